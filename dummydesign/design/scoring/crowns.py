"""What crowns that are off, and finite strain in quick presses, make of the force of a pad."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.design.scoring.press_simulation import PadBatch, PadRows, SlabCurves, make_curves, parabolic_work_mJ
from dummydesign.design.scoring.score import press_all
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.scoring.verdict import Readings
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.material.relaxation import PronyTerm, relaxed_force
from dummydesign.pad.predict import departure

# Even steps of a crown's height, and of the logarithm of its tip radius, at which a force law is asked.
HEIGHTS, RADII = 9, 3


@dataclass(frozen=True, eq=False)
class Crowns(PadRows):
    """Crowns of n pads: height over the flat less the designed one [mm], tip radius over the designed one; (n,)."""

    higher_mm: NDArray
    blunter: NDArray


class CrownedLaw(Protocol):
    """A force law of a shape that knows pads whose crowns are off."""

    def with_crowns(self, crowns: Crowns) -> ForceLaw:
        """The law of such pads, one a row; their thickness at the tip has the crown's error in it."""


def law_with_crowns(law: ForceLaw, crowns: Crowns) -> ForceLaw:
    """The law of pads of a crowned shape whose crowns are off, one a row."""
    return cast(CrownedLaw, law).with_crowns(crowns)


def crowned_curves(
    law: ForceLaw, crowns: Crowns, thickness_mm: float, radius_mm: float, gel_compression: float
) -> Callable[[Crowns, SlabCurves], SlabCurves]:
    """What makes curves of n of these crowns from those with the designed one, row by row.

    What a crown changes is worked out on a pad of one thickness, as ln F / E at shares of the depth limit, and
    interpolated: straight over the height, by a parabola over the logarithm of the tip radius. A crown that the law
    does not hold counts as designed.
    """
    ends = (crowns.higher_mm, HEIGHTS), (np.log(crowns.blunter), RADII)
    rows, radii = (np.linspace(one.min(), one.max(), count) for one, count in ends)
    nodes = Crowns(np.r_[0.0, np.repeat(rows, RADII)], np.exp(np.r_[0.0, np.tile(radii, HEIGHTS)]))
    made = make_curves(law_with_crowns(law, nodes), thickness_mm + nodes.higher_mm, radius_mm, gel_compression)
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithms = np.log(np.column_stack([made.limit_mm, made.area_mm2[:, 1:]]))
        changes = np.nan_to_num(logarithms[1:] - logarithms[0], nan=0.0, posinf=0.0, neginf=0.0)

    def curves(own: Crowns, designed: SlabCurves) -> SlabCurves:
        heights, logs = own.higher_mm, np.log(own.blunter)
        place = np.clip((heights - rows[0]) / max(rows[1] - rows[0], 1e-12), 0.0, HEIGHTS - 1.000001)
        left, each = place.astype(int), np.arange(len(heights))
        parabola = np.stack([_lagrange(radii, k, logs) for k in range(RADII)], axis=-1)
        weights = np.zeros((len(heights), HEIGHTS, RADII))
        weights[each, left] = (1.0 - place + left)[:, None] * parabola
        weights[each, left + 1] = (place - left)[:, None] * parabola
        area = weights.reshape(len(heights), -1) @ changes
        np.exp(area, out=area)
        limit = designed.limit_mm * area[:, 0]
        area[:, 0] = 1.0
        area *= designed.area_mm2
        return SlabCurves(designed.thickness_mm + heights, limit, area)

    return curves


def _lagrange(nodes: NDArray, k: int, at: NDArray) -> NDArray:
    """The polynomial that is 1 at node k and 0 at the others; where all nodes are one, the middle one's is 1."""
    if np.ptp(nodes) == 0.0:
        return np.full(len(at), float(k == len(nodes) // 2))
    others = np.delete(nodes, k)
    return np.asarray(np.prod([(at - one) / (nodes[k] - one) for one in others], axis=0))


def crown_scatter(law: ForceLaw, crowns: Crowns, thickness_mm: float, depth_mm: NDArray, radius_mm: float) -> float:
    """Standard deviation of the logarithm of the force that crowns leave, as a mean over depths (m,)."""
    pads = Crowns(np.r_[0.0, crowns.higher_mm], np.r_[1.0, crowns.blunter])
    thickness = (thickness_mm + pads.higher_mm)[:, None]
    depth = np.broadcast_to(depth_mm, (len(thickness), len(depth_mm)))
    with np.errstate(divide="ignore", invalid="ignore"):
        logs = np.log(law_with_crowns(law, pads).force(depth, thickness, 1.0, radius_mm))
    means = (logs[1:] - logs[0]).mean(axis=-1)
    known = means[np.isfinite(means)]
    return float(known.std()) if len(known) else 0.0


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
