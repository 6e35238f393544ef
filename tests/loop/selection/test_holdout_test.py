"""Base and corrected model on presses left out: which are left out, and that the base is kept where it is better."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop import run
from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.fitting.fit import best_vector
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection import holdout_test, nonparametric_effect
from dummydesign.loop.selection.holdout_test import LeftOut, deepest, fastest, left_out_errors, predicts_worse
from dummydesign.loop.selection.nonparametric_effect import learn, predicted_without, refitted_squares
from dummydesign.measurement.campaign_file import read_campaign
from tests.loop.selection.test_learning import changed_fit, warmer
from tests.support import campaign_generator as generator
from tests.support.puck_presses import clean_fit


def fit_of(**columns):
    return SimpleNamespace(problem=SimpleNamespace(presses=SimpleNamespace(**columns)))


def test_the_deepest_and_the_fastest_presses_lie_beyond_the_others():
    pad = np.repeat([0, 1], 4)
    depth = np.array([1.0, 1.1, 2.0, 2.0, 4.0, 4.5, 9.0, 3.0])
    assert deepest(fit_of(pad=pad, depth_mm=depth)).tolist() == [False, False, True, True, False, False, True, False]
    speed = np.array([10.0, 10.0, 200.0, 200.0] * 2)
    assert fastest(fit_of(pad=pad, velocity_mm_s=speed)).tolist() == [False, False, True, True] * 2


def test_a_pad_must_keep_two_presses():
    pad = np.array([0, 0, 0, 1, 1, 1])
    assert not deepest(fit_of(pad=pad, depth_mm=np.array([1.0, 2.0, 2.0, 1.0, 1.0, 2.0]))).any()
    assert not fastest(fit_of(pad=pad, velocity_mm_s=np.full(6, 50.0))).any()


@pytest.mark.parametrize(("beyond", "worse"), [(0.9, False), (1.0, False), (1.2, True)])
def test_all_kinds_count_together(beyond, worse):
    same = LeftOut("other conditions", 0.1, 0.1)
    assert predicts_worse((same, LeftOut("deeper presses", 0.2, 0.2 * beyond))) is worse


def test_an_effect_that_predicts_other_pads_better_stays():
    worse = LeftOut("deeper presses", 0.2, 0.3)
    assert not predicts_worse((worse, LeftOut("other pads", 0.8, 0.2)))
    assert predicts_worse((worse, LeftOut("other pads", 0.2, 0.8)))


@pytest.mark.parametrize(
    ("by_stated_law", "held", "kept"),
    [((0.9, 0.2), False, True), ((0.2, 0.9), False, False), ((0.9, 0.2), True, False)],
)
def test_on_a_single_pad_a_named_effect_stays_that_needs_no_law_far_from_the_stated(
    by_stated_law, held, kept, monkeypatch
):
    """The deep presses alone speak for the base: by what law, says the pad without its law error."""
    models = []
    for error in by_stated_law:
        fit = fit_of(pad=np.zeros(6, int), depth_mm=np.r_[1.0, 1.0, 1.1, 2.0, 2.0, 2.1], velocity_mm_s=np.full(6, 9.0))
        fit.problem.effects = (SimpleNamespace(held=held),)
        errors = SimpleNamespace(heldout_N=None)
        models.append(SimpleNamespace(fit=fit, errors=errors, by_pad=SimpleNamespace(heldout_N=error)))
    shown = {id(models[0].fit): 0.1, id(models[1].fit): 0.2}
    monkeypatch.setattr(holdout_test, "_error_N", lambda fit, parts: shown[id(fit)])
    assert predicts_worse(left_out_errors(*models)) is not kept


def test_without_a_kind_nothing_is_compared():
    assert not predicts_worse(())


def test_presses_of_one_condition_are_left_out_one_by_one(monkeypatch):
    presses = SimpleNamespace(
        cell=np.full(3, 7), samples=np.ones((3, 2)), used=np.ones((3, 2), bool), force_N=np.arange(6.0).reshape(3, 2)
    )
    left: list[list[bool]] = []

    def nothing(found, out, shape=None):
        left.append(out.tolist())
        return np.zeros((3, 2))

    monkeypatch.setattr(nonparametric_effect, "predicted_without", nothing)
    squares = refitted_squares(fit_of(**vars(presses)))
    assert left == np.eye(3, dtype=bool).tolist() and squares == pytest.approx(np.mean(np.arange(6.0) ** 2))


def test_a_fit_without_presses_begins_with_what_the_whole_fit_knows_and_ends_as_without_it(monkeypatch):
    found, made, jacobian = clean_fit(), [], CampaignProblem._jacobian
    problem, presses = found.problem, found.problem.presses

    def counted(self, vector, forces):
        made.append(self is problem or not np.array_equal(vector, found.vector))
        return jacobian(self, vector, forces)

    monkeypatch.setattr(CampaignProblem, "_jacobian", counted)
    for out in (presses.pad == 0, np.arange(len(presses.pad)) % 3 == 1):
        known = predicted_without(found, out)
        assert all(made)
        anew = replace(problem, presses=replace(presses, bins=presses.bins.without(out)))
        vector = best_vector(anew, found.vector, found.sizes, 6)
        assert not np.array_equal(vector, found.vector)
        assert not all(made)
        np.testing.assert_array_equal(known, replace(problem).predict(vector))
        made.clear()


@pytest.fixture(scope="module")
def campaign(tmp_path_factory):
    folder = tmp_path_factory.mktemp("base_kept")
    generator.write_campaign(folder / "a", "temperature", generator.SIZES["temperature"], 402)
    return read_campaign(folder / "a")


@pytest.mark.slow
def test_where_the_corrected_model_predicts_worse_the_base_is_written(campaign, monkeypatch):
    right = close_loop(campaign)
    shown = left_out_errors(right.base, right.after)
    assert [one.kind for one in shown][:2] == ["other conditions", "deeper presses"]
    assert all(one.corrected_N < one.base_N for one in shown) and not predicts_worse(shown)
    worse = tuple(LeftOut(one.kind, one.corrected_N, one.base_N) for one in shown)
    monkeypatch.setattr(run, "left_out_errors", lambda base, after: worse)
    kept = close_loop(campaign)
    assert right.effects and not kept.effects and kept.after.fit.vector == pytest.approx(kept.base.fit.vector)
    assert kept.warnings[0]["code"] == "base_kept" and kept.verdict in ("none", "unexplained")
    made = calibration_of(kept)
    assert made.after.active == () and made.after.base == made.base.base
    # the modulus of the model that was dropped is in the interval: it explains the campaign
    low, high = made.posterior.interval("log young_kPa")
    assert low < 1e3 * right.after.fit.base.young_MPa < high
    assert "base_kept" not in [one["code"] for one in right.warnings]


def test_a_learned_curve_is_compared_on_pads_that_were_left_out():
    learnt = learn(changed_fit(warmer), ("temperature_C", "age_days"))
    presses = learnt.fit.problem.presses
    for place in np.unique(presses.pad):
        own = presses.pad == place
        forces = predicted_without(learnt.fit, own)
        left = np.where(presses.used, presses.force_N - forces, 0.0)[own]
        assert np.sqrt(np.mean(left**2)) < 0.2 * presses.force_N.max()


@pytest.mark.slow
def test_a_bump_that_only_a_law_far_worse_than_stated_explains_is_no_silence(tmp_path):
    """The force of a layer at 1.2 mm, 26 %: level, slope, curvature and waves could follow it, ten times too large."""
    generator.write_campaign(tmp_path / "a", "stiffness_bump", 2.0 * generator.UNKNOWN["stiffness_bump"], 403)
    result = close_loop(read_campaign(tmp_path / "a"))
    assert result.verdict == "unexplained" and result.remainder.reasons
