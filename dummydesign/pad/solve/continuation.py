"""Follow the equilibrium of a pad while a punch goes down: Newton's method with adaptive load steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dummydesign.core.threads import one_blas_thread
from dummydesign.pad.contact.surface_axisymmetric import Punch, Surface
from dummydesign.pad.fem.mixed_solid import Solid, State
from dummydesign.pad.solve.solver_superlu import Pattern

Array = np.ndarray

RESIDUAL_TOLERANCE = 1e-6
MAX_ITERATIONS = 14
SMALLEST_J = 0.02


@dataclass(frozen=True)
class Path:
    """Forces at the depths that were reached, and what the solve cost.

    ``stop`` is None when every depth was reached, else the reason in words.
    """

    depth: Array
    force: Array
    smallest_J: Array
    unknowns: int
    load_steps: int
    newton_iterations: int
    seconds: float
    stop: str | None
    residuals: tuple[tuple[float, ...], ...] = ()


NOTHING: dict[str, float] = {"unknowns": 0, "load_steps": 0, "newton_iterations": 0, "seconds": 0.0}


def cost(paths: Sequence[Path]) -> dict[str, float]:
    """What several paths cost together: their largest number of unknowns, and sums of the rest."""
    return {
        "unknowns": max(path.unknowns for path in paths),
        "load_steps": sum(path.load_steps for path in paths),
        "newton_iterations": sum(path.newton_iterations for path in paths),
        "seconds": sum(path.seconds for path in paths),
    }


class Problem:
    """A solid, the unknowns that move with the punch or are held, and the surface in contact.

    Parameters
    ----------
    solid : Solid
    held : ndarray of bool
        Unknowns kept at zero.
    driven : ndarray of int
        Unknowns that move with the punch, by -depth.
    base : ndarray of int
        Held unknowns over which the reaction is summed: the force that the pad carries.
    surface, punch : Surface and Punch, optional
    carried : ndarray of int, optional
        Free unknowns that lie on the punch's face at first touch; they go down with it at first.
    solver : callable, optional
        Makes the linear solver from (connectivities, free unknowns, number of unknowns); a sparse
        factorisation by default.
    """

    def __init__(
        self,
        solid: Solid,
        held: Array,
        driven: Array,
        base: Array,
        surface: Surface | None = None,
        punch: Punch | None = None,
        carried: Array | None = None,
        solver: Callable[[list[Array], Array, int], Any] = Pattern,
    ) -> None:
        self.solid, self.driven, self.base, self.surface, self.punch = solid, driven, base, surface, punch
        self.carried = driven if carried is None else np.union1d(driven, carried)
        fixed = held.copy()
        fixed[driven] = True
        used = np.zeros(solid.mesh.size, dtype=bool)
        used[solid.mesh.dofs] = True
        groups = [solid.mesh.dofs] + ([surface.dofs] if surface else [])
        self.pattern = solver(groups, np.nonzero(used & ~fixed)[0], solid.mesh.size)

    def contact(self, u: Array, depth: float) -> tuple[Array, list[Array]]:
        """Force and matrices of the surface; zero without one."""
        if self.surface is None:
            return np.zeros(len(u)), []
        force, matrix = self.surface.forces(u, self.punch, depth)
        return force, [matrix]

    def force(self, state: State) -> float:
        """Force that the pad carries, from the reaction of its base."""
        return float(state.internal_force[self.base].sum())

    def start(self) -> tuple[Array, Array]:
        """Undeformed displacement and pressure."""
        pressures = self.solid.mesh.pressure_basis.shape[1]
        return np.zeros(self.solid.mesh.size), np.zeros((len(self.solid.mesh.weight), pressures))

    def direction(self) -> tuple[Array, Array]:
        """Small-strain solution for a unit depth of the punch, from the undeformed state."""
        u, p = self.start()
        state = self.solid.state(u, p)
        _, matrices = self.contact(u, 0.0)
        lift = np.zeros(len(u))
        lift[self.carried] = -1.0
        pull = (state.stiffness @ lift[self.solid.mesh.dofs][:, :, None])[:, :, 0]
        load = -np.bincount(self.solid.mesh.dofs.ravel(), pull.ravel(), minlength=len(u))
        du = lift + self.pattern.solve([state.stiffness, *matrices], load)
        return du, self.solid.pressure_step(state, du)

    @one_blas_thread()
    def stiffness(self) -> float:
        """Force per depth at first touch (the small-strain limit)."""
        u, p = self.start()
        du, _ = self.direction()
        state = self.solid.state(u, p)
        pull = (state.stiffness @ du[self.solid.mesh.dofs][:, :, None])[:, :, 0]
        total = np.bincount(self.solid.mesh.dofs.ravel(), pull.ravel(), minlength=len(u))
        return float(total[self.base].sum())


@dataclass
class _Solution:
    u: Array
    p: Array
    state: State
    residuals: tuple[float, ...]


@dataclass
class _Failure:
    reason: str
    iterations: int


def _equilibrium(problem: Problem, u: Array, p: Array, depth: float) -> _Solution | _Failure:
    """Newton's method at one depth, from a predicted state."""
    solid, free = problem.solid, problem.pattern.free
    u = u.copy()
    u[problem.driven] = -depth
    state = solid.state(u, p)
    if state is None:
        return _Failure("the predicted state turns an element inside out", 0)
    residuals: list[float] = []
    for _ in range(MAX_ITERATIONS):
        contact, matrices = problem.contact(u, depth)
        load = state.force_of_pressure - state.internal_force - contact
        du = problem.pattern.solve([state.stiffness, *matrices], load)
        dp = solid.pressure_step(state, du)
        fraction = 1.0
        while True:
            trial = solid.state(u + fraction * du, p + fraction * dp)
            if trial is not None and trial.J.min() > SMALLEST_J:
                break
            fraction *= 0.5
            if fraction < 0.05:
                return _Failure("an element would turn inside out", len(residuals) + 1)
        u, p, state = u + fraction * du, p + fraction * dp, trial
        contact, _ = problem.contact(u, depth)
        scale = np.linalg.norm(state.internal_force) + 1e-300
        residuals.append(float(np.linalg.norm((state.internal_force + contact)[free]) / scale))
        if not np.isfinite(residuals[-1]):
            return _Failure("the residual is no longer a number", len(residuals))
        if residuals[-1] < RESIDUAL_TOLERANCE and fraction == 1.0:
            return _Solution(u, p, state, tuple(residuals))
    reason = f"no equilibrium after {MAX_ITERATIONS} iterations (relative residual {residuals[-1]:.1e})"
    return _Failure(reason, MAX_ITERATIONS)


@one_blas_thread()
def follow(
    problem: Problem,
    depths: Sequence[float] | Array,
    first_step: float,
    largest_step: float,
    smallest_step: float,
    progress: Callable[[float], None] | None = None,
    sound_J: float = 0.0,
) -> Path:
    """Follow the equilibrium from first touch through ``depths`` (increasing, in the mesh's unit of length).

    Every depth is met exactly. A step that fails is halved and tried again from the last good state;
    below ``smallest_step`` the path ends there and says why. It also ends after a wanted depth at which
    the smallest volume ratio is below ``sound_J``.
    """
    began = time.perf_counter()
    targets = np.asarray(depths, dtype=float)
    u, p = problem.start()
    direction = problem.direction()
    earlier: tuple[Array, Array, float] | None = None
    depth, step, iterations, steps, stop = 0.0, min(first_step, largest_step), 0, 0, None
    found: list[tuple[float, float, float]] = []
    history: list[tuple[float, ...]] = []
    while len(found) < len(targets):
        goal = targets[len(found)]
        remaining = goal - depth
        # Do not leave a sliver before the next wanted depth.
        trial_depth = goal if remaining <= step * 1.25 else depth + min(step, remaining / 2.0)
        if earlier is None:
            guess = u + (trial_depth - depth) * direction[0], p + (trial_depth - depth) * direction[1]
        else:
            # After a very small step its direction is mostly rounding: do not stretch it far.
            ratio = min((trial_depth - depth) / (depth - earlier[2]), 5.0)
            guess = u + ratio * (u - earlier[0]), p + ratio * (p - earlier[1])
        answer = _equilibrium(problem, *guess, trial_depth)
        if isinstance(answer, _Failure):
            iterations += answer.iterations
            step = 0.5 * (trial_depth - depth)
            if step < smallest_step:
                stop = _explain(problem, u, p, depth, answer.reason)
                break
            continue
        earlier, u, p, depth = (u, p, depth), answer.u, answer.p, trial_depth
        iterations += len(answer.residuals)
        if problem.surface is not None:
            problem.surface.settle(u, problem.punch, depth)
        steps += 1
        history.append(answer.residuals)
        if len(answer.residuals) <= 5:
            step = min(1.4 * step, largest_step)
        if depth == goal:
            found.append((depth, problem.force(answer.state), float(answer.state.J.min())))
            if progress:
                progress(depth)
            if found[-1][2] < sound_J:
                stop = _explain(problem, u, p, depth, f"a volume ratio fell below {sound_J:g}")
                break
    table = np.array(found).reshape(-1, 3)
    return Path(
        table[:, 0], table[:, 1], table[:, 2], problem.pattern.n, steps, iterations,
        time.perf_counter() - began, stop, tuple(history),
    )


def _explain(problem: Problem, u: Array, p: Array, depth: float, reason: str) -> str:
    """Say where a path ended, with the worst element, for the user who has to act on it."""
    state = problem.solid.state(u, p, tangent=False)
    element, _ = np.unravel_index(np.argmin(state.J), state.J.shape)
    nodes = problem.solid.mesh.dofs[element] // problem.solid.mesh.nodes.shape[0]
    place = ", ".join(f"{x:.3g}" for x in problem.solid.mesh.nodes[:, nodes].mean(axis=1))
    return (
        f"stopped at relative depth {depth:.3f}: {reason}; worst element {element} at ({place}) thicknesses, "
        f"smallest volume ratio {state.J.min():.2g}"
    )
