"""Force of a pad of any shape under a flat punch in space, by finite elements at finite strain.

The pad stands between its base (or a rigid bone) and its tested face, both height fields; the grid of a slab is
mapped to it column by column. The punch is a rectangle or a disc with a fillet at its edge, without a wall behind
it, and may land beside the pad's highest point. Depth counts from the level of the highest point.

The grid is uniform under the punch, finer at its edge and, on pads that are touched at one place, at the first
touch; outside it grows. A kink of a height field (the foot of a cap) lies inside cells and is rounded by them.
Every plane of symmetry that a punch leaves is used: a quarter of the pad when it is centred, half when it is
beside the centre along one side.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES, CONDITIONS
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.pad.contact.stiffness import SHAPED_PAD_IN_SPACE
from dummydesign.pad.contact.surface_spatial import BeadedPunch, FaceContact, rectangle_punch, round_punch
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.shaped.fold import FOLDED
from dummydesign.pad.shaped.fold_in_space import SpatialFace, watched
from dummydesign.pad.shaped.paths import climb as climb_round
from dummydesign.pad.shaped.paths import first_depth
from dummydesign.pad.shaped.problem import CELLS, RIMS, Press
from dummydesign.pad.shaped.spatial_mesh import Grid, Load, axis_lines, levels
from dummydesign.pad.slab.problem import PadCurve, normalise
from dummydesign.pad.solve.continuation import Path, cost
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.solve.solver_multifrontal import Dissection

Array = np.ndarray

# Contact stiffness in shear moduli over the cell, and grip as a share of it.
CONTACT_STIFFNESS, GRIP_SHARE = SHAPED_PAD_IN_SPACE.contact, SHAPED_PAD_IN_SPACE.grip_share
# How far beyond the punch the surface may come to touch it, in units of the smaller of punch and thickness.
REACH = 0.8
# Depths at which a round twin is looked at for folds, in thicknesses.
LOOKED_AT = 0.02


def shaped_problem(load: Load, law: Law, grid: Grid) -> Problem:
    """The meshed part of the pad under the punch; the force of the whole is ``load.multiplicity`` times its.

    Parameters
    ----------
    load : Load
        Pad and punch in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    grid : Grid
        Cells under the punch, their growth, and the edge fillet.

    Returns
    -------
    Problem
    """
    x, y = (axis_lines(load, grid, axis) for axis in (0, 1))
    rim = grid.rim * load.scale
    coarse = float(min(load.half_sides) / grid.cells)
    z = levels(load, grid)

    def bend(places: Array) -> Array:
        bone, face = load.heights(places[0], places[1])
        return np.stack([places[0], places[1], face + (bone - face) * -places[2]])

    mesh = space.discretise(space.extrude(*space.rectangle_plan(x, y), z), bend)
    shape = (len(z) - 1, len(x) - 1, len(y) - 1)
    lattice = np.indices(shape).reshape(3, -1)
    layers = load.shape.layers()
    if layers is not None and not load.homogeneous:
        # All terms of the energy scale alike; the pressure is then counted in the moduli of its layer.
        lower = z[lattice[0] + 1] <= -layers[0] / load.thickness_mm + 1e-9
        mesh = replace(mesh, weight=mesh.weight * np.where(lower, layers[1], 1.0)[:, None])
    faces = space.horizontal_faces(mesh, np.nonzero(lattice[0] == shape[0] - 1)[0])
    base = np.unique(space.horizontal_faces(mesh, np.nonzero(lattice[0] == 0)[0], upper=False))
    held = np.zeros((mesh.nodes.shape[1], 3), dtype=bool)
    for axis in (0, 1):
        if load.offset[axis] == 0.0:
            held[mesh.nodes[axis] < 1e-9, axis] = True
    held[base] |= np.array([load.base == "bonded"] * 2 + [True])
    if load.base != "bonded" and np.ptp(load.heights(mesh.nodes[0, base], mesh.nodes[1, base])[0]) > 0.0:
        raise InputError("base = 'sliding' is not built for a pad with a bone; take bonded")
    middle = np.abs(mesh.nodes[:2, faces[:, 4]] - np.array(load.offset)[:, None])
    faces = faces[np.all(middle <= np.array(load.half_sides)[:, None] + REACH * load.scale, axis=0)]
    strength = np.full(len(faces), CONTACT_STIFFNESS * law.shear_MPa / coarse)
    grip = GRIP_SHARE * strength * (load.condition == "bonded")
    surface, punch = FaceContact(mesh.nodes, faces, strength, grip), _punch(load, rim)
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    on_face = np.unique(faces)
    touching = on_face[punch.gap(mesh.nodes[:, on_face].T, 0.0)[0] < 1e-12]
    carried = 3 * touching + 2 if load.shape.flat_top else None
    solver = partial(Dissection, position=lattice)
    nothing = np.array([], dtype=int)
    return Problem(
        Solid(mesh, law, load.poisson), held.ravel(), nothing, 3 * base + 2, surface, punch, carried, solver=solver
    )


def climb(
    load: Load, law: Law, depths: Array, grid: Grid, progress: Callable[[float], None] | None = None
) -> Path:
    """Follow a pad through depths, to where its face folds on to itself at the most.

    Parameters
    ----------
    load : Load
        Pad and punch in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    depths : ndarray, shape (n,)
        Increasing depths in thicknesses.
    grid : Grid
        Cells under the punch, their growth, and the edge fillet.
    progress : callable, optional
        Called with each solved depth.

    Returns
    -------
    Path
        Its forces are those of the meshed part.
    """
    problem = shaped_problem(load, law, grid)
    mesh = problem.solid.mesh
    top = np.arange(len(mesh.dofs))[-(len(axis_lines(load, grid, 0)) - 1) * (len(axis_lines(load, grid, 1)) - 1) :]
    mirrored = load.offset[0] == 0.0, load.offset[1] == 0.0
    face = SpatialFace(problem, space.horizontal_faces(mesh, top), mirrored, load.thickness_mm)
    return watched(problem, face, depths, 0.05 * load.scale, progress)


def _punch(load: Load, rim: float) -> BeadedPunch:
    if load.is_round:
        return round_punch(load.half_sides[0], rim, load.offset)
    return rectangle_punch(load.half_sides, rim, load.offset)


def solve_shaped_block(
    shape: PadShape,
    thickness_mm: float,
    punch: tuple[float, float] | float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    condition: str = "bonded",
    *,
    offset_mm: tuple[float, float] = (0.0, 0.0),
    base: str = "bonded",
    poisson: float = 0.5,
    slab_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM),
    law: Law | None = None,
    grid: Grid | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a shaped pad under a flat punch with a filleted edge.

    Parameters
    ----------
    shape : PadShape
        Height fields of the pad, its highest point over the origin.
    thickness_mm : float
        Thickness at the highest point. [mm]
    punch : (float, float) or float
        Half sides of a rectangular punch along length and width, or the radius of a round one. [mm]
    young_MPa : float
        Long-term modulus E; of the upper layer, of a layered pad. [MPa]
    depth_mm : sequence of float, or ndarray of shape (n,)
        Depths below the highest point, at most 0.6 thicknesses. [mm]
    condition : str
        ``bonded`` (what touches sticks) or ``frictionless``.
    offset_mm : (float, float)
        Where the punch's middle is, along length and width. [mm]
    base, poisson : str, float
        ``bonded`` or ``sliding``; Poisson's ratio, 0.5 for incompressible.
    slab_mm : (float, float)
        Length and width of the pad. [mm]
    law : Law, optional
        Shape of the hyperelastic law, neo-Hookean without it.
    grid : Grid, optional
        Cells; those of the stated error by default.
    progress : callable, optional
        Called with each solved depth over thickness.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. ``error_N`` is the change against
        cells about 1.5 times as large with the same fillet; what the fillet itself changes is not in it.

    Raises
    ------
    InputError
        For a bad value.
    NoAnswerError
        When no depth could be solved.
    """
    load, own, depths, unit = _load(
        shape, thickness_mm, punch, young_MPa, depth_mm, condition, offset_mm, base, poisson, slab_mm, law
    )
    grid = grid or Grid()
    wanted, folds = _open_depths(load, own, depths)
    coarse, fine = (_climb(load, own, wanted, fineness, progress) for fineness in (grid.coarser(), grid))
    force = fine.force * load.multiplicity * unit * thickness_mm**2
    share = _change(coarse.force, fine.force)
    return PadCurve(fine.depth * thickness_mm, force, force * share, cost([coarse, fine]), _notes(fine, depths, folds))


def _load(
    shape: PadShape, thickness_mm: float, punch: tuple[float, float] | float, young_MPa: float,
    depth_mm: Sequence[float], condition: str, offset_mm: tuple[float, float], base: str, poisson: float,
    slab_mm: tuple[float, float], law: Law | None,
) -> tuple[Load, Law, Array, float]:  # fmt: skip
    """What is pressed, in thicknesses, with the law of unit shear modulus, the depths, and the modulus. [MPa]"""
    is_round = not isinstance(punch, tuple | list)
    half_mm = (float(punch),) * 2 if is_round else tuple(float(side) for side in punch)
    own, depths, _, unit = normalise(thickness_mm, half_mm[0], young_MPa, depth_mm, poisson, law)
    load = Load(
        shape, float(thickness_mm), tuple(side / thickness_mm for side in half_mm),
        tuple(0.5 * side / thickness_mm for side in slab_mm), is_round,
        tuple(float(shift) / thickness_mm for shift in offset_mm), base, condition, poisson, float(depths[0]),
    )  # fmt: skip
    _check(load)
    return load, own, depths, unit


def _climb(load: Load, law: Law, depths: Array, grid: Grid, progress: Callable[[float], None] | None) -> Path:
    """Follow a pad through relative depths, one at least."""
    path = climb(load, law, depths, grid, progress)
    if not len(path.depth):
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {path.stop}")
    return path


def _change(coarse: Array, fine: Array) -> Array:
    """Relative change between two grids; where the coarse one did not get to, the largest that was seen."""
    both = min(len(coarse), len(fine))
    change = np.abs(coarse[:both] / fine[:both] - 1.0)
    return np.concatenate([change, np.full(len(fine) - both, change.max())])


def _open_depths(load: Load, law: Law, depths: Array) -> tuple[Array, str | None]:
    """Depths at which a round pad under the circle of the punch's area is open, and why the others are left out.

    Cells in space round a foot that is narrow beside them; those in a meridian plane resolve it, at little cost.
    """
    radius, extent = (2.0 * float(np.sqrt(np.prod(sides) / np.pi)) for sides in (load.half_sides, load.half_extents))
    radius = load.half_sides[0] if load.is_round else radius
    centred = load.offset == (0.0, 0.0) and extent >= 1.5 * radius
    if load.shape.flat_top or not load.shape.axisymmetric or not centred:
        return depths, None
    press = Press(
        load.shape, load.thickness_mm, radius, extent, load.base, load.condition, load.poisson, first_depth(depths)
    )
    # Looked at often, as a notch that is narrow is told by the state before.
    ends = np.union1d(depths, np.arange(LOOKED_AT, depths[-1], LOOKED_AT))
    path = climb_round(press, law, ends, CELLS, RIMS[0])
    if path.stop is None or not path.stop.startswith(FOLDED):
        return depths, None
    open_ones = depths[depths <= (path.depth[-1] if len(path.depth) else 0.0)]
    if not len(open_ones):
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {path.stop}")
    return open_ones, f"under the circle of the punch's area {path.stop}"


def _notes(path: Path, depths: Array, folds: str | None) -> tuple[str, ...]:
    stop = path.stop or folds
    return (f"solved to d/h = {path.depth[-1]:.3f} of {depths[-1]:.3f}: {stop}",) if stop else ()


def _check(load: Load) -> None:
    if load.base not in BASES:
        raise InputError(f"base = '{load.base}' is not one of {', '.join(BASES)}")
    if load.condition not in CONDITIONS:
        raise InputError(f"condition = '{load.condition}' is not one of {', '.join(CONDITIONS)}")
    for half, shift, extent in zip(load.half_sides, load.offset, load.half_extents):
        h = load.thickness_mm
        if not half > 0.0 or not np.isfinite(half):
            raise InputError(f"half side of the punch = {half * h:g} mm must be above 0")
        if not np.isfinite(shift) or abs(shift) + 1.3 * half > extent:
            raise InputError(
                f"punch of half side {half * h:g} mm, {shift * h:g} mm off the middle, leaves the pad of half "
                f"side {extent * h:g} mm or comes near its rim; take a smaller offset"
            )
