"""Update a resin's relaxation by the arms that a puck's holds showed.

The base's arms are carried to the puck's ratio, with what is not known of its law (draws). Then, arm by arm:

- a measured arm and the base's nearest one within a factor of three in time are taken for the same; the posterior
  of ln beta is normal, with weights 1 / variance of the base's and of the measured. The time is the measured one.
  Where the two miss each other by more than 2.6 of their joint standard deviation, both are widened until they
  agree (Birge ratio) and this is reported;
- a measured arm without a counterpart is taken as measured;
- an arm of the base inside the times that the puck could show, without a counterpart, is not there: the measured
  arms stand for all of it;
- an arm of the base outside those times is kept as the base has it, and this is reported.

From pour to pour strengths scatter by more than one puck shows: :data:`POUR` is added to the measured spread.

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

from dummydesign.core.quantity import Quantity
from dummydesign.resin.model.distribution import HALF_WIDTH
from dummydesign.resin.model.resin import Arm, Resin

SAME_TIME = 3.0
POUR = 0.05
"""Standard deviation of ln beta from pour to pour that is added to a puck's own: assumed, a twentieth."""
DRAWS = 4000
SURPRISE = 2.6


@dataclass(frozen=True)
class ArmUpdate:
    """What became of one arm: ``from`` is measured, both, base or gone; strengths are at the puck's ratio."""

    tau_s: float
    came_from: str
    base_beta: tuple[float, float, float] | None
    measured_beta: tuple[float, float, float] | None
    beta: tuple[float, float, float] | None

    def to_dict(self) -> dict[str, Any]:
        """Return plain values; strengths as {value, low, high} or null."""
        named = {"base_beta": self.base_beta, "measured_beta": self.measured_beta, "beta": self.beta}
        ends = ("value", "low", "high")
        strengths = {key: None if one is None else dict(zip(ends, one)) for key, one in named.items()}
        return {"tau_s": self.tau_s, "from": self.came_from, **strengths}


def update_relaxation(
    resin: Resin, measured: Sequence[tuple[Quantity, Quantity]], ratio: float, seen_s: tuple[float, float]
) -> tuple[Resin, tuple[ArmUpdate, ...], tuple[str, ...]]:
    """Put measured arms into a resin.

    Parameters
    ----------
    resin : Resin
        With its modulus already updated.
    measured : sequence of (tau_s, beta)
        Identifiable arms, strengths relative to the long-term modulus at ``ratio``.
    ratio : float
        Mixing ratio of the puck; becomes the ratio that the arms refer to.
    seen_s : (float, float)
        Shortest and longest time that the puck could show. [s]

    Returns
    -------
    resin : Resin
    updates : tuple of ArmUpdate
        In rising time.
    said : tuple of str
        What a reader must know: what was kept, dropped, or did not agree.
    """
    drawn = resin.draw(DRAWS).beta(ratio)
    base = [_carried(column) for column in drawn.T]
    taken: set[int] = set()
    arms: list[Arm] = []
    updates: list[ArmUpdate] = []
    said: list[str] = []
    for tau, beta in sorted(measured, key=lambda pair: pair[0].value):
        near = [
            (abs(math.log(arm.tau_s.value / tau.value)), index)
            for index, arm in enumerate(resin.arms)
            if index not in taken and abs(math.log(arm.tau_s.value / tau.value)) <= math.log(SAME_TIME)
        ]
        own = (beta.value, beta.low, beta.high)
        carried = base[min(near)[1]] if near else None
        if carried is not None:
            index = min(near)[1]
            taken.add(index)
            value, widening = _combined(carried, own)
            if widening > 1.0:
                said.append(
                    f"the strength at {tau.value:.3g} s, {beta.value:.3g}, is not what the base states "
                    f"({carried[0]:.3g}); both were widened {widening:.1f} times so that they agree"
                )
            source = f"{beta.source}; prior ({resin.arms[index].beta.source}) by inverse variance of ln beta"
            updates.append(ArmUpdate(tau.value, "both", base[index], own, value))
        else:
            spread = math.hypot(_spread(own), POUR)
            value = _interval(math.log(beta.value), spread)
            source = f"{beta.source}; spread from pour to pour {POUR:g} of ln beta assumed"
            updates.append(ArmUpdate(tau.value, "measured", None, own, value))
        arms.append(Arm(tau, Quantity(*value, "fitted", source)))
    for index, arm in enumerate(resin.arms):
        if index in taken:
            continue
        time = arm.tau_s.value
        if seen_s[0] <= time <= seen_s[1]:
            updates.append(ArmUpdate(time, "gone", base[index], None, None))
            said.append(f"the base's arm at {time:g} s is replaced by the measured ones")
            continue
        value = base[index] or (0.0, 0.0, 0.0)
        source = f"{arm.beta.source}; carried to ratio {ratio:g}"
        arms.append(Arm(arm.tau_s, Quantity(*value, arm.beta.kind, source)))
        updates.append(ArmUpdate(time, "base", base[index], None, value))
        said.append(f"the base's arm at {time:g} s is kept: holds show {seen_s[0]:.2g} to {seen_s[1]:.3g} s")
    order = np.argsort([arm.tau_s.value for arm in arms])
    changed = replace(
        resin, arms=tuple(arms[k] for k in order), relaxation_ratio_ref=ratio,
        prior_relaxation=resin.prior_relaxation or (resin.arms, resin.relaxation_ratio_ref),
        notes=(*resin.notes, *(f"relaxation: {text}" for text in said if f"relaxation: {text}" not in resin.notes)),
    )  # fmt: skip
    return changed, tuple(sorted(updates, key=lambda one: one.tau_s)), tuple(said)


def _carried(draws: np.ndarray) -> tuple[float, float, float] | None:
    """Median and 95 % interval of a strength; None for an arm without any."""
    low, value, high = (float(end) for end in np.percentile(draws, [2.5, 50.0, 97.5]))
    return (value, low, high) if value > 0.0 else None


def _spread(triple: tuple[float, float, float]) -> float:
    """Standard deviation of ln beta from a 95 % interval; an end at zero counts as far away."""
    value, low, high = triple
    return math.log(high / max(low, 1e-3 * value)) / (2.0 * HALF_WIDTH)


def _interval(log_value: float, spread: float) -> tuple[float, float, float]:
    return tuple(math.exp(log_value + k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0))  # type: ignore[return-value]


def _combined(
    base: tuple[float, float, float], own: tuple[float, float, float]
) -> tuple[tuple[float, float, float], float]:
    """Posterior of a strength and the factor by which both were widened."""
    first, second = _spread(base), math.hypot(_spread(own), POUR)
    apart = math.log(base[0] / own[0])
    misfit = abs(apart) / math.hypot(first, second)
    widening = misfit if misfit > SURPRISE else 1.0
    weights = first**-2, second**-2
    centre = (weights[0] * math.log(base[0]) + weights[1] * math.log(own[0])) / sum(weights)
    return _interval(centre, widening / math.sqrt(sum(weights))), widening
