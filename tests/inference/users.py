"""One press as each user of the shared statistics reduces it: a fit of a tissue, the loop, a puck test."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.loop.data.reduction import reduce_press as reduce_trial
from dummydesign.measurement.ramp_detection import find_holds
from dummydesign.measurement.trace import Trace
from dummydesign.resin.puck_test.loading_fit import reduce_press as reduce_puck
from dummydesign.tissue.fitting.reduction import reduce_trace

USERS = ("tissue", "loop", "puck")
DEPTH_MM, SPEED_MM_S, HOLD_S = 6.0, 10.0, 20.0


@dataclass(frozen=True)
class Reduced:
    """Bins, and the nodes with their operator."""

    start_s: np.ndarray
    end_s: np.ndarray
    samples: np.ndarray
    force_N: np.ndarray
    nodes_s: np.ndarray
    displacement_mm: np.ndarray
    average: np.ndarray


def motion() -> tuple[np.ndarray, np.ndarray]:
    """Times at 500 Hz and a ramp that begins a tenth of a second after the record and holds to its end."""
    time = np.arange(round((0.1 + DEPTH_MM / SPEED_MM_S + HOLD_S) * 500)) / 500.0
    return time, np.clip(SPEED_MM_S * (time - 0.1), -1.0, DEPTH_MM)


def reduced(user: str, force) -> Reduced:
    """Reduce the press whose force is a function of time and displacement."""
    time, x = motion()
    trace = Trace("press.csv", time, x, force(time, x))
    if user == "tissue":
        found = reduce_trace(trace)
        nodes, depth = found.motion.time_s, found.motion.displacement_mm
        return Reduced(found.start_s, found.end_s, found.samples, found.force_N, nodes, depth, found.operator)
    if user == "loop":
        found = reduce_trial(trace, None)
        average = found.operator
    else:
        found = reduce_puck(time, x, trace.force_N, find_holds(time, x), (-1.0, 100.0))
        average = found.average
    return Reduced(
        found.start_s, found.end_s, found.samples, found.force_N, found.time_s, found.displacement_mm, average
    )
