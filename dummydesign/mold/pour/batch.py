"""The batch that is mixed: as much as the balance can weigh true, and how much of it goes into the mould. No CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.pour.plan import CUP_FACTOR, PourPlan, split_batch

WITNESS_DIAMETER_MM, WITNESS_HEIGHT_MM = 50.0, 30.0


@dataclass(frozen=True)
class Mix:
    """What is weighed into one cup; ``error_percent`` is the largest error of a component's share. [g, %]"""

    components: tuple[tuple[str, float], ...]
    total_g: float
    error_percent: float

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "components": [{"name": name, "mass_g": mass} for name, mass in self.components],
            "total_g": self.total_g, "weighing_error_percent": self.error_percent,
        }  # fmt: skip


@dataclass(frozen=True)
class Batch:
    """One batch: what to mix, what of it to pour into the mould, and what to mix for a witness puck as well. [g]"""

    mix: Mix
    pour_g: float
    raised: bool
    witness_g: float
    with_witness: Mix

    @property
    def holds_witness(self) -> bool:
        """Whether what the mould leaves is enough for the witness puck."""
        return self.with_witness == self.mix

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        witness = {"mass_g": self.witness_g, **self.with_witness.to_dict()}
        return {**self.mix.to_dict(), "pour_g": self.pour_g, "witness": witness}


def witness_mass_g(pour: Pour) -> float:
    """Liquid for the witness puck. [g]"""
    volume = math.pi / 4 * WITNESS_DIAMETER_MM**2 * WITNESS_HEIGHT_MM
    return volume * pour.density_g_per_cm3 * 1e-3


def batch_of(spec: MouldSpec, pour: Pour, plan: PourPlan) -> Batch:
    """Work out the batch of one pour.

    It is the pour's own, raised to whole grams where the balance could not weigh that in the right ratio, but not
    above what foams in the vacuum chamber.

    Parameters
    ----------
    spec : MouldSpec
        The mould; its balance and chamber count.
    pour : Pour
        The resin of this pour.
    plan : PourPlan
        Weights of this pour.

    Returns
    -------
    Batch
    """
    machines = spec.machines
    cup_mm = min(machines.chamber_diameter_mm, machines.chamber_height_mm)
    most = math.pi / 4 * cup_mm**3 / CUP_FACTOR * pour.density_g_per_cm3 * 1e-3
    least = min(math.ceil(plan.batch_for_ratio_g - 1e-9), math.floor(most))
    own = Mix(plan.components, plan.batch_mass_g, plan.ratio_error_percent)
    mix = own if plan.batch_mass_g >= least else _mix(least, pour, machines.balance_resolution_g)
    wanted = plan.batch_mass_g + (1 + pour.extra_percent / 100) * witness_mass_g(pour)
    both = mix if wanted <= mix.total_g else _mix(wanted, pour, machines.balance_resolution_g)
    poured = spec.count * plan.fill_mass_g
    return Batch(mix, round(poured, 2), mix is not own, round(witness_mass_g(pour), 2), both)


def batches_of(spec: MouldSpec, plan: PourPlan) -> dict[str, Any]:
    """The batch of a mould in plain values; that of a layered pad's base as ``base``."""
    found = batch_of(spec, spec.pour, plan).to_dict()
    if spec.base is None or plan.base is None:
        return found
    return {**found, "base": batch_of(spec, spec.base.pour, plan.base).to_dict()}


def _mix(total_g: float, pour: Pour, resolution_g: float) -> Mix:
    components, error = split_batch(total_g, pour.components, resolution_g)
    return Mix(components, round(sum(mass for _, mass in components), 6), error)
