"""Force of a slab under a round flat punch, by axisymmetric finite elements at finite strain.

The edge of a sharp, glued punch shears the material without bound, so no mesh resolves it. The punch
here has a small bead of radius ``rim`` at its edge, with unilateral contact, and the reported force is
the limit of rim to 0, found from a ladder of rims each half the one before (see ``edge_limit``). A rim is
of use for depths that are large against its own scale (depth^2 > rim, both in units of the smaller of
punch radius and thickness); the small-depth limit comes from a sharp edge with quarter-point elements,
which is exact there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.errors import InputError, NoAnswerError, out_of_range
from dummydesign.pad import mesh as meshes
from dummydesign.pad.contact import FlatPunch, Surface
from dummydesign.pad.edge_limit import Samples, fit_limit
from dummydesign.pad.laws import Law, Yeoh
from dummydesign.pad.mesh import Resolution
from dummydesign.pad.newton import Path, Problem, follow
from dummydesign.pad.solid import Solid

Array = np.ndarray

# Rims of the ladder over the smaller of punch radius and thickness.
RIMS = tuple(0.1 * 0.5**k for k in range(6))
# Contact and film stiffness in shear moduli per rim; ten times either moves the limit by less than 0.1 %.
CONTACT_STIFFNESS = 3000.0
FILM_STIFFNESS = 300.0
FILM_REACH = 6.0
# A curve is solved on this many depths besides the wanted ones, and fitted by a series of this many terms.
GRID_POINTS = 12
SERIES_TERMS = 8
MAX_DEPTH_OVER_THICKNESS = 0.6
STANDARD_EXTENT_MM = float(np.sqrt(150.0 * 120.0 / np.pi))
BASES = ("bonded", "sliding")
CONDITIONS = ("bonded", "frictionless")


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
    """

    depth_mm: Array
    force_N: Array
    error_N: Array
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain lists and numbers."""
        return {k: v.tolist() if isinstance(v, np.ndarray) else v for k, v in asdict(self).items()}


def _held(mesh: Any, slab: Slab) -> Array:
    held = np.zeros(mesh.size, dtype=bool)
    held[2 * np.nonzero(meshes.on_axis(mesh))[0]] = True
    base = np.nonzero(meshes.on_base(mesh, 1.0))[0]
    held[2 * base + 1] = True
    if slab.base == "bonded":
        held[2 * base] = True
    return held


def _base(mesh: Any) -> Array:
    return 2 * np.nonzero(meshes.on_base(mesh, 1.0))[0] + 1


def _rings(box: float, smallest: float) -> int:
    return max(1, int(np.ceil(np.log2(box / smallest))))


def sharp_problem(slab: Slab, law: Law, poisson: float, resolution: Resolution, rings: int = 6) -> Problem:
    """The sharp-edged punch, for the small-strain limit: quarter-point elements at the edge.

    Lengths in thicknesses; the law's moduli set the unit of stress.
    """
    half_box = resolution.box * slab.scale
    points, quads, centre = meshes.web_mesh(slab.radius, 1.0, slab.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre, quarter_points=True)
    under = np.nonzero(meshes.on_top(mesh) & (mesh.nodes[0] <= slab.radius + 1e-9))[0]
    held = _held(mesh, slab)
    if slab.condition == "bonded":
        held[2 * under] = True
    return Problem(Solid(mesh, law, poisson), held, 2 * under + 1, _base(mesh))


def rimmed_problem(slab: Slab, law: Law, poisson: float, rim: float, resolution: Resolution) -> Problem:
    """The punch with a bead of radius ``rim`` (in thicknesses), glued or frictionless under its flat face.

    The face far from the edge moves with the punch node by node. Within six rims of the bead, and
    everywhere for a frictionless face, the surface is held by contact; a glued face is also held by the
    film, whose stiffness falls off over one rim towards the bead, and the bead grips what touches it.
    """
    punch = FlatPunch(slab.radius, rim)
    half_box = resolution.box * slab.scale
    rings = _rings(half_box, rim) + 2
    points, quads, centre = meshes.web_mesh(punch.flat_radius, 1.0, slab.extent, half_box, rings, resolution)
    mesh = meshes.discretise(points, quads, centre)
    solid = Solid(mesh, law, poisson)
    top, r = meshes.on_top(mesh), mesh.nodes[0]
    glued = slab.condition == "bonded"
    inner = max(punch.flat_radius - FILM_REACH * rim, 0.3 * punch.flat_radius)
    vertices = points[0][(np.abs(points[1]) < 1e-9) & (points[0] <= inner + 1e-9)]
    inner = vertices.max()
    under = np.nonzero(top & (r <= inner + 1e-9))[0]
    held = _held(mesh, slab)
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
    return Problem(solid, held, 2 * under + 1, _base(mesh), surface, punch, 2 * face + 1)


def first_stiffness(slab: Slab, law: Law, poisson: float = 0.5, resolution: Resolution | None = None) -> float:
    """Force per depth at first touch over E a, E = 3 mu, of a sharp-edged punch (dimensionless).

    For a frictionless face on a bonded base this is 2 kappa / (1 - nu^2) * (E / E') of the layer solution
    of Hayes et al., J. Biomech. 5 (1972) 541, at the same shear modulus.
    """
    problem = sharp_problem(slab, law, poisson, resolution or Resolution(cells=4))
    return problem.stiffness() / (3.0 * law.shear_MPa * slab.radius)


def climb(
    slab: Slab,
    law: Law,
    poisson: float,
    depths: Array,
    rim: float,
    resolution: Resolution,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Follow one rung of the ladder through ``depths`` (in thicknesses)."""
    problem = rimmed_problem(slab, law, poisson, rim, resolution)
    return follow(problem, depths, rim, 0.05 * slab.scale, 0.005 * slab.scale, progress)


def climb_all(
    slab: Slab,
    law: Law,
    poisson: float,
    depths: Array,
    rims: Sequence[float],
    resolution: Resolution,
    progress: Callable[[float], None] | None = None,
) -> tuple[Samples, list[Path]]:
    """Solve every rim (over scale) at the relative ``depths`` that are large against it.

    Returns
    -------
    Samples
        s = F / (E a d), E = 3 mu, at all depths that were reached.
    list of Path
        What each rung cost and why it stopped.
    """
    depth, rim_of, value, paths = [], [], [], []
    for rim in rims:
        wanted = depths[depths >= 0.8 * np.sqrt(rim) * slab.scale]
        if not len(wanted):
            continue
        path = climb(slab, law, poisson, wanted, rim * slab.scale, resolution, progress)
        paths.append(path)
        depth.append(path.depth)
        rim_of.append(np.full(len(path.depth), rim))
        value.append(path.force / (3.0 * law.shear_MPa * slab.radius * path.depth))
    joined = [np.concatenate(parts) if parts else np.array([]) for parts in (depth, rim_of, value)]
    return Samples(joined[0], np.full(len(joined[0]), slab.radius), joined[1], joined[2]), paths


def solve_curve(
    thickness_mm: float,
    radius_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float],
    *,
    base: str = "bonded",
    condition: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float | None = None,
    law: Law | None = None,
    resolution: Resolution | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a slab under a round, flat, sharp-edged punch at the wanted depths.

    Parameters
    ----------
    thickness_mm, radius_mm : float
        Thickness of the slab and radius of the punch. [mm]
    young_MPa : float
        Long-term Young's modulus E; the shear modulus is E / (2 (1 + nu)). [MPa]
    depth_mm : sequence of float
        Depths of the punch, >= 0, at most 0.6 thicknesses. [mm]
    base, condition : str
        ``bonded`` or ``sliding`` base; ``bonded`` or ``frictionless`` punch face.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    extent_mm : float, optional
        Outer radius of the slab; by default that of the circle with the area of 150 x 120 mm. [mm]
    law : Law, optional
        Shape of the hyperelastic law; it is scaled to the modulus. Neo-Hookean by default.
    progress : callable, optional
        Called with each relative depth that is solved.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing.

    Raises
    ------
    InputError
        For a value outside its range.
    NoAnswerError
        When no depth at all could be solved.
    """
    from dummydesign.pad.checks import positive

    positive("thickness_mm", thickness_mm)
    positive("radius_mm", radius_mm)
    positive("young_MPa", young_MPa)
    wanted = np.unique(np.asarray(depth_mm, dtype=float))
    limit = MAX_DEPTH_OVER_THICKNESS * thickness_mm
    if not len(wanted) or not np.isfinite(wanted).all() or wanted[0] < 0.0 or wanted[-1] > limit * (1.0 + 1e-9):
        worst = wanted[-1] if len(wanted) and np.isfinite(wanted[-1]) else "nothing"
        raise InputError(
            f"depth_mm = {worst} is outside the allowed range 0 to {limit:.4g} "
            f"({MAX_DEPTH_OVER_THICKNESS} of the thickness {thickness_mm} mm)"
        )
    a = radius_mm / thickness_mm
    extent = (STANDARD_EXTENT_MM if extent_mm is None else extent_mm) / thickness_mm
    slab = Slab(a, extent, base, condition)
    shape = law or Yeoh(1.0)
    shape = shape.scaled(1.0 / shape.shear_MPa)
    positive_depths = wanted[wanted > 0.0] / thickness_mm
    unit = young_MPa * 1.5 / (1.0 + poisson)  # E' = 3 mu of the law with this shear modulus
    if not len(positive_depths):
        nothing = {"unknowns": 0, "load_steps": 0, "newton_iterations": 0, "seconds": 0.0}
        return PadCurve(wanted, 0.0 * wanted, 0.0 * wanted, nothing)
    deepest = positive_depths[-1]
    even = deepest * np.linspace(0.0, 1.0, GRID_POINTS + 1)[1:]
    apart = np.abs(even[:, None] - positive_depths).min(axis=1) > 0.02 * deepest
    grid = np.union1d(positive_depths, even[apart])
    samples, paths = climb_all(slab, shape, poisson, grid, RIMS, resolution or Resolution(), progress)
    stops = [path.stop for path in paths if path.stop]
    reached = float(samples.depth.max()) if len(samples.depth) else 0.0
    if len(np.unique(samples.depth)) < 4:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {'; '.join(stops[:1]) or 'no depth'}")
    first = first_stiffness(slab, shape, poisson)
    limit = fit_limit(samples, np.array([a]), np.array([first]), (0.0, reached), None, (SERIES_TERMS, 1))
    notes = []
    if reached < deepest * (1.0 - 1e-9):
        notes.append(f"solved to d/h = {reached:.3f} of {deepest:.3f}: {stops[0]}")
    kept = positive_depths[positive_depths <= reached * (1.0 + 1e-9)]
    depth = kept * thickness_mm
    force = unit * radius_mm * depth * np.exp(limit.log_stiffness(kept, a))
    error = force * limit.error(kept, a)
    if wanted[0] == 0.0:
        depth, force, error = (np.concatenate([[0.0], x]) for x in (depth, force, error))
    solver = {
        "unknowns": max(p.unknowns for p in paths),
        "load_steps": sum(p.load_steps for p in paths),
        "newton_iterations": sum(p.newton_iterations for p in paths),
        "seconds": sum(p.seconds for p in paths),
    }
    return PadCurve(depth, force, error, solver, tuple(notes))
