"""Where base and ring of a printed mould part, and what goes through their flanges; no CAD. [mm]"""

from __future__ import annotations

from dummydesign.mold.model.layout import Layout, Point
from dummydesign.mold.model.spec import MouldSpec

DOWEL_MM = 4.0
"""Diameter of the two steel pins that keep ring and base in line."""
# The second pin stands off the first one's mirror image, so that the ring goes on in one way.
SHIFT_MM = 3.0


def parting_mm(spec: MouldSpec, plan: Layout) -> float:
    """Height at which ring and base meet: over the rounding of the tested face's edge, off the tested face."""
    return plan.face_mm + spec.pad.edge_radius_mm * plan.scale


def _line(spec: MouldSpec, plan: Layout) -> tuple[float, float]:
    inset = spec.box.flange_mm / 2
    return plan.flange.length_mm / 2 - inset, plan.flange.width_mm / 2 - inset


def dowel_places(spec: MouldSpec, plan: Layout) -> tuple[Point, ...]:
    """Two pins in the front flange."""
    x, y = _line(spec, plan)
    return Point(x / 2, -y), Point(-x / 2 + SHIFT_MM, -y)


def level_places(spec: MouldSpec, plan: Layout) -> tuple[Point, ...]:
    """Three screws to level by, off the bolts in corners and middles."""
    x, y = _line(spec, plan)
    return Point(x, -y / 2), Point(-x, -y / 2), Point(x / 3, y)
