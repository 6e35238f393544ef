"""Punches as they are typed, reduced to the radius of the circle of equal area, and what a square adds."""

from __future__ import annotations

import math
from functools import partial

from dummydesign.core.errors import InputError
from dummydesign.pad.force_law import ForceLaw, TimesFactor
from dummydesign.pad.tables.square import square_factor

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


class SquareLaw(TimesFactor):
    """Force law of a glued square punch: that of the circle of its area times the square's factor.

    Parameters
    ----------
    circle : ForceLaw
    base : str
        ``bonded`` or ``sliding``.
    filleted : bool
        Whether the edge is a fillet.
    """

    def __init__(self, circle: ForceLaw, base: str, filleted: bool = False) -> None:
        super().__init__(circle, partial(square_factor, base=base, filleted=filleted))


def circle_of(law: ForceLaw) -> ForceLaw:
    """The law of the circle of the punch's area, under a square's factor or by itself."""
    return law.law if isinstance(law, SquareLaw) else law


def punch_law(circle: ForceLaw, punch: str, base: str = "bonded", filleted: bool = False) -> ForceLaw:
    """The force law of a glued punch from that of the circle of its area; only squares differ.

    A rectangle counts as the circle: its factor depends on its sides and is solved by ``--fidelity 3d``.

    Parameters
    ----------
    circle : ForceLaw
        Of round punches.
    punch : str
        As typed: ``square:14``, ``round:16``, ``rectangle:20x10``.
    base : str
        ``bonded`` or ``sliding``.
    filleted : bool
        Whether the punch's edge is a fillet.

    Returns
    -------
    ForceLaw
        To be asked with the radius of the circle of the punch's area.
    """
    sides = punch_sides_mm(punch)
    return SquareLaw(circle, base, filleted) if sides is not None and sides[0] == sides[1] else circle
