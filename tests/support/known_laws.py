"""Laws of campaigns that need no solve: slabs in the response table, pucks that slip freely."""

from __future__ import annotations

import math

from dummydesign.loop.model.campaign_law import CampaignLaw, law_without_solve
from dummydesign.pad.pad_under_punch import Pad, Puck


def slab_law(radius_mm: float, square: bool = False, base: str = "bonded", edge_radius_mm: float = 0.0) -> CampaignLaw:
    """Slabs of any thickness under a glued flat punch, round or a square of the same area."""
    side = math.sqrt(math.pi) * radius_mm
    sides = (side, side) if square else None
    return law_without_solve([Pad(10.0, 1.0, radius_mm, base=base, sides_mm=sides, edge_radius_mm=edge_radius_mm)])


def puck_law(diameter_mm: float) -> CampaignLaw:
    """Pucks of any height between frictionless plates."""
    return law_without_solve([Puck(10.0, 1.0, diameter_mm)])
