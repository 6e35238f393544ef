"""What is known of a pad before it is pressed: its own factor of the modulus, from its witness and its weighing.

A force is in proportion to the modulus, and pads of one recipe differ in it by what was weighed and by how they cured.
A witness puck of the batch and the weighed masses are read relative to those of the campaign's pads, so that what a
puck test reads too high on all pucks stays out. Thickness is not here: it acts through the force law.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.measurement.campaign import Campaign, Trial

PADS_DIFFER = 0.1
"""Standard deviation of ln modulus between pads of one recipe of which nothing is known. The polyurethane's modulus
changes by 17 % a per cent of its ratio; scales good to 0.1 g weigh 0.4 % of 26 g of its hardener (a pad of 200 g): 7 %,
and as much again for the cure: judgement."""
CURE = 0.07
"""The same of pads of which the weighed ratio is exactly known: the cure's share."""
WITNESS_SHARE = 0.03
"""Standard error of a witness's modulus over it where none is given, by judgement: its height and place."""
RATIO_STEP = 0.002
USUAL = ("usual_witness_kPa", "usual_weighed_ratio")
"""What a calibration remembers of the pads that its modulus is of: geometric means."""


def usual_of(trials: Sequence[Trial]) -> dict[str, float]:
    """Geometric means of witnesses and weighed ratios of the pads of some trials; empty where none is known."""
    usual = {}
    for key, name in zip(USUAL, ("witness_kPa", "weighed_ratio")):
        known = {trial.pad: getattr(trial, name) for trial in trials if getattr(trial, name)}
        if known:
            usual[key] = float(np.exp(np.mean(np.log(list(known.values())))))
    return usual


def with_pad_factors(campaign: Campaign, usual: Mapping[str, Any] | None = None) -> Campaign:
    """A campaign whose trials carry what is known of their pads' moduli, where something is.

    ``usual`` are the pads that the modulus is of, by the keys of :data:`USUAL`: those of a calibration that is used, or
    the campaign's own.
    """
    known = {key: value for key, value in (usual or {}).items() if key in USUAL and value}
    known = known or usual_of(campaign.trials)
    factors = {trial.pad: factor_of(trial, known, campaign) for trial in campaign.trials}
    if all(one is None for one in factors.values()):
        return campaign
    trials = []
    for trial in campaign.trials:
        mean, spread = factors[trial.pad] or (0.0, PADS_DIFFER)
        trials.append(replace(trial, young_factor=math.exp(mean), young_factor_sd=spread))
    return replace(campaign, trials=tuple(trials), usual_pad=known)


def factor_of(trial: Trial, usual: Mapping[str, float], campaign: Campaign) -> tuple[float, float] | None:
    """Mean and standard deviation of ln of a pad's modulus over the usual pad's; None where nothing is known.

    Before its witness a pad is as its weighing says, within what the cure and the scales leave; the witness is one
    reading of the same with an error of its own: both by their precision.
    """
    mean, spread, known = 0.0, PADS_DIFFER, False
    weighed, own = usual.get(USUAL[1]), trial.weighed_ratio
    slope = 0.0 if not (weighed and own) else _slope(campaign, weighed)
    if weighed and own and slope:
        scales = slope * (trial.weighed_ratio_sd or 0.0) / own
        if math.hypot(CURE, scales) < PADS_DIFFER:
            mean, spread, known = slope * math.log(own / weighed), math.hypot(CURE, scales), True
    witness = usual.get(USUAL[0])
    if witness and trial.witness_kPa:
        error = WITNESS_SHARE if trial.witness_sd_kPa is None else trial.witness_sd_kPa / trial.witness_kPa
        weight = spread**2 / (spread**2 + error**2)
        mean += weight * (math.log(trial.witness_kPa / witness) - mean)
        spread, known = math.sqrt(weight) * error, True
    return (mean, spread) if known else None


def _slope(campaign: Campaign, ratio: float) -> float:
    """d ln modulus / d ln ratio of a campaign's resin; 0 without a resin or outside its ratios."""
    from dummydesign.core.errors import InputError
    from dummydesign.resin import load_resin

    if campaign.pad.resin is None:
        return 0.0
    try:
        resin = load_resin(campaign.pad.resin)
        ends = [ratio * (1.0 - RATIO_STEP), ratio * (1.0 + RATIO_STEP)]
        resin.check_ratio(ends[0])
        resin.check_ratio(ends[1])
    except InputError:
        return 0.0
    low, high = (float(np.asarray(resin.young_MPa(one))) for one in ends)
    return math.log(high / low) / math.log(ends[1] / ends[0])
