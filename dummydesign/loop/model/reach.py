"""Presses that go deeper than the force law of their pad holds do not enter a fit.

Beyond its end a law goes on at its last stiffness, which is less than any pad has: what is missing there would be taken
for a stiffer resin, or for an effect.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.loop.data.trials import Presses, stack
from dummydesign.loop.model.base_law import SetupLaw, depth_limits
from dummydesign.measurement.campaign import Campaign

# A press may end so much deeper than its law: the last secant is good for that.
BEYOND = 1.02
LEAST_LEFT = 2


def within_reach(
    campaign: Campaign, presses: Presses, law: SetupLaw, least: int = LEAST_LEFT
) -> tuple[Campaign, Presses, str]:
    """A campaign without the presses that go deeper than their law.

    Parameters
    ----------
    campaign : Campaign
    presses : Presses
        Of all its trials.
    law : callable
        Of its pads, with the depths to which it holds.
    least : int
        Presses that must stay.

    Returns
    -------
    Campaign, Presses
        Those that stay; the same objects where all do.
    str
        Which are left out, how deep they go and where their law ends; empty where none is.

    Raises
    ------
    InputError
        When fewer would stay.
    """
    limit = depth_limits(law, presses.trials)
    deep = presses.depth_mm > BEYOND * limit
    if not deep.any():
        return campaign, presses, ""
    files = ", ".join(trial.file for trial, out in zip(presses.trials, deep) if out)
    depth, end = float(presses.depth_mm[deep].max()), float(np.min(limit[deep]))
    why = f"up to {depth:.3g} mm, where the force law of the pad is known to {end:.3g} mm"
    kept = tuple(trial for trial, out in zip(presses.trials, deep) if not out)
    if len(kept) < least:
        raise InputError(f"presses go deeper than can be modelled, {why}: {files}; press less deep, or a thicker pad")
    own = replace(campaign, trials=kept)
    return own, stack(kept, campaign.lowpass), f"{int(deep.sum())} of {len(deep)} presses are left out, {why}: {files}"
