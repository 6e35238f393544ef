"""Solve a shaped design again by finite elements: a search prefers designs whose table error is favourable.

The best of many pads by a table with an error is also the one whose error helps it most. So the pads that win are
solved, the table is multiplied by what the elements give over it, and ratio and scores are found anew.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.design.request import Progress, quiet
from dummydesign.design.scoring.standing import NOT_ACCEPTABLE
from dummydesign.design.search.shape_family import ShapeLaw
from dummydesign.design.search.shapes import Shaped
from dummydesign.design.search.slabs import search
from dummydesign.design.search.space import SearchSpace
from dummydesign.geometry.standard import PAD_EXTENT_MM
from dummydesign.pad.force_law import BaseForceLaw
from dummydesign.pad.shaped.contact_radius import Touch
from dummydesign.pad.shaped.paths import Solved

DEPTH_SHARES = np.linspace(0.04, 1.0, 16)
SOLVED = 3
DOUBT = 0.03
"""Twice the most by which solving moved what a design of the three built-in tissues is worth (0.014)."""


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
    """

    table: ShapeLaw
    thickness_mm: float
    depth_mm: NDArray
    log_factor: NDArray
    error: NDArray
    touch: Touch | None = None

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
    return _law(shaped, made, space.radius_mm)


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
    return _law(shaped, made, space.radius_mm)


def _own(space: SearchSpace) -> dict[str, Any]:
    """Base and size of the pads where they are not those of the tables."""
    own: dict[str, Any] = {} if space.base == "bonded" else {"base": space.base}
    return own if space.extent_mm == PAD_EXTENT_MM else {**own, "extent_mm": space.extent_mm}


def _inputs(shaped: Shaped, radius_mm: float) -> dict[str, Any]:
    thickness = shaped.found.best.thickness_mm
    depth = float(replace(shaped.law, cast=True).depth_limit_mm(thickness, radius_mm)) * DEPTH_SHARES
    return {"shape": str(shaped.shape), "thickness": thickness, "radius": radius_mm, "depth": depth}


def _law(shaped: Shaped, made: Mapping[str, Any], radius_mm: float) -> ElementsLaw:
    thickness, law = shaped.found.best.thickness_mm, replace(shaped.law, cast=True)
    reached, force = (np.asarray(made[name], float) for name in ("depth_mm", "force_N"))
    if len(reached) < 2:
        message = f"{shaped.shape} on {thickness:g} mm could not be solved by finite elements"
        raise NoAnswerError("no_convergence", message)
    factor = np.log(force / law.plain.force(reached, thickness, 1.0, radius_mm))
    touch = Touch(*(np.asarray(column) for column in made["touch"])) if made.get("touch") else None
    return ElementsLaw(law, thickness, reached, factor, np.asarray(made["error_N"], float) / force, touch)


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
    depth, area, _ = press_field(shaped.shape, thickness_mm, depth_mm / thickness_mm, COARSE)
    table = load_shape_table(shaped.shape.name)
    error = np.interp(depth, table.error_depth, table.solve_error)
    return {"depth_mm": depth * thickness_mm, "force_N": area, "error_N": area * error}


def with_law(shaped: Shaped, law: ElementsLaw, space: SearchSpace) -> Shaped:
    """The same pad with ratio, scores and curves from its own finite elements.

    Parameters
    ----------
    shaped : Shaped
    law : ElementsLaw
        Of its shape and thickness.
    space : SearchSpace

    Raises
    ------
    NoAnswerError
        When it does not reach 10 N where it was.
    """
    thickness = np.array([shaped.found.best.thickness_mm])
    best = search(law, replace(space, thickness_mm=thickness), space.targets.weights.low_aim, fitted=0).best
    return replace(shaped, found=replace(shaped.found, best=best), elements=law)


def on_elements(shaped: Shaped, space: SearchSpace, solved: Solved | None = None) -> Shaped:
    """The same pad solved, with ratio, scores and curves from its own finite elements.

    Parameters
    ----------
    shaped : Shaped
    space : SearchSpace
    solved : Solved, optional
        What was solved of it already.

    Raises
    ------
    NoAnswerError
        When it cannot be solved, or does not reach 10 N where it was.
    """
    return with_law(shaped, solve_law(shaped, space, solved), space)


def _rank(shaped: Shaped) -> float:
    return shaped.worth


def solve_leading(designs: Sequence[Shaped], space: SearchSpace, progress: Progress = quiet) -> tuple[Shaped, ...]:
    """Designs with those that can be the best worked out on elements; those that cannot be solved fall away.

    In question are, of the round ones, the first of every kind and the first three of the best kind. They are pressed
    on a coarse grid one after the other, by what they are worth by their table, until no other can be worth more, the
    table's doubt of :data:`DOUBT` included; the best of these is solved to the end, and the next where it turns out
    worse. Fields of caps take minutes in space and are solved, the first of them, when nothing else was asked for.

    Parameters
    ----------
    designs : sequence of Shaped
        By their tables.
    space : SearchSpace
    progress : callable, optional
        Is told each solve as it begins.
    """
    order = sorted((shaped for shaped in designs if shaped.shape.axisymmetric), key=_rank, reverse=True)
    if not order:
        first = sorted(designs, key=_rank, reverse=True)[:1]
        return tuple(_solvable(first, space) or designs)
    leading = [shaped for shaped in order if shaped.shape.name == order[0].shape.name][:SOLVED]
    firsts = [next(s for s in order if s.shape.name == kind) for kind in dict.fromkeys(s.shape.name for s in order)]
    contenders = [*leading, *firsts[1:]]
    judged, failed = _judged(contenders, space, progress)
    fields = [shaped for shaped in designs if not shaped.shape.axisymmetric]
    found: list[Shaped] = []
    for at_most, shaped, solved in judged:
        if found and at_most <= max(map(_rank, found)):
            continue
        progress(f"finite elements, {shaped.shape.name} pad")
        try:
            found.append(on_elements(shaped, space, solved))
        except NoAnswerError:
            failed.append(shaped)
    if not found:
        tried = [shaped.shape for shaped in failed]
        found = _solvable([shaped for shaped in contenders if shaped.shape not in tried], space)
    if not found:
        return tuple(designs)
    done = [shaped.shape for shaped in (*found, *failed)]
    return (*fields, *found, *(shaped for shaped in order if shaped.shape not in done))


def _judged(
    contenders: Sequence[Shaped], space: SearchSpace, progress: Progress
) -> tuple[list[tuple[float, Shaped, Solved]], list[Shaped]]:
    """Contenders pressed on the coarse grid, by the most they can be worth, and those that could not be pressed.

    That is the merit, where a pad is acceptable (a finer grid may put it on the other side of the end of a range), and
    what it is worth by its table, where the coarse grid does not carry it to every depth.
    """
    judged: list[tuple[float, Shaped, Solved]] = []
    failed, best = [], -np.inf
    for shaped in sorted(contenders, key=_rank, reverse=True):
        # what reads low by its table may not by its elements, and then counts by its merit
        if shaped.merit + DOUBT < best:
            continue
        progress(f"coarse finite elements, {shaped.shape.name} pad")
        solved = Solved()
        try:
            law = rough_law(shaped, space, solved)
            rough = with_law(shaped, law, space)
        except NoAnswerError:
            failed.append(shaped)
            continue
        best = max(best, rough.worth)
        at_most = rough.merit if rough.found.best.standing > NOT_ACCEPTABLE else rough.worth
        if len(law.depth_mm) < len(DEPTH_SHARES):
            at_most = max(at_most, shaped.worth)
        judged.append((at_most, shaped, solved))
    return sorted(judged, key=lambda entry: entry[0], reverse=True), failed


def _solvable(designs: Sequence[Shaped], space: SearchSpace) -> list[Shaped]:
    found = []
    for shaped in designs:
        try:
            found.append(on_elements(shaped, space))
        except NoAnswerError:
            continue
    return found
