"""Press a planned campaign of any set-up: the force that ``predict`` solves, two arms, noise; nothing of the loop."""

from __future__ import annotations

import tomllib
from functools import lru_cache
from pathlib import Path

import numpy as np

from dummydesign.geometry.punch import ball_profile, read_profile
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.pad_under_punch import Pad, Puck

ARMS = (PronyTerm(0.05, 0.3), PronyTerm(1.5, 0.2))


@lru_cache(maxsize=8)
def _curve(pad: Pad | Puck, deepest_mm: float):
    return elastic_curve(pad, "axisymmetric", deepest_mm)


def press_set_up(folder: Path, young_kPa: float, seed: int = 1, noise_N: float = 0.02) -> None:
    """Write the traces of all trials of a campaign of one shape that was planned by depth."""
    path = folder / "campaign.toml"
    text = path.read_text()
    data = tomllib.loads(text)
    draw = np.random.default_rng([seed, 55])
    for trial in data["trial"]:
        depth, speed = trial["target_depth_mm"], trial["velocity_mm_s"]
        deepest = max(t["target_depth_mm"] for t in data["trial"])
        curve = _curve(pad_of(data, folder, trial["thickness_mm"], 1e-3 * young_kPa), 1.05 * deepest)
        press = ramp_and_hold(speed, depth, trial["hold_s"])
        stop = float(press.time_s[-1]) - trial["hold_s"]
        lead = min(0.1, 20.0 / speed)
        fine = np.arange(-lead, stop + 0.4, max(1e-3, stop / 500.0))
        hold = np.arange(fine[-1] + 0.02, stop + trial["hold_s"], 0.02)
        back = np.arange(hold[-1] + 4e-3, hold[-1] + (depth + 2.0) / 10.0, 4e-3) if trial["unload"] else np.zeros(0)
        time = np.r_[fine, hold, back]
        x = np.interp(time, press.time_s, press.displacement_mm)
        x = np.where(time < 0, speed * time, x)
        x = np.where(time > hold[-1], depth - 10.0 * (time - hold[-1]), x)
        elastic = np.where(x > 0.0, curve.force(np.maximum(x, 1e-9)), 0.0)
        force = np.maximum(relaxed_force(time, elastic, ARMS), 0.0)
        noisy = force + draw.normal(0.0, noise_N, len(time))
        rows = np.column_stack([time - time[0], x, noisy])
        np.savetxt(folder / trial["file"], rows, "%.4f", ",", header="time_s,displacement_mm,force_N", comments="")
    path.write_text(text.replace("# temperature_C =", "temperature_C = 23.0"))


def pad_of(data: dict, folder: Path, thickness_mm: float, young_MPa: float) -> Pad | Puck:
    """The pad and punch of a campaign file."""
    pad, punch = data["pad"], data["punch"]
    if pad.get("shape") == "cylinder":
        return Puck(thickness_mm, young_MPa, pad["diameter_mm"], plates=punch["contact"])
    profile = ball_profile(punch["diameter_mm"]) if punch["shape"] == "ball" else None
    profile = read_profile(folder / punch["file"]) if punch["shape"] == "profile" else profile
    side = punch.get("side_mm")
    radius = profile[0][-1] if profile else side / np.sqrt(np.pi) if side else 0.5 * punch["diameter_mm"]
    return Pad(
        thickness_mm,
        young_MPa,
        float(radius),
        base=pad["base"],
        condition=punch["contact"],
        profile_mm=profile,
        geometry=read_shape(pad["shape"]) if "shape" in pad else Slab(),
        edge_radius_mm=punch.get("edge_radius_mm", 0.0),
        sides_mm=(side, side) if side else None,
    )
