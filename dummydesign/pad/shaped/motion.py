"""How far a finite-strain viscoelastic shaped pad departs from the quick (separable) prediction, on one mesh.

The ratio of both forces is solved as that of a slab (:mod:`dummydesign.pad.slab.finite_strain_ratio`) and multiplies
the prediction that rests on the pad's own table or solve. Layers relax alike: the lower one's moduli are those of the
upper one times its ratio. To the ratio of a pad with a flat top is added what a slab's own, on small cells round the
edge, has over that on the pad's cells; on three pads it was left within 0.01 of the force by half the cells.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.pad.material.hyperelastic import Law
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.shaped.fold import FoldWatch, RoundFace
from dummydesign.pad.shaped.paths import FLAT_STEP, LARGEST_STEP
from dummydesign.pad.shaped.problem import RIMS, Press, shaped_problem
from dummydesign.pad.slab.finite_strain_ratio import RatioPath, ratio_path, solve_ratio
from dummydesign.pad.slab.problem import Slab
from dummydesign.pad.solve.equilibrium import Problem

Array = np.ndarray

CELLS = 12


def solve_shaped_ratio(
    press: Press,
    law: Law,
    prony: Sequence[PronyTerm],
    time_s: Array,
    depth: Array,
    *,
    cells: int = CELLS,
    progress: Callable[[float], None] | None = None,
) -> RatioPath:
    """Solve one motion of a round shaped pad twice on one mesh, with and without relaxation.

    Parameters
    ----------
    press : Press
        Pad, punch and support in thicknesses.
    law : Law
        Long-term law; only its shape counts.
    prony : sequence of PronyTerm
        Relative to the long-term modulus.
    time_s, depth : ndarray, shape (n,)
        Motion from the undeformed state (depth 0), depth in thicknesses. [s, -]
    cells : int
        Cells between the axis and the punch's edge, at least.
    progress : callable, optional
        Called with each solved depth.

    Returns
    -------
    RatioPath
        Forces in units of mu h^2, mu the shear modulus of the upper resin.

    Raises
    ------
    InputError
        For a shape that is not round.
    NoAnswerError
        When a solve stops before the end with every fillet, with the last reason, or the face folds on to itself.
    """
    press.check()
    shape, arms = law.scaled(1.0 / law.shear_MPa), tuple(prony)
    inputs = {"press": press, "law": shape, "prony": arms, "time": time_s, "depth": depth, "cells": cells}
    solve = partial(_solve, press, shape, arms, time_s, depth, cells, progress)
    return RatioPath(**cached("shaped-ratio", inputs, solve))


def _solve(
    press: Press, shape: Law, prony: tuple[PronyTerm, ...], time_s: Array, depth: Array, cells: int,
    progress: Callable[[float], None] | None,
) -> dict[str, Any]:  # fmt: skip
    """The fields of a RatioPath."""
    step = (FLAT_STEP if press.shape.flat_top else LARGEST_STEP) * 16.0 / cells
    rims = (press.edge / press.scale,) if press.edge else RIMS[::-1]

    def followed(twin: bool, rims: Sequence[float]) -> RatioPath:
        def problem(material: Any, rim: float) -> Problem:
            return shaped_problem(press, material, cells, rim, twin)

        def watch(made: Problem) -> FoldWatch:
            return FoldWatch(RoundFace(made, press.thickness_mm))

        looked = None if twin or press.shape.flat_top else watch
        return ratio_path(problem, shape, prony, time_s, depth, rims, step, progress, looked)

    path = followed(False, rims)
    if not press.shape.flat_top:
        return vars(path)
    # The edge of a flat top: what cells this large leave out of a slab's departure is left out of this pad's.
    twin = followed(True, (path.solver["rim_over_scale"],))
    slab = Slab(press.radius, press.extent, press.base, press.condition)
    fine = solve_ratio(slab, shape, prony, time_s, depth, poisson=press.poisson, progress=progress)
    ratio = path.ratio + fine.ratio - twin.ratio
    counted = ("load_steps", "newton_iterations", "seconds")
    solver = path.solver | {name: sum(part.solver[name] for part in (path, twin, fine)) for name in counted}
    return vars(replace(path, force=ratio * path.separable, solver=solver))
