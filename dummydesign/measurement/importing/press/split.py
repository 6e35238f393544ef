"""Presses in one recording: where force and depth return to zero, it is another press."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.press.signs import middle_of_three, noise_of

LOW, HIGH = 0.01, 0.03
"""Shares of the largest force below which it is zero, and above which it is a press."""
PAUSE = 0.5
"""Share of the time between two presses above which one step of it is a pause of the recording."""
BACK = 0.3
"""Share of its depth that the punch must come back before the next press is one of its own."""


@dataclass(frozen=True)
class Span:
    """One press in a recording.

    Attributes
    ----------
    start, stop : int
        Its samples, from where the punch rests before it to where it rests after it.
    onset : int
        First sample at which the force stands clearly above zero.
    """

    start: int
    stop: int
    onset: int


def thresholds(load: NDArray) -> tuple[float, float]:
    """Force that is zero, and force that is a press, by the noise and the largest force. [N]"""
    few = int(np.clip(len(load) // 200, 3, 50))
    noise = max(noise_of(load), min(float(np.std(load[:few])), 0.01 * float(load.max())))
    peak = float(load.max())
    return max(6.0 * noise, LOW * peak), max(12.0 * noise, HIGH * peak)


def find_presses(
    file: str, x: NDArray, load: NDArray, several: bool, time: NDArray | None = None
) -> list[Span]:
    """Find the presses.

    Parameters
    ----------
    file : str
        Name for messages.
    x, load : ndarray, shape (n,)
        Compression positive; force less its reading at rest. [mm, N]
    several : bool
        Whether more than one may be found; else all is one press.
    time : ndarray, shape (n,), optional
        A pause of the recording between two presses parts them. [s]

    Returns
    -------
    list of Span
        In order; together they hold all samples.

    Raises
    ------
    InputError
        When nothing is pressed.
    """
    smooth = middle_of_three(load)
    low, high = thresholds(smooth)
    runs = [(a, b) for a, b in _runs(_touching(x, smooth, low)) if smooth[a:b].max() >= high]
    depth = _depth(x, smooth, runs)
    runs = [run for run in runs if not _jolt(x, smooth, run, depth)]
    if not runs:
        raise InputError(f"{file}: nothing is pressed: the force stays within {high:.3g} N of its reading at rest")
    joined = [runs[0]]
    for run in runs[1:]:
        if several and _came_back(x, joined[-1], run):
            joined.append(run)
        else:
            joined[-1] = (joined[-1][0], run[1])
    if not several:
        joined = [(joined[0][0], joined[-1][1])]
    at = np.arange(len(x), dtype=float) if time is None else time
    cuts = [0, *(_cut(at, x, before[1], after[0]) for before, after in pairwise(joined)), len(x)]
    return [Span(a, b, run[0]) for a, b, run in zip(cuts, cuts[1:], joined)]


def _touching(x: NDArray, smooth: NDArray, low: float) -> NDArray:
    """Where the punch touches: the force is above zero, unless it is small and the punch is out all the same.

    The second half is for a force whose zero has drifted away since the start.
    """
    touching = smooth > low
    peak = int(np.argmax(smooth))
    before = np.nonzero(~touching[:peak])[0]
    start = int(before[-1]) if before.size else 0
    way = float(x[peak] - x[start])
    if way > 0:
        touching = touching & ~((x < x[start] - 0.05 * way) & (smooth < 0.2 * smooth[peak]))
    return touching


def _runs(mask: NDArray) -> list[tuple[int, int]]:
    """Half-open ranges in which a mask is true."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], mask.astype(np.int8), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist()))


def _depth(x: NDArray, smooth: NDArray, runs: list[tuple[int, int]]) -> float:
    if not runs:
        return 0.0
    a, b = max(runs, key=lambda run: float(smooth[run[0] : run[1]].max()))
    return float(x[a:b].max() - x[a])


def _jolt(x: NDArray, smooth: NDArray, run: tuple[int, int], depth: float) -> bool:
    """A force without way: the jolt of the punch when the robot starts or stops in the air, or a spike."""
    a, b = run
    return bool(smooth[a:b].max() < 0.3 * smooth.max() and np.ptp(x[a:b]) < 0.1 * depth)


def _came_back(x: NDArray, before: tuple[int, int], after: tuple[int, int]) -> bool:
    deepest = float(x[before[0] : before[1]].max())
    return deepest - float(x[before[1] : after[0]].min()) >= BACK * (deepest - float(x[before[0]]))


def _cut(time: NDArray, x: NDArray, leave: int, touch: int) -> int:
    """Where one press ends and the next begins: at a pause of the recording while the punch is farthest out.

    Without a pause it is the middle of the samples there.
    """
    gap = x[leave:touch]
    low, high = float(gap.min()), float(max(gap[0], gap[-1]))
    far = np.nonzero(gap <= low + 0.05 * (high - low))[0]
    steps = np.diff(time[leave + far])
    if steps.size and steps.max() > PAUSE * (time[leave + far[-1]] - time[leave + far[0]]):
        return leave + int(far[int(np.argmax(steps)) + 1])
    return leave + int(far[len(far) // 2]) + (1 if len(far) == 1 else 0)
