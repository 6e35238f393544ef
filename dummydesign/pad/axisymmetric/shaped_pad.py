"""Force of a shaped pad under a round flat punch, by axisymmetric finite elements at finite strain.

The pad stands from the base (or from a rigid bone) up to its tested face; both may be curved. A crowned pad
is touched at its apex first: depth 0 is there, the contact opens over the crown and may reach the flat around
it and the punch's edge later. The edge is a fillet of small radius, without a wall behind it.

A pad with a flat top has the sharp edge of a slab under its punch. Its force is the ratio to a homogeneous
slab on the same cells with the same fillet, times the slab's own sharp-edge force (``axisymmetric``).

A slab whose face or base slides: the ratio of its force to the glued slab's on one mesh, times the glued curve. An
edge fillet of 0.1 lowers the force by a few per cent, in the glued and in the sliding slab alike: with friction
their ratio changes by some tenths of a per cent when the fillet is halved, without by 0.2 to 2 %. So the ratio is
solved with two fillets and extrapolated with the power of ``edge_extrapolation``, and the glued curve is the limit
of ``sharp_edge``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.cache import cached
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.pad.axisymmetric.case import (
    Case,
    end_note,
    padded,
    relative_depths,
    solve_on_lattice,
    unsolved,
)
from dummydesign.pad.axisymmetric.filleted import filleted_problem, follow_filleted, solve_filleted
from dummydesign.pad.axisymmetric.profile_punch import edge_problem
from dummydesign.pad.axisymmetric.self_contact import FOLDED
from dummydesign.pad.axisymmetric.shaped_problem import (
    CELLS,
    RIMS,
    SOUND_J,
    Climb,
    PathCache,
    climb,
    grids,
    meshed,
    shaped_problem,
)
from dummydesign.pad.axisymmetric.sharp_edge import RIM_POWER, extrapolate_to_sharp, solve_curve
from dummydesign.pad.contact.friction import SLIP_SCALE
from dummydesign.pad.force_law import NO_COST, PadCurve
from dummydesign.pad.material.hyperelastic import Array, Yeoh
from dummydesign.pad.pad_under_punch import SLAB, Pad
from dummydesign.pad.solve.continuation import ForcePath, add_costs, cost, follow
from dummydesign.pad.tables.slab import POWER, slab_table

# The rest of a correction by one halving of the fillet.
LEFT = 1.0 / (2.0**RIM_POWER - 1.0)
# Error of the ratio from cells and contact: half the cells moved it by up to 0.3 % and 1 %.
GLUED_ERROR, SLIDING_ERROR = 3e-3, 1e-2


def solve_flat(pad: Pad, depth_mm: ArrayLike) -> PadCurve:
    """Static force of a slab under a flat, sharp-edged punch where the face, the base or both slide or rub."""
    depths = relative_depths(depth_mm, pad.thickness_mm)
    Interface.parse(pad.condition, "condition", FACES)
    Interface.parse(pad.base, "base", BASES)
    case = Case.of(pad)
    glued = solve_curve(replace(pad, base="bonded", condition="bonded"), depths * pad.thickness_mm)
    depths = depths[: len(glued.depth_mm)]
    made = cached("slab-ratio", {"case": case, "depths": depths}, lambda: solve_ratio(case, depths))
    count = len(made["ratio"])
    force = glued.force_N[:count] * made["ratio"]
    error = force * (made["error"] + glued.error_N[:count] / glued.force_N[:count])
    solver = add_costs(glued.solver, made["solver"])
    return PadCurve(glued.depth_mm[:count], force, error, solver, (*made["notes"], *glued.notes))


def _follow_rim(case: Case, depths: Array, slides: bool) -> ForcePath:
    """Follow one fillet: contact over the whole face where it slides, else a face that moves with the punch."""
    if slides:
        problem = edge_problem(case)
        return follow(problem, depths, 0.1 * case.edge, 0.05 * case.scale, 0.002 * case.scale)
    return follow_filleted(filleted_problem(case, sides=False), depths)


def solve_ratio(case: Case, depths: Array) -> dict[str, Any]:
    """Ratio to the glued slab and its relative error at the first of the depths, with cost and notes."""
    slides = case.condition != "bonded"
    rows, paths = [], []
    for rim in RIMS:
        own = replace(case, edge=rim * case.scale)
        pair = [_follow_rim(one, depths, slides) for one in (replace(own, base="bonded", condition="bonded"), own)]
        paths += pair
        rows.append(padded(pair[1], len(depths)) / padded(pair[0], len(depths)))
    coarse, fine = rows
    stops = [path.stop for path in paths if path.stop]
    count = int(np.isfinite(coarse).sum())
    both = int(np.isfinite(fine[:count]).sum())
    if not both:
        raise unsolved(stops[0], "contact")
    change = np.log(fine[:both] / coarse[:both])
    # Where the small fillet stops first, its correction is held, and doubted as a whole.
    held = np.concatenate([change, np.full(count - both, change[-1])])
    doubt = np.where(np.arange(count) < both, LEFT, 1.0 + LEFT) * np.abs(held)
    ratio = extrapolate_to_sharp(coarse[:count], held, 1.0 + LEFT)
    error = (SLIDING_ERROR if slides else GLUED_ERROR) + doubt
    if Interface.names_friction(case.base):
        error = error + 0.5 * SLIP_SCALE / depths[:count]
    notes = end_note(depths[count - 1], depths[-1], stops[0]) if count < len(depths) else ()
    return {"ratio": ratio, "error": error, "solver": cost(paths), "notes": notes}


# From one fillet (RIMS) to the next of half the size the missing force falls by 0.42 (the power 1.25 of
# ``edge_extrapolation``), so this share of the last step is left.
LEFT_TO_SHARP = 0.42 / (1.0 - 0.42)
# Share of that extrapolation, and of the step to cells of half the size, that is stated as error.
EDGE_ERROR = 0.3
MESH_ERROR = 1.0
LEAST_ERROR = 2e-3
# The step to cells of half the size changes sign on the way: its largest size over these shares of a depth is stated,
# which is that of the contact as it is there and not that of a tip of a few cells.
BACK = np.linspace(0.6, 1.0, 5)
# Smallest fillet over the smaller of radius and thickness that is followed: smaller ones end at half the depth. They
# are interpolated to the sharp edge in the power that slabs show (``tables.filleted``).
LEAST_FILLET = 0.015


def sharp(rough: Array, fine: Array) -> tuple[Array, Array]:
    """Values with fillets of 0.1 and 0.05 extrapolated to a sharp edge; NaN where a fillet did not get to.

    Where only one is known, the step between them is taken from the last depth at which both are.
    """
    step = last_known(np.log(fine / rough), 0.0)
    best = np.where(np.isfinite(fine), fine, rough * np.exp(step))
    return extrapolate_to_sharp(best, step, LEFT_TO_SHARP), np.expm1(LEFT_TO_SHARP * step)


def last_known(values: Array, otherwise: float) -> Array:
    """Values by depth, held at the last known one."""
    known = np.flatnonzero(np.isfinite(values))
    if not len(known):
        return np.full(len(values), otherwise)
    return np.where(np.arange(len(values)) <= known[-1], values, values[known[-1]])


def solve_shaped_pad(pad: Pad, depth_mm: ArrayLike, cells: int = CELLS, solved: PathCache | None = None) -> PadCurve:
    """Static force of a round shaped pad under a round, flat punch with a sharp or filleted edge, from first touch.

    Force and error at a depth are the same whatever the other depths are.
    """
    least = least_fillet_mm(pad)
    if 0.0 < pad.edge_radius_mm < least:
        return _nearly_sharp(pad, least, depth_mm, cells, solved)
    depths = relative_depths(depth_mm, pad.thickness_mm)
    case = meshed(replace(Case.of(pad), thickness_mm=float(pad.thickness_mm)))
    solved = PathCache() if solved is None else solved
    if case.shape.flat_top:
        return _over_slab(pad, case, depths, cells, solved)
    climbs = _climbs(case, depths[-1], cells, solved, False)
    asked, at = _looked_back(depths, climbs)
    paths = [one.at(asked) for one in climbs]
    fine, half, *large = (padded(path, len(asked)) for path in paths)
    value, mesh = _by_both(fine, half, large[0] if large else half)
    added = sharp(large[0], fine)[1] if large else np.zeros(len(asked))
    value, own = value * (1.0 + added), at[:, -1]
    doubt = _doubt(paths[0], len(asked))
    error = LEAST_ERROR + EDGE_ERROR * np.abs(added[own]) + MESH_ERROR * mesh[at].max(axis=1) + doubt[own]
    stops = [path.stop for path in paths if path.stop]
    return _curve(case, depths, value[own] * pad.shear_MPa * pad.thickness_mm**2, error, paths, stops)


def _climbs(case: Case, deepest: float, cells: int, solved: PathCache, twin: bool) -> list[Climb]:
    """Paths on all grids; large cells are there to compare with."""
    return [solved.climb(case, deepest, grid, twin, SOUND_J * (grid[0] < cells)) for grid in grids(cells, case)]


def _doubt(path: ForcePath, count: int) -> Array:
    """Relative error of a path's forces between the ends of its steps, shape (count,); held at the last one."""
    known = np.zeros(len(path.force)) if path.doubt is None else path.doubt
    return last_known(np.concatenate([known, np.full(count - len(known), np.nan)]), 0.0)


def _by_both(fine: Array, half: Array, further: Array) -> tuple[Array, Array]:
    """Values on fine cells, and beyond their end those of a path that got further, made equal there; what cells do."""
    change = last_known(np.abs(np.log(half / fine)), 0.01)
    beyond = further * np.exp(last_known(np.log(fine / further), 0.0))
    return np.where(np.isfinite(fine), fine, beyond), change


def _looked_back(depths: Array, climbs: Sequence[Climb]) -> tuple[Array, Array]:
    """Depths with those at shares of each and the ends of paths, and where the shares of each depth are among them."""
    back = np.outer(depths, BACK)
    ends = [one.reached for one in climbs if 0.0 < one.reached < depths[-1]]
    asked, at = np.unique(np.concatenate([back.ravel(), ends]), return_inverse=True)
    return asked, at[: back.size].reshape(back.shape)


def least_fillet_mm(pad: Pad) -> float:
    """Smallest fillet of a shaped pad's punch that is followed. [mm]"""
    return LEAST_FILLET * min(pad.radius_mm, pad.thickness_mm)


def _nearly_sharp(pad: Pad, least_mm: float, depth_mm: ArrayLike, cells: int, solved: PathCache | None) -> PadCurve:
    """Force between that under a sharp edge and that under the smallest fillet that is followed."""
    sharp_edge = solve_shaped_pad(replace(pad, edge_radius_mm=0.0), depth_mm, cells, solved)
    fillet = solve_shaped_pad(replace(pad, edge_radius_mm=least_mm), depth_mm, cells)
    count = min(len(sharp_edge.force_N), len(fillet.force_N))
    part = (pad.edge_radius_mm / least_mm) ** POWER
    logs = [np.log(curve.force_N[:count]) for curve in (sharp_edge, fillet)]
    force = np.exp((1.0 - part) * logs[0] + part * logs[1])
    error = np.maximum(*(curve.error_N[:count] / curve.force_N[:count] for curve in (sharp_edge, fillet)))
    shorter = min(sharp_edge, fillet, key=lambda curve: len(curve.force_N))
    solver = add_costs(sharp_edge.solver, fillet.solver)
    return PadCurve(shorter.depth_mm[:count], force, error * force, solver, shorter.notes)


def _over_slab(pad: Pad, case: Case, depths: Array, cells: int, solved: PathCache) -> PadCurve:
    """Force of a flat-topped pad: its ratio to the slab of the upper resin on twin grids, times the slab's force."""
    slab = _slab_curve(pad, case, depths)
    count = len(slab.depth_mm)
    if case.shape.plain:
        error = slab.error_N / slab.force_N + 1e-3
        return _curve(case, depths, slab.force_N, error, [], list(slab.notes))
    pairs = list(zip(*(_climbs(case, depths[-1], cells, solved, twin) for twin in (False, True))))
    asked, at = _looked_back(depths, [one for pair in pairs for one in pair])
    paths = [one.at(asked) for pair in pairs for one in pair]
    forces = [padded(path, len(asked)) for path in paths]
    fine, half, *large = (one / twin for one, twin in zip(forces[::2], forces[1::2]))
    ratio, spread = _by_both(fine, half, large[0] if large else half)
    if large:
        spread = spread + np.abs(last_known(np.log(large[0] / fine), 0.0))
    doubt = _doubt(paths[0], len(asked))
    error = slab.error_N / slab.force_N + 1e-3 + (spread[at].max(axis=1) + doubt[at[:, -1]])[:count]
    stops = [path.stop for path in paths if path.stop]
    curve = _curve(case, depths, ratio[at[:, -1]][:count] * slab.force_N, error, paths, stops + list(slab.notes))
    return replace(curve, solver=add_costs(curve.solver, slab.solver))


def _slab_curve(pad: Pad, case: Case, depths: Array) -> PadCurve:
    """Force of the slab of the upper resin under the same edge: from its table where it holds, else solved."""
    h = pad.thickness_mm
    a, edge = case.radius * h, case.edge * h
    own = replace(pad, geometry=SLAB, radius_mm=a, edge_radius_mm=edge, extent_mm=case.extent * h)
    plain = pad.condition == "bonded" and pad.poisson == 0.5 and pad.shape == Yeoh(pad.shape.shear_MPa)
    if plain and abs(case.extent * h / PAD_EXTENT_MM - 1.0) < 0.01:
        table = slab_table(pad.base, edge, a)
        low, high = table.ratio_range
        if low <= case.radius <= high:
            depth = depths[depths <= table.depth_limit(case.radius) * (1.0 + 1e-9)] * h
            force = table.force(depth, h, pad.young_MPa, a)
            notes = () if len(depth) == len(depths) else (f"the slab's table ends at {depth[-1] / h:.3f}",)
            return PadCurve(depth, force, table.relative_error(depth, h, a) * force, dict(NO_COST), notes)
    if case.edge:
        return solve_on_lattice("filleted", own, depths * h, solve_filleted)
    return (solve_curve if pad.condition == "bonded" else solve_flat)(own, depths * h)


def _curve(
    case: Case, depths: Array, force: Array, error: Array, paths: list[ForcePath], stops: Sequence[str | None]
) -> PadCurve:
    """The curve of forces to the first that is not known, and why it ends there."""
    count = int(np.isfinite(force).sum())
    if not count:
        raise unsolved(stops[0])
    # Of several reasons the one that the user can do something about.
    why = next((stop for stop in stops if stop and stop.startswith(FOLDED)), stops[0] if stops else None)
    notes = end_note(depths[count - 1], depths[-1], why) if count < len(depths) else ()
    solver = cost(paths) if paths else dict(NO_COST)
    return PadCurve(depths[:count] * case.thickness_mm, force[:count], error[:count] * force[:count], solver, notes)


# Largest step over the smaller of radius and thickness, as in space.
LARGEST_STEP = 0.05


@dataclass(frozen=True)
class RoundTwin:
    """Force under a sharp edge at the depths, over the thickness, at which the pad is open.

    ``stop`` says why others are left out.
    """

    case: Case
    depths: Array
    force: Array
    stop: str | None

    @classmethod
    def solve(cls, case: Case, depths: Array) -> RoundTwin:
        """Follow both fillets that stand for a sharp edge."""
        case, deepest = meshed(case), float(depths[-1])
        small = climb(case, deepest, CELLS, RIMS[1])
        large = climb(case, deepest, CELLS, RIMS[0], smaller=small)
        why = large.path.stop or ""
        open_ones = depths[depths <= large.reached] if why.startswith(FOLDED) else depths
        if not len(open_ones):
            raise unsolved(why)
        force, _ = sharp(*(padded(path.at(open_ones), len(open_ones)) for path in (large, small)))
        stop = f"under the circle of the punch's area {why}" if len(open_ones) < len(depths) else None
        return cls(case, open_ones, force, stop)

    def change_on(self, lines: tuple[Array, Array], cells: int, rim: float, step: float = LARGEST_STEP) -> Array:
        """ln of the force over that on other lines under a punch with a fillet, held where not known.

        Parameters
        ----------
        lines : (ndarray, ndarray)
            Radii and shares of the column.
        cells : int
            Under the punch, for the stiffness of the contact.
        rim : float
            Fillet over the smaller of radius and thickness.
        step : float
            Largest load step over the same.
        """
        first = 0.25 * float(self.depths[0])
        problem = shaped_problem(self.case, cells, rim, lines=lines)
        path = follow(problem, self.depths, first, step * self.case.scale, first / 64.0)
        return last_known(np.log(self.force / padded(path, len(self.depths))), 0.0)
