"""Force of a pad of any shape under a flat punch, by finite elements in space.

Whether the face has folded on to itself is asked as ``fold`` does of round pads. The face is a lattice of triangles
through its nodes. It has met itself when an edge of one triangle pierces another, or when it has passed a plane of
symmetry, where its mirror image stands. A face that starts without crossing itself cannot come to lie inside the
gel, or inside another part of itself, without that. One of both must be free of the punch: a cell that is crumpled
where it touches the punch's corner is a matter of the sharp edge.

Most states are settled by less: seen from above a face that is nowhere turned over covers each place once and
cannot cross itself. Where it is (a crown that bulges over its foot), every place that is covered more than once is
covered by a triangle that is turned over too, so only those that stand over or under such ones are compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.axisymmetric.case import Case, end_note, relative_depths, unsolved
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, opening_deg
from dummydesign.pad.axisymmetric.shaped_pad import EDGE_ERROR, LARGEST_STEP, RoundTwin
from dummydesign.pad.contact.axisymmetric import SHAPED_PAD_IN_SPACE
from dummydesign.pad.contact.spatial import BeadedPunch, FaceContact
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mesh_axisymmetric import Sizes, lines_by_size
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.force_law import ForceCurve, PadCurve
from dummydesign.pad.material.hyperelastic import Array
from dummydesign.pad.pad_under_punch import SLAB, Pad
from dummydesign.pad.solve.continuation import ForcePath, cost, follow
from dummydesign.pad.solve.equilibrium import ContactProblem, Equilibrium
from dummydesign.pad.solve.multifrontal import Dissection
from dummydesign.pad.spatial.square_punch import Block
from dummydesign.pad.tables.crowned import fade

# How far a node may be beyond a plane of symmetry, in thicknesses: rounding.
BEYOND = 1e-9
# Nodes nearer to the punch than this, over the radius of its fillet, touch it: contact gives way a little.
NEAR = 0.1


def lattice_triangles(along: int, across: int) -> Array:
    """Triangles of a lattice of points, two to each of its meshes, counted anticlockwise from above."""
    number = np.arange(along * across).reshape(along, across)
    one, two, three, four = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    return np.concatenate([np.stack([one, two, three], -1), np.stack([one, three, four], -1)]).reshape(-1, 3)


def turned_over(points: Array, triangles: Array) -> Array:
    """Which triangles show their lower side from above, or are seen edge on."""
    one, two, three = (points[triangles[:, i], :2] for i in range(3))
    way, other = two - one, three - one
    return way[:, 0] * other[:, 1] - way[:, 1] * other[:, 0] <= 0.0


def pierced(points: Array, triangles: Array) -> tuple[Array, Array]:
    """Edges of triangles that pierce other triangles of one surface, to which they do not belong."""
    over = turned_over(points, triangles)
    low, high = (best(points[triangles], axis=1) for best in (np.min, np.max))
    near = np.nonzero(_overlap(low[:, :2], high[:, :2], low[over, :2], high[over, :2]).any(axis=1))[0]
    faces = triangles[near]
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    ends = points[edges]
    edge, face = np.nonzero(_overlap(ends.min(axis=1), ends.max(axis=1), low[near], high[near]))
    separate = ~(edges[edge][:, :, None] == faces[face][:, None, :]).any(axis=(1, 2))
    edge, face = edge[separate], face[separate]
    start, way = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    corner = points[faces[face]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    before = np.einsum("ni,ni->n", start - corner[:, 0], normal)
    behind = np.einsum("ni,ni->n", start + way - corner[:, 0], normal)
    arm = corner - start[:, None]
    side = np.einsum("nki,ni->nk", np.cross(arm, np.roll(arm, -1, axis=1)), way)
    crossing = (before * behind < 0.0) & (np.all(side >= 0.0, axis=1) | np.all(side <= 0.0, axis=1))
    return edges[edge[crossing]], faces[face[crossing]]


def _overlap(low: Array, high: Array, other_low: Array, other_high: Array) -> Array:
    """Which boxes (n, axes) overlap which others (m, axes)."""
    meeting = np.ones((len(low), len(other_low)), dtype=bool)
    for axis in range(low.shape[1]):
        meeting &= low[:, None, axis] <= other_high[None, :, axis]
        meeting &= other_low[None, :, axis] <= high[:, None, axis]
    return meeting


class SpatialFace:
    """The face of a pad solved in space."""

    notch: ClassVar[str] = "the face"
    meets: ClassVar[str] = (
        "the face folds on to itself: between relative depths {last:.3f} and {depth:.3f} it meets itself at {place} mm "
        "from the highest point, and contact of the pad with itself is not followed; flatter flanks stay open"
    )

    def __init__(
        self,
        problem: ContactProblem,
        faces: Array,
        mirrored: tuple[bool, bool],
        thickness_mm: float,
    ) -> None:
        used = np.unique(faces)
        face_nodes = problem.solid.mesh.nodes[:, used].T
        (x, i), (y, j) = (np.unique(face_nodes[:, axis].round(9), return_inverse=True) for axis in (0, 1))
        nodes = np.full((len(x), len(y)), -1)
        nodes[i, j] = used
        self._nodes = nodes
        self._triangles = lattice_triangles(*nodes.shape)
        self.rest = problem.solid.mesh.nodes.T[nodes.ravel()]
        assert isinstance(problem.punch, BeadedPunch)
        self._punch = problem.punch
        self._mirrored, self._thickness_mm = mirrored, thickness_mm

    def _points(self, u: Array) -> Array:
        return self.rest + u.reshape(-1, 3)[self._nodes.ravel()]

    def meeting(self, depth: float, u: Array) -> str | None:
        """Where the free face crosses itself or its mirror image, nearest to the highest point, in words. [mm]"""
        points = self._points(u)
        if not turned_over(points, self._triangles).any():
            return None
        free = self._punch.gap(points, depth)[0] > NEAR * self._punch.rim
        edges, faces = pierced(points, self._triangles)
        edges = edges[free[edges].all(axis=1) | free[faces].all(axis=1)]
        parts = [self.rest[edges, :2].mean(axis=1)]
        for axis in np.flatnonzero(np.array(self._mirrored)):
            parts.append(self.rest[free & (points[:, axis] < -BEYOND), :2])
        places = np.concatenate(parts)
        if not len(places):
            return None
        x, y = places[np.argmin(np.hypot(places[:, 0], places[:, 1]))] * self._thickness_mm
        return f"({x:.3g}, {y:.3g})"

    def opening_deg(self, u: Array) -> float:
        """Angle of the narrowest notch along the lines of the lattice."""
        points = self._points(u).reshape(*self._nodes.shape, 3)
        return min(opening_deg(points[..., [0, 2]].swapaxes(0, 1)), opening_deg(points[..., [1, 2]]))


def watched(problem: ContactProblem, face: SpatialFace, depths: Array, largest_step: float) -> ForcePath:
    """Follow a problem through depths, to where its face folds on to itself at the most."""
    watch, first = FoldWatch(face), 0.25 * float(depths[0])

    def check(depth: float, solution: Equilibrium) -> str | None:
        return watch.check(depth, solution.u)

    return watch.with_stop_reason(follow(problem, depths, first, largest_step, first / 64.0, visit=check))


# Cell at the first touch: this over ``Grid.cells``, of the contact radius sqrt(R d) at the first depth.
APEX_CELLS = 4.0
# Height of the uppermost cells over the thickness: this over ``Grid.cells``.
HEIGHT_CELLS = 1.0
# A part of a cell that is no cell of its own along a side.
SPARE = 0.3


@dataclass(frozen=True)
class GridFineness:
    """How fine the grid is."""

    cells: int = 7
    rim: float = 0.1
    slope: float = 0.7
    height_growth: float = 1.6

    def coarser(self) -> GridFineness:
        """Cells about 1.5 times as large, the same fillet."""
        return replace(self, cells=max(3, round(self.cells / 1.5)), slope=1.2 * self.slope)


@dataclass(frozen=True)
class Load(Block):
    """A shaped pad and the punch on it (lengths of the shape in mm).

    ``first`` is the smallest depth of interest. ``homogeneous`` leaves out bone and second resin.
    """

    shape: PadShape = SLAB
    thickness_mm: float = 1.0
    is_round: bool = False
    offset: tuple[float, float] = (0.0, 0.0)
    first: float = 0.05
    homogeneous: bool = False

    @classmethod
    def of(cls, pad: Pad, first: float, offset_mm: tuple[float, float] = (0.0, 0.0)) -> Load:
        """Make the load of a pad under its own punch, square or round; refuse what cannot be meshed."""
        h = pad.thickness_mm
        half_mm = (pad.radius_mm,) * 2 if pad.sides_mm is None else (0.5 * pad.sides_mm[0], 0.5 * pad.sides_mm[1])
        half_sides, extents, offset = (
            (float(one) / h, float(other) / h)
            for one, other in (half_mm, (0.5 * pad.slab_mm[0], 0.5 * pad.slab_mm[1]), offset_mm)
        )
        load = cls(
            half_sides,
            extents,
            pad.base,
            pad.condition,
            pad.shape,
            pad.poisson,
            pad.geometry,
            float(h),
            pad.sides_mm is None,
            offset,
            first,
        )
        load.check()
        return load

    def check(self) -> None:
        """Refuse a punch that is not over the pad."""
        h = self.thickness_mm
        for half, shift, extent in zip(self.half_sides, self.offset, self.half_extents):
            if not half > 0.0 or not np.isfinite(half):
                message = f"half side of the punch = {half * h:g} mm must be above 0"
                raise InputError(message, "out_of_range", "punch_half_side_mm", half * h)
            if not np.isfinite(shift) or abs(shift) + 1.3 * half > extent:
                raise InputError(
                    f"punch of half side {half * h:g} mm, {shift * h:g} mm off the middle, leaves the pad of half "
                    f"side {extent * h:g} mm or comes near its rim; take a smaller offset",
                    "out_of_range",
                    "offset_mm",
                    shift * h,
                )

    @property
    def scale(self) -> float:
        """The smaller of half side and thickness, over the thickness."""
        return min(*self.half_sides, 1.0)

    @property
    def multiplicity(self) -> int:
        """How often the meshed part makes up the whole."""
        return 2 ** sum(shift == 0.0 for shift in self.offset)

    def heights(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Level of the bone and of the tested face, the highest point at 0 and the base at -1."""
        h = self.thickness_mm
        bone = 0.0 * x if self.homogeneous else self.shape.bone_mm(x * h, y * h) / h
        return bone - 1.0, -self.shape.drop_mm(x * h, y * h) / h

    def bend(self, places: Array) -> Array:
        """Put the nodes of a slab between -1 and 0 into the pad."""
        bone, face = self.heights(places[0], places[1])
        return np.stack([places[0], places[1], face + (bone - face) * -places[2]])

    def punch(self, rim: float) -> BeadedPunch:
        """The punch with a fillet at its edge, which is part of its sides or radius."""
        one, other = (half - rim for half in self.half_sides)
        core, corner = ((0.0, 0.0), one) if self.is_round else ((one, other), 0.0)
        return BeadedPunch(core, corner, rim, self.offset)


def _tip(load: Load, axis: int) -> float:
    """Radius of curvature of the tested face at its highest point along one axis, in thicknesses; inf if flat."""
    at = np.zeros((2, 1))
    at[axis] = 1e-3
    fall = float(-load.heights(*at)[1][0])
    return np.inf if fall <= 0.0 else 1e-6 / (2.0 * fall)


def axis_lines(load: Load, grid: GridFineness, axis: int) -> Array:
    """Grid lines along one side of the pad."""
    half, shift, extent = load.half_sides[axis], load.offset[axis], load.half_extents[axis]
    rim = grid.rim * load.scale
    coarse = half / grid.cells
    places, sizes = [shift + half - rim, shift - half + rim], [min(coarse, rim)] * 2
    tip = _tip(load, axis)
    if np.isfinite(tip):
        places.append(0.0)
        # A first contact of radius sqrt(R d) is to span some cells.
        sizes.append(min(coarse, APEX_CELLS / grid.cells * np.sqrt(tip * load.first)))
    wanted = Sizes(places, sizes, grid.slope, coarse, half, shift)
    return lines_by_size(0.0 if shift == 0.0 else -extent, extent, (places[0], places[1], 0.0), wanted.at, SPARE)


def levels(load: Load, grid: GridFineness) -> Array:
    """Levels of the reference slab from -1 to 0; one lies between the layers."""
    first = min(min(load.half_sides), HEIGHT_CELLS) / grid.cells
    layers = load.shape.layers()
    if layers is None:
        return -space.lines(1.0, first, grid.height_growth)[::-1]
    between = layers[0] / load.thickness_mm
    upper = space.lines(between, min(first, between / 3.0), grid.height_growth)
    lower = between + space.lines(1.0 - between, min(upper[-1] - upper[-2], (1.0 - between) / 3.0), grid.height_growth)
    return -np.concatenate([upper, lower[1:]])[::-1]


# How far beyond the punch the surface may come to touch it, in units of the smaller of punch and thickness.
REACH = 0.8


def shaped_problem(load: Load, grid: GridFineness) -> ContactProblem:
    """The meshed part of the pad under the punch; the force of the whole is ``load.multiplicity`` times its."""
    x, y = (axis_lines(load, grid, axis) for axis in (0, 1))
    z = levels(load, grid)
    part = space.quarter(x, y, z, bend=load.bend)
    layers = load.shape.layers()
    if layers is not None and not load.homogeneous:
        # All terms of the energy scale alike; the pressure is then counted in the moduli of its layer.
        lower = z[part.lattice[0] + 1] <= -layers[0] / load.thickness_mm + 1e-9
        weight = part.mesh.weight * np.where(lower, layers[1], 1.0)[:, None]
        part = replace(part, mesh=replace(part.mesh, weight=weight))
    base = np.unique(space.horizontal_faces(part.mesh, np.nonzero(part.lattice[0] == 0)[0], upper=False))
    if load.base != "bonded" and np.ptp(load.heights(*part.mesh.nodes[:2, base])[0]) > 0.0:
        message = "base = 'sliding' is not built for a pad with a bone; take bonded"
        raise InputError(message, "unsupported", "base", load.base, "bonded")
    strength = SHAPED_PAD_IN_SPACE.contact * load.law.shear_MPa / float(min(load.half_sides) / grid.cells)
    return contact_problem(load, part, base, part.share * strength, grid.rim * load.scale)


def contact_problem(load: Load, part: space.Quarter, base: Array, strength: Array, rim: float) -> ContactProblem:
    """Hold base and planes of symmetry of a meshed pad; its face is in contact, ``strength`` stiff, with the punch."""
    mesh, nodes = part.mesh, part.mesh.nodes
    held = np.zeros((nodes.shape[1], 3), dtype=bool)
    for axis in (0, 1):
        if load.offset[axis] == 0.0:
            held[nodes[axis] < 1e-9, axis] = True
    held[base] |= np.array([load.base == "bonded"] * 2 + [True])
    middle = np.abs(nodes[:2, part.faces[:, 4]] - np.array(load.offset)[:, None])
    near = np.all(middle <= np.array(load.half_sides)[:, None] + REACH * load.scale, axis=0)
    grip = SHAPED_PAD_IN_SPACE.grip_share * strength[near] * (load.condition == "bonded")
    surface = FaceContact(nodes, part.faces[near], strength[near], grip, part.unknowns)
    punch = load.punch(rim)
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    carried = None
    if load.shape.flat_top:
        on_face = np.unique(part.faces[near])
        carried = 3 * on_face[punch.gap(nodes[:, on_face].T, 0.0)[0] < 1e-12] + 2
    solid, nothing = Solid(mesh, load.law, load.poisson), np.array([], dtype=int)
    solver = partial(Dissection, position=part.lattice)
    return ContactProblem(solid, held.ravel(), nothing, 3 * base + 2, surface, punch, carried, solver=solver)


def solve_path(load: Load, depths: Array, grid: GridFineness) -> ForcePath:
    """Follow a pad through depths, to where its face folds on to itself at the most."""
    problem = shaped_problem(load, grid)
    mesh = problem.solid.mesh
    top = np.arange(len(mesh.dofs))[-(len(axis_lines(load, grid, 0)) - 1) * (len(axis_lines(load, grid, 1)) - 1) :]
    mirrored = load.offset[0] == 0.0, load.offset[1] == 0.0
    face = SpatialFace(problem, space.horizontal_faces(mesh, top), mirrored, load.thickness_mm)
    return watched(problem, face, depths, LARGEST_STEP * load.scale)


# What a corrected force is off by that neither the cells nor the correction show: contact gives way, steps are long.
LEAST_ERROR = 0.01


def solve_shaped_block(
    pad: Pad,
    depth_mm: Sequence[float] | Array,
    grid: GridFineness | None = None,
    offset_mm: tuple[float, float] = (0.0, 0.0),
    slab: ForceCurve | None = None,
) -> PadCurve:
    """Static force of a shaped pad under a flat punch with a sharp edge.

    Cells in space are large and stand for a fillet. A flat top is solved beside a homogeneous ``slab`` on the same
    cells: its force is the ratio times the slab's under this punch. Round pads under a centred punch are corrected by
    what cells and fillet do under the circle of the punch's area, in a meridian plane. For all others the error
    has what a sharp edge may carry more.
    """
    h, depths, grid = pad.thickness_mm, relative_depths(depth_mm, pad.thickness_mm), grid or GridFineness()
    load = Load.of(pad, float(depths[0]), offset_mm)
    twin = round_twin(load, depths)
    wanted = depths if twin is None else twin.depths
    paths, forces = [], []
    for fineness in (grid.coarser(), grid):
        pair = [solve_path(load, wanted, fineness)]
        if slab is not None:
            pair.append(solve_path(replace(load, homogeneous=True), wanted, fineness))
        if not all(len(path.depth) for path in pair):
            raise unsolved(next(path.stop for path in pair if not len(path.depth)))
        paths += pair
        count = min(len(path.force) for path in pair)
        force = pair[0].force[:count] * load.multiplicity * pad.shear_MPa * h**2
        if slab is not None:
            force = slab.force(wanted[:count] * h) * pair[0].force[:count] / pair[1].force[:count]
        correction = np.zeros(count) if twin is None else correction_of(load, fineness, twin)[:count]
        forces.append((force * np.exp(correction), correction))
    (coarse, _), (fine, correction) = forces
    # Where the coarse grid did not get to, the error is the largest change that was seen.
    both = min(len(coarse), len(fine))
    change = np.abs(coarse[:both] / fine[:both] - 1.0)
    share = np.concatenate([change, np.full(len(fine) - both, change.max())]) + EDGE_ERROR * np.abs(correction)
    reached = wanted[: len(fine)]
    if slab is not None:
        share += slab.relative_error(reached * h)
    elif not load.shape.plain:
        share += LEAST_ERROR + (_edge_left(load, reached) if twin is None else 0.0)
    stop = next((path.stop for path in paths[::-1] if path.stop), None) or (None if twin is None else twin.stop)
    notes = end_note(reached[-1], depths[-1], stop) if stop and len(reached) < len(depths) else ()
    return PadCurve(reached * h, fine, fine * share, cost(paths), notes)


def round_twin(load: Load, depths: Array) -> RoundTwin | None:
    """The pad under the circle of the punch's area; None of a flat top, and of what is not round or not centred."""
    radius, extent = load.half_sides[0] if load.is_round else load.radius, load.extent
    centred = load.offset == (0.0, 0.0) and extent >= 1.5 * radius
    if load.shape.flat_top or not load.shape.axisymmetric or not centred:
        return None
    face = load.base, load.condition, load.law, load.poisson
    return RoundTwin.solve(Case(radius, extent, *face, shape=load.shape, thickness_mm=load.thickness_mm), depths)


# What a sharp edge carries more than the fillet of the solves, by d / h: 9 % at 0.13, 14 % at 0.2, 10 % at 0.37 and 2 %
# at 0.58 on 9.3 mm (half the fillet, extrapolated), 12 to 17 % at the first touch of slabs. Not in the force.
EDGE_LEFT = (0.25, 0.6), (0.15, 0.03)


def _edge_left(load: Load, depths: Array) -> Array:
    """What the fillet may take from a force that is not corrected, over it, from where the edge is near the face."""
    turn = np.linspace(0.0, 2.0 * np.pi, 65)
    plan = np.stack([np.cos(turn), np.sin(turn)])
    if not load.is_round:
        plan = plan / np.abs(plan).max(axis=0)
    x, y = plan * np.array(load.half_sides)[:, None] + np.array(load.offset)[:, None]
    fall = -load.heights(x, y)[1].max()
    near, _ = fade(depths, 0.5 * fall, fall + 1e-9)
    return near * np.interp(depths, *EDGE_LEFT)


def correction_of(load: Load, grid: GridFineness, twin: RoundTwin, step: float = LARGEST_STEP) -> Array:
    """ln of what cells, fillet and load steps in space take from the force.

    All act along the punch's edge, which a square has more of than the circle of its area.
    """
    radius, extent = twin.case.radius, twin.case.extent
    plane = replace(load, half_sides=(radius, radius), half_extents=(extent, extent), is_round=True)
    lines = axis_lines(plane, grid, 0), -levels(plane, grid)[::-1]
    edge = 1.0 if load.is_round else 2.0 * sum(load.half_sides) / (np.pi * radius) * load.scale / plane.scale
    return edge * twin.change_on(lines, grid.cells, grid.rim * plane.scale / twin.case.scale, step)
