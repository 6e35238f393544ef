"""Is a measured dummy inside a tissue's ranges? The paper's own use, with its two ways of looking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.measurement.trace_checks import CODES
from dummydesign.tissue.comparison.press_test import SPEED_APART, PressTest, hold_of, presses_of
from dummydesign.tissue.fitting.fit import Fit, Progress, fit_traces
from dummydesign.tissue.fitting.groups import condition_groups, rounded_velocity
from dummydesign.tissue.fitting.reduction import ReducedTrace
from dummydesign.tissue.model.laws import DEFAULT, law_named
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, ForceRange, end_of_hold_range
from dummydesign.tissue.model.tissue import Tissue

SHOWN = ("lack_of_fit", "at_bound", "not_identifiable", *CODES)
"""Codes of the fit's warnings that a comparison repeats."""
BRAKING_MM_S2 = (3_000.0, 200_000.0)
AS_PRESSED = PressTest()
"""Every press in its own test, the steady curve from 5 to 15 N."""


@dataclass(frozen=True)
class Comparison:
    """What was found; ``result`` is the JSON of ``compare``, the rest is for tables and pictures.

    ``steady`` are depths (n,) [mm] of the dummy at the forces ``grid_N``, NaN where it was not pressed, ``range_mm``
    those of the stiffest and the softest subject; ``presses`` pair each trace with the tissue's range at its
    condition; ``test`` is what they were compared in.
    """

    result: dict[str, Any]
    fit: Fit
    steady: NDArray
    points: NDArray
    presses: tuple[tuple[ReducedTrace, ForceRange], ...]
    grid_N: NDArray
    range_mm: tuple[NDArray, NDArray]
    test: PressTest


def compare_traces(
    traces: Sequence[Trace], tissue: Tissue, lowpass: Lowpass | None = None, test: PressTest = AS_PRESSED,
    progress: Progress | None = None,
) -> Comparison:  # fmt: skip
    """Compare a dummy's traces with a tissue: by parameters, by steady-state range, by force variation range.

    The dummy is fitted per speed with the law and the number of elements of the tissue. Its steady-state
    curve goes through its measured (depth, force at the end of the hold); below the smallest of them it
    is the rise of the slowest, deepest press scaled by that press's steady over peak force. The force
    variation range is made for the steady force, speed, hold and braking of each press, and goes through
    the declared sensor filter as the dummy's force did. A test that is given chooses the presses that belong
    to it, ends their hold, and says between which forces the steady curve is judged; after a hold of less than
    10 s that curve is compared with the subjects' at the end of the same hold.

    Parameters
    ----------
    traces : sequence of Trace
        Presses of one dummy.
    tissue : Tissue
    lowpass : Lowpass, optional
        Filter the recorded forces went through.
    test : PressTest
        Forces, speeds, hold and braking; by default those of each press.
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Comparison
    """
    own, reduced, said = presses_of(traces, test)
    known = law_named(tissue.law).fitted
    elements, law = (tissue.elements, tissue.law) if known else (5, DEFAULT)
    fit = fit_traces(own, elements, law, "per-speed", lowpass, progress=progress)
    if progress is not None:
        progress("ranges of the tissue")
    grid = test.grid_N
    points, depth = steady_curve(reduced, grid)
    slowest = min(trace.velocity_mm_s for trace in reduced)
    span = end_of_hold_range(tissue.parameter_sets, grid, test.speed_of(rounded_velocity(slowest)),
                             hold_of(reduced, test), test.deceleration_mm_s2 or DECELERATION_MM_S2)  # fmt: skip
    presses, rows = [], []
    for measured, _, group in condition_groups(reduced):
        speed = test.speed_of(measured)
        for trace in group:
            band = _range_for(trace, speed, tissue, lowpass, test.deceleration_mm_s2)
            shares = _shares(trace, band, fit.result["noise_floor_N"])
            presses.append((trace, band))
            rows.append({"file": trace.trace.name, "velocity_mm_s": speed, **shares})
    result = {
        "tissue": tissue.name,
        "law": tissue.law,
        "parametric": _parametric(fit, tissue) if known else {},
        "steady_state_range": _steady_shares(grid, depth, span, test.span_N),
        "force_variation_range": _by_condition(reduced, rows, test),
        "by_trace": rows,
        "fit": {key: fit.result[key] for key in ("rmse_N", "noise_floor_N", "max_residual_N", "comparison")},
        "warnings": [{"code": code, "message": text} for code, text in said] + _warnings(fit, tissue, points, rows),
    }
    return Comparison(result, fit, depth, points, tuple(presses), grid, span, test)


def steady_curve(reduced: Sequence[ReducedTrace], grid_N: NDArray) -> tuple[NDArray, NDArray]:
    """Steady points (k, 2) of depth and force at the end of the hold, and depths at the forces ``grid_N`` (n,)."""
    points = np.array(sorted((trace.ramp.depth_mm, trace.steady_force_N) for trace in reduced))
    merged: list[tuple[list[float], list[float]]] = []
    for depth, force in points:
        if merged and depth < 1.05 * merged[-1][0][-1]:
            merged[-1][0].append(depth)
            merged[-1][1].append(force)
        else:
            merged.append(([depth], [force]))
    knots = np.array([[np.mean(depths), np.mean(forces)] for depths, forces in merged])
    slowest = min(reduced, key=lambda trace: (round(trace.velocity_mm_s, -1), -trace.ramp.depth_mm))
    rise = slowest.end_s <= slowest.ramp.stop_time_s
    x = (slowest.average @ slowest.motion.displacement_mm)[rise]
    peak = float(slowest.force_N[rise].max())
    scaled = slowest.force_N[rise] * slowest.steady_force_N / peak
    below = (x > 0.02 * knots[0, 0]) & (x < 0.97 * knots[0, 0]) & (scaled > 0)
    # the rise joins the first steady point: its shape is used, its level is the point's
    level = knots[0, 1] / float(np.interp(knots[0, 0], x, scaled))
    log_depth = np.log(np.r_[x[below], knots[:, 0]])
    log_force = np.log(np.maximum.accumulate(np.r_[scaled[below] * level, knots[:, 1]]))
    keep = np.r_[True, np.diff(log_force) > 0]
    wanted = np.log(grid_N)
    depth = np.exp(np.interp(wanted, log_force[keep], log_depth[keep], left=np.nan, right=np.nan))
    # a force a little above the deepest press still belongs to it
    last = (np.isnan(depth)) & (grid_N > knots[-1, 1]) & (grid_N <= 1.05 * knots[-1, 1])
    depth[last] = knots[-1, 0]
    return knots, depth


def _range_for(
    trace: ReducedTrace, speed: float, tissue: Tissue, lowpass: Lowpass | None, braking_mm_s2: float | None
) -> ForceRange:
    hold = trace.ramp.hold_end_s - trace.ramp.stop_time_s
    return tissue.force_range(trace.steady_force_N, speed, hold, braking_mm_s2 or braking_of(trace, speed), lowpass)


def braking_of(trace: ReducedTrace, velocity_mm_s: float) -> float:
    """Deceleration of the robot: of the way left before the stop, sqrt(d - x) = sqrt(a / 2) (t_stop - t). [mm/s2]

    With fewer than four samples there, from the rise time, t_p = d / v + v / (2 a); the default when it is not seen.

    Parameters
    ----------
    trace : ReducedTrace
    velocity_mm_s : float
        Speed before the braking.
    """
    spare = trace.ramp.rise_time_s - trace.ramp.depth_mm / velocity_mm_s
    if velocity_mm_s < 50 or spare <= 0:
        return DECELERATION_MM_S2
    rough = float(np.clip(velocity_mm_s / (2.0 * spare), *BRAKING_MM_S2))
    time, x = trace.trace.time_s, trace.trace.displacement_mm
    left = (trace.ramp.depth_mm - x) * 2.0 * rough / velocity_mm_s**2
    seen = (time > trace.ramp.contact_time_s) & (time < trace.ramp.stop_time_s) & (left > 0.02) & (left < 0.6)
    if seen.sum() < 4:
        return rough
    slope = np.polyfit(time[seen], np.sqrt(trace.ramp.depth_mm - x[seen]), 1)[0]
    return float(np.clip(2.0 * slope**2, *BRAKING_MM_S2))


def _shares(trace: ReducedTrace, band: ForceRange, noise_N: float) -> dict[str, Any]:
    """Shares of one press inside its range, give or take the steady force's tolerance or the noise."""
    time = trace.trace.time_s[trace.inside] - trace.ramp.contact_time_s
    force = trace.trace.force_N[trace.inside]
    near = max(STEADY_TOLERANCE * trace.steady_force_N, 3.0 * noise_N)
    shares = band.inside(time, force, trace.ramp.rise_time_s, near)
    return {
        "steady_force_N": trace.steady_force_N,
        "depth_mm": trace.ramp.depth_mm,
        "peak_force_N": float(force.max()),
        "range_peak_low_N": band.peak_low_N,
        "range_peak_high_N": band.peak_high_N,
        **{name: float(share) for name, share in shares.items()},
    }


def _by_condition(
    reduced: Sequence[ReducedTrace], rows: list[dict[str, Any]], test: PressTest
) -> list[dict[str, Any]]:
    """Mean over the repeats of each condition."""
    by_file = {row["file"]: row for row in rows}
    found = []
    for speed, _, group in condition_groups(reduced):
        own = [by_file[trace.trace.name] for trace in group]
        mean = {
            key: float(np.mean([row[key] for row in own])) for key in own[0] if key not in ("file", "velocity_mm_s")
        }
        found.append({"velocity_mm_s": test.speed_of(speed), **mean, "repeats": len(own)})
    return found


def _parametric(fit: Fit, tissue: Tissue) -> dict[str, Any]:
    """Each parameter beside the tissue's band at the same speed; dampers at speeds both have."""
    table: dict[str, Any] = {}
    for name, entry in fit.result["parameters"].items():
        band = tissue.bands[name]
        pairs = {name: (entry, band)} if "value" in entry else {
            f"{name}.{speed}": (one, band.get(speed)) for speed, one in entry.items()
        }  # fmt: skip
        for label, (one, limits) in pairs.items():
            row = {key: one[key] for key in ("value", "low", "high", "at_bound")}
            row |= {"band_low": None, "band_high": None, "inside": None}
            if limits is not None:
                row |= {"band_low": limits.low, "band_high": limits.high}
                row["inside"] = bool(limits.low <= one["value"] <= limits.high)
            table[label] = row
    return table


def _steady_shares(
    grid_N: NDArray, depth: NDArray, range_mm: tuple[NDArray, NDArray], span_N: tuple[float, float]
) -> dict[str, Any]:
    """Shares over the forces the dummy reached; a part it did not reach is null. Below means below the lowest force."""
    reached = ~np.isnan(depth)
    inside = (depth >= range_mm[0] - 1e-9) & (depth <= range_mm[1] + 1e-9)
    parts = {
        "inside_fraction": reached, "below_5N_fraction": reached & (grid_N <= span_N[0] * (1 + 1e-9)),
        "above_5N_fraction": reached & (grid_N >= span_N[0] * (1 - 1e-9)),
    }  # fmt: skip
    found: dict[str, Any] = {name: float(inside[part].mean()) if part.any() else None for name, part in parts.items()}
    span = grid_N[reached]
    reach = [float(span[0]), float(span[-1])] if len(span) else None
    return {**found, "reached_N": reach, "span_N": list(span_N)}


def _warnings(fit: Fit, tissue: Tissue, points: NDArray, rows: list[dict[str, Any]]) -> list[dict[str, str]]:
    shown = SHOWN if law_named(tissue.law).fitted else CODES
    found = [w for w in fit.result["warnings"] if w["code"] in shown]
    if "inferred" in tissue.kinds:
        found.append({"code": "inferred_tissue", "message": f"the band of {tissue.name} is inferred, not measured"})
    if points[0, 1] > 0.6:
        found.append(
            {"code": "steady_from_rise", "message": f"below {points[0, 1]:.2g} N the steady-state curve is the "
             "scaled rise of the slowest press, not a measured steady force"}
        )  # fmt: skip
    unknown = sorted({row["velocity_mm_s"] for row in rows} - set(tissue.velocities_mm_s))
    if tissue.measured:
        unknown = [v for v in unknown if all(max(v / one, one / v) > SPEED_APART for one in tissue.velocities_mm_s)]
    speeds = ", ".join(f"{v:g}" for v in unknown)
    if tissue.said is not None:
        found.append({"code": tissue.said[0], "message": tissue.said[1]})
    if tissue.measured and unknown:
        found.append(
            {"code": "speed_not_in_band", "message": f"nobody was pressed at {speeds} mm/s: the range there lies "
             "between the curves of the speeds beside it"}
        )  # fmt: skip
    elif law_named(tissue.law).fitted and unknown:
        found.append(
            {"code": "speed_not_in_band", "message": f"the tissue has no dampers at {speeds} mm/s: its range "
             "there uses dampers interpolated in ln c over ln v"}
        )  # fmt: skip
    return found
