"""A measurement campaign: what was cast, the punch, the sensor and the trials, as plain values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes import PadShape, Slab
from dummydesign.measurement.sensor import Lowpass
from dummydesign.measurement.trace import Trace

SLAB = Slab()


@dataclass(frozen=True)
class PadSpec:
    """What was cast: nominal modulus or resin and ratio, outline, shape, and how it lies on its base.

    ``shape`` is ``slab`` (a pad on a base, of any ``geometry``) or ``cylinder`` (a puck between plates).
    """

    young_kPa_nominal: float | None
    resin: str | None
    ratio: float | None
    shape: str
    length_mm: float | None
    width_mm: float | None
    diameter_mm: float | None
    base: str
    geometry: PadShape = SLAB


@dataclass(frozen=True)
class PunchSpec:
    """The impactor: ``square`` (side), ``round`` or ``ball`` (diameter), ``profile`` or ``plate``, and its contact.

    ``profile_mm`` are radii and heights over the lowest point, of ball and profile. ``edge_radius_mm`` is the fillet of
    a flat punch's edge, 0 for a sharp one.
    """

    shape: str
    side_mm: float | None
    diameter_mm: float | None
    contact: str
    profile_mm: tuple[tuple[float, ...], tuple[float, ...]] | None = None
    edge_radius_mm: float = 0.0

    @property
    def text(self) -> str:
        """As it is typed, such as ``square:14``, with the fillet of its edge; the kind alone of plate and profile."""
        size = self.side_mm if self.shape == "square" else self.diameter_mm
        words = self.shape if size is None or self.shape in ("plate", "profile") else f"{self.shape}:{size:g}"
        return f"{words}, edge radius {self.edge_radius_mm:g} mm" if self.edge_radius_mm else words

    @property
    def radius_mm(self) -> float:
        """Radius of the circle of equal area; the largest of a ball or profile. [mm]"""
        if self.profile_mm is not None:
            return self.profile_mm[0][-1]
        if self.shape == "square" and self.side_mm is not None:
            return float(self.side_mm) / math.sqrt(math.pi)
        if self.shape == "round" and self.diameter_mm is not None:
            return 0.5 * float(self.diameter_mm)
        raise InputError("a plate has no radius of equal area")


@dataclass(frozen=True)
class Trial:
    """One press with what was declared of it; None where nothing was declared.

    ``thickness_sd_mm`` is the standard error of a thickness that was measured. ``geometry`` is the shape of the pad.
    """

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
    geometry: PadShape = SLAB
    thickness_sd_mm: float | None = None

    @property
    def pad(self) -> tuple[str, float]:
        """What a pad is known by: its shape as typed (empty for a slab) and its thickness. [-, mm]"""
        return "" if self.geometry.plain else str(self.geometry), self.thickness_mm


@dataclass(frozen=True)
class Campaign:
    """A checked campaign, trials in the order of ``campaign.toml``; ``records`` are files of pads that it names."""

    name: str
    folder: Path
    pad: PadSpec
    punch: PunchSpec
    lowpass: Lowpass | None
    force_resolution_N: float
    trials: tuple[Trial, ...]
    warnings: tuple[dict[str, str], ...] = ()
    records: tuple[Path, ...] = ()
