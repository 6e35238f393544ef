"""A number from outside with interval, kind and source, and as a distribution."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dummydesign.core.serialise import Serialised

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

KINDS = ("measured", "fitted", "digitised", "inferred", "assumed")
FIELDS = {"value", "low", "high", "kind", "source"}


@dataclass(frozen=True)
class Quantity(Serialised):
    """A value with the interval it lies in, what kind of number it is and where it was read.

    ``low`` and ``high`` bound a 95 % interval for measured, fitted and inferred numbers and a
    plausible range for assumed ones. The unit is part of the name under which the number is kept.
    """

    value: float
    low: float
    high: float
    kind: str
    source: str


def fitted_around(value: float, spread: float, source: str) -> Quantity:
    """A positive fitted quantity with its 95 % interval.

    Parameters
    ----------
    value : float
        Fitted value, in the quantity's unit.
    spread : float
        Half width of the interval of its natural logarithm.
    source : str
        What it was fitted to.

    Returns
    -------
    Quantity
        ``value``, between ``value / exp(spread)`` and ``value * exp(spread)``.
    """
    factor = math.exp(min(spread, 99.0))
    return Quantity(value, value / factor, value * factor, "fitted", source)


def line_of(text: str, *keys: str) -> int:
    """Find the line (from 1) of a TOML text that sets the last of ``keys``, each searched after the one before.

    A key is a name, or the beginning of a header: ``[pad`` finds ``[pad]``, ``[[pad]]`` and ``[pad.punch]``. Comments
    and texts in quotes are passed over; a key that is not found leaves the line of the one before.
    """
    lines = text.splitlines()
    row = 0
    for key in keys:
        sets = _setting(key)
        row = next((index for index in range(row, len(lines)) if sets(lines[index])), row)
    return row + 1


def has_line(text: str, key: str) -> bool:
    """Whether a line of a TOML text sets a key or begins with a header; see :func:`line_of`."""
    return any(map(_setting(key), text.splitlines()))


_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'[^']*'")


def _setting(key: str) -> Callable[[str], bool]:
    """A test of a line: whether it sets the key, alone or in an inline table, or is a header that begins with it."""
    name = re.escape(key.strip("[]"))
    if key.startswith("["):
        second = r"\[" if key.startswith("[[") else r"\[?"
        head = re.compile(rf"\s*\[{second}\s*{name}\s*[\].]")
        return lambda line: head.match(line) is not None
    first, inside = re.compile(rf"\s*[\"']?{name}[\"']?\s*[=.]"), re.compile(rf"[{{,]\s*{name}\s*[=.]")
    return lambda line: bool(first.match(line) or inside.search(_QUOTED.sub("", line).partition("#")[0]))


NAGOYA_CITATION = (
    "Development of Dummy Based on Impedance Properties of Human Soft Tissue Using a Nonlinear Viscoelastic Model, "
    "IEEE Access (Nagoya University)"
)
"""What code and documents call "the paper"."""

ISO_TS_15066 = "ISO/TS 15066:2016, Robots and robotic devices - Collaborative robots"

HAND_STIFFNESS = (
    f"{ISO_TS_15066}, annex A: spring constant of hands and fingers 75 N/mm, second-hand as in the published code of "
    "V. Gupta, human_robot_collision_RL (the standard itself was not at hand)"
)


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
    import numpy as np

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
