"""Answers as text for the terminal: one screen of labelled lines, the verdict as its first line."""

from __future__ import annotations

import os
import re
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

WIDTH, LINES, INDENT = 100, 30, 8


def labelled(label: str, text: str, most: int | None = None) -> list[str]:
    """A label in capitals and its text, wrapped under itself; nothing without a text."""
    if not text:
        return []
    lines: list[str] = []
    for part in text.split("\n"):
        if _step(part) and part[3:].startswith("dummydesign "):
            lines += _command(part)
            continue
        # the words of a command stay on one line
        part = re.sub(r"\bdummydesign [a-z-]+(?: (?:add|new|check|show|list|record)\b)?", _joined, part)
        wrapped = textwrap.wrap(part, WIDTH - INDENT, break_long_words=False, break_on_hyphens=False)
        lines += (
            [
                wrapped[0],
                *(
                    f"   {line}"
                    for line in textwrap.wrap(" ".join(wrapped[1:]), WIDTH - INDENT - 3, break_on_hyphens=False)
                ),
            ]
            if _step(part)
            else wrapped
        )
    if most is not None and len(lines) > most:
        last = lines[most - 1]
        if len(last) > WIDTH - INDENT - 4:
            last = last[: WIDTH - INDENT - 3].rpartition(" ")[0] or last[: WIDTH - INDENT - 4]
        lines = [*lines[: most - 1], f"{last.rstrip()} ..."]
    return [f"{label if not row else '':<{INDENT}}{line}".replace("\0", " ") for row, line in enumerate(lines)]


def _joined(words: re.Match[str]) -> str:
    """Words that are not to be parted: their blanks as zero characters until lines are made."""
    return words[0].replace(" ", "\0")


def _command(part: str) -> list[str]:
    """A command over several lines that a shell takes as one; a quoted word is never broken."""
    whole = re.sub(r"'[^']*'", _joined, part)
    wrapped = textwrap.wrap(whole, WIDTH - INDENT - 5, break_long_words=False, break_on_hyphens=False)
    wrapped = [line.replace("\0", " ") for line in wrapped]
    ends = [" \\"] * (len(wrapped) - 1) + [""]
    return [("   " if row else "") + line + end for row, (line, end) in enumerate(zip(wrapped, ends))]


def _step(part: str) -> bool:
    """Whether a line begins with the number of a step, under which it is indented."""
    return part[:1].isdigit() and part[1:3] == ". "


def fitted(
    head: Sequence[str], table: Sequence[str], tail: Sequence[Sequence[str]], optional: Sequence[int], more: str
) -> list[str]:
    """Lay head, table and blocks of lines on one screen.

    What has no room is left out: first blocks that are optional, in their order, then rows of the table, which are
    counted in a line.
    """
    blocks, going = list(tail), list(optional)

    def room() -> int:
        return LINES - len(head) - sum(len(block) for block in blocks)

    while going and room() < len(table):
        blocks[going.pop(0)] = []
    rows = list(table)
    kept = max(room() - 1, 2)
    if len(rows) > kept + 1:
        rows = [*rows[:kept], more.format(len(rows) - kept)]
    return [*head, *rows, *(line for block in blocks for line in block)]


def step_lines(steps: Sequence[str], one: int | None = None, several: int | None = None) -> list[str]:
    """What to do now: the steps in their order, or the only one; at most so many lines."""
    if len(steps) == 1:
        return labelled("NEXT", steps[0], one)
    return labelled("NEXT", "\n".join(f"{number}. {step}" for number, step in enumerate(steps, 1)), several)


NO_LAW = "measured_curves"
FIRST = (
    NO_LAW,
    "tissue_punch",
    "force_not_in_band",
    "speed_not_in_band",
    "calibration_resin",
    "contradiction",
    "size_not_weighed",
)
"""Codes of warnings printed right after the verdict: missing measurements, or another resin's campaign."""
CODES = {"green": "32", "amber": "33", "red": "31"}


def verdict_lines(verdict: dict[str, Any] | None) -> list[str]:
    """The verdict and an empty line; nothing where there is none."""
    if verdict is None:
        return []
    light = verdict["light"].upper()
    lines = labelled(light, verdict["text"])
    if sys.stdout.isatty() and not os.environ.get("NO_COLOR"):
        lines[0] = f"\033[1;{CODES[verdict['light']]}m{light}\033[0m{lines[0].removeprefix(light)}"
    return [*lines, ""]


def tissue_lines(result: dict[str, Any]) -> list[str]:
    """What a tissue does not have, or is not known for in this test, before any comparison with it."""
    messages = [item["message"] for item in result["warnings"] if item["code"] in FIRST]
    return [*messages, ""] if messages else []


def warning_lines(result: dict[str, Any]) -> list[str]:
    """Warnings not printed with the verdict."""
    return [f"warning: {item['message']}" for item in result["warnings"] if item["code"] not in FIRST]


MOST_WARNINGS = 4


def warning_block(result: dict[str, Any], leave: Sequence[str] = (), most: int = MOST_WARNINGS) -> list[str]:
    """At most four warnings of two lines each; those of one code are one, with their number."""
    by_code: dict[str, list[str]] = {}
    for item in result["warnings"]:
        if item["code"] not in (*FIRST, *leave):
            by_code.setdefault(item["code"], []).append(item["message"])
    lines = []
    for messages in list(by_code.values())[:most]:
        like = f" (and {len(messages) - 1} more: --details)" if len(messages) > 1 else ""
        lines += labelled("WARNING", shortened(sentence(messages[0]), 170 - len(like)) + like, 2)
    left = len(by_code) - most
    return [*lines, *(labelled("", f"{left} more warnings: --details") if left > 0 else [])]


def sentence(text: str) -> str:
    """The text with a capital, unless it begins with a name."""
    first = text.partition(" ")[0].rstrip(",;:")
    return text[0].upper() + text[1:] if first.isalpha() else text


def shortened(text: str, most: int) -> str:
    """The text, cut at the end of a statement when it is longer, or else at a word."""
    if len(text) <= most:
        return text
    ends = [at for mark in ("; ", ". ", ": ") if (at := text.rfind(mark, 40, most - len(CUT))) > 0]
    return f"{text[: max(ends)]}{CUT}" if ends else textwrap.shorten(text, most, placeholder=" ...")


CUT = " (more: --details)"


def notes_block(notes: Sequence[str]) -> list[str]:
    """The first two notes, two lines each."""
    return [line for note in notes[:2] for line in labelled("NOTE", shortened(note, 170), 2)]


def files_block(result: dict[str, Any], first: Sequence[str] = ("report",)) -> list[str]:
    """The folder and the files to begin with."""
    files = {role: path for role, path in result.get("files", {}).items() if path}
    if not files:
        return []
    shown = [role for role in first if role in files] or list(files)[:1]
    folder = Path(files[shown[0]]).parent
    names = [Path(os.path.relpath(files[role], folder)).as_posix() for role in shown]
    left = [f"{len(files) - len(shown)} more"] if len(files) > len(shown) else []
    return [f"{'FILES':<{INDENT}}{at_home(folder)}/: {', '.join([*names, *left])}"]  # a path is never broken


def at_home(folder: Path) -> str:
    """A folder as it is typed: below the home folder from ~ on."""
    try:
        return f"~/{folder.relative_to(Path.home()).as_posix()}" if folder.is_absolute() else str(folder)
    except (RuntimeError, ValueError):
        return str(folder)


def screen(head: Sequence[str], table: Sequence[str], *tail: Sequence[str], more: str = "") -> str:
    """Head, table and blocks on one screen; of the table the first rows, with the number of the others."""
    words = more or "  ... and {} more rows: --details"
    wide = [line if len(line) <= WIDTH else f"{line[: WIDTH - 4].rstrip()} ..." for line in (*head, *table)]
    return "\n".join(fitted(wide[: len(head)], wide[len(head) :], [list(block) for block in tail], (), words))


def file_lines(result: dict[str, Any]) -> list[str]:
    """What was written."""
    return [f"{role}: {path}" for role, path in result["files"].items()]
