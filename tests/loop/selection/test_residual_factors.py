"""What a residual depends on: a residual made of one factor is put to it, and nothing depends on clock or order."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from dummydesign.loop.data.reduction import HOLD, PRE, UNLOADING
from dummydesign.loop.data.trials import stack
from dummydesign.loop.effects.learned import followed
from dummydesign.loop.effects.registry import known_effects
from dummydesign.loop.fitting.candidates import first_fit, project, screen, starts_of
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.fitting.noise import estimate_slow_noise, repeat_pairs
from dummydesign.loop.selection.cross_validation import assess
from dummydesign.loop.selection.nonparametric_effect import refitted_squares
from dummydesign.loop.selection.residuals import (
    dependences,
    diagnose,
    families,
    hats,
    raw_residuals,
    run_checks,
)
from tests.support import puck_presses as pucks
from tests.support.puck_presses import clean_fit


def made_of(factor, presses, forces):
    """A residual that follows a factor alone, written anew. [N]"""
    since = 0.5 * (presses.bins.start + presses.bins.end) - presses.stop_s[:, None]
    phase = presses.label // 100
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    history = presses.history
    rows = {
        "force": lambda: forces * (forces / 10.0) ** 2,
        "depth": lambda: forces * np.maximum(1.0 - np.abs(8.0 * depth / depth.max() - 4.0), 0.0),
        "speed": lambda: forces * np.log(presses.velocity_mm_s / 30.0)[:, None] * (since > 0.05),
        "thickness": lambda: forces * np.log(presses.thickness_mm / 9.8)[:, None] * (since > 0.1),
        "time since stop": lambda: (
            forces * np.interp(np.log(since.clip(1e-3)), np.log([0.03, 0.12, 0.5]), [0.0, 1.0, 0.0]) * (since > 0.0)
        ),
        "oscillation after the stop": lambda: np.where(
            (since > 0.0) & (since < 0.3) & (presses.velocity_mm_s > 100.0)[:, None],
            np.sin(2.0 * np.pi * 20.0 * since),
            0.0,
        ),
        "order": lambda: forces * ((history.sequence - 8.5) / 7.5)[:, None],
        "repeat": lambda: forces * (history.repeat - 1.5)[:, None],
        "loading or unloading": lambda: forces * (phase == UNLOADING),
        "before contact": lambda: 1.0 * (phase == PRE),
        "single trials": lambda: forces * (np.arange(len(forces)) == 5)[:, None],
        "temperature": lambda: forces * (history.temperature_C - history.temperature_C.mean())[:, None],
        "age": lambda: forces * (history.age_days - history.age_days.mean())[:, None],
    }
    made = np.where(presses.used, rows[factor](), 0.0)
    return made / np.abs(made).max()


@lru_cache(maxsize=1)
def shuffled():
    """The clean fit's trials with warmth, age and order that tell each other apart."""
    chance = np.random.default_rng(3)
    presses = pucks.pressed()
    warm, age, order = 20.0 + 6.0 * chance.random(16), 5.0 + 9.0 * chance.random(16), chance.permutation(16) + 1.0
    history = replace(presses.history, temperature_C=warm, age_days=age, sequence=order)
    problem = replace(clean_fit().problem, presses=replace(presses, history=history))
    return replace(clean_fit(), problem=problem)


@pytest.mark.parametrize(
    "factor",
    [
        "force",
        "depth",
        "speed",
        "thickness",
        "time since stop",
        "oscillation after the stop",
        "order",
        "repeat",
        "loading or unloading",
        "before contact",
        "single trials",
        "temperature",
        "age",
    ],
)
def test_a_residual_made_of_one_factor_is_put_to_it(factor):
    found = shuffled()
    left = 0.5 * made_of(factor, found.problem.presses, found.forces)
    first = dependences(replace(found, residual=left, vector=0.0 * found.vector))[0]
    assert first.factor == factor and first.share > 0.85 and first.excess == pytest.approx(first.drop - first.columns)


def test_what_a_factor_explains_is_what_least_squares_explain():
    found = shuffled()
    chance = np.random.default_rng(4)
    left = np.where(found.problem.presses.used, 0.1 * chance.normal(size=found.forces.shape), 0.0)
    made = replace(found, residual=left)
    projection = project(made, law_free=True)
    whiten = projection.whiten
    clean = projection.remove(projection.residual)
    told = {one.factor: one for one in dependences(made)}
    for name in ("temperature", "repeat", "loading or unloading"):
        rows = [np.r_[whiten(one).ravel(), np.zeros(projection.rows)] for one in families(made)[name]]
        columns = np.stack(rows, axis=1)
        columns = columns - projection.basis @ (projection.basis.T @ columns)
        kept = np.linalg.lstsq(columns, clean, rcond=1e-6)[0]
        assert told[name].drop == pytest.approx(float((columns @ kept) @ clean), rel=0.02, abs=0.01)
        assert told[name].share == pytest.approx(told[name].drop / float(clean @ clean))
    excess = [one.excess for one in dependences(made)]
    assert excess == sorted(excess, reverse=True)


def test_hats_add_to_one_and_interpolate():
    knots = np.array([0.0, 1.0, 3.0, 7.0])
    at = np.array([[-1.0, 0.5], [2.0, 9.0]])
    rows = np.stack(hats(at, knots), axis=-1)
    np.testing.assert_allclose(rows.sum(axis=-1), 1.0)
    assert rows.min() >= 0.0 and np.count_nonzero(rows, axis=-1).max() == 2
    np.testing.assert_allclose(rows @ knots, [[0.0, 0.5], [2.0, 7.0]])


def with_raw(change):
    """The clean fit whose raw samples are its own forces and what ``change`` gives for a trial; hardly any noise."""
    found = clean_fit()
    presses = found.problem.presses
    trials = []
    for row, (trial, model) in enumerate(zip(presses.trials, found.problem.at_samples(found.vector))):
        time = trial.trace.time_s
        force = model + change(row, time - presses.stop_s[row], time) + 1e-9 * np.cos(1e4 * time**2)
        trials.append(replace(trial, trace=replace(trial.trace, force_N=force)))
    made = replace(presses, trials=tuple(trials))
    return replace(found, problem=replace(found.problem, presses=made), residual=0.0 * found.residual)


def check(found, name):
    return next(one for one in run_checks(found) if one.name == name)


def test_raw_residuals_are_what_was_added_and_a_shift_of_contact_is_taken_out():
    def added(row, since, time):
        return 0.01 * row * np.sin(time)

    for row, (left, trial) in enumerate(zip(raw_residuals(with_raw(added)), clean_fit().problem.presses.trials)):
        np.testing.assert_allclose(left, added(row, None, trial.trace.time_s), atol=2e-9)
    # a trial that touched earlier by s, with room for it in the scatter
    found = clean_fit()
    problem, shift = found.problem, 0.02 * (-1.0) ** np.arange(16)
    sizes = replace(found.sizes, noise=replace(found.sizes.noise, position_mm=0.1))
    moved = problem.at_samples(found.vector, -shift)
    trials = tuple(
        replace(trial, trace=replace(trial.trace, force_N=force)) for trial, force in zip(problem.presses.trials, moved)
    )
    presses = replace(problem.presses, trials=trials)
    bins = np.where(presses.used, problem.predict(found.vector, -shift) - found.forces, 0.0)
    made = replace(found, problem=replace(problem, presses=presses), residual=bins, sizes=sizes)
    left, before = (
        np.concatenate(one)
        for one in (raw_residuals(made), [a - b for a, b in zip(moved, problem.at_samples(found.vector))])
    )
    assert np.abs(left).max() < 0.1 * np.abs(before).max()


def test_a_step_is_as_large_and_where_it_is():
    quiet = check(with_raw(lambda row, since, time: 0.0 * time), "step in the hold")
    assert quiet.value == pytest.approx(0.0, abs=1e-6) and not quiet.exceeded
    # blocks of a tenth of a second begin 0.4 s after the stop
    found = with_raw(lambda row, since, time: -0.5 * (since >= 1.2) * (row == 6))
    step = check(found, "step in the hold")
    size, where = step.text.split(" N in p7.csv, ")
    assert float(size.split()[-1]) == pytest.approx(-0.5, rel=0.01)
    assert float(where.split(" s ")[0]) == pytest.approx(1.2, abs=0.06) and step.exceeded
    # ten times as large, ten times as many standard deviations
    ten = check(with_raw(lambda row, since, time: -5.0 * (since >= 1.2) * (row == 6)), "step in the hold")
    assert ten.value == pytest.approx(10.0 * step.value, rel=1e-4)
    assert not check(with_raw(lambda row, since, time: -0.1 * (since >= 1.2)), "step in the hold").exceeded


@pytest.mark.parametrize("shape", [np.log, np.square, lambda s: s, lambda s: np.log(s) ** 2, np.ones_like])
def test_what_a_wrong_relaxation_leaves_is_no_step(shape):
    found = with_raw(lambda row, since, time: 3.0 * shape(np.maximum(since, 1e-3)) * (since > 0.2))
    assert not check(found, "step in the hold").exceeded


@pytest.mark.parametrize("frequency", [40.0, 90.0, 333.0])
def test_a_line_is_where_it_is_in_the_spectrum(frequency):
    chance = np.random.default_rng(2)

    def humming(row, since, time):
        return 0.02 * np.sin(2.0 * np.pi * frequency * time + row) + 0.01 * chance.normal(size=len(time))

    line = check(with_raw(humming), "spectral line")
    assert line.exceeded and line.value > line.limit
    # the window after the stop is a third of a second
    assert float(line.text.split("at ")[1].split(" Hz")[0]) == pytest.approx(frequency, abs=3.0)
    plain = check(with_raw(lambda row, since, time: 0.01 * chance.normal(size=len(time))), "spectral line")
    assert not plain.exceeded and plain.value > 1.0


def test_a_smooth_curve_or_a_slow_swing_is_no_line():
    chance = np.random.default_rng(2)
    for size in (0.0, 5.0):
        found = with_raw(lambda row, since, time, size=size: size * since**3 + 0.01 * chance.normal(size=len(time)))
        assert not check(found, "spectral line").exceeded


def test_noise_before_contact_is_read_against_the_floor_and_does_not_see_a_bias():
    found = clean_fit()
    floor = found.sizes.floor_N
    for times in (1.0, 1.4, 1.6):

        def noisy(row, since, time, times=times):
            return 0.7 * row + times * floor * (-1.0) ** np.arange(len(time))

        quiet = check(with_raw(noisy), "noise before contact")
        assert quiet.value == pytest.approx(times, rel=0.01) and quiet.exceeded is (times > 1.5)
    late = check(with_raw(lambda row, since, time: 5.0 * (since > -1e-9)), "noise before contact")
    assert late.value == pytest.approx(0.0, abs=1e-7)


@lru_cache(maxsize=1)
def moved_fit():
    """The clean campaign with trials in another order and a clock of its own in each."""
    presses = pucks.pressed()
    order = np.random.default_rng(8).permutation(16)
    trials = []
    for place in order:
        trial = presses.trials[place]
        trials.append(replace(trial, trace=replace(trial.trace, time_s=trial.trace.time_s + 3.0 * (1 + place % 5))))
    made = stack(tuple(trials), None)
    reduced = tuple(replace(one, white_N=pucks.NOISE_N) for one in made.presses)
    made = replace(made, presses=reduced, force_N=presses.force_N[order])
    return order, fit_base(made, pucks.LAW, pucks.YOUNG_MPA)


def test_clock_and_order_of_the_trials_change_no_reduction():
    order, other = moved_fit()
    one, two = clean_fit().problem.presses, other.problem.presses
    for name in ("label", "samples", "used", "depth_mm", "velocity_mm_s", "thickness_mm", "back_mm_s", "unloads"):
        np.testing.assert_allclose(getattr(two, name), getattr(one, name)[order], atol=1e-6)
    shift = 3.0 * (1 + order % 5)
    for name in ("contact_s", "stop_s", "hold_end_s"):
        np.testing.assert_allclose(getattr(two, name) - shift, getattr(one, name)[order], atol=1e-6)
    np.testing.assert_allclose(two.acceleration_mm_s2, one.acceleration_mm_s2[order], atol=1e-2)
    pairs = {frozenset(order[list(pair)].tolist()) for pair in repeat_pairs(two)}
    assert pairs == {frozenset(pair) for pair in repeat_pairs(one)} and len(pairs) == 8
    for name in ("earlier_depth_mm", "elapsed_s"):
        np.testing.assert_allclose(getattr(two.history, name), getattr(one.history, name)[np.ix_(order, order)])
    for name in ("sequence", "repeat", "rest_s", "temperature_C", "age_days"):
        np.testing.assert_array_equal(getattr(two.history, name), getattr(one.history, name)[order])


def test_clock_and_order_of_the_trials_change_no_fit_and_nothing_that_is_read_off_it():
    order, other = moved_fit()
    found = clean_fit()
    np.testing.assert_allclose(other.vector, found.vector, atol=2e-4)
    np.testing.assert_allclose(other.forces, found.forces[order], atol=1e-3)
    np.testing.assert_allclose(other.slope, found.slope[order], rtol=1e-2, atol=1e-2)
    assert other.score == pytest.approx(found.score, abs=0.05)
    one, two = assess(found), assess(other)
    assert two.errors.train_N == pytest.approx(one.errors.train_N, rel=1e-4)
    assert two.errors.heldout_N == pytest.approx(one.errors.heldout_N, rel=1e-3)
    assert two.by_pad.heldout_N == pytest.approx(one.by_pad.heldout_N, rel=1e-2)
    assert two.lack.ratio == pytest.approx(one.lack.ratio, rel=1e-3)
    assert refitted_squares(other) == pytest.approx(refitted_squares(found), rel=0.03)
    for name, values in followed(other.problem.presses, other.forces).items():
        own = followed(found.problem.presses, found.forces)[name]
        np.testing.assert_allclose(np.sort(values), np.sort(own), atol=1e-3)
    seen, again = diagnose(found), diagnose(other)
    drops = {row.factor: row.drop for row in again.where}
    assert {row.factor: row.drop for row in seen.where} == pytest.approx(drops, rel=0.02, abs=0.1)
    assert [row.value for row in again.checks] == pytest.approx([row.value for row in seen.checks], rel=1e-2)
    noise = [
        estimate_slow_noise(fit.problem.presses, fit.residual, fit.slope, fit.forces, fit.sizes.noise)
        for fit in (found, other)
    ]
    assert noise[1].slow_N == pytest.approx(noise[0].slow_N, abs=1e-4)


def available():
    presses = clean_fit().problem.presses
    return tuple(one for one in known_effects() if not one.unavailable(presses, pucks.LAW))


def test_effects_are_screened_by_what_they_would_explain():
    """A residual that is an effect's own change has a score of the length of that change, projected, and its size."""
    found = replace(clean_fit(), residual=0.0 * clean_fit().residual, vector=clean_fit().vector.copy())
    found.vector[found.problem.fixed :] = 0.0
    presses = found.problem.presses
    forces = found.problem.predict(found.vector)
    for effect in available():
        start = starts_of(effect)[0]
        problem = found.problem.plus(effect)
        vector = np.insert(found.vector, found.problem.fixed, start)
        change = np.where(presses.used, problem.predict(vector) - forces, 0.0)
        made = replace(found, forces=forces, residual=change)
        projection = project(made)
        whiten = projection.whiten
        wanted = projection.remove(np.r_[whiten(change).ravel(), np.zeros(projection.rows)])
        if np.linalg.norm(wanted) < 1e-3:
            continue
        (one,) = screen(made, (effect,))
        assert abs(one.z) == pytest.approx(np.linalg.norm(wanted), rel=1e-6)
        if len(starts_of(effect)) == 1:
            assert one.coordinate == pytest.approx(start[0], rel=1e-6)
            np.testing.assert_allclose(one.signature, wanted / np.linalg.norm(wanted), atol=1e-9)


def test_scores_come_best_first_and_a_size_that_cannot_be_has_none():
    effects = available()
    ranked = screen(clean_fit(), effects)
    assert [abs(one.z) for one in ranked] == sorted((abs(one.z) for one in ranked), reverse=True)
    (effect,) = (one for one in effects if one.name == "machine_compliance")
    found = clean_fit()
    problem = found.problem.plus(effect)
    change = problem.predict(np.insert(found.vector, found.problem.fixed, starts_of(effect)[0])) - found.forces
    for sign in (1.0, -1.0):
        (one,) = screen(replace(found, residual=sign * np.where(found.problem.presses.used, change, 0.0)), (effect,))
        # a machine does not give way by less than nothing
        assert (one.z == 0.0) is (sign < 0.0)


def test_an_effect_that_is_there_is_fitted_as_large_as_it_is():
    effect = next(one for one in available() if one.name == "contact_offset")
    presses = clean_fit().problem.presses
    problem = replace(clean_fit().problem, effects=(effect,))
    vector = np.insert(pucks.truth(), 5, effect.parameters[0].to_coordinate(0.08))
    made = replace(presses, force_N=np.where(presses.used, problem.predict(vector), 0.0))
    base = fit_base(made, pucks.LAW, pucks.YOUNG_MPA)
    (one,) = screen(base, (effect,))
    found = first_fit(base, one)
    assert found.active[0].values[effect.parameters[0].name] == pytest.approx(0.08, rel=0.03)
    assert found.score < base.score - 100.0


def test_phases_of_a_press_follow_each_other():
    presses = pucks.planned()
    for row, press in enumerate(presses.presses):
        phase = press.label // 100
        middle = 0.5 * (press.start_s + press.end_s)
        assert np.all(middle[phase == HOLD] > presses.stop_s[row])
        assert np.all(middle[phase == UNLOADING] > presses.hold_end_s[row])
        assert np.all(middle[phase == PRE] < presses.contact_s[row])
