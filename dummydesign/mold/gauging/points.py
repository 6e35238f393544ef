"""Gauge points of a pad: name, place, nominal thickness and limits. No CAD."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from dummydesign.geometry.limits import RIM_FREE_MM
from dummydesign.mold.model.spec import MouldSpec

# A gauge point keeps this distance from the rounded edge of the tested face. [mm]
EDGE_CLEAR_MM = 1.0
CORNERS = ((1, 1), (-1, 1), (-1, -1), (1, -1))


@dataclass(frozen=True)
class GaugePoint:
    """One place of the pad, from its middle: x along the length, y across, seen on the tested face. [mm]

    ``nominal_mm`` is the thickness from the base to the tested face, ``gel_mm`` the part of it that is gel: less over a
    bone. ``pressed`` says that the gel there is what lies under the punch.
    """

    name: str
    x_mm: float
    y_mm: float
    nominal_mm: float
    low_mm: float
    high_mm: float
    gel_mm: float
    pressed: bool

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values."""
        return asdict(self)


def gauge_points(spec: MouldSpec) -> tuple[GaugePoint, ...]:
    """Return the gauge points of a pad: tips or middle, what its shape adds, four corners.

    Nominal values come from the shape's own heights. Each limit is the preset's share of the pad's full thickness on
    either side: a plate that lies too high adds as much at every point.

    Parameters
    ----------
    spec : MouldSpec
        The mould of the pad.

    Returns
    -------
    tuple of GaugePoint
    """
    pad, shape = spec.pad, spec.pad.shape
    first = "middle" if shape.flat_top else "tip"
    shift = (0.0, 0.0) if spec.insert is None else (spec.insert.placing.x_mm, spec.insert.placing.y_mm)
    stands = [(x + shift[0], y + shift[1]) for x, y in shape.places_mm]
    places = {first if len(stands) == 1 else f"{first}{i}": place for i, place in enumerate(stands, 1)}
    places |= {} if pad.is_puck else shape.gauge_places(pad)
    corner = _corner(spec)
    places |= {f"{'edge' if pad.is_puck else 'corner'}{i}": (a * corner[0], b * corner[1])
               for i, (a, b) in enumerate(CORNERS, 1)}  # fmt: skip
    return tuple(_point(spec, name, place, stands) for name, place in places.items())


def _corner(spec: MouldSpec) -> tuple[float, float]:
    """Distances of a corner's gauge point from the pad's middle. [mm]"""
    pad, radius = spec.pad, spec.pad.corner_radius_mm
    most = min(RIM_FREE_MM, min(pad.length_mm, pad.width_mm) / 4)
    inset = max(most, pad.edge_radius_mm + EDGE_CLEAR_MM)
    # Inside the rounded corner the same distance from the edge, along the corner's diagonal.
    back = inset if radius <= inset else radius - (radius - inset) / math.sqrt(2.0)
    return pad.length_mm / 2 - back, pad.width_mm / 2 - back


def _point(
    spec: MouldSpec, name: str, place: tuple[float, float], stands: Sequence[tuple[float, float]]
) -> GaugePoint:
    pad, shape = spec.pad, spec.pad.shape
    x, y = np.array([place[0] - x for x, _ in stands]), np.array([place[1] - y for _, y in stands])
    nominal = pad.thickness_mm - float(np.min(shape.drop_mm(x, y)))
    gel = nominal - float(np.max(shape.bone_mm(x, y)))
    middle = pad.thickness_mm - shape.bone_height_mm
    allowed = pad.thickness_mm * spec.acceptance.thickness_percent / 100
    return GaugePoint(
        name, round(place[0], 2), round(place[1], 2), nominal, nominal - allowed, nominal + allowed, gel,
        abs(nominal - pad.thickness_mm) < 1e-9 and abs(gel - middle) < 1e-9,
    )  # fmt: skip


def points_of(listed: Sequence[dict[str, Any]]) -> tuple[GaugePoint, ...]:
    """Rebuild gauge points from plain values.

    Raises
    ------
    KeyError, TypeError
        When a value is missing or is unknown.
    """
    return tuple(GaugePoint(**one) for one in listed)


def points_rows(points: Sequence[GaugePoint], blank: str, first_pad: int = 1, pads: int = 1) -> list[tuple[str, ...]]:
    """Table of the gauge points with free columns, the first row its head.

    Parameters
    ----------
    points : sequence of GaugePoint
        Of one pad.
    blank : str
        What stands in a free column.
    first_pad, pads : int
        Number of the first pad of the table, and how many pads it has columns for.
    """
    bone = any(one.gel_mm < one.nominal_mm - 1e-9 for one in points)
    free = ["measured, mm"] if first_pad == pads == 1 else [f"pad {first_pad + i}, mm" for i in range(pads)]
    part = ["of it gel, mm"] if bone else []
    rows = [("gauge point", "x, mm", "y, mm", "nominal, mm", *part, "allowed, mm", *free)]
    for one in points:
        gel = [f"{one.gel_mm:.2f}"] if bone else []
        rows.append((one.name, f"{one.x_mm:g}", f"{one.y_mm:g}", f"{one.nominal_mm:.2f}", *gel,
                     f"{one.low_mm:.2f} to {one.high_mm:.2f}", *[blank] * pads))  # fmt: skip
    return rows
