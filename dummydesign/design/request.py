"""What is asked of :func:`dummydesign.design.suggest.suggest`, and the press that every design is judged by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from dummydesign.geometry.standard import PUNCH_RADIUS_MM, PUNCH_SIDE_MM

Progress = Callable[[str], None]
"""Is told each step of the work as it begins, in words."""


def quiet(step: str) -> None:
    """Tell nobody."""


PUNCH = f"square:{PUNCH_SIDE_MM:g}"
RADIUS_MM = PUNCH_RADIUS_MM
"""Circle of the area of the paper's 14 x 14 mm impactor. [mm]"""


@dataclass(frozen=True)
class Request:
    """What is asked for. Ranges are (low, high) with both ends included, None for all that is allowed."""

    tissue: str
    aim: str = "average"
    resin: str = "polyurethane-nagoya"
    thickness_mm: tuple[float, float] | None = None
    ratio: tuple[float, float] | None = None
    shape: str = "auto"
    verify: bool = True
    hold_s: float = 10.0
    deceleration_mm_s2: float = 30_000.0
    weighing_g: float = 0.1
    thickness_tolerance_mm: float = 0.2
    calibration: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return what was asked, defaults included."""
        return asdict(self)
