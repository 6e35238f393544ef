"""Motion of a robot that meets people: a mass on a spring, a free mass, and a force that is followed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.motion import work_to_deepest_mJ
from dummydesign.person.people import People
from dummydesign.person.smoothing import GAP_S, RobotArm, interpolation

# ISO/TS 15066: contact below 0.5 s is transient, what lasts longer quasi-static (second-hand, docs/references.md).
QUASI_STATIC_AFTER_S = 0.5
TOLERANCE = 2e-5
"""Error of a step, over the depth."""
SOLVED_MM = 1e-7
LEAST_DEPTH = 1e-3
MOST_STEPS = 400_000
RINGS = 100.0
"""Periods of the robot's own ringing after the stop that are followed; then it is damped."""
IN_PHASE, STABLE, DAMPED = (0.5, 1.0 / 12.0), (0.5, 0.25), (0.7, 0.36)
"""Newmark's gamma and beta: Fox and Goodwin's, whose period is right to the fourth order; the trapezoidal rule, for
steps that are long beside the period; and what damps."""
SHORT, STIFFENING = 1.5, 5.0
"""Square of step times frequency below which the first is used, and a person's stiffness over force / depth."""
SUBSTEPS, SOLVED, LEAST_N = 2, 1e-9, 1e-3
"""Steps between two times, error of the force over itself, and the least force that it is measured by. [N]"""


FOUR = ("peak_N", "steady_N", "depth_mm", "energy_mJ")
"""What is reported of a press."""
LATE_POINTS = 25


@dataclass(frozen=True, eq=False)
class PersonResponse:
    """What persons bear: curves of shape (p, n) over ``time_s`` (n,) or (p, n), and numbers, shape (p,).

    ``energy_mJ`` is the work done on the person from contact to the largest depth;
    ``held_N`` is the largest force later than 0.5 s after contact; ``stop_s`` is when a free mass stopped.
    """

    time_s: NDArray
    depth_curve_mm: NDArray
    force_curve_N: NDArray
    peak_N: NDArray
    steady_N: NDArray
    depth_mm: NDArray
    energy_mJ: NDArray
    held_N: NDArray
    stop_s: NDArray | float = np.inf

    @classmethod
    def of_curves(
        cls, time_s: NDArray, depth: NDArray, force: NDArray, steady: NDArray, energy: NDArray | None = None
    ) -> PersonResponse:
        """Take peak, depth, held force and the energy, unless it is given, from curves (p, n)."""
        held = held_after(time_s, force)
        energy = work_to_deepest_mJ(np.maximum(depth, 0.0), force) if energy is None else energy
        return cls(time_s, depth, force, force.max(axis=-1), steady, depth.max(axis=-1), energy, held)

    def four(self) -> dict[str, NDArray]:
        """The four numbers by name."""
        return {name: getattr(self, name) for name in FOUR}


class PressedBody(Protocol):
    """What :func:`run_robot` presses: persons, or a pad; p of them at once, each with ``arms`` inner states.

    The methods are those of :class:`~dummydesign.person.people.People`.
    """

    def __len__(self) -> int: ...

    def at_rest(self) -> NDArray:
        """Inner states before contact, shape (p, arms)."""

    def carried(self, depth: NDArray, stretch: NDArray, new: NDArray, step: float) -> tuple[NDArray, NDArray]:
        """Inner states after a step at even speed, and their slopes over the new depth, both (p, arms)."""

    def force_of(self, depth: NDArray, stretch: NDArray) -> NDArray:
        """Force at depths (p,), not below 0. [N]"""

    def slope_of(self, depth: NDArray, stretch: NDArray, gain: NDArray) -> NDArray:
        """Slope of the force over depth within a step, shape (p,). [N/mm]"""

    def depth_taking(self, energy_mJ: float) -> NDArray:
        """Depth at which an energy is taken if nothing relaxes, shape (p,). [mm]"""


Input = Callable[[float], tuple[NDArray | float, NDArray | float]]
"""Force [N] and path [mm] of the pad at a time."""


def held_after(time_s: NDArray, force_N: NDArray) -> NDArray:
    """Largest force later than 0.5 s after contact, shape (p,); NaN where it is not followed that long. [N]"""
    late = np.where(np.broadcast_to(time_s >= QUASI_STATIC_AFTER_S, force_N.shape), force_N, -np.inf).max(axis=-1)
    return np.where(np.isfinite(late), late, np.nan)


def late_mean(time_s: NDArray, force: NDArray, from_s: float) -> NDArray:
    """Mean force over common times (n,) from one on, shape (p,); NaN where the press ends before. [N]"""
    if from_s >= time_s[-1]:
        return np.full(len(force), np.nan)
    return force @ interpolation(np.linspace(from_s, float(time_s[-1]), LATE_POINTS), time_s).mean(axis=0)


def follow_force(
    people: People,
    time_s: NDArray,
    force_N: NDArray,
    late_s: float = np.inf,
    substeps: int = SUBSTEPS,
    tolerance: float = SOLVED,
) -> PersonResponse:
    """Press so that each person bears a force that is given over time, F(x, q) = F(t).

    Each step solves for the depth at its end, by Newton's method inside a bracket; the arms are exact for the even
    speed of the step.

    Parameters
    ----------
    people : People
    time_s : ndarray, shape (n,)
    force_N : ndarray, shape (n,) or (p, n)
        Below 0 counts as 0.
    late_s : float
        From when on the mean of the force is taken. [s]
    substeps : int
        Steps between two times.
    tolerance : float
        Error of the force at each step, over the force.
    """
    wanted = np.maximum(np.broadcast_to(force_N, (len(people), len(time_s))), 0.0)
    x, q = np.zeros(len(people)), people.at_rest()
    energy, steps = np.zeros(len(people)), [x]
    deepest, taken = x, energy
    for at in range(1, len(time_s)):
        step = float(time_s[at] - time_s[at - 1]) / substeps
        for part in range(1, substeps + 1):
            share = part / substeps
            before = wanted[:, at - 1] + (share - 1.0 / substeps) * (wanted[:, at] - wanted[:, at - 1])
            goal = wanted[:, at - 1] + share * (wanted[:, at] - wanted[:, at - 1])
            new = _depth_for(people, x, q, step, goal, tolerance)
            q = people.carried(x, q, new, step)[0]
            energy = energy + 0.5 * (before + goal) * (new - x)
            x = new
            taken, deepest = np.where(x > deepest, energy, taken), np.maximum(x, deepest)
        steps.append(x)
    return PersonResponse.of_curves(time_s, np.stack(steps, axis=-1), wanted, late_mean(time_s, wanted, late_s), taken)


def _depth_for(people: People, x: NDArray, q: NDArray, step: float, goal: NDArray, tolerance: float) -> NDArray:
    """Depth at the end of a step whose force is the goal, shape (p,). [mm]"""
    low, high = np.zeros(len(people)), np.maximum(people.law.root(goal / people.gamma1), x) + 1e-9
    for _ in range(60):
        short = people.force_of(high, people.carried(x, q, high, step)[0]) < goal
        if not short.any():
            break
        high = np.where(short, 2.0 * high, high)
    new = np.clip(np.where(x > 0.0, x, high), low, high)
    for _ in range(80):
        stretch, gain = people.carried(x, q, new, step)
        lacking = goal - people.force_of(new, stretch)
        if np.all(np.abs(lacking) <= tolerance * np.maximum(goal, LEAST_N)):
            break
        low, high = np.where(lacking > 0.0, new, low), np.where(lacking > 0.0, high, new)
        guess = new + lacking / np.maximum(people.slope_of(new, stretch, gain), 1e-12)
        new = np.where((guess > low) & (guess < high), guess, 0.5 * (low + high))
        if np.all(high - low <= 1e-12):
            break
    return new


def run_robot(
    body: PressedBody,
    arm: RobotArm,
    given: Input,
    end_s: float,
    velocity_mm_s: NDArray,
    scale_mm: NDArray,
    longest_step: Callable[[float], float],
    until_stop: bool = False,
    keep: bool = True,
    late_s: float = np.inf,
    loose_after_s: float = np.inf,
    tolerance: float = TOLERANCE,
    mean_from_s: float = np.inf,
    lost_mm_s: NDArray | float = 0.0,
) -> PersonResponse:
    """Integrate M u'' = F_p(t) - D u' - K u - F(x_p(t) + u, q) of all bodies, by Newmark's rules.

    u is the difference of the path on a person to the path x_p on the pad, where the force was F_p. The command
    x_c that the trace implies, with M x_p'' = K (x_c - x_p) + D (x_c' - x_p') - F_p, acts on the person too, and the
    acceleration of the trace drops out of the equation. The rules keep the energy of springs and masses. The step
    keeps the difference to a third-order prediction, which bounds the rule's error, below 2e-5 of the depth.

    References
    ----------
    Fox and Goodwin, Proceedings of the Cambridge Philosophical Society 45 (1949) 373; Newmark, ASCE Journal of the
    Engineering Mechanics Division 85 (1959) 67.

    Parameters
    ----------
    body : PressedBody
    arm : Arm
        K, M and the damping of the robot alone, D; a stiffness of 0 and no input is a free mass.
    given : callable
        Force [N] and path [mm] on the pad at a time.
    end_s : float
        Until when.
    velocity_mm_s, scale_mm : ndarray, shape (p,)
        u' at time 0, and the size of depths.
    longest_step : callable
        Longest step at a time. [s]
    until_stop : bool
        End when every body has stopped; depth and energy are then those of the stop.
    keep : bool
        Keep the curves over time.
    late_s : float
        From when on the mean of the force is taken. [s]
    loose_after_s : float
        A hundred periods after this time the robot's own ringing is damped: forces and depths become means. [s]
    tolerance : float
        Error of a step, over the depth.
    mean_from_s : float
        From when on force and path on the pad are means over its ringing. The person goes on at the same depth and
        speed; what rang on the pad passes to the difference. [s]
    lost_mm_s : ndarray or float
        Speed of the path just before that time, less that after it.
    """
    mass, stiffness, damping, count = 1e-3 * arm.mass_kg, arm.stiffness_N_per_mm, arm.damping_N_s_per_mm, len(body)
    u, v, q = np.zeros(count), np.array(velocity_mm_s, float), body.at_rest()
    pushed, path = given(0.0)
    x = path + u
    force = body.force_of(x, q)
    a = (pushed - force) / mass
    times, depths, forces = [0.0], [x], [force]
    peak, deepest, work, energy = force.copy(), x.copy(), np.zeros(count), np.zeros(count)
    stop, longer, late = np.full(count, np.nan), np.full(count, np.nan), np.zeros(count)
    fastest = max(float(np.max(np.abs(v))), 1e-9)
    time, step = 0.0, min(1e-3 * float(np.min(scale_mm)) / fastest, longest_step(0.0))
    before: tuple[float, NDArray] | None = None
    for _ in range(MOST_STEPS):
        if time >= end_s * (1.0 - 1e-12) or not np.isnan(stop).any():
            break
        taken = min(step, longest_step(time), end_s - time)
        pushed, path = given(time + taken)
        jerk = np.zeros(count) if before is None else (a - before[1]) / before[0]
        predicted = u + taken * v + 0.5 * taken**2 * a + taken**3 / 6.0 * jerk
        loose = max(1.0, (time - loose_after_s) / (RINGS * arm.period_s)) ** 3
        stiff = stiffness + STIFFENING * float(np.max(force / np.maximum(x, LEAST_DEPTH * scale_mm)))
        ringing = stiffness > 0.0 and stiff * taken**2 < SHORT * mass
        new_share, far_share = IN_PHASE if ringing else STABLE
        new_share, far_share = (new_share, far_share) if loose == 1.0 else DAMPED
        constant = u + taken * v + (0.5 - far_share) * taken**2 * a
        weight = far_share * taken**2 / mass
        resisting = damping * new_share / (far_share * taken)
        known = weight * (pushed - damping * (v + taken * (1.0 - new_share) * a) + resisting * constant)
        new, new_q, new_force = _solve(
            body, x, q, taken, constant + known, weight, stiffness + resisting, path, predicted
        )
        error = float(np.max(np.abs(new - predicted) / scale_mm)) / (tolerance * loose)
        if before is not None and error > 2.0 and taken > 1e-9:
            step = taken * max(0.3, 0.85 * error ** (-1.0 / 3.0))
            continue
        drag = damping * (v + taken * (1.0 - new_share) * a) + resisting * (new - constant)
        new_a = (pushed - drag - stiffness * new - new_force) / mass
        new_v, new_x = v + taken * ((1.0 - new_share) * a + new_share * new_a), path + new
        going = np.isnan(stop)
        halted = going & until_stop & (new_v <= 0.0)
        share = np.where(halted, v / np.maximum(v - new_v, 1e-300), 1.0)
        reached = np.where(halted, x + 0.5 * share * taken * v, new_x)
        at_end = force + share * (new_force - force)
        way = np.maximum(reached, 0.0) - np.maximum(x, 0.0)
        work = work + np.where(going, 0.5 * (force + at_end) * way, 0.0)
        peak = np.where(going, np.maximum(peak, np.where(halted, at_end, new_force)), peak)
        energy = np.where(going & (reached > deepest), work, energy)
        deepest = np.where(going, np.maximum(deepest, reached), deepest)
        if time + taken >= QUASI_STATIC_AFTER_S:
            longer = np.where(going, np.fmax(longer, new_force), longer)
        stop = np.where(halted, time + share * taken, stop)
        late = late + 0.5 * max(time + taken - max(time, late_s), 0.0) * (force + new_force)
        before, time = (taken, a), time + taken
        u, v, a, q, x, force = new, new_v, new_a, new_q, new_x, new_force
        if time >= mean_from_s:
            time, mean_from_s, before = mean_from_s + GAP_S, np.inf, None
            pushed, path = given(time)
            u, v = x - path, v + lost_mm_s
            a = (pushed - damping * v - stiffness * u - force) / mass
        if keep:
            times.append(time)
            depths.append(x)
            forces.append(force)
        grown = taken * float(np.clip(0.85 * max(error, 1e-9) ** (-1.0 / 3.0), 0.3, 1.6))
        # a step that was cut to end at a node says nothing against the longer one
        step = max(grown, step) if error < 1.0 and taken < step else grown
    depth_curve, force_curve = (np.stack(rows, axis=-1) for rows in (depths, forces))
    steady = late / (time - late_s) if time > late_s else np.full(count, np.nan)
    return PersonResponse(np.array(times), depth_curve, force_curve, peak, steady, deepest, energy, longer, stop)


def _solve(
    body: PressedBody,
    x: NDArray,
    q: NDArray,
    step: float,
    constant: NDArray,
    weight: float,
    stiffness: float,
    path: NDArray | float,
    guess: NDArray,
) -> tuple[NDArray, NDArray, NDArray]:
    """Solve u = constant - weight (K u + F(path + u)) for u, stretches and force at the end of a step (Newton)."""
    new = guess
    for _ in range(25):
        stretch, gain = body.carried(x, q, path + new, step)
        force, slope = body.force_of(path + new, stretch), body.slope_of(path + new, stretch, gain)
        left = new - constant + weight * (stiffness * new + force)
        change = left / (1.0 + weight * (stiffness + slope))
        new = new - change
        if float(np.max(np.abs(change))) <= SOLVED_MM:
            break
    # the last change is so small that force and stretch follow it on their tangents
    return new, stretch - gain * change[:, None], np.maximum(force - slope * change, 0.0)
