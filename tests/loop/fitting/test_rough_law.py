"""A force law that may be rough over depth: what it leaves in doubt, and where the fit goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects.registry import effect_named
from dummydesign.loop.fitting.fit import KNOTS, fit, fit_base, prior_precision, rough_columns, with_rough_law
from dummydesign.loop.fitting.noise import make_whitener
from dummydesign.loop.model.base_law import USUAL_ROUGHNESS
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.material import UNDECLARED
from dummydesign.measurement.campaign_file import read_campaign

BASE = len(UNDECLARED.mean)


@pytest.fixture(scope="module")
def edged(campaigns):
    """A fit of three pads with a free edge."""
    campaign = read_campaign(campaigns("none", 401))
    campaign = replace(campaign, trials=campaign.trials[::3])
    base = fit_base(make_presses(campaign), law_of(campaign), 0.03)
    edge = effect_named("punch_edge")
    problem = base.problem.plus(edge)
    vector = np.insert(base.vector, base.problem.fixed, edge.parameters[0].to_coordinate(0.2))
    return fit(problem, vector, base.sizes, 12)


def pressed(edged, wave=0.0, seed=0):
    """The fit of its own forces, edge 0.2 mm, times waves of this standard deviation; the truth and the waves."""
    truth, rng = edged.vector.copy(), np.random.default_rng(seed)
    at = edged.problem.entries["punch_edge"][0]
    truth[at] = effect_named("punch_edge").parameters[0].to_coordinate(0.2)
    truth[edged.problem.fixed :] = 0.0
    columns = rough_columns(replace(edged, forces=edged.problem.predict(truth)))
    presses = edged.problem.presses
    heights = wave / USUAL_ROUGHNESS * rng.standard_normal(columns.shape[-1])
    measured = np.where(presses.used, edged.problem.predict(truth) + columns @ heights, presses.force_N)
    problem = replace(edged.problem, presses=replace(presses, force_N=measured))
    return fit(problem, truth, edged.sizes, 12), truth, columns @ heights


def test_columns_are_hats_over_depth_of_one_pad_each(edged):
    columns, presses = rough_columns(edged), edged.problem.presses
    assert columns.shape[-1] == (KNOTS - 1) * len(presses.pads)
    assert np.all(np.abs(columns).sum(axis=-1) <= USUAL_ROUGHNESS * np.abs(edged.forces) + 1e-12)
    for column in np.moveaxis(columns, -1, 0):
        assert len({presses.trials[row].pad for row in np.nonzero(column.any(axis=1))[0]}) == 1


def test_step_and_doubt_are_those_of_least_squares_with_a_row_for_each_wave(edged):
    whiten = make_whitener(edged.problem.presses, edged.sizes.noise, edged.slope)
    count = len(edged.vector)
    jacobian = whiten(edged.jacobian).reshape(-1, count)
    waves = whiten(rough_columns(edged)).reshape(len(jacobian), -1)
    wide = np.block(
        [
            [jacobian, waves],
            [np.diag(np.sqrt(prior_precision(edged.problem, edged.sizes))), np.zeros((count, waves.shape[1]))],
            [np.zeros((waves.shape[1], count)), np.eye(waves.shape[1])],
        ]
    )
    covariance = np.linalg.inv(wide.T @ wide)
    rough = with_rough_law(edged)
    whole = (edged.covariance + rough.doubt)[: BASE + 1, : BASE + 1]
    assert whole == pytest.approx(covariance[: BASE + 1, : BASE + 1], rel=1e-5, abs=1e-9)
    # at the optimum what the residual asks of the parameters is nought: the waves alone move them
    asked = np.r_[np.zeros(count), waves.T @ whiten(edged.residual).ravel()]
    step = (covariance @ asked)[:count]
    assert rough.vector - edged.vector == pytest.approx(step, rel=1e-4, abs=1e-8)
    assert np.linalg.norm(step[: BASE + 1]) > 0.01 * np.sqrt(np.trace(whole))


def test_data_of_a_smooth_law_stay_where_they_are(edged):
    smooth, truth, _ = pressed(edged)
    rough = with_rough_law(smooth)
    assert rough.vector == pytest.approx(truth, abs=2e-4)
    assert np.linalg.eigvalsh(rough.doubt).min() > -1e-12


def test_waves_of_the_law_move_the_edge_as_the_linear_fit_says_and_less_than_without(edged):
    at = edged.problem.entries["punch_edge"][0]
    plain, better, linear = [], [], []
    for seed in range(4):
        waved, truth, waves = pressed(edged, USUAL_ROUGHNESS, seed)
        whiten = make_whitener(waved.problem.presses, waved.sizes.noise, waved.slope)
        columns = whiten(waved.jacobian).reshape(-1, len(truth))
        linear.append((waved.covariance @ (columns.T @ whiten(waves).ravel()))[at])
        rough = with_rough_law(waved)
        plain.append(waved.vector[at] - truth[at])
        better.append(rough.vector[at] - truth[at])
        assert rough.doubt[at, at] > 0.2 * waved.covariance[at, at]
    assert plain == pytest.approx(linear, rel=0.2, abs=0.02)
    assert np.mean(np.square(better)) < 0.8 * np.mean(np.square(plain))


def test_a_residual_that_no_waves_of_the_usual_size_make_leaves_the_fit_where_it_is(edged):
    for times, stays in ((1.0, False), (8.0, True)):
        waved, _, _ = pressed(edged, times * USUAL_ROUGHNESS, 1)
        rough = with_rough_law(waved)
        assert (rough.vector is waved.vector) is stays
        assert rough.doubt[0, 0] > 0.0
