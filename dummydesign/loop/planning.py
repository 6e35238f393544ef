"""The next measurement as a campaign to press, with the target depth or force of each press."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import write_text
from dummydesign.core.progress import Progress, quiet
from dummydesign.core.serialise import Serialised
from dummydesign.core.user_library import toml_table
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.inference.noise import Noise
from dummydesign.loop.data.trials import Presses, make_presses, planned_trace
from dummydesign.loop.effects.registry import known_effects
from dummydesign.loop.fitting.candidates import change_by, project, starts_of
from dummydesign.loop.fitting.fit import fit_at, start_vector
from dummydesign.loop.fitting.noise import NoiseSizes
from dummydesign.loop.fitting.problem import CampaignProblem
from dummydesign.loop.model.campaign_law import CampaignLaw, law_without_solve, pad_of
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.forward_model import simulate
from dummydesign.loop.model.material import Material, material_of
from dummydesign.loop.next_measurement import HOLD_S, LUBRICATED, PossiblePress, options, planned_presses
from dummydesign.loop.result import LoopResult
from dummydesign.measurement.campaign import Campaign, Trial
from dummydesign.measurement.campaign_plan import Planned
from dummydesign.measurement.motion import DECELERATION_MM_S2, Motion, contact_velocity, ramp_and_hold
from dummydesign.pad.force_law import ForceCurve
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.predict import depth_for_steady_force, motion_on_curve

LEAST_HOLD_S = 1e-3


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
            f"expected_{name}_{unit}": self.value,
            f"expected_{name}_low_{unit}": self.low,
            f"expected_{name}_high_{unit}": self.high,
            "depth_limit_mm": self.limit_mm,
            "beyond_depth_limit": self.beyond,
            "may_go_beyond_depth_limit": self.may_go_beyond,
        }


def expected_presses(
    plan: tuple[Planned, ...], campaign: Campaign, material: Material, progress: Progress = quiet
) -> tuple[Expected, ...]:
    """Work out depth or steady force of every planned press."""
    made = (1e-3 * material.young_kPa.value, campaign.pad.geometry, material.prony)
    curves = {h: _curve(pad_of(campaign, h, *made), progress) for h in sorted({row.thickness_mm for row in plan})}
    keys = [(row.thickness_mm, row.velocity_mm_s, row.target, row.hold_s) for row in plan]
    # repeats are expected to reach the same
    one_of_each = dict(zip(keys, plan))
    expected = {key: _expected(row, *curves[row.thickness_mm], material) for key, row in one_of_each.items()}
    return tuple(expected[key] for key in keys)


def at_reached_speed(row: Planned, expected: Expected) -> Planned:
    """The press at the speed that a robot reaches which brakes to a stop at the expected depth, cut to 0.1 mm/s."""
    depth = (row.target if row.by_depth else expected.value) or math.inf
    touch = float(contact_velocity(row.velocity_mm_s, depth, DECELERATION_MM_S2))
    return replace(row, velocity_mm_s=math.floor(10.0 * touch) / 10.0) if touch < row.velocity_mm_s else row


def _curve(pad: Pad | Puck, progress: Progress) -> tuple[Pad | Puck, ForceCurve]:
    """Long-term force of a pad by its table, else solved."""
    try:
        return pad, elastic_curve(pad, "table")
    except InputError:
        progress(f"depths of the presses: solving the pad of {pad.thickness_mm:g} mm")
        return pad, elastic_curve(pad, "axisymmetric")


def _expected(row: Planned, pad: Pad | Puck, curve: ForceCurve, material: Material) -> Expected:
    hold = max(row.hold_s, LEAST_HOLD_S)

    def motion_to(depth: float) -> Motion:
        return ramp_and_hold(row.velocity_mm_s, depth, hold)

    def depth_at(force: float) -> float | None:
        try:
            return depth_for_steady_force(pad, force, hold, motion_to, curve=curve)
        except NoAnswerError:
            return None
        except InputError:
            # Too small a force to differ from first touch.
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
    pad: Pad | Puck, curve: ForceCurve, motion_to: Callable[[float], Motion], depth_mm: float, material: Material
) -> tuple[float, float]:
    """Ends of the steady force's interval over its value: the modulus' and the law's, joined."""
    moved = motion_on_curve(pad, motion_to(depth_mm), curve)
    law = moved.force_low_N[-1] / moved.steady_force_N, moved.force_high_N[-1] / moved.steady_force_N
    modulus = (end / material.young_kPa.value for end in (material.young_kPa.low, material.young_kPa.high))
    below, above = (math.hypot(math.log(max(a, 1e-3)), math.log(max(b, 1e-3))) for a, b in zip(law, modulus))
    return math.exp(-below), math.exp(above)


REPEATS, ORDER_SEED = 3, 0
DEEP, MOST = 0.3, 4  # depth over thickness of presses of new pads, and how many of them are planned
CAMPAIGN, SHEET = "campaign.toml", "sheet.csv"


@dataclass(frozen=True)
class PlannedPress:
    """One press to make."""

    file: str
    option: PossiblePress
    repeat: int
    sequence: int
    target_force_N: float


def plan_of(result: LoopResult, repeats: int = REPEATS) -> tuple[PlannedPress, ...]:
    """The presses of the next measurement: the best one and its alternatives, repeated, in random order."""
    fit = result.after.fit
    chosen = list(result.next.options) if result.next is not None else _of_new_pads(result.presses, fit.problem.law)
    # plates are of a campaign: lubricated ones need one of their own
    chosen = [option for option in chosen if option.circumstance != LUBRICATED]
    planned = planned_presses(result.presses, None, chosen)
    forces = simulate(planned, fit.problem.law, fit.base, fit.active)
    held = [
        float(np.interp(end, time, force)) for end, time, force in zip(planned.hold_end_s - 0.1, planned.time_s, forces)
    ]
    out = []
    for sequence, index in enumerate(np.random.default_rng(ORDER_SEED).permutation(repeats * len(chosen)).tolist(), 1):
        before, number = divmod(index, len(chosen))
        option, repeat = chosen[number], before + 1
        name = f"press_{sequence:02d}_t{option.thickness_mm:g}_v{option.velocity_mm_s:g}_r{repeat}.csv"
        out.append(PlannedPress(name, option, repeat, sequence, held[number]))
    return tuple(out)


def _of_new_pads(presses: Presses, law: SetupLaw) -> list[PossiblePress]:
    """Deep presses of pads that were not pressed yet, slow and fast; of the known ones where no others are in reach."""
    plain = [one for one in options(presses, law) if not one.circumstance and one.depth_share == DEEP]
    speeds = {min(one.velocity_mm_s for one in plain), max(one.velocity_mm_s for one in plain)}
    fit = [one for one in plain if one.velocity_mm_s in speeds]
    return ([one for one in fit if not one.known] or fit)[:MOST]


def write_plan(folder: str | Path, campaign: Campaign, presses: tuple[PlannedPress, ...]) -> dict[str, str]:
    """Write a campaign that is still to be pressed."""
    folder = Path(folder)
    toml = write_text(folder / CAMPAIGN, _toml(campaign, presses))
    sheet = write_text(folder / SHEET, _sheet(presses))
    return {"plan_campaign": str(toml), "plan_sheet": str(sheet)}


def _toml(campaign: Campaign, presses: tuple[PlannedPress, ...]) -> str:
    pad, punch, low = campaign.pad, campaign.punch, campaign.lowpass
    content: dict[str, Any] = {
        "schema": 1,
        "name": f"{campaign.name}, next",
        "pad": _known(
            young_kPa_nominal=pad.young_kPa_nominal,
            resin=pad.resin,
            ratio=pad.ratio,
            shape=pad.shape if pad.shape == "cylinder" else str(pad.geometry),
            length_mm=pad.length_mm,
            width_mm=pad.width_mm,
            diameter_mm=pad.diameter_mm,
            base=pad.base,
        ),
        "punch": _known(
            shape=punch.shape,
            side_mm=punch.side_mm,
            diameter_mm=punch.diameter_mm,
            contact=punch.contact,
            edge_radius_mm=punch.edge_radius_mm or None,
        ),
        "sensor": _known(
            lowpass_hz=low and low.cutoff_hz,
            lowpass_order=low and low.order,
            lowpass_passes=low and low.passes,
            force_resolution_N=campaign.force_resolution_N or None,
        ),
        "trial": [_trial(press, pad.geometry) for press in presses],
    }
    notes = [f"{press.file}: {press.option.text}" for press in presses]
    if punch.shape == "profile":
        notes.insert(0, "copy the profile of the punch into this folder and write file = NAME under [punch]")
    return "".join(f"# {note}\n" for note in notes) + toml_table(content)


def _trial(press: PlannedPress, usual: PadShape) -> dict[str, Any]:
    option = press.option
    return _known(
        file=press.file,
        thickness_mm=option.thickness_mm,
        shape=None if option.geometry == usual else str(option.geometry),
        velocity_mm_s=option.velocity_mm_s,
        hold_s=HOLD_S,
        target_force_N=round(press.target_force_N, 2),
        repeat=press.repeat,
        sequence=press.sequence,
        rest_s=option.rest_s,
        temperature_C=None if option.temperature_C is None else round(option.temperature_C, 1),
        age_days=None if option.age_days is None else round(option.age_days, 1),
    )


def _known(**values: object) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None}


def _sheet(presses: tuple[PlannedPress, ...]) -> str:
    head = "sequence,file,pad_mm,shape,velocity_mm_s,depth_mm,expected_force_N,hold_s,way_back,rest_before_s,done"
    rows = [
        (
            str(press.sequence),
            press.file,
            f"{press.option.thickness_mm:g}",
            f'"{press.option.geometry}"',
            f"{press.option.velocity_mm_s:g}",
            f"{press.option.depth_share * press.option.thickness_mm:.3g}",
            f"{press.target_force_N:.3g}",
            f"{HOLD_S:g}",
            "record" if press.option.unloading else "",
            f"{press.option.rest_s:g}",
            "",
        )
        for press in presses
    ]
    return "\n".join([head, *(",".join(row) for row in rows)]) + "\n"


NOISE = Noise(0.03, 0.02, 1.0, 0.02)
"""White and slow noise of the force, its time, scatter of the contact: those of the blind study. [N, N, s, mm]"""
SEEN = 6.0  # standard deviations from which an effect of its usual size is called visible: evidence of about 36
ALIKE = 0.95  # cosine between two effects from which they are called alike


@dataclass(frozen=True)
class PlanPower(Serialised):
    """Effects that are visible, hidden or not testable, and pairs that look alike.

    ``seen`` and ``hidden`` give the standard deviations at usual size, ``alike`` two ``effects`` and their ``cosine``.
    """

    seen: dict[str, float]
    hidden: dict[str, float]
    untested: dict[str, str]
    alike: tuple[dict[str, Any], ...]


@one_blas_thread()
def plan_power(plan: tuple[Planned, ...], campaign: Campaign, young_MPa: float, seed: int = 1) -> PlanPower:
    """Work out what a plan can see."""
    geometry, heights = campaign.pad.geometry, sorted({row.thickness_mm for row in plan})
    law = law_without_solve(pad_of(campaign, h, 1.0, geometry) for h in heights)
    trials = planned_trials(plan, law, young_MPa, np.random.default_rng(seed))
    presses = make_presses(replace(campaign, trials=trials))
    problem = CampaignProblem(presses, law, prior=material_of(campaign).prior)
    usual = NoiseSizes(NOISE, tuple(median for median, _ in law.error_priors))
    vector = start_vector(problem, young_MPa)
    fit = fit_at(problem, vector, usual)
    projection = project(fit)
    effects = [one for one in known_effects() if not one.seen_raw]
    untested = {one.name: reason for one in effects if (reason := one.unavailable(presses, law))}
    # what each adds in its usual size, beyond base and law error
    changes = {
        one.name: projection.remove(projection.column(change_by(fit, one, starts_of(one)[0])))
        for one in effects
        if one.name not in untested
    }
    sizes = {name: float(np.linalg.norm(change)) for name, change in changes.items()}
    seen = {name: size for name, size in sizes.items() if size >= SEEN}
    hidden = {name: size for name, size in sizes.items() if size < SEEN}
    units = {name: changes[name] / size for name, size in seen.items()}
    cosines = {(a, b): abs(float(units[a] @ units[b])) for a, b in combinations(units, 2)}
    alike = tuple({"effects": pair, "cosine": cosine} for pair, cosine in cosines.items() if cosine >= ALIKE)
    return PlanPower(seen, hidden, untested, alike)


def planned_trials(
    plan: tuple[Planned, ...], law: CampaignLaw, young_MPa: float, draw: np.random.Generator
) -> tuple[Trial, ...]:
    """Trials of a plan with the motion that is to be made and no force."""
    trials = []
    for row in plan:
        depth = row.target if row.by_depth else depth_for(law, row.thickness_mm, row.target / young_MPa)
        trace = planned_trace(row.file, row.velocity_mm_s, depth, row.hold_s, row.unload)
        trials.append(
            Trial(
                row.file,
                row.thickness_mm,
                row.velocity_mm_s,
                row.hold_s,
                None if row.by_depth else row.target,
                row.repeat,
                row.sequence,
                row.rest_s,
                float(draw.uniform(20.0, 27.0)),
                row.age_days,
                trace,
            )
        )
    return tuple(trials)


def depth_for(law: CampaignLaw, thickness_mm: float, force_over_young_mm2: float) -> float:
    """Depth at which a slab or puck carries a force, at most what the force law knows. [mm]"""
    own = law.law_of(("", thickness_mm))
    depths = np.linspace(0.0, 0.98 * own.limit_mm, 200)
    force = own(depths[None], np.array([[thickness_mm]]))[0]
    return float(np.interp(force_over_young_mm2, force, depths))
