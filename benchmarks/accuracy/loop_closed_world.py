"""The loop on presses that ``predict`` wrote: ``python -m benchmarks.accuracy.loop_closed_world --count 100``.

Nothing is undeclared: a batch is drawn from the intervals of the resin that the campaign names, ``predict`` writes
every press of the plan, noise is added. With ``--elastic`` the resin's pucks have shown an Ogden law, whose exponent is
drawn from its interval. Shared with the loop: force law, relaxation and the resin's intervals, all of
the model; what is tested is that the loop's model is the one that designs. Rows are kept in ``--rows``.
"""

from __future__ import annotations

import argparse
import os
import sys
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.rows import resume, scratch
from dummydesign.api.campaigns import calibrate, plan_campaign
from dummydesign.api.predictions import predict
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.quantity import Quantity
from dummydesign.measurement.campaign_file import SetUp
from dummydesign.measurement.campaign_plan import PlanSettings
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin_file import save_resin

RESIN, RATIOS = "polyurethane-nagoya", (14.8, 16.0)
NOISE_N, SLOW_N, SLOW_S = 0.02, 0.01, 1.0
RATE_HZ, REST = 1000.0, 200
EXPONENTS = {1.6: 0.08, 2.8: 0.4, 3.5: 0.4}
"""Exponents of elastic laws that pucks have shown, and half their 95 % intervals."""
KINDS = {
    "slabs": ("slab", (5.0, 15.0, 20.0)),
    "crown": ("crowned:3.6,4.6,9.4", (10.5,)),
    "crowns": ("crowned:radius=4,height=3,foot=9", (7.0, 10.0, 14.0)),
}


@dataclass(frozen=True)
class Row:
    """One campaign: truth, verdict, names, and the modulus with its interval."""

    seed: int
    number: int
    kind: str
    young_kPa: float
    found_kPa: float
    low_kPa: float
    high_kPa: float
    verdict: str
    held: bool
    names: list[str]
    warnings: list[str]
    rmse_N: float


def slow_noise(time_s: NDArray, rng: np.random.Generator) -> NDArray:
    """A wandering zero: an Ornstein-Uhlenbeck path. [N]"""
    keep = np.exp(-np.diff(time_s, prepend=time_s[0]) / SLOW_S)
    steps = rng.normal(0.0, SLOW_N, len(time_s)) * np.sqrt(1.0 - keep**2)
    path = [float(rng.normal(0.0, SLOW_N))]
    for kept, step in zip(keep[1:], steps[1:]):
        path.append(kept * path[-1] + step)
    return np.array(path)


def stiffening_resin(rng: np.random.Generator) -> tuple[str, str]:
    """Keep a resin of another elastic law; its name, and the law of a batch as ``predict`` takes it."""
    value = float(rng.choice(list(EXPONENTS)))
    half, name = EXPONENTS[value], f"own-{value:g}"
    known = Quantity(value, value - half, value + half, "fitted", "drawn")
    save_resin(replace(load_resin(RESIN), name=name, ogden_alpha=known))
    alpha = value + half * float(np.clip(rng.normal(), -2.0, 2.0)) / 1.96
    return name, f"ogden:{2.0 / alpha:.9g},{alpha:.9g}"


def run(number: int, seed: int, folder: Path, elastic: bool = False) -> Row:
    """Plan, press and correct one campaign."""
    rng = np.random.default_rng([seed, number])
    name, law = stiffening_resin(np.random.default_rng([seed, number, 1])) if elastic else (RESIN, "neo-hookean")
    kind = list(KINDS)[number % len(KINDS)]
    shape, pads = KINDS[kind]
    ratio = float(np.round(rng.uniform(*RATIOS), 1))
    resin = load_resin(RESIN)
    batch = resin.draw(1, rng)
    young, strengths = 1e3 * float(batch.young_MPa(ratio)[0]), batch.beta(ratio)[0]
    prony = ",".join(f"{tau:g}:{beta:.6g}" for tau, beta in zip(resin.tau_s, strengths))
    set_up = SetUp("closed", resin=name, ratio=ratio, shape=shape)
    plan_campaign(folder, set_up, PlanSettings(pads, repeats=2, ages_days=(7.0,), seed=1 + number), power=False)
    lost: list[str] = []
    made: dict[tuple, NDArray | None] = {}
    for trial in tomllib.loads((folder / "campaign.toml").read_text())["trial"]:
        key = trial["thickness_mm"], trial["velocity_mm_s"], trial["target_force_N"]
        if key not in made:
            try:
                predict(
                    key[0],
                    young_kPa=young,
                    prony=prony,
                    law=law,
                    shape=trial.get("shape", shape),
                    force_N=key[2],
                    velocity_mm_s=key[1],
                    hold_s=trial["hold_s"],
                    rate_Hz=RATE_HZ,
                    out=folder / "press.csv",
                )
                made[key] = np.genfromtxt(folder / "press.csv", delimiter=",", names=True)
            except NoAnswerError as problem:  # a press that this batch is too soft for
                print(problem, file=sys.stderr)
                made[key] = None
        if (press := made[key]) is None:
            lost.append(trial["file"])
            continue
        rest = np.zeros(REST)
        time = np.concatenate([np.arange(-REST, 0) / RATE_HZ, press["time_s"]])
        depth, force = (np.concatenate([rest, press[name]]) for name in ("displacement_mm", "force_N"))
        force += slow_noise(time, rng) + rng.normal(0.0, NOISE_N, len(time))
        table = np.column_stack([time - time[0], depth, force])
        head = "time_s,displacement_mm,force_N"
        np.savetxt(folder / trial["file"], table, "%.6f", ",", header=head, comments="")
    head, *trials = (folder / "campaign.toml").read_text().split("[[trial]]")
    kept = [text for text in trials if not any(name in text for name in lost)]
    (folder / "campaign.toml").write_text("[[trial]]".join([head, *kept]))
    answer = calibrate(folder).to_dict()
    after, names = answer["after"]["parameters"]["young_kPa"], [one["name"] for one in answer["effects"]]
    held = bool((answer.get("as_designed") or {}).get("held"))
    return Row(
        seed,
        number,
        kind,
        young,
        after["value"],
        after["low"],
        after["high"],
        answer["verdict"],
        held,
        names,
        [one["code"] for one in answer["warnings"]],
        answer["after"]["error"]["heldout_rmse_N"],
    )


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=5900)
    parser.add_argument("--rows", type=Path, default=Path("loop_closed_world.jsonl"))
    parser.add_argument("--elastic", action="store_true")
    options = parser.parse_args()

    def one(number: int, seed: int) -> Row:
        with scratch("closed-") as folder:
            os.environ["DUMMYDESIGN_HOME"] = str(folder / "home")
            return run(number, seed, folder / "campaign", options.elastic)

    rows = resume(options.rows, options.seed, options.count, Row, one)
    inside = sum(row.low_kPa <= row.young_kPa <= row.high_kPa for row in rows)
    print(f"none: {sum(row.verdict == 'none' for row in rows)} of {len(rows)}, modulus inside: {inside}")


if __name__ == "__main__":
    main()
