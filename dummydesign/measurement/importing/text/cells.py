"""Parting lines into cells."""

from __future__ import annotations

import csv
from collections.abc import Sequence

SEPARATORS = {"\t": "tab", ";": "semicolon", "|": "bar", ",": "comma", " ": "spaces"}
COMMENTS = ("#", "%", "//")
QUOTED_HEAD = 60
"""Lines at the start in which a quoted cell may go over several lines."""


def split(line: str, separator: str) -> list[str]:
    """Part a line into stripped cells; quotes keep a separator inside a cell."""
    if separator == " ":
        return line.replace('"', " ").split()
    if '"' in line:
        try:
            return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
        except (csv.Error, StopIteration):
            return [cell.strip().strip('"') for cell in line.split(separator)]
    return [cell.strip() for cell in line.split(separator)]


def is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(COMMENTS)


def whole_cells(lines: list[str]) -> list[str]:
    """Bring together the lines of a header whose quoted cells hold line ends; blank lines keep the numbering."""
    head = min(len(lines), QUOTED_HEAD)
    if not any(line.count('"') % 2 for line in lines[:head]):
        return lines
    found, at = list(lines), 0
    while at < head:
        end = at
        while _open(lines[at : end + 1]) and end < min(at + 8, head - 1):
            end += 1
        if end > at and not _open(lines[at : end + 1]):
            found[at : end + 1] = [" ".join(line.strip() for line in lines[at : end + 1]), *[""] * (end - at)]
        at = end + 1
    return found


def _open(lines: Sequence[str]) -> bool:
    """Whether a quote is left open at the end of some lines."""
    return sum(line.count('"') for line in lines) % 2 == 1
