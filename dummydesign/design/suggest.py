"""From a tissue and an aim to ratio, thickness, recipe and reasons: read what is named, search, solve, judge."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, cast

import numpy as np

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.process import one_blas_thread
from dummydesign.design.assessment.castings import Castings, PadCastings, pour_yield, verdict_of_design
from dummydesign.design.assessment.choice import Expectation, by_expectation, explain, measure_first
from dummydesign.design.assessment.warnings import count_unmeasured, design_warnings
from dummydesign.design.request import PAPER, Progress, Request, quiet
from dummydesign.design.scoring.people import people_warnings
from dummydesign.design.scoring.presses import Sampling, make_curves
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.search.best_of_kinds import SearchOutcome, Shaped, best_of_kinds, choose, close_to, kinds_of
from dummydesign.design.search.shape_family import FamilyLaw
from dummydesign.design.search.slabs import Correct, DesignCandidate, SearchSpace, thickness_steps
from dummydesign.design.suggestion import (
    CentringTolerance,
    RecommendedDesign,
    Suggestion,
    Verification,
    mould_of,
    recipe_and_batch,
    tolerances_of,
)
from dummydesign.design.test_setup import (
    beyond_people,
    check_calibrated,
    check_mould,
    check_test,
    own_slab_law,
    own_warnings,
    pad_of_request,
    refused_kinds,
    standard_press,
    tabulated,
)
from dummydesign.geometry.dimensions import PAD_EXTENT_MM, THICKNESS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import Punch, read_punch
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.tables.square import circle_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dummydesign.design.calibrated import Calibrated
    from dummydesign.design.search.finalists import ElementsLaw
    from dummydesign.design.sites import Sites
    from dummydesign.pad.axisymmetric.shaped_problem import Touch
    from dummydesign.pad.specimen import Pad
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

CALIBRATED = "designed with a calibration: the correction is based on the campaign, the table on finite elements"


@dataclass(frozen=True)
class Inputs:
    """A request with what it names."""

    request: Request
    tissue: Tissue
    space: SearchSpace
    slab_law: ForceLaw
    punch: Punch
    castings: Castings
    calibrated: Calibrated | None = None


def resolve(request: Request, law: ForceLaw | None = None) -> Inputs:
    """Read tissue, resin, calibration and force law, and lay out what is searched."""
    from dummydesign.resin import load_resin
    from dummydesign.tissue.model.tissue_file import load_tissue

    if request.shape.lower() != Slab.name:
        kinds_of(request.shape)
    punch = read_punch(request.punch)
    check_test(request, punch)
    tissue, resin = load_tissue(request.tissue), load_resin(request.resin)
    sampling = Sampling(hold_s=request.hold_s, deceleration_mm_s2=request.deceleration_mm_s2)
    tissue.target(request.aim)
    thickness = tabulated(thickness_steps(*(request.thickness_mm or THICKNESS_MM)), request, punch)
    ratios = _ratios(resin, request.ratio)
    targets = make_targets(tissue, request.aim, sampling, request.protocol)
    calibrated, correct = None, None
    if request.calibration is not None:
        from dummydesign.design.calibrated import CalibratedFamily, with_calibration

        if not standard_press(request):
            check_calibrated(request, punch, thickness)
        calibrated = with_calibration(resin, request.calibration, request.punch, punch.square, request.edge_radius_mm)
        resin, law = calibrated.resin, cast(ForceLaw, calibrated.law)
        correct = cast(Correct, partial(CalibratedFamily, correction=calibrated.law.correction))
    if law is None:
        law = own_slab_law(request, punch, thickness)
    castings = Castings(resin, request.castings)
    verdict_limits()
    check_mould(request, resin, float(thickness[0]), float(ratios[0]))
    space = SearchSpace(
        resin, targets, thickness, ratios, punch.radius_mm, sampling, request.pad_mm, request.base, correct,
        request.edge_radius_mm,
    )  # fmt: skip
    return Inputs(request, tissue, space, law, punch, castings, calibrated)


def _ratios(resin: Resin, wanted: tuple[float, float] | None) -> NDArray:
    """Practical ratios inside the wanted range, which must lie inside the resin's."""
    if wanted is None:
        return resin.ratios()
    resin.check_ratio(wanted)
    ratios = resin.ratios(*wanted)
    if not len(ratios):
        raise InputError(
            f"ratio range {wanted[0]:g}:{wanted[1]:g} holds no step of {resin.ratio_step:g}; "
            f"{resin.name} allows {resin.ratio_min:g} to {resin.ratio_max:g}",
            "out_of_range", "ratio", wanted, (resin.ratio_min, resin.ratio_max),
        )  # fmt: skip
    return ratios


@dataclass(frozen=True)
class SolvedDesign:
    """The chosen design, how it was chosen by expectation, its verification, a crown's centring tolerance and sites."""

    chosen: Shaped
    expectation: Expectation
    verification: Verification
    centring: CentringTolerance | None = None
    sites: Sites | None = None


def solve(inputs: Inputs, outcome: SearchOutcome, progress: Progress = quiet) -> SolvedDesign:
    """Solve the leading shaped designs, choose the best, and compare a recommended slab with its table.

    Designs that the search does not tell apart are chosen from by what is expected of their castings. Nothing is
    solved when the request has ``verify = False``; a slab with a calibration is not compared.
    """
    request, space = inputs.request, inputs.space
    if request.verify and outcome.designs:
        from dummydesign.design.search.finalists import solve_leading

        outcome = replace(outcome, designs=solve_leading(outcome.designs, space, progress))
    chosen = choose(outcome, space)
    low_share = 0.0 if outcome.asked.lower() == Slab.name else space.targets.weights.low_aim
    tolerances = tolerances_of(space.resin, chosen.result.best, request, chosen.shape)
    chosen, expected = by_expectation(close_to(chosen, outcome, space), space, inputs.castings, tolerances, low_share)
    if request.calibration is not None and chosen.shape.plain:
        return SolvedDesign(chosen, expected, not_verified(CALIBRATED))
    if not request.verify:
        return SolvedDesign(chosen, expected, not_verified("not requested"))
    best, forces = chosen.result.best, (space.targets.protocol.low_grid_N[1], *space.targets.protocol.forces_N)
    centring = centring_tolerance(
        best, chosen.shape, space.radius_mm, inputs.punch.half_width_mm, forces, space.extent_mm,
        getattr(chosen.cast, "touch", None),
    )  # fmt: skip
    verification, sites = _verify(chosen, inputs), None
    if request.sites is not None:
        from dummydesign.design.sites import lay_out_sites

        progress("neighbouring sites")
        sites = lay_out_sites(chosen.shape, best, space, inputs.punch, request.sites)
        chosen = replace(chosen, shape=sites.on(chosen.shape))
    return SolvedDesign(chosen, expected, verification, centring, sites)


def _verify(chosen: Shaped, inputs: Inputs) -> Verification:
    """Solve the depths of the slow conditions by finite elements; the fast ones differ by micrometres.

    Compared are the forces of the circle of the punch's area, which is what is solved. A design with a shape has
    been worked out on its elements already; what the table was off is reported.
    """
    from dummydesign.design.search.finalists import ElementsLaw

    best, space = chosen.result.best, inputs.space
    young, thickness, radius = space.resin.young_MPa(best.ratio), best.thickness_mm, space.radius_mm
    if isinstance(chosen.cast, ElementsLaw):
        return of_shape(chosen.cast, young, radius)
    if chosen.shape != Slab():
        text = f"{chosen.shape} was designed with its response table; predict --fidelity 3d solves it in minutes"
        return not_verified(text)
    law = circle_of(chosen.cast)
    depth = best.depth_mm[: len(space.targets.protocol.forces_N)]
    depth = depth[np.isfinite(depth)]
    depth = depth[depth <= make_curves(law, [thickness], radius).limit_mm[0]]
    forces = young * np.asarray(law.force(depth, thickness, 1.0, radius))
    return verify_design(pad_of_request(inputs.request, inputs.punch, thickness, young), depth, forces)


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
    from dummydesign.pad.elastic_force import solve_points

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
    best: DesignCandidate, shape: PadShape, radius_mm: float, half_side_mm: float,
    forces_N: tuple[float, ...] = (1.0, *PAPER.forces_N), extent_mm: float = PAD_EXTENT_MM, touch: Touch | None = None,
) -> CentringTolerance | None:  # fmt: skip
    """Solve the contact of a round crowned pad; None for flat tops, shapes that are not round, or a failed solve."""
    from dummydesign.pad.specimen import Pad

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


def assess(inputs: Inputs, solved: SolvedDesign) -> Suggestion:
    """Judge the chosen design and lay the whole answer together."""
    request, space, chosen, calibrated = inputs.request, inputs.space, solved.chosen, inputs.calibrated
    best = chosen.result.best
    tolerances = tolerances_of(space.resin, best, request, chosen.shape)
    castings = PadCastings(inputs.castings, chosen.cast, best, space, tolerances)
    pour = pour_yield(castings)
    solved_round = solved.verification.fidelity == "axisymmetric" and chosen.shape.axisymmetric
    warnings = own_warnings(request, inputs.punch, inputs.tissue, chosen.shape.plain or solved_round)
    checks = solved.verification, solved.centring, request.verify
    warnings += design_warnings(chosen, space, inputs.tissue, pour, *checks)
    warnings += people_warnings(space.targets)
    beyond = beyond_people(request.protocol.forces_N, inputs.tissue)
    listed = [{"code": code, "message": text} for code, text in warnings]
    return Suggestion(
        request=request, tissue=inputs.tissue, resin=space.resin, targets=space.targets, punch=inputs.punch,
        result=chosen.result, law=chosen.law, cast=chosen.cast, comparisons=chosen.comparisons,
        verification=solved.verification, centring=solved.centring, sites=solved.sites, expectation=solved.expectation,
        verdict=verdict_of_design(castings, beyond), castings=castings, pour=pour,
        recommended=_recommended(inputs, best, chosen.shape),
        alternatives=tuple(_recommended(inputs, one, _shape_at(chosen, one)) for one in chosen.result.alternatives),
        rests_on=count_unmeasured(space.resin, inputs.tissue, best),
        warnings=(*listed, *(() if calibrated is None else calibrated.warnings)),
        choice=explain(castings, chosen.shape.name, chosen.comparisons), measure_first=measure_first(castings),
        calibration=None if calibrated is None else calibrated.summary,
    )  # fmt: skip


def _shape_at(chosen: Shaped, other: DesignCandidate) -> PadShape:
    """Shape of an alternative: the best design's, in proportion to the thickness."""
    if other is chosen.result.best or not isinstance(chosen.law, FamilyLaw):
        return chosen.shape
    return chosen.law.shape_at(other.thickness_mm)


def _recommended(inputs: Inputs, candidate: DesignCandidate, shape: PadShape) -> RecommendedDesign:
    spec = mould_of(inputs.space.resin, candidate, inputs.request, shape)
    return RecommendedDesign(candidate, shape, *recipe_and_batch(spec))


def suggest(request: Request, law: ForceLaw | None = None) -> Suggestion:
    """Find ratio, thickness and, on request, shape of a pad for a tissue, with tolerance study and verification."""
    return design(resolve(request, law))


@one_blas_thread()
def design(inputs: Inputs, progress: Progress = quiet) -> Suggestion:
    """Run the search on resolved inputs and report progress."""
    progress("search")
    refused = refused_kinds(inputs.request, inputs.punch)
    outcome = best_of_kinds(inputs.request.kind, inputs.slab_law, inputs.space, refused)
    solved = solve(inputs, outcome, progress)
    progress("tolerance and verdict")
    return assess(inputs, solved)
