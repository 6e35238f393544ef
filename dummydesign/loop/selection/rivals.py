"""What a modulus owes to the choice of the model: rivals that the campaign does not separate, and the law itself."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import CampaignFit
from dummydesign.loop.fitting.problem import BASE
from dummydesign.loop.selection.verdict import EACH_PARAMETER, at_bound

LAW_ERROR = 0.004
"""Relative standard deviation of what a force law is off on all pads of a shape alike: slabs differ from GetFEM's by
0.1 to 0.4 %, and pads of one shape do not average it out."""


Rival = tuple[float, CampaignFit]
"""Evidence of a model over that of the chosen one, with the same noise, and its fit."""


def doubt_of(chosen: CampaignFit, rivals: Iterable[Rival]) -> NDArray:
    """Covariance (5, 5) of the base logarithms over rival models, and the law's error in the modulus.

    A rival weighs exp(evidence / 2) of the chosen model, less :data:`EACH_PARAMETER` for each named parameter more; its
    own covariance counts as well.
    """
    rows = [(gain - EACH_PARAMETER * (_named(one) - _named(chosen)), one) for gain, one in rivals if not at_bound(one)]
    weights = np.exp(0.5 * np.array([0.0, *(gain for gain, _ in rows)]).clip(-60.0, 60.0))
    out = np.zeros((BASE, BASE))
    for weight, (_, one) in zip((weights / weights.sum())[1:], rows):
        apart = one.vector[:BASE] - chosen.vector[:BASE]
        out += weight * (np.outer(apart, apart) + one.covariance[:BASE, :BASE])
    out[0, 0] += LAW_ERROR**2
    return out


def doubt_of_curve(flat: NDArray) -> NDArray:
    """Covariance (5, 5) of the base logarithms beside a learned curve with these values: both share their level."""
    out = np.zeros((BASE, BASE))
    out[0, 0] = LAW_ERROR**2 + float(np.abs(flat).max()) ** 2
    return out


def _named(fit: CampaignFit) -> int:
    return sum(not p.of_form for one in fit.problem.effects if not one.held for p in one.parameters)
