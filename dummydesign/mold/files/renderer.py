"""Draw solids in a parallel view: triangles by NumPy into a depth buffer, letters by Pillow.

No graphics library or display is needed, and the picture is the same on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.mold.files.drawing_layout import font_file

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


@dataclass(frozen=True)
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

    picture = Image.fromarray(np.round(255.0 * pixels).astype(np.uint8))
    drawing, font = ImageDraw.Draw(picture), font_file("DejaVuSans")
    sizes = (LABEL_PX, TITLE_PX)
    small, large = (ImageFont.truetype(str(font), size) if font else ImageFont.load_default(size) for size in sizes)
    for corner, text in labels:
        drawing.text((corner[0] - 10, corner[1]), text, LETTERS, small, anchor="rm")
    drawing.text((24, 40), title, LETTERS, large, anchor="lm")
    picture.save(path, "PNG")
