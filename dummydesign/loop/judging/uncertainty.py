"""How well the parameters of a fit are known: the covariance that its 95 % intervals are made with.

Three things beside the curvature at the optimum: the sizes of law error and contact scatter are estimated from a few
pads and trials (Student's t, see :mod:`dummydesign.loop.fitting.size_likelihood`); noise that is larger than taken
(Birge's ratio); and a model that misfits, whose error is shared by all bins of a press, so that bins are not so many
witnesses. The last shows in how much the parameters change when conditions are left out (jackknife).

References
----------
Birge, Phys. Rev. 40 (1932) 207; Efron, The Jackknife, the Bootstrap and Other Resampling Plans, SIAM (1982), ch. 3.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import Fit, size_likelihood
from dummydesign.loop.fitting.size_likelihood import student_over_normal
from dummydesign.loop.judging.left_out import leave_out

MISFIT = 1.5
"""Lack of fit over the pure error of repeats, a ratio of variances, above which a model is taken to misfit."""


def widened(found: Fit, lack_ratio: float | None = None) -> NDArray:
    """Covariance (n, n) of a fit's vector, scaled so that 1.96 standard deviations are its 95 % interval.

    Parameters
    ----------
    found : Fit
        One that was joined with a prior has it already.
    lack_ratio : float, optional
        Lack of fit; above one it widens the covariance, above :data:`MISFIT` the jackknife's is added.
    """
    if found.joined:
        return found.covariance
    fixed = found.problem.fixed
    likelihood = size_likelihood(found)
    degrees, _ = likelihood.degrees(found.sizes)
    variances = likelihood.variances(np.array([found.sizes.noise.position_mm, *found.sizes.law]))
    plain = np.diag(found.covariance)[:fixed]
    factor = np.ones(len(found.vector))
    known = plain > 0.0
    factor[:fixed][known] = np.sqrt(variances[known] / plain[known]) * student_over_normal(degrees[known])
    covariance = found.covariance * np.outer(factor, factor) * max(1.0, lack_ratio or 1.0)
    if lack_ratio is not None and lack_ratio > MISFIT:
        covariance = covariance + jackknife(found)
    return 0.5 * (covariance + covariance.T)


def jackknife(found: Fit) -> NDArray:
    """Covariance (n, n) of a fit's vector from leaving out one condition at a time; zero for fewer than three."""
    changes = np.array([*leave_out(found, found.problem.presses.cell).values()])
    if len(changes) < 3:
        return np.zeros_like(found.covariance)
    apart = changes - changes.mean(axis=0)
    return (len(changes) - 1) / len(changes) * apart.T @ apart


def pad_spreads(found: Fit) -> tuple[float, ...]:
    """Standard deviations from pad to pad of the law's level, slope and curvature, scaled like :func:`widened`."""
    _, degrees = size_likelihood(found).degrees(found.sizes)
    level, slope, curve = (np.array(found.sizes.law) * student_over_normal(degrees[1:])).tolist()
    return level, slope, curve
