"""The call that works out many slabs: :func:`whatif`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from contextlib import nullcontext
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Rows, question

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from dummydesign.design.sweep.spec import Study
    from dummydesign.resin.model.resin import Resin

Values = float | str | Iterable[float]
"""One number, numbers, or text as on the command line: ``"3:30:0.5"`` (end included) or ``"5,15"``."""


def whatif(
    thickness_mm: Values,
    ratio: Values | None = None,
    *,
    resin: str = "polyurethane-nagoya",
    tissue: str | None = None,
    aim: str = "average",
    punch: str | Iterable[str] = "square:14",
    condition: str | Iterable[str] = "bonded",
    base: str | Iterable[str] = "bonded",
    shape: str | Iterable[str] = "slab",
    edge_radius_mm: Values = 0.0,
    velocity_mm_s: Values = (10.0, 250.0),
    force_N: Values = (1.0, 5.0, 10.0, 15.0),
    hold_s: float | str = 10.0,
    deceleration_mm_s2: float | str = 30_000.0,
    fidelity: str = "table",
    workers: int = 1,
    scheduler: str | None = None,
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    resume: bool = False,
    replace: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Rows:
    """Work out every combination of slabs, ratios, punches and supports.

    Parameters
    ----------
    thickness_mm, ratio, velocity_mm_s, force_N : number, numbers or text
        See :data:`Values`; the ratio is the resin's reference by default. [mm, resin's ratio, mm/s, N]
    hold_s, deceleration_mm_s2 : float
        Hold after the stop, and braking, of the presses that scores and peak over steady are of. [s, mm/s2]
    resin, tissue : str
        Names or paths; with a tissue every design is scored for it.
    aim : str
        Whom of the tissue a score is for: ``average``, ``safe-side`` or ``subject:NAME``.
    punch, condition, base : str or several
        Such as ``square:14``, ``bonded``, ``sliding``.
    shape : str or several
        ``NAME[:KEY=RANGE,...],...``: every combination of a shape's lengths, such as
        ``slab,crowned:radius=10:20:2,height=2``.
    edge_radius_mm : number, numbers or text
        Fillets of the punch's edge (0 to 0.3 of its half-width), of slabs by ``axisymmetric``. [mm]
    fidelity : str
        ``table``, ``axisymmetric`` or ``3d``.
    workers : int
        Processes on this machine. A script must then start its work below ``if __name__ == "__main__":``.
    scheduler : str, optional
        Address of a running Dask scheduler.
    executor : concurrent.futures.Executor, optional
        Runs the tasks side by side, from any library with this interface, instead of ``workers`` or ``scheduler``.
    out : path, optional
        Folder of ``rows.csv`` and the report; the next free number when it holds the answer to another question.
    resume : bool
        Keep the rows that are in ``out``.
    replace : bool
        Take the place of the other answer instead.
    progress : callable, optional
        Called with the number of designs that are done and that of all.

    Returns
    -------
    Rows
        The same as ``dummydesign whatif --json`` prints for the same question.

    Raises
    ------
    InputError
        For names, ranges or a number of designs that are not allowed.
    NoAnswerError
        When a worker was lost; what was done is in ``out``.

    Examples
    --------
    >>> import dummydesign
    >>> rows = dummydesign.whatif([8, 12], [14, 16], tissue="palm").rows
    >>> [(row["thickness_mm"], row["ratio"]) for row in rows]
    [(8.0, 14.0), (8.0, 16.0), (12.0, 14.0), (12.0, 16.0)]
    """
    from dummydesign.core.parsing import DECELERATION, HOLD, read_names, read_number, read_values
    from dummydesign.design.sweep.run import open_executor
    from dummydesign.design.sweep.spec import Study, parse_shapes
    from dummydesign.geometry.punch import equal_area_radius_mm
    from dummydesign.resin import load_resin

    material = load_resin(resin)
    study = Study(
        read_values(thickness_mm, "thickness in mm"),
        (material.relaxation_ratio_ref,) if ratio is None else read_values(ratio, "ratio"),
        tuple((name, equal_area_radius_mm(name)) for name in read_names(punch)),
        read_values(velocity_mm_s, "velocity in mm/s"), read_values(force_N, "force in N"), resin, tissue, aim,
        fidelity, read_names(condition), read_names(base),
        tuple(text for item in ([shape] if isinstance(shape, str) else shape) for text in parse_shapes(item)),
        read_values(edge_radius_mm, "edge radius in mm"), read_number(hold_s, HOLD),
        read_number(deceleration_mm_s2, DECELERATION),
    )  # fmt: skip
    study.check(material)
    folder = None if out is None else Path(out)
    inputs = {
        **study.to_dict(), "workers": workers if executor is None else None, "scheduler": scheduler, "resume": resume,
        "out": None if folder is None else str(folder),
    }  # fmt: skip
    opened = open_executor(workers, scheduler) if executor is None else nullcontext(executor)
    return _work_out(study, material, opened, folder, inputs, replace, progress)


def _work_out(
    study: Study, resin: Resin, opened: Any, folder: Path | None, inputs: dict[str, Any], replace: bool,
    progress: Callable[[int, int], None] | None,
) -> Rows:  # fmt: skip
    """Run a study that was checked, and write rows and report when there is a folder."""
    from dummydesign.design.sweep.run import targets_of
    from dummydesign.design.sweep.run import whatif as work_out

    targets = targets_of(study)  # a tissue that has no such press is refused before there is a folder
    sites = None if targets is None else targets.tissue
    sources = (*resin.references, *(() if sites is None else sites.sources))
    if folder is None:
        with opened as executor:
            found = work_out(study, executor=executor, progress=progress, targets=targets)
        return Rows(study, tuple(found["rows"]), found["seconds"], inputs, tuple(found["warnings"]), sources)
    from dummydesign.core.outputs import growing_folder
    from dummydesign.design.sweep.live_data import live_data
    from dummydesign.design.sweep.rows_file import RowsFile, settings_of
    from dummydesign.report.whatif import write_whatif

    settings = settings_of(study, resin, sites)
    asked = question("whatif", inputs, tissue=study.tissue, resin=study.resin)
    with opened as executor, growing_folder(folder, asked, replace=replace, go_on=inputs["resume"]) as output:
        file = RowsFile(output.work, study, settings, inputs["resume"])
        kept = len(file.rows)
        found = work_out(study, executor=executor, file=file, progress=progress, targets=targets)
        rows = found["rows"]
        live = live_data(resin, sites, study.sampling)
        page = write_whatif(output.work, study, rows, resin, sites, live, found["warnings"])
    answered = output.answer({"warnings": found["warnings"], "files": {"rows": str(file.path), **page}})
    inputs = {**inputs, "out": str(output.folder)}
    warnings = tuple(answered["warnings"])
    return Rows(study, tuple(rows), found["seconds"], inputs, warnings, sources, kept, answered["files"])
