"""Checks of a campaign: what the traces say against what was declared of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.interface import BASES, CONDITIONS, Interface
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import LARGEST_EDGE_RADIUS
from dummydesign.measurement.campaign import PadSpec, PunchSpec, Trial
from dummydesign.measurement.campaign_lines import CampaignLines
from dummydesign.measurement.landmarks import find_ramp


def check_against_declared(trial: Trial, index: int, place: CampaignLines) -> None:
    """Refuse magnitudes that can only be another unit, seen against the declared thickness, speed and force.

    Parameters
    ----------
    trial : Trial
        With its trace.
    index : int
        Its place in the campaign file, from 0.
    place : CampaignLines
        Gives the line of an entry, for the message.

    Raises
    ------
    InputError
        Naming the file, what it holds, what is declared, and the unit it looks like.
    """
    trace = trial.trace
    try:
        ramp = find_ramp(trace.time_s, trace.displacement_mm, "slowed")
    except InputError as problem:
        raise InputError(f"{trial.file}: {problem}") from None
    deepest = float(trace.displacement_mm.max())
    if deepest >= 0.95 * trial.thickness_mm:
        raise InputError(
            f"{place.trial(index, 'thickness_mm')}: {trial.file} presses {deepest:g} mm into a pad of "
            f"{trial.thickness_mm:g} mm; is displacement_mm or thickness_mm in another unit?"
        )
    if trial.target_force_N:
        late = trace.time_s >= ramp.hold_end_s - 0.2 * (ramp.hold_end_s - ramp.stop_time_s)
        held = float(np.median(trace.force_N[late & (trace.time_s <= ramp.hold_end_s)]))
        share = held / trial.target_force_N
        if share > 100 or share < 0.01:
            unit = "millinewtons: --units force=mN" if share > 100 else "kilonewtons: --units force=kN"
            raise InputError(
                f"{trial.file}: force_N is {held:g} in the hold, the target at {place.trial(index, 'target_force_N')} "
                f"is {trial.target_force_N:g} N; it looks like {unit} of 'dummydesign import' reads them"
            )
    ratio = ramp.velocity_mm_s / trial.velocity_mm_s
    if not 0.02 < ratio < 20.0:
        raise InputError(
            f"{place.trial(index, 'velocity_mm_s')}: velocity_mm_s = {trial.velocity_mm_s:g}, but {trial.file} moves "
            f"at {ramp.velocity_mm_s:.4g} mm/s; is the speed in m/s, or the time of the trace in another unit "
            "(--units time=ms of 'dummydesign import' reads milliseconds)?"
        )


def check_edge(pad: PadSpec, punch: PunchSpec, shapes: Sequence[PadShape], where: str = "") -> None:
    """Refuse a fillet of the punch's edge that is too large, or where the force law with it is not solved.

    Parameters
    ----------
    pad : PadSpec
    punch : PunchSpec
    shapes : sequence of PadShape
        Of the pads that are pressed.
    where : str
        Begins the message.

    Raises
    ------
    InputError
    """
    edge = punch.edge_radius_mm
    if not edge:
        return
    width = {"square": punch.side_mm, "round": punch.diameter_mm}.get(punch.shape)
    if width is None:
        raise InputError(f"{where}edge_radius_mm = {edge:g}: a {punch.shape} has no edge")
    most = LARGEST_EDGE_RADIUS * 0.5 * width
    if not 0.0 < edge <= most * (1.0 + 1e-9):
        raise InputError(
            f"{where}edge_radius_mm = {edge:g} is outside the allowed range 0 to {most:.4g}, {LARGEST_EDGE_RADIUS:g} "
            "of the punch's half-width"
        )
    own = next((str(shape) for shape in shapes if not shape.plain), "")
    other = {
        "shape": own, "contact": "" if Interface.find(punch.contact, CONDITIONS) else punch.contact,
        "base": "" if pad.base in BASES else pad.base,
    }  # fmt: skip
    for name in filter(other.get, other):
        raise InputError(
            f"{where}edge_radius_mm = {edge:g} with {name} = {other[name]} is not solved; a fillet goes with a flat "
            "punch on slabs whose base is bonded or sliding: give 0 for the sharp edge"
        )


def check_set(
    trials: tuple[Trial, ...], blocks: list[dict[str, Any]], place: CampaignLines, warnings: list[dict[str, str]]
) -> None:
    """Checks over all trials: files and sequence numbers used twice, what is missing for some tests.

    Parameters
    ----------
    trials : tuple of Trial
        All trials of the campaign.
    blocks : list of dict
        What the file says of each, which shows what was left to defaults.
    place : CampaignLines
        Gives the line of an entry, for messages.
    warnings : list of {code, message}
        What is missing for some tests is appended.

    Raises
    ------
    InputError
        For a file or a sequence number that is used twice.
    """
    for what in ("file", "sequence"):
        seen: dict[Any, int] = {}
        for index, trial in enumerate(trials):
            value = getattr(trial, what)
            if value in seen and (what == "file" or what in blocks[index]):
                raise InputError(
                    f"{place.trial(index, what)}: {what} = {value!r} is already used by trial {seen[value] + 1}"
                )
            seen[value] = index

    def warn(code: str, message: str) -> None:
        warnings.append({"code": code, "message": message})

    if not any("sequence" in block for block in blocks):
        warn("no_sequence", "no sequence is given: the order of the file is taken as the order of the trials")
    for key in ("temperature_C", "age_days", "rest_s"):
        if any(getattr(trial, key) is None for trial in trials):
            warn(f"no_{key}", f"{key} is not given for every trial: effects that need it cannot be tested")
