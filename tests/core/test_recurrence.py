"""The linear recurrence equals the plain loop, for any length, shape and start."""

import numpy as np
import pytest

from dummydesign.core.recurrence import linear_recurrence


def plain(factor, addend, start):
    out, value = [], start
    for a, b in zip(factor, addend):
        value = a * value + b
        out.append(value)
    return np.array(out)


@pytest.mark.parametrize("count", [1, 2, 3, 10, 49, 50, 997])
def test_it_equals_the_loop_for_every_length(count):
    rng = np.random.default_rng(count)
    factor, addend = rng.uniform(-1, 1, count), rng.normal(size=count)
    assert np.allclose(linear_recurrence(factor, addend, 2.0), plain(factor, addend, 2.0), rtol=1e-12)


def test_leading_axes_broadcast_and_complex_numbers_pass():
    rng = np.random.default_rng(0)
    factor = np.exp(-rng.uniform(0, 1, 30) + 1j * rng.normal(size=30))
    addend, start = rng.normal(size=(4, 3, 30)), rng.normal(size=(4, 3))
    many = linear_recurrence(factor, addend, start)
    assert many.shape == (4, 3, 30)
    assert np.allclose(many[2, 1], plain(factor, addend[2, 1], start[2, 1]))


def test_nothing_in_nothing_out():
    assert linear_recurrence(np.zeros(0), np.zeros(0)).shape == (0,)
