"""Blind study of the loop with several effects at once: ``python benchmarks/loop_several.py``. Simulated campaigns.

Each campaign holds ``--effects`` effects of the vocabulary, drawn without replacement, each of a size that alone would
leave 3 to 8 noise floors on left-out conditions. Every run is kept in ``--rows`` (one JSON object a line), so that a
study can be stopped and resumed. Generator: tests/support, which shares no code with the effect classes.
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from dummydesign.loop.calibration import calibration_of  # noqa: E402
from dummydesign.loop.replay import replay  # noqa: E402
from dummydesign.loop.result import LoopResult  # noqa: E402
from dummydesign.loop.run import close_loop  # noqa: E402
from dummydesign.measurement.campaign_file import read_campaign  # noqa: E402
from tests.support import campaign_generator as generator  # noqa: E402

FLOORS = {
    "contact_offset": 9.8, "punch_tilt": 4.4, "rate_dependent_viscosity": 2.3, "fast_relaxation_mode": 1.8,
    "strain_dependent_relaxation": 1.2, "softening_with_cycles": 4.4, "incomplete_recovery": 2.2, "temperature": 4.5,
    "ageing": 3.8, "inertia": 3.6, "friction_hysteresis": 1.1, "force_bias": 1.2, "adhesion": 1.0, "sensor_lag": 39.0,
    "time_skew": 31.0,
}  # fmt: skip
"""Noise floors that each effect of its usual size leaves to the base model beyond noise (benchmarks/loop_blind.jsonl,
median of three sizes). Left out are those that the force law's own error takes up: their size would leave the range
in which they are small (compliance, slip, compressibility, thickness, stiffening, slow mode, drift)."""
LEAST, MOST = 3.0, 8.0


def draw(seed: int, count: int) -> list[tuple[str, float]]:
    """Names and sizes of the effects of one campaign."""
    rng = np.random.default_rng([seed, 77])
    names = rng.choice(sorted(FLOORS), count, replace=False)
    return [(str(n), generator.SIZES[n] * float(rng.uniform(LEAST, MOST)) / FLOORS[n]) for n in names]


def row_of(put_in: list[tuple[str, float]], floor_N: float, result: LoopResult, seconds: float) -> dict:
    """What is kept of one campaign."""
    return {
        "effects": [name for name, _ in put_in], "sizes": [size for _, size in put_in], "floor": floor_N,
        "verdict": result.verdict, "found": [f.candidate.effect.name for f in result.effects],
        "confounded": [list(f.confounded_with) for f in result.effects],
        "evidence": [round(f.candidate.gain, 1) for f in result.effects],
        "over_floor": result.remainder.over_floor, "expected": result.remainder.expected,
        "lack": [result.after.lack.ratio, result.after.lack.p], "reasons": list(result.remainder.reasons),
        "cpu_seconds": round(seconds, 1),
    }  # fmt: skip


def run_one(seed: int, count: int, folder: Path) -> dict:
    """Make a campaign and one on new pads, run the loop, predict the second."""
    put_in = draw(seed, count)
    first, more = (put_in[0], tuple(put_in[1:])) if put_in else (("none", 0.0), ())
    truth = generator.write_campaign(folder / "a", *first, seed, more=more)
    generator.write_campaign(folder / "b", *first, seed, held_out=True, more=more)
    campaign, started = read_campaign(folder / "a"), time.process_time()
    result = close_loop(campaign)
    row = row_of(put_in, truth.floor_N, result, time.process_time() - started)
    other = replay(read_campaign(folder / "b"), calibration_of(result))
    return {"seed": seed, **row, "replay": [other.total_base_rmse_N, other.total_rmse_N]}


def table(rows: list[dict]) -> str:
    """Rates and errors, by the number of effects put in."""
    heads = (
        "effects put in", "campaigns", "all named", "all but one named", "a wrong name",
        "not called unexplained, and over 2 noise floors on other pads", "called unexplained",
        "median error on other pads over the floor: base, after", "processor seconds",
    )  # fmt: skip
    lines = ["| " + " | ".join(heads) + " |", "|---" * len(heads) + "|"]
    for count in sorted({len(row["effects"]) for row in rows}):
        own = [row for row in rows if len(row["effects"]) == count]
        right = [len(set(row["effects"]) & set(row["found"])) for row in own]
        wrong = sum(bool(set(row["found"]) - set(row["effects"])) for row in own)
        silent = sum(row["verdict"] != "unexplained" and row["replay"][1] > 2.0 * row["floor"] for row in own)
        base, after = (np.median([row["replay"][k] / row["floor"] for row in own]) for k in (0, 1))
        cells = (
            count, len(own), sum(r == count for r in right), sum(r >= count - 1 for r in right), wrong, silent,
            sum(row["verdict"] == "unexplained" for row in own), f"{base:.1f}, {after:.1f}",
            f"{np.median([row['cpu_seconds'] for row in own]):.0f}",
        )  # fmt: skip
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what is missing of the study and print the table."""
    parser = argparse.ArgumentParser(description="Blind study of the loop with several effects at once.")
    parser.add_argument("--seed", type=int, default=70000, help="seeds count up from here")
    parser.add_argument("--campaigns", type=int, default=60)
    parser.add_argument("--effects", type=int, default=2)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "loop_several.jsonl")
    options = parser.parse_args()
    done = [json.loads(line) for line in options.rows.read_text().splitlines()] if options.rows.exists() else []
    known = {(row["seed"], len(row["effects"])) for row in done}
    for seed in range(options.seed, options.seed + options.campaigns):
        if (seed, options.effects) in known:
            continue
        folder = Path(tempfile.mkdtemp(prefix="several-"))
        try:
            row = run_one(seed, options.effects, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        done.append(row)
        with options.rows.open("a") as stream:
            stream.write(json.dumps(row) + "\n")
        print(seed, row["effects"], row["verdict"], row["found"], row["cpu_seconds"], file=sys.stderr, flush=True)
    print(table(done))


if __name__ == "__main__":
    main()
