"""The ring mould of a witness puck: sizes, volumes in closed form, printing hours and grams. No CAD.

A ring is two equal halves, upright prisms without an overhang, held by a clip on each pair of lugs. A ridge on one lug
of each half lies in a groove of the other's, so that the halves meet in one place. The ring stands on release film on a
flat plate; a second plate strikes the resin off at its rim. The halves are taken apart to free the puck, so its side
needs no draft: a draft would make the puck a cone, whose modulus no closed form gives.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Any

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import read_size
from dummydesign.core.serialise import rebuild, to_plain
from dummydesign.mold.model.layout import Outline, bed_spare_mm, cavity_scale
from dummydesign.mold.model.preset import mould_spec
from dummydesign.mold.model.products import Machines, Plastic
from dummydesign.mold.model.spec import Acceptance, Pour, without_usual, without_zeros

WALL_MM, LUG_LONG_MM, LUG_THICK_MM, RIDGE_MM = 2.4, 8.0, 4.0, 1.0
"""Wall (six lines of a 0.4 mm nozzle), length and thickness of a lug, height of the ridge on it."""
DIAMETERS_MM, HEIGHTS_MM = (15.0, 150.0), (8.0, 100.0)
MOST = 12
PRINTED = "printed"
DUMMY_MM = 10.0, 40.0, 40.0
"""Thickness, length and width of a pad whose mould is never made: presets are read by the function that reads a
pad's."""


@dataclass(frozen=True)
class Ring:
    """The ring of one size of puck, ``count`` of them; ``diameter_mm`` and ``height_mm`` are of the cured puck."""

    diameter_mm: float
    height_mm: float
    count: int = 1

    def __post_init__(self) -> None:
        from dummydesign.pad.tables.puck import shape_range

        for name, value, (low, high) in (
            ("puck diameter", self.diameter_mm, DIAMETERS_MM),
            ("puck height", self.height_mm, HEIGHTS_MM),
        ):
            if not low <= value <= high:
                raise out_of_range(name, f"{value:g}", f"{low:g}", f"{high:g}", "mm")
        low, high = shape_range()
        shape = self.diameter_mm / self.height_mm
        if not low * (1 - 1e-6) <= shape <= high * (1 + 1e-6):
            raise out_of_range(
                "puck diameter over height",
                f"{shape:.3g}",
                f"{low:.3g}",
                f"{high:.3g}",
                "for which plate friction is solved",
            )

    @property
    def tag(self) -> str:
        """Size as it stands in file names: ``50x30``."""
        return f"{self.diameter_mm:g}x{self.height_mm:g}"

    @property
    def volume_mm3(self) -> float:
        """Volume of the cured puck."""
        return math.pi / 4 * self.diameter_mm**2 * self.height_mm


@dataclass(frozen=True)
class PuckSpec:
    """Everything that pucks of one pour are made from; equal specifications have equal hashes and equal files."""

    preset: str
    rings: tuple[Ring, ...]
    pour: Pour
    machines: Machines
    plastic: Plastic
    acceptance: Acceptance
    sources: tuple[str, ...] = ()

    @property
    def scale(self) -> float:
        """Factor from the cured puck to the cold ring."""
        return cavity_scale(self.pour, self.plastic.expansion_per_K or 0.0)

    @property
    def pucks(self) -> int:
        """How many pucks are cast."""
        return sum(ring.count for ring in self.rings)

    @property
    def tag(self) -> str:
        """Sizes as they stand in file names."""
        return "_".join(ring.tag + (f"_x{ring.count}" if ring.count > 1 else "") for ring in self.rings)

    @property
    def title(self) -> str:
        """Pucks in words."""
        sizes = " and ".join(f"{ring.count} of {ring.diameter_mm:g} x {ring.height_mm:g} mm" for ring in self.rings)
        return (
            f"puck {self.rings[0].diameter_mm:g} x {self.rings[0].height_mm:g} mm"
            if self.pucks == 1
            else (f"{self.pucks} pucks ({sizes})")
        )

    def to_dict(self) -> dict[str, Any]:
        """Return nested plain dictionaries."""
        plain = to_plain(asdict(self))
        machines = without_zeros(plain["machines"], "bed_diameter_mm")
        return {**plain, "pour": without_usual(plain["pour"]), "machines": machines}

    @staticmethod
    def from_dict(data: dict[str, Any]) -> PuckSpec:
        """Rebuild a specification from :meth:`to_dict`."""
        return replace(rebuild(PuckSpec, {**data, "rings": []}), rings=tuple(Ring(**one) for one in data["rings"]))

    @cached_property
    def hash(self) -> str:
        """First eight hexadecimal digits (upper case) of the SHA-256 of the specification."""
        same = replace(self, pour=replace(self.pour, assumed=(), chemistry=""))
        text = json.dumps(same.to_dict(), sort_keys=True, separators=(",", ":"), allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:8].upper()


def read_pucks(text: str) -> tuple[Ring, ...]:
    """Read ``50x30`` or ``50x30,40x25``: diameter x height of each puck in mm; the same size twice is two pucks."""
    sizes: list[tuple[float, float]] = []
    for part in text.split(","):
        try:
            sizes.append(read_size(part.strip().lower(), "puck"))
        except InputError:
            message = f"--puck {part.strip()!r} must be diameter x height in mm, such as 50x30"
            raise InputError(message, "malformed", "puck", part.strip()) from None
    if len(sizes) > MOST:
        raise out_of_range("number of pucks", len(sizes), 1, MOST)
    return tuple(Ring(*size, count) for size, count in Counter(sizes).items())


def puck_spec(rings: Sequence[Ring], preset: str = PRINTED, resin: str | None = None, ratio: float = 15.0) -> PuckSpec:
    """Put together what pucks are made from; machines and plastic are those of a preset of printed moulds."""
    pad = mould_spec(*DUMMY_MM, preset=preset, resin=resin, ratio=ratio)
    if not pad.is_printed or pad.plastic is None:
        message = f"preset '{preset}' is of silicone moulds; a puck's ring is printed: leave --preset out"
        raise InputError(message, "not_applicable", "preset", preset, [PRINTED])
    sources = tuple(one for one in pad.sources if not one.startswith(("surface ", "silicone ")))
    spec = PuckSpec(pad.preset, tuple(rings), pad.pour, pad.machines, pad.plastic, pad.acceptance, sources)
    check_bed(spec)
    return spec


def check_bed(spec: PuckSpec) -> None:
    """Refuse a ring that is larger than the printer."""
    for ring in spec.rings:
        if (spare := spare_mm(spec, ring)) < 0.0:
            raise InputError(
                f"the ring of a puck of {ring.tag} mm does not fit the printer of {spec.machines.name} (too large by "
                f"{-spare:.0f} mm); cast a smaller puck, or name your printer in a preset",
                "cannot_be_made",
                "puck",
                ring.tag,
            )


def spare_mm(spec: PuckSpec, ring: Ring) -> float:
    """Room that a half leaves on the printer, in the direction with the least. [mm]"""
    long, wide = half_size_mm(spec, ring)
    grow = spec.machines.print_scale
    half = Outline(grow * long, grow * wide, 0.0)
    return bed_spare_mm(spec.machines, half, grow * spec.scale * ring.height_mm)


def half_size_mm(spec: PuckSpec, ring: Ring) -> tuple[float, float]:
    """Length and width of a half in plan. [mm]"""
    outer = spec.scale * ring.diameter_mm / 2 + WALL_MM
    return 2 * (outer + LUG_LONG_MM), outer + RIDGE_MM


def half_area_mm2(spec: PuckSpec, ring: Ring) -> float:
    """Area of a half in plan: half an annulus, two lugs outside it, the ridge less the groove.

    A lug of thickness t reaches from the circle of radius R to R + l: (R + l) t less the circle's part below t,
    (t sqrt(R^2 - t^2) + R^2 asin(t / R)) / 2.
    """
    inner = spec.scale * ring.diameter_mm / 2
    outer = inner + WALL_MM
    t = LUG_THICK_MM
    under = 0.5 * (t * math.sqrt(outer**2 - t**2) + outer**2 * math.asin(t / outer))
    lug = (outer + LUG_LONG_MM) * t - under
    return math.pi / 2 * (outer**2 - inner**2) + 2 * lug + RIDGE_MM**2 - groove_mm(spec) ** 2


def groove_mm(spec: PuckSpec) -> float:
    """Depth of the groove: the ridge and the gap of the machine's prints, its sides at 45 degrees. [mm]"""
    return RIDGE_MM + spec.machines.gap_mm


def ring_volume_mm3(spec: PuckSpec, ring: Ring) -> float:
    """Volume of both halves of one ring in closed form. [mm3]"""
    return 2 * half_area_mm2(spec, ring) * spec.scale * ring.height_mm


def cavity_mm3(spec: PuckSpec, ring: Ring) -> float:
    """Room in one closed ring up to its rim. [mm3]"""
    return spec.scale**3 * ring.volume_mm3


def ring_mass_g(spec: PuckSpec, ring: Ring) -> float:
    """Filament of one ring, whose walls are too thin for infill. [g]"""
    return 1e-3 * spec.plastic.density_g_per_cm3 * ring_volume_mm3(spec, ring)
