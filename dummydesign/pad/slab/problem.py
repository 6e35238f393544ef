"""A slab under a round flat punch as a finite-element problem: with a sharp edge, or with a fillet at it.

The sharp edge with quarter-point elements is exact at first touch; at depth its corner cells invert.
The fillet makes the problem well-posed at any depth (see ``sharp_edge`` for the limit of small fillets).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.core.checks import positive
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.interface import BASES, CONDITIONS
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.contact.stiffness import GLUED_SLAB
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch, Surface
from dummydesign.pad.fem import mesh_axisymmetric as meshes
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.fem.mixed_solid import Solid
from dummydesign.pad.material.hyperelastic import Law, Yeoh
from dummydesign.pad.solve.continuation import Path
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

# Contact and film stiffness in shear moduli per rim.
CONTACT_STIFFNESS = GLUED_SLAB.contact
FILM_STIFFNESS = GLUED_SLAB.contact * GLUED_SLAB.grip_share
FILM_REACH = 6.0
# The energy term that keeps elements from inverting, in shear moduli, where a glued face ends in an edge: ten times as
# much stiffens the cells there and the pad by up to 1 % at d/h 0.45; a tenth of it changes no more than 0.2 %.
EDGE_STABILISATION = 1.0


@dataclass(frozen=True)
class Slab:
    """A slab and the punch on it, in thicknesses.

    Attributes
    ----------
    radius : float
        Radius of the punch over the thickness, a / h.
    extent : float
        Outer radius of the slab over the thickness.
    base : str
        ``bonded`` or ``sliding`` (no friction, no lift-off).
    condition : str
        Between punch and pad: ``bonded`` or ``frictionless``.
    """

    radius: float
    extent: float
    base: str = "bonded"
    condition: str = "bonded"

    def __post_init__(self) -> None:
        if self.base not in BASES:
            raise InputError(f"base = '{self.base}' is not one of {', '.join(BASES)}")
        if self.condition not in CONDITIONS:
            raise InputError(f"condition = '{self.condition}' is not one of {', '.join(CONDITIONS)}")
        if not 0.05 <= self.radius <= 20.0:
            raise out_of_range("punch radius over thickness", self.radius, 0.05, 20.0)
        if not self.extent >= 1.5 * self.radius:
            raise InputError(
                f"slab radius over punch radius = {self.extent / self.radius:.3g} is below 1.5; "
                "the punch must stay away from the slab's rim"
            )

    @property
    def scale(self) -> float:
        """The smaller of punch radius and thickness, over the thickness."""
        return min(self.radius, 1.0)


@dataclass(frozen=True)
class PadCurve:
    """Static force-depth curve of a pad.

    Attributes
    ----------
    depth_mm, force_N : ndarray
    error_N : ndarray
        Estimate of the numerical error of the force: mesh, scatter, and a share of what the
        extrapolation to a sharp edge added.
    solver : dict
        unknowns, load_steps, newton_iterations, seconds.
    notes : tuple of str
        Why the curve stops early, if it does.
    solved_error_N : ndarray, optional
        Where ``error_N`` counts what independent solutions differ by: the error without it.
    """

    depth_mm: Array
    force_N: Array
    error_N: Array
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()
    solved_error_N: Array | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists and numbers."""
        return {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in asdict(self).items()}


def held_unknowns(mesh: Any, slab: Slab) -> Array:
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    base = np.nonzero(meshes.on_base(mesh, 1.0))[0]
    held[2 * base + 1] = True
    if slab.base == "bonded":
        held[2 * base] = True
    return held


def base_unknowns(mesh: Any) -> Array:
    return 2 * np.nonzero(meshes.on_base(mesh, 1.0))[0] + 1


def _rings(box: float, smallest: float) -> int:
    return max(1, int(np.ceil(np.log2(box / smallest))))


def sharp_problem(
    slab: Slab, law: Law, poisson: float, resolution: Resolution, rings: int = 6, quarter_points: bool = True
) -> Problem:
    """The sharp-edged punch, for the small-strain limit: quarter-point elements at the edge.

    Parameters
    ----------
    slab : Slab
        Slab and punch in thicknesses.
    law : Law
        Its moduli set the unit of stress.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    resolution : Resolution
        Cells around the edge.
    rings : int
        Rings of cells around the edge, each half the size of the one outside.
    quarter_points : bool
        Without them and with few rings the edge is not resolved, but the solve goes deep: for what two slabs that
        differ far from the edge have over each other.

    Returns
    -------
    Problem
    """
    half_box = resolution.box * slab.scale
    points, quads, centre = meshes.web_mesh(slab.radius, 1.0, slab.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre, quarter_points)
    under = np.nonzero(meshes.on_top(mesh) & (mesh.nodes[0] <= slab.radius + 1e-9))[0]
    held = held_unknowns(mesh, slab)
    if slab.condition == "bonded":
        held[2 * under] = True
    return Problem(Solid(mesh, law, poisson, EDGE_STABILISATION), held, 2 * under + 1, base_unknowns(mesh))


def rimmed_problem(slab: Slab, law: Law, poisson: float, rim: float, resolution: Resolution) -> Problem:
    """The punch with a small fillet at its edge, glued or frictionless under its flat face.

    The face far from the edge moves with the punch node by node. Within six fillet radii of the fillet, and
    everywhere for a frictionless face, the surface is held by contact; a glued face is also held by the film, whose
    stiffness falls off over one radius towards the fillet, and what touches the fillet sticks to it.

    Parameters
    ----------
    slab, law, poisson, resolution
        As for :func:`sharp_problem`.
    rim : float
        Radius of the fillet, in thicknesses.

    Returns
    -------
    Problem
    """
    punch = FlatPunch(slab.radius, rim)
    half_box = resolution.box * slab.scale
    rings = _rings(half_box, rim) + 2
    points, quads, centre = meshes.web_mesh(punch.flat_radius, 1.0, slab.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre)
    solid = Solid(mesh, law, poisson, EDGE_STABILISATION)
    top, r = meshes.on_top(mesh), mesh.nodes[0]
    glued = slab.condition == "bonded"
    inner = max(punch.flat_radius - FILM_REACH * rim, 0.3 * punch.flat_radius)
    vertices = points[0][(np.abs(points[1]) < 1e-9) & (points[0] <= inner + 1e-9)]
    inner = vertices.max()
    under = np.nonzero(top & (r <= inner + 1e-9))[0]
    held = held_unknowns(mesh, slab)
    if glued:
        held[2 * under] = True
    reach = slab.radius + 0.8 * slab.scale
    sides = meshes.edges_on(mesh, top & (r >= inner - 1e-9) & (r <= reach))

    def film(radius: Array) -> Array:
        strength = FILM_STIFFNESS / rim * np.exp(np.minimum((punch.flat_radius - radius) / rim, FILM_REACH))
        return np.where(radius < punch.flat_radius, law.shear_MPa * strength, 0.0) * glued

    def stiffness(radius: Array) -> Array:
        return np.full_like(radius, law.shear_MPa * CONTACT_STIFFNESS / rim)

    grip = law.shear_MPa * FILM_STIFFNESS / rim * glued
    surface = Surface(mesh.nodes, sides, stiffness, film, grip, punch.flat_radius)
    face = np.nonzero(top & (r <= punch.flat_radius + 1e-9))[0]
    return Problem(solid, held, 2 * under + 1, base_unknowns(mesh), surface, punch, 2 * face + 1)


def first_stiffness(slab: Slab, law: Law, poisson: float = 0.5, resolution: Resolution | None = None) -> float:
    """Force per depth at first touch over E a, E = 3 mu, of a sharp-edged punch (dimensionless).

    For a frictionless face on a bonded base this is 2 kappa / (1 - nu^2) * (E / E') of the layer solution
    of Hayes et al., J. Biomech. 5 (1972) 541, at the same shear modulus.

    Parameters
    ----------
    slab, law, poisson, resolution
        As for :func:`sharp_problem`.

    Returns
    -------
    float
    """
    problem = sharp_problem(slab, law, poisson, resolution or Resolution(cells=4))
    return problem.stiffness() / (3.0 * law.shear_MPa * slab.radius)


def normalise(
    thickness_mm: float, length_mm: float, young_MPa: float, depth_mm: Sequence[float] | Array, poisson: float,
    law: Law | None,
) -> tuple[Law, Array, float, float]:
    """A pad's sizes, depths and law in thicknesses and shear moduli.

    Parameters
    ----------
    thickness_mm, length_mm : float
        Thickness, and a length that is to be expressed in it: radius or reach of the punch. [mm]
    young_MPa : float
        Long-term Young's modulus. [MPa]
    depth_mm : sequence of float, or ndarray of shape (n,)
        Depths, at most 0.6 thicknesses; 0 is left out. [mm]
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    law : Law or None
        Neo-Hookean by default.

    Returns
    -------
    law : Law
        With unit shear modulus.
    depths : ndarray, shape (m,)
        Increasing, in thicknesses.
    length, shear : float
        In thicknesses; shear modulus in MPa.

    Raises
    ------
    InputError
        For a size or depth outside its range.
    """
    for name, value in (("thickness_mm", thickness_mm), ("radius_mm", length_mm), ("young_MPa", young_MPa)):
        positive(name, value)
    depths = np.unique(np.asarray(depth_mm, dtype=float))
    limit = MAX_DEPTH_OVER_THICKNESS * thickness_mm
    depths = depths[depths != 0.0]
    if not len(depths) or not np.isfinite(depths).all() or depths[0] < 0.0 or depths[-1] > limit * (1.0 + 1e-9):
        worst = depths[-1] if len(depths) else "nothing"
        raise InputError(f"depth_mm = {worst} is outside the allowed range above 0 to {limit:.4g}")
    shape = law or Yeoh(1.0)
    shape = shape.scaled(1.0 / shape.shear_MPa)
    return shape, depths / thickness_mm, length_mm / thickness_mm, young_MPa / (2.0 * (1.0 + poisson))


def padded(path: Path, count: int) -> Array:
    """Forces of a path at all wanted depths, shape (count,); NaN where it did not get to."""
    return np.concatenate([path.force, np.full(count - len(path.force), np.nan)])


def held_on(values: Array) -> Array:
    """Largest value so far, carried over depths where it is not known (NaN); 1 % where it never is."""
    known = np.isfinite(values).any()
    return np.maximum.accumulate(np.nan_to_num(values, nan=0.0)) if known else np.full(len(values), 0.01)
