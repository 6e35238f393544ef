"""Roughness of a solved force law: what contact that grows cell by cell leaves, pad by pad, over the depth.

The law error of a pad is smooth (level, slope, curvature). Finite elements whose contact grows are rough beside it;
this allowance, with a prior of its size, is taken out of a remainder before it is asked what it follows.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import Fit

KNOTS = 9


def rough_columns(found: Fit) -> NDArray:
    """What a rough law could add, in newton at one standard deviation, shape (T, B, q); q is 0 for smooth laws.

    Parameters
    ----------
    found : Fit
        With modelled forces, whose law says how rough it is on each pad (``roughness``).
    """
    presses, law = found.problem.presses, found.problem.law
    depth = presses.measure(np.maximum(presses.displacement_mm, 0.0))
    columns = []
    for pad in presses.pads:
        size = law.roughness(pad) if hasattr(law, "roughness") else 0.0
        if not size:
            continue
        own = np.array([trial.pad == pad for trial in presses.trials])[:, None] & presses.used
        knots = np.linspace(0.0, float(depth[own].max()), KNOTS)
        at = np.clip(depth, knots[0], knots[-1])
        for place in range(1, KNOTS):
            hat = np.interp(at, knots, np.eye(KNOTS)[place])
            columns.append(np.where(own, size * found.forces * hat, 0.0))
    return np.stack(columns, axis=-1) if columns else np.zeros((*presses.used.shape, 0))
