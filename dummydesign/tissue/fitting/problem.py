"""The fit of one set of parameters to traces: model, starts, noise, optimum, residuals on the raw samples."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.files import csv_text
from dummydesign.inference.least_squares import Model, Solution, aicc, solve
from dummydesign.inference.noise import (
    Bins,
    Noise,
    likeliest,
    minus_two_log_likelihood,
    noise_floor,
    restricted_slope,
    whitener,
)
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.fitting.reduction import ReducedTrace, condition_groups, speed_groups
from dummydesign.tissue.model.maxwell_law import law_named

PER_DECADE = 10
SLOWEST_PER_S, FASTEST_PER_S = 1e-3, 3e4
"""Decay rates r x^2 at the depths of the traces between which A is tabulated."""


class Responses:
    """X and A(ln r) of several traces, their bins joined in one vector."""

    def __init__(self, law: str, traces: list[ReducedTrace], lowpass: Lowpass | None) -> None:
        from scipy.interpolate import CubicSpline

        depth = [trace.ramp.depth_mm for trace in traces]
        low, high = np.log(SLOWEST_PER_S / max(depth) ** 2), np.log(FASTEST_PER_S / min(depth) ** 2)
        grid = np.linspace(low, high, int(np.ceil((high - low) / np.log(10.0) * PER_DECADE)) + 1)
        elastic, arms = [], []
        for trace in traces:
            drive = law_named(law).drive(trace.motion)
            # by decades: only the fast ones need the fine quadrature
            parts = [drive.arm(np.exp(part)) for part in np.array_split(grid, max(len(grid) // PER_DECADE, 1))]
            curves = np.vstack([drive.elastic[None], *parts])
            if lowpass is not None:
                curves = lowpass.apply(trace.motion.time_s, curves)
            binned = curves @ trace.operator.T
            elastic.append(binned[0])
            arms.append(binned[1:])
        self.elastic = np.concatenate(elastic)
        self.log_rate = (float(low), float(high))
        self._spline = CubicSpline(grid, np.concatenate(arms, axis=1))
        self._slope = self._spline.derivative()

    def arm(self, log_rate: float) -> tuple[NDArray, NDArray]:
        """A and dA / d ln r at one ln r, each of shape (bins,). [mm3]"""
        low, high = self.log_rate
        if log_rate > high:
            value = self._spline(high) * np.exp(high - log_rate)
            return value, -value
        if log_rate < low:
            return self._spline(low), np.zeros_like(self.elastic)
        return self._spline(log_rate), self._slope(log_rate)


LOWEST = 1e-4
"""Slow noise [N], position [mm] and misfit over peak below which they count as none."""

MISFIT_GAIN = 6.0
"""Gain in twice the log likelihood for which misfit is believed."""

LARGEST_POSITION_MM = 0.05
"""Largest error of the contact position that is believed; robot precision is 0.02 mm."""

ALIKE = 3.0
"""Neighbouring bins that misfit alike: the variance of misfit is raised by as much for the intervals."""

FLOOR_N = 1e-3
"""Smallest white noise that is believed: a tenth of the usual step of a force sensor. [N]"""


def estimate_noise(
    bins: Bins,
    level: NDArray,
    slope: NDArray,
    residual: NDArray,
    jacobian: NDArray,
    largest_slow_N: float,
    start: Noise | None = None,
) -> Noise:
    """Estimate the noise by restricted maximum likelihood."""
    with_position = len(residual) >= 4
    scale = max(float(np.sqrt((residual**2).sum() / bins.used.sum())), FLOOR_N)
    begin = start or Noise(max(min(scale, largest_slow_N), 2 * FLOOR_N), 0.5 * scale, 0.5, 5e-3 * with_position)
    low = Noise(FLOOR_N, LOWEST, 5e-3, LOWEST if with_position else 0.0)
    high = Noise(1.5 * largest_slow_N, largest_slow_N, 5.0, LARGEST_POSITION_MM if with_position else 0.0)

    def search(begin: Noise, low: Noise, high: Noise) -> tuple[Noise, float]:
        """Sizes whose upper bound is not 0; those at their lower bound become 0."""
        names = [name for name, value in asdict(high).items() if value > 0]

        def noise_of(sizes: NDArray) -> Noise:
            kept = {name: 0.0 if value <= 1.02 * LOWEST else value for name, value in zip(names, sizes.tolist())}
            return Noise(**{**dict.fromkeys(asdict(high), 0.0), **kept})

        def cost_of(sizes: NDArray) -> tuple[float, NDArray]:
            noise = noise_of(sizes)
            cost, pull = restricted_slope(bins.covariance(noise, slope, level), residual, jacobian)
            slopes = bins.size_slopes(noise, slope, level, pull)
            return cost, sizes * [slopes[name] for name in names]

        first, least, most = (np.array([getattr(one, name) for name in names]) for one in (begin, low, high))
        sizes, cost = likeliest(cost_of, first, least, most, gradient=True)
        return noise_of(sizes), cost

    plain, plain_cost = search(begin, low, high)
    if plain.white_N < 0.9 * high.white_N and plain.slow_N < 0.9 * high.slow_N:
        return plain  # the residual looks like the noise of the holds
    low, high = replace(low, misfit_fraction=LOWEST), replace(high, misfit_fraction=1.0)
    wide, wide_cost = search(replace(plain, misfit_fraction=max(plain.misfit_fraction, 3e-3)), low, high)
    # slow noise and misfit are alike: misfit must earn its place
    if wide_cost > plain_cost - MISFIT_GAIN:
        return plain
    return replace(wide, misfit_fraction=ALIKE**0.5 * wide.misfit_fraction)


START_RATES_PER_S = np.geomspace(0.05, 400.0, 14)
"""Decay rates at the median depth from which starts are combined."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """The best fit of a number of arms: parameters (ln), noise and whitening."""

    arms: int
    solution: Solution
    noise: Noise
    factor: NDArray


def largest_slow(traces: Sequence[ReducedTrace]) -> float:
    """Return the slow noise that may be believed: twice what the holds show without any law. [N]"""
    return max(2.0 * noise_floor(trace.hold for trace in traces), 0.01)


class TissueProblem:
    """Traces with one gamma per spring and one c per arm and group of traces.

    Parameters (natural logarithms): gamma1, gamma2 .., then for each group c2 .. of its arms.
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

    def by_trace(self, values: NDArray) -> list[tuple[ReducedTrace, NDArray]]:
        """Return each trace with its part of values of all bins."""
        return list(zip(self.traces, np.split(values, np.cumsum([len(trace.force_N) for trace in self.traces])[:-1])))

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
        return jacobian[:, 0] + jacobian[:, 1:].sum(axis=1), jacobian

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
        """Parameter vectors to start from: the best few of all combinations of arm rates."""
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
        parts = (
            np.column_stack([response.elastic, *(response.arm(rate)[0] for rate in own)])
            for response, own in zip(self.responses, rates)
        )
        return np.concatenate(list(parts))

    def _combinations(self, arms: int, grid: NDArray, weight: NDArray, where: list[slice], count: int) -> list[NDArray]:
        """The best ``count`` combinations of ``arms`` rates out of the grid, for the bins in ``where``."""
        from scipy.optimize import nnls

        rows = np.concatenate([np.arange(part.start, part.stop) for part in where])
        columns = self._columns(np.tile(grid, (len(self.groups), 1)))[rows] * weight[rows, None]
        weighted = np.column_stack([columns, self.force[rows] * weight[rows]])
        triangle = np.asarray(np.linalg.qr(weighted, mode="r"))
        combos = itertools.combinations(range(len(grid)), arms)
        ranked = sorted((nnls(triangle[:, [0, *(1 + at for at in own)]], triangle[:, -1])[1], own) for own in combos)
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
        depth = self.bins.stacked(np.concatenate([t.depth_mm for t in self.traces]))
        rough = self.bins.stacked(1.0 / (0.03 + 0.02 * np.abs(self.force)))
        factor = np.where(self.bins.used, rough, 1.0)[:, :, None] * np.eye(rough.shape[1])
        last = first = solve(self.model(arms, factor), self.starts(arms), low, high, 1e-7)
        noise: Noise | None = None
        measured, level = self.measured_and_level()
        slope = 3.0 * np.maximum(measured, 0.0) / np.maximum(depth, shallow)
        for _ in range(2):
            force, jacobian = self.predict(last.parameters, arms)
            residual, sensitivity = self.bins.stacked(self.force - force), self.bins.stacked(jacobian)
            noise = estimate_noise(self.bins, level, slope, residual, sensitivity, self.largest_slow_N, noise)
            factor = whitener(self.bins.covariance(noise, slope, level))
            last = solve(self.model(arms, factor), [last.parameters], low, high)
        assert noise is not None
        # arms in the order of falling c / gamma (geometric mean over groups)
        gamma1, gamma, damper = self.split(last.parameters, arms)
        order = np.argsort(gamma - damper.mean(axis=0), kind="stable")
        theta = np.r_[gamma1, gamma[order], damper[:, order].ravel()]
        return Optimum(arms, Solution(theta, last.chi_square, first.starts, first.agreeing), noise, factor)

    def measured_and_level(self) -> tuple[NDArray, NDArray]:
        """Return measured forces, and the peak of their press where there is a bin, both (traces, longest). [N]"""
        measured = self.bins.stacked(self.force)
        return measured, np.where(self.bins.used, measured.max(axis=1, keepdims=True), 0.0)

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


def problems_of(law: str, mode: str, reduced: list[ReducedTrace], lowpass: Lowpass | None) -> list[TissueProblem]:
    """The fits that a mode consists of: one, or one per condition."""
    if mode == "per-condition":
        return [TissueProblem(law, [group], lowpass) for _, _, group in condition_groups(reduced)]
    groups = [reduced] if mode == "joint" else [group for _, group in speed_groups(reduced)]
    return [TissueProblem(law, groups, lowpass)]


def fitted_force(problem: TissueProblem, optimum: Optimum, index: int) -> NDArray:
    """Fitted force of trace ``index`` of the problem at its nodes, filtered as recorded. [N]"""
    gamma1, gamma, damper = problem.split(optimum.solution.parameters, optimum.arms)
    group = np.repeat(np.arange(len(problem.groups)), [len(part) for part in problem.groups])[index]
    motion = problem.traces[index].motion
    curve = law_named(problem.law).force(motion, np.exp(gamma1), np.exp(gamma), np.exp(damper[group]))
    return curve if problem.lowpass is None else problem.lowpass.apply(motion.time_s, curve)


def trace_residuals(pairs: Sequence[tuple[TissueProblem, Optimum]]) -> dict[str, Any]:
    """Residuals of all traces."""
    rows: list[dict[str, Any]] = []
    squares, count = 0.0, 0
    for problem, optimum in pairs:
        binned = problem.predict(optimum.solution.parameters, optimum.arms)[0] - problem.force
        for index, (trace, own) in enumerate(problem.by_trace(binned)):
            raw, time = trace.trace.force_N[trace.inside], trace.trace.time_s[trace.inside]
            model = np.interp(time, trace.motion.time_s, fitted_force(problem, optimum, index))
            worst = int(np.argmax(np.abs(own)))
            squares, count = squares + float(((raw - model) ** 2).sum()), count + len(raw)
            rows.append(
                {
                    "file": trace.trace.name,
                    "velocity_mm_s": trace.velocity_mm_s,
                    "depth_mm": trace.ramp.depth_mm,
                    "steady_force_N": trace.steady_force_N,
                    "peak_force_N": float(trace.force_N.max()),
                    "fitted_peak_force_N": float(model.max()),
                    "rmse_N": float(np.sqrt(np.mean((raw - model) ** 2))),
                    "max_residual_N": float(abs(own[worst])),
                    "max_residual_time_s": float(trace.middle_s[worst] - trace.ramp.contact_time_s),
                }
            )
    return {
        "rmse_N": float(np.sqrt(squares / count)),
        "max_residual_N": max(row["max_residual_N"] for row in rows),
        "by_trace": rows,
    }


def heldout_rmse(problem: TissueProblem, optimum: Optimum) -> float | None:
    """Rms over the bins of conditions (speed and depth) left out of the fit one after another. [N]"""
    conditions = [{id(trace) for trace in group} for _, _, group in condition_groups(problem.traces)]
    if len(conditions) < 3:
        return None
    low, high = problem.box(optimum.arms)
    owner = np.repeat(np.arange(len(problem.traces)), [len(trace.force_N) for trace in problem.traces])
    squares, count = 0.0, 0
    for members in conditions:
        out = np.array([id(trace) in members for trace in problem.traces])
        left = [sum(id(t) not in members for t in group) for group in problem.groups]
        if min(left) == 0:
            continue
        factor = optimum.factor.copy()
        factor[out] = 0.0
        solution = solve(problem.model(optimum.arms, factor), [optimum.solution.parameters], low, high, 1e-6)
        error = problem.predict(solution.parameters, optimum.arms)[0] - problem.force
        squares, count = squares + float((error[out[owner]] ** 2).sum()), count + int(out[owner].sum())
    return float(np.sqrt(squares / count)) if count else None


def residual_table(pairs: Sequence[tuple[TissueProblem, Optimum]]) -> str:
    """CSV of all bins: file, time since contact, displacement, force, fitted force, residual."""
    rows: list[list[str]] = []
    for problem, optimum in pairs:
        fitted = problem.predict(optimum.solution.parameters, optimum.arms)[0]
        for trace, model in problem.by_trace(fitted):
            since = trace.middle_s - trace.ramp.contact_time_s
            columns = zip(since, trace.depth_mm, trace.force_N, model, trace.force_N - model)
            rows += [[trace.trace.name, *(f"{number:.6g}" for number in row)] for row in columns]
    head = ("file", "time_since_contact_s", "displacement_mm", "force_N", "fitted_N", "residual_N")
    return csv_text(head, rows)
