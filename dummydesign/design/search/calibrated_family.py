"""A family of shapes with what a measured campaign taught of its pads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.search.shape_family import Designs, Family
from dummydesign.geometry.shapes import PadShape, read_shape
from dummydesign.pad.tables.compressibility import load_compressibility

if TYPE_CHECKING:
    from dummydesign.loop.corrected_law import Correction

OTHER = "another"


@dataclass(frozen=True)
class CalibratedFamily:
    """Shapes of one kind (:class:`~dummydesign.design.search.shape_family.Family`) as a calibration corrects them.

    Attributes
    ----------
    plain : Family
    correction : Correction
    """

    plain: Family
    correction: Correction

    @property
    def kind(self) -> str:
        """Name of the kind."""
        return self.plain.kind

    @property
    def source(self) -> str:
        """Where the plain force comes from: ``table`` or ``law``."""
        return self.plain.source

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the design must know of the effects in it."""
        return self.correction.notes(shaped=True)

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps; see :class:`Family`."""
        return self.plain.candidates(thickness_mm, radius_mm)

    def check(self, shape: PadShape) -> None:
        """Refuse a shape that the plain family is not made for; see :class:`Family`."""
        self.plain.check(shape)

    def at_thickness(self, shape: PadShape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        """The same shape in proportion; see :class:`Family`."""
        return self.plain.at_thickness(shape, thickness_mm, wanted_mm)

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the plain force is known; see :class:`Family`. [mm]"""
        return self.plain.limit_mm(designs, radius_mm)

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the plain force; see :class:`Family`."""
        return self.plain.relative_error(designs, depth_mm, radius_mm)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over modulus; see :class:`Family`. [mm2]"""
        depth = np.atleast_2d(np.asarray(depth_mm, float))
        thickness = designs.thickness_mm[:, None]
        limit = self.limit_mm(designs, radius_mm)[:, None]
        law = _PlainForce(self.plain, designs, radius_mm)
        return self.correction.apply(law, depth, thickness, limit, self._pressed(designs))

    def _pressed(self, designs: Designs) -> list[str]:
        """For each pad the shape of the campaign that it has, or a word that no pad has."""
        found = np.full(len(designs.thickness_mm), OTHER, dtype=object)
        for text in set(self.correction.calibration.after.shapes) - {""}:
            shape = read_shape(text)
            if shape.name == self.kind:
                same = [np.isclose(designs.parameters[name], value, rtol=1e-6) for name, value in shape.parameters]
                found[np.logical_and.reduce(same)] = text
        return list(found)


@dataclass(frozen=True)
class _PlainForce:
    """F / E of M pads, and how a bulk that gives changes it: as on slabs."""

    family: Family
    designs: Designs
    radius_mm: float

    def __call__(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        return self.family.area_mm2(self.designs, depth_mm, self.radius_mm)

    def give(self, depth_mm: NDArray, thickness_mm: NDArray) -> NDArray:
        return load_compressibility().coefficient(depth_mm / thickness_mm, self.radius_mm / thickness_mm)
