"""Several effects at once: found together, dropped when needless, and an honest verdict on what is left."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, Model, calibration_of
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.corrected_law import CorrectedLaw
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects import effect_named
from dummydesign.loop.fitting.base_fit import fit_base
from dummydesign.loop.fitting.fit import Problem, settle
from dummydesign.loop.judging import verdict
from dummydesign.loop.judging.search import without
from dummydesign.loop.judging.verdict import remainder
from dummydesign.loop.model.base_law import law_of
from dummydesign.loop.model.parameters import BaseParameters
from dummydesign.loop.replay import replay
from dummydesign.loop.run import close_loop
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator as generator


def stage(over=1.1, ratio=1.0, p=0.5, score=0.0):
    """A stage whose left-out error is so many noise floors of 0.03 N, with a lack of fit."""
    fit = SimpleNamespace(sizes=SimpleNamespace(floor_N=0.03), score=score)
    lack = SimpleNamespace(ratio=ratio, p=p)
    return SimpleNamespace(fit=fit, lack=lack, errors=SimpleNamespace(heldout_N=None if over is None else 0.03 * over))


@pytest.fixture
def noise_alone(monkeypatch):
    """Noise and uncertainty alone leave 1.1 noise floors."""
    monkeypatch.setattr(verdict, "expected_heldout_N", lambda fit: 1.1 * fit.sizes.floor_N)


def test_a_fit_at_the_noise_leaves_nothing_to_explain(noise_alone):
    assert remainder(stage(9.0), stage(1.4), [], []).reasons == ()
    assert remainder(stage(None), stage(None), [], []).over_floor is None


@pytest.mark.parametrize("over", [1.5, 4.0, 9.0])
def test_more_than_noise_on_left_out_conditions_is_unexplained_however_much_was_won(over, noise_alone):
    left = remainder(stage(90.0, score=1e6), stage(over), [], [])
    assert len(left.reasons) == 1 and f"{over:.2f} noise floors" in left.reasons[0]


def test_lack_of_fit_is_unexplained_however_much_of_it_was_explained(noise_alone):
    base, after = stage(30.0, ratio=100.0, p=0.001), stage(1.2, ratio=1.8, p=0.001)
    assert any("lack of fit 1.80" in reason for reason in remainder(base, after, [], []).reasons)
    assert remainder(base, stage(1.2, ratio=1.8, p=0.2), [], []).reasons == ()


def test_a_calibration_keeps_why_it_is_unexplained_and_says_so_where_it_is_used(tmp_path):
    model = Model(BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)), (), np.array([5.0]), np.zeros((3, 1)))
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    said = Calibration(model, model, "unexplained", {}, 0.03, pad, ("left-out conditions are at 5 noise floors",))
    again = read_calibration(write_calibration(said, tmp_path / "c.json"))
    assert again.unexplained_because == said.unexplained_because
    assert CorrectedLaw(again).notes == (again.caution,)
    assert "unexplained" in again.caution and "5 noise floors" in again.caution
    assert CorrectedLaw(replace(said, verdict="effect")).notes == ()


def test_an_effect_that_is_taken_out_again_leaves_the_model_without_it(campaigns):
    campaign = read_campaign(campaigns("none", 401))
    few = tuple(t for t in campaign.trials if t.thickness_mm == 15.0 and t.velocity_mm_s > 100.0)
    campaign = replace(campaign, trials=few)
    presses, law = make_presses(campaign), law_of(campaign)
    base = fit_base(presses, law, 0.03)
    offset = effect_named("contact_offset")
    problem = Problem(presses, law, (offset, effect_named("force_bias")))
    both = settle(problem, np.insert(base.vector, 5, [0.1, 0.1]), base.sizes)
    one = settle(Problem(presses, law, (offset,)), np.insert(base.vector, 5, [0.1]), base.sizes)
    reduced = without(both, effect_named("force_bias"))
    assert [effect.name for effect in reduced.problem.effects] == ["contact_offset"]
    assert reduced.score == pytest.approx(one.score, abs=0.5) and reduced.score > both.score - 0.5


@pytest.mark.slow
def test_two_effects_are_named_sized_and_leave_noise_on_other_pads(tmp_path):
    more = (("temperature", 0.008),)
    for name, held_out in (("a", False), ("b", True)):
        generator.write_campaign(tmp_path / name, "sensor_lag", 0.0004, 91002, held_out, more=more)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert result.verdict == "effect"
    assert {found.candidate.effect.name for found in result.effects} == {"sensor_lag", "temperature"}
    assert all(found.candidate.gain > found.threshold for found in result.effects)
    assert result.remainder.over_floor < 1.3 * result.remainder.expected
    predicted = replay(read_campaign(tmp_path / "b"), calibration_of(result))
    assert predicted.total_rmse_N < 2.5 * result.after.fit.sizes.floor_N < predicted.total_base_rmse_N


@pytest.mark.slow
def test_without_an_effect_nothing_is_found_and_what_is_left_is_noise(campaigns):
    result = close_loop(read_campaign(campaigns("none", 401)))
    assert result.verdict == "none" and result.remainder.over_floor < 1.3 * result.remainder.expected
