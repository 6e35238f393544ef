"""Force of a slab under a round flat punch, by axisymmetric finite elements at finite strain.

The edge of a sharp, glued punch shears the material without bound, so no mesh resolves it. The punch
here has a small bead of radius ``rim`` at its edge, with unilateral contact, and the reported force is
the limit of rim to 0, extrapolated from a ladder of rims each half the one before. A rim is good for
depths that are large against its own scale (depth^2 > rim, both in units of the smaller of punch radius
and thickness) and not too large for its mesh; the small-depth limit comes from a sharp edge with
quarter-point elements, which is exact there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.errors import InputError, NoAnswerError, out_of_range
from dummydesign.pad import mesh as meshes
from dummydesign.pad.contact import FlatPunch, Surface
from dummydesign.pad.laws import Law, Yeoh
from dummydesign.pad.mesh import Resolution
from dummydesign.pad.newton import Path, Problem, follow
from dummydesign.pad.solid import Solid

Array = np.ndarray

# Rims of the ladder over the smaller of punch radius and thickness.
RIMS = tuple(0.2 * 0.5**k for k in range(8))
# Contact and film stiffness in shear moduli per rim; ten times either moves the limit by less than 0.1 %.
CONTACT_STIFFNESS = 3000.0
FILM_STIFFNESS = 300.0
FILM_REACH = 6.0
# Relative error of one rung's mesh in the limit; measured by halving all cells (see VERIFICATION.md).
MESH_ERROR = 1e-3
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
        Estimate of the numerical error of the force: half of what the extrapolation to a sharp edge
        added, plus 0.1 % for the mesh.
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
    film, whose stiffness falls off over one rim towards the bead.
    """
    punch = FlatPunch(slab.radius, rim)
    half_box = resolution.box * slab.scale
    rings = _rings(half_box, rim) + 1
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
        return np.where(radius < punch.flat_radius + 2.0 * rim, law.shear_MPa * strength, 0.0) * glued

    def stiffness(radius: Array) -> Array:
        return np.full_like(radius, law.shear_MPa * CONTACT_STIFFNESS / rim)

    surface = Surface(mesh.nodes, sides, stiffness, film)
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
    return follow(problem, depths, rim, 0.05 * slab.scale, 0.002 * slab.scale, progress)


def _reach(slab: Slab, rim: float) -> float:
    """Depth over scale up to which the mesh of a rim is usually sound; beyond it only time is lost."""
    return float(np.sqrt(rim * np.clip(10.0 / slab.radius**1.2, 3.5, 40.0)))


def _from(rim: float) -> float:
    """Depth over scale from which a rim is small against the depth."""
    return float(np.sqrt(rim))


def sharp_limit(values: Sequence[float]) -> tuple[float, float]:
    """Extrapolate to rim 0 from values at rims each half the one before; return limit and error estimate.

    Three values give the ratio of successive differences (kept within 0.25 to 0.6), two take 1/2, the
    first-order behaviour of the force in the rim.
    """
    value = np.asarray(values, dtype=float)
    ratio = 0.5
    if len(value) >= 3 and value[-2] > value[-3]:
        ratio = float(np.clip((value[-1] - value[-2]) / (value[-2] - value[-3]), 0.25, 0.6))
    added = max(value[-1] - value[-2], 0.0) * ratio / (1.0 - ratio)
    return float(value[-1] + added), float(0.5 * added + MESH_ERROR * abs(value[-1]))


@dataclass(frozen=True)
class Ladder:
    """Dimensionless force F / (E a d) at relative depths d / h, with its error and the cost."""

    depth: Array
    stiffness: Array
    error: Array
    first: float
    paths: tuple[Path, ...]


def ladder(
    slab: Slab,
    law: Law,
    poisson: float,
    depths: Array,
    resolution: Resolution,
    progress: Callable[[float], None] | None = None,
) -> Ladder:
    """Force over E a d of the sharp-edged punch at relative ``depths`` > 0, in increasing order.

    Depths that no rung reaches are left out of the answer.
    """
    wanted = np.asarray(depths, dtype=float)
    shallow = _from(RIMS[-1]) * 1.02 * slab.scale
    anchors = shallow * np.array([1.0, 1.5])
    if wanted[0] >= anchors[1]:
        anchors = np.array([])
    grid = np.union1d(wanted[wanted >= shallow], anchors)
    modulus = 3.0 * law.shear_MPa
    table = np.full((len(RIMS), len(grid)), np.nan)
    paths = []
    for row, rim in enumerate(RIMS):
        use = (grid >= _from(rim) * slab.scale) & (grid <= _reach(slab, rim) * slab.scale)
        if not use.any():
            continue
        path = climb(slab, law, poisson, grid[use], rim * slab.scale, resolution, progress)
        paths.append(path)
        place = np.nonzero(use)[0][: len(path.depth)]
        table[row, place] = path.force / (modulus * slab.radius * path.depth)
    value, error = _combine(table)
    first = first_stiffness(slab, law, poisson) if len(anchors) else np.nan
    reached = np.isfinite(value)
    if len(anchors):
        # Below the finest rim the stiffness is a parabola through first touch and the two anchors.
        x, y = grid[reached][:2], value[reached][:2] - first
        curve = np.linalg.solve(np.stack([x, x**2], axis=1), y)
        low = wanted[wanted < shallow]
        value = np.concatenate([first + curve[0] * low + curve[1] * low**2, value])
        error = np.concatenate([np.full(len(low), MESH_ERROR * first), error])
        grid = np.concatenate([low, grid])
        reached = np.isfinite(value)
    keep = reached & np.isin(grid, wanted)
    return Ladder(grid[keep], value[keep], error[keep], float(first), tuple(paths))


def _combine(table: Array) -> tuple[Array, Array]:
    """Sharp limit per depth from a table (rims, depths) with gaps.

    Where one rim alone reaches, the relative correction it has at the nearest depth is used.
    """
    value, error = np.full(table.shape[1], np.nan), np.full(table.shape[1], np.nan)
    solved = np.isfinite(table)
    for column in np.nonzero(solved.sum(axis=0) >= 2)[0]:
        value[column], error[column] = sharp_limit(table[solved[:, column], column])
    extrapolated = np.isfinite(value)
    for column in np.nonzero(solved.sum(axis=0) == 1)[0]:
        row = int(np.argmax(solved[:, column]))
        known = np.nonzero(extrapolated & solved[row])[0]
        if len(known):
            nearest = known[np.argmin(np.abs(known - column))]
            correction = value[nearest] / table[row, nearest]
            value[column] = table[row, column] * correction
            error[column] = table[row, column] * (0.5 * (correction - 1.0) + 5.0 * MESH_ERROR)
    return value, error


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
    found = ladder(slab, shape, poisson, positive_depths, resolution or Resolution(), progress)
    stops = [path.stop for path in found.paths if path.stop]
    if not len(found.depth):
        raise NoAnswerError("no_convergence", "; ".join(stops[:1]) or "no depth could be solved")
    notes = []
    if len(found.depth) < len(positive_depths):
        notes.append(f"solved to d/h = {found.depth[-1]:.3f} of {positive_depths[-1]:.3f}: {(stops or [''])[0]}")
    depth = found.depth * thickness_mm
    scale = unit * radius_mm * depth
    force, error = scale * found.stiffness, scale * found.error
    if wanted[0] == 0.0:
        depth, force, error = (np.concatenate([[0.0], x]) for x in (depth, force, error))
    solver = {
        "unknowns": max(p.unknowns for p in found.paths),
        "load_steps": sum(p.load_steps for p in found.paths),
        "newton_iterations": sum(p.newton_iterations for p in found.paths),
        "seconds": sum(p.seconds for p in found.paths),
    }
    return PadCurve(depth, force, error, solver, tuple(notes))
