"""Blind study of the loop: ``python -m benchmarks.accuracy.loop_blind``. Simulated campaigns only; some 10 s each.

Campaigns with none, one, two and three effects and with effects that are not in the vocabulary, from
tests/support/campaign_generator.py, which shares no code with the effect classes. Every run is kept in ``--rows`` (one
JSON object a line), so that a study can be stopped and resumed. With ``--visible`` every campaign has one
effect that can be seen, and rates are printed only.
"""

from __future__ import annotations

import argparse
import csv
import sys
from pathlib import Path

from benchmarks.accuracy.loop_blind_table import HEADS, data, table, visible
from benchmarks.accuracy.loop_campaigns import KINDS, VISIBLE, kind_of, run_one
from benchmarks.accuracy.loop_independent_generator_page import section, write_functions
from benchmarks.rows import keep_row, read_rows, scratch, write_evidence

ROOT = Path(__file__).resolve().parents[2]
ROWS = ROOT / "benchmarks" / "results" / "loop_blind_747000.jsonl"


def main() -> None:
    """Run what is missing of the study and write the table."""
    parser = argparse.ArgumentParser(description="Blind study of the loop.")
    parser.add_argument("--seed", type=int, default=747000, help="first seed; below 700000 are for development")
    parser.add_argument("--campaigns", type=int, default=250)
    parser.add_argument("--part", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="each N-th from K")
    parser.add_argument("--rows", type=Path, default=ROWS)
    parser.add_argument("--only", nargs="*", choices=KINDS, help="kinds to run")
    parser.add_argument("--visible", action="store_true", help="one effect of 3 to 8 noise floors in each")
    parser.add_argument("--table-only", action="store_true")
    options = parser.parse_args()
    known = {row["seed"] for row in read_rows(options.rows)}
    start, step = options.part
    for number in range(start, 0 if options.table_only else options.campaigns, step):
        (kind, before), seed = (VISIBLE, number) if options.visible else kind_of(number), options.seed + number
        if seed in known or (options.only and kind not in options.only):
            continue
        with scratch("blind-") as folder:
            row = run_one(kind, before, seed, folder)
        keep_row(options.rows, row)
        print(seed, row["effects"], row["verdict"], row["found"], row["cpu_seconds"], file=sys.stderr, flush=True)
    rows = sorted(read_rows(options.rows), key=lambda row: row["seed"])
    if options.visible:
        print(visible(rows))
        return
    write_evidence("independent", section())
    write_evidence("blind", table(rows))
    folder = ROOT / "docs" / "data"
    write_functions(folder / "loop-functions.csv")
    for name, lines in data(rows).items():
        with (folder / f"{name}.csv").open("w", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([HEADS[name], *lines])


if __name__ == "__main__":
    main()
