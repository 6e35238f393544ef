"""The force law of a campaign, how deep it reaches, and the modulus expected before a fit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.progress import Progress, quiet
from dummydesign.geometry.dimensions import MAX_DEPTH_OVER_THICKNESS, PAD_LENGTH_MM, PAD_WIDTH_MM
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.loop.data.trials import Presses, stack
from dummydesign.loop.model.base_law import PuckLaw, SlabLaw
from dummydesign.loop.model.campaign_force_law import (
    ROUGHNESS,
    THICKNESS_SLOPE,
    CampaignForceLaw,
    SolvedCurve,
    error_priors,
)
from dummydesign.loop.model.effect import SetupLaw
from dummydesign.loop.model.material import material_of
from dummydesign.measurement.campaign import Campaign, PunchSpec, Trial
from dummydesign.pad.force_source import has_square_factor
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.tables.slab import load_table

# A press may end so much deeper than its law: the last secant is good for that.
BEYOND = 1.02
LEAST_LEFT = 2


def limit_of(law: SetupLaw, trials: Sequence[Trial], thickness_mm: NDArray) -> NDArray:
    """Depth to which the law of each trial's pad holds, shape (T,). [mm]"""
    if isinstance(law, CampaignForceLaw):
        return law.limit_of(trials)
    return cast(SlabLaw | PuckLaw, law).limit(thickness_mm)


def within_reach(
    campaign: Campaign, presses: Presses, law: SetupLaw, least: int = LEAST_LEFT
) -> tuple[Campaign, Presses, str]:
    """A campaign without the presses that go deeper than their law."""
    limit = limit_of(law, presses.trials, presses.thickness_mm)
    deep = presses.depth_mm > BEYOND * limit
    if not deep.any():
        return campaign, presses, ""
    files = ", ".join(trial.file for trial, out in zip(presses.trials, deep) if out)
    depth, end = float(presses.depth_mm[deep].max()), float(np.min(limit[deep]))
    why = f"up to {depth:.3g} mm, where the force law of the pad is known to {end:.3g} mm"
    kept = tuple(trial for trial, out in zip(presses.trials, deep) if not out)
    if len(kept) < least:
        message = f"presses go deeper than can be modelled, {why}: {files}; press less deep, or a thicker pad"
        raise InputError(message, "out_of_range", "displacement_mm", depth, (0.0, end))
    own = replace(campaign, trials=kept)
    return own, stack(kept, campaign.lowpass), f"{int(deep.sum())} of {len(deep)} presses are left out, {why}: {files}"


ONE_PAD = 0.06
"""Thicknesses that differ by less than this share of them are on one solved curve, whose change is solved too."""
DEPTHS = (0.3, 0.45, MAX_DEPTH_OVER_THICKNESS)
"""Depths over thickness to which pads are solved: the first that covers what was pressed."""
MARGIN = 1.1


def law_of(campaign: Campaign, progress: Progress = quiet) -> SlabLaw | PuckLaw | CampaignForceLaw:
    """Choose the force law that a campaign declares."""
    if not campaign.trials:
        return tabulated_law(campaign)
    by_shape: dict[str, list[Trial]] = {}
    for trial in campaign.trials:
        by_shape.setdefault(trial.pad[0], []).append(trial)
    laws = {shape: _law(campaign, trials, progress) for shape, trials in by_shape.items()}
    if len(laws) == 1:
        return laws.popitem()[1]
    pads: dict[tuple[str, float], Any] = {}
    for trial in campaign.trials:
        law = laws[trial.pad[0]]
        pads[trial.pad] = law.law_of(trial.pad) if isinstance(law, CampaignForceLaw) else law
    return CampaignForceLaw(
        pads, "shaped", tuple(max(terms) for terms in zip(*(law.error_priors for law in laws.values())))
    )


def tabulated_law(campaign: Campaign) -> SlabLaw | PuckLaw:
    """The law of a campaign that is only planned: one that needs no solve."""
    law, pad = _without_solve(campaign, campaign.pad.geometry, ()), campaign.pad
    if law is not None:
        return law
    shape = pad.shape if pad.geometry.plain else str(pad.geometry)
    raise InputError(
        f"a pad of shape = {shape} on base = {pad.base} under a {_named(campaign.punch)} has no tabulated force; "
        "'dummydesign loop' solves this pad once it is pressed",
        "not_tabulated",
        "pad",
    )


def _named(punch: PunchSpec) -> str:
    edge = f" with edge_radius_mm = {punch.edge_radius_mm:g}" if punch.edge_radius_mm else ""
    return f"{punch.shape} punch{edge}, contact = {punch.contact},"


def _without_solve(campaign: Campaign, geometry: PadShape, trials: Sequence[Trial]) -> SlabLaw | PuckLaw | None:
    """The law of pads of one shape in closed form or by the response table of slabs; None where there is none."""
    pad, punch = campaign.pad, campaign.punch
    if pad.shape == "cylinder":
        return PuckLaw(pad.diameter_mm or 0.0) if punch.contact == "frictionless" else None
    if not geometry.plain or pad.base not in BASES or punch.contact != "bonded":
        return None
    table = load_table(pad.base)
    low, high = (punch.radius_mm / ratio for ratio in reversed(table.ratio_range))
    if punch.profile_mm is not None or punch.edge_radius_mm or not all(low <= t.thickness_mm <= high for t in trials):
        return None
    return SlabLaw(table, punch.radius_mm, punch.shape == "square")


def _law(campaign: Campaign, trials: Sequence[Trial], progress: Progress) -> SlabLaw | PuckLaw | CampaignForceLaw:
    cylinder, geometry = campaign.pad.shape == "cylinder", trials[0].geometry
    thickness_error = float(np.sqrt(np.mean([level_error(t) ** 2 for t in trials]))) / THICKNESS_SLOPE
    law = _without_solve(campaign, geometry, trials)
    if law is not None and thickness_error:
        return replace(law, error_priors=error_priors(law.error_priors, 0.0, False, thickness_error))
    if law is not None:
        return law
    if not cylinder:
        check_round(geometry)
    return _solved(campaign, trials, "cylinder" if cylinder else "shaped", thickness_error, progress)


def level_error(trial: Trial) -> float:
    """What is not known of a pad's level: errors of its measured thickness and of its modulus' factor, in ln force."""
    return math.hypot(THICKNESS_SLOPE * (trial.thickness_sd_mm or 0.0) / trial.thickness_mm, trial.young_factor_sd)


def check_round(geometry: PadShape) -> None:
    """Refuse a shape whose force is not solved round."""
    if geometry.axisymmetric:
        return
    raise InputError(
        f"shape = {geometry} is not round: its force under a punch is solved in space, minutes for each pad and "
        "for each change of it that an effect asks for, which the loop does not do; press a crowned, layered or "
        f"boned pad, or compare its traces with 'dummydesign predict --shape {geometry} --fidelity 3d'",
        "unsupported",
        "shape",
        str(geometry),
    )


def _solved(
    campaign: Campaign, trials: Sequence[Trial], shape: str, thickness_error: float, progress: Progress
) -> CampaignForceLaw:
    """The law of the pads of one shape, solved for every thickness."""
    pad, punch, geometry = campaign.pad, campaign.punch, trials[0].geometry
    offers: set[str] = set()
    grows = False
    if shape == "shaped":
        flat, glued = punch.profile_mm is None, pad.base == "bonded" and punch.contact == "bonded"
        if flat and glued:
            offers = {"bulk_that_gives"} if geometry.bone_height_mm else {"base_that_can_slip", "bulk_that_gives"}
        if flat and geometry.flat_top:
            offers.add("flat_faces")
        grows = not (flat and geometry.flat_top and pad.base in BASES and punch.contact == "bonded")
    curves: dict[tuple[str, float], SolvedCurve] = {}
    groups = _groups(sorted({trial.thickness_mm for trial in trials}))
    for number, group in enumerate(groups):
        own = [trial for trial in trials if trial.thickness_mm in group]
        young = 1.0 if pad.base in BASES or shape == "cylinder" else 1e-3 * material_of(campaign).young_kPa
        made = pad_of(campaign, float(np.mean(group)) if len(group) > 1 else group[0], young, geometry)
        if isinstance(made, Pad) and not punch.edge_radius_mm and not made.geometry.crowned:
            made = replace(made, sides_mm=None)
        what = "puck" if isinstance(made, Puck) else f"{geometry} pad"
        progress(f"force law of the {what} of {made.thickness_mm:g} mm ({number + 1} of {len(groups)})")
        share = MARGIN * max(float(t.trace.displacement_mm.max()) / t.thickness_mm for t in own)
        deepest = next((depth for depth in DEPTHS if depth >= share), DEPTHS[-1]) * made.thickness_mm
        curve = SolvedCurve(made, deepest, frozenset(offers))
        curves |= {trial.pad: curve for trial in own}
    error = max(curve.relative_error for curve in curves.values())
    corners = all(isinstance(curve.pad, Pad) and has_square_factor(curve.pad) for curve in curves.values())
    outline = punch.shape == "square" and not corners
    priors = error_priors(SlabLaw.error_priors, error, outline, thickness_error, ROUGHNESS if grows else 0.0)
    return CampaignForceLaw(dict(curves), shape, priors)


def _groups(thickness_mm: list[float]) -> list[list[float]]:
    """Thicknesses that rise, those that lie near each other together."""
    groups: list[list[float]] = []
    for value in thickness_mm:
        if groups and value <= groups[-1][0] * (1.0 + ONE_PAD):
            groups[-1].append(value)
        else:
            groups.append([value])
    return groups


def pad_of(
    campaign: Campaign, thickness_mm: float, young_MPa: float, geometry: PadShape, prony: tuple[PronyTerm, ...] = ()
) -> Pad | Puck:
    """A pad of a campaign under its punch, as the pad model takes it."""
    pad, punch = campaign.pad, campaign.punch
    if pad.shape == "cylinder":
        return Puck(thickness_mm, young_MPa, pad.diameter_mm or 0.0, prony, punch.contact)
    size = (pad.length_mm, pad.width_mm) if pad.length_mm and pad.width_mm else None
    return Pad(
        thickness_mm,
        young_MPa,
        punch.radius_mm,
        prony=prony,
        base=pad.base,
        condition=punch.contact,
        extent_mm=math.sqrt(size[0] * size[1] / math.pi) if size else None,
        sides_mm=(punch.side_mm, punch.side_mm) if punch.side_mm else None,
        profile_mm=punch.profile_mm,
        geometry=geometry,
        edge_radius_mm=punch.edge_radius_mm,
        slab_mm=size or (PAD_LENGTH_MM, PAD_WIDTH_MM),
    )
