"""What the generator's effects do to the force of a press and to its signal; shares nothing with the loop."""

from __future__ import annotations

import numpy as np


def at_the_pad(effects: dict[str, float], force: np.ndarray) -> np.ndarray:
    """Effects outside the vocabulary that act on the force of the pad."""
    if "saturation" in effects:
        size = effects["saturation"]
        knee = 0.72 * np.quantile(force.max(axis=1), 0.9)
        over = np.maximum(force - knee, 0.0)
        return np.minimum(force, knee) + over / (1.0 + 0.25 * size * over)
    return force


def at_the_punch(
    effects: dict[str, float], time: np.ndarray, force: np.ndarray, acceleration: np.ndarray
) -> np.ndarray:
    """What is added to the force of one trial before the filter."""
    for effect, size in effects.items():
        if effect == "force_bias":
            force = force + size
        if effect == "force_drift":
            force = force + size * 15.0 * (1.0 - np.exp(-time / 15.0))
        if effect == "inertia":
            force = force + size * acceleration * 1e-3
        if effect == "ringing" and np.any(acceleration):
            stop = time[np.nonzero(acceleration)[0][-1]]
            hit = -acceleration.min() * 1e-3
            after = np.maximum(time - stop, 0.0)
            wave = 0.06 * size * hit * np.exp(-after / 0.07) * np.sin(2 * np.pi * 17.0 * after)
            force = force + wave * (time > stop)
    return force


def as_saved(effects: dict[str, float], time: np.ndarray, signal: np.ndarray, rng) -> np.ndarray:
    """What happens to the filtered signal of one trial."""
    for effect, size in effects.items():
        if effect == "time_skew":
            signal = np.interp(time - size, time, signal)
        if effect == "mains_hum":
            signal = signal + size * np.sin(2 * np.pi * 50.0 * time + rng.uniform(0, 6.28))
        if effect == "load_drop" and rng.random() < 0.35:
            signal = signal - size * (time > rng.uniform(1.0, 8.0))
    return signal


def slow_noise(time: np.ndarray, size: float, correlation: float, rng) -> np.ndarray:
    """Ornstein-Uhlenbeck noise on any grid."""
    out = np.empty(len(time))
    out[0] = rng.normal(0, size)
    keep = np.exp(-np.diff(time) / correlation)
    kicks = rng.normal(0, size, len(time) - 1) * np.sqrt(1 - keep**2)
    for k in range(len(time) - 1):
        out[k + 1] = keep[k] * out[k] + kicks[k]
    return out
