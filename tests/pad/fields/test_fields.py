"""Stress, displacement and contact pressure inside pressed pads: closed forms, balance of forces, files."""

from dataclasses import replace
from functools import lru_cache
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad import fields as fields_solve
from dummydesign.pad.axisymmetric import shaped_problem as paths
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.filleted import solve_under_fillet
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.field_files import TOP, draw, grid, write_fields, write_picture
from dummydesign.pad.fields import FREE, cauchy, face_tractions, has_fields, solve_fields, to_nodes
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad, Puck
from tests.support.refusal import raises_code

YOUNG_MPa = 0.03


def block() -> tuple[Solid, np.ndarray]:
    """A cylinder of 3 x 2 cells."""
    points = np.array([(x, y) for x in (0.0, 0.4, 0.7, 1.0) for y in (0.0, -0.4, -1.0)]).T
    number = np.arange(12).reshape(4, 3)
    quads = np.stack([number[:-1, 1:], number[1:, 1:], number[1:, :-1], number[:-1, :-1]]).reshape(4, -1)
    mesh = meshes.discretise(points, quads)
    return Solid(mesh, Yeoh(2.0, 0.3)), mesh.nodes


@lru_cache
def pressed(shape: str = "slab", condition: str = "bonded", share: float = 0.1):
    thickness = 10.0 if shape == "slab" else 8.0
    pad = Pad(thickness, YOUNG_MPa, 7.9, condition=condition, geometry=read_shape(shape))
    return solve_fields(pad, [share * thickness])[0][0]


def test_a_cylinder_squeezed_evenly_has_the_stress_of_the_closed_form():
    solid, nodes = block()
    stretch = 0.7
    across = 1.0 / np.sqrt(stretch)
    u = np.stack([(across - 1.0) * nodes[0], (stretch - 1.0) * nodes[1]], axis=1).ravel()
    p = np.zeros((len(solid.mesh.weight), 3))
    # The pressure that leaves the sides free: sigma_rr = 0.
    trial, _ = cauchy(solid, solid.state(u, p), np.ones(len(p)))
    p[:, 0] = -trial[:, 0, 0]
    stress, principal = cauchy(solid, solid.state(u, p), np.ones(len(p)))
    invariant = stretch**2 + 2.0 / stretch - 3.0
    wanted = (2.0 + 4.0 * 0.3 * invariant) * (stretch**2 - 1.0 / stretch)
    at_nodes = to_nodes(solid, meshes.POINTS, stress)
    assert np.allclose(at_nodes, [0.0, wanted, 0.0, 0.0], atol=1e-9)
    assert np.allclose(principal[..., [0, 2]], [across, stretch])


def test_the_drawn_punch_is_flat_then_a_quarter_circle_tangent_to_both():
    depth, radius, rim = 0.3, 1.2, 0.1
    problem = SimpleNamespace(punch=SimpleNamespace(rim=rim))
    r, z = fields_solve._outline(problem, depth, radius).T
    assert (r[0], z[0]) == (0.0, -depth) and z.min() == -depth and (np.diff(r) >= -1e-12).all()
    bend = slice(1, -1)
    assert np.hypot(r[bend] - (radius - rim), z[bend] + depth - rim) == pytest.approx(rim)
    assert (r[-2], z[-2]) == pytest.approx((radius, rim - depth))


@pytest.mark.slow
def test_a_picture_of_a_press_is_written_in_the_format_of_its_name(tmp_path):
    assert write_picture([pressed()], tmp_path / "a.svg").read_text(encoding="utf-8").lstrip().startswith("<?xml")
    assert write_picture([pressed()], tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.slow
def test_a_picture_shows_both_halves_of_pad_and_punch_to_scale_with_stress_in_kilopascals():
    found = pressed()
    figure = draw([found], "title")
    section, curve = figure.axes[:2]
    assert section.get_aspect() == 1.0 and figure._suptitle.get_text() == "title"
    (left, right), (low, high) = section.get_xlim(), section.get_ylim()
    radius = found.punch_mm[:, 0].max()
    # Less than twice as wide as the punch; the pad's base and its whole face are in it.
    assert left == -right and 1.2 * radius < right < 2.0 * radius and -2.0 < low < 0.0 and 10.5 < high < 12.5
    points = (found.rest_mm + found.displacement_mm)[found.face.node]
    drawn = [line.get_xydata() for line in section.lines if len(line.get_xydata()) == len(points)]
    assert drawn[0] == pytest.approx(points) and drawn[1] == pytest.approx(points * [-1.0, 1.0])
    outline = section.patches[0].get_xy()
    assert outline[:, 0].min() == -radius and outline[:, 0].max() == radius and outline[:, 1].max() > high
    assert outline[:, 1].min() == pytest.approx(9.0) and outline[:-1, 0].sum() == pytest.approx(0.0, abs=1e-9)
    shown = [np.asarray(one.get_array()) for one in section.collections]
    near = found.rest_mm[:, 0] < 1.2 * right
    mises = 1e3 * found.von_mises_MPa
    assert len(shown) == 2 and shown[0] == pytest.approx(shown[1])
    assert shown[0].max() == pytest.approx(mises[near].max())
    under = mises[found.rest_mm[:, 0] < 0.9 * radius]
    assert section.collections[0].get_clim() == (0.0, pytest.approx(np.percentile(under, TOP)))
    assert float(section.get_title(loc="left").split()[1]) == 1.0
    contact = found.contact()
    pressures = curve.lines[0].get_xydata().T
    assert pressures[0] == pytest.approx(contact["profile"]["radius_mm"])
    assert pressures[1] == pytest.approx(contact["profile"]["pressure_kPa"])
    assert curve.lines[1].get_ydata() == pytest.approx(np.full(2, contact["mean_kPa"]))
    bottom, most = curve.get_ylim()
    assert bottom == 0.0 and max(contact["peak_kPa"], contact["mean_kPa"]) < most < contact["edge_kPa"]
    assert curve.get_xlim()[0] == 0.0 and radius < curve.get_xlim()[1] < 2.0 * radius
    assert f"{contact['edge_kPa']:.3g} kPa" in curve.get_title(loc="right")


def test_at_most_four_depths_are_drawn_the_first_and_the_last_among_them():
    fields = [replace(pressed(), depth_mm=float(depth)) for depth in range(1, 10)]
    many, two = draw(fields), draw(fields[:2])
    titles = [axes.get_title(loc="left") for axes in many.axes[:8:2]]
    assert [int(title.split()[1]) for title in titles] == [1, 4, 6, 9]
    assert len(two.axes) == 5 and two.get_figheight() < many.get_figheight()
    free = replace(pressed().face, state=np.full(len(pressed().face.state), FREE), contact_radius_mm=0.0)
    idle = draw([replace(pressed(), face=free, force_N=0.0)]).axes[1]
    assert idle.get_title(loc="right") == "" and idle.get_ylim() == (0.0, 1.0)


def test_the_grid_of_a_pad_has_its_fields_in_the_plane_and_those_of_the_face_at_its_nodes():
    found = pressed()
    made = grid(found)
    assert made.points[:, :2] == pytest.approx(found.rest_mm) and not made.points[:, 2].any()
    data = made.point_data
    assert data["displacement_mm"][:, :2] == pytest.approx(found.displacement_mm)
    assert not data["displacement_mm"][:, 2].any() and not data["cauchy_MPa"][:, 4:].any()
    assert data["cauchy_MPa"][:, :4] == pytest.approx(found.cauchy_MPa)
    assert data["pressure_MPa"] == pytest.approx(found.pressure_MPa)
    assert data["von_mises_MPa"] == pytest.approx(found.von_mises_MPa)
    node, face = found.face.node, found.face
    for name, values in (("pressure_MPa", face.pressure_MPa), ("shear_MPa", face.shear_MPa), ("state", face.state)):
        assert data[f"contact_{name}"][node] == pytest.approx(values)
        assert not np.delete(data[f"contact_{name}"], node).any()
    assert (made.field_data["depth_mm"][0], made.field_data["force_N"][0]) == (1.0, found.force_N)


def test_half_the_modulus_in_a_cell_halves_its_stress():
    solid, nodes = block()
    u = np.stack([0.05 * nodes[0], -0.1 * nodes[1]], axis=1).ravel()
    p = np.zeros((len(solid.mesh.weight), 3))
    factor = np.ones(len(p))
    factor[2] = 0.5
    whole, half = cauchy(solid, solid.state(u, p), np.ones(len(p)))[0], cauchy(solid, solid.state(u, p), factor)[0]
    assert np.allclose(half[2], 0.5 * whole[2]) and np.allclose(half[3], whole[3])


def test_an_even_pressure_is_recovered_from_its_nodal_forces():
    # Two sides of unequal length; nodal forces by Gauss's rule, not by the formula that is tested.
    r = np.array([0.0, 0.3, 0.6, 1.1, 1.6])
    nodes = np.stack([r, 0.2 * r])
    sides = np.array([[0, 1, 2], [2, 3, 4]])
    x, weight = np.polynomial.legendre.leggauss(6)
    shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0])
    force = np.zeros((5, 2))
    normal = np.array([0.2, -1.0]) / np.hypot(0.2, 1.0)
    for side in sides:
        length = np.hypot(*(nodes[:, side[2]] - nodes[:, side[0]]))
        for i, node in enumerate(side):
            share = (2.0 * np.pi * (nodes[0, side] @ shape) * shape[i] * weight).sum() * 0.5 * length
            force[node] += 3.0 * share * normal
    found = face_tractions(nodes, np.zeros(10), force.ravel(), sides)
    assert found["pressure"] == pytest.approx(3.0) and found["shear"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("shape", ["slab", "crowned:20,2,9"])
def test_the_stress_on_the_base_carries_the_force_of_the_punch(shape):
    found = pressed(shape)
    base = found.rest_mm[:, 1] < 1e-9
    order = np.argsort(found.rest_mm[base, 0])
    r, stress = found.rest_mm[base, 0][order], found.cauchy_MPa[base, 1][order]
    assert np.trapezoid(-2.0 * np.pi * r * stress, r) == pytest.approx(found.force_N, rel=0.01)


def test_the_pressure_over_a_crown_carries_the_force():
    face = pressed("crowned:20,2,9").face
    total = np.trapezoid(2.0 * np.pi * face.radius_mm * face.pressure_MPa, face.radius_mm)
    assert total == pytest.approx(pressed("crowned:20,2,9").force_N, rel=0.01)


def test_the_pressure_on_the_face_is_the_stress_just_below_it():
    found = pressed()
    rest = found.rest_mm[found.face.node, 0]
    inside = (rest > 0.5) & (rest < 5.0)
    below = -found.cauchy_MPa[found.face.node[inside], 1]
    assert below == pytest.approx(found.face.pressure_MPa[inside], rel=0.02)


def test_a_shallow_crown_without_friction_has_hertz_pressure_and_the_force_of_a_cap_on_a_layer():
    # p = p0 sqrt(1 - (r/a)^2) with p0 = 3 F / (2 pi a^2); F over Hertz's as E. K. Dimitriadis et al. give it for a
    # glued incompressible layer, Biophys. J. 82 (2002) 2798, doi 10.1016/S0006-3495(02)75620-8, x = sqrt(R d) / h.
    depth = 0.16
    pad = Pad(20.0, YOUNG_MPa, 9.0, condition="frictionless", geometry=read_shape("crowned:40,1.5,11"), extent_mm=60.0)
    found = solve_fields(pad, [0.5 * depth, depth])[0][-1]
    x = np.sqrt(40.0 * depth) / 20.0
    layer = 1.0 + 1.133 * x + 1.283 * x**2 + 0.769 * x**3 + 0.0975 * x**4
    assert found.force_N == pytest.approx(layer * 16.0 / 9.0 * YOUNG_MPa * np.sqrt(40.0) * depth**1.5, rel=0.01)
    r, p = found.face.radius_mm, found.face.pressure_MPa
    inside = p > 0.3 * p.max()
    slope, peak = np.polyfit(r[inside] ** 2, p[inside] ** 2, 1)
    radius = np.sqrt(-peak / slope)
    assert inside.sum() >= 8
    assert np.sqrt(peak) == pytest.approx(1.5 * found.force_N / (np.pi * radius**2), rel=0.02)
    assert p[inside] == pytest.approx(np.sqrt(peak * (1.0 - (r[inside] / radius) ** 2)), rel=0.03)
    assert found.contact()["peak_radius_mm"] < 0.3 * radius
    assert found.face.shear_MPa == pytest.approx(0.0, abs=3e-3 * p.max())
    assert set(found.contact()["profile"]["state"]) == {"slips"}


@pytest.mark.slow
def test_stress_is_proportional_to_the_modulus():
    soft = pressed()
    stiff = solve_fields(Pad(10.0, 2.0 * YOUNG_MPa, 7.9), [1.0])[0][0]
    assert stiff.force_N == pytest.approx(2.0 * soft.force_N, rel=1e-9)
    assert stiff.cauchy_MPa == pytest.approx(2.0 * soft.cauchy_MPa, rel=1e-9, abs=1e-15)
    assert stiff.displacement_mm == pytest.approx(soft.displacement_mm, rel=1e-9, abs=1e-12)


def test_the_volume_is_kept():
    crowned = pressed("crowned:20,2,9").stretch.prod(axis=1)
    assert crowned == pytest.approx(1.0, abs=0.005)


def test_a_fillet_of_the_punch_is_that_of_the_fields():

    pad = Pad(10.0, YOUNG_MPa, 7.9, edge_radius_mm=1.0)
    found = solve_fields(pad, [1.0, 3.0])[0]
    force = solve_under_fillet(Pad(10.0, YOUNG_MPa, 7.9, edge_radius_mm=1.0), [1.0, 3.0]).force_N
    assert [one.force_N for one in found] == pytest.approx(force, rel=0.01)
    # The edge carries the more, the smaller its fillet.
    assert found[0].contact()["edge_kPa"] < pressed().contact()["edge_kPa"]


def test_a_glued_face_sticks():
    assert set(pressed().contact()["profile"]["state"]) == {"sticks"}


def test_paraview_reads_back_what_was_written(tmp_path):
    import pyvista

    found = pressed()
    files = write_fields([found, found], tmp_path / "pad.vtu")
    assert [file.name for file in files] == ["pad.pvd", "pad-1.vtu", "pad-2.vtu"]
    read = pyvista.read(files[1])
    assert read.n_cells == len(found.cells)
    assert read.point_data["principal_MPa"] == pytest.approx(found.principal_MPa)
    series = pyvista.PVDReader(files[0])
    assert [entry.path for entry in series.datasets] == ["pad-1.vtu", "pad-2.vtu"]
    assert series.time_values == [found.depth_mm]


def test_cells_stand_upright_so_that_programs_find_their_area():
    found = pressed()
    area = grid(found).compute_cell_sizes(length=False, volume=False)["Area"]
    assert np.abs(area).sum() == pytest.approx(10.0 * found.rest_mm[:, 0].max(), rel=1e-6)


@pytest.mark.parametrize(("name", "code"), [("pad.vtk", "bad_name"), ("missing/pad.vtu", "file_unwritable")])
def test_a_place_that_cannot_be_written_is_said_in_one_line(tmp_path, name, code):
    with raises_code(code):
        write_fields([pressed()], tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_pads_that_are_not_round_have_no_fields():
    pad = Pad(10.0, YOUNG_MPa, 7.9, geometry=read_shape("crowned:10,2,6,1"))
    with raises_code("unsupported", "fields"):
        solve_fields(pad, [1.0])


def test_a_puck_between_plates_has_no_fields():
    puck = Puck(30.0, YOUNG_MPa, 50.0)
    assert not has_fields(puck)
    with raises_code("unsupported", "fields"):
        solve_fields(puck, [1.0])


@pytest.mark.slow
def test_fields_on_the_way_of_a_followed_path_are_those_followed_anew():
    pad = Pad(5.0, YOUNG_MPa, 7.9, geometry=read_shape("crowned:8,2"))
    paths._VISITED.clear()
    anew = solve_fields(pad, [0.4, 0.63], coarse=True)[0]
    press = Case(7.9 / 5.0, PAD_EXTENT_MM / 5.0, shape=pad.geometry, thickness_mm=5.0, first=0.02)
    followed = paths.solve_path(press, np.array([0.1, 0.15]), 8)
    assert followed.stop is None and paths.visited_states(press, 8, 0.05, 0.126)
    assert not paths.visited_states(press, 8, 0.05, 0.2) and not paths.visited_states(press, 16, 0.05, 0.1)
    beside = solve_fields(pad, [0.4, 0.63], coarse=True)[0]
    for one, other in zip(anew, beside):
        assert other.force_N == pytest.approx(one.force_N, rel=2e-4)
        assert np.abs(other.displacement_mm - one.displacement_mm).max() < 2e-4


def test_fields_on_the_way_of_a_followed_path_follow_none(monkeypatch):
    pad = Pad(5.0, YOUNG_MPa, 7.9, geometry=read_shape("crowned:8,2"))
    press = paths.meshed(Case(7.9 / 5.0, PAD_EXTENT_MM / 5.0, shape=pad.geometry, thickness_mm=5.0))
    paths.solve_path(press, np.array([0.1, 0.15]), 8)
    monkeypatch.setattr(fields_solve, "follow", None)
    assert len(solve_fields(pad, [0.4, 0.63], coarse=True)[0]) == 2


WIDE = {"geometry": read_shape("crowned:21.2,2,9.4")}


@pytest.mark.parametrize(
    ("more", "depths"),
    [
        pytest.param(WIDE, [0.2, 1.5, 2.0], marks=pytest.mark.slow),
        ({}, [0.05, 1.5]),
        ({"edge_radius_mm": 1.0}, [2.0]),
        (WIDE | {"edge_radius_mm": 1.0}, [2.0]),
        pytest.param({"base": "friction:0.5"}, [0.4], marks=pytest.mark.slow),
        ({"condition": "frictionless"}, [0.2]),
    ],
)
def test_the_contact_under_a_flat_punch_is_no_wider_than_the_punch(more, depths):
    radius = 7.8988
    found = [one.contact() for one in solve_fields(Pad(5.0, YOUNG_MPa, radius, **more), depths, coarse=True)[0]]
    assert len(found) == len(depths)
    for one in found:
        reach = one["contact_radius_mm"]
        assert 0.0 < reach <= radius * (1.0 + 1e-9) and max(one["profile"]["radius_mm"]) <= reach
        assert 1e-3 * one["mean_kPa"] * np.pi * reach**2 == pytest.approx(one["force_N"])
    sharp_edge = "edge_radius_mm" not in more
    assert (found[-1]["contact_radius_mm"] == pytest.approx(radius, rel=1e-9)) == sharp_edge
    if more == WIDE:  # inside the face the contact grows as that of a ball on a thin layer, between the two limits
        assert np.sqrt(21.2 * 0.2) < found[0]["contact_radius_mm"] < np.sqrt(2.0 * 21.2 * 0.2)
