"""Readings that end at one value are seen in the raw data, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.data.trials import flat_top


def presses(rng, count=6, noise_N=0.03):
    time = np.arange(0.0, 8.0, 0.002)
    tops = rng.uniform(5.0, 14.0, count)
    return [top * np.clip(time - 1.0, 0.0, 0.2) / 0.2 * (1.0 + 0.4 * np.exp(-np.clip(time - 1.2, 0.0, None))) / 1.4
            + rng.normal(0.0, noise_N, len(time)) for top in tops]  # fmt: skip


@pytest.mark.parametrize("seed", range(20))
def test_clipped_readings_are_found_with_their_limit_and_clean_ones_never(seed):
    rng = np.random.default_rng([seed, 91])
    forces = presses(rng)
    assert flat_top(forces) is None
    limit = float(np.sort([force.max() for force in forces])[-2]) * rng.uniform(0.8, 0.95)
    assert flat_top([np.minimum(force, limit) for force in forces]) == pytest.approx(limit, rel=1e-9)


def test_one_clipped_press_or_coarse_readings_tell_nothing():
    rng = np.random.default_rng(92)
    forces = presses(rng)
    second = float(np.sort([force.max() for force in forces])[-2])
    assert flat_top([np.minimum(force, second + 0.05) for force in forces]) is None
    assert flat_top([np.round(force, 0) for force in forces]) is None
