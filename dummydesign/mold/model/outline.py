"""Rounded rectangles and what is drafted from them, in closed form; no CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Outline:
    """A rectangle ``length_mm`` by ``width_mm`` about the origin with corners of ``radius_mm``."""

    length_mm: float
    width_mm: float
    radius_mm: float

    @property
    def is_circle(self) -> bool:
        """Whether the corners meet, so that nothing of the sides is left."""
        return abs(self.length_mm - self.width_mm) < 1e-9 and abs(self.length_mm - 2 * self.radius_mm) < 1e-6

    @property
    def area_mm2(self) -> float:
        """Area inside. [mm2]"""
        return self.length_mm * self.width_mm - (4 - math.pi) * self.radius_mm**2

    @property
    def perimeter_mm(self) -> float:
        """Length of the outline. [mm]"""
        return 2 * (self.length_mm + self.width_mm) - (8 - 2 * math.pi) * self.radius_mm

    @property
    def diagonal_mm(self) -> float:
        """Largest distance between two of its points, the corners rounded. [mm]"""
        inner = math.hypot(self.length_mm - 2 * self.radius_mm, self.width_mm - 2 * self.radius_mm)
        return inner + 2 * self.radius_mm

    def grown(self, by_mm: float) -> Outline:
        """Return the outline moved outwards by ``by_mm`` (inwards when negative); corners stay rounded."""
        return Outline(self.length_mm + 2 * by_mm, self.width_mm + 2 * by_mm, self.radius_mm + by_mm)

    def scaled(self, factor: float) -> Outline:
        """Return the outline with all lengths multiplied."""
        return Outline(self.length_mm * factor, self.width_mm * factor, self.radius_mm * factor)


def drafted_volume_mm3(base: Outline, height_mm: float, draft_deg: float) -> float:
    """Volume of a drafted prism whose outline moves outwards by z tan(draft). [mm3]"""
    k = math.tan(math.radians(draft_deg))
    return base.area_mm2 * height_mm + base.perimeter_mm * k * height_mm**2 / 2 + math.pi * k**2 * height_mm**3 / 3


def edge_fillet_volume_mm3(base: Outline, radius_mm: float, draft_deg: float) -> float:
    """Volume that a fillet takes off the lower edge of a drafted prism.

    The cross-section lost (a kite of two tangent lengths less the sector of the arc) is the same all along
    the outline; straight sides give area times length, the four corners together one turn about their
    axes (second theorem of Pappus and Guldinus), its radius taken at the section's centroid.
    """
    if radius_mm == 0:
        return 0.0
    inside = math.pi / 2 + math.radians(draft_deg)
    turn = math.pi - inside
    tangent = radius_mm / math.tan(inside / 2)
    area = radius_mm * tangent - radius_mm**2 * turn / 2
    # First moments about the outline, u inwards: kite = two triangles; sector about the arc's centre.
    wall_u = tangent * math.cos(inside)
    kite = radius_mm * tangent / 2 * ((tangent + tangent) / 3 + (wall_u + tangent) / 3)
    reach = 2 * radius_mm * math.sin(turn / 2) / (3 * turn / 2)
    sector_u = tangent + reach * math.cos(math.pi / 2 + turn / 2)
    moment = kite - radius_mm**2 * turn / 2 * sector_u
    straight = base.perimeter_mm - 2 * math.pi * base.radius_mm
    return area * straight + 2 * math.pi * (base.radius_mm * area - moment)


def slab_volume_mm3(base: Outline, height_mm: float, draft_deg: float, edge_radius_mm: float) -> float:
    """Volume of a drafted slab with a filleted lower edge, exact for corner radius >= edge radius. [mm3]"""
    whole = drafted_volume_mm3(base, height_mm, draft_deg)
    return whole - edge_fillet_volume_mm3(base, edge_radius_mm, draft_deg)
