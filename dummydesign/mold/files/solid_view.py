"""Solids to turn in a page: triangles packed small, the canvas, and the parts of a mould."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.mold.files.picture import GAP_SHARE, exploded, stacks_of

if TYPE_CHECKING:
    from dummydesign.geometry.pad_shape import PadShape

COLOURS = {"pad": (0.93, 0.71, 0.60), "layer top": (0.93, 0.71, 0.60), "mould": (0.62, 0.72, 0.80)}
STEPS = 65535


def read_view(page: Path) -> dict[str, NDArray]:
    """Triangles of pad, layers and mould in a page of :func:`mould_view`, shape (n, 3, 3); none where there are none.

    [mm]
    """
    try:
        found = re.search(r'id="view-data">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
        parts = json.loads(found[1]) if found else []
        return {one["name"]: _unpacked(one) for one in parts if one["name"].startswith(("pad", "layer", "mould"))}
    except (OSError, ValueError, KeyError, TypeError):
        return {}


def _unpacked(part: dict[str, Any]) -> NDArray:
    low, high = np.array(part["low"], float), np.array(part["high"], float)
    steps = np.frombuffer(base64.b64decode(part["triangles"]), "<u2").reshape(-1, 3, 3)
    return low + steps / STEPS * (high - low)


def box(length_mm: float, width_mm: float, height_mm: float) -> NDArray:
    """Triangles of a box that stands on z = 0, seen from outside; shape (12, 3, 3). [mm]"""
    x, y = 0.5 * length_mm, 0.5 * width_mm
    corner = np.array([(a * x, b * y, c * height_mm) for c in (0, 1) for b in (-1, 1) for a in (-1, 1)])
    sides = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
    return corner[sides[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)]


@dataclass(frozen=True, eq=False)
class Shown:
    """One part in the view: how far it is lifted when the parts are apart, and where its stack stands. [mm]

    A name such as ``pad, tested face up`` says that it is shown turned over.
    """

    name: str
    triangles: NDArray
    colour: tuple[float, float, float]
    lift_mm: float = 0.0
    shift_mm: float = 0.0


def pack(triangles: NDArray, colour: tuple[float, float, float], lift_mm: float) -> dict[str, Any]:
    """One part for the page: corners in 65535 steps of its box, colour, and how far it is lifted when apart."""
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    steps = np.round((triangles - low) / np.maximum(high - low, 1e-9) * STEPS).astype("<u2")
    coded = base64.b64encode(steps.tobytes()).decode("ascii")
    return {"triangles": coded, "low": low.tolist(), "high": high.tolist(), "colour": colour, "lift": lift_mm}


def stack(parts: Mapping[str, NDArray], gap_mm: float = 25.0, shift_mm: float = 0.0) -> list[Shown]:
    """Parts one over the other, each lifted clear of the one below it when they are drawn apart."""
    heights = {name: (float(one[..., 2].min()), float(one[..., 2].max())) for name, one in parts.items()}
    lifts = exploded(heights, list(parts), gap_mm)
    return [
        Shown(name, one, COLOURS.get(name.split(",")[0], (0.7, 0.7, 0.72)), lifts[name], shift_mm)
        for name, one in parts.items()
    ]


def view_html(parts: Sequence[Shown]) -> str:
    """Canvas, controls and packed parts; :func:`view_script` draws them."""
    packed = [
        {
            **pack(one.triangles, one.colour, one.lift_mm),
            "name": one.name.replace("_", " "),
            "beside": one.shift_mm,
            "turned": ", " in one.name,
        }
        for one in parts
    ]
    names = " and ".join(one["name"] for one in packed)
    plain = json.dumps(packed, separators=(",", ":")).replace("<", "\\u003c")
    return (
        f"<style>{(_HERE / 'viewer.css').read_text(encoding='utf-8')}</style>"
        '<div class="viewer"><div class="stage"><canvas id="view-canvas" tabindex="0" role="img" '
        f'aria-label="{escape(names)} as solids; drag or use the arrow keys to turn, scroll or pinch to zoom"></canvas>'
        '<svg id="view-lines" aria-hidden="true"></svg><div id="view-labels" aria-hidden="true"></div></div>'
        '<div class="controls noprint"><label class="apart">apart <input type="range" id="view-apart" min="0" max="1" '
        f'step="0.01" value="{1 if len(packed) > 1 else 0}"></label><span id="view-parts"></span></div>'
        '<p id="view-note"></p></div>'
        f'<script type="application/json" id="view-data">{plain}</script>'
    )


def view_script() -> str:
    """The script that draws the view."""
    return (_HERE / "viewer.js").read_text(encoding="utf-8")


def view_page(parts: Sequence[Shown], title: str, text: str) -> str:
    """A page of its own with the view; opens without a network, dark or light as the reader's system."""
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{escape(title)}</title><style>{_PAGE}</style></head><body><h1>{escape(title)}</h1><p>{escape(text)}</p>"
        f"{view_html(parts)}<script>{view_script()}</script></body></html>\n"
    )


def pad_solids(shape: PadShape, thickness_mm: float) -> dict[str, NDArray]:
    """Triangles of a pad, seen from outside, shape (n, 3, 3): layers, or a bone and the pad cut through its middle."""
    half = 0.5 * np.array([PAD_LENGTH_MM, PAD_WIDTH_MM])
    fine = np.r_[np.linspace(-32.0, 32.0, 33), np.linspace(-16.0, 16.0, 65)]
    x, y = (np.unique(np.r_[-h, fine[np.abs(fine) < h], h]) for h in half)

    def top(across: NDArray, along: NDArray) -> NDArray:
        return thickness_mm - np.asarray(shape.drop_mm(across, along), float)

    if (layers := shape.layers()) is not None:
        between = thickness_mm - layers[0]
        ends = x[[0, -1]], y[[0, -1]]
        return {"lower layer": _body(*ends, 0.0, between), "upper layer": _body(*ends, between, top)}
    if float(np.max(shape.bone_mm(np.zeros(1), np.zeros(1)))) > 0.0:
        bone = _body(x, y, 0.0, shape.bone_mm)
        bone = bone[bone[:, :, 2].max(axis=1) > 0.0]
        return {"rigid bone": bone, "pad": _body(x, y[y >= 0.0], shape.bone_mm, top)}
    return {"pad": _body(x, y, 0.0, top)}


def _body(x: NDArray, y: NDArray, low: Any, high: Any) -> NDArray:
    """What lies between two height fields, closed; shape (n, 3, 3)."""
    across, along = np.meshgrid(x, y, indexing="ij")
    over, under = (
        np.stack([across, along, np.broadcast_to(one(across, along) if callable(one) else one, across.shape)], axis=-1)
        for one in (high, low)
    )
    sides = (np.s_[::-1, 0], np.s_[:, -1], np.s_[0], np.s_[-1, ::-1])
    walls = (_faces(np.stack([under[side], over[side]])) for side in sides)
    faces = np.concatenate([_faces(over), _faces(under)[:, ::-1], *walls])
    return faces[np.ptp(faces[:, :, 2], axis=1) + np.ptp(faces[:, :, 1], axis=1) > 0.0]


def _faces(nodes: NDArray) -> NDArray:
    """Triangles over a grid of points, seen from above; shape (n, 3, 3)."""
    a, b, c, d = nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]
    return np.concatenate([np.stack([a, b, c], -2).reshape(-1, 3, 3), np.stack([a, c, d], -2).reshape(-1, 3, 3)])


def pad_view(shape: PadShape, thickness_mm: float) -> str:
    """A page of its own with a pad as a solid."""
    text = "Drag or use the arrow keys to turn, scroll or pinch to zoom."
    return view_page(stack(pad_solids(shape, thickness_mm)), "The pad", text)


_HERE = Path(__file__).parent
_PAGE = (
    ":root{--panel:#eef2f5;--ink:#20303c;--page:#fff}"
    "@media(prefers-color-scheme:dark){:root{--panel:#1b242b;--ink:#dfe7ec;--page:#12181d}}"
    "body{font:15px/1.4 system-ui,sans-serif;margin:0;padding:.6rem 1rem;background:var(--page);color:var(--ink)}"
    "h1{font-size:1.1rem;margin:.2rem 0}p{margin:.2rem 0}"
    "body>.viewer .stage canvas{height:calc(100vh - 9.5rem);min-height:320px}"
)


TEXT = "Drag or use the arrow keys to turn, scroll or pinch to zoom; 'apart' lifts the parts off each other."


def mould_view(meshes: Mapping[str, Any], colours: Mapping[str, tuple[float, float, float]], title: str) -> str:
    """The page with all parts."""
    stacks = stacks_of(list(meshes))
    rest = [[name] for name in meshes if not any(name in names for names in stacks)]
    shown: list[Shown] = []
    edge, size = None, max(float(np.ptp(mesh.bounds, axis=0).max()) for mesh in meshes.values())
    for names in filter(None, [*stacks, *rest]):
        parts = {name: np.asarray(meshes[name].triangles, float) for name in names}
        low = min(float(one[..., 0].min()) for one in parts.values())
        high = max(float(one[..., 0].max()) for one in parts.values())
        shift = 0.0 if edge is None else edge + 0.15 * size - low
        edge = high + shift
        shown += stack(parts, GAP_SHARE * size, shift)
    return view_page([replace(one, colour=colours[one.name]) for one in shown], title, TEXT)
