"""What is expected of a design over the resin's modulus: its map of scores, averaged along the ratio.

A casting whose modulus is off is, nearly, a casting of another ratio: modulus and relaxation move together. So the mean
over castings of a design is a weighted mean of the row of the map that it stands in. Exact castings of the leading
designs decide afterwards (:mod:`dummydesign.design.expected.expectation`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin

QUANTILES = (np.arange(9) + 0.5) / 9.0
DRAWS = 400


def averaging(resin: Resin, ratio: NDArray) -> NDArray:
    """Weights (R, R) of the ratios whose modulus the castings of each ratio may have; every row sums to 1.

    Moduli beyond the ends count at the ends.

    Parameters
    ----------
    resin : Resin
    ratio : ndarray, shape (R,)
        Rising.
    """
    count = len(ratio)
    if count < 2:
        return np.eye(count)
    drawn = resin.draw(DRAWS)
    moduli = np.array([np.log(np.maximum(drawn.young_MPa(value), 1e-12)) for value in ratio])
    spread = np.quantile(moduli, QUANTILES, axis=1).T
    central = np.log(resin.young_MPa(ratio))
    # the draws' median may lie off the central law: what counts here is their spread about it
    spread += (central - np.median(moduli, axis=1))[:, None]
    order = np.argsort(central)
    place = np.interp(spread, central[order], np.arange(count)[order].astype(float))
    left = np.minimum(place.astype(int), count - 2)
    share = place - left
    weights = np.zeros((count, count))
    rows = np.arange(count)[:, None]
    np.add.at(weights, (rows, left), (1.0 - share) / len(QUANTILES))
    np.add.at(weights, (rows, left + 1), share / len(QUANTILES))
    return weights
