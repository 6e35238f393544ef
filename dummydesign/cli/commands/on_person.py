"""``dummydesign on-person``: what the same robot press would have been on people."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_replace_option, call_in_steps
from dummydesign.cli.text import INDENT, WIDTH, fitted, labelled

HELP = "Work out what a press measured on a pad would have been on people, against your limits."
ABOUT_STEPS = 6
MOST_WARNINGS = 4


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("traces", nargs="+", metavar="TRACE.csv", help="time_s,displacement_mm,force_N, one press each")
    parser.add_argument("--tissue", required=True, metavar="NAME|FILE", help="see 'dummydesign tissues list'")
    drives = "what moves the robot: position (default), steady, force, mass:KG, spring:N_PER_MM,KG[,DAMPING_RATIO]"
    parser.add_argument("--drive", default="position", metavar="NAME", help=drives)
    limits = "your limits of force and pressure with their source, as 'suggest --limits' takes them"
    parser.add_argument("--limits", metavar="FILE.toml", help=limits)
    parser.add_argument("--lowpass", metavar="HZ[:ORDER[:PASSES]]", help="filter the force went through; it is undone")
    parser.add_argument("--rate", default=1000.0, metavar="HZ", help="of the curves in the CSV (default 1000)")
    faces = "face of the punch, for mean pressures (default square:14)"
    parser.add_argument("--punch", default="square:14", metavar="KIND:SIZE", help=faces)
    parser.add_argument("--out", metavar="DIR", help="folder of the files (default on-person-TISSUE)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read the traces, press people, write curves and report."""
    from dummydesign.api.traces import on_person

    return call_in_steps(ABOUT_STEPS, on_person, options).to_dict()


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    from pathlib import Path

    return f"on-person-{Path(options.tissue).stem}"


def render(result: dict[str, Any]) -> str:
    """Lay the answer out on one screen."""
    head = [*_headline(result), ""]
    tail = [["", *_limits(result, 4)], _drive(result), _warnings(result, MOST_WARNINGS), _files(result),
            labelled("MORE", "--details: each subject, all limits, all notes")]  # fmt: skip
    return "\n".join(fitted(head, _table(result), tail, (), "... and {} more lines: --details"))


def render_details(result: dict[str, Any]) -> str:
    """Lay everything out."""
    from dummydesign.report import on_person as facts

    lines = [*_headline(result), "", *_table(result), ""]
    for press in result["presses"]:
        lines += [f"{press['file']}: subjects"]
        for one in press["subjects"]:
            cells = ", ".join(f"{words} {facts.number_text(one[key])}" for key, words in facts.FOUR)
            lines.append(f"  {one['name']:<16} {cells}")
    lines += ["", *_limits(result, None), *_drive(result), *_warnings(result, None)]
    return "\n".join([*lines, *(f"{role}: {path}" for role, path in result["files"].items())])


def _headline(result: dict[str, Any]) -> list[str]:
    """What it comes to: limits where there are any, else the peak of people over the pad's."""
    from dummydesign.report.on_person import headline

    word, text = headline(result)
    return _first(word.upper(), text)


def _first(word: str, text: str) -> list[str]:
    """A word and its text; UNDECIDED is longer than the column of labels."""
    return labelled(word if len(word) < INDENT else "", text if len(word) < INDENT else f"{word}: {text}")


def _table(result: dict[str, Any]) -> list[str]:
    """All five numbers of a single press; of several presses a line each."""
    from dummydesign.report.on_person import press_table

    head, rows = press_table(result)
    first, widths = (22, (8, 18, 18)) if len(result["presses"]) == 1 else (20, (5, 10, 14, 14, 14, 14))
    cells = (" ".join(f"{cell:>{wide}}" for cell, wide in zip(row[1:], widths)) for row in (head, *rows))
    return [f"  {row[0][-first:]:<{first}} {line}"[:WIDTH] for row, line in zip((head, *rows), cells)]


def _limits(result: dict[str, Any], most: int | None) -> list[str]:
    """Checks of the limits; on one screen the worst of them."""
    from dummydesign.report.on_person import limit_rows, number_text, span_text

    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]
    return [
        f"{row['result']:<10}{row['name']:<27} limit {row['limit']:<7.4g} pad {number_text(row['pad']):<7} "
        f"people {span_text([row['person_low_95'], row['person_high_95']])} {row['unit']} ({file})"[:WIDTH]
        for row, file in (rows if most is None else limit_rows(result)[:most])
    ]


def _drive(result: dict[str, Any]) -> list[str]:
    from dummydesign.person.drives import read_drive

    return labelled("DRIVE", f"{result['drive']}: {read_drive(result['drive']).words}")


def _warnings(result: dict[str, Any], most: int | None) -> list[str]:
    """Warnings; on one screen the first ones, two lines each."""
    lines: list[str] = []
    shown = result["warnings"] if most is None else result["warnings"][:most]
    for one in shown:
        lines += labelled("NOTE", one["message"], None if most is None else 2)
    return lines


def _files(result: dict[str, Any]) -> list[str]:
    names = [result["files"][role] for role in ("report", "first_page", "curves") if role in result["files"]]
    return labelled("FILES", ", ".join(names), 2) if names else []
