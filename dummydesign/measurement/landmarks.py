"""Contact, stop and end of hold of a measured press whose robot wanders and whose position has steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.motion import Ramp

STOPPED = 0.1
"""Share of the speed of the ramp below which the punch counts as stopped."""
STEP_MM = 0.005
LEAVE_MM = 0.06


def find_landmarks(time_s: NDArray, displacement_mm: NDArray) -> Ramp:
    """Find the landmarks of one ramp and hold.

    The stop is where the speed, over a window that steps of 5 um do not disturb, falls to a tenth of the
    speed between 20 and 60 % of the depth; unlike a depth to be reached, it does not move when the robot
    creeps by hundredths of a millimetre afterwards. The hold ends where the punch leaves for good; a motion
    that ends while it presses has its stop there and no hold.

    Parameters
    ----------
    time_s, displacement_mm : ndarray, shape (n,)
        One measured motion, compression positive. [s, mm]

    Raises
    ------
    InputError
        When the motion contains no compression or begins pressed.
    """
    time, x = np.asarray(time_s, float), np.asarray(displacement_mm, float)
    largest = float(x.max())
    if largest <= 0:
        text = f"the motion contains no compression: largest displacement_mm = {largest:g}; compression is positive"
        raise InputError(text)
    if x[0] > 0.1 * largest:
        raise InputError(f"the motion starts pressed at displacement_mm = {x[0]:g}; it must begin at or before contact")
    depth = float(np.median(x[x >= largest - max(0.05, 0.03 * largest)]))
    early, late = int(np.argmax(x >= 0.2 * depth)), int(np.argmax(x >= 0.6 * depth))
    below = np.nonzero(x[: early + 1] <= 0)[0]
    start = int(below[-1]) if below.size else 0
    contact = _cross(time, x, start)
    speed = (x[late] - x[start]) / max(time[late] - time[start], 1e-9)
    window = max(10.0 * STEP_MM / speed, 3.0 * float(np.median(np.diff(time[start : late + 4]))))
    ahead = np.interp(time[late:] + window, time, x) - x[late:]
    slow = np.nonzero((ahead <= STOPPED * speed * window) & (time[late:] + window <= time[-1]))[0]
    stop = float(time[late + (int(slow[0]) if slow.size else len(time) - late - 1)])
    return Ramp(contact, stop, _hold_end(time, x, depth, stop), depth, depth / max(stop - contact, 1e-9))


def _cross(time: NDArray, x: NDArray, before: int) -> float:
    """Time at which the line from a sample at or above the surface to the next one reaches it."""
    rise = x[before + 1] - x[before]
    if x[before] >= 0 or rise <= 0:
        return float(time[before])
    return float(time[before] - x[before] / rise * (time[before + 1] - time[before]))


def _hold_end(time: NDArray, x: NDArray, depth: float, stop: float) -> float:
    """Time at which the punch begins to leave for good. [s]"""
    wander = max(LEAVE_MM, 0.01 * depth)
    last = int(np.nonzero(x >= depth - wander)[0][-1])
    if last == len(time) - 1:
        return float(time[-1])
    after = min(last + 5, len(x) - 1)
    speed = (x[last] - x[after]) / (time[after] - time[last])
    return float(max(time[last] - wander / max(speed, 1e-9), stop))


def approach_velocity(time: NDArray, x: NDArray, ramp: Ramp) -> float:
    """Speed the robot was sent with: the fastest stretch of 0.4 depths before the stop, the approach included.

    A shallow press at 250 mm/s brakes all the way from the surface, so its mean speed says little. [mm/s]
    """
    before = time <= ramp.stop_time_s
    climb = np.maximum.accumulate(x[before])
    rising = np.r_[True, np.diff(climb) > 0]
    grid, climb = time[before][rising], climb[rising]
    stretch = 0.4 * ramp.depth_mm
    if len(grid) < 3 or climb[-1] - climb[0] <= stretch:
        return ramp.velocity_mm_s
    starts = np.linspace(climb[0], climb[-1] - stretch, 200)
    needed = np.interp(starts + stretch, climb, grid) - np.interp(starts, climb, grid)
    return float(stretch / needed.min())
