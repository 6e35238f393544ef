"""Learned functions on a small campaign of pucks, step by step: sensitivities, one step, refits without conditions."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.progress import quiet
from dummydesign.loop.data.reduction import UNLOADING
from dummydesign.loop.effects.learned import FOLLOWED, Learned, SmoothChange, followed, largest_change
from dummydesign.loop.fitting.candidates import project
from dummydesign.loop.fitting.fit import fit, fit_base, prior_precision
from dummydesign.loop.selection import nonparametric_effect
from dummydesign.loop.selection.nonparametric_effect import closed_form, learn
from dummydesign.loop.selection.residuals import Dependence, ResidualDiagnostics
from tests.support import puck_presses as pucks
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit


def quantities():
    return followed(clean_fit().problem.presses, clean_fit().forces)


def warmer(presses, forces):
    """5 % stiffer above 25 C."""
    return 1.0 + 0.05 * (presses.history.temperature_C > 25.0)[:, None] * np.ones_like(forces)


def creeping(presses, forces):
    """6 % a decade of 1 + 10 t / s after the stop."""
    since = 0.5 * (presses.bins.start + presses.bins.end) - presses.stop_s[:, None]
    return 1.0 - 0.06 * np.log10(1.0 + 10.0 * np.maximum(since, 0.0))


def together(presses, forces):
    """Stiffer with depth on warm presses, softer on cold ones."""
    share = presses.measure(np.maximum(presses.displacement_mm, 0.0)) / presses.thickness_mm[:, None]
    warm = presses.history.temperature_C[:, None]
    return 1.0 + 0.08 * np.tanh((share - 0.15) / 0.05) * (warm - 25.25) / 3.75


@lru_cache(maxsize=4)
def changed_fit(change):
    return fit_base(pucks.pressed(change), pucks.LAW, pucks.YOUNG_MPA)


def test_a_step_with_temperature_is_learned_as_high_as_it_is():
    base = changed_fit(warmer)
    found = learn(base, ("temperature_C", "age_days"))
    assert found.effect.name == "learned_temperature_c" and found.form.name == "step" and found.left_out < 0.3
    cold, warm = 1.0 + found.effect.shape(np.array([23.0, 27.5]))
    assert warm / cold == pytest.approx(1.05, abs=0.008)
    assert found.fit.score < base.score - found.cost - nonparametric_effect.EACH_PARAMETER


@pytest.mark.slow
def test_a_creep_after_the_stop_is_learned_from_zero():
    found = learn(changed_fit(creeping), ("since_stop_s",))
    at = np.array([0.003, 0.3, 1.0, 2.0])
    wanted = -0.06 * np.log10(1.0 + 10.0 * at)
    seen = found.effect.shape(at)
    assert seen[0] == pytest.approx(0.0, abs=0.004)
    # two arms have taken their part of it, the slower one of what changes last
    assert np.corrcoef(seen, wanted)[0, 1] > 0.97 and found.left_out < 0.1


@pytest.mark.slow
def test_what_depends_on_two_quantities_is_learned_over_both_though_each_alone_is_tried():
    found = learn(changed_fit(together), ("depth_share", "temperature_C"))
    assert set(found.effect.shape.follows) == {"depth_share", "temperature_C"} and found.form.name == "surface"
    assert found.left_out < 0.4
    order = found.effect.shape.follows.index("depth_share")
    deep, shallow = ([(s, t) if order == 0 else (t, s) for t in (22.5, 28.0)] for s in (0.25, 0.08))
    change = [found.effect.shape(*(np.array(axis) for axis in zip(*pairs))) for pairs in (deep, shallow)]
    # warm over cold, deep over shallow: 0.08 tanh(2) and tanh(-1.4), over 5.5 K of 3.75 K
    wanted = 0.08 * (np.tanh(2.0) - np.tanh(-1.4)) * 5.5 / 3.75
    assert (change[0][1] - change[0][0]) - (change[1][1] - change[1][0]) == pytest.approx(wanted, rel=0.2)


def test_noise_alone_teaches_nothing():
    assert learn(clean_fit(), ("depth_mm", "force_N", "temperature_C", "age_days")) is None


@pytest.mark.parametrize("name", ["depth_mm", "depth_share", "force_N", "temperature_C"])
def test_sensitivities_of_all_values_together_are_the_force(name):
    """The hats of all knots add to one, and a gain of one on the pad or the sensor is the force itself."""
    found = clean_fit()
    values = quantities()[name]
    low = values.min() if name == "temperature_C" else 0.0
    shape = SmoothChange((name,), (tuple(np.linspace(low, 1.2 * values.max(), 7)),), (0.0,) * 7)
    columns = nonparametric_effect._columns(found, shape)
    used = found.problem.presses.used
    assert columns.shape == (*used.shape, 7)
    # on the way back the contact lets go, which is not linear
    held = used & (found.problem.presses.label < 100 * UNLOADING)
    np.testing.assert_allclose(columns.sum(axis=-1)[held], found.forces[held], rtol=2e-3, atol=2e-3)
    assert not columns[~used].any()


def test_a_sensitivity_is_a_difference_of_predictions_whatever_the_fit_has_learned():
    found = clean_fit()
    shape = SmoothChange(("temperature_C",), ((21.0, 25.0, 29.5),), (0.02, -0.01, 0.03))
    problem, vector = nonparametric_effect._with(found, shape)
    learned = replace(found, problem=problem, vector=vector, forces=problem.predict(vector))
    columns = nonparametric_effect._columns(learned, shape)
    for place in range(3):
        moved = shape.with_flat(shape.flat + 1e-3 * np.eye(3)[place])
        change = nonparametric_effect._with(found, moved)[0].predict(vector) - learned.forces
        np.testing.assert_allclose(1e3 * change * problem.presses.used, columns[..., place], atol=1e-6)
    # one learned effect takes the place of another, at size one
    again, at = nonparametric_effect._with(learned, shape)
    assert len(again.effects) == 1 and at == pytest.approx(vector) and at[again.fixed - 1] == 1.0


def test_knots_span_what_was_seen_evenly_and_are_no_more_than_the_values_of_a_trials_quantity():
    found, seen = clean_fit(), quantities()
    for name, values in seen.items():
        knots = np.array(nonparametric_effect._knots(found, name, values, nonparametric_effect.KNOTS))
        assert knots[0] == pytest.approx(values.min())
        beyond = name in ("force_N", "reading_N")
        assert knots[-1] > 1.1 * values.max() if beyond else knots[-1] == pytest.approx(values.max())
        steps = np.diff(np.log(knots)) if name == "since_stop_s" else np.diff(knots)
        np.testing.assert_allclose(steps, steps[0], rtol=1e-9)
        most = (
            nonparametric_effect.MOST_BY_TRIAL
            if len(values) == len(found.problem.presses.trials)
            else nonparametric_effect.KNOTS
        )
        assert len(knots) == min(most, len(np.unique(values)))
    pair = nonparametric_effect._first(found, seen, "temperature_C", "depth_mm")[0]
    assert [len(knots) for knots in pair.knots] == [nonparametric_effect.PAIR_BY_TRIAL, nonparametric_effect.PAIR_KNOTS]


def test_a_step_is_the_normal_posterior_of_the_curve_with_all_other_parameters_free():
    """By dense algebra: bins r = J x + C v + noise, x with its own prior, v with the penalty's."""
    found = changed_fit(warmer)
    shape = SmoothChange(("temperature_C",), (tuple(np.linspace(21.5, 29.0, 6)),), (0.0,) * 6)
    step = nonparametric_effect._step(found, shape)
    whiten = project(found).whiten
    presses = found.problem.presses
    columns = whiten(nonparametric_effect._columns(found, shape)).reshape(-1, 6)
    jacobian = whiten(found.jacobian).reshape(len(columns), -1)
    target = whiten(found.residual).ravel()
    prior = prior_precision(found.problem, found.sizes)
    # flat priors of the base are wide ones here, in units of what the data know
    wide = 1e-9 * np.maximum((jacobian**2).sum(axis=0), 1e-12)
    cover = np.eye(len(target)) + jacobian @ np.diag(1.0 / np.maximum(prior, wide)) @ jacobian.T
    pulled = target - jacobian @ (np.where(prior > 0.0, -found.vector, 0.0))
    weigh = np.linalg.solve(cover, np.column_stack([columns, pulled]))
    information, pull = columns.T @ weigh[:, :6], columns.T @ weigh[:, 6]
    assert presses.used.sum() == np.count_nonzero(target)
    np.testing.assert_allclose(step.information, information, rtol=2e-3, atol=2e-4 * np.abs(information).max())
    np.testing.assert_allclose(
        (step.information + step.precision) @ step.values, pull, rtol=5e-3, atol=5e-3 * np.abs(pull).max()
    )
    ratio = np.linalg.slogdet(np.eye(6) + np.linalg.solve(step.precision, information))[1]
    assert step.evidence == pytest.approx(float(pull @ step.values - ratio), rel=1e-2)


def test_the_penalty_is_on_bends_and_leaves_a_line_its_plain_prior():
    found = changed_fit(warmer)
    knots = np.linspace(21.5, 29.0, 6)
    step = nonparametric_effect._step(found, SmoothChange(("temperature_C",), (tuple(knots),), (0.0,) * 6))
    rough = np.diff(np.eye(6), 2, axis=0)
    line, bend = np.arange(6.0), (-1.0) ** np.arange(6)
    plain = step.precision @ line / np.where(line == 0.0, 1.0, line)
    np.testing.assert_allclose(plain[1:], plain[1], rtol=1e-6)
    penalty = (bend @ step.precision @ bend - plain[1] * bend @ bend) / float(((rough @ bend) ** 2).sum())
    assert penalty > 0.99
    np.testing.assert_allclose(step.precision, penalty * rough.T @ rough + plain[1] * np.eye(6), rtol=1e-6, atol=1e-9)
    # of changes of ten per cent and a half either way most are within it
    assert 0.2 < plain[1] ** -0.5 < 0.5


def test_a_second_step_stays_where_the_first_has_led():
    """The model is linear in the curve: from the step's own values the next step leads to them again."""
    found = changed_fit(warmer)
    shape = SmoothChange(("temperature_C",), (tuple(np.linspace(21.5, 29.0, 6)),), (0.0,) * 6)
    first = nonparametric_effect._step(found, shape)
    problem, vector = nonparametric_effect._with(found, shape.with_flat(first.values))
    there = fit(problem, vector, found.sizes, 8)
    second = nonparametric_effect._step(there, shape.with_flat(first.values))
    np.testing.assert_allclose(second.values - second.values.mean(), first.values - first.values.mean(), atol=3e-3)


def test_left_out_squares_are_those_of_fits_to_the_rest():
    """Conditions go in four parts; each press is predicted by a fit that has not seen its condition."""
    found = clean_fit()
    presses = found.problem.presses
    weight = presses.samples * presses.used
    squares, left = 0.0, []
    for out in (presses.cell % 4 == part for part in range(4)):
        forces = nonparametric_effect.predicted_without(found, out)
        left.append(out)
        squares += float((weight * (presses.force_N - forces) ** 2)[out].sum())
    assert np.sum(left) == len(presses.trials)
    assert nonparametric_effect.refitted_squares(found) == pytest.approx(squares / weight.sum(), rel=1e-12)
    total, counted = nonparametric_effect.squares_without(found, left)
    assert total == pytest.approx(squares) and counted == pytest.approx(weight.sum())


def test_a_fit_without_presses_does_not_look_at_them():
    found = clean_fit()
    presses = found.problem.presses
    out = presses.cell == presses.cell[0]
    spoiled = replace(presses, force_N=np.where(out[:, None], 9.0, presses.force_N))
    one = nonparametric_effect.predicted_without(found, out)
    other = nonparametric_effect.predicted_without(replace(found, problem=replace(found.problem, presses=spoiled)), out)
    np.testing.assert_array_equal(one, other)
    all_in = nonparametric_effect.predicted_without(found, np.zeros(len(out), bool))
    np.testing.assert_allclose(all_in, found.forces, atol=0.02)


@pytest.mark.slow
def test_a_learned_shape_is_learned_anew_without_the_presses():
    found = changed_fit(warmer)
    learnt = learn(found, ("temperature_C",))
    presses = found.problem.presses
    out = np.arange(len(presses.trials)) == int(np.argmax(presses.history.temperature_C < 24.0))
    with_shape = nonparametric_effect.predicted_without(learnt.fit, out)
    plain = nonparametric_effect.predicted_without(found, out)
    weight = (presses.samples * presses.used)[out]
    errors = [float(np.average((presses.force_N - one)[out] ** 2, weights=weight)) for one in (with_shape, plain)]
    assert errors[0] < 0.25 * errors[1]


def test_the_largest_change_is_named_where_the_campaign_says_something():
    shape = SmoothChange(("depth_mm", "age_days"), ((1.0, 3.0), (5.0, 7.0, 9.0)), ((0.1, -0.2, 0.05), (0.02, 0.9, 0.0)))
    seen = np.diag([1.0, 1.0, 1.0, 1.0, 1e-4, 1.0])
    said = largest_change(shape, seen)
    assert "-20.0 % at 1 and 7" in said
    assert "+90.0 % at 3 and 7" in largest_change(shape, np.eye(6))


@pytest.mark.parametrize(
    ("name", "scale"),
    [
        pytest.param("linear", 1e3, marks=pytest.mark.slow),
        ("power", 1e-3),
        ("exponential", 1.0),
        pytest.param("saturation", 1e3, marks=pytest.mark.slow),
        pytest.param("bump", 1e-3, marks=pytest.mark.slow),
        ("step", 1.0),
    ],
)
def test_a_form_is_found_whatever_the_unit_of_the_quantity(name, scale):
    u = np.linspace(0.0, 10.0, 30)
    curves = {
        "linear": 0.02 * u,
        "power": 3e-4 * u**2.5,
        "exponential": 0.004 * np.expm1(u / 4.0),
        "saturation": -0.2 * np.expm1(-u / 2.0),
        "bump": 0.1 * np.exp(-(((u - 6.0) / 2.0) ** 2)),
        "step": 0.05 * (u > 3.1),
    }
    found = closed_form(scale * u, curves[name], 1e6 * np.eye(30), "depth_mm")
    assert found.name == name and found.lost < 0.05
    # what is said is the curve, relative to no depth
    said = found.text.split(": ")[1].removesuffix(". Usual cause")
    at = scale * 9.0
    value = said.replace("^", "**").replace("beyond", "* (u >") + (")" if name == "step" else "")
    with np.errstate(all="ignore"):
        told = float(eval(_times(value), {"u": at, "exp": np.exp}))
    assert told == pytest.approx(np.interp(9.0, u, curves[name] - curves[name][0]), rel=0.15, abs=2e-3)


def _times(text):
    """What is said as an expression: a number beside u, exp or a bracket multiplies it."""
    import re

    return re.sub(r"(?<=[\d]) (?=[u(e])", " * ", text)


@pytest.mark.slow
def test_a_form_that_loses_a_tenth_of_the_curve_is_no_form():
    """A ripple on a straight line: as the form takes the line, the ripple's share of the squares is lost."""
    u = np.linspace(0.0, 10.0, 30)
    ripple = np.cos(np.pi * np.arange(30.0))
    for share, name in ((0.05, "linear"), (0.2, "curve")):
        line = 0.05 * (u - u.mean())
        ripple_size = np.sqrt(share / (1.0 - share) * (line @ line) / (ripple @ ripple))
        values = line + ripple_size * ripple
        found = closed_form(u, values, np.eye(30), "depth_mm")
        assert found.name == name and found.lost == pytest.approx(share, rel=0.35)


def model(score, effects=(), **more):
    problem = SimpleNamespace(effects=tuple(effects))
    return SimpleNamespace(fit=SimpleNamespace(score=score, problem=problem, squares=more.get("squares", 1.0)))


def test_a_model_costs_its_likelihood_its_named_parameters_and_its_curve():
    plain, named = model(100.0), model(100.0, [effect_named("contact_offset")])
    each = nonparametric_effect._cost(named) - nonparametric_effect._cost(plain)
    assert nonparametric_effect._cost(plain) == 100.0 and each == nonparametric_effect.EACH_PARAMETER > 0.0
    curve = Learned(SmoothChange(("depth_mm",), ((0.0, 1.0),), (0.1, 0.0)))
    assert nonparametric_effect._cost(model(100.0, [curve]), SimpleNamespace(cost=7.5)) == 107.5
    # a parameter of form is known beforehand: the exponent of a machine costs nothing
    formed = effect_named("machine_compliance")
    assert any(one.of_form for one in formed.parameters)
    own = sum(not one.of_form for one in formed.parameters)
    assert nonparametric_effect._cost(model(100.0, [formed])) == 100.0 + own * each


@pytest.fixture
def decided(monkeypatch):
    """What is learned, at which score, and what each model leaves."""
    state = {"score": 500.0, "leaves": False}
    monkeypatch.setattr(nonparametric_effect, "assess", lambda fit: SimpleNamespace(fit=fit))
    monkeypatch.setattr(nonparametric_effect, "_leaves", lambda base, fit: fit.leaves)
    monkeypatch.setattr(nonparametric_effect, "remainder", lambda *args: SimpleNamespace(reasons=("more",)))

    def learn_it(fit, among):
        made = model(state["score"]).fit
        made.leaves = state["leaves"]
        return SimpleNamespace(fit=made, cost=20.0, effect=None)

    monkeypatch.setattr(nonparametric_effect, "learn", learn_it)
    return state


SEEN = ResidualDiagnostics([Dependence("depth", 500.0, 3, 0.5, "")], [])


def ranked(score, leaves=True):
    made = model(score).fit
    made.leaves = leaves
    return [SimpleNamespace(fit=made)]


def test_a_function_alone_wins_where_it_leaves_noise_and_the_best_effect_leaves_more_and_explains_less(decided):
    base = model(1000.0)
    least = 520.0 - nonparametric_effect.EACH_PARAMETER
    assert nonparametric_effect.learned_alone(base, SEEN, ranked(least + 1.0), quiet) is not None
    assert nonparametric_effect.learned_alone(base, SEEN, ranked(least - 1.0), quiet) is None
    assert nonparametric_effect.learned_alone(base, SEEN, ranked(900.0, leaves=False), quiet) is None
    assert nonparametric_effect.learned_alone(base, SEEN, [], quiet) is not None
    assert nonparametric_effect.learned_alone(base, ResidualDiagnostics([], []), ranked(900.0), quiet) is None
    decided["leaves"] = True
    assert nonparametric_effect.learned_alone(base, SEEN, ranked(900.0), quiet) is None


def test_a_function_first_must_cost_less_and_predict_better_than_the_named_effects(decided, monkeypatch):
    curve = Learned(SmoothChange(("depth_mm",), ((0.0, 1.0),), (0.1, 0.0)))
    effect = effect_named("contact_offset")
    named = model(600.0, [effect], squares=2.0)
    monkeypatch.setattr(nonparametric_effect, "refitted_squares", lambda fit: fit.squares)
    monkeypatch.setattr(nonparametric_effect, "replace", lambda one, **more: SimpleNamespace(**{**vars(one), **more}))
    asked = []

    def found(score, squares):
        def search_it(model_, available, progress, most):
            asked.append(most)
            after = model(score, [curve], squares=squares)
            entries = [SimpleNamespace(candidate=SimpleNamespace(effect=one)) for one in (curve, effect)]
            return SimpleNamespace(after=after, effects=tuple(entries))

        monkeypatch.setattr(nonparametric_effect, "search", search_it)
        monkeypatch.setattr(
            nonparametric_effect,
            "learn",
            lambda *args: SimpleNamespace(fit=None, cost=20.0, effect=SimpleNamespace(shape=None)),
        )
        return nonparametric_effect.learned_first(model(1000.0), SEEN, named, (), quiet)

    least = 600.0 + nonparametric_effect.EACH_PARAMETER - 20.0
    best = found(least - 1.0, 1.9)
    assert [one.candidate.effect for one in best.effects] == [effect] and asked == [1]
    assert found(least + 1.0, 1.9) is None and found(least - 1.0, 2.1) is None
    assert nonparametric_effect.learned_first(model(1000.0), SEEN, model(600.0), (), quiet) is None


def test_every_quantity_that_a_curve_may_follow_has_words_and_a_usual_cause():
    assert set(nonparametric_effect.CAUSES) == set(FOLLOWED) - {nonparametric_effect.BY_TIME}


@pytest.fixture
def rounds(monkeypatch):
    """``_learnt`` on fits whose scores are given one after another; values of the tried shapes are kept."""
    shape = SmoothChange(("depth_mm",), ((0.0, 1.0),), (0.0, 0.0))
    step = nonparametric_effect._Step(np.array([-0.1, 0.1]), 1e4, np.eye(2), np.eye(2))
    sizes = SimpleNamespace(noise=None)
    tried = []

    def run(*scores):
        queue = iter(scores)
        tried.clear()

        def fitted(problem, vector, sizes, *_):
            tried.append(problem.flat[1])
            return SimpleNamespace(score=next(queue), sizes=SimpleNamespace(noise=None), squares=0.1)

        monkeypatch.setattr(nonparametric_effect, "fit_with_noise", fitted)
        before = SimpleNamespace(score=10_000.0, sizes=sizes, squares=1.0)
        return nonparametric_effect._learnt(before, before, shape, step)

    monkeypatch.setattr(nonparametric_effect, "replace", lambda one, **more: one)
    monkeypatch.setattr(nonparametric_effect, "_with", lambda fit, shape: (shape, None))
    monkeypatch.setattr(nonparametric_effect, "_step", lambda fit, shape: step)
    monkeypatch.setattr(nonparametric_effect, "refitted_squares", lambda fit: fit.squares)
    return SimpleNamespace(run=run, tried=tried)


def test_rounds_end_where_one_gains_less_than_evidence_and_a_share_of_the_score(rounds):
    least = nonparametric_effect.EVIDENCE + nonparametric_effect.ENDED * 7_800.0
    for gain, count in ((least - 5.0, 2), (least + 5.0, 3)):
        score = 8_000.0 - gain
        found = rounds.run(8_000.0, score, score - 1.0)
        assert len(rounds.tried) == count and found.fit.score == (score if count == 2 else score - 1.0)


def test_of_a_change_that_raises_the_score_a_smaller_share_is_taken_or_nothing(rounds):
    found = rounds.run(10_500.0, 9_900.0)
    assert rounds.tried == pytest.approx([0.1, 0.05]) and found.effect.shape.flat[1] == pytest.approx(0.05)
    third = rounds.run(10_500.0, 10_400.0, 9_900.0)
    assert rounds.tried == pytest.approx([0.1, 0.05, 0.02]) and third.effect.shape.flat[1] == pytest.approx(0.02)
    assert rounds.run(10_500.0, 10_400.0, 10_001.0) is None
