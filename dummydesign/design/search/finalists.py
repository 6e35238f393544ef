"""The pads that can win, solved by finite elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.interpolation import monotone_cubic
from dummydesign.design.request import Progress, quiet
from dummydesign.design.scoring.verdict import NOT_ACCEPTABLE, deviations, ranges_of, representative
from dummydesign.design.search.best_of_kinds import Shaped
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.search.slabs import SearchSpace, search
from dummydesign.geometry.dimensions import PAD_EXTENT_MM, PUNCH_RADIUS_MM
from dummydesign.pad.axisymmetric.shaped_problem import PathCache, Touch
from dummydesign.pad.force_law import BaseForceLaw
from dummydesign.pad.specimen import Pad

# Of solved depths over thickness, by whether the top is flat: ends of load steps, which cost no solve of its own.
SPACING = {False: 0.02, True: 0.015}
# Of the last one, the depths of fields of caps: in space every depth is a solve.
FIELD_SHARES = np.linspace(0.04, 1.0, 16)
# Over the deepest press of the test: a resin softer by a third presses no deeper.
BEYOND = 1.3


@dataclass(frozen=True)
class ElementsLaw(BaseForceLaw):
    """Force law of one cast shape: its table times the elements' force over the table's, at the pad's own thickness.
    """

    table: FamilyLaw
    thickness_mm: float
    depth_mm: NDArray
    log_factor: NDArray
    error: NDArray
    touch: Touch | None = None
    complete: bool = False
    end: str = ""

    def force(
        self, depth_mm: ArrayLike, thickness_mm: ArrayLike, young_MPa: ArrayLike, radius_mm: ArrayLike
    ) -> NDArray:
        """Elastic force; see :class:`dummydesign.pad.force_law.ForceLaw`. [N]"""
        # without corners, which would be seen in exponents and stiffness
        inside = np.clip(depth_mm, self.depth_mm[0], self.depth_mm[-1])
        factor = np.exp(monotone_cubic(self.depth_mm, self.log_factor)(inside))
        return factor * self.table.force(depth_mm, thickness_mm, young_MPa, radius_mm)

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth that the table holds and to which the elements did not fail. [mm]"""
        held = self.table.depth_limit_mm(thickness_mm, radius_mm)
        if self.complete:
            return held
        return np.minimum(held, self.depth_mm[-1] * np.asarray(thickness_mm, float) / self.thickness_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Error of the elements over the force; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        error = np.interp(depth, self.depth_mm, self.error)
        deeper = depth > self.depth_mm[-1]
        if not deeper.any():
            return error
        return np.where(deeper, np.maximum(error, self.table.relative_error(depth, thickness, radius_mm)), error)


def solve_law(shaped: Shaped, space: SearchSpace, solved: PathCache | None = None) -> ElementsLaw:
    """Solve the best pad of a search, once for all moduli, on the base and of the size requested."""
    inputs, pad = _inputs(shaped, space)
    depth = inputs["depth"]

    def solve() -> dict[str, Any]:
        round_pad = shaped.shape.axisymmetric
        return _solve_round(pad, depth, solved or PathCache()) if round_pad else _solve_field(pad, depth)

    return _law(shaped, cached("design", inputs, solve), len(depth), space.radius_mm)


def rough_law(shaped: Shaped, space: SearchSpace, solved: PathCache) -> ElementsLaw:
    """The same on the coarsest grid alone, to compare pads."""
    from dummydesign.pad.axisymmetric.shaped_pad import rough_shaped_pad

    inputs, pad = _inputs(shaped, space)
    depth = inputs["depth"]
    made = cached("rough-design", inputs, lambda: vars(rough_shaped_pad(pad, depth, solved)))
    return _law(shaped, made, len(depth), space.radius_mm)


def _inputs(shaped: Shaped, space: SearchSpace) -> tuple[dict[str, Any], Pad]:
    """What a solve depends on, and the pad of unit modulus.

    Of a round pad that is also its base and size and the punch's fillet, where they are not those of the tables.
    """
    thickness, own = shaped.result.best.thickness_mm, {}
    if shaped.shape.axisymmetric:
        usual = {"base": "bonded", "extent_mm": PAD_EXTENT_MM, "edge_radius_mm": 0.0}
        own = {name: getattr(space, name) for name, value in usual.items() if getattr(space, name) != value}
    depth = thickness * solved_shares(shaped, space.radius_mm)
    inputs = {"shape": str(shaped.shape), "thickness": thickness, "radius": space.radius_mm, "depth": depth, **own}
    return inputs, Pad(thickness, 1.0, space.radius_mm, geometry=shaped.shape, **own)


def solved_shares(shaped: Shaped, radius_mm: float) -> NDArray:
    """Depths over the thickness at which a design is solved: somewhat beyond its deepest press, or to the table's end.
    """
    best = shaped.result.best
    limit = float(shaped.table.depth_limit_mm(best.thickness_mm, radius_mm)) / best.thickness_mm
    pressed = best.depth_mm / best.thickness_mm
    last = min(limit, BEYOND * float(np.max(pressed))) if np.isfinite(pressed).all() else limit
    if not shaped.shape.axisymmetric:
        return FIELD_SHARES * last
    step = SPACING[shaped.shape.flat_top]
    return np.unique(np.minimum(step * np.arange(1, int(np.ceil(last / step - 1e-6)) + 1), limit))


def _law(shaped: Shaped, made: Mapping[str, Any], asked: int, radius_mm: float) -> ElementsLaw:
    thickness, law = shaped.result.best.thickness_mm, shaped.table
    reached, force = (np.asarray(made[name], float) for name in ("depth_mm", "force_N"))
    if len(reached) < 2:
        message = f"{shaped.shape} on {thickness:g} mm could not be solved by finite elements"
        raise NoAnswerError("no_convergence", message, quantity="pad")
    factor = np.log(force / law.plain.force(reached, thickness, 1.0, radius_mm))
    touch = Touch(*(np.asarray(column) for column in made["touch"])) if made.get("touch") else None
    error = np.asarray(made["error_N"], float) / force
    complete = len(reached) == asked
    end = "" if complete else "; ".join(made.get("notes", ()))
    return ElementsLaw(law, thickness, reached, factor, error, touch, complete, end)


def _solve_round(pad: Pad, depth_mm: NDArray, solved: PathCache) -> dict[str, Any]:
    from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad

    curve, h = solve_shaped_pad(pad, depth_mm, solved=solved), pad.thickness_mm
    rows = [(depth * h, min(touched * h, pad.radius_mm), edge) for depth, touched, edge in solved.touched]
    return {**vars(curve), "touch": [list(column) for column in zip(*rows)]}


def _solve_field(pad: Pad, depth_mm: NDArray) -> dict[str, Any]:
    """In space under the 14 x 14 mm punch; with a table, on its grid, whose stated error of the solves it has."""
    from dummydesign.geometry.shapes.bumped import Bumped
    from dummydesign.pad.spatial.shaped_pad import COARSE, HALF_SIDE_MM, press_field, solve_shaped_block
    from dummydesign.pad.tables.shape import load_shape_table

    shape, h = pad.geometry, pad.thickness_mm
    if not shape.tabulated:
        sides_mm = (2.0 * HALF_SIDE_MM, 2.0 * HALF_SIDE_MM)
        return vars(solve_shaped_block(Pad(h, 1.0, PUNCH_RADIUS_MM, geometry=shape, sides_mm=sides_mm), depth_mm))
    depth, area, stop = press_field(cast(Bumped, shape), h, depth_mm / h, COARSE)
    table = load_shape_table(shape.name)
    error = np.interp(depth, table.error_depth, table.solve_error)
    return {"depth_mm": depth * h, "force_N": area, "error_N": area * error, "notes": (stop,) if stop else ()}


WORTH = attrgetter("worth")
SOLVED = 3
# Twice the most by which solving moved what a design of the three built-in tissues is worth (0.014), where elements
# reach every press.
DOUBT = 0.03
# Share of a force by which elements move 95 % of pads from their tables.
MOVED = 0.06
# Relative difference in every length up to which one pad's elements over its table are taken for another's, and what
# such a neighbour must then be worth more than the best to be solved itself.
NEAR, GAIN = 0.1, 0.01


def with_law(shaped: Shaped, law: ElementsLaw, space: SearchSpace) -> Shaped:
    """The same pad with ratio, scores and curves from its own finite elements."""
    thickness = np.array([shaped.result.best.thickness_mm])
    best = search(law, replace(space, thickness_mm=thickness), space.targets.weights.low_aim, fitted=0).best
    return replace(shaped, result=replace(shaped.result, best=best), elements=law)


def on_elements(shaped: Shaped, space: SearchSpace, solved: PathCache | None = None) -> Shaped:
    """The same pad solved, with ratio, scores and curves from its own finite elements."""
    return with_law(shaped, solve_law(shaped, space, solved), space)


def solve_leading(designs: Sequence[Shaped], space: SearchSpace, progress: Progress = quiet) -> tuple[Shaped, ...]:
    """Designs with those that can be the best worked out on elements; those that cannot be solved fall away.

    In question are, of the round ones, the first of every kind and the first three of the best kind. They are pressed
    on a coarse grid one after the other, by what they are worth by their table, until no other can be worth more, the
    table's doubt of :data:`DOUBT` included; the best of these is solved to the end, and the next where it turns out
    worse. Pads that are nearly the same are not pressed one by one: once the first is solved, the others are judged by
    what its elements give over its table. Fields of caps take minutes in space and are solved, the first of them, when
    nothing else was requested.
    """
    order = sorted((shaped for shaped in designs if shaped.shape.axisymmetric), key=WORTH, reverse=True)
    if not order:
        first = sorted(designs, key=WORTH, reverse=True)[:1]
        return tuple(_solvable(first, space) or designs)
    leading = [shaped for shaped in order if shaped.shape.name == order[0].shape.name][:SOLVED]
    firsts = [next(s for s in order if s.shape.name == kind) for kind in dict.fromkeys(s.shape.name for s in order)]
    contenders = [*leading, *firsts[1:]]
    distinct: list[Shaped] = []
    for shaped in contenders:
        if not any(near(before, shaped) for before in distinct):
            distinct.append(shaped)
    judged, failed = _judged(distinct, space, progress)
    fields = [shaped for shaped in designs if not shaped.shape.axisymmetric]
    finalists: list[Shaped] = []
    for at_most, shaped, solved in judged:
        if finalists and at_most <= max(one.worth for one in finalists):
            continue
        progress(f"finite elements, {shaped.shape.name} pad")
        try:
            finalists.append(on_elements(shaped, space, solved))
        except NoAnswerError:
            failed.append(shaped)
            continue
        at_least = max(one.worth for one in finalists) + GAIN
        better = _better_neighbour(finalists[-1], _neighbours(shaped, contenders), space, at_least)
        if better is not None:
            progress(f"finite elements, {shaped.shape.name} pad")
            finalists += _solvable([better], space)
    for shaped in failed:
        # what keeps one pad from being solved need not keep its neighbours
        best = max((one.worth for one in finalists), default=-np.inf)
        finalists += _solvable([other for other in _neighbours(shaped, contenders) if other.worth > best], space)
    if not finalists:
        tried = [shaped.shape for shaped in failed]
        finalists = _solvable([shaped for shaped in contenders if shaped.shape not in tried], space)
    if not finalists:
        return tuple(designs)
    done = [shaped.shape for shaped in (*finalists, *failed)]
    return (*fields, *finalists, *(shaped for shaped in order if shaped.shape not in done))


def near(one: Shaped, other: Shaped) -> bool:
    """Whether two pads of a kind differ by at most :data:`NEAR` in every length."""
    if one.shape.name != other.shape.name:
        return False
    lengths = [
        np.array([shaped.result.best.thickness_mm, *(value for _, value in shaped.shape.parameters)])
        for shaped in (one, other)
    ]
    return bool((np.abs(lengths[0] - lengths[1]) <= NEAR * np.maximum(*np.abs(lengths))).all())


def _neighbours(shaped: Shaped, contenders: Sequence[Shaped]) -> list[Shaped]:
    """Other contenders that are nearly the same pad."""
    return [other for other in contenders if other is not shaped and near(shaped, other)]


def _better_neighbour(
    solved: Shaped, neighbours: Sequence[Shaped], space: SearchSpace, at_least: float
) -> Shaped | None:
    """Of pads that are nearly a solved one, that which is worth most with its elements over the table, if enough."""
    law = solved.elements
    assert isinstance(law, ElementsLaw)
    judged = []
    for shaped in neighbours:
        thickness = shaped.result.best.thickness_mm
        depth = law.depth_mm * thickness / law.thickness_mm
        own = replace(law, table=shaped.table, thickness_mm=thickness, depth_mm=depth, touch=None)
        try:
            judged.append((with_law(shaped, own, space).worth, shaped))
        except NoAnswerError:
            continue
    best = max(judged, key=lambda entry: entry[0], default=None)
    return best[1] if best is not None and best[0] > at_least else None


def _judged(
    contenders: Sequence[Shaped], space: SearchSpace, progress: Progress
) -> tuple[list[tuple[float, Shaped, PathCache]], list[Shaped]]:
    """Contenders pressed on the coarse grid, by the most they can be worth, and those that could not be pressed.

    That is what it is worth once it is acceptable (a finer grid may put it on the other side of a limit), or what it is
    worth by its table, where the coarse grid does not carry it to every depth.
    """
    judged: list[tuple[float, Shaped, PathCache]] = []
    failed, best = [], -np.inf
    for shaped in sorted(contenders, key=WORTH, reverse=True):
        # a pad just beyond a limit by its table may keep it by its elements, and then counts by its merit
        if (shaped.merit if _nearly(shaped, space) else shaped.worth) + DOUBT < best:
            continue
        progress(f"coarse finite elements, {shaped.shape.name} pad")
        solved = PathCache()
        try:
            law = rough_law(shaped, space, solved)
            rough = with_law(shaped, law, space)
        except NoAnswerError:
            failed.append(shaped)
            continue
        best = max(best, rough.worth)
        at_most = rough.merit if rough.result.best.rank > NOT_ACCEPTABLE else rough.worth
        if not law.complete:
            at_most = max(at_most, shaped.worth)
        judged.append((at_most, shaped, solved))
    return sorted(judged, key=lambda entry: entry[0], reverse=True), failed


def _nearly(shaped: Shaped, space: SearchSpace) -> bool:
    """Whether a pad keeps the verdict's limits within what solving moves its forces."""
    best, targets = shaped.result.best, space.targets
    if best.rank > NOT_ACCEPTABLE:
        return True
    differences = deviations(ranges_of(targets), best.readings)
    # the safe side knows no tie, so its own limit is moved
    limits = replace(targets.limits, tie=MOVED).moved("stands_shortfall", 1.0 + MOVED)
    return bool(representative(differences, limits)[0])


def _solvable(designs: Sequence[Shaped], space: SearchSpace) -> list[Shaped]:
    solved = []
    for shaped in designs:
        try:
            solved.append(on_elements(shaped, space))
        except NoAnswerError:
            continue
    return solved
