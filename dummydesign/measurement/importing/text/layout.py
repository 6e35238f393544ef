"""Where the table of numbers stands in a text, how its cells are parted, and what its header says."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import NoTableError, Notes, Settings, question
from dummydesign.measurement.importing.text.cells import SEPARATORS, is_comment, split, whole_cells
from dummydesign.measurement.importing.text.faults import refuse_two_commas, refuse_unfinished, why_no_table
from dummydesign.measurement.importing.text.header import find_header
from dummydesign.measurement.importing.text.numbers import (
    decimal_evidence,
    has_thousands,
    is_missing,
    is_number,
    is_stamp,
)

LEAST_ROWS = 3
LONGEST_LINE = 20_000
_SAMPLE = 60


@dataclass(frozen=True)
class Layout:
    """The table inside a text.

    Attributes
    ----------
    file : str
        Name for messages.
    lines : list of str
        All lines.
    first, last : int
        The table's numbers stand in ``lines[first:last]``.
    skipped : int
        Lines left out before ``lines[0]``, so that line numbers in messages are those of the file.
    separator, decimal : str
    thousands : bool
        Whether numbers have thousands signs.
    kinds : tuple of str
        ``number``, ``stamp``, ``text`` or ``empty``, a column each.
    names, units : tuple of str
        Header and unit row, a cell a column; empty where there is none.
    """

    file: str
    lines: list[str]
    first: int
    last: int
    skipped: int
    separator: str
    decimal: str
    thousands: bool
    kinds: tuple[str, ...]
    names: tuple[str, ...]
    units: tuple[str, ...]

    def line(self, index: int) -> int:
        """Line number in the file, from 1, of ``lines[index]``."""
        return index + self.skipped + 1

    def cells(self, line: str) -> list[str]:
        """Part one line."""
        return split(line, self.separator)


def find_layout(file: str, text: str, settings: Settings, notes: Notes) -> Layout:
    """Find the table of numbers.

    Separator and decimal sign are read off lines spread over the whole text; then the first and the last line of
    that form bound the table, and the header is looked for above it.

    Parameters
    ----------
    file, text : str
        Name for messages, and the file as text.
    settings : Settings
        What the user settled.
    notes : Notes
        Receives the decisions.

    Raises
    ------
    InputError
        When there is no table, when the file breaks off within a line, or when comma parts both cells and decimals.
    QuestionError
        When the decimal sign can be either.
    """
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    skipped = settings.skip or 0
    lines = whole_cells(lines[skipped:])
    sample = _spread(lines)
    if not sample:
        raise NoTableError(f"{file}: holds no table: nothing but comments and blank lines")
    longest = max(map(len, sample))
    if longest > LONGEST_LINE:
        raise NoTableError(
            f"{file}: a line is {longest} characters long: the line ends are lost; export the test as text again"
        )
    separator = _separator(file, sample, settings, notes)
    width, kinds = _columns(sample, separator)
    if settings.separator is not None and (width < 2 or kinds.count("number") + kinds.count("stamp") < 2):
        raise InputError(
            f"{file}: parted by {SEPARATORS[separator]}, as --separator or the profile says, there is no table of "
            "numbers; leave that out to have it found"
        )
    if width < 2 or kinds.count("number") + kinds.count("stamp") < 2:
        raise NoTableError(f"{file}: {why_no_table(lines, separator)}")
    first, last = _bounds(lines, separator, kinds)
    if last - first < LEAST_ROWS:
        raise NoTableError(f"{file}: {why_no_table(lines, separator)}")
    body = lines[first:last]
    cells = [
        cell
        for line in body[:: max(len(body) // 300, 1)]
        for cell, kind in zip(split(line, separator), kinds)
        if kind == "number" and is_number(cell)
    ]
    decimal = _decimal(file, cells, separator, settings, notes)
    names, units, where = find_header(lines, first, separator, kinds)
    refuse_two_commas(file, separator, cells, len(kinds), lines, first)
    refuse_unfinished(file, lines, last, separator, kinds, skipped)
    _tell(lines, first, last, where, notes)
    thousands = any(has_thousands(cell, decimal) for cell in cells)
    return Layout(file, lines, first, last, skipped, separator, decimal, thousands, kinds, names, units)


def _spread(lines: Sequence[str]) -> list[str]:
    """Some lines of the whole text, neither blank nor comments."""
    for step in (max(len(lines) // (4 * _SAMPLE), 1), 1):
        used = [line for line in lines[::step] if line.strip() and not is_comment(line)]
        if len(used) >= min(_SAMPLE, len(lines)) or step == 1:
            break
    return used[:: max(len(used) // _SAMPLE, 1)]


def separator_of(word: str) -> str:
    """Read ``--separator``: the sign itself or its name.

    Raises
    ------
    InputError
        For any other word.
    """
    known = {**{sign: sign for sign in SEPARATORS}, **{name: sign for sign, name in SEPARATORS.items()}, "\\t": "\t"}
    known |= {"space": " ", "whitespace": " ", "pipe": "|"}
    if word.lower() not in known:
        raise InputError(f"--separator '{word}' is not one of tab, semicolon, comma, bar, spaces (or the sign itself)")
    return known[word.lower()]


def _separator(file: str, sample: Sequence[str], settings: Settings, notes: Notes) -> str:
    if settings.separator is not None:
        separator = separator_of(settings.separator)
        notes.decide("separator", SEPARATORS[separator], "given by --separator")
        return separator
    best, chosen = 0.0, ""
    for separator in SEPARATORS:
        rows = [split(line, separator) for line in sample if separator == " " or separator in line]
        # Empty cells do not count: a tab at the end of every line makes one.
        counted = [(len(row), _numbers_in(row), sum(map(bool, row))) for row in rows]
        good = [(width, numbers / filled) for width, numbers, filled in counted if numbers >= 2]
        if not good:
            continue
        width, count = Counter(width for width, _ in good).most_common(1)[0]
        score = count / len(sample) * sum(share for one, share in good if one == width) / count
        if separator == " ":
            score *= 0.95  # a tab is white space too: where it parts nearly as well, it is meant
        if score > best + 1e-9:
            best, chosen = score, separator
    if not chosen:
        raise NoTableError(f"{file}: {why_no_table(sample, ';')}")
    notes.decide("separator", SEPARATORS[chosen], "parts most lines into equally many numbers")
    return chosen


def _numbers_in(row: Sequence[str]) -> int:
    return sum(is_number(cell) or is_stamp(cell) for cell in row)


def _columns(sample: Sequence[str], separator: str) -> tuple[int, tuple[str, ...]]:
    """Number of columns and what each of them holds, by the sampled lines."""
    rows = [split(line, separator) for line in sample]
    rows = [row for row in rows if _numbers_in(row) >= 2]
    if not rows:
        return 0, ()
    width = Counter(map(len, rows)).most_common(1)[0][0]
    kinds = []
    for column in zip(*(row for row in rows if len(row) == width)):
        filled = [cell for cell in column if not is_missing(cell)]
        if not filled:
            kinds.append("empty")
        elif sum(map(is_number, filled)) >= 0.7 * len(filled):
            kinds.append("number")
        elif sum(map(is_stamp, filled)) >= 0.7 * len(filled):
            kinds.append("stamp")
        else:
            kinds.append("text")
    return width, tuple(kinds)


def is_row(cells: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether cells are a row of the table: every column holds what it should, and not all of it is missing."""
    if len(cells) != len(kinds):
        return False
    filled = 0
    for cell, kind in zip(cells, kinds):
        if kind in ("number", "stamp"):
            if (is_number if kind == "number" else is_stamp)(cell):
                filled += 1
            elif not is_missing(cell):
                return False
    return filled > 0


def _bounds(lines: Sequence[str], separator: str, kinds: Sequence[str]) -> tuple[int, int]:
    """First and one past the last line of the table; a lone row of numbers in a preamble does not begin it."""

    def row(index: int) -> bool:
        return not is_comment(lines[index]) and is_row(split(lines[index], separator), kinds)

    first = 0
    while first < len(lines):
        if row(first):
            ahead = [i for i in range(first + 1, min(first + 8, len(lines))) if lines[i].strip()][:2]
            if all(map(row, ahead)):
                break
        first += 1
    first += _counts_columns(lines, first, separator)
    last = len(lines)
    while last > first and not row(last - 1):
        last -= 1
    return first, last


def _counts_columns(lines: Sequence[str], first: int, separator: str) -> int:
    """1 where the first row only counts the columns (1;2;3), which some programs write under their names."""
    if first + 1 >= len(lines):
        return 0
    cells = split(lines[first], separator)
    counted = any(cells == [str(begin + place) for place in range(len(cells))] for begin in (0, 1))
    return int(counted and len(cells) > 2 and not split(lines[first + 1], separator)[0].startswith(("2", "1.0", "1,0")))


def _decimal(file: str, cells: Sequence[str], separator: str, settings: Settings, notes: Notes) -> str:
    seen = decimal_evidence(cells)
    if settings.decimal is not None:
        other = "," if settings.decimal == "." else "."
        if seen[other] > seen[settings.decimal]:
            raise InputError(
                f"{file}: with --decimal {settings.decimal} most numbers cannot be read: {seen[other]} of them have "
                f"'{other}' as their decimal sign; leave the option (or the profile) out"
            )
        notes.decide("decimal", settings.decimal, "given by --decimal")
        return settings.decimal
    if seen["."] and seen[","]:
        few, many = sorted((".", ","), key=lambda sign: seen[sign])
        if seen[few] > 0.02 * seen[many]:
            doubt = f"{seen['.']} numbers have a decimal dot and {seen[',']} a decimal comma"
            raise question(file, doubt, "--decimal . or --decimal ,")
        seen[few] = 0
    if seen["."] or seen[","]:
        decimal = "." if seen["."] else ","
        notes.decide("decimal", decimal, f"{seen[decimal]} of the numbers looked at can be read in this way only")
        return decimal
    if seen["either"] and any("," in cell for cell in cells):
        example = next(cell for cell in cells if "," in cell)
        raise question(file, f"'{example}' may be a decimal or a thousand", "--decimal , or --decimal .")
    if seen["either"] and separator != ",":
        example = next(cell for cell in cells if "." in cell)
        raise question(file, f"'{example}' may be a decimal or a thousand", "--decimal . or --decimal ,")
    notes.decide("decimal", ".", "the comma parts the columns" if separator == "," else "no number has a decimal sign")
    return "."


def _tell(lines: Sequence[str], first: int, last: int, where: Sequence[int], notes: Notes) -> None:
    before = [index for index in range(first) if lines[index].strip() and index not in where]
    if before:
        notes.decide(
            "preamble", f"{len(before)} lines", f"no numbers of the table; the first: '{_short(lines[before[0]])}'"
        )
    after = [line for line in lines[last:] if line.strip()]
    if after:
        notes.decide("footer", f"{len(after)} lines", f"not rows of the table; the first: '{_short(after[0])}'")


def _short(line: str) -> str:
    text = " ".join(line.split())
    return text if len(text) <= 60 else text[:57] + "..."
