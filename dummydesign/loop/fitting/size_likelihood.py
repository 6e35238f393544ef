"""Likelihood of contact scatter and law error at an optimum, and what their own uncertainty does to the intervals.

The fit is linearised: residual = X b + Z u + noise, X the sensitivities to what is fitted, Z those to the contact
shift of each trial and to the law error of each pad, u normal with four sizes s. The sizes are estimated by restricted
likelihood with priors. A few pads do not say well how pads scatter, and an interval that takes the estimate for the
truth is too narrow: the variance v of a parameter has a distribution of its own, and its 95 % interval is that of
Student's t with

    degrees = 2 v^2 / (g' S g),  g = dv / d ln s,  S = covariance of ln s,

which for pads that differ by a level alone is exactly the number of pads minus one.

References
----------
Patterson and Thompson, Biometrika 58 (1971) 545 (restricted maximum likelihood);
Satterthwaite, Biometrics Bull. 2 (1946) 110; Giesbrecht and Burns, Biometrics 41 (1985) 477 (the degrees).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.inference.noise import Noise, likeliest
from dummydesign.loop.fitting.noise import POSITION_PRIOR_MM, SIZE_BOUNDS, Priors, Sizes

NORMAL_95 = 1.959964
LEAST_DEGREES = 2.0
"""The expansion does not hold for fewer; the priors on the sizes keep them above, but for a handful of trials."""
STEP = 0.05


@dataclass(frozen=True)
class SizeLikelihood:
    """Minus twice the log likelihood of contact scatter and law error.

    Attributes
    ----------
    gram : ndarray, shape (1 + p + t + 3 h, ...)
        Inner products of [residual | sensitivities | contact shift of each trial | law level | slope | curvature
        per thickness], whitened with white and slow noise only; the residual is that without law error and shifts.
    counts : (p, t, h, h, h)
        Numbers of columns.
    law_priors : tuple of (median, spread of the logarithm)
        Of the law error's three terms.
    """

    gram: NDArray
    counts: tuple[int, ...]
    law_priors: Priors

    def estimate(self, sizes: Sizes) -> tuple[Sizes, float]:
        """Likeliest sizes, and minus twice the log likelihood there.

        Parameters
        ----------
        sizes : Sizes
            Former sizes, the start; white and slow noise are kept.

        Returns
        -------
        Sizes
        float
            With the random columns integrated out, the fixed ones at their best, plus the penalties of the priors;
            without the constant of the white and slow noise.
        """
        terms = self._terms()
        begin = np.array([max(sizes.noise.position_mm, 1e-3), *sizes.law])
        found = likeliest(lambda z: self._score(terms, z, True), begin, *SIZE_BOUNDS, gradient=True)[0]
        position, *law = found.tolist()
        noise = Noise(sizes.noise.white_N, sizes.noise.slow_N, sizes.noise.slow_time_s, position)
        return Sizes(noise, *law), self._score(terms, found, False)[0]

    def variances(self, sizes: NDArray) -> NDArray:
        """Variances (p,) of the fitted parameters for given sizes (4,), random columns integrated out."""
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

    def degrees(self, sizes: Sizes) -> tuple[NDArray, NDArray]:
        """Degrees of freedom of the variances of the fitted parameters (p,), and of the four sizes squared (4,).

        Parameters
        ----------
        sizes : Sizes
            As estimated.
        """
        at = np.clip(np.array([sizes.noise.position_mm, *sizes.law]), *SIZE_BOUNDS)
        terms = self._terms()
        steps = np.exp(STEP * np.eye(len(at)))
        sides = [(at * step, at / step) for step in steps]
        bend = np.stack([self._score(terms, up, True)[1] - self._score(terms, down, True)[1] for up, down in sides])
        bend = 0.25 * (bend + bend.T) / STEP
        # of -2 ln L, whose second derivative is twice the inverse covariance; flat or upward where a size is unseen
        values, turn = np.linalg.eigh(bend)
        priors = np.array([POSITION_PRIOR_MM[1], *(spread for _, spread in self.law_priors)])
        values = np.maximum(values, 2.0 / priors.max() ** 2)
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
        p = self.counts[0]
        gram = self.gram
        fixed = gram[: 1 + p, : 1 + p][1:, 1:] + np.diag(1e-9 * np.diag(gram)[1 : 1 + p] + 1e-12)
        others = np.r_[0, np.arange(1 + p, len(gram))]
        cross = gram[1 : 1 + p][:, others]
        rest = gram[np.ix_(others, others)] - cross.T @ np.linalg.solve(fixed, cross)
        return float(rest[0, 0]), rest[1:, 0], rest[1:, 1:], gram[1 + p :, 1 + p :]

    def _score(
        self, terms: tuple[float, NDArray, NDArray, NDArray], sizes: NDArray, restricted: bool
    ) -> tuple[float, NDArray]:
        """Minus twice the log likelihood, and (restricted) its gradient in the logarithms of the sizes."""
        total, inner, cleaned, random = terms
        groups = self._groups()
        medians, spreads = np.array((POSITION_PRIOR_MM, *self.law_priors)).T
        eye, scale, logs = np.eye(len(random)), sizes[groups], np.log(sizes)
        # in units of the scale the matrix is 1 + S R S, which is never singular
        inverse = np.linalg.inv(eye + scale[:, None] * cleaned * scale)
        pull = inverse @ (scale * inner)
        chi2 = total - (scale * inner) @ pull
        spectrum = cleaned if restricted else random
        volume = np.linalg.slogdet(eye + scale[:, None] * spectrum * scale)[1]
        prior = (logs - np.log(medians)) / spreads
        each = -2.0 * pull**2 + 2.0 * (1.0 - np.diag(inverse))
        return float(chi2 + volume + prior @ prior), np.bincount(groups, each) + 2.0 * prior / spreads


def student_over_normal(degrees: NDArray) -> NDArray:
    """97.5 % quantile of Student's t over that of the normal distribution."""
    from scipy.stats import t

    return t.ppf(0.975, np.asarray(degrees, float)) / NORMAL_95
