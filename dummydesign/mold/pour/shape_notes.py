"""What a shape changes in the workshop: lines of the pour sheet. No CAD."""

from __future__ import annotations

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec, PadGeometry
from dummydesign.mold.pour.plan import PourPlan

BLANK = "________"


def plug_finish(pad: PadGeometry) -> str:
    """How the face that forms the tested face is made smooth."""
    if not pad.shape.relief_mm:
        return (
            "The top of the plug becomes the tested face: sand it, or bond a sheet of glass or acrylic of known "
            "thickness in its place."
        )
    layer = formula.print_layer_mm(pad.shape.relief_mm)
    return (
        f"The top of the plug becomes the tested face and is curved: layers of at most {layer:.2g} mm there, then "
        "sand with a soft pad or coat it; measure its height over the flat with a dial gauge."
    )


def shape_mark(spec: MouldSpec) -> str:
    """One line on the shape for sheet and drawing, empty for a slab."""
    return spec.pad.shape.mark(spec.pad, layout(spec).scale)


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
    if not spec.pad.shape.bone_height_mm:
        return []
    return [
        "Roughen or drill the bone and the underside of its plate (keys), clean, prime them for this resin and let the "
        "primer dry: what is neither keyed nor primed peels off the gel. No release agent here. Lower the carrier into "
        "the empty mould once: it must sit on the land all round.",
    ]


def carrier_steps(spec: MouldSpec, plan: PourPlan) -> list[str]:
    """How the bone gets into the resin."""
    bone = spec.pad.shape.bone_volume_mm3(spec.pad) * 1e-3
    return [
        f"Stand the mould on the balance, tare it, pour and stop at {plan.fill_mass_g:.1f} g: the bone displaces "
        f"{bone:.1f} cm3, so the resin stands below the step of the brim. Poured: {BLANK} g",
        "Wet bone and plate with resin. Set the plate down on one edge and lower it like a hinge, slowly, until it "
        "rests on the land and every vent shows resin; top up through a vent. Clamp it or weigh it down: it must not "
        f"float. Seated all round: {BLANK}",
    ]


def demould_first(spec: MouldSpec) -> str:
    """Where the pad goes when the mould is off."""
    if spec.pad.shape.bone_height_mm:
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
