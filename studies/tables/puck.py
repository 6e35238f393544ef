"""Build the tables of plate friction of pucks: ``python -m studies.tables.puck [--shapes]``."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

import numpy as np

from dummydesign.core.errors import NoAnswerError
from dummydesign.core.library import table_path
from dummydesign.pad.axisymmetric.puck import solve_puck
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.specimen import Puck
from dummydesign.pad.tables.puck import (
    COMMAND,
    DIAMETER_MM,
    HEIGHT_MM,
    OTHERS,
    SHAPE_STEP,
    USUAL,
    PuckTable,
    grip,
    uniaxial,
)
from studies.tables.common import Build, write_table

ALPHAS = (1.0, 2.0, 3.0, 4.0, 6.0)
FRICTIONS = (0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, np.inf)
COMPRESSIONS = np.concatenate([[0.005, 0.01, 0.02], np.arange(0.04, 0.581, 0.02)])
OTHER_SHAPES = tuple(0.5 * DIAMETER_MM / HEIGHT_MM * SHAPE_STEP**k for k in (-3, -2, -1, 1, 2, 3))


def build(
    radius_over_height: float, alphas: Sequence[float] = ALPHAS, frictions: Sequence[float] = FRICTIONS
) -> PuckTable:
    """Solve the table for one shape of puck; 2 to 5 s for each pair of alpha and friction.

    A compression that one friction does not reach is filled in between its neighbours in friction; the table
    ends where the bonded puck of some alpha ends (flat pucks fold at the edge before 58 %).

    Parameters
    ----------
    radius_over_height : float
        Radius of the undeformed puck over its height.
    alphas : sequence of float
        Exponents of the one-term Ogden law.
    frictions : sequence of float
        Coefficients of friction of the plates, ``inf`` for bonded; frictionless is added in closed form.

    Returns
    -------
    PuckTable

    Raises
    ------
    NoAnswerError
        When a bonded puck ends before 30 %.
    """
    area = np.pi * radius_over_height**2
    log_factor = np.zeros((len(alphas), len(frictions) + 1, len(COMPRESSIONS)))
    for i, alpha in enumerate(alphas):
        for j, friction in enumerate(frictions, start=1):
            plates = "bonded" if np.isinf(friction) else f"friction:{friction:g}"
            law = Ogden([2.0 / alpha], [alpha])
            curve = solve_puck(Puck(1.0, 3.0, 2.0 * radius_over_height, plates=plates, law=law), COMPRESSIONS)
            count = len(curve.depth_mm)
            free = 3.0 * area * uniaxial(alpha, curve.depth_mm)
            log_factor[i, j, :count] = np.log(curve.force_N / free)
            log_factor[i, j, count:] = np.nan
            seconds = curve.solver["seconds"]
            print(f"alpha {alpha:g}, {plates}: {count} of {len(COMPRESSIONS)}, {seconds:.1f} s", flush=True)
    grips = np.concatenate([[0.0], grip(np.array(frictions))])
    reached = ~np.isnan(log_factor[:, -1]).any(axis=0)
    log_factor, compressions = log_factor[..., reached], COMPRESSIONS[reached]
    if not compressions.size or compressions[-1] < 0.3:
        message = "the bonded puck could not be compressed to 30 %"
        raise NoAnswerError("no_convergence", message, quantity="force_N")
    for row in log_factor:
        for column in row.T:
            known = ~np.isnan(column)
            column[~known] = np.interp(grips[~known], grips[known], column[known])
    return PuckTable(radius_over_height, np.array(alphas), grips, compressions, log_factor)


def _content(table: PuckTable) -> dict[str, Any]:
    return {
        "radius_over_height": round(table.radius_over_height, 8),
        "alpha": table.alpha.tolist(),
        "grip": np.round(table.grip, 6).tolist(),
        "compression": np.round(table.compression, 4).tolist(),
        "log_factor": np.round(table.log_factor, 5).tolist(),
    }


def main() -> None:
    """Build the table of the 50 x 30 mm shape, or those of the other proportions, and write it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shapes", action="store_true", help="the other proportions")
    options = parser.parse_args()
    run = Build.begin("studies.tables.puck")
    meaning = "ln B[alpha, grip, compression]; B = force over that between frictionless plates, one-term Ogden"
    content: dict[str, Any] = {"schema": "dummydesign.puck-table/1", "command": COMMAND, "meaning": meaning}
    if options.shapes:
        content |= {"command": f"{COMMAND} --shapes", "shapes": [_content(build(shape)) for shape in OTHER_SHAPES]}
        write_table(table_path(OTHERS), content, run)
    else:
        shape = 0.5 * DIAMETER_MM / HEIGHT_MM
        content |= _content(build(shape)) | {"radius_over_height": shape}
        write_table(table_path(USUAL), content, run)


if __name__ == "__main__":
    main()
