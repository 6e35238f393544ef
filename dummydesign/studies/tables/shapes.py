"""Make the response tables of shaped pads: ``python -m dummydesign.studies.tables.shapes crowned``.

Shapes are taken from a Sobol sequence over the table's ranges, as far as they can be cast. Solved curves are kept
line by line in a file of their own, so that a build can be interrupted and taken up again.
"""

from __future__ import annotations

import argparse
import json
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from dummydesign.core.datafiles import data_folder
from dummydesign.pad.shaped.axisymmetric import EDGE_ERROR, LEAST_ERROR
from dummydesign.pad.tables.response_surface import fit
from dummydesign.studies.tables.common import Build, write_table
from dummydesign.studies.tables.designs import Design, designs
from dummydesign.studies.tables.designs.base import EXTENT_OVER_RADIUS

Array = np.ndarray
# What a curve that reached the last depth counts in the mean that limits the table's depth.
COMPLETE = 0.7
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
            print(f"{done} of {len(missing)}: reached {reach} of {len(design.depths)} depths", file=sys.stderr)
    return [known[key(point)] for point in points if key(point) in known]


def values_of(design: Design, answers: list[dict[str, Any]]) -> tuple[Array, Array, Array]:
    """Points, forces (crowned, with a sharp edge) or factors at the depths, and what the edge added, relative."""
    points = np.array([answer["point"] for answer in answers])
    rows, added = [], []
    for answer in answers:
        padded = [np.array(row + [np.nan] * (len(design.depths) - len(row)), dtype=float) for row in answer["force"]]
        value, edge = design.joined(padded)
        rows.append(value)
        added.append(edge)
    return points, np.array(rows), np.array(added)


def reduced(design: Design, points: Array, values: Array) -> Array:
    """ln of F over Hertz's force of the tip (crowned), or of the factor.

    Parameters
    ----------
    design : Design
        The table's design: its depths and similarity numbers.
    points : ndarray, shape (n, k)
        Design points; column 0 is ln h / a.
    values : ndarray, shape (n, depths)
        Force over E a^2, or the factor on the slab's force.

    Returns
    -------
    ndarray, shape (n, depths)
    """
    if not design.similarity.over_tip:
        return np.log(values)
    h = np.exp(points[:, 0])
    return np.log(values / (16.0 / 9.0 * np.sqrt(design.tips(points))[:, None] * (design.depths * h[:, None]) ** 1.5))


def content(
    design: Design, answers: list[dict[str, Any]], checks: list[dict[str, Any]], finer: list[dict[str, Any]]
) -> dict[str, Any]:
    """Fit the response surface, measure its error on fresh solves, and return what goes into the file.

    Parameters
    ----------
    design : Design
        What is tabulated.
    answers, checks : list of dict
        Solves of the design and of the fresh points, from :func:`_gather`.
    finer : list of dict
        Some of the fresh points on cells of half the size.
    """
    depths = design.depths
    points, values, added = values_of(design, answers)
    rows = reduced(design, points, values)
    reach = np.array([depths[np.isfinite(row)][-1] for row in rows])
    reach = np.where(reach >= depths[-1], COMPLETE, reach)
    levels, rows = design.over_levels(points, rows)
    low, high = (design.coordinates(end[None])[0] for end in (design.low, design.high))
    anchored = design.similarity.over_tip
    surface = fit(design.coordinates(points), rows, levels, low, high, anchored, reach)
    short = {name: _shorter(getattr(surface, name), 7) for name in ("trend", "weights", "lengths")}
    surface = replace(surface, **short)
    at, fresh_values, _ = values_of(design, checks)
    checked = design.coordinates(at)
    place = np.broadcast_to(np.arange(len(at))[:, None], fresh_values.shape)
    answered, _ = surface.along(surface.at_levels(checked), place, depths / design.depth_unit(at))
    miss = np.abs(np.expm1(answered - reduced(design, at, fresh_values)))
    # Judged where the table answers: within the limit it states itself.
    miss = np.where(depths[None, :] <= surface.limit(checked)[:, None] * (1.0 + 1e-9), miss, np.nan)
    places, fine_values, _ = values_of(design, finer)
    twin = np.array([np.abs(at - place).sum(1).argmin() for place in places])
    mesh = _rms(np.log(fine_values / fresh_values[twin]))
    return {
        "kind": design.kind,
        "condition": "bonded",
        "meaning": design.meaning,
        "low": _list(design.plain(design.low + design.margin), 4),
        "high": _list(design.plain(design.high - design.margin), 4),
        "error_depth": _list(depths, 4),
        "median_error": _list(_filled(np.nanmedian(miss, axis=0)), 3),
        "error": _list(_filled(np.nanpercentile(miss, 95.0, axis=0)), 3),
        "solve_error": _list(_filled(LEAST_ERROR + mesh + EDGE_ERROR * _rms(added)), 3),
        "surface": {
            "low": _list(surface.low, 9),
            "high": _list(surface.high, 9),
            "lengths": _list(surface.lengths, 7),
            "centres": _list(surface.centres, 7),
            "levels": _list(levels, 4),
            "trend": _list(surface.trend, 7),
            "weights": _list(surface.weights, 7),
            "reach": _list(surface.reach, 4),
            "anchored": anchored,
        },
        "fresh": {"points": _list(at, 7), "values": _list(fresh_values, 6)},
        "provenance": {
            "law": "neo-Hookean, incompressible",
            "punch": design.punch,
            "base": "bonded",
            "extent_over_radius": EXTENT_OVER_RADIUS,
            "cells_under_punch": design.cells,
            "design": "Sobol sequence over the ranges, castable under a 14 x 14 mm punch",
            "curves": len(answers),
            "curves_that_stopped_early": int((reach < COMPLETE).sum()),
            "fresh_curves": len(checks),
            "fresh_curves_on_half_the_cells": len(finer),
            "median_error": float(f"{np.nanmedian(miss):.3g}"),
            "error_of_95_percent": float(f"{np.nanpercentile(miss, 95.0):.3g}"),
            "largest_error": float(f"{np.nanmax(miss):.3g}"),
        },
    }  # fmt: skip


def _rms(values: Array) -> Array:
    return np.sqrt(np.nanmean(values**2, axis=0))


def _filled(errors: Array) -> Array:
    """Errors at depths where nothing was measured take the largest measured one."""
    return np.where(np.isfinite(errors), errors, np.nanmax(errors))


def _shorter(values: Array, digits: int) -> Array:
    return np.array([float(f"{value:.{digits}g}") for value in values.ravel()]).reshape(values.shape)


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
    build = Build.begin("dummydesign.studies.tables.shapes", arguments)
    design, workers = designs()[options.kind], 0 if options.no_solve else options.workers
    asked = (options.count, options.fresh, options.finer)
    count, fresh, finer = (v or w for v, w in zip(asked, design.usual))
    store = options.store or Path(f"{options.kind}-solves.jsonl")
    checks = _gather(design, design.fresh(fresh), store, workers)
    fine = _gather(design, design.fresh(finer), store.with_suffix(".finer.jsonl"), workers, True)
    solved = _gather(design, design.points(count), store, workers)
    shallow = int((design.depths < LEAST_DEPTH).sum())
    answers = [answer for answer in solved if min(len(row) for row in answer["force"]) > shallow]
    if len(answers) < len(solved):
        # Contact that flickers near the edge ends a path early; that says nothing of how deep such pads go.
        print(f"{len(solved) - len(answers)} pads ended before d/h {LEAST_DEPTH} and are left out", file=sys.stderr)
    table = content(design, answers, checks, fine)
    write_table(options.out / f"{options.kind}-bonded.json", table, build)
    print(json.dumps(table["provenance"], indent=1))


if __name__ == "__main__":
    main()
