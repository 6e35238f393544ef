"""Measured points update the law: the closed form, narrow near the points, honest in conflict."""

import dataclasses

import numpy as np
import pytest

from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.modulus_laws import LAWS
from dummydesign.resin.model.resin import Point
from dummydesign.resin.update import update_resin
from tests.support.refusal import raises_code


@pytest.fixture(scope="module")
def polyurethane():
    return load_resin()


def point(ratio, young_kPa, relative_sd):
    spread = np.exp(HALF_WIDTH * relative_sd)
    q = Quantity(young_kPa, young_kPa / spread, young_kPa * spread, "measured", "test")
    return Point(ratio, q)


def log_width(resin, ratio):
    young = resin.modulus_kPa(ratio)
    return np.log(young.high / young.low)


def test_a_conjugate_case_has_the_posterior_of_the_closed_form(polyurethane):
    """With one log-normal scale and a fixed exponent the posterior of ln E is normal."""
    prior_sd, sd = 0.4, 0.15
    spread = np.exp(HALF_WIDTH * prior_sd)
    resin = dataclasses.replace(
        polyurethane,
        ratio_min=0.0,
        ratio_max=100.0,
        law=LAWS["polymer_fraction"],
        numbers={
            "young_neat_kPa": Quantity(60.0, 60.0 / spread, 60.0 * spread, "measured", "test"),
            "exponent": Quantity(3.0, 3.0, 3.0, "measured", "test"),
        },
    )
    points = [point(25.0, 40.0, sd), point(50.0, 20.0, sd)]
    data = np.log([40.0 * 1.25**3, 20.0 * 1.5**3])
    precision = 1 / prior_sd**2 + 2 / sd**2
    mean = (np.log(60.0) / prior_sd**2 + data.sum() / sd**2) / precision
    drawn = np.log(update_resin(resin, points, "u").posterior["young_neat_kPa"])
    assert drawn.mean() == pytest.approx(mean, abs=4 * precision**-0.5 / 20)  # 400 chains
    assert drawn.std() == pytest.approx(precision**-0.5, rel=4.0 / np.sqrt(2 * 400))


@pytest.mark.slow
def test_points_recover_a_law_they_were_made_from(polyurethane):
    truth = {"young_ref_kPa": 34.0, "ratio_ref": 15.0, "gel_ratio_over_ref": 0.84, "exponent": 2.2}
    ratios = np.array([14.2, 15.0, 16.0, 18.0, 19.5])
    exact = LAWS["gel_point"].young_kPa(ratios, truth)
    noisy = exact * np.exp(0.03 * np.random.default_rng(4).standard_normal(len(ratios)))
    resin = update_resin(polyurethane, [point(r, e, 0.03) for r, e in zip(ratios, noisy)], "u")
    between = np.linspace(14.2, 19.5, 12)
    for ratio, young in zip(between, LAWS["gel_point"].young_kPa(between, truth)):
        found = resin.modulus_kPa(float(ratio))
        assert found.low * 0.97 <= young <= found.high * 1.03
    assert not resin.contradictions


def test_the_interval_narrows_near_the_point_and_stays_wide_away(polyurethane):
    resin = update_resin(polyurethane, [point(15.0, 28.0, 0.03)], "u")
    assert log_width(resin, 15.0) < 0.2 * log_width(polyurethane, 15.0)
    assert log_width(resin, 20.0) > 0.5 * log_width(polyurethane, 20.0)
    assert log_width(resin, 20.0) > 4 * log_width(resin, 15.0)


def test_a_vague_point_changes_almost_nothing(polyurethane):
    resin = update_resin(polyurethane, [point(15.0, 25.0, 5.0)], "u")
    for ratio in (14.5, 15.0, 18.0):
        assert log_width(resin, ratio) == pytest.approx(log_width(polyurethane, ratio), rel=0.2)


@pytest.mark.slow
def test_points_one_after_the_other_are_points_together(polyurethane):
    first, second = point(15.0, 28.0, 0.05), point(17.0, 120.0, 0.05)
    at_once = update_resin(polyurethane, [first, second], "u")
    in_turn = update_resin(update_resin(polyurethane, [first], "u"), [second], "u")
    assert in_turn.to_dict()["modulus"] == at_once.to_dict()["modulus"]


@pytest.mark.slow
def test_points_that_fall_where_the_law_grows_are_said(polyurethane):
    resin = update_resin(polyurethane, [point(15.0, 50.0, 0.03), point(16.0, 35.0, 0.03)], "u")
    assert any("must grow" in text for text in resin.contradictions)
    assert any("widened" in text for text in resin.contradictions)
    # not averaged away: the interval is far wider than either point claims
    assert log_width(resin, 15.5) > 3 * 2 * HALF_WIDTH * 0.03 / np.sqrt(2)


@pytest.mark.slow
def test_two_different_values_at_one_ratio_are_said(polyurethane):
    resin = update_resin(polyurethane, [point(15.0, 22.0, 0.02), point(15.0, 30.0, 0.02)], "u")
    assert any("differ by more" in text for text in resin.contradictions)
    young = resin.modulus_kPa(15.0)
    assert young.low < 24.5 and young.high > 27.0


@pytest.mark.slow
def test_a_point_far_from_the_prior_is_said(polyurethane):
    resin = update_resin(polyurethane, [point(15.0, 140.0, 0.03)], "u")
    assert any("young_ref_kPa" in text for text in resin.contradictions)


@pytest.mark.slow
def test_agreeing_points_are_not_called_contradictory(polyurethane):
    """5 honest sets of noise; a false alarm has a chance of a few per cent each."""
    rng = np.random.default_rng(11)
    alarms = 0
    for _ in range(5):
        points = [
            point(r, 1e3 * polyurethane.young_MPa(r) * np.exp(0.05 * rng.standard_normal()), 0.05)
            for r in (14.5, 15.5, 17.0)
        ]
        alarms += bool(update_resin(polyurethane, points, "u").contradictions)
    assert alarms <= 1


def test_no_points_are_refused(polyurethane):
    with raises_code("missing", "point"):
        update_resin(polyurethane, [], "u")
