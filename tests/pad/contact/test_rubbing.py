"""Coulomb friction along a rigid outline: the cone, slip that turns back, the derivative."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.axisymmetric.filleted import FilletedPunch
from dummydesign.pad.contact.friction import FULL, RubbingSurface, coulomb_drag
from tests.support.rubbing import tractions

NODES = np.array([[0.0, 0.25, 0.5, 0.6, 0.7, 0.78, 0.86, 0.95, 1.04], np.zeros(9)])
SIDES = np.array([[0, 1, 2], [2, 3, 4], [4, 5, 6], [6, 7, 8]])
PUNCH = FilletedPunch(1.0, 0.2)
MU, STIFFNESS, SHARE = 0.3, 50.0, 0.4


def surface() -> RubbingSurface:
    made = RubbingSurface(NODES, SIDES, STIFFNESS, SHARE, MU)
    made.settle(np.zeros(18), PUNCH, 0.0)
    return made


def moved(out: float, down: float) -> np.ndarray:
    return np.tile([out, -down], 9).astype(float)


def test_the_drag_of_a_spring_is_smooth_and_ends_at_coulombs_limit():
    limit = 0.7
    pull = np.linspace(-3.0, 3.0, 4001) * limit
    drag, by_pull, by_limit = coulomb_drag(pull, np.full_like(pull, limit))
    assert np.abs(drag).max() == pytest.approx(limit) and np.all(np.diff(drag) >= -1e-12)
    assert drag[np.abs(pull) >= FULL * limit] == pytest.approx(limit * np.sign(pull[np.abs(pull) >= FULL * limit]))
    assert np.gradient(drag, pull) == pytest.approx(by_pull, abs=2e-3)
    more = coulomb_drag(pull, np.full_like(pull, limit + 1e-6))[0]
    assert (more - drag) / 1e-6 == pytest.approx(by_limit, abs=1e-4)


@pytest.mark.parametrize("out", [0.0, 0.004, 0.03])
def test_the_derivative_is_that_of_the_force(out):
    rng = np.random.default_rng(3)
    contact = surface()
    u = moved(out, 0.28) + 0.004 * rng.standard_normal(18)
    contact.tie(u, PUNCH, 0.3)
    _, matrix = contact.forces(u, PUNCH, 0.3)
    whole = np.zeros((18, 18))
    for dofs, part in zip(contact.dofs, matrix):
        whole[np.ix_(dofs, dofs)] += part
    step = 1e-7
    for k in range(18):
        du = np.zeros(18)
        du[k] = step
        rate = (contact.forces(u + du, PUNCH, 0.3)[0] - contact.forces(u - du, PUNCH, 0.3)[0]) / (2.0 * step)
        assert rate == pytest.approx(whole[:, k], rel=1e-4, abs=1e-4 * np.abs(whole).max())


def test_drag_never_leaves_coulombs_cone_and_reaches_it_where_the_face_slips():
    contact = surface()
    for out in np.linspace(0.0, 0.05, 6):
        u = moved(out, 0.29)
        way, pressure, drag = tractions(contact, u, PUNCH, 0.3)
        assert np.all(np.abs(drag) <= MU * pressure * (1.0 + 1e-12))
        contact.settle(u, PUNCH, 0.3)
    assert len(way) and drag == pytest.approx(MU * pressure)


def test_slip_that_turns_back_is_dragged_the_other_way():
    contact = surface()
    for out in (0.05, 0.02):
        u = moved(out, 0.29)
        contact.settle(u, PUNCH, 0.3)
    _, pressure, drag = tractions(contact, u, PUNCH, 0.3)
    assert drag[:5] == pytest.approx(-MU * pressure[:5])


def test_a_face_that_has_lifted_off_forgets_where_it_stuck():
    contact = surface()
    contact.settle(moved(0.0, 0.29), PUNCH, 0.3)
    contact.settle(moved(0.1, 0.5), PUNCH, 0.3)
    u = moved(0.1, 0.29)
    contact.settle(u, PUNCH, 0.3)
    flat = tractions(contact, u, PUNCH, 0.3)[0] < 0.8
    assert tractions(contact, u, PUNCH, 0.3)[2][flat] == pytest.approx(0.0, abs=1e-12)


def test_ties_can_be_taken_back():
    contact = surface()
    kept = contact.memory()
    contact.settle(moved(0.05, 0.29), PUNCH, 0.3)
    contact.restore(kept)
    assert tractions(contact, moved(0.0, 0.01), PUNCH, 0.02)[2] == pytest.approx(0.0, abs=1e-12)
