"""Slab curves from finite elements instead of the table: one solve a thickness serves every modulus."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.errors import NoAnswerError

SHARES = (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
"""Depths over thickness that are solved."""
DEGREE = 6


@dataclass(frozen=True)
class SolvedLaw:
    """Elastic force of solved slabs, F = E a d exp(p(d / h)) with a polynomial p a thickness.

    Attributes
    ----------
    radius_mm : float
        Radius of the punch all slabs were solved for. [mm]
    polynomials : dict
        {thickness: coefficients of p, lowest power first}.
    limits_mm : dict
        {thickness: largest depth that was solved}. [mm]
    notes : tuple of str
        Why curves stop early.
    """

    radius_mm: float
    polynomials: dict[float, tuple[float, ...]]
    limits_mm: dict[float, float]
    notes: tuple[str, ...]

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force at solved thicknesses; all arguments broadcast. [N]"""
        if not np.isclose(radius_mm, self.radius_mm):
            raise ValueError(f"solved for a punch radius of {self.radius_mm} mm, asked for {radius_mm}")
        depth, thickness, young = np.broadcast_arrays(
            *(np.asarray(value, float) for value in (depth_mm, thickness_mm, young_MPa))
        )
        force = np.empty(depth.shape)
        for value in np.unique(thickness):
            at = thickness == value
            series = np.polynomial.polynomial.polyval(depth[at] / value, self.polynomials[float(value)])
            force[at] = young[at] * radius_mm * depth[at] * np.exp(series)
        return force

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Largest depth that was solved. [mm]"""
        return np.array([self.limits_mm[float(value)] for value in np.atleast_1d(thickness_mm)])


def solve_law(thickness_mm: Sequence[float], radius_mm: float, executor: Executor | None = None) -> SolvedLaw:
    """Solve one curve a thickness, in parallel when an executor is given.

    Parameters
    ----------
    thickness_mm : sequence of float
        Slabs, glued to base and punch. [mm]
    radius_mm : float
        Radius of the circle of the punch's area. [mm]
    executor : concurrent.futures.Executor, optional
        Runs the solves; here one after the other by default.

    Raises
    ------
    NoAnswerError
        When a slab could not be solved to a useful depth.
    """
    unique = sorted(set(float(value) for value in thickness_mm))
    run = map if executor is None else executor.map
    polynomials, limits, notes = {}, {}, []
    for thickness, (depth, force, why) in zip(unique, run(_solve, [(value, radius_mm) for value in unique])):
        if len(depth) <= DEGREE:
            raise NoAnswerError("no_convergence", f"slab of {thickness:g} mm: only {len(depth)} depths solved")
        logarithm = np.log(force / (radius_mm * depth))
        fitted = np.polynomial.polynomial.polyfit(depth / thickness, logarithm, DEGREE)
        polynomials[thickness] = tuple(float(value) for value in fitted)
        limits[thickness] = float(depth[-1])
        notes += [f"slab of {thickness:g} mm: {text}" for text in why]
    return SolvedLaw(radius_mm, polynomials, limits, tuple(notes))


def _solve(case: tuple[float, float]) -> tuple[NDArray, NDArray, tuple[str, ...]]:
    """Solve one slab of unit modulus (runs in a worker): depths, forces, notes."""
    from dummydesign.pad.axisymmetric import solve_curve

    thickness, radius = case
    curve = solve_curve(thickness, radius, 1.0, [share * thickness for share in SHARES])
    return np.asarray(curve.depth_mm, float), np.asarray(curve.force_N, float), tuple(curve.notes)
