"""The relaxation of a force-depth law: closed forms, grid independence, superposition, conversions."""

import numpy as np
import pytest
from scipy.integrate import quad

from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from tests.support.refusal import raises_code

ARMS = (PronyTerm(0.03, 0.6), PronyTerm(1.7, 0.25))


def test_a_steady_ramp_follows_the_closed_form():
    time, rate = np.linspace(0.0, 0.5, 7), 4.0
    exact = rate * time + sum(a.beta * rate * a.tau_s * (1 - np.exp(-time / a.tau_s)) for a in ARMS)
    assert np.allclose(relaxed_force(time, rate * time, ARMS), exact, rtol=1e-13)


def test_a_jump_at_the_first_sample_relaxes_from_the_instantaneous_to_the_long_term_force():
    time = np.geomspace(1e-6, 100.0, 40)
    force = relaxed_force(np.r_[0.0, time], np.full(41, 2.0), ARMS)
    exact = 2.0 * (1 + sum(a.beta * np.exp(-np.r_[0.0, time] / a.tau_s) for a in ARMS))
    assert np.allclose(force, exact, rtol=1e-12)
    assert force[0] == pytest.approx(2.0 * (1 + 0.85)) and force[-1] == pytest.approx(2.0)


def test_it_is_the_hereditary_integral_on_an_uneven_grid():
    rng = np.random.default_rng(1)
    time = np.cumsum(rng.uniform(1e-3, 0.2, 30))
    elastic = np.r_[0.0, rng.normal(size=29)]
    rate = np.diff(elastic) / np.diff(time)

    def at(end):
        total = 0.0
        for k in range(len(rate)):
            if time[k] < end:
                kernel = quad(
                    lambda s: 1 + sum(a.beta * np.exp(-(end - s) / a.tau_s) for a in ARMS),
                    time[k],
                    min(time[k + 1], end),
                    epsabs=1e-13,
                    limit=200,
                )[0]
                total += rate[k] * kernel
        return total

    got = relaxed_force(time, elastic, ARMS)
    for index in (3, 11, 29):
        assert got[index] == pytest.approx(at(time[index]), abs=1e-10)


def test_more_samples_on_the_same_polyline_change_nothing():
    time, elastic = np.array([0.0, 0.1, 0.15, 3.0]), np.array([0.0, 5.0, 4.0, 6.0])
    fine = np.union1d(time, np.random.default_rng(0).uniform(0, 3, 997))
    coarse = relaxed_force(time, elastic, ARMS)
    dense = relaxed_force(fine, np.interp(fine, time, elastic), ARMS)
    assert np.allclose(dense[np.searchsorted(fine, time)], coarse, rtol=1e-12)


def test_curves_are_independent_of_each_other_and_superpose():
    rng = np.random.default_rng(2)
    time = np.cumsum(rng.uniform(0.01, 0.1, 50))
    elastic = rng.normal(size=(3, 4, 50))
    together = relaxed_force(time, elastic, ARMS)
    assert np.allclose(together[1, 2], relaxed_force(time, elastic[1, 2], ARMS))
    summed = relaxed_force(time, elastic.sum(axis=(0, 1)), ARMS)
    assert np.allclose(together.sum(axis=(0, 1)), summed)
    own_times = np.stack([time, 2 * time])
    both = relaxed_force(own_times, elastic[0, 0], ARMS)
    assert np.allclose(both[1], relaxed_force(2 * time, elastic[0, 0], ARMS))


def test_without_arms_the_elastic_force_is_returned_unchanged():
    elastic = np.random.default_rng(3).normal(size=20)
    assert np.array_equal(relaxed_force(np.arange(20.0), elastic, ()), elastic)


def test_steps_far_below_the_time_constant_keep_their_digits():
    time = np.linspace(0, 1e-9, 5)
    force = relaxed_force(time, 1e9 * time, (PronyTerm(1e6, 1.0),))
    assert np.allclose(force, 2e9 * time, rtol=1e-12)


@pytest.mark.parametrize(
    "make, code",
    [
        (lambda: PronyTerm(0.0, 1.0), "out_of_range"),
        (lambda: PronyTerm(1.0, -0.1), "out_of_range"),
        (lambda: relaxed_force([0, 1, 1], [0, 1, 2], ()), "malformed"),
        (lambda: relaxed_force([0, 1], [0, 1, 2], ()), "inconsistent"),
    ],
)
def test_bad_input_is_said(make, code):
    with raises_code(code):
        make()
