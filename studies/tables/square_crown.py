"""Make the square-over-circle factor of crowned pads: ``python -m studies.tables.square_crown``.

A crown under the square punch is solved in space, an eighth of it, on the coarse cells of ``predict --fidelity 3d``,
the forefinger's on finer ones too. What cells and fillet take from the force is found in a meridian plane, under the
circle of the punch's area. The factor is checked blind: on crowns of another seed and the recommended ones, with half
the fillet and a third of the load step. Solves are kept in the store, one a line, so that a run goes on where it was
stopped.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from dummydesign.core.blas_threads import one_blas_thread
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.user_library import data_folder
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS, PUNCH_RADIUS_MM, PUNCH_SIDE_MM
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.axisymmetric.shaped_pad import LARGEST_STEP
from dummydesign.pad.contact.axisymmetric import SHAPED_PAD_IN_SPACE
from dummydesign.pad.fem.mesh_hexahedra import horizontal_faces, quarter
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.solve.continuation import follow
from dummydesign.pad.spatial.shaped_pad import (
    GridFineness,
    Load,
    axis_lines,
    contact_problem,
    correction_of,
    levels,
    round_twin,
)
from dummydesign.pad.tables.shape import load_shape_table
from dummydesign.pad.tables.square import CrownTable, crown_factor
from studies.tables.common import Build, write_table
from studies.tables.designs.crowned import DESIGN

Array = np.ndarray

SEED, FRESH_SEED, BLIND_SEED = 58, 1158, 77001
# Crowns that people's tissues lead to: thickness, tip radius, height, foot. [mm]
RECOMMENDED = ((4.5, 21.2, 2.0, 9.4), (11.0, 2.4, 3.5, 7.8), (13.5, 2.0, 4.3, 7.8))
# Recommended ones of the blind check, and grids.
BLIND = ((4.5, 21.2, 2.0, 9.4), (11.0, 3.3, 3.5, 7.8), (13.5, 2.0, 4.3, 7.8))
BLIND_GRID, FINER_GRID = GridFineness(5, rim=0.05, slope=0.84), GridFineness(7, rim=0.05)
# Largest load step and deepest depth of the parts that are not fitted; the forefinger's is solved on finer cells too.
STEP, SHORT = 0.08, {"blind": (0.02, 0.5), "finer": (0.02, 0.4)}
# Values are fitted from this share of the edge's depth, where cells and fillet take no more than a share of the force.
BEGINS, MOST_CORRECTED = 0.9, 0.08
# Stated errors: of all crowns, and more of thin pads whose foot is under the punch or near its edge. The blind crowns
# widened them: 83 % of their values were inside 0.025 with the second for feet near the edge alone.
ERROR, FOOT_ERROR = 0.03, 0.075
# Depths that are solved, from this share of that at which the circle's edge is reached to the deepest.
FIRST_SHARE, DEEPEST, DEPTHS = 0.8, 0.55, 7


# Parts of a square pad that mirror each other.
PARTS = 8.0


def solve_eighth(pad: Pad, depths: Array, grid: GridFineness, step: float) -> tuple[Array, Array, Array]:
    """Force of a square, round pad under a square punch over that of the circle of its area, and its correction.

    ``step`` is the largest of the load: what sticks remembers its path, with 0.06 instead of 0.02 the factor was up to
    2 % larger.
    """
    load = Load.of(pad, float(depths[0]))
    x, twin = axis_lines(load, grid, 0), round_twin(load, depths)
    assert twin is not None
    part = quarter(x, x, levels(load, grid), folded=True, bend=load.bend)
    base = np.unique(horizontal_faces(part.mesh, np.nonzero(part.lattice[0] == 0)[0], upper=False))
    strength = SHAPED_PAD_IN_SPACE.contact * load.law.shear_MPa / float(min(load.half_sides) / grid.cells)
    problem = contact_problem(load, part, base, part.share * strength, grid.rim * load.scale)
    path = follow(problem, twin.depths, 0.25 * depths[0], step * load.scale, depths[0] / 256.0)
    correction, reached = correction_of(load, grid, twin, min(step, LARGEST_STEP)), slice(len(path.force))
    factor = PARTS * path.force / twin.force[reached] * np.exp(correction[reached])
    return twin.depths[reached], factor, correction[reached]


def drawn_pads(count: int, seed: int) -> list[tuple[float, ...]]:
    """Castable crowns of a Latin hypercube over the response table's numbers."""
    raw = qmc.LatinHypercube(4, seed=seed).random(8 * count)
    points = DESIGN.low + (DESIGN.high - DESIGN.low) * raw
    points[:, 3] = DESIGN.low[3] * (DESIGN.high[3] / DESIGN.low[3]) ** raw[:, 3]
    table, pads = load_shape_table("crowned"), []
    for point in (point for point in points if DESIGN.castable(point)):
        shape, h = DESIGN.shape(point)
        if table.inside(numbers_of(shape, h)).all():
            pads.append((h, shape.radius_mm, shape.height_mm, shape.foot_mm))
    return pads[:count]


def blind_pads(count: int) -> list[tuple[float, ...]]:
    """Drawn crowns, and of many more the thinnest, the thickest and those with the smallest and the largest foot."""
    drawn = drawn_pads(400, BLIND_SEED)
    rest = drawn[count:]
    return drawn[:count] + [best(rest, key=lambda pad: pad[at]) for at in (0, 3) for best in (min, max)]


def numbers_of(shape: Crowned, thickness_mm: float) -> Array:
    """Numbers of the response table, shape (1, 4)."""
    given = {name: np.array([value]) for name, value in shape.parameters}
    return Crowned.numbers(given, np.array([thickness_mm]), PUNCH_RADIUS_MM)


def solve_one(pad: tuple[float, ...], fineness: GridFineness, step: float, deepest: float) -> dict[str, Any]:
    """Solve one crown: factor over the circle of equal area at depths over the thickness."""
    thickness, shape = pad[0], Crowned(*pad[1:])
    table, inputs = load_shape_table("crowned"), numbers_of(shape, thickness)
    edge = float(table.response.edge(table.coordinates(inputs))[0])
    last = float(min(deepest, table.depth_limit(inputs)[0]))
    depth = np.linspace(min(FIRST_SHARE * edge, 0.5 * last), last, DEPTHS)
    side = EXTENT_OVER_RADIUS * PUNCH_RADIUS_MM * np.sqrt(np.pi)
    own = Pad(thickness, 1.0, PUNCH_RADIUS_MM, geometry=shape, sides_mm=(PUNCH_SIDE_MM,) * 2, slab_mm=(side, side))
    began = time.process_time()
    reached, factor, correction = solve_eighth(own, depth, fineness, step)
    row = {"pad": pad, "cells": fineness.cells, "edge": edge, "depth": reached, "factor": factor}
    row |= {"correction": correction, "seconds": time.process_time() - began}
    return {
        name: np.round(value, 5).tolist() if isinstance(value, np.ndarray) else value for name, value in row.items()
    }


def rows_of(lines: list[dict[str, Any]], part: str) -> list[tuple[tuple[float, ...], Array, Array]]:
    """Crowns, depths over the thickness and factors of a part, where the edge matters and the mesh does not."""
    rows = []
    for line in lines:
        depth, correction = np.array(line.get("depth", [])), np.array(line.get("correction", []))
        kept = (depth > BEGINS * line.get("edge", 1.0)) & (np.abs(correction) < MOST_CORRECTED)
        if line["part"] == part and kept.any():
            rows.append((tuple(line["pad"]), depth[kept], np.array(line["factor"])[kept]))
    return rows


def misfit(table: CrownTable, rows: list[tuple[tuple[float, ...], Array, Array]]) -> tuple[Array, Array]:
    """ln of fitted over solved factors, and the stated errors."""
    away, stated = [], []
    for (h, *crown), depth, factor in rows:
        named = dict(zip(("radius", "height", "foot"), crown))
        value, error = crown_factor(depth * h, h, PUNCH_RADIUS_MM, named, table)
        away.append(np.log(value / factor))
        stated.append(error)
    return np.concatenate(away), np.concatenate(stated)


def fit(lines: list[dict[str, Any]]) -> dict[str, Any]:
    """Fit the six numbers of the factor, by least squares that outliers do not lead."""
    rows = rows_of(lines, "fit")

    def table(numbers: Array) -> CrownTable:
        return CrownTable(numbers, ERROR, FOOT_ERROR)

    found = least_squares(lambda x: misfit(table(x), rows)[0] / 0.01, np.zeros(6), loss="soft_l1", diff_step=1e-4)
    checks = {}
    for part in ("fit", "fresh", "blind", "finer"):
        away, stated = misfit(table(found.x), rows_of(lines, part))
        checks[part] = {
            "forces": len(away),
            "inside_stated_error": round(float(np.mean(np.abs(away) <= stated)), 3),
            "rms": round(float(np.sqrt(np.mean(away**2))), 4),
            "error_of_95_percent": round(float(np.quantile(np.abs(away), 0.95)), 4),
            "largest": round(float(np.max(np.abs(away))), 4),
        }
    return {
        "coefficients": np.round(found.x, 5).tolist(),
        "error": ERROR,
        "foot_error": FOOT_ERROR,
        "provenance": {"seed": SEED, "fresh_seed": FRESH_SEED, "blind_seed": BLIND_SEED, **checks},
        "values": lines,
    }


def main(arguments: list[str] | None = None) -> None:
    """Solve what the store lacks, then fit and write the table."""
    parser = argparse.ArgumentParser(description="Make the square-over-circle factor of crowned pads.")
    parser.add_argument("--count", type=int, default=24, help="drawn crowns that are fitted")
    parser.add_argument("--fresh", type=int, default=8, help="drawn crowns that check the fit")
    parser.add_argument(
        "--blind", type=int, default=12, help="drawn crowns that check it blind, besides four at the rims"
    )
    parser.add_argument("--store", type=Path, default=Path("square-crown-solves.jsonl"))
    options = parser.parse_args(arguments)
    build = Build.begin("studies.tables.square_crown", arguments)
    coarse = GridFineness().coarser()
    fitted, fresh = drawn_pads(options.count, SEED), drawn_pads(options.fresh, FRESH_SEED)
    tasks = [(pad, "fit", coarse) for pad in RECOMMENDED]
    tasks += [(RECOMMENDED[0], "fit", one) for one in (GridFineness(), GridFineness(9, slope=0.6))]
    for number, pad in enumerate(fitted):
        tasks.append((pad, "fit", coarse))
        if number % 3 == 2 and fresh:
            tasks.append((fresh.pop(0), "fresh", coarse))
    lines = options.store.read_text(encoding="utf-8").splitlines() if options.store.exists() else []
    tasks += [(pad, "blind", BLIND_GRID) for pad in (*BLIND, *blind_pads(options.blind))]
    tasks.append((BLIND[0], "finer", FINER_GRID))
    done = {(row["part"], tuple(row["pad"]), row["cells"]) for row in map(json.loads, lines)}
    with one_blas_thread():
        for pad, part, fineness in tasks:
            if (part, pad, fineness.cells) in done:
                continue
            try:
                row = solve_one(pad, fineness, *SHORT.get(part, (STEP, DEEPEST)))
            except NoAnswerError as problem:
                row = {"pad": pad, "cells": fineness.cells, "stop": str(problem)}
            with options.store.open("a", encoding="utf-8") as store:
                store.write(json.dumps({"part": part, **row}) + "\n")
    lines = [json.loads(line) for line in options.store.read_text(encoding="utf-8").splitlines()]
    content = fit(lines)
    write_table(data_folder() / "materials" / "tables" / "square-crowned.json", content, build, SEED)
    print(content["provenance"])


if __name__ == "__main__":
    main()
