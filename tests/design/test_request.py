"""Forces and speeds of a test, and what is scored from them."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol, face_of


def test_the_published_test_is_5_to_15_newtons_at_two_speeds():
    assert NAGOYA_PROTOCOL.words == "5 to 15 N" and NAGOYA_PROTOCOL.needed_N == 10.0
    assert (NAGOYA_PROTOCOL.slow_mm_s, NAGOYA_PROTOCOL.fast_mm_s) == (10.0, 250.0)


@pytest.mark.parametrize(
    ("forces", "words", "needed"),
    [((8.0,), "8 N", 8.0), ((3.0, 9.0), "3 to 9 N", 9.0), ((2.0, 3.0, 4.0, 20.0), "2 to 20 N", 4.0)],
)
def test_other_forces_have_grids_from_their_lowest_to_their_highest(forces, words, needed):
    own = Protocol(forces_N=forces)
    assert own.words == words and own.needed_N == needed
    assert (own.steady_grid_N[0], own.steady_grid_N[-1]) == (forces[0], forces[-1])
    np.testing.assert_allclose(own.low_grid_N[[0, -1]], [0.1 * forces[0], forces[0]])
    np.testing.assert_allclose(own.misfit_N[[0, -1]], [0.1 * forces[0], forces[-1]])
    np.testing.assert_allclose(own.wide_N[[0, -1]], [2e-4 * forces[0], 10.0 * forces[-1]])
    np.testing.assert_allclose(np.diff(np.log(own.misfit_N)), np.log(own.misfit_N[1] / own.misfit_N[0]))
    assert own.exponent_at_N[-len(forces) :] == forces


@pytest.mark.parametrize(
    ("punch", "condition", "face"),
    [
        ("square:14", None, "bonded"),
        ("ball:20", None, "frictionless"),
        ("profile:a.csv", None, "frictionless"),
        ("ball:20", "bonded", "bonded"),
    ],
)
def test_a_flat_punch_is_glued_and_another_one_slides_unless_it_is_said(punch, condition, face):
    assert face_of(punch, condition) == face
