"""What the number of persons leaves open of a tissue: coverage, limits, and draws of an inferred one."""

import numpy as np
import pytest

from dummydesign.tissue.model.posterior import drawn_logs
from dummydesign.tissue.model.tissue_file import load_tissue
from tests.support.slab_by_formula import make_tissue


def gammas(tissue):
    return np.log([one.gamma1_N_per_mm3 for one in tissue.parameter_sets])


@pytest.mark.slow
@pytest.mark.parametrize("persons", [2, 3, 5, 10])
def test_the_mean_of_the_population_is_in_the_95_percent_of_the_draws_95_times_in_100(persons):
    """1000 groups of persons; 95 % intervals by 400 draws each hold the truth as often as they say."""
    rng = np.random.default_rng(6)
    held = 0
    for _ in range(1000):
        group = rng.normal(0.0, 0.1, (persons, 1))
        means = np.array([drawn_logs(group, rng).mean() for _ in range(400)])
        low, high = np.quantile(means, [0.025, 0.975])
        held += low <= 0.0 <= high
    # binomial: 950 +- 7, and the quantiles of 400 draws
    assert 925 <= held <= 972


def test_more_persons_leave_less_open():
    rng = np.random.default_rng(1)
    wide = []
    for persons in (3, 10, 40):
        group = np.linspace(-1.0, 1.0, persons)[:, None] * 0.3
        wide.append(np.std([drawn_logs(group, rng).mean() for _ in range(300)]))
    assert wide[0] > 1.5 * wide[1] > 2.0 * wide[2]


def test_parameters_that_go_together_in_the_subjects_go_together_in_the_draws():
    values = np.array([[0.0, 1.0], [0.3, 1.3], [0.9, 1.9]])
    drawn = drawn_logs(values, np.random.default_rng(2))
    np.testing.assert_allclose(drawn[:, 1] - drawn[:, 0], 1.0)


def test_one_subject_and_a_standards_spring_say_nothing_of_others():
    from dummydesign.tissue.adding.from_springs import spring_tissue

    assert make_tissue((1.0,)).drawn(4) == ()
    assert spring_tissue("arm", 30.0, 5.0, "a standard", "digitised").drawn(4) == ()


def test_a_measured_tissue_is_drawn_with_its_names_law_and_speeds_and_the_same_each_time():
    tissue = make_tissue()
    drawn = tissue.drawn(5)
    assert [one.name for one in drawn[0].subjects] == [one.name for one in tissue.subjects]
    assert drawn[0].velocities_mm_s == tissue.velocities_mm_s and len({gammas(one)[0] for one in drawn}) == 5
    np.testing.assert_array_equal(gammas(drawn[3]), gammas(tissue.drawn(5)[3]))


def test_an_inferred_tissue_is_drawn_from_its_posterior():
    from dummydesign.core.user_library import find
    from dummydesign.tissue.model.posterior import draws_path, read_draws

    tissue = load_tissue("forefinger")
    drawn = tissue.drawn(49)
    draws, weight = read_draws(draws_path(find("materials/tissues", "tissue", "forefinger").path))
    logs = np.log(draws[..., 0])
    mean = float(weight @ logs.mean(axis=1) / weight.sum())
    spread = float(weight @ logs.std(axis=1) / weight.sum())
    assert np.mean([gammas(one).mean() for one in drawn]) == pytest.approx(mean, abs=0.05)
    assert np.mean([gammas(one).std() for one in drawn]) == pytest.approx(spread, rel=0.1)
    known = {round(value, 6) for value in logs.ravel()}
    assert all(round(value, 6) in known for one in drawn[:5] for value in gammas(one))
