"""The known laws of soft tissue, instances of ``MaxwellLaw``; a new one is a class here and an entry of ``LAWS``."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.tissue.model.maxwell_law import LAWS, MaxwellLaw, MotionResponse
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, HOLD_FACTOR, LAW, SHARES, common_span, hold_times


class Spring(MaxwellLaw):
    """F = k x with the effective spring constant k of a body region, as ISO/TS 15066:2016, annex A, models contact."""

    name = "spring"
    words = "one spring constant"
    reference = "the model of contact of ISO/TS 15066:2016, annex A"
    elements = (1,)
    power = 1.0
    steady_name = "k_N_per_mm"
    fitted = False

    def notice_of(self, name: str) -> tuple[str, str]:
        """Say that it says nothing of speed and relaxation."""
        return "spring_tissue", (
            f"{name} is a spring constant: it says nothing of speed and relaxation, so peaks are compared with the "
            "steady force itself; a pad that relaxes reads high in them, and one that does not may still be below a "
            "person's"
        )

    def drive(self, motion: Motion) -> MotionResponse:
        """Drive by the depth as it is: X = x. [mm]"""
        drive = MotionResponse()
        drive.elastic = np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        return drive

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """There is no arm."""
        return np.ones_like(rate), np.zeros_like(rate)


_GAUSS_X, _GAUSS_W = (0.5 * (x + shift) for x, shift in zip(np.polynomial.legendre.leggauss(4), (1.0, 0.0)))


class Ode(MaxwellLaw):
    """Springs gamma x^2 in series with dampers c: stretch e' = x' - (gamma / c) x^2 e, arm force gamma x^2 e."""

    name = "ode"
    words = "the differential equation of the arms along the measured motion"
    reference = (
        "our reading of figure 6(b) of 'Development of Dummy Based on Impedance Properties of Human Soft Tissue Using "
        "a Nonlinear Viscoelastic Model', IEEE Access"
    )

    def drive(self, motion: Motion) -> OdeDrive:
        """Drive by the motion as it is."""
        return OdeDrive(motion)

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """Gain 1, decay r x^2."""
        return np.ones_like(rate), rate * (depth_mm**2)[..., None]


class OdeDrive(MotionResponse):
    """X = x^3, and A = x^2 e by the exact integrating factor of each step on which x is linear."""

    def __init__(self, motion: Motion) -> None:
        time = np.asarray(motion.time_s, float)
        self._x = np.maximum(np.asarray(motion.displacement_mm, float), 0.0)
        self._step = np.diff(time, axis=-1)
        self.elastic = self._x**3

    def arm(self, rate: ArrayLike) -> NDArray:
        """A(t; r). [mm3]"""
        rate = np.asarray(rate, float)[..., None]
        before, after = self._x[..., :-1], self._x[..., 1:]
        rise = after - before
        decay = rate * self._step * (before**2 + before * after + after**2) / 3.0
        # nothing is added to the stretch while nothing moves: the hold's samples are left out
        moving = np.flatnonzero((rise != 0.0).any(axis=tuple(range(rise.ndim - 1))))
        added = np.zeros(decay.shape)
        if len(moving):
            rate_step = (rate * self._step)[..., moving]
            parts = after[..., moving], rise[..., moving], decay[..., moving]
            added[..., moving] = parts[1] * _mean_survival(rate_step, *parts)
        stretch = linear_recurrence(np.exp(-decay), added)
        response = np.zeros(np.broadcast_shapes(rate.shape[:-1] + (1,), self._x.shape))
        response[..., 1:] = after**2 * stretch
        return response


def _mean_survival(rate_step: NDArray, after: NDArray, rise: NDArray, decay: NDArray) -> NDArray:
    """Mean over a step of exp(-decay from then to the step's end): the rest of stretch added evenly.

    With w the share of the step still to go, the decay is r dt (x1^2 w - x1 dx w^2 + dx^2 w^3 / 3). Four
    Gauss points per panel; panels halve towards the end of the step, where a fast arm keeps its memory.
    The relative error stays below 2e-6.
    """
    strongest = float(np.max(decay, where=np.broadcast_to(rise != 0, decay.shape), initial=0.0))
    panels = 1 if strongest < 0.25 else 2 + int(np.ceil(np.log2(max(strongest, 1.0))))
    edges = np.r_[0.0, 0.5 ** np.arange(panels - 1, -1, -1)]
    linear, square, cubic = rate_step * after**2, rate_step * after * rise, rate_step * rise**2 / 3.0
    total, left = np.zeros(decay.shape), np.empty(decay.shape)
    for low, high in itertools.pairwise(edges):
        for point, weight in zip(_GAUSS_X, _GAUSS_W):
            w = low + (high - low) * point
            # exp(-w (linear - w (square - w cubic))), in place
            np.subtract(square, np.multiply(cubic, w, out=left), out=left)
            np.subtract(linear, np.multiply(left, w, out=left), out=left)
            np.exp(np.multiply(left, -w, out=left), out=left)
            total += np.multiply(left, (high - low) * weight, out=left)
    return total


class IdealRamp(MaxwellLaw):
    """Equation (5) of the paper, which knows speed v and stop time t_p only.

    An arm of rate r carries v / r (1 - exp(-r v^2 t^3)) while it is loaded, times exp(-r (v t_p)^2 (t - t_p)) after.
    ``running_clock`` puts t for t_p there, as the exponent is printed.
    """

    ideal_ramp = True
    reference = (
        "'Development of Dummy Based on Impedance Properties of Human Soft Tissue Using a Nonlinear Viscoelastic "
        "Model', IEEE Access, equations (4) to (6)"
    )
    running_clock: ClassVar[bool]

    def drive(self, motion: Motion) -> RampDrive:
        """Drive by the ideal ramp with the contact, stop and depth of the motion."""
        return RampDrive(motion, self.running_clock)


class Consistent(IdealRamp):
    """With the stop time in the exponent: the force is continuous at the stop."""

    name = "consistent"
    words = "equation (5) for an ideal ramp, continuous at the stop"
    running_clock = False


class Published(IdealRamp):
    """With the running time in the exponent, as printed."""

    name = "published"
    words = "equation (5) for an ideal ramp, as printed"
    running_clock = True


class RampDrive(MotionResponse):
    """X and A of the ideal ramp that stands in for a motion."""

    def __init__(self, motion: Motion, running_clock: bool) -> None:
        contact, stop, depth = ramps_of(motion)
        self._running_clock = running_clock
        self._rise, self._depth = (stop - contact)[..., None], depth[..., None]
        self._velocity = self._depth / self._rise
        self._since = np.maximum(np.asarray(motion.time_s, float) - contact[..., None], 0.0)
        self.elastic = (self._velocity * np.minimum(self._since, self._rise)) ** 3

    def arm(self, rate: ArrayLike) -> NDArray:
        """A(t; r). [mm3]"""
        r = np.maximum(np.asarray(rate, float)[..., None], 1e-300)
        v, peak_time = self._velocity, self._rise
        rising = np.minimum(self._since, peak_time)
        held = np.maximum(self._since - peak_time, 0.0)
        clock = np.maximum(self._since, peak_time) if self._running_clock else peak_time
        loaded = -np.expm1(-r * v**2 * rising**3) * v / r
        return loaded * np.exp(-r * (v * clock) ** 2 * held)


def ramps_of(motion: Motion) -> tuple[NDArray, NDArray, NDArray]:
    """Contact time [s], stop time [s] and depth [mm] of each motion, each of shape (...)."""
    from dummydesign.measurement.ramp_detection import find_ramp

    time, x = np.broadcast_arrays(motion.time_s, motion.displacement_mm)
    ramps = [find_ramp(*row) for row in zip(time.reshape(-1, time.shape[-1]), x.reshape(-1, x.shape[-1]))]
    names = ("contact_time_s", "stop_time_s", "depth_mm")
    contact, stop, depth = (np.reshape([getattr(one, name) for one in ramps], time.shape[:-1]) for name in names)
    return contact, stop, depth


class Curves(MaxwellLaw):
    """Measured curves: presses between those that were made, no parameters, nothing under any other motion.

    Its subjects are ``Measured``, whatever the contract says of parameters.
    """

    name = LAW
    words = "measured curves, without a law"
    reference = "the curves themselves"
    elements = (1,)
    steady_name = "none"
    fitted = False
    measured = True

    def notice_of(self, name: str) -> tuple[str, str]:
        """Say that there are no parameters and nothing beside what was pressed."""
        return "measured_curves", (
            f"{name} is measured curves, without a law: pads are compared with their ranges of peaks, steady forces "
            "and energies; there are no parameters, and nothing is extrapolated to presses that were not made"
        )

    def drive(self, motion: Motion) -> MotionResponse:
        """Curves answer to no motion."""
        message = "measured curves give the presses that were made, not the force under any motion"
        raise InputError(message, "unsupported", "law", LAW)

    def steady_depths(self, subjects: Sequence[Any], force_N: ArrayLike) -> NDArray:
        """Depth of each at forces at the end of its own shortest hold, shape (subjects, ...). [mm]"""
        return np.stack([one.depth_mm(force_N, np.inf) for one in subjects])

    def exponent_of(self, subjects: Sequence[Any], low_N: float, high_N: float, hold_s: float) -> float:
        """Mean exponent of the steady curves between two forces, or about the one."""
        ends = np.array([low_N, high_N]) if high_N > low_N else low_N * np.array([0.9, 1.1])
        depth = np.log([one.depth_mm(ends, hold_s) for one in subjects])
        return float(np.mean(np.log(ends[1] / ends[0]) / (depth[:, 1] - depth[:, 0])))

    def held_depths(
        self,
        subjects: Sequence[Any],
        force_N: NDArray,
        velocity_mm_s: float,
        hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:
        """Depths on the steady curves, shape (subjects, n). [mm]"""
        return np.stack([one.depth_mm(force_N, hold_s) for one in subjects])

    def press(
        self,
        subjects: Sequence[Any],
        force_N: float,
        velocity_mm_s: float,
        hold_s: float,
        deceleration_mm_s2: float,
    ) -> tuple[Motion, NDArray, NDArray]:
        """The press of each to a force at the end of the hold, between those that were made."""
        self.check(subjects, force_N, velocity_mm_s, hold_s)
        depth = np.array([float(one.depth_mm(force_N, hold_s)) for one in subjects])
        motion = ramp_and_hold(velocity_mm_s, depth, hold_s, deceleration_mm_s2)
        since = motion.time_s - (motion.time_s[:, -1:] - hold_s)
        force = np.empty_like(since)
        for row, one in enumerate(subjects):
            rise, hold = one.shape_N(force_N, velocity_mm_s, hold_s)
            rising = np.interp(motion.displacement_mm[row] / depth[row], SHARES, rise)
            force[row] = np.where(since[row] <= 0.0, rising, np.interp(since[row], hold_times(hold_s), hold))
        return motion, force, depth

    def check(self, people: Sequence[Any], force_N: float, velocity_mm_s: float, hold_s: float) -> None:
        """Refuse a press that curves do not hold, in one line with the test that they do."""
        longest = min(one.hold_known_s() for one in people)
        hold = min(hold_s, longest)
        span, too_long = common_span(people, velocity_mm_s, hold), hold_s > HOLD_FACTOR * longest
        if span and span[0] / FORCE_FACTOR <= force_N <= span[1] * FORCE_FACTOR and not too_long:
            return
        raise InputError(
            f"{force_N:g} N at {velocity_mm_s:g} mm/s, held {hold_s:g} s, was not pressed: the tissue is measured "
            "curves, without a law that would carry them on; all its subjects were pressed "
            f"{known_words(people, hold)}",
            "out_of_range",
            "velocity_mm_s" if span is None else "hold_s" if too_long else "force_N",
        )


def known_words(people: Sequence[Any], hold_s: float = np.inf) -> str:
    """The tests that everyone's curves hold, as options of the commands."""
    longest = min(one.hold_known_s() for one in people)
    hold, spans = min(hold_s, longest), {}
    for speed in sorted(set.intersection(*(set(one.velocities_mm_s) for one in people))):
        span = common_span(people, speed, hold)
        if span and span[0] / FORCE_FACTOR <= span[1] * FORCE_FACTOR:
            spans[speed] = span[0] / FORCE_FACTOR, span[1] * FORCE_FACTOR
    if not spans:
        return "to no steady force in common at one speed"
    low, high = max(low for low, _ in spans.values()), min(high for _, high in spans.values())
    forces = (
        f"--force within {low:.3g} to {high:.3g} N"
        if low <= high
        else "; ".join(f"--force within {a:.3g} to {b:.3g} N at {speed:g} mm/s" for speed, (a, b) in spans.items())
    )
    less = " or less" if hold > 0.99 * longest else ""
    return f"{forces}, --velocity {','.join(f'{v:g}' for v in spans)}, --hold {hold:.3g}{less}"


CURVES, CONSISTENT, PUBLISHED, ODE, SPRING = Curves(), Consistent(), Published(), Ode(), Spring()
LAWS.update({law.name: law for law in (CURVES, CONSISTENT, PUBLISHED, ODE, SPRING)})
