"""The label on the mould's land, in letters of straight strokes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec

# Strokes on a grid 4 wide and 6 high.
GRID_WIDTH, GRID_HEIGHT, ADVANCE = 4.0, 6.0, 5.6

_STROKES: dict[str, tuple[tuple[tuple[int, int], ...], ...]] = {
    "0": (((0, 0), (0, 6), (4, 6), (4, 0), (0, 0)), ((1, 2), (3, 4))),
    "1": (((1, 5), (2, 6), (2, 0)),),
    "2": (((0, 6), (4, 6), (4, 3), (0, 3), (0, 0), (4, 0)),),
    "3": (((0, 6), (4, 6), (4, 0), (0, 0)), ((1, 3), (4, 3))),
    "4": (((3, 0), (3, 6), (0, 2), (4, 2)),),
    "5": (((4, 6), (0, 6), (0, 3), (4, 3), (4, 0), (0, 0)),),
    "6": (((4, 6), (0, 6), (0, 0), (4, 0), (4, 3), (0, 3)),),
    "7": (((0, 6), (4, 6), (1, 0)),),
    "8": (((0, 0), (0, 6), (4, 6), (4, 0), (0, 0)), ((0, 3), (4, 3))),
    "9": (((4, 3), (0, 3), (0, 6), (4, 6), (4, 0), (0, 0)),),
    "A": (((0, 0), (2, 6), (4, 0)), ((1, 2), (3, 2))),
    "B": (((0, 0), (0, 6), (3, 6), (3, 3), (4, 3), (4, 0), (0, 0)), ((0, 3), (3, 3))),
    "C": (((4, 6), (0, 6), (0, 0), (4, 0)),),
    "D": (((0, 0), (0, 6), (2, 6), (4, 4), (4, 2), (2, 0), (0, 0)),),
    "E": (((4, 6), (0, 6), (0, 0), (4, 0)), ((0, 3), (3, 3))),
    "F": (((4, 6), (0, 6), (0, 0)), ((0, 3), (3, 3))),
    "R": (((0, 0), (0, 6), (4, 6), (4, 3), (0, 3)), ((2, 3), (4, 0))),
    "T": (((0, 6), (4, 6)), ((2, 6), (2, 0))),
    "X": (((0, 0), (4, 6)), ((0, 6), (4, 0))),
    ".": (((2, 0), (2, 1)),),
    "-": (((1, 3), (3, 3)),),
    "#": (((1, 0), (1, 6)), ((3, 0), (3, 6)), ((0, 2), (4, 2)), ((0, 4), (4, 4))),
    " ": (),
}
KNOWN = "".join(_STROKES)


@dataclass(frozen=True)
class Bar:
    """One straight stroke from (x0, y0) to (x1, y1), its ends half a stroke longer. [mm]"""

    x0_mm: float
    y0_mm: float
    x1_mm: float
    y1_mm: float
    width_mm: float

    @property
    def length_mm(self) -> float:
        """Length with both overruns. [mm]"""
        return math.hypot(self.x1_mm - self.x0_mm, self.y1_mm - self.y0_mm) + self.width_mm

    @property
    def angle_deg(self) -> float:
        """Direction against +x. [deg]"""
        return math.degrees(math.atan2(self.y1_mm - self.y0_mm, self.x1_mm - self.x0_mm))

    @property
    def middle(self) -> tuple[float, float]:
        """Middle of the stroke. [mm]"""
        return (self.x0_mm + self.x1_mm) / 2, (self.y0_mm + self.y1_mm) / 2


def text_length_mm(text: str, height_mm: float) -> float:
    """Length of a text whose letters are ``height_mm`` high. [mm]"""
    return (len(text) * ADVANCE - (ADVANCE - GRID_WIDTH)) * height_mm / GRID_HEIGHT if text else 0.0


def letter_bars(letter: str, height_mm: float, stroke_mm: float, corner: tuple[float, float]) -> list[Bar]:
    """Strokes of a letter whose lower left corner is at a place, reading along +x when seen from +z."""
    unit, (left, below) = height_mm / GRID_HEIGHT, corner
    return [
        Bar(left + x0 * unit, below + y0 * unit, left + x1 * unit, below + y1 * unit, stroke_mm)
        for run in _STROKES[letter] for (x0, y0), (x1, y1) in pairwise(run)
    ]  # fmt: skip


def text_corners(text: str, height_mm: float, middle: tuple[float, float]) -> list[tuple[float, float]]:
    """Lower left corner of each letter of a text centred on ``middle``. [mm]"""
    unit = height_mm / GRID_HEIGHT
    left = middle[0] - text_length_mm(text, height_mm) / 2
    return [(left + number * ADVANCE * unit, middle[1] - height_mm / 2) for number in range(len(text))]


def text_bars(text: str, height_mm: float, stroke_mm: float, middle: tuple[float, float]) -> list[Bar]:
    """Strokes of a text centred on ``middle``, reading along +x when seen from +z."""
    corners = text_corners(text, height_mm, middle)
    return [bar for letter, at in zip(text, corners) for bar in letter_bars(letter, height_mm, stroke_mm, at)]


def label_text(spec: MouldSpec) -> str:
    """Choose the longest label that fits the land's front side; an empty text when none fits."""
    pad = spec.pad
    size = f"T{pad.thickness_mm:g} {pad.length_mm:g}X{pad.width_mm:g}"
    for text in (
        f"{size} R{spec.pour.ratio:g} #{spec.hash}",
        f"T{pad.thickness_mm:g} #{spec.hash}",
        f"#{spec.hash}",
        f"#{spec.hash[:4]}",
        f"T{pad.thickness_mm:g}",
    ):
        readable = all(letter in KNOWN for letter in text)
        if readable and text_length_mm(text, spec.body.label_height_mm) <= layout(spec).label_room_mm:
            return text
    return ""


def label_bars(spec: MouldSpec) -> list[Bar]:
    """Strokes of the label where they stand on the land, in the mould's frame."""
    body = spec.body
    return text_bars(label_text(spec), body.label_height_mm, body.label_stroke_mm, _middle(spec))


def label_corners(spec: MouldSpec) -> list[tuple[str, tuple[float, float]]]:
    """Letters of the label and where the lower left corner of each is, in the mould's frame. [mm]"""
    text = label_text(spec)
    return list(zip(text, text_corners(text, spec.body.label_height_mm, _middle(spec))))


def _middle(spec: MouldSpec) -> tuple[float, float]:
    return 0.0, layout(spec).label_y_mm
