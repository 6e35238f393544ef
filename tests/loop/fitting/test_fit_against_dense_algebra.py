"""The fit of a campaign of pucks against the same normal distribution written out: whitening, likelihoods, slopes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.inference.noise import Noise
from dummydesign.loop.fitting import candidates
from dummydesign.loop.fitting.candidates import (
    EffectCandidate,
    Screened,
    first_fit,
    first_fits,
    modest,
    starts_of,
    to_the_end,
)
from dummydesign.loop.fitting.fit import (
    fit,
    prior_precision,
    same_noise,
    size_likelihood,
    start_vector,
    with_sizes,
)
from dummydesign.loop.fitting.noise import NoiseSizes, contrasts, estimate_slow_noise, make_whitener
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.forward_model import LAW_TERMS, SMOOTH_TERMS, WAVES, simulate_yielding
from dummydesign.loop.model.material import UNDECLARED
from tests.support import puck_presses as pucks
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit

BASE = len(UNDECLARED.mean)
LOW, HIGH = UNDECLARED.bounds()

NOISE = Noise(0.1, 0.05, 0.7, 0.02)


def dense(presses, noise, slope, row):
    """Covariance of the used bins of a trial: white by samples, slow by distance in time, contact scatter."""
    use = presses.used[row]
    start, end = presses.bins.start[row][use], presses.bins.end[row][use]
    samples, s = presses.samples[row][use], slope[row][use]
    middle, long = 0.5 * (start + end), end - start
    # mean of exp(-|t - u| / tau) over two bins: sinh factors apart, closed within one
    tau = noise.slow_time_s
    x = long / tau
    between = np.exp(-np.abs(middle[:, None] - middle) / tau) * np.outer(_sinhc(0.5 * x), _sinhc(0.5 * x))
    np.fill_diagonal(between, 2.0 * (x - 1.0 + np.exp(-x)) / x**2)
    cover = np.diag(noise.white_N**2 / samples) + noise.slow_N**2 * between
    return use, cover, cover + noise.position_mm**2 * np.outer(s, s)


def _sinhc(x):
    return np.sinh(x) / x


@pytest.mark.parametrize("row", [0, 2, 7])
def test_whitening_is_the_inverse_root_of_the_covariance(row):
    found = clean_fit()
    presses = found.problem.presses
    for with_position, place in ((True, 2), (False, 1)):
        whiten = make_whitener(presses, NOISE, (found.slope,) if with_position else (), (NOISE.position_mm,))
        cover = dense(presses, NOISE, found.slope, row)[place]
        use = presses.used[row]
        count = int(use.sum())
        units = np.zeros((*presses.used.shape, count))
        units[row][np.flatnonzero(use), np.arange(count)] = 1.0
        white = whiten(units)[row]
        inverse = np.linalg.inv(cover)
        np.testing.assert_allclose(white.T @ white, inverse, rtol=0.02, atol=0.01 * np.abs(inverse).max())
        np.testing.assert_allclose(whiten(units[..., 3])[row], white[:, 3])
        assert not whiten(units)[np.arange(16) != row].any()


def central(problem, vector, entry, step=1e-4):
    up, down = vector.copy(), vector.copy()
    up[entry] += step
    down[entry] -= step
    return (problem.predict(up) - problem.predict(down)) / (2.0 * step)


@pytest.mark.parametrize("names", [(), ("contact_offset",), ("machine_compliance",), ("temperature", "sensor_lag")])
def test_sensitivities_are_differences_of_predictions(names):
    """With and without an effect under which the set-up gives way, where law and base cannot share a solve."""
    found = clean_fit()
    effects = tuple(effect_named(name) for name in names)
    problem = CampaignProblem(found.problem.presses, pucks.LAW, effects)
    # within the bounds of every parameter, so that both sides can be looked at
    own = [p.to_coordinate(p.null) + 0.2 if p.of_form else 0.3 for effect in effects for p in effect.parameters]
    vector = np.insert(found.vector, BASE, own)
    vector[problem.fixed :] = 0.01 * np.cos(np.arange(len(vector) - problem.fixed))
    vector[problem.law_entries(SMOOTH_TERMS).start :] *= 0.1
    forces = problem.predict(vector)
    columns = problem.spread(problem.jacobian(vector, forces))
    # on the way back the contact lets go: there is no slope
    used = problem.presses.used & (problem.presses.label < 300)
    for entry in range(len(vector)):
        wanted = central(problem, vector, entry)
        if entry >= problem.law_entries(SMOOTH_TERMS).start:
            # waves step their relaxation from bin to bin
            off = np.linalg.norm((columns[..., entry] - wanted)[used])
            assert off < 0.1 * np.linalg.norm(wanted[used]) + 0.02 * forces.max()
            continue
        scale = np.abs(wanted[used]).max() + 1e-9
        np.testing.assert_allclose(columns[..., entry][used], wanted[used], atol=0.015 * scale)
    slope = (problem.predict(vector, -5e-4) - problem.predict(vector, 5e-4)) / 1e-3
    np.testing.assert_allclose(problem.slope(vector, forces)[used], slope[used], atol=0.02 * np.abs(slope).max())


def test_what_is_held_or_not_seen_has_no_sensitivity():
    presses = clean_fit().problem.presses
    assert CampaignProblem(presses, pucks.LAW).frozen() == []
    elastic = replace(
        presses,
        velocity_mm_s=np.full(16, 5.0),
        presses=tuple(replace(one, ramp=replace(one.ramp, hold_end_s=one.ramp.stop_time_s)) for one in presses.presses),
    )
    problem = CampaignProblem(elastic, pucks.LAW)
    assert problem.frozen() == list(range(1, BASE))
    assert not problem.jacobian(pucks.truth(), problem.predict(pucks.truth()))[..., list(range(1, BASE))].any()
    # relaxation of no account, and all of it before the arms are fitted
    assert np.exp(start_vector(problem, 0.04)[[0, 2, 4]]) == pytest.approx([0.04, 1e-3, 1e-3])


def test_the_vector_is_cut_where_it_was_joined():
    effects = effect_named("machine_compliance"), effect_named("contact_offset")
    problem = CampaignProblem(clean_fit().problem.presses, pucks.LAW, effects)
    counts = [len(effect.parameters) for effect in effects]
    assert problem.fixed == 5 + sum(counts) and [h for _, h in problem.presses.pads] == [8.0, 12.0]
    first, second = (problem.entries[effect.name] for effect in effects)
    assert (first.start, first.stop, second.start, second.stop) == (5, 5 + counts[0], 5 + counts[0], problem.fixed)
    vector = np.arange(float(problem.fixed + 2 * LAW_TERMS))
    error = problem.model(vector)[2]
    pad = problem.presses.pad
    for term, values in enumerate(error.terms):
        np.testing.assert_array_equal(values, vector[problem.law_entries(term)][pad])
        np.testing.assert_array_equal(values, problem.fixed + 2.0 * term + pad)
    low, high = problem.bounds()
    np.testing.assert_array_equal(low[:5], LOW)
    np.testing.assert_array_equal(high[:5], HIGH)
    assert np.all(low < high) and len(low) == len(vector)
    size = effects[1].parameters[0]
    at = second.start
    assert [size.to_value(end[at]) for end in (low, high)] == pytest.approx(sorted((size.low, size.high)))
    active = problem.active_of(np.zeros(len(vector)))
    assert [one.effect for one in active] == list(effects)
    assert active[1].values == {p.name: p.to_value(0.0) for p in effects[1].parameters}


def test_a_set_up_that_gives_way_balances_its_force():
    """Depth = travel - compliance x force, found for each node as a root."""
    found = clean_fit()
    effect = effect_named("machine_compliance")
    problem = CampaignProblem(found.problem.presses, pucks.LAW, (effect,))
    vector = np.insert(found.vector, BASE, [0.5, *(p.to_coordinate(p.null) for p in effect.parameters[1:])])
    model = problem.model(vector)
    forces, yielding = simulate_yielding(problem.presses, pucks.LAW, *model)
    wanted = effect.yielding(problem.presses, forces, model[1][0].values)
    np.testing.assert_allclose(yielding, wanted, atol=2e-5)
    assert yielding.max() > 0.01
    # from a start nearby the same balance is found
    near = simulate_yielding(problem.presses, pucks.LAW, *model, 0.0, 0.9 * yielding)
    np.testing.assert_allclose(near[0], forces, atol=1e-3)


def dense_score(found, scatter, law, restricted=True):
    """Minus twice the log likelihood of residuals at an optimum, by the full covariance of all bins."""
    problem, presses = found.problem, found.problem.presses
    noise = replace(found.sizes.noise, position_mm=scatter[0])
    whiten = make_whitener(presses, noise)
    jacobian = whiten(found.jacobian).reshape(-1, len(found.vector))
    fixed, random = jacobian[:, : problem.fixed], jacobian[:, problem.fixed :]
    residual = whiten(found.residual + found.jacobian[..., problem.fixed :] @ found.vector[problem.fixed :]).ravel()
    own = whiten(found.slope), whiten(np.where(presses.used, found.forces, 0.0))
    cover = np.eye(len(residual)) + (random * np.repeat(np.square(law), [2, 2, 2, 2 * WAVES])) @ random.T
    width = own[0].shape[1]
    for size, directions in zip(scatter, own):
        for row, along in enumerate(directions):
            at = slice(row * width, (row + 1) * width)
            cover[at, at] += size**2 * np.outer(along, along)
    solved = np.linalg.solve(cover, np.column_stack([fixed, residual]))
    known, pull = fixed.T @ solved[:, :-1], fixed.T @ solved[:, -1]
    chi2 = residual @ solved[:, -1] - pull @ np.linalg.solve(known, pull)
    return chi2 + np.linalg.slogdet(cover)[1] + restricted * np.linalg.slogdet(known)[1]


def prior_score(sizes, law_priors):
    medians, spreads = np.transpose([(0.008, 1.0), (5e-4, 1.0), *law_priors])
    return float(np.sum((np.log(sizes / medians) / spreads) ** 2))


def test_the_likelihood_of_the_sizes_is_that_of_the_normal_distribution():
    found = clean_fit()
    made = size_likelihood(found)
    trials = [np.array([0.003, 0.0004, 0.004, 0.01, 0.006, 0.001]), np.array([0.02, 0.002, 0.01, 0.004, 0.02, 0.003])]
    said = [made._score(made._terms(), sizes, True) for sizes in trials]
    wanted = [dense_score(found, one[:2], one[2:]) + prior_score(one, pucks.LAW.error_priors) for one in trials]
    assert said[1][0] - said[0][0] == pytest.approx(wanted[1] - wanted[0], abs=0.02)
    plain = [made._score(made._terms(), sizes, False)[0] for sizes in trials]
    without = [dense_score(found, one[:2], one[2:], False) + prior_score(one, pucks.LAW.error_priors) for one in trials]
    assert plain[1] - plain[0] == pytest.approx(without[1] - without[0], abs=0.02)
    # its gradient in the logarithms of the sizes
    for place in range(6):
        step = np.exp(1e-4 * np.eye(6)[place])
        up, down = (made._score(made._terms(), trials[0] * one, True)[0] for one in (step, 1.0 / step))
        assert said[0][1][place] == pytest.approx((up - down) / 2e-4, rel=1e-3, abs=1e-4)
    # variances of what is fitted, random columns integrated out
    likely = made.estimate(found.sizes)[0]
    best = made._score(made._terms(), likely.fitted, True)[0]
    assert all(best <= made._score(made._terms(), one, True)[0] for one in trials)


def test_variances_of_the_base_have_what_shifts_and_law_errors_hide():
    found = clean_fit()
    sizes = found.sizes.fitted
    variances = size_likelihood(found).variances(sizes)
    assert variances == pytest.approx(np.diag(found.covariance)[:BASE], rel=0.02)
    wider = size_likelihood(found).variances(sizes * [1.0, 1.0, 3.0, 1.0, 1.0, 1.0])
    # two pads: the modulus is known to the level over sqrt 2
    gain = wider[0] - variances[0]
    assert gain == pytest.approx(8.0 * found.sizes.law[0] ** 2 / 2.0, rel=0.1)


def test_covariance_and_chi2_are_those_of_the_linearised_normal_model():
    found = clean_fit()
    presses = found.problem.presses
    prior = prior_precision(found.problem, found.sizes)
    information, chi2 = np.diag(prior).copy(), float((prior * found.vector**2).sum())
    for row in range(16):
        whiten = found.whitener
        white = whiten(found.jacobian)[row]
        information += white.T @ white
        use, _, cover = dense(presses, found.sizes.noise, found.slope, row)
        chi2 += found.residual[row][use] @ np.linalg.solve(cover, found.residual[row][use])
    again = fit(found.problem, found.vector, found.sizes, 20, 1e-8)
    wanted = np.linalg.inv(information)
    spread = np.sqrt(np.diag(wanted))
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), spread, rtol=0.02)
    np.testing.assert_allclose(
        found.covariance / np.outer(spread, spread), wanted / np.outer(spread, spread), atol=0.02
    )
    assert again.chi2 == pytest.approx(chi2, rel=0.02)
    # nearby the optimum no vector fits better
    for entry in range(len(found.vector)):
        for sign in (-1.0, 1.0):
            vector = again.vector.copy()
            vector[entry] += sign * np.sqrt(found.covariance[entry, entry])
            moved = np.where(presses.used, presses.force_N - found.problem.predict(vector), 0.0)
            white = again.whitener(moved)
            assert float((white**2).sum() + (prior * vector**2).sum()) > again.chi2 + 0.3
    assert len(prior) == len(found.vector) and not prior[:BASE].any()
    np.testing.assert_allclose(prior[BASE:], np.repeat(np.array(found.sizes.law) ** -2.0, [2, 2, 2, 2 * WAVES]))


def test_slow_noise_is_found_as_large_and_as_slow_as_it_was_made():
    presses = pucks.pressed()
    found = clean_fit()
    chance = np.random.default_rng(6)
    truth = Noise(0.02, 0.06, 0.8, 0.0)
    factor = np.linalg.cholesky(presses.bins.covariance(truth, np.zeros(presses.used.shape)))
    sizes = []
    for _ in range(3):
        drawn = np.einsum("tij,tj->ti", factor, chance.normal(size=presses.used.shape)) * presses.used
        drawn = drawn + 0.02 * found.forces * chance.normal(size=(16, 1)) + 0.1 * np.sin(presses.label / 40.0)
        start = Noise(0.02, 0.03, 1.0, 0.01)
        noise = estimate_slow_noise(presses, drawn * presses.used, found.slope, found.forces, start)
        assert (noise.white_N, noise.position_mm) == (0.02, 0.01)
        sizes.append(noise.slow_N)
    assert np.mean(sizes) == pytest.approx(0.06, rel=0.2)
    single = replace(presses, cell=np.arange(16))
    drawn = np.einsum("tij,tj->ti", factor, chance.normal(size=presses.used.shape)) * presses.used
    own = estimate_slow_noise(single, drawn, found.slope, found.forces, Noise(0.02, 0.03, 1.0, 0.01))
    assert own.slow_N == pytest.approx(0.06, rel=0.5)
    # repeats that differ in scale and shift alone have no slow noise
    gains = found.forces * np.linspace(-0.03, 0.03, 16)[:, None] + found.slope * np.linspace(0.02, -0.01, 16)[:, None]
    quiet = estimate_slow_noise(presses, gains * presses.used, found.slope, found.forces, Noise(0.02, 0.03, 1.0, 0.01))
    assert quiet.slow_N < 0.005


def test_differences_of_repeats_are_over_root_two_and_end_before_the_way_back():
    found = clean_fit()
    presses = found.problem.presses
    parts, places = contrasts(presses, found.residual)
    for part, (first, second, a, b) in zip(parts, places):
        np.testing.assert_allclose(part.force_N, (found.residual[first, a] - found.residual[second, b]) / np.sqrt(2.0))
        np.testing.assert_array_equal(presses.label[first, a], presses.label[second, b])
        each = 1.0 / presses.samples[first, a] + 1.0 / presses.samples[second, b]
        np.testing.assert_allclose(1.0 / part.samples, 0.5 * each)
        assert presses.label[first, a].max() < 300 and np.all(np.diff(a) > 0)
        np.testing.assert_array_equal(part.start_s, presses.presses[first].start_s[a])
        np.testing.assert_array_equal(part.end_s, presses.presses[first].end_s[a])


def test_a_better_model_shows_the_noise_better_and_sizes_are_at_their_best():
    found = clean_fit()
    again = same_noise(found)
    assert again.sizes.noise.slow_N == pytest.approx(found.sizes.noise.slow_N, abs=5e-3)
    sized = with_sizes(found)
    assert (
        sized.score
        <= size_likelihood(found)._score(size_likelihood(found)._terms(), found.sizes.fitted, False)[0] + 0.01
    )
    wide = replace(found, sizes=NoiseSizes(replace(found.sizes.noise, position_mm=0.2), (0.1, 0.1, 0.1, 0.009), 0.05))
    kept = modest(wide)
    assert kept.sizes.law == tuple(median for median, _ in pucks.LAW.error_priors)
    assert kept.sizes.scatter == (0.02, 0.002)
    narrow = modest(
        replace(found, sizes=NoiseSizes(replace(found.sizes.noise, position_mm=0.001), (1e-3, 1e-3, 1e-3, 2e-4)))
    )
    assert narrow.sizes.law == (1e-3, 1e-3, 1e-3, 2e-4) and narrow.sizes.noise.position_mm == 0.001


def entry(name, gain=0.0, z=0.0):
    effect = SimpleNamespace(name=name, always_fitted=False, parameters=(None,))
    return EffectCandidate(effect, None, gain, Screened(effect, z, 0.0, np.zeros(1), np.zeros(1)))


def test_first_fits_near_the_best_are_fitted_to_the_end(monkeypatch):
    """Within 40 of the best; or among the first three with three tenths of it."""
    monkeypatch.setattr(candidates, "finished", lambda fit, one: replace(one, fit="finished"))
    rows = [entry("a", 1000.0), entry("b", 990.0), entry("c", 961.0), entry("d", 959.0), entry("e", 310.0)]
    ended = {one.effect.name for one in to_the_end(None, rows) if one.fit}
    assert ended == {"a", "b", "c"}
    ended = {one.effect.name for one in to_the_end(None, [entry("x", 290.0), *rows[3:], rows[0]]) if one.fit}
    assert ended == {"a", "d", "e"}
    assert [one.fit for one in to_the_end(None, [rows[0], entry("f", 290.0)])] == ["finished", None]
    assert [one.gain for one in to_the_end(None, rows[::-1])] == sorted((one.gain for one in rows), reverse=True)


def test_effects_that_cannot_win_are_not_fitted(monkeypatch):
    """At most twice the squared score is gained by one parameter, twenty times by several."""
    tried = []
    monkeypatch.setattr(candidates, "modest", lambda fit: fit)
    monkeypatch.setattr(
        candidates,
        "first_fit",
        lambda usual, one: tried.append(one.effect.name) or SimpleNamespace(score=1000.0 - gains[one.effect.name]),
    )
    gains = dict.fromkeys("abcdef", 100.0)
    base = SimpleNamespace(score=1000.0)

    def screened(*rows, several=()):
        made = []
        for name, z in rows:
            effect = SimpleNamespace(name=name, always_fitted=name == "f", parameters=(None,) * (1 + (name in several)))
            made.append(Screened(effect, z, 0.0, np.zeros(1), np.zeros(1)))
        monkeypatch.setattr(candidates, "screen", lambda usual, effects: made)

    def names(keep=7, least_z=2.0, least_gain=0.0):
        tried.clear()
        _, found = first_fits(base, (), keep, least_z, least_gain=least_gain)
        assert [one.gain for one in found] == [gains[one.effect.name] for one in found]
        return "".join(tried)

    screened(("a", 9.0), ("b", -8.0), ("c", 2.1), ("d", 1.9), ("e", -1.0))
    assert names() == "abc" and names(keep=2) == "ab"
    # a tenth of what the best has gained so far, when three were fitted
    screened(("a", 9.0), ("b", 8.0), ("c", 7.0), ("d", 2.3), ("e", 2.2))
    assert names() == "abcd"
    screened(("a", 9.0), ("b", 8.0), ("e", 2.2))
    assert names() == "abe"
    screened(("a", 9.0), ("b", 8.0), ("c", 7.0), ("d", 2.2), several=("d",))
    assert names() == "abcd"
    screened(("a", 9.0), ("b", 5.1), ("c", 4.9), ("d", 1.7), several=("d",))
    assert names(least_z=1.0, least_gain=50.0) == "abd"
    # one whose first-order change the base can imitate is fitted whatever its score, not below the least
    screened(("a", 9.0), ("b", 8.0), ("c", 7.0), ("f", 2.1))
    assert names(keep=3) == "abcf"


def test_a_first_fit_starts_from_where_the_effect_scored_best(monkeypatch):
    found = clean_fit()
    effect = effect_named("contact_offset")
    starts = []
    monkeypatch.setattr(
        candidates, "fit", lambda problem, vector, *_: starts.append(vector) or SimpleNamespace(chi2=1.0)
    )
    monkeypatch.setattr(candidates, "with_sizes", lambda fit: fit)
    for coordinate, begun in ((2.0, 2.0), (-30.0, -8.0), (30.0, 8.0), (0.04, 0.3), (0.06, 0.06), (-0.01, 0.3)):
        one = Screened(effect, 1.0, coordinate, np.zeros(1), starts_of(effect)[0])
        first_fit(found, one)
        assert starts[-1][BASE] == pytest.approx(begun)
        np.testing.assert_array_equal(np.delete(starts[-1], range(BASE, BASE + len(effect.parameters))), found.vector)


def test_starts_are_at_the_usual_size_toward_the_side_that_can_be():
    for name in ("contact_offset", "machine_compliance", "slow_relaxation_mode", "sensor_lag", "adhesion"):
        effect = effect_named(name)
        starts = starts_of(effect)
        first = effect.parameters[0]
        for start in starts:
            assert abs(start[0]) == 1.0 and first.to_value(start[0]) != first.null
            assert len(start) == len(effect.parameters)
            for p, value in zip(effect.parameters[1:], start[1:]):
                wanted = [p.typical if p.log or p.null == 0.0 else p.null, *p.starts]
                assert min(abs(p.to_value(value) - one) for one in wanted) < 1e-9
        combinations = np.prod([1 + len(p.starts) for p in effect.parameters[1:]], dtype=int)
        assert len(starts) == combinations
