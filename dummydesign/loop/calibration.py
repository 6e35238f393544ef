"""The calibration file: base and corrected model of a campaign, for ``replay`` and for designing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.threads import one_blas_thread
from dummydesign.loop.data.reduction import HOLD, PRE, RISE, UNLOADING
from dummydesign.loop.data.trials import Presses, make_presses
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.noise import LAW_TERMS
from dummydesign.loop.model.base_law import PuckLaw, SlabLaw, law_of
from dummydesign.loop.model.forward_model import Active, LawError, simulate
from dummydesign.loop.model.parameters import BaseParameters
from dummydesign.loop.run import LoopResult, start_young_kPa
from dummydesign.measurement.campaign import Campaign
from dummydesign.pad.material.relaxation import PronyTerm

_PHASES = {PRE: "before_contact", RISE: "rise", HOLD: "hold", UNLOADING: "unloading"}


@dataclass(frozen=True)
class Model:
    """A fitted model: base parameters, effects, and the law error found on each thickness.

    Attributes
    ----------
    base : BaseParameters
    active : tuple of Active
    thickness_mm : ndarray, shape (h,)
    law : ndarray, shape (3, h)
        Level, slope and curvature of the law error.
    """

    base: BaseParameters
    active: tuple[Active, ...]
    thickness_mm: NDArray
    law: NDArray

    def law_error(self, thickness_mm: NDArray) -> LawError:
        """Law error on any thicknesses (T,): linear in the logarithm between the known, constant outside."""
        at = np.log(thickness_mm)
        return LawError(*(np.interp(at, np.log(self.thickness_mm), term) for term in self.law))

    def nodes(self, presses: Presses, law: SlabLaw | PuckLaw) -> NDArray:
        """Force at the nodes of other presses (T, N). [N]"""
        return simulate(presses, law, self.base, self.active, self.law_error(presses.thickness_mm))

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "base": self.base.to_dict(),
            "effects": [
                {"name": one.effect.name, "belongs_to": one.effect.belongs_to, "parameters": dict(one.values)}
                for one in self.active
            ],
            "law_error": {"thickness_mm": self.thickness_mm.tolist(), "level_slope_curve": self.law.tolist()},
        }


@dataclass(frozen=True)
class Calibration:
    """Base and corrected model, and how far a prediction is to be trusted.

    Attributes
    ----------
    base, after : Model
    verdict : str
    remainder_N : dict
        Root mean square of what the corrected model leaves, by phase of the press: a warning band.
    noise_floor_N : float
    pad : dict
        Set-up of the campaign: young_kPa_expected, resin, ratio, base, shape.
    """

    base: Model
    after: Model
    verdict: str
    remainder_N: dict[str, float]
    noise_floor_N: float
    pad: dict[str, Any]

    def prony(self) -> tuple[PronyTerm, ...]:
        """Relaxation of the corrected material at small strain, extra modes included."""
        arms = list(zip(self.after.base.tau_s, self.after.base.beta))
        for one in self.after.active:
            arms += [(term.tau_s, term.beta) for term in one.effect.adds_terms(one.values)]
        return tuple(PronyTerm(float(tau), float(beta)) for tau, beta in sorted(arms, key=lambda arm: arm[0]))

    def design_effects(self) -> tuple[Active, ...]:
        """Effects that belong to the pad, and so to every design; those of the rig and the sensor do not."""
        return tuple(one for one in self.after.active if one.effect.belongs_to == "pad")

    def on_pucks(self) -> bool:
        """Whether the campaign pressed pucks between plates."""
        return self.pad.get("shape", "slab") == "cylinder"


def model_of(fit: Fit) -> Model:
    """Take the model out of a fit."""
    law = np.array(np.split(fit.vector[fit.problem.fixed :], LAW_TERMS))
    return Model(fit.base, fit.active, fit.problem.thicknesses, law)


def calibration_of(result: LoopResult) -> Calibration:
    """Make the calibration of a loop's result, whatever its verdict."""
    presses, fit = result.presses, result.after.fit
    left = {}
    for code, name in _PHASES.items():
        use = presses.used & (presses.label // 100 == code)
        if use.any():
            left[name] = float(np.sqrt(np.average(fit.residual[use] ** 2, weights=presses.samples[use])))
    pad = {
        "young_kPa_expected": start_young_kPa(result.campaign),
        "resin": result.campaign.pad.resin,
        "ratio": result.campaign.pad.ratio,
        "base": result.campaign.pad.base,
        "shape": result.campaign.pad.shape,
    }
    return Calibration(
        model_of(result.base.fit), model_of(fit), result.verdict, left, fit.sizes.floor_N, pad
    )


@dataclass(frozen=True)
class Replayed:
    """A campaign predicted with a calibration: errors per trial and over all samples. [N]"""

    files: tuple[str, ...]
    rmse_N: NDArray
    base_rmse_N: NDArray
    peak_error_N: NDArray
    total_rmse_N: float
    total_base_rmse_N: float

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON of ``replay``."""
        rows = zip(self.files, self.rmse_N, self.base_rmse_N, self.peak_error_N)
        return {
            "trials": [
                {"file": file, "rmse_N": float(own), "base_rmse_N": float(base), "peak_error_N": float(peak)}
                for file, own, base, peak in rows
            ],
            "rmse_N": self.total_rmse_N,
            "base_rmse_N": self.total_base_rmse_N,
        }


@one_blas_thread()
def replay(campaign: Campaign, calibration: Calibration) -> Replayed:
    """Predict a campaign with the corrected and with the base model, nothing fitted.

    ``peak_error_N`` is modelled minus measured largest force, both smoothed over five samples.

    Raises
    ------
    InputError
        When an effect of the calibration has no value on these pads, or needs what the campaign does not declare.
    """
    law, presses = law_of(campaign), make_presses(campaign)
    for one in calibration.after.active:
        reason = one.effect.undefined(presses, law)
        if reason:
            raise InputError(f"the calibration holds {one.effect.name}, which this campaign cannot take: {reason}")
    after = presses.at_samples(calibration.after.nodes(presses, law))
    base = presses.at_samples(calibration.base.nodes(presses, law))
    measured = [trial.trace.force_N for trial in campaign.trials]

    def squares(model: list[NDArray]) -> list[float]:
        return [float(np.mean((f - m) ** 2)) for f, m in zip(measured, model)]

    weight = np.array([len(f) for f in measured])
    own, plain = np.array(squares(after)), np.array(squares(base))
    smooth = np.ones(5) / 5.0

    def peak(force: NDArray) -> float:
        return float(np.convolve(force, smooth, "valid").max())

    peaks = [peak(m) - peak(f) for f, m in zip(measured, after)]
    return Replayed(
        tuple(trial.file for trial in campaign.trials), np.sqrt(own), np.sqrt(plain), np.array(peaks),
        float(np.sqrt(np.average(own, weights=weight))), float(np.sqrt(np.average(plain, weights=weight))),
    )  # fmt: skip
