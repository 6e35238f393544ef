"""What may go wrong with a pour, by the numbers of its plan and by what its shape asks of the workshop. No CAD."""

from __future__ import annotations

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.batch import batch_of
from dummydesign.mold.pour.plan import CARRIER_VENTS, RATIO_ERROR_LIMIT_PERCENT, PourPlan
from dummydesign.mold.pour.print_layers import layer_words, tip_words
from dummydesign.mold.printed.notes import release_words

# A base further than this from the shape's modulus ratio is worth a word.
RATIO_APART = 0.02


def pour_warnings(spec: MouldSpec, plan: PourPlan) -> list[dict[str, str]]:
    """Say what may go wrong with this pour, as {code, message}."""
    found: list[tuple[str, str]] = [
        (
            "level",
            f"level the mould to {plan.level_deg:.2f} deg: {plan.level_mm:.2f} mm over the longer side, "
            f"{100 * plan.level_mm / spec.pad.thickness_mm:.1f} % of {spec.pad.thickness_mm:g} mm",
        )
    ]
    if spec.body.style != "lidded":
        boned = spec.pad.shape.bone_height_mm > 0.0
        plate = "the carrier of the bone" if boned else "the strike-off plate onto a release film"
        found.append(
            (
                "meniscus",
                f"the liquid forms a meniscus up to {plan.meniscus_mm:.1f} mm high at the walls of an open cavity: "
                f"fill to the sharp step of the brim, no higher, and lower {plate}",
            )
        )
    pours = [(spec.pour, plan)] + ([(spec.base.pour, plan.base)] if spec.base and plan.base else [])
    pour, small = max(pours, key=lambda one: one[1].ratio_error_percent)
    if small.ratio_error_percent > RATIO_ERROR_LIMIT_PERCENT:
        mix, alone = batch_of(spec, pour, small).mix, small.batch_mass_g
        found.append(
            (
                "small_batch",
                f"mix {mix.total_g:g} g though {alone:g} g would fill the mould: a balance of "
                f"{spec.machines.balance_resolution_g:g} g leaves up to {small.ratio_error_percent:.2f} % error in the "
                f"smaller component of {alone:g} g, {mix.error_percent:.2f} % of {mix.total_g:g} g; a finer balance "
                "saves resin",
            )
        )
    if plan.wall_deflection_mm > 0.2:
        found.append(
            (
                "wall_deflection",
                f"the walls may bulge by {plan.wall_deflection_mm:.2f} mm under the liquid: support them in the tray",
            )
        )
    slow = max([plan, plan.base] if plan.base else [plan], key=lambda part: part.pour_time_s)
    if slow.pour_time_s > 60 * spec.pour.pot_life_min / 4:
        found.append(
            (
                "slow_levelling",
                f"the liquid needs about {slow.pour_time_s / 60:.0f} min to level itself in "
                f"{spec.pad.least_gel_mm:g} mm, a good part of its pot life of {spec.pour.pot_life_min:g} min: spread "
                "it with a spatula",
            )
        )
    if spec.is_printed:
        found.append(("printed_mould", release_words(spec)))
    elif not any("isocyanate" in name.lower() for name, _ in spec.pour.components):
        found.append(
            (
                "bonding",
                f"if {spec.pour.resin} is a silicone it bonds to a silicone mould: use a release agent and try it on a "
                "scrap first",
            )
        )
    if words := layer_words(spec):
        found.append(("print_layers", words))
    if 0.0 < spec.pad.edge_radius_mm == spec.pad.edge_room_mm:
        found.append(("edge_radius", f"the edge of the tested face is rounded by {spec.pad.edge_radius_mm:g} mm, all "
                      "that the pad's rim has room for"))  # fmt: skip
    found += [*_relief(spec), *_bone(spec), *_layers(spec), *spec.pad.shape.casting_notes(spec.pad)]
    return [{"code": code, "message": message} for code, message in found]


def _relief(spec: MouldSpec) -> list[tuple[str, str]]:
    """What a tested face that is not flat asks for."""
    pad, shape = spec.pad, spec.pad.shape
    if not shape.relief_mm:
        return []
    layer = formula.print_layer_mm(shape.relief_mm)
    tip = ""
    if shape.tip_radius_mm is not None:
        flat = formula.tip_flat_mm(shape.tip_radius_mm, layer)
        tip = f" (they leave a flat of {flat:.1f} mm at a tip of radius {shape.tip_radius_mm:g} mm)"
    found = [
        (
            "curved_master",
            f"the plug's top is curved: print it in layers of at most {layer:.2g} mm{tip}, sand or coat the steps, or "
            "machine it" + (f"; {words}" if (words := tip_words(spec)) else ""),
        ),
        (
            "thickness_varies",
            f"the pad is {pad.thickness_mm:g} mm thick at its highest point and {pad.least_gel_mm:g} mm beside it: "
            "pour by mass, not by depth",
        ),
    ]
    if shape.pockets:
        found.append(
            (
                "air_pockets",
                f"the {shape.pockets} pockets in the floor keep air: brush a thin coat of resin into them first, or "
                "draw a vacuum on the filled mould",
            )
        )
    return found


def _bone(spec: MouldSpec) -> list[tuple[str, str]]:
    """How the carrier of a bone is lowered, and how true its height must be."""
    if not spec.pad.shape.bone_height_mm:
        return []
    text = f"the plate shuts the mould: lower it tilted, one edge first, until all {CARRIER_VENTS} vents show resin"
    words = tip_words(spec)
    if spec.insert is not None:
        told = [("bone_from_file", spec.insert.words)]
        if spec.insert.overhang:
            told.append(("bone_overhang", "parts of the bone look up towards its plate and keep air under them: wet "
                         "them with resin, lower the bone tilted and turn it while it sinks"))  # fmt: skip
        return [("bone_air", text), *told]
    return [("bone_air", text), *([("bone_height", f"measure the bone over its plate: {words}")] if words else [])]


def _layers(spec: MouldSpec) -> list[tuple[str, str]]:
    """How two layers bond, and a base of another modulus than the shape's."""
    layers = spec.pad.shape.layers()
    if layers is None or spec.base is None:
        return []
    found = [
        (
            "layer_bond",
            "the layers bond only while the first is gelled and still tacky: a finger in a glove sticks but draws no "
            "resin; try it on the witness of this batch, not on the pad",
        )
    ]
    made, wanted = spec.base.modulus_ratio, layers[1]
    if abs(made / wanted - 1) > RATIO_APART:
        found.append(
            (
                "modulus_ratio",
                f"base ratio {spec.base.pour.ratio:g} gives a base of {made:.3g} times the upper modulus, the shape "
                f"says {wanted:g}",
            )
        )
    return found
