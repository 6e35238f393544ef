"""The forward chain and each effect: limits, closed forms, and the base when an effect is absent."""

from __future__ import annotations

import inspect
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dummydesign.loop import check_effect, effects
from dummydesign.loop.effects.registry import EFFECTS
from dummydesign.loop.model.effect import Arm
from dummydesign.loop.model.forward_model import Active, BaseParameters, readings, relax, simulate
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.tables import puck as puck_shapes
from dummydesign.pad.tables import puck as puck_table
from dummydesign.pad.tables.puck import grip, table_for
from dummydesign.pad.tables.slab import load_table
from tests.support.known_laws import puck_law
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

BASE = BaseParameters(0.025, (0.06, 1.4), (0.3, 0.25))
ON_SLABS = [effect for effect in EFFECTS if effect.name != "plate_friction"]


def values_of(name, **changes):
    effect = effect_named(name)
    return Active(effect, {**effect.null_values(), **changes})


def run(plain, *active, base=BASE):
    presses, law = plain
    vars(presses)["flat_top_N"] = 5.0  # as if readings were clipped there, which only one effect asks for
    return readings(presses, simulate(presses, law, base, active), active)


def test_each_effect_stands_once_in_the_registry_and_its_folder_says_whose_it_is():
    names = [effect.name for effect in EFFECTS]
    assert len(names) == len(set(names)) >= 23
    rooms = {"rig": "rig", "sensor": "sensor", "material": "pad", "history": "pad"}
    for effect in EFFECTS:
        file = Path(inspect.getfile(type(effect)))
        assert effect.belongs_to == rooms[file.parent.name]
        assert file.stem == effect.name or effect.name.endswith(file.stem)
    files = [path for room in rooms for path in (Path(inspect.getfile(effects)).parent / room).glob("[!_]*.py")]
    assert {Path(inspect.getfile(type(effect))) for effect in EFFECTS} == set(files)


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda e: e.name)
def test_every_effect_keeps_the_contract(effect):
    assert check_effect(effect) == ()


def test_the_base_is_the_table_with_the_relaxation_of_the_pad_model(plain):
    presses, law = plain
    force = run(plain)
    for row in (0, 7, 20):
        depth, h = presses.displacement_mm[row : row + 1], presses.thickness_mm[row : row + 1, None]
        elastic = BASE.young_MPa * law(depth, h)[0]
        terms = [PronyTerm(t, b) for t, b in zip(BASE.tau_s, BASE.beta)]
        expected = np.maximum(relaxed_force(presses.time_s[row], elastic, terms), 0.0)
        np.testing.assert_allclose(force[row], expected, rtol=1e-9, atol=1e-9)


def test_the_fast_law_is_the_response_table(plain):
    _, law = plain
    h = np.array([[5.0], [15.0], [20.0]])
    depth = np.array([[0.1, 1.0, 2.0]]) * h / 5.0
    square = law(depth, h) / load_table("bonded").force(depth, h, 1.0, law.radius_mm)
    assert np.all((square > 1.0) & (square < 1.035))


@pytest.mark.parametrize("effect", ON_SLABS, ids=lambda e: e.name)
def test_an_effect_at_null_is_the_base_to_the_last_bit(plain, effect):
    null = Active(effect, effect.null_values())
    np.testing.assert_array_equal(run(plain, null), run(plain))


@pytest.mark.parametrize("effect", ON_SLABS, ids=lambda e: e.name)
def test_a_vanishing_effect_vanishes_continuously_and_a_usual_one_does_not(plain, effect):
    presses, _ = plain
    base = run(plain)
    first = effect.parameters[0]
    changes = []
    for share in (1e-6, 1.0):
        value = first.null + share * first.typical
        changed = run(plain, Active(effect, {**effect.null_values(), first.name: value}))
        changes.append(np.abs(presses.measure(changed - base)).max())
    assert changes[0] < 1e-4 * max(changes[1], 0.05)
    assert changes[1] > 0.01


def test_two_effects_at_two_hooks_act_together(plain):
    both = run(plain, values_of("machine_compliance", compliance_mm_per_N=0.01), values_of("force_bias", bias_N=0.2))
    alone = run(plain, values_of("machine_compliance", compliance_mm_per_N=0.01))
    np.testing.assert_allclose(both, alone + 0.2, atol=1e-6)


def test_compliance_is_the_force_at_the_depth_it_leaves(plain):
    presses, law = plain
    stiff = BaseParameters(0.04, (0.06, 1.4), (1e-9, 1e-9))
    c = 0.02
    force = run(plain, values_of("machine_compliance", compliance_mm_per_N=c), base=stiff)
    left = presses.displacement_mm - c * force
    np.testing.assert_allclose(force, 0.04 * law(left, presses.thickness_mm[:, None]), atol=2e-5)


def test_compliance_of_a_series_spring_adds_to_the_initial_compliance(plain):
    presses, law = plain
    elastic = BaseParameters(0.03, (0.06, 1.4), (1e-9, 1e-9))
    tiny = replace(presses, displacement_mm=np.full_like(presses.displacement_mm, 1e-3))
    free = simulate(tiny, law, elastic)[:, -1]
    held = simulate(tiny, law, elastic, [values_of("machine_compliance", compliance_mm_per_N=0.05)])[:, -1]
    np.testing.assert_allclose(1e-3 / held, 1e-3 / free + 0.05, rtol=1e-4)


def test_offset_and_dent_move_the_motion(plain):
    presses, law = plain
    moved = replace(presses, displacement_mm=presses.displacement_mm - 0.07)
    np.testing.assert_array_equal(run(plain, values_of("contact_offset", offset_mm=0.07)), simulate(moved, law, BASE))
    first = presses.history.earlier_depth_mm.max(axis=1) == 0
    dent = run(plain, values_of("incomplete_recovery", fraction=0.1, tau_s=100.0))
    np.testing.assert_array_equal(dent[first], run(plain)[first])
    assert np.all(dent[~first].max(axis=1) <= run(plain)[~first].max(axis=1))


def test_extra_modes_are_a_third_prony_term(plain):
    presses, law = plain
    force = run(plain, values_of("slow_relaxation_mode", beta=0.2, tau_s=20.0))
    row = 3
    elastic = BASE.young_MPa * law(presses.displacement_mm[row : row + 1], presses.thickness_mm[row : row + 1, None])[0]
    terms = [PronyTerm(t, b) for t, b in [*zip(BASE.tau_s, BASE.beta), (20.0, 0.2)]]
    np.testing.assert_allclose(force[row], np.maximum(relaxed_force(presses.time_s[row], elastic, terms), 0), atol=1e-9)


def test_weighted_arms_with_constant_weight_are_stronger_arms():
    time = np.linspace(0.0, 2.0, 50)[None]
    elastic = np.minimum(time, 0.5)
    double = relax(time, elastic, [Arm(0.3, 0.2, np.full_like(time, 2.0))])
    np.testing.assert_allclose(double, relax(time, elastic, [Arm(0.3, 0.4)]), atol=1e-12)


def test_batch_effects_scale_the_force_by_their_law(plain):
    presses, _ = plain
    base = run(plain)
    warm = run(plain, values_of("temperature", modulus_loss_per_K=0.01))
    factor = 1.0 - 0.01 * (presses.history.temperature_C - 23.0)
    np.testing.assert_allclose(warm, factor[:, None] * base, rtol=1e-9, atol=1e-12)
    aged = run(plain, values_of("ageing", growth_per_doubling=0.05))
    np.testing.assert_allclose(aged, (1 + 0.05 * np.log2(presses.history.age_days / 7.0))[:, None] * base, atol=1e-9)


def test_softening_spares_a_first_press_and_takes_its_share_from_the_second(plain):
    presses, _ = plain
    soft = run(plain, values_of("softening_with_cycles", softening=0.1))
    base = run(plain)
    first = presses.history.earlier_depth_mm.max(axis=1) == 0
    np.testing.assert_array_equal(soft[first], base[first])
    earlier = presses.history.earlier_depth_mm
    once = ((earlier >= presses.depth_mm[:, None] * 1.001).sum(axis=1) == 1) & ((earlier > 0).sum(axis=1) == 1)
    held = np.abs(presses.time_s - presses.stop_s[:, None] - 5.0).argmin(axis=1)
    rows = np.nonzero(once)[0]
    for row in rows:
        assert soft[row, held[row]] == pytest.approx(0.9 * base[row, held[row]], rel=1e-6)


def test_sensor_effects_have_their_closed_forms(plain):
    presses, _ = plain
    base = run(plain)
    np.testing.assert_allclose(run(plain, values_of("force_bias", bias_N=0.3)), base + 0.3, atol=1e-12)
    drift = run(plain, values_of("force_drift", drift_N_per_s=0.01)) - base
    np.testing.assert_allclose(drift, 0.01 * (presses.time_s - presses.time_s[:, :1]), atol=1e-12)
    pushed = run(plain, values_of("inertia", mass_kg=0.5)) - base
    np.testing.assert_allclose(pushed, 0.5e-3 * presses.acceleration_mm_s2, atol=1e-12)
    assert np.abs(pushed[presses.velocity_mm_s > 100]).max() > 3.0


def test_a_lag_delays_a_ramp_by_its_time_constant():
    from dummydesign.loop.effects.sensor.sensor_lag import SensorLag

    class Ramp:
        time_s = np.linspace(0.0, 1.0, 400)[None] ** 1.5

    ramp = 5.0 * Ramp.time_s
    late = SensorLag().sensor(Ramp, ramp, {"time_constant_s": 0.02, "second_stage": 0.0})
    exact = 5.0 * (Ramp.time_s - 0.02 * (1.0 - np.exp(-Ramp.time_s / 0.02)))
    np.testing.assert_allclose(late, exact, atol=1e-12)


def test_base_slip_and_compressibility_weaken_the_thin_pad_most(plain):
    _, law = plain
    h = np.array([[5.0], [15.0], [20.0]])
    depth = 0.1 * h
    for active in (values_of("base_slip", slip_fraction=1.0), values_of("compressibility", poisson_ratio=0.49)):
        changed = active.effect.law(law, active.values)(depth, h) / law(depth, h)
        assert changed[0, 0] < changed[1, 0] < changed[2, 0] < 1.0
    slipped = values_of("base_slip", slip_fraction=1.0)
    share = (slipped.effect.law(law, slipped.values)(depth, h) / law(depth, h))[:, 0]
    np.testing.assert_allclose(share, [0.44, 0.74, 0.80], atol=0.02)


def test_compressibility_follows_finite_elements_at_another_poisson_ratio(plain):
    from tests.support import campaign_press as generator_press

    _, law = plain
    h = np.array([5.0, 15.0, 20.0])
    depth = 0.2 * h
    solved = generator_press._layer_force(depth[:, None], h, "bonded", 0.46)
    hard = generator_press._layer_force(depth[:, None], h, "bonded", 0.5)
    active = values_of("compressibility", poisson_ratio=0.46)
    ours = active.effect.law(law, active.values)(depth[:, None], h[:, None]) / law(depth[:, None], h[:, None])
    np.testing.assert_allclose(ours, solved / hard, rtol=0.03)


def test_adhesion_and_hysteresis_leave_the_way_in_alone(plain):
    presses, _ = plain
    base = run(plain)
    pulled = run(plain, values_of("adhesion", pull_off_N=0.4))
    away = presses.time_s > presses.hold_end_s[:, None]
    np.testing.assert_array_equal(pulled[~away], base[~away])
    assert pulled[presses.unloads].min() == pytest.approx(-0.4, abs=0.05)
    rubbed = run(plain, values_of("friction_hysteresis", friction_fraction=0.1))
    np.testing.assert_allclose(rubbed[~away], 1.1 * base[~away], rtol=1e-12)


def test_a_puck_between_frictionless_plates_is_compressed_homogeneously():
    law = puck_law(50.0)
    h, d = np.array([[30.0]]), np.array([[0.3, 9.0, 15.0]])
    stretch = 1.0 - d / h
    np.testing.assert_allclose(law(d, h), np.pi * 625.0 / 3.0 * (stretch**-2 - stretch), rtol=1e-5)
    assert law(np.array([[1e-4]]), h)[0, 0] == pytest.approx(np.pi * 625.0 * 1e-4 / 30.0, rel=1e-4)


def rubbed(diameter, h, d, friction):
    law, effect = puck_law(diameter), effect_named("plate_friction")
    return effect.law(law, {"friction": friction})(d, h) / law(d, h)


def test_plate_friction_stiffens_flat_pucks_more_and_grows_with_friction():
    h = np.array([[40.0], [25.0], [16.0]])
    some, much = (rubbed(50.0, h, np.array([[0.01, 0.2]]) * h, friction) for friction in (0.1, 2.0))
    assert np.all(some > 1.0) and np.all(np.diff(some[:, 1]) > 0.0) and np.all(much > some)


def test_plate_friction_of_any_proportion_is_that_of_its_table_and_of_its_proportion_alone():
    """Each puck of a stack has the stiffening of its own table; 2 grip (mu = 2) is nearly the bonded puck, which at
    small compression is within 7 % of 1 + 2 S^2 (S = D / 4 h; Gent and Lindley 1959)."""
    h, share = np.array([[40.0], [27.0], [20.0]]), np.array([[0.01, 0.1, 0.3]])
    for friction in (0.1, 0.5):
        tables = [table_for(50.0, float(one)) for one in h[:, 0]]
        wanted = [table.factor(2.0, float(grip(friction)), share[0]) for table in tables]
        np.testing.assert_allclose(rubbed(50.0, h, share * h, friction), wanted, rtol=1e-12)
    np.testing.assert_allclose(rubbed(25.0, 0.5 * h, share * 0.5 * h, 0.3), rubbed(50.0, h, share * h, 0.3), rtol=1e-12)
    bonded = 1.0 + 2.0 * (50.0 / (4.0 * h)) ** 2
    np.testing.assert_allclose(rubbed(50.0, h, 0.01 * h, 2.0), bonded, rtol=0.09)


class Pucks:
    def __init__(self, share, *thickness):
        self.thickness_mm = np.array(thickness)
        self.depth_mm = share * self.thickness_mm


def test_plate_friction_of_a_puck_without_a_table_is_unavailable_with_the_reason():
    effect = effect_named("plate_friction")
    assert effect.unavailable(Pucks(0.45, 30.0, 20.0), puck_law(50.0)) == ""
    reason = effect.unavailable(Pucks(0.3, 30.0, 10.0), puck_law(50.0))
    assert "diameter over height = 5" in reason and "allowed range" in reason
    assert "70 %" in effect.unavailable(Pucks(0.7, 30.0), puck_law(50.0))


def test_plate_friction_without_its_table_is_an_error_and_not_another_law(monkeypatch, tmp_path):
    from dummydesign.loop.effects.rig import plate_friction

    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    for cached in (puck_table.load_puck_table, puck_table.load_shapes, plate_friction._table):
        cached.cache_clear()
    with raises_code("table_unavailable", "table"):
        rubbed(50.0, np.array([[30.0]]), np.array([[3.0]]), 0.2)
    with raises_code("table_unavailable", "table"):
        effect_named("plate_friction").unavailable(Pucks(0.3, 30.0), puck_law(50.0))


def test_a_fitted_thickness_beyond_the_tables_takes_the_nearest_proportion():
    edge = 50.0 / puck_shapes.shape_range()[1]
    at, beyond = (rubbed(50.0, np.array([[h]]), np.array([[0.1 * h]]), 0.2) for h in (edge, edge - 0.5))
    np.testing.assert_allclose(beyond, at, rtol=1e-9)


def test_plate_friction_of_the_usual_puck_comes_from_finite_elements_and_grows_to_the_bonded_puck():
    rows = [rubbed(50.0, np.array([[30.0]]), np.array([[0.3, 3.0, 12.0]]), mu) for mu in (0.05, 0.2, 2.0)]
    assert np.all(np.diff(np.concatenate(rows), axis=0) > 0) and np.all(rows[0] > 1.0)
    # bonded at small compression: 1.404 at shape factor 0.417; a friction of 2 is nearly that
    assert 1.3 < rows[2][0, 0] < 1.41
