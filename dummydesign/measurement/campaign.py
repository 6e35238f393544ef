"""A measurement campaign: what was cast, the punch, the sensor and the trials, as plain values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace


@dataclass(frozen=True)
class PadSpec:
    """What was cast: nominal modulus or resin and ratio, outline, and how it lies on its base."""

    young_kPa_nominal: float | None
    resin: str | None
    ratio: float | None
    shape: str
    length_mm: float | None
    width_mm: float | None
    diameter_mm: float | None
    base: str


@dataclass(frozen=True)
class PunchSpec:
    """The impactor: ``square`` (side), ``round`` (diameter) or ``plate``, and its contact."""

    shape: str
    side_mm: float | None
    diameter_mm: float | None
    contact: str

    @property
    def radius_mm(self) -> float:
        """Radius of the circle of equal area. [mm]"""
        if self.shape == "square" and self.side_mm is not None:
            return float(self.side_mm) / math.sqrt(math.pi)
        if self.shape == "round" and self.diameter_mm is not None:
            return 0.5 * float(self.diameter_mm)
        raise InputError("a plate has no radius of equal area")


@dataclass(frozen=True)
class Trial:
    """One press with what was declared of it; None where nothing was declared."""

    file: str
    thickness_mm: float
    velocity_mm_s: float
    hold_s: float | None
    target_force_N: float | None
    repeat: int
    sequence: int
    rest_s: float | None
    temperature_C: float | None
    age_days: float | None
    trace: Trace = field(repr=False)


@dataclass(frozen=True)
class Campaign:
    """A checked campaign, trials in the order of ``campaign.toml``."""

    name: str
    folder: Path
    pad: PadSpec
    punch: PunchSpec
    lowpass: Lowpass | None
    force_resolution_N: float
    trials: tuple[Trial, ...]
    warnings: tuple[dict[str, str], ...] = ()
