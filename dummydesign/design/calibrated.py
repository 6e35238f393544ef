"""Design with what a measured campaign taught: the batch's modulus and relaxation, and the corrected force law."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dummydesign.core.quantity import Quantity

if TYPE_CHECKING:
    from dummydesign.loop.calibration import Calibration
    from dummydesign.loop.corrected_law import CorrectedLaw
    from dummydesign.resin.model.resin import Resin

YOUNG_SPREAD, BETA_SPREAD = 0.03, 0.1
"""Half widths of the 95 % intervals of modulus and strengths of calibrations of earlier versions, which carry none:
assumed."""
LARGEST_SHARE = 0.9
"""A half width is not more than this share of the value, which is positive."""


def with_calibration(resin: Resin, path: str) -> tuple[Resin, CorrectedLaw, Calibration]:
    """Read a calibration and put it into a resin and a force law.

    The resin's law is updated by the campaign's modulus at its ratio and takes the campaign's relaxation there.
    The intervals come from the calibration's posterior; that of the modulus is of a pad that was not pressed, which
    has a factor of its own. The force law carries the effects that belong to the pad; what belongs to the rig or the
    sensor does not change a design.

    Parameters
    ----------
    resin : Resin
        The resin that is designed with.
    path : str
        File written by ``dummydesign loop``.

    Raises
    ------
    InputError
        When the file is not a calibration, or its ratio is outside the resin's range.
    """
    from dummydesign.loop.calibration_file import read_calibration
    from dummydesign.loop.corrected_law import CorrectedLaw
    from dummydesign.loop.posterior import NORMAL_95
    from dummydesign.resin.model.resin import Arm
    from dummydesign.resin.update.modulus import Point, update_resin

    calibration = read_calibration(path)
    ratio = calibration.pad.get("ratio") or resin.relaxation_ratio_ref
    source = f"calibration {path} of a measured campaign"
    young = 1e3 * float(calibration.after.base.young_MPa)
    known = calibration.posterior
    spread = YOUNG_SPREAD if known is None else NORMAL_95 * known.new_pad_spread
    point = Point(ratio, _around(young, spread, source))
    updated = update_resin(resin, [point], resin.name)
    arms = []
    for term in calibration.prony():
        own = calibration.strength_spread(term)
        share = BETA_SPREAD if own is None else min(NORMAL_95 * own, LARGEST_SHARE)
        arms.append(Arm(_around(term.tau_s, 0.0, source), _around(term.beta, share, source)))
    told = (*resin.references, source)
    resin = replace(updated, arms=tuple(arms), relaxation_ratio_ref=float(ratio), references=told)
    return resin, CorrectedLaw(calibration), calibration


def _around(value: float, share: float, source: str) -> Quantity:
    return Quantity(value, value * (1.0 - share), value * (1.0 + share), "fitted", source)
