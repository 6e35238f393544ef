"""Force of a slab under a round flat punch with a filleted edge along which its face rubs.

Friction holds the face back where it goes round the fillet, so the mesh stays with the gel, other than without friction
(:mod:`dummydesign.pad.slab.frictionless`). What touches remembers where it has slipped to
(:mod:`dummydesign.pad.contact.rubbing`). Depths of the load steps are the same whatever is wanted.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.contact.rubbing import RubbingSurface
from dummydesign.pad.contact.stiffness import RUBBING_PUNCH
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import columns
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.filleted import CELLS, GROWTH, LARGEST, FilletedPunch, check_fillet, lines
from dummydesign.pad.slab.problem import (
    EDGE_STABILISATION,
    PadCurve,
    Slab,
    base_unknowns,
    held_unknowns,
    normalise,
)
from dummydesign.pad.slab.solved_depths import HALVINGS, LATTICE, curve_through, lattice_depths, of_two_meshes
from dummydesign.pad.solve.continuation import Path, follow
from dummydesign.pad.solve.equilibrium import Problem, Solution

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


def solve_rubbing(
    thickness_mm: float,
    radius_mm: float,
    fillet_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    friction: float,
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge, Coulomb friction on face, fillet and side.

    Parameters
    ----------
    thickness_mm, radius_mm, fillet_mm, young_MPa, depth_mm, base, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.filleted.solve_filleted`.
    friction : float
        Coulomb's coefficient, above 0.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. The stated error is what cells
        of 1.5 times the size change, twice the largest of it where only one mesh got to, what a softer grip changed
        where a path was carried on with it, and 0.5 %.

    Raises
    ------
    InputError
        For a value outside its range.
    NoAnswerError
        When no depth could be solved.
    """
    shape, depths, ratio, unit = normalise(thickness_mm, radius_mm, young_MPa, depth_mm, poisson, law)
    check_fillet(fillet_mm, radius_mm)
    slab, fillet = Slab(ratio, extent_mm / thickness_mm, base), fillet_mm / thickness_mm
    nodes = lattice_depths(float(depths[-1]))
    inputs: dict[str, Any] = {"slab": slab, "fillet": fillet, "law": shape, "poisson": poisson, "depths": nodes}

    def solve() -> dict[str, Any]:
        (coarse, rough), (fine, softer) = (
            _carried_on(slab, shape, poisson, fillet, friction, cells, nodes, progress) for cells in (COARSE, FINE)
        )
        made = of_two_meshes(coarse, fine, nodes, LEAST_ERROR)
        count = len(made["error"])
        own = np.concatenate([softer, rough[len(softer) :]]) if len(rough) > len(softer) else softer
        return made | {"error": made["error"] + np.maximum.accumulate(own)[:count]}

    found = cached("rubbing", inputs | {"friction": friction}, solve)
    return curve_through(nodes, found, depths, thickness_mm, unit)


def rubbing_problem(
    slab: Slab, law: Law, poisson: float, fillet: float, friction: float, cells: int, grip: float = 1.0
) -> Problem:
    """The slab under a punch with a fillet, contact and friction over the whole face; lengths in thicknesses.

    Parameters
    ----------
    slab : Slab
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    fillet : float
        Radius of the punch's edge.
    friction : float
        Coulomb's coefficient, above 0.
    cells : int
        Cells over the fillet.
    grip : float
        Stiffness of what holds a point that sticks, over that of the table.
    """
    punch = FilletedPunch(slab.radius, fillet)
    flat, cell = punch.flat_radius, fillet / cells
    growth, largest = GROWTH ** (CELLS / cells), LARGEST * CELLS / cells
    inner = min(INWARDS * fillet, 0.5 * flat)
    near = np.linspace(flat - inner, flat + OUTWARDS * fillet, max(2, round((inner + OUTWARDS * fillet) / cell)) + 1)
    r = np.concatenate([
        near[0] - lines(near[0], cell, growth, largest)[:0:-1], near,
        near[-1] + lines(slab.extent - near[-1], cell, growth, largest, 1.0)[1:],
    ])  # fmt: skip
    points, quads, _ = columns(r, lines(1.0, cell, growth, largest))
    mesh = meshes.discretise(points, quads)
    top, radius = meshes.on_top(mesh), mesh.nodes[0]
    sides = meshes.edges_on(mesh, top & (radius <= slab.radius + 0.8 * slab.scale))
    stiffness = law.shear_MPa * RUBBING_PUNCH.contact / fillet
    surface = RubbingSurface(mesh.nodes, sides, stiffness, grip * RUBBING_PUNCH.grip_share, friction)
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    under = np.nonzero(top & (radius <= flat + 1e-9))[0]
    return Problem(
        Solid(mesh, law, poisson, EDGE_STABILISATION), held_unknowns(mesh, slab), np.array([], dtype=int),
        base_unknowns(mesh), surface, punch, 2 * under + 1,
    )  # fmt: skip


def follow_rubbing(
    problem: Problem, depths: Array, progress: Callable[[float], None] | None = None,
    visit: Callable[[float, Solution], None] | None = None,
) -> Path:  # fmt: skip
    """Follow the problem through depths that are no further apart than the steps of the force's path.

    Parameters
    ----------
    problem : Problem
        As :func:`rubbing_problem` makes it.
    depths : ndarray, shape (n,)
        Increasing, in thicknesses.
    progress, visit : callable, optional
        As for :func:`dummydesign.pad.solve.continuation.follow`.
    """
    return follow(problem, depths, LATTICE * 0.5**HALVINGS, LATTICE, SMALLEST_STEP, progress, visit=visit)


def _carried_on(
    slab: Slab, law: Law, poisson: float, fillet: float, friction: float, cells: int, nodes: Array,
    progress: Callable[[float], None] | None,
) -> tuple[Path, Array]:  # fmt: skip
    """A path, carried on by that with a softer grip where it ends early, and the relative doubt in that."""
    first, softer = GRIPS
    path = follow_rubbing(rubbing_problem(slab, law, poisson, fillet, friction, cells, first), nodes, progress)
    count = len(path.force)
    if path.stop is None:
        return path, np.zeros(count)
    other = follow_rubbing(rubbing_problem(slab, law, poisson, fillet, friction, cells, softer), nodes, progress)
    iterations = path.newton_iterations + other.newton_iterations
    steps, seconds = path.load_steps + other.load_steps, path.seconds + other.seconds
    if len(other.force) <= count:
        path = replace(path, newton_iterations=iterations, load_steps=steps, seconds=seconds)
        return path, np.zeros(count)
    # Up to a depth that both reached they differ by less than what is stated beside; deeper by what they did last.
    log = float(np.log(path.force[-1] / other.force[count - 1])) if count else 0.0
    force = np.concatenate([path.force, other.force[count:] * np.exp(log)])
    doubt = np.where(np.arange(len(force)) < count, 0.0, max(abs(log), 0.0 if count else SOFTER_ERROR))
    other = replace(other, force=force, newton_iterations=iterations, load_steps=steps, seconds=seconds)
    return other, doubt
