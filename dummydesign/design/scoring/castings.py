"""Castings of a resin: batches and making drawn once, in named groups, for every fraction and quantile of an answer."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, value_at
from dummydesign.core.serialise import Serialised
from dummydesign.design.scoring.crowns import Crowns
from dummydesign.design.scoring.settings import STEPS, CrownMaking
from dummydesign.resin.model.resin import Draws, Resin

MODULUS, RELAXATION, MAKING, FORCE_LAW = GROUPS = ("modulus", "relaxation", "making", "force_law")
RESIN = frozenset((MODULUS, RELAXATION))
# Castings: a share of 1200 has a standard error of at most 1.45 points.
COUNT, SEED, MOST = 1200, 11, 100_000


@dataclass(frozen=True)
class Tolerances(Serialised):
    """How well a pad is made. Errors are even within plus and minus these limits.

    ``pour_g`` is the whole mass that is weighed in, ``crown`` what is known of a crown's height and tip radius; None
    for a pad without one.
    """

    pour_g: float
    weighing_g: float = 0.1
    thickness_mm: float = 0.2
    crown: CrownMaking | None = None


@dataclass(frozen=True, eq=False)
class Pours:
    """Pads that may come out of one design: ``thickness_mm``, ``young_MPa`` (n,) and ``beta`` (n, arms).

    ``thickness_mm`` is that of a pad whose crown is as designed; ``crowns`` are those of the pads, None where they are
    as designed. ``finite_strain`` (n,) are standard normal deviates of what finite strain makes of readings.
    """

    thickness_mm: NDArray
    young_MPa: NDArray
    beta: NDArray
    finite_strain: NDArray
    crowns: Crowns | None = None


@dataclass(frozen=True)
class Castings:
    """Deviates of n castings of a resin; see :meth:`pours`."""

    resin: Resin
    n: int = COUNT
    seed: int = SEED

    def __post_init__(self) -> None:
        if not COUNT <= self.n <= MOST:
            message = f"castings = {self.n} is outside {COUNT} to {MOST}: fewer leave percentages too uncertain"
            raise InputError(message, "out_of_range", "castings", self.n, (COUNT, MOST))

    @cached_property
    def _drawn(self) -> dict[str, Any]:
        # a stream of its own for each group, so that none depends on another
        of_resin, of_making, of_law = np.random.default_rng(self.seed).spawn(3)
        weighed = {liquid.name: of_making.uniform(-1.0, 1.0, self.n) for liquid in self.resin.liquids}
        thickness, law = of_making.uniform(-1.0, 1.0, self.n), of_law.standard_normal(self.n)
        crown, strain = of_making.standard_normal((2, len(STEPS), self.n)), of_law.standard_normal(self.n)
        resin = self.resin.draw(self.n, of_resin)
        central = {name: np.full(self.n, value) for name, value in self.resin.central.items()}
        beta = np.tile([arm.beta.value for arm in self.resin.arms], (self.n, 1))
        softness = np.full(self.n, self.resin.softness_exponent.value)
        stated = replace(resin, numbers=central, beta_ref=beta, softness_exponent=softness)
        return {
            "weighed": weighed,
            "thickness": thickness,
            "crown": crown,
            "law": law,
            "strain": strain,
            "resin": resin,
            "central": stated,
        }

    @property
    def batches(self) -> Draws:
        """Batches of the resin, one a casting."""
        return self._drawn["resin"]

    @property
    def central(self) -> Draws:
        """As many batches at the resin's central numbers."""
        return self._drawn["central"]

    def pours(
        self,
        thickness_mm: float,
        ratio: float | NDArray,
        tolerances: Tolerances,
        error: float = 0.0,
        known: Collection[str] = (),
    ) -> Pours:
        """Pads that may come out of one design; ``ratio`` is one for all, or one a casting, shape (n,)."""
        drawn, making = self._drawn, MAKING not in known
        weighed = self._weighed_ratio(ratio, tolerances) if making else np.broadcast_to(ratio, self.n)
        thickness = thickness_mm + (tolerances.thickness_mm * drawn["thickness"] if making else np.zeros(self.n))
        modulus, relaxation = (drawn["central" if group in known else "resin"] for group in (MODULUS, RELAXATION))
        law, strain = (drawn[name] * (FORCE_LAW not in known) for name in ("law", "strain"))
        kept = np.clip(weighed, self.resin.ratio_min, self.resin.ratio_max)
        young = np.maximum(modulus.young_MPa(weighed), 1e-9) * np.exp(error / HALF_WIDTH * law)
        crowns = self.crowns(tolerances.crown) if making and tolerances.crown else None
        return Pours(thickness, young, relaxation.beta(kept), strain, crowns)

    def crowns(self, making: CrownMaking) -> Crowns:
        """Crowns that may come out; the errors of the steps add up."""
        heights, radii = self._drawn["crown"]
        higher = sum(value_at(making.height_mm[name], z) for name, z in zip(STEPS, heights))
        blunter = sum(value_at(making.tip_radius_percent[name], z) for name, z in zip(STEPS, radii))
        return Crowns(np.asarray(higher), np.maximum(1.0 + 0.01 * np.asarray(blunter), 0.01))

    def _weighed_ratio(self, ratio: float | NDArray, tolerances: Tolerances) -> NDArray:
        """Ratio that is in the cup when every component is weighed with an error of its own."""
        fixed = {liquid.name: liquid.parts for liquid in self.resin.liquids if liquid.parts}
        by_ratio = next(liquid.name for liquid in self.resin.liquids if liquid.parts is None)
        others, wanted = sum(fixed.values()), np.broadcast_to(ratio, self.n)
        errors = {name: tolerances.weighing_g * own for name, own in self._drawn["weighed"].items()}
        gram = tolerances.pour_g / (others + wanted)
        # a liquid at ratio 0 is not weighed
        varied = np.where(wanted > 0.0, np.maximum(gram * wanted + errors[by_ratio], 0.0), 0.0)
        rest = sum(np.maximum(gram * parts + errors[name], 0.0) for name, parts in fixed.items())
        return np.asarray(others * varied / np.maximum(rest, 1e-9))

    def weighing_spread(self, ratio: float, tolerances: Tolerances) -> float:
        """Standard deviation of ln modulus that weighing leaves at a ratio."""
        masses = np.array([item.mass_g for item in self.resin.recipe(ratio, tolerances.pour_g)])
        relative = np.sqrt(np.sum(masses**-2.0)) * tolerances.weighing_g / np.sqrt(3.0)
        return float(abs(self.resin.log_slope(ratio)) * relative)
