"""Presses of a person reduced to what curves without a law keep of them: rise over depth, hold over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.tissue.fitting.reduction import ReducedTrace
from dummydesign.tissue.model.held_press import FIRST_HOLD_S, SHARES, HeldPress
from dummydesign.tissue.model.measured_curves import MeasuredPerson

LEAST_RISE = 20
"""Samples of a rise from which on it is smoothed."""
WINDOW, ORDER = 5, 2
"""Samples and degree of the parabolas that smooth a rise; at its ends the outer parabola goes on."""
HOLD_BINS, LATE = 40, 0.05
"""Bins of the hold, even in the logarithm of time, and the last share of it that its end is the mean of."""


def person_of(reduced: Sequence[ReducedTrace]) -> MeasuredPerson:
    """A person of reduced presses at the speeds they were told.

    Parameters
    ----------
    reduced : sequence of ReducedTrace

    Raises
    ------
    InputError
        With the press, for one without a force at its end.
    """
    return MeasuredPerson([held_press(trace, trace.velocity_mm_s) for trace in reduced])


def held_press(trace: ReducedTrace, velocity_mm_s: float) -> HeldPress:
    """Rise at shares of the depth, and means of the hold in bins of time.

    Parameters
    ----------
    trace : ReducedTrace
    velocity_mm_s : float
        Nominal speed. [mm/s]

    Raises
    ------
    InputError
        When nothing is left at the end of the hold.
    """
    time, force, x = trace.trace.time_s, trace.trace.force_N, trace.trace.displacement_mm
    ramp = trace.ramp
    rise = (time >= ramp.contact_time_s) & (time <= ramp.stop_time_s)
    rising = _smooth(time[rise], force[rise])
    share = np.maximum.accumulate(np.clip(x[rise] / ramp.depth_mm, 0.0, 1.0))
    first = np.unique(share, return_index=True)[1]
    stop = _at_stop(time[rise], rising, ramp.stop_time_s)
    known, values = share[first], rising[first]
    inner = known < 1.0
    curve = np.interp(SHARES, np.r_[known[inner], 1.0], np.r_[values[inner], stop])
    held = trace.inside[time[trace.inside] > ramp.stop_time_s]
    hold = ramp.hold_end_s - ramp.stop_time_s
    when, mean = _bins(time[held] - ramp.stop_time_s, force[held], hold)
    if not trace.steady_force_N > 0.0:
        raise InputError(f"{trace.trace.name}: the force at the end of the hold is {trace.steady_force_N:.3g} N")
    carried = np.r_[stop, mean, trace.steady_force_N]
    return HeldPress(float(velocity_mm_s), float(ramp.depth_mm), curve, np.r_[0.0, when, hold], carried)


def _smooth(time: NDArray, force: NDArray) -> NDArray:
    """Parabolas through five even samples; where there are few or uneven ones, the samples."""
    step = np.diff(time)
    if len(time) < LEAST_RISE or step.max() > 1.2 * step.min():
        return force
    from scipy.signal import savgol_filter

    return savgol_filter(force, WINDOW, ORDER, mode="interp")


def _at_stop(time: NDArray, force: NDArray, stop_s: float) -> float:
    """Force at the stop, carried on from the last two samples by less than a sample. [N]"""
    slope = (force[-1] - force[-2]) / (time[-1] - time[-2]) if len(time) > 1 else 0.0
    return float(force[-1] + slope * min(stop_s - time[-1], time[-1] - time[-2] if len(time) > 1 else 0.0))


def _bins(since_s: NDArray, force_N: NDArray, hold_s: float) -> tuple[NDArray, NDArray]:
    """Mean time and force of the bins that hold a sample, before the last twentieth. [s, N]"""
    edges = np.r_[0.0, np.geomspace(FIRST_HOLD_S, (1.0 - LATE) * hold_s, HOLD_BINS)]
    place = np.digitize(since_s, edges)
    rows = [np.flatnonzero(place == number) for number in range(1, len(edges))]
    kept = [row for row in rows if len(row)]
    return np.array([since_s[row].mean() for row in kept]), np.array([force_N[row].mean() for row in kept])
