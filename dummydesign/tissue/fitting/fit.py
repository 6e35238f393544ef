"""Fit of the tissue law to traces: joint, per speed or per condition, with intervals and rivals compared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.threads import one_blas_thread
from dummydesign.inference.model_selection import simplest
from dummydesign.inference.noise_floor import noise_floor
from dummydesign.inference.profile import profile_interval
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.measurement.trace_checks import copies_among, doubts_of, subjects_among
from dummydesign.tissue.fitting.contact_offsets import find_offsets, shifted, with_unknown_offsets
from dummydesign.tissue.fitting.groups import rounded_velocity, speed_groups
from dummydesign.tissue.fitting.offset_proposal import proposed_offsets
from dummydesign.tissue.fitting.problem import Optimum, Problem, problems_of
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.fitting.residuals import heldout_rmse, trace_residuals
from dummydesign.tissue.model.laws import fitted_law, law_named
from dummydesign.tissue.model.parameters import speed_key

MODES = ("auto", "joint", "per-speed", "per-condition")
CONTACTS = ("none", "per-press")
Progress = Callable[[str], None]
SAME_ERROR = 1.01
"""Errors on left-out conditions that count as the same."""

@dataclass(frozen=True)
class Fit:
    """What was found; :meth:`to_dict` is the JSON of ``fit``.

    ``problems`` are the fits it consists of (one, or one per condition) with their optimum.
    """

    elements: int
    law: str
    mode: str
    lowpass: Lowpass | None
    result: dict[str, Any]
    problems: tuple[tuple[Problem, Optimum], ...]

    def to_dict(self) -> dict[str, Any]:
        """Return parameters, intervals, residuals and the comparison of elements as plain values."""
        return dict(self.result)


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
) -> Fit:
    """Fit the tissue law to traces of one tissue or dummy.

    Trust-region least squares in log parameters on binned data (about fifty bins a trace), from several
    starts, with a noise model (white, slow, contact position) estimated from the residuals; 95 %
    intervals by profile likelihood; 3, 5 and 7 elements compared by AICc and by the error on left-out
    conditions. The measured motion and the declared sensor filter are part of the model.

    Parameters
    ----------
    traces : sequence of Trace
        Any forces, speeds and repeats of the same specimen.
    elements : 3, 5, 7 or "auto"
        ``auto`` takes the fewest whose AICc is within 6 of the lowest, or fewer that predict left-out conditions
        better (by more than 1 %).
    law : str
        ``ode``, ``consistent`` or ``published``; the latter two use mean speed and stop time only.
    mode : str
        ``joint`` (one set), ``per-speed`` (gamma shared, c per speed), ``per-condition`` (as the
        paper: every speed and depth by itself, then averaged), or ``auto``: per speed when speeds differ, else joint.
    lowpass : Lowpass, optional
        Filter the recorded forces went through.
    intervals : bool
        Whether to compute intervals.
    contact : str
        ``none``, or ``per-press``: an offset of the contact of each press is fitted with the law, see
        :mod:`~dummydesign.tissue.fitting.contact_offsets`.
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Fit

    Raises
    ------
    InputError
        For unknown choices, no traces, or a trace without a press and a hold.
    """
    form = fitted_law(law)
    allowed = form.elements
    if mode not in MODES:
        raise unknown_name("mode", mode, MODES)
    if contact not in CONTACTS:
        raise unknown_name("contact", contact, CONTACTS)
    if elements != "auto" and elements not in allowed:
        raise InputError(f"elements = {elements} is not one of {', '.join(map(str, allowed))} or auto")
    if not traces:
        raise InputError("fit needs at least one trace")
    whole, tell = list(traces), progress or _silent
    if mode == "auto":
        mode = "per-speed" if len(speed_groups([reduce_trace(trace) for trace in traces])) > 1 else "joint"
    offsets = None
    if contact == "per-press":
        tell("where each press touched")
        arms = 2 if elements == "auto" else (int(elements) - 1) // 2
        offsets = find_offsets(whole, law, mode, arms, lowpass)
        traces = shifted(whole, offsets.value_mm)
    reduced = [reduce_trace(trace) for trace in traces]
    problems = problems_of(law, mode, reduced, lowpass)
    optima: dict[int, list[Optimum]] = {}
    for n in allowed:
        tell(f"{n} elements")
        optima[n] = [problem.optimum((n - 1) // 2) for problem in problems]
    tell("presses left out")
    comparison = _comparison(mode, problems, optima)
    chosen = _chosen(comparison) if elements == "auto" else int(elements)
    pairs = tuple(zip(problems, optima[chosen]))
    if offsets is not None:
        pairs = tuple((problem, with_unknown_offsets(problem, optimum)) for problem, optimum in pairs)
    result: dict[str, Any] = {"elements": chosen, "law": law, "mode": mode, "contact": contact}
    result |= _parameters(mode, pairs, chosen, intervals, tell)
    result |= trace_residuals(pairs)
    place = {trace.name: index for index, trace in enumerate(whole)}
    result["by_trace"].sort(key=lambda row: place[row["file"]])
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
    return Fit(chosen, law, mode, lowpass, result, pairs)


def _silent(word: str) -> None:
    """Tell nobody."""


def _chosen(comparison: dict[str, dict[str, Any]]) -> int:
    """The simplest near the lowest AICc, or a simpler one that predicts left-out conditions better."""
    criterion = {int(n): row["aicc"] for n, row in comparison.items()}
    most = simplest(criterion)
    left_out = {int(n): row["heldout_rmse_N"] for n, row in comparison.items() if int(n) <= most}
    if any(error is None for error in left_out.values()):
        return most
    best = min(left_out.values())
    return simplest({n: criterion[n] for n, error in left_out.items() if error <= SAME_ERROR * best})


def _comparison(mode: str, problems: list[Problem], optima: dict[int, list[Optimum]]) -> dict[str, dict[str, Any]]:
    """Error, AICc and left-out error of 3, 5 and 7 elements."""
    table = {}
    for elements, found in optima.items():
        pairs = list(zip(problems, found))
        heldout = heldout_rmse(*pairs[0]) if mode != "per-condition" else None
        table[str(elements)] = {
            "rmse_N": trace_residuals(pairs)["rmse_N"],
            # the noise of the most flexible rival, which has the least misfit in it
            "aicc": sum(p.aicc(o, best.factor) for (p, o), best in zip(pairs, optima[max(optima)])),
            "heldout_rmse_N": heldout,
            "parameters": sum(len(optimum.solution.parameters) for optimum in found),
        }
    return table


def _parameters(
    mode: str, pairs: Sequence[tuple[Problem, Optimum]], elements: int, intervals: bool, tell: Progress
) -> dict[str, Any]:
    """``parameters`` and, by mode, ``by_speed`` or ``by_condition``."""
    names = law_named(pairs[0][0].law).parameter_names(elements)
    arms = (elements - 1) // 2
    objects = [_objects(problem, optimum, intervals, tell) for problem, optimum in pairs]
    if mode == "joint":
        return {"parameters": dict(zip(names, objects[0]))}
    if mode == "per-speed":
        speeds = [speed_key(speed) for speed, _ in speed_groups(pairs[0][0].traces)]
        springs, dampers = objects[0][: 1 + arms], objects[0][1 + arms :]
        by_speed = {
            speed: dict(zip(names, [*springs, *dampers[at * arms : (at + 1) * arms]]))
            for at, speed in enumerate(speeds)
        }
        shared: dict[str, Any] = dict(zip(names, springs))
        for arm in range(arms):
            shared[names[1 + arms + arm]] = {speed: dampers[at * arms + arm] for at, speed in enumerate(speeds)}
        return {"parameters": shared, "by_speed": by_speed}
    conditions: list[dict[str, Any]] = []
    for (problem, _), own in zip(pairs, objects):
        group = problem.traces
        conditions.append(
            {
                "velocity_mm_s": rounded_velocity(float(np.median([t.velocity_mm_s for t in group]))),
                "depth_mm": float(np.mean([t.ramp.depth_mm for t in group])),
                "steady_force_N": float(np.mean([t.steady_force_N for t in group])),
                "traces": [t.trace.name for t in group],
                "parameters": dict(zip(names, own)),
            }
        )
    reason = "mean over conditions, as the paper reports; a mean of separate fits has no profile interval"
    mean = {
        name: {
            "value": float(np.mean([c["parameters"][name]["value"] for c in conditions])),
            "low": None, "high": None, "at_bound": any(c["parameters"][name]["at_bound"] for c in conditions),
            "reason": reason,
        }
        for name in names
    }  # fmt: skip
    return {"parameters": mean, "by_condition": conditions}


def _objects(problem: Problem, optimum: Optimum, intervals: bool, tell: Progress) -> list[dict[str, Any]]:
    """Value, interval and state of every parameter, in the order of the parameter vector."""
    low, high = problem.box(optimum.arms)
    model = problem.model(optimum.arms, optimum.factor)
    result = []
    for index, value in enumerate(optimum.solution.parameters):
        entry: dict[str, Any] = {"value": float(np.exp(value)), "low": None, "high": None}
        edge = min(value - low[index], high[index] - value)
        entry["at_bound"] = bool(edge < 1e-4)
        if intervals:
            tell(f"interval {index + 1} of {len(low)}")
            found = profile_interval(model, optimum.solution, index, low, high)
            entry["low"] = None if found.low is None else float(np.exp(found.low))
            entry["high"] = None if found.high is None else float(np.exp(found.high))
            entry["at_bound"] = found.at_bound
            if found.reason:
                entry["reason"] = found.reason
        else:
            entry["reason"] = "intervals were not asked for"
        result.append(entry)
    return result


def _warnings(law: str, result: dict[str, Any], pairs: Sequence[tuple[Problem, Optimum]]) -> list[dict[str, str]]:
    """Say what a reader of the parameters must know."""
    found = []
    if law_named(law).ideal_ramp:
        found.append(
            {"code": "ideal_ramp", "message": f"law {law} knows only an ideal ramp: mean speed and stop time of "
             "each measured motion were used"}
        )  # fmt: skip
    if result["rmse_N"] > 2.0 * result["noise_floor_N"]:
        floor = result["noise_floor_N"]
        above = f"{result['rmse_N'] / floor:.1f} times the noise floor" if floor > 0.0 else "above traces without noise"
        found.append(
            {"code": "lack_of_fit", "message": f"rms residual {result['rmse_N']:.3g} N is {above}: the law does not "
             "describe these traces; intervals count the misfit as correlated noise"}
        )  # fmt: skip
    for name, entry in result["parameters"].items():
        for key, one in {"": entry}.items() if "value" in entry else entry.items():
            at = f" at {key} mm/s" if key else ""
            if one["at_bound"]:
                found.append({"code": "at_bound", "message": f"{name}{at} at the limit of its range"})
            elif "not identifiable" in one.get("reason", ""):
                found.append({"code": "not_identifiable", "message": f"{name}{at}: {one['reason']}"})
    broken = _paper_order(pairs)
    if broken:
        found.append({"code": "paper_order", "message": broken})
    return found


def _paper_order(pairs: Sequence[tuple[Problem, Optimum]]) -> str:
    """Say when gamma2 < gamma3 or c2 > c3 does not hold, as the paper always found with five elements."""
    if pairs[0][1].arms != 2:
        return ""
    broken = []
    for problem, optimum in pairs:
        _, gamma, damper = problem.split(optimum.solution.parameters, 2)
        if gamma[0] >= gamma[1]:
            broken.append("gamma2 < gamma3")
        if np.any(damper[:, 0] <= damper[:, 1]):
            broken.append("c2 > c3")
    if not broken:
        return ""
    which = " and ".join(sorted(set(broken)))
    return f"{which}, which the paper found in all its subjects, does not hold here (arm 2 is the slow one)"
