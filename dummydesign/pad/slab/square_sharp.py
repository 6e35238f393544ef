"""A punch of any rectangle on a rectangular slab in space, beside its axisymmetric twin.

What is computed is the ratio of the force under a square or rectangular punch to that under the round
punch of equal area. The corner of a sharp, glued edge cannot be resolved at depth (see ``sharp_edge``),
but the ratio can: both are solved on tensor grids with the same cells, in shares of the punch, down from
and beside a sharp edge, and the error of the corner cell is nearly the same in both.

A quarter of the slab is meshed; x = 0 and y = 0 are planes of symmetry. Lengths in thicknesses.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.interface import BASES, CONDITIONS
from dummydesign.pad.fem import mesh_axisymmetric as plane
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Discretisation, Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.solve.continuation import Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.solve.solver_multifrontal import Dissection
from dummydesign.pad.solve.solver_superlu import Pattern
from dummydesign.pad.tables.square import SIDE_OVER_RADIUS

Array = np.ndarray
_TOLERANCE = 1e-9
# Below this volume ratio at a quadrature point the corner cell is about to fold.
SOUND_J = 0.2


@dataclass(frozen=True)
class Block:
    """A rectangular punch on a rectangular slab, in thicknesses.

    Attributes
    ----------
    half_sides : (float, float)
        Half sides of the punch along x and y.
    half_extents : (float, float)
        Half length and half width of the slab.
    base, condition : str
        As of ``axisymmetric.Slab``.
    """

    half_sides: tuple[float, float]
    half_extents: tuple[float, float]
    base: str = "bonded"
    condition: str = "bonded"

    def __post_init__(self) -> None:
        if self.base not in BASES:
            raise InputError(f"base = '{self.base}' is not one of {', '.join(BASES)}")
        if self.condition not in CONDITIONS:
            raise InputError(f"condition = '{self.condition}' is not one of {', '.join(CONDITIONS)}")
        for side, extent in zip(self.half_sides, self.half_extents):
            if not 0.05 <= side <= 20.0:
                raise out_of_range("half side of the punch over thickness", side, 0.05, 20.0)
            if not extent >= 1.5 * side:
                raise InputError(
                    f"slab over punch = {extent / side:.3g} is below 1.5 along one side; "
                    "the punch must stay away from the slab's rim"
                )

    @property
    def radius(self) -> float:
        """Radius of the circle with the punch's area."""
        return float(2.0 * np.sqrt(self.half_sides[0] * self.half_sides[1] / np.pi))

    @property
    def extent(self) -> float:
        """Radius of the circle with the slab's area."""
        return float(2.0 * np.sqrt(self.half_extents[0] * self.half_extents[1] / np.pi))

    @property
    def middle_extents(self) -> tuple[float, float]:
        """Half sides of the square slab of equal area, for a square punch: on it and on its own a punch has the same
        number of cells.
        """
        if self.half_sides[0] != self.half_sides[1]:
            return self.half_extents
        return (float(np.sqrt(self.half_extents[0] * self.half_extents[1])),) * 2

    @property
    def mirrors(self) -> bool:
        """Whether x and y may be exchanged: half of a quarter is then enough."""
        return self.half_sides[0] == self.half_sides[1] and self.half_extents[0] == self.half_extents[1]

    @property
    def scale(self) -> float:
        """The smaller of equal-area radius and thickness, over the thickness."""
        return min(self.radius, 1.0)


@dataclass(frozen=True)
class Cells:
    """Corner cell in units of the smaller of punch radius and thickness, and growth away from it."""

    corner: float = 0.12
    growth: float = 2.0


def _levels(scale: float, cells: Cells) -> Array:
    return -space.lines(1.0, cells.corner * scale, cells.growth)[::-1]


def _grid(block: Block, cells: Cells) -> tuple[Array, Array, Array]:
    # Of a square and its twin the corner cell is then the same share of the punch.
    first = cells.corner * block.scale * SIDE_OVER_RADIUS
    x, y = (
        space.lines_around(side, extent, first, cells.growth, middle)
        for side, extent, middle in zip(block.half_sides, block.half_extents, block.middle_extents)
    )
    return x, y, _levels(block.scale, cells)


def lattice_of(block: Block, cells: Cells) -> Array:
    """Place of every cell of :func:`block_problem` in its tensor grid, shape (3, cells)."""
    x, y, z = _grid(block, cells)
    return np.indices((len(z) - 1, len(x) - 1, len(y) - 1)).reshape(3, -1)


def block_problem(block: Block, law: Law, poisson: float, cells: Cells, folded: bool = False) -> Problem:
    """The quarter of a slab under a rectangular punch; its force is a quarter of the whole.

    Parameters
    ----------
    block : Block
        Slab and punch in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    cells : Cells
        Corner cell and growth.
    folded : bool
        Half of the quarter, whose force is an eighth, where ``block`` mirrors.
    """
    part = space.quarter(*_grid(block, cells), folded)
    mesh = part.mesh
    under = np.all(mesh.nodes[:2] <= np.array(block.half_sides)[:, None] + _TOLERANCE, axis=0)
    solver = partial(Dissection, position=part.lattice)
    return _problem(mesh, under, mesh.nodes[:2] < _TOLERANCE, block, Solid(mesh, law, poisson), solver)


def twin_problem(block: Block, law: Law, poisson: float, cells: Cells) -> Problem:
    """The axisymmetric slab under the round punch of equal area, on the same cells in r and z.

    Parameters
    ----------
    block, law, poisson, cells
        As for :func:`block_problem`.
    """
    r = space.lines_around(block.radius, block.extent, cells.corner * block.scale, cells.growth)
    points, quads = space.rectangle_plan(r, _levels(block.scale, cells))
    mesh = plane.discretise(points, quads)
    under = mesh.nodes[0] <= block.radius + _TOLERANCE
    return _problem(mesh, under, mesh.nodes[:1] < _TOLERANCE, block, Solid(mesh, law, poisson), Pattern)


def _problem(
    mesh: Discretisation, under: Array, symmetry: Array, block: Block, solid: Solid, solver: Callable[..., Any]
) -> Problem:
    """Hold the planes of symmetry, base and face; ``symmetry`` is bool per horizontal direction and node."""
    dimension = len(mesh.nodes)
    held = np.zeros((mesh.nodes.shape[1], dimension), dtype=bool)
    held[:, :-1] = symmetry.T
    base = np.nonzero(np.abs(mesh.nodes[-1] + 1.0) < _TOLERANCE)[0]
    face = np.nonzero(under & (np.abs(mesh.nodes[-1]) < _TOLERANCE))[0]
    held[base] |= np.array([block.base == "bonded"] * (dimension - 1) + [True])
    if block.condition == "bonded":
        held[face, :-1] = True
    last = dimension - 1
    return Problem(solid, held.ravel(), dimension * face + last, dimension * base + last, solver=solver)


@dataclass(frozen=True)
class Ratios:
    """Force under the rectangle over that under its round twin, at relative depths that both reached soundly.

    ``first`` is the ratio at first touch. ``solver`` counts unknowns, load steps, Newton iterations and seconds.
    """

    depth: Array
    ratio: Array
    first: float
    smallest_J: Array
    solver: dict[str, Any]


def depth_of_corner(block: Block, cells: Cells) -> float:
    """Depth over thickness beyond which the corner cells of a glued punch have folded, by experience."""
    return 1.3 * cells.corner**0.55 * block.scale


def solve_ratios(
    block: Block,
    law: Law,
    poisson: float,
    depths: Array,
    cells: Cells,
    progress: Callable[[float], None] | None = None,
) -> Ratios:
    """Follow a rectangular punch and its round twin on the same cells through ``depths`` (in thicknesses).

    Depths at which a corner cell is near folding (volume ratio at a quadrature point below 0.2, in either)
    are left out: from there on the force shows the collapse of one cell, at another depth in each of the two.

    Parameters
    ----------
    block, law, poisson, cells
        As for :func:`block_problem`.
    depths : ndarray, shape (n,)
        Increasing, positive; none for the ratio at first touch alone.
    progress : callable, optional
        Called with each depth that the three-dimensional solve has reached.
    """
    folded = block.mirrors
    problems = block_problem(block, law, poisson, cells, folded), twin_problem(block, law, poisson, cells)
    parts = 8.0 if folded else 4.0
    first = parts * problems[0].stiffness() / problems[1].stiffness()
    steps = (0.08 * block.scale, 0.15 * block.scale, 0.02 * block.scale)
    reports = (progress, None)
    paths = [follow(problem, depths, *steps, report, SOUND_J) for problem, report in zip(problems, reports)]
    return ratios_of(paths, first, SOUND_J, parts)


def ratios_of(paths: list[Path], first: float, sound_J: float, parts: float) -> Ratios:
    """Force of all ``parts`` of a slab over that of its round reference, at the depths both reached soundly.

    Parameters
    ----------
    paths : list of Path
        That in space and that in axisymmetry.
    first : float
        Ratio at first touch.
    sound_J : float
        Smallest volume ratio at a quadrature point that counts as sound.
    parts : float
        How many of the part that was solved the slab has.

    Returns
    -------
    Ratios
    """
    count = min(len(path.depth) for path in paths)
    smallest = np.minimum(*(path.smallest_J[:count] for path in paths))
    sound = np.logical_and.accumulate(smallest >= sound_J)
    ratio = parts * paths[0].force[:count] / paths[1].force[:count]
    return Ratios(paths[0].depth[:count][sound], ratio[sound], first, smallest[sound], cost(paths))
