"""The sheet of glass or acrylic that is let into the plug's top as the tested face; no CAD.

All lengths are those of the casting box, where the sheet keeps its size whatever the silicone shrinks by. [mm]
"""

from __future__ import annotations

import math

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.mold.model.layout import Layout
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import MouldSpec

SHEET_MM = (1.0, 8.0)
STEP_MM = 0.5
LEAST_MM = 20.0
LEAST_FLOOR_MM = 3.0


def sheet_outline(spec: MouldSpec, plan: Layout) -> Outline:
    """Outline to cut the sheet to: within the flat of the tested face, a rim of plastic around it, in half millimetres.

    A rectangle keeps its sharp corners, so near a round corner of the face it stays further inside; a round face takes
    a round sheet.
    """
    face = plan.floor_outline.scaled(plan.silicone_scale)
    inset = spec.pad.edge_radius_mm * plan.scale * plan.silicone_scale + spec.box.sheet_rim_mm
    if face.is_circle:
        across = _step(face.length_mm - 2 * inset)
        return Outline(across, across, across / 2)
    if face.radius_mm > inset:
        inset = max(inset, face.radius_mm - (face.radius_mm - inset) / math.sqrt(2))
    return Outline(_step(face.length_mm - 2 * inset), _step(face.width_mm - 2 * inset), 0.0)


def recess_outline(spec: MouldSpec, plan: Layout) -> Outline:
    """Pocket in the plug: the sheet and the gap of the machine's prints on each side."""
    sheet, gap = sheet_outline(spec, plan), spec.machines.gap_mm
    return sheet.grown(gap) if sheet.is_circle else Outline(sheet.length_mm + 2 * gap, sheet.width_mm + 2 * gap, 0.0)


def plug_top_mm(plan: Layout) -> float:
    """Height of the plug over the base plate. [mm]"""
    return plan.land_mm * plan.silicone_scale


def check_face_sheet(spec: MouldSpec, plan: Layout) -> None:
    """Refuse a sheet that cannot be the tested face.

    Raises
    ------
    InputError
        With what is allowed.
    """
    box, shape = spec.box, spec.pad.shape
    if not box.face_sheet_mm:
        return
    if shape.relief_mm:
        raise InputError(
            f"face_sheet_mm = {box.face_sheet_mm:g}: the tested face of {shape} is curved, a sheet is flat; use 0"
        )
    under = spec.body.floor_mm if spec.is_printed else plug_top_mm(plan) + box.base_mm
    most = min(SHEET_MM[1], under - LEAST_FLOOR_MM - box.sheet_bond_mm)
    if not SHEET_MM[0] <= box.face_sheet_mm <= most:
        raise out_of_range("face_sheet_mm", f"{box.face_sheet_mm:g}", f"{SHEET_MM[0]:g}", f"{most:.3g}",
                           f"{LEAST_FLOOR_MM:g} mm of plastic stay under it")  # fmt: skip
    for name, low, high in (("sheet_bond_mm", 0.0, 0.5), ("sheet_rim_mm", 2.0, 20.0)):
        if not low <= getattr(box, name) <= high:
            raise out_of_range(name, f"{getattr(box, name):g}", f"{low:g}", f"{high:g}")
    sheet = sheet_outline(spec, plan)
    if min(sheet.length_mm, sheet.width_mm) < LEAST_MM:
        raise InputError(
            f"a sheet of {sheet.length_mm:g} x {sheet.width_mm:g} mm is all that fits on the tested face inside its "
            f"rim; at least {LEAST_MM:g} mm each way are of use: leave face_sheet_mm at 0 or take a larger pad"
        )


def _step(length_mm: float) -> float:
    return math.floor(length_mm / STEP_MM) * STEP_MM
