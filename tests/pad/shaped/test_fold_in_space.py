"""The face of a pad in space that meets itself: surfaces with a known crossing, and pressed pads beside round ones."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.self_contact import FoldWatch
from dummydesign.pad.axisymmetric.shaped_problem import solve_path as climb_round
from dummydesign.pad.fem.mesh_hexahedra import horizontal_faces
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.spatial.shaped_pad import (
    GridFineness,
    Load,
    SpatialFace,
    axis_lines,
    lattice_triangles,
    pierced,
    shaped_problem,
    solve_path,
    solve_shaped_block,
    turned_over,
)

STEEP = Crowned(2.0, 6.0, 2.2)
CASTABLE = read_shape("crowned:4.434,5.76,6.221")


def lattice(n: int, half: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Points (n * n, 3) of a flat sheet and their triangles."""
    line = np.linspace(-half, half, n)
    x, y = np.meshgrid(line, line, indexing="ij")
    return np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1), lattice_triangles(n, n)


def mushroom(dip: float, n: int = 61) -> tuple[np.ndarray, np.ndarray]:
    """A stem of radius 0.4 with a cap to radius 0.8 whose rim hangs to ``dip`` above the flat around."""
    points, triangles = lattice(n)
    r = np.hypot(points[:, 0], points[:, 1])
    at = np.array([0.0, 0.2, 0.3, 0.4, 0.5, 2.0])
    wide = np.interp(r, at, [0.0, 0.6, 0.8, 0.4, 0.5, 2.0])
    high = np.interp(r, at, [1.0, 0.9, dip, 0.6, 0.0, 0.0])
    ratio = np.divide(wide, r, out=np.ones_like(r), where=r > 0.0)
    return np.stack([points[:, 0] * ratio, points[:, 1] * ratio, high], axis=1), triangles


def crosses_by_all_pairs(points: np.ndarray, triangles: np.ndarray) -> bool:
    """Whether any edge, in barycentric coordinates of a triangle it has no end in, runs through that triangle."""
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    for one in triangles:
        corner = points[one]
        frame = np.stack([corner[1] - corner[0], corner[2] - corner[0]], axis=1)
        normal = np.cross(frame[:, 0], frame[:, 1])
        start, end = np.moveaxis(points[edges[~np.isin(edges, one).any(axis=1)]], 1, 0)
        low, high = (start - corner[0]) @ normal, (end - corner[0]) @ normal
        through = low * high < 0.0
        share = (low[through] / (low - high)[through])[:, None]
        place = start[through] + share * (end - start)[through]
        part = np.linalg.lstsq(frame, (place - corner[0]).T, rcond=None)[0]
        if np.any((part[0] >= 0.0) & (part[1] >= 0.0) & (part.sum(axis=0) <= 1.0)):
            return True
    return False


def test_a_sheet_of_hills_stands_over_each_place_once_and_does_not_cross():
    points, triangles = lattice(21)
    points[:, 2] = 5.0 * np.sin(7.0 * points[:, 0]) * np.cos(5.0 * points[:, 1])
    assert not turned_over(points, triangles).any() and not len(pierced(points, triangles)[0])


@pytest.mark.parametrize("dip", [0.3, 0.02])
def test_a_cap_that_hangs_over_its_foot_without_touching_it_has_not_met_itself(dip):
    points, triangles = mushroom(dip)
    assert turned_over(points, triangles).sum() > 100
    assert not len(pierced(points, triangles)[0])


def test_a_cap_whose_rim_has_sunk_into_the_flat_crosses_it_all_round_the_rim():
    points, triangles = mushroom(-0.1)
    found = pierced(points, triangles)[0]
    middle = points[found].mean(axis=1)
    r = np.hypot(middle[:, 0], middle[:, 1])
    # The flat is met where the rim's two sides pass the height 0: at radii of 0.6 to 0.8.
    assert len(found) > 50 and np.all((r > 0.55) & (r < 0.95))
    turn = np.sort(np.arctan2(middle[:, 1], middle[:, 0]))
    assert np.diff(turn).max() < 0.3


@pytest.mark.parametrize("gap", [0.02, -0.02])
def test_a_pleat_crosses_where_its_sides_have_passed_each_other(gap):
    """A groove along y whose walls lean together: their upper rims are ``gap`` apart."""
    points, triangles = lattice(21)
    x = points[:, 0]
    points[:, 2] = np.interp(np.abs(x), [0.0, 0.5, 1.0], [-1.0, 0.0, 0.0])
    points[:, 0] = np.sign(x) * np.interp(np.abs(x), [0.0, 0.25, 0.5, 1.0], [0.0, 0.2, 0.5 * gap, 1.0])
    assert bool(len(pierced(points, triangles)[0])) == (gap < 0.0)


def test_triangles_near_those_turned_over_find_what_all_pairs_find():
    """Sheets with a smooth random displacement, large enough that about half of them cross."""
    rng, crossed = np.random.default_rng(20), []
    for _ in range(16):
        points, triangles = lattice(9)
        wave = rng.uniform(1.0, 5.0, (6, 2))
        move = np.sin(points[:, :2] @ wave.T + rng.uniform(0.0, 6.0, 6)) @ rng.normal(0.0, 0.17, (6, 3))
        # The rim stays where it is: a sheet whose rim folds is not one that covers each place.
        points += move * np.prod(1.0 - points[:, :2] ** 4, axis=1)[:, None]
        crossed.append(crosses_by_all_pairs(points, triangles))
        assert bool(len(pierced(points, triangles)[0])) == crossed[-1]
    assert 3 <= sum(crossed) <= 13


def load(shape, thickness: float, half: float = 7.0, is_round: bool = False, first: float = 0.04) -> Load:
    sides = (half / thickness,) * 2
    slab = (75.0 / thickness, 60.0 / thickness)
    return Load(sides, slab, shape=shape, thickness_mm=thickness, is_round=is_round, first=first)


def face(cells: int = 4) -> SpatialFace:
    here, grid = load(Crowned(10.0, 2.0), 5.0), GridFineness(cells, slope=1.0, height_growth=2.0)
    problem = shaped_problem(here, grid)
    count, along = len(problem.solid.mesh.dofs), len(axis_lines(here, grid, 0)) - 1
    top = np.arange(count)[-along * (len(axis_lines(here, grid, 1)) - 1) :]
    return SpatialFace(problem, horizontal_faces(problem.solid.mesh, top), (True, True), 5.0)


def test_the_lattice_of_a_mesh_is_its_tested_face():
    found = face()
    assert np.all(np.diff(found.rest.reshape(*found._nodes.shape, 3)[..., 0], axis=0) > 0.0)
    assert np.all(np.diff(found.rest.reshape(*found._nodes.shape, 3)[..., 1], axis=1) > 0.0)
    corners = found.rest.reshape(*found._nodes.shape, 3)[::2, ::2].reshape(-1, 3) * 5.0
    assert corners[:, 2] == pytest.approx(-Crowned(10.0, 2.0).drop_mm(corners[:, 0], corners[:, 1]), abs=1e-9)


def test_a_face_that_has_passed_a_plane_of_symmetry_has_met_its_mirror_image():
    found = face()
    rest, whole = found.rest.reshape(*found._nodes.shape, 3), np.zeros((found._nodes.max() + 1, 3))
    assert found.meeting(0.0, whole.ravel()) is None
    # Near the apex the column beside x = 0 goes to the other side of it, the next one stays.
    whole[found._nodes[1, :3], 0] = -0.01 - rest[1, :3, 0]
    assert found.meeting(-0.1, whole.ravel()) is not None
    # What touches the punch does not count: there the sharp edge may crumple a cell.
    assert found.meeting(0.2, whole.ravel()) is None


def test_a_watch_says_between_which_depths_and_where_and_says_it_again():
    class Shut(SpatialFace):
        def __init__(self) -> None:
            pass

        def meeting(self, depth, u):
            return "(1, 2)" if u[0] else None

        def opening_deg(self, u):
            return 12.0

    watch = FoldWatch(Shut())
    assert watch.check(0.3, np.zeros(1)) is None
    assert watch.stop_reason("no equilibrium") == "the face is folded to 12 degrees, and no equilibrium"
    said = watch.check(0.35, np.ones(1))
    assert "between relative depths 0.300 and 0.350 it meets itself at (1, 2) mm" in said
    assert watch.check(0.4, np.zeros(1)) == said and watch.stop_reason(said) == said


def reach(shape, thickness: float, depths: np.ndarray, cells: int, half: float = 7.0, is_round: bool = False):
    """The path in space, on cells as the tables of fields of caps have them."""
    return solve_path(load(shape, thickness, half, is_round), depths, GridFineness(cells, slope=1.0, height_growth=2.0))


@pytest.mark.slow
def test_a_narrow_tall_crown_folds_under_a_square_as_under_its_circle_and_in_a_meridian_plane():
    """Too steep to be cast; the punch's edge is far from its foot. Steps of 0.04, each within two of them.

    On 6 cells the square finds it, the disc does not: what a foot in space shows hangs on where cells lie.
    """
    depths, radius = np.arange(0.12, 0.5, 0.04), 14.0 / np.sqrt(np.pi)
    square, disc = reach(STEEP, 10.0, depths, 4), reach(STEEP, 10.0, depths, 4, radius, True)
    meridian = climb_round(Case(radius / 10.0, 7.5, shape=STEEP, thickness_mm=10.0, first=0.04), depths, 16, 0.1)
    finer = reach(STEEP, 10.0, depths, 6)
    for path in (square, disc, finer):
        assert "the face folds on to itself: between relative depths" in path.stop
        assert abs(path.depth[-1] - meridian.depth[-1]) < 0.081


@pytest.mark.slow
def test_a_castable_crown_that_folds_under_a_square_does_so_near_where_it_does_in_a_meridian_plane():
    """In a meridian plane its foot is shut to 12 degrees at d/h 0.48, where the solve ends."""
    path = reach(CASTABLE, 8.0, np.arange(0.4, 0.6, 0.04), 6)
    assert "the face folds on to itself" in path.stop and 0.4 < path.depth[-1] < 0.54


@pytest.mark.slow
@pytest.mark.parametrize("shape", [Crowned(20.0, 2.0, 9.0), Layered(4.0, 3.0)], ids=lambda shape: shape.name)
def test_a_flat_crown_and_layers_do_not_fold(shape):
    path = reach(shape, 8.0, np.array([0.1, 0.25, 0.4]), 4)
    assert path.stop is None and len(path.depth) == 3


@pytest.mark.slow
def test_a_curve_ends_where_its_crown_folds_in_a_meridian_plane_if_cells_in_space_round_the_foot():
    """Castable (64 degrees); on 7 cells in space nothing of the face meets itself to d/h 0.6."""
    crown, depths = Crowned(1.0, 4.35, 3.43), np.array([0.1, 0.3, 0.5, 0.55])
    curve = solve_shaped_block(
        Pad(12.8, 0.03, 7.9, geometry=crown, sides_mm=(14.0, 14.0)), 12.8 * depths, grid=GridFineness(3)
    )
    assert curve.depth_mm == pytest.approx(12.8 * depths[:2])
    assert "under the circle of the punch's area the crown" in curve.notes[0] and "fold" in curve.notes[0]


@pytest.mark.slow
def test_a_crown_beside_the_punch_says_where_its_face_meets_itself_and_ends_there(monkeypatch):
    monkeypatch.setattr(Crowned, "check", lambda *_: None)  # no mould can make it
    depths, grid = 10.0 * np.array([0.1, 0.2, 0.45, 0.5]), GridFineness(6, slope=1.0, height_growth=2.0)
    curve = solve_shaped_block(
        Pad(10.0, 0.03, 7.9, geometry=STEEP, sides_mm=(14.0, 14.0)), depths, grid=grid, offset_mm=(1.0, 0.0)
    )
    assert len(curve.depth_mm) == 2 and "the face folds on to itself" in curve.notes[0]
    assert "contact of the pad with itself is not followed" in curve.notes[0]
