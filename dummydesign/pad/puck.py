"""Compression of a cylinder between two rigid plates: frictionless, rough (Coulomb) or bonded.

Upper half of the cylinder, lengths in its height; the middle plane stays plane by symmetry. Plates without
friction leave the cylinder a cylinder. Rough and bonded plates make it bulge, and from some compression on
its side comes to lie on the plates: unilateral contact there, with the same friction.

Friction is Coulomb's, |t| <= mu p per reference area, in a regularised total form for a slip s since first
touch that never turns back, as in compression [1]:

    t = mu p s / sqrt(s^2 + e^2),   e = 2e-4 heights.

Contact is a penalty; its penetration is 1e-5 heights times the pressure in shear moduli. With bonded plates
the edge is a singular corner: its cells invert at some compression, where the curve ends and says so.

References
----------
.. [1] J. T. Oden, J. A. C. Martins, Comput. Methods Appl. Mech. Eng. 52 (1985) 527, section 4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.checks import positive
from dummydesign.core.errors import InputError, NoAnswerError, out_of_range
from dummydesign.geometry.interface import FACES, FRICTION, Interface
from dummydesign.pad.contact.stiffness import PUCK_PLATES
from dummydesign.pad.contact.surface_axisymmetric import Punch
from dummydesign.pad.contact.ties import NoTies
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_columns import columns
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law, Yeoh
from dummydesign.pad.slab.problem import PadCurve
from dummydesign.pad.solve.continuation import NOTHING, Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

PLATES = (*FACES, FRICTION)
SLIP_SCALE = 2e-4
CONTACT_STIFFNESS = PUCK_PLATES.contact
# Smallest cells that are tried in turn when a curve stops early; a rough edge can fold a cell of one mesh.
CORNER_CELLS = (0.01, 0.02, 0.014, 0.03)
GROWTH = 1.4
MAX_COMPRESSION = 0.6
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
        found = Interface.find(self.plates, FACES)
        if found is None:
            raise InputError(f"plates = '{self.plates}' is not one of {', '.join(PLATES)} with MU from 0 to 5")
        return found.friction


class RoughPlate(NoTies):
    """The plate over the puck: a plane that comes down; for the end face and the side alike.

    Has the methods of :class:`dummydesign.pad.contact.surface_axisymmetric.Surface`.
    """

    def __init__(self, nodes: Array, sides: Array, stiffness: float, friction: float, slip_scale: float) -> None:
        x, weight = np.polynomial.legendre.leggauss(4)
        self._shape = np.stack([x * (x - 1.0) / 2.0, 1.0 - x**2, x * (x + 1.0) / 2.0], axis=1)
        slope = np.stack([x - 0.5, -2.0 * x, x + 0.5], axis=1)
        place = np.moveaxis(nodes[:, sides], 0, -1)
        length = np.linalg.norm(np.einsum("qi,eic->eqc", slope, place), axis=-1)
        self._place = place
        self._area = 2.0 * np.pi * (place[..., 0] @ self._shape.T) * length * weight
        self._stiffness, self._friction, self._scale = stiffness, friction, slip_scale
        self.dofs = np.stack([2 * sides, 2 * sides + 1], axis=-1).reshape(len(sides), 6)
        points = self._points(np.zeros(2 * nodes.shape[1]))
        self._touched = points[..., 1] > -1e-9
        self._spot = points[..., 0].copy()

    def _points(self, u: Array) -> Array:
        moved = self._place + u[self.dofs].reshape(self._place.shape)
        return np.einsum("qi,eic->eqc", self._shape, moved)

    def settle(self, u: Array, punch: Punch | None, depth: float) -> None:
        """Remember where points first touched, so that their slip is counted from there.

        See :class:`dummydesign.pad.contact.ties.Contact`.
        """
        points = self._points(u)
        new = (points[..., 1] + depth >= 0.0) & ~self._touched
        self._spot[new] = points[..., 0][new]
        self._touched |= new

    def forces(self, u: Array, punch: Punch | None, depth: float) -> tuple[Array, Array]:
        """Internal force (full length) and its derivative (per side) of contact and friction.

        See :class:`dummydesign.pad.contact.ties.Contact`.
        """
        points = self._points(u)
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
        local = np.einsum("qi,eqc->eic", self._shape, np.stack([drag, push], axis=-1)).reshape(len(self.dofs), 6)
        matrix = np.einsum("qi,qj,eqab->eiajb", self._shape, self._shape, second, optimize=True)
        total = np.bincount(self.dofs.ravel(), local.ravel(), minlength=len(u))
        return total, matrix.reshape(len(local), 6, 6)


def puck_problem(
    puck: UnitPuck, law: Law, poisson: float = 0.5, corner: float = CORNER_CELLS[0], slip_scale: float = SLIP_SCALE
) -> Problem:
    """Upper half of a cylinder of unit height under a plate; the plate's depth is half the compression.

    Parameters
    ----------
    puck : Puck
        Radius over height, and what the plates do.
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    corner : float
        Size of the smallest cell, at the edge of the end face, in heights.
    slip_scale : float
        Slip over which Coulomb's friction is regularised, in heights.
    """
    r = meshes.graded(puck.radius, 0.0, corner, GROWTH)[::-1]
    z = meshes.graded(0.0, -0.5, corner, GROWTH)
    points, quads, _ = columns(r, -z)
    mesh = meshes.discretise(points, quads)
    top = np.nonzero(meshes.on_top(mesh))[0]
    middle = np.nonzero(meshes.on_base(mesh, 0.5))[0]
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    held[2 * middle + 1] = True
    solid = Solid(mesh, law, poisson)
    if puck.friction == 0.0:
        return Problem(solid, held, 2 * top + 1, 2 * middle + 1)
    side = np.abs(mesh.nodes[0] - puck.radius) < 1e-9
    sides = meshes.edges_on(mesh, side)
    none = np.array([], dtype=int)
    driven = none
    if puck.plates == "bonded":
        held[2 * top] = True
        driven = 2 * top + 1
    else:
        sides = np.concatenate([meshes.edges_on(mesh, meshes.on_top(mesh)), sides])
    stiffness = CONTACT_STIFFNESS * law.shear_MPa
    plate = RoughPlate(mesh.nodes, sides, stiffness, puck.friction, slip_scale)
    return Problem(solid, held, driven, 2 * middle + 1, plate, None, 2 * top + 1)


def solve_puck(
    diameter_mm: float,
    height_mm: float,
    young_MPa: float,
    compression_mm: Sequence[float] | Array,
    *,
    plates: str = "frictionless",
    poisson: float = 0.5,
    law: Law | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a cylinder compressed between two rigid plates.

    Parameters
    ----------
    diameter_mm, height_mm : float
        Of the undeformed cylinder. [mm]
    young_MPa : float
        Long-term Young's modulus E; the shear modulus is E / (2 (1 + nu)). [MPa]
    compression_mm : sequence of float, or ndarray of shape (n,)
        How much nearer the plates come, >= 0, at most 0.6 heights. [mm]
    plates : str
        ``frictionless``, ``bonded`` or ``friction:MU``.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    law : Law, optional
        Shape of the hyperelastic law, scaled to the modulus; neo-Hookean by default.
    progress : callable, optional
        Called with each compression over height that is solved.

    Returns
    -------
    PadCurve
        ``depth_mm`` is the compression. ``error_N`` is 0.5 % of the force, the largest difference to a
        mesh with half the corner cell; ``notes`` says why a curve stops early.

    Raises
    ------
    InputError
        For a value outside its range.
    NoAnswerError
        When no compression at all could be solved.
    """
    for name, value in (("diameter_mm", diameter_mm), ("height_mm", height_mm), ("young_MPa", young_MPa)):
        positive(name, value)
    wanted = np.unique(np.asarray(compression_mm, dtype=float))
    limit = MAX_COMPRESSION * height_mm
    if not len(wanted) or not np.isfinite(wanted).all() or wanted[0] < 0.0 or wanted[-1] > limit * (1.0 + 1e-9):
        raise InputError(
            f"compression_mm = {list(wanted)} is outside the allowed range 0 to {limit:.4g} "
            f"({MAX_COMPRESSION} of the height {height_mm} mm)"
        )
    shape = law or Yeoh(1.0)
    shape = shape.scaled(1.0 / shape.shear_MPa)
    puck = UnitPuck(0.5 * diameter_mm / height_mm, plates)
    relative = wanted[wanted > 0.0] / height_mm
    start = np.zeros(int(wanted[0] == 0.0))
    if not len(relative):
        return PadCurve(start, start, start, dict(NOTHING))
    inputs = {"puck": puck, "law": shape, "poisson": poisson, "compression": relative}
    found = cached("puck", inputs, lambda: _farthest(puck, shape, poisson, relative, progress))
    force = np.concatenate([start, found["force"] * young_MPa / (2.0 * (1.0 + poisson)) * height_mm**2])
    depth = np.concatenate([start, 2.0 * found["depth"] * height_mm])
    return PadCurve(depth, force, MESH_ERROR * force, found["solver"], found["notes"])


def _farthest(
    puck: UnitPuck, law: Law, poisson: float, compression: Array, progress: Callable[[float], None] | None
) -> dict[str, Any]:
    """The path of the mesh that gets farthest, tried in turn."""
    path = compress(puck, law, compression, poisson, progress=progress)
    for corner in CORNER_CELLS[1:]:
        if path.stop is None:
            break
        other = compress(puck, law, compression, poisson, corner, progress=progress)
        path = max(path, other, key=lambda one: len(one.depth))
    if not len(path.depth):
        raise NoAnswerError("no_convergence", f"the puck could not be solved: {path.stop}")
    notes = (path.stop,) if path.stop else ()
    return {"depth": path.depth, "force": path.force, "solver": cost([path]), "notes": notes}


def compress(
    puck: UnitPuck,
    law: Law,
    compression: Array,
    poisson: float = 0.5,
    corner: float = CORNER_CELLS[0],
    slip_scale: float = SLIP_SCALE,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Follow a puck of unit height through relative compressions; a Path whose depth is HALF of them.

    Parameters
    ----------
    puck, law, poisson, corner, slip_scale
        As for :func:`puck_problem`.
    compression : ndarray, shape (n,)
        Increasing, over the height.
    progress : callable, optional
        Called with each solved depth, half of the compression.
    """
    problem = puck_problem(puck, law, poisson, corner, slip_scale)
    first = 0.02 if problem.surface is None else slip_scale
    return follow(problem, np.asarray(compression) / 2.0, first, 0.0125, 1e-4, progress)
