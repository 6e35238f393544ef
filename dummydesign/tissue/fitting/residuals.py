"""Residuals of a fit on the raw samples, the noise floor, and the error on left-out data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import solve
from dummydesign.tissue.fitting.problem import Optimum, TissueProblem
from dummydesign.tissue.fitting.reduction import condition_groups
from dummydesign.tissue.model.laws import law_named


def fitted_force(problem: TissueProblem, optimum: Optimum, index: int) -> NDArray:
    """Fitted force of trace ``index`` of the problem at its nodes, filtered as recorded. [N]"""
    gamma1, gamma, damper = problem.split(optimum.solution.parameters, optimum.arms)
    group = next(g for g in range(len(problem.groups)) if index < sum(len(part) for part in problem.groups[: g + 1]))
    motion = problem.traces[index].motion
    curve = law_named(problem.law).force(motion, np.exp(gamma1), np.exp(gamma), np.exp(damper[group]))
    return curve if problem.lowpass is None else problem.lowpass.apply(motion.time_s, curve)


def trace_residuals(pairs: Sequence[tuple[TissueProblem, Optimum]]) -> dict[str, Any]:
    """Residuals of all traces."""
    rows: list[dict[str, Any]] = []
    squares, count = 0.0, 0
    for problem, optimum in pairs:
        binned = problem.predict(optimum.solution.parameters, optimum.arms)[0] - problem.force
        for index, (trace, own) in enumerate(problem.by_trace(binned)):
            raw, time = trace.trace.force_N[trace.inside], trace.trace.time_s[trace.inside]
            model = np.interp(time, trace.motion.time_s, fitted_force(problem, optimum, index))
            worst = int(np.argmax(np.abs(own)))
            squares, count = squares + float(((raw - model) ** 2).sum()), count + len(raw)
            rows.append({
                "file": trace.trace.name,
                "velocity_mm_s": trace.velocity_mm_s,
                "depth_mm": trace.ramp.depth_mm,
                "steady_force_N": trace.steady_force_N,
                "peak_force_N": float(trace.force_N.max()),
                "fitted_peak_force_N": float(model.max()),
                "rmse_N": float(np.sqrt(np.mean((raw - model) ** 2))),
                "max_residual_N": float(abs(own[worst])),
                "max_residual_time_s": float(trace.middle_s[worst] - trace.ramp.contact_time_s),
            })  # fmt: skip
    return {
        "rmse_N": float(np.sqrt(squares / count)),
        "max_residual_N": max(row["max_residual_N"] for row in rows),
        "by_trace": rows,
    }


def heldout_rmse(problem: TissueProblem, optimum: Optimum) -> float | None:
    """Rms over the bins of conditions (speed and depth) left out of the fit one after another. [N]"""
    conditions = [{id(trace) for trace in group} for _, _, group in condition_groups(problem.traces)]
    if len(conditions) < 3:
        return None
    low, high = problem.box(optimum.arms)
    owner = np.repeat(np.arange(len(problem.traces)), [len(trace.force_N) for trace in problem.traces])
    squares, count = 0.0, 0
    for members in conditions:
        out = np.array([id(trace) in members for trace in problem.traces])
        left = [sum(id(t) not in members for t in group) for group in problem.groups]
        if min(left) == 0:
            continue
        factor = optimum.factor.copy()
        factor[out] = 0.0
        found = solve(problem.model(optimum.arms, factor), [optimum.solution.parameters], low, high, 1e-6)
        error = problem.predict(found.parameters, optimum.arms)[0] - problem.force
        squares, count = squares + float((error[out[owner]] ** 2).sum()), count + int(out[owner].sum())
    return float(np.sqrt(squares / count)) if count else None


def residual_table(pairs: Sequence[tuple[TissueProblem, Optimum]]) -> str:
    """CSV of all bins: file, time since contact, displacement, force, fitted force, residual."""
    lines = ["file,time_since_contact_s,displacement_mm,force_N,fitted_N,residual_N"]
    for problem, optimum in pairs:
        fitted = problem.predict(optimum.solution.parameters, optimum.arms)[0]
        for trace, model in problem.by_trace(fitted):
            since = trace.middle_s - trace.ramp.contact_time_s
            for row in zip(since, trace.depth_mm, trace.force_N, model, trace.force_N - model):
                lines.append(trace.trace.name + "".join(f",{number:.6g}" for number in row))
    return "\n".join(lines) + "\n"


def residual_plot(pairs: Sequence[tuple[TissueProblem, Optimum]], title: str) -> bytes:
    """PNG: residual of every bin over time since the stop (hold) and over depth (rise)."""
    import io

    import matplotlib

    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4), layout="constrained")
    rise, hold = figure.subplots(1, 2, sharey=True)
    for problem, optimum in pairs:
        error = problem.force - problem.predict(optimum.solution.parameters, optimum.arms)[0]
        for trace, own in problem.by_trace(error):
            after = trace.middle_s > trace.ramp.stop_time_s
            label = f"{trace.velocity_mm_s:.3g} mm/s, {trace.steady_force_N:.3g} N"
            line = hold.semilogx(trace.middle_s[after] - trace.ramp.stop_time_s, own[after], lw=0.9, label=label)
            rise.plot(trace.depth_mm[~after], own[~after], lw=0.9, color=line[0].get_color())
    rise.set(xlabel="depth in the rise [mm]", ylabel="measured - fitted [N]", title=title)
    hold.set(xlabel="time since the stop [s]")
    for axes in (rise, hold):
        axes.axhline(0.0, color="0.6", lw=0.6)
    if sum(len(problem.traces) for problem, _ in pairs) <= 12:
        hold.legend(fontsize=7)
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=110)
    return stream.getvalue()
