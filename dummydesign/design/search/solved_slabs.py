"""Slab curves from finite elements instead of the table: one solve a thickness serves every modulus."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.pad.force_law import BaseForceLaw

if TYPE_CHECKING:
    from dummydesign.pad.pad import Pad

SHARES = (0.01, 0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)
"""Depths over thickness that are solved."""
DEGREE, SLIDING_DEGREE = 6, 4
"""Of the polynomial through a solved curve; a face that slides scatters more, and is followed less closely."""


@dataclass(frozen=True)
class SlabCase:
    """One slab to solve: thickness and punch radius [mm], what holds its base and its face, stiffening.

    ``yeoh_c2_over_mu`` is the stiffening of a Yeoh law, 0 for neo-Hookean. ``sides_mm`` are those of a square
    or rectangular punch whose area the radius stands for, None for a round one. ``fidelity`` is
    ``axisymmetric`` (a glued square on a neo-Hookean slab carries its tabulated factor) or ``3d``.
    """

    thickness_mm: float
    radius_mm: float
    base: str = "bonded"
    condition: str = "bonded"
    yeoh_c2_over_mu: float = 0.0
    sides_mm: tuple[float, float] | None = None
    fidelity: str = "axisymmetric"

    @property
    def pad(self) -> Pad:
        """The slab with unit modulus as the pad model takes it."""
        from dummydesign.pad.material.hyperelastic import Yeoh
        from dummydesign.pad.pad import Pad

        return Pad(
            self.thickness_mm, 1.0, self.radius_mm, base=self.base, condition=self.condition,
            law=Yeoh(1.0, self.yeoh_c2_over_mu), sides_mm=self.sides_mm,
        )  # fmt: skip

    @property
    def corners_known(self) -> bool:
        """Whether this fidelity knows what the corners of the punch do; true for a round one."""
        from dummydesign.pad.elastic import has_square_factor

        return self.sides_mm is None or self.fidelity == "3d" or has_square_factor(self.pad)


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
class SolvedLaw(BaseForceLaw):
    """Elastic force of solved slabs, F = E a d exp(p(d / h)) with a polynomial p a thickness.

    Attributes
    ----------
    radius_mm : float
        Radius of the punch all slabs were solved for. [mm]
    polynomials : dict
        {thickness: coefficients of p, lowest power first}.
    limits_mm : dict
        {thickness: largest depth that was solved}. [mm]
    errors : dict
        {thickness: (depths [mm], relative errors of the force)}, numerical and of the fit.
    notes : tuple of str
        Why curves stop early.
    """

    radius_mm: float
    polynomials: dict[float, tuple[float, ...]]
    limits_mm: dict[float, float]
    errors: dict[float, tuple[NDArray, NDArray]]
    notes: tuple[str, ...]

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force at solved thicknesses and the one solved radius; see
        :class:`dummydesign.pad.force_law.ForceLaw`. [N]
        """
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


    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Error of the force over the force, between solved depths on straight lines; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        found = np.empty(depth.shape)
        for value in np.unique(thickness):
            at = thickness == value
            found[at] = np.interp(depth[at], *self.errors[float(value)])
        return found


def solve_slab(case: SlabCase) -> SolvedSlab:
    """Solve one slab of unit modulus to 0.6 of its thickness; a picklable task for any executor.

    Raises
    ------
    InputError
        When the punch has corners that an axisymmetric slab of this kind cannot have.
    InputError, NoAnswerError
        As :func:`dummydesign.pad.elastic.elastic_curve`.
    """
    from dummydesign.pad.elastic import elastic_curve

    if not case.corners_known:
        sides = "x".join(f"{side:g}" for side in case.sides_mm)
        raise InputError(
            f"punch of {sides} mm has no corners at fidelity = axisymmetric, which knows them of a glued square on a "
            "neo-Hookean slab inside the response table only; take fidelity 3d, or a round punch of the same area"
        )
    pad, depth = case.pad, np.array(SHARES) * case.thickness_mm
    if case.condition != "bonded" and case.fidelity != "3d":
        from dummydesign.pad.slab.sliding_faces import solve_flat

        curve = solve_flat(
            pad.thickness_mm, pad.radius_mm, pad.young_MPa, depth, pad.condition, base=pad.base, law=pad.law
        )
        return SolvedSlab(case, curve.depth_mm, curve.force_N, curve.error_N / curve.force_N, tuple(curve.notes))
    found = elastic_curve(pad, case.fidelity, float(depth[-1]), depth, None)
    depth = depth[depth <= found.limit_mm * (1.0 + 1e-9)]
    return SolvedSlab(case, depth, found.force(depth), found.relative_error(depth), tuple(found.notes))


def law_of(slabs: Iterable[SolvedSlab]) -> SolvedLaw:
    """Make one force law of slabs solved for the same punch.

    Raises
    ------
    NoAnswerError
        When a slab could not be solved to a useful depth.
    """
    polynomials, limits, errors, notes, radius = {}, {}, {}, [], 0.0
    for slab in slabs:
        thickness, radius = slab.case.thickness_mm, slab.case.radius_mm
        degree = DEGREE if slab.case.condition == "bonded" else SLIDING_DEGREE
        if len(slab.depth_mm) <= degree:
            raise NoAnswerError("no_convergence", f"slab of {thickness:g} mm: only {len(slab.depth_mm)} depths solved")
        logarithm = np.log(slab.area_mm2 / (radius * slab.depth_mm))
        fitted = np.polynomial.polynomial.polyfit(slab.depth_mm / thickness, logarithm, degree, w=1.0 / slab.error)
        polynomials[thickness] = tuple(float(value) for value in fitted)
        limits[thickness] = float(slab.depth_mm[-1])
        misfit = np.polynomial.polynomial.polyval(slab.depth_mm / thickness, fitted) - logarithm
        errors[thickness] = (slab.depth_mm, slab.error + np.abs(misfit))
        notes += [f"slab of {thickness:g} mm: {text}" for text in slab.notes]
    return SolvedLaw(radius, polynomials, limits, errors, tuple(notes))


def solve_law(
    thickness_mm: Sequence[float],
    radius_mm: float,
    executor: Executor | None = None,
    base: str = "bonded",
    condition: str = "bonded",
    sides_mm: tuple[float, float] | None = None,
    fidelity: str = "axisymmetric",
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
    sides_mm : (float, float), optional
        Sides of a rectangular punch. Where the fidelity does not know the corners the punch is taken as the circle;
        whoever asks has to say so (``Study.reduced``). [mm]
    fidelity : str
        ``axisymmetric`` or ``3d``; see :class:`SlabCase`.

    Raises
    ------
    NoAnswerError
        When a slab could not be solved to a useful depth.
    """
    cases = [
        SlabCase(value, radius_mm, base, condition, 0.0, sides_mm, fidelity)
        for value in sorted({float(v) for v in thickness_mm})
    ]
    cases = [case if case.corners_known else replace(case, sides_mm=None) for case in cases]
    return law_of((map if executor is None else executor.map)(solve_slab, cases))
