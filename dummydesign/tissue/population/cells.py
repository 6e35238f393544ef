"""Tables of subjects as CSV: header and rows with their lines, or one line that says what is wrong with the file."""

from __future__ import annotations

import csv
from pathlib import Path

from dummydesign.core.errors import InputError


def read_cells(
    path: Path, what: str, skip_space: bool = False
) -> tuple[list[str], list[tuple[int, dict[str, str]]]]:
    """Read the header and the rows that hold something.

    Parameters
    ----------
    path : Path
        The CSV file, in UTF-8.
    what : str
        What it holds, for the message.
    skip_space : bool
        Whether blanks after a comma belong to no cell.

    Returns
    -------
    header : list of str
    rows : list of (int, dict)
        Line of the file, and cells by column.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    try:
        with open(path, encoding="utf-8-sig", newline="") as stream:
            reader = csv.DictReader(stream, skipinitialspace=skip_space)
            header = [cell.strip() for cell in reader.fieldnames or []]
            reader.fieldnames = header
            rows = [(reader.line_num, row) for row in reader if any((v or "").strip() for v in row.values() if v)]
    except OSError as problem:
        raise InputError(f"{what} file '{path}' cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path.name}: is not UTF-8 text") from None
    return header, rows
