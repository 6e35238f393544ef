"""Steady-state curves of the paper's three dummies under everything that is not known of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.pad.tables.slab import load_table

THICKNESS_MM = {"palm": 15.0, "thenar": 20.0, "forefinger": 5.0}
"""Thickness of dummies I, II and III (paper, section IV), by the tissue each stands for."""

SITES = tuple(THICKNESS_MM)
RADIUS_MM = PUNCH_RADIUS_MM
"""Radius of the circle with the punch's area."""

SQUARE_OVER_ROUND = {5.0: 1.002, 15.0: 1.032, 20.0: 1.032}
"""Force of the 14 mm square over that of the circle of equal area, nearly the same at all depths (3D solutions)."""

DEEPEST = 0.85
"""Largest depth over thickness that is looked at; beyond the pad model's range by its last exponent."""

# Force of a face glued to the punch over that of a frictionless one at small depth, base glued | sliding.
_GLUED_OVER_FREE = {5.0: (1.27, 1.17), 15.0: (1.015, 1.0), 20.0: (1.005, 1.0)}
# Growth of the force by strain stiffening, per unit c2 / mu of the Yeoh law, at depth 0.3 of the thickness.
_STIFFENING_AT_03 = {5.0: 4.4, 15.0: 2.0, 20.0: 1.9}


@dataclass(frozen=True)
class Unknowns:
    """Samples, each of shape (n,), of what the paper does not say of its dummies.

    ``young_kPa`` long-term modulus; ``slip`` 0 for a glued and 1 for a sliding base; ``grip`` 1 for a
    face that sticks to the punch and 0 for a frictionless one; ``stiffening`` c2 / mu of the Yeoh law.
    """

    young_kPa: NDArray
    slip: NDArray
    grip: NDArray
    stiffening: NDArray


def slab_force(depth_mm: NDArray, thickness_mm: float, base: str) -> NDArray:
    """Force of a 1 MPa neo-Hookean slab under the paper's punch, glued to it, up to :data:`DEEPEST`. [N]

    By the response table where it is valid; beyond it the force goes on with the local exponent it has
    there, which understates how a slab stiffens when it is nearly crushed.

    Parameters
    ----------
    depth_mm : ndarray, shape (m,)
        Depths above 0. [mm]
    thickness_mm : float
        One of the thicknesses of the paper's dummies. [mm]
    base : str
        ``bonded`` or ``sliding``.

    Returns
    -------
    ndarray, shape (m,)
        [N]
    """
    table = load_table(base)
    depth = np.asarray(depth_mm, float)
    limit = float(table.depth_limit_mm(thickness_mm, RADIUS_MM))
    inside = np.minimum(depth, limit)
    last, stiffness = (one(limit, thickness_mm, 1.0, RADIUS_MM) for one in (table.force, table.stiffness))
    force = table.force(inside, thickness_mm, 1.0, RADIUS_MM) * (depth / inside) ** (limit * stiffness / last)
    return SQUARE_OVER_ROUND[thickness_mm] * force


def steady_curves(site: str, unknowns: Unknowns, points: int = 60) -> tuple[NDArray, NDArray]:
    """Steady force of the dummy of one site over depth, for every sample.

    Parameters
    ----------
    site : str
        ``palm``, ``thenar`` or ``forefinger``.
    unknowns : Unknowns
        The n samples.
    points : int
        How many depths.

    Returns
    -------
    depth_mm : ndarray, shape (points,)
    force_N : ndarray, shape (n, points)
    """
    thickness = THICKNESS_MM[site]
    depth = thickness * np.linspace(0.01, DEEPEST, points)
    glued, sliding = (slab_force(depth, thickness, base) for base in ("bonded", "sliding"))
    on_glued, on_sliding = _GLUED_OVER_FREE[thickness]
    free = 1.0 - unknowns.grip[:, None]
    glued = glued * (1.0 - free * (1.0 - 1.0 / on_glued))
    sliding = sliding * (1.0 - free * (1.0 - 1.0 / on_sliding))
    slip = unknowns.slip[:, None]
    growth = 1.0 + _STIFFENING_AT_03[thickness] * unknowns.stiffening[:, None] * (depth / thickness / 0.3) ** 2
    return depth, unknowns.young_kPa[:, None] * 1e-3 * ((1.0 - slip) * glued + slip * sliding) * growth


def depth_at(force_N: NDArray, depth: NDArray, curves: NDArray) -> NDArray:
    """Depth at which each curve reaches its row of forces (n, m); NaN beyond the last depth. [mm]

    Parameters
    ----------
    force_N : ndarray, shape (n, m)
        Forces wanted of each curve. [N]
    depth : ndarray, shape (points,)
        Increasing depths of the curves. [mm]
    curves : ndarray, shape (n, points)
        Increasing forces. [N]
    """
    rows = [np.interp(f, curve, depth, right=np.nan) for f, curve in zip(force_N, curves)]
    return np.array(rows)


def force_at(depth_mm: NDArray, depth: NDArray, curves: NDArray) -> NDArray:
    """Force of each curve at its row of depths (n, m); NaN beyond the last depth. [N]

    Parameters
    ----------
    depth_mm : ndarray, shape (n, m)
        Depths wanted of each curve. [mm]
    depth : ndarray, shape (points,)
        Increasing depths of the curves. [mm]
    curves : ndarray, shape (n, points)
        Increasing forces. [N]
    """
    return np.array([np.interp(x, depth, curve, right=np.nan) for x, curve in zip(depth_mm, curves)])
