"""What a shape changes in the workshop: lines of the pour sheet. No CAD."""

from __future__ import annotations

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.model.volumes import bone_volume_mm3
from dummydesign.mold.pour.plan import PourPlan
from dummydesign.mold.pour.steps import BLANK, CLOSE, DEGAS, GEL, MIX, POUR, WAIT, Step


def plug_finish(spec: MouldSpec) -> str:
    """How the face that forms the tested face is made smooth."""
    pad, sheet = spec.pad, spec.box.face_sheet_mm
    where = "floor of the base" if spec.is_printed else "plug's top"
    if sheet:
        return (
            f"The tested face is the sheet of {sheet:g} mm (drawing face_sheet): gauge it first, another thickness is "
            f"another face_sheet_mm (really: {BLANK} mm). Bond it into the pocket with a film of "
            f"{spec.box.sheet_bond_mm:g} mm, weighed down on a flat plate so that it ends flush with the {where} "
            f"(step really: {BLANK} mm), and fill the gap around it."
        )
    if not pad.shape.relief_mm:
        return (
            f"The {where} becomes the tested face: sand it, or have a sheet of glass let in (face_sheet_mm)."
        )
    layer = formula.print_layer_mm(pad.shape.relief_mm)
    return (
        f"The {where} becomes the tested face and is curved: layers of at most {layer:.2g} mm there, then "
        "sand with a soft pad or coat it; measure its height over the flat with a dial gauge."
    )


def shape_mark(spec: MouldSpec) -> str:
    """One line on the shape for sheet and drawing, empty for a slab."""
    mark = spec.pad.shape.mark(spec.pad, layout(spec).scale)
    return mark if spec.insert is None else f"bone from {spec.insert.file}; for the model {mark}"


def by_difference(plan: PourPlan, why: str, count: int = 1) -> str:
    """How a mass is poured into a mould that stays where it is level, or into each of its cavities.

    Parameters
    ----------
    plan : PourPlan
        The mass.
    why : str
        What it is reckoned from, in words.
    count : int
        Cavities of the mould.
    """
    if count > 1:
        return (
            f"Fill the {count} cavities one after the other, each by difference: put the cup on the balance and tare "
            f"it, pour in a thin stream into one corner, put the cup back and stop at -{plan.fill_mass_g:.1f} g "
            f"({why}). The mould stays where it is. Poured: {' '.join([BLANK] * count)} g"
        )
    return (
        f"Put the cup on the balance and tare it. Pour in a thin stream into one corner and put the cup back: the "
        f"balance shows what has left it. Stop at -{plan.fill_mass_g:.1f} g ({why}). The mould stays where it is. "
        f"Poured: {BLANK} g"
    )


def first_layer_steps(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    """From the first pour of a layered pad to the moment of the second."""
    pour, under = spec.pour, plan.base
    texts = [
        f"UPPER LAYER FIRST (it forms the tested face). "
        f"{by_difference(plan, f'{plan.gram_per_mm_g:.1f} g make one millimetre')} at: {BLANK}",
        f"Prick bubbles, wait {max(30.0, plan.pour_time_s):.0f} s. Lay release film on the spacer, set it down on one "
        "edge and lower it like a hinge until it rests on the land; what is too much comes up in the gap. Without a "
        "spacer the layer is as even as the mould is level.",
        f"Let it gel where it stands, {_where(spec)}; not before its pot life of {pour.pot_life_min:g} min is over "
        f"lift the spacer on one edge. Gelled at: {BLANK}",
        "BASE LAYER SECOND, while the first is tacky: weigh, mix and degas it only now, as the first (ratio "
        f"{spec.base.pour.ratio:.4g}). The surface must be free of film, dust and release agent. "
        f"{by_difference(under, 'up to the step of the brim')} at: {BLANK}",
    ]
    acts = ((POUR,), (WAIT, CLOSE), (GEL,), (MIX, DEGAS, POUR))
    return [Step(text, act) for text, act in zip(texts, acts)]


def before_mixing(spec: MouldSpec) -> list[Step]:
    """What is done before the resin is opened."""
    if not spec.pad.shape.bone_height_mm:
        return []
    return [
        Step(
            "Roughen or drill the bone and the underside of its plate (keys), clean, prime them for this resin and let "
            "the primer dry: what is neither keyed nor primed peels off the gel. No release agent here. Lower the "
            "carrier into the empty mould once: it must sit on the land all round."
        ),
    ]


def carrier_steps(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    """How the bone gets into the resin."""
    bone = bone_volume_mm3(spec) * 1e-3
    why = f"the bone displaces {bone:.1f} cm3, so the resin stands below the step of the brim"
    texts = [
        by_difference(plan, why),
        "Wet bone and plate with resin. Set the plate down on one edge and lower it like a hinge, slowly, until it "
        "rests on the land and every vent shows resin; top up through a vent. Clamp it or weigh it down: it must not "
        f"float. Seated all round: {BLANK}",
    ]
    return [Step(text, act) for text, act in zip(texts, ((POUR,), (CLOSE,)))]


def demould_first(spec: MouldSpec) -> str:
    """Where the pad goes when the mould is off."""
    if spec.pad.shape.bone_height_mm:
        return (
            "The pad stays on its plate for good: lift both, cut the stems in the vents and the rim flush, and screw "
            "the plate to the base of the test rig through its four corner holes."
        )
    if len(spec.pad.shape.places_mm) > 1:
        return (
            "Slide the pad on release film onto a flat board, then glue it by its free face to the middle of the "
            "carrier (drawing carrier): its grooves point at the tips, the punch is set down where the lines cross. "
            "No silicone spray on the face that is tested."
        )
    return "Slide the pad on release film onto a flat board. No silicone spray on the face that is tested."


def _where(spec: MouldSpec) -> str:
    pour = spec.pour
    if pour.cures_warm:
        return f"at {pour.cure_temperature_C:g} C in the vented oven"
    return "at room temperature"
