"""The modulus that a campaign expects before anything is fitted."""

from __future__ import annotations

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign import Campaign


def start_young_kPa(campaign: Campaign) -> float:
    """Nominal modulus of a campaign, or that of its resin at its ratio. [kPa]"""
    pad = campaign.pad
    if pad.young_kPa_nominal is not None:
        return pad.young_kPa_nominal
    if pad.resin is None or pad.ratio is None:
        raise InputError("campaign.toml: [pad] needs young_kPa_nominal, or resin and ratio")
    from dummydesign.resin import load_resin

    resin = load_resin(pad.resin)
    resin.check_ratio(pad.ratio)
    return float(resin.modulus_kPa(pad.ratio).value)
