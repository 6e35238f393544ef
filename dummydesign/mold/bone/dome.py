"""The conic dome nearest to the underside of a bone. No CAD."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.geometry.conic import Conic
from dummydesign.geometry.limits import STEEPEST_BONE_DEG

GRID, ROUNDS = 41, 4
MOST_TIP_MM = 500.0


def nearest_dome(
    heights_mm: NDArray, radii_mm: NDArray, height_mm: float, room_mm: float
) -> tuple[float, float, float]:
    """Tip radius and foot of the dome of a given height whose profile is nearest to points of a bone.

    Least squares over all domes that can be cast, by a grid in ln(radius) and foot that is refined around its best.

    Parameters
    ----------
    heights_mm, radii_mm : ndarray, shape (n,)
        How far the bone reaches from the free face, 0 beside it, and the distance from its tip. [mm]
    height_mm : float
        Of the bone at its tip. [mm]
    room_mm : float
        Largest foot. [mm]

    Returns
    -------
    float, float, float
        Tip radius, foot radius, and the root mean square of what is left. [mm]

    Raises
    ------
    InputError
        When no dome of this height can be cast.
    """
    low, high = np.array([0.0, 0.2 * height_mm]), np.array([np.log(MOST_TIP_MM), room_mm])
    best: tuple[float, float, float] | None = None
    for _ in range(ROUNDS):
        for tip in np.exp(np.linspace(low[0], high[0], GRID)):
            for foot in np.linspace(low[1], high[1], GRID):
                conic = Conic(float(tip), height_mm, float(foot))
                if conic.factor * height_mm > tip * (1 - 1e-6) or conic.foot_slope_deg > STEEPEST_BONE_DEG - 0.5:
                    continue
                off = float(np.sqrt(np.mean((height_mm - conic.sag_mm(radii_mm) - heights_mm) ** 2)))
                if best is None or off < best[2]:
                    best = float(tip), float(foot), off
        if best is None:
            raise InputError(f"bone height = {height_mm:g} mm: no dome so high fits within {room_mm:g} mm of its tip")
        step = 2 * (high - low) / (GRID - 1)
        middle = np.array([np.log(best[0]), best[1]])
        low = np.maximum(middle - step, [0.0, 0.2 * height_mm])
        high = np.minimum(middle + step, [np.log(MOST_TIP_MM), room_mm])
    assert best is not None
    return best


def undersides(triangles: NDArray, points: NDArray) -> NDArray:
    """Lowest height of a triangle mesh under points of the plane; NaN where there is none.

    Parameters
    ----------
    triangles : ndarray, shape (n, 3, 3)
        Corners. [mm]
    points : ndarray, shape (m, 2)
        x and y. [mm]

    Returns
    -------
    ndarray, shape (m,)
        [mm]
    """
    found = np.full(len(points), np.nan)
    for a, b, c in triangles:
        u, v = b[:2] - a[:2], c[:2] - a[:2]
        area = u[0] * v[1] - u[1] * v[0]
        if abs(area) < 1e-12:
            continue
        away = points - a[:2]
        s = (away[:, 0] * v[1] - away[:, 1] * v[0]) / area
        t = (u[0] * away[:, 1] - u[1] * away[:, 0]) / area
        inside = (s >= -1e-9) & (t >= -1e-9) & (s + t <= 1 + 1e-9)
        z = a[2] + s[inside] * (b[2] - a[2]) + t[inside] * (c[2] - a[2])
        found[inside] = np.fmin(found[inside], z)
    return found
