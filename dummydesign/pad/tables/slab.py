"""The response table: dimensionless force of a slab, F = E a^2 f(d/h, a/h), as a Chebyshev series.

What is stored is ln of s = F / (E a d) as a polynomial in x = d / h and ln(a / h): smooth, so that
stiffness and local exponent follow by exact differentiation, and evaluated without finite elements.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.interface import BASES
from dummydesign.pad.tables.edge_doubt import sharp_edge_doubt
from dummydesign.pad.tables.interpolation import between

Array = np.ndarray


def equal_area_radius_mm(area_mm2: float) -> float:
    """Radius of the round punch of the same area: sqrt(A / pi). [mm]"""
    return float(np.sqrt(area_mm2 / np.pi))


@dataclass(frozen=True)
class ResponseTable:
    """Force law of slabs on one kind of base, glued to a round flat punch.

    Attributes
    ----------
    base : str
    coefficients : ndarray, shape (terms in x, terms in ln a/h)
        Chebyshev coefficients of ln s.
    ratio_range : (float, float)
        Smallest and largest a / h.
    depth_range : (float, float)
        Range of x of the series.
    limit_ratio, limit_depth : ndarray
        Largest valid x at some a / h; in between, linear in ln a / h.
    error_ratio, error_depth, error : ndarray
        Relative numerical error (ratios, depths): finite elements plus interpolation.
    provenance : dict
    """

    base: str
    coefficients: Array
    ratio_range: tuple[float, float]
    depth_range: tuple[float, float]
    limit_ratio: Array
    limit_depth: Array
    error_ratio: Array
    error_depth: Array
    error: Array
    provenance: dict[str, Any]

    def _coordinates(self, x: Array, ratio: Array) -> tuple[Array, Array]:
        low, high = np.log(self.ratio_range)
        start, stop = self.depth_range
        return 2.0 * (x - start) / (stop - start) - 1.0, 2.0 * (np.log(ratio) - low) / (high - low) - 1.0

    def log_stiffness(self, x: ArrayLike, ratio: ArrayLike) -> tuple[Array, Array]:
        """Return ln s and its derivative with respect to x at relative depth x and a / h (broadcast)."""
        x, ratio = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(ratio, dtype=float))
        u, v = self._coordinates(x, ratio)
        series = np.polynomial.chebyshev
        slope = series.chebder(self.coefficients, axis=0) * 2.0 / (self.depth_range[1] - self.depth_range[0])
        return series.chebval2d(u, v, self.coefficients), series.chebval2d(u, v, slope)

    def log_secant(self, x: Array, ratio: Array) -> Array:
        """ln s as :meth:`log_stiffness` gives it, faster: one series for each slab.

        Parameters
        ----------
        x : ndarray, shape (T, N)
            Relative depths within the series' range.
        ratio : ndarray, shape (T, 1)
            a / h of each slab.
        """
        u, v = self._coordinates(x, ratio[..., 0])
        across = np.polynomial.chebyshev.chebvander(v, self.coefficients.shape[1] - 1)
        series = (across @ self.coefficients.T).T[..., None]
        # Clenshaw's recurrence
        later, last = np.zeros_like(u), np.zeros_like(u)
        for coefficient in series[:0:-1]:
            later, last = 2.0 * u * later - last + coefficient, later
        return u * later - last + series[0]

    def _ratio(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        ratio = np.asarray(radius_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        low, high = self.ratio_range
        bad = ~((ratio >= low * (1.0 - 1e-9)) & (ratio <= high * (1.0 + 1e-9)))
        if np.any(bad):
            worst = float(np.asarray(ratio)[bad].flat[0]) if np.ndim(ratio) else float(ratio)
            raise out_of_range(
                "punch radius over pad thickness",
                f"{worst:.4g}",
                low,
                high,
                "use --fidelity axisymmetric outside the table",
            )
        return ratio

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Static force F = E a d s(d/h, a/h). [N]

        Parameters
        ----------
        depth_mm : array_like, broadcast
            Depth; zero and negative depths (above the surface) carry no force. [mm]
        thickness_mm, young_MPa, radius_mm : array_like, broadcast
            Thickness [mm], long-term Young's modulus [MPa], punch radius [mm].

        Returns
        -------
        ndarray
            NaN beyond the depth limit: the table does not guess. [N]
        """
        return self.force_and_stiffness(depth_mm, thickness_mm, young_MPa, radius_mm)[0]

    def force_and_stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> tuple[Array, Array]:
        """Static force [N] and tangent stiffness dF/dd [N/mm].

        Parameters
        ----------
        depth_mm, thickness_mm, young_MPa, radius_mm
            As for :meth:`force`.
        """
        ratio = self._ratio(thickness_mm, radius_mm)
        depth, radius = np.asarray(depth_mm, dtype=float), np.asarray(radius_mm, dtype=float)
        x = depth / np.asarray(thickness_mm, dtype=float)
        value, slope = self.log_stiffness(np.clip(x, *self.depth_range), ratio)
        unit = np.asarray(young_MPa, dtype=float) * radius * np.exp(value)
        touching = np.where(x > 0.0, 1.0, 0.0)
        beyond = np.where(x > self.depth_limit(ratio) * (1.0 + 1e-9), np.nan, 1.0)
        force = unit * np.maximum(depth, 0.0) * beyond
        return force, unit * (1.0 + np.maximum(x, 0.0) * slope) * touching * beyond

    def stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> Array:
        """Tangent stiffness dF/dd; see :meth:`ResponseTable.force` for the arguments. [N/mm]"""
        return self.force_and_stiffness(depth_mm, thickness_mm, young_MPa, radius_mm)[1]

    @property
    def notes(self) -> tuple[str, ...]:
        """None."""
        return ()

    def local_exponent(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Exponent d ln F / d ln d = 1 + x d(ln s)/dx of the force; 1 at first touch.

        Parameters
        ----------
        depth_mm, thickness_mm, radius_mm
            As for :meth:`force`.

        Returns
        -------
        ndarray
            NaN beyond the depth limit.
        """
        ratio = self._ratio(thickness_mm, radius_mm)
        x = np.asarray(depth_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        _, slope = self.log_stiffness(np.clip(x, *self.depth_range), ratio)
        return np.where(x > self.depth_limit(ratio) * (1.0 + 1e-9), np.nan, 1.0 + x * slope)

    def depth_limit(self, ratio: ArrayLike) -> Array:
        """Largest valid d / h at a / h."""
        return np.interp(np.log(ratio), np.log(self.limit_ratio), self.limit_depth)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Largest valid depth. [mm]"""
        return self.depth_limit(self._ratio(thickness_mm, radius_mm)) * np.asarray(thickness_mm, dtype=float)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force: elements plus interpolation, or what independent solutions differ by; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        ratio = self._ratio(thickness_mm, radius_mm)
        x = np.asarray(depth_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        return np.maximum(self.solved_error(depth_mm, thickness_mm, radius_mm), sharp_edge_doubt(x, ratio))

    def solved_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Relative error of elements and interpolation alone: what a solve made now may differ by from the table.

        Parameters
        ----------
        depth_mm, thickness_mm, radius_mm : array_like, broadcast
            As of :meth:`relative_error`. [mm]
        """
        ratio = np.log(self._ratio(thickness_mm, radius_mm))
        x = np.asarray(depth_mm, dtype=float) / np.asarray(thickness_mm, dtype=float)
        x, ratio = np.broadcast_arrays(x, ratio)
        return between(x, ratio, self.error_depth, np.log(self.error_ratio), self.error)

    def depth_at_force(
        self, force_N: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> Array:
        """Depth at which the static force is reached, by safeguarded Newton steps; NaN when out of reach. [mm]

        Parameters
        ----------
        force_N : array_like, broadcast
            Wanted. [N]
        thickness_mm, young_MPa, radius_mm
            As for :meth:`force`.
        """
        force, thickness, young, radius = np.broadcast_arrays(
            *(np.asarray(v, dtype=float) for v in (force_N, thickness_mm, young_MPa, radius_mm))
        )
        high = self.depth_limit_mm(thickness, radius)
        low = np.zeros_like(high)
        out = self.force(high, thickness, young, radius) < force
        depth = np.clip(force / self.force_and_stiffness(high * 1e-6, thickness, young, radius)[1], 0.0, high)
        for _ in range(60):
            value, slope = self.force_and_stiffness(depth, thickness, young, radius)
            low = np.where(value < force, depth, low)
            high = np.where(value >= force, depth, high)
            step = depth - (value - force) / np.where(slope > 0.0, slope, np.inf)
            new = np.where((step > low) & (step < high), step, 0.5 * (low + high))
            if np.all(np.abs(new - depth) <= 1e-12 * thickness):
                break
            depth = new
        return np.where(out, np.nan, depth)


@lru_cache(maxsize=4)
def load_table(base: str = "bonded") -> ResponseTable:
    """Read a shipped table.

    Parameters
    ----------
    base : str
        ``bonded`` or ``sliding``.

    Raises
    ------
    InputError
        For another base.
    NoAnswerError
        When the file is missing or damaged, with the command that rebuilds it.

    Examples
    --------
    Force of a 12 mm slab of 25 kPa, 1 and 2 mm under a round punch of 28 mm:

    >>> load_table("bonded").force([1.0, 2.0], 12.0, 0.025, 14.0).round(2).tolist()
    [4.95, 10.74]
    """
    if base not in BASES:
        raise InputError(f"base = '{base}' has no table; known are {', '.join(BASES)}; use --fidelity axisymmetric")
    command = "python -m dummydesign.studies.tables.slab"
    return json_table.read(f"slab-{base}.json", "response table", command, _from_dict)


def _from_dict(data: dict[str, Any]) -> ResponseTable:
    return ResponseTable(
        base=data["base"],
        coefficients=np.array(data["coefficients"]),
        ratio_range=tuple(data["ratio_range"]),
        depth_range=tuple(data["depth_range"]),
        limit_ratio=np.array(data["limit_ratio"]),
        limit_depth=np.array(data["limit_depth"]),
        error_ratio=np.array(data["error_ratio"]),
        error_depth=np.array(data["error_depth"]),
        error=np.array(data["error"]),
        provenance=data["provenance"],
    )
