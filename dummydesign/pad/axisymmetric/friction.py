"""A slab that rubs along a filleted punch; force by the condition at its face."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from dummydesign.geometry.interface import FACES, Interface
from dummydesign.pad.axisymmetric.case import (
    FIRST_STEP,
    LATTICE,
    Case,
    Progress,
    extend_path,
    of_two_meshes,
    round_problem,
    solve_on_lattice,
)
from dummydesign.pad.axisymmetric.filleted import CELLS, GROWTH, LARGEST, fine_columns, solve_filleted
from dummydesign.pad.axisymmetric.frictionless import solve_sliding
from dummydesign.pad.contact.axisymmetric import FilletedPunch
from dummydesign.pad.contact.friction import RubbingSurface
from dummydesign.pad.contact.penalty import RUBBING_PUNCH
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.solve.continuation import Path, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution
from dummydesign.pad.specimen import Pad

Array = np.ndarray

# Cells over the fillet of the two meshes; even cells reach this many fillets inwards of it, and half of one beyond.
COARSE, FINE = 2, 3
INWARDS, OUTWARDS = 2.0, 0.5
# Grips over the one of the table: where a path ends early, that with the softer one is followed too, whose points that
# slip and stick in turn do so more gently. Its force counts from there on, made equal where both are known.
GRIPS = (1.0, 0.2)
# Stated for a path of the softer grip alone.
SOFTER_ERROR = 2e-3
SMALLEST_STEP = LATTICE / 512.0
# Error of contact, grip and steps, beside the step between the meshes.
LEAST_ERROR = 5e-3


def solve_under_fillet(
    pad: Pad, depth_mm: Sequence[float] | Array, progress: Progress | None = None, sides: bool = True
) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge, by what its face does there.

    Without ``sides`` a punch that is glued ends with its fillet.
    """
    face = Interface.parse(pad.condition, "condition", FACES)
    if face.bonded:
        kind = "filleted" if sides else "filleted-without-sides"
        return solve_on_lattice(kind, pad, depth_mm, partial(solve_filleted, progress=progress, sides=sides))
    kind, solve = ("rubbing", solve_rubbing) if face.friction else ("sliding", solve_sliding)
    return solve_on_lattice(kind, pad, depth_mm, partial(solve, progress=progress))


def solve_rubbing(case: Case, nodes: Array, progress: Progress | None = None) -> dict[str, Any]:
    """F / d over mu h at the first of the nodes, those that were reached, and its relative error."""
    (coarse, rough), (fine, softer) = (_extended(case, cells, nodes, progress) for cells in (COARSE, FINE))
    made = of_two_meshes(coarse, fine, nodes, LEAST_ERROR)
    count = len(made["error"])
    own = np.concatenate([softer, rough[len(softer) :]]) if len(rough) > len(softer) else softer
    return made | {"error": made["error"] + np.maximum.accumulate(own)[:count]}


def rubbing_problem(case: Case, cells: int, grip: float = 1.0) -> Problem:
    """The slab under a punch with a fillet, contact and friction over the whole face."""
    fillet, friction = case.edge, Interface.parse(case.condition, "condition", FACES).friction
    punch = FilletedPunch(case.radius, fillet)
    flat, cell = punch.flat_radius, fillet / cells
    inner = min(INWARDS * fillet, 0.5 * flat)
    near = np.linspace(flat - inner, flat + OUTWARDS * fillet, max(2, round((inner + OUTWARDS * fillet) / cell)) + 1)
    mesh = fine_columns(case, near, cell, GROWTH ** (CELLS / cells), LARGEST * CELLS / cells)
    top, radius = meshes.on_top(mesh), mesh.nodes[0]
    sides = meshes.edges_on(mesh, top & (radius <= case.radius + 0.8 * case.scale))
    stiffness = case.law.shear_MPa * RUBBING_PUNCH.contact / fillet
    surface = RubbingSurface(mesh.nodes, sides, stiffness, grip * RUBBING_PUNCH.grip_share, friction)
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    under = np.nonzero(top & (radius <= flat + 1e-9))[0]
    return round_problem(mesh, case, np.array([], dtype=int), surface, punch, under)


def follow_rubbing(
    problem: Problem, depths: Array, progress: Progress | None = None,
    visit: Callable[[float, Solution], None] | None = None,
) -> Path:  # fmt: skip
    """Follow the problem through depths that are no further apart than the steps of the force's path."""
    return follow(problem, depths, FIRST_STEP, LATTICE, SMALLEST_STEP, progress, visit=visit)


def _extended(case: Case, cells: int, nodes: Array, progress: Progress | None) -> tuple[Path, Array]:
    """A path, extended by that with a softer grip where it ends early, and the relative doubt in that."""
    path = follow_rubbing(rubbing_problem(case, cells, GRIPS[0]), nodes, progress)
    count = len(path.force)
    if path.stop is None:
        return path, np.zeros(count)
    other = follow_rubbing(rubbing_problem(case, cells, GRIPS[1]), nodes, progress)
    # Up to a depth that both reached they differ by less than what is stated; deeper by what they did last.
    log = float(np.log(path.force[-1] / other.force[count - 1])) if 0 < count <= len(other.force) else 0.0
    path = extend_path(path, other, other.force[count:] * np.exp(log))
    doubt = max(abs(log), 0.0 if count else SOFTER_ERROR)
    return path, np.where(np.arange(len(path.force)) < count, 0.0, doubt)
