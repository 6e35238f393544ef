"""A field of caps under the 14 x 14 mm punch, in space: what its table is made of.

Lattice, punch and pad mirror in both axes and in the diagonal, so an eighth is solved; the pad is taken as a square of
its width, far outside what the punch moves. Grid lines lie over the middles of the caps and half-way between them, so
that every cap of every pitch is cut into cells alike and what cells change is smooth over a table.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.geometry.standard import PAD_WIDTH_MM, PUNCH_SIDE_MM
from dummydesign.pad.contact.surface_spatial import FaceContact, rectangle_punch
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.shaped.fold_in_space import SpatialFace, watched
from dummydesign.pad.shaped.spatial import CONTACT_STIFFNESS, GRIP_SHARE, REACH
from dummydesign.pad.shaped.spatial_mesh import Load, graded_lines
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.solve.solver_multifrontal import Dissection
from dummydesign.pad.tables.fields.overlap import RIM

Array = np.ndarray

HALF_SIDE_MM = 0.5 * PUNCH_SIDE_MM
# Cells over half a pitch of the table's solves, and of the finer ones that say what cells change.
COARSE, FINER = 2, 3
# Pads of wide pitch take the cells of this one. [mm]
WIDEST_PITCH_MM = 8.0
# The smaller of half side and thickness over the height of the first cells, at a cell over half a pitch.
CELLS_DOWN = 3.0
GROWTH, SLOPE = 2.0, 1.0
# Cells at the middle tip over the others.
AT_TIP = 0.4
# The contact stiffness is that of cells of this share of the punch's half side.
STIFF_OVER = 6.0
PARTS = 8.0


def field_lines(pitch_mm: float, rim_mm: float, cells: int) -> Array:
    """Grid lines from the middle of a field to the rim of the pad, the same along both sides.

    Parameters
    ----------
    pitch_mm : float
        Of the lattice. [mm]
    rim_mm : float
        Fillet at the punch's edge, inside and outside of which lines lie. [mm]
    cells : int
        Over half a pitch.

    Returns
    -------
    ndarray, shape (lines,)
        From 0 to half the pad's width. [mm]
    """
    cell = 0.5 * min(pitch_mm, WIDEST_PITCH_MM) / cells
    fine, tip = min(cell, rim_mm), AT_TIP * cell
    edge = HALF_SIDE_MM + rim_mm * np.array([-1.0, 1.0])
    halves = 0.5 * pitch_mm * np.arange(1, int(2.0 * (HALF_SIDE_MM + pitch_mm) / pitch_mm) + 1)
    apart = np.abs(halves[:, None] - edge).min(axis=1) > 0.4 * fine
    halves = halves[apart & ((halves < edge[0]) | (halves > edge[1]))]
    far = max(edge[1], halves.max(initial=0.0))

    def size(x: Array) -> Array:
        near = fine + SLOPE * np.abs(x[:, None] - edge).min(axis=1)
        return np.minimum(np.minimum(near, tip + SLOPE * x), cell + SLOPE * np.maximum(x - far, 0.0))

    return graded_lines(0.0, 0.5 * PAD_WIDTH_MM, [*halves, *edge], size)


def field_problem(shape: Bumped, thickness_mm: float, cells: int) -> tuple[Problem, SpatialFace]:
    """An eighth of a field of caps under the punch, what touches sticks; unit shear modulus, lengths in thicknesses.

    Parameters
    ----------
    shape : Bumped
    thickness_mm : float
        At the highest point. [mm]
    cells : int
        Over half a pitch.

    Returns
    -------
    Problem, SpatialFace
    """
    h, law = thickness_mm, Yeoh(1.0)
    half, extent = (HALF_SIDE_MM / h,) * 2, (0.5 * PAD_WIDTH_MM / h,) * 2
    load = Load(shape, h, half, extent)
    rim = RIM * load.scale
    x = field_lines(shape.pitch_mm, rim * h, cells) / h
    z = -space.lines(1.0, load.scale / (CELLS_DOWN * cells), GROWTH)[::-1]

    def bend(places: Array) -> Array:
        bottom, face = load.heights(places[0], places[1])
        return np.stack([places[0], places[1], face + (bottom - face) * -places[2]])

    part = space.quarter(x, x, z, folded=True, bend=bend)
    mesh, nodes = part.mesh, part.mesh.nodes
    held = np.stack([nodes[0] < 1e-9, nodes[1] < 1e-9, np.zeros(nodes.shape[1], dtype=bool)], axis=1)
    base = np.nonzero(nodes[2] < -1.0 + 1e-9)[0]
    held[base] = True
    near = np.all(nodes[:2, part.faces[:, 4]] <= half[0] + REACH * load.scale, axis=0)
    strength = part.share[near] * CONTACT_STIFFNESS * law.shear_MPa * STIFF_OVER / half[0]
    surface = FaceContact(nodes, part.faces[near], strength, GRIP_SHARE * strength, part.unknowns)
    punch = rectangle_punch(half, rim)
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    solver, nothing = partial(Dissection, position=part.lattice), np.array([], dtype=int)
    solid = Solid(mesh, law, 0.5)
    made = Problem(solid, held.ravel(), nothing, 3 * base + 2, surface, punch, None, solver=solver)
    return made, SpatialFace(made, part.faces, (True, True), h, part.unknowns)


def press_field(shape: Bumped, thickness_mm: float, depths: Array, cells: int) -> tuple[Array, Array, str | None]:
    """Press a field of caps with the 14 x 14 mm punch, what touches sticks.

    Parameters
    ----------
    shape : Bumped
    thickness_mm : float
        At the highest point. [mm]
    depths : ndarray, shape (n,)
        Relative depths d / h, increasing from above 0. They are the ends of the load steps: every 0.02 is near enough
        (half of that moves the force by 0.6 % at most).
    cells : int
        Cells over half a pitch.

    Returns
    -------
    depth, area : ndarray
        Relative depths that were reached and F / E there. [-, mm2]
    stop : str or None
        Why it ended early.
    """
    h = thickness_mm
    path = watched(*field_problem(shape, h, cells), depths, 0.05 * min(HALF_SIDE_MM / h, 1.0))
    return path.depth, PARTS * path.force / 3.0 * h**2, path.stop
