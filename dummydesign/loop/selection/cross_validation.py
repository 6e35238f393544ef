"""Errors on what was left out, uncertainty of parameters, lack of fit, and a fitted model with all of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Bins, whitener
from dummydesign.loop.fitting.fit import NORMAL_95, CampaignFit, prior_precision, size_likelihood
from dummydesign.loop.fitting.noise import UNSEEN, contrasts, repeat_scatter
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.forward_model import SMOOTH_TERMS, base_names

ESTIMABLE = 0.2  # a cell counts when the rest still holds this share of the information on an effect's size

LARGEST = (0.01, 0.005)
"""Largest scatter of presses in contact [mm] and gain that is taken for usual."""


@dataclass(frozen=True)
class Errors:
    """Root mean square residuals."""

    train_N: float
    heldout_N: float | None
    by_trial_N: NDArray
    heldout_by_trial_N: NDArray


def _squares(fit: CampaignFit) -> tuple[NDArray, NDArray]:
    """Per bin: mean and sum of squares of the raw residual, both (T, B)."""
    presses = fit.problem.presses
    modelled = fit.problem.at_samples(fit.vector)
    mean, total = (np.zeros(presses.used.shape) for _ in range(2))
    for row, (press, trial, model) in enumerate(zip(presses.presses, presses.trials, modelled)):
        residual, size = trial.trace.force_N - model, len(press.samples)
        mean[row, :size] = press.mean(residual)
        total[row, :size] = np.bincount(press.bin_index, residual[press.inside] ** 2)
    return mean, total


def errors(fit: CampaignFit, cells: NDArray | None = None) -> Errors:
    """Errors of a fit; every cell is left out once and predicted by the fit to the rest, linearised.

    delta = -(N - N_S + P)^-1 g_S with N the normal matrix, S the cell, P the prior of the law error.
    """
    presses = fit.problem.presses
    if cells is None:
        cells = presses.cell if np.any(presses.cell != presses.cell[0]) else np.arange(len(presses.cell))
    mean, total = _squares(fit)
    counted = presses.samples.sum(axis=1)
    by_trial = np.sqrt(total.sum(axis=1) / counted)
    train = float(np.sqrt(total.sum() / counted.sum()))
    changes = leave_out(fit, cells)
    heldout = np.full(len(cells), np.nan)
    for cell, change in changes.items():
        for row in np.nonzero(cells == cell)[0]:
            moved = fit.jacobian[row] @ change
            square = total[row].sum() + (presses.samples[row] * moved * (moved - 2.0 * mean[row])).sum()
            heldout[row] = np.sqrt(max(square, 0.0) / counted[row])
    use = np.isfinite(heldout)
    value = float(np.sqrt((heldout[use] ** 2 * counted[use]).sum() / counted[use].sum())) if use.any() else None
    return Errors(train, value, by_trial, heldout)


def expected_heldout_N(fit: CampaignFit) -> float:
    """Error on left-out conditions when nothing is missing: noise, scatter of presses, uncertainty of parameters. [N]

    Scatter of presses counts as far as repeats show it and a test machine has it: more is a sign of a missing effect.
    """
    presses, noise = fit.problem.presses, fit.sizes.noise
    weight = presses.samples * presses.used
    shown = repeat_scatter(presses, fit.residual, fit.slope, fit.forces, noise) or UNSEEN
    position, gain = (min(each) for each in zip(fit.sizes.scatter, shown, LARGEST))
    spread = ((fit.jacobian @ fit.covariance) * fit.jacobian).sum(axis=-1)
    spread += (position * fit.slope) ** 2 + (gain * fit.forces) ** 2
    return float(np.sqrt(fit.sizes.floor_N**2 + np.average(spread, weights=weight)))


def leave_out(fit: CampaignFit, cells: NDArray) -> dict[int, NDArray]:
    """Change of the vector when each cell is left out; cells without which an effect is not known are missing."""
    problem = fit.problem
    turned, white = fit.whitened_jacobian, fit.whitener(fit.residual)
    normal = np.swapaxes(turned, 1, 2) @ turned
    gradient = np.einsum("tbi,tb->ti", turned, white)
    prior = np.diag(prior_precision(problem, fit.sizes) + 1e-9)
    low, high = problem.bounds()
    pinned = (fit.vector <= low + 1e-9) | (fit.vector >= high - 1e-9)
    pinned[problem.frozen()] = True
    free = ~pinned
    full = (normal.sum(axis=0) + prior)[np.ix_(free, free)]
    sizes = [i for i, at in enumerate(np.nonzero(free)[0]) if problem.base_count <= at < problem.fixed]
    variance = np.diag(np.linalg.inv(full))
    changes = {}
    for cell in np.unique(cells):
        out = cells == cell
        change = np.zeros(len(fit.vector))
        if out.all():  # of a single pad only the error of its law can be left out
            others = np.nonzero(free)[0] < problem.fixed
            change[problem.fixed :] = -fit.vector[problem.fixed :]
            pull = full[np.ix_(others, ~others)] @ change[free][~others]
            change[np.flatnonzero(free)[others]] = -np.linalg.solve(full[np.ix_(others, others)], pull)
            changes[int(cell)] = change
            continue
        rest = full - normal[out].sum(axis=0)[np.ix_(free, free)]
        try:
            inverse = np.linalg.inv(rest)
        except np.linalg.LinAlgError:
            continue
        kept = variance / np.maximum(np.diag(inverse), 1e-300)
        if np.any(np.diag(inverse) <= 0) or any(kept[i] < ESTIMABLE for i in sizes):
            continue
        change[free] = -inverse @ gradient[out].sum(axis=0)[free]
        changes[int(cell)] = change
    return changes


SIZE_ERROR = 0.01
"""Relative standard deviation of what the law of an effect is off in its size: no instrument or force law is better."""
MISFIT = 1.5  # lack of fit over the pure error of repeats, a ratio of variances, above which a model is taken to misfit


def student_over_normal(degrees: NDArray) -> NDArray:
    """97.5 % quantile of Student's t over that of the normal distribution."""
    from scipy.special import stdtrit

    return np.asarray(stdtrit(np.asarray(degrees, float), 0.975)) / NORMAL_95


def widened(fit: CampaignFit, lack_ratio: float | None = None) -> NDArray:
    """Covariance (n, n) of a fit's vector, scaled so that 1.96 standard deviations are its 95 % interval."""
    if fit.joined:  # widened before it was joined
        return fit.covariance
    fixed = fit.problem.fixed
    likelihood = size_likelihood(fit)
    degrees, _ = likelihood.degrees(fit.sizes)
    variances = likelihood.variances(fit.sizes.fitted)
    plain = np.diag(fit.covariance)[:fixed]
    factor = np.ones(len(fit.vector))
    known = plain > 0.0
    factor[:fixed][known] = np.sqrt(variances[known] / plain[known]) * student_over_normal(degrees[known])
    covariance = fit.covariance * np.outer(factor, factor) * max(1.0, lack_ratio or 1.0)
    if lack_ratio is not None and lack_ratio > MISFIT:
        covariance = covariance + jackknife(fit)
    if fit.doubt is not None:
        covariance[: len(fit.doubt), : len(fit.doubt)] += fit.doubt
    for effect in fit.problem.effects:
        if not effect.held:
            size = fit.problem.entries[effect.name][0]
            covariance[size, size] += (SIZE_ERROR * fit.vector[size]) ** 2
    return 0.5 * (covariance + covariance.T)


def jackknife(fit: CampaignFit) -> NDArray:
    """Covariance (n, n) of a fit's vector from leaving out one condition at a time; zero for fewer than three."""
    changes = np.array([*leave_out(fit, fit.problem.presses.cell).values()])
    if len(changes) < 3:
        return np.zeros_like(fit.covariance)
    differences = changes - changes.mean(axis=0)
    return (len(changes) - 1) / len(changes) * differences.T @ differences


def pad_spreads(fit: CampaignFit) -> tuple[float, ...]:
    """Standard deviations from pad to pad of the law's level, slope and curvature, scaled like :func:`widened`."""
    _, degrees = size_likelihood(fit).degrees(fit.sizes)
    return tuple((np.array(fit.sizes.law) * student_over_normal(degrees[2:])).tolist()[:SMOOTH_TERMS])


DRAWS = 4000


@dataclass(frozen=True)
class LackOfFit:
    """Ratio of the mean square of repeats' means to that of their differences, and its p value.

    ``p`` is from sign changes: without model error the sum and the difference of a pair are exchangeable,
    whatever the noise is like. None without repeats.
    """

    ratio: float | None
    p: float | None
    pairs: int


def lack_of_fit(fit: CampaignFit) -> LackOfFit:
    """Test a fit against the pure error of repeats."""
    presses = fit.problem.presses
    parts, places = contrasts(presses, fit.residual)
    if len(parts) < 3:
        return LackOfFit(None, None, len(parts))
    bins = Bins(parts)
    both = [[values[i, a] + values[j, b] for i, j, a, b in places] for values in (fit.residual, fit.slope)]
    sums, slopes = bins.stacked(np.concatenate(both[0])) / np.sqrt(2.0), 0.5 * bins.stacked(np.concatenate(both[1]))
    differences = bins.stacked(np.concatenate([part.force_N for part in parts]))
    factor = whitener(bins.covariance(fit.sizes.noise, slopes))
    count = bins.used.sum(axis=1)
    shared = ((factor @ sums[..., None])[..., 0] ** 2).sum(axis=1)
    pure = ((factor @ differences[..., None])[..., 0] ** 2).sum(axis=1)
    freedom = max(count.sum() - len(fit.vector), 1)
    ratio = float(shared.sum() / freedom / (pure.sum() / count.sum()))
    excess = (shared - pure) / count
    signs = np.random.default_rng(0).choice([-1.0, 1.0], size=(DRAWS, len(excess)))
    beyond = int((signs @ excess >= excess.sum() - 1e-12).sum())
    return LackOfFit(ratio, (1 + beyond) / (DRAWS + 1), len(parts))


@dataclass(frozen=True)
class AssessedModel:
    """A model with its errors (``by_pad`` with all trials on one pad left out at a time, and with them its law error;
    of a single pad that error alone) and its lack of fit."""

    fit: CampaignFit
    errors: Errors
    by_pad: Errors
    lack: LackOfFit

    @cached_property
    def covariance(self) -> NDArray:
        """Covariance of the fit's vector, see :func:`widened`."""
        return widened(self.fit, self.lack.ratio)

    def to_dict(self) -> dict[str, Any]:
        """Parameters with 95 % intervals, and errors."""
        return {
            "parameters": base_intervals(self.fit, self.covariance),
            "error": {
                "train_rmse_N": self.errors.train_N,
                "heldout_rmse_N": self.errors.heldout_N,
                "heldout_pad_rmse_N": self.by_pad.heldout_N if len(self.fit.problem.presses.pads) > 1 else None,
                "noise_floor_N": self.fit.sizes.floor_N,
                "lack_of_fit_p": self.lack.p,
                "lack_of_fit_ratio": self.lack.ratio,
            },
            "noise": self.fit.sizes.to_dict(),
        }


def assess(fit: CampaignFit) -> AssessedModel:
    """Work out errors and lack of fit of a model."""
    return AssessedModel(fit, errors(fit), errors(fit, fit.problem.presses.pad), lack_of_fit(fit))


DECADES = 100.0
"""Ratio of the ends of an interval above which the campaign does not determine the parameter."""


def interval(fit: CampaignFit, covariance: NDArray, index: int, to_value: Callable[[float], float]) -> dict[str, Any]:
    """Value with its 95 % interval."""
    low, high = fit.problem.bounds()
    at, spread = fit.vector[index], NORMAL_95 * float(np.sqrt(max(covariance[index, index], 0.0)))
    ends = sorted((to_value(max(at - spread, low[index])), to_value(min(at + spread, high[index]))))
    bound = bool(at <= low[index] + 1e-6 or at >= high[index] - 1e-6)
    known = not (ends[0] > 0.0 and ends[1] > DECADES * ends[0])
    return {"value": to_value(at), "low": ends[0], "high": ends[1], "at_bound": bound, "determined": known}


def base_intervals(fit: CampaignFit, covariance: NDArray) -> dict[str, Any]:
    """Base parameters with 95 % intervals; modulus in kPa."""
    young, *arms = (interval(fit, covariance, at, lambda z: float(np.exp(z))) for at in range(fit.problem.base_count))
    ends = {key: 1e3 * young[key] for key in ("value", "low", "high")}
    return dict(zip(base_names(fit.problem.prior.arms), ({**young, **ends}, *arms)))


def effect_intervals(model: AssessedModel, effect: Effect) -> dict[str, Any]:
    """Parameters of one fitted effect of a model with 95 % intervals, widened by its lack of fit."""
    fit, entries = model.fit, model.fit.problem.entries[effect.name]
    intervals = {p.name: interval(fit, model.covariance, at, p.to_value) for p, at in zip(effect.parameters, entries)}
    if holds_null(model, effect):  # the interval reaches over all decades
        intervals[effect.parameters[0].name]["determined"] = False
    return intervals


def holds_null(model: AssessedModel, effect: Effect) -> bool:
    """Whether the interval of an effect's size holds the value at which the effect is absent."""
    size = effect.parameters[0]
    one = interval(model.fit, model.covariance, model.fit.problem.entries[effect.name][0], size.to_value)
    return bool(one["low"] <= size.null <= one["high"]) and not effect.held
