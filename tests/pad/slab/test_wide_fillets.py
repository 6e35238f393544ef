"""Slabs that slide or rub along a wide fillet, which few cells are enough for: between each other, in equilibrium,
columns that keep to the fillet, paths that end early.
"""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.progress import reporting_depths
from dummydesign.pad.axisymmetric import filleted
from dummydesign.pad.axisymmetric.case import Case, extend_path, of_two_meshes
from dummydesign.pad.axisymmetric.filleted import (
    COARSE,
    GRIPS,
    INWARDS,
    OUTWARDS,
    SLIDING_ERROR,
    SMALLEST_SLIDE,
    SPAN,
    SlidingMesh,
    follow_rubbing,
    follow_sliding,
    rubbing_problem,
    solve_rubbing,
    solve_sliding,
    solve_under_fillet,
)
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve import continuation
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.solve.equilibrium import Failure, find_equilibrium
from tests.support.rubbing import tractions

FIRST = 0.02 / 32.0
DEPTHS = np.array([FIRST, 0.02, 0.04, 0.06])


def case(condition: str = "frictionless") -> Case:
    return Case(0.8, 2.4, condition=condition, edge=0.24)


@pytest.fixture(scope="module")
def slid():
    """A mesh that followed the fillet, its path, and at every depth the force, what the punch pushes, and u."""
    mesh, seen = SlidingMesh(case(), COARSE), []

    def visit(depth, solution):
        push = mesh.problem.surface.forces(solution.u, mesh.punch, depth)[0]
        nodes = mesh.problem.solid.mesh.nodes.T
        seen.append((depth, mesh.problem.force(solution.state), push.reshape(-1, 2), nodes + solution.u.reshape(-1, 2)))

    told = []
    with reporting_depths(told.append):
        path = follow_sliding(mesh, DEPTHS, visit)
    assert told == pytest.approx(DEPTHS)
    return mesh, path, seen


@pytest.fixture(scope="module")
def rubbed():
    """Forces at the same depths by the friction of the face, on cells that do not move."""
    return {
        condition: follow_rubbing(rubbing_problem(case(condition), COARSE), DEPTHS).force
        for condition in ("friction:0.05", "friction:0.1")
    }


def test_a_sliding_face_is_met_at_every_depth_and_carried_by_base_and_punch_alike(slid):
    mesh, path, seen = slid
    assert path.depth == pytest.approx(DEPTHS) and path.stop is None
    assert [row[0] for row in seen] == pytest.approx(DEPTHS) and [row[1] for row in seen] == pytest.approx(path.force)
    for _, force, push, _ in seen[1:]:
        assert push[:, 1].sum() == pytest.approx(force, rel=1e-3)
    assert np.all(np.diff(path.force / path.depth) > 0.0)
    assert 0.5 < path.smallest_J.min() <= path.smallest_J.max() <= 1.0 and path.unknowns == mesh.problem.pattern.n
    assert len(DEPTHS) <= path.load_steps <= path.newton_iterations and path.seconds > 0.0
    # Carried on straight in the frame of the punch, a state hardly needs more than one tangent.
    assert path.newton_iterations < 2 * path.load_steps


def test_columns_begin_where_the_fillet_begins_while_the_face_slides_round_it(slid):
    """What is on the fillet's start at rest has gone on to it; the mesh has been moved inwards instead."""
    mesh, _, seen = slid
    depth, _, _, places = seen[-1]
    start = np.argmin(np.abs(mesh.problem.solid.mesh.nodes[0, mesh.face] - mesh.edge))
    assert mesh.edge < 0.99 * mesh.punch.flat_radius
    way = mesh.punch.outline(places[mesh.face], depth)
    cell = SPAN * 0.24 / COARSE
    assert abs(way[start] - mesh.punch.flat_radius) < 0.2 * cell
    at_rest = mesh.problem.solid.mesh.nodes[0, mesh.face]
    on_fillet = (at_rest >= mesh.edge - 1e-9) & (at_rest <= mesh.edge + SPAN * 0.24 + 1e-9)
    chords = np.diff(way[on_fillet][::2]) / np.diff(at_rest[on_fillet][::2])
    assert mesh.stretch((places - mesh.problem.solid.mesh.nodes.T).ravel(), depth) >= chords.max() - 1e-12


def test_friction_that_vanishes_is_a_face_that_slides_on_a_mesh_that_moves(slid, rubbed):
    """What little friction adds is in proportion to it; cells this large are 2 % off."""
    half, whole = (rubbed[name] for name in ("friction:0.05", "friction:0.1"))
    assert 2.0 * half[1:] - whole[1:] == pytest.approx(slid[1].force[1:], rel=0.02)
    assert np.all(half[1:] < whole[1:]) and np.all(slid[1].force[1:] < whole[1:])


def test_other_depths_on_the_way_hardly_change_a_sliding_face(slid):
    alone = follow_sliding(SlidingMesh(case(), COARSE), DEPTHS[[0, 3]])
    assert alone.force == pytest.approx(slid[1].force[[0, 3]], rel=3e-4)


def test_columns_come_to_the_start_of_the_fillet_and_carry_a_linear_field_with_them():
    mesh = SlidingMesh(case(), COARSE)
    flat, shares, misses = mesh.punch.flat_radius, np.array([0.97, 1.0]), []
    edge = flat
    for _ in range(12):
        nodes = mesh.problem.solid.mesh.nodes.T
        misses.append(mesh.punch.outline(np.array([[0.97 * edge, 0.0]]), 0.0)[0] - flat)
        further, places = mesh.nearer(edge, nodes * shares, 0.0)
        assert abs(further - edge) <= 0.5 * SPAN * 0.24 / COARSE + 1e-12
        mesh.move(further)
        assert places == pytest.approx(mesh.problem.solid.mesh.nodes.T * shares, abs=1e-12)
        edge = further
    assert np.all(np.diff(np.abs(misses)) < 0.0) and abs(misses[-1]) < 0.01 * abs(misses[0])
    # A column is where it is named, the rim and the axis stay.
    r = np.unique(mesh.problem.solid.mesh.nodes[0].round(9))
    assert np.abs(r - edge).min() < 1e-8 and (r[0], r[-1]) == (0.0, 2.4)


@pytest.mark.parametrize("power", [0.5, 2.0])
def test_the_stretch_of_the_face_is_the_largest_over_the_fillet_and_beside_it(power):
    """A face drawn out by a power of its radius and still flat: the largest chord is at one of the ends."""
    mesh = SlidingMesh(case(), COARSE)
    nodes, flat, cell = mesh.problem.solid.mesh.nodes, mesh.punch.flat_radius, SPAN * 0.24 / COARSE
    u = np.stack([0.4 * (nodes[0] / flat) ** power * flat - nodes[0], 0.0 * nodes[0]], axis=1)
    lines = np.unique(nodes[0].round(9))[::2]
    start = np.argmin(np.abs(lines - flat))
    chosen = lines[start - 1 : start + 1] if power < 1.0 else lines[start + COARSE - 1 : start + COARSE + 1]
    ends = 0.4 * (chosen / flat) ** power * flat
    assert mesh.stretch(u.ravel(), 0.0) == pytest.approx(float(np.diff(ends)[0] / np.diff(chosen)[0]), rel=1e-6)
    assert lines[start + COARSE] == pytest.approx(flat + COARSE * cell)


def test_a_sliding_path_that_cannot_go_on_halves_its_steps_and_says_how_far_it_got(monkeypatch):
    failed = []

    def walled(problem, u, p, depth, *how, **more):
        if depth <= 0.0213:
            return find_equilibrium(problem, u, p, depth, *how, **more)
        failed.append(depth)
        return Failure("a wall", 3)

    monkeypatch.setattr(continuation, "find_equilibrium", walled)
    path = follow_sliding(SlidingMesh(case(), COARSE), DEPTHS)
    assert path.depth == pytest.approx(DEPTHS[:2])
    assert all(one in path.stop for one in ("a wall", "0.021", "1.0"))
    assert path.newton_iterations >= path.load_steps + 3 * len(failed)
    # The last step that failed was less than two of the smallest; no step before it was tried twice.
    assert min(failed) - 0.0213 < 2.0 * SMALLEST_SLIDE and len(failed) == len(set(failed)) > 3


def test_the_mesh_of_a_face_that_rubs_has_even_cells_round_the_fillet_and_contact_beyond_it():
    problem, fillet = rubbing_problem(case("friction:0.3"), COARSE), 0.24
    mesh, flat = problem.solid.mesh, 0.8 - fillet
    corners = np.unique(mesh.nodes[0, meshes.cell_nodes(mesh)[:, :4]].round(9))
    inwards = min(INWARDS * fillet, 0.5 * flat)
    near = corners[(corners > flat - inwards - 1e-6) & (corners < flat + OUTWARDS * fillet + 1e-6)]
    assert np.diff(near) == pytest.approx(fillet / COARSE, rel=0.2)
    assert near[0] == pytest.approx(flat - inwards) and near[-1] == pytest.approx(flat + OUTWARDS * fillet)
    reach = problem.surface.points(np.zeros(mesh.size))[..., 0]
    assert reach.min() < 0.02 and 0.8 < reach.max() <= 0.8 + 0.8 * 0.8 + 0.3
    carried = mesh.nodes[0, problem.carried // 2]
    under = (mesh.nodes[1] > -1e-9) & (mesh.nodes[0] <= flat + 1e-9)
    assert carried.max() <= flat + 1e-9 and len(carried) == under.sum()


def test_points_of_a_face_that_rubs_stay_in_coulombs_cone_and_are_dragged_inwards():
    problem, seen = rubbing_problem(case("friction:0.2"), COARSE), []

    def visit(depth, solution):
        way, pressure, drag = tractions(problem.surface, solution.u, problem.punch, depth)
        assert np.all(np.diff(way) >= 0.0) and np.all(np.abs(drag) <= 0.2 * pressure * (1.0 + 1e-12))
        push = problem.surface.forces(solution.u, problem.punch, depth)[0]
        assert push[1::2].sum() == pytest.approx(problem.force(solution.state), rel=1e-3)
        seen.append((drag > 0.0).mean())

    path = follow_rubbing(problem, DEPTHS[:2], visit)
    assert path.stop is None and len(seen) == 2 and seen[-1] > 0.8


@pytest.fixture(scope="module")
def curves():
    """Of a pad in mm, by what its face does."""
    pads = {
        name: Pad(10.0, 0.03, 8.0, edge_radius_mm=2.4, extent_mm=24.0, condition=name)
        for name in ("frictionless", "friction:0.1")
    }
    return {name: solve_under_fillet(pad, [0.1, 0.2]) for name, pad in pads.items()}


def test_a_curve_has_the_depths_asked_for_and_rises_with_friction(curves):
    for curve in curves.values():
        assert curve.depth_mm == pytest.approx([0.1, 0.2]) and curve.notes == ()
        share = curve.error_N / curve.force_N
        assert np.all((share > 1e-3) & (share < 0.06))
    free, rubs = (curves[name].force_N for name in ("frictionless", "friction:0.1"))
    assert np.all(free < rubs) and np.all(rubs < 1.03 * free)


def test_a_curve_is_that_of_its_path_in_thicknesses(curves, slid, rubbed):
    """Shear modulus times thickness squared times the force of the coarse path, within the error stated for it."""
    for name, path in (("frictionless", slid[1].force), ("friction:0.1", rubbed["friction:0.1"])):
        apart = np.abs(curves[name].force_N[1] - 0.01 * 10.0**2 * path[1])
        assert apart < curves[name].error_N[1]


@pytest.mark.parametrize("condition", ["frictionless", "friction:0.1"])
def test_a_curve_is_in_proportion_to_the_modulus_and_to_the_square_of_all_lengths(condition, curves):
    large = Pad(30.0, 0.06, 24.0, edge_radius_mm=7.2, extent_mm=72.0, condition=condition)
    assert solve_under_fillet(large, [0.3, 0.6]).force_N == pytest.approx(18.0 * curves[condition].force_N, rel=1e-4)


def made(force, stop=None) -> ForcePath:
    depth = 0.1 * np.arange(1, len(force) + 1)
    return ForcePath(depth, np.array(force), np.ones(len(force)), 10, 2, 5, 0.5, stop)


NODES = 0.1 * np.arange(1, 5)


def test_of_two_meshes_the_finer_one_counts_as_far_as_it_gets():
    fine, coarse = made([1.0, 2.0], "short"), made([1.01, 2.04, 3.06, 4.08])
    found = of_two_meshes(coarse, fine, NODES, 1e-3)
    assert found["depth"] == pytest.approx(NODES) and found["stop"] is None
    # Beyond, the coarse one with what the meshes differed by last; its error is then counted twice.
    assert found["stiffness"] == pytest.approx(np.array([1.0, 2.0, 3.0, 4.0]) / NODES)
    steps = np.log([1.01, 1.02, 1.02, 1.02])
    assert found["error"] == pytest.approx(1e-3 + np.array([1.0, 1.0, 2.0, 2.0]) * steps)
    assert found["solver"] == {"unknowns": 10, "load_steps": 4, "newton_iterations": 10, "seconds": 1.0}


def test_of_two_meshes_a_coarse_one_that_ends_first_leaves_its_difference_as_error():
    found = of_two_meshes(made([1.04, 2.02], "coarse"), made([1.0, 2.0, 3.0], "fine"), NODES, 1e-3)
    assert found["stiffness"] == pytest.approx(np.array([1.0, 2.0, 3.0]) / NODES[:3]) and found["stop"] == "fine"
    # The largest difference so far, also where single ones are smaller.
    assert found["error"] == pytest.approx(1e-3 + np.log(1.04) * np.array([1.0, 1.0, 2.0]))
    same = of_two_meshes(made([1.0], "both"), made([1.0], "both"), NODES, 1e-3)
    assert same["error"] == pytest.approx([1e-3]) and same["stop"] == "both"


def test_a_path_that_is_extended_has_the_forces_of_both_and_their_cost():
    short, long = made([1.0, 2.0], "a"), made([1.1, 2.2, 3.3], "b")
    longer = extend_path(short, long, np.array([3.0]))
    assert longer.force.tolist() == [1.0, 2.0, 3.0] and longer.depth == pytest.approx(long.depth)
    assert (longer.load_steps, longer.newton_iterations, longer.seconds, longer.stop) == (4, 10, 1.0, "b")
    kept = extend_path(short, long, np.array([]))
    assert kept.force.tolist() == [1.0, 2.0] and (kept.load_steps, kept.newton_iterations) == (4, 10)


def rubbing_with(monkeypatch, paths):
    """``solve_rubbing`` with made-up paths by cells and grip."""
    monkeypatch.setattr(filleted, "rubbing_problem", lambda case, cells, grip=1.0: (cells, grip))
    monkeypatch.setattr(filleted, "follow_rubbing", lambda problem, nodes: paths[problem])
    return solve_rubbing(case("friction:0.3"), NODES)


def test_a_rubbing_path_that_ends_early_goes_on_with_the_softer_grip_and_doubts_it(monkeypatch):
    full, soft = GRIPS
    coarse, fine = filleted.COARSE, filleted.FINE
    paths = {
        (coarse, full): made([1.0, 2.0, 3.0, 4.0]),
        (fine, full): made([1.0, 2.0], "grip"),
        (fine, soft): made([0.98, 1.96, 2.94, 3.92]),
    }
    found = rubbing_with(monkeypatch, paths)
    # Made equal to the harder grip at the last depth that both reached, it goes on as that would.
    assert found["stiffness"] == pytest.approx(np.full(4, 10.0)) and found["stop"] is None
    doubt = np.log(2.0 / 1.96)
    assert found["error"] == pytest.approx(filleted.RUBBING_ERROR + np.array([0.0, 0.0, doubt, doubt]))
    whole = rubbing_with(monkeypatch, {key: made([1.0, 2.0, 3.0, 4.0]) for key in ((coarse, full), (fine, full))})
    assert whole["error"] == pytest.approx(np.full(4, filleted.RUBBING_ERROR))


def test_a_rubbing_path_of_the_softer_grip_alone_is_doubted_from_the_start(monkeypatch):
    full, soft = GRIPS
    coarse, fine = filleted.COARSE, filleted.FINE
    paths = {(coarse, full): made([1.0, 2.0, 3.0]), (fine, full): made([], "at once"), (fine, soft): made([1.0, 2.0])}
    found = rubbing_with(monkeypatch, paths)
    assert np.all(found["error"][:2] == pytest.approx(filleted.RUBBING_ERROR + filleted.SOFTER_ERROR))
    # Where the fine cells ended, the doubt in the coarse ones' grip follows; theirs is none, so the earlier one stays.
    assert found["error"][2] == pytest.approx(filleted.RUBBING_ERROR + filleted.SOFTER_ERROR)


def test_a_sliding_solve_takes_both_meshes(monkeypatch):
    monkeypatch.setattr(filleted, "SlidingMesh", lambda case, cells: cells)
    forces = {filleted.COARSE: [1.02, 2.04], filleted.FINE: [1.0, 2.0, 3.0]}
    monkeypatch.setattr(filleted, "follow_sliding", lambda cells, nodes: made(forces[cells]))
    found = solve_sliding(case(), NODES)
    assert found["stiffness"] == pytest.approx(np.full(3, 10.0))
    assert found["error"] == pytest.approx(SLIDING_ERROR + np.log(1.02) * np.array([1.0, 1.0, 2.0]))
