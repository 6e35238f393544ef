"""A clipped force is found within its noise; rounded tops, ringing, creep and coarse digits are none."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.sensor import find_clip

TIME = np.arange(0.0, 8.0, 0.002)


def press(ringing=0.0, relaxing=0.4):
    since = np.maximum(TIME - 1.5, 0.0)
    x = np.clip(10.0 * (TIME - 1.0), -1.0, 5.0) + ringing * np.exp(-6.0 * since) * np.sin(40.0 * since)
    return x, 0.11 * np.maximum(x, 0.0) ** 3 * (1.0 - relaxing + relaxing * np.exp(-since / 0.6))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("converter_N", [0.0, 0.01, 0.03])
@pytest.mark.parametrize("share", [0.7, 0.85])
def test_a_clipped_stretch_is_found_with_its_force_and_its_ends(seed, converter_N, share):
    rng, (x, force) = np.random.default_rng([seed, 8]), press()
    limit = share * force.max()
    noisy = np.minimum(force + rng.normal(0.0, 0.01, len(x)), limit) + rng.normal(0.0, converter_N, len(x))
    clip = find_clip(TIME, x, noisy)
    inside = np.flatnonzero(force >= limit)
    assert clip.level_N == pytest.approx(limit, abs=0.03)
    assert abs(clip.start_s - TIME[inside[0]]) < 0.02 and abs(clip.end_s - TIME[inside[-1]]) < 0.05


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("kind", ["clean", "ringing", "elastic", "digits", "creep"])
def test_other_tops_are_not_clipped(seed, kind):
    rng = np.random.default_rng([seed, 9])
    x, force = press(0.4 if kind == "ringing" else 0.0, 0.0 if kind == "elastic" else 0.4)
    if kind == "creep":  # a held force
        x = np.where(TIME > 1.5, 5.0 + 0.6 * (1.0 - np.exp(-(TIME - 1.5))), x)
        force = np.where(TIME > 1.5, force.max(), force)
    force = force + rng.normal(0.0, 0.01, len(x))
    assert find_clip(TIME, x, np.round(force, 1) if kind == "digits" else force) is None


@pytest.mark.parametrize("lag_s", [0.008, 0.02])
def test_the_top_of_a_lagging_sensor_is_not_clipped(lag_s):
    """a fast ramp on a pad that relaxes, through a first-order filter: its round top stands for some samples"""
    time = np.arange(0.0, 0.6, 1e-3)
    x, since = np.clip(250.0 * (time - 0.2), -1.0, 5.7), np.maximum(time - 0.2 - 5.7 / 250.0, 0.0)
    force = 18.0 * (np.maximum(x, 0.0) / 5.7) ** 1.6 * (0.5 + 0.5 * np.exp(-since / 0.3))
    for k in range(1, len(force)):
        force[k] = force[k - 1] + (force[k] - force[k - 1]) * -np.expm1(-1e-3 / lag_s)
    noise = np.random.default_rng(7).normal(0.0, 0.02, (60, len(x)))
    assert sum(find_clip(time, x, force + one) is not None for one in noise) <= 1
