"""A relaxation slower or faster than the declared arms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.model.effect import PadEffect, Parameter, Values
from dummydesign.pad.material.relaxation import PronyTerm

USUAL_FAST_S, USUAL_SLOW_S, LONGEST_FAST_S, USUAL_BETA = 0.05, 1.5, 0.3, 0.2
FAST_S, SLOW_S, APART = 0.03, 4.0, 2.7
"""A mode is faster or slower than these times, or away from the declared arms by a factor ``APART``."""

LEAST_S, MOST_S = 0.002, 200.0
"""Times that a mode may have at all."""

VARIANCE = Parameter("variance", "1", 0.0, 0.0, 1.5, 0.3, spread=1.5)


class RelaxationMode(PadEffect):
    """A further arm (tau, beta), its time bounded away from the declared ones.

    A gel relaxes over a range of times: with a ``variance`` of ln tau, a form, the arm is two of half the strength, at
    tau exp(+-sqrt(variance)).
    """

    cause = "relaxation over more time scales than the declared arms hold"
    remedy = "hold longer for a slow mode, sample and press faster for a fast one"
    reference = "Pawluk and Howe, J. Biomech. Eng. 121 (1999) 178 (modes of 4 ms, 70 ms, 1.4 s)"
    always_fitted = True

    def __init__(
        self,
        name: str,
        signature: str,
        time: Parameter,
        base_starts: Callable[[NDArray], list[NDArray]],
        ends: Callable[[NDArray], tuple[float, float]],
    ) -> None:
        self.name, self.signature = name, signature
        self.parameters = (Parameter("beta", "1", 0.0, 0.0, 5.0, 0.05), time, VARIANCE)
        self._starts, self._ends = base_starts, ends

    def ends(self, parameter: Parameter, tau_s: NDArray) -> tuple[float, float]:
        return self._ends(tau_s) if parameter.name == "tau_s" else (parameter.low, parameter.high)

    def base_starts(self, logs: NDArray) -> list[NDArray]:
        # arms that are declared stay where they are
        return self._starts(logs) if len(logs) == 5 else [logs]

    def adds_terms(self, values: Values) -> tuple[PronyTerm, ...]:
        apart = float(np.exp(np.sqrt(values["variance"])))
        if apart == 1.0:
            return (PronyTerm(values["tau_s"], values["beta"]),)
        return tuple(PronyTerm(values["tau_s"] * one, 0.5 * values["beta"]) for one in (1.0 / apart, apart))


def _starts_slow(logs: NDArray) -> list[NDArray]:
    # without the mode the slow arm sits between its own time and the mode's, or is used up by the mode
    used_up = [logs[0], np.log(USUAL_FAST_S), np.log(USUAL_BETA), logs[1], logs[2]]
    return [logs + [0.0, 0.0, 0.0, -0.3, 0.0], np.array(used_up)]


def _starts_fast(logs: NDArray) -> list[NDArray]:
    used_up = [logs[0], min(logs[3], np.log(LONGEST_FAST_S)), logs[4], np.log(USUAL_SLOW_S), np.log(USUAL_BETA)]
    return [logs + [0.0, 0.4, 0.0, 0.0, 0.0], np.array(used_up)]


def _slower(tau_s: NDArray) -> tuple[float, float]:
    room = tau_s[np.r_[tau_s[1:] > APART**2 * tau_s[:-1], True]] if len(tau_s) else tau_s
    return min([SLOW_S, *(APART * room[:1])]), MOST_S


def _faster(tau_s: NDArray) -> tuple[float, float]:
    return LEAST_S, max([FAST_S, *(tau_s[:1] / APART)])


MEMBERS = (
    RelaxationMode(
        "slow_relaxation_mode",
        "slow drift of force through the whole hold, proportional to force",
        Parameter("tau_s", "s", 10.0, LEAST_S, MOST_S, 10.0, log=True, starts=(30.0,)),
        _starts_slow,
        _slower,
    ),
    RelaxationMode(
        "fast_relaxation_mode",
        "extra force in the fast ramp that is gone some hundredths of a second after the stop",
        Parameter("tau_s", "s", 0.01, LEAST_S, MOST_S, 0.01, log=True, starts=(0.02,)),
        _starts_fast,
        _faster,
    ),
)
"""Both are this class; the registry takes them in place of an instance of it."""
