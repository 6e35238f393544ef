"""The families of shapes that can be designed with: practical steps of each kind over its response table."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import unknown_name
from dummydesign.design.search.shape_family import Designs, Family, rounded
from dummydesign.geometry.shapes import Shape
from dummydesign.pad.tables.shape import TIPPED, ShapeLaw, ShapeTable, load_shape_table
from dummydesign.pad.tables.slab import load_table
from dummydesign.studies.tables.bumped_designs import bumped

FAMILIES = ("crowned", "bumped", "layered", "boned")
# Shapes that are tried, as shares of thickness and punch radius; lengths are rounded to tenths of a millimetre.
HEIGHT_SHARES = np.linspace(0.2, 0.74, 10)
FOOT_SHARES = np.geomspace(0.4, 1.7, 9)
POINTEDNESS = np.array([0.1, 0.14, 0.19, 0.25, 0.32, 0.4, 0.48, 0.56, 0.65])
TOP_SHARES = np.linspace(0.2, 0.8, 7)
MODULUS_RATIOS = np.array([0.1, 0.2, 0.4, 0.7, 1.5, 2.5, 5.0, 10.0])
BONE_SHARES = np.linspace(0.2, 0.7, 6)
PITCHES_MM = np.arange(3.5, 7.6, 0.5)
BEYOND_END = 0.06
GRADE_SHARES = np.linspace(0.05, 0.65, 9)


class TableFamily:
    """Shapes of one kind on their response table (:mod:`dummydesign.pad.tables.shape`)."""

    def __init__(self, kind: str) -> None:
        self.kind = kind
        self.table: ShapeTable = load_shape_table(kind)

    @property
    def provenance(self) -> dict[str, object]:
        """How the table was made."""
        return self.table.provenance

    def candidates(self, thickness_mm: NDArray, radius_mm: float) -> Designs:
        """Pads in practical steps inside the table's range; not yet judged by castability."""
        make = {"crowned": _crowned, "bumped": _bumped, "layered": _layered, "boned": _boned}[self.kind]
        thickness, parameters = make(np.asarray(thickness_mm, float), radius_mm)
        designs = Designs(self.kind, thickness, parameters)
        return designs.take(self.table.inside(self._raw(designs, radius_mm)))

    def check(self, shape: Shape) -> None:
        """Refuse a shape that is not of the kind's tabulated form.

        Raises
        ------
        InputError
            Naming what the table is made for.
        """
        ShapeLaw(shape)

    def at_thickness(self, shape: Shape, thickness_mm: float, wanted_mm: NDArray) -> Designs:
        """The same shape in proportion: heights go with the thickness, feet stay, and so does the form of the cap.

        Caps of a bumped pad stay as they are.
        """
        wanted = np.asarray(wanted_mm, float)
        k = wanted / thickness_mm
        grows = {} if self.kind == "bumped" else {"height": k, "top": k, "radius": 1.0 / k}
        one = np.ones_like(k)
        scaled = {name: value * grows.get(name, one) for name, value in shape.parameters}
        return Designs(self.kind, wanted, scaled)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """F / E at depths (M, n); NaN where the table does not reach. [mm2]"""
        inputs = self._inputs(designs, radius_mm)
        h = designs.thickness_mm[:, None]
        depth = np.maximum(np.asarray(depth_mm, float), 0.0)
        limit = self.limit_mm(designs, radius_mm)[:, None]
        held = np.minimum(depth, limit)
        place = np.broadcast_to(np.arange(len(inputs))[:, None], depth.shape)
        value, _ = self.table.log_factor(inputs, place, held / h)
        if self.kind in TIPPED:
            base = 16.0 / 9.0 * np.sqrt(designs.parameters["radius"])[:, None] * held**1.5
        else:
            base = load_table("bonded").force(held, h, 1.0, radius_mm)
        return np.where((depth <= limit * (1.0 + 1e-9)) & (limit > 0.0), base * np.exp(value), np.nan)

    def limit_mm(self, designs: Designs, radius_mm: float) -> NDArray:
        """Depth to which the table holds, shape (M,); 0 outside its range. [mm]"""
        inputs = self._inputs(designs, radius_mm)
        limit = self.table.depth_limit(inputs)
        inside = self.table.inside(inputs)
        if self.kind not in TIPPED:
            slab = load_table("bonded")
            low, high = slab.ratio_range
            ratio = radius_mm / designs.thickness_mm
            inside &= (ratio >= low) & (ratio <= high)
            limit = np.minimum(limit, slab.depth_limit(np.clip(ratio, low, high)))
        return np.where(inside, limit, 0.0) * designs.thickness_mm

    def relative_error(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Stated error of the force over the force at depths (M, n)."""
        return self.table.relative_error(depth_mm / designs.thickness_mm[:, None])

    def _inputs(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs of the table, shape (M, k); those a little outside, as of a pad poured too thin, are at its end."""
        raw = self._raw(designs, radius_mm)
        held = np.clip(raw, self.table.low, self.table.high)
        return np.where(np.abs(raw - held) <= BEYOND_END * np.abs(raw), held, raw)

    def _raw(self, designs: Designs, radius_mm: float) -> NDArray:
        """Inputs as :func:`dummydesign.pad.tables.shape.ratios` gives them for one shape."""
        h, p = designs.thickness_mm, designs.parameters
        if self.kind == "crowned":
            point = p["radius"] * p["height"] / p["foot"] ** 2
            columns = [h / radius_mm, p["height"] / h, p["foot"] / radius_mm, point]
        elif self.kind == "bumped":
            columns = [h / radius_mm, p["pitch"] / radius_mm, p["grade"] / p["height"]]
        elif self.kind == "layered":
            columns = [h / radius_mm, p["top"] / h, p["modulus_ratio"]]
        else:
            columns = [h / radius_mm, p["height"] / h, p["foot"] / radius_mm]
        return np.stack(columns, axis=-1)


@lru_cache
def load_family(kind: str) -> Family:
    """Load the family of one kind.

    Raises
    ------
    InputError
        For a kind without a response table.
    """
    if kind not in FAMILIES:
        raise unknown_name("family of shapes", kind, FAMILIES)
    return TableFamily(kind)


def _grid(*axes: NDArray) -> list[NDArray]:
    return [axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")]


def _crowned(thickness_mm: NDArray, radius_mm: float) -> tuple[NDArray, dict[str, NDArray]]:
    h, share, foot, point = _grid(thickness_mm, HEIGHT_SHARES, FOOT_SHARES, POINTEDNESS)
    height, foot = np.round(share * h, 1), np.round(foot * radius_mm, 1)
    return h, {"radius": np.round(point * foot**2 / height, 1), "height": height, "foot": foot}


def _bumped(thickness_mm: NDArray, radius_mm: float) -> tuple[NDArray, dict[str, NDArray]]:
    fields = [rounded(bumped(pitch, share)) for pitch in PITCHES_MM for share in GRADE_SHARES]
    h, index = _grid(thickness_mm, np.arange(len(fields)))
    names = [name for name, _ in fields[0].parameters]
    values = np.array([[value for _, value in field.parameters] for field in fields])
    return h, {name: values[index.astype(int), column] for column, name in enumerate(names)}


def _layered(thickness_mm: NDArray, radius_mm: float) -> tuple[NDArray, dict[str, NDArray]]:
    h, share, ratio = _grid(thickness_mm, TOP_SHARES, MODULUS_RATIOS)
    return h, {"top": np.round(share * h, 1), "modulus_ratio": ratio}


def _boned(thickness_mm: NDArray, radius_mm: float) -> tuple[NDArray, dict[str, NDArray]]:
    h, share, foot = _grid(thickness_mm, BONE_SHARES, FOOT_SHARES)
    height, foot = np.round(share * h, 1), np.round(foot * radius_mm, 1)
    # A spherical dome of that height and foot.
    return h, {"radius": np.round((foot**2 + height**2) / (2.0 * height), 1), "height": height, "foot": foot}
