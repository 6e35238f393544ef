"""Force of a shaped pad under a round flat punch, by axisymmetric finite elements at finite strain.

The pad stands from the base (or from a rigid bone) up to its tested face; both may be curved. A crowned pad
is touched at its apex first: depth 0 is there, the contact opens over the crown and may reach the flat around
it and the punch's edge later. The edge is a fillet of small radius, without a wall behind it.

A pad with a flat top has the sharp edge of a slab under its punch. Its force is the ratio to a homogeneous
slab on the same cells with the same fillet, times the slab's own sharp-edge force (``axisymmetric``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.material.hyperelastic import Law, Yeoh
from dummydesign.pad.shaped.fold import FOLDED
from dummydesign.pad.shaped.paths import Solved, climb, first_depth, grids
from dummydesign.pad.shaped.problem import CELLS, Press
from dummydesign.pad.slab.edge_extrapolation import carried_on
from dummydesign.pad.slab.filleted import check_fillet
from dummydesign.pad.slab.problem import PadCurve, held_on, normalise, padded
from dummydesign.pad.solve.continuation import NOTHING, Path, cost

Array = np.ndarray
__all__ = ["climb", "rough_shaped_pad", "sharp", "solve_shaped_pad"]

# From one fillet (RIMS) to the next of half the size the missing force falls by 0.42 (the power 1.25 of
# ``edge_extrapolation``), so this share of the last step is left.
LEFT_TO_SHARP = 0.42 / (1.0 - 0.42)
# Share of that extrapolation, and of the step to cells of half the size, that is stated as error.
EDGE_ERROR = 0.3
MESH_ERROR = 1.0
LEAST_ERROR = 2e-3


def rough_shaped_pad(
    shape: PadShape, thickness_mm: float, radius_mm: float, depth_mm: Sequence[float] | Array, *, solved: Solved,
    base: str = "bonded", extent_mm: float = PAD_EXTENT_MM,
) -> PadCurve:  # fmt: skip
    """Force of a round shaped neo-Hookean pad of unit modulus on the coarsest of the grids of :func:`solve_shaped_pad`.

    A third to a sixth of the work, to see which of several pads is worth the whole of it; the error is not stated.

    Parameters
    ----------
    shape, thickness_mm, radius_mm, depth_mm, base, extent_mm
        As for :func:`solve_shaped_pad`.
    solved : Solved
        Keeps what is solved.

    Raises
    ------
    NoAnswerError
        When no depth could be solved.
    """
    own, depths, ratio, unit = normalise(thickness_mm, radius_mm, 1.0, depth_mm, 0.5, None)
    first = first_depth(depths)
    press = Press(shape, float(thickness_mm), ratio, extent_mm / thickness_mm, base, first=first)
    press.check()
    grid = grids(CELLS, press)[-1]
    paths = [solved.path(press, own, depths, grid, False)]
    force = padded(paths[0], len(depths)) * unit * thickness_mm**2
    if shape.flat_top:
        slab = _slab_curve(press, 1.0, depths, None, None)
        paths.append(solved.path(press, own, depths, grid, True))
        count = len(slab.force_N)
        force = slab.force_N * padded(paths[0], len(depths))[:count] / padded(paths[1], len(depths))[:count]
    count = int(np.isfinite(force).sum())
    if not count:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {paths[0].stop}")
    return _curve(press, depths, force, np.full(len(depths), np.nan), count, paths, [path.stop or "" for path in paths])


def sharp(rough: Array, fine: Array) -> tuple[Array, Array]:
    """Values with fillets of 0.1 and 0.05 carried on to a sharp edge; NaN where a fillet did not get to.

    Where only one is known, the step between them is taken from the last depth at which both are.

    Returns
    -------
    value, added : ndarray
        The limit, and what it adds over the smaller fillet, relative.
    """
    step = np.log(fine / rough)
    known = np.isfinite(step)
    if known.any():
        at = np.arange(len(step))
        step = np.where(known, step, step[known][-1]) if at[known][-1] < at[-1] else np.where(known, step, 0.0)
    else:
        step = np.zeros(len(step))
    best = np.where(np.isfinite(fine), fine, rough * np.exp(step))
    return carried_on(best, step, LEFT_TO_SHARP), np.expm1(LEFT_TO_SHARP * step)


def solve_shaped_pad(
    shape: PadShape,
    thickness_mm: float,
    radius_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    condition: str = "bonded",
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    cells: int = CELLS,
    edge_mm: float = 0.0,
    progress: Callable[[float], None] | None = None,
    solved: Solved | None = None,
) -> PadCurve:
    """Static force of a round shaped pad under a round, flat punch with a sharp or filleted edge, from first touch.

    Parameters
    ----------
    shape : PadShape
        Round (``shape.axisymmetric``): slab, crowned, layered or boned.
    thickness_mm, radius_mm : float
        Thickness of the pad at its highest point and radius of the punch. [mm]
    young_MPa : float
        Long-term Young's modulus of the resin, the upper one of a layered pad. [MPa]
    depth_mm : sequence of float, or ndarray of shape (n,)
        Depths of the punch below the pad's highest point, above 0, at most 0.6 thicknesses. [mm]
    condition : str
        ``bonded`` (what touches sticks), ``frictionless`` or ``friction:MU``.
    base, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.sharp_edge.solve_curve`.
    cells : int
        Cells between the axis and the punch's edge, at least; half as many are solved for the error.
    edge_mm : float
        Radius of the fillet of the punch's edge, above which it has an upright side; 0 for a sharp edge. [mm]
    solved : Solved, optional
        Keeps what is solved on the way; what it holds of the same pad and depths already is not solved again.

    Returns
    -------
    PadCurve
        At the depths that were reached; ``notes`` says why if some are missing. The stated error is what
        cells of twice the size changed, 0.3 of what the sharp edge added, and 0.2 %. With a fillet nothing is added.

    Raises
    ------
    InputError
        For a value outside its range or a shape that is not round.
    NoAnswerError
        When no depth could be solved.
    """
    own, depths, ratio, unit = normalise(thickness_mm, radius_mm, young_MPa, depth_mm, poisson, law)
    press = Press(
        shape, float(thickness_mm), ratio, extent_mm / thickness_mm, base, condition, poisson, first_depth(depths),
        edge_mm / thickness_mm,
    )
    press.check()
    if edge_mm:
        check_fillet(edge_mm, radius_mm)
    solved = Solved() if solved is None else solved
    if shape.flat_top:
        return _over_slab(press, own, young_MPa, depths, cells, law, progress, solved)
    paths = [solved.path(press, own, depths, grid, False, progress) for grid in grids(cells, press)]
    rough, fine, half = (padded(path, len(depths)) for path in _three(paths))
    value, added = sharp(rough, fine)
    count = int(np.isfinite(value).sum())
    stops = [path.stop for path in paths[:-1] if path.stop]
    if not count:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {stops[0]}")
    error = LEAST_ERROR + EDGE_ERROR * np.abs(added) + MESH_ERROR * held_on(np.abs(np.log(half / fine)))
    return _curve(press, depths, value * unit * thickness_mm**2, error, count, paths, stops)


def _over_slab(
    press: Press, own: Law, young_MPa: float, depths: Array, cells: int, law: Law | None,
    progress: Callable[[float], None] | None, solved: Solved,
) -> PadCurve:  # fmt: skip
    """Force of a flat-topped pad: its ratio to the slab of the upper resin on twin grids, times the slab's force."""
    slab = _slab_curve(press, young_MPa, depths, law, progress)
    factors, paths = [], []
    if press.shape.plain:
        factors = [np.ones(len(depths))] * 3
    else:
        for grid in grids(cells, press):
            pair = [solved.path(press, own, depths, grid, twin, progress) for twin in (False, True)]
            factors.append(padded(pair[0], len(depths)) / padded(pair[1], len(depths)))
            paths += pair
    rough, fine, half = _three(factors)
    best = np.where(np.isfinite(fine), fine, rough)
    spread = np.abs(np.log(rough / fine)) + MESH_ERROR * np.abs(np.log(half / fine))
    error = slab.error_N / slab.force_N + 1e-3 + held_on(spread)[: len(slab.depth_mm)]
    count = min(int(np.isfinite(best).sum()), len(slab.depth_mm))
    stops = [path.stop for path in paths[:4] if path.stop] + list(slab.notes)
    if not count:
        raise NoAnswerError("no_convergence", f"the pad could not be solved: {stops[0]}")
    force = best[:count] * slab.force_N[:count]
    curve = _curve(press, depths, force, error, count, paths, stops)
    solver = {name: value + slab.solver[name] for name, value in curve.solver.items()}
    return replace(curve, solver={**solver, "unknowns": max(curve.solver["unknowns"], slab.solver["unknowns"])})


def _slab_curve(
    press: Press, young_MPa: float, depths: Array, law: Law | None, progress: Callable[[float], None] | None
) -> PadCurve:
    """Force of the slab of the upper resin under the same edge: from its table where it holds, else solved."""
    from dummydesign.pad.slab.filleted import solve_filleted
    from dummydesign.pad.slab.sharp_edge import solve_curve
    from dummydesign.pad.slab.sliding_faces import solve_flat
    from dummydesign.pad.tables.filleted import slab_table

    h, a = press.thickness_mm, press.radius * press.thickness_mm
    plain = press.condition == "bonded" and press.poisson == 0.5 and (law is None or law == Yeoh(law.shear_MPa))
    if plain and abs(press.extent * h / PAD_EXTENT_MM - 1.0) < 0.01:
        table = slab_table(press.base, press.edge * h, a)
        low, high = table.ratio_range
        if low <= press.radius <= high:
            depth = depths[depths <= table.depth_limit(press.radius) * (1.0 + 1e-9)] * h
            force = table.force(depth, h, young_MPa, a)
            notes = () if len(depth) == len(depths) else (f"the slab's table ends at {depth[-1] / h:.3f}",)
            return PadCurve(depth, force, table.relative_error(depth, h, a) * force, dict(NOTHING), notes)
    common = {
        "base": press.base, "poisson": press.poisson, "extent_mm": press.extent * h, "law": law, "progress": progress
    }  # fmt: skip
    if press.edge:
        return solve_filleted(h, a, press.edge * h, young_MPa, depths * h, **common)
    if press.condition == "bonded":
        return solve_curve(h, a, young_MPa, depths * h, **common)
    return solve_flat(h, a, young_MPa, depths * h, press.condition, **common)


def _three(found: list[Any]) -> list[Any]:
    """What was found with the large fillet, the small one, and large cells; a real fillet stands for the first two."""
    return found if len(found) == 3 else [found[0], *found]


def _curve(
    press: Press, depths: Array, force: Array, error: Array, count: int, paths: list[Path], stops: list[str]
) -> PadCurve:
    notes = ()
    if count < len(depths):
        # of several reasons the one that the user can do something about
        why = next((stop for stop in stops if stop.startswith(FOLDED)), stops[0])
        notes = (f"solved to d/h = {depths[count - 1]:.3f} of {depths[-1]:.3f}: {why}",)
    depth, value = depths[:count] * press.thickness_mm, force[:count]
    return PadCurve(depth, value, error[:count] * value, cost(paths) if paths else dict(NOTHING), notes)
