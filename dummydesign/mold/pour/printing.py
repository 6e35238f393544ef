"""Printed parts: layers, fit, surface and release."""

from __future__ import annotations

from dummydesign.core.errors import InputError
from dummydesign.geometry.shape_registry import make_shape
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import layout, plug_top_mm
from dummydesign.mold.model.printed_parts import lying_words
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import MOST_PERCENT, change_percent, crown_limits, force_change_percent
from dummydesign.mold.pour.steps import BLANK

ALLOWED_PERCENT = 1.0
PROBED_MM = 0.05
# Layers that slicers offer, the thickest first.
LAYERS_MM = (0.3, 0.25, 0.2, 0.15, 0.12, 0.1, 0.08, 0.06, 0.05)


def height_cost(spec: MouldSpec, low_mm: float) -> float | None:
    """Change of the force when a curve or a bone is lower than designed, its apex radius and foot kept. [%]

    At a quarter of the thickness from touch, glued, under a square punch of 14 mm, by the shape's response table.
    """
    pad, shape = spec.pad, spec.pad.shape
    if not (shape.relief_mm or shape.bone_height_mm):
        return 0.0
    lower = tuple((name, round(value - low_mm, 9) if name == "height" else value) for name, value in shape.parameters)
    try:
        made = make_shape(pad.kind, lower)
    except InputError:
        return None
    # A low crown makes the pad thinner, a low bone leaves more gel over it.
    return change_percent(pad, made, pad.thickness_mm - (low_mm if shape.relief_mm else 0.0))


def allowed_layer_mm(spec: MouldSpec) -> float | None:
    """Thickest layer whose half, by which a tip may be too low, changes the force by 1 %. [mm]

    By the cost of 0.05 mm, to which it is proportional within a few per cent; None for a flat face, and where the cost
    is not known.
    """
    cost = height_cost(spec, PROBED_MM)
    return 2 * PROBED_MM * ALLOWED_PERCENT / abs(cost) if cost else None


def printed_thickness_mm(spec: MouldSpec, layer_mm: float) -> float:
    """Thickness of the pad when every height of the prints is rounded to a whole number of layers. [mm]

    The plug stands on the base plate; in an open mould a plate dips from its underside to the fill plane. A sheet let
    into the plug keeps its thickness, its pocket's floor is rounded.
    """
    plan, box, aids = layout(spec), spec.box, spec.aids

    def printed(height: float) -> float:
        return layer_mm * round(height / layer_mm)

    sheet = box.face_sheet_mm + box.sheet_bond_mm if box.face_sheet_mm else 0.0
    plug = printed(box.base_mm + plug_top_mm(plan) - sheet) + sheet - printed(box.base_mm)
    dip = printed(aids.plate_mm + spec.body.freeboard_mm) - printed(aids.plate_mm)
    return (plug / plan.silicone_scale - dip) / plan.scale


def rounding_cost(spec: MouldSpec, layer_mm: float) -> float | None:
    """Change of the force at a given depth for :func:`printed_thickness_mm`; None where that is not known. [%]"""
    if abs(share := printed_thickness_mm(spec, layer_mm) / spec.pad.thickness_mm - 1) < 1e-9:
        return 0.0
    return force_change_percent(spec, 1 + share)


def layer_words(spec: MouldSpec) -> str:
    """What whole layers make of the thickness, and so of the force; empty where the printer's layer is not said."""
    layer = spec.machines.layer_mm
    if not layer:
        return ""
    cost = rounding_cost(spec, layer)
    force = "" if cost is None else f", {cost:+.1f} % of force at a given depth"
    return f"whole layers of {layer:g} mm make the pad {printed_thickness_mm(spec, layer):.3f} mm thick{force}"


def check_layers(spec: MouldSpec) -> None:
    """Refuse a printer whose layers are too thick for a curve, or do not meet the heights of the mould."""
    layer, allowed = spec.machines.layer_mm, allowed_layer_mm(spec)
    if layer and allowed is not None and layer > allowed:
        raise InputError(
            f"layer_mm = {layer:g} of machines '{spec.machines.name}' may leave the tip of {spec.pad.shape} half a "
            f"layer low, {ALLOWED_PERCENT * layer / allowed:.1f} % of force; allowed is up to {allowed:.3f} mm "
            f"for {ALLOWED_PERCENT:g} %: machine the master or take a higher, flatter curve",
            "out_of_range",
            "layer_mm",
            layer,
            (0, allowed),
        )
    cost = rounding_cost(spec, layer) if layer else 0.0
    if cost is not None and abs(cost) > ALLOWED_PERCENT:
        good = [one for one in LAYERS_MM if one < layer and abs(rounding_cost(spec, one) or 0.0) <= ALLOWED_PERCENT]
        finer = f"layers of {good[0]:g} mm do" if good else "machine the master"
        raise InputError(
            f"layer_mm = {layer:g} of machines '{spec.machines.name}': {layer_words(spec)}; allowed is "
            f"{ALLOWED_PERCENT:g} %: {finer}, or take a thickness near {printed_thickness_mm(spec, layer):.2f} mm",
            "out_of_range",
            "layer_mm",
            layer,
        )


def tip_words(spec: MouldSpec) -> str:
    """How true a curve's height must be, and what the advised layers cost; empty where that is not known."""
    if (allowed := allowed_layer_mm(spec)) is None:
        return ""
    tall = max(spec.pad.shape.relief_mm, spec.pad.shape.bone_height_mm)
    layer = spec.machines.layer_mm or formula.print_layer_mm(tall)
    return (
        f"{allowed / 2:.3f} mm of its height change the force by {ALLOWED_PERCENT:g} %, layers of {layer:.2g} mm "
        f"by up to {ALLOWED_PERCENT * layer / allowed:.1f} %"
    )


def height_words(spec: MouldSpec) -> str:
    """The height over the flat to gauge on the printed face, with its limits, as it is measured and written down."""
    limits = crown_limits(spec.pad, spec.acceptance.thickness_percent)
    if limits is None:
        return f"Height over the flat: {BLANK} mm."
    grow = face_factor(spec)
    low, high = (grow * one for one in limits.height_mm)
    return (
        f"Height over the flat: {grow * spec.pad.shape.relief_mm:.2f} mm, {low:.2f} to {high:.2f} mm allowed "
        f"({MOST_PERCENT:g} % of force); measured: {BLANK} mm."
    )


def face_factor(spec: MouldSpec) -> float:
    """Length of the printed face that shapes the tested face over that of the pad."""
    plan = layout(spec)
    return plan.scale * (1.0 if spec.is_printed else plan.silicone_scale)


def print_words(spec: MouldSpec) -> str:
    """How the parts lie on the bed; elephant's foot, shrinkage and gap of the machine's prints, where known."""
    fit, sentences = spec.machines.fit, [lying_words(spec)]
    if fit is not None:
        foot = f"take {fit.elephant_foot_mm:g} mm off the first layer (elephant's foot compensation)"
        size = "print a bar of 150 mm, measure it and let the slicer compensate the shrinkage"
        if fit.shrinkage_percent:
            size = f"switch shrinkage compensation off: STL and 3MF are enlarged by {fit.shrinkage_percent:g} %"
        gap = f"Clearance of fitting parts: {fit.gap_per_side_mm:g} mm per side."
        sentences.append(f"In the slicer {foot}; {size}. {gap}")
    if words := layer_words(spec):
        sentences.append(f"{words[0].upper()}{words[1:]}.")
    return f" {' '.join(sentences)}"


def release_words(spec: MouldSpec) -> str:
    """The warning: plastic does not let go by itself."""
    assert spec.surface is not None
    chemistry = spec.pour.chemistry
    bonds = f"{chemistry or spec.pour.resin} may bond to plastic"
    if chemistry == "polyurethane" or spec.pour.has_isocyanate:
        bonds = "polyurethane bonds to plastic"
    elif "silicone" in chemistry:
        bonds = "some prints inhibit the cure of silicone, which does not bond to plastic but grips its valleys"
    return (
        f"a printed mould is rigid and {bonds}: finish the faces to valleys of at most "
        f"{spec.surface.depth_mm:g} mm, wax them, lay on a film of PVA, and try a scrap of print and resin first"
    )


def mould_steps(spec: MouldSpec, plastic: str, face: str) -> tuple[str, ...]:
    """From the printer to the empty mould."""
    assert spec.surface is not None
    return (
        f"Print base and ring solid where resin touches ({plastic}; 6 perimeters), "
        f"and the plates. {face}{print_words(spec)}",
        f"Fill and sand floor and walls until no valley is deeper than {spec.surface.depth_mm:g} mm (gauge a "
        f"scrap), 400 grit last; the walls' draft of {spec.pad.draft_deg:g} deg releases no "
        f"deeper ones. Measured: {BLANK}",
        "Test on a scrap of the same print, finished and released alike: resin must cure without a tacky border and "
        f"lift off by hand. Lifted off: {BLANK}",
        "Wax base and ring, polish, twice; then a thin film of PVA, dried. No silicone spray on the floor: it is the "
        "tested face.",
        "Put the ring on the base by its two pins (it goes on in one way) and draw the bolts up crosswise, with a bead "
        "of wax or plasticine around the joint from outside: the joint must hold the resin.",
    )


def demould_steps(spec: MouldSpec) -> tuple[str, ...]:
    """How the pad is taken out of a soft mould, or of a rigid one."""
    pad = spec.pad
    hold = formula.suction_force_N(pad.length_mm * pad.width_mm)
    peel = formula.peel_force_N(min(pad.length_mm, pad.width_mm), 5.0)
    if not spec.is_printed:
        return (
            f"Never pull it straight: air pressure alone can hold {hold:.0f} N on the sealed face. Peel a corner "
            "of the mould's wall outwards, let air in, and roll the mould off the pad "
            f"(about {peel:.1f} N at 5 J/m2).",
        )
    return (
        f"Never pull the pad out of the ring: air pressure alone can hold {hold:.0f} N on the sealed face. Turn the "
        "mould over onto release film on a flat board and take the bolts out.",
        f"Lift the base on one edge with wedges in the joint and let air in along it (about {peel:.1f} N at 5 J/m2); a "
        "little water dissolves the PVA from the edge.",
        "Lift the ring straight up: its walls open towards the board. Wash the PVA off with water, dry the pad.",
    )
