"""Forms of text that are brought to a plain table: LabVIEW's .lvm, serial monitors, specimens side by side."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

from dummydesign.measurement.importing.cells import SEPARATORS, split, without_empty_end
from dummydesign.measurement.importing.decisions import ImportLog
from dummydesign.measurement.importing.vocabulary import KIND_OF_ROLE, ROLES, roles_of_name, split_name, words_of

_CLOCK = r"((?:\d{4}-\d{2}-\d{2}[T ])?\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)"
_ARRIVAL = re.compile(rf"\s*(?:\[{_CLOCK}\]\s*(?:[-=]?>|→|:)?|{_CLOCK}\s*(?:[-=]?>|→))\s*(.*)")
"""The time of arrival that serial monitors write before a line: ``14:03:20.250 -> ``, ``[2024-05-03 14:03:20] ``."""
_LABELLED = re.compile(
    r"(?:^|(?<=[,;\s]))([^\W\d][\w.]*(?: ?[(\[][^\])]+[)\]])?)\s*[:=]\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)(?=[,;\s]|$)[,;]?"
)
_LABVIEW = "LabVIEW Measurement"
_HEAD = 60
"""Lines at the start among which a header is looked for."""


def plain_lines(lines: list[str], log: ImportLog) -> list[str]:
    """Return the lines of a plain table, as many as there are, so that errors name the lines of the file."""
    if lines and lines[0].startswith(_LABVIEW):
        return _labview(lines, log)
    lines = _without_labels(lines, log)
    if not any(map(_ARRIVAL.fullmatch, lines[:_HEAD])):
        return lines
    matches = [_ARRIVAL.fullmatch(line) for line in lines]
    if sum(match is not None for match in matches) <= 0.5 * sum(bool(line.strip()) for line in lines):
        return lines
    log.decide("form", "serial monitor", "the time of its arrival stands before each line")
    rest = "\n".join(match[3] for match in matches[:_HEAD] if match)
    separator = next((sign for sign in SEPARATORS if sign in rest), ",")
    return [
        line if match is None else f"{match[1] or match[2]}{separator}{match[3]}" for line, match in zip(lines, matches)
    ]


def _without_labels(lines: list[str], log: ImportLog) -> list[str]:
    """Lines of labelled values, ``Position:1.25,Force:0.3``, as a table whose first line is added: the labels."""
    read = [_labelled(line) for line in lines[:_HEAD]]
    labels, count = (Counter(map(tuple, read)).most_common(1) or [((), 0)])[0]
    if len(labels) < 2 or count < 0.5 * len(read):
        return lines
    log.decide("form", "labelled values", f"each line holds {', '.join(labels)} with their values")
    plain = ["\t".join(labels)]
    for line in lines:
        own = _labelled(line)
        plain.append("\t".join(own.values()) if tuple(own) == labels else line)
    return plain


def _labelled(line: str) -> dict[str, str]:
    """Values by their label, of a line that consists of nothing else."""
    if not (":" in line or "=" in line) or _LABELLED.sub("", line).strip(" ,;\t"):
        return {}
    return {part[1]: part[2] for part in _LABELLED.finditer(line)}


def _labview(lines: Sequence[str], log: ImportLog) -> list[str]:
    """Lines of a LabVIEW measurement: names with their units, and rows with their time.

    Its ``X_Columns`` are No (the time follows from X0 and Delta_X), One, or Multi (each channel has its own).
    National Instruments, "Specification for the LabVIEW Measurement File (.lvm)".
    """
    plain, facts, names, row = [""] * len(lines), dict[str, list[str]](), list[str](), 0
    separator, in_header = "," if lines[0].startswith(f"{_LABVIEW},") else "\t", True
    for at, line in enumerate(lines):
        cells = [cell.strip() for cell in line.split(separator)]
        if in_header and names and line.startswith(("X_Value", "Comment")):
            in_header, row = False, 0
        elif in_header and line.startswith("X_Value"):
            names = [name for name in cells if name and name != "Comment"]
            plain[at] = separator.join(_channels(names, facts))
            in_header = False
        elif in_header:
            facts[cells[0]] = cells
        elif not any(cells):
            in_header = True
        else:
            cells = cells[: len(names)]
            if facts.get("X_Columns", ["", ""])[1] == "No":
                begin, step = (float(facts.get(key, ["", "0"])[1].replace(",", ".")) for key in ("X0", "Delta_X"))
                cells[0] = f"{begin + row * step:.9f}".replace(".", facts.get("Decimal_Separator", ["", "."])[1] or ".")
            plain[at] = separator.join(cells)
            row += 1
    columns = facts.get("X_Columns", ["", "One"])[1]
    log.decide("form", "LabVIEW measurement", f"its first line; columns of time: {columns}")
    return plain


def _channels(names: Sequence[str], facts: dict[str, list[str]]) -> list[str]:
    """Names of the columns with the units of the header."""
    units, timed = facts.get("Y_Unit_Label", []), facts.get("X_Dimension", ["", "Time"])[1:2] == ["Time"]
    several = sum(name == "X_Value" for name in names) > 1
    titles = []
    for at, name in enumerate(names):
        if name == "X_Value" and timed:
            titles.append(f"Time {names[at + 1]} [s]" if several and at + 1 < len(names) else "Time [s]")
        else:
            titles.append(f"{name} [{units[at]}]" if at < len(units) and units[at] else name)
    return titles


def specimens(text: str, log: ImportLog) -> dict[str, str]:
    """Part a table in which several specimens stand side by side into one text a specimen, by its title.

    Names of columns that repeat in the same order show it, where one set of them speaks for time, displacement and
    force. Any other text is returned whole, under an empty title.
    """
    if any(name.strip().isdigit() for name in log.settings.columns.values()):
        return {"": text}  # numbers of columns count those of the file
    first = log.settings.skip or 0
    lines = text[: _HEAD * 1000].splitlines()[first : first + _HEAD]
    heads = ((at, sign) for at in range(len(lines)) for sign in SEPARATORS if sign != " ")
    for at, separator in heads:
        width = _period(split(lines[at], separator)) if lines[at].count(separator) >= 2 * len(ROLES) - 1 else 0
        if width:
            break
    else:
        return {"": text}
    at += first
    rows = [split(line, separator) for line in text.replace("\r\n", "\n").replace("\r", "\n").split("\n")]
    starts = [start for start in range(0, len(rows[at]), width) if any(rows[at][start : start + width])]
    above = next((row for row in reversed(rows[first:at]) if any(row)), [])
    titles = [above[start] if start < len(above) else "" for start in starts]
    if not all(titles) or len(set(titles)) < len(titles):
        titles = [f"specimen {number}" for number in range(1, len(starts) + 1)]
    why = f"the names of the columns in line {at + 1} repeat: each set is a test of its own"
    log.decide("specimens", ", ".join(titles), why)

    def line(row: Sequence[str]) -> str:
        return separator.join(f'"{cell}"' if separator in cell else cell for cell in row) if any(row) else ""

    return {title: "\n".join(line(row[start : start + width]) for row in rows) for title, start in zip(titles, starts)}


def _period(names: list[str]) -> int:
    """How many columns belong to one specimen; 0 where the names do not repeat."""
    read = [split_name(name) for name in without_empty_end(names)]
    keys = [(tuple(words_of(name)), unit.text if unit else "") for name, unit in read]
    for width in range(len(ROLES), (len(keys) + 1) // 2 + 1):
        rest = len(keys) % width
        if rest in (0, width - 1) and all(key == keys[at % width] for at, key in enumerate(keys)):
            kinds = {unit.kind for _, unit in read[:width] if unit}
            roles = frozenset[str]().union(*(roles_of_name(name) for name, _ in read[:width]))
            if all(role in roles or KIND_OF_ROLE[role] in kinds for role in ROLES):
                return width
    return 0
