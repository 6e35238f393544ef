"""What a measured campaign changes in a design: modulus, relaxation, correction, families of shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, log
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import Quantity, fitted_around
from dummydesign.design.search.shape_family import ChangedFamily, Designs
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.loop.calibration import Calibration
from dummydesign.loop.calibration_file import read_calibration
from dummydesign.loop.corrected_law import CorrectedLaw, Correction, DesignedForce
from dummydesign.loop.fitting.fit import NORMAL_95
from dummydesign.loop.model.effect import Arm, Effect
from dummydesign.loop.model.forward_model import relax
from dummydesign.measurement.campaign import with_edge
from dummydesign.pad.material.relaxation import PressedForce
from dummydesign.resin.model.resin import Point, RelaxationGivenModulus, Resin, ResinArm
from dummydesign.resin.model.resin_file import load_resin
from dummydesign.resin.update import update_resin

BETA_SPREAD = 0.1
"""Half width of the 95 % interval of ln strength of calibrations that carry none: assumed."""
UNDETERMINED = 3.0
"""A modulus that is known only within this factor either way (95 %) was not measured: as wide as a resin's own law."""
# What holds the base and the face of the pads that are designed.
BASE, CONTACT = "bonded", "bonded"
OTHER = "another"


@dataclass(frozen=True)
class Calibrated:
    """What a design is made with when it has a calibration."""

    resin: Resin
    law: CorrectedLaw
    calibration: Calibration
    warnings: tuple[dict[str, str], ...]
    path: str

    @property
    def summary(self) -> dict[str, Any]:
        """What an answer says first of the calibration it uses: verdict, effects, and what was left."""
        used, left = self.calibration, self.calibration.remainder_N
        names = [one.effect.name for one in used.after.active]
        effects = f" ({', '.join(names)})" if names else ""
        text = f"calibration {self.path}: verdict {used.verdict}{effects}"
        if left:
            parts = ", ".join(f"{value:.3g} N {phase.replace('_', ' ')}" for phase, value in left.items())
            text += f"; left {parts}; noise floor {used.noise_floor_N:.3g} N"
        return {
            "file": self.path,
            "verdict": used.verdict,
            "effects": names,
            "unexplained_because": list(used.unexplained_because),
            "left_N": dict(left),
            "noise_floor_N": used.noise_floor_N,
            "text": text,
        }


def settles_modulus(calibration: Calibration) -> bool:
    """Whether a pad can be designed with a calibration: it knows the modulus within a factor of 3."""
    return calibration.young_spread <= log(UNDETERMINED)


def with_calibration(
    resin: Resin, path: str, punch: str = PUNCH, square: bool = True, edge_radius_mm: float = 0.0
) -> Calibrated:
    """Read a calibration and put it into a resin and a force law.

    The resin's law is updated by the campaign's modulus at its ratio and takes the campaign's relaxation there.
    Intervals and what ties the strengths to the modulus come from the calibration's posterior; the modulus is that
    of a pad that was not pressed, which has a factor of its own. The force law carries the effects that belong to
    the pad; what belongs to the rig or the sensor does not change a design.
    """
    calibration = read_calibration(path)
    ratio, pressed = _ratio(calibration, path), calibration.pad.get("resin")
    _check_family(calibration, resin, path)
    if pressed not in (None, resin.name) and not resin.ratio_min <= ratio <= resin.ratio_max:
        raise InputError(
            f"calibration {path} is of {pressed} at ratio {ratio:g}, which {resin.name} does not have "
            f"({resin.ratio_min:g} to {resin.ratio_max:g}): design with --resin {pressed}, or without it "
            "(--calibration none)",
            "inconsistent",
            "calibration.ratio",
            ratio,
            (resin.ratio_min, resin.ratio_max),
        )
    punch = with_edge(punch, edge_radius_mm)
    warnings = _differences(calibration, resin, punch)
    source = f"calibration {path} of a measured campaign"
    young = 1e3 * float(calibration.after.base.young_MPa)
    spread = calibration.young_spread
    if not settles_modulus(calibration):
        raise InputError(
            f"calibration {path} leaves the modulus undetermined: {young:.3g} kPa, 95 % within a factor of "
            f"{exp(min(spread, 99.0)):.2g}, at most {UNDETERMINED:g} is allowed; press deeper or more pads and run "
            "'dummydesign loop' again, or design without it (--calibration none)",
            "not_enough_data",
            "calibration.young_kPa",
            young,
        )
    updated = update_resin(resin, [Point(ratio, fitted_around(young, spread, source))], resin.name)
    arms = []
    for term in calibration.prony():
        own = calibration.strength_spread(term)
        beta_spread = BETA_SPREAD if own is None else NORMAL_95 * own
        if not beta_spread <= log(UNDETERMINED):
            message = (
                f"the calibration's campaign leaves the strength of the relaxation at {term.tau_s:.2g} s "
                f"undetermined ({term.beta:.2g}, 95 % within a factor of {exp(min(beta_spread, 99.0)):.2g}); "
                "press a ramp and a longer hold"
            )
            warnings = (*warnings, {"code": "calibration_relaxation", "message": message})
        arms.append(ResinArm(fitted_around(term.tau_s, 0.0, source), fitted_around(term.beta, beta_spread, source)))
    alpha = calibration.pad.get("ogden_alpha")
    resin = replace(
        updated,
        # the law that the campaign was compared with: its effects and law error stand on that
        ogden_alpha=None if alpha is None else Quantity(alpha, alpha, alpha, "fitted", source),
        arms=tuple(arms),
        relaxation_ratio_ref=float(ratio),
        references=(*resin.references, source),
        joint_relaxation=_joint(calibration),
        pressed_force=pressed_force(calibration),
    )
    law = CorrectedLaw(Correction(calibration, BASE, punch), square, edge_radius_mm)
    return Calibrated(resin, law, calibration, warnings, path)


def pressed_force(calibration: Calibration) -> PressedForce | None:
    """The force of presses that are designed, where effects change the arms with depth or speed; else None."""
    acting = [one for one in calibration.design_effects() if type(one.effect).pressed_arms is not Effect.pressed_arms]

    def force(
        time_s: NDArray,
        elastic_N: NDArray,
        share: NDArray,
        velocity_mm_s: ArrayLike,
        tau_s: Sequence[float],
        beta: NDArray,
    ) -> NDArray:
        arms = tuple(Arm(tau, beta[:, at, None]) for at, tau in enumerate(tau_s))
        speed = np.broadcast_to(velocity_mm_s, len(beta))[:, None]
        for one in acting:
            arms = one.effect.pressed_arms(arms, share, speed, one.values)
        return relax(time_s, elastic_N, arms)

    return force if acting else None


def _ratio(calibration: Calibration, path: str) -> float:
    """Ratio of the pads that were pressed: a modulus without it leads to no recipe."""
    ratio = calibration.pad.get("ratio")
    if ratio is None:
        raise InputError(
            f"calibration {path} has no mixing ratio, so no weights follow from its modulus: write 'ratio = R' into "
            "[pad] of the campaign's campaign.toml and run 'dummydesign loop' on it again, or design without it "
            "(--calibration none)",
            "missing",
            "calibration.ratio",
        )
    return float(ratio)


def _check_family(calibration: Calibration, resin: Resin, path: str) -> None:
    """Refuse a campaign of other liquids: its ratio means something else."""
    pressed = calibration.pad.get("resin")
    if pressed in (None, resin.name):
        return
    try:
        other = load_resin(pressed)
    except InputError:  # a resin of another library; the warning names it
        return
    if other.ratio_meaning != resin.ratio_meaning or [one.name for one in other.liquids] != [
        one.name for one in resin.liquids
    ]:
        raise InputError(
            f"calibration {path} is of {pressed}, whose ratio is {other.ratio_meaning}; that of {resin.name} is "
            f"{resin.ratio_meaning}: design with --resin {pressed}, or without it (--calibration none)",
            "inconsistent",
            "calibration.resin",
            pressed,
            resin.name,
        )


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


def _differences(calibration: Calibration, resin: Resin, punch: str) -> tuple[dict[str, str], ...]:
    """Where the campaign differs from what is designed: resin, base, contact and punch."""
    pad = calibration.pad
    notes = []
    carried = "modulus, relaxation and effects are carried over, what was found of the force law is not"
    if pad.get("resin") not in (None, resin.name):
        notes.append(
            (
                "calibration_resin",
                f"the calibration's campaign pressed pads of {pad['resin']}; this design is "
                f"of {resin.name}, and still uses its modulus and relaxation",
            )
        )
    if not calibration.on_pucks():
        for name, own, designed in (("base", pad.get("base"), BASE), ("contact", pad.get("contact"), CONTACT)):
            if own not in (None, designed):
                notes.append(
                    (
                        f"calibration_{name}",
                        f"the calibration's campaign had {name} = {own}, the pad that is "
                        f"designed has {designed}: {carried}",
                    )
                )
        if (own := pad.get("punch") or PUNCH) != punch:
            notes.append(
                (
                    "calibration_punch",
                    f"the calibration's campaign pressed with punch {own}, this design is for {punch}: {carried}",
                )
            )
    return tuple({"code": code, "message": message} for code, message in notes)


@dataclass(frozen=True)
class CalibratedFamily(ChangedFamily):
    """Shapes of one kind as a calibration corrects their force."""

    correction: Correction

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the design must know of the effects in it."""
        return self.correction.notes(shaped=True)

    def area_mm2(self, designs: Designs, depth_mm: NDArray, radius_mm: float) -> NDArray:
        """Force over modulus; see :class:`~dummydesign.design.search.shape_family.Family`. [mm2]"""
        depth, thickness = np.atleast_2d(np.asarray(depth_mm, float)), designs.thickness_mm[:, None]
        limit = self.plain.limit_mm(designs, radius_mm)[:, None]
        law = DesignedForce(lambda at_mm, _: self.plain.area_mm2(designs, at_mm, radius_mm), radius_mm)
        return self.correction.apply(law, depth, thickness, limit, self._pressed(designs))

    def _pressed(self, designs: Designs) -> list[str]:
        """For each pad the shape of the campaign that it has, or a word that no pad has."""
        count = len(designs.thickness_mm)
        texts = np.full(count, OTHER, dtype=object)
        # parameters that a search leaves out, such as a ridge, have their usual values
        usual = dict(designs.shape(0).parameters) if count else {}
        for text in {shape for shape, _ in self.correction.calibration.after.pads} - {""}:
            shape = read_shape(text)
            if shape.name == self.plain.kind and count:
                own = {name: designs.parameters.get(name, np.full(count, usual[name])) for name, _ in shape.parameters}
                same = [np.isclose(own[name], value, rtol=1e-6) for name, value in shape.parameters]
                texts[np.logical_and.reduce(same)] = text
        return list(texts)
