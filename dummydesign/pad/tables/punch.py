"""Punches as they are typed, reduced to the radius of the circle of equal area, and what a square adds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dummydesign.design.scoring.presses import ForceLaw

FORMS = "square:SIDE, rectangle:AxB or round:DIAMETER, sizes in mm"


def equal_area_radius_mm(text: str) -> float:
    """Radius of the circle with the area of a punch such as ``square:14``, ``rectangle:20x10``, ``round:16``.

    Raises
    ------
    InputError
        When the text is not of a known form.
    """
    name, sizes = _read(text)
    if name == "round":
        return 0.5 * sizes[0]
    return math.sqrt(sizes[0] * sizes[-1] / math.pi)


def punch_sides_mm(text: str) -> tuple[float, float] | None:
    """Sides of a square or rectangular punch; None for a round one."""
    name, sizes = _read(text)
    return None if name == "round" else (sizes[0], sizes[-1])


def _read(text: str) -> tuple[str, list[float]]:
    name, _, size = text.partition(":")
    try:
        sizes = [float(part) for part in size.split("x")]
    except ValueError:
        sizes = []
    count = {"square": 1, "rectangle": 2, "round": 1}.get(name)
    if count != len(sizes) or not all(math.isfinite(value) and value > 0 for value in sizes):
        raise InputError(f"punch '{text}' is not {FORMS}")
    return name, sizes


@dataclass(frozen=True)
class SquareLaw:
    """Force law of a glued square punch: that of the circle of its area times the square's factor."""

    circle: ForceLaw
    base: str

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; see :class:`dummydesign.design.scoring.presses.ForceLaw`. [N]"""
        from dummydesign.pad.tables.square import square_factor

        factor, _ = square_factor(depth_mm, thickness_mm, radius_mm, self.base)
        return factor * self.circle.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth to which the circle's law holds. [mm]"""
        return self.circle.depth_limit_mm(thickness_mm, radius_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Error of the force over the force: the circle's and the factor's."""
        from dummydesign.pad.tables.square import square_factor

        _, error = square_factor(depth_mm, thickness_mm, radius_mm, self.base)
        return error + self.circle.relative_error(depth_mm, thickness_mm, radius_mm)

    @property
    def ratio_range(self) -> tuple[float, float]:
        """Range of radius over thickness, where the circle's law has one."""
        return getattr(self.circle, "ratio_range", (1e-6, 1e6))

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the circle's law comes from."""
        return getattr(self.circle, "provenance", {})


def punch_law(circle: ForceLaw, punch: str, base: str = "bonded") -> ForceLaw:
    """The force law of a glued punch from that of the circle of its area; only squares differ.

    A rectangle counts as the circle: its factor depends on its sides and is solved by ``--fidelity 3d``.
    """
    sides = punch_sides_mm(punch)
    return SquareLaw(circle, base) if sides is not None and sides[0] == sides[1] else circle
