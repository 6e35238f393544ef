"""An offset per press where contact is not where the file has it, and when to propose it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import solve
from dummydesign.inference.noise import whitener
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.problem import Optimum, Responses, TissueProblem, problems_of
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.fitting.residuals import trace_residuals

MOST_STEPS = 12
SETTLED_MM = 5e-4
LARGEST_SHARE = 0.4
"""Share of the depth beyond which no contact is looked for."""
UNKNOWN_MM = 1.0
"""Standard deviation that stands for an unknown offset in the intervals of the parameters. [mm]"""
_STEP_MM = 1e-3


@dataclass(frozen=True)
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
        some = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
        message = (
            f"contact of {some} would lie before what was recorded, or too far in: the offset there is no "
            "measurement; record from above the surface"
        )
        return [{"code": "contact_at_end", "message": message}]


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
        place = {id(one): index for index, one in enumerate(reduced)}
        step = np.zeros(len(traces))
        for problem in problems_of(law, mode, reduced, lowpass):
            moves, errors = _step(problem, problem.optimum(arms))
            for one, move, wide in zip(problem.traces, moves, errors):
                step[place[id(one)]], error[place[id(one)]] = move, wide
        largest = float(np.abs(step).max())
        # a step that does not shrink is shortened: the rise bends
        step *= min(1.0, 0.15 * float(reach.min()) / LARGEST_SHARE / largest) if largest > 0 else 1.0
        if largest > 0.9 * before:
            step *= 0.5
        before = largest
        at = np.clip(at + step, -reach, most)
        if largest < SETTLED_MM:
            break
    ended = (at >= most) | (at <= -reach)
    return ContactOffsets(at, at - 1.96 * error, at + 1.96 * error, ended)


def with_unknown_offsets(problem: TissueProblem, optimum: Optimum) -> Optimum:
    """The same fit with the offset of every press counted as unknown."""
    slope = problem.bins.stacked(_slope(problem, optimum))
    unknown = UNKNOWN_MM**2 * slope[:, :, None] * slope[:, None]
    factor = whitener(_covariance(problem, optimum) + unknown)
    low, high = problem.box(optimum.arms)
    found = solve(problem.model(optimum.arms, factor), [optimum.solution.parameters], low, high)
    solution = replace(optimum.solution, parameters=found.parameters, chi_square=found.chi_square)
    return replace(optimum, solution=solution, factor=factor)


def _covariance(problem: TissueProblem, optimum: Optimum) -> NDArray:
    """Covariance of the bins without an error of the contact position, shape (traces, longest, longest). [N2]"""
    measured, level = problem.measured_and_level()
    return problem.bins.covariance(replace(optimum.noise, position_mm=0.0), np.zeros_like(measured), level)


def _slope(problem: TissueProblem, optimum: Optimum) -> NDArray:
    """Change of the force of every bin with the offset of its press, shape (bins,). [N/mm]"""
    theta = optimum.solution.parameters
    base = problem.predict(theta, optimum.arms)[0]
    gamma1, gamma, damper = problem.split(theta, optimum.arms)
    moved = np.empty_like(base)
    for group, (where, traces) in enumerate(zip(problem.slices, problem.groups)):
        pushed = [replace(t, motion=Motion(t.motion.time_s, t.motion.displacement_mm + _STEP_MM)) for t in traces]
        response = Responses(problem.law, pushed, problem.lowpass)
        moved[where] = np.exp(gamma1) * response.elastic + sum(
            np.exp(gamma[arm]) * response.arm(gamma[arm] - damper[group, arm])[0] for arm in range(optimum.arms)
        )
    return (moved - base) / _STEP_MM


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
