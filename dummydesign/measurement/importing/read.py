"""Files to presses and traces: zero at contact, tared, compression positive; the profile of a machine."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_bytes, write_text, writing
from dummydesign.core.parsing import NUMBER
from dummydesign.core.serialise import to_plain
from dummydesign.core.toml_schema import read_table
from dummydesign.core.user_library import DEVICE, Entry, entries, find, toml_table, user_folder
from dummydesign.measurement.importing import contact as contact_zero
from dummydesign.measurement.importing.baseline import Baseline
from dummydesign.measurement.importing.decisions import Decision, ImportLog, NoTableError, QuestionError, Settings
from dummydesign.measurement.importing.decoding import LEFT_OUT
from dummydesign.measurement.importing.judge import Judgement, contact_of
from dummydesign.measurement.importing.press_checks import Warn, check_press, copies_among
from dummydesign.measurement.importing.sign_convention import HIGH, Span, find_presses, find_signs, joined_cycles
from dummydesign.measurement.importing.table import Columns, Ranges, columns_of, read_texts
from dummydesign.measurement.importing.times import read_between_changes
from dummydesign.measurement.importing.vocabulary import (
    BASE,
    KIND_OF_ROLE,
    ROLES,
    USUAL_UNITS,
    find_unit,
    scaled_unit,
    split_name,
)
from dummydesign.measurement.ramp_detection import SHALLOWEST_MM, Summary, summarise
from dummydesign.measurement.trace import (
    COLUMNS,
    ROLE,
    SECONDS,
    Trace,
    impossible,
    magnitude_fault,
    press_quantities,
    ranges,
    units_that_fit,
)

Warnings = list[dict[str, Any]]
SharedZero = tuple[float, str]
"""The reading at contact that other files show, and which. [mm]"""


@dataclass(frozen=True, eq=False)
class ImportedPress:
    """One press as it is written: time from 0 at its first sample, zero at contact, tared, compression positive.

    ``contact_low_mm`` and ``contact_high_mm`` are the 95 % interval of the contact by the force alone, about the zero
    that was taken; ``begins_s`` is the time of the file at its first sample. ``steady_error_N`` is how far (95 %)
    noise, ringing and a level, drift or slope of the force not seen before contact may move the steady force; None
    without a hold, or where the samples before contact show too little to exclude a large one.
    """

    number: int
    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    summary: Summary
    contact_low_mm: float
    contact_high_mm: float
    zero_mm: float
    begins_s: float
    steady_error_N: float | None
    judged: Judgement


@dataclass(frozen=True)
class Imported:
    """A file that was read: its presses, what was decided, what looks wrong, and the layout for a profile."""

    source: Path
    presses: tuple[ImportedPress, ...]
    decisions: tuple[Decision, ...]
    warnings: tuple[dict[str, Any], ...]
    columns: Columns
    sheet: str = ""
    """Title of the sheet, of a workbook whose sheets are tests of their own."""

    @property
    def name(self) -> str:
        """Name of the file, and of the sheet in it."""
        return f"{self.source.name} [{self.sheet}]" if self.sheet else self.source.name


def _tests_of(path: Path, settings: Settings | None) -> list[tuple[str, str, ImportLog]]:
    """The title, the text and the log of each test of a file: one, or one a sheet of a workbook of tests."""
    log = ImportLog(path.name, settings or Settings())
    texts = read_texts(path, log)
    if len(texts) == 1:
        return [("", next(iter(texts.values())), log)]
    tests = []
    for title, text in texts.items():
        own = ImportLog(f"{path.name} [{title}]", log.settings, list(log.decisions))
        own.decide("test", title, "one of the tests of this file: each has its own zero and presses")
        tests.append((title, text, own))
    return tests


def _import_text(path: Path, sheet: str, text: str, log: ImportLog, shared: SharedZero | None = None) -> Imported:
    """Read one test; ``shared`` is the zero of the files beside it, where its own force shows none."""
    columns = columns_of(text, log)
    tare = (
        columns.force_N[0].item() if log.settings.tare == "first" else _read_option("tare", log.settings.tare, "force")
    )
    given, by = shared or (_read_option("contact", log.settings.contact, "length"), "given by --contact")
    time = columns.time_s
    way, step_mm = read_between_changes(time, columns.displacement_mm, log)
    signs = find_signs(way, columns.force_N, tare, log)
    x = signs.displacement * way
    rest, load = signs.force * signs.rest_force_N, signs.force * (columns.force_N - signs.rest_force_N)
    spans = _find_spans(time, x, load, columns.recordings, log)
    _check_magnitudes(time, x, load, spans, columns, log)
    found = {span.start: _find_contact(time, x, load, span, rest, log) for span in spans}
    spans = joined_cycles(spans, time, x, found[spans[0].start].position_mm)
    contacts = [found[span.start] for span in spans]
    if len(spans) < len(found):
        log.decide("cycles", f"{len(found) - len(spans)} joined", "they begin pressed; the hold is that of the last")
    tares = contact_zero.find_tares(contacts, rest, signs.force, log, tare)
    depths = [float(x[s.start : s.stop].max()) - c.position_mm for s, c in zip(spans, contacts)]
    zeros = contact_zero.find_contacts(contacts, depths, float(x[spans[0].start]), signs.displacement, log, given, by)
    presses = []
    for number, (span, contact, at, level) in enumerate(zip(spans, contacts, zeros, tares), 1):
        part = slice(span.start, span.stop)
        name = log.file if len(spans) == 1 else f"{log.file} press {number}"
        t, way = time[part] - time[span.start], x[part] - at + 0.0
        force = load[part] + rest - level.at(time[part], x[part]) + 0.0
        summary = summarise(name, t, way, force)
        if fault := magnitude_fault(t, way, force, seconds="time" in log.settings.units):
            option = "--units time=.., displacement=.. or force=.. with the unit that it is in"
            raise log.question(f"press {number}: {fault.message}", option)
        warn = partial(log.warn, name=name)
        judged = check_press(t, way, force, contact, summary, warn)
        ends = contact.low_mm - at - step_mm, contact.high_mm - at + step_mm, signs.displacement * at
        error = _steady_error(summary, level, warn)
        presses.append(ImportedPress(number, t, way, force, summary, *ends, float(time[span.start]), error, judged))
    return Imported(path, tuple(presses), tuple(log.decisions), tuple(log.warnings), columns, sheet)


UNSURE, BACK = 0.05, 0.01
"""Shares of the steady force without a warning: by which drift and slope that are not seen may move it, and that is
left when the punch is back."""


def _steady_error(summary: Summary, baseline: Baseline, warn: Warn) -> float | None:
    """How far noise, ringing, unseen drift and slope may move the steady force (95 %); None where unknown. [N]"""
    steady, left_N = summary.steady_force_N, baseline.left_N
    error_N = float(np.hypot(baseline.held_error_N, summary.rings_N))
    if steady is None or baseline.samples < contact_zero.LEAST_LEAD_IN:
        return None
    if left_N > BACK * abs(steady):
        warn(
            "force_not_back",
            f"the force still reads {left_N:.2g} N when the punch is back, and falls from there: the load cell creeps "
            f"or an average is recorded. The steady force of {steady:.3g} N may be off by {error_N:.2g} N (95 %); "
            "record without averaging, or let the force come back before the next press",
        )
    elif error_N > UNSURE * abs(steady):
        rings, known = summary.rings_N > baseline.held_error_N, baseline.shown
        cause = "the punch still rings" if rings else "a drift or a slope may be left in the force"
        advice = "hold longer" if rings else "begin earlier and farther from contact, or record until the punch is back"
        size = f"by {error_N:.2g} N (95 %)" if known else "by more than 5 %, its size is not known"
        warn("steady_uncertain", f"{cause}: the steady force of {steady:.3g} N may be off {size}; {advice}")
        return error_N if known else None
    return error_N


def _read_option(option: str, word: str, kind: str) -> float | None:
    """A reading given by the user, as the file counts it, in N or mm; None for auto and none."""
    if word in ("auto", "none") or (option == "tare" and word in ("drift", "slope")):
        return None
    parts = NUMBER.match(word)
    unit = find_unit(parts[2] or BASE[kind]) if parts else None
    if parts and unit and unit.kind == kind:
        return float(parts[1]) * unit.factor
    form = f"a reading in {BASE[kind]} (or with a unit: {USUAL_UNITS[kind]})"
    form += ", or first (each file's first sample), drift or slope" if option == "tare" else ""
    raise InputError(f"--{option} {word} is not auto, none or {form}", "not_a_number", option, word)


def _find_spans(time: NDArray, x: NDArray, load: NDArray, recordings: Ranges, log: ImportLog) -> list[Span]:
    """Presses of all recordings of the file."""
    several, spans = log.settings.split == "auto", []
    for first, stop in recordings:
        part = slice(first, stop)
        shift = float(np.median(load[part][:5])) if first else 0.0
        where = f"the recording that begins at sample {first + 1}"
        if abs(shift) > HIGH * float(load.max()):
            message = f"{where} begins pressed, with {shift:.3g} N; record from before contact, or leave it out"
            raise log.fault(message, "not_enough_data", "force_N", shift)
        try:
            presses = find_presses(log.file, x[part], load[part] - shift, several, time[part])
        except InputError:
            if len(recordings) == 1:
                raise
            log.warn("nothing_pressed", f"nothing is pressed in {where}; it is left out")
            continue
        spans += [Span(span.start + first, span.stop + first, span.onset + first) for span in presses]
    if not spans:
        raise log.fault(f"nothing is pressed in any of its {len(recordings)} recordings", "nothing_found", "force_N")
    one = "force and depth do not return to zero and rise again" if several else "--split none"
    log.decide("presses", str(len(spans)), one if len(spans) == 1 else "force and depth return to zero between them")
    return spans


def _check_magnitudes(
    time: NDArray, x: NDArray, load: NDArray, spans: Sequence[Span], columns: Columns, log: ImportLog
) -> None:
    """Refuse what no such machine does: a unit is proposed only where the file read with it is plausible."""
    for span in spans:
        part = slice(span.start, span.stop)
        way, before = x[span.onset : span.stop], x[span.start : span.onset + 1]
        if way.max() - way[0] < SHALLOWEST_MM < np.ptp(before):
            late = time[span.onset] - time[span.start + int(np.argmax(before >= before.max() - SHALLOWEST_MM))]
            doubt = f"the force rises {late:.3g} s after the punch has stopped: by a filter, or another clock"
            raise log.question(doubt, "--delay S with the time by which the force is later than the displacement")
        press = time[part], x[part] - x[span.onset], load[part]
        fault = impossible(press_quantities(*press))
        if fault is None:
            continue
        (key, text), role = fault, ROLE[fault[0]]
        given, stated = log.settings.units.get(role), columns.chosen[role].unit
        unit = scaled_unit(given, KIND_OF_ROLE[role]) if given else stated
        fitting = units_that_fit(role, *press, factor=unit.factor) if unit else []
        options = " or ".join(f"--units {role}={one}" for one in fitting)
        if given and key in ("stop_mm_s2", "step_s"):
            continue  # a doubt that was settled
        if given:
            raise log.fault(
                f"with --units {role}={given} {text}; {options or 'check the unit'}", "implausible_unit", "units", given
            )
        where = f"with the {role} in {stated.text}, as the header states, " if stated else ""
        # a force or a depth beyond the range of this tool can be: only a motion that cannot be shows a wrong header
        if role == "time" and fitting:
            raise log.question(f"{where}{text}, which no machine does", f"{options} if the header is wrong")
        low, high, base = (getattr(ranges()[key], name) for name in ("low", "high", "unit"))
        doubt = f"{where}{text}; {low:g} to {high:g} {base} can be read"
        raise log.question(doubt, f"--units {role}=UNIT with the unit that it is in, if the header is wrong")


def _find_contact(
    time: NDArray, x: NDArray, load: NDArray, span: Span, rest: float, log: ImportLog
) -> contact_zero.ContactEstimate:
    """Contact of one press; where nothing was recorded before it, with the force counted from zero."""
    if float(x[span.onset : span.stop].max() - x[span.start : span.onset + 1].min()) < SHALLOWEST_MM:
        raise log.fault(
            f"the force rises to {load[span.start : span.stop].max():.3g} N while the position stands at "
            f"{x[span.onset]:.4g} mm; does the recording begin pressed, or is this another column? "
            "(--columns displacement=NAME)",
            "inconsistent",
            "displacement_mm",
            float(x[span.onset]),
        )
    # where there is a lead-in it tells the level, also beside a tare that is given
    contact = contact_of(time, x, load, span)
    if contact.baseline.samples < contact_zero.LEAST_LEAD_IN:
        contact = contact_of(time, x, load, span, -rest if log.settings.tare == "none" else 0.0)
    if contact.delay_s:
        why = "contact is found as if the force were not so late; the columns stay"
        log.decide("delay of the force", f"{1e3 * contact.delay_s:+.0f} ms", why)
    return contact


ENDINGS = (".csv", ".txt", ".dat", ".tsv", ".asc", ".tra", ".log", ".lst", ".prn", ".lvm", ".xlsx", ".xls", ".ods")
Planned = tuple[Imported, ImportedPress, str]
"""A press, the file it comes from, and the name of its trace."""


def files_of(paths: Iterable[str | Path]) -> list[tuple[Path, bool]]:
    """List the files that are meant, each with whether it is from a folder: of one, those with the usual endings."""
    files: dict[Path, tuple[Path, bool]] = {}
    for path in map(Path, paths):
        if not path.exists():
            raise InputError(f"file '{path}' does not exist", "file_not_found", "file")
        inside = [path]
        if path.is_dir():
            try:
                inside = sorted(
                    p for p in path.iterdir() if p.is_file() and p.suffix.lower() in ENDINGS and p.name[0] != "."
                )
            except OSError as problem:
                raise InputError(
                    f"folder '{path}' cannot be read: {problem.strerror or problem}", "file_unreadable", "folder"
                ) from None
            if not inside:
                message = f"folder '{path}' holds no file that may be a trace ({', '.join(ENDINGS)})"
                raise InputError(message, "nothing_found", "folder")
        for one in inside:
            files.setdefault(one.resolve(), (one, path.is_dir()))
    return list(files.values())


def import_files(paths: Sequence[str | Path], settings: Settings | None = None) -> tuple[list[Imported], Warnings]:
    """Read files and folders as test machines wrote them; warnings of all together.

    The first error or question of a file is raised, with the names of other files that have one too, and how many can
    be read without these. Nothing is left out silently.
    """
    warnings: Warnings = []
    read: dict[tuple[Path, str], Imported | InputError] = {}
    listed = files_of(paths)
    for path, in_folder in listed:
        try:
            read |= {(path, test[0]): _read_test(path, *test) for test in _tests_of(path, settings)}
        except InputError as problem:
            read[path, ""] = problem
        if in_folder and isinstance(read.get((path, "")), NoTableError):
            del read[path, ""]
            warnings.append({"code": "skipped", "message": f"{path.name} is left out: it holds no table of numbers"})
    asked = {at: one for at, one in read.items() if isinstance(one, QuestionError) and one.quantity == "contact"}
    zeros = {at: zero for at, one in asked.items() if (zero := _shared_zero(at[0], one, [*read.values()]))}
    read |= {
        (path, test[0]): _read_test(path, *test, zeros[path, test[0]])
        for path in {path for path, _ in zeros}
        for test in _tests_of(path, settings)
        if (path, test[0]) in zeros
    }
    if zeros:
        names = ", ".join(dict.fromkeys(path.name for path, _ in zeros))
        message = (
            f"{names}: too fast to show contact; the zero is that of slower presses (see the decisions). If the "
            "surface moved between them, say --contact"
        )
        warnings.append({"code": "contact_of_slower_presses", "message": message})
    imported = [one for one in read.values() if isinstance(one, Imported)]
    problems = [(one, path, sheet) for (path, sheet), one in read.items() if isinstance(one, InputError)]
    if problems:
        first = problems[0][0]
        others = _other_files(problems, imported) if len(listed) > 1 else _others(problems, imported, settings)
        raise type(first)(f"{first}{others}", first.code, first.quantity, first.value, first.allowed)
    if not imported:
        raise InputError(f"none of the {len(listed)} files holds a table of numbers", "nothing_found", "table")
    traces = [
        Trace(f"{one.name} press {press.number}", press.time_s, press.displacement_mm, press.force_N)
        for one in imported
        for press in one.presses
    ]
    return imported, [*warnings, *copies_among(traces)]


def _read_test(path: Path, sheet: str, text: str, log: ImportLog, shared: SharedZero | None = None) -> Any:
    """Read one test, or return what stands against it."""
    try:
        return _import_text(path, sheet, text, log, shared)
    except InputError as problem:
        return problem


def _shared_zero(path: Path, doubt: QuestionError, read: Iterable[object]) -> SharedZero | None:
    """The zero of slow presses, from the files named most like this one, if they agree and its force allows it."""
    imported = [one for one in read if isinstance(one, Imported)]
    alike = [len([*takewhile(lambda pair: pair[0] == pair[1], zip(str(one.source), str(path)))]) for one in imported]
    slow = [
        (one.name, press.zero_mm, wide)
        for one, same in zip(imported, alike)
        for press in one.presses
        # the force may be late by a filter that is not declared
        for late in [press.summary.velocity_mm_s * contact_zero.FILTER_DELAY_S]
        for wide in [0.5 * (press.contact_high_mm - press.contact_low_mm + late)]
        if same == max(alike) and wide <= contact_zero.SURE_MM
    ]
    if not slow:
        return None
    files, zeros, wides = (np.array(column) for column in zip(*slow))
    zero, (low, high) = float(np.average(zeros, weights=wides**-2.0)), np.array(doubt.allowed)
    agree = low <= zero <= high and np.all(abs(zeros - zero) <= wides + contact_zero.SMALL_MM)
    return (round(zero, 3), f"as seen in {', '.join(dict.fromkeys(files.tolist()))}") if agree else None


def _other_files(problems: Sequence[tuple[InputError, Path, str]], imported: Sequence[Imported]) -> str:
    """Which files are in doubt where there are several, each with its reason, and how many are not."""
    reasons: dict[str, dict[str, None]] = {}
    for problem, path, _ in problems:
        reasons.setdefault(str(problem).removeprefix(f"{path.name}: "), {})[path.name] = None
    doubtful = {path for _, path, _ in problems}
    certain, text = len({one.source for one in imported} - doubtful), ""
    if len(doubtful) > 1:
        shown = [
            ", ".join([*names][:NAMED]) + f" ({reason})" * (at > 0)
            for at, (reason, names) in enumerate(reasons.items())
        ]
        text = f"; {len(doubtful)} files are in doubt: {'; '.join(shown[:NAMED])}"
    rest = f"the other {certain} files" if certain > 1 else "the other file"
    return f"{text}; without {'them' if len(doubtful) > 1 else 'it'} {rest} can be read" if certain else text


NAMED = 12
"""Files and reasons that a message names at most."""


def _others(
    problems: Sequence[tuple[InputError, Path, str]], imported: Sequence[Imported], settings: Settings | None
) -> str:
    """How to read the sheets of a workbook that are not in doubt."""
    doubtful, certain = [sheet for *_, sheet in problems if sheet], [one.sheet for one in imported if one.sheet]
    if not doubtful or not certain:
        return ""
    text = f"{LEFT_OUT}{','.join(doubtful)}" if not settings or settings.sheets is None else ",".join(certain)
    return f'; --sheets "{text}" reads the other {f"{len(certain)} sheets" if len(certain) > 1 else "sheet"}'


def plan_traces(imported: Sequence[Imported], folder: Path | None) -> list[Planned]:
    """Choose the file name of every press."""
    sources = {one.source.resolve() for one in imported}
    taken: set[str] = set()
    planned = []
    for one in imported:
        for press in one.presses:
            name = _name(one.source, one.sheet, press.number, taken)
            if folder is not None and (folder / name).resolve() in sources:
                message = f"trace '{name}' would take the place of a file that is read; give another --out"
                raise InputError(message, "file_exists", "out", name)
            planned.append((one, press, name))
    return planned


def write_traces(planned: Sequence[Planned], folder: Path) -> None:
    """Write one canonical CSV a press into a folder."""
    for _, press, name in planned:
        columns = press.time_s, press.displacement_mm, press.force_N
        # a doubt that is left was settled by the user
        write_bytes(folder / name, trace_bytes(*columns, settled=magnitude_fault(*columns) is not None))


def describe(imported: Sequence[Imported], planned: Sequence[Planned]) -> list[dict[str, Any]]:
    """Return what became of each file: ``source``, ``traces`` (without their folder), ``decisions``, ``warnings``."""
    return [
        {
            "source": str(one.source),
            **({"sheet": one.sheet} if one.sheet else {}),
            "traces": [
                {
                    "file": name,
                    "press": press.number,
                    "samples": len(press.time_s),
                    **press.summary.to_dict(),
                    "contact_low_mm": press.contact_low_mm,
                    "contact_high_mm": press.contact_high_mm,
                    "steady_error_N": press.steady_error_N,
                    "judged": press.judged.to_dict(),
                }
                for owner, press, name in planned
                if owner is one
            ],
            "decisions": to_plain(one.decisions),
            "warnings": list(one.warnings),
        }
        for one in imported
    ]


def _name(source: Path, sheet: str, number: int, taken: set[str]) -> str:
    """A plain name: the source's, its sheet's, and the number of the press; a count behind it where two share one."""
    plain = (re.sub(r"[^\w.-]+", "_", word).strip("._") for word in (source.stem[:60] if sheet else source.stem, sheet))
    stem = "_".join(word for word in plain if word) or "trace"
    name, count = f"{stem[:100]}_{number}.csv", 1
    while name.lower() in taken:
        count += 1
        name = f"{stem[:100]}-{count}_{number}.csv"
    taken.add(name.lower())
    return name


def trace_bytes(time_s: NDArray, displacement_mm: NDArray, force_N: NDArray, settled: bool = False) -> bytes:
    """The canonical CSV, to a microsecond, a nanometre and a micronewton.

    Parameters
    ----------
    time_s, displacement_mm, force_N : ndarray, shape (n,)
        A press in the project's units. [s, mm, N]
    settled : bool
        Whether a column is added that says that time is in seconds, however slow the press.
    """
    rows = np.stack([time_s, displacement_mm, force_N, *([np.ones_like(time_s)] if settled else [])], axis=1)
    header = ",".join((*COLUMNS, SECONDS) if settled else COLUMNS)
    text = io.BytesIO()
    np.savetxt(text, np.rint(rows * 1e6) / 1e6 + 0.0, "%.6f", ",", header=header, comments="")
    return text.getvalue()


PROFILES = "profiles"
"""Folder of the profiles in the user's own one."""


def list_profiles() -> list[Entry]:
    """The profiles that are known, by name."""
    return [entry for _, entry in sorted(entries(PROFILES).items())]


def load_profile(name: str) -> Settings:
    """Read a profile by name, or from a file that ends in ``.toml``."""
    return _read_profile(find(PROFILES, "profile", name).path)


_TEXTS = ("separator", "decimal", "encoding", "tare", "contact", "split", "sheets")


def _read_profile(path: Path) -> Settings:
    top = read_table(path, ("schema", *vars(Settings())), None)
    if top.data.get("schema", 1) != 1:
        raise InputError(f"{path.name}: schema is not 1, the one that this version reads", "unsupported", "schema")
    values = {
        **{key: top.get(key, str, "a text", None) for key in _TEXTS},
        "rate": top.number("rate", None, above=0.0),
        "delay": top.number("delay", None),
        "skip": top.get("skip", int, "a whole number from 0", None),
    }
    top.number("skip", None, low=0.0)
    for key in ("columns", "units"):
        values[key] = {role: str(word) for role, word in top.table(key, required=False).only(ROLES).data.items()}
    values["flip"] = frozenset(top.strings("flip")) if "flip" in top else None
    return Settings(**{key: value for key, value in values.items() if value is not None})


def learned(given: Settings, imported: Iterable[Imported]) -> Settings:
    """What to keep for the next time: what the user gave, and the columns and signs of text that all files share."""
    layouts = [one.columns for one in imported]

    def common(values: list[str]) -> str | None:
        return values[0] if values and len(set(values)) == 1 and values[0] else None

    columns = dict(given.columns)
    for role in ROLES:
        # Units are not kept: a file states its own, and one that does not was read with those that were given.
        name = common([one.chosen[role].name for one in layouts])
        names = [[split_name(name)[0] for name in one.layout.names] for one in layouts]
        if role not in columns and name and all(one.count(name) == 1 for one in names):
            columns[role] = name
    separator, decimal = (common([getattr(one.layout, name) for one in layouts]) for name in ("separator", "decimal"))
    return replace(
        given, sheets=None, columns=columns, separator=given.separator or separator, decimal=given.decimal or decimal
    )


def save_profile(name: str, settings: Settings, overwrite: bool = False) -> Path:
    """Keep a profile in the user's folder.

    Parameters
    ----------
    name : str
        Name of the profile: letters, digits, '-', '_' and '.'.
    settings : Settings
        What was settled for the machine.
    overwrite : bool
        Replace a profile of this name that has other settings.
    """
    if not re.fullmatch(r"[\w][\w .-]{0,60}", name) or name.lower().endswith(".toml") or DEVICE.fullmatch(name):
        message = f"--save-profile '{name}': a profile's name is made of letters, digits, '-', '_' and '.'"
        raise InputError(message, "bad_name", "save_profile", name)
    path = user_folder() / PROFILES / f"{name}.toml"
    if path.exists() and not overwrite and _read_profile(path) != settings:
        message = f"--save-profile '{name}': exists already with other settings; add --replace to replace it"
        raise InputError(message, "file_exists", "save_profile", name)
    with writing("folder", path.parent, "folder"):
        path.parent.mkdir(parents=True, exist_ok=True)
    return write_text(path, _profile_text(settings))


def _profile_text(settings: Settings) -> str:
    usual = Settings().to_dict()
    return toml_table({"schema": 1, **{key: value for key, value in settings.to_dict().items() if value != usual[key]}})
