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

from dataclasses import dataclass

import numpy as np

from dummydesign.inference.model_selection import simplest
from dummydesign.inference.profile import CHI_SQUARE_95, within
from dummydesign.pad.tables.pucks.response import PuckTable, friction_of
from dummydesign.resin.puck_test.model import PuckProblem, Trial
from dummydesign.resin.puck_test.noise import PuckNoise, estimate, whitener
from dummydesign.resin.puck_test.reduction import PuckPress

Array = np.ndarray

MOST_ARMS = 3
PUCK_SCATTER = 0.02
GRIPS = np.linspace(0.0, 1.0, 11)
COARSE = (0.0, 0.5, 1.0)
WIDEST = 10.0
"""Factor between the ends of an arm's strength or time beyond which it is not given a value."""


@dataclass(frozen=True)
class Found:
    """A value with the ends of its 95 % interval."""

    value: float
    low: float
    high: float

    def to_dict(self) -> dict[str, float]:
        """Return the three numbers."""
        return {"value": self.value, "low": self.low, "high": self.high}


@dataclass(frozen=True)
class PuckArm:
    """One relaxing arm; ``reason`` says why it is not identifiable, empty when it is."""

    tau_s: Found
    beta: Found
    reason: str


@dataclass(frozen=True)
class PuckRelaxation:
    """What one press with holds says; intervals are 95 %.

    ``seen_s`` are the shortest and longest times that the holds can show: twice the sampling or a tenth of the
    shortest ramp, and half of the longest hold. ``comparison`` gives rmse [N] and AICc for each number of arms,
    ``chi_square`` the profile over friction, ``time_s``, ``force_N``, ``fitted_N`` the bins.
    """

    young_kPa: Found
    alpha: float
    friction: Found
    offset_mm: float
    arms: tuple[PuckArm, ...]
    seen_s: tuple[float, float]
    comparison: dict[str, dict[str, float]]
    noise: PuckNoise
    rmse_N: float
    chi_square: tuple[tuple[float, float], ...]
    time_s: Array
    force_N: Array
    fitted_N: Array


def fit_relaxation(press: PuckPress, diameter_mm: float, height_mm: float, table: PuckTable) -> PuckRelaxation:
    """Fit one press with holds.

    Parameters
    ----------
    press : PuckPress
        One press with holds, reduced by :func:`reduce_press`.
    diameter_mm, height_mm : float
        Undeformed puck. [mm]
    table : PuckTable
        Of this shape, see :func:`dummydesign.pad.tables.pucks.proportions.table_for`.

    Returns
    -------
    PuckRelaxation
    """
    problem = PuckProblem(press, diameter_mm, height_mm, table)
    rivals: dict[int, Trial] = {}
    for arms in range(MOST_ARMS, -1, -1):
        tried = [problem.fit(problem.starts(arms, grip), grip) for grip in COARSE]
        rivals[arms] = min(tried, key=lambda one: one.chi_square)
        if arms == MOST_ARMS:
            problem.factor = whitener(press, height_mm, _noise(problem, rivals[arms]))
            rivals[arms] = problem.fit([rivals[arms].parameters], rivals[arms].grip)
    scores = {arms: problem.aicc(found) for arms, found in rivals.items()}
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
        str(arms): {"rmse_N": _rmse(problem, found), "aicc": scores[arms]} for arms, found in sorted(rivals.items())
    }
    return _summarise(problem, profile, comparison, noise)


def _noise(problem: PuckProblem, found: Trial) -> PuckNoise:
    lower = np.linalg.inv(problem.factor)
    jacobian = lower @ found.jacobian
    return estimate(problem.press, problem.height_mm, lower @ found.residual, jacobian)


def _rmse(problem: PuckProblem, found: Trial) -> float:
    error = problem.predict(found.parameters, found.grip) - problem.press.force_N
    return float(np.sqrt(np.mean(error**2)))


def _spreads(found: Trial) -> Array:
    """Standard deviations of the parameters from the Jacobian; what cannot be told has a very large one."""
    _, singular, turn = np.linalg.svd(found.jacobian, full_matrices=False)
    floor = 1e-10 * singular[0]
    return np.sqrt(np.sum((turn / np.maximum(singular, floor)[:, None]) ** 2, axis=0))


def _summarise(
    problem: PuckProblem, profile: list[Trial], comparison: dict[str, dict[str, float]], noise: PuckNoise
) -> PuckRelaxation:
    best = min(profile, key=lambda one: one.chi_square)
    kept = [profile[place] for place in within([one.chi_square for one in profile])]
    reach = [np.sqrt(CHI_SQUARE_95 - (one.chi_square - best.chi_square)) * _spreads(one) for one in kept]
    low = np.min([one.parameters - width for one, width in zip(kept, reach)], axis=0)
    high = np.max([one.parameters + width for one, width in zip(kept, reach)], axis=0)
    q, arms = best.parameters, (len(best.parameters) - 3) // 2
    ends = problem.box(arms)
    parts = []
    for k in range(arms):
        strength, time = 3 + k, 3 + arms + k
        tau_s, beta = (
            Found(*np.exp([q[i], max(low[i], -40.0), min(high[i], 40.0)]).tolist()) for i in (time, strength)
        )
        parts.append(PuckArm(tau_s, beta, _reason(problem, tau_s, beta, q[time] - ends[0][time])))
    # what a slow arm still carries at the end of the file counts as stiffness
    elastic = problem.elastic(q[1], best.grip, q[2])
    stiff = 1.0
    for arm in parts:
        if arm.tau_s.value > 0.5 * problem.longest:
            stiff += arm.beta.value * float(problem.arm(elastic, arm.tau_s.value)[-1] / elastic[-1])
    given = tuple(
        PuckArm(arm.tau_s, Found(arm.beta.value / stiff, arm.beta.low / stiff, arm.beta.high), arm.reason)
        for arm in parts
    )
    young, friction = _elastic(problem, profile, best)
    slow_low = float(np.exp(low[0])) if stiff > 1.0 else young.low
    young = Found(young.value * stiff, min(young.low, slow_low), young.high * stiff)
    press = problem.press
    return PuckRelaxation(
        young, float(q[1]), friction, float(q[2] * problem.height_mm), given, _seen(problem), comparison, noise,
        _rmse(problem, best), tuple((friction_of(one.grip), one.chi_square - best.chi_square) for one in profile),
        0.5 * (press.start_s + press.end_s), press.force_N, problem.predict(q, best.grip),
    )  # fmt: skip


def _elastic(problem: PuckProblem, profile: list[Trial], best: Trial) -> tuple[Found, Found]:
    """Modulus [kPa] and friction with cautious intervals: the puck is one independent number."""
    squares = [float(np.mean(problem.residual(one.parameters, one.grip) ** 2)) for one in profile]
    own = squares[profile.index(best)]
    variance = PUCK_SCATTER**2 + own
    kept = [profile[place] for place in within(squares, variance, own)]
    around = np.sqrt(CHI_SQUARE_95 * variance)
    logs = [one.parameters[0] for one in kept]
    young = Found(*np.exp([best.parameters[0], min(logs) - around, max(logs) + around]).tolist())
    return young, Found(*(friction_of(one.grip) for one in (best, kept[0], kept[-1])))


def _seen(problem: PuckProblem) -> tuple[float, float]:
    holds = problem.press.holds
    touch = float(problem.press.time_s[int(np.argmax(problem.press.displacement_mm > 0.0))])
    ramps = [hold.start_s - begin for hold, begin in zip(holds, [touch, *(hold.end_s for hold in holds)])]
    return max(2.0 * problem.times[0], 0.1 * min(ramps)), 0.5 * problem.longest


def _reason(problem: PuckProblem, tau_s: Found, beta: Found, above_shortest: float) -> str:
    """Why an arm is not identifiable, or nothing."""
    if tau_s.value > 0.5 * problem.longest:
        return f"slower than half of the longest hold ({problem.longest:.4g} s): hold longer to see its time"
    if above_shortest < 1e-3:
        return f"faster than the samples show ({problem.times[0]:.2g} s)"
    for name, found in (("time", tau_s), ("strength", beta)):
        if found.high > WIDEST * found.low:
            return f"the {name} is known to a factor of {found.high / found.low:.2g} only"
    return ""
