"""What to weigh, in what cup, how level and how fast: the numbers of a pour sheet. No CAD."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, replace
from typing import Any

from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model import layout as dimensions
from dummydesign.mold.model.layout import BACKER_PLAY_MM, Outline, layout
from dummydesign.mold.model.products import Machines
from dummydesign.mold.model.spec import MouldSpec, Pour

RATIO_ERROR_LIMIT_PERCENT = 0.5
CUP_FACTOR = 4.0
# Vents through the plate that carries a bone.
CARRIER_VENTS, CARRIER_VENT_MM = 4, 3.0


@dataclass(frozen=True)
class PourPlan:
    """Weights and limits of one pour; ``components`` are (name, mass in g) as the balance shows them.

    ``weighed_ratio`` is the mixing ratio that these weights make, None where the ratio's component is not known.
    ``cavity_mm3`` is the resin of one pad in this pour, ``pad_mass_g`` and ``fill_mass_g`` are those of one cavity, the
    batch is for all cavities of the mould. ``base`` is the second pour of a layered pad. Of a closed mould that is
    heated ``riser_mm3`` stands over the lid: it feeds what the cavity gains over the resin, ``riser_mm`` high in rings
    on the backer (0 where the backer's holes hold it).
    """

    cavity_mm3: float
    pad_mass_g: float
    batch_mass_g: float
    components: tuple[tuple[str, float], ...]
    ratio_error_percent: float
    batch_for_ratio_g: float
    cup_mm3: float
    fill_mass_g: float
    gram_per_mm_g: float
    silicone_mass_g: float
    lid_silicone_mass_g: float
    mould_mass_g: float
    level_deg: float
    level_mm: float
    meniscus_mm: float
    meniscus_mm3: float
    wall_deflection_mm: float
    thermal_growth_mm: float
    collar_mm: float
    pour_time_s: float
    riser_mm3: float = 0.0
    riser_mm: float = 0.0
    base: PourPlan | None = None
    weighed_ratio: float | None = None

    @property
    def cast_mass_g(self) -> float:
        """Mass of one pad, of a layered one both layers. [g]"""
        return self.pad_mass_g + (self.base.pad_mass_g if self.base else 0.0)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as plain values; components as {name, mass_g}; ``base`` only when there is one."""
        plain = {**asdict(self), "components": _named(self.components)}
        del plain["base"]
        return {**plain, "base": self.base.to_dict()} if self.base else plain


def _named(components: tuple[tuple[str, float], ...], volumes: tuple[float, ...] = ()) -> list[dict[str, Any]]:
    named: list[dict[str, Any]] = [{"name": name, "mass_g": mass} for name, mass in components]
    for one, volume in zip(named, volumes):
        one["volume_ml"] = round(volume, 2)
    return named


def split_batch(
    total_g: float, components: tuple[tuple[str, float], ...], resolution_g: float, most_g: float = math.inf
) -> tuple[tuple[tuple[str, float], ...], float]:
    """Split a batch into whole steps of the balance; return masses [g] and largest error of a component's share. [%]

    Of the totals from the batch up to one more step of the smallest component it takes the one whose shares come out
    best: rounding each component by itself would leave the smallest wrong by half a step. None is above ``most_g``.
    """
    digits = max(0, -math.floor(math.log10(resolution_g)))
    shares = [share for _, share in components]
    most = math.inf if math.isinf(most_g) else math.floor(most_g / resolution_g + 1e-9)
    first = int(min(math.ceil(total_g / resolution_g - 1e-9), most))
    last = int(min(first + math.ceil(1.0 / min(shares)), most))
    tried = [_in_steps(total, shares) for total in range(first, last + 1)]
    steps = min(tried, key=lambda one: (round(_share_error(one, shares), 12), sum(one)))
    masses = tuple((name, round(n * resolution_g, digits)) for (name, _), n in zip(components, steps))
    wanted = [share * sum(steps) for share in shares]
    return masses, 100 * max((abs(n - want) + 0.5) / want for n, want in zip(steps, wanted))


def _in_steps(total: int, shares: list[float]) -> list[int]:
    """A total split into whole steps: all but the largest share rounded, the largest takes the rest."""
    steps = [max(1, round(total * share)) for share in shares]
    largest = shares.index(max(shares))
    steps[largest] = max(1, total - sum(steps) + steps[largest])
    return steps


def _share_error(steps: list[int], shares: list[float]) -> float:
    """Largest relative error of a component's share."""
    return max(abs(n / (share * sum(steps)) - 1.0) for n, share in zip(steps, shares))


def weighed_ratio(pour: Pour, components: tuple[tuple[str, float], ...]) -> float | None:
    """Mixing ratio that masses make, in the resin's definition; None where its component is not known."""
    wanted, masses = dict(pour.components), dict(components)
    name = pour.ratio_component
    if name not in masses or len(masses) < 2:
        return None
    asked, made = (one[name] / (sum(one.values()) - one[name]) for one in (wanted, masses))
    if pour.ratio_per == "mix":
        to_others = pour.ratio / (100.0 - pour.ratio) * made / asked
        return 100.0 * to_others / (1.0 + to_others)
    return pour.ratio * made / asked


def volumes_ml(pour: Pour, components: tuple[tuple[str, float], ...]) -> tuple[float, ...]:
    """Volume of each weighed component of a resin by volume; empty for one by weight. [ml]"""
    return tuple(mass / density for (_, mass), density in zip(components, pour.component_densities_g_per_cm3))


def pour_plan(spec: MouldSpec) -> PourPlan:
    """Work out the pour, of a layered pad both."""
    plan, layers = layout(spec), spec.pad.shape.layers()
    resin = dimensions.resin_volume_mm3(spec)
    if spec.base is None or layers is None:
        film = spec.pad.least_gel_mm
        return _one_pour(spec, spec.pour, resin, above_fill_mm3(spec, spec.pour), plan.fill_outline, film)
    upper, _ = dimensions.layer_volumes_mm3(spec)
    base, left_mm = spec.base.pour, spec.pad.thickness_mm - layers[0]
    under = _one_pour(spec, base, resin - upper, above_fill_mm3(spec, base), plan.fill_outline, left_mm)
    # The spacer closes the first pour, so no meniscus stands over it.
    return replace(_one_pour(spec, spec.pour, upper, 0.0, plan.interface_outline, layers[0]), base=under)


def _one_pour(
    spec: MouldSpec, pour: Pour, resin_mm3: float, above_mm3: float, face: Outline, film_mm: float
) -> PourPlan:
    """Weights and limits of one resin.

    ``above_mm3`` stands over the pour's free face, whose outline is ``face``; ``film_mm`` has to level itself.
    """
    plan = layout(spec)
    density = pour.density_g_per_cm3 * 1e-3
    gained, riser_mm, held = _riser(spec, pour, resin_mm3)
    in_mould = density * (resin_mm3 + above_mm3 + held)
    wanted = spec.count * in_mould * (1 + pour.extra_percent / 100) + pour.film_loss_g
    resolution = spec.machines.balance_resolution_g
    components, error = split_batch(wanted, pour.components, resolution)
    batch = sum(mass for _, mass in components)
    long = max(spec.pad.length_mm, spec.pad.width_mm)
    level = formula.level_tolerance_deg(spec.pad.thickness_mm, long)
    mass_mould, mass_lid = (
        one(spec) * spec.tool.density_g_per_cm3 * 1e-3
        for one in (dimensions.mould_volume_mm3, dimensions.lid_volume_mm3)
    )
    mixed = 0.0 if spec.is_printed else 1 + pour.silicone_extra_percent / 100
    warmer = max(0.0, pour.cure_temperature_C - pour.room_temperature_C)
    return PourPlan(
        cavity_mm3=resin_mm3,
        pad_mass_g=density * (resin_mm3 + gained),
        batch_mass_g=round(batch, 6),
        components=components,
        ratio_error_percent=error,
        batch_for_ratio_g=batch_for_ratio_g(pour, resolution),
        cup_mm3=CUP_FACTOR * batch / density,
        fill_mass_g=in_mould,
        gram_per_mm_g=density * face.area_mm2,
        silicone_mass_g=mixed * mass_mould,
        lid_silicone_mass_g=mixed * mass_lid,
        mould_mass_g=mass_mould + mass_lid,
        level_deg=level,
        level_mm=formula.tilt_error_mm(long, level),
        meniscus_mm=formula.meniscus_height_mm(*_liquid(pour)),
        meniscus_mm3=_meniscus_mm3(spec, pour),
        wall_deflection_mm=formula.wall_deflection_mm(
            plan.depth_mm, spec.body.wall_mm, spec.tool.young_MPa or 0.0, pour.density_g_per_cm3
        ),
        thermal_growth_mm=plan.bottom.length_mm * (spec.tool.expansion_per_K or 0.0) * warmer,
        collar_mm=formula.collar_height_mm(plan.depth_mm, pour.foam_factor) if pour.degas == "mould" else 0.0,
        pour_time_s=spreading_time_s(spec, pour, film_mm),
        riser_mm3=gained,
        riser_mm=riser_mm,
        weighed_ratio=weighed_ratio(pour, components),
    )


def _liquid(pour: Pour) -> tuple[float, float, float]:
    return pour.surface_tension_N_per_m, pour.density_g_per_cm3, pour.contact_angle_deg


def _meniscus_mm3(spec: MouldSpec, pour: Pour) -> float:
    return formula.meniscus_volume_mm3(*_liquid(pour), layout(spec).fill_outline.perimeter_mm)


def above_fill_mm3(spec: MouldSpec, pour: Pour) -> float:
    """Resin over the fill plane: stems in a lid's funnels or the vents of a bone's carrier, else the meniscus. [mm3]"""
    if spec.pad.shape.bone_height_mm:
        high = spec.body.freeboard_mm + spec.aids.plate_mm
        return CARRIER_VENTS * math.pi / 4 * CARRIER_VENT_MM**2 * high
    if spec.closure is None:
        return _meniscus_mm3(spec, pour)
    return sum(one.volume_mm3(spec.closure.lid_mm) for one in layout(spec).funnels)


RISER_SPRUE_MM, RISER_VENT_MM, RISER_SPARE_MM = 20.0, 10.0, 5.0
"""Width inside of the rings on the backer around sprue and vents, and how much higher than the resin they are."""


def _riser(spec: MouldSpec, pour: Pour, resin_mm3: float) -> tuple[float, float, float]:
    """What a closed cavity gains over its resin until it is warm; height of the rings and all resin over the lid.

    All of it cold: [mm3], [mm], [mm3]. Sprue and vents are connected, so that the resin stands equally high in all. An
    open mould needs none: there the poured mass sets the height.
    """
    c, warmer = spec.closure, pour.cure_temperature_C - pour.room_temperature_C
    if c is None or warmer <= 0.0:
        return 0.0, 0.0, 0.0
    mould, resin = ((1 + one * warmer) ** 3 for one in (spec.tool.expansion_per_K or 0.0, pour.resin_expansion_per_K))
    gained = max(0.0, resin_mm3 * (mould / resin - 1.0))
    holes = sum(math.pi / 4 * (one.large_mm + BACKER_PLAY_MM) ** 2 for one in layout(spec).funnels) * c.backer_mm
    across = math.pi / 4 * (RISER_SPRUE_MM**2 + (len(layout(spec).funnels) - 1) * RISER_VENT_MM**2)
    left = max(0.0, gained - holes)
    return gained, left / across + RISER_SPARE_MM if left else 0.0, max(gained, holes)


def spreading_time_s(spec: MouldSpec, pour: Pour, film_mm: float) -> float:
    """Time in which a poured film levels itself over the pad, of the order given by thin-film flow. [s]

    A film of thickness h levels a slope of wavelength 2 L in tau = 3 mu / (rho g h^3 q^2), q = pi / L; three of
    them leave 5 %.

    References
    ----------
    Orchard, Appl. Sci. Res. A 11 (1963) 451 (lubrication theory; the gravity term alone).
    """
    pad = spec.pad
    wave = math.pi / (max(pad.length_mm, pad.width_mm) * 1e-3)
    weight = pour.density_g_per_cm3 * 1e3 * formula.GRAVITY_M_PER_S2
    return 3 * 3 * pour.viscosity_Pa_s / (weight * (film_mm * 1e-3) ** 3 * wave**2)


def least_film_mm(spec: MouldSpec) -> float:
    """Thinnest film that levels itself while the resin can be poured (:func:`spreading_time_s`). [mm]"""
    left_s = 60 * (spec.pour.pot_life_min - spec.pour.pour_and_degas_min)
    return float((spreading_time_s(spec, spec.pour, 1.0) / left_s) ** (1 / 3))


FILLED_SHARE, GRAM_PER_HOUR = 0.5, 18.0
"""Share of a printed part that is plastic: 4 perimeters and 15 % infill fill plates of 5 to 8 mm by about half
(judgement; a slicer knows better), and grams an hour of a 0.4 mm nozzle (judgement)."""
WITNESS_MM = 50.0, 30.0
"""Diameter and height of the witness puck."""


@dataclass(frozen=True)
class Mix:
    """What is weighed into one cup; ``error_percent`` is the largest error of a component's share. [g, %]

    ``ratio`` is the mixing ratio of these weights, None where the ratio's component is not known; ``volumes_ml`` are
    those of the components where the ratio is by volume.
    """

    components: tuple[tuple[str, float], ...]
    total_g: float
    error_percent: float
    ratio: float | None = None
    volumes_ml: tuple[float, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        return {
            "components": _named(self.components, self.volumes_ml),
            "total_g": self.total_g,
            "weighing_error_percent": self.error_percent,
            "ratio": self.ratio,
        }


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
    diameter, height = WITNESS_MM
    return math.pi / 4 * diameter**2 * height * pour.density_g_per_cm3 * 1e-3


def batch_for_ratio_g(pour: Pour, resolution_g: float) -> float:
    """Smallest batch that a balance weighs in the right ratio. [g]"""
    return resolution_g / (RATIO_ERROR_LIMIT_PERCENT / 100 * min(share for _, share in pour.components))


def batch_limits_g(pour: Pour, machines: Machines) -> tuple[int, float]:
    """Least batch, in whole grams, for the balance, and the most that foams in the vacuum chamber. [g]"""
    least = math.ceil(batch_for_ratio_g(pour, machines.balance_resolution_g) - 1e-9)
    if not pour.is_degassed:
        return least, math.inf
    cup_mm = min(machines.chamber_diameter_mm, machines.chamber_height_mm)
    most = math.pi / 4 * cup_mm**3 / CUP_FACTOR * pour.density_g_per_cm3 * 1e-3
    return min(least, math.floor(most)), most


def batch_of(spec: MouldSpec, pour: Pour, plan: PourPlan) -> Batch:
    """Work out the batch of one pour.

    It is the pour's own, raised to whole grams where the balance could not weigh that in the right ratio, but not
    above what foams in the vacuum chamber.
    """
    least, most = batch_limits_g(pour, spec.machines)
    own = Mix(
        plan.components,
        plan.batch_mass_g,
        plan.ratio_error_percent,
        plan.weighed_ratio,
        volumes_ml(pour, plan.components),
    )
    mix = own if plan.batch_mass_g >= least else mix_of(least, pour, spec.machines.balance_resolution_g, most)
    wanted = plan.batch_mass_g + (1 + pour.extra_percent / 100) * witness_mass_g(pour)
    both = mix if wanted <= mix.total_g else mix_of(wanted, pour, spec.machines.balance_resolution_g)
    poured = spec.count * plan.fill_mass_g
    return Batch(mix, poured, mix is not own, round(witness_mass_g(pour), 2), both)


def pours_of(spec: MouldSpec, plan: PourPlan) -> list[tuple[Pour, PourPlan]]:
    """Return the pours in their order: one, of a layered pad two."""
    base = [(spec.base.pour, plan.base)] if spec.base is not None and plan.base is not None else []
    return [(spec.pour, plan), *base]


def batches_of(spec: MouldSpec, plan: PourPlan) -> dict[str, Any]:
    """The batch of a mould in plain values; that of a layered pad's base as ``base``."""
    first, *base = (batch_of(spec, *one).to_dict() for one in pours_of(spec, plan))
    return {**first, "base": base[0]} if base else first


def mix_of(total_g: float, pour: Pour, resolution_g: float, most_g: float = math.inf) -> Mix:
    """What is weighed for so much of a resin, in steps of the balance."""
    components, error = split_batch(total_g, pour.components, resolution_g, most_g)
    return Mix(
        components,
        round(sum(mass for _, mass in components), 6),
        error,
        weighed_ratio(pour, components),
        volumes_ml(pour, components),
    )
