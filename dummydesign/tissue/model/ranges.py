"""The ranges of force over time that a pad is compared with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2, RobotPath, work_to_deepest_mJ
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.model.maxwell_law import Parameters, law_named, stack

FIRST_HOLD_S = 0.005

STEADY_TOLERANCE = 0.01
"""Share of the steady force to which it can be set: the robot's 0.02 mm are 1 % of it at a depth of 6 mm."""


@dataclass(frozen=True, eq=False)
class ForceRange:
    """Force variation range at one steady force and speed: the envelope of the subjects' F(t).

    Contact is at time 0; every subject has its own depth and stop time. Arrays of shape (n,), the
    single curves of shape (subjects, n). ``energy_mJ`` is the work on each subject up to its largest depth, where they
    followed a measured path.
    """

    steady_force_N: float
    velocity_mm_s: float
    time_s: NDArray
    low_N: NDArray
    high_N: NDArray
    curves_N: NDArray
    depth_mm: NDArray
    stop_s: NDArray
    energy_mJ: NDArray | None = None

    @property
    def peak_low_N(self) -> float:
        """Smallest peak of the subjects. [N]"""
        return float(self.curves_N.max(axis=-1).min())

    @property
    def peak_high_N(self) -> float:
        """Largest peak of the subjects. [N]"""
        return float(self.curves_N.max(axis=-1).max())

    def inside(
        self, time_s: ArrayLike, force_N: ArrayLike, stop_s: ArrayLike, tolerance_N: float | None = None
    ) -> dict[str, NDArray]:
        """Fraction of a press in the range, in the rise, in the hold, and the mean of both.

        The rise counts evenly in time from contact to the dummy's own stop, the hold evenly in the
        logarithm of the time since the stop (from 5 ms on, or the first sample after it), so that neither the 10 s of
        hold nor the first milliseconds drown the other.
        """
        time, pressed = np.broadcast_arrays(np.asarray(time_s, float), np.asarray(force_N, float))
        stop = np.broadcast_to(np.asarray(stop_s, float), time.shape[:-1])[..., None]
        end = np.minimum(time[..., -1:], self.time_s[-1])
        rise_at = stop * np.linspace(0.0, 1.0, 61)[1:]
        hold = np.maximum(end - stop, 2 * FIRST_HOLD_S)
        sampled = np.where(time > stop, time - stop, np.inf).min(axis=-1, keepdims=True)
        first = np.clip(sampled, FIRST_HOLD_S, 0.5 * hold)
        hold_at = stop + first * (hold / first) ** np.linspace(0.0, 1.0, 61)
        near = STEADY_TOLERANCE * self.steady_force_N if tolerance_N is None else tolerance_N
        shares = []
        for at in (rise_at, np.minimum(hold_at, end)):
            value = interpolate_rows(at, time, pressed)
            low, high = (np.interp(at, self.time_s, edge) for edge in (self.low_N, self.high_N))
            shares.append(np.mean((value >= low - near) & (value <= high + near), axis=-1))
        rise, hold = shares
        return {"inside_fraction": 0.5 * (rise + hold), "inside_rise_fraction": rise, "inside_hold_fraction": hold}


def interpolate_rows(at: NDArray, time: NDArray, values: NDArray) -> NDArray:
    """Interpolate each row of values over its row of times."""
    rows = zip(*(array.reshape(-1, array.shape[-1]) for array in (at, time, values)))
    return np.array([np.interp(*row) for row in rows]).reshape(at.shape)


def force_range(
    subjects: tuple[Parameters, ...],
    steady_force_N: float,
    velocity_mm_s: float,
    hold_s: float = 10.0,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
    lowpass: Lowpass | None = None,
    path: RobotPath | None = None,
) -> ForceRange:
    """Envelope of the subjects' F(t), each pressed to its own depth for the same force at the end of hold."""
    return force_ranges((subjects,), steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2, lowpass, path)[0]


def force_ranges(
    groups: Sequence[tuple[Parameters, ...]],
    steady_force_N: float,
    velocity_mm_s: float,
    hold_s: float = 10.0,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
    lowpass: Lowpass | None = None,
    path: RobotPath | None = None,
) -> list[ForceRange]:
    """The :func:`force_range` of each of several groups of subjects of one law, all pressed at once."""
    everyone = [one for group in groups for one in group]
    law = law_named(everyone[0].law)
    energy = None
    if path is None:
        motion, curves, depth = law.press(everyone, steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2)
    else:
        force = np.array([steady_force_N])
        depth = law.held_depths(everyone, force, velocity_mm_s, hold_s, deceleration_mm_s2)[:, 0]
        motion = path.to(depth)
        curves = law.force(motion, *stack(everyone, velocity_mm_s))
        energy = work_to_deepest_mJ(motion.displacement_mm, curves)
    if lowpass is not None:
        curves = lowpass.apply(motion.time_s, curves)
    stop = motion.time_s[..., -1] - hold_s
    ranges, end = [], 0
    for group in groups:
        rows = slice(end, end := end + len(group))
        time = motion.time_s[rows]
        # the samples of every subject, so that each piecewise-linear curve is kept as it is
        grid = np.unique(time)
        grid = grid[grid <= float(stop[rows].min()) + hold_s]
        on_grid = interpolate_rows(np.broadcast_to(grid, (len(time), len(grid))), time, curves[rows])
        low, high = on_grid.min(axis=0), on_grid.max(axis=0)
        condition = float(steady_force_N), float(velocity_mm_s)
        own = None if energy is None else energy[rows]
        ranges.append(ForceRange(*condition, grid, low, high, on_grid, depth[rows], stop[rows], own))
    return ranges
