"""Parting a line into cells."""

from __future__ import annotations

import csv

SEPARATORS = {"\t": "tab", ";": "semicolon", "|": "bar", ",": "comma", " ": "spaces"}
COMMENTS = ("#", "%", "//")


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
