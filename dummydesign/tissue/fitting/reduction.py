"""Reduction of a press to bins, and the groups of presses at one condition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import group_near
from dummydesign.inference.noise import Binning, cut, distinct, hold_edges, mean_around
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.ramp_detection import Ramp, ramp_of, ringing_times, steady_force
from dummydesign.measurement.sensor import find_clip
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.model.measured_curves import SAME_DEPTH, SPEED_FACTOR

RISE_BINS = 20
FIRST_HOLD_S = 1e-3
RISE_NODES = 160
FINE_NODES = 80
"""Nodes that a rise of few samples is brought to; its motion between samples is :func:`between`."""
SETTLED_S = 0.01
"""Time after the stop from which the motion is taken as a slow wander and the force as smooth. [s]"""
QUIET_SAMPLES = 40
"""Samples that a punch must leave after its ringing for the noise of the hold to be read from them."""


@dataclass(frozen=True, eq=False)
class ReducedTrace(Binning):
    """One press in bins, and the motion at the nodes where a model is evaluated.

    ``operator`` (bins, nodes) makes means over the samples of each bin from a curve's values at the nodes.
    """

    trace: Trace
    ramp: Ramp
    velocity_mm_s: float
    steady_force_N: float
    force_N: NDArray
    motion: Motion
    operator: NDArray

    @property
    def hold_s(self) -> float:
        """How long the depth was held. [s]"""
        return self.ramp.hold_end_s - self.ramp.stop_time_s

    @property
    def middle_s(self) -> NDArray:
        """Middle of each bin. [s]"""
        return 0.5 * (self.start_s + self.end_s)

    @property
    def depth_mm(self) -> NDArray:
        """Mean depth of each bin. [mm]"""
        return self.operator @ self.motion.displacement_mm

    @property
    def since_contact(self) -> tuple[NDArray, NDArray]:
        """Time since contact [s] and force [N] of the samples that are used."""
        return self.trace.time_s[self.inside] - self.ramp.contact_time_s, self.trace.force_N[self.inside]

    @property
    def hold(self) -> tuple[NDArray, NDArray]:
        """Time since the stop [s] and force [N] of the samples that are used, from where the punch has rung out."""
        time, force = self.trace.time_s[self.inside], self.trace.force_N[self.inside]
        quiet = time > self.ramp.settled_s if self.ramp.overshoot_mm else np.ones(len(time), bool)
        quiet = quiet if quiet.sum() >= QUIET_SAMPLES else np.ones(len(time), bool)
        return time[quiet] - self.ramp.stop_time_s, force[quiet]


def reduce_trace(trace: Trace) -> ReducedTrace:
    """Cut a press into bins: evenly over the rise, from 1 ms growing by a third each over the hold."""
    ramp = ramp_of(trace, "reached")
    time, force = trace.time_s, trace.force_N
    hold = ramp.hold_end_s - ramp.stop_time_s
    if hold < 5 * ramp.rise_time_s * 0.02 or hold < 0.05:
        needed = max(10.0, 0.1 * ramp.rise_time_s)
        message = (
            f"{trace.name}: a hold of {hold:.3g} s after a rise of {ramp.rise_time_s:.3g} s is too short to see "
            f"relaxation; hold {needed:.3g} s"
        )
        raise InputError(message, "not_enough_data", "hold_s", float(hold))
    edges, settled_s = _edges(ramp, time), ramp.stop_time_s + SETTLED_S
    clip = find_clip(time, trace.displacement_mm, force)
    left_out = None if clip is None else (edges[1:] > clip.start_s) & (edges[:-1] <= clip.end_s)
    binning, nodes = cut(time, edges, left_out), _nodes(time, edges, ramp)
    measured, mean = (of(nodes, time, trace.displacement_mm) for of in (between, mean_around))
    motion = Motion(nodes, np.where(nodes > max(settled_s, ramp.settled_s), mean, measured))
    steady, _ = steady_force(time, trace.displacement_mm, force, ramp)
    velocity = trace.commanded_speed_mm_s or ramp.speed.value_mm_s
    return ReducedTrace(
        **vars(binning),
        trace=trace,
        ramp=ramp,
        velocity_mm_s=velocity,
        steady_force_N=steady,
        force_N=binning.mean(force),
        motion=motion,
        operator=binning.average(time, nodes, (settled_s, np.inf)),
    )


def _edges(ramp: Ramp, time: NDArray) -> NDArray:
    """Bin edges [s]: one bin before contact, the rise, the hold."""
    before = max(float(time[0]), ramp.contact_time_s - 3 * max(float(np.median(np.diff(time))), 1e-3))
    rise = np.linspace(ramp.contact_time_s, ramp.stop_time_s, RISE_BINS + 1)
    hold = ramp.stop_time_s + hold_edges(FIRST_HOLD_S, ramp.hold_end_s - ramp.stop_time_s)
    return np.unique(np.r_[before, rise, hold])


def _nodes(time: NDArray, edges: NDArray, ramp: Ramp) -> NDArray:
    """Times at which the model is evaluated: the samples of the rise (thinned), three per hold bin, and a ringing."""
    rise = time[(time >= edges[0]) & (time < ramp.stop_time_s + SETTLED_S)]
    if len(rise) > RISE_NODES:
        rise = rise[np.unique(np.linspace(0, len(rise) - 1, RISE_NODES).astype(int))]
    elif 1 < len(rise) < FINE_NODES:
        parts = -(-FINE_NODES // len(rise))
        rise = np.interp(np.arange(parts * (len(rise) - 1) + 1) / parts, np.arange(len(rise)), rise)
    hold = edges[edges >= ramp.stop_time_s]
    middle = 0.5 * (hold[:-1] + hold[1:])
    known = np.r_[rise, ramp.contact_time_s, ramp.stop_time_s, ringing_times(ramp)]
    nodes = np.union1d(known, np.r_[hold, middle])
    return distinct(nodes[(nodes >= edges[0]) & (nodes <= ramp.hold_end_s)], 1e-7)


def between(at: NDArray, time: NDArray, x: NDArray) -> NDArray:
    """Motion between samples: cubic by central differences, without overshoot; outside as at the ends.

    Exact for a constant deceleration. A chord would run below the braking of a robot at 250 mm/s, by 4 um at
    1 kHz, which a fit of the fast arm sees. Slopes are at most three times those of the chords beside them, so
    that the curve rises where the samples rise and an abrupt stop stays one.

    References
    ----------
    Fritsch and Carlson, SIAM J. Numer. Anal. 17 (1980) 238 (condition for a monotone cubic).
    """
    if len(time) < 3:
        return np.interp(at, time, x)
    step = np.diff(time)
    chord = np.diff(x) / step
    left, right = chord[:-1], chord[1:]
    middle = (left * step[1:] + right * step[:-1]) / (step[1:] + step[:-1])
    limit = np.where(left * right > 0, 3.0 * np.minimum(np.abs(left), np.abs(right)), 0.0)
    inner = np.clip(middle, -limit, limit)
    ends, most = 2.0 * chord[[0, -1]] - inner[[0, -1]], 3.0 * np.abs(chord[[0, -1]])
    ends = np.where(ends * chord[[0, -1]] > 0, np.clip(ends, -most, most), 0.0)
    slope = np.r_[ends[0], inner, ends[1]]
    index = np.clip(np.searchsorted(time, at, side="right") - 1, 0, len(step) - 1)
    h = step[index]
    t = np.clip((at - time[index]) / h, 0.0, 1.0)
    return (
        x[index] * (1 + 2 * t) * (1 - t) ** 2
        + x[index + 1] * t**2 * (3 - 2 * t)
        + h * t * (1 - t) * (slope[index] * (1 - t) - slope[index + 1] * t)
    )


def rounded_velocity(velocity_mm_s: float) -> float:
    """Nominal speed of a measured one: two significant digits. [mm/s]"""
    return float(f"{velocity_mm_s:.2g}")


def speed_groups(traces: Sequence[ReducedTrace]) -> list[tuple[float, list[ReducedTrace]]]:
    """Group traces whose speeds are within 15 % of their neighbour's: (nominal speed, traces), rising.

    The nominal speed is the commanded one, where it is the same for all of a group; else two digits of the median.
    """
    groups = group_near(traces, lambda trace: trace.velocity_mm_s, SPEED_FACTOR)
    return [(_nominal(group), group) for group in groups]


def _nominal(group: Sequence[ReducedTrace]) -> float:
    commanded = {trace.trace.commanded_speed_mm_s for trace in group}
    if len(commanded) == 1 and None not in commanded:
        return group[0].velocity_mm_s
    return rounded_velocity(float(np.median([trace.velocity_mm_s for trace in group])))


def condition_groups(traces: Sequence[ReducedTrace]) -> list[tuple[float, float, list[ReducedTrace]]]:
    """Group by speed and by depth (5 % apart at most); (speed, mean depth, traces)."""
    return [
        (speed, float(np.mean([t.ramp.depth_mm for t in part])), part)
        for speed, group in speed_groups(traces)
        for part in group_near(group, lambda trace: trace.ramp.depth_mm, SAME_DEPTH)
    ]
