"""Unilateral contact of a slab with a rigid axisymmetric punch: frictionless, rough or sticking.

The whole face is in contact that opens and closes; the pad is pushed by it alone. Use this for shaped
punches, and for flat ones that are not glued; the sharp, glued punch has its own way (``sharp_edge``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.contact.resting_base import Both, RestingBase, weight_over_shear
from dummydesign.pad.contact.stiffness import PROFILE_PUNCH, SLIDING_EDGE
from dummydesign.pad.contact.surface_axisymmetric import ProfilePunch, Punch, Surface
from dummydesign.pad.contact.ties import Contact
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_axisymmetric import graded
from dummydesign.pad.fem.mesh_columns import columns
from dummydesign.pad.fem.mixed_solid import STABILISATION, Solid
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.problem import PadCurve, held_on, normalise, padded
from dummydesign.pad.solve.continuation import Path, cost, follow
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Contact stiffness in shear moduli per cell, of a profile and of a flat punch that slides.
SHAPED_STIFFNESS, EDGE_STIFFNESS = PROFILE_PUNCH.contact, SLIDING_EDGE.contact
SLIP_SCALE = 0.02
# Cells from the axis to a profile's reach, and how large they may be over their radius: uniform ones move the force by
# 0.1 %. Four of them lie in the contact at the first depth, where that is less than a sixth of the reach.
CELLS, SHARE = 24, 0.08
TIP_CELLS = 6.0
# Stated besides a third of what cells of twice the size change: together more than what half the size changes.
LEAST_ERROR = {"frictionless": 2e-3, "bonded": 3e-3, "friction": 5e-3}
# Load steps in thicknesses of contact that remembers its path: half of them move a force by at most 0.27 %.
STEP = 0.005


def sphere(radius: float) -> ProfilePunch:
    """A ball of a given radius; points beyond 0.98 of it are carried on straight."""
    edge = 0.98 * radius
    end = np.sqrt(radius**2 - edge**2)

    def height(r: Array) -> tuple[Array, Array, Array, Array]:
        inside = np.clip(r, 0.0, edge)
        root = np.sqrt(radius**2 - inside**2)
        slope = inside / root
        beyond = np.maximum(r - edge, 0.0)
        second, third = radius**2 / root**3, 3.0 * radius**2 * inside / root**5
        return radius - root + beyond * edge / end, slope, *(np.where(r < edge, x, 0.0) for x in (second, third))

    return ProfilePunch(height)


def profile(radius: Sequence[float] | Array, height: Sequence[float] | Array) -> ProfilePunch:
    """A punch through points (r, z(r)) measured from its lowest point, joined by a smooth curve.

    Raises
    ------
    InputError
        When radii do not start at 0 and increase, or heights do not start at 0.
    """
    from scipy.interpolate import PchipInterpolator

    r, z = np.asarray(radius, dtype=float), np.asarray(height, dtype=float)
    if len(r) < 3 or len(r) != len(z) or r[0] != 0.0 or np.any(np.diff(r) <= 0.0) or not np.isfinite(z).all():
        raise InputError("a punch profile needs at least 3 points with radii that start at 0 and increase")
    if abs(z[0]) > 1e-9 or z.min() < -1e-9:
        raise InputError(f"punch profile height = {z.min():.4g} at its lowest; it must start at 0 on the axis and rise")
    # Mirrored at the axis, so that the curve is flat there.
    curve = PchipInterpolator(np.concatenate([-r[:0:-1], r]), np.concatenate([z[:0:-1], z]))
    slope, second, third = (curve.derivative(order) for order in (1, 2, 3))

    def height_at(at: Array) -> tuple[Array, Array, Array, Array]:
        inside = np.clip(at, 0.0, r[-1])
        steep = slope(inside)
        bent = (np.where(at <= r[-1], part(inside), 0.0) for part in (second, third))
        return curve(inside) + (at - inside) * steep, steep, *bent

    return ProfilePunch(height_at)


@dataclass(frozen=True)
class Region:
    """Where the surface is meshed finely: from ``start`` to ``stop`` with cells of size ``cell`` (thicknesses).

    With ``share`` cells may be as large as that share of their radius: a contact that grows from the axis is then
    resolved alike at every depth.
    """

    start: float
    stop: float
    cell: float
    share: float = 0.0

    def lines(self) -> Array:
        """Radii of the cells' ends, shape (n,)."""
        if not self.share:
            return np.linspace(self.start, self.stop, max(2, round((self.stop - self.start) / self.cell)) + 1)
        r = [self.start]
        while r[-1] < self.stop:
            r.append(r[-1] + max(self.cell, self.share * r[-1]))
        return self.start + (np.array(r) - self.start) * (self.stop - self.start) / (r[-1] - self.start)


def indentation_problem(
    punch: Punch,
    region: Region,
    extent: float,
    law: Law,
    poisson: float = 0.5,
    base: str = "bonded",
    condition: str = "frictionless",
    growth: float = 1.3,
    stiffness: float = EDGE_STIFFNESS,
    weight: float = 0.0,
    stabilisation: float = STABILISATION,
) -> Problem:
    """A slab of unit thickness under a rigid punch, contact over the whole top.

    Parameters
    ----------
    punch : Punch
        In thicknesses; touches the slab at (0, 0) first.
    region : Region
        Where cells are small, and how small.
    extent : float
        Outer radius of the slab, in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    base : str
        ``bonded``, ``sliding`` (no lift-off) or ``friction:MU`` (rests on a plate by its weight).
    condition : str
        ``frictionless``, ``friction:MU`` or ``bonded`` (what touches sticks).
    growth : float
        Largest ratio of neighbouring cells outside the region.
    stiffness : float
        Contact stiffness in shear moduli per cell.
    weight : float
        Pressure of the pad's weight on the base in shear moduli; counts for ``base`` friction:MU only.
    stabilisation : float
        The energy term that keeps elements from inverting, in shear moduli.
    """
    face = Interface.parse(condition, "condition", FACES)
    support = Interface.parse(base, "base", BASES)
    cell = region.cell
    inner = graded(region.start, 0.0, cell, growth)[::-1] if region.start > 0.0 else np.array([0.0])
    fine = region.lines()
    outer = graded(region.stop, extent, max(cell, fine[-1] - fine[-2]), growth)
    r = np.concatenate([inner[:-1], fine, outer[1:]])
    z = graded(0.0, -1.0, cell, growth)
    points, quads, _ = columns(r, -z)
    mesh = meshes.discretise(points, quads)
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    below = np.nonzero(meshes.on_base(mesh, 1.0))[0]
    held[2 * below + 1] = support.coulomb is None
    held[2 * below] |= support.bonded
    sides = meshes.edges_on(mesh, meshes.on_top(mesh) & (mesh.nodes[0] <= region.stop + 0.5))
    contact = law.shear_MPa * stiffness

    def pushing(radius: Array) -> Array:
        return contact / np.maximum(cell, region.share * radius)

    surface: Contact = Surface(
        mesh.nodes, sides, pushing, np.zeros_like,
        contact / cell * float(face.bonded), 0.0, face.coulomb or 0.0, SLIP_SCALE * cell, ties_within_step=True,
    )  # fmt: skip
    # What touches at the start sticks or slips from where it is.
    surface.settle(np.zeros(mesh.size), punch, 0.0)
    if support.coulomb is not None:
        bottom = meshes.edges_on(mesh, meshes.on_base(mesh, 1.0))
        surface = Both(surface, RestingBase(mesh, bottom, law.shear_MPa, support.coulomb, weight))
    solid = Solid(mesh, law, poisson, stabilisation)
    return Problem(solid, held, np.array([], dtype=int), 2 * below + 1, surface, punch)


def press(
    problem: Problem, depths: Sequence[float] | Array, first_step: float, largest_step: float, lattice: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Path:  # fmt: skip
    """Follow the contact through depths; raise when not even the first is reached.

    Parameters
    ----------
    problem : Problem
        As :func:`indentation_problem` makes it.
    depths : sequence of float, or ndarray of shape (n,)
        Increasing depths in thicknesses.
    first_step, largest_step : float
        Load steps in thicknesses; the smallest is a 64th of the first.
    lattice : bool
        Whether the steps do not depend on the wanted depths: for contact that remembers its path.
    progress : callable, optional
        Called with each solved depth.

    Raises
    ------
    NoAnswerError
        With the reason, when no depth could be solved.
    """
    path = follow(problem, depths, first_step, largest_step, first_step / 64.0, progress, lattice=lattice)
    if not len(path.depth):
        raise NoAnswerError("no_convergence", f"contact could not be solved: {path.stop}")
    return path


def solve_shaped(
    punch: ProfilePunch,
    thickness_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    reach_mm: float,
    condition: str = "frictionless",
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    cells: int = CELLS,
) -> PadCurve:
    """Static force of a slab under a shaped punch (ball or profile), from first touch.

    Returns and errors are as for :func:`dummydesign.pad.slab.sliding_faces.solve_flat`. The stated error
    is a third of what cells of twice the size change, and 0.2 % without friction, 0.3 % where it sticks, else 0.5 %.

    Parameters
    ----------
    punch : ProfilePunch
        In mm.
    thickness_mm, young_MPa, depth_mm, condition, base, poisson, extent_mm, law
        As for :func:`dummydesign.pad.slab.sliding_faces.solve_flat`.
    reach_mm : float
        Radius that the contact will not exceed; cells of ``reach_mm / cells`` lie inside it. [mm]
    cells : int
        Cells from the axis to there.
    """
    shape, depths, reach, unit = normalise(thickness_mm, reach_mm, young_MPa, depth_mm, poisson, law)
    own = ProfilePunch(lambda r: _scaled(punch, r, thickness_mm))
    first, largest, lattice = load_steps(condition, float(depths[0]))
    extent, weight = extent_mm / thickness_mm, weight_over_shear(thickness_mm, unit)

    def meshed(cells: int) -> Problem:
        region = tip_region(own, reach, float(depths[0]), cells)
        return indentation_problem(
            own, region, extent, shape, poisson, base, condition, stiffness=SHAPED_STIFFNESS, weight=weight
        )

    path = press(meshed(cells), depths, first, largest, lattice)
    half = follow(meshed(max(4, cells // 2)), path.depth, first, largest, first / 64.0, lattice=lattice)
    # With cells of twice the size a smooth contact is wrong by four times as much.
    change = held_on(np.abs(np.log(padded(half, len(path.depth)) / path.force))) / 3.0
    error = LEAST_ERROR[condition.partition(":")[0]] + change
    notes = (path.stop,) if path.stop else ()
    force = path.force * unit * thickness_mm**2
    return PadCurve(path.depth * thickness_mm, force, error * force, cost([path, half]), notes)


def tip_region(punch: ProfilePunch, reach: float, first: float, cells: int) -> Region:
    """Cells under a profile punch, small enough at the axis for the contact at the first depth.

    Parameters
    ----------
    punch : ProfilePunch
    reach, first : float
        Radius that the contact will not exceed, and the smallest wanted depth. [thicknesses]
    cells : int
        Of the uniform size, from the axis to the reach.
    """
    r = np.geomspace(1e-4 * reach, reach, 400)
    # Where the surface, which rises to half of the depth at a ball's contact, meets the profile.
    tip = float(r[np.searchsorted(punch.height(r)[0], 0.5 * first).clip(0, len(r) - 1)])
    return Region(0.0, reach, min(reach, TIP_CELLS * tip) / cells, SHARE * CELLS / cells)


def load_steps(condition: str, first: float) -> tuple[float, float, bool]:
    """First and largest load step under a profile punch, and whether they are the same for all wanted depths.

    Parameters
    ----------
    condition : str
        As for :func:`indentation_problem`.
    first : float
        The smallest wanted depth. [thicknesses]
    """
    return (0.25 * first, 0.05, False) if condition == "frictionless" else (0.25 * STEP, STEP, True)


def _scaled(punch: ProfilePunch, r: Array, thickness_mm: float) -> tuple[Array, Array, Array, Array]:
    value, slope, second, third = punch.height(r * thickness_mm)
    return value / thickness_mm, slope, second * thickness_mm, third * thickness_mm**2
