"""Families of shaped pads: what the search asks of each kind, and those over response tables."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import accepts, unknown_name
from dummydesign.core.quantity import Quantity
from dummydesign.design.scoring.crowns import Crowns
from dummydesign.design.scoring.press_simulation import PadRows
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import make_shape, part_of, shape_kind, shape_kinds
from dummydesign.mold.model.spec import PadGeometry
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.tables.elastic_law import elastic_factor, mean_drop_mm
from dummydesign.pad.tables.slab import load_table
from dummydesign.pad.tables.square import crown_factor


@dataclass(frozen=True, eq=False)
class Designs(PadRows):
    """M pads of one kind: thickness (M,) and the shape's parameters, name: (M,), in mm or without unit.

    ``limit_mm`` (M,) is the depth to which their force is known under the punch at hand, where it was worked out.
    """

    kind: str
    thickness_mm: NDArray
    parameters: dict[str, NDArray]
    limit_mm: NDArray | None = None

    @property
    def gel_mm(self) -> NDArray:
        """Thickness of the gel under the middle of the punch, shape (M,). [mm]"""
        return shape_kind(self.kind).gel_mm(self.thickness_mm, self.parameters)

    def shape(self, index: int) -> PadShape:
        """Shape of one pad."""
        return make_shape(self.kind, [(name, float(values[index])) for name, values in self.parameters.items()])

    def castable(self, pad_mm: tuple[float, float], least_film_mm: float = 0.0) -> NDArray:
        """Which pads of a length and width their own shape accepts, none thinner than a film, shape (M,)."""
        accepted = np.zeros(len(self.thickness_mm), dtype=bool)
        for index, thickness in enumerate(self.thickness_mm.tolist()):
            shape = self.shape(index)
            if accepts(shape.check, thickness, *pad_mm):
                accepted[index] = shape.least_gel_mm(PadGeometry(thickness, *pad_mm)) >= least_film_mm
        return accepted


class Family(Protocol):
    """Shapes of one kind with their force: a response surface, or a law."""

    kind: str
    source: str
    """Where the force comes from, a word: ``table`` or ``law``."""

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps inside the surface's range; not yet judged by castability."""

    def check(self, shape: PadShape) -> None:
        """Refuse a shape that the surface is not made for (``InputError``)."""

    def at_thickness(self, shape: PadShape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        """The same shape in proportion on pads of other thickness.

        Parameters
        ----------
        shape : PadShape
            Made for a pad of ``thickness_mm``.
        thickness_mm : float
            That pad. [mm]
        wanted_mm : ndarray, shape (M,)
            The other thicknesses. [mm]

        Returns
        -------
        Designs
            M of them.
        """

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over Young's modulus; NaN where the surface does not reach.

        Parameters
        ----------
        designs : Designs
            M pads.
        depth_mm : ndarray, shape (M, n)
            Depths on each. [mm]
        radius_mm : float
            Radius of the circle of the punch's area. [mm]

        Returns
        -------
        ndarray, shape (M, n)
            [mm2]
        """

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the surface holds, shape (M,); 0 outside its range. [mm]"""

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the force over the force.

        Parameters
        ----------
        designs : Designs
            M pads.
        depth_mm : ndarray, shape (M, n)
            Depths on each. [mm]
        radius_mm : float
            Radius of the circle of the punch's area. [mm]

        Returns
        -------
        ndarray, shape (M, n)
        """


@dataclass(frozen=True)
class FamilyLaw(ForceLaw):
    """Force law (:class:`~dummydesign.pad.force_law.ForceLaw`) of one shape on pads near its own thickness.

    Without ``cast`` the shape's heights go in proportion with the thickness, as in a study of thickness. With it
    they stay: a pad poured too thick from one mould has the same top on a thicker base. With ``crowns`` it is the law
    of as many pads, one a row, whose thickness at the tip has the crown's error in it.
    """

    family: Family
    shape: PadShape
    made_for_mm: float
    cast: bool = False
    crowns: Crowns | None = None

    @property
    def notes(self) -> tuple[str, ...]:  # type: ignore[override]
        """What a calibration says of the pads; empty without one."""
        return getattr(self.family, "notes", ())

    @property
    def plain(self) -> FamilyLaw:
        """The same without what a calibration changed, under the circle of the punch's area."""
        family = self.family
        while (under := getattr(family, "plain", None)) is not None:
            family = under
        return replace(self, family=family)

    def _designs(self, thickness_mm: NDArray) -> Designs:
        if not self.cast:
            return self.family.at_thickness(self.shape, self.made_for_mm, thickness_mm)
        same = {name: np.full(len(thickness_mm), value) for name, value in self.shape.parameters}
        if self.crowns is not None:
            same["height"] += self.crowns.higher_mm
            same["radius"] *= self.crowns.blunter
        return Designs(self.shape.name, thickness_mm, same)

    def with_crowns(self, crowns: Crowns) -> FamilyLaw:
        """The law of pads of this shape, as cast, whose crowns are off, one a row."""
        return replace(self, cast=True, crowns=crowns)

    def shape_at(self, thickness_mm: float) -> PadShape:
        """Shape of a pad of another thickness, with lengths in tenths of a millimetre."""
        return self._designs(np.array([float(thickness_mm)])).shape(0).rounded()

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Elastic force; zero above the surface, NaN beyond the law's depth; see
        :class:`dummydesign.pad.force_law.ForceLaw`. [N]
        """
        depth, thickness, young = (np.asarray(value, float) for value in (depth_mm, thickness_mm, young_MPa))
        if depth.ndim == 2 and thickness.shape == (len(depth), 1):
            # a row a pad, as curves are sampled: all pads at once
            return young * self.family.area_mm2(self._designs(thickness[:, 0]), depth, cast(float, radius_mm))
        return young * self._of_each(self.family.area_mm2, depth, thickness, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth to which the law holds. [mm]"""
        limit = self.family.limit_mm(self._flat(thickness_mm), cast(float, radius_mm))
        return np.asarray(limit).reshape(np.shape(thickness_mm))

    def gel_mm(self, thickness_mm: ArrayLike) -> NDArray:
        """Thickness of the gel under the middle of the punch, over a bone where there is one. [mm]"""
        pads = self._flat(thickness_mm)
        return np.asarray(self.shape.gel_mm(pads.thickness_mm, pads.parameters)).reshape(np.shape(thickness_mm))

    def _flat(self, thickness_mm: ArrayLike) -> Designs:
        return self._designs(np.atleast_1d(np.asarray(thickness_mm, float)).ravel())

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Stated error of the force over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        return self._of_each(self.family.relative_error, depth_mm, thickness_mm, radius_mm)

    def _of_each(
        self,
        quantity: Callable[[Designs, NDArray, float], NDArray],
        depth_mm: ArrayLike,
        thickness_mm: ArrayLike,
        radius_mm: ArrayLike,
    ) -> NDArray:
        """A quantity of the family, one pad after the other."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        values = np.empty(depth.shape)
        for value in np.unique(thickness):
            here, pad = thickness == value, self._designs(np.array([float(value)]))
            values[here] = quantity(pad, depth[here][None], cast(float, radius_mm))[0]
        return values


ROLE = "FAMILY"
BEYOND_END = 0.06


class TableFamily:
    """Shapes of one kind on their response table (:mod:`dummydesign.pad.tables.shape`)."""

    source = "table"

    def __init__(self, kind: str) -> None:
        from dummydesign.pad.tables.shape import load_shape_table

        self.kind = kind
        self._shape = shape_kind(kind)
        self.table = load_shape_table(kind)

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps inside the table's range; not yet judged by castability."""
        thickness, parameters = self._shape.candidates(np.asarray(thickness_mm, float), radius_mm)
        designs = Designs(self.kind, thickness, parameters)
        return designs.take(self.table.inside(self._raw(designs, radius_mm)))

    def check(self, shape: PadShape) -> None:
        """Refuse a shape that is not of the kind's tabulated form (``InputError``)."""
        from dummydesign.pad.tables.shape import TabulatedShapeLaw

        TabulatedShapeLaw(shape)

    def at_thickness(self, shape: PadShape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        """The same shape in the proportion of its kind (:meth:`PadShape.in_proportion`); see :class:`Family`."""
        wanted = np.asarray(wanted_mm, float)
        grows = self._shape.in_proportion(wanted / thickness_mm)
        scaled = {name: value * grows.get(name, np.ones_like(wanted)) for name, value in shape.parameters}
        return Designs(self.kind, wanted, scaled)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over modulus; NaN where the table does not reach; see :class:`Family`. [mm2]"""
        depth = np.asarray(depth_mm, float)
        limit = self.limit_mm(designs, radius_mm) if designs.limit_mm is None else designs.limit_mm
        inputs, row = self._inputs(designs, radius_mm), np.broadcast_to(np.arange(len(limit))[:, None], depth.shape)
        pads = designs.thickness_mm, np.full(len(limit), radius_mm), designs.parameters.get("radius", limit)
        area = self.table.area_mm2(inputs, row, depth, limit[row], *(value[row] for value in pads))
        return np.where(limit[row] > 0.0, area, np.nan)

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the table holds, shape (M,); 0 outside its range. [mm]"""
        inputs, thickness = self._inputs(designs, radius_mm), designs.thickness_mm
        inside = self.table.inside(inputs)
        if not self.table.similarity.over_tip:
            low, high = load_table("bonded").ratio_range
            inside &= (radius_mm / thickness >= low) & (radius_mm / thickness <= high)
        return np.where(inside, self.table.limit_mm(inputs, thickness, np.asarray(radius_mm)), 0.0)

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the force over the force; see :class:`Family`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), designs.thickness_mm[:, None])
        row = np.broadcast_to(np.arange(len(thickness))[:, None], depth.shape)
        inputs = self._inputs(designs, radius_mm)
        return self.table.force_error(inputs, row, depth, thickness, np.full(depth.shape, radius_mm))

    def _inputs(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs of the table, shape (M, k); those a little outside, as of a pad poured too thin, are at its end."""
        raw = self._raw(designs, radius_mm)
        held = np.clip(raw, self.table.low, self.table.high)
        return np.where(np.abs(raw - held) <= BEYOND_END * np.abs(raw), held, raw)

    def _raw(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs as :func:`dummydesign.pad.tables.shape.ratios` gives them for one shape."""
        return self._shape.numbers(designs.parameters, designs.thickness_mm, np.asarray(radius_mm, float))


FamilyFactor = Callable[[Designs, NDArray, float], tuple[NDArray, NDArray]]
"""Factor of the force of designs (M,) at depths (M, n) under a radius, and its relative error."""


@dataclass(frozen=True)
class ChangedFamily:
    """Shapes of one kind with another force; all but the force is the plain family's."""

    plain: Family

    def __getattr__(self, name: str) -> Any:
        return getattr(self.__dict__["plain"], name)


@dataclass(frozen=True)
class ScaledFamily(ChangedFamily):
    """Shapes of one kind whose force has a factor."""

    factor: FamilyFactor

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over modulus; see :class:`Family`. [mm2]"""
        return self.plain.area_mm2(designs, depth_mm, radius_mm) * self.factor(designs, depth_mm, radius_mm)[0]

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the table and of the factor; see :class:`Family`."""
        return self.plain.relative_error(designs, depth_mm, radius_mm) + self.factor(designs, depth_mm, radius_mm)[1]


def under_square(family: Family) -> Family:
    """The family under a square punch; only that of crowns knows the corners."""

    def corners(designs: Designs, depth_mm: NDArray, radius_mm: float) -> tuple[NDArray, NDArray]:
        crowns = {name: values[:, None] for name, values in designs.parameters.items()}
        return crown_factor(depth_mm, designs.thickness_mm[:, None], radius_mm, crowns)

    return cast(Family, ScaledFamily(family, corners)) if family.kind == "crowned" else family


def with_elastic_law(family: Family, alpha: Quantity) -> Family:
    """The family of a resin whose elastic law is not neo-Hookean."""

    def stiffening(designs: Designs, depth_mm: NDArray, radius_mm: float) -> tuple[NDArray, NDArray]:
        pads = range(len(designs.thickness_mm))
        drop = np.array([mean_drop_mm(designs.shape(index), radius_mm) for index in pads])[:, None]
        return elastic_factor(depth_mm, designs.thickness_mm[:, None], radius_mm, alpha, family.kind, drop)

    return cast(Family, ScaledFamily(family, stiffening))


def designable_kinds() -> tuple[str, ...]:
    """Kinds of shapes that a search can take: those with a response table or a family of their own."""
    kinds, room = shape_kinds().items(), __package__
    return tuple(name for name, kind in kinds if kind.similarity is not None or part_of(name, ROLE, room))


def load_family(kind: str) -> Family:
    """Load the family of one kind: its own (``FAMILY`` of a module here of its name), else that of its table.

    Raises
    ------
    InputError
        For a kind without either.
    """
    if kind not in designable_kinds():
        raise unknown_name("family of shapes", kind, designable_kinds())
    return part_of(kind, ROLE, __package__) or _table_family(kind)


_table_family = lru_cache(TableFamily)
