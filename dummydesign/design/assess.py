"""Fourth step of a suggestion: recipe, pour yield, what the answer is based on, and what a user must know."""

from __future__ import annotations

from dummydesign.design.assessment.castings import PadCastings
from dummydesign.design.assessment.choice import explain
from dummydesign.design.assessment.measure_first import measure_first
from dummydesign.design.assessment.pour_yield import pour_yield
from dummydesign.design.assessment.readings import verdict_of_design
from dummydesign.design.assessment.warnings import design_warnings, rests_on
from dummydesign.design.calibrated import calibration_dict
from dummydesign.design.inputs import Inputs
from dummydesign.design.mould import pour_batch, pour_recipe, tolerances_of
from dummydesign.design.own_test.checks import beyond_people, own_warnings
from dummydesign.design.search.best_of_kinds import Chosen
from dummydesign.design.search.shape_family import ShapeLaw
from dummydesign.design.search.slabs import Candidate
from dummydesign.design.solve import Solved
from dummydesign.design.suggestion import Design, Suggestion
from dummydesign.geometry.shapes import PadShape


def assess(inputs: Inputs, solved: Solved) -> Suggestion:
    """Judge the chosen design and lay the whole answer together.

    Parameters
    ----------
    inputs : Inputs
    solved : Solved
        The chosen design with its verification.
    """
    request, space, chosen = inputs.request, inputs.space, solved.chosen
    best = chosen.found.best
    recommended = _design(inputs, best, chosen.shape)
    tolerances = tolerances_of(space.resin, best, request, chosen.shape)
    cast = PadCastings(inputs.castings, chosen.cast, best, space, tolerances)
    pour = pour_yield(cast)
    own = own_warnings(request, inputs.punch, inputs.tissue, chosen.shape.plain)
    warnings = design_warnings(
        chosen, space, inputs.tissue, pour, solved.verification, solved.centring, request.verify, own
    )
    calibrated = inputs.calibrated
    warnings += [] if calibrated is None else list(calibrated.warnings)
    return Suggestion(
        request=request,
        tissue=inputs.tissue,
        resin=space.resin,
        targets=space.targets,
        found=chosen.found,
        verdict=verdict_of_design(cast, beyond_people(request, inputs.tissue)),
        castings=cast,
        recommended=recommended,
        alternatives=tuple(
            _design(inputs, other, _shape_at(chosen, other)) for other in chosen.found.alternatives
        ),
        law=chosen.law,
        cast=chosen.cast,
        beside=chosen.beside,
        pour=pour,
        verification=solved.verification,
        centring=solved.centring,
        sites=solved.sites,
        rests_on=rests_on(space.resin, inputs.tissue, best),
        warnings=tuple(warnings),
        punch=inputs.punch,
        choice=explain(cast, chosen.shape.name, chosen.beside),
        expectation=solved.expectation,
        measure_first=measure_first(cast),
        calibration=None if calibrated is None else calibration_dict(calibrated.calibration, str(request.calibration)),
    )


def _shape_at(chosen: Chosen, other: Candidate) -> PadShape:
    """Shape of an alternative: the best design's, in proportion to the thickness."""
    if other is chosen.found.best or not isinstance(chosen.law, ShapeLaw):
        return chosen.shape
    return chosen.law.shape_at(other.thickness_mm)


def _design(inputs: Inputs, candidate: Candidate, shape: PadShape) -> Design:
    made = inputs.space.resin, candidate, inputs.request, shape
    return Design(candidate, shape, pour_recipe(*made), pour_batch(*made))
