"""What a shape changes in the workshop: warnings and lines of the pour sheet. No CAD."""

from __future__ import annotations

from dummydesign.geometry.shapes import Boned, Bumped, Crowned, Layered
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model import volumes as contents
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec, PadGeometry
from dummydesign.mold.pour.plan import CARRIER_VENTS, PourPlan

BLANK = "________"
# A base further than this from the shape's modulus ratio is worth a word.
RATIO_APART = 0.02


def shape_warnings(spec: MouldSpec) -> list[tuple[str, str]]:
    """Say what may go wrong with this shape, as (code, message)."""
    pad, shape = spec.pad, spec.pad.shape
    found = []
    if isinstance(shape, Crowned | Bumped):
        layer = formula.print_layer_mm(shape.height_mm)
        flat = formula.tip_flat_mm(shape.radius_mm, layer)
        found.append(
            (
                "curved_master",
                f"the plug's top is curved: print it in layers of at most {layer:.2g} mm (they leave a flat of "
                f"{flat:.1f} mm at a tip of radius {shape.radius_mm:g} mm), sand or coat the steps, or machine it",
            )
        )
        found.append(
            (
                "thickness_varies",
                f"the pad is {pad.thickness_mm:g} mm thick at its highest point and {pad.least_gel_mm:g} mm beside it: "
                "pour by mass, not by depth",
            )
        )
    if isinstance(shape, Bumped):
        count = len(shape.caps_mm())
        found.append(
            (
                "air_pockets",
                f"the {count} pockets in the floor keep air: brush a thin coat of resin into them first, or draw a "
                "vacuum on the filled mould",
            )
        )
    if isinstance(shape, Boned):
        found.append(
            (
                "bone_air",
                f"the plate shuts the mould: lower it tilted, one edge first, until all {CARRIER_VENTS} vents show "
                "resin",
            )
        )
        if shape.bar:
            gap = contents.BAR_END_GAP_MM
            found.append(("bar_ends", f"the bar ends {gap:g} mm before the walls: a film of gel covers its ends"))
    if isinstance(shape, Layered):
        found += _layer_warnings(spec, shape)
    return found


def _layer_warnings(spec: MouldSpec, shape: Layered) -> list[tuple[str, str]]:
    found = [
        (
            "layer_bond",
            "the layers bond only while the first is gelled and still tacky: a finger in a glove sticks but draws no "
            "resin; try it on the witness of this batch, not on the pad",
        )
    ]
    made = spec.base.modulus_ratio
    if abs(made / shape.modulus_ratio - 1) > RATIO_APART:
        found.append(
            (
                "modulus_ratio",
                f"base ratio {spec.base.pour.ratio:g} gives a base of {made:.3g} times the upper modulus, the shape "
                f"says {shape.modulus_ratio:g}",
            )
        )
    return found


def plug_finish(pad: PadGeometry) -> str:
    """How the face that forms the tested face is made smooth."""
    if pad.shape.flat_top:
        return (
            "The top of the plug becomes the tested face: sand it, or bond a sheet of glass or acrylic of known "
            "thickness in its place."
        )
    layer = formula.print_layer_mm(pad.shape.height_mm)
    return (
        f"The top of the plug becomes the tested face and is curved: layers of at most {layer:.2g} mm there, then "
        "sand with a soft pad or coat it; measure its height over the flat with a dial gauge."
    )


def shape_mark(spec: MouldSpec) -> str:
    """One line on the shape for sheet and drawing, empty for a slab."""
    pad, shape, plan = spec.pad, spec.pad.shape, layout(spec)
    if isinstance(shape, Crowned):
        what = "ridge along the length" if shape.ridge else "crown"
        return (
            f"{what}: tip radius {shape.radius_mm:g}, height {shape.height_mm:g}, foot at {shape.foot_mm:.4g} mm from "
            f"the middle{'; edges of the tested face stay sharp' if shape.ridge else ''}"
        )
    if isinstance(shape, Bumped):
        lower = f", lower by {shape.grade_mm:g} (i2 + j2)" if shape.grade_mm else ""
        return (
            f"{len(shape.caps_mm())} caps of radius {shape.radius_mm:g}, height {shape.height_mm:g}{lower}, "
            f"pitch {shape.pitch_mm:g} mm"
        )
    if isinstance(shape, Layered):
        return (
            f"upper layer {shape.top_mm:g} mm (cavity {plan.interface_mm:.3f}), base "
            f"{pad.thickness_mm - shape.top_mm:g} mm of {shape.modulus_ratio:g} times its modulus"
        )
    if isinstance(shape, Boned):
        what = "bar along the length" if shape.bar else "dome"
        return (
            f"bone, a {what}: tip radius {shape.radius_mm:g}, height {shape.height_mm:g}, foot at {shape.foot_mm:.4g} "
            f"mm; {pad.least_gel_mm:g} mm of gel over it"
        )
    return ""


def first_layer_steps(spec: MouldSpec, plan: PourPlan) -> list[str]:
    """From the first pour of a layered pad to the moment of the second."""
    pour, under = spec.pour, plan.base
    return [
        f"UPPER LAYER FIRST (it forms the tested face): with the mould on the balance pour and stop at "
        f"{plan.fill_mass_g:.1f} g ({plan.gram_per_mm_g:.1f} g make one millimetre). Poured: {BLANK} g at: {BLANK}",
        f"Prick bubbles, wait {max(30.0, plan.pour_time_s):.0f} s. Lay release film on the spacer, set it down on one "
        "edge and lower it like a hinge until it rests on the land; what is too much comes up in the gap. Without a "
        "spacer the layer is as even as the mould is level.",
        f"Let it gel, level, {_where(spec)}; not before its pot life of {pour.pot_life_min:g} min is over lift the "
        f"spacer on one edge. Gelled at: {BLANK}",
        "BASE LAYER SECOND, while the first is tacky: weigh, mix and degas it only now, as the first (ratio "
        f"{spec.base.pour.ratio:.4g}). The surface must be free of film, dust and release agent. Stop at "
        f"{under.fill_mass_g:.1f} g. Poured: {BLANK} g at: {BLANK}",
    ]


def before_mixing(spec: MouldSpec) -> list[str]:
    """What is done before the resin is opened."""
    if not isinstance(spec.pad.shape, Boned):
        return []
    return [
        "Roughen or drill the bone and the underside of its plate (keys), clean, prime them for this resin and let the "
        "primer dry: what is neither keyed nor primed peels off the gel. No release agent here. Lower the carrier into "
        "the empty mould once: it must sit on the land all round.",
    ]


def carrier_steps(spec: MouldSpec, plan: PourPlan) -> list[str]:
    """How the bone gets into the resin."""
    bone = contents.bone_volume_mm3(spec.pad) * 1e-3
    return [
        f"Stand the mould on the balance, tare it, pour and stop at {plan.fill_mass_g:.1f} g: the bone displaces "
        f"{bone:.1f} cm3, so the resin stands below the step of the brim. Poured: {BLANK} g",
        "Wet bone and plate with resin. Set the plate down on one edge and lower it like a hinge, slowly, until it "
        "rests on the land and every vent shows resin; top up through a vent. Clamp it or weigh it down: it must not "
        f"float. Seated all round: {BLANK}",
    ]


def demould_first(spec: MouldSpec) -> str:
    """Where the pad goes when the mould is off."""
    if isinstance(spec.pad.shape, Boned):
        return (
            "The pad stays on its plate for good: lift both, cut the stems in the vents and the rim flush, and screw "
            "the plate to the base of the test rig through its four corner holes."
        )
    return "Slide the pad on release film onto a flat board. No silicone spray on the face that is tested."


def _where(spec: MouldSpec) -> str:
    pour = spec.pour
    if pour.cure_temperature_C > pour.room_temperature_C:
        return f"at {pour.cure_temperature_C:g} C"
    return "at room temperature"
