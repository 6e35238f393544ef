"""``dummydesign on-person``: what the same robot press would have been on people."""

from __future__ import annotations

import argparse
from typing import Any

from dummydesign.cli.common_options import add_replace_option, call_in_steps
from dummydesign.cli.text import INDENT, WIDTH, fitted, labelled

HELP = "Work out what a press measured on a pad would have been on people, against your limits."
ABOUT_STEPS = 6
FOUR = (("peak_N", "peak force N"), ("steady_N", "steady force N"), ("depth_mm", "depth mm"),
        ("energy_mJ", "energy mJ"), ("mean_pressure_N_per_cm2", "mean pressure N/cm2"))  # fmt: skip
MOST_WARNINGS = 4
WORST = ("fail", "undecided", "pass")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("traces", nargs="+", metavar="TRACE.csv", help="time_s,displacement_mm,force_N, one press each")
    parser.add_argument("--tissue", required=True, metavar="NAME|FILE", help="see 'dummydesign tissues list'")
    drives = "position (default), steady, force, mass:KG, spring:N_PER_MM,KG: what moves the robot"
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
    from dummydesign.api.person import on_person

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
    lines = [*_headline(result), "", *_table(result), ""]
    for press in result["presses"]:
        lines += [f"{press['file']}: subjects"]
        for one in press["subjects"]:
            cells = ", ".join(f"{words} {_text(one[key])}" for key, words in FOUR)
            lines.append(f"  {one['name']:<16} {cells}")
    lines += ["", *_limits(result, None), *_drive(result), *_warnings(result, None)]
    return "\n".join([*lines, *(f"{role}: {path}" for role, path in result["files"].items())])


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


def _span(ends: list[float | None]) -> str:
    return "-" if ends[0] is None or ends[1] is None else f"{ends[0]:.3g} to {ends[1]:.3g}"


def _headline(result: dict[str, Any]) -> list[str]:
    """What it comes to: limits where there are any, else the peak of people over the pad's."""
    rows = [(row, press) for press in result["presses"] for row in press["limits"]]
    if rows:
        row, press = min(rows, key=lambda pair: (WORST.index(pair[0]["result"]), -_share(pair[0])))
        high = _text(row["person_high_95"])
        count = sum(one["result"] == row["result"] for one, _ in rows)
        reason = "" if row["result"] == "pass" else f" {row['reason'][0].upper()}{row['reason'][1:]}."
        if any(one["drive_contradicted"] for one in result["presses"]):
            reason += " The drive does not fit the trace."
        text = (
            f"{count} of {len(rows)} checks. Closest: {row['name']}, people up to {high} {row['unit']} (95 %), "
            f"limit {row['limit']:.4g}, pad {_text(row['pad'])}.{reason}"
        )
        return _first(row["result"].upper(), text)
    press = max(result["presses"], key=lambda one: one["factor_peak"][1] or 0.0)
    return _first("RESULT", f"Peak force on the subjects is {_span(press['factor_peak'])} times the pad's; for 95 % of "
                            f"people {_span(press['factor_peak_95'])} times ({press['file']}).")  # fmt: skip


def _first(word: str, text: str) -> list[str]:
    """A word and its text; UNDECIDED is longer than the column of labels."""
    return labelled(word if len(word) < INDENT else "", text if len(word) < INDENT else f"{word}: {text}")


def _share(row: dict[str, Any]) -> float:
    return (row["person_high_95"] or 0.0) / row["limit"]


def _table(result: dict[str, Any]) -> list[str]:
    """All five numbers of a single press; of several presses a line each."""
    presses = result["presses"]
    if len(presses) == 1:
        one = presses[0]
        lines = [f"  {'':<22} {'pad':>8} {'subjects':>18} {'95 % of people':>18}"]
        return lines + [
            f"  {words:<22} {_text(one['pad'][key]):>8} {_span(one['band'][key]):>18} "
            f"{_span(one['interval_95'][key]):>18}"
            for key, words in FOUR
        ]
    lines = [f"  {'press':<20} {'mm/s':>5} {'pad peak N':>10} {'subjects N':>14} {'95 % N':>14} {'times':>14} "
             f"{'depth mm':>14}"]  # fmt: skip
    for one in presses:
        row = (
            f"  {one['file'][-20:]:<20} {one['velocity_mm_s']:>5.4g} {_text(one['pad']['peak_N']):>10} "
            f"{_span(one['band']['peak_N']):>14} {_span(one['interval_95']['peak_N']):>14} "
            f"{_span(one['factor_peak']):>14} {_span(one['band']['depth_mm']):>14}"
        )
        lines.append(row[:WIDTH])
    return lines


def _limits(result: dict[str, Any], most: int | None) -> list[str]:
    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]
    if most is not None:
        rows.sort(key=lambda pair: (WORST.index(pair[0]["result"]), -_share(pair[0])))
        rows = rows[:most]
    return [
        f"{row['result']:<10}{row['name']:<27} limit {row['limit']:<7.4g} pad {_text(row['pad']):<7} "
        f"people {_span([row['person_low_95'], row['person_high_95']])} {row['unit']} ({file})"[:WIDTH]
        for row, file in rows
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
    names = [result["files"][role] for role in ("report", "curves") if role in result["files"]]
    return labelled("FILES", ", ".join(names), 2) if names else []
