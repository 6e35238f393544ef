"""The pour itself, step by step: levelled where it cures, weighed by difference, never moved before it has gelled."""

from __future__ import annotations

from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour import shape_notes
from dummydesign.mold.pour.plan import PourPlan
from dummydesign.mold.pour.steps import BLANK, CLOSE, CURE, DEGAS, LEVEL, MIX, MOVE, POUR, PREPARE, WAIT, Step

VENTED_OVEN = "vented oven"
# Drying of a mould for a resin that water foams; silicone gives off what it took up within the hour.
DRYING_H = 1.0


def pour_steps(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    """From the empty mould to the end of the cure.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    plan : PourPlan
        Weights and times of its pours.

    Returns
    -------
    list of Step
        Keeps the rules of :func:`dummydesign.mold.pour.steps.order_faults`.
    """
    steps = [*_drying(spec), *shape_notes.before_mixing(spec)]
    if spec.pour.degas == "mould":
        steps += [_mixing(spec), *_degas_in_mould(spec, plan), _levelling(spec, plan)]
        steps += _after_pouring(spec, plan)
    elif spec.body.style != "lidded":
        steps += [_levelling(spec, plan), _mixing(spec), _degas_in_cup(spec), *_filling(spec, plan)]
    else:
        steps += [*_closing_lid(spec), _mixing(spec), _degas_in_cup(spec), *_filling_lidded(spec, plan)]
    latest = spec.pour.pot_life_min - max(2.0, plan.pour_time_s / 60)
    what = "All of this" if plan.base is None else "Each of the two pours"
    limit = f"{what} within {latest:.0f} min of mixing (pot life {spec.pour.pot_life_min:g} min). Done at: {BLANK}"
    return [*steps, Step(limit, (WAIT,)), _cure(spec, plan)]


def _place(spec: MouldSpec) -> str:
    return f"on the shelf of the {VENTED_OVEN}, switched off and open" if spec.pour.cures_warm else "on a firm bench"


def _drying(spec: MouldSpec) -> list[Step]:
    if not any("isocyanate" in name.lower() for name, _ in spec.pour.components):
        return []
    pour = spec.pour
    at = f"at {pour.cure_temperature_C:g} C" if spec.pour.cures_warm or spec.is_printed else "at 60 C"
    wet = "plastic" if spec.is_printed else "silicone"
    return [
        Step(
            f"Dry the mould {DRYING_H:g} h {at} in a {VENTED_OVEN}: release agent and resin left in it give off "
            f"vapour. Water in the {wet} would foam the polyurethane. Let it cool below 40 C before you pour, else the "
            "pot life shortens.",
            (PREPARE, MOVE),
        )
    ]


def _vapour(spec: MouldSpec) -> str:
    """Why a warm cure needs a vent."""
    if any("isocyanate" in name.lower() for name, _ in spec.pour.components):
        return "warm isocyanate gives off vapour that harms the airways"
    return "warm resin and release agent give off vapour"


def _levelling(spec: MouldSpec, plan: PourPlan) -> Step:
    pad = spec.pad
    load = spec.count * plan.fill_mass_g + (plan.base.fill_mass_g if plan.base else 0.0)
    cavity = "cavity" if spec.count == 1 else "cavities"
    empty = spec.pour.degas != "mould"
    under = (
        f"with a weight of about {load:.0f} g on a clean film in the {cavity}, the load to come; take it out again"
        if empty
        else "at once, with the resin in it"
    )
    carried, stay = ("the mould", "it stays") if spec.is_printed else ("tray and mould", "they stay")
    return Step(
        f"Set {carried} where {stay} until the resin is cured: {_place(spec)}. Level with the three screws to "
        f"{plan.level_deg:.2f} deg ({plan.level_mm:.2f} mm over {max(pad.length_mm, pad.width_mm):g} mm), along and "
        f"across, {under}. From here on the mould is not moved. Read: {BLANK}",
        (MOVE, LEVEL),
    )


def _mixing(spec: MouldSpec) -> Step:
    return Step(
        f"Weigh {', then '.join(name for name, _ in spec.pour.components)}; stir slowly for two minutes, scrape wall "
        f"and floor, pour over into a second cup and stir again. Start of mixing: {BLANK}",
        (MIX,),
    )


def _degas_in_cup(spec: MouldSpec) -> Step:
    return Step(
        f"Degas in the cup below {spec.pour.degas_pressure_kPa:g} kPa until the foam has fallen and a minute more. A "
        "weaker pump only swells the bubbles.",
        (DEGAS,),
    )


def _degas_in_mould(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    filled = shape_notes.by_difference(plan, "the step of the brim is the fill line", spec.count)
    return [
        Step(f"Set the collar on the land. {filled.replace(' The mould stays where it is.', '')}", (POUR,)),
        Step(
            f"Stand the mould in the chamber and degas below {spec.pour.degas_pressure_kPa:g} kPa until the foam falls "
            f"(it may rise {plan.collar_mm:.0f} mm), then take the collar off.",
            (MOVE, DEGAS),
        ),
    ]


def _filling(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    """Filling an open mould that is level: at once, in two layers, or under a bone."""
    if spec.pad.shape.bone_height_mm:
        return shape_notes.carrier_steps(spec, plan)
    if plan.base is not None:
        return [*shape_notes.first_layer_steps(spec, plan), *_after_pouring(spec, plan)]
    why = f"the step of the brim is the fill line; {plan.gram_per_mm_g:.1f} g make one millimetre"
    return [Step(shape_notes.by_difference(plan, why, spec.count), (POUR,)), *_after_pouring(spec, plan)]


def _after_pouring(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    last = plan if plan.base is None else plan.base
    pour = spec.pour if spec.base is None else spec.base.pour
    if spec.pad.shape.bone_height_mm:
        return shape_notes.carrier_steps(spec, plan)[1:]
    return [
        Step(
            f"Prick bubbles, wait {max(30.0, last.pour_time_s):.0f} s for the liquid to level (viscosity "
            f"{pour.viscosity_Pa_s:.2g} Pa s).",
            (WAIT,),
        ),
        Step(
            "Lay release film on the strike-off plate, set it down on one edge and lower it like a hinge until it "
            "rests on the land; excess comes up in the gap.",
            (CLOSE,),
        ),
    ]


def _closing_lid(spec: MouldSpec) -> list[Step]:
    return [
        Step(
            "Release agent on the parting faces only. Close the lid (it goes on in one way), lay on the backer, clamp."
        ),
        Step(
            f"Set it {_place(spec)}, where it stays until the resin is cured, and prop the vent end 5 to 10 degrees "
            "high.",
            (MOVE,),
        ),
    ]


def _filling_lidded(spec: MouldSpec, plan: PourPlan) -> list[Step]:
    return [
        Step(
            f"Pour through the sprue until all five vents show resin (about {plan.fill_mass_g:.0f} g; put the cup back "
            f"on the balance to see what has left it). Poured: {BLANK} g",
            (POUR,),
        ),
        Step(
            f"Take the prop away and level to {plan.level_deg:.2f} deg; top up. Keep the vents open while it is hot. "
            f"Read: {BLANK}",
            (MOVE, LEVEL),
        ),
    ]


def _cure(spec: MouldSpec, plan: PourPlan) -> Step:
    pour = spec.pour
    place = f"Cure {pour.cure_time_h:g} h at room temperature"
    if spec.pour.cures_warm:
        place = f"Close the {VENTED_OVEN} and cure {pour.cure_time_h:g} h at {pour.cure_temperature_C:g} C"
        place += f" ({_vapour(spec)}; lead the oven's air outdoors or into extraction)"
    carried = "" if spec.is_printed else ", in the tray"
    return Step(
        f"{place}, where it stands{carried}. The hot mould grows by {plan.thermal_growth_mm:.1f} mm; the cavity is "
        f"cut {100 * (layout(spec).scale - 1):+.2f} % to end at size.",
        (CURE,),
    )
