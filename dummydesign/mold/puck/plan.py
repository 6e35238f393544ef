"""What to weigh and to pour for the pucks of one batch. No CAD."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.pour.plan import CUP_FACTOR, GRAM_PER_HOUR, Mix, batch_limits_g, mix_of
from dummydesign.mold.pour.steps import assumed_words
from dummydesign.mold.puck.ring import PuckSpec, Ring, cavity_mm3, puck_spec, ring_mass_g


@dataclass(frozen=True)
class PuckPlan:
    """One pour: what is mixed, what of it goes into each ring; ``raised`` when the balance needs more than that."""

    mix: Mix
    pour_g: tuple[float, ...]
    puck_g: tuple[float, ...]
    wanted_g: float
    raised: bool
    cup_mm3: float
    level_deg: float

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            **self.mix.to_dict(),
            "pour_g": list(self.pour_g),
            "puck_g": list(self.puck_g),
            "wanted_g": self.wanted_g,
            "raised": self.raised,
            "cup_mm3": self.cup_mm3,
            "level_deg": self.level_deg,
        }


def puck_plan(spec: PuckSpec) -> PuckPlan:
    """Work out the pour: all rings filled a little over the rim, film and spare added, weighable in the right ratio."""
    pour = spec.pour
    density = pour.density_g_per_cm3 * 1e-3
    over = tuple(density * (cavity_mm3(spec, ring) + _over_rim_mm3(spec, ring)) for ring in spec.rings)
    needed = sum(ring.count * mass for ring, mass in zip(spec.rings, over))
    wanted = needed * (1 + pour.extra_percent / 100) + pour.film_loss_g
    least, _ = batch_limits_g(pour, spec.machines)
    mix = mix_of(max(wanted, least), pour, spec.machines.balance_resolution_g)
    return PuckPlan(
        mix,
        over,
        tuple(density * ring.volume_mm3 for ring in spec.rings),
        wanted,
        wanted < least,
        CUP_FACTOR * mix.total_g / density,
        min(formula.level_tolerance_deg(ring.height_mm, ring.diameter_mm) for ring in spec.rings),
    )


def _over_rim_mm3(spec: PuckSpec, ring: Ring) -> float:
    """Half of the cap that surface tension holds over a rim: what the strike-off plate drives out. [mm3]"""
    pour = spec.pour
    high = formula.meniscus_height_mm(pour.surface_tension_N_per_m, pour.density_g_per_cm3, 0.0)
    return 0.5 * high * math.pi / 4 * (spec.scale * ring.diameter_mm) ** 2


def warnings_of(spec: PuckSpec, plan: PuckPlan) -> list[dict[str, str]]:
    """What changes what the user does."""
    notes: dict[str, str] = {}
    if words := assumed_words(spec.pour):
        notes["assumed_numbers"] = words
    if plan.raised:
        notes["batch_raised"] = (
            f"the balance cannot weigh {plan.wanted_g:.0f} g, the pucks with cup loss and spare, in the right "
            f"ratio: mix {plan.mix.total_g:.0f} g, or pour the pad's or a second puck of the same cup"
        )
    return [{"code": code, "message": message} for code, message in notes.items()]


@dataclass(frozen=True)
class RingCost:
    """What the rings of some pucks take."""

    printing_h: float
    filament_g: float
    resin_g: float


def ring_cost(
    diameter_mm: float = 50.0,
    height_mm: float = 30.0,
    count: int = 1,
    resin: str | None = None,
    ratio: float = 15.0,
) -> RingCost:
    """Estimate printing hours and grams of a puck's ring and of the resin to mix; loads no CAD.

    Parameters
    ----------
    diameter_mm, height_mm : float
        Of the puck. [mm]
    count : int
        Pucks, each with a ring.
    resin : str, optional
        The paper's polyurethane by default.
    ratio : float
        Mixing ratio.
    """
    return spec_cost(puck_spec((Ring(diameter_mm, height_mm, count),), resin=resin, ratio=ratio))


def spec_cost(spec: PuckSpec) -> RingCost:
    """Estimate what the rings of a specification take, and the resin of all pucks."""
    filament = sum(ring.count * ring_mass_g(spec, ring) for ring in spec.rings)
    return RingCost(filament / GRAM_PER_HOUR, filament, puck_plan(spec).mix.total_g)
