"""A press written in a drawn layout, as test machines, loggers and robots of many countries write it.

:func:`write_file` is independent of the importer: names and forms here are what programs write, not what it knows.
"""

from __future__ import annotations

import datetime
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.import_words import (
    CODE_PAGES,
    COMMA,
    FORCES,
    LENGTHS,
    NAMES,
    PREAMBLES,
    RATES,
    STRESS,
    TIME_FORMS,
    TIMES,
)

FAULTS = ("none", "none", "none", "none", "dropped", "twice", "swapped", "padded", "slip_time", "slip_force")
SPECIAL = ("lvm", "arrow", "cells", "side_by_side")
"""Whole formats, drawn in a quarter of the files."""

Cells = list[str]


@dataclass
class _Column:
    """A column: its title, its unit (empty for none), and its cells."""

    title: str
    unit: str
    cells: Cells
    role: str = ""


@dataclass(frozen=True)
class _Style:
    """How a program writes."""

    language: str
    separator: str
    decimal: str
    units: str
    quoted: bool = False
    preamble: tuple[str, ...] = ()


def write_file(
    path: Path, rng: np.random.Generator, time_s: NDArray, displacement_mm: NDArray, force_N: NDArray
) -> dict[str, Any]:
    """Write a press in a drawn layout and return its truth.

    Parameters
    ----------
    path : Path
        File to write.
    rng : Generator
    time_s, displacement_mm, force_N : ndarray, shape (n,)
        The press, evenly sampled, time from 0. [s, mm, N]

    Returns
    -------
    dict
        ``layout`` (what was drawn, by name), ``presses`` (list of time_s, displacement_mm, force_N as the file means
        them, time from 0 at the first row), ``time_error_s`` (what the form of the time leaves open), ``slip`` (role
        whose unit in the header is wrong; a question or a warning is right), ``needs`` (options without which the file
        cannot be read, with the value that answers).
    """
    form = str(rng.choice(SPECIAL)) if rng.random() < 0.25 else "columns"
    press = [np.asarray(one, float) for one in (time_s - time_s[0], displacement_mm, force_N)]
    if form == "lvm":
        return _lvm(path, rng, press)
    language = str(rng.choice(list(NAMES)))
    comma = language in COMMA and rng.random() < 0.8
    separator = str(rng.choice([";", "\t"] if comma else [",", ";", "\t", "|"]))
    quoted = bool(rng.random() < 0.2)
    if comma and quoted and rng.random() < 0.5:
        separator = ","
    units = str(
        rng.choice(
            ["[]", "()", "in", "/", "_", "row", "row", "row()", "none"],
            p=[0.18, 0.15, 0.06, 0.08, 0.1, 0.15, 0.1, 0.13, 0.05],
        )
    )
    preamble = tuple(PREAMBLES.get(language, PREAMBLES["english"])) if rng.random() < 0.5 else ()
    style = _Style(language, separator, "," if comma else ".", units, quoted, preamble)
    if form == "arrow":
        return _arrow(path, rng, style, press)
    if form == "cells":
        return _cells(path, rng, style, press)
    if form == "side_by_side":
        return _side_by_side(path, rng, style, press)
    return _columns(path, rng, style, press)


def _columns(path: Path, rng: np.random.Generator, style: _Style, press: list[NDArray]) -> dict[str, Any]:
    """One test, one row a sample."""
    fault = str(rng.choice(FAULTS))
    form = "plain" if fault.startswith("slip") else str(rng.choice(TIME_FORMS))
    if form in ("coarse", "packets", "rate", "two_bases") and fault in ("dropped", "twice", "swapped"):
        fault = "none"  # without times of their own, rows that are lost cannot be seen
    if form in ("counter",) and fault == "swapped":
        fault = "none"
    units = {"time": _draw(rng, TIMES, 0.6), "length": _draw(rng, LENGTHS, 0.6), "force": _draw(rng, FORCES, 0.6)}
    slip = {"slip_time": "time", "slip_force": "force"}.get(fault, "")
    if slip:
        style = replace(style, units="()" if style.units == "none" else style.units)
        units["time"] = "s"
    time, x, force = press
    names = [str(rng.choice(options)) for options in NAMES[style.language]]
    rate = (len(time) - 1) / time[-1]
    truth: dict[str, Any] = {
        "layout": {
            "form": form,
            "fault": fault,
            "language": style.language,
            "units": style.units,
            "separator": style.separator,
            "decimal": style.decimal,
        },
        "time_error_s": 0.0,
        "slip": slip,
        "needs": {},
    }
    columns, error_s, lines = _time_columns(rng, form, style, names[0], units["time"], time)
    truth["time_error_s"] = error_s
    length = _Column(names[1], units["length"], _numbers(style, x, *LENGTHS[units["length"]]), "displacement")
    shown = "N" if slip == "force" else units["force"]
    written = "mN" if slip == "force" else units["force"]
    load = _Column(names[2], shown, _numbers(style, force, *FORCES[written]), "force")
    if slip == "time":
        columns[0].unit = "ms"
    if form == "two_bases":
        columns, pressed = _two_bases(rng, style, names, units, press)
        truth["presses"], truth["time_error_s"] = [pressed], 0.0
    else:
        truth["presses"] = [tuple(press)]
        columns += [length, load] if rng.random() < 0.6 else [load, length]
        if rng.random() < 0.2 and form == "plain":
            columns = columns[1:] + columns[:1]
    columns += _extras(rng, style, x, force, len(columns[0].cells))
    if style.units == "none":
        numeric = {one.role: one.unit for one in columns if one.role and one.unit}
        asked = {role: unit for role, unit in numeric.items() if not (role == "time" and form == "epoch")}
        truth["needs"] = {"units": asked} if asked else {}
    rows = [list(row) for row in zip(*(one.cells for one in columns))]
    if form in ("rate", "counter"):
        rate_line = str(rng.choice(RATES)).format(rate=round(rate, 6), step=round(1 / rate, 9))
        lines = [rate_line.replace(".", style.decimal) if style.decimal == "," else rate_line]
    rows, kept = _faulty_rows(rng, fault, rows)
    if fault == "dropped":
        truth["presses"] = [tuple(part[kept] for part in press)]
    _write(path, rng, style, columns, rows, lines, padded=fault == "padded")
    return truth


def _draw(rng: np.random.Generator, table: dict[str, Any], usual: float) -> str:
    """The first of a table with this probability, else any of them."""
    return next(iter(table)) if rng.random() < usual else str(rng.choice(list(table)))


def _time_columns(
    rng: np.random.Generator, form: str, style: _Style, name: str, unit: str, time: NDArray
) -> tuple[list[_Column], float, list[str]]:
    """Columns of the time, what their form leaves open, and lines of a preamble. [s]"""
    step = time[-1] / (len(time) - 1)
    begin = datetime.datetime(2025, 11, 19, 14, 3, 20) + datetime.timedelta(seconds=float(rng.integers(0, 35)) + 0.25)
    stamps = [begin + datetime.timedelta(seconds=round(float(one), 6)) for one in time]
    micro = [f"{one.microsecond:06d}" for one in stamps]
    if form == "plain":
        factor, digits = TIMES[unit]
        offset = float(rng.choice([0.0, 0.0, rng.uniform(0.0, 300.0)]))
        return [_Column(name, unit, _numbers(style, time + offset, factor, digits), "time")], 0.0, []
    if form == "iso":
        return [_Column(name, "", [one.isoformat(timespec="microseconds") for one in stamps])], 0.0, []
    if form == "compact":
        zone = str(rng.choice(["Z", ""]))
        cells = [one.strftime("%Y%m%dT%H%M%S.%f") + zone for one in stamps]
        return [_Column("time_utc" if style.language == "english" else name, "", cells)], 0.0, []
    if form == "clock":
        return (
            [_Column(name, "", [f"{one:%H:%M:%S}{style.decimal}{part}" for one, part in zip(stamps, micro)])],
            0.0,
            [],
        )
    if form == "date_clock":
        dates = [f"{one:%d.%m.%Y}" for one in stamps]
        clock = [f"{one:%H:%M:%S}{style.decimal}{part}" for one, part in zip(stamps, micro)]
        return [_Column("Date", "", dates), _Column(name, "", clock)], 0.0, []
    if form == "clock_ms":
        # whole milliseconds: what is finer is cut off
        fine = "Milliseconds" if style.language == "english" else "ms"
        cells = [str(one.microsecond // 1000) for one in stamps]
        return [_Column(name, "", [f"{one:%H:%M:%S}" for one in stamps]), _Column(fine, "", cells)], 1e-3, []
    if form == "secs_nsecs":
        origin = 1_700_000_000 + int(rng.integers(0, 10**7))
        nano = np.rint(time * 1e9).astype(np.int64) + int(rng.integers(0, 10**9))
        names = [("secs", "nsecs"), ("header.stamp.secs", "header.stamp.nsecs"), ("sec", "nanosec")][rng.integers(3)]
        whole, part = np.divmod(nano, 10**9)
        return (
            [
                _Column(names[0], "", [str(origin + int(one)) for one in whole]),
                _Column(names[1], "", [str(int(one)) for one in part]),
            ],
            1e-6,
            [],
        )
    if form == "epoch":
        return [_Column("timestamp", "", _numbers(style, time + 1763561000.0, 1.0, 5), "time")], 1e-5, []
    if form == "counter":
        return [_Column("Sample", "", [str(at) for at in range(len(time))])], 1e-6, []
    if form in ("rate", "two_bases"):
        return [], 1e-6, []
    if form == "coarse":
        digit = float(rng.choice([0.01, 0.1, 1.0] if step < 0.005 else [0.1, 1.0]))
        shift = 1e-9 + 0.5 * digit * float(rng.integers(2))
        cells = _numbers(style, np.floor((time + shift) / digit) * digit, 1.0, 2)
        return [_Column(name, "s", cells, "time")], 1.5 * step, []
    # packets: several samples arrive together, with the time of their arrival
    sizes = rng.integers(2, 8, len(time))
    ends = np.minimum(np.cumsum(sizes), len(time)) - 1
    arrival = time[ends[np.searchsorted(ends, np.arange(len(time)))]]
    return [_Column(name, "s", _numbers(style, arrival, 1.0, 4), "time")], 8.0 * step, []


def _two_bases(
    rng: np.random.Generator, style: _Style, names: list[str], units: dict[str, str], press: list[NDArray]
) -> tuple[list[_Column], tuple[NDArray, ...]]:
    """Force and position, each with its own time: the position begins later and is sampled at another instant."""
    time, x, force = press
    lag = float(rng.uniform(-0.2, 0.2))
    begin = max(0.0, lag)
    moved = np.interp(time + lag, time, x)
    factor, digits = TIMES[units["time"]]
    forms = [("{0} {1}", "{0} {1}"), ("{0}", "{0}"), ("{0} 1", "{0} 2")][rng.integers(3)]
    columns = [
        _Column(forms[0].format(names[0], names[2]), units["time"], _numbers(style, time, factor, digits), "time"),
        _Column(names[2], units["force"], _numbers(style, force, *FORCES[units["force"]]), "force"),
        _Column(
            forms[1].format(names[0], names[1]), units["time"], _numbers(style, time + lag, factor, digits), "time"
        ),
        _Column(names[1], units["length"], _numbers(style, moved, *LENGTHS[units["length"]]), "displacement"),
    ]
    inside = (time >= begin - 1e-9) & (time <= time[-1] + min(0.0, lag) + 1e-9)
    return columns, (time[inside] - time[inside][0], x[inside], force[inside])


def _extras(rng: np.random.Generator, style: _Style, x: NDArray, force: NDArray, count: int) -> list[_Column]:
    """Stress and strain, a temperature, a channel that is commanded."""
    stress, strain = STRESS[style.language]
    possible = [
        _Column(stress, "MPa", _numbers(style, force / 196.0, 1.0, 6)),
        _Column(strain, str(rng.choice(["mm/mm", "%"])), _numbers(style, x / 30.0, 1.0, 5)),
        _Column(
            "Temperature",
            "°C" if style.language in ("german", "french", "english") else "C",
            _numbers(style, rng.normal(21.0, 0.02, count), 1.0, 2),
        ),
    ]
    return [one for one in possible if rng.random() < 0.25]


def _numbers(style: _Style, values: NDArray, factor: float, digits: int) -> Cells:
    text = [f"{value:.{digits}f}" for value in (np.asarray(values) * factor).tolist()]
    return [cell.replace(".", ",") for cell in text] if style.decimal == "," else text


def _faulty_rows(rng: np.random.Generator, fault: str, rows: list[Cells]) -> tuple[list[Cells], NDArray]:
    """Rows after what happened to them, and which samples are left."""
    kept = np.arange(len(rows))
    if fault == "dropped":
        lost = rng.random(len(rows)) < 0.02
        lost[[0, -1]] = False
        kept = np.flatnonzero(~lost)
        return [rows[at] for at in kept], kept
    if fault == "twice":
        twice = np.sort(np.r_[kept, rng.choice(kept, max(1, int(rng.uniform(0.01, 0.06) * len(rows))), replace=False)])
        return [rows[at] for at in twice], kept
    if fault == "swapped":
        at = int(rng.integers(2, len(rows) - 3))
        rows = list(rows)
        rows[at], rows[at + 1] = rows[at + 1], rows[at]
    return rows, kept


def _header(style: _Style, columns: list[_Column]) -> list[Cells]:
    """Rows of names and units."""
    if style.units.startswith("row"):
        a, b = ("(", ")") if style.units == "row()" else ("", "")
        return [[one.title for one in columns], [f"{a}{one.unit}{b}" if one.unit else "" for one in columns]]
    forms = {"[]": "{0} [{1}]", "()": "{0} ({1})", "in": "{0} in {1}", "/": "{0}/{1}", "_": "{0}_{1}", "none": "{0}"}
    return [[forms[style.units].format(one.title, one.unit) if one.unit else one.title for one in columns]]


def _write(
    path: Path,
    rng: np.random.Generator,
    style: _Style,
    columns: list[_Column],
    rows: list[Cells],
    lines: list[str],
    above: Cells | None = None,
    padded: bool = False,
) -> None:
    """Write header and rows in the code page of the language."""

    def line(cells: Cells) -> str:
        quote = style.quoted or style.separator == style.decimal
        return style.separator.join(f'"{cell}"' for cell in cells) if quote else style.separator.join(cells)

    text = [one.replace(";", style.separator) for one in (*style.preamble, *lines)]
    text += [""] if text and rng.random() < 0.7 else []
    text += [line(cells) for cells in ([above] if above else [])] + [line(cells) for cells in _header(style, columns)]
    text += [line(cells) for cells in rows]
    newline = str(rng.choice(["\n", "\r\n"]))
    whole, pages = newline.join([*text, ""]), list(CODE_PAGES[style.language])
    while True:
        page = pages.pop(int(rng.integers(len(pages)))) if pages else "utf-8"
        try:
            data = whole.encode(page)
            break
        except UnicodeEncodeError:
            continue
    if padded and page not in ("utf-16",):
        data += b"\x00" * int(rng.integers(500, 40000))
    path.write_bytes(data)


def _simple_truth(style: _Style, form: str, presses: list[tuple[NDArray, ...]], error_s: float = 0.0) -> dict[str, Any]:
    layout = {
        "form": form,
        "fault": "none",
        "language": style.language,
        "units": style.units,
        "separator": style.separator,
        "decimal": style.decimal,
    }
    return {"layout": layout, "presses": presses, "time_error_s": error_s, "slip": "", "needs": {}}


def _arrow(path: Path, rng: np.random.Generator, style: _Style, press: list[NDArray]) -> dict[str, Any]:
    """A serial monitor: the clock of arrival and an arrow before what the board prints."""
    time, x, force = press
    style = _Style("english", str(rng.choice([",", "\t", " "])), ".", "_")
    stamps = [datetime.datetime(2025, 11, 19, 14, 3, 20) + datetime.timedelta(seconds=float(one)) for one in time]
    head = style.separator.join(["Position_mm", "Force_N"])
    lines = [f"14:03:19.990 -> {head}"]
    lines += [
        f"{one:%H:%M:%S}.{one.microsecond // 1000:03d} -> {a:.4f}{style.separator}{b:.4f}"
        for one, a, b in zip(stamps, x, force)
    ]
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return _simple_truth(style, "arrow", [tuple(press)], 1e-3)


def _cells(path: Path, rng: np.random.Generator, style: _Style, press: list[NDArray]) -> dict[str, Any]:
    """A hand gauge: every cell with its unit."""
    time, x, force = press
    names = [str(rng.choice(options)) for options in NAMES[style.language]]
    style = replace(style, units="none", quoted=style.quoted or style.separator == style.decimal)
    length, load = _draw(rng, LENGTHS, 0.6), _draw(rng, FORCES, 0.6)
    gap = str(rng.choice([" ", ""]))
    written = ("s", time, (1.0, 4)), (length, x, LENGTHS[length]), (load, force, FORCES[load])
    columns = [
        _Column(name, "", [f"{cell}{gap}{unit}" for cell in _numbers(style, values, *form)])
        for name, (unit, values, form) in zip(names, written)
    ]
    _write(path, rng, style, columns, [list(row) for row in zip(*(one.cells for one in columns))], [])
    return _simple_truth(style, "cells", [tuple(press)])


def _side_by_side(path: Path, rng: np.random.Generator, style: _Style, press: list[NDArray]) -> dict[str, Any]:
    """Two or three specimens beside each other, the later ones shorter."""
    style = replace(style, units=style.units if style.units.startswith("row") else "row")
    names = [str(rng.choice(options)) for options in NAMES[style.language]]
    count, presses, columns, above = int(rng.integers(2, 4)), [], [], []
    for number in range(count):
        end = len(press[0]) - int(rng.choice([0, len(press[0]) // 12])) * number
        own = tuple(part[:end] for part in (press[0], press[1], press[2] * (1.0 - 0.2 * number)))
        presses.append(own)
        blank = [""] * (len(press[0]) - end)
        columns += [
            _Column(names[0], "s", _numbers(style, own[0], 1.0, 4) + blank, "time"),
            _Column(names[2], "N", _numbers(style, own[2], 1.0, 4) + blank, "force"),
            _Column(names[1], "mm", _numbers(style, own[1], 1.0, 4) + blank, "displacement"),
        ]
        above += [f"1 _ {number + 1}", "", ""]
    rows = [list(row) for row in zip(*(one.cells for one in columns))]
    _write(path, rng, style, columns, rows, [], above if rng.random() < 0.7 else None)
    return _simple_truth(style, "side_by_side", presses)


def _lvm(path: Path, rng: np.random.Generator, press: list[NDArray]) -> dict[str, Any]:
    """A LabVIEW measurement file with no, one or several columns of time."""
    time, x, force = press
    form = str(rng.choice(["No", "One", "Multi"]))
    comma = bool(rng.random() < 0.3)
    style, step = _Style("english", "\t", "," if comma else ".", "row"), float(time[1] - time[0])
    several, t = form == "Multi", "\t" if form == "Multi" else ""
    cells = [_numbers(style, one, 1.0, 6) for one in (time, force, x)]
    body = {
        "No": [f"\t{b}\t{c}" for b, c in zip(*cells[1:])],
        "One": ["\t".join(row) for row in zip(*cells)],
        "Multi": [f"{a}\t{b}\t{a}\t{c}" for a, b, c in zip(*cells)],
    }[form]
    delta, zero = (one.replace(".", style.decimal) for one in (f"{step:.9f}", "0.0"))
    head = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        f"Decimal_Separator\t{style.decimal}",
        f"Multi_Headings\t{'Yes' if several else 'No'}",
        f"X_Columns\t{form}",
        f"Time_Pref\t{rng.choice(['Absolute', 'Relative'])}",
        "Operator\tlab",
        "Date\t2025/11/19",
        "Time\t14:03:20.25",
        "***End_of_Header***\t",
        "\t",
        f"Channels\t2{t}\t\t{t}",
        f"Samples\t{len(time)}{t}\t{len(time)}\t",
        f"Date\t2025/11/19{t}\t2025/11/19\t",
        f"Time\t14:03:20.25{t}\t14:03:20.25\t",
        f"Y_Unit_Label\tNewton{t}\tMillimeter\t",
        f"X_Dimension\tTime{t}\tTime\t",
        f"X0\t{zero}{t}\t{zero}\t",
        f"Delta_X\t{delta}{t}\t{delta}\t",
        f"***End_of_Header***\t\t{t}\t",
        f"X_Value\tForce\t{'X_Value' + t if t else ''}Position\tComment",
    ]
    path.write_bytes("\r\n".join([*head, *body, ""]).encode())
    return _simple_truth(style, f"lvm {form}", [tuple(press)], 1e-5)


def plain_press(rng: np.random.Generator) -> tuple[NDArray, NDArray, NDArray]:
    """A press without overshoot of a soft hand or a stiff finger, as the machine would record it. [s, mm, N]"""
    rate, speed = float(rng.choice([100.0, 200.0, 500.0, 1000.0])), float(rng.choice([2.0, 5.0, 10.0]))
    stiff = float(np.exp(rng.uniform(np.log(0.05), np.log(2.0))))
    depth, hold = float(np.cbrt(rng.uniform(6.0, 30.0) / stiff)), float(rng.uniform(3.0, 9.0))
    lead = float(rng.uniform(0.3, 1.0))
    end = 2.0 * lead + 2.0 * (depth + 1.0) / speed + hold
    time = np.arange(int(end * rate)) / rate
    way = depth + 1.0
    x = np.interp(time, [lead, lead + way / speed, lead + way / speed + hold, end - lead], [-1.0, depth, depth, -1.0])
    since = np.maximum(time - lead - way / speed, 0.0)
    pressed = np.maximum(x, 0.0)
    force = stiff * pressed**3 * (1.0 + 0.35 * np.exp(-since / 1.5))
    return time, x, force + rng.normal(0.0, 2e-4 * force.max(), len(time))


@dataclass(frozen=True)
class Verdict:
    """How a file was read.

    ``kind``: right; answered (a needed option was asked for, and with it the file is right); slip caught (the wrong
    unit of a header was refused, asked for or warned of); unneeded (a question or refusal of a file that says all);
    wrong warned; wrong quiet.
    """

    kind: str
    text: str


def judge(path: Path, truth: dict[str, Any]) -> Verdict:
    """Import a drawn file and compare what comes out with its truth."""
    from dummydesign.core.errors import InputError
    from dummydesign.measurement.importing.decisions import Settings
    from dummydesign.measurement.importing.read import import_files

    try:
        read = import_files([path])[0]
    except InputError as refusal:
        if truth["slip"]:
            return Verdict("slip caught", str(refusal))
        if not truth["needs"]:
            return Verdict("unneeded", str(refusal))
        try:
            read = import_files([path], Settings(**truth["needs"]))[0]
        except InputError as second:
            return Verdict("unneeded", f"answered, then: {second}")
        fault = _fault(read, truth)
        return Verdict("wrong quiet" if fault else "answered", fault)
    codes = {warning["code"] for one in read for warning in one.warnings}
    fault = _fault(read, truth)
    if truth["slip"]:
        return Verdict(
            "slip caught" if codes - {"hold_too_short"} else "wrong quiet", f"unit of {truth['slip']}: {codes}"
        )
    if truth["needs"]:
        return Verdict("wrong quiet", "a unit that the file does not state was taken without a question")
    return Verdict(("wrong warned" if codes else "wrong quiet") if fault else "right", f"{fault} {sorted(codes)}")


def _fault(read: list[Any], truth: dict[str, Any]) -> str:
    """What differs from the truth, of time, displacement and force; contact and tare are not judged here."""
    if len(read) != len(truth["presses"]):
        return f"{len(read)} tests instead of {len(truth['presses'])}"
    for one, (time, x, force) in zip(read, truth["presses"]):
        if len(one.presses) != 1:
            return f"{len(one.presses)} presses instead of 1"
        press = one.presses[0]
        length = float(time[-1] - time[0])
        if abs(float(press.time_s[-1]) - length) > 2.0 * truth["time_error_s"] + 2e-3 * length:
            return f"{press.time_s[-1]:.5g} s instead of {length:.5g} s"
        speed = float(np.max(np.abs(np.diff(x) / np.diff(time))))
        steep = float(np.max(np.abs(np.diff(force))))
        for name, own, true, least in (
            ("displacement", press.displacement_mm, x, 0.01 + 2.0 * speed * (truth["time_error_s"] + 1e-3)),
            ("force", press.force_N, force, 0.02 * float(force.max()) + 3.0 * steep),
        ):
            apart = own - np.interp(press.time_s, time - time[0], true)
            off = float(np.max(np.abs(apart - np.median(apart))))
            late = 0.0 if name == "displacement" else 2.0 * truth["time_error_s"] * speed * float(force.max()) / 2.0
            if off > least + late:
                return f"{name} is off by {off:.3g} (up to {least + late:.3g} is right)"
    return ""


def main() -> None:
    """Print the rates over drawn files: ``python -m benchmarks.accuracy.import_layouts FIRST COUNT``."""
    import sys
    import tempfile
    from collections import Counter

    first, count = (int(word) for word in sys.argv[1:3])
    kinds: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(first, first + count):
            rng = np.random.default_rng(seed)
            path = Path(folder) / f"press_{seed}.csv"
            truth = write_file(path, rng, *plain_press(rng))
            verdict = judge(path, truth)
            kinds[verdict.kind] += 1
            if verdict.kind not in ("right", "answered", "slip caught"):
                print(seed, verdict.kind, truth["layout"], verdict.text[:300])
    print(count, "files:", dict(kinds))


if __name__ == "__main__":
    main()
