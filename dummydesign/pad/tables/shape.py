"""Response tables of shaped pads: their force without finite elements, as a force law of one shape.

Crowned pads: ln of F over Hertz's force of the tip, 16/9 E sqrt(R) d^1.5, as a function of depth, ln(h / a), c / h,
ln(b / a) and ln s, s = R c / b^2 (apex radius R, height c and foot radius b of the crown, thickness h, punch radius a),
in pieces that are joined where the punch's edge is reached (:mod:`dummydesign.pad.tables.crown_surface`). At first
touch it is 0. Layered and boned pads: ln of F over the force of
the slab of the upper resin, which is taken from the slab's own table. Bumped pads, solved in space under a square
punch: the same over Hertz's force of the middle cap, for caps of one proportion (``Bumped.proportioned``), counted
against the volume that punch and field overlap by (:mod:`dummydesign.pad.tables.fields.surface`).
"""

from __future__ import annotations

from dataclasses import dataclass
from dataclasses import fields as parts
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dummydesign.core import json_table
from dummydesign.core.errors import InputError, out_of_range
from dummydesign.geometry.shapes import PadShape, Similarity, shape_kinds
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.pad.force_law import BaseForceLaw
from dummydesign.pad.tables.crown_surface import CrownResponse
from dummydesign.pad.tables.fields.surface import FieldResponse
from dummydesign.pad.tables.response_surface import Response, read_response
from dummydesign.pad.tables.slab import ResponseTable, load_table

Array = np.ndarray
Surface = Response | CrownResponse | FieldResponse


def tabulated_kinds() -> dict[str, Similarity]:
    """Kinds of shapes with a response table, by name, and the numbers it is over."""
    return {name: kind.similarity for name, kind in shape_kinds().items() if kind.similarity is not None}


def ratios(shape: PadShape, thickness_mm: Array, radius_mm: Array) -> Array:
    """Numbers of the shape's response table.

    Parameters
    ----------
    shape : PadShape
        A shape of a kind with a table.
    thickness_mm, radius_mm : ndarray, shape (n,), or a scalar
        Of pads and punches. [mm]

    Returns
    -------
    ndarray, shape (n, k)
        As :meth:`PadShape.numbers` gives them.
    """
    h, a = np.broadcast_arrays(np.asarray(thickness_mm, dtype=float), np.asarray(radius_mm, dtype=float))
    given: dict[str, Any] = dict(shape.parameters)
    return shape.numbers(given, h, a)


@dataclass(frozen=True)
class ShapeTable:
    """Response surface of one kind of shaped pad, what it is right for and how near it is.

    Attributes
    ----------
    kind, condition : str
    response : Response, CrownResponse or FieldResponse
        Over the numbers of the kind (:class:`~dummydesign.geometry.shapes.Similarity`), some by their logarithm.
    low, high : ndarray, shape (k,)
        Smallest and largest inputs that are answered.
    error_depth : ndarray, shape (m,)
        Relative depths d / h of the errors.
    median_error, error : ndarray, shape (m,)
        Relative: median and 95 % of fresh solves.
    solve_error : ndarray, shape (m,)
        Stated error of the solves themselves.
    provenance : dict
    """

    kind: str
    condition: str
    response: Surface
    low: Array
    high: Array
    error_depth: Array
    median_error: Array
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
        """Refuse inputs outside the range; ``fidelity`` is what solves the shape there.

        Raises
        ------
        InputError
            Naming the first that is outside.
        """
        bad = inputs[~self.inside(inputs)]
        if not len(bad):
            return
        for name, value, low, high in zip(self.similarity.names, bad[0], self.low, self.high):
            if not low * (1.0 - 1e-9) <= value <= high * (1.0 + 1e-9):
                advice = f"use --fidelity {fidelity} outside the table"
                raise out_of_range(f"{self.kind} pad: {name}", f"{value:.4g}", f"{low:.4g}", f"{high:.4g}", advice)

    def coordinates(self, inputs: Array) -> Array:
        """Inputs as the response surface takes them."""
        return np.where(self.similarity.logarithms, np.log(np.maximum(inputs, 1e-300)), inputs)

    def log_factor(self, inputs: Array, place: Array, x: Array) -> tuple[Array, Array]:
        """ln of the force over that of the tip (crowned) or of the slab, and its derivative with respect to d / h.

        Parameters
        ----------
        inputs : ndarray, shape (n, k)
            Numbers as :func:`ratios` gives them.
        place : ndarray of int
            Which of them each depth belongs to; any shape.
        x : ndarray
            Relative depths d / h of the same shape, >= 0.
        """
        depth, coordinates = np.maximum(x, 0.0), self.coordinates(inputs)
        if not isinstance(self.response, Response):
            return self.response.along(coordinates, place, depth)
        value, slope = self.response.along(self.response.at_levels(coordinates), place, depth)
        return value, slope / (2.0 * np.sqrt(np.maximum(depth, 1e-12)))

    def depth_limit(self, inputs: Array) -> Array:
        """Largest valid d / h of inputs (n, k)."""
        return np.minimum(self.response.limit(self.coordinates(inputs)), MAX_DEPTH_OVER_THICKNESS)

    def relative_error(self, x: Array) -> Array:
        """Error of the force at relative depths: 95 % of fresh solves, and the solves' own, as a root of squares."""
        at = np.sqrt(np.maximum(np.asarray(x, dtype=float), 0.0))
        levels = np.sqrt(self.error_depth)
        return np.hypot(np.interp(at, levels, self.error), np.interp(at, levels, self.solve_error))


class ShapeLaw(BaseForceLaw):
    """Force law of one shape (lengths fixed in mm) at any thickness and punch radius the table holds.

    Parameters
    ----------
    shape : PadShape
        Crowned, layered or boned, round; bumped with caps of the table's proportions.
    condition : str
        ``bonded``.

    Raises
    ------
    InputError
        For a shape or a condition without a table.
    """

    def __init__(self, shape: PadShape, condition: str = "bonded") -> None:
        if not shape.tabulated:
            raise InputError(f"shape = {shape} has no response table; known are round {', '.join(tabulated_kinds())}")
        shape.check_tabulated()
        self.shape = shape
        self.table = load_shape_table(shape.name, condition)
        self._tip_radius_mm = float(shape.tip_radius_mm or 0.0)
        self._slab: ResponseTable | None = None if self.table.similarity.over_tip else load_table("bonded")

    def inside(self, thickness_mm: Array, radius_mm: Array) -> Array:
        """Whether the table holds the pads (broadcast)."""
        return self.table.inside(ratios(self.shape, thickness_mm, radius_mm))

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Static force; zero and negative depths carry none, NaN beyond the depth limit. [N]

        Thickness is that at the highest point, the modulus that of the upper resin; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        return self.force_and_stiffness(depth_mm, thickness_mm, young_MPa, radius_mm)[0]

    def force_and_stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> tuple[Array, Array]:
        """Static force [N] and tangent stiffness dF/dd [N/mm]; see :meth:`ResponseTable.force_and_stiffness`."""
        d, h, young, a = np.broadcast_arrays(
            *(np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, young_MPa, radius_mm))
        )
        pads, place = self._pads(h, a)
        inputs = ratios(self.shape, *pads)
        self.table.check(inputs, self.shape.fidelity)
        x = np.maximum(d, 0.0) / h
        limit = self.table.depth_limit(inputs)[place]
        if self._slab is not None:
            limit = np.minimum(limit, self._slab.depth_limit(a / h))
        held = np.minimum(x, limit)
        value, slope = self.table.log_factor(inputs, place, held)
        depth, bend = held * h, slope / h
        if self._slab is None:
            base = 16.0 / 9.0 * young * np.sqrt(self._tip_radius_mm) * depth**1.5
            steep = 1.5 * base / np.maximum(depth, 1e-12)
        else:
            base, steep = self._slab.force_and_stiffness(depth, h, young, a)
        factor = np.exp(value)
        beyond = np.where(x > limit * (1.0 + 1e-9), np.nan, 1.0)
        touching = np.where(d > 0.0, 1.0, 0.0)
        return base * factor * beyond * touching, (steep + base * bend) * factor * beyond * touching

    def stiffness(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> Array:
        """Tangent stiffness dF/dd; see :class:`dummydesign.pad.force_law.ForceLaw`. [N/mm]"""
        return self.force_and_stiffness(depth_mm, thickness_mm, young_MPa, radius_mm)[1]

    def local_exponent(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """d ln F / d ln d at depths above 0; see :meth:`ResponseTable.local_exponent`."""
        force, stiffness = self.force_and_stiffness(depth_mm, thickness_mm, 1.0, radius_mm)
        return np.asarray(depth_mm, dtype=float) * stiffness / force

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Largest valid depth. [mm]"""
        h, a = np.broadcast_arrays(np.asarray(thickness_mm, dtype=float), np.asarray(radius_mm, dtype=float))
        inputs = ratios(self.shape, h.ravel(), a.ravel())
        self.table.check(inputs, self.shape.fidelity)
        limit = self.table.depth_limit(inputs).reshape(h.shape)
        if self._slab is not None:
            limit = np.minimum(limit, self._slab.depth_limit(a / h))
        return limit * h

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> Array:
        """Error of the force over the force: finite elements and regression; see
        :class:`dummydesign.pad.force_law.ForceLaw`.
        """
        depth, h, a = np.broadcast_arrays(
            *(np.asarray(v, dtype=float) for v in (depth_mm, thickness_mm, radius_mm))
        )
        error = self.table.relative_error(depth / h)
        return error if self._slab is None else error + self._slab.relative_error(depth, h, a)

    def depth_at_force(
        self, force_N: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> Array:
        """Depth of a force, NaN when out of reach; see :meth:`ResponseTable.depth_at_force`. [mm]"""
        force, h, young, a = np.broadcast_arrays(
            *(np.asarray(v, dtype=float) for v in (force_N, thickness_mm, young_MPa, radius_mm))
        )
        high = self.depth_limit_mm(h, a)
        out = ~(self.force(high, h, young, a) >= force)
        low = np.zeros_like(high)
        for _ in range(60):
            middle = 0.5 * (low + high)
            under = self.force(middle, h, young, a) < force
            low, high = np.where(under, middle, low), np.where(under, high, middle)
        return np.where(out, np.nan, 0.5 * (low + high))

    @staticmethod
    def _pads(h: Array, a: Array) -> tuple[tuple[Array, Array], Array]:
        """Pads that differ, as (thickness, punch radius), and which of them each entry is."""
        pairs, place = np.unique(np.stack([h.ravel(), a.ravel()], axis=1), axis=0, return_inverse=True)
        return (pairs[:, 0], pairs[:, 1]), np.asarray(place).reshape(h.shape)


@lru_cache(maxsize=8)
def load_shape_table(kind: str, condition: str = "bonded") -> ShapeTable:
    """Read a shipped table.

    Raises
    ------
    InputError
        For a kind or condition without a table.
    NoAnswerError
        When the file is missing or damaged, with the command that rebuilds it.
    """
    if kind not in tabulated_kinds():
        raise InputError(f"shape = '{kind}' has no table; known are {', '.join(tabulated_kinds())}")
    if condition != "bonded":
        raise InputError(f"condition = '{condition}' is not in the tables of shapes (only bonded); solve it instead")
    command = f"python -m dummydesign.studies.tables.shapes {kind}"
    return json_table.read(f"{kind}-{condition}.json", "response table", command, from_dict)


def from_dict(data: dict[str, Any]) -> ShapeTable:
    """Table from the content of its file."""
    listed = ("low", "high", "error_depth", "median_error", "error", "solve_error")
    fields: dict[str, Any] = {name: np.array(data[name], dtype=float) for name in listed}
    surface = data["surface"]
    form = next((form for form in (CrownResponse, FieldResponse) if parts(form)[0].name in surface), None)
    pieces = {part.name: read_response(surface[part.name]) for part in parts(form)} if form else {}
    response = form(**pieces) if form else read_response(surface)
    return ShapeTable(data["kind"], data["condition"], response, **fields, provenance=data["provenance"])
