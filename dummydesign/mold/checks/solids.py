"""Checks of the solids: each measures something on what was built and compares it with a limit. CAD child only."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dummydesign.mold.cad.casting_box import to_casting
from dummydesign.mold.cad.parts import CORE_MM, Parts
from dummydesign.mold.cad.prisms import drafted_prism, rough_bounds
from dummydesign.mold.checks import release as demould
from dummydesign.mold.checks.label import check_label
from dummydesign.mold.checks.result import Check, above, below, equal
from dummydesign.mold.model import volumes as contents
from dummydesign.mold.model.spec import MouldSpec

VOLUME_REL, INTERFERENCE_MM3, SILICONE_REL, DRAFT_SLACK_DEG = 1e-9, 0.01, 2e-4, 0.01
APART_MM = 0.8


def check_solids(made: Parts, meshes: Mapping[str, Any] | None = None) -> list[Check]:
    """Check all solids: validity, volumes, interference, silicone in the box, draft, sweep, features, label.

    ``meshes`` are those that :func:`~dummydesign.mold.checks.label.check_label` reads the label from.
    """
    found = [*check_validity(made), *check_volumes(made), *check_interference(made), *check_boxes(made)]
    found += [*check_drafts(made), _sweep(made), *check_distances(made), *check_label(made, meshes), *check_sheet(made)]
    if made.spec.body.style == "lidded":
        found.append(lid_one_way(made.solid("lid"), made.solid("mould")))
    return found


def check_validity(made: Parts) -> list[Check]:
    """Each part is one valid solid with one closed shell."""
    bad = []
    for name, part in made.parts.items():
        shape = part.solid
        closed = all(shell.Closed() for shell in shape.Shells())
        if len(shape.Solids()) != 1 or len(shape.Shells()) != 1 or not shape.isValid() or not closed:
            bad.append(name)
    return [equal("solids_valid", len(made.parts) - len(bad), len(made.parts), ", ".join(bad))]


def check_volumes(made: Parts) -> list[Check]:
    """Cavity against what fills it, compensated pad against nominal pad, and the pad against its closed form."""
    spec, plan, pad = made.spec, made.plan, made.solid("pad")
    nominal = made.pad_nominal.Volume()
    low = drafted_prism(plan.fill_outline.grown(CORE_MM), plan.depth_mm + spec.body.floor_mm, 0.0, -spec.body.floor_mm)
    cavities = [one.cut(made.core).Volume() for one in plan.at_places(low)]
    filled = made.cavity.Volume()
    what = "against pad" if made.with_bone is None else "against pad and bone"
    off = max(abs(one / filled - 1) for one in cavities)
    exact = contents.resin_volume_mm3(spec, plan)
    return [
        below("cavity_volume", off, VOLUME_REL, f"cavity to the fill plane {what}"),
        below("compensation", abs(pad.Volume() / (nominal * plan.scale**3) - 1), VOLUME_REL),
        below("closed_form", abs(pad.Volume() / exact - 1), VOLUME_REL, _closed_form(spec)),
    ]


def _closed_form(spec: MouldSpec) -> str:
    if spec.insert is not None:
        return "drafted slab by Steiner and Pappus, less the placed bone as measured"
    return "drafted slab by Steiner and Pappus" + spec.pad.shape.closed_form


def check_interference(made: Parts) -> list[Check]:
    """Parts that touch in use or in the casting box must not overlap."""
    pairs = [("mould", "pad"), ("master", "frame"), ("tray", "mould"), ("lid", "mould"), ("lid", "pad")]
    pairs += [("backer", "lid"), ("lid_master", "lid_frame"), ("strike_off", "mould"), ("strike_off", "pad")]
    pairs += [("collar", "mould"), ("spacer", "mould"), ("carrier", "mould"), ("carrier", "pad")]
    pairs += [("face_sheet", "master")]
    if made.spec.is_printed:
        # Here the ring stands where it is used; a silicone mould's frame stands in its casting box.
        pairs += [("frame", "mould"), ("frame", "pad"), ("strike_off", "frame"), ("carrier", "frame")]
        pairs += [("spacer", "frame"), ("face_sheet", "mould"), ("face_sheet", "pad")]
    found = []
    for one, other in pairs:
        if one in made.parts and other in made.parts:
            common = demould.common_volume_mm3(_met(made, one, other), _met(made, other, one))
            found.append(below(f"interference_{one}_{other}", common, INTERFERENCE_MM3, "mm3"))
    return found


def _met(made: Parts, name: str, other: str) -> Any:
    """Solid of a part, of a mould all that the other part can touch: what lies in its cavities meets its core alone."""
    return made.core if (name, other) == ("mould", "pad") and made.whole is None else made.solid(name)


def check_boxes(made: Parts) -> list[Check]:
    """The silicone a casting box holds is the part scaled by the silicone's shrinkage, and the box is empty of it."""
    spec, plan = made.spec, made.plan
    found = []
    boxes = [] if spec.is_printed else [("mould", "master", "frame", made.solid("mould"), plan.land_mm, True)]
    if "lid" in made.parts:
        whole = made.solid("lid").fuse(*[tool.intersect(made.tools["lid_hull"][0]) for tool in _funnels(made)])
        boxes.append(("lid", "lid_master", "lid_frame", whole, plan.land_mm, False))
    for name, master, frame, part, parting, turned in boxes:
        cast = to_casting(part, parting, turned, plan.silicone_scale)
        box = cast.BoundingBox()
        # From the bottom of the base plate to the fill mark, outside half-way into the frame's wall.
        room = drafted_prism(
            plan.top.scaled(plan.silicone_scale).grown(spec.box.frame_wall_mm / 2), box.zmax + spec.box.base_mm, 0.0,
            -spec.box.base_mm,
        )  # fmt: skip
        held = room.cut(_without_pocket(made) if name == "mould" else made.solid(master), made.solid(frame))
        # Bolt holes and pin sockets are no room for silicone: keep what the poured block is connected to.
        volume = max(solid.Volume() for solid in held.Solids())
        if name == "lid":
            volume -= sum(tool.Volume() for tool in made.tools.get("sockets", []))
        found.append(below(f"silicone_in_box_{name}", abs(volume / cast.Volume() - 1), SILICONE_REL))
        overlap = demould.common_volume_mm3(made.solid(master), cast)
        found.append(below(f"interference_{master}_{name}", overlap, INTERFERENCE_MM3, "mm3"))
    return found


def _without_pocket(made: Parts) -> Any:
    """The master with its sheet bonded in, as silicone and pad see it."""
    return made.solid("master").fuse(*made.tools["face_recess"]).clean() if "face_sheet" in made.parts else made.solid(
        "master"
    )


def _funnels(made: Parts) -> list[Any]:
    return [*made.tools.get("sprue", []), *made.tools.get("vents", [])]


def cavity_draft_deg(mould: Any, made: Parts) -> float:
    """Smallest draft of a mould's cavity faces, pulled along +z. [deg]"""
    plan = made.plan
    return demould.minimum_draft_deg(demould.faces_within(mould, plan.openings, -0.01, plan.land_mm))


def check_drafts(made: Parts) -> list[Check]:
    """Draft of cavity, of the plug it is cast on and of the frame, each in its direction of pull."""
    spec, plan, grow = made.spec, made.plan, made.plan.silicone_scale
    outer = spec.body.outer_draft_deg
    found = [above("draft_cavity", cavity_draft_deg(made.core, made), spec.pad.draft_deg - DRAFT_SLACK_DEG)]
    if spec.is_printed:
        return found
    high = plan.height_mm * grow
    plug = demould.faces_within(_without_pocket(made), plan.openings.scaled(grow), 0.0, high)
    found.append(above("draft_plug", demould.minimum_draft_deg(plug), spec.pad.draft_deg - DRAFT_SLACK_DEG))
    frames = [("frame", high)]
    if "lid_frame" in made.parts:
        frames.append(("lid_frame", spec.closure.lid_mm * grow))
    for name, top in frames:
        inner = demould.faces_within(made.solid(name), plan.top.scaled(grow), 0.0, top)
        found.append(above(f"draft_{name}", demould.minimum_draft_deg(inner, -1.0), outer - DRAFT_SLACK_DEG))
    return found


def check_sheet(made: Parts) -> list[Check]:
    """The sheet that is the tested face ends flush with the plug's top, and lies over its bond in the pocket."""
    if "face_sheet" not in made.parts:
        return []
    sheet, box, printed = made.solid("face_sheet"), made.spec.box, made.spec.is_printed
    top = 0.0 if printed else rough_bounds(_without_pocket(made))[5]
    apart = abs(rough_bounds(sheet)[5] - top)
    bed = made.solid("mould" if printed else "master").distance(sheet.translate((0, 0, -box.sheet_bond_mm)))
    return [below("face_sheet_flush", apart, 1e-5, "mm off the face around it"),
            below("face_sheet_seated", bed, 1e-5, "mm from the pocket's floor, its bond taken away")]  # fmt: skip


def sweep_offsets_mm(depth_mm: float) -> list[float]:
    """Offsets of the swept pull: small ones too, where a lip bites most."""
    return [0.1, 0.5, *(depth_mm * share for share in (0.1, 0.25, 0.5, 0.75))]


def _sweep(made: Parts) -> Check:
    offsets = sweep_offsets_mm(made.plan.depth_mm)
    worst = max(demould.sweep_interference_mm3(pad, made.core, offsets) for pad in made.cavities)
    return below("sweep_cavity", worst, INTERFERENCE_MM3, "mm3, pad pulled straight out at six offsets")


def lid_one_way(lid: Any, mould: Any) -> Check:
    """The lid turned round by 180 degrees must collide with the mould."""
    import cadquery as cq

    turned = lid.rotate(cq.Vector(), cq.Vector(0, 0, 1), 180)
    common = demould.common_volume_mm3(turned, mould)
    return above("lid_one_way", common, 50.0, "mm3 of collision when the lid is turned round")


def check_distances(made: Parts) -> list[Check]:
    """Key, gutter, label, sprue and vents keep apart; the gutter keeps off the cavity."""
    import cadquery as cq

    tools = {name: made.tools.get(name, []) for name in ("keys", "gutter", "label", "sprue", "vents")}
    flat = [(name, tool) for name, group in tools.items() for tool in group]
    if not flat:
        return []
    pairs = [
        (f"{name} and {other_name}", tool, other)
        for i, (name, tool) in enumerate(flat)
        for other_name, other in flat[i + 1 :]
        if not name == other_name == "label"
    ]
    least, where = _nearest(pairs)
    found = [above("features_apart", least, APART_MM, f"mm, nearest: {where}")] if where else []
    if tools["gutter"]:
        c = made.spec.closure
        gap = made.solid("pad").distance(tools["gutter"][0])
        found.append(above("gutter_to_cavity", gap, c.gutter_distance_mm - c.gutter_radius_mm - 1e-3, "mm"))
    if tools["label"]:
        near = made.solid("pad").distance(cq.Compound.makeCompound(tools["label"]))
        found.append(above("label_to_pad", near, APART_MM, "mm"))
    return found


def _nearest(pairs: list[tuple[str, Any, Any]]) -> tuple[float, str]:
    """Least distance of named pairs, and whose it is; pairs whose boxes are further apart are not measured. [mm]"""
    least, where = math.inf, ""
    gaps = [(_box_gap_mm(tool, other), name, tool, other) for name, tool, other in pairs]
    for gap, name, tool, other in sorted(gaps, key=lambda pair: pair[0]):
        if gap >= least:
            break
        distance = tool.distance(other)
        if distance < least:
            least, where = distance, name
    return least, where


def _box_gap_mm(one: Any, other: Any) -> float:
    """Distance of two bounding boxes, a lower bound of the distance of what is in them. [mm]"""
    a, b = rough_bounds(one), rough_bounds(other)
    return math.hypot(*(max(0.0, a[axis] - b[axis + 3], b[axis] - a[axis + 3]) for axis in range(3)))
