"""Work that a solve leaves out, counted, and that answers do not depend on it."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.shaped_problem import shaped_problem
from dummydesign.pad.contact.axisymmetric import AxisymmetricSurface
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial.square_punch import CornerCells, SquareProblem, block_problem


def crown():
    return shaped_problem(Case(0.79, 6.0, shape=Crowned(10.0, 2.0), thickness_mm=10.0), cells=8)


def test_matrices_of_contact_are_made_for_tangents_alone(monkeypatch):
    states, matrices = [], []
    forces, stiffness = AxisymmetricSurface._force, AxisymmetricSurface._matrix
    monkeypatch.setattr(AxisymmetricSurface, "_force", lambda *words: states.append(1) or forces(*words))
    monkeypatch.setattr(AxisymmetricSurface, "_matrix", lambda *words: matrices.append(1) or stiffness(*words))
    path = follow(crown(), [0.05, 0.1], 0.005, 0.02, 1e-4, lattice=True)
    # One more for the way in which the path begins.
    assert len(matrices) <= path.newton_iterations + 1 < 0.7 * len(states)


def test_contact_that_changes_within_a_linear_step_saves_states_and_changes_no_force(monkeypatch):
    states, forces = [], []
    whole = Solid.state
    monkeypatch.setattr(Solid, "state", lambda *words: states.append(1) or whole(*words))
    for changes in (4, 0):
        problem = crown()
        assert problem.surface.changes == 4
        problem.surface.changes = changes
        states.clear()
        forces.append((follow(problem, [0.05, 0.1, 0.2], 0.005, 0.02, 1e-4, lattice=True).force, len(states)))
    (met, few), (asked, many) = forces
    assert met == pytest.approx(asked, rel=1e-3)
    assert few < 0.8 * many


def test_the_matrix_of_contact_is_the_slope_of_its_force():
    problem, rng = crown(), np.random.default_rng(5)
    u, step = 1e-3 * rng.standard_normal(problem.solid.mesh.size), 1e-7
    way = rng.standard_normal(len(u))
    force, matrix = problem.pressed(u, 0.05)
    assert np.abs(force).max() > 0.0
    dofs = problem.surface.dofs
    slope = np.bincount(dofs.ravel(), (matrix()[0] @ way[dofs][:, :, None]).ravel(), minlength=len(u))
    ends = [problem.pressed(u + sign * step * way, 0.05)[0] for sign in (1.0, -1.0)]
    assert (ends[0] - ends[1]) / (2.0 * step) == pytest.approx(slope, abs=1e-4 * np.abs(slope).max())


def test_first_touch_without_contact_is_solved_once(monkeypatch):
    problem = block_problem(SquareProblem((0.7, 0.7), (7.5, 7.5)), CornerCells(0.6), folded=True)
    solved = []
    whole = problem.pattern.solve
    monkeypatch.setattr(problem.pattern, "solve", lambda *words: solved.append(1) or whole(*words))
    stiffness = problem.stiffness()
    du, dp = problem.direction()
    assert len(solved) == 1
    # By the force at a small depth, which that direction begins.
    path = follow(problem, [1e-5], 1e-5, 1e-5, 1e-6)
    assert path.force[0] / 1e-5 == pytest.approx(stiffness, rel=1e-3)
    assert du[problem.driven] == pytest.approx(-1.0) and np.isfinite(dp).all()
