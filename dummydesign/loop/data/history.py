"""What happened to each pad before each trial: earlier presses, their depth, and the time since."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.campaign import Trial

DAY_S = 86400.0


@dataclass(frozen=True)
class History:
    """Earlier presses on the same pad. A pad is known by its shape and thickness.

    Attributes
    ----------
    earlier_depth_mm : ndarray, shape (T, T)
        [t, k]: depth that trial k reached on the pad of trial t before it; 0 when it was another pad or later.
    elapsed_s : ndarray, shape (T, T)
        [t, k]: time from the end of trial k to the start of trial t; infinite where not earlier.
    sequence : ndarray, shape (T,)
    repeat : ndarray, shape (T,)
    rest_s, temperature_C, age_days : ndarray, shape (T,)
        NaN where not declared.
    """

    earlier_depth_mm: NDArray
    elapsed_s: NDArray
    sequence: NDArray
    repeat: NDArray
    rest_s: NDArray
    temperature_C: NDArray
    age_days: NDArray


def make_history(trials: tuple[Trial, ...], depth_mm: NDArray) -> History:
    """Collect the history of every trial from sequence, rest and age.

    Parameters
    ----------
    trials : tuple of Trial
    depth_mm : ndarray, shape (T,)
        Depth each trial held. [mm]
    """

    def column(name: str) -> NDArray:
        return np.array([np.nan if getattr(t, name) is None else getattr(t, name) for t in trials], dtype=float)

    count = len(trials)
    sequence, rest, age = column("sequence"), column("rest_s"), column("age_days")
    depth, elapsed = np.zeros((count, count)), np.full((count, count), np.inf)
    pads: dict[tuple[str, float], list[int]] = {}
    for index in np.argsort(sequence, kind="stable"):
        before = pads.setdefault(trials[index].pad, [])
        since = 0.0
        later = index
        for earlier in reversed(before):
            since += float(rest[later]) if np.isfinite(rest[later]) else 60.0
            days = age[index] - age[earlier]
            gap = max(since, days * DAY_S) if np.isfinite(days) else since
            depth[index, earlier], elapsed[index, earlier] = depth_mm[earlier], gap
            trace = trials[earlier].trace
            since += float(trace.time_s[-1] - trace.time_s[0])
            later = earlier
        before.append(int(index))
    return History(
        depth, elapsed, sequence, column("repeat"), rest, column("temperature_C"), age
    )
