"""The calibration file: base and corrected model of a campaign, for ``replay`` and for designing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.loop.data.reduction import HOLD, PRE, RISE, UNLOADING
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.fitting.fit import Fit
from dummydesign.loop.fitting.noise import LAW_TERMS
from dummydesign.loop.learned.effect import Learned
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.expected import start_young_kPa
from dummydesign.loop.model.forward_model import Active, LawError, simulate
from dummydesign.loop.model.parameters import BaseParameters
from dummydesign.loop.posterior import Posterior, posterior_of
from dummydesign.loop.prior import carried_law
from dummydesign.loop.result import LoopResult
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
    shapes : tuple of str
        Shape of each of these pads as typed, empty for slabs and pucks; empty altogether when all are.
    """

    base: BaseParameters
    active: tuple[Active, ...]
    thickness_mm: NDArray
    law: NDArray
    shapes: tuple[str, ...] = ()

    def law_error(self, thickness_mm: NDArray, shapes: Sequence[str] = ()) -> LawError:
        """Law error of pads (T,): of one's own shape, linear in the logarithm of thickness between the known and
        constant outside; none for a shape that was not measured.

        Parameters
        ----------
        thickness_mm : ndarray, shape (T,)
        shapes : sequence of str
            Shapes of the pads as typed; slabs when none are given.
        """
        at, wanted = np.log(thickness_mm), np.array(list(shapes) or [""] * len(thickness_mm))
        own = np.array(self.shapes or ("",) * len(self.thickness_mm))
        terms = np.zeros((len(self.law), len(at)))
        for shape in set(wanted.tolist()) & set(own.tolist()):
            rows, known = wanted == shape, own == shape
            for term, values in zip(terms, self.law):
                term[rows] = np.interp(at[rows], np.log(self.thickness_mm[known]), values[known])
        return LawError(*terms)

    def nodes(self, presses: Presses, law: SetupLaw) -> NDArray:
        """Force at the nodes of other presses (T, N). [N]"""
        error = self.law_error(presses.thickness_mm, [trial.pad[0] for trial in presses.trials])
        return simulate(presses, law, self.base, self.active, error)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "base": self.base.to_dict(),
            "effects": [
                {"name": one.effect.name, "belongs_to": one.effect.belongs_to, "parameters": dict(one.values)}
                | (one.effect.shape.to_dict() if isinstance(one.effect, Learned) else {})
                for one in self.active
            ],
            "law_error": {
                "thickness_mm": self.thickness_mm.tolist(), "level_slope_curve": self.law.tolist(),
                **({"shape": list(self.shapes)} if any(self.shapes) else {}),
            },
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
        Set-up of the campaign: young_kPa_expected, resin, ratio, base, shape, contact of the punch or plates,
        punch as typed (absent in files of earlier versions).
    unexplained_because : tuple of str
        Why the verdict is ``unexplained``; empty otherwise, and in files of earlier versions.
    posterior : Posterior or None
        Of the corrected model; None in files of earlier versions.
    """

    base: Model
    after: Model
    verdict: str
    remainder_N: dict[str, float]
    noise_floor_N: float
    pad: dict[str, Any]
    unexplained_because: tuple[str, ...] = ()
    posterior: Posterior | None = None

    @property
    def caution(self) -> str:
        """What a user of an incomplete calibration must be told; empty when what it left was noise."""
        if self.verdict != "unexplained":
            return ""
        why = f": {self.unexplained_because[0]}" if self.unexplained_because else ""
        return f"the calibration's verdict is unexplained, something is missing in its model{why}"

    def prony(self) -> tuple[PronyTerm, ...]:
        """Relaxation of the corrected material at small strain, extra modes included."""
        arms = list(zip(self.after.base.tau_s, self.after.base.beta))
        for one in self.after.active:
            arms += [(term.tau_s, term.beta) for term in one.effect.adds_terms(one.values)]
        return tuple(PronyTerm(float(tau), float(beta)) for tau, beta in sorted(arms, key=lambda arm: arm[0]))

    def strength_parameter(self, term: PronyTerm) -> tuple[str, float]:
        """The posterior's name for the strength of a term of :meth:`prony`, and d ln strength over d of it."""
        for place, (tau, beta) in enumerate(zip(self.after.base.tau_s, self.after.base.beta), 1):
            if (tau, beta) == (term.tau_s, term.beta):
                return f"log beta_{place}", 1.0
        one = next(one for one in self.after.active if term in one.effect.adds_terms(one.values))
        return f"{one.effect.name}.{one.effect.parameters[0].name}", 1.0 / term.beta

    def strength_spread(self, term: PronyTerm) -> float | None:
        """Standard deviation of a term of :meth:`prony` over its strength; None when no posterior is known."""
        if self.posterior is None:
            return None
        name, scale = self.strength_parameter(term)
        return scale * self.posterior.spread(name)

    def design_effects(self) -> tuple[Active, ...]:
        """Effects that belong to the pad, and so to every design; those of the rig and the sensor do not."""
        return tuple(one for one in self.after.active if one.effect.belongs_to == "pad")

    def on_pucks(self) -> bool:
        """Whether the campaign pressed pucks between plates."""
        return self.pad.get("shape", "slab") == "cylinder"


def model_of(fit: Fit) -> Model:
    """Take the model out of a fit."""
    law = np.array(np.split(fit.vector[fit.problem.fixed :], LAW_TERMS))
    shapes = tuple(shape for shape, _ in fit.problem.presses.pads)
    return Model(fit.base, fit.active, fit.problem.thicknesses, law, shapes if any(shapes) else ())


def calibration_of(result: LoopResult, prior: Calibration | None = None) -> Calibration:
    """Make the calibration of a loop's result, whatever its verdict; with a prior, it knows the pads of both.

    Parameters
    ----------
    result : LoopResult
    prior : Calibration, optional
        That the loop was run with; passed over where it contradicted the campaign.
    """
    prior = prior if result.joined is not None and result.joined.used else None
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
        "contact": result.campaign.punch.contact,
        "punch": result.campaign.punch.text,
    }
    # what a joined prior left was widened by the lack of fit before
    lack = None if result.joined is not None and result.joined.used else result.after.lack.ratio
    return Calibration(
        model_of(result.base.fit), _with_earlier_pads(model_of(fit), prior), result.verdict, left, fit.sizes.floor_N,
        pad, result.remainder.reasons, posterior_of(fit, lack),
    )  # fmt: skip


def _with_earlier_pads(model: Model, prior: Calibration | None) -> Model:
    """The model with the law errors of pads that only the prior's campaign pressed."""
    if prior is None:
        return model
    own = dict.fromkeys(zip(model.shapes or ("",) * len(model.thickness_mm), model.thickness_mm.tolist()))
    pads, law = carried_law(prior, tuple(own), model.law)
    shapes = tuple(shape for shape, _ in pads)
    return replace(
        model, thickness_mm=np.array([h for _, h in pads]), law=law, shapes=shapes if any(shapes) else ()
    )
