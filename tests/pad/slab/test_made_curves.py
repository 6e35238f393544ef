"""Curves of fillets, balls, pucks and motions from made-up paths: units, extrapolation, errors, ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.pad.axisymmetric import case as cases
from dummydesign.pad.axisymmetric import filleted, finite_strain, profile_punch, puck
from dummydesign.pad.axisymmetric.case import Case, first_stiffness, solve_on_lattice
from dummydesign.pad.axisymmetric.filleted import LEAST_ERROR, MESH_LEFT, solve_filleted
from dummydesign.pad.axisymmetric.finite_strain import RatioPath, nodes_of_motion, ratio_error, solve_ratio
from dummydesign.pad.axisymmetric.profile_punch import load_steps, profile, relative_punch, solve_profile
from dummydesign.pad.axisymmetric.puck import CORNER_CELLS, MESH_ERROR, RoughPlate, UnitPuck, puck_problem, solve_puck
from dummydesign.pad.force_law import NO_COST
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.solve.continuation import ForcePath, add_costs, cost
from tests.support.ball_punch import sphere


def made(depth, force, stop=None) -> ForcePath:
    return ForcePath(np.array(depth), np.array(force), np.ones(len(depth)), 9, 2, 5, 0.5, stop)


NODES = 0.02 * np.array([0.5, 1.0, 2.0, 3.0])


def test_a_fillet_is_extrapolated_by_half_of_what_larger_cells_changed_and_starts_with_its_flat_face(monkeypatch):
    case = Case(0.8, 2.4, edge=0.2)
    small, large = 2.0 * NODES * np.exp([0.0, 0.01, 0.02, 0.03]), 2.0 * NODES[:3] * np.exp(-0.02)
    paths = {1.0: made(NODES, small), 2.0: made(NODES[:3], large)}
    monkeypatch.setattr(filleted, "filleted_problem", lambda case, sides, coarser: coarser)
    monkeypatch.setattr(filleted, "follow_filleted", lambda coarser, nodes: paths[coarser])
    found = solve_filleted(case, NODES)
    face = replace(case, radius=0.6)
    assert found["depth"] == pytest.approx([0.0, *NODES])
    assert found["stiffness"][0] == pytest.approx(3.0 * 0.6 * first_stiffness(face))
    # Where the larger cells end the last change is counted twice.
    steps = np.array([0.02, 0.03, 0.04, 0.08])
    logs = np.array([0.0, 0.01, 0.02, 0.03]) + MESH_LEFT * steps
    assert found["stiffness"][1:] == pytest.approx(2.0 * np.exp(logs))
    assert found["error"] == pytest.approx([LEAST_ERROR, *(LEAST_ERROR + MESH_LEFT * steps)])
    assert found["solver"]["load_steps"] == 4 and found["stop"] is None


@pytest.mark.parametrize("thickness", [1.0, 8.0])
def test_a_curve_on_the_lattice_is_exact_where_its_logarithm_is_straight_over_the_root_of_depth(monkeypatch, thickness):
    asked = []

    def solve(case, nodes, reach=None):
        asked.append(nodes)
        at = nodes[: reach or len(nodes)]
        return {
            "depth": at,
            "stiffness": np.exp(1.0 + 2.0 * np.sqrt(at)),
            "error": 0.01 + 0.1 * np.sqrt(at),
            "solver": dict(NO_COST),
            "stop": "ends" if reach else None,
        }

    pad = Pad(thickness, 0.03, 0.8 * thickness, extent_mm=3.0 * thickness)
    depth = thickness * np.array([0.0313, 0.1, 0.257])
    found = solve_on_lattice("kind", pad, depth, solve)
    x = depth / thickness
    assert found.depth_mm == pytest.approx(depth) and found.notes == ()
    assert found.force_N == pytest.approx(0.01 * thickness * depth * np.exp(1.0 + 2.0 * np.sqrt(x)), rel=1e-6)
    assert found.error_N / found.force_N == pytest.approx(0.01 + 0.1 * np.sqrt(x), rel=1e-6)
    assert asked[0][-1] >= 0.257 > asked[0][-2]
    short = solve_on_lattice("kind", pad, depth, lambda case, nodes: solve(case, nodes, 9))
    assert short.depth_mm == pytest.approx(depth[depth <= asked[0][8] * thickness])
    assert "ends" in short.notes[0] and "0.257" in short.notes[0]
    with pytest.raises(NoAnswerError, match="ends"):
        solve_on_lattice("kind", pad, depth, lambda case, nodes: solve(case, nodes, 2))
    alone = solve_on_lattice("kind", pad, depth[:1], lambda case, nodes: solve(case, nodes[-1:]))
    last = cases.lattice_depths(0.0313)[-1]
    assert alone.force_N == pytest.approx(0.01 * thickness * depth[:1] * np.exp(1.0 + 2.0 * np.sqrt(last)))


def test_costs_add_up_but_for_the_largest_number_of_unknowns():
    small, large = made([0.1], [1.0]), replace(made([0.1], [1.0]), unknowns=40, seconds=2.0)
    assert cost([small, large]) == {"unknowns": 40, "load_steps": 4, "newton_iterations": 10, "seconds": 2.5}
    assert add_costs(cost([large]), cost([small, small]))["newton_iterations"] == 15


@pytest.mark.parametrize("condition", ["frictionless", "bonded", "friction:0.3"])
def test_a_ball_states_a_third_of_what_cells_of_twice_the_size_change(monkeypatch, condition):
    asked = []
    depth = np.array([0.05, 0.1, 0.2])

    def problem(case, punch, first, cells):
        asked.append((first, cells))
        return cells

    def follow(cells, depths, first, largest, smallest, lattice):
        asked.append((first, largest, smallest, lattice))
        return made(depths[:2], depths[:2] * np.exp(0.03)) if cells == 12 else made(depths, depths, None)

    monkeypatch.setattr(profile_punch, "profile_problem", problem)
    monkeypatch.setattr(profile_punch, "follow", follow)
    found = solve_profile(Pad(10.0, 0.03, 6.0, condition=condition), 10.0 * depth, sphere(20.0))
    assert found.force_N == pytest.approx(0.01 * 100.0 * depth) and found.depth_mm == pytest.approx(10.0 * depth)
    least = profile_punch.LEAST_ERROR[condition.partition(":")[0]]
    assert found.error_N / found.force_N == pytest.approx(np.full(3, least + 0.01))
    assert asked[:2] == [(0.05, 24), (0.05, 12)]
    first, largest, lattice = load_steps(condition, 0.05)
    assert asked[2:] == [(first, largest, pytest.approx(first / 64.0), lattice)] * 2
    assert first <= 0.25 * 0.05 and first < largest and lattice == (condition != "frictionless")


@pytest.mark.parametrize("of_pad", [True, False])
def test_a_profile_in_thicknesses_has_the_derivatives_of_the_one_in_millimetres(of_pad):
    """By differences; under the points it is met, beyond them it goes on straight, on the axis it is flat."""
    r = np.linspace(0.0, 6.0, 13)
    points = (tuple(r), tuple(0.03 * r**2 + 0.001 * r**3))
    pad = Pad(8.0, 0.03, 6.0, condition="frictionless", profile_mm=points)
    punch = relative_punch(pad, None if of_pad else profile(*points))
    assert punch.height(r / 8.0)[0] == pytest.approx(np.array(points[1]) / 8.0)
    at, step = np.array([0.11, 0.37, 0.6, 0.9]), 1e-5
    value, slope, second, third = punch.height(at)
    up, down = punch.height(at + step), punch.height(at - step)
    assert slope == pytest.approx((up[0] - down[0]) / (2.0 * step), rel=1e-4)
    assert second == pytest.approx((up[1] - down[1]) / (2.0 * step), abs=1e-3)
    assert third[:3] == pytest.approx(((up[2] - down[2]) / (2.0 * step))[:3], abs=1e-2) and third[3] == second[3] == 0.0
    edge = punch.height(np.array([0.75]))
    assert value[3] == pytest.approx(float(edge[0][0] + 0.15 * edge[1][0]))
    assert punch.height(np.array([0.0]))[1] == pytest.approx([0.0], abs=1e-12)


def plate(friction: float) -> RoughPlate:
    nodes = np.array([[0.0, 0.25, 0.5, 0.5, 0.5], [0.0, 0.0, 0.0, -0.02, -0.04]])
    return RoughPlate(nodes, np.array([[0, 1, 2], [2, 3, 4]]), 50.0, friction, 1e-3)


@pytest.mark.parametrize("friction", [0.3, np.inf])
def test_the_plate_of_a_puck_pushes_and_drags_with_an_exact_derivative(friction):
    contact, rng = plate(friction), np.random.default_rng(2)
    u = 2e-3 * rng.standard_normal(10)
    contact.settle(u, None, 0.03)
    u = u + 1e-3 * rng.standard_normal(10)
    force, matrix = contact.forces(u, None, 0.05)
    whole = np.zeros((10, 10))
    for dofs, part in zip(contact.dofs, matrix):
        whole[np.ix_(dofs, dofs)] += part
    for k in range(10):
        step = 1e-8 * np.eye(10)[k]
        rate = (contact.forces(u + step, None, 0.05)[0] - contact.forces(u - step, None, 0.05)[0]) / 2e-8
        assert rate == pytest.approx(whole[:, k], abs=2e-5 * np.abs(whole).max())
    assert force[1::2].sum() > 0.0


def test_the_plate_of_a_puck_counts_slip_from_first_touch_and_stays_in_coulombs_cone():
    contact, even = plate(0.3), np.zeros(10)
    aside = even.copy()
    aside[0::2] = 0.05
    force = contact.forces(aside, None, 0.002)[0]
    # End face alone, slipped fifty times the scale: the limit; what of the side touches later slips from there.
    assert force[1::2].sum() == pytest.approx(50.0 * np.pi * 0.25 * 0.002, rel=1e-6)
    assert force[0::2].sum() == pytest.approx(0.3 * force[1::2].sum(), rel=2e-3)
    deep = plate(0.3)
    deep.settle(aside, None, 0.06)
    side = deep.forces(aside, None, 0.06)[0] - contact.forces(aside, None, 0.06)[0]
    assert side[0::2].sum() == pytest.approx(0.0, abs=1e-9) and not contact.forces(even, None, -0.01)[0].any()


@pytest.mark.parametrize("plates", ["frictionless", "friction:0.3", "bonded"])
def test_half_a_puck_is_meshed_finest_at_its_edge_and_held_by_its_plates(plates):
    problem = puck_problem(UnitPuck(0.8, plates), Yeoh(1.0), corner=0.05)
    mesh = problem.solid.mesh
    assert mesh.weight.sum() == pytest.approx(np.pi * 0.64 * 0.5)
    r = np.unique(mesh.nodes[0].round(9))
    assert np.diff(r)[-1] < 0.5 * np.diff(r)[0] and mesh.nodes[1].min() == -0.5
    driven = len(problem.driven)
    top = np.sum(np.abs(mesh.nodes[1]) < 1e-9)
    assert driven == (0 if plates == "friction:0.3" else top)
    assert (problem.surface is None) == (plates == "frictionless")
    assert UnitPuck(0.8, plates).friction == {"frictionless": 0.0, "friction:0.3": 0.3, "bonded": np.inf}[plates]


@pytest.mark.parametrize("shear", [0.5, 3.0])
def test_the_plate_of_a_puck_is_as_much_harder_as_the_gel(shear):
    problem = puck_problem(UnitPuck(0.8, "friction:0.3"), Yeoh(shear), corner=0.05)
    force = problem.surface.forces(np.zeros(problem.solid.mesh.size), None, 1e-6)[0]
    assert force[1::2].sum() == pytest.approx(puck.PUCK_PLATES.contact * shear * 1e-6 * np.pi * 0.64, rel=1e-3)


def test_a_puck_takes_the_mesh_that_gets_farthest_and_has_its_units(monkeypatch):
    asked, reach = [], {0.01: 1, 0.02: 3, 0.014: 2, 0.03: 2}

    def compress(unit, law, compression, poisson, corner=CORNER_CELLS[0]):
        asked.append((unit.radius, corner))
        count = reach[corner]
        return made(0.5 * compression[:count], 3.0 * compression[:count], None if count == 4 else f"cells of {corner}")

    monkeypatch.setattr(puck, "compress", compress)
    found = solve_puck(Puck(30.0, 0.03, 50.0, plates="bonded"), [0.0, 3.0, 6.0, 9.0, 12.0])
    assert [one for _, one in asked] == list(CORNER_CELLS) and asked[0][0] == pytest.approx(25.0 / 30.0)
    assert found.depth_mm == pytest.approx([0.0, 3.0, 6.0, 9.0]) and found.notes == ("cells of 0.02",)
    assert found.force_N == pytest.approx(0.01 * 900.0 * 3.0 * np.array([0.0, 0.1, 0.2, 0.3]))
    assert found.error_N == pytest.approx(MESH_ERROR * found.force_N)
    reach[0.01] = 4
    asked.clear()
    assert solve_puck(Puck(30.0, 0.03, 50.0), [3.0, 6.0, 9.0, 12.0]).notes == () and len(asked) == 1
    reach.update(dict.fromkeys(CORNER_CELLS, 0))
    with pytest.raises(NoAnswerError):
        solve_puck(Puck(30.0, 0.03, 50.0, plates="friction:0.1"), [3.0])
    assert solve_puck(Puck(30.0, 0.03, 50.0), [0.0]).force_N.tolist() == [0.0]


ARMS = (PronyTerm(0.1, 0.5),)
TIME = np.array([0.0, 0.1, 0.2, 1.0])
DEPTH = np.array([0.0, 0.1, 0.2, 0.2])


def test_the_ratio_to_the_separable_force_is_one_where_there_is_next_to_no_force():
    path = RatioPath(TIME, DEPTH, DEPTH, np.array([0.0, 1e-9, 2.0, -1.0]), np.array([0.0, 5.0, 2.2, -0.9]), {})
    assert path.ratio == pytest.approx([1.0, 1.0, 1.1, 0.9])
    assert ratio_error(0.05) == pytest.approx(2.0 * ratio_error(0.025)) and 0.0 < ratio_error(0.025) < 0.05


def motions(monkeypatch, ends, over=lambda rim: 1.0 + rim):
    """``follow_motion`` with made-up forces by problem; what was asked."""
    asked = []

    def follow(problem, time, depth, largest, check):
        kind, case, rim = problem
        relaxing = bool(case.law.prony)
        asked.append((kind, rim, largest, relaxing))
        elastic = 2.0 * depth
        force = over(rim if kind == "slab" else -rim) * relaxed_force(time, elastic, ARMS) if relaxing else elastic
        stop = ends.get((kind, rim, relaxing))
        return ForcePath(depth, force, np.ones(len(depth)), 9, 2, 5, 0.5, stop)

    monkeypatch.setattr(finite_strain, "follow_motion", follow)
    monkeypatch.setattr(finite_strain, "rimmed_problem", lambda case, rim, resolution: ("slab", case, rim / case.scale))
    kinds = {True: "twin", False: "pad"}
    shaped = lambda case, cells, rim, twin, refinement: (kinds[twin], case, rim)  # noqa: E731
    monkeypatch.setattr(finite_strain, "shaped_problem", shaped)
    return asked


def test_a_slab_in_motion_takes_the_first_fillet_that_gets_there(monkeypatch):
    asked = motions(monkeypatch, {("slab", 0.025, True): "folds", ("slab", 0.05, False): "folds"})
    found = solve_ratio(Case(0.5, 3.0), ARMS, TIME, DEPTH)
    assert [(rim, relaxing) for _, rim, _, relaxing in asked] == [
        (0.025, False), (0.025, True), (0.05, False), (0.1, False), (0.1, True),
    ]  # fmt: skip
    assert found.solver["rim_over_scale"] == 0.1 and found.ratio[1:] == pytest.approx(np.full(3, 1.1))
    assert found.separable == pytest.approx(relaxed_force(TIME, 2.0 * DEPTH, ARMS)) and found.solver["load_steps"] == 4
    assert asked[0][2] == pytest.approx(0.05 * 0.5)
    motions(monkeypatch, {("slab", rim, True): "folds" for rim in finite_strain.SLAB_RIMS})
    with pytest.raises(NoAnswerError, match="folds"):
        solve_ratio(Case(0.5, 3.0), ARMS, TIME, DEPTH)


def test_a_flat_top_in_motion_departs_as_its_slab_does_and_by_what_it_is_not_its_twin(monkeypatch):
    """Pad and twin 5 % below on their cells, a fine slab 2.5 % above: the pad's own share of the edge is left out."""
    asked = motions(monkeypatch, {}, lambda rim: 1.0 + rim)
    case = Case(0.5, 3.0, shape=Layered(4.0, 2.0), thickness_mm=10.0)
    found = solve_ratio(case, ARMS, TIME, DEPTH)
    assert {kind for kind, *_ in asked} == {"pad", "twin", "slab"}
    assert found.ratio[1:] == pytest.approx(np.full(3, 0.95 + 1.025 - 0.95))
    assert found.solver["load_steps"] == 12 and found.force == pytest.approx(found.ratio * found.separable)
    largest = {kind: step for kind, _, step, _ in asked}
    assert largest["pad"] == largest["twin"] == pytest.approx(finite_strain.FLAT_STEP * 16.0 / finite_strain.CELLS)


def test_a_motion_at_half_the_fineness_is_followed_at_fewer_times():
    time = np.linspace(0.0, 2.0, 2001)
    depth = 0.3 * np.minimum(time / 0.5, 1.0)
    (plain, at), (fine, closer) = (nodes_of_motion(time, depth, ARMS, fineness) for fineness in (1, 2))
    assert 1.6 < len(fine) / len(plain) < 2.4
    for nodes, depths, share in ((plain, at, 1.0), (fine, closer, 0.5)):
        moving = nodes <= 0.5 + 1e-9
        assert np.diff(depths).max() <= share * min(0.02, 0.3 / 16.0) + 3e-4
        # In the hold a step may be as long as a quarter of the fastest arm, and 0.3 of the time since the stop.
        held = nodes[~moving]
        assert np.all(np.diff(held) <= share * np.maximum(0.25 * 0.1, 0.3 * (held[:-1] - 0.5)) + 2e-3)
        assert nodes[0] == pytest.approx(0.0, abs=0.004) and depths[0] == 0.0
        assert (nodes[-1], depths[-1]) == pytest.approx((2.0, 0.3))


def test_a_crown_in_motion_is_watched_for_folds_and_needs_no_slab(monkeypatch):
    watched = []
    asked = motions(monkeypatch, {})
    monkeypatch.setattr(finite_strain, "RoundFace", lambda problem, thickness: watched.append(thickness))
    found = solve_ratio(Case(0.5, 3.0, shape=Crowned(20.0, 2.0), thickness_mm=10.0), ARMS, TIME, DEPTH)
    assert {kind for kind, *_ in asked} == {"pad"} and watched == [10.0, 10.0]
    assert asked[0][2] == pytest.approx(finite_strain.LARGEST_STEP * 16.0 / finite_strain.CELLS)
    assert found.ratio[1:] == pytest.approx(np.full(3, 0.95)) and found.solver["rim_over_scale"] == 0.05
