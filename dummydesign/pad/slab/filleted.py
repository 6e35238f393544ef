"""Force of a slab under a round flat punch whose edge is a fillet: a well-posed problem without a singular edge.

The face inside the fillet is glued from the start. Beyond it the pad's surface rolls on to the fillet, and further on
to the punch's upright side; what touches there sticks where it touched. Nothing is singular: the force is solved on
two meshes, the cells of one twice as large, and carried on by half of what that changed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import out_of_range
from dummydesign.geometry.standard import LARGEST_EDGE_RADIUS, PAD_EXTENT_MM
from dummydesign.pad.contact.resting_base import Both, RestingBase
from dummydesign.pad.contact.stiffness import FILLETED_PUNCH
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch, Surface
from dummydesign.pad.contact.ties import Contact
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import columns
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.problem import (
    EDGE_STABILISATION,
    PadCurve,
    Slab,
    base_unknowns,
    first_stiffness,
    held_unknowns,
    normalise,
)
from dummydesign.pad.slab.solved_depths import LATTICE, curve_through, lattice_depths
from dummydesign.pad.solve.continuation import Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Fine mesh: cells over the fillet, growth away from it, largest cell (thicknesses); the coarse one has half the cells.
CELLS, GROWTH, LARGEST = 3.0, 1.5, 0.2
# Cells over a large fillet are no larger than this (thicknesses).
AT_FILLET = 0.06
# What is left of the step between the meshes, added and stated as error; and the error of contact and steps.
MESH_LEFT = 0.5
LEAST_ERROR = 1.5e-3


@dataclass(frozen=True)
class FilletedPunch(FlatPunch):
    """A flat punch whose edge is a fillet of radius ``rim``, with an upright side above it or none."""

    sides: bool = True

    def gap(self, points: Array, depth: float) -> tuple[Array, Array, Array]:
        """Distance to face, fillet or side, with its derivatives."""
        v = points - np.array([self.flat_radius, self.rim - depth])
        distance = np.maximum(np.linalg.norm(v, axis=-1), 1e-300)
        face = v[..., 0] < 0.0
        wall = ~face & (v[..., 1] > 0.0) & self.sides
        gap = np.where(face, -v[..., 1] - self.rim, np.where(wall, v[..., 0] - self.rim, distance - self.rim))
        normal = np.where(face[..., None], np.array([0.0, -1.0]), v / distance[..., None])
        normal = np.where(wall[..., None], np.array([1.0, 0.0]), normal)
        bend = np.where(face | wall, 0.0, 1.0 / distance)[..., None, None] * (
            np.eye(2) - normal[..., :, None] * normal[..., None, :]
        )
        return gap, normal, bend

    def outline(self, points: Array, depth: float) -> Array:
        """Length of the outline from the axis to the place next to ``points``.

        Parameters
        ----------
        points : ndarray, shape (..., 2)
            Radius and height, in the mesh's unit of length.
        depth : float
            How far the punch has come, in the same unit.
        """
        v = points - np.array([self.flat_radius, self.rim - depth])
        wall = (v[..., 1] > 0.0) & self.sides
        angle = np.where(wall, 0.5 * np.pi, np.arctan2(np.maximum(v[..., 0], 0.0), -v[..., 1]))
        beyond = self.flat_radius + self.rim * angle + np.where(wall, v[..., 1], 0.0)
        return np.where(v[..., 0] < 0.0, points[..., 0], beyond)


def lines(length: float, first: float, growth: float, largest: float, within: float = np.inf) -> Array:
    """Places of cells that grow away from the first one.

    Parameters
    ----------
    length : float
        Last place, in any unit of length; the first is 0.
    first : float
        Size of the first cell.
    growth : float
        Ratio of neighbouring cells.
    largest : float
        Largest cell up to ``within``.
    within : float
        Place up to which no cell is larger.

    Returns
    -------
    ndarray, shape (cells + 1,)
    """
    found, cell = [0.0], first
    while found[-1] < length:
        found.append(found[-1] + cell)
        cell = cell * growth if found[-1] >= within else min(cell * growth, largest)
    return np.array(found) * (length / found[-1])


def filleted_problem(
    slab: Slab, law: Law, poisson: float, fillet: float, sides: bool = True, coarser: float = 1.0,
    rests: tuple[float, float] | None = None,
) -> Problem:  # fmt: skip
    """The slab under a punch with a fillet, lengths in thicknesses, what touches it glued.

    Parameters
    ----------
    slab : Slab
        Slab and punch in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    fillet : float
        Radius of the fillet.
    sides : bool
        Whether the punch has an upright side above the fillet.
    coarser : float
        Size of the cells over those of the fine mesh.
    rests : (float, float), optional
        The slab merely rests on its base: coefficient of friction, and the weight's pressure in shear moduli.
    """
    punch = FilletedPunch(slab.radius, fillet, sides)
    flat, cell, growth = punch.flat_radius, min(fillet / CELLS, AT_FILLET) * coarser, GROWTH**coarser
    largest = LARGEST * coarser
    start = flat + 0.5 * fillet
    near = np.linspace(flat, start, max(1, round(0.5 * fillet / cell)) + 1)
    r = np.concatenate([
        flat - lines(flat, cell, growth, largest)[:0:-1], near,
        start + lines(slab.extent - start, cell, growth, largest, 1.0)[1:],
    ])  # fmt: skip
    points, quads, _ = columns(r, lines(1.0, cell, growth, largest))
    mesh = meshes.discretise(points, quads)
    top, radius = meshes.on_top(mesh), mesh.nodes[0]
    under = np.nonzero(top & (radius <= flat + 1e-9))[0]
    held = held_unknowns(mesh, slab)
    held[2 * under] = True
    free = meshes.edges_on(mesh, top & (radius >= flat - 1e-9) & (radius <= slab.radius + 0.8 * slab.scale))
    stiffness = law.shear_MPa * FILLETED_PUNCH.contact / coarser / fillet
    surface: Contact = Surface(
        mesh.nodes, free, lambda at: np.full_like(at, stiffness), np.zeros_like, stiffness, 0.0, ties_within_step=True
    )
    solid = Solid(mesh, law, poisson, EDGE_STABILISATION)
    if rests is not None:
        below = meshes.on_base(mesh, 1.0)
        held[2 * np.nonzero(below & ~meshes.on_axis(mesh))[0]] = held[base_unknowns(mesh)] = False
        surface = Both(surface, RestingBase(mesh, meshes.edges_on(mesh, below), law.shear_MPa, *rests))
    return Problem(solid, held, 2 * under + 1, base_unknowns(mesh), surface, punch)


def check_fillet(fillet_mm: float, half_width_mm: float) -> None:
    """Refuse a fillet that is not above 0 and within 0.3 of the punch's smaller half-width.

    Raises
    ------
    InputError
    """
    largest = LARGEST_EDGE_RADIUS * half_width_mm
    if not 0.0 < fillet_mm <= largest * (1.0 + 1e-9):
        raise out_of_range("edge_radius_mm", fillet_mm, 0.0, float(f"{largest:.4g}"))


def solve_filleted(
    thickness_mm: float,
    radius_mm: float,
    fillet_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    sides: bool = True,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge, glued where it touches.

    Parameters
    ----------
    thickness_mm, radius_mm, young_MPa, depth_mm, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.sharp_edge.solve_curve`.
    fillet_mm : float
        Radius of the punch's edge, above 0, at most 0.3 of the punch's radius. [mm]
    base : str
        ``bonded`` or ``sliding``.
    sides : bool
        Whether the punch's upright side above the fillet can touch; without it small fillets tend to the sharp edge.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. The load steps are the same whatever
        depths are wanted, so the force at one does not depend on the others. Half of what cells of half the size
        changed is added to it, and stated as error together with 0.15 %.

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
    inputs = {"slab": slab, "fillet": fillet, "law": shape, "poisson": poisson, "depths": nodes, "sides": sides}
    found = cached("filleted", inputs, lambda: _solve(slab, shape, poisson, fillet, sides, nodes, progress))
    # F / d rises from that of the flat face as the contact rolls on to the fillet, by about the root of the depth.
    return curve_through(np.concatenate([[0.0], nodes]), found, depths, thickness_mm, unit)


def _solve(
    slab: Slab, law: Law, poisson: float, fillet: float, sides: bool, nodes: Array,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:  # fmt: skip
    """F / d over mu h at depth 0 and at the first of the nodes, those that were reached, and its relative error."""
    coarse, fine = (_follow(filleted_problem(slab, law, poisson, fillet, sides, coarser), nodes, progress)
                    for coarser in (2.0, 1.0))  # fmt: skip
    face = Slab(slab.radius - fillet, slab.extent, slab.base)
    first = 3.0 * face.radius * first_stiffness(face, law, poisson)
    count = len(fine.force)
    step = np.zeros(count)
    both = min(count, len(coarse.force))
    step[:both] = np.log(fine.force[:both] / coarse.force[:both])
    if 0 < both < count:
        step[both:] = 2.0 * step[both - 1]
    stiffness = np.concatenate([[first], fine.force / nodes[:count] * np.exp(MESH_LEFT * step)])
    # Largest step so far: single ones pass through zero.
    error = LEAST_ERROR + MESH_LEFT * np.maximum.accumulate(np.abs(step))
    error = np.concatenate([[LEAST_ERROR], error])
    return {"stiffness": stiffness, "error": error, "solver": cost([coarse, fine]), "stop": fine.stop}


def _follow(problem: Problem, nodes: Array, progress: Callable[[float], None] | None) -> Path:
    return follow(problem, nodes, float(nodes[0]), LATTICE, LATTICE / 256.0, progress, lattice=True)
