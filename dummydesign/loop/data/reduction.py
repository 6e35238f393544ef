"""One press reduced to bins, and the nodes at which the model is evaluated.

Bins: three before contact; every sample of a fast rise or seventeen of a slow one; from 1 ms growing
by a third over the hold; twenty over the unloading. Equal parts of repeats carry equal labels.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Binning, Range, cut, distinct, mean_around, repeatable_hold_edges, white_noise
from dummydesign.measurement.ramp_detection import Ramp, ramp_of, ringing_times
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace

FAST_RISE_S = 0.06
SLOW_BINS = 17
SHORTEST_HOLD_S = 0.05
LOADING_BINS = 40  # bins of a press that ends while it loads
UNLOADING_BINS = 20
RISE_NODES = 80
AWAY_NODES, BACK_NODES = 20, 60  # nodes on the way back: even in time, and even in the travel of a deepest press
NODE_GROWTH, NODE_CAP_S = 1.2, 0.4
NEAR_S = 0.01
EARLY_S = (0.06, 0.005)
EARLY_NODES = 16  # nodes before contact, closer towards it: a tilted punch and an early force clock are seen there
QUARTIC = np.array([-13.0, 67.0, -19.0, -70.0, -19.0, 67.0, -13.0]) / 132.0
"""Weights of seven even samples, over their step squared, for the second derivative at the fourth."""
UNEVEN = 0.05  # relative difference of steps up to which samples count as even
PRE, RISE, HOLD, UNLOADING = 0, 1, 2, 3  # phases of a press; a bin's label is 100 times its phase plus its place


@dataclass(frozen=True)
class ReducedPress(Binning):
    """Bins and nodes of one trial."""

    ramp: Ramp
    force_N: NDArray
    label: NDArray
    time_s: NDArray
    displacement_mm: NDArray
    acceleration_mm_s2: NDArray
    filtered: NDArray
    smooth_s: Range
    """Where a curve is smooth between its nodes, which lie far apart there: the settled hold."""
    operator: NDArray
    white_N: float


def reduce_press(trace: Trace, lowpass: Lowpass | None) -> ReducedPress:
    """Reduce one trial."""
    ramp = ramp_of(trace)
    edges, labels = _bin_edges(trace.time_s, ramp)
    binning = cut(trace.time_s, edges, labels < 0)
    nodes, x = _nodes(trace, ramp)
    filtered = np.eye(len(nodes)) if lowpass is None else lowpass.apply(nodes, np.eye(len(nodes))).T
    smooth = max(ramp.stop_time_s + NEAR_S, ramp.settled_s), ramp.hold_end_s
    operator = binning.average(trace.time_s, nodes, smooth) @ filtered
    acceleration = np.interp(nodes, trace.time_s, _acceleration(trace.time_s, trace.displacement_mm))
    return ReducedPress(
        **vars(binning),
        ramp=ramp,
        force_N=binning.mean(trace.force_N),
        label=labels[binning.interval],
        time_s=nodes,
        displacement_mm=x,
        acceleration_mm_s2=acceleration,
        filtered=filtered,
        smooth_s=smooth,
        operator=operator,
        white_N=_white(trace, ramp),
    )


def has_hold(ramp: Ramp) -> bool:
    """Whether a press holds long enough to show relaxation."""
    return ramp.hold_end_s - ramp.stop_time_s >= SHORTEST_HOLD_S


def _bin_edges(time: NDArray, ramp: Ramp) -> tuple[NDArray, NDArray]:
    """Edges [s] and the label of each bin."""
    step = 1e-3
    contact, stop, end = ramp.contact_time_s, ramp.stop_time_s, ramp.hold_end_s
    if not has_hold(ramp):
        edges = np.linspace(contact, time[-1], LOADING_BINS + 1)
        edges[-1] += 1e-9
        return edges, 100 * RISE + np.arange(LOADING_BINS)
    before = contact - 2 * step
    parts, labels = [], []
    if time[0] < before - 4 * step:
        parts.append(np.linspace(time[0], before, 4)[:-1])
        labels.append(100 * PRE + np.arange(3))
    if ramp.rise_time_s < FAST_RISE_S:
        count = int(np.ceil((stop - before) / step))
        parts.append(stop - step * np.arange(count, 0, -1))
        if len(parts) > 1:
            parts[-1] = parts[-1][parts[-1] > parts[0][-1] + step]
            count = len(parts[-1])
        labels.append(100 * RISE + np.arange(count, 0, -1).clip(0, 99))
    else:
        parts.append(before + (stop - before) / SLOW_BINS * np.arange(SLOW_BINS))
        labels.append(100 * RISE + np.arange(SLOW_BINS))
    hold = repeatable_hold_edges(step, end - stop)
    parts.append(stop + hold)
    labels.append(100 * HOLD + np.arange(len(hold)))
    if time[-1] > end + 0.1:
        # between coarse samples the turn of the motion is not known: leave it out
        around = time[(time > end - 0.05) & (time < end + 0.05)]
        blind = float(np.diff(around).max()) + 0.02 if len(around) > 1 else 0.02
        parts.append(np.r_[end - blind, np.linspace(end + blind, time[-1] + 1e-9, UNLOADING_BINS + 1)[:-1]])
        labels.append(np.r_[-1, 100 * UNLOADING + np.arange(UNLOADING_BINS)])
    edges = np.r_[np.concatenate(parts), time[-1] + 2e-9 if time[-1] > end + 0.1 else end + 1e-9]
    return edges, np.concatenate(labels)


def _nodes(trace: Trace, ramp: Ramp) -> tuple[NDArray, NDArray]:
    """Node times and the displacement there.

    All samples (and, when fast, points half-way on a cubic) near contact and stop; thinned elsewhere in
    the rise; close while the punch rings; a growing series with averaged displacement in the hold; thinned on the
    way back, by travel and by time.
    """
    from scipy.interpolate import CubicSpline

    time, x = trace.time_s, trace.displacement_mm
    contact, stop, end = ramp.contact_time_s, ramp.stop_time_s, ramp.hold_end_s
    early, late = contact - EARLY_S[1], stop + 0.03
    rise = time[(time >= early) & (time <= late)]
    if len(rise) > RISE_NODES:
        stride = int(np.ceil(len(rise) / RISE_NODES))
        near = (np.abs(rise - stop) < NEAR_S) | (np.abs(rise - contact) < NEAR_S)
        rise = rise[near | (np.arange(len(rise)) % stride == 0)]
    else:
        rise = np.union1d(rise, 0.5 * (rise[1:] + rise[:-1]))
    start = np.r_[time[0], np.maximum(contact - np.geomspace(*EARLY_S, EARLY_NODES), time[0])]
    hold = [max(late, rise[-1] if len(rise) else late)]
    while hold[-1] < end:
        hold.append(hold[-1] + min(max((hold[-1] - stop) * (NODE_GROWTH - 1.0), 2e-3), NODE_CAP_S))
    away = time >= end
    # travel from the deepest on, which noise of the position does not add to
    back = np.maximum.accumulate(np.clip(1.0 - x[away] / max(float(x.max()), 1e-9), 0.0, 1.0))
    passed = BACK_NODES * back + AWAY_NODES * (time[away] - end) / max(time[-1] - end, 1e-9)
    away = time[away][np.diff(np.floor(passed), prepend=-1.0) > 0]
    nodes = np.unique(np.r_[start, rise, ringing_times(ramp), hold[1:-1], end, away, time[-1]])
    nodes = distinct(nodes[(nodes >= time[0]) & (nodes <= time[-1])], 1e-5)
    rising = np.diff(time).min() > 0 and len(time) > 3
    placed = CubicSpline(time, x)(nodes) if rising else np.interp(nodes, time, x)
    linear, mean = np.interp(nodes, time, x), mean_around(nodes, time, x)
    rung_out = max(late, ramp.settled_s)
    held = (nodes > rung_out) & (nodes < end - 0.02)
    smooth = (nodes >= contact) & (nodes <= rung_out)
    return nodes, np.where(held, mean, np.where(smooth, placed, linear))


def _acceleration(time: NDArray, x: NDArray) -> NDArray:
    """Acceleration of the punch where sampled at 400 Hz or faster, else 0. [mm/s2]

    Second derivative of the quartic through seven even samples by least squares: differences of differences spread
    the pulse of a stop over four samples, so that its height is too low and a mass is found too large.

    References
    ----------
    Savitzky and Golay, Anal. Chem. 36 (1964) 1627.
    """
    value = np.gradient(np.gradient(x, time), time)
    gaps = np.diff(time)
    step = np.r_[gaps[0], np.maximum(gaps[1:], gaps[:-1]), gaps[-1]]
    if len(time) >= len(QUARTIC):
        windows, own = (np.lib.stride_tricks.sliding_window_view(v, n) for v, n in ((x, 7), (gaps, 6)))
        even = own.max(axis=1) < (1.0 + UNEVEN) * own.min(axis=1)
        inside = value[3:-3]
        inside[even] = (windows[even] @ QUARTIC) / own[even].mean(axis=1) ** 2
    value[step > 2.5e-3] = 0.0
    return value


def _white(trace: Trace, ramp: Ramp) -> float:
    """White noise per sample from second differences before contact, and 0.1 s after the stop or the ringing. [N]"""
    time, force = trace.time_s, trace.force_N
    step = np.diff(time)
    even = (np.abs(step[1:] / step[:-1] - 1) < 0.1) & (step[1:] < 0.1)
    middle = time[1:-1]
    rung_out = max(ramp.stop_time_s + 0.1, ramp.settled_s)
    quiet = (middle < ramp.contact_time_s) | ((middle > rung_out) & (middle < ramp.hold_end_s))
    second = (force[2:] - 2 * force[1:-1] + force[:-2])[even & quiet]
    if len(second) < 20:
        second = np.diff(force, 2)
    return max(white_noise(second), 1e-3)
