"""What to weigh and to pour for the pucks of one batch, how they are pressed, and what is typed then. No CAD."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.pour.plan import CUP_FACTOR, GRAM_PER_HOUR, Mix, batch_limits_g, mix_of
from dummydesign.mold.pour.steps import assumed_words
from dummydesign.mold.puck.ring import PuckSpec, Ring, cavity_mm3, puck_spec, ring_mass_g

SPEEDS_MM_S = (10.0, 50.0)
"""Of the two presses: by drawn pucks both show terms from 0.01 s on (benchmarks/accuracy/puck_batches.py); at 0.5 mm/s
terms of 0.02 s are hidden."""
DEPTH_SHARE, HOLD_S, RATE_HZ, REST_MIN = 0.3, 10.0, 1000.0, 5.0
PLATE_SHARE = 1.5
"""Least width of the plates over the puck's diameter: it bulges by a fifth at a compression of 30 %."""
BATCH = "my-batch"
"""Name that is proposed for a batch that is measured."""


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


def trace_names(tag: str, number: int = 1, count: int = 1) -> tuple[str, ...]:
    """Files of the two presses of a puck."""
    puck = f"puck{tag}" if count == 1 else f"puck{tag}-{number}"
    return tuple(f"{puck}-v{speed:g}.csv" for speed in SPEEDS_MM_S)


def command(
    names: Sequence[str], diameter: str, height: str, ratio: float, resin: str, name: str = BATCH, mass: str = ""
) -> str:
    """What is typed when the presses are saved, with the weighed mass where there is one."""
    return (
        f"dummydesign resins add-compression {' '.join(names)} --diameter {diameter} --height {height} "
        f"{f'--mass {mass} ' if mass else ''}--friction lubricated --name {name} --ratio {ratio:.6g} --resin {resin}"
    )


def press_rows(names: Sequence[str], height_mm: float) -> list[tuple[str, ...]]:
    """Table of the presses of a puck; the first row is the head."""
    head = ("file to save", "speed, mm/s", "compress by, mm", "hold, s", "samples a second")
    depth = DEPTH_SHARE * height_mm
    return [
        head,
        *(
            (name, f"{speed:g}", f"{depth:.1f} ({100 * DEPTH_SHARE:.0f} %)", f"{HOLD_S:g}", f"{RATE_HZ:g}")
            for name, speed in zip(names, SPEEDS_MM_S)
        ),
    ]


def protocol_steps(diameter_mm: float, age_days: float, mark: str = "") -> tuple[str, ...]:
    """The work from the cured puck to its traces, in order."""
    return (
        f"Wait {age_days:g} days{mark} after the cure. Test at room temperature, on one day with the pad if there is "
        "one.",
        "Measure diameter and height again on this day; the command needs what was measured, not what was planned.",
        f"Use two flat, stiff, parallel plates at least {PLATE_SHARE * diameter_mm:.0f} mm wide. Wipe the puck dry. "
        "Spread a fresh film of silicone oil on both plates (on a silicone puck: glycerine). Or glue both faces to the "
        "plates and type --friction bonded.",
        "Centre the puck. Zero the force with the upper plate free. Start recording about 1 mm above the "
        "puck; displacement is 0 where the plate touches it.",
        "Press at the speeds of the table to one depth, stop, hold the position (not the force), then lift off. "
        "If the machine is slower, use its fastest speed: the command says which terms it hides.",
        f"Renew the film and rest the puck {REST_MIN:g} minutes between the presses.",
        "Save each press as CSV with columns time_s, displacement_mm, force_N (compression positive), not filtered. "
        "Other machine files: dummydesign import.",
    )
