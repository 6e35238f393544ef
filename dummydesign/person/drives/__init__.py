"""The drives that are known: each module here with a subclass of ``RobotDrive`` is one; nothing else lists them."""

from __future__ import annotations

import importlib
import pkgutil
from typing import Any

from dummydesign.core.errors import unknown_name
from dummydesign.person.drives.drive import RobotDrive

ORDER = ("position", "steady", "force", "mass", "spring")


def _below(kind: type[Any]) -> list[type[Any]]:
    """Subclasses, and theirs: a drive may derive from another."""
    return [one for own in kind.__subclasses__() for one in (own, *_below(own))]


for entry in pkgutil.iter_modules(__path__):
    importlib.import_module(f"{__name__}.{entry.name}")
_rank = dict(zip(ORDER, range(9)))
DRIVES: dict[str, type[RobotDrive]] = {
    one.name: one for one in sorted(_below(RobotDrive), key=lambda one: (_rank.get(one.name, 9), one.name))
}
"""Drives by name."""


def read_drive(text: str) -> RobotDrive:
    """Read a drive as it is typed: ``position``, ``mass:KG``, ``spring:N_PER_MM,KG[,DAMPING_RATIO]``.

    Raises
    ------
    InputError
        For an unknown name, a wrong form, or a number outside its range.
    """
    name, _, numbers = text.strip().partition(":")
    if name not in DRIVES:
        raise unknown_name("drive", name, DRIVES)
    return DRIVES[name].read(numbers)
