"""Times that a press can be followed by: strictly rising within a recording, one recording after the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes


def recordings(
    file: str, time: NDArray, rows: NDArray, breaks: tuple[int, ...], lines: NDArray, notes: Notes
) -> tuple[NDArray, list[tuple[int, int]]]:
    """Find rows to keep and the recordings in them.

    A row that repeats the one before it word for word is left out. Where the time falls back to (about) its
    beginning, or where text parts the table, another recording begins.

    Parameters
    ----------
    file : str
        Name for messages.
    time : ndarray, shape (n,)
        As read, in file order. [s]
    rows : ndarray, shape (n, k)
        Numbers of each row.
    breaks : tuple of int
        Rows before which the table was interrupted by text.
    lines : ndarray of int, shape (n,)
        Line of the file of each row.
    notes : Notes
        Receives what was left out.

    Returns
    -------
    keep : ndarray of bool, shape (n,)
    ranges : list of (int, int)
        Half-open, counted in the rows that are kept.

    Raises
    ------
    InputError
        With the line, where the time stands still or goes back.
    """
    keep = np.ones(len(time), bool)
    still = np.flatnonzero(np.diff(time) == 0) + 1
    same = still[np.all(rows[still] == rows[still - 1], axis=1)] if still.size else still
    if same.size and same.size <= 0.02 * len(time):
        keep[same] = False
        notes.decide(
            "repeated rows", f"{same.size} rows", f"word for word the row before; the first is line {lines[same[0]]}"
        )
    kept, at = time[keep], lines[keep]
    jumps = np.diff(kept)
    wrong = np.flatnonzero(jumps <= 0) + 1
    shift = np.cumsum(keep) - 1
    parted = {int(shift[b]) for b in breaks}
    starts = [0]
    for row in wrong.tolist():
        begin = float(kept[starts[-1]])
        reached = float(kept[row - 1])
        back = reached - float(kept[row])
        if back > 0 and (row in parted or back > 0.9 * (reached - begin)) and row - starts[-1] >= 10:
            starts.append(row)
            continue
        _refuse(file, kept, row, at, jumps)
    if len(starts) > 1:
        notes.decide("recordings", str(len(starts)), f"the time begins again at line {int(at[starts[1]])}")
    ends = [*starts[1:], len(kept)]
    return keep, list(zip(starts, ends))


def _refuse(file: str, time: NDArray, row: int, lines: NDArray, jumps: NDArray) -> None:
    share = float(np.mean(jumps == 0))
    where = f"{file}:{int(lines[row])}"
    if share > 0.05:
        steps = jumps[jumps > 0]
        size = float(steps.min()) if steps.size else 0.0
        raise InputError(
            f"{where}: time = {time[row]:.6g} s is written {1 / max(1 - share, 1e-9):.1f} times on average: its last "
            f"digit ({size:.3g} s) is coarser than the sampling; export the time with more digits"
        )
    raise InputError(
        f"{where}: time = {time[row]:.6g} s does not rise (the row before has {time[row - 1]:.6g} s); sort the rows, "
        "or leave this one out"
    )
