"""The published protocol: every body is pressed to the depth at which its steady force is the same."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Motion, ramp_and_hold, work_mJ
from dummydesign.person.drives.drive import Drive, Response, not_kept
from dummydesign.person.integrate import held_after
from dummydesign.person.people import People
from dummydesign.person.press import SHORTEST_HOLD_S, Press
from dummydesign.person.signs import TraceSigns


class Steady(Drive):
    """Ramp and hold at the speed and braking of the trace, to the depth at which the force after the hold is the
    pad's."""

    name = form = "steady"
    curves = True
    words = (
        "the published protocol: each person is pressed at the trace's speed to the depth with the pad's steady force"
    )

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
        """Find each depth, and press."""
        hold, braking = press_of(press)
        forces = np.broadcast_to(np.maximum(np.asarray(press.steady_N), 1e-6), len(people))

        def coarse(depth: NDArray) -> Motion:
            return ramp_and_hold(press.velocity_mm_s, depth, hold, braking, 24, 12, 3)

        parts = people.gamma1, people.gamma, people.c
        depth = people.law.steady_depth(coarse, forces, *parts)
        motion = ramp_and_hold(press.velocity_mm_s, depth, hold, braking)
        force = np.maximum(people.law.force(motion, *parts), 0.0)
        return _response(motion, force, depth)

    def on_curves(self, press: Press, people: Sequence[Any]) -> Response:
        """The presses that were made, between their forces."""
        from dummydesign.tissue.model.laws.curves import CURVES

        hold, braking = press_of(press)
        steady = float(np.mean(np.asarray(press.steady_N)))
        motion, force, depth = CURVES.press(people, steady, press.velocity_mm_s, hold, braking)
        return _response(motion, force, depth)


def press_of(press: Press) -> tuple[float, float]:
    """Hold [s] and braking [mm/s2] of a press, as `compare` reads them."""
    from dummydesign.tissue.comparison import braking_of
    from dummydesign.tissue.fitting.reduction import reduce_trace

    reduced = reduce_trace(press.trace)
    return reduced.hold_s, braking_of(reduced, press.velocity_mm_s)


def _response(motion: Motion, force: NDArray, depth: NDArray) -> Response:
    x = motion.displacement_mm
    return Response(motion.time_s, x, force, force.max(axis=-1), force[..., -1], depth, work_mJ(x, force),
                    held_after(motion.time_s, force))  # fmt: skip
