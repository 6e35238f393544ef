"""Press a pad to steady forces: each ramp stops where the force at the end of the hold is the wanted one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from dummydesign.core.errors import NoAnswerError
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.pad.pad import Pad, Puck
from dummydesign.pad.predict import MotionPrediction, depth_for_steady_force, predict_motion


@dataclass(frozen=True)
class RampPress:
    """One ramp and hold.

    Attributes
    ----------
    steady_force_N, velocity_mm_s : float
        Wanted at the end of the hold, and the speed of the ramp.
    depth_mm : float or None
        Where the ramp stops; None when the force is out of the pad's reach.
    prediction : MotionPrediction or None
        Along the ramp and the hold.
    out_of_reach : str
        Why there is none.
    """

    steady_force_N: float
    velocity_mm_s: float
    depth_mm: float | None
    prediction: MotionPrediction | None
    out_of_reach: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return force, speed, depth and, where the force is in reach, the curves and their peak as plain values."""
        asked = {"steady_force_N": self.steady_force_N, "velocity_mm_s": self.velocity_mm_s, "depth_mm": self.depth_mm}
        if self.prediction is None:
            return {**asked, "peak_force_N": None, "out_of_reach": self.out_of_reach}
        found = self.prediction.to_dict()
        curves = ("peak_force_N", "peak_time_s", "time_s", "displacement_mm", "force_N", "force_low_N", "force_high_N")
        return {**asked, **{name: found[name] for name in curves}}


def press_to_forces(
    pad: Pad | Puck, force_N: Sequence[float], velocity_mm_s: Sequence[float], hold_s: float,
    deceleration_mm_s2: float, fidelity: str = "table", progress: Callable[[float], None] | None = None,
) -> tuple[RampPress, ...]:  # fmt: skip
    """Press a pad to every force at every speed.

    Parameters
    ----------
    pad : Pad or Puck
        Pad, punch, modulus and relaxation.
    force_N, velocity_mm_s : sequence of float, shapes (forces,), (speeds,)
        Steady forces and speeds. [N, mm/s]
    hold_s, deceleration_mm_s2 : float
        Hold after the stop, and braking. [s, mm/s2]
    fidelity, progress
        As for :func:`dummydesign.pad.predict.predict_motion`.

    Returns
    -------
    tuple of RampPress
        Speed by speed, in the order of the forces.

    Raises
    ------
    NoAnswerError
        When every force is out of reach.
    """
    presses: list[RampPress] = []
    out_of_reach: NoAnswerError | None = None
    for velocity in velocity_mm_s:

        def motion_to(depth: float, velocity: float = velocity) -> Motion:
            return ramp_and_hold(velocity, depth, hold_s, deceleration_mm_s2)

        for force in force_N:
            try:
                depth = depth_for_steady_force(pad, force, hold_s, motion_to, fidelity)
            except NoAnswerError as problem:
                if problem.code != "out_of_reach":
                    raise
                out_of_reach = out_of_reach or problem
                presses.append(RampPress(force, velocity, None, None, str(problem)))
                continue
            prediction = predict_motion(pad, motion_to(depth), fidelity, progress)
            presses.append(RampPress(force, velocity, depth, prediction))
    if out_of_reach is not None and all(press.prediction is None for press in presses):
        raise out_of_reach
    return tuple(presses)
