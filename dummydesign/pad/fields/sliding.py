"""Follow a face that slides or rubs round a filleted punch, and keep its states.

Without friction the mesh moves with the fillet; with friction it stays with the gel.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.geometry.interface import FACES, Interface
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.pad import Pad
from dummydesign.pad.slab.frictionless.filleted_punch import COARSE, FINE, follow_sliding
from dummydesign.pad.slab.frictionless.moving_mesh import SlidingMesh
from dummydesign.pad.slab.problem import Slab
from dummydesign.pad.slab.rubbing.filleted_punch import follow_rubbing, rubbing_problem
from dummydesign.pad.slab.solved_depths import LATTICE, lattice_depths
from dummydesign.pad.solve.continuation import Path
from dummydesign.pad.solve.equilibrium import Problem, Solution

Array = np.ndarray

# Depths of the path that are nearer than this to a wanted one are left out, over their own size.
NEAR = 0.1


@dataclass(frozen=True)
class SlidingPath:
    """How far a face was followed: the depths reached, and why not further (None when it was)."""

    reached: int
    stop: str | None
    notes: tuple[str, ...]


def follow_states(
    pad: Pad, law: Law, depths: Array, coarse: bool, progress: Callable[[float], None] | None,
    keep: Callable[[Problem, Solution, float], None],
) -> SlidingPath:  # fmt: skip
    """Follow a slab that is not glued to a filleted punch and hand over its states at wanted depths.

    Parameters
    ----------
    pad : Pad
        A slab with a face that is not glued and a punch with a fillet.
    law : Law
        With unit shear modulus.
    depths : ndarray, shape (n,)
        Rising, in thicknesses.
    coarse : bool
        On cells of 1.5 times the size alone.
    progress : callable or None
        Called with each solved depth.
    keep : callable
        Called with the problem as it stands, the equilibrium and the depth, in the order of the depths.

    Returns
    -------
    SlidingPath
        Where the fine cells end before the last depth, the coarser ones go on; ``notes`` says from where.
    """
    h = pad.thickness_mm
    slab = Slab(pad.radius_mm / h, (pad.extent_mm or PAD_EXTENT_MM) / h, pad.base)
    friction = Interface.parse(pad.condition, "condition", FACES).friction
    found = 0
    notes: tuple[str, ...] = ()
    stop: str | None = None
    for cells in (COARSE,) if coarse else (FINE, COARSE):
        wanted, path = depths[found:], _with_lattice(depths)
        problem, follow = _way(slab, law, pad.poisson, pad.edge_radius_mm / h, friction, cells)

        def visit(depth: float, solution: Solution, problem: Problem = problem, wanted: Array = wanted) -> None:
            if np.isclose(wanted, depth, rtol=1e-9, atol=0.0).any():
                keep(problem, solution, depth)

        made = follow(path, progress, visit)
        before, found = found, int((depths <= (made.depth[-1] if len(made.depth) else 0.0) * (1.0 + 1e-9)).sum())
        if cells == COARSE and not coarse and found > before:
            notes = (f"fields from {depths[before] * h:.3g} mm on are those of cells of 1.5 times the size: finer ones "
                     "end before",)  # fmt: skip
        found, stop = max(found, before), made.stop
        if found == len(depths):
            return SlidingPath(found, None, notes)
    return SlidingPath(found, stop, notes)


def _way(
    slab: Slab, law: Law, poisson: float, fillet: float, friction: float, cells: int
) -> tuple[Problem, Callable[..., Path]]:
    """The problem of a face with or without friction, and what follows it."""
    if not friction:
        mesh = SlidingMesh(slab, law, poisson, fillet, cells)
        return mesh.problem, lambda *args: follow_sliding(mesh, *args)
    problem = rubbing_problem(slab, law, poisson, fillet, friction, cells)
    return problem, lambda *args: follow_rubbing(problem, *args)


def _with_lattice(depths: Array) -> Array:
    """Wanted depths and those of the force's own path between them."""
    path = lattice_depths(float(depths[-1]))
    room = NEAR * np.minimum(path, LATTICE)
    apart = np.abs(path[:, None] - depths).min(axis=1) > room
    return np.union1d(path[apart & (path < depths[-1])], depths)
