"""The contract of a nonlinear Maxwell law of soft tissue.

A spring gamma1 x^2 acts in parallel with arms of a spring gamma_i and a damper c_i in series: one arm is the
three-element law, two the five-element law, three the seven-element law. With the arm's rate r_i = gamma_i / c_i the
force is linear in all gammas,

    F(t) = gamma1 X(t) + sum_i gamma_i A(t; r_i),

and only X, the cube of the displacement a law sees, and A differ from law to law. At rest under a depth x the force is
gamma1 x^3 in all of them. A law is one module in :mod:`dummydesign.tissue.model.laws`.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.subjects_law import SubjectsLaw


class Drive(Protocol):
    """What a motion does to a law: the elastic shape X(t) and the response A(t; r) of an arm, both in mm3."""

    elastic: NDArray
    """X(t), shape (..., n). [mm3]"""

    def arm(self, rate: ArrayLike) -> NDArray:
        """Response A(t; r) of an arm with spring constant 1 and damper 1 / r. [mm3]

        Parameters
        ----------
        rate : array_like, shape (...)
            r = gamma / c, above or equal to 0. [1 / (mm2 s)]

        Returns
        -------
        ndarray, shape (..., n)
        """


class MaxwellLaw(SubjectsLaw):
    """One form of the law: everything that differs between forms is a method here, and nothing else names a form.

    Attributes
    ----------
    name : str
        As tissue files and commands call it.
    words : str
        What it is, to follow "fitted to traces:" in a report.
    reference : str
        Where it is from.
    elements : tuple of int
        Numbers of elements it may have: 1 + 2 a relaxing arm.
    ideal_ramp : bool
        Whether it knows an ideal ramp only (mean speed and stop time of what it is given), not the measured motion.
    log_gamma1, log_gamma : (float, float)
        Bounds of ln gamma1 and ln gamma_i over the size of gamma1 in the traces; those of c follow from the rates.
    power : float
        Exponent of the steady force over depth, 3 for springs gamma x^2. The steady coefficient, called gamma1 in the
        package, is then in N / mm^power.
    steady_name : str
        Name of that coefficient in files and answers.
    fitted : bool
        Whether it is fitted to traces.
    measured : bool
        Whether its subjects are measured curves and no parameters.
    live : dict or None
        What ``live.js`` computes the law by; None where a page cannot.
    """

    name: ClassVar[str]
    words: ClassVar[str]
    reference: ClassVar[str]
    elements: ClassVar[tuple[int, ...]] = (3, 5, 7)
    ideal_ramp: ClassVar[bool] = False
    power: ClassVar[float] = 3.0
    steady_name: ClassVar[str] = "gamma1_N_per_mm3"
    fitted: ClassVar[bool] = True
    measured: ClassVar[bool] = False
    log_gamma1: ClassVar[tuple[float, float]] = (-6.0, 3.0)
    log_gamma: ClassVar[tuple[float, float]] = (float(np.log(1e-5)), float(np.log(1e4)))
    live: ClassVar[dict[str, Any] | None] = None

    @abstractmethod
    def drive(self, motion: Motion) -> Drive:
        """What a motion, arrays of shape (n,) or (..., n), does to the law."""

    def stretch_rates(self, depth_mm: NDArray, rate: NDArray) -> tuple[NDArray, NDArray]:
        """Law of the arms for a body that moves freely: q' = gain x' - decay q, F = gamma1 x^3 + x^2 sum gamma q.

        Parameters
        ----------
        depth_mm : ndarray, shape (...)
            x. [mm]
        rate : ndarray, shape (..., arms)
            gamma / c. [1 / (mm2 s)]

        Returns
        -------
        gain, decay : ndarray, shape (..., arms)
            [1, 1/s]

        Raises
        ------
        InputError
            By a law that does not say.
        """
        raise InputError(
            f"law = '{self.name}' follows ideal ramps only; a robot of finite mass needs a tissue of law ode"
        )

    def said_of(self, name: str) -> tuple[str, str] | None:
        """Code and words of what must be said of a tissue of this law, by its name; None for nothing."""
        return None

    def parameter_names(self, elements: int) -> list[str]:
        """Names of the parameters, in the order gamma1, gamma2.., c2..; refuses elements the law does not have."""
        if elements not in self.elements:
            raise InputError(f"elements = {elements} is not one of {', '.join(map(str, self.elements))}")
        return [self.steady_name, *parameter_names(elements)[1:]]

    def root(self, ratio: ArrayLike) -> NDArray:
        """Depth at rest from force over the steady coefficient. [mm]"""
        value = np.asarray(ratio, float)
        return np.cbrt(value) if self.power == 3.0 else value ** (1.0 / self.power)

    def bounds(
        self, arms: int, groups: int, gamma1_N_per_mm3: float, log_rate: tuple[float, float]
    ) -> tuple[NDArray, NDArray]:
        """Lowest and highest ln of gamma1, gamma (arms) and c (groups x arms).

        Parameters
        ----------
        arms, groups : int
            Relaxing arms, and groups of traces with dampers of their own.
        gamma1_N_per_mm3 : float
            Size of gamma1 in the traces. [N/mm3]
        log_rate : (float, float)
            Slowest and fastest ln gamma / c that is looked for.
        """
        size = float(np.log(gamma1_N_per_mm3))
        springs = [size + end for end in self.log_gamma]
        dampers = [springs[0] - log_rate[1], springs[1] - log_rate[0]]
        low, high = (
            np.r_[size + self.log_gamma1[end], np.full(arms, springs[end]), np.full(groups * arms, dampers[end])]
            for end in (0, 1)
        )
        return low, high

    def force(
        self, motion: Motion, gamma1_N_per_mm3: ArrayLike, gamma_N_per_mm3: ArrayLike, c_N_s_per_mm: ArrayLike
    ) -> NDArray:
        """Force under a motion, for one or many parameter sets at once.

        Parameters
        ----------
        motion : Motion
            Arrays of shape (n,) or (..., n).
        gamma1_N_per_mm3 : array_like, shape (...)
            Steady stiffness coefficient, F_s = gamma1 x^3. [N/mm3]
        gamma_N_per_mm3, c_N_s_per_mm : array_like, shape (..., arms)
            Spring and damper of each arm, c above 0. [N/mm3, N s/mm]

        Returns
        -------
        ndarray, shape (..., n)
            Force. [N]

        Raises
        ------
        InputError
            For a damper that is not positive or a negative gamma.
        """
        gamma1 = np.asarray(gamma1_N_per_mm3, float)
        gamma, damper = np.asarray(gamma_N_per_mm3, float), np.asarray(c_N_s_per_mm, float)
        if not np.all(damper > 0):
            raise out_of_range("damper c_N_s_per_mm", float(damper.min()), "above 0", "any finite value")
        if np.any(gamma < 0) or np.any(gamma1 < 0):
            raise out_of_range("gamma", float(min(gamma.min(), gamma1.min())), 0, "any finite value")
        if gamma.shape[-1:] != damper.shape[-1:]:
            raise InputError(f"{gamma.shape[-1]} springs but {damper.shape[-1]} dampers; each arm needs one of both")
        drive = self.drive(motion)
        total = gamma1[..., None] * drive.elastic
        for arm in range(gamma.shape[-1]):
            strength = gamma[..., arm]
            total = total + strength[..., None] * drive.arm(strength / damper[..., arm])
        return total

    def steady_depth(
        self, make_motion: Any, force_N: ArrayLike, gamma1: ArrayLike, gamma: ArrayLike, c: ArrayLike
    ) -> NDArray:
        """Depth whose force at the end of the hold is ``force_N``: secants of ln F over ln x from that at rest. [mm]

        Parameters
        ----------
        make_motion : callable
            Maps depths of shape (...) to a Motion that ends with the hold.
        force_N, gamma1 : array_like, shape (...)
            Force at the end of the hold [N] and steady coefficient [N/mm3].
        gamma, c : array_like, shape (..., arms)
            Arms.

        Returns
        -------
        ndarray, shape (...)
        """
        target = np.asarray(force_N, float)
        depth = self.root(target / np.asarray(gamma1, float))
        slope, before = np.full(np.shape(depth), self.power), None
        for _ in range(30):
            lacking = np.log(target / self.force(make_motion(depth), gamma1, gamma, c)[..., -1])
            if before is not None:
                moved = np.log(depth / before[0])
                known = np.abs(moved) > 1e-9
                secant = (before[1] - lacking) / np.where(known, moved, 1.0)
                slope = np.where(known, np.clip(secant, 0.5 * self.power, 2.0 * self.power), slope)
            before = depth, lacking
            depth = depth * np.exp(lacking / slope)
            if np.all(np.abs(lacking) < 1e-7):
                break
        return depth


def parameter_names(elements: int) -> list[str]:
    """Names of the parameters of a law of so many elements, in the order gamma1, gamma2.., c2.."""
    arms = range(2, 2 + (elements - 1) // 2)
    return [f"gamma{i}_N_per_mm3" for i in (1, *arms)] + [f"c{i}_N_s_per_mm" for i in arms]


def arms_of(names: Any) -> list[int]:
    """Numbers of the arms, 2 and up, that have a spring among parameter names."""
    return sorted(int(name[5]) for name in names if name.startswith("gamma") and name[5] != "1")
