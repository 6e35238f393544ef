"""Scores of many designs at once: how far from the subjects, closeness to the aim, parameters."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dummydesign.design.request import NAGOYA_PROTOCOL, Protocol
from dummydesign.design.scoring.press_simulation import (
    COARSE,
    PadBatch,
    Sampling,
    SimulatedPress,
    press_to_depth,
    steady_depth,
    take_rows,
)
from dummydesign.design.scoring.settings import Weights
from dummydesign.design.scoring.targets import Targets
from dummydesign.tissue.model.ranges import STEADY_TOLERANCE, ForceRange


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Scores and presses of D designs.

    ``steady_state_range`` (over the forces of the test, 5 to 15 N), ``low_force_range`` (below its lowest),
    ``force_variation_range`` and ``aim`` have shape (D,), ``inside`` and ``depth_mm`` (D, conditions),
    ``low_depth_mm`` (D, low forces), ``steady_depth_mm`` (D, steady forces); ``presses`` one a condition, in the order
    of the targets' conditions. ``protocol`` and ``sampling`` are the test, ``weights`` those of the total.
    """

    slabs: PadBatch
    steady_state_range: NDArray
    low_force_range: NDArray
    force_variation_range: NDArray
    aim: NDArray
    inside: NDArray
    depth_mm: NDArray
    low_depth_mm: NDArray
    steady_depth_mm: NDArray
    presses: tuple[SimulatedPress, ...]
    protocol: Protocol
    sampling: Sampling
    weights: Weights

    def total(self, parametric: NDArray) -> NDArray:
        """Weighted mean of the parts, shape (D,)."""
        weighted = [
            weight * (parametric if name == "parametric" else getattr(self, name))
            for name, weight in self.weights.parts.items()
        ]
        return np.sum(weighted, axis=0)

    def take(self, chosen: NDArray) -> Evaluation:
        """Keep the designs chosen by index or mask (without their presses)."""
        return replace(take_rows(self, chosen), slabs=self.slabs.take(chosen), presses=())

    @property
    def feasible(self) -> NDArray:
        """Designs that reach the middle force (10 N) at every speed inside their depth limit, shape (D,)."""
        forces = self.protocol.forces_N
        return np.isfinite(self.depth_mm[:, forces.index(self.protocol.needed_N) :: len(forces)]).all(axis=-1)


def halving(distance: NDArray) -> NDArray:
    """Closeness from a distance in half-widths of the band: 1 at the aim, 1/2 half a band away; NaN is 0."""
    return np.where(np.isfinite(distance), 0.5 ** np.abs(np.nan_to_num(distance)), 0.0)


def closeness(distance: NDArray) -> NDArray:
    """Closeness of curves (D, n) to the aim: :func:`halving` of the rms distance, times the share in reach.

    The rms, not the mean of closenesses: a curve that runs evenly about the aim is nearer to it than one
    that touches it once and is far off elsewhere.
    """
    known = np.isfinite(distance)
    count = known.sum(axis=-1)
    square = np.where(known, np.nan_to_num(distance) ** 2, 0.0).sum(axis=-1)
    return halving(np.sqrt(square / np.maximum(count, 1))) * count / distance.shape[-1]


def evaluate(slabs: PadBatch, targets: Targets, sampling: Sampling | None = None, exact: bool = False) -> Evaluation:
    """Score designs against a tissue by the ranges and the aim."""
    protocol = targets.protocol
    sampling = sampling or targets.sampling.coarse
    low_N, lows = protocol.low_grid_N, len(protocol.low_grid_N)
    forces = np.concatenate([low_N, protocol.steady_grid_N])
    reached, presses = press_all(slabs, targets, forces, sampling, exact)
    share = _inside_exact if exact else _inside_at_samples
    away = np.log(reached / targets.aim_depth_mm(forces)) / targets.depth_half_width
    pairs = list(zip(targets.conditions, presses))
    inside = [share(press, condition.range) for condition, press in pairs]
    peaks = [np.log(press.peak_N / one.aim_peak_N) / one.peak_half_width for one, press in pairs]
    aim = 0.5 * (closeness(away[:, lows:]) + closeness(np.stack(peaks, axis=-1)))
    return Evaluation(
        slabs,
        targets.steady_inside(protocol.steady_grid_N, reached[:, lows:]),
        targets.steady_inside(low_N, reached[:, :lows]),
        np.mean(inside, axis=0),
        aim,
        np.stack(inside, axis=-1),
        np.stack([press.depth_mm for press in presses], axis=-1),
        reached[:, :lows],
        reached[:, lows:],
        presses,
        protocol,
        sampling,
        targets.weights,
    )


def press_all(
    slabs: PadBatch, targets: Targets, forces_N: NDArray, sampling: Sampling, exact: bool = False
) -> tuple[NDArray, tuple[SimulatedPress, ...]]:
    """Depths (D, forces) at steady forces of the slowest ramp, and the presses of every condition."""
    pressed = np.array([(one.steady_force_N, one.velocity_mm_s) for one in targets.conditions])
    # one inversion of the curves for all, but where the presses are to be exact
    wanted = np.r_[[(force, targets.protocol.slow_mm_s) for force in forces_N], pressed]
    force_N, speed_mm_s = (wanted[: len(forces_N)] if exact else wanted).T
    depth = steady_depth(slabs, force_N, speed_mm_s, sampling)
    reached = depth[:, : len(forces_N)]
    depth = steady_depth(slabs, pressed[:, 0], pressed[:, 1], sampling, exact) if exact else depth[:, len(forces_N) :]
    if len(depth) > 1:
        return reached, tuple(press_to_depth(slabs, *at, sampling) for at in zip(depth.T, pressed[:, 1].tolist()))
    # of one design all conditions at once: the recursion costs by its steps, not by its presses
    count = len(pressed)
    every = press_to_depth(slabs.take(np.zeros(count, int)), depth[0], pressed[:, 1], sampling)
    return reached, tuple(every.take(slice(number, number + 1)) for number in range(count))


def _inside_exact(press: SimulatedPress, band: ForceRange) -> NDArray:
    """Share of each press inside a force range as the tissue defines it; 0 where out of reach."""
    share = np.zeros(len(press.stop_s))
    known = np.isfinite(press.depth_mm)
    if known.any():
        shares = band.inside(press.time_s[known], press.force_N[known], press.stop_s[known])
        share[known] = shares["inside_fraction"]
    return share


def _inside_at_samples(press: SimulatedPress, band: ForceRange) -> NDArray:
    """The same share taken at the samples: rise even in time, hold even in the logarithm from 5 ms on."""
    # both ends as the parts of one complex number, so that they are found at once
    ends = np.interp(press.time_s[:, press.counted], band.time_s, band.low_N + 1j * band.high_N)
    force, near = press.force_N[:, press.counted], STEADY_TOLERANCE * band.steady_force_N
    with np.errstate(invalid="ignore"):
        within = (force >= ends.real - near) & (force <= ends.imag + near)
    share = np.einsum("dn,dn->d", press.sample_weights, within)
    return np.where(np.isfinite(press.depth_mm), share, 0.0)


def steady_gamma1(
    slabs: PadBatch, protocol: Protocol = NAGOYA_PROTOCOL, sampling: Sampling = COARSE, power: float = 3.0
) -> NDArray:
    """Least-squares gamma1 of F = gamma1 x^power over the steady forces of the protocol, shape (D,). [N/mm^power]

    It is what a fit of the five-element law settles for in the hold of all presses; NaN when none is reached.
    """
    return _gamma1(steady_depth(slabs, np.array(protocol.forces_N), protocol.slow_mm_s, sampling), protocol, power)


def evaluated_gamma1(evaluation: Evaluation, power: float = 3.0) -> NDArray:
    """The :func:`steady_gamma1` of designs whose evaluation is not exact, from its depths at the slowest ramp, (D,)."""
    return _gamma1(evaluation.depth_mm[:, : len(evaluation.protocol.forces_N)], evaluation.protocol, power)


def _gamma1(depth_mm: NDArray, protocol: Protocol, power: float) -> NDArray:
    cube = np.nan_to_num(depth_mm) ** power
    with np.errstate(invalid="ignore", divide="ignore"):
        return (cube * np.array(protocol.forces_N)).sum(axis=-1) / (cube**2).sum(axis=-1)
