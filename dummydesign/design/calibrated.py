"""Design with what a measured campaign taught: the batch's modulus and relaxation, and the corrected force laws."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity
from dummydesign.geometry.standard import PUNCH
from dummydesign.resin.model.relaxation_given_modulus import RelaxationGivenModulus

if TYPE_CHECKING:
    from dummydesign.loop.calibration import Calibration
    from dummydesign.loop.corrected_law import CorrectedLaw
    from dummydesign.resin.model.resin import Resin

YOUNG_SPREAD, BETA_SPREAD = 0.03, 0.1
"""Half widths of the 95 % intervals of modulus and strengths of calibrations of earlier versions, which carry none:
assumed."""
LARGEST_SHARE = 0.9
"""A half width is not more than this share of the value, which is positive."""
BASE, CONTACT = "bonded", "bonded"
"""What holds the base and the face of the pads that are designed."""


@dataclass(frozen=True)
class Calibrated:
    """What a design is made with when it has a calibration.

    Attributes
    ----------
    resin : Resin
        With the campaign's modulus and relaxation.
    law : CorrectedLaw
        Of slabs.
    calibration : Calibration
    warnings : tuple of {code, message}
        Where the campaign was of something else than what is designed.
    """

    resin: Resin
    law: CorrectedLaw
    calibration: Calibration
    warnings: tuple[dict[str, str], ...]


def with_calibration(resin: Resin, path: str, punch: str = PUNCH, square: bool = True) -> Calibrated:
    """Read a calibration and put it into a resin and a force law.

    The resin's law is updated by the campaign's modulus at its ratio and takes the campaign's relaxation there.
    Intervals and what ties the strengths to the modulus come from the calibration's posterior; the modulus is that
    of a pad that was not pressed, which has a factor of its own. The force law carries the effects that belong to
    the pad; what belongs to the rig or the sensor does not change a design.

    Parameters
    ----------
    resin : Resin
        The resin that is designed with.
    path : str
        File written by ``dummydesign loop``.
    punch : str
        Flat punch with sharp edges that the design is pressed with, as typed.
    square : bool
        Whether it is square; another one counts as the circle of its area.

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
    ratio, pressed = calibration.pad.get("ratio") or resin.relaxation_ratio_ref, calibration.pad.get("resin")
    if pressed not in (None, resin.name) and not resin.ratio_min <= ratio <= resin.ratio_max:
        raise InputError(
            f"calibration {path} is of {pressed} at ratio {ratio:g}, which {resin.name} does not have "
            f"({resin.ratio_min:g} to {resin.ratio_max:g}): design with --resin {pressed}, or without it "
            "(--calibration none)"
        )
    warnings = _differences(calibration, resin, ratio, punch)
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
    resin = replace(
        updated, arms=tuple(arms), relaxation_ratio_ref=float(ratio), references=told,
        joint_relaxation=_joint(calibration),
    )  # fmt: skip
    return Calibrated(resin, CorrectedLaw(calibration, square, BASE, punch), calibration, warnings)


def _joint(calibration: Calibration) -> RelaxationGivenModulus | None:
    """Strengths given the modulus that a new pad shows, from the posterior's covariance; None without one."""
    known = calibration.posterior
    if known is None:
        return None
    names, scales = zip(*(calibration.strength_parameter(term) for term in calibration.prony()))
    rows = [known.names.index(name) for name in ("log young_kPa", *names)]
    scale = np.array([1.0, *scales])
    covariance = known.covariance[np.ix_(rows, rows)] * np.outer(scale, scale)
    covariance[0, 0] = known.new_pad_spread**2
    return RelaxationGivenModulus.of(float(np.log(1e3 * calibration.after.base.young_MPa)), covariance)


def _differences(calibration: Calibration, resin: Resin, ratio: float, punch: str) -> tuple[dict[str, str], ...]:
    """Where the campaign differs from what is designed: resin, ratio, base, contact and punch."""
    pad = calibration.pad
    said = []
    if pad.get("resin") not in (None, resin.name):
        said.append(("calibration_resin", f"the calibration's campaign pressed pads of {pad['resin']}; this design is "
                     f"of {resin.name}, and takes its modulus and relaxation all the same"))
    if pad.get("ratio") is None:
        said.append(("calibration_ratio", f"the calibration's campaign says no ratio: its modulus is taken for that at "
                     f"{ratio:g}, the ratio of {resin.name}'s relaxation; name resin and ratio in campaign.toml"))
    if not calibration.on_pucks():
        for name, own, designed in (("base", pad.get("base"), BASE), ("contact", pad.get("contact"), CONTACT)):
            if own not in (None, designed):
                said.append((f"calibration_{name}", f"the calibration's campaign had {name} = {own}, the pad that is "
                             f"designed has {designed}: modulus, relaxation and effects are carried over, what "
                             "was found of the force law is not"))
        if (own := pad.get("punch") or PUNCH) != punch:
            said.append(("calibration_punch", f"the calibration's campaign pressed with punch {own}, this design is "
                         f"for {punch}: modulus, relaxation and effects are carried over, what was found of the force "
                         "law is not"))
    return tuple({"code": code, "message": message} for code, message in said)


def calibration_dict(calibration: Calibration, path: str) -> dict[str, Any]:
    """What an answer says first of the calibration it uses: verdict, effects, and what was left.

    Parameters
    ----------
    calibration : Calibration
    path : str
        Of its file.
    """
    left = calibration.remainder_N
    names = [one.effect.name for one in calibration.after.active]
    found = f" ({', '.join(names)})" if names else ""
    text = f"calibration {path}: verdict {calibration.verdict}{found}"
    if left:
        parts = ", ".join(f"{value:.3g} N {phase.replace('_', ' ')}" for phase, value in left.items())
        text += f"; left {parts}; noise floor {calibration.noise_floor_N:.3g} N"
    return {
        "file": path, "verdict": calibration.verdict, "effects": names,
        "unexplained_because": list(calibration.unexplained_because), "left_N": dict(left),
        "noise_floor_N": calibration.noise_floor_N, "text": text,
    }  # fmt: skip


def _around(value: float, share: float, source: str) -> Quantity:
    return Quantity(value, value * (1.0 - share), value * (1.0 + share), "fitted", source)
