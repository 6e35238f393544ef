"""The sensor chain: the low-pass that was applied to a force before it was saved."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.recurrence import linear_recurrence


@dataclass(frozen=True)
class Lowpass:
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
        """Filter a force; see :func:`lowpass`."""
        return lowpass(time_s, force_N, self.cutoff_hz, self.order, self.passes)

    def to_dict(self) -> dict[str, Any]:
        """Return cut-off, order and passes."""
        return asdict(self)


def parse_lowpass(text: str | None) -> Lowpass | None:
    """Read ``HZ[:ORDER[:PASSES]]`` as given on the command line; None stays None.

    Raises
    ------
    InputError
        When the text is not of this form or a number is out of range.
    """
    if text is None:
        return None
    parts = text.split(":")
    try:
        if not 1 <= len(parts) <= 3:
            raise ValueError
        return Lowpass(float(parts[0]), *(int(part) for part in parts[1:]))
    except ValueError:
        raise InputError(f"low-pass '{text}' is not HZ[:ORDER[:PASSES]], such as 35 or 35:2:1") from None


def lowpass(time_s: ArrayLike, force_N: ArrayLike, cutoff_hz: float = 35.0, order: int = 2, passes: int = 1) -> NDArray:
    """Butterworth low-pass of a force on any, also uneven, sampling.

    The analogue filter is solved exactly for a force that is linear between its samples: each pole p
    with residue q gives y' = p y + q u. Before the first sample the force is taken as constant.
    Two passes run there and back (no delay); the cut-off is that of one pass, so that the sum is
    6 dB down there.

    Parameters
    ----------
    time_s : array_like, shape (n,) or (..., n)
        Increasing times. [s]
    force_N : array_like, shape (..., n)
        Force, one row per curve. [N]
    cutoff_hz : float
        Frequency at which one pass is 3 dB down. [Hz]
    order, passes : int
        Order of the filter (1 to 8), passes 1 or 2.

    Returns
    -------
    ndarray, shape (..., n)
        Filtered force. [N]

    References
    ----------
    S. Butterworth, Experimental Wireless 7 (1930) 536. The paper's own filter is "second-order ... 35 Hz"
    (section II-C); its kind and number of passes are not said.
    """
    Lowpass(cutoff_hz, order, passes)
    time, force = np.asarray(time_s, float), np.asarray(force_N, float)
    if np.any(np.diff(time, axis=-1) <= 0):
        raise InputError("time_s must increase strictly")
    once = _one_pass(np.diff(time, axis=-1), force, cutoff_hz, order)
    if passes == 1:
        return once
    return _one_pass(np.diff(time, axis=-1)[..., ::-1], once[..., ::-1], cutoff_hz, order)[..., ::-1]


def _one_pass(step: NDArray, force: NDArray, cutoff_hz: float, order: int) -> NDArray:
    """Run the filter forward once; ``step`` are the time steps."""
    cutoff = 2.0 * np.pi * cutoff_hz
    poles = cutoff * np.exp(1j * np.pi * (2 * np.arange(order) + order + 1) / (2 * order))
    filtered = np.zeros(np.broadcast_shapes(force.shape, (*step.shape[:-1], force.shape[-1])))
    slope = np.diff(force, axis=-1) / step
    for index, pole in enumerate(poles):
        if pole.imag < -1e-9 * cutoff:
            continue  # its conjugate is counted twice
        others = np.delete(poles, index)
        residue = cutoff**order / np.prod(pole - others)
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
