"""The contract of a drive: what moves the robot that pressed the pad, and so how it presses a person."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.parsing import QuantitySpec, read_number
from dummydesign.person.integrate import FOUR, PersonResponse
from dummydesign.person.press import Press

if TYPE_CHECKING:
    from dummydesign.person.drive_diagnostics import TraceSigns
    from dummydesign.person.people import People
    from dummydesign.person.ringing import RobotArm

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
