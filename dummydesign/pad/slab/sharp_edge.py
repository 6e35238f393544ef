"""Force of a slab under a round flat punch, by axisymmetric finite elements at finite strain.

The edge of a sharp, glued punch shears the material without bound, so no mesh resolves it. The punch
here has a small fillet of radius ``rim`` at its edge, with unilateral contact, and the reported force is
the limit of rim to 0, found from a ladder of rims each half the one before (see ``edge_extrapolation``). A rim is
of use for depths that are large against its own scale (depth^2 > rim, both in units of the smaller of
punch radius and thickness); the small-depth limit comes from a sharp edge with quarter-point elements,
which is exact there.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.checks import positive
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS, PAD_EXTENT_MM
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.material.hyperelastic import Law, Yeoh
from dummydesign.pad.slab.edge_extrapolation import Samples, fit_limit
from dummydesign.pad.slab.problem import (
    PadCurve,
    Slab,
    first_stiffness,
    rimmed_problem,
    sharp_problem,
)
from dummydesign.pad.solve.continuation import NOTHING, Path, cost, follow
from dummydesign.pad.tables.edge_doubt import sharp_edge_doubt

Array = np.ndarray
__all__ = [
    "RIMS", "PadCurve", "Slab", "climb", "climb_all", "first_stiffness", "rimmed_problem", "sharp_problem",
    "solve_curve",
]  # fmt: skip

# Rims of the ladder over the smaller of punch radius and thickness, and the depth in that unit that every curve is
# solved to: over less the series has too few values with rims.
RIMS = tuple(0.1 * 0.5**k for k in range(6))
LEAST_DEPTH = 0.25
# Tangents that failed steps may cost before a rim's path ends: pads of 3.5 to 30 mm get as far as without a bound.
MOST_WASTED = 45
# A curve is solved on this many depths besides the wanted ones, and fitted by a series of this many terms.
GRID_POINTS = 12
SERIES_TERMS = 8
# Cells at the edge that are added where the path of the largest fillet ends early: their corner cell inverts later.
CLOSER = (1, 2)


def climb(
    slab: Slab,
    law: Law,
    poisson: float,
    depths: Array,
    rim: float,
    resolution: Resolution,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Follow the slab under a punch with one fillet.

    Parameters
    ----------
    slab, law, poisson, resolution
        As for :func:`dummydesign.pad.slab.problem.sharp_problem`.
    depths : ndarray, shape (n,)
        Increasing, in thicknesses.
    rim : float
        Radius of the fillet, in thicknesses.
    progress : callable, optional
        Called with each solved depth.

    Returns
    -------
    Path
    """
    problem = rimmed_problem(slab, law, poisson, rim, resolution)
    # Under a small rim the first touch is steep: steps down to a tenth of it.
    smallest = min(0.005 * slab.scale, 0.1 * rim)
    return follow(problem, depths, rim, 0.05 * slab.scale, smallest, progress, most_wasted=MOST_WASTED)


def climb_all(
    slab: Slab,
    law: Law,
    poisson: float,
    depths: Array,
    rims: Sequence[float],
    resolution: Resolution,
    progress: Callable[[float], None] | None = None,
) -> tuple[Samples, list[Path]]:
    """Solve every fillet at the depths that are large against it.

    Parameters
    ----------
    slab, law, poisson, resolution, progress
        As for :func:`climb`.
    depths : ndarray, shape (n,)
        Increasing, in thicknesses.
    rims : sequence of float
        Fillet radii over the smaller of punch radius and thickness.

    Returns
    -------
    Samples
        s = F / (E a d), E = 3 mu, at all depths that were reached.
    list of Path
        What each fillet cost and why it stopped.
    """
    depth, rim_of, value, paths = [], [], [], []
    for rim in rims:
        wanted = depths[depths >= 0.8 * np.sqrt(rim) * slab.scale]
        if not len(wanted):
            continue
        path = climb(slab, law, poisson, wanted, rim * slab.scale, resolution, progress)
        for more in CLOSER if rim == max(rims) else ():
            if path.stop is None:
                break
            closer = replace(resolution, cells=resolution.cells + more)
            path = _carried_on(path, climb(slab, law, poisson, wanted, rim * slab.scale, closer, progress))
        paths.append(path)
        depth.append(path.depth)
        rim_of.append(np.full(len(path.depth), rim))
        value.append(path.force / (3.0 * law.shear_MPa * slab.radius * path.depth))
    joined = [np.concatenate(parts) if parts else np.array([]) for parts in (depth, rim_of, value)]
    return Samples(joined[0], np.full(len(joined[0]), slab.radius), joined[1], joined[2]), paths


def _carried_on(path: Path, other: Path) -> Path:
    """A path, beyond its end that of another mesh made equal where both are known; their common cost.

    The reach of a curve is that of its largest fillet. Where that one's corner cell inverts no smaller step helps.
    """
    count = len(path.force)
    steps, seconds = path.load_steps + other.load_steps, path.seconds + other.seconds
    iterations = path.newton_iterations + other.newton_iterations
    if not count or len(other.force) <= count:
        return replace(path, load_steps=steps, newton_iterations=iterations, seconds=seconds)
    force = np.concatenate([path.force, other.force[count:] * path.force[-1] / other.force[count - 1]])
    return replace(other, force=force, load_steps=steps, newton_iterations=iterations, seconds=seconds)


def solve_curve(
    thickness_mm: float,
    radius_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
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
    depth_mm : sequence of float, or ndarray of shape (n,)
        Depths of the punch, >= 0, at most 0.6 thicknesses. [mm]
    base, condition : str
        ``bonded`` or ``sliding`` base; ``bonded`` or ``frictionless`` punch face.
    poisson : float
        Poisson's ratio; 0.5 is incompressible.
    extent_mm : float, optional
        Outer radius of the slab; by default that of the circle with the area of 150 x 120 mm. [mm]
    law : Law, optional
        Shape of the hyperelastic law; it is scaled to the modulus. Neo-Hookean by default.
    resolution : Resolution, optional
        Cells around the edge; those of the stated error by default.
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
    extent = (PAD_EXTENT_MM if extent_mm is None else extent_mm) / thickness_mm
    slab = Slab(radius_mm / thickness_mm, extent, base, condition)
    shape = law or Yeoh(1.0)
    shape = shape.scaled(1.0 / shape.shear_MPa)
    depths = wanted[wanted > 0.0] / thickness_mm
    if not len(depths):
        return PadCurve(wanted, 0.0 * wanted, 0.0 * wanted, dict(NOTHING))
    cells = resolution or Resolution()
    inputs = {"slab": slab, "law": shape, "poisson": poisson, "depths": depths, "resolution": cells}
    found = cached("slab", inputs, lambda: _relative_curve(slab, shape, poisson, depths, cells, progress))
    unit = young_MPa * 1.5 / (1.0 + poisson)  # E' = 3 mu of the law with this shear modulus
    depth = depths[: len(found["stiffness"])] * thickness_mm
    force = unit * radius_mm * depth * found["stiffness"]
    error, own = force * found["error"], force * found["own"]
    if wanted[0] == 0.0:
        depth, force, error, own = (np.concatenate([[0.0], x]) for x in (depth, force, error, own))
    return PadCurve(depth, force, error, found["solver"], found["notes"], own)


def _relative_curve(
    slab: Slab, law: Law, poisson: float, depths: Array, resolution: Resolution,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:  # fmt: skip
    """s = F / (E a d) and its relative error at the first of the relative ``depths``, those that were reached."""
    deepest = max(depths[-1], LEAST_DEPTH * slab.scale)
    even = deepest * np.linspace(0.0, 1.0, GRID_POINTS + 1)[1:]
    apart = np.abs(even[:, None] - depths).min(axis=1) > 0.02 * deepest
    grid = np.union1d(depths, even[apart])
    samples, paths = climb_all(slab, law, poisson, grid, RIMS, resolution, progress)
    stops = [path.stop for path in paths if path.stop]
    reached = float(samples.depth.max()) if len(samples.depth) else 0.0
    if len(np.unique(samples.depth)) < 4:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {'; '.join(stops[:1]) or 'no depth'}")
    first = np.array([first_stiffness(slab, law, poisson)])
    limit = fit_limit(samples, np.array([slab.radius]), first, (0.0, reached), None, (SERIES_TERMS, 1))
    notes: tuple[str, ...] = ()
    if reached < depths[-1] * (1.0 - 1e-9):
        notes = (f"solved to d/h = {reached:.3f} of {depths[-1]:.3f}: {stops[0]}",)
    kept = depths[depths <= reached * (1.0 + 1e-9)]
    stiffness = np.exp(limit.log_stiffness(kept, np.array(slab.radius)))
    own = limit.error(kept, slab.radius)
    error = own
    if slab.condition == "bonded":
        error = np.maximum(own, sharp_edge_doubt(kept, np.array(slab.radius)))
    return {"stiffness": stiffness, "error": error, "own": own, "solver": cost(paths), "notes": notes}
