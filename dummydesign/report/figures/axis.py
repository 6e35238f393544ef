"""Axes of a plot: from values to places, and round numbers to write beside them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

LETTER = 7.0
"""Mean width of a letter of an axis. [px]"""


@dataclass(frozen=True)
class Axis:
    """One axis: label with unit, range of values, places of its ends, linear or logarithmic."""

    label: str
    low: float
    high: float
    start: float
    stop: float
    log: bool = False

    def place(self, value: float) -> float:
        """Place of a value along the axis; values outside are put a little outside."""
        if self.log:
            share = (math.log(max(value, 1e-300)) - math.log(self.low)) / (math.log(self.high) - math.log(self.low))
        else:
            share = (value - self.low) / (self.high - self.low)
        return self.start + min(max(share, -1.0), 2.0) * (self.stop - self.start)

    def places(self, values: NDArray) -> NDArray:
        """:meth:`place` of several values; NaN stays."""
        if self.log:
            share = np.log(np.maximum(values, 1e-300) / self.low) / math.log(self.high / self.low)
        else:
            share = (values - self.low) / (self.high - self.low)
        return self.start + np.clip(share, -1.0, 2.0) * (self.stop - self.start)

    def ticks(self, about: int = 5) -> list[tuple[float, str]]:
        """Round values inside the range and how to write them."""
        if self.log:
            first, last = math.ceil(math.log10(self.low) - 1e-9), math.floor(math.log10(self.high) + 1e-9)
            found = [(10.0**power, _short(10.0**power)) for power in range(first, last + 1)]
            room = abs(self.stop - self.start) / max(len(found), 1)
            return found if room > LETTER * max((len(text) for _, text in found), default=0) else found[::2]
        step = round_step((self.high - self.low) / max(about, 1))
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [(index * step, _short(round(index * step, 12))) for index in range(first, last + 1)]


def round_step(step: float) -> float:
    """The next of 1, 2, 2.5, 5 times a power of ten that is not below ``step``."""
    power = 10.0 ** math.floor(math.log10(step))
    return next(factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0) if factor * power >= step * (1.0 - 1e-9))


def _short(value: float) -> str:
    return f"{value:g}"


def span(values: list[float], from_zero: bool = False, margin: float = 0.04) -> tuple[float, float]:
    """Range that holds all finite values with a margin; never empty.

    Parameters
    ----------
    values : list of float
        What the axis shows; values that are not finite do not count.
    from_zero : bool
        Whether the axis begins at 0 when no value is below.
    margin : float
        Room beyond the values, over their range.

    Returns
    -------
    (float, float)
        Lower and upper end, in the unit of the values.
    """
    known = [value for value in values if math.isfinite(value)]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    if from_zero:
        low = min(low, 0.0)
    if high <= low:
        low, high = low - 0.5 * (abs(low) or 1.0), high + 0.5 * (abs(high) or 1.0)
    room = margin * (high - low)
    return (low if from_zero and low == 0.0 else low - room), high + room
