"""Search over shape, thickness and ratio: the pads of which most castings will be usable.

The first sieve is elastic and free of the resin: at the depths where the aim carries 0.5 to 15 N every pad's force is
known up to its modulus, whose best value in ln F is a mean; the remainder is the misfit. Unlike pads of every thickness
that come near are then pressed as cured by a few batches of the resin (:mod:`dummydesign.design.scoring.windows`), and
the best of them by many.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import DummydesignError, InputError, NoAnswerError, accepts, unknown_name
from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.scoring.crowns import DEVIATES, crown_scatter, finite_strain_of
from dummydesign.design.scoring.outlook import LEAST, Match, Outlook, Scatter, outlook_of, smoothed
from dummydesign.design.scoring.press_simulation import DEPTH_SHARE, PadBatch, SlabCurves, make_curves
from dummydesign.design.scoring.windows import MARGIN, REACH, Batches, unlike, windows_of
from dummydesign.design.search.shape_family import Designs, Family, FamilyLaw, designable_kinds, load_family
from dummydesign.design.search.slabs import DesignCandidate, SearchSpace, exact_candidates, make_slabs, with_parameters
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin

# Unlike pads of a thickness and of a kind that pass the sieve; lengths that differ by less than a share are alike.
A_THICKNESS, A_KIND, ALIKE = 6, 80, 0.12
# Batches and moduli by which pads are first compared, and those of the leading ones.
FEW_BATCHES, FEW_NODES, MANY_BATCHES, MANY_NODES = 6, 10, 160, 10
LEADING = 14
# Scatter of ln modulus of a usual making, by which windows are first compared.
USUAL_SCATTER = 0.05
# Samples of a pad's curve in the search, and every which force of the sieve is compared.
SAMPLES, SIEVE_STEP = 161, 3
# Of these forces, those by which all pads are compared first, and how many pads are compared at all of them.
ROUGH, SIEVED = [0, 5, 9, -1], 3000
# Nodes of an even tolerance of thickness, over its half width, that are equally likely.
TOLERANCE_NODES = (-0.7746, 0.0, 0.7746)
AUTO = "auto"
# Castings whose crowns tell how much they scatter the force of a pad.
CROWNS = 60
# Level of a pad that is usable neither as poured nor with the resin measured.
NONE = 3


@dataclass(frozen=True, eq=False)
class _Sieved:
    """A pad that passed the sieve, with its force laws: in proportion with thickness, and as it is cast."""

    shape: PadShape
    thickness_mm: float
    law: ForceLaw
    cast: ForceLaw
    match: Match


@dataclass(frozen=True, eq=False)
class ShapedDesign(_Sieved):
    """A pad that may be recommended, with what is expected of it; ``solved`` is whether ``cast`` is from finite
    elements of this pad."""

    outlook: Outlook
    solved: bool = False

    @property
    def table(self) -> FamilyLaw:
        """Force law of a tabulated shape as it is cast."""
        return replace(cast(FamilyLaw, self.law), cast=True)

    @property
    def source(self) -> str:
        """Where the force comes from: ``elements``, ``table`` or ``law``."""
        if self.solved:
            return "elements"
        return self.law.family.source if isinstance(self.law, FamilyLaw) else "table"


def kinds_of(text: str) -> tuple[str, ...]:
    """Kinds of shapes a request names: one kind, one given shape, or ``auto`` for all whose force is known."""
    known = designable_kinds()
    if text.lower() == AUTO:
        return (Slab.name, *(kind for kind in known if kind != Slab.name))
    name = text.partition(":")[0].lower()
    shape = read_shape(text) if ":" in text else None
    if shape is None and name not in known and name != Slab.name:
        raise unknown_name("shape", text, (*known, Slab.name, AUTO))
    if name not in known and name != Slab.name:
        message = f"shape {name} has no response surface; press it with 'dummydesign predict --shape {text}'"
        raise InputError(message, "unsupported", "shape", text)
    return (name,)


def search_shapes(
    text: str, slab_law: ForceLaw, space: SearchSpace, refused: Mapping[str, str] = MappingProxyType({})
) -> tuple[list[ShapedDesign], dict[str, str]]:
    """Search every kind of shape that a request names, by its tables: designs, the best first, and why kinds have none.

    A pad that cannot be made is left out; its error stands where no pad is left and one kind was named.

    Raises
    ------
    InputError, NoAnswerError
        When no kind has a pad that can be made and reaches the middle force of the test.
    """
    kinds = kinds_of(text)
    if text.lower() != AUTO and (reason := refused.get(kinds[0])):
        raise InputError(f"shape = {text}: {reason}", "unsupported", "shape", text)
    faults: dict[str, DummydesignError] = {}
    sieved: list[_Sieved] = []
    for kind in (kind for kind in kinds if kind not in refused):
        try:
            sieved += _sieve_slabs(slab_law, space) if kind == Slab.name else _sieve_kind(kind, text, space)
        except (InputError, NoAnswerError) as problem:
            faults[kind] = problem
    designs = rank(_assessed(_leading(sieved, space), space, faults), space) if sieved else []
    if not designs and len(kinds) == 1 and faults:
        raise faults[kinds[0]]
    found, reasons = {design.shape.name for design in designs}, {**refused, **faults}
    missing = {kind: str(reasons[kind]) for kind in kinds if kind in reasons and kind not in found}
    if not designs:
        raise NoAnswerError("no_feasible_design", "; ".join(missing.values()), quantity="pad")
    return designs, missing


def rank(designs: Sequence[ShapedDesign], space: SearchSpace) -> list[ShapedDesign]:
    """Order designs: the best level, then the largest share after a puck, then as poured, then the least misfit.

    Shares within two standard errors of the largest are tied.
    """
    limits, strict, left = space.targets.limits, space.targets.strict, list(designs)
    ordered: list[ShapedDesign] = []
    while left:
        level = min(one.outlook.level(limits, strict) for one in left)
        if none_usable(left, space):
            return ordered + sorted(left, key=lambda one: (one.outlook.beyond, one.outlook.misfit))
        best = [one for one in left if one.outlook.level(limits, strict) == level]
        top = max(best, key=lambda one: one.outlook.after_puck).outlook
        tied = [one for one in best if one.outlook.ties(top)]
        top = max(tied, key=lambda one: one.outlook.as_poured).outlook
        tied = [one for one in tied if one.outlook.ties(top, poured=True)]
        first = min(tied, key=lambda one: one.outlook.misfit)
        ordered.append(first)
        left.remove(first)
    return ordered


def none_usable(designs: Sequence[ShapedDesign], space: SearchSpace) -> bool:
    """Whether no pad is usable: then the one whose readings are least beyond the limits is the best."""
    limits, strict = space.targets.limits, space.targets.strict
    return all(one.outlook.level(limits, strict) == NONE and one.outlook.after_puck <= LEAST for one in designs)


def match_of(forces_N: NDArray, area_mm2: NDArray) -> tuple[NDArray, NDArray]:
    """Mean and spread (M,) of ln(F / A), the best modulus of pads for the aim and what it leaves. [ln MPa]

    ``area_mm2`` (M, n) is force over modulus at the aim's depths; NaN beyond what is known.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        away = np.log(forces_N) - np.log(area_mm2)
    known = np.isfinite(away)
    count = np.maximum(known.sum(axis=1), 1)
    mean = np.where(known, away, 0.0).sum(axis=1) / count
    spread = np.sqrt(np.where(known, (away - mean[:, None]) ** 2, 0.0).sum(axis=1) / count)
    return np.where(known.any(axis=1), mean, np.nan), spread


def _thickness_matches(law: ForceLaw, thickness_mm: NDArray, space: SearchSpace) -> tuple[SlabCurves, NDArray, NDArray]:
    """Curves of a law at thicknesses (M,) with the mean and the spread (M,) of :func:`match_of`, up to their limits."""
    targets = space.targets
    curves = make_curves(law, thickness_mm, space.radius_mm, targets.limits.gel_compression)
    forces = targets.protocol.misfit_N[::SIEVE_STEP]
    depth = np.minimum(targets.aim_depth_mm(forces), curves.limit_mm[:, None])
    area = np.array([curves.area_at(np.array([n]), depth[[n]])[0] for n in range(len(thickness_mm))])
    return (curves, *match_of(forces, area))


def _sieve_slabs(law: ForceLaw, space: SearchSpace) -> list[_Sieved]:
    """A slab of each thickness; its modulus is that which carries the middle force as deep as the aim, if it can."""
    curves, mean, spread = _thickness_matches(law, space.thickness_mm, space)
    return [
        _Sieved(Slab(), float(t), law, law, Match(float(m), float(s)))
        for t, m, s, limit in zip(space.thickness_mm, mean, spread, curves.limit_mm)
        if limit > 0.0 and np.isfinite(m)
    ]


def _sieve_kind(kind: str, text: str, space: SearchSpace) -> list[_Sieved]:
    family = load_family(kind)
    if space.correct is not None:
        family = space.correct(family)
    if ":" in text:
        return _sieve_fixed(family, read_shape(text), space)
    return _sieve(family, space)


def sieve(family: Family, space: SearchSpace) -> tuple[Designs, NDArray, NDArray]:
    """Castable pads of a kind that reach the aim's depth at the largest force, with their match, by rising misfit."""
    targets, thickness = space.targets, space.thickness_mm
    forces = targets.protocol.misfit_N[::SIEVE_STEP]
    depth, designs = targets.aim_depth_mm(forces), family.candidates(thickness, space.radius_mm)
    limit = np.minimum(family.limit_mm(designs, space.radius_mm), targets.limits.gel_compression * designs.gel_mm)
    deep = np.minimum(limit, DEPTH_SHARE * designs.thickness_mm) >= depth[-1]
    designs = replace(designs, limit_mm=limit).take(deep)
    rough, *_ = _matches(family, designs, depth[ROUGH], forces[ROUGH], space)
    designs = designs.take(np.argsort(rough, kind="stable")[: min(SIEVED, int(np.isfinite(rough).sum()))])
    misfit, mean, spread = _matches(family, designs, depth, forces, space)
    order = np.argsort(misfit, kind="stable")[: int(np.isfinite(misfit).sum())]
    if not len(order):
        raise NoAnswerError(
            "no_feasible_design",
            f"no {family.kind} pad of {thickness[0]:g} to {thickness[-1]:g} mm reaches {depth[-1]:.2f} mm, the "
            f"tissue's depth at {forces[-1]:g} N, within {DEPTH_SHARE:g} of its thickness; allow thicker pads",
            quantity="pad",
        )
    return designs.take(order), mean[order], spread[order]


def _matches(
    family: Family, designs: Designs, depth_mm: NDArray, forces_N: NDArray, space: SearchSpace
) -> tuple[NDArray, NDArray, NDArray]:
    """Misfit (M,) of pads with their best modulus inside the resin's range, and their match."""
    young = np.log(space.resin.young_MPa(space.ratio))
    count = len(designs.thickness_mm)
    mean, spread = np.full(count, np.nan), np.full(count, np.nan)
    for start in range(0, count, 4000):
        rows = np.arange(start, min(start + 4000, count))
        depth = np.broadcast_to(depth_mm, (len(rows), len(depth_mm)))
        mean[rows], spread[rows] = match_of(forces_N, family.area_mm2(designs.take(rows), depth, space.radius_mm))
    return np.hypot(spread, mean - np.clip(mean, young.min(), young.max())), mean, spread


def _sieve(family: Family, space: SearchSpace) -> list[_Sieved]:
    """Unlike pads that can be cast, a few of each thickness, those of the least misfit first."""
    designs, mean, spread = sieve(family, space)
    lengths = np.stack([designs.thickness_mm, *designs.parameters.values()], axis=-1)
    kept: list[int] = []
    of_thickness: dict[float, list[int]] = {}
    for index, thickness in enumerate(designs.thickness_mm.tolist()):
        same = of_thickness.setdefault(thickness, [])
        if len(same) >= A_THICKNESS or any(_alike(lengths[index], lengths[other]) for other in same):
            continue
        if designs.take(np.array([index])).castable(space.pad_mm, space.least_film_mm)[0]:
            same.append(index)
            kept.append(index)
            if len(kept) == A_KIND:
                break
    sieved = []
    for index in kept:
        shape, thickness = designs.shape(index), float(designs.thickness_mm[index])
        match = Match(float(mean[index]), float(spread[index]))
        if mixable(shape, space.resin, np.array([_matched_ratio(match, space)]))[0]:
            law = FamilyLaw(family, shape, thickness)
            sieved.append(_Sieved(shape, thickness, law, replace(law, cast=True), match))
    if not sieved:
        reason = f"no {family.kind} pad has a base that {space.resin.name} can be mixed for"
        raise NoAnswerError("no_feasible_design", reason, quantity="pad")
    return sieved


def _alike(one: NDArray, other: NDArray) -> bool:
    return bool((np.abs(one - other) <= ALIKE * np.maximum(np.abs(one), np.abs(other))).all())


def _sieve_fixed(family: Family, shape: PadShape, space: SearchSpace) -> list[_Sieved]:
    """Pads of a shape whose lengths are given: only what lies under it changes."""
    family.check(shape)
    fitting = [
        float(thickness) for thickness in space.thickness_mm if accepts(shape.check, float(thickness), *space.pad_mm)
    ]
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
    _, mean, spread = _thickness_matches(law, steps, space)
    return [
        _Sieved(
            shape,
            float(t),
            FamilyLaw(family, shape, float(t)),
            replace(law, made_for_mm=float(t)),
            Match(float(m), float(s)),
        )
        for t, m, s in zip(steps, mean, spread)
        if np.isfinite(m)
    ]


def mixable(shape: PadShape, resin: Resin, ratio: NDArray) -> NDArray:
    """At which ratios of the first resin of a layered shape the second can be mixed; others need none."""
    layers = shape.layers()
    if layers is None:
        return np.ones(len(ratio), dtype=bool)
    low, high = np.sort(np.asarray(resin.young_MPa(np.array([resin.ratio_min, resin.ratio_max]))))
    lower = layers[1] * np.asarray(resin.young_MPa(ratio))
    return np.asarray((low <= lower) & (lower <= high))


def _matched_ratio(match: Match, space: SearchSpace) -> float:
    """The ratio whose central modulus is nearest to a pad's best."""
    young = np.log(np.asarray(space.resin.young_MPa(space.ratio)))
    return float(space.ratio[np.argmin(np.abs(young - match.log_young))])


def _curves(pads: Sequence[_Sieved], space: SearchSpace) -> SlabCurves:
    """Curves of pads, those of one family at once."""
    limit, area = np.empty(len(pads)), np.empty((len(pads), SAMPLES))
    share, gel = np.linspace(0.0, 1.0, SAMPLES), space.targets.limits.gel_compression
    for kind in dict.fromkeys(pad.shape.name for pad in pads):
        rows = np.array([n for n, pad in enumerate(pads) if pad.shape.name == kind])
        own = [pads[n] for n in rows]
        thickness = np.array([pad.thickness_mm for pad in own])
        if isinstance(own[0].cast, FamilyLaw):
            lengths = [dict(pad.shape.parameters) for pad in own]
            parameters = {name: np.array([one[name] for one in lengths]) for name in lengths[0]}
            designs, family = Designs(kind, thickness, parameters), own[0].cast.family
            limit[rows] = np.minimum(family.limit_mm(designs, space.radius_mm), gel * designs.gel_mm)
            area[rows] = family.area_mm2(designs, limit[rows, None] * share, space.radius_mm)
        else:
            for n, pad in zip(rows, own):
                one = make_curves(pad.cast, [pad.thickness_mm], space.radius_mm, gel)
                grid = one.limit_mm[0] * share
                limit[n], area[n] = one.limit_mm[0], one.area_at(np.array([0]), grid[None])[0]
    return SlabCurves(np.array([pad.thickness_mm for pad in pads]), limit, area)


def _leading(sieved: Sequence[_Sieved], space: SearchSpace) -> list[_Sieved]:
    """The pads that can win by a few unlike batches, and the best of each kind."""
    batches = unlike(Batches.of(space.castings.batches, space.ratio, MANY_BATCHES), FEW_BATCHES)
    curves = _curves(sieved, space)
    centre = _centres([pad.match for pad in sieved], curves, space)
    windows = windows_of(curves, centre, batches, space.targets, space.sampling.coarse, FEW_NODES)
    # how much of a usual scatter of making a window holds at best, batch by batch
    held = smoothed(windows.usable, windows.log_young[0], USUAL_SCATTER).max(axis=-1)
    score = held.mean(axis=-1)
    beyond = np.nan_to_num(windows.beyond_usable.min(axis=-1), posinf=1e3).mean(axis=-1)
    order = sorted(
        range(len(sieved)),
        key=lambda n: (-round(float(score[n]), 2), round(float(beyond[n]), 2), sieved[n].match.spread),
    )
    firsts = [
        next(n for n in order if sieved[n].shape.name == kind)
        for kind in dict.fromkeys(pad.shape.name for pad in sieved)
    ]
    return [sieved[n] for n in dict.fromkeys([*order[:LEADING], *firsts])]


def _centres(matches: Sequence[Match], curves: SlabCurves, space: SearchSpace) -> NDArray:
    """Moduli about which windows are sought: the best match, or where that is far too soft what carries the forces.

    [ln MPa]
    """
    matched = np.array([match.log_young for match in matches])
    if space.targets.strict:  # over-reading has no limit there: a stiffer pad may read hundreds of times too high
        return matched
    carries = np.log(max(space.targets.protocol.forces_N) / curves.area_mm2[:, -1])
    return np.where(carries > matched + REACH - MARGIN, carries, matched)


def _assessed(pads: Sequence[_Sieved], space: SearchSpace, faults: dict[str, DummydesignError]) -> list[ShapedDesign]:
    """Pads with their outlook over many batches; those that no ratio carries to the middle force fall away.

    So do those that cannot be made; ``faults`` keeps the first one's error of each kind.
    """
    made = []
    for pad in pads:
        try:
            outlook = outlook_for(pad.cast, pad.shape, pad.thickness_mm, pad.match, space, MANY_BATCHES)
            made.append(feasible(ShapedDesign(**vars(pad), outlook=outlook), space))
        except (InputError, NoAnswerError) as problem:
            faults.setdefault(pad.shape.name, problem)
    return made


def feasible(design: ShapedDesign, space: SearchSpace) -> ShapedDesign:
    """The design, which reaches the middle force of the test within its depth limit at the ratio to pour.

    Raises
    ------
    NoAnswerError
        For one that does not.
    """
    curves = make_curves(design.cast, [design.thickness_mm], space.radius_mm, space.targets.limits.gel_compression)
    needed_N = space.targets.protocol.needed_N
    if space.resin.young_MPa(design.outlook.ratio) * curves.area_mm2[0, -1] >= needed_N:
        return design
    message = f"no {design.shape.name} pad reaches {needed_N:g} N with {space.resin.name}"
    raise NoAnswerError("no_feasible_design", message, quantity="pad")


def outlook_for(
    law: ForceLaw, shape: PadShape, thickness_mm: float, match: Match, space: SearchSpace, count: int
) -> Outlook:
    """Outlook of one pad over the first batches of the castings, by the ratios at which it can be mixed."""
    able = mixable(shape, space.resin, space.ratio)
    if able.any():  # else the mould says why there is none
        space = replace(space, ratio=space.ratio[able])
    targets, sampling, gel = space.targets, space.sampling.coarse, space.targets.limits.gel_compression
    batches = Batches.of(space.castings.batches, space.ratio, count)
    centre = Batches.of(space.castings.central, space.ratio, 1)
    ratio = _matched_ratio(match, space)
    tolerances = space.tolerances(shape, thickness_mm, ratio)
    nodes = thickness_mm + tolerances.thickness_mm * np.array(TOLERANCE_NODES)
    smallest, largest = law.ratio_range
    nodes = np.clip(nodes, space.radius_mm / largest, space.radius_mm / smallest)
    curves = make_curves(law, nodes, space.radius_mm, gel)
    middle = _centres([match], curves.take(np.array([1])), space)
    pad = make_slabs(curves, np.array([1]), space.resin, np.array([ratio]))
    strain = finite_strain_of(pad, shape, space.base, targets, space.radius_mm), DEVIATES
    around = windows_of(curves, np.repeat(middle, len(nodes)), centre, targets, sampling, 2 * MANY_NODES, *strain)
    windows = windows_of(curves.take(np.array([1])), middle, batches, targets, sampling, MANY_NODES, *strain)
    error = relative_error_of(law, curves.limit_mm[1], thickness_mm, space.radius_mm)
    weighing = space.castings.weighing_spread(ratio, tolerances)
    crown = 0.0
    if tolerances.crown is not None:
        pressed = np.minimum(targets.aim_depth_mm(targets.protocol.misfit_N[::SIEVE_STEP]), 0.98 * curves.limit_mm[1])
        crowns = space.castings.crowns(tolerances.crown).take(slice(CROWNS))
        crown = crown_scatter(law, crowns, thickness_mm, pressed, space.radius_mm)
    scatter = Scatter(
        float(np.hypot(np.hypot(weighing, error / HALF_WIDTH), crown)),
        float(np.hypot(weighing, space.puck_error)),
        _shifts(around.usable[: len(nodes), 0], around.log_young[0]),
    )
    limits, strict = targets.limits, targets.strict
    return outlook_of(windows, around.take(slice(1, None, len(nodes))), batches, centre, match, scatter, limits, strict)


def relative_error_of(law: ForceLaw, deepest_mm: float, thickness_mm: float, radius_mm: float) -> float:
    """Largest stated error of a force law down to a depth."""
    depth = deepest_mm * np.linspace(0.1, 1.0, 10)
    return float(np.max(law.relative_error(depth, thickness_mm, radius_mm)))


def _shifts(usable: NDArray, grid: NDArray) -> NDArray:
    """By how much windows (k, F) of pads of other thickness lie off the middle one, in ln E; none without windows."""
    if not usable.any(axis=-1).all():
        return np.zeros(1)
    ends = np.array([(grid[row].min(), grid[row].max()) for row in usable])
    return np.asarray((ends - ends[len(ends) // 2]).mean(axis=-1))


def candidate_of(law: ForceLaw, thickness_mm: float, ratio: float, space: SearchSpace) -> DesignCandidate:
    """One pad of one ratio, pressed on the fine grid."""
    curves = make_curves(law, np.array([thickness_mm]), space.radius_mm, space.targets.limits.gel_compression)
    slabs: PadBatch = make_slabs(curves, np.array([0]), space.resin, np.array([ratio]))
    return exact_candidates(slabs, np.array([ratio]), space)[0]


def fitted_candidates(pads: Iterable[tuple[ForceLaw, float, float]], space: SearchSpace) -> tuple[DesignCandidate, ...]:
    """Pads of given laws, thicknesses and ratios, each pressed alone and with the tissue's law fitted."""
    return with_parameters([candidate_of(*one, space) for one in pads], space)
