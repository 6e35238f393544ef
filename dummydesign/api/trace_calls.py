"""The calls that read traces: :func:`fit` the tissue law to them, :func:`compare` them with a tissue."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING

from dummydesign.api.answers import Fitted, Result
from dummydesign.core.errors import InputError
from dummydesign.core.references import PAPER

if TYPE_CHECKING:
    from dummydesign.measurement.trace import Trace

LAW_SOURCE = f"{PAPER}, equations (4) to (6)"
Traces = Iterable["str | PathLike[str] | Trace"]


def fit(
    traces: Traces,
    *,
    elements: int | str = "auto",
    law: str = "ode",
    mode: str = "joint",
    lowpass: str | None = None,
    out: str | PathLike[str] | None = None,
) -> Fitted:
    """Fit the tissue law to traces of one tissue or dummy; see :func:`dummydesign.tissue.fitting.fit.fit_traces`.

    Parameters
    ----------
    traces : iterable of path or Trace
        CSV files with time_s, displacement_mm, force_N, or traces in memory.
    elements : 3, 5, 7 or "auto"
        Springs and dampers of the law: one spring, and two elements for each Maxwell branch.
    law : str
        ``ode``, ``consistent`` or ``published``.
    mode : str
        ``joint``, ``per-speed`` or ``per-condition``.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``.
    out : path, optional
        Tissue file (TOML) to write, with residuals and report beside it.

    Returns
    -------
    Fitted
        The same as ``dummydesign fit --json`` prints for the same question.

    Raises
    ------
    InputError
        For files or settings that cannot be used.
    """
    from dummydesign.core.files import output_folder
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.fitting.fit import fit_traces

    if str(elements) not in ("3", "5", "7", "auto"):
        raise InputError(f"elements = {elements} is not one of 3, 5, 7, auto")
    count = elements if elements == "auto" else int(elements)
    passed = parse_lowpass(lowpass)
    if out is not None:
        if not str(out).lower().endswith(".toml"):
            raise InputError(f"out = '{out}' must end in .toml: a tissue file is written there")
        output_folder(Path(out).parent)
    names, read = _read(traces)
    found = fit_traces(read, count, law, mode, passed)
    inputs = {
        "traces": names,
        "elements": str(elements),
        "law": law,
        "mode": mode,
        "lowpass": passed.to_dict() if passed else None,
        "out": None if out is None else fspath(out),
    }
    files: dict[str, str] = {}
    if out is not None:
        from dummydesign.report.files.fit import write_fit

        files = write_fit(found, fspath(out), [LAW_SOURCE])
    return Fitted(found, {"inputs": inputs, **found.to_dict(), "sources": [LAW_SOURCE], "files": files})


def compare(
    traces: Traces, tissue: str, *, lowpass: str | None = None, out: str | PathLike[str] | None = None
) -> Result:
    """Compare the traces of a cast dummy with a tissue; see :mod:`dummydesign.tissue.fitting.compare`.

    Parameters
    ----------
    traces : iterable of path or Trace
        CSV files with time_s, displacement_mm, force_N, or traces in memory.
    tissue : str
        Name of the library, or path of a TOML file.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``.
    out : path, optional
        Folder of tables and report, which are not written without it.

    Returns
    -------
    Result
        The same as ``dummydesign compare --json`` prints for the same question.

    Raises
    ------
    InputError
        For names or files that cannot be used.
    """
    from dummydesign.core.files import output_folder
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.fitting.compare import compare_traces
    from dummydesign.tissue.model.tissue_file import load_tissue

    site, passed = load_tissue(tissue), parse_lowpass(lowpass)
    names, read = _read(traces)
    folder = None if out is None else output_folder(out)
    found = compare_traces(read, site, passed)
    inputs = {
        "traces": names,
        "tissue": tissue,
        "lowpass": passed.to_dict() if passed else None,
        "out": None if out is None else fspath(out),
    }
    files: dict[str, str] = {}
    if folder is not None:
        from dummydesign.report.files.compare import write_comparison

        files = write_comparison(found, site, folder)
    return Result(found, {"inputs": inputs, **found.result, "sources": list(site.sources), "files": files})


def _read(traces: Traces) -> tuple[list[str], list[Trace]]:
    """Names and traces; files are read."""
    from dummydesign.measurement.trace import Trace, read_trace

    names, read = [], []
    for trace in traces:
        in_memory = isinstance(trace, Trace)
        names.append(trace.name if in_memory else fspath(trace))
        read.append(trace if in_memory else read_trace(trace))
    return names, read
