"""A resin made from a supplier's Shore value alone: the law of another resin moved to it, or one fixed mix."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.core.user_library import make_room
from dummydesign.resin.model.hardness import SHORE_00, SHORE_A, hardness_law
from dummydesign.resin.model.modulus_laws import LAWS
from dummydesign.resin.model.resin import Liquid, Resin, ResinArm
from dummydesign.resin.model.resin_file import DEFAULT, KIND, load_resin, save_resin
from dummydesign.resin.update import without_points

RELAXES_LITTLE = "ecoflex-00-30"
"""Of the built-in resins the one that relaxes least; the polyurethane relaxes most."""
FIXED_RATIO = 100.0
MIXED = "mixed resin"
DOUBT = 2.0
"""Factor by which strengths of relaxation taken from another resin may be wrong: assumed."""


def add_hardness(
    name: str,
    shore_00: float | None = None,
    shore_a: float | None = None,
    base: str | None = None,
    replace_own: bool = False,
) -> dict[str, Any]:
    """Make a resin of a supplier's Shore value and keep it in the user's own folder.

    The answer has plain values: the modulus at ``ratio``, and the ``base`` (None: one fixed mix).

    With a base its law of the ratio is kept and moved to the modulus at its reference ratio; relaxation and liquid
    properties are the base's, with doubt. Without one the resin has one fixed mix, and its relaxation lies anywhere
    between those of the built-in resins.

    Parameters
    ----------
    name : str
        Of the resin.
    shore_00, shore_a : float, optional
        The supplier's value, exactly one of them.
    base : str, optional
        Name or file of the resin whose law is kept.
    replace_own : bool
        Take the place of a resin of the user that has this name.

    Raises
    ------
    InputError
        For none or both Shore values, one outside its scale's range, or a name that is taken.
    """
    given = [(scale, value) for scale, value in ((SHORE_00, shore_00), (SHORE_A, shore_a)) if value is not None]
    if len(given) != 1:
        words, code = ("give one of", "missing") if not given else ("give only one of", "conflict")
        raise InputError(f"{words} --shore-00 and --shore-a, as the supplier states it", code, "shore")
    scale, shore = given[0]
    law = hardness_law()
    young = law.modulus(shore, scale)
    shadowed = make_room(KIND, "resin", name, replace_own)
    resin = _moved(load_resin(base), young) if base is not None else _fixed(young)
    stated = f"Shore {scale} {shore:g}"
    resin = replace(resin, name=name, title=f"{resin.title}, {stated} as stated by its supplier", origin="user")
    factor = max(young.high / young.value, young.value / young.low)
    hardest = f"the hardest product of known modulus has Shore A {law.sure_to_a:g}"
    ends = [
        (
            shore < law.sure_from_a,
            "end_of_scale",
            f"{stated} is at the end of its scale: give --shore-00 or press a puck",
        ),
        (shore > law.sure_to_a, "hardness_extrapolated", f"{stated} is extrapolated: {hardest}; press a puck"),
    ]
    warnings = [
        *({"code": code, "message": text} for beyond, code, text in ends if beyond and scale == SHORE_A),
        {
            "code": "hardness_only",
            "message": f"made from {stated} alone: the modulus is known to a factor of "
            f"{factor:.1f}, the relaxation is assumed; cast a puck and press it (resins add-compression)",
        },
        *shadowed,
    ]
    return {
        "name": name,
        "shore": {"scale": scale, "value": shore},
        "base": base,
        "ratio": resin.relaxation_ratio_ref,
        "young_kPa": young.to_dict(),
        "warnings": warnings,
        "files": {"resin": str(save_resin(resin))},
    }


def _moved(measured: Resin, young: Quantity) -> Resin:
    """The base with its law's modulus replaced; what its own points and pucks said is left out."""
    base = without_points(measured)
    taken = f"taken from resin {base.name}, not of this product"
    # the law's first number is its modulus at its reference, or at 0 where it has none
    at = base.central.get("ratio_ref", 0.0)

    return replace(
        base,
        numbers={**base.numbers, base.law.parameters[0]: young},
        arms=tuple(
            ResinArm(
                arm.tau_s,
                Quantity(
                    arm.beta.value,
                    arm.beta.low / DOUBT,
                    arm.beta.high * DOUBT,
                    "assumed",
                    f"{taken}, a factor of {DOUBT:g} wider: {arm.beta.source}",
                ),
            )
            for arm in base.arms
        ),
        properties={
            key: replace(one, kind="assumed", source=f"{taken}: {one.source}") for key, one in base.properties.items()
        },
        notes=(
            f"Made from a Shore value: the modulus is put to ratio {at:g}, the law of the ratio, "
            f"relaxation and liquid properties are those of {base.name}.",
        ),
        joint_relaxation=None,
    )


def _fixed(young: Quantity) -> Resin:
    """A resin of one mix; relaxation and liquid properties between those of the built-in resins."""
    least, most = load_resin(RELAXES_LITTLE), load_resin(DEFAULT)
    source = f"between the built-in resins {least.name} and {most.name}; no measurement of this product"

    def between(one: Quantity, other: Quantity) -> Quantity:
        low, high = min(one.low, other.low), max(one.high, other.high)
        return Quantity((one.value * other.value) ** 0.5, low, high, "assumed", source)

    ratios = least.ratio_min, most.ratio_min
    density, viscosity = (
        between(least.property(key, ratios[0]), most.property(key, ratios[1]))
        for key in ("density_g_per_cm3", "viscosity_Pa_s")
    )
    return Resin(
        name="",
        title="Resin of one fixed mix",
        origin="user",
        ratio_meaning="parts of mixed resin, A and B as the supplier says",
        ratio_min=FIXED_RATIO,
        ratio_max=FIXED_RATIO,
        ratio_step=1.0,
        liquids=(Liquid(MIXED, None, density, viscosity),),
        law=LAWS["fixed"],
        numbers={"young_kPa": young},
        arms=tuple(ResinArm(two.tau_s, between(one.beta, two.beta)) for one, two in zip(least.arms, most.arms)),
        relaxation_ratio_ref=FIXED_RATIO,
        softness_exponent=Quantity(0.0, 0.0, 0.0, "assumed", "one mix: nothing changes with the ratio"),
        properties={
            key: between(least.properties[key], one) for key, one in most.properties.items() if key in least.properties
        },
        references=("materials/hardness.toml, and the supplier's Shore value",),
        notes=("Mix A and B as the supplier says; the weights on the pour sheet are of the mixed resin.",),
    )
