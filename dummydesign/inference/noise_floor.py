"""The noise of a hold without any law."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dummydesign.inference.reduction import ReducedTrace


def noise_floor(traces: Sequence[ReducedTrace]) -> float:
    """Rms of the noise of the hold without any law: what a smooth curve in log time cannot follow. [N]"""
    squares, count = 0.0, 0
    for trace in traces:
        time = trace.trace.time_s[trace.inside] - trace.ramp.stop_time_s
        force_N = trace.trace.force_N[trace.inside]
        late = time > 0.05 * time[-1]
        if late.sum() < 20:
            continue
        at = np.log(time[late])
        at = 2.0 * (at - at[0]) / (at[-1] - at[0]) - 1.0
        smooth = np.polynomial.chebyshev.Chebyshev.fit(at, force_N[late], 6)
        squares += float(((force_N[late] - smooth(at)) ** 2).sum())
        count += int(late.sum()) - 7
    return float(np.sqrt(squares / count)) if count > 0 else 0.0
