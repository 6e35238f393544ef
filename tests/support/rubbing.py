"""What a rubbing face carries along the outline of its punch."""

from __future__ import annotations

import numpy as np

from dummydesign.pad.contact.friction import coulomb_drag


def tractions(surface, u, punch, depth):
    """Way along the outline, rising, with pressure and drag at the quadrature points that touch, per rest area."""
    points = surface.points(u)
    gap = punch.gap(points, depth)[0]
    on = surface._held & (gap < 0.0)
    way, push = punch.outline(points, depth), surface._stiffness * np.maximum(-gap, 0.0)
    drag = coulomb_drag(surface._spring * (way - surface._anchor), surface._friction * push)[0]
    order = np.argsort(way[on])
    return tuple(part[on][order] for part in (way, push / surface._area, drag / surface._area))
