"""Depth of each planned press that has a force, force of each that has a depth: for machines that control either.

The nominal modulus and relaxation give the value. Its interval (95 %) joins that of the modulus and the stated error of
the force law, as factors on the force, by the root of the sum of their squared logarithms.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.measurement.campaign import Campaign
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.measurement.planning.plan import Planned
from dummydesign.pad.curve import ElasticCurve
from dummydesign.pad.elastic import elastic_curve
from dummydesign.pad.pad import Pad, Puck
from dummydesign.pad.predict import depth_for_steady_force, motion_on_curve

if TYPE_CHECKING:
    from dummydesign.pad.material.relaxation import PronyTerm

DECELERATION_MM_S2 = 30000.0
"""Braking at the end of the ramp, as ``predict`` has it. [mm/s2]"""
LEAST_HOLD_S = 1e-3
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Material:
    """Long-term modulus with its 95 % interval and the relaxation; ``source`` says where they come from. [kPa]"""

    young_kPa: float
    low_kPa: float
    high_kPa: float
    prony: tuple[PronyTerm, ...]
    source: str

    def to_dict(self) -> dict[str, Any]:
        """Return plain values."""
        young = {"value": self.young_kPa, "low": self.low_kPa, "high": self.high_kPa}
        return {"young_kPa": young, "prony": [term.to_dict() for term in self.prony], "source": self.source}


@dataclass(frozen=True)
class Expected:
    """What a press is expected to reach: depth [mm] of a planned force, steady force [N] of a planned depth.

    None where the pad is not modelled: deeper than ``limit_mm``. ``beyond`` says that the press itself goes there,
    ``may_go_beyond`` that only the end of its interval does.
    """

    value: float | None
    low: float | None
    high: float | None
    by_depth: bool
    limit_mm: float
    beyond: bool
    may_go_beyond: bool

    def to_dict(self) -> dict[str, Any]:
        """Return plain values, by the names of the quantity."""
        name, unit = ("force", "N") if self.by_depth else ("depth", "mm")
        return {
            f"expected_{name}_{unit}": self.value, f"expected_{name}_low_{unit}": self.low,
            f"expected_{name}_high_{unit}": self.high, "depth_limit_mm": self.limit_mm,
            "beyond_depth_limit": self.beyond, "may_go_beyond_depth_limit": self.may_go_beyond,
        }  # fmt: skip


def material_of(campaign: Campaign) -> Material:
    """Return the nominal modulus and relaxation of a campaign's pads.

    Raises
    ------
    InputError
        When no modulus is known.
    """
    from dummydesign.loop.model.expected import start_young_kPa

    pad, value = campaign.pad, start_young_kPa(campaign)
    if pad.resin is None or pad.ratio is None:
        return Material(value, value, value, (), "given, no interval known")
    from dummydesign.resin import load_resin

    resin = load_resin(pad.resin)
    resin.check_ratio(pad.ratio)
    prony = resin.prony(pad.ratio)
    if pad.young_kPa_nominal is not None:
        return Material(value, value, value, prony, f"given, no interval known; relaxation of {resin.name}")
    modulus = resin.modulus_kPa(pad.ratio)
    return Material(value, modulus.low, modulus.high, prony, modulus.source)


def expected_presses(
    plan: tuple[Planned, ...], campaign: Campaign, material: Material, progress: Progress | None = None
) -> tuple[Expected, ...]:
    """Work out depth or steady force of every planned press.

    Parameters
    ----------
    plan : tuple of Planned
        The presses.
    campaign : Campaign
        Its pad and punch; without trials.
    material : Material
        Of the pads.
    progress : callable, optional
        Called with a line for each pad that has to be solved.

    Returns
    -------
    tuple of Expected
        In the order of the plan.

    Raises
    ------
    InputError, NoAnswerError
        When a pad has no force law.
    """
    curves = {h: _curve(_pad(campaign, h, material), progress) for h in sorted({row.thickness_mm for row in plan})}
    found: dict[tuple[float, float, float, float], Expected] = {}
    for row in plan:
        key = (row.thickness_mm, row.velocity_mm_s, row.target, row.hold_s)
        if key not in found:
            found[key] = _expected(row, *curves[row.thickness_mm], material)
    return tuple(found[row.thickness_mm, row.velocity_mm_s, row.target, row.hold_s] for row in plan)


def _pad(campaign: Campaign, thickness_mm: float, material: Material) -> Pad | Puck:
    """The pad as ``predict`` makes it of the same words."""
    pad, punch, young = campaign.pad, campaign.punch, 1e-3 * material.young_kPa
    if pad.shape == "cylinder":
        return Puck(thickness_mm, young, float(pad.diameter_mm or 0.0), material.prony, punch.contact)
    size = (pad.length_mm, pad.width_mm) if pad.length_mm and pad.width_mm else None
    return Pad(
        thickness_mm, young, punch.radius_mm, prony=material.prony, base=pad.base, condition=punch.contact,
        extent_mm=math.sqrt(size[0] * size[1] / math.pi) if size else None,
        sides_mm=(punch.side_mm, punch.side_mm) if punch.side_mm else None, profile_mm=punch.profile_mm,
        geometry=pad.geometry, edge_radius_mm=punch.edge_radius_mm, **({"slab_mm": size} if size else {}),
    )  # fmt: skip


def _curve(pad: Pad | Puck, progress: Progress | None) -> tuple[Pad | Puck, ElasticCurve]:
    """Long-term force of a pad by its table, else solved."""
    try:
        return pad, elastic_curve(pad, "table", None, None, None)
    except InputError:
        if progress is not None:
            progress(f"depths of the presses: solving the pad of {pad.thickness_mm:g} mm")
        return pad, elastic_curve(pad, "axisymmetric", None, None, None)


def _expected(row: Planned, pad: Pad | Puck, curve: ElasticCurve, material: Material) -> Expected:
    hold = max(row.hold_s, LEAST_HOLD_S)

    def motion_to(depth: float) -> Motion:
        return ramp_and_hold(row.velocity_mm_s, depth, hold, DECELERATION_MM_S2)

    def depth_at(force: float) -> float | None:
        try:
            return depth_for_steady_force(pad, force, hold, motion_to, curve=curve)
        except NoAnswerError:
            return None
        except InputError:
            # Too small a force to be told from first touch.
            return 0.0

    limit = min(curve.limit_mm, MAX_DEPTH_OVER_THICKNESS * pad.thickness_mm)
    depth = row.target if row.by_depth else depth_at(row.target)
    if depth is None or depth > limit * (1.0 + 1e-9):
        low = None if row.by_depth else depth_at(row.target / _factors(pad, curve, motion_to, limit, material)[1])
        return Expected(None, low, None, row.by_depth, limit, True, True)
    if depth <= 0.0:
        return Expected(0.0, 0.0, depth_at(row.target), row.by_depth, limit, False, False)
    below, above = _factors(pad, curve, motion_to, depth, material)
    if row.by_depth:
        force = motion_on_curve(pad, motion_to(depth), curve).steady_force_N
        return Expected(force, force * below, force * above, True, limit, False, False)
    high = depth_at(row.target / below)
    return Expected(depth, depth_at(row.target / above), high, False, limit, False, high is None)


def _factors(
    pad: Pad | Puck, curve: ElasticCurve, motion_to: Callable[[float], Motion], depth_mm: float, material: Material
) -> tuple[float, float]:
    """Ends of the steady force's interval over its value: the modulus' and the law's, joined."""
    moved = motion_on_curve(pad, motion_to(depth_mm), curve)
    law = moved.force_low_N[-1] / moved.steady_force_N, moved.force_high_N[-1] / moved.steady_force_N
    modulus = material.low_kPa / material.young_kPa, material.high_kPa / material.young_kPa
    below, above = (math.hypot(math.log(max(a, 1e-3)), math.log(max(b, 1e-3))) for a, b in zip(law, modulus))
    return math.exp(-below), math.exp(above)
