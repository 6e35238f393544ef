"""Where each press really touched: an offset per press fitted with the law, and whether it explains a residual.

The offset is added to the displacement: the surface was touched so much before (above 0) or after the zero of the
file. Law and offsets are found together by Gauss-Newton steps; the presses are cut anew at every step, for the part of
the rise that counts moves with the contact. Intervals of the law's parameters then count the offsets as unknown: their
direction is given a variance so large that it says nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import solve
from dummydesign.inference.noise import whitener
from dummydesign.measurement.motion import Motion
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace
from dummydesign.tissue.fitting.problem import Optimum, Problem, problems_of
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.fitting.responses import Responses

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
        rows = zip(traces, *(part.tolist() for part in (self.value_mm, self.low_mm, self.high_mm, self.at_end)))
        return [
            {"file": trace.name, "value_mm": value, "low_mm": low, "high_mm": high, "at_end": end}
            for trace, value, low, high, end in rows
        ]

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
    """Fit the law and an offset per press together.

    Parameters
    ----------
    traces : sequence of Trace
        The presses.
    law, mode : str
        As for :func:`~dummydesign.tissue.fitting.fit.fit_traces`.
    arms : int
        Number of arms of the law.
    lowpass : Lowpass, optional
        Filter that the forces went through.

    Raises
    ------
    InputError
        When a trace holds no press.
    """
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


def with_unknown_offsets(problem: Problem, optimum: Optimum) -> Optimum:
    """The same fit with the offset of every press counted as unknown."""
    slope = problem.bins.stacked(_slope(problem, optimum))
    unknown = UNKNOWN_MM**2 * slope[:, :, None] * slope[:, None]
    factor = whitener(_covariance(problem, optimum) + unknown)
    low, high = problem.box(optimum.arms)
    found = solve(problem.model(optimum.arms, factor), [optimum.solution.parameters], low, high)
    solution = replace(optimum.solution, parameters=found.parameters, chi_square=found.chi_square)
    return replace(optimum, solution=solution, factor=factor)


def _covariance(problem: Problem, optimum: Optimum) -> NDArray:
    """Covariance of the bins without an error of the contact position, shape (traces, longest, longest). [N2]"""
    measured = problem.bins.stacked(problem.force)
    level = np.where(problem.bins.used, measured.max(axis=1, keepdims=True), 0.0)
    return problem.bins.covariance(replace(optimum.noise, position_mm=0.0), np.zeros_like(measured), level)


def _slope(problem: Problem, optimum: Optimum) -> NDArray:
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


def _step(problem: Problem, optimum: Optimum) -> tuple[NDArray, NDArray]:
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
