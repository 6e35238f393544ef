"""The test that presses are compared in, where it is said: which presses belong to it, and what of it is missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.tissue.fitting.groups import condition_groups
from dummydesign.tissue.fitting.reduction import ReducedTrace, reduce_trace

if TYPE_CHECKING:
    from dummydesign.measurement.trace import Trace

FORCE_APART, SPEED_APART = 1.2, 1.15
"""A press belongs to a force or a speed of the test within these factors."""
LONGER, SHORTER = 1.02, 0.9
"""Holds over the test's from which on a trace is cut, and below which the test was not made."""
LOW_SHARE = 0.1
PAPER_N, PAPER_STEP_N, MOST_STEPS = (5.0, 15.0), 0.1, 400


@dataclass(frozen=True)
class PressTest:
    """Steady forces, speeds, hold and braking of a test; None for what each press itself was made with.

    Attributes
    ----------
    forces_N, velocities_mm_s : tuple of float or None
        Rising. [N, mm/s]
    hold_s, deceleration_mm_s2 : float or None
    """

    forces_N: tuple[float, ...] | None = None
    velocities_mm_s: tuple[float, ...] | None = None
    hold_s: float | None = None
    deceleration_mm_s2: float | None = None

    @property
    def span_N(self) -> tuple[float, float]:
        """Lowest and highest steady force, between which the steady curve is judged: 5 and 15 N unless said. [N]"""
        return PAPER_N if self.forces_N is None else (self.forces_N[0], self.forces_N[-1])

    @property
    def grid_N(self) -> NDArray:
        """Forces at which the steady curve is shown, from a tenth of the lowest. [N]"""
        low, high = self.span_N
        step = PAPER_STEP_N * low / PAPER_N[0]
        below = np.arange(LOW_SHARE * low, low - 0.5 * step, step)
        count = min(round((high - low) / step), MOST_STEPS)
        return np.r_[below, np.linspace(low, high, count + 1)]

    def speed_of(self, measured_mm_s: float) -> float:
        """The test's speed that a measured one stands for; the measured one where the test says none. [mm/s]"""
        return next((v for v in self.velocities_mm_s or () if _near(measured_mm_s, v, SPEED_APART)), measured_mm_s)


def presses_of(
    traces: Sequence[Trace], test: PressTest
) -> tuple[list[Trace], list[ReducedTrace], list[tuple[str, str]]]:
    """Presses that belong to a test, held no longer than it holds, and what must be said of the others.

    Parameters
    ----------
    traces : sequence of Trace
    test : PressTest

    Returns
    -------
    traces : list of Trace
    reduced : list of ReducedTrace
        The same presses in bins.
    said : list of (code, message)

    Raises
    ------
    InputError
        When no press belongs to the test, with what was pressed.
    """
    every = [_held(trace, test.hold_s) for trace in traces]
    own = [(trace, reduced) for trace, reduced in every if _belongs(reduced, test)]
    said: list[tuple[str, str]] = []
    if every and not own:
        made = sorted({_words(*_condition(reduced)) for _, reduced in every})
        raise InputError(
            f"no press belongs to the test ({_test_words(test)}): the traces are of {'; '.join(made[:6])}; "
            "give --force and --velocity that were pressed"
        )
    others = [trace.name for trace, reduced in every if not _belongs(reduced, test)]
    if others:
        names = ", ".join(others[:5]) + (", ..." if len(others) > 5 else "")
        said.append(("press_outside_test", f"{len(others)} of {len(every)} presses are not of the test "
                     f"({_test_words(test)}) and are left out: {names}"))  # fmt: skip
    return [trace for trace, _ in own], [reduced for _, reduced in own], said


def missing_of(reduced: Sequence[ReducedTrace], test: PressTest, known_mm_s: Sequence[float]) -> str:
    """Why presses do not settle a test, in words; empty when they do.

    Parameters
    ----------
    reduced : sequence of ReducedTrace
        Presses that belong to the test.
    test : PressTest
    known_mm_s : sequence of float
        Speeds of the tissue, wanted where the test says none. [mm/s]
    """
    made = [_condition(trace) for trace in reduced]
    why = []
    if test.velocities_mm_s is None:
        absent = [v for v in known_mm_s if not any(_near(speed, v, 1.5) for _, speed in made)]
        if absent:
            why.append(f"it was not pressed at {' and '.join(f'{v:g}' for v in absent)} mm/s")
    if test.forces_N is None and made:
        low, high = test.span_N
        forces_made = [force for force, _ in made]
        for wanted, reached, side in ((high, max(forces_made), "above"), (low, min(forces_made), "below")):
            if not _near(reached, wanted, FORCE_APART) and (reached < wanted) == (side == "above"):
                why.append(f"it was not pressed {side} {reached:.3g} N")
    if test.forces_N is not None or test.velocities_mm_s is not None:
        speeds = test.velocities_mm_s or tuple(sorted({speed for speed, _, _ in condition_groups(reduced)}))
        forces: tuple[float | None, ...] = test.forces_N or (None,)
        not_made = [
            (force, speed)
            for speed in speeds
            for force in forces
            if not any(
                (force is None or _near(f, force, FORCE_APART)) and _near(v, speed, SPEED_APART) for f, v in made
            )
        ]
        if not_made:
            why.append("it was not pressed " + ", ".join(_to_at(*one) for one in not_made))
    if test.hold_s is not None:
        shortest = min(trace.ramp.hold_end_s - trace.ramp.stop_time_s for trace in reduced)
        if shortest < SHORTER * test.hold_s:
            why.append(f"it was held {shortest:.3g} s of {test.hold_s:g} s")
    return " and ".join(why)


def hold_of(reduced: Sequence[ReducedTrace], test: PressTest) -> float:
    """Hold at whose end steady forces are taken: the test's, else the middle one of the presses. [s]"""
    own = float(np.median([trace.ramp.hold_end_s - trace.ramp.stop_time_s for trace in reduced]))
    return own if test.hold_s is None else min(test.hold_s, own)


def _held(trace: Trace, hold_s: float | None) -> tuple[Trace, ReducedTrace]:
    """The trace, cut at the end of the test's hold where it was held longer, and reduced."""
    reduced = reduce_trace(trace)
    if hold_s is None or reduced.ramp.hold_end_s - reduced.ramp.stop_time_s <= LONGER * hold_s:
        return trace, reduced
    keep = trace.time_s <= reduced.ramp.stop_time_s + hold_s
    cut = replace(
        trace, time_s=trace.time_s[keep], displacement_mm=trace.displacement_mm[keep], force_N=trace.force_N[keep]
    )
    return cut, reduce_trace(cut)


def _belongs(reduced: ReducedTrace, test: PressTest) -> bool:
    force, speed = _condition(reduced)
    return (test.forces_N is None or any(_near(force, one, FORCE_APART) for one in test.forces_N)) and (
        test.velocities_mm_s is None or any(_near(speed, one, SPEED_APART) for one in test.velocities_mm_s)
    )


def _condition(reduced: ReducedTrace) -> tuple[float, float]:
    return reduced.steady_force_N, reduced.velocity_mm_s


def _near(value: float, wanted: float, factor: float) -> bool:
    return wanted / factor < value < wanted * factor


def _words(force_N: float, velocity_mm_s: float) -> str:
    return f"{force_N:.2g} N at {velocity_mm_s:.2g} mm/s"


def _to_at(force_N: float | None, velocity_mm_s: float) -> str:
    return f"{'' if force_N is None else f'to {force_N:g} N '}at {velocity_mm_s:g} mm/s"


def _test_words(test: PressTest) -> str:
    forces = None if test.forces_N is None else f"{', '.join(f'{v:g}' for v in test.forces_N)} N"
    speeds = None if test.velocities_mm_s is None else f"{', '.join(f'{v:g}' for v in test.velocities_mm_s)} mm/s"
    return " at ".join(filter(None, (forces, speeds)))
