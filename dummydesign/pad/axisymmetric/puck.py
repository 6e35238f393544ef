"""Compression of a cylinder between two rigid plates: frictionless, rough (Coulomb) or bonded.

Upper half of the cylinder, lengths in its height; the middle plane stays plane by symmetry. Plates without
friction leave the cylinder a cylinder. Rough and bonded plates make it bulge, and from some compression on
its side comes to lie on the plates: unilateral contact there, with the same friction.

Friction is Coulomb's, |t| <= mu p per reference area, in a regularised total form for a slip s since first
touch that never turns back, as in compression [1]:

    t = mu p s / sqrt(s^2 + e^2),   e = 2e-4 heights.

Contact is a penalty; its penetration is 1e-5 heights times the pressure in shear moduli. With bonded plates
the edge is a singular corner: its cells invert at some compression, where the curve ends with a note.

References
----------
.. [1] J. T. Oden, J. A. C. Martins, Comput. Methods Appl. Mech. Eng. 52 (1985) 527, section 4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.interface import FACES, FRICTION, Interface
from dummydesign.pad.axisymmetric.case import Case, round_problem, unsolved
from dummydesign.pad.contact.axisymmetric import PUCK_PLATES, RigidPunch, SideContact
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mixed_solid import STABILISATION
from dummydesign.pad.force_law import NO_COST, PadCurve
from dummydesign.pad.material.hyperelastic import Array, HyperelasticLaw
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.solve.continuation import ForcePath, cost, follow
from dummydesign.pad.solve.equilibrium import ContactProblem

PLATES = (*FACES, FRICTION)
SLIP_SCALE = 2e-4
# Smallest cells that are tried in turn when a curve stops early; a rough edge can fold a cell of one mesh.
CORNER_CELLS = (0.01, 0.02, 0.014, 0.03)
GROWTH = 1.4
MESH_ERROR = 5e-3


@dataclass(frozen=True)
class UnitPuck:
    """A cylinder of unit height, by its radius over height and its plates: frictionless, bonded or friction:MU."""

    radius: float
    plates: str = "frictionless"

    def __post_init__(self) -> None:
        if not 0.1 <= self.radius <= 10.0:
            raise out_of_range("puck radius over height", self.radius, 0.1, 10.0)
        _ = self.friction

    @property
    def friction(self) -> float:
        """Coefficient of friction; infinite when bonded."""
        interface = Interface.find(self.plates, FACES)
        if interface is None:
            message = f"plates = '{self.plates}' is not one of {', '.join(PLATES)} with MU from 0 to 5"
            raise InputError(message, "unknown_name", "plates", self.plates, PLATES)
        return interface.friction


class RoughPlate(SideContact):
    """The plate over the puck: a plane that comes down; for the end face and the side alike."""

    def __init__(self, nodes: Array, sides: Array, stiffness: float, friction: float, slip_scale: float) -> None:
        super().__init__(nodes, sides, 4)
        self._stiffness, self._friction, self._scale = stiffness, friction, slip_scale
        points = self.points(np.zeros(2 * nodes.shape[1]))
        self._touched = points[..., 1] > -1e-9
        self._spot = points[..., 0].copy()

    def settle(self, u: Array, punch: RigidPunch | None, depth: float) -> None:
        """Remember where points first touched, so that their slip is counted from there."""
        points = self.points(u)
        new = (points[..., 1] + depth >= 0.0) & ~self._touched
        self._spot[new] = points[..., 0][new]
        self._touched |= new

    def forces(self, u: Array, punch: RigidPunch | None, depth: float) -> tuple[Array, Array]:
        """Internal force (full length) and its derivative (per side) of contact and friction."""
        points = self.points(u)
        penetration = points[..., 1] + depth
        stiffness = np.where(penetration >= -1e-12, self._stiffness, 0.0) * self._area
        push = stiffness * np.maximum(penetration, 0.0)
        slip = points[..., 0] - self._spot
        held = self._touched
        second = np.zeros((*push.shape, 2, 2))
        if np.isinf(self._friction):
            # Held as strongly as it is kept out: bonded.
            hold = np.where(held, stiffness, 0.0)
            drag, second[..., 0, 0] = hold * slip, hold
        else:
            root = np.sqrt(slip**2 + self._scale**2)
            share = np.where(held, self._friction * slip / root, 0.0)
            drag = share * push
            second[..., 0, 0] = np.where(held, self._friction * push * self._scale**2 / root**3, 0.0)
            second[..., 0, 1] = share * stiffness
        second[..., 1, 1] = stiffness
        return self._assembled(u, np.stack([drag, push], axis=-1), second)


def puck_problem(
    puck: UnitPuck,
    law: HyperelasticLaw,
    poisson: float = 0.5,
    corner: float = CORNER_CELLS[0],
    slip_scale: float = SLIP_SCALE,
) -> ContactProblem:
    """Upper half of a cylinder of unit height under a plate; the plate's depth is half the compression."""
    r = meshes.graded(puck.radius, 0.0, corner, GROWTH)[::-1]
    z = meshes.graded(0.0, -0.5, corner, GROWTH)
    points, quads, _ = meshes.columns(r, -z)
    mesh = meshes.discretise(points, quads)
    top = np.nonzero(meshes.on_top(mesh))[0]
    middle = np.nonzero(meshes.on_base(mesh, 0.5))[0]
    # By symmetry the middle plane slides as on a base.
    case = Case(puck.radius, puck.radius, "sliding", puck.plates, law, poisson)
    if puck.friction == 0.0:
        return round_problem(mesh, case, top, stabilisation=STABILISATION, base=middle)
    sides, glued = meshes.edges_on(mesh, np.abs(mesh.nodes[0] - puck.radius) < 1e-9), top
    if puck.plates != "bonded":
        sides, glued = np.concatenate([meshes.edges_on(mesh, meshes.on_top(mesh)), sides]), top[:0]
    stiffness = PUCK_PLATES.contact * law.shear_MPa
    plate = RoughPlate(mesh.nodes, sides, stiffness, puck.friction, slip_scale)
    return round_problem(mesh, case, glued, plate, None, top, STABILISATION, middle)


def solve_puck(puck: Puck, compression_mm: Sequence[float] | Array) -> PadCurve:
    """Static force of a cylinder compressed between two rigid plates."""
    h = puck.thickness_mm
    wanted = np.unique(np.asarray(compression_mm, dtype=float))
    limit = MAX_DEPTH_OVER_THICKNESS * h
    if not len(wanted) or not np.isfinite(wanted).all() or wanted[0] < 0.0 or wanted[-1] > limit * (1.0 + 1e-9):
        raise InputError(
            f"compression_mm = {list(wanted)} is outside the allowed range 0 to {limit:.4g} "
            f"({MAX_DEPTH_OVER_THICKNESS} of the height {h} mm)",
            "out_of_range",
            "compression_mm",
            list(wanted),
            (0.0, limit),
        )
    unit = UnitPuck(0.5 * puck.diameter_mm / h, puck.plates)
    law = puck.shape
    relative, start = wanted[wanted > 0.0] / h, np.zeros(int(wanted[0] == 0.0))
    if not len(relative):
        return PadCurve(start, start, start, dict(NO_COST))
    inputs = {"puck": unit, "law": law, "poisson": puck.poisson, "compression": relative}
    made = cached("puck", inputs, lambda: _farthest(unit, law, puck.poisson, relative))
    force = np.concatenate([start, made["force"] * puck.young_MPa / (2.0 * (1.0 + puck.poisson)) * h**2])
    depth = np.concatenate([start, 2.0 * made["depth"] * h])
    return PadCurve(depth, force, MESH_ERROR * force, made["solver"], made["notes"])


def _farthest(puck: UnitPuck, law: HyperelasticLaw, poisson: float, compression: Array) -> dict[str, Any]:
    """The path of the mesh that gets farthest, tried in turn."""
    path = compress(puck, law, compression, poisson)
    for corner in CORNER_CELLS[1:]:
        if path.stop is None:
            break
        other = compress(puck, law, compression, poisson, corner)
        path = max(path, other, key=lambda one: len(one.depth))
    if not len(path.depth):
        raise unsolved(path.stop, "the puck")
    notes = (path.stop,) if path.stop else ()
    return {"depth": path.depth, "force": path.force, "solver": cost([path]), "notes": notes}


def compress(
    puck: UnitPuck,
    law: HyperelasticLaw,
    compression: Array,
    poisson: float = 0.5,
    corner: float = CORNER_CELLS[0],
    slip_scale: float = SLIP_SCALE,
) -> ForcePath:
    """Follow a puck of unit height through relative compressions; a Path whose depth is HALF of them."""
    problem = puck_problem(puck, law, poisson, corner, slip_scale)
    first = 0.02 if problem.surface is None else slip_scale
    return follow(problem, np.asarray(compression) / 2.0, first, 0.0125, 1e-4)
