"""People who are measured curves: the presses that were made, and one line for those that were not."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.laws import CURVES, known_words
from dummydesign.tissue.model.measured_curves import SHARES, hold_times
from tests.support.refusal import raises_code


class Person:
    """F = k x^2 at the end of the hold; the peak is twice that and falls at once. Pressed from ``low`` to ``high``."""

    velocities_mm_s = (10.0, 250.0)

    def __init__(self, k, low=5.0, high=15.0, hold_s=10.0, speeds=(10.0, 250.0)):
        self.k, self.span, self.hold_s, self.velocities_mm_s = k, (low, high), hold_s, speeds

    def hold_known_s(self):
        return self.hold_s

    def known_N(self, velocity_mm_s, hold_s):
        return self.span if velocity_mm_s in self.velocities_mm_s else None

    def depth_mm(self, force_N, hold_s):
        return np.sqrt(np.asarray(force_N) / self.k)

    def shape_N(self, force_N, velocity_mm_s, hold_s):
        return 2.0 * force_N * SHARES**2, force_N * (1.0 + np.exp(-hold_times(hold_s) / 0.01))


PEOPLE = [Person(2.0), Person(8.0, 6.0, 12.0, 8.0)]


def test_depths_are_those_of_each_person_and_the_exponent_that_of_their_curves():
    np.testing.assert_allclose(CURVES.steady_depths(PEOPLE, [8.0, 18.0]), [[2.0, 3.0], [1.0, 1.5]])
    np.testing.assert_allclose(CURVES.held_depths(PEOPLE, np.array([8.0]), 10.0, 10.0, 1e4), [[2.0], [1.0]])
    assert CURVES.exponent_of(PEOPLE, 5.0, 15.0, 10.0) == pytest.approx(2.0)
    assert CURVES.exponent_of(PEOPLE, 10.0, 10.0, 10.0) == pytest.approx(2.0)


def test_a_press_ends_at_its_depth_and_its_steady_force():
    motion, force, depth = CURVES.press(PEOPLE, 8.0, 10.0, 8.0, 1e4)
    np.testing.assert_allclose(depth, [2.0, 1.0])
    np.testing.assert_allclose(motion.displacement_mm[:, -1], depth)
    np.testing.assert_allclose(force[:, -1], 8.0, rtol=1e-6)
    np.testing.assert_allclose(force.max(axis=1), 16.0, rtol=0.02)
    assert np.all(force[:, 0] == 0.0)
    # half of the depth is a quarter of the peak
    for row in range(2):
        rise = motion.displacement_mm[row] < 0.999 * depth[row]
        x = motion.displacement_mm[row][rise] / depth[row]
        np.testing.assert_allclose(force[row][rise], 16.0 * x**2, atol=0.02)


@pytest.mark.parametrize(
    ("force", "speed", "hold", "quantity"),
    [
        (5.01, 10.0, 8.0, None),  # a factor of 1.2 below the 6 N that all were pressed to
        (4.99, 10.0, 8.0, "force_N"),
        (14.39, 10.0, 8.0, None),
        (14.41, 10.0, 8.0, "force_N"),
        (8.0, 50.0, 8.0, "velocity_mm_s"),
        (8.0, 250.0, 8.79, None),  # a tenth longer than the shortest hold
        (8.0, 250.0, 8.81, "hold_s"),
    ],
)
def test_a_press_is_refused_beyond_what_all_were_pressed_to(force, speed, hold, quantity):
    if quantity is None:
        CURVES.check(PEOPLE, force, speed, hold)
        return
    with raises_code("out_of_range", quantity) as caught:
        CURVES.check(PEOPLE, force, speed, hold)
    assert known_words(PEOPLE, hold) in str(caught.value)


def test_what_was_pressed_is_named_as_options():
    assert known_words(PEOPLE) == "--force within 5 to 14.4 N, --velocity 10,250, --hold 8 or less"
    assert known_words(PEOPLE, 5.0).endswith("--hold 5")
    apart = [Person(2.0, 1.0, 2.0), Person(2.0, 10.0, 20.0)]
    assert known_words(apart) == "to no steady force in common at one speed"
    assert known_words([Person(2.0, speeds=(10.0,)), Person(2.0, speeds=(250.0,))]).startswith("to no steady force")


def test_curves_answer_to_no_motion_and_have_no_parameters():
    with raises_code("unsupported", "law"):
        CURVES.drive(Motion(np.arange(3.0), np.arange(3.0)))
    assert CURVES.measured and not CURVES.fitted
    code, words = CURVES.notice_of("mine")
    assert code == "measured_curves" and words.startswith("mine is")
