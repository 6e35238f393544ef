"""The verdict in one sentence or two: the level, then the worst reading with its size, then the castings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dummydesign.design.scoring.deviations import (
    ENERGY,
    OUT_OF_REACH,
    OVER,
    PEAK,
    READS_LOW,
    STANDS_FOR,
    STEADY,
    USABLE,
    tolerance_of,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.design.scoring.verdict import Findings

LEVEL_WORDS = {
    "stands_for": "Stands for the subjects",
    "usable_with_correction": "Usable with a correction",
    "not_settled": "Not settled",
    "not_representative": "Not representative",
}
QUANTITIES = {PEAK: "the peak", STEADY: "the steady force at equal depth", ENERGY: "the energy"}
OUTCOMES = {OUT_OF_REACH: "out of reach", READS_LOW: "too low", OVER: "too high"}


def sentence(of: Findings) -> str:
    """Write the verdict: level, worst reading, castings, limits that bind.

    Parameters
    ----------
    of : Findings
    """
    parts = [_readings(of), _castings(of), _ending(of)]
    said = "; ".join(part for part in parts if part)
    text = f"{LEVEL_WORDS[of.level]}. {said[0].upper()}{said[1:]}." if said else f"{LEVEL_WORDS[of.level]}."
    if of.bound and of.level != "stands_for":
        text += f" At the limit of {' and of '.join(of.bound)}."
    return text


def whole_percents(shares: list[float], taken: int | None = None) -> list[int]:
    """Round shares to whole per cent so that they keep their sum.

    Parameters
    ----------
    shares : list of float
        They sum to at most 1.
    taken : int, optional
        What others have of 100: these then fill it.
    """
    exact = 100.0 * np.array(shares)
    whole = np.floor(exact).astype(int)
    left = (round(float(exact.sum())) if taken is None else 100 - taken) - int(whole.sum())
    if left < 0:
        whole[np.argsort(exact - whole - 1.0 * (whole > 0), kind="stable")[: -left]] -= 1
    else:
        whole[np.argsort(whole - exact, kind="stable")[:left]] += 1
    return [int(value) for value in whole]


def factor_words(force: float | None, every: float | None) -> str:
    """What readings are multiplied by: forces, and energies where they need more."""
    if every is None or force is None:
        return ""
    if every - force < 0.005:
        return f"multiply readings by {every:.2f}"
    if force < 1.0 + tolerance_of(PEAK):
        return f"multiply energies by {every:.2f}, forces by nothing"
    return f"multiply forces by {force:.2f}, energies by {every:.2f}"


def _readings(of: Findings) -> str:
    """What leaves the subjects most, below before above; else that nothing does."""
    missing = int((~np.isfinite(of.readings.peak_N)).sum())
    if missing:
        return f"{missing} of {len(of.readings.peak_N)} presses are out of reach"
    who = "the one subject" if of.found.ranges.subjects < 2 else "all subjects"
    if of.strict:
        below, above = _worst(of, of.found.short, "below", "the highest subject"), _worst(
            of, of.found.above, "above", who)  # fmt: skip
        price = f"price of the safe side: {above}" if above else ""
        kept = "no peak and no steady force is below the highest subject"
        return "; ".join(part for part in (below or kept, price) if part)
    short, over = of.found.worst(of.found.short)[0], of.found.worst(of.found.above)[0]
    below, above = _worst(of, of.found.short, "below", who), _worst(of, of.found.above, "above", who)
    if below and above:
        return f"{below}, and {above}" if short >= over or of.level != "not_representative" else f"{above}, and {below}"
    if below or above:
        return below or above
    if who == "the one subject":
        return "all readings are as near to the one subject as can be set"
    return f"all {len(of.readings.peak_N)} peaks and the steady curve are among the subjects"


def _worst(of: Findings, ratios: dict[str, NDArray], side: str, who: str) -> str:
    """The largest ratio in words; empty where it is within tolerance."""
    value, name, at = of.found.worst(ratios)
    if not value > 1.0 + tolerance_of(name):
        return ""
    ranges = of.found.ranges
    # how far the reading is below a subject's is told as a share of the subject's
    percent = 100.0 * (1.0 - 1.0 / value if side == "below" else value - 1.0)
    if name == STEADY:
        where = f"({ranges.steady_N[at]:.3g} N)"
    else:
        where = f"at {ranges.force_N[at]:.3g} N, {ranges.velocity_mm_s[at]:g} mm/s"
    reading = f" ({of.readings.peak_N[at]:.1f} N)" if name == PEAK else ""
    return f"{QUANTITIES[name]} {where}{reading} is {percent:.0f} % {side} {who}"


def _castings(of: Findings) -> str:
    """What becomes of the castings; the classes add up to 100 %."""
    if of.shares is None:
        return ""
    share = of.shares[STANDS_FOR] + (0.0 if of.strict else of.shares[USABLE])
    good, *rest = (round(100.0 * share), *whole_percents([of.shares[name] for name in OUTCOMES], round(100.0 * share)))
    lost = [(name, percent) for name, percent in zip(OUTCOMES, rest) if percent > 0]
    word = "keep the safe side" if of.strict else "are usable"
    if of.level == "not_settled" and share < of.limits.share <= 0.01 * good:
        text = f"{np.floor(1000.0 * share) / 10.0:.1f} % of {of.of} {word}"  # not rounded up to the limit
    else:
        text = f"{good} % of {of.of} {word}"
    if lost and of.level != "stands_for":
        text += " (" + ", ".join(f"{percent} % {OUTCOMES[name]}" for name, percent in lost) + ")"
    return text


def _ending(of: Findings) -> str:
    """The correction, or why nothing is settled."""
    if of.unsettled and of.level in ("not_settled", "not_representative"):
        return of.unsettled
    if of.level == "usable_with_correction" and of.correction.factor is not None:
        if of.correction.factor < 1.0 + tolerance_of(PEAK):
            return "no correction is needed"
        words = factor_words(of.correction.force, of.correction.factor)
        return f"{words} for 95 % of them" if of.shares is not None else words
    return ""
