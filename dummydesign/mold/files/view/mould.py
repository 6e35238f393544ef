"""The parts of a mould in the view: in use in one stack, each casting box in one beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dummydesign.mold.files.picture import GAP_SHARE, stacked
from dummydesign.mold.files.view.solids import Shown, stack, view_page

BOXES = (("master", "face_sheet", "frame"), ("lid_master", "lid_frame"), ("sprue_pin",), ("vent_pin",), ("collar",))
TEXT = "Drag or use the arrow keys to turn, scroll or pinch to zoom; 'apart' lifts the parts off each other."


def mould_view(meshes: Mapping[str, Any], colours: Mapping[str, tuple[float, float, float]], title: str) -> str:
    """The page with all parts.

    Parameters
    ----------
    meshes : mapping of str to trimesh.Trimesh
        The parts by name, turned over where what matters is below. [mm]
    colours : mapping of str to (float, float, float)
        Red, green and blue of each, from 0 to 1.
    title : str
        Heading of the page.
    """
    used = stacked(list(meshes))
    stacks = [used, *([name for name in box if name in meshes and name not in used] for box in BOXES)]
    rest = [[name] for name in meshes if not any(name in names for names in stacks)]
    found: list[Shown] = []
    edge, size = None, max(float(np.ptp(mesh.bounds, axis=0).max()) for mesh in meshes.values())
    for names in filter(None, [*stacks, *rest]):
        parts = {name: np.asarray(meshes[name].triangles, float) for name in names}
        low = min(float(one[..., 0].min()) for one in parts.values())
        high = max(float(one[..., 0].max()) for one in parts.values())
        beside = 0.0 if edge is None else edge + 0.15 * size - low
        edge = high + beside
        found += stack(parts, GAP_SHARE * size, beside)
    return view_page([Shown(one.name, one.triangles, colours[one.name], one.lift_mm, one.beside_mm) for one in found],
                     title, TEXT)  # fmt: skip
