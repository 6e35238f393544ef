"""Punches as they are typed, reduced to the radius of the circle of equal area."""

from __future__ import annotations

import math

from dummydesign.errors import InputError

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
