"""What finite strain makes of the peaks and energies of a pad that is pressed quickly, as ``predict`` allows for it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.scoring.press_simulation import PadBatch, parabolic_work_mJ
from dummydesign.design.scoring.score import press_all
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Readings
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.predict import departure


@dataclass(frozen=True, eq=False)
class FiniteStrain:
    """Finite-strain over quick reading of each of c presses: mean and standard deviation, shapes (2, c).

    The mean is the middle of what the prediction allows for, whose ends are the 95 % of a normal distribution.
    """

    peak: NDArray
    energy: NDArray

    def judged(self, readings: Readings, deviate: ArrayLike = 0.0) -> Readings:
        """Quick readings as pads are judged by them, with the standard normal deviate of each (n,), or of all."""
        own = np.asarray(deviate, float)[..., None]
        peak, energy = (middle + spread * own for middle, spread in (self.peak, self.energy))
        return replace(readings, peak_N=readings.peak_N * peak, energy_mJ=readings.energy_mJ * energy)


# Readings that have no such error.
EXACT = FiniteStrain(np.array([[1.0], [0.0]]), np.array([[1.0], [0.0]]))
# Three deviates, equally likely, that have the mean and the deviation of all; the mean first.
DEVIATES = (0.0, -np.sqrt(1.5), np.sqrt(1.5))


def finite_strain_of(pad: PadBatch, shape: PadShape, base: str, targets: Targets, radius_mm: float) -> FiniteStrain:
    """What finite strain makes of one pad in the presses of a test, by its motion and relaxation at central numbers.

    A press that is out of reach is taken to the pad's depth limit.
    """
    thickness = float(pad.thickness_mm[0])
    prony = [PronyTerm(tau_s=tau, beta=beta) for tau, beta in zip(pad.tau_s, pad.beta[0].tolist())]
    _, presses = press_all(pad, targets, targets.protocol.steady_grid_N, replace(targets.sampling, hold_points=0))
    ends = []
    for press in presses:
        time_s, depth_mm = press.time_s[0], press.displacement_mm
        elastic = pad.young_MPa[0] * pad.curves.area_at(pad.slab, depth_mm)[0]
        force = relaxed_force(time_s, elastic, prony)
        place = radius_mm / thickness, depth_mm[0] / thickness
        curves = np.stack([force, *departure(base, *place, time_s, elastic, prony, shape, thickness)])
        ends.append([curves[:, np.argmax(force)], parabolic_work_mJ(np.repeat(depth_mm, 3, axis=0), curves)])
    reading, low, high = np.transpose(ends, (2, 1, 0))
    middle, half = 1.0 + 0.5 * (high + low) / reading, 0.5 * (high - low) / reading
    return FiniteStrain(*np.stack([middle, half / HALF_WIDTH], axis=1))
