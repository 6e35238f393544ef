"""The families of shapes that can be designed with: each kind over its response table, or by a law it brings."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import unknown_name
from dummydesign.design.scoring.verdict_limits import verdict_limits
from dummydesign.design.search.shape_family import Designs, Family
from dummydesign.geometry.shapes import PadShape, part_of, shape_kind, shape_kinds
from dummydesign.pad.tables.shape import ShapeLaw, ShapeTable, load_shape_table
from dummydesign.pad.tables.slab import load_table

ROLE = "FAMILY"
BEYOND_END = 0.06


class TableFamily:
    """Shapes of one kind on their response table (:mod:`dummydesign.pad.tables.shape`)."""

    source = "table"

    def __init__(self, kind: str) -> None:
        self.kind = kind
        self._shape = shape_kind(kind)
        self.table: ShapeTable = load_shape_table(kind)

    @property
    def provenance(self) -> dict[str, object]:
        """How the table was made."""
        return self.table.provenance

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps inside the table's range; not yet judged by castability."""
        thickness, parameters = self._shape.candidates(np.asarray(thickness_mm, float), radius_mm)
        designs = Designs(self.kind, thickness, parameters)
        return designs.take(self.table.inside(self._raw(designs, radius_mm)))

    def check(self, shape: PadShape) -> None:
        """Refuse a shape that is not of the kind's tabulated form.

        Raises
        ------
        InputError
            Naming what the table is made for.
        """
        ShapeLaw(shape)

    def at_thickness(self, shape: PadShape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        """The same shape in the proportion of its kind (:meth:`PadShape.in_proportion`); see :class:`Family`."""
        wanted = np.asarray(wanted_mm, float)
        k = wanted / thickness_mm
        grows = self._shape.in_proportion(k)
        one = np.ones_like(k)
        scaled = {name: value * grows.get(name, one) for name, value in shape.parameters}
        return Designs(self.kind, wanted, scaled)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over modulus; NaN where the table does not reach; see :class:`Family`. [mm2]"""
        inputs = self._inputs(designs, radius_mm)
        h = designs.thickness_mm[:, None]
        depth = np.maximum(np.asarray(depth_mm, float), 0.0)
        known = designs.limit_mm
        limit = (self.limit_mm(designs, radius_mm) if known is None else known)[:, None]
        held = np.minimum(depth, limit)
        place = np.broadcast_to(np.arange(len(inputs))[:, None], depth.shape)
        value, _ = self.table.log_factor(inputs, place, held / h)
        if self.table.similarity.over_tip:
            base = 16.0 / 9.0 * np.sqrt(designs.parameters["radius"])[:, None] * held**1.5
        else:
            base = load_table("bonded").force(held, h, 1.0, radius_mm)
        return np.where((depth <= limit * (1.0 + 1e-9)) & (limit > 0.0), base * np.exp(value), np.nan)

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the table holds and the gel is not bottomed out, shape (M,); 0 outside its range. [mm]"""
        inputs = self._inputs(designs, radius_mm)
        limit = self.table.depth_limit(inputs)
        inside = self.table.inside(inputs)
        if not self.table.similarity.over_tip:
            slab = load_table("bonded")
            low, high = slab.ratio_range
            ratio = radius_mm / designs.thickness_mm
            inside &= (ratio >= low) & (ratio <= high)
            limit = np.minimum(limit, slab.depth_limit(np.clip(ratio, low, high)))
        bottom_mm = verdict_limits().gel_compression * self._shape.gel_mm(designs.thickness_mm, designs.parameters)
        return np.where(inside, np.minimum(limit * designs.thickness_mm, bottom_mm), 0.0)

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the force over the force; see :class:`Family`."""
        return self.table.relative_error(depth_mm / designs.thickness_mm[:, None])

    def _inputs(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs of the table, shape (M, k); those a little outside, as of a pad poured too thin, are at its end."""
        raw = self._raw(designs, radius_mm)
        held = np.clip(raw, self.table.low, self.table.high)
        return np.where(np.abs(raw - held) <= BEYOND_END * np.abs(raw), held, raw)

    def _raw(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs as :func:`dummydesign.pad.tables.shape.ratios` gives them for one shape."""
        return self._shape.numbers(designs.parameters, designs.thickness_mm, radius_mm)


def designable_kinds() -> tuple[str, ...]:
    """Kinds of shapes that a search can take: those with a response table or a family of their own."""
    return tuple(name for name, kind in shape_kinds().items() if kind.similarity is not None or _own_family(name))


def load_family(kind: str) -> Family:
    """Load the family of one kind: its own (``FAMILY`` of a module here of its name), else that of its table.

    Raises
    ------
    InputError
        For a kind without either.
    """
    if kind not in designable_kinds():
        raise unknown_name("family of shapes", kind, designable_kinds())
    return _own_family(kind) or _table_family(kind)


def _own_family(kind: str) -> Family | None:
    return part_of(kind, ROLE, __package__)


@lru_cache
def _table_family(kind: str) -> TableFamily:
    return TableFamily(kind)
