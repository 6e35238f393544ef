"""Points that come to touch within a load step are tied where their gap closed, and answers hold no load step."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_pad import solve_ratio, solve_shaped_pad
from dummydesign.pad.axisymmetric.shaped_problem import FREE_STEP, shaped_problem, solve_path
from dummydesign.pad.contact.axisymmetric import AxisymmetricSurface, FlatPunch, closure
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow

LAW = Yeoh(1.0)
H, A, E = 4.5, 0.5 * 15.798, 0.0426
CROWN = read_shape("crowned:radius=21.2,height=2,foot=9.4")
PRESS = Case(A / H, PAD_EXTENT_MM / H, shape=CROWN, thickness_mm=H)


def test_a_contact_that_grows_closes_evenly_from_its_old_edge_to_its_new_one():
    r = np.arange(10.0)
    share = closure(r, r < 3.0, r < 7.0, np.zeros(10))
    assert share[3:7] == pytest.approx((r[3:7] - 2.5) / 4.0)
    assert np.all(share[7:] == 1.0)
    backwards = closure(r, r > 6.0, r > 2.0, np.zeros(10))
    assert backwards[3:7] == pytest.approx(share[3:7][::-1])


def test_a_contact_of_its_own_closes_in_the_order_of_its_gaps():
    r = np.linspace(0.0, 1.0, 11)
    share = closure(r, np.zeros(11, bool), r < 0.65, r**2)
    assert share[:7] == pytest.approx(r[:7] ** 2 / 0.49)
    assert np.all(closure(r, r < 0.65, r < 0.65, r**2) == 1.0)


def test_a_point_is_tied_on_its_way_not_where_the_step_ends():
    nodes = np.array([[1.0, 1.5, 2.0], [0.0, 0.0, 0.0]])
    surface = AxisymmetricSurface(
        nodes, np.array([[0, 1, 2]]), np.ones_like, np.zeros_like, 1.0, 0.0, ties_within_step=True
    )
    punch = FlatPunch(10.0, 5.0)
    start = np.array([0.0, -0.1, 0.0, -0.2, 0.0, -0.3])
    surface.settle(start, punch, 0.0)
    end = start.copy()
    end[::2] += 0.4
    assert surface.tie(end, punch, 0.5)
    slipped = surface._spot[0, :, 0] - (surface.points(0 * end)[0, :, 0])
    room = -surface.points(start)[0, :, 1]
    assert slipped == pytest.approx(0.4 * room / room.max())
    surface.begin()
    assert not surface._held.any()


def forces(depths, cells=6):
    path = solve_path(PRESS, np.array(depths), cells)
    return dict(zip(np.round(path.depth, 6), path.force))


def test_the_force_on_a_crown_is_the_same_whatever_other_depths_are_asked_for():
    few, some, many = forces([0.15]), forces([0.04, 0.1, 0.15, 0.17]), forces(np.arange(1, 17) * 0.0097)
    assert some[0.15] == pytest.approx(few[0.15], rel=3e-4)
    last = 16 * 0.0097
    assert many[round(last, 6)] == pytest.approx(forces([last])[round(last, 6)], rel=3e-4)


@pytest.mark.slow
def test_steps_of_a_third_hardly_move_the_force_where_ties_at_the_end_of_a_step_moved_it_by_per_cents():
    depths = [0.1, 0.15, 0.2]

    def force(step, ties):
        problem = shaped_problem(PRESS, 8)
        problem.surface._within = ties
        return follow(problem, depths, 0.005, step, 1e-4, lattice=True).force

    tied, fine = force(0.015, True), force(0.005, True)
    assert tied == pytest.approx(fine, rel=8e-3)
    assert np.all(force(FREE_STEP, False)[1:] < 0.98 * fine[1:])


@pytest.mark.slow
def test_the_forefingers_crown_agrees_with_an_independent_code_carried_to_steps_of_zero():
    # Another element and program, contact tied on touching, steps and edge carried to their limits.
    known = {0.15: 1.047, 0.2: 2.47, 0.25: 5.30}
    curve = solve_shaped_pad(Pad(H, E, A, geometry=CROWN), H * np.array(list(known)))
    other = solve_shaped_pad(Pad(H, E, A, geometry=CROWN), H * np.append(np.linspace(0.02, 0.24, 8), 0.25))
    assert other.force_N[-1] == pytest.approx(curve.force_N[-1], rel=3e-3)
    assert curve.force_N == pytest.approx(list(known.values()), rel=6e-3)
    assert np.all(np.abs(curve.force_N - list(known.values())) < curve.error_N)


@pytest.mark.slow
@pytest.mark.parametrize(("condition", "base"), [("friction:0.3", "bonded"), ("bonded", "friction:0.3")])
def test_flat_faces_with_friction_and_resting_pads_do_not_depend_on_the_list_of_depths(condition, base):
    found = []
    for depths in ([0.2], [0.05, 0.1, 0.15, 0.2], np.arange(1, 21) * 0.01):
        answer = solve_ratio(Case(0.79, 7.57, base, condition, weight=0.01), np.array(depths))
        found.append(answer["ratio"][-1])
    assert np.ptp(found) < 3e-3 * np.mean(found)
