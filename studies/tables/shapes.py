"""Make the response tables of shaped pads: ``python -m studies.tables.shapes crowned``.

Shapes are taken from a Sobol sequence over the table's ranges, as far as they can be cast. Solved curves are kept
line by line in a file of their own, so that a build can be interrupted and taken up again.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.user_library import data_folder
from dummydesign.geometry.dimensions import EXTENT_OVER_RADIUS
from dummydesign.pad.axisymmetric.shaped_pad import EDGE_ERROR, LEAST_ERROR
from dummydesign.pad.tables.crowned import Response
from dummydesign.pad.tables.shape import ShapeTable, Surface, from_dict
from studies.tables.common import Build, write_table
from studies.tables.designs import designs
from studies.tables.designs.base import COMPLETE, FIRST_SEED, Design

Array = np.ndarray
# A curve that ends before this d / h is not used.
LEAST_DEPTH = 0.2


def _gather(design: Design, points: Array, store: Path, workers: int, finer: bool = False) -> list[dict[str, Any]]:
    """Solve the points that the store does not hold yet (none with 0 workers); answers in the points' order."""
    known: dict[tuple[str, ...], dict[str, Any]] = {}

    def key(point: Array) -> tuple[str, ...]:
        return tuple(f"{x:.6f}" for x in point)

    if store.exists():
        for line in store.read_text(encoding="utf-8").splitlines():
            answer = json.loads(line)
            known[key(answer["point"])] = answer
    missing = [point for point in points if key(point) not in known] if workers else []
    store.parent.mkdir(parents=True, exist_ok=True)
    work = partial(design.solve, finer=finer)
    with ProcessPoolExecutor(workers or 1) as pool, store.open("a", encoding="utf-8") as file:
        for done, job in enumerate(as_completed([pool.submit(work, point) for point in missing]), 1):
            try:
                answer = job.result()
            except Exception as problem:  # one curve that fails must not end hours of others
                print(f"{done}: {problem}", file=sys.stderr)
                continue
            known[key(answer["point"])] = answer
            file.write(json.dumps(answer) + "\n")
            file.flush()
            reach = [len(force) for force in answer["force"]]
            print(f"{done} of {len(missing)}: reached {reach} depths", file=sys.stderr)
    return [known[key(point)] for point in points if key(point) in known]


def content(
    design: Design,
    answers: list[dict[str, Any]],
    checks: list[dict[str, Any]],
    finer: list[dict[str, Any]],
    twins: list[dict[str, Any]],
) -> dict[str, Any]:
    """Fit the response surface, measure its error on fresh solves, and return what goes into the file.

    Parameters
    ----------
    design : Design
        What is tabulated.
    answers, checks : list of dict
        Solves of the design and of the fresh points, from :func:`_gather`.
    finer, twins : list of dict
        The same pads on cells of half the size and as all others.
    """
    depths = design.depths
    surface = design.surface(answers)
    at = np.array([answer["point"] for answer in checks])
    fresh_values, added = design.at_depths(checks, depths)
    mesh = _rms(np.log(design.at_depths(finer, depths)[0] / design.at_depths(twins, depths)[0]))
    reach = design.reach(design.at_depths(answers, depths)[0], depths)
    unknown = [1.0] * len(depths)
    data = {
        "kind": design.kind,
        "condition": "bonded",
        "meaning": design.meaning,
        "low": _list(design.plain(design.low + design.margin), 4),
        "high": _list(design.plain(design.high - design.margin), 4),
        "error_depth": _list(depths, 4),
        "median_error": unknown,
        "error": unknown,
        "solve_error": _list(_filled(LEAST_ERROR + mesh + EDGE_ERROR * _rms(added)), 3),
        "surface": to_dict(surface),
        "provenance": {},
    }
    miss = _missed(design, from_dict(data), at, fresh_values)
    provenance = {
        "law": "neo-Hookean, incompressible",
        "punch": design.punch,
        "base": "bonded",
        "extent_over_radius": EXTENT_OVER_RADIUS,
        design.cells_are: design.cells,
        "design": "Sobol sequence over the ranges, castable under a 14 x 14 mm punch",
        "curves": len(answers),
        "curves_that_stopped_early": int((reach < COMPLETE).sum()),
        "fresh_curves": len(checks),
        "fresh_seed": design.seed,
        "fresh_curves_on_half_the_cells": len(finer),
        "median_error": float(f"{np.nanmedian(miss):.3g}"),
        "error_of_95_percent": float(f"{np.nanpercentile(miss, 95.0):.3g}"),
        "largest_error": float(f"{np.nanmax(miss):.3g}"),
    }
    return {
        **data,
        "median_error": _list(_filled(np.nanmedian(miss, axis=0)), 3),
        "error": _list(_filled(np.nanpercentile(miss, 95.0, axis=0)), 3),
        "fresh": {"points": _list(at, 7), "values": _list(fresh_values, 6)},
        "provenance": provenance,
    }


def _missed(design: Design, table: ShapeTable, points: Array, values: Array) -> Array:
    """Relative errors of a table at solves (n, depths); NaN beyond the limit that it states itself."""
    depths, plain = design.depths, np.array([design.plain(point) for point in points])
    row = np.broadcast_to(np.arange(len(points))[:, None], values.shape)
    answered = table.log_factor(plain, row, np.broadcast_to(depths, values.shape))
    miss = np.abs(np.expm1(answered - design.reduced(points, values, depths)))
    return np.where(depths[None, :] <= table.depth_limit(plain)[:, None] * (1.0 + 1e-9), miss, np.nan)


def to_dict(surface: Surface) -> dict[str, Any]:
    """A surface, or each of its pieces, as short numbers for a file."""
    if not isinstance(surface, Response):
        return {part.name: to_dict(getattr(surface, part.name)) for part in fields(surface)}
    digits = {"levels": 4, "reach": 4}
    numbers = {
        part.name: _list(np.asarray(getattr(surface, part.name)), digits.get(part.name, 9))
        for part in fields(surface)
        if part.name != "anchored"
    }
    # Weights of long kernels are large and cancel: what counts is their last decimal, not their digits.
    fixed = {name: np.round(getattr(surface, name), 6).tolist() for name in ("weights", "trend")}
    return {**numbers, **fixed, "anchored": surface.anchored}


def _deepest(design: Design, answer: dict[str, Any]) -> float:
    """d / h that both paths of a pad reached."""
    count = min(len(row) for row in answer["force"])
    return float(answer.get("depth", design.depths)[count - 1]) if count else 0.0


def _rms(values: Array) -> Array:
    return np.sqrt(np.nanmean(values**2, axis=0))


def _filled(errors: Array) -> Array:
    """Errors at depths where nothing was measured take the largest measured one."""
    return np.where(np.isfinite(errors), errors, np.nanmax(errors))


def _list(values: Array, digits: int) -> list[Any]:
    """Nested lists of short numbers; None where not a number."""
    if values.ndim > 1:
        return [_list(row, digits) for row in values]
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values]


def main(arguments: list[str] | None = None) -> None:
    """Solve what is missing and write the table."""
    parser = argparse.ArgumentParser(description="Make a response table of shaped pads by finite elements.")
    parser.add_argument("kind", choices=tuple(designs()))
    parser.add_argument("--count", type=int, help="shapes that are solved")
    parser.add_argument("--fresh", type=int, help="further random shapes, for the table's error")
    parser.add_argument("--finer", type=int, help="of these on smaller cells, for the elements' error")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--store", type=Path, help="file that keeps solves (KIND-solves.jsonl)")
    parser.add_argument("--no-solve", action="store_true", help="use what the store holds")
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    build = Build.begin("studies.tables.shapes", arguments)
    design, workers = designs()[options.kind], 0 if options.no_solve else options.workers
    asked = (options.count, options.fresh, options.finer)
    count, fresh, finer = (v or w for v, w in zip(asked, design.usual))
    store = options.store or Path(f"{options.kind}-solves.jsonl")
    checks = _gather(design, design.fresh(fresh), store, workers)
    again = design.fresh(finer, FIRST_SEED)
    fine = _gather(design, again, store.with_suffix(".finer.jsonl"), workers, True)
    twins = _gather(design, np.array([answer["point"] for answer in fine]), store, workers)
    solved = _gather(design, design.points(count), store, workers)
    answers = [answer for answer in solved if _deepest(design, answer) >= LEAST_DEPTH]
    if len(answers) < len(solved):
        # Contact that flickers near the edge ends a path early; that says nothing of how deep such pads go.
        print(f"{len(solved) - len(answers)} pads ended before d/h {LEAST_DEPTH} and are left out", file=sys.stderr)
    table = content(design, answers, checks, fine, twins)
    write_table(options.out / f"{options.kind}-bonded.json", table, build)
    print(json.dumps(table["provenance"], indent=1))


if __name__ == "__main__":
    main()
