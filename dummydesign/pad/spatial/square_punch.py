"""A rectangular punch on a slab in space, sharp or filleted, with its round twin.

Its factor over the round twin is taken to the limit of small cells. Sharp edges with three corner cells carry it to
where the corner cell folds; edges with a fillet of two radii carry it on. Both are fitted together: one parabola or
cubic in depth, and what one unit of corner cell or fillet changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import InputError, NoAnswerError, out_of_range
from dummydesign.core.parsing import one_of
from dummydesign.geometry.interface import BASES, CONDITIONS
from dummydesign.pad.contact.axisymmetric import BEADED_SQUARE, AxisymmetricSurface, ContactSurface, FlatPunch
from dummydesign.pad.contact.spatial import BeadedPunch, FaceContact
from dummydesign.pad.fem import mesh_axisymmetric as plane
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Discretisation, Solid
from dummydesign.pad.material.hyperelastic import NEO_HOOKEAN, Array, HyperelasticLaw
from dummydesign.pad.solve.continuation import add_costs, cost, follow
from dummydesign.pad.solve.equilibrium import ContactProblem
from dummydesign.pad.solve.multifrontal import Dissection
from dummydesign.pad.solve.sparse import Pattern
from dummydesign.pad.tables.square import HELD_ERROR, SIDE_OVER_RADIUS

_TOLERANCE = 1e-9
# Below this volume ratio at a quadrature point the corner cell is about to fold.
SOUND_J = 0.2
# Grip in shear moduli per rim.
GRIP_STIFFNESS = BEADED_SQUARE.contact * BEADED_SQUARE.grip_share
# Cells inside the flat face's edge that are held by contact instead of moving with the punch.
FILM_CELLS = 1
# How far beyond the punch the surface may come to touch it, in units of the smaller of radius and thickness.
REACH = 0.8
# Largest load step in units of the smaller of radius and thickness.
LARGEST_STEP = 0.035
# Below this volume ratio at a quadrature point values are not used. Unlike a sharp corner's, a filleted edge's cells
# may be pressed flat without a change of the ratio: on thin pads it moves by less than 0.5 % from 0.5 to 0.03.
FILLETED_SOUND_J = 0.03


@dataclass(frozen=True)
class Block:
    """A pad under a punch and its material, lengths in thicknesses; a round punch has its radius in both half sides."""

    half_sides: tuple[float, float]
    half_extents: tuple[float, float]
    base: str = "bonded"
    condition: str = "bonded"
    law: HyperelasticLaw = NEO_HOOKEAN
    poisson: float = 0.5

    def __post_init__(self) -> None:
        one_of("base", self.base, BASES)
        one_of("condition", self.condition, CONDITIONS)

    @property
    def radius(self) -> float:
        """Radius of the circle with the punch's area."""
        return float(2.0 * np.sqrt(self.half_sides[0] * self.half_sides[1] / np.pi))

    @property
    def extent(self) -> float:
        """Radius of the circle with the pad's area."""
        return float(2.0 * np.sqrt(self.half_extents[0] * self.half_extents[1] / np.pi))


class SquareProblem(Block):
    """A rectangular punch on a rectangular slab."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for side, extent in zip(self.half_sides, self.half_extents):
            if not 0.05 <= side <= 20.0:
                raise out_of_range("half side of the punch over thickness", side, 0.05, 20.0)
            if not extent >= 1.5 * side:
                raise InputError(
                    f"slab over punch = {extent / side:.3g} is below 1.5 along one side; "
                    "the punch must stay away from the slab's rim",
                    "out_of_range",
                    "slab_over_punch",
                    extent / side,
                )

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
class CornerCells:
    """Corner cell in units of the smaller of punch radius and thickness, and growth away from it."""

    corner: float = 0.12
    growth: float = 2.0


def _grid(block: SquareProblem, cells: CornerCells, rim: float) -> tuple[list[Array], Array, Array]:
    """Lines of the grid along x, y and z, the edges of the flat face, and the lines up to which it is glued."""
    # Of a square and its twin the corner cell is then the same share of the punch.
    first, bead = (share * block.scale * SIDE_OVER_RADIUS for share in (cells.corner, rim))
    core = np.array([side - bead for side in block.half_sides])
    x, y = (
        space.lines_around(edge, extent, first, cells.growth, middle)
        for edge, extent, middle in zip(core, block.half_extents, block.middle_extents)
    )
    return [x, y, _levels(block, cells)], core, np.array([_last_glued(x, core[0], rim), _last_glued(y, core[1], rim)])


def _levels(block: SquareProblem, cells: CornerCells) -> Array:
    return -space.lines(1.0, cells.corner * block.scale, cells.growth)[::-1]


def _last_glued(lines: Array, edge: float, rim: float) -> float:
    """The line up to which the face moves with the punch: its edge, or inside it where that has a fillet."""
    return float(lines[max(int(np.argmin(np.abs(lines - edge))) - (FILM_CELLS if rim else 0), 0)])


def block_problem(block: SquareProblem, cells: CornerCells, rim: float = 0.0, folded: bool = False) -> ContactProblem:
    """The quarter of a slab under a rectangular punch, sharp or with a fillet; its force is a quarter of the whole."""
    (x, y, z), core, last = _grid(block, cells, rim)
    part = space.quarter(x, y, z, folded)
    mesh, faces = part.mesh, part.faces
    surface, punch = None, None
    if rim:
        bead = rim * block.scale * SIDE_OVER_RADIUS
        under = np.all(mesh.nodes[:2] <= last[:, None] + _TOLERANCE, axis=0)
        reach = np.array([[side + REACH * block.scale] for side in block.half_sides])
        near = ~under[faces].all(axis=1) & np.all(mesh.nodes[:2, faces[:, 4]] <= reach, axis=0)
        strength = part.share[near] * block.law.shear_MPa / bead
        grip = (block.condition == "bonded") * GRIP_STIFFNESS * strength
        surface = FaceContact(mesh.nodes, faces[near], BEADED_SQUARE.contact * strength, grip, part.unknowns)
        punch = BeadedPunch((float(core[0]), float(core[1])), 0.0, bead)
    return _problem(mesh, block, core, last, surface, punch, partial(Dissection, position=part.lattice))


def twin_problem(block: SquareProblem, cells: CornerCells, rim: float = 0.0) -> ContactProblem:
    """The axisymmetric slab under the round punch of equal area, with the same edge on the same cells in r and z."""
    bead = rim * block.scale
    core = block.radius - bead
    r = space.lines_around(core, block.extent, cells.corner * block.scale, cells.growth, block.extent if rim else None)
    last = _last_glued(r, core, rim)
    mesh = plane.discretise(*space.rectangle_plan(r, _levels(block, cells)))
    if not rim:
        return _problem(mesh, block, np.array([core]), np.array([last]), solver=Pattern)
    inside = (mesh.nodes[0] >= last - _TOLERANCE) & (mesh.nodes[0] <= block.radius + REACH * block.scale)
    strength = block.law.shear_MPa / bead
    surface = AxisymmetricSurface(
        mesh.nodes,
        plane.edges_on(mesh, plane.on_top(mesh) & inside),
        BEADED_SQUARE.contact * strength,
        grip=(block.condition == "bonded") * GRIP_STIFFNESS * strength,
        grip_from=0.0,
    )
    return _problem(mesh, block, np.array([core]), np.array([last]), surface, FlatPunch(block.radius, bead))


def _problem(
    mesh: Discretisation,
    block: SquareProblem,
    core: Array,
    last: Array,
    surface: ContactSurface | None = None,
    punch: Any = None,
    solver: Callable[..., Any] | None = None,
) -> ContactProblem:
    """Hold the planes of symmetry, base and inner face; what lies on the face at first touch sticks at once."""
    plan, level, dimension = mesh.nodes[:-1], mesh.nodes[-1], len(mesh.nodes)
    held = np.zeros((mesh.nodes.shape[1], dimension), dtype=bool)
    held[:, :-1] = (plan < _TOLERANCE).T
    base = np.nonzero(np.abs(level + 1.0) < _TOLERANCE)[0]
    driven, face = (
        np.nonzero(np.all(plan <= ends[:, None] + _TOLERANCE, axis=0) & (np.abs(level) < _TOLERANCE))[0]
        for ends in (last, core)
    )
    held[base] |= np.array([block.base == "bonded"] * (dimension - 1) + [True])
    if block.condition == "bonded":
        held[driven, :-1] = True
    if surface is not None:
        surface.settle(np.zeros(mesh.size), punch, 0.0)
    down, solid = dimension - 1, Solid(mesh, block.law, block.poisson)
    return ContactProblem(
        solid,
        held.ravel(),
        dimension * driven + down,
        dimension * base + down,
        surface,
        punch,
        dimension * face + down,
        solver=solver,
    )


@dataclass(frozen=True)
class Ratios:
    """Force under the rectangle over that under its round twin, at relative depths that both reached soundly.

    ``first`` is the ratio at first touch, NaN under a fillet. ``solver`` counts unknowns, load steps, Newton iterations
    and seconds.
    """

    depth: Array
    ratio: Array
    first: float
    smallest_J: Array
    solver: dict[str, Any]


def depth_of_corner(block: SquareProblem, cells: CornerCells) -> float:
    """Depth over thickness beyond which the corner cells of a glued punch have folded, by experience."""
    return 1.3 * cells.corner**0.55 * block.scale


def useful_depths(block: SquareProblem, depths: Array, rim: float) -> Array:
    """Depths that are large against the fillet's own scale: 4 depth^2 > rim, both in units of ``block.scale``."""
    return depths[depths >= 0.5 * np.sqrt(rim) * block.scale]


def solve_ratios(block: SquareProblem, depths: Array, cells: CornerCells, rim: float = 0.0) -> Ratios:
    """Follow a rectangular punch and its round twin on the same cells through ``depths`` (in thicknesses).

    Depths at which a cell is near folding (volume ratio at a quadrature point below ``SOUND_J``, in either) are left
    out: under a sharp edge the force shows the collapse of one cell, at another depth in each of the two.
    """
    parts, scale = 8.0 if block.mirrors else 4.0, block.scale
    problems = block_problem(block, cells, rim, block.mirrors), twin_problem(block, cells, rim)
    if rim:
        # Points stick where they are at the end of a step: small ones, alike in both.
        first, sound_J, steps = float("nan"), FILLETED_SOUND_J, (0.3 * rim * scale, LARGEST_STEP * scale, 2e-3 * scale)
    else:
        first = parts * problems[0].stiffness() / problems[1].stiffness()
        sound_J, steps = SOUND_J, (0.08 * scale, 0.15 * scale, 0.02 * scale)
    paths = [follow(problem, depths, *steps, sound_J) for problem in problems]
    count = min(len(path.depth) for path in paths)
    smallest = np.minimum(*(path.smallest_J[:count] for path in paths))
    sound = np.logical_and.accumulate(smallest >= sound_J)
    ratio = parts * paths[0].force[:count] / paths[1].force[:count]
    return Ratios(paths[0].depth[:count][sound], ratio[sound], first, smallest[sound], cost(paths))


polyval = np.polynomial.polynomial.polyval

CORNERS = (0.45, 0.3, 0.2)
STEP = 0.06
# Fillets, as large as the cells beside them.
RIMS = (0.28, 0.2)
# Scatter that is expected of a value besides its correction, for its weight: sharp and filleted edge.
MESH_ERROR = 5e-4
RIMMED_ERROR = 2e-3
# Share of its own correction by which an extrapolated factor may be off.
CORRECTION_ERROR = 0.5


@dataclass(frozen=True)
class FactorCurve:
    """ln factor as a polynomial in depth; corrections are what one unit of corner cell or fillet changes it by.

    Depths over thickness. ``reach_of_corner`` and ``reach_of_rim`` say how deep each size was solved, ``scatter``
    and ``rim_scatter`` by how much single values lie off. Beyond ``reach`` the factor is held and its error grows
    by ``HELD_ERROR`` per reach.
    """

    coefficients: Array
    correction: Array
    rim_correction: Array
    reach: float
    reach_of_corner: dict[float, float]
    reach_of_rim: dict[float, float]
    scatter: float
    rim_scatter: float
    solver: dict[str, Any]

    def factor(self, depth: Array) -> tuple[Array, Array]:
        """Factor and relative error at relative depths."""
        depth = np.maximum(np.asarray(depth, dtype=float), 0.0)
        inside = np.minimum(depth, self.reach)
        by_rim = 2.0 * self.rim_scatter + _off(inside, self.reach_of_rim, self.rim_correction)
        by_corner = 2.0 * self.scatter + _off(inside, self.reach_of_corner, self.correction)
        sharp = inside <= max(self.reach_of_corner.values(), default=0.0) * (1.0 + 1e-9)
        error = MESH_ERROR + np.where(sharp, by_corner, by_rim)
        return np.exp(polyval(inside, self.coefficients)), error + HELD_ERROR * (depth - inside) / self.reach


def _off(depth: Array, reach: dict[float, float], correction: Array) -> Array:
    """Share of its correction by which the finest size that reaches a depth may be off."""
    finest = np.full(depth.shape, max(reach, default=0.0))
    for size in sorted(reach, reverse=True):
        finest = np.where(depth <= reach[size] * (1.0 + 1e-9), size, finest)
    return CORRECTION_ERROR * np.abs(finest * polyval(depth, correction))


@one_blas_thread()
def solve_factor(block: SquareProblem, deepest: float) -> FactorCurve:
    """Solve a rectangular punch and its twin with several corner cells and fillets, and fit the limit at size 0."""
    outline = 1.0
    if not block.mirrors and block.middle_extents != block.half_extents:
        # Half of a quarter is enough on a square slab; what the true outline changes is that of first touch.
        square = replace(block, half_extents=block.middle_extents)
        outline, block = outline_factor(block, square), square
    step = min(STEP * block.scale, deepest / 4.0)
    sharp: dict[float, Ratios] = {}
    for corner in CORNERS:
        cells = CornerCells(corner)
        end = min(deepest, depth_of_corner(block, cells))
        count = max(1, round(end / step))
        depths: Array = end * np.arange(1, count + 1) / count
        sharp[corner] = solve_ratios(block, depths, cells)
    beaded: dict[float, Ratios] = {}
    if max(_reach(sharp).values()) < deepest * 0.999:
        # Values of fillets scatter: some more than the curve's own depths.
        depths = deepest * np.arange(1, 13) / 12.0
        for rim in RIMS:
            beaded[rim] = solve_ratios(block, useful_depths(block, depths, rim), CornerCells(rim), rim)
    curve = _fitted(sharp, beaded, step)
    return replace(curve, coefficients=curve.coefficients + np.log(outline) * np.eye(1, len(curve.coefficients))[0])


def outline_factor(block: SquareProblem, square: SquareProblem) -> float:
    """Force at first touch on a rectangular slab over that on the square one of its area, on the same cells."""
    cells = CornerCells(CORNERS[0])
    quarter, eighth = block_problem(block, cells), block_problem(square, cells, folded=True)
    return quarter.stiffness() / (2.0 * eighth.stiffness())


def _reach(runs: dict[float, Ratios]) -> dict[float, float]:
    return {size: float(run.depth[-1]) if len(run.depth) else 0.0 for size, run in runs.items()}


def _fitted(sharp: dict[float, Ratios], beaded: dict[float, Ratios], step: float) -> FactorCurve:
    reach, rim_reach = _reach(sharp), _reach(beaded)
    longest = max(*reach.values(), *rim_reach.values())
    if longest == 0.0:
        message = f"the punch's corner folds before d/h = {step:.3g}; no 3D factor"
        raise NoAnswerError("no_convergence", message, quantity="force_N")
    rows = [(d, f, c, 0.0) for c, run in sharp.items() for d, f in zip([0.0, *run.depth], [run.first, *run.ratio])]
    rows += [(d, f, 0.0, r) for r, run in beaded.items() for d, f in zip(run.depth, run.ratio)]
    depth, factor, corner, rim = np.array(rows).T
    value, share, is_sharp = np.log(factor), depth / longest, rim == 0.0
    terms = 4 if beaded else 3
    series = share[:, None] ** np.arange(terms)
    columns = np.concatenate([series, np.stack([corner, corner * share, rim, rim * share], axis=1)], axis=1)
    # Only the corrections are held back: two or three sizes do not settle them.
    damping = np.diag([0.0] * terms + [0.02] * 4) / MESH_ERROR
    weight = 1.0 / np.where(is_sharp, MESH_ERROR + 2e-3 * corner, RIMMED_ERROR + 5e-3 * rim)
    system = np.concatenate([columns * weight[:, None], damping])
    load = np.concatenate([value * weight, np.zeros(terms + 4)])
    solution, *_ = np.linalg.lstsq(system, load, rcond=None)
    misfit = value - columns @ solution
    runs = [*sharp.values(), *beaded.values()]
    solver = add_costs(*(run.solver for run in runs))
    own, corrections = solution[:terms], solution[terms:].reshape(2, 2)
    by_corner, by_rim = corrections / np.array([1.0, longest])
    scatter, rim_scatter = (
        float(np.sqrt(np.mean(part**2))) if len(part) else 0.0 for part in (misfit[is_sharp], misfit[~is_sharp])
    )
    own = own * longest ** -np.arange(float(terms))
    return FactorCurve(own, by_corner, by_rim, longest, reach, rim_reach, scatter, rim_scatter, solver)
