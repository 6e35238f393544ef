"""What the printer's layers do to the pad's thickness, a curved tested face or a bone, and so to the force. No CAD."""

from __future__ import annotations

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.face_sheet import plug_top_mm
from dummydesign.mold.model.layout import layout
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import TOLD_DEPTH, force_at_thickness

ALLOWED_PERCENT = 1.0
PROBED_MM = 0.05
# Layers that slicers offer, the thickest first.
LAYERS_MM = (0.3, 0.25, 0.2, 0.15, 0.12, 0.1, 0.08, 0.06, 0.05)


def height_cost(spec: MouldSpec, low_mm: float) -> float | None:
    """Change of the force when a curve or a bone is lower than designed, its apex radius and foot kept. [%]

    At a quarter of the thickness from touch, glued, under a square punch of 14 mm, by the shape's response table.

    Parameters
    ----------
    spec : MouldSpec
        Of a pad with a curved tested face or a bone.
    low_mm : float
        How much the curve is too low. [mm]

    Returns
    -------
    float, or None
        0 for a flat face; None for a shape that no table holds.
    """
    from dummydesign.geometry.shapes import make_shape
    from dummydesign.geometry.standard import PUNCH_RADIUS_MM
    from dummydesign.pad.tables.shape import ShapeLaw

    pad, shape = spec.pad, spec.pad.shape
    if not (shape.relief_mm or shape.bone_height_mm):
        return 0.0
    lower = tuple((name, value - low_mm if name == "height" else value) for name, value in shape.parameters)
    try:
        # A low crown makes the pad thinner, a low bone leaves more gel over it.
        lost = low_mm if shape.relief_mm else 0.0
        kinds = (shape, pad.thickness_mm), (make_shape(pad.kind, lower), pad.thickness_mm - lost)
        force = [
            float(ShapeLaw(one).force(TOLD_DEPTH * pad.thickness_mm, np.array([h]), 1.0, PUNCH_RADIUS_MM)[0])
            for one, h in kinds
        ]
    except InputError:
        return None
    return 100 * (force[1] / force[0] - 1)


def allowed_layer_mm(spec: MouldSpec) -> float | None:
    """Thickest layer whose half, by which a tip may be too low, changes the force by 1 %. [mm]

    By the cost of 0.05 mm, to which it is proportional within a few per cent; None for a flat face, and where the cost
    is not known.
    """
    cost = height_cost(spec, PROBED_MM)
    return 2 * PROBED_MM * ALLOWED_PERCENT / abs(cost) if cost else None


def printed_thickness_mm(spec: MouldSpec, layer_mm: float) -> float:
    """Thickness of the pad when every height of the prints is rounded to a whole number of layers. [mm]

    The plug stands on the base plate; in an open mould a plate dips from its underside to the fill plane. A sheet let
    into the plug keeps its thickness, its pocket's floor is rounded.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    layer_mm : float
        Of the printer. [mm]
    """
    plan, box, aids = layout(spec), spec.box, spec.aids

    def printed(height: float) -> float:
        return layer_mm * round(height / layer_mm)

    sheet = box.face_sheet_mm + box.sheet_bond_mm if box.face_sheet_mm else 0.0
    plug = printed(box.base_mm + plug_top_mm(plan) - sheet) + sheet - printed(box.base_mm)
    dip = printed(aids.plate_mm + spec.body.freeboard_mm) - printed(aids.plate_mm)
    return (plug / plan.silicone_scale - dip) / plan.scale


def rounding_cost(spec: MouldSpec, layer_mm: float) -> float | None:
    """Change of the force at a given depth for :func:`printed_thickness_mm`; None where that is not known. [%]"""
    if abs(share := printed_thickness_mm(spec, layer_mm) / spec.pad.thickness_mm - 1) < 1e-9:
        return 0.0
    force = force_at_thickness(spec, (1 + share,))
    return None if force is None else 100 * (force[0] - 1)


def layer_words(spec: MouldSpec) -> str:
    """What whole layers make of the thickness, and so of the force; empty where the printer's layer is not said."""
    layer = spec.machines.layer_mm
    if not layer:
        return ""
    cost = rounding_cost(spec, layer)
    force = "" if cost is None else f", {cost:+.1f} % of force at a given depth"
    return f"whole layers of {layer:g} mm make the pad {printed_thickness_mm(spec, layer):.3f} mm thick{force}"


def check_layers(spec: MouldSpec) -> None:
    """Refuse a printer whose layers are too thick for a curve, or do not meet the heights of the mould.

    Raises
    ------
    InputError
        With the layer that is allowed, and what it costs.
    """
    layer, allowed = spec.machines.layer_mm, allowed_layer_mm(spec)
    if layer and allowed is not None and layer > allowed:
        raise InputError(
            f"layer_mm = {layer:g} of machines '{spec.machines.name}' may leave the tip of {spec.pad.shape} half a "
            f"layer low, {ALLOWED_PERCENT * layer / allowed:.1f} % of force; allowed is up to {allowed:.3f} mm "
            f"for {ALLOWED_PERCENT:g} %: machine the master or take a higher, flatter curve"
        )
    cost = rounding_cost(spec, layer) if layer else 0.0
    if cost is not None and abs(cost) > ALLOWED_PERCENT:
        good = [one for one in LAYERS_MM if one < layer and abs(rounding_cost(spec, one) or 0.0) <= ALLOWED_PERCENT]
        finer = f"layers of {good[0]:g} mm do" if good else "machine the master"
        raise InputError(
            f"layer_mm = {layer:g} of machines '{spec.machines.name}': {layer_words(spec)}; allowed is "
            f"{ALLOWED_PERCENT:g} %: {finer}, or take a thickness near "
            f"{printed_thickness_mm(spec, layer):.2f} mm"
        )


def tip_words(spec: MouldSpec) -> str:
    """How true a curve's height must be, and what the advised layers cost; empty where that is not known."""
    allowed = allowed_layer_mm(spec)
    if allowed is None:
        return ""
    tall = max(spec.pad.shape.relief_mm, spec.pad.shape.bone_height_mm)
    layer = spec.machines.layer_mm or formula.print_layer_mm(tall)
    return (
        f"{allowed / 2:.3f} mm of its height are {ALLOWED_PERCENT:g} % of force, and layers of {layer:.2g} mm may cost "
        f"{ALLOWED_PERCENT * layer / allowed:.1f} %"
    )
