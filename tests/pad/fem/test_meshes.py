"""Meshes: lines that follow wanted sizes, volumes in closed form, sides, folded quarters."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.pad.axisymmetric import filleted
from dummydesign.pad.axisymmetric.case import Case, rimmed_problem, sharp_problem
from dummydesign.pad.axisymmetric.filleted import AT_FILLET, CELLS, GROWTH, LARGEST, filleted_problem
from dummydesign.pad.axisymmetric.profile_punch import CELLS as PROFILE_CELLS
from dummydesign.pad.axisymmetric.profile_punch import (
    EDGE_CELLS,
    SHARE,
    TIP_CELLS,
    Region,
    edge_problem,
    indentation_problem,
    tip_region,
)
from dummydesign.pad.axisymmetric.shaped_problem import Touch, shaped_problem
from dummydesign.pad.fem import mesh_axisymmetric as plane
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mesh_axisymmetric import Resolution, Sizes
from tests.support.ball_punch import sphere


@pytest.mark.parametrize(("start", "stop"), [(0.0, 3.0), (1.0, 0.0), (-0.5, -2.0)])
@pytest.mark.parametrize("growth", [1.0, 1.35, 2.0])
def test_graded_points_meet_both_ends_and_grow_by_one_factor(start, stop, growth):
    points = plane.graded(start, stop, 0.1, growth)
    sizes = np.abs(np.diff(points))
    assert (points[0], points[-1]) == pytest.approx((start, stop)) and np.all(np.diff(points) * (stop - start) > 0.0)
    assert sizes[1:] / sizes[:-1] == pytest.approx(np.full(len(sizes) - 1, growth))
    # As many cells as the first one needs: with one fewer it would be too large.
    if growth > 1.0:
        fewer = abs(stop - start) * (growth - 1.0) / (growth ** (len(sizes) - 1) - 1.0)
        assert sizes[0] <= 0.1 * (1.0 + 1e-9) < fewer
    else:
        assert sizes[0] == pytest.approx(0.1)
    assert len(plane.graded(0.0, 0.01, 0.1, growth)) == 2


def test_wanted_sizes_are_the_least_of_all_places_and_of_what_is_allowed_inside_the_reach():
    slope, r = 0.25, np.array([0.0, 0.5, 1.0, 2.0, 2.4, 9.0])
    sizes = Sizes((0.5, 2.0), (0.02, 0.1), slope, 0.3, 3.0)
    exact = [0.02 + slope * 0.5, 0.02, 0.02 + slope * 0.5, 0.1, 0.1 + slope * 0.4, 0.3 + slope * 6.0]
    assert sizes.at(r) == pytest.approx(exact)
    lines = plane.lines_by_size(0.0, 9.0, (0.7, 12.0), sizes.at, 0.2)
    assert lines[0] == 0.0 and lines[-1] == 9.0 and np.abs(lines - 0.7).min() == 0.0
    cells, middle = np.diff(lines), 0.5 * (lines[1:] + lines[:-1])
    # A cell follows the wanted size where it is not stretched to meet a mark.
    share = cells / sizes.at(middle)
    assert np.median(share) == pytest.approx(1.0, abs=0.12) and share.max() < 1.3


@pytest.mark.parametrize("interface", [None, 0.1, 0.5, 0.95])
def test_heights_grow_from_the_face_and_one_lies_between_layers(interface):
    share = plane.height_lines(0.06, interface)
    assert (share[0], share[-1]) == (0.0, pytest.approx(1.0)) and np.all(np.diff(share) > 0.0)
    assert 0.02 < share[1] <= 0.06 * (1.0 + 1e-9)
    seam = len(share) - 1 if interface is None else int(np.argmin(np.abs(share - interface)))
    sizes = np.diff(share)
    for part in (sizes[:seam], sizes[seam:]):
        assert part[1:] / part[:-1] == pytest.approx(np.full(max(len(part) - 1, 0), plane.Z_GROWTH))
    if interface is not None:
        assert share[seam] == pytest.approx(interface) and seam >= 3
        assert sizes[seam] <= min(sizes[seam - 1], (1.0 - interface) / 4.0) * (1.0 + 1e-9)


def test_columns_that_are_stretched_have_the_volume_between_bone_and_face():
    """A cone taken off the face and another put on the base; both are met by straight columns exactly."""
    r, share = np.linspace(0.0, 2.0, 9), plane.height_lines(0.2)
    points, quads, row = plane.columns(r, share)
    mesh = plane.discretise(points, quads, move=plane.stretch(lambda at: 0.1 * at, lambda at: 0.2 * (1.0 - 0.5 * at)))
    removed = 2.0 * np.pi * (0.1 * 8.0 / 3.0) + 2.0 * np.pi * 0.2 * (2.0 - 0.5 * 8.0 / 3.0)
    assert mesh.weight.sum() == pytest.approx(4.0 * np.pi - removed, rel=1e-12)
    node = plane.cell_nodes(mesh)
    top = mesh.nodes[:, np.unique(node[row == 0][:, [2, 6, 3]])]
    low = mesh.nodes[:, np.unique(node[row == row.max()][:, [0, 4, 1]])]
    assert top[1] == pytest.approx(-0.1 * top[0]) and low[1] == pytest.approx(-1.0 + 0.2 * (1.0 - 0.5 * low[0]))


@pytest.mark.parametrize("quarter_points", [False, True])
def test_a_web_has_the_volume_of_the_slab_and_its_centre_at_the_edge(quarter_points):
    points, quads, centre = plane.web_mesh(0.8, 3.0, 0.25, 4, Resolution())
    mesh = plane.discretise(points, quads, centre, quarter_points)
    assert mesh.weight.sum() == pytest.approx(np.pi * 9.0, rel=1e-10) and mesh.weight.min() > 0.0
    assert points[:, centre] == pytest.approx(np.repeat([[0.8], [0.0]], len(centre), axis=1))
    at = np.all(np.abs(mesh.nodes - np.array([[0.8], [0.0]])) < 1e-12, axis=0)
    # All nodes in the centre are one in the unknowns.
    assert len(np.unique(mesh.dofs[np.isin(mesh.dofs // 2, np.nonzero(at)[0])])) == 2
    ring = np.hypot(*(mesh.nodes - np.array([[0.8], [0.0]])))
    near = ring[(ring > 1e-12) & (mesh.nodes[1] > -1e-12)]
    smallest = 0.25 * 0.5**3
    assert near.min() == pytest.approx(smallest * (0.25 if quarter_points else 0.5))
    # On the face: the rings, each half of the one before, and the middles of what lies between them.
    inside = np.unique(near[near <= 0.25 * (1.0 + 1e-9)].round(9))
    middles = [0.75 * 0.25 * 0.5**k for k in range(3)] + [near.min()]
    assert inside == pytest.approx(np.sort(np.round([0.25 * 0.5**k for k in range(4)] + middles, 9)))


def test_sides_on_a_face_are_those_of_its_cells_and_have_their_middles_between_their_ends():
    points, quads, _ = plane.columns(np.array([0.0, 0.5, 1.5]), np.array([0.0, 0.3, 1.0]))
    mesh = plane.discretise(points, quads)
    for on, along in ((plane.on_top(mesh), 0), (plane.on_base(mesh, 1.0), 0), (plane.on_axis(mesh), 1)):
        sides = plane.edges_on(mesh, on)
        assert len(sides) == 2 and on[sides].all() and on.sum() == 5
        ends = mesh.nodes[:, sides[:, [0, 2]]]
        assert mesh.nodes[:, sides[:, 1]] == pytest.approx(ends.mean(axis=2))
        assert np.abs(np.diff(ends[along], axis=1)).sum() == pytest.approx(1.5 if along == 0 else 1.0)


@pytest.mark.parametrize("within", [np.inf, 1.0])
def test_cells_away_from_a_fillet_grow_to_the_largest_and_beyond_where_nothing_is_felt(within):
    points = filleted.lines(4.0, 0.03, 1.5, 0.2, within)
    sizes = np.diff(points)
    scale = 4.0 / np.sum(sizes) * sizes[0] / 0.03
    assert points[0] == 0.0 and points[-1] == pytest.approx(4.0) and 0.7 < scale <= 1.0
    own = sizes / scale
    inside = points[1:] / scale < within
    assert own[inside].max() <= 0.2 * (1.0 + 1e-9) and (own[~inside].max(initial=0.0) > 0.5) == (within == 1.0)
    grows = own[1:] / own[:-1]
    free = own[1:] < 0.2 * (1.0 - 1e-9)
    assert grows[free] == pytest.approx(np.full(free.sum(), 1.5)) and grows.max() <= 1.5 * (1.0 + 1e-9)


@pytest.mark.parametrize("edge", [0.05, 0.24])
@pytest.mark.parametrize("coarser", [1.0, 2.0])
def test_a_filleted_problem_has_its_cells_over_the_fillet_and_glues_the_flat_face(edge, coarser):
    problem = filleted_problem(Case(0.8, 2.4, edge=edge), coarser=coarser)
    mesh = problem.solid.mesh
    corner = mesh.nodes[:, np.unique(plane.cell_nodes(mesh)[:, :4])]
    r, z = (np.unique(line.round(9)) for line in corner)
    assert mesh.weight.sum() == pytest.approx(np.pi * 2.4**2)
    assert (r[0], r[-1], z[0]) == pytest.approx((0.0, 2.4, -1.0))
    flat, cell = 0.8 - edge, min(edge / CELLS, AT_FILLET) * coarser
    start = int(np.argmin(np.abs(r - flat)))
    assert r[start] == pytest.approx(flat) and r[start + 1] - flat == pytest.approx(cell, rel=0.35)
    assert -z[-2] == pytest.approx(cell, rel=0.35) and r[start] - r[start - 1] == pytest.approx(cell, rel=0.35)
    assert np.diff(z).max() <= LARGEST * coarser and np.diff(r[r < 0.8]).max() <= LARGEST * coarser
    growth = np.diff(r[start + 2 :])
    assert (growth[1:] / growth[:-1]).max() <= GROWTH**coarser * 1.05
    driven = mesh.nodes[:, problem.driven // 2]
    assert driven[0].max() == pytest.approx(flat) and driven[1] == pytest.approx(0.0 * driven[1])
    reach = problem.surface.points(np.zeros(mesh.size))
    assert flat <= reach[..., 0].min() < flat + cell and reach[..., 0].max() > 0.8 + 0.3
    assert (problem.punch.radius, problem.punch.rim) == pytest.approx((0.8, edge))


def test_the_coarse_mesh_of_a_fillet_has_half_the_cells_across():
    counts = [len(filleted_problem(Case(0.8, 2.4, edge=0.12), coarser=one).solid.mesh.dofs) for one in (1.0, 2.0)]
    assert 3.0 < counts[0] / counts[1] < 5.0


@pytest.mark.parametrize("share", [0.0, 0.08])
@pytest.mark.parametrize("start", [0.0, 0.4])
def test_a_region_is_met_at_both_ends_with_cells_of_its_size_or_share_of_the_radius(share, start):
    region = Region(start, 2.0, 0.05, share)
    lines = region.lines()
    sizes = np.diff(lines)
    assert (lines[0], lines[-1]) == pytest.approx((start, 2.0)) and np.all(sizes > 0.0)
    wanted = np.maximum(0.05, share * lines[:-1])
    assert sizes / wanted == pytest.approx(np.full(len(sizes), 1.0), abs=0.12) and sizes.max() <= wanted.max() * 1.05


@pytest.mark.parametrize("depth", [1e-3, 1e-2])
@pytest.mark.parametrize("radius", [1.5, 6.0])
def test_under_a_ball_some_cells_lie_in_the_first_contact(depth, radius):
    """Where half of the depth meets the ball: its contact radius sqrt(R d)."""
    region = tip_region(sphere(radius), 0.7, depth, 24)
    assert (region.start, region.stop, region.share) == (0.0, 0.7, pytest.approx(SHARE * PROFILE_CELLS / 24))
    tip = min(0.7 / TIP_CELLS, np.sqrt(radius * depth))
    assert region.cell == pytest.approx(TIP_CELLS * tip / 24.0, rel=0.03)
    coarse = tip_region(sphere(radius), 0.7, depth, 12)
    assert coarse.cell == pytest.approx(2.0 * region.cell) and coarse.share == pytest.approx(2.0 * region.share)


@pytest.mark.parametrize("region", [Region(0.0, 0.8, 0.02, 0.2), Region(0.5, 1.0, 0.05)])
def test_cells_beside_a_fine_region_go_on_from_its_own(region):
    problem = indentation_problem(sphere(3.0), region, Case(0.8, 2.4, condition="frictionless"))
    mesh = problem.solid.mesh
    r, z = (np.unique(mesh.nodes[k, plane.cell_nodes(mesh)[:, :4]].round(9)) for k in (0, 1))
    start, stop = (int(np.argmin(np.abs(r - one))) for one in (region.start, region.stop))
    sizes, growth = np.diff(r), 1.3
    assert r[start : stop + 1] == pytest.approx(region.lines()) and mesh.weight.sum() == pytest.approx(np.pi * 2.4**2)
    # What is graded begins with its first cell or a little less, so that the last one ends where it should.
    assert sizes[stop - 1] / growth**2 < sizes[stop] <= sizes[stop - 1] * (1.0 + 1e-6)
    assert region.cell / growth**2 < -z[-2] <= region.cell * (1.0 + 1e-6)
    if start:
        assert region.cell / growth**2 < sizes[start - 1] <= region.cell * (1.0 + 1e-6)


def test_a_sliding_edge_is_meshed_finely_inwards_and_beyond():
    problem = edge_problem(Case(0.8, 2.4, condition="frictionless", edge=0.2))
    mesh = problem.solid.mesh
    r = np.unique(mesh.nodes[0, plane.cell_nodes(mesh)[:, :4]].round(9))
    fine = np.diff(r[(r > 0.8 - 3.0 * 0.2 - 1e-9) & (r < 0.8 + 2.0 * 0.2 + 1e-9)])
    assert fine == pytest.approx(np.full(len(fine), 0.2 / EDGE_CELLS), rel=0.1) and len(fine) == 15
    assert mesh.weight.sum() == pytest.approx(np.pi * 2.4**2)
    assert (problem.punch.radius, problem.punch.rim) == (0.8, 0.2)


@pytest.mark.parametrize("rim", [0.1, 0.02])
def test_a_rimmed_problem_moves_the_face_far_from_the_edge_and_glues_the_rest(rim):
    case = Case(0.8, 2.4)
    problem, sharp = rimmed_problem(case, rim, Resolution()), sharp_problem(case, Resolution())
    mesh, flat = problem.solid.mesh, 0.8 - rim
    driven = mesh.nodes[0, problem.driven // 2].max()
    points = problem.surface.points(np.zeros(mesh.size))[..., 0]
    # Six fillets from the fillet or a little more, but a third of the face at least.
    assert 0.2 * flat < driven <= max(flat - 6.0 * rim, 0.3 * flat) + 1e-9
    assert driven <= points.min() < driven + 0.2 and 0.8 < points.max() <= 1.6
    assert mesh.nodes[0, problem.carried // 2].max() == pytest.approx(flat)
    assert sharp.solid.mesh.nodes[0, sharp.driven // 2].max() == pytest.approx(0.8)
    assert mesh.weight.sum() == pytest.approx(sharp.solid.mesh.weight.sum()) == pytest.approx(np.pi * 2.4**2)


def test_a_smaller_first_depth_takes_smaller_cells_at_an_apex_and_a_layer_has_a_line_of_nodes():
    def apex(first):
        mesh = shaped_problem(Case(0.8, 3.0, shape=Crowned(10.0, 2.0), thickness_mm=10.0, first=first), 8).solid.mesh
        return np.sort(np.unique(mesh.nodes[0, plane.cell_nodes(mesh)[:, :4]].round(9)))[1]

    assert apex(0.00125) == pytest.approx(0.5 * apex(0.005), rel=0.2)
    layered = shaped_problem(Case(0.8, 3.0, shape=Layered(3.0, 2.0), thickness_mm=10.0), 8).solid.mesh
    plain = np.pi * 9.0
    assert layered.weight.sum() == pytest.approx(plain * (0.3 + 2.0 * 0.7))
    assert layered.weight[layered.modulus_factor == 1.0].sum() == pytest.approx(0.3 * plain)


def test_a_contact_radius_lies_on_straight_lines_between_solved_depths_and_ends_with_them():
    touch = Touch(np.array([1.0, 2.0]), np.array([2.0, 3.0]))
    found = touch.radius_at(np.array([0.0, 0.5, 1.5, 2.0, 2.1]))
    assert found[:4] == pytest.approx([0.0, 1.0, 2.5, 3.0]) and np.isnan(found[4])


def quarter(folded):
    x, z = np.array([0.0, 0.5, 1.2, 2.0]), np.array([-1.0, -0.4, 0.0])
    return space.quarter(x, x, z, folded), x, z


def test_a_quarter_has_its_volume_whole_and_folded_and_its_faces_on_top():
    whole, x, _ = quarter(False)
    half, *_ = quarter(True)
    assert whole.mesh.weight.sum() == pytest.approx(4.0) and half.mesh.weight.sum() == pytest.approx(2.0)
    assert len(whole.faces) == 9 and len(half.faces) == 6 and whole.share == pytest.approx(np.ones(9))
    assert np.sort(half.share) == pytest.approx([0.5, 0.5, 0.5, 1.0, 1.0, 1.0])
    for part in (whole, half):
        places = part.mesh.nodes[:, part.faces]
        assert places[2] == pytest.approx(0.0 * places[2])
        assert np.all(np.diff(places[1].reshape(-1, 3, 3), axis=2) > 0.0)
        assert np.all(np.diff(places[0].reshape(-1, 3, 3), axis=1) > 0.0)
        area = np.ptp(places[0], axis=1) * np.ptp(places[1], axis=1)
        assert (area * part.share).sum() == pytest.approx(4.0 if part is whole else 2.0)
    low = space.horizontal_faces(whole.mesh, np.nonzero(whole.lattice[0] == 0)[0], upper=False)
    assert whole.mesh.nodes[2, low] == pytest.approx(np.full(low.shape, -1.0)) and len(low) == 9
    assert whole.lattice[0].max() == 1 and whole.lattice[1].max() == whole.lattice[2].max() == len(x) - 2


def test_unknowns_beyond_the_diagonal_of_a_folded_quarter_are_those_of_their_mirror_image():
    half, *_ = quarter(True)
    x, y, _ = half.mesh.nodes
    u = np.random.default_rng(4).standard_normal(half.mesh.size)
    moved = u[half.unknowns].reshape(-1, 3)
    beyond, on = x > y + 1e-9, np.abs(x - y) < 1e-9
    assert beyond.any() and on.any() and moved[on, 0] == pytest.approx(moved[on, 1])
    for k in np.nonzero(beyond)[0]:
        mirror = np.argmin(np.abs(half.mesh.nodes - half.mesh.nodes[[1, 0, 2], k][:, None]).sum(axis=0))
        assert moved[k] == pytest.approx(moved[mirror][[1, 0, 2]])
    before = ~beyond & ~on
    assert moved[before] == pytest.approx(u.reshape(-1, 3)[before])
