"""What a press of a hand or a pad can be: bounds on both sides, and the units that would make all of it plausible."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.user_library import data_folder, fill_table, read_toml
from dummydesign.measurement.plateau import time_at

UNITS = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "displacement": {"mm": 1.0, "um": 1e-3, "cm": 10.0, "m": 1e3, "in": 25.4},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3, "gf": 9.80665e-3, "kgf": 9.80665, "lbf": 4.4482216},
}
"""Units that are proposed, in s, mm and N; 1 cN is 1.02 gf and is not proposed beside it."""
ROLE = {
    "force_N": "force",
    "depth_mm": "displacement",
    "speed_mm_s": "time",
    "stop_mm_s2": "time",
    "step_s": "time",
}
"""The column whose unit is doubted by each quantity."""
RISE, END = (0.2, 0.9), (0.88, 0.98)
"""Shares of the depth between which the speed of a press, and that at its end, are taken."""


@dataclass(frozen=True)
class Range:
    """Bounds of one quantity: of what is read, and of what is usual."""

    words: str
    unit: str
    low: float
    high: float
    usual_low: float
    usual_high: float

    def fault(self, value: float) -> str:
        """Return in words why a value cannot be; empty where it can."""
        if self.low <= value <= self.high:
            return ""
        limit = f"above {self.high:g}" if value > self.high else f"below {self.low:g}"
        return f"{self.words} would be {value:.4g} {self.unit}, {limit} {self.unit}"

    def usual(self, value: float) -> bool:
        """Whether a value is a usual one."""
        return self.usual_low <= value <= self.usual_high


@cache
def ranges() -> Mapping[str, Range]:
    """Return the bounds by quantity, from ``materials/plausible-press.toml``."""
    data, _ = read_toml(data_folder() / "materials" / "plausible-press.toml")
    return {key: fill_table(Range, row) for key, row in data.items()}


def press_quantities(time: NDArray, x: NDArray, force: NDArray) -> dict[str, float]:
    """Return force, depth, speed, braking, sampling and stiffness of a press whose zero is near contact.

    The braking is the least with which the speed between 88 and 98 % of the depth ends there: v^2 / (2 s), where the
    way s is the rest of the depth, or that of one sample.
    """
    depth, largest = float(x.max()), float(force.max())
    step = float(np.median(np.diff(time)))
    ends = [[time_at(time, x, share * depth) for share in part] for part in (RISE, END)]
    speed, last = ((high - low) * depth / max(b - a, 1e-12) for (low, high), (a, b) in zip((RISE, END), ends))
    top = max(int(np.argmax(x >= END[1] * depth)), 1)
    way = max((1.0 - END[1]) * depth, last * float(time[top] - time[top - 1]), 1e-12)
    return {
        "force_N": largest,
        "depth_mm": depth,
        "speed_mm_s": speed,
        "stop_mm_s2": last**2 / (2.0 * way),
        "step_s": step,
        "stiffness_N_mm": largest / max(depth, 1e-12),
    }


def impossible(quantities: Mapping[str, float]) -> tuple[str, str] | None:
    """Return the first quantity that cannot be, and why in words; None where all can."""
    for key, value in quantities.items():
        if fault := ranges()[key].fault(value):
            return key, fault
    return None


def units_that_fit(role: str, time: NDArray, x: NDArray, force: NDArray, factor: float = 1.0) -> list[str]:
    """Return the units of one column with which all quantities of the press are usual.

    Parameters
    ----------
    role : str
        ``time``, ``displacement`` or ``force``.
    time, x, force : ndarray, shape (n,)
        The press as it was read. [s, mm, N]
    factor : float
        How many s, mm or N one count of the column was taken for.
    """
    fitting = []
    for unit, size in UNITS[role].items():
        scale = {one: size / factor if one == role else 1.0 for one in UNITS}
        found = press_quantities(scale["time"] * time, scale["displacement"] * x, scale["force"] * force)
        if abs(size / factor - 1.0) > 1e-6 and all(ranges()[key].usual(value) for key, value in found.items()):
            fitting.append(unit)
    return fitting
