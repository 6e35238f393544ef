"""The paper's three dummies as data: what is not said of them, and what one of them shows when pressed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from dummydesign.geometry.interface import BASES
from dummydesign.measurement.trace import Trace

if TYPE_CHECKING:
    from dummydesign.tissue.model.maxwell_law import Parameters
    from dummydesign.tissue.model.ranges import ForceRange
    from dummydesign.tissue.model.tissue import Tissue

SITES = {"I": ("palm", 15.0), "II": ("thenar", 20.0), "III": ("forefinger", 5.0)}
"""Tissue and thickness [mm] of each dummy (paper, section IV)."""
RESIN, RATIO = "polyurethane-nagoya", 15.0
PUNCH = "square:14"
RADIUS_MM = PUNCH_RADIUS_MM
HELD = {"bonded": "glued", "sliding": "sliding"}
YOUNG_KPA = (15.0, 25.0, 34.0, 50.0)
STIFFENING = (0.0, 0.1, 0.3)
"""c2 / mu of the Yeoh laws; 0 is neo-Hookean."""
FORCES_N, VELOCITIES_MM_S = (5.0, 10.0, 15.0), (10.0, 250.0)
ARM_TAU_S = np.geomspace(1e-3, 10.0, 33)
"""Times of single relaxing arms that are tried for what they add to a peak. [s]"""
STEADY_GRID_N = np.linspace(0.5, 15.0, 146)
STEADY_PARTS_N = {"inside": (0.5, 15.0), "below_5N": (0.5, 5.0), "above_5N": (5.0, 15.0)}
"""Parts of the steady-state range that are reported separately; below 5 N there are no measurements. [N]"""
SAMPLING = Sampling(200, 60, 300)
RATE_HZ, APPROACH_S = 1000.0, 0.03
"""Sampling of the simulated traces and the free way before contact, as a robot's record has them."""


def inside_shares(depth_mm: NDArray, stiff_mm: NDArray, soft_mm: NDArray) -> dict[str, NDArray]:
    """Fraction of steady curves (..., 146) in a range, below 5 N, above 5 N and over both."""
    inside = (depth_mm >= stiff_mm - 1e-9) & (depth_mm <= soft_mm + 1e-9)
    parts = {name: (STEADY_GRID_N >= low) & (STEADY_GRID_N <= high) for name, (low, high) in STEADY_PARTS_N.items()}
    return {f"{name}_fraction": inside[..., part].mean(axis=-1) for name, part in parts.items()}


@dataclass(frozen=True, order=True)
class Variant:
    """What the paper does not say of its dummies: base, modulus at 100:15 [kPa], c2 / mu of the resin."""

    base: str = "bonded"
    young_kPa: float = 25.0
    stiffening: float = 0.0

    def __str__(self) -> str:
        shape = f", c2/mu {self.stiffening:g}" if self.stiffening else ""
        return f"{HELD[self.base]}, {self.young_kPa:g} kPa{shape}"


REFERENCE = Variant()


def variants() -> list[Variant]:
    """All bases, moduli and laws of the study, the paper's 25 kPa on a glued base first."""
    every = [Variant(base, young, c2) for c2 in STIFFENING for base in BASES for young in YOUNG_KPA]
    return sorted(every, key=lambda variant: variant != REFERENCE)


@dataclass(frozen=True)
class PressFigures:
    """One press of a dummy beside the subjects at the same steady force and speed."""

    depth_mm: float
    time_s: NDArray
    force_N: NDArray
    stop_s: float
    band: ForceRange
    inside: dict[str, float]
    trace: Trace

    @property
    def peak_N(self) -> float:
        """Largest force. [N]"""
        return float(self.force_N.max())

    @property
    def peak_position(self) -> float:
        """Place of the peak between the smallest (0) and the largest (1) of the subjects."""
        low, high = self.band.peak_low_N, self.band.peak_high_N
        return (self.peak_N - low) / (high - low)

    def at(self, time_s: float) -> tuple[float, float, float]:
        """Force of the dummy and of the lower and upper edge of the range at a time. [N]"""
        edges = (np.interp(time_s, self.band.time_s, edge) for edge in (self.band.low_N, self.band.high_N))
        return (float(np.interp(time_s, self.time_s, self.force_N)), *(float(edge) for edge in edges))


@dataclass(frozen=True)
class Dummy:
    """One dummy, pressed: depths (NaN out of reach), presses by (steady force, speed), fitted parameters.

    ``arm_weights`` are by speed what an arm of strength 1 and each of the times :data:`ARM_TAU_S` adds to the
    peak at 10 N, over 10 N; missing when 10 N is out of reach.
    """

    name: str
    thickness_mm: float
    tissue: Tissue
    reach_N: float
    depth_mm: NDArray
    presses: dict[tuple[float, float], PressFigures]
    parameters: Parameters | None
    rmse_N: float | None
    arm_weights: dict[float, NDArray]

    @cached_property
    def edges_mm(self) -> tuple[NDArray, NDArray]:
        """Depths of the stiffest and softest subject at the grid of steady forces. [mm]"""
        return self.tissue.steady_depth_range(STEADY_GRID_N)

    @cached_property
    def steady_inside(self) -> dict[str, float]:
        """Share of the steady-state curve inside the range below and above 5 N; out of reach is outside."""
        return {name: float(share) for name, share in inside_shares(self.depth_mm, *self.edges_mm).items()}

    def depth_at(self, force_N: float) -> float:
        """Depth at a steady force, NaN out of reach. [mm]"""
        return float(np.interp(force_N, STEADY_GRID_N, self.depth_mm))

    def position_at(self, force_N: float) -> float:
        """Place in the steady-state range by depth: 0 at the softest subject, 1 at the stiffest."""
        stiff, soft = (float(np.interp(force_N, STEADY_GRID_N, edge)) for edge in self.edges_mm)
        return (soft - self.depth_at(force_N)) / (soft - stiff)

    @property
    def crossing_N(self) -> float:
        """Steady force above which the dummy is softer than the stiffest subject; NaN when never so in reach."""
        softer = np.nonzero(self.depth_mm >= self.edges_mm[0])[0]
        return float(STEADY_GRID_N[softer[0]]) if len(softer) else math.nan

    def exponent(self, low_N: float = 5.0, high_N: float = 10.0) -> float:
        """Mean d ln F / d ln x of the steady curve between two forces; NaN when one is out of reach."""
        return math.log(high_N / low_N) / math.log(self.depth_at(high_N) / self.depth_at(low_N))
