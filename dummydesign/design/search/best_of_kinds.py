"""Search over shapes, the best pad of each kind by one rule, and how near it comes at low force.

The first sieve is elastic and free of the resin's steps: at the depths where the aim carries 0.5 to 15 N
every shape's force is known up to its modulus, whose best value in ln F is a mean. The remainder is the
misfit. The best of it, one a thickness, go through the same
search over ratio and thickness as slabs do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, NoAnswerError, unknown_name
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.design.request import PAPER
from dummydesign.design.scoring.presses import DEPTH_SHARE
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import NOT_ACCEPTABLE
from dummydesign.design.search.shape_family import Designs, Family, FamilyLaw, designable_kinds, load_family
from dummydesign.design.search.slabs import (
    THICKNESS_STEP_MM,
    DesignCandidate,
    SearchResult,
    SearchSpace,
    search,
    search_each,
    with_parameters,
)
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin

SIEVED, TRIED, AROUND_STEPS, REFINED = 400, 6, 2, 4
SIEVE_STEP = 3


@dataclass(frozen=True)
class Shaped:
    """The design of one kind: its force law in proportion with thickness, and that of its finite elements once solved.

    ``comparisons`` are the best designs of all kinds, where it was chosen among them.
    """

    shape: PadShape
    law: ForceLaw
    result: SearchResult
    elements: ForceLaw | None = None
    comparisons: tuple[ShapeComparison, ...] = ()

    @property
    def table(self) -> FamilyLaw:
        """Force law of a tabulated shape as it is cast."""
        return replace(cast(FamilyLaw, self.law), cast=True)

    @property
    def cast(self) -> ForceLaw:
        """Force law of the pad as it is cast, by its elements where they are solved."""
        return self.elements or (self.table if isinstance(self.law, FamilyLaw) else self.law)

    @property
    def merit(self) -> float:
        """What is expected of a design with a shape, whether it is representative or not."""
        return self.result.best.merit() - self.result.best.loss

    @property
    def worth(self) -> float:
        """By what designs with a shape are chosen; see :meth:`DesignCandidate.worth`."""
        return self.result.best.worth()


def misfits(family: Family, designs: Designs, targets: Targets, young_MPa: NDArray, radius_mm: float) -> NDArray:
    """Misfit (M,) of pads to the aim with their best modulus inside a range; NaN where the force is not known."""
    forces = targets.protocol.misfit_N[::SIEVE_STEP]
    depth, misfit = targets.aim_depth_mm(forces), np.full(len(designs.thickness_mm), np.nan)
    for start in range(0, len(misfit), 4000):
        rows = np.arange(start, min(start + 4000, len(misfit)))
        area = family.area_mm2(designs.take(rows), np.broadcast_to(depth, (len(rows), len(depth))), radius_mm)
        away = np.log(forces) - np.log(area)
        level = np.clip(away.mean(axis=1), np.log(young_MPa.min()), np.log(young_MPa.max()))
        misfit[rows] = np.sqrt(np.mean((away - level[:, None]) ** 2, axis=1))
    return misfit


def prescreen(family: Family, space: SearchSpace) -> Designs:
    """The best castable pad of each thickness that reaches the aim's depth at 15 N; some of them, by rising misfit."""
    thickness, targets = space.thickness_mm, space.targets
    designs = family.candidates(thickness, space.radius_mm)
    limit = family.limit_mm(designs, space.radius_mm)
    forces = targets.protocol.misfit_N[::SIEVE_STEP]
    deepest = targets.aim_depth_mm(forces)[-1]
    deep = np.minimum(limit, DEPTH_SHARE * designs.thickness_mm) >= deepest
    designs = replace(designs, limit_mm=limit).take(deep)
    misfit = misfits(family, designs, targets, space.resin.young_MPa(space.ratio), space.radius_mm)
    order = np.argsort(misfit, kind="stable")[: min(int(np.isfinite(misfit).sum()), SIEVED)]
    kept = order[_one_a_thickness(designs.take(order), space.pad_mm, TRIED)]
    if not len(kept):
        raise NoAnswerError(
            "no_feasible_design",
            f"no {family.kind} pad of {thickness[0]:g} to {thickness[-1]:g} mm reaches {deepest:.2f} mm, the tissue's "
            f"depth at {forces[-1]:g} N, within {DEPTH_SHARE:g} of its thickness; allow thicker pads", quantity="pad",
        )  # fmt: skip
    return designs.take(kept)


def search_shapes(families: Sequence[Family], space: SearchSpace) -> list[list[Shaped] | NoAnswerError]:
    """Shape, thickness and ratio of each family: designs of several thicknesses, the best first, or why it has none."""
    starts: list[list[tuple[Family, PadShape, float]] | NoAnswerError] = []
    for family in families:
        try:
            designs = prescreen(family, space)
        except NoAnswerError as problem:
            starts.append(problem)
            continue
        starts.append([(family, designs.shape(i), at) for i, at in enumerate(designs.thickness_mm.tolist())])
    around = iter(_around([one for each in starts if isinstance(each, list) for one in each], space))
    answers: list[list[Shaped] | NoAnswerError] = []
    for family, each in zip(families, starts):
        if isinstance(each, NoAnswerError):
            answers.append(each)
            continue
        able = [shaped for shaped in (next(around) for _ in each) if shaped is not None]
        why = f"no {family.kind} pad reaches {space.targets.protocol.needed_N:g} N within its depth limit"
        best_first = sorted(able, key=lambda shaped: shaped.worth, reverse=True)
        answers.append(best_first if able else NoAnswerError("no_feasible_design", why, quantity="pad"))
    return answers


def search_fixed(family: Family, shape: PadShape, space: SearchSpace) -> Shaped:
    """Find thickness and ratio of a shape whose lengths are given: only what lies under it changes."""
    family.check(shape)
    fitting = [float(thickness) for thickness in space.thickness_mm if _accepts(shape, float(thickness), space.pad_mm)]
    if not fitting:
        shape.check(float(space.thickness_mm[-1]), *space.pad_mm)
    law = FamilyLaw(family, shape, fitting[0], cast=True)
    steps = np.array(fitting)[law.depth_limit_mm(np.array(fitting), space.radius_mm) > 0.0]
    if not len(steps):
        raise NoAnswerError(
            "no_feasible_design",
            f"{shape} lies outside the response surface of {family.kind} pads at every thickness from {fitting[0]:g} "
            f"to {fitting[-1]:g} mm; press it with 'dummydesign predict --shape {shape} --fidelity {shape.fidelity}'",
            quantity="shape",
        )
    result = search(law, replace(space, thickness_mm=steps), space.targets.weights.low_aim, fitted=0)
    return Shaped(shape, law, result)


def mixable(shape: PadShape, ratio: float, resin: Resin) -> bool:
    """Whether the second resin of a layered shape can be mixed where the first has a ratio; others need none."""
    layers = shape.layers()
    if layers is None:
        return True
    low, high = np.sort(np.asarray(resin.young_MPa(np.array([resin.ratio_min, resin.ratio_max]))))
    return bool(low <= layers[1] * np.asarray(resin.young_MPa(ratio)) <= high)


def _accepts(shape: PadShape, thickness_mm: float, pad_mm: tuple[float, float]) -> bool:
    try:
        shape.check(thickness_mm, *pad_mm)
    except InputError:
        return False
    return True


def _around(starts: Sequence[tuple[Family, PadShape, float]], space: SearchSpace) -> list[Shaped | None]:
    """Search ratio and the thicknesses near each start, in proportion; then its own, rounded shape exactly."""
    near = [_near(*start, space) for start in starts]
    able = [n for n, steps in enumerate(near) if len(steps)]
    low_share, rough = space.targets.weights.low_aim, {}
    laws: list[tuple[ForceLaw, NDArray]] = [(FamilyLaw(*starts[n]), near[n]) for n in able]
    for n, result in zip(able, search_each(laws, space, low_share, REFINED, 0)):
        if isinstance(result, SearchResult):
            (family, shape, thickness), chosen = starts[n], result.best.thickness_mm
            rounded = family.at_thickness(shape, thickness, np.array([chosen])).shape(0).rounded()
            if _accepts(rounded, chosen, space.pad_mm):
                rough[n] = FamilyLaw(family, rounded, chosen), result
    laws = [(law, np.array([law.made_for_mm])) for law, _ in rough.values()]
    made: list[Shaped | None] = [None] * len(starts)
    for (n, (law, result)), exact in zip(rough.items(), search_each(laws, space, low_share, REFINED, 0, others=False)):
        if isinstance(exact, SearchResult):
            made[n] = Shaped(law.shape, law, replace(result, best=exact.best))
    return made


def _near(family: Family, shape: PadShape, thickness: float, space: SearchSpace) -> NDArray:
    """Thicknesses of the space near that of a start at which the shape in proportion is known and can be cast."""
    near = space.thickness_mm[np.abs(space.thickness_mm - thickness) <= AROUND_STEPS * THICKNESS_STEP_MM + 1e-9]
    known = FamilyLaw(family, shape, thickness).depth_limit_mm(near, space.radius_mm) > 0.0
    return near[known & family.at_thickness(shape, thickness, near).castable(space.pad_mm)]


def _one_a_thickness(designs: Designs, pad_mm: tuple[float, float], count: int) -> list[int]:
    """Places of the first castable design of each thickness, in order; no more than a count."""
    indices: list[int] = []
    seen: set[float] = set()
    for index, thickness in enumerate(designs.thickness_mm.tolist()):
        if len(indices) < count and thickness not in seen and designs.take(np.array([index])).castable(pad_mm)[0]:
            seen.add(thickness)
            indices.append(index)
    return indices


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
    index, evaluation, slabs, protocol = candidate.index, candidate.evaluation, candidate.alone, targets.protocol
    area = np.array(protocol.exponent_at_N) / slabs.young_MPa[0]
    depth = slabs.curves.depth_at(slabs.slab, area[None])
    exponent = (slabs.curves.slope_at(slabs.slab, depth) * depth / area)[0]
    deepest = float(candidate.steady_depth_mm(np.array([protocol.forces_N[-1]]))[0])
    wide = candidate.steady_depth_mm(protocol.wide_N)
    return LowForce(
        misfit(wide, protocol.wide_N, targets.aim_depth_mm(protocol.misfit_N), protocol.misfit_N),
        float(evaluation.low_force_range[index]), float(evaluation.steady_state_range[index]),
        to_plain({f"{force:g}": value for force, value in zip(protocol.exponent_at_N, exponent)}),
        to_plain(deepest / candidate.thickness_mm),
    )  # fmt: skip


def misfit(depth_mm: NDArray, force_N: NDArray, aim_depth_mm: NDArray, aim_N: NDArray = MISFIT_N) -> float | None:
    """Root mean square of ln F(pad) - ln F(aim) over the aim's forces."""
    known = np.isfinite(depth_mm)
    if known.sum() < 2 or depth_mm[known].max() < aim_depth_mm.max() * (1.0 - 1e-9):
        return None
    away = np.log(force_at(aim_depth_mm, depth_mm, force_N) / aim_N)
    return float(np.sqrt(np.mean(away**2)))


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
            "kind": self.kind, "shape": str(self.shape), "thickness_mm": self.candidate.thickness_mm,
            "ratio": self.candidate.ratio, "young_kPa": self.young_kPa, "merit": self.candidate.merit(),
            "total": self.candidate.total, "by": self.by, "acceptable": self.candidate.rank > NOT_ACCEPTABLE,
            **self.low_force.to_dict(), "reason": None,
        }  # fmt: skip


@dataclass(frozen=True)
class SearchOutcome:
    """What tables give for a request: the best flat slab, designs of the requested kinds, kinds without one."""

    asked: str
    slab: Shaped | None
    slab_reason: str | None = None
    designs: tuple[Shaped, ...] = ()
    missing: tuple[ShapeComparison, ...] = ()


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
        return SearchOutcome(text, Shaped(Slab(), slab_law, search(slab_law, space)))
    slab, reason = None, None
    try:
        slab = Shaped(Slab(), slab_law, search(slab_law, space, space.targets.weights.low_aim))
    except NoAnswerError as problem:
        reason = str(problem)
    return SearchOutcome(text, slab, reason, *_designs(text, space, refused))


def choose(outcome: SearchOutcome, space: SearchSpace) -> Shaped:
    """Take the best of what was found: solved designs first; a slab only where it was requested or by ``auto``."""
    flat, designs = outcome.slab, outcome.designs
    if outcome.asked.lower() == Slab.name and flat is not None:
        return flat
    none = ShapeComparison(Slab.name, reason=outcome.slab_reason)
    comparisons = [none if flat is None else compare_shape(flat, space, "table")]
    winner = max(designs, key=_rank) if designs else None
    leaders = _fitted(_leaders(designs), space, None if winner is None else winner.shape.name)
    for best in leaders:
        by = best.table.family.source if best.elements is None else "elements"
        comparisons.append(compare_shape(best, space, by))
    listed = (*comparisons, *outcome.missing)
    if outcome.asked.lower() == AUTO and flat is not None and (winner is None or flat.worth >= winner.worth):
        return replace(flat, comparisons=listed)
    if winner is None:
        message = "; ".join(item.reason for item in outcome.missing if item.reason)
        raise NoAnswerError("no_feasible_design", message, quantity="pad")
    best = next(shaped for shaped in leaders if shaped.shape.name == winner.shape.name)
    return replace(best, comparisons=listed)


def close_to(chosen: Shaped, outcome: SearchOutcome, space: SearchSpace) -> tuple[Shaped, ...]:
    """The chosen design, then the best of every other kind that is near in worth: their castings decide.

    A design that only a table knows is not compared with one that was solved.
    """
    if outcome.asked.lower() != AUTO:
        return (chosen,)
    least = chosen.worth - space.targets.weights["resolution"]
    solved = any(shaped.elements is not None for shaped in outcome.designs)
    designs = [shaped for shaped in outcome.designs if not solved or shaped.elements is not None]
    leaders = _leaders([shaped for shaped in designs if shaped.shape.name != chosen.shape.name])
    near = _fitted([shaped for shaped in leaders if shaped.worth >= least], space)
    if not chosen.shape.plain and outcome.slab is not None and outcome.slab.worth >= least:
        near.append(outcome.slab)
    return (chosen, *(replace(shaped, comparisons=chosen.comparisons) for shaped in near))


def _leaders(designs: Sequence[Shaped]) -> list[Shaped]:
    """The best design of each kind."""
    kinds: dict[str, list[Shaped]] = {}
    for shaped in designs:
        kinds.setdefault(shaped.shape.name, []).append(shaped)
    return [max(own, key=_rank) for own in kinds.values()]


def _rank(shaped: Shaped) -> tuple[bool, float]:
    """Solved designs before those that only a table knows, then by what they are worth."""
    return shaped.elements is not None, shaped.worth


def _fitted(designs: Sequence[Shaped], space: SearchSpace, kind: str | None = None) -> list[Shaped]:
    """With the tissue's law fitted to the presses of designs, which a search leaves out, and of their alternatives.

    Where a kind is named, only its alternatives are fitted: nobody sees the others.
    """
    groups = [
        (shaped.result.best, *(shaped.result.alternatives if kind in (None, shaped.shape.name) else ()))
        for shaped in designs
    ]
    fits = iter(with_parameters([candidate for group in groups for candidate in group], space))
    fitted = [[next(fits) for _ in group] for group in groups]
    results = [
        replace(shaped.result, best=best, alternatives=tuple(others) or shaped.result.alternatives)
        for shaped, (best, *others) in zip(designs, fitted)
    ]
    return [replace(shaped, result=result) for shaped, result in zip(designs, results)]


def _designs(
    text: str, space: SearchSpace, refused: Mapping[str, str]
) -> tuple[tuple[Shaped, ...], tuple[ShapeComparison, ...]]:
    """Designs of the requested kinds by their tables, and the kinds that have none with the reason."""
    designs: list[Shaped] = []
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
            designs += result
    able = [pourable for shaped in designs if (pourable := _pourable(shaped, space.resin)) is not None]
    for kind in {shaped.shape.name for shaped in designs} - {shaped.shape.name for shaped in able}:
        reason = f"no {kind} pad has a base that {space.resin.name} can be mixed for"
        failed.append(ShapeComparison(kind, reason=reason))
    return tuple(able), tuple(failed)


def _pourable(shaped: Shaped, resin: Resin) -> Shaped | None:
    """The design with those alternatives whose second resin can be mixed; None when its own cannot."""
    if shaped.shape.layers() is None:
        return shaped
    if not mixable(shaped.shape, shaped.result.best.ratio, resin):
        return None
    others = tuple(other for other in shaped.result.alternatives if mixable(shaped.shape, other.ratio, resin))
    return replace(shaped, result=replace(shaped.result, alternatives=others))


def compare_shape(design: Shaped, space: SearchSpace, by: str) -> ShapeComparison:
    """The row of a kind's best design."""
    shape, best = design.shape, design.result.best
    young = 1e3 * float(np.asarray(space.resin.young_MPa(best.ratio)))
    return ShapeComparison(shape.name, shape, best, young, low_force(best, space.targets), None, by)
