"""One screen of text: labelled lines that wrap under themselves, at most 30 lines of 100 characters."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

WIDTH, LINES, INDENT = 100, 30, 8


def labelled(label: str, text: str, most: int | None = None) -> list[str]:
    """A label in capitals and its text, wrapped under itself; nothing without a text.

    Parameters
    ----------
    label : str
        At most seven characters.
    text : str
        Lines of their own are parted by a line feed.
    most : int, optional
        Largest number of lines; what is longer ends with dots.
    """
    if not text:
        return []
    lines: list[str] = []
    for part in text.split("\n"):
        if _step(part) and part[3:].startswith("dummydesign "):
            lines += _command(part)
            continue
        found = textwrap.wrap(part, WIDTH - INDENT, break_long_words=False, break_on_hyphens=False)
        lines += [found[0], *(f"   {line}" for line in textwrap.wrap(" ".join(found[1:]), WIDTH - INDENT - 3,
                                                                  break_on_hyphens=False))] if _step(part) else found
    if most is not None and len(lines) > most:
        lines = [*lines[: most - 1], f"{lines[most - 1][: WIDTH - INDENT - 4].rstrip()} ..."]
    return [f"{label if not row else '':<{INDENT}}{line}" for row, line in enumerate(lines)]


def _command(part: str) -> list[str]:
    """A command over several lines that a shell takes as one."""
    found = textwrap.wrap(part, WIDTH - INDENT - 5, break_long_words=False, break_on_hyphens=False)
    ends = [" \\"] * (len(found) - 1) + [""]
    return [("   " if row else "") + line + end for row, (line, end) in enumerate(zip(found, ends))]


def _step(part: str) -> bool:
    """Whether a line begins with the number of a step, under which it is indented."""
    return part[:1].isdigit() and part[1:3] == ". "


def fitted(
    head: Sequence[str], table: Sequence[str], tail: Sequence[Sequence[str]], optional: Sequence[int], more: str
) -> list[str]:
    """Lay head, table and blocks of lines on one screen.

    What has no room is left out: first blocks that are optional, in their order, then rows of the table, which are
    counted in a line.

    Parameters
    ----------
    head, table : sequence of str
        Lines; of the table the first is its heading.
    tail : sequence of sequence of str
        Blocks below the table.
    optional : sequence of int
        Places of blocks that may be left out, the first to go first.
    more : str
        What is said of rows left out, with a place for their number.
    """
    blocks, going = list(tail), list(optional)

    def room() -> int:
        return LINES - len(head) - sum(len(block) for block in blocks)

    while going and room() < len(table):
        blocks[going.pop(0)] = []
    rows = list(table)
    if len(rows) > room():
        kept = max(room() - 1, 2)
        rows = [*rows[:kept], more.format(len(rows) - kept)]
    return [*head, *rows, *(line for block in blocks for line in block)]
