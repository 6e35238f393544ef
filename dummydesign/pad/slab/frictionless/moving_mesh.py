"""A slab's mesh whose columns stay with the fillet of a punch while the slab's face slides round it.

A corner of a cell that slides over a small fillet snaps from side to side, and no load step is small enough. So the
columns are moved through the undeformed slab, from step to step: the cells over the fillet are always those.
"""

from __future__ import annotations

import numpy as np

from dummydesign.pad.contact.stiffness import FILLETED_PUNCH
from dummydesign.pad.contact.surface_axisymmetric import Surface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import columns
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.filleted import GROWTH, LARGEST, FilletedPunch, lines
from dummydesign.pad.slab.problem import Slab, base_unknowns, held_unknowns
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Undeformed length of the face over the fillet, and of the even cells above it, in fillets.
SPAN, ABOVE = 0.8, 2.0
# The energy term that keeps cells from inverting, in shear moduli; a tenth of it changes no force by more than 0.2 %.
STABILISATION = 10.0
# A column is moved by this share of what it is away from the fillet's start, and at most by this share of a cell.
GAIN, FURTHEST = 0.5, 0.5


class SlidingMesh:
    """The slab under a filleted punch without friction, its columns at any place; lengths in thicknesses.

    Parameters
    ----------
    slab : Slab
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    fillet : float
        Radius of the punch's edge.
    cells : int
        Cells over the fillet.
    """

    def __init__(self, slab: Slab, law: Law, poisson: float, fillet: float, cells: int) -> None:
        self.slab, self.punch = slab, FilletedPunch(slab.radius, fillet)
        self._law, self._poisson = law, poisson
        flat, self._cell = self.punch.flat_radius, SPAN * fillet / cells
        self._inside = (1.0 - lines(flat, self._cell, GROWTH, LARGEST) / flat)[::-1]
        self._even = self._cell * np.arange(cells + round(ABOVE * fillet / self._cell) + 1)
        beyond = slab.extent - flat - self._even[-1]
        self._beyond = lines(beyond, self._cell, GROWTH, LARGEST, 1.0) / beyond
        self._z = -lines(1.0, self._cell, GROWTH, LARGEST)
        self.cells = cells
        self.edge = flat
        solid = self._solid()
        mesh = solid.mesh
        top = meshes.on_top(mesh)
        self._sides = meshes.edges_on(mesh, top & (mesh.nodes[0] <= slab.radius + 0.8 * slab.scale))
        self.face = np.nonzero(top)[0][np.argsort(mesh.nodes[0][top])]
        under = np.nonzero(top & (mesh.nodes[0] <= flat + 1e-9))[0]
        middles = self._middles(flat)
        depths = np.concatenate([self._z, 0.5 * (self._z[1:] + self._z[:-1])])
        depths.sort()
        self._column = np.argmin(np.abs(mesh.nodes[0][:, None] - middles), axis=1)
        self._row = np.argmin(np.abs(mesh.nodes[1][:, None] - depths), axis=1)
        self.problem = Problem(
            solid, held_unknowns(mesh, slab), np.array([], dtype=int), base_unknowns(mesh), self._surface(solid),
            self.punch, 2 * under + 1,
        )  # fmt: skip

    def _radii(self, edge: float) -> Array:
        """Radii of the columns when the fillet's first one is at ``edge`` in the undeformed slab."""
        start = edge + self._even[-1]
        outside = start + (self.slab.extent - start) * self._beyond
        return np.concatenate([edge * self._inside[:-1], edge + self._even[:-1], outside])

    def _middles(self, edge: float) -> Array:
        """Those and the radii half-way between them: all that have nodes."""
        radii = self._radii(edge)
        both = np.empty(2 * len(radii) - 1)
        both[::2], both[1::2] = radii, 0.5 * (radii[1:] + radii[:-1])
        return both

    def _solid(self) -> Solid:
        points, quads, _ = columns(self._radii(self.edge), -self._z)
        return Solid(meshes.discretise(points, quads), self._law, self._poisson, STABILISATION)

    def _surface(self, solid: Solid) -> Surface:
        stiffness = self._law.shear_MPa * FILLETED_PUNCH.contact / self.punch.rim
        return Surface(solid.mesh.nodes, self._sides, lambda at: np.full_like(at, stiffness), np.zeros_like)

    def move(self, edge: float) -> None:
        """Put the columns where the fillet's first one is at a radius ``edge`` of the undeformed slab."""
        self.edge = edge
        self.problem.solid = self._solid()
        self.problem.surface = self._surface(self.problem.solid)

    def better(self, edge: float, places: Array, depth: float) -> tuple[float, Array]:
        """Columns nearer to the fillet's start than those at ``edge``, and where their nodes are then.

        Parameters
        ----------
        edge : float
            Radius of the fillet's first column in the undeformed slab.
        places : ndarray, shape (nodes, 2)
            Of the deformed nodes.
        depth : float
            Of the punch.

        Returns
        -------
        edge : float
        places : ndarray, shape (nodes, 2)
        """
        way = self.punch.outline(places[self.face], depth)
        before, at = self._middles(edge), 2 * (len(self._inside) - 1)
        stretch = (way[at + 1] - way[at - 1]) / (before[at + 1] - before[at - 1])
        miss = (way[at] - self.punch.flat_radius) / max(stretch, 0.3)
        moved = edge - float(np.clip(GAIN * miss, -FURTHEST * self._cell, FURTHEST * self._cell))
        grid = np.zeros((len(before), self._row.max() + 1, 2))
        grid[self._column, self._row] = places
        grid += np.gradient(grid, before, axis=0) * (self._middles(moved) - before)[:, None, None]
        return moved, grid[self._column, self._row]

    def stretch(self, u: Array, depth: float) -> float:
        """Largest stretch of the face along the outline, of the cells over the fillet and next to it.

        Parameters
        ----------
        u : ndarray, shape (displacements,)
            Displacements of the nodes.
        depth : float
            Of the punch.
        """
        nodes = self.problem.solid.mesh.nodes[:, self.face].T
        way = self.punch.outline(nodes + u.reshape(-1, 2)[self.face], depth)
        at = 2 * (len(self._inside) - 2) + 2 * np.arange(self.cells + 2)
        return float((np.diff(way[at]) / np.diff(nodes[at, 0])).max())
