"""Choose the force law of a campaign: the response table where it holds, else finite elements for each pad."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dummydesign.core.errors import InputError
from dummydesign.geometry.interface import BASES
from dummydesign.geometry.shapes import PadShape
from dummydesign.geometry.standard import MAX_DEPTH_OVER_THICKNESS
from dummydesign.loop.model.base_law import PuckLaw, SlabLaw
from dummydesign.loop.model.expected import start_young_kPa
from dummydesign.loop.model.solved_curve import SolvedCurve
from dummydesign.loop.model.solved_law import ROUGHNESS, MixedLaw, SolvedLaw, error_priors
from dummydesign.measurement.campaign import Campaign, PunchSpec, Trial
from dummydesign.pad.elastic import has_square_factor
from dummydesign.pad.pad import Pad, Puck
from dummydesign.pad.tables.shape import load_shape_table
from dummydesign.pad.tables.slab import load_table

ONE_PAD = 0.06
"""Thicknesses that differ by less than this share of them are on one solved curve, whose change is solved too."""
DEPTHS = (0.3, 0.45, MAX_DEPTH_OVER_THICKNESS)
"""Depths over thickness to which pads are solved: the first that covers what was pressed."""
MARGIN = 1.1

Progress = Callable[[str], None]


def law_of(campaign: Campaign, progress: Progress | None = None) -> SlabLaw | PuckLaw | SolvedLaw | MixedLaw:
    """Choose the force law that a campaign declares.

    Parameters
    ----------
    campaign : Campaign
    progress : callable, optional
        Called with a word for each pad that is solved.

    Raises
    ------
    InputError
        For a shape that is not solved round.
    NoAnswerError
        When a pad cannot be solved.
    """
    if not campaign.trials:
        return _before_any_trial(campaign)
    kinds = dict.fromkeys(trial.pad[0] for trial in campaign.trials)
    laws = {kind: _law(campaign, [t for t in campaign.trials if t.pad[0] == kind], progress) for kind in kinds}
    return next(iter(laws.values())) if len(laws) == 1 else MixedLaw(laws)


def _before_any_trial(campaign: Campaign) -> SlabLaw | PuckLaw:
    """The law of a campaign that is only planned: one that needs no solve."""
    pad, punch = campaign.pad, campaign.punch
    if pad.shape == "cylinder" and punch.contact == "frictionless":
        return PuckLaw(float(pad.diameter_mm))
    if pad.shape == "slab" and pad.geometry.plain and _tabulated(campaign, ()):
        return SlabLaw(load_table(pad.base), punch.radius_mm, punch.shape == "square")
    shape = pad.shape if pad.geometry.plain else str(pad.geometry)
    raise InputError(
        f"a pad of shape = {shape} on base = {pad.base} under a {_named(punch)} has no tabulated force; "
        "'dummydesign loop' solves this pad once it is pressed"
    )


def _named(punch: PunchSpec) -> str:
    edge = f" with edge_radius_mm = {punch.edge_radius_mm:g}" if punch.edge_radius_mm else ""
    return f"{punch.shape} punch{edge}, contact = {punch.contact},"


def _law(campaign: Campaign, trials: Sequence[Trial], progress: Progress | None) -> SlabLaw | PuckLaw | SolvedLaw:
    pad, punch, geometry = campaign.pad, campaign.punch, trials[0].geometry
    measured = [(t.thickness_sd_mm or 0.0) / t.thickness_mm for t in trials]
    thickness_error = float(np.sqrt(np.mean(np.square(measured))))
    if pad.shape == "cylinder":
        if punch.contact == "frictionless":
            return _widened(PuckLaw(float(pad.diameter_mm)), thickness_error)
        return _solved(campaign, trials, "cylinder", thickness_error, progress)
    if geometry.plain and _tabulated(campaign, trials):
        return _widened(SlabLaw(load_table(pad.base), punch.radius_mm, punch.shape == "square"), thickness_error)
    check_round(geometry)
    return _solved(campaign, trials, "shaped", thickness_error, progress)


def check_round(geometry: PadShape) -> None:
    """Refuse a shape whose force is not solved round.

    Raises
    ------
    InputError
    """
    if geometry.axisymmetric:
        return
    rough = ""
    if geometry.tabulated:
        share = load_shape_table(geometry.name).provenance["error_of_95_percent"]
        rough = f"its table ({100.0 * share:.1f} % at 95 %) is of one form of caps, a glued 14 x 14 mm punch, and "
    raise InputError(
        f"shape = {geometry} is not round: {rough}its force under a punch is solved in space, minutes for each pad and "
        "for each change of it that an effect asks for, which the loop does not do; press a crowned, layered or "
        f"boned pad, or compare its traces with 'dummydesign predict --shape {geometry} --fidelity 3d'"
    )


def _widened(law: Any, thickness_error: float) -> Any:
    if not thickness_error:
        return law
    return replace(law, error_priors=error_priors(law.error_priors, 0.0, False, thickness_error))


def _tabulated(campaign: Campaign, trials: Sequence[Trial]) -> bool:
    """Whether the response table of slabs holds the set-up and all its thicknesses."""
    pad, punch = campaign.pad, campaign.punch
    if pad.base not in BASES or punch.contact != "bonded" or punch.profile_mm is not None or punch.edge_radius_mm:
        return False
    low, high = (punch.radius_mm / ratio for ratio in reversed(load_table(pad.base).ratio_range))
    return all(low <= trial.thickness_mm <= high for trial in trials)


def _solved(
    campaign: Campaign, trials: Sequence[Trial], shape: str, thickness_error: float, progress: Progress | None
) -> SolvedLaw:
    """The law of one shape, solved for every thickness of it."""
    pad, punch, geometry = campaign.pad, campaign.punch, trials[0].geometry
    curves: dict[float, SolvedCurve] = {}
    groups = _groups(sorted({trial.thickness_mm for trial in trials}))
    for number, group in enumerate(groups):
        own = [trial for trial in trials if trial.thickness_mm in group]
        made = _pad(campaign, own, float(np.mean(group)) if len(group) > 1 else group[0])
        if progress is not None:
            what = "puck" if isinstance(made, Puck) else f"{geometry} pad"
            progress(f"force law of the {what} of {made.thickness_mm:g} mm ({number + 1} of {len(groups)})")
        share = MARGIN * max(float(t.trace.displacement_mm.max()) / t.thickness_mm for t in own)
        deepest = next((depth for depth in DEPTHS if depth >= share), DEPTHS[-1])
        curve = SolvedCurve(made, deepest * made.thickness_mm)
        curves |= dict.fromkeys(group, curve)
    glued = pad.base == "bonded" and punch.contact == "bonded" and punch.profile_mm is None and shape == "shaped"
    offers = {"base_that_can_slip", "bulk_that_gives"} if glued and geometry.bone_height_mm == 0.0 else set()
    if glued and geometry.bone_height_mm:
        offers = {"bulk_that_gives"}
    if geometry.flat_top and punch.profile_mm is None and shape == "shaped":
        offers.add("flat_faces")
    error = max(curve.relative_error for curve in curves.values())
    as_circle = punch.shape == "square" and not all(_has_corners(curve.pad) for curve in curves.values())
    priors = error_priors(SlabLaw.error_priors, error, as_circle, thickness_error)
    grows = not geometry.flat_top or punch.profile_mm is not None or pad.base not in BASES
    grows = shape == "shaped" and (grows or punch.contact != "bonded")
    return SolvedLaw(curves, shape, frozenset(offers), priors, ROUGHNESS if grows else 0.0)


def _has_corners(pad: Pad | Puck) -> bool:
    """Whether the factor of the square is in the curve of a pad."""
    return isinstance(pad, Pad) and has_square_factor(pad)


def _groups(thickness_mm: list[float]) -> list[list[float]]:
    """Thicknesses that rise, those that lie near each other together."""
    groups: list[list[float]] = []
    for value in thickness_mm:
        if groups and value <= groups[-1][0] * (1.0 + ONE_PAD):
            groups[-1].append(value)
        else:
            groups.append([value])
    return groups


def _pad(campaign: Campaign, trials: Sequence[Trial], thickness_mm: float) -> Pad | Puck:
    """The pad of some trials as the pad model takes it, with unit modulus; with its own where the base rubs."""
    pad, punch = campaign.pad, campaign.punch
    if pad.shape == "cylinder":
        return Puck(thickness_mm, 1.0, float(pad.diameter_mm), plates=punch.contact)
    young = 1.0 if pad.base in BASES else 1e-3 * start_young_kPa(campaign)
    extent = math.sqrt(pad.length_mm * pad.width_mm / math.pi) if pad.length_mm and pad.width_mm else None
    return Pad(
        thickness_mm, young, punch.radius_mm, base=pad.base, condition=punch.contact, extent_mm=extent,
        profile_mm=punch.profile_mm, geometry=trials[0].geometry, edge_radius_mm=punch.edge_radius_mm,
        sides_mm=(punch.side_mm, punch.side_mm) if punch.edge_radius_mm and punch.side_mm else None,
    )  # fmt: skip
