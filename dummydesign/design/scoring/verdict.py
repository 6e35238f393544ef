"""Use this pad in place of the person or not: one sentence, a light, and the numbers behind them.

A robot is cleared by what it does to a pad. A pad whose peaks, steady force or energy are below every subject's
clears robots that would hurt the person: that is *low*, and nothing that may be low is called inside. The sentence is
worked out from numbers alone: readings of a pad, ranges of the subjects, and readings of the pads that may come out of
the same design (or of the same measurement).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.verdict_words import Findings, sentence

LEVELS = ("inside", "reads_low", "reads_high", "mixed", "poor")
FORCE_TOLERANCE = 0.01
"""Outside begins this share of the steady force beyond the outermost subject: a steady force is not set finer."""
ENERGY_TOLERANCE = 0.02
"""The same for energies, which go with force times depth."""
HIGH_SHARE = 0.1
"""A steady curve stiffer than every subject over more than this share of 5 to 15 N reads high."""
POOR_SHARE = 0.5
"""A steady curve outside the subjects over more than this share follows no tissue."""
LOW_DOUBT, OTHER_DOUBT = 0.05, 0.2
"""A pad is inside when at most this share of what may come out reads low, and this share leaves the ranges at all."""


@dataclass(frozen=True)
class Ranges:
    """What the subjects do in each of c presses, and their depths at g steady forces.

    Attributes
    ----------
    force_N, velocity_mm_s : ndarray, shape (c,)
        Steady force and speed of each press.
    peak_low_N, peak_high_N, energy_low_mJ, energy_high_mJ : ndarray, shape (c,)
        Outermost subjects; NaN energies are not judged.
    steady_N, stiff_mm, soft_mm : ndarray, shape (g,)
        Steady forces, and the depths of the stiffest and the softest subject there.
    subjects : int
    power : float
        Exponent of their steady force over depth.
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


@dataclass(frozen=True)
class Readings:
    """What one pad, or n of them, do: shapes (c,) and (g,), or (n, c) and (n, g); NaN where out of reach."""

    peak_N: NDArray
    energy_mJ: NDArray
    depth_mm: NDArray


@dataclass(frozen=True)
class Verdict:
    """The answer in one sentence and the numbers behind it.

    Attributes
    ----------
    level : str
        One of :data:`LEVELS`.
    text : str
    peaks_below, peaks_above, peaks : int
        Presses whose peak is below or above every subject's, of all that were judged.
    steady_fraction, steady_below_fraction, steady_above_fraction : float or None
        Share of the steady curve among the subjects, softer than all of them, and stiffer.
    energy_ratio : float or None
        Energy of the rise over the middle of the subjects', geometric mean over the presses.
    energy_below, energy_above : int
        Presses whose energy is below or above every subject's.
    furthest_below_percent : float
        How far the lowest peak is below the lowest subject's, or the energy where only that is; 0 when none is.
    subjects : int
    low_share, inside_share : float or None
        Shares of what may come out of the same design or measurement that read low, and that lie inside.
    limits_that_bind : tuple of str
    safe_side_shortfall_percent : float or None
        For the aim safe-side: how far the lowest peak or steady force is below the highest subject's.
    """

    level: str
    text: str
    peaks_below: int
    peaks_above: int
    peaks: int
    steady_fraction: float | None
    steady_below_fraction: float | None
    steady_above_fraction: float | None
    energy_ratio: float | None
    energy_below: int
    energy_above: int
    furthest_below_percent: float
    not_reached: int
    subjects: int
    low_share: float | None
    inside_share: float | None
    limits_that_bind: tuple[str, ...]
    safe_side_shortfall_percent: float | None = None

    @property
    def light(self) -> str:
        """``green``, ``amber`` or ``red``."""
        if self.level == "inside":
            return "green"
        return "red" if self.level in ("reads_low", "poor") or self.low else "amber"

    @property
    def low(self) -> bool:
        """Whether the pad itself, not only what it may turn out as, is below every subject somewhere."""
        return bool(self.peaks_below or self.energy_below or (self.steady_below_fraction or 0.0) > 0.0)

    @property
    def acceptable(self) -> bool:
        """Whether the pad may stand for the person, possibly after a test puck: it is not red."""
        return self.light != "red"

    def to_dict(self) -> dict[str, Any]:
        """Return all fields and the light as plain values."""
        fields = {name: getattr(self, name) for name in self.__dataclass_fields__}
        return {**fields, "light": self.light, "limits_that_bind": list(self.limits_that_bind)}


@dataclass(frozen=True)
class Flags:
    """Of n pads: what is below, above and not reached, press by press (n, c) and force by force (n, g)."""

    peak_low: NDArray
    peak_high: NDArray
    energy_low: NDArray
    energy_high: NDArray
    steady_low: NDArray
    steady_high: NDArray
    unreached: NDArray

    @property
    def low(self) -> NDArray:
        return self.peak_low.any(-1) | self.energy_low.any(-1) | self.steady_low.any(-1)

    @property
    def level(self) -> NDArray:
        """Level of each pad, for itself, as an index into :data:`LEVELS`."""
        peak_high = self.peak_high.any(-1)
        stiff = self.steady_high.mean(-1) if self.steady_high.shape[-1] else np.zeros(len(peak_high))
        high = peak_high | self.energy_high.any(-1) | (stiff > HIGH_SHARE)
        # A pad stiffer than every subject takes less energy at the same force because it yields less.
        only_energy = ~self.peak_low.any(-1) & ~self.steady_low.any(-1)
        mixed = self.low & (peak_high | (only_energy & (stiff > 0.0)))
        poor = self.unreached.any(-1) | ((stiff > POOR_SHARE) & ~peak_high)
        kinds = ["mixed", "reads_low", "poor", "reads_high"]
        chosen = np.select([mixed, self.low, poor, high], [LEVELS.index(kind) for kind in kinds], 0)
        return np.asarray(chosen)


def levels(ranges: Ranges, readings: Readings) -> list[str]:
    """Level of each of n pads as it is, without any doubt about it."""
    return [LEVELS[index] for index in _flags(ranges, readings).level]


def verdict(
    ranges: Ranges,
    readings: Readings,
    spread: Readings | None = None,
    limits_that_bind: Sequence[str] = (),
    of: str = "castings",
    unsettled: str = "",
) -> Verdict:
    """Judge one pad against the subjects of a tissue.

    Parameters
    ----------
    ranges : Ranges
    readings : Readings
        Of the pad, shapes (c,) and (g,).
    spread : Readings, optional
        Of n pads that may come out of the same design, or true pads behind the same measurement, shapes (n, c) and
        (n, g). Without it the pad is taken as exactly known.
    limits_that_bind : sequence of str
        Limits that keep a better pad out, in words.
    of : str
        What the members of the spread are, for the sentence.
    unsettled : str
        Why the readings do not settle that a pad is inside, in words; empty where they do.

    Returns
    -------
    Verdict
    """
    flags = _flags(ranges, readings)
    level = LEVELS[int(flags.level[0])]
    low_share = inside_share = None
    if spread is not None:
        others = _flags(ranges, spread)
        low_share = float(others.low.mean())
        inside_share = float((others.level == LEVELS.index("inside")).mean())
    doubtful = low_share is not None and low_share > LOW_DOUBT and level in ("inside", "reads_high")
    if level == "inside" and inside_share is not None and inside_share < 1.0 - OTHER_DOUBT:
        doubtful = True
    alone = ranges.subjects < 2
    if doubtful or (level == "inside" and (alone or unsettled)):
        level = "mixed"
    known = np.isfinite(readings.depth_mm)
    steady: dict[str, float | None] = {"in": None, "below": None, "above": None}
    if len(known) and known.any():
        depth = readings.depth_mm
        within = (depth >= ranges.stiff_mm * (1 - 1e-9)) & (depth <= ranges.soft_mm * (1 + 1e-9))
        steady = {
            "in": float(within.mean()),
            "below": float(flags.steady_low.mean()),
            "above": float(flags.steady_high.mean()),
        }
    findings = Findings(ranges, readings, flags, steady, low_share, inside_share, doubtful, of, alone, unsettled)
    return Verdict(
        level,
        sentence(level, findings, limits_that_bind),
        findings.below,
        findings.above,
        int(np.isfinite(readings.peak_N).sum()),
        steady["in"],
        steady["below"],
        steady["above"],
        _energy_ratio(ranges, readings),
        int(flags.energy_low.sum()),
        int(flags.energy_high.sum()),
        findings.furthest[0],
        int(flags.unreached.sum()),
        ranges.subjects,
        low_share,
        inside_share,
        tuple(limits_that_bind),
    )


def _flags(ranges: Ranges, readings: Readings) -> Flags:
    """Hold pads against the ranges; one pad counts as n = 1."""
    peak, energy, depth = (np.atleast_2d(values) for values in (readings.peak_N, readings.energy_mJ, readings.depth_mm))
    near = FORCE_TOLERANCE * ranges.force_N
    # At rest every subject follows a power, a cube as a rule, so a share of the force is a third of it in depth.
    shift = (1.0 + FORCE_TOLERANCE) ** (1.0 / ranges.power)
    with np.errstate(invalid="ignore"):
        return Flags(
            peak < ranges.peak_low_N - near,
            peak > ranges.peak_high_N + near,
            energy < ranges.energy_low_mJ * (1.0 - ENERGY_TOLERANCE),
            energy > ranges.energy_high_mJ * (1.0 + ENERGY_TOLERANCE),
            depth > ranges.soft_mm * shift,
            depth < ranges.stiff_mm / shift,
            ~np.isfinite(peak),
        )


def _energy_ratio(ranges: Ranges, readings: Readings) -> float | None:
    """Energy over the geometric middle of the outermost subjects', mean of the logarithms over the presses."""
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.log(readings.energy_mJ) - 0.5 * np.log(ranges.energy_low_mJ * ranges.energy_high_mJ)
    known = np.isfinite(away)
    return float(np.exp(away[known].mean())) if known.any() else None
