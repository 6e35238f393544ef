"""What is declared of the plates of a puck test: lubricated, bonded, a friction coefficient, or nothing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.core.toml_schema import read_table
from dummydesign.core.user_library import data_folder
from dummydesign.pad.tables.puck import friction_of, grip

Array = np.ndarray

LUBRICATED, BONDED = "lubricated", "bonded"
LARGEST = 5.0
POINTS = 9
"""Frictions at which a declared interval is profiled."""


@dataclass(frozen=True)
class Plates:
    """A declaration; ``friction`` is its 95 % interval, None where nothing was declared, infinite when bonded."""

    name: str = ""
    friction: Quantity | None = None

    def __bool__(self) -> bool:
        return self.friction is not None

    @property
    def words(self) -> str:
        """The declaration as a source states it."""
        if self.friction is None:
            return "plate friction left open"
        return f"plates declared {self.name}" if self.name in (LUBRICATED, BONDED) else f"plate friction {self.name}"

    def grips(self, free: Array) -> Array:
        """Grips at which a fit profiles the friction: those of ``free`` without a declaration."""
        if self.friction is None:
            return free
        if not self.friction.low < self.friction.high:
            return np.array([float(grip(self.friction.value))])
        away = np.linspace(-HALF_WIDTH, HALF_WIDTH, POINTS)
        return grip(np.exp(np.log(self.friction.value) + away * np.where(away < 0.0, *self._spreads)))

    def surprise(self, grip_value: float) -> float:
        """Chi square of a grip under the declaration, 0 without one."""
        if self.friction is None or not self.friction.low < self.friction.high:
            return 0.0
        away = math.log(friction_of(grip_value) / self.friction.value)
        return float((away / self._spreads[0 if away < 0.0 else 1]) ** 2)

    @property
    def _spreads(self) -> tuple[float, float]:
        """Standard deviations of ln friction below and above the value."""
        assert self.friction is not None
        low, value, high = (math.log(one) for one in (self.friction.low, self.friction.value, self.friction.high))
        return (value - low) / HALF_WIDTH, (high - value) / HALF_WIDTH


OPEN = Plates()


def read_plates(text: str | float | None) -> Plates:
    """Read ``lubricated``, ``bonded`` or a friction coefficient; None leaves the friction open."""
    if text is None:
        return OPEN
    name = str(text).strip().lower()
    if name == LUBRICATED:
        path = data_folder() / "materials" / "plates.toml"
        return Plates(name, read_table(path, ("schema", LUBRICATED)).table(LUBRICATED).quantity("friction"))
    if name == BONDED:
        return Plates(name, Quantity(math.inf, math.inf, math.inf, "assumed", "declared"))
    try:
        value = float(name)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= LARGEST:
        raise InputError(
            f"friction = {text} is not allowed; give lubricated, bonded or a friction coefficient from 0 to "
            f"{LARGEST:g}",
            "out_of_range" if math.isfinite(value) else "unknown_name",
            "friction",
            text,
            [LUBRICATED, BONDED, (0.0, LARGEST)],
        )
    return Plates(f"{value:g}", Quantity(value, value, value, "assumed", "declared"))
