"""Contact that opens and closes: balls on layers against the integral equation, friction between its limits."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.punch import read_punch
from dummydesign.pad.axisymmetric.case import EDGE_STABILISATION, Case, first_stiffness
from dummydesign.pad.axisymmetric.profile_punch import (
    CELLS,
    Region,
    before_the_step,
    indentation_problem,
    press,
    profile,
    solve_profile,
    tip_region,
)
from dummydesign.pad.axisymmetric.shaped_pad import solve_flat
from dummydesign.pad.axisymmetric.sharp_edge import solve_path
from dummydesign.pad.contact.axisymmetric import AxisymmetricSurface, FlatPunch, ProfilePunch
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from tests.support.ball_punch import sphere
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)
EDGE = Region(0.65, 1.2, 0.1 / 1.5)
"""Where the edge of a flat punch of radius 1 with a bead of 0.1 slides, for depths up to 0.1."""
# F = 16/9 E sqrt(R) d^1.5 f(c), c = sqrt(R d) / h, frictionless ball on a bonded incompressible layer.
CAP = {0.185: 1.270, 0.554: 2.381, 0.748: 3.371, 1.054: 5.563, 1.349: 8.468}


@pytest.mark.slow
@pytest.mark.parametrize(("c", "factor"), CAP.items())
def test_a_shallow_ball_agrees_with_the_law_of_a_cap_on_a_layer(c, factor):
    radius = 5.0 if c < 0.3 else 120.0
    depth = c**2 / radius
    curve = solve_profile(
        Pad(10.0, 0.03, 13.0 * c, extent_mm=100.0 + 20 * c, condition="frictionless"),
        [depth * 10.0],
        sphere(radius * 10.0),
    )
    force = 16.0 / 9.0 * 0.03 * np.sqrt(radius) * depth**1.5 * factor * 100.0
    assert curve.force_N[0] == pytest.approx(force, rel=5e-3)


@pytest.mark.slow
def test_a_profile_through_points_of_a_ball_presses_like_the_ball():
    r = np.linspace(0.0, 6.0, 60)
    ball = sphere(20.0)
    points = profile(r, 20.0 - np.sqrt(400.0 - r**2))
    pair = [
        solve_profile(Pad(10.0, 0.03, 5.0, condition="frictionless"), [0.3, 0.6], p, cells=16).force_N
        for p in (ball, points)
    ]
    assert pair[1] == pytest.approx(pair[0], rel=3e-3)


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["bonded", "friction:0.3"])
def test_the_force_under_a_ball_that_sticks_or_rubs_does_not_depend_on_the_list_of_depths(condition):
    lists = [0.5, 1.0, 1.5], np.arange(0.15, 1.51, 0.07).tolist() + [0.5, 1.0, 1.5]
    found = [
        solve_profile(Pad(5.0, 0.03, 7.0, condition=condition), np.unique(wanted), sphere(15.0)) for wanted in lists
    ]
    many = np.interp(lists[0], found[1].depth_mm, found[1].force_N)
    assert many == pytest.approx(found[0].force_N, rel=3e-4)


LEDGE = profile([0.0, 3.0, 3.5, 4.0, 4.2, 6.0], [0.0, 0.0, 0.1, 1.0, 3.0, 3.2])  # mm; a wall of 0.2 mm, 3 mm high


@pytest.mark.parametrize("punch", [sphere(6.0), sphere(20.0), profile([0, 1, 2, 4, 6], [0, 0.3, 0.8, 1.8, 2.8])])
def test_a_smooth_punch_has_no_step(punch):
    depth = np.linspace(0.1, 5.0, 30)
    kept, note = before_the_step(punch, 5.8, depth, 1.0, CELLS)
    assert note == "" and np.all(kept == depth)


def test_forces_end_before_the_top_of_a_step_that_cells_do_not_resolve():
    depth = np.linspace(0.1, 5.0, 50)
    kept, note = before_the_step(LEDGE, 6.0, depth, 1.0, CELLS)
    assert note and 2.0 < kept[-1] <= 2.5
    assert before_the_step(LEDGE, 6.0, kept, 1.0, CELLS)[1] == ""
    with raises_code("unsupported", "punch_profile"):
        before_the_step(LEDGE, 6.0, np.array([4.0, 5.0]), 1.0, CELLS)
    with raises_code("unsupported", "punch_profile"):
        solve_profile(Pad(10.0, 0.04, 6.0, condition="bonded"), [4.0], LEDGE)


@pytest.mark.parametrize(("cells_wide", "narrow"), [(1.6, True), (2.4, False)])
def test_a_step_is_one_whose_slope_falls_by_one_within_two_cells(cells_wide, narrow):
    """A slope that rises to 1.5 and falls again: by 1 within two thirds of its way down."""
    at = 3.0
    region = tip_region(sphere(20.0), 6.0, 0.1, CELLS)
    down = 1.5 * cells_wide * max(region.cell, region.share * at)
    r = np.linspace(0.0, 6.0, 60001)
    slope = np.interp(r, [0.0, 2.0, at, at + down, 6.0], [0.0, 0.1, 1.5, 0.0, 0.0])
    height = np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * np.diff(r))])
    punch = ProfilePunch(lambda of: (np.interp(of, r, height), np.interp(of, r, slope), 0.0 * of, 0.0 * of))
    wanted = np.linspace(0.1, 2.0, 40)
    kept, note = before_the_step(punch, 6.0, wanted, 1.0, CELLS)
    top = float(np.interp(at + down, r, height))
    assert bool(note) == narrow and (kept[-1] <= 0.8 * top if narrow else kept[-1] == 2.0)
    assert not narrow or kept[-1] > 0.7 * float(np.interp(at, r, height))


@pytest.mark.slow
@pytest.mark.parametrize("condition", ["bonded", "friction:0.3"])
def test_before_a_step_forces_keep_their_stated_error(condition):
    depth = [0.5, 1.0, 2.0, 3.0, 4.0]
    fine, own = (
        solve_profile(Pad(10.0, 0.04, 6.0, condition=condition), depth, LEDGE, cells=n) for n in (2 * CELLS, CELLS)
    )
    assert len(own.force_N) == 3 and any("step" in note for note in own.notes)
    assert np.all(np.abs(np.log(own.force_N / fine.force_N[:3])) < own.error_N / own.force_N)


def test_contact_forces_are_the_derivative_of_their_energy_and_their_tangent_is_exact():
    rng = np.random.default_rng(6)
    nodes = np.array([[0.4, 0.7, 1.0, 1.2, 1.4], [0.0, 0.01, 0.0, 0.02, 0.01]])
    sides = np.array([[0, 1, 2], [2, 3, 4]])
    for punch in (FlatPunch(1.0, 0.2), sphere(3.0)):
        surface = AxisymmetricSurface(
            nodes, sides, lambda r: 40.0 + r, lambda r: 0.0 * r, friction=0.4, slip_scale=0.05
        )
        surface.settle(np.zeros(10), punch, 0.05)
        u = 0.02 * rng.standard_normal(10)
        force, matrix = surface.forces(u, punch, 0.1)
        whole = np.zeros((10, 10))
        for side, block in zip(surface.dofs, matrix):
            whole[np.ix_(side, side)] += block
        for k in range(10):
            step = np.zeros(10)
            step[k] = 1e-7
            up, down = (surface.forces(u + sign * step, punch, 0.1)[0] for sign in (1.0, -1.0))
            assert whole[:, k] == pytest.approx((up - down) / 2e-7, abs=2e-4)
        assert np.abs(force).max() > 0.1


def test_the_gap_to_a_cone_is_the_distance_to_its_flank_and_the_normal_has_unit_length():
    flank = 3.0
    cone = ProfilePunch(lambda r: (flank * r, flank + 0.0 * r, 0.0 * r, 0.0 * r))
    points = np.array([[0.5, 1.0], [0.4, 0.2], [1.0, 2.2]])
    gap, normal, _ = cone.gap(points, 0.3)
    assert gap == pytest.approx((flank * points[:, 0] - 0.3 - points[:, 1]) / np.hypot(flank, 1.0))
    assert np.linalg.norm(normal, axis=-1) == pytest.approx(1.0)


def test_what_slips_on_a_steep_flank_is_dragged_by_the_coefficient_times_what_presses_on_it():
    """Coulomb's law has the force along the normal in it; a gap along the axis gave a third of that here."""
    flank, mu = 3.0, 0.2
    cone = ProfilePunch(lambda r: (flank * r, flank + 0.0 * r, 0.0 * r, 0.0 * r))
    nodes = np.array([[0.50, 0.55, 0.60], [0.0, 0.0, 0.0]])
    stiffness = lambda r: np.full_like(r, 1e3)  # noqa: E731
    surface = AxisymmetricSurface(
        nodes, np.array([[0, 1, 2]]), stiffness, lambda r: 0.0 * r, friction=mu, slip_scale=1e-6
    )
    depth = flank * 0.60 + 1e-3
    surface.settle(np.zeros(6), cone, depth)
    # All points slide the same way along the flank.
    along = np.array([1.0, flank]) / np.hypot(1.0, flank)
    u = np.tile(-0.01 * along, 3)
    force, _ = surface.forces(u, cone, depth)
    total = force.reshape(3, 2).sum(axis=0)
    pressed = total @ np.array([flank, -1.0]) / np.hypot(flank, 1.0)
    assert abs(total @ along) == pytest.approx(mu * abs(pressed), rel=1e-4)


def test_friction_lies_between_sliding_and_sticking_and_grows_with_its_coefficient():
    punch = FlatPunch(1.0, 0.1)
    forces = []
    for condition in ("frictionless", "friction:0.1", "friction:0.3", "bonded"):
        problem = indentation_problem(punch, EDGE, Case(1.0, 8.0, condition=condition))
        forces.append(press(problem, [0.1], 0.03, 0.03).force[0])
    assert np.all(np.diff(forces) > 0.0)


def test_a_flat_face_sticks_from_first_touch_however_large_the_first_step_is():
    punch, forces = FlatPunch(1.0, 0.1), []
    for first in (0.005, 0.02):
        problem = indentation_problem(punch, EDGE, Case(1.0, 8.0))
        forces.append(press(problem, [0.02], first, first).force[0])
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)


@pytest.mark.slow
def test_a_frictionless_flat_punch_starts_at_the_layer_solution():
    curve = solve_flat(Pad(10.0, 0.03, 10.0, condition="frictionless"), [0.3, 0.6])
    stiffness = curve.force_N / (0.03 * 10.0 * curve.depth_mm)
    start = 2.0 * stiffness[0] - stiffness[1]
    slab = Case(1.0, 7.569, "bonded", "frictionless")
    assert start == pytest.approx(first_stiffness(slab), rel=0.03)
    assert np.all(np.abs(stiffness / first_stiffness(slab) - 1.0) < 0.03 + curve.error_N / curve.force_N)


@pytest.mark.slow
def test_a_sticking_flat_punch_agrees_with_the_glued_one_solved_the_other_way():
    """Another mesh, no film, no nodes driven by hand: nearer to each other than a rim is to one of half its size."""
    punch, depths = FlatPunch(1.0, 0.05), np.array([0.1, 0.2, 0.3])
    region = Region(0.85, 1.1, 0.05 / 1.5)
    problem = indentation_problem(punch, region, Case(1.0, 8.0))
    problem.solid.stabilisation = EDGE_STABILISATION
    stick = press(problem, depths, 0.015, 0.03).force
    glued, half = (solve_path(Case(1.0, 8.0), depths, rim, Resolution()).force for rim in (0.05, 0.025))
    assert np.all(np.abs(stick - glued) < 0.6 * (half - glued))


@pytest.mark.parametrize("young_MPa", [0.03, pytest.param(0.06, marks=pytest.mark.slow)])
def test_under_a_ball_a_slab_that_lies_by_friction_is_between_a_free_and_a_glued_one_at_its_own_modulus(young_MPa):
    ball = read_punch("ball:20")
    curves = [
        solve_points(
            Pad(10.0, young_MPa, ball.radius_mm, profile_mm=ball.profile_mm, condition="frictionless", base=base),
            np.array([0.3]),
        )
        for base in ("sliding", "friction:0.3", "bonded")
    ]
    free, rubs, glued = (curve.force_N[0] for curve in curves)
    assert 1.02 * free < rubs < 0.998 * glued
    assert all(1e-4 < curve.error_N[0] / curve.force_N[0] < 0.02 for curve in curves)


@pytest.mark.parametrize("text", ["glue", "friction", "friction:x", "friction:-1", "friction:9"])
def test_unknown_conditions_are_refused(text):
    with raises_code("unknown_name", "condition"):
        indentation_problem(sphere(1.0), Region(0.0, 1.0, 0.2), Case(1.0, 5.0, condition=text))


@pytest.mark.parametrize(
    "points", [([0, 1], [0, 1]), ([0, 1, 1], [0, 1, 2]), ([0, 1, 2], [1, 1, 2]), ([1, 2, 3], [0, 1, 2])]
)
def test_profiles_that_are_no_punch_are_refused(points):
    with raises_code("malformed", "punch_profile"):
        profile(*points)


def test_a_ball_is_carried_on_straight_beyond_its_side():
    value, slope, second, third = sphere(2.0).height(np.array([0.0, 1.0, 5.0]))
    assert value[0] == slope[0] == 0.0
    assert value[1] == pytest.approx(2.0 - np.sqrt(3.0))
    assert np.isfinite(value).all() and second[2] == third[2] == 0.0
    assert isinstance(sphere(2.0), ProfilePunch)
