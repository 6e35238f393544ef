"""Clock times over several days: by their dates where the file has them, else by the clock that goes back."""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes

DAY_S = 86400.0
_DATE = re.compile(r"\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[-/.]\d{1,2}[-/.]\d{2,4}", re.ASCII)
_ORDERS = ("year-month-day", "day-month-year", "month-day-year")


def is_date(cell: str) -> bool:
    """Whether a cell is a date in digits."""
    return _DATE.fullmatch(cell) is not None


def elapsed_seconds(file: str, stamps: Sequence[tuple[float, str]], notes: Notes) -> NDArray:
    """Seconds of stamps since midnight of the first day.

    Parameters
    ----------
    file : str
        Name for messages.
    stamps : sequence of (float, str)
        Clock and date of each row, from :func:`dummydesign.measurement.importing.text.numbers.seconds_of_stamp`.
    notes : Notes
        Receives the days between the rows, where they are of more than one day.

    Returns
    -------
    ndarray, shape (rows,)

    Raises
    ------
    InputError
        Where several dates are in no known order.
    """
    days, order = _days(file, [text for _, text in stamps])
    seconds, day, clock, guessed, last = [], 0, stamps[0][0], 0, ""
    for now, text in stamps:
        if text and text != last:
            day, last = days[text], text
        elif not text and now < clock - 0.5 * DAY_S:
            day, guessed = day + 1, guessed + 1
        clock = now
        seconds.append(DAY_S * day + now)
    if len(days) > 1:
        notes.decide("days", f"{max(days.values())} after the first", f"by the dates of the file, read as {order}")
    if guessed:
        notes.decide(
            "midnight", f"{guessed} days added" if guessed > 1 else "1 day added",
            "the clock goes back and these rows have no date: one day is the least; it may be more",
        )  # fmt: skip
    return np.array(seconds)


def _days(file: str, texts: Sequence[str]) -> tuple[dict[str, int], str]:
    """Days of each date since the first one, and the order in which they are written.

    Where several orders fit, dates that never go back come first, then the shortest time.
    """
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
        raise InputError(f"{file}: dates '{shown}' are in no known order; write them as year-month-day")
    best = min(fitting, key=lambda one: one[:3])
    return best[3], best[4]


def _ordinal(text: str, order: str) -> int:
    """Number of the day of a date.

    Raises
    ------
    ValueError
        Where there is no such day.
    """
    parts = re.split("[-/.]", text)
    year, month, day = (parts[order.split("-").index(word)] for word in ("year", "month", "day"))
    if len(year) not in (2, 4) or max(len(month), len(day)) > 2:
        raise ValueError(text)
    return date(int(year) + (2000 if len(year) == 2 else 0), int(month), int(day)).toordinal()
