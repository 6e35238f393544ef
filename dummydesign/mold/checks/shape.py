"""Checks that belong to a shape: its curved face, its bone, its layers. CAD child only."""

from __future__ import annotations

import math
from typing import Any

from dummydesign.geometry.limits import RIM_FREE_MM
from dummydesign.mold.cad.parts import Parts
from dummydesign.mold.cad.prisms import drafted_prism
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks.result import Check, below
from dummydesign.mold.checks.solids import INTERFERENCE_MM3, VOLUME_REL
from dummydesign.mold.model import volumes as contents
from dummydesign.mold.model.outline import Outline
from dummydesign.mold.model.spec import PadGeometry

PROFILE_MM, HEIGHT_MM, LEAST_POINTS = 1e-5, 1e-5, 12
# The box round the splines of a bone from a file is known to a few thousandths; 0.005 mm are 0.1 % of 5 mm of gel.
PLACED_MM = 0.005


def check_shape(made: Parts) -> list[Check]:
    """Check what the slab does not have; nothing for a slab."""
    pad = made.spec.pad
    found = []
    if pad.shape.relief_mm or pad.shape.bone_height_mm:
        found += [] if made.spec.insert is not None else [face_profile(made)]
    if pad.shape.bone_height_mm:
        found += _bone(made)
    if pad.shape.layers():
        found += _layers(made)
    return found


def face_profile(made: Parts) -> Check:
    """Heights of the curved faces, tested face or bone, against those that the finite-element model uses.

    Looked at are the corners of a mesh, which lie on the exact faces however coarse it is.
    """
    import numpy as np

    pad, shape = made.spec.pad, made.spec.pad.shape
    turn = math.radians(shape.steepest_deg) / 3
    tall = max(shape.relief_mm, shape.bone_height_mm)
    corners = [
        point.toTuple()
        for face in _inner_faces(made.pad_nominal.copy(), pad)
        for point in face.tessellate(0.05 * tall, turn)[0]
    ]
    if len(corners) < LEAST_POINTS:
        return below("face_profile", math.inf, PROFILE_MM, "no curved face was found")
    x, y, z = np.array(corners).T
    if shape.bone_height_mm:
        height = pad.thickness_mm - shape.bone_mm(x, y)
    else:
        height = np.min([shape.drop_mm(x - at, y - across) for at, across in shape.places_mm], axis=0)
    worst = float(np.abs(z - height).max())
    return below("face_profile", worst, PROFILE_MM, f"mm off the shape's formula at {len(corners)} points of its faces")


def _inner_faces(solid: Any, pad: PadGeometry) -> list[Any]:
    """Faces that keep off the pad's rim: those of its curves and no other."""
    reach = pad.length_mm / 2 - (-pad.thickness_mm if pad.shape.runs_out else RIM_FREE_MM) + 1e-3
    room = Outline(2 * reach, pad.width_mm - 2 * RIM_FREE_MM + 2e-3, 0.0)
    found = demould.faces_within(solid, room, 0.0, pad.thickness_mm)
    # A bar's end faces lean as the walls do.
    return [face for face in found if abs(face.normalAt().z) > 0.2]


def _bone(made: Parts) -> list[Check]:
    """The bone fills what the gel leaves free and keeps its cover over the tested face."""
    spec, plan = made.spec, made.plan
    exact = plan.scale**3 * contents.bone_volume_mm3(spec)
    what = "closed form" if spec.insert is None else "the placed file"
    bone = _below(made.solid("carrier"), made, plan.depth_mm)
    whole = made.parts["pad"].volume_mm3 + bone
    cover = plan.scale * (spec.pad.thickness_mm - spec.pad.shape.bone_height_mm)
    lowest = made.solid("carrier").BoundingBox().zmin
    near = HEIGHT_MM if spec.insert is None else PLACED_MM
    return [
        below("bone_volume", abs(bone / exact - 1), VOLUME_REL, f"carrier below the fill plane against {what}"),
        below("gel_and_bone", abs(whole / made.cavity.Volume() - 1), VOLUME_REL, "together against the cavity"),
        below("bone_cover", abs(lowest - cover), near, f"mm off the cover of {cover:.3f} mm under the bone"),
    ]


def _below(solid: Any, made: Parts, height_mm: float) -> float:
    """Volume of a solid between the mould's underside and a height. [mm3]"""
    floor = made.spec.body.floor_mm
    return solid.intersect(drafted_prism(made.plan.top.grown(5.0), height_mm + floor, 0.0, -floor)).Volume()


def _layers(made: Parts) -> list[Check]:
    """Both layers are the cavity, the first has its closed form, and the spacer ends where it does."""
    plan, spacer = made.plan, made.solid("spacer")
    top, base = (made.parts[name].volume_mm3 for name in ("layer_top", "layer_base"))
    exact, _ = contents.layer_volumes_mm3(made.spec, plan)
    common = demould.common_volume_mm3(spacer, made.solid("layer_top"))
    dip = spacer.BoundingBox().zmin
    return [
        below("layers_fill_cavity", abs((top + base) / made.cavity.Volume() - 1), VOLUME_REL),
        below("layer_closed_form", abs(top / exact - 1), VOLUME_REL, "layer poured first, by Steiner and Pappus"),
        below("interference_spacer_layer_top", common, INTERFERENCE_MM3, "mm3"),
        below("spacer_height", abs(dip - plan.interface_mm), HEIGHT_MM, "mm off the interface, seated on the land"),
    ]
