"""Pads in space on few cells: meshes in closed form, curves from made-up paths, a crown that scales."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.axisymmetric import shaped_pad as plane
from dummydesign.pad.axisymmetric.shaped_pad import EDGE_ERROR, LEFT_TO_SHARP
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath
from dummydesign.pad.spatial import shaped_pad
from dummydesign.pad.spatial.shaped_pad import (
    GridFineness,
    Load,
    axis_lines,
    levels,
    shaped_problem,
    solve_path,
    solve_shaped_block,
)

FEW = GridFineness(3, slope=1.0, height_growth=2.0)
CROWN = Crowned(10.0, 2.0)


def load(shape=CROWN, thickness=5.0, half=(7.0, 5.0), offset=(0.0, 0.0), slab=(30.0, 24.0), is_round=False, **more):
    sides = tuple(one / thickness for one in half), tuple(one / thickness for one in slab)
    at = tuple(one / thickness for one in offset)
    return Load(*sides, shape=shape, thickness_mm=thickness, is_round=is_round, offset=at, **more)


def made(depth, force, stop=None) -> ForcePath:
    return ForcePath(np.array(depth), np.array(force), np.ones(len(depth)), 9, 2, 5, 0.5, stop)


def test_a_load_has_its_lengths_in_thicknesses_and_a_punch_off_its_middle_is_no_quarter():
    pad = Pad(5.0, 0.03, 7.9, geometry=CROWN, sides_mm=(14.0, 10.0), slab_mm=(60.0, 48.0))
    made_of = Load.of(pad, 0.02, (1.5, -2.0))
    assert made_of.half_sides == pytest.approx((1.4, 1.0)) and made_of.half_extents == pytest.approx((6.0, 4.8))
    assert made_of.offset == pytest.approx((0.3, -0.4)) and not made_of.is_round and made_of.first == 0.02
    disc = Load.of(replace(pad, sides_mm=None), 0.02)
    assert disc.is_round and disc.half_sides == pytest.approx((1.58, 1.58)) and disc.offset == (0.0, 0.0)
    assert [load(offset=one).multiplicity for one in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0))] == [4, 2, 2, 1]
    assert load(half=(7.0, 2.0)).scale == pytest.approx(0.4) and load(half=(7.0, 9.0), slab=(60.0, 60.0)).scale == 1.0


def test_the_punch_of_a_load_has_its_sides_or_its_radius_about_its_own_middle():
    at = np.array([[1.8, 0.2, 0.0], [1.8, 0.2, 1.0], [0.3, -0.4, -0.1]])
    for is_round, sides in ((False, (1.4, 1.0)), (True, (1.4, 1.4))):
        here = load(half=tuple(5.0 * one for one in sides), offset=(1.5, -2.0), is_round=is_round)
        punch = here.punch(0.1)
        assert punch.centre == pytest.approx((0.3, -0.4)) and punch.rim == 0.1
        assert np.array(punch.core) + punch.corner + punch.rim == pytest.approx(sides)
        assert punch.gap(at, 0.0)[0][2] == pytest.approx(-0.1 + 0.2)


def test_the_heights_of_a_pad_are_its_shape_over_the_thickness():
    x, y = np.array([0.0, 0.4, 1.1]), np.array([0.0, -0.3, 0.2])
    boned = Boned(9.0, 2.0, 6.0)
    bone, face = load(boned, 10.0).heights(x, y)
    assert bone == pytest.approx(boned.bone_mm(10.0 * x, 10.0 * y) / 10.0 - 1.0) and bone[0] == pytest.approx(-0.8)
    assert face == pytest.approx(0.0 * x)
    assert load(boned, 10.0, homogeneous=True).heights(x, y)[0] == pytest.approx(-1.0)
    bone, face = load().heights(x, y)
    assert bone == pytest.approx(np.full(3, -1.0)) and face == pytest.approx(-CROWN.drop_mm(5.0 * x, 5.0 * y) / 5.0)
    places = np.stack([x, y, np.array([0.0, -1.0, -0.25])])
    bent = load().bend(places)
    assert bent[2] == pytest.approx([face[0], -1.0, 0.75 * face[2] - 0.25])


@pytest.mark.parametrize("top", [1.0, 2.5, 4.5])
def test_one_level_lies_between_two_layers_and_cells_grow_from_the_face(top):
    here = load(Layered(top, 2.0))
    z, growth = levels(here, FEW), FEW.height_growth * (1.0 + 1e-9)
    assert (z[0], z[-1]) == pytest.approx((-1.0, 0.0)) and np.abs(z + top / 5.0).min() < 1e-12
    sizes, seam = np.diff(z)[::-1], int(np.argmin(np.abs(z[::-1] + top / 5.0)))
    assert np.all(sizes > 0.0) and seam >= 2
    assert sizes[0] == pytest.approx(min(1.0 / FEW.cells, top / 15.0))
    for part in (sizes[:seam], sizes[seam:]):
        assert np.all(part[1:] / part[:-1] <= growth)
    # The lower layer begins no coarser than the upper one ended, and with a third of itself at the most.
    assert sizes[seam] == pytest.approx(min(sizes[seam - 1], (1.0 - top / 5.0) / 3.0))
    plain = levels(load(Slab()), FEW)
    assert (plain[0], plain[-1]) == pytest.approx((-1.0, 0.0)) and -plain[-2] == pytest.approx(1.0 / FEW.cells)
    assert -levels(load(Slab(), half=(2.0, 7.0)), FEW)[-2] == pytest.approx(0.4 / FEW.cells)


SPARSE = GridFineness(2, 0.3, 2.0, 3.0)


def test_the_lower_layer_counts_by_its_modulus_and_only_it():
    """Volume of the upper layer, and of the lower one times the ratio of moduli; a homogeneous twin has one."""
    here = load(Layered(2.0, 3.0), slab=(20.0, 16.0))
    weights = [shaped_problem(one, SPARSE).solid.mesh.weight.sum() for one in (here, replace(here, homogeneous=True))]
    assert weights == pytest.approx([4.0 * 3.2 * (0.4 + 3.0 * 0.6), 4.0 * 3.2], rel=1e-9)


def test_the_meshed_part_has_the_volume_of_its_share_of_the_pad():
    here = load(Boned(9.0, 2.0, 6.0), slab=(20.0, 16.0))
    mesh = shaped_problem(here, SPARSE).solid.mesh
    x, y = np.meshgrid((np.arange(400) + 0.5) / 100.0, (np.arange(320) + 0.5) / 100.0)
    bone, face = here.heights(x, y)
    assert mesh.weight.sum() == pytest.approx((face - bone).sum() * 1e-4, rel=5e-3)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (1.5, -2.0)])
def test_lines_meet_the_edges_of_the_punch_and_the_apex_and_are_finest_there(axis, offset):
    here = load(offset=offset)
    lines = axis_lines(here, FEW, axis)
    half, shift, extent = here.half_sides[axis], here.offset[axis], here.half_extents[axis]
    rim = FEW.rim * here.scale
    assert lines[0] == (0.0 if shift == 0.0 else -extent) and lines[-1] == pytest.approx(extent)
    marks = [shift + half - rim, shift - half + rim, 0.0]
    for mark in (one for one in marks if one >= lines[0]):
        assert np.abs(lines - mark).min() < 1e-12
    sizes, middle = np.diff(lines), 0.5 * (lines[1:] + lines[:-1])
    at_edge = sizes[np.argmin(np.abs(middle - marks[0] - 0.4 * rim))]
    assert rim < at_edge < 1.8 * rim and sizes[-1] > 2.0 * at_edge
    assert np.all(sizes < 1.35 * (half / FEW.cells + FEW.slope * np.maximum(np.abs(middle - shift) - half, 0.0)))


def test_a_sharper_apex_and_a_smaller_first_depth_take_smaller_cells_there():
    def first(shape, depth):
        return np.diff(axis_lines(load(shape, first=depth), GridFineness(8), 0))[0]

    assert first(Crowned(10.0, 2.0), 0.002) == pytest.approx(0.1**0.5 * first(Crowned(10.0, 2.0), 0.02), rel=0.25)
    assert first(Crowned(2.5, 2.0), 0.002) == pytest.approx(0.5 * first(Crowned(10.0, 2.0), 0.002), rel=0.25)
    assert first(Slab(), 0.002) > 3.0 * first(Crowned(10.0, 2.0), 0.002)


def test_a_coarser_grid_has_about_two_thirds_of_the_cells_and_the_same_fillet():
    grid = GridFineness(9, 0.08, 0.5, 1.7)
    coarser = grid.coarser()
    assert (coarser.cells, coarser.rim, coarser.height_growth) == (6, 0.08, 1.7)
    assert coarser.slope > grid.slope and GridFineness(3).coarser().cells == 3


def test_a_path_on_few_cells_is_that_of_a_cap_on_a_layer_before_the_edge_of_the_punch_is_reached():
    """Four quarters, in units of the modulus 3 and the thickness; Dimitriadis et al. (2002) for a glued layer."""
    depth = np.array([0.03, 0.06])
    here = load(half=(5.0, 5.0), slab=(15.0, 15.0), condition="frictionless", first=0.03)
    path = solve_path(here, depth, GridFineness(3, 0.2, 1.0, 2.5))
    assert path.depth == pytest.approx(depth) and path.stop is None
    x = np.sqrt(2.0 * depth)
    layer = 1.0 + 1.133 * x + 1.283 * x**2 + 0.769 * x**3 + 0.0975 * x**4
    assert here.multiplicity * path.force == pytest.approx(layer * 16.0 / 3.0 * np.sqrt(2.0) * depth**1.5, rel=0.07)


@pytest.mark.parametrize("sides", [(14.0, 14.0), (14.0, 10.0)])
def test_a_curve_is_the_finer_path_of_the_whole_in_newtons_with_what_the_coarser_one_is_off_by(monkeypatch, sides):
    paths = {3: made([0.1, 0.2], [1.1, 2.1], "coarse"), 5: made([0.1, 0.2, 0.3], [1.0, 2.0, 3.0])}
    monkeypatch.setattr(shaped_pad, "solve_path", lambda load, depths, grid: paths[grid.cells])
    pad = Pad(5.0, 0.03, 7.9, geometry=Slab(), sides_mm=sides)
    depth, unit = 5.0 * np.array([0.1, 0.2, 0.3]), 4.0 * 0.01 * 25.0
    found = solve_shaped_block(pad, depth, GridFineness(5))
    assert found.force_N == pytest.approx(unit * np.array([1.0, 2.0, 3.0])) and found.depth_mm == pytest.approx(depth)
    # Where the coarse grid has ended the largest change that was seen counts.
    assert found.error_N / found.force_N == pytest.approx([0.1, 0.05, 0.1]) and found.notes == ()
    assert found.solver["newton_iterations"] == 10
    beside = solve_shaped_block(pad, depth, GridFineness(5), (1.0, -1.0))
    assert beside.force_N == pytest.approx(0.25 * found.force_N)
    paths[5] = made([0.1], [1.0], "it ends")
    (note,) = solve_shaped_block(pad, depth, GridFineness(5)).notes
    assert "0.100" in note and "0.300" in note and "it ends" in note
    paths[3] = made([], [], "at once")
    with pytest.raises(NoAnswerError, match="at once"):
        solve_shaped_block(pad, depth, GridFineness(5))


@pytest.mark.parametrize("is_round", [True, False])
def test_a_round_pad_is_asked_in_a_meridian_plane_under_the_circle_of_the_punch_s_area(monkeypatch, is_round):
    asked, ends = [], {"stop": None, "reached": 0.9}

    def climb(case, deepest, cells, rim, smaller=None):
        asked.append(case)
        force = {0.05: 1.1, 0.1: 1.0}[rim]
        path = made([], [], ends["stop"])
        at = lambda depths: made(depths, force * depths[depths <= ends["reached"]])  # noqa: E731
        return SimpleNamespace(path=path, reached=ends["reached"], at=at)

    monkeypatch.setattr(plane, "climb", climb)
    here, depths = load(half=(7.0, 7.0), is_round=is_round), np.array([0.05, 0.11, 0.3])
    twin = shaped_pad.round_twin(here, depths)
    assert twin.depths == pytest.approx(depths) and twin.stop is None
    assert twin.force == pytest.approx(1.1 * depths * 1.1**LEFT_TO_SHARP)
    assert twin.case.radius == pytest.approx(1.4 * (1.0 if is_round else 2.0 / np.sqrt(np.pi)))
    assert twin.case.extent == pytest.approx(2.0 * np.sqrt(6.0 * 4.8 / np.pi)) and twin.case.thickness_mm == 5.0
    ends.update(stop="no equilibrium", reached=0.2)
    assert shaped_pad.round_twin(here, depths).stop is None
    ends.update(stop=f"{plane.FOLDED[0]} folds")
    folded = shaped_pad.round_twin(here, depths)
    assert folded.depths == pytest.approx(depths[:2]) and "folds" in folded.stop
    ends.update(reached=0.0)
    with pytest.raises(NoAnswerError):
        shaped_pad.round_twin(here, depths)
    count = len(asked)
    for other in (
        load(half=(7.0, 7.0), offset=(1.0, 0.0)),
        load(Slab(), half=(7.0, 7.0)),
        load(Crowned(10.0, 2.0, ridge=1.0), half=(7.0, 7.0)),
        load(half=(7.0, 7.0), slab=(9.2, 9.2)),
    ):
        assert shaped_pad.round_twin(other, depths) is None
    assert len(asked) == count


def test_a_round_pad_is_corrected_by_what_like_cells_do_in_the_plane_and_states_a_share_of_it(monkeypatch):
    """Half of the force is left out on the cells in space: the force doubles, and more along a square's longer edge."""
    depths = np.array([0.1, 0.3])
    twin = SimpleNamespace(depths=depths, stop=None, case=SimpleNamespace(radius=1.58, extent=6.0, scale=1.0))
    twin.change_on = lambda lines, cells, rim, step: np.full(2, np.log(2.0))
    monkeypatch.setattr(shaped_pad, "round_twin", lambda load, depths: twin)
    monkeypatch.setattr(shaped_pad, "solve_path", lambda load, wanted, grid: made(wanted, wanted))
    pad = Pad(5.0, 0.03, 7.9, geometry=CROWN)
    disc, square = (
        solve_shaped_block(one, 5.0 * depths, GridFineness(5))
        for one in (pad, replace(pad, sides_mm=(7.9 * np.pi**0.5,) * 2))
    )
    assert disc.force_N == pytest.approx(2.0 * 4.0 * 0.01 * 25.0 * depths)
    assert disc.error_N / disc.force_N == pytest.approx(0.01 + EDGE_ERROR * np.log(2.0))
    assert square.force_N == pytest.approx(0.5 * disc.force_N * 2.0 ** (2.0 / np.pi**0.5))


def test_a_flat_top_is_its_ratio_to_a_homogeneous_pad_on_the_same_cells_times_the_slab(monkeypatch):
    def solve(load, depths, grid):
        return made(depths, depths * (1.0 if load.homogeneous else 3.0 - 0.1 * (grid.cells == 3)))

    monkeypatch.setattr(shaped_pad, "solve_path", solve)
    slab = SimpleNamespace(force=lambda depth: 7.0 * depth, relative_error=lambda depth: 0.02 + 0.0 * depth)
    depth = np.array([0.5, 1.5])
    found = solve_shaped_block(Pad(5.0, 0.03, 7.9, geometry=Layered(2.0, 3.0)), depth, GridFineness(5), slab=slab)
    assert found.force_N == pytest.approx(21.0 * depth)
    assert found.error_N / found.force_N == pytest.approx(0.02 + 0.1 / 3.0)


def test_what_is_not_corrected_doubts_its_edge_from_where_the_face_is_near_it():
    """A crown's face at the edge is 2 of 5 mm below the top, less beside the middle; a ridge's is its top."""
    ridge = Crowned(10.0, 2.0, ridge=1.0)
    pads = load(half=(7.0, 7.0)), load(half=(7.0, 7.0), offset=(2.0, 0.0)), load(ridge, half=(7.0, 7.0))
    centred, beside, on_top = (shaped_pad._edge_left(one, np.array([0.01, 0.15, 0.3, 0.45, 0.6])) for one in pads)
    assert centred == pytest.approx([0.0, 0.0, 0.0664, 0.0814, 0.03], abs=1e-4)
    assert on_top == pytest.approx([0.15, 0.15, 0.1329, 0.0814, 0.03], abs=1e-4)
    assert beside[0] == 0.0 < beside[1] < on_top[1] and centred[2] < beside[2]
