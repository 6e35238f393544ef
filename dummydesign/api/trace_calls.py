"""The calls that read traces: :func:`fit` the tissue law to them, :func:`compare` them with a tissue."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace as replace_fields
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dummydesign.api.answers import Fitted, Result
from dummydesign.api.questions import question
from dummydesign.core.errors import InputError
from dummydesign.core.references import PAPER

if TYPE_CHECKING:
    from dummydesign.core.outputs.manifest import Question
    from dummydesign.design.own_test.of_traces import TracesTest
    from dummydesign.measurement.pad_record import PadRecord
    from dummydesign.measurement.trace import Trace
    from dummydesign.tissue.comparison.compare import Comparison
    from dummydesign.tissue.fitting.fit import Fit
    from dummydesign.tissue.model.tissue import Tissue

LAW_SOURCE = f"{PAPER}, equations (4) to (6)"
Traces = Iterable["str | PathLike[str] | Trace"]
Numbers = float | str | Iterable[float | str]


def fit(
    traces: Traces,
    *,
    elements: int | str = "auto",
    law: str = "ode",
    mode: str = "auto",
    contact: str = "none",
    lowpass: str | None = None,
    out: str | PathLike[str] | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
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
        ``auto`` (per speed when speeds differ, else joint), ``joint``, ``per-speed`` or ``per-condition``.
    contact : str
        ``none``, or ``per-press``: an offset of the contact of each press is fitted too.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``.
    out : path, optional
        Tissue file (TOML) to write, with residuals, report and manifest beside it; the next free number when a
        file of this name is there that another fit wrote.
    replace : bool
        Take the place of the other file instead.
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
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.fitting.fit import fit_traces

    if str(elements) not in ("3", "5", "7", "auto"):
        raise InputError(f"elements = {elements} is not one of 3, 5, 7, auto")
    count = elements if elements == "auto" else int(elements)
    passed = parse_lowpass(lowpass)
    if out is not None and not str(out).lower().endswith(".toml"):
        raise InputError(f"out = '{out}' must end in .toml: a tissue file is written there")
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

    def answered(fitted: Fit, path: Path | None) -> dict[str, Any]:
        place = None if path is None else str(path)
        return {"inputs": {**inputs, "out": place}, **fitted.to_dict(), "sources": [LAW_SOURCE], "files": {}}

    if out is None:
        found = fit_traces(read, count, law, mode, passed, contact=contact, progress=progress)
        return Fitted(found, answered(found, None))
    from dummydesign.core.outputs.write import new_files
    from dummydesign.report.files.fit import write_fit

    with new_files(out, _question("fit", inputs, names, read), replace=replace) as output:
        found = fit_traces(read, count, law, mode, passed, contact=contact, progress=progress)
        name = f"{output.place.stem}.toml"
        result = answered(found, output.folder / name)
        result["files"] = write_fit(found, fspath(output.work / name), [LAW_SOURCE])
        result = output.answer(result)
    return Fitted(found, result)


def compare(
    traces: Traces,
    tissue: str,
    *,
    lowpass: str | None = None,
    record: str | PathLike[str] | None = None,
    punch: str = "square:14",
    edge_radius_mm: float | str = 0.0,
    force_N: Numbers | None = None,
    velocity_mm_s: Numbers | None = None,
    hold_s: float | str | None = None,
    deceleration_mm_s2: float | str | None = None,
    condition: str | None = None,
    out: str | PathLike[str] | None = None,
    replace: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Result:
    """Compare the traces of a cast dummy with a tissue; see :mod:`dummydesign.tissue.comparison.compare`.

    Parameters
    ----------
    traces : iterable of path or Trace
        CSV files with time_s, displacement_mm, force_N, or traces in memory.
    tissue : str
        Name of the library, or path of a TOML file.
    lowpass : str, optional
        Filter the forces went through, ``HZ[:ORDER[:PASSES]]``.
    record : path, optional
        Record of the pad as it was cast, by ``mold record``: told beside the verdict.
    punch : str
        Of the test, as in :func:`dummydesign.suggest`.
    edge_radius_mm : float
        Fillet of its edge. [mm]
    force_N, velocity_mm_s : numbers or text, optional
        Steady forces and speeds of the test: presses to others are left out, and one that was not made leaves the
        verdict open. The steady curve is judged from the lowest to the highest force. Without them every press
        counts as it was made, and the curve from 5 to 15 N. [N, mm/s]
    hold_s : float, optional
        Hold of the test: traces that were held longer are cut there; else the hold of each press. [s]
    deceleration_mm_s2 : float, optional
        Braking of the robot; else read from each motion. [mm/s2]
    condition : str, optional
        How the punch held the face, as in :func:`dummydesign.suggest`: said beside the answer.
    out : path, optional
        Folder of tables and report, which are not written without it; the next free number when it holds another
        answer.
    replace : bool
        Take the place of the other answer instead.
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
    from dummydesign.design.assessment.verdict_of_traces import verdict_of_traces
    from dummydesign.design.own_test.of_traces import read_test
    from dummydesign.measurement.pad_record import read_record
    from dummydesign.measurement.sensor import parse_lowpass
    from dummydesign.tissue.comparison.compare import compare_traces
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
    }
    if record is not None:
        inputs["record"] = fspath(record)

    def answered() -> tuple[Comparison, dict[str, Any]]:
        made = compare_traces(read, site, passed, test.presses, progress)
        compared = _in_test(_of_pad(made, pad), test, site)
        return compared, verdict_of_traces(compared, site).to_dict()

    if out is None:
        found, judged = answered()
        known = {"inputs": inputs, "verdict": judged, **found.result}
        return Result(found, {**known, "sources": list(site.sources), "files": {}}, "compare")
    from dummydesign.core.outputs.write import new_folder
    from dummydesign.report.files.compare import write_comparison

    more = [fspath(name) for name in (record, punch.partition("profile:")[2] or None) if name is not None]
    with new_folder(out, _question("compare", inputs, [*names, *more], read, tissue), replace=replace) as output:
        found, judged = answered()
        head = {"inputs": {**inputs, "out": str(output.folder)}, "verdict": judged, **found.result}
        files = write_comparison(found, site, output.work, judged)
        output.extra["summary"] = {"verdict": judged["level"], "text": judged["text"]}
        result = output.answer({**head, "sources": list(site.sources), "files": files})
    return Result(found, result, "compare")


def _in_test(found: Comparison, test: TracesTest, tissue: Tissue) -> Comparison:
    """The comparison with the test that was given, and what must be said of the tissue in it."""
    said = [*test.warnings(tissue), *found.result["warnings"]]
    given = {"test": test.given} if test.given else {}
    return replace_fields(found, result={**found.result, **given, "warnings": said})


def _of_pad(found: Comparison, pad: PadRecord | None) -> Comparison:
    """The comparison with the pad as it was cast, and a warning of each limit that it missed."""
    if pad is None:
        return found
    told = {key: value for key, value in pad.to_dict().items() if key not in ("schema", "limits")}
    return replace_fields(
        found, result={**found.result, "pad": told, "warnings": [*found.result["warnings"], *pad.warnings()]}
    )


def _question(
    command: str, inputs: dict[str, Any], names: list[str], traces: list[Trace], tissue: str | None = None
) -> Question:
    """The question of a call with traces; those in memory count by their numbers."""
    from hashlib import sha256

    numbers = [
        sha256(b"".join(part.tobytes() for part in (one.time_s, one.displacement_mm, one.force_N))).hexdigest()
        for one in traces
    ]
    files = [name for name in names if Path(name).is_file()]
    return question(command, {**inputs, "trace_numbers_sha256": numbers}, tissue=tissue, files=files)


def _read(traces: Traces) -> tuple[list[str], list[Trace]]:
    """Names and traces; files are read."""
    from dummydesign.measurement.trace import Trace, read_trace

    given = list(traces)
    read = [trace if isinstance(trace, Trace) else read_trace(fspath(trace)) for trace in given]
    names = [one.name if isinstance(one, Trace) else fspath(one) for one in given]
    for one in read:
        back = (one.time_s[1:] <= one.time_s[:-1]).nonzero()[0]
        if len(back):
            at = int(back[0]) + 1
            raise InputError(f"{one.name}: time_s does not increase at sample {at} ({one.time_s[at]:g} s)")
    return names, read
