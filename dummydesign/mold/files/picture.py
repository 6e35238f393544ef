"""Picture of the parts, as a process of its own beside the checks; the mould is as good without one.

Solids are drawn in a parallel view by VTK without a window, letters by Pillow; where VTK (with PyVista) is missing, or
finds nothing to draw with, there is no picture. PyVista itself would load matplotlib and draw every pixel four times.

``python -m dummydesign.mold.files.picture meshes.pickle picture.png``
"""

from __future__ import annotations

import importlib.util
import pickle
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

WIDTH = 1600
GAP_SHARE, LABEL_SHARE = 0.22, 0.55
VIEW = (-0.42, -1.0, 0.95)
# From the lowest to the highest.
STACK = ("tray", "mould", "pad", "layer_top", "spacer", "layer_base", "lid", "backer", "strike_off", "carrier")

BOXES = (("master", "face_sheet", "frame"), ("lid_master", "lid_frame"), ("sprue_pin",), ("vent_pin",), ("collar",))
"""Parts next to those in use, one over the other."""


def pack(meshes: dict[str, Any], colours: dict[str, tuple[float, float, float]], title: str, path: Path) -> None:
    """Write what the picture needs into one file: vertices, faces and colour of each part shown, and the title."""
    parts = {
        name: (np.asarray(mesh.vertices, float), np.asarray(mesh.faces), colours[name]) for name, mesh in meshes.items()
    }
    path.write_bytes(pickle.dumps((parts, title)))


def stacked(names: list[str]) -> list[str]:
    """Names of the parts in use from the lowest to the highest; ``NAME, something up`` is shown on top of all."""
    known = [name for name in names if name.split(",")[0] in STACK]
    return sorted(known, key=lambda name: ("," in name, STACK.index(name.split(",")[0])))


def stacks_of(names: list[str]) -> list[list[str]]:
    """Names of the parts in use, and of those next to them, one over the other."""
    return [stacked(names), *([name for name in box if name in names] for box in BOXES)]


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


AMBIENT, DIFFUSE = 0.25, 0.75
LIGHTS = (((-1, -2, 3), 0.75), ((2, -1, 1.5), 0.35), ((0, 1, 2), 0.25))
"""Where each light comes from, and its strength."""
# Neighbouring triangles of one curved face turn by 11.5 deg at the most.
EDGE_DEG = 14.0
BOTTOM, TOP, INK = "#ffffff", "#e8edf2", "#33424d"
LETTERS, LABEL_PX, TITLE_PX = (32, 48, 60), 22, 25


@dataclass(frozen=True, eq=False)
class Scene:
    """Parts as they stand in the picture (vertices, faces, colour), their labels, and a parallel view of them.

    ``axes`` point to the viewer, to the right and up; ``scale`` is half the height of the view. [mm]
    """

    parts: Sequence[tuple[NDArray, NDArray, Sequence[float]]]
    labels: Sequence[tuple[NDArray, str]]
    title: str
    window: tuple[int, int]
    axes: tuple[NDArray, NDArray, NDArray]
    middle: NDArray
    scale: float


def render(scene: Scene, path: Path, lights: Sequence[tuple[Sequence[float], float]] = LIGHTS) -> None:
    """Draw a scene and write a PNG.

    Edges are drawn, which makes flat faces readable and shows where a shallow crown begins.
    """
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  makes the classes below draw
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkFiltersCore import vtkFeatureEdges
    from vtkmodules.vtkRenderingCore import (
        vtkActor,
        vtkLight,
        vtkPolyDataMapper,
        vtkRenderer,
        vtkRenderWindow,
        vtkWindowToImageFilter,
    )

    def shown(mesh: Any, colour: Sequence[float]) -> Any:
        mapper, actor = vtkPolyDataMapper(), vtkActor()
        mapper.SetInputData(mesh)
        mapper.ScalarVisibilityOff()
        actor.SetMapper(mapper)
        actor.GetProperty().SetColor(*colour)
        stage.AddActor(actor)
        return actor.GetProperty()

    away, right, up = scene.axes
    stage, window = vtkRenderer(), vtkRenderWindow()
    stage.SetBackground(*_rgb(BOTTOM))
    stage.SetBackground2(*_rgb(TOP))
    stage.GradientBackgroundOn()
    for vertices, faces, colour in scene.parts:
        points, cells, mesh, edges = vtkPoints(), vtkCellArray(), vtkPolyData(), vtkFeatureEdges()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices), deep=True))
        rows = np.column_stack([np.full(len(faces), 3), faces]).astype(np.int64).ravel()
        cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(rows, deep=True))
        mesh.SetPoints(points)
        mesh.SetPolys(cells)
        surface = shown(mesh, colour)
        surface.SetAmbient(AMBIENT)
        surface.SetDiffuse(DIFFUSE)
        edges.SetInputData(mesh)
        edges.SetFeatureAngle(EDGE_DEG)
        edges.BoundaryEdgesOff()
        edges.NonManifoldEdgesOff()
        edges.Update()
        lines = shown(edges.GetOutput(), _rgb(INK))
        lines.SetLineWidth(1.5)
        lines.LightingOff()
    for direction, power in lights:
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPosition(*direction)
        light.SetIntensity(power)
        stage.AddLight(light)
    far = 10.0 * max(scene.scale, *(float(np.ptp(part[0])) for part in scene.parts))
    camera = stage.GetActiveCamera()
    camera.SetPosition(*(scene.middle + far * away))
    camera.SetFocalPoint(*scene.middle)
    camera.SetViewUp(*up)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(scene.scale)
    stage.ResetCameraClippingRange()
    stage.UseFXAAOn()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*scene.window)
    window.AddRenderer(stage)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ShouldRerenderOff()
    grab.Update()
    wide, high, _ = grab.GetOutput().GetDimensions()
    pixels = vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).reshape(high, wide, -1)[::-1]
    width, height = scene.window
    per_mm = height / (2.0 * scene.scale)

    def placed(point: NDArray) -> tuple[float, float]:
        moved = point - scene.middle
        return width / 2 + float(moved @ right) * per_mm, height / 2 - float(moved @ up) * per_mm

    _write(pixels, [(placed(point), text) for point, text in scene.labels], scene.title, path)


def _rgb(colour: str) -> tuple[float, ...]:
    """Shares of red, green and blue of ``#rrggbb``."""
    return tuple(part / 255.0 for part in bytes.fromhex(colour[1:]))


def _write(pixels: Any, labels: Sequence[tuple[tuple[float, float], str]], title: str, path: Path) -> None:
    from PIL import Image, ImageDraw, ImageFont

    picture = Image.fromarray(np.asarray(pixels))
    drawing, font = ImageDraw.Draw(picture), _font_file()
    sizes = (LABEL_PX, TITLE_PX)
    small, large = (ImageFont.truetype(str(font), size) if font else ImageFont.load_default(size) for size in sizes)
    for corner, text in labels:
        drawing.text((corner[0] - 10, corner[1]), text, LETTERS, small, anchor="rm")
    drawing.text((24, 40), title, LETTERS, large, anchor="lm")
    picture.save(path, "PNG", compress_level=4)


def _font_file() -> Path | None:
    """DejaVu Sans, found without loading matplotlib, or None where it is not installed."""
    spec = importlib.util.find_spec("matplotlib")
    places = spec.submodule_search_locations if spec is not None else None
    file = Path(next(iter(places), "")) / "mpl-data/fonts/ttf/DejaVuSans.ttf" if places else Path()
    return file if file.is_file() else None


def scene_of(source: Path) -> Scene:
    """Place the packed meshes: the parts in use stacked with gaps, the casting box beside them."""
    parts, title = pickle.loads(source.read_bytes())
    points = {name: vertices for name, (vertices, _, _) in parts.items()}
    # Unit vectors towards the viewer, to the right and up in the picture.
    away = np.array(VIEW) / np.linalg.norm(VIEW)
    right = np.cross((0.0, 0.0, 1.0), away)
    right /= np.linalg.norm(right)
    up = np.cross(away, right)
    shown: list[tuple[NDArray, NDArray, tuple[float, ...]]] = []
    labels: list[tuple[NDArray, str]] = []
    corners: list[Any] = []
    # Stacks stand side by side along the picture's own horizontal, so that their feet are level.
    side = 0.0
    size = max(np.ptp(part[:, 0]) for part in points.values())
    gap, label_room = GAP_SHARE * size, LABEL_SHARE * size
    for stack in filter(None, stacks_of(list(parts))[:3]):
        lifts = exploded({name: (points[name][:, 2].min(), points[name][:, 2].max()) for name in stack}, stack, gap)
        half = max(np.ptp(_corners(points[name]) @ right) for name in stack) / 2
        side += half if labels else 0.0
        for name in stack:
            moved = points[name] + side * right + np.array((0, 0, lifts[name]))
            shown.append((moved, *parts[name][1:]))
            places = _corners(moved)
            left = places[np.argmin(places @ right + 1e-3 * (places @ up))]
            labels.append((left, name.replace("_", " ")))
            corners += [*places, left - label_room * right]
        side += half + label_room
    window, scale, middle = _frame(np.array(corners), right, up)
    return Scene(shown, labels, title, window, (away, right, up), middle, scale)


def _corners(points: NDArray) -> NDArray:
    (x0, y0, z0), (x1, y1, z1) = points.min(axis=0), points.max(axis=0)
    return np.array([(x, y, z) for x in (x0, x1) for y in (y0, y1) for z in (z0, z1)])


def _frame(corners: Any, right: Any, up: Any) -> tuple[tuple[int, int], float, Any]:
    """Picture size, parallel scale and focal point that fit the corners with a margin and a line for the title."""
    across, along = corners @ right, corners @ up
    wide, high = 1.06 * np.ptp(across), 1.14 * np.ptp(along)
    height = int(min(max(WIDTH * high / wide, 0.4 * WIDTH), 0.9 * WIDTH))
    scale = max(high, wide * height / WIDTH) / 2
    level = (along.max() + along.min()) / 2 + 0.03 * np.ptp(along)
    return (WIDTH, height), scale, right * (across.max() + across.min()) / 2 + up * level


def main() -> None:
    """Draw the picture named on the command line."""
    part = Path(sys.argv[2]).with_suffix(".part.png")
    render(scene_of(Path(sys.argv[1])), part)
    part.replace(sys.argv[2])


if __name__ == "__main__":
    main()
