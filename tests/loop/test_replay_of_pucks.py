"""A campaign of pucks predicted by a calibration, and presses that go deeper than their law."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, model_of
from dummydesign.loop.data.trials import stack
from dummydesign.loop.model.campaign_law import law_of, within_reach
from dummydesign.loop.model.forward_model import Active
from dummydesign.loop.model.material import material_of
from dummydesign.loop.run import replay
from dummydesign.measurement.campaign import Campaign, PadSpec, PunchSpec
from tests.support import puck_presses as pucks
from tests.support.named_effects import effect_named
from tests.support.puck_presses import clean_fit
from tests.support.refusal import raises_code


def campaign_of(trials, young_kPa=50.0):
    pad = PadSpec(young_kPa, None, 15.0, "cylinder", None, None, pucks.DIAMETER_MM, "bonded")
    return Campaign("pucks", Path("."), pad, PunchSpec("plate", None, None, "frictionless"), None, 0.0, tuple(trials))


def test_a_replay_is_the_models_readings_beside_the_samples():
    found = clean_fit()
    presses = found.problem.presses
    model = model_of(found)
    biased = replace(model, active=(Active(effect_named("force_bias"), {"bias_N": 0.5}),))
    pad = {"resin": None, "ratio": 15.0}
    calibration = Calibration(model, biased, "effect", {}, 0.1, pad)
    said = replay(campaign_of(presses.trials), calibration)
    modelled = found.problem.at_samples(found.vector)
    measured = [trial.trace.force_N for trial in presses.trials]
    plain = np.array([np.mean((a - b) ** 2) for a, b in zip(modelled, measured)])
    own = np.array([np.mean((a + 0.5 - b) ** 2) for a, b in zip(modelled, measured)])
    np.testing.assert_allclose(said.base_rmse_N, np.sqrt(plain), rtol=1e-6)
    np.testing.assert_allclose(said.rmse_N, np.sqrt(own), rtol=1e-6)
    weight = [len(one) for one in measured]
    assert said.total_rmse_N == pytest.approx(np.sqrt(np.average(own, weights=weight)), rel=1e-6)
    assert said.total_base_rmse_N == pytest.approx(np.sqrt(np.average(plain, weights=weight)), rel=1e-6)
    smooth = np.ones(5) / 5.0
    peaks = [
        np.convolve(a + 0.5, smooth, "valid").max() - np.convolve(b, smooth, "valid").max()
        for a, b in zip(modelled, measured)
    ]
    np.testing.assert_allclose(said.peak_error_N, peaks, rtol=1e-6, atol=1e-9)
    assert said.files == tuple(trial.file for trial in presses.trials) and said.left_out == "" and said.pads == ()
    rows = said.to_dict()
    assert rows["rmse_N"] == said.total_rmse_N and rows["trials"][3]["peak_error_N"] == said.peak_error_N[3]


def short(known):
    """Pucks whose law is known to a share of their height."""
    return SimpleNamespace(limit_of=lambda trials: known * np.array([trial.thickness_mm for trial in trials]))


@pytest.mark.parametrize(("known", "left"), [(0.3 / 1.019, 16), (0.3 / 1.021, 8), (0.15 / 1.019, 8)])
def test_presses_beyond_their_law_by_two_per_cent_are_left_out(known, left):
    presses = pucks.planned()
    law = short(known)
    campaign, kept, words = within_reach(campaign_of(presses.trials), presses, law)
    assert len(campaign.trials) == len(kept.trials) == left and bool(words) is (left < 16)
    if left < 16:
        assert words.startswith("8 of 16 presses are left out") and "up to 3.6 mm" in words
        assert np.all(kept.depth_mm <= 0.16 * kept.thickness_mm)


def test_too_few_presses_within_their_law_are_refused():
    trials = pucks.planned().trials
    deep = [trial for trial in trials if trial.trace.displacement_mm.max() > 0.2 * trial.thickness_mm]
    law = short(0.2)
    for flat, least, able in ((2, 2, True), (1, 2, False), (1, 1, True), (0, 1, False)):
        chosen = (*[one for one in trials if one not in deep][:flat], *deep[:2])
        presses = stack(chosen, None)
        if able:
            assert len(within_reach(campaign_of(chosen), presses, law, least)[0].trials) == flat
            continue
        with raises_code("out_of_range", "displacement_mm"):
            within_reach(campaign_of(chosen), presses, law, least)


def test_the_law_of_pucks_knows_what_is_not_known_of_their_heights_and_moduli():
    trials = pucks.planned().trials
    law = law_of(campaign_of(trials))
    depth, h = np.array([[1.0, 2.0]]), np.array([[9.0]])
    assert law.shape == "cylinder" and np.array_equal(law(depth, h), pucks.LAW(depth, h))
    assert material_of(campaign_of(trials)).young_kPa.value == 50.0
    read = [replace(trial, thickness_sd_mm=0.03 * trial.thickness_mm, young_factor_sd=0.04) for trial in trials]
    level, *rest = law_of(campaign_of(read)).error_priors
    (own, spread), *others = pucks.LAW.error_priors
    assert level == (pytest.approx(np.hypot(own, 0.05)), spread) and rest == list(others)
    with raises_code("missing", "pad.young_kPa_nominal"):
        material_of(campaign_of(trials, None))
