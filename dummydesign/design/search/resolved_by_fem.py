"""Solve a shaped design again by finite elements: a search prefers designs whose table error is favourable.

The best of many pads by a table with an error is also the one whose error helps it most. So the pads that win are
solved, the table is multiplied by what the elements give over it, and ratio and scores are found anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.design.search.shape_family import ShapeLaw
from dummydesign.design.search.shapes import LOW_SHARE, Shaped
from dummydesign.design.search.slabs import search
from dummydesign.design.search.space import SearchSpace
from dummydesign.pad.force_law import BaseForceLaw

DEPTH_SHARES = np.linspace(0.04, 1.0, 16)
SOLVED = 3


@dataclass(frozen=True)
class ElementsLaw(BaseForceLaw):
    """Force law of one cast shape: its table times the elements' force over the table's, at the pad's own thickness.

    Attributes
    ----------
    table : ShapeLaw
        With the shape as cast.
    thickness_mm : float
    depth_mm, log_factor, error : ndarray, shape (n,)
        Solved depths, ln of elements over table there, and the elements' relative error.
    """

    table: ShapeLaw
    thickness_mm: float
    depth_mm: NDArray
    log_factor: NDArray
    error: NDArray

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        factor = np.exp(np.interp(depth_mm, self.depth_mm, self.log_factor))
        return factor * self.table.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth that the table holds and the elements reached. [mm]"""
        reached = self.depth_mm[-1] * np.asarray(thickness_mm, float) / self.thickness_mm
        return np.minimum(self.table.depth_limit_mm(thickness_mm, radius_mm), reached)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Error of the elements over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        shape = np.broadcast_shapes(np.shape(depth_mm), np.shape(thickness_mm))
        return np.interp(np.broadcast_to(depth_mm, shape), self.depth_mm, self.error)

    @property
    def largest_difference(self) -> float:
        """Largest relative difference of table and elements."""
        return float(np.max(np.abs(np.expm1(self.log_factor))))


def solve_law(shaped: Shaped, radius_mm: float) -> ElementsLaw:
    """Solve the best pad of a search, once for all moduli.

    Raises
    ------
    NoAnswerError
        When the elements reach fewer than two depths.
    """
    thickness, shape = shaped.found.best.thickness_mm, shaped.shape
    law = replace(shaped.law, cast=True)
    depth = float(law.depth_limit_mm(thickness, radius_mm)) * DEPTH_SHARES
    inputs = {"shape": str(shape), "thickness": thickness, "radius": radius_mm, "depth": depth}
    solve = _round if shape.axisymmetric else _field
    made = cached("design", inputs, lambda: solve(shaped, thickness, radius_mm, depth))
    reached, force = (np.asarray(made[name], float) for name in ("depth_mm", "force_N"))
    if len(reached) < 2:
        raise NoAnswerError("no_convergence", f"{shape} on {thickness:g} mm could not be solved by finite elements")
    factor = np.log(force / law.plain.force(reached, thickness, 1.0, radius_mm))
    return ElementsLaw(law, thickness, reached, factor, np.asarray(made["error_N"], float) / force)


def _round(shaped: Shaped, thickness_mm: float, radius_mm: float, depth_mm: NDArray) -> dict[str, Any]:
    from dummydesign.pad.shaped.axisymmetric import solve_shaped_pad

    return vars(solve_shaped_pad(shaped.shape, thickness_mm, radius_mm, 1.0, depth_mm))


def _field(shaped: Shaped, thickness_mm: float, radius_mm: float, depth_mm: NDArray) -> dict[str, Any]:
    """In space under the 14 x 14 mm punch; with a table, on its grid, whose stated error of the solves it has."""
    from dummydesign.pad.shaped.spatial import solve_shaped_block
    from dummydesign.pad.shaped.under_square import COARSE, HALF_SIDE_MM, press_field
    from dummydesign.pad.tables.shape import load_shape_table

    if not shaped.shape.tabulated:
        return vars(solve_shaped_block(shaped.shape, thickness_mm, (HALF_SIDE_MM,) * 2, 1.0, depth_mm))
    depth, area, _ = press_field(shaped.shape, thickness_mm, depth_mm / thickness_mm, COARSE)
    table = load_shape_table(shaped.shape.name)
    error = np.interp(depth, table.error_depth, table.solve_error)
    return {"depth_mm": depth * thickness_mm, "force_N": area, "error_N": area * error}


def on_elements(shaped: Shaped, space: SearchSpace) -> Shaped:
    """The same pad with ratio, scores and curves from its own finite elements.

    Raises
    ------
    NoAnswerError
        When it cannot be solved, or does not reach 10 N where it was.
    """
    law = solve_law(shaped, space.radius_mm)
    thickness = np.array([shaped.found.best.thickness_mm])
    best = search(law, replace(space, thickness_mm=thickness), LOW_SHARE, fitted=0).best
    return replace(shaped, found=replace(shaped.found, best=best), elements=law)


def _rank(shaped: Shaped) -> float:
    return shaped.worth


def solve_leading(designs: Sequence[Shaped], space: SearchSpace) -> tuple[Shaped, ...]:
    """Designs with the best round ones of each kind worked out on elements; those that cannot be solved fall away.

    Of every kind the first is solved, of the best kind the first three. Fields of caps take minutes in space and
    are solved, the first of them, when nothing else was asked for.
    """
    order = sorted((shaped for shaped in designs if shaped.shape.axisymmetric), key=_rank, reverse=True)
    if not order:
        order = sorted(designs, key=_rank, reverse=True)[:1]
    if not order:
        return tuple(designs)
    leading = [shaped for shaped in order if shaped.shape.name == order[0].shape.name][:SOLVED]
    firsts = [next(s for s in order if s.shape.name == kind) for kind in dict.fromkeys(s.shape.name for s in order)]
    found = [shaped for shaped in designs if not shaped.shape.axisymmetric]
    for shaped in [*leading, *firsts[1:]]:
        try:
            found.append(on_elements(shaped, space))
        except NoAnswerError:
            continue
    return tuple(found if any(shaped.elements for shaped in found) else designs)
