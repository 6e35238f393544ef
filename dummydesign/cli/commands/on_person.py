"""``dummydesign on-person``: what the same robot press would have been on people."""

from __future__ import annotations

import re
from typing import Any

from dummydesign.cli.common_options import named_by
from dummydesign.cli.text import INDENT, WIDTH, files_block, fitted, labelled, step_lines, tissue_lines, warning_block
from dummydesign.core.tables import Table

HELP = "Compute what a press measured on a pad would have been on people; compare it with your limits."
default_out = named_by("on-person", "tissue")
CALL = "traces.on_person"
ABOUT_STEPS = 6
NUMBER_UNIT = re.compile(r"(?<=\d) (?=(?:%|N|mm|mJ|kg|s|mm/s|N/mm|N/cm2|times)(?:[\s.,;:)]|$))")


def render(result: dict[str, Any]) -> str:
    """Lay the answer out on one screen."""
    from dummydesign.report import on_person as facts

    limits = ["", *_limits(result, 4)] if facts.limit_rows(result) else []
    notes, checks = len(result["warnings"]), "all limits, " if limits else ""
    tail = [
        limits,
        ["", *_drive(result)],
        warning_block(result, facts.IN_HEADLINE, 2),
        step_lines(facts.next_steps(result)),
        files_block(result, ("report", "first_page", "curves")),
        labelled("MORE", f"--details: each subject, {checks}{notes} note{'s' * (notes != 1)}"),
    ]
    head, left_out = [*_headline(result), "", *tissue_lines(result)], "  ... and {} more presses: --details"
    return "\n".join(fitted(head, _table(result), tail, (1,), left_out))


def render_details(result: dict[str, Any]) -> str:
    """Lay everything out."""
    from dummydesign.report import on_person as facts
    from dummydesign.report.sections import budget_lines

    lines = [*_headline(result), "", *_table(result), ""]
    for press in result["presses"]:
        table = facts.subject_table(press)
        forms = ["<20", *(f">{max(len(name) + 2, 10)}" for name in table.head[1:])]
        lines += [f"  {press['file']}", *table.lines(forms, ""), ""]
    checks = _limits(result, None)
    lines += [*checks, *([""] if checks else []), *budget_lines(result["budget"]), *_drive(result)]
    lines += [line for one in result["warnings"] for line in labelled("NOTE", one["message"])]
    lines += step_lines(facts.next_steps(result))
    return "\n".join([*lines, *(f"{role}: {path}" for role, path in result["files"].items())])


def _headline(result: dict[str, Any]) -> list[str]:
    """A drive that does not fit; then limits where there are any, else the peak of people over the pad's."""
    from dummydesign.report.on_person import headline, mismatch

    word, text = headline(result)
    return [*_whole("CAUTION", mismatch(result)), *_whole(word.upper(), text)]


def _whole(word: str, text: str) -> list[str]:
    """A word and its text, numbers together with their units; UNDECIDED is longer than the column of labels."""
    text = NUMBER_UNIT.sub("\u00a0", text)
    lines = labelled(word, text) if len(word) < INDENT else labelled("", f"{word}: {text}")
    return [line.replace("\u00a0", " ") for line in (lines[0].lstrip(), *lines[1:])] if lines else []


def _table(result: dict[str, Any]) -> list[str]:
    """All five numbers of a single press; of several presses a line each."""
    from dummydesign.report.on_person import press_table

    table = press_table(result)
    forms = ("<22 >8 >18 >18" if len(result["presses"]) == 1 else "<20 >5 >10 >14 >14 >14 >14").split()
    rows = [[row[0][-int(forms[0][1:]) :], *row[1:]] for row in table.rows]
    return [line[:WIDTH] for line in Table(table.head, rows).lines(forms)]


def _limits(result: dict[str, Any], most: int | None) -> list[str]:
    """Checks of the limits; on one screen the worst of them."""
    from dummydesign.report.on_person import limit_name, limit_rows, number_text, span_text

    every = limit_rows(result)
    rows = every if most is None else every[:most]
    if not rows:
        return []
    several = len(result["presses"]) > 1
    cells = [
        [
            limit_name(row),
            f"{row['limit']:.4g} {row['unit']}",
            number_text(row["pad"]),
            span_text([row["person_low_95"], row["person_high_95"]]),
            f"  {row['result']}",
            *([file[-16:]] if several else []),
        ]
        for row, file in rows
    ]
    head = ["limit of", "limit", "pad", "95 % of people", "  result", *(["press"] if several else [])]
    left = [f"  ... and {len(every) - len(rows)} more checks: --details"] if len(every) > len(rows) else []
    return [*Table(head, cells).lines("<27 >13 >9 >18 <12 <1".split(), ""), *left]


def _drive(result: dict[str, Any]) -> list[str]:
    from dummydesign.person.drives import read_drive
    from dummydesign.report.on_person import people_text

    drive = labelled("DRIVE", f"{result['drive']}: {read_drive(result['drive']).words}")
    return [*drive, *labelled("PEOPLE", people_text(result))]
