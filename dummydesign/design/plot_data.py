"""What a report draws of a suggestion: its curves, how it reacts to what is not exact, and inside of the pressed pad.

The inside, deformed cross-sections with stress at the forces of the test and the contact pressure, is solved on
coarse elements under the circle of the punch's area, static, at the depths of the design. The best slab is solved
beside a shaped pad, so that peak and position of the pressure can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.request import Protocol
from dummydesign.design.scoring.press_simulation import PadBatch, make_curves, press_to_depth, steady_depth
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.slabs import DesignCandidate
from dummydesign.design.suggestion import Suggestion
from dummydesign.design.test_conditions import pad_of_request
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.pad_under_punch import Pad


def ratio_error(answer: Suggestion) -> float:
    """Largest error of the ratio when both components are weighed off by the tolerance, in opposite ways."""
    masses = {item["name"]: item["mass_g"] for item in answer.batch["components"]}
    by_ratio = next(liquid.name for liquid in answer.resin.liquids if liquid.parts is None)
    varied = masses.get(by_ratio, 0.0)
    rest = sum(mass for name, mass in masses.items() if name != by_ratio)
    error = answer.castings.tolerances.weighing_g
    if varied <= 0.0 or rest <= 0.0:
        return 0.0
    return float(answer.best.ratio * ((1.0 + error / varied) / (1.0 - error / rest) - 1.0))


@dataclass(frozen=True)
class Reaction:
    """Change in per cent of depth (middle force, slow) and peak (middle force, fast) between both ends."""

    name: str
    depth_percent: tuple[float, float]
    peak_percent: tuple[float, float]


def reactions(answer: Suggestion, law: ForceLaw) -> list[Reaction]:
    """How depth and peak of the recommended pad react to each thing that is not exact, one at a time."""
    resin, ratio, thickness, radius = answer.resin, answer.best.ratio, answer.best.thickness_mm, answer.radius_mm
    tolerance, off, modulus = answer.castings.tolerances.thickness_mm, ratio_error(answer), resin.modulus_kPa(ratio)
    smallest, largest = law.ratio_range
    thin = np.clip([thickness - tolerance, thickness + tolerance], radius / largest, radius / smallest)
    mixed = [min(max(ratio + sign * off, resin.ratio_min), resin.ratio_max) for sign in (-1, 1)]
    young, beta = resin.young_MPa(ratio), resin.strengths([ratio, *mixed])
    ends = [[getattr(arm.beta, end) / arm.beta.value for arm in resin.arms] for end in ("low", "high")]
    # the pad itself, then both ends of each
    names = (
        f"thickness ± {tolerance:g} mm",
        f"weighing ± {answer.castings.tolerances.weighing_g:g} g",
        "modulus, 95 %",
        "relaxation, 95 %",
    )
    moduli = [young, young, young, *resin.young_MPa(mixed), 1e-3 * modulus.low, 1e-3 * modulus.high, young, young]
    strengths = np.concatenate([beta[[0, 0, 0, 1, 2, 0, 0]], beta[0] * np.array(ends)])
    slab, gel = np.array([0, 1, 2, 0, 0, 0, 0, 0, 0]), answer.targets.limits.gel_compression
    curves = make_curves(law, [thickness, *thin], radius, gel)
    slabs = PadBatch(curves, slab, np.array(moduli), resin.tau_s, strengths, resin.pressed_force)
    protocol, sampling = answer.targets.protocol, answer.targets.sampling.coarse
    speeds = protocol.slow_mm_s, protocol.fast_mm_s
    slow, fast = (steady_depth(slabs, protocol.needed_N, speed, sampling) for speed in speeds)
    measured = np.stack([slow, press_to_depth(slabs, fast, speeds[1], sampling).peak_N], axis=-1)
    bars = []
    for name, change in zip(names, (100.0 * (measured[1:] / measured[0] - 1.0)).reshape(len(names), 2, 2)):
        # an end at which the force cannot be reached has no number: the bar then ends at no change, with a note
        name += "" if np.isfinite(change).all() else " *"
        low, high = (end.reduce([*change, 0.0 * measured[0]]).tolist() for end in (np.fmin, np.fmax))
        bars.append(Reaction(name, (low[0], high[0]), (low[1], high[1])))
    return bars


THICKNESS_GRID_MM = np.linspace(*THICKNESS_MM, 55)


@dataclass(frozen=True, eq=False)
class ForceGrids:
    """Steady forces at which curves are drawn. [N]

    ``pad`` for pads; ``extrapolated``, ``measured`` and ``aim`` for subjects and aim; ``relative`` for the ratio of
    both; ``exponent_at`` for exponents over thickness.
    """

    pad: NDArray
    extrapolated: NDArray
    measured: NDArray
    aim: NDArray
    relative: NDArray
    exponent_at: tuple[float, ...]


def force_grids(protocol: Protocol) -> ForceGrids:
    """Lay out the forces of a test."""
    low, high = protocol.forces_N[0], protocol.forces_N[-1]
    above = np.linspace(low + 0.025 * (high - low), high, 40) if high > low else np.zeros(0)
    return ForceGrids(
        pad=np.r_[np.linspace(0.02 * low, low, 25), above],
        extrapolated=np.linspace(0.0, low, 21),
        measured=np.linspace(low, high, 41 if high > low else 1),
        aim=np.linspace(0.0, high, 61),
        relative=np.geomspace(0.06 * low, high, 60),
        exponent_at=protocol.forces_N,
    )


def relative_force(candidate: DesignCandidate, targets: Targets, grids: ForceGrids) -> NDArray:
    """Steady force of a design over the aim's, at the depths where the aim carries ``grids.relative``."""
    aim, depth = targets.aim_depth_mm(grids.relative), candidate.steady_depth_mm(grids.pad)
    known = np.isfinite(depth)
    curve = np.log(depth[known]), np.log(grids.pad[known])
    return np.exp(np.interp(np.log(aim), *curve, left=np.nan, right=np.nan)) / grids.relative


def exponent_over_thickness(answer: Suggestion, law: ForceLaw, grids: ForceGrids) -> NDArray:
    """Local exponent d ln F / d ln x at ``grids.exponent_at``, ratio as recommended; (thickness, force).

    NaN at thicknesses that the law does not hold.
    """
    low, high = law.ratio_range
    held = (answer.radius_mm / THICKNESS_GRID_MM >= low) & (answer.radius_mm / THICKNESS_GRID_MM <= high)
    held[held] = np.asarray(law.depth_limit_mm(THICKNESS_GRID_MM[held], answer.radius_mm)) > 0.0
    curves = make_curves(law, THICKNESS_GRID_MM[held], answer.radius_mm, answer.targets.limits.gel_compression)
    slab = np.arange(int(held.sum()))
    area = np.array(grids.exponent_at) / answer.resin.young_MPa(answer.best.ratio)
    depth = curves.depth_at(slab, np.broadcast_to(area, (len(slab), len(area))))
    exponent = np.full((len(held), len(area)), np.nan)
    exponent[held] = curves.slope_at(slab, depth) * depth / area
    return exponent


# How far out is shown, over the punch's radius.
REACH = 1.6
COLUMNS, ABOVE_MM, TOP_PERCENTILE = 121, 2.0, 97.0


@dataclass(frozen=True, eq=False)
class PressedPad:
    """A pad at one force of the test; lengths from the axis and from the base. [mm, kPa]"""

    title: str
    force_N: float
    static_N: float
    depth_mm: float
    radius_mm: NDArray
    height_mm: NDArray
    stress_kPa: NDArray
    face_mm: NDArray
    punch_mm: NDArray
    contact: dict[str, Any]


@dataclass(frozen=True)
class PressPictures:
    """What is shown of the inside of the pads."""

    pads: tuple[PressedPad, ...] = ()
    slab: tuple[PressedPad, ...] = ()
    ceiling_kPa: float = 1.0
    left_out: str = ""


def press_pictures(answer: Suggestion) -> PressPictures:
    """Solve the recommended pad, and the best slab beside a shaped one, at the forces of the test."""
    if not answer.request.verify:
        return PressPictures(left_out="left out, as finite elements were not requested")
    if not answer.shape.axisymmetric:
        kind = answer.shape.name
        return PressPictures(left_out=f"left out: {kind} pads are not round, and no one section stands for them")
    try:
        pads = _pressed(answer, answer.best, answer.shape)
    except NoAnswerError as problem:
        return PressPictures(left_out=f"left out: {problem}")
    slab: tuple[PressedPad, ...] = ()
    flat = next((item.candidate for item in answer.comparisons if item.kind == Slab.name and item.candidate), None)
    left_out = ""
    if flat is not None and not answer.shape.plain:
        try:
            slab = _pressed(answer, flat, Slab())
        except NoAnswerError as problem:
            left_out = f"the slab beside it is left out: {problem}"
    return PressPictures(pads, slab, max(_under_punch(pad) for pad in (*pads, *slab)), left_out)


def _under_punch(pad: PressedPad) -> float:
    """Stress below which nearly all of the pad under the contact is. [kPa]"""
    inside = pad.stress_kPa[:, np.abs(pad.radius_mm) < 0.9 * pad.contact["contact_radius_mm"]]
    known = inside[np.isfinite(inside)]
    return float(np.percentile(known, TOP_PERCENTILE)) if len(known) else 1.0


def _pressed(answer: Suggestion, candidate: DesignCandidate, shape: PadShape) -> tuple[PressedPad, ...]:
    """One pad at every force of the test that it reaches."""
    from dummydesign.core.cache import cached

    forces = np.array(answer.targets.protocol.forces_N)
    depths = candidate.depth_mm[: len(forces)]
    reached = np.isfinite(depths)
    if not reached.any():
        raise NoAnswerError("no_feasible_design", "the pad reaches no force of the test", quantity="pad")
    young = float(np.asarray(answer.resin.young_MPa(candidate.ratio)))
    pad = replace(pad_of_request(answer.request, answer.punch, candidate.thickness_mm, young), geometry=shape)
    wanted = depths[reached]
    made = cached("pictures", {"pad": pad, "depth": wanted}, lambda: _solved(pad, wanted))
    return tuple(_drawn(pad, force, state) for force, state in zip(forces[reached].tolist(), made["states"]))


def _solved(pad: Pad, depth_mm: NDArray) -> dict[str, Any]:
    """States at rising depths as plain values."""
    from dummydesign.pad.fields import solve_fields

    fields, _ = solve_fields(pad, np.maximum.accumulate(depth_mm).tolist(), coarse=True)
    return {
        "states": [
            {
                "depth_mm": one.depth_mm,
                "force_N": one.force_N,
                "place_mm": one.rest_mm + one.displacement_mm,
                "cells": one.cells,
                "stress_kPa": 1e3 * one.von_mises_MPa,
                "punch_mm": one.punch_mm,
                "contact": one.contact(),
                "face_mm": np.stack([one.face.radius_mm, one.face.height_mm], axis=1),
            }
            for one in fields
        ]
    }


def _on_pixels(place: NDArray, value: NDArray, cells: NDArray, size: float, shape: tuple[int, int]) -> NDArray:
    """Mean of values at the nodes of nine-node cells on square pixels (rows up, columns out), NaN where none are."""
    from dummydesign.pad.fem.mesh_axisymmetric import functions

    near = cells[place[cells, 0].min(axis=1) < shape[1] * size]
    # two places a pixel at least, in powers of two, so that cells of a few sizes are worked out at once
    level = np.ceil(np.log2(2.0 * np.ptp(place[near], axis=1).max(axis=-1) / size)).clip(1).astype(int)
    number = shape[0] * shape[1]
    total, hits = np.zeros(number), np.zeros(number)
    for one in np.unique(level):
        share, own = (np.arange(2**one) + 0.5) / 2**one, near[level == one]
        between = functions(np.stack([np.repeat(share, len(share)), np.tile(share, len(share))]))[0].T
        column = np.rint((place[own, 0] @ between) / size).astype(int)
        row = np.floor((place[own, 1] @ between) / size).astype(int)
        inside = (row >= 0) & (row < shape[0]) & (column < shape[1])
        pixel = (row * shape[1] + column)[inside]
        total += np.bincount(pixel, (value[own] @ between)[inside], minlength=number)
        hits += np.bincount(pixel, minlength=number)
    with np.errstate(invalid="ignore"):
        return np.asarray((total / hits).reshape(shape))


def _drawn(pad: Pad, force_N: float, state: dict[str, Any]) -> PressedPad:
    """One state on the picture's cells."""
    points, face = np.asarray(state["place_mm"], float), np.asarray(state["face_mm"], float)
    reach = REACH * pad.radius_mm
    size = 2.0 * reach / COLUMNS
    radius = (np.arange(COLUMNS) - 0.5 * (COLUMNS - 1)) * size
    height = (np.arange(int(np.ceil(float(face[:, 1].max()) / size))) + 0.5) * size
    out, up = np.meshgrid(np.abs(radius), height)
    inside = up <= np.interp(out, face[:, 0], face[:, 1])
    inside &= up >= np.asarray(pad.geometry.bone_mm(out, 0.0 * out), float)
    half = len(height), COLUMNS // 2 + 1
    right = _on_pixels(points, np.asarray(state["stress_kPa"], float), np.asarray(state["cells"]), size, half)
    stress = np.where(inside, np.hstack([right[:, :0:-1], right]), np.nan)
    return PressedPad(
        pad.geometry.name,
        force_N,
        float(state["force_N"]),
        float(state["depth_mm"]),
        radius,
        height,
        stress,
        face,
        np.asarray(state["punch_mm"], float),
        state["contact"],
    )
