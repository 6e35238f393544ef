"""Families of shaped pads: what the search over shapes asks of each kind."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.design.scoring.verdict_limits import verdict_limits
from dummydesign.geometry.shapes import PadShape, make_shape
from dummydesign.pad.force_law import BaseForceLaw


@dataclass(frozen=True)
class Designs:
    """M pads of one kind: thickness (M,) and the shape's parameters, name: (M,), in mm or without unit.

    ``limit_mm`` (M,) is the depth to which their force is known under the punch at hand, where it was worked out.
    """

    kind: str
    thickness_mm: NDArray
    parameters: dict[str, NDArray]
    limit_mm: NDArray | None = None

    def take(self, chosen: NDArray) -> Designs:
        """Keep the pads chosen by index or mask."""
        kept = {name: values[chosen] for name, values in self.parameters.items()}
        limit = None if self.limit_mm is None else self.limit_mm[chosen]
        return Designs(self.kind, self.thickness_mm[chosen], kept, limit)

    def shape(self, index: int) -> PadShape:
        """Shape of one pad."""
        return make_shape(self.kind, [(name, float(values[index])) for name, values in self.parameters.items()])

    def castable(self, pad_mm: tuple[float, float]) -> NDArray:
        """Which pads of a length and width their own shape accepts, shape (M,)."""
        accepted = np.zeros(len(self.thickness_mm), dtype=bool)
        for index, thickness in enumerate(self.thickness_mm):
            try:
                self.shape(index).check(float(thickness), *pad_mm)
            except InputError:
                continue
            accepted[index] = True
        return accepted


class Family(Protocol):
    """Shapes of one kind with their force: a response surface, or a law."""

    kind: str
    source: str
    """Where the force comes from, a word: ``table`` or ``law``."""

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps inside the surface's range; not yet judged by castability."""
        ...

    def check(self, shape: PadShape) -> None:
        """Refuse a shape that the surface is not made for (``InputError``)."""
        ...

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
        ...

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
        ...

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the surface holds, shape (M,); 0 outside its range. [mm]"""
        ...

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
        ...


@dataclass(frozen=True)
class ShapeLaw(BaseForceLaw):
    """Force law (:class:`~dummydesign.pad.force_law.ForceLaw`) of one shape on pads near its own thickness.

    Without ``cast`` the shape's heights go in proportion with the thickness, as in a study of thickness. With it
    they stay: a pad poured too thick from one mould has the same top on a thicker base.
    """

    family: Family
    shape: PadShape
    made_for_mm: float
    cast: bool = False

    @property
    def notes(self) -> tuple[str, ...]:  # type: ignore[override]
        """What a calibration says of the pads; empty without one."""
        return getattr(self.family, "notes", ())

    @property
    def plain(self) -> ShapeLaw:
        """The same without what a calibration changed."""
        return replace(self, family=getattr(self.family, "plain", self.family))

    def _designs(self, thickness_mm: NDArray) -> Designs:
        if not self.cast:
            return self.family.at_thickness(self.shape, self.made_for_mm, thickness_mm)
        same = {name: np.full(len(thickness_mm), value) for name, value in self.shape.parameters}
        return Designs(self.shape.name, thickness_mm, same)

    def shape_at(self, thickness_mm: float) -> PadShape:
        """Shape of a pad of another thickness, with lengths in tenths of a millimetre."""
        return self._designs(np.array([float(thickness_mm)])).shape(0).rounded()

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; zero above the surface, NaN beyond the law's depth; see
        :class:`dummydesign.pad.force_law.ForceLaw`. [N]
        """
        given = [np.asarray(value, float) for value in (depth_mm, thickness_mm, young_MPa)]
        if given[0].ndim == 2 and given[1].shape == (len(given[0]), 1):
            # a row a pad, as curves are sampled: all pads at once
            return given[2] * self.family.area_mm2(self._designs(given[1][:, 0]), given[0], radius_mm)
        depth, thickness, young = np.broadcast_arrays(*given)
        known, row = np.unique(thickness, return_inverse=True)
        row = row.reshape(thickness.shape)
        area = np.empty(depth.shape)
        designs = self._designs(known)
        for index in range(len(known)):
            here = row == index
            area[here] = self.family.area_mm2(designs.take(np.array([index])), depth[here][None], radius_mm)[0]
        return young * area

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth to which the law holds and the gel, over a bone where there is one, is not bottomed out. [mm]"""
        designs = self._designs(np.atleast_1d(np.asarray(thickness_mm, float)).ravel())
        gel = self.shape.gel_mm(designs.thickness_mm, designs.parameters)
        limit = np.minimum(self.family.limit_mm(designs, radius_mm), verdict_limits().gel_compression * gel)
        return limit.reshape(np.shape(thickness_mm))

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Stated error of the force over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        error = np.empty(depth.shape)
        for value in np.unique(thickness):
            here = thickness == value
            designs = self._designs(np.array([float(value)]))
            error[here] = self.family.relative_error(designs, depth[here][None], radius_mm)[0]
        return error
