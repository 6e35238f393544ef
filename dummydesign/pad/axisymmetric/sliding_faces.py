"""Slab whose face or base slides: the ratio of its force to the glued slab's on one mesh, times the glued curve.

An edge fillet of 0.1 lowers the force by a few per cent, in the glued and in the sliding slab alike: with friction
their ratio changes by some tenths of a per cent when the fillet is halved, without by 0.2 to 2 %.
So the ratio is solved with two fillets and extrapolated with the power of ``edge_extrapolation``, and the glued curve
is the limit of ``sharp_edge``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.pad.axisymmetric.case import Case, Progress, end_note, padded, relative_depths, unsolved
from dummydesign.pad.axisymmetric.filleted import filleted_problem, follow_filleted
from dummydesign.pad.axisymmetric.profile_punch import edge_problem
from dummydesign.pad.axisymmetric.sharp_edge import RIM_POWER, extrapolate_to_sharp, solve_curve
from dummydesign.pad.contact.friction import SLIP_SCALE
from dummydesign.pad.force_law import PadCurve
from dummydesign.pad.solve.continuation import Path, add_costs, cost, follow
from dummydesign.pad.specimen import Pad

Array = np.ndarray

RIMS = (0.1, 0.05)
# The rest of a correction by one halving of the fillet.
LEFT = 1.0 / (2.0**RIM_POWER - 1.0)
# Error of the ratio from cells and contact: half the cells moved it by up to 0.3 % and 1 %.
GLUED_ERROR, SLIDING_ERROR = 3e-3, 1e-2


def solve_flat(pad: Pad, depth_mm: Sequence[float] | Array, progress: Progress | None = None) -> PadCurve:
    """Static force of a slab under a flat, sharp-edged punch where the face, the base or both slide or rub."""
    depths = relative_depths(depth_mm, pad.thickness_mm)
    Interface.parse(pad.condition, "condition", FACES)
    Interface.parse(pad.base, "base", BASES)
    case = Case.of(pad)
    glued = solve_curve(replace(pad, base="bonded", condition="bonded"), depths * pad.thickness_mm, progress)
    depths = depths[: len(glued.depth_mm)]
    made = cached("slab-ratio", {"case": case, "depths": depths}, lambda: solve_ratio(case, depths, progress))
    count = len(made["ratio"])
    force = glued.force_N[:count] * made["ratio"]
    error = force * (made["error"] + glued.error_N[:count] / glued.force_N[:count])
    solver = add_costs(glued.solver, made["solver"])
    return PadCurve(glued.depth_mm[:count], force, error, solver, (*made["notes"], *glued.notes))


def _follow_rim(case: Case, depths: Array, slides: bool, progress: Progress | None) -> Path:
    """Follow one fillet: contact over the whole face where it slides, else a face that moves with the punch."""
    if slides:
        problem = edge_problem(case)
        return follow(problem, depths, 0.1 * case.edge, 0.05 * case.scale, 0.002 * case.scale, progress)
    return follow_filleted(filleted_problem(case, sides=False), depths, progress)


def solve_ratio(case: Case, depths: Array, progress: Progress | None = None) -> dict[str, Any]:
    """Ratio to the glued slab and its relative error at the first of the depths, with cost and notes."""
    slides = case.condition != "bonded"
    rows, paths = [], []
    for rim in RIMS:
        own = replace(case, edge=rim * case.scale)
        pair = [
            _follow_rim(one, depths, slides, progress)
            for one in (replace(own, base="bonded", condition="bonded"), own)
        ]
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
