"""Blind check of castings. Simulated pads; 5 minutes, and 5 for the curves.

    python -m benchmarks.accuracy.castings_blind

``suggest`` designs crowned pads and slabs for the built-in tissues, with the resin as it is stated, with a better known
modulus, with both modulus and relaxation measured, and with both measured well and the pad made well (0.01 g, 0.05 mm,
ratios in steps of 0.02). Of each shape, one ratio of every level that occurs is taken. Pads of each design are then
cast and pressed by code of this file alone: draws from the stated intervals, errors of weighing and thickness, and a
smooth error of the force law, of its stated size at each depth, on curves that were solved by finite elements for pads
0.2 mm thinner and thicker (``castings_blind_curves.json``). The arms of the relaxation are integrated by a rule of this
file. Nothing of ``dummydesign.design.scoring.castings`` is used for a pad; the subjects' presses are the design's.

A pad's needed factor is the largest ratio of the lowest subject to the pad over all peaks, energies and the steady
curve. ``correction.factor`` should cover it for 95 % of the pads that reach every press. Rows are kept in ``--rows``
(one JSON object a line and design), so that a study can be stopped and resumed.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PchipInterpolator
from scipy.special import erf

from benchmarks.rows import keep_row, read_rows, write_evidence
from dummydesign.core.levels import LEVELS
from dummydesign.design.assessment.pad_castings import verdict_of_design
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.castings import Castings
from dummydesign.design.scoring.press_simulation import make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.verdict import ranges_of
from dummydesign.design.search.slabs import DesignCandidate, make_slabs
from dummydesign.design.suggest import design
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.pad.axisymmetric.shaped_pad import solve_shaped_pad
from dummydesign.pad.axisymmetric.sharp_edge import solve_curve
from dummydesign.pad.pad_under_punch import Pad

ROOT = Path(__file__).resolve().parents[2]

RADIUS_MM = 14.0 / np.sqrt(np.pi)
BRAKING_MM_S2, HOLD_S = 30_000.0, 10.0
SHARES = np.r_[0.015, 0.03, 0.05, np.arange(0.075, 0.601, 0.025)]
CELLS = 24
CURVES = ROOT / "benchmarks" / "results" / "castings_blind_curves.json"
GEOMETRIES = (
    ("forefinger", "crowned:radius=21.2,height=2,foot=9.4", 4.5),
    ("palm", "crowned:radius=2.4,height=3.5,foot=7.8", 11.0),
    ("thenar", "crowned:radius=2,height=4.3,foot=7.8", 13.5),
    ("forefinger", "slab", 5.5),
    ("palm", "slab", 12.0),
)
"""Tissue, shape and thickness of what is pressed; the first three are what ``suggest`` recommends. [mm]"""
KNOWLEDGE = ("as stated", "modulus known", "measured", "measured, made well")
MADE_WELL: dict[str, Any] = {"weighing_g": 0.01, "thickness_mm": 0.05}
AROUND, TRIED = 9, 28
"""Steps of the ratio to either side that are judged, and depths at which a pad is pressed."""
CLASSES = ("stands_for", "with_correction", "reads_low", "over", "out_of_reach")


def known_resin(resin, knowledge: str):
    """The resin with narrower intervals: of the modulus's law, and of the relaxation too once it is ``measured``."""

    def within(quantity, share: float):
        return replace(quantity, low=quantity.value * (1.0 - share), high=quantity.value * (1.0 + share), kind="fitted")

    if knowledge == "as stated":
        return resin
    well = 0.5 if knowledge == KNOWLEDGE[-1] else 1.0
    widths = {"young_ref_kPa": 0.04 * well, "gel_ratio_over_ref": 0.004 * well, "exponent": 0.04}
    numbers = {name: within(q, widths[name]) if name in widths else q for name, q in resin.numbers.items()}
    if knowledge == "modulus known":
        return replace(resin, numbers=numbers)
    arms = tuple(replace(arm, beta=within(arm.beta, 0.06 * well)) for arm in resin.arms)
    step = 0.02 if well < 1.0 else resin.ratio_step
    softness = within(resin.softness_exponent, 0.1)
    return replace(resin, numbers=numbers, arms=arms, softness_exponent=softness, ratio_step=step)


# --- curves -----------------------------------------------------------------------------------------------------------


def solve_curves() -> list[dict]:
    """Solve what the file does not hold: every geometry 0.2 mm below and above its thickness."""
    rows = json.loads(CURVES.read_text()) if CURVES.exists() else []
    done = {(row["shape"], row["thickness_mm"]) for row in rows}
    for _, shape, middle in GEOMETRIES:
        for thickness in (middle - 0.2, middle + 0.2):
            thickness = round(thickness, 3)
            if (shape, thickness) in done:
                continue
            depth = SHARES * thickness
            if shape == "slab":
                curve = solve_curve(Pad(thickness, 1.0, RADIUS_MM, extent_mm=75.7), depth, independent=True)
            else:
                pad = Pad(thickness, 1.0, RADIUS_MM, extent_mm=75.7, geometry=read_shape(shape))
                curve = solve_shaped_pad(pad, depth, cells=CELLS)
            rows.append(
                {
                    "shape": shape,
                    "thickness_mm": thickness,
                    "depth_mm": [round(float(d), 5) for d in curve.depth_mm],
                    "force_over_young_mm2": [float(f"{f:.6g}") for f in curve.force_N],
                }
            )
            CURVES.write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")
            print("solved", shape, thickness, len(curve.depth_mm), file=sys.stderr, flush=True)
    return rows


@lru_cache(maxsize=32)
def solved(shape: str, middle: float) -> tuple[NDArray, tuple, float]:
    """Two thicknesses, curves of ln(F / (E h^2 share^p)) over ln share through solved points, and the last share."""
    rows = sorted(
        (r for r in json.loads(CURVES.read_text()) if r["shape"] == shape and abs(r["thickness_mm"] - middle) < 0.21),
        key=lambda r: r["thickness_mm"],
    )
    curves = []
    for row in rows:
        share = np.log(np.array(row["depth_mm"]) / row["thickness_mm"])
        area = np.array(row["force_over_young_mm2"]) / row["thickness_mm"] ** 2
        curves.append(PchipInterpolator(share, np.log(area) - _power(shape) * share))
    last = min(row["depth_mm"][-1] / row["thickness_mm"] for row in rows)
    return np.array([row["thickness_mm"] for row in rows]), tuple(curves), last


def _power(shape: str) -> float:
    return 1.0 if shape == "slab" else 1.5


def force_over_young(shape: str, middle: float, thickness: NDArray, share: NDArray) -> NDArray:
    """F / E of pads (n,) at depths over thickness (m,), shape (n, m): a power of the thickness between two. [mm2]

    The square punch is stiffer than the circle of its area by what the campaign generator takes for flat slabs.
    """
    nodes, curves, _ = solved(shape, middle)
    at = np.log(np.maximum(share, SHARES[0]))
    low, high = (curve(at) for curve in curves)
    part = (np.log(thickness / nodes[0]) / np.log(nodes[1] / nodes[0]))[:, None]
    total = (1.0 - part) * low + part * high
    force = np.exp(total) * thickness[:, None] ** 2 * share ** _power(shape)
    if shape == "slab":
        square = np.interp(thickness, [5.0, 10.0, 15.0, 20.0], [0.002, 0.028, 0.030, 0.030])[:, None]
        force = force * (1.0 + square * (1.0 - 0.5 * share))
    return np.asarray(force)


# --- castings ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Cast:
    """Pads of one design: thickness and modulus (n,), strengths (n, arms), and deviates (n, 2) of the force law."""

    thickness_mm: NDArray
    young_MPa: NDArray
    beta: NDArray
    law: NDArray


def drawn(quantity, deviate: ArrayLike) -> NDArray:
    """Values of an interval: two half normals of the logarithm about the value, or even parts where it is assumed."""
    value, low, high, deviate = quantity.value, quantity.low, quantity.high, np.asarray(deviate, float)
    if quantity.kind == "assumed":
        below = 0.5 * (1.0 + erf(deviate / np.sqrt(2.0)))
        return np.interp(below, [0.0, 0.5, 1.0], [low, value, high])
    up, down = (np.log(high / value) / 1.96, np.log(value / low) / 1.96)
    return np.asarray(value * np.exp(np.where(deviate > 0, up, down) * deviate))


def cast_pads(resin, ratio: float, thickness_mm: float, limits, count: int, rng, measured: bool) -> Cast:
    """Cast pads: the resin's numbers, two weighed liquids and the thickness, with errors even within limits.

    With ``measured`` modulus and relaxation are at their centre.
    """
    names = ("young_ref_kPa", "gel_ratio_over_ref", "exponent")
    rows: list[list[float]] = []
    reference = resin.numbers["ratio_ref"].value
    while len(rows) < count:
        one = [float(drawn(resin.numbers[name], 0.0 if measured else rng.standard_normal())) for name in names]
        if one[1] * reference < resin.ratio_min:  # a gel point above the leanest mix is no such resin
            rows.append(one)
    young_ref, gel, exponent = np.array(rows).T
    free = 0.0 if measured else 1.0
    arms = [drawn(arm.beta, free * rng.standard_normal(count)) for arm in resin.arms]
    softness = drawn(resin.softness_exponent, free * rng.standard_normal(count))
    pour_g, off_g, off_mm = limits
    polyol = pour_g * 100.0 / (100.0 + ratio) + rng.uniform(-off_g, off_g, count)
    isocyanate = pour_g * ratio / (100.0 + ratio) + rng.uniform(-off_g, off_g, count)
    mixed = 100.0 * isocyanate / polyol

    def modulus(at):
        return young_ref * (np.maximum(at - gel * reference, 1e-3) / (reference - gel * reference)) ** exponent

    growth = (modulus(resin.relaxation_ratio_ref) / modulus(mixed)) ** softness
    thickness = thickness_mm + rng.uniform(-off_mm, off_mm, count)
    return Cast(thickness, 1e-3 * modulus(mixed), np.stack(arms, 1) * growth[:, None], rng.standard_normal((count, 2)))


def motion(velocity: float, depth: NDArray) -> tuple[NDArray, NDArray]:
    """Times and depths (T, K) of ramps, constant braking and holds to depths (T,): 240 steps, then ever longer."""
    brake = np.minimum(velocity / BRAKING_MM_S2, 2.0 * depth / velocity)
    stop = depth / velocity + 0.5 * brake
    rise = np.linspace(0.0, 1.0, 241)[None] * stop[:, None]
    hold = stop[:, None] + np.geomspace(1e-4, HOLD_S, 160)[None]
    when = np.concatenate([rise, hold], axis=1)
    left = np.maximum(stop[:, None] - when, 0.0)
    ramp = velocity * when
    depth_at = np.where(left > brake[:, None], ramp, depth[:, None] - 0.5 * velocity / brake[:, None] * left**2)
    return when, np.maximum(depth_at, 0.0)


def press(pads: Cast, shape: str, middle: float, tau: NDArray, error, velocity: float, share: NDArray) -> tuple:
    """End force, peak and energy (n, m) of pads pressed to depths (m,) over their thickness."""
    count, many = len(pads.young_MPa), len(share)
    depth = (pads.thickness_mm[:, None] * share).ravel()
    when, depth_at = motion(velocity, depth)
    grid = np.r_[0.0, np.geomspace(1e-4, share[-1], 2500)]
    area = np.concatenate([np.zeros((count, 1)), force_over_young(shape, middle, pads.thickness_mm, grid[1:])], axis=1)
    # a smooth error over depth, of the stated size at every depth
    turn = 0.5 * np.pi * grid / share[-1]
    size = np.log1p(np.nan_to_num(error(grid * middle))) / 1.96
    area = area * np.exp(size * (pads.law[:, :1] * np.cos(turn) + pads.law[:, 1:] * np.sin(turn)))
    elastic = np.empty_like(depth_at)
    for pad in range(count):
        own = slice(pad * many, (pad + 1) * many)
        elastic[own] = np.interp(depth_at[own] / pads.thickness_mm[pad], grid, area[pad] * pads.young_MPa[pad])
    beta = np.repeat(pads.beta, many, axis=0)
    arms, force = np.zeros((len(depth), len(tau))), np.zeros_like(depth_at)
    for at in range(1, depth_at.shape[1]):
        step = ((when[:, at] - when[:, at - 1])[:, None]) / tau
        rise = (elastic[:, at] - elastic[:, at - 1])[:, None]
        arms = arms * np.exp(-step) + beta * rise * np.exp(-0.5 * step)
        force[:, at] = elastic[:, at] + arms.sum(axis=1)
    energy = (0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(depth_at, axis=1)).sum(axis=1)
    return tuple(one.reshape(count, many) for one in (force[:, -1], force.max(axis=1), energy))


def needs(pads: Cast, answer, shape: str, middle: float) -> tuple[NDArray, NDArray, NDArray]:
    """Needed factor, over-reading and reach (n,) of pads in every press of the test."""
    ranges, law = ranges_of(answer.targets), answer.cast
    gel = float(answer.shape.gel_mm(np.array([middle]), {k: np.array([v]) for k, v in answer.shape.parameters})[0])
    deepest = min(answer.targets.limits.gel_compression * gel / middle, solved(shape, middle)[2])
    share = np.geomspace(0.03, deepest, TRIED)
    tau = np.array([arm.tau_s.value for arm in answer.resin.arms])

    def error(depth):
        return law.relative_error(depth, middle, RADIUS_MM)

    count = len(pads.young_MPa)
    peak, energy = (np.full((count, len(ranges.force_N)), np.nan) for _ in range(2))
    depth = np.full((count, len(ranges.steady_N)), np.nan)
    slow = ranges.velocity_mm_s.min()
    for speed in np.unique(ranges.velocity_mm_s):
        end, most, work = press(pads, shape, middle, tau, error, speed, share)
        here = np.nonzero(ranges.velocity_mm_s == speed)[0]
        for pad in range(count):
            where = PchipInterpolator(np.log(end[pad]), np.log(share), extrapolate=False)
            at = where(np.log(ranges.force_N[here]))
            peak[pad, here] = np.exp(PchipInterpolator(np.log(share), np.log(most[pad]))(at))
            energy[pad, here] = np.exp(PchipInterpolator(np.log(share), np.log(work[pad]))(at))
            if speed == slow:
                depth[pad] = pads.thickness_mm[pad] * np.exp(where(np.log(ranges.steady_N)))
    short = [ranges.peak_low_N / peak, (depth / ranges.soft_mm) ** ranges.power, ranges.energy_low_mJ / energy]
    above = [peak / ranges.peak_high_N, (ranges.stiff_mm / depth) ** ranges.power, energy / ranges.energy_high_mJ]
    reached = np.isfinite(peak).all(axis=1)
    lowest, highest = (np.max(np.nan_to_num(np.concatenate(one, axis=1)), axis=1) for one in (short, above))
    return lowest, highest, reached


def classes_of(lowest: NDArray, highest: NDArray, reached: NDArray, limits) -> NDArray:
    """Class of each pad by the limits, as places in ``CLASSES``."""
    classes = np.full(len(lowest), 4)
    for pad in np.nonzero(reached)[0]:
        low, high = lowest[pad], highest[pad]
        if low <= limits.stands_shortfall and high <= limits.stands_over:
            classes[pad] = 0
        elif low <= limits.shortfall and high <= limits.over:
            classes[pad] = 1
        else:
            classes[pad] = 2 if low / limits.shortfall >= high / limits.over else 3
    return classes


# --- designs ----------------------------------------------------------------------------------------------------------


def designs_of(tissue: str, shape: str, thickness: float, knowledge: str, verify: bool) -> list[tuple]:
    """What ``suggest`` says of a shape, and designs of it: that, and the middle ratio of every level near it."""
    made: dict[str, Any] = MADE_WELL if knowledge == KNOWLEDGE[-1] else {}
    inputs = read_problem(Request(tissue, shape=shape, thickness_mm=(thickness, thickness), verify=verify))
    as_asked = inputs.tolerances
    inputs = replace(inputs, tolerances=lambda *pad: replace(as_asked(*pad), **made))
    resin = known_resin(inputs.resin, knowledge)
    castings = Castings(resin, inputs.castings.n)
    inputs = space = replace(inputs, resin=resin, ratio=resin.ratios(), castings=castings)
    answer = design(inputs)
    best = answer.best
    here = int(np.argmin(np.abs(space.ratio - best.ratio)))
    ratios = space.ratio[max(here - AROUND, 0) : here + AROUND + 1]
    gel = space.targets.limits.gel_compression
    curves = make_curves(answer.cast, np.array([best.thickness_mm]), space.radius_mm, gel)
    slabs = make_slabs(curves, np.zeros(len(ratios), int), resin, ratios)
    evaluation = evaluate(slabs, space.targets, space.sampling, exact=True)
    levels: dict[str, list[tuple]] = {}
    for at, ratio in enumerate(ratios):
        one = DesignCandidate(best.thickness_mm, float(ratio), at, evaluation)
        judged = verdict_of_design(replace(answer.castings, candidate=one))
        levels.setdefault(judged.level, []).append((answer, float(ratio), judged, False))
    kept = {best.ratio: (answer, best.ratio, answer.verdict, True)}
    for rows in levels.values():
        middle = rows[len(rows) // 2]
        kept.setdefault(middle[1], middle)
    return list(kept.values())


def run_one(design_: tuple, case: tuple, pads: int, seed: int) -> dict:
    """Cast and press the pads of one design."""
    number, (tissue, shape, thickness), knowledge = case
    answer, ratio, judged, recommended = design_
    rng = np.random.default_rng([seed, number, round(100 * ratio)])
    errors = answer.castings.tolerances
    making = errors.pour_g, errors.weighing_g, errors.thickness_mm
    row = {
        "number": number,
        "seed": seed,
        "tissue": tissue,
        "shape": shape,
        "thickness_mm": thickness,
        "ratio": ratio,
        "knowledge": knowledge,
        "suggested": recommended,
        "level": judged.level,
        "stated": judged.castings,
        "factor": judged.correction.factor,
        "factor_after_measuring": judged.correction.factor_after_measuring,
        "shortfall_q95": judged.shortfall.q95,
        "over_q95": judged.over.q95,
        "law_error": round(answer.castings.error, 4),
        "pads": pads,
    }
    # what is stated of an average batch is of the ratio chosen for it, whatever ratio is judged: once an answer
    measured = [("measured_", True, answer.castings.outlook.known_ratio)] if recommended else []
    for name, known, at in [("", False, ratio), *measured]:
        cast = cast_pads(answer.resin, at, thickness, making, pads, rng, known)
        lowest, highest, reached = needs(cast, answer, shape, thickness)
        kinds = classes_of(lowest, highest, reached, answer.targets.limits)
        row[f"{name}needed"] = [round(float(one), 4) if ok else None for one, ok in zip(lowest, reached)]
        row[f"{name}over"] = [round(float(one), 4) if ok else None for one, ok in zip(highest, reached)]
        row[f"{name}classes"] = [int(kind) for kind in kinds]
    return row


# --- table ------------------------------------------------------------------------------------------------------------


def covered(rows: list[dict], needed: str, stated: str) -> tuple[int, int]:
    """How many pads in reach are at most what was stated, and how many are in reach."""
    known = [row for row in rows if row[stated] is not None]
    flags = [
        max(value, 1.0 if "factor" in stated else 0.0) <= row[stated]
        for row in known
        for value in row.get(needed, ())
        if value is not None
    ]
    return sum(flags), len(flags)


def beyond(rows: list[dict], needed: str, stated: str) -> str:
    """By how much pads are above what was stated: the 95 % quantile of the ratio, in per cent."""
    ratios = [
        max(value, 1.0 if "factor" in stated else 0.0) / row[stated]
        for row in rows
        if row[stated] is not None
        for value in row.get(needed, ())
        if value is not None
    ]
    return f"{100 * (float(np.quantile(ratios, 0.95)) - 1):+.1f}" if ratios else ""


def shares_of(rows: list[dict], name: str) -> tuple[float, float, float, int]:
    """Stated and counted share of a class over designs, standard error of the difference, and the pads."""
    number = CLASSES.index(name)
    pads = sum(row["pads"] for row in rows)
    stated = sum(row["stated"][name] * row["pads"] for row in rows) / pads
    counted = sum(row["classes"].count(number) for row in rows) / pads
    # pads are independent; the stated shares of one shape and resin come from the same 1200 castings
    own = sum(row["stated"][name] * (1 - row["stated"][name]) * row["pads"] for row in rows) / pads**2
    groups: dict[int, float] = {}
    for row in rows:
        spread = np.sqrt(row["stated"][name] * (1 - row["stated"][name]) / 1200)
        groups[row["number"]] = groups.get(row["number"], 0.0) + spread * row["pads"] / pads
    return stated, counted, float(np.sqrt(own + sum(size**2 for size in groups.values()))), pads


QUANTITIES = (
    ("factor", "needed", "factor"),
    ("shortfall", "needed", "shortfall_q95"),
    ("over-reading", "over", "over_q95"),
    ("factor after measuring", "measured_needed", "factor_after_measuring"),
)
"""Stated 95 % figures: name, what a pad needs, and what was stated."""


def groups_of(rows: list[dict]) -> dict[str, list[dict]]:
    """Designs by name: all, those suggested, by level, by knowledge of the resin, by tissue and shape."""
    groups = {"all": rows, "suggested": [row for row in rows if row["suggested"]]}
    groups |= {level: [row for row in rows if row["level"] == level] for level in LEVELS}
    groups |= {f"resin {name}": [row for row in rows if row["knowledge"] == name] for name in KNOWLEDGE}
    shapes = dict.fromkeys((row["tissue"], row["shape"]) for row in rows)
    return groups | {f"{t}, {s}": [r for r in rows if (r["tissue"], r["shape"]) == (t, s)] for t, s in shapes}


def data(rows: list[dict]) -> dict[str, list[tuple]]:
    """Rows of both data files, with heads: 95 % figures of every group, and classes by knowledge of the resin."""
    held: list[tuple] = [
        ("designs", "number", "quantity", "pads", "held_percent", "standard_error_percent", "q95_over_stated_percent")
    ]
    kinds: list[tuple] = [
        ("resin", "pads", "class", "stated_percent", "counted_percent", "difference_points", "standard_error_points")
    ]
    for words, own in groups_of(rows).items():
        for name, *names in QUANTITIES:
            good, every = covered(own, *names)
            held.append((words, len(own), name, every, *_percent(good, every), beyond(own, *names)))
    for name in ("all", *KNOWLEDGE):
        own = [row for row in rows if name in ("all", row["knowledge"])]
        for kind in CLASSES:
            stated, counted, error, pads = shares_of(own, kind)
            values = (f"{100 * value:.1f}" for value in (stated, counted, counted - stated, error))
            kinds.append((name, pads, kind, *values))
    return {"castings-blind": held, "castings-blind-classes": kinds}


def table(rows: list[dict]) -> str:
    """Whether stated figures hold, by level of the design, in Markdown."""
    groups, shown = groups_of(rows), [one for one in QUANTITIES if one[0] != "shortfall"]
    lines = [
        f"| designs | number | {' | '.join(name for name, *_ in shown)} | fit as promised: stated | counted |",
        "|---|---|" + "---|" * (len(shown) + 2),
    ]
    for words, own in groups.items():
        if words == "all" or words in LEVELS:
            cells = (f"{_percent(*covered(own, *names))[0]} %" for _, *names in shown)
            kinds = [shares_of(own, name) for name in CLASSES[: 1 if words == "stands_for" else 2]]
            ends = (f"{100 * sum(kind[at] for kind in kinds):.1f} %" for at in (0, 1))
            lines.append(f"| {words} | {len(own)} | {' | '.join([*cells, *ends])} |")
    return "\n".join([*lines, "", *(_weakest(groups, *one) for one in shown)]) + "\n"


def _weakest(groups: dict[str, list[dict]], name: str, *names: str) -> str:
    """The group with the lowest share, and the largest excess of any group, in a line."""
    share = {words: covered(own, *names) for words, own in groups.items()}
    low = min(share, key=lambda words: share[words][0] / max(share[words][1], 1))
    most = max(float(beyond(own, *names) or 0.0) for own in groups.values())
    return f"- {name}: weakest {_share(*share[low])} for {low}; figures {most} % larger suffice in every group."


def _percent(good: int, every: int) -> tuple[str, str]:
    """A share and its standard error."""
    share = good / max(every, 1)
    return f"{100 * share:.1f}", f"{100 * np.sqrt(share * (1 - share) / max(every, 1)):.1f}"


def _share(good: int, every: int) -> str:
    return "{} % ({})".format(*_percent(good, every)) if every else "-"


def main() -> None:
    """Run what is missing of the study and write the table."""
    parser = argparse.ArgumentParser(description="Blind check of castings.")
    parser.add_argument("--pads", type=int, default=60, help="of each design")
    parser.add_argument("--seed", type=int, default=20261127)
    parser.add_argument("--rows", type=Path, help="default results/castings_blind.jsonl, ..._tables.jsonl")
    parser.add_argument("--tables", action="store_true", help="designs by their tables (--no-verify); printed")
    parser.add_argument("--table-only", action="store_true")
    options = parser.parse_args()
    # rows of the two kinds of designs have a file each: they have the same numbers
    name = f"castings_blind{'_tables' if options.tables else ''}.jsonl"
    kept = options.rows or ROOT / "benchmarks" / "results" / name
    rows = [row for row in read_rows(kept) if row["seed"] == options.seed]
    known = {row["number"] for row in rows}
    if not options.table_only:
        solve_curves()
        places = [(geometry, knowledge) for geometry in GEOMETRIES for knowledge in KNOWLEDGE]
        for number, (geometry, knowledge) in enumerate(places):
            if number in known:
                continue
            started = time.process_time()
            # the designs of one shape are kept together, so that a study that was stopped goes on at a whole shape
            judged = [
                run_one(one, (number, geometry, knowledge), options.pads, options.seed)
                for one in designs_of(*geometry, knowledge, not options.tables)
            ]
            for row in judged:
                keep_row(kept, row)
            rows += judged
            levels = ", ".join(f"{row['ratio']:g} {row['level']}" for row in judged)
            seconds = f"{time.process_time() - started:.1f} s"
            print(number, *geometry, knowledge, levels, seconds, file=sys.stderr, flush=True)
    if options.tables:
        for words, *names in QUANTITIES:
            print(f"{words}: {_share(*covered(rows, *names))}")
        return
    write_evidence("castings", table(rows))
    for name, lines in data(rows).items():
        with (ROOT / "docs" / "data" / f"{name}.csv").open("w", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows(lines)


if __name__ == "__main__":
    main()
