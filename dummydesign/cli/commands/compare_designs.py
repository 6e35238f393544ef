"""`dummydesign compare-designs`: several answers of `suggest` side by side."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Sequence
from typing import Any

from dummydesign.cli.common_options import add_replace_option, call
from dummydesign.cli.text import WIDTH, fitted, labelled, warning_lines

COLUMNS, LABEL = 5, 15


def render(result: dict[str, Any]) -> str:
    """Lay at most five designs out on one screen."""
    from dummydesign.report import compare_designs as report

    shown = result["designs"][:COLUMNS]
    head = [*_different(result, 3), *_rows(_header(shown), shown), *_rows(report.design_rows(shown), shown)]
    presses = ["peak N, subjects' range", *_rows(report.press_rows(shown), shown)]
    left = len(result["designs"]) - len(shown)
    tail = [f"report: {result['files']['report']}"] if "report" in result["files"] else []
    tail += [f"{left} more designs are in the report and in --details"] if left else []
    return "\n".join(fitted(head, presses, [tail], (), "... and {} more lines: --details"))


def render_details(result: dict[str, Any]) -> str:
    """Lay all designs out, five beside each other."""
    from dummydesign.report import compare_designs as report

    lines = _different(result, None)
    for start in range(0, len(result["designs"]), COLUMNS):
        shown = result["designs"][start : start + COLUMNS]
        lines += [
            *_rows(_header(shown), shown),
            *_rows(report.design_rows(shown), shown),
            "peak N, subjects' range",
            *_rows(report.press_rows(shown), shown),
            "",
        ]
    for one in result["designs"]:
        lines += labelled("", f"{one['name']}: {one['verdict']['text']}")
    return "\n".join([*lines, *warning_lines(result), *(f"{role}: {path}" for role, path in result["files"].items())])


def _different(result: dict[str, Any], most: int | None) -> list[str]:
    """What the questions differ in, before any number."""
    from dummydesign.report import compare_designs as report

    rows = report.difference_rows(result["differences"])
    if not rows:
        return []
    text = "; ".join(f"{name}: {' | '.join(values)}" for name, *values in rows)
    return [*labelled("DIFFER", f"these designs answer different questions. {text}", most), ""]


def _header(designs: Sequence[dict[str, Any]]) -> list[tuple[str, list[str]]]:
    return [("", [one["name"] for one in designs])]


def _rows(rows: list[tuple[str, list[str]]], designs: Sequence[dict[str, Any]]) -> list[str]:
    """Rows with their cells wrapped under themselves."""
    width = (WIDTH - LABEL) // len(designs)
    lines = []
    for label, cells in rows:
        parts = [textwrap.wrap(cell, width - 1) or [""] for cell in cells]
        for number in range(max(map(len, parts))):
            row = "".join(f"{part[number] if number < len(part) else '':<{width}}" for part in parts)
            lines.append(f"{label if not number else '':<{LABEL}}{row}".rstrip())
    return lines


HELP = "Compare the designs of several 'suggest' folders: verdict, score, presses, weights."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("folders", nargs="+", metavar="DIR", help="folders of 'dummydesign suggest', two or more")
    parser.add_argument("--out", metavar="DIR", help="folder of the report (default compare-designs)")
    add_replace_option(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read the designs and write the report."""
    from dummydesign.api.designs import compare_designs

    return call(compare_designs, options).to_dict()


def default_out(options: argparse.Namespace) -> str:
    """Name of the folder when none is typed."""
    return "compare-designs"
