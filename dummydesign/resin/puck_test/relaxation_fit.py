"""Long-term modulus, relaxation, stiffening and plate friction of a puck from one press with holds.

The force is that of :mod:`dummydesign.resin.puck_test.loading_fit` with relaxation on top (quasi-linear law):

    F(t) = E integral of (1 + sum_i beta_i exp(-(t - s) / tau_i)) d[A u(c; alpha) B(c; alpha, friction)],

driven by the measured motion. Given alpha, contact offset and times the force is linear in E and E beta_i, from
which the starts are found. The number of arms, 0 to 3, is the smallest whose AICc is within 6 of the lowest, all
under the noise of the richest. Friction is not specified: it is profiled from frictionless to bonded.

Intervals of times and strengths are those of the profile likelihood over friction, with the other parameters in
their Gaussian approximation. Modulus and friction have the cautious ones of ``loading_fit``: how the law misfits
along the compression is not known, so a puck counts as one independent number with that misfit and a scatter of 2 %
as its size. (By the likelihood, with a smooth misfit of known length, they held the truth in 0.7 of the draws of a
rougher one.) alpha has none: it takes up what the law misfits.

An arm slower than half of the longest hold is not given a value. What it has not relaxed at the end of the file
counts as stiffness; the interval of the modulus goes down to where it would have relaxed, those of the other
strengths, which are relative to the modulus, up accordingly.

References
----------
Fung, Biomechanics: Mechanical Properties of Living Tissues (1993), chapter 7 (quasi-linear law).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.inference.least_squares import CHI_SQUARE_95, aicc, simplest, solve_by_differences, within
from dummydesign.pad.tables.puck import PuckTable, friction_of, uniaxial
from dummydesign.resin.model.resin import Interval
from dummydesign.resin.puck_test import loading_fit as loading
from dummydesign.resin.puck_test.loading_fit import PuckNoise, PuckPress, whitener

Array = np.ndarray

STRENGTHS = (1e-4, 30.0)


@dataclass(frozen=True, eq=False)
class Trial:
    """Best parameters at one friction, with whitened residuals (bins,) and Jacobian (bins, parameters)."""

    grip: float
    parameters: Array
    chi_square: float
    residual: Array
    jacobian: Array


class PuckProblem:
    """One press: parameters ln E [kPa], alpha, offset over height, then ln beta of the arms, then ln tau [s]."""

    def __init__(self, press: PuckPress, diameter_mm: float, height_mm: float, table: PuckTable) -> None:
        self.press, self.height_mm, self.table = press, height_mm, table
        self.area = 0.25e-3 * np.pi * diameter_mm**2
        self.log_factor = cache(partial(_smooth_log_factor, table))
        self.step = np.diff(press.time_s)
        self.longest = max(hold.duration_s for hold in press.holds)
        shortest = float(np.min(press.end_s - press.start_s))
        self.times = (max(shortest, 1e-4 * self.longest), 10.0 * self.longest)
        self.factor = whitener(press, height_mm, PuckNoise(press.white_N, 1e-3 * press.force_N.max(), 1.0, 0.02))

    def elastic(self, alpha: float, grip: float, offset: float) -> Array:
        """Long-term force over E at the nodes, zeroed where the displacement is zero. [N/kPa]"""
        compression = np.r_[0.0, self.press.displacement_mm] / self.height_mm
        c = np.maximum(compression - offset, 0.0)
        load = self.area * uniaxial(alpha, c) * np.exp(self.log_factor(grip)(alpha, c))
        return load[1:] - load[0]

    def arm(self, elastic: Array, tau_s: float) -> Array:
        """Force of an arm of strength one at the nodes, exact for forces that are linear between them."""
        ratio = self.step / tau_s
        return np.r_[0.0, linear_recurrence(np.exp(-ratio), np.diff(elastic) * (-np.expm1(-ratio) / ratio))]

    def predict(self, q: Array, grip: float) -> Array:
        """Force of the bins. [N]"""
        arms = (len(q) - 3) // 2
        elastic = self.elastic(q[1], grip, q[2])
        total = elastic.copy()
        for beta, tau in zip(np.exp(q[3 : 3 + arms]), np.exp(q[3 + arms :])):
            total += beta * self.arm(elastic, tau)
        return np.exp(q[0]) * (self.press.average @ total)

    def residual(self, q: Array, grip: float) -> Array:
        """Logarithm of fitted over measured force of the bins."""
        return np.log(np.maximum(self.predict(q, grip), 1e-9) / self.press.force_N)

    def box(self, arms: int) -> tuple[Array, Array]:
        """Lowest and highest parameters."""
        weak, strong = np.log(STRENGTHS)
        short, long = np.log(self.times)
        low = [-20.0, loading.ALPHA_RANGE[0], -loading.LARGEST_OFFSET, *[weak] * arms, *[short] * arms]
        high = [20.0, loading.ALPHA_RANGE[1], loading.LARGEST_OFFSET, *[strong] * arms, *[long] * arms]
        return np.array(low), np.array(high)

    def starts(self, arms: int, grip: float, count: int = 2) -> list[Array]:
        """The best of all combinations of times on a grid, E and strengths by non-negative least squares."""
        from scipy.optimize import nnls

        starts = []
        grid = np.geomspace(3.0 * self.times[0], 0.6 * self.longest, 9)
        for alpha in (1.5, 3.0):
            elastic = self.elastic(alpha, grip, 0.0)
            forces = np.stack([elastic, *(self.arm(elastic, tau) for tau in grid)], axis=1)
            columns = self.factor @ ((self.press.average @ forces) / self.press.force_N[:, None])
            goal = self.factor @ np.ones(len(columns))
            for combo in itertools.combinations(range(len(grid)), arms):
                strength, rest = nnls(columns[:, [0, *(1 + k for k in combo)]], goal)
                if strength[0] > 0.0:
                    beta = np.clip(strength[1:] / strength[0], 1e-3, 10.0)
                    starts.append((rest, [np.log(strength[0]), alpha, 0.0, *np.log(beta), *np.log(grid[list(combo)])]))
        starts.sort(key=lambda pair: pair[0])
        return [np.array(q) for _, q in starts[:count]]

    def fit(self, starts: list[Array], grip: float) -> Trial:
        """Trust-region least squares of the whitened residuals; arms in the order of their times."""
        arms = (len(starts[0]) - 3) // 2
        best = solve_by_differences(
            lambda q: self.factor @ self.residual(q, grip), starts, *self.box(arms), tolerance=1e-7, most=60
        )
        assert best.residual is not None and best.jacobian is not None
        order = np.argsort(best.parameters[3 + arms :])
        columns = np.r_[0, 1, 2, 3 + order, 3 + arms + order]
        return Trial(grip, best.parameters[columns], best.chi_square, best.residual, best.jacobian[:, columns])

    def aicc(self, trial: Trial) -> float:
        """Corrected Akaike criterion under the whitening of now; friction and two sizes of noise are counted."""
        fit = trial.chi_square - 2.0 * float(np.log(np.diag(self.factor)).sum())
        return aicc(fit, len(trial.parameters) + 3, len(trial.residual))


def _smooth_log_factor(table: PuckTable, grip: float) -> Callable[[float, Array], Array]:
    """ln B of one friction: cubic in compression, a polynomial in alpha, for kinks would halt the search."""
    from scipy.interpolate import CubicSpline

    rows = np.stack([np.log(table.factor(alpha, grip, table.compression)) for alpha in table.alpha], axis=1)
    spline = CubicSpline(table.compression, rows)
    low, high = table.compression[[0, -1]]

    def value(alpha: float, c: Array) -> Array:
        at = table.alpha
        weights = [np.prod((alpha - np.delete(at, k)) / (at[k] - np.delete(at, k))) for k in range(len(at))]
        return spline(np.clip(c, low, high)) @ np.array(weights)

    return value


MOST_ARMS = 3
PUCK_SCATTER = 0.02
GRIPS = np.linspace(0.0, 1.0, 11)
COARSE = (0.0, 0.5, 1.0)
WIDEST = 10.0
"""Factor between the ends of an arm's strength or time beyond which it is not given a value."""


@dataclass(frozen=True)
class PuckArm:
    """One relaxing arm; ``reason`` says why it is not identifiable, empty when it is."""

    tau_s: Interval
    beta: Interval
    reason: str


Comparison = dict[str, dict[str, float]]


@dataclass(frozen=True)
class PuckRelaxation:
    """What one press with holds says; intervals are 95 %.

    ``seen_s`` are the shortest and longest times that the holds can show: twice the sampling or a tenth of the
    shortest ramp, and half of the longest hold. ``comparison`` gives rmse [N] and AICc for each number of arms.
    """

    young_kPa: Interval
    alpha: float
    friction: Interval
    arms: tuple[PuckArm, ...]
    seen_s: tuple[float, float]
    comparison: Comparison
    noise: PuckNoise
    rmse_N: float


def fit_relaxation(press: PuckPress, diameter_mm: float, height_mm: float, table: PuckTable) -> PuckRelaxation:
    """Fit one press with holds."""
    problem = PuckProblem(press, diameter_mm, height_mm, table)
    rivals: dict[int, Trial] = {}
    for arms in range(MOST_ARMS, -1, -1):
        tried = [problem.fit(problem.starts(arms, grip), grip) for grip in COARSE]
        rivals[arms] = min(tried, key=lambda one: one.chi_square)
        if arms == MOST_ARMS:
            problem.factor = whitener(press, height_mm, _noise(problem, rivals[arms]))
            rivals[arms] = problem.fit([rivals[arms].parameters], rivals[arms].grip)
    scores = {arms: problem.aicc(trial) for arms, trial in rivals.items()}
    chosen = simplest(scores)
    noise = _noise(problem, rivals[chosen])
    problem.factor = whitener(press, height_mm, noise)
    profile: list[Trial] = []
    warm = rivals[chosen].parameters
    for grip in GRIPS[np.argsort(np.abs(GRIPS - rivals[chosen].grip))]:
        nearest = min(profile, key=lambda one: abs(one.grip - grip)).parameters if profile else warm
        profile.append(problem.fit([nearest, warm] if profile else [warm], float(grip)))
    profile.sort(key=lambda one: one.grip)
    comparison = {
        str(arms): {"rmse_N": _rmse(problem, trial), "aicc": scores[arms]} for arms, trial in sorted(rivals.items())
    }
    return _summarise(problem, profile, comparison, noise)


def _noise(problem: PuckProblem, trial: Trial) -> PuckNoise:
    lower = np.linalg.inv(problem.factor)
    return loading.estimate(problem.press, problem.height_mm, lower @ trial.residual, lower @ trial.jacobian)


def _rmse(problem: PuckProblem, trial: Trial) -> float:
    error = problem.predict(trial.parameters, trial.grip) - problem.press.force_N
    return float(np.sqrt(np.mean(error**2)))


def _spreads(trial: Trial) -> Array:
    """Standard deviations of the parameters from the Jacobian; an undetermined one has a very large one."""
    _, singular, turn = np.linalg.svd(trial.jacobian, full_matrices=False)
    return np.sqrt(np.sum((turn / np.maximum(singular, 1e-10 * singular[0])[:, None]) ** 2, axis=0))


def _summarise(problem: PuckProblem, profile: list[Trial], comparison: Comparison, noise: PuckNoise) -> PuckRelaxation:
    best = min(profile, key=lambda one: one.chi_square)
    kept = [profile[index] for index in within([one.chi_square for one in profile])]
    reach = [np.sqrt(CHI_SQUARE_95 - (one.chi_square - best.chi_square)) * _spreads(one) for one in kept]
    low = np.min([one.parameters - width for one, width in zip(kept, reach)], axis=0)
    high = np.max([one.parameters + width for one, width in zip(kept, reach)], axis=0)
    q, arms = best.parameters, (len(best.parameters) - 3) // 2
    ends = problem.box(arms)
    parts = []
    for k in range(arms):
        strength, time = 3 + k, 3 + arms + k
        tau_s, beta = (
            Interval(*np.exp([q[i], max(low[i], -40.0), min(high[i], 40.0)]).tolist()) for i in (time, strength)
        )
        parts.append(PuckArm(tau_s, beta, _reason(problem, tau_s, beta, q[time] - ends[0][time])))
    # what a slow arm still carries at the end of the file counts as stiffness
    elastic = problem.elastic(q[1], best.grip, q[2])
    stiff = 1.0
    for arm in parts:
        if arm.tau_s.value > 0.5 * problem.longest:
            stiff += arm.beta.value * float(problem.arm(elastic, arm.tau_s.value)[-1] / elastic[-1])
    given = tuple(
        PuckArm(arm.tau_s, Interval(arm.beta.value / stiff, arm.beta.low / stiff, arm.beta.high), arm.reason)
        for arm in parts
    )
    young, friction = _elastic(problem, profile, best)
    slow_low = float(np.exp(low[0])) if stiff > 1.0 else young.low
    young = Interval(young.value * stiff, min(young.low, slow_low), young.high * stiff)
    return PuckRelaxation(young, float(q[1]), friction, given, _seen(problem), comparison, noise, _rmse(problem, best))


def _elastic(problem: PuckProblem, profile: list[Trial], best: Trial) -> tuple[Interval, Interval]:
    """Modulus [kPa] and friction with cautious intervals: the puck is one independent number."""
    squares = [float(np.mean(problem.residual(one.parameters, one.grip) ** 2)) for one in profile]
    own = squares[profile.index(best)]
    variance = PUCK_SCATTER**2 + own
    kept = [profile[index] for index in within(squares, variance, own)]
    around = np.sqrt(CHI_SQUARE_95 * variance)
    logs = [one.parameters[0] for one in kept]
    young = Interval(*np.exp([best.parameters[0], min(logs) - around, max(logs) + around]).tolist())
    return young, Interval(*(friction_of(one.grip) for one in (best, kept[0], kept[-1])))


def _seen(problem: PuckProblem) -> tuple[float, float]:
    holds = problem.press.holds
    touch = float(problem.press.time_s[int(np.argmax(problem.press.displacement_mm > 0.0))])
    ramps = [hold.start_s - begin for hold, begin in zip(holds, [touch, *(hold.end_s for hold in holds)])]
    return max(2.0 * problem.times[0], 0.1 * min(ramps)), 0.5 * problem.longest


def _reason(problem: PuckProblem, tau_s: Interval, beta: Interval, above_shortest: float) -> str:
    """Why an arm is not identifiable, or nothing."""
    if tau_s.value > 0.5 * problem.longest:
        return f"slower than half of the longest hold ({problem.longest:.4g} s): hold longer to see its time"
    if above_shortest < 1e-3:
        return f"faster than the samples show ({problem.times[0]:.2g} s)"
    for name, interval in (("time", tau_s), ("strength", beta)):
        if interval.high > WIDEST * interval.low:
            return f"the {name} is known to a factor of {interval.high / interval.low:.2g} only"
    return ""
