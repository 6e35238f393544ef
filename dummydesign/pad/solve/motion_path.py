"""Follow a viscoelastic pad or puck along a motion: Newton's method at each time, steps cut where it fails."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dummydesign.pad.material.viscoelastic import Viscoelastic
from dummydesign.pad.solve.equilibrium import Failure, Problem, explain, find_equilibrium

Array = np.ndarray

SMALLEST_SHARE = 1e-3


@dataclass(frozen=True)
class MotionPath:
    """Forces at the times that were reached, in the units of the problem, and what the solve cost.

    ``refused`` says whether ``check`` of the states ended the path.
    """

    time_s: Array
    depth: Array
    force: Array
    unknowns: int
    load_steps: int
    newton_iterations: int
    seconds: float
    stop: str | None
    refused: bool = False


def follow_motion(
    problem: Problem, time_s: Array, depth: Array, largest_step: float, progress: Callable[[float], None] | None = None,
    check: Callable[[float, Array], str | None] | None = None,
) -> MotionPath:  # fmt: skip
    """Follow a motion, piecewise linear in time, from the undeformed state."""
    began = clock.perf_counter()
    law = problem.solid.law if isinstance(problem.solid.law, Viscoelastic) else None
    u, p = problem.start()
    now, here, steps, iterations, stop = float(time_s[0]), 0.0, 0, 0, None
    direction = problem.direction()
    earlier: tuple[Array, Array] | None = None
    moved, refused = 0.0, False
    forces = [0.0]
    for goal_time, goal in zip(time_s[1:], depth[1:]):
        parts = max(1, int(np.ceil(abs(goal - here) / largest_step - 1e-9)))
        todo = [1.0 / parts] * parts
        start_time, start, done, state = now, here, 0.0, None
        while todo:
            share = todo[0]
            last = len(todo) == 1
            to_time = goal_time if last else start_time + (done + share) * (goal_time - start_time)
            to = goal if last else start + (done + share) * (goal - start)
            if law is not None:
                law.begin(to_time - now)
            answer = find_equilibrium(problem, *_guess(u, p, to - here, earlier, moved, direction), to)
            if isinstance(answer, Failure):
                iterations += answer.iterations
                todo[:1] = [0.5 * share, 0.5 * share]
                if 0.5 * share < SMALLEST_SHARE / parts:
                    stop = f"{explain(problem, u, p, here, answer.reason)}; at {now:.4g} s"
                    break
                continue
            if check and (why := check(to, answer.u)):
                stop, refused = f"{why}; at {to_time:.4g} s", True
                break
            if to != here:
                earlier, moved = (u, p), to - here
            u, p, state = answer.u, answer.p, answer.state
            if law is not None:
                law.commit(problem.solid.deformation(u))
            if problem.surface is not None:
                problem.surface.settle(u, problem.punch, to)
            now, here, done = to_time, to, done + share
            steps, iterations = steps + 1, iterations + len(answer.residuals)
            todo.pop(0)
        if stop:
            break
        assert state is not None
        forces.append(problem.force(state))
        if progress:
            progress(here)
    count = len(forces)
    return MotionPath(
        time_s[:count], depth[:count], np.array(forces), problem.pattern.n, steps, iterations,
        clock.perf_counter() - began, stop, refused,
    )  # fmt: skip


def _guess(
    u: Array, p: Array, move: float, earlier: tuple[Array, Array] | None, moved: float, direction: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Extrapolate the last step that moved; stay when the punch stays."""
    if move == 0.0:
        return u, p
    if earlier is None:
        return u + move * direction[0], p + move * direction[1]
    ratio = float(np.clip(move / moved, -5.0, 5.0))
    return u + ratio * (u - earlier[0]), p + ratio * (p - earlier[1])
