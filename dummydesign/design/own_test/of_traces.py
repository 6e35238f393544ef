"""One's own test as traces are compared in it: read, checked, and what must be said of the tissue in it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.checks import DECELERATION, EDGE, FORCE, HOLD, VELOCITY, positive, read_number, read_numbers
from dummydesign.design.own_test.checks import check_edge, check_numbers, tissue_warnings
from dummydesign.design.own_test.punch import read_punch
from dummydesign.design.request import face_of
from dummydesign.geometry.interface import CONDITIONS, Interface
from dummydesign.geometry.standard import PUNCH
from dummydesign.tissue.comparison.press_test import PressTest

if TYPE_CHECKING:
    from dummydesign.tissue.model.tissue import Tissue

Numbers = float | str | Iterable[float | str]


@dataclass(frozen=True)
class TracesTest:
    """A test with its punch.

    Attributes
    ----------
    punch : str
        As typed.
    edge_radius_mm : float
    condition : str
        How it held the face: said beside the answer, which is of the traces as they are.
    presses : PressTest
        Forces, speeds, hold and braking, None where they are those of each press.
    """

    punch: str
    edge_radius_mm: float
    condition: str
    presses: PressTest

    def to_dict(self) -> dict[str, Any]:
        """Return all as plain values, None for what is taken from each press."""
        test = self.presses
        return {
            "punch": self.punch, "edge_radius_mm": self.edge_radius_mm, "condition": self.condition,
            "force_N": _listed(test.forces_N),
            "velocity_mm_s": _listed(test.velocities_mm_s), "hold_s": test.hold_s,
            "deceleration_mm_s2": test.deceleration_mm_s2,
        }  # fmt: skip

    @property
    def given(self) -> dict[str, Any]:
        """What differs from the presses as they were made with the 14 x 14 mm punch; empty for nothing."""
        own = self.punch != PUNCH or self.edge_radius_mm or self.condition != "bonded"
        return {
            name: value
            for name, value in self.to_dict().items()
            if value is not None and (own or name not in ("punch", "edge_radius_mm", "condition"))
        }

    def warnings(self, tissue: Tissue) -> list[dict[str, str]]:
        """What must be said of the tissue in this test."""
        said = tissue_warnings(tissue, self.punch, self.edge_radius_mm, self.presses.forces_N or ())
        return [{"code": code, "message": text} for code, text in said]


def _listed(values: tuple[float, ...] | None) -> list[float] | None:
    return None if values is None else list(values)


def read_test(
    punch: str = PUNCH,
    edge_radius_mm: float | str = 0.0,
    force_N: Numbers | None = None,
    velocity_mm_s: Numbers | None = None,
    hold_s: float | str | None = None,
    deceleration_mm_s2: float | str | None = None,
    condition: str | None = None,
) -> TracesTest:
    """Read a test; numbers may carry their unit.

    Parameters
    ----------
    punch : str
        ``square:14``, ``rectangle:20x10``, ``round:16``, ``ball:20`` or ``profile:FILE.csv``, sizes in mm.
    edge_radius_mm : float or str
        Fillet of its edge. [mm]
    force_N, velocity_mm_s : numbers or text, optional
        Steady forces and speeds, such as ``"2,4"``. [N, mm/s]
    hold_s, deceleration_mm_s2 : float or str, optional
        [s, mm/s2]
    condition : str, optional
        ``bonded``, ``frictionless`` or ``friction:MU``; as of a design's request by default.

    Raises
    ------
    InputError
        For numbers that no test has.
    """
    asked, face = read_punch(punch), face_of(punch, condition)
    Interface.parse(face, "condition", CONDITIONS)
    edge = read_number(edge_radius_mm, EDGE)
    forces = None if force_N is None else tuple(sorted(set(read_numbers(force_N, FORCE))))
    speeds = None if velocity_mm_s is None else tuple(sorted(set(read_numbers(velocity_mm_s, VELOCITY))))
    hold = None if hold_s is None else read_number(hold_s, HOLD)
    braking = None if deceleration_mm_s2 is None else read_number(deceleration_mm_s2, DECELERATION)
    check_numbers(forces, speeds, hold)
    if braking is not None:
        positive(DECELERATION.quantity, braking)
    if edge:
        check_edge(edge, asked)
    return TracesTest(punch, edge, face, PressTest(forces, speeds, hold, braking))
