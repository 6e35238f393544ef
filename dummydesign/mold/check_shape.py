"""Checks that belong to a shape: its curved face, its bone, its layers. CAD child only."""

from __future__ import annotations

from typing import Any

from dummydesign.mold import contents, demould
from dummydesign.mold.build import Parts
from dummydesign.mold.check import INTERFERENCE_MM3, VOLUME_REL, Check, below, equal, insides
from dummydesign.mold.shapes import drafted_prism
from dummydesign.mold.spec import PadGeometry
from dummydesign.shape import RIM_FREE_MM, Bumped

PROFILE_MM, HEIGHT_MM, PLACES = 1e-4, 1e-5, 128


def check_shape(made: Parts) -> list[Check]:
    """Check what the slab does not have; nothing for a slab."""
    pad = made.spec.pad
    found = [] if pad.kind in ("slab", "puck") else [face_profile(made)]
    if pad.kind == "boned":
        found += _bone(made)
    if pad.kind == "layered":
        found += _layers(made)
    return found


def face_profile(made: Parts) -> Check:
    """Where gel begins and ends, against the heights that the finite-element model uses.

    At places spread over the pad a point just inside either face must lie in the solid, one just outside not.
    """
    pad, inside = made.spec.pad, insides(made.pad_nominal)
    wrong = 0
    for x, y in profile_places(pad):
        low = float(pad.shape.drop_mm(x, y))
        high = pad.thickness_mm - float(pad.shape.bone_mm(x, y))
        seen = [inside(x, y, z) for z in (low - PROFILE_MM, low + PROFILE_MM, high - PROFILE_MM, high + PROFILE_MM)]
        wrong += seen != [False, True, True, False]
    note = f"of {PLACES} places where a face is more than {PROFILE_MM:g} mm off the shape's formula"
    return equal("face_profile", wrong, 0, note)


def profile_places(pad: PadGeometry) -> Any:
    """Places (x, y), half of them where the shape is curved, half all over the pad but its rim; shape (n, 2)."""
    import numpy as np

    shape = pad.shape
    pad_reach = np.array([pad.length_mm, pad.width_mm]) / 2 - RIM_FREE_MM
    curved = max(shape.lines_mm(), default=pad_reach.min())
    if isinstance(shape, Bumped):
        curved = shape.rings * shape.pitch_mm + shape.radius_mm
    # Halton's points in bases 2 and 3.
    spread = np.array([[_halton(i, base) for base in (2, 3)] for i in range(1, PLACES + 1)]) * 2 - 1
    reach = np.where(np.arange(PLACES)[:, None] % 4 < 2, np.minimum(curved, pad_reach), pad_reach)
    return spread * reach


def _halton(index: int, base: int) -> float:
    value, share = 0.0, 1.0
    while index:
        share /= base
        value += share * (index % base)
        index //= base
    return value


def _bone(made: Parts) -> list[Check]:
    """The bone fills what the gel leaves free and keeps its cover over the tested face."""
    spec, plan = made.spec, made.plan
    exact = plan.scale**3 * contents.bone_volume_mm3(spec.pad)
    bone = _below(made.solid("carrier"), made, plan.depth_mm)
    whole = made.solid("pad").Volume() + bone
    cover = plan.scale * (spec.pad.thickness_mm - spec.pad.shape.height_mm)
    lowest = made.solid("carrier").BoundingBox().zmin
    return [
        below("bone_volume", abs(bone / exact - 1), VOLUME_REL, "carrier below the fill plane against closed form"),
        below("gel_and_bone", abs(whole / made.cavity.Volume() - 1), VOLUME_REL, "together against the cavity"),
        below("bone_cover", abs(lowest - cover), HEIGHT_MM, f"mm off the cover of {cover:.3f} mm under the bone"),
    ]


def _below(solid: Any, made: Parts, height_mm: float) -> float:
    """Volume of a solid between the mould's underside and a height. [mm3]"""
    floor = made.spec.body.floor_mm
    return solid.intersect(drafted_prism(made.plan.top.grown(5.0), height_mm + floor, 0.0, -floor)).Volume()


def _layers(made: Parts) -> list[Check]:
    """Both layers are the cavity, the first has its closed form, and the spacer ends where it does."""
    plan, spacer = made.plan, made.solid("spacer")
    top, base = (made.solid(name).Volume() for name in ("layer_top", "layer_base"))
    exact, _ = contents.layer_volumes_mm3(made.spec, plan)
    common = demould.common_volume_mm3(spacer, made.solid("layer_top"))
    dip = spacer.BoundingBox().zmin
    return [
        below("layers_fill_cavity", abs((top + base) / made.cavity.Volume() - 1), VOLUME_REL),
        below("layer_closed_form", abs(top / exact - 1), VOLUME_REL, "layer poured first, by Steiner and Pappus"),
        below("interference_spacer_layer_top", common, INTERFERENCE_MM3, "mm3"),
        below("spacer_height", abs(dip - plan.interface_mm), HEIGHT_MM, "mm off the interface, seated on the land"),
    ]
