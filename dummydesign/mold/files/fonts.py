"""The font of papers and pictures: DejaVu Sans, which knows more than Western letters and comes with matplotlib."""

from __future__ import annotations

import importlib.util
from pathlib import Path


def font_file(name: str) -> Path | None:
    """File of a font, found without loading matplotlib, or None where it is not installed."""
    spec = importlib.util.find_spec("matplotlib")
    places = spec.submodule_search_locations if spec is not None else None
    file = Path(next(iter(places), "")) / f"mpl-data/fonts/ttf/{name}.ttf" if places else Path()
    return file if file.is_file() else None
