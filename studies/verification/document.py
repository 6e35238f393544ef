"""Run of all checks, and the text of VERIFICATION.md."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from studies.verification.check import Check
from studies.verification.slabs_and_pucks import ALL

ROOT = Path(__file__).parents[2]
ROWS = ROOT / "benchmarks" / "results" / "mutation.jsonl"


def run(fast: bool, say: Callable[[str], None] | None = None) -> list[Check]:
    """Run the checks; ``fast`` leaves out those that take more than about a second."""
    checks: list[Check] = []
    for is_fast, make in ALL:
        if fast and not is_fast:
            continue
        began = time.perf_counter()
        rows: Iterable[Check] = make()
        checks += list(rows)
        if say:
            say(f"{make.__name__}: {time.perf_counter() - began:.1f} s")
    return checks


def document(checks: list[Check]) -> str:
    """The text of VERIFICATION.md."""
    failed = sum(not check.passed for check in checks)
    lines = [
        "# Verification of the pad model",
        "",
        "Made by `python -m studies.verification`; do not edit. Lengths in thicknesses, stresses in shear",
        "moduli unless a unit is given. Tolerances are relative unless marked `abs`; `>=` asks for at least what",
        "is expected. Comparisons with FElupe and GetFEM, separate programs, are",
        "`python -m benchmarks.accuracy.pad_felupe` and `python -m benchmarks.accuracy.pad_getfem`;",
        "their figures are in `docs/pad.md`.",
        "",
        f"{len(checks)} checks, {failed} failed.",
    ]
    for group in dict.fromkeys(check.group for check in checks):
        lines += ["", f"## {group}", "", *table_of([check for check in checks if check.group == group])]
    if ROWS.is_file():
        lines += _faults([json.loads(line) for line in ROWS.read_text(encoding="utf-8").splitlines()])
    return "\n".join(lines) + "\n"


def table_of(checks: Iterable[Check]) -> list[str]:
    """Lines of a table of checks."""
    head = ["| check | expected | found | deviation | tolerance | source | |", "|---|---|---|---|---|---|---|"]
    return head + [_row(check) for check in checks]


def _faults(rows: list[dict[str, Any]]) -> list[str]:
    """How many faults the tests see, and those that they do not, with the reason."""
    lines = [
        "",
        "## Faults that the tests see",
        "",
        "`python -m benchmarks.accuracy.mutation` changes one sign, limit or index in lines drawn at random from core,",
        "pad, loop and design, and runs the default tests that execute the line; rows in",
        "`benchmarks/results/mutation.jsonl`.",
        "Faults that were not run count as open. The tests of the second figure were written for this draw: a new draw",
        "is better judged by the first.",
        "",
        "| state | seed | faults | caught | caught with the tests written for those missed | open |",
        "|---|---|---|---|---|---|",
    ]
    for state, seed in dict.fromkeys((row["state"], row["seed"]) for row in rows):
        drawn = [row for row in rows if (row["state"], row["seed"]) == (state, seed)]
        first, since = (sum(bool(row.get(key)) for row in drawn) for key in ("caught", "since"))
        lines.append(f"| {state} | {seed} | {len(drawn)} | {first} | {first + since} | {len(drawn) - first - since} |")
    missed = [row for row in rows if not (row["caught"] or row.get("since"))]
    lines += ["", "| open | change | why |", "|---|---|---|"]
    lines += [f"| {_where(row['file'])} | `{row['before']}` -> `{row['after']}` | {row['note']} |" for row in missed]
    return lines


def _where(file: str) -> str:
    """File of a fault; one that has gone since is named by its module alone."""
    return file if (ROOT / file).is_file() else f"{Path(file).stem}, a module that is gone or has another name"


def _row(check: Check) -> str:
    percent = f"{check.deviation:+.2g}" if check.absolute else f"{100 * check.deviation:+.3f} %"
    tolerance = f"{check.tolerance:g} abs" if check.absolute else f"{100 * check.tolerance:.3g} %"
    sign = ">= " if check.one_sided else ""
    verdict = "pass" if check.passed else "FAIL"
    return (
        f"| {check.name} | {sign}{check.expected:.5g} | {check.computed:.5g} | {percent} | {tolerance} | "
        f"{check.source} | {verdict} |"
    )
