"""What may go wrong with a pour, by the numbers of its plan and by what its shape asks of the workshop. No CAD."""

from __future__ import annotations

import re

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import gauge_places
from dummydesign.mold.pour.plan import CARRIER_VENTS, RATIO_ERROR_LIMIT_PERCENT, PourPlan, batch_of, pours_of
from dummydesign.mold.pour.printing import layer_words, release_words, tip_words
from dummydesign.mold.pour.steps import assumed_words

# A base further than this from the shape's modulus ratio is worth a word.
RATIO_OFF = 0.02


def pour_warnings(spec: MouldSpec, plan: PourPlan) -> list[dict[str, str]]:
    """Say what may go wrong with this pour, as {code, message}."""
    pad = spec.pad
    notes = {
        "level": f"level the mould to {plan.level_deg:.2f} deg: {plan.level_mm:.2f} mm over the longer side, "
        f"{100 * plan.level_mm / pad.thickness_mm:.1f} % of {pad.thickness_mm:g} mm"
    }
    if spec.body.style != "lidded":
        plate = "the carrier of the bone" if pad.shape.bone_height_mm else "the strike-off plate onto a release film"
        notes["meniscus"] = (
            f"fill to the sharp step of the brim, no higher, and lower {plate}: the liquid rises up "
            f"to {plan.meniscus_mm:.1f} mm at the walls of an open cavity"
        )
    if words := assumed_words(spec.pour):
        notes["assumed_numbers"] = words
    if not spec.pour.is_degassed:
        notes["not_degassed"] = (
            "poured without a vacuum: air that stays makes the pad softer by an unknown amount; "
            "weigh the pad, and cast the witness puck from the same cup"
        )
    pours = pours_of(spec, plan)
    pour, small = max(pours, key=lambda one: one[1].ratio_error_percent)
    if small.ratio_error_percent > RATIO_ERROR_LIMIT_PERCENT:
        mix, alone = batch_of(spec, pour, small).mix, small.batch_mass_g
        notes["small_batch"] = (
            f"mix {mix.total_g:g} g, although {alone:g} g with cup loss and spare would do: with a "
            "balance of "
            f"{spec.machines.balance_resolution_g:g} g the error of the smaller component is then "
            f"at most {mix.error_percent:.2f} % instead of {small.ratio_error_percent:.2f} %; a "
            "finer balance saves resin"
        )
    if plan.wall_deflection_mm > 0.2:
        notes["wall_deflection"] = (
            f"the walls may bulge by {plan.wall_deflection_mm:.2f} mm under the liquid: support them in the tray"
        )
    slowest_s = max(one.pour_time_s for _, one in pours)
    if slowest_s > 60 * spec.pour.pot_life_min / 4:
        notes["slow_levelling"] = (
            f"the liquid needs about {slowest_s / 60:.0f} min to level itself in "
            f"{pad.least_gel_mm:g} mm, a good part of its pot life of "
            f"{spec.pour.pot_life_min:g} min{spec.pour.mark('pot_life_min')}: spread it "
            "with a spatula"
        )
    if spec.is_printed:
        notes["printed_mould"] = release_words(spec)
    else:
        notes |= _against_silicone(spec)
    if words := layer_words(spec):
        notes["print_layers"] = words
    if 0.0 < pad.edge_radius_mm == pad.edge_room_mm:
        notes["edge_radius"] = (
            f"the edge of the tested face is rounded by {pad.edge_radius_mm:g} mm, all that the pad's rim has room for"
        )
    if crowded := [name for name, point in gauge_places(spec).items() if point is None]:
        notes["gauge_points_left_out"] = (
            f"no flat has room to gauge at {', '.join(crowded)}: 4 mm to every slope are needed. A larger pad has room"
        )
    notes |= {**_relief(spec), **_bone(spec), **_layers(spec)}
    listed = [*notes.items(), *pad.shape.casting_notes(pad)]
    return [{"code": code, "message": message} for code, message in listed]


def _against_silicone(spec: MouldSpec) -> dict[str, str]:
    """What the pad's resin and the mould's silicone do to each other."""
    pour, mould, notes = spec.pour, spec.tool.name, dict[str, str]()
    silicone = "silicone" in pour.chemistry
    if silicone or (pour.chemistry in ("", "other") and not pour.has_isocyanate):
        is_one = f"{pour.resin} is a silicone and" if silicone else f"if {pour.resin} is a silicone it"
        notes["bonding"] = f"{is_one} bonds to a silicone mould: use a release agent and try it on a scrap first"
    if silicone and is_tin(mould) and pour.chemistry != "tin silicone":
        notes["cure_inhibition"] = (
            f"the mould silicone {mould} cures with tin, which "
            f"{'inhibits' if pour.chemistry == 'platinum silicone' else 'may inhibit'} the cure of "
            f"{pour.resin}: the pad stays tacky. Name a platinum-cured silicone in the "
            "preset, or cast in a printed mould (--preset printed)"
        )
    return notes


def is_tin(silicone: str) -> bool:
    """Whether the name of a silicone says that it cures with tin (condensation)."""
    return bool(re.search(r"(^|[^a-z])tin([^a-z]|$)|condensation", silicone.lower()))


def _relief(spec: MouldSpec) -> dict[str, str]:
    """What a tested face that is not flat asks for."""
    pad, shape = spec.pad, spec.pad.shape
    if not shape.relief_mm:
        return {}
    layer = formula.print_layer_mm(shape.relief_mm)
    tip = ""
    if shape.tip_radius_mm is not None:
        flat = formula.tip_flat_mm(shape.tip_radius_mm, layer)
        tip = f"its layers flatten the tip of radius {shape.tip_radius_mm:g} mm over {flat:.1f} mm"
    effect = "".join(f"; {words}" for words in (tip, tip_words(spec)) if words)
    return {
        "curved_master": f"the plug's top is curved: print it in layers of at most {layer:.2g} mm, sand or coat "
        f"the steps, or machine it{effect}",
        "thickness_varies": f"the pad is {pad.thickness_mm:g} mm thick at its highest point and {pad.least_gel_mm:g} "
        "mm beside it: pour by mass, not by depth",
    }


def _bone(spec: MouldSpec) -> dict[str, str]:
    """How the carrier of a bone is lowered, and how true its height must be."""
    if not spec.pad.shape.bone_height_mm:
        return {}
    notes = {
        "bone_air": "the plate shuts the mould: lower it tilted, one edge first, until all "
        f"{CARRIER_VENTS} vents show resin"
    }
    if words := tip_words(spec):
        notes["bone_height"] = f"measure the bone over its plate: {words}"
    return notes


def _layers(spec: MouldSpec) -> dict[str, str]:
    """How two layers bond, and a base of another modulus than the shape's."""
    layers = spec.pad.shape.layers()
    if layers is None or spec.base is None:
        return {}
    notes = {
        "layer_bond": "the layers bond only while the first is gelled and still tacky: a finger in a glove sticks "
        "but draws no resin; try it on the witness of this batch, not on the pad"
    }
    made, wanted = spec.base.modulus_ratio, layers[1]
    if abs(made / wanted - 1) > RATIO_OFF:
        of = f"base ratio {spec.base.pour.ratio:g} gives a base of {made:.3g} times the upper modulus"
        notes["modulus_ratio"] = f"{of}, the shape says {wanted:g}"
    return notes
