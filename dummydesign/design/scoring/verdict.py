"""May this pad be used in place of people? A level, a light, one sentence, and the numbers behind them.

A robot is cleared by what it does to a pad. A pad below every subject clears robots that would hurt the person; a pad
far above every subject fails good robots. Both are judged by ratios (:mod:`dummydesign.design.scoring.deviations`) at
central estimates and over the castings of the design, against the limits of ``materials/verdict.toml``. Every command
that judges a pad calls :func:`verdict`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.deviations import (
    CLASSES,
    ENERGY,
    PEAK,
    STANDS_FOR,
    STEADY,
    USABLE,
    Deviations,
    Ranges,
    Readings,
    classes,
    deviations,
    tolerance_of,
)
from dummydesign.design.scoring.verdict_limits import VerdictLimits, verdict_limits

LEVELS = ("stands_for", "usable_with_correction", "not_settled", "not_representative")
LIGHTS = dict(zip(LEVELS, ("green", "amber", "amber", "red")))
QUANTILE = 0.95


@dataclass(frozen=True)
class Deviation:
    """Shortfall or over-reading: the largest ratio, where it is, and what 95 % of the castings do not exceed.

    ``central`` and ``press`` are None where nothing was reached, ``q95`` without castings in reach. ``press`` has
    ``steady_force_N`` and ``velocity_mm_s``; ``quantity`` is ``peak``, ``steady`` or ``energy``.
    """

    central: float | None
    q95: float | None
    press: dict[str, float] | None
    quantity: str | None


@dataclass(frozen=True)
class Correction:
    """By what readings are multiplied so that none is below the lowest subject's; 1 where none is.

    ``factor`` holds for 95 % of the castings that reach every press, ``factor_central`` at central estimates,
    ``factor_after_measuring`` for 95 % of castings once modulus and relaxation of the resin are measured. ``force``,
    ``force_central`` and ``force_after_measuring`` are the same for forces alone: energies may need more.
    """

    factor: float | None
    factor_central: float | None
    factor_after_measuring: float | None = None
    force: float | None = None
    force_central: float | None = None
    force_after_measuring: float | None = None


@dataclass(frozen=True)
class Verdict:
    """The verdict on one pad.

    Attributes
    ----------
    level : str
        One of :data:`LEVELS`.
    reads : str
        ``inside``, ``low``, ``high`` or ``mixed``, at central estimates.
    text : str
    shortfall, over : Deviation
    correction : Correction
    peaks_below, peaks_above, peaks : int
        Presses whose peak is below or above every subject's, of all that were judged.
    steady_fraction, steady_below_fraction, steady_above_fraction : float or None
        Share of the steady curve among the subjects, softer than all of them, and stiffer.
    energy_ratio : float or None
        Energy of the rise over the middle of the subjects', geometric mean over the presses.
    energy_below, energy_above : int
        Presses whose energy is below or above every subject's.
    not_reached : int
        Presses out of the pad's reach.
    subjects : int
    castings : dict or None
        Share of the castings in each class of :data:`~dummydesign.design.scoring.deviations.CLASSES`; they sum to 1.
    limits_that_bind : tuple of str
    limits : VerdictLimits
        By which it was judged.
    """

    level: str
    reads: str
    text: str
    shortfall: Deviation
    over: Deviation
    correction: Correction
    peaks_below: int
    peaks_above: int
    peaks: int
    steady_fraction: float | None
    steady_below_fraction: float | None
    steady_above_fraction: float | None
    energy_ratio: float | None
    energy_below: int
    energy_above: int
    not_reached: int
    subjects: int
    castings: dict[str, float] | None
    limits_that_bind: tuple[str, ...]
    limits: VerdictLimits

    @property
    def light(self) -> str:
        """``green``, ``amber`` or ``red``."""
        return LIGHTS[self.level]

    @property
    def acceptable(self) -> bool:
        """Whether the pad may be cast: it is not red."""
        return self.light != "red"

    @property
    def usable_share(self) -> float | None:
        """Share of the castings that may be used, as they are or with a correction."""
        return None if self.castings is None else self.castings[STANDS_FOR] + self.castings[USABLE]

    def to_dict(self) -> dict[str, Any]:
        """Return all fields and the light as plain values."""
        return {**asdict(self), "light": self.light, "limits_that_bind": list(self.limits_that_bind)}


@dataclass(frozen=True)
class Findings:
    """What the sentence is made of: deviations of the pad, its level, shares of castings, and what is left open."""

    found: Deviations
    readings: Readings
    level: str
    reads: str
    shares: dict[str, float] | None
    correction: Correction
    limits: VerdictLimits
    strict: bool
    of: str
    unsettled: str
    bound: tuple[str, ...]


def verdict(
    ranges: Ranges,
    readings: Readings,
    spread: Readings | None = None,
    limits_that_bind: Sequence[str] = (),
    of: str = "castings",
    unsettled: str = "",
    strict: bool = False,
    measured: Readings | None = None,
    limits: VerdictLimits | None = None,
    beyond: float = 1.0,
    cast: bool = False,
) -> Verdict:
    """Judge one pad against the subjects of a tissue.

    Parameters
    ----------
    ranges : Ranges
    readings : Readings
        Of the pad at central estimates, shapes (c,) and (g,).
    spread : Readings, optional
        Of n pads that may come out of the same design, or that may be behind the same measurement, shapes (n, c) and
        (n, g). Without it the pad is taken as exactly known.
    limits_that_bind : sequence of str
        Limits that keep a better pad out, in words.
    of : str
        What the members of the spread are, for the sentence.
    unsettled : str
        Why the readings leave the verdict open, in words; empty where they do not.
    strict : bool
        For the aim safe-side: nothing may be below any subject, and what is above is stated, not limited.
    measured : Readings, optional
        Of the castings once modulus and relaxation are known.
    limits : VerdictLimits, optional
        By default those of ``materials/verdict.toml``.
    beyond : float
        Largest steady force of the test over the hardest press of people. Above 1 nothing is settled; above the limit
        no pad is representative.
    cast : bool
        Whether the pad exists and was pressed: it is then one casting, and held to the limit of castings.

    Returns
    -------
    Verdict
    """
    from dummydesign.design.scoring.verdict_words import sentence

    limits = verdict_limits() if limits is None else limits
    if cast:
        limits = replace(limits, shortfall=limits.shortfall_castings)
    plain = deviations(ranges, readings)
    found = deviations(ranges, readings, strict) if strict else plain
    shares, short_95, over_95, force_95 = None, None, None, None
    if spread is not None:
        every = deviations(ranges, spread, strict)
        kinds = classes(every, limits, strict)
        shares = {name: float((kinds == place).mean()) for place, name in enumerate(CLASSES)}
        short_95, over_95, force_95 = (
            _quantile(values[every.reached]) for values in (every.shortfall, every.over, every.force_shortfall)
        )
    else:
        own = int(classes(found, limits, strict)[0])
        known = {name: float(own == place) for place, name in enumerate(CLASSES)}
    below, above = outside(plain)
    if beyond > 1.0 and not unsettled:
        unsettled = f"the test goes to {beyond:.2g} times the hardest press of people"
    level = _level(found, shares or known, limits, strict, ranges.subjects < 2, unsettled, _inside(below, above))
    if beyond > limits.beyond_people:
        level = "not_representative"
    after, force_after = None, None
    if measured is not None:
        resin = deviations(ranges, measured, strict)
        after, force_after = (
            _factor(_quantile(values[resin.reached])) for values in (resin.shortfall, resin.force_shortfall)
        )
    shortfall, over = _deviation(found, found.short, short_95), _deviation(found, found.above, over_95)
    central, own_force = _factor(shortfall.central), float(found.force_shortfall[0])
    force = _factor(own_force) if np.isfinite(own_force) else None
    known_exactly = spread is None
    correction = Correction(
        central if known_exactly else _factor(short_95), central, after,
        force if known_exactly else _factor(force_95), force, force_after,
    )  # fmt: skip
    reads = reads_of(below, above)
    bound = tuple(limits_that_bind)
    words = Findings(found, readings, level, reads, shares, correction, limits, strict, of, unsettled, bound)
    steady = _steady(ranges, readings, below, above)
    return Verdict(
        level, reads, sentence(words), shortfall, over, correction,
        int(below[PEAK].sum()), int(above[PEAK].sum()), int(np.isfinite(readings.peak_N).sum()),
        *steady, _energy_ratio(ranges, readings),
        int(below[ENERGY].sum()), int(above[ENERGY].sum()), int((~np.isfinite(readings.peak_N)).sum()),
        ranges.subjects, shares, bound, limits,
    )  # fmt: skip


def representative(
    found: Deviations, limits: VerdictLimits, strict: bool = False, slack: float | None = None
) -> NDArray:
    """Whether pads may be cast by their central estimates, shape (n,).

    Parameters
    ----------
    found : Deviations
    limits : VerdictLimits
    strict : bool
        For the safe side.
    slack : float, optional
        Share by which the limits are taken wider, by default their tie: a reading is not known finer.
    """
    short, over = np.nan_to_num(found.shortfall), np.nan_to_num(found.over)
    if strict:
        return np.asarray(found.reached & (short <= limits.stands_shortfall))
    near = 1.0 + (limits.tie if slack is None else slack)
    return np.asarray(found.reached & (short <= limits.shortfall * near) & (over <= limits.over * near))


def outside(found: Deviations, pad: int = 0) -> tuple[dict[str, NDArray], dict[str, NDArray]]:
    """What of one pad is below and above every subject, by quantity.

    Parameters
    ----------
    found : Deviations
        Not of the safe side.
    pad : int
    """
    below, above = (
        {name: ratios[name][pad] > 1.0 + tolerance_of(name) for name in ratios} for ratios in (found.short, found.above)
    )
    return below, above


def reads_of(below: dict[str, NDArray], above: dict[str, NDArray]) -> str:
    """``inside``, ``low``, ``high`` or ``mixed``, from what is :func:`outside`."""
    low, high = (any(bool(flags.any()) for flags in sides.values()) for sides in (below, above))
    return {(False, False): "inside", (True, False): "low", (False, True): "high", (True, True): "mixed"}[low, high]


def _level(
    found: Deviations, shares: dict[str, float], limits: VerdictLimits, strict: bool, alone: bool, unsettled: str,
    inside: float,
) -> str:
    if not representative(found, limits, strict)[0]:
        return "not_representative"
    enough = shares[STANDS_FOR] >= limits.share and not alone and not unsettled
    if enough and (strict or inside >= limits.stands_inside):
        return "stands_for"
    if not strict and shares[STANDS_FOR] + shares[USABLE] >= limits.share and not unsettled:
        return "usable_with_correction"
    return "not_settled"


def _inside(below: dict[str, NDArray], above: dict[str, NDArray]) -> float:
    """The smaller of the shares of peaks and of the steady curve that lie among the subjects."""
    return min((float(1.0 - (below[name] | above[name]).mean()) for name in (PEAK, STEADY) if below[name].size),
               default=0.0)  # fmt: skip


def _steady(
    ranges: Ranges, readings: Readings, below: dict[str, NDArray], above: dict[str, NDArray]
) -> tuple[float | None, float | None, float | None]:
    """Shares of the steady curve inside, below and above the subjects."""
    depth = readings.depth_mm
    if not np.isfinite(depth).any():
        return None, None, None
    with np.errstate(invalid="ignore"):
        within = (depth >= ranges.stiff_mm * (1 - 1e-9)) & (depth <= ranges.soft_mm * (1 + 1e-9))
    return float(within.mean()), float(below[STEADY].mean()), float(above[STEADY].mean())


def _quantile(values: NDArray) -> float | None:
    return float(np.quantile(values, QUANTILE)) if len(values) else None


def _factor(ratio: float | None) -> float | None:
    return None if ratio is None else max(ratio, 1.0)


def _deviation(found: Deviations, ratios: dict[str, NDArray], q95: float | None) -> Deviation:
    value, name, at = found.worst(ratios)
    if not np.isfinite(value):
        return Deviation(None, q95, None, None)
    force, speed = found.ranges.force_N, found.ranges.velocity_mm_s
    place = (found.ranges.steady_N[at], speed.min()) if name == STEADY else (force[at], speed[at])
    press = {"steady_force_N": float(place[0]), "velocity_mm_s": float(place[1])}
    return Deviation(value, q95, press, name)


def _energy_ratio(ranges: Ranges, readings: Readings) -> float | None:
    """Energy over the geometric middle of the outermost subjects', mean of the logarithms over the presses."""
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.log(readings.energy_mJ) - 0.5 * np.log(ranges.energy_low_mJ * ranges.energy_high_mJ)
    known = np.isfinite(away)
    return float(np.exp(away[known].mean())) if known.any() else None
