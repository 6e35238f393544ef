"""The pad or puck that a call asks for in words: sizes, punch, interfaces, law, material; and warnings about it."""

from __future__ import annotations

from collections.abc import Iterable
from math import pi, sqrt
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError

if TYPE_CHECKING:
    from dummydesign.pad.material.relaxation import PronyTerm
    from dummydesign.pad.pad import Pad, Puck


def asked_pad(inputs: dict[str, Any]) -> tuple[Pad | Puck, dict[str, float], list[str]]:
    """Make the pad or puck that is asked for; also its modulus with interval, and sources."""
    from dummydesign.geometry.punch_profile import read_profile
    from dummydesign.geometry.shapes import read_shape
    from dummydesign.pad.material.hyperelastic import read_law
    from dummydesign.pad.pad import SLAB, Pad, Puck
    from dummydesign.pad.tables.punch import equal_area_radius_mm, punch_sides_mm

    young, sources, prony = _material(inputs)
    size_text, punch = inputs["pad"], inputs["punch"]
    kind, _, size = size_text.partition(":")
    sides = numbers("pad", size.replace("x", ","))
    if {"slab": 2, "cylinder": 1}.get(kind) != len(sides) or not min(sides) > 0:
        raise InputError(f"pad '{size_text}' is not of the form slab:LENGTHxWIDTH or cylinder:DIAMETER in mm")
    cylinder, plate = kind == "cylinder", punch == "plate"
    if cylinder != plate:
        raise InputError(f"pad '{size_text}' and punch '{punch}': plates press cylinders only")
    law, geometry = read_law(inputs["law"]), read_shape(inputs["shape"])
    if cylinder:
        if geometry != SLAB:
            raise InputError(f"shape {geometry} is pressed by a flat punch, not by a profile or plates")
        if inputs["base"] != "bonded":
            raise InputError(f"base = {inputs['base']}: both plates hold a puck alike; say how by --condition")
        if inputs["edge_radius_mm"]:
            raise InputError(f"edge_radius_mm = {inputs['edge_radius_mm']:g} is of a punch; plates have no edge")
        puck = Puck(
            inputs["thickness_mm"], young["value"] * 1e-3, sides[0], prony, inputs["condition"], inputs["poisson"], law
        )
        return puck, young, sources
    profile = read_profile(punch[len("profile:") :]) if punch.startswith("profile:") else None
    radius = profile[0][-1] if profile else equal_area_radius_mm(punch)
    widest = max((punch_sides_mm(punch) if profile is None else None) or (2.0 * radius,))
    if min(sides) < widest:
        raise InputError(f"pad = {size} mm is smaller than the punch {punch}; its sides must be at least {widest:g} mm")
    made = Pad(
        thickness_mm=inputs["thickness_mm"],
        young_MPa=young["value"] * 1e-3,
        radius_mm=radius,
        prony=prony,
        base=inputs["base"],
        condition=inputs["condition"],
        poisson=inputs["poisson"],
        law=law,
        extent_mm=sqrt(sides[0] * sides[-1] / pi),
        sides_mm=None if profile else punch_sides_mm(punch),
        slab_mm=(sides[0], sides[-1]),
        profile_mm=profile,
        geometry=geometry,
        edge_radius_mm=inputs["edge_radius_mm"],
    )
    return made, young, sources


def _material(inputs: dict[str, Any]) -> tuple[dict[str, float], list[str], tuple[PronyTerm, ...]]:
    """Modulus with interval, sources and relaxation, given or from a resin."""
    prony = _prony(inputs["prony"])
    if (inputs["young_kPa"] is None) == (inputs["resin"] is None):
        raise InputError("give either --young KPA or --resin NAME with --ratio R")
    if inputs["young_kPa"] is not None:
        young = inputs["young_kPa"]
        return {"value": young, "low": young, "high": young}, [], prony
    from dummydesign.resin import load_resin

    if inputs["ratio"] is None:
        raise InputError("--resin needs --ratio, the mixing ratio")
    resin = load_resin(inputs["resin"])
    modulus = resin.modulus_kPa(inputs["ratio"])
    prony = prony if inputs["prony"] is not None else resin.prony(inputs["ratio"])
    young = {"value": modulus.value, "low": modulus.low, "high": modulus.high}
    return young, [modulus.source, *resin.references], prony


def relaxation_warnings(made: Pad | Puck, moves: bool) -> list[dict[str, str]]:
    """Warn where a pad without relaxation is pressed in time; ``moves`` says whether it is."""
    if made.prony or not moves:
        return []
    message = (
        "this pad has no relaxation: its peak force is its steady force. Give --resin with --ratio, or --young with "
        "--prony TAU:BETA"
    )
    return [{"code": "no_relaxation", "message": message}]


def pad_warnings(made: Pad | Puck, fidelity: str) -> list[dict[str, str]]:
    """Warn where a punch that is not round, or one of several crowns, is taken for another."""
    return _punch_warnings(made, fidelity) + _sites_warnings(made)


def _punch_warnings(made: Pad | Puck, fidelity: str) -> list[dict[str, str]]:
    """Warn where a square or rectangle is taken as the circle of equal area."""
    from dummydesign.pad.elastic import has_square_factor
    from dummydesign.pad.pad import Puck

    if isinstance(made, Puck) or made.sides_mm is None or fidelity == "3d":
        return []
    if has_square_factor(made):
        if not made.edge_radius_mm:
            return []
        message = "what a square adds to the circle of its area is that of sharp edges; half of it is stated as error"
        return [{"code": "square_with_fillet", "message": message}]
    message = (
        "the punch is taken as the circle of equal area; a square is 0 to 3 % stiffer (5 to 20 mm pads), "
        "a rectangle more; --fidelity 3d solves it"
    )
    return [{"code": "equal_area_punch", "message": message}]


def _sites_warnings(made: Pad | Puck) -> list[dict[str, str]]:
    """Say that one of several crowns is pressed as if it were alone."""
    from dummydesign.design.sites.pressed_alone import pressed_alone
    from dummydesign.pad.pad import Puck

    return pressed_alone([] if isinstance(made, Puck) else [len(made.geometry.places_mm)])


def numbers(name: str, text: str | float | Iterable[float]) -> list[float]:
    """Numbers from text such as ``"1,2"``, one number, or several."""
    try:
        if isinstance(text, str):
            return [float(part) for part in text.split(",")]
        return [float(text)] if isinstance(text, int | float) else [float(part) for part in text]
    except (TypeError, ValueError):
        raise InputError(f"--{name} '{text}' is not a list of numbers separated by commas") from None


def _prony(text: str | None) -> tuple[PronyTerm, ...]:
    """Terms from ``TAU:BETA,...``."""
    from dummydesign.pad.material.relaxation import PronyTerm

    if not text:
        return ()
    terms = []
    for part in text.split(","):
        pair = part.split(":")
        if len(pair) != 2:
            raise InputError(f"--prony '{part}' is not TAU:BETA, such as 0.1:0.3,1.5:0.3")
        terms.append(PronyTerm(*(numbers("prony", number)[0] for number in pair)))
    return tuple(terms)
