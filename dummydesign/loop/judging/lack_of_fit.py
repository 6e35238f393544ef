"""Lack of fit against pure error: what repeats share against what they do not."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.inference.noise import Bins
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.noise import contrasts

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

    def to_dict(self) -> dict[str, Any]:
        """Return ratio, p value and number of pairs."""
        return asdict(self)


def lack_of_fit(found: Fit, seed: int = 0) -> LackOfFit:
    """Test a fit against the pure error of repeats."""
    presses = found.problem.presses
    parts, places = contrasts(presses, found.residual)
    if len(parts) < 3:
        return LackOfFit(None, None, len(parts))
    bins = Bins(parts)
    sums, slopes = np.zeros(bins.used.shape), np.zeros(bins.used.shape)
    for row, (i, j, a, b) in enumerate(places):
        sums[row, : len(a)] = (found.residual[i, a] + found.residual[j, b]) / np.sqrt(2.0)
        slopes[row, : len(a)] = 0.5 * (found.slope[i, a] + found.slope[j, b])
    differences = bins.stacked(np.concatenate([part.force_N for part in parts]))
    factor = np.linalg.inv(np.linalg.cholesky(bins.covariance(found.sizes.noise, slopes)))
    count = bins.used.sum(axis=1)
    shared = ((factor @ sums[..., None])[..., 0] ** 2).sum(axis=1)
    pure = ((factor @ differences[..., None])[..., 0] ** 2).sum(axis=1)
    freedom = max(count.sum() - len(found.vector), 1)
    ratio = float(shared.sum() / freedom / (pure.sum() / count.sum()))
    excess = (shared - pure) / count
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], size=(DRAWS, len(excess)))
    beyond = int((signs @ excess >= excess.sum() - 1e-12).sum())
    return LackOfFit(ratio, (1 + beyond) / (DRAWS + 1), len(parts))
