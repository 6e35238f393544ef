"""The label on the mould's land: as much of size, ratio and hash as there is room for."""

from __future__ import annotations

from dummydesign.mold.cad.stroke_font import KNOWN, Bar, text_bars, text_length_mm
from dummydesign.mold.model.layout import Layout, layout
from dummydesign.mold.model.spec import MouldSpec


def label_text(spec: MouldSpec, plan: Layout | None = None) -> str:
    """Choose the longest label that fits the land's front side; an empty text when none fits."""
    plan = plan or layout(spec)
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
        if readable and text_length_mm(text, spec.body.label_height_mm) <= plan.label_room_mm:
            return text
    return ""


def label_bars(spec: MouldSpec, plan: Layout | None = None) -> list[Bar]:
    """Strokes of the label where they stand on the land, in the mould's frame."""
    plan = plan or layout(spec)
    body = spec.body
    text = label_text(spec, plan)
    return text_bars(text, body.label_height_mm, body.label_stroke_mm, (0.0, plan.label_y_mm))
