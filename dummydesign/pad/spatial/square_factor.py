"""Factor of one rectangular punch over its round twin, solved in space and taken to the limit of small cells.

Sharp edges with three corner cells carry it to where the corner cell folds; edges with a fillet of two radii carry
it on. Both are fitted together: one parabola or cubic in depth, and what one unit of corner cell or fillet changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.process import one_blas_thread
from dummydesign.pad.solve.continuation import add_costs
from dummydesign.pad.spatial.square_punch import (
    Block,
    Cells,
    Ratios,
    block_problem,
    depth_of_corner,
    solve_ratios,
    useful_depths,
)
from dummydesign.pad.tables.square import HELD_ERROR

Array = np.ndarray
polyval = np.polynomial.polynomial.polyval

CORNERS = (0.45, 0.3, 0.2)
STEP = 0.06
# Fillets, as large as the cells beside them.
RIMS = (0.28, 0.2)
# Scatter that is expected of a value besides its correction, for its weight: sharp and filleted edge.
MESH_ERROR = 5e-4
RIMMED_ERROR = 2e-3
# Share of its own correction by which an extrapolated factor may be off.
CORRECTION_ERROR = 0.5


@dataclass(frozen=True)
class FactorCurve:
    """ln factor as a polynomial in depth; corrections are what one unit of corner cell or fillet changes it by.

    Depths over thickness. ``reach_of_corner`` and ``reach_of_rim`` say how deep each size was solved, ``scatter``
    and ``rim_scatter`` by how much single values lie off. Beyond ``reach`` the factor is held and its error grows
    by ``HELD_ERROR`` per reach.
    """

    coefficients: Array
    correction: Array
    rim_correction: Array
    reach: float
    reach_of_corner: dict[float, float]
    reach_of_rim: dict[float, float]
    scatter: float
    rim_scatter: float
    solver: dict[str, Any]

    def factor(self, depth: Array) -> tuple[Array, Array]:
        """Factor and relative error at relative depths."""
        depth = np.maximum(np.asarray(depth, dtype=float), 0.0)
        inside = np.minimum(depth, self.reach)
        by_rim = 2.0 * self.rim_scatter + _off(inside, self.reach_of_rim, self.rim_correction)
        by_corner = 2.0 * self.scatter + _off(inside, self.reach_of_corner, self.correction)
        sharp = inside <= max(self.reach_of_corner.values(), default=0.0) * (1.0 + 1e-9)
        error = MESH_ERROR + np.where(sharp, by_corner, by_rim)
        return np.exp(polyval(inside, self.coefficients)), error + HELD_ERROR * (depth - inside) / self.reach


def _off(depth: Array, reach: dict[float, float], correction: Array) -> Array:
    """Share of its correction by which the finest size that reaches a depth may be off."""
    finest = np.full(depth.shape, max(reach, default=0.0))
    for size in sorted(reach, reverse=True):
        finest = np.where(depth <= reach[size] * (1.0 + 1e-9), size, finest)
    return CORRECTION_ERROR * np.abs(finest * polyval(depth, correction))


@one_blas_thread()
def solve_factor(block: Block, deepest: float, progress: Callable[[float], None] | None = None) -> FactorCurve:
    """Solve a rectangular punch and its twin with several corner cells and fillets, and fit the limit at size 0."""
    outline = 1.0
    if not block.mirrors and block.middle_extents != block.half_extents:
        # Half of a quarter is enough on a square slab; what the true outline changes is that of first touch.
        square = replace(block, half_extents=block.middle_extents)
        outline, block = outline_factor(block, square), square
    step = min(STEP * block.scale, deepest / 4.0)
    sharp: dict[float, Ratios] = {}
    for corner in CORNERS:
        cells = Cells(corner)
        end = min(deepest, depth_of_corner(block, cells))
        count = max(1, round(end / step))
        depths: Array = end * np.arange(1, count + 1) / count
        sharp[corner] = solve_ratios(block, depths, cells, progress=progress)
    beaded: dict[float, Ratios] = {}
    if max(_reach(sharp).values()) < deepest * 0.999:
        # Values of fillets scatter: some more than the curve's own depths.
        depths = deepest * np.arange(1, 13) / 12.0
        for rim in RIMS:
            beaded[rim] = solve_ratios(block, useful_depths(block, depths, rim), Cells(rim), rim, progress)
    found = _fitted(sharp, beaded, step)
    return replace(found, coefficients=found.coefficients + np.log(outline) * np.eye(1, len(found.coefficients))[0])


def outline_factor(block: Block, square: Block) -> float:
    """Force at first touch on a rectangular slab over that on the square one of its area, on the same cells."""
    cells = Cells(CORNERS[0])
    quarter, eighth = block_problem(block, cells), block_problem(square, cells, folded=True)
    return quarter.stiffness() / (2.0 * eighth.stiffness())


def _reach(runs: dict[float, Ratios]) -> dict[float, float]:
    return {size: float(run.depth[-1]) if len(run.depth) else 0.0 for size, run in runs.items()}


def _fitted(sharp: dict[float, Ratios], beaded: dict[float, Ratios], step: float) -> FactorCurve:
    reach, rim_reach = _reach(sharp), _reach(beaded)
    longest = max(*reach.values(), *rim_reach.values())
    if longest == 0.0:
        message = f"the punch's corner folds before d/h = {step:.3g}; no 3D factor"
        raise NoAnswerError("no_convergence", message, quantity="force_N")
    rows = [(d, f, c, 0.0) for c, run in sharp.items() for d, f in zip([0.0, *run.depth], [run.first, *run.ratio])]
    rows += [(d, f, 0.0, r) for r, run in beaded.items() for d, f in zip(run.depth, run.ratio)]
    depth, factor, corner, rim = np.array(rows).T
    value, share, is_sharp = np.log(factor), depth / longest, rim == 0.0
    terms = 4 if beaded else 3
    series = share[:, None] ** np.arange(terms)
    columns = np.concatenate([series, np.stack([corner, corner * share, rim, rim * share], axis=1)], axis=1)
    # Only the corrections are held back: two or three sizes do not settle them.
    damping = np.diag([0.0] * terms + [0.02] * 4) / MESH_ERROR
    weight = 1.0 / np.where(is_sharp, MESH_ERROR + 2e-3 * corner, RIMMED_ERROR + 5e-3 * rim)
    system = np.concatenate([columns * weight[:, None], damping])
    load = np.concatenate([value * weight, np.zeros(terms + 4)])
    solution, *_ = np.linalg.lstsq(system, load, rcond=None)
    misfit = value - columns @ solution
    runs = [*sharp.values(), *beaded.values()]
    solver = add_costs(*(run.solver for run in runs))
    own, corrections = solution[:terms], solution[terms:].reshape(2, 2)
    by_corner, by_rim = corrections / np.array([1.0, longest])
    scatter, rim_scatter = (
        float(np.sqrt(np.mean(part**2))) if len(part) else 0.0 for part in (misfit[is_sharp], misfit[~is_sharp])
    )
    own = own * longest ** -np.arange(float(terms))
    return FactorCurve(own, by_corner, by_rim, longest, reach, rim_reach, scatter, rim_scatter, solver)
