"""The pads that can win, solved by finite elements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.cache import cached
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.interpolation import monotone_cubic
from dummydesign.core.progress import Progress, quiet
from dummydesign.design.scoring.crowns import Crowns
from dummydesign.design.scoring.press_simulation import designed_depth_mm
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.search.shape_search import MANY_BATCHES, ShapedDesign, candidate_of, feasible, outlook_for, rank
from dummydesign.design.search.slabs import SearchSpace
from dummydesign.geometry.dimensions import PAD_EXTENT_MM, PUNCH_RADIUS_MM, PUNCH_SIDE_MM
from dummydesign.pad.axisymmetric.shaped_problem import PathCache, Touch
from dummydesign.pad.first_touch import with_foot
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.pad_under_punch import Pad

# Of solved depths over thickness, by whether the top is flat: ends of load steps, which cost no solve of its own.
SPACING = {False: 0.02, True: 0.015}
# Of the last one, the depths of shapes that are not round: in space every depth is a solve.
SPATIAL_SHARES = np.linspace(0.04, 1.0, 16)
# Over the deepest press of the test: a resin softer by a third presses no deeper.
BEYOND = 1.3


@dataclass(frozen=True, eq=False)
class ElementsLaw(ForceLaw):
    """Force law of one cast shape: its table times the elements' force over the table's, at the pad's own thickness."""

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

    def with_crowns(self, crowns: Crowns) -> ElementsLaw:
        """The law of pads whose crowns are off, one a row: what the table says of them, times the same factor."""
        return replace(self, table=self.table.with_crowns(crowns))

    def depth_limit_mm(self, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Depth that the table holds and to which the elements did not fail. [mm]"""
        held = self.table.depth_limit_mm(thickness_mm, radius_mm)
        if self.complete:
            return held
        return np.minimum(held, self.depth_mm[-1] * np.asarray(thickness_mm, float) / self.thickness_mm)

    def gel_mm(self, thickness_mm: ArrayLike) -> NDArray:
        """Thickness of the gel under the middle of the punch. [mm]"""
        return self.table.gel_mm(thickness_mm)

    def relative_error(self, depth_mm: ArrayLike, thickness_mm: ArrayLike, radius_mm: ArrayLike) -> NDArray:
        """Error of the elements and of a square's factor; see :class:`dummydesign.pad.force_law.ForceLaw`."""
        depth, thickness = np.broadcast_arrays(np.asarray(depth_mm, float), np.asarray(thickness_mm, float))
        own = (self.table, self.table.plain)
        square, circle = (one.relative_error(depth, thickness, radius_mm) for one in own)
        error = np.interp(depth, self.depth_mm, self.error) + square - circle
        return np.where(depth > self.depth_mm[-1], np.maximum(error, square), error)


def solve_law(design: ShapedDesign, space: SearchSpace) -> ElementsLaw:
    """Solve a pad, once for all moduli, on the base and of the size requested."""
    inputs, pad = _inputs(design, space)
    depth = inputs["depth"]

    def solve() -> dict[str, Any]:
        return _solve_round(pad, depth, PathCache()) if design.shape.axisymmetric else _solve_in_space(pad, depth)

    return _law(design, cached("design", inputs, solve), len(depth), space.radius_mm)


def _inputs(design: ShapedDesign, space: SearchSpace) -> tuple[dict[str, Any], Pad]:
    """What a solve depends on, and the pad of unit modulus.

    Of a round pad that is also its base and size and the punch's fillet, where they are not those of the tables.
    """
    thickness, own = design.thickness_mm, {}
    depth = thickness * solved_shares(design, space)
    if design.shape.axisymmetric:
        depth = with_foot(depth, design.shape, space.radius_mm)
        usual = {"base": "bonded", "extent_mm": PAD_EXTENT_MM, "edge_radius_mm": 0.0}
        own = {name: getattr(space, name) for name, value in usual.items() if getattr(space, name) != value}
    inputs = {"shape": str(design.shape), "thickness": thickness, "radius": space.radius_mm, "depth": depth, **own}
    return inputs, Pad(thickness, 1.0, space.radius_mm, geometry=design.shape, **own)


def solved_shares(design: ShapedDesign, space: SearchSpace) -> NDArray:
    """Depths over the thickness at which a design is solved: somewhat beyond its deepest press, or to the limit."""
    gel, thickness = space.targets.limits.gel_compression, np.array([design.thickness_mm])
    limit = float(designed_depth_mm(design.table, thickness, space.radius_mm, gel)[0]) / design.thickness_mm
    pressed = candidate_of(design.table, design.thickness_mm, design.outlook.ratio, space).depth_mm / thickness[0]
    last = min(limit, BEYOND * float(np.max(pressed))) if np.isfinite(pressed).all() else limit
    if not design.shape.axisymmetric:
        return SPATIAL_SHARES * last
    step = SPACING[design.shape.flat_top]
    return np.unique(np.minimum(step * np.arange(1, int(np.ceil(last / step - 1e-6)) + 1), limit))


def _law(design: ShapedDesign, made: Mapping[str, Any], asked: int, radius_mm: float) -> ElementsLaw:
    thickness, law = design.thickness_mm, design.table
    reached, force = (np.asarray(made[name], float) for name in ("depth_mm", "force_N"))
    if len(reached) < 2:
        message = f"{design.shape} on {thickness:g} mm could not be solved by finite elements"
        raise NoAnswerError("no_convergence", message, quantity="pad")
    factor = np.log(force / law.plain.force(reached, thickness, 1.0, radius_mm))
    touch = Touch(*(np.asarray(column) for column in made["touch"])) if made.get("touch") else None
    # what corrects the table, such as another elastic law, has its own error beside the elements'
    known = (one.relative_error(reached, thickness, radius_mm) for one in (law, law.plain))
    error = np.asarray(made["error_N"], float) / force + np.subtract(*known)
    complete = len(reached) == asked
    end = "" if complete else "; ".join(made.get("notes", ()))
    return ElementsLaw(law, thickness, reached, factor, error, touch, complete, end)


def _solve_round(pad: Pad, depth_mm: NDArray, solved: PathCache) -> dict[str, Any]:
    from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad

    curve, h = solve_shaped_pad(pad, depth_mm, solved=solved), pad.thickness_mm
    rows = [(depth * h, min(touched * h, pad.radius_mm)) for depth, touched in solved.touched]
    return {**vars(curve), "touch": [list(column) for column in zip(*rows)]}


def _solve_in_space(pad: Pad, depth_mm: NDArray) -> dict[str, Any]:
    """Under the 14 x 14 mm punch."""
    from dummydesign.pad.spatial.shaped_pad import solve_shaped_block

    sides_mm = (PUNCH_SIDE_MM, PUNCH_SIDE_MM)
    square = Pad(pad.thickness_mm, 1.0, PUNCH_RADIUS_MM, geometry=pad.geometry, sides_mm=sides_mm)
    return vars(solve_shaped_block(square, depth_mm))


# Designs that are solved at most, and by how much the share of another one has to exceed that of the solved one:
# solving moved shares of leading pads of the three built-in tissues by up to 0.03.
MOST_SOLVED, DOUBT = 3, 0.03


def on_elements(design: ShapedDesign, space: SearchSpace) -> ShapedDesign:
    """The same pad solved, with its outlook from its own finite elements."""
    law = solve_law(design, space)
    outlook = outlook_for(law, design.shape, design.thickness_mm, design.match, space, MANY_BATCHES)
    return replace(design, cast=law, outlook=outlook, solved=True)


def _better(other: ShapedDesign, solved: ShapedDesign, space: SearchSpace) -> bool:
    """Whether a design that only a table knows is better than a solved one by more than solving moves it."""
    limits, strict = space.targets.limits, space.targets.strict
    its, own = (one.outlook.level(limits, strict) for one in (other, solved))
    return its < own or (its == own and other.outlook.after_puck > solved.outlook.after_puck + DOUBT)


def solve_leading(
    designs: Sequence[ShapedDesign], space: SearchSpace, faults: dict[str, str], progress: Progress = quiet
) -> list[ShapedDesign]:
    """Solve the best design; another one only where solving leaves the first behind it.

    Pads that cannot be solved, or no longer reach the middle force, fall away, the reason of each kind into ``faults``.
    Shapes that are not round take minutes in space: they are solved where no round pad was searched, the first of them.
    Slabs are designed by their table.
    """
    left = list(designs)
    solved: list[ShapedDesign] = []
    fallen: list[ShapedDesign] = []
    if any(one.shape.axisymmetric for one in designs):
        left = [one for one in designs if one.shape.axisymmetric or one.shape.plain]
    while len(solved) < MOST_SOLVED:
        first = rank([*left, *solved], space)[0] if left or solved else None
        if first is None or first.solved or first.shape.plain:
            break
        left.remove(first)
        progress(f"finite elements, {first.shape.name} pad")
        try:
            solved.append(feasible(on_elements(first, space), space))
        except (InputError, NoAnswerError) as problem:
            if isinstance(problem, InputError) and not (left or solved):
                raise
            faults.setdefault(first.shape.name, str(problem))
            fallen.append(first)
            continue
        if left and not _better(rank(left, space)[0], rank(solved, space)[0], space):
            break
    if not solved:
        return rank(left, space) or list(designs)
    # what only a table knows is not chosen before what was solved, but a slab by its own table
    slabs = [one for one in left if one.shape.plain]
    leading = rank([*solved, *slabs], space)
    gone = {item.shape for item in solved}
    behind = [one for one in designs if one not in slabs and one not in fallen and one.shape not in gone]
    return [*leading, *rank(behind, space)]
