"""The contract of a drive: what moves the robot that pressed the pad, and so how it presses a person."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import Purpose, read_number
from dummydesign.measurement.motion import work_mJ
from dummydesign.person.integrate import held_after
from dummydesign.person.press import LATE, Press
from dummydesign.person.smoothing import interpolation

if TYPE_CHECKING:
    from dummydesign.person.integrate import Trajectory
    from dummydesign.person.people import People
    from dummydesign.person.ringing import Arm
    from dummydesign.person.signs import TraceSigns

FOUR = ("peak_N", "steady_N", "depth_mm", "energy_mJ")
"""What is reported of a press."""
FASTER = 20.0
"""Factor of the tolerance where only the four numbers of many draws are wanted."""
LATE_POINTS = 25
DAMPING = Purpose("damping ratio", "", (0.0, 1.0))
MASS = Purpose("mass in kg", "kg", (0.05, 500.0))
STIFFNESS = Purpose("stiffness in N/mm", "N/mm", (0.1, 10_000.0))
MASSES, STIFFNESSES = (1e-3, 1e4), (1e-3, 1e6)
"""Masses and stiffnesses that are allowed with their unit. [kg, N/mm]"""
DAMPINGS = (0.0, 2.0)
"""Damping ratios of an arm that are allowed."""


@dataclass(frozen=True)
class Response:
    """What persons bear: curves of shape (p, n) over ``time_s`` (n,) or (p, n), and numbers, shape (p,).

    ``held_N`` is the largest force later than 0.5 s after contact.
    """

    time_s: NDArray
    depth_curve_mm: NDArray
    force_curve_N: NDArray
    peak_N: NDArray
    steady_N: NDArray
    depth_mm: NDArray
    energy_mJ: NDArray

    held_N: NDArray

    def four(self) -> dict[str, NDArray]:
        """The four numbers by name."""
        return {name: getattr(self, name) for name in FOUR}


class Drive(ABC):
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
    numbers: ClassVar[tuple[tuple[Purpose, tuple[float, float]], ...]] = ()
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
    def read(cls, text: str) -> Drive:
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
    def arm(self) -> Arm | None:
        """The arm that may ring in the trace; None where the drive has none."""
        return None

    def check(self, press: Press) -> None:
        """Refuse a press that the drive cannot carry over to people; by itself none."""
        return None

    @abstractmethod
    def respond(self, press: Press, people: People, keep: bool = True) -> Response:
        """Press people as the robot pressed the pad.

        Parameters
        ----------
        press : Press
            Curves of shape (n,), or (p, n) with one for each person.
        people : People
        keep : bool
            Whether the curves are wanted, and not the four numbers alone.
        """

    def on_curves(self, press: Press, people: Sequence[Any]) -> Response:
        """Press persons who are measured curves; refused unless ``curves``."""
        raise InputError(
            f"drive = {self.name} needs the force under any motion, and the tissue is measured curves without a law; "
            "use --drive steady, or a tissue with a law",
            "unsupported", "drive", self.name,
        )  # fmt: skip

    def contradicted(self, signs: TraceSigns) -> str:
        """Say why this drive cannot have made the trace; empty where nothing speaks against it."""
        return ""

    def on_pad(self, press: Press) -> dict[str, NDArray | None]:
        """The four numbers of the pad, over the same part of the press as those of people."""
        return {"peak_N": press.peak_N, "steady_N": press.steady_N, "depth_mm": press.depth_mm,
                "energy_mJ": press.energy_mJ}  # fmt: skip


def not_kept(signs: TraceSigns) -> str:
    """Say that the path was not kept, for drives that keep it; empty where it was."""
    if signs.looks_like == "force":
        return f"the depth crept by {signs.creep_mm:.2g} mm while the force was kept"
    if signs.looks_like == "mass":
        return f"the pad alone stopped a mass of {signs.mass_kg:.3g} kg"
    return ""


def late_from(press: Press) -> float:
    """Time from which on the mean of the force is the steady force; infinite without a hold. [s]"""
    return float(press.time_s[-1]) - LATE * press.hold_s if press.steady_N is not None else np.inf


def of_trajectory(run: Trajectory) -> Response:
    """Make the answer of an integrated motion."""
    return Response(run.time_s, run.depth_mm, run.force_N, run.peak_N, run.late_N, run.deepest_mm, run.energy_mJ,
                    run.held_N)  # fmt: skip


def of_curves(press: Press, time_s: NDArray, depth: NDArray, force: NDArray) -> Response:
    """Make the answer of curves of shape (p, n) over common times (n,)."""
    depth, start = np.broadcast_to(depth, force.shape), late_from(press)
    energy = work_mJ(np.maximum(depth, 0.0), force)
    held = np.full(len(force), np.nan)
    if np.isfinite(start):
        held = force @ interpolation(np.linspace(start, float(time_s[-1]), LATE_POINTS), time_s).mean(axis=0)
    longer = held_after(time_s, force)
    return Response(time_s, depth, force, force.max(axis=-1), held, depth.max(axis=-1), energy, longer)
