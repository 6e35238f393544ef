"""Update a resin's relaxation by the arms that presses of a puck showed.

The base's arms are carried to the puck's ratio, with what is not known of its law (draws). Then, arm by arm:

- a measured arm takes the place of the base's nearest one within a factor of three in time where that is a guess
  (assumed or inferred): a guess has no weight beside a measurement. Where the base's is measured too, the posterior
  of ln beta is normal, with weights 1 / variance of both, and so is that of ln tau. Where the two miss each other by
  more than three of their joint standard deviation, both are widened until they agree (Birge ratio) and this is
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
from dummydesign.resin.model.resin import SURPRISE, Interval, Resin, ResinArm, log_spread

SAME_TIME = 3.0
GUESSES = ("assumed", "inferred")
DRAWS = 4000
NOTE = "relaxation: "
"""How the notes begin that an update adds to a resin."""


@dataclass(frozen=True)
class ArmUpdate:
    """What became of one arm: ``from`` is measured, both, base or gone; strengths are at the puck's ratio.

    ``arm`` is what the resin has now, None of one that is gone. ``notice`` says what a user should know of it, empty
    for what was to be expected.
    """

    tau_s: float
    came_from: str
    base_beta: Interval | None
    measured_beta: Interval | None
    arm: ResinArm | None
    notice: str = ""

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; strengths as {value, low, high} or null."""
        beta = None if self.arm is None else _of(self.arm.beta)
        strengths = {"base_beta": self.base_beta, "measured_beta": self.measured_beta, "beta": beta}
        plain = {key: one and one._asdict() for key, one in strengths.items()}
        return {"tau_s": self.tau_s, "from": self.came_from, **plain}


def update_relaxation(
    resin: Resin, measured: Sequence[ResinArm], ratio: float, seen_s: tuple[float, float]
) -> tuple[Resin, tuple[ArmUpdate, ...]]:
    """Put measured arms into a resin; also what became of each arm."""
    left = {at: _carried(column) for at, column in enumerate(resin.draw(DRAWS).beta(ratio).T)}
    updates = []
    for arm in sorted(measured, key=lambda one: one.tau_s.value):
        distances = ((abs(math.log(resin.arms[at].tau_s.value / arm.tau_s.value)), at) for at in left)
        off, near = min(distances, default=(math.inf, 0))
        known = left[near] if off <= math.log(SAME_TIME) else None
        if known is not None:
            del left[near]
        updates.append(_measured(arm, resin.arms[near] if known else None, known))
    updates += [_of_base(resin.arms[at], known, ratio, seen_s) for at, known in left.items()]
    updates.sort(key=lambda one: one.tau_s)
    arms = sorted((one.arm for one in updates if one.arm is not None), key=lambda arm: arm.tau_s.value)
    notices = (NOTE + one.notice for one in updates if one.notice)
    return replace(
        resin,
        arms=tuple(arms),
        relaxation_ratio_ref=ratio,
        prior_relaxation=resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref),
        notes=tuple(dict.fromkeys([*resin.notes, *notices])),
    ), tuple(updates)


def _measured(arm: ResinArm, base: ResinArm | None, known: Interval | None) -> ArmUpdate:
    """A measured arm, with the base's nearest one and its strength at this ratio where there is one."""
    tau, beta = arm.tau_s, arm.beta
    own, notice = _of(beta), ""
    if base is None or known is None or base.beta.kind in GUESSES:
        value = _interval(math.log(own.value), log_spread(own))
        return ArmUpdate(tau.value, "measured", known, own, replace(arm, beta=_with(beta, value)))
    value, widening = _combined(known, own)
    tau = _with(tau, _combined(_of(base.tau_s), _of(tau))[0])
    if widening > 1.0:
        notice = (
            f"the strength at {tau.value:.3g} s, {beta.value:.3g}, differs from the one measured before "
            f"({known.value:.3g}); both were widened {widening:.1f} times so that they agree"
        )
    beta = replace(beta, source=f"{beta.source}; before ({base.beta.source}) by inverse variance of ln beta")
    return ArmUpdate(tau.value, "both", known, own, ResinArm(tau, _with(beta, value)), notice)


def _of_base(arm: ResinArm, known: Interval | None, ratio: float, seen_s: tuple[float, float]) -> ArmUpdate:
    """An arm of the base that no measured one replaces, with its strength at this ratio."""
    time, value = arm.tau_s.value, known or Interval(0.0, 0.0, 0.0)
    if seen_s[0] <= time <= seen_s[1]:
        return ArmUpdate(
            time, "gone", known, None, None, f"the base's arm at {time:g} s is replaced by the measured ones"
        )
    notice = (
        f"the base's arm at {time:g} s, {value.value:.3g} ({value.low:.3g} to {value.high:.3g}), is kept: "
        f"the presses show {seen_s[0]:.2g} to {seen_s[1]:.3g} s"
    )
    carried = replace(arm.beta, source=f"{arm.beta.source}; carried to ratio {ratio:g}")
    return ArmUpdate(time, "base", known, None, replace(arm, beta=_with(carried, value)), notice)


def _of(one: Quantity) -> Interval:
    return Interval(one.value, one.low, one.high)


def _with(one: Quantity, ends: Interval) -> Quantity:
    return replace(one, **ends._asdict())


def _carried(draws: np.ndarray) -> Interval | None:
    """Median and 95 % interval of a strength; None for an arm without any."""
    low, value, high = np.percentile(draws, [2.5, 50.0, 97.5]).tolist()
    return Interval(value, low, high) if value > 0.0 else None


def _interval(log_value: float, spread: float) -> Interval:
    return Interval(*(math.exp(log_value + k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)))


def _combined(base: Interval, own: Interval) -> tuple[Interval, float]:
    """Posterior of a strength and the factor by which both were widened."""
    first, second = log_spread(base), log_spread(own)
    misfit = abs(math.log(base.value / own.value)) / math.hypot(first, second)
    widening = misfit if misfit > SURPRISE else 1.0
    weights = first**-2, second**-2
    centre = (weights[0] * math.log(base.value) + weights[1] * math.log(own.value)) / sum(weights)
    return _interval(centre, widening / math.sqrt(sum(weights))), widening
