"""Whether a pad may be used in place of people: a level, a light, one sentence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.levels import LEVELS, LIGHTS, level_name
from dummydesign.core.serialise import Serialised, percent_below_limit
from dummydesign.design.scoring.score import Evaluation
from dummydesign.design.scoring.settings import VerdictLimits, verdict_limits
from dummydesign.design.scoring.targets import Targets

# A reading within 1 % of the outermost subject counts as inside: a steady force is not set finer. Energies go with
# force times depth.
TOLERANCE, ENERGY_TOLERANCE = 0.01, 0.02
PEAK, STEADY, ENERGY = "peak", "steady", "energy"
# Exclusive classes of castings, in the order of their numbers.
CLASSES = ("stands_for", "with_correction", "reads_low", "over", "out_of_reach")
STANDS_FOR, WITH_CORRECTION, READS_LOW, OVER, OUT_OF_REACH = CLASSES


@dataclass(frozen=True, eq=False)
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
    highest: str = ""  # the upper end, where it is not the highest subject


@dataclass(frozen=True, eq=False)
class Readings:
    """What one pad, or n of them, do: shapes (c,) and (g,), or (n, c) and (n, g); NaN where out of reach."""

    peak_N: NDArray
    energy_mJ: NDArray
    depth_mm: NDArray


@dataclass(frozen=True, eq=False)
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

    @property
    def quantiles(self) -> tuple[float | None, float | None, float | None]:
        """95 % quantiles of shortfall, over-reading and shortfall of forces over the pads that reach every press."""
        if not self.reached.any():
            return None, None, None
        every = np.stack([self.shortfall, self.over, self.force_shortfall])[:, self.reached]
        short, over, force = np.quantile(every, QUANTILE, axis=-1).tolist()
        return short, over, force

    def worst(self, ratios: dict[str, NDArray]) -> tuple[float, str, int]:
        """Largest ratio of the first pad, its quantity and the place of its press or steady force."""
        best = (np.nan, PEAK, 0)
        for name, values in ratios.items():
            row = values[0]
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


def classes(differences: Deviations, limits: VerdictLimits) -> NDArray:
    """Class of each pad as it is, shape (n,), as places in :data:`CLASSES`.

    A casting that both falls short and over-reads counts by the larger excess over its limit.
    """
    short, over = np.nan_to_num(differences.shortfall), np.nan_to_num(differences.over)
    if differences.ranges.strict:
        return np.asarray(np.select([~differences.reached, short <= limits.stands_shortfall], [4, 0], 2))
    stands = (short <= limits.stands_shortfall) & (over <= limits.stands_over)
    usable = (short <= limits.shortfall) & (over <= limits.over)
    low = short / limits.shortfall >= over / limits.over
    return np.asarray(np.select([~differences.reached, stands, usable, low], [4, 0, 1, 2], 3))


def tolerance_of(quantity: str) -> float:
    """A reading outside the subjects' range by less than this share of it counts as inside."""
    return ENERGY_TOLERANCE if quantity == ENERGY else TOLERANCE


def _largest(ratios: dict[str, NDArray]) -> NDArray:
    every = np.concatenate(list(ratios.values()), axis=-1)
    return np.where(np.isfinite(every).any(axis=-1), np.nanmax(np.nan_to_num(every, nan=-np.inf), axis=-1), np.nan)


QUANTITIES = {PEAK: "the peak", ENERGY: "the energy"}
OUTCOMES = {OUT_OF_REACH: "too soft to reach a force", READS_LOW: "too low", OVER: "too high"}
TIMES = 3.0  # a reading further above the subjects is stated in times, not in per cent
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
class ReadingCorrection:
    """By what readings are multiplied so that none is below the lowest subject's; 1 where none is.

    ``factor`` holds for 95 % of the castings that reach every press, ``factor_central`` at central estimates,
    ``factor_after_measuring`` for 95 % of castings of the resin's centre. ``force``,
    ``force_central`` and ``force_after_measuring`` are the same for forces alone: energies may need more.
    """

    factor: float | None
    factor_central: float | None
    factor_after_measuring: float | None = None
    force: float | None = None
    force_central: float | None = None
    force_after_measuring: float | None = None


@dataclass(frozen=True)
class Verdict(Serialised):
    """The verdict on one pad."""

    also: ClassVar[tuple[str, ...]] = ("light",)

    level: str
    reads: str
    text: str
    shortfall: Deviation
    over: Deviation
    correction: ReadingCorrection
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
        return None if self.castings is None else good_share(self.castings, strict=False)


def shares_of(differences: Deviations, limits: VerdictLimits) -> dict[str, float]:
    """Share of pads in each of :data:`CLASSES`; they sum to 1."""
    kinds = classes(differences, limits)
    return {name: float((kinds == number).mean()) for number, name in enumerate(CLASSES)}


def good_share(shares: dict[str, float], strict: bool) -> float:
    """Share of pads that may be used: as they are or with a correction, on the safe side as they are alone."""
    return shares[STANDS_FOR] if strict else shares[STANDS_FOR] + shares[WITH_CORRECTION]


def level_number(stands_for: float, poured: float, known: float, enough: float, strict: bool) -> int:
    """Place in :data:`LEVELS` by the share of castings that stand for the subjects and by both shares that are good."""
    if stands_for >= enough:
        return 0
    if not strict and poured >= enough:
        return 1
    return 2 if known >= enough else 3


def verdict(
    ranges: Ranges,
    readings: Readings,
    spread: Readings | None = None,
    limits_that_bind: Sequence[str] = (),
    of: str = "castings",
    unsettled: str = "",
    known: Readings | None = None,
    limits: VerdictLimits | None = None,
    beyond: float = 1.0,
    measure: str = "",
    after_puck: Readings | None = None,
) -> Verdict:
    """Judge one pad against the subjects of a tissue.

    ``spread`` are the readings of its castings as poured, ``known`` those with the resin measured; without them the pad
    itself counts, as for one that is cast. ``beyond`` is the largest force of the test over the hardest press of
    people. ``measure`` is what settles a level that is open, ``after_puck`` the castings once a puck is measured;
    both are for the sentence alone.
    """
    limits = verdict_limits() if limits is None else limits
    differences, strict = deviations(ranges, readings), ranges.strict
    below, above = outside(deviations(replace(ranges, strict=False), readings))
    every = differences if spread is None else deviations(ranges, spread)
    measured = None if known is None else deviations(ranges, known)
    shares = shares_of(every, limits)
    shares_known = shares_of(differences if measured is None else measured, limits)
    short_95, over_95, force_95 = (None, None, None) if spread is None else every.quantiles
    if beyond > 1.0 and not unsettled:
        unsettled = f"the test goes to {beyond:.2g} times the hardest press of the subjects"
        measure = "people at these forces"
    inside = [float(1.0 - (below[name] | above[name]).mean()) for name in (PEAK, STEADY) if below[name].size]
    stands = ranges.subjects > 1 and (strict or min(inside, default=0.0) >= limits.stands_inside)
    poured, average = good_share(shares, strict), good_share(shares_known, strict)
    level = LEVELS[level_number(shares[STANDS_FOR] if stands else 0.0, poured, average, limits.share, strict)]
    if unsettled and level in ("stands_for", "usable_with_correction"):
        level = "not_settled"
    # castings are judged by the subjects' presses: far beyond these none is called usable
    if far := beyond > limits.beyond_people:
        level = "not_representative"
    after, _, force_after = (None, None, None) if measured is None else measured.quantiles
    shortfall = _deviation(differences, differences.short, short_95)
    over = _deviation(differences, differences.above, over_95)
    central, own_force = factor_of(shortfall.central), float(differences.force_shortfall[0])
    force = factor_of(own_force) if np.isfinite(own_force) else None
    factors = (central, force) if spread is None else (factor_of(short_95), factor_of(force_95))
    correction = ReadingCorrection(factors[0], central, factor_of(after), factors[1], force, factor_of(force_after))
    castings = None if spread is None else shares
    bound = tuple(limits_that_bind)
    puck = None if after_puck is None else good_share(shares_of(deviations(ranges, after_puck), limits), strict)
    words_known = None if measured is None or unsettled else shares_known
    parts = [
        _reading_words(differences, readings, level),
        "" if castings is None or far else _casting_words(castings, words_known, puck, level, limits, strict, of),
        _ending(level, correction, unsettled, castings is not None, over.central if spread is None else over_95),
    ]
    words = f"Measure {measure} first" if measure and level == "not_settled" else level_name(level)
    reached = np.isfinite(readings.peak_N)
    return Verdict(
        level,
        reads_of(below, above),
        _sentence(words, parts, bound if level != "stands_for" else ()),
        shortfall,
        over,
        correction,
        int(below[PEAK].sum()),
        int(above[PEAK].sum()),
        int(reached.sum()),
        *_steady_shares(ranges, readings, below, above),
        _energy_ratio(ranges, readings),
        int(below[ENERGY].sum()),
        int(above[ENERGY].sum()),
        int((~reached).sum()),
        ranges.subjects,
        castings,
        bound,
        limits,
    )


def outside(differences: Deviations, pad: int = 0) -> tuple[dict[str, NDArray], dict[str, NDArray]]:
    """What of one pad is below and above every subject, by quantity."""
    below, above = (
        {name: ratios[name][pad] > 1.0 + tolerance_of(name) for name in ratios}
        for ratios in (differences.short, differences.above)
    )
    return below, above


def reads_of(below: dict[str, NDArray], above: dict[str, NDArray]) -> str:
    """``inside``, ``low``, ``high`` or ``mixed``, from what is :func:`outside`."""
    low, high = (any(bool(flags.any()) for flags in sides.values()) for sides in (below, above))
    return {(False, False): "inside", (True, False): "low", (False, True): "high", (True, True): "mixed"}[low, high]


def _steady_shares(
    ranges: Ranges, readings: Readings, below: dict[str, NDArray], above: dict[str, NDArray]
) -> tuple[float | None, float | None, float | None]:
    """Shares of the steady curve inside, below and above the subjects."""
    depth = readings.depth_mm
    if not np.isfinite(depth).any():
        return None, None, None
    with np.errstate(invalid="ignore"):
        within = (depth >= ranges.stiff_mm * (1 - 1e-9)) & (depth <= ranges.soft_mm * (1 + 1e-9))
    return float(within.mean()), float(below[STEADY].mean()), float(above[STEADY].mean())


def factor_of(ratio: float | None) -> float | None:
    """By what readings of a shortfall are multiplied."""
    return None if ratio is None else max(ratio, 1.0)


def _deviation(differences: Deviations, ratios: dict[str, NDArray], q95: float | None) -> Deviation:
    value, name, at = differences.worst(ratios)
    if not np.isfinite(value):
        return Deviation(None, q95, None, None)
    ranges, speed = differences.ranges, differences.ranges.velocity_mm_s
    force, velocity = (ranges.steady_N[at], speed.min()) if name == STEADY else (ranges.force_N[at], speed[at])
    return Deviation(value, q95, {"steady_force_N": float(force), "velocity_mm_s": float(velocity)}, name)


def _energy_ratio(ranges: Ranges, readings: Readings) -> float | None:
    """Energy over the geometric middle of the outermost subjects', mean of the logarithms over the presses."""
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.log(readings.energy_mJ) - 0.5 * np.log(ranges.energy_low_mJ * ranges.energy_high_mJ)
    known = np.isfinite(away)
    return float(np.exp(away[known].mean())) if known.any() else None


def _sentence(level_words: str, parts: Sequence[str], bound: Sequence[str]) -> str:
    """Write the verdict: level, worst reading, castings, limits that bind."""
    words = "; ".join(part for part in parts if part)
    text = f"{level_words}. {words[0].upper()}{words[1:]}." if words else f"{level_words}."
    return f"{text} At the limit of {' and of '.join(bound)}." if bound else text


def whole_percents(shares: list[float], taken: int | None = None) -> list[int]:
    """Round shares to whole per cent so that they keep their sum."""
    exact = 100.0 * np.array(shares)
    whole = np.floor(exact).astype(int)
    left = (round(float(exact.sum())) if taken is None else 100 - taken) - int(whole.sum())
    if left < 0:
        whole[np.argsort(exact - whole - 1.0 * (whole > 0), kind="stable")[:-left]] -= 1
    else:
        whole[np.argsort(whole - exact, kind="stable")[:left]] += 1
    return [int(value) for value in whole]


def _reading_words(differences: Deviations, readings: Readings, level: str) -> str:
    """What leaves the subjects most, below before above; else that nothing does."""
    presses, ranges = len(readings.peak_N), differences.ranges
    if missing := int((~np.isfinite(readings.peak_N)).sum()):
        return f"{missing} of {presses} presses are out of reach"
    who = ranges.highest or ("the one subject" if ranges.subjects < 2 else "all subjects")
    highest = ranges.highest or "the highest subject"
    above = _worst_words(differences, readings, differences.above, "above", who)
    if ranges.strict:
        below = _worst_words(differences, readings, differences.short, "below", highest)
        kept = below or f"no peak and no steady force is below {highest}"
        return f"{kept}; price of the safe side: {above}" if above else kept
    below = _worst_words(differences, readings, differences.short, "below", who)
    if below and above:
        short, over = (differences.worst(ratios)[0] for ratios in (differences.short, differences.above))
        below_first = short >= over or level != "not_representative"
        return f"{below}, and {above}" if below_first else f"{above}, and {below}"
    if below or above:
        return below or above
    if ranges.subjects < 2:
        return "all readings are as near to the one subject as can be set"
    return f"all {presses} peaks and the steady curve are inside the subjects' range"


def _worst_words(differences: Deviations, readings: Readings, ratios: dict[str, NDArray], side: str, who: str) -> str:
    """The largest ratio in words; empty where it is within tolerance."""
    value, name, at = differences.worst(ratios)
    if not value > 1.0 + tolerance_of(name):
        return ""
    ranges = differences.ranges
    # a reading below a subject's is given as a share of the subject's
    percent = 100.0 * (1.0 - 1.0 / value if side == "below" else value - 1.0)
    if name == STEADY:  # compared at the pad's depth
        what = f"at {readings.depth_mm[at]:.2f} mm the pad's steady force ({ranges.steady_N[at]:.3g} N)"
    else:
        what = f"{QUANTITIES[name]} at {ranges.force_N[at]:.3g} N, {ranges.velocity_mm_s[at]:g} mm/s"
        what += f" ({readings.peak_N[at]:.1f} N)" if name == PEAK else ""
    if side == "above" and value > TIMES:
        return f"{what} is {value:.2g} times that of {who}"
    return f"{what} is {percent:.0f} % {side} {who}"


def _casting_words(
    shares: dict[str, float],
    known: dict[str, float] | None,
    after_puck: float | None,
    level: str,
    limits: VerdictLimits,
    strict: bool,
    of: str,
) -> str:
    """What becomes of the castings: first the share that decides the level; the classes add up to 100 %."""
    share, word = good_share(shares, strict), "keep the safe side" if strict else "are usable"
    good, shown = round(100.0 * share), percent_below_limit(share, limits.share)
    if level == "stands_for":
        return f"{100.0 * shares[STANDS_FOR]:.0f} % of {of} {word if strict else 'need no correction'}"
    if level == "not_settled" and known is not None and after_puck is not None:
        average, after = (100.0 * one for one in (good_share(known, strict), after_puck))
        return f"{average:.0f} % of {of} of an average batch {word}, {after:.0f} % after one puck, {shown} as poured"
    text = f"{shown} of {of} {word}"
    if level == "not_settled" and share < limits.share:
        text += f", {100.0 * limits.share:g} % needed"
    rest = whole_percents([shares[name] for name in OUTCOMES], good)
    if lost := [f"{percent} % {words}" for words, percent in zip(OUTCOMES.values(), rest) if percent > 0]:
        text += f" ({', '.join(lost)})"
    if level != "not_representative" or known is None:
        return text
    most = max(OUTCOMES, key=lambda outcome: known[outcome])
    why = f" (most are {OUTCOMES[most]})" if known[most] > 0.0 else ""
    return f"{text}; {100.0 * good_share(known, strict):.0f} % of an average batch{why}"


def _ending(
    level: str, correction: ReadingCorrection, unsettled: str, over_castings: bool, over: float | None = None
) -> str:
    """The correction, or why nothing is settled."""
    if unsettled and level in ("not_settled", "not_representative"):
        return unsettled
    force, every = correction.force, correction.factor
    if level != "usable_with_correction" or every is None:
        return ""
    if every < 1.0 + tolerance_of(PEAK):
        high = 100.0 * ((over or 1.0) - 1.0)
        words = "multiply readings by 1.00: they are not low"
        words += f", but up to {high:.0f} % above all subjects" if high >= 1.0 else ""
    elif force is None:
        words = ""
    elif every - force < 0.005:
        words = f"multiply readings by {every:.2f}"
    elif force < 1.0 + tolerance_of(PEAK):
        words = f"multiply energies by {every:.2f}, forces by 1.00"
    else:
        words = f"multiply forces by {force:.2f}, energies by {every:.2f}"
    return f"{words} for 95 % of them" if over_castings else words


def ranges_of(targets: Targets) -> Ranges:
    """Peaks and energies of the outermost subjects in every press of a protocol, and their depths from 5 to 15 N."""
    rows = [
        (one.steady_force_N, one.velocity_mm_s, one.range.peak_low_N, one.range.peak_high_N, *one.energy_mJ)
        for one in targets.conditions
    ]
    force, speed, low, high, least, most = (np.array(column) for column in zip(*rows))
    grid_N, subjects = targets.protocol.steady_grid_N, len(targets.tissue.subjects)
    stiff, soft = targets.depth_range_mm(grid_N)
    bounds = targets.bounds
    high, most, stiff, highest = bounds or (high, most, stiff, "")
    return Ranges(
        force, speed, low, high, least, most, grid_N, stiff, soft, subjects, targets.power, targets.strict, highest
    )


def readings_of(evaluation: Evaluation, index: int | None = None) -> Readings:
    """Readings of all designs of an evaluation, shapes (D, c) and (D, g); with an index of that one, (c,) and (g,)."""
    at = slice(None) if index is None else index
    peak, energy = (
        np.stack([getattr(press, name) for press in evaluation.presses], axis=-1) for name in ("peak_N", "energy_mJ")
    )
    return Readings(peak[at], energy[at], evaluation.steady_depth_mm[at])
