"""Presses of shaped pads at finite strain, for the error of the quick prediction (part ``shapes`` of its table).

Pads are drawn as for the check of their response tables, presses from the speeds and arms of the slabs' ones.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.pad.axisymmetric.case import Case
from dummydesign.pad.axisymmetric.finite_strain import CELLS, nodes_of_motion, solve_ratio
from dummydesign.pad.material.relaxation import PronyTerm
from dummydesign.pad.predict import most_viscous, over_gel, slab_allowance
from studies.tables.designs import designs

KINDS = ("crowned", "layered", "boned")
PRESSES = 40
SEED = 20261122
DEPTHS = (0.1, 0.45)
SPEEDS_MM_S = (10.0, 50.0, 250.0)
# Where less than this share of the depth is reached forces are small and mostly mesh.
SMALLEST_DEPTH = 0.2


def measure_shape(
    press: Case, share: float, velocity_mm_s: float, prony: tuple[PronyTerm, ...], cells: int = CELLS
) -> dict[str, Any]:
    """Solve one press and hold of a shaped pad, and how far it leaves what is allowed for a slab so deep.

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
        A row: ``below`` the quick force and ``above`` what is allowed over it for a slab, as shares of the largest
        viscous force so far.

    Raises
    ------
    NoAnswerError
        When the motion cannot be followed.
    """
    h = press.thickness_mm
    deepest = share / over_gel(press.shape, h)
    motion = ramp_and_hold(velocity_mm_s, deepest * h)
    nodes = nodes_of_motion(motion.time_s, motion.displacement_mm / h, prony)
    path = solve_ratio(press, prony, *nodes, cells=cells)
    viscous = most_viscous(path.separable, path.elastic)
    args = (press.radius, path.depth * over_gel(press.shape, h), path.time_s, path.elastic, prony)
    _, above = slab_allowance("bonded", *args)
    inside = path.depth > SMALLEST_DEPTH * deepest
    over = (path.force - path.separable)[inside]
    peak = int(np.argmax(path.separable))
    return {
        "shape": str(press.shape),
        "thickness_mm": round(h, 3),
        "relative_depth": round(deepest, 4),
        "velocity_mm_s": velocity_mm_s,
        "below": round(float(np.max(-over / viscous[inside])), 4),
        "above": round(float(np.max((over - above[inside]) / viscous[inside])), 4),
        "error_at_peak": round(float(path.force[peak] / path.separable[peak] - 1.0), 4),
        "allowed_at_peak": round(float(above[peak] / path.separable[peak]), 4),
        "viscous_share_at_peak": round(float(viscous[peak] / path.separable[peak]), 4),
    }


def build_shapes(sets: dict[str, tuple[PronyTerm, ...]]) -> dict[str, list[dict[str, Any]]]:
    """One row a press in ``shapes``; presses without an answer, such as those that fold, in ``shapes_left_out``.

    Parameters
    ----------
    sets : dict
        Sets of arms by name.
    """
    rows: list[dict[str, Any]] = []
    left_out: list[dict[str, Any]] = []
    for kind in KINDS:
        rng = np.random.default_rng([SEED, KINDS.index(kind)])
        design = designs()[kind]
        for number, point in enumerate(design.fresh(PRESSES)):
            share, speed, arms = rng.uniform(*DEPTHS), float(rng.choice(SPEEDS_MM_S)), str(rng.choice(list(sets)))
            press = design.press(point)
            try:
                row = measure_shape(press, float(share), speed, sets[arms])
            except NoAnswerError as problem:
                h = press.thickness_mm
                row = {"shape": str(press.shape), "thickness_mm": round(h, 3), "velocity_mm_s": speed}
                row |= {"relative_depth": round(share / over_gel(press.shape, h), 4), "why": str(problem)}
                left_out.append({"kind": kind, "arms": arms, **row})
                print(f"{kind} {number}: {problem}", flush=True)
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
