"""Contacts that a pad and people stop, on springs and straight curves: depths, forces, limits, words."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design import safety
from dummydesign.design.safety import (
    SafetyContact,
    _bottoming,
    _impact_rows,
    _stopped,
    against_limits,
    curves_impact,
    impact,
    pad_body,
    pad_press,
)
from dummydesign.design.scoring.press_simulation import SAMPLES, PadBatch, Sampling, SlabCurves
from tests.support.refusal import raises_code


def contact(values):
    values = np.array(values, float)
    return SafetyContact(values, values, values, values, values)


def limits(force=10.0, pressure=20.0, factor=2.0):
    return safety.UserLimits("x", *(SimpleNamespace(value=value) for value in (force, pressure, factor)))


def test_limits_hold_forces_and_mean_pressures_transient_ones_by_a_factor():
    found = against_limits(contact([3.0, 9.9, np.nan]), 50.0, limits())
    rows = {(row["criterion"], row["contact"]): row for row in found}
    assert rows["force_N", "quasi-static"]["value"] == 9.9 and rows["force_N", "quasi-static"]["within"]
    assert rows["force_N", "transient"]["limit"] == 20.0
    pressed = rows["mean_pressure_N_per_cm2", "quasi-static"]
    assert pressed["value"] == pytest.approx(9.9 / 0.5) and pressed["limit"] == 20.0 and pressed["within"]
    over = against_limits(contact([10.01]), 50.0, limits())
    assert [row["within"] for row in over] == [False, True, False, True]
    none = against_limits(contact([np.nan]), 50.0, limits())
    assert all(row["value"] is None and row["within"] is None for row in none)
    exact = against_limits(contact([10.0]), 50.0, limits())
    assert exact[0]["within"]


def test_a_curve_stops_an_energy_where_it_has_taken_it():
    depth = np.array([0.0, 1.0, 2.0, 3.0])
    stop, peak, taken = _stopped(depth, 4.0 * depth, 8.0)
    assert (stop, peak, taken) == pytest.approx((2.0, 8.0, 18.0), abs=0.04)
    falling = _stopped(depth, np.array([0.0, 10.0, 2.0, 2.0]), 11.5)
    # the peak before the stop counts
    assert falling[1] == pytest.approx(10.0, abs=0.05) and 1.9 < falling[0] < 2.4
    beyond = _stopped(depth, 4.0 * depth, 18.1)
    assert np.isnan(beyond[0]) and np.isnan(beyond[1]) and beyond[2] == pytest.approx(18.0)


class Person:
    """Measured: at 250 mm/s the force rises by 4 N/mm to 3 mm, at rest by 2 N/mm."""

    velocities_mm_s = (10.0, 250.0)

    def __init__(self, stiffness=4.0, rest=2.0):
        self.stiffness, self.rest = stiffness, rest

    def rise_at(self, velocity):
        depth = np.array([0.0, 0.02, 1.0, 2.0, 3.0])
        return None if velocity not in self.velocities_mm_s else (depth, self.stiffness * depth)

    def steady_N(self, depth, hold):
        return self.rest * np.asarray(depth)


def test_people_stop_a_mass_by_their_own_curves_and_at_rest_deeper():
    mass = 2.0 * 4.0 / (1e-3 * 250.0**2)
    found = curves_impact([Person(), Person(8.0, 1.0)], mass, 250.0)
    # 4 mJ: 4 x^2 / 2
    np.testing.assert_allclose(found.contact.depth_mm, [np.sqrt(2.0), 1.0], atol=5e-3)
    np.testing.assert_allclose(found.contact.energy_mJ, 4.0)
    np.testing.assert_allclose(found.contact.peak_force_N, [4.0 * np.sqrt(2.0), 8.0], rtol=5e-3)
    assert found.notes[0] == "at most 2.00 mm" and found.notes[1] == "at most 2.83 mm"
    soft = curves_impact([Person(4.0, 0.5)], mass, 250.0)
    assert soft.notes[0] == "at rest deeper than 3.00 mm"
    fast = curves_impact([Person()], 10.0 * mass, 250.0)
    assert np.isnan(fast.contact.depth_mm[0])
    assert "it brings 40 mJ, the deepest press took 18 mJ to 3.00 mm" in fast.notes[0]
    with raises_code("out_of_range", "robot_velocity_mm_s"):
        curves_impact([Person()], mass, 100.0)


def springs(stiffness=20.0, limit=8.0, beta=0.0, tau=1.0):
    depth = limit * np.linspace(0.0, 1.0, SAMPLES)
    curves = SlabCurves(np.array([20.0]), np.array([limit]), stiffness * depth[None])
    return PadBatch(curves, np.array([0]), np.array([0.5]), (tau,), np.array([[beta]]))


@pytest.mark.slow
def test_a_mass_on_a_spring_stops_after_a_quarter_of_its_period():
    mass, speed, stiffness = 0.4, 100.0, 10.0
    found = impact(pad_body(springs()), mass, speed)
    omega = np.sqrt(stiffness / (1e-3 * mass))
    assert found.depth_mm[0] == pytest.approx(speed / omega, rel=1e-4)
    assert found.stop_s[0] == pytest.approx(0.5 * np.pi / omega, rel=1e-3)
    assert found.peak_force_N[0] == pytest.approx(stiffness * speed / omega, rel=1e-3)
    assert found.energy_mJ[0] == pytest.approx(0.5e-3 * mass * speed**2, rel=1e-3)
    # an arm that hardly relaxes is a spring beside it, one that relaxes at once none
    for tau, added in ((1e4, 0.5), (1e-7, 0.0)):
        one = impact(pad_body(springs(beta=0.5, tau=tau)), mass, speed)
        assert one.depth_mm[0] == pytest.approx(speed / omega / np.sqrt(1.0 + added), rel=2e-3)
    assert np.isnan(impact(pad_body(springs(limit=1.0)), 10.0 * mass, speed).depth_mm[0])
    for wrong in ((0.0, 100.0), (1.0, -5.0), (np.inf, 1.0)):
        with raises_code("out_of_range"):
            impact(pad_body(springs()), *wrong)


def test_a_press_of_a_pad_holds_its_relaxed_force_later_than_half_a_second():
    slabs = springs(beta=0.5, tau=0.05)
    found = pad_press(slabs, np.array([2.0]), 100.0, Sampling(hold_s=5.0))
    assert found.held_force_N[0] == pytest.approx(20.0, rel=1e-3) and found.depth_mm[0] == 2.0
    assert found.peak_force_N[0] > 24.0
    short = pad_press(slabs, np.array([2.0]), 100.0, Sampling(hold_s=0.4))
    assert np.isnan(short.held_force_N[0]) and np.isfinite(short.peak_force_N[0])
    assert np.isnan(pad_press(slabs, np.array([np.nan]), 100.0).energy_mJ[0])
    elastic = pad_press(springs(), np.array([2.0]), 100.0)
    assert elastic.energy_mJ[0] == pytest.approx(20.0, rel=1e-3)


def test_a_pad_that_bottoms_out_says_what_it_takes_and_what_the_mass_brings():
    text = _bottoming(springs(), 2.0, 500.0)["message"]
    # 10 N/mm to 8 mm; 2 kg at 0.5 m/s
    assert "bring 250 mJ" in text and "320 mJ to 8.0 mm, 0.40 of its thickness" in text
    rows = _impact_rows("pad", contact([2.0]), 50.0)
    assert rows[0]["body"] == "pad" and rows[0]["mean_pressure_N_per_cm2"] == pytest.approx(4.0)
    several = _impact_rows("tissue", contact([2.0, np.nan]), 50.0)
    assert [row["body"] for row in several] == ["tissue, subject 1", "tissue, subject 2"]
    assert several[1]["peak_force_N"] is None and several[1]["note"] and not several[0]["note"]
    assert [row["note"] for row in _impact_rows("tissue", contact([2.0, 3.0]), 50.0, ("a", "b"))] == ["a", "b"]


@pytest.mark.parametrize("tau", [0.003, 0.02])
def test_a_mass_on_a_standard_solid_stops_as_its_equation_says(tau):
    """m x'' = -k (x + 1.5 q), q' = x' - q / tau, solved tightly: a midpoint rule of 1000 steps is good to 1e-5."""
    from scipy.integrate import solve_ivp

    def rates(time, state):
        x, v, q = state
        return [v, -10.0 * (x + 1.5 * q) / 0.4e-3, v - q / tau]

    def stopped(time, state):
        return state[1]

    stopped.terminal, stopped.direction = True, -1
    wanted = solve_ivp(rates, (0.0, 1.0), [0.0, 100.0, 0.0], events=stopped, rtol=1e-10, atol=1e-12)
    found = impact(pad_body(springs(beta=1.5, tau=tau)), 0.4, 100.0)
    assert found.depth_mm[0] == pytest.approx(wanted.y_events[0][0][0], rel=1e-5)
    assert found.stop_s[0] == pytest.approx(wanted.t_events[0][0], rel=5e-6)
