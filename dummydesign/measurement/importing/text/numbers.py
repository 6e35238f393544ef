"""Numbers and clock times as they are written: decimal and thousands signs, typographic minus, stamps of time."""

from __future__ import annotations

import re
from collections.abc import Iterable

_MINUS = str.maketrans({"−": "-", "–": "-", "－": "-"})
_GROUPS = {".": ",'’ \u00a0\u202f", ",": ".'’ \u00a0\u202f"}
_NUMBER = {
    decimal: re.compile(
        rf"[+-]?(?:[1-9]\d{{0,2}}(?:([{groups}])\d{{3}})(?:\1\d{{3}})*|\d+)?(?:{re.escape(decimal)}\d*)?(?:[eE][+-]?\d+)?",
        re.ASCII,
    )
    for decimal, groups in _GROUPS.items()
}
_PLAIN = {".": re.compile(r"-?\d+(?:\.\d+)?", re.ASCII), ",": re.compile(r"-?\d+(?:,\d+)?", re.ASCII)}
"""Numbers of the usual form, which most are; the patterns above also take groups, exponents and other signs."""
_DIGITS = frozenset("0123456789")
_NOT_FINITE = {"nan", "inf", "-inf", "+inf", "#nv", "#n/a", "n/a", "na", "null", "none", "---", "--", "-", "overflow"}
_STAMP = re.compile(
    r"(?:(\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4})[T ]+)?"
    r"(\d{1,2}):(\d{2}):(\d{2})(?:[.,:](\d+))?(?: ?([AaPp])\.?[Mm]\.?)?(?:Z| ?[+-]\d{2}:?\d{2})?",
    re.ASCII,
)
_MINUTES = re.compile(r"(\d{1,3}):(\d{2})[.,](\d+)", re.ASCII)


def is_number(cell: str, decimal: str | None = None) -> bool:
    """Whether a cell is a number, with this decimal sign or with either."""
    return any(parse(cell, sign) is not None for sign in ((decimal,) if decimal else (".", ",")))


def parse(cell: str, decimal: str) -> float | None:
    """Read a number with this decimal sign, thousands signs taken out; None where it is none."""
    if _PLAIN[decimal].fullmatch(cell):
        return float(cell.replace(",", "."))
    text = cell.translate(_MINUS)
    if not any(letter in _DIGITS for letter in text) or not _NUMBER[decimal].fullmatch(text):
        return None
    for sign in _GROUPS[decimal]:
        text = text.replace(sign, "")
    try:
        return float(text.replace(",", "."))
    except ValueError:  # an exponent without a mantissa
        return None


def is_missing(cell: str) -> bool:
    """Whether a cell stands for a number that is not there."""
    return not cell or cell.lower() in _NOT_FINITE


def has_thousands(cell: str, decimal: str) -> bool:
    """Whether a number is written with thousands signs."""
    return any(sign in cell for sign in _GROUPS[decimal])


def decimal_evidence(cells: Iterable[str]) -> dict[str, int]:
    """Count numbers that can only be read with a dot, or only with a comma, as decimal sign; and the undecided.

    A single sign followed by exactly three digits, as in 1,795, may be either; 0,795 and 17,95 are decimals, and
    with two kinds of sign the last one is the decimal sign.

    Returns
    -------
    dict
        Counts under ``"."``, ``","`` and ``"either"``.
    """
    count = {".": 0, ",": 0, "either": 0}
    for cell in cells:
        mantissa = re.split("[eE]", cell.translate(_MINUS).lstrip("+-"))[0]
        for odd in "'’ \u00a0\u202f":
            mantissa = mantissa.replace(odd, "")
        dots, commas = mantissa.count("."), mantissa.count(",")
        if not dots and not commas:
            continue
        if dots and commas:
            count["." if mantissa.rindex(".") > mantissa.rindex(",") else ","] += 1
            continue
        sign, other, times = (".", ",", dots) if dots else (",", ".", commas)
        if times > 1:
            count[other] += 1
            continue
        before, after = mantissa.split(sign)
        grouped = len(after) == 3 and 1 <= len(before) <= 3 and not before.startswith("0")
        exponent = len(mantissa) < len(cell.lstrip("+-−"))
        count["either" if grouped and not exponent else sign] += 1
    return count


def is_stamp(cell: str) -> bool:
    """Whether a cell is a time of day, with or without a date, or minutes and seconds."""
    return ":" in cell and (_STAMP.fullmatch(cell) is not None or _MINUTES.fullmatch(cell) is not None)


def seconds_of_stamp(cell: str) -> tuple[float, str]:
    """Seconds since midnight (or the start) and the date as written (empty without one).

    Raises
    ------
    ValueError
        When the cell is no stamp, or names an hour, minute or second that there is not.
    """
    short = _MINUTES.fullmatch(cell)
    if short is not None:
        return int(short[1]) * 60.0 + float(f"{int(short[2])}.{short[3]}"), ""
    parts = _STAMP.fullmatch(cell)
    if parts is None:
        raise ValueError(cell)
    hour, minute, second = int(parts[2]), int(parts[3]), int(parts[4])
    if hour > 23 or minute > 59 or second > 60:
        raise ValueError(cell)
    if parts[6]:
        hour = hour % 12 + (12 if parts[6] in "pP" else 0)
    return 3600.0 * hour + 60.0 * minute + float(f"{second}.{parts[5] or 0}"), parts[1] or ""
