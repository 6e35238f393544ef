"""Equilibrium of a pad at one depth of the punch, by Newton's method from a predicted state."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.pad.contact.axisymmetric import Array, ContactSurface, RigidPunch
from dummydesign.pad.fem.mixed_solid import Solid, SolidState, Tangent
from dummydesign.pad.solve.sparse import Pattern

RESIDUAL_TOLERANCE = 1e-6
MAX_ITERATIONS = 14
EXHAUSTED = "no equilibrium after"
SMALLEST_J = 0.02
# Points that came to touch are tied once the relative residual is below this, so many times at most; the force does
# not change by more than 0.05 % when it is 1e-3.
TIE_TOLERANCE = 5e-2
LARGEST_TIES = 4
TIED = "contact was tied"
# Once the relative residual is below this, a factorised tangent is used again for as long as every use brings the
# residual below a share of the one before, which the solver knows.
REUSE_BELOW = 2e-2
# After so many tangents contact is taken to flicker, and every step gets its own.
REUSE_UP_TO = 7
# A step that leaves more out of balance than before, and a relative residual above the first, is shortened to no less
# than the second: small residuals may grow when a point comes to touch, and shortening for it leads nowhere.
SHORTEN_ABOVE = 0.2
SHORTEST = 0.25
# Where contact changes, the solid's tangent is kept for so many factorisations.
HELD = 3
# Contact changes within a step of the linearised solid until this share of the forces is out of balance.
SETTLED = 1e-2
# Least share of a step taken where a whole one would invert an element.
LEAST_FRACTION = 0.05


class ContactProblem:
    """A solid, the unknowns that move with the punch or are held, and the surface in contact."""

    def __init__(
        self,
        solid: Solid,
        held: Array,
        driven: Array,
        base: Array,
        surface: ContactSurface | None = None,
        punch: RigidPunch | None = None,
        carried: Array | None = None,
        solver: Callable[[list[Array], Array, int], Any] | None = None,
    ) -> None:
        self.solid, self.driven, self.base, self.surface, self.punch = solid, driven, base, surface, punch
        self.carried = driven if carried is None else np.union1d(driven, carried)
        fixed = held.copy()
        fixed[driven] = True
        used = np.zeros(solid.mesh.size, dtype=bool)
        used[solid.mesh.dofs] = True
        groups = [solid.mesh.dofs] + ([surface.dofs] if surface else [])
        free, size = np.nonzero(used & ~fixed)[0], solid.mesh.size
        self._touch: tuple[Array, Array, float] | None = None
        self.pattern: Any = solver(groups, free, size) if solver else Pattern(groups, free, size, solid.mesh.nodes)

    def pressed(self, u: Array, depth: float) -> tuple[Array, Callable[[], list[Array]]]:
        """Force of the surface, and what gives its matrices."""
        if self.surface is None:
            return np.zeros(len(u)), list
        force, matrix = self.surface.pressed(u, self.punch, depth)
        return force, lambda: [matrix()]

    def force(self, state: SolidState) -> float:
        """Force that the pad carries, from the reaction of its base."""
        return float(state.internal_force[self.base].sum())

    def start(self) -> tuple[Array, Array]:
        """Undeformed displacement and pressure."""
        pressures = self.solid.mesh.pressure_basis.shape[1]
        return np.zeros(self.solid.mesh.size), np.zeros((len(self.solid.mesh.weight), pressures))

    def direction(self) -> tuple[Array, Array]:
        """Small-strain solution for a unit depth of the punch, from the undeformed state."""
        return self._first_touch()[:2]

    @one_blas_thread()
    def stiffness(self) -> float:
        """Force per depth at first touch (the small-strain limit)."""
        return self._first_touch()[2]

    def _first_touch(self) -> tuple[Array, Array, float]:
        """Displacement and pressure for a unit depth of the punch, and their force; without contact solved once."""
        if self._touch is not None:
            return self._touch
        mesh, (u, p) = self.solid.mesh, self.start()
        state = self.solid.state(u, p)
        assert state is not None
        tangent = self.solid.linearise(state)
        matrices = self.pressed(u, 0.0)[1]()

        def pull(of: Array) -> Array:
            local = (tangent.stiffness @ of[mesh.dofs][:, :, None])[:, :, 0]
            return np.bincount(mesh.dofs.ravel(), local.ravel(), minlength=len(u))

        lift = np.zeros(len(u))
        lift[self.carried] = -1.0
        du = lift + self.pattern.solve([tangent.stiffness, *matrices], -pull(lift))
        touch = du, self.solid.pressure_step(tangent, state, du), float(pull(du)[self.base].sum())
        if self.surface is None:
            self._touch = touch
        return touch


@dataclass
class Equilibrium:
    """A state in equilibrium, the relative residuals on the way to it, ties of contact, and factorised tangents."""

    u: Array
    p: Array
    state: SolidState
    residuals: tuple[float, ...]
    ties: int
    iterations: int


@dataclass
class Failure:
    """Why no equilibrium was found, and what the search cost."""

    reason: str
    iterations: int


def find_equilibrium(
    problem: ContactProblem,
    u: Array,
    p: Array,
    depth: float,
    tolerance: float = RESIDUAL_TOLERANCE,
    without_ties: bool = False,
) -> Equilibrium | Failure:
    """Newton's method at one depth, from a predicted state."""
    found = newton_search(problem, u, p, depth, tolerance, without_ties, HELD)
    if isinstance(found, Failure) and found.reason.startswith(EXHAUSTED):
        # Near the end of what can be solved a tangent that is kept wanders: the exact one is tried before giving up.
        other = newton_search(problem, u, p, depth, tolerance, without_ties, 1)
        return replace(other, iterations=other.iterations + found.iterations)
    return found


def newton_search(
    problem: ContactProblem, u: Array, p: Array, depth: float, tolerance: float, without_ties: bool, most_held: int
) -> Equilibrium | Failure:
    """One search, the solid's tangent kept for up to ``most_held`` factorisations."""
    solid, surface = problem.solid, problem.surface
    u = u.copy()
    u[problem.driven] = -depth
    state = solid.state(u, p)
    if state is None:
        return Failure("the predicted state inverts an element", 0)
    if surface is not None:
        surface.begin()
    at = _met(problem, depth, 1.0, u, p, state)
    residuals: list[float] = []
    ties = factorised = changed = 0
    contraction, least = problem.pattern.contraction
    tangent: Tangent | None = None
    again = False
    while factorised < MAX_ITERATIONS or again:
        if tangent is None:
            tangent, held = solid.linearise(at.state), 0
        load = solid.force_of_pressure(tangent, at.state) - at.state.internal_force - at.contact
        if again:
            du = problem.pattern.again(load)
        else:
            du, changes = _touching(problem, tangent, at, load, depth)
            factorised, changed, held = factorised + 1, changed + changes, held + 1
        dp = solid.pressure_step(tangent, at.state, du)
        trial = _sound(problem, at, du, dp, depth)
        if trial is None:
            if again or held > 1:
                tangent, again = None, False
                continue
            return Failure("an element would invert", factorised + changed)
        if again and not trial.residual < max(least * at.residual, tolerance):
            # A used tangent that leads away is given up together with its step.
            tangent, again = None, False
            continue
        if trial.residual > SHORTEN_ABOVE and trial.unbalanced > at.unbalanced:
            trial = _shortened(problem, at, du, dp, depth, trial)
        last, at = at.residual, trial
        residuals.append(at.residual)
        if not np.isfinite(at.residual):
            return Failure("the residual is no longer a number", factorised + changed)
        if at.residual < TIE_TOLERANCE and ties < LARGEST_TIES and surface is not None:
            if surface.tie(at.u, problem.punch, depth):
                if without_ties:
                    return Failure(TIED, factorised + changed)
                ties, at = ties + 1, _met(problem, depth, at.fraction, at.u, at.p, at.state)
                again = False
                if held >= most_held:
                    tangent = None
                continue
        if at.residual < tolerance and at.fraction == 1.0:
            return Equilibrium(at.u, at.p, at.state, tuple(residuals), ties, factorised + changed)
        good = at.residual < (contraction * last if again else REUSE_BELOW)
        again = at.fraction == 1.0 and good and factorised <= REUSE_UP_TO
        if not again and (held >= most_held or at.residual < REUSE_BELOW):
            tangent = None
    reason = f"{EXHAUSTED} {MAX_ITERATIONS} iterations (relative residual {residuals[-1]:.1e})"
    return Failure(reason, factorised + changed)


class _Trial(NamedTuple):
    """A state on the way to equilibrium: the share of the step that led there, its contact, its relative residual."""

    fraction: float
    u: Array
    p: Array
    state: SolidState
    contact: Array
    matrices: Callable[[], list[Array]]
    residual: float
    unbalanced: float


def _touching(problem: ContactProblem, tangent: Tangent, at: _Trial, load: Array, depth: float) -> tuple[Array, int]:
    """Step of the linearised solid that meets the contact as it is after the step, and how often that changed.

    Each change of contact takes a factorisation of what lies behind the first place that changed, but no state.
    """
    force, matrices, size = at.contact, at.matrices(), _size(at.state.internal_force)
    step = problem.pattern.solve([tangent.stiffness, *matrices], load)
    surface, du, changes, before = problem.surface, step, 0, math.inf
    while surface is not None and changes < surface.changes:
        new, changed = problem.pressed(at.u + du, depth)
        own = (matrices[0] @ step[surface.dofs][:, :, None]).ravel()
        # What the linear contact of the last solve leaves out of balance.
        rest = force - new + np.bincount(surface.dofs.ravel(), own, minlength=len(du))
        left = _size(rest[problem.pattern.free])
        if not SETTLED * size < left < before:
            break
        force, matrices, before = new, changed(), left
        step = problem.pattern.solve([tangent.stiffness, *matrices], rest)
        du, changes = du + step, changes + 1
    return du, changes


def _met(problem: ContactProblem, depth: float, fraction: float, u: Array, p: Array, state: SolidState) -> _Trial:
    """Displacements and pressures with the contact as it is now."""
    contact, matrices = problem.pressed(u, depth)
    unbalanced = _size((state.internal_force + contact)[problem.pattern.free])
    residual = unbalanced / (_size(state.internal_force) + 1e-300)
    return _Trial(fraction, u, p, state, contact, matrices, residual, unbalanced)


def _size(forces: Array) -> float:
    """Euclidean norm, at a third of the overhead of the library's."""
    return math.sqrt(float(forces @ forces))


def _tried(problem: ContactProblem, at: _Trial, du: Array, dp: Array, depth: float, fraction: float) -> _Trial | None:
    """The state after a share of a step; None when it inverts an element."""
    u, p = at.u + fraction * du, at.p + fraction * dp
    state = problem.solid.state(u, p)
    if state is None or not state.J.min() > SMALLEST_J:
        return None
    return _met(problem, depth, fraction, u, p, state)


def _sound(problem: ContactProblem, at: _Trial, du: Array, dp: Array, depth: float) -> _Trial | None:
    """The largest of 1, 1/2, ... of a step that inverts no element; None below a twentieth."""
    fraction = 1.0
    while fraction >= LEAST_FRACTION:
        trial = _tried(problem, at, du, dp, depth, fraction)
        if trial is not None:
            return trial
        fraction *= 0.5
    return None


def _shortened(problem: ContactProblem, at: _Trial, du: Array, dp: Array, depth: float, trial: _Trial) -> _Trial:
    """Halves of a step while the residual falls.

    A whole step from where the punch is met leaves places that should touch, and presses others: points change sides
    from step to step without end.
    """
    while trial.fraction > SHORTEST:
        shorter = _tried(problem, at, du, dp, depth, 0.5 * trial.fraction)
        if shorter is None or not shorter.unbalanced < trial.unbalanced:
            break
        trial = shorter
    return trial


def explain(problem: ContactProblem, u: Array, p: Array, depth: float, reason: str) -> str:
    """Say where a path ended, with the worst element, for the user who has to act on it."""
    state = problem.solid.state(u, p)
    assert state is not None
    element, _ = np.unravel_index(np.argmin(state.J), state.J.shape)
    nodes = problem.solid.mesh.dofs[element] // problem.solid.mesh.nodes.shape[0]
    point = ", ".join(f"{x:.3g}" for x in problem.solid.mesh.nodes[:, nodes].mean(axis=1))
    return (
        f"solution stopped at relative depth {depth:.3f}: {reason}; worst element {element} at ({point}) thicknesses, "
        f"smallest volume ratio {state.J.min():.2g}"
    )
