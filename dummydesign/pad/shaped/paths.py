"""Paths of a shaped pad under a round punch: load steps on a grid, and which grids make an answer."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dummydesign.pad.contact.resting_base import Both
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.shaped.fold import FoldWatch, RoundFace
from dummydesign.pad.shaped.problem import CELLS, RIMS, Press, shaped_problem
from dummydesign.pad.solve.continuation import Passed, Path, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution

Array = np.ndarray

# Load steps in thicknesses, at 16 cells, while a contact grows that sticks: a quarter of them moves a force by at most
# 0.2 %. Wanted depths are solved beside the path, which is the same whatever they are. Other contact takes larger ones.
LARGEST_STEP = 0.01
# The same under a flat top, where only what is drawn to the fillet comes to touch: half of it moves the ratio to the
# slab by at most 0.25 %, twice as much by 1 %.
FLAT_STEP = 0.015
FREE_STEP = 0.03
FIRST_DEPTH = 0.02


# Ends of the steps of the paths followed last that do not fold, for whoever wants fields on the way; so many paths, the
# oldest first.
_PASSED: dict[tuple[Press, Law, int, float], list[Passed]] = {}
MOST_PASSED = 8


def passed_by(press: Press, law: Law, cells: int, rim: float, deepest: float) -> list[Passed]:
    """Ends of the steps of a path of this pad that was followed beyond a depth in this process; empty without one.

    Parameters
    ----------
    press, law, cells, rim
        As for :func:`climb`.
    deepest : float
        In thicknesses.
    """
    known = _PASSED.get((press, law, cells, rim), [])
    return known if known and known[-1].depth >= deepest * (1.0 - 1e-9) else []


def climb(press: Press, law: Law, depths: Array, cells: int = CELLS, rim: float = RIMS[-1], twin: bool = False,
          progress: Callable[[float], None] | None = None,
          visit: Callable[[Problem, float, Solution], None] | None = None) -> Path:  # fmt: skip
    """Follow the pad under a punch with one edge fillet.

    Parameters
    ----------
    press : Press
        Pad, punch and support in thicknesses.
    law : Law
        Of the upper resin; its moduli set the unit of stress.
    depths : ndarray, shape (n,)
        Increasing depths in thicknesses.
    cells : int
        Cells between the axis and the punch's edge, at least.
    rim : float
        Fillet radius over the smaller of punch radius and thickness.
    twin : bool
        Whether the homogeneous reference slab is solved on the same grid instead.
    progress : callable, optional
        Called with each solved depth.
    visit : callable, optional
        Called with the problem, each wanted depth and its equilibrium.

    Returns
    -------
    Path
        Of a pad whose face folds on to itself up to there; ``stop`` says so.
    """
    problem = shaped_problem(press, law, cells, rim, twin)
    watch = None if twin or press.shape.flat_top else FoldWatch(RoundFace(problem, press.thickness_mm))

    def seen(depth: float, solution: Solution) -> str | None:
        if watch is not None and (folded := watch.look(depth, solution.u)):
            return folded
        if visit is not None:
            visit(problem, depth, solution)
        return None

    passed: list[Passed] = []
    path = _follow(press, problem, depths, cells, rim, progress, seen, passed)
    if watch is None:
        return path
    if watch.folded is None:
        if len(_PASSED) >= MOST_PASSED:
            _PASSED.pop(next(iter(_PASSED)))
        # Up to the last state that was looked at for a fold.
        last = path.depth[-1] if len(path.depth) else 0.0
        _PASSED[press, law, cells, rim] = [end for end in passed if end.depth <= last * (1.0 + 1e-9)]
    return watch.told(path)


def _follow(
    press: Press, problem: Problem, depths: Array, cells: int, rim: float, progress: Callable[[float], None] | None,
    seen: Callable[[float, Solution], str | None], passed: list[Passed],
) -> Path:  # fmt: skip
    if press.condition == "frictionless":
        # Contact without memory: the force is the same whatever the steps were.
        return follow(problem, depths, 0.25 * press.first, FREE_STEP, 3e-4, progress, visit=seen)
    if press.shape.flat_top:
        return follow(problem, depths, 0.3 * rim, FLAT_STEP, 3e-4, progress, lattice=True, visit=seen)
    step = LARGEST_STEP * CELLS / cells
    return follow(
        problem, depths, 0.25 * press.first, step, 3e-4, progress, lattice=True, visit=seen, keep=passed.append
    )


class Solved:
    """Paths of one pad and its depths that were followed already, by grid.

    ``touched`` has, of a pad that is touched gradually, every depth, the radius of its contact, and whether that
    is the punch's edge, from the finest grid. [thicknesses]
    """

    def __init__(self) -> None:
        self._paths: dict[tuple[int, float, bool], Path] = {}
        self.touched: list[tuple[float, float, bool]] = []

    def path(self, press: Press, law: Law, depths: Array, grid: tuple[int, float], twin: bool,
             progress: Callable[[float], None] | None = None) -> Path:  # fmt: skip
        """The path on one grid, followed now if it was not yet.

        Parameters
        ----------
        press : Press
        law : Law
        depths : ndarray, shape (n,)
            Increasing depths in thicknesses.
        grid : (int, float)
            Cells, and fillet over the smaller of punch radius and thickness.
        twin : bool
            Whether the homogeneous slab is meant.
        progress : callable, optional
            Called with each solved depth.
        """
        key = (*grid, twin)
        if key not in self._paths:
            seen = self._touch if grid == grids(CELLS, press)[-2] and not press.shape.flat_top else None
            self._paths[key] = climb(press, law, depths, *grid, twin=twin, progress=progress, visit=seen)
        return self._paths[key]

    def _touch(self, problem: Problem, depth: float, solution: Solution) -> None:
        radius = radius_touched(problem, depth, solution)
        self.touched.append((depth, radius, radius >= problem.punch.flat_radius))


def radius_touched(problem: Problem, depth: float, solution: Solution) -> float:
    """Radius of the contact at an equilibrium.

    Parameters
    ----------
    problem : Problem
    depth : float
        Of the punch, in the mesh's unit of length.
    solution : Solution

    Returns
    -------
    float
        Largest deformed radius of the glued nodes and of the face's integration points that touch, in the mesh's unit
        of length. No point of a flat punch lies outside its radius, upright side included.
    """
    surface: Any = problem.surface
    points = surface.face._points(solution.u) if isinstance(surface, Both) else surface._points(solution.u)
    assert problem.punch is not None
    touching = problem.punch.gap(points, depth)[0] <= 0.0
    glued = np.unique(problem.driven // 2)
    moved = problem.solid.mesh.nodes[0, glued] + solution.u.reshape(-1, 2)[glued, 0]
    return float(max(np.max(points[..., 0], where=touching, initial=0.0), np.max(moved, initial=0.0)))


def first_depth(depths: Array) -> float:
    """Depth that the apex is meshed for: 0.02, halved until no wanted depth is smaller."""
    return FIRST_DEPTH * 0.5 ** max(0, int(np.ceil(np.log2(FIRST_DEPTH / float(depths[0])) - 1e-9)))


def grids(cells: int, press: Press) -> list[tuple[int, float]]:
    """Cells and fillet of the solves: large fillet, small fillet, small fillet on cells of twice the size.

    A real fillet is solved as it is, without the first.
    """
    if press.edge:
        rim = press.edge / press.scale
        return [(cells, rim), (max(4, cells // 2), rim)]
    return [(cells, RIMS[0]), (cells, RIMS[1]), (max(4, cells // 2), RIMS[1])]
