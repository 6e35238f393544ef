"""Presses as a robot or a test machine makes them: motion, force of tissue or pad, sensor, noise. Seeded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Recording:
    """What stands in one recording, compression positive and zero at contact.

    ``time_s``, ``displacement_mm`` and ``force_N`` are as measured (with noise); ``true_force_N`` is without noise
    and offset. ``starts`` are the indices where the approach of each press begins.
    """

    time_s: np.ndarray
    displacement_mm: np.ndarray
    force_N: np.ndarray
    true_force_N: np.ndarray
    noise_N: float
    velocity_mm_s: float
    depth_mm: tuple[float, ...]
    hold_s: float
    filtered: bool
    law: str


def recording(
    seed: int,
    presses: int = 1,
    velocity_mm_s: float | None = None,
    hold_s: float | None = None,
    filtered: bool | None = None,
    lead_in: bool = True,
    unload: bool | None = None,
) -> Recording:
    """Make one recording of some presses of equal speed; what is not given is drawn."""
    draw = np.random.default_rng([seed, 2])
    velocity = float(velocity_mm_s or draw.choice([2.0, 10.0, 10.0, 50.0, 250.0]))
    hold = float(draw.choice([3.0, 5.0, 10.0]) if hold_s is None else hold_s)
    rate = 1000.0 if velocity > 100 else 500.0 if velocity > 5 else 50.0 if velocity > 0.5 else 2.0
    law = draw.choice(["tissue", "pad", "hertz"])
    depths = [float(draw.uniform(2.5, 7.0)) for _ in range(presses)]
    above = float(draw.uniform(0.5, 3.0)) if lead_in else 0.0
    unload = bool(draw.integers(2)) if unload is None else unload
    times, motion, clock = [], [], 0.0
    for number, depth in enumerate(depths):
        last = number == presses - 1
        t, x = _cycle(draw, velocity, depth, hold, rate, above, unload or not last)
        times.append(clock + t)
        motion.append(x)
        clock += t[-1] + 1.0 / rate
    time, x = np.concatenate(times), np.concatenate(motion)
    force = _FORCES[str(law)](draw, time, x)
    force *= float(draw.uniform(8.0, 25.0)) / force.max()
    filtered = bool(draw.integers(2)) if filtered is None else filtered
    if filtered:
        force = _second_order(time, force, 35.0)
    noise = float(draw.uniform(0.003, 0.03))
    slow = _slow(draw, time, 0.5 * noise)
    white = draw.normal(0.0, noise, len(time))
    measured = x + draw.normal(0.0, 0.001, len(x))
    seen = force + white + slow
    return Recording(time, measured, seen, force, noise, velocity, tuple(depths), hold, filtered, str(law))


def _cycle(draw, velocity, depth, hold, rate, above, unload):
    """Time and position of one press: dwell above the surface, approach, ramp with braking, hold, retraction."""
    dwell = float(draw.uniform(0.2, 1.0)) if above > 0 else 0.0
    braking = 30_000.0 if velocity > 100 else 1_000.0
    stop_way = min(velocity**2 / (2 * braking), depth)
    straight = (above + depth - stop_way) / velocity
    brake = 2 * stop_way / velocity
    back = 10.0 if velocity > 5 else velocity
    leave = (depth + above) / back if unload else 0.0
    rest = float(draw.uniform(0.5, 2.0)) if unload else 0.0
    if velocity < 0.5:
        dwell, rest = 20 * dwell, 20 * rest
    total = dwell + straight + brake + hold + leave + rest
    t = np.arange(round(total * rate) + 1) / rate
    s = t - dwell
    x = np.full(len(t), -above)
    ramp = (s > 0) & (s <= straight)
    x[ramp] = -above + velocity * s[ramp]
    slowing = (s > straight) & (s <= straight + brake)
    left = (straight + brake - s[slowing]) / max(brake, 1e-12)
    x[slowing] = depth - stop_way * left**2
    stopped = s > straight + brake
    x[stopped] = depth
    away = s - straight - brake - hold
    leaving = away > 0
    if unload:
        x[leaving] = np.maximum(depth - back * away[leaving], -above)
    return t, x


def _tissue(draw, time, x):
    """Five-element law: F = g1 x^3 + sum of arms g x^2 e with e' = x' - g x^2 e / c (exact decay between samples)."""
    deep = np.maximum(x, 0.0)
    force = deep**3
    for share, tau in (
        (draw.uniform(0.3, 2.0), draw.uniform(0.5, 3.0)),
        (draw.uniform(1.0, 10.0), draw.uniform(0.02, 0.2)),
    ):
        stretch, previous = np.zeros(len(x)), 0.0
        way, dt = np.diff(deep), np.diff(time)
        rate = (0.5 * (deep[1:] + deep[:-1])) ** 2 / deep.max() ** 2 / tau
        kept = np.exp(-rate * dt)
        for k in range(len(way)):
            # motion is even within a step: what it adds decays for half of it
            previous = max(previous * kept[k] + way[k] * np.sqrt(kept[k]), 0.0)
            stretch[k + 1] = previous
        force = force + share * deep**2 * stretch
    return np.where(x > 0, np.maximum(force, 0.0), 0.0)


def _linear_relaxing(draw, time, elastic, x):
    """Elastic force with two Prony arms, F = Fe + sum b * int exp(-(t-s)/tau) dFe; cannot pull."""
    force = elastic.copy()
    dt, step = np.diff(time), np.diff(elastic)
    for share, tau in (
        (draw.uniform(0.1, 0.4), draw.uniform(0.8, 3.0)),
        (draw.uniform(0.1, 0.6), draw.uniform(0.02, 0.2)),
    ):
        decay, arm, held = np.exp(-dt / tau), np.zeros(len(x)), 0.0
        for k in range(len(step)):
            held = (held + step[k]) * decay[k]
            arm[k + 1] = held
        force = force + share * arm
    return np.where(x > 0, np.maximum(force, 0.0), 0.0)


def _pad(draw, time, x):
    """A flat punch on a slab: linear at first, stiffening with depth over thickness."""
    deep = np.maximum(x, 0.0)
    thick = draw.uniform(10.0, 20.0)
    return _linear_relaxing(draw, time, deep * (1.0 + 1.5 * deep / thick + 3.0 * (deep / thick) ** 2), x)


def _hertz(draw, time, x):
    """A ball: F as depth to the power 3/2."""
    return _linear_relaxing(draw, time, np.maximum(x, 0.0) ** 1.5, x)


_FORCES = {"tissue": _tissue, "pad": _pad, "hertz": _hertz}


def _second_order(time, force, cutoff_hz):
    """Second-order Butterworth low-pass in one pass, integrated on a fine grid."""
    from scipy.signal import butter, lfilter

    rate = 1.0 / float(np.median(np.diff(time)))
    fine = max(1, int(np.ceil(2000.0 / rate)))
    grid = np.linspace(time[0], time[-1], fine * (len(time) - 1) + 1)
    b, a = butter(2, cutoff_hz, fs=fine * rate)
    return np.interp(time, grid, lfilter(b, a, np.interp(grid, time, force)))


def _slow(draw, time, size):
    """Noise that wanders over half a second."""
    step = np.r_[0.0, np.diff(time)]
    keep = np.exp(-step / 0.5)
    kick = draw.normal(0.0, 1.0, len(time)) * size * np.sqrt(1.0 - keep**2)
    out, level = np.empty(len(time)), float(draw.normal(0.0, size))
    for k in range(len(time)):
        level = level * keep[k] + kick[k]
        out[k] = level
    return out
