"""Build the tables of plate friction of pucks: ``python -m studies.tables.puck [--shapes]``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.user_library import table_path
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Puck
from dummydesign.pad.tables.puck import (
    COMMAND,
    DIAMETER_MM,
    HEIGHT_MM,
    OTHERS,
    USUAL,
    PuckTable,
    grip,
    table_for,
    uniaxial,
)
from studies.tables.common import Build, write_table

Array = np.ndarray

MEANING = (
    "ln B[alpha, grip, compression]; B = force over that between frictionless plates, one-term Ogden; solved[alpha, "
    "grip] compressions are solved, the others lie between their neighbours in friction"
)
ALPHAS = (1.0, 2.0, 3.0, 4.0, 6.0)
FRICTIONS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, np.inf)
COMPRESSIONS = np.concatenate([[0.005, 0.01, 0.02], np.arange(0.04, 0.581, 0.02)])
# Largest difference of ln B at which an earlier value is kept.
AGREE = 0.02
SHAPE_STEP = 1.3
OTHER_SHAPES = tuple(0.5 * DIAMETER_MM / HEIGHT_MM * SHAPE_STEP**k for k in (-3, -2, -1, 1, 2, 3))


def solve_grid(radius_over_height: float, alphas: Sequence[float], frictions: Sequence[float]) -> Array:
    """Solve ln B of one shape of puck over alpha, friction and compression; NaN beyond the end of a curve.

    Parameters
    ----------
    radius_over_height : float
        Radius of the undeformed puck over its height.
    alphas : sequence of float
        Exponents of the one-term Ogden law.
    frictions : sequence of float
        Coefficients of friction of the plates, ``inf`` for bonded.

    Returns
    -------
    ndarray
        (alphas, frictions, compressions).
    """
    area = np.pi * radius_over_height**2
    log_factor = np.full((len(alphas), len(frictions), len(COMPRESSIONS)), np.nan)
    for (i, alpha), (j, friction) in product(enumerate(alphas), enumerate(frictions)):
        plates = "bonded" if np.isinf(friction) else f"friction:{friction:g}"
        law = Ogden([2.0 / alpha], [alpha])
        curve = solve_puck(Puck(1.0, 3.0, 2.0 * radius_over_height, plates=plates, law=law), COMPRESSIONS)
        count = len(curve.depth_mm)
        log_factor[i, j, :count] = np.log(curve.force_N / (3.0 * area * uniaxial(alpha, curve.depth_mm)))
        seconds = curve.solver["seconds"]
        print(f"alpha {alpha:g}, {plates}: {count} of {len(COMPRESSIONS)}, {seconds:.1f} s", flush=True)
    return log_factor


def filled(log_factor: Array, grips: Array) -> Array:
    """The rows of one law over friction and compression, each continued beyond the end of its curve.

    A row goes on between the nearest rows that are complete, at the share of their distance that it ended with, so
    that the force has no step there; the row that got farthest comes first.

    Parameters
    ----------
    log_factor : ndarray
        (grips, compressions), NaN beyond the end of a curve; the first and the last row are complete.
    grips : ndarray
        Rising, of the rows.

    Returns
    -------
    ndarray
        (grips, compressions).
    """
    rows = log_factor.copy()
    count = np.isfinite(rows).sum(axis=1)
    complete = sorted(np.nonzero(count == rows.shape[1])[0])
    for j in sorted(set(range(len(rows))) - set(complete), key=lambda j: -count[j]):
        below, above = (max(k for k in complete if k < j), min(k for k in complete if k > j))
        low, span, last = rows[below], rows[above] - rows[below], count[j] - 1
        share = (grips[j] - grips[below]) / (grips[above] - grips[below])
        if last >= 0:
            share = (rows[j, last] - low[last]) / span[last]
        rows[j, last + 1 :] = (low + share * span)[last + 1 :]
        complete.append(j)
    return rows


def agreed(before: PuckTable, solved: Array) -> Array:
    """Values (alphas, frictions, compressions) of an earlier table as far as solves made now agree with them.

    A curve that ends early is solved again with larger cells, which bend round the plate's edge later: where the side
    comes to lie on the plates that moves the force by up to 0.9 %. Earlier values stay to the first that is more than
    ``AGREE`` away from the solve of now.
    """
    earlier = np.full(solved.shape, np.nan)
    earlier[..., : len(before.compression)] = before.log_factor[:, 1:]
    apart = ~(np.abs(earlier - solved) < AGREE)
    return np.where(np.cumsum(apart, axis=-1) > 0, np.nan, earlier)


def assembled(
    radius_over_height: float, alphas: Sequence[float], frictions: Sequence[float], solved: Array
) -> tuple[PuckTable, Array]:
    """Table and numbers of solved compressions (alphas, grips) of solved curves, see :func:`solve_grid`.

    Frictionless plates are added in closed form. The table ends where the bonded puck of some alpha ends: flat pucks
    fold at the edge before 58 %.

    Raises
    ------
    NoAnswerError
        When a bonded puck ends before 30 %.
    """
    log_factor = np.concatenate([np.zeros_like(solved[:, :1]), solved], axis=1)
    reached = ~np.isnan(log_factor[:, -1]).any(axis=0)
    log_factor, strains = log_factor[..., reached], COMPRESSIONS[reached]
    if not strains.size or strains[-1] < 0.3:
        message = "the bonded puck could not be compressed to 30 %"
        raise NoAnswerError("no_convergence", message, quantity="force_N")
    grips = np.concatenate([[0.0], grip(np.array(frictions))])
    rows = np.array([filled(row, grips) for row in log_factor])
    return PuckTable(radius_over_height, np.array(alphas), grips, strains, rows), np.isfinite(log_factor).sum(axis=2)


def build(
    radius_over_height: float, alphas: Sequence[float] = ALPHAS, frictions: Sequence[float] = FRICTIONS
) -> PuckTable:
    """Solve the table for one shape of puck, arguments as in :func:`solve_grid`; 1 to 3 s for each curve."""
    solved = solve_grid(radius_over_height, alphas, frictions)
    return assembled(radius_over_height, alphas, frictions, solved)[0]


def _content(table: PuckTable, solved: Array) -> dict[str, Any]:
    return {
        "radius_over_height": round(table.radius_over_height, 8),
        "alpha": table.alpha.tolist(),
        "grip": np.round(table.grip, 6).tolist(),
        "compression": np.round(table.compression, 4).tolist(),
        "solved": solved.tolist(),
        "log_factor": np.round(table.log_factor, 5).tolist(),
    }


def main() -> None:
    """Build the table of the 50 x 30 mm shape, or those of the other proportions, and write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shapes", action="store_true", help="the other proportions")
    parser.add_argument("--keep", action="store_true", help="keep the file's values where solves made now agree")
    options = parser.parse_args()
    run = Build.begin("studies.tables.puck")
    content: dict[str, Any] = {"schema": "dummydesign.puck-table/1", "command": COMMAND, "meaning": MEANING}
    shapes = OTHER_SHAPES if options.shapes else (0.5 * DIAMETER_MM / HEIGHT_MM,)
    made = []
    for one in shapes:
        solved = solve_grid(one, ALPHAS, FRICTIONS)
        if options.keep:
            solved = agreed(table_for(2.0 * one, 1.0), solved)
        made.append(_content(*assembled(one, ALPHAS, FRICTIONS, solved)))
    if options.shapes:
        content |= {"command": f"{COMMAND} --shapes", "shapes": made}
    else:
        content |= made[0] | {"radius_over_height": shapes[0]}
    write_table(table_path(OTHERS if options.shapes else USUAL), content, run)


if __name__ == "__main__":
    main()
