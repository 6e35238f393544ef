"""Variances of fitted parameters with contact scatter and law error integrated out."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.fitting.noise import SizeLikelihood
from dummydesign.loop.model.campaign_law import SLAB_ERROR

COUNTS = (3, 4, 2, 2, 2)
SIZES = np.array([0.05, 0.02, 0.03, 0.04])


def columns(seed=3):
    """Whitened residual, three fitted columns and ten random ones, over forty readings."""
    return np.random.default_rng(seed).normal(size=(40, 1 + sum(COUNTS)))


def by_inverse(made, likelihood):
    """The block of the inverse of the whole information, in which a random column has its prior."""
    prior = np.r_[np.zeros(COUNTS[0]), SIZES[likelihood._groups()] ** -2.0]
    whole = made[:, 1:].T @ made[:, 1:] + np.diag(prior)
    return np.diag(np.linalg.inv(whole))[: COUNTS[0]]


@pytest.mark.parametrize("scale", [1.0, 1e-4])
def test_they_are_those_of_the_whole_information_in_any_unit(scale):
    made = columns()
    made[:, 2] *= scale
    likelihood = SizeLikelihood(made.T @ made, COUNTS, SLAB_ERROR)
    np.testing.assert_allclose(likelihood.variances(SIZES), by_inverse(made, likelihood), rtol=1e-7)


def test_a_parameter_that_no_reading_sees_has_none_and_leaves_the_others():
    made = columns()
    fewer = np.delete(made, 2, axis=1)
    full = SizeLikelihood(fewer.T @ fewer, (2, *COUNTS[1:]), SLAB_ERROR)
    made[:, 2] = 0.0
    found = SizeLikelihood(made.T @ made, COUNTS, SLAB_ERROR).variances(SIZES)
    assert found[1] == 0.0
    np.testing.assert_allclose(found[[0, 2]], full.variances(SIZES), rtol=1e-9)


def test_scatter_that_may_be_larger_leaves_less_certainty():
    made = columns()
    likelihood = SizeLikelihood(made.T @ made, COUNTS, SLAB_ERROR)
    assert np.all(likelihood.variances(3.0 * SIZES) > likelihood.variances(SIZES))
    without = np.diag(np.linalg.inv(made[:, 1:4].T @ made[:, 1:4]))
    np.testing.assert_allclose(likelihood.variances(1e-9 * SIZES), without, rtol=1e-6)
