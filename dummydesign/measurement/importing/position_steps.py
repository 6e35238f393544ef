"""A position that is written in steps, by its digits or by a slower source that is held: known where it changes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.baseline import digit_step
from dummydesign.measurement.importing.decisions import ImportLog

MIDDLE, SLOWER = 0.45, 2.5
"""Share of the travel about its middle that is on the way, and samples from one change to the next there from which a
position goes in steps."""
COARSE, WARNED = 0.003, 0.01
"""Step over the travel from which it matters, and from which there is a warning."""
FEWEST, AT_REST = 6, 0.05
"""Changes on the way between which a position is read, and share of the largest below which one is noise at rest."""
STANDS = 3.0
"""Multiple of the usual time between two changes beyond which the punch stands."""
EVEN, MOST = 0.02, 30.0
"""How far a rounded position's steps may be off multiples of one digit, and the largest multiple."""


def read_between_changes(time: NDArray, x: NDArray, log: ImportLog) -> tuple[NDArray, float]:
    """The position at each sample: between changes on a line, where it stands as it is written; its step. [mm]

    A rounded position is half way between two values where it changes; one that is held is that of the new value. The
    steps of a rounded position are all multiples of one digit.

    Parameters
    ----------
    time, x : ndarray, shape (n,)
        [s, mm]
    """
    step, reach = np.abs(np.diff(x)), float(np.ptp(x))
    rows = np.flatnonzero(step) + 1
    moves = step[rows - 1] > AT_REST * step.max()  # after an overshoot the hold is about the middle too
    way = rows[moves & (np.abs(x[rows] - x.min() - 0.5 * reach) < MIDDLE * reach)]
    if few := len(way) < FEWEST:
        stands, jump = np.diff(np.r_[0, rows, len(x)]), int(np.argmax(step[rows - 1])) if len(rows) else 0
        usual, size = 0.0, float(step.max()) if np.min(stands[jump : jump + 2]) >= SLOWER else 0.0
    else:
        usual, size = float(np.median(np.diff(time[way]))), float(np.median(step[way - 1]))
    stepped = size >= COARSE * reach and (few or usual >= SLOWER * float(np.median(np.diff(time))))
    size = size if stepped else digit_step(x)  # at speed every sample may change, by several digits
    if not stepped and size <= WARNED * reach:
        return x, 0.0
    if size > WARNED * reach:
        log.warn(
            "coarse_position",
            f"the position goes in steps of {size:.2g} mm: contact and depth are known to {size:.2g} mm only, the "
            f"speed to {100.0 * size / reach:.0f} %; record it with more digits, or as often as the force",
        )
    if few or not stepped:
        return x, size
    digits = step[rows - 1] / step[rows - 1].min()
    rounded = bool(np.all(np.abs(digits - np.round(digits)) < EVEN * digits)) and digits.max() < MOST
    after, before = (0.5, 0.5) if rounded else (0.0, 1.0)
    changes = (0.5 * (time[rows] + time[rows - 1]), 0.5 * (x[rows] + x[rows - 1])) if rounded else (time[rows], x[rows])
    stands = np.diff(time[rows]) > STANDS * usual
    begun, ended = time[rows[:-1]][stands] + after * usual, time[rows[1:]][stands] - before * usual
    ends = time[rows[0]] - before * usual, time[rows[-1]] + after * usual
    places = np.r_[time[0] - usual, ends[0], changes[0], begun, ended, ends[1]]
    values = np.r_[x[0], x[0], changes[1], np.tile(x[rows[:-1]][stands], 2), x[-1]]
    order = np.argsort(places, kind="stable")
    why = f"it changes every {usual:.3g} s only, by {size:.2g} mm: " + ("few digits" if rounded else "a slower source")
    log.decide("position", "read where it changes", why)
    return np.interp(time, places[order], values[order]), size
