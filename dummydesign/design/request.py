"""What is asked of :func:`dummydesign.design.suggest.suggest`, and the press that every design is judged by."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.options import SuggestOptions
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM

Progress = Callable[[str], None]
"""Called with the name of each step as it begins."""


def quiet(step: str) -> None:
    """Tell nobody."""


RADIUS_MM = PUNCH_RADIUS_MM
"""Circle of the area of the paper's 14 x 14 mm impactor. [mm]"""

LOW_SHARES = (0.1, 0.2)
"""Forces below the lowest of the test at which exponents are given, over that force."""
FINE, COARSE = 41, 10
# File of the answer in the folder of `suggest`.
ANSWER = "suggest.json"


@dataclass(frozen=True)
class Protocol:
    """Presses of a test: every steady force at every speed."""

    forces_N: tuple[float, ...] = (5.0, 10.0, 15.0)
    velocities_mm_s: tuple[float, ...] = (10.0, 250.0)

    @property
    def slow_mm_s(self) -> float:
        """The slowest ramp, at which steady curves are taken. [mm/s]"""
        return self.velocities_mm_s[0]

    @property
    def fast_mm_s(self) -> float:
        """The fastest ramp. [mm/s]"""
        return self.velocities_mm_s[-1]

    @property
    def needed_N(self) -> float:
        """The force that a design has to reach at every speed: the middle one, 10 of 5, 10 and 15 N."""
        return self.forces_N[len(self.forces_N) // 2]

    @cached_property
    def steady_grid_N(self) -> NDArray:
        """Steady forces at which the steady curve is scored, from the lowest to the highest. [N]"""
        return np.linspace(self.forces_N[0], self.forces_N[-1], FINE if len(self.forces_N) > 1 else 1)

    @cached_property
    def low_grid_N(self) -> NDArray:
        """Steady forces below those of the test, from a tenth of the lowest: reported, not scored. [N]"""
        return np.linspace(0.1 * self.forces_N[0], self.forces_N[0], COARSE)

    @cached_property
    def misfit_N(self) -> NDArray:
        """Forces over which the misfit is taken, even in the logarithm. [N]"""
        return np.geomspace(0.1 * self.forces_N[0], self.forces_N[-1], 40)

    @cached_property
    def wide_N(self) -> NDArray:
        """Forces far beyond those of the test: a flat pad's own, at the depths of a soft tissue. [N]"""
        return np.geomspace(2e-4 * self.forces_N[0], 10.0 * self.forces_N[-1], 400)

    @cached_property
    def exponent_at_N(self) -> tuple[float, ...]:
        """Forces at which exponents are given. [N]"""
        return (*(float(f"{share * self.forces_N[0]:.6g}") for share in LOW_SHARES), *self.forces_N)

    @property
    def words(self) -> str:
        """The forces as the span of the scored curve: ``5 to 15 N``."""
        low, high = self.forces_N[0], self.forces_N[-1]
        return f"{low:g} to {high:g} N" if high > low else f"{low:g} N"


NAGOYA_PROTOCOL = Protocol()
"""5, 10 and 15 N at 10 and 250 mm/s."""


def face_of(punch: str, condition: str | None) -> str:
    """How a punch as typed holds a face: by the condition, else glued, but sliding freely where it is not flat."""
    return condition or ("frictionless" if punch.startswith(("ball:", "profile:")) else "bonded")


@dataclass(frozen=True)
class Request(SuggestOptions):
    """The question. Ranges are (low, high) with both ends included, None for all that is allowed.

    ``punch``, ``force_N``, ``velocity_mm_s``, ``hold_s``, ``pad_mm``, ``base``, ``edge_radius_mm`` and ``condition``
    are the test that the pad and the people behind the tissue are pressed by; ``preset``, ``machine`` and ``silicone``
    are of its mould, None for what the preset names. ``sites`` are how many crowns stand along and across the pad,
    ``castings`` how many castings are drawn.
    """

    @property
    def kind(self) -> str:
        """The shape that is searched: several sites are those of crowns."""
        return "crowned" if self.sites and self.shape.lower() == "auto" else self.shape

    @property
    def face(self) -> str:
        """How the punch holds the pad's face: as asked, else glued, or freely sliding under one without a flat face."""
        return face_of(self.punch, self.condition)

    @property
    def protocol(self) -> Protocol:
        """Steady forces and speeds, rising."""
        return Protocol(tuple(sorted(set(self.force_N))), tuple(sorted(set(self.velocity_mm_s))))

    @property
    def punch_text(self) -> str:
        """The punch in words, such as ``14 x 14 mm``."""
        kind, _, size = self.punch.partition(":")
        if kind == "square":
            return f"{size} x {size} mm"
        return f"{size.replace('x', ' x ')} mm" if kind == "rectangle" else f"{kind} {size}"

    def to_dict(self) -> dict[str, Any]:
        """Return what was asked, defaults included."""
        return asdict(self) | {"condition": self.face}
