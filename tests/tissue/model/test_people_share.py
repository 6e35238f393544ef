"""What n subjects say of people: published factors, exact limits, coverage by simulation, aims."""

import numpy as np
import pytest
from scipy.stats import nct, norm, t

from dummydesign.tissue.model.people_share import Population, share_of_aim, tolerance_factor
from tests.support.refusal import raises_code

# ISO 16269-6:2014 and Hahn and Meeker 1991, one-sided factors with 95 % confidence
FACTORS = {
    (2, 0.95): 26.260,
    (5, 0.90): 3.407,
    (5, 0.95): 4.203,
    (5, 0.99): 5.741,
    (10, 0.95): 2.911,
    (15, 0.95): 2.566,
    (40, 0.95): 2.125,
    (100, 0.95): 1.927,
}


@pytest.mark.parametrize(("n", "share"), FACTORS)
def test_factors_are_those_of_published_tables(n, share):
    assert tolerance_factor(n, share) == pytest.approx(FACTORS[n, share], abs=6e-4)


def test_many_subjects_leave_the_quantile_of_the_population():
    assert tolerance_factor(200_000, 0.95) == pytest.approx(norm.ppf(0.95), abs=0.01)


@pytest.mark.parametrize("n", [3, 5, 15])
@pytest.mark.parametrize("deviations", [-0.5, 0.0, 1.3, 2.5])
def test_the_share_below_a_reading_is_student_t_and_its_ends_are_those_of_the_noncentral_t(n, deviations):
    logs = np.random.default_rng(n).normal(2.0, 0.1, n)
    people = Population.of(np.exp(logs))
    reading = np.exp(logs.mean() + deviations * logs.std(ddof=1))
    assert float(people.expected_below(reading)) == pytest.approx(t.cdf(deviations / np.sqrt(1 + 1 / n), n - 1))
    low, high = people.interval_below(reading)
    # the limit is the share at whose z the noncentral t of the sample has the level
    for end, level in ((low, 0.95), (high, 0.05)):
        z = norm.ppf(float(end))
        assert nct.cdf(np.sqrt(n) * deviations, n - 1, np.sqrt(n) * z) == pytest.approx(level, abs=0.006)


@pytest.mark.slow
def test_the_interval_and_the_bound_hold_as_often_as_they_say():
    """2,000 groups of five of a log-normal population; 1.96 standard errors of 95 % are 1 %."""
    rng, held = np.random.default_rng(), np.zeros(3)
    draws = 2000
    logs = rng.normal(1.0, 0.2, (draws, 5))
    people = Population.of(np.exp(logs.T))  # one reading a group
    x = 1.0 + 0.2 * norm.ppf(0.8)
    low, high = people.interval_below(np.full(draws, np.exp(x)))
    bound = people.bound(0.95)
    held = [np.mean(low <= 0.8), np.mean(high >= 0.8), np.mean(np.log(bound) >= 1.0 + 0.2 * norm.ppf(0.95))]
    assert all(0.93 < share < 0.97 for share in held), held


def test_a_bound_and_the_share_below_it_agree():
    people = Population.of(np.exp(np.random.default_rng(4).normal(0.0, 0.3, 8)))
    low, _ = people.interval_below(people.bound(0.9))
    assert float(low) == pytest.approx(0.9, abs=0.002)


def test_the_unit_of_a_reading_does_not_matter():
    peaks = np.array([8.0, 9.0, 9.5, 11.0])
    a, b = Population.of(peaks), Population.of(4.448 * peaks)
    assert float(b.bound(0.95)) == pytest.approx(4.448 * float(a.bound(0.95)))
    assert float(a.expected_below(10.0)) == pytest.approx(float(b.expected_below(44.48)))


def test_alike_groups_are_one_group_and_unlike_ones_widen_the_interval():
    peaks = np.array([8.0, 9.0, 9.5, 11.0])
    one, same = Population.of(peaks), Population.of_groups(np.tile(peaks, (30, 1)))
    unlike = Population.of_groups(peaks * np.exp(np.linspace(-0.5, 0.5, 30))[:, None])
    assert float(same.bound(0.95)) == pytest.approx(float(one.bound(0.95)), rel=0.02)
    assert float(unlike.bound(0.95)) > float(one.bound(0.95))
    widths = [float(np.diff(np.ravel(each.interval_below(10.0)))[0]) for each in (one, unlike)]
    assert widths[1] > widths[0]


def test_errors_of_subjects_widen_only_what_they_exceed_and_a_common_error_moves_the_mean():
    peaks = np.exp(np.array([-0.1, 0.0, 0.1]))
    plain, small, large = (Population.of(peaks, own=own) for own in (0.0, 0.05, 0.3))
    assert float(small.bound(0.95)) == float(plain.bound(0.95)) < float(large.bound(0.95))
    common = Population.of(peaks, common=0.5)
    low, high = (float(end) for end in common.interval_below(1.0))
    assert float(common.expected_below(1.0)) == pytest.approx(0.5, abs=1e-6)
    assert low < 0.01 and high > 0.99


def test_subjects_that_are_all_alike_give_numbers():
    people = Population.of([3.0, 3.0, 3.0])
    assert float(people.bound(0.95)) == pytest.approx(3.0, rel=1e-6)
    assert float(people.expected_below(3.1)) == pytest.approx(1.0)


def test_an_unreached_reading_has_no_share():
    people = Population.of(np.full((3, 2), [1.0, 2.0]) * np.array([[1.0], [1.1], [1.2]]))
    low, high = people.interval_below(np.array([1.1, np.nan]))
    assert np.isfinite([low[0], high[0]]).all() and np.isnan([low[1], high[1]]).all()


def test_one_subject_is_refused():
    with raises_code("not_enough_data", "subjects"):
        Population.of([3.0])


def test_an_aim_is_read_with_its_percentage():
    assert share_of_aim("people:95") == share_of_aim("People: 95%") == 0.95
    assert share_of_aim("average") is None and share_of_aim("subject:people") is None
    for typed, code in (
        ("0", "out_of_range"),
        ("100", "out_of_range"),
        ("nan", "out_of_range"),
        ("-5", "out_of_range"),
        ("abc", "not_a_number"),
        ("", "not_a_number"),
    ):
        with raises_code(code, "aim"):
            share_of_aim(f"people:{typed}")
