"""Checks of the solids: dimensions, the shape's own, the label."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from dummydesign.geometry.dimensions import RIM_FREE_MM
from dummydesign.mold.cad.casting_box import to_casting
from dummydesign.mold.cad.kernel import cq
from dummydesign.mold.cad.label import label_bars
from dummydesign.mold.cad.parts import CORE_MM, Parts
from dummydesign.mold.cad.solids import drafted_prism, heights_over, rough_bounds
from dummydesign.mold.checks import Check, above, below, equal, release, skipped
from dummydesign.mold.files.meshes import tessellate
from dummydesign.mold.model import layout as dimensions
from dummydesign.mold.model.layout import Outline
from dummydesign.mold.model.spec import PadGeometry

OFF_MM = 1e-4


def check_label(made: Parts, meshes: Mapping[str, Any] | None = None) -> list[Check]:
    """The label reads right on the mould (void along its strokes) and mirrored on the master (proud there)."""
    bars = label_bars(made.spec)
    if not bars:
        return [skipped("label_reads_right", "no room for a label on this land")]
    plan, grow = made.plan, made.plan.silicone_scale
    solids = {"mould": made.mould, **({} if made.spec.is_printed else {"master": made.solid("master")})}
    meshes = meshes or {name: tessellate(solid) for name, solid in solids.items()}
    depth = plan.land_mm - made.spec.body.label_depth_mm / 2
    places = np.array([(*bar.middle, depth) for bar in bars])
    right = ~inside_mesh(meshes["mould"], places)
    wrong = ~inside_mesh(meshes["mould"], places * (-1.0, 1.0, 1.0))
    if not made.spec.is_printed:
        # Turned over about x: y changes sign, heights count from the land downwards.
        turned = (places - (0.0, 0.0, plan.land_mm)) * (grow, -grow, -grow)
        right = right & inside_mesh(meshes["master"], turned)
    note = "share of strokes cut in the mould and proud on the master"
    checks = [equal("label_reads_right", float(right.mean()), 1.0, note)]
    # A mirrored label would share all strokes only if the text were its own mirror image.
    if (shared := float(wrong.mean())) == 1.0:
        return [*checks, skipped("label_not_mirrored", "the label is its own mirror image")]
    note = "share of strokes that a mirrored label would share"
    return [*checks, below("label_not_mirrored", shared, 0.99, note)]


def inside_mesh(mesh: Any, points: Any) -> Any:
    """Which points lie inside a closed mesh: an odd number of its triangles is above them."""
    # Off the edges of triangles, which the middle of a stroke may lie on.
    moved, corners = points + (OFF_MM, 0.7 * OFF_MM, 0.0), mesh.triangles
    low, high = corners.min(axis=1)[:, :2], corners.max(axis=1)[:, :2]
    near = np.all((low <= moved.max(axis=0)[:2]) & (high >= moved.min(axis=0)[:2]), axis=1)
    over = [np.count_nonzero(heights > some[:, 2:], axis=1) for some, heights in heights_over(moved, corners[near])]
    return np.concatenate(over) % 2 == 1


VOLUME_REL, INTERFERENCE_MM3, SILICONE_REL, DRAFT_SLACK_DEG = 1e-9, 0.01, 2e-4, 0.01
LEAST_GAP_MM = 0.8


def check_solids(made: Parts, meshes: Mapping[str, Any] | None = None) -> list[Check]:
    """Check all solids: validity, volumes, interference, silicone in the box, draft, sweep, features, label.

    ``meshes`` are those that :func:`~dummydesign.mold.checks.solids.check_label` reads the label from.
    """
    checks = [*check_validity(made), *check_volumes(made), *check_interference(made), *check_boxes(made)]
    checks += [*check_drafts(made), _sweep(made), *check_distances(made)]
    checks += [*check_label(made, meshes), *check_sheet(made)]
    if made.spec.body.style == "lidded":
        checks.append(lid_one_way(made.solid("lid"), made.solid("mould")))
    return checks


def check_validity(made: Parts) -> list[Check]:
    """Each part is one valid solid with one closed shell."""

    def good(shape: Any) -> bool:
        shells = shape.Shells()
        return len(shape.Solids()) == len(shells) == 1 and shape.isValid() and shells[0].Closed()

    bad = [name for name, part in made.parts.items() if not good(part.solid)]
    return [equal("solids_valid", len(made.parts) - len(bad), len(made.parts), ", ".join(bad))]


def check_volumes(made: Parts) -> list[Check]:
    """Cavity against what fills it, compensated pad against nominal pad, and the pad against its closed form."""
    spec, plan, pad = made.spec, made.plan, made.solid("pad")
    low = drafted_prism(plan.fill_outline.grown(CORE_MM), plan.depth_mm + spec.body.floor_mm, 0.0, -spec.body.floor_mm)
    cavities = [one.cut(made.core).Volume() for one in plan.at_places(low)]
    filled = made.cavity.Volume()
    what = "against pad" if made.with_bone is None else "against pad and bone"
    off = max(abs(one / filled - 1) for one in cavities)
    return [
        below("cavity_volume", off, VOLUME_REL, f"cavity to the fill plane {what}"),
        below("compensation", abs(pad.Volume() / (made.pad_nominal.Volume() * plan.scale**3) - 1), VOLUME_REL),
        below(
            "closed_form",
            abs(pad.Volume() / dimensions.resin_volume_mm3(spec) - 1),
            VOLUME_REL,
            f"drafted slab by Steiner and Pappus{spec.pad.shape.closed_form}",
        ),
    ]


TOUCHING = (
    ("mould", "pad"),
    ("master", "frame"),
    ("tray", "mould"),
    ("lid", "mould"),
    ("lid", "pad"),
    ("backer", "lid"),
    ("lid_master", "lid_frame"),
    ("strike_off", "mould"),
    ("strike_off", "pad"),
    ("collar", "mould"),
    ("spacer", "mould"),
    ("carrier", "mould"),
    ("carrier", "pad"),
    ("face_sheet", "master"),
)
TOUCHING_PRINTED = (
    ("frame", "mould"),
    ("frame", "pad"),
    ("strike_off", "frame"),
    ("carrier", "frame"),
    ("spacer", "frame"),
    ("face_sheet", "mould"),
    ("face_sheet", "pad"),
)


def check_interference(made: Parts) -> list[Check]:
    """Parts that touch in use or in the casting box must not overlap."""
    checks = []
    # A printed mould's ring stands where it is used; a silicone mould's frame stands in its casting box.
    for one, other in (*TOUCHING, *(TOUCHING_PRINTED if made.spec.is_printed else ())):
        if one in made.parts and other in made.parts:
            common = release.common_volume_mm3(_met(made, one, other), _met(made, other, one))
            checks.append(below(f"interference_{one}_{other}", common, INTERFERENCE_MM3, "mm3"))
    return checks


def _met(made: Parts, name: str, other: str) -> Any:
    """Solid of a part, of a mould all that the other part can touch: what lies in its cavities meets its core alone."""
    return made.core if (name, other) == ("mould", "pad") and made.whole is None else made.solid(name)


def check_boxes(made: Parts) -> list[Check]:
    """The silicone a casting box holds is the part scaled by the silicone's shrinkage, and the box is empty of it."""
    spec, plan = made.spec, made.plan
    checks = []
    boxes = [] if spec.is_printed else [("mould", "master", "frame", made.solid("mould"), True)]
    if "lid" in made.parts:
        funnels = [*made.tools["sprue"], *made.tools["vents"]]
        whole = made.solid("lid").fuse(*[tool.intersect(made.tools["lid_hull"][0]) for tool in funnels])
        boxes.append(("lid", "lid_master", "lid_frame", whole, False))
    for name, master, frame, part, turned in boxes:
        cast = to_casting(part, plan, turned)
        box = cast.BoundingBox()
        # From the bottom of the base plate to the fill mark, outside half-way into the frame's wall.
        inside = plan.top.scaled(plan.silicone_scale).grown(spec.box.frame_wall_mm / 2)
        room = drafted_prism(inside, box.zmax + spec.box.base_mm, 0.0, -spec.box.base_mm)
        held = room.cut(_without_pocket(made) if name == "mould" else made.solid(master), made.solid(frame))
        # Bolt holes and pin sockets are no room for silicone: keep what the poured block is connected to.
        volume = max(solid.Volume() for solid in held.Solids())
        if name == "lid":
            volume -= sum(tool.Volume() for tool in made.tools.get("sockets", []))
        checks.append(below(f"silicone_in_box_{name}", abs(volume / cast.Volume() - 1), SILICONE_REL))
        overlap = release.common_volume_mm3(made.solid(master), cast)
        checks.append(below(f"interference_{master}_{name}", overlap, INTERFERENCE_MM3, "mm3"))
    return checks


def _without_pocket(made: Parts) -> Any:
    """The master with its sheet bonded in, as silicone and pad see it."""
    master = made.solid("master")
    return master.fuse(*made.tools["face_recess"]).clean() if "face_sheet" in made.parts else master


def cavity_draft_deg(mould: Any, made: Parts) -> float:
    """Smallest draft of a mould's cavity faces, pulled along +z. [deg]"""
    plan = made.plan
    return release.minimum_draft_deg(release.faces_within(mould, plan.openings, -0.01, plan.land_mm))


def check_drafts(made: Parts) -> list[Check]:
    """Draft of cavity, of the plug it is cast on and of the frame, each in its direction of pull."""
    spec, plan, grow = made.spec, made.plan, made.plan.silicone_scale
    outer = spec.body.outer_draft_deg
    checks = [above("draft_cavity", cavity_draft_deg(made.core, made), spec.pad.draft_deg - DRAFT_SLACK_DEG)]
    if spec.is_printed:
        return checks
    high = plan.height_mm * grow
    plug = release.faces_within(_without_pocket(made), plan.openings.scaled(grow), 0.0, high)
    checks.append(above("draft_plug", release.minimum_draft_deg(plug), spec.pad.draft_deg - DRAFT_SLACK_DEG))
    frames = [("frame", high)]
    if "lid_frame" in made.parts:
        frames.append(("lid_frame", spec.lid.lid_mm * grow))
    for name, top in frames:
        inner = release.faces_within(made.solid(name), plan.top.scaled(grow), 0.0, top)
        checks.append(above(f"draft_{name}", release.minimum_draft_deg(inner, -1.0), outer - DRAFT_SLACK_DEG))
    return checks


def check_sheet(made: Parts) -> list[Check]:
    """The sheet that is the tested face ends flush with the plug's top, and lies over its bond in the pocket."""
    if "face_sheet" not in made.parts:
        return []
    sheet, box, printed = made.solid("face_sheet"), made.spec.box, made.spec.is_printed
    top = 0.0 if printed else rough_bounds(_without_pocket(made))[5]
    offset = abs(rough_bounds(sheet)[5] - top)
    bed = made.solid("mould" if printed else "master").distance(sheet.translate((0, 0, -box.sheet_bond_mm)))
    return [
        below("face_sheet_flush", offset, 1e-5, "mm off the face around it"),
        below("face_sheet_seated", bed, 1e-5, "mm from the pocket's floor, its bond taken away"),
    ]


def sweep_offsets_mm(depth_mm: float) -> list[float]:
    """Offsets of the swept pull: small ones too, where a lip bites most; of two alike one."""
    offsets = sorted((0.0, 0.1, 0.5, *(depth_mm * share for share in (0.1, 0.25, 0.5, 0.75))))
    return [offset for before, offset in pairwise(offsets) if offset > 1.25 * before]


def _sweep(made: Parts) -> Check:
    offsets = sweep_offsets_mm(made.plan.depth_mm)
    worst = max(release.sweep_interference_mm3(pad, made.core, offsets) for pad in made.cavities)
    return below("sweep_cavity", worst, INTERFERENCE_MM3, f"mm3, pad pulled straight out at {len(offsets)} offsets")


def lid_one_way(lid: Any, mould: Any) -> Check:
    """The lid turned round by 180 degrees must collide with the mould."""
    turned = lid.rotate(cq.Vector(), cq.Vector(0, 0, 1), 180)
    common = release.common_volume_mm3(turned, mould)
    return above("lid_one_way", common, 50.0, "mm3 of collision when the lid is turned round")


def check_distances(made: Parts) -> list[Check]:
    """Key, gutter, label, sprue and vents keep apart; the gutter keeps off the cavity."""
    tools = {name: made.tools.get(name, []) for name in ("keys", "gutter", "label", "sprue", "vents")}
    flat = [(name, tool) for name, group in tools.items() for tool in group]
    least, where = _nearest([(f"{name} and {other_name}", tool, other) for (name, tool), (other_name, other)
                             in combinations(flat, 2) if not name == other_name == "label"])  # fmt: skip
    checks = [above("features_apart", least, LEAST_GAP_MM, f"mm, nearest: {where}")] if where else []
    if tools["gutter"]:
        c = made.spec.lid
        gap = made.solid("pad").distance(tools["gutter"][0])
        checks.append(above("gutter_to_cavity", gap, c.gutter_distance_mm - c.gutter_radius_mm - 1e-3, "mm"))
    if tools["label"]:
        near = made.solid("pad").distance(cq.Compound.makeCompound(tools["label"]))
        checks.append(above("label_to_pad", near, LEAST_GAP_MM, "mm"))
    return checks


def _nearest(pairs: list[tuple[str, Any, Any]]) -> tuple[float, str]:
    """Least distance of named pairs, and whose it is; pairs whose boxes are further apart are not measured. [mm]"""
    least, where = math.inf, ""
    gaps = [(_box_gap_mm(tool, other), name, tool, other) for name, tool, other in pairs]
    for gap, name, tool, other in sorted(gaps, key=lambda pair: pair[0]):
        if gap >= least:
            break
        if (distance := tool.distance(other)) < least:
            least, where = distance, name
    return least, where


def _box_gap_mm(one: Any, other: Any) -> float:
    """Distance of two bounding boxes, a lower bound of the distance of what is in them. [mm]"""
    a, b = rough_bounds(one), rough_bounds(other)
    return math.hypot(*(max(0.0, a[axis] - b[axis + 3], b[axis] - a[axis + 3]) for axis in range(3)))


PROFILE_MM, HEIGHT_MM, LEAST_POINTS = 1e-5, 1e-5, 12


def check_shape(made: Parts) -> list[Check]:
    """Check what the slab does not have; nothing for a slab."""
    pad = made.spec.pad
    checks = []
    if pad.shape.relief_mm or pad.shape.bone_height_mm:
        checks.append(face_profile(made))
    if pad.shape.bone_height_mm:
        checks += _bone(made)
    if pad.shape.layers():
        checks += _layers(made)
    return checks


def face_profile(made: Parts) -> Check:
    """Heights of the curved faces, tested face or bone, against those that the finite-element model uses.

    Looked at are the corners of a mesh, which lie on the exact faces however coarse it is.
    """
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
    faces = release.faces_within(solid, room, 0.0, pad.thickness_mm)
    # A bar's end faces lean as the walls do.
    return [face for face in faces if abs(face.normalAt().z) > 0.2]


def _bone(made: Parts) -> list[Check]:
    """The bone fills what the gel leaves free and keeps its cover over the tested face."""
    spec, plan = made.spec, made.plan
    exact = plan.scale**3 * dimensions.bone_volume_mm3(spec)
    floor = spec.body.floor_mm
    below_fill = drafted_prism(plan.top.grown(5.0), plan.depth_mm + floor, 0.0, -floor)
    bone = float(made.solid("carrier").intersect(below_fill).Volume())
    whole = made.solid("pad").Volume() + bone
    cover = plan.scale * (spec.pad.thickness_mm - spec.pad.shape.bone_height_mm)
    lowest = made.solid("carrier").BoundingBox().zmin
    filled = made.cavity.Volume()
    return [
        below("bone_volume", abs(bone / exact - 1), VOLUME_REL, "carrier below the fill plane, against its formula"),
        below("gel_and_bone", abs(whole / filled - 1), VOLUME_REL, "together against the cavity"),
        below("bone_cover", abs(lowest - cover), HEIGHT_MM, f"mm off the cover of {cover:.3f} mm under the bone"),
    ]


def _layers(made: Parts) -> list[Check]:
    """Both layers are the cavity, the first has its closed form, and the spacer ends where it does."""
    plan, spacer = made.plan, made.solid("spacer")
    top, base = (made.parts[name].volume_mm3 for name in ("layer_top", "layer_base"))
    exact, _ = dimensions.layer_volumes_mm3(made.spec)
    common = release.common_volume_mm3(spacer, made.solid("layer_top"))
    dip = spacer.BoundingBox().zmin
    return [
        below("layers_fill_cavity", abs((top + base) / made.cavity.Volume() - 1), VOLUME_REL),
        below("layer_closed_form", abs(top / exact - 1), VOLUME_REL, "layer poured first, by Steiner and Pappus"),
        below("interference_spacer_layer_top", common, INTERFERENCE_MM3, "mm3"),
        below("spacer_height", abs(dip - plan.interface_mm), HEIGHT_MM, "mm off the interface, seated on the land"),
    ]
