"""Long-term modulus, relaxation, stiffening and plate friction of a puck from presses with holds.

The force is that of :mod:`dummydesign.resin.puck_test.loading_fit` with relaxation on top (quasi-linear law):

    F(t) = E integral of (1 + sum_i beta_i exp(-(t - s) / tau_i)) d[A u(c; alpha) B(c; alpha, friction)],

driven by the measured motion. Given alpha, contact offset and times the force is linear in E and E beta_i, from
which the starts are found. The number of arms, 0 to 3, is the smallest whose AICc is within 6 of the lowest, all
under the noise of the richest. Friction is profiled: from frictionless to bonded, or over what was declared of the
plates with its chi square. Presses of one puck are fitted together; each has its own contact offset.

Intervals of times and strengths are those of the profile likelihood over friction, with the other parameters in
their Gaussian approximation. Modulus, friction and alpha are medians over the friction, weighed as in ``loading_fit``:
how the law misfits along the compression is not known, so a puck counts as one independent number with that misfit and
a scatter of 2 % as its size. (By the likelihood, with a smooth misfit of known length, intervals held the truth in 0.7
of the draws of a rougher one.)

An arm whose time may be longer than the longest hold is not given a value. What it has not relaxed at the end of the
file counts as stiffness, what it has is a strength of its own. The interval of the modulus goes down to where it would
have relaxed, those of the other strengths, which are relative to the modulus, up accordingly.

References
----------
Fung, Biomechanics: Mechanical Properties of Living Tissues (1993), chapter 7 (quasi-linear law).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache, partial

import numpy as np

from dummydesign.core.recurrence import linear_recurrence
from dummydesign.inference.least_squares import CHI_SQUARE_95, aicc, simplest, solve_by_differences, within
from dummydesign.pad.tables.puck import PuckTable, uniaxial
from dummydesign.resin.model.resin import PUCK_SCATTER, Interval
from dummydesign.resin.puck_test import loading_fit as loading
from dummydesign.resin.puck_test.loading_fit import FrictionFit, PuckFit, PuckNoise, PuckPress, joined, whitener
from dummydesign.resin.puck_test.plates import ALPHA_RANGE, OPEN, Plates, over_friction

STRENGTHS = (1e-4, 30.0)
KEPT = 256
"""Forces that a problem keeps."""
# Of the Ogden law, from which every fit begins: offset and friction can stand in for stiffening, so that the sum of
# squares may have a valley on either side of neo-Hookean.
EXPONENTS = (1.5, 3.0)


@dataclass(frozen=True, eq=False)
class FitTrial(FrictionFit):
    """With whitened residuals (bins,) and Jacobian (bins, parameters), and the rms residual of the force."""

    chi_square: float
    rmse_N: float


class PuckProblem:
    """Presses of one puck.

    Parameters: ln E [kPa], alpha, an offset over height for each press, then ln beta of the arms, then ln tau [s].
    """

    def __init__(self, presses: Sequence[PuckPress], diameter_mm: float, height_mm: float, table: PuckTable) -> None:
        self.presses, self.height_mm, self.table = tuple(presses), height_mm, table
        self.force_N = joined(presses, "force_N")
        self.first = 2 + len(self.presses)
        self.area = 0.25e-3 * np.pi * diameter_mm**2
        self.log_factor = cache(partial(_smooth_log_factor, table))
        # a slope by differences moves one parameter: what the others give is kept
        self.curve, self.column = lru_cache(KEPT)(self.elastic), lru_cache(KEPT)(self._column)
        self.steps = [np.diff(press.time_s) for press in presses]
        self.longest = loading.longest_hold(presses)
        shortest = float(np.min(joined(presses, "end_s") - joined(presses, "start_s")))
        self.times = (max(shortest, 1e-4 * self.longest), 10.0 * self.longest)
        self.factor = whitener(presses, height_mm, PuckNoise(0.0, 1e-3 * float(self.force_N.max()), 1.0, 0.02))

    def elastic(self, alpha: float, grip: float, offset: float, press: int = 0) -> np.ndarray:
        """Long-term force over E at the nodes of a press, zeroed where its forces are: at its beginning. [N/kPa]"""
        c = np.maximum(self.presses[press].displacement_mm / self.height_mm - offset, 0.0)
        load = self.area * uniaxial(alpha, c) * np.exp(self.log_factor(grip)(alpha, c))
        return load - load[0]

    def arm(self, elastic: np.ndarray, tau_s: float, press: int = 0) -> np.ndarray:
        """Force of an arm of strength one at the nodes, exact for forces that are linear between them."""
        ratio = self.steps[press] / tau_s
        return np.r_[0.0, linear_recurrence(np.exp(-ratio), np.diff(elastic) * (-np.expm1(-ratio) / ratio))]

    def arms(self, q: np.ndarray) -> int:
        """Number of arms of a vector."""
        return (len(q) - self.first) // 2

    def parts(self, q: np.ndarray, grip: float, times: Sequence[float] | np.ndarray) -> np.ndarray:
        """Force over E of the bins: elastic, then an arm of strength one for each time, shape (bins, 1 + times)."""
        alpha, *offsets = q[1 : self.first].tolist()
        taus = [np.inf, *(float(tau) for tau in times)]
        return np.concatenate(
            [
                np.stack([self.column(number, alpha, float(grip), offset, tau) for tau in taus], axis=1)
                for number, offset in enumerate(offsets)
            ]
        )

    def _column(self, number: int, alpha: float, grip: float, offset: float, tau_s: float) -> np.ndarray:
        """Bins of a press: its elastic force over E (infinite time), or that of an arm of strength one."""
        elastic = self.curve(alpha, grip, offset, number)
        return self.presses[number].average @ (elastic if np.isinf(tau_s) else self.arm(elastic, tau_s, number))

    def predict(self, q: np.ndarray, grip: float) -> np.ndarray:
        """Force of the bins. [N]"""
        arms = self.arms(q)
        beta, tau = np.exp(q[self.first : self.first + arms]), np.exp(q[self.first + arms :])
        return np.exp(q[0]) * (self.parts(q, grip, tau) @ np.r_[1.0, beta])

    def residual(self, q: np.ndarray, grip: float) -> np.ndarray:
        """Logarithm of fitted over measured force of the bins."""
        return np.log(np.maximum(self.predict(q, grip), 1e-9) / self.force_N)

    def box(self, arms: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest parameters."""
        weak, strong = np.log(STRENGTHS)
        short, long = np.log(self.times)
        offsets = [loading.LARGEST_OFFSET] * len(self.presses)
        return (
            np.array([-20.0, ALPHA_RANGE[0], *(-one for one in offsets), *[weak] * arms, *[short] * arms]),
            np.array([20.0, ALPHA_RANGE[1], *offsets, *[strong] * arms, *[long] * arms]),
        )

    def starts(self, arms: int, grip: float) -> list[np.ndarray]:
        """For each of both exponents the best combination of times on a grid; E and strengths by non-negative least
        squares."""
        from scipy.optimize import nnls

        starts, goal = [], self.factor.sum(axis=1)
        grid = np.geomspace(3.0 * self.times[0], 0.6 * self.longest, 9)
        offsets = [0.0] * len(self.presses)
        for alpha in EXPONENTS:
            forces = self.parts(np.array([0.0, alpha, *offsets]), grip, grid)
            columns = self.factor @ (forces / self.force_N[:, None])
            # under correlated noise too few arms can be nearest with no modulus at all: it begins with the middle one
            lasting = np.log(np.median(self.force_N / forces[:, 0]))
            logs = [*np.log(np.full(arms, 0.1)), *np.log(grid[np.linspace(1, len(grid) - 2, arms).astype(int)])]
            tried = [(np.inf, [lasting, alpha, *offsets, *logs])]
            for combo in itertools.combinations(range(len(grid)), arms):
                strength, rest = nnls(columns[:, [0, *(1 + k for k in combo)]], goal)
                if strength[0] > 0.0:
                    beta = np.clip(strength[1:] / strength[0], 1e-3, 10.0)
                    logs = [*np.log(beta), *np.log(grid[list(combo)])]
                    tried.append((rest, [np.log(strength[0]), alpha, *offsets, *logs]))
            starts.append(np.array(min(tried, key=lambda pair: pair[0])[1]))
        return starts

    def fit(self, starts: list[np.ndarray], grip: float) -> FitTrial:
        """Trust-region least squares of the whitened residuals; arms in the order of their times."""
        arms, first = self.arms(starts[0]), self.first
        best = solve_by_differences(
            lambda q: self.factor @ self.residual(q, grip), starts, *self.box(arms), tolerance=1e-7, most=60
        )
        assert best.residual is not None and best.jacobian is not None
        order = np.argsort(best.parameters[first + arms :])
        columns = np.r_[np.arange(first), first + order, first + arms + order]
        q = best.parameters[columns]
        misfit, rmse_N = (
            float(np.sqrt(np.mean(rest**2))) for rest in (self.residual(q, grip), self.predict(q, grip) - self.force_N)
        )
        jacobian = best.jacobian[:, columns]
        _, singular, turn = np.linalg.svd(jacobian, full_matrices=False)
        # an undetermined parameter has a very large error
        spread = np.sqrt(np.sum((turn / np.maximum(singular, 1e-10 * singular[0])[:, None]) ** 2, axis=0))
        return FitTrial(grip, q, best.residual, jacobian, spread, misfit, best.chi_square, rmse_N)

    def aicc(self, trial: FitTrial) -> float:
        """Corrected Akaike criterion under the whitening of now; friction and two sizes of noise are counted."""
        fit = trial.chi_square - 2.0 * float(np.log(np.diag(self.factor)).sum())
        return aicc(fit, len(trial.parameters) + 3, len(trial.residual))


def _smooth_log_factor(table: PuckTable, grip: float) -> Callable[[float, np.ndarray], np.ndarray]:
    """ln B of one friction: cubic in compression, a polynomial in alpha, for kinks would halt the search."""
    from scipy.interpolate import CubicSpline

    at = table.alpha
    spline = CubicSpline(
        table.compression, np.stack([np.log(table.factor(one, grip, table.compression)) for one in at], axis=1)
    )

    def value(alpha: float, c: np.ndarray) -> np.ndarray:
        weights = [np.prod((alpha - np.delete(at, k)) / (at[k] - np.delete(at, k))) for k in range(len(at))]
        return spline(np.clip(c, *table.compression[[0, -1]])) @ np.array(weights)

    return value


MOST_ARMS = 3
GRIPS = np.linspace(0.0, 1.0, 11)
COARSE = (0.0, 0.5, 1.0)
WIDEST = 10.0
"""Factor between the ends of an arm's strength or time beyond which it is not given a value."""


@dataclass(frozen=True)
class PuckArm:
    """One relaxing arm; ``reason`` says why it is not identifiable, empty when it is.

    Of a ``slow`` arm, which may outlast the hold, ``beta`` is what relaxes within it, up to all of it.
    """

    tau_s: Interval
    beta: Interval
    reason: str
    slow: bool = False


@dataclass(frozen=True)
class PuckRelaxation(PuckFit):
    """What presses with holds say; intervals are 95 %.

    ``seen_s`` are the shortest and longest times that the presses show (:func:`_fastest_seen`, half of the longest
    hold). ``comparison`` gives rmse [N] and AICc for each number of arms.
    """

    arms: tuple[PuckArm, ...]
    seen_s: tuple[float, float]
    comparison: dict[str, dict[str, float]]
    noise: PuckNoise


def fit_relaxation(
    presses: Sequence[PuckPress], diameter_mm: float, height_mm: float, table: PuckTable, plates: Plates = OPEN
) -> PuckRelaxation:
    """Fit presses of one puck, each with a hold or more."""
    problem = PuckProblem(presses, diameter_mm, height_mm, table)
    rivals: dict[int, FitTrial] = {}
    for arms in range(MOST_ARMS, -1, -1):
        grips = (rivals[MOST_ARMS].grip,) if plates.friction and rivals else COARSE
        rivals[arms] = _likeliest([problem.fit(problem.starts(arms, grip), grip) for grip in grips])
        if arms == MOST_ARMS:
            problem.factor = whitener(presses, height_mm, _noise(problem, rivals[arms]))
            rivals[arms] = problem.fit([rivals[arms].parameters], rivals[arms].grip)
    scores = {arms: problem.aicc(trial) for arms, trial in rivals.items()}
    chosen = simplest(scores)
    noise = _noise(problem, rivals[chosen])
    problem.factor = whitener(presses, height_mm, noise)
    nodes, prior = plates.nodes(GRIPS)
    profile = _profile(problem, nodes, rivals[chosen])
    free = _profile(problem, np.array(COARSE), _likeliest(profile)) if plates.friction else []
    misfit, misfit_open = (min(one.misfit for one in some) for some in (profile, [*profile, *free]))
    comparison = {str(arms): {"rmse_N": trial.rmse_N, "aicc": scores[arms]} for arms, trial in sorted(rivals.items())}
    return _summarise(problem, profile, comparison, noise, prior, (misfit, misfit_open))


def _likeliest(trials: list[FitTrial]) -> FitTrial:
    return min(trials, key=lambda one: one.chi_square)


def _profile(problem: PuckProblem, grips: np.ndarray, start: FitTrial) -> list[FitTrial]:
    """Best fits at some grips, each from the nearest that was fitted and from both exponents; by rising grip."""
    valleys = [np.r_[start.parameters[0], alpha, start.parameters[2:]] for alpha in EXPONENTS]
    profile: list[FitTrial] = []
    for grip in grips[np.argsort(np.abs(grips - start.grip))].tolist():
        nearest = min([start, *profile], key=lambda one: abs(one.grip - grip))
        profile.append(problem.fit([nearest.parameters, *valleys], grip))
    return sorted(profile, key=lambda one: one.grip)


def _noise(problem: PuckProblem, trial: FitTrial) -> PuckNoise:
    lower = np.linalg.inv(problem.factor)
    return loading.estimate(problem.presses, problem.height_mm, lower @ trial.residual, lower @ trial.jacobian)


def _summarise(
    problem: PuckProblem,
    profile: list[FitTrial],
    comparison: dict[str, dict[str, float]],
    noise: PuckNoise,
    prior: np.ndarray,
    misfit: tuple[float, float],
) -> PuckRelaxation:
    costs = [one.chi_square + more for one, more in zip(profile, prior)]
    best, least = profile[int(np.argmin(costs))], min(costs)
    places = within(costs)
    kept = [profile[index] for index in places]
    reach = [np.sqrt(CHI_SQUARE_95 - (costs[index] - least)) * profile[index].spread for index in places]
    low = np.min([one.parameters - width for one, width in zip(kept, reach)], axis=0)
    high = np.max([one.parameters + width for one, width in zip(kept, reach)], axis=0)
    q, arms, first = best.parameters, problem.arms(best.parameters), problem.first
    parts = []
    for k in range(arms):
        strength, time = first + k, first + arms + k
        tau_s, beta = (
            Interval(*np.exp([q[i], max(low[i], -40.0), min(high[i], 40.0)]).tolist()) for i in (time, strength)
        )
        reason = _reason(problem, tau_s, beta)
        parts.append(PuckArm(tau_s, beta, reason, tau_s.high > problem.longest))
    # what a slow arm still carries at the end of the file counts as stiffness
    longest = int(np.argmax([loading.longest_hold([press]) for press in problem.presses]))
    elastic = problem.elastic(q[1], best.grip, q[2 + longest], longest)
    carried = [float(problem.arm(elastic, arm.tau_s.value, longest)[-1] / elastic[-1]) * arm.slow for arm in parts]
    stiff = 1.0 + sum(arm.beta.value * share for arm, share in zip(parts, carried))
    given = tuple(
        PuckArm(
            arm.tau_s,
            Interval((1.0 - share) * arm.beta.value / stiff, (1.0 - share) * arm.beta.low / stiff, arm.beta.high),
            arm.reason,
            arm.slow,
        )
        for arm, share in zip(parts, carried)
    )
    # the puck is one independent number
    squares = np.array([one.misfit**2 for one in profile])
    variance = PUCK_SCATTER**2 + squares.min()
    law = np.array([one.spread[:2] for one in profile]).T
    log_young, alpha = np.array([one.parameters[:2] for one in profile]).T
    known = over_friction(
        np.array([one.grip for one in profile]),
        (squares - squares.min()) / variance + prior,
        np.stack([log_young, np.sqrt(variance + law[0] ** 2)]),
        np.stack([alpha, law[1]]),
        np.sqrt(squares),
        np.concatenate([press.compression_mm for press in problem.presses]) / problem.height_mm,
    )
    young = known.young_kPa
    slow_low = float(np.exp(low[0])) if stiff > 1.0 else young.low
    young = Interval(young.value * stiff, min(young.low, slow_low), young.high * stiff)
    levels = loading.press_levels(
        partial(problem.residual, q),
        np.linalg.solve(problem.factor, best.jacobian),
        best.grip,
        loading.covariance(problem.presses, problem.height_mm, noise),
        [press.compression_mm / problem.height_mm for press in problem.presses],
    )
    return PuckRelaxation(
        replace(known, young_kPa=young),
        best.rmse_N,
        *misfit,
        *levels,
        given,
        _seen(problem, best, given),
        comparison,
        noise,
    )


SHOWN = 0.05
"""Standard deviation of a strength, over the long-term modulus, up to which presses show an arm: one of a tenth would
be seen."""


def _seen(problem: PuckProblem, best: FitTrial, arms: Sequence[PuckArm]) -> tuple[float, float]:
    """Shortest and longest time that the presses show; a fast arm without a value bounds them."""
    shortest, longest = _fastest_seen(problem, best), 0.5 * problem.longest
    known = [arm.tau_s.value for arm in arms if not arm.reason]
    shortest = min([shortest, *known])
    for arm in arms:
        if arm.reason and not arm.slow and arm.tau_s.value < min(known, default=np.inf):
            shortest = max(shortest, min(arm.tau_s.high, min(known, default=longest)))
    return min(shortest, longest), longest


def _fastest_seen(problem: PuckProblem, best: FitTrial) -> float:
    """Shortest time at which an arm alone would have a strength known to :data:`SHOWN` or better. [s]

    By the noise of the bins, with modulus, stiffening and offsets free: a ramp that is slow against the time or noise
    hide it. Not shorter than two samples.
    """
    step = min(float(np.median((one.end_s - one.start_s) / one.samples)) for one in problem.presses)
    times = np.geomspace(problem.times[0], 0.5 * problem.longest, 40)
    forces = problem.parts(best.parameters, best.grip, times)[:, 1:]
    columns = problem.factor @ (np.exp(best.parameters[0]) * forces / problem.force_N[:, None])
    others, _ = np.linalg.qr(best.jacobian[:, : problem.first])
    columns = columns - others @ (others.T @ columns)
    hidden = np.nonzero(np.sum(columns**2, axis=0) < SHOWN**-2)[0]
    return max(float(times[min(hidden[-1] + 1, len(times) - 1) if hidden.size else 0]), 2.0 * step)


def _reason(problem: PuckProblem, tau_s: Interval, beta: Interval) -> str:
    """Why an arm is not identifiable, or nothing."""
    if tau_s.high > problem.longest:
        return (
            f"its time ({tau_s.value:.3g} s) may be longer than the longest hold ({problem.longest:.4g} s): hold "
            "longer to see it"
        )
    if tau_s.value < 1.001 * problem.times[0]:
        return f"faster than the samples show ({problem.times[0]:.2g} s)"
    for name, interval in (("time", tau_s), ("strength", beta)):
        if interval.high > WIDEST * interval.low:
            return f"the {name} is known to a factor of {interval.high / interval.low:.2g} only"
    return ""
