"""Uncertainty budget of a reading and its statement of conformity, in the words of an accredited laboratory.

Uncertainties are standard deviations of the logarithm of a reading, in per cent: 10 % is a factor of exp(0.1). Requests
for a statement of conformity must name the decision rule (ISO/IEC 17025:2017, 7.1.3); this one is the non-binary
statement with a guard band of ILAC-G8:09/2019, 4.2.3.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import out_of_range
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.assessment.pad_castings import PadCastings
from dummydesign.design.scoring.castings import FORCE_LAW, GROUPS, MAKING, MODULUS, RELAXATION
from dummydesign.design.scoring.settings import VerdictLimits
from dummydesign.design.scoring.verdict import (
    ENERGY,
    PEAK,
    STEADY,
    Deviations,
    Ranges,
    Readings,
    deviations,
    ranges_of,
)

K = 2.0
PASS, CONDITIONAL_PASS, CONDITIONAL_FAIL, FAIL = STATEMENTS = (
    "pass",
    "conditional pass",
    "conditional fail",
    "fail",
)
RULE = (
    "ILAC-G8:09/2019, 4.2.3 (ISO/IEC 17025:2017, 7.1.3): non-binary statement, guard band equal to the expanded "
    "uncertainty (k = 2)"
)
SUBJECTS, TRACE = "subjects", "trace"
OF_GROUPS = {MODULUS: "resin modulus", RELAXATION: "resin relaxation", MAKING: "making", FORCE_LAW: "force law"}
LOW, HIGH = "low", "high"
QUANTITY_WORDS = {PEAK: "peak force", STEADY: "steady force at the pad's depth", ENERGY: "energy"}
UNITS = {PEAK: "N", STEADY: "N", ENERGY: "mJ"}


@dataclass(frozen=True)
class UncertaintyComponent(Serialised):
    """One part of a budget: standard uncertainty in per cent of the reading; None where it is not known."""

    name: str
    standard_percent: float | None


def combined_percent(components: tuple[UncertaintyComponent, ...]) -> float:
    """Root sum of squares of the parts that are known (GUM, equation 10, independent parts). [%]"""
    return math.sqrt(sum((one.standard_percent or 0.0) ** 2 for one in components))


@dataclass(frozen=True)
class IntervalEnds(Serialised):
    """Ends of an interval; None where it is open."""

    low: float | None
    high: float | None


@dataclass(frozen=True)
class ConformityDecision(Serialised):
    """The statement on one reading, where it changes, and the probability that it is outside the tolerance.

    ``tolerance`` are the limits of the requirement, ``acceptance`` those less the guard band, ``rejection`` those with
    it. ``false_acceptance`` is the probability that an accepted reading of this value is outside the tolerance.
    """

    statement: str
    false_acceptance: float
    tolerance: IntervalEnds
    acceptance: IntervalEnds
    rejection: IntervalEnds


def decide(
    value: float, tolerance: tuple[float | None, float | None], standard: tuple[float, float], k: float = K
) -> ConformityDecision:
    """Decide whether a reading keeps its limits, with a guard band of k standard uncertainties.

    Parameters
    ----------
    value : float
        The reading, above 0.
    tolerance : (float or None, float or None)
        Lower and upper limit in the reading's unit, above 0; None for none.
    standard : (float, float)
        Standard uncertainty of ln(reading / lower limit) and of ln(upper limit / reading), 0 or more.
    k : float
        Standard uncertainties in the guard band, 0 or more.

    Returns
    -------
    Decision

    Raises
    ------
    InputError
        For a reading, limit, uncertainty or k outside its range.

    References
    ----------
    ILAC-G8:09/2019, 4.2.3. False acceptance: JCGM 106:2012, 7, for a normal distribution of the logarithm:
    Phi(-ln(value / low) / u) + Phi(-ln(high / value) / u).
    """
    _above("reading", value, positive=True)
    _above("k", k)
    rooms: list[tuple[float, float]] = []
    tails: list[float] = []
    guards: list[tuple[float | None, float | None]] = []
    for limit, side, u in zip(tolerance, (1.0, -1.0), standard):
        _above("standard uncertainty", u)
        if limit is None:
            guards.append((None, None))
            continue
        _above("limit", limit, positive=True)
        room = side * math.log(value / limit)
        tails.append(_tail(room, u))
        rooms.append((room, k * u))
        guards.append((limit * math.exp(side * k * u), limit * math.exp(-side * k * u)))
    places = [0 if room >= guard else 1 if room >= 0.0 else 2 if room >= -guard else 3 for room, guard in rooms]
    (accept_low, reject_low), (accept_high, reject_high) = guards
    return ConformityDecision(
        STATEMENTS[max(places, default=0)],
        min(sum(tails), 1.0),
        IntervalEnds(*tolerance),
        IntervalEnds(accept_low, accept_high),
        IntervalEnds(reject_low, reject_high),
    )


def _tail(room: float, u: float) -> float:
    """Probability that a normal deviate of standard deviation u exceeds the room."""
    if u == 0.0:
        return 0.0 if room >= 0.0 else 1.0
    return 0.5 * math.erfc(room / (u * math.sqrt(2.0)))


def _above(name: str, value: float, positive: bool = False) -> None:
    if not (math.isfinite(value) and (value > 0.0 if positive else value >= 0.0)):
        raise out_of_range(name, value, "above 0" if positive else "0", "any finite value")


@dataclass(frozen=True)
class Reading(Serialised):
    """What is decided on: a quantity of one press, its value, and the place of the press."""

    quantity: str
    value: float
    unit: str
    steady_force_N: float | None = None
    velocity_mm_s: float | None = None
    file: str | None = None


@dataclass(frozen=True)
class Budget:
    """The budget of the reading that decides, and the decision on it.

    ``decision`` is None where there is no requirement. ``exact_range`` is the decision with the subjects' range taken
    as the specification itself, without their uncertainty; None where that is not known or changes nothing.
    ``missing`` are presses that gave no reading: the statement is then ``fail``. With a ``doubt`` whose size is not
    known a pass is conditional, and the probability of false acceptance is not known.
    """

    reading: Reading
    components: tuple[UncertaintyComponent, ...]
    requirement: str
    decision: ConformityDecision | None
    exact_range: ConformityDecision | None = None
    missing: int = 0
    doubt: str = ""

    @property
    def combined_percent(self) -> float:
        """Combined standard uncertainty. [%]"""
        return combined_percent(self.components)

    @property
    def expanded_percent(self) -> float:
        """Expanded uncertainty, k = 2. [%]"""
        return K * self.combined_percent

    @property
    def statement(self) -> str | None:
        """One of the four statements; None without a requirement."""
        if self.decision is None:
            return None
        if self.missing:
            return FAIL
        made = self.decision.statement
        return CONDITIONAL_PASS if self.doubt and made == PASS else made

    @property
    def false_acceptance(self) -> float | None:
        """Probability that the reading is outside the tolerance; None without a requirement, or in doubt."""
        if self.decision is None or self.doubt:
            return None
        return 1.0 if self.missing else self.decision.false_acceptance

    @property
    def not_known(self) -> tuple[str, ...]:
        """Parts that are not in the combined uncertainty, as nothing is known of them."""
        return tuple(one.name for one in self.components if one.standard_percent is None)

    def to_dict(self) -> dict[str, Any]:
        """Return the budget in the form of the contract, with what it rests on."""
        made = self.decision
        return {
            "components": [one.to_dict() for one in self.components],
            "combined_percent": self.combined_percent,
            "expanded_percent": self.expanded_percent,
            "k": K,
            "rule": RULE,
            "false_acceptance": self.false_acceptance,
            "statement": self.statement,
            "reading": self.reading.to_dict(),
            "requirement": self.requirement,
            "guard_band_percent": None if made is None else self.expanded_percent,
            "decision": to_plain(made),
            "exact_range": to_plain(self.exact_range),
            "missing": self.missing,
            "doubt": self.doubt or None,
            "not_known": list(self.not_known),
        }


@dataclass(frozen=True)
class EndSpread:
    """Standard deviations of the logarithms of the outermost subjects' values, by quantity; shapes of the ranges."""

    low: dict[str, NDArray]
    high: dict[str, NDArray]


def spread_of_ends(drawn: list[Ranges]) -> EndSpread | None:
    """How uncertain the subjects' ranges are, from those of tissues that their data allow; None without any."""
    if len(drawn) < 2:
        return None
    power = drawn[0].power
    low = {PEAK: [one.peak_low_N for one in drawn], ENERGY: [one.energy_low_mJ for one in drawn]}
    high = {PEAK: [one.peak_high_N for one in drawn], ENERGY: [one.energy_high_mJ for one in drawn]}
    low[STEADY], high[STEADY] = [one.soft_mm**-power for one in drawn], [one.stiff_mm**-power for one in drawn]
    return EndSpread(*({name: _log_spread(np.array(rows)) for name, rows in ends.items()} for ends in (low, high)))


def _log_spread(values: NDArray) -> NDArray:
    """Standard deviation of the logarithms over the first axis, of values that are known; NaN for fewer than two."""
    known = np.isfinite(values) & (values > 0.0)
    logs = np.where(known, np.log(np.where(known, values, 1.0)), 0.0)
    count = known.sum(axis=0)
    mean = logs.sum(axis=0) / np.maximum(count, 1)
    square = (np.where(known, logs - mean, 0.0) ** 2).sum(axis=0)
    return np.where(count > 1, np.sqrt(square / np.maximum(count - 1, 1)), np.nan)


def log_spreads(every: Deviations) -> dict[str, NDArray]:
    """Standard deviation of the logarithm of each reading over pads, by quantity."""
    return {name: _log_spread(ratios) for name, ratios in every.above.items()}


@dataclass(frozen=True)
class Deciding:
    """The reading with the largest probability of being outside its limits: quantity, place, and which end is near."""

    quantity: str
    at: int
    side: str


def deciding(
    differences: Deviations, limits: tuple[float, float | None], spread: Mapping[str, NDArray], ends: EndSpread | None
) -> Deciding | None:
    """Find the reading that decides; None where nothing was reached.

    Parameters
    ----------
    differences : Deviations
        Of the one pad.
    limits : (float, float or None)
        Largest shortfall and over-reading; None for no limit.
    spread : mapping
        Standard deviation of the logarithm of each reading, by quantity.
    ends : EndSpread or None
        Of the subjects' ranges.
    """
    best: tuple[float, Deciding] | None = None
    for side, ratios, limit in ((LOW, differences.short, limits[0]), (HIGH, differences.above, limits[1])):
        if limit is None:
            continue
        for name, values in ratios.items():
            u = np.hypot(spread[name], 0.0 if ends is None else np.nan_to_num(getattr(ends, side)[name]))
            with np.errstate(invalid="ignore", divide="ignore"):
                room = np.log(limit / values[0]) / np.maximum(u, 1e-9)
            room = np.where(np.isfinite(room), room, np.nan)
            if np.isnan(room).all():
                continue
            at = int(np.nanargmin(room))
            if best is None or room[at] < best[0]:
                best = float(room[at]), Deciding(name, at, side)
    return None if best is None else best[1]


def budget_of_pad(
    ranges: Ranges,
    readings: Readings,
    limits: tuple[float, float | None],
    parts: Mapping[str, Readings],
    whole: Readings,
    ends: EndSpread | None,
) -> Budget | None:
    """Make the budget of one pad against the subjects' ranges; None where no press was reached.

    Parameters
    ----------
    ranges : Ranges
        What the subjects do.
    readings : Readings
        Of the pad.
    limits : (float, float or None)
        Largest shortfall and over-reading of the requirement.
    parts : mapping of str to Readings
        By name of a component: readings of pads of which only this is drawn.
    whole : Readings
        Of pads of which all is drawn: they say which reading decides.
    ends : EndSpread or None
        Uncertainty of the subjects' ranges.
    """
    if ranges.strict and ends is not None:
        ends = EndSpread(ends.high, ends.high)  # both sides are held to the highest subject
    differences = deviations(ranges, readings)
    found = deciding(differences, limits, log_spreads(deviations(ranges, whole)), ends)
    if found is None:
        return None
    name, at = found.quantity, found.at
    components = [
        UncertaintyComponent(part, _percent(log_spreads(deviations(ranges, drawn))[name][at]))
        for part, drawn in parts.items()
    ]
    own = 0.01 * combined_percent(tuple(components))
    of_ends = [0.0, 0.0] if ends is None else [float(np.nan_to_num(side[name][at])) for side in (ends.low, ends.high)]
    near = of_ends[0 if found.side == LOW else 1]
    components.append(UncertaintyComponent(SUBJECTS, None if ends is None else 100.0 * near))
    value = float({PEAK: readings.peak_N, ENERGY: readings.energy_mJ, STEADY: ranges.steady_N}[name][at])
    short = differences.short.get(name)
    low = None if short is None else value * float(short[0][at]) / limits[0]
    high = None if limits[1] is None else value / float(differences.above[name][0][at]) * limits[1]
    exact = decide(value, (low, high), (own, own))
    made = decide(value, (low, high), (math.hypot(own, of_ends[0]), math.hypot(own, of_ends[1])))
    missing = int((~np.isfinite(readings.peak_N)).sum())
    force, speed = (
        (ranges.steady_N[at], ranges.velocity_mm_s.min())
        if name == STEADY
        else (ranges.force_N[at], ranges.velocity_mm_s[at])
    )
    reading = Reading(QUANTITY_WORDS[name], value, UNITS[name], float(force), float(speed))
    return Budget(
        reading,
        tuple(components),
        requirement_words(limits, ranges.strict),
        made,
        None if ends is None else exact,
        missing,
    )


def _percent(value: float) -> float | None:
    return 100.0 * float(value) if np.isfinite(value) else None


def requirement_words(limits: tuple[float, float | None], strict: bool) -> str:
    """The requirement that a reading is held to, in words."""
    if strict:
        return f"not below the highest subject over {limits[0]:g}"
    return f"usable: from the lowest subject over {limits[0]:g} to the highest times {limits[1]:g}"


def usable_limits(limits: VerdictLimits, strict: bool) -> tuple[float, float | None]:
    """Largest shortfall and over-reading with which a pad may be used; on the safe side nothing limits the second."""
    return (limits.stands_shortfall, None) if strict else (limits.shortfall, limits.over)


def budget_of_castings(cast: PadCastings) -> Budget | None:
    """Make the budget of a designed pad: each group of its castings alone, then the subjects."""
    targets, every = cast.space.targets, frozenset(GROUPS)
    ranges = ranges_of(targets)
    parts = {name: cast.few.readings(every - {group}) for group, name in OF_GROUPS.items()}
    ends = spread_of_ends([ranges_of(one) for one in targets.drawn])
    limits = usable_limits(targets.limits, ranges.strict)
    middle = cast.finite_strain.judged(cast.candidate.readings)
    return budget_of_pad(ranges, middle, limits, parts, cast.readings(), ends)
