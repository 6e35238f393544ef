"""Elastic force of the relaxed pad per unit modulus: slabs from the response table, pucks in closed form.

Other set-ups are in :mod:`dummydesign.loop.model.campaign_force_law`;
:mod:`dummydesign.loop.model.campaign_law` chooses.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.pad.tables.filleted import FILLETS, POWER, load_filleted
from dummydesign.pad.tables.slab import ResponseTable, load_compressibility, load_table
from dummydesign.pad.tables.square import load_square

SLAB_ERROR = ((0.005, 0.35), (0.015, 0.35), (0.008, 0.4), (0.001, 0.7))
PUCK_ERROR = SLAB_ERROR
"""Error of a law per thickness in level, slope and curvature at d/h = 0.4, and waves: median size and spread of its
logarithm.
Slabs: half a per cent from pad to pad, and at depth what the table and the square-punch factor state, each known
within a factor of two (0.35 = ln 2 / 1.96); waves: slabs of 6, 10 and 16 mm under a filleted punch differ from GetFEM's
by 0.05 to 0.09 % (root mean square) beside a parabola in depth, known within a factor of four. Pucks: the closed form
is exact for the neo-Hookean law; the allowance is for the law."""

EDGES = (0.0, *map(float, FILLETS))
"""Fillets over the punch's radius between which the change of a force by a fillet is interpolated."""

_SHARES = np.linspace(0.0, 0.6, 121)


@lru_cache(maxsize=512)
def _square_curve(thickness_mm: float, radius_mm: float, base: str) -> NDArray:
    """Square over circle at the relative depths ``_SHARES`` on one thickness."""
    table = load_square(base)
    ratio = np.clip(radius_mm / thickness_mm, *table.ratio_range)
    return np.asarray(table.factor(_SHARES, ratio)[0], float)


def square_over_circle(depth_mm: NDArray, thickness_mm: NDArray, radius_mm: float, base: str = "bonded") -> NDArray:
    """Force (T, N) of a square punch over that of the round one of equal area, at depths (T, N) on pads (T, 1)."""
    return _by_pad(depth_mm, thickness_mm, lambda h: _square_curve(h, radius_mm, base))


def _by_pad(depth_mm: NDArray, thickness_mm: NDArray, curve: Callable[[float], NDArray]) -> NDArray:
    """Values (T, N) at depths (T, N) of the curve of each pad, by its thickness (T, 1), over ``_SHARES``."""
    share = np.clip(depth_mm / thickness_mm, 0.0, _SHARES[-1])
    rows = np.broadcast_to(np.asarray(thickness_mm, float), (len(share), 1))[:, 0].tolist()
    curves = {h: curve(h) for h in set(rows)}
    return np.stack([np.interp(s, _SHARES, curves[h]) for s, h in zip(share, rows)])


@lru_cache(maxsize=512)
def _edge_curves(thickness_mm: float, radius_mm: float, base: str) -> Callable[[float], NDArray]:
    """ln of filleted over sharp at the relative depths ``_SHARES`` on one thickness, by (fillet / radius)^POWER."""
    from scipy.interpolate import PchipInterpolator

    sharp = load_table(base)
    ratio = float(np.clip(radius_mm / thickness_mm, *sharp.ratio_range))
    ideal = sharp.log_stiffness(np.minimum(_SHARES, sharp.depth_limit(ratio)), ratio)[0]
    rows = [np.zeros_like(_SHARES)]
    for fillet in EDGES[1:]:
        table = load_filleted(base, fillet)
        end = min(float(table.depth_limit(ratio)), float(sharp.depth_limit(ratio)))
        change = table.log_stiffness(np.minimum(_SHARES, end), ratio)[0] - ideal
        rows.append(np.where(_SHARES <= end, change, np.interp(end, _SHARES, change)))
    return PchipInterpolator(np.power(EDGES, POWER), np.array(rows), axis=0)


@dataclass(frozen=True)
class SlabLaw:
    """Glued flat punch on a slab, incompressible neo-Hookean, from the response table; ``radius_mm`` is that of the
    circle of its area."""

    table: ResponseTable
    radius_mm: float
    square: bool
    shape: str = "slab"
    error_priors: tuple = SLAB_ERROR

    @property
    def offers(self) -> frozenset[str]:
        """A flat face, and on a glued base what slip and bubbles change."""
        own = {"flat_faces", "sharp_edge"}
        return frozenset(own | {"base_that_can_slip", "bulk_that_gives"} if self.table.base == "bonded" else own)

    def sliding(self) -> SlabLaw:
        """The same punch on a base that slides."""
        return SlabLaw(load_table("sliding"), self.radius_mm, self.square)

    def edge_factor(self, edge_radius_mm: float, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """Force (T, N) under a punch with a fillet over that of the sharp one, by the tables of both; beyond 0.3 of the
        punch's radius the fillet of 0.3."""
        argument = min(edge_radius_mm / self.radius_mm, EDGES[-1]) ** POWER
        own = self.radius_mm, self.table.base
        return np.exp(_by_pad(depth_mm, thickness_mm, lambda h: _edge_curves(h, *own)(argument)))

    def compressibility_coefficient(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """c of a compressible slab, F / (1 + (1 - 2 nu) c), tabulated from finite elements."""
        return load_compressibility().coefficient(depth_mm / thickness_mm, self.radius_mm / thickness_mm)

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2]; beyond the table's depth its last stiffness F / d goes on (see :meth:`limit`)."""
        thickness = np.asarray(thickness_mm, float)
        ratio = np.clip(self.radius_mm / thickness, *self.table.ratio_range)
        share = np.clip(depth_mm / thickness, self.table.depth_range[0], self.table.depth_limit(ratio))
        value = self.table.log_secant(share, ratio)
        factor = square_over_circle(depth_mm, thickness, self.radius_mm, self.table.base) if self.square else 1.0
        return factor * self.radius_mm * np.maximum(depth_mm, 0.0) * np.exp(value)

    def limit(self, thickness_mm: NDArray) -> NDArray:
        """Largest depth the table knows. [mm]"""
        ratio = np.clip(self.radius_mm / np.asarray(thickness_mm, float), *self.table.ratio_range)
        return self.table.depth_limit(ratio) * thickness_mm


@dataclass(frozen=True)
class PuckLaw:
    """Cylinder between frictionless plates: homogeneous compression, F / E = A (1 / l^2 - l) / 3, l = 1 - d / h.

    Incompressible neo-Hookean, exact; a puck that slips freely stays a cylinder.
    """

    diameter_mm: float
    shape: str = "cylinder"
    error_priors: tuple = PUCK_ERROR
    offers: frozenset[str] = frozenset({"frictionless_plates"})

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        """F / E [mm2]."""
        stretch = 1.0 - np.clip(depth_mm / thickness_mm, 0.0, 0.95)
        return math.pi * self.diameter_mm**2 / 12.0 * (stretch**-2 - stretch)

    def limit(self, thickness_mm: NDArray) -> NDArray:
        """Largest depth. [mm]"""
        return 0.8 * np.asarray(thickness_mm, float)
