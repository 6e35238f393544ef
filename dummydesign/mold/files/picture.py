"""Picture of the parts, as a process of its own beside the checks; the mould is as good without one.

Solids are drawn in a parallel view: triangles by NumPy into a depth buffer, letters by Pillow. No graphics library or
display is needed, and the picture is the same on every machine.

``python -m dummydesign.mold.files.picture meshes.npz picture.png``
"""

from __future__ import annotations

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


FINE = 2
"""Pixels are drawn so many times finer along each side and averaged."""
CHUNK = 100_000
"""Pixels drawn at a time: few enough to stay in the processor's cache."""
AMBIENT, DIFFUSE = 0.25, 0.75
LIGHTS = (((-1, -2, 3), 0.75), ((2, -1, 1.5), 0.35), ((0, 1, 2), 0.25))
"""Where each light comes from, and its strength."""
# Neighbouring triangles of one curved face turn by 11.5 deg at the most.
EDGE_DEG = 14.0
BOTTOM, TOP = (255, 255, 255), (232, 237, 242)
INK = (51, 66, 77)
LETTERS, LABEL_PX, TITLE_PX = (32, 48, 60), 22, 25


class Canvas:
    """A picture with a depth for each pixel. Places are columns, rows from the top and heights towards the viewer."""

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self.depth = np.full(width * height, -np.inf)
        # Which of the colours a pixel has; without one the background shows, with the first one a line.
        self.owner = np.full(width * height, -1, np.int32)
        self.palette = np.array([INK], float)

    def fill(self, corners: NDArray, colours: NDArray) -> None:
        """Draw triangles, shape (n, 3, 3), each of one colour; the nearest is seen whatever their order."""
        offset = len(self.palette)
        self.palette = np.concatenate([self.palette, colours])
        # Number of rows whose middle a triangle meets, and the first.
        low, high = corners[:, :, 1].min(axis=1), corners[:, :, 1].max(axis=1)
        first, last = (np.clip(np.ceil(end - 0.5), 0, self.height).astype(int) for end in (low, high))
        rows = last - first
        which = np.repeat(np.arange(len(corners)), rows)
        row = np.repeat(first, rows) + _counting(rows)
        left, right = _span(corners[which], row + 0.5)
        start, stop = (np.clip(np.ceil(end - 0.5), 0, self.width).astype(int) for end in (left, right))
        slope = _plane(corners)
        some = stop > start
        which, row, start, length = which[some], row[some], start[some], (stop - start)[some]
        ends = np.append(np.searchsorted(np.cumsum(length), np.arange(CHUNK, length.sum(), CHUNK)), len(length))
        begin = 0
        for end in ends:
            n = length[begin:end]
            column = np.repeat(start[begin:end], n) + _counting(n)
            owner, line = np.repeat(which[begin:end], n), np.repeat(row[begin:end], n)
            level = slope[owner, 0] * (column + 0.5) + slope[owner, 1] * (line + 0.5) + slope[owner, 2]
            pixel = line * self.width + column
            np.maximum.at(self.depth, pixel, level)
            seen = level >= self.depth[pixel]
            self.owner[pixel[seen]] = offset + owner[seen]
            begin = end

    def lines(self, ends: NDArray, near: float) -> None:
        """Draw lines, shape (n, 2, 3), where nothing lies more than ``near`` before them."""
        steps = np.ceil(np.abs(ends[:, 1, :2] - ends[:, 0, :2]).max(axis=1)).astype(int) + 1
        which = np.repeat(np.arange(len(ends)), steps)
        share = (_counting(steps) / np.repeat(np.maximum(steps - 1, 1), steps))[:, None]
        points = ends[which, 0] * (1 - share) + ends[which, 1] * share
        for across, down in ((0, 0), (1, 0), (0, 1)):
            column, row = np.floor(points[:, 0]).astype(int) + across, np.floor(points[:, 1]).astype(int) + down
            inside = (column >= 0) & (column < self.width) & (row >= 0) & (row < self.height)
            pixel = row[inside] * self.width + column[inside]
            seen = points[inside, 2] + near >= self.depth[pixel]
            self.owner[pixel[seen]] = 0

    def pixels(self) -> NDArray:
        """The averaged picture; shape (height, width, 3), 0 to 1."""
        owner = self.owner.reshape(self.height, self.width)
        share = np.linspace(0.0, 1.0, self.height)[:, None]
        behind = np.array(TOP) * (1 - share) + np.array(BOTTOM) * share
        summed = np.zeros((self.height // FINE, self.width // FINE, 3))
        for row in range(FINE):
            for column in range(FINE):
                some = owner[row::FINE, column::FINE]
                summed += np.where(some[..., None] < 0, behind[row::FINE, None], self.palette[some])
        return np.clip(summed / FINE**2 / 255.0, 0.0, 1.0)


def _counting(lengths: NDArray) -> NDArray:
    """0, 1, 2, ... anew for each length."""
    return np.arange(lengths.sum()) - np.repeat(np.cumsum(lengths) - lengths, lengths)


def _span(corners: NDArray, level: NDArray) -> tuple[NDArray, NDArray]:
    """Where triangles begin and end along a row."""
    left, right = np.full(len(level), np.inf), np.full(len(level), -np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        (xa, ya), (xb, yb) = corners[:, a, :2].T, corners[:, b, :2].T
        crossed = (np.minimum(ya, yb) <= level) & (level <= np.maximum(ya, yb)) & (ya != yb)
        with np.errstate(divide="ignore", invalid="ignore"):
            x = xa + (level - ya) / (yb - ya) * (xb - xa)
        left = np.where(crossed, np.minimum(left, x), left)
        right = np.where(crossed, np.maximum(right, x), right)
    return left, right


def _plane(corners: NDArray) -> NDArray:
    """Height over column and row of each triangle: two slopes and the height at the origin."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    (ux, uy, uz), (vx, vy, vz) = (b - a).T, (c - a).T
    area = ux * vy - uy * vx
    area = np.where(area == 0.0, np.inf, area)
    along, down = (uz * vy - vz * uy) / area, (ux * vz - vx * uz) / area
    return np.stack([along, down, a[:, 2] - along * a[:, 0] - down * a[:, 1]], axis=1)


def normals_of(vertices: NDArray, faces: NDArray) -> NDArray:
    """Unit normals of triangles, outwards; zero where a triangle has no area."""
    a, b, c = (vertices[faces[:, number]] for number in range(3))
    across = np.cross(b - a, c - a)
    size = np.linalg.norm(across, axis=1, keepdims=True)
    return np.divide(across, size, out=np.zeros_like(across), where=size > 0)


def sharp_edges(faces: NDArray, normals: NDArray, least_deg: float) -> NDArray:
    """Pairs of corners of the edges at which two faces turn by more than an angle; shape (n, 2)."""
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    owner = np.tile(np.arange(len(faces)), 3)
    order = np.lexsort((edges[:, 1], edges[:, 0]))
    edges, owner = edges[order], owner[order]
    twice = np.flatnonzero((edges[1:] == edges[:-1]).all(axis=1))
    turn = np.einsum("ij,ij->i", normals[owner[twice]], normals[owner[twice + 1]])
    return edges[twice[turn < np.cos(np.radians(least_deg))]]


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
    width, height = scene.window[0] * FINE, scene.window[1] // FINE * FINE * FINE
    away, right, up = scene.axes
    per_mm = height / (2.0 * scene.scale)

    def placed(points: NDArray) -> NDArray:
        moved = points - scene.middle
        across, high = moved @ right * per_mm + width / 2, height / 2 - moved @ up * per_mm
        return np.stack([across, high, moved @ away * per_mm], axis=-1)

    canvas = Canvas(width, height)
    triangles, colours, lines = [], [], []
    for vertices, faces, colour in scene.parts:
        normals = normals_of(vertices, faces)
        front = normals @ away > 1e-9
        light = np.full(np.count_nonzero(front), AMBIENT)
        for direction, power in lights:
            unit = np.array(direction) / np.linalg.norm(direction)
            light += DIFFUSE * power * np.maximum(normals[front] @ unit, 0.0)
        triangles.append(placed(vertices)[faces[front]])
        colours.append(np.clip(light[:, None] * np.array(colour), 0.0, 1.0) * 255.0)
        lines.append(placed(vertices)[sharp_edges(faces, normals, EDGE_DEG)])
    canvas.fill(np.concatenate(triangles), np.concatenate(colours))
    canvas.lines(np.concatenate(lines), near=2.0 * FINE)
    _write(canvas.pixels(), [(placed(point[None])[0] / FINE, text) for point, text in scene.labels], scene.title, path)


def _write(pixels: NDArray, labels: Sequence[tuple[NDArray, str]], title: str, path: Path) -> None:
    from PIL import Image, ImageDraw, ImageFont

    from dummydesign.mold.files.drawing_layout import font_file

    picture = Image.fromarray(np.round(255.0 * pixels).astype(np.uint8))
    drawing, font = ImageDraw.Draw(picture), font_file("DejaVuSans")
    sizes = (LABEL_PX, TITLE_PX)
    small, large = (ImageFont.truetype(str(font), size) if font else ImageFont.load_default(size) for size in sizes)
    for corner, text in labels:
        drawing.text((corner[0] - 10, corner[1]), text, LETTERS, small, anchor="rm")
    drawing.text((24, 40), title, LETTERS, large, anchor="lm")
    picture.save(path, "PNG")


def scene_of(source: Path) -> Scene:
    """Place the packed meshes: the parts in use stacked with gaps, the casting box beside them."""
    data = np.load(source)
    names = list(dict.fromkeys(key.split("/")[0] for key in data.files if "/" in key))
    points = {name: np.asarray(data[f"{name}/vertices"], float) for name in names}
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
    for stack in filter(None, stacks_of(names)[:3]):
        lifts = exploded({name: (points[name][:, 2].min(), points[name][:, 2].max()) for name in stack}, stack, gap)
        half = max(np.ptp(_corners(points[name]) @ right) for name in stack) / 2
        side += half if labels else 0.0
        for name in stack:
            moved = points[name] + side * right + np.array((0, 0, lifts[name]))
            shown.append((moved, np.asarray(data[f"{name}/faces"]), tuple(data[f"{name}/colour"].tolist())))
            places = _corners(moved)
            left = places[np.argmin(places @ right + 1e-3 * (places @ up))]
            labels.append((left, name.replace("_", " ")))
            corners += [*places, left - label_room * right]
        side += half + label_room
    window, scale, middle = _frame(np.array(corners), right, up)
    return Scene(shown, labels, str(data["title"]), window, (away, right, up), middle, scale)


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
