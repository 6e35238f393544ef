"""How far a finite-strain viscoelastic pad departs from the quasi-linear prediction, solved along its motion."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from dummydesign.core.cache import cached
from dummydesign.core.progress import tell_depth
from dummydesign.pad.axisymmetric.case import Array, Case, rimmed_problem, unsolved
from dummydesign.pad.axisymmetric.self_contact import FoldWatch, RoundFace
from dummydesign.pad.axisymmetric.shaped_problem import FLAT_STEP, LARGEST_STEP, RIMS, shaped_problem
from dummydesign.pad.fem.mesh_axisymmetric import Resolution
from dummydesign.pad.material.relaxation import PronyTerm, Viscoelastic, relaxed_force
from dummydesign.pad.pad_under_punch import SLAB
from dummydesign.pad.solve.continuation import ForcePath, add_costs, cost
from dummydesign.pad.solve.equilibrium import ContactProblem, Failure, explain, find_equilibrium

SMALLEST_SHARE = 1e-3


def follow_motion(
    problem: ContactProblem,
    time_s: Array,
    depth: Array,
    largest_step: float,
    check: Callable[[float, Array], str | None] | None = None,
) -> ForcePath:
    """Follow a motion, piecewise linear in time, from the undeformed state; forces at the times that were reached."""
    began = clock.perf_counter()
    law = problem.solid.law if isinstance(problem.solid.law, Viscoelastic) else None
    u, p = problem.start()
    now, here, steps, iterations, stop = float(time_s[0]), 0.0, 0, 0, None
    direction = problem.direction()
    earlier: tuple[Array, Array] | None = None
    moved, points = 0.0, [(0.0, 0.0, 1.0)]
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
                stop = f"{why}; at {to_time:.4g} s"
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
        points.append((here, problem.force(state), float(state.J.min())))
        tell_depth(here)
    reached, force, smallest_J = np.array(points).T
    seconds = clock.perf_counter() - began
    return ForcePath(reached, force, smallest_J, problem.pattern.n, steps, iterations, seconds, stop)


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


# Fillets that are tried in turn; a small one folds the corner too early on a pad that is thick and pressed deep.
SLAB_RIMS = (0.025, 0.05, 0.1, 0.2)
SLAB_LARGEST_STEP = 0.02
TOLERANCE = 5e-4
HOLD_GROWTH = 0.3
# Cells under the punch of a shaped pad.
CELLS = 12


def ratio_error(rim: float) -> float:
    """Share of the viscous part of the force by which the ratio may be off with a fillet of this size.

    Half the fillet of 0.05 moves it by 0.01 to 0.02, half that of 0.025 by less than 0.01 (four presses of 5 to
    15 mm pads to d/h 0.2 to 0.4); half the time steps by 0.005.
    """
    return 0.02 * rim / SLAB_RIMS[0]


@dataclass(frozen=True)
class RatioPath:
    """Forces with one mesh at the times of a motion that were solved; unit mu h^2.

    ``elastic`` is that of the relaxed material, ``separable`` its convolution, ``force`` the finite-strain
    one; ``ratio`` is force over separable.
    """

    time_s: Array
    depth: Array
    elastic: Array
    separable: Array
    force: Array
    solver: dict[str, Any]

    @property
    def ratio(self) -> Array:
        """Force over separable force; 1 where there is next to no force."""
        tiny = np.abs(self.separable) <= 1e-6 * np.abs(self.separable).max()
        return np.where(tiny, 1.0, self.force / np.where(tiny, 1.0, self.separable))


def solve_ratio(
    case: Case,
    prony: Sequence[PronyTerm],
    time_s: Array,
    depth: Array,
    *,
    rims: Sequence[float] = SLAB_RIMS,
    cells: int = CELLS,
) -> RatioPath:
    """Solve one motion of a round pad twice on one mesh, with and without relaxation.

    ``rims`` are the fillets that are tried on a slab, ``cells`` those under the punch of a shaped pad.
    """
    arms = tuple(prony)
    inputs = {"case": case, "prony": arms, "time": time_s, "depth": depth, "rims": rims, "cells": cells}

    def solve() -> RatioPath:
        if case.shape != SLAB:
            return _of_shape(case, arms, time_s, depth, cells)
        return _ratio_path(
            lambda own, rim: rimmed_problem(own, rim * case.scale, Resolution()),
            case,
            arms,
            time_s,
            depth,
            rims,
            0.05 * case.scale,
            False,
        )

    return RatioPath(**cached("viscoelastic-ratio", inputs, lambda: vars(solve())))


def _of_shape(case: Case, prony: tuple[PronyTerm, ...], time_s: Array, depth: Array, cells: int) -> RatioPath:
    flat = case.shape.flat_top
    # No finer cells at the edge: what they leave out cancels in the ratio.
    step = (FLAT_STEP if flat else LARGEST_STEP) * 16.0 / cells

    def follow(twin: bool, rims: Sequence[float]) -> RatioPath:
        problem = partial(shaped_problem, cells=cells, twin=twin, refinement=1.0)
        return _ratio_path(problem, case, prony, time_s, depth, rims, step, not (twin or flat))

    path = follow(False, (case.edge / case.scale,) if case.edge else RIMS[::-1])
    if not flat:
        return path
    # The edge of a flat top: what cells this large leave out of a slab's departure is left out of this pad's.
    twin = follow(True, (path.solver["rim_over_scale"],))
    fine = solve_ratio(replace(case, shape=SLAB, edge=0.0, thickness_mm=1.0), prony, time_s, depth)
    ratio = path.ratio + fine.ratio - twin.ratio
    solver = path.solver | add_costs(path.solver, twin.solver, fine.solver) | {"unknowns": path.solver["unknowns"]}
    return replace(path, force=ratio * path.separable, solver=solver)


def _ratio_path(
    problem: Callable[..., ContactProblem],
    case: Case,
    prony: tuple[PronyTerm, ...],
    time_s: Array,
    depth: Array,
    rims: Sequence[float],
    largest_step: float,
    folds: bool,
) -> RatioPath:
    """Follow one motion with and without relaxation on the mesh of any pad, with the first fillet that gets there."""
    for rim in rims:
        paths, why = [], None
        for arms in ((), prony):
            made = problem(replace(case, law=Viscoelastic(case.law, arms)), rim=rim)
            watch = FoldWatch(RoundFace(made, case.thickness_mm)) if folds else None
            path = follow_motion(made, time_s, depth, largest_step, watch.check if watch else None)
            paths.append(path)
            why = watch.stop_reason(path.stop) if watch else path.stop
            if why:
                break
        if why is None or (watch is not None and watch.folded):
            break
    if why:
        raise unsolved(why, "the motion of the viscoelastic pad")
    elastic, relaxing = paths
    solver = {"rim_over_scale": rim, **cost(paths)}
    return RatioPath(time_s, depth, elastic.force, relaxed_force(time_s, elastic.force, prony), relaxing.force, solver)


def nodes_of_motion(time_s: Array, depth: Array, prony: Sequence[PronyTerm], fineness: int = 1) -> tuple[Array, Array]:
    """Choose times of a motion to solve at: fine where it moves, growing in a hold.

    A step spans at most 0.02 thicknesses or a 16th of the largest depth, follows the motion within 5e-4
    thicknesses, and in a hold grows to 0.3 of the time since the motion ended; ``fineness`` divides all of
    these. The undeformed state stands where the punch is still less than 5e-4 thicknesses deep.
    """
    depth = np.maximum(depth, 0.0)
    tolerance, largest = TOLERANCE / fineness, min(SLAB_LARGEST_STEP, depth.max() / 16.0) / fineness
    first = int(np.argmax(depth > TOLERANCE))
    fastest = min((term.tau_s for term in prony), default=1.0)
    if first == 0:
        time_s, depth = np.r_[time_s[0] - 1e-6 * fastest, time_s], np.r_[0.0, depth]
        first = 1
    start = first - 1
    depth = np.where(np.arange(len(depth)) == start, 0.0, depth)
    keep, moved_at = [start], time_s[start]
    while keep[-1] < len(time_s) - 1:
        at, end = keep[-1], keep[-1] + 1
        longest = max(0.25 / fineness * fastest, HOLD_GROWTH / fineness * (time_s[at] - moved_at))
        while end < len(time_s) - 1:
            trial = end + 1
            between = slice(at + 1, trial)
            chord = np.interp(time_s[between], time_s[[at, trial]], depth[[at, trial]])
            moving = abs(depth[trial] - depth[at]) > tolerance
            if np.abs(depth[between] - chord).max() > tolerance or abs(depth[trial] - depth[at]) > largest:
                break
            if not moving and time_s[trial] - time_s[at] > longest:
                break
            end = trial
        if abs(depth[end] - depth[at]) > tolerance:
            moved_at = time_s[end]
        keep.append(end)
    return time_s[keep], depth[keep]
