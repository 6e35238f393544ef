"""Solve a shaped design again by finite elements: a search prefers designs whose table error is favourable.

The best of many pads by a table with an error is also the one whose error helps it most. So the pads that win are
solved, the table is multiplied by what the elements give over it, and ratio and scores are found anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.finalists.elements_law import ElementsLaw, rough_law, solve_law
from dummydesign.design.request import Progress, quiet
from dummydesign.design.scoring.acceptability import NOT_ACCEPTABLE, ranges_of, readings_of, strict_aim
from dummydesign.design.scoring.deviations import Readings, deviations
from dummydesign.design.scoring.verdict import representative
from dummydesign.design.search.shapes import Shaped
from dummydesign.design.search.slabs import search
from dummydesign.design.search.space import SearchSpace
from dummydesign.pad.shaped.paths import Solved

SOLVED = 3
DOUBT = 0.03
"""Twice the most by which solving moved what a design of the three built-in tissues is worth (0.014), where elements
reach every press."""
MOVED = 0.06
"""Share of a force by which elements move 95 % of pads from their tables."""
NEAR, GAIN = 0.1, 0.01
"""Relative difference in every length up to which one pad's elements over its table are taken for another's, and what
such a neighbour must then be worth more than the best to be solved itself."""


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
    worse. Pads that are nearly the same are not pressed one by one: once the first is solved, the others are judged by
    what its elements give over its table. Fields of caps take minutes in space and are solved, the first of them, when
    nothing else was asked for.

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
    apart: list[Shaped] = []
    for shaped in contenders:
        if not any(near(before, shaped) for before in apart):
            apart.append(shaped)
    judged, failed = _judged(apart, space, progress)
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
            continue
        better = _better_neighbour(found[-1], _beside(shaped, contenders), space, max(map(_rank, found)) + GAIN)
        if better is not None:
            progress(f"finite elements, {shaped.shape.name} pad")
            found += _solvable([better], space)
    for shaped in failed:
        # what keeps one pad from being solved need not keep its neighbours
        best = max(map(_rank, found), default=-np.inf)
        found += _solvable([other for other in _beside(shaped, contenders) if other.worth > best], space)
    if not found:
        tried = [shaped.shape for shaped in failed]
        found = _solvable([shaped for shaped in contenders if shaped.shape not in tried], space)
    if not found:
        return tuple(designs)
    done = [shaped.shape for shaped in (*found, *failed)]
    return (*fields, *found, *(shaped for shaped in order if shaped.shape not in done))


def near(one: Shaped, other: Shaped) -> bool:
    """Whether two pads of a kind differ by at most :data:`NEAR` in every length."""
    if one.shape.name != other.shape.name:
        return False
    lengths = [
        np.array([shaped.found.best.thickness_mm, *(value for _, value in shaped.shape.parameters)])
        for shaped in (one, other)
    ]
    return bool((np.abs(lengths[0] - lengths[1]) <= NEAR * np.maximum(*np.abs(lengths))).all())


def _beside(shaped: Shaped, contenders: Sequence[Shaped]) -> list[Shaped]:
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
        thickness = shaped.found.best.thickness_mm
        depth = law.depth_mm * thickness / law.thickness_mm
        own = replace(law, table=replace(shaped.law, cast=True), thickness_mm=thickness, depth_mm=depth, touch=None)
        try:
            judged.append((with_law(shaped, own, space).worth, shaped))
        except NoAnswerError:
            continue
    best = max(judged, key=lambda entry: entry[0], default=None)
    return best[1] if best is not None and best[0] > at_least else None


def _judged(
    contenders: Sequence[Shaped], space: SearchSpace, progress: Progress
) -> tuple[list[tuple[float, Shaped, Solved]], list[Shaped]]:
    """Contenders pressed on the coarse grid, by the most they can be worth, and those that could not be pressed.

    That is what it is worth once it is acceptable (a finer grid may put it on the other side of a limit), or what it is
    worth by its table, where the coarse grid does not carry it to every depth.
    """
    judged: list[tuple[float, Shaped, Solved]] = []
    failed, best = [], -np.inf
    for shaped in sorted(contenders, key=_rank, reverse=True):
        # a pad just beyond a limit by its table may keep it by its elements, and then counts by its merit
        if (shaped.merit if _nearly(shaped, space) else shaped.worth) + DOUBT < best:
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
        at_most = rough.merit if rough.found.best.rank > NOT_ACCEPTABLE else rough.worth
        if not law.complete:
            at_most = max(at_most, shaped.worth)
        judged.append((at_most, shaped, solved))
    return sorted(judged, key=lambda entry: entry[0], reverse=True), failed


def _nearly(shaped: Shaped, space: SearchSpace) -> bool:
    """Whether a pad keeps the verdict's limits within what solving moves its forces."""
    best, targets = shaped.found.best, space.targets
    if best.rank > NOT_ACCEPTABLE:
        return True
    one = Readings(*(values[best.index] for values in vars(readings_of(best.evaluation)).values()))
    found = deviations(ranges_of(targets), one, strict_aim(targets))
    # the safe side knows no tie, so its own limit is moved
    limits = replace(targets.limits, tie=MOVED).moved("stands_shortfall", 1.0 + MOVED)
    return bool(representative(found, limits, strict_aim(targets))[0])


def _solvable(designs: Sequence[Shaped], space: SearchSpace) -> list[Shaped]:
    found = []
    for shaped in designs:
        try:
            found.append(on_elements(shaped, space))
        except NoAnswerError:
            continue
    return found
