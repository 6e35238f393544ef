"""A measurement campaign: pads, punch, sensor and trials; the force that was held, and the edges that are solved."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import LARGEST_EDGE_RADIUS
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.measurement.ramp_detection import Ramp
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


def with_edge(punch: str, edge_radius_mm: float) -> str:
    """A punch as it is typed, with the fillet of its edge where it has one."""
    return f"{punch}, edge radius {edge_radius_mm:g} mm" if edge_radius_mm else punch


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
        return with_edge(words, self.edge_radius_mm)

    @property
    def radius_mm(self) -> float:
        """Radius of the circle of equal area; the largest of a ball or profile. [mm]"""
        if self.profile_mm is not None:
            return self.profile_mm[0][-1]
        if self.shape == "square" and self.side_mm is not None:
            return float(self.side_mm) / math.sqrt(math.pi)
        if self.shape == "round" and self.diameter_mm is not None:
            return 0.5 * float(self.diameter_mm)
        raise InputError("a plate has no radius of equal area", "not_applicable", "punch.shape", self.shape)


@dataclass(frozen=True)
class Trial:
    """One press with what was declared of it; None where nothing was declared.

    ``thickness_sd_mm`` is the standard error of a thickness that was measured, ``design_thickness_mm`` what the pad was
    designed as. ``geometry`` is the shape of the pad. ``witness_kPa`` is the modulus of a puck of the pad's own batch,
    ``weighed_ratio`` the ratio that was weighed, each with its standard error. ``young_factor`` is what these make of
    the pad's modulus over that of the campaign's usual pad, and ``young_factor_sd`` the standard deviation of its
    logarithm; the loop sets them. ``lowpass`` is a filter of its own, and ``confirmed`` says that its labels
    were looked at again.
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
    design_thickness_mm: float | None = None
    witness_kPa: float | None = None
    witness_sd_kPa: float | None = None
    weighed_ratio: float | None = None
    weighed_ratio_sd: float | None = None
    young_factor: float = 1.0
    young_factor_sd: float = 0.0
    lowpass: Lowpass | None = None
    confirmed: bool = False

    @property
    def pad(self) -> tuple[str, float]:
        """What a pad is known by: its shape as typed (empty for a slab) and its thickness. [-, mm]"""
        return "" if self.geometry.plain else str(self.geometry), self.thickness_mm


@dataclass(frozen=True)
class Campaign:
    """A checked campaign, trials in the order of ``campaign.toml``; ``records`` are files of pads that it names.

    ``usual_pad`` are witness and weighed ratio of the pad that the modulus is of; the loop sets them.
    """

    name: str
    folder: Path
    pad: PadSpec
    punch: PunchSpec
    lowpass: Lowpass | None
    force_resolution_N: float
    trials: tuple[Trial, ...]
    warnings: tuple[dict[str, str], ...] = ()
    records: tuple[Path, ...] = ()
    usual_pad: Mapping[str, float] = field(default_factory=dict)


def held_force(trace: Trace, ramp: Ramp) -> float:
    """Return the median force of the last fifth of the hold. [N]"""
    late = trace.time_s >= ramp.hold_end_s - 0.2 * (ramp.hold_end_s - ramp.stop_time_s)
    return float(np.median(trace.force_N[late & (trace.time_s <= ramp.hold_end_s)]))


def check_edge(pad: PadSpec, punch: PunchSpec, shapes: Sequence[PadShape], where: str = "") -> None:
    """Refuse a fillet of the punch's edge that is too large, or where the force law with it is not solved.

    Parameters
    ----------
    pad : PadSpec
    punch : PunchSpec
    shapes : sequence of PadShape
        Of the pads that are pressed.
    where : str
        Begins the message.
    """
    edge = punch.edge_radius_mm
    if not edge:
        return
    text = f"{where}edge_radius_mm = {edge:g}"
    width = {"square": punch.side_mm, "round": punch.diameter_mm}.get(punch.shape)
    if width is None:
        raise InputError(f"{text}: a {punch.shape} has no edge", "not_applicable", "edge_radius_mm", edge)
    most = LARGEST_EDGE_RADIUS * 0.5 * width
    if not 0.0 < edge <= most * (1.0 + 1e-9):
        raise InputError(
            f"{text} is outside the allowed range 0 to {most:.4g}, {LARGEST_EDGE_RADIUS:g} of the punch's half-width",
            "out_of_range",
            "edge_radius_mm",
            edge,
            (0.0, most),
        )
    shaped = [shape for shape in shapes if not shape.plain]
    unsolved = [f"shape = {shape}" for shape in shaped if not shape.axisymmetric][:1]
    contact = Interface.find(punch.contact, CONDITIONS)
    # a face that slides or rubs round the fillet is followed on slabs only
    glued = contact is not None and contact.bonded
    unsolved += [] if contact and (glued or not shaped) else [f"contact = {punch.contact}"]
    held = ("bonded",) if any(shape.bone_height_mm for shape in shaped) else BASES
    unsolved += [] if pad.base in held else [f"base = {pad.base}"]
    if unsolved:
        raise InputError(
            f"{text} with {unsolved[0]} is not solved; a fillet goes with a flat punch on slabs, or glued "
            "on round shapes, whose base is bonded, or sliding without a bone: give 0 for the sharp edge",
            "unsupported",
            "edge_radius_mm",
            edge,
        )
