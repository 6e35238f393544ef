"""Rows of a what-if study, many designs at once, and their file."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import repeat
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.files import csv_text, write_text
from dummydesign.design.scoring.press_simulation import (
    DEPTH_SHARE,
    SAMPLES,
    PadBatch,
    PadRows,
    Sampling,
    SlabCurves,
    make_curves,
    press_to_depth,
    steady_depth,
)
from dummydesign.design.scoring.settings import verdict_limits, weights_of
from dummydesign.design.scoring.targets import Targets
from dummydesign.design.search.shape_family import Designs, load_family, under_square
from dummydesign.design.sweep.spec import Key, Study, why_not_cast
from dummydesign.geometry.punch import punch_sides_mm
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.pad.tables.slab import load_table, slab_table
from dummydesign.pad.tables.square import punch_law

# Steady force at which peak over steady is given, that of the paper's force-time figures. [N]
PEAK_FORCE_N = 10.0
SCORES = ("total", "steady_state_range", "force_variation_range", "aim", "parametric", "low_force_range")
_BY_FORCE = ("exponent", "depth_mm", "depth_over_thickness", "stiffness_N_per_mm")
BY_FORCE = tuple(f"{name}_at_N" for name in _BY_FORCE)
SOLVED_SHARES = DEPTH_SHARE * np.linspace(0.04, 1.0, 16)


@dataclass(frozen=True, eq=False)
class Task(PadRows):
    """Some designs of one punch, condition and base with all that is needed to work them out anywhere."""

    fidelity: str
    punch: str
    condition: str
    base: str
    radius_mm: float
    thickness_mm: NDArray
    ratio: NDArray
    young_MPa: NDArray
    tau_s: tuple[float, ...]
    beta: NDArray
    forces_N: tuple[float, ...]
    velocities_mm_s: tuple[float, ...]
    targets: Targets | None = None
    shapes: tuple[str, ...] = (Slab.name,)
    shape: NDArray | None = None
    edge_radius_mm: float = 0.0
    sampling: Sampling = field(default_factory=Sampling)
    gel_compression: float = DEPTH_SHARE

    @cached_property
    def keys(self) -> tuple[list[str], list[str]]:
        """Names of the forces and of the speeds in rows."""
        return [f"{force:g}" for force in self.forces_N], [f"{speed:g}" for speed in self.velocities_mm_s]

    def shape_of(self, index: int) -> str:
        """Shape of one design, as its text."""
        return self.shapes[0 if self.shape is None else int(self.shape[index])]


def rows_of(task: Task, slabs: PadBatch, error: Callable[[NDArray], NDArray]) -> list[dict[str, Any]]:
    """Work out all designs at once and lay them out as rows."""
    forces = np.array(task.forces_N)
    depth = slabs.curves.depth_at(slabs.slab, forces / slabs.young_MPa[:, None])
    slope = slabs.curves.slope_at(slabs.slab, depth) * slabs.young_MPa[:, None]
    with np.errstate(invalid="ignore"):
        columns = (slope * depth / forces, depth, depth / slabs.thickness_mm[:, None], slope)
    by_force = [_plain(values) for values in columns]
    scores = repeat(None) if task.targets is None else _plain(_scores(slabs, task.targets))
    peaks, limits = _plain(_peaks(slabs, task.velocities_mm_s, task.sampling)), _limits(slabs, depth, task.forces_N)
    errors = (one for (one,) in _plain(_errors(depth, error)[:, None]))
    each = zip(range(len(task.ratio)), zip(*by_force), peaks, errors, limits, scores)
    return [_row(task, *values) for values in each]


def _row(
    task: Task,
    index: int,
    by_force: Sequence[Sequence[float | None]],
    peaks: Sequence[float | None],
    error: float | None,
    limit: str | None,
    scores: Sequence[float | None] | None,
) -> dict[str, Any]:
    forces, speeds = task.keys
    row = {
        "thickness_mm": float(task.thickness_mm[index]),
        "ratio": float(task.ratio[index]),
        "punch": task.punch,
        "condition": task.condition,
        "base": task.base,
        "shape": task.shape_of(index),
        "edge_radius_mm": task.edge_radius_mm,
        "young_kPa": float(1e3 * task.young_MPa[index]),
        **{name: dict(zip(forces, values)) for name, values in zip(BY_FORCE, by_force)},
        "peak_over_steady": dict(zip(speeds, peaks)),
        "force_error_percent": error,
        "limit": limit,
    }
    return row if scores is None else row | {"score": dict(zip(SCORES, scores))}


def empty_row(task: Task, index: int, why: str) -> dict[str, Any]:
    """A row without values for a pad that could not be solved or cast."""
    by_force, peaks = [[None] * len(task.forces_N)] * len(BY_FORCE), [None] * len(task.velocities_mm_s)
    return _row(task, index, by_force, peaks, None, why, None if task.targets is None else [0.0] * len(SCORES))


def empty_rows(task: Task, why: str) -> list[dict[str, Any]]:
    """The same for all pads of a task."""
    return [empty_row(task, index, why) for index in range(len(task.ratio))]


def _peaks(slabs: PadBatch, velocities: Sequence[float], sampling: Sampling) -> NDArray:
    """Peak over the force at the end of the hold where that is 10 N, shape (D, speeds)."""
    columns = []
    for velocity in velocities:
        depth = steady_depth(slabs, PEAK_FORCE_N, velocity, sampling)
        columns.append(press_to_depth(slabs, depth, velocity, sampling).peak_N / PEAK_FORCE_N)
    return np.stack(columns, axis=-1)


def _scores(slabs: PadBatch, targets: Targets) -> NDArray:
    """Scores for a tissue as in the map of the search, shape (D, SCORES): the parametric part is that of gamma1."""
    from dummydesign.design.scoring.law_parameters import gamma1_score
    from dummydesign.design.scoring.score import evaluate, evaluated_gamma1

    evaluation = evaluate(slabs, targets)
    parametric = gamma1_score(evaluated_gamma1(evaluation, targets.power), targets)
    shown = parametric if targets.parametric else np.full(len(parametric), np.nan)
    ranges = evaluation.steady_state_range, evaluation.force_variation_range
    parts = (*ranges, evaluation.aim, shown, evaluation.low_force_range)
    return np.stack([evaluation.total(parametric), *parts], axis=-1)


def _limits(slabs: PadBatch, depth: NDArray, forces: Sequence[float]) -> list[str | None]:
    """Why a row stops early: the first force that is out of reach, and the limit it meets."""
    limits: list[str | None] = []
    edge = slabs.curves.limit_mm[slabs.slab]
    for index, row in enumerate(np.isnan(depth)):
        if not row.any():
            limits.append(None)
            continue
        share = edge[index] / slabs.thickness_mm[index]
        first = min(force for force, missing in zip(forces, row) if missing)
        limits.append(f"{first:g} N needs more than {edge[index]:.2f} mm ({share:.2f} of the thickness)")
    return limits


def _errors(depth: NDArray, error_of: Callable[[NDArray], NDArray]) -> NDArray:
    """Largest numerical error of the forces that are reached, shape (D,); NaN when the law states none. [%]"""
    known = np.isfinite(depth)
    error = error_of(np.where(known, depth, 0.0))
    largest = np.where(known, error, -np.inf).max(axis=-1)
    return 100.0 * np.where(np.isfinite(largest), largest, np.nan)


def _plain(values: NDArray) -> list[list[float | None]]:
    """Plain lists with None where a value is missing."""
    plain = values.tolist()
    if np.isnan(values).any():
        return [[None if value != value else value for value in row] for row in plain]
    return plain


def _by_tables(task: Task) -> list[dict[str, Any]]:
    """Pads of each kind on its table, all at once."""
    chosen = np.zeros(len(task.ratio), int) if task.shape is None else task.shape
    pads, pad_of = np.unique(np.stack([chosen, task.thickness_mm]), axis=1, return_inverse=True)
    pad_of = pad_of.reshape(-1)
    shapes = [read_shape(task.shapes[int(index)]) for index in pads[0]]
    why: list[str | None] = [why_not_cast(str(shape), float(mm)) for shape, mm in zip(shapes, pads[1])]
    rows: list[dict[str, Any]] = [{} for _ in pad_of]
    for kind in dict.fromkeys(shape.name for shape in shapes):
        family, own = load_family(kind), []
        if (sides := punch_sides_mm(task.punch)) is not None and sides[0] == sides[1]:
            family = under_square(family)
        for n in (n for n, shape in enumerate(shapes) if shape.name == kind and why[n] is None):
            try:
                family.check(shapes[n])
            except InputError as problem:
                why[n] = str(problem)
                continue
            own.append(n)
        if not own:
            continue
        lengths = [dict(shapes[n].parameters) for n in own]
        designs = Designs(kind, pads[1][own], {name: np.array([one[name] for one in lengths]) for name in lengths[0]})
        limit = np.minimum(family.limit_mm(designs, task.radius_mm), task.gel_compression * designs.gel_mm)
        curve_of, held = np.full(len(shapes), -1), np.array(own)[limit > 0.0]
        for n in set(own) - set(held.tolist()):
            why[n] = f"outside the response table of {kind} pads; --fidelity {shapes[n].fidelity} solves it"
        if not len(held):
            continue
        designs, limit, curve_of[held] = designs.take(limit > 0.0), limit[limit > 0.0], np.arange(len(held))
        area = family.area_mm2(designs, limit[:, None] * np.linspace(0.0, 1.0, SAMPLES), task.radius_mm)
        able = np.nonzero(curve_of[pad_of] >= 0)[0]
        part, slab = task.take(able), curve_of[pad_of[able]]
        curves = SlabCurves(designs.thickness_mm, limit, area)
        slabs = PadBatch(curves, slab, part.young_MPa, part.tau_s, part.beta)
        error = partial(family.relative_error, designs.take(slab), radius_mm=task.radius_mm)
        for index, row in zip(able, rows_of(part, slabs, error)):
            rows[index] = row
    return [row or empty_row(task, index, why[pad] or "") for index, (row, pad) in enumerate(zip(rows, pad_of))]


def _solved(task: Task) -> list[dict[str, Any]]:
    """One pad by finite elements, for all its ratios."""
    from dummydesign.pad.force_source import elastic_curve
    from dummydesign.pad.pad_under_punch import Pad

    shape, thickness = task.shape_of(0), float(task.thickness_mm[0])
    refused = why_not_cast(shape, thickness)
    if refused:
        return empty_rows(task, refused)
    wanted = SOLVED_SHARES * thickness
    # corners are known of a glued square on a slab or a crown; all other punches are the circle of their area
    sides = punch_sides_mm(task.punch) if task.edge_radius_mm or read_shape(shape).crowned else None
    if sides is not None and sides[0] != sides[1]:
        sides = None
    pad = Pad(
        thickness,
        1.0,
        task.radius_mm,
        base=task.base,
        condition=task.condition,
        sides_mm=sides,
        edge_radius_mm=task.edge_radius_mm,
        geometry=read_shape(shape),
    )
    try:
        force_curve = elastic_curve(pad, task.fidelity, float(wanted[-1]), wanted)
    except NoAnswerError as problem:
        return empty_rows(task, str(problem))
    depth = wanted[wanted <= force_curve.limit_mm * (1.0 + 1e-9)]
    if len(depth) < 3:
        return empty_rows(task, "could not be solved to a useful depth")
    curve = force_curve.force(float(depth[-1]) * np.linspace(0.0, 1.0, SAMPLES))
    curves = SlabCurves(np.array([thickness]), depth[-1:], curve[None])
    slabs = PadBatch(curves, np.zeros(len(task.ratio), int), task.young_MPa, task.tau_s, task.beta)
    return rows_of(task, slabs, force_curve.relative_error)


def work(task: Task, law: ForceLaw | None = None) -> list[dict[str, Any]]:
    """Work out the rows of a task (runs in this process, in another, or on a cluster)."""
    if task.shapes != (Slab.name,) or (task.edge_radius_mm and task.fidelity != "table"):
        return _by_tables(task) if task.fidelity == "table" else _solved(task)
    thickness, row = np.unique(task.thickness_mm, return_inverse=True)
    try:
        law = law or force_law(task, thickness)
        curves = make_curves(law, thickness, task.radius_mm, task.gel_compression)
    except NoAnswerError as problem:
        return empty_rows(task, str(problem))
    slabs, known = PadBatch(curves, row, task.young_MPa, task.tau_s, task.beta), law
    return rows_of(task, slabs, lambda at: known.relative_error(at, slabs.thickness_mm[:, None], task.radius_mm))


def force_law(task: Task, thickness_mm: NDArray) -> ForceLaw:
    """The force law of the task's fidelity, punch, condition and base."""
    if task.fidelity == "table":
        table = slab_table(task.base, task.edge_radius_mm, task.radius_mm)
        return punch_law(table, task.punch, task.base, bool(task.edge_radius_mm))
    from dummydesign.pad.fe_force_law import solve_law

    sides = punch_sides_mm(task.punch)
    solved = solve_law(thickness_mm.tolist(), task.radius_mm, task.base, task.condition, sides, task.fidelity)
    return cast(ForceLaw, solved)


ROWS, SETTINGS = "rows.csv", "study.json"
_NAMED = ("thickness_mm", "ratio", "punch", "condition", "base", "shape", "edge_radius_mm")


def columns_of_rows(study: Study) -> dict[str, tuple[str, ...]]:
    """Where each column's value is in a row; nested values have one column a key, such as ``depth_mm_at_5_N``."""
    forces, speeds = study.forces_N, study.velocities_mm_s
    columns: dict[str, tuple[str, ...]] = {name: (name,) for name in (*_NAMED, "young_kPa")}
    columns |= {f"{name}_at_{force:g}_N": (f"{name}_at_N", f"{force:g}") for name in _BY_FORCE for force in forces}
    columns |= {f"peak_over_steady_at_{speed:g}_mm_s": ("peak_over_steady", f"{speed:g}") for speed in speeds}
    columns |= {name: (name,) for name in ("force_error_percent", "limit")}
    if study.tissue is not None:
        columns |= {f"score_{name}": ("score", name) for name in SCORES}
    return columns


def key_of(row: dict[str, Any]) -> Key:
    """Name of a row's design."""
    names = ("punch", "condition", "base", "shape", "edge_radius_mm", "thickness_mm", "ratio")
    return tuple(row[name] for name in names)  # type: ignore[return-value]


def write_rows(folder: Path, study: Study, settings: dict[str, Any], rows: Iterable[dict[str, Any]]) -> Path:
    """Write the rows of a study, numbers in full, and beside them the settings that they share."""
    write_text(folder / SETTINGS, json.dumps(settings, indent=1) + "\n")
    columns = columns_of_rows(study)
    values = ([row[at[0]] if len(at) == 1 else row[at[0]][at[1]] for at in columns.values()] for row in rows)
    return write_text(folder / ROWS, csv_text(columns, values))


def settings_of(study: Study, resin: Any, tissue: Any) -> dict[str, Any]:
    """Settings that rows in one file share: all but the lists that name designs; data by their hash."""
    from dummydesign._version import __version__

    settings = {
        "version": __version__,
        "fidelity": study.fidelity,
        "resin": f"{resin.name} {_hash(resin.to_dict())}",
        "tissue": None if tissue is None else f"{tissue.name} {study.aim} {_hash(tissue.to_dict())}",
        "forces_N": list(study.forces_N),
        "velocities_mm_s": list(study.velocities_mm_s),
        "hold_s": study.hold_s,
        "deceleration_mm_s2": study.deceleration_mm_s2,
        "gel_compression": verdict_limits().gel_compression,
        "weights": None if tissue is None else _hash(weights_of(study.aim).to_dict()),
    }
    if study.fidelity == "table":
        from dummydesign.geometry.interface import BASES

        settings["tables"] = _hash({base: load_table(base).coefficients.tolist() for base in BASES})
    return settings


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()[:16]
