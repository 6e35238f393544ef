"""The contract of a force law: long-term elastic force of pads over depth, how deep it holds and how sure it is.

A law is asked for many pads at once: depth, thickness, modulus and punch radius broadcast. A curve is a law at one
pad. Your own laws inherit :class:`BaseForceLaw`, give ``force`` and ``depth_limit_mm``, and go wherever a
response table goes: ``predict_static(..., force_law=...)``, ``whatif(..., law=...)``, ``suggest(..., law=...)``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

NOTHING_KNOWN: Mapping[str, Any] = MappingProxyType({})
ANY_RATIO = (1e-6, 1e6)
# Step of the difference that stands for a derivative, over the thickness.
SLOPE_STEP = 1e-4

Factor = Callable[[ArrayLike, ArrayLike, ArrayLike], tuple[NDArray, NDArray]]
"""Factor on a force and its relative error, at depths, thicknesses and punch radii (broadcast). [mm]"""


@runtime_checkable
class ForceLaw(Protocol):
    """What every force law offers."""

    @property
    def ratio_range(self) -> tuple[float, float]:
        """Smallest and largest punch radius over thickness that the law answers."""
        ...

    @property
    def provenance(self) -> Mapping[str, Any]:
        """How it was made (``command``, ...); empty where it has none of its own."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of its forces must know."""
        ...

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
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
        ...

    def stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Tangent stiffness dF/dd. All arguments broadcast.

        Parameters
        ----------
        depth_mm, thickness_mm, young_MPa, radius_mm
            As for :meth:`force`.

        Returns
        -------
        ndarray
            [N/mm]
        """
        ...

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth to which the law holds. [mm]"""
        ...

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Stated error of the force over the force; NaN where none is stated.

        Parameters
        ----------
        depth_mm, thickness_mm : array_like, broadcast
            Depth of the punch in the pad, and thickness of the undeformed pad. [mm]
        radius_mm : array_like, broadcast
            Radius of the punch, or of the circle of its area. [mm]
        """
        ...


def slope_of(
    force: Callable[[NDArray], NDArray], depth_mm: ArrayLike, step_mm: ArrayLike, limit_mm: ArrayLike
) -> NDArray:
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


class BaseForceLaw:
    """What a law is that says nothing else: any ratio, no provenance, no stated error, stiffness by differences.

    Examples
    --------
    A foam that carries under the punch alone, half as deep as it is thick:

    >>> class Foam(BaseForceLaw):
    ...     def force(self, depth_mm, thickness_mm, young_MPa, radius_mm):
    ...         return young_MPa * np.pi * np.square(radius_mm) * np.asarray(depth_mm) / thickness_mm
    ...     def depth_limit_mm(self, thickness_mm, radius_mm):
    ...         return 0.5 * np.asarray(thickness_mm)
    >>> pad = AtThickness(Foam(), thickness_mm=10.0, young_MPa=0.1, radius_mm=14.0)
    >>> f"{pad.force(1.0):.2f} N, {pad.stiffness(1.0):.2f} N/mm, to {pad.limit_mm:g} mm"
    '6.16 N, 6.16 N/mm, to 5 mm'
    """

    ratio_range: tuple[float, float] = ANY_RATIO
    provenance: Mapping[str, Any] = NOTHING_KNOWN
    notes: tuple[str, ...] = ()

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Elastic force; see :class:`ForceLaw`. [N]"""
        raise NotImplementedError

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth to which the law holds. [mm]"""
        raise NotImplementedError

    def stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Tangent stiffness by a central difference, one-sided at both ends; see :class:`ForceLaw`. [N/mm]"""
        step = SLOPE_STEP * np.asarray(thickness_mm, float)
        limit = self.depth_limit_mm(thickness_mm, radius_mm)
        return slope_of(lambda depth: self.force(depth, thickness_mm, young_MPa, radius_mm), depth_mm, step, limit)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """NaN: no error is stated; see :class:`ForceLaw`."""
        shape = np.broadcast_shapes(np.shape(depth_mm), np.shape(thickness_mm), np.shape(radius_mm))
        return np.full(shape, np.nan)


@dataclass(frozen=True)
class TimesFactor(BaseForceLaw):
    """A law times a factor that states its own error; the errors add up, all else is the law's.

    Attributes
    ----------
    law : ForceLaw
    factor : callable
        See ``Factor``.
    """

    law: ForceLaw
    factor: Factor

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Elastic force; see :class:`ForceLaw`. [N]"""
        factor, _ = self.factor(depth_mm, thickness_mm, radius_mm)
        return factor * self.law.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth to which the law holds. [mm]"""
        return self.law.depth_limit_mm(thickness_mm, radius_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Error of the force over the force: the law's and the factor's; see :class:`ForceLaw`."""
        _, error = self.factor(depth_mm, thickness_mm, radius_mm)
        return error + self.law.relative_error(depth_mm, thickness_mm, radius_mm)

    @property
    def ratio_range(self) -> tuple[float, float]:  # type: ignore[override]
        """The law's range of radius over thickness."""
        return self.law.ratio_range

    @property
    def provenance(self) -> Mapping[str, Any]:  # type: ignore[override]
        """Where the law comes from."""
        return self.law.provenance

    @property
    def notes(self) -> tuple[str, ...]:  # type: ignore[override]
        """The law's notes."""
        return self.law.notes


@runtime_checkable
class ForceCurve(Protocol):
    """A force law at one pad, or the solve of one: a function of depth alone."""

    @property
    def provenance(self) -> Mapping[str, Any]:
        """How it was made; empty where it has none of its own."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of its forces must know."""
        ...

    @property
    def limit_mm(self) -> float:
        """Depth to which it holds. [mm]"""
        ...

    @property
    def force(self) -> Callable[[NDArray], NDArray]:
        """Elastic force of depths. [mm -> N]"""
        ...

    def stiffness(self, depth_mm: NDArray) -> NDArray:
        """Tangent stiffness dF/dd. [N/mm]"""
        ...

    @property
    def relative_error(self) -> Callable[[NDArray], NDArray]:
        """Stated error of the force over the force, of depths."""
        ...


@dataclass(frozen=True)
class AtThickness:
    """One pad of a force law: its force as a function of depth alone.

    Attributes
    ----------
    law : ForceLaw
    thickness_mm, young_MPa, radius_mm : float
        Of the pad and of the punch. [mm, MPa, mm]
    """

    law: ForceLaw
    thickness_mm: float
    young_MPa: float
    radius_mm: float

    @property
    def provenance(self) -> Mapping[str, Any]:
        """How the law was made."""
        return self.law.provenance

    @property
    def notes(self) -> tuple[str, ...]:
        """The law's notes."""
        return self.law.notes

    @property
    def limit_mm(self) -> float:
        """Depth to which the law holds on this pad. [mm]"""
        return float(np.squeeze(self.law.depth_limit_mm(self.thickness_mm, self.radius_mm)))

    def force(self, depth_mm: NDArray) -> NDArray:
        """Elastic force. [N]"""
        return self.law.force(depth_mm, self.thickness_mm, self.young_MPa, self.radius_mm)

    def stiffness(self, depth_mm: NDArray) -> NDArray:
        """Tangent stiffness dF/dd. [N/mm]"""
        return self.law.stiffness(depth_mm, self.thickness_mm, self.young_MPa, self.radius_mm)

    def relative_error(self, depth_mm: NDArray) -> NDArray:
        """Stated error of the force over the force; outside the law's depths that of the nearest end."""
        return self.law.relative_error(np.clip(depth_mm, 0.0, self.limit_mm), self.thickness_mm, self.radius_mm)
