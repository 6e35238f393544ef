"""Follow the equilibrium of a pad while a punch goes down, with adaptive load steps."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.interpolation import cubic_by_slopes, monotone_slopes
from dummydesign.core.progress import tell_depth
from dummydesign.pad.force_law import NO_COST, Array
from dummydesign.pad.solve.equilibrium import (
    RESIDUAL_TOLERANCE,
    TIED,
    ContactProblem,
    Equilibrium,
    Failure,
    explain,
    find_equilibrium,
)

# Residual of states that are passed on the way to a wanted depth, on a lattice, and where a contact that sticks grows:
# there a hundredth of it moves forces by at most 0.006 %.
PATH_TOLERANCE, GROWING_TOLERANCE = 1e-4, 1e-3
# Steps that take no more iterations than this, and this more for each time that contact was tied, may grow.
EASY = 5
EASY_PER_TIE = 2
# On a lattice, steps in which nothing comes to touch may be larger by this factor.
WITHOUT_TIES = 4.0


@dataclass(frozen=True)
class ForcePath:
    """Forces at the depths that were reached, and what the solve cost.

    ``stop`` is None when every depth was reached, else the reason in words; ``doubt`` the relative error of forces
    that lie between the ends of steps.
    """

    depth: Array
    force: Array
    smallest_J: Array
    unknowns: int
    load_steps: int
    newton_iterations: int
    seconds: float
    stop: str | None
    doubt: Array | None = None


@dataclass(frozen=True)
class VisitedState:
    """The end of a step on a path: depth, displacements, pressures, and what the surface remembers of contact.

    ``force`` is what the pad carries there, ``smallest_J`` the smallest volume ratio.
    """

    depth: float
    u: Array
    p: Array
    memory: Any
    force: float = math.nan
    smallest_J: float = math.nan


def force_between(ends: Sequence[VisitedState], depths: Array) -> tuple[Array, Array]:
    """Force at depths up to the last end of a step, and its relative error: ln F over ln d by a monotone cubic.

    A force knows of two ends before it and two after it. The stiffness at an end is no slope for it: it jumps by some
    per cent when a point comes to touch, and forces left out were met three times worse by it. The error is how far the
    parabolas through both ends and the slope at one of them lie apart. Above the first end the force goes with a power
    of the depth.
    """
    x, y = (np.log([getattr(end, name) for end in ends]) for name in ("depth", "force"))
    at = np.log(depths)
    if len(ends) == 1:
        return np.exp(np.full(len(at), y[0])), np.zeros(len(at))
    power, inside = monotone_slopes(x, y), np.clip(at, x[0], x[-1])
    left = np.clip(np.searchsorted(x, inside, side="right") - 1, 0, len(x) - 2)
    step, far = np.diff(x)[left], inside - x[left]
    bend = (power[left] + power[left + 1] - 2.0 * np.diff(y)[left] / step) / step
    log = cubic_by_slopes(x, y, power)(inside) + power[0] * np.minimum(at - x[0], 0.0)
    return np.exp(log), np.abs(bend * far * (step - far))


def state_between(problem: ContactProblem, passed: Sequence[VisitedState], depth: float) -> Equilibrium | Failure:
    """Equilibrium at a depth that a path has passed, from the ends of the steps before and after it."""
    after = next(i for i, end in enumerate(passed) if end.depth >= depth * (1.0 - 1e-9))
    before = passed[after - 1] if after else VisitedState(0.0, *problem.start(), None)
    end = passed[after]
    if problem.surface is not None:
        if before.memory is not None:
            problem.surface.restore(before.memory)
        problem.surface.settle(before.u, problem.punch, before.depth)
    part = (depth - before.depth) / (end.depth - before.depth)
    return find_equilibrium(problem, before.u + part * (end.u - before.u), before.p + part * (end.p - before.p), depth)


def cost(paths: Sequence[Any]) -> dict[str, float]:
    """Return the cost of several paths together: their largest number of unknowns, and sums of the rest."""
    return add_costs(*({name: getattr(path, name) for name in NO_COST} for path in paths))


def add_costs(*costs: Mapping[str, float]) -> dict[str, float]:
    """Add up what several solves cost: the largest number of unknowns, and sums of the rest."""
    return {name: (max if name == "unknowns" else sum)(one[name] for one in costs) for name in NO_COST}


@one_blas_thread()
def follow(
    problem: ContactProblem,
    depths: ArrayLike,
    first_step: float,
    largest_step: float,
    smallest_step: float,
    sound_J: float = 0.0,
    lattice: bool = False,
    visit: Callable[[float, Equilibrium], str | None] | None = None,
    keep: Callable[[VisitedState], str | None] | None = None,
    most_wasted: float = math.inf,
    after: Sequence[VisitedState] = (),
    ahead: Callable[[float], tuple[Array, Array]] | None = None,
    explained: Callable[[ContactProblem, Array, Array, float, str], str] | None = None,
) -> ForcePath:
    """Follow the equilibrium from first touch through ``depths`` (increasing, in the mesh's unit of length).

    Every depth is met exactly. A step that fails is halved and tried again from the last good state;
    below ``smallest_step``, or when failed steps cost more than ``most_wasted``, the path ends there and says why.
    It also ends after a wanted depth at which the smallest volume ratio is below ``sound_J``.

    With ``lattice`` the steps end at multiples of ``largest_step`` (halves, quarters, ... of it at the start),
    whatever depths are wanted; those are solved beside the path and leave no trace on it. Contact that sticks
    remembers its path, so this makes an answer independent of the other requested depths.

    ``visit`` is called with every wanted depth and the equilibrium found there, ``keep`` with the end of every step.
    Where ``visit`` says why, the path ends before that depth; where ``keep`` does, there. It goes on from the ends of
    steps ``after``, where there are some. A mesh that moves gives what is expected ``ahead``, at a depth, and how the
    end of its path is ``explained``.
    """
    began, why = time.perf_counter(), explained or explain
    targets = np.asarray(depths, dtype=float)
    u, p = problem.start()
    direction = problem.direction()
    earlier: tuple[Array, Array, float] | None = None
    depth, step, iterations, steps, stop = 0.0, min(first_step, largest_step), 0, 0, None
    if len(after) > 1:
        before, last = after[-2:]
        earlier, u, p, depth = (before.u, before.p, before.depth), last.u, last.p, last.depth
        step = depth - before.depth
        if problem.surface is not None:
            problem.surface.restore(last.memory)
            problem.surface.settle(u, problem.punch, depth)
    grows = problem.surface is not None and problem.surface.changes > 0
    on_the_way = GROWING_TOLERANCE if grows else PATH_TOLERANCE
    wasted, since = 0, depth
    points: list[tuple[float, float, float]] = []
    while len(points) < len(targets) and stop is None:
        if lattice:
            trial_depth = _on_lattice(depth, step, largest_step, targets[-1])
        else:
            remaining = targets[len(points)] - depth
            # Do not leave a sliver before the next wanted depth.
            trial_depth = targets[len(points)] if remaining <= step * 1.25 else depth + min(step, remaining / 2.0)
        if ahead is not None:
            guess = ahead(trial_depth)
        elif earlier is None:
            guess = u + (trial_depth - depth) * direction[0], p + (trial_depth - depth) * direction[1]
        else:
            # After a very small step its direction is mostly rounding: do not stretch it far.
            ratio = min((trial_depth - depth) / (depth - earlier[2]), 5.0)
            guess = u + ratio * (u - earlier[0]), p + ratio * (p - earlier[1])
        passing = lattice and not np.isclose(targets, trial_depth, rtol=1e-9, atol=0.0).any()
        long = lattice and trial_depth - depth > largest_step * (1.0 + 1e-9)
        aim = on_the_way if passing else RESIDUAL_TOLERANCE
        answer = find_equilibrium(problem, *guess, trial_depth, aim, without_ties=long)
        iterations += answer.iterations
        if isinstance(answer, Failure) and answer.reason == TIED:
            step = largest_step
            continue
        if isinstance(answer, Failure):
            wasted, since = (wasted, since) if depth - since < largest_step else (0, depth)
            wasted += answer.iterations
            step = 0.5 * (trial_depth - depth)
            if step < smallest_step or wasted > most_wasted:
                stop = why(problem, u, p, depth, answer.reason)
            continue
        passed = [goal for goal in targets[len(points) :] if goal <= trial_depth * (1.0 + 1e-12)]
        tied = problem.surface.memory() if problem.surface is not None and passed else None
        between: Equilibrium | Failure = answer
        for goal in passed:
            between = answer
            if goal < trial_depth * (1.0 - 1e-9):
                part = (goal - depth) / (trial_depth - depth)
                between = find_equilibrium(problem, u + part * (answer.u - u), p + part * (answer.p - p), goal)
                iterations += between.iterations
                if isinstance(between, Failure):
                    break
            if visit and (stop := visit(goal, between)):
                break
            points.append((goal, problem.force(between.state), float(between.state.J.min())))
            tell_depth(goal)
            if points[-1][2] < sound_J:
                stop = why(problem, answer.u, answer.p, goal, f"a volume ratio fell below {sound_J:g}")
                break
        if isinstance(between, Failure):
            # A wanted depth that cannot be met from here is met from nearer by.
            step = 0.5 * (trial_depth - depth)
            if step < smallest_step:
                stop = why(problem, u, p, depth, between.reason)
            continue
        if tied is not None and problem.surface is not None:
            problem.surface.restore(tied)
        earlier, u, p, depth = (u, p, depth), answer.u, answer.p, trial_depth
        if keep:
            memory = None if problem.surface is None else problem.surface.memory()
            state = answer.state
            stop = stop or keep(VisitedState(depth, u, p, memory, problem.force(state), float(state.J.min())))
        if problem.surface is not None:
            problem.surface.settle(u, problem.punch, depth)
        steps += 1
        if answer.iterations <= EASY + EASY_PER_TIE * answer.ties:
            step = min(1.4 * step, largest_step if answer.ties or not lattice else WITHOUT_TIES * largest_step)
    reached, force, smallest_J = np.array(points).reshape(-1, 3).T
    return ForcePath(
        reached,
        force,
        smallest_J,
        problem.pattern.n,
        steps,
        iterations,
        time.perf_counter() - began,
        stop,
    )


def _on_lattice(depth: float, step: float, largest: float, last: float) -> float:
    """The next end of a step: a multiple of ``largest`` over a power of two, at most ``last``."""
    level = largest * 0.5 ** int(np.ceil(np.log2(largest / step) - 1e-9))
    return min((np.floor(depth / level + 1e-6) + 1.0) * level, last)
