"""A force law whose error has waves over depth: a term of every fit, shared by the presses of a pad."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit, fit_base, fit_with_noise, with_sizes
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.forward_model import LAW_TERMS, SMOOTH_TERMS, WAVES, WAVES_END, LawError, wave_number
from dummydesign.measurement.campaign_file import read_campaign
from tests.support.named_effects import effect_named

USUAL = 0.001


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


def pressed(edged, wave, seed):
    """Problem whose forces have an edge of 0.2 mm and waves that are sines of drawn length and phase; and the truth."""
    truth, rng = edged.vector.copy(), np.random.default_rng(seed)
    truth[edged.problem.entries["punch_edge"][0]] = effect_named("punch_edge").parameters[0].to_coordinate(0.2)
    truth[edged.problem.fixed :] = 0.0
    presses = edged.problem.presses
    share = presses.measure(np.maximum(presses.displacement_mm, 0.0)) / presses.thickness_mm[:, None]
    length, phase = rng.uniform(0.06, 0.2, len(presses.pads)), rng.uniform(0.0, 2.0 * np.pi, len(presses.pads))
    factor = np.sqrt(2.0) * wave * np.sin(2.0 * np.pi * share / length[presses.pad, None] + phase[presses.pad, None])
    forces = edged.problem.predict(truth)
    noise = rng.normal(0.0, edged.sizes.noise.white_N / np.sqrt(np.maximum(presses.samples, 1.0)))
    measured = np.where(presses.used, forces * (1.0 + factor) + noise, presses.force_N)
    return replace(edged.problem, presses=replace(presses, force_N=measured)), truth


def test_waves_are_none_at_no_depth_add_up_to_a_level_and_end_where_they_are_held():
    share = np.linspace(0.0, 1.0, 401)[None]
    single = np.eye(LAW_TERMS)[SMOOTH_TERMS:, :, None]
    waves = np.stack([LawError(one).factor(share)[0] - 1.0 for one in single])
    assert len(waves) == WAVES and not waves[:, 0].any() and waves.min() >= 0.0
    inside = share[0] > WAVES_END * WAVES**-1.5
    np.testing.assert_allclose(waves[:, inside].sum(axis=0), 1.0)
    np.testing.assert_allclose(waves[-1, share[0] >= WAVES_END], 1.0)
    heights = np.random.default_rng(0).normal(size=(LAW_TERMS, 1))
    level, slope, curve = heights[:SMOOTH_TERMS, 0]
    s = share[0] / 0.4
    wanted = (1.0 + level + slope * s + curve * s**2) * (1.0 + heights[SMOOTH_TERMS:, 0] @ waves)
    np.testing.assert_allclose(LawError(heights).factor(share)[0], wanted)


def test_sensitivities_to_the_law_are_those_of_central_differences(edged):
    vector = edged.vector + np.r_[np.zeros(edged.problem.fixed), np.full(len(edged.vector) - edged.problem.fixed, 2e-3)]
    forces = edged.problem.predict(vector)
    jacobian, step = edged.problem.spread(edged.problem.jacobian(vector, forces)), 1e-4
    for term in (0, 1, 2, 5, 9, 14):
        for entry in range(len(vector))[edged.problem.law_entries(term)]:
            ends = [edged.problem.predict(vector + sign * step * np.eye(len(vector))[entry]) for sign in (1, -1)]
            slope = (ends[0] - ends[1]) / (2.0 * step)
            # waves step their relaxation from bin to bin
            scale = 1e-3 * max(1.0, np.abs(slope).max()) if term < SMOOTH_TERMS else 0.02 * forces.max()
            np.testing.assert_allclose(jacobian[..., entry], slope, atol=scale)


def test_the_size_of_waves_is_found(edged):
    sizes = []
    for wave in (0.0, 0.003, 0.006):
        problem, truth = pressed(edged, wave, 3)
        sizes.append(fit_with_noise(problem, truth, edged.sizes, 3).sizes.law[-1])
    assert sizes[0] < 0.001 and sizes[1] == pytest.approx(0.003, rel=0.6) and sizes[2] > 1.4 * sizes[1]


def test_waves_move_the_edge_less_than_in_a_fit_that_takes_the_law_for_smooth(edged):
    at = edged.problem.entries["punch_edge"][0]
    plain, better, z = [], [], []
    for seed in range(6):
        problem, truth = pressed(edged, 2.0 * USUAL, seed)
        smooth = fit(problem, truth, replace(edged.sizes, law=(*edged.sizes.law[:-1], 1e-7)), 12)
        waved = fit(problem, truth, with_sizes(fit(problem, truth, edged.sizes, 12)).sizes, 12)
        plain.append(smooth.vector[at] - truth[at])
        better.append(waved.vector[at] - truth[at])
        z.append(better[-1] / np.sqrt(waved.covariance[at, at]))
    assert np.mean(np.square(better)) < 0.8 * np.mean(np.square(plain))
    assert np.mean(np.square(z)) < 3.0


def test_heights_of_waves_are_linear_between_knots_for_each_trial_and_no_number_stays_none():
    rng = np.random.default_rng(7)
    terms, share = rng.normal(size=(LAW_TERMS, 5)), rng.uniform(0.0, 0.8, (5, 300))
    share[0, :3] = 0.0, WAVES_END, np.nan
    knots = np.arange(WAVES + 1.0)
    wanted = [np.interp(x, knots, np.r_[0.0, own]) for x, own in zip(wave_number(share), terms[SMOOTH_TERMS:].T)]
    np.testing.assert_allclose(LawError(terms).waved(share), 1.0 + np.stack(wanted), rtol=1e-14)
