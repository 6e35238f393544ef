"""The published protocol: every body is pressed to the depth at which its steady force is the same."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, work_mJ
from dummydesign.person.drives.drive import Drive, not_kept
from dummydesign.person.integrate import LATE_POINTS, Response
from dummydesign.person.people import People
from dummydesign.person.press import LATE, SHORTEST_HOLD_S, Press
from dummydesign.person.signs import TraceSigns


class Steady(Drive):
    """Approach, stop and hold as in the trace, to the depth at which the force at the end of the hold is the pad's."""

    name = form = "steady"
    curves = True
    words = "the published protocol, which presses each person to the depth with the pad's steady force"

    def check(self, press: Press) -> None:
        """Refuse a press without a hold, which has no steady force."""
        if press.steady_N is None:
            message = (
                f"{press.trace.name}: a hold of {press.hold_s:.3g} s has no steady force; --drive steady needs a hold "
                f"of {SHORTEST_HOLD_S:g} s at least, another drive needs none"
            )
            raise InputError(message, "not_enough_data", "hold_s", press.hold_s)
        steady = float(np.min(press.steady_N))
        if steady <= 0.0:
            message = f"{press.trace.name}: its steady force is {steady:.3g} N; it must be above 0"
            raise InputError(message, "out_of_range", "steady_force_N", steady)

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was not kept."""
        return not_kept(signs)

    def respond(self, press: Press, people: People, keep: bool = True) -> Response:
        """Find each depth, and press with the path of the trace, shifted along its way."""
        path = RobotPath.of(press, press_of(press)[1])
        forces = np.broadcast_to(np.maximum(np.asarray(press.steady_N), 1e-6), len(people))
        parts = people.gamma1, people.gamma, people.c
        depth = people.law.steady_depth(lambda wanted: path.to(wanted, coarse=True), forces, *parts)
        motion = path.to(depth)
        force = np.maximum(people.law.force(motion, *parts), 0.0)
        return _response(motion, force, own_late_mean(motion, force, LATE * press.hold_s))

    def on_curves(self, press: Press, people: Sequence[Any]) -> Response:
        """The presses that were made, between their forces."""
        from dummydesign.tissue.model.laws.curves import CURVES

        hold, braking = press_of(press)
        steady = float(np.mean(np.asarray(press.steady_N)))
        motion, force, _ = CURVES.press(people, steady, press.velocity_mm_s, hold, braking)
        return _response(motion, force, force[..., -1])


def press_of(press: Press) -> tuple[float, float]:
    """Hold [s] and braking [mm/s2] of a press, as `compare` reads them."""
    from dummydesign.tissue.comparison import braking_of
    from dummydesign.tissue.fitting.reduction import reduce_trace

    reduced = reduce_trace(press.trace)
    return reduced.hold_s, braking_of(reduced, press.velocity_mm_s)


def own_late_mean(motion: Motion, force: NDArray, last_s: float) -> NDArray:
    """Mean force over the last seconds of motions with their own times, shape (p,). [N]"""
    at = motion.time_s[:, -1:] - last_s * np.linspace(1.0, 0.0, LATE_POINTS)
    return np.array([np.interp(*row).mean() for row in zip(at, motion.time_s, force)])


def _response(motion: Motion, force: NDArray, steady: NDArray) -> Response:
    x = motion.displacement_mm
    return Response.of_curves(motion.time_s, x, force, steady, work_mJ(x, force))


SAME_SPEED = 0.95
"""Share of the speed of the approach from which on the robot counts as not yet braking at contact."""
RISE, COARSE = 128, 32
"""Even steps from contact to the stop, for curves and to find depths."""


@dataclass(frozen=True)
class RobotPath:
    """Path of a robot on the pad, from before contact on.

    Attributes
    ----------
    time_s, x_mm : ndarray, shape (n,)
        From contact to the end of the hold.
    stop_s : float
    contact_mm_s, approach_mm_s : float
        Speed at contact, and before the robot braked.
    braking_mm_s2 : float
        Deceleration before contact, where the two differ.
    """

    time_s: NDArray
    x_mm: NDArray
    stop_s: float
    contact_mm_s: float
    approach_mm_s: float
    braking_mm_s2: float

    @classmethod
    def of(cls, press: Press, braking_mm_s2: float) -> RobotPath:
        """Take the path of a press; of drawn presses their mean."""
        x = press.x_mm if press.x_mm.ndim == 1 else press.x_mm.mean(axis=0)
        touch = float(np.mean(press.contact_mm_s))
        fast = press.velocity_mm_s if touch < SAME_SPEED * press.velocity_mm_s else touch
        return cls(press.time_s, x - x[0], press.stop_s, touch, fast, braking_mm_s2)

    @property
    def depth_mm(self) -> float:
        """At the end of the hold."""
        return float(self.x_mm[-1])

    def contact_s(self, deeper_mm: NDArray) -> NDArray:
        """Time at which a body is touched that is pressed deeper than the pad by so much. [s]"""
        rise = self.time_s <= self.stop_s
        inside = np.interp(-deeper_mm, np.maximum.accumulate(self.x_mm[rise]), self.time_s[rise])
        braking, gain = self.braking_mm_s2, self.approach_mm_s - self.contact_mm_s
        way = 0.5 * gain * (self.approach_mm_s + self.contact_mm_s) / braking
        slow = np.minimum(np.maximum(deeper_mm, 0.0), way)
        time = (np.sqrt(self.contact_mm_s**2 + 2.0 * braking * slow) - self.contact_mm_s) / braking
        before = time + np.maximum(deeper_mm - way, 0.0) / self.approach_mm_s
        return np.where(deeper_mm > 0.0, -before, inside)

    def at(self, time_s: NDArray) -> NDArray:
        """Place of the punch, 0 at contact with the pad. [mm]"""
        back = np.maximum(-time_s, 0.0)
        slow = np.minimum(back, (self.approach_mm_s - self.contact_mm_s) / self.braking_mm_s2)
        before = self.contact_mm_s * slow + 0.5 * self.braking_mm_s2 * slow**2 + self.approach_mm_s * (back - slow)
        return np.where(time_s < 0.0, -before, np.interp(time_s, self.time_s, self.x_mm))

    def to(self, depth_mm: NDArray, coarse: bool = False) -> Motion:
        """Motion to depths at the end of the hold, shape (p,): time from contact, shapes (p, n).

        A coarse one ends halfway through the last twentieth of the hold, where the force is the steady force.
        """
        deeper = np.asarray(depth_mm, float) - self.depth_mm
        contact = np.minimum(self.contact_s(deeper), 0.999 * self.stop_s)[..., None]
        after = self.time_s[self.time_s > self.stop_s]
        if coarse:
            end = float(self.time_s[-1]) - 0.5 * LATE * (float(self.time_s[-1]) - self.stop_s)
            after = np.r_[after[after < end][:: RISE // COARSE], end]
        share = np.linspace(0.0, 1.0, (COARSE if coarse else RISE) + 1)
        rise = contact + (self.stop_s - contact) * share
        time = np.concatenate([rise, np.broadcast_to(after, (*deeper.shape, len(after)))], axis=-1)
        x = self.at(time) + deeper[..., None]
        x[..., 0] = 0.0
        return Motion(time - contact, x)
