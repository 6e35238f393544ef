"""Designs with a shape of their own: the best pad of each kind, beside the slab, by one rule."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.design.scoring.acceptability import NOT_ACCEPTABLE
from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.search.low_force import LowForce, low_force
from dummydesign.design.search.shapes import Shaped, mixable, search_fixed, search_shapes
from dummydesign.design.search.slabs import Candidate, SearchResult, search, with_parameters
from dummydesign.design.search.space import SearchSpace
from dummydesign.geometry.shapes import PadShape, Slab, read_shape

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin

AUTO = "auto"


@dataclass(frozen=True)
class Beside:
    """The best design of one kind of shape, or the reason why there is none.

    ``by`` says where its force comes from: ``table``, ``law`` or ``elements``.
    """

    kind: str
    shape: PadShape | None
    candidate: Candidate | None
    young_kPa: float | None
    low_force: LowForce | None
    reason: str | None = None
    by: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the design and how near it comes to the tissue as plain values."""
        if self.candidate is None:
            return {"kind": self.kind, "shape": None, "reason": self.reason}
        return {
            "kind": self.kind,
            "shape": str(self.shape),
            "thickness_mm": self.candidate.thickness_mm,
            "ratio": self.candidate.ratio,
            "young_kPa": self.young_kPa,
            "merit": self.candidate.merit(),
            "total": self.candidate.total,
            "by": self.by,
            "acceptable": self.candidate.rank > NOT_ACCEPTABLE,
            **self.low_force.to_dict(),
            "reason": None,
        }


@dataclass(frozen=True)
class Found:
    """What tables give for a request: the best flat slab, designs of the kinds asked for, kinds without one.

    Attributes
    ----------
    asked : str
        The shape as it was asked for.
    slab_law : ForceLaw
    slab : SearchResult or None
        The best slab by the rule of the shapes, None with ``slab_reason``.
    designs : tuple of Shaped
    missing : tuple of Beside
        With the reason of each.
    """

    asked: str
    slab_law: ForceLaw
    slab: SearchResult | None
    slab_reason: str | None = None
    designs: tuple[Shaped, ...] = ()
    missing: tuple[Beside, ...] = ()


@dataclass(frozen=True)
class Chosen:
    """The winning design with its force laws: in proportion with thickness, and as cast."""

    shape: PadShape
    found: SearchResult
    law: ForceLaw
    cast: ForceLaw
    beside: tuple[Beside, ...]


def kinds_of(text: str) -> tuple[str, ...]:
    """Kinds of shapes a request names: one kind, one given shape, or ``auto`` for all with a response surface.

    Raises
    ------
    InputError
        For unknown names, parameters that make no shape, or kinds without a response surface.
    """
    from dummydesign.design.search.tabulated_shapes import designable_kinds

    known = designable_kinds()
    if text.lower() == AUTO:
        return known
    name = text.partition(":")[0].lower()
    shape = read_shape(text) if ":" in text else None
    if shape is None and name not in known and name != Slab.name:
        from dummydesign.core.errors import unknown_name

        raise unknown_name("shape", text, (*known, Slab.name, AUTO))
    if name not in known and name != Slab.name:
        raise InputError(f"shape {name} has no response surface; press it with 'dummydesign predict --shape {text}'")
    return (name,)


def best_of_kinds(
    text: str, slab_law: ForceLaw, space: SearchSpace, refused: Mapping[str, str] = MappingProxyType({})
) -> Found:
    """Search every kind of shape that a request names, and the slab by the same rule.

    Parameters
    ----------
    text : str
        ``slab``, ``crowned``, ..., a shape with its parameters such as ``crowned:10,2``, or ``auto``.
    slab_law : ForceLaw
        Elastic force of slabs.
    space : SearchSpace
    refused : mapping
        Kinds that cannot be designed for the test, with the reason.

    Raises
    ------
    InputError
        When the one kind that is asked for is refused.
    NoAnswerError
        ``no_feasible_design`` when a slab alone was asked for and there is none.
    """
    if text.lower() != AUTO and (reason := refused.get(text.partition(":")[0].lower())):
        raise InputError(f"shape = {text}: {reason}")
    if text.lower() == Slab.name:
        return Found(text, slab_law, search(slab_law, space))
    slab: SearchResult | None = None
    reason = None
    try:
        slab = search(slab_law, space, space.targets.weights.low_aim)
    except NoAnswerError as problem:
        reason = str(problem)
    designs, missing = _designs(text, space, refused)
    return Found(text, slab_law, slab, reason, tuple(designs), tuple(missing))


def choose(found: Found, space: SearchSpace) -> Chosen:
    """Take the best of what was found: solved designs first; a slab only where it was asked for or by ``auto``.

    Raises
    ------
    NoAnswerError
        ``no_feasible_design`` when no kind has one.
    """
    flat, law, designs = found.slab, found.slab_law, found.designs
    if found.asked.lower() == Slab.name and flat is not None:
        return Chosen(Slab(), flat, law, law, ())
    beside = [Beside(Slab.name, None, None, None, None, found.slab_reason)]
    if flat is not None:
        beside = [_beside(Slab.name, Slab(), flat.best, space, "table")]
    leaders = [
        max((shaped for shaped in designs if shaped.shape.name == kind), key=_rank)
        for kind in dict.fromkeys(shaped.shape.name for shaped in designs)
    ]
    winner = max(designs, key=_rank) if designs else None
    leaders = _fitted(leaders, space, None if winner is None else winner.shape.name)
    for best in leaders:
        by = best.law.family.source if best.elements is None else "elements"
        beside.append(_beside(best.shape.name, best.shape, best.found.best, space, by))
    listed = (*beside, *found.missing)
    if found.asked.lower() == AUTO and flat is not None:
        if not designs or flat.best.worth() >= max(designs, key=_rank).worth:
            return Chosen(Slab(), flat, law, law, listed)
    if not designs:
        raise NoAnswerError("no_feasible_design", "; ".join(item.reason for item in found.missing if item.reason))
    assert winner is not None
    best = next(shaped for shaped in leaders if shaped.shape.name == winner.shape.name)
    return _chosen(best, listed)


def close_to(chosen: Chosen, found: Found, space: SearchSpace) -> tuple[Chosen, ...]:
    """The chosen design, then the best of every other kind that is near in worth: their castings decide.

    A design that only a table knows is not compared with one that was solved.

    Parameters
    ----------
    chosen : Chosen
        From :func:`choose`.
    found : Found
        That it was chosen from.
    space : SearchSpace
    """
    if found.asked.lower() != AUTO:
        return (chosen,)
    least = chosen.found.best.worth() - space.targets.weights.resolution
    solved = any(shaped.elements is not None for shaped in found.designs)
    designs = [shaped for shaped in found.designs if not solved or shaped.elements is not None]
    kinds = dict.fromkeys(shaped.shape.name for shaped in designs if shaped.shape.name != chosen.shape.name)
    leaders = [max((one for one in designs if one.shape.name == kind), key=_rank) for kind in kinds]
    near = _fitted([shaped for shaped in leaders if shaped.worth >= least], space)
    others = [_chosen(shaped, chosen.beside) for shaped in near]
    if not chosen.shape.plain and found.slab is not None and found.slab.best.worth() >= least:
        others.append(Chosen(Slab(), found.slab, found.slab_law, found.slab_law, chosen.beside))
    return (chosen, *others)


def _chosen(best: Shaped, beside: tuple[Beside, ...]) -> Chosen:
    return Chosen(best.shape, best.found, best.law, best.elements or replace(best.law, cast=True), beside)


def _rank(shaped: Shaped) -> tuple[bool, float]:
    """Solved designs before those that only a table knows, then by what they are worth."""
    return shaped.elements is not None, shaped.worth


def _fitted(designs: Sequence[Shaped], space: SearchSpace, kind: str | None = None) -> list[Shaped]:
    """With the tissue's law fitted to the presses of designs, which a search leaves out, and of their alternatives.

    Where a kind is named, only its alternatives are fitted: nobody sees the others.
    """
    groups = [
        (shaped.found.best, *(shaped.found.alternatives if kind in (None, shaped.shape.name) else ()))
        for shaped in designs
    ]
    fits = iter(with_parameters([candidate for group in groups for candidate in group], space))
    fitted = [[next(fits) for _ in group] for group in groups]
    return [
        replace(shaped, found=replace(shaped.found, best=best, alternatives=tuple(others) or shaped.found.alternatives))
        for shaped, (best, *others) in zip(designs, fitted)
    ]


def _designs(text: str, space: SearchSpace, refused: Mapping[str, str]) -> tuple[list[Shaped], list[Beside]]:
    """Designs of the kinds asked for by their tables, and the kinds that have none with the reason."""
    from dummydesign.design.search.tabulated_shapes import load_family

    found: list[Shaped] = []
    failed = []
    kinds = [kind for kind in kinds_of(text) if kind not in refused]
    failed += [Beside(kind, None, None, None, None, refused[kind]) for kind in kinds_of(text) if kind in refused]
    families = [load_family(kind) for kind in kinds]
    if space.correct is not None:
        families = [space.correct(family) for family in families]
    results: list[list[Shaped] | NoAnswerError]
    if ":" in text:
        try:
            results = [[search_fixed(families[0], read_shape(text), space)]]
        except NoAnswerError as problem:
            results = [problem]
    else:
        results = search_shapes(families, space)
    for kind, result in zip(kinds, results):
        if isinstance(result, NoAnswerError):
            failed.append(Beside(kind, None, None, None, None, str(result)))
        else:
            found += result
    able = [pourable for shaped in found if (pourable := _pourable(shaped, space.resin)) is not None]
    for kind in {shaped.shape.name for shaped in found} - {shaped.shape.name for shaped in able}:
        reason = f"no {kind} pad has a base that {space.resin.name} can be mixed for"
        failed.append(Beside(kind, None, None, None, None, reason))
    return able, failed


def _pourable(shaped: Shaped, resin: Resin) -> Shaped | None:
    """The design with those alternatives whose second resin can be mixed; None when its own cannot."""
    if shaped.shape.layers() is None:
        return shaped
    if not mixable(shaped.shape, shaped.found.best.ratio, resin):
        return None
    others = tuple(other for other in shaped.found.alternatives if mixable(shaped.shape, other.ratio, resin))
    return replace(shaped, found=replace(shaped.found, alternatives=others))


def beside_of(chosen: Chosen, best: Candidate, space: SearchSpace) -> Beside:
    """The row of a kind's best design, where it is another than the search's.

    Parameters
    ----------
    chosen : Chosen
        Its shape.
    best : Candidate
    space : SearchSpace
    """
    by = next(item.by for item in chosen.beside if item.kind == chosen.shape.name)
    return _beside(chosen.shape.name, chosen.shape, best, space, by or "table")


def _beside(kind: str, shape: PadShape, best: Candidate, space: SearchSpace, by: str) -> Beside:
    young = 1e3 * float(np.asarray(space.resin.young_MPa(best.ratio)))
    return Beside(kind, shape, best, young, low_force(best, space.targets), None, by)
