"""The label on the mould's land, in letters of straight strokes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec

GRID_WIDTH, GRID_HEIGHT, ADVANCE = 4.0, 6.0, 5.6
_STROKES = {
    "0": "0006464000 1234",
    "1": "152620",
    "2": "064643030040",
    "3": "06464000 1343",
    "4": "30360242",
    "5": "460603434000",
    "6": "460600404303",
    "7": "064610",
    "8": "0006464000 0343",
    "9": "430306464000",
    "A": "002640 1232",
    "B": "00063633434000 0333",
    "C": "46060040",
    "D": "00062644422000",
    "E": "46060040 0333",
    "F": "460600 0333",
    "R": "0006464303 2340",
    "T": "0646 2620",
    "X": "0046 0640",
    ".": "2021",
    "-": "1333",
    "#": "1016 3036 0242 0444",
    " ": "",
}
"""Strokes on a grid 4 wide and 6 high: the points of each run, two digits a point (x, y)."""
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
    runs = [[(int(x), int(y)) for x, y in zip(run[::2], run[1::2])] for run in _STROKES[letter].split()]
    return [Bar(left + x0 * unit, below + y0 * unit, left + x1 * unit, below + y1 * unit, stroke_mm)
            for run in runs for (x0, y0), (x1, y1) in pairwise(run)]  # fmt: skip


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
    high, stroke = spec.body.label_height_mm, spec.body.label_stroke_mm
    return [bar for letter, at in label_corners(spec) for bar in letter_bars(letter, high, stroke, at)]


def label_corners(spec: MouldSpec) -> list[tuple[str, tuple[float, float]]]:
    """Letters of the label and where the lower left corner of each is, in the mould's frame. [mm]"""
    text, high = label_text(spec), spec.body.label_height_mm
    left, below = -text_length_mm(text, high) / 2, layout(spec).label_y_mm - high / 2
    return [(letter, (left + n * ADVANCE * (high / GRID_HEIGHT), below)) for n, letter in enumerate(text)]
