"""Force law of one shaped design from its own finite elements: its table times what they give over it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.monotone import monotone_cubic
from dummydesign.design.search.shape_family import ShapeLaw
from dummydesign.design.search.shapes import Shaped
from dummydesign.design.search.space import SearchSpace
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.force_law import BaseForceLaw
from dummydesign.pad.shaped.contact_radius import Touch
from dummydesign.pad.shaped.paths import Solved

SPACING = {False: 0.02, True: 0.015}
"""Of solved depths over thickness, by whether the top is flat: ends of load steps, which cost no solve of its own."""
FIELD_SHARES = np.linspace(0.04, 1.0, 16)
"""Of the last one, the depths of fields of caps: in space every depth is a solve."""
BEYOND = 1.3
"""Over the deepest press of the test: a resin softer by a third presses no deeper."""


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
    touch : Touch, optional
        Radius of the contact of a crown, from the same solve.
    complete : bool
        Whether all was solved that was asked for. Deeper the table goes on, times the last factor, with its own error;
        otherwise the law ends where the solve did.
    end : str
        Why it ended there, in words; empty where nothing was said.
    """

    table: ShapeLaw
    thickness_mm: float
    depth_mm: NDArray
    log_factor: NDArray
    error: NDArray
    touch: Touch | None = None
    complete: bool = False
    end: str = ""

    def force(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: float) -> NDArray:
        """Elastic force; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        # without corners, which would be seen in exponents and stiffness
        inside = np.clip(depth_mm, self.depth_mm[0], self.depth_mm[-1])
        factor = np.exp(monotone_cubic(self.depth_mm, self.log_factor)(inside))
        return factor * self.table.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Depth that the table holds and to which the elements did not fail. [mm]"""
        held = self.table.depth_limit_mm(thickness_mm, radius_mm)
        if self.complete:
            return held
        return np.minimum(held, self.depth_mm[-1] * np.asarray(thickness_mm, float) / self.thickness_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: float) -> NDArray:
        """Error of the elements over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        error = np.interp(depth, self.depth_mm, self.error)
        if not (deeper := depth > self.depth_mm[-1]).any():
            return error
        return np.where(deeper, np.maximum(error, self.table.relative_error(depth, thickness, radius_mm)), error)

    @property
    def largest_difference(self) -> float:
        """Largest relative difference of table and elements."""
        return float(np.max(np.abs(np.expm1(self.log_factor))))


def solve_law(shaped: Shaped, space: SearchSpace, solved: Solved | None = None) -> ElementsLaw:
    """Solve the best pad of a search, once for all moduli, on the base and of the size that are asked for.

    Parameters
    ----------
    shaped : Shaped
    space : SearchSpace
        Punch, base and size of the pad.
    solved : Solved, optional
        What was solved of this pad already.

    Raises
    ------
    NoAnswerError
        When the elements reach fewer than two depths.
    """
    inputs, own = _inputs(shaped, space.radius_mm), _own(space)
    if shaped.shape.axisymmetric:
        args = (shaped, space.radius_mm, inputs["depth"], solved, own)
        made = cached("design", {**inputs, **own}, lambda: _round(*args))
    else:
        made = cached("design", inputs, lambda: _field(shaped, inputs["thickness"], inputs["depth"]))
    return _law(shaped, made, len(inputs["depth"]), space.radius_mm)


def rough_law(shaped: Shaped, space: SearchSpace, solved: Solved) -> ElementsLaw:
    """The same on the coarsest grid alone, to compare pads.

    Parameters
    ----------
    shaped : Shaped
    space : SearchSpace
        Punch, base and size of the pad.
    solved : Solved
        Keeps what is solved.

    Raises
    ------
    NoAnswerError
        When the elements reach fewer than two depths.
    """
    from dummydesign.pad.shaped.axisymmetric import rough_shaped_pad

    inputs, own = _inputs(shaped, space.radius_mm), _own(space)
    args = (shaped.shape, inputs["thickness"], space.radius_mm, inputs["depth"])
    made = cached("rough-design", {**inputs, **own}, lambda: vars(rough_shaped_pad(*args, solved=solved, **own)))
    return _law(shaped, made, len(inputs["depth"]), space.radius_mm)


def _own(space: SearchSpace) -> dict[str, Any]:
    """Base and size of the pads where they are not those of the tables."""
    own: dict[str, Any] = {} if space.base == "bonded" else {"base": space.base}
    return own if space.extent_mm == PAD_EXTENT_MM else {**own, "extent_mm": space.extent_mm}


def _inputs(shaped: Shaped, radius_mm: float) -> dict[str, Any]:
    thickness = shaped.found.best.thickness_mm
    return {"shape": str(shaped.shape), "thickness": thickness, "radius": radius_mm,
            "depth": thickness * solved_shares(shaped, radius_mm)}  # fmt: skip


def solved_shares(shaped: Shaped, radius_mm: float) -> NDArray:
    """Depths over the thickness at which a design is solved: somewhat beyond its deepest press, or to the table's end.

    Parameters
    ----------
    shaped : Shaped
    radius_mm : float
        Of the punch. [mm]
    """
    best = shaped.found.best
    limit = float(replace(shaped.law, cast=True).depth_limit_mm(best.thickness_mm, radius_mm)) / best.thickness_mm
    pressed = best.evaluation.depth_mm[best.index] / best.thickness_mm
    last = min(limit, BEYOND * float(np.max(pressed))) if np.isfinite(pressed).all() else limit
    if not shaped.shape.axisymmetric:
        return FIELD_SHARES * last
    step = SPACING[shaped.shape.flat_top]
    return np.unique(np.minimum(step * np.arange(1, int(np.ceil(last / step - 1e-6)) + 1), limit))


def _law(shaped: Shaped, made: Mapping[str, Any], asked: int, radius_mm: float) -> ElementsLaw:
    thickness, law = shaped.found.best.thickness_mm, replace(shaped.law, cast=True)
    reached, force = (np.asarray(made[name], float) for name in ("depth_mm", "force_N"))
    if len(reached) < 2:
        message = f"{shaped.shape} on {thickness:g} mm could not be solved by finite elements"
        raise NoAnswerError("no_convergence", message)
    factor = np.log(force / law.plain.force(reached, thickness, 1.0, radius_mm))
    touch = Touch(*(np.asarray(column) for column in made["touch"])) if made.get("touch") else None
    error = np.asarray(made["error_N"], float) / force
    complete = len(reached) == asked
    end = "" if complete else "; ".join(made.get("notes", ()))
    return ElementsLaw(law, thickness, reached, factor, error, touch, complete, end)


def _round(
    shaped: Shaped, radius_mm: float, depth_mm: NDArray, solved: Solved | None, own: dict[str, Any]
) -> dict[str, Any]:
    from dummydesign.pad.shaped.axisymmetric import solve_shaped_pad

    thickness = shaped.found.best.thickness_mm
    solved = Solved() if solved is None else solved
    curve = solve_shaped_pad(shaped.shape, thickness, radius_mm, 1.0, depth_mm, solved=solved, **own)
    rows = [(depth * thickness, min(touched * thickness, radius_mm), edge) for depth, touched, edge in solved.touched]
    return {**vars(curve), "touch": [list(column) for column in zip(*rows)]}


def _field(shaped: Shaped, thickness_mm: float, depth_mm: NDArray) -> dict[str, Any]:
    """In space under the 14 x 14 mm punch; with a table, on its grid, whose stated error of the solves it has."""
    from dummydesign.pad.shaped.spatial import solve_shaped_block
    from dummydesign.pad.shaped.under_square import COARSE, HALF_SIDE_MM, press_field
    from dummydesign.pad.tables.shape import load_shape_table

    if not shaped.shape.tabulated:
        return vars(solve_shaped_block(shaped.shape, thickness_mm, (HALF_SIDE_MM,) * 2, 1.0, depth_mm))
    depth, area, stop = press_field(shaped.shape, thickness_mm, depth_mm / thickness_mm, COARSE)
    table = load_shape_table(shaped.shape.name)
    error = np.interp(depth, table.error_depth, table.solve_error)
    notes = (stop,) if stop else ()
    return {"depth_mm": depth * thickness_mm, "force_N": area, "error_N": area * error, "notes": notes}
