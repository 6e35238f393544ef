"""Solids in a page: triangles of STL files, packed small, and the canvas that shows them."""

from __future__ import annotations

import base64
import struct
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.report.html.page import Section, script_json

COLOURS = {"pad": (0.93, 0.71, 0.60), "mould": (0.62, 0.72, 0.80)}
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("spare", "<u2")])


def read_stl(path: str | Path) -> NDArray:
    """Triangles of a binary STL file, shape (n, 3, 3). [mm]

    Raises
    ------
    InputError
        When the file cannot be read or is not a binary STL.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as problem:
        raise InputError(f"{Path(path).name}: cannot be read: {problem.strerror}") from None
    count = struct.unpack("<I", content[80:84])[0] if len(content) >= 84 else -1
    if len(content) != 84 + 50 * count:
        raise InputError(f"{Path(path).name}: is not a binary STL file")
    return np.frombuffer(content, _RECORD, offset=84)["corners"].astype(float)


def box(length_mm: float, width_mm: float, height_mm: float) -> NDArray:
    """Triangles of a box that stands on z = 0, seen from outside; shape (12, 3, 3). [mm]

    Parameters
    ----------
    length_mm, width_mm, height_mm : float
        Along x, y and z. [mm]
    """
    x, y = 0.5 * length_mm, 0.5 * width_mm
    corner = np.array([(a * x, b * y, c * height_mm) for c in (0, 1) for b in (-1, 1) for a in (-1, 1)])
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return np.array([corner[[a, b, c]] for s in sides for a, b, c in ((s[0], s[1], s[2]), (s[0], s[2], s[3]))])


def pack(triangles: NDArray, colour: tuple[float, float, float], lift_mm: float) -> dict[str, Any]:
    """One part for the page: corners in 65535 steps of its box, colour, and how far it is lifted when apart.

    Parameters
    ----------
    triangles : ndarray, shape (n, 3, 3)
        Corners of the triangles, counter-clockwise from outside. [mm]
    colour : (float, float, float)
        Red, green and blue, from 0 to 1.
    lift_mm : float
        By how much the part is lifted when the parts are shown apart. [mm]

    Returns
    -------
    dict
        Plain values for JSON.
    """
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    steps = np.round((triangles - low) / np.maximum(high - low, 1e-9) * 65535).astype("<u2")
    coded = base64.b64encode(steps.tobytes()).decode("ascii")
    return {"triangles": coded, "low": low.tolist(), "high": high.tolist(), "colour": colour, "lift": lift_mm}


def solid_section(parts: Mapping[str, NDArray], text: str) -> Section:
    """A section with a view of parts that can be turned.

    Parameters
    ----------
    parts : mapping of name to ndarray (n, 3, 3)
        From the lowest to the highest when drawn apart.
    text : str
    """
    packed, level = [], 0.0
    below = None
    for name, triangles in parts.items():
        low, high = triangles[..., 2].min(), triangles[..., 2].max()
        level = 0.0 if below is None else max(0.0, below + 25.0 - low)
        below = high + level
        packed.append(pack(triangles, COLOURS.get(name, (0.7, 0.7, 0.72)), level))
    names = " and ".join(parts)
    html = (
        '<div class="viewer"><canvas id="view-canvas" tabindex="0" role="img" '
        f'aria-label="{escape(names)} as solids; drag or use the arrow keys to turn, scroll to zoom"></canvas>'
        '<div class="controls noprint"><label>apart <input type="range" id="view-apart" min="0" max="1" step="0.01" '
        f'value="{1 if len(packed) > 1 else 0}"></label></div><p id="view-note"></p></div>'
        f'<script type="application/json" id="view-data">{script_json(packed)}</script>'
    )
    return Section("Pad and mould", text, html=html)


def viewer_script() -> str:
    """The script that draws the view."""
    return (Path(__file__).parent / "viewer.js").read_text(encoding="utf-8")
