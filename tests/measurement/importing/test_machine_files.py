"""Whole files as machines write them: read right or refused with a reason, and never an internal error."""

from __future__ import annotations

import warnings
from collections import Counter

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.read import import_files
from tests.support.import_rates import judge
from tests.support.machine_files import DIALECTS, machine_file
from tests.support.mutations import mutate

SET = range(96)
"""Seeds of the published set: every form of file four times, with its own unit, sign, offset, zero and presses."""


@pytest.mark.parametrize("seed", range(len(DIALECTS)))
def test_every_form_of_file_is_read_right(seed, tmp_path):
    outcome = judge(machine_file(seed), tmp_path)
    assert outcome.verdict == "right", outcome.text


@pytest.mark.slow
@pytest.mark.parametrize(("seeds", "share"), [(SET, 0.97), (range(7000, 7240), 0.95)])
def test_97_of_100_files_are_read_right_and_none_wrong_without_a_word(seeds, share, tmp_path):
    """What is not right is a contact to be told from a noisy force alone: 0.15 to 0.3 mm off, and said to be so."""
    found = Counter()
    for seed in seeds:
        outcome = judge(machine_file(seed), tmp_path)
        found[outcome.verdict] += 1
        assert outcome.verdict != "wrong" or outcome.warned, (seed, outcome.text)
    assert found["right"] >= share * len(seeds), found


@pytest.mark.slow
def test_a_fast_press_in_unknown_coordinates_is_never_wrong_without_a_word(tmp_path):
    for seed in range(120):
        made = machine_file(seed + 9000, fast=True)
        outcome = judge(made, tmp_path)
        assert outcome.verdict != "wrong" or outcome.warned, (seed, outcome.text)


def damaged(seeds, folder):
    """Import damaged files; anything but an answer or an error of ours fails."""
    sound = [machine_file(seed) for seed in range(len(DIALECTS))]
    for seed in seeds:
        made = sound[seed % len(sound)]
        path = folder / made.name
        path.write_bytes(mutate(made.data, seed))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                found = import_files([path])[0][0]
            except InputError as refusal:
                text = str(refusal)
                assert text.startswith((made.name, "--")) and "\n" not in text and len(text) < 700, (seed, text)
                continue
        for press in found.presses:
            assert np.all(np.diff(press.time_s) > 0), seed
            assert np.isfinite(press.displacement_mm).all() and np.isfinite(press.force_N).all(), seed
            assert press.summary.depth_mm > 0 and press.summary.velocity_mm_s > 0, seed


@pytest.mark.slow
def test_damaged_files_never_end_in_an_internal_error(tmp_path):
    damaged(range(200), tmp_path)


@pytest.mark.slow
def test_two_thousand_damaged_files_never_end_in_an_internal_error(tmp_path):
    damaged(range(200, 2200), tmp_path)
