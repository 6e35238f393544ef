"""Sizes of law error and contact scatter, and the intervals when few pads show them, against one-way random effects."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import t as student

from dummydesign.inference.noise import Noise
from dummydesign.loop.fitting.fit import NORMAL_95
from dummydesign.loop.fitting.noise import NoiseSizes, SizeLikelihood
from dummydesign.loop.selection.cross_validation import student_over_normal

NOISE = 1e-4
WIDE = ((0.005, 30.0), (0.005, 0.3), (0.005, 0.3), (0.001, 0.3))


def pressed(levels, rng, presses=4, priors=WIDE):
    """Likelihood of a mean from pads that differ by a level each: slope, curvature and shifts do nothing."""
    pads = len(levels)
    pad = np.repeat(np.arange(pads), presses)
    values = levels[pad] + rng.normal(0.0, NOISE, len(pad))
    level = np.eye(pads)[pad]
    nothing = np.zeros((len(pad), len(pad)))
    columns = np.column_stack([values, np.ones(len(pad)), nothing, nothing, level, *[0.0 * level] * 3]) / NOISE
    return SizeLikelihood(columns.T @ columns, (1, len(pad), len(pad), *[pads] * 4), priors), values


def start(level=0.005):
    return NoiseSizes(Noise(NOISE, 0.0, 1.0, 0.005), (level, 0.005, 0.005, 0.001))


@pytest.mark.parametrize("pads", [3, 4, 8])
def test_the_degrees_of_a_mean_over_pads_are_their_number_less_one(pads):
    rng = np.random.default_rng(pads)
    levels = rng.normal(0.0, 0.01, pads)
    made, values = pressed(levels, rng)
    sizes, _ = made.estimate(start())
    degrees, own = made.degrees(sizes)
    assert degrees[0] == pytest.approx(pads - 1, rel=0.03) and own[2] == pytest.approx(pads - 1, rel=0.03)
    means = values.reshape(pads, -1).mean(axis=1)
    variance = made.variances(sizes.fitted)[0]
    assert variance == pytest.approx(means.var(ddof=1) / pads, rel=0.02)


@pytest.mark.slow
def test_intervals_of_students_t_cover_the_mean_of_all_pads_and_normal_ones_do_not():
    rng = np.random.default_rng(4)
    draws, inside = 300, np.zeros(2)
    for _ in range(draws):
        made, values = pressed(rng.normal(0.0, 0.007, 3), rng)
        sizes, _ = made.estimate(start())
        spread = np.sqrt(made.variances(sizes.fitted)[0])
        wider = student_over_normal(made.degrees(sizes)[0])[0]
        inside += abs(values.mean()) < NORMAL_95 * spread * np.array([1.0, wider])
    # three standard deviations of a count; the normal interval covers P(|t| < 1.96) with two degrees, 0.81
    normal = 1.0 - 2.0 * student.sf(NORMAL_95, 2)
    for share, wanted in zip(inside / draws, (normal, 0.95)):
        assert share == pytest.approx(wanted, abs=3.0 * np.sqrt(wanted * (1.0 - wanted) / draws))


def test_what_is_known_of_pads_beforehand_adds_to_the_degrees():
    rng = np.random.default_rng(1)
    levels = rng.normal(0.0, 0.005, 3)
    degrees = []
    for spread in (30.0, 0.35, 0.05):
        made, _ = pressed(levels, rng, priors=((0.005, spread), *WIDE[1:]))
        sizes, _ = made.estimate(start())
        degrees.append(made.degrees(sizes)[0][0])
    assert degrees[0] < 0.5 * degrees[1] < 0.1 * degrees[2]


def test_noise_that_is_known_leaves_the_normal_interval():
    rng = np.random.default_rng(2)
    made, _ = pressed(np.zeros(3), rng, priors=((1e-3 * NOISE, 0.1), *WIDE[1:]))
    sizes = start(3e-4)
    assert made.degrees(sizes)[0][0] >= 2.0
    assert student_over_normal(np.array([2.0, 7.0, 1e6])) == pytest.approx([2.1953, 1.2065, 1.0], abs=2e-4)
