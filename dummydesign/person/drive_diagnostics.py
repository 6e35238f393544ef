"""What a trace shows of the drive that made it: path kept, force kept, or speed lost to the pad alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dummydesign.core.serialise import Serialised
from dummydesign.person.press import SHORTEST_HOLD_S, Press

KEPT_MM, KEPT_SHARE = 0.04, 0.01
"""Creep in a hold up to which a path counts as kept: 0.04 mm, or 1 % of the depth. [mm]"""
RELAXED, FORCE_KEPT = 0.05, 0.03
"""Shares of the force at the stop that must relax for a path to be kept, and may change in a force that is kept."""
CREPT_SHARE = 0.02
FREE_MISFIT = 0.015
"""Share of the depth by which the path of a free mass may differ from the one that the force explains."""


@dataclass(frozen=True)
class TraceSigns(Serialised):
    """Signs of the drive in one press.

    ``looks_like`` is ``position``, ``force``, ``mass`` or None; ``creep_mm`` and ``relaxed_N`` are the changes from
    just after the stop to the end of the hold, None without a hold; ``mass_kg`` is the free mass that explains the
    path.
    """

    looks_like: str | None
    held_s: float
    creep_mm: float | None
    kept_mm: float
    relaxed_N: float | None
    force_N: float
    mass_kg: float | None


def signs_of(press: Press) -> TraceSigns:
    """Read the signs in a press."""
    depth = float(press.depth_mm)
    kept = max(KEPT_MM, KEPT_SHARE * depth)
    mass = _free_mass(press, depth)
    if press.hold_s < SHORTEST_HOLD_S:
        looks = "mass" if mass is not None else None
        return TraceSigns(looks, press.hold_s, None, kept, None, float(press.peak_N), mass)
    since = press.time_s - press.stop_s
    # the first samples of a hold still belong to the braking
    first = int(np.searchsorted(since, max(0.1 * press.stop_s, 0.02)))
    late = press.time_s >= press.time_s[-1] - 0.05 * press.hold_s
    creep = float(press.x_mm[late].mean() - press.x_mm[first])
    force = float(press.force_N[first])
    relaxed = force - float(press.force_N[late].mean())
    looks = None
    if abs(creep) <= kept and relaxed >= RELAXED * force:
        looks = "position"
    elif abs(relaxed) <= FORCE_KEPT * force and creep >= max(KEPT_MM, CREPT_SHARE * depth):
        looks = "force"
    return TraceSigns(looks, press.hold_s, creep, kept, relaxed, force, None)


def _free_mass(press: Press, depth: float) -> float | None:
    """Mass whose path x = v t - int int F / M explains the press up to its stop; None where none does. [kg]"""
    upto = slice(0, press.stopped + 1)
    time, force, x = press.time_s[upto], press.force_N[upto], press.x_mm[upto]
    if len(time) < 10:
        return None
    steps = np.diff(time)
    impulse = np.r_[0.0, np.cumsum(0.5 * (force[1:] + force[:-1]) * steps)]
    way = np.r_[0.0, np.cumsum(0.5 * (impulse[1:] + impulse[:-1]) * steps)]
    (speed, inverse), *_ = np.linalg.lstsq(np.stack([time, -way], axis=-1), x, rcond=None)
    left = x - speed * time + inverse * way
    stopped = inverse * impulse[-1] / speed if speed > 0 else 0.0
    if inverse <= 0.0 or float(np.max(np.abs(left))) > FREE_MISFIT * depth or not 0.8 < stopped < 1.2:
        return None
    return float(1e3 / inverse)
