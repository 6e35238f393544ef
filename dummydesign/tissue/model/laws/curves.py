"""No law: people are the curves that were measured, and what was not pressed is refused."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.tissue.model.held_press import FORCE_APART, HOLD_APART, SHARES, hold_times
from dummydesign.tissue.model.maxwell_law import Drive, MaxwellLaw
from dummydesign.tissue.model.measured_curves import LAW, MeasuredParameters, MeasuredPerson

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters


class Curves(MaxwellLaw):
    """Measured curves: presses between those that were made, no parameters, nothing under any other motion."""

    name = LAW
    words = "measured curves, without a law"
    reference = "the curves themselves"
    elements = (1,)
    steady_name = "none"
    fitted = False
    measured = True

    def said_of(self, name: str) -> tuple[str, str]:
        """That there are no parameters and nothing beside what was pressed."""
        return "measured_curves", curves_words(name)

    def drive(self, motion: Motion) -> Drive:
        """Curves answer to no motion."""
        raise InputError("measured curves give the presses that were made, not the force under any motion")

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """Curves say nothing of a free mass."""
        raise InputError("measured curves say nothing of a robot of finite mass; it needs a tissue with a law")

    def steady_depths(self, subjects: Sequence[Parameters], force_N: ArrayLike) -> NDArray:
        """Depth of each at forces at the end of its own shortest hold, shape (subjects, ...). [mm]"""
        return np.stack([one.depth_mm(force_N, np.inf) for one in _people(subjects)])

    def steady_forces(self, subjects: Sequence[Parameters], depth_mm: ArrayLike) -> NDArray:
        """Force of each at the end of its own shortest hold, shape (subjects, ...). [N]"""
        return np.stack([cast(MeasuredPerson, one).steady_N(depth_mm, np.inf) for one in subjects])

    def exponent_of(self, subjects: Sequence[Parameters], low_N: float, high_N: float, hold_s: float) -> float:
        """Mean exponent of the steady curves between two forces, or about the one.

        Parameters
        ----------
        subjects : sequence of Parameters
            People or an aim.
        low_N, high_N : float
            [N]
        hold_s : float
            At whose end forces are steady. [s]
        """
        ends = np.array([low_N, high_N]) if high_N > low_N else low_N * np.array([0.9, 1.1])
        depth = np.log([one.depth_mm(ends, hold_s) for one in _people(subjects)])
        return float(np.mean(np.log(ends[1] / ends[0]) / (depth[:, 1] - depth[:, 0])))

    def held_depths(
        self, subjects: Sequence[Parameters], force_N: NDArray, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:  # fmt: skip
        """Depths on the steady curves, shape (subjects, n). [mm]"""
        return np.stack([one.depth_mm(force_N, hold_s) for one in _people(subjects)])

    def end_of_hold_depths(
        self, subjects: Sequence[Parameters], force_N: NDArray, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:  # fmt: skip
        """The same; see :meth:`~dummydesign.tissue.model.laws.curves.Curves.held_depths`."""
        return self.held_depths(subjects, force_N, velocity_mm_s, hold_s, deceleration_mm_s2)

    def press(
        self, subjects: Sequence[Parameters], force_N: float, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> tuple[Motion, NDArray, NDArray]:  # fmt: skip
        """The press of each to a force at the end of the hold, between those that were made.

        Raises
        ------
        InputError
            For a force, speed or hold that was not pressed, with what was.
        """
        people = _people(subjects)
        self.check(people, force_N, velocity_mm_s, hold_s)
        depth = np.array([float(one.depth_mm(force_N, hold_s)) for one in people])
        motion = ramp_and_hold(velocity_mm_s, depth, hold_s, deceleration_mm_s2)
        since = motion.time_s - (motion.time_s[:, -1:] - hold_s)
        force = np.empty_like(since)
        for row, one in enumerate(people):
            rise, hold = one.shape_N(force_N, velocity_mm_s, hold_s)
            rising = np.interp(motion.displacement_mm[row] / depth[row], SHARES, rise)
            force[row] = np.where(since[row] <= 0.0, rising, np.interp(since[row], hold_times(hold_s), hold))
        return motion, force, depth

    def check(
        self, people: Sequence[MeasuredParameters], force_N: float, velocity_mm_s: float, hold_s: float
    ) -> None:
        """Refuse a press that curves do not hold, in one line with the test that they do.

        Parameters
        ----------
        people : sequence of MeasuredParameters
            Who were pressed.
        force_N, velocity_mm_s, hold_s : float
            [N, mm/s, s]

        Raises
        ------
        InputError
        """
        longest = min(one.hold_known_s() for one in people)
        hold = min(hold_s, longest)
        spans = [one.known_N(velocity_mm_s, hold) for one in people]
        known = [span for span in spans if span is not None]
        low, high = (max(s[0] for s in known), min(s[1] for s in known)) if known else (np.nan, np.nan)
        if (
            len(known) == len(spans)
            and low / FORCE_APART <= force_N <= high * FORCE_APART
            and hold_s <= HOLD_APART * longest
        ):
            return
        raise InputError(
            f"{force_N:g} N at {velocity_mm_s:g} mm/s, held {hold_s:g} s, was not pressed: the tissue is measured "
            f"curves, without a law that would carry them on; all its people were pressed {known_words(people, hold)}"
        )


def known_words(people: Sequence[MeasuredParameters], hold_s: float = np.inf) -> str:
    """The tests that everyone's curves hold, as options of the commands.

    Parameters
    ----------
    people : sequence of MeasuredParameters
    hold_s : float
        At whose end forces are taken, at most the longest that all were held for. [s]
    """
    speeds = sorted(set.intersection(*(set(one.velocities_mm_s) for one in people)))
    longest = min(one.hold_known_s() for one in people)
    hold = min(hold_s, longest)
    spans = {}
    for speed in speeds:
        ends = [span for one in people if (span := one.known_N(speed, hold)) is not None]
        low, high = max(s[0] for s in ends) / FORCE_APART, min(s[1] for s in ends) * FORCE_APART
        if low <= high:
            spans[speed] = low, high
    if not spans:
        return "to no steady force in common at one speed"
    low, high = max(low for low, _ in spans.values()), min(high for _, high in spans.values())
    forces = f"--force within {low:.3g} to {high:.3g} N" if low <= high else "; ".join(
        f"--force within {a:.3g} to {b:.3g} N at {speed:g} mm/s" for speed, (a, b) in spans.items()
    )  # fmt: skip
    less = " or less" if hold > 0.99 * longest else ""
    return f"{forces}, --velocity {','.join(f'{v:g}' for v in spans)}, --hold {hold:.3g}{less}"


def _people(subjects: Sequence[Parameters]) -> list[MeasuredParameters]:
    return [cast(MeasuredParameters, one) for one in subjects]


CURVES = Curves()


def curves_words(name: str) -> str:
    """What must be said of a tissue that is measured curves."""
    return (
        f"{name} is measured curves, without a law: pads are held against their ranges of peaks, steady forces and "
        "energies; there are no parameters, and nothing is carried on to presses that were not made"
    )
