"""Crowned pads against slabs in the loop: ``python -m benchmarks.accuracy.loop_crowned``. Simulated campaigns only.

The same effects, seeds and sizes are put into campaigns of crowned pads and of slabs, by
tests/support/campaign_generator.py, which shares no code with the effect classes and solves its crowned pads on finer
cells than the loop. Slip of the base, compressibility and tilt are not made for crowned pads and are left out of both.
Further kinds of pads are crowned ones under a punch with a fillet of 0.4 mm that the campaign declares, or does not.
Every run is kept in ``--rows`` (one JSON object a line), so that it can be stopped and resumed; the counts are printed.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.accuracy.loop_campaigns import FLOORS, LEAST, MOST, Put, learned
from benchmarks.rows import keep_row, read_rows, scratch
from tests.support import campaign_generator as generator

ROOT = Path(__file__).resolve().parents[2]

LEFT_OUT = ("base_slip", "compressibility", "punch_tilt")
ONE = tuple(name for name in generator.SIZES if name not in LEFT_OUT)
ROUND = ("one", "one", "none", "two")


def draw(number: int, seed: int) -> Put:
    """Names and sizes of what is put into a campaign: single effects in turn, none, and pairs."""
    kind = ROUND[number % len(ROUND)]
    if kind == "none":
        return []
    if kind == "one":
        name = ONE[(number // len(ROUND) * 2 + number % len(ROUND)) % len(ONE)]
        return [(name, generator.SIZES[name])]
    rng = np.random.default_rng([seed, 77])
    names = rng.choice([name for name in sorted(FLOORS) if name not in LEFT_OUT], 2, replace=False)
    return [(str(n), generator.SIZES[n] * float(rng.uniform(LEAST, MOST)) / FLOORS[n]) for n in names]


KINDS: dict[str, dict[str, Any]] = {
    "crowned": {"crowned": True},
    "slabs": {},
    "fillet": {"crowned": True, "edge_mm": 0.4},
    "undeclared": {"crowned": True, "edge_mm": 0.4, "declared": False},
}
"""Pads of a campaign and the punch's fillet, as ``learned`` takes them."""


def run_one(number: int, seed: int, pads: str, folder: Path) -> dict:
    """Make a campaign and one on new pads, run the loop, predict the second."""
    return {"seed": seed, "number": number, "pads": pads, **learned(draw(number, seed), seed, folder, **KINDS[pads])}


def counts(rows: list[dict]) -> str:
    """How often the names are right, as text: the kinds of pads side by side."""
    kinds = [pads for pads in KINDS if any(row["pads"] == pads for row in rows)]
    lines = [f"{'':<34}" + "".join(f" {pads:>10}" for pads in kinds)]
    for size, label in ((0, "none"), (1, "one"), (2, "two")):
        texts = {}
        for pads in kinds:
            own = [row for row in rows if row["pads"] == pads and len(row["effects"]) == size]
            named = sum(set(row["effects"]) <= set(row["found"]) for row in own)
            wrong = sum(bool(set(row["found"]) - set(row["effects"])) for row in own)
            quiet = sum(row["verdict"] != "unexplained" for row in own)
            texts[pads] = [f"{count} of {len(own)}" for count in (named, wrong, quiet)]
        for column, what in enumerate(("all named", "a name that is not in it", "verdict not unexplained")):
            lines.append(f"{label + ': ' + what:<34}" + "".join(f" {texts[pads][column]:>10}" for pads in kinds))
    return "\n".join(lines)


def main() -> None:
    """Run what is missing and print the counts."""
    parser = argparse.ArgumentParser(description="Crowned pads against slabs in the loop.")
    parser.add_argument("--seed", type=int, default=979400, help="seeds count up from here")
    parser.add_argument("--campaigns", type=int, default=40, help="of each kind of pad")
    parser.add_argument("--pads", choices=(*KINDS, "both", "all"), default="both")
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "results" / "loop_crowned_979400.jsonl")
    options = parser.parse_args()
    kinds = {"both": ("crowned", "slabs"), "all": tuple(KINDS)}.get(options.pads, (options.pads,))

    known = {(row["seed"], row["pads"]) for row in read_rows(options.rows)}
    for number in range(options.campaigns):
        for pads in kinds:
            seed = options.seed + number
            if (seed, pads) in known:
                continue
            with scratch("crowned-") as folder:
                row = run_one(number, seed, pads, folder)
            keep_row(options.rows, row)
            print(seed, row["pads"], row["effects"], row["verdict"], row["found"], row["cpu_seconds"], file=sys.stderr)
    print(counts(read_rows(options.rows)))


if __name__ == "__main__":
    main()
