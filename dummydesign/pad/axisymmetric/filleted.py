"""Force of a slab under a round flat punch whose edge is a fillet: a well-posed problem without a singular edge.

The face inside the fillet is glued from the start. Beyond it the pad's surface rolls on to the fillet, and further on
to the punch's upright side; what touches there sticks where it touched. Nothing is singular: the force is solved on
two meshes, the cells of one twice as large, and extrapolated by half of what that changed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.errors import out_of_range
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS
from dummydesign.pad.axisymmetric.case import FIRST_STEP, LATTICE, Case, first_stiffness, round_problem
from dummydesign.pad.contact.axisymmetric import FilletedPunch, Surface
from dummydesign.pad.contact.penalty import FILLETED_PUNCH
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_axisymmetric import columns
from dummydesign.pad.fem.mixed_solid import Discretisation
from dummydesign.pad.solve.continuation import Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Fine mesh: cells over the fillet, growth away from it, largest cell (thicknesses); the coarse one has half the cells.
CELLS, GROWTH, LARGEST = 3.0, 1.5, 0.2
# Cells over a large fillet are no larger than this (thicknesses).
AT_FILLET = 0.06
# The rest of the step between the meshes, added and stated as error; and the error of contact and steps.
MESH_LEFT = 0.5
LEAST_ERROR = 1.5e-3


def lines(length: float, first: float, growth: float, largest: float, within: float = np.inf) -> Array:
    """Places of cells that grow away from the first one."""
    nodes, cell = [0.0], first
    while nodes[-1] < length:
        nodes.append(nodes[-1] + cell)
        cell = cell * growth if nodes[-1] >= within else min(cell * growth, largest)
    return np.array(nodes) * (length / nodes[-1])


def filleted_problem(case: Case, sides: bool = True, coarser: float = 1.0) -> Problem:
    """The slab under a punch with a fillet, what touches it glued; over a base with friction it may lift off."""
    check_fillet(case.edge, case.radius)
    fillet, shear = case.edge, case.law.shear_MPa
    punch = FilletedPunch(case.radius, fillet, sides)
    flat, cell, growth = punch.flat_radius, min(fillet / CELLS, AT_FILLET) * coarser, GROWTH**coarser
    start = flat + 0.5 * fillet
    near = np.linspace(flat, start, max(1, round(0.5 * fillet / cell)) + 1)
    mesh = fine_columns(case, near, cell, growth, LARGEST * coarser)
    top, radius = meshes.on_top(mesh), mesh.nodes[0]
    under = np.nonzero(top & (radius <= flat + 1e-9))[0]
    free = meshes.edges_on(mesh, top & (radius >= flat - 1e-9) & (radius <= case.radius + 0.8 * case.scale))
    stiffness = shear * FILLETED_PUNCH.contact / coarser / fillet
    surface = Surface(mesh.nodes, free, stiffness, grip=stiffness, grip_from=0.0, ties_within_step=True)
    return round_problem(mesh, case, under, surface, punch)


def fine_columns(case: Case, near: Array, cell: float, growth: float, largest: float) -> Discretisation:
    """Mesh a slab with the columns ``near``, and cells that grow away from them and down from the face."""
    r = np.concatenate([
        near[0] - lines(near[0], cell, growth, largest)[:0:-1], near,
        near[-1] + lines(case.extent - near[-1], cell, growth, largest, 1.0)[1:],
    ])  # fmt: skip
    points, quads, _ = columns(r, lines(1.0, cell, growth, largest))
    return meshes.discretise(points, quads)


def check_fillet(fillet_mm: float, half_width_mm: float) -> None:
    """Refuse a fillet that is not above 0 and within 0.3 of the punch's smaller half-width."""
    largest = LARGEST_EDGE_RADIUS * half_width_mm
    if not 0.0 < fillet_mm <= largest * (1.0 + 1e-9):
        raise out_of_range("edge_radius_mm", fillet_mm, 0.0, float(f"{largest:.4g}"))


def follow_filleted(problem: Problem, nodes: Array) -> Path:
    """Follow a glued fillet through depths on the lattice."""
    return follow(problem, nodes, FIRST_STEP, LATTICE, LATTICE / 256.0, lattice=True)


def solve_filleted(case: Case, nodes: Array, sides: bool = True) -> dict[str, Any]:
    """F / d over mu h at depth 0 and at the first of the nodes, those that were reached, and its relative error.

    F / d rises from that of the flat face as the contact rolls on to the fillet, by about the root of the depth.
    """
    coarse, fine = (follow_filleted(filleted_problem(case, sides, coarser), nodes) for coarser in (2.0, 1.0))
    face = replace(case, radius=case.radius - case.edge)
    first = 3.0 * face.radius * first_stiffness(face)
    count = len(fine.force)
    step = np.zeros(count)
    both = min(count, len(coarse.force))
    step[:both] = np.log(fine.force[:both] / coarse.force[:both])
    if 0 < both < count:
        step[both:] = 2.0 * step[both - 1]
    stiffness = np.concatenate([[first], fine.force / nodes[:count] * np.exp(MESH_LEFT * step)])
    # Largest step so far: single ones pass through zero.
    error = LEAST_ERROR + MESH_LEFT * np.maximum.accumulate(np.abs(step))
    return {
        "depth": np.concatenate([[0.0], nodes[:count]]), "stiffness": stiffness,
        "error": np.concatenate([[LEAST_ERROR], error]), "solver": cost([coarse, fine]), "stop": fine.stop,
    }  # fmt: skip
