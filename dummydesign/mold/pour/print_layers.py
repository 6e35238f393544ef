"""What the printer's layers do to a curved tested face, and so to the force. No CAD."""

from __future__ import annotations

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.acceptance import TOLD_DEPTH

ALLOWED_PERCENT = 1.0
PROBED_MM = 0.05


def height_cost(spec: MouldSpec, low_mm: float) -> float | None:
    """Change of the force when a curve is lower than designed, its apex radius and foot kept. [%]

    At a quarter of the thickness from touch, glued, under a square punch of 14 mm, by the shape's response table.

    Parameters
    ----------
    spec : MouldSpec
        Of a pad with a curved tested face.
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
    if not shape.relief_mm:
        return 0.0
    lower = tuple((name, value - low_mm if name == "height" else value) for name, value in shape.parameters)
    try:
        kinds = (shape, pad.thickness_mm), (make_shape(pad.kind, lower), pad.thickness_mm - low_mm)
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


def check_layers(spec: MouldSpec) -> None:
    """Refuse a printer whose layers are too thick for a curve.

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


def tip_words(spec: MouldSpec) -> str:
    """How true a curve's height must be, and what the advised layers cost; empty where that is not known."""
    allowed = allowed_layer_mm(spec)
    if allowed is None:
        return ""
    layer = spec.machines.layer_mm or formula.print_layer_mm(spec.pad.shape.relief_mm)
    return (
        f"{allowed / 2:.3f} mm of its height are {ALLOWED_PERCENT:g} % of force, and layers of {layer:.2g} mm may cost "
        f"{ALLOWED_PERCENT * layer / allowed:.1f} %"
    )
