"""The range of force over time that a dummy is compared with, and depths at the end of a hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.measurement.motion import DECELERATION_MM_S2
from dummydesign.measurement.sensor import Lowpass
from dummydesign.tissue.model.laws import law_named
from dummydesign.tissue.model.parameters import Parameters
from dummydesign.tissue.model.subjects_law import one_law

FIRST_HOLD_S = 0.005

STEADY_TOLERANCE = 0.01
"""Share of the steady force to which it can be set: the robot's 0.02 mm are 1 % of it at a depth of 6 mm."""


@dataclass(frozen=True)
class ForceRange:
    """Force variation range at one steady force and speed: the envelope of the subjects' F(t).

    Contact is at time 0; every subject has its own depth and stop time. Arrays of shape (n,), the
    single curves of shape (subjects, n).
    """

    steady_force_N: float
    velocity_mm_s: float
    time_s: NDArray
    low_N: NDArray
    high_N: NDArray
    curves_N: NDArray
    depth_mm: NDArray
    stop_s: NDArray

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
        logarithm of the time since the stop (from 5 ms on), so that neither the 10 s of hold nor the
        first milliseconds drown the other.

        Parameters
        ----------
        time_s, force_N : array_like, shapes (n,) or (..., n)
            Press with contact at time 0. [s, N]
        stop_s : array_like, shape (...)
            Stop time of each press. [s]
        tolerance_N : float, optional
            How far outside still counts as inside; by default :data:`STEADY_TOLERANCE` of the steady force,
            because all curves meet at the end of the hold, where the range has no width. [N]

        Returns
        -------
        dict of ndarray, shape (...)
            ``inside_fraction``, ``inside_rise_fraction``, ``inside_hold_fraction``.
        """
        time, pressed = np.broadcast_arrays(np.asarray(time_s, float), np.asarray(force_N, float))
        stop = np.broadcast_to(np.asarray(stop_s, float), time.shape[:-1])[..., None]
        end = np.minimum(time[..., -1:], self.time_s[-1])
        rise_at = stop * np.linspace(0.0, 1.0, 61)[1:]
        hold_at = stop + np.geomspace(FIRST_HOLD_S, 1.0, 61) * np.maximum(end - stop, 2 * FIRST_HOLD_S)
        near = STEADY_TOLERANCE * self.steady_force_N if tolerance_N is None else tolerance_N
        shares = {}
        for name, at in (
            ("inside_rise_fraction", rise_at),
            ("inside_hold_fraction", np.minimum(hold_at, end)),
        ):
            value = interpolate_rows(at, time, pressed)
            low = np.interp(at, self.time_s, self.low_N)
            high = np.interp(at, self.time_s, self.high_N)
            shares[name] = np.mean((value >= low - near) & (value <= high + near), axis=-1)
        mean = 0.5 * (shares["inside_rise_fraction"] + shares["inside_hold_fraction"])
        return {"inside_fraction": mean, **shares}

    def to_dict(self) -> dict[str, Any]:
        """Return condition, envelope and the subjects' depths as plain values."""
        return {
            "steady_force_N": self.steady_force_N,
            "velocity_mm_s": self.velocity_mm_s,
            "time_s": self.time_s.tolist(),
            "low_N": self.low_N.tolist(),
            "high_N": self.high_N.tolist(),
            "depth_mm": self.depth_mm.tolist(),
            "peak_low_N": self.peak_low_N,
            "peak_high_N": self.peak_high_N,
        }


def interpolate_rows(at: NDArray, time: NDArray, values: NDArray) -> NDArray:
    """Interpolate each row of values over its row of times.

    Parameters
    ----------
    at : ndarray, shape (..., m)
        Times wanted in each row; beyond the row's ends its end values are taken. [s]
    time, values : ndarray, shape (..., n)
        Increasing times and the values there. [s, any unit]

    Returns
    -------
    ndarray, shape (..., m)
    """
    flat = at.reshape(-1, at.shape[-1])
    rows = [
        np.interp(a, t, v)
        for a, t, v in zip(flat, time.reshape(-1, time.shape[-1]), values.reshape(-1, values.shape[-1]))
    ]
    return np.array(rows).reshape(at.shape)


def force_range(
    subjects: tuple[Parameters, ...],
    steady_force_N: float,
    velocity_mm_s: float,
    hold_s: float = 10.0,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
    lowpass: Lowpass | None = None,
) -> ForceRange:
    """Envelope of the subjects' F(t), each pressed to its own depth for the same force at the end of hold.

    Parameters
    ----------
    subjects : tuple of Parameters
        At least one; all of the same law.
    steady_force_N, velocity_mm_s : float
        Condition: force at the end of the hold [N] and speed [mm/s].
    hold_s, deceleration_mm_s2 : float
        Hold [s] and braking [mm/s2] of the robot.
    lowpass : Lowpass, optional
        Sensor filter to put on the curves; none by default, as in the paper's calibration curves.

    Returns
    -------
    ForceRange
    """
    return force_ranges((subjects,), steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2, lowpass)[0]


def force_ranges(
    groups: Sequence[tuple[Parameters, ...]],
    steady_force_N: float,
    velocity_mm_s: float,
    hold_s: float = 10.0,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
    lowpass: Lowpass | None = None,
) -> list[ForceRange]:
    """The :func:`force_range` of each of several groups of subjects of one law, all pressed at once.

    Parameters
    ----------
    groups : sequence of tuple of Parameters
        At least one of each.
    steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2, lowpass
        As for :func:`force_range`. [N, mm/s, s, mm/s2]
    """
    everyone = [one for group in groups for one in group]
    law = law_named(one_law(everyone))
    motion, curves, depth = law.press(everyone, steady_force_N, velocity_mm_s, hold_s, deceleration_mm_s2)
    if lowpass is not None:
        curves = lowpass.apply(motion.time_s, curves)
    stop = motion.time_s[..., -1] - hold_s
    found, end = [], 0
    for group in groups:
        rows = slice(end, end := end + len(group))
        # the samples of every subject, so that each piecewise-linear curve is kept as it is
        time = motion.time_s[rows]
        grid = np.unique(time)
        grid = grid[grid <= float(stop[rows].min()) + hold_s]
        on_grid = interpolate_rows(np.broadcast_to(grid, (len(time), len(grid))), time, curves[rows])
        low, high = on_grid.min(axis=0), on_grid.max(axis=0)
        condition = float(steady_force_N), float(velocity_mm_s)
        found.append(ForceRange(*condition, grid, low, high, on_grid, depth[rows], stop[rows]))
    return found


def held_depth(
    subjects: tuple[Parameters, ...],
    force_N: NDArray,
    velocity_mm_s: float,
    hold_s: float,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
) -> NDArray:
    """Depths at which subjects still carry steady forces at the end of a hold, shape (subjects, n). [mm]

    Parameters
    ----------
    subjects : tuple of Parameters
        At least one; all of the same law.
    force_N : ndarray, shape (n,)
        Forces at the end of the hold. [N]
    velocity_mm_s, hold_s, deceleration_mm_s2 : float
        Ramp, hold and braking. [mm/s, s, mm/s2]
    """
    law = law_named(one_law(subjects))
    return law.held_depths(subjects, force_N, velocity_mm_s, hold_s, deceleration_mm_s2)


def end_of_hold_range(
    subjects: tuple[Parameters, ...],
    force_N: NDArray,
    velocity_mm_s: float,
    hold_s: float,
    deceleration_mm_s2: float = DECELERATION_MM_S2,
) -> tuple[NDArray, NDArray]:
    """Depth of the stiffest and of the softest subject at forces at the end of a hold, shapes (n,). [mm]

    After a short hold a subject still carries part of its peak and is less deep at a force than at rest.

    Parameters
    ----------
    subjects : tuple of Parameters
        At least one; all of the same law.
    force_N : ndarray, shape (n,)
        Rising, above 0. [N]
    velocity_mm_s, hold_s, deceleration_mm_s2 : float
        Ramp, hold and braking. [mm/s, s, mm/s2]
    """
    law = law_named(one_law(subjects))
    found = law.end_of_hold_depths(subjects, force_N, velocity_mm_s, hold_s, deceleration_mm_s2)
    return found.min(axis=0), found.max(axis=0)
