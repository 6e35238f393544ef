"""Whether a pad's face has folded on to itself: contact of the pad with itself is not followed.

The flank of a steep crown and the pad beside its foot close like a book as the crown is pressed. Nothing in the
equations keeps one from passing through the other, so every wanted state is checked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np

from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.solve.continuation import Array, ForcePath
from dummydesign.pad.solve.equilibrium import ContactProblem

# The reason of a path that ends with a notch narrower than this names the notch.
NARROW_DEG = 30.0
# What the reasons of a fold begin with.
FOLDED = ("the crown", "the face")


class Face(Protocol):
    """The tested face of a meshed pad, as it is checked for a fold."""

    notch: ClassVar[str]
    """What is folded when a notch is narrow."""
    meets: ClassVar[str]
    """The reason, with ``last``, ``depth`` and ``place`` to be filled in."""

    def meeting(self, depth: float, u: Array) -> str | None:
        """Where on the pad at rest the face crosses itself, in words; None when it does not."""

    def opening_deg(self, u: Array) -> float:
        """Angle of the narrowest notch, 180 of a flat face."""


@dataclass
class FoldWatch:
    """Checks the states of a pad, one after the other, for a face that has met itself."""

    face: Face
    folded: str | None = None
    last: float = 0.0
    opening: float = 180.0

    def check(self, depth: float, u: Array) -> str | None:
        """Why a path ends before a state: its face has met itself; None where it has not."""
        if self.folded is None:
            radius = self.face.meeting(depth, u)
            if radius is None:
                self.last, self.opening = depth, self.face.opening_deg(u)
            else:
                self.folded = self.face.meets.format(last=self.last, depth=depth, place=radius)
        return self.folded

    def stop_reason(self, stop: str | None) -> str | None:
        """Why a path ended, with the notch where it is nearly shut."""
        if stop is None or self.folded is not None or self.opening > NARROW_DEG:
            return stop
        return f"{self.face.notch} is folded to {self.opening:.0f} degrees, and {stop}"

    def with_stop_reason(self, path: ForcePath, last: Array | None = None) -> ForcePath:
        """The path with the reason of its end; ``last`` is where it came to, beyond the last wanted depth."""
        if last is not None and self.folded is None:
            self.opening = min(self.opening, self.face.opening_deg(last))
        return replace(path, stop=self.stop_reason(path.stop))


def crossing(line: Array) -> int | None:
    """The first segment of a line that another one, not its neighbour, crosses; None when none does."""
    start, way = line[:-1], np.diff(line, axis=0)
    between = start[None] - start[:, None]
    across = _cross(way[:, None], way[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = _cross(between, way[None]) / across, _cross(between, way[:, None]) / across
    meet = (one >= 0.0) & (one <= 1.0) & (other >= 0.0) & (other <= 1.0)
    first = np.nonzero(np.triu(meet, 2))[0]
    return int(first.min()) if len(first) else None


def opening_deg(line: Array) -> float:
    """Angle of the narrowest notch in lines that run outwards, above them: 180 where straight, 0 where shut."""
    way = np.diff(line, axis=-2)
    angle = np.unwrap(np.arctan2(way[..., 1], way[..., 0]), axis=-1)
    rise = angle - np.minimum.accumulate(angle, axis=-1)
    return float(180.0 - np.degrees(rise.max()))


class RoundFace:
    """The face of a round pad, a line from the axis outwards."""

    notch: ClassVar[str] = "the crown's foot"
    meets: ClassVar[str] = (
        "the crown folds on to the pad beside its foot: between relative depths {last:.3f} and {depth:.3f} the face "
        "meets itself {place} mm from the axis, and contact of the pad with itself is not followed; a crown with a "
        "flatter flank stays open"
    )

    def __init__(self, problem: ContactProblem, thickness_mm: float) -> None:
        mesh = problem.solid.mesh
        node = meshes.cell_nodes(mesh)
        # The face is the upper side of the first row of cells, which no other cell has.
        uses = np.bincount(node[:, [4, 6]].ravel(), minlength=mesh.nodes.shape[1])
        top = np.unique(node[uses[node[:, 6]] == 1][:, [2, 6, 3]])
        self._nodes = top[np.argsort(mesh.nodes[0, top])]
        self.rest = mesh.nodes[:, self._nodes].T
        self._thickness_mm = thickness_mm

    def _line(self, u: Array) -> Array:
        return self.rest + u.reshape(-1, 2)[self._nodes]

    def meeting(self, depth: float, u: Array) -> str | None:
        """Distance from the axis of the first segment that another crosses, in words. [mm]"""
        node = crossing(self._line(u))
        return None if node is None else f"{float(self.rest[node, 0]) * self._thickness_mm:.3g}"

    def opening_deg(self, u: Array) -> float:
        """Angle of the narrowest notch in the line."""
        return opening_deg(self._line(u))


def _cross(one: Array, other: Array) -> Array:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
