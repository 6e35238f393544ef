"""Presses of linear and of power-law pads with one arm in closed form, and what a score makes of them."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.request import NAGOYA_PROTOCOL
from dummydesign.design.scoring import law_parameters, score
from dummydesign.design.scoring.law_parameters import (
    RATES,
    _flat,
    _nonnegative,
    _weights,
    fit_presses,
    gamma1_score,
    parametric_score,
)
from dummydesign.design.scoring.press_simulation import (
    SAMPLES,
    PadBatch,
    Sampling,
    SimulatedPress,
    SlabCurves,
    join_curves,
    join_slabs,
    make_curves,
    parabolic_work_mJ,
    press_to_depth,
    rest_after_hold,
    steady_depth,
)
from dummydesign.design.scoring.score import (
    Evaluation,
    closeness,
    evaluate,
    evaluated_gamma1,
    halving,
    steady_gamma1,
)
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import Deviations, Ranges, Readings, deviations
from dummydesign.measurement.motion import ramp_and_hold
from tests.support.slab_by_formula import LayerLaw, make_tissue

TAU, BETA = 0.2, 0.6
SMOOTH = Sampling(400, 200, 200)


def linear(stiffness=(20.0, 60.0), tau=(TAU,), beta=((BETA,), (0.3,)), power=1.0):
    """Two pads with F / E = c d^power to 8 mm, of moduli of 0.1 and 0.2 MPa."""
    depth = 8.0 * np.linspace(0.0, 1.0, SAMPLES) ** 1.0
    curves = SlabCurves(np.array([20.0, 24.0]), np.array([8.0, 8.0]), np.array(stiffness)[:, None] * depth**power)
    return PadBatch(curves, np.array([0, 1]), np.array([0.1, 0.2]), tau, np.array(beta))


def test_curves_are_looked_up_and_turned_round():
    slabs = linear(power=2.0)
    curves, rows = slabs.curves, np.array([1, 0, 1])
    depth = np.array([[0.5, 3.0], [1.0, 8.0], [2.0, np.nan]])
    area = curves.area_at(rows, depth)
    wanted = np.array([60.0, 20.0, 60.0])[:, None] * depth**2
    np.testing.assert_allclose(area, wanted, rtol=1e-3)
    assert np.isnan(area[2, 1])
    np.testing.assert_allclose(curves.depth_at(rows, wanted)[:2], depth[:2], rtol=1e-4)
    np.testing.assert_allclose(curves.depth_at(rows, wanted[:, 0]), depth[:, 0], rtol=1e-4)
    assert np.isnan(curves.depth_at(np.array([0]), np.array([[20.0 * 8.0**2 + 0.1]]))).all()
    slope = curves.slope_at(rows, depth)
    np.testing.assert_allclose(slope[:2], 2.0 * wanted[:2] / depth[:2], rtol=1e-3)
    # ends of the curve are held
    assert curves.area_at(np.array([0]), np.array([[-1.0, 99.0]])).tolist() == [[0.0, 20.0 * 64.0]]
    joined = join_curves([curves, curves.take(np.array([1]))])
    assert joined.thickness_mm.tolist() == [20.0, 24.0, 24.0]
    assert joined.step_mm[0] == pytest.approx(8.0 / (SAMPLES - 1))
    both = join_slabs([slabs, slabs.take(np.array([1]))])
    assert both.slab.tolist() == [0, 1, 2] and both.thickness_mm.tolist() == [20.0, 24.0, 24.0]


def test_a_press_of_a_linear_pad_has_its_arms_convolution():
    slabs, depth = linear(), np.array([2.0, np.nan])
    press = press_to_depth(slabs, depth, 50.0, SMOOTH)
    motion = ramp_and_hold(50.0, np.array([2.0, 8.0]), 10.0, 30000.0, 400, 200, 200)
    np.testing.assert_allclose(press.time_s, motion.time_s)
    time, x = press.time_s[0], motion.displacement_mm[0]
    fine = np.linspace(0.0, press.stop_s[0], 20001)
    rate = np.gradient(np.interp(fine, time, x), fine)

    def held(at):
        inside = fine <= at
        return np.trapezoid(np.exp(-(at - fine[inside]) / TAU) * rate[inside], fine[inside])

    for place in (100, 401, 550, press.stopped, press.stopped + 60, -1):
        wanted = 0.1 * 20.0 * (x[place] + BETA * held(time[place]))
        assert press.force_N[0, place] == pytest.approx(wanted, rel=2e-4)
    assert np.isnan(press.force_N[1]).all() and np.isnan(press.peak_N[1]) and press.peak_N[0] == press.force_N[0].max()
    assert press.stop_s[0] == pytest.approx(time[press.stopped]) and press.stopped == 600
    assert press.depth_mm[0] == 2.0 and np.isnan(press.depth_mm[1])


def test_energy_of_an_elastic_pad_is_its_integral_exactly():
    for power, coarse in ((1.0, Sampling(16, 8, 20)), (2.0, Sampling(16, 8, 20)), (2.0, Sampling(15, 8, 20))):
        slabs = linear(tau=(1e-9,), beta=((0.0,), (0.0,)), power=power)
        press = press_to_depth(slabs, np.array([2.0, 1.0]), 50.0, coarse)
        wanted = np.array([0.1 * 20.0 * 2.0 ** (power + 1.0), 0.2 * 60.0]) / (power + 1.0)
        np.testing.assert_allclose(press.energy_mJ, wanted, rtol=1e-3)


@pytest.mark.parametrize("count", [6, 7])
def test_work_by_parabolas_is_exact_for_parabolas_on_uneven_steps_and_lines_where_nothing_moves(count):
    x = np.cumsum(np.r_[0.0, 0.3 + 0.2 * np.sin(np.arange(count - 1.0))])
    force = 2.0 + x + 0.5 * x**2
    whole = 2.0 * x[-1] + 0.5 * x[-1] ** 2 + x[-1] ** 3 / 6.0
    odd = count % 2 == 0
    last = np.trapezoid(force[-2:], x[-2:]) - (
        2.0 * np.diff(x[-2:])[0] + 0.5 * np.diff(x[-2:] ** 2)[0] + np.diff(x[-2:] ** 3)[0] / 6.0
    )
    assert parabolic_work_mJ(x[None], force[None])[0] == pytest.approx(whole + odd * last)
    still = np.array([[0.0, 1.0, 1.0, 2.0, 2.0]])
    assert parabolic_work_mJ(still, np.array([[0.0, 2.0, 3.0, 5.0, 9.0]]))[0] == pytest.approx(1.0 + 4.0)


@pytest.mark.parametrize("exact", [False, True])
def test_a_steady_depth_carries_its_force_at_the_end_of_the_hold(exact):
    """With an arm of 30 s a fifth of it is left after ten seconds: pressed to that depth, the pad shows the force."""
    slabs = linear(tau=(TAU, 30.0), beta=((0.5, 0.3), (0.2, 0.4)))
    forces, speeds = np.array([4.0, 8.0]), np.array([20.0, 200.0])
    depth = steady_depth(slabs, forces, speeds, Sampling(), exact)
    assert depth.shape == (2, 2)
    for column, (force, speed) in enumerate(zip(forces, speeds)):
        press = press_to_depth(slabs, depth[:, column], speed, Sampling())
        # the formula takes the braking for a sudden stop
        np.testing.assert_allclose(press.force_N[:, -1], force, rtol=1e-6 if exact else 2e-3)
    assert steady_depth(slabs, 4.0, 20.0, Sampling(), exact) == pytest.approx(depth[:, 0], rel=1e-6)
    alone = steady_depth(slabs.take(np.array([1])), forces, speeds, Sampling(), exact)
    np.testing.assert_array_equal(alone[0], depth[1])
    short = steady_depth(slabs, np.array([4.0]), 20.0, Sampling(hold_s=0.05), exact)
    assert np.all(short[:, 0] < depth[:, 0])


def test_what_is_left_of_slow_arms_brings_a_force_into_reach():
    slabs = linear(tau=(1e4,), beta=((0.5,), (0.5,)))
    limit = 0.1 * 20.0 * 8.0
    assert np.isfinite(steady_depth(slabs, 1.4 * limit, 500.0, Sampling())[0])
    assert np.isnan(steady_depth(slabs, 1.6 * limit, 500.0, Sampling())[0])
    quick = linear()
    assert np.isnan(steady_depth(quick, 1.01 * limit, 500.0, Sampling())[0])
    assert steady_depth(quick, 0.99 * limit, 500.0, Sampling())[0] == pytest.approx(0.99 * 8.0)


def test_a_pad_that_cannot_be_pressed_keeps_the_whole_arm():
    """The rise lasts no time: what is left is the step's."""
    with np.errstate(all="raise"):
        left = rest_after_hold(np.array([[0.5]]), (30.0,), np.zeros((1, 1)), np.array([500.0]), Sampling(hold_s=10.0))
    assert left[0, 0] == pytest.approx(1.0 + 0.5 * np.exp(-10.0 / 30.0))


def test_samples_of_a_press_weigh_half_in_the_rise_and_half_in_the_logarithm_of_the_hold():
    press = press_to_depth(linear(), np.array([2.0, 3.0]), 50.0, Sampling())
    weights = press.sample_weights
    counted = press.counted
    np.testing.assert_allclose(weights.sum(axis=1), 1.0)
    rising = counted <= press.stopped
    time, since = press.time_s[:, counted], press.time_s[:, counted] - press.stop_s[:, None]
    for row in (0, 1):
        # the share of the rise before half of it is a quarter, that of the hold in ln t from 5 ms on
        early = rising & (time[row] < 0.5 * press.stop_s[row])
        assert weights[row][early].sum() == pytest.approx(0.25, abs=0.02)
        middle = np.sqrt(0.005 * since[row, -1])
        late = ~rising & (since[row] < middle)
        assert weights[row][late].sum() == pytest.approx(0.25, abs=0.04)
    assert not np.any((since[0] > 1e-9) & (since[0] < 0.003))


def test_curves_of_a_law_end_at_the_gels_compression_or_the_laws_end():
    class Held(LayerLaw):
        share = 0.4

        def depth_limit_mm(self, thickness_mm, radius_mm):
            return self.share * np.asarray(thickness_mm)

    law = Held()
    made = make_curves(law, np.array([10.0, 20.0]), 7.9, 0.6)
    np.testing.assert_allclose(made.limit_mm, [4.0, 8.0])
    far = Held()
    far.share = 0.9
    np.testing.assert_allclose(make_curves(far, 10.0, 7.9, 0.6).limit_mm, [10.0 * verdict_limits().gel_compression])
    depth = np.array([[1.0, 3.0], [2.0, 7.0]])
    wanted = law.force(depth, np.array([[10.0], [20.0]]), 1.0, 7.9)
    np.testing.assert_allclose(made.area_at(np.array([0, 1]), depth), wanted, rtol=1e-4)


def test_closeness_halves_each_half_width_and_counts_what_is_out_of_reach():
    np.testing.assert_allclose(halving(np.array([0.0, 1.0, -1.0, 2.0, np.nan])), [1.0, 0.5, 0.5, 0.25, 0.0])
    distance = np.array([[1.0, -1.0], [0.0, np.sqrt(2.0)], [1.0, np.nan], [np.nan, np.nan]])
    np.testing.assert_allclose(closeness(distance), [0.5, 0.5, 0.25, 0.0])


@pytest.fixture(scope="module")
def targets():
    return make_targets(make_tissue(), "average", Sampling())


def test_an_aims_own_distances_are_none_and_a_factor_in_depth_is_its_logarithm(targets):
    protocol = targets.protocol
    lows, steady = protocol.low_grid_N, protocol.steady_grid_N
    reached = targets.aim_depth_mm(np.concatenate([lows, steady]))
    presses = tuple(
        SimpleNamespace(peak_N=np.array([one.aim_peak_N]), depth_mm=np.array([1.0])) for one in targets.conditions
    )

    def scored(factor, peak=1.0, low=1.0, share=0.25):
        own = np.r_[low * reached[: len(lows)], factor * reached[len(lows) :]][None]
        pressed = tuple(SimpleNamespace(peak_N=peak * one.peak_N, depth_mm=one.depth_mm) for one in presses)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(score, "press_all", lambda *_: (own, pressed))
            patch.setattr(score, "_inside_at_samples", lambda press, band: np.array([share]))
            return evaluate(None, targets)

    whole = scored(1.0)
    assert whole.aim[0] == pytest.approx(1.0)
    assert whole.force_variation_range[0] == 0.25 and whole.steady_state_range[0] == 1.0
    away = np.exp(targets.depth_half_width)
    assert scored(away).aim[0] == pytest.approx(0.5 * (0.5 + 1.0)) and scored(1.0 / away).aim[0] == pytest.approx(0.75)
    assert scored(1.0, low=away).aim[0] == pytest.approx(1.0)
    wide = np.array([one.peak_half_width for one in targets.conditions])
    rms = np.sqrt(np.mean((0.2 / wide) ** 2))
    assert scored(1.0, peak=np.exp(0.2)).aim[0] == pytest.approx(0.5 * (1.0 + 0.5**rms))
    weights = targets.weights.parts
    total = whole.total(np.array([0.3]))[0]
    parts = {"parametric": 0.3, "aim": 1.0, "steady_state_range": 1.0, "force_variation_range": 0.25}
    assert total == pytest.approx(sum(weight * parts[name] for name, weight in weights.items()))


def slabs_of(count=5):
    curves = make_curves(LayerLaw(), np.linspace(8.0, 16.0, count), 7.9, 0.6)
    return PadBatch(
        curves, np.arange(count), np.linspace(0.02, 0.08, count), (0.08, 1.2), np.tile([0.3, 0.2], (count, 1))
    )


def test_scores_are_the_same_for_each_design_alone(targets):
    slabs = slabs_of()
    whole = evaluate(slabs, targets)
    for index in range(5):
        one = evaluate(slabs.take(np.array([index])), targets)
        for name in ("aim", "steady_state_range", "force_variation_range", "low_force_range", "depth_mm"):
            np.testing.assert_allclose(getattr(one, name)[0], getattr(whole, name)[index], rtol=1e-9)
    exact = evaluate(slabs, targets, Sampling(), exact=True)
    np.testing.assert_allclose(exact.aim, whole.aim, atol=0.01)
    np.testing.assert_allclose(exact.force_variation_range, whole.force_variation_range, atol=0.08)
    np.testing.assert_allclose(exact.steady_state_range, whole.steady_state_range, atol=0.03)
    kept = whole.take(np.array([2, 0]))
    np.testing.assert_array_equal(kept.aim, whole.aim[[2, 0]])
    assert kept.presses == () and kept.slabs.slab.tolist() == [2, 0]
    # each press carries its force in the end
    for column, condition in enumerate(targets.conditions):
        known = np.isfinite(whole.depth_mm[:, column])
        force = whole.presses[column].force_N[known, -1]
        np.testing.assert_allclose(force, condition.steady_force_N, rtol=5e-3)
    reach = np.isfinite(whole.depth_mm[:, [1, 4]]).all(axis=1)
    np.testing.assert_array_equal(whole.feasible, reach)


def test_a_press_between_the_subjects_is_inside_throughout_and_one_per_cent_beyond_still_is(targets):
    """The aim's own curve as a pad's: all inside; stiffer by the band's width, none of it."""
    condition = targets.conditions[1]
    band, aim = condition.range, condition.aim
    time = np.r_[np.linspace(0.0, aim.stop_s[0], 61), aim.stop_s[0] + np.geomspace(1e-4, 9.9, 80)]
    curve = np.interp(time, aim.time_s, aim.curves_N[0])
    top = np.interp(time, band.time_s, band.high_N)

    def share(force):
        press = SimulatedPress(time[None], force[None], aim.stop_s[:1], np.array([1.0]), None, 60)
        return score._inside_at_samples(press, band)[0]

    assert share(curve) == pytest.approx(1.0)
    near = score.STEADY_TOLERANCE * band.steady_force_N
    assert share(top + 0.99 * near) == pytest.approx(1.0) and share(top + 1.01 * near) < 0.02
    half = np.where(time <= aim.stop_s[0], curve, 9.0 * curve)
    assert share(half) == pytest.approx(0.5, abs=0.02)


def test_gamma1_of_steady_forces_is_least_squares():
    slabs = slabs_of()
    found = steady_gamma1(slabs)
    depth = steady_depth(slabs, np.array(NAGOYA_PROTOCOL.forces_N), NAGOYA_PROTOCOL.slow_mm_s)
    for row, value in zip(depth, found):
        known = np.isfinite(row)
        if not known.any():
            assert np.isnan(value)
            continue
        cube = row[known] ** 3
        assert value == pytest.approx(
            np.linalg.lstsq(cube[:, None], np.array(NAGOYA_PROTOCOL.forces_N)[known], rcond=None)[0][0]
        )
    square = steady_gamma1(slabs, power=2.0)
    assert np.nanmax(np.abs(square / found - 1.0)) > 0.1


def ranges(**more):
    given = {
        "force_N": np.array([5.0, 10.0]),
        "velocity_mm_s": np.array([10.0, 250.0]),
        "peak_low_N": np.array([6.0, 12.0]),
        "peak_high_N": np.array([8.0, 16.0]),
        "energy_low_mJ": np.array([2.0, 6.0]),
        "energy_high_mJ": np.array([4.0, 9.0]),
        "steady_N": np.array([5.0, 7.0, 10.0]),
        "stiff_mm": np.array([1.0, 1.2, 1.5]),
        "soft_mm": np.array([2.0, 2.2, 2.5]),
        "subjects": 3,
    }
    return Ranges(**{**given, **more})


def test_deviations_are_ratios_over_the_outermost_subject_and_their_largest():
    readings = Readings(np.array([5.0, 17.0]), np.array([5.0, 6.0]), np.array([0.9, 2.4, 2.0]))
    found = deviations(ranges(), readings)
    np.testing.assert_allclose(found.short["peak"][0], [6.0 / 5.0, 12.0 / 17.0])
    np.testing.assert_allclose(found.above["peak"][0], [5.0 / 8.0, 17.0 / 16.0])
    np.testing.assert_allclose(found.short["energy"][0], [0.4, 1.0])
    np.testing.assert_allclose(found.above["energy"][0], [1.25, 6.0 / 9.0])
    np.testing.assert_allclose(found.short["steady"][0], (np.array([0.9, 2.4, 2.0]) / [2.0, 2.2, 2.5]) ** 3)
    np.testing.assert_allclose(found.above["steady"][0], (np.array([1.0, 1.2, 1.5]) / [0.9, 2.4, 2.0]) ** 3)
    assert found.shortfall[0] == pytest.approx((2.4 / 2.2) ** 3)
    assert found.worst(found.short) == (pytest.approx((2.4 / 2.2) ** 3), "steady", 1)
    assert found.worst(found.above)[1:] == ("steady", 0) and found.over[0] == found.worst(found.above)[0]
    strict = deviations(ranges(strict=True), readings)
    assert "energy" not in strict.short
    np.testing.assert_allclose(strict.short["peak"][0], [8.0 / 5.0, 16.0 / 17.0])
    energy = Readings(np.array([7.0, 14.0]), np.array([1.0, 7.0]), np.array([1.5, 1.7, 2.0]))
    told = deviations(ranges(), energy)
    assert told.shortfall[0] == 2.0 and told.force_shortfall[0] < 1.0
    lost = deviations(ranges(), replace(energy, peak_N=np.array([np.nan, 14.0])))
    assert not lost.reached[0] and told.reached[0]
    nothing = Deviations(ranges(), {"peak": np.full((1, 2), np.nan)}, {}, np.array([False]))
    assert np.isnan(nothing.shortfall[0]) and np.isnan(nothing.worst(nothing.short)[0])


def test_parameters_are_close_by_half_widths_of_their_own_bands(targets):
    aim = targets.parameters
    assert parametric_score([aim, None], targets) == pytest.approx([1.0, 0.0])
    flat = _flat(aim.to_dict())
    bands = [_flat(one.parameters.to_dict()) for one in targets.tissue.subjects]
    one = targets.tissue.subjects[0].parameters
    values = _flat(one.to_dict())
    parts = []
    for name, wanted in flat.items():
        own = [band[name] for band in bands]
        half = 0.5 * np.log(max(own) / min(own))
        parts.append(0.5 ** abs(np.log(values[name] / wanted) / half))
    assert parametric_score([one], targets)[0] == pytest.approx(np.mean(parts))
    # all bands are those of gamma1 here
    half = 0.5 * np.log(2.2 / 0.8)
    gamma = targets.steady_gamma1_N_per_mm3 * np.exp(np.array([0.0, half, -2.0 * half]))
    np.testing.assert_allclose(gamma1_score(gamma, targets), [1.0, 0.5, 0.25], rtol=1e-6)


def test_weights_of_a_fit_are_one_for_the_rise_and_one_for_the_hold():
    time = np.array([np.r_[np.linspace(0.0, 0.1, 40), 0.1 + np.geomspace(1e-4, 10.0, 60)]])
    square = _weights(time, np.array([0.1])) ** 2
    rise, late = time[0] <= 0.1, time[0] > 0.1 + 1.9e-3
    assert square[0][rise].sum() == pytest.approx(1.0) and square[0][~rise].sum() == pytest.approx(1.0)
    assert not square[0][~rise & ~late].any()
    assert square[0][rise & (time[0] < 0.05)].sum() == pytest.approx(0.5, abs=0.03)
    assert square[0][late & (time[0] < 0.1 + np.sqrt(0.002 * 10.0))].sum() == pytest.approx(0.5, abs=0.05)


def test_springs_are_the_best_that_are_not_negative():
    from scipy.optimize import nnls

    chance = np.random.default_rng(2)
    matrix, right = chance.normal(size=(40, 12, 3)), chance.normal(size=(40, 12))
    found = _nonnegative(matrix, right)
    for one, wanted, own in zip(matrix, right, found):
        best = nnls(one, wanted)[0]
        np.testing.assert_allclose(own, best, atol=1e-7 * max(best.max(), 1e-9) + 1e-12)


def test_the_law_of_a_tissue_is_recovered_from_presses_that_it_made(targets, monkeypatch):
    """Presses of a subject's own law in place of a pad's: its parameters are found again."""
    truth = targets.tissue.subjects[2].parameters

    def pressed(slabs, depth, velocity, sampling):
        motion = sampling.motion(velocity, depth)
        drive = law_parameters.law_named(targets.tissue.law).drive(
            SimpleNamespace(time_s=motion.time_s[:, None], displacement_mm=motion.displacement_mm[:, None])
        )
        force = truth.gamma1_N_per_mm3 * drive.elastic
        for gamma, damper in zip(truth.gamma_N_per_mm3, truth.dampers_at(velocity)):
            force = force + gamma * drive.arm(np.full((len(depth), 1, 1), gamma / damper)[..., 0])
        stop = motion.time_s[:, sampling.stopped]
        return SimpleNamespace(depth_mm=depth, force_N=force[:, 0], stop_s=stop, time_s=motion.time_s)

    monkeypatch.setattr(law_parameters, "press_to_depth", pressed)
    depth = np.tile([[1.2, 1.6, 2.0, 1.1, 1.5, 1.9]], (2, 1))
    depth[1, :3] = np.nan
    found, none = fit_presses(slabs_of(2), targets, depth, Sampling())
    assert none is None and found is not None
    values, wanted = _flat(found.to_dict()), _flat(truth.to_dict())
    for name in wanted:
        assert values[name] == pytest.approx(wanted[name], rel=0.03)
    assert RATES[0] < 1.0 < RATES[1]


def test_gamma1_of_an_evaluation_is_that_of_its_slow_presses():
    forces = np.array(NAGOYA_PROTOCOL.forces_N)
    depth = np.array([[1.0, 2.0, np.nan, 9.0, 9.0, 9.0]])
    empty = np.zeros(1)
    made = Evaluation(None, empty, empty, empty, empty, empty, depth, empty, empty, (), NAGOYA_PROTOCOL, None, None)
    cube = np.array([1.0, 8.0])
    assert evaluated_gamma1(made)[0] == pytest.approx((cube @ forces[:2]) / (cube @ cube))
    assert made.feasible.tolist() == [True]


def test_depths_of_subjects_that_still_relax_go_on_below_the_known_forces_with_their_power():
    """In a hold of a third of a second nobody has settled: depths are tabulated, and go on straight in logarithms."""
    quick = make_targets(make_tissue(), "average", Sampling(hold_s=0.3))
    assert not quick.settled
    known, _ = quick._held_curves
    first = float(np.exp(known[0]))
    forces = first * np.array([1e-3, 0.1, 0.5, 1.0, 1.0 + 1e-9, np.exp(known[1] - known[0])])
    for depth in (quick.aim_depth_mm(forces), *quick.depth_range_mm(forces)):
        slope = np.log(depth[-1] / depth[3]) / np.log(forces[-1] / forces[3])
        assert 0.2 < slope < 0.5
        np.testing.assert_allclose(depth[:3], depth[3] * (forces[:3] / first) ** slope, rtol=1e-6)
    stiff, soft = quick.depth_range_mm(np.array([5.0, 10.0]))
    aim = quick.aim_depth_mm(np.array([5.0, 10.0]))
    assert np.all(stiff < aim) and np.all(aim < soft)
    # held for longer they are deeper under the same force
    long = make_targets(make_tissue(), "average", Sampling())
    assert np.all(long.aim_depth_mm(np.array([5.0, 10.0])) > aim)


def test_work_where_the_punch_waits_is_that_of_straight_lines():
    """A linear force, with samples at the same place in either half of a pair and in both."""
    displacement = np.array([[0.0, 0.0, 0.4, 0.4, 0.4, 1.0, 1.0], [0.0, 0.5, 0.5, 0.7, 0.9, 0.9, 1.0]])
    work = parabolic_work_mJ(displacement, 3.0 * displacement)
    assert work == pytest.approx([1.5, 1.5])
