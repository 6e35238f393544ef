"""What a press was: speed, hold, depth, largest and steady force."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.landmarks import approach_velocity, find_ramp

SHORTEST_HOLD_S = 0.3
SHALLOWEST_MM = 0.02


@dataclass(frozen=True)
class Summary:
    """Numbers of one press; ``steady_force_N`` is the mean of the last twentieth of the hold, None without one."""

    velocity_mm_s: float
    hold_s: float
    depth_mm: float
    peak_force_N: float
    steady_force_N: float | None
    stop_time_s: float
    hold_end_s: float

    def to_dict(self) -> dict[str, Any]:
        """The five numbers of the contract."""
        kept = ("velocity_mm_s", "hold_s", "depth_mm", "peak_force_N", "steady_force_N")
        return {key: value for key, value in asdict(self).items() if key in kept}


def summarise(file: str, time: NDArray, x: NDArray, force: NDArray) -> Summary:
    """Summarise one press, zero at contact and compression positive.

    Parameters
    ----------
    file : str
        Name for messages.
    time, x, force : ndarray, shape (n,)
        The press, tared, x = 0 at contact. [s, mm, N]

    Returns
    -------
    Summary

    Raises
    ------
    InputError
        When the motion cannot be followed: it begins pressed, or never presses.
    """
    if x.max() < SHALLOWEST_MM:
        raise InputError(
            f"{file}: presses {x.max():.3g} mm deep only, counted from contact; is the displacement that of "
            "the punch? "
            "(--columns displacement=NAME, --contact N)"
        )
    try:
        ramp = find_ramp(time, x, "slowed")
    except InputError as problem:
        raise InputError(f"{file}: {problem}; record from before contact, or say --contact N") from None
    hold = max(ramp.hold_end_s - ramp.stop_time_s, 0.0)
    steady = None
    if hold >= SHORTEST_HOLD_S:
        late = (time >= ramp.hold_end_s - 0.05 * hold) & (time <= ramp.hold_end_s)
        steady = float(np.mean(force[late])) if late.any() else None
    speed = approach_velocity(time, x, ramp)
    held = 0.0 if steady is None else hold
    return Summary(
        float(speed), float(held), float(ramp.depth_mm), float(force.max()), steady, ramp.stop_time_s, ramp.hold_end_s
    )
