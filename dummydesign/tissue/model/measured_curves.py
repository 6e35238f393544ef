"""People as measured curves of force over depth, speed and time, without a law: what was pressed, and between presses.

Between the presses of one speed, forces over the steady force are linear in ln depth; between speeds in ln speed; the
steady curve is a monotone cubic of ln force over ln depth through its points, and below the shallowest press it is the
rise of that press of the slowest speed, scaled to its steady force. Nothing is carried on further than a press
belongs to a force (20 %) or a speed (15 %).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.tissue.model.held_press import (
    SHARES,
    SPEED_APART,
    START_SHARE,
    HeldPress,
    by_depth,
    by_speed,
    carried_on,
    over_steady,
    smooth_curve,
)
from dummydesign.tissue.model.parameters import Parameters

if TYPE_CHECKING:
    from dummydesign.measurement.motion import Motion

LAW = "curves"


class MeasuredParameters(Parameters):
    """What stands where parameters of a law stand: there are none, and whoever asks for one is told so."""

    def __init__(self) -> None:
        for name, value in (("law", LAW), ("gamma_N_per_mm3", ()), ("c_N_s_per_mm", ())):
            object.__setattr__(self, name, value)

    __eq__ = object.__eq__
    __hash__ = object.__hash__
    __repr__ = object.__repr__

    @property
    def gamma1_N_per_mm3(self) -> float:  # type: ignore[override]
        """There is none."""
        raise InputError("measured curves have no parameters; this needs a tissue with a law, such as ode")

    def to_dict(self) -> dict[str, str]:
        """Return the law's name alone."""
        return {"law": LAW}

    def force(self, motion: Motion, velocity_mm_s: float) -> NDArray:
        """Force under any motion, which curves do not give."""
        raise InputError("measured curves give the presses that were made, not the force under any motion")

    def hold_known_s(self) -> float:
        """Longest hold that all presses were held for. [s]"""
        raise NotImplementedError

    def known_N(self, velocity_mm_s: float, hold_s: float) -> tuple[float, float] | None:
        """Lowest and highest steady force that was pressed at a speed, None for a speed that was not. [N]"""
        raise NotImplementedError

    def depth_mm(self, force_N: ArrayLike, hold_s: float) -> NDArray:
        """Depth at forces at the end of a hold. [mm]"""
        raise NotImplementedError

    def shape_N(self, force_N: float, velocity_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """Force at :data:`SHARES` of the depth and at :func:`hold_times` of a press to a force at its end. [N]

        Parameters
        ----------
        force_N, velocity_mm_s, hold_s : float
            Of the press. [N, mm/s, s]
        """
        raise NotImplementedError


class MeasuredPerson(MeasuredParameters):
    """The presses of one person."""

    def __init__(self, presses: Sequence[HeldPress]) -> None:
        super().__init__()
        object.__setattr__(self, "presses", tuple(presses))
        object.__setattr__(self, "_by_speed", by_speed(presses))
        object.__setattr__(self, "_curves", {})

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
        pairs = self._speeds(velocity_mm_s)
        if not pairs:
            return None
        ends = []
        for speed, _ in pairs:
            forces = [np.mean([press.steady_N(hold_s) for press in group]) for group in self._by_speed[speed]]
            ends.append((min(forces), max(forces)))
        return float(max(low for low, _ in ends)), float(min(high for _, high in ends))

    def depth_mm(self, force_N: ArrayLike, hold_s: float) -> NDArray:
        """Depth at forces at the end of a hold, on the steady curve of all presses. [mm]"""
        log_depth, log_force = self.steady_curve(hold_s)
        return np.exp(carried_on(np.log(np.maximum(force_N, 1e-12)), log_force, log_depth))

    def steady_N(self, depth_mm: ArrayLike, hold_s: float) -> NDArray:
        """Force at the end of a hold at depths. [N]"""
        log_depth, log_force = self.steady_curve(hold_s)
        return np.exp(carried_on(np.log(np.maximum(depth_mm, 1e-12)), log_depth, log_force))

    def steady_curve(self, hold_s: float) -> tuple[NDArray, NDArray]:
        """Points of ln depth and ln steady force, rising. [ln mm, ln N]"""
        key = min(hold_s, self.hold_known_s())
        if key not in self._curves:
            self._curves[key] = self._steady_curve(key)
        return self._curves[key]

    def shape_N(self, force_N: float, velocity_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """Force at :data:`SHARES` of the depth and at :func:`hold_times` of a press to a force at its end. [N]

        Parameters
        ----------
        force_N, velocity_mm_s, hold_s : float
            Of the press. [N, mm/s, s]
        """
        depth = float(self.depth_mm(force_N, hold_s))
        rows = [share * self._ratios(speed, depth, hold_s) for speed, share in self._speeds(velocity_mm_s)]
        mean = np.sum(rows, axis=0)
        return force_N * mean[: len(SHARES)], force_N * mean[len(SHARES) :]

    def rise_at(self, velocity_mm_s: float) -> tuple[NDArray, NDArray] | None:
        """Depth and force of the rise at a speed, to the deepest press there; None for one that was not pressed.

        Between two speeds the forces at equal depth are linear in ln speed, to the smaller of both depths. [mm, N]
        """
        pairs = [(self._by_speed[speed][-1], share) for speed, share in self._speeds(velocity_mm_s)]
        if not pairs:
            return None
        depths = [float(np.mean([press.depth_mm for press in group])) for group, _ in pairs]
        x = SHARES * min(depths)
        forces = [
            share * np.interp(x, SHARES * depth, np.mean([press.rise_N for press in group], axis=0))
            for (group, share), depth in zip(pairs, depths)
        ]
        return x, np.sum(forces, axis=0)

    def _speeds(self, velocity_mm_s: float) -> list[tuple[float, float]]:
        """Speeds that stand for a speed, with their shares: itself, or its two neighbours; none outside them."""
        known = np.array(self.velocities_mm_s)
        nearest = float(known[np.argmin(np.abs(np.log(known / velocity_mm_s)))])
        if 1.0 / SPEED_APART < nearest / velocity_mm_s < SPEED_APART:
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
        place = np.clip(np.log(depth_mm), depths[0], depths[-1])
        at = int(np.clip(np.searchsorted(depths, place), 1, max(len(depths) - 1, 1)))
        if len(depths) == 1:
            return rows[0]
        share = (place - depths[at - 1]) / (depths[at] - depths[at - 1])
        return (1.0 - share) * rows[at - 1] + share * rows[at]

    def _steady_curve(self, hold_s: float) -> tuple[NDArray, NDArray]:
        groups = by_depth(sorted(self.presses, key=lambda press: press.depth_mm))
        knots = [
            (np.mean([press.depth_mm for press in group]), np.mean([press.steady_N(hold_s) for press in group]))
            for group in groups
        ]
        depth, force = np.array(knots).T
        first = self._by_speed[self.velocities_mm_s[0]][0][0]
        x, rise = SHARES * first.depth_mm, np.maximum.accumulate(first.rise_N)
        start = (x > START_SHARE * depth[0]) & (x < 0.97 * depth[0]) & (rise > 0.0)
        level = force[0] / float(np.interp(depth[0], x, rise))
        log_depth, log_force = np.log(np.r_[x[start], depth]), np.log(np.r_[rise[start] * level, force])
        rising = np.r_[True, np.diff(np.maximum.accumulate(log_force)) > 0.0]
        if rising.sum() < 2:
            raise InputError(f"the press to {first.depth_mm:g} mm carries no force that rises with depth")
        return smooth_curve(log_depth[rising], log_force[rising])


class MeasuredAim(MeasuredParameters):
    """What lies in the middle of people, or on the strict side of all, at equal steady force.

    The mean of their ln depths and of their forces at equal shares of the depth and equal times of the hold
    (``average``), or the smallest depth and the largest forces (``safe-side``).
    """

    def __init__(self, people: Sequence[MeasuredPerson], aim: str) -> None:
        super().__init__()
        object.__setattr__(self, "people", tuple(people))
        object.__setattr__(self, "aim", aim)

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
        ends = [one.known_N(velocity_mm_s, hold_s) for one in self.people]
        whole = [pair for pair in ends if pair is not None]
        return (max(p[0] for p in whole), min(p[1] for p in whole)) if len(whole) == len(ends) else None

    def depth_mm(self, force_N: ArrayLike, hold_s: float) -> NDArray:
        """Depth at forces at the end of a hold. [mm]"""
        depth = np.stack([one.depth_mm(force_N, hold_s) for one in self.people])
        return np.exp(np.log(depth).mean(axis=0)) if self.aim == "average" else depth.min(axis=0)

    def shape_N(self, force_N: float, velocity_mm_s: float, hold_s: float) -> tuple[NDArray, NDArray]:
        """Force at shares of the depth and at times of the hold. [N]

        Parameters
        ----------
        force_N, velocity_mm_s, hold_s : float
            Of the press. [N, mm/s, s]
        """
        rows = [one.shape_N(force_N, velocity_mm_s, hold_s) for one in self.people]
        over = np.mean if self.aim == "average" else np.max
        return over([rise for rise, _ in rows], axis=0), over([hold for _, hold in rows], axis=0)
