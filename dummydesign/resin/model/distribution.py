"""A number with an interval as a distribution, so that what is not known can be drawn."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.quantity import Quantity

HALF_WIDTH = 1.959963984540054
"""Standard deviations from the median to either end of a 95 % interval."""


def value_at(quantity: Quantity, z: ArrayLike) -> NDArray:
    """Map standard normal deviates to values of a quantity, so that its ``value`` is the median.

    Measured, fitted, digitised and inferred numbers: low and high are the ends of a 95 % interval, each
    side with its own width (two-piece normal; of the logarithm when low > 0, since moduli and times
    scatter by factors). Assumed numbers: low and high are the ends of the plausible range; half of the
    probability lies evenly between low and value, half between value and high.

    Parameters
    ----------
    quantity : Quantity
        Value with interval and kind.
    z : array_like, any shape
        Standard normal deviates.

    Returns
    -------
    ndarray, shape of ``z``
        Values in the unit of the quantity.
    """
    z = np.asarray(z, dtype=float)
    value, low, high = quantity.value, quantity.low, quantity.high
    if low == high:
        return np.full(z.shape, value)
    if quantity.kind == "assumed":
        share = 0.5 * (1.0 + np.vectorize(math.erf, otypes=[float])(z / math.sqrt(2.0)))
        return np.where(share < 0.5, low + (value - low) * 2.0 * share, value + (high - value) * (2.0 * share - 1.0))
    if low > 0:
        width = np.where(z > 0, math.log(high / value), math.log(value / low)) / HALF_WIDTH
        return value * np.exp(width * z)
    width = np.where(z > 0, high - value, value - low) / HALF_WIDTH
    return value + width * z
