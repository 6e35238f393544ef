"""The drives that are known: each module here with a subclass of ``Drive`` is one; nothing else lists them."""

from __future__ import annotations

import importlib
import pkgutil

from dummydesign.core.errors import unknown_name
from dummydesign.person.drives.drive import Drive

ORDER = ("position", "steady", "force", "mass", "spring")


def _find() -> dict[str, type[Drive]]:
    drives: dict[str, type[Drive]] = {}
    for entry in pkgutil.iter_modules(__path__):
        module = importlib.import_module(f"{__name__}.{entry.name}")
        own = (value for value in vars(module).values() if isinstance(value, type) and issubclass(value, Drive))
        drives |= {value.name: value for value in own if value.__module__ == module.__name__ and value is not Drive}
    return dict(sorted(drives.items(), key=lambda item: (ORDER.index(item[0]) if item[0] in ORDER else 9, item[0])))


DRIVES: dict[str, type[Drive]] = _find()
"""Drives by name."""


def read_drive(text: str) -> Drive:
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
