"""A ball as a punch, its profile in closed form."""

from __future__ import annotations

import numpy as np

from dummydesign.pad.contact.axisymmetric import ProfilePunch

Array = np.ndarray


def sphere(radius: float) -> ProfilePunch:
    """A ball of a given radius; points beyond 0.98 of it are carried on straight."""
    edge = 0.98 * radius
    end = np.sqrt(radius**2 - edge**2)

    def height(r: Array) -> tuple[Array, Array, Array, Array]:
        inside = np.clip(r, 0.0, edge)
        root = np.sqrt(radius**2 - inside**2)
        slope = inside / root
        beyond = np.maximum(r - edge, 0.0)
        second, third = radius**2 / root**3, 3.0 * radius**2 * inside / root**5
        return radius - root + beyond * edge / end, slope, *(np.where(r < edge, x, 0.0) for x in (second, third))

    return ProfilePunch(height)
