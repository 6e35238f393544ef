"""Punches as they are typed, reduced to the radius of the circle of equal area, and what a square adds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dummydesign.design.curves import ForceLaw

FORMS = "square:SIDE, rectangle:AxB or round:DIAMETER, sizes in mm"


def equal_area_radius_mm(text: str) -> float:
    """Radius of the circle with the area of a punch such as ``square:14``, ``rectangle:20x10``, ``round:16``.

    Raises
    ------
    InputError
        When the text is not of a known form.
    """
    name, _, size = text.partition(":")
    try:
        sides = [float(part) for part in size.split("x")]
    except ValueError:
        sides = []
    count = {"square": 1, "rectangle": 2, "round": 1}.get(name)
    if count != len(sides) or not all(math.isfinite(side) and side > 0 for side in sides):
        raise InputError(f"punch '{text}' is not {FORMS}")
    if name == "round":
        return 0.5 * sides[0]
    return math.sqrt(sides[0] * sides[-1] / math.pi)


@dataclass(frozen=True)
class SquareLaw:
    """Force law of a glued square punch: that of the circle of its area times the square's factor."""

    circle: ForceLaw
    base: str

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; see :class:`dummydesign.design.curves.ForceLaw`. [N]"""
        from dummydesign.pad.square import square_factor

        factor, _ = square_factor(depth_mm, thickness_mm, radius_mm, self.base)
        return factor * self.circle.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth to which the circle's law holds. [mm]"""
        return self.circle.depth_limit_mm(thickness_mm, radius_mm)

    @property
    def ratio_range(self) -> tuple[float, float]:
        """Range of radius over thickness, where the circle's law has one."""
        return getattr(self.circle, "ratio_range", (1e-6, 1e6))

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the circle's law comes from."""
        return getattr(self.circle, "provenance", {})


def square_known(base: str) -> bool:
    """Whether the factors of square punches are there for this base."""
    from dummydesign.library import data_folder

    return (data_folder() / "materials" / "tables" / f"square-{base}.json").is_file()


def punch_law(circle: ForceLaw, punch: str, condition: str = "bonded", base: str = "bonded") -> ForceLaw:
    """The force law of a punch from that of the circle of its area; only glued squares differ."""
    if punch.startswith("square") and condition == "bonded" and square_known(base):
        return SquareLaw(circle, base)
    return circle
