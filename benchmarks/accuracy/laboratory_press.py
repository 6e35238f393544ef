"""What a laboratory presses, by laws of its own: people, pads, the batch, and how a press is recorded."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from benchmarks.accuracy.laboratory_pad import Curve

FORCES_N, SPEEDS_MM_S, HOLD_S, BRAKE_MM_S2 = (5.0, 10.0, 15.0), (10.0, 250.0), 10.0, 30_000.0
NOISE_N, SLOW_N, DEEPEST, LEAD_MM = 0.02, 0.01, 0.59, 0.5
WEIGHED_G, ISOCYANATE_G, ZERO_MM = 0.1, 20.0, 12.0
"""Largest error of a weight, isocyanate in a mix, and where a machine's file has the contact."""


def maxwell(t: NDArray, elastic: NDArray, arms: Any, weight: NDArray | float = 1.0) -> NDArray:
    """Elastic force and its arms, each stepped exactly for a force that is straight between samples."""
    out, step, rise = elastic.copy(), np.diff(t), np.diff(elastic)
    for tau, beta in arms:
        keep = np.exp(-step / tau)
        given = beta * rise * tau / step * (1.0 - keep) * (weight if np.isscalar(weight) else weight[1:])  # type: ignore[index]
        arm = 0.0
        for k, (kept, new) in enumerate(zip(keep.tolist(), given.tolist())):
            arm = kept * arm + new
            out[k + 1] += arm
    return out


def motion(speed: float, depth: float, hold_s: float = HOLD_S, unload: bool = False) -> tuple[NDArray, NDArray]:
    """Ramp from before contact, braking at 30 m/s2 (from contact on where it is too shallow), hold, back at 10 mm/s."""
    speed = min(speed, float(np.sqrt(2.0 * BRAKE_MM_S2 * depth)))
    brake = speed / BRAKE_MM_S2
    stop = depth / speed + 0.5 * brake
    # a pad that is higher than was thought is touched before
    lead = np.linspace(-LEAD_MM / speed, 0.0, 21)[:-1]
    t = np.concatenate([lead, np.linspace(0.0, stop, 401), stop + np.geomspace(stop / 400.0, hold_s, 260)])
    x = np.where(t < stop - brake, speed * t, depth - 0.5 * BRAKE_MM_S2 * np.clip(stop - t, 0.0, None) ** 2)
    if unload:
        back = np.linspace(0.0, (depth + 1.0) / 10.0, 301)[1:]
        t, x = np.concatenate([t, t[-1] + back]), np.concatenate([x, depth - 10.0 * back])
    return t, x


@dataclass(frozen=True)
class Person:
    """One subject: the five-element law, or a power of its own with two quasi-linear arms."""

    gamma: tuple[float, float, float]
    times_s: tuple[float, float]
    power: float | None

    def force(self, t: NDArray, x: NDArray) -> NDArray:
        x = np.clip(x, 0.0, None)
        if self.power is not None:
            shares = [(tau, gamma / self.gamma[0]) for tau, gamma in zip(self.times_s, self.gamma[1:])]
            return maxwell(t, self.gamma[0] * x**self.power, shares)
        total, middle = self.gamma[0] * x**3, 0.5 * (x[1:] + x[:-1])
        deep = np.cbrt(10.0 / self.gamma[0])
        for gamma, tau in zip(self.gamma[1:], self.times_s):
            damper, stretch = gamma * deep**2 * tau, 0.0
            rate = gamma * middle**2 / damper * np.diff(t)
            given = np.diff(x) * np.where(rate > 1e-9, -np.expm1(-rate) / np.maximum(rate, 1e-9), 1.0)
            for k, (kept, new) in enumerate(zip(np.exp(-rate).tolist(), given.tolist())):
                stretch = kept * stretch + new
                total[k + 1] += gamma * x[k + 1] ** 2 * stretch
        return np.maximum(total, 0.0)


@dataclass
class Batch:
    """The resin as it came: gel-point law, arms, elastic law, scatter of pours; what age and temperature do."""

    young_ref: float
    gel: float
    exponent: float
    softness: float
    arms: list[tuple[float, float]]
    yeoh: float

    def young_MPa(self, ratio: float) -> float:
        return float(1e-3 * self.young_ref * ((ratio - 15.0 * self.gel) / (15.0 * (1.0 - self.gel))) ** self.exponent)

    def arms_at(self, ratio: float) -> list[tuple[float, float]]:
        grow = (1e-3 * self.young_ref / self.young_MPa(ratio)) ** self.softness
        return [(tau, beta * grow) for tau, beta in self.arms]

    def poured(self, ratio: float, rng: np.random.Generator) -> float:
        """The ratio that was weighed where another was wanted."""
        wrong = rng.uniform(-WEIGHED_G, WEIGHED_G, 2)
        polyol = 100.0 / ratio * ISOCYANATE_G
        return 100.0 * (ISOCYANATE_G + wrong[0]) / (polyol + wrong[1])


@dataclass
class Pad:
    """One cast pad under the punch: curve of force, modulus, arms, and what is undeclared of rig and material."""

    curve: Curve
    thickness_mm: float
    young_MPa: float
    arms: list[tuple[float, float]]
    effect: dict[str, float] = field(default_factory=dict)

    def law(self, depth: NDArray) -> NDArray:
        slope = np.diff(self.curve.area_mm2[-2:]) / np.diff(self.curve.depth_mm[-2:])
        inside = PchipInterpolator(*self.curve)(np.clip(depth, 0.0, self.curve.depth_mm[-1]))
        return inside + slope * np.clip(depth - self.curve.depth_mm[-1], 0.0, None)

    def force(self, t: NDArray, x: NDArray, state: dict[str, float] | None = None) -> NDArray:
        """What the sensor says of a motion; ``state``: temperature, age and earlier presses of this pad."""
        put, state = self.effect, state or {}
        scale = self.young_MPa * (1.0 - put.get("temperature", 0.0) * (state.get("warm_C", 23.0) - 23.0))
        scale *= 1.0 + put.get("ageing", 0.0) * np.log10(state.get("age_days", 7.0) / 7.0)
        scale *= 1.0 - put.get("softening_with_cycles", 0.0) * (1.0 - 0.5 ** state.get("before", 0.0))
        arms = [*self.arms, (30.0, put.get("slow_relaxation_mode", 0.0)), (0.005, put.get("fast_relaxation_mode", 0.0))]
        arms, force = [one for one in arms if one[1]], np.zeros_like(x)
        # a stiff pad on a soft frame: whole steps would swing ever wider
        steps, part = (60, 0.25) if "machine_compliance" in put else (1, 1.0)
        for _ in range(steps):
            depth = x - put.get("contact_offset", 0.0) - put.get("machine_compliance", 0.0) * force
            share = np.clip(depth, 0.0, None) / self.thickness_mm
            elastic = scale * self.law(depth) * (1.0 + put.get("strain_stiffening", 0.0) * share**2)
            grow = put.get("strain_dependent_relaxation", 0.0)
            weight = 1.0 + grow * (share - 0.15) if grow else 1.0
            force = force + part * (np.maximum(maxwell(t, elastic, arms, weight), 0.0) - force)
        if "sensor_lag" in put:
            force = force - maxwell(t, force, [(put["sensor_lag"], 1.0)]) + force
        force = force * (1.0 - put.get("sensor_curve", 0.0) * force)
        return force + put.get("force_bias", 0.0) + put.get("force_drift", 0.0) * t


def depth_for(body: Person | Pad, force_N: float, speed: float, deepest: float) -> float:
    """Depth whose force at the end of the hold is wanted; NaN beyond the deepest. [mm]"""
    low, high = 0.02 * deepest, deepest
    if body.force(*motion(speed, high))[-1] < force_N:
        return float("nan")
    for _ in range(24):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if body.force(*motion(speed, middle))[-1] < force_N else (low, middle)
    return 0.5 * (low + high)


def readings(body: Person | Pad, deepest: float) -> dict[str, NDArray]:
    """Peak, energy and depth of the six presses, and steady depths at 10 mm/s."""
    depth = [depth_for(body, force, speed, deepest) for speed in SPEEDS_MM_S for force in FORCES_N]
    peak, energy = [], []
    for speed, one in zip(np.repeat(SPEEDS_MM_S, len(FORCES_N)), depth):
        t, x = motion(speed, one) if np.isfinite(one) else (np.zeros(2), np.zeros(2))
        f = body.force(t, x) if np.isfinite(one) else np.full(2, np.nan)
        peak.append(float(f.max()))
        energy.append(float((0.5 * (f[1:] + f[:-1]) * np.diff(x)).sum()))
    return {"depth": np.array(depth), "peak": np.array(peak), "energy": np.array(energy)}


def usable_truth(pad: Pad, people: list[Person]) -> dict[str, float | bool]:
    """The verdict's limits (1.20 short, 1.25 over) on exact presses of the pad and the true people."""
    own, theirs = readings(pad, DEEPEST * pad.thickness_mm), [readings(one, 40.0) for one in people]
    short, over = [], []
    for name in ("peak", "energy"):
        every = np.array([one[name] for one in theirs])
        short.append(every.min(0) / own[name])
        over.append(own[name] / every.max(0))
    for depth, force in zip(own["depth"][:3], FORCES_N):
        steady = [one.force(*motion(10.0, depth))[-1] if np.isfinite(depth) else np.nan for one in people]
        short.append(np.array([min(steady) / force]))
        over.append(np.array([force / max(steady)]))
    low, high = float(np.max(np.concatenate(short))), float(np.max(np.concatenate(over)))
    return {"short": low, "over": high, "usable": bool(low <= 1.20 and high <= 1.25)}


def record(path: Path, t: NDArray, x: NDArray, force: NDArray, rng: np.random.Generator, machine: bool = False) -> None:
    """Save a press with approach and noise, at 1 kHz to 0.3 s after the stop, then at 100 Hz.

    A machine's own file has a tare, its sign and its zero.
    """
    speed = x[0] / t[0]
    lead = 1.5 / speed
    stop = float(t[np.argmax(x >= x.max() - 1e-9)]) + 0.3
    even = np.arange(-lead - 0.15, stop, 1e-3)
    even = np.concatenate([even, np.arange(even[-1] + 1e-2, t[-1], 1e-2)])
    x_even = np.where(even < 0.0, np.maximum(speed * even, -1.5), np.interp(even, t, x))
    keep, slow = np.exp(-np.diff(even)), [float(rng.normal(0.0, SLOW_N))]
    for kept, push in zip(keep, rng.normal(0.0, SLOW_N * np.sqrt(1.0 - keep**2))):
        slow.append(kept * slow[-1] + push)
    read = np.interp(even, t, force, left=force[0]) + slow + rng.normal(0.0, NOISE_N, len(even))
    head = "time_s,displacement_mm,force_N"
    if machine:
        read, x_even, head = -(read + 0.31), x_even + ZERO_MM, "Time (s),Crosshead (mm),Load (N)"
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack([even - even[0], x_even, read]), "%.4f", ",", header=head, comments="")
