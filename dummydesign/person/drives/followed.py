"""Drives that give people what the trace shows: the pad's path, its force, or its steady force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, RobotPath
from dummydesign.person.drives.drive import RobotDrive, TraceSigns, not_kept
from dummydesign.person.integrate import LATE_POINTS, PersonResponse, follow_force, late_mean
from dummydesign.person.people import People
from dummydesign.person.press import LATE, SHORTEST_HOLD_S, Press
from dummydesign.person.validity_range import short_number


class Position(RobotDrive):
    """x(t) on people is x(t) on the pad, from contact on."""

    name = form = "position"
    words = "a stiff arm that presses people to the pad's depth at each time"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was not kept."""
        return not_kept(signs)

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Force of the law along the path."""
        time, force = press.time_s, people.force(press.time_s, press.x_mm)
        depth, steady = np.broadcast_to(press.x_mm, force.shape), late_mean(time, force, press.late_from_s)
        return PersonResponse.of_curves(time, depth, force, steady)


class Force(RobotDrive):
    """F(t) on people is F(t) on the pad; depth follows."""

    name = form = "force"
    words = "a clamp that controls its force and gives people the pad's force at each time"

    def contradicted(self, signs: TraceSigns) -> str:
        """Where the path was kept instead, or the pad took the speed."""
        if signs.looks_like == "position":
            return f"the force fell by {short_number(signs.relaxed_N or 0.0, 2)} N in the hold while the depth was kept"
        return not_kept(signs) if signs.looks_like == "mass" else ""

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Solve the law for the depth."""
        given = people, press.time_s, press.force_N, press.late_from_s
        return follow_force(*given) if keep else follow_force(*given, substeps=1, tolerance=1e-5)


SAME_SPEED = 0.95
"""Share of the speed of the approach from which on the robot counts as not yet braking at contact."""


class SteadyDrive(RobotDrive):
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

    def respond(self, press: Press, people: People, keep: bool = True) -> PersonResponse:
        """Find each depth, and press with the path of the trace, shifted along its way."""
        path = path_of(press, press_of(press)[1])
        forces = np.broadcast_to(np.maximum(np.asarray(press.steady_N), 1e-6), len(people))
        parts = people.gamma1, people.gamma, people.c
        depth = people.law.steady_depth(lambda wanted: path.to(wanted, coarse=True), forces, *parts)
        motion = path.to(depth)
        force = np.maximum(people.law.force(motion, *parts), 0.0)
        steady = own_late_mean(motion, force, LATE * press.hold_s)
        return PersonResponse.of_curves(motion.time_s, motion.displacement_mm, force, steady)

    def on_curves(self, press: Press, people: Sequence[Any]) -> PersonResponse:
        """The presses that were made, between their forces."""
        from dummydesign.tissue.model.laws import CURVES

        hold, braking = press_of(press)
        steady = float(np.mean(np.asarray(press.steady_N)))
        motion, force, _ = CURVES.press(people, steady, press.velocity_mm_s, hold, braking)
        return PersonResponse.of_curves(motion.time_s, motion.displacement_mm, force, force[..., -1])


def press_of(press: Press) -> tuple[float, float]:
    """Hold [s] and braking [mm/s2] of a press, as `compare` reads them."""
    from dummydesign.tissue.fitting.reduction import reduce_trace

    reduced = reduce_trace(press.trace)
    return reduced.hold_s, reduced.ramp.speed.braking_mm_s2


def path_of(press: Press, braking_mm_s2: float) -> RobotPath:
    """Take the path of a press; of drawn presses their mean."""
    x = press.x_mm if press.x_mm.ndim == 1 else press.x_mm.mean(axis=0)
    touch = float(np.mean(press.contact_mm_s))
    fast = press.velocity_mm_s if touch < SAME_SPEED * press.velocity_mm_s else touch
    return RobotPath(press.time_s, x - x[0], press.stop_s, touch, fast, braking_mm_s2)


def own_late_mean(motion: Motion, force: NDArray, last_s: float) -> NDArray:
    """Mean force over the last seconds of motions with their own times, shape (p,). [N]"""
    at = motion.time_s[:, -1:] - last_s * np.linspace(1.0, 0.0, LATE_POINTS)
    return np.array([np.interp(*row).mean() for row in zip(at, motion.time_s, force)])
