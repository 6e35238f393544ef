"""Modulus, stiffening and plate friction from compression curves, recovered from curves with known ones."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.inference.least_squares import CHI_SQUARE_95
from dummydesign.measurement.ramp_detection import find_holds
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import friction_of, grip, load_puck_table, load_shapes, uniaxial
from dummydesign.resin.puck_test.add_compression import steps
from dummydesign.resin.puck_test.loading_fit import LoadingCurve, fit_pucks, reduce_press
from dummydesign.resin.puck_test.plates import read_plates
from tests.support.puck_history import frictionless, ramps
from tests.support.refusal import raises_code

WINDOW = (1.0, 15.0)
GRID = np.arange(0.0, 15.1, 0.5)


def made(young_kPa, alpha, plates, tests, noise=0.003):
    """Curves from a solve made now (not from the table), each with its own contact, zeroed at x = 0."""
    law = Ogden([2.0 / alpha], [alpha])
    at = np.concatenate([[0.002, 0.01, 0.03], np.arange(0.06, 0.53, 0.04)])
    curve = solve_puck(Puck(30.0, young_kPa * 1e-3, 50.0, plates=plates, law=law), 30.0 * at)
    factor = curve.force_N / uniaxial(alpha, at)
    rng, curves = np.random.default_rng(3), []
    for name, offset_mm, scale in tests:
        compression = np.maximum(GRID - offset_mm, 0.0) / 30.0
        load = uniaxial(alpha, compression) * np.interp(compression, at, factor)
        load = scale * (load - load[0]) * (1.0 + noise * rng.standard_normal(len(load)))
        curves.append(LoadingCurve(name, name[0], GRID, load))
    return curves


def best_of(fit):
    """The best fit of a profile."""
    return min(fit.profile, key=lambda one: one.misfit)


@pytest.fixture(scope="module")
def table():
    return load_puck_table()


@pytest.mark.slow
@pytest.mark.parametrize(("plates", "friction"), [("friction:0.12", 0.12), ("bonded", np.inf)])
def test_what_made_the_curves_is_found_within_its_interval(table, plates, friction):
    tests = [("A1", 0.3, 1.02), ("A2", -0.2, 1.01), ("B1", 0.0, 0.98), ("B2", 0.1, 0.99)]
    fit = fit_pucks(made(30.0, 2.5, plates, tests), 50.0, 30.0, table, WINDOW)
    best = best_of(fit)
    kept = [one for one, excess in zip(fit.profile, fit.excess) if excess <= CHI_SQUARE_95]
    logs, around = [one.parameters[0] for one in kept], np.sqrt(CHI_SQUARE_95 * fit.variance)
    assert min(logs) - around < np.log(30.0) < max(logs) + around
    assert np.exp(best.parameters[0]) == pytest.approx(30.0, rel=0.02)
    assert best.parameters[1] == pytest.approx(2.5, abs=0.25)
    assert friction_of(kept[0].grip) <= friction <= friction_of(kept[-1].grip)
    for (_, offset, _), found in zip(tests, 30.0 * best.parameters[2:]):
        # A press that began before x = 0 shows less of its offset: its load was zeroed.
        assert found == pytest.approx(offset, abs=0.06 if offset >= 0.0 else 0.2)


@pytest.mark.slow
def test_taking_the_plates_for_frictionless_would_have_overestimated_the_modulus(table):
    fit = fit_pucks(made(30.0, 2.0, "bonded", [("A1", 0.0, 1.0)], 0.0), 50.0, 30.0, table, WINDOW)
    first, last = fit.profile[0], fit.profile[-1]
    assert first.parameters[0] - last.parameters[0] > np.log(1.25)
    assert first.misfit > 5.0 * fit.misfit


@pytest.mark.parametrize(("alpha", "friction"), [pytest.param(2.5, 0.12, marks=pytest.mark.slow), (3.5, 0.08)])
def test_between_its_grid_the_table_agrees_with_a_solve(table, alpha, friction):
    compression = np.array([0.05, 0.21, 0.37, 0.5])
    law = Ogden([2.0 / alpha], [alpha])
    solved = solve_puck(Puck(30.0, 0.03, 50.0, plates=f"friction:{friction}", law=law), 30.0 * compression)
    factor = table.factor(alpha, float(grip(friction)), compression)
    found = 0.03 * np.pi * 625.0 * uniaxial(alpha, compression) * factor
    assert found == pytest.approx(solved.force_N, rel=0.012)


def test_grip_and_friction_are_inverse_and_run_from_free_to_bonded():
    for friction in (0.0, 0.1, 2.0):
        assert friction_of(float(grip(friction))) == pytest.approx(friction)
    assert grip(np.inf) == 1.0
    assert friction_of(1.0) == np.inf


def test_another_shape_and_bad_curves_are_refused(table, monkeypatch, tmp_path):
    curve = LoadingCurve("A1", "A", GRID, GRID * 2.0)
    with raises_code("out_of_range", "puck_radius_over_height"):
        fit_pucks([curve], 40.0, 30.0, table, WINDOW)
    with raises_code("not_enough_data", "curve"):
        fit_pucks([LoadingCurve("A2", "A", GRID, -GRID)], 50.0, 30.0, table, WINDOW)
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    load_puck_table.cache_clear()
    with raises_code("table_unavailable", "table"):
        load_puck_table()
    load_puck_table.cache_clear()
    load_shapes.cache_clear()  # it holds the table that was read before


@pytest.mark.parametrize("contact_mm", [0.2, -0.7, -1.1])
def test_contact_before_the_files_zero_does_not_change_the_modulus_or_make_a_press_odd(table, contact_mm):
    """Closed form between frictionless plates; the approach begins 1 mm before the zero, one press touches at zero."""
    x = np.linspace(-1.0, 9.0, 2001)
    contacts = (contact_mm, 0.0)
    forces = [30.0 * frictionless((x - at) / 30.0, 50.0, 2.0) for at in contacts]
    curves = [LoadingCurve(str(at), "puck", *steps(x, force, (0.9, 9.0))) for at, force in zip(contacts, forces)]
    fit = fit_pucks(curves, 50.0, 30.0, table, (0.9, 9.0), read_plates(0))
    assert best_of(fit).parameters[0] == pytest.approx(np.log(30.0), abs=0.002)
    assert best_of(fit).parameters[2] * 30.0 == pytest.approx(contact_mm, abs=0.01)
    assert fit.levels == pytest.approx([0.0, 0.0], abs=0.003)


@pytest.mark.parametrize("contact_mm", [0.0, -0.7])
def test_the_bins_of_a_held_press_are_zeroed_where_its_force_is(table, contact_mm):
    time, x = ramps((0.2,), 30.0, 1.0, 10.0, 0.01)
    x = np.r_[np.linspace(-1.0, x[0], 90, endpoint=False), x]
    time = np.r_[time[0] - 0.01 * np.arange(90, 0, -1), time]
    force = 30.0 * frictionless((x - contact_mm) / 30.0, 50.0, 2.0)
    press = reduce_press(time, x, force, find_holds(time, x), (0.9, 6.5))
    found = press.average @ (30.0 * frictionless((press.displacement_mm - contact_mm) / 30.0, 50.0, 2.0))
    assert found == pytest.approx(press.force_N, rel=0.01)
