"""Signs and noise of a recording: compression is made positive, doubt is asked about."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.importing.decisions import ImportLog, Settings
from dummydesign.measurement.importing.sign_convention import find_signs
from dummydesign.measurement.plateau import noise_of
from dummydesign.measurement.sensor import middle_of_three
from tests.support.machine_presses import recording
from tests.support.refusal import raises_code


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("push", [1.0, -1.0])
def test_compression_is_made_positive_whatever_the_file_counts(way, push):
    record = recording(1, velocity_mm_s=10.0)
    x, force = way * (record.displacement_mm + 120.0), push * (record.force_N + 1.7)
    signs = find_signs(x, force, None, ImportLog("a.csv"))
    assert (signs.displacement, signs.force) == (way, push)
    assert signs.rest_force_N == pytest.approx(push * 1.7, abs=4 * record.noise_N)


def test_given_signs_are_taken_and_wrong_ones_refused():
    record = recording(1, velocity_mm_s=10.0)
    both = frozenset({"displacement", "force"})
    signs = find_signs(-record.displacement_mm, -record.force_N, None, ImportLog("a.csv", Settings(flip=both)))
    assert (signs.displacement, signs.force) == (-1.0, -1.0)
    for flip in ({"displacement"}, {"force"}):
        with raises_code("inconsistent", "flip"):
            find_signs(record.displacement_mm, record.force_N, None, ImportLog("a.csv", Settings(flip=frozenset(flip))))


def test_a_force_that_swings_both_ways_is_asked_about():
    record = recording(1, velocity_mm_s=10.0)
    force = record.force_N.copy()
    force[-200:] = -0.8 * force.max()
    with raises_code("needs_decision", "flip"):
        find_signs(record.displacement_mm, force, None, ImportLog("a.csv"))


def test_a_recording_that_begins_pressed_is_no_press_of_the_other_sign():
    record = recording(1, velocity_mm_s=10.0, unload=True)
    late = record.force_N.argmax() + 500
    with raises_code("needs_decision", "tare"):
        find_signs(record.displacement_mm[late:], record.force_N[late:], None, ImportLog("a.csv"))


@pytest.mark.parametrize("force", [np.zeros(500), np.full(500, 3.0), np.random.default_rng(1).normal(0, 0.01, 500)])
def test_nothing_pressed_says_so(force):
    x = np.linspace(-1.0, 5.0, 500)
    with raises_code("nothing_found", "force_N"):
        find_signs(x, force, None, ImportLog("a.csv"))


def test_single_spikes_do_not_survive_the_middle_of_three_and_edges_do():
    values = np.r_[np.zeros(10), 5.0, np.zeros(10), np.ones(10)]
    assert np.array_equal(middle_of_three(values), np.r_[np.zeros(21), np.ones(10)])


def test_noise_is_told_beside_a_smooth_force():
    force = 3.0 * np.linspace(0, 1, 4000) ** 3 + np.random.default_rng(2).normal(0.0, 0.02, 4000)
    assert noise_of(force) == pytest.approx(0.02, rel=0.05)
