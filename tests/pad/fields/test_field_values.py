"""What is worked out from stresses and contact, on made-up values: invariants, tractions, profiles, states."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad import fields as solve
from dummydesign.pad.axisymmetric.case import LATTICE
from dummydesign.pad.axisymmetric.profile_punch import profile, solve_profile
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.fields import (
    FREE,
    SLIPS,
    STICKS,
    Pressed,
    PressedFace,
    cauchy,
    face_tractions,
    solve_fields,
    to_nodes,
)
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad

RNG = np.random.default_rng(17)
RADII, LEVELS = np.array([0.0, 2.0, 4.0, 5.0, 8.0, 20.0]), np.array([0.0, -1.0, -3.0, -6.0])
PUNCH = np.array([[0.0, 5.0], [4.5, 5.0], [5.0, 5.5], [5.0, 6.3]])


def mesh():
    points, quads, _ = meshes.columns(RADII, -LEVELS)
    return meshes.discretise(points, quads)


def pressed(scale: float = 1.0) -> Pressed:
    """A pad of 6 mm and 20 mm radius with random stresses, whose face is touched to 5 mm."""
    made = mesh()
    places = made.nodes.T
    top = np.nonzero(meshes.on_top(made))[0]
    top = top[np.argsort(places[top, 0])]
    radius = places[top, 0]
    state = np.where(radius < 3.0, STICKS, np.where(radius <= 5.0, SLIPS, FREE))
    pressure = np.where(state == FREE, 0.0, scale * (0.01 + 0.004 * np.sin(radius) + 0.05 * (radius > 4.6)))
    face = PressedFace(top, radius, 0.0 * radius + 5.0, pressure, 0.2 * pressure, state, 5.0)
    stress = scale * 0.01 * np.random.default_rng(3).standard_normal((len(places), 4))
    return Pressed(
        1.0,
        0.8,
        places + np.array([0.0, 6.0]),
        np.stack([0.01 * places[:, 0], 0.1 * places[:, 1]], axis=1),
        meshes.cell_nodes(made),
        stress,
        np.ones((len(places), 3)),
        face,
        PUNCH,
    )


def test_principal_values_pressure_and_von_mises_are_those_of_the_whole_tensor():
    found = pressed()
    rr, zz, tt, rz = found.cauchy_MPa.T
    tensor = np.zeros((len(rr), 3, 3))
    tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 2, 2] = rr, zz, tt
    tensor[:, 0, 1] = tensor[:, 1, 0] = rz
    assert found.principal_MPa == pytest.approx(np.linalg.eigvalsh(tensor)[:, ::-1], abs=1e-15)
    mean = np.trace(tensor, axis1=1, axis2=2) / 3.0
    assert found.pressure_MPa == pytest.approx(-mean, abs=1e-15)
    deviator = tensor - mean[:, None, None] * np.eye(3)
    assert found.von_mises_MPa == pytest.approx(np.sqrt(1.5 * np.einsum("nij,nij->n", deviator, deviator)), rel=1e-12)


def test_the_cauchy_stress_is_that_of_the_law_in_space_pushed_forward():
    """P F^T / J from the nine components of the same deformation, with the pressure of the element in it."""
    made = mesh()
    law, factor = Yeoh(1.7, 0.3), np.linspace(0.5, 2.0, len(made.weight))
    solid = Solid(made, law, 0.45)
    r, z = made.nodes
    u = np.stack([0.03 * r + 0.002 * r * z, 0.05 * z - 0.001 * r**2 * z], axis=1).ravel()
    p = 0.1 * RNG.standard_normal((len(made.weight), 3))
    stress, stretch = cauchy(solid, solid.state(u, p), factor)
    F = solid.deformation(u)
    whole = np.zeros((*F.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1), (2, 2))):
        whole[..., i, j] = F[..., k]
    J = np.linalg.det(whole)
    # mu F - mu F^-T of the law, compressible: the pressure is what the element has for it.
    slope = -law.shear_MPa / J + p @ made.pressure_basis.T
    piola = law.stress(whole.reshape(*J.shape, 9)).reshape(whole.shape)
    piola = piola + (slope * J)[..., None, None] * np.linalg.inv(whole).swapaxes(-1, -2)
    tensor = piola @ whole.swapaxes(-1, -2) * (factor[:, None] / J)[..., None, None]
    exact = np.stack([tensor[..., 0, 0], tensor[..., 1, 1], tensor[..., 2, 2], tensor[..., 0, 1]], axis=-1)
    assert stress == pytest.approx(exact, abs=1e-12)
    assert stretch == pytest.approx(np.linalg.svd(whole, compute_uv=False), abs=1e-12)
    assert tensor[..., 0, 1] == pytest.approx(tensor[..., 1, 0], abs=1e-12)


def test_values_that_are_linear_over_the_pad_are_carried_to_its_nodes_exactly():
    made = mesh()
    solid, r_z = Solid(made, Yeoh(1.0)), meshes.integrate(made.nodes, meshes.cell_nodes(made)).position
    values = np.stack([2.0 + 0.3 * r_z[0] - r_z[1], r_z[0]], axis=-1)
    exact = np.stack([2.0 + 0.3 * made.nodes[0] - made.nodes[1], made.nodes[0]], axis=1)
    assert to_nodes(solid, meshes.POINTS, values) == pytest.approx(exact, abs=1e-10)


@pytest.mark.parametrize("tilt", [0.0, 0.3, -0.3])
def test_tractions_of_a_moved_face_are_recovered_and_the_axis_has_the_parabola_of_its_neighbours(tilt):
    """A face that was flat and now leans, under an even pressure and shear per area as it is now."""
    r = np.array([0.0, 0.3, 0.6, 1.1, 1.6])
    nodes, move = np.stack([r, 0.0 * r]), np.stack([0.1 * r, tilt * r], axis=1)
    sides, moved = np.array([[0, 1, 2], [2, 3, 4]]), nodes + move.T
    x, weight = np.polynomial.legendre.leggauss(8)
    shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0])
    along = np.array([1.1, tilt]) / np.hypot(1.1, tilt)
    down = np.array([along[1], -along[0]])
    force = np.zeros((5, 2))
    for side in sides:
        length = np.hypot(*(moved[:, side[2]] - moved[:, side[0]]))
        for i, node in enumerate(side):
            share = (2.0 * np.pi * (moved[0, side] @ shape) * shape[i] * weight).sum() * 0.5 * length
            force[node] += share * (3.0 * down + 0.5 * along)
    found = face_tractions(nodes, move.ravel(), force.ravel(), sides)
    assert found["node"].tolist() == [0, 1, 2, 3, 4] and found["down"] == pytest.approx(-force[:, 1])
    assert found["pressure"] == pytest.approx(3.0) and found["shear"][1:] == pytest.approx(0.5)
    uneven = force * np.array([1.0, 1.0, 1.4, 1.7, 2.0])[:, None]
    other = face_tractions(nodes, move.ravel(), uneven.ravel(), sides)["pressure"]
    slope, axis = np.polyfit(moved[0, 1:3] ** 2, other[1:3], 1)
    assert other[0] == pytest.approx(axis) and slope > 0.0


def test_mean_peak_edge_and_profile_of_a_contact_are_those_of_its_face():
    found, face = pressed().contact(), pressed().face
    touched = face.radius_mm <= 5.0
    assert found["mean_kPa"] == pytest.approx(1e3 * 0.8 / (np.pi * 25.0)) and found["contact_radius_mm"] == 5.0
    inside = face.radius_mm <= 4.5
    assert found["peak_kPa"] == pytest.approx(1e3 * face.pressure_MPa[inside].max())
    assert found["peak_radius_mm"] == face.radius_mm[np.argmax(np.where(inside, face.pressure_MPa, 0.0))]
    assert found["edge_kPa"] == pytest.approx(1e3 * face.pressure_MPa[touched & ~inside].max())
    assert found["edge_kPa"] > found["peak_kPa"] > found["mean_kPa"]
    profile_of = found["profile"]
    assert profile_of["radius_mm"] == pytest.approx(face.radius_mm[touched])
    assert profile_of["pressure_kPa"] == pytest.approx(1e3 * face.pressure_MPa[touched])
    assert profile_of["shear_kPa"] == pytest.approx(200.0 * face.pressure_MPa[touched])
    assert profile_of["state"] == ["sticks" if r < 3.0 else "slips" for r in face.radius_mm[touched]]
    free = replace(face, state=np.full(len(face.state), FREE), contact_radius_mm=0.0)
    nothing = replace(pressed(), face=free).contact()
    assert (nothing["mean_kPa"], nothing["peak_kPa"], nothing["edge_kPa"]) == (0.0, 0.0, 0.0)
    assert nothing["profile"]["radius_mm"] == []


def test_a_contact_may_be_ever_so_light():
    """A crown without friction at a thousandth of a millimetre: about Hertz's radius on few cells, all of it slips."""
    pad = Pad(20.0, 0.03, 9.0, condition="frictionless", geometry=Crowned(40.0, 1.5, 11.0), extent_mm=60.0)
    contact = solve_fields(pad, [1e-3], coarse=True)[0][0].contact()
    assert 0.5 < contact["contact_radius_mm"] / np.sqrt(40.0 * 1e-3) < 1.3
    assert set(contact["profile"]["state"]) == {"slips"} and contact["mean_kPa"] > 0.0


@pytest.mark.parametrize("condition", ["frictionless", "bonded"])
def test_the_fields_under_a_ball_have_its_force_and_its_outline(condition):
    r = np.linspace(0.0, 6.0, 40)
    points = (tuple(r), tuple(20.0 - np.sqrt(400.0 - r**2)))
    pad = Pad(10.0, 0.03, 6.0, condition=condition, extent_mm=24.0, profile_mm=points)
    found = solve_fields(pad, [0.4], coarse=True)[0][0]
    force = solve_profile(pad, [0.4], profile(*points), cells=12).force_N[0]
    assert found.force_N == pytest.approx(force, rel=0.01) and found.depth_mm == pytest.approx(0.4)
    at, height = found.punch_mm.T
    assert at[-1] == pytest.approx(6.0)
    assert height == pytest.approx(10.0 - 0.4 + 20.0 - np.sqrt(400.0 - at**2), abs=2e-3)
    face = found.face
    touched = face.state != FREE
    # Where it touches, the pad has the height of the ball.
    ball = 9.6 + 20.0 - np.sqrt(400.0 - face.radius_mm[touched] ** 2)
    assert face.height_mm[touched] == pytest.approx(ball, abs=5e-3)
    assert 0.7 * np.sqrt(20.0 * 0.4) < face.contact_radius_mm < np.sqrt(2.0 * 20.0 * 0.4)
    assert set(face.state[touched]) == ({SLIPS} if condition == "frictionless" else {STICKS})


def test_wanted_depths_stand_among_those_of_the_path_which_keep_their_distance():
    wanted = np.array([0.101, 0.17])
    depths = solve._with_lattice(wanted)
    assert set(wanted) <= set(depths) and depths[-1] == 0.17 and np.all(np.diff(depths) > 0.0)
    own = [depth for depth in depths if depth not in wanted]
    steps = np.array(own) / LATTICE
    assert steps[steps > 0.9] == pytest.approx(np.round(steps[steps > 0.9]))
    assert np.diff([0.0, *depths]).max() < 1.2 * LATTICE
    assert min(abs(one - other) for one in own for other in wanted) > 0.05 * LATTICE
    # A multiple of the lattice that is as good as wanted is left out.
    assert np.abs(np.array(own) - 0.1).min() > 0.01


def test_the_sides_of_the_tested_face_are_those_that_belong_to_one_cell_and_to_no_end_of_the_pad():
    made = mesh()
    base = np.nonzero(meshes.on_base(made, 6.0))[0]
    sides = solve.face_sides(SimpleNamespace(solid=SimpleNamespace(mesh=made), base=2 * base + 1))
    top = np.nonzero(meshes.on_top(made))[0]
    assert len(sides) == len(RADII) - 1 and set(sides.ravel()) == set(top)
    assert made.nodes[0, sides[:, 1]] == pytest.approx(made.nodes[0, sides[:, [0, 2]]].mean(axis=1))
