"""The design's own prediction against presses: its error, what holds, and what contradicts the declared material."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.fitting.fit import fit_base, start_vector
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.forward_model import BaseParameters, base_names
from dummydesign.loop.model.material import BasePrior
from dummydesign.loop.selection.verdict import as_designed
from tests.support import puck_presses as pucks
from tests.support.puck_presses import clean_fit

ARMS = BaseParameters(0.03, (0.03, 0.3, 3.0), (1.0, 0.35, 0.11))


def refitted(away: float, presses=None, mean=None, spread=0.1):
    """The refit of presses whose declared modulus is so many standard deviations from the true one."""
    mean = start_vector(clean_fit().problem, pucks.YOUNG_MPA)[:5] if mean is None else mean
    prior = BasePrior(mean + np.eye(len(mean))[0] * away * spread, np.full(len(mean), spread))
    return fit_base(pucks.pressed() if presses is None else presses, pucks.LAW, pucks.YOUNG_MPA, prior=prior)


def test_without_a_declared_material_nothing_is_designed():
    assert as_designed(clean_fit()) is None


def test_a_true_design_leaves_the_noise_and_holds():
    found = as_designed(refitted(0.0))
    assert found.held and not found.contradicted
    assert found.to_dict()["error"]["train_rmse_N"] == pytest.approx(pucks.NOISE_N, rel=0.1)
    assert [one.name for one in found.agreement] == base_names(2)


@pytest.mark.parametrize("away", [-5.0, 5.0])
def test_a_modulus_five_standard_deviations_off_is_contradicted_with_both_numbers(away):
    fit = refitted(away)
    found = as_designed(fit)
    (one,) = found.contradicted
    assert one.name == "young_kPa" and not found.held
    assert one.declared == pytest.approx(1e3 * pucks.YOUNG_MPA * np.exp(0.1 * away), rel=1e-6)
    assert one.refitted == pytest.approx(1e3 * pucks.YOUNG_MPA, rel=0.05)
    assert one.distance == pytest.approx(5.0, rel=0.2) and found.rmse_N > 5.0 * pucks.NOISE_N
    # what the presses say of it then stands, and the rest of the declaration with it
    prior = fit.problem.prior.released([one.name])
    assert (
        prior.spread[0] > 10.0 * fit.problem.prior.spread[0]
        and (prior.spread[1:] == fit.problem.prior.spread[1:]).all()
    )
    again = fit_base(fit.problem.presses, pucks.LAW, pucks.YOUNG_MPA, prior=prior)
    pulled, free = (abs(np.log(1e-3 * kPa / pucks.YOUNG_MPA)) for kPa in (one.refitted, 1e3 * again.base.young_MPa))
    assert free < max(pulled, 0.01)


def test_three_declared_arms_are_found_where_three_made_the_presses():
    mean = ARMS.to_logs()
    prior = BasePrior(mean, np.full(len(mean), 0.3))
    problem = CampaignProblem(pucks.planned(), pucks.LAW, prior=prior)
    forces = problem.predict(problem.centre)
    noise = np.random.default_rng(3).normal(0.0, 1e-3, forces.shape)
    made = replace(pucks.pressed(), force_N=np.where(problem.presses.used, forces + noise, 0.0))
    shifted = BasePrior(mean + 0.3 * np.array([0.5, 0.5, -0.5, -0.5, 0.5, 0.5, -0.5]), prior.spread)
    fit = fit_base(made, pucks.LAW, 0.03, prior=shifted)
    assert fit.base.young_MPa == pytest.approx(ARMS.young_MPa, rel=0.03)
    assert fit.base.beta[:2] == pytest.approx(ARMS.beta[:2], rel=0.1)
    assert np.diag(fit.covariance)[1] < 0.3**2, "the presses say more than the prior"
