"""Picture of the parts by PyVista, as a process of its own: a renderer that crashes harms nothing.

``python -m dummydesign.mold.files.picture meshes.npz picture.png``
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from dummydesign.mold.light_imports import load_pyvista

WIDTH = 1600
GAP_SHARE, LABEL_SHARE = 0.22, 0.55
# Neighbouring triangles of one curved face turn by 11.5 deg at the most.
EDGE_DEG = 14.0
VIEW = (-0.42, -1.0, 0.95)
# From the lowest to the highest.
STACK = ("tray", "mould", "pad", "layer_top", "spacer", "layer_base", "lid", "backer", "strike_off", "carrier")


def pack(meshes: dict[str, Any], colours: dict[str, tuple[float, float, float]], title: str, path: Path) -> None:
    """Write what the picture needs into one file: vertices, faces, colour and place of each part shown.

    Parameters
    ----------
    meshes : dict of str to trimesh.Trimesh
        The parts by name. [mm]
    colours : dict of str to (float, float, float)
        Red, green and blue of each, from 0 to 1.
    title : str
        Line over the picture.
    path : Path
        The ``.npz`` file that is written.
    """
    import numpy as np

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


def turned(mesh: Any) -> Any:
    """Return a copy turned upside down about the middle of its height."""
    import numpy as np

    low, high = mesh.bounds[0][2], mesh.bounds[1][2]
    copy = mesh.copy()
    copy.vertices = np.asarray(mesh.vertices) * (1.0, -1.0, -1.0) + (0.0, 0.0, low + high)
    return copy


def exploded(bounds: dict[str, tuple[float, float]], order: list[str], gap_mm: float) -> dict[str, float]:
    """Heights by which stacked parts are lifted so that each stands clear above the one before it.

    Parameters
    ----------
    bounds : dict
        Lowest and highest z of each part. [mm]
    order : list of str
        From the lowest to the highest.
    gap_mm : float
        Clear height between two parts. [mm]
    """
    lifts, level = {}, None
    for name in order:
        low, high = bounds[name]
        lifts[name] = 0.0 if level is None else max(0.0, level + gap_mm - low)
        level = high + lifts[name]
    return lifts


def draw(source: Path, picture: Path) -> None:
    """Draw the packed meshes: the parts in use stacked with gaps, the casting box beside them."""
    import numpy as np
    import pyvista

    data = np.load(source)
    names = list(dict.fromkeys(key.split("/")[0] for key in data.files if "/" in key))
    meshes = {name: _surface(pyvista, np, data, name) for name in names}
    stacks = [
        stacked(names),
        [name for name in ("master", "face_sheet", "frame") if name in names],
        [name for name in ("lid_master", "lid_frame") if name in names],
    ]
    # Stacks stand side by side along the picture's own horizontal, so that their feet are level.
    away, right, up = _view_axes(np)
    shown, labels, corners, side = [], [], [], 0.0
    size = max(mesh.bounds[1] - mesh.bounds[0] for mesh in meshes.values())
    gap, label_room = GAP_SHARE * size, LABEL_SHARE * size
    for stack in filter(None, stacks):
        bounds = {name: (meshes[name].bounds[4], meshes[name].bounds[5]) for name in stack}
        lifts = exploded(bounds, stack, gap)
        half = max(np.ptp(_corners(np, meshes[name]) @ right) for name in stack) / 2
        side += half if labels else 0.0
        for name in stack:
            mesh = meshes[name].translate(side * right + np.array((0, 0, lifts[name])), inplace=False)
            shown.append((mesh, tuple(float(c) for c in data[f"{name}/colour"])))
            places = _corners(np, mesh)
            left = places[np.argmin(places @ right + 1e-3 * (places @ up))]
            labels.append((left, name))
            corners += [*places, left - label_room * right]
        side += half + label_room
    window, scale, middle = _frame(np, np.array(corners), right, up)
    plot = pyvista.Plotter(off_screen=True, window_size=window, lighting="none")
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


def _view_axes(np: Any) -> tuple[Any, Any, Any]:
    """Unit vectors towards the viewer, to the right and up in the picture."""
    away = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 0.0, 1.0), away)
    right /= np.linalg.norm(right)
    return away, right, np.cross(away, right)


def _corners(np: Any, mesh: Any) -> Any:
    x0, x1, y0, y1, z0, z1 = mesh.bounds
    return np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])


def _frame(np: Any, corners: Any, right: Any, up: Any) -> tuple[tuple[int, int], float, Any]:
    """Picture size, parallel scale and focal point that fit the corners with a margin and a line for the title."""
    across, along = corners @ right, corners @ up
    wide, high = 1.06 * np.ptp(across), 1.14 * np.ptp(along)
    height = int(min(max(WIDTH * high / wide, 0.4 * WIDTH), 0.9 * WIDTH))
    scale = max(high, wide * height / WIDTH) / 2
    level = (along.max() + along.min()) / 2 + 0.03 * np.ptp(along)
    return (WIDTH, height), scale, right * (across.max() + across.min()) / 2 + up * level


def _surface(pyvista: Any, np: Any, data: Any, name: str) -> Any:
    faces = data[f"{name}/faces"]
    cells = np.hstack([np.full((len(faces), 1), 3), faces]).ravel()
    return pyvista.PolyData(data[f"{name}/vertices"], cells)


def _add(plot: Any, mesh: Any, colour: tuple[float, float, float]) -> None:
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
    load_pyvista()
    part = Path(sys.argv[2]).with_suffix(".part.png")
    draw(Path(sys.argv[1]), part)
    part.replace(sys.argv[2])


if __name__ == "__main__":
    main()
