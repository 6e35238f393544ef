"""The steps of a pour in their order, and what a shape changes in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.layout import bone_volume_mm3, layout
from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.pour.plan import RISER_SPARE_MM, RISER_SPRUE_MM, RISER_VENT_MM, PourPlan

# What a step may do. A move is anything that disturbs the level: carrying, weighing the mould itself, tilting it.
PREPARE, LEVEL, MIX, DEGAS, POUR, WAIT, CLOSE, GEL, MOVE, CURE = (
    "prepare",
    "level",
    "mix",
    "degas",
    "pour",
    "wait",
    "close",
    "gel",
    "move",
    "cure",
)


# What is filled in by hand.
BLANK = "________"


@dataclass(frozen=True)
class PourStep:
    """One line of the sheet and what is done in it, in order."""

    text: str
    acts: tuple[str, ...] = (PREPARE,)


def order_faults(steps: Sequence[PourStep]) -> list[str]:
    """What is wrong with the order of a pour's steps, in words; empty when nothing is.

    Rules: the mould is level when resin starts to gel and nothing moves it in between; resin is degassed after it is
    mixed and before it gels; it is poured before the mould is closed; the cure comes last. Resin that has not
    gelled before gels in the cure.
    """
    acts = [act for step in steps for act in step.acts]
    faults: list[str] = []
    level = mixed = degassed = poured = False
    for act in acts:
        if act == LEVEL:
            level = True
        elif act == MOVE:
            level = False
        elif act == MIX:
            mixed, degassed, poured = True, False, False
        elif act == DEGAS:
            degassed = mixed
        elif act == POUR:
            if not mixed:
                faults.append("resin is poured that is not mixed")
            poured = True
        elif act == CLOSE and not poured:
            faults.append("the mould is closed before resin is poured")
        elif act == GEL or (act == CURE and mixed):
            if not level:
                faults.append("resin gels in a mould that is not level or was moved since")
            if not (poured and degassed):
                faults.append("resin gels that was not degassed and poured")
            mixed = False
    if not acts or acts[-1] != CURE:
        faults.append("the cure is not the last step")
    return faults


def plug_finish(spec: MouldSpec) -> str:
    """How the face that forms the tested face is made smooth."""
    pad, sheet = spec.pad, spec.box.face_sheet_mm
    where = "floor of the base" if spec.is_printed else "plug's top"
    if sheet:
        return (
            f"The tested face is the sheet of {sheet:g} mm (drawing face_sheet): gauge it first, another "
            f"thickness is another face_sheet_mm (measured: {BLANK} mm). Bond it into the pocket with a film of "
            f"{spec.box.sheet_bond_mm:g} mm, weighed down on a flat plate so that it ends flush with the {where} "
            f"(step measured: {BLANK} mm), and fill the gap around it."
        )
    if not pad.shape.relief_mm:
        return f"The {where} becomes the tested face: sand it, or have a sheet of glass let in (face_sheet_mm)."
    layer = formula.print_layer_mm(pad.shape.relief_mm)
    return (
        f"The {where} shapes the tested face and is curved. Print it in layers of at most {layer:.2g} mm, then "
        "sand it with a soft pad or coat it. Measure its height over the flat with a dial gauge."
    )


def shape_mark(spec: MouldSpec) -> str:
    """One line on the shape for sheet and drawing, empty for a slab."""
    return spec.pad.shape.mark(spec.pad, layout(spec).scale)


def by_difference(plan: PourPlan, why: str, count: int = 1) -> str:
    """How a mass is poured into a mould that stays where it is level, or into each of its cavities."""
    if count > 1:
        return (
            f"Fill the {count} cavities one after the other, each by difference: put the cup on the balance and tare "
            f"it, pour in a thin stream into one corner, put the cup back and stop at -{plan.fill_mass_g:.1f} g "
            f"({why}). Do not move the mould. Poured: {' '.join([BLANK] * count)} g"
        )
    return (
        "Put the cup on the balance and tare it. Pour in a thin stream into one corner and put the cup back: the "
        f"balance shows how much you poured. Stop at -{plan.fill_mass_g:.1f} g ({why}). Do not move the mould. "
        f"Poured: {BLANK} g"
    )


def _layer_steps(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    """From the first pour of a layered pad to the second."""
    assert spec.base is not None and plan.base is not None
    pour = spec.pour
    return [
        PourStep(
            "UPPER LAYER FIRST (it forms the tested face). "
            f"{by_difference(plan, f'{plan.gram_per_mm_g:.1f} g fill one millimetre')} at: {BLANK}",
            (POUR,),
        ),
        PourStep(
            f"Prick bubbles, wait {max(30.0, plan.pour_time_s):.0f} s. Lay release film on the spacer, set it down on "
            "one edge and lower it like a hinge until it rests on the land; excess comes up in the gap. "
            "Without a spacer the layer is as even as the mould is level.",
            (WAIT, CLOSE),
        ),
        PourStep(
            f"Let it gel where it stands, {pour.cure_place}; not before its pot life of {pour.pot_life_min:g} "
            f"min{pour.mark('pot_life_min')} is over "
            f"lift the spacer on one edge. Gelled at: {BLANK}",
            (GEL,),
        ),
        PourStep(
            "BASE LAYER SECOND, while the first is tacky: weigh, mix and degas it only now, as the first (ratio "
            f"{spec.base.pour.ratio:.4g}). The surface must be free of film, dust and release agent. "
            f"{by_difference(plan.base, 'up to the step of the brim')} at: {BLANK}",
            (MIX, DEGAS, POUR),
        ),
    ]


def _preparing_bone(spec: MouldSpec) -> list[PourStep]:
    if not spec.pad.shape.bone_height_mm:
        return []
    return [
        PourStep(
            "Roughen or drill the bone and the underside of its plate (keys), clean, prime them for this resin "
            "and let the primer dry: what is neither keyed nor primed peels off the gel. No release agent here. "
            "Lower the carrier into the empty mould once: it must sit on the land all round."
        )
    ]


def demould_first(spec: MouldSpec) -> str:
    """Where the pad goes when the mould is off."""
    if spec.pad.shape.bone_height_mm:
        return (
            "The pad stays on its plate for good: lift both, cut the stems in the vents and the rim flush, and "
            "screw the plate to the base of the test rig through its four corner holes."
        )
    if len(spec.pad.shape.places_mm) > 1:
        return (
            "Slide the pad on release film onto a flat board, then glue it by its free face to the middle of the "
            "carrier (drawing carrier): its grooves point at the tips, the punch is set down where the lines "
            "cross. No silicone spray on the face that is tested."
        )
    return "Slide the pad on release film onto a flat board. No silicone spray on the face that is tested."


VENTED_OVEN = "vented oven"
# Drying of a mould for a resin that water foams; silicone gives off what it took up within the hour.
DRYING_H = 1.0


def pour_steps(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    """From the empty mould to the end of the cure."""
    steps, in_cup = [*_drying(spec), *_preparing_bone(spec)], PourStep(degas_words(spec.pour), (DEGAS,))
    if spec.pour.degas == "mould":
        steps += [_mixing(spec), *_degas_in_mould(spec, plan), _levelling(spec, plan), *_closing(spec, plan)]
    elif spec.body.style != "lidded":
        steps += [_levelling(spec, plan), _mixing(spec), in_cup, *_filling(spec, plan)]
    else:
        steps += [*_closing_lid(spec, plan), _mixing(spec), in_cup, *_filling_lidded(plan)]
    latest = spec.pour.pot_life_min - max(2.0, plan.pour_time_s / 60)
    what = "All of this" if plan.base is None else "Each of the two pours"
    life = f"{spec.pour.pot_life_min:g} min{spec.pour.mark('pot_life_min')}"
    limit = f"{what} within {latest:.0f} min of mixing (pot life {life}). Done at: {BLANK}"
    return [*steps, PourStep(limit, (WAIT,)), _cure(spec, plan)]


def _site(spec: MouldSpec) -> str:
    if spec.pour.cures_cold:
        return "on the shelf of the refrigerator"
    return f"on the shelf of the {VENTED_OVEN}, switched off and open" if spec.pour.cures_warm else "on a firm bench"


def _drying(spec: MouldSpec) -> list[PourStep]:
    if not spec.pour.has_isocyanate:
        return []
    at = f"at {spec.pour.cure_temperature_C:g} C" if spec.pour.cures_warm or spec.is_printed else "at 60 C"
    wet = "plastic" if spec.is_printed else "silicone"
    return [
        PourStep(
            f"Dry the mould {DRYING_H:g} h {at} in a {VENTED_OVEN}: traces of release agent and resin give off "
            f"vapour. Water in the {wet} would foam the polyurethane. Let it cool below 40 C before you pour, "
            "else the pot life shortens.",
            (PREPARE, MOVE),
        )
    ]


def _levelling(spec: MouldSpec, plan: PourPlan) -> PourStep:
    load = spec.count * plan.fill_mass_g + (plan.base.fill_mass_g if plan.base else 0.0)
    cavity = "cavity" if spec.count == 1 else "cavities"
    under = f"with a weight of about {load:.0f} g on a clean film in the {cavity} in place of the resin. Take it out"
    if spec.pour.degas == "mould":
        under = "at once, with the resin in it"
    carried, stay = ("the mould", "it stays") if spec.is_printed else ("tray and mould", "they stay")
    long = max(spec.pad.length_mm, spec.pad.width_mm)
    return PourStep(
        f"Set {carried} where {stay} until the resin is cured: {_site(spec)}. Level with the three screws to "
        f"{plan.level_deg:.2f} deg ({plan.level_mm:.2f} mm over {long:g} mm), along and across, {under}. From "
        f"here on do not move the mould. Level read: {BLANK}",
        (MOVE, LEVEL),
    )


def _mixing(spec: MouldSpec) -> PourStep:
    return PourStep(
        f"Weigh {', then '.join(name for name, _ in spec.pour.components)}; stir slowly for two minutes, "
        f"scrape wall and floor, pour it into a second cup and stir again. Start of mixing: {BLANK}",
        (MIX,),
    )


ASSUMED = {
    "pot_life_min": ("pot life", "min"),
    "shrinkage_percent": ("shrinkage", "%"),
    "cure_time_h": ("cure time", "h"),
    "age_before_test_days": ("age before the test", "days"),
    "degas_pressure_kPa": ("degassing pressure", "kPa"),
    "cure_temperature_C": ("cure temperature", "C"),
}


def assumed_words(pour: Pour) -> str:
    """What the resin's file does not state, with the numbers taken instead; empty where it states all."""
    listed = ", ".join(
        f"{name} {getattr(pour, key):g} {unit}" for key, (name, unit) in ASSUMED.items() if key in pour.assumed
    )
    return listed and (
        f"assumed, as the file of resin {pour.resin} does not state them: {listed}. Write those of the "
        "data sheet into [property] of the file"
    )


def cup_words(pour: Pour, litres: float) -> str:
    """The cup to mix in; ``litres`` is what foam under a vacuum needs."""
    if not pour.is_degassed:
        return f"Cup of at least {litres / 2:.2f} litres."
    return f"Cup of at least {litres:.2f} litres: the mix foams to four times its volume under vacuum."


def degas_words(pour: Pour) -> str:
    """How the air is taken out of the mixed resin, in its cup or without a vacuum."""
    if not pour.is_degassed:
        return (
            "No vacuum: stir slowly without drawing air in. Let large bubbles rise for a minute and prick them. "
            "Pour from high up in a thin thread, so that bubbles break as it stretches."
        )
    below = f"{pour.degas_pressure_kPa:g} kPa{pour.mark('degas_pressure_kPa')}"
    return (
        f"Degas in the cup below {below} until the foam has fallen, then one minute more. "
        "With less vacuum the bubbles only swell."
    )


def _degas_in_mould(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    filled = by_difference(plan, "the step of the brim is the fill line", spec.count)
    return [
        PourStep(f"Set the collar on the land. {filled.replace(' Do not move the mould.', '')}", (POUR,)),
        PourStep(
            f"Stand the mould in the chamber and degas below {spec.pour.degas_pressure_kPa:g} kPa"
            f"{spec.pour.mark('degas_pressure_kPa')} until the foam "
            f"falls (it may rise {plan.collar_mm:.0f} mm), then take the collar off.",
            (MOVE, DEGAS),
        ),
    ]


def _filling(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    """Filling an open mould that is level: at once, in two layers, or under a bone."""
    why = f"the step of the brim is the fill line; {plan.gram_per_mm_g:.1f} g fill one millimetre"
    if spec.pad.shape.bone_height_mm:
        bone = bone_volume_mm3(spec) * 1e-3
        why = f"the bone displaces {bone:.1f} cm3, so the resin stands below the step of the brim"
    steps = [PourStep(by_difference(plan, why, spec.count), (POUR,))]
    return [*(steps if plan.base is None else _layer_steps(spec, plan)), *_closing(spec, plan)]


def _closing(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    """What closes an open mould that is filled: a bone's carrier or the strike-off plate."""
    if spec.pad.shape.bone_height_mm:
        return [
            PourStep(
                "Wet bone and plate with resin. Set the plate down on one edge and lower it like a hinge, slowly, "
                "until it rests on the land and every vent shows resin; top up through a vent. Clamp it or weigh "
                f"it down: it must not float. Seated all round: {BLANK}",
                (CLOSE,),
            )
        ]
    last, pour = plan.base or plan, spec.base.pour if spec.base else spec.pour
    return [
        PourStep(
            f"Prick bubbles, wait {max(30.0, last.pour_time_s):.0f} s for the liquid to level (viscosity "
            f"{pour.viscosity_Pa_s:.2g} Pa s).",
            (WAIT,),
        ),
        PourStep(
            "Lay release film on the strike-off plate, set it down on one edge and lower it like a hinge until it "
            "rests on the land; excess comes up in the gap.",
            (CLOSE,),
        ),
    ]


def _closing_lid(spec: MouldSpec, plan: PourPlan) -> list[PourStep]:
    rings = ""
    if plan.riser_mm:
        rings = (
            f" Build a ring of plasticine around each hole of the backer, {plan.riser_mm:.0f} mm high: "
            f"{RISER_SPRUE_MM:g} mm wide inside at the sprue, {RISER_VENT_MM:g} mm at the vents."
        )
    return [
        PourStep(
            "Put release agent on the parting faces only. Close the lid (it goes on in one way), put the backer on, "
            f"clamp.{rings}"
        ),
        PourStep(
            f"Set it {_site(spec)}, where it stays until the resin is cured, and prop the vent end 5 to 10 degrees "
            "high.",
            (MOVE,),
        ),
    ]


def _filling_lidded(plan: PourPlan) -> list[PourStep]:
    until = "all five vents show resin"
    if plan.riser_mm3:
        where = (
            f"{plan.riser_mm - RISER_SPARE_MM:.0f} mm high in all rings" if plan.riser_mm else "level with the backer"
        )
        until = f"the resin stands {where}: the hot cavity takes {1e-3 * plan.riser_mm3:.1f} cm3 of it"
    return [
        PourStep(
            f"Pour through the sprue until {until} (about {plan.fill_mass_g:.1f} g; put the cup "
            f"back on the balance to see how much you poured). Poured: {BLANK} g",
            (POUR,),
        ),
        PourStep(
            f"Take the prop away and level to {plan.level_deg:.2f} deg; top up. Keep the vents open while it is hot. "
            f"Level read: {BLANK}",
            (MOVE, LEVEL),
        ),
    ]


def _cure(spec: MouldSpec, plan: PourPlan) -> PourStep:
    pour = spec.pour
    hours = f"{pour.cure_time_h:g} h{pour.mark('cure_time_h')}"
    how = f"Cure {hours} {pour.cure_place}"
    if pour.cures_warm:
        vapour = "warm resin and release agent give off vapour"
        if spec.pour.has_isocyanate:
            vapour = "warm isocyanate gives off vapour that harms the airways"
        how = (
            f"Close the {VENTED_OVEN} and cure {hours} at {pour.cure_temperature_C:g} C ({vapour}: "
            "lead the oven's air outdoors or into extraction)"
        )
    carried = "" if spec.is_printed else ", in the tray"
    hot = f" The hot mould grows by {plan.thermal_growth_mm:.1f} mm." if pour.cures_warm else ""
    shrinks = f" (shrinkage {pour.shrinkage_percent:g} % assumed)" if pour.mark("shrinkage_percent") else ""
    cut = f"{100 * (layout(spec).scale - 1):+.2f} %{shrinks}"
    return PourStep(
        f"{how}, where it stands{carried}.{hot} The cavity is cut {cut} so that the cured pad has its size.", (CURE,)
    )
