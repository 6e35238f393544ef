"""The fit of one set of parameters to some traces: model, starts, noise, optimum."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.least_squares import Model, Solution, solve
from dummydesign.inference.model_selection import aicc
from dummydesign.inference.noise import Bins, Noise, minus_two_log_likelihood, whitener
from dummydesign.inference.noise_floor import noise_floor
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.fitting.groups import condition_groups, speed_groups
from dummydesign.tissue.fitting.noise import estimate_noise
from dummydesign.tissue.fitting.reduction import ReducedTrace
from dummydesign.tissue.fitting.responses import Responses
from dummydesign.tissue.model.laws import law_named

START_RATES_PER_S = np.geomspace(0.05, 400.0, 14)
"""Decay rates at the median depth from which starts are combined."""


@dataclass(frozen=True)
class Optimum:
    """The best fit of a number of arms: parameters (ln), noise and whitening."""

    arms: int
    solution: Solution
    noise: Noise
    factor: NDArray


def largest_slow(traces: Sequence[ReducedTrace]) -> float:
    """Slow noise that may be believed: twice what the holds show without any law. [N]"""
    return max(2.0 * noise_floor(trace.hold for trace in traces), 0.01)


class Problem:
    """Traces with one gamma per spring and one c per arm and group of traces.

    Parameters (natural logarithms): gamma1, gamma2 .., then for each group c2 .. of its arms.

    Parameters
    ----------
    law : str
        Form of the law.
    groups : list of list of ReducedTrace
        Traces that share dampers: one group in a joint fit, one per speed in a fit per speed.
    lowpass : Lowpass or None
        Filter the recorded forces went through.
    """

    def __init__(self, law: str, groups: list[list[ReducedTrace]], lowpass: Lowpass | None) -> None:
        self.traces = [trace for group in groups for trace in group]
        self.law, self.lowpass, self.groups = law, lowpass, groups
        self.responses = [Responses(law, group, lowpass) for group in groups]
        self.bins = Bins(self.traces)
        self.largest_slow_N = largest_slow(self.traces)
        self.force = np.concatenate([trace.force_N for trace in self.traces])
        self.elastic = np.concatenate([response.elastic for response in self.responses])
        ends = np.cumsum([0, *(len(response.elastic) for response in self.responses)])
        self.slices = [slice(a, b) for a, b in itertools.pairwise(ends)]
        self.size = float(np.median([t.steady_force_N / t.ramp.depth_mm**3 for t in self.traces]))
        self.depth = float(np.median([t.ramp.depth_mm for t in self.traces]))

    def split(self, theta: NDArray, arms: int) -> tuple[float, NDArray, NDArray]:
        """ln gamma1, ln gamma (arms,) and ln c (groups, arms) of a parameter vector."""
        return theta[0], theta[1 : 1 + arms], theta[1 + arms :].reshape(len(self.groups), arms)

    def predict(self, theta: NDArray, arms: int) -> tuple[NDArray, NDArray]:
        """Binned force (bins,) [N] and its derivatives to the ln parameters (bins, parameters)."""
        gamma1, gamma, damper = self.split(theta, arms)
        jacobian = np.zeros((len(self.force), len(theta)))
        jacobian[:, 0] = np.exp(gamma1) * self.elastic
        for group, (where, response) in enumerate(zip(self.slices, self.responses)):
            for arm in range(arms):
                value, slope = response.arm(gamma[arm] - damper[group, arm])
                strength = np.exp(gamma[arm])
                jacobian[where, 1 + arm] = strength * (value + slope)
                jacobian[where, 1 + arms + group * arms + arm] = -strength * slope
        # F = gamma1 X + sum gamma A: the sum of gamma and c columns of an arm is gamma A itself
        force = jacobian[:, 0].copy()
        force += jacobian[:, 1:].sum(axis=1)
        return force, jacobian

    def box(self, arms: int) -> tuple[NDArray, NDArray]:
        """Lowest and highest ln parameters."""
        return law_named(self.law).bounds(arms, len(self.groups), self.size, self.responses[0].log_rate)

    def model(self, arms: int, factor: NDArray) -> Model:
        """Residuals and Jacobian, whitened by ``factor`` (traces, longest, longest)."""

        def evaluate(theta: NDArray) -> tuple[NDArray, NDArray]:
            force, jacobian = self.predict(theta, arms)
            both = factor @ self.bins.stacked(np.column_stack([force - self.force, jacobian]))
            flat = both.reshape(-1, both.shape[-1])
            return flat[:, 0], flat[:, 1:]

        return evaluate

    def starts(self, arms: int, count: int = 4) -> list[NDArray]:
        """Parameter vectors to start from: the best few of all combinations of arm rates.

        For given rates the force is linear in the gammas, which non-negative least squares finds.
        """
        weight = 1.0 / (0.03 + 0.02 * np.abs(self.force))
        grid = np.log(START_RATES_PER_S / self.depth**2)
        chosen = self._combinations(arms, grid, weight, self.slices, count)
        rates = [np.tile(combo, (len(self.groups), 1)) for combo in chosen]
        if len(self.groups) > 1:
            own = [self._combinations(arms, grid, weight, [where], 1)[0] for where in self.slices]
            rates.append(np.array(own))
        return [self._linear(rate, weight) for rate in rates]

    def _columns(self, rates: NDArray) -> NDArray:
        """X and A at ln rates (groups, arms), shape (bins, 1 + arms)."""
        arms = rates.shape[1]
        columns = np.empty((len(self.force), 1 + arms))
        columns[:, 0] = self.elastic
        for where, response, own in zip(self.slices, self.responses, rates):
            for arm in range(arms):
                columns[where, 1 + arm] = response.arm(own[arm])[0]
        return columns

    def _combinations(self, arms: int, grid: NDArray, weight: NDArray, where: list[slice], count: int) -> list[NDArray]:
        """The best ``count`` combinations of ``arms`` rates out of the grid, for the bins in ``where``."""
        from scipy.optimize import nnls

        rows = np.concatenate([np.arange(part.start, part.stop) for part in where])
        columns = self._columns(np.tile(grid, (len(self.groups), 1)))[rows] * weight[rows, None]
        weighted = np.column_stack([columns, self.force[rows] * weight[rows]])
        triangle = np.asarray(np.linalg.qr(weighted, mode="r"))
        ranked = []
        for combo in itertools.combinations(range(len(grid)), arms):
            places = [0, *(1 + place for place in combo)]
            ranked.append((nnls(triangle[:, places], triangle[:, -1])[1], combo))
        ranked.sort()
        kept: list[tuple[int, ...]] = []
        for _, combo in ranked:
            if all(sum(abs(a - b) for a, b in zip(combo, other)) > 2 for other in kept):
                kept.append(combo)
            if len(kept) == count:
                break
        return [grid[list(combo)] for combo in kept]

    def _linear(self, rates: NDArray, weight: NDArray) -> NDArray:
        """Parameter vector with the best gammas for ln rates (groups, arms)."""
        from scipy.optimize import nnls

        gammas = nnls(self._columns(rates) * weight[:, None], self.force * weight)[0]
        logs = np.log(np.maximum(gammas, 1e-3 * self.size))
        return np.r_[logs, (logs[1:] - rates).ravel()]

    def optimum(self, arms: int) -> Optimum:
        """Fit: simple weights from all starts, then the noise model estimated and the best refitted twice."""
        low, high = self.box(arms)
        shallow = np.maximum([t.ramp.depth_mm for t in self.traces], 1e-3)[:, None] * 0.1
        depth = self.bins.stacked(np.concatenate([t.average @ t.motion.displacement_mm for t in self.traces]))
        rough = self.bins.stacked(1.0 / (0.03 + 0.02 * np.abs(self.force)))
        factor = np.zeros((*rough.shape, rough.shape[1]))
        diagonal = np.arange(rough.shape[1])
        factor[:, diagonal, diagonal] = np.where(self.bins.used, rough, 1.0)
        first = solve(self.model(arms, factor), self.starts(arms), low, high, 1e-7)
        found = first
        noise: Noise | None = None
        measured = self.bins.stacked(self.force)
        slope = 3.0 * np.maximum(measured, 0.0) / np.maximum(depth, shallow)
        level = np.where(self.bins.used, measured.max(axis=1, keepdims=True), 0.0)
        for _ in range(2):
            force, jacobian = self.predict(found.parameters, arms)
            residual, sensitivity = self.bins.stacked(self.force - force), self.bins.stacked(jacobian)
            noise = estimate_noise(self.bins, level, slope, residual, sensitivity, self.largest_slow_N, noise)
            factor = whitener(self.bins.covariance(noise, slope, level))
            found = solve(self.model(arms, factor), [found.parameters], low, high)
        assert noise is not None
        best = Solution(found.parameters, found.chi_square, first.starts, first.agreeing)
        return Optimum(arms, self._slowest_first(best, arms), noise, factor)

    def aicc(self, optimum: Optimum, factor: NDArray) -> float:
        """Corrected Akaike criterion of a fit under a given whitening, refitted under it.

        Rivals are compared under one and the same noise; with a noise of its own each would be judged
        by another measure.
        """
        low, high = self.box(optimum.arms)
        model = self.model(optimum.arms, factor)
        theta = solve(model, [optimum.solution.parameters], low, high, 1e-7).parameters
        residual = self.bins.stacked(self.force - self.predict(theta, optimum.arms)[0])
        unknown = len(theta) + (5 if len(self.traces) >= 4 else 4)
        return aicc(minus_two_log_likelihood(self.bins, factor, residual), unknown, len(self.force))

    def _slowest_first(self, solution: Solution, arms: int) -> Solution:
        """Order the arms by falling c / gamma (geometric mean over groups)."""
        gamma1, gamma, damper = self.split(solution.parameters, arms)
        order = np.argsort(gamma - damper.mean(axis=0), kind="stable")
        theta = np.r_[gamma1, gamma[order], damper[:, order].ravel()]
        return Solution(theta, solution.chi_square, solution.starts, solution.agreeing)


def problems_of(law: str, mode: str, reduced: list[ReducedTrace], lowpass: Lowpass | None) -> list[Problem]:
    """The fits that a mode consists of: one, or one per condition.

    Parameters
    ----------
    law, mode : str
        As for :func:`~dummydesign.tissue.fitting.fit.fit_traces`.
    reduced : list of ReducedTrace
        The presses in bins.
    lowpass : Lowpass or None
        Filter that the forces went through.

    Returns
    -------
    list of Problem
    """
    if mode == "joint":
        return [Problem(law, [reduced], lowpass)]
    if mode == "per-speed":
        return [Problem(law, [group for _, group in speed_groups(reduced)], lowpass)]
    return [Problem(law, [group], lowpass) for _, _, group in condition_groups(reduced)]
