"""From a tissue and an aim to ratio, thickness, recipe and reasons: search, solve, cast, judge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import NoAnswerError
from dummydesign.design.assessment.budget import budget_of_castings
from dummydesign.design.assessment.curves import match_of_design
from dummydesign.design.assessment.decision import compare_kinds, explain
from dummydesign.design.assessment.pad_castings import PadCastings, pour_yield, shares_of_pad, verdict_of_design
from dummydesign.design.assessment.value_of_information import measure_first
from dummydesign.design.assessment.warnings import count_unmeasured, design_warnings
from dummydesign.design.problem import Problem, read_problem, recipe_and_batch
from dummydesign.design.request import NAGOYA_PROTOCOL, Progress, Request, quiet
from dummydesign.design.scoring.castings import Castings
from dummydesign.design.scoring.people import people_warnings
from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.design.scoring.verdict import LEVELS, deviations, good_share, ranges_of, shares_of
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.search.shape_search import (
    SearchOutcome,
    ShapedDesign,
    candidate_of,
    outlook_for,
    rank,
    search_shapes,
)
from dummydesign.design.search.slabs import ALTERNATIVES, DesignCandidate, SearchResult, search, with_parameters
from dummydesign.design.suggestion import CentringTolerance, RecommendedDesign, Suggestion, Verification
from dummydesign.design.test_conditions import beyond_people, own_warnings, pad_of_request, refused_kinds
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.tables.square import circle_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dummydesign.design.crown_array import Sites
    from dummydesign.design.search.fe_candidates import ElementsLaw
    from dummydesign.pad.axisymmetric.shaped_problem import Touch
    from dummydesign.pad.pad_under_punch import Pad

CALIBRATED = "designed with a calibration: the correction is based on the campaign, the table on finite elements"

# Standard errors between a share of castings and its limit from which the level is certain; how many more are drawn.
CERTAIN, MORE, MOST_DRAWN = 3.0, 4, 19_200
# Thicknesses beside the recommended one whose ratios are scored with it, in steps of the search.
AROUND_STEPS = 2


@dataclass(frozen=True)
class SolvedDesign:
    """The chosen design, the others ranked, its verification, a crown's centring tolerance and sites."""

    chosen: ShapedDesign
    designs: tuple[ShapedDesign, ...]
    castings: PadCastings
    result: SearchResult
    verification: Verification
    centring: CentringTolerance | None = None
    sites: Sites | None = None

    @property
    def best(self) -> DesignCandidate:
        """The chosen pad with its presses and parameters."""
        return self.result.best


def solve(problem: Problem, outcome: SearchOutcome, progress: Progress = quiet) -> SolvedDesign:
    """Solve the leading design, draw its castings, and compare a recommended slab with its table.

    Nothing is solved when the request has ``verify = False``; a slab with a calibration is not compared.
    """
    request, space, designs = problem.request, problem.space, outcome.designs
    if request.verify:
        from dummydesign.design.search.fe_candidates import solve_leading

        designs = solve_leading(designs, space, progress)
    chosen = designs[0]
    progress("castings")
    castings = cast_pad(problem, chosen)
    result = _neighbours(problem, chosen, castings.candidate)
    done = SolvedDesign(chosen, designs, castings, result, not_verified("not requested"))
    if request.calibration is not None and chosen.shape.plain:
        return replace(done, verification=not_verified(CALIBRATED))
    if not request.verify:
        return done
    best, forces = done.best, (space.targets.protocol.low_grid_N[1], *space.targets.protocol.forces_N)
    centring = centring_tolerance(
        best,
        chosen.shape,
        space.radius_mm,
        problem.punch.half_width_mm,
        forces,
        space.extent_mm,
        getattr(chosen.cast, "touch", None),
    )
    sites = None
    if request.sites is not None:
        from dummydesign.design.crown_array import lay_out_sites

        progress("neighbouring sites")
        sites = lay_out_sites(chosen.shape, best, space, problem.punch, request.sites)
        chosen = replace(chosen, shape=sites.on(chosen.shape))
    return replace(done, chosen=chosen, verification=_verify(chosen, best, problem), centring=centring, sites=sites)


def cast_pad(problem: Problem, design: ShapedDesign) -> PadCastings:
    """Draw the castings of a design at the ratio to pour, as many as make its level certain."""
    space, castings, limits = problem.space, problem.space.castings, problem.space.targets.limits
    outlook = outlook_for(design.cast, design.shape, design.thickness_mm, design.match, space, castings.n)
    (candidate,) = with_parameters([candidate_of(design.cast, design.thickness_mm, outlook.ratio, space)], space)
    tolerances = space.tolerances(design.shape, design.thickness_mm, outlook.ratio)
    cast = PadCastings(castings, design.cast, candidate, space, tolerances, outlook)
    while MORE * cast.castings.n <= MOST_DRAWN and _near_a_limit(cast, limits.share):
        cast = replace(cast, castings=Castings(castings.resin, MORE * cast.castings.n, castings.seed))
    return cast


def _near_a_limit(cast: PadCastings, needed: float) -> bool:
    """Whether a share of castings that decides the level lies within three standard errors of what is needed."""
    ranges, limits = ranges_of(cast.space.targets), cast.space.targets.limits
    poured, known = (shares_of(deviations(ranges, one), limits) for one in (cast.readings(), cast.resin_known))
    decisive = [good_share(poured, ranges.strict), good_share(known, ranges.strict), poured["stands_for"]]
    error = np.sqrt(needed * (1.0 - needed) / cast.castings.n)
    return any(abs(value - needed) < CERTAIN * error for value in decisive)


def _neighbours(problem: Problem, chosen: ShapedDesign, best: DesignCandidate) -> SearchResult:
    """The map of scores and the alternatives about a design, with the design as the best."""
    space = problem.space
    around = space.thickness_mm
    if isinstance(chosen.law, FamilyLaw):
        near = around[np.abs(around - chosen.thickness_mm) <= AROUND_STEPS * 0.5 + 1e-9]
        known = np.asarray(chosen.law.depth_limit_mm(near, space.radius_mm)) > 0.0
        pads = chosen.law.family.at_thickness(chosen.shape, chosen.thickness_mm, near)
        able = known & pads.castable(space.pad_mm, space.least_film_mm)
        around = near[able] if able.any() else np.array([chosen.thickness_mm])
    found = search(chosen.law, replace(space, thickness_mm=around))
    others = [
        one
        for one in (found.best, *found.alternatives)
        if abs(one.thickness_mm - best.thickness_mm) > 1e-9 or abs(one.ratio - best.ratio) > 1e-9
    ]
    return replace(found, best=best, alternatives=tuple(others[:ALTERNATIVES]))


def _verify(chosen: ShapedDesign, best: DesignCandidate, problem: Problem) -> Verification:
    """Solve the depths of the slow conditions by finite elements; the fast ones differ by micrometres.

    Compared are the forces of the circle of the punch's area, which is what is solved. A design with a shape has
    been worked out on its elements already; what the table was off is reported.
    """
    from dummydesign.design.search.fe_candidates import ElementsLaw

    space = problem.space
    young, thickness, radius = space.resin.young_MPa(best.ratio), best.thickness_mm, space.radius_mm
    if isinstance(chosen.cast, ElementsLaw):
        return of_shape(chosen.cast, young, radius)
    if chosen.shape != Slab():
        text = f"{chosen.shape} was designed with its response table; predict --fidelity 3d solves it in minutes"
        return not_verified(text)
    law = circle_of(chosen.cast)
    depth = best.depth_mm[: len(space.targets.protocol.forces_N)]
    depth = depth[np.isfinite(depth)]
    gel = space.targets.limits.gel_compression
    depth = depth[depth <= make_curves(law, [thickness], radius, gel).limit_mm[0]]
    forces = young * np.asarray(law.force(depth, thickness, 1.0, radius))
    return verify_design(pad_of_request(problem.request, problem.punch, thickness, young), depth, forces)


def not_verified(reason: str) -> Verification:
    """Make the record of a verification that was not made."""
    return Verification("table", None, notes=(reason,))


def of_shape(law: ElementsLaw, young_MPa: float, radius_mm: float) -> Verification:
    """The record of a shape that was designed on its own elements: what the table gave, what was solved."""
    table = np.asarray(law.table.force(law.depth_mm, law.thickness_mm, young_MPa, radius_mm), float)
    depth, force, solved = (tuple(values.tolist()) for values in (law.depth_mm, table, table * np.exp(law.log_factor)))
    notes = ("forces come from finite elements of this pad, not from stored solutions", *([law.end] if law.end else []))
    largest = float(np.max(np.abs(np.expm1(law.log_factor))))
    return Verification(law.table.shape.fidelity, 100.0 * largest, depth, force, solved, notes)


def verify_design(pad: Pad, depth_mm: ArrayLike, table_force_N: ArrayLike) -> Verification:
    """Solve the elastic curve of one slab, without the table, and compare the two."""
    from dummydesign.pad.force_source import solve_points

    order = np.argsort(np.asarray(depth_mm, float))
    depth, table = (np.asarray(values, float)[order] for values in (depth_mm, table_force_N))
    try:
        solved = solve_points(pad, depth, independent=True)
    except NoAnswerError as problem:
        return not_verified(str(problem))
    same = np.interp(solved.depth_mm, depth, table)
    difference = 100.0 * float(np.max(np.abs(solved.force_N / same - 1.0)))
    depths, expected, forces = (tuple(values.tolist()) for values in (solved.depth_mm, same, solved.force_N))
    return Verification("axisymmetric", difference, depths, expected, forces, tuple(solved.notes))


DEPTH_SHARES = np.linspace(0.05, 1.0, 12)


def centring_tolerance(
    best: DesignCandidate,
    shape: PadShape,
    radius_mm: float,
    half_side_mm: float,
    forces_N: tuple[float, ...] = (1.0, *NAGOYA_PROTOCOL.forces_N),
    extent_mm: float = PAD_EXTENT_MM,
    touch: Touch | None = None,
) -> CentringTolerance | None:
    """Solve the contact of a round crowned pad; None for flat tops, shapes that are not round, or a failed solve."""
    from dummydesign.pad.pad_under_punch import Pad

    if shape.flat_top or not shape.axisymmetric:
        return None
    slabs = best.alone
    depth = slabs.curves.depth_at(slabs.slab, np.array([forces_N]) / slabs.young_MPa[0])[0]
    if not np.isfinite(depth).any():
        return None
    try:
        if touch is None:
            from dummydesign.pad.axisymmetric.shaped_problem import contact_radius

            wanted = np.nanmax(depth) * DEPTH_SHARES
            pad = Pad(best.thickness_mm, 1.0, radius_mm, geometry=shape, extent_mm=extent_mm)
            touch = contact_radius(pad, wanted)
    except NoAnswerError:
        return None
    radius = touch.radius_at(depth)
    margin = np.maximum(half_side_mm - radius, 0.0)
    values = (tuple(float(v) if np.isfinite(v) else None for v in row) for row in (radius, margin))
    return CentringTolerance(forces_N, *values)


def assess(problem: Problem, solved: SolvedDesign, missing: dict[str, str] | None = None) -> Suggestion:
    """Judge the chosen design and lay the whole answer together."""
    request, space, chosen, best = problem.request, problem.space, solved.chosen, solved.best
    castings, designs = solved.castings, solved.designs
    pour = pour_yield(castings)
    comparisons = compare_kinds(_of_kinds(designs), missing or {}, space)
    solved_round = solved.verification.fidelity == "axisymmetric" and chosen.shape.axisymmetric
    warnings = own_warnings(request, problem.punch, problem.tissue, chosen.shape.plain or solved_round)
    checks = solved.verification, solved.centring, request.verify
    warnings += design_warnings(chosen, best, comparisons, space, problem.tissue, pour, *checks)
    warnings += people_warnings(space.targets)
    beyond = beyond_people(request.protocol.forces_N, problem.tissue)
    listed = [{"code": code, "message": text} for code, text in warnings]
    calibrated = problem.calibrated
    return Suggestion(
        problem=problem,
        result=solved.result,
        law=chosen.law,
        cast=chosen.cast,
        comparisons=tuple(comparisons),
        verification=solved.verification,
        centring=solved.centring,
        sites=solved.sites,
        verdict=verdict_of_design(castings, beyond),
        castings=castings,
        shares=shares_of_pad(castings),
        pour=pour,
        recommended=_recommended(problem, best, chosen.shape),
        alternatives=tuple(_recommended(problem, one, _shape_at(chosen, one)) for one in solved.result.alternatives),
        rests_on=count_unmeasured(space.resin, problem.tissue, best),
        warnings=(*listed, *(() if calibrated is None else calibrated.warnings)),
        choice=explain(chosen, rank([one for one in designs if one is not chosen], space), space),
        measure_first=measure_first(castings),
        curves=match_of_design(best.evaluation, best.index, space.targets),
        budget=budget_of_castings(castings),
    )


def _of_kinds(designs: Sequence[ShapedDesign]) -> list[ShapedDesign]:
    """The best design of each kind, in their order."""
    first: dict[str, ShapedDesign] = {}
    for design in designs:
        first.setdefault(design.shape.name, design)
    return list(first.values())


def _shape_at(chosen: ShapedDesign, other: DesignCandidate) -> PadShape:
    """Shape of an alternative: the best design's, in proportion to the thickness."""
    if not isinstance(chosen.law, FamilyLaw):
        return chosen.shape
    return chosen.law.shape_at(other.thickness_mm)


def _recommended(problem: Problem, candidate: DesignCandidate, shape: PadShape) -> RecommendedDesign:
    return RecommendedDesign(candidate, shape, *recipe_and_batch(problem.mould(candidate, shape)))


def suggest(request: Request) -> Suggestion:
    """Find ratio, thickness and shape of a pad for a tissue, with its castings and verification."""
    return design(read_problem(request))


@one_blas_thread()
def design(problem: Problem, progress: Progress = quiet) -> Suggestion:
    """Search, solve, cast and judge, and report progress."""
    progress("search")
    refused = refused_kinds(problem.request, problem.punch)
    outcome = search_shapes(problem.request.kind, problem.slab_law, problem.space, refused)
    solved = solve(problem, outcome, progress)
    other = None
    if problem.wide is not None:
        progress("other moulds")
        other = other_mould(problem, solved.chosen)
    progress("tolerance and verdict")
    return replace(assess(problem, solved, dict(outcome.missing)), other_mould=other)


def other_mould(problem: Problem, chosen: ShapedDesign) -> dict[str, Any]:
    """What the best other mould would be worth beside the one that is kept, by the tables."""
    assert problem.wide is not None
    limits, strict = problem.wide.targets.limits, problem.wide.targets.strict
    try:
        designs = search_shapes("auto", problem.slab_law, problem.wide, refused_kinds(problem.request, problem.punch))
    except NoAnswerError:
        return {"shape": None, "text": "no other mould is better"}
    best = rank([chosen, *designs.designs], problem.wide)[0]
    mine, its = chosen.outlook, best.outlook
    if best is chosen or (
        its.level(limits, strict) == mine.level(limits, strict) and its.ties(mine) and mine.ties(its)
    ):
        return {"shape": None, "text": "no other mould is better"}
    text = (
        f"another mould ({best.shape.name}, {best.thickness_mm:g} mm) would make {100 * its.as_poured:.0f} % of "
        f"castings usable instead of {100 * mine.as_poured:.0f} %"
    )
    return {
        "shape": str(best.shape),
        "thickness_mm": best.thickness_mm,
        "ratio": its.ratio,
        "level": LEVELS[its.level(limits, strict)],
        "as_poured": its.as_poured,
        "after_puck": its.after_puck,
        "text": text,
    }
