"""What is verified of shaped pads: the cap on a layer, and the slab as the limit of every shape."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.boned import Boned
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.geometry.shapes.layered import Layered
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.force_source import solve_points
from dummydesign.pad.pad_under_punch import Pad
from studies.verification.check import Check

GROUP = "Shaped pads"
# f(c) of a frictionless cap on an incompressible layer glued to its base, F = 16/9 E sqrt(R) d^1.5 f(c).
CAP_ON_LAYER = {0.185: 1.270, 0.417: 1.857, 0.554: 2.381, 0.748: 3.371, 1.054: 5.563, 1.349: 8.468}
SMALL = 4e-4


def _uncast(shape: PadShape) -> PadShape:
    """The shape without the workshop's limits: it is solved and never cast."""
    kind = type(shape)
    return type(kind.__name__, (kind,), {"check": lambda *_: None})(**vars(shape))


def _paraboloid(radius: float, foot: float) -> PadShape:
    return _uncast(Crowned(radius, foot**2 / (2.0 * radius), foot))


def cap_on_layer() -> Iterator[Check]:
    """Small strain: a shallow paraboloid on a layer, for c = sqrt(R d) / h."""
    for c, factor in CAP_ON_LAYER.items():
        radius = c**2 / SMALL
        reach = 2.0 * c + 1.0
        shape = _paraboloid(radius, reach + 3.0)
        curve = solve_shaped_pad(
            Pad(1.0, 1.0, reach, extent_mm=reach + 6.0, geometry=shape, condition="frictionless"),
            [0.25 * SMALL, SMALL],
            cells=48,
        )
        value = float(curve.force_N[-1]) / (16.0 / 9.0 * np.sqrt(radius) * SMALL**1.5)
        yield Check(GROUP, f"cap on a layer, f at c = {c:g}", factor, value, 2e-3, "integral equation of the layer")


def slab_limits() -> Iterator[Check]:
    """Every shape becomes the slab: a crown that is nearly flat, equal layers, a bone far below."""
    depth, radius = 1.5, 7.9
    slab = solve_curve(Pad(8.0, 0.05, radius), [0.5 * depth, depth])
    expected = float(slab.force_N[-1])
    flat: tuple[tuple[str, PadShape], ...] = (
        ("equal layers", Layered(3.0, 1.0)),
        ("bone of 0.01 mm", _uncast(Boned(2000.0, 0.01))),
    )
    for name, shape in flat:
        curve = solve_shaped_pad(Pad(8.0, 0.05, radius, geometry=shape), [0.5 * depth, depth])
        value = float(curve.force_N[-1]) / expected
        yield Check(GROUP, f"{name}, over the slab, d/h 0.19", 1.0, value, 3e-3, "the slab, solved as one")
    flat_crown = _paraboloid(2e4, 11.0)
    curve = solve_shaped_pad(Pad(8.0, 0.05, radius, geometry=flat_crown), [0.5 * depth, depth])
    name, source = "crown of 0.003 mm, over the slab, d/h 0.19, sharp edge", "the slab; tolerance: the stated error"
    stated = float(curve.error_N[-1] / curve.force_N[-1])
    yield Check(GROUP, name, 1.0, float(curve.force_N[-1]) / expected, stated, source)
    pads = [Pad(8.0, 0.05, radius, geometry=shape, edge_radius_mm=0.4) for shape in (flat_crown, Slab())]
    crown, filleted = (solve_points(pad, [0.5 * depth, depth]) for pad in pads)
    stated = float(sum(curve.error_N[-1] / curve.force_N[-1] for curve in (crown, filleted)))
    name = "crown of 0.003 mm, over the slab, d/h 0.19, fillet of 0.4 mm"
    source = "the slab on cells of its own; tolerance: the stated errors"
    yield Check(GROUP, name, 1.0, float(crown.force_N[-1] / filleted.force_N[-1]), stated, source)
