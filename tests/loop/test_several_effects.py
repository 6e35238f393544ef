"""Several effects at once: found together, dropped when needless, and an honest verdict on what is left."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.calibration import Calibration, Model, calibration_of
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.corrected_law import CorrectedLaw, Correction
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base, fit_with_noise
from dummydesign.loop.fitting.noise import repeat_scatter
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.forward_model import BaseParameters
from dummydesign.loop.run import close_loop, replay
from dummydesign.loop.selection import search, verdict
from dummydesign.loop.selection import verdict as acceptance
from dummydesign.loop.selection.cross_validation import LARGEST, expected_heldout_N
from dummydesign.loop.selection.residuals import ResidualDiagnostics
from dummydesign.loop.selection.search import without
from dummydesign.loop.selection.verdict import Needed, remainder
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator as generator
from tests.support.named_effects import effect_named

NOTHING = ResidualDiagnostics([], [])


def stage(over=1.1, ratio=1.0, p=0.5, score=0.0):
    """A stage whose left-out error is so many noise floors of 0.03 N, with a lack of fit."""
    law = SimpleNamespace(error_priors=((0.01, 0.3),) * 4)
    sizes = SimpleNamespace(floor_N=0.03, law=(0.01,) * 4)
    fit = SimpleNamespace(sizes=sizes, score=score, problem=SimpleNamespace(law=law))
    lack = SimpleNamespace(ratio=ratio, p=p)
    return SimpleNamespace(fit=fit, lack=lack, errors=SimpleNamespace(heldout_N=None if over is None else 0.03 * over))


@pytest.fixture
def noise_alone(monkeypatch):
    """Noise and uncertainty alone leave 1.1 noise floors."""
    monkeypatch.setattr(verdict, "expected_heldout_N", lambda fit: 1.1 * fit.sizes.floor_N)


def test_a_fit_at_the_noise_leaves_nothing_to_explain(noise_alone):
    assert remainder(stage(9.0), stage(1.4), NOTHING).reasons == ()
    assert remainder(stage(None), stage(None), NOTHING).over_floor is None


@pytest.mark.parametrize("over", [1.5, 4.0, 9.0])
def test_more_than_noise_on_left_out_conditions_is_unexplained_however_much_was_won(over, noise_alone):
    left = remainder(stage(90.0, score=1e6), stage(over), NOTHING)
    assert len(left.reasons) == 1 and f"{over:.2f} noise floors" in left.reasons[0]


def test_lack_of_fit_is_unexplained_however_much_of_it_was_explained(noise_alone):
    base, after = stage(30.0, ratio=100.0, p=0.001), stage(1.2, ratio=1.8, p=0.001)
    assert any("lack of fit 1.80" in reason for reason in remainder(base, after, NOTHING).reasons)
    assert remainder(base, stage(1.2, ratio=1.8, p=0.2), NOTHING).reasons == ()


def test_a_calibration_keeps_why_it_is_unexplained_and_says_so_where_it_is_used(tmp_path):
    model = Model(BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2)), (), (("", 5.0),), np.zeros((3, 1)))
    pad = {"young_kPa_expected": 25.0, "resin": None, "ratio": 15.0, "base": "bonded", "shape": "slab"}
    said = Calibration(model, model, "unexplained", {}, 0.03, pad, ("left-out conditions are at 5 noise floors",))
    again = read_calibration(write_calibration(said, tmp_path / "c.json"))
    assert again.unexplained_because == said.unexplained_because
    assert CorrectedLaw(Correction(again)).notes == (again.caution,)
    assert "unexplained" in again.caution and "5 noise floors" in again.caution
    assert CorrectedLaw(Correction(replace(said, verdict="effect"))).notes == ()


def test_an_effect_that_is_taken_out_again_leaves_the_model_without_it(campaigns):
    campaign = read_campaign(campaigns("none", 401))
    few = tuple(t for t in campaign.trials if t.thickness_mm == 15.0 and t.velocity_mm_s > 100.0)
    campaign = replace(campaign, trials=few)
    presses, law = make_presses(campaign), law_of(campaign)
    base = fit_base(presses, law, 0.03)
    offset = effect_named("contact_offset")
    problem = CampaignProblem(presses, law, (offset, effect_named("force_bias")))
    both = fit_with_noise(problem, np.insert(base.vector, 5, [0.1, 0.1]), base.sizes)
    one = fit_with_noise(CampaignProblem(presses, law, (offset,)), np.insert(base.vector, 5, [0.1]), base.sizes)
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


def one(name, gain, bound=False):
    """A candidate with one effect, as the beam sees it."""
    effect = effect_named(name)
    size = effect.parameters[0]
    active = (SimpleNamespace(effect=effect, values={size.name: size.high if bound else size.typical}),)
    fit = SimpleNamespace(problem=SimpleNamespace(effects=(effect,)), active=active)
    return SimpleNamespace(effect=effect, fit=fit, gain=gain)


def test_rivals_of_one_effect_are_carried_on_and_those_far_behind_or_at_their_bound_are_not():
    ranking = [one("sensor_lag", 1e3), one("time_skew", 900.0, bound=True), one("inertia", 600.0), one("ageing", 90.0)]
    assert [c.effect.name for c in search._beam(ranking, 0.0, 1)] == ["sensor_lag", "inertia"]
    # beside what three effects gained together all of them are near
    assert len(search._beam(ranking, 20000.0, 4)) == search.WIDTH


@pytest.mark.parametrize(
    ("cosine", "share", "stands_in"),
    [(0.99, 0.002, True), (0.99, 0.01, False), (0.5, 0.002, False), (-0.99, 0.002, True)],
)
def test_what_looks_the_same_may_fall_short_by_a_share_of_the_evidence_and_still_be_the_cause(cosine, share, stands_in):
    def candidate(gain, turned):
        signature = np.array([turned, np.sqrt(1.0 - turned**2)])
        return SimpleNamespace(gain=gain, screened=SimpleNamespace(signature=signature))

    lag, delay = candidate(2e4, 1.0), candidate(2e4 * (1.0 - share), cosine)
    near = search._near(SimpleNamespace(options=[lag, delay]), None)
    assert near == ([delay] if stands_in else [])
    # within ten in evidence nothing needs to look the same
    assert search._near(SimpleNamespace(options=[lag, candidate(2e4 - 9.0, 0.1)]), None)


def errors_of(square):
    return SimpleNamespace(heldout_by_trial_N=np.sqrt(square) * np.ones(4))


@pytest.mark.parametrize(
    ("gain", "left", "apart", "stands"),
    [
        (49.0, 0.1, 60.0, False),
        (51.0, 0.5, 0.0, True),
        (51.0, 0.9, 0.0, False),
        (51.0, 0.9, 51.0, True),
        (51.0, 0.9, 49.0, False),
        (101.0, 0.9, 0.0, True),
        (101.0, 1.0, 0.0, True),
    ],
)
def test_an_effect_in_doubt_has_its_evidence_apart_or_lowers_the_left_out_error(gain, left, apart, stands, monkeypatch):
    monkeypatch.setattr(acceptance, "errors", lambda fit: errors_of(fit))
    monkeypatch.setattr(acceptance, "separate_evidence", lambda fit, name: apart)
    assert acceptance.worth(gain, Needed(50.0, 100.0, "ageing"), before=1.0, after=left) is stands


def test_evidence_apart_counts_only_bins_that_the_form_error_of_another_effect_does_not_reach(monkeypatch):
    """A large bias on the first half of the bins, an offset on all of them, noise 1."""
    effects = (effect_named("force_bias"), effect_named("contact_offset"))
    bins, size = 100, 3.0
    jacobian = np.zeros((1, bins, 7))
    jacobian[0, :50, 5], jacobian[0, :, 6] = 1.0, 1.0
    vector = np.r_[np.zeros(5), 100.0, size]

    class Problem(CampaignProblem):
        centre = np.zeros(7)

        def predict(self, at):
            return jacobian @ at

    problem = Problem(SimpleNamespace(used=np.ones((1, bins), bool)), None, effects)
    forces = jacobian @ vector
    fit = SimpleNamespace(
        problem=problem,
        sizes=SimpleNamespace(noise=None),
        slope=None,
        whitened_jacobian=jacobian,
        vector=vector,
        forces=forces,
        residual=np.zeros((1, bins)),
        whitener=lambda values: values,
    )
    monkeypatch.setattr(verdict, "make_whitener", lambda *args: lambda values: values)
    monkeypatch.setattr(verdict, "prior_precision", lambda problem, sizes: np.zeros(7))
    # fifty bins of size 3 and noise 1 are left; 100 on the others is off by up to sqrt(0.015) x 100 = 12
    assert verdict.separate_evidence(fit, "contact_offset") == pytest.approx(50 * size**2)
    # a bias whose form error is within the noise hides nothing: the bias is then known from all bins
    near = SimpleNamespace(**{**vars(fit), "vector": np.r_[np.zeros(5), 2.0, size]})
    near.forces = jacobian @ near.vector
    assert verdict.separate_evidence(near, "contact_offset") == pytest.approx(50 * size**2)
    # the offset's form error of 0.37 reaches every bin of the bias
    assert verdict.separate_evidence(fit, "force_bias") < 1e-3


def doubtful(share, monkeypatch):
    """What an effect must gain beside one of evidence 1e5 with which it shares so much of its bins."""
    effects = (effect_named("force_bias"), effect_named("contact_offset"))
    jacobian = np.zeros((1, 100, 7))
    jacobian[0, :50, 5] = 1.0
    jacobian[0, round(50 * (1.0 - share)) : round(50 * (2.0 - share)), 6] = 1.0
    problem = CampaignProblem(None, None, effects)
    sizes = SimpleNamespace(noise=None)
    fit = SimpleNamespace(problem=problem, sizes=sizes, slope=None, columns=jacobian)
    monkeypatch.setattr(verdict, "make_whitener", lambda *args: lambda values: values)
    monkeypatch.setattr(verdict, "lack_of_fit", lambda fit: SimpleNamespace(ratio=1.0))
    return verdict.needed([], fit, "contact_offset", {"force_bias": 1e5}, 20)


def test_an_effect_is_in_doubt_as_far_as_it_acts_where_a_larger_one_does(monkeypatch):
    usual = verdict.NEXT_FLOOR + 2.0 * np.log(20)
    assert doubtful(0.0, monkeypatch) == Needed(pytest.approx(usual), pytest.approx(usual), "contact_offset")
    half, whole = doubtful(0.5, monkeypatch), doubtful(1.0, monkeypatch)
    assert half.least == whole.least == pytest.approx(usual)
    assert whole.doubted == pytest.approx(verdict.IMITATED * 1e5) == 2.0 * half.doubted


def scatter_of(fit):
    """Scatter of the contact that the repeats of a fit show."""
    return repeat_scatter(fit.problem.presses, fit.residual, fit.slope, fit.forces, fit.sizes.noise)[0]


def test_what_must_be_gained_grows_with_the_models_tried(monkeypatch):
    problem, sizes = SimpleNamespace(presses=None, effects=()), SimpleNamespace(noise=None)
    fit = SimpleNamespace(problem=problem, sizes=sizes, slope=None)
    monkeypatch.setattr(verdict, "make_whitener", lambda *args: None)
    monkeypatch.setattr(verdict, "lack_of_fit", lambda fit: SimpleNamespace(ratio=1.0))
    monkeypatch.setattr(verdict, "_where", lambda fit, names: {name: np.zeros(1) for name in names})
    limits = [verdict.needed([], fit, "ageing", {"inertia": 1.0}, tried).least for tried in (1, 10, 100)]
    assert np.diff(limits) == pytest.approx([2.0 * np.log(10)] * 2)
    assert verdict.needed([], fit, "ageing", {}, 100).least == verdict.GAIN_FLOOR


@pytest.mark.slow
def test_scatter_that_a_missing_effect_makes_does_not_count_as_contact_scatter(campaigns):
    """Single trials that are shifted far are passed over by the median; all of them shifted is more than a machine."""
    presses = make_presses(read_campaign(campaigns("none", 401)))
    found = fit_base(presses, law_of(read_campaign(campaigns("none", 401))), 0.03)
    usual = scatter_of(found)
    assert 0.0039 < usual < 0.008
    few, all_shifted = found.residual.copy(), found.residual.copy()
    few[:6] += 0.1 * found.slope[:6]
    assert scatter_of(replace(found, residual=few)) < 2.5 * usual
    shift = np.random.default_rng(1).normal(0.0, 0.08, len(few))
    all_shifted += shift[:, None] * found.slope
    scattered = replace(found.sizes, noise=replace(found.sizes.noise, position_mm=0.08))
    far = replace(found, residual=all_shifted, sizes=scattered)
    assert scatter_of(far) > 0.04
    stiff = np.sqrt(np.average(found.slope**2, weights=presses.samples * presses.used))
    largest = np.hypot(expected_heldout_N(found), LARGEST[0] * stiff)
    assert expected_heldout_N(far) < largest + 0.1 * found.sizes.floor_N
