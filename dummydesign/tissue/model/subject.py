"""One person of a tissue: a name and every parameter with interval, kind and source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from dummydesign.core.quantity import Quantity
from dummydesign.core.serialise import to_plain
from dummydesign.tissue.model.maxwell_law import Parameters

KIND = "materials/tissues"
"""Folder of tissues, in the package and in a user's."""

PRESSED = ("steady_force_N", "depth_mm", "peak_force_N")
"""What is kept of the presses of a subject, the lowest and the highest."""
FITTED = "fitted_over_measured_peak"
"""The law's peaks over those of the presses, where they are known."""


@dataclass(frozen=True)
class Subject:
    """One person (or posterior quantile): a name and every parameter with interval, kind and source.

    ``numbers`` maps outward names to a Quantity; dampers to {speed: Quantity}. ``pressed`` has the median, lowest and
    highest steady force, depth and peak force of the presses that were fitted, and what the law makes of their peaks;
    it is empty where they are not known.
    """

    name: str
    parameters: Parameters
    numbers: dict[str, Any]
    pressed: Mapping[str, Quantity] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, law: str, numbers: dict[str, Any], pressed: Mapping[str, Quantity] | None = None) -> Subject:
        """Make a subject of a law from its numbers.

        Parameters
        ----------
        name : str
            Of the person.
        law : str
            Name of the law.
        numbers : dict
            Quantity by outward name; dampers {speed: Quantity}.
        pressed : mapping, optional
            Quantity by each of :data:`PRESSED`, and by :data:`FITTED`.
        """
        return cls(name, subject_parameters(law, numbers), numbers, pressed or {})

    def to_dict(self) -> dict[str, Any]:
        """Return the name and the numbers with their sources."""
        pressed = {"pressed": to_plain(self.pressed)} if self.pressed else {}
        return {"name": self.name, **to_plain(self.numbers), **pressed}


def flatten(numbers: Mapping[str, Any]) -> dict[tuple[str, str], Any]:
    """Return numbers by (name, speed); springs have no speed."""
    return {
        (name, speed): number
        for name, entry in numbers.items()
        for speed, number in (entry.items() if isinstance(entry, dict) else [("", entry)])
    }


def subject_parameters(law: str, numbers: Mapping[str, Any], end: str = "value") -> Parameters:
    """Make parameters of a subject's or a band's numbers.

    Parameters
    ----------
    law : str
        Name of the law.
    numbers : mapping
        Quantity by outward name; dampers {speed: Quantity}.
    end : str
        ``value``, ``low`` or ``high``.
    """
    return Parameters.from_dict(law, nest({key: getattr(one, end) for key, one in flatten(numbers).items()}))


def nest(flat: Mapping[tuple[str, str], Any]) -> dict[str, Any]:
    """Return numbers by name, dampers as {speed: number}."""
    numbers: dict[str, Any] = {}
    for (name, speed), number in flat.items():
        if speed:
            numbers.setdefault(name, {})[speed] = number
        else:
            numbers[name] = number
    return numbers
