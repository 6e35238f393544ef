"""Left-out errors, intervals and lack of fit on a small campaign of pucks, against least squares done again."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2

from dummydesign.loop.fitting.fit import fit, fit_with_noise, prior_precision
from dummydesign.loop.fitting.noise import contrasts, repeat_scatter
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.material import UNDECLARED
from dummydesign.loop.selection import cross_validation, verdict
from dummydesign.loop.selection.cross_validation import (
    assess,
    base_intervals,
    effect_intervals,
    errors,
    expected_heldout_N,
    holds_null,
    interval,
    jackknife,
    lack_of_fit,
    leave_out,
    widened,
)
from tests.support import puck_presses as pucks
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit

BASE = len(UNDECLARED.mean)


@pytest.fixture(scope="module")
def offset_fit():
    """The campaign with an effect of the motion whose true size is zero."""
    found = clean_fit()
    effect = effect_named("contact_offset")
    vector = np.insert(found.vector, BASE, 0.1)
    near = fit_with_noise(CampaignProblem(found.problem.presses, pucks.LAW, (effect,)), vector, found.sizes)
    return replace(fit(near.problem, near.vector, near.sizes, 30, 1e-7), score=near.score)


def raw(found, vector=None):
    """Residuals of the raw samples in the bins, trial by trial."""
    presses = found.problem.presses
    modelled = found.problem.at_samples(found.vector if vector is None else vector)
    out = []
    for press, trial, model in zip(presses.presses, presses.trials, modelled):
        time = trial.trace.time_s
        inside = np.zeros(len(time), bool)
        for start, end in zip(press.start_s, press.end_s):
            inside |= (time >= start) & (time < end)
        out.append((trial.trace.force_N - model)[inside])
    return out


def test_errors_are_those_of_the_raw_samples_in_the_bins():
    found = clean_fit()
    left, said = raw(found), errors(found)
    assert said.by_trial_N == pytest.approx([np.sqrt(np.mean(one**2)) for one in left], rel=1e-9)
    assert said.train_N == pytest.approx(np.sqrt(np.mean(np.concatenate(left) ** 2)), rel=1e-9)


def test_left_out_errors_are_those_of_the_changed_vector_where_the_model_is_linear(offset_fit):
    presses = offset_fit.problem.presses
    said, changes = errors(offset_fit), leave_out(offset_fit, presses.cell)
    assert len(changes) == 8
    for cell, change in changes.items():
        moved = raw(offset_fit, offset_fit.vector + change)
        for row in np.flatnonzero(presses.cell == cell):
            assert said.heldout_by_trial_N[row] == pytest.approx(np.sqrt(np.mean(moved[row] ** 2)), rel=2e-3)
    counts = np.array([len(one) for one in moved])
    assert said.heldout_N == pytest.approx(np.sqrt(np.average(said.heldout_by_trial_N**2, weights=counts)), rel=1e-9)
    assert said.heldout_N > said.train_N


@pytest.mark.parametrize("by", ["cell", "pad"])
def test_leaving_presses_out_is_least_squares_without_them(offset_fit, by):
    presses, problem = offset_fit.problem.presses, offset_fit.problem
    whiten = offset_fit.whitener
    jacobian, residual = whiten(offset_fit.jacobian), whiten(offset_fit.residual)
    root = np.sqrt(prior_precision(problem, offset_fit.sizes))
    labels = getattr(presses, by)
    spread = np.sqrt(np.diag(offset_fit.covariance))
    for out, change in leave_out(offset_fit, labels).items():
        kept = labels != out
        rows = np.concatenate([jacobian[kept].reshape(-1, len(root)), np.diag(root)])
        left = np.r_[residual[kept].ravel(), -root * offset_fit.vector]
        wanted = np.linalg.lstsq(rows, left, rcond=None)[0]
        np.testing.assert_allclose(change / spread, wanted / spread, atol=0.1)
    assert assess(offset_fit).by_pad.heldout_N == pytest.approx(errors(offset_fit, presses.pad).heldout_N)


def test_presses_of_one_condition_are_left_out_one_by_one():
    found = clean_fit()
    one = replace(found, problem=replace(found.problem, presses=replace(found.problem.presses, cell=np.zeros(16, int))))
    each = errors(found, np.arange(16))
    np.testing.assert_array_equal(errors(one).heldout_by_trial_N, each.heldout_by_trial_N)
    assert np.isfinite(each.heldout_by_trial_N).all()


def test_of_a_single_pad_the_error_of_its_law_is_left_out_and_the_rest_is_fitted_again():
    """What only a law far from the stated one can follow is not predicted: then an effect may be."""
    found, count = clean_fit(), BASE
    vector = np.r_[found.vector[:count], np.full(len(found.vector) - count, 0.01)]
    (change,) = leave_out(replace(found, vector=vector), np.zeros(16, int)).values()
    np.testing.assert_array_equal(change[count:], -vector[count:])
    rows = found.whitener(found.jacobian).reshape(-1, len(vector))
    wanted = np.linalg.lstsq(rows[:, :count], rows[:, count:] @ vector[count:], rcond=None)[0]
    np.testing.assert_allclose(change[:count], wanted, rtol=1e-3, atol=1e-5)


def test_an_effect_that_the_rest_hardly_shows_leaves_its_presses_out_of_the_count():
    """All information on the offset in one cell but for a share: below a fifth the cell is not predicted."""
    found = clean_fit()
    problem = CampaignProblem(found.problem.presses, pucks.LAW, (effect_named("force_bias"),))
    for share, counted in ((0.15, False), (0.25, True)):
        columns = np.insert(np.zeros_like(found.columns), BASE, 0.0, axis=-1)
        weights = np.array([share / (1.0 - share), 1.0])
        columns[:2, 20, BASE] = np.sqrt(weights)
        columns[:, 10:15, :BASE] = np.eye(BASE)
        sizes = replace(found.sizes, noise=replace(found.sizes.noise, slow_N=1e-6, position_mm=1e-9))
        samples = problem.presses.samples[:2, 20]
        assert samples[0] == samples[1]
        vector = np.insert(found.vector, BASE, 0.1)
        made = replace(found, problem=problem, vector=vector, columns=columns, sizes=sizes)
        assert (1 in leave_out(made, np.arange(16))) is counted
        assert 5 in leave_out(made, np.arange(16))


def scatter_of(fit):
    """Scatter of the contact that the repeats of a fit show."""
    shown = repeat_scatter(fit.problem.presses, fit.residual, fit.slope, fit.forces, fit.sizes.noise)
    return shown[0] if shown else None


def test_what_is_expected_on_left_out_conditions_adds_up():
    found = clean_fit()
    presses, floor = found.problem.presses, found.sizes.floor_N
    own = replace(found.sizes, gain=0.0)
    nothing = replace(found, covariance=0.0 * found.covariance, slope=0.0 * found.slope, sizes=own)
    assert expected_heldout_N(nothing) == pytest.approx(floor)
    weight = presses.samples * presses.used
    one = np.zeros_like(found.covariance)
    one[0, 0] = 0.03**2
    gain = expected_heldout_N(replace(nothing, covariance=one)) ** 2 - floor**2
    # the first entry is the logarithm of the modulus: 3 % of the force
    assert gain == pytest.approx(np.average((0.03 * found.forces) ** 2, weights=weight), rel=0.01)
    for position in (0.002, 0.006, 0.03):
        sizes = replace(found.sizes, gain=0.0, noise=replace(found.sizes.noise, position_mm=position))
        moved = replace(found, covariance=0.0 * found.covariance, sizes=sizes)
        seen = min(position, scatter_of(moved), cross_validation.LARGEST[0])
        gain = expected_heldout_N(moved) ** 2 - floor**2
        assert gain == pytest.approx(np.average((seen * found.slope) ** 2, weights=weight))


def test_contact_scatter_is_read_off_the_shifts_between_repeats():
    """The second repeat of each condition lies deeper by d: their difference over sqrt 2 is shifted by d / sqrt 2."""
    found = clean_fit()
    second = (found.problem.presses.history.repeat == 2)[:, None]
    assert scatter_of(found) == pytest.approx(0.004, rel=0.02)
    for shift in (0.3, 0.6):
        moved = replace(found, residual=shift * found.slope * second)
        wanted = shift / np.sqrt(2.0) / np.sqrt(chi2.ppf(0.5, 1))
        assert scatter_of(moved) == pytest.approx(wanted, rel=0.05)
    # the repeats differ in scale alone: that is no shift
    scaled = replace(found, residual=0.05 * found.forces * second)
    assert scatter_of(scaled) < 0.02


def test_two_pairs_of_repeats_do_not_tell_the_scatter():
    found = clean_fit()
    few = replace(found.problem.presses, cell=np.r_[0, 1, np.arange(2, 8), 0, 1, np.arange(12, 18)])
    made = replace(found, problem=replace(found.problem, presses=few), residual=0.3 * found.slope)
    assert len(contrasts(few, made.residual)[0]) == 2
    assert scatter_of(made) is None and lack_of_fit(made).ratio is None and lack_of_fit(made).pairs == 2


def test_lack_of_fit_of_residuals_in_one_of_two_repeats_is_that_of_nothing():
    """Sums and differences are the same then: the ratio is that of bins to degrees of freedom, the chance one."""
    found = clean_fit()
    second = (found.problem.presses.history.repeat == 2)[:, None]
    one = lack_of_fit(replace(found, residual=found.residual * second))
    count = sum(len(part.force_N) for part in contrasts(found.problem.presses, found.residual)[0])
    assert one.ratio == pytest.approx(count / (count - len(found.vector))) and one.p == 1.0 and one.pairs == 8
    # a ratio knows no unit, and no order of the repeats
    twice = lack_of_fit(replace(found, residual=2.0 * found.residual))
    assert twice.ratio == pytest.approx(lack_of_fit(found).ratio) and twice.p == lack_of_fit(found).p
    same = lack_of_fit(replace(found, residual=found.residual + 0.3 * np.sqrt(np.maximum(found.forces, 0.0))))
    # all eight pairs to one side, by chance once in 2^8
    assert same.ratio > 2.0 and same.p == pytest.approx(2.0**-8, abs=0.002)


def test_a_shared_residual_on_bins_of_both_repeats_has_twice_its_square_in_the_sums():
    found = clean_fit()
    quiet = replace(found.sizes, noise=replace(found.sizes.noise, slow_N=1e-9, position_mm=1e-12))
    presses = found.problem.presses
    sign = np.where(presses.history.repeat == 2, -1.0, 1.0)[:, None]
    shape = pucks.NOISE_N / np.sqrt(np.maximum(presses.samples, 1.0))
    made = lack_of_fit(replace(found, sizes=quiet, residual=(2.0 + sign) * shape))
    count = sum(len(part.force_N) for part in contrasts(presses, found.residual)[0])
    # residuals of 3 and 1: their sum is 4, their difference 2
    assert made.ratio == pytest.approx(4.0 * count / (count - len(found.vector)), rel=1e-6)


def test_the_covariance_grows_by_what_is_stated(offset_fit):
    plain = widened(offset_fit)
    at = offset_fit.problem.fixed - 1
    own = np.zeros_like(plain)
    own[at, at] = (0.01 * offset_fit.vector[at]) ** 2
    larger = replace(offset_fit, vector=offset_fit.vector.copy())
    np.testing.assert_allclose(plain, plain.T)
    np.testing.assert_allclose(widened(larger, 0.7), plain, rtol=1e-9)
    np.testing.assert_allclose(widened(larger, 1.4) - own, 1.4 * (plain - own), rtol=1e-9, atol=1e-18)
    beyond = 1.6 * (plain - own) + own + jackknife(offset_fit)
    np.testing.assert_allclose(widened(larger, 1.6), beyond, rtol=1e-9, atol=1e-18)
    doubt = np.diag(np.linspace(0.0, 3e-4, len(plain)))
    with_doubt = widened(replace(offset_fit, doubt=doubt))
    np.testing.assert_allclose(with_doubt - plain, doubt, atol=1e-15)
    # never narrower than the normal interval of the fit at its own sizes
    assert np.all(np.diag(plain)[:BASE] >= 0.95 * np.diag(offset_fit.covariance)[:BASE])
    assert widened(replace(offset_fit, joined=True)) is offset_fit.covariance


def test_the_jackknife_is_that_of_the_textbook():
    found = clean_fit()
    changes = np.array([*leave_out(found, found.problem.presses.cell).values()])
    count = len(changes)
    wanted = (count - 1) * np.cov(changes.T, bias=True)
    np.testing.assert_allclose(jackknife(found), wanted, rtol=1e-9, atol=1e-18)
    two = replace(found.problem.presses, cell=np.repeat([0, 1], 8))
    assert not jackknife(replace(found, problem=replace(found.problem, presses=two))).any()


def bounded(at, low, high):
    return SimpleNamespace(
        problem=SimpleNamespace(bounds=lambda: (np.array([low]), np.array([high]))), vector=np.array([at])
    )


def test_an_interval_reaches_two_standard_deviations_within_the_bounds():
    cover = np.array([[0.25]])
    found = interval(bounded(1.0, -9.0, 9.0), cover, 0, lambda z: z)
    assert (found["low"], found["high"]) == pytest.approx((1.0 - 0.5 * 1.96, 1.0 + 0.5 * 1.96), abs=1e-4)
    assert found["value"] == 1.0 and found["determined"] and not found["at_bound"]
    falling = interval(bounded(1.0, -9.0, 1.5), cover, 0, lambda z: -z)
    assert (falling["low"], falling["high"]) == pytest.approx((-1.5, -0.02), abs=1e-3)
    for at, bound in ((-1.0, True), (2.0, True), (-0.99, False), (1.99, False)):
        assert interval(bounded(at, -1.0, 2.0), cover, 0, lambda z: z)["at_bound"] is bound
    assert interval(bounded(1.0, 0.0, 2.0), np.array([[-1e-20]]), 0, lambda z: z)["low"] == 1.0


def test_an_interval_over_more_than_two_decades_determines_nothing():
    for ratio, known in ((98.0, True), (102.0, False)):
        cover = np.array([[(np.log(ratio) / 2.0 / 1.959964) ** 2]])
        found = interval(bounded(0.0, -9.0, 9.0), cover, 0, lambda z: float(np.exp(z)))
        assert found["high"] / found["low"] == pytest.approx(ratio) and found["determined"] is known
        assert interval(bounded(0.0, -9.0, 9.0), cover, 0, lambda z: z)["determined"]


def test_intervals_of_base_and_effects_are_named_and_in_their_units(offset_fit):
    said = base_intervals(offset_fit, widened(offset_fit))
    base = offset_fit.base
    values = [1e3 * base.young_MPa, base.tau_s[0], base.beta[0], base.tau_s[1], base.beta[1]]
    assert [one["value"] for one in said.values()] == pytest.approx(values)
    truth = [1e3 * pucks.YOUNG_MPA, 0.07, 0.3, 1.5, 0.3]
    for one, true in zip(said.values(), truth):
        assert abs(np.log(one["value"] / true)) < np.log(one["high"] / one["low"])
    spread = np.sqrt(np.diag(widened(offset_fit)))[:BASE]
    for one, wide in zip(said.values(), spread):
        assert np.log(one["high"] / one["low"]) == pytest.approx(2.0 * 1.96 * wide, rel=1e-3)
    model = assess(offset_fit)
    effect = offset_fit.problem.effects[0]
    size = effect_intervals(model, effect)[effect.parameters[0].name]
    assert size["low"] < 0.0 < size["high"] and holds_null(model, effect) and not size["determined"]
    far = replace(offset_fit, vector=offset_fit.vector + np.eye(len(offset_fit.vector))[BASE] * 5.0)
    assert not holds_null(replace(model, fit=far), effect)
    assert effect_intervals(replace(model, fit=far), effect)[effect.parameters[0].name]["determined"]


def screened(*signatures):
    vectors = [np.array(one, float) for one in signatures]
    return [SimpleNamespace(signature=one / np.linalg.norm(one)) for one in vectors]


def test_the_threshold_is_the_quantile_of_the_largest_score():
    """Of one or of several that look the same that of chi-square of one degree; of n apart its n-th root."""
    one = screened([1.0, 0.0, 0.0])
    same = screened([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-2.0, 0.0, 0.0])
    apart = screened(*np.eye(12))
    for chosen, count in ((one, 1), (same, 1), (apart, 12)):
        wanted = chi2.ppf(0.999 ** (1.0 / count), 1)
        # the quantile of 4,000 draws scatters by 7 %
        assert verdict.gain_threshold(chosen, None, 0.0) == pytest.approx(wanted, rel=0.2)
    assert verdict.gain_threshold(same, None, 0.0) == pytest.approx(verdict.gain_threshold(one, None, 0.0), rel=0.15)
    assert verdict.gain_threshold(one, 3.0, 20.0) == 60.0 and verdict.gain_threshold(one, 0.5, 20.0) == 20.0


def errors_of(*squares):
    return SimpleNamespace(heldout_by_trial_N=np.sqrt(np.array(squares, float)))


@pytest.mark.parametrize(
    ("cells", "pads", "count", "better"),
    [
        (0.997, 1.5, 3, True),
        (0.999, 0.97, 3, True),
        (0.999, 0.99, 3, False),
        (1.015, 0.97, 3, True),
        (1.03, 0.5, 3, False),
        (1.03, 0.5, 1, True),
        (1.03, 0.9, 1, False),
        (1.35, 0.5, 1, False),
        (None, 0.97, 3, True),
        (None, 0.99, 3, False),
        (1.0, None, 3, False),
    ],
)
def test_an_effect_predicts_better_on_conditions_or_without_loss_there_on_pads(cells, pads, count, better, monkeypatch):
    """Two in a thousand of the square on conditions, two in a hundred on pads; of a single pad thirty in a hundred."""
    nothing = errors_of(np.nan, np.nan)

    def errors_without(fit, labels=None):
        share = cells if labels is None else pads
        assert labels in (None, "by pad")
        return nothing if share is None else errors_of(share, share)

    monkeypatch.setattr(verdict, "errors", errors_without)
    before = SimpleNamespace(errors=errors_of(1.0, 1.0), by_pad=errors_of(1.0, 1.0))
    after = SimpleNamespace(problem=SimpleNamespace(presses=SimpleNamespace(pad="by pad", pads=range(count))))
    assert verdict.predicts_better(before, after) is better


def test_a_size_is_at_its_bound_within_a_thousandth_of_its_range_but_not_at_null():
    effect = effect_named("contact_offset")
    size = effect.parameters[0]
    reach = size.high - size.low
    for value, bound in (
        (size.low + 0.95e-3 * reach, True),
        (size.low + 1.05e-3 * reach, False),
        (size.null, False),
        (size.high - 0.95e-3 * reach, True),
        (size.high - 1.05e-3 * reach, False),
    ):
        active = (SimpleNamespace(effect=effect, values={size.name: value}),)
        assert verdict.at_bound(SimpleNamespace(active=active)) is bound
    one_sided = effect_named("machine_compliance")
    size = one_sided.parameters[0]
    assert size.low == size.null
    active = (SimpleNamespace(effect=one_sided, values={size.name: size.null}),)
    assert not verdict.at_bound(SimpleNamespace(active=active))


def test_a_fit_without_noise_of_its_own_keeps_the_fast_arm_first():
    found = clean_fit()
    swapped = found.vector.copy()
    swapped[[1, 2, 3, 4]] = found.vector[[3, 4, 1, 2]]
    again = fit(found.problem, swapped, found.sizes)
    assert again.base.tau_s[0] < again.base.tau_s[1]
    np.testing.assert_allclose(again.vector[:BASE], found.vector[:BASE], atol=0.02)
