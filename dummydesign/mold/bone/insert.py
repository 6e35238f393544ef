"""What is known of a bone that comes from a file; no CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.limits import RIM_FREE_MM, THINNEST_COVER_MM

LEAST_SEAT_MM2 = 20.0
"""What of a bone must meet the plate that carries it."""


@dataclass(frozen=True)
class Placing:
    """How a file's solid becomes the bone: scaled, turned about x, y and z in this order, its tip set down.

    The tip is the lowest point after turning; it lies over ``x_mm``, ``y_mm`` of the pad's middle and reaches
    ``height_mm`` into the gel from the free face. What is above the free face is cut away.
    """

    height_mm: float
    scale: float = 1.0
    turn_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    x_mm: float = 0.0
    y_mm: float = 0.0

    def check(self, thickness_mm: float) -> None:
        """Refuse numbers that place nothing.

        Raises
        ------
        InputError
            With what is allowed.
        """
        if not all(math.isfinite(value) for value in (self.scale, *self.turn_deg, self.x_mm, self.y_mm)):
            raise InputError("scale, turn and place of the bone must be finite numbers")
        if not 1e-3 <= self.scale <= 1e3:
            raise out_of_range("bone scale", f"{self.scale:g}", 0.001, 1000, "of the file's lengths, taken as mm")
        most = thickness_mm - THINNEST_COVER_MM
        if not 0.3 <= self.height_mm <= most:
            raise out_of_range("bone height", f"{self.height_mm:g}", 0.3, f"{most:g}",
                               f"{THINNEST_COVER_MM:g} mm of gel stay over it")  # fmt: skip


@dataclass(frozen=True)
class Insert:
    """A placed bone: its file by name and hash, and what was measured on the solid. [mm]

    ``seat_mm2`` meets the plate; ``reach`` are its bounds in x and y; ``off_dome_mm`` is the root mean square distance
    of its underside from the dome that the finite elements take in its place; ``off_file_mm`` what the simplified
    triangles are off the file's.
    """

    file: str
    sha256: str
    placing: Placing
    volume_mm3: float
    seat_mm2: float
    x_low_mm: float
    x_high_mm: float
    y_low_mm: float
    y_high_mm: float
    off_dome_mm: float
    off_file_mm: float = 0.0
    overhang: bool = False

    def check(self, length_mm: float, width_mm: float) -> None:
        """Refuse a bone that sticks out of the gel or hardly meets its plate.

        Parameters
        ----------
        length_mm, width_mm : float
            The pad. [mm]

        Raises
        ------
        InputError
            With what is allowed.
        """
        for name, low, high, across in (("length", self.x_low_mm, self.x_high_mm, length_mm),
                                        ("width", self.y_low_mm, self.y_high_mm, width_mm)):  # fmt: skip
            room = across / 2 - RIM_FREE_MM
            if low < -room or high > room:
                raise InputError(
                    f"bone '{self.file}' sticks out: along the {name} it lies from {low:.1f} to {high:.1f} mm of the "
                    f"pad's middle, allowed is {-room:g} to {room:g} ({RIM_FREE_MM:g} mm of gel all round); scale or "
                    "move it, or take a larger pad"
                )
        if self.seat_mm2 < LEAST_SEAT_MM2:
            raise InputError(
                f"bone '{self.file}' meets its plate with {self.seat_mm2:.1f} mm2, at least {LEAST_SEAT_MM2:g} are "
                "needed: let it reach less deep into the gel (bone height) so that a wider section lies at the plate"
            )

    @property
    def words(self) -> str:
        """The warning that goes out with it."""
        text = (
            f"the bone comes from {self.file} (scale {self.placing.scale:g}); finite elements take the nearest dome in "
            f"its place, which is {self.off_dome_mm:.2f} mm off its underside (root mean square)"
        )
        simpler = f"; its triangles were simplified by up to {self.off_file_mm:.3f} mm" if self.off_file_mm else ""
        return text + simpler
