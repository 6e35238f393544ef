"""The call that carries presses on a pad over to people."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike, fspath
from typing import Any

from dummydesign.api.answers import Result, answer_folder
from dummydesign.api.traces import Traces, question_of_traces, read_traces
from dummydesign.core.parsing import RATE, RATES_HZ, read_allowed

GUARD_BAND = "JCGM 106:2012, The role of measurement uncertainty in conformity assessment"


def on_person(
    traces: Traces,
    tissue: str,
    *,
    drive: str = "position",
    limits: str | PathLike[str] | None = None,
    lowpass: str | None = None,
    rate: float | str = 1000.0,
    punch: str = "square:14",
    out: str | PathLike[str] | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Work out what presses on a pad would have been on people; see :mod:`dummydesign.person`.

    Parameters
    ----------
    traces : iterable of path or Trace
        CSV files with time_s, displacement_mm, force_N, or traces in memory; one press each, zero at contact.
    tissue : str
        Name of the library, or path of a TOML file.
    drive : str
        What moves the robot: ``position``, ``steady``, ``force``, ``mass:KG`` or
        ``spring:N_PER_MM,KG[,DAMPING_RATIO]``.
    limits : path, optional
        Own limits of force and pressure, as in :func:`dummydesign.suggest`.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``; it is undone.
    rate : float
        Of the curves in ``on_person.csv``. [Hz]
    punch : str
        Its face gives the mean pressure: ``square:14``, ``round:16``, ``rectangle:20x10``.
    out : path, optional
        Folder of table, curves and report, which are not written without it.
    replace : bool
        Take the place of another answer in ``out``.
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Result
        The same as ``dummydesign on-person --json`` prints.

    Raises
    ------
    InputError
        For names, files, presses or numbers that cannot be used.
    """
    import math

    from dummydesign.core.serialise import to_plain
    from dummydesign.design.assessment.safety import read_limits
    from dummydesign.geometry.punch import equal_area_radius_mm
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.person.drives import read_drive
    from dummydesign.person.on_person import on_person as work_out
    from dummydesign.tissue.model.tissue_file import load_tissue

    moved, rate_hz = read_drive(drive), read_allowed(rate, RATE, *RATES_HZ)
    area = math.pi * equal_area_radius_mm(punch) ** 2
    site, passed = load_tissue(tissue), parse_lowpass(lowpass)
    allowed = None if limits is None else read_limits(fspath(limits))
    names, read = read_traces(traces)
    inputs: dict[str, Any] = {
        "traces": names, "tissue": tissue, "drive": moved.text, "limits": None if limits is None else fspath(limits),
        "lowpass": passed.to_dict() if passed else None, "rate": rate_hz, "punch": punch,
        "out": None if out is None else fspath(out),
    }  # fmt: skip
    more = [] if limits is None else [fspath(limits)]
    with answer_folder(out, question_of_traces("on-person", inputs, [*names, *more], read, tissue), replace) as output:
        found = work_out(read, site, moved, limits=allowed, lowpass=passed, area_mm2=area, progress=progress)
        sources = [*site.sources, *([GUARD_BAND] if allowed is not None else [])]
        result: dict[str, Any] = {
            "inputs": inputs, "drive": moved.text, "tissue": site.name,
            "presses": [one.to_dict(area) for one in found.presses],
            "limits_file": to_plain(allowed.to_dict()) if allowed is not None else None,
            "warnings": [dict(one) for one in found.warnings], "sources": sources, "files": {},
        }  # fmt: skip
        if output is not None:
            from dummydesign.report.on_person import write_on_person

            files = write_on_person(found, result, rate_hz, output.work)
            result = output.answer({**result, "inputs": {**inputs, "out": str(output.folder)}, "files": files})
    return Result(found, result, "on_person")
