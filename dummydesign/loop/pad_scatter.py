"""By how much the pads of a campaign differ of their own, what their records explain of it, and what would lower it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.serialise import Serialised
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import NORMAL_95, CampaignFit
from dummydesign.loop.model.campaign_law import THICKNESS_SLOPE, level_error
from dummydesign.measurement.campaign import Trial

FEWEST = 2
"""Pads with a record below which no share is stated."""
MOST_OF_IT = 0.5
"""Share of the rest that the errors of one kind of reading make, from which it is named."""


@dataclass(frozen=True)
class PadScatter(Serialised):
    """Own factors of the pads of a campaign, standard deviations of ln force at a given depth in per cent.

    ``size_percent`` is of the whole factor, ``left_percent`` of the part without a record, as the fit estimates it;
    ``explained`` the records' share of the whole's square, None with fewer than two pads that have a record: the two
    parts are independent, and their squares add up to the whole's. ``errors`` are those of the readings that the
    records state, by what was read, in per cent.
    """

    pads: int
    recorded: int
    size_percent: float
    left_percent: float
    explained: float | None
    errors: dict[str, float]
    lower_it: str
    text: str


def pad_scatter(fit: CampaignFit) -> PadScatter:
    """Own factors of the pads that a fit saw."""
    presses = fit.problem.presses
    stated, known = recorded_ln(presses)
    left = 100.0 * fit.sizes.law[0]
    size, explained = left, None
    if known.sum() >= FEWEST:
        size = float(np.hypot(left, 100.0 * np.std(stated[known], ddof=1)))
        explained = 1.0 - (left / size) ** 2
    errors = _errors(presses.trials)
    advice = _advice(errors, left, int(known.sum()), len(known))
    text = f"Each pad has a factor of its own of about {size:.2g} % (standard deviation)"
    if explained is not None:
        text += f"; the records explain {100.0 * explained:.0f} % of its square, and {left:.2g} % remains"
    return PadScatter(len(known), int(known.sum()), size, left, explained, errors, advice, f"{text}. {advice}.")


def carried_share(fit: CampaignFit) -> float:
    """Share of the levels that were found on pads that is the law's, and so that of other pads too.

    The law's own level is known within a factor of two (the spread of its prior); beyond twice its median the pads'
    levels are their own. Of independent parts the law's share of a level is its share of the square.
    """
    trials, (median, spread) = fit.problem.presses.trials, fit.problem.law.error_priors[0]
    recorded = np.mean([level_error(trial) ** 2 for trial in trials])
    own = np.sqrt(max(median**2 - recorded, 0.0)) * np.exp(NORMAL_95 * spread)
    return float(min(1.0, (own / fit.sizes.law[0]) ** 2))


def recorded_ln(presses: Presses) -> tuple[NDArray, NDArray]:
    """Logarithm of each pad's force as its record has it over the designed pad's, and which have a record (pads,)."""
    stated, known = np.zeros(len(presses.pads)), np.zeros(len(presses.pads), bool)
    for number, pad in enumerate(presses.pads):
        trial = next(one for one in presses.trials if one.pad == pad)
        known[number] = _read(trial) or trial.design_thickness_mm is not None
        stated[number] = np.log(trial.young_factor)
        if trial.design_thickness_mm:
            stated[number] -= THICKNESS_SLOPE * np.log(trial.thickness_mm / trial.design_thickness_mm)
    return stated, known


def recorded_spread(presses: Presses) -> float:
    """Standard deviation of what records say of the pads' moduli, in ln; 0 where fewer than two have one."""
    factors = {trial.pad: trial.young_factor for trial in presses.trials if _read(trial)}
    return float(np.std(np.log(list(factors.values())), ddof=1)) if len(factors) >= FEWEST else 0.0


def known_pads(trials: Sequence[Trial]) -> tuple[dict[str, Any], ...]:
    """What was known of each pad before it was pressed: modulus over the usual pad's, and thickness, with errors."""
    known = {
        trial.pad: {
            "thickness_mm": trial.thickness_mm,
            "thickness_sd_mm": trial.thickness_sd_mm,
            "young_factor": trial.young_factor,
            "young_factor_sd": trial.young_factor_sd or None,
        }
        for trial in trials
        if _read(trial) or trial.thickness_sd_mm
    }
    return tuple(known.values())


def _read(trial: Trial) -> bool:
    """Whether a witness or a weighing says something of a trial's pad."""
    read = trial.witness_kPa or trial.weighed_ratio
    return bool(read) and (trial.young_factor != 1.0 or trial.young_factor_sd > 0.0)


def _errors(trials: Sequence[Trial]) -> dict[str, float]:
    """Root mean square over pads of the stated errors, as they act on the force. [%]"""
    pads = {trial.pad: trial for trial in trials}.values()
    squares = {
        "modulus": [one.young_factor_sd for one in pads if one.young_factor_sd],
        "thickness": [THICKNESS_SLOPE * one.thickness_sd_mm / one.thickness_mm for one in pads if one.thickness_sd_mm],
    }
    return {name: float(100.0 * np.sqrt(np.mean(np.square(own)))) for name, own in squares.items() if own}


def _advice(errors: dict[str, float], left: float, recorded: int, pads: int) -> str:
    """What would lower the rest of the factor."""
    if recorded < pads:
        which = "each pad" if not recorded else f"the other {pads - recorded}"
        return f"To know it before a pad is pressed, weigh and gauge {which} and test a witness puck: mold record"
    worst = max(errors, key=lambda name: errors[name], default="")
    if worst and errors[worst] ** 2 >= MOST_OF_IT * left**2:
        todo = {"modulus": "test more witness pucks of each batch", "thickness": "gauge each pad where it is pressed"}
        return f"Most of the rest is the error of the {worst} ({errors[worst]:.2g} %): {todo[worst]}"
    return "The rest is of the force law or of the cure: press more pads"
