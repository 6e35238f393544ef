"""Contact in space: gap and its derivatives, energy and its derivatives, closed forms, the axisymmetric form of it."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.optimize import brentq

from dummydesign.pad.contact.axisymmetric import FlatPunch
from dummydesign.pad.contact.spatial import BeadedPunch, FaceContact
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.solve import equilibrium
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import ContactProblem
from dummydesign.pad.solve.multifrontal import Dissection
from dummydesign.pad.solve.sparse import Pattern
from dummydesign.pad.spatial.square_punch import CornerCells, SquareProblem, block_problem, solve_ratios

LAW = Yeoh(1.0)


def rectangle_punch(half_sides, rim, centre=(0.0, 0.0)):
    return BeadedPunch((half_sides[0] - rim, half_sides[1] - rim), 0.0, rim, centre)


def round_punch(radius, rim):
    return BeadedPunch((0.0, 0.0), radius - rim, rim)


PUNCHES = [rectangle_punch((1.0, 0.7), 0.2, (0.3, -0.1)), round_punch(0.8, 0.2), BeadedPunch((0.3, 0.2), 0.3, 0.2)]


def block(thickness: float) -> SquareProblem:
    """The 14 mm square on the 150 x 120 mm slab."""
    return SquareProblem((7.0 / thickness,) * 2, (75.0 / thickness, 60.0 / thickness))


def points(count: int = 400):
    """Places near the face of a punch that is down by 0.1, outside and a little inside."""
    rng = np.random.default_rng(1)
    return np.concatenate([rng.uniform(-1.2, 1.2, (count, 2)), rng.uniform(-0.3, 0.05, (count, 1))], axis=1)


@pytest.mark.parametrize("punch", PUNCHES)
def test_the_gap_has_the_derivatives_it_states(punch):
    at, step = points(), 1e-6
    _, gradient, second = punch.gap(at, 0.1)
    for k, e in enumerate(np.eye(3) * step):
        (high, slope_high, _), (low, slope_low, _) = punch.gap(at + e, 0.1), punch.gap(at - e, 0.1)
        assert gradient[:, k] == pytest.approx((high - low) / (2.0 * step), abs=1e-7)
        assert second[:, :, k] == pytest.approx((slope_high - slope_low) / (2.0 * step), abs=1e-6)


def test_a_round_punch_in_space_is_the_axisymmetric_one():
    plan = np.abs(points()[:, [0, 2]]) * np.array([1.0, -0.3])
    here = np.stack([plan[:, 0], 0.0 * plan[:, 0], plan[:, 1]], axis=1)
    gap, gradient, second = round_punch(0.8, 0.2).gap(here, 0.1)
    flat = FlatPunch(0.8, 0.2).gap(plan, 0.1)
    assert gap == pytest.approx(flat[0], abs=1e-12)
    assert gradient[:, [0, 2]] == pytest.approx(flat[1], abs=1e-12)
    assert second[:, [0, 2]][:, :, [0, 2]] == pytest.approx(flat[2], abs=1e-12)


def test_the_gap_of_a_rectangle_is_the_distance_to_its_inner_core_less_the_bead():
    punch = rectangle_punch((1.0, 0.7), 0.2)
    corner = np.array([0.8, 0.5, 0.2 - 0.1])
    away = np.array([0.3, 0.4, -1.2])
    assert punch.gap(corner + away, 0.1)[0] == pytest.approx(1.3 - 0.2)


def plate(condition: str):
    """A brick 1 x 0.7 x 1 and the contact of its whole top."""
    x, y, z = np.array([0.0, 0.4, 1.0]), np.array([0.0, 0.3, 0.7]), np.array([-1.0, -0.4, 0.0])
    mesh = space.discretise(space.extrude(*space.rectangle_plan(x, y), z))
    faces = space.horizontal_faces(mesh, np.arange(4, 8))
    surface = FaceContact(mesh.nodes, faces, np.full(4, 200.0), np.full(4, 60.0 * (condition == "bonded")))
    return mesh, surface


@pytest.mark.parametrize("condition", ["bonded", "frictionless"])
def test_contact_forces_and_matrices_are_derivatives_of_one_energy(condition):
    """A matrix that is the symmetric derivative of the force has an energy; points in and out of touch."""
    mesh, surface = plate(condition)
    punch, rng = rectangle_punch((0.9, 0.6), 0.3), np.random.default_rng(2)
    surface.settle(0.01 * rng.standard_normal(mesh.size), punch, 0.05)
    u = 0.03 * rng.standard_normal(mesh.size)
    _, matrices = surface.forces(u, punch, 0.08)
    assert matrices == pytest.approx(matrices.transpose(0, 2, 1), abs=1e-12 * np.abs(matrices).max())
    du = rng.standard_normal(mesh.size)
    change = np.zeros(mesh.size)
    np.add.at(change, surface.dofs, (matrices @ du[surface.dofs][:, :, None])[:, :, 0])
    step = 1e-7
    (high, _), (low, _) = (surface.forces(u + s * du, punch, 0.08) for s in (step, -step))
    assert (high - low) / (2.0 * step) == pytest.approx(change, abs=2e-4 * np.abs(change).max())


def test_a_brick_under_a_wide_frictionless_punch_is_compressed_uniformly():
    """Closed form: nominal stress 1/l^2 - l at stretch l, in balance with the penalty on the penetration."""
    mesh, surface = plate("frictionless")
    held = np.zeros((mesh.nodes.shape[1], 3), dtype=bool)
    held[:, :2] = (mesh.nodes[:2] < 1e-9).T
    base = np.nonzero(mesh.nodes[2] < -1.0 + 1e-9)[0]
    held[base, 2] = True
    solver = partial(Dissection, position=np.indices((2, 2, 2)).reshape(3, -1))
    punch, nothing = rectangle_punch((9.0, 9.0), 0.1), np.array([], dtype=int)
    problem = ContactProblem(Solid(mesh, LAW), held.ravel(), nothing, 3 * base + 2, surface, punch, solver=solver)
    path = follow(problem, [0.1, 0.4], 0.05, 0.1, 0.001)

    def out_of_balance(stress, depth):
        stretch = 1.0 - depth + stress / 200.0
        return 1.0 / stretch**2 - stretch - stress

    stress = [brentq(out_of_balance, 0.0, 5.0, args=(depth,)) for depth in (0.1, 0.4)]
    assert path.force == pytest.approx(0.7 * np.array(stress), rel=3e-5)


def test_what_touches_a_bonded_punch_goes_along_with_it_and_comes_off_freely():
    mesh, surface = plate("bonded")
    punch = rectangle_punch((9.0, 9.0), 0.1)
    down = np.zeros(mesh.size)
    down[2::3] = -0.1
    surface.settle(down, punch, 0.1 + 1e-6)
    aside = down.copy()
    aside[0::3] += 0.01
    pull, _ = surface.forces(aside, punch, 0.1 + 1e-6)
    assert pull[0::3].sum() == pytest.approx(60.0 * 0.01 * 0.7)
    surface.settle(aside, punch, 0.05)
    assert not surface.forces(aside, punch, 0.05)[0].any()


def test_the_dissection_solves_with_faces_what_a_sparse_factorisation_solves():
    problem = block_problem(block(10.0), CornerCells(0.45), 0.45)
    solid, rng = problem.solid, np.random.default_rng(3)
    tangent = solid.linearise(solid.state(*problem.start()))
    faces = problem.pressed(np.zeros(solid.mesh.size), 0.01)[1]()
    assert np.abs(faces[0]).max() > 0.0
    load, groups = rng.standard_normal(solid.mesh.size), [solid.mesh.dofs, problem.surface.dofs]
    reference = Pattern(groups, problem.pattern.free, solid.mesh.size).solve([tangent.stiffness, *faces], load)
    found = problem.pattern.solve([tangent.stiffness, *faces], load)
    assert found == pytest.approx(reference, abs=1e-8 * np.abs(reference).max())


def test_half_of_a_quarter_under_a_square_with_a_fillet_carries_half():
    pad, depths = SquareProblem((0.7, 0.7), (5.0, 5.0)), [0.06, 0.12]
    whole, half = (block_problem(pad, CornerCells(0.45), 0.45, folded) for folded in (False, True))
    forces = [follow(problem, depths, 0.06, 0.06, 0.01).force for problem in (whole, half)]
    assert forces[1] == pytest.approx(0.5 * forces[0], rel=1e-7)


@pytest.mark.slow
def test_tangents_that_are_used_again_save_a_fifth_of_them_and_change_no_force(monkeypatch):
    """Where points come to touch, uses that hardly help are undone."""
    side = np.sqrt(75.0 * 60.0) / 20.0
    pad, scale, paths = SquareProblem((0.35, 0.35), (side, side)), 0.35 * 2.0 / np.sqrt(np.pi), []
    for below in (equilibrium.REUSE_BELOW, 0.0):
        monkeypatch.setattr(equilibrium, "REUSE_BELOW", below)
        problem = block_problem(pad, CornerCells(0.45), 0.45, True)
        paths.append(follow(problem, [0.1, 0.2], 0.13 * scale, 0.035 * scale, 2e-3 * scale))
    assert paths[0].force == pytest.approx(paths[1].force, rel=1e-5)
    assert paths[0].newton_iterations < 0.8 * paths[1].newton_iterations


def test_the_dissection_refuses_faces_that_lie_outside_their_cell():
    cells, faces = np.array([[0, 1, 2], [2, 3, 4]]), np.array([[1, 3]])
    with pytest.raises(ValueError, match="outside its cell"):
        Dissection([cells, faces], np.arange(5), 5, np.zeros((3, 2), dtype=int))


@pytest.mark.slow
def test_square_over_circle_with_a_bead_is_that_with_a_sharp_edge_where_both_exist():
    """At d/h 0.2 on a 10 mm pad, where a bead of 0.28 is off by less than 0.6 %."""
    pad = block(10.0)
    sharp = solve_ratios(pad, np.array([0.2]), CornerCells(0.36))
    beaded = solve_ratios(pad, np.array([0.2]), CornerCells(0.28), 0.28)
    assert beaded.ratio == pytest.approx(sharp.ratio, rel=6e-3)


@pytest.mark.slow
def test_square_over_circle_converges_with_the_bead_to_half_the_thickness():
    """Beads and cells of 0.28, 0.2 and 0.14 on a 10 mm pad: the last two agree within 0.6 % at every depth."""
    depths = np.array([0.3, 0.4, 0.5])
    found = [solve_ratios(block(10.0), depths, CornerCells(rim), rim) for rim in (0.28, 0.2, 0.14)]
    assert all(len(answer.depth) == 3 for answer in found)
    assert found[2].ratio == pytest.approx(found[1].ratio, rel=6e-3)
    assert np.all(np.abs(found[2].ratio - found[1].ratio) < np.abs(found[1].ratio - found[0].ratio) + 2e-3)
