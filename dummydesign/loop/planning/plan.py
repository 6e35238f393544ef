"""The next measurement as a campaign to press: campaign.toml and a sheet, in random order, with repeats."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dummydesign.core.files import write_text
from dummydesign.loop.data.trials import Presses
from dummydesign.loop.model.base_law import SetupLaw
from dummydesign.loop.model.forward_model import simulate
from dummydesign.loop.next_measurement import HOLD_S, Option, options, planned_presses
from dummydesign.loop.result import LoopResult
from dummydesign.measurement.campaign import Campaign

REPEATS, ORDER_SEED = 3, 0
DEEP, MOST = 0.3, 4
"""Depth over thickness of presses of new pads, and how many of them are planned."""
CAMPAIGN, SHEET = "campaign.toml", "sheet.csv"


@dataclass(frozen=True)
class PlannedPress:
    """One press to make.

    Attributes
    ----------
    file : str
        Name under which its trace is to be saved.
    option : Option
        Pad, speed, depth and circumstances.
    repeat, sequence : int
    target_force_N : float
        Force that the corrected model expects at the end of the hold. [N]
    """

    file: str
    option: Option
    repeat: int
    sequence: int
    target_force_N: float


def plan_of(result: LoopResult, repeats: int = REPEATS) -> tuple[PlannedPress, ...]:
    """The presses of the next measurement: the best one and its alternatives, repeated, in random order.

    Parameters
    ----------
    result : LoopResult
    repeats : int
        How often each is pressed.

    Returns
    -------
    tuple of PlannedPress
        Where no two explanations are left to be told apart, presses of new pads: the modulus is known no better than
        the number of pads lets it.
    """
    fit = result.after.fit
    chosen = list(result.next.options) if result.next is not None else _of_new_pads(result.presses, fit.problem.law)
    planned = planned_presses(result.presses, None, chosen)
    forces = simulate(planned, fit.problem.law, fit.base, fit.active)
    held = [float(np.interp(end, time, force))
            for end, time, force in zip(planned.hold_end_s - 0.1, planned.time_s, forces)]  # fmt: skip
    runs = [(place, repeat) for repeat in range(1, repeats + 1) for place in range(len(chosen))]
    order = np.random.default_rng(ORDER_SEED).permutation(len(runs))
    out = []
    for sequence, index in enumerate(order, 1):
        place, repeat = runs[index]
        option = chosen[place]
        name = f"press_{sequence:02d}_t{option.thickness_mm:g}_v{option.velocity_mm_s:g}_r{repeat}.csv"
        out.append(PlannedPress(name, option, repeat, sequence, held[place]))
    return tuple(out)


def _of_new_pads(presses: Presses, law: SetupLaw) -> list[Option]:
    """Deep presses of pads that were not pressed yet, slow and fast; of the known ones where no others are in reach."""
    plain = [one for one in options(presses, law) if not one.circumstance and one.depth_share == DEEP]
    speeds = {min(one.velocity_mm_s for one in plain), max(one.velocity_mm_s for one in plain)}
    fit = [one for one in plain if one.velocity_mm_s in speeds]
    return ([one for one in fit if not one.known] or fit)[:MOST]


def write_plan(folder: str | Path, campaign: Campaign, presses: tuple[PlannedPress, ...]) -> dict[str, str]:
    """Write a campaign that is still to be pressed.

    Parameters
    ----------
    folder : path
        Existing folder.
    campaign : Campaign
        The campaign before it: pad, punch and sensor are the same.
    presses : tuple of PlannedPress
        In the order of their sequence.

    Returns
    -------
    dict
        Paths by role: ``plan_campaign``, ``plan_sheet``.
    """
    folder = Path(folder)
    toml = write_text(folder / CAMPAIGN, _toml(campaign, presses))
    sheet = write_text(folder / SHEET, _sheet(presses))
    return {"plan_campaign": str(toml), "plan_sheet": str(sheet)}


def _toml(campaign: Campaign, presses: tuple[PlannedPress, ...]) -> str:
    pad, punch, lowpass = campaign.pad, campaign.punch, campaign.lowpass
    shape = pad.shape if pad.shape == "cylinder" else str(pad.geometry)
    lines = ["schema = 1", f'name = "{campaign.name}, next"', "", "[pad]"]
    lines += _given(
        young_kPa_nominal=pad.young_kPa_nominal, resin=pad.resin, ratio=pad.ratio, shape=shape,
        length_mm=pad.length_mm, width_mm=pad.width_mm, diameter_mm=pad.diameter_mm, base=pad.base,
    )  # fmt: skip
    lines += ["", "[punch]"]
    lines += _given(shape=punch.shape, side_mm=punch.side_mm, diameter_mm=punch.diameter_mm, contact=punch.contact,
                    edge_radius_mm=punch.edge_radius_mm or None)  # fmt: skip
    if punch.shape == "profile":
        lines.append("# file = the profile of the punch: copy it into this folder and name it here")
    lines += ["", "[sensor]"]
    if lowpass is not None:
        lines += _given(
            lowpass_hz=lowpass.cutoff_hz, lowpass_order=lowpass.order, lowpass_passes=lowpass.passes
        )
    lines += _given(force_resolution_N=campaign.force_resolution_N or None)
    for press in presses:
        option = press.option
        own = None if option.geometry == pad.geometry else str(option.geometry)
        lines += ["", "[[trial]]"]
        lines += _given(
            file=press.file, thickness_mm=option.thickness_mm, shape=own, velocity_mm_s=option.velocity_mm_s,
            hold_s=HOLD_S, target_force_N=round(press.target_force_N, 2), repeat=press.repeat,
            sequence=press.sequence, rest_s=option.rest_s,
            temperature_C=None if option.temperature_C is None else round(option.temperature_C, 1),
            age_days=None if option.age_days is None else round(option.age_days, 1),
        )  # fmt: skip
        lines.append(f"# {option.text}")
    return "\n".join(lines) + "\n"


def _given(**values: object) -> list[str]:
    return [
        f'{key} = "{value}"' if isinstance(value, str) else f"{key} = {value}"
        for key, value in values.items()
        if value is not None
    ]


def _sheet(presses: tuple[PlannedPress, ...]) -> str:
    head = "sequence,file,pad_mm,shape,velocity_mm_s,depth_mm,expected_force_N,hold_s,way_back,rest_before_s,done"
    rows = []
    for press in presses:
        option = press.option
        cells = (
            str(press.sequence), press.file, f"{option.thickness_mm:g}", f'"{option.geometry}"',
            f"{option.velocity_mm_s:g}", f"{option.depth_share * option.thickness_mm:.3g}",
            f"{press.target_force_N:.3g}", f"{HOLD_S:g}", "record" if option.unloading else "",
            f"{option.rest_s:g}", "",
        )  # fmt: skip
        rows.append(",".join(cells))
    return "\n".join([head, *rows]) + "\n"
