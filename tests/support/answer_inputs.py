"""Inputs of ``tests/answers.py``, made by formulas of their own: the same bytes every time, nothing of the package.

A campaign of two slabs, presses of a tissue, a puck's loading, points, a batch and a ball.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

BRAKING_MM_S2 = 20_000.0
STEP_S = 5e-4

# Force over modulus [mm2] of slabs under the 14 mm punch, glued on both sides, by finite elements (force_curves.json)
SHARES = (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)
SLABS = {
    5.0: (0, 44.9285, 95.4616, 151.846, 214.428, 283.659, 360.226, 445.175, 539.967, 646.479, 767.094),
    10.0: (0, 32.1297, 66.4962, 103.26, 142.577, 184.598, 229.441, 277.283, 328.552, 384.129, 445.276),
}


def motion(velocity_mm_s: float, depth_mm: float, hold_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Even times from 0.1 s before contact, and a ramp that brakes evenly to its stop and holds."""
    brake = min(velocity_mm_s / BRAKING_MM_S2, 2.0 * depth_mm / velocity_mm_s)
    straight = depth_mm / velocity_mm_s - 0.5 * brake
    stop = straight + brake
    t = np.arange(round((0.1 + stop + hold_s) / STEP_S)) * STEP_S - 0.1
    left = np.clip(stop - t, 0.0, None)
    return t, np.where(t < straight, velocity_mm_s * t, depth_mm - 0.5 * velocity_mm_s / brake * left**2)


def save_trace(path: Path, t: np.ndarray, x: np.ndarray, force: np.ndarray) -> None:
    """Every 4th sample to 0.5 s, every 40th later; to 0.1 ms, 1 um and 0.01 N."""
    keep = np.arange(len(t))
    keep = keep[np.where(t < 0.5, keep % 4, keep % 40) == 0]
    rows = "\n".join(f"{t[k]:.4f},{x[k]:.3f},{force[k]:.2f}" for k in keep)
    path.write_text("time_s,displacement_mm,force_N\n" + rows + "\n", encoding="utf-8")


def five_elements(t: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Force of springs gamma x^2, one alone and two in series with dampers; e' = x' - gamma x^2 e / c of each arm."""
    deep = np.clip(x, 0.0, None)
    middle, rise = 0.5 * (deep[1:] + deep[:-1]), np.diff(deep)
    total = 0.09 * deep**3
    for gamma, damper in ((0.03, 1.2), (0.11, 0.08)):
        keep = np.exp(-gamma * middle**2 / damper * np.diff(t))
        stretch = 0.0
        for k in range(len(rise)):
            stretch = keep[k] * stretch + np.sqrt(keep[k]) * rise[k]
            total[k + 1] += gamma * deep[k + 1] ** 2 * stretch
    return total


Arms = tuple[tuple[float, float], ...]
TWO_ARMS: Arms = ((0.06, 0.35), (1.8, 0.25))


def pad_press(t: np.ndarray, x: np.ndarray, thickness_mm: float, young_MPa: float, arms: Arms = TWO_ARMS) -> np.ndarray:
    """Force of a slab with relaxing arms (time, strength), seen through a second-order Butterworth filter of 35 Hz."""
    curve = np.interp(np.clip(x, 0.0, None), np.array(SHARES) * thickness_mm, SLABS[thickness_mm])
    elastic = young_MPa * curve
    force = elastic.copy()
    for tau, beta in arms:
        keep, arm = np.exp(-STEP_S / tau), 0.0
        for k, rise in enumerate(np.diff(elastic)):
            arm = keep * arm + np.sqrt(keep) * beta * rise
            force[k + 1] += arm
    warp = np.tan(np.pi * 35.0 * STEP_S)
    a0 = 1.0 + np.sqrt(2.0) * warp + warp**2
    a1, a2, b = 2.0 * (warp**2 - 1.0) / a0, (1.0 - np.sqrt(2.0) * warp + warp**2) / a0, warp**2 / a0
    out = np.zeros(len(force))
    for k in range(2, len(force)):
        out[k] = b * (force[k] + 2.0 * force[k - 1] + force[k - 2]) - a1 * out[k - 1] - a2 * out[k - 2]
    return out


def make_campaign(folder: Path, arms: Arms = TWO_ARMS) -> None:
    """Twelve presses of two slabs at two speeds whose contact was taken 0.06 mm too early."""
    folder.mkdir()
    lines = [
        "schema = 1",
        'name = "twelve presses"',
        "[pad]",
        "ratio = 15.0",
        "young_kPa_nominal = 30.0",
        "length_mm = 150.0",
        "width_mm = 120.0",
        'base = "bonded"',
        "[punch]",
        'shape = "square"',
        "side_mm = 14.0",
        'contact = "bonded"',
        "[sensor]",
        "lowpass_hz = 35.0",
        "lowpass_order = 2",
        "lowpass_passes = 1",
        "force_resolution_N = 0.01",
    ]
    rng = np.random.default_rng(20260417)
    young_MPa, count = 0.032, 0
    for thickness in (5.0, 10.0):
        for share in (0.12, 0.24, 0.36):
            for velocity in (10.0, 250.0):
                count += 1
                t, x = motion(velocity, share * thickness, 5.0)
                force = pad_press(t, x - 0.06, thickness, young_MPa, arms) + rng.normal(0.0, 0.02, len(t))
                save_trace(folder / f"t{count:02d}.csv", t, x, force)
                target = young_MPa * np.interp(share, SHARES, SLABS[thickness])
                lines += [
                    "[[trial]]",
                    f'file = "t{count:02d}.csv"',
                    f"thickness_mm = {thickness}",
                    f"velocity_mm_s = {velocity}",
                    "hold_s = 5.0",
                    f"target_force_N = {target:.2f}",
                    "repeat = 1",
                    f"sequence = {count}",
                    "rest_s = 120.0",
                    "temperature_C = 23.0",
                    "age_days = 7.0",
                ]
    (folder / "campaign.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")


def make_inputs(folder: Path) -> None:
    """Traces of a tissue, a campaign, a puck's loading, points, a batch and a punch; the same bytes every time."""
    folder.mkdir()
    rng = np.random.default_rng(20260416)
    for k, (velocity, depth) in enumerate(((10.0, 3.6), (10.0, 5.1), (250.0, 3.6), (250.0, 5.1))):
        t, x = motion(velocity, depth, 5.0)
        save_trace(folder / f"press_{k}.csv", t, x, five_elements(t, x) + rng.normal(0.0, 0.03, len(t)))
    make_campaign(folder / "campaign")
    t = np.arange(0.0, 131.0, 0.1)
    stretch = 1.0 - 0.1 * t / 30.0
    load = 0.03 / 3.0 * np.pi * 25.0**2 * (1.0 / stretch**2 - stretch)
    rows = "\n".join(f"{a:.1f},{0.1 * a:.4f},{f:.3f}" for a, f in zip(t, load))
    (folder / "puck.csv").write_text("time_s,displacement_mm,force_N\n" + rows + "\n", encoding="utf-8")
    gammas, depths = (("Subj. 1", 0.05), ("Subj. 2", 0.08)), (2.0, 3.0, 4.0, 5.0)
    rows = [f"{name},{d},{gamma * d**3:.3f}" for name, gamma in gammas for d in depths]
    (folder / "points.csv").write_text("subject,depth_mm,force_N\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (folder / "batch.toml").write_text(
        '[[point]]\nratio = 15.0\nyoung_kPa = {value = 30, low = 28, high = 32, kind = "measured", source = "puck"}\n',
        encoding="utf-8",
    )
    rows = [f"{r},{r * r / 40.0}" for r in range(9)]
    (folder / "ball.csv").write_text("r_mm,z_mm\n" + "\n".join(rows) + "\n", encoding="utf-8")
    (folder / "broken.csv").write_text("time_s,displacement_mm,force_N\n0,0,0\n0.1,x,1\n", encoding="utf-8")
