"""The calls that read traces: import, fit, compare, and presses carried over to people."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
from dataclasses import replace as replace_fields
from math import pi
from os import fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Fitted, Result, answer_folder, question
from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath
from dummydesign.core.parsing import DELAY, DELAYS_S, RATE, RATES_HZ, read_allowed
from dummydesign.core.quantity import NAGOYA_CITATION
from dummydesign.core.serialise import to_plain

if TYPE_CHECKING:
    from dummydesign.core.manifest import Question
    from dummydesign.measurement.importing.decisions import Settings
    from dummydesign.measurement.trace import Trace

LAW_SOURCE = f"{NAGOYA_CITATION}, equations (4) to (6)"
Traces = Iterable["FilePath | Trace"]
Numbers = float | str | Iterable[float | str]


def fit(
    traces: Traces,
    *,
    elements: int | str = "auto",
    law: str = "ode",
    mode: str = "auto",
    contact: str = "none",
    lowpass: str | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Fitted:
    """Fit the tissue law to traces of one tissue or dummy; see :func:`dummydesign.tissue.fitting.fit.fit_traces`.

    Parameters
    ----------
    traces : TRACE.csv ...
        time_s,displacement_mm,force_N.

        Or traces in memory.
    elements : 3|5|7|auto
        ``auto`` (default): chosen by AICc, or fewer if these predict left-out presses better.

        Springs and dampers of the law: one spring, and two elements for each Maxwell branch.
    law : published|consistent|ode
        ``ode`` (default): the law along the measured motion; ``published``, ``consistent``: closed forms of an ideal
        ramp and hold, as printed and as they follow from the law.
    mode : joint|per-speed|per-condition
        ``joint``: one set of parameters for all presses; ``per-speed``: springs shared, dampers of their own for each
        speed, as the paper reports them; ``per-condition``: every speed and depth by itself, then the mean, without
        intervals; default ``auto``: per-speed when speeds differ, else joint.
    contact : none|per-press
        ``per-press``: fit where each press touched, as an offset of its zero; for presses whose contact is late or
        early (fit proposes it when that explains the residual).
    lowpass : HZ[:ORDER[:PASSES]]
        Filter the force went through.
    out : tissue.toml
        Write a tissue file; its report in a folder NAME-report beside it.

        The next free number when a file of this name is there that another fit wrote.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Fitted
        The same as ``dummydesign fit --json`` prints for the same question.

    Raises
    ------
    InputError
        For files or settings that cannot be used.

    Examples
    --------
    A press that the law itself gives is fitted by the law's own parameters.

    >>> import dummydesign
    >>> from dummydesign.measurement.motion import ramp_and_hold
    >>> from dummydesign.measurement.trace import Trace
    >>> from dummydesign.tissue import load_tissue
    >>> finger = load_tissue("forefinger").target()
    >>> motion = ramp_and_hold(10.0, 1.5, hold_s=5.0, hold_points=400)
    >>> trace = Trace("press", motion.time_s, motion.displacement_mm, finger.force(motion, 10.0))
    >>> found = dummydesign.fit([trace], elements=5).to_dict()["parameters"]
    >>> f"{finger.gamma1_N_per_mm3:.3f}, fitted {found['gamma1_N_per_mm3']['value']:.3f}"
    '3.635, fitted 3.635'
    """
    from dummydesign.core.outputs import new_files
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.fitting.fit import fit_traces

    if str(elements) not in ("3", "5", "7", "auto"):
        message = f"elements = {elements} is not one of 3, 5, 7, auto"
        raise InputError(message, "unknown_name", "elements", elements, (3, 5, 7, "auto"))
    count = elements if elements == "auto" else int(elements)
    passed = parse_lowpass(lowpass)
    out = out or None
    if out is not None and not str(out).lower().endswith(".toml"):
        message = f"out = '{out}' must end in .toml: a tissue file is written there"
        raise InputError(message, "bad_name", "out", str(out))
    names, read = _read(traces)
    inputs = {
        "traces": names,
        "elements": str(elements),
        "law": law,
        "mode": mode,
        "contact": contact,
        "lowpass": passed.to_dict() if passed else None,
        "out": None if out is None else fspath(out),
    }
    asked = _question("fit", inputs, names, read)
    with nullcontext() if out is None else new_files(out, asked, replace=replace) as output:
        fitted = fit_traces(read, count, law, mode, passed, contact=contact, progress=progress)
        result = {"inputs": inputs, **fitted.result, "sources": [LAW_SOURCE], "files": {}}
        if output is not None:
            from dummydesign.report.fit import write_fit

            name = f"{output.target.stem}.toml"
            files = write_fit(fitted, fspath(output.work / name), [LAW_SOURCE])
            result |= {"inputs": {**inputs, "out": str(output.folder / name)}, "files": files}
            result = output.answer(result)
    return Fitted(fitted, result)


def compare(
    traces: Traces,
    tissue: str,
    *,
    lowpass: str | None = None,
    record: FilePath | None = None,
    punch: str = "square:14",
    edge_radius_mm: float | str = 0.0,
    force_N: Numbers | None = None,
    velocity_mm_s: Numbers | None = None,
    hold_s: float | str | None = None,
    deceleration_mm_s2: float | str | None = None,
    condition: str | None = None,
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Compare the traces of a cast dummy with a tissue; see :mod:`dummydesign.tissue.comparison`.

    Parameters
    ----------
    traces : TRACE.csv ...
        time_s,displacement_mm,force_N.

        Or traces in memory.
    tissue : --tissue NAME|FILE
        See 'dummydesign tissues list'.
    lowpass : HZ[:ORDER[:PASSES]]
        Filter the force went through.
    record : FILE
        The pad as it was cast, by 'mold record'.
    punch : KIND:SIZE
        ``square:14`` (default), ``rectangle:AxB``, ``round:D``, ``ball:D``, ``profile:FILE.csv``.
    edge_radius_mm : MM
        Fillet of the punch's edge (default 0, sharp). [mm]
    condition : NAME
        ``bonded`` (default; under a ball or a profile frictionless), ``frictionless``, ``friction:MU`` (for the report
        only).
    force_N : F1,F2,...
        Steady forces in N: presses to others are left out. [N]

        One that was not made leaves the verdict open. The steady curve is judged from the lowest to the highest force.
        Without them every press counts as it was made, and the curve from 5 to 15 N.
    velocity_mm_s : V1,V2,...
        Speeds in mm/s: presses at others are left out. [mm/s]
    hold_s : S
        Hold after the stop: longer traces are cut there. [s]
    deceleration_mm_s2 : MM_S2
        Braking (default: read from the motion). [mm/s2]
    out : DIR
        Folder of the files (default compare-TISSUE).

        Without it nothing is written; the next free number when it holds another answer.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
    progress : callable, optional
        Called with a word at each step.

    Returns
    -------
    Result
        The same as ``dummydesign compare --json`` prints for the same question.

    Raises
    ------
    InputError
        For names or files that cannot be used.
    """
    from dummydesign.design.measured_pad import (
        budget_of_traces,
        curves_of_traces,
        read_test,
        readings_of_traces,
        shares_of_traces,
        verdict_of_traces,
    )
    from dummydesign.measurement.pad_record import read_record
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.comparison import compare_traces
    from dummydesign.tissue.model.tissue_file import load_tissue

    test = read_test(punch, edge_radius_mm, force_N, velocity_mm_s, hold_s, deceleration_mm_s2, condition)
    site, passed = load_tissue(tissue), parse_lowpass(lowpass)
    pad = None if record is None else read_record(fspath(record))
    names, read = _read(traces)
    inputs = {
        "traces": names,
        "tissue": tissue,
        "lowpass": passed.to_dict() if passed else None,
        **test.to_dict(),
        "out": None if out is None else fspath(out),
        **({} if record is None else {"record": fspath(record)}),
    }
    more = [fspath(name) for name in (record, punch.partition("profile:")[2] or None) if name is not None]
    with answer_folder(out, _question("compare", inputs, [*names, *more], read, tissue), replace) as output:
        comparison = compare_traces(read, site, passed, test.presses, progress)
        values = dict(comparison.result)
        if pad is not None:
            values["pad"] = {key: one for key, one in pad.to_dict().items() if key not in ("schema", "limits")}
        if test.given:
            values["test"] = test.given
        missed = [] if pad is None else pad.warnings()
        values["warnings"] = [*test.warnings(site), *comparison.result["warnings"], *missed]
        values["curves"] = to_plain(curves_of_traces(comparison, site, passed))
        found = readings_of_traces(comparison, site)
        values["budget"] = to_plain(budget_of_traces(comparison, site, *found))
        comparison = replace_fields(comparison, result=values)
        judged = verdict_of_traces(comparison, site, found).to_dict()
        people = shares_of_traces(comparison, site, passed).to_dict()
        result = {
            "inputs": inputs,
            "verdict": judged,
            "people": people,
            **values,
            "sources": list(site.sources),
            "files": {},
        }
        if output is not None:
            from dummydesign.report.compare import write_comparison

            files = write_comparison(comparison, site, output.work, result)
            output.extra["summary"] = {"verdict": judged["level"], "text": judged["text"]}
            result = output.answer({**result, "inputs": {**inputs, "out": str(output.folder)}, "files": files})
    return Result(comparison, result, "compare")


def _question(
    command: str, inputs: dict[str, Any], names: list[str], traces: list[Trace], tissue: str | None = None
) -> Question:
    """Make the question of a call with traces; those in memory count by their numbers."""
    from hashlib import sha256

    numbers = [
        sha256(b"".join(part.tobytes() for part in (one.time_s, one.displacement_mm, one.force_N))).hexdigest()
        for one in traces
    ]
    files = [name for name in names if Path(name).is_file()]
    return question(command, {**inputs, "trace_numbers_sha256": numbers}, tissue=tissue, files=files)


def _read(traces: Traces) -> tuple[list[str], list[Trace]]:
    """Return names and traces; files are read."""
    from dummydesign.measurement.trace import Trace, read_trace

    given = list(traces)
    read = [trace if isinstance(trace, Trace) else read_trace(fspath(trace)) for trace in given]
    names = [one.name if isinstance(one, Trace) else fspath(one) for one in given]
    for one in read:
        back = (one.time_s[1:] <= one.time_s[:-1]).nonzero()[0]
        if len(back):
            at = int(back[0]) + 1
            message = f"{one.name}: time_s does not increase at sample {at} ({one.time_s[at]:g} s)"
            raise InputError(message, "malformed", "time_s", float(one.time_s[at]))
    return names, read


def import_traces(
    files: Iterable[FilePath],
    *,
    profile: str | None = None,
    save_profile: str | None = None,
    columns: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
    skip: int | None = None,
    flip: Iterable[str] | None = None,
    tare: str | None = None,
    contact: str | None = None,
    split: str | None = None,
    sheets: str | None = None,
    rate: float | str | None = None,
    delay: float | str | None = None,
    out: FilePath | None = None,
    replace: bool = False,
) -> Result:
    """Read files as test machines wrote them, and write each press as a trace.

    What is None is taken from the profile, and where there is none from the file.

    Parameters
    ----------
    files : FILE|FOLDER ...
        Text in any usual form, or a workbook (extra xlsx).

        A folder stands for the files in it.
    profile : NAME|FILE
        Saved settings of a machine; other options override it.
    save_profile : NAME
        Save the settings under this name.

        With the columns and signs of text that were found.
    columns : time=NAME,...
        Column of time, displacement or force: its name or number.

        In Python a mapping.
    units : time=s,...
        Unit of time, displacement or force; 0.5N: one count is 0.5 N.

        In Python a mapping.
    rate : HZ
        Sampling rate of evenly spaced samples, where the file has no time.
    delay : S
        The force is so much later than the displacement.

        By a filter or another clock.
    separator : C
        Between columns: ``tab``, ``semicolon``, ``comma``, ``bar`` or ``spaces``.
    decimal : C
        Decimal sign: . or ,
    encoding : E
        Such as ``utf-8``, ``utf-16``, ``cp1252``, ``cp932``.
    skip : N
        Lines to leave out at the start of the file.
    flip : WHICH
        Reverse the sign of displacement, force, or displacement,force; none (default: detected).

        In Python a list of them; empty for none.
    tare : auto|none|first|drift|slope|N
        Force reading without load in N (or with a unit), counted as in the file; drift, slope: what grows with time or
        depth too.
    contact : auto|none|MM
        Displacement reading at contact in mm (or with a unit), counted as in the file (default auto: by force).
    split : auto|none
        ``auto``: split where force and depth return to zero; ``none``: one press.
    sheets : NAME,...
        Sheets of a workbook or specimens to read; not:NAME,...: all others.
    out : DIR
        Folder of the traces (default import-NAME).

        Without it neither traces nor preview are written; the next free number when it holds another answer.
    replace
        Take the place of another answer in --out, or of the profile's name.

    Returns
    -------
    Result
        The same as ``dummydesign import --json`` prints; ``outcome`` is the list of
        :class:`~dummydesign.measurement.importing.read.Imported`, with the presses as arrays.

    Raises
    ------
    InputError
        For files that cannot be read, and for what they leave open: then with the option that settles it.
    """
    from dummydesign.measurement.importing.read import describe, import_files, learned, plan_traces, write_traces
    from dummydesign.measurement.importing.read import save_profile as keep

    given: dict[str, Any] = {
        "columns": columns,
        "units": units,
        "separator": separator,
        "decimal": decimal,
        "encoding": encoding,
        "skip": skip,
        "tare": tare,
        "contact": contact,
        "split": split,
        "sheets": sheets,
        "rate": None if rate is None else read_allowed(rate, RATE, *RATES_HZ),
        "delay": None if delay is None else read_allowed(delay, DELAY, *DELAYS_S),
        "flip": None if flip is None else frozenset(flip),
    }
    settings = _settings(profile, {key: value for key, value in given.items() if value is not None})
    names = [fspath(name) for name in files]
    imported, warnings = import_files(names, settings)
    inputs = {
        "files": names,
        "profile": profile,
        **settings.to_dict(),
        "save_profile": save_profile,
        "out": None if out is None else fspath(out),
    }
    planned = plan_traces(imported, None if out is None else Path(out))
    described = describe(imported, planned)
    of_files = [warning for one in described for warning in one["warnings"]]
    result: dict[str, Any] = {"inputs": inputs, "files": described, "preview": None, "warnings": [*of_files, *warnings]}
    profiles: dict[str, str] = {}
    asked = {key: value for key, value in inputs.items() if key not in ("sheets", "rate", "delay") or value is not None}
    with answer_folder(out, question("import", asked, files=[one.source for one in imported]), replace) as output:
        if save_profile:
            # first: a name that is taken must not leave traces behind
            profiles = {"profile": str(keep(save_profile, learned(settings, imported), replace))}
        if output is not None:
            from dummydesign.report.import_preview import write_preview

            write_traces(planned, output.work)
            output.extra["summary"] = {"traces": sum(len(one["traces"]) for one in described)}
            result["preview"] = output.settled(write_preview(output.work, imported, described, warnings))
            result["inputs"] = {**inputs, "out": str(output.folder)}
            result["manifest"] = str(output.folder / output.target.manifest)
            result["warnings"] += output.target.warnings
    return Result(imported, result | profiles, "import_traces")


def _settings(profile: str | None, given: dict[str, Any]) -> Settings:
    """What the caller and the profile settle together; the caller wins."""
    from dummydesign.measurement.importing.decisions import Settings
    from dummydesign.measurement.importing.read import load_profile

    base = load_profile(profile) if profile else Settings()
    for key in ("columns", "units"):
        if key in given:
            given[key] = {**getattr(base, key), **given[key]}
    return replace_fields(base, **given)


GUARD_BAND = "JCGM 106:2012, The role of measurement uncertainty in conformity assessment"


def on_person(
    traces: Traces,
    tissue: str,
    *,
    drive: str = "position",
    limits: FilePath | None = None,
    lowpass: str | None = None,
    rate: float | str = 1000.0,
    punch: str = "square:14",
    out: FilePath | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Work out what presses on a pad would have been on people; see :mod:`dummydesign.person`.

    Parameters
    ----------
    traces : TRACE.csv ...
        One press a file: columns time_s, displacement_mm, force_N, zero at contact ('dummydesign import').

        Or traces in memory.
    tissue : --tissue NAME|FILE
        The people: a name of 'dummydesign tissues list', or a tissue file.
    drive : NAME
        What moves the robot: ``position`` (default), ``steady``, ``force``, ``mass:KG``, ``spring:K,M`` or
        ``spring:K,M,ZETA``.
    limits : FILE.toml
        Your limits of force and pressure, with their source; without it, a template is written.
    lowpass : HZ[:ORDER[:PASSES]]
        Low-pass filter of the force sensor; its delay is undone.
    rate : HZ
        Samples per second of on_person.csv (default 1000).
    punch : KIND:SIZE
        Face of the punch, for the mean pressure: ``square:14`` (default), ``rectangle:AxB``, ``round:D``.
    out : DIR
        Folder of report and curves (default on-person-TISSUE).

        Without it nothing is written.
    replace
        Overwrite an earlier answer in --out (default: keep it and number the new folder).
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
    from dummydesign.geometry.punch import equal_area_radius_mm
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.person.drives import read_drive
    from dummydesign.person.limits import read_limits
    from dummydesign.person.on_person import budget_of_people
    from dummydesign.person.on_person import on_person as work_out
    from dummydesign.tissue.model.tissue_file import load_tissue

    moved, rate_hz = read_drive(drive), read_allowed(rate, RATE, *RATES_HZ)
    area = pi * equal_area_radius_mm(punch) ** 2
    site, passed = load_tissue(tissue), parse_lowpass(lowpass)
    allowed = None if limits is None else read_limits(fspath(limits))
    names, read = _read(traces)
    inputs: dict[str, Any] = {
        "traces": names,
        "tissue": tissue,
        "drive": moved.text,
        "limits": None if limits is None else fspath(limits),
        "lowpass": passed.to_dict() if passed else None,
        "rate": rate_hz,
        "punch": punch,
        "out": None if out is None else fspath(out),
    }
    more = [] if limits is None else [fspath(limits)]
    with answer_folder(out, _question("on-person", inputs, [*names, *more], read, tissue), replace) as output:
        answer = work_out(read, site, moved, limits=allowed, lowpass=passed, area_mm2=area, progress=progress)
        sources = [*site.sources, *([GUARD_BAND] if allowed is not None else [])]
        result: dict[str, Any] = {
            "inputs": inputs,
            "drive": moved.text,
            "tissue": site.name,
            "presses": [one.to_dict(area) for one in answer.presses],
            "budget": to_plain(budget_of_people(answer)),
            "limits_file": to_plain(allowed.to_dict()) if allowed is not None else None,
            "warnings": [dict(one) for one in answer.warnings],
            "sources": sources,
            "files": {},
        }
        if output is not None:
            from dummydesign.report.on_person import write_on_person

            files = write_on_person(answer, result, rate_hz, output.work)
            result = output.answer({**result, "inputs": {**inputs, "out": str(output.folder)}, "files": files})
    return Result(answer, result, "on_person")
