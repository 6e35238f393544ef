"""Slab curves from finite elements instead of the table: one solve a thickness serves every modulus."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.errors import NoAnswerError

SHARES = (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
"""Depths over thickness that are solved."""
DEGREE = 6


@dataclass(frozen=True)
class SlabCase:
    """One slab to solve: thickness and punch radius [mm], what holds its base and its face, stiffening.

    ``yeoh_c2_over_mu`` is the stiffening of a Yeoh law, 0 for neo-Hookean.
    """

    thickness_mm: float
    radius_mm: float
    base: str = "bonded"
    condition: str = "bonded"
    yeoh_c2_over_mu: float = 0.0


@dataclass(frozen=True)
class SolvedSlab:
    """Elastic curve of one slab of unit modulus.

    ``depth_mm``, ``area_mm2`` (force over modulus) and ``error`` (relative) have one length; ``notes`` say
    why the curve stops early.
    """

    case: SlabCase
    depth_mm: NDArray
    area_mm2: NDArray
    error: NDArray
    notes: tuple[str, ...] = ()


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


def solve_slab(case: SlabCase) -> SolvedSlab:
    """Solve one slab of unit modulus to 0.6 of its thickness; a picklable task for any executor.

    Raises
    ------
    InputError, NoAnswerError
        As :func:`dummydesign.pad.axisymmetric.solve_curve`.
    """
    from dummydesign.pad.axisymmetric import solve_curve
    from dummydesign.pad.laws import Yeoh

    depths = [share * case.thickness_mm for share in SHARES]
    law = Yeoh(1.0, case.yeoh_c2_over_mu)
    curve = solve_curve(
        case.thickness_mm, case.radius_mm, 1.0, depths, base=case.base, condition=case.condition, law=law
    )
    depth, force = np.asarray(curve.depth_mm, float), np.asarray(curve.force_N, float)
    return SolvedSlab(case, depth, force, np.asarray(curve.error_N, float) / force, tuple(curve.notes))


def law_of(slabs: Iterable[SolvedSlab]) -> SolvedLaw:
    """Make one force law of slabs solved for the same punch.

    Raises
    ------
    NoAnswerError
        When a slab could not be solved to a useful depth.
    """
    polynomials, limits, notes, radius = {}, {}, [], 0.0
    for slab in slabs:
        thickness, radius = slab.case.thickness_mm, slab.case.radius_mm
        if len(slab.depth_mm) <= DEGREE:
            raise NoAnswerError("no_convergence", f"slab of {thickness:g} mm: only {len(slab.depth_mm)} depths solved")
        logarithm = np.log(slab.area_mm2 / (radius * slab.depth_mm))
        fitted = np.polynomial.polynomial.polyfit(slab.depth_mm / thickness, logarithm, DEGREE)
        polynomials[thickness] = tuple(float(value) for value in fitted)
        limits[thickness] = float(slab.depth_mm[-1])
        notes += [f"slab of {thickness:g} mm: {text}" for text in slab.notes]
    return SolvedLaw(radius, polynomials, limits, tuple(notes))


def solve_law(
    thickness_mm: Sequence[float],
    radius_mm: float,
    executor: Executor | None = None,
    base: str = "bonded",
    condition: str = "bonded",
) -> SolvedLaw:
    """Solve one curve a thickness, in parallel when an executor is given.

    Parameters
    ----------
    thickness_mm : sequence of float
        Slabs. [mm]
    radius_mm : float
        Radius of the circle of the punch's area. [mm]
    executor : concurrent.futures.Executor, optional
        Runs the solves; here one after the other by default.
    base, condition : str
        What holds the base and the face under the punch.

    Raises
    ------
    NoAnswerError
        When a slab could not be solved to a useful depth.
    """
    cases = [SlabCase(value, radius_mm, base, condition) for value in sorted({float(v) for v in thickness_mm})]
    return law_of((map if executor is None else executor.map)(solve_slab, cases))
