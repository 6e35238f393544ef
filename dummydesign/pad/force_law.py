"""The contract of a force law over depth, and the force curve of one pad."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS

Array = np.ndarray
NOTHING_KNOWN: Mapping[str, Any] = MappingProxyType({})
ANY_RATIO = (1e-6, 1e6)
# Step of the difference that stands for a derivative, over the thickness.
SLOPE_STEP = 1e-4

Factor = Callable[[ArrayLike, ArrayLike, ArrayLike], tuple[Array, Array]]
"""Factor on a force and its relative error, at depths, thicknesses and punch radii (broadcast). [mm]"""


def slope_of(force: Callable[[Array], Array], depth_mm: ArrayLike, step_mm: ArrayLike, limit_mm: ArrayLike) -> Array:
    """Derivative of a force by a central difference, one-sided at the surface and at the limit; zero above it.

    Parameters
    ----------
    force : callable
        Force of depths. [mm -> N]
    depth_mm, step_mm, limit_mm : array_like
        Where, the half step, and the largest depth the force is asked at; broadcast. [mm]
    """
    depth, step = np.asarray(depth_mm, float), np.asarray(step_mm, float)
    low = np.maximum(depth - step, 0.0)
    high = np.minimum(np.maximum(depth, 0.0) + step, limit_mm)
    high = np.maximum(high, low + 1e-3 * step)
    return np.where(depth > 0.0, (force(high) - force(low)) / (high - low), 0.0)


@runtime_checkable
class ForceLaw(Protocol):
    """What every force law offers; one that says nothing else holds at any ratio and has no provenance.

    ``ratio_range`` are the smallest and largest punch radius over thickness that it answers, ``provenance`` says how it
    was made, ``notes`` what a reader of its forces must know.

    Examples
    --------
    A foam that carries under the punch alone, half as deep as it is thick, known to 2 %:

    >>> class Foam(ForceLaw):
    ...     def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
    ...         return young_MPa * np.pi * np.square(radius_mm) * np.asarray(depth_mm) / thickness_mm
    ...     def depth_limit_mm(self, thickness_mm, radius_mm):
    ...         return 0.5 * np.asarray(thickness_mm)
    ...     def relative_error(self, depth_mm, thickness_mm, radius_mm):
    ...         return np.full(np.broadcast_shapes(np.shape(depth_mm), np.shape(thickness_mm)), 0.02)
    >>> pad = curve_at(Foam(), thickness_mm=10.0, young_MPa=0.1, radius_mm=14.0)
    >>> f"{pad.force(1.0):.2f} N, {pad.stiffness(1.0):.2f} N/mm, to {pad.limit_mm:g} mm"
    '6.16 N, 6.16 N/mm, to 5 mm'
    """

    ratio_range: tuple[float, float] = ANY_RATIO
    provenance: Mapping[str, Any] = NOTHING_KNOWN
    notes: tuple[str, ...] = ()

    @abstractmethod
    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Elastic force; zero above the surface, NaN or held beyond the law's depth. All arguments broadcast.

        Parameters
        ----------
        depth_mm, thickness_mm : array_like, broadcast
            Depth of the punch in the pad, and thickness of the undeformed pad. [mm]
        young_MPa : array_like, broadcast
            Long-term (equilibrium) Young's modulus. [MPa]
        radius_mm : array_like, broadcast
            Radius of the punch, or of the circle of its area. [mm]

        Returns
        -------
        ndarray
            [N]
        """

    @abstractmethod
    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Depth to which the law holds. [mm]"""

    @abstractmethod
    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Stated error of the force over the force, finite within the law's depth; 0 for a law that is exact.

        Parameters
        ----------
        depth_mm, thickness_mm : array_like, broadcast
            Depth of the punch in the pad, and thickness of the undeformed pad. [mm]
        radius_mm : array_like, broadcast
            Radius of the punch, or of the circle of its area. [mm]
        """

    def stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> Array:
        """Tangent stiffness dF/dd by a central difference, one-sided at both ends.

        Parameters
        ----------
        depth_mm, thickness_mm, young_MPa, radius_mm : array_like, broadcast
            As of :meth:`force`. [mm, mm, MPa, mm]

        Returns
        -------
        ndarray
            [N/mm]
        """
        step = SLOPE_STEP * np.asarray(thickness_mm, float)
        limit = self.depth_limit_mm(thickness_mm, radius_mm)
        return slope_of(lambda depth: self.force(depth, thickness_mm, young_MPa, radius_mm), depth_mm, step, limit)

    def gel_mm(self, thickness_mm: ArrayLike) -> Array:
        """Thickness of the gel under the middle of the punch: the pad's, less a bone. [mm]"""
        return np.asarray(thickness_mm, float)


BaseForceLaw = ForceLaw
"""The name under which laws of one's own derive from it."""


class ScaledLaw(ForceLaw):
    """A law times a factor that states its own error; the errors add up, all else is the law's.

    Parameters
    ----------
    law : ForceLaw
    factor : callable
        See ``Factor``.
    """

    def __init__(self, law: ForceLaw, factor: Factor) -> None:
        self.law, self.factor = law, factor
        self.ratio_range, self.provenance, self.notes = law.ratio_range, law.provenance, law.notes

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Elastic force; see :class:`ForceLaw`. [N]"""
        factor, _ = self.factor(depth_mm, thickness_mm, radius_mm)
        return factor * self.law.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Depth to which the law holds. [mm]"""
        return self.law.depth_limit_mm(thickness_mm, radius_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force: the law's and the factor's; see :class:`ForceLaw`."""
        _, error = self.factor(depth_mm, thickness_mm, radius_mm)
        return error + self.law.relative_error(depth_mm, thickness_mm, radius_mm)


# Depths at which a finite-element curve is solved before it is followed along a motion.
CURVE_POINTS = 16
NO_COST: dict[str, float] = {"unknowns": 0, "load_steps": 0, "newton_iterations": 0, "seconds": 0.0}
"""What a solve counts; this of a force that was not solved."""


@dataclass(frozen=True)
class PadCurve:
    """Static force of one pad at depths, with its error; ``solved_error_N`` is that of the elements alone."""

    depth_mm: Array
    force_N: Array
    error_N: Array
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()
    solved_error_N: Array | None = None


@dataclass(frozen=True)
class ForceCurve:
    """Long-term elastic force of one pad as a function of depth, and its relative error.

    ``provenance`` is that of the law or table, empty where the pad was solved; ``first_mm`` is then the first solved
    depth, below which the force is by the law of first touch.
    """

    force: Callable[[Array], Array]
    relative_error: Callable[[Array], Array]
    limit_mm: float
    solver: dict[str, Any]
    notes: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)
    first_mm: float = 0.0

    def stiffness(self, depth_mm: Array) -> Array:
        """Tangent stiffness dF/dd, by a central difference. [N/mm]"""
        return slope_of(self.force, depth_mm, SLOPE_STEP * self.limit_mm, self.limit_mm)


def curve_at(law: ForceLaw, thickness_mm: float, young_MPa: float, radius_mm: float) -> ForceCurve:
    """Force of a law at one pad; beyond the law's depths it has the error of the nearest end.

    Parameters
    ----------
    law : ForceLaw
    thickness_mm, young_MPa, radius_mm : float
        Of the pad and of the punch. [mm, MPa, mm]
    """
    limit = float(np.squeeze(law.depth_limit_mm(thickness_mm, radius_mm)))
    return ForceCurve(
        lambda depth: law.force(depth, thickness_mm, young_MPa, radius_mm),
        lambda depth: law.relative_error(np.clip(depth, 0.0, limit), thickness_mm, radius_mm),
        limit,
        dict(NO_COST),
        law.notes,
        law.provenance,
    )


def depth_grid(thickness_mm: float, deepest_mm: float | None, depths_mm: Array | None) -> Array:
    """Depths of a curve, the wanted ones among them. [mm]

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
    return grid


def scale_curve(curve: ForceCurve, factor: Callable[[Array], tuple[Array, Array]]) -> ForceCurve:
    """Multiply a curve by a factor that gives its own relative error; the errors add up."""
    return replace(
        curve,
        force=lambda depth: curve.force(depth) * factor(depth)[0],
        relative_error=lambda depth: curve.relative_error(depth) + factor(depth)[1],
    )
