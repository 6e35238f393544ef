"""Whether a residual is explained by contact that is not where the files have it."""

from __future__ import annotations

from typing import Any

import numpy as np

from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.contact_offsets import find_offsets, shifted
from dummydesign.tissue.fitting.problem import problems_of
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.fitting.residuals import trace_residuals

PROPOSE = 1.3
"""Factor over the noise of the holds from which a residual is looked into, and below which it is explained."""
LEAST_OFFSET_MM = 0.02
"""Smallest contact offset that is spoken of: robot precision. [mm]"""


def proposed_offsets(traces: list[Trace], result: dict[str, Any], lowpass: Lowpass | None) -> dict[str, Any]:
    """Look for contact offsets that explain the residual of a fit without them.

    They are proposed when the residual stands out of the noise of the holds, the offsets bring it down to that noise,
    and at least one stands out of its error.

    Parameters
    ----------
    traces : list of Trace
        The presses that were fitted.
    result : dict
        The result of the fit without offsets.
    lowpass : Lowpass or None
        Filter that the forces went through.

    Returns
    -------
    dict
        ``proposed_contact_offsets`` and the ``warnings`` with one more; empty when there is nothing to propose.
    """
    floor = result["noise_floor_N"]
    if result["rmse_N"] < PROPOSE * floor:
        return {}
    arms = (result["elements"] - 1) // 2
    law, mode = result["law"], result["mode"]
    offsets = find_offsets(traces, law, mode, arms, lowpass)
    problems = problems_of(law, mode, [reduce_trace(one) for one in shifted(traces, offsets.value_mm)], lowpass)
    left = trace_residuals([(problem, problem.optimum(arms)) for problem in problems])["rmse_N"]
    seen = np.abs(offsets.value_mm) > np.maximum(1.5 * (offsets.high_mm - offsets.value_mm), LEAST_OFFSET_MM)
    if left > PROPOSE * floor or left > result["rmse_N"] / PROPOSE or not seen.any():
        return {}
    worst = int(np.argmax(np.where(seen, np.abs(offsets.value_mm), 0.0)))
    value, low, high = (float(end[worst]) for end in (offsets.value_mm, offsets.low_mm, offsets.high_mm))
    message = (
        f"contact offsets explain the residual ({result['rmse_N']:.3g} N becomes {left:.3g} N): {traces[worst].name} "
        f"was touched {abs(value):.3f} mm ({min(abs(low), abs(high)):.3f} to {max(abs(low), abs(high)):.3f}) "
        f"{'before' if value > 0 else 'after'} its zero, {int(seen.sum())} of {len(traces)} presses are off; without "
        "them the parameters and their intervals are wrong: fit again with --contact per-press"
    )
    warning = {"code": "contact_offsets", "message": message}
    return {"proposed_contact_offsets": offsets.to_list(traces), "warnings": [*result["warnings"], warning]}
