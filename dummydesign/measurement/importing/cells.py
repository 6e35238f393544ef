"""Split lines into cells; numbers and clock times as they are written."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.vocabulary import Unit, find_unit

SEPARATORS = {"\t": "tab", ";": "semicolon", "|": "bar", ",": "comma", " ": "spaces"}
COMMENTS = ("#", "%", "//")
QUOTED_HEAD = 60
"""Lines at the start in which a quoted cell may go over several lines."""


def split(line: str, separator: str) -> list[str]:
    """Split a line into stripped cells; quotes keep a separator inside a cell."""
    if separator == " ":
        return line.replace('"', " ").split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
        except (csv.Error, StopIteration):
            return [cell.strip().strip('"') for cell in line.split(separator)]
    return [cell.strip() for cell in line.split(separator)]


def without_empty_end(cells: list[str], width: int = 0) -> list[str]:
    """Cells without the empty ones at their end, as many as a table is wide at least."""
    while len(cells) > width and not cells[-1]:
        cells = cells[:-1]
    return cells


def is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(COMMENTS)


def whole_cells(lines: list[str]) -> list[str]:
    """Join the lines of a header whose quoted cells hold line ends; blank lines keep the numbering."""
    head, joined, at = min(len(lines), QUOTED_HEAD), list(lines), 0
    while at < head:
        end = at
        while _open(lines[at : end + 1]) and end < min(at + 8, head - 1):
            end += 1
        if end > at and not _open(lines[at : end + 1]):
            joined[at : end + 1] = [" ".join(line.strip() for line in lines[at : end + 1]), *[""] * (end - at)]
        at = end + 1
    return joined


def _open(lines: Sequence[str]) -> bool:
    """Whether a quote is left open at the end of some lines."""
    return sum(line.count('"') for line in lines) % 2 == 1


_MINUS = str.maketrans("−–－", "---")
_GROUPS = {".": ",'’ \u00a0\u202f", ",": ".'’ \u00a0\u202f"}
_NO_GROUPS = str.maketrans("", "", "'’ \u00a0\u202f")
_FORM = r"[+-]?(?=[.,]?\d)(?:[1-9]\d{0,2}(?:([%s])\d{3})(?:\1\d{3})*|\d+)?(?:%s\d*)?(?:[eE][+-]?\d+)?"
_NUMBER = {sign: re.compile(_FORM % (groups, re.escape(sign)), re.ASCII) for sign, groups in _GROUPS.items()}
_PLAIN = {".": re.compile(r"-?\d+(?:\.\d+)?", re.ASCII), ",": re.compile(r"-?\d+(?:,\d+)?", re.ASCII)}
"""Numbers of the usual form, which most are; the patterns above also take groups, exponents and other signs."""
_ABSENT = {"", "nan", "#nv", "#n/a", "n/a", "na", "null", "none", "---", "--", "-"}
_NOT_FINITE = {"inf", "-inf", "+inf", "overflow"}
_MONTH = r"\d{1,2}[-/. ]+[A-Za-z]{3}[a-z]*[-/., ]+\d{4}"
_DAY = rf"\d{{4}}[-/.]\d{{1,2}}[-/.]\d{{1,2}}|\d{{1,2}}[-/.]\d{{1,2}}[-/.]\d{{2,4}}|{_MONTH}"
_STAMP = re.compile(
    rf"(?:({_DAY})[T ]+)?"
    r"(\d{1,2}):(\d{2}):(\d{2})(?:[.,:](\d+))?(?: ?([AaPp])\.?[Mm]\.?)?(?:Z| ?[+-]\d{2}:?\d{2})?",
    re.ASCII,
)
_COMPACT = re.compile(r"(\d{4})(\d{2})(\d{2})T(\d{2})(\d{2})(\d{2})(?=\D|$)(.*)", re.ASCII)
_DURATIONS = (
    r"(?:(?P<day>[+-]?\d+) days?,? )?(?P<sign>[+-])?(?P<hour>\d+):(?P<minute>\d{2}):(?P<second>\d{2}(?:[.,]\d+)?)",
    r"(?P<sign>[+-])?P(?=.*\d)(?:(?P<day>\d+)D)?"
    r"(?:T(?:(?P<hour>\d+)H)?(?:(?P<minute>\d+)M)?(?:(?P<second>\d+(?:[.,]\d+)?)S)?)?",
)
"""Forms of a duration: ``0 days 00:00:01.25``, ``-1 days +23:59:59.5``, ``-00:00:00.5``; ISO 8601's ``PT1.25S``."""
_MINUTES = r"(?P<minute>\d{1,3}):(?P<second>\d{2}[.,]\d+)"
_MEASURE = re.compile(r"(.*\d[.,]?)\s*(\D+)", re.ASCII)


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with either decimal sign."""
    return any(parse(cell, sign) is not None for sign in (".", ","))


def parse(cell: str, decimal: str) -> float | None:
    """Read a number with this decimal sign, thousands signs taken out; None where it is none."""
    if _PLAIN[decimal].fullmatch(cell):
        return float(cell.replace(",", "."))
    text = cell.translate(_MINUS)
    if not _NUMBER[decimal].fullmatch(text):
        return None
    for sign in _GROUPS[decimal]:
        text = text.replace(sign, "")
    return float(text.replace(",", "."))


def measure(cell: str) -> tuple[str, Unit] | None:
    """Part a number from the unit behind it, ``12.3 N``; None where a cell is no such thing."""
    parts = None if not cell or cell[-1].isdigit() else _MEASURE.fullmatch(cell)
    unit = find_unit(parts[2].strip()) if parts else None
    return (parts[1], unit) if parts and unit and is_number(parts[1]) else None


def is_measure(cell: str) -> bool:
    """Whether a cell is a number with its unit."""
    return measure(cell) is not None


def is_missing(cell: str) -> bool:
    """Whether a cell stands for a number that is not there, or not used."""
    return is_absent(cell) or cell.lower() in _NOT_FINITE or is_excluded(cell)


def is_absent(cell: str) -> bool:
    """Whether a cell says that nothing was read; a number out of range was read."""
    return cell.lower() in _ABSENT


def is_excluded(cell: str) -> bool:
    """Whether a star behind a number says that the value is not to be used, as GraphPad writes it."""
    return cell.endswith("*") and is_number(cell[:-1])


def has_thousands(cell: str, decimal: str) -> bool:
    """Whether a number is written with thousands signs."""
    return any(sign in cell for sign in _GROUPS[decimal])


def decimal_evidence(cells: Iterable[str]) -> dict[str, int]:
    """Count numbers that can only be read with a dot, or only with a comma, as decimal sign; and the undecided."""
    count = Counter(map(_decimal_sign, cells))
    return {sign: count[sign] for sign in (".", ",", "either")}


def _decimal_sign(cell: str) -> str:
    """The only decimal sign that a number can have, or ``either``; empty where it has none.

    A single sign followed by exactly three digits, as in 1,795, may be either; 0,795 and 17,95 are decimals, and
    with two kinds of sign the last one is the decimal sign.
    """
    mantissa = re.split("[eE]", cell.translate(_MINUS).lstrip("+-"))[0].translate(_NO_GROUPS)
    dots, commas = mantissa.count("."), mantissa.count(",")
    if not dots and not commas:
        return ""
    if dots and commas:
        return "." if mantissa.rindex(".") > mantissa.rindex(",") else ","
    sign, other = (".", ",") if dots else (",", ".")
    if dots + commas > 1:
        return other
    before, after = mantissa.split(sign)
    grouped = len(after) == 3 and 1 <= len(before) <= 3 and not before.startswith("0")
    exponent = len(mantissa) < len(cell.lstrip("+-−"))
    return "either" if grouped and not exponent else sign


def is_stamp(cell: str) -> bool:
    """Whether a cell is a time of day, with or without a date, minutes and seconds, or a duration."""
    return seconds_of_stamp(cell) is not None


def _duration(cell: str) -> float | None:
    """Seconds of a duration, or of minutes and seconds; None of a time of day, which has a date or no sign."""
    forms = _DURATIONS if cell[:1] in ("+", "-", "P") or " day" in cell else (_MINUTES,)
    found = next((found for form in forms if (found := re.fullmatch(form, cell, re.ASCII))), None)
    if found is None:
        return None
    parts = {name: part for name, part in found.groupdict().items() if part}
    day, hour, minute, second = (float(parts.get(name, "0").replace(",", ".")) for name in _PARTS)
    sign = -1.0 if parts.get("sign") == "-" else 1.0
    return DAY_S * day * (sign if "P" in cell else 1.0) + sign * (3600.0 * hour + 60.0 * minute + second)


_PARTS = ("day", "hour", "minute", "second")


def seconds_of_stamp(cell: str) -> tuple[float, str] | None:
    """Seconds since midnight (or the start) and the date as written (empty without one); None of no such cell."""
    if (duration := _duration(cell)) is not None:
        return duration, ""
    parts = _STAMP.fullmatch(cell if ":" in cell[:-3] else _COMPACT.sub(r"\1-\2-\3T\4:\5:\6\7", cell))
    if parts is None or int(parts[2]) > 23 or int(parts[3]) > 59 or int(parts[4]) > 60:
        return None
    hour, minute, second = int(parts[2]), int(parts[3]), int(parts[4])
    if parts[6]:
        hour = hour % 12 + (12 if parts[6] in "pP" else 0)
    return 3600.0 * hour + 60.0 * minute + float(f"{second}.{parts[5] or 0}"), parts[1] or ""


DAY_S = 86400.0
_DATE = re.compile(_DAY, re.ASCII)
_ORDERS = ("year-month-day", "day-month-year", "month-day-year")
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")


def is_date(cell: str) -> bool:
    """Whether a cell is a date in digits."""
    return _DATE.fullmatch(cell) is not None


def elapsed_seconds(stamps: Sequence[tuple[float, str]], log: ImportLog) -> NDArray:
    """Return the seconds of stamps since midnight of the first day."""
    days, order = _days([text for _, text in stamps], log)
    seconds, day, clock, guessed, last = [], 0, stamps[0][0], 0, ""
    for now, text in stamps:
        if text and text != last:
            day, last = days[text], text
        elif not text and now < clock - 0.5 * DAY_S:
            day, guessed = day + 1, guessed + 1
        clock = now
        seconds.append(DAY_S * day + now)
    if len(days) > 1:
        log.decide("days", f"{max(days.values())} after the first", f"by the dates of the file, read as {order}")
    if guessed:
        why = "the clock goes back and these rows have no date: one day is the least; it may be more"
        log.decide("midnight", f"{guessed} days added" if guessed > 1 else "1 day added", why)
    return np.array(seconds)


def _days(texts: Sequence[str], log: ImportLog) -> tuple[dict[str, int], str]:
    """Days of each date since the first one, and the order in which they are written."""
    written = [text for text in dict.fromkeys(texts) if text]
    if len(written) < 2:
        return dict.fromkeys(written, 0), ""
    fitting = []
    for order in _ORDERS:
        try:
            ordinals = [_ordinal(text, order) for text in written]
        except ValueError:
            continue
        days = [one - ordinals[0] for one in ordinals]
        dotted = order != "day-month-year" and "." in written[0] and not re.match(r"\d{4}", written[0])
        fitting.append((dotted, days != sorted(days), max(days) - min(days), dict(zip(written, days)), order))
    if not fitting:
        shown = "', '".join(written[:2])
        raise log.fault(f"dates '{shown}' are in no known order; write year-month-day", "malformed", "date")
    return min(fitting, key=lambda one: one[:3])[3:]


def _ordinal(text: str, order: str) -> int:
    """Number of the day of a date; two digits of a year are of this century."""
    parts = dict(zip(order.split("-"), re.split("[-/., ]+", text)))
    name = parts["month"][:3].lower()
    parts["month"] = str(_MONTHS.index(name) + 1) if name in _MONTHS else parts["month"]
    year = parts["year"] if len(parts["year"]) != 2 else f"20{parts['year']}"
    return datetime.strptime(f"{year}-{parts['month']}-{parts['day']}", "%Y-%m-%d").toordinal()
