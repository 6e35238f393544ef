"""What-if studies: every combination of slabs, ratios, punches and supports, here or side by side."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.design.scoring.presses import ForceLaw
from dummydesign.design.sites.pressed_alone import pressed_alone
from dummydesign.design.sweep.executors import completed
from dummydesign.design.sweep.rows import Task
from dummydesign.design.sweep.spec import Key, Study
from dummydesign.design.sweep.work import work
from dummydesign.geometry.shapes import Slab, read_shape

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from dummydesign.design.scoring.targets import Targets
    from dummydesign.design.sweep.rows_file import RowsFile
    from dummydesign.resin.model.resin import Resin

CHUNK = 4096
ROUGH_PERCENT = 2.0
"""Numerical error of a force above which a study warns. [%]"""
__all__ = ["Study", "study_warnings", "targets_of", "tasks_of", "whatif"]


def whatif(
    study: Study,
    law: ForceLaw | None = None,
    executor: Executor | None = None,
    file: RowsFile | None = None,
    progress: Callable[[int, int], None] | None = None,
    targets: Targets | None = None,
) -> dict[str, Any]:
    """Work out every design of a study.

    Parameters
    ----------
    study : Study
        What is varied.
    law : ForceLaw, optional
        Elastic force of slabs; by default what the study's fidelity names. Works in this process only.
    executor : concurrent.futures.Executor, optional
        Runs tasks side by side; the rows do not depend on it.
    file : RowsFile, optional
        Takes the rows as they are done; the designs it already holds are not worked out again.
    progress : callable, optional
        Called with the number of designs that are done and the number of all, whenever some are done.
    targets : Targets, optional
        Those of the study, where they are known; made by default.

    Returns
    -------
    dict
        ``rows`` (see :func:`dummydesign.design.sweep.work.work`) in the study's order, ``seconds`` of work, and
        ``warnings``, {code, message} each.

    Raises
    ------
    InputError
        For names, ranges or a number of designs that are not allowed.
    NoAnswerError
        ``worker_lost`` when a worker died and nobody could take over.
    """
    from dummydesign.resin import load_resin

    start = time.perf_counter()
    resin = load_resin(study.resin)
    study.check(resin)
    done = {} if file is None else file.rows
    targets = targets or targets_of(study)
    tasks = tasks_of(study, resin, targets, done)
    found: dict[Key, dict[str, Any]] = {}
    results = completed(work, tasks, executor) if law is None else (work(task, law) for task in tasks)
    if progress is not None:
        results = _counted(results, study.size, len(set(done) & set(study.keys())), progress)
    if file is None:
        from dummydesign.design.sweep.rows_file import key_of

        for rows in results:
            found.update((key_of(row), row) for row in rows)
        ordered = [found[key] for key in study.keys()]
    else:
        try:
            for rows in results:
                file.add(rows)
        except BaseException:
            file.close()
            raise
        ordered = file.finish()
    warnings = [*_tissue_said(targets), *study_warnings(study, ordered)]
    return {"rows": ordered, "seconds": time.perf_counter() - start, "warnings": warnings}


def _counted(
    results: Iterable[list[dict[str, Any]]], size: int, done: int, progress: Callable[[int, int], None]
) -> Iterator[list[dict[str, Any]]]:
    """The same results, told of as they come."""
    progress(done, size)
    for rows in results:
        done += len(rows)
        progress(done, size)
        yield rows


def _tissue_said(targets: Targets | None) -> list[dict[str, str]]:
    """What must be said of the tissue's law."""
    said = None if targets is None else targets.tissue.said
    return [] if said is None else [{"code": said[0], "message": said[1]}]


def study_warnings(study: Study, rows: list[dict[str, Any]]) -> list[dict[str, str]]:
    """What a reader of the rows has to know: out of reach, rough solves, one crown of several, punches as circles."""
    said = []
    stopped = sum(row["limit"] is not None for row in rows)
    if stopped:
        message = f"{stopped} of {study.size} designs do not reach every force; 'limit' says why"
        said.append({"code": "out_of_reach", "message": message})
    rough = [row["force_error_percent"] for row in rows if (row["force_error_percent"] or 0.0) > ROUGH_PERCENT]
    if rough:
        message = f"the force of {len(rough)} designs has an error of up to {max(rough):.1f} % ('force_error_percent')"
        said.append({"code": "rough_solve", "message": f"{message}; their exponents are less accurate"})
    said += pressed_alone([len(read_shape(shape).places_mm) for shape in study.shapes])
    if study.reduced:
        message = f"{', '.join(study.reduced)}: taken as the circle of equal area; --fidelity 3d solves the corners"
        said.append({"code": "punch_as_circle", "message": message})
    return said


def tasks_of(study: Study, resin: Resin, targets: Targets | None, done: Iterable[Key] = ()) -> Iterator[Task]:
    """Cut a study into tasks, leaving out designs that are done.

    By the table a task is a few thousand designs of one punch, condition and base; by finite elements it is
    one slab, solved once for all its ratios.

    Parameters
    ----------
    study : Study
        What was asked.
    resin : Resin
        Gives modulus and relaxation at a ratio.
    targets : Targets or None
        What to score against.
    done : iterable of Key
        Designs that need not be worked out again.

    Yields
    ------
    Task
    """
    done = set(done)
    ratios = np.array(study.ratio)
    young = np.atleast_1d(resin.young_MPa(ratios))
    tau = tuple(arm.tau_s.value for arm in resin.arms)
    beta = np.array([[term.beta for term in resin.prony(float(value))] for value in ratios]).reshape(len(ratios), -1)
    for (punch, radius), condition, base in study.setups:
        for shapes, edge in _groups(study):
            designs = [
                (which, thickness, column)
                for which, shape in enumerate(shapes)
                for thickness in study.thickness_mm
                for column, ratio in enumerate(study.ratio)
                if (punch, condition, base, shape, edge, thickness, ratio) not in done
            ]
            for part in _parts(designs, study.fidelity):
                which, thickness, columns = (np.array(values) for values in zip(*part))
                yield Task(
                    study.fidelity, punch, condition, base, radius, thickness, ratios[columns], young[columns], tau,
                    beta[columns], study.forces_N, study.velocities_mm_s, targets, shapes, which, edge,
                    study.sampling,
                )  # fmt: skip


def _groups(study: Study) -> Iterator[tuple[tuple[str, ...], float]]:
    """Shapes that go together, and an edge radius: slabs by themselves; by tables all other shapes, else each one."""
    for edge in study.edge_radii_mm:
        if Slab.name in study.shapes:
            yield (Slab.name,), edge
        others = tuple(shape for shape in study.shapes if shape != Slab.name)
        if study.fidelity == "table" and others:
            yield others, edge
        elif study.fidelity != "table":
            for shape in others:
                yield (shape,), edge


Part = list[tuple[int, float, int]]


def _parts(designs: Part, fidelity: str) -> Iterator[Part]:
    if fidelity == "table":
        for first in range(0, len(designs), CHUNK):
            yield designs[first : first + CHUNK]
        return
    for thickness in dict.fromkeys(value for _, value, _ in designs):
        yield [design for design in designs if design[1] == thickness]


def targets_of(study: Study) -> Targets | None:
    """What the study's scores are of, None without a tissue; InputError for a test that the tissue does not know."""
    if study.tissue is None:
        return None
    from dummydesign.design.scoring.targets import make_targets
    from dummydesign.tissue.model.tissue_file import load_tissue

    return make_targets(load_tissue(study.tissue), study.aim, study.sampling, study.protocol)
