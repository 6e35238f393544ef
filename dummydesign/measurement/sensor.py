"""The sensor chain: the low-pass that was applied to a force before it was saved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.recurrence import linear_recurrence
from dummydesign.core.serialise import Serialised


@dataclass(frozen=True)
class Lowpass(Serialised):
    """A Butterworth low-pass: cut-off [Hz] of one pass, order, and 1 pass (causal) or 2 (there and back)."""

    cutoff_hz: float
    order: int = 2
    passes: int = 1

    def __post_init__(self) -> None:
        if not (np.isfinite(self.cutoff_hz) and self.cutoff_hz > 0):
            raise out_of_range("low-pass cut-off in Hz", self.cutoff_hz, "above 0", "any finite frequency")
        if self.order not in range(1, 9):
            raise out_of_range("low-pass order", self.order, 1, 8)
        if self.passes not in (1, 2):
            raise out_of_range("low-pass passes", self.passes, 1, 2, "2 is there and back without delay")

    def apply(self, time_s: ArrayLike, force_N: ArrayLike) -> NDArray:
        """Filter a force on any, also uneven, sampling.

        The analogue filter is solved exactly for a force that is linear between its samples: each pole p
        with residue q gives y' = p y + q u. Before the first sample the force is taken as constant.
        Two passes run there and back (no delay); the cut-off is that of one pass, so that the sum is
        6 dB down there.

        References
        ----------
        S. Butterworth, Experimental Wireless 7 (1930) 536. The paper's own filter is "second-order ... 35 Hz"
        (section II-C); its kind and number of passes are not stated.
        """
        time, force = np.asarray(time_s, float), np.asarray(force_N, float)
        step = np.diff(time, axis=-1)
        if np.any(step <= 0):
            raise InputError("time_s must increase strictly", "malformed", "time_s")
        once = _one_pass(step, force, self.cutoff_hz, self.order)
        if self.passes == 1:
            return once
        return _one_pass(step[..., ::-1], once[..., ::-1], self.cutoff_hz, self.order)[..., ::-1]


def parse_lowpass(text: str | None) -> Lowpass | None:
    """Read ``HZ[:ORDER[:PASSES]]`` as given on the command line; None stays None."""
    if text is None:
        return None
    cutoff, *counts = text.split(":")
    try:
        return Lowpass(float(cutoff), *map(int, counts))
    except (TypeError, ValueError):  # more than three parts, or one that is no number
        raise InputError(
            f"low-pass '{text}' is not HZ[:ORDER[:PASSES]], such as 35 or 35:2:1", "malformed", "lowpass", text
        ) from None


def _one_pass(step: NDArray, force: NDArray, cutoff_hz: float, order: int) -> NDArray:
    """Run the filter forward once; ``step`` are the time steps."""
    cutoff = 2.0 * np.pi * cutoff_hz
    poles = cutoff * np.exp(1j * np.pi * (2 * np.arange(order) + order + 1) / (2 * order))
    filtered = np.zeros(np.broadcast_shapes(force.shape, (*step.shape[:-1], force.shape[-1])))
    slope = np.diff(force, axis=-1) / step
    for index, pole in enumerate(poles):
        if pole.imag < -1e-9 * cutoff:
            continue  # its conjugate is counted twice
        residue = cutoff**order / np.prod(pole - np.delete(poles, index))
        weight = 1.0 if abs(pole.imag) <= 1e-9 * cutoff else 2.0
        change = pole * step
        growth = np.expm1(change)
        constant = growth / pole
        ramp = (growth - change) / pole**2
        # (e^z - 1 - z) loses its digits for small z; its series does not
        small = np.abs(change) < 1e-3
        ramp = np.where(small, step**2 * (0.5 + change / 6 + change**2 / 24), ramp)
        addend = residue * (force[..., :-1] * constant + slope * ramp)
        first = -residue / pole * force[..., 0]
        state = linear_recurrence(np.exp(change), addend, first)
        filtered[..., 1:] += weight * state.real
        filtered[..., 0] += weight * first.real
    return filtered
