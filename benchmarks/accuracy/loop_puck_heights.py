"""What the loop says of drawn pucks of one height and of two: ``python -m benchmarks.accuracy.loop_puck_heights``.

Each rubber is pressed twice, on two specimens each: pucks of 30 mm, and pucks of 30 and 15 mm. Rows are kept and go on
where they end; :mod:`benchmarks.accuracy.loop_ecoflex` writes the page.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.rows import resume, scratch
from dummydesign.loop.run import close_loop
from tests.support.drawn_pucks import KINDS, draw_rubber, press_pucks

ROOT = Path(__file__).resolve().parents[2]
HEIGHTS = {"one": (30.0,), "two": (30.0, 15.0)}
SEED, CAMPAIGNS = 3300000, 40


@dataclass(frozen=True)
class Row:
    """A rubber, and what the loop says of it by the number of heights."""

    seed: int
    number: int
    kind: str
    rubber: dict
    verdict: dict[str, str]
    named: dict[str, list[str]]
    possible: dict[str, list[str]]
    sets: dict[str, list[list[str]]]
    young_kPa: dict[str, list[float]]
    cpu_s: dict[str, float]


def rows_file(seed: int) -> Path:
    """Where the rows of a seed are kept."""
    return ROOT / "benchmarks" / "results" / f"loop_puck_heights_{seed}.jsonl"


def run_one(number: int, seed: int) -> Row:
    """Draw a rubber and run the loop on its pucks."""
    kind = KINDS[number % len(KINDS)]
    rubber = draw_rubber(kind, np.random.default_rng([seed, number]))
    verdict, named, possible, sets, young, cpu = {}, {}, {}, {}, {}, {}
    for count, heights in HEIGHTS.items():
        with scratch("pucks-") as folder:
            campaign = press_pucks(folder / "pucks", rubber, heights, np.random.default_rng([seed, number, 1]))
            start = time.process_time()
            result = close_loop(campaign)
            cpu[count] = round(time.process_time() - start, 1)
        verdict[count] = result.verdict
        named[count] = [one.candidate.effect.name for one in result.effects]
        possible[count] = [] if result.among is None else list(result.among.names)
        sets[count] = [list(one.names) for one in result.among.found] if result.among else [named[count]]
        modulus = result.after.to_dict()["parameters"]["young_kPa"]
        young[count] = [round(modulus[end], 2) for end in ("value", "low", "high")]
    return Row(seed, number, kind, asdict(rubber), verdict, named, possible, sets, young, cpu)


def main() -> None:
    """Run what is not yet kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--campaigns", type=int, default=CAMPAIGNS)
    options = parser.parse_args()
    resume(rows_file(options.seed), options.seed, options.campaigns, Row, run_one)


if __name__ == "__main__":
    main()
