"""One set of parameters of the tissue law: springs, dampers per speed, and the law they belong to."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.tissue.model.maxwell_law import arms_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dummydesign.measurement.motion import Motion


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
        from dummydesign.tissue.model.laws import law_named

        dampers = self.dampers_at(velocity_mm_s)
        return law_named(self.law).force(motion, self.gamma1_N_per_mm3, self.gamma_N_per_mm3, dampers)

    def to_dict(self) -> dict[str, Any]:
        """Return the outward names: gamma1_N_per_mm3 .., c2_N_s_per_mm {speed: value} .., and the law."""
        from dummydesign.tissue.model.laws import law_named

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
        from dummydesign.tissue.model.laws import law_named

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
