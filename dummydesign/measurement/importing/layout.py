"""Where the table of numbers is in a text, how its cells are separated, and its header."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice
from textwrap import shorten

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing import cells as cell_text
from dummydesign.measurement.importing import vocabulary
from dummydesign.measurement.importing.cells import (
    COMMENTS,
    SEPARATORS,
    is_absent,
    is_comment,
    is_excluded,
    is_missing,
    is_number,
    is_stamp,
)
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.forms import plain_lines

LEAST_ROWS = 3
LONGEST_LINE = 20_000
LEAST_GAPS = 0.2
"""Share of empty cells from which on quantities are written in rows of their own; fewer are drop-outs."""
HEADER_LINES = 8
"""Lines above the table that may be its header."""
_LONGEST_NAME = 80
_SAMPLE = 60
_TESTS = {"number": is_number, "stamp": is_stamp, "measure": cell_text.is_measure}
"""What the cells of a column are known by."""


Texts = tuple[str, ...]


@dataclass(frozen=True)
class TableLayout:
    """The table inside a text: its lines from ``first`` to before ``last``, and names, units and kinds of columns."""

    lines: list[str]
    first: int
    last: int
    skipped: int
    separator: str
    decimal: str
    thousands: bool
    kinds: Texts
    names: Texts
    units: Texts
    rate_Hz: float | None = None
    """Sampling rate that the lines above the table state."""
    sparse: bool = False
    """Whether quantities are written in rows of their own, the other cells empty."""

    def line(self, index: int) -> int:
        """Line number in the file, from 1, of ``lines[index]``."""
        return index + self.skipped + 1

    def repeats(self, line: int) -> bool:
        """Whether a line of the file is word for word the one before, blank lines left out."""
        at = line - self.skipped - 1
        before = next((one for one in reversed(self.lines[max(at - 8, 0) : at]) if one.strip()), "")
        return self.lines[at] == before

    def cells(self, line: str) -> list[str]:
        """Split one line."""
        return cell_text.split(line, self.separator)


def find_layout(text: str, log: ImportLog) -> TableLayout:
    """Find the table of numbers."""
    skipped = log.settings.skip or 0
    written = cell_text.whole_cells(text.replace("\r\n", "\n").replace("\r", "\n").split("\n")[skipped:])
    lines = plain_lines(written, log)
    skipped -= len(lines) - len(written)
    sample = _spread(lines)
    if not sample:
        skipped_text = f" after its first {log.settings.skip} lines (--skip)" if log.settings.skip else ""
        raise log.no_table(f"holds no table: nothing but comments and blank lines{skipped_text}")
    longest = max(map(len, sample))
    if longest > LONGEST_LINE:
        message = f"a line is {longest} characters long: the line ends are lost; export the test as text again"
        raise log.no_table(message, "malformed", longest)
    separator = _separator(sample, log)
    kinds = _column_kinds(sample, separator)
    if sum(map(kinds.count, _TESTS)) < 2:
        if log.settings.separator is None:
            raise log.no_table(_why_no_table(lines))
        raise log.fault(
            f"separated by {SEPARATORS[separator]}, as --separator or the profile says, there is no table "
            "of numbers; leave that out to have it found",
            "inconsistent",
            "separator",
            log.settings.separator,
        )
    first, last = _bounds(lines, separator, kinds)
    if last - first < LEAST_ROWS:
        raise log.no_table(_why_no_table(lines))
    rows = [cell_text.split(line, separator) for line in _thinned(lines[first:last], (last - first) // 300)]
    cells = [cell for row in rows for cell, kind in zip(row, kinds) if kind == "number" and is_number(cell)]
    full = list(zip(*(row for row in rows if len(row) == len(kinds))))
    inside = [_units_inside(column, kind, cells) for column, kind in zip(full, kinds)]
    words = (map(vocabulary.roles_of_name, set(column)) for column, kind in zip(full, kinds) if kind == "text")
    if any(frozenset[str]().union(*roles) >= {"displacement", "force"} for roles in words):
        raise log.fault(
            "one row a reading: the quantity is named in the row; pivot it to a column for each quantity, in pandas by "
            "pivot(index, columns, values)",
            "malformed",
            "table",
            line=first + skipped + 1,
        )
    sparse = any(kind == "number" and _gaps(column) >= LEAST_GAPS for column, kind in zip(full, kinds))
    decimal = _decimal(cells, separator, log)
    names, units, header = find_header(lines, first, separator, len(kinds))
    beside = [unit if kind == "text" else "" for unit, kind in zip([*inside[1:], ""], [*kinds[1:], ""])]
    if kinds.count("measure") + sum(map(bool, beside)) < 2:  # a single letter may be a status
        inside = [unit if kind == "measure" else "" for unit, kind in zip(inside, kinds)]
        beside = [""] * len(kinds)
    if any(inside):
        log.decide("units", ", ".join(filter(None, inside)), "stand behind the numbers, in the cells")
        units = tuple(
            own or unit or (right if kind == "number" else "")
            for own, unit, right, kind in zip(inside, units, beside, kinds)
        )
    _refuse_two_commas(separator, cells, len(kinds), lines[max(first - HEADER_LINES, 0) : first], log)
    _refuse_unfinished(lines, last, separator, kinds, log)
    before = [lines[at] for at in range(first) if lines[at].strip() and at not in header]
    after = [line for line in lines[last:] if line.strip()]
    rates = {rate for at in range(first) if at not in header if (rate := vocabulary.sampling_rate_in(lines[at]))}
    for what, beyond, none in (("preamble", before, "no numbers"), ("footer", after, "not rows")):
        if beyond:
            first_line = shorten(beyond[0], 60, placeholder="...")
            log.decide(what, f"{len(beyond)} lines", f"{none} of the table; the first: '{first_line}'")
    thousands = any(cell_text.has_thousands(cell, decimal) for cell in cells)
    rate = rates.pop() if len(rates) == 1 else None
    return TableLayout(
        lines, first, last, skipped, separator, decimal, thousands, kinds, names, units, rate_Hz=rate, sparse=sparse
    )


def _gaps(column: Sequence[str]) -> float:
    """Share of cells without a reading between the first and the last one that has one."""
    empty = list(map(is_absent, column))
    first, last = (empty.index(False), len(empty) - empty[::-1].index(False)) if False in empty else (0, 0)
    return sum(empty[first:last]) / max(last - first, 1)


def _units_inside(column: Sequence[str], kind: str, numbers: list[str]) -> str:
    """The unit in the cells of a column, the likeliest of several, or that it consists of; their numbers are added."""
    if kind == "text":
        units = {cell for cell in column if cell}
        return units.pop() if len(units) == 1 and vocabulary.find_unit(min(units)) else ""
    if kind != "measure":
        return ""
    read = [parts for cell in column if (parts := cell_text.measure(cell))]
    numbers += [number for number, _ in read]
    return Counter(unit.text for _, unit in read).most_common(1)[0][0]


def _spread(lines: Sequence[str]) -> list[str]:
    """Some lines of the whole text, neither blank nor comments."""
    for step in (len(lines) // (4 * _SAMPLE), 1):
        used = [line for line in _thinned(lines, step) if line.strip() and not is_comment(line)]
        if len(used) >= min(_SAMPLE, len(lines)):
            break
    return _thinned(used, len(used) // _SAMPLE)


def _thinned(lines: Sequence[str], step: int) -> list[str]:
    """One of so many lines, each at another place among them: all rows are seen where quantities take turns."""
    step = max(step, 1)
    return [lines[turn * step + turn % step] for turn in range(len(lines) // step)]


def _why_no_table(lines: Sequence[str]) -> str:
    heads = (cell_text.split(line, sign) for line in lines[:200] for sign in SEPARATORS if sign in line)
    head = next((cells for cells in heads if _count_names(cells) >= 2), [])
    absent = vocabulary.absent_roles(head) if head else ()
    if absent:
        return vocabulary.absent_words(absent, head)
    if head:
        return "has a header but no rows of numbers below it; export the test with its data"
    return "holds no table of numbers; export time, displacement and force as columns of text"


def _count_names(cells: Sequence[str]) -> int:
    return sum(bool(vocabulary.roles_of_name(vocabulary.split_name(cell)[0])) for cell in cells)


def _read_separator(word: str) -> str:
    """Read ``--separator``: the sign itself or its name."""
    known = {"\\t": "\t", "space": " ", "whitespace": " ", "pipe": "|"}
    known |= {word: sign for sign, name in SEPARATORS.items() for word in (sign, name)}
    if word.lower() not in known:
        message = f"--separator '{word}' is not one of tab, semicolon, comma, bar, spaces (or the sign itself)"
        raise InputError(message, "unknown_name", "separator", word)
    return known[word.lower()]


def _separator(sample: Sequence[str], log: ImportLog) -> str:
    if log.settings.separator is not None:
        separator = _read_separator(log.settings.separator)
        log.decide("separator", SEPARATORS[separator], "given by --separator")
        return separator
    best, chosen = 0.0, ""
    for separator in SEPARATORS:
        rows = [cell_text.split(line, separator) for line in sample if separator == " " or separator in line]
        # Empty cells do not count: a tab at the end of every line makes one.
        counted = [(len(row), _count_numbers(row), sum(map(bool, row))) for row in rows]
        good = [(width, numbers / filled) for width, numbers, filled in counted if numbers >= 2]
        if not good:
            continue
        width, count = Counter(width for width, _ in good).most_common(1)[0]
        score = count / len(sample) * sum(share for one, share in good if one == width) / count
        # a tab is white space too: where it separates nearly as well, it is meant
        score *= 0.95 if separator == " " else 1.0
        if score > best + 1e-9:
            best, chosen = score, separator
    if not chosen:
        raise log.no_table(_why_no_table(sample))
    log.decide("separator", SEPARATORS[chosen], "parts most lines into equally many numbers")
    return chosen


def _count_numbers(row: Sequence[str]) -> int:
    return sum(any(test(cell) for test in _TESTS.values()) for cell in row)


def _column_kinds(sample: Sequence[str], separator: str) -> tuple[str, ...]:
    """What each column holds by the sampled lines: ``number``, ``stamp``, ``text`` or ``empty``."""
    rows = [row for line in sample if _count_numbers(row := cell_text.split(line, separator)) >= 2]
    width = Counter(map(len, rows)).most_common(1)[0][0] if rows else 0
    kinds = []
    for column in zip(*(row for row in rows if len(row) == width)):
        filled = [cell for cell in column if not is_missing(cell)]
        kind = next((kind for kind, test in _TESTS.items() if sum(map(test, filled)) >= 0.7 * len(filled)), "text")
        kinds.append(kind if filled else "empty")
    return tuple(kinds)


def _is_row(cells: Sequence[str], kinds: Sequence[str]) -> bool:
    """Whether cells are a row of the table: every column holds what it should, and not all of it is missing."""
    if len(cells) != len(kinds):
        return False
    fits = [(cell, _TESTS[kind](cell)) for cell, kind in zip(cells, kinds) if kind in _TESTS]
    return any(fit for _, fit in fits) and all(fit or is_missing(cell) for cell, fit in fits)


def _bounds(lines: Sequence[str], separator: str, kinds: Sequence[str]) -> tuple[int, int]:
    """First and one past the last line of the table; a lone row of numbers in a preamble does not begin it."""

    def row(index: int) -> bool:
        return not is_comment(lines[index]) and _is_row(cell_text.split(lines[index], separator), kinds)

    def begins(index: int) -> bool:
        ahead = (i for i in range(index + 1, min(index + 8, len(lines))) if lines[i].strip())
        return row(index) and all(row(i) for i in islice(ahead, 2))

    first = next((index for index in range(len(lines)) if begins(index)), len(lines))
    first += _counts_columns(lines, first, separator)
    last = next((index + 1 for index in range(len(lines) - 1, first - 1, -1) if row(index)), first)
    return first, last


def _counts_columns(lines: Sequence[str], first: int, separator: str) -> bool:
    """Whether the first row only counts the columns (1;2;3), which some programs write under their names."""
    if first + 1 >= len(lines):
        return False
    cells = cell_text.split(lines[first], separator)
    if len(cells) < 3 or not any(cells == [str(begin + at) for at in range(len(cells))] for begin in (0, 1)):
        return False
    return not "".join(cell_text.split(lines[first + 1], separator)[:1]).startswith(("2", "1.0", "1,0"))


def _decimal(cells: Sequence[str], separator: str, log: ImportLog) -> str:
    seen, given = cell_text.decimal_evidence(cells), log.settings.decimal
    if given is not None:
        other = "," if given == "." else "."
        if seen[other] > seen[given]:
            message = f"--decimal {given}, but {seen[other]} numbers have '{other}'; leave the option (or profile) out"
            raise log.fault(message, "inconsistent", "decimal", given)
        log.decide("decimal", given, "given by --decimal")
        return given
    few, many = sorted((".", ","), key=lambda sign: seen[sign])
    if seen[few] > 0.02 * seen[many]:
        raise log.question(
            f"{seen['.']} numbers have a decimal dot and {seen[',']} a decimal comma", "--decimal . or --decimal ,"
        )
    if seen[many]:
        log.decide("decimal", many, f"{seen[many]} of the numbers looked at can be read in this way only")
        return many
    sign, other = (",", ".") if any("," in cell for cell in cells) else (".", ",")
    if seen["either"] and (sign == "," or separator != ","):
        example = next(cell for cell in cells if sign in cell)
        raise log.question(f"'{example}' may be a decimal or a thousand", f"--decimal {sign} or --decimal {other}")
    log.decide("decimal", ".", "the comma parts the columns" if separator == "," else "no number has a decimal sign")
    return "."


def find_header(lines: Sequence[str], first: int, separator: str, width: int) -> tuple[Texts, Texts, list[int]]:
    """Find names and units above the table, and the indices of their lines."""
    block: list[tuple[int, list[str], int]] = []
    for index in range(first - 1, max(first - 1 - 3 * HEADER_LINES, -1), -1):
        cells = _header_cells(lines[index], separator, width)
        if cells is None or any(map(is_number, cells)):
            # the header is the block just above the numbers; a comment or a blank line may stand below it
            if any(not _are_units(row) for row in block):
                break
            continue
        block.append((index, cells, sum(vocabulary.find_unit(cell) is not None for cell in cells)))
        if len(block) == HEADER_LINES:
            break
    units = max((row for row in block if _are_units(row)), key=lambda row: (row[2], row[0]), default=None)
    named = [(sum(map(_is_name, cells)), index, cells) for index, cells, _ in block if not units or index != units[0]]
    names = max(named, key=lambda row: row[:2], default=None)
    texts = [tuple(cells) if cells else ("",) * width for cells in (names and names[2], units and units[1])]
    return texts[0], texts[1], [index for index in (names and names[1], units and units[0]) if index is not None]


def _are_units(row: tuple[int, list[str], int]) -> bool:
    """Whether most cells of a row are units."""
    return row[2] >= max(2, 0.6 * sum(map(bool, row[1])))


def _is_name(cell: str) -> bool:
    name, unit = vocabulary.split_name(cell)
    return bool(vocabulary.roles_of_name(name)) or unit is not None


def _header_cells(line: str, separator: str, width: int) -> list[str] | None:
    """Split a line above the table into as many cells as the table has; None where that cannot be."""
    text = line.strip()
    for mark in COMMENTS:
        text = text.removeprefix(mark)
    if not text.strip():
        return None
    ways = [cell_text.split(line if text == line.strip() else text, separator)]
    if separator == " ":
        ways.insert(0, [part.strip() for part in text.replace("\t", "  ").split("  ") if part.strip()])
    ways += [cell_text.split(text, other) for other in SEPARATORS if other not in (separator, " ") and other in text]
    for cells in ways:
        cells = cell_text.without_empty_end(cells, width)
        if len(cells) == width - 1 >= 2 and separator != " ":
            cells = [*cells, ""]
        if len(cells) == width:
            # the clock of a serial monitor stands above its own column too
            return ["" if is_stamp(cell) else cell.strip('"').strip()[:_LONGEST_NAME] for cell in cells]
    return None


def _refuse_two_commas(separator: str, cells: Sequence[str], width: int, header: Sequence[str], log: ImportLog) -> None:
    """Refuse a table in which the comma separates both columns and decimals."""
    if separator != "," or width % 2 or any("." in cell or "," in cell for cell in cells):
        return
    for names in (cell_text.split(line, ",") for line in header):
        if len(names) == width // 2 and _count_names(names) >= 2:
            raise log.fault(
                f"{len(names)} names but {width} cells a row: the comma separates both columns and "
                "decimals, which look the same; export with ';' between columns, or with numbers in quotes",
                "malformed",
                "table",
            )


def _refuse_unfinished(lines: Sequence[str], last: int, separator: str, kinds: Sequence[str], log: ImportLog) -> None:
    """Refuse a file that is still being written: its last line has no end and breaks off within a row."""
    if len(lines) < 2 or not lines[-1].strip():
        return
    index = len(lines) - 1
    cells = cell_text.split(lines[-1], separator)
    broken = last <= index and all(cell in ("", "-", "+") or is_number(cell) or is_stamp(cell) for cell in cells)
    if last == index + 1:
        final = max((i for i, kind in enumerate(kinds) if kind in ("number", "measure")), default=0)
        rows = [cell_text.split(line, separator) for line in lines[max(index - 40, 0) : index]]
        digits = [_decimals(row[final]) for row in rows if len(row) == len(kinds)]
        fewer = len(digits) > 5 and len(set(digits)) == 1 and _decimals(cells[final]) < digits[0]
        broken = (is_missing(cells[final]) and not is_excluded(cells[final])) or fewer
    if broken:
        raise log.fault(
            f"the last line breaks off ('{lines[-1].strip()[-40:]}'): the file is still being written, or "
            "was cut; wait for the test to end and export it again",
            "malformed",
            "table",
            line=index + (log.settings.skip or 0) + 1,
        )


def _decimals(cell: str) -> int:
    return len(cell.replace(",", ".").rpartition(".")[2])
