"""The best pad of each kind by one rule, and how near it comes at low force."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, NoAnswerError, unknown_name
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.request import PAPER
from dummydesign.design.scoring.presses import steady_depth
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import NOT_ACCEPTABLE
from dummydesign.design.search.shape_family import designable_kinds, load_family
from dummydesign.design.search.shapes import Shaped, mixable, search_fixed, search_shapes
from dummydesign.design.search.slabs import DesignCandidate, SearchResult, SearchSpace, search, with_parameters
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw

if TYPE_CHECKING:
    from dummydesign.resin.model.resin import Resin


AUTO = "auto"
# Forces of the tissue over which the misfit is taken in the paper's test, even in the logarithm. [N]
MISFIT_N = PAPER.misfit_N


@dataclass(frozen=True)
class LowForce(Serialised):
    """One design against the tissue from a tenth of the lowest force of the test to its highest: 0.5 to 15 N."""

    misfit_rms_ln_force: float | None
    share_below_5N: float
    share_above_5N: float
    exponent_at_N: dict[str, float | None]
    depth_over_thickness: float | None


def low_force(candidate: DesignCandidate, targets: Targets) -> LowForce:
    """Compare a design with the aim and the subjects' range over 0.5 to 15 N."""
    index, evaluation = candidate.index, candidate.evaluation
    slabs = evaluation.slabs.take(np.array([index]))
    protocol, sampling = targets.protocol, targets.sampling.coarse
    area = np.array(protocol.exponent_at_N) / slabs.young_MPa[0]
    depth = slabs.curves.depth_at(slabs.slab, area[None])
    exponent = (slabs.curves.slope_at(slabs.slab, depth) * depth / area)[0]
    deepest = float(steady_depth(slabs, protocol.forces_N[-1], protocol.slow_mm_s, sampling)[0])
    wide = steady_depth(slabs, protocol.wide_N, protocol.slow_mm_s, sampling)[0]
    return LowForce(
        misfit(wide, protocol.wide_N, targets.aim_depth_mm(protocol.misfit_N), protocol.misfit_N),
        float(evaluation.low_force_range[index]),
        float(evaluation.steady_state_range[index]),
        to_plain({f"{force:g}": value for force, value in zip(protocol.exponent_at_N, exponent)}),
        to_plain(deepest / candidate.thickness_mm),
    )


def misfit(depth_mm: NDArray, force_N: NDArray, aim_depth_mm: NDArray, aim_N: NDArray = MISFIT_N) -> float | None:
    """Root mean square of ln F(pad) - ln F(aim) over the aim's forces."""
    known = np.isfinite(depth_mm)
    if known.sum() < 2 or depth_mm[known].max() < aim_depth_mm.max() * (1.0 - 1e-9):
        return None
    away = np.log(force_at(aim_depth_mm, depth_mm, force_N) / aim_N)
    return float(np.sqrt(np.mean(away**2)))


def steady_force(candidate: DesignCandidate, depth_mm: NDArray) -> NDArray:
    """Steady force of a design at depths, through its steady curve; NaN beyond it. [N]"""
    slabs = candidate.evaluation.slabs.take(np.array([candidate.index]))
    protocol, sampling = candidate.evaluation.protocol, candidate.evaluation.sampling.coarse
    wide = steady_depth(slabs, protocol.wide_N, protocol.slow_mm_s, sampling)[0]
    return force_at(depth_mm, wide, protocol.wide_N)


def force_at(at_mm: NDArray, depth_mm: NDArray, force_N: NDArray) -> NDArray:
    """Force at depths on a curve, straight in ln F over ln depth; NaN beyond the curve's deepest point. [N]"""
    known = np.isfinite(depth_mm)
    curve = np.log(depth_mm[known]), np.log(force_N[known])
    # A little slack: the aim's deepest point may be the curve's own.
    held = np.minimum(at_mm, depth_mm[known].max() * (1.0 + 1e-9))
    force = np.exp(np.interp(np.log(held), *curve))
    return np.where(at_mm <= held, force, np.nan)


@dataclass(frozen=True)
class ShapeComparison:
    """The best design of one kind of shape, or the reason why there is none.

    ``by`` says where its force comes from: ``table``, ``law`` or ``elements``.
    """

    kind: str
    shape: PadShape | None = None
    candidate: DesignCandidate | None = None
    young_kPa: float | None = None
    low_force: LowForce | None = None
    reason: str | None = None
    by: str | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return the design and how near it comes to the tissue as plain values."""
        if self.candidate is None or self.low_force is None:
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
class SearchOutcome:
    """What tables give for a request: the best flat slab, designs of the requested kinds, kinds without one."""

    asked: str
    slab_law: ForceLaw
    slab: SearchResult | None
    slab_reason: str | None = None
    designs: tuple[Shaped, ...] = ()
    missing: tuple[ShapeComparison, ...] = ()


@dataclass(frozen=True)
class Chosen:
    """The winning design with its force laws: in proportion with thickness, and as cast."""

    shape: PadShape
    found: SearchResult
    law: ForceLaw
    cast: ForceLaw
    beside: tuple[ShapeComparison, ...]


def kinds_of(text: str) -> tuple[str, ...]:
    """Kinds of shapes a request names: one kind, one given shape, or ``auto`` for all with a response surface."""
    known = designable_kinds()
    if text.lower() == AUTO:
        return known
    name = text.partition(":")[0].lower()
    shape = read_shape(text) if ":" in text else None
    if shape is None and name not in known and name != Slab.name:
        raise unknown_name("shape", text, (*known, Slab.name, AUTO))
    if name not in known and name != Slab.name:
        message = f"shape {name} has no response surface; press it with 'dummydesign predict --shape {text}'"
        raise InputError(message, "unsupported", "shape", text)
    return (name,)


def best_of_kinds(
    text: str, slab_law: ForceLaw, space: SearchSpace, refused: Mapping[str, str] = MappingProxyType({})
) -> SearchOutcome:
    """Search every kind of shape that a request names, and the slab by the same rule."""
    if text.lower() != AUTO and (reason := refused.get(text.partition(":")[0].lower())):
        raise InputError(f"shape = {text}: {reason}", "unsupported", "shape", text)
    if text.lower() == Slab.name:
        return SearchOutcome(text, slab_law, search(slab_law, space))
    slab, reason = None, None
    try:
        slab = search(slab_law, space, space.targets.weights.low_aim)
    except NoAnswerError as problem:
        reason = str(problem)
    return SearchOutcome(text, slab_law, slab, reason, *_designs(text, space, refused))


def choose(found: SearchOutcome, space: SearchSpace) -> Chosen:
    """Take the best of what was found: solved designs first; a slab only where it was requested or by ``auto``."""
    flat, law, designs = found.slab, found.slab_law, found.designs
    if found.asked.lower() == Slab.name and flat is not None:
        return Chosen(Slab(), flat, law, law, ())
    beside = [ShapeComparison(Slab.name, reason=found.slab_reason)]
    if flat is not None:
        beside = [compare_shape(Slab.name, Slab(), flat.best, space, "table")]
    winner = max(designs, key=_rank) if designs else None
    leaders = _fitted(_leaders(designs), space, None if winner is None else winner.shape.name)
    for best in leaders:
        by = best.law.family.source if best.elements is None else "elements"
        beside.append(compare_shape(best.shape.name, best.shape, best.found.best, space, by))
    listed = (*beside, *found.missing)
    if found.asked.lower() == AUTO and flat is not None and (winner is None or flat.best.worth() >= winner.worth):
        return Chosen(Slab(), flat, law, law, listed)
    if winner is None:
        message = "; ".join(item.reason for item in found.missing if item.reason)
        raise NoAnswerError("no_feasible_design", message, quantity="pad")
    best = next(shaped for shaped in leaders if shaped.shape.name == winner.shape.name)
    return _chosen(best, listed)


def close_to(chosen: Chosen, found: SearchOutcome, space: SearchSpace) -> tuple[Chosen, ...]:
    """The chosen design, then the best of every other kind that is near in worth: their castings decide.

    A design that only a table knows is not compared with one that was solved.
    """
    if found.asked.lower() != AUTO:
        return (chosen,)
    least = chosen.found.best.worth() - space.targets.weights["resolution"]
    solved = any(shaped.elements is not None for shaped in found.designs)
    designs = [shaped for shaped in found.designs if not solved or shaped.elements is not None]
    leaders = _leaders([shaped for shaped in designs if shaped.shape.name != chosen.shape.name])
    near = _fitted([shaped for shaped in leaders if shaped.worth >= least], space)
    others = [_chosen(shaped, chosen.beside) for shaped in near]
    if not chosen.shape.plain and found.slab is not None and found.slab.best.worth() >= least:
        others.append(Chosen(Slab(), found.slab, found.slab_law, found.slab_law, chosen.beside))
    return (chosen, *others)


def _leaders(designs: Sequence[Shaped]) -> list[Shaped]:
    """The best design of each kind."""
    kinds: dict[str, list[Shaped]] = {}
    for shaped in designs:
        kinds.setdefault(shaped.shape.name, []).append(shaped)
    return [max(own, key=_rank) for own in kinds.values()]


def _chosen(best: Shaped, beside: tuple[ShapeComparison, ...]) -> Chosen:
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


def _designs(
    text: str, space: SearchSpace, refused: Mapping[str, str]
) -> tuple[tuple[Shaped, ...], tuple[ShapeComparison, ...]]:
    """Designs of the requested kinds by their tables, and the kinds that have none with the reason."""
    found: list[Shaped] = []
    kinds = [kind for kind in kinds_of(text) if kind not in refused]
    failed = [ShapeComparison(kind, reason=refused[kind]) for kind in kinds_of(text) if kind in refused]
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
            failed.append(ShapeComparison(kind, reason=str(result)))
        else:
            found += result
    able = [pourable for shaped in found if (pourable := _pourable(shaped, space.resin)) is not None]
    for kind in {shaped.shape.name for shaped in found} - {shaped.shape.name for shaped in able}:
        reason = f"no {kind} pad has a base that {space.resin.name} can be mixed for"
        failed.append(ShapeComparison(kind, reason=reason))
    return tuple(able), tuple(failed)


def _pourable(shaped: Shaped, resin: Resin) -> Shaped | None:
    """The design with those alternatives whose second resin can be mixed; None when its own cannot."""
    if shaped.shape.layers() is None:
        return shaped
    if not mixable(shaped.shape, shaped.found.best.ratio, resin):
        return None
    others = tuple(other for other in shaped.found.alternatives if mixable(shaped.shape, other.ratio, resin))
    return replace(shaped, found=replace(shaped.found, alternatives=others))


def compare_shape(kind: str, shape: PadShape, best: DesignCandidate, space: SearchSpace, by: str) -> ShapeComparison:
    """The row of a kind's best design."""
    young = 1e3 * float(np.asarray(space.resin.young_MPa(best.ratio)))
    return ShapeComparison(kind, shape, best, young, low_force(best, space.targets), None, by)
