"""Presses of one tissue by condition: speeds and depths that count as the same."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dummydesign.tissue.fitting.reduction import ReducedTrace


def rounded_velocity(velocity_mm_s: float) -> float:
    """Nominal speed of a measured one: two significant digits. [mm/s]"""
    return float(f"{velocity_mm_s:.2g}")


def speed_groups(traces: Sequence[ReducedTrace]) -> list[tuple[float, list[ReducedTrace]]]:
    """Group traces whose speeds are within 15 % of their neighbour's: (nominal speed, traces), rising.

    The nominal speed is that which the robot was told, where all of a group were told one; else two digits of the
    median.
    """
    ordered = sorted(traces, key=lambda trace: trace.velocity_mm_s)
    groups: list[list[ReducedTrace]] = []
    for trace in ordered:
        if groups and trace.velocity_mm_s < 1.15 * groups[-1][-1].velocity_mm_s:
            groups[-1].append(trace)
        else:
            groups.append([trace])
    return [(_nominal(group), group) for group in groups]


def _nominal(group: Sequence[ReducedTrace]) -> float:
    told = {trace.trace.told_mm_s for trace in group}
    if len(told) == 1 and None not in told:
        return group[0].velocity_mm_s
    return rounded_velocity(float(np.median([trace.velocity_mm_s for trace in group])))


def condition_groups(traces: Sequence[ReducedTrace]) -> list[tuple[float, float, list[ReducedTrace]]]:
    """Group by speed and by depth (5 % apart at most); (speed, mean depth, traces)."""
    found = []
    for speed, group in speed_groups(traces):
        ordered = sorted(group, key=lambda trace: trace.ramp.depth_mm)
        parts: list[list[ReducedTrace]] = []
        for trace in ordered:
            if parts and trace.ramp.depth_mm < 1.05 * parts[-1][-1].ramp.depth_mm:
                parts[-1].append(trace)
            else:
                parts.append([trace])
        found += [(speed, float(np.mean([t.ramp.depth_mm for t in part])), part) for part in parts]
    return found
