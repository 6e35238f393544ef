"""Simulated campaigns with one undeclared effect, written as folders; shares no code with the effect classes.

Motion, relaxation, filter and noise are integrated here; the elastic law comes from direct finite-element solves
(``force_curves.json``), off by half a per cent from pad to pad; crowned pads likewise, on finer cells than the
package's (``crowned_curves.json``). Most effects have another functional form than
the class that must find them (noted beside each).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.support.campaign_press import Pad, Physics, butterworth, pad_force
from tests.support.campaign_signal import as_saved, at_the_pad, at_the_punch, slow_noise

# Usual size of each effect (the middle strength); the sign is drawn where two signs make sense.
SIZES = {
    "contact_offset": 0.05,
    "machine_compliance": 0.004,
    "punch_tilt": 2.0,
    "base_slip": 0.15,
    "compressibility": 0.012,  # 1/2 - nu; table by elements, parabola in nu
    "thickness_error": 0.3,
    "strain_stiffening": 0.8,  # exp(c strain^2)
    "strain_dependent_relaxation": 1.2,  # exp(s (strain - 0.15))
    "rate_dependent_viscosity": 0.12,  # Cross form
    "slow_relaxation_mode": 0.08,  # two arms about tau
    "fast_relaxation_mode": 0.25,  # two arms about tau
    "softening_with_cycles": 0.04,  # hyperbola in cycles, sharp in depth
    "incomplete_recovery": 0.015,  # hyperbola in time, last press only
    "temperature": 0.008,  # exponential
    "ageing": 0.03,  # power law
    "adhesion": 0.25,  # exponential release
    "inertia": 0.03,
    "friction_hysteresis": 0.04,  # tanh turn
    "force_bias": 0.06,
    "force_drift": 0.008,  # saturating
    "sensor_lag": 0.003,  # two equal poles
    "time_skew": 0.003,
}
TWO_SIGNED = {"contact_offset", "thickness_error", "temperature", "force_bias", "force_drift", "time_skew"}
UNKNOWN = {
    "ringing": 1.0,
    "mains_hum": 0.15,
    "poroelastic": 1.0,
    "stiffness_bump": 0.12,
    "saturation": 1.0,
    "load_drop": 0.35,
    "gain_scatter": 0.02,
}
CROWN = "crowned:radius=20,height=3,foot=11"
SLABS, CROWNS = ((5.0, 15.0, 20.0), 10.0), ((7.0, 10.0, 14.0), 12.0)
"""Thicknesses of a campaign, and the further one of the campaign that is held out."""
SLOW_TAU_S, FAST_TAU_S, RECOVERY_TAU_S = 20.0, 0.010, 120.0


@dataclass(frozen=True)
class Truth:
    """What was put in: effect, size (in the units of the vocabulary), floor of the noise, true modulus."""

    effect: str
    size: float
    floor_N: float
    young_kPa: float


@dataclass(frozen=True)
class CastPads:
    """How pads of one recipe differ (standard deviations), what is read of them, and whether the campaign says it."""

    thickness_mm: float = 0.12
    ln_young: float = 0.05
    gauge_mm: float = 0.05
    witness: float = 0.02
    recorded: bool = True

    def pad(self, seed: int, held_out: bool, h: float, young_kPa: float) -> tuple[float, float, str]:
        """Thickness and factor of the modulus of a pad, and the lines that its trials carry."""
        rng = np.random.default_rng([seed, 6, held_out, round(100 * h)])
        thickness, factor = h + rng.normal(0, self.thickness_mm), float(np.exp(rng.normal(0, self.ln_young)))
        read = thickness + rng.normal(0, self.gauge_mm)
        witness = young_kPa * factor * float(np.exp(rng.normal(0, self.witness)))
        lines = (
            f"thickness_mm = {read:.3f}\nthickness_sd_mm = {self.gauge_mm}\ndesign_thickness_mm = {h}\n"
            f"witness_kPa = {witness:.4f}\nwitness_sd_kPa = {self.witness * witness:.4f}"
        )
        return thickness, factor, lines if self.recorded else f"thickness_mm = {h}"


def conditions(rng: np.random.Generator, held_out: bool, thicknesses: tuple = SLABS) -> list[dict]:
    """Trials with sequence, rest, age and temperature, in the order they are run."""
    pads, further = thicknesses
    if held_out:
        pads = sorted((*pads, further))
        speeds, levels, days = (10.0, 50.0, 250.0), (0.45, 0.8), (11.0, 37.0)
        wanted = [(h, v, f) for h in pads for v in speeds for f in levels]
    else:
        levels, days = (0.27, 0.58, 1.0), (9.0, 14.0, 29.0)
        wanted = [(h, v, f) for h in pads for v in (10.0, 250.0) for f in levels for _ in range(2)]
    rng.shuffle(wanted)
    rows, seen, sequence = [], {}, 0
    for day, group in zip(days, np.array_split(np.arange(len(wanted)), len(days))):
        block = [wanted[i] for i in group]
        order = list(rng.permutation(sorted({b[0] for b in block})))
        for h in order:
            fresh = True
            for _, v, f in [b for b in block if b[0] == h]:
                sequence += 1
                key = (h, v, f)
                seen[key] = seen.get(key, 0) + 1
                rows.append(
                    {
                        "h": h,
                        "v": v,
                        "level": f,
                        "repeat": seen[key],
                        "sequence": sequence,
                        "rest": 3600.0 if fresh else 60.0,
                        "age": day,
                        "temperature": round(rng.uniform(20, 27), 1),
                        "unload": rng.random() < 1 / 3,
                        "day_first": fresh,
                    }
                )
                fresh = False
    return rows


def motion(row: dict, depth: float, deceleration: float, rng: np.random.Generator) -> tuple:
    """Fine grid, true position and the sampling of one trial. Returns time, x, away, save mask, acceleration."""
    v = row["v"]
    brake = min(v / deceleration, 2 * depth / v)
    slow_down = v / brake
    reach = 0.5 * v * brake
    before = 0.1
    lead = before * v
    stop = (lead + depth - reach) / v + brake
    fine = np.arange(0.0, stop + 0.4, 5e-4)
    coarse = np.arange(fine[-1] + 5e-3, stop + 10.0, 5e-3)
    end = coarse[-1]
    back = np.arange(end + 1e-3, end + (depth + 2.0) / 10.0, 1e-3) if row["unload"] else np.zeros(0)
    time = np.r_[fine, coarse, back]
    t1 = stop - brake
    x = np.where(time < t1, v * time - lead, depth - 0.5 * slow_down * np.maximum(stop - time, 0.0) ** 2)
    wander = np.cumsum(rng.normal(0, 1, 40))
    wander = 0.004 * (wander - wander[0]) / np.sqrt(10)
    x = x + np.interp(time, stop + np.linspace(0, 10.5, 40), wander) * np.clip((time - stop) / 0.3, 0, 1)
    away = time > end
    x = np.where(away, np.minimum(x, x[len(fine) + len(coarse) - 1] - 10.0 * (time - end)), x)
    save = np.zeros(len(time), bool)
    save[: len(fine) : 2] = True
    save[len(fine) + 3 : len(fine) + len(coarse) : 4] = True
    save[len(fine) + len(coarse) + 3 :: 4] = True
    # mean about each grid point, so that the pulse takes off the whole speed wherever it begins
    middle = np.r_[time[0], 0.5 * (time[1:] + time[:-1]), time[-1]]
    acceleration = -slow_down * np.diff(np.clip(middle, t1, stop)) / np.diff(middle)
    return time, x, away, save, acceleration


def write_campaign(
    folder: Path,
    effect: str,
    size: float,
    seed: int,
    held_out: bool = False,
    level_error: float = 0.005,
    more: tuple[tuple[str, float], ...] = (),
    crowned: bool = False,
    rows: list[dict] | None = None,
    cast: str | None = None,
    edge_mm: float = 0.0,
    declared: bool = True,
    cast_pads: CastPads | None = None,
    cutoff_hz: float = 35.0,
) -> Truth:
    """Write a campaign with one effect of the given size; the same seed has the same material in both roles.

    ``more`` are further effects with their sizes, acting together with the first. ``crowned`` pads are pressed by a
    round punch of the same area; they are solved glued and incompressible, and a tilt has no toe on them.
    ``rows`` are planned presses (h, v, target in N, repeat, sequence, rest, age, temperature, unload) in place of the
    usual ones; a pad pressed in several such campaigns of one seed is the same pad. ``cast`` is what [pad] says it was
    cast of (lines of TOML). ``edge_mm`` is a fillet of the punch that presses crowned pads, 0 or 0.4; the file says so
    when it is ``declared``. ``cast_pads`` gives each pad a thickness and a modulus of its own, and a record.
    ``cutoff_hz`` is that of the sensor, which the file says is 35.
    """
    if edge_mm and not crowned:
        raise ValueError("the fillet is solved for crowned pads")
    if crowned and {effect, *(name for name, _ in more)} & {"base_slip", "compressibility", "punch_tilt"}:
        raise ValueError("slip of the base, compressibility and tilt are not made for crowned pads")
    material = np.random.default_rng([seed, 1])
    rng = np.random.default_rng([seed, 2 + held_out])
    young = float(np.exp(material.uniform(np.log(18.0), np.log(60.0)))) * 1e-3
    nominal = young * 1e3 * material.uniform(0.92, 1.08)
    tau = np.array([np.exp(material.uniform(np.log(0.03), np.log(0.1))), np.exp(material.uniform(0.0, np.log(2.8)))])
    beta = material.uniform(0.12, 0.5, 2)
    slow_time = material.uniform(0.5, 2.0)
    deceleration = material.uniform(8000.0, 25000.0)
    sign = 1.0 if material.random() < 0.5 or effect not in TWO_SIGNED else -1.0
    top_force = material.uniform(9.0, 14.0)
    effects = {effect: size * sign}
    for place, (name, amount) in enumerate(more):
        turned = np.random.default_rng([seed, 10 + place]).random() < 0.5 and name in TWO_SIGNED
        effects[name] = -amount if turned else amount
    kinds = CROWNS if crowned else SLABS
    planned = rows is not None
    if rows is None:
        rows = conditions(rng, held_out, kinds)
        pads = {t: rng.normal(0, level_error, 2) for t in sorted((*kinds[0], kinds[1]))}
    else:
        rng = np.random.default_rng([seed, 4, len(rows), round(100 * sum(row["h"] for row in rows))])
        pads = {
            row["h"]: np.random.default_rng([seed, 5, round(100 * row["h"])]).normal(0, level_error, 2) for row in rows
        }
    h = np.array([row["h"] for row in rows])
    own = {"crown": crowned, "edge_mm": edge_mm}
    of_pad = {t: (t, 1.0, f"thickness_mm = {t}") for t in pads}
    if cast_pads is not None:
        of_pad = {t: cast_pads.pad(seed, held_out, t, 1e3 * young) for t in pads}
    for row in rows:
        row["declared"] = of_pad[row["h"]][2]
    real, factor = (np.array([of_pad[t][k] for t in h]) for k in (0, 1))
    pad = Pad(real, np.array([pads[t][0] for t in h]), np.array([pads[t][1] for t in h]), **own)
    share = np.linspace(0.0, 0.42, 85)
    depths = []
    for i, row in enumerate(rows):
        one = Pad(h[i : i + 1].repeat(85), np.zeros(85), np.zeros(85), **own)
        force = nominal * 1e-3 * one.force(share * row["h"])
        target = min(row["target"] if planned else row["level"] * top_force, row.get("level", 0.95) * force[-1])
        depths.append(float(np.interp(target, force, share * row["h"])))
        row["target"] = round(target, 2)
    moved = [motion(row, depth, deceleration, rng) for row, depth in zip(rows, depths)]
    longest = max(len(m[0]) for m in moved)

    def stacked(index: int) -> np.ndarray:
        return np.stack([np.r_[m[index], np.full(longest - len(m[index]), m[index][-1])] for m in moved])

    time, x, away = stacked(0), stacked(1), stacked(2).astype(bool)
    time = time + np.maximum(np.arange(longest) - np.array([[len(m[0]) - 1] for m in moved]), 0) * 1e-3
    physics = _physics(effects, young, tau, beta, pad, rows, np.array(depths), rng)
    physics.young = physics.young * factor
    force = pad_force(time, x, away, physics)
    force = at_the_pad(effects, force)
    before = np.stack([at_the_punch(effects, t, f, a) for t, f, a in zip(time, force, stacked(4))])
    signal = butterworth(time, before, cutoff_hz, effects.get("sensor_lag", 0.0))
    cast = "\n".join([*([cast] if cast else []), *([f'shape = "{CROWN}"'] if crowned else [])])
    punch = [f"edge_radius_mm = {edge_mm}"] if edge_mm and declared else []
    return _write(folder, effects, rows, moved, signal, nominal, young, slow_time, rng, crowned, cast, punch)


def _physics(effects, young, tau, beta, pad, rows, depths, rng) -> Physics:
    """Turn the effect into what acts during the trials."""
    count = len(rows)
    age = np.array([r["age"] for r in rows])
    warm = np.array([r["temperature"] for r in rows]) - 23.0
    speed = np.array([r["v"] for r in rows])
    scale, offset = np.ones(count), rng.normal(0, 0.004, count)
    taus, betas = np.repeat(tau[:, None], count, 1), np.repeat(beta[:, None], count, 1)
    extra: dict = {}
    for effect, size in effects.items():
        match effect:
            case "contact_offset":
                offset = offset + size
            case "machine_compliance":
                extra["compliance"] = size
            case "punch_tilt":
                pad.tilt_deg = size
            case "base_slip":
                pad.slip = size
            case "compressibility":
                pad.poisson = 0.5 - size
            case "thickness_error":
                pad.thickness_error = size
            case "strain_stiffening":
                pad.stiffening = size
            case "stiffness_bump":
                pad.bump = size
            case "strain_dependent_relaxation":
                extra["beta_strain"] = size
            case "rate_dependent_viscosity":
                taus = taus * ((1.0 + speed / 20.0) / (1.0 + 50.0 / 20.0)) ** (-size)
            case "poroelastic":
                taus = taus * np.array([1.0, 1.0])[:, None]
                taus[1] = taus[1] * (pad.thickness / 13.0) ** (1.2 * size)
                betas[1] = betas[1] * (pad.thickness / 13.0) ** (-0.4 * size)
            case "slow_relaxation_mode" | "fast_relaxation_mode":
                middle = SLOW_TAU_S if effect.startswith("slow") else FAST_TAU_S
                more = np.array([middle / 1.4, middle * 1.4])
                taus = np.concatenate([taus, np.repeat(more[:, None], count, 1)])
                betas = np.concatenate([betas, np.full((2, count), 0.5 * size)])
            case "temperature":
                scale = scale * np.exp(-size * warm)
            case "ageing":
                scale = scale * (age / 7.0) ** np.log2(1.0 + size)
            case "softening_with_cycles":
                extra["softening"] = size
                extra["soft_depth"] = [
                    np.array([depths[k] if k < i and rows[k]["h"] == rows[i]["h"] else 0.0 for i in range(count)])
                    for k in range(count)
                ]
            case "incomplete_recovery":
                last: dict = {}
                for i, row in enumerate(rows):
                    if row["h"] in last:
                        offset[i] += size * depths[last[row["h"]]] / (1.0 + row["rest"] / RECOVERY_TAU_S)
                    last[row["h"]] = i
            case "adhesion":
                extra["pull_off"] = size
            case "friction_hysteresis":
                extra["friction"] = size
            case "gain_scatter":
                scale = scale * (1.0 + rng.normal(0, size, count))
    return Physics(young * scale, taus, betas, pad, offset, **extra)


def _write(folder, effects, rows, moved, force, nominal, young, slow_time, rng, crowned, cast, punch) -> Truth:
    folder.mkdir(parents=True, exist_ok=True)
    lines = [
        "schema = 1",
        f'name = "{folder.name}"',
        "[pad]",
        "ratio = 15.0",
        f"young_kPa_nominal = {nominal:.2f}",
        *([cast] if cast else []),
        "length_mm = 150.0",
        "width_mm = 120.0",
        'base = "bonded"',
        "[punch]",
        *punch,
        *(
            ['shape = "round"', f"diameter_mm = {28.0 / np.sqrt(np.pi):.6f}"]
            if crowned
            else ['shape = "square"', "side_mm = 14.0"]
        ),
        'contact = "bonded"',
        "[sensor]",
        "lowpass_hz = 35.0",
        "lowpass_order = 2",
        "lowpass_passes = 1",
        "force_resolution_N = 0.01",
    ]
    squares, samples = 0.0, 0
    for i, (row, (time, x, _away, save, _)) in enumerate(zip(rows, moved)):
        signal = as_saved(effects, time, force[i, : len(time)], rng)[save]
        t = time[save]
        noise = rng.normal(0, 0.03, len(t)) + slow_noise(t, 0.02, slow_time, rng)
        squares, samples = squares + float((noise**2).sum()), samples + len(t)
        saved = np.round(signal + noise, 2)
        place = np.round((x[save] + 0.0) / 0.005) * 0.005
        name = f"trial_{i + 1:02d}.csv"
        table = "\n".join(f"{a:.4f},{b:.3f},{c:.2f}" for a, b, c in zip(t, place, saved))
        (folder / name).write_text("time_s,displacement_mm,force_N\n" + table + "\n")
        lines += [
            "[[trial]]",
            f'file = "{name}"',
            row["declared"],
            f"velocity_mm_s = {row['v']}",
            "hold_s = 10.0",
            f"target_force_N = {row['target']}",
            f"repeat = {row['repeat']}",
            f"sequence = {row['sequence']}",
            f"rest_s = {row['rest']}",
            f"temperature_C = {row['temperature']}",
            f"age_days = {row['age']}",
        ]
    (folder / "campaign.toml").write_text("\n".join(lines) + "\n")
    effect, size = next(iter(effects.items()))
    shown = 0.5 - size if effect == "compressibility" else size
    return Truth(effect, shown, float(np.sqrt(squares / samples)), young * 1e3)
