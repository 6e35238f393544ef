"""The verdict in one sentence: what is low comes first, with how far and where."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from dummydesign.design.scoring.verdict import Flags, Ranges, Readings


@dataclass(frozen=True)
class Findings:
    """What the sentence is made of."""

    ranges: Ranges
    readings: Readings
    flags: Flags
    steady: dict[str, float | None]
    low_share: float | None
    inside_share: float | None
    doubtful: bool
    of: str
    alone: bool
    unsettled: str

    @property
    def below(self) -> int:
        return int(self.flags.peak_low.sum())

    @property
    def above(self) -> int:
        return int(self.flags.peak_high.sum())

    @property
    def furthest(self) -> tuple[float, str]:
        """How far below the lowest subject the lowest peak or energy is in percent, and where."""
        for flag, value, low in (
            (self.flags.peak_low[0], self.readings.peak_N, self.ranges.peak_low_N),
            (self.flags.energy_low[0], self.readings.energy_mJ, self.ranges.energy_low_mJ),
        ):
            if flag.any():
                share = np.where(flag, value / low - 1.0, np.inf)
                at = int(np.argmin(share))
                where = f"{self.ranges.force_N[at]:.3g} N, {self.ranges.velocity_mm_s[at]:g} mm/s"
                return -100.0 * float(share[at]), where
        return 0.0, ""


def sentence(level: str, found: Findings, limits: Sequence[str]) -> str:
    """The verdict in words; what is low comes first.

    Parameters
    ----------
    level : str
        As judged.
    found : Findings
    limits : sequence of str
        Limits that bind.
    """
    low = _below_words(found)
    high = _above_words(found)
    if level == "reads_low":
        text = f"reads low, the unsafe side: {low}; a robot that passes on this pad may not pass on the person"
        if high:
            text += f" ({high})"
    elif level == "mixed" and low:
        text = f"mixed: {low}, which is the unsafe side, and {high}"
    elif level == "mixed":
        text = f"mixed, not settled: {_doubt_words(found, high)}"
    elif level == "reads_high":
        text = f"reads high, the strict side: {high}; nothing is below every subject's"
    elif level == "poor":
        text = f"poor: {_poor_words(found, high)}"
    else:
        steady = _percent(found.steady["in"])
        text = f"inside: all {_count(found)} peaks and {steady} of the steady curve lie among the subjects'"
        if found.low_share is not None:
            text += f"; {_share(found.low_share)} of {found.of} read low"
    if found.alone and level != "poor":
        text += "; one subject makes no range: the pad is held against this one person"
    return text + (f"; bound by {' and '.join(limits)}" if limits and level != "inside" else "")


def _count(found: Findings) -> int:
    return int(np.isfinite(found.readings.peak_N).sum())


def _below_words(found: Findings) -> str:
    every, flags = _than(found), found.flags
    parts = []
    if found.below:
        percent, where = found.furthest
        verb = "is" if found.below == 1 else "are"
        text = f"{found.below} of {_count(found)} peaks {verb} below {every}, by up to {percent:.0f} % ({where})"
        parts.append(text)
    if found.steady["below"]:
        parts.append(f"the steady force is below {every} over {_percent(found.steady['below'])} of {_span(found)}")
    if flags.energy_low.any():
        parts.append(f"{_presses(flags.energy_low)} below {every}")
    return ", ".join(parts)


def _above_words(found: Findings) -> str:
    every, flags = _than(found), found.flags
    parts = []
    if found.above:
        verb = "is" if found.above == 1 else "are"
        parts.append(f"{found.above} of {_count(found)} peaks {verb} above {every}")
    if found.steady["above"]:
        parts.append(f"the steady force is above {every} over {_percent(found.steady['above'])} of {_span(found)}")
    if flags.energy_high.any():
        parts.append(f"{_presses(flags.energy_high)} above {every}")
    return ", ".join(parts)


def _span(found: Findings) -> str:
    forces = found.ranges.steady_N
    return f"{forces[0]:.3g} to {forces[-1]:.3g} N"


def _doubt_words(found: Findings, high: str) -> str:
    if found.alone and not found.doubtful and not high:
        return "nothing is further from the one subject than can be set"
    stands = high or "as it stands nothing is outside the subjects' ranges"
    if found.unsettled:
        stands += f", but {found.unsettled}"
    if not found.doubtful:
        return stands
    shares = f"{_share(found.low_share)} of {found.of} read low and {_share(found.inside_share)} are inside"
    return f"{stands}, but {shares}"


def _poor_words(found: Findings, high: str) -> str:
    missing = int(found.flags.unreached.sum())
    parts = [f"{missing} of {len(found.readings.peak_N)} presses are out of the pad's reach"] if missing else []
    return ", ".join([*parts, *filter(None, [high])]) or "the steady curve lies outside the subjects"


def _presses(flags: NDArray) -> str:
    count = int(flags.sum())
    return f"the energy of {'1 press' if count == 1 else f'{count} presses'} is"


def _than(found: Findings) -> str:
    return "the one subject's" if found.alone else "every subject's"


def _percent(share: float | None) -> str:
    return "none" if share is None else f"{100 * share:.0f} %"


def _share(share: float | None) -> str:
    """A share of draws in percent; what is rare is not called never."""
    if share is None:
        return "an unknown share"
    return "less than 1 %" if share < 0.01 else f"{100 * share:.0f} %"
