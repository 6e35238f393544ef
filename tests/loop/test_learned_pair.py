"""Learned effects of two quantities: recovered where neither alone would do, kept in their range, and their file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.loop import check_effect
from dummydesign.loop.calibration import Calibration, Model
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects.learned import FADE, Learned, SmoothChange, followed_by
from dummydesign.loop.fitting.fit import fit_base, fit_with_noise
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.forward_model import Active, BaseParameters
from dummydesign.loop.selection.nonparametric_effect import learn
from dummydesign.loop.selection.residuals import run_checks
from dummydesign.measurement.campaign_file import read_campaign
from tests.support.refusal import raises_code

SEEN = SmoothChange(("depth_mm", "since_stop_s"), ((1.0, 3.0), (0.1, 1.1, 2.1)), ((0.0, 0.1, 0.2), (0.4, 0.3, 0.2)))


def test_a_surface_is_bilinear_where_it_was_seen_and_fades_out_beyond():
    assert SEEN(np.array([1.0, 3.0, 2.0, 2.0]), np.array([1.1, 0.1, 0.1, 1.6])) == pytest.approx([0.1, 0.4, 0.2, 0.2])
    far = FADE * 2.0
    beyond = SEEN(np.array([3.0 + 0.5 * far, 3.0 + far, 3.0]), np.array([0.1, 0.1, 9.0]))
    assert beyond == pytest.approx([0.2, 0.0, 0.0])


def test_its_roughness_is_zero_for_planes_and_not_for_bends():
    rows, columns = np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij")
    made = SmoothChange(("depth_mm", "age_days"), (tuple(range(4)), tuple(range(5))), ((0.0,) * 5,) * 4)
    rough = made.roughness()
    np.testing.assert_allclose(rough @ (2.0 + rows - 3.0 * columns).ravel(), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.unique(rough @ (rows**2).ravel()), [0.0, 2.0])
    again = made.with_flat((rows - columns).ravel())
    np.testing.assert_allclose(np.array(again.values), rows - columns)


@pytest.mark.parametrize(
    "follows",
    [
        ("depth_mm", "temperature_C"),
        ("since_stop_s", "depth_share"),
        ("age_days", "force_N"),
        ("thickness_mm", "since_stop_s"),
    ],
)
def test_a_learned_pair_keeps_the_contract_of_effects(follows):
    learned = Learned(SmoothChange(follows, ((0.01, 1.0, 30.0),) * 2, ((0.1, -0.05, 0.02),) * 3))
    assert check_effect(learned) == () and followed_by(learned.name) == follows


def test_names_of_learned_effects_say_what_they_follow():
    assert followed_by("learned_depth_mm") == ("depth_mm",) and followed_by("friction_hysteresis") is None
    assert followed_by("learned_depth_mm_and_colour") is None


def test_a_learned_pair_survives_its_file_and_damage_is_refused(tmp_path):
    model = Model(
        BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)),
        (Active(Learned(SEEN), {"size": 1.0}),),
        (("", 5.0),),
        np.zeros((3, 1)),
    )
    pad = {"young_kPa_expected": 30.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    path = write_calibration(Calibration(model, model, "unexplained", {}, 0.03, pad), tmp_path / "c.json")
    assert read_calibration(path).after.active[0].effect.shape == SEEN
    for old, new in ((" 1.1,", " 0.01,"), (" 0.4,", ' "much",')):
        (tmp_path / "d.json").write_text(path.read_text().replace(old, new))
        with raises_code("malformed", "calibration"):
            read_calibration(tmp_path / "d.json")


@pytest.mark.slow
def test_a_stiffening_that_depends_on_depth_and_temperature_together_is_learned(campaigns):
    """(1 + g) on the force of a clean campaign, g = 0.12 tanh((d/h - 0.2) / 0.08) (T - mean) / 3 K."""
    campaign = read_campaign(campaigns("none", 401))
    presses, law = make_presses(campaign), law_of(campaign)
    warm = presses.history.temperature_C

    def change(share, temperature):
        return 0.12 * np.tanh((share - 0.2) / 0.08) * (temperature - warm.mean()) / 3.0

    share = np.maximum(presses.measure(presses.displacement_mm), 0.0) / presses.thickness_mm[:, None]
    force = presses.force_N * (1.0 + np.where(share > 0.0, change(share, warm[:, None]), 0.0))
    clean = fit_base(presses, law, 0.03)
    made = CampaignProblem(replace(presses, force_N=np.where(presses.used, force, 0.0)), law)
    base = fit_with_noise(made, clean.vector, clean.sizes, 2, 8)
    found = learn(base)
    assert set(found.effect.shape.follows) == {"depth_share", "temperature_C"} and found.left_out < 0.7
    at = np.linspace(0.06, 0.28, 8)[:, None], warm.mean() + np.array([-2.0, 0.0, 2.0])[None]
    order = (at[1].T, at[0].T) if found.effect.shape.follows[0] == "temperature_C" else at
    seen = found.effect.shape(*order)
    seen = seen.T if seen.shape[0] == 3 else seen
    # a factor in depth alone is shared with the law error, one in temperature alone is not
    apart = (seen - seen.mean(axis=1, keepdims=True)) - (change(*at) - change(*at).mean(axis=1, keepdims=True))
    assert np.abs(apart).max() < 0.03
    assert learn(clean) is None


@pytest.mark.slow
def test_relaxation_that_lasts_longer_in_a_thicker_pad_is_learned_and_is_no_step_in_the_hold(campaigns):
    campaign = read_campaign(campaigns("poroelastic", 418))
    presses, law = make_presses(campaign), law_of(campaign)
    base = fit_base(presses, law, 0.03)
    assert not any(check.exceeded for check in run_checks(base))
    found = learn(base)
    assert found.effect.shape.follows == ("thickness_mm", "since_stop_s") and found.left_out < 0.25
