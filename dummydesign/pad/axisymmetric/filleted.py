"""Force of a slab under a round flat punch whose edge is a fillet: a well-posed problem without a singular edge.

Glued, the face inside the fillet moves with the punch from the start. Beyond it the pad's surface rolls on to the
fillet, and further on to the punch's upright side; what touches there sticks where it touched. Nothing is singular: the
force is solved on two meshes, the cells of one twice as large, and extrapolated by half of what that changed. A face
that slides without friction has a mesh that moves with the fillet; one with friction rubs along the punch's outline.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.errors import out_of_range
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS
from dummydesign.geometry.interface import FACES, Interface
from dummydesign.pad.axisymmetric.case import (
    FIRST_STEP,
    LATTICE,
    Case,
    extend_path,
    first_stiffness,
    of_two_meshes,
    round_problem,
    solve_on_lattice,
)
from dummydesign.pad.contact.axisymmetric import FILLETED_PUNCH, RUBBING_PUNCH, AxisymmetricSurface, FilletedPunch
from dummydesign.pad.contact.friction import RubbingSurface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import Discretisation, Solid
from dummydesign.pad.force_law import Array, PadCurve
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import ForcePath, VisitedState, cost, follow
from dummydesign.pad.solve.equilibrium import ContactProblem, Equilibrium

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


def filleted_problem(case: Case, sides: bool = True, coarser: float = 1.0) -> ContactProblem:
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
    surface = AxisymmetricSurface(mesh.nodes, free, stiffness, grip=stiffness, grip_from=0.0, ties_within_step=True)
    return round_problem(mesh, case, under, surface, punch)


def fine_columns(case: Case, near: Array, cell: float, growth: float, largest: float) -> Discretisation:
    """Mesh a slab with the columns ``near``, and cells that grow away from them and down from the face."""
    r = np.concatenate(
        [
            near[0] - lines(near[0], cell, growth, largest)[:0:-1],
            near,
            near[-1] + lines(case.extent - near[-1], cell, growth, largest, 1.0)[1:],
        ]
    )
    points, quads, _ = meshes.columns(r, lines(1.0, cell, growth, largest))
    return meshes.discretise(points, quads)


def check_fillet(fillet_mm: float, half_width_mm: float) -> None:
    """Refuse a fillet that is not above 0 and within 0.3 of the punch's smaller half-width."""
    largest = LARGEST_EDGE_RADIUS * half_width_mm
    if not 0.0 < fillet_mm <= largest * (1.0 + 1e-9):
        raise out_of_range("edge_radius_mm", fillet_mm, 0.0, float(f"{largest:.4g}"))


def follow_filleted(problem: ContactProblem, nodes: Array) -> ForcePath:
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
        "depth": np.concatenate([[0.0], nodes[:count]]),
        "stiffness": stiffness,
        "error": np.concatenate([[LEAST_ERROR], error]),
        "solver": cost([coarse, fine]),
        "stop": fine.stop,
    }


# Undeformed length of the face over the fillet, and of the even cells above it, in fillets.
SPAN, ABOVE = 0.8, 2.0
# The energy term that keeps cells from inverting, in shear moduli; a tenth of it changes no force by more than 0.2 %.
STABILISATION = 10.0
# A column is moved by this share of what it is away from the fillet's start, and at most by this share of a cell.
GAIN, FURTHEST = 0.5, 0.5


class SlidingMesh:
    """The slab under a filleted punch without friction, its columns at any place; lengths in thicknesses."""

    def __init__(self, case: Case, cells: int) -> None:
        fillet = case.edge
        self.case, self.punch, self.cells = case, FilletedPunch(case.radius, fillet), cells
        flat, self._cell = self.punch.flat_radius, SPAN * fillet / cells
        self.edge = flat
        self._inside = (1.0 - lines(flat, self._cell, GROWTH, LARGEST) / flat)[::-1]
        self._even = self._cell * np.arange(cells + round(ABOVE * fillet / self._cell) + 1)
        beyond = case.extent - flat - self._even[-1]
        self._beyond = lines(beyond, self._cell, GROWTH, LARGEST, 1.0) / beyond
        self._z = -lines(1.0, self._cell, GROWTH, LARGEST)
        mesh = self._mesh()
        top, r = meshes.on_top(mesh), mesh.nodes[0]
        self._sides = meshes.edges_on(mesh, top & (r <= case.radius + 0.8 * case.scale))
        self.face = np.nonzero(top)[0][np.argsort(r[top])]
        depths = np.sort(np.concatenate([self._z, 0.5 * (self._z[1:] + self._z[:-1])]))
        self._column = np.argmin(np.abs(r[:, None] - self._middles(flat)), axis=1)
        self._row = np.argmin(np.abs(mesh.nodes[1][:, None] - depths), axis=1)
        self.problem: ContactProblem = round_problem(
            mesh,
            case,
            np.array([], dtype=int),
            self._surface(mesh),
            self.punch,
            np.nonzero(top & (r <= flat + 1e-9))[0],
            STABILISATION,
        )
        self._ends = [(0.0, flat, mesh.nodes.T, self.problem.start()[1])]
        self._stretched = 1.0

    def _radii(self, edge: float) -> Array:
        """Radii of the columns when the fillet's first one is at ``edge`` in the undeformed slab."""
        start = edge + self._even[-1]
        outside = start + (self.case.extent - start) * self._beyond
        return np.concatenate([edge * self._inside[:-1], edge + self._even[:-1], outside])

    def _middles(self, edge: float) -> Array:
        """Those and the radii half-way between them: all that have nodes."""
        radii = self._radii(edge)
        both = np.empty(2 * len(radii) - 1)
        both[::2], both[1::2] = radii, 0.5 * (radii[1:] + radii[:-1])
        return both

    def _mesh(self) -> Discretisation:
        points, quads, _ = meshes.columns(self._radii(self.edge), -self._z)
        return meshes.discretise(points, quads)

    def _surface(self, mesh: Discretisation) -> AxisymmetricSurface:
        return AxisymmetricSurface(
            mesh.nodes, self._sides, self.case.law.shear_MPa * FILLETED_PUNCH.contact / self.punch.rim
        )

    def move(self, edge: float) -> None:
        """Put the columns where the fillet's first one is at a radius ``edge`` of the undeformed slab."""
        self.edge = edge
        mesh = self._mesh()
        self.problem.solid = Solid(mesh, self.case.law, self.case.poisson, STABILISATION)
        self.problem.surface = self._surface(mesh)

    def nearer(self, edge: float, places: Array, depth: float) -> tuple[float, Array]:
        """Columns nearer to the fillet's start than those at ``edge``, and where their nodes are then."""
        way = self.punch.outline(places[self.face], depth)
        before, at = self._middles(edge), 2 * (len(self._inside) - 1)
        stretch = (way[at + 1] - way[at - 1]) / (before[at + 1] - before[at - 1])
        miss = (way[at] - self.punch.flat_radius) / max(stretch, 0.3)
        moved = edge - float(np.clip(GAIN * miss, -FURTHEST * self._cell, FURTHEST * self._cell))
        grid = np.zeros((len(before), self._row.max() + 1, 2))
        grid[self._column, self._row] = places
        grid += np.gradient(grid, before, axis=0) * (self._middles(moved) - before)[:, None, None]
        return moved, grid[self._column, self._row]

    def ahead(self, depth: float) -> tuple[Array, Array]:
        """Displacements and pressures that are expected at a depth, on columns that are put where the fillet will be.

        They are extrapolated from the last two states in the frame of the punch, in which it hardly changes.
        """
        here, edge, places, p = self._ends[-1]
        if len(self._ends) == 1:
            rate = self.problem.direction()
            guess, pressure = places + (depth - here) * rate[0].reshape(-1, 2), p + (depth - here) * rate[1]
        else:
            earlier = self._ends[-2]
            part = min((depth - here) / (here - earlier[0]), 5.0)
            guess, pressure = places + part * (places - earlier[2]), p + part * (p - earlier[3])
            edge, guess = self.nearer(edge + part * (edge - earlier[1]), guess, depth)
        self.move(edge)
        return (guess - self.problem.solid.mesh.nodes.T).ravel(), pressure

    def keep(self, end: VisitedState) -> None:
        """Take the end of a step as what the next one goes on from."""
        places = self.problem.solid.mesh.nodes.T + end.u.reshape(-1, 2)
        self._ends = [self._ends[-1], (end.depth, self.edge, places, end.p)]
        self._stretched = self.stretch(end.u, end.depth)

    def explain(self, problem: ContactProblem, u: Array, p: Array, depth: float, reason: str) -> str:
        """Why a path ends: with how far the face is drawn out where it slides round the fillet."""
        return (
            f"{reason}; at relative depth {depth:.3f} the face is {self._stretched:.1f} times as long where it "
            "slides round the fillet; under a larger fillet it gets further"
        )

    def stretch(self, u: Array, depth: float) -> float:
        """Largest stretch of the face along the outline, of the cells over the fillet and next to it."""
        nodes = self.problem.solid.mesh.nodes[:, self.face].T
        way = self.punch.outline(nodes + u.reshape(-1, 2)[self.face], depth)
        at = 2 * (len(self._inside) - 2) + 2 * np.arange(self.cells + 2)
        return float((np.diff(way[at]) / np.diff(nodes[at, 0])).max())


SMALLEST_SLIDE = LATTICE / 128.0
# Error of contact, steps and the energy term; beside the step between the meshes, doubled where the fine one has ended.
SLIDING_ERROR = 3e-3


def solve_sliding(case: Case, nodes: Array) -> dict[str, Any]:
    """F / d over mu h at the first of the nodes, those that were reached, and its relative error."""
    coarse, fine = (follow_sliding(SlidingMesh(case, cells), nodes) for cells in (COARSE, FINE))
    return of_two_meshes(coarse, fine, nodes, SLIDING_ERROR)


def follow_sliding(
    mesh: SlidingMesh, depths: Array, visit: Callable[[float, Equilibrium], None] | None = None
) -> ForcePath:
    """Follow the slab through depths while the mesh's columns follow the fillet."""
    return follow(
        mesh.problem,
        depths,
        float(depths[0]),
        LATTICE,
        SMALLEST_SLIDE,
        visit=visit,
        keep=mesh.keep,
        ahead=mesh.ahead,
        explained=mesh.explain,
    )


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
RUBBING_ERROR = 5e-3


def solve_under_fillet(pad: Pad, depth_mm: Sequence[float] | Array, sides: bool = True) -> PadCurve:
    """Static force of a slab under a round punch with a filleted edge, by what its face does there.

    Without ``sides`` a punch that is glued ends with its fillet.
    """
    face = Interface.parse(pad.condition, "condition", FACES)
    if face.bonded:
        kind = "filleted" if sides else "filleted-without-sides"
        return solve_on_lattice(kind, pad, depth_mm, partial(solve_filleted, sides=sides))
    kind, solve = ("rubbing", solve_rubbing) if face.friction else ("sliding", solve_sliding)
    return solve_on_lattice(kind, pad, depth_mm, solve)


def solve_rubbing(case: Case, nodes: Array) -> dict[str, Any]:
    """F / d over mu h at the first of the nodes, those that were reached, and its relative error."""
    (coarse, rough), (fine, softer) = (_extended(case, cells, nodes) for cells in (COARSE, FINE))
    made = of_two_meshes(coarse, fine, nodes, RUBBING_ERROR)
    count = len(made["error"])
    own = np.concatenate([softer, rough[len(softer) :]]) if len(rough) > len(softer) else softer
    return made | {"error": made["error"] + np.maximum.accumulate(own)[:count]}


def rubbing_problem(case: Case, cells: int, grip: float = 1.0) -> ContactProblem:
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
    problem: ContactProblem, depths: Array, visit: Callable[[float, Equilibrium], None] | None = None
) -> ForcePath:
    """Follow the problem through depths that are no further apart than the steps of the force's path."""
    return follow(problem, depths, FIRST_STEP, LATTICE, SMALLEST_STEP, visit=visit)


def _extended(case: Case, cells: int, nodes: Array) -> tuple[ForcePath, Array]:
    """A path, extended by that with a softer grip where it ends early, and the relative doubt in that."""
    path = follow_rubbing(rubbing_problem(case, cells, GRIPS[0]), nodes)
    count = len(path.force)
    if path.stop is None:
        return path, np.zeros(count)
    other = follow_rubbing(rubbing_problem(case, cells, GRIPS[1]), nodes)
    # Up to a depth that both reached they differ by less than what is stated; deeper by what they did last.
    log = float(np.log(path.force[-1] / other.force[count - 1])) if 0 < count <= len(other.force) else 0.0
    path = extend_path(path, other, other.force[count:] * np.exp(log))
    doubt = max(abs(log), 0.0 if count else SOFTER_ERROR)
    return path, np.where(np.arange(len(path.force)) < count, 0.0, doubt)
