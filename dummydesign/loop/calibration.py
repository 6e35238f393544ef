"""The calibration of a campaign: base and corrected model, joint estimate, covariance, scatter of pads; and as the
prior of the next campaign.

Posterior and next fit are normal around their optimum. What they share are the parameters of the material: modulus,
arms, and effects that belong to the pad. What belongs to the rig, to the sensor or to single pads is not carried over.
Where the two contradict each other beyond chance the new campaign stands alone, and what contradicts is named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import fitted_around
from dummydesign.loop.data.reduction import HOLD, PRE, RISE, UNLOADING
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.effects.learned import Learned
from dummydesign.loop.fitting.fit import NORMAL_95, CampaignFit, fit_with_noise
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.forward_model import (
    LAW_TERMS,
    SMOOTH_TERMS,
    Active,
    BaseParameters,
    LawError,
    parameter_names,
    simulate,
)
from dummydesign.loop.model.material import ARM_TOLERANCE, material_of
from dummydesign.loop.pad_scatter import carried_share, recorded_spread
from dummydesign.loop.result import LoopResult, PooledFit
from dummydesign.loop.selection.cross_validation import pad_spreads, widened
from dummydesign.measurement.campaign import Campaign, PadSpec
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.resin import load_resin, update_resin
from dummydesign.resin.model.resin import Point

PADS = ("level", "slope", "curve")
YOUNG_SPREAD = 0.03
"""Half width of the 95 % interval of ln modulus of calibrations that carry none: assumed."""
SAME_RATIO = 1e-3
"""Share by which the ratios of two campaigns of one mix may differ."""


@dataclass(frozen=True)
class Posterior:
    """Normal distribution of the parameters of a model."""

    names: tuple[str, ...]
    mean: NDArray
    covariance: NDArray
    pads: tuple[float, ...]

    def spread(self, name: str) -> float:
        """Standard deviation of one parameter."""
        index = self.names.index(name)
        return float(np.sqrt(self.covariance[index, index]))

    def interval(self, name: str) -> tuple[float, float]:
        """95 % interval of one parameter, in its unit where the logarithm was kept."""
        middle, half = self.mean[self.names.index(name)], NORMAL_95 * self.spread(name)
        low, high = middle - half, middle + half
        return (float(np.exp(low)), float(np.exp(high))) if name.startswith("log ") else (float(low), float(high))

    @property
    def young_spread(self) -> float:
        """Standard deviation of the logarithm of the long-term modulus of the material."""
        return self.spread("log young_kPa")

    @property
    def new_pad_spread(self) -> float:
        """The same as a pad shows it that was not pressed, with its own level."""
        return float(np.hypot(self.young_spread, self.pads[0]))

    def to_dict(self) -> dict[str, Any]:
        """Plain values, with the 95 % intervals spelt out."""
        return {
            "names": list(self.names),
            "mean": self.mean.tolist(),
            "covariance": self.covariance.tolist(),
            "intervals_95": {name.removeprefix("log "): list(self.interval(name)) for name in self.names},
            "pad_to_pad": dict(zip(PADS, self.pads)),
        }


def posterior_of(fit: CampaignFit, lack_ratio: float | None = None) -> Posterior:
    """Posterior of the base and effect parameters of a fit, law errors and contact shifts integrated out."""
    pairs = [(p, one.values[p.name]) for one in fit.active for p in one.effect.parameters]
    count = fit.problem.base_count
    mean = np.r_[fit.vector[:count], [np.log(value) if p.log else value for p, value in pairs]]
    mean[0] += np.log(1e3)  # MPa to kPa
    scale = np.r_[np.ones(count), [1.0 if p.log else p.typical for p, _ in pairs]]
    own = widened(fit, lack_ratio)[: len(mean), : len(mean)] * np.outer(scale, scale)
    names = parameter_names(fit.problem.prior.arms, [one.effect for one in fit.active])
    level, *rest = pad_spreads(fit)
    # what records say of these pads is not known of the next one
    level = float(np.hypot(level, recorded_spread(fit.problem.presses)))
    return Posterior(tuple(names), mean, own, (level, *rest))


_PHASES = {PRE: "before_contact", RISE: "rise", HOLD: "hold", UNLOADING: "unloading"}


@dataclass(frozen=True)
class Model:
    """A fitted model: base parameters, effects, and the law error ``law`` (terms, pads) found on each of the ``pads``.

    A pad is known by its shape as typed, empty for a slab, and its thickness. [mm]

    ``carried`` is the share of a pad's level that goes over to another pad: what is of the law, not of the pad;
    ``reach`` the depth over thickness that was pressed, to which the law error is known.
    """

    base: BaseParameters
    active: tuple[Active, ...]
    pads: tuple[tuple[str, float], ...]
    law: NDArray
    carried: float = 1.0
    reach: float = np.inf

    def with_pads_of(self, earlier: Model) -> Model:
        """The model with the law errors of pads that only an earlier one knows."""
        rows = dict(zip(earlier.pads, earlier.law.T)) | dict(zip(self.pads, self.law.T))
        pads = tuple(sorted(rows))
        law = np.stack([rows[pad] for pad in pads], axis=1)
        return replace(self, pads=pads, law=law, reach=max(self.reach, earlier.reach))

    def law_error(self, thickness_mm: NDArray, shapes: Sequence[str] = (), cast: bool = False) -> LawError:
        """Law error of pads (T,): of one's own shape, linear in the logarithm of thickness between the known and
        constant outside; none for a shape that was not measured.

        A pad of another thickness than those that were pressed takes :attr:`carried` of the level, and so does every
        pad that is newly ``cast``; neither has the waves of the law that the pressed ones were compared with.
        """
        at, wanted = np.log(thickness_mm), np.array(list(shapes) or [""] * len(thickness_mm))
        own, measured = (np.array(column) for column in zip(*self.pads))
        terms = np.zeros((len(self.law), len(at)))
        for shape in set(wanted.tolist()) & set(own.tolist()):
            rows, known = wanted == shape, own == shape
            for term, values in zip(terms, self.law):
                term[rows] = np.interp(at[rows], np.log(measured[known]), values[known])
        same = np.array([(shape, h) in self.pads for shape, h in zip(wanted.tolist(), thickness_mm.tolist())])
        same &= not cast
        terms[0] *= np.where(same, 1.0, self.carried)
        terms[SMOOTH_TERMS:] *= same
        return LawError(terms, self.reach)

    def nodes(self, presses: Presses, law: SetupLaw) -> NDArray:
        """Force at the nodes of other presses (T, N). [N]"""
        error = self.law_error(presses.thickness_mm, [trial.pad[0] for trial in presses.trials])
        return simulate(presses, law, self.base, self.active, error)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        shapes, thickness = (list(column) for column in zip(*self.pads))
        return {
            "base": self.base.to_dict(),
            "effects": [
                {"name": one.effect.name, "belongs_to": one.effect.belongs_to, "parameters": dict(one.values)}
                | (one.effect.shape.to_dict() if isinstance(one.effect, Learned) else {})
                for one in self.active
            ],
            "law_error": {
                "thickness_mm": thickness,
                "level_slope_curve": self.law[:SMOOTH_TERMS].tolist(),
                **({"waves": self.law[SMOOTH_TERMS:].tolist()} if self.law[SMOOTH_TERMS:].any() else {}),
                **({"shape": shapes} if any(shapes) else {}),
                **({"carried_to_other_pads": self.carried} if self.carried < 1.0 else {}),
                **({"known_to_depth_over_thickness": self.reach} if np.isfinite(self.reach) else {}),
            },
        }


@dataclass(frozen=True)
class Calibration:
    """Base and corrected model, and how far a prediction is to be trusted."""

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
        """Warning about an incomplete calibration; empty when its residual was noise."""
        if self.verdict == "ambiguous":
            return f"the calibration's verdict is ambiguous: {''.join(self.unexplained_because[:1])}"
        if self.verdict != "unexplained":
            return ""
        why = f": {self.unexplained_because[0]}" if self.unexplained_because else ""
        return f"the calibration's verdict is unexplained, something is missing in its model{why}"

    @property
    def young_spread(self) -> float:
        """Logarithm of the factor within which the modulus of a new pad is known (95 %)."""
        return YOUNG_SPREAD if self.posterior is None else float(NORMAL_95 * self.posterior.new_pad_spread)

    def at_ratio_of(self, pad: PadSpec) -> Calibration:
        """The calibration for pads of another ratio: modulus and strengths follow the resin's law, as in a design."""
        ratio = self.pad.get("ratio")
        if pad.resin is None or pad.ratio is None or ratio is None or abs(pad.ratio - ratio) <= SAME_RATIO * ratio:
            return self
        young = fitted_around(1e3 * self.after.base.young_MPa, self.young_spread, "calibration")
        resin = update_resin(load_resin(pad.resin), [Point(ratio, young)], pad.resin)
        grown = resin.young_MPa(pad.ratio) / resin.young_MPa(ratio)
        softer = grown**-resin.softness_exponent.value

        def carried(model: Model) -> Model:
            base, strengths = model.base, tuple(softer * beta for beta in model.base.beta)
            return replace(model, base=replace(base, young_MPa=grown * base.young_MPa, beta=strengths))

        return replace(self, base=carried(self.base), after=carried(self.after))

    def prony(self) -> tuple[PronyTerm, ...]:
        """Relaxation of the corrected material at small strain, extra modes included."""
        arms = list(zip(self.after.base.tau_s, self.after.base.beta))
        for one in self.after.active:
            arms += [(term.tau_s, term.beta) for term in one.effect.adds_terms(one.values)]
        return tuple(PronyTerm(float(tau), float(beta)) for tau, beta in sorted(arms, key=lambda arm: arm[0]))

    def strength_parameter(self, term: PronyTerm) -> tuple[str, float]:
        """The posterior's name for the strength of a term of :meth:`prony`, and d ln strength over d of it."""
        for number, (tau, beta) in enumerate(zip(self.after.base.tau_s, self.after.base.beta), 1):
            if (tau, beta) == (term.tau_s, term.beta):
                return f"log beta_{number}", 1.0
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


def model_of(fit: CampaignFit) -> Model:
    """Take the model out of a fit."""
    presses, law = fit.problem.presses, fit.vector[fit.problem.fixed :].reshape(LAW_TERMS, -1)
    reach = float(np.max(presses.depth_mm / presses.thickness_mm))
    return Model(fit.base, fit.active, presses.pads, law, carried_share(fit), reach)


def calibration_of(result: LoopResult, prior: Calibration | None = None) -> Calibration:
    """Make the calibration of a loop's result, whatever its verdict; with a prior, it knows the pads of both."""
    joined = result.joined is not None and result.joined.used
    presses, fit = result.presses, result.after.fit
    after = model_of(fit) if prior is None or not joined else model_of(fit).with_pads_of(prior.after)
    phases = {name: presses.used & (presses.label // 100 == code) for code, name in _PHASES.items()}
    left = {
        name: float(np.sqrt(np.average(fit.residual[use] ** 2, weights=presses.samples[use])))
        for name, use in phases.items()
        if use.any()
    }
    material = material_of(result.campaign)
    pad = {
        "young_kPa_expected": material.young_kPa.value,
        "resin": result.campaign.pad.resin,
        "ratio": result.campaign.pad.ratio,
        "base": result.campaign.pad.base,
        "shape": result.campaign.pad.shape,
        "contact": result.campaign.punch.contact,
        "punch": result.campaign.punch.text,
        **result.campaign.usual_pad,
        **({} if material.alpha is None else {"ogden_alpha": material.alpha.value}),
    }
    return Calibration(
        model_of(result.base.fit),
        after,
        result.verdict,
        left,
        fit.sizes.floor_N,
        pad,
        result.remainder.reasons,
        posterior_of(fit, result.after.lack.ratio),
    )


CONFLICT_P = 0.01  # probability of a larger difference by chance below which a prior is held to contradict the data
NAMED_Z = 2.5  # parameters that differ by more standard deviations than this are named


def check_prior(prior: Calibration, campaign: Campaign) -> None:
    """Refuse a prior that cannot speak of a campaign."""
    if prior.posterior is None:
        raise InputError("the prior's calibration has no posterior: run loop again", "missing", "prior.posterior")
    pad, known = campaign.pad, prior.pad
    for name, own, other in (("resin", pad.resin, known["resin"]), ("ratio", pad.ratio, known["ratio"])):
        if own is None or other is None:
            continue
        same = own == other if isinstance(own, str) else abs(own - other) <= SAME_RATIO * abs(other)
        if not same:
            message = f"the prior is of {name} = {other}, the campaign of {name} = {own}: give one of the same"
            raise InputError(message, "inconsistent", f"prior.{name}", other, own)


def with_prior_effects(fit: CampaignFit, prior: Calibration) -> CampaignFit:
    """The model refitted with the prior's effects of the pad beside its own, as far as the campaign can take them."""
    problem = fit.problem
    more = [
        one
        for one in prior.design_effects()
        if one.effect.name not in problem.entries and not one.effect.undefined(problem.presses, problem.law)
    ]
    if not more:
        return fit
    start = [p.to_coordinate(one.values[p.name]) for one in more for p in one.effect.parameters]
    vector = np.insert(fit.vector, problem.fixed, start)
    return fit_with_noise(problem.plus(*(one.effect for one in more)), vector, fit.sizes, 2, 8)


def join(fit: CampaignFit, prior: Calibration, lack_ratio: float | None = None) -> tuple[CampaignFit, PooledFit]:
    """Join a prior to a fit, or leave the fit as it is where the two contradict each other.

    With H taking the vector to the shared parameters: gain K = C H' (H C H' + P)^-1, vector + K (m - H vector),
    covariance (1 - K H) C; C is widened by a lack of fit as the posterior's is, and P is the prior's covariance
    with :data:`ARM_TOLERANCE` for the arms.
    """
    from scipy.special import chdtrc

    known = prior.posterior
    assert known is not None
    entries, names, units, zeros = zip(*_shared(fit, known.names))
    take = [known.names.index(name) for name in names]
    turn = np.zeros((len(names), len(fit.vector)))
    turn[np.arange(len(names)), entries] = units
    covariance = widened(fit, lack_ratio)
    arms = np.array([name.startswith(("log tau_", "log beta_")) for name in names])
    there = known.covariance[np.ix_(take, take)] + np.diag(np.where(arms, ARM_TOLERANCE, 0.0) ** 2)
    together = turn @ covariance @ turn.T + there
    here = turn @ fit.vector + np.array(zeros)
    away = known.mean[take] - here
    distance = float(away @ np.linalg.solve(together, away))
    p = float(chdtrc(len(names), distance))
    if p < CONFLICT_P:
        spread = np.sqrt(np.diag(together))
        order = np.argsort(-np.abs(away / spread))
        named = [k for k in order if abs(away[k]) > NAMED_Z * spread[k]] or [order[0]]
        words = tuple(_conflict(names[k], known.mean[take][k], here[k], abs(away[k] / spread[k])) for k in named)
        return fit, PooledFit(False, distance, p, words, names)
    gain = np.linalg.solve(together, turn @ covariance).T
    low, high = fit.problem.bounds()
    vector = np.clip(fit.vector + gain @ away, low, high)
    left = covariance - gain @ turn @ covariance
    forces = fit.problem.predict(vector)
    residual = np.where(fit.problem.presses.used, fit.problem.presses.force_N - forces, 0.0)
    both = 0.5 * (left + left.T)
    joined = replace(fit, vector=vector, covariance=both, forces=forces, residual=residual, joined=True)
    return joined, PooledFit(True, distance, p, (), names)


def _shared(fit: CampaignFit, known: tuple[str, ...]) -> list[tuple[int, str, float, float]]:
    """Entry in the vector, name in the posterior, unit per coordinate and value at coordinate 0 of what is shared."""
    problem = fit.problem
    names = parameter_names(problem.prior.arms, problem.effects)
    # arms of another number are other arms: only the modulus is then shared
    same = sum(name.startswith("log beta_") for name in known) == problem.prior.arms
    own = [(effect, p) for effect in problem.effects for p in effect.parameters]
    return [
        (0, names[0], 1.0, float(np.log(1e3))),  # MPa to kPa
        *((entry, names[entry], 1.0, 0.0) for entry in range(1, problem.base_count if same else 1)),
        *(
            (entry, names[entry], 1.0, float(np.log(p.typical))) if p.log else (entry, names[entry], p.typical, p.null)
            for entry, (effect, p) in enumerate(own, problem.base_count)
            if effect.belongs_to == "pad" and names[entry] in known
        ),
    ]


def _conflict(name: str, prior: float, data: float, z: float) -> str:
    values = np.exp([prior, data]) if name.startswith("log ") else np.array([prior, data])
    return f"{name.removeprefix('log ')}: {values[0]:.4g} before, {values[1]:.4g} now ({z:.1f} standard deviations)"
