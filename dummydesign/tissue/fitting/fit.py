"""Fit of the tissue law to traces: joint, per speed or per condition, with intervals and rivals compared.

A press whose contact is not where the file has it gets an offset of its own, where that is to be proposed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.quantity import Quantity
from dummydesign.inference.least_squares import profile_interval, simplest, solve
from dummydesign.inference.noise import noise_floor, whitener
from dummydesign.measurement.importing.press_checks import copies_among, doubts_of, subjects_among
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.problem import (
    Optimum,
    Responses,
    TissueProblem,
    heldout_rmse,
    problems_of,
    trace_residuals,
)
from dummydesign.tissue.fitting.reduction import reduce_trace, rounded_velocity, speed_groups
from dummydesign.tissue.model.maxwell_law import fitted_law, law_named, speed_key
from dummydesign.tissue.model.subject import FITTED, PRESSED, Subject

MOST_STEPS = 12
SETTLED_MM = 5e-4
LARGEST_SHARE = 0.4
"""Share of the depth beyond which no contact is looked for."""
UNKNOWN_MM = 1.0
"""Standard deviation that stands for an unknown offset in the intervals of the parameters. [mm]"""
_STEP_MM = 1e-3


@dataclass(frozen=True, eq=False)
class ContactOffsets:
    """Offset of each press with its 95 % interval, in the order of the traces [mm].

    ``at_end`` marks those that stand at the beginning of what was recorded, or at :data:`LARGEST_SHARE` of the depth.
    """

    value_mm: NDArray
    low_mm: NDArray
    high_mm: NDArray
    at_end: NDArray

    def to_list(self, traces: Sequence[Trace]) -> list[dict[str, float | str | bool]]:
        """One row a press."""
        columns = {"file": [trace.name for trace in traces], **{key: part.tolist() for key, part in vars(self).items()}}
        return [dict(zip(columns, row)) for row in zip(*columns.values())]

    def warnings(self, traces: Sequence[Trace]) -> list[dict[str, str]]:
        """What a reader must know of offsets that stand at an end."""
        names = [trace.name for trace, end in zip(traces, self.at_end) if end]
        if not names:
            return []
        message = (
            f"contact of {_some(names)} would lie before what was recorded, or too far in: the offset there is "
            "no measurement; record from above the surface"
        )
        return [{"code": "contact_at_end", "message": message}]


def _some(names: Sequence[str]) -> str:
    """The first three names, and how many more there are."""
    return ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")


def shifted(traces: Sequence[Trace], offsets_mm: NDArray) -> list[Trace]:
    """Traces with their zero where the surface was touched."""
    return [replace(trace, displacement_mm=trace.displacement_mm + off) for trace, off in zip(traces, offsets_mm)]


def find_offsets(traces: Sequence[Trace], law: str, mode: str, arms: int, lowpass: Lowpass | None) -> ContactOffsets:
    """Fit the law and an offset per press together."""
    at = np.zeros(len(traces))
    error = np.full(len(traces), np.inf)
    reach = LARGEST_SHARE * np.array([reduce_trace(trace).ramp.depth_mm for trace in traces])
    # a press must be recorded from before its contact
    most = np.minimum(reach, [max(-0.98 * float(trace.displacement_mm[0]), 0.0) for trace in traces])
    before = np.inf
    for _ in range(MOST_STEPS):
        reduced = [reduce_trace(one) for one in shifted(traces, at)]
        index_of = {id(one): index for index, one in enumerate(reduced)}
        step = np.zeros(len(traces))
        for problem in problems_of(law, mode, reduced, lowpass):
            moves, errors = _step(problem, problem.optimum(arms))
            for one, move, wide in zip(problem.traces, moves, errors):
                step[index_of[id(one)]], error[index_of[id(one)]] = move, wide
        largest = float(np.abs(step).max())
        # a step that does not shrink is shortened: the rise bends
        step *= min(1.0, 0.15 * float(reach.min()) / LARGEST_SHARE / largest) if largest > 0 else 1.0
        if largest > 0.9 * before:
            step *= 0.5
        before = largest
        at = np.clip(at + step, -reach, most)
        if largest < SETTLED_MM:
            break
    return ContactOffsets(at, at - 1.96 * error, at + 1.96 * error, (at >= most) | (at <= -reach))


def with_unknown_offsets(problem: TissueProblem, optimum: Optimum) -> Optimum:
    """The same fit with the offset of every press counted as unknown."""
    slope = problem.bins.stacked(_slope(problem, optimum))
    factor = whitener(_covariance(problem, optimum) + UNKNOWN_MM**2 * slope[:, :, None] * slope[:, None])
    low, high = problem.box(optimum.arms)
    refit = solve(problem.model(optimum.arms, factor), [optimum.solution.parameters], low, high)
    solution = replace(optimum.solution, parameters=refit.parameters, chi_square=refit.chi_square)
    return replace(optimum, solution=solution, factor=factor)


def _covariance(problem: TissueProblem, optimum: Optimum) -> NDArray:
    """Covariance of the bins without an error of the contact position, shape (traces, longest, longest). [N2]"""
    measured, level = problem.measured_and_level()
    return problem.bins.covariance(replace(optimum.noise, position_mm=0.0), np.zeros_like(measured), level)


def _slope(problem: TissueProblem, optimum: Optimum) -> NDArray:
    """Change of the force of every bin with the offset of its press, shape (bins,). [N/mm]"""
    theta, arms = optimum.solution.parameters, range(optimum.arms)
    gamma1, gamma, damper = problem.split(theta, optimum.arms)
    pushed = [
        [replace(t, motion=Motion(t.motion.time_s, t.motion.displacement_mm + _STEP_MM)) for t in group]
        for group in problem.groups
    ]
    moved = np.concatenate(
        [
            np.exp(gamma1) * own.elastic + sum(np.exp(gamma[arm]) * own.arm(gamma[arm] - c[arm])[0] for arm in arms)
            for own, c in zip((Responses(problem.law, group, problem.lowpass) for group in pushed), damper)
        ]
    )
    return (moved - problem.predict(theta, optimum.arms)[0]) / _STEP_MM


def _step(problem: TissueProblem, optimum: Optimum) -> tuple[NDArray, NDArray]:
    """Gauss-Newton step of the offset of each press, the parameters of the law free, and its standard deviation."""
    weight = np.linalg.inv(_covariance(problem, optimum))
    force, jacobian = problem.predict(optimum.solution.parameters, optimum.arms)
    residual = problem.bins.stacked(problem.force - force)
    columns = problem.bins.stacked(jacobian)
    slope = problem.bins.stacked(_slope(problem, optimum))
    held = (weight @ slope[..., None])[..., 0]
    own = np.maximum((held * slope).sum(axis=1), 1e-12)
    cross = (held[..., None] * columns).sum(axis=1)
    pull = (held * residual).sum(axis=1)
    weighted = weight @ columns
    hessian = np.einsum("tlp,tlq->pq", columns, weighted) - np.einsum("tp,tq->pq", cross / own[:, None], cross)
    gradient = np.einsum("tlp,tl->p", weighted, residual) - (cross * (pull / own)[:, None]).sum(axis=0)
    # log parameters: a deviation of ten is no knowledge, and keeps an arm that is not there from being singular
    inverse = np.linalg.inv(hessian + 1e-2 * np.eye(len(hessian)))
    change = inverse @ gradient
    moves = (pull - cross @ change) / own
    variance = 1.0 / own + np.einsum("tp,pq,tq->t", cross, inverse, cross) / own**2
    return moves, np.sqrt(variance)


PROPOSE = 1.3
"""Factor over the noise of the holds from which a residual is looked into, and below which it is explained."""
LEAST_OFFSET_MM = 0.02
"""Smallest contact offset that is spoken of: robot precision. [mm]"""


def proposed_offsets(traces: list[Trace], result: dict[str, Any], lowpass: Lowpass | None) -> dict[str, Any]:
    """Look for contact offsets that explain the residual of a fit without them.

    They are proposed when the residual stands out of the noise of the holds, the offsets bring it down to that noise,
    and at least one stands out of its error.
    """
    floor = result["noise_floor_N"]
    if result["rmse_N"] < PROPOSE * floor:
        return {}
    arms = (result["elements"] - 1) // 2
    law, mode = result["law"], result["mode"]
    offsets = find_offsets(traces, law, mode, arms, lowpass)
    problems = problems_of(law, mode, [reduce_trace(one) for one in shifted(traces, offsets.value_mm)], lowpass)
    left = trace_residuals([(problem, problem.optimum(arms)) for problem in problems])["rmse_N"]
    seen = np.abs(offsets.value_mm) > np.maximum(1.5 * (offsets.high_mm - offsets.value_mm), LEAST_OFFSET_MM)
    if left > PROPOSE * floor or left > result["rmse_N"] / PROPOSE or not seen.any():
        return {}
    worst = int(np.argmax(np.where(seen, np.abs(offsets.value_mm), 0.0)))
    value, low, high = (float(end[worst]) for end in (offsets.value_mm, offsets.low_mm, offsets.high_mm))
    message = (
        f"contact offsets explain the residual ({result['rmse_N']:.3g} N becomes {left:.3g} N): {traces[worst].name} "
        f"was touched {abs(value):.3f} mm ({min(abs(low), abs(high)):.3f} to {max(abs(low), abs(high)):.3f}) "
        f"{'before' if value > 0 else 'after'} its zero, {int(seen.sum())} of {len(traces)} presses are off; without "
        "them the parameters and their intervals are wrong: fit again with --contact per-press"
    )
    warning = {"code": "contact_offsets", "message": message}
    return {"proposed_contact_offsets": offsets.to_list(traces), "warnings": [*result["warnings"], warning]}


MODES = ("auto", "joint", "per-speed", "per-condition")
CONTACTS = ("none", "per-press")
Progress = Callable[[str], None]
SAME_ERROR = 1.01
"""Errors on left-out conditions that count as the same."""


@dataclass(frozen=True)
class TissueFit:
    """What was found; ``result`` is the JSON of ``fit``.

    ``problems`` are the fits it consists of (one, or one per condition) with their optimum.
    """

    law: str
    mode: str
    result: dict[str, Any]
    problems: tuple[tuple[TissueProblem, Optimum], ...]


@one_blas_thread()
def fit_traces(
    traces: Sequence[Trace],
    elements: int | str = "auto",
    law: str = "ode",
    mode: str = "joint",
    lowpass: Lowpass | None = None,
    intervals: bool = True,
    contact: str = "none",
    progress: Progress | None = None,
) -> TissueFit:
    """Fit the tissue law to traces of one tissue or dummy.

    Trust-region least squares in log parameters on binned data (about fifty bins a trace), from several
    starts, with a noise model (white, slow, contact position) estimated from the residuals; 95 %
    intervals by profile likelihood; 3, 5 and 7 elements compared by AICc and by the error on left-out
    conditions. The measured motion and the declared sensor filter are part of the model.
    """
    allowed = fitted_law(law).elements
    if mode not in MODES:
        raise unknown_name("mode", mode, MODES)
    if contact not in CONTACTS:
        raise unknown_name("contact", contact, CONTACTS)
    if elements != "auto" and elements not in allowed:
        message = f"elements = {elements} is not one of {', '.join(map(str, allowed))} or auto"
        raise InputError(message, "unknown_name", "elements", elements, (*allowed, "auto"))
    if not traces:
        raise InputError("fit needs at least one trace", "missing", "trace")
    whole, tell = list(traces), progress or (lambda step: None)
    if mode == "auto":
        mode = "per-speed" if len(speed_groups([reduce_trace(trace) for trace in traces])) > 1 else "joint"
    offsets = None
    if contact == "per-press":
        tell("where each press touched")
        offsets = find_offsets(whole, law, mode, 2 if elements == "auto" else (int(elements) - 1) // 2, lowpass)
        traces = shifted(whole, offsets.value_mm)
    reduced = [reduce_trace(trace) for trace in traces]
    problems = problems_of(law, mode, reduced, lowpass)
    optima: dict[int, list[Optimum]] = {}
    for count in allowed:
        tell(f"{count} elements")
        optima[count] = [problem.optimum((count - 1) // 2) for problem in problems]
    tell("presses left out")
    comparison = _comparison(mode, problems, optima)
    chosen = _chosen(comparison) if elements == "auto" else int(elements)
    pairs = tuple(zip(problems, optima[chosen]))
    if offsets is not None:
        pairs = tuple((problem, with_unknown_offsets(problem, optimum)) for problem, optimum in pairs)
    result: dict[str, Any] = {"elements": chosen, "law": law, "mode": mode, "contact": contact}
    result |= _parameters(mode, pairs, chosen, intervals, tell) | trace_residuals(pairs)
    order = {trace.name: index for index, trace in enumerate(whole)}
    result["by_trace"].sort(key=lambda row: order[row["file"]])
    result["noise_floor_N"] = noise_floor(trace.hold for trace in reduced)
    result["noise"] = [optimum.noise.to_dict() for _, optimum in pairs]
    result["starts"] = {"tried": pairs[0][1].solution.starts, "same_optimum": pairs[0][1].solution.agreeing}
    result["comparison"] = comparison
    result["contact_offsets"] = None if offsets is None else offsets.to_list(whole)
    result["warnings"] = [
        *_warnings(law, result, pairs),
        *(doubt for trace in traces for doubt in doubts_of(trace)),
        *([] if offsets is None else offsets.warnings(whole)),
        *copies_among(whole),
        *subjects_among(result["by_trace"]),
    ]
    if offsets is None and intervals:
        tell("contact of the presses")
        result |= proposed_offsets(whole, result, lowpass)
    return TissueFit(law, mode, result, pairs)


def _chosen(comparison: dict[str, dict[str, Any]]) -> int:
    """The simplest near the lowest AICc, or a simpler one that predicts left-out conditions better."""
    criterion = {int(n): row["aicc"] for n, row in comparison.items()}
    most = simplest(criterion)
    left_out = {int(n): row["heldout_rmse_N"] for n, row in comparison.items() if int(n) <= most}
    if any(error is None for error in left_out.values()):
        return most
    best = min(left_out.values())
    return simplest({n: criterion[n] for n, error in left_out.items() if error <= SAME_ERROR * best})


def _comparison(
    mode: str, problems: list[TissueProblem], optima: dict[int, list[Optimum]]
) -> dict[str, dict[str, Any]]:
    """Error, AICc and left-out error of 3, 5 and 7 elements."""
    table = {}
    for elements, pairs_of in optima.items():
        pairs = list(zip(problems, pairs_of))
        heldout = heldout_rmse(*pairs[0]) if mode != "per-condition" else None
        table[str(elements)] = {
            "rmse_N": trace_residuals(pairs)["rmse_N"],
            # the noise of the most flexible rival, which has the least misfit in it
            "aicc": sum(p.aicc(o, best.factor) for (p, o), best in zip(pairs, optima[max(optima)])),
            "heldout_rmse_N": heldout,
            "parameters": sum(len(optimum.solution.parameters) for optimum in pairs_of),
        }
    return table


def _parameters(
    mode: str, pairs: Sequence[tuple[TissueProblem, Optimum]], elements: int, intervals: bool, tell: Progress
) -> dict[str, Any]:
    """``parameters`` and, by mode, ``by_speed`` or ``by_condition``."""
    names = law_named(pairs[0][0].law).parameter_names(elements)
    arms = (elements - 1) // 2
    objects = [_objects(problem, optimum, intervals, tell) for problem, optimum in pairs]
    if mode == "joint":
        return {"parameters": dict(zip(names, objects[0]))}
    if mode == "per-speed":
        speeds = [speed_key(speed) for speed, _ in speed_groups(pairs[0][0].traces)]
        springs = objects[0][: 1 + arms]
        dampers = {speed: objects[0][1 + (at + 1) * arms :][:arms] for at, speed in enumerate(speeds)}
        by_speed = {speed: dict(zip(names, [*springs, *own])) for speed, own in dampers.items()}
        shared: dict[str, Any] = dict(zip(names, springs))
        for arm, name in enumerate(names[1 + arms :]):
            shared[name] = {speed: own[arm] for speed, own in dampers.items()}
        return {"parameters": shared, "by_speed": by_speed}
    conditions: list[dict[str, Any]] = [
        {
            "velocity_mm_s": rounded_velocity(float(np.median([t.velocity_mm_s for t in problem.traces]))),
            "depth_mm": float(np.mean([t.ramp.depth_mm for t in problem.traces])),
            "steady_force_N": float(np.mean([t.steady_force_N for t in problem.traces])),
            "traces": [t.trace.name for t in problem.traces],
            "parameters": dict(zip(names, own)),
        }
        for (problem, _), own in zip(pairs, objects)
    ]
    reason = "mean over conditions, as the paper reports; a mean of separate fits has no profile interval"
    mean = {
        name: {
            "value": float(np.mean([one["value"] for one in each])),
            "low": None,
            "high": None,
            "at_bound": any(one["at_bound"] for one in each),
            "reason": reason,
        }
        for name, each in zip(names, zip(*objects))
    }
    return {"parameters": mean, "by_condition": conditions}


def _objects(problem: TissueProblem, optimum: Optimum, intervals: bool, tell: Progress) -> list[dict[str, Any]]:
    """Value, interval and state of every parameter, in the order of the parameter vector."""
    low, high = problem.box(optimum.arms)
    model = problem.model(optimum.arms, optimum.factor)
    result = []
    for index, value in enumerate(optimum.solution.parameters):
        at_bound = bool(min(value - low[index], high[index] - value) < 1e-4)
        entry: dict[str, Any] = {"value": float(np.exp(value)), "low": None, "high": None, "at_bound": at_bound}
        reason = "intervals were not requested"
        if intervals:
            tell(f"interval {index + 1} of {len(low)}")
            interval = profile_interval(model, optimum.solution, index, low, high)
            ends = {"low": interval.low, "high": interval.high}
            entry |= {key: None if end is None else float(np.exp(end)) for key, end in ends.items()}
            entry["at_bound"], reason = interval.at_bound, interval.reason
        result.append(entry | ({"reason": reason} if reason else {}))
    return result


def _warnings(law: str, result: dict[str, Any], pairs: Sequence[tuple[TissueProblem, Optimum]]) -> list[dict[str, str]]:
    """Warn of what a reader of the parameters must know."""
    notes: list[tuple[str, str]] = []
    if law_named(law).ideal_ramp:
        notes.append(
            (
                "ideal_ramp",
                f"law {law} knows only an ideal ramp: mean speed and stop time of each measured motion were used",
            )
        )
    rmse, floor = result["rmse_N"], result["noise_floor_N"]
    if rmse > 2.0 * floor:
        above = f"{rmse / floor:.3g} times the noise" if floor > 0.0 else "above traces without noise"
        text = f"rms residual {rmse:.3g} N is {above}: the law does not describe these traces"
        todo = "fit one pad or person at a time and check each contact; the intervals include the misfit"
        notes.append(("lack_of_fit", f"{text}; {todo}"))
    for name, entry in result["parameters"].items():
        for key, one in {"": entry}.items() if "value" in entry else entry.items():
            at = f" at {key} mm/s" if key else ""
            if one["at_bound"]:
                notes.append(("at_bound", f"{name}{at} is at the limit of its range: these traces do not determine it"))
            elif "not identifiable" in one.get("reason", ""):
                notes.append(("not_identifiable", f"{name}{at}: {one['reason']}"))
    broken = set()
    for problem, optimum in pairs if pairs[0][1].arms == 2 else ():
        _, gamma, damper = problem.split(optimum.solution.parameters, 2)
        broken |= {"gamma2 < gamma3"} if gamma[0] >= gamma[1] else set()
        broken |= {"c2 > c3"} if np.any(damper[:, 0] <= damper[:, 1]) else set()
    if broken:
        notes.append(
            (
                "paper_order",
                f"{' and '.join(sorted(broken))}, which the paper found in all its subjects, does "
                "not hold here (arm 2 is the slow one)",
            )
        )
    return [{"code": code, "message": text} for code, text in notes]


UNKNOWN = 1000.0
"""Factor put on a side of an interval that the data do not bound."""


def subject_from_fit(name: str, fit: TissueFit) -> Subject:
    """Make a subject from a fit: kind ``fitted``, the law and mode in the source.

    An interval without an end on one side gets a factor of :data:`UNKNOWN` there, as its source states.
    A fit per condition has no intervals; the range over its conditions stands in.
    """
    rows = fit.result["by_trace"]
    files = [row["file"] for row in rows]
    shown = _some(files)
    source = f"fit of {shown}: law {fit.law}, {fit.mode}, rms residual {fit.result['rmse_N']:.3g} N"
    speeds = [speed_key(speed) for speed, _ in speed_groups([t for p, _ in fit.problems for t in p.traces])]
    numbers: dict[str, Any] = {}
    for key, entry in fit.result["parameters"].items():
        if not key.startswith("c"):
            numbers[key] = _quantity(entry, source, _over_conditions(fit, key))
            continue
        by_speed = (dict.fromkeys(speeds, entry) if "value" in entry else entry).items()
        numbers[key] = {v: _quantity(one, source, _over_conditions(fit, key, float(v))) for v, one in by_speed}
    pressed = {key: [float(row[key]) for row in rows] for key in PRESSED}
    if min(map(min, pressed.values())) <= 0.0:
        return Subject.of(name, fit.law, numbers)
    words = f"{len(files)} press{'es' if len(files) > 1 else ''}: {shown}; median, lowest and highest"
    spans = {
        key: Quantity(float(np.median(values)), min(values), max(values), "measured", words)
        for key, values in pressed.items()
    }
    off = [row["fitted_peak_force_N"] / row["peak_force_N"] for row in rows]
    spans[FITTED] = Quantity(float(np.median(off)), min(off), max(off), "fitted", words)
    return Subject.of(name, fit.law, numbers, spans)


def _over_conditions(fit: TissueFit, key: str, speed: float | None = None) -> list[float] | None:
    """Values of one parameter over the conditions (of one speed) of a fit per condition."""
    if fit.mode != "per-condition":
        return None
    return [
        condition["parameters"][key]["value"]
        for condition in fit.result["by_condition"]
        if speed is None or rounded_velocity(condition["velocity_mm_s"]) == speed
    ]


def _quantity(entry: dict[str, Any], source: str, spread: list[float] | None) -> Quantity:
    if spread:
        value = sum(spread) / len(spread)
        return Quantity(value, min(spread), max(spread), "fitted", f"{source}; low and high over conditions")
    value, low, high = entry["value"], entry["low"], entry["high"]
    if low is None or high is None:
        source = f"{source}; {entry.get('reason', 'no interval')}"
    low = value / UNKNOWN if low is None else min(low, value)
    high = value * UNKNOWN if high is None else max(high, value)
    return Quantity(value, low, high, "fitted", source)
