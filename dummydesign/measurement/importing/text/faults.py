"""Texts that are no table, or no whole one, and what to do about them."""

from __future__ import annotations

from collections.abc import Sequence

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.absent import absent_roles, absent_words
from dummydesign.measurement.importing.core.units import split_name
from dummydesign.measurement.importing.core.vocabulary import roles_of_name
from dummydesign.measurement.importing.text.cells import SEPARATORS, split
from dummydesign.measurement.importing.text.header import HEADER_LINES
from dummydesign.measurement.importing.text.numbers import is_missing, is_number, is_stamp


def why_no_table(lines: Sequence[str], separator: str) -> str:
    """Say why there is no table."""
    heads = (split(line, sign) for line in lines[:200] for sign in SEPARATORS if sign in line)
    head = next((cells for cells in heads if sum(bool(roles_of_name(split_name(cell)[0])) for cell in cells) >= 2), [])
    absent = absent_roles(head) if head else ()
    if absent:
        return absent_words(absent, head)
    if head:
        return "has a header but no rows of numbers below it; export the test with its data"
    return "holds no table of numbers; export time, displacement and force as columns of text"


def refuse_two_commas(
    file: str, separator: str, cells: Sequence[str], width: int, lines: Sequence[str], first: int
) -> None:
    """Refuse a table in which the comma parts both columns and decimals.

    Parameters
    ----------
    file, separator : str
        Name for messages, and what parts the cells.
    cells : sequence of str
        A sample of the cells.
    width : int
        Cells a row.
    lines : sequence of str
        All lines of the text.
    first : int
        Index of the first line of numbers; the names stand above it.

    Raises
    ------
    InputError
        With the numbers of names and of cells.
    """
    if separator != "," or width % 2 or any("." in cell or "," in cell for cell in cells):
        return
    for line in lines[max(first - HEADER_LINES, 0) : first]:
        head = split(line, ",")
        if len(head) == width // 2 and sum(bool(roles_of_name(split_name(cell)[0])) for cell in head) >= 2:
            raise InputError(
                f"{file}: {len(head)} names but {width} cells a row: the comma parts both columns and decimals, which "
                "cannot be told apart; export with ';' between columns, or with numbers in quotes"
            )


def refuse_unfinished(
    file: str, lines: Sequence[str], last: int, separator: str, kinds: Sequence[str], skipped: int
) -> None:
    """Refuse a file that is still being written: its last line has no end and breaks off within a row.

    Parameters
    ----------
    file, separator : str
        Name for messages, and what parts the cells.
    lines : sequence of str
        All lines of the text.
    last : int
        Index after the last line of numbers.
    kinds : sequence of str
        What each column holds: ``number``, ``stamp``, ``text``, ``empty``.
    skipped : int
        Lines left out at the start of the file, for the line number.

    Raises
    ------
    InputError
        With the line and its end.
    """
    if not lines or not lines[-1].strip():
        return
    index = len(lines) - 1
    cells = split(lines[-1], separator)
    broken = last <= index and all(is_number(cell) or is_stamp(cell) or cell in ("", "-", "+") for cell in cells)
    if last == index + 1:
        final = max((i for i, kind in enumerate(kinds) if kind == "number"), default=0)
        digits = [
            len(row[final].replace(",", ".").rpartition(".")[2])
            for row in (split(line, separator) for line in lines[max(index - 40, 0) : index])
            if len(row) == len(kinds)
        ]
        last_digits = len(cells[final].replace(",", ".").rpartition(".")[2])
        broken = is_missing(cells[final]) or (len(digits) > 5 and len(set(digits)) == 1 and last_digits < digits[0])
    if broken and len(lines) > 1:
        raise InputError(
            f"{file}:{index + skipped + 1}: the last line breaks off ('{lines[-1].strip()[-40:]}'): the file is still "
            "being written, or was cut; wait for the test to end and export it again"
        )
