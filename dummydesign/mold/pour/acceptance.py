"""Whether a cast pad is the one that was designed: limits, what each deviation costs in force, what to do. No CAD."""

from __future__ import annotations

import numpy as np

from dummydesign.geometry.standard import PUNCH_RADIUS_MM
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import PourPlan
from dummydesign.mold.pour.steps import BLANK

# Depth over thickness at which the force's sensitivity to the thickness is told.
TOLD_DEPTH = 0.25


def force_at_thickness(spec: MouldSpec, shares: tuple[float, ...]) -> tuple[float, ...] | None:
    """Force at a given depth of pads whose thickness is a share of the designed one, over that of the designed one.

    At a quarter of the designed thickness, glued, under a square punch of 14 mm, by the response table.

    Parameters
    ----------
    spec : MouldSpec
        Of the designed pad.
    shares : tuple of float
        Thickness over the designed thickness.

    Returns
    -------
    tuple of float, or None
        None for a pad that no table holds, that is pressed between plates, or that is thinner than a table goes.
    """
    from dummydesign.core.errors import InputError
    from dummydesign.pad.tables.shape import ShapeLaw
    from dummydesign.pad.tables.slab import load_table

    pad = spec.pad
    if pad.is_puck or not (pad.shape.plain or pad.shape.tabulated):
        return None
    h = pad.thickness_mm
    try:
        law = load_table("bonded") if pad.shape.plain else ShapeLaw(pad.shape)
        force = law.force(TOLD_DEPTH * h, np.array([1.0, *shares]) * h, 1.0, PUNCH_RADIUS_MM)
    except InputError:
        return None
    over = force[1:] / force[0]
    return tuple(float(one) for one in over) if np.all(np.isfinite(over)) else None


def force_per_thickness(spec: MouldSpec) -> float | None:
    """Relative change of the force at a given depth for a relative change of the thickness, d ln F / d ln h.

    Central difference over one per cent of :func:`force_at_thickness`; None where that is not known.
    """
    step = 0.01
    force = force_at_thickness(spec, (1.0 - step, 1.0 + step))
    if force is None:
        return None
    return float(np.log(force[1] / force[0]) / np.log((1.0 + step) / (1.0 - step)))


def acceptance_rows(spec: MouldSpec, plan: PourPlan) -> list[tuple[str, ...]]:
    """Table of what is measured on the finished pad, what is allowed, what it costs and what to do; a row each."""
    limits, pad = spec.acceptance, spec.pad
    slope = force_per_thickness(spec)
    h = pad.thickness_mm
    mass = plan.pad_mass_g + (plan.base.pad_mass_g if plan.base else 0.0)

    def costs(percent: float) -> str:
        return "not known" if slope is None else f"{abs(slope) * percent:.0f} % of force at a given depth"

    return [
        ("measured", "wanted", "allowed", "the limit costs", "really", "if it is missed"),
        (
            "thickness at each gauge point", "its nominal", f"within {h * limits.thickness_percent / 100:.2f} mm",
            costs(limits.thickness_percent), "table above",
            "give the campaign the record with the real thickness; beyond twice the limit cast again",
        ),
        (
            "off nominal, largest less smallest", "0 mm", f"{h * limits.spread_percent / 100:.2f} mm",
            costs(limits.spread_percent / 2.0), BLANK, "level again with the load in the mould, cast again",
        ),
        (
            "mass", f"{mass:.1f} g", f"{mass * (1 - limits.mass_percent / 100):.1f} to "
            f"{mass * (1 + limits.mass_percent / 100):.1f} g", costs(limits.mass_percent), BLANK,
            "too light: air inside or a leak; too heavy: overfilled",
        ),
        (
            "modulus of the witness", _modulus(spec), f"within {limits.modulus_percent:g} %",
            f"{limits.modulus_percent:.0f} % of force", BLANK,
            "wrong ratio, moist or old resin: cast again, or design again with resins add-compression",
        ),
        (
            "bubbles over 1 mm under the punch", "none", "none", "local softening, not known", BLANK,
            "reject; degas longer or at a lower pressure",
        ),
    ]  # fmt: skip


def _modulus(spec: MouldSpec) -> str:
    young = spec.pour.young_kPa
    return "that of the design" if young is None else f"{young:.1f} kPa"


def when_it_fails(spec: MouldSpec) -> tuple[str, ...]:
    """What to do when a step of the pour fails, for the kind of mould that is poured."""
    lidded, boned = spec.body.style == "lidded", bool(spec.pad.shape.bone_height_mm)
    mix = "mix the missing grams anew within the pot life"
    if lidded:
        little = f"Too little poured, a vent stays empty: raise its end, tap the mould, {mix} and pour on."
        much = "Too much poured: wipe what comes out of the vents off the backer before it gels."
        air = "Air under the lid: prop the vent end up again and wait until it has come out; never open the lid."
    elif boned:
        little = f"Too little poured: {mix} and top up through a vent."
        much = "Too much poured: wipe what comes out of the vents off the plate before it gels."
        air = "Air under the plate of the bone: lift one edge, let it out, lower again until all vents show resin."
    else:
        little = f"Too little poured: {mix}, or strike off short and enter the mass."
        much = "Too much poured: take it off with a syringe from a corner before it gels."
        air = "Air under the plate: lift one edge, let it out, lower again."
    torn = "A torn corner of the mould: outside the land it may be glued with silicone; in the cavity cast a new mould."
    if spec.is_printed:
        torn = "A joint that leaks: seal it with wax from outside. A chipped wall of the cavity: print the part anew."
    cast = "silicone" if not spec.is_printed else "release agent"
    return (
        "Foam does not fall within the time: the pump is too weak or the resin is moist. Throw the batch away.",
        f"{little} Never stretch a batch after it thickens.",
        much,
        "The mould was bumped: level again at once while the resin still flows; once it has gelled, cast again.",
        air,
        f"A face that stays tacky: cure inhibition or a wrong ratio. Test print, {cast} and resin on scraps before the "
        "next pour.",
        torn,
    )


def measured_blanks(count: int) -> str:
    """Line for the mass of each pad that came out."""
    if count == 1:
        return f"Weigh the trimmed pad: {BLANK} g"
    pads = "; ".join(f"pad {number}: {BLANK} g" for number in range(1, count + 1))
    return f"Weigh each trimmed pad, by the cavities' order: {pads}"
