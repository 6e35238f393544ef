"""A campaign predicted with a calibration, nothing fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.threads import one_blas_thread
from dummydesign.loop.calibration import Calibration
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.effects.own import refuse_unsound
from dummydesign.loop.model.campaign_law import law_of
from dummydesign.loop.model.reach import within_reach
from dummydesign.measurement.campaign import Campaign


@dataclass(frozen=True)
class Replayed:
    """A campaign predicted with a calibration: errors per trial and over all samples. [N]"""

    files: tuple[str, ...]
    rmse_N: NDArray
    base_rmse_N: NDArray
    peak_error_N: NDArray
    total_rmse_N: float
    total_base_rmse_N: float
    left_out: str = ""
    """Presses deeper than the force law of their pad, in words; empty where there are none."""

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
def replay(
    campaign: Campaign, calibration: Calibration, progress: Callable[[str], None] | None = None
) -> Replayed:
    """Predict a campaign with the corrected and with the base model, nothing fitted.

    ``peak_error_N`` is modelled minus measured largest force, both smoothed over five samples.

    Parameters
    ----------
    campaign : Campaign
    calibration : Calibration
    progress : callable, optional
        Called with a word at each step.

    Raises
    ------
    InputError
        When an effect of the calibration has no value on these pads, or needs what the campaign does not declare.
    """
    tell = progress or (lambda word: None)
    law = law_of(campaign, progress)
    tell("presses")
    campaign, presses, left_out = within_reach(campaign, make_presses(campaign), law, least=1)
    for one in calibration.after.active:
        reason = one.effect.undefined(presses, law)
        if reason:
            raise InputError(f"the calibration holds {one.effect.name}, which this campaign cannot take: {reason}")
    refuse_unsound([one.effect for one in calibration.after.active], presses, law)
    tell("with what was found")
    after = presses.at_samples(calibration.after.nodes(presses, law))
    tell("with the base model")
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
        left_out,
    )  # fmt: skip
