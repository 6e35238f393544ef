"""What in a campaign is noise: white and slow noise from repeats, scatter of presses, error of the force law.

The slow noise is estimated from differences of repeats from which a shift in depth and a change of scale
are taken out, so that neither model error nor effects that change from trial to trial count as noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Bins, Noise, likeliest, restricted_likelihood, whitener
from dummydesign.loop.data.reduction import HOLD, UNLOADING
from dummydesign.loop.data.trials import Presses

POSITION_PRIOR_MM = (0.008, 1.0)
"""Median and spread (of the logarithm) of the contact scatter; that of the law's error belongs to the law."""
GAIN_PRIOR = (5e-4, 1.0)
"""Median and spread of the scatter of a press's whole force about that of its repeats."""
SLOW_BOUNDS = np.array([[1e-4, 0.05], [5.0, 20.0]])  # lowest and highest slow noise [N] and time of it [s]
STEADY = 1e-4
"""Slow noise over the largest force, at least: load cells creep by up to 2.5e-4 of their load (OIML R 60, class C3)."""
MOST = (0.5, 0.1)
"""Largest scatter of presses in contact [mm] and gain where repeats do not bound it."""
SIZE_BOUNDS = np.array([[3e-4, 5e-5, 3e-4, 3e-4, 3e-4, 1e-4], [*MOST, 0.2, 0.3, 0.3, 0.01]])
"""Lowest and highest scatter of presses in contact [mm] and gain, and law error in level, slope, curvature, waves."""
UNSEEN = (POSITION_PRIOR_MM[0], GAIN_PRIOR[0])
"""Scatter of contact [mm] and gain that is taken for usual where repeats do not show it."""
CHI2_MEDIAN = 0.4549  # median of the chi-square distribution of one degree of freedom
Priors = tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class NoiseSizes:
    """Noise of the bins, the prior sizes of the law's error (level, slope, curvature, waves), the scatter of presses in
    gain, and the largest scatter in contact [mm] and gain that repeats allow."""

    noise: Noise
    law: tuple[float, ...]
    gain: float = 0.0
    most: tuple[float, float] = MOST

    @classmethod
    def first(cls, presses: Presses, law_priors: Priors) -> NoiseSizes:
        """Sizes to start from: white noise as measured, the rest at the middle of the priors."""
        white = float(np.sqrt(np.mean([press.white_N**2 for press in presses.presses])))
        return cls(Noise(white, 0.6 * white, 1.0, POSITION_PRIOR_MM[0]), tuple(median for median, _ in law_priors))

    @property
    def scatter(self) -> tuple[float, float]:
        """Scatter of presses in contact [mm] and gain."""
        return self.noise.position_mm, self.gain

    @property
    def fitted(self) -> NDArray:
        """The sizes that are estimated with a fit: of the presses, of the law."""
        return np.array([*self.scatter, *self.law])

    def to_dict(self) -> dict[str, Any]:
        """Return all sizes with units."""
        law = zip(("law_level", "law_slope", "law_curve", "law_wave"), self.law)
        return {**self.noise.to_dict(), "gain": self.gain, **dict(law)}

    @property
    def floor_N(self) -> float:
        """Standard deviation of the noise of one raw sample: white and slow. [N]"""
        return float(np.hypot(self.noise.white_N, self.noise.slow_N))


def repeat_pairs(presses: Presses) -> list[tuple[int, int]]:
    """Neighbouring repeats of each condition, as pairs of trial indices."""
    pairs = []
    for cell in np.unique(presses.cell):
        same = np.nonzero(presses.cell == cell)[0]
        same = same[np.argsort(presses.history.repeat[same], kind="stable")]
        pairs += [(int(a), int(b)) for a, b in pairwise(same)]
    return pairs


@dataclass(frozen=True)
class _Part:
    """Edges and counts of some bins of a trial, as :class:`Bins` wants them."""

    start_s: NDArray
    end_s: NDArray
    samples: NDArray
    force_N: NDArray


def contrasts(presses: Presses, residual: NDArray) -> tuple[list[_Part], list[tuple[int, int, NDArray, NDArray]]]:
    """Differences of repeats over sqrt 2 on bins that both have, before the unloading."""
    parts, places = [], []
    for first, second in repeat_pairs(presses):
        labels = []
        for trial in (first, second):
            use = presses.used[trial] & (presses.label[trial] < 100 * UNLOADING)
            labels.append(np.where(use, presses.label[trial], -1 - trial))
        _, a, b = np.intersect1d(labels[0], labels[1], return_indices=True)
        if len(a) < 10:
            continue
        press = presses.presses[first]
        order = np.argsort(a)
        a, b = a[order], b[order]
        difference = (residual[first, a] - residual[second, b]) / np.sqrt(2.0)
        samples = 2.0 / (1.0 / presses.samples[first, a] + 1.0 / presses.samples[second, b])
        parts.append(_Part(press.start_s[a], press.end_s[a], samples, difference))
        places.append((first, second, a, b))
    return parts, places


def estimate_slow_noise(presses: Presses, residual: NDArray, slope: NDArray, force: NDArray, start: Noise) -> Noise:
    """Size and time of the slow noise by restricted maximum likelihood of repeat differences.

    Without repeats the residuals of the holds themselves are used: then model error counts as noise.
    """
    parts, places = contrasts(presses, residual)
    if parts:
        nuisance = [np.stack([slope[i, a], force[i, a]], axis=1) for i, _, a, _ in places]
    else:
        parts, nuisance = [], []
        for row, press in enumerate(presses.presses):
            use = (press.label >= 100 * HOLD) & (press.label < 100 * UNLOADING)
            left, *changes = (values[row, : len(use)][use] for values in (residual, slope, force))
            parts.append(_Part(press.start_s[use], press.end_s[use], press.samples[use], left))
            nuisance.append(np.stack(changes, axis=1))
    bins = Bins(parts)
    values = bins.stacked(np.concatenate([part.force_N for part in parts]))
    columns = bins.stacked(np.concatenate(nuisance))
    zero = np.zeros_like(values)

    def cost(sizes: NDArray) -> float:
        cover = bins.covariance(Noise(start.white_N, float(sizes[0]), float(sizes[1]), 0.0), zero)
        weak = np.log(sizes[1]) ** 2  # the time is hardly seen in short holds: 1 s within a factor of e
        return restricted_likelihood(cover, values, columns, shared=False, refitted=True) + weak

    begin = np.array([max(start.slow_N, 1e-3), start.slow_time_s])
    low, high = SLOW_BOUNDS
    low = np.array([max(low[0], STEADY * float(presses.force_N.max())), low[1]])
    slow, time = likeliest(cost, begin, low, high)[0].tolist()
    return Noise(start.white_N, slow, time, start.position_mm)


def repeat_scatter(
    presses: Presses, residual: NDArray, slope: NDArray, forces: NDArray, noise: Noise
) -> tuple[float, ...]:
    """Scatter of contact [mm] and gain as differences of repeats show it, by medians so that few cannot make it.

    Each difference is fitted with a shift and a change of scale, of variances v by noise alone; of either the scatter p
    is such that the median of d^2 / (p^2 + v) is that of the chi-square of one degree. A change of scale that follows
    the pad's history is no scatter. Not below half of :data:`UNSEEN`; nothing without three pairs.
    """
    parts, places = contrasts(presses, residual)
    if len(parts) < 3:
        return ()
    bins = Bins(parts)
    difference = bins.stacked(np.concatenate([part.force_N for part in parts]))
    sides = [np.stack([slope[i, a], forces[i, a]], axis=1) for i, _, a, _ in places]
    factor = whitener(bins.covariance(replace(noise, position_mm=0.0), np.zeros(difference.shape)))
    columns, values = factor @ bins.stacked(np.concatenate(sides)), factor @ difference[..., None]
    turned = np.swapaxes(columns, 1, 2)
    inverse = np.linalg.pinv(turned @ columns, hermitian=True)
    found = (inverse @ turned @ values)[..., 0]
    found[:, 1] = _without_history(presses, places, found[:, 1], inverse[:, 1, 1])
    shown = []
    for at, least in enumerate(UNSEEN):
        sizes = np.geomspace(0.5 * least, 1.0, 200)
        ratio = np.median(found[:, at] ** 2 / (sizes[:, None] ** 2 + inverse[:, at, at]), axis=1)
        shown.append(float(sizes[np.argmin(ratio > CHI2_MEDIAN)]))
    return tuple(shown)


def _without_history(presses: Presses, places: Sequence[Any], gains: NDArray, variances: NDArray) -> NDArray:
    """Changes of scale between repeats less what follows ageing, softening or temperature, where one of them explains
    so much that chance would in :data:`BY_CHANCE` of campaigns."""
    from scipy.special import betaincc

    history, first, second = presses.history, *np.array([place[:2] for place in places]).T
    weight = 1.0 / np.sqrt(variances + GAIN_PRIOR[0] ** 2)
    count, best, least = len(gains), gains, BY_CHANCE
    with np.errstate(all="ignore"):
        cycles = 1.0 + np.count_nonzero(history.earlier_depth_mm > 0.0, axis=1)
        drivers = np.log(history.age_days), 1.0 / cycles, history.temperature_C
    for driver in drivers:
        along, wanted = weight * (driver[first] - driver[second]), weight * gains
        if not (np.isfinite(along).all() and along.any() and wanted.any()):
            continue
        left = wanted - along * (along @ wanted) / (along @ along)
        chance = float(betaincc(0.5, 0.5 * (count - 1), 1.0 - (left @ left) / (wanted @ wanted)))
        if chance < least:
            least, best = chance, left / weight * np.sqrt(count / (count - 1))
    return best


BY_CHANCE = 1e-3
Whitener = Callable[[NDArray], NDArray]  # takes (T, B) or (T, B, p) to its whitened form


@lru_cache(maxsize=6)
def _factor(bins: Bins, white_N: float, slow_N: float, slow_time_s: float) -> NDArray:
    """Inverse Cholesky factors of white and slow noise. A search fits many models with the same."""
    return whitener(bins.covariance(Noise(white_N, slow_N, slow_time_s, 0.0), np.zeros(bins.used.shape)))


def volume(presses: Presses, noise: Noise) -> float:
    """Logarithm of the determinant of white and slow noise of all bins."""
    factor = _factor(presses.bins, noise.white_N, noise.slow_N, noise.slow_time_s)
    return float(-2.0 * np.log(np.diagonal(factor, axis1=1, axis2=2)).sum())


def make_whitener(
    presses: Presses, noise: Noise, directions: Sequence[NDArray] = (), sizes: Sequence[float] = ()
) -> Whitener:
    """Whitening by the noise of the bins, and by scatter of presses of these sizes along directions (T, B) in newton.

    A scatter p is one direction u of each trial's bins, whitened by all before it:
    (1 + p^2 u u')^(-1/2) = 1 - (1 - (1 + p^2 u'u)^(-1/2)) u u' / u'u.
    """
    factor = _factor(presses.bins, noise.white_N, noise.slow_N, noise.slow_time_s)
    taken: list[tuple[NDArray, NDArray]] = []

    def apply(values: NDArray) -> NDArray:
        white = factor @ (values[..., None] if values.ndim == 2 else values)
        for along, shrink in taken:
            white -= along[..., None] * (shrink[:, None, None] * (along[:, None, :] @ white))
        return white[..., 0] if values.ndim == 2 else white

    for direction, size in zip(directions, sizes):
        along = apply(np.where(presses.used, direction, 0.0))
        length = (along**2).sum(axis=1)
        taken.append((along, -np.expm1(-0.5 * np.log1p(size**2 * length)) / np.maximum(length, 1e-300)))
    return apply


LEAST_DEGREES = 2.0
"""Fewest for which the expansion holds; the priors on the sizes keep them above, but for a handful of trials."""
STEP = 0.05


@dataclass(frozen=True)
class SizeLikelihood:
    """Minus twice the log likelihood of the scatter of presses and of the law error."""

    gram: NDArray
    counts: tuple[int, ...]
    law_priors: Priors
    most: tuple[float, float] = MOST

    @property
    def bounds(self) -> tuple[NDArray, NDArray]:
        """Lowest and highest sizes."""
        low, high = SIZE_BOUNDS
        return low, np.r_[self.most, high[2:]]

    @property
    def priors(self) -> Priors:
        """Median and spread of the logarithm of each size."""
        return POSITION_PRIOR_MM, GAIN_PRIOR, *self.law_priors

    def estimate(self, sizes: NoiseSizes) -> tuple[NoiseSizes, float]:
        """Likeliest sizes, and minus twice the log likelihood there."""
        terms = self._terms()
        low, high = self.bounds
        begin = np.clip(np.maximum(sizes.fitted, [1e-3, 1e-4, *low[2:]]), low, high)
        likely = likeliest(lambda z: self._score(terms, z, True), begin, low, high, gradient=True)[0]
        position, gain, *law = likely.tolist()
        noise = replace(sizes.noise, position_mm=position)
        return NoiseSizes(noise, tuple(law), gain, self.most), self._score(terms, likely, False)[0]

    def variances(self, sizes: NDArray) -> NDArray:
        """Variances (p,) of the fitted parameters for given sizes, random columns integrated out."""
        p = self.counts[0]
        fixed, cross = self.gram[1 : 1 + p, 1 : 1 + p], self.gram[1 : 1 + p, 1 + p :]
        scale = sizes[self._groups()]
        inner = np.eye(len(scale)) + scale[:, None] * self.gram[1 + p :, 1 + p :] * scale
        turned = cross * scale
        known = fixed - turned @ np.linalg.solve(inner, turned.T)
        length = np.sqrt(np.maximum(np.diag(fixed), 0.0))
        seen = np.where(length > 0.0, length, 1.0)
        inverse = np.linalg.pinv(known / np.outer(seen, seen), rcond=1e-12, hermitian=True)
        return np.where(length > 0.0, np.diag(inverse) / seen**2, 0.0)

    def degrees(self, sizes: NoiseSizes) -> tuple[NDArray, NDArray]:
        """Degrees of freedom of the variances of the fitted parameters (p,), and of the sizes squared."""
        at = np.clip(sizes.fitted, *self.bounds)
        terms = self._terms()
        steps = np.exp(STEP * np.eye(len(at)))
        sides = [(at * step, at / step) for step in steps]
        bend = np.stack([self._score(terms, up, True)[1] - self._score(terms, down, True)[1] for up, down in sides])
        bend = 0.25 * (bend + bend.T) / STEP
        # of -2 ln L, whose second derivative is twice the inverse covariance; flat or upward where a size is unseen
        values, turn = np.linalg.eigh(bend)
        values = np.maximum(values, 2.0 / max(spread for _, spread in self.priors) ** 2)
        covariance = turn @ np.diag(2.0 / values) @ turn.T
        middle = self.variances(at)
        slopes = np.stack([self.variances(up) - self.variances(down) for up, down in sides], axis=1) / (2.0 * STEP)
        spread = np.einsum("pi,ij,pj->p", slopes, covariance, slopes)
        own = 0.5 / np.diag(covariance)
        known = 2.0 * middle**2 / np.maximum(spread, 1e-12 * middle**2 + 1e-300)
        return np.maximum(known, LEAST_DEGREES), np.maximum(own, LEAST_DEGREES)

    def _groups(self) -> NDArray:
        return np.repeat(np.arange(len(self.counts) - 1), self.counts[1:])

    def _terms(self) -> tuple[float, NDArray, NDArray, NDArray]:
        """Squares of the residual, its inner products with the random columns, and theirs: the fixed at their best."""
        p, gram = self.counts[0], self.gram
        fixed = gram[1 : 1 + p, 1 : 1 + p] + np.diag(1e-9 * np.diag(gram)[1 : 1 + p] + 1e-12)
        others = np.r_[0, np.arange(1 + p, len(gram))]
        cross = gram[1 : 1 + p][:, others]
        rest = gram[np.ix_(others, others)] - cross.T @ np.linalg.solve(fixed, cross)
        return float(rest[0, 0]), rest[1:, 0], rest[1:, 1:], gram[1 + p :, 1 + p :]

    def _score(
        self, terms: tuple[float, NDArray, NDArray, NDArray], sizes: NDArray, restricted: bool
    ) -> tuple[float, NDArray]:
        """Minus twice the log likelihood, and (restricted) its gradient in the logarithms of the sizes."""
        from scipy.linalg.lapack import dpotrf, dpotri, dpotrs

        total, inner, cleaned, random = terms
        groups = self._groups()
        medians, spreads = np.array(self.priors).T
        eye, scale, logs = np.eye(len(random)), sizes[groups], np.log(sizes)
        # in units of the scale the matrix is 1 + S R S, which is never singular
        spectra = (cleaned,) if restricted else (cleaned, random)
        lower, *other = (dpotrf(eye + scale[:, None] * one * scale, lower=True)[0] for one in spectra)
        pull = dpotrs(lower, scale * inner, lower=True)[0]
        chi2 = total - (scale * inner) @ pull
        volume = 2.0 * np.log(np.diag([lower, *other][-1])).sum()
        prior = (logs - np.log(medians)) / spreads
        each = -2.0 * pull**2 + 2.0 * (1.0 - np.diag(dpotri(lower, lower=True)[0]))
        return float(chi2 + volume + prior @ prior), np.bincount(groups, each) + 2.0 * prior / spreads
