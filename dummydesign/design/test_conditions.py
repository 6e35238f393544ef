"""A test of one's own: punches, forces, speeds, pads and bases, and what slabs do under them."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite, pi, sqrt

from numpy.typing import NDArray

from dummydesign.core.errors import InputError, out_of_range, quantity_name
from dummydesign.design.request import Request
from dummydesign.design.search.shape_family import designable_kinds
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM, PUNCH, THICKNESS_MM
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.geometry.punch import Punch
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.fe_force_law import in_table, near_rim
from dummydesign.pad.fe_force_law import own_slab_law as solved_over
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.slab import load_table, slab_table
from dummydesign.pad.tables.square import punch_law
from dummydesign.tissue.model.measured_curves import FORCE_FACTOR
from dummydesign.tissue.model.subject import PRESSED
from dummydesign.tissue.model.tissue import Tissue


def tabulated(thickness_mm: NDArray, request: Request, punch: Punch) -> NDArray:
    """Those thicknesses (T,) that the table holds for the punch's size."""
    base = request.base if request.base in BASES else "bonded"
    smallest, largest = load_table(base=base).ratio_range
    kept = thickness_mm[(punch.radius_mm / thickness_mm >= smallest) & (punch.radius_mm / thickness_mm <= largest)]
    if not len(kept):
        low, high = (max(punch.radius_mm / largest, THICKNESS_MM[0]), min(punch.radius_mm / smallest, THICKNESS_MM[1]))
        if low > high:
            raise InputError(
                f"punch {request.punch} is outside what is tabulated: the circle of its area has a radius of "
                f"{punch.radius_mm:.3g} mm, allowed is {smallest * THICKNESS_MM[0]:.3g} to "
                f"{largest * THICKNESS_MM[1]:.3g}",
                "out_of_range",
                "punch_radius_mm",
                punch.radius_mm,
            )
        raise out_of_range(
            "thickness in mm",
            f"{thickness_mm[0]:g}:{thickness_mm[-1]:g}",
            f"{low:.3g}",
            f"{high:.3g}",
            f"under the punch {request.punch}",
        )
    return kept


def own_slab_law(request: Request, punch: Punch, thickness_mm: NDArray) -> ForceLaw:
    """Force law of the slabs of a request: the table of its base under its punch, or what is solved over it."""
    base = request.base if request.base in BASES else "bonded"
    pad, edge = pad_of_request(request, punch), request.edge_radius_mm
    if request.face != "bonded" and punch.profile_mm is None:
        # the fillets' tables and the square's factor are of glued punches
        return solved_over(slab_table(base, 0.0, punch.radius_mm), pad, thickness_mm)
    law: ForceLaw = solved_over(slab_table(base, edge, punch.radius_mm), replace(pad, edge_radius_mm=0.0), thickness_mm)
    if request.base not in BASES or punch.profile_mm:
        return law
    return punch_law(law, request.punch, base, bool(edge))


def table_alone(request: Request, punch: Punch) -> ForceLaw:
    """The table of a request's base under a flat punch with sharp edges, without anything solved."""
    return punch_law(load_table(base=request.base), request.punch, request.base)


def why_solved(request: Request, punch: Punch, thickness_mm: float) -> str:
    """Why a slab of a request is not pressed by the table alone; empty when it is."""
    pad = pad_of_request(request, punch)
    if not in_table(pad):
        return f"pads under the punch {punch.text} are not in the tables"
    if near_rim(pad, thickness_mm):
        return f"the rim of a pad {thickness_mm:g} mm thick is felt under the punch {punch.text}"
    return ""


def correctable(request: Request, punch: Punch, thickness_mm: NDArray) -> list[float]:
    """Those thicknesses whose slabs the tables alone press: what a calibration can correct."""
    # slabs under a filleted punch have tables too
    sharp = replace(request, edge_radius_mm=0.0)
    return [one for one in thickness_mm.tolist() if not why_solved(sharp, punch, one)]


def check_calibrated(request: Request, punch: Punch, thickness_mm: NDArray) -> None:
    """Refuse to design with a calibration where its corrections have nothing to act on: the tables of glued slabs."""
    free = correctable(request, punch, thickness_mm)
    why = why_solved(replace(request, edge_radius_mm=0.0), punch, float(thickness_mm[-1]))
    instead = f" or up to --thickness {free[0]:g}:{free[-1]:g}" if free else ""
    if request.base != "bonded":
        why = f"base = {request.base} is not in them"
    elif request.face != "bonded" and punch.profile_mm is None:
        why = f"condition = {request.face} is not in them"
    if why:
        raise InputError(
            "a calibration corrects the tables of glued pads under flat glued punches, and "
            f"{why}: design without it (--calibration none){instead}",
            "not_applicable",
            "calibration",
        )


def pad_of_request(request: Request, punch: Punch, thickness_mm: float = 10.0, young_MPa: float = 1.0) -> Pad:
    """The slab of a request as the pad model takes it."""
    return Pad(
        thickness_mm,
        young_MPa,
        punch.radius_mm,
        base=request.base,
        sides_mm=punch.sides_mm,
        extent_mm=sqrt(request.pad_mm[0] * request.pad_mm[1] / pi),
        slab_mm=request.pad_mm,
        profile_mm=punch.profile_mm,
        edge_radius_mm=request.edge_radius_mm,
        condition=request.face,
    )


FORCE_N, VELOCITY_MM_S, HOLD_S = (0.05, 300.0), (0.1, 5000.0), (0.05, 3600.0)
MOST = 8
LEAST_SIDE = 1.5
"""Shortest side of a pad over the longer side of the punch: nearer to the rim nothing was compared with."""
KNOWN_FORCE_N = (5.0, 15.0)
"""Steady forces between which the built-in tissues are known."""


def check_test(request: Request, punch: Punch) -> None:
    """Refuse what no pad can be pressed with, before any work."""
    check_numbers(request.force_N, request.velocity_mm_s, request.hold_s)
    least = LEAST_SIDE * punch.length_mm
    length, width = request.pad_mm
    if not (isfinite(length) and isfinite(width) and min(length, width) >= least):
        raise InputError(
            f"pad = {length:g}x{width:g} mm is too small for the punch {request.punch}: the smallest that is designed "
            f"is {least:g}x{least:g}, {LEAST_SIDE:g} times the punch",
            "out_of_range",
            "pad_mm",
            request.pad_mm,
        )
    Interface.parse(request.base, "base", BASES)
    friction = Interface.parse(request.face, "condition", CONDITIONS).friction
    if friction == 0.0 and not request.edge_radius_mm and not punch.profile_mm:
        raise InputError(
            f"condition = {request.face} under a sharp edge is solved to a tenth of a thin pad only, no depth "
            f"to design for: give the real edge's fillet, such as --edge-radius {0.1 * punch.half_width_mm:.2g}",
            "unsupported",
            "condition",
            request.face,
        )
    if request.edge_radius_mm:
        check_edge(request.edge_radius_mm, punch)
        if Interface.names_friction(request.base):
            raise InputError(
                f"edge_radius_mm = {request.edge_radius_mm:g} with base = {request.base} is not solved: "
                "leave the fillet out, or take base = sliding or bonded",
                "unsupported",
                "edge_radius_mm",
                request.edge_radius_mm,
            )
    _check_sites(request)
    if refused := refused_kinds(request, punch).get(request.kind.partition(":")[0].lower()):
        raise InputError(refused, "unsupported", "shape", request.kind)


def _check_sites(request: Request) -> None:
    """Several sites are those of round crowns, and what they do to each other is solved."""
    if request.sites is None:
        return
    sites = "x".join(f"{count}" for count in request.sites)
    name, colon, _ = request.kind.partition(":")
    if name.lower() != "crowned":
        message = f"sites = {sites} are of crowned pads, not of shape {request.shape}: leave --shape out"
        raise InputError(message, "conflict", "sites", sites)
    if colon:
        shape = read_shape(request.kind)
        if not shape.axisymmetric or len(shape.places_mm) > 1:
            message = f"sites = {sites} are of one round crown; leave ridge and sites out of shape {shape}"
            raise InputError(message, "conflict", "sites", sites)
    if not request.verify:
        message = f"sites = {sites}: that crowns are independent is solved; leave --no-verify out"
        raise InputError(message, "conflict", "sites", sites)


def check_numbers(
    force_N: tuple[float, ...] | None, velocity_mm_s: tuple[float, ...] | None, hold_s: float | None
) -> None:
    """Refuse forces, speeds and holds that no test has; None is not looked at."""
    for name, values, (low, high) in (
        ("force in N", force_N, FORCE_N),
        ("velocity in mm/s", velocity_mm_s, VELOCITY_MM_S),
        ("hold in s", None if hold_s is None else (hold_s,), HOLD_S),
    ):
        if values is None:
            continue
        if not 1 <= len(values) <= MOST:
            code, message = "too_large" if len(values) else "missing", f"{name}: {len(values)} values; give 1 to {MOST}"
            raise InputError(message, code, quantity_name(name), len(values), (1, MOST))
        for value in values:
            if not (isfinite(value) and low <= value <= high):
                raise out_of_range(name, f"{value:g}", low, high)


def check_edge(edge_radius_mm: float, punch: Punch) -> None:
    """Refuse a fillet that the punch cannot have."""
    from dummydesign.pad.axisymmetric.filleted import check_fillet

    if punch.profile_mm:
        message = f"edge_radius_mm = {edge_radius_mm:g} is of a flat punch, not of {punch.text}"
        raise InputError(message, "not_applicable", "edge_radius_mm", edge_radius_mm)
    check_fillet(edge_radius_mm, punch.half_width_mm)


def standard_press(request: Request) -> bool:
    """Whether punch, edge, face, pad and base are those that the tables and the tissues are made for."""
    test = request.punch, request.edge_radius_mm, request.face, request.base
    return (*test, *request.pad_mm) == (PUNCH, 0.0, "bonded", "bonded", PAD_LENGTH_MM, PAD_WIDTH_MM)


def refused_kinds(request: Request, punch: Punch) -> dict[str, str]:
    """Kinds of shapes that cannot be designed for a test, with the reason in one line."""
    reasons: dict[str, str] = {}
    for kind in designable_kinds():
        if kind == Slab.name:
            continue
        if punch.profile_mm:
            reasons[kind] = f"{kind} pads are designed under flat punches, not under {punch.text}"
        elif request.face != "bonded":
            press = "'predict' and 'whatif --fidelity axisymmetric' press round ones"
            reasons[kind] = f"{kind} pads are designed under a glued punch; with condition = {request.face} {press}"
        elif request.base != "bonded" and kind != "crowned":
            reasons[kind] = f"{kind} pads are designed on a glued base only"
        elif request.base != "bonded" and not request.verify:
            reasons[kind] = f"base = {request.base} is not in the tables of shapes; without --no-verify it is solved"
    return reasons


def own_warnings(request: Request, punch: Punch, tissue: Tissue, edge_known: bool) -> list[tuple[str, str]]:
    """What must be said of a test that is not the paper's; ``edge_known`` is whether the force knows the fillet."""
    notes = tissue_warnings(tissue, request.punch, request.edge_radius_mm, request.protocol.forces_N)
    if punch.sides_mm and not (punch.square and request.face == "bonded"):
        notes.append(
            (
                "equal_area_punch",
                f"the punch {request.punch} is taken as the circle of its area; 'predict "
                "--fidelity 3d' gives what its sides add",
            )
        )
    if request.edge_radius_mm and not edge_known:
        notes.append(("fillet", _fillet_words(request, punch)))
    return notes


def tissue_warnings(
    tissue: Tissue, punch: str, edge_radius_mm: float, forces_N: tuple[float, ...]
) -> list[tuple[str, str]]:
    """What must be said of a tissue in a test: under which punch and to which forces people were pressed."""
    notes = []
    built_in = tissue.origin == "built-in"
    if built_in and (punch != PUNCH or edge_radius_mm):
        edge = f" with an edge radius of {edge_radius_mm:g} mm" if edge_radius_mm else ""
        notes.append(
            (
                "tissue_punch",
                f"{tissue.name} is known under the 14 x 14 mm punch: under {punch}{edge} "
                "its ranges are those of another test; add your own tissue measured with it",
            )
        )
    low, high = pressed_N(tissue) or (0.0, inf)
    near = 1.0 if built_in else FORCE_FACTOR
    if far := [f"{force:g}" for force in forces_N if not low / near <= force <= high * near]:
        where, factor = " and ".join(far), beyond_people(forces_N, tissue)
        text = f"{tissue.name} is known from {low:.3g} to {high:.3g} N: at {where} N its law is extrapolated"
        if factor > 1.0:
            text += f"; {max(forces_N):g} N is {factor:.3g} times the largest force people were pressed to"
        notes.append(("force_not_in_band", text))
    return notes


def beyond_people(forces_N: tuple[float, ...], tissue: Tissue) -> float:
    """Return the largest steady force of a test over the largest that people were pressed to, at least 1."""
    return max(1.0, max(forces_N, default=0.0) / (pressed_N(tissue) or (0.0, inf))[1])


def pressed_N(tissue: Tissue) -> tuple[float, float] | None:
    """Return the lowest and largest steady force people of a tissue were pressed to, None where unknown. [N]

    Built-in tissues are known from 5 to 15 N; own tissues by their presses, at the end of the hold.
    """
    if tissue.origin == "built-in":
        return KNOWN_FORCE_N
    presses = [press for person in tissue.parameter_sets for press in getattr(person, "presses", ())]
    spans = [one.pressed[PRESSED[0]] for one in tissue.subjects if one.pressed]
    forces = [float(one.steady_N(one.hold_s)) for one in presses] + [
        end for one in spans for end in (one.low, one.high)
    ]
    return (min(forces), max(forces)) if forces else None


def _fillet_words(request: Request, punch: Punch) -> str:
    """What a fillet changes on a shaped pad: nothing while the contact lies inside the flat face."""
    inner = punch.half_width_mm - request.edge_radius_mm
    return (
        f"the pad is designed with a sharp edge, for it was not solved: a fillet of {request.edge_radius_mm:g} mm "
        f"changes nothing while the contact is inside {inner:.3g} mm from the centre, and beyond makes the pad softer "
        f"by up to what a punch {2 * request.edge_radius_mm:g} mm narrower would"
    )
