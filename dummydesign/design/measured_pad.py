"""The verdict on a pad that was cast and pressed, its curves and uncertainty budget, and people below its peaks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import DummydesignError
from dummydesign.core.levels import LEVELS
from dummydesign.core.parsing import DECELERATION, EDGE, FORCE, HOLD, VELOCITY, positive, read_number, read_numbers
from dummydesign.core.serialise import to_plain
from dummydesign.design.assessment.budget import TRACE, Budget, EndSpread, budget_of_pad, spread_of_ends, usable_limits
from dummydesign.design.assessment.curves import CurveMatch, PressCurve, match_of_presses
from dummydesign.design.request import face_of
from dummydesign.design.scoring.castings import COUNT
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import (
    DRAWN,
    PeopleShares,
    ShareBelow,
    energies_of,
    is_inferred,
    moved_tissues,
    reason_of,
    with_errors,
)
from dummydesign.design.scoring.verdict import Ranges, Readings, Verdict, verdict
from dummydesign.design.test_conditions import check_edge, check_numbers, tissue_warnings
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.geometry.interface import CONDITIONS, Interface
from dummydesign.geometry.punch import read_punch
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.motion import work_mJ, work_to_deepest_mJ
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.comparison import ComparedPress, Comparison, PressTest, compare_traces, hold_of, missing_of
from dummydesign.tissue.fitting.reduction import ReducedTrace
from dummydesign.tissue.model.maxwell_law import law_named
from dummydesign.tissue.model.people_share import Population
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, force_range, force_ranges
from dummydesign.tissue.model.tissue import Tissue

Numbers = float | str | Iterable[float | str]


@dataclass(frozen=True)
class TracesTest:
    """A test with its punch."""

    punch: str
    edge_radius_mm: float
    condition: str
    presses: PressTest

    def to_dict(self) -> dict[str, Any]:
        """Return all as plain values, None for what is taken from each press."""
        test = self.presses
        return {
            "punch": self.punch,
            "edge_radius_mm": self.edge_radius_mm,
            "condition": self.condition,
            "force_N": to_plain(test.forces_N),
            "velocity_mm_s": to_plain(test.velocities_mm_s),
            "hold_s": test.hold_s,
            "deceleration_mm_s2": test.deceleration_mm_s2,
        }

    @property
    def given(self) -> dict[str, Any]:
        """What differs from the presses as they were made with the 14 x 14 mm punch; empty for nothing."""
        own = self.punch != PUNCH or self.edge_radius_mm or self.condition != "bonded"
        return {
            name: value
            for name, value in self.to_dict().items()
            if value is not None and (own or name not in ("punch", "edge_radius_mm", "condition"))
        }

    def warnings(self, tissue: Tissue) -> list[dict[str, str]]:
        """What must be said of the tissue in this test."""
        pairs = tissue_warnings(tissue, self.punch, self.edge_radius_mm, self.presses.forces_N or ())
        return [{"code": code, "message": text} for code, text in pairs]


def read_test(
    punch: str = PUNCH,
    edge_radius_mm: float | str = 0.0,
    force_N: Numbers | None = None,
    velocity_mm_s: Numbers | None = None,
    hold_s: float | str | None = None,
    deceleration_mm_s2: float | str | None = None,
    condition: str | None = None,
) -> TracesTest:
    """Read a test; numbers may carry their unit."""
    asked, face = read_punch(punch), face_of(punch, condition)
    Interface.parse(face, "condition", CONDITIONS)
    edge = read_number(edge_radius_mm, EDGE)
    forces = None if force_N is None else tuple(sorted(set(read_numbers(force_N, FORCE))))
    speeds = None if velocity_mm_s is None else tuple(sorted(set(read_numbers(velocity_mm_s, VELOCITY))))
    hold = None if hold_s is None else read_number(hold_s, HOLD)
    braking = None if deceleration_mm_s2 is None else read_number(deceleration_mm_s2, DECELERATION)
    check_numbers(forces, speeds, hold)
    if braking is not None:
        positive(DECELERATION.quantity, braking)
    if edge:
        check_edge(edge, asked)
    return TracesTest(punch, edge, face, PressTest(forces, speeds, hold, braking))


DRAWS, SEED = COUNT, 23
DEPTH_ERROR_MM = 0.01
"""Standard deviation of where a trace has its zero: half of the 0.02 mm to which a robot is taken to repeat."""
SMOOTHED = 5
"""Samples of the parabola that the peak is read from; a single largest sample is too large by its noise."""
PARABOLA = np.array([-3.0, 12.0, 17.0, 12.0, -3.0]) / 35.0
RAW_BIAS = 1.5
"""Standard deviations by which the largest of the few samples about a peak is too large."""


def verdict_of_traces(
    comparison: Comparison, tissue: Tissue, found: tuple[Ranges, Readings, Readings] | None = None
) -> Verdict:
    """Judge a cast pad by its traces.

    Each press is compared with the subjects at its own steady force, speed, hold and braking; repeats are averaged.
    True pads that may be behind the measurement are drawn from the noise, the scatter of repeats and the zero of
    depth. A press of the test that was not made, or without a test a speed of the tissue at which the pad was not
    pressed, leaves open whether it is inside. ``found`` is :func:`readings_of_traces`, where it is known.
    """
    ranges, readings, spread = found or readings_of_traces(comparison, tissue)
    reduced = [press.trace for press in comparison.presses]
    unsettled = missing_of(reduced, comparison.test, tissue.velocities_mm_s)
    if not len(ranges.steady_N):
        lowest = comparison.test.span_N[0]
        unsettled = " and ".join(filter(None, [unsettled, f"it was not pressed above {lowest:g} N"]))
    of, measure = "pads that fit these traces", "more presses of this pad"
    return verdict(ranges, readings, spread, of=of, unsettled=unsettled, measure=measure)


def readings_of_traces(comparison: Comparison, tissue: Tissue) -> tuple[Ranges, Readings, Readings]:
    """Subjects' ranges at the presses of a cast pad, its readings, and those of pads that fit its traces."""
    noise = comparison.noise_N
    rows = [_press(pressed, tissue, speed, noise) for speed, pressed in comparison.conditions]
    reduced = [press.trace for press in comparison.presses]
    lowest = comparison.test.span_N[0]
    force, speeds, low, high, least, most, peak, error, energy = (np.array(column) for column in zip(*rows))
    from_N = max(lowest * (1 - 1e-9), 0.97 * comparison.points[0, 1])
    grid = (comparison.grid_N >= from_N) & np.isfinite(comparison.steady)
    steady, depth = comparison.grid_N[grid], comparison.steady[grid]
    stiff, soft = (edge[grid] for edge in comparison.range_mm)
    hold = hold_of(reduced, comparison.test)
    exponent = law_named(tissue.law).exponent_of(tissue.parameter_sets, *comparison.test.span_N, hold)
    ranges = Ranges(force, speeds, low, high, least, most, steady, stiff, soft, len(tissue.subjects), exponent)
    rng = np.random.default_rng(SEED)
    spread = Readings(
        peak + error * rng.standard_normal((DRAWS, len(peak))),
        energy * (1.0 + error / peak * rng.standard_normal((DRAWS, len(peak)))),
        depth + DEPTH_ERROR_MM * rng.standard_normal((DRAWS, 1)),
    )
    return ranges, Readings(peak, energy, depth), spread


def _press(pressed: Sequence[ComparedPress], tissue: Tissue, speed_mm_s: float, noise_N: float) -> tuple[float, ...]:
    """One condition: force, speed, outermost peaks and energies of the subjects, the pad's, and its peak's error."""
    peaks = np.array([peak_of(press.trace, noise_N) for press in pressed])
    energies = np.array([energy_of(press.trace) for press in pressed])
    outer = []
    for trace, band, braking in pressed:
        sampling = Sampling(hold_s=trace.hold_s, deceleration_mm_s2=braking)
        energy = energies_of([band], tissue.law, sampling)[0] if band.energy_mJ is None else band.energy_mJ
        outer.append((trace.steady_force_N, band.peak_low_N, band.peak_high_N, energy.min(), energy.max()))
    force, low, high, least, most = np.mean(outer, axis=0)
    # Repeats differ in depth and force; what scatters is the peak over its own lowest subject.
    relative = peaks / np.array([row[1] for row in outer])
    scatter = float(np.std(relative, ddof=1)) * low if len(peaks) > 1 else 0.0
    error = float(np.hypot(noise_N, scatter)) / np.sqrt(len(peaks))
    return (force, speed_mm_s, low, high, least, most, float(peaks.mean()), error, float(energies.mean()))


def peak_of(trace: ReducedTrace, noise_N: float = 0.0) -> float:
    """Largest force of a press: at an abrupt stop, else of parabolas through five even samples. [N]

    The parabolas are less what noise adds to a largest value. Where sampling is not even the sample itself is taken,
    and with fewer than twenty samples in the rise throughout.
    """
    if (stopped := _force_at_abrupt_stop(trace)) is not None:
        return stopped
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


LAST_PART, LEAST_SAMPLES = 0.25, 6
"""Share of the rise, at its end, whose samples tell the force at an abrupt stop, and how many are needed."""
BRAKED, BRAKING_SAMPLES, REACHED = 0.97, 2, 0.999
"""Share of the speed below which a step is slowed, how many are at an abrupt stop, share of the depth that is there."""


def _force_at_abrupt_stop(trace: ReducedTrace) -> float | None:
    """Force where the depth is reached, by a parabola of the force over depth; None if braking is seen. [N]

    The force is largest at the stop and falls at once. With 20 to 60 samples in the rise, 100 Hz at 10 mm/s, the
    largest sample is 0.7 to 1.5 % too low and a parabola across the stop 1.3 to 2.7 %.
    """
    ramp, time, x, force = trace.ramp, trace.trace.time_s, trace.trace.displacement_mm, trace.trace.force_N
    first = int(np.argmax(time >= ramp.contact_time_s))
    reach = first + int(np.argmax(x[first:] >= REACHED * ramp.depth_mm))
    count = max(LEAST_SAMPLES, int(LAST_PART * (reach - first)))
    start = reach - count - BRAKING_SAMPLES
    if ramp.overshoot_mm or start < first:
        return None
    speed = np.diff(x[start : reach + 1]) / np.diff(time[start : reach + 1])
    slowed = int((speed < BRAKED * np.median(speed)).sum())
    if slowed > BRAKING_SAMPLES:
        return None
    end = reach - max(slowed - 1, 0)  # a step that is slowed begins at a sample of full speed
    at = slice(end - count, end)
    return float(np.polyfit(x[at] - ramp.depth_mm, force[at], 2)[-1])


def energy_of(trace: ReducedTrace) -> float:
    """Integral of F dx from contact to the largest depth. [mJ]

    That is the end of the hold, where nothing moves any more, unless the punch overshot. The stop of the ideal ramp
    lies halfway through the braking, or between two samples: up to there the steepest part of the rise is missing,
    3 % of the energy at 150 samples in the rise.
    """
    time = trace.trace.time_s
    pressed = (time >= trace.ramp.contact_time_s) & (time <= trace.ramp.hold_end_s)
    x: NDArray = trace.trace.displacement_mm[pressed]
    force = trace.trace.force_N[pressed]
    return float(work_to_deepest_mJ(x, force) if trace.ramp.overshoot_mm else work_mJ(x, force))


@dataclass(frozen=True)
class PadVerdict:
    """One pad of a campaign with its verdict, or the reason why it has none."""

    shape: str
    thickness_mm: float
    presses: int
    verdict: Verdict | None
    reason: str = ""
    budget: Budget | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return all fields as plain values."""
        judged = None if self.verdict is None else self.verdict.to_dict()
        return {
            "shape": self.shape or "slab",
            "thickness_mm": self.thickness_mm,
            "presses": self.presses,
            "verdict": judged,
            "budget": to_plain(self.budget),
            "reason": self.reason or None,
        }


def verdicts_of_campaign(campaign: Campaign, tissue: Tissue) -> tuple[PadVerdict, ...]:
    """Judge every pad of a campaign by its own presses, the worst level first."""
    verdicts = []
    for shape, thickness in dict.fromkeys(trial.pad for trial in campaign.trials):
        traces = [trial.trace for trial in campaign.trials if trial.pad == (shape, thickness)]
        judged, budget, reason = None, None, ""
        try:
            compared = compare_traces(traces, tissue, campaign.lowpass)
            found = readings_of_traces(compared, tissue)
            judged = verdict_of_traces(compared, tissue, found)
            budget = budget_of_traces(compared, tissue, *found)
        except DummydesignError as problem:
            reason = str(problem)
        verdicts.append(PadVerdict(shape, thickness, len(traces), judged, reason, budget))
    return tuple(
        sorted(verdicts, key=lambda pad: -1 if pad.verdict is None else LEVELS.index(pad.verdict.level), reverse=True)
    )


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
    energies = energies_of(bands, law, Sampling(hold_s=trace.hold_s, deceleration_mm_s2=braking))
    peaks = np.array([(band.peak_low_N, band.peak_high_N) for band in bands])
    return peaks, np.array([(energy.min(), energy.max()) for energy in energies])


def shares_of_traces(comparison: Comparison, tissue: Tissue, lowpass: Lowpass | None = None) -> PeopleShares:
    """Return the share of people below the peaks of a pad, each press at its own force, speed, hold and braking.

    Repeats of a press are averaged.

    Parameters
    ----------
    comparison : Comparison
        Of the pad's traces with the tissue.
    tissue : Tissue
        The one of the comparison.
    lowpass : Lowpass, optional
        Filter that the traces went through.
    """
    count, inferred, reason = len(tissue.subjects), is_inferred(tissue), reason_of(tissue)
    if reason is not None:
        return PeopleShares(count, (), inferred, reason)
    noise = comparison.noise_N
    posterior = tissue.posterior(DRAWN)
    moved = [] if posterior else moved_tissues(tissue)
    kinds = [kind for kind, _ in moved]
    groups = [one.parameter_sets for one in (tissue, *posterior, *(one for _, one in moved))]
    rows = []
    for speed, pressed in comparison.conditions:
        forces, pads, subjects = list[float](), list[float](), list[NDArray]()
        for trace, _, braking in pressed:
            bands = force_ranges(groups, trace.steady_force_N, speed, trace.hold_s, braking, lowpass)
            forces.append(trace.steady_force_N)
            pads.append(peak_of(trace, noise))
            subjects.append(np.log([band.curves_N.max(axis=-1) for band in bands]))
        peak, peaks = float(np.mean(pads)), np.exp(np.mean(subjects, axis=0))
        people = Population.of_groups(peaks[1:]) if posterior else with_errors(peaks[0], list(peaks[1:]), kinds)
        low, high = (float(end) for end in people.interval_below(peak))
        exact = float(Population.of(peaks[0]).expected_below(peak))
        rows.append(ShareBelow(float(np.mean(forces)), speed, float(people.expected_below(peak)), (low, high), exact))
    return PeopleShares(count, tuple(rows), inferred)
