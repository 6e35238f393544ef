"""One pad against a tissue: its curve, its presses and the verdict, fast enough for a slider."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.assessment.pad_castings import PadCastings, limits_that_bind, verdict_of_design
from dummydesign.design.scoring.castings import COUNT, RESIN, Castings, Pours, Tolerances
from dummydesign.design.scoring.crowns import finite_strain_of
from dummydesign.design.scoring.press_simulation import SAMPLES, PadBatch, Sampling, SlabCurves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.targets import Targets, make_targets
from dummydesign.design.scoring.verdict import Verdict, deviations, good_share, ranges_of, shares_of, verdict
from dummydesign.design.scoring.windows import readings_along
from dummydesign.design.search.shape_family import Family, FamilyLaw, load_family
from dummydesign.design.search.shape_search import (
    ShapedDesign,
    candidate_of,
    fitted_candidates,
    outlook_for,
    search_shapes,
)
from dummydesign.design.search.slabs import DesignCandidate, SearchSpace
from dummydesign.design.test_conditions import beyond_people, refused_kinds, why_solved
from dummydesign.geometry.dimensions import PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.force_law import ForceCurve, ForceLaw

if TYPE_CHECKING:
    from dummydesign.design.problem import Problem
    from dummydesign.pad.pad_under_punch import Pad
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue


DRAWS, SEED = COUNT, 41
# Resin that is weighed in for a usual pad, so that a balance of 0.1 g gives the ratio to 0.5 %.
USUAL_BATCH_G = 150.0


def verdict_of_pad(
    pad: Pad,
    curve: ForceCurve,
    young: dict[str, float],
    tissue: Tissue,
    aim: str,
    sampling: Sampling,
    resin: tuple[Resin, float] | None = None,
) -> tuple[Verdict, DesignCandidate, Targets]:
    """Press a pad by the paper's test and judge it, with what is not known of its modulus and of the force.

    With a resin and its ratio the castings are those of the batch: modulus, relaxation and weighing of 150 g.
    """
    targets = make_targets(tissue, aim, sampling)
    gel_mm = pad.thickness_mm - pad.geometry.bone_height_mm
    thickness, limit = pad.thickness_mm, min(targets.limits.gel_compression * gel_mm, float(curve.limit_mm))
    depth = np.linspace(0.0, limit, SAMPLES)
    area = np.asarray(curve.force(depth), float) / pad.young_MPa
    area[0] = 0.0
    curves = SlabCurves(np.array([thickness]), np.array([limit]), area[None])
    tau, beta = tuple(term.tau_s for term in pad.prony), np.array([[term.beta for term in pad.prony]])
    pressed = None if resin is None else resin[0].pressed_force
    slabs = PadBatch(curves, np.array([0]), np.array([pad.young_MPa]), tau, beta, pressed)
    evaluation = evaluate(slabs, targets, sampling, exact=True)
    candidate = DesignCandidate(thickness, 0.0, 0, evaluation)
    reached = candidate.depth_mm[np.isfinite(candidate.depth_mm)]
    error = float(np.max(curve.relative_error(reached), initial=0.0)) if len(reached) else 0.0
    missing = len(reached) < evaluation.depth_mm.shape[1]
    bound = [f"depth over thickness (at most {limit / thickness:.2f})"] if missing else []

    if resin is None:
        width = float(np.hypot(0.5 * np.log(young["high"] / young["low"]), error)) / HALF_WIDTH
        drawn = np.random.default_rng(SEED).standard_normal((2, DRAWS))
        pours = [
            Pours(np.full(len(off), thickness), pad.young_MPa * np.exp(width * off), beta.repeat(len(off), 0), strain)
            for off, strain in (drawn, np.zeros((2, 1)))
        ]
    else:
        castings, tolerances = Castings(resin[0]), Tolerances(USUAL_BATCH_G, thickness_mm=0.0)
        pours = [castings.pours(thickness, resin[1], tolerances, error, group) for group in ((), RESIN)]
    strain = finite_strain_of(slabs, pad.geometry, pad.base, targets, pad.radius_mm)
    presses = targets, targets.protocol.steady_grid_N, sampling.coarse
    batches = (
        replace(slabs, slab=np.zeros(len(one.beta), int), young_MPa=one.young_MPa, beta=one.beta) for one in pours
    )
    spread, known = (
        strain.judged(readings_along(batch, *presses), one.finite_strain) for batch, one in zip(batches, pours)
    )
    judged = verdict(
        ranges_of(targets),
        candidate.readings,
        spread,
        bound,
        of="castings" if resin else "pads with a modulus in its interval",
        known=known,
        limits=targets.limits,
    )
    return judged, candidate, targets


@dataclass(frozen=True)
class EvaluatedPad:
    """One pad with its presses and its verdict at central estimates."""

    candidate: DesignCandidate
    law: ForceLaw
    verdict: Verdict


def law_of_shape(
    slab_law: ForceLaw,
    shape: PadShape,
    thickness_mm: float,
    pad_mm: tuple[float, float] = (PAD_LENGTH_MM, PAD_WIDTH_MM),
    correct: Callable[[Family], Family] | None = None,
) -> ForceLaw:
    """Elastic force of a pad of a shape: the slabs' law, or the response surface of the kind."""
    if shape.plain:
        return slab_law
    shape.check(thickness_mm, *pad_mm)
    family = load_family(shape.name)
    family.check(shape)
    if correct is not None:
        family = correct(family)
    return FamilyLaw(family, shape, thickness_mm, cast=True)


def one_pad(law: ForceLaw, space: SearchSpace, thickness_mm: float, ratio: float) -> EvaluatedPad:
    """Press one pad as the search presses its best ones, and judge it."""
    candidate = candidate_of(law, thickness_mm, ratio, space)
    bound = limits_that_bind(candidate, space.thickness_mm, space.ratio)
    judged = verdict(ranges_of(space.targets), candidate.readings, None, bound, limits=space.targets.limits)
    return EvaluatedPad(candidate, law, judged)


class NotTabulated(InputError):
    """The pad can be made, but no table holds its force: finite elements have to solve it."""

    def __init__(self, reason: str, quantity: str) -> None:
        super().__init__(f"{reason}: it is solved by finite elements, which takes minutes", "not_tabulated", quantity)
        self.reason = reason

    def __reduce__(self) -> tuple[type[NotTabulated], tuple[str, str]]:
        return type(self), (self.reason, self.quantity)


# Standard errors between a share of castings and its limit from which the level is certain; how many more are drawn.
CERTAIN, MORE, MOST_DRAWN = 3.0, 4, 19_200


def cast_pad(problem: Problem, design: ShapedDesign) -> PadCastings:
    """Draw the castings of a design at the ratio to pour, as many as make its level certain."""
    castings, limits = problem.castings, problem.targets.limits
    outlook = outlook_for(design.cast, design.shape, design.thickness_mm, design.match, problem, castings.n)
    (candidate,) = fitted_candidates([(design.cast, design.thickness_mm, outlook.ratio)], problem)
    tolerances = problem.tolerances(design.shape, design.thickness_mm, outlook.ratio)
    strain = finite_strain_of(candidate.alone, design.shape, problem.base, problem.targets, problem.radius_mm)
    cast = PadCastings(castings, design.cast, candidate, problem, tolerances, outlook, strain)
    while MORE * cast.castings.n <= MOST_DRAWN and _near_a_limit(cast, limits.share):
        cast = replace(cast, castings=replace(castings, n=MORE * cast.castings.n), first=cast.few)
    return cast


def judged(problem: Problem, design: ShapedDesign) -> tuple[PadCastings, Verdict]:
    """Draw the castings of a design and judge it by them."""
    castings = cast_pad(problem, design)
    return castings, verdict_of_design(castings, beyond_people(problem.request.protocol.forces_N, problem.tissue))


def _near_a_limit(cast: PadCastings, needed: float) -> bool:
    """Whether a share of castings that decides the level lies within three standard errors of what is needed."""
    ranges, limits = ranges_of(cast.space.targets), cast.space.targets.limits
    poured, known = (shares_of(deviations(ranges, one), limits) for one in (cast.readings(), cast.resin_known))
    decisive = [good_share(poured, ranges.strict), good_share(known, ranges.strict), poured["stands_for"]]
    error = np.sqrt(needed * (1.0 - needed) / cast.castings.n)
    return any(abs(value - needed) < CERTAIN * error for value in decisive)


@dataclass(frozen=True)
class PadEvaluator:
    """Presses pads one by one under the inputs of a search, by the tables alone, and judges them."""

    problem: Problem

    def evaluate(self, shape: PadShape, thickness_mm: float, ratio: float) -> EvaluatedPad:
        """Press one pad; refuse one that cannot be made (InputError) or that no table holds (NotTabulated)."""
        problem = self.problem
        request, punch = problem.request, problem.punch
        if refused := refused_kinds(request, punch).get(shape.name):
            raise InputError(refused, "unsupported", "shape", shape.name)
        # with a calibration slabs are pressed by their table, under a fillet too; shapes have none with a fillet
        unknown = not request.calibration or (request.edge_radius_mm and not shape.plain)
        if unknown and (why := why_solved(request, punch, thickness_mm)):
            raise NotTabulated(why, "punch")
        problem.resin.check_ratio(ratio)
        shape.check(thickness_mm, *request.pad_mm)
        try:
            law = law_of_shape(problem.slab_law, shape, thickness_mm, request.pad_mm, problem.correct)
        except InputError as reason:
            raise NotTabulated(str(reason).partition("; use --fidelity")[0], "shape") from None
        if float(law.depth_limit_mm(np.array([thickness_mm]), problem.radius_mm)[0]) <= 0.0:
            raise NotTabulated(f"the proportions of this {shape.name} pad are not in the tables", "shape")
        return one_pad(law, problem, thickness_mm, ratio)

    def with_castings(self, shape: PadShape, thickness_mm: float, ratio: float) -> Verdict:
        """Judge a pad as ``suggest`` does that may search this shape, thickness and ratio alone.

        Raises
        ------
        InputError, NoAnswerError
            Where that search has no answer.
        """
        held = replace(self.problem, thickness_mm=np.array([thickness_mm]), ratio=np.array([ratio]))
        refused = refused_kinds(held.request, held.punch)
        return judged(held, search_shapes(str(shape), held.slab_law, held, refused)[0][0])[1]
