"""Slabs pressed in one's own way: fillet, resting base, shaped punch or small pad, over the table of the glued slab.

What the table does not hold is solved by finite elements at a few thicknesses, and its ratio to the table is
interpolated in ln thickness and ln of depth over thickness, in which it is smooth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.standard import EXTENT_OVER_RADIUS, MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.force_law import BaseForceLaw, ForceLaw
from dummydesign.pad.pad import Pad

NODES = 5
SHARES = MAX_DEPTH_OVER_THICKNESS * np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0])
RIM_CHANGE, RIM_DECAY, RIM_COUNTS = 0.5, 1.5, 0.002
"""What a rim takes of the force falls as 0.5 exp(-1.5 way / thickness), way from the punch to it: solved for slabs of
half to four radii, within a factor of two; a change of 0.2 % is solved."""
COARSE_CELLS, COARSE_RINGS = 2, 1
"""Mesh on which pads of two sizes are compared. Its few cells at the sharp edge are the same in both, so what they are
off by falls out of the ratio: it is smooth in depth and within 0.2 % of what three times as many cells give. Ratios
under a small fillet scatter by 0.5 %, as one more or one less of its points is held."""
SCATTER = 0.002


@dataclass(frozen=True)
class Solved:
    """ln of solved over tabulated force at shares of one thickness, and the solve's relative error there, (n,)."""

    thickness_mm: float
    share: NDArray
    log_factor: NDArray
    error: NDArray


@dataclass(frozen=True)
class OwnSlabLaw(BaseForceLaw):
    """A table times what was solved over it.

    Attributes
    ----------
    table : ForceLaw
    solved : tuple of Solved
        By rising thickness.
    doubt : float
        Relative error of interpolating between them.
    steep : bool
        Whether the ratio goes on as a power of depth below the first share, as under a punch without a flat face.
    """

    table: ForceLaw
    solved: tuple[Solved, ...]
    doubt: float
    steep: bool = False

    @property
    def ratio_range(self) -> tuple[float, float]:  # type: ignore[override]
        """The table's."""
        return self.table.ratio_range

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        return np.exp(self._over(depth, thickness, "log_factor")) * self.table.force(
            depth, thickness, young_MPa, radius_mm
        )

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth that the table holds and the solves reached. [mm]"""
        thickness = np.asarray(thickness_mm, float)
        nodes = np.log([one.thickness_mm for one in self.solved])
        reached = np.interp(np.log(thickness), nodes, [one.share[-1] for one in self.solved]) * thickness
        return np.minimum(self.table.depth_limit_mm(thickness, radius_mm), reached)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Error of the solves and of what lies between; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        return self._over(depth, thickness, "error") + self.doubt

    def _over(self, depth: NDArray, thickness: NDArray, name: str) -> NDArray:
        """A solved quantity between shares and thicknesses."""
        share = np.log(np.maximum(depth / thickness, 1e-9))
        rows = [_along(one, share, name, self.steep) for one in self.solved]
        if len(rows) == 1:
            return rows[0]
        nodes = np.log([one.thickness_mm for one in self.solved])
        place = np.interp(np.log(thickness), nodes, np.arange(len(nodes)))
        left = np.minimum(place.astype(int), len(nodes) - 2)
        stack, part = np.stack(rows), place - left
        low, high = (np.take_along_axis(stack, at[None], 0)[0] for at in (left, left + 1))
        return low + part * (high - low)


def _along(one: Solved, log_share: NDArray, name: str, steep: bool) -> NDArray:
    known, values = np.log(one.share), getattr(one, name)
    found = np.interp(log_share, known, values)
    if steep and name == "log_factor" and len(known) > 1:
        found += (values[1] - values[0]) / (known[1] - known[0]) * np.minimum(log_share - known[0], 0.0)
    return found


def own_slab_law(table: ForceLaw, pad: Pad, thickness_mm: NDArray) -> ForceLaw:
    """The law of slabs that are pressed as a pad is: the table itself where nothing differs.

    Parameters
    ----------
    table : ForceLaw
        Of glued round punches, of the base where it has one.
    pad : Pad
        Punch, edge, base and size; its thickness and modulus do not matter.
    thickness_mm : ndarray, shape (T,)
        Thicknesses that are searched. [mm]

    Raises
    ------
    NoAnswerError
        ``no_convergence`` where too little could be solved.
    """
    ends = float(np.min(thickness_mm)), float(np.max(thickness_mm))
    if in_table(pad) and not near_rim(pad, ends[1]):
        return table
    count = 1 if ends[0] == ends[1] else NODES
    solved = tuple(solve_over_table(table, pad, float(h)) for h in np.geomspace(*ends, count))
    return OwnSlabLaw(table, solved, _doubt(solved), pad.profile_mm is not None)


def in_table(pad: Pad) -> bool:
    """Whether punch, edge, face and base are those of a table."""
    return pad.profile_mm is None and not pad.edge_radius_mm and pad.base in BASES and pad.condition == "bonded"


def near_rim(pad: Pad, thickness_mm: float) -> bool:
    """Whether a pad's rim is so near to the punch that its force is not that of the table's, larger pads.

    Parameters
    ----------
    pad : Pad
        Its size and the punch.
    thickness_mm : float
    """
    extents = np.array([EXTENT_OVER_RADIUS * pad.radius_mm, pad.extent_mm])
    taken = RIM_CHANGE * np.exp(-RIM_DECAY * (extents - pad.radius_mm) / thickness_mm)
    return bool(abs(taken[1] - taken[0]) > RIM_COUNTS)


def solve_over_table(table: ForceLaw, pad: Pad, thickness_mm: float) -> Solved:
    """Solve one thickness and put it over the table.

    Parameters
    ----------
    table : ForceLaw
    pad : Pad
        Punch, edge, base and size.
    thickness_mm : float
        [mm]

    Raises
    ------
    NoAnswerError
        When fewer than two depths were reached.
    """
    from dataclasses import replace

    limit = float(np.squeeze(table.depth_limit_mm(thickness_mm, pad.radius_mm)))
    share = SHARES[SHARES * thickness_mm <= limit * (1.0 + 1e-9)]
    own = replace(pad, thickness_mm=thickness_mm, young_MPa=1.0, sides_mm=None)
    if in_table(pad):
        inputs = {"radius": pad.radius_mm, "extent": pad.extent_mm, "base": pad.base, "thickness": thickness_mm}
        made = cached("rim", inputs, lambda: _by_rim(own, share))
        found, factor, error = (np.asarray(made[name], float) for name in ("share", "log_factor", "error"))
        error = error + table.relative_error(found * thickness_mm, thickness_mm, pad.radius_mm)
    else:
        from dummydesign.pad.elastic import solve_points

        curve = solve_points(own, share * thickness_mm)
        found = curve.depth_mm / thickness_mm
        factor = np.log(curve.force_N / table.force(curve.depth_mm, thickness_mm, 1.0, pad.radius_mm))
        error = curve.error_N / curve.force_N
    if len(found) < 2:
        raise NoAnswerError("no_convergence", f"a slab of {thickness_mm:.3g} mm under this punch could not be solved")
    return Solved(thickness_mm, found, factor, error)


def _by_rim(pad: Pad, share: NDArray) -> dict[str, Any]:
    """Force of the pad over that of one of the table's size, both under a sharp edge of the same coarse cells."""
    from dummydesign.pad.fem.mesh_axisymmetric import Resolution
    from dummydesign.pad.material.hyperelastic import Yeoh
    from dummydesign.pad.slab.problem import Slab, sharp_problem
    from dummydesign.pad.solve.continuation import follow

    a = pad.radius_mm / pad.thickness_mm
    assert pad.extent_mm is not None
    largest = 0.05 * min(a, 1.0)
    extents = pad.extent_mm / pad.thickness_mm, EXTENT_OVER_RADIUS * a
    problems = [
        sharp_problem(
            Slab(a, extent, pad.base, "bonded"), Yeoh(1.0), 0.5, Resolution(COARSE_CELLS), COARSE_RINGS, False
        )
        for extent in extents
    ]
    paths = [follow(problem, share, 0.2 * largest, largest, 0.1 * largest) for problem in problems]
    count = min(len(path.depth) for path in paths)
    ratio = np.asarray(paths[0].force[:count]) / np.asarray(paths[1].force[:count])
    return {"share": paths[0].depth[:count], "log_factor": np.log(ratio), "error": SCATTER + 0.1 * np.abs(ratio - 1.0)}


def _doubt(solved: tuple[Solved, ...]) -> float:
    """Error of what is interpolated: a quarter of what leaving a node out changes, its distance being twice."""
    changes = [0.0]
    for before, here, after in zip(solved, solved[1:], solved[2:]):
        share = np.log(here.share[here.share <= min(before.share[-1], after.share[-1]) + 1e-9])
        low, high = (_along(one, share, "log_factor", False) for one in (before, after))
        changes.append(float(np.max(np.abs(0.5 * (low + high) - here.log_factor[: len(share)]), initial=0.0)))
    return 0.25 * max(changes)


