"""Response tables of shaped pads: their force without finite elements, as a force law of one shape.

Crowned pads: ln of F over Hertz's force of the tip, 16/9 E sqrt(R) d^1.5, as a function of depth, ln(h / a), c / h,
ln(b / a) and ln s, s = R c / b^2 (apex radius R, height c and foot radius b of the crown, thickness h, punch radius a),
in pieces that are joined where the punch's edge is reached (:mod:`dummydesign.pad.tables.crowned`). At first
touch it is 0. Layered and boned pads: ln of F over the force of
the slab of the upper resin, which is taken from the slab's own table.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import user_library as json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.user_library import fill_table
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.pad_shape import PadShape, Similarity
from dummydesign.geometry.shape_registry import shape_kinds
from dummydesign.pad.force_law import Array, ForceLaw
from dummydesign.pad.tables.crowned import CrownResponse, Response
from dummydesign.pad.tables.slab import load_table

Surface = Response | CrownResponse


def tabulated_kinds() -> dict[str, Similarity]:
    """Kinds of shapes with a response table, by name, and the numbers it is over."""
    return {name: kind.similarity for name, kind in shape_kinds().items() if kind.similarity is not None}


def ratios(shape: PadShape, thickness_mm: Array, radius_mm: Array) -> Array:
    """Numbers of the shape's response table."""
    h, a = np.broadcast_arrays(np.asarray(thickness_mm, dtype=float), np.asarray(radius_mm, dtype=float))
    given: dict[str, Any] = dict(shape.parameters)
    return shape.numbers(given, h, a)


@dataclass(frozen=True)
class ShapeTable:
    """Response surface of one kind of shaped pad, what it is right for and how near it is."""

    kind: str
    response: Surface
    low: Array
    high: Array
    error_depth: Array
    error: Array
    solve_error: Array
    provenance: dict[str, Any]

    @property
    def similarity(self) -> Similarity:
        """The numbers the table is over, and what forces are divided by."""
        return tabulated_kinds()[self.kind]

    def inside(self, inputs: Array) -> Array:
        """Whether inputs (n, k) are in the table's range."""
        slack = 1e-9 * (1.0 + np.abs(self.high))
        return np.all((inputs >= self.low - slack) & (inputs <= self.high + slack), axis=-1)

    def check(self, inputs: Array, fidelity: str) -> None:
        """Refuse inputs outside the range; ``fidelity`` is what solves the shape there."""
        bad = inputs[~self.inside(inputs)]
        if not len(bad):
            return
        for name, value, low, high in zip(self.similarity.names, bad[0], self.low, self.high):
            if not low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9):
                ends, advice = (f"{low:.4g}", f"{high:.4g}"), f"use --fidelity {fidelity} outside the table"
                raise out_of_range(f"{self.kind} pad: {name}", f"{value:.4g}", *ends, advice, name)

    def coordinates(self, inputs: Array) -> Array:
        """Inputs as the response surface takes them."""
        return np.where(self.similarity.logarithms, np.log(np.maximum(inputs, 1e-300)), inputs)

    def log_factor(self, inputs: Array, row: Array, x: Array) -> Array:
        """ln of the force over that of the tip (crowned) or of the slab."""
        depth, coordinates = np.maximum(x, 0.0), self.coordinates(inputs)
        if not isinstance(self.response, Response):
            return self.response.along(coordinates, row, depth)
        return self.response.along(self.response.at_levels(coordinates), row, depth)[0]

    def depth_limit(self, inputs: Array) -> Array:
        """Largest valid d / h of inputs (n, k)."""
        return np.minimum(self.response.limit(self.coordinates(inputs)), MAX_DEPTH_OVER_THICKNESS)

    def relative_error(self, x: Array) -> Array:
        """Error of the force at relative depths: 95 % of fresh solves, and the solves' own, as a root of squares."""
        at = np.sqrt(np.maximum(np.asarray(x, dtype=float), 0.0))
        levels = np.sqrt(self.error_depth)
        return np.hypot(np.interp(at, levels, self.error), np.interp(at, levels, self.solve_error))

    def limit_mm(self, inputs: Array, thickness_mm: Array, radius_mm: Array) -> Array:
        """Depth to which the table and, where it is over a slab, the slab's hold pads with these inputs (n, k). [mm]"""
        limit = self.depth_limit(inputs)
        if not self.similarity.over_tip:
            slab = load_table("bonded")
            limit = np.minimum(limit, slab.depth_limit(np.clip(radius_mm / thickness_mm, *slab.ratio_range)))
        return limit * thickness_mm

    def area_mm2(
        self,
        inputs: Array,
        row: Array,
        depth_mm: Array,
        limit_mm: Array,
        thickness_mm: Array,
        radius_mm: Array,
        tip_mm: Array,
    ) -> Array:
        """Force over modulus; NaN beyond the limit. [mm2]

        ``inputs`` are (n, k); all else has the shape of ``row``, which says which of them; ``tip_mm`` is the radius of
        a rounded tip.
        """
        held = np.clip(depth_mm, 0.0, limit_mm)
        value = self.log_factor(inputs, row, held / thickness_mm)
        if self.similarity.over_tip:
            base = 16.0 / 9.0 * np.sqrt(tip_mm) * held**1.5
        else:
            base = load_table("bonded").force(held, thickness_mm, 1.0, radius_mm)
        return base * np.where(depth_mm > limit_mm * (1.0 + 1e-9), np.nan, np.exp(value))

    def force_error(self, inputs: Array, row: Array, depth_mm: Array, thickness_mm: Array, radius_mm: Array) -> Array:
        """Error of the force over the force: of the factor, and of the slab's table or of what the punch's edge does.

        Arguments as those of :meth:`area_mm2`.
        """
        x = depth_mm / thickness_mm
        if isinstance(self.response, Response):
            return self.relative_error(x) + load_table("bonded").relative_error(depth_mm, thickness_mm, radius_mm)
        return np.hypot(self.relative_error(x), self.response.doubt(self.coordinates(inputs), row, x))


class TabulatedShapeLaw(ForceLaw):
    """Force law of one shape (lengths fixed in mm) at any thickness and punch radius the table holds."""

    def __init__(self, shape: PadShape) -> None:
        if not shape.tabulated:
            message = f"shape = {shape} has no response table; known are round {', '.join(tabulated_kinds())}"
            raise InputError(message, "not_tabulated", "shape", str(shape))
        shape.check_tabulated()
        self.shape = shape
        self.table = load_shape_table(shape.name)

    def gel_mm(self, thickness_mm: ArrayLike) -> Array:
        """Thickness of the gel under the middle of the punch: the pad's, less a bone. [mm]"""
        return np.asarray(thickness_mm, float) - self.shape.bone_height_mm

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Static force; zero and negative depths carry none, NaN beyond the limit. [N]

        Thickness is that at the highest point, the modulus that of the upper resin.
        """
        values = (np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, young_MPa, radius_mm))
        d, h, young, a = np.broadcast_arrays(*values)
        inputs, row, pads = self._inputs(h, a)
        self.table.check(inputs, self.shape.fidelity)
        limit = self.table.limit_mm(inputs, *pads.T)[row]
        tip = np.full(h.shape, self.shape.tip_radius_mm or 0.0)
        return self.table.area_mm2(inputs, row, d, limit, h, a, tip) * np.where(d > 0.0, young, 0.0)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Largest valid depth. [mm]"""
        h, a = np.broadcast_arrays(np.asarray(thickness_mm, dtype=float), np.asarray(radius_mm, dtype=float))
        inputs = ratios(self.shape, h.ravel(), a.ravel())
        self.table.check(inputs, self.shape.fidelity)
        return self.table.limit_mm(inputs, h.ravel(), a.ravel()).reshape(h.shape)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force: finite elements and regression; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        d, h, a = np.broadcast_arrays(*(np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, radius_mm)))
        inputs, row, _ = self._inputs(h, a)
        return self.table.force_error(inputs, row, d, h, a)

    def _inputs(self, thickness_mm: Array, radius_mm: Array) -> tuple[Array, Array, Array]:
        """Numbers of the pads that differ, which of them each one is, and their thickness and punch radius."""
        pads, at = np.unique(np.stack([thickness_mm.ravel(), radius_mm.ravel()], axis=1), axis=0, return_inverse=True)
        return ratios(self.shape, *pads.T), np.asarray(at).reshape(thickness_mm.shape), pads


@lru_cache(maxsize=8)
def load_shape_table(kind: str) -> ShapeTable:
    """Read the shipped table of one of the tabulated kinds."""
    command = f"python -m studies.tables.shapes {kind}"
    return json_table.read(f"{kind}-bonded.json", "response table", command, from_dict)


def from_dict(data: dict[str, Any]) -> ShapeTable:
    """Table from the content of its file."""
    surface = data["surface"]
    parts = [part.name for part in fields(CrownResponse)]
    if parts[0] not in surface:
        return fill_table(ShapeTable, data, response=fill_table(Response, surface))
    pieces = {name: fill_table(Response, surface[name]) for name in parts}
    return fill_table(ShapeTable, data, response=CrownResponse(**pieces))
