"""Picture of the parts by PyVista, as a process of its own: a renderer that crashes harms nothing.

``python -m dummydesign.mold.files.picture meshes.npz picture.png``
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

WIDTH = 1600
GAP_SHARE, LABEL_SHARE = 0.22, 0.55
# Neighbouring triangles of one curved face turn by 11.5 deg at the most.
EDGE_DEG = 14.0
VIEW = (-0.42, -1.0, 0.95)
# From the lowest to the highest.
STACK = ("tray", "mould", "pad", "layer_top", "spacer", "layer_base", "lid", "backer", "strike_off", "carrier")

BOXES = (("master", "face_sheet", "frame"), ("lid_master", "lid_frame"), ("sprue_pin",), ("vent_pin",), ("collar",))
"""Parts next to those in use, one over the other."""


def pack(meshes: dict[str, Any], colours: dict[str, tuple[float, float, float]], title: str, path: Path) -> None:
    """Write what the picture needs into one file: vertices, faces, colour and place of each part shown."""
    arrays: dict[str, Any] = {"title": np.array(title)}
    for name, mesh in meshes.items():
        arrays[f"{name}/vertices"] = np.asarray(mesh.vertices)
        arrays[f"{name}/faces"] = np.asarray(mesh.faces)
        arrays[f"{name}/colour"] = np.array(colours[name])
    np.savez_compressed(path, **arrays)


def stacked(names: list[str]) -> list[str]:
    """Names of the parts in use from the lowest to the highest; ``NAME, something up`` is shown on top of all."""
    known = [name for name in names if name.split(",")[0] in STACK]
    return sorted(known, key=lambda name: ("," in name, STACK.index(name.split(",")[0])))


def turned_over(points: NDArray) -> NDArray:
    """Points turned by half a turn about the x axis, at the same heights; shape (..., 3). [mm]"""
    low, high = points[..., 2].min(), points[..., 2].max()
    return points * (1.0, -1.0, -1.0) + (0.0, 0.0, low + high)


def exploded(bounds: Mapping[str, tuple[float, float]], order: Sequence[str], gap_mm: float) -> dict[str, float]:
    """Heights by which stacked parts are lifted so that each stands clear above the one before it."""
    lifts: dict[str, float] = {}
    level = None
    for name in order:
        low, high = bounds[name]
        lifts[name] = 0.0 if level is None else max(0.0, level + gap_mm - low)
        level = high + lifts[name]
    return lifts


def draw(source: Path, picture: Path) -> None:
    """Draw the packed meshes: the parts in use stacked with gaps, the casting box beside them."""
    import pyvista

    data = np.load(source)
    names = list(dict.fromkeys(key.split("/")[0] for key in data.files if "/" in key))
    meshes = {name: _surface(pyvista, data, name) for name in names}
    stacks = [stacked(names), *([name for name in box if name in names] for box in BOXES[:2])]
    # Stacks stand side by side along the picture's own horizontal, so that their feet are level.
    away, right, up = _view_axes()
    shown: list[tuple[Any, Any]] = []
    labels: list[tuple[Any, str]] = []
    corners: list[Any] = []
    side = 0.0
    size = max(mesh.bounds[1] - mesh.bounds[0] for mesh in meshes.values())
    gap, label_room = GAP_SHARE * size, LABEL_SHARE * size
    for stack in filter(None, stacks):
        bounds = {name: (meshes[name].bounds[4], meshes[name].bounds[5]) for name in stack}
        lifts = exploded(bounds, stack, gap)
        half = max(np.ptp(_corners(meshes[name]) @ right) for name in stack) / 2
        side += half if labels else 0.0
        for name in stack:
            mesh = meshes[name].translate(side * right + np.array((0, 0, lifts[name])), inplace=False)
            shown.append((mesh, data[f"{name}/colour"].tolist()))
            places = _corners(mesh)
            left = places[np.argmin(places @ right + 1e-3 * (places @ up))]
            labels.append((left, name))
            corners += [*places, left - label_room * right]
        side += half + label_room
    window, scale, middle = _frame(np.array(corners), right, up)
    plot: Any = pyvista.Plotter(off_screen=True, window_size=list(window), lighting="none")
    plot.set_background("#ffffff", top="#e8edf2")
    for mesh, colour in shown:
        _add(plot, mesh, colour)
    _light_and_look(plot, pyvista, middle, away, scale)
    for place, name in labels:
        plot.add_point_labels(
            [place], [name.replace("_", " ") + "  "], font_size=22, text_color="#20303c", shape=None,
            show_points=False, always_visible=True, justification_horizontal="right", bold=False,
        )  # fmt: skip
    plot.add_text(str(data["title"]), position=(24, window[1] - 44), font_size=13, color="#20303c")
    plot.screenshot(str(picture))
    plot.close()


def _view_axes() -> tuple[Any, Any, Any]:
    """Unit vectors towards the viewer, to the right and up in the picture."""
    away = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 0.0, 1.0), away)
    right /= np.linalg.norm(right)
    return away, right, np.cross(away, right)


def _corners(mesh: Any) -> Any:
    x0, x1, y0, y1, z0, z1 = mesh.bounds
    return np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])


def _frame(corners: Any, right: Any, up: Any) -> tuple[tuple[int, int], float, Any]:
    """Picture size, parallel scale and focal point that fit the corners with a margin and a line for the title."""
    across, along = corners @ right, corners @ up
    wide, high = 1.06 * np.ptp(across), 1.14 * np.ptp(along)
    height = int(min(max(WIDTH * high / wide, 0.4 * WIDTH), 0.9 * WIDTH))
    scale = max(high, wide * height / WIDTH) / 2
    level = (along.max() + along.min()) / 2 + 0.03 * np.ptp(along)
    return (WIDTH, height), scale, right * (across.max() + across.min()) / 2 + up * level


def _surface(pyvista: Any, data: Any, name: str) -> Any:
    faces = data[f"{name}/faces"]
    cells = np.hstack([np.full((len(faces), 1), 3), faces]).ravel()
    return pyvista.PolyData(data[f"{name}/vertices"], cells)


def _add(plot: Any, mesh: Any, colour: Sequence[float]) -> None:
    """Add one part with its edges drawn, which makes flat faces readable and shows where a shallow crown begins."""
    # Every triangle has its own normal: one shared with a crown would shade the flat beside it as if it were bent.
    plot.add_mesh(mesh, color=colour, smooth_shading=False, ambient=0.25, diffuse=0.75, specular=0.15)
    edges = mesh.extract_feature_edges(feature_angle=EDGE_DEG, boundary_edges=False, manifold_edges=False)
    plot.add_mesh(edges, color="#33424d", line_width=1.2)


def _light_and_look(plot: Any, pyvista: Any, middle: Any, away: Any, scale: float) -> None:
    """Light the scene and set the parallel view."""
    for place, strength in (((-1, -2, 3), 0.75), ((2, -1, 1.5), 0.35), ((0, 1, 2), 0.25)):
        plot.add_light(pyvista.Light(position=place, light_type="scene light", intensity=strength))
    camera = plot.camera
    camera.parallel_projection = True
    camera.focal_point = middle
    camera.position = middle + 3000.0 * away
    camera.up = (0.0, 0.0, 1.0)
    camera.clipping_range = (10.0, 6000.0)
    camera.parallel_scale = scale
    plot.enable_anti_aliasing("ssaa")


def main() -> None:
    """Draw the picture named on the command line."""
    from dummydesign.mold.cad.kernel import load_pyvista

    load_pyvista()
    part = Path(sys.argv[2]).with_suffix(".part.png")
    draw(Path(sys.argv[1]), part)
    part.replace(sys.argv[2])


if __name__ == "__main__":
    main()
