"""The published protocol: every body is pressed to the depth at which its steady force is the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, work_to_deepest_mJ
from dummydesign.measurement.robot_path import RobotPath
from dummydesign.person.drive_diagnostics import TraceSigns
from dummydesign.person.drives.drive import RobotDrive, not_kept
from dummydesign.person.integrate import LATE_POINTS, PersonResponse
from dummydesign.person.people import People
from dummydesign.person.press import LATE, SHORTEST_HOLD_S, Press

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
        return _response(motion, force, own_late_mean(motion, force, LATE * press.hold_s))

    def on_curves(self, press: Press, people: Sequence[Any]) -> PersonResponse:
        """The presses that were made, between their forces."""
        from dummydesign.tissue.model.laws import CURVES

        hold, braking = press_of(press)
        steady = float(np.mean(np.asarray(press.steady_N)))
        motion, force, _ = CURVES.press(people, steady, press.velocity_mm_s, hold, braking)
        return _response(motion, force, force[..., -1])


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


def _response(motion: Motion, force: NDArray, steady: NDArray) -> PersonResponse:
    x = motion.displacement_mm
    return PersonResponse.of_curves(motion.time_s, x, force, steady, work_to_deepest_mJ(x, force))
