"""Slab whose face or base slides: the ratio of its force to the glued slab's on one mesh, times the glued curve.

An edge fillet of 0.1 lowers the force by a few per cent, in the glued and in the sliding slab alike: with friction
their ratio changes by some tenths of a per cent when the fillet is halved, without by 0.2 to 2 %.
So the ratio is solved with two fillets and extrapolated with the power of ``edge_extrapolation``, and the glued curve
is the limit of ``sharp_edge``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.interface import BASES, FACES, Interface
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.contact.resting_base import SLIP_SCALE, weight_over_shear
from dummydesign.pad.contact.surface_axisymmetric import FlatPunch
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.slab.edge_extrapolation import RIM_POWER, carried_on
from dummydesign.pad.slab.filleted import filleted_problem
from dummydesign.pad.slab.indentation import Region, indentation_problem
from dummydesign.pad.slab.problem import PadCurve, Slab, normalise
from dummydesign.pad.slab.sharp_edge import solve_curve
from dummydesign.pad.slab.solved_depths import HALVINGS, LATTICE
from dummydesign.pad.solve.continuation import Path, cost, follow

Array = np.ndarray

RIMS = (0.1, 0.05)
# Cells per fillet of a face that slides.
SLIDING_CELLS = 3.0
# What is left of a correction by one halving of the fillet.
LEFT = 1.0 / (2.0**RIM_POWER - 1.0)
# Error of the ratio from cells and contact: half the cells moved it by up to 0.3 % and 1 %.
GLUED_ERROR, SLIDING_ERROR = 3e-3, 1e-2


def solve_flat(
    thickness_mm: float,
    radius_mm: float,
    young_MPa: float,
    depth_mm: Sequence[float] | Array,
    condition: str,
    *,
    base: str = "bonded",
    poisson: float = 0.5,
    extent_mm: float = PAD_EXTENT_MM,
    law: Law | None = None,
    progress: Callable[[float], None] | None = None,
) -> PadCurve:
    """Static force of a slab under a flat, sharp-edged punch where the face, the base or both slide or rub.

    Parameters
    ----------
    thickness_mm, radius_mm, young_MPa, depth_mm, poisson, extent_mm, law, progress
        As for :func:`dummydesign.pad.slab.sharp_edge.solve_curve`.
    condition : str
        Of the face: ``bonded``, ``frictionless`` or ``friction:MU``.
    base : str
        ``bonded``, ``sliding`` (no lift-off) or ``friction:MU`` (lifts off, rests by its weight). A glued face on
        one of the first two is solved by :func:`dummydesign.pad.slab.sharp_edge.solve_curve`.

    Returns
    -------
    PadCurve
        ``error_N`` adds the errors of both factors: of the glued curve; of the ratio, cells and contact, and what
        the limit of small fillets added to it.

    Raises
    ------
    InputError, NoAnswerError
        For bad values; when no depth is reached with both fillets.
    """
    shape, depths, ratio, unit = normalise(thickness_mm, radius_mm, young_MPa, depth_mm, poisson, law)
    Interface.parse(condition, "condition", FACES)
    rests = Interface.parse(base, "base", BASES).coulomb is not None
    slab = Slab(ratio, extent_mm / thickness_mm)
    glued = solve_curve(
        thickness_mm, radius_mm, young_MPa, depths * thickness_mm, poisson=poisson, extent_mm=extent_mm, law=shape,
        progress=progress,
    )  # fmt: skip
    depths = depths[: len(glued.depth_mm)]
    weight = weight_over_shear(thickness_mm, unit) if rests else 0.0
    args = (slab, shape, poisson, depths, condition, base, weight)
    inputs = dict(zip(("slab", "law", "poisson", "depths", "condition", "base", "weight"), args))
    found = cached("slab-ratio", inputs, lambda: _solve_ratio(*args, progress))
    count = len(found["ratio"])
    force = glued.force_N[:count] * found["ratio"]
    error = force * (found["error"] + glued.error_N[:count] / glued.force_N[:count])
    solver = {name: glued.solver[name] + found["solver"][name] for name in glued.solver}
    solver["unknowns"] = max(glued.solver["unknowns"], found["solver"]["unknowns"])
    return PadCurve(glued.depth_mm[:count], force, error, solver, (*found["notes"], *glued.notes))


def _follow_sliding(
    slab: Slab, law: Law, poisson: float, fillet: float, face: str, support: str, weight: float, depths: Array,
    progress: Callable[[float], None] | None,
) -> Path:  # fmt: skip
    """One path of a face that slides, or of the glued one on the same cells: contact over the whole face."""
    punch = FlatPunch(slab.radius, fillet)
    region = Region(max(0.0, slab.radius - 3.0 * fillet), slab.radius + 2.0 * fillet, fillet / SLIDING_CELLS)
    problem = indentation_problem(punch, region, slab.extent, law, poisson, support, face, weight=weight)
    return follow(problem, depths, 0.1 * fillet, 0.05 * slab.scale, 0.002 * slab.scale, progress)


def _follow_glued(
    slab: Slab, law: Law, poisson: float, fillet: float, support: str, weight: float, depths: Array,
    progress: Callable[[float], None] | None,
) -> Path:  # fmt: skip
    """One path of a glued face, which moves with the punch node by node, over a base that rests or is bonded."""
    friction = Interface.parse(support, "base", BASES).coulomb
    rests = None if friction is None else (friction, weight)
    problem = filleted_problem(slab, law, poisson, fillet, sides=False, rests=rests)
    steps = (LATTICE * 0.5**HALVINGS, LATTICE, LATTICE / 256.0)
    return follow(problem, depths, *steps, progress, lattice=True)


def _solve_ratio(
    slab: Slab, law: Law, poisson: float, depths: Array, condition: str, base: str, weight: float,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:  # fmt: skip
    """Ratio and its relative error at the first of the depths, with cost and notes."""
    slides = condition != "bonded"
    rows, paths = [], []
    for rim in RIMS:
        forces = []
        for face, support in (("bonded", "bonded"), (condition, base)):
            fillet = rim * slab.scale
            if slides:
                path = _follow_sliding(slab, law, poisson, fillet, face, support, weight, depths, progress)
            else:
                path = _follow_glued(slab, law, poisson, fillet, support, weight, depths, progress)
            paths.append(path)
            forces.append(np.concatenate([path.force, np.full(len(depths) - len(path.force), np.nan)]))
        rows.append(forces[1] / forces[0])
    coarse, fine = rows
    stops = [path.stop for path in paths if path.stop]
    count = int(np.isfinite(coarse).sum())
    both = int(np.isfinite(fine[:count]).sum())
    if not both:
        raise NoAnswerError("no_convergence", f"contact could not be solved: {stops[0]}")
    change = np.log(fine[:both] / coarse[:both])
    # Where the small fillet stops first, its correction is held, and doubted as a whole.
    held = np.concatenate([change, np.full(count - both, change[-1])])
    doubt = np.where(np.arange(count) < both, LEFT, 1.0 + LEFT) * np.abs(held)
    ratio = carried_on(coarse[:count], held, 1.0 + LEFT)
    error = (SLIDING_ERROR if slides else GLUED_ERROR) + doubt
    if Interface.parse(base, "base", BASES).coulomb is not None:
        error = error + 0.5 * SLIP_SCALE / depths[:count]
    notes: tuple[str, ...] = ()
    if count < len(depths):
        notes = (f"solved to d/h = {depths[count - 1]:.3f} of {depths[-1]:.3f}: {stops[0]}",)
    return {"ratio": ratio, "error": error, "solver": cost(paths), "notes": notes}
