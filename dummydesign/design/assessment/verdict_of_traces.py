"""The verdict on a pad that was cast and pressed: its traces against the tissue's subjects in the same presses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.assessment.castings import COUNT
from dummydesign.design.assessment.safety import tissue_press
from dummydesign.design.scoring.deviations import Ranges, Readings
from dummydesign.design.scoring.presses import Sampling
from dummydesign.design.scoring.verdict import Verdict, verdict
from dummydesign.measurement.motion import work_mJ
from dummydesign.tissue.comparison.compare import Comparison, braking_of
from dummydesign.tissue.comparison.press_test import PressTest, hold_of, missing_of
from dummydesign.tissue.fitting.groups import condition_groups
from dummydesign.tissue.model.laws import law_named

if TYPE_CHECKING:
    from dummydesign.tissue.fitting.reduction import ReducedTrace
    from dummydesign.tissue.model.ranges import ForceRange
    from dummydesign.tissue.model.tissue import Tissue

DRAWS, SEED = COUNT, 23
DEPTH_ERROR_MM = 0.01
"""Standard deviation of where a trace has its zero: half of the 0.02 mm to which a robot is taken to repeat."""
SMOOTHED = 5
"""Samples of the parabola that the peak is read from; a single largest sample is too large by its noise."""
PARABOLA = np.array([-3.0, 12.0, 17.0, 12.0, -3.0]) / 35.0
RAW_BIAS = 1.5
"""Standard deviations by which the largest of the few samples about a peak is too large."""


def verdict_of_traces(found: Comparison, tissue: Tissue) -> Verdict:
    """Judge a cast pad by its traces.

    Each press is held against the subjects at its own steady force, speed, hold and braking; repeats are averaged.
    True pads that may be behind the measurement are drawn from the noise, the scatter of repeats and the zero of
    depth. A press of the test that was not made, or without a test a speed of the tissue at which the pad was not
    pressed, leaves open whether it is inside.

    Parameters
    ----------
    found : Comparison
    tissue : Tissue
    """
    bands = {id(trace): band for trace, band in found.presses}
    noise = float(found.fit.result["noise_floor_N"] or 0.0)
    rows = [
        _press([(trace, bands[id(trace)]) for trace in group], tissue, found.test, speed, noise)
        for speed, _, group in condition_groups([trace for trace, _ in found.presses])
    ]
    lowest = found.test.span_N[0]
    force, speeds, low, high, least, most, peak, error, energy = (np.array(column) for column in zip(*rows))
    grid = (found.grid_N >= max(lowest * (1 - 1e-9), 0.97 * found.points[0, 1])) & np.isfinite(found.steady)
    steady, depth = found.grid_N[grid], found.steady[grid]
    stiff, soft = (edge[grid] for edge in found.range_mm)
    hold = hold_of([trace for trace, _ in found.presses], found.test)
    ranges = Ranges(force, speeds, low, high, least, most, steady, stiff, soft, len(tissue.subjects),
                    law_named(tissue.law).exponent_of(tissue.parameter_sets, *found.test.span_N, hold))  # fmt: skip
    rng = np.random.default_rng(SEED)
    spread = Readings(
        peak + error * rng.standard_normal((DRAWS, len(peak))),
        energy * (1.0 + error / peak * rng.standard_normal((DRAWS, len(peak)))),
        depth + DEPTH_ERROR_MM * rng.standard_normal((DRAWS, 1)),
    )
    unsettled = missing_of([trace for trace, _ in found.presses], found.test, tissue.velocities_mm_s)
    if not len(steady):
        unsettled = " and ".join(filter(None, [unsettled, f"it was not pressed above {lowest:g} N"]))
    readings = Readings(peak, energy, depth)
    return verdict(ranges, readings, spread, of="pads that these traces allow", unsettled=unsettled, cast=True)


def _press(
    pairs: list[tuple[ReducedTrace, ForceRange]], tissue: Tissue, test: PressTest, measured_mm_s: float,
    noise_N: float,
) -> tuple[float, ...]:
    """One condition: force, speed, outermost peaks and energies of the subjects, the pad's, and its peak's error."""
    peaks = np.array([peak_of(trace, noise_N) for trace, _ in pairs])
    energies = np.array([energy_of(trace) for trace, _ in pairs])
    outer = []
    speed_mm_s = test.speed_of(measured_mm_s)
    for trace, band in pairs:
        hold = trace.ramp.hold_end_s - trace.ramp.stop_time_s
        braking = test.deceleration_mm_s2 or braking_of(trace, speed_mm_s)
        sampling = Sampling(hold_s=hold, deceleration_mm_s2=braking)
        energy = tissue_press(band, tissue.law, sampling).energy_mJ
        outer.append((trace.steady_force_N, band.peak_low_N, band.peak_high_N, energy.min(), energy.max()))
    force, low, high, least, most = np.mean(outer, axis=0)
    # Repeats differ in depth and force; what scatters is the peak over its own lowest subject.
    relative = peaks / np.array([row[1] for row in outer])
    scatter = float(np.std(relative, ddof=1)) * low if len(peaks) > 1 else 0.0
    error = float(np.hypot(noise_N, scatter)) / np.sqrt(len(peaks))
    return (force, speed_mm_s, low, high, least, most, float(peaks.mean()), error, float(energies.mean()))


def peak_of(trace: ReducedTrace, noise_N: float = 0.0) -> float:
    """Largest force of a press: of parabolas through five even samples, less what noise adds to a largest value. [N]

    Where sampling is not even the sample itself is taken, and with fewer than twenty samples in the rise throughout.

    Parameters
    ----------
    trace : ReducedTrace
    noise_N : float
        Standard deviation of a sample.
    """
    force = trace.trace.force_N[trace.inside]
    time = trace.trace.time_s[trace.inside]
    rising = int(((time >= trace.ramp.contact_time_s) & (time <= trace.ramp.stop_time_s)).sum())
    if rising < 4 * SMOOTHED:
        return float(force.max())
    step = np.lib.stride_tricks.sliding_window_view(np.diff(time), SMOOTHED - 1)
    even = step.max(axis=-1) < 1.2 * step.min(axis=-1)
    left = float(np.sqrt((PARABOLA**2).sum()))
    smooth = np.convolve(force, PARABOLA, "valid") - left * noise_N
    middle = force[SMOOTHED // 2 : -(SMOOTHED // 2)] - RAW_BIAS * noise_N
    return float(np.where(even, smooth, middle).max())


def energy_of(trace: ReducedTrace) -> float:
    """Integral of F dx from contact to the end of the hold, where nothing moves any more. [mJ]

    The stop of the ideal ramp lies in the middle of the braking, or between two samples: up to there the steepest part
    of the rise is missing, 3 % of the energy at 150 samples in the rise.
    """
    time = trace.trace.time_s
    pressed = (time >= trace.ramp.contact_time_s) & (time <= trace.ramp.hold_end_s)
    x: NDArray = trace.trace.displacement_mm[pressed]
    force = trace.trace.force_N[pressed]
    return float(work_mJ(x, force))
