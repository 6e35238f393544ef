"""Whether a pad's face has folded on to itself: contact of the pad with itself is not followed.

The flank of a steep crown and the pad beside its foot close like a book as the crown is pressed. Nothing in the
equations keeps one from passing through the other, so every wanted state is looked at.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.solve.continuation import Path
from dummydesign.pad.solve.equilibrium import Problem, Solution

Array = np.ndarray

# A path that ends for another reason with a notch narrower than this is said to end at the fold.
NARROW_DEG = 30.0
# What the reasons of a fold begin with.
FOLDED = "the crown"


def crossing(line: Array) -> int | None:
    """The first segment of a line that another one, not its neighbour, crosses; None when none does.

    Parameters
    ----------
    line : ndarray, shape (n, 2)
        Its points in order.
    """
    start, way = line[:-1], np.diff(line, axis=0)
    between = start[None] - start[:, None]
    across = _cross(way[:, None], way[None])
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = _cross(between, way[None]) / across, _cross(between, way[:, None]) / across
    meet = (one >= 0.0) & (one <= 1.0) & (other >= 0.0) & (other <= 1.0)
    first = np.nonzero(np.triu(meet, 2))[0]
    return int(first.min()) if len(first) else None


def opening_deg(line: Array) -> float:
    """Angle of the narrowest notch in a line that runs outwards, above it: 180 where it is straight, 0 where shut.

    Parameters
    ----------
    line : ndarray, shape (n, 2)
        Radius and height, from the axis.
    """
    way = np.diff(line, axis=0)
    angle = np.unwrap(np.arctan2(way[:, 1], way[:, 0]))
    rise = angle - np.minimum.accumulate(angle)
    return float(180.0 - np.degrees(rise.max()))


@dataclass
class FoldWatch:
    """Looks at the states of a pad at its wanted depths.

    Attributes
    ----------
    problem : Problem
    thickness_mm : float
        What its unit of length is. [mm]
    folded : (float, float) or None
        Depth of the first state whose face crosses itself, in thicknesses, and the rest radius of the place. [mm]
    opening : float
        Of the narrowest notch in the last state before it, in degrees.
    """

    problem: Problem
    thickness_mm: float
    folded: tuple[float, float] | None = None
    opening: float = 180.0
    _face: Array = field(init=False)

    def __post_init__(self) -> None:
        mesh = self.problem.solid.mesh
        node = meshes.cell_nodes(mesh)
        # the face is the upper side of the first row of cells, which begins at the axis
        top = np.unique(node[_first_row(mesh)][:, [2, 6, 3]])
        self._face = top[np.argsort(mesh.nodes[0, top])]

    def sound(self, depth: float, solution: Solution) -> bool:
        """Whether the face has not met itself up to a state.

        Parameters
        ----------
        depth : float
            In thicknesses.
        solution : Solution
        """
        if self.folded is not None:
            return False
        rest = self.problem.solid.mesh.nodes[:, self._face].T
        line = rest + solution.u.reshape(-1, 2)[self._face]
        place = crossing(line)
        if place is None:
            self.opening = opening_deg(line)
            return True
        self.folded = depth, float(rest[place, 0]) * self.thickness_mm
        return False

    def cut(self, path: Path) -> Path:
        """The path up to the fold, with what is said of it.

        Parameters
        ----------
        path : Path
            Whose wanted states were looked at.
        """
        if self.folded is None:
            if path.stop is None or self.opening > NARROW_DEG:
                return path
            return replace(path, stop=f"{FOLDED}'s foot is folded to {self.opening:.0f} degrees, and {path.stop}")
        depth, place = self.folded
        count = int((path.depth < depth * (1.0 - 1e-9)).sum())
        last = float(path.depth[count - 1]) if count else 0.0
        stop = (
            f"{FOLDED} folds on to the pad beside its foot: between relative depths {last:.3f} and {depth:.3f} the "
            f"face meets itself {place:.3g} mm from the axis, and contact of the pad with itself is not followed; a "
            "crown with a flatter flank stays open"
        )
        return replace(
            path, depth=path.depth[:count], force=path.force[:count], smallest_J=path.smallest_J[:count], stop=stop
        )


def _first_row(mesh: meshes.Discretisation) -> Array:
    """Cells under the tested face: those whose upper side belongs to no other cell, the base apart."""
    node = meshes.cell_nodes(mesh)
    count = np.bincount(node[:, 6], minlength=mesh.nodes.shape[1]) + np.bincount(
        node[:, 4], minlength=mesh.nodes.shape[1]
    )
    return count[node[:, 6]] == 1


def _cross(one: Array, other: Array) -> Array:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]
