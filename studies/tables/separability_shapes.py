"""Presses of shaped pads at finite strain, for the error of the quick prediction (part ``shapes`` of its table).

Pads are drawn as for the check of their response tables, presses from the speeds and arms of the slabs' ones. More
crowns are drawn with the arms of the library's polyurethane at many ratios.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.finite_strain import CELLS, nodes_of_motion, solve_ratio
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.predict import slab_depth, sums_of_arms
from dummydesign.pad.tables.shape import load_shape_table
from dummydesign.resin import load_resin
from studies.tables.designs import designs
from studies.tables.square_crown import numbers_of

Array = np.ndarray

KINDS = ("crowned", "layered", "boned")
PRESSES = 40
SEED = 20261122
DEPTHS = (0.1, 0.45)
SPEEDS_MM_S = (10.0, 50.0, 250.0)
# Crowns with arms of the library's polyurethane at drawn ratios, each strength off by a factor, at drawn depths.
DRAWN, RATIOS, SCATTER = ((4711, 140), (90210, 56)), (14.8, 16.5), 0.25
# Depths over the thickness, and the shares of crowns even in ln s and of speeds between the ends.
DRAWN_DEPTHS, POINTED, BETWEEN = (0.15, 0.55), 0.6, 0.4


def measure_shape(
    press: Case, share: float, velocity_mm_s: float, prony: tuple[PronyTerm, ...], cells: int = CELLS
) -> dict[str, Any]:
    """Solve one press and hold of a shaped pad and compare the error with that of a slab's single arms.

    Parameters
    ----------
    press : Case
        Pad and punch in thicknesses.
    share : float
        Depth of the hold over the gel between bone and apex.
    velocity_mm_s : float
        Of the punch. [mm/s]
    prony : tuple of PronyTerm
        Relaxation of the pad.
    cells : int
        Under the punch.

    Returns
    -------
    dict
        A row: error of the quick force, sums over single arms of the slab that is compressed as much, and viscous
        force, all at the peak and over the quick force.

    Raises
    ------
    NoAnswerError
        When the motion cannot be followed.
    """
    h = press.thickness_mm
    deepest = share * over_thickness(press)
    motion = ramp_and_hold(velocity_mm_s, deepest * h)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / h, prony)
    path = solve_ratio(press, prony, *nodes, cells=cells)
    depth = slab_depth(press.shape, h, press.radius, path.depth)
    sums = sums_of_arms("bonded", press.radius, depth, path.time_s, path.elastic, prony)
    peak = int(np.argmax(path.separable))
    return {
        "shape": str(press.shape),
        "thickness_mm": round(h, 3),
        "relative_depth": round(deepest, 4),
        "velocity_mm_s": velocity_mm_s,
        "error_at_peak": round(float(path.force[peak] / path.separable[peak] - 1.0), 4),
        **over_peak(sums, path.separable),
        "viscous_share_at_peak": round(float(1.0 - path.elastic[peak] / path.separable[peak]), 4),
    }


def over_thickness(press: Case) -> float:
    """Gel between bone and apex over the thickness."""
    return 1.0 - press.shape.bone_height_mm / press.thickness_mm


def over_peak(sums: Array, force: Array) -> dict[str, float]:
    """Both sums over arms at the peak of a force, over that."""
    names, peak = ("rho_at_peak", "relaxing_at_peak"), int(np.argmax(force))
    return {name: round(float(one[peak] / force[peak]), 4) for name, one in zip(names, sums)}


Press = tuple[str, str, Case, float, float, tuple[PronyTerm, ...]]


def presses(sets: dict[str, tuple[PronyTerm, ...]]) -> Iterator[Press]:
    """Kind, name of the arms, pad, depth over the gel, speed and arms of every press."""
    for number, kind in enumerate(KINDS):
        rng, design = np.random.default_rng([SEED, number]), designs()[kind]
        for point in design.fresh(PRESSES):
            share, speed, arms = rng.uniform(*DEPTHS), float(rng.choice(SPEEDS_MM_S)), str(rng.choice(list(sets)))
            yield kind, arms, design.press(point), float(share), speed, sets[arms]
    for seed, count in DRAWN:
        yield from islice(drawn_crowns(seed), count)


def drawn_crowns(seed: int) -> Iterator[Press]:
    """Crowns of the response table, most of them pointed, with drawn arms."""
    rng, resin = np.random.default_rng(seed), load_resin("polyurethane-nagoya")
    design, table, ends = designs()["crowned"], load_shape_table("crowned"), (SPEEDS_MM_S[0], SPEEDS_MM_S[-1])
    while True:
        point = design.low + (design.high - design.low) * rng.uniform(size=4)
        if rng.random() < POINTED:
            point[3] = design.low[3] * (design.high[3] / design.low[3]) ** rng.uniform()
        if not design.castable(point):
            continue
        inputs = numbers_of(*design.shape(point))
        if not table.inside(inputs).all():
            continue
        share = rng.uniform(DRAWN_DEPTHS[0], min(DRAWN_DEPTHS[1], float(table.depth_limit(inputs)[0])))
        between = rng.random() < BETWEEN
        speed = np.exp(rng.uniform(*np.log(ends))) if between else rng.choice(ends)
        arms = resin.prony(rng.uniform(*RATIOS))
        prony = tuple(PronyTerm(arm.tau_s, arm.beta * np.exp(SCATTER * rng.standard_normal())) for arm in arms)
        yield "crowned", "drawn", design.press(point), float(share), float(speed), prony


def build_shapes(sets: dict[str, tuple[PronyTerm, ...]]) -> dict[str, list[dict[str, Any]]]:
    """One row a press in ``shapes``; presses without an answer, such as those that fold, in ``shapes_left_out``.

    Parameters
    ----------
    sets : dict
        Sets of arms by name.
    """
    rows: list[dict[str, Any]] = []
    left_out: list[dict[str, Any]] = []
    for kind, arms, press, share, speed, prony in presses(sets):
        try:
            row = measure_shape(press, share, speed, prony)
        except NoAnswerError as problem:
            h = press.thickness_mm
            row = {"shape": str(press.shape), "thickness_mm": round(h, 3), "velocity_mm_s": speed}
            row |= {"relative_depth": round(share * over_thickness(press), 4), "why": str(problem)}
            left_out.append({"kind": kind, "arms": arms, **row})
            print(f"{kind}: {problem}", flush=True)
            continue
        rows.append({"kind": kind, "arms": arms, **row})
        print(rows[-1], flush=True)
    return {"shapes": rows, "shapes_left_out": left_out}


def with_earlier(before: dict[str, Any], found: dict[str, list[dict[str, Any]]]) -> dict[str, list[dict[str, Any]]]:
    """What :func:`build_shapes` found, and after it the presses of a file that were not drawn again.

    The designs draw other pads once their ranges change; what was measured before stays true.
    """
    return {
        name: rows + [row for row in before.get(name, []) if _press_of(row) not in {_press_of(one) for one in rows}]
        for name, rows in found.items()
    }


def _press_of(row: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in ("kind", "arms", "shape", "thickness_mm", "relative_depth", "velocity_mm_s"))
