"""The punch and the pad of the paper that everything is made for unless something else is asked."""

from __future__ import annotations

import math

PUNCH_SIDE_MM = 14.0
"""Side of the square punch."""
PUNCH = f"square:{PUNCH_SIDE_MM:g}"
"""It as typed."""
PUNCH_RADIUS_MM = PUNCH_SIDE_MM / math.sqrt(math.pi)
"""Radius of the circle of its area."""
PAD_LENGTH_MM, PAD_WIDTH_MM = 150.0, 120.0
PAD_EXTENT_MM = math.sqrt(PAD_LENGTH_MM * PAD_WIDTH_MM / math.pi)
"""Radius of the circle of the pad's area."""
EXTENT_OVER_RADIUS = math.sqrt(PAD_LENGTH_MM * PAD_WIDTH_MM) / PUNCH_SIDE_MM
MAX_DEPTH_OVER_THICKNESS = 0.6
"""To which depth pads are modelled and designed."""
LARGEST_EDGE_RADIUS = 0.3
"""Largest fillet of a punch's edge over its smaller half-width."""
