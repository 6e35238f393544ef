"""How far pads are from the subjects, press by press: shortfall below the lowest, over-reading above the highest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.settings import VerdictLimits

# A reading within 1 % of the outermost subject counts as inside: a steady force is not set finer. Energies go with
# force times depth.
TOLERANCE, ENERGY_TOLERANCE = 0.01, 0.02
PEAK, STEADY, ENERGY = "peak", "steady", "energy"
# Exclusive classes of castings, in the order of their numbers.
CLASSES = ("stands_for", "usable", "reads_low", "over", "out_of_reach")
STANDS_FOR, USABLE, READS_LOW, OVER, OUT_OF_REACH = CLASSES


@dataclass(frozen=True)
class Ranges:
    """What the subjects do in each of c presses, and their depths at g steady forces.

    With ``strict`` (the aim safe-side) nothing may be below any subject.
    """

    force_N: NDArray
    velocity_mm_s: NDArray
    peak_low_N: NDArray
    peak_high_N: NDArray
    energy_low_mJ: NDArray
    energy_high_mJ: NDArray
    steady_N: NDArray
    stiff_mm: NDArray
    soft_mm: NDArray
    subjects: int
    power: float = 3.0
    strict: bool = False


@dataclass(frozen=True)
class Readings:
    """What one pad, or n of them, do: shapes (c,) and (g,), or (n, c) and (n, g); NaN where out of reach."""

    peak_N: NDArray
    energy_mJ: NDArray
    depth_mm: NDArray


@dataclass(frozen=True)
class Deviations:
    """Of n pads: lowest subject over pad (``short``) and pad over highest subject (``above``), by quantity.

    Each is {quantity: ndarray (n, presses) or (n, steady forces)}; NaN where out of reach or not judged. A steady force
    is compared at the pad's depth, where a subject's goes with its power. ``reached`` has shape (n,).
    """

    ranges: Ranges
    short: dict[str, NDArray]
    above: dict[str, NDArray]
    reached: NDArray

    @property
    def shortfall(self) -> NDArray:
        """Largest of each pad over presses and quantities, shape (n,); NaN where nothing was reached."""
        return _largest(self.short)

    @property
    def force_shortfall(self) -> NDArray:
        """The same of peaks and steady forces alone."""
        return _largest({name: values for name, values in self.short.items() if name != ENERGY})

    @property
    def over(self) -> NDArray:
        """The same of over-reading."""
        return _largest(self.above)

    def worst(self, ratios: dict[str, NDArray], pad: int = 0) -> tuple[float, str, int]:
        """Largest ratio of one pad, its quantity and the place of its press or steady force."""
        best = (np.nan, PEAK, 0)
        for name, values in ratios.items():
            row = values[pad]
            if np.isfinite(row).any():
                at = int(np.nanargmax(row))
                if not row[at] <= best[0]:
                    best = (float(row[at]), name, at)
        return best


def deviations(ranges: Ranges, readings: Readings) -> Deviations:
    """Compare pads with the subjects; one pad counts as n = 1."""
    peak, energy, depth = (np.atleast_2d(values) for values in (readings.peak_N, readings.energy_mJ, readings.depth_mm))
    reached = np.isfinite(peak).all(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        above = {PEAK: peak / ranges.peak_high_N, STEADY: (ranges.stiff_mm / depth) ** ranges.power}
        if ranges.strict:
            return Deviations(ranges, {name: 1.0 / ratio for name, ratio in above.items()}, above, reached)
        short = {PEAK: ranges.peak_low_N / peak, STEADY: (depth / ranges.soft_mm) ** ranges.power}
        short[ENERGY], above[ENERGY] = ranges.energy_low_mJ / energy, energy / ranges.energy_high_mJ
    return Deviations(ranges, short, above, reached)


def classes(found: Deviations, limits: VerdictLimits) -> NDArray:
    """Class of each pad as it is, shape (n,), as places in :data:`CLASSES`.

    A casting that both falls short and over-reads counts by the larger excess over its limit.
    """
    short, over = np.nan_to_num(found.shortfall), np.nan_to_num(found.over)
    if found.ranges.strict:
        return np.asarray(np.select([~found.reached, short <= limits.stands_shortfall], [4, 0], 2))
    stands = (short <= limits.stands_shortfall) & (over <= limits.stands_over)
    usable = (short <= limits.shortfall_castings) & (over <= limits.over)
    low = short / limits.shortfall_castings >= over / limits.over
    return np.asarray(np.select([~found.reached, stands, usable, low], [4, 0, 1, 2], 3))


def tolerance_of(quantity: str) -> float:
    """Share of a reading by which it may leave the subjects and count as inside."""
    return ENERGY_TOLERANCE if quantity == ENERGY else TOLERANCE


def _largest(ratios: dict[str, NDArray]) -> NDArray:
    every = np.concatenate(list(ratios.values()), axis=-1)
    return np.where(np.isfinite(every).any(axis=-1), np.nanmax(np.nan_to_num(every, nan=-np.inf), axis=-1), np.nan)
