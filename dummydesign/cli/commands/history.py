"""``dummydesign history``: past answers of a folder with their verdicts."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from dummydesign.cli.text import labelled, screen
from dummydesign.core.levels import level_name

HELP = "Past answers of this folder with their verdicts, the newest first."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the folder."""
    parser.add_argument("folder", nargs="?", default=".", metavar="DIR", help="default: this folder")


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read the manifests."""
    from dataclasses import asdict

    from dummydesign.project.status import history_of

    rows = [asdict(one) for one in history_of(Path(options.folder))]
    return {"inputs": {"folder": options.folder}, "warnings": [], "sources": [], "answers": rows}


def render(result: dict[str, Any]) -> str:
    """One line an answer."""
    rows = _rows(result)
    return screen([], rows) if rows else _nothing(result)


def render_details(result: dict[str, Any]) -> str:
    """All of them."""
    return "\n".join(_rows(result)) or _nothing(result)


def _nothing(result: dict[str, Any]) -> str:
    folder = result["inputs"]["folder"]
    where = "this folder" if folder == "." else f"folder '{folder}'"
    text = f"No answers in {where}. Name another folder, or make one: dummydesign suggest --tissue forefinger"
    return "\n".join(labelled("NONE", text))


def _rows(result: dict[str, Any]) -> list[str]:
    answers = result["answers"]
    rows = [
        (one["date"][:16].replace("T", " "), one["command"], one["folder"], _words(one["summary"])) for one in answers
    ]
    shown = [("when (UTC)", "command", "folder", "verdict; usable castings; factor of readings; pad"), *rows]
    wide = [max(len(row[column]) for row in shown) for column in range(3)]
    return ["  " + "  ".join([*map(str.ljust, row, wide), row[-1]]) for row in shown] if rows else []


def _words(summary: dict[str, Any] | None) -> str:
    """What an answer came to, in a few words."""
    known = summary or {}
    parts = [level_name(known["verdict"])] if known.get("verdict") else []
    if "usable_fraction" in known:
        parts.append(f"{100 * known['usable_fraction']:.0f} % usable")
    if "correction_factor" in known:
        parts.append(f"x {known['correction_factor']:.2f}")
    parts += [str(known["shape"])] if known.get("shape") else []
    if "thickness_mm" in known and "ratio" in known:
        parts.append(f"{known['thickness_mm']:g} mm, ratio {known['ratio']:g}")
    if "effects" in known:
        parts.append(", ".join(known["effects"]) or "no effect")
    return "; ".join(parts) or "-"
