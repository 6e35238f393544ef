"""A field of caps under the 14 x 14 mm punch, in space: what its table is made of.

Lattice, punch and pad mirror in both axes and in the diagonal, so an eighth is solved; the pad is taken as a square of
its width, far outside what the punch moves. Grid lines lie over the middles of the caps and half-way between them, so
that every cap of every pitch is cut into cells alike and what cells change is smooth over a table.
"""

from __future__ import annotations

import numpy as np

from dummydesign.geometry.dimensions import PAD_WIDTH_MM, PUNCH_SIDE_MM
from dummydesign.geometry.shapes.bumped import Bumped
from dummydesign.pad.fem import mesh_hexahedra as space
from dummydesign.pad.solve.equilibrium import Problem
from dummydesign.pad.spatial.self_contact import SpatialFace, watched
from dummydesign.pad.spatial.shaped_pad import CONTACT_STIFFNESS, Load, contact_problem, graded_lines
from dummydesign.pad.tables.bumped import RIM

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
    """Grid lines from the middle of a field to the rim of the pad, the same along both sides. [mm]"""
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
    """
    h, half, extent = thickness_mm, HALF_SIDE_MM / thickness_mm, 0.5 * PAD_WIDTH_MM / thickness_mm
    load = Load(shape, h, (half, half), (extent, extent))
    rim = RIM * load.scale
    x = field_lines(shape.pitch_mm, rim * h, cells) / h
    z = -space.lines(1.0, load.scale / (CELLS_DOWN * cells), GROWTH)[::-1]
    part = space.quarter(x, x, z, folded=True, bend=load.bend)
    base = np.nonzero(part.mesh.nodes[2] < -1.0 + 1e-9)[0]
    strength = part.share * CONTACT_STIFFNESS * load.law.shear_MPa * STIFF_OVER / half
    made = contact_problem(load, part, base, strength, rim)
    return made, SpatialFace(made, part.faces, (True, True), h, part.unknowns)


def press_field(shape: Bumped, thickness_mm: float, depths: Array, cells: int) -> tuple[Array, Array, str | None]:
    """Press a field of caps with the 14 x 14 mm punch, what touches sticks."""
    h = thickness_mm
    path = watched(*field_problem(shape, h, cells), depths, 0.05 * min(HALF_SIDE_MM / h, 1.0))
    return path.depth, PARTS * path.force / 3.0 * h**2, path.stop
