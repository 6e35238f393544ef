"""Hatching of cut faces. No CAD."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dummydesign.mold.files.drawings.sheet import Point


def hatch(loops: Sequence[Sequence[Point]], pitch: float) -> list[tuple[Point, Point]]:
    """Lines at 45 degrees inside closed loops (even-odd rule), ``pitch`` apart. [mm on paper]"""
    root = math.sqrt(0.5)
    # Turn by -45 degrees, so that hatching runs along the first axis.
    turned = [[(root * (x + y), root * (y - x)) for x, y in loop] for loop in loops]
    edges = [(loop[i], loop[(i + 1) % len(loop)]) for loop in turned for i in range(len(loop))]
    if not edges:
        return []
    low, high = min(a[1] for a, _ in edges), max(a[1] for a, _ in edges)
    pieces = []
    level = math.ceil(low / pitch) * pitch + 1e-7
    while level < high:
        crossings = sorted(
            a[0] + (level - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
            for a, b in edges
            if (a[1] <= level) != (b[1] <= level)
        )
        for start, end in zip(crossings[::2], crossings[1::2]):
            pieces.append(tuple((root * (u - level), root * (u + level)) for u in (start, end)))
        level += pitch
    return pieces
