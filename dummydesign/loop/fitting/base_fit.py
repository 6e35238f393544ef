"""The base calibration of a campaign: modulus and two arms with a noise model, nothing else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import Fit, settle, start_vector
from dummydesign.loop.fitting.noise import estimate_slow_noise, first_sizes
from dummydesign.loop.fitting.problem import Problem
from dummydesign.loop.model.base_law import SetupLaw


def fit_base(
    presses: Presses, law: SetupLaw, young_MPa: float, progress: Callable[[str], None] | None = None
) -> Fit:
    """Fit modulus, two Prony arms and law error; the noise is estimated in between, twice.

    Parameters
    ----------
    presses : Presses
        The reduced trials of the campaign.
    law : SetupLaw
        Elastic force per unit modulus.
    young_MPa : float
        Where to start. [MPa]
    progress : callable, optional
        Called with a word for each step.

    Returns
    -------
    Fit
    """
    problem = Problem(presses, law)
    vector, sizes = start_vector(problem, young_MPa), first_sizes(presses, law.error_priors)
    for _ in range(2):
        if progress is not None:
            progress("base")
        found = settle(problem, vector, sizes)
        noise = estimate_slow_noise(presses, found.residual, found.slope, found.forces, found.sizes.noise)
        vector, sizes = found.vector, replace(found.sizes, noise=noise)
    return settle(problem, vector, sizes)


def same_noise(found: Fit) -> Fit:
    """Estimate the slow noise again at a fit and refit: a better model shows the noise better."""
    noise = estimate_slow_noise(
        found.problem.presses, found.residual, found.slope, found.forces, found.sizes.noise
    )
    return settle(found.problem, found.vector, replace(found.sizes, noise=noise), 2, 8)
