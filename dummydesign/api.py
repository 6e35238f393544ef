"""The three calls for scripts: :func:`suggest`, :func:`whatif`, :func:`fit`; each result has a dict and a table.

    import dummydesign
    answer = dummydesign.suggest("forefinger")
    answer.to_dict()["recommendation"]["thickness_mm"]
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.errors import InputError

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from dummydesign.design.study import Study
    from dummydesign.design.suggest import Suggestion
    from dummydesign.protocol.trace import Trace
    from dummydesign.tissue.fit import Fit

Values = float | str | Iterable[float]
"""One number, numbers, or text as on the command line: ``"3:30:0.5"`` (end included) or ``"5,15"``."""


def frame_of(records: Sequence[dict[str, Any]]) -> Any:
    """Make a pandas DataFrame; nested values become columns such as ``depth_mm_at_N.10``.

    Raises
    ------
    InputError
        When pandas is not installed.
    """
    try:
        from pandas import json_normalize
    except ImportError:
        raise InputError("to_frame needs pandas, which is not installed; pip install pandas, or use to_dict") from None
    return json_normalize(list(records))


@dataclass(frozen=True)
class Answer:
    """What :func:`suggest` found. ``found`` is the search with all its objects, ``files`` what was written."""

    found: Suggestion
    files: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return the answer in the form of ``dummydesign suggest --json``."""
        return {"inputs": self.found.request.to_dict(), **self.found.to_dict(), "files": dict(self.files)}

    def to_frame(self) -> Any:
        """Return recommendation and alternatives as a DataFrame, one row a design (needs pandas)."""
        answer = self.found.to_dict()
        keys = ("thickness_mm", "ratio", "young_kPa", "scores")
        return frame_of([{key: d[key] for key in keys} for d in (answer["recommendation"], *answer["alternatives"])])


@dataclass(frozen=True)
class Rows:
    """What :func:`whatif` found: one row a design, in the study's order."""

    study: Study
    rows: tuple[dict[str, Any], ...]
    seconds: float
    files: dict[str, str] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Return study, rows and seconds as plain values."""
        rows = [dict(row) for row in self.rows]
        return {"inputs": self.study.to_dict(), "rows": rows, "seconds": self.seconds, "files": dict(self.files)}

    def to_frame(self) -> Any:
        """Return the rows as a DataFrame, one row a design (needs pandas)."""
        return frame_of(self.rows)


@dataclass(frozen=True)
class Fitted:
    """What :func:`fit` found. ``found`` is the fit with all its objects."""

    found: Fit

    def to_dict(self) -> dict[str, Any]:
        """Return the fit in the form of ``dummydesign fit --json``."""
        return self.found.to_dict()

    def to_frame(self) -> Any:
        """Return the parameters with their intervals as a DataFrame, one row a parameter (needs pandas)."""
        records = []
        for name, entry in self.found.to_dict()["parameters"].items():
            parts = {name: entry} if "value" in entry else {f"{name} at {v} mm/s": e for v, e in entry.items()}
            records += [{"parameter": label, **one} for label, one in parts.items()]
        return frame_of(records)


def suggest(
    tissue: str,
    *,
    aim: str = "average",
    resin: str = "polyurethane-nagoya",
    thickness_mm: tuple[float, float] | None = None,
    ratio: tuple[float, float] | None = None,
    verify: bool = False,
    out: str | PathLike[str] | None = None,
) -> Answer:
    """Recommend ratio and thickness of a slab for a tissue (no mould is drawn: see :mod:`dummydesign.mold`).

    Parameters
    ----------
    tissue, resin : str
        Names of the library, or paths of TOML files.
    aim : str
        ``average``, ``safe-side`` or ``subject:NAME``.
    thickness_mm, ratio : (low, high), optional
        Limits with both ends included.
    verify : bool
        Solve the recommended pad by finite elements.
    out : path, optional
        Folder in which the report is written.

    Raises
    ------
    InputError
        For unknown names or ranges outside what is allowed.
    NoAnswerError
        When no slab reaches 10 N steady.
    """
    from dummydesign.design.suggest import Request, accept
    from dummydesign.design.suggest import suggest as search

    request = Request(tissue, aim, resin, _pair(thickness_mm), _pair(ratio), verify=verify)
    accept(request)
    if out is not None:
        from dummydesign.files import output_folder

        output_folder(out)
    found = search(request)
    if out is None:
        return Answer(found)
    from dummydesign.design.safety_view import safety_view
    from dummydesign.report.suggest import write_suggestion

    return Answer(found, write_suggestion(Path(out), found, found.to_dict(), safety_view(found)))


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
    velocity_mm_s: Values = (10.0, 250.0),
    force_N: Values = (1.0, 5.0, 10.0, 15.0),
    fidelity: str = "table",
    executor: Executor | None = None,
    out: str | PathLike[str] | None = None,
    resume: bool = False,
) -> Rows:
    """Work out every combination of slabs, ratios, punches and supports.

    Parameters
    ----------
    thickness_mm, ratio, velocity_mm_s, force_N : number, numbers or text
        See :data:`Values`; the ratio is the resin's reference by default. [mm, resin's ratio, mm/s, N]
    resin, tissue : str
        Names or paths; with a tissue every design is scored for it and ``aim``.
    punch, condition, base : str or several
        Such as ``square:14``, ``bonded``, ``sliding``.
    fidelity : str
        ``table`` or ``axisymmetric``.
    executor : concurrent.futures.Executor, optional
        Runs the tasks side by side, from any library with this interface.
    out : path, optional
        Folder of ``rows.csv`` and the report.
    resume : bool
        Keep the rows that are in ``out``.

    Raises
    ------
    InputError
        For names, ranges or a number of designs that are not allowed.
    NoAnswerError
        When a worker was lost; what was done is in ``out``.
    """
    from dummydesign.design.punch import equal_area_radius_mm
    from dummydesign.design.study import Study
    from dummydesign.design.whatif import whatif as work_out
    from dummydesign.resin import load_resin

    material = load_resin(resin)
    study = Study(
        _values(thickness_mm, "thickness in mm"),
        (material.relaxation_ratio_ref,) if ratio is None else _values(ratio, "ratio"),
        tuple((name, equal_area_radius_mm(name)) for name in _names(punch)),
        _values(velocity_mm_s, "velocity in mm/s"),
        _values(force_N, "force in N"),
        resin,
        tissue,
        aim,
        fidelity,
        _names(condition),
        _names(base),
    )
    study.check(material)
    if out is None:
        found = work_out(study, executor=executor)
        return Rows(study, tuple(found["rows"]), found["seconds"])
    from dummydesign.design.rows_file import RowsFile, settings_of
    from dummydesign.files import output_folder
    from dummydesign.report.whatif import write_whatif
    from dummydesign.tissue.store import load_tissue

    sites = None if tissue is None else load_tissue(tissue)
    folder = output_folder(out)
    file = RowsFile(folder, study, settings_of(study, material, sites), resume)
    found = work_out(study, executor=executor, file=file)
    files = {"rows": str(file.path), **write_whatif(folder, study, found["rows"], material, sites, [])}
    return Rows(study, tuple(found["rows"]), found["seconds"], files)


def fit(
    traces: Iterable[str | PathLike[str] | Trace],
    *,
    elements: int | str = "auto",
    law: str = "ode",
    mode: str = "joint",
    lowpass: str | None = None,
) -> Fitted:
    """Fit the tissue law to traces of one tissue or dummy; see :func:`dummydesign.tissue.fit.fit_traces`.

    Parameters
    ----------
    traces : iterable of path or Trace
        CSV files with time_s, displacement_mm, force_N, or traces in memory.
    elements : 3, 5, 7 or "auto"
    law : str
        ``ode``, ``consistent`` or ``published``.
    mode : str
        ``joint``, ``per-speed`` or ``per-condition``.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``.

    Raises
    ------
    InputError
        For files or settings that cannot be used.
    """
    from dummydesign.protocol.sensor import parse_lowpass
    from dummydesign.protocol.trace import Trace, read_trace
    from dummydesign.tissue.fit import fit_traces

    read = [trace if isinstance(trace, Trace) else read_trace(Path(trace)) for trace in traces]
    return Fitted(fit_traces(read, elements, law, mode, parse_lowpass(lowpass)))


def _pair(limits: tuple[float, float] | None) -> tuple[float, float] | None:
    return None if limits is None else (float(limits[0]), float(limits[1]))


def _values(values: Values, quantity: str) -> tuple[float, ...]:
    """Read numbers however they are given."""
    if isinstance(values, str):
        from dummydesign.design.ranges import parse_values

        return tuple(parse_values(values, quantity))
    try:
        found = tuple(float(value) for value in (values if isinstance(values, Iterable) else (values,)))
    except (TypeError, ValueError):
        raise InputError(f"{quantity} = {values!r} is not a number, a list of numbers or text like 3:30:0.5") from None
    if not found:
        raise InputError(f"{quantity} has no value; give at least one")
    return found


def _names(names: str | Iterable[str]) -> tuple[str, ...]:
    return tuple(names.split(",")) if isinstance(names, str) else tuple(names)
