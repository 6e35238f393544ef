"""Campaigns pressed with a fillet of 0.5 mm that they do not declare: is it named, and with what size?

``python -m benchmarks.accuracy.loop_punch_edge --seed N --campaigns N --rows FILE``. Force curves by GetFEM in the
campaigns of tests.support.independent_generator: round punch of 15.8 mm, slabs of 6, 10 and 16 mm. Every
second one has another effect.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.accuracy.loop_independent_generator import draw
from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.run import close_loop
from dummydesign.loop.selection.cross_validation import effect_intervals
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import independent_generator as generator

FILLET_MM = 0.5


def run_one(seed: int, other: bool, folder: Path) -> dict:
    """One campaign: what is named, the edge found with its interval, modulus."""
    put = draw("one", int(np.random.default_rng([seed, 77]).integers(0, 40)), seed) if other else ()
    truth = generator.write_campaign(folder, put, seed)
    plan = folder / "campaign.toml"
    plan.write_text(plan.read_text().replace(f"edge_radius_mm = {FILLET_MM}\n", ""))
    campaign, begun = read_campaign(folder), time.process_time()
    result = close_loop(campaign)
    sizes = {one.candidate.effect.name: effect_intervals(result.after, one.candidate.effect) for one in result.effects}
    edge = sizes.get("punch_edge")
    posterior = calibration_of(result).posterior
    return {
        "seed": seed,
        "put": [name for name, _ in put],
        "verdict": result.verdict,
        "named": list(sizes),
        "edge_mm": edge and [edge["edge_radius_mm"][key] for key in ("low", "value", "high")],
        "young_kPa": truth.young_kPa,
        "interval_kPa": posterior and list(posterior.interval("log young_kPa")),
        "learned": None if result.learnt is None else result.learnt.effect.shape.name,
        "ranking": [[one.effect.name, round(one.gain, 1)] for one in result.selection.ranking[:4]],
        "cpu_s": round(time.process_time() - begun, 1),
    }


def main() -> None:
    """Run campaigns and append rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=964000)
    parser.add_argument("--campaigns", type=int, default=12)
    parser.add_argument("--rows", type=Path, default=Path("benchmarks/results/loop_punch_edge_964000.jsonl"))
    options = parser.parse_args()
    for number in range(options.campaigns):
        with tempfile.TemporaryDirectory() as folder:
            row = run_one(options.seed + number, number % 2 == 1, Path(folder) / "a")
        with options.rows.open("a") as out:
            out.write(json.dumps(row) + "\n")
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
