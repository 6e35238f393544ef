"""What a law says of several subjects at once: their depths at rest and at the end of a hold, and their presses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, ramp_and_hold

if TYPE_CHECKING:
    from dummydesign.tissue.model.parameters import Parameters

SETTLED_S = 10.0
"""From this hold on a subject counts as relaxed: what its arms then hold is below 0.6 % of its depth from 5 N on."""
HELD_FORCES = 40


class SubjectsLaw(ABC):
    """Subjects of one law; what is here follows from its force, its steady depth and its power."""

    power: ClassVar[float] = 3.0

    @abstractmethod
    def root(self, ratio: ArrayLike) -> NDArray:
        """Depth at rest from force over the steady coefficient. [mm]"""

    @abstractmethod
    def force(
        self, motion: Motion, gamma1_N_per_mm3: ArrayLike, gamma_N_per_mm3: ArrayLike, c_N_s_per_mm: ArrayLike
    ) -> NDArray:
        """Force under a motion. [N]

        Parameters
        ----------
        motion : Motion
            Arrays of shape (n,) or (..., n).
        gamma1_N_per_mm3, gamma_N_per_mm3, c_N_s_per_mm : array_like, shapes (...) and (..., arms)
            Steady coefficient, springs and dampers of the arms. [N/mm3, N s/mm]
        """

    @abstractmethod
    def steady_depth(
        self, make_motion: Callable[[NDArray], Motion], force_N: ArrayLike, gamma1: ArrayLike, gamma: ArrayLike,
        c: ArrayLike,
    ) -> NDArray:  # fmt: skip
        """Depth whose force at the end of the hold is given. [mm]

        Parameters
        ----------
        make_motion : callable
            Maps depths of shape (...) to a Motion that ends with the hold.
        force_N, gamma1 : array_like, shape (...)
            Force at the end of the hold, and steady coefficient. [N, N/mm3]
        gamma, c : array_like, shape (..., arms)
            Arms.
        """

    def steady_depths(self, subjects: Sequence[Parameters], force_N: ArrayLike) -> NDArray:
        """Depth of each subject at rest, shape (subjects, ...). [mm]

        Parameters
        ----------
        subjects : sequence of Parameters
        force_N : array_like, shape (...)
            Below 0 counts as 0. [N]
        """
        force = np.maximum(np.asarray(force_N, float), 0.0)
        return np.stack([self.root(force / subject.gamma1_N_per_mm3) for subject in subjects])

    def steady_forces(self, subjects: Sequence[Parameters], depth_mm: ArrayLike) -> NDArray:
        """Force of each subject at rest, shape (subjects, ...). [N]

        Parameters
        ----------
        subjects : sequence of Parameters
        depth_mm : array_like, shape (...)
            Below 0 counts as 0. [mm]
        """
        powered = np.maximum(np.asarray(depth_mm, float), 0.0) ** self.power
        return np.stack([subject.gamma1_N_per_mm3 * powered for subject in subjects])

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
        self, subjects: Sequence[Parameters], force_N: NDArray, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:  # fmt: skip
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
        gamma1, gamma, dampers = stack(subjects, velocity_mm_s)[1:]

        def coarse(depth: NDArray) -> Motion:
            return ramp_and_hold(velocity_mm_s, depth, hold_s, deceleration_mm_s2, 24, 12, 3)

        return np.stack([self.steady_depth(coarse, float(force), gamma1, gamma, dampers) for force in force_N], axis=-1)

    def end_of_hold_depths(
        self, subjects: Sequence[Parameters], force_N: NDArray, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> NDArray:  # fmt: skip
        """The held depths at many rising forces: at rest after a long hold, else between forty of them. [mm]

        Parameters
        ----------
        subjects : sequence of Parameters
            All of this law.
        force_N : ndarray, shape (n,)
            Rising, above 0. [N]
        velocity_mm_s, hold_s, deceleration_mm_s2 : float
            Ramp, hold and braking. [mm/s, s, mm/s2]
        """
        if hold_s >= 0.98 * SETTLED_S:
            return self.steady_depths(subjects, force_N)
        known = np.geomspace(force_N[0], force_N[-1], HELD_FORCES if force_N[-1] > force_N[0] else 1)
        depth = np.log(self.held_depths(subjects, known, velocity_mm_s, hold_s, deceleration_mm_s2))
        return np.exp([np.interp(np.log(force_N), np.log(known), row) for row in depth])

    def press(
        self, subjects: Sequence[Parameters], force_N: float, velocity_mm_s: float, hold_s: float,
        deceleration_mm_s2: float,
    ) -> tuple[Motion, NDArray, NDArray]:  # fmt: skip
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
        return motion, self.force(motion, *stack(subjects, velocity_mm_s)[1:]), depth


def stack(subjects: Sequence[Parameters], velocity_mm_s: float) -> tuple[str, NDArray, NDArray, NDArray]:
    """Law, gamma1 (S,), gamma (S, arms) and dampers (S, arms) of several subjects at one speed.

    Raises
    ------
    InputError
        For subjects of different laws or numbers of elements.
    """
    law = one_law(subjects)
    if len({len(subject.gamma_N_per_mm3) for subject in subjects}) != 1:
        raise InputError("subjects fitted with different numbers of elements cannot share a range")
    gamma1 = np.array([subject.gamma1_N_per_mm3 for subject in subjects])
    gamma = np.array([subject.gamma_N_per_mm3 for subject in subjects])
    dampers = np.array([subject.dampers_at(velocity_mm_s) for subject in subjects])
    return law, gamma1, gamma, dampers


def one_law(subjects: Sequence[Parameters]) -> str:
    """Name of the law that subjects share, or InputError where they do not."""
    laws = {subject.law for subject in subjects}
    if len(laws) != 1:
        raise InputError(f"subjects fitted with different laws ({', '.join(sorted(laws))}) cannot share a range")
    return laws.pop()
