"""The resin: components, modulus against ratio with its posterior, relaxation, liquid properties."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dummydesign.core.errors import InputError, out_of_range, unknown_name
from dummydesign.core.quantity import HALF_WIDTH, Quantity, value_at
from dummydesign.core.serialise import Serialised, to_plain
from dummydesign.pad.material.relaxation import PressedForce, PronyTerm
from dummydesign.resin.model.modulus_laws import ModulusLaw

WRITTEN = (
    "name",
    "title",
    "chemistry",
    "ratio_meaning",
    "ratio_by",
    "ratio_per",
    "ratio_min",
    "ratio_max",
    "ratio_step",
    "references",
    "notes",
    "contradictions",
)
"""Fields that stand in a resin file as they are."""
MIXED = ("density_g_per_cm3", "viscosity_Pa_s")
"""Properties that follow from the components when the file does not give them for the mixture."""


@dataclass(frozen=True)
class Component(Serialised):
    """One liquid of a recipe and how much of it to weigh."""

    name: str
    mass_g: float


@dataclass(frozen=True)
class Liquid:
    """A component in the can: parts as the resin counts them (None: the ratio itself), density, viscosity."""

    name: str
    parts: float | None
    density_g_per_cm3: Quantity
    viscosity_Pa_s: Quantity


def mixed(name: str, liquids: Sequence[Liquid], parts: Sequence[float]) -> Quantity:
    """Density (added volumes) or viscosity (Arrhenius: mean of the logarithms by weight) of a mixture.

    Parameters
    ----------
    name : str
        One of :data:`MIXED`.
    liquids : sequence of Liquid
        The components.
    parts : sequence of float
        Parts by weight of each.
    """
    shares = [part / sum(parts) for part in parts]
    quantities = [getattr(liquid, name) for liquid in liquids]

    def at(end: str) -> float:
        values = [getattr(quantity, end) for quantity in quantities]
        if name == "density_g_per_cm3":
            return 1.0 / sum(share / value for share, value in zip(shares, values))
        return math.exp(sum(share * math.log(value) for share, value in zip(shares, values)))

    kind = "assumed" if any(quantity.kind == "assumed" for quantity in quantities) else "inferred"
    rule = "added volumes" if name == "density_g_per_cm3" else "mean of logarithms by weight"
    source = f"{rule} of the components: " + "; ".join(dict.fromkeys(q.source for q in quantities))
    return Quantity(at("value"), at("low"), at("high"), kind, source)


@dataclass(frozen=True, eq=False)
class RelaxationGivenModulus:
    """ln beta = ln of the stated strength + slope (ln E - mean) + spread z, with independent normal z.

    ``log_young_kPa`` is the mean of ln E at the reference ratio, ``slope`` (arms,), ``spread`` (arms, arms)
    a root of the covariance of ln beta at a known modulus.
    """

    log_young_kPa: float
    slope: NDArray
    spread: NDArray

    @classmethod
    def of(cls, log_young_kPa: float, covariance: NDArray) -> RelaxationGivenModulus:
        """From the covariance (1 + arms, 1 + arms) of ln E and the ln beta."""
        slope = covariance[1:, 0] / covariance[0, 0]
        left = covariance[1:, 1:] - np.outer(slope, covariance[0, 1:])
        values, turn = np.linalg.eigh(0.5 * (left + left.T))
        return cls(log_young_kPa, slope, turn * np.sqrt(np.maximum(values, 0.0)))

    def draw(self, beta: ArrayLike, young_kPa: NDArray, rng: np.random.Generator) -> NDArray:
        """Strengths (n, arms) of draws of the modulus.

        Parameters
        ----------
        beta : array_like, shape (arms,)
            The stated strengths.
        young_kPa : ndarray, shape (n,)
            The modulus at the reference ratio in each draw. [kPa]
        rng : numpy Generator
            Of the draws.
        """
        away = np.log(np.maximum(young_kPa, 1e-9)) - self.log_young_kPa
        own = rng.standard_normal((len(away), len(self.slope))) @ self.spread.T
        return np.asarray(beta, float) * np.exp(np.outer(away, self.slope) + own)


DRAWS, SEED = 2000, 20240
INCREMENT_DIGITS = 6
SMALLEST_SPREAD = 0.005
"""A modulus is never believed to better than 0.5 % (one standard deviation), whatever a file claims."""


SURPRISE = 3.0
"""Standard deviations from which on two numbers, or a number and a law, contradict each other."""
PUCK_SCATTER = 0.02
"""Scatter of ln modulus between pucks of one batch: assumed."""
NEO_HOOKEAN = 2.0
"""Exponent of the Ogden law that is the neo-Hookean one."""


class Interval(NamedTuple):
    """A value with the ends of its 95 % interval."""

    value: float
    low: float
    high: float


def log_spread(one: Interval | Quantity) -> float:
    """Standard deviation of the logarithm from a 95 % interval; an end at zero counts as far away."""
    return max(math.log(one.high / max(one.low, 1e-3 * one.value)) / (2.0 * HALF_WIDTH), SMALLEST_SPREAD)


@dataclass(frozen=True)
class ResinArm(Serialised):
    """One relaxing arm at the reference ratio, relative to the LONG-TERM modulus."""

    tau_s: Quantity
    beta: Quantity

    @property
    def time_spread(self) -> float:
        """Standard deviation of ln tau; a time that was chosen, not measured, is known within half a decade (95 %)."""
        known = self.tau_s.high > self.tau_s.low
        return 0.5 * math.log(self.tau_s.high / self.tau_s.low if known else 10.0) / HALF_WIDTH


@dataclass(frozen=True)
class PuckPoint:
    """The recordings of a puck; by ``sha256`` of their numbers they are known again under other file names.

    Several recordings have their hashes in one text, separated by blanks. ``plates`` is what was declared of them,
    ``seen_s`` are the shortest and longest time that its holds show, None without holds; ``arms`` what they showed,
    strengths relative to the long-term modulus at the point's ratio; ``alpha`` the exponent of its Ogden law.
    """

    sha256: str
    file: str
    diameter_mm: float
    height_mm: float
    seen_s: tuple[float, float] | None = None
    arms: tuple[ResinArm, ...] = ()
    plates: str = ""
    alpha: Quantity | None = None

    def has(self, sha256: str) -> bool:
        """Whether one of some recordings is among those of this puck."""
        return not set(self.sha256.split()).isdisjoint(sha256.split())

    def to_dict(self) -> dict[str, Any]:
        """Return plain values as they stand in a resin file, what is unknown left out."""
        return {"arm" if key == "arms" else key: one for key, one in to_plain(vars(self)).items() if one}


@dataclass(frozen=True)
class Point:
    """A modulus measured at a ratio; ``puck`` says on which recording, when it is known."""

    ratio: float
    young_kPa: Quantity
    puck: PuckPoint | None = None

    def to_dict(self) -> dict[str, Any]:
        """Return plain values as they stand in a resin file."""
        return {key: one for key, one in to_plain(vars(self)).items() if one is not None}

    @property
    def log_young(self) -> float:
        """Natural logarithm of the modulus in kPa."""
        return math.log(self.young_kPa.value)

    @property
    def spread(self) -> float:
        """Standard deviation of the logarithm, from the 95 % interval."""
        return log_spread(self.young_kPa)


@dataclass(frozen=True, eq=False)
class Draws:
    """Draws of what is not known of a resin; ``young_MPa`` and ``beta`` follow one draw each.

    ``numbers`` holds the law's parameters, ``beta_ref`` the strengths at the reference ratio, shape
    (n, arms), ``softness_exponent`` how relaxation grows when the modulus falls, shape (n,).
    """

    resin: Resin
    numbers: Mapping[str, NDArray]
    beta_ref: NDArray
    softness_exponent: NDArray

    def young_MPa(self, ratio: ArrayLike) -> NDArray:
        """Long-term Young's modulus of every draw [MPa]; ``ratio`` broadcasts against shape (n,)."""
        return self.resin.law.young_kPa(ratio, self.numbers) * 1e-3

    def beta(self, ratio: ArrayLike) -> NDArray:
        """Strengths of the arms of every draw, shape (n, arms), for one ratio or one a draw."""
        growth = self.young_MPa(self.resin.relaxation_ratio_ref) / self.young_MPa(ratio)
        return self.beta_ref * (growth**self.softness_exponent)[:, None]


@dataclass(frozen=True)
class Resin:
    """A resin family: everything that follows from its mixing ratio.

    Ratios are in the unit named by ``ratio_meaning``; ``law`` with its ``numbers`` gives
    the long-term Young's modulus, ``arms`` the relaxation at ``relaxation_ratio_ref``. ``posterior``
    holds joint draws of the law's parameters when points have updated it; ``prior_numbers`` and ``prior_relaxation``
    (arms and their ratio) are those before. ``joint_relaxation`` ties strengths to the modulus (a calibration's).
    ``pressed_force`` is that of presses where effects of a calibration change the arms with depth or speed.
    ``ogden_alpha`` is the exponent of the elastic law where pucks show another than neo-Hookean (2), else None.
    ``ratio_by`` is what parts are measured by (weight or volume), ``ratio_per`` whether the ratio is to the parts of
    the other components (others) or in 100 parts of the whole mix (mix). ``chemistry`` is empty where it is not known.
    """

    name: str
    title: str
    origin: str
    ratio_meaning: str
    ratio_min: float
    ratio_max: float
    ratio_step: float
    liquids: tuple[Liquid, ...]
    law: ModulusLaw
    numbers: Mapping[str, Quantity]
    arms: tuple[ResinArm, ...]
    relaxation_ratio_ref: float
    softness_exponent: Quantity
    properties: Mapping[str, Quantity]
    references: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    points: tuple[Point, ...] = ()
    contradictions: tuple[str, ...] = ()
    posterior: Mapping[str, NDArray] | None = field(default=None, repr=False)
    prior_numbers: Mapping[str, Quantity] | None = field(default=None, repr=False)
    prior_relaxation: tuple[tuple[ResinArm, ...], float] | None = field(default=None, repr=False)
    joint_relaxation: RelaxationGivenModulus | None = field(default=None, repr=False)
    ogden_alpha: Quantity | None = None
    pressed_force: PressedForce | None = field(default=None, repr=False)
    ratio_by: str = "weight"
    ratio_per: str = "others"
    chemistry: str = ""

    @property
    def measured(self) -> bool:
        """Whether this batch was measured: by a puck, or by the pads of a calibration."""
        return self.joint_relaxation is not None or any(point.puck is not None for point in self.points)

    def same_ratio(self, first: Point, second: Point) -> bool:
        """Whether two points are of one ratio, within half a step."""
        return math.isclose(first.ratio, second.ratio, abs_tol=0.5 * self.ratio_step)

    def check_ratio(self, ratio: ArrayLike) -> None:
        """Refuse ratios outside the range the law is meant for (InputError)."""
        values = np.atleast_1d(np.asarray(ratio, float))
        wrong = values[~((values >= self.ratio_min - 1e-9) & (values <= self.ratio_max + 1e-9))].tolist()
        if wrong:
            raise out_of_range(
                f"ratio of {self.name}", wrong[0], self.ratio_min, self.ratio_max, self.ratio_meaning, "ratio"
            )

    @property
    def central(self) -> dict[str, float]:
        """Values of the law's parameters."""
        return {name: quantity.value for name, quantity in self.numbers.items()}

    def young_MPa(self, ratio: ArrayLike) -> Any:
        """Long-term (relaxed) Young's modulus at a ratio, central value.

        Parameters
        ----------
        ratio : float or array_like
            Mixing ratio, see ``ratio_meaning``.

        Returns
        -------
        float, or ndarray of the shape of ``ratio``
            Modulus. [MPa]

        Raises
        ------
        InputError
            When a ratio is outside the resin's range.
        """
        self.check_ratio(ratio)
        young = self.law.young_kPa(ratio, self.central) * 1e-3
        return float(young) if np.ndim(ratio) == 0 else young

    def modulus_kPa(self, ratio: float) -> Quantity:
        """Modulus at one ratio with its 95 % interval from the draws [kPa]."""
        value = self.young_MPa(ratio) * 1e3
        low, high = np.percentile(self._draws.young_MPa(ratio) * 1e3, [2.5, 97.5]).tolist()
        kind, at = ("fitted", ", updated by points") if self.points else ("inferred", "")
        return Quantity(
            value,
            min(low, value),
            max(high, value),
            kind,
            f"law {self.law.name} of resin {self.name}{at}; 95 % interval of {DRAWS} draws",
        )

    def ratio_for(self, young_MPa: float) -> float:
        """Ratio whose central modulus is the one given [MPa].

        Raises
        ------
        InputError
            When the modulus is not reached inside the resin's ratio range.
        """
        if not (math.isfinite(young_MPa) and young_MPa > 0):
            raise out_of_range("Young's modulus in kPa", young_MPa * 1e3, "above 0", "any finite value")
        ratio = float(self.law.ratio(young_MPa * 1e3, self.central))
        if not self.ratio_min - 1e-9 <= ratio <= self.ratio_max + 1e-9:
            ends = sorted(1e3 * self.young_MPa(end) for end in (self.ratio_min, self.ratio_max))
            young_kPa, low, high = round(young_MPa * 1e3, 4), round(ends[0], 2), round(ends[1], 2)
            raise out_of_range(f"Young's modulus of {self.name} in kPa", young_kPa, low, high)
        return min(max(ratio, self.ratio_min), self.ratio_max)

    def log_slope(self, ratio: float) -> float:
        """Relative change of the modulus per relative change of the ratio, d ln E / d ln r, central."""
        up, down = (self.law.young_kPa(ratio * (1 + step), self.central) for step in (1e-5, -1e-5))
        return float((np.log(up) - np.log(down)) / (math.log1p(1e-5) - math.log1p(-1e-5)))

    def prony(self, ratio: float) -> tuple[PronyTerm, ...]:
        """Relaxing arms at a ratio, strengths relative to the LONG-TERM modulus.

        beta_i(r) = beta_i(r_ref) (E(r_ref) / E(r))^q. q = 1 keeps the relaxing part of the modulus as it
        is while the long-term part vanishes (a critical gel, G(t) = S t^-n); q = 0 would scale both.

        Raises
        ------
        InputError
            When the ratio is outside the resin's range.
        """
        growth = (self.young_MPa(self.relaxation_ratio_ref) / self.young_MPa(ratio)) ** self.softness_exponent.value
        return tuple(PronyTerm(arm.tau_s.value, arm.beta.value * growth) for arm in self.arms)

    def arm_spread(self, ratio: float) -> tuple[float, ...]:
        """Standard deviations of ln tau and ln beta of each arm of :meth:`prony`: tau_1, beta_1, tau_2, ..."""
        strength = np.log(np.maximum(self._draws.beta(ratio), 1e-9)).std(axis=0)
        return tuple(one for arm, beta in zip(self.arms, strength.tolist()) for one in (arm.time_spread, beta))

    @property
    def tau_s(self) -> tuple[float, ...]:
        """Times of the arms. [s]"""
        return tuple(arm.tau_s.value for arm in self.arms)

    def strengths(self, ratio: Sequence[float] | NDArray) -> NDArray:
        """Strengths of the arms of ``prony`` at several ratios.

        Parameters
        ----------
        ratio : sequence of float, or ndarray, shape (n,)
            Mixing ratios, see ``ratio_meaning``.

        Returns
        -------
        ndarray, shape (n, arms)
            Relative to the LONG-TERM modulus.
        """
        return np.array([[term.beta for term in self.prony(float(value))] for value in ratio])

    def draw(self, count: int, seed: int | np.random.Generator = SEED) -> Draws:
        """Draw what is not known: law parameters (prior, or posterior after an update) and relaxation.

        Parameters
        ----------
        count : int
            Number of draws.
        seed : int or numpy Generator
            The same seed gives the same draws.
        """
        rng = np.random.default_rng(seed)
        if self.posterior is not None:
            rows = rng.integers(0, len(next(iter(self.posterior.values()))), count)
            numbers = {name: np.asarray(column)[rows] for name, column in self.posterior.items()}
        else:
            numbers = self._draw_prior(count, rng)
        if self.joint_relaxation is not None:
            young_kPa = self.law.young_kPa(self.relaxation_ratio_ref, numbers)
            beta_ref = self.joint_relaxation.draw([arm.beta.value for arm in self.arms], young_kPa, rng)
        else:
            beta = [value_at(arm.beta, rng.standard_normal(count)) for arm in self.arms]
            beta_ref = np.stack(beta, axis=1) if beta else np.zeros((count, 0))
        return Draws(self, numbers, beta_ref, value_at(self.softness_exponent, rng.standard_normal(count)))

    def _draw_prior(self, count: int, rng: np.random.Generator) -> dict[str, NDArray]:
        """Draw the law's parameters independently, drawing again what the law says cannot be."""
        kept: dict[str, list[NDArray]] = {name: [] for name in self.numbers}
        missing = count
        for _ in range(100):
            tried = {name: value_at(q, rng.standard_normal(missing)) for name, q in self.numbers.items()}
            good = np.broadcast_to(self.law.valid(self.ratio_min, tried), (missing,))
            for name, values in tried.items():
                kept[name].append(values[good])
            missing -= int(good.sum())
            if missing == 0:
                return {name: np.concatenate(parts) for name, parts in kept.items()}
        raise InputError(
            f"resin {self.name}: its intervals leave almost no valid law down to ratio {self.ratio_min}",
            "inconsistent",
            "resin.modulus",
        )

    @cached_property
    def _draws(self) -> Draws:
        return self.draw(DRAWS)

    def parts(self, ratio: float) -> dict[str, float]:
        """Parts by weight of each liquid at a ratio.

        Parts by volume are multiplied by the density of their liquid. A ratio to the whole mix leaves 100 less the
        ratio to the other liquids, in the proportion of their own parts.
        """
        self.check_ratio(ratio)
        others = (100.0 - ratio) / self._fixed_parts if self.ratio_per == "mix" else 1.0
        return {
            liquid.name: self._weight_per_part(liquid) * (ratio if liquid.parts is None else others * liquid.parts)
            for liquid in self.liquids
        }

    @property
    def _fixed_parts(self) -> float:
        return sum(liquid.parts for liquid in self.liquids if liquid.parts is not None)

    def _weight_per_part(self, liquid: Liquid) -> float:
        return liquid.density_g_per_cm3.value if self.ratio_by == "volume" else 1.0

    def ratio_of(self, masses_g: Mapping[str, ArrayLike]) -> Any:
        """Mixing ratio that weighed masses make, in the resin's own definition.

        Parameters
        ----------
        masses_g : mapping of str to float or array_like
            Mass of each liquid. What is missing counts as none. [g]
        """
        parts = {
            liquid.name: np.asarray(masses_g.get(liquid.name, 0.0), float) / self._weight_per_part(liquid)
            for liquid in self.liquids
        }
        varied = next(liquid.name for liquid in self.liquids if liquid.parts is None)
        rest = sum(part for name, part in parts.items() if name != varied)
        if self.ratio_per == "mix":
            return 100.0 * parts[varied] / np.maximum(parts[varied] + rest, 1e-12)
        return self._fixed_parts * parts[varied] / np.maximum(rest, 1e-12)

    def recipe(self, ratio: float, total_g: float) -> list[Component]:
        """Masses to weigh for a total mass.

        Parameters
        ----------
        ratio : float
            Mixing ratio.
        total_g : float
            Mass of the mixed liquid, above 0. [g]

        Returns
        -------
        list of Component
            In pouring order; the masses sum to ``total_g``.

        Raises
        ------
        InputError
            When the ratio is outside the range or the mass is not positive.
        """
        if not (math.isfinite(total_g) and total_g > 0):
            raise out_of_range("total_g", total_g, "above 0", "any finite mass")
        parts = self.parts(ratio)
        return [Component(name, total_g * part / sum(parts.values())) for name, part in parts.items() if part > 0]

    def property(self, name: str, ratio: float) -> Quantity:
        """Property of the mixed liquid or of its cure at a ratio.

        Density follows from added volumes, viscosity from the mean of the logarithms by weight
        (Arrhenius' rule); the others are as in the file.

        Parameters
        ----------
        name : str
            ``density_g_per_cm3``, ``viscosity_Pa_s`` or a name in ``properties``.
        ratio : float
            Mixing ratio.

        Raises
        ------
        InputError
            When the name is not known or the ratio is outside the range.
        """
        parts = self.parts(ratio)
        if name in self.properties:
            return self.properties[name]
        if name not in MIXED:
            raise unknown_name(f"property of {self.name}", name, self.property_names(), quantity="property")
        return mixed(name, self.liquids, [parts[liquid.name] for liquid in self.liquids])

    def property_names(self) -> tuple[str, ...]:
        """Names that :meth:`property` knows."""
        return tuple(dict.fromkeys([*MIXED, *self.properties]))

    def ratios(self, low: float | None = None, high: float | None = None) -> NDArray:
        """Ratios in practical steps inside ``low`` to ``high``, both ends included; where they are one, that alone."""
        first = self.ratio_min if low is None else max(low, self.ratio_min)
        last = self.ratio_max if high is None else min(high, self.ratio_max)
        if first == last or self.ratio_min == self.ratio_max:
            return np.array([first] if first <= last else [])
        steps = np.arange(math.ceil(first / self.ratio_step - 1e-9), math.floor(last / self.ratio_step + 1e-9) + 1)
        return np.round(steps * self.ratio_step, INCREMENT_DIGITS)

    def to_dict(self) -> dict[str, Any]:
        """Return the whole resin file as plain values, every number with interval, kind and source."""
        modulus: dict[str, Any] = {"law": self.law.name, **self.numbers}
        if self.posterior is not None and self.prior_numbers is not None:
            modulus |= {"prior": self.prior_numbers, "posterior": self.posterior}
        relaxation: dict[str, Any] = {
            "ratio_ref": self.relaxation_ratio_ref,
            "softness_exponent": self.softness_exponent,
            "term": self.arms,
        }
        if self.prior_relaxation is not None:
            relaxation["prior"] = dict(zip(("ratio_ref", "term"), self.prior_relaxation[::-1]))
        return to_plain(
            {
                "schema": 1,
                **{key: getattr(self, key) for key in WRITTEN if key != "chemistry" or self.chemistry},
                "component": [
                    to_plain(one) | ({"parts": "ratio"} if one.parts is None else {}) for one in self.liquids
                ],
                "modulus": modulus,
                "relaxation": relaxation,
                "property": self.properties,
                **({} if self.ogden_alpha is None else {"elastic": {"ogden_alpha": self.ogden_alpha}}),
                **({"point": self.points} if self.points else {}),
            }
        )

    def uncertain(self) -> list[str]:
        """Names of the numbers of this resin that are inferred or assumed, in the order of the file."""
        numbers = {
            **{f"modulus.{name}": q for name, q in self.numbers.items()},
            **{f"relaxation.beta at {arm.tau_s.value:g} s": arm.beta for arm in self.arms},
            "relaxation.softness_exponent": self.softness_exponent,
            **{name: self.property(name, self.relaxation_ratio_ref) for name in self.property_names()},
        }
        return [name for name, quantity in numbers.items() if quantity.kind in ("inferred", "assumed")]
