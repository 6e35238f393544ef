"""From a tissue and an aim to ratio, thickness, recipe and reasons: search, solve, cast, judge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import NoAnswerError, accepts
from dummydesign.core.levels import LEVELS
from dummydesign.core.progress import Progress, quiet
from dummydesign.design.assessment.budget import budget_of_castings
from dummydesign.design.assessment.curves import match_of_design
from dummydesign.design.assessment.decision import compare_kinds, explain
from dummydesign.design.assessment.pad_castings import pour_yield, shares_of_pad
from dummydesign.design.assessment.warnings import count_unmeasured, design_warnings
from dummydesign.design.pad_evaluator import judged
from dummydesign.design.problem import Problem, read_problem
from dummydesign.design.request import NAGOYA_PROTOCOL, Request
from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.design.scoring.targets import people_warnings
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.search.shape_search import (
    ShapedDesign,
    rank,
    search_shapes,
)
from dummydesign.design.search.slabs import ALTERNATIVES, DesignCandidate, ScoreMap, search
from dummydesign.design.suggestion import CentringTolerance, Suggestion, Verification
from dummydesign.design.test_conditions import own_warnings, pad_of_request, refused_kinds
from dummydesign.geometry.dimensions import PAD_EXTENT_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.square import circle_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dummydesign.design.crown_array import Sites
    from dummydesign.design.search.fe_candidates import ElementsLaw
    from dummydesign.pad.axisymmetric.shaped_problem import Touch

CALIBRATED = "designed with a calibration: the correction is based on the campaign, the table on finite elements"

# Thicknesses beside the recommended one whose ratios are scored with it, in steps of the search.
AROUND_STEPS = 2


def _neighbours(
    problem: Problem, chosen: ShapedDesign, best: DesignCandidate
) -> tuple[list[DesignCandidate], ScoreMap]:
    """Alternatives of other thickness or ratio about a design, and the map of scores."""
    around, law = problem.thickness_mm, chosen.law
    if isinstance(law, FamilyLaw):
        near = around[np.abs(around - chosen.thickness_mm) <= AROUND_STEPS * 0.5 + 1e-9]
        known = np.asarray(law.depth_limit_mm(near, problem.radius_mm)) > 0.0
        pads = law.family.at_thickness(chosen.shape, chosen.thickness_mm, near)
        able = known & pads.castable(problem.pad_mm, problem.least_film_mm)
        around = near[able] if able.any() else np.array([chosen.thickness_mm])
    first, alternatives, score_map = search(law, replace(problem, thickness_mm=around))
    others = [
        replace(one, shape=law.shape_at(one.thickness_mm) if isinstance(law, FamilyLaw) else chosen.shape)
        for one in (first, *alternatives)
        if abs(one.thickness_mm - best.thickness_mm) > 1e-9 or abs(one.ratio - best.ratio) > 1e-9
    ]
    return [one for one in others if accepts(problem.mould, one)][:ALTERNATIVES], score_map


def _verify(chosen: ShapedDesign, best: DesignCandidate, problem: Problem) -> Verification:
    """Solve the depths of the slow conditions by finite elements; the fast ones differ by micrometres.

    Compared are the forces of the circle of the punch's area, which is what is solved. A design with a shape has
    been worked out on its elements already; what the table was off is reported.
    """
    from dummydesign.design.search.fe_candidates import ElementsLaw

    young, thickness, radius = problem.resin.young_MPa(best.ratio), best.thickness_mm, problem.radius_mm
    if isinstance(chosen.cast, ElementsLaw):
        return of_shape(chosen.cast, young, radius)
    if chosen.shape != Slab():
        text = f"{chosen.shape} was designed with its response table; predict --fidelity 3d solves it in minutes"
        return not_verified(text)
    law = circle_of(chosen.cast)
    depth = best.depth_mm[: len(problem.targets.protocol.forces_N)]
    depth = depth[np.isfinite(depth)]
    gel = problem.targets.limits.gel_compression
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


def _of_kinds(designs: Sequence[ShapedDesign]) -> list[ShapedDesign]:
    """The best design of each kind, in their order."""
    first: dict[str, ShapedDesign] = {}
    for design in designs:
        first.setdefault(design.shape.name, design)
    return list(first.values())


def suggest(request: Request) -> Suggestion:
    """Find ratio, thickness and shape of a pad for a tissue, with its castings and verification."""
    return design(read_problem(request))


@one_blas_thread()
def design(problem: Problem, progress: Progress = quiet) -> Suggestion:
    """Search, solve the leading design, cast and judge, and report progress.

    Nothing is solved when the request has ``verify = False``.
    """
    request = problem.request
    progress("search")
    designs, missing = search_shapes(request.kind, problem.slab_law, problem, refused_kinds(request, problem.punch))
    if request.verify:
        from dummydesign.design.search.fe_candidates import solve_leading

        designs = solve_leading(designs, problem, missing, progress)
    chosen = designs[0]
    progress("castings")
    castings, verdict = judged(problem, chosen)
    best = castings.candidate
    alternatives, score_map = _neighbours(problem, chosen, best)
    verification, centring, sites = _solved_again(problem, chosen, best, progress)
    if sites is not None:
        chosen = replace(chosen, shape=sites.on(chosen.shape))
    other = None
    if problem.wide_mm is not None:
        progress("other moulds")
        other = other_mould(problem, chosen)
    progress("tolerance and verdict")
    pour = pour_yield(castings)
    comparisons = compare_kinds(_of_kinds(designs), missing, problem)
    solved_round = verification.fidelity == "axisymmetric" and chosen.shape.axisymmetric
    warnings = own_warnings(request, problem.punch, problem.tissue, chosen.shape.plain or solved_round)
    checks = verification, centring, request.verify
    warnings += design_warnings(chosen, best, comparisons, problem, problem.tissue, pour, *checks)
    warnings += people_warnings(problem.targets)
    listed = [{"code": code, "message": text} for code, text in warnings]
    calibrated = problem.calibrated
    return Suggestion(
        problem=problem,
        score_map=score_map,
        law=chosen.law,
        cast=chosen.cast,
        comparisons=tuple(comparisons),
        verification=verification,
        centring=centring,
        sites=sites,
        verdict=verdict,
        castings=castings,
        shares=shares_of_pad(castings),
        pour=pour,
        best=replace(best, shape=chosen.shape),
        alternatives=tuple(alternatives),
        rests_on=count_unmeasured(problem.resin, problem.tissue, best),
        warnings=(*listed, *(() if calibrated is None else calibrated.warnings)),
        choice=explain(chosen, rank([one for one in designs if one is not chosen], problem), problem),
        curves=match_of_design(best.evaluation, best.index, problem.targets),
        budget=budget_of_castings(castings),
        other_mould=other,
    )


def _solved_again(
    problem: Problem, chosen: ShapedDesign, best: DesignCandidate, progress: Progress
) -> tuple[Verification, CentringTolerance | None, Sites | None]:
    """Verification, a crown's centring tolerance and its sites; a slab with a calibration is not compared."""
    request = problem.request
    if request.calibration is not None and chosen.shape.plain:
        return not_verified(CALIBRATED), None, None
    if not request.verify:
        return not_verified("not requested"), None, None
    forces = (problem.targets.protocol.low_grid_N[1], *problem.targets.protocol.forces_N)
    touch, half = getattr(chosen.cast, "touch", None), problem.punch.half_width_mm
    centring = centring_tolerance(best, chosen.shape, problem.radius_mm, half, forces, problem.extent_mm, touch)
    sites = None
    if request.sites is not None:
        from dummydesign.design.crown_array import lay_out_sites

        progress("neighbouring sites")
        sites = lay_out_sites(chosen.shape, best, problem, problem.punch, request.sites)
        chosen = replace(chosen, shape=sites.on(chosen.shape))
    return _verify(chosen, best, problem), centring, sites


def other_mould(problem: Problem, chosen: ShapedDesign) -> dict[str, Any]:
    """What the best other mould would be worth beside the one that is kept, by the tables."""
    assert problem.wide_mm is not None
    wide = replace(problem, thickness_mm=problem.wide_mm)
    limits, strict = wide.targets.limits, wide.targets.strict
    try:
        designs, _ = search_shapes("auto", problem.slab_law, wide, refused_kinds(problem.request, problem.punch))
    except NoAnswerError:
        return {"shape": None, "text": "no other mould is better"}
    best = rank([chosen, *designs], wide)[0]
    mine, its = chosen.outlook, best.outlook
    if best is chosen or (
        its.level(limits, strict) == mine.level(limits, strict) and its.ties(mine) and mine.ties(its)
    ):
        return {"shape": None, "text": "no other mould is better"}
    poured, after = ([100.0 * getattr(one, name) for one in (its, mine)] for name in ("as_poured", "after_puck"))
    text = (
        f"another mould ({best.shape.name}, {best.thickness_mm:g} mm) would make {poured[0]:.0f} instead of "
        f"{poured[1]:.0f} % of castings usable as poured, {after[0]:.0f} instead of {after[1]:.0f} % after one puck"
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
