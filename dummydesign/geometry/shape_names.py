"""Names of the shapes, known by their modules without loading them: for help texts, which load nothing heavy."""

from __future__ import annotations

import pkgutil
from pathlib import Path

DEFAULT = "slab"


def shape_names() -> tuple[str, ...]:
    """Names of the package's shapes, the slab first; a module of ``geometry/shapes`` is a shape of its name."""
    found = {item.name for item in pkgutil.iter_modules([str(Path(__file__).with_name("shapes"))])}
    return DEFAULT, *sorted(found - {DEFAULT})


def shape_help(*more: str) -> str:
    """The shapes as help texts list them, with further names at the end.

    Parameters
    ----------
    more : str
        What else the option takes.
    """
    first, *rest = shape_names()
    return ", ".join([f"{first} (default)", *rest, *more])
