"""A nonlinear Maxwell law of soft tissue for one and for several subjects, its parameters, and the laws by name."""

from __future__ import annotations

import itertools
import math
import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.measurement.motion import Motion, ramp_and_hold

SETTLED_S = 10.0
"""From this hold on a subject counts as relaxed: what its arms then hold is below 0.6 % of its depth from 5 N on."""
HELD_FORCES = 40


def stack(subjects: Sequence[Parameters], velocity_mm_s: float) -> tuple[NDArray, NDArray, NDArray]:
    """Stack gamma1 (S,), gamma (S, arms) and dampers (S, arms) of a tissue's subjects at one speed."""
    gamma1 = np.array([subject.gamma1_N_per_mm3 for subject in subjects])
    gamma = np.array([subject.gamma_N_per_mm3 for subject in subjects])
    return gamma1, gamma, np.array([subject.dampers_at(velocity_mm_s) for subject in subjects])


class MotionResponse:
    """What a motion does to a law: the elastic shape X(t), shape (..., n), and the response A(t; r) of an arm. [mm3]"""

    elastic: NDArray

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
        raise NotImplementedError("a law of one element has no arm")


class MaxwellLaw(ABC):
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

    @abstractmethod
    def drive(self, motion: Motion) -> MotionResponse:
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
            f"law = '{self.name}' follows ideal ramps only; a robot of finite mass needs a tissue of law ode",
            "unsupported",
            "law",
            self.name,
        )

    def notice_of(self, name: str) -> tuple[str, str] | None:
        """Code and words of what must be said of a tissue of this law, by its name; None for nothing."""
        return None

    def parameter_names(self, elements: int) -> list[str]:
        """Names of the parameters, in the order gamma1, gamma2.., c2..; refuses elements the law does not have."""
        if elements not in self.elements:
            message = f"elements = {elements} is not one of {', '.join(map(str, self.elements))}"
            raise InputError(message, "unknown_name", "elements", elements, self.elements)
        arms = range(2, 2 + (elements - 1) // 2)
        return [self.steady_name, *(f"gamma{i}_N_per_mm3" for i in arms), *(f"c{i}_N_s_per_mm" for i in arms)]

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
        ends = zip([size + end for end in self.log_gamma1], springs, dampers)
        low, high = (np.repeat(end, [1, arms, groups * arms]) for end in ends)
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
            message = f"{gamma.shape[-1]} springs but {damper.shape[-1]} dampers; each arm needs one of both"
            raise InputError(message, "inconsistent", "c_N_s_per_mm")
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

    def steady_depths(self, subjects: Sequence[Parameters], force_N: ArrayLike) -> NDArray:
        """Depth of each subject at rest, shape (subjects, ...); a force below 0 counts as 0. [mm]"""
        force = np.maximum(np.asarray(force_N, float), 0.0)
        return np.stack([self.root(force / subject.gamma1_N_per_mm3) for subject in subjects])

    def exponent_of(self, subjects: Sequence[Parameters], low_N: float, high_N: float, hold_s: float) -> float:
        """Exponent of the subjects' steady force over depth between two forces; that of the law.

        Parameters
        ----------
        subjects : sequence of Parameters
            All of this law.
        low_N, high_N : float
            [N]
        hold_s : float
            At whose end forces are steady. [s]
        """
        return self.power

    def held_depths(
        self,
        subjects: Sequence[Parameters],
        force_N: NDArray,
        velocity_mm_s: float,
        hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:
        """Depths at which subjects still carry forces at the end of a hold, shape (subjects, n). [mm]

        Parameters
        ----------
        subjects : sequence of Parameters
            All of this law.
        force_N : ndarray, shape (n,)
            Above 0. [N]
        velocity_mm_s, hold_s, deceleration_mm_s2 : float
            Ramp, hold and braking. [mm/s, s, mm/s2]
        """
        arms = stack(subjects, velocity_mm_s)

        def coarse(depth: NDArray) -> Motion:
            return ramp_and_hold(velocity_mm_s, depth, hold_s, deceleration_mm_s2, 24, 12, 3)

        return np.stack([self.steady_depth(coarse, float(force), *arms) for force in force_N], axis=-1)

    def end_of_hold_depths(
        self,
        subjects: Sequence[Parameters],
        force_N: NDArray,
        velocity_mm_s: float,
        hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:
        """Return the held depths at many rising forces: at rest after a long hold, else between forty of them. [mm]

        See :meth:`~dummydesign.tissue.model.maxwell_law.MaxwellLaw.held_depths`.
        """
        if self.measured:
            return self.held_depths(subjects, force_N, velocity_mm_s, hold_s, deceleration_mm_s2)
        if hold_s >= 0.98 * SETTLED_S:
            return self.steady_depths(subjects, force_N)
        known = np.geomspace(force_N[0], force_N[-1], HELD_FORCES if force_N[-1] > force_N[0] else 1)
        depth = np.log(self.held_depths(subjects, known, velocity_mm_s, hold_s, deceleration_mm_s2))
        return np.exp([np.interp(np.log(force_N), np.log(known), row) for row in depth])

    def press(
        self,
        subjects: Sequence[Parameters],
        force_N: float,
        velocity_mm_s: float,
        hold_s: float,
        deceleration_mm_s2: float,
    ) -> tuple[Motion, NDArray, NDArray]:
        """Press every subject to its own depth for the same force at the end of the hold.

        Parameters
        ----------
        subjects : sequence of Parameters
            All of this law.
        force_N, velocity_mm_s, hold_s, deceleration_mm_s2 : float
            [N, mm/s, s, mm/s2]

        Returns
        -------
        motion : Motion
            Arrays of shape (subjects, n).
        force : ndarray, shape (subjects, n)
            [N]
        depth : ndarray, shape (subjects,)
            [mm]
        """
        depth = self.held_depths(subjects, np.array([force_N]), velocity_mm_s, hold_s, deceleration_mm_s2)[:, 0]
        motion = ramp_and_hold(velocity_mm_s, depth, hold_s, deceleration_mm_s2)
        return motion, self.force(motion, *stack(subjects, velocity_mm_s)), depth


def arms_of(names: Any) -> list[int]:
    """Numbers of the arms, 2 and up, that have a spring among parameter names."""
    return sorted(int(name[5]) for name in names if name.startswith("gamma") and name[5] != "1")


LAWS: dict[str, MaxwellLaw] = {}
"""Laws by name; :mod:`~dummydesign.tissue.model.laws` fills it."""
DEFAULT = "ode"
"""Law that follows any motion, of the built-in tissues."""


def law_named(name: str) -> MaxwellLaw:
    """Find a law by its name, or raise InputError with the nearest known one."""
    if name not in LAWS:
        raise unknown_name("law", name, LAWS)
    return LAWS[name]


def fitted_law(name: str) -> MaxwellLaw:
    """Find a law that is fitted to traces, or raise InputError."""
    law = law_named(name)
    if not law.fitted:
        message = f"law = {name} is not fitted to traces: it is {law.words}; fit ode, consistent or published"
        raise InputError(message, "unsupported", "law", name)
    return law


@dataclass(frozen=True)
class Parameters:
    """Parameters of the tissue law; arm 2 is the slow one."""

    law: str
    gamma1_N_per_mm3: float
    gamma_N_per_mm3: tuple[float, ...]
    c_N_s_per_mm: tuple[tuple[float, tuple[float, ...]], ...]

    def __post_init__(self) -> None:
        springs, numbers = len(self.gamma_N_per_mm3), [self.gamma1_N_per_mm3, *self.gamma_N_per_mm3]
        if springs and not self.c_N_s_per_mm:
            raise InputError("tissue parameters need dampers for at least one speed", "missing", "c_N_s_per_mm")
        for _, dampers in self.c_N_s_per_mm:
            if len(dampers) != springs:
                message = f"{springs} springs but {len(dampers)} dampers in the arms"
                raise InputError(message, "inconsistent", "c_N_s_per_mm")
            numbers += dampers
        if min(numbers) <= 0:
            raise out_of_range("tissue parameter", min(numbers), "above 0", "any finite value")

    @property
    def velocities_mm_s(self) -> tuple[float, ...]:
        """Speeds at which dampers are known. [mm/s]"""
        return tuple(speed for speed, _ in self.c_N_s_per_mm)

    def dampers_at(self, velocity_mm_s: float) -> tuple[float, ...]:
        """Dampers at a speed: ln c is linear in ln v between known speeds and constant outside them."""
        known = self.c_N_s_per_mm
        if not known:
            return ()
        if velocity_mm_s <= known[0][0]:
            return known[0][1]
        for (slow, before), (fast, after) in itertools.pairwise(known):
            if velocity_mm_s <= fast:
                share = math.log(velocity_mm_s / slow) / math.log(fast / slow)
                return tuple(b * (a / b) ** share for b, a in zip(before, after))
        return known[-1][1]

    def force(self, motion: Motion, velocity_mm_s: float) -> NDArray:
        """Force under a motion with the dampers of the given speed; shape of the motion. [N]

        Examples
        --------
        >>> from dummydesign.measurement.motion import ramp_and_hold
        >>> from dummydesign.tissue import load_tissue
        >>> finger = load_tissue("forefinger").target()
        >>> force_N = finger.force(ramp_and_hold(10.0, 1.0, hold_s=60.0), 10.0)
        >>> f"peak {force_N.max():.1f} N, after a minute {force_N[-1]:.2f} N"  # gamma1 is 3.63 N/mm3
        'peak 7.0 N, after a minute 3.63 N'
        """
        dampers = self.dampers_at(velocity_mm_s)
        return law_named(self.law).force(motion, self.gamma1_N_per_mm3, self.gamma_N_per_mm3, dampers)

    def to_dict(self) -> dict[str, Any]:
        """Return the outward names: gamma1_N_per_mm3 .., c2_N_s_per_mm {speed: value} .., and the law."""
        by_speed = {speed_key(speed): dampers for speed, dampers in self.c_N_s_per_mm}
        arms = range(len(self.gamma_N_per_mm3))
        return {
            law_named(self.law).steady_name: self.gamma1_N_per_mm3,
            **{f"gamma{arm + 2}_N_per_mm3": self.gamma_N_per_mm3[arm] for arm in arms},
            **{f"c{arm + 2}_N_s_per_mm": {speed: c[arm] for speed, c in by_speed.items()} for arm in arms},
            "law": self.law,
        }

    @classmethod
    def from_dict(cls, law: str, values: Mapping[str, Any]) -> Parameters:
        """Make parameters from outward names; dampers are given as {speed: value}."""
        arms = arms_of(values)
        speeds = sorted(values.get(f"c{arms[0]}_N_s_per_mm", ()), key=float) if arms else []
        gamma = tuple(float(values[f"gamma{arm}_N_per_mm3"]) for arm in arms)
        c = [(float(speed), tuple(float(values[f"c{arm}_N_s_per_mm"][speed]) for arm in arms)) for speed in speeds]
        return cls(law, float(values[law_named(law).steady_name]), gamma, tuple(c))


def speed_key(velocity_mm_s: float) -> str:
    """Write a speed as the key used in JSON and files: ``"10"``, ``"250"``, ``"2.5"``."""
    return f"{velocity_mm_s:g}"


ARM = re.compile(r"(gamma|c)([2-9])_")
SPEEDS_OF_ARMS = {1: ("",), 2: ("slow ", "fast "), 3: ("slow ", "middle ", "fast ")}


def arm_names(labels: Iterable[str]) -> dict[str, str]:
    """Arms of a law by their number, in words; arm 2 is the slow one."""
    arms = sorted({match[2] for label in labels if (match := ARM.match(label))})
    return dict(zip(arms, SPEEDS_OF_ARMS.get(len(arms), tuple(f"{arm}. " for arm in arms))))


def parameter_words(label: str, arms: Mapping[str, str]) -> tuple[str, str] | None:
    """A parameter of the law in words, and its unit; None for another law's."""
    if label.startswith("gamma1_"):
        return "steady stiffness", "N/mm³"
    if match := ARM.match(label):
        what, unit = ("stiffness", "N/mm³") if match[1] == "gamma" else ("damper", "N s/mm")
        return f"{arms[match[2]]}arm, {what}", unit
    return None
