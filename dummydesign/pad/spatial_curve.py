"""Factor of one rectangular punch over its round twin, solved in space and taken to the limit of small cells."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.errors import NoAnswerError
from dummydesign.pad.laws import Law
from dummydesign.pad.spatial import Block, Cells, Ratios, depth_of_corner, solve_ratios
from dummydesign.pad.square import HELD_ERROR

Array = np.ndarray

CORNERS = (0.45, 0.3, 0.2)
STEP = 0.06
MESH_ERROR = 5e-4
# Share of its own correction by which an extrapolated factor may be off.
CORRECTION_ERROR = 0.5


@dataclass(frozen=True)
class FactorCurve:
    """ln factor as a parabola in depth; ``correction`` is what one unit of corner cell changes it by.

    Depths over thickness. Beyond ``reach`` the factor is held and its error grows by ``HELD_ERROR`` per reach.
    """

    coefficients: Array
    correction: Array
    reach: float
    reach_of_corner: dict[float, float]
    scatter: float
    solver: dict[str, Any]

    def factor(self, depth: Array) -> tuple[Array, Array]:
        """Factor and relative error at relative depths."""
        depth = np.maximum(np.asarray(depth, dtype=float), 0.0)
        inside = np.minimum(depth, self.reach)
        value = np.exp(np.polynomial.polynomial.polyval(inside, self.coefficients))
        finest = np.full(inside.shape, max(self.reach_of_corner))
        for corner in sorted(self.reach_of_corner, reverse=True):
            finest = np.where(inside <= self.reach_of_corner[corner] * (1.0 + 1e-9), corner, finest)
        change = np.abs(finest * np.polynomial.polynomial.polyval(inside, self.correction))
        error = MESH_ERROR + 2.0 * self.scatter + CORRECTION_ERROR * change
        return value, error + HELD_ERROR * (depth - inside) / self.reach


def solve_factor(
    block: Block,
    law: Law,
    poisson: float,
    deepest: float,
    progress: Callable[[float], None] | None = None,
) -> FactorCurve:
    """Solve a rectangular punch and its twin with three corner cells, and fit what is left at cell size 0.

    Parameters
    ----------
    deepest : float
        Largest depth of interest over the thickness.

    Raises
    ------
    NoAnswerError
        When no corner cell allows even the first depths.
    """
    runs: dict[float, Ratios] = {}
    step = min(STEP * block.scale, deepest / 4.0)
    for corner in CORNERS:
        cells = Cells(corner)
        depths = np.arange(1, int(min(deepest * 1.001, depth_of_corner(block, cells)) / step) + 1) * step
        runs[corner] = solve_ratios(block, law, poisson, depths, cells, progress)
    reach = {corner: float(run.depth[-1]) if len(run.depth) else 0.0 for corner, run in runs.items()}
    if max(reach.values()) == 0.0:
        raise NoAnswerError("no_convergence", f"the punch's corner folds before d/h = {step:.3g}; no 3D factor")
    depth = np.concatenate([np.concatenate([[0.0], run.depth]) for run in runs.values()])
    value = np.log(np.concatenate([np.concatenate([[run.first], run.ratio]) for run in runs.values()]))
    corner = np.concatenate([np.full(len(run.depth) + 1, c) for c, run in runs.items()])
    longest = max(reach.values())
    share = depth / longest
    columns = np.stack([share**0, share, share**2, corner, corner * share], axis=1)
    # Only the corner's part is held back: two or three cells do not settle it.
    damping = np.diag([0.0, 0.0, 0.0, 0.02, 0.02]) / MESH_ERROR
    weight = 1.0 / (MESH_ERROR + 2e-3 * corner)
    system = np.concatenate([columns * weight[:, None], damping])
    solution, *_ = np.linalg.lstsq(system, np.concatenate([value * weight, np.zeros(5)]), rcond=None)
    scale = longest ** -np.arange(3.0)
    solver = {name: sum(run.solver[name] for run in runs.values()) for name in next(iter(runs.values())).solver}
    solver["unknowns"] = max(run.solver["unknowns"] for run in runs.values())
    scatter = float(np.sqrt(np.mean((value - columns @ solution) ** 2)))
    return FactorCurve(solution[:3] * scale, solution[3:] * scale[:2], longest, reach, scatter, solver)
