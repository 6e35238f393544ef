"""One held press as curves keep it, and what lies between presses: equal depths, straight lines, monotone cubics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

SHARES: NDArray = 1.0 - (1.0 - np.linspace(0.0, 1.0, 61)) ** 3
"""Shares of its depth at which the rise of a press is kept, finer where a robot brakes."""
FIRST_HOLD_S, HOLD_POINTS = 1e-3, 60
FORCE_APART, SPEED_APART, HOLD_APART, SAME_DEPTH = 1.2, 1.15, 1.1, 1.05
"""Factors within which a press belongs to a force, a speed and a hold, and presses to one depth."""
FINE = 400
START_SHARE = 0.02
"""Share of its depth from which on the rise of a press gives the start of the steady curve."""
DEPTH_MM = 0.02
"""Half-width to which a depth is taken as known: that to which a robot is taken to repeat. [mm]"""


@dataclass(frozen=True, eq=False)
class HeldPress:
    """One press of one person: a rise at a speed to a depth that is held.

    Attributes
    ----------
    velocity_mm_s, depth_mm : float
    rise_N : ndarray, shape (61,)
        Force at :data:`SHARES` of the depth. [N]
    time_s, hold_N : ndarray, shape (n,)
        Time since the stop, from 0, and force there. [s, N]
    """

    velocity_mm_s: float
    depth_mm: float
    rise_N: NDArray
    time_s: NDArray
    hold_N: NDArray

    @property
    def hold_s(self) -> float:
        """How long it was held. [s]"""
        return float(self.time_s[-1])

    def steady_N(self, hold_s: float) -> float:
        """Force at the end of a hold, at most of its own. [N]"""
        return float(np.interp(hold_s, self.time_s, self.hold_N))


@lru_cache(maxsize=64)
def hold_times(hold_s: float) -> NDArray:
    """Times since the stop at which a hold is worked out: 0, then growing from 1 ms. [s]"""
    return np.r_[0.0, np.geomspace(min(FIRST_HOLD_S, 0.1 * hold_s), hold_s, HOLD_POINTS)]


def over_steady(press: HeldPress, hold_s: float) -> NDArray:
    """Rise and hold of a press over its force at the end of the hold."""
    hold = np.interp(hold_times(hold_s), press.time_s, press.hold_N)
    return np.r_[press.rise_N, hold] / press.steady_N(hold_s)


def smooth_curve(x: NDArray, y: NDArray) -> tuple[NDArray, NDArray]:
    """The same points with a monotone cubic between them, fine enough for straight lines."""
    if len(x) < 3:
        return x, y
    from scipy.interpolate import PchipInterpolator

    fine = np.unique(np.r_[x, np.linspace(x[0], x[-1], FINE)])
    return fine, PchipInterpolator(x, y)(fine)


def carried_on(at: NDArray, x: NDArray, y: NDArray) -> NDArray:
    """Straight lines through points, carried on at both ends by the line through the outer two.

    Parameters
    ----------
    at : ndarray, shape (...)
        Where.
    x, y : ndarray, shape (n,)
        Points by rising x, at least two.
    """
    found = np.interp(at, x, y)
    found = found + np.minimum(at - x[0], 0.0) * (y[1] - y[0]) / (x[1] - x[0])
    return found + np.maximum(at - x[-1], 0.0) * (y[-1] - y[-2]) / (x[-1] - x[-2])


def by_speed(presses: Sequence[HeldPress]) -> dict[float, list[list[HeldPress]]]:
    """Presses by rising speed, then by rising depth with repeats together."""
    found: dict[float, list[list[HeldPress]]] = {}
    for speed in sorted({press.velocity_mm_s for press in presses}):
        own = [press for press in presses if press.velocity_mm_s == speed]
        found[speed] = by_depth(sorted(own, key=lambda press: press.depth_mm))
    return found


def by_depth(ordered: Sequence[HeldPress]) -> list[list[HeldPress]]:
    groups: list[list[HeldPress]] = []
    for press in ordered:
        if groups and press.depth_mm < SAME_DEPTH * groups[-1][0].depth_mm:
            groups[-1].append(press)
        else:
            groups.append([press])
    return groups
