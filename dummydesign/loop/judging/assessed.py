"""One fitted model with its errors, its lack of fit, and the intervals of its parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.size_likelihood import NORMAL_95
from dummydesign.loop.judging.lack_of_fit import LackOfFit, lack_of_fit
from dummydesign.loop.judging.left_out import Errors, errors
from dummydesign.loop.judging.uncertainty import widened
from dummydesign.loop.model.effect import Effect
from dummydesign.loop.model.parameters import NAMES


@dataclass(frozen=True)
class Stage:
    """A model with its errors and its lack of fit."""

    fit: Fit
    errors: Errors
    by_pad: Errors
    lack: LackOfFit

    def to_dict(self) -> dict[str, Any]:
        """Parameters with 95 % intervals, and errors."""
        return {
            "parameters": base_intervals(self.fit, self.lack.ratio),
            "error": {
                "train_rmse_N": self.errors.train_N,
                "heldout_rmse_N": self.errors.heldout_N,
                "heldout_pad_rmse_N": self.by_pad.heldout_N,
                "noise_floor_N": self.fit.sizes.floor_N,
                "lack_of_fit_p": self.lack.p,
                "lack_of_fit_ratio": self.lack.ratio,
            },
            "noise": self.fit.sizes.to_dict(),
        }


def make_stage(fit: Fit) -> Stage:
    """Measure a fit."""
    return Stage(fit, errors(fit), pad_errors(fit), lack_of_fit(fit))


def pad_errors(fit: Fit) -> Errors:
    """Errors with all trials on one pad left out at a time, and with them its law error."""
    return errors(fit, fit.problem.presses.pad)


def interval(fit: Fit, covariance: NDArray, place: int, to_value: Callable[[float], float]) -> dict[str, Any]:
    """Value with its 95 % interval.

    Parameters
    ----------
    fit : Fit
    covariance : ndarray, shape (n, n)
        Of its vector, see :func:`dummydesign.loop.judging.uncertainty.widened`.
    place : int
        Which entry of the parameter vector.
    to_value : callable
        From the fitted coordinate to the parameter in its unit; monotone.

    Returns
    -------
    dict
        ``value``, ``low``, ``high`` in the parameter's unit, and ``at_bound``.
    """
    low, high = fit.problem.bounds()
    at, spread = fit.vector[place], NORMAL_95 * float(np.sqrt(max(covariance[place, place], 0.0)))
    ends = sorted((to_value(max(at - spread, low[place])), to_value(min(at + spread, high[place]))))
    bound = bool(at <= low[place] + 1e-6 or at >= high[place] - 1e-6)
    return {"value": to_value(at), "low": ends[0], "high": ends[1], "at_bound": bound}


def base_intervals(fit: Fit, lack_ratio: float | None = None) -> dict[str, Any]:
    """Base parameters with 95 % intervals, widened by the lack of fit; modulus in kPa."""
    out, covariance = {}, widened(fit, lack_ratio)
    for place, name in enumerate(NAMES):
        unit = 1e3 if name == "young_kPa" else 1.0
        out[name] = interval(fit, covariance, place, lambda z, unit=unit: float(np.exp(z)) * unit)
    return out


def effect_intervals(stage: Stage, effect: Effect) -> dict[str, Any]:
    """Parameters of one fitted effect of a model with 95 % intervals, widened by its lack of fit."""
    fit, covariance = stage.fit, widened(stage.fit, stage.lack.ratio)
    place = fit.problem.fixed - sum(len(e.parameters) for e in fit.problem.effects)
    for other in fit.problem.effects:
        if other.name == effect.name:
            return {p.name: interval(fit, covariance, place + i, p.to_value) for i, p in enumerate(other.parameters)}
        place += len(other.parameters)
    raise KeyError(effect.name)
