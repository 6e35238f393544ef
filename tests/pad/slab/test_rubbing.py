"""A filleted punch whose face rubs: between glue and no friction, Coulomb's cone, equilibrium, steps, cells."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.case import LATTICE, Case
from dummydesign.pad.axisymmetric.filleted import COARSE, FINE, follow_rubbing, rubbing_problem, solve_under_fillet
from dummydesign.pad.fields import SLIPS, STICKS, solve_fields
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.equilibrium import Equilibrium
from tests.support.refusal import raises_code
from tests.support.rubbing import tractions

LAW = Yeoh(1.0)
EVEN = LATTICE * np.concatenate([0.5 ** np.arange(5, 0, -1), np.arange(1, 16)])


def problem(friction: float, thickness_mm: float = 10.0, cells: int = COARSE, grip: float = 1.0):
    h = thickness_mm
    return rubbing_problem(Case(7.9 / h, 75.7 / h, condition=f"friction:{friction:g}", edge=0.5 / h), cells, grip)


@lru_cache
def forces(friction: float, cells: int = COARSE, grip: float = 1.0) -> np.ndarray:
    """At 0.1, 0.2 and 0.3 thicknesses of 10 mm."""
    return at_tenths(follow_rubbing(problem(friction, cells=cells, grip=grip), EVEN))


def at_tenths(path) -> np.ndarray:
    found = path.force[np.abs(path.depth[:, None] - np.array([0.1, 0.2, 0.3])).min(axis=1) < 1e-9]
    return np.concatenate([found, np.full(3 - len(found), np.nan)])


@pytest.mark.slow
@pytest.mark.parametrize("thickness_mm", [5.0, 10.0])
def test_much_friction_is_glue(thickness_mm):
    depth = thickness_mm * np.array([0.1, 0.3])
    rubbing = solve_under_fillet(Pad(thickness_mm, 0.025, 7.9, edge_radius_mm=0.5, condition="friction:5.0"), depth)
    glued = solve_under_fillet(Pad(thickness_mm, 0.025, 7.9, edge_radius_mm=0.5), depth)
    assert np.all(np.abs(rubbing.force_N - glued.force_N) < rubbing.error_N + glued.error_N)


@pytest.mark.slow
def test_little_friction_tends_to_none():
    # What friction adds is in proportion to a small coefficient.
    none = (
        solve_under_fillet(Pad(10.0, 3.0, 7.9, edge_radius_mm=0.5, condition="frictionless"), [1.0, 2.0]).force_N
        / 100.0
    )
    assert 2.0 * forces(0.05, FINE)[:2] - forces(0.1, FINE)[:2] == pytest.approx(none, rel=0.01)
    assert np.all(forces(0.05, FINE)[:2] > none)


@pytest.mark.slow
def test_the_force_grows_with_friction():
    rows = np.array([forces(friction, FINE)[:2] for friction in (0.05, 0.1, 0.3, 0.5, 1.0, 5.0)])
    assert np.all(np.diff(rows[:4], axis=0) > 0.0)
    # From 0.5 on the face sticks nearly everywhere, and the force has come to its limit.
    assert np.all(np.diff(rows[3:], axis=0) > -1e-3 * rows[3:-1])


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_cells_and_grip_hardly_change_the_force(friction):
    assert forces(friction, FINE)[:2] == pytest.approx(forces(friction)[:2], rel=6e-3)
    assert forces(friction, FINE, 0.5) == pytest.approx(forces(friction, FINE), rel=3e-3)


@pytest.mark.slow
def test_smaller_steps_do_not_change_the_force():
    depths = np.union1d(EVEN, EVEN[5:] - 0.5 * LATTICE)
    finer = follow_rubbing(problem(0.3, cells=FINE), depths)
    assert at_tenths(finer) == pytest.approx(forces(0.3, FINE), rel=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.3, 0.5])
def test_every_point_stays_in_coulombs_cone_and_the_face_carries_the_force(friction):
    made = problem(friction, cells=FINE)
    seen = []

    def visit(depth: float, solution: Equilibrium) -> None:
        way, pressure, drag = tractions(made.surface, solution.u, made.punch, depth)
        assert np.all(np.abs(drag) <= friction * pressure * (1.0 + 1e-12))
        # The punch drags the face inwards, which goes outwards: nearly all of the contact outside the axis.
        assert np.mean(drag > 0.0) > 0.8
        slipping = np.abs(drag) > 0.999 * friction * pressure
        assert not slipping[way < 0.1].any() or friction < 0.3
        push = made.surface.forces(solution.u, made.punch, depth)[0]
        assert push[1::2].sum() == pytest.approx(made.force(solution.state), rel=1e-3)
        seen.append(depth)

    path = follow_rubbing(made, EVEN, visit=visit)
    assert path.stop is None and len(seen) == len(EVEN)


@pytest.mark.slow
def test_fields_show_where_the_face_sticks_and_slips_within_the_cone():
    pad = Pad(10.0, 0.025, 7.9, condition="friction:0.3", edge_radius_mm=0.5)
    (found,), notes = solve_fields(pad, [2.0])
    face = found.face
    assert notes == () and {STICKS, SLIPS} <= set(face.state)
    inside = (face.radius_mm < 7.0) & (face.radius_mm > 0.1)
    assert np.all(np.abs(face.shear_MPa[inside]) <= 1.02 * 0.3 * face.pressure_MPa[inside])
    sticking = face.radius_mm[(face.state == STICKS) & inside]
    assert sticking.max() < face.radius_mm[(face.state == SLIPS) & inside].min() + 1e-9
    assert found.force_N == pytest.approx(solve_points(pad, np.array([2.0])).force_N[0], rel=2e-3)


@pytest.mark.slow
def test_a_force_does_not_depend_on_the_other_depths_nor_on_the_modulus():
    alone = solve_under_fillet(Pad(10.0, 0.025, 7.9, edge_radius_mm=0.5, condition="friction:0.5"), [2.0])
    among = solve_under_fillet(Pad(10.0, 0.05, 7.9, edge_radius_mm=0.5, condition="friction:0.5"), [0.137, 0.811, 2.0])
    assert among.force_N[2] == pytest.approx(2.0 * alone.force_N[0], rel=1e-6)


def test_a_coefficient_that_is_none_is_refused():
    with raises_code("unsupported", "edge_radius_mm"):
        Pad(10.0, 0.025, 7.9, condition="friction:9", edge_radius_mm=0.5)
