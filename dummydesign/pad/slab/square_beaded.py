"""The punch with a fillet at its edge in space, and its axisymmetric twin: what carries a ratio to depth.

A sharp, glued corner cell folds (see ``square_sharp``). With a fillet of radius ``rim`` at the edge and contact that
sticks, as ``axisymmetric.rimmed_problem`` has it, the solve goes deeper. Rim and cells at the edge are alike in
both, in shares of each punch, so that the rim's and the mesh's error nearly cancel in the ratio.

The face far from the edge moves with the punch node by node; within ``FILM_CELLS`` cells of the fillet, and
beyond, the surface is held by contact.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from dummydesign.pad.contact.stiffness import BEADED_SQUARE
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch, Surface
from dummydesign.pad.contact.surface_spatial import BeadedPunch, FaceContact
from dummydesign.pad.fem import mesh_axisymmetric as plane
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Discretisation, Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.square_sharp import Block, Cells, Ratios, ratios_of
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.solve.solver_multifrontal import Dissection
from dummydesign.pad.tables.square import SIDE_OVER_RADIUS

Array = np.ndarray
_TOLERANCE = 1e-9

# Contact and grip in shear moduli per rim.
CONTACT_STIFFNESS = BEADED_SQUARE.contact
GRIP_STIFFNESS = BEADED_SQUARE.contact * BEADED_SQUARE.grip_share
# Cells inside the flat face's edge that are held by contact instead of moving with the punch.
FILM_CELLS = 1
# How far beyond the punch the surface may come to touch it, in units of the smaller of radius and thickness.
REACH = 0.8
# Largest load step in units of the smaller of radius and thickness.
LARGEST_STEP = 0.035
# Below this volume ratio at a quadrature point values are not used. Unlike a sharp corner's, a filleted edge's cells
# may be pressed flat without a change of the ratio: on thin pads it moves by less than 0.5 % from 0.5 to 0.03.
SOUND_J = 0.03


def _levels(scale: float, cells: Cells) -> Array:
    return -space.lines(1.0, cells.corner * scale, cells.growth)[::-1]


def _lines(edge: float, extent: float, middle: float, first: float, growth: float) -> tuple[Array, float]:
    """Lines finest around the flat face's edge, and the last of them that moves with the punch."""
    lines = space.lines_around(edge, extent, first, growth, middle)
    at = int(np.argmin(np.abs(lines - edge)))
    return lines, float(lines[max(at - FILM_CELLS, 0)])


def rimmed_block(
    block: Block, law: Law, poisson: float, cells: Cells, rim: float, folded: bool = False
) -> Problem:
    """The quarter of a slab under a rectangular punch with an edge fillet; its force is a quarter of the whole.

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
    rim : float
        Fillet radius over the smaller of radius and thickness, times half side over radius as the corner cell.
    folded : bool
        Half of the quarter, whose force is an eighth, where ``block`` mirrors.
    """
    first, bead = (share * block.scale * SIDE_OVER_RADIUS for share in (cells.corner, rim))
    core = (block.half_sides[0] - bead, block.half_sides[1] - bead)
    (x, last_x), (y, last_y) = (
        _lines(*ends, first, cells.growth) for ends in zip(core, block.half_extents, block.middle_extents)
    )
    part = space.quarter(x, y, _levels(block.scale, cells), folded)
    mesh, faces = part.mesh, part.faces
    under = np.all(mesh.nodes[:2] <= np.array([[last_x], [last_y]]) + _TOLERANCE, axis=0)
    middle = mesh.nodes[:2, faces[:, 4]]
    reach = np.array([[side + REACH * block.scale] for side in block.half_sides])
    near = ~under[faces].all(axis=1) & np.all(middle <= reach, axis=0)
    glued = block.condition == "bonded"
    strength = part.share[near] * law.shear_MPa / bead
    surface = FaceContact(
        mesh.nodes, faces[near], CONTACT_STIFFNESS * strength, glued * GRIP_STIFFNESS * strength, part.unknowns
    )
    face = np.all(mesh.nodes[:2] <= np.array(core)[:, None] + _TOLERANCE, axis=0)
    symmetry = mesh.nodes[:2] < _TOLERANCE
    punch = BeadedPunch(core, 0.0, bead)
    return _problem(
        mesh, block, Solid(mesh, law, poisson), under, face, symmetry, surface, punch,
        partial(Dissection, position=part.lattice),
    )  # fmt: skip


def rimmed_twin(block: Block, law: Law, poisson: float, cells: Cells, rim: float) -> Problem:
    """The axisymmetric slab under the round punch of equal area, with the same fillet on the same cells.

    Parameters
    ----------
    block, law, poisson, cells, rim
        As for :func:`rimmed_block`.
    """
    bead = rim * block.scale
    core = block.radius - bead
    r, last = _lines(core, block.extent, block.extent, cells.corner * block.scale, cells.growth)
    mesh = plane.discretise(*space.rectangle_plan(r, _levels(block.scale, cells)))
    top = plane.on_top(mesh)
    under = mesh.nodes[0] <= last + _TOLERANCE
    reach = block.radius + REACH * block.scale
    sides = plane.edges_on(mesh, top & (mesh.nodes[0] >= last - _TOLERANCE) & (mesh.nodes[0] <= reach))
    glued = block.condition == "bonded"
    strength = law.shear_MPa / bead
    surface = Surface(
        mesh.nodes, sides, lambda at: np.full_like(at, CONTACT_STIFFNESS * strength), np.zeros_like,
        glued * GRIP_STIFFNESS * strength, 0.0,
    )  # fmt: skip
    face = mesh.nodes[0] <= core + _TOLERANCE
    symmetry = mesh.nodes[:1] < _TOLERANCE
    punch = FlatPunch(block.radius, bead)
    return _problem(mesh, block, Solid(mesh, law, poisson), under, face, symmetry, surface, punch, None)


def _problem(
    mesh: Discretisation, block: Block, solid: Solid, under: Array, face: Array, symmetry: Array,
    surface: Any, punch: Any, solver: Any,
) -> Problem:  # fmt: skip
    """Hold the planes of symmetry, base and the inner face; what lies on the face at first touch sticks at once."""
    dimension = len(mesh.nodes)
    last = dimension - 1
    held = np.zeros((mesh.nodes.shape[1], dimension), dtype=bool)
    held[:, :last] = symmetry.T
    base = np.nonzero(np.abs(mesh.nodes[last] + 1.0) < _TOLERANCE)[0]
    top = np.abs(mesh.nodes[last]) < _TOLERANCE
    driven = np.nonzero(under & top)[0]
    held[base] |= np.array([block.base == "bonded"] * last + [True])
    if block.condition == "bonded":
        held[driven, :last] = True
    carried = dimension * np.nonzero(face & top)[0] + last
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    extra = {} if solver is None else {"solver": solver}
    return Problem(
        solid, held.ravel(), dimension * driven + last, dimension * base + last, surface, punch, carried, **extra
    )


def useful_depths(block: Block, depths: Array, rim: float) -> Array:
    """Depths that are large against the fillet's own scale: 4 depth^2 > rim, both in units of ``block.scale``.

    Parameters
    ----------
    block : Block
        Slab and punch.
    depths : ndarray, shape (n,)
        Depths in thicknesses.
    rim : float
        Fillet radius over ``block.scale``.

    Returns
    -------
    ndarray, shape (m,)
    """
    return depths[depths >= 0.5 * np.sqrt(rim) * block.scale]


def solve_rimmed_ratios(
    block: Block,
    law: Law,
    poisson: float,
    depths: Array,
    cells: Cells,
    rim: float,
    progress: Callable[[float], None] | None = None,
) -> Ratios:
    """Follow a filleted rectangular punch and its round twin on the same cells through ``depths`` (in thicknesses).

    Depths at which a cell is near folding (volume ratio at a quadrature point below ``SOUND_J``, in either) are
    left out. ``first`` of the answer is not a number: a fillet has no sharp edge at first touch.

    Parameters
    ----------
    block, law, poisson, cells, rim
        As for :func:`rimmed_block`.
    depths : ndarray, shape (n,)
        Increasing, in thicknesses.
    progress : callable, optional
        Called with each depth that the three-dimensional solve has reached.

    Returns
    -------
    Ratios
    """
    folded = block.mirrors
    problems = rimmed_block(block, law, poisson, cells, rim, folded), rimmed_twin(block, law, poisson, cells, rim)
    scale = block.scale
    # Points stick where they are at the end of a step: small ones, alike in both.
    steps = (0.3 * rim * scale, LARGEST_STEP * scale, 2e-3 * scale)
    paths = [follow(problem, depths, *steps, report, SOUND_J) for problem, report in zip(problems, (progress, None))]
    return ratios_of(paths, float("nan"), SOUND_J, 8.0 if folded else 4.0)
