"""The long-term force of one pad over depth, and such a curve drawn through solved depths."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.force_law import SLOPE_STEP, slope_of

if TYPE_CHECKING:
    from dummydesign.pad.slab.problem import PadCurve

Array = np.ndarray
# Depths at which a finite-element curve is solved before it is followed along a motion.
CURVE_POINTS = 16


@dataclass(frozen=True)
class ElasticCurve:
    """Long-term elastic force as a function of depth, and its relative error.

    Keeps the contract ``ForceCurve``; ``provenance`` is that of the law or table, empty where the pad was solved.
    """

    force: Callable[[Array], Array]
    relative_error: Callable[[Array], Array]
    limit_mm: float
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def stiffness(self, depth_mm: Array) -> Array:
        """Tangent stiffness dF/dd, by a central difference. [N/mm]"""
        return slope_of(self.force, depth_mm, SLOPE_STEP * self.limit_mm, self.limit_mm)


def depth_grid(thickness_mm: float, deepest_mm: float | None, depths_mm: Array | None) -> tuple[Array, float]:
    """Depths that are solved, the wanted ones among them, and the deepest. [mm]

    Parameters
    ----------
    thickness_mm : float
        Of the pad, or height of the puck. [mm]
    deepest_mm : float, optional
        Deepest that is wanted; by default what is valid. [mm]
    depths_mm : ndarray, shape (n,), optional
        Depths to be met exactly. [mm]
    """
    limit = MAX_DEPTH_OVER_THICKNESS * thickness_mm
    deepest = limit if deepest_mm is None else min(max(deepest_mm, 0.02 * thickness_mm), limit)
    grid = np.linspace(0.0, deepest, CURVE_POINTS + 1)[1:]
    if depths_mm is not None:
        grid = np.union1d(grid[::2], depths_mm[(depths_mm > 0.0) & (depths_mm <= limit)])
    return grid, deepest


def through(power: float, solved: PadCurve) -> ElasticCurve:
    """A curve through solved depths of a force that begins as depth to a power (1 of a flat, 1.5 of a rounded tip).

    Raises
    ------
    NoAnswerError
        When fewer than two were reached.
    """
    from scipy.interpolate import PchipInterpolator

    depth, force = solved.depth_mm, solved.force_N
    if len(depth) < 2:
        raise NoAnswerError("no_convergence", f"the pad could be solved at {len(depth)} depth only: {solved.notes[0]}")
    # F / d (under a rounded tip F / d^1.5) varies little; between solved depths lies a monotone cubic through it.
    stiffness = PchipInterpolator(depth, np.log(force / depth**power), extrapolate=True)
    error = solved.error_N / force

    def value(at: Array) -> Array:
        at = np.asarray(at, dtype=float)
        inside = np.clip(at, 0.0, depth[-1])
        return np.where(at > 0.0, inside**power * np.exp(stiffness(inside)), 0.0)

    return ElasticCurve(
        value, lambda at: np.interp(at, depth, error), float(depth[-1]), solved.solver, solved.notes
    )


def times(curve: ElasticCurve, factor: Callable[[Array], tuple[Array, Array]]) -> ElasticCurve:
    """Multiply a curve by a factor that gives its own relative error; the errors add up."""
    return replace(
        curve,
        force=lambda depth: curve.force(depth) * factor(depth)[0],
        relative_error=lambda depth: curve.relative_error(depth) + factor(depth)[1],
    )
