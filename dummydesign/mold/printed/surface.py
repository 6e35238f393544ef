"""How smooth a printed mould must be finished, and the draft that its roughness asks for; no CAD."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.quantity import read_quantity
from dummydesign.mold.shop.tables import known_keys, named_source

KEYS = ("depth_mm", "least_draft_deg", "draft_deg_per_mm")


@dataclass(frozen=True)
class Surface:
    """Depth of what is left of the layers' valleys, and the draft: ``least_draft_deg`` and so much more per depth."""

    depth_mm: float
    least_draft_deg: float
    draft_deg_per_mm: float

    @property
    def draft_needed_deg(self) -> float:
        """Draft with which a rigid wall lets go of a part that has filled its valleys. [deg]"""
        return self.least_draft_deg + self.draft_deg_per_mm * self.depth_mm


def read_surface(table: Any, path: Path, text: str) -> tuple[Surface, list[str]]:
    """Read the table ``surface`` of a preset; return it and where its numbers come from.

    Parameters
    ----------
    table : dict
        As read.
    path, text : Path, str
        The file and its text, for messages.

    Returns
    -------
    Surface, list of str

    Raises
    ------
    InputError
        For a table that is not one, unknown or missing keys.
    """
    if not isinstance(table, dict):
        raise InputError(f"{path.name}: 'surface' must be a table")
    known_keys(table, set(KEYS), path, text)
    found = {key: read_quantity(table, key, path, text) for key in KEYS}
    sources = [named_source(f"surface {key}", quantity) for key, quantity in found.items()]
    return Surface(**{key: quantity.value for key, quantity in found.items()}), sources


def check_surface(surface: Surface | None, draft_deg: float) -> None:
    """Refuse a printed mould that would not let go.

    Raises
    ------
    InputError
        With the draft that is needed, or the depth that the draft allows.
    """
    if surface is None:
        raise InputError("a printed mould needs the table [surface] in its preset: depth_mm and the draft it asks for")
    for name, low, high in (("depth_mm", 0.001, 0.2), ("least_draft_deg", 0.0, 5.0), ("draft_deg_per_mm", 0.0, 200.0)):
        if not low <= (value := getattr(surface, name)) <= high:
            raise out_of_range(f"surface {name}", f"{value:g}", f"{low:g}", f"{high:g}")
    if draft_deg < surface.draft_needed_deg:
        deep = max(0.0, (draft_deg - surface.least_draft_deg) / surface.draft_deg_per_mm)
        raise InputError(
            f"draft_deg = {draft_deg:g} of a printed mould: valleys of {surface.depth_mm:g} mm need at least "
            f"{surface.draft_needed_deg:.2f} deg; give more draft, or finish it to {deep:.3f} mm (surface depth_mm)"
        )
