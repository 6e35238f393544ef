"""Working out a task of a what-if study: slabs here, shaped pads and solved filleted punches by ``shaped_rows``."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import NoAnswerError
from dummydesign.design.scoring.presses import ForceLaw, Slabs, make_curves
from dummydesign.design.sweep.rows import Task, empty_row, rows_of
from dummydesign.design.sweep.shaped_rows import work_shaped
from dummydesign.geometry.shapes import Slab
from dummydesign.pad.tables.punch import punch_law, punch_sides_mm


def work(task: Task, law: ForceLaw | None = None) -> list[dict[str, Any]]:
    """Work out the rows of a task (runs in this process, in another, or on a cluster).

    Parameters
    ----------
    task : Task
    law : ForceLaw, optional
        Elastic force of slabs; by default what the task's fidelity names.

    Returns
    -------
    list of dict
        One a design, in the task's order: ``thickness_mm``, ``ratio``, ``punch``, ``condition``, ``base``, ``shape``,
        ``edge_radius_mm``, ``young_kPa``; by force ``depth_mm_at_N``, ``depth_over_thickness_at_N``,
        ``stiffness_N_per_mm_at_N``, ``exponent_at_N`` (d ln F / d ln x), all of the relaxed pad; ``peak_over_steady``
        by speed at 10 N steady; ``force_error_percent``, the model's own numerical error, largest of the forces
        reached;
        ``limit`` (None, or why values are missing); ``score`` when there are targets. What is out of
        reach is None. A slab that cannot be solved gives rows without values whose ``limit`` says why.
    """
    if task.shapes != (Slab.name,) or (task.edge_radius_mm and task.fidelity != "table"):
        return work_shaped(task)
    thickness, place = np.unique(task.thickness_mm, return_inverse=True)
    try:
        law = law or force_law(task, thickness)
        curves = make_curves(law, thickness, task.radius_mm)
    except NoAnswerError as problem:
        return [empty_row(task, index, str(problem)) for index in range(len(task.ratio))]
    slabs = Slabs(curves, place, task.young_MPa, task.tau_s, task.beta)

    def error(depth_mm: NDArray) -> NDArray:
        return law.relative_error(depth_mm, slabs.thickness_mm[:, None], task.radius_mm)

    return rows_of(task, slabs, error)


def force_law(task: Task, thickness_mm: NDArray) -> ForceLaw:
    """The force law of the task's fidelity, punch, condition and base."""
    if task.fidelity == "table":
        from dummydesign.pad.tables.filleted import slab_table

        table = slab_table(task.base, task.edge_radius_mm, task.radius_mm)
        return punch_law(table, task.punch, task.base, bool(task.edge_radius_mm))
    from dummydesign.design.search.solved_slabs import solve_law

    sides = punch_sides_mm(task.punch)
    return solve_law(thickness_mm.tolist(), task.radius_mm, None, task.base, task.condition, sides, task.fidelity)
