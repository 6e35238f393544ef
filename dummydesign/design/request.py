"""The question of ``suggest``, read from texts or values, with the presses that a pad is judged by; command and Python
call give the same."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from functools import cached_property, partial
from os import fspath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core import parsing
from dummydesign.core.errors import InputError
from dummydesign.core.parsing import parse_limits, read_number, read_numbers, read_size
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH

# File of the answer in the folder of `suggest`.
ANSWER = "suggest.json"


def face_of(punch: str, condition: str | None) -> str:
    """How a punch as typed holds a face: by the condition, else glued, but sliding freely where it is not flat."""
    return condition or ("frictionless" if punch.startswith(("ball:", "profile:")) else "bonded")


def read_sites(text: str | tuple[int, int]) -> tuple[int, int]:
    """Read ``NxM``, crowns along the length times across the width."""
    from dummydesign.geometry.shapes.crowned import MOST_SITES

    parts = text.lower().split("x") if isinstance(text, str) else [str(value) for value in text]
    if len(parts) != 2 or not all(part.strip().isdigit() and 1 <= int(part) <= MOST_SITES for part in parts):
        shown = text if isinstance(text, str) else "x".join(parts)
        message = f"sites = {shown} is not NxM with 1 to {MOST_SITES} crowns each way, such as 4x3"
        raise InputError(message, "malformed", "sites", shown)
    return int(parts[0]), int(parts[1])


def base_words(base: str) -> str:
    """Return in words how a pad lies on its base."""
    return {"bonded": "glued to a rigid base", "sliding": "sliding on a rigid base"}.get(base, f"resting, {base}")


READERS: dict[str, Callable[[Any], Any]] = {
    "thickness_mm": partial(parse_limits, quantity="thickness in mm"),
    "ratio": partial(parse_limits, quantity="ratio"),
    "mould": fspath,
    "hold_s": partial(read_number, purpose=parsing.HOLD),
    "deceleration_mm_s2": partial(read_number, purpose=parsing.DECELERATION),
    "calibration": fspath,
    "force_N": partial(read_numbers, purpose=parsing.FORCE),
    "velocity_mm_s": partial(read_numbers, purpose=parsing.VELOCITY),
    "pad_mm": partial(read_size, quantity="pad"),
    "edge_radius_mm": partial(read_number, purpose=parsing.EDGE),
    "sites": read_sites,
    "effects": lambda paths: tuple(map(fspath, paths)),
}
"""How what is typed or given is read; other values are taken as they are."""


LOW_SHARES = (0.1, 0.2)
"""Forces below the lowest of the test at which exponents are given, over that force."""
FINE, COARSE = 41, 10


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


@dataclass(frozen=True)
class Request:
    """The question, in the order of the answer's inputs.

    Ranges are (low, high) with both ends included, None for all that is allowed. ``punch``, ``force_N``,
    ``velocity_mm_s``, ``hold_s``, ``pad_mm``, ``base``, ``edge_radius_mm`` and ``condition`` are the test that the pad
    and the people behind the tissue are pressed by; ``preset`` is of its mould. ``sites`` are how
    many crowns stand along and across the pad. ``cad`` is whether the mould of a pad that is not red is made,
    ``effects`` are files of own effects.
    """

    tissue: str
    aim: str = "average"
    resin: str = "polyurethane-nagoya"
    thickness_mm: tuple[float, float] | None = None
    ratio: tuple[float, float] | None = None
    shape: str = "auto"
    mould: str | None = None
    verify: bool = True
    hold_s: float = 10.0
    deceleration_mm_s2: float = 30_000.0
    calibration: str | None = None
    punch: str = PUNCH
    force_N: tuple[float, ...] = (5.0, 10.0, 15.0)
    velocity_mm_s: tuple[float, ...] = (10.0, 250.0)
    pad_mm: tuple[float, float] = PAD_LENGTH_MM, PAD_WIDTH_MM
    base: str = "bonded"
    edge_radius_mm: float = 0.0
    condition: str | None = None
    preset: str = "open"
    sites: tuple[int, int] | None = None
    cad: bool = True
    effects: tuple[str, ...] = ()

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

    @classmethod
    def read(cls, **given: Any) -> Request:
        """Read texts or values by the names of the arguments of ``suggest``, the rest default; no other names count."""
        given = {"pad_mm" if name == "pad" else name: value for name, value in given.items()}
        known = {one.name: given[one.name] for one in fields(cls) if one.name in given}
        return cls(**{name: READERS[name](x) if name in READERS and x is not None else x for name, x in known.items()})

    def to_dict(self) -> dict[str, Any]:
        """Return what was asked, defaults included."""
        asked = asdict(self) | {"condition": self.face}
        return {name: value for name, value in asked.items() if name != "effects"}
