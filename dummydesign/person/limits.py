"""Limits with a guard band: pass, fail or undecided by the 95 % end of what people bear."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import Serialised
from dummydesign.core.toml_schema import read_table

N_PER_CM2 = 100.0
"""Pressure of 1 N/mm2. [N/cm2]"""


@dataclass(frozen=True)
class UserLimits(Serialised):
    """A user's limits at one site, each with source: force [N] and pressure [N/cm2], and the transient factor."""

    name: str
    force_N: Quantity
    pressure_N_per_cm2: Quantity
    transient_factor: Quantity


def read_limits(path: str | Path) -> UserLimits:
    """Read a limits file: ``name`` and the three numbers, each with value, low, high, kind, source."""
    names = ("force_N", "pressure_N_per_cm2", "transient_factor")
    table = read_table(Path(path), ("schema", "name", *names), schema=None)
    return UserLimits(str(table.data.get("name", Path(path).stem)), *(table.quantity(name) for name in names))


@dataclass(frozen=True)
class LimitRow(Serialised):
    """One limit: the value on the pad, the 95 % interval on one more person, the result and why."""

    name: str
    unit: str
    limit: float
    pad: float | None
    person_low_95: float | None
    person_high_95: float | None
    result: str
    reason: str
    source: str


@dataclass(frozen=True)
class ContactLoad:
    """One kind of contact: force on the pad, 95 % ends on one more person, lower 95 % ends of the subjects. [N]"""

    kind: str
    pad_N: float | None
    low_N: float | None
    high_N: float | None
    subjects_low_N: tuple[float, ...]


def decide(high: float | None, subjects_low: tuple[float, ...], limit: float, extrapolated: bool) -> tuple[str, str]:
    """Decide one limit with a guard band as wide as the doubt.

    Pass: the upper end of the 95 % interval of one more person is at most the limit, and nothing is extrapolated.
    Fail: the lower end of one subject's own interval is above it. Else undecided.

    References
    ----------
    JCGM 106:2012, 8.3 (guarded acceptance and guarded rejection).
    """
    if subjects_low and max(subjects_low) > limit:
        return "fail", "even the lower 95 % end of the highest subject is above the limit"
    if high is None:
        return "undecided", "the 95 % interval of people is not known"
    if high > limit:
        return "undecided", "the upper 95 % end of people is above the limit"
    if extrapolated:
        return "undecided", "the press goes beyond the range in which people were pressed"
    return "pass", "the upper 95 % end of people is at most the limit"


def against_guarded_limits(
    loads: list[ContactLoad], limits: UserLimits, area_mm2: float, extrapolated: bool
) -> tuple[LimitRow, ...]:
    """Compare loads with limits of force and of mean pressure, quasi-static and transient.

    Parameters
    ----------
    loads : list of Load
        ``quasi-static`` (largest force later than 0.5 s) and ``transient`` (peak).
    limits : Limits
    area_mm2 : float
        Of the punch. [mm2]
    extrapolated : bool
        Whether the press goes beyond the range in which people were pressed.
    """
    rows = []
    for name, unit, quantity, scale in (
        ("force", "N", limits.force_N, 1.0),
        ("mean pressure", "N/cm2", limits.pressure_N_per_cm2, N_PER_CM2 / area_mm2),
    ):
        for load in loads:
            if load.pad_N is None and load.high_N is None and not load.subjects_low_N:
                continue
            limit = quantity.value * (limits.transient_factor.value if load.kind == "transient" else 1.0)
            pad, low, high = (None if one is None else one * scale for one in (load.pad_N, load.low_N, load.high_N))
            result, reason = decide(high, tuple(one * scale for one in load.subjects_low_N), limit, extrapolated)
            rows.append(LimitRow(f"{name} {load.kind}", unit, limit, pad, low, high, result, reason, quantity.source))
    return tuple(rows)
