"""Simulated campaigns of an independent generator: laws near those that the loop assumes and none of them exactly.

Force curves are GetFEM's (``independent_generator_curves.json``, made by
``benchmarks/accuracy/independent_generator_curves.py``). Every arm is a pair of times, every
effect has another form, order or exponent than the class that must find it, recursive filters
do the integration, and speeds, pads, plan and sampling differ from the other generator's. Nothing is shared with the
loop.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import bilinear, butter, lfilter

CURVES = Path(__file__).parent / "independent_generator_curves.json"
STEP_S, PEAK = 2.5e-4, 1.4
PADS_MM, FURTHER_MM = (6.0, 10.0, 16.0), 12.0
SIZES = {
    "contact_offset": 0.05,
    "machine_compliance": 0.006,
    "punch_tilt": 2.0,
    "base_slip": 0.2,
    "compressibility": 0.012,
    "thickness_error": 0.3,
    "strain_stiffening": 0.8,
    "strain_dependent_relaxation": 1.5,
    "rate_dependent_viscosity": 0.15,
    "slow_relaxation_mode": 0.08,
    "fast_relaxation_mode": 0.25,
    "softening_with_cycles": 0.04,
    "incomplete_recovery": 0.012,
    "temperature": 0.008,
    "ageing": 0.03,
    "adhesion": 0.25,
    "inertia": 0.04,
    "friction_hysteresis": 0.03,
    "force_bias": 0.06,
    "force_drift": 0.01,
    "sensor_lag": 0.004,
    "time_skew": 0.004,
    "sensor_clipping": 1.0,
}
"""Usual size of each effect, in the units of the vocabulary; of clipping the share of the largest force."""
UNNAMED = {
    "sensor_square": 0.015,
    "sensor_cube": 0.08,
    "skin": 0.15,
    "bottom_felt": 0.25,
    "flow_through": 0.8,
    "creeping_hold": 0.06,
    "cold_stiffening": 0.06,
}
"""Functions of the reading (two), of depth, of depth over thickness, of thickness and time, of time, of temperature."""
TWO_SIGNED = {
    "contact_offset",
    "thickness_error",
    "temperature",
    "force_bias",
    "force_drift",
    "time_skew",
    "sensor_square",
    "sensor_cube",
}


@dataclass(frozen=True)
class Plan:
    """The trials of a campaign as columns (T,), in the order they are run."""

    thickness_mm: np.ndarray
    speed_mm_s: np.ndarray
    target_N: np.ndarray
    repeat: np.ndarray
    rest_s: np.ndarray
    age_days: np.ndarray
    temperature_C: np.ndarray
    unloads: np.ndarray


@dataclass(frozen=True)
class Truth:
    """What was put in, with its sign, the modulus, and the noise."""

    effects: dict[str, float]
    young_kPa: float
    floor_N: float


def _plan(rng: np.random.Generator, top_N: float, held_out: bool) -> Plan:
    pads = sorted((*PADS_MM, FURTHER_MM)) if held_out else PADS_MM
    speeds, shares, repeats = ((15.0, 90.0), (0.4, 0.85), 1) if held_out else ((8.0, 160.0), (0.25, 0.6, 1.0), 2)
    wanted = [(h, v, f, k + 1) for h in pads for v in speeds for f in shares for k in range(repeats)]
    # by pad and day, drawn within
    days = rng.integers(0, 3, len(wanted))
    order = np.lexsort((rng.random(len(wanted)), [w[0] for w in wanted], days))
    rows = [wanted[i] for i in order]
    fresh = np.r_[True, [(a[0], days[i]) != (b[0], days[j]) for a, b, i, j in zip(rows, rows[1:], order, order[1:])]]
    seen: dict[tuple, int] = {}
    repeat = []
    for row in rows:
        seen[row[:3]] = seen.get(row[:3], 0) + 1
        repeat.append(seen[row[:3]])
    return Plan(
        np.array([r[0] for r in rows]),
        np.array([r[1] for r in rows]),
        top_N * np.array([r[2] for r in rows]),
        np.array(repeat),
        np.where(fresh, 7200.0, rng.choice([45.0, 90.0, 240.0], len(rows))),
        np.array([8.0, 15.0, 31.0])[days[order]],
        np.round(23.0 + 3.5 * rng.standard_normal(len(rows)).clip(-1, 1), 1),
        rng.random(len(rows)) < 0.4,
    )


def _solved_mm(h: float) -> float:
    """Largest depth that was solved on a slab. [mm]"""
    rows = json.loads(CURVES.read_text())
    return next(
        r["depth_mm"][-1] for r in rows if r["base"] == "bonded" and r["poisson"] == 0.5 and r["thickness_mm"] == h
    )


def _layer(h: float, depth: np.ndarray, base: str = "bonded", poisson: float = 0.5) -> np.ndarray:
    """F / E of depths on a slab: a spline in depth over thickness through the nearest solved pad. [mm2]

    The logarithm goes on straight beyond what was solved, and with the slope of the neighbours from pad to pad.
    """
    rows = [r for r in json.loads(CURVES.read_text()) if r["base"] == base and r["poisson"] == poisson]
    nodes = np.log([r["thickness_mm"] for r in rows])

    def value(row: dict, share: np.ndarray) -> np.ndarray:
        d, f = np.array(row["depth_mm"]), np.array(row["force_over_young_mm2"])
        own = d / row["thickness_mm"]
        curve = CubicSpline(own, np.log(f / d * row["thickness_mm"]), bc_type="natural")
        ask = np.clip(share, own[0], own[-1])
        return curve(ask) + curve(own[-1], 1) * np.maximum(share - own[-1], 0.0)

    near = int(np.argmin(np.abs(nodes - np.log(h))))
    share = np.maximum(depth, 0.0) / h
    low, high = max(near - 1, 0), min(near + 1, len(rows) - 1)
    seen = np.minimum(share, 0.22)
    slope = (value(rows[high], seen) - value(rows[low], seen)) / (nodes[high] - nodes[low])
    return np.exp(value(rows[near], share) + slope * (np.log(h) - nodes[near])) / h * np.maximum(depth, 0.0)


def _elastic(h: float, depth: np.ndarray, put: dict[str, float]) -> np.ndarray:
    """F / E of depths with what changes the elastic law. [mm2]"""
    true = h + put.get("thickness_error", 0.0)

    def flat(d: np.ndarray) -> np.ndarray:
        force = _layer(true, d)
        share = np.maximum(d, 0.0) / true
        if put.get("compressibility"):
            give = force / np.maximum(_layer(true, d, "bonded", 0.47), 1e-12)
            force = force / (1.0 + put["compressibility"] / 0.03 * np.where(d > 0, give - 1.0, 0.0))
        if put.get("base_slip"):
            loose = _layer(true, d, "sliding")
            force = force + put["base_slip"] * (1.0 - np.exp(-share / 0.08)) * (loose - force)
        force = force * (1.0 + put.get("strain_stiffening", 0.0) * 0.09 * (share / 0.3) ** 2.5)
        force = force * (1.0 + put.get("skin", 0.0) * np.exp(-(((np.maximum(d, 0.0) - 0.9) / 0.5) ** 2)))
        return force * (1.0 + put.get("bottom_felt", 0.0) * (share / 0.25) ** 4 / (1.0 + (share / 0.25) ** 4))

    grid = np.linspace(-1.0, 0.45 * h, 1500)
    if put.get("punch_tilt"):
        # chords of a round face
        at, weight = np.polynomial.chebyshev.chebgauss(15)
        weight = weight * (1.0 - at**2)
        lever = 7.9 * np.tan(np.radians(put["punch_tilt"])) * at
        table = sum(w * flat(grid + u) for u, w in zip(lever, weight)) / weight.sum()
    else:
        table = flat(grid)
    return np.interp(depth, grid, table)


def _motion(v: float, depth: float, unloads: bool, hold_s: float, rng: np.random.Generator) -> tuple:
    """Even time, position of the punch, place of stop and of the way back: a stop of constant braking."""
    brake_s = min(0.02, depth / v)
    lead_s = 0.15
    stop_s = lead_s + (depth - 0.5 * v * brake_s) / v + brake_s
    way_s = (depth + 1.5) / 20.0 if unloads else 0.0
    time = np.arange(0.0, stop_s + hold_s + way_s, STEP_S)
    ahead = np.maximum(stop_s - time, 0.0)
    x = np.where(ahead > brake_s, v * (time - lead_s), depth - 0.5 * v / brake_s * ahead**2)
    x = x + 0.003 * np.sin(2 * np.pi * time / rng.uniform(6.0, 15.0)) * np.clip((time - stop_s) / 0.5, 0.0, 1.0)
    end = np.searchsorted(time, stop_s + hold_s)
    if unloads:
        x[end:] = x[end - 1] - 20.0 * (time[end:] - time[end - 1])
    return time, x, int(np.searchsorted(time, stop_s)), end


def _arm(elastic: np.ndarray, tau: np.ndarray, weight: np.ndarray | float, parts: list[slice]) -> np.ndarray:
    """Force of one arm of unit strength, ``tau`` of each part of the press: a one-pole filter of the rise."""
    rise = np.diff(elastic, prepend=0.0) * weight
    out, last = np.zeros_like(elastic), 0.0
    for part, t in zip(parts, tau):
        keep = np.exp(-STEP_S / t)
        if part.stop > part.start:
            out[part] = lfilter([np.sqrt(keep)], [1.0, -keep], rise[part], zi=[keep * last])[0]
            last = out[part.stop - 1]
    return out


def write_campaign(
    folder: Path,
    effects: tuple[tuple[str, float], ...],
    seed: int,
    held_out: bool = False,
    usual_pads: bool = False,
    cutoff_hz: float = 50.0,
) -> Truth:
    """Write a campaign; the same seed has the same material, machine and signs with and without ``held_out``.

    With ``usual_pads`` no pad has a factor of its own and no press a contact of its own. ``cutoff_hz`` is that
    of the sensor, which the file says is 50.
    """
    own, rng = np.random.default_rng([seed, 101]), np.random.default_rng([seed, 102 + held_out])
    young = float(np.exp(own.uniform(np.log(20.0), np.log(70.0)))) * 1e-3
    nominal = young * own.uniform(0.93, 1.07)
    tau = np.array([np.exp(own.uniform(np.log(0.03), np.log(0.1))), np.exp(own.uniform(0.0, np.log(2.8)))])
    beta = own.uniform(0.12, 0.45, 2)
    top_N, noise_N, slow_N = own.uniform(8.0, 13.0), own.uniform(0.02, 0.04), own.uniform(0.01, 0.025)
    put = {name: size * (own.choice([-1.0, 1.0]) if name in TWO_SIGNED else 1.0) for name, size in effects}
    plan = _plan(rng, top_N, held_out)
    scatter = 0.0 if usual_pads else 0.004
    pads = {h: scatter * rng.standard_normal(3) for h in np.unique(plan.thickness_mm)}
    depths, presses, squares = [], [], []
    for k, h in enumerate(plan.thickness_mm):
        grid = np.linspace(0.01, 1.0, 200) * _solved_mm(h)
        force = nominal * _layer(h, grid)
        depths.append(float(np.interp(min(plan.target_N[k], 0.97 * force[-1]), force, grid)))
        plan.target_N[k] = round(float(np.interp(depths[-1], grid, force)), 2)
    for k in range(len(depths)):
        presses.append(_press(k, plan, depths, put, young, tau, beta, pads, scatter, rng))
    largest = max(float(force.max()) for _, _, force in presses)
    folder.mkdir(parents=True, exist_ok=True)
    lines = [
        "schema = 1",
        f'name = "{folder.name}"',
        "[pad]",
        "ratio = 15.0",
        f"young_kPa_nominal = {1e3 * nominal:.2f}",
        "length_mm = 150.0",
        "width_mm = 120.0",
        'base = "bonded"',
        "[punch]",
        'shape = "round"',
        "diameter_mm = 15.8",
        "edge_radius_mm = 0.5",
        'contact = "bonded"',
        "[sensor]",
        "lowpass_hz = 50.0",
        "lowpass_order = 2",
        "lowpass_passes = 1",
        "force_resolution_N = 0.01",
    ]
    for k, (time, x, force) in enumerate(presses):
        signal = _read(time, force, put, PEAK * top_N, cutoff_hz)
        stop = int(np.argmax(x >= 0.999 * x.max()))
        save = np.unique(np.r_[np.arange(0, min(stop + 2000, len(time)), 4), np.arange(stop, len(time), 40)])
        away = np.flatnonzero(x[stop + 4000 :] < 0.98 * x[stop])
        if len(away):
            save = np.unique(np.r_[save, np.arange(stop + 4000 + away[0], len(time), 8)])
        t, one = time[save], signal[save]
        slow = lfilter([1.0], [1.0, -np.exp(-0.01 / 1.2)], rng.standard_normal(int(t[-1] / 0.01) + 2))
        slow = slow_N * slow * np.sqrt(1.0 - np.exp(-0.02 / 1.2))
        noise = rng.normal(0.0, noise_N, len(t)) + np.interp(t, 0.01 * np.arange(len(slow)), slow)
        squares.append(noise**2)
        shown = np.round(np.minimum(one + noise, _limit(put, largest)), 2)
        place = np.round(x[save] / 0.002) * 0.002
        name = f"press_{k + 1:02d}.csv"
        table = "\n".join(f"{a:.5f},{b:.4f},{c:.2f}" for a, b, c in zip(t, place, shown))
        (folder / name).write_text("time_s,displacement_mm,force_N\n" + table + "\n")
        lines += [
            "[[trial]]",
            f'file = "{name}"',
            f"thickness_mm = {plan.thickness_mm[k]}",
            f"velocity_mm_s = {plan.speed_mm_s[k]}",
            "hold_s = 8.0",
            f"target_force_N = {plan.target_N[k]}",
            f"repeat = {plan.repeat[k]}",
            f"sequence = {k + 1}",
            f"rest_s = {plan.rest_s[k]}",
            f"temperature_C = {plan.temperature_C[k]}",
            f"age_days = {plan.age_days[k]}",
        ]
    (folder / "campaign.toml").write_text("\n".join(lines) + "\n")
    return Truth(put, 1e3 * young, float(np.sqrt(np.mean(np.concatenate(squares)))))


def _press(k, plan, depths, put, young, tau, beta, pads, scatter_mm, rng) -> tuple:
    """Time, position and force on the sensor's pad side of one trial."""
    h, v = plan.thickness_mm[k], plan.speed_mm_s[k]
    time, x, stop, end = _motion(v, depths[k], bool(plan.unloads[k]), 8.0, rng)
    same_pad = [j for j in range(k) if plan.thickness_mm[j] == h]
    dent = put.get("contact_offset", 0.0) + scatter_mm * rng.standard_normal()
    for j in same_pad:
        since = plan.rest_s[j + 1 : k + 1].sum() + 10.0 * (k - j)
        dent += 0.7 * put.get("incomplete_recovery", 0.0) * depths[j] * (1.0 + since / 150.0) ** -1.5
    warm, age = plan.temperature_C[k] - 23.0, plan.age_days[k]
    scale = np.exp(-put.get("temperature", 0.0) * warm)
    scale *= 1.0 + put.get("ageing", 0.0) * 1.6 * (1.0 - np.exp(-(age - 7.0) / 12.0))
    scale *= 1.0 + put.get("cold_stiffening", 0.0) / (1.0 + np.exp((warm + 1.0) / 0.4))
    level, slope, curve = pads[h]
    back = v if not put.get("rate_dependent_viscosity") else 20.0
    speeds = np.array([v, back])
    thin = ((speeds**2 + 15.0**2) / (50.0**2 + 15.0**2)) ** (-0.5 * put.get("rate_dependent_viscosity", 0.0))
    slower = np.exp(-2.0 * put.get("temperature", 0.0) * warm)
    flow = (h / 10.0) ** (1.5 * put.get("flow_through", 0.0))
    arms = [(t * s, 0.5 * b) for t, b in zip(tau * [1.0, flow], beta) for s in (1.15, 1.0 / 1.15)]
    for name, middle in (("slow_relaxation_mode", 20.0), ("fast_relaxation_mode", 0.010)):
        if put.get(name):
            arms += [(middle * s, put[name] * w) for s, w in ((0.5, 0.25), (1.0, 0.5), (2.0, 0.25))]
    parts = [slice(0, end), slice(end, len(time))]
    give = np.zeros_like(x)
    for _ in range(12 if put.get("machine_compliance") else 1):
        depth = x - dent - give
        share = np.maximum(depth, 0.0) / h
        elastic = young * scale * _elastic(h, depth, put) * (1.0 + level + slope * share / 0.4 + curve * share**2)
        if put.get("softening_with_cycles"):
            past = [(depth - depths[j]) / (0.06 * depths[j]) for j in same_pad]
            count = sum(0.5 - 0.5 * t / np.sqrt(1.0 + t**2) for t in past)
            elastic = elastic * (1.0 - put["softening_with_cycles"] * (1.0 - 0.55**count) / 0.45)
        growth = put.get("strain_dependent_relaxation", 0.0) * (share - 0.15)
        weight = 1.0 + growth / (1.0 + 0.3 * np.abs(growth))
        force = elastic + sum(b * _arm(elastic, t * thin * slower, weight, parts) for t, b in arms)
        if put.get("machine_compliance"):
            give = 0.5 * (give + put["machine_compliance"] * 8.0 * (np.maximum(force, 0.0) / 8.0) ** 0.85)
    since = np.maximum(time - time[stop], 0.0)
    force = force * (1.0 - put.get("creeping_hold", 0.0) * np.log1p(since) / np.log(10.0))
    # what adheres carries tension up to a limit that falls off above the surface; below it the edge pulls already
    pull = put.get("adhesion", 0.0) * (np.arange(len(time)) >= end)
    edge = 0.4 * np.exp(-np.maximum(depth, 0.0) / 0.25)
    force = np.maximum(force - pull * edge, -pull * np.exp(-((np.minimum(depth, 0.0) / 0.4) ** 2)))
    if put.get("friction_hysteresis"):
        force = force * (1.0 + put["friction_hysteresis"] * _dahl(x))
    acceleration = np.gradient(np.gradient(x, STEP_S), STEP_S) * (time < time[end - 1])
    force = force + put.get("inertia", 0.0) * 1e-3 * acceleration
    force = force + put.get("force_bias", 0.0) + put.get("force_drift", 0.0) * 1.2 * time**0.9
    return time, x, force


def _dahl(x: np.ndarray) -> np.ndarray:
    """Dahl's friction of a path: from 0 to 1 on the way in, to -1 on the way back, within some 0.1 mm."""
    out, state = np.zeros_like(x), 0.0
    for k, move in enumerate(np.diff(x), 1):
        toward = 1.0 if move > 0 else -1.0
        state = toward + (state - toward) * np.exp(-abs(move) / 0.06)
        out[k] = state
    return out


def _limit(put: dict[str, float], largest: float) -> float:
    return largest / (1.0 + 0.35 * put["sensor_clipping"]) if put.get("sensor_clipping") else np.inf


def _read(time: np.ndarray, force: np.ndarray, put: dict[str, float], full: float, cutoff_hz: float) -> np.ndarray:
    """The declared filter, the stages that nobody declared, clock, and the curve of an amplifier of this full load."""
    b, a = butter(2, cutoff_hz, fs=1.0 / STEP_S)
    signal = lfilter(b, a, force - force[0]) + force[0]
    lag = put.get("sensor_lag", 0.0)
    for pole in (0.8 * lag, 0.2 * lag) if lag else ():
        b, a = bilinear([1.0], [pole, 1.0], fs=1.0 / STEP_S)
        signal = lfilter(b, a, signal - signal[0]) + signal[0]
    if put.get("time_skew"):
        signal = np.interp(time - put["time_skew"] - 5e-5 * time, time, signal)
    signal = signal * (1.0 + put.get("sensor_square", 0.0) * signal)
    return signal * (1.0 + put.get("sensor_cube", 0.0) * (signal / full) ** 2)
