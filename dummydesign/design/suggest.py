"""The main job: from a tissue and an aim to ratio, thickness, recipe and reasons, step by step.

The steps hand on plain frozen objects: ``Request`` -> resolve -> ``Inputs`` -> search -> ``Found`` -> solve ->
``Solved`` -> assess -> ``Suggestion``. None calls one before it. The calls for scripts and the command line write
it (:mod:`dummydesign.api`).
"""

from __future__ import annotations

from dummydesign.core.threads import one_blas_thread
from dummydesign.design.assess import assess
from dummydesign.design.inputs import Inputs, resolve
from dummydesign.design.own_test.checks import refused_kinds
from dummydesign.design.request import Progress, Request, quiet
from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.search.best_of_kinds import best_of_kinds
from dummydesign.design.solve import solve
from dummydesign.design.suggestion import Suggestion


def suggest(request: Request, law: ForceLaw | None = None) -> Suggestion:
    """Find ratio, thickness and, if asked for, shape of a pad for a tissue, with tolerance study and verification.

    Parameters
    ----------
    request : Request
        Tissue, aim, resin and limits.
    law : ForceLaw, optional
        Elastic force of slabs; the response table of the bonded slab by default.

    Returns
    -------
    Suggestion

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    NoAnswerError
        ``no_feasible_design`` when no pad reaches 10 N steady.
    """
    return design(resolve(request, law))


@one_blas_thread()
def design(inputs: Inputs, progress: Progress = quiet) -> Suggestion:
    """The same from inputs that are already read, with word of each step as it begins; see :func:`suggest`."""
    progress("search")
    refused = refused_kinds(inputs.request, inputs.punch)
    found = best_of_kinds(inputs.request.kind, inputs.slab_law, inputs.space, refused)
    solved = solve(inputs, found, progress)
    progress("tolerance and verdict")
    return assess(inputs, solved)
