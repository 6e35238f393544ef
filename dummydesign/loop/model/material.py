"""What is known of a campaign's material before its pads are pressed: modulus and relaxing arms with their spread."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.loop.data.pad_modulus_factors import PADS_DIFFER
from dummydesign.loop.model.forward_model import BaseParameters, base_names
from dummydesign.measurement.campaign import Campaign
from dummydesign.pad.material.relaxation import PronyTerm

USUAL_ARMS = (PronyTerm(0.07, 0.3), PronyTerm(1.5, 0.3))
"""Arms that stand for a material of which no relaxation is declared."""
RELEASED = 20.0
"""Factor on the spread of a declared number that the presses contradict: what they say then stands."""
ARM_TOLERANCE = 0.05
"""Standard deviation of the logarithm of an arm's time and strength from pour to pour beside what the data say: newly
cast pads scatter in strength (assumed: a twentieth)."""


@dataclass(frozen=True)
class BasePrior:
    """Mean and standard deviation of the logarithms of modulus [MPa] and arms [s, 1]; infinite if nothing is known."""

    mean: NDArray
    spread: NDArray

    @property
    def arms(self) -> int:
        """Number of arms."""
        return len(self.mean) // 2

    @cached_property
    def declared(self) -> bool:
        """Whether the material's arms are known."""
        return bool(np.isfinite(self.spread[1:]).any())

    def released(self, names: Collection[str]) -> BasePrior:
        """The prior where these numbers are known :data:`RELEASED` times less well."""
        wider = [RELEASED if name in names else 1.0 for name in base_names(self.arms)]
        return BasePrior(self.mean, self.spread * wider)

    def bounds(self) -> tuple[NDArray, NDArray]:
        """Bounds of the logarithms: those of arms that are not declared keep the fast one before the slow one."""
        low, high = widest_bounds(self.arms)
        if not self.declared and self.arms == 2:
            low[[1, 3]], high[1] = np.log([2e-3, 0.05]), np.log(3.0)
        return low, high


def widest_bounds(arms: int) -> tuple[NDArray, NDArray]:
    """Bounds of the logarithms of modulus [MPa], and of time [s] and strength of each arm."""
    return (
        np.log([0.2e-3, *(1e-3, 1e-3) * arms]),
        np.log([20.0, *(100.0, 20.0) * arms]),
    )


@dataclass(frozen=True)
class Material:
    """Long-term modulus with its 95 % interval, where there is one, and the relaxation; its source is that of both.

    ``arm_spread`` holds the standard deviations of ln tau and ln beta of each arm of ``prony``, which is empty where no
    relaxation is declared. ``alpha`` is the exponent of the elastic law where it is not neo-Hookean.
    """

    young_kPa: Quantity
    prony: tuple[PronyTerm, ...]
    arm_spread: tuple[float, ...] = ()
    alpha: Quantity | None = None

    @property
    def prior(self) -> BasePrior:
        """What a fit knows before: a pad differs from another of one batch by :data:`PADS_DIFFER`."""
        arms, young = self.prony or USUAL_ARMS, self.young_kPa
        mean = BaseParameters(1e-3 * young.value, tuple(a.tau_s for a in arms), tuple(a.beta for a in arms)).to_logs()
        spread = np.full(len(mean), np.inf)
        if self.prony:
            spread[1:] = np.hypot(self.arm_spread, ARM_TOLERANCE)
        if young.high > young.low:
            spread[0] = np.hypot(np.log(young.high / young.low) / (2.0 * HALF_WIDTH), PADS_DIFFER)
        return BasePrior(mean, spread)

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        young = {end: getattr(self.young_kPa, end) for end in ("value", "low", "high")}
        return {"young_kPa": young, "prony": [term.to_dict() for term in self.prony], "source": self.young_kPa.source}


def material_of(campaign: Campaign) -> Material:
    """Modulus and relaxation of a campaign's pads as declared: the nominal modulus, or the resin's at its ratio."""
    pad, value = campaign.pad, campaign.pad.young_kPa_nominal
    if pad.resin is None or pad.ratio is None:
        if value is None:
            message = "campaign.toml: [pad] needs young_kPa_nominal, or resin and ratio"
            raise InputError(message, "missing", "pad.young_kPa_nominal")
        return Material(Quantity(value, value, value, "assumed", "given, no interval known"), ())
    from dummydesign.resin import load_resin

    resin = load_resin(pad.resin)
    resin.check_ratio(pad.ratio)
    prony, spread = resin.prony(pad.ratio), resin.arm_spread(pad.ratio)
    if value is None:
        young = resin.modulus_kPa(pad.ratio)
    else:
        young = Quantity(value, value, value, "assumed", f"given, no interval known; relaxation of {resin.name}")
    return Material(young, prony, spread, resin.ogden_alpha)


UNDECLARED = Material(Quantity(30.0, 30.0, 30.0, "assumed", "not declared"), ()).prior
