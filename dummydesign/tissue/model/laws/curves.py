"""No law: people are the curves that were measured, and what was not pressed is refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.tissue.model.maxwell_law import MaxwellLaw, MotionResponse
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, HOLD_FACTOR, LAW, SHARES, common_span, hold_times


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


CURVES = Curves()
