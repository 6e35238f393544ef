"""Whether the face of a pad solved in space has folded on to itself, as ``fold`` has it of round pads.

The face is a lattice of triangles through its nodes. It has met itself when an edge of one triangle pierces another,
or when it has passed a plane of symmetry, where its mirror image stands. A face that starts without crossing itself
cannot come to lie inside the gel, or inside another part of itself, without that. One of both must be free of the
punch: a cell that is crumpled where it touches the punch's corner is a matter of the sharp edge.

Most states are settled by less: seen from above a face that is nowhere turned over covers each place once and cannot
cross itself. Where it is (a crown that bulges over its foot), every place that is covered more than once is covered by
a triangle that is turned over too, so only those that stand over or under such ones are compared.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

import numpy as np

from dummydesign.pad.axisymmetric.self_contact import FoldWatch, opening_deg
from dummydesign.pad.contact.spatial import BeadedPunch
from dummydesign.pad.solve.continuation import Path, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution

Array = np.ndarray

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
    apart = ~(edges[edge][:, :, None] == faces[face][:, None, :]).any(axis=(1, 2))
    edge, face = edge[apart], face[apart]
    start, way = ends[edge, 0], ends[edge, 1] - ends[edge, 0]
    corner = points[faces[face]]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    before = np.einsum("ni,ni->n", start - corner[:, 0], normal)
    behind = np.einsum("ni,ni->n", start + way - corner[:, 0], normal)
    arm = corner - start[:, None]
    side = np.einsum("nki,ni->nk", np.cross(arm, np.roll(arm, -1, axis=1)), way)
    through = (before * behind < 0.0) & (np.all(side >= 0.0, axis=1) | np.all(side <= 0.0, axis=1))
    return edges[edge[through]], faces[face[through]]


def _overlap(low: Array, high: Array, other_low: Array, other_high: Array) -> Array:
    """Which boxes (n, axes) overlap which others (m, axes)."""
    found = np.ones((len(low), len(other_low)), dtype=bool)
    for axis in range(low.shape[1]):
        found &= low[:, None, axis] <= other_high[None, :, axis]
        found &= other_low[None, :, axis] <= high[:, None, axis]
    return found


class SpatialFace:
    """The face of a pad solved in space."""

    notch: ClassVar[str] = "the face"
    meets: ClassVar[str] = (
        "the face folds on to itself: between relative depths {last:.3f} and {depth:.3f} it meets itself at {place} mm "
        "from the highest point, and contact of the pad with itself is not followed; flatter flanks stay open"
    )

    def __init__(
        self, problem: Problem, faces: Array, mirrored: tuple[bool, bool], thickness_mm: float,
        unknowns: Array | None = None,
    ) -> None:  # fmt: skip
        used = np.unique(faces)
        place = problem.solid.mesh.nodes[:, used].T
        (x, i), (y, j) = (np.unique(place[:, axis].round(9), return_inverse=True) for axis in (0, 1))
        nodes = np.full((len(x), len(y)), -1)
        nodes[i, j] = used
        # The half beyond the diagonal of a folded mesh is the mirror image of the one before it.
        self._swapped = np.nonzero(nodes.ravel() < 0)[0]
        self._nodes = np.where(nodes < 0, nodes.T, nodes) if len(self._swapped) else nodes
        self._triangles = lattice_triangles(*nodes.shape)
        self._unknowns = unknowns
        self.rest = self._mirror(problem.solid.mesh.nodes.T[self._nodes.ravel()])
        assert isinstance(problem.punch, BeadedPunch)
        self._punch = problem.punch
        self._mirrored, self._thickness_mm = mirrored, thickness_mm

    def _mirror(self, points: Array) -> Array:
        points[self._swapped] = points[self._swapped][:, [1, 0, 2]]
        return points

    def _points(self, u: Array) -> Array:
        own = u if self._unknowns is None else u[self._unknowns]
        return self.rest + self._mirror(own.reshape(-1, 3)[self._nodes.ravel()])

    def meeting(self, depth: float, u: Array) -> str | None:
        """Where the free face crosses itself or its mirror image, nearest to the highest point, in words. [mm]"""
        points = self._points(u)
        if not turned_over(points, self._triangles).any():
            return None
        free = self._punch.gap(points, depth)[0] > NEAR * self._punch.rim
        edges, faces = pierced(points, self._triangles)
        edges = edges[free[edges].all(axis=1) | free[faces].all(axis=1)]
        found = [self.rest[edges, :2].mean(axis=1)]
        for axis in np.flatnonzero(np.array(self._mirrored)):
            found.append(self.rest[free & (points[:, axis] < -BEYOND), :2])
        places = np.concatenate(found)
        if not len(places):
            return None
        x, y = places[np.argmin(np.hypot(places[:, 0], places[:, 1]))] * self._thickness_mm
        return f"({x:.3g}, {y:.3g})"

    def opening_deg(self, u: Array) -> float:
        """Angle of the narrowest notch along the lines of the lattice."""
        points = self._points(u).reshape(*self._nodes.shape, 3)
        return min(opening_deg(points[..., [0, 2]].swapaxes(0, 1)), opening_deg(points[..., [1, 2]]))


def watched(
    problem: Problem, face: SpatialFace, depths: Array, largest_step: float,
    progress: Callable[[float], None] | None = None,
) -> Path:  # fmt: skip
    """Follow a problem through depths, to where its face folds on to itself at the most."""
    watch, first = FoldWatch(face), 0.25 * float(depths[0])

    def check(depth: float, solution: Solution) -> str | None:
        return watch.check(depth, solution.u)

    return watch.with_stop_reason(follow(problem, depths, first, largest_step, first / 64.0, progress, visit=check))
