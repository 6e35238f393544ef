"""Readings that end at one value are seen in the raw data, and only there."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.data.trials import flat_top
from dummydesign.measurement.trace import Trace


def presses(rng, count=6, noise_N=0.03, limits=None, digits=9, own_noise_N=0.0):
    time = np.arange(0.0, 8.0, 0.002)
    tops = rng.uniform(5.0, 14.0, count)
    share = np.clip(time - 1.0, 0.0, 0.2) / 0.2
    shape = share * (1.0 + 0.4 * np.exp(-np.clip(time - 1.2, 0.0, None))) / 1.4
    forces = [top * shape + rng.normal(0.0, noise_N, len(time)) for top in tops]
    if limits is not None:
        limit = float(np.sort([force.max() for force in forces])[-2]) * limits
        forces = [np.minimum(force, limit) + rng.normal(0.0, own_noise_N, len(time)) for force in forces]
    traces = [Trace(f"{n}.csv", time, 4.0 * share - 0.1, np.round(force, digits)) for n, force in enumerate(forces)]
    return traces, (limit if limits is not None else None)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("own_noise_N", [0.0, 0.02])
def test_clipped_readings_are_found_with_their_limit_and_clean_ones_never(seed, own_noise_N):
    rng = np.random.default_rng([seed, 91])
    assert flat_top(presses(rng)[0]) is None
    traces, limit = presses(rng, limits=rng.uniform(0.6, 0.85), own_noise_N=own_noise_N)
    assert flat_top(traces) == pytest.approx(limit, rel=0.01)


def test_one_clipped_press_or_coarse_readings_tell_nothing():
    rng = np.random.default_rng(92)
    traces, _ = presses(rng, limits=1.005)
    assert flat_top(traces) is None
    assert flat_top(presses(rng, digits=0)[0]) is None
