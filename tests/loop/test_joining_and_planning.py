"""A prior joined to a small campaign of pucks, and the presses that it plans next, against closed forms."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import chi2

from dummydesign.core.quantity import Quantity
from dummydesign.loop import next_measurement as next_module
from dummydesign.loop import planning
from dummydesign.loop.calibration import (
    Calibration,
    Model,
    Posterior,
    _shared,
    check_prior,
    join,
    model_of,
    posterior_of,
    with_prior_effects,
)
from dummydesign.loop.data.trials import BACK_MM_S, planned_trace
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.forward_model import LAW_TERMS, WAVES, Active, BaseParameters, LawError, parameter_names
from dummydesign.loop.model.material import ARM_TOLERANCE, UNDECLARED
from dummydesign.loop.next_measurement import HOLD_S, LUBRICATED, next_measurement, options, planned_presses
from dummydesign.loop.selection.cross_validation import widened
from dummydesign.measurement.sensor import Lowpass
from dummydesign.pad.tables.slab import load_table
from tests.support import puck_presses as pucks
from tests.support.known_laws import puck_law, slab_law
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit
from tests.support.refusal import raises_code

BASE = len(UNDECLARED.mean)


def prior_of(found, mean=None, covariance=None):
    own = posterior_of(found)
    changes = {name: value for name, value in (("mean", mean), ("covariance", covariance)) if value is not None}
    model = model_of(found)
    pad = {"resin": None, "ratio": 15.0}
    return Calibration(model, model, "none", {}, 0.03, pad, (), replace(own, **changes))


def test_two_normals_are_joined_by_their_precisions_and_arms_know_what_pours_differ_by():
    found = clean_fit()
    away = np.array([0.4, -0.5, 0.3, 0.2, -0.4]) * np.sqrt(np.diag(posterior_of(found).covariance)[:5])
    own = posterior_of(found)
    prior = prior_of(found, own.mean + away, 2.0 * own.covariance)
    joined, met = join(found, prior)
    here = widened(found)
    there = 2.0 * own.covariance + np.diag(np.r_[0.0, np.full(4, ARM_TOLERANCE)] ** 2)
    information = np.linalg.inv(here)
    information[:5, :5] += np.linalg.inv(there)
    covariance = np.linalg.inv(information)
    np.testing.assert_allclose(joined.covariance, covariance, rtol=1e-5, atol=1e-12)
    moved = covariance[:, :5] @ np.linalg.solve(there, away)
    np.testing.assert_allclose(joined.vector - found.vector, moved, atol=1e-9)
    together = here[:5, :5] + there
    assert met.used and joined.joined and met.chi2 == pytest.approx(away @ np.linalg.solve(together, away))
    assert met.p == pytest.approx(chi2.sf(met.chi2, 5))
    np.testing.assert_allclose(joined.forces, found.problem.predict(joined.vector))
    used = found.problem.presses.used
    np.testing.assert_allclose(joined.residual[used], (found.problem.presses.force_N - joined.forces)[used])
    assert met.shared == tuple(own.names)


@pytest.mark.parametrize(("chance", "used"), [(0.011, True), (0.009, False)])
def test_a_prior_contradicts_at_one_per_cent_and_what_differs_most_is_named(chance, used):
    found = clean_fit()
    own = posterior_of(found)
    here, there = widened(found)[:5, :5], own.covariance + np.diag(np.r_[0.0, np.full(4, ARM_TOLERANCE)] ** 2)
    away = np.zeros(5)
    away[0] = np.sqrt(chi2.isf(chance, 5) / np.linalg.inv(here + there)[0, 0])
    joined, met = join(found, prior_of(found, own.mean + away))
    assert met.used is used and met.p == pytest.approx(chance, rel=1e-6)
    if not used:
        assert joined is found and met.conflicts[0].startswith("young_kPa: ")
        before, now = (float(met.conflicts[0].split(word)[0].split()[-1]) for word in (" before", " now"))
        assert before / now == pytest.approx(np.exp(away[0]), rel=2e-3)
        told = float(met.conflicts[0].split("(")[1].split(" standard")[0])
        assert told == pytest.approx(away[0] / np.sqrt((here + there)[0, 0]), abs=0.06)


def test_all_that_differ_by_two_and_a_half_standard_deviations_are_named_largest_first():
    found = clean_fit()
    own = posterior_of(found)
    spread = np.sqrt(np.diag(widened(found))[:5] + np.diag(own.covariance) + np.r_[0.0, np.full(4, ARM_TOLERANCE)] ** 2)
    _, met = join(found, prior_of(found, own.mean + spread * [2.4, 2.6, 0.0, -9.0, 2.4]))
    assert [text.split(":")[0] for text in met.conflicts] == ["tau_2_s", "tau_1_s"]


def test_effects_of_the_pad_are_shared_in_their_own_units():
    effects = effect_named("temperature"), effect_named("contact_offset"), effect_named("strain_stiffening")
    problem = CampaignProblem(clean_fit().problem.presses, pucks.LAW, effects)
    names = (
        "temperature.modulus_loss_per_K",
        "contact_offset.offset_mm",
        *(f"{'log ' if p.log else ''}strain_stiffening.{p.name}" for p in effects[2].parameters),
    )
    names = (*parameter_names(2, ()), *names)
    rows = _shared(SimpleNamespace(problem=problem), names)
    assert rows[0] == (0, "log young_kPa", 1.0, pytest.approx(np.log(1e3)))
    taken = {name: (entry, unit, zero) for entry, name, unit, zero in rows[BASE:]}
    assert not any(name.startswith("contact_offset") for name in taken) and len(taken) >= 2
    for effect in (effects[0], effects[2]):
        for entry, p in zip(problem.entries[effect.name], effect.parameters):
            name = f"{'log ' if p.log else ''}{effect.name}.{p.name}"
            if name in taken:
                at, unit, zero = taken[name]
                for coordinate in (0.0, 0.7):
                    value = p.typical * np.exp(coordinate) if p.log else p.null + p.typical * coordinate
                    assert at == entry and zero + unit * coordinate == pytest.approx(np.log(value) if p.log else value)
    assert not _shared(SimpleNamespace(problem=problem), ())[1:]


def test_a_prior_of_another_ratio_is_refused_beyond_a_thousandth():
    prior = prior_of(clean_fit())
    for ratio, same in ((15.0148, True), (14.9852, True), (15.0152, False), (14.9848, False), (None, True)):
        campaign = SimpleNamespace(pad=SimpleNamespace(resin="a", ratio=ratio))
        if same:
            check_prior(prior, campaign)
            continue
        with raises_code("inconsistent", "prior.ratio"):
            check_prior(prior, campaign)
    other = replace(prior, pad={"resin": "b", "ratio": None})
    with raises_code("inconsistent", "prior.resin"):
        check_prior(other, SimpleNamespace(pad=SimpleNamespace(resin="a", ratio=15.0)))


def test_pads_of_both_campaigns_are_kept_with_the_newer_law_error():
    old = Model(BaseParameters(0.03, (0.1, 1.0), (0.3, 0.3)), (), (("", 5.0), ("", 10.0)), np.arange(6.0).reshape(3, 2))
    new = replace(old, pads=(("", 10.0), ("", 20.0)), law=-np.arange(6.0).reshape(3, 2)).with_pads_of(old)
    assert new.pads == (("", 5.0), ("", 10.0), ("", 20.0))
    np.testing.assert_array_equal(new.law, [[0.0, 0.0, -1.0], [2.0, -2.0, -3.0], [4.0, -4.0, -5.0]])


def test_a_law_error_is_linear_in_the_logarithm_of_thickness_of_its_own_shape():
    model = Model(BaseParameters(0.03, (0.1, 1.0), (0.3, 0.3)), (), (("", 5.0), ("", 20.0), ("crowned", 8.0)),
                  np.array([[0.01, 0.03, 0.5], [0.0, 0.1, 0.6], [0.2, 0.0, 0.7]]))  # fmt: skip
    at = np.array([1.0, 5.0, 10.0, 20.0, 90.0])
    error = model.law_error(at)
    np.testing.assert_allclose(error.terms[0], [0.01, 0.01, 0.02, 0.03, 0.03])
    np.testing.assert_allclose(error.terms[1], [0.0, 0.0, 0.05, 0.1, 0.1])
    np.testing.assert_allclose(error.terms[2], [0.2, 0.2, 0.1, 0.0, 0.0])
    mixed = model.law_error(np.array([10.0, 10.0, 10.0]), ("crowned", "boned", ""))
    np.testing.assert_allclose(mixed.terms[0], [0.5, 0.0, 0.02])
    # of a level a pad that was not pressed takes what is of the law
    part = replace(model, carried=0.25)
    np.testing.assert_allclose(part.law_error(at).terms[0], [0.0025, 0.01, 0.005, 0.03, 0.0075])
    np.testing.assert_allclose(part.law_error(at, cast=True).terms[0], 0.25 * error.terms[0])
    np.testing.assert_allclose(part.law_error(at).terms[1], error.terms[1])
    terms = np.zeros((LAW_TERMS, 1))
    terms[:3, 0] = 0.1, 0.2, 0.4
    held = LawError(terms, 0.4).factor(np.array([[0.2, 0.4, 0.8]]))
    assert held[0, 2] == held[0, 1] == pytest.approx(1.7) and held[0, 0] == LawError(terms).factor(
        held[:, :1] * 0 + 0.2
    )
    factor = LawError(terms).factor(np.array([[0.0, 0.2, 0.4, 0.8]]))
    np.testing.assert_allclose(factor[0], [1.1, 1.1 + 0.1 + 0.1, 1.7, 1.1 + 0.4 + 1.6])


def test_a_posterior_is_in_kilopascal_and_has_the_pads_own_scatter():
    found = clean_fit()
    own = posterior_of(found)
    assert own.mean[0] == pytest.approx(np.log(1e3 * found.base.young_MPa))
    np.testing.assert_allclose(own.mean[1:], found.vector[1:BASE])
    np.testing.assert_allclose(own.covariance, widened(found)[:BASE, :BASE])
    low, high = own.interval("log young_kPa")
    assert np.sqrt(low * high) == pytest.approx(1e3 * found.base.young_MPa)
    assert np.log(high / low) == pytest.approx(2.0 * 1.96 * own.young_spread, rel=1e-4)
    assert own.new_pad_spread == pytest.approx(np.hypot(own.young_spread, own.pads[0])) and own.pads[0] > 0.0
    plain = Posterior(("a.size", "log tau"), np.array([2.0, 0.0]), np.diag([0.25, 1.0]), (0.0, 0.0, 0.0))
    assert plain.interval("a.size") == pytest.approx((2.0 - 0.98, 2.0 + 0.98), abs=1e-3)
    assert plain.spread("log tau") == 1.0


@pytest.mark.parametrize(("velocity", "depth", "away"), [(250.0, 4.0, True), (2.0, 6.0, True), (50.0, 3.0, False)])
def test_a_planned_motion_holds_ten_seconds_and_goes_back_beyond_the_surface(velocity, depth, away):
    trace = planned_trace("a", velocity, depth, HOLD_S, away)
    time, x = trace.time_s, trace.displacement_mm
    assert np.all(np.diff(time) > 0.0) and x.max() == pytest.approx(depth) and not trace.force_N.any()
    # before contact at full speed, some way above the surface
    before = time < 0.0
    assert x[before] == pytest.approx(velocity * time[before])
    assert 0.05 <= -time[0] <= 0.1001 and x[0] >= -25.1
    held = time[x > depth - 1e-6]
    assert held[-1] - held[0] == pytest.approx(HOLD_S, abs=0.03)
    assert np.diff(time[time < held[0] + 0.35]).max() <= max(1e-3, held[0] / 500.0) + 1e-9
    assert np.diff(held).max() < 0.0251
    if away:
        back = time > held[-1]
        np.testing.assert_allclose(np.diff(x[back]) / np.diff(time[back]), -BACK_MM_S, rtol=1e-6)
        assert -2.1 < x[-1] < -1.9
    else:
        assert x[-1] == pytest.approx(depth)


def test_options_are_the_campaigns_pads_at_all_speeds_and_three_depths_with_circumstances_of_two():
    presses = clean_fit().problem.presses
    chosen = options(presses, pucks.LAW)
    plain = [one for one in chosen if not one.circumstance]
    # 8 and 12 mm were pressed; of half as high again and six tenths the plates' table holds the higher puck
    assert {one.thickness_mm: one.known for one in plain} == {8.0: True, 12.0: True, 18.0: False}
    assert {one.velocity_mm_s for one in plain} == {2.0, 4.7, 190.0}
    assert len(plain) == 3 * 3 * 3 and all(one.rest_s == 3600.0 for one in plain)
    shares = sorted({one.depth_share for one in plain})
    assert shares[0] == 0.1 and shares[1] == planning.DEEP and 0.4 < shares[2] < 0.48
    warm, old = presses.history.temperature_C.mean(), presses.history.age_days.max()
    assert all(one.temperature_C == pytest.approx(warm) and one.age_days == old for one in plain)
    others = [one for one in chosen if one.circumstance]
    (lubricated,) = [one for one in others if one.circumstance == LUBRICATED]
    assert lubricated.known and lubricated.thickness_mm == 8.0 and lubricated.velocity_mm_s == 2.0
    others.remove(lubricated)
    assert {one.thickness_mm for one in others} == {8.0, 12.0} and len(others) == 6
    assert {one.velocity_mm_s for one in others} == {190.0}
    assert sorted(one.rest_s for one in others) == [10.0, 10.0] + [3600.0] * 4
    assert {round(one.temperature_C - warm) for one in others} == {0, 10}
    assert {one.age_days / old for one in others} == {1.0, 3.0}
    silent = replace(
        presses, history=replace(presses.history, temperature_C=np.full(16, np.nan), age_days=np.full(16, np.nan))
    )
    assert len(options(silent, pucks.LAW)) == 27 + 1 + 2


def test_new_slabs_are_thinner_between_and_thicker_as_far_as_the_table_reaches():
    presses = clean_fit().problem.presses
    law = slab_law(7.9)
    low, high = (7.9 / ratio for ratio in reversed(load_table("bonded").ratio_range))
    new = sorted({one.thickness_mm for one in options(presses, law) if not one.known})
    assert new == [round(h, 1) for h in (5.6, 10.0, 15.6) if low <= h <= high]
    thin = slab_law(2.0 * 7.9)
    reach = tuple(2.0 * one for one in (low, high))
    assert sorted({one.thickness_mm for one in options(presses, thin) if not one.known}) == [
        h for h in (5.6, 10.0, 15.6) if reach[0] <= h <= reach[1]
    ]


def test_a_planned_press_is_the_next_one_on_its_pad():
    presses = clean_fit().problem.presses
    chosen = [one for one in options(presses, pucks.LAW) if one.depth_share == 0.3][:3]
    other = replace(chosen[0], thickness_mm=9.0, known=False, rest_s=77.0)
    made = planned_presses(presses, None, [*chosen, other])
    depths = [one.depth_share * one.thickness_mm for one in (*chosen, other)]
    np.testing.assert_allclose(made.depth_mm, depths, rtol=1e-6)
    assert made.history.sequence.tolist() == [17.0, 18.0, 19.0, 20.0]
    for row, option in enumerate((*chosen, other)):
        same = presses.thickness_mm == option.thickness_mm
        np.testing.assert_array_equal(made.history.earlier_depth_mm[row], np.where(same, presses.depth_mm, 0.0))
        np.testing.assert_array_equal(made.history.elapsed_s[row], np.where(same, option.rest_s, np.inf))
    assert "a new 9 mm pad to 2.7 mm" in other.text and "the 8 mm" in chosen[0].text


def test_a_prediction_knows_pressed_pads_as_the_fit_does_and_new_ones_as_their_prior():
    found = clean_fit()
    presses = found.problem.presses
    # the campaign's own presses: nothing but the fit
    forces, root = next_module._prediction(found, presses)
    np.testing.assert_allclose(forces, found.forces, atol=1e-9)
    for row in (0, 5):
        own = found.jacobian[row]
        np.testing.assert_allclose(root[row] @ root[row].T, own @ found.covariance @ own.T, rtol=1e-5, atol=1e-9)
    option = next(one for one in options(presses, pucks.LAW) if one.depth_share == 0.3)
    new = planned_presses(presses, None, [replace(option, thickness_mm=10.0, known=False)])
    forces, root = next_module._prediction(found, new)
    problem = CampaignProblem(new, pucks.LAW)
    vector = np.r_[found.vector[:BASE], np.zeros(LAW_TERMS)]
    np.testing.assert_allclose(forces, problem.predict(vector), atol=1e-9)
    jacobian = problem.spread(problem.jacobian(vector, forces))[0]
    spread = np.zeros((5 + LAW_TERMS,) * 2)
    spread[:5, :5] = found.covariance[:5, :5]
    spread[5:, 5:] = np.diag(np.repeat(np.square(found.sizes.law), [1, 1, 1, WAVES]))
    np.testing.assert_allclose(root[0] @ root[0].T, jacobian @ spread @ jacobian.T, rtol=1e-5, atol=1e-9)


def test_the_next_press_has_the_largest_gap_over_noise_and_doubt():
    """Two models that differ in the slow arm's time; each gap is solved anew with both covariances."""
    found = clean_fit()
    vector = found.vector.copy()
    vector[3] += 0.3
    other = replace(found, vector=vector, forces=found.problem.predict(vector))
    made = next_measurement(found, (other,), ("a", "b"), None)
    gaps = {}
    for option in options(found.problem.presses, pucks.LAW):
        planned = planned_presses(found.problem.presses, None, [option])
        one, first = next_module._prediction(found, planned)
        two, second = next_module._prediction(other, planned)
        law = np.zeros(LAW_TERMS)
        slope = CampaignProblem(planned, pucks.LAW).slope(np.r_[found.vector[:BASE], law], one)
        cover = planned.bins.covariance(found.sizes.noise, slope)[0]
        total = cover + first[0] @ first[0].T + second[0] @ second[0].T
        gaps[option.text] = float((one - two)[0] @ np.linalg.solve(total, (one - two)[0]))
    assert made.expected_gain == pytest.approx(max(gaps.values()), rel=0.02) and gaps[made.text] == max(gaps.values())
    listed = [gap for _, gap in made.alternatives]
    assert listed == sorted(listed, reverse=True) and len(listed) == 3 and listed[0] <= made.expected_gain
    assert [one.text for one in made.options] == [made.text, *(text for text, _ in made.alternatives)]
    for text, gap in made.alternatives:
        assert gap == pytest.approx(gaps[text], rel=0.02)


def test_a_plan_repeats_every_press_and_expects_the_force_near_the_end_of_its_hold():
    found = clean_fit()
    presses = found.problem.presses
    result = SimpleNamespace(after=SimpleNamespace(fit=found), next=None, presses=presses)
    plan = planning.plan_of(result, 2)
    # a height that was not pressed yet, slow and fast, twice each
    assert [one.sequence for one in plan] == [1, 2, 3, 4]
    assert {(one.option.thickness_mm, one.option.velocity_mm_s) for one in plan} == {(18.0, 2.0), (18.0, 190.0)}
    assert all(one.option.depth_share == planning.DEEP for one in plan) and len({one.file for one in plan}) == 4
    base = found.base
    for one in plan:
        h = one.option.thickness_mm
        steady = base.young_MPa * puck_law(pucks.DIAMETER_MM)(np.array([[0.3 * h]]), np.array([[h]]))[0, 0]
        # after ten seconds the arm of 1.5 s has left e^-6.6 of its strength
        left = 1.0 + base.beta[1] * np.exp(-(HOLD_S - 0.1) / base.tau_s[1])
        assert one.target_force_N == pytest.approx(steady * left, rel=2e-3)
    again = planning.plan_of(result, 2)
    assert [one.file for one in again] == [one.file for one in plan]


@pytest.mark.parametrize("law", [puck_law(30.0), slab_law(7.9, square=True)])
def test_the_depth_for_a_force_is_the_one_that_gives_it_within_the_law(law):
    for h in (6.0, 14.0):
        thickness = np.array([[h]])
        limit = law.law_of(("", h)).limit_mm
        for depth in (0.05 * h, 0.2 * h):
            area = float(law(np.array([[depth]]), thickness)[0, 0])
            assert planning.depth_for(law, h, area) == pytest.approx(depth, rel=2e-3)
        assert planning.depth_for(law, h, 1e9) == pytest.approx(0.98 * limit)
        assert planning.depth_for(law, h, 0.0) == 0.0


class Curve:
    """A relaxed force of 2 N/mm, known to a tenth of it below and a fifth above."""

    limit_mm = 3.0


@pytest.fixture
def simple(monkeypatch):
    """The steady force is 2 N/mm times the depth; the law of force and modulus have an interval each."""

    def moved(pad, motion, curve):
        force = 2.0 * float(motion.displacement_mm[-1])
        return SimpleNamespace(
            steady_force_N=force, force_low_N=np.array([0.9 * force]), force_high_N=np.array([1.2 * force])
        )

    def depth(pad, force, hold, motion_to, curve):
        if force > 2.0 * curve.limit_mm:
            raise planning.NoAnswerError("no_convergence", "too deep")
        if force < 0.01:
            raise planning.InputError("too small", "out_of_range", "force")
        return 0.5 * force

    monkeypatch.setattr(planning, "motion_on_curve", moved)
    monkeypatch.setattr(planning, "depth_for_steady_force", depth)
    material = planning.Material(Quantity(30.0, 27.0, 36.0, "fitted", ""), ())

    def expect(target, by_depth=False, thickness=10.0):
        row = SimpleNamespace(hold_s=10.0, velocity_mm_s=100.0, target=target, by_depth=by_depth)
        return planning._expected(row, SimpleNamespace(thickness_mm=thickness), Curve(), material)

    return expect


BELOW, ABOVE = np.exp(-np.hypot(np.log(0.9), np.log(0.9))), np.exp(np.hypot(np.log(1.2), np.log(1.2)))


def test_an_expected_press_has_the_interval_of_law_and_modulus_together(simple):
    force = simple(1.5, by_depth=True)
    assert (force.value, force.low, force.high) == pytest.approx((3.0, 3.0 * BELOW, 3.0 * ABOVE)) and force.by_depth
    depth = simple(3.0)
    # a softer pad is pressed deeper
    assert (depth.value, depth.low, depth.high) == pytest.approx((1.5, 1.5 / ABOVE, 1.5 / BELOW))
    assert depth.limit_mm == 3.0 and not depth.beyond and not depth.may_go_beyond
    assert set(depth.to_dict()) >= {"expected_depth_mm", "expected_depth_low_mm"}
    assert set(force.to_dict()) >= {"expected_force_N", "expected_force_high_N"}


def test_a_press_beyond_what_is_modelled_has_no_value_and_one_at_its_edge_may_go_beyond(simple):
    assert simple(3.0, by_depth=True).value == pytest.approx(6.0) and simple(3.01, by_depth=True).value is None
    deep = simple(6.5)
    assert deep.beyond and deep.value is None and deep.high is None and deep.low == pytest.approx(0.5 * 6.5 / ABOVE)
    edge = simple(5.8)
    assert edge.value == pytest.approx(2.9) and edge.high is None and edge.may_go_beyond and not edge.beyond
    touch = simple(0.005)
    assert (touch.value, touch.low, touch.high) == (0.0, 0.0, 0.0) and not touch.may_go_beyond
    # a thin pad is modelled to a share of its thickness
    thin = simple(2.0, by_depth=True, thickness=3.0)
    assert thin.limit_mm == pytest.approx(planning.MAX_DEPTH_OVER_THICKNESS * 3.0) and thin.beyond


def test_a_plan_that_is_written_has_the_pads_and_presses_of_the_plan_and_names_a_shape_where_it_is_another(tmp_path):
    from dummydesign.geometry.shape_registry import read_shape

    found = clean_fit()
    result = SimpleNamespace(after=SimpleNamespace(fit=found), next=None, presses=found.problem.presses)
    plan = planning.plan_of(result, 1)
    crown = read_shape("crowned:radius=21.2,height=2,foot=9.4")
    other = replace(plan[0], option=replace(plan[0].option, geometry=crown, temperature_C=None, unloading=False))
    own = plan[0].option.geometry
    pad = SimpleNamespace(
        shape="slab",
        geometry=own,
        young_kPa_nominal=30.0,
        resin=None,
        ratio=15.0,
        length_mm=60.0,
        width_mm=50.0,
        diameter_mm=None,
        base="bonded",
    )
    punch = SimpleNamespace(shape="square", side_mm=14.0, diameter_mm=None, contact="bonded", edge_radius_mm=0.0)
    campaign = SimpleNamespace(name="first", pad=pad, punch=punch, lowpass=Lowpass(35.0, 2, 1), force_resolution_N=0.0)
    files = planning.write_plan(tmp_path, campaign, (*plan[1:], other))
    read = tomllib.loads((tmp_path / planning.CAMPAIGN).read_text())
    assert len(read["trial"]) == len(plan) and read["pad"]["young_kPa_nominal"] == 30.0
    assert "resin" not in read["pad"] and "edge_radius_mm" not in read["punch"]
    assert read["sensor"]["lowpass_hz"] == 35.0 and "force_resolution_N" not in read["sensor"]
    for trial, press in zip(read["trial"], (*plan[1:], other)):
        assert trial["thickness_mm"] == press.option.thickness_mm and trial["file"] == press.file
        assert trial["target_force_N"] == pytest.approx(press.target_force_N, abs=0.005) and trial["hold_s"] == HOLD_S
        assert (trial.get("shape") == str(crown)) is (press is other) and ("shape" in trial) is (press is other)
        assert ("temperature_C" in trial) is (press is not other)
    head, *rows = (line.split(",") for line in (tmp_path / planning.SHEET).read_text().splitlines())
    assert len(rows) == len(plan) and set(files) == {"plan_campaign", "plan_sheet"}
    place = head.index("depth_mm")
    depths = [float(row[place]) for row in rows[:-1]]
    assert depths == pytest.approx([p.option.depth_share * p.option.thickness_mm for p in plan[1:]], rel=5e-3)


def test_effects_of_the_pad_come_from_a_prior_as_far_as_the_campaign_can_take_them():
    found = clean_fit()
    names = {
        "strain_stiffening": {"coefficient": 0.2, "exponent": 2.0},
        "contact_offset": {"offset_mm": 0.05},
        "compressibility": {"poisson_ratio": 0.49},
    }
    active = tuple(Active(effect_named(name), values) for name, values in names.items())
    prior = prior_of(found)
    assert with_prior_effects(found, prior) is found
    both = with_prior_effects(found, replace(prior, after=replace(prior.after, active=active)))
    # an offset is of the rig, and pucks between plates have no bulk that gives
    assert [effect.name for effect in both.problem.effects] == ["strain_stiffening"]
    spread = np.sqrt(np.diag(both.covariance))[BASE]
    assert abs(both.vector[BASE]) < 4.0 * spread and abs(both.vector[BASE]) < 0.2 / 0.3
    again = with_prior_effects(both, replace(prior, after=replace(prior.after, active=active)))
    assert again is both
