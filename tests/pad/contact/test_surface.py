"""A surface and a rigid punch: distances, film and grip in closed form, what is remembered, closing of gaps."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.pad.contact.axisymmetric import AxisymmetricSurface, ContactSurface, FilletedPunch, FlatPunch, closure
from dummydesign.pad.contact.friction import CombinedSurface, RestingBase, weight_over_shear
from dummydesign.pad.fem import mesh_axisymmetric as meshes

RADII = np.array([0.2, 0.5, 0.8, 1.0, 1.2])
NODES = np.stack([RADII, 0.0 * RADII])
SIDES = np.array([[0, 1, 2], [2, 3, 4]])
PUNCH = FlatPunch(5.0, 0.5)


def moved(out: float, down: float) -> np.ndarray:
    return np.tile([out, -down], 5).astype(float)


def surface(**more) -> AxisymmetricSurface:
    return AxisymmetricSurface(NODES, SIDES, **({"stiffness": 40.0} | more))


AREA = np.pi * (1.2**2 - 0.2**2)


def test_the_gap_of_a_flat_punch_is_the_distance_to_its_face_or_to_its_fillet():
    """Face at radius 0.8, fillet of 0.2 centred over its edge; inside the centre's quarter the face is nearest."""
    punch, down = FlatPunch(1.0, 0.2), 0.3
    points = np.array([[0.5, -0.35], [0.5, -0.25], [0.8, -0.6], [1.1, -0.5], [0.95, -0.1], [1.4, 0.5]])
    v = points - np.array([0.8, -0.1])
    exact = [0.05, -0.05, 0.3, *(np.hypot(*v[k]) - 0.2 for k in (3, 4, 5))]
    gap, normal, bend = punch.gap(points, down)
    assert gap == pytest.approx(exact) and np.linalg.norm(normal, axis=1) == pytest.approx(1.0)
    assert normal[:2] == pytest.approx(np.array([[0.0, -1.0]] * 2))
    assert normal[3] == pytest.approx(v[3] / np.hypot(*v[3]))
    assert np.trace(bend, axis1=1, axis2=2)[3:] == pytest.approx(1.0 / np.hypot(*v[3:].T)) and not bend[:2].any()
    assert punch.flat_radius == pytest.approx(0.8)


@pytest.mark.parametrize("sides", [True, False])
def test_the_way_along_an_outline_grows_by_what_one_goes_along_it(sides):
    punch, step = FilletedPunch(1.0, 0.2, sides), 1e-4
    turns = np.array([0.2, 0.8, 1.4])
    places = np.array([0.8, -0.1]) + 0.2 * np.stack([np.sin(turns), -np.cos(turns)], axis=1)
    ahead = np.array([0.8, -0.1]) + 0.2 * np.stack([np.sin(turns + step), -np.cos(turns + step)], axis=1)
    assert punch.outline(ahead, 0.3) - punch.outline(places, 0.3) == pytest.approx(np.full(3, 0.2 * step), rel=1e-3)
    assert punch.outline(np.array([[0.3, 0.0], [0.8, -0.3]]), 0.3) == pytest.approx([0.3, 0.8])
    if sides:
        wall = punch.outline(np.array([[1.0, 0.0], [1.0, 0.4]]), 0.3)
        assert wall == pytest.approx(0.8 + 0.1 * np.pi + np.array([0.1, 0.5]))


def test_a_face_pushes_by_stiffness_depth_and_area_and_the_film_holds_it_by_its_own():
    """Stiffness that grows with the radius: the integral of 2 pi r (30 + 20 r); the film's of 2 pi r 7 r."""
    made = surface(stiffness=lambda r: 30.0 + 20.0 * r, film=lambda r: 7.0 * r)
    force, matrix = made.forces(moved(0.01, 0.0), PUNCH, 0.02)
    whole = 30.0 * np.pi * (1.2**2 - 0.2**2) + 40.0 * np.pi / 3.0 * (1.2**3 - 0.2**3)
    assert force[1::2].sum() == pytest.approx(0.02 * whole)
    film = 14.0 * np.pi / 3.0 * (1.2**3 - 0.2**3)
    assert force[0::2].sum() == pytest.approx(0.01 * film)
    rows = matrix.reshape(2, 3, 2, 3, 2)
    assert rows[:, :, 1, :, 1].sum() == pytest.approx(whole) and rows[:, :, 0, :, 0].sum() == pytest.approx(film)
    lifted = made.forces(moved(0.01, 0.1), PUNCH, 0.02)[0]
    assert not lifted[1::2].any() and lifted[0::2].sum() == pytest.approx(0.01 * film)
    assert made.points(moved(0.01, 0.0))[..., 0].min() > 0.21


@pytest.mark.parametrize("grip_from", [0.0, 0.8])
def test_what_touches_is_held_where_it_touched_until_it_lifts_off(grip_from):
    made = surface(grip=25.0, grip_from=grip_from)
    held = np.pi * (1.2**2 - max(0.2, grip_from) ** 2)
    made.settle(moved(0.05, 0.0), PUNCH, 0.01)
    force = made.forces(moved(0.08, 0.0), PUNCH, 0.01)[0]
    assert force[0::2].sum() == pytest.approx(25.0 * 0.03 * held)
    # Further touch does not move the spot; a punch that has left lets go.
    made.settle(moved(0.08, 0.0), PUNCH, 0.02)
    kept = made.memory()
    assert made.forces(moved(0.08, 0.0), PUNCH, 0.02)[0][0::2].sum() == pytest.approx(25.0 * 0.03 * held)
    made.settle(moved(0.08, 0.0), PUNCH, -0.1)
    made.settle(moved(0.08, 0.0), PUNCH, 0.02)
    assert made.forces(moved(0.08, 0.0), PUNCH, 0.02)[0][0::2].sum() == pytest.approx(0.0, abs=1e-12)
    made.restore(kept)
    assert made.forces(moved(0.08, 0.0), PUNCH, 0.02)[0][0::2].sum() == pytest.approx(25.0 * 0.03 * held)


def test_friction_drags_by_its_coefficient_times_the_push_and_less_while_the_slip_is_small():
    made = surface(friction=0.4, slip_scale=0.01)
    made.settle(moved(0.0, 0.0), PUNCH, 0.01)
    push = 40.0 * 0.01 * AREA
    for slip in (0.01, -0.5):
        force = made.forces(moved(slip, 0.0), PUNCH, 0.01)[0]
        assert force[0::2].sum() == pytest.approx(0.4 * push * slip / np.hypot(slip, 0.01))
        assert force[1::2].sum() == pytest.approx(push)


def test_two_surfaces_together_have_the_forces_and_the_memory_of_both():
    points, quads, _ = meshes.columns(np.array([0.0, 0.7, 1.5]), np.array([0.0, 0.4, 1.0]))
    mesh = meshes.discretise(points, quads)
    top = meshes.edges_on(mesh, meshes.on_top(mesh))
    face = AxisymmetricSurface(mesh.nodes, top, 40.0, grip=5.0, grip_from=0.0, ties_within_step=True)
    base = RestingBase(mesh, meshes.edges_on(mesh, meshes.on_base(mesh, 1.0)), 1.0, 0.3, 0.02)
    both, u = CombinedSurface(face, base), 1e-3 * np.random.default_rng(1).standard_normal(mesh.size)
    assert both.face is face and np.array_equal(both.dofs, np.concatenate([face.dofs, base.dofs]))
    both.settle(u, PUNCH, 0.01)
    force, matrix = both.forces(1.5 * u, PUNCH, 0.01)
    own, other = face.forces(1.5 * u, PUNCH, 0.01), base.forces(1.5 * u, PUNCH, 0.01)
    assert force == pytest.approx(own[0] + other[0]) and matrix == pytest.approx(np.concatenate([own[1], other[1]]))
    kept = both.memory()
    both.settle(u, PUNCH, -0.5)
    assert not face._held.any()
    both.restore(kept)
    assert face._held.any() and both.forces(1.5 * u, PUNCH, 0.01)[0] == pytest.approx(force)
    both.settle(u, PUNCH, -0.5)
    assert both.tie(u, PUNCH, 0.01) and face._held.any() and not both.tie(u, PUNCH, 0.01)
    both.begin()
    assert not face._held.any() and not ContactSurface().tie(u, PUNCH, 0.01) and ContactSurface().memory() is None


def test_a_base_carries_the_weight_at_rest_and_drags_what_slides_by_its_coefficient():
    points, quads, _ = meshes.columns(np.array([0.0, 0.7, 1.5]), np.array([0.0, 0.4, 1.0]))
    mesh = meshes.discretise(points, quads)
    weight, shear = 0.05, 2.0
    base = RestingBase(mesh, meshes.edges_on(mesh, meshes.on_base(mesh, 1.0)), shear, 0.3, weight)
    rest = base.forces(np.zeros(mesh.size), None, 0.0)[0]
    assert rest == pytest.approx(0.0, abs=1e-12)
    out = np.tile([0.1, 0.0], mesh.size // 2)
    dragged = base.forces(out, None, 0.0)[0]
    assert dragged[0::2].sum() == pytest.approx(0.3 * weight * shear * np.pi * 1.5**2, rel=1e-2)
    down = np.tile([0.0, -1e-4], mesh.size // 2)
    pushed = base.forces(down, None, 0.0)[0][1::2].sum()
    assert pushed == pytest.approx(-3e4 * shear * 1e-4 * np.pi * 1.5**2, rel=0.02)
    assert weight_over_shear(10.0, 0.01) == pytest.approx(1030.0 * 9.81 * 0.01 / 1e4)


def test_gaps_between_two_contacts_close_in_the_order_of_their_room():
    r = np.arange(8.0)
    held = np.array([1, 1, 0, 0, 0, 0, 1, 1], dtype=bool)
    room = np.array([0.0, 0.0, 0.1, 0.4, 0.3, 0.2, 0.0, 0.0])
    share = closure(r, held, np.ones(8, dtype=bool), room)
    assert share == pytest.approx([1.0, 1.0, 0.25, 1.0, 0.75, 0.5, 1.0, 1.0])


def test_a_new_contact_counts_its_room_against_that_of_the_open_places_beside_it():
    r, none = np.arange(6.0), np.zeros(6, dtype=bool)
    touching, room = np.array([0, 0, 1, 1, 0, 0], dtype=bool), np.array([0.9, 0.5, 0.1, 0.2, 0.4, 0.9])
    assert closure(r, none, touching, room) == pytest.approx([1.0, 1.0, 0.2, 0.4, 1.0, 1.0])
    at_end = np.array([0, 0, 0, 0, 1, 1], dtype=bool)
    assert closure(r, none, at_end, room[::-1]) == pytest.approx([1.0, 1.0, 1.0, 1.0, 5.0 / 9.0, 1.0])
    assert closure(r, none, at_end, room) == pytest.approx([1.0, 1.0, 1.0, 1.0, 4.0 / 9.0, 1.0])


def test_an_edge_moves_evenly_from_half_way_after_the_last_held_point_also_on_uneven_places():
    r = np.array([0.0, 1.0, 1.5, 3.0, 4.0])
    held, touching = np.array([1, 1, 0, 0, 0], dtype=bool), np.array([1, 1, 1, 1, 0], dtype=bool)
    start, stop = 1.25, 3.5
    assert closure(r, held, touching, 0.0 * r)[2:4] == pytest.approx((r[2:4] - start) / (stop - start))
    turned = closure(-r[::-1], held[::-1], touching[::-1], 0.0 * r)
    assert turned[1:3] == pytest.approx(((r[2:4] - start) / (stop - start))[::-1])
    whole = closure(r, held, np.ones(5, dtype=bool), 0.0 * r)
    assert whole[2:] == pytest.approx((r[2:] - start) / (4.0 - start))
