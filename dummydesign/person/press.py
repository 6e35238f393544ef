"""One press of a trace: contact, stop and end, smooth depth and force of the pad, and their errors."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import LATE, work_to_deepest_mJ
from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.ramp_detection import Ramp, ramp_of
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.person.smoothing import (
    RobotArm,
    SmoothCurve,
    growing_nodes,
    real_bends,
    smooth_curve,
    smoothed_ringing,
    still_rings,
)
from dummydesign.tissue.fitting.reduction import rounded_velocity

RISE_NODES, AFTER = 160, 0.25
"""Nodes from contact to a quarter of the rise (8 ms at least) after the stop; then each interval is 8 % longer."""
AFTER_S = 0.008
MOST_ROUNDS, MOST_NODES = 5, 900
"""How often nodes are added where samples show more, and up to how many."""
CONTACT_SD_MM = 0.01
"""Standard deviation of where a trace has its zero: half of the 0.02 mm to which a robot is taken to repeat."""
CURVE_ERROR = 0.002
"""Relative standard deviation of what smoothing rounds off a force up to the stop, less after it: peaks of simulated
presses are off by 0.05 to 0.34 % where a robot stops sharply."""
SHORTEST_HOLD_S = 0.3
CONTACT_WINDOW, LEAST_NEAR, SPEED_SHARE = 0.3, 5, 0.002
"""Share of the rise on both sides of contact whose samples give the speed there, how many there are at least on a
side, and the relative error of their curve."""
RINGS = 5
"""Intervals after the stop in which samples show more than the nodes: an arm that rings on."""
LATE_CONTACT = 0.6
"""Share of the depth at which a force must have begun."""
SEEN = 6.0
"""Multiple of the noise that the force of a press must reach."""
MOVING = 0.35
"""Share of the speed at which a trace that ends is still moving."""


@dataclass(frozen=True, eq=False)
class Press:
    """A press on the pad, from contact to the end of the hold; time counts from contact.

    Attributes
    ----------
    trace : Trace
    time_s : ndarray, shape (n,)
        Nodes; finer about the stop.
    x_mm, force_N : ndarray, shape (n,) or (p, n)
        Depth and force of the pad at the nodes; several where they are drawn from their errors.
    x_factor, force_factor : ndarray, shape (n, k)
        Roots of the covariances.
    contact_s, stop_s, hold_s, velocity_mm_s : float
        Time of contact in the trace; stop, hold and speed of the robot, two digits. [s, mm/s]
    contact_mm_s : ndarray, shape () or (p,)
        Speed at contact. [mm/s]
    contact_sd_mm_s : float
        Its standard deviation. [mm/s]
    steady_N : ndarray or None
        Mean of the last twentieth of the hold, shape () or (p,); None without a hold.
    noise_N : float
        Noise of one sample.
    rings : bool
        Whether an arm is seen to ring on in the hold.
    mean_from_s : float
        From when on depth and force are means over the ringing of the arm; infinite where they are not. [s]
    approached : bool
        Whether the path before contact is recorded; without it the speed at contact is a guess.
    """

    trace: Trace
    time_s: NDArray
    x_mm: NDArray
    force_N: NDArray
    x_factor: NDArray
    force_factor: NDArray
    contact_s: float
    stop_s: float
    hold_s: float
    velocity_mm_s: float
    contact_mm_s: NDArray
    contact_sd_mm_s: float
    steady_N: NDArray | None
    noise_N: float
    rings: bool = False
    mean_from_s: float = np.inf
    approached: bool = True

    @property
    def peak_N(self) -> NDArray:
        """Largest force. [N]"""
        return self.force_N.max(axis=-1)

    @property
    def depth_mm(self) -> NDArray:
        """Largest depth. [mm]"""
        return self.x_mm.max(axis=-1)

    @property
    def energy_mJ(self) -> NDArray:
        """Work on the pad from contact to its largest depth. [mJ]"""
        return work_to_deepest_mJ(np.broadcast_to(self.x_mm, self.force_N.shape), self.force_N)

    @property
    def stopped(self) -> int:
        """Number of the node with the largest depth."""
        return int(np.argmax(self.x_mm if self.x_mm.ndim == 1 else self.x_mm.mean(axis=0)))

    @property
    def lost_mm_s(self) -> NDArray | float:
        """Speed of the path where its means begin: what it was just before, less that of the means. [mm/s]"""
        if not np.isfinite(self.mean_from_s):
            return 0.0
        last = int(np.searchsorted(self.time_s, self.mean_from_s * (1.0 + 1e-12), side="right")) - 1
        slope = np.diff(self.x_mm, axis=-1) / np.diff(self.time_s)
        before = 1.5 * slope[..., last - 1] - 0.5 * slope[..., last - 2]
        return np.asarray(before - slope[..., last + 1])

    @property
    def late_from_s(self) -> float:
        """Time from which on the mean of the force is the steady force; infinite without a hold. [s]"""
        return np.inf if self.steady_N is None else float(self.time_s[-1]) - LATE * self.hold_s

    def drawn(self, count: int, rng: np.random.Generator) -> Press:
        """Draw presses that may be behind the trace: noise of both columns, and where contact is."""
        x = self.x_mm + rng.standard_normal((count, self.x_factor.shape[1])) @ self.x_factor.T
        shift = CONTACT_SD_MM * rng.standard_normal((count, 1))
        force = self.force_N + rng.standard_normal((count, self.force_factor.shape[1])) @ self.force_factor.T
        steady = None
        if self.steady_N is not None:
            steady = self.steady_N + (force - self.force_N)[:, self.time_s >= self.late_from_s].mean(axis=-1)
        near = np.exp(-np.maximum(self.time_s / self.stop_s - 1.0, 0.0))
        force = force * (1.0 + CURVE_ERROR * rng.standard_normal((count, 1)) * near)
        speed = np.maximum(self.contact_mm_s + self.contact_sd_mm_s * rng.standard_normal(count), 1e-3)
        return replace(self, x_mm=x - shift, force_N=force, steady_N=steady, contact_mm_s=speed)


def read_press(trace: Trace, lowpass: Lowpass | None = None, arm: RobotArm | None = None) -> Press:
    """Find the press in a trace and smooth it; a declared filter of the force is undone.

    With an arm, its ringing is followed closely for some time and averaged over afterwards.

    Raises
    ------
    InputError
        For a trace without contact, one that begins pressed, or ends before the stop.
    """
    time, x, force = trace.time_s, trace.displacement_mm, trace.force_N
    noise = float(noise_of(force))
    largest = float(force.max())
    if largest <= SEEN * noise or float(x.max()) <= 0.0:
        message = f"{trace.name}: no contact: the force never rises above its noise"
        raise InputError(message, "nothing_found", "contact", largest)
    ramp = ramp_of(trace)
    _check_contact(trace, ramp.contact_time_s, noise, lowpass is not None)
    velocity = rounded_velocity(trace.commanded_speed_mm_s or ramp.speed.value_mm_s)
    _check_stop(trace, ramp, velocity)
    used = (time >= ramp.contact_time_s) & (time <= max(ramp.hold_end_s, float(time[np.argmax(x)])))
    since, hold = time[used] - ramp.contact_time_s, float(time[used][-1]) - ramp.stop_time_s
    stop, mean_from = ramp.rise_time_s, np.inf
    nodes = _nodes(stop, float(since[-1]))
    if arm is None:
        path, load, nodes = _smoothed(since, x[used], force[used], nodes, lowpass)
    else:
        path, load, nodes, mean_from = smoothed_ringing(since, x[used], force[used], nodes, stop, arm, lowpass)
    speed, error = contact_speed(time - ramp.contact_time_s, x, stop, path.noise)
    approached = bool(time[0] <= ramp.contact_time_s - LEAST_NEAR * float(np.median(np.diff(time))))
    if not approached:
        # without an approach the curve starts too steep where the robot brakes
        speed = np.minimum(speed, ramp.speed.value_mm_s)
    rings = int(((path.coarse | load.coarse) & (nodes[:-1] > 2.0 * stop)).sum()) >= RINGS
    if arm is not None:
        rings = still_rings(path, nodes, min(mean_from, float(nodes[-1])), arm.period_s)
    late = force[used][since >= since[-1] - LATE * hold]
    steady = np.asarray(late.mean()) if hold >= SHORTEST_HOLD_S else None
    return Press(
        trace,
        nodes,
        path.value,
        np.maximum(load.value, 0.0),
        path.factor,
        load.factor,
        ramp.contact_time_s,
        stop,
        hold,
        velocity,
        speed,
        error,
        steady,
        load.noise,
        rings,
        mean_from,
        approached,
    )


def contact_speed(time_s: NDArray, x_mm: NDArray, stop_s: float, noise_mm: float) -> tuple[NDArray, float]:
    """Speed at contact and its standard deviation. [mm/s]

    A parabola through as much before contact as after it, at most 0.3 rises, with a cubic from contact on: what a pad
    takes of the speed of a free mass begins there. A trace that begins at contact is read from a parabola alone.
    """
    lead, step = float(-time_s[0]), float(np.median(np.diff(time_s)))
    seen = lead >= LEAST_NEAR * step
    scale = max(min(lead, CONTACT_WINDOW * stop_s) if seen else 0.5 * CONTACT_WINDOW * stop_s, LEAST_NEAR * step)
    near = np.abs(time_s) <= scale * (1.0 + 1e-9)
    time = time_s[near] / scale
    powers = [np.ones(len(time)), time, time**2, np.maximum(time, 0.0) ** 3]
    inverse = np.linalg.pinv(np.stack(powers[: 4 if seen else 3], axis=-1))
    slope = max(float(inverse[1] @ x_mm[near]) / scale, 1e-3)
    return np.asarray(slope), float(np.hypot(noise_mm * np.linalg.norm(inverse[1]) / scale, SPEED_SHARE * slope))


def _smoothed(
    since: NDArray, x: NDArray, force: NDArray, nodes: NDArray, lowpass: Lowpass | None
) -> tuple[SmoothCurve, SmoothCurve, NDArray]:
    """Smooth path and force at nodes; an arm that rings gets more nodes than a press that relaxes.

    With more nodes the roughness is that over time: the weight that lets wide nodes follow the ringing of a hold would
    leave close nodes without samples, those of the rise, free to scatter, and peaks drawn from them too high.
    """

    def both(nodes: NDArray, bends: NDArray | None = None) -> tuple[SmoothCurve, SmoothCurve]:
        return smooth_curve(since, x, nodes, bends=bends), smooth_curve(since, force, nodes, lowpass, bends=bends)

    (path, load), usual = both(nodes), len(nodes)
    for _ in range(MOST_ROUNDS):
        coarse = path.coarse | load.coarse
        if not coarse.any() or len(nodes) + coarse.sum() > MOST_NODES:
            break
        nodes = np.sort(np.r_[nodes, 0.5 * (nodes[1:] + nodes[:-1])[coarse]])
        path, load = both(nodes)
    if len(nodes) > usual:
        path, load = both(nodes, real_bends(nodes))
    return path, load, nodes


def _nodes(stop_s: float, end_s: float) -> NDArray:
    """Times since contact: even to a little after the stop, then growing. [s]"""
    fine = min(stop_s + max(AFTER * stop_s, AFTER_S), end_s)
    even = np.linspace(0.0, fine, RISE_NODES + 1)
    if fine >= end_s * (1.0 - 1e-9):
        return even
    return np.r_[even, growing_nodes(fine, end_s, fine / RISE_NODES, 1, first=1)]


def _check_contact(trace: Trace, contact_s: float, noise_N: float, delayed: bool) -> None:
    """Refuse a trace that carries load at its zero of displacement, or touches long after it.

    A filter delays the force, so that nothing is known of the second.
    """
    peak, time, x = float(trace.force_N.max()), trace.time_s, trace.displacement_mm
    near = int(np.searchsorted(time, contact_s, side="right"))
    touched = float(trace.force_N[: max(near, 1)].max())
    if touched > max(0.1 * peak, SEEN * noise_N):
        message = (
            f"{trace.name}: carries {touched:.3g} N at displacement 0; contact must be zero in both columns, "
            "'dummydesign import' finds it"
        )
        raise InputError(message, "inconsistent", "contact", touched, 0.0)
    loaded = trace.force_N > max(0.02 * peak, SEEN * noise_N)
    first = float(x[int(np.argmax(loaded))])
    if first > LATE_CONTACT * float(x.max()) and not delayed:
        message = (
            f"{trace.name}: carries no force down to {first:.3g} mm of {float(x.max()):.3g} mm; contact must be at "
            "displacement 0, 'dummydesign import' finds it"
        )
        raise InputError(message, "inconsistent", "contact", first, 0.0)


def _check_stop(trace: Trace, ramp: Ramp, velocity_mm_s: float) -> None:
    """Refuse a trace that ends while the punch still goes deeper."""
    time, x, rise = trace.time_s, trace.displacement_mm, ramp.rise_time_s
    if time[-1] - ramp.stop_time_s > max(5.0 * float(np.median(np.diff(time))), 0.05 * rise):
        return
    back = min(int(np.searchsorted(time, time[-1] - 0.1 * rise)), len(x) - 3)
    speed = float((x[-1] - x[back]) / (time[-1] - time[back]))
    if speed > MOVING * velocity_mm_s:
        message = f"{trace.name}: ends before the stop, at {speed:.3g} mm/s; record until the punch holds or leaves"
        raise InputError(message, "not_enough_data", "hold_s", speed)
