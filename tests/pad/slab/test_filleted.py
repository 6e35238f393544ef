"""A punch with a fillet against closed forms, limits, refinement, and whatever other depths are asked for."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.case import Case, first_stiffness
from dummydesign.pad.axisymmetric.filleted import filleted_problem, solve_under_fillet
from dummydesign.pad.contact.axisymmetric import FilletedPunch, FlatPunch
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.tables.slab import load_table
from studies.verification.edges import rounded_flat
from tests.support.refusal import raises_code

LAW = Yeoh(1.0)


@pytest.mark.parametrize("sides", [True, False])
def test_gap_of_face_fillet_and_side_has_the_derivatives_it_says(sides):
    punch = FilletedPunch(1.0, 0.2, sides)
    points = np.array([[0.5, -0.31], [0.9, -0.3], [0.98, -0.2], [1.05, 0.1], [0.99, 0.2]])
    _, slope, bend = punch.gap(points, 0.3)
    step = 1e-6
    for k in range(2):
        move = step * np.eye(2)[k]
        ahead, behind = punch.gap(points + move, 0.3), punch.gap(points - move, 0.3)
        assert slope[:, k] == pytest.approx((ahead[0] - behind[0]) / (2 * step), abs=1e-8)
        assert bend[:, :, k] == pytest.approx((ahead[1] - behind[1]) / (2 * step), abs=1e-6)


def test_the_upright_side_stands_at_the_radius_of_the_punch_and_without_it_the_edge_recedes():
    point = np.array([[1.03, 0.4]])
    assert FilletedPunch(1.0, 0.2).gap(point, 0.3)[0] == pytest.approx([0.03])
    recedes = FilletedPunch(1.0, 0.2, sides=False).gap(point, 0.3)[0]
    assert recedes == pytest.approx(FlatPunch(1.0, 0.2).gap(point, 0.3)[0])
    assert recedes[0] > 0.3


def test_small_depths_agree_with_the_closed_form_of_a_rounded_punch_on_a_thick_pad():
    """Incompressible half-space: glued and frictionless are the same. A flat of radius b with a shoulder r^2 / 2 rho
    reaches the contact radius c at d = (c / rho) (sqrt(c^2 - b^2) - b acos(b / c)), F = 2 E* (c d - the integral of
    the profile's g(x) from b to c). A layer lets the whole contact sink by a share of F / h, taken from flat punches.
    """
    radius, fillet = 0.1, 0.03
    flat, unit = radius - fillet, 4.0  # E* = E / (1 - nu^2) = 4 mu
    slab = Case(flat, 12.0)
    sink = 1.0 / (3.0 * flat * first_stiffness(slab)) - 1.0 / (2.0 * unit * flat)
    contact = np.array([0.0725, 0.074])
    depth, force = rounded_flat(flat, fillet, contact, unit)
    found = solve_under_fillet(Pad(1.0, 3.0, radius, extent_mm=12.0, edge_radius_mm=fillet), depth + sink * force)
    assert np.all(force / (depth + sink * force) > 1.02 / (sink + 1.0 / (2.0 * unit * flat)))
    assert found.force_N == pytest.approx(force, rel=8e-3)


@pytest.mark.slow
def test_small_fillets_without_sides_tend_to_the_sharp_edge_within_the_errors_stated():
    depth = np.array([0.5, 1.0])
    table = load_table()
    sharp, stated = table.force(depth, 10.0, 0.025, 7.9), table.solved_error(depth, 10.0, 7.9)
    curves = [
        solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=fillet), depth, sides=False)
        for fillet in (0.4, 0.2, 0.1)
    ]
    missing = np.array([1.0 - curve.force_N / sharp for curve in curves])
    errors = np.array([curve.error_N / curve.force_N for curve in curves]).max(axis=0)
    assert np.all(np.diff(missing, axis=0) < 0.0)
    # The power 1.25 of the fillet: 0.42 of what is missing is left by each halving.
    left = missing[2] - 0.42 / 0.58 * (missing[1] - missing[2])
    assert np.all(np.abs(left) < stated + 2.0 * errors)


@pytest.fixture(scope="module")
def curve():
    return solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5), [0.4, 1.0, 2.0, 3.0, 4.0, 5.0])


@pytest.mark.slow
def test_the_force_at_a_depth_is_the_same_whatever_other_depths_are_asked_for(curve):
    alone = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5), [2.0])
    odd = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5), [0.137, 0.811, 2.0, 2.93])
    assert alone.force_N[0] == pytest.approx(curve.force_N[2], rel=1e-5)
    assert odd.force_N[2] == pytest.approx(curve.force_N[2], rel=1e-5)


def test_a_fillet_reaches_half_the_thickness_and_states_less_than_one_per_cent(curve):
    assert len(curve.force_N) == 6
    assert np.all(curve.error_N < 0.01 * curve.force_N)
    assert np.all(np.diff(curve.force_N / curve.depth_mm) > 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [5.0, 20.0])
def test_cells_of_half_the_size_change_less_than_the_stated_error(thickness):
    depth = np.array([0.1, 0.2, 0.3, 0.4])
    problem = filleted_problem(Case(7.9 / thickness, 75.7 / thickness, edge=0.5 / thickness), coarser=0.5)
    finer = follow(problem, depth, 0.01, 0.02, 1e-4, lattice=True).force * thickness**2
    found = solve_under_fillet(Pad(thickness, 3.0, 7.9, edge_radius_mm=0.5), depth * thickness)
    assert np.all(np.abs(found.force_N / finer - 1.0) < found.error_N / found.force_N)


def test_sides_carry_nothing_before_the_surface_reaches_them_and_stiffen_a_deep_press(curve):
    bare = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5), [0.4, 1.0, 5.0], sides=False)
    assert bare.force_N[:2] == pytest.approx(curve.force_N[:2], rel=1e-6)
    assert bare.force_N[2] < 0.99 * curve.force_N[5]


@pytest.mark.parametrize("fillet", [-0.1, 0.0, 2.5, float("nan")])
def test_a_fillet_outside_its_range_is_refused(fillet):
    with raises_code("out_of_range", "edge_radius_mm"):
        solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=fillet), [1.0])


def test_predict_takes_the_fillet_and_a_square_its_factor_with_half_of_it_as_doubt():
    from dummydesign.pad.pad_under_punch import Pad
    from dummydesign.pad.predict import predict_static
    from dummydesign.pad.tables.square import square_factor

    square = Pad(10.0, 0.025, 14.0 / np.sqrt(np.pi), sides_mm=(14.0, 14.0), edge_radius_mm=0.5)
    found = predict_static(square, [0.2, 0.4], "axisymmetric")
    round_ = solve_under_fillet(Pad(10.0, 0.025, 14.0 / np.sqrt(np.pi), edge_radius_mm=0.5), found.depth_mm)
    factor, error = square_factor(found.depth_mm, 10.0, 14.0 / np.sqrt(np.pi))
    assert found.force_N == pytest.approx(round_.force_N * factor, rel=1e-3)
    width = (found.force_high_N - found.force_low_N) / 2.0 / found.force_N
    assert np.all(width > error + 0.5 * (factor - 1.0))


@pytest.mark.parametrize(
    ("change", "fidelity", "code"),
    [
        ({"edge_radius_mm": 2.2}, "axisymmetric", "out_of_range"),
        ({"edge_radius_mm": -0.5}, "axisymmetric", "out_of_range"),
        ({}, "3d", "unsupported"),
        ({"base": "friction:0.3"}, "axisymmetric", "unsupported"),
    ],
)
def test_what_a_fillet_is_not_solved_for_is_refused(change, fidelity, code):
    from dummydesign.pad.pad_under_punch import Pad
    from dummydesign.pad.predict import predict_static

    values = {"radius_mm": 7.9, "sides_mm": (14.0, 14.0), "edge_radius_mm": 0.5, **change}
    with raises_code(code):
        predict_static(Pad(10.0, 0.025, **values), [1.0], fidelity)
