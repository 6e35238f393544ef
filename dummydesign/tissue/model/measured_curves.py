"""People as measured curves of force over depth, speed and time, without a law: what was pressed, and between presses.

Between the presses of one speed, forces over the steady force are linear in ln depth; between speeds in ln speed; the
steady curve is a monotone cubic of ln force over ln depth through its points, and below the shallowest press it is the
rise of that press of the slowest speed, scaled to its steady force. Nothing is extrapolated further than a press
belongs to a force (20 %) or a speed (15 %).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.interpolation import group_near
from dummydesign.measurement.motion import Motion
from dummydesign.tissue.model.maxwell_law import Parameters
from dummydesign.tissue.model.people_share import Population, is_share, share_of_aim

SHARES: NDArray = 1.0 - (1.0 - np.linspace(0.0, 1.0, 61)) ** 3
"""Shares of its depth at which the rise of a press is kept, finer where a robot brakes."""
FIRST_HOLD_S, HOLD_POINTS = 1e-3, 60
FORCE_FACTOR, SPEED_FACTOR, HOLD_FACTOR, SAME_DEPTH = 1.2, 1.15, 1.1, 1.05
"""Factors within which a press belongs to a force, a speed and a hold, and presses to one depth."""
ONE_FORCE = 1.3
"""Ratio of the highest to the lowest force in common below which one force stands for both."""
FINE = 400
SMALLEST_N = 1e-6
"""Force that stands for none where logarithms are taken. [N]"""
START_SHARE = 0.02
"""Share of its depth from which on the rise of a press gives the start of the steady curve."""
DEPTH_MM = 0.02
"""Half-width to which a depth is taken as known: that to which a robot is taken to repeat. [mm]"""


@dataclass(frozen=True, eq=False)
class HeldPress:
    """One press of one person: a rise at a speed to a depth that is held."""

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


def log_steady_curve(x: NDArray, rise_N: NDArray, depth: NDArray, force: NDArray) -> tuple[NDArray, NDArray]:
    """ln depth and ln force of the steady curve: its points, before them a rise with its level put to the first point.

    Only what rises with depth is kept.
    """
    start = (x > START_SHARE * depth[0]) & (x < 0.97 * depth[0]) & (rise_N > 0.0)
    level = force[0] / float(np.interp(depth[0], x, rise_N))
    log_depth, log_force = np.log(np.r_[x[start], depth]), np.log(np.r_[rise_N[start] * level, force])
    rising = np.r_[True, np.diff(np.maximum.accumulate(log_force)) > 0.0]
    return log_depth[rising], log_force[rising]


def extrapolate_linearly(at: NDArray, x: NDArray, y: NDArray) -> NDArray:
    """Straight lines through points, extrapolated at both ends by the line through the outer two."""
    value = np.interp(at, x, y)
    value = value + np.minimum(at - x[0], 0.0) * (y[1] - y[0]) / (x[1] - x[0])
    return value + np.maximum(at - x[-1], 0.0) * (y[-1] - y[-2]) / (x[-1] - x[-2])


def by_depth(presses: Iterable[HeldPress]) -> list[list[HeldPress]]:
    """Presses by rising depth with repeats together."""
    return group_near(presses, lambda press: press.depth_mm, SAME_DEPTH, of=0)


def common_span(people: Iterable[Measured], velocity_mm_s: float, hold_s: float) -> tuple[float, float] | None:
    """Lowest and highest steady force that all were pressed to at a speed, None where one was not. [N]"""
    spans = [one.known_N(velocity_mm_s, hold_s) for one in people]
    known = [span for span in spans if span is not None]
    return (max(low for low, _ in known), min(high for _, high in known)) if len(known) == len(spans) else None


def common_forces(people: Sequence[Measured], speeds: Sequence[float], hold_s: float) -> tuple[float, ...]:
    """Steady forces that all were pressed to at all speeds: the lowest, the middle and the highest, or one. [N]"""
    spans = [span for speed in speeds if (span := common_span(people, speed, hold_s)) is not None]
    low, high = max(span[0] for span in spans), min(span[1] for span in spans)
    if low > high * FORCE_FACTOR**2:
        return ()
    if high < ONE_FORCE * low:
        return (float(f"{np.sqrt(low * high):.2g}"),)
    return tuple(float(f"{force:.2g}") for force in (low, np.sqrt(low * high), high))


LAW = "curves"


class MeasuredParameters(Parameters):
    """In place of the parameters of a law: there are none, and asking for one is refused."""

    law, gamma_N_per_mm3, c_N_s_per_mm = LAW, (), ()

    __eq__ = object.__eq__
    __hash__ = object.__hash__
    __repr__ = object.__repr__

    @property
    def gamma1_N_per_mm3(self) -> float:  # type: ignore[override]
        """There is none."""
        message = "measured curves have no parameters; this needs a tissue with a law, such as ode"
        raise InputError(message, "unsupported", "law", LAW)

    def to_dict(self) -> dict[str, str]:
        """Return the law's name alone."""
        return {"law": LAW}

    def force(self, motion: Motion, velocity_mm_s: float) -> NDArray:
        """Force under any motion, which curves do not give."""
        message = "measured curves give the presses that were made, not the force under any motion"
        raise InputError(message, "unsupported", "law", LAW)


class MeasuredPerson(MeasuredParameters):
    """The presses of one person."""

    def __init__(self, presses: Sequence[HeldPress]) -> None:
        speeds = sorted({press.velocity_mm_s for press in presses})
        groups = {v: by_depth(press for press in presses if press.velocity_mm_s == v) for v in speeds}
        # The class is frozen.
        self.__dict__.update(presses=tuple(presses), _by_speed=groups, _curves={})

    presses: tuple[HeldPress, ...]
    _by_speed: dict[float, list[list[HeldPress]]]
    _curves: dict[float, tuple[NDArray, NDArray]]

    @property
    def velocities_mm_s(self) -> tuple[float, ...]:
        """Speeds that were pressed. [mm/s]"""
        return tuple(self._by_speed)

    def hold_known_s(self) -> float:
        """Longest hold that all presses were held for. [s]"""
        return min(press.hold_s for press in self.presses)

    def known_N(self, velocity_mm_s: float, hold_s: float) -> tuple[float, float] | None:
        """Lowest and highest steady force that was pressed at a speed, None for a speed that was not. [N]"""
        forces = [
            [np.mean([press.steady_N(hold_s) for press in group]) for group in self._by_speed[speed]]
            for speed, _ in self._speeds(velocity_mm_s)
        ]
        return (float(max(map(min, forces))), float(min(map(max, forces)))) if forces else None

    def depth_mm(self, force_N: ArrayLike, hold_s: float) -> NDArray:
        """Depth at forces at the end of a hold, on the steady curve of all presses. [mm]"""
        log_depth, log_force = self.steady_curve(hold_s)
        return np.exp(extrapolate_linearly(np.log(np.maximum(force_N, 1e-12)), log_force, log_depth))

    def steady_N(self, depth_mm: ArrayLike, hold_s: float) -> NDArray:
        """Force at the end of a hold at depths. [N]"""
        log_depth, log_force = self.steady_curve(hold_s)
        return np.exp(extrapolate_linearly(np.log(np.maximum(depth_mm, 1e-12)), log_depth, log_force))

    def steady_curve(self, hold_s: float) -> tuple[NDArray, NDArray]:
        """Points of ln depth and ln steady force, rising. [ln mm, ln N]"""
        key = min(hold_s, self.hold_known_s())
        if key not in self._curves:
            self._curves[key] = self._steady_curve(key)
        return self._curves[key]

    def shape_N(self, force_N: float, velocity_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """Force at :data:`SHARES` of the depth and at :func:`hold_times` of a press to a force at its end. [N]"""
        depth = float(self.depth_mm(force_N, hold_s))
        rows = [share * self._ratios(speed, depth, hold_s) for speed, share in self._speeds(velocity_mm_s)]
        mean = np.sum(rows, axis=0)
        return force_N * mean[: len(SHARES)], force_N * mean[len(SHARES) :]

    def _speeds(self, velocity_mm_s: float) -> list[tuple[float, float]]:
        """Speeds that stand for a speed, with their shares: itself, or its two neighbours; none outside them."""
        known = np.array(self.velocities_mm_s)
        nearest = float(known[np.argmin(np.abs(np.log(known / velocity_mm_s)))])
        if 1.0 / SPEED_FACTOR < nearest / velocity_mm_s < SPEED_FACTOR:
            return [(nearest, 1.0)]
        if not known[0] < velocity_mm_s < known[-1]:
            return []
        at = int(np.searchsorted(known, velocity_mm_s))
        share = float(np.log(velocity_mm_s / known[at - 1]) / np.log(known[at] / known[at - 1]))
        return [(float(known[at - 1]), 1.0 - share), (float(known[at]), share)]

    def over_steady_at(self, speed_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """ln depth (presses,) and rise and hold over the steady force (presses, n) of the presses of a speed."""
        groups = self._by_speed[speed_mm_s]
        depths = np.log([np.mean([press.depth_mm for press in group]) for group in groups])
        return depths, np.array([np.mean([over_steady(press, hold_s) for press in group], axis=0) for group in groups])

    def _ratios(self, speed_mm_s: float, depth_mm: float, hold_s: float) -> NDArray:
        """Rise and hold over the steady force at a depth, between the presses of a speed."""
        depths, rows = self.over_steady_at(speed_mm_s, hold_s)
        position = np.clip(np.log(depth_mm), depths[0], depths[-1])
        at = int(np.clip(np.searchsorted(depths, position), 1, max(len(depths) - 1, 1)))
        if len(depths) == 1:
            return rows[0]
        share = (position - depths[at - 1]) / (depths[at] - depths[at - 1])
        return (1.0 - share) * rows[at - 1] + share * rows[at]

    def _steady_curve(self, hold_s: float) -> tuple[NDArray, NDArray]:
        groups = by_depth(self.presses)
        depth = np.array([np.mean([press.depth_mm for press in group]) for group in groups])
        force = np.array([np.mean([press.steady_N(hold_s) for press in group]) for group in groups])
        first = self._by_speed[self.velocities_mm_s[0]][0][0]
        x, rise = SHARES * first.depth_mm, np.maximum.accumulate(first.rise_N)
        log_depth, log_force = log_steady_curve(x, rise, depth, force)
        if len(log_depth) < 2:
            message = f"the press to {first.depth_mm:g} mm carries no force that rises with depth"
            raise InputError(message, "not_enough_data", "force_N")
        return smooth_curve(log_depth, log_force)


class MeasuredAim(MeasuredParameters):
    """The average of people, or on the strict side of all, at equal steady force.

    The mean of their ln depths and of their forces at equal shares of the depth and equal times of the hold
    (``average``), the smallest depth and the largest forces (``safe-side``), or the bounds of a share of people.
    """

    def __init__(self, people: Sequence[MeasuredPerson], aim: str) -> None:
        self.__dict__.update(people=tuple(people), aim=aim)

    people: tuple[MeasuredPerson, ...]
    aim: str

    @property
    def velocities_mm_s(self) -> tuple[float, ...]:
        """Speeds at which all were pressed. [mm/s]"""
        return tuple(sorted(set.intersection(*(set(one.velocities_mm_s) for one in self.people))))

    def hold_known_s(self) -> float:
        """Longest hold that all presses of all were held for. [s]"""
        return min(one.hold_known_s() for one in self.people)

    def known_N(self, velocity_mm_s: float, hold_s: float) -> tuple[float, float] | None:
        """Forces that all were pressed to at a speed, None where one was not. [N]"""
        return common_span(self.people, velocity_mm_s, hold_s)

    def depth_mm(self, force_N: ArrayLike, hold_s: float) -> NDArray:
        """Depth at forces at the end of a hold. [mm]"""
        depth = np.stack([one.depth_mm(force_N, hold_s) for one in self.people])
        if is_share(self.aim):
            return 1.0 / self._bound(1.0 / depth)
        return np.exp(np.log(depth).mean(axis=0)) if self.aim == "average" else depth.min(axis=0)

    def shape_N(self, force_N: float, velocity_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """Force at shares of the depth and at times of the hold. [N]"""
        rows = [one.shape_N(force_N, velocity_mm_s, hold_s) for one in self.people]
        rises, holds = (np.array(each) for each in zip(*rows))
        if is_share(self.aim):
            rises[:, 0] = 0.0  # at contact: what little one reads there says nothing of people
            return self._bound(rises), self._bound(holds)
        over = np.mean if self.aim == "average" else np.max
        return over(rises, axis=0), over(holds, axis=0)

    def _bound(self, readings: NDArray) -> NDArray:
        """Bound of the aimed share of people of readings (people, ...); the start of a rise may be 0."""
        share = share_of_aim(self.aim)
        assert share is not None
        return Population.of(np.maximum(readings, SMALLEST_N)).bound(share)


Measured = MeasuredPerson | MeasuredAim
