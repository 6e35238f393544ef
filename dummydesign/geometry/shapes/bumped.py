"""Spherical caps on a square lattice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import ClassVar, Self

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry import dimensions as limits
from dummydesign.geometry.conic import Conic, sphere_foot_mm
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import Array, PadBlock, PadShape, Similarity, grid, stack

# The proportions that the mould allows at most: feet that nearly meet and a height of 0.26 of the diameter.
FOOT_OVER_PITCH = 1.0 / 2.1
HEIGHT_OVER_FOOT = 0.52
# Lattice places beyond this distance are never touched by a punch of 14 x 14 mm.
FIELD_MM = 9.5
# Radius of a gauge's pin that goes between caps. [mm]
GAUGE_PIN_MM = 1.5
# How far caps may lie from those proportions and still be those of the table.
PROPORTIONS_WITHIN = 0.06
# Fields that are tried.
PITCHES_MM = np.arange(3.5, 7.6, 0.5)
GRADE_SHARES = np.linspace(0.05, 0.65, 9)


@dataclass(frozen=True)
class Bumped(PadShape):
    """Spherical caps of one radius on a square lattice, the lower the farther from the middle.

    The cap at lattice place (i, j) has height ``height`` - ``grade`` (i^2 + j^2); places run to ``rings`` on
    every side, and caps lower than 0.3 mm are left out.
    """

    name: ClassVar[str] = "bumped"
    order: ClassVar[int] = 2
    flat_top: ClassVar[bool] = False
    closed_form: ClassVar[str] = ", caps of spheres"
    required_warnings: ClassVar[frozenset[str]] = frozenset({"curved_master", "thickness_varies", "air_pockets"})
    similarity: ClassVar[Similarity | None] = Similarity(
        ("thickness over punch radius", "pitch over punch radius", "grade over height of the caps"),
        (True, True, False),
        "tip",
    )
    sliders: ClassVar[tuple[str, ...]] = ("pitch", "grade")
    pitch_mm: float
    radius_mm: float
    height_mm: float
    grade_mm: float = 0.0
    rings: float = 1.0

    @classmethod
    def proportioned(cls, pitch_mm: float, grade_share: float) -> Self:
        """A field of caps of the table's proportions, as far as caps are high enough and may be touched.

        To keep the table small, its caps have one form; thickness, pitch and grade over height are left to choose.
        """
        foot = FOOT_OVER_PITCH * pitch_mm
        height = HEIGHT_OVER_FOOT * foot
        grade = grade_share * height
        reach = int(np.ceil(FIELD_MM / pitch_mm))
        if grade > 0.0:
            reach = min(reach, int(np.sqrt(max(height - limits.SMALLEST_HEIGHT_MM, 0.0) / grade)))
        return cls(pitch_mm, (foot**2 + height**2) / (2.0 * height), height, grade, float(reach))

    def with_length(self, name: str, value: float) -> Self:
        """The caps keep the table's proportions: radius, height and rings follow pitch and grade."""
        if name not in self.sliders:
            return super().with_length(name, value)
        pitch = value if name == "pitch" else self.pitch_mm
        height = HEIGHT_OVER_FOOT * FOOT_OVER_PITCH * pitch
        share = value / height if name == "grade" else self.grade_mm / self.height_mm
        return self.proportioned(pitch, share).rounded()

    @property
    def axisymmetric(self) -> bool:
        """A lattice is not round."""
        return False

    @property
    def tabulated(self) -> bool:
        """The table was solved in space."""
        return True

    @property
    def relief_mm(self) -> float:
        """Height of the middle cap."""
        return self.height_mm

    @property
    def tip_radius_mm(self) -> float:
        """Radius of the caps."""
        return self.radius_mm

    @property
    def pockets(self) -> int:
        """One a cap."""
        return len(self.caps_mm())

    @property
    def steepest_deg(self) -> float:
        """The slope at the foot of the middle cap."""
        return self.cap(self.height_mm).foot_slope_deg

    def cap(self, height_mm: float) -> Conic:
        """The sphere's cap of a height."""
        return Conic(self.radius_mm, height_mm, sphere_foot_mm(self.radius_mm, height_mm))

    def caps_mm(self) -> tuple[tuple[float, float, float], ...]:
        """Places and heights (x, y, height) of the caps, the highest first."""
        places = range(-int(self.rings), int(self.rings) + 1)
        caps = [
            (i * self.pitch_mm, j * self.pitch_mm, self.height_mm - self.grade_mm * (i * i + j * j))
            for i, j in product(places, places)
        ]
        high = (cap for cap in caps if cap[2] >= limits.SMALLEST_HEIGHT_MM - 1e-9)
        return tuple(sorted(high, key=lambda cap: (-cap[2], cap)))

    def drop_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """How far the caps, or the flat between them, lie below the highest tip."""
        x, y = np.broadcast_arrays(np.asarray(x_mm, dtype=float), np.asarray(y_mm, dtype=float))
        drop = np.full(x.shape, self.height_mm)
        for at_x, at_y, height in self.caps_mm():
            drop = np.minimum(drop, self.height_mm - height + self.cap(height).sag_mm(np.hypot(x - at_x, y - at_y)))
        return drop

    def top_volume_mm3(self, block: PadBlock) -> float:
        """All caps."""
        return sum(self.cap(height).cap_volume_mm3() for _, _, height in self.caps_mm())

    def gauge_places(self, block: PadBlock) -> dict[str, tuple[float, float]]:
        """Beside the field of caps, and between four of them where a pin of the gauge reaches the flat. [mm]"""
        foot, half = self.cap(self.height_mm).foot_mm, self.pitch_mm / 2
        reach = self.rings * self.pitch_mm + foot + limits.GAUGE_FOOT_MM
        shoulder = min(reach, block.length_mm / 2 - limits.RIM_FREE_MM)
        free = half * 2.0**0.5 - foot
        between = {"between": (half, half)} if self.rings and free >= GAUGE_PIN_MM else {}
        return {**between, "shoulder": (shoulder, 0.0)}

    def check(self, thickness_mm: float, length_mm: float = PAD_LENGTH_MM, width_mm: float = PAD_WIDTH_MM) -> None:
        """Refuse caps that overlap, keep air or leave the pad."""
        cap = self.cap(self.height_mm)
        cap.check("cap", limits.STEEPEST_TOP_DEG)
        width = 2.0 * cap.foot_mm
        most = 2.0 * limits.DEEPEST_POCKET * cap.foot_mm
        if self.height_mm > most:
            pocket = f"{limits.DEEPEST_POCKET:g} of its diameter: its pocket in the mould keeps its air"
            message = f"cap height = {self.height_mm:g} mm is above {most:.3g} mm, {pocket}"
            raise InputError(message, "out_of_range", "cap_height_mm", self.height_mm, (None, most))
        if not self.pitch_mm >= width:
            message = f"pitch = {self.pitch_mm:g} mm is below {width:.3g} mm: caps overlap"
            raise InputError(message, "out_of_range", "pitch_mm", self.pitch_mm, (width, None))
        if not (np.isfinite(self.grade_mm) and self.grade_mm >= 0.0):
            message = f"grade = {self.grade_mm:g} mm is below 0: the middle cap must be the highest"
            raise InputError(message, "out_of_range", "grade_mm", self.grade_mm, (0, None))
        if not 0 <= self.rings <= 10 or self.rings != int(self.rings):
            message = f"rings = {self.rings:g} is not a whole number from 0 to 10"
            raise InputError(message, "out_of_range", "rings", self.rings, (0, 10))
        limits.check_left("cap", self.height_mm, thickness_mm, limits.THINNEST_GEL_MM)
        limits.check_inside("field of caps", self.rings * self.pitch_mm + cap.foot_mm, min(length_mm, width_mm))

    def mark(self, block: PadBlock, scale: float) -> str:
        """Caps and pitch."""
        lower = f", lower by {self.grade_mm:g} (i2 + j2)" if self.grade_mm else ""
        return (
            f"{len(self.caps_mm())} caps of radius {self.radius_mm:g}, height {self.height_mm:g}{lower}, "
            f"pitch {self.pitch_mm:g} mm"
        )

    @classmethod
    def candidates(cls, thickness_mm: Array, radius_mm: float) -> tuple[Array, dict[str, Array]]:
        """Fields of the table's proportions; they do not change with the thickness."""
        made = [cls.proportioned(pitch, share).rounded() for pitch in PITCHES_MM for share in GRADE_SHARES]
        h, index = grid(thickness_mm, np.arange(len(made)))
        values = np.array([[value for _, value in field.parameters] for field in made])
        return h, {name: values[index.astype(int), column] for column, name in enumerate(cls.parameter_names())}

    @classmethod
    def numbers(cls, parameters: Mapping[str, Array], thickness_mm: Array, radius_mm: Array) -> Array:
        """h / a, pitch / a and grade over height."""
        pitch, height, grade = (parameters[name] for name in ("pitch", "height", "grade"))
        return stack(thickness_mm / radius_mm, pitch / radius_mm, grade / height)

    def check_tabulated(self) -> None:
        """The table is of caps of one form."""
        wanted = self.proportioned(self.pitch_mm, self.grade_mm / self.height_mm)
        off = max(abs(self.radius_mm / wanted.radius_mm - 1.0), abs(self.height_mm / wanted.height_mm - 1.0))
        if off > PROPORTIONS_WITHIN or self.rings < wanted.rings:
            message = (
                f"{self}: the table of bumped pads holds, at a pitch of {self.pitch_mm:g} mm, caps of radius "
                f"{wanted.radius_mm:.2f} and height {wanted.height_mm:.2f} mm, {wanted.rings:g} rings; use --fidelity "
                f"{self.fidelity}"
            )
            raise InputError(message, "not_tabulated", "shape", str(self))

    @classmethod
    def digits(cls, name: str) -> int:
        """Caps are given in hundredths of a millimetre."""
        return 2
