"""Third step of a suggestion: what the tables found is solved by finite elements, and the best of it chosen."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dummydesign.design.assessment.centring import CentringTolerance, centring_tolerance
from dummydesign.design.assessment.verification import Verification, not_verified, of_shape, verify_design
from dummydesign.design.expected.expectation import Expectation, by_expectation
from dummydesign.design.finalists.resolved_by_fem import ElementsLaw, solve_leading
from dummydesign.design.inputs import Inputs
from dummydesign.design.mould import tolerances_of
from dummydesign.design.own_test.checks import standard_press
from dummydesign.design.own_test.slab_law import asked_pad
from dummydesign.design.request import Progress, quiet
from dummydesign.design.scoring.presses import make_curves
from dummydesign.design.search.best_of_kinds import Chosen, Found, choose, close_to
from dummydesign.design.sites.layout import Sites, lay_out
from dummydesign.design.sites.neighbours import Alone
from dummydesign.geometry.shapes import Slab
from dummydesign.pad.tables.punch import circle_of

CALIBRATED = "designed with a calibration: the correction is based on the campaign, the table on finite elements"


@dataclass(frozen=True)
class Solved:
    """The chosen design, how it was chosen by expectation, its verification, a crown's centring tolerance and sites."""

    chosen: Chosen
    expectation: Expectation
    verification: Verification
    centring: CentringTolerance | None = None
    sites: Sites | None = None


def solve(inputs: Inputs, found: Found, progress: Progress = quiet) -> Solved:
    """Solve the leading shaped designs, choose the best, and compare a recommended slab with its table.

    Designs that the search does not tell apart are chosen from by what is expected of their castings. Nothing is
    solved when the request has ``verify = False``; a slab with a calibration is not compared.

    Parameters
    ----------
    inputs : Inputs
    found : Found
        From :func:`dummydesign.design.search.best_of_kinds.best_of_kinds`.
    progress : callable, optional
        Is told each solve as it begins.

    Raises
    ------
    InputError
        When the sites that are asked for do not fit the pad.
    NoAnswerError
        ``no_feasible_design`` when no kind of shape has a design.
    """
    request, space = inputs.request, inputs.space
    if request.verify:
        found = replace(found, designs=solve_leading(found.designs, space, progress))
    chosen, expected = _expected(choose(found, space), found, inputs)
    if request.calibration is not None and chosen.shape.plain:
        return Solved(chosen, expected, not_verified(CALIBRATED))
    if not request.verify:
        return Solved(chosen, expected, not_verified("not asked for"))
    forces = (space.targets.protocol.low_grid_N[1], *space.targets.protocol.forces_N)
    touch = chosen.cast.touch if isinstance(chosen.cast, ElementsLaw) else None
    lands = centring_tolerance(
        chosen.found.best, chosen.shape, space.radius_mm, inputs.punch.half_width_mm, forces, space.extent_mm, touch
    )
    checked, sites = _verify(chosen, inputs), None
    if request.sites is not None:
        progress("neighbouring sites")
        sites = _sites(chosen, inputs)
        chosen = replace(chosen, shape=sites.on(chosen.shape))
    return Solved(chosen, expected, checked, lands, sites)


def _sites(chosen: Chosen, inputs: Inputs) -> Sites:
    """The grid of crowns that was asked for, checked at the deepest press."""
    best, space, punch = chosen.found.best, inputs.space, inputs.punch
    assert inputs.request.sites is not None
    depth = float(np.nanmax(best.evaluation.depth_mm[best.index]))
    alone = Alone(chosen.shape, best.thickness_mm, space.radius_mm, depth, space.extent_mm, space.base)
    reach = float(np.hypot(*punch.sides_mm)) / 2.0 if punch.sides_mm else punch.radius_mm
    return lay_out(alone, inputs.request.sites, space.pad_mm, reach)


def _expected(chosen: Chosen, found: Found, inputs: Inputs) -> tuple[Chosen, Expectation]:
    """Of the designs that the search does not tell apart the one that is expected to be worth most."""
    space, request = inputs.space, inputs.request
    low_share = 0.0 if found.asked.lower() == Slab.name else space.targets.weights.low_aim
    tolerances = tolerances_of(space.resin, chosen.found.best, request, chosen.shape)
    return by_expectation(close_to(chosen, found, space), space, inputs.castings, tolerances, low_share)


def _verify(chosen: Chosen, inputs: Inputs) -> Verification:
    """Solve the depths of the slow conditions by finite elements; the fast ones differ by micrometres.

    Compared are the forces of the circle of the punch's area, which is what is solved. A design with a shape has
    been worked out on its elements already; what the table was off is reported.
    """
    best, law, space = chosen.found.best, chosen.cast, inputs.space
    young = space.resin.young_MPa(best.ratio)
    if isinstance(law, ElementsLaw):
        return of_shape(law, young, space.radius_mm)
    if chosen.shape != Slab():
        text = f"{chosen.shape} was designed with its response table; predict --fidelity 3d solves it in minutes"
        return not_verified(text)
    law = circle_of(law)
    depth = best.evaluation.depth_mm[best.index, : len(space.targets.protocol.forces_N)]
    depth = depth[np.isfinite(depth)]
    table = make_curves(law, [best.thickness_mm], space.radius_mm)
    depth = depth[depth <= table.limit_mm[0]]
    forces = young * np.asarray(law.force(depth, best.thickness_mm, 1.0, space.radius_mm))
    own = None if standard_press(inputs.request) else asked_pad(inputs.request, inputs.punch, best.thickness_mm, young)
    return verify_design(best.thickness_mm, young, space.radius_mm, depth, forces, own)
