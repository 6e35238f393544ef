"""What is known of a pad before it is pressed: factors of its modulus, and what they make of forces and scatter."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.loop.calibration import Model
from dummydesign.loop.calibration_file import read_calibration, write_calibration
from dummydesign.loop.data.pad_modulus_factors import CURE, PADS_DIFFER, WITNESS_SHARE, usual_of, with_pad_factors
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.forward_model import BaseParameters, simulate
from dummydesign.loop.pad_scatter import carried_share, known_pads, pad_scatter, recorded_spread
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.resin import load_resin
from tests.support import campaign_generator as generator
from tests.support.made_calibration import calibration as made_calibration

BASE = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))


@pytest.fixture
def campaign(campaigns):
    """A campaign of slabs of 5, 15 and 20 mm; nothing is known of its pads."""
    return read_campaign(campaigns("none", 401))


def witnessed(campaign, kPa, sd=0.0):
    """The campaign with witnesses by thickness [kPa], None where there is none."""
    trials = tuple(
        replace(t, witness_kPa=kPa[t.thickness_mm], witness_sd_kPa=kPa[t.thickness_mm] and sd * kPa[t.thickness_mm])
        for t in campaign.trials
    )
    return replace(campaign, trials=trials)


def factors(campaign):
    return {t.thickness_mm: (t.young_factor, t.young_factor_sd) for t in campaign.trials}


def test_a_campaign_of_pads_of_which_nothing_is_known_stays_the_same(campaign):
    assert with_pad_factors(campaign) is campaign and make_presses(campaign).young_factor is None


def test_exact_witnesses_are_the_factors_and_what_all_pucks_read_too_high_stays_out(campaign):
    kPa = {5.0: 30.0, 15.0: 33.0, 20.0: 27.0}
    found = factors(with_pad_factors(witnessed(campaign, kPa)))
    usual = np.exp(np.mean(np.log(list(kPa.values()))))
    assert usual_of(witnessed(campaign, kPa).trials)["usual_witness_kPa"] == pytest.approx(usual)
    for h, (factor, spread) in found.items():
        assert factor == pytest.approx(kPa[h] / usual, rel=1e-12) and spread == 0.0
    high = factors(with_pad_factors(witnessed(campaign, {h: 1.3 * value for h, value in kPa.items()})))
    assert {h: one[0] for h, one in high.items()} == pytest.approx({h: one[0] for h, one in found.items()})


def test_a_witness_counts_by_its_precision_and_a_pad_without_one_is_the_usual_pad(campaign):
    found = factors(with_pad_factors(witnessed(campaign, {5.0: 30.0, 15.0: 36.0, 20.0: None}, 0.1)))
    weight = PADS_DIFFER**2 / (PADS_DIFFER**2 + 0.1**2)
    assert np.log(found[15.0][0]) == pytest.approx(0.5 * weight * np.log(1.2))
    assert found[15.0][1] == pytest.approx(np.sqrt(weight) * 0.1)
    assert found[20.0] == (1.0, PADS_DIFFER)
    usual = factors(
        with_pad_factors(replace(campaign, trials=tuple(replace(t, witness_kPa=30.0) for t in campaign.trials)))
    )
    assert 0.9 * WITNESS_SHARE < usual[5.0][1] < WITNESS_SHARE, "without an error of its own it has the usual one"


def test_a_weighed_ratio_counts_as_the_resin_s_law_says_and_a_coarse_scale_tells_nothing(campaign):
    ratios = {5.0: 14.9, 15.0: 15.1, 20.0: 15.0}
    weighed = replace(
        campaign,
        pad=replace(campaign.pad, resin="polyurethane-nagoya", ratio=15.0),
        trials=tuple(replace(t, weighed_ratio=ratios[t.thickness_mm], weighed_ratio_sd=0.01) for t in campaign.trials),
    )
    found = factors(with_pad_factors(weighed))
    resin = load_resin("polyurethane-nagoya")
    expected = float(resin.young_MPa(15.1) / resin.young_MPa(14.9))
    assert found[15.0][0] / found[5.0][0] == pytest.approx(expected, rel=0.01)
    assert found[5.0][1] > CURE
    coarse = replace(weighed, trials=tuple(replace(t, weighed_ratio_sd=0.2) for t in weighed.trials))
    assert with_pad_factors(coarse) is coarse


def test_a_force_is_in_proportion_to_the_factor_of_its_pad(campaign):
    known = with_pad_factors(witnessed(campaign, {5.0: 30.0, 15.0: 33.0, 20.0: 27.0}))
    law = law_of(campaign)
    plain, own = (simulate(make_presses(one), law, BASE) for one in (campaign, known))
    factor = np.array([t.young_factor for t in known.trials])[:, None]
    np.testing.assert_allclose(own, factor * plain, rtol=1e-12)


def test_the_law_s_error_is_expected_to_hold_what_the_record_does_not_say(campaign):
    exact, rough = (
        law_of(with_pad_factors(witnessed(campaign, {5.0: 30.0, 15.0: 33.0, 20.0: 27.0}, sd))) for sd in (0.0, 0.04)
    )
    assert exact.error_priors == law_of(campaign).error_priors
    weight = PADS_DIFFER**2 / (PADS_DIFFER**2 + 0.04**2)
    expected = np.hypot(exact.error_priors[0][0], np.sqrt(weight) * 0.04)
    assert rough.error_priors[0][0] == pytest.approx(expected) and rough.error_priors[1:] == exact.error_priors[1:]


def test_a_calibration_remembers_the_pad_that_its_modulus_is_of(campaign, tmp_path):
    made = made_calibration(pad={"usual_witness_kPa": 30.0})
    again = read_calibration(write_calibration(made, tmp_path / "c.json"))
    assert again.pad["usual_witness_kPa"] == 30.0 and "usual_weighed_ratio" not in again.pad
    known = with_pad_factors(witnessed(campaign, dict.fromkeys((5.0, 15.0, 20.0), 33.0)), again.pad)
    assert all(t.young_factor == pytest.approx(1.1) for t in known.trials)
    assert known.usual_pad["usual_witness_kPa"] == 30
    assert {row["young_factor"] for row in known_pads(known.trials)} == {known.trials[0].young_factor}


def test_what_the_records_told_and_what_is_left_add_up_to_the_pads_own_factor(campaign):
    known = with_pad_factors(witnessed(campaign, {5.0: 30.0, 15.0: 33.0, 20.0: 27.0}))
    presses = make_presses(known)
    fit = SimpleNamespace(problem=SimpleNamespace(presses=presses), sizes=SimpleNamespace(law=(0.03,)))
    found = pad_scatter(fit)
    told = 100.0 * recorded_spread(presses)
    assert told == pytest.approx(100.0 * np.std(np.log([30.0, 33.0, 27.0]), ddof=1))
    assert found.size_percent == pytest.approx(np.hypot(told, 3.0)) and found.left_percent == pytest.approx(3.0)
    assert found.explained == pytest.approx(told**2 / (told**2 + 9.0)) and found.recorded == found.pads == 3
    fit.problem.presses = make_presses(campaign)
    unknown = pad_scatter(fit)
    assert unknown.explained is None and unknown.recorded == 0 and unknown.size_percent == pytest.approx(3.0)


@pytest.mark.slow
def test_records_of_pads_that_differ_leave_less_to_the_pads_than_none(tmp_path):
    """Pads of 5 % scatter with exact readings: what is left of the level is the force law's."""
    rows = [
        {
            "h": h,
            "v": v,
            "target": 4.0,
            "repeat": k,
            "sequence": n + 1,
            "rest": 60.0,
            "age": 9.0,
            "unload": False,
            "temperature": 23.0,
        }
        for n, (h, v, k) in enumerate((h, v, k) for h in (6.0, 8.0, 10.0, 14.0) for v in (10.0, 250.0) for k in (1, 2))
    ]
    levels = {}
    for recorded in (True, False):
        pads = generator.CastPads(gauge_mm=0.0, witness=0.0, recorded=recorded)
        generator.write_campaign(
            tmp_path / str(recorded), "none", 0.0, 77, rows=[dict(row) for row in rows], cast_pads=pads
        )
        made = with_pad_factors(read_campaign(tmp_path / str(recorded)))
        fit = fit_base(make_presses(made), law_of(made), 0.03)
        level = fit.vector[fit.problem.law_entries(0)]
        levels[recorded] = np.std(level, ddof=1)
    assert levels[True] < 0.012 < 0.02 < levels[False]


def test_a_level_beyond_what_the_law_can_be_off_is_the_pad_s_and_does_not_go_over_to_others(campaign):
    law = law_of(campaign)
    fit = SimpleNamespace(problem=SimpleNamespace(presses=make_presses(campaign), law=law), sizes=None)
    median, spread = law.error_priors[0]
    largest = median * np.exp(1.96 * spread)
    for level, share in ((median, 1.0), (0.99 * largest, 1.0), (2.0 * largest, 0.25), (10.0 * largest, 0.01)):
        fit.sizes = SimpleNamespace(law=(level,))
        assert carried_share(fit) == pytest.approx(share, rel=1e-3)
    widened = with_pad_factors(witnessed(campaign, {5.0: 30.0, 15.0: 33.0, 20.0: 27.0}, 0.03))
    fit.problem = SimpleNamespace(presses=make_presses(widened), law=law_of(widened))
    fit.sizes = SimpleNamespace(law=(2.0 * largest,))
    assert carried_share(fit) == pytest.approx(0.25, rel=1e-3), "what a record leaves open is not the law's"
    model = Model(BASE, (), (("", 5.0), ("", 15.0)), np.array([[0.04, 0.08], [0.1, 0.1], [0.0, 0.0]]), 0.25)
    found = model.law_error(np.array([5.0, 15.0, 20.0]))
    np.testing.assert_allclose(found.terms[0], [0.04, 0.08, 0.02])
    np.testing.assert_allclose(found.terms[1], 0.1)
    np.testing.assert_allclose(model.law_error(np.array([5.0, 15.0]), cast=True).terms[0], [0.01, 0.02])
