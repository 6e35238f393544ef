"""What-if studies: every combination, here, in processes or on a cluster."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, as_completed
from contextlib import contextmanager
from typing import Any

import numpy as np

from dummydesign.core.errors import DummydesignError, InputError, NoAnswerError, out_of_range
from dummydesign.core.progress import COMMAND_LINE
from dummydesign.design.crown_array import pressed_alone
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.targets import Targets, make_targets
from dummydesign.design.sweep.rows import Task, key_of, work
from dummydesign.design.sweep.spec import Study
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.geometry.shapes.slab import Slab
from dummydesign.pad.force_law import ForceLaw
from dummydesign.resin.model.resin import Resin

# How often a cluster tries a task again whose worker was lost.
RETRIES = 3
CONNECT_S, CHUNK = 10, 4096
# Numerical error of a force above which a study warns. [%]
ROUGH_PERCENT = 2.0


@contextmanager
def open_executor(workers: int = 1, scheduler: str | None = None) -> Iterator[Executor | None]:
    """Open what runs the tasks; None stands for this process."""
    if workers < 1:
        raise out_of_range("workers", workers, 1, "any number of processes")
    if scheduler is not None:
        with _dask(scheduler) as executor:
            yield executor
    elif workers == 1:
        yield None
    else:
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor

        # spawned, not forked: a fork copies the threads of numerical libraries in any state they are in
        with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
            yield pool


@contextmanager
def _dask(address: str) -> Iterator[Executor]:
    # Dask's client leaves a thread and a traceback behind when it is given what is no address
    if not re.fullmatch(r"([a-z]+://)?[^/\s]+:\d+", address):
        message = f"--scheduler '{address}' is not an address such as tcp://host:8786"
        raise InputError(message, "malformed", "scheduler", address)
    try:
        from distributed import Client
    except ImportError:
        message = f"--scheduler {address}: Dask is not installed; pip install 'dummydesign[cluster]'"
        raise InputError(message, "program_missing", "scheduler", address) from None
    try:
        client = Client(address, timeout=CONNECT_S, set_as_default=False)
    except (OSError, ValueError, TypeError) as problem:
        text = str(problem).split("\n")[0] or type(problem).__name__
        message = f"--scheduler {address} does not answer within {CONNECT_S} s: {text}"
        raise InputError(message, "program_failed", "scheduler", address) from None
    try:
        with client.get_executor(pure=False, retries=RETRIES) as executor:
            yield executor
    finally:
        client.close()


def completed(function: Callable[[Any], Any], tasks: Iterable[Any], executor: Executor | None) -> Iterator[Any]:
    """Yield results as they are done; each task's exactly once."""
    if executor is None:
        yield from map(function, tasks)
        return
    waiting = [executor.submit(function, task) for task in tasks]
    try:
        for future in as_completed(waiting):
            try:
                yield future.result()
            except (DummydesignError, GeneratorExit):
                raise
            except Exception as problem:
                advice = "run the same command again"
                if COMMAND_LINE.get() is None:
                    # each process runs a script from its top again
                    advice += "; a script must start its work below: if __name__ == '__main__':"
                raise NoAnswerError(
                    "worker_lost",
                    f"a worker failed ({type(problem).__name__}: {problem}); {advice}",
                    quantity="workers",
                ) from problem
    finally:
        for future in waiting:
            future.cancel()


def whatif(
    study: Study,
    law: ForceLaw | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] | None = None,
    targets: Targets | None = None,
) -> dict[str, Any]:
    """Work out every design of a study."""
    from dummydesign.resin import load_resin

    start = time.perf_counter()
    resin = load_resin(study.resin)
    study.check(resin)
    targets = targets or targets_of(study)
    tasks = tasks_of(study, resin, targets)
    results = completed(work, tasks, executor) if law is None else (work(task, law) for task in tasks)
    if progress is not None:
        results = _counted(results, study.size, progress)
    known = {key_of(row): row for rows in results for row in rows}
    ordered = [known[key] for key in study.keys()]
    notice = None if targets is None else targets.tissue.notice
    warnings = [] if notice is None else [{"code": notice[0], "message": notice[1]}]
    warnings += study_warnings(study, ordered)
    return {"rows": ordered, "seconds": time.perf_counter() - start, "warnings": warnings}


def _counted(
    results: Iterable[list[dict[str, Any]]], size: int, progress: Callable[[int, int], None]
) -> Iterator[list[dict[str, Any]]]:
    """The same results, reported as they come."""
    done = 0
    progress(done, size)
    for rows in results:
        done += len(rows)
        progress(done, size)
        yield rows


def study_warnings(study: Study, rows: list[dict[str, Any]]) -> list[dict[str, str]]:
    """What a reader of the rows has to know: out of reach, rough solves, one crown of several, punches as circles."""
    notes = []
    stopped = sum(row["limit"] is not None for row in rows)
    if stopped:
        message = f"{stopped} of {study.size} designs do not reach every force: see the column limit of rows.csv"
        notes.append({"code": "out_of_reach", "message": message})
    rough = [row["force_error_percent"] for row in rows if (row["force_error_percent"] or 0.0) > ROUGH_PERCENT]
    if rough:
        most = f"{max(rough):.1f} % (column force_error_percent of rows.csv)"
        message = f"the force of {len(rough)} designs has an error of up to {most}"
        notes.append({"code": "rough_solve", "message": f"{message}; their exponents are less accurate"})
    notes += pressed_alone([len(read_shape(shape).places_mm) for shape in study.shapes])
    if study.reduced:
        message = f"{', '.join(study.reduced)}: taken as the circle of equal area; --fidelity 3d solves the corners"
        notes.append({"code": "punch_as_circle", "message": message})
    return notes


def tasks_of(study: Study, resin: Resin, targets: Targets | None) -> Iterator[Task]:
    """Cut a study into tasks.

    By the table a task is a few thousand designs of one punch, condition and base; by finite elements it is
    one slab, solved once for all its ratios.
    """
    ratios = np.array(study.ratio)
    young, beta = resin.young_MPa(ratios), resin.strengths(ratios)
    gel = (verdict_limits() if targets is None else targets.limits).gel_compression
    for (punch, radius), condition, base in study.setups:
        for shapes, edge in _groups(study):
            designs = [
                (which, thickness, column)
                for which in range(len(shapes))
                for thickness in study.thickness_mm
                for column in range(len(study.ratio))
            ]
            if study.fidelity == "table":
                parts = [designs[first : first + CHUNK] for first in range(0, len(designs), CHUNK)]
            else:
                order = dict.fromkeys(value for _, value, _ in designs)
                parts = [[design for design in designs if design[1] == thickness] for thickness in order]
            for part in parts:
                which, thickness, columns = (np.array(values) for values in zip(*part))
                yield Task(
                    study.fidelity,
                    punch,
                    condition,
                    base,
                    radius,
                    thickness,
                    ratios[columns],
                    young[columns],
                    resin.tau_s,
                    beta[columns],
                    study.forces_N,
                    study.velocities_mm_s,
                    targets,
                    shapes,
                    which,
                    edge,
                    study.sampling,
                    gel,
                )


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


def targets_of(study: Study) -> Targets | None:
    """What the study's scores are of, None without a tissue; InputError for a test that the tissue does not know."""
    if study.tissue is None:
        return None
    from dummydesign.tissue.model.tissue_file import load_tissue

    return make_targets(load_tissue(study.tissue), study.aim, study.sampling, study.protocol)
