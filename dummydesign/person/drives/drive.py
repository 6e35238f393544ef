"""The contract of a drive, what moves the robot and so presses a person, and the signs of a drive in a trace."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import QuantitySpec, read_number
from dummydesign.core.serialise import Serialised
from dummydesign.person.integrate import FOUR, PersonResponse
from dummydesign.person.people import People
from dummydesign.person.press import SHORTEST_HOLD_S, Press
from dummydesign.person.smoothing import RobotArm

FASTER = 20.0
"""Factor of the tolerance where only the four numbers of many draws are wanted."""
DAMPING = QuantitySpec("damping ratio", "", (0.0, 1.0))
MASS = QuantitySpec("mass in kg", "kg", (0.05, 500.0))
STIFFNESS = QuantitySpec("stiffness in N/mm", "N/mm", (0.1, 10_000.0))
MASSES, STIFFNESSES = (1e-3, 1e4), (1e-3, 1e6)
"""Masses and stiffnesses that are allowed with their unit. [kg, N/mm]"""
DAMPINGS = (0.0, 2.0)
"""Damping ratios of an arm that are allowed."""


class RobotDrive(ABC):
    """One way in which a robot moves; an own one is a module of this folder with one subclass.

    Attributes
    ----------
    name : str
        As ``--drive`` takes it, before a colon.
    form : str
        The whole word with its numbers, such as ``mass:KG``.
    numbers : tuple of (Purpose, (float, float))
        What its numbers are, and their ranges.
    defaults : tuple of float
        Values of the last numbers, which may be left out.
    curves : bool
        Whether it works with measured curves, without a law.
    words : str
        What it is, in a report: one sentence without a capital and a full stop.
    """

    name: ClassVar[str]
    form: ClassVar[str]
    numbers: ClassVar[tuple[tuple[QuantitySpec, tuple[float, float]], ...]] = ()
    defaults: ClassVar[tuple[float, ...]] = ()
    curves: ClassVar[bool] = False
    words: ClassVar[str]

    def __init__(self, *values: float) -> None:
        left_out = len(self.numbers) - len(values)
        values = (*values, *self.defaults[len(self.defaults) - left_out :]) if left_out > 0 else values
        for (purpose, (low, high)), value in zip(self.numbers, values, strict=True):
            if not low <= value <= high:
                raise out_of_range(purpose.quantity, f"{value:g}", f"{low:g}", f"{high:g}")
        self.values = values

    @classmethod
    def read(cls, text: str) -> RobotDrive:
        """Make the drive from what stands behind the colon."""
        parts = text.split(",") if text else []
        if not len(cls.numbers) - len(cls.defaults) <= len(parts) <= len(cls.numbers):
            message = f"drive '{cls.name}{':' if text else ''}{text}' is not of the form {cls.form}"
            raise InputError(message, "malformed", "drive", f"{cls.name}:{text}", cls.form)
        return cls(*(read_number(part.strip(), purpose) for part, (purpose, _) in zip(parts, cls.numbers)))

    @property
    def text(self) -> str:
        """The drive as it is typed, without last numbers that are their defaults."""
        given, usual = list(self.values), list(self.defaults)
        while usual and given[-1] == usual.pop():
            given.pop()
        return self.name + (":" + ",".join(f"{value:g}" for value in given) if given else "")

    @property
    def arm(self) -> RobotArm | None:
        """The arm that may ring in the trace; None where the drive has none."""
        return None

    def check(self, press: Press) -> None:
        """Refuse a press that the drive cannot carry over to people; by itself none."""
        return None

    def with_own_speed(self, press: Press) -> Press:
        """Return the press with the speed at contact that the drive knows better than the path; by itself as it is."""
        return press

    @abstractmethod
    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Press people as the robot pressed the pad.

        Parameters
        ----------
        press : Press
            Curves of shape (n,), or (p, n) with one for each person.
        people : People
        keep : bool
            Whether the curves are wanted, and not the four numbers alone.
        """

    def on_curves(self, press: Press, people: Sequence[Any]) -> PersonResponse:
        """Press persons who are measured curves; refused unless ``curves``."""
        raise InputError(
            f"drive = {self.name} needs the force under any motion, and the tissue is measured curves without a law; "
            "use --drive steady, or a tissue with a law",
            "unsupported",
            "drive",
            self.name,
        )

    def contradicted(self, signs: TraceSigns) -> str:
        """Say why this drive cannot have made the trace; empty where nothing speaks against it."""
        return ""

    def speed_doubt(self, press: Press) -> str:
        """Say why the speed at contact is not that of this drive; empty where nothing speaks against it."""
        return ""

    def on_pad(self, press: Press) -> dict[str, NDArray | None]:
        """The four numbers of the pad, over the same part of the press as those of people."""
        return {name: getattr(press, name) for name in FOUR}


def not_kept(signs: TraceSigns) -> str:
    """Say that the path was not kept, for drives that keep it; empty where it was."""
    if signs.looks_like == "force":
        return f"the depth crept by {signs.creep_mm:.2g} mm while the force was kept"
    if signs.looks_like == "mass":
        return f"the pad alone stopped a mass of {signs.mass_kg:.3g} kg"
    return ""


KEPT_MM, KEPT_SHARE = 0.04, 0.01
"""Creep in a hold up to which a path counts as kept: 0.04 mm, or 1 % of the depth. [mm]"""
RELAXED, FORCE_KEPT = 0.05, 0.03
"""Shares of the force at the stop that must relax for a path to be kept, and may change in a force that is kept."""
CREPT_SHARE = 0.02
FREE_MISFIT = 0.015
"""Share of the depth by which the path of a free mass may differ from the one that the force explains."""


@dataclass(frozen=True)
class TraceSigns(Serialised):
    """Signs of the drive in one press.

    ``looks_like`` is ``position``, ``force``, ``mass`` or None; ``creep_mm`` and ``relaxed_N`` are the changes from
    just after the stop to the end of the hold, None without a hold; ``mass_kg`` is the free mass that explains the
    path.
    """

    looks_like: str | None
    held_s: float
    creep_mm: float | None
    kept_mm: float
    relaxed_N: float | None
    force_N: float
    mass_kg: float | None


def signs_of(press: Press) -> TraceSigns:
    """Read the signs in a press."""
    depth = float(press.depth_mm)
    kept = max(KEPT_MM, KEPT_SHARE * depth)
    mass = _free_mass(press, depth)
    if press.hold_s < SHORTEST_HOLD_S:
        looks = "mass" if mass is not None else None
        return TraceSigns(looks, press.hold_s, None, kept, None, float(press.peak_N), mass)
    since = press.time_s - press.stop_s
    # the first samples of a hold still belong to the braking
    first = int(np.searchsorted(since, max(0.1 * press.stop_s, 0.02)))
    late = press.time_s >= press.time_s[-1] - 0.05 * press.hold_s
    creep = float(press.x_mm[late].mean() - press.x_mm[first])
    force = float(press.force_N[first])
    relaxed = force - float(press.force_N[late].mean())
    looks = None
    if abs(creep) <= kept and relaxed >= RELAXED * force:
        looks = "position"
    elif abs(relaxed) <= FORCE_KEPT * force and creep >= max(KEPT_MM, CREPT_SHARE * depth):
        looks = "force"
    return TraceSigns(looks, press.hold_s, creep, kept, relaxed, force, None)


def _free_mass(press: Press, depth: float) -> float | None:
    """Mass whose path x = v t - int int F / M explains the press up to its stop; None where none does. [kg]"""
    upto = slice(0, press.stopped + 1)
    time, force, x = press.time_s[upto], press.force_N[upto], press.x_mm[upto]
    if len(time) < 10:
        return None
    steps = np.diff(time)
    impulse = np.r_[0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * steps)]
    way = np.r_[0.0, np.cumsum(0.5 * (impulse[1:] + impulse[:-1]) * steps)]
    (speed, inverse), *_ = np.linalg.lstsq(np.stack([time, -way], axis=-1), x, rcond=None)
    left = x - speed * time + inverse * way
    stopped = inverse * impulse[-1] / speed if speed > 0 else 0.0
    if inverse <= 0.0 or float(np.max(np.abs(left))) > FREE_MISFIT * depth or not 0.8 < stopped < 1.2:
        return None
    return float(1e3 / inverse)
