"""A measured pad against a tissue's ranges, in a test of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import group_near
from dummydesign.measurement.importing.press_checks import CODES
from dummydesign.measurement.motion import DECELERATION_MM_S2, RobotPath
from dummydesign.measurement.ramp_detection import ramp_of
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.fit import Progress, TissueFit, fit_traces
from dummydesign.tissue.fitting.reduction import ReducedTrace, condition_groups, reduce_trace, rounded_velocity
from dummydesign.tissue.model.maxwell_law import DEFAULT, law_named
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR, SAME_DEPTH, SPEED_FACTOR, log_steady_curve
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, ForceRange
from dummydesign.tissue.model.tissue import Tissue

LONGER, SHORTER = 1.02, 0.9
"""Holds over the test's from which on a trace is cut, and below which the test was not made."""
LOW_SHARE = 0.1
PAPER_N, PAPER_STEP_N, MOST_STEPS = (5.0, 15.0), 0.1, 400


@dataclass(frozen=True)
class PressTest:
    """Steady forces, speeds, hold and braking of a test; None for what each press itself was made with."""

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
        return next((v for v in self.velocities_mm_s or () if _near(measured_mm_s, v, SPEED_FACTOR)), measured_mm_s)


def presses_of(
    traces: Sequence[Trace], test: PressTest, known_mm_s: Sequence[float] = ()
) -> tuple[list[Trace], list[ReducedTrace], list[tuple[str, str]]]:
    """Return the presses that belong to a test, held no longer than it holds, and a notice of the others."""
    every = [_held(_sent(trace, test.velocities_mm_s or known_mm_s), test.hold_s) for trace in traces]
    own = [pair for pair in every if _belongs(pair[1], test)]
    forces, speeds = (
        None if values is None else f"{', '.join(f'{v:g}' for v in values)} {unit}"
        for values, unit in ((test.forces_N, "N"), (test.velocities_mm_s, "mm/s"))
    )
    words = " at ".join(filter(None, (forces, speeds)))
    if every and not own:
        made = sorted({f"{one.steady_force_N:.2g} N at {one.velocity_mm_s:.2g} mm/s" for _, one in every})
        raise InputError(
            f"no press belongs to the test ({words}): the traces are of {'; '.join(made[:6])}; "
            "give --force and --velocity that were pressed",
            "nothing_found",
            "press",
        )
    others = [trace.name for trace, reduced in every if not _belongs(reduced, test)]
    names = ", ".join(others[:5]) + (", ..." if len(others) > 5 else "")
    text = f"{len(others)} of {len(every)} presses are not of the test ({words}) and are left out: {names}"
    notices = [("press_outside_test", text)] if others else []
    return [trace for trace, _ in own], [reduced for _, reduced in own], notices


def _speeds_not_seen(unsure: Sequence[tuple[ReducedTrace, float]]) -> list[tuple[str, str]]:
    """A notice where a press's speed is not seen and another likely one changes the subjects' largest peak force.

    Changes of up to twice the share to which the steady force can be set are left out; NaN is an unknown one.
    """
    matter = [(trace, change) for trace, change in unsure if not abs(change) <= 2.0 * STEADY_TOLERANCE]
    if not matter:
        return []
    trace, change = max(matter, key=lambda one: abs(one[1]))
    much = "" if np.isnan(change) else f"{100.0 * change:+.0f} % "
    return [
        (
            "speed_not_seen",
            f"{len({one.trace.name for one, _ in matter})} presses do not show the speed that was commanded: "
            f"{trace.trace.name} shows {trace.ramp.speed.words}, {trace.velocity_mm_s:.3g} is used. Subjects' peaks "
            f"may be {much}off. Give --velocity, or record the approach with more samples a second",
        )
    ]


def missing_of(reduced: Sequence[ReducedTrace], test: PressTest, known_mm_s: Sequence[float]) -> str:
    """Say why presses do not settle a test; empty when they do."""
    made = [(trace.steady_force_N, trace.velocity_mm_s) for trace in reduced]
    why = []
    if test.velocities_mm_s is None:
        absent = [v for v in known_mm_s if not any(_near(speed, v, 1.5) for _, speed in made)]
        if absent:
            why.append(f"it was not pressed at {' and '.join(f'{v:g}' for v in absent)} mm/s")
    if test.forces_N is None and made:
        (low, high), forces_made = test.span_N, [force for force, _ in made]
        if max(forces_made) <= high / FORCE_FACTOR:
            why.append(f"it was not pressed above {max(forces_made):.3g} N")
        if min(forces_made) >= low * FORCE_FACTOR:
            why.append(f"it was not pressed below {min(forces_made):.3g} N")
    if test.forces_N is not None or test.velocities_mm_s is not None:
        speeds = test.velocities_mm_s or tuple(sorted({speed for speed, _, _ in condition_groups(reduced)}))
        not_made = [
            f"{'' if force is None else f'to {force:g} N '}at {speed:g} mm/s"
            for speed in speeds
            for force in test.forces_N or (None,)
            if not any(_near(f, force, FORCE_FACTOR) and _near(v, speed, SPEED_FACTOR) for f, v in made)
        ]
        if not_made:
            why.append(f"it was not pressed {', '.join(not_made)}")
    if test.hold_s is not None:
        shortest = min(trace.hold_s for trace in reduced)
        if shortest < SHORTER * test.hold_s:
            why.append(f"it was held {shortest:.3g} s of {test.hold_s:g} s")
    return " and ".join(why)


def hold_of(reduced: Sequence[ReducedTrace], test: PressTest) -> float:
    """Return the hold at whose end steady forces are taken: the test's, else the median of the presses. [s]"""
    own = float(np.median([trace.hold_s for trace in reduced]))
    return own if test.hold_s is None else min(test.hold_s, own)


def _sent(trace: Trace, speeds_mm_s: Sequence[float]) -> Trace:
    """The trace, as of the fastest of these speeds that it can be of."""
    speed = ramp_of(trace).speed
    alike = [v for v in speeds_mm_s if (trace.commanded_speed_mm_s or speed.low_mm_s) <= v <= speed.high_mm_s]
    return replace(trace, commanded_speed_mm_s=max(alike)) if alike else trace


def _held(trace: Trace, hold_s: float | None) -> tuple[Trace, ReducedTrace]:
    """The trace, cut at the end of the test's hold where it was held longer, and reduced."""
    reduced = reduce_trace(trace)
    if hold_s is None or reduced.hold_s <= LONGER * hold_s:
        return trace, reduced
    keep = trace.time_s <= reduced.ramp.stop_time_s + hold_s
    cut = replace(
        trace, time_s=trace.time_s[keep], displacement_mm=trace.displacement_mm[keep], force_N=trace.force_N[keep]
    )
    return cut, reduce_trace(cut)


def _belongs(reduced: ReducedTrace, test: PressTest) -> bool:
    return any(_near(reduced.steady_force_N, one, FORCE_FACTOR) for one in test.forces_N or (None,)) and any(
        _near(reduced.velocity_mm_s, one, SPEED_FACTOR) for one in test.velocities_mm_s or (None,)
    )


def _near(value: float, wanted: float | None, factor: float) -> bool:
    """Whether a value is that of the test; None of the test is any."""
    return wanted is None or wanted / factor < value < wanted * factor


SHOWN = ("lack_of_fit", "at_bound", "not_identifiable", *CODES)
"""Codes of the fit's warnings that a comparison repeats."""
AS_PRESSED = PressTest()
"""Every press in its own test, the steady curve from 5 to 15 N."""


class ComparedPress(NamedTuple):
    """A press of the dummy, the tissue's range at its condition, and the braking of both. [mm/s2]"""

    trace: ReducedTrace
    range: ForceRange
    braking_mm_s2: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """What was found; ``result`` is the JSON of ``compare``, the rest is for tables and pictures.

    ``steady`` are depths (n,) [mm] of the dummy at the forces ``grid_N``, NaN where it was not pressed, ``range_mm``
    those of the stiffest and the softest subject; ``conditions`` are the test's speed and the presses of each
    condition; ``test`` is what they were compared in.
    """

    result: dict[str, Any]
    fit: TissueFit
    steady: NDArray
    points: NDArray
    conditions: tuple[tuple[float, tuple[ComparedPress, ...]], ...]
    grid_N: NDArray
    range_mm: tuple[NDArray, NDArray]
    test: PressTest

    @property
    def presses(self) -> list[ComparedPress]:
        """All presses, condition by condition."""
        return [press for _, pressed in self.conditions for press in pressed]

    @property
    def noise_N(self) -> float:
        """Noise of the traces; 0 where their holds do not tell it."""
        return float(self.fit.result["noise_floor_N"] or 0.0)


def compare_traces(
    traces: Sequence[Trace],
    tissue: Tissue,
    lowpass: Lowpass | None = None,
    test: PressTest = AS_PRESSED,
    progress: Progress | None = None,
) -> Comparison:
    """Compare a dummy's traces with a tissue: by parameters, by steady-state range, by force variation range.

    The dummy is fitted per speed with the law and the number of elements of the tissue. Its steady-state
    curve goes through its measured (depth, force at the end of the hold); below the smallest of them it
    is the rise of the slowest, deepest press scaled by that press's steady over peak force. The force
    variation range is made for the steady force, speed, hold and braking of each press, and goes through
    the declared sensor filter as the dummy's force did. Where the robot overshot, subjects are pressed with the path
    of the press, shifted to their depths: the same robot overshoots on them too. A test that is given chooses the
    presses that belong to it, ends their hold, and says between which forces the steady curve is judged; after a hold
    of less than 10 s that curve is compared with the subjects' at the end of the same hold.
    """
    own, reduced, notices = presses_of(traces, test, tissue.velocities_mm_s)
    known = law_named(tissue.law).fitted
    elements, law = (tissue.elements, tissue.law) if known else (5, DEFAULT)
    fit = fit_traces(own, elements, law, "per-speed", lowpass, progress=progress)
    if progress is not None:
        progress("ranges of the tissue")
    grid = test.grid_N
    points, depth = steady_curve(reduced, grid)
    held = law_named(tissue.law).end_of_hold_depths(
        tissue.parameter_sets,
        grid,
        test.speed_of(rounded_velocity(min(trace.velocity_mm_s for trace in reduced))),
        hold_of(reduced, test),
        test.deceleration_mm_s2 or DECELERATION_MM_S2,
    )
    span = held.min(axis=0), held.max(axis=0)
    follows = not law_named(tissue.law).ideal_ramp and not law_named(tissue.law).measured
    conditions, by_condition, rows = [], [], list[dict[str, Any]]()
    declared = {trace.name for trace in traces if trace.commanded_speed_mm_s}
    unsure: list[tuple[ReducedTrace, float]] = []
    for measured, _, group in condition_groups(reduced):
        speed, pressed = test.speed_of(measured), []
        for trace in group:
            braking = test.deceleration_mm_s2 or trace.ramp.speed.braking_mm_s2
            path = None if test.deceleration_mm_s2 or not follows else overshooting_path(trace)
            motions = [(speed, braking)]
            if not (trace.ramp.speed.sure or test.velocities_mm_s or trace.trace.name in declared):
                if tissue.measured:  # curves answer for speeds that were pressed alone
                    unsure.append((trace, np.nan))
                else:
                    motions += [(v, test.deceleration_mm_s2 or own) for v, own in trace.ramp.speed.ends]
            band, *others = (
                tissue.force_range(trace.steady_force_N, v, trace.hold_s, a, lowpass, path) for v, a in motions
            )
            pressed.append(ComparedPress(trace, band, braking))
            unsure += [(trace, other.peak_high_N / band.peak_high_N - 1.0) for other in others]
        shares = [_shares(press, fit.result["noise_floor_N"]) for press in pressed]
        mean = {key: float(np.mean([own[key] for own in shares])) for key in shares[0]}
        conditions.append((speed, tuple(pressed)))
        by_condition.append({"velocity_mm_s": speed, **mean, "repeats": len(group)})
        rows += [{"file": one.trace.name, "velocity_mm_s": speed, **own} for one, own in zip(group, shares)]
    result = {
        "tissue": tissue.name,
        "law": tissue.law,
        "parametric": _parametric(fit, tissue) if known else {},
        "steady_state_range": _steady_shares(grid, depth, span, test.span_N),
        "force_variation_range": by_condition,
        "by_trace": rows,
        "fit": {key: fit.result[key] for key in ("rmse_N", "noise_floor_N", "max_residual_N", "comparison")},
        "warnings": _warnings(
            fit,
            tissue,
            points,
            rows,
            [*notices, *_speeds_not_seen(unsure), *([] if follows else overshoots_of(reduced))],
        ),
    }
    return Comparison(result, fit, depth, points, tuple(conditions), grid, span, test)


def steady_curve(reduced: Sequence[ReducedTrace], grid_N: NDArray) -> tuple[NDArray, NDArray]:
    """Steady points (k, 2) of depth and force at the end of the hold, and depths at the forces ``grid_N`` (n,)."""
    points = sorted((trace.ramp.depth_mm, trace.steady_force_N) for trace in reduced)
    groups = group_near(points, lambda point: point[0], SAME_DEPTH)
    knots = np.array([[np.mean(column) for column in zip(*group)] for group in groups])
    slowest = min(reduced, key=lambda trace: (round(trace.velocity_mm_s, -1), -trace.ramp.depth_mm))
    rise = slowest.end_s <= slowest.ramp.stop_time_s
    scaled = slowest.force_N[rise] * slowest.steady_force_N / float(slowest.force_N[rise].max())
    log_depth, log_force = log_steady_curve(slowest.depth_mm[rise], scaled, *knots.T)
    depth = np.exp(np.interp(np.log(grid_N), log_force, log_depth, left=np.nan, right=np.nan))
    # a force a little above the deepest press still belongs to it
    last = (np.isnan(depth)) & (grid_N > knots[-1, 1]) & (grid_N <= 1.05 * knots[-1, 1])
    depth[last] = knots[-1, 0]
    return knots, depth


def overshooting_path(trace: ReducedTrace) -> RobotPath | None:
    """Path of a press that overshot, level where it has rung out; None for a press that did not."""
    ramp = trace.ramp
    if not ramp.overshoot_mm:
        return None
    time, x = trace.motion.time_s, trace.motion.displacement_mm
    kept = time > ramp.contact_time_s
    since = np.r_[0.0, time[kept] - ramp.contact_time_s]
    way = np.r_[0.0, np.where(time[kept] > ramp.settled_s, ramp.depth_mm, x[kept])]
    way[-1] = ramp.depth_mm
    speed = trace.velocity_mm_s
    return RobotPath(since, way, ramp.rise_time_s, speed, speed, DECELERATION_MM_S2)


def overshoots_of(reduced: Sequence[ReducedTrace]) -> list[tuple[str, str]]:
    """Warn of presses whose overshoot the tissue's law cannot follow."""
    over = [trace for trace in reduced if trace.ramp.overshoot_mm]
    if not over:
        return []
    most = max(over, key=lambda trace: trace.ramp.overshoot_mm / trace.ramp.depth_mm)
    text = (
        f"{len(over)} of {len(reduced)} presses went beyond their depth, {most.trace.name} by "
        f"{most.ramp.overshoot_mm:.2g} mm; people's peaks are without an overshoot: let the robot brake earlier"
    )
    return [("overshoot", text)]


def _shares(press: ComparedPress, noise_N: float) -> dict[str, Any]:
    """Shares of one press inside its range, give or take the steady force's tolerance or the noise."""
    trace, band, _ = press
    time, force = trace.since_contact
    near = max(STEADY_TOLERANCE * trace.steady_force_N, 3.0 * noise_N)
    return {
        "steady_force_N": trace.steady_force_N,
        "depth_mm": trace.ramp.depth_mm,
        "peak_force_N": float(force.max()),
        "range_peak_low_N": band.peak_low_N,
        "range_peak_high_N": band.peak_high_N,
        **{k: float(share) for k, share in band.inside(time, force, trace.ramp.rise_time_s, near).items()},
    }


def _parametric(fit: TissueFit, tissue: Tissue) -> dict[str, Any]:
    """Each parameter beside the tissue's band at the same speed; dampers at speeds both have."""
    table: dict[str, Any] = {}
    for name, entry in fit.result["parameters"].items():
        band = tissue.bands[name]
        for speed, one in {"": entry}.items() if "value" in entry else entry.items():
            limits = band.get(speed) if speed else band
            row = {key: one[key] for key in ("value", "low", "high", "at_bound")}
            row |= {"band_low": None, "band_high": None, "inside": None}
            if limits is not None:
                inside = bool(limits.low <= one["value"] <= limits.high)
                row |= {"band_low": limits.low, "band_high": limits.high, "inside": inside}
            table[f"{name}.{speed}" if speed else name] = row
    return table


def _steady_shares(
    grid_N: NDArray, depth: NDArray, range_mm: tuple[NDArray, NDArray], span_N: tuple[float, float]
) -> dict[str, Any]:
    """Shares over the forces the dummy reached; a part it did not reach is null. Below means below the lowest force."""
    reached = ~np.isnan(depth)
    inside = (depth >= range_mm[0] - 1e-9) & (depth <= range_mm[1] + 1e-9)
    parts = {
        "inside_fraction": reached,
        "below_5N_fraction": reached & (grid_N <= span_N[0] * (1 + 1e-9)),
        "above_5N_fraction": reached & (grid_N >= span_N[0] * (1 - 1e-9)),
    }
    shares: dict[str, Any] = {name: float(inside[part].mean()) if part.any() else None for name, part in parts.items()}
    span = grid_N[reached]
    reach = [float(span[0]), float(span[-1])] if len(span) else None
    return {**shares, "reached_N": reach, "span_N": list(span_N)}


def _warnings(
    fit: TissueFit, tissue: Tissue, points: NDArray, rows: list[dict[str, Any]], notices: list[tuple[str, str]]
) -> list[dict[str, str]]:
    fitted = law_named(tissue.law).fitted
    own: list[tuple[str, str]] = []
    if "inferred" in tissue.kinds:
        own.append(("inferred_tissue", f"the band of {tissue.name} is inferred, not measured"))
    if points[0, 1] > 0.6:
        own.append(
            (
                "steady_from_rise",
                f"below {points[0, 1]:.2g} N the steady-state curve is the scaled rise of the "
                "slowest press, not a measured steady force",
            )
        )
    own += [] if tissue.notice is None else [tissue.notice]
    near, known = SPEED_FACTOR if tissue.measured else 1.0, tissue.velocities_mm_s
    speeds_made = sorted({row["velocity_mm_s"] for row in rows})
    unknown = [v for v in speeds_made if all(max(v / one, one / v) > near for one in known)]
    speeds = ", ".join(f"{v:g}" for v in unknown)
    why = f"the tissue has no dampers at {speeds} mm/s: its range there uses dampers interpolated in ln c over ln v"
    if tissue.measured:
        why = f"nobody was pressed at {speeds} mm/s: the range there lies between the curves of the speeds beside it"
    if unknown and (tissue.measured or fitted):
        own.append(("speed_not_in_band", why))
    of_fit = [w for w in fit.result["warnings"] if w["code"] in (SHOWN if fitted else CODES)]
    before, after = ([{"code": code, "message": text} for code, text in pairs] for pairs in (notices, own))
    return before + of_fit + after
