"""Curves and uncertainty budget of a pad that was cast and pressed: its traces against the tissue's subjects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.budget import (
    TRACE,
    Budget,
    EndSpread,
    budget_of_pad,
    spread_of_ends,
    usable_limits,
)
from dummydesign.design.assessment.curves import CurveMatch, PressCurve, match_of_presses
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import DRAWN, press_subjects
from dummydesign.design.scoring.verdict import Ranges, Readings
from dummydesign.measurement.motion import work_mJ
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, force_range, force_ranges

if TYPE_CHECKING:
    from dummydesign.measurement.sensor import Lowpass
    from dummydesign.tissue.comparison import ComparedPress, Comparison
    from dummydesign.tissue.model.tissue import Tissue


def curves_of_traces(comparison: Comparison, tissue: Tissue, lowpass: Lowpass | None = None) -> CurveMatch:
    """Compare measured presses with the subjects' ranges and the tissue's average, each in its own test."""
    aim = tissue.target("average")
    noise = comparison.noise_N
    conditions = []
    for (speed, pressed), row in zip(comparison.conditions, _shares(comparison)):
        curves = []
        for (trace, band, braking), share in zip(pressed, row):
            time, force = trace.since_contact
            own = force_range((aim,), trace.steady_force_N, speed, trace.hold_s, braking, lowpass)
            near = max(STEADY_TOLERANCE * trace.steady_force_N, 3.0 * noise)
            curves.append(
                PressCurve(trace.steady_force_N, speed, time, force, trace.ramp.rise_time_s, band, own, share, near)
            )
        conditions.append(curves)
    return match_of_presses(conditions)


def _shares(comparison: Comparison) -> list[list[float]]:
    """Shares of the time inside, press by press of each condition."""
    every = iter(float(row["inside_fraction"]) for row in comparison.result["by_trace"])
    return [[next(every) for _ in pressed] for _, pressed in comparison.conditions]


def budget_of_traces(
    comparison: Comparison, tissue: Tissue, ranges: Ranges, readings: Readings, spread: Readings
) -> Budget | None:
    """Make the budget of a pressed pad: its trace (noise, repeats, zero of depth) and the subjects.

    Resin, making and force law are no parts: the pad itself was measured. Ranges and readings are those of
    :func:`~dummydesign.design.measured_pad.readings_of_traces`.
    """
    limits, ends = usable_limits(verdict_limits(), ranges.strict), _spread_of_ends(comparison, tissue, ranges)
    return budget_of_pad(ranges, readings, limits, {TRACE: spread}, spread, ends)


def _spread_of_ends(comparison: Comparison, tissue: Tissue, ranges: Ranges) -> EndSpread | None:
    """How uncertain the subjects' ranges are in the presses that were made, the first of each condition."""
    drawn = tissue.drawn(DRAWN)
    if not drawn:
        return None
    first = [pressed[0] for _, pressed in comparison.conditions]
    by_press = [_outer(press, speed, drawn, tissue.law) for press, (speed, _) in zip(first, comparison.conditions)]
    peaks, energies = (np.stack(columns, axis=-1) for columns in zip(*by_press))
    several = []
    for peak, energy, one in zip(peaks, energies, drawn):
        stiff, soft = one.steady_depth_range(ranges.steady_N)
        several.append(
            replace(
                ranges,
                peak_low_N=peak[0],
                peak_high_N=peak[1],
                energy_low_mJ=energy[0],
                energy_high_mJ=energy[1],
                stiff_mm=stiff,
                soft_mm=soft,
            )
        )
    return spread_of_ends(several)


def _outer(press: ComparedPress, speed_mm_s: float, drawn: Sequence[Tissue], law: str) -> tuple[NDArray, NDArray]:
    """Outermost peaks and energies of drawn tissues in one press, each of shape (tissues, 2)."""
    trace, braking = press.trace, press.braking_mm_s2
    groups = [one.parameter_sets for one in drawn]
    bands = force_ranges(groups, trace.steady_force_N, speed_mm_s, trace.hold_s, braking)
    _, displacement, force = press_subjects(bands, law, Sampling(hold_s=trace.hold_s, deceleration_mm_s2=braking))
    parts = np.split(work_mJ(displacement, force), np.cumsum([len(band.stop_s) for band in bands])[:-1])
    peaks = np.array([(band.peak_low_N, band.peak_high_N) for band in bands])
    return peaks, np.array([(part.min(), part.max()) for part in parts])
