"""Make the response tables of shaped pads: ``python -m dummydesign.pad.build_shape_table crowned``.

Shapes are taken from a Sobol sequence over the table's ranges, as far as they can be cast; each is solved with
two beads at the punch's edge. Solved curves are kept line by line in a file of their own, so that a build can
be interrupted and taken up again.
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

from dummydesign import __version__
from dummydesign.errors import InputError
from dummydesign.files import write_text
from dummydesign.library import data_folder
from dummydesign.pad.laws import Yeoh
from dummydesign.pad.response import fit
from dummydesign.pad.shaped import CELLS, EDGE_ERROR, LEAST_ERROR, RIMS, Press, climb, sharp
from dummydesign.shape import Crowned

Array = np.ndarray

# The punch of the tables, which makes castability (in mm) a matter of ratios: 14 x 14 mm as a circle.
RADIUS_MM = 14.0 / float(np.sqrt(np.pi))
EXTENT_OVER_RADIUS = float(np.sqrt(150.0 * 120.0)) / 14.0
DEPTHS = np.array([0.02, 0.04, 0.07, 0.1, 0.14, 0.18, 0.22, 0.26, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6])
# Levels of the response surface: depth over the height of the crown.
LEVELS = np.array(
    [0.03, 0.06, 0.1, 0.16, 0.23, 0.32, 0.42, 0.53, 0.65, 0.78, 0.92, 1.07, 1.25, 1.45, 1.7, 2.0, 2.4, 2.9, 3.5]
)
# Curves that reached the last depth are carried on straight to here, so that the surface has no free end.
CARRIED_ON = 0.9
# What a curve that reached the last depth counts in the mean that limits the table's depth.
COMPLETE = 0.7
# Solved a little beyond what the table offers, so that its ends lie inside.
LOW = np.array([np.log(0.48), 0.17, np.log(0.36), 0.085])
HIGH = np.array([np.log(3.3), 0.78, np.log(1.8), 0.72])
MARGIN = 0.02 * (HIGH - LOW)


def crown(point: Array) -> tuple[Crowned, float]:
    """Shape and thickness [mm] of a design point (ln h/a, c/h, ln b/a, s)."""
    h = RADIUS_MM * np.exp(point[0])
    c, b = point[1] * h, RADIUS_MM * np.exp(point[2])
    return Crowned(float(point[3] * b * b / c), float(c), float(b)), float(h)


def castable(point: Array) -> bool:
    """Whether the crown of a design point can be cast."""
    shape, h = crown(point)
    try:
        shape.check(h)
    except InputError:
        return False
    return True


def design(count: int) -> Array:
    """First ``count`` castable points of the Sobol sequence, shape (count, 4)."""
    from scipy.stats import qmc

    raw = qmc.Sobol(4, scramble=False).random_base2(14)[1:]
    points = LOW + (HIGH - LOW) * raw
    return np.array([point for point in points[: 12 * count] if castable(point)][:count])


def fresh(count: int) -> Array:
    """Random castable points inside the table's own ranges, for its error."""
    rng = np.random.default_rng(20)
    inside = 0.04 * (HIGH - LOW)
    points = rng.uniform(LOW + inside, HIGH - inside, (800, 4))
    return np.array([point for point in points if castable(point)][:count])


def solve(point: Array, cells: int = CELLS) -> dict[str, Any]:
    """Solve one crown with each bead: F / (E a^2) at the depths that were reached, and why it stopped."""
    shape, h = crown(point)
    press = Press(shape, h, RADIUS_MM / h, EXTENT_OVER_RADIUS * RADIUS_MM / h)
    answer: dict[str, Any] = {"point": [float(x) for x in point], "force": [], "stop": []}
    for rim in RIMS:
        path = climb(press, Yeoh(1.0), DEPTHS, cells, rim)
        force = np.asarray(path.force) / 3.0 * (h / RADIUS_MM) ** 2
        answer["force"].append([float(f"{value:.7g}") for value in force])
        answer["stop"].append(path.stop)
    return answer


def gather(points: Array, store: Path, workers: int, cells: int = CELLS) -> list[dict[str, Any]]:
    """Solve the points that the store does not hold yet (none with 0 workers); answers in the points' order."""
    known: dict[tuple[str, ...], dict[str, Any]] = {}

    def key(point: Array) -> tuple[str, ...]:
        return tuple(f"{x:.6f}" for x in point)

    if store.exists():
        for line in store.read_text(encoding="utf-8").splitlines():
            answer = json.loads(line)
            known[key(answer["point"])] = answer
    missing = [point for point in points if key(point) not in known] if workers else []
    work = partial(solve, cells=cells)
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
            print(f"{done} of {len(missing)}: reached {reach} of {len(DEPTHS)} depths", file=sys.stderr)
    return [known[key(point)] for point in points if key(point) in known]


def padded(forces: list[list[float]]) -> Array:
    """Forces of one shape with each bead at all depths, NaN where they were not reached, shape (beads, levels)."""
    return np.array([force + [np.nan] * (len(DEPTHS) - len(force)) for force in forces], dtype=float)


def sharp_values(answers: list[dict[str, Any]]) -> tuple[Array, Array, Array]:
    """Points, F / (E a^2) with a sharp edge at the levels, and what the edge added, relative."""
    points = np.array([answer["point"] for answer in answers])
    pairs = [sharp(*padded(answer["force"])) for answer in answers]
    return points, np.array([value for value, _ in pairs]), np.array([added for _, added in pairs])


def reduced(points: Array, values: Array) -> Array:
    """ln of F over Hertz's force of the tip."""
    h = np.exp(points[:, 0])
    tip = points[:, 3] * np.exp(2.0 * points[:, 2]) / (points[:, 1] * h)
    return np.log(values / (16.0 / 9.0 * np.sqrt(tip)[:, None] * (DEPTHS * h[:, None]) ** 1.5))


def at_levels(points: Array, rows: Array) -> Array:
    """Curves over d / h, shape (n, depths), at the levels of d / c; NaN where they were not solved.

    A natural cubic spline in sqrt(d / h) from 0 at first touch, carried on straight.
    """
    from scipy.interpolate import CubicSpline

    out = np.full((len(points), len(LEVELS)), np.nan)
    for row, share, values in zip(out, points[:, 1], rows):
        known = np.isfinite(values)
        last = DEPTHS[known][-1]
        place = np.sqrt(np.concatenate([[0.0], DEPTHS[known]]))
        spline = CubicSpline(place, np.concatenate([[0.0], values[known]]), bc_type="natural")
        x = LEVELS * share
        inside = np.minimum(np.sqrt(x), place[-1])
        carried = spline(inside) + (np.sqrt(x) - inside) * spline(place[-1], 1)
        wanted = x <= (CARRIED_ON if last >= DEPTHS[-1] else last * (1.0 + 1e-9))
        row[wanted] = carried[wanted]
    return out


def content(answers: list[dict[str, Any]], checks: list[dict[str, Any]], finer: list[dict[str, Any]]) -> dict[str, Any]:
    """Fit the response surface, measure its error on fresh solves, and return what goes into the file.

    Parameters
    ----------
    answers, checks : list of dict
        Solves of the design and of the fresh points, from :func:`gather`.
    finer : list of dict
        Some of the fresh points on cells of half the size.
    """
    points, values, added = sharp_values(answers)
    rows = reduced(points, values)
    reach = np.array([DEPTHS[np.isfinite(row)][-1] for row in rows])
    reach = np.where(reach >= DEPTHS[-1], COMPLETE, reach)
    low, high = (np.append(ends[:3], np.log(ends[3])) for ends in (LOW, HIGH))
    coordinates = np.column_stack([points[:, :3], np.log(points[:, 3])])
    surface = fit(coordinates, at_levels(points, rows), LEVELS, low, high, True, reach)
    short = {name: _shorter(getattr(surface, name), 7) for name in ("trend", "weights", "lengths")}
    surface = replace(surface, **short)
    at, fresh_values, _ = sharp_values(checks)
    checked = np.column_stack([at[:, :3], np.log(at[:, 3])])
    place = np.broadcast_to(np.arange(len(at))[:, None], fresh_values.shape)
    answered, _ = surface.along(surface.at_levels(checked), place, DEPTHS / at[:, 1:2])
    miss = np.abs(np.expm1(answered - reduced(at, fresh_values)))
    # Judged where the table answers: within the limit it states itself.
    miss = np.where(DEPTHS[None, :] <= surface.limit(checked)[:, None] * (1.0 + 1e-9), miss, np.nan)
    places, fine_values, _ = sharp_values(finer)
    twin = np.array([np.abs(at - place).sum(1).argmin() for place in places])
    mesh = _rms(np.log(fine_values / fresh_values[twin]))
    edge = EDGE_ERROR * _rms(added)
    stop = [answer["stop"][-1] for answer in answers if answer["stop"][-1]]
    return {
        "kind": "crowned",
        "condition": "bonded",
        "meaning": "ln(F / (16/9 E sqrt(R) d^1.5)) over ln h/a, c/h, ln b/a, ln s and d/c; s = R c / b^2",
        "low": _list(_plain(LOW + MARGIN), 4),
        "high": _list(_plain(HIGH - MARGIN), 4),
        "error_depth": _list(DEPTHS, 4),
        "median_error": _list(np.nanmedian(miss, axis=0), 3),
        "error": _list(np.nanpercentile(miss, 95.0, axis=0), 3),
        "solve_error": _list(LEAST_ERROR + mesh + edge, 3),
        "surface": {
            "low": _list(surface.low, 9),
            "high": _list(surface.high, 9),
            "lengths": _list(surface.lengths, 7),
            "centres": _list(surface.centres, 7),
            "levels": _list(LEVELS, 4),
            "trend": _list(surface.trend, 7),
            "weights": _list(surface.weights, 7),
            "reach": _list(surface.reach, 4),
            "anchored": True,
        },
        "fresh": {"points": _list(at, 7), "force": _list(fresh_values, 6)},
        "provenance": {
            "command": "python -m dummydesign.pad.build_shape_table crowned",
            "version": __version__,
            "law": "neo-Hookean, incompressible",
            "punch": "round, flat, what touches sticks, sharp edge from beads of 0.1 and 0.05",
            "base": "bonded",
            "extent_over_radius": EXTENT_OVER_RADIUS,
            "cells_under_punch": CELLS,
            "design": "Sobol sequence over the ranges, castable under a 14 x 14 mm punch",
            "curves": len(answers),
            "curves_that_stopped_early": len(stop),
            "fresh_curves": len(checks),
            "fresh_curves_on_half_the_cells": len(finer),
            "median_error": float(f"{np.nanmedian(miss):.3g}"),
            "error_of_95_percent": float(f"{np.nanpercentile(miss, 95.0):.3g}"),
            "largest_error": float(f"{np.nanmax(miss):.3g}"),
        },
    }


def _rms(values: Array) -> Array:
    return np.sqrt(np.nanmean(values**2, axis=0))


def _plain(point: Array) -> Array:
    """Inputs of the table (h/a, c/h, b/a, s) of a design point."""
    return np.array([np.exp(point[0]), point[1], np.exp(point[2]), point[3]])


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
    parser.add_argument("kind", choices=("crowned",))
    parser.add_argument("--count", type=int, default=400, help="shapes that are solved")
    parser.add_argument("--fresh", type=int, default=36, help="further random shapes, for the table's error")
    parser.add_argument("--finer", type=int, default=8, help="of these on half the cells, for the elements' error")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--store", type=Path, default=Path("crowned-solves.jsonl"), help="file that keeps solves")
    parser.add_argument("--no-solve", action="store_true", help="use what the store holds")
    parser.add_argument("--out", type=Path, default=data_folder() / "materials" / "tables")
    options = parser.parse_args(arguments)
    workers = 0 if options.no_solve else options.workers
    checks = gather(fresh(options.fresh), options.store, workers)
    finer = gather(fresh(options.finer), options.store.with_suffix(".finer.jsonl"), workers, 2 * CELLS)
    answers = gather(design(options.count), options.store, workers)
    table = content(answers, checks, finer)
    write_text(options.out / "crowned-bonded.json", json.dumps(table) + "\n")
    print(json.dumps(table["provenance"], indent=1))


if __name__ == "__main__":
    main()
