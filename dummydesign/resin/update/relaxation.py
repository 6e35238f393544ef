"""Update a resin's relaxation by the arms that presses of a puck showed.

The base's arms are carried to the puck's ratio, with what is not known of its law (draws). Then, arm by arm:

- a measured arm takes the place of the base's nearest one within a factor of three in time where that is a guess
  (assumed or inferred): a guess has no weight beside a measurement. Where the base's is measured too, the posterior
  of ln beta is normal, with weights 1 / variance of both, and so is that of ln tau. Where the two miss each other by
  more than 2.6 of their joint standard deviation, both are widened until they agree (Birge ratio) and this is
  reported;
- a measured arm without a counterpart is taken as measured;
- an arm of the base inside the times that the presses show, without a counterpart, is not there: the measured
  arms stand for all of it;
- an arm of the base outside those times is kept as the base has it, with its own interval, and this is reported.

The interval is that of the batch that was poured. Another pour of the recipe is another batch.

References
----------
Birge, Phys. Rev. 40 (1932) 207 (widening of inconsistent data).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.resin.model.resin import SMALLEST_SPREAD, Interval, Resin, ResinArm

SAME_TIME = 3.0
GUESSES = ("assumed", "inferred")
DRAWS = 4000
SURPRISE = 2.6
NOTE = "relaxation: "
"""How the notes begin that an update adds to a resin."""


@dataclass(frozen=True)
class ArmUpdate:
    """What became of one arm: ``from`` is measured, both, base or gone; strengths are at the puck's ratio.

    ``notice`` says what a user should know of it, empty for what was to be expected.
    """

    tau_s: float
    came_from: str
    base_beta: Interval | None
    measured_beta: Interval | None
    beta: Interval | None
    notice: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; strengths as {value, low, high} or null."""
        strengths = {"base_beta": self.base_beta, "measured_beta": self.measured_beta, "beta": self.beta}
        plain = {key: None if one is None else one._asdict() for key, one in strengths.items()}
        return {"tau_s": self.tau_s, "from": self.came_from, **plain}


Updated = tuple[Resin, tuple[ArmUpdate, ...], tuple[str, ...]]
"""A resin, what became of its arms, and notices."""


def update_relaxation(resin: Resin, measured: Sequence[ResinArm], ratio: float, seen_s: tuple[float, float]) -> Updated:
    """Put measured arms into a resin."""
    base = [_carried(column) for column in resin.draw(DRAWS).beta(ratio).T]
    taken: set[int] = set()
    arms: list[ResinArm] = []
    updates: list[ArmUpdate] = []
    for tau, beta in sorted(((arm.tau_s, arm.beta) for arm in measured), key=lambda pair: pair[0].value):
        free = [at for at in range(len(base)) if at not in taken]
        distances = ((abs(math.log(resin.arms[at].tau_s.value / tau.value)), at) for at in free)
        off, index = min(distances, default=(math.inf, 0))
        own = Interval(beta.value, beta.low, beta.high)
        carried = base[index] if off <= math.log(SAME_TIME) else None
        value, source, came_from, notice = _interval(math.log(own.value), _spread(own)), beta.source, "measured", ""
        if carried is not None:
            taken.add(index)
            known = resin.arms[index].beta
            if known.kind not in GUESSES:
                value, widening = _combined(carried, own)
                times = (Interval(one.value, one.low, one.high) for one in (resin.arms[index].tau_s, tau))
                tau = Quantity(*_combined(*times)[0], tau.kind, tau.source)
                came_from, source = "both", f"{source}; before ({known.source}) by inverse variance of ln beta"
                if widening > 1.0:
                    notice = (
                        f"the strength at {tau.value:.3g} s, {beta.value:.3g}, differs from the one measured before "
                        f"({carried.value:.3g}); both were widened {widening:.1f} times so that they agree"
                    )
        updates.append(ArmUpdate(tau.value, came_from, carried, own, value, notice))
        arms.append(ResinArm(tau, Quantity(*value, beta.kind, source)))
    for index, arm in enumerate(resin.arms):
        if index in taken:
            continue
        time = arm.tau_s.value
        if seen_s[0] <= time <= seen_s[1]:
            notice = f"the base's arm at {time:g} s is replaced by the measured ones"
            updates.append(ArmUpdate(time, "gone", base[index], None, None, notice))
            continue
        value = base[index] or Interval(0.0, 0.0, 0.0)
        source = f"{arm.beta.source}; carried to ratio {ratio:g}"
        arms.append(ResinArm(arm.tau_s, Quantity(*value, arm.beta.kind, source)))
        notice = (
            f"the base's arm at {time:g} s, {value.value:.3g} ({value.low:.3g} to {value.high:.3g}), is kept: "
            f"the presses show {seen_s[0]:.2g} to {seen_s[1]:.3g} s"
        )
        updates.append(ArmUpdate(time, "base", base[index], None, value, notice))
    updates.sort(key=lambda one: one.tau_s)
    notices = tuple(one.notice for one in updates if one.notice)
    changed = replace(
        resin,
        arms=tuple(sorted(arms, key=lambda arm: arm.tau_s.value)),
        relaxation_ratio_ref=ratio,
        prior_relaxation=resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref),
        notes=tuple(dict.fromkeys([*resin.notes, *(NOTE + text for text in notices)])),
    )
    return changed, tuple(updates), notices


def _carried(draws: np.ndarray) -> Interval | None:
    """Median and 95 % interval of a strength; None for an arm without any."""
    low, value, high = np.percentile(draws, [2.5, 50.0, 97.5]).tolist()
    return Interval(value, low, high) if value > 0.0 else None


def _spread(beta: Interval) -> float:
    """Standard deviation of ln beta from a 95 % interval; an end at zero counts as far away."""
    return max(math.log(beta.high / max(beta.low, 1e-3 * beta.value)) / (2.0 * HALF_WIDTH), SMALLEST_SPREAD)


def _interval(log_value: float, spread: float) -> Interval:
    return Interval(*(math.exp(log_value + k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)))


def _combined(base: Interval, own: Interval) -> tuple[Interval, float]:
    """Posterior of a strength and the factor by which both were widened."""
    first, second = _spread(base), _spread(own)
    misfit = abs(math.log(base.value / own.value)) / math.hypot(first, second)
    widening = misfit if misfit > SURPRISE else 1.0
    weights = first**-2, second**-2
    centre = (weights[0] * math.log(base.value) + weights[1] * math.log(own.value)) / sum(weights)
    return _interval(centre, widening / math.sqrt(sum(weights))), widening
