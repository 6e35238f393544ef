"""Presses of many designs at one condition: forces over time, and what is read from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

FIRST_HOLD_S = 0.005
"""Time after the stop from which the hold counts, as in the tissue's own definition. [s]"""


@dataclass(frozen=True)
class Press:
    """Presses of D designs at one condition: arrays (D, n) over time, NaN where out of reach.

    Sample ``stopped`` is the stop of each, and from there on all have the same times.
    """

    time_s: NDArray
    force_N: NDArray
    stop_s: NDArray
    depth_mm: NDArray
    displacement_mm: NDArray
    stopped: int

    @cached_property
    def peak_N(self) -> NDArray:
        """Largest force of each press, shape (D,); NaN where out of reach. [N]"""
        return self.force_N.max(axis=-1)

    @cached_property
    def _hold(self) -> NDArray:
        """ln of the time since the stop, at least of 5 ms, in the hold of all presses, shape (n - stopped,)."""
        return np.log(np.maximum(self.time_s[0, self.stopped :] - self.stop_s[0], FIRST_HOLD_S))

    @cached_property
    def counted(self) -> NDArray:
        """Which samples count in a share of the press: not the first 5 ms of the hold. Indices, shape (m,)."""
        first = int(np.argmax(self._hold > np.log(FIRST_HOLD_S))) - 1
        return np.r_[: self.stopped + 1, self.stopped + max(first, 1) : self.time_s.shape[-1]]

    @cached_property
    def in_order(self) -> tuple[NDArray, NDArray]:
        """Order (D, m) of the counted samples of all presses in time, flat places, and these times (D m,). [s]"""
        times = self.time_s[:, self.counted]
        order = np.argsort(times, axis=None, kind="stable")
        return order.reshape(times.shape), times.ravel()[order]

    @cached_property
    def sample_weights(self) -> NDArray:
        """What counted samples (D, m) weigh in a share of the press: half the rise in time, half the hold in ln t."""
        weights = np.zeros_like(self.time_s)
        rise = np.diff(self.time_s[:, : self.stopped + 1], axis=-1)
        parts = weights[:, : self.stopped + 1], weights[:, self.stopped :]
        for own, step in zip(parts, (rise, np.diff(self._hold)[None])):
            step = step * (0.25 / step.sum(-1, keepdims=True))
            own[:, 1:] += step
            own[:, :-1] += step
        return weights[:, self.counted]

    @cached_property
    def energy_mJ(self) -> NDArray:
        """Integral of F dx from touch to stop, shape (D,); NaN where out of reach."""
        rise = slice(self.stopped + 1)
        return parabolic_work_mJ(self.displacement_mm[:, rise], self.force_N[:, rise])


def parabolic_work_mJ(displacement_mm: NDArray, force_N: NDArray) -> NDArray:
    """Integral of F dx by parabolas through every three samples, shape (D,). [mJ]

    Straight lines make too much of a force that bends upwards: 1.5 % on the coarse grid. Where a step is zero, and in a
    last step without a partner, lines are taken.

    Parameters
    ----------
    displacement_mm, force_N : ndarray, shape (D, n)
    """
    step = np.diff(displacement_mm, axis=-1)
    lines = 0.5 * (force_N[:, 1:] + force_N[:, :-1]) * step
    pairs = step.shape[-1] // 2 * 2
    first, second = step[:, 0:pairs:2], step[:, 1:pairs:2]
    low, middle, high = (force_N[:, start : start + pairs : 2] for start in range(3))
    whole = first + second
    with np.errstate(invalid="ignore", divide="ignore"):
        curved = (
            (2.0 - second / first) * low + whole**2 / (first * second) * middle + (2.0 - first / second) * high
        ) * whole / 6.0  # fmt: skip
    plain = lines[:, 0:pairs:2] + lines[:, 1:pairs:2]
    work = np.where((first > 0.0) & (second > 0.0), curved, plain)
    return np.asarray(work.sum(axis=-1) + lines[:, pairs:].sum(axis=-1))
