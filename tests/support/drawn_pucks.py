"""Pucks between dry plates, drawn: rubber of five laws, plates that rub, specimens that differ. No code of the loop.

Friction is by finite elements (the stored table, whose laws are Ogden's); closed forms are of a puck that slips freely.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.pad.tables.puck import grip, table_for, uniaxial

DIAMETER_MM, SPEED_MM_S, RATE_HZ, NOISE_N = 50.0, 1.0 / 6.0, 2.0, 0.02
SCATTER, FACES_MM = 0.015, 0.1  # standard deviations of a specimen's stiffness and of its contact
DEEPEST = {30.0: 0.5, 15.0: 0.45}
KINDS = ("none", "friction", "stiffening", "both")

HEAD = f"""schema = 1
name = "pucks"
[pad]
young_kPa_nominal = 40.0
shape = "cylinder"
diameter_mm = {DIAMETER_MM:g}
[punch]
shape = "plate"
contact = "frictionless"
"""
TRIAL = """[[trial]]
file = "{file}"
thickness_mm = {height:g}
velocity_mm_s = {speed:.4f}
repeat = {repeat}
"""


@dataclass(frozen=True)
class Rubber:
    """A law by name and its parameter, modulus and friction of the plates. [MPa]"""

    law: str
    parameter: float
    young_MPa: float
    friction: float

    def stress(self, compression: NDArray) -> NDArray:
        """Nominal stress of free compression. [MPa]"""
        stretch = 1.0 - compression
        neo = (stretch**-2 - stretch) / 3.0
        rise = stretch**2 + 2.0 / stretch - 3.0  # first invariant less three
        by_law = {
            "ogden": lambda p: uniaxial(p, compression),
            "mooney": lambda p: (1.0 - p) * neo + p * (stretch**-3 - 1.0) / 3.0,
            "gent": lambda p: neo * p / (p - rise),
            "yeoh": lambda p: neo * (1.0 + 2.0 * p * rise),
        }
        return self.young_MPa * by_law[self.law](self.parameter)

    def force_N(self, depth_mm: NDArray, height_mm: float) -> NDArray:
        """Force of a puck pressed so deep. [N]"""
        compression = np.maximum(depth_mm, 0.0) / height_mm
        alpha = self.parameter if self.law == "ogden" else 2.0
        held = table_for(DIAMETER_MM, height_mm).factor(alpha, float(grip(self.friction)), compression)
        return 0.25 * math.pi * DIAMETER_MM**2 * self.stress(compression) * held


def draw_rubber(kind: str, chance: np.random.Generator) -> Rubber:
    """Rubber and plates of a kind: neo-Hookean unless it stiffens, without friction unless it rubs."""
    young = 1e-3 * float(np.exp(chance.uniform(np.log(20.0), np.log(150.0))))
    friction = float(np.exp(chance.uniform(np.log(0.15), np.log(0.6)))) if kind in ("friction", "both") else 0.0
    law, parameter = "ogden", 2.0
    if kind == "both":  # the table of friction is of Ogden's laws
        parameter = float(chance.uniform(3.0, 6.0))
    elif kind == "stiffening":
        law, low, high = (("ogden", 3.0, 6.0), ("gent", 2.5, 6.0), ("yeoh", 0.05, 0.25), ("mooney", 0.3, 0.9))[
            int(chance.integers(4))
        ]
        parameter = float(chance.uniform(low, high))
    return Rubber(law, parameter, young, friction)


def press_pucks(folder: Path, rubber: Rubber, heights_mm: Sequence[float], chance: np.random.Generator) -> Campaign:
    """Write and read a campaign of two specimens of each height."""
    folder.mkdir(parents=True)
    text = HEAD
    for height in heights_mm:
        for repeat in (1, 2):
            way = np.arange(-2.0, DEEPEST[height] * height, SPEED_MM_S / RATE_HZ)
            force = rubber.force_N(way - FACES_MM * chance.normal(), height) * np.exp(SCATTER * chance.normal())
            force = force + NOISE_N * chance.normal(size=len(way))
            file = f"h{height:g}_{repeat}.csv"
            rows = "\n".join(f"{at / RATE_HZ:.3f},{x:.5f},{f:.5f}" for at, (x, f) in enumerate(zip(way, force)))
            (folder / file).write_text(f"time_s,displacement_mm,force_N\n{rows}\n")
            text += TRIAL.format(file=file, height=height, speed=SPEED_MM_S, repeat=repeat)
    (folder / "campaign.toml").write_text(text)
    return read_campaign(folder)
