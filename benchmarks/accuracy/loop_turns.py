"""Round after round in the loop: ``python -m benchmarks.accuracy.loop_turns``. Simulated material only.

Each turn presses a campaign, calibrates with the turn before as prior, designs a slab with the calibration, and plans
the next measurement; the next turn presses that plan and the pad that was designed, newly cast. Presses come from
tests/support/campaign_generator.py, which shares no code with the loop. After each turn the calibration predicts the
same campaign on pads that no turn presses. Criteria, set before any seed was drawn: the interval of the modulus is
narrower after each turn, and the error on the other pads smaller after the third turn than after the first.

With ``--pads`` every pad has a thickness and a modulus of its own (``CastPads`` of the generator), and each series is
run twice: with what was read of each pad (thickness, witness of its batch) in the campaigns, and without. Criterion,
set before: the error on newly cast pads is smaller with records than without in every turn's median.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
import tomllib
from pathlib import Path
from typing import Any

import numpy as np

import dummydesign
from benchmarks.rows import keep_row, read_rows, scratch, write_evidence
from dummydesign.core.errors import NoAnswerError
from dummydesign.loop.calibration_file import read_calibration
from dummydesign.loop.run import replay
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator as generator

ROOT = Path(__file__).resolve().parents[2]

RESIN, RATIO = "polyurethane-nagoya", 15.0
CAST = f'resin = "{RESIN}"\nratio = {RATIO}'
PUT_IN = (("none", 0.0), ("temperature", 0.008), ("contact_offset", 0.05), ("strain_stiffening", 0.8))
FIRST_MM, TURNS = (8.0, 14.0), 3
REACH_MM = (5.0, 20.0)
"""Pads that the generator has solved; a planned one outside is pressed at the nearer end."""


def first_rows() -> list[dict]:
    """A small first campaign: two pads, two speeds, two forces, twice."""
    rows = []
    for age, repeat in ((9.0, 1), (14.0, 2)):
        for h in FIRST_MM:
            for v in (10.0, 250.0):
                for target in (3.0, 8.0):
                    rows.append(_row(h, v, target, repeat, len(rows) + 1, 60.0, age))
    return rows


def _row(h: float, v: float, target: float, repeat: int, sequence: int, rest: float, age: float) -> dict:
    return {
        "h": h,
        "v": v,
        "target": target,
        "repeat": repeat,
        "sequence": sequence,
        "rest": rest,
        "age": age,
        "temperature": 20.0 + (7.0 * sequence * 0.618) % 7.0,
        "unload": sequence % 3 == 0,
    }


def planned_rows(plan: Path, designed_mm: float, turn: int) -> list[dict]:
    """The presses of a plan, and six of the pad that was designed."""
    trials = tomllib.loads((plan / "campaign.toml").read_text())["trial"]
    age = 14.0 + 10.0 * turn
    rows = [
        _row(
            round(float(np.clip(t["thickness_mm"], *REACH_MM)), 1),
            t["velocity_mm_s"],
            t["target_force_N"],
            t["repeat"],
            t["sequence"],
            t.get("rest_s", 60.0),
            t.get("age_days", age),
        )
        for t in trials
    ]
    for repeat in (1, 2):
        for target in (3.0, 6.0, 9.0):
            rows.append(_row(designed_mm, 10.0 if repeat == 1 else 250.0, target, 1, len(rows) + 1, 60.0, age))
    return rows


def run_seed(seed: int, folder: Path, pads: generator.CastPads | None = None) -> dict:
    """Three turns of one material."""
    effect, size = PUT_IN[seed % len(PUT_IN)]
    own: dict[str, Any] = {"cast": CAST, "cast_pads": pads}
    truth = generator.write_campaign(folder / "other", effect, size, seed, held_out=True, **own)
    other = read_campaign(folder / "other")
    rows, prior, turns = first_rows(), None, []
    for turn in range(TURNS):
        started = time.process_time()
        here = folder / f"turn-{turn}"
        generator.write_campaign(here, effect, size, seed, rows=rows, **own)
        calibrated = dummydesign.calibrate(here, prior=prior, plan=folder / f"plan-{turn}", out=folder / f"out-{turn}")
        result = calibrated.to_dict()
        prior = folder / f"out-{turn}" / "calibration.json"
        try:
            answer = dummydesign.suggest(
                "forefinger",
                shape="slab",
                calibration=prior,
                ratio=(RATIO, RATIO),
                thickness_mm=(5.0, 20.0),
                verify=False,
            ).to_dict()
        except NoAnswerError as reason:
            answer = reason.result
        best = answer["recommendation"]
        known = read_calibration(prior)
        seen = replay(other, known)
        assert known.posterior is not None
        low, high = known.posterior.interval("log young_kPa")
        turns.append(
            {
                "presses": len(rows),
                "verdict": result["verdict"],
                "found": [one["name"] for one in result["effects"]],
                "prior_used": None if result["prior"] is None else result["prior"]["used"],
                "conflicts": [] if result["prior"] is None else result["prior"]["conflicts"],
                "young": [low, high],
                "design": [best["thickness_mm"], best["young_kPa"]["low"], best["young_kPa"]["high"]],
                "replay": seen.total_rmse_N,
                "pad_factors": result["pad_factors"],
                "cpu_seconds": time.process_time() - started,
            }
        )
        designed = round(float(np.clip(best["thickness_mm"], *REACH_MM)), 1)
        rows = planned_rows(folder / f"plan-{turn}", designed, turn + 1)
    records = {} if pads is None else {"recorded": pads.recorded}
    return {"seed": seed, "effect": effect, "young": truth.young_kPa, "floor": truth.floor_N, **records, "turns": turns}


def contradicted(seed: int, folder: Path) -> dict:
    """A material 25 % stiffer than that of the prior: whether the contradiction is named."""
    generator.write_campaign(folder / "a", "none", 0.0, seed, rows=first_rows(), cast=CAST)
    dummydesign.calibrate(folder / "a", out=folder / "out-a")
    path = folder / "out-a" / "calibration.json"
    data = json.loads(path.read_text())
    index = data["posterior"]["names"].index("log young_kPa")
    data["posterior"]["mean"][index] += float(np.log(1.25))
    path.write_text(json.dumps(data))
    generator.write_campaign(folder / "b", "none", 0.0, seed, rows=planned_like(first_rows()), cast=CAST)
    prior = dummydesign.calibrate(folder / "b", prior=path).to_dict()["prior"]
    return {"seed": seed, "contradicted": True, "used": prior["used"], "conflicts": prior["conflicts"]}


def planned_like(rows: list[dict]) -> list[dict]:
    """The same presses on other pads."""
    return [{**row, "h": {8.0: 10.0, 14.0: 17.0}[row["h"]]} for row in rows]


FIELDS = (
    "seed",
    "put_in",
    "records",
    "turn",
    "modulus_half_width_percent",
    "error_on_other_pads_floors",
    "modulus_in_interval",
    "named",
)


def turn_rows(rows: list[dict]) -> list[dict]:
    """Each turn of each series, as a row of the data file."""
    return [
        {
            "seed": row["seed"],
            "put_in": row["effect"],
            "records": {None: "", False: "no", True: "yes"}[row.get("recorded")],
            "turn": number,
            "modulus_half_width_percent": f"{100 * np.log(turn['young'][1] / turn['young'][0]) / 2:.2f}",
            "error_on_other_pads_floors": f"{turn['replay'] / row['floor']:.2f}",
            "modulus_in_interval": "yes" if turn["young"][0] <= row["young"] <= turn["young"][1] else "no",
            "named": " ".join(turn["found"]),
        }
        for row in rows
        if "turns" in row
        for number, turn in enumerate(row["turns"], 1)
    ]


def table(rows: list[dict]) -> str:
    """Pads of one material, as designed, in Markdown; then :func:`pads_table`."""
    plain = [row for row in rows if "turns" in row and "recorded" not in row]
    width = np.array([[100 * np.log(t["young"][1] / t["young"][0]) / 2 for t in row["turns"]] for row in plain])
    error = np.array([[t["replay"] / row["floor"] for t in row["turns"]] for row in plain])
    inside = [[t["young"][0] <= row["young"] <= t["young"][1] for t in row["turns"]] for row in plain]
    narrower = int((np.diff(width, axis=1) < 0).all(axis=1).sum())
    smaller = int((error[:, -1] < error[:, 0]).sum())
    wrong = [row for row in rows if "contradicted" in row]
    named = sum(not row["used"] and any("young_kPa" in text for text in row["conflicts"]) for row in wrong)
    lines = [
        f"- Modulus: half width {_medians(width)} %, narrower after each turn in {narrower} of {len(plain)}; it "
        f"contains the true value in {sum(map(sum, inside))} of {np.size(inside)} turns.",
        f"- Error on other pads {_medians(error)}, smaller after the third turn in {smaller} of {len(plain)}.",
        f"- A prior of the same material was refused in {_refused(plain)} of {2 * len(plain)} turns; one with a "
        f"modulus 25 % off in {named} of {len(wrong)}.",
        "",
    ]
    return "\n".join([*lines, *pads_table(rows)]) + "\n"


def _medians(values: np.ndarray | list[list[float]]) -> str:
    """Median of each turn."""
    return " -> ".join(f"{v:.2f}" for v in np.median(values, axis=0))


def pads_table(rows: list[dict]) -> list[str]:
    """The part of the page on pads with a factor of their own: the same series with and without records."""
    both = {one: [row for row in rows if row.get("recorded") is one] for one in (False, True)}
    seeds = sorted({row["seed"] for row in both[True]} & {row["seed"] for row in both[False]})
    if not seeds:
        return []
    lines = ["| pads differ | without records | with records |", "|---|---|---|"]
    error: dict[bool, list[list[float]]] = {False: [], True: []}
    right: dict[bool, list[bool]] = {False: [], True: []}
    for seed in seeds:
        for one in (False, True):
            row = next(row for row in both[one] if row["seed"] == seed)
            error[one].append([turn["replay"] / row["floor"] for turn in row["turns"]])
            wanted = [] if row["effect"] == "none" else [row["effect"]]
            right[one] += [turn["found"] == wanted for turn in row["turns"]]
    falls = {one: sum(each[-1] < each[0] for each in error[one]) for one in error}
    smaller = int((np.array(error[True]) < np.array(error[False])).sum())
    last = [next(row for row in both[True] if row["seed"] == seed)["turns"][-1]["pad_factors"] for seed in seeds]
    explained = [one["explained"] or 0.0 for one in last]
    lines += [
        f"| median error | {_medians(error[False])} | {_medians(error[True])} |",
        f"| error smaller after the third turn | {falls[False]} of {len(seeds)} | {falls[True]} of {len(seeds)} |",
        f"| exactly the right names | {sum(right[False])} of {len(right[False])} turns | {sum(right[True])} of "
        f"{len(right[True])} |",
        "",
        f"- With records the error is smaller in {smaller} of {3 * len(seeds)} turns.",
        f"- The third answer states that pads differ by {np.median([one['size_percent'] for one in last]):.1f} % "
        f"(standard deviation). With the records {np.median([one['left_percent'] for one in last]):.1f} % remain; "
        f"they explain {100 * min(explained):.0f} to {100 * max(explained):.0f} % of the variance (median "
        f"{100 * np.median(explained):.0f}).",
    ]
    return lines


def write_page(rows: list[dict]) -> None:
    """Write the part of the page, and the data file of all turns."""
    write_evidence("turns", table(rows))
    with (ROOT / "docs" / "data" / "loop-turns.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(turn_rows(rows))


def _refused(rows: list[dict]) -> int:
    return sum(turn["prior_used"] is False for row in rows for turn in row["turns"])


def _run_pads(options: argparse.Namespace) -> None:
    """Each series twice, with and without records of the same pads."""
    for seed in range(options.seed, options.seed + options.seeds):
        for recorded in (False, True):
            if (seed, recorded) in {(row["seed"], row.get("recorded")) for row in read_rows(options.rows)}:
                continue
            with scratch("turns-") as folder:
                row = run_seed(seed, folder, generator.CastPads(recorded=recorded))
            keep_row(options.rows, row)
            print(json.dumps(row), file=sys.stderr, flush=True)
    write_page(read_rows(options.rows))


def main() -> None:
    """Run what is missing and write the page."""
    parser = argparse.ArgumentParser(description="Three turns of the loop.")
    parser.add_argument("--seed", type=int, default=981000, help="seeds count up from here")
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "results" / "loop_turns.jsonl")
    parser.add_argument("--pads", action="store_true", help="pads with a factor of their own, with and without records")
    options = parser.parse_args()
    if options.pads:
        _run_pads(options)
        return

    known = {row["seed"] for row in read_rows(options.rows)}
    for number in range(options.seeds + options.seeds // 4):
        seed = options.seed + number
        if seed in known:
            continue
        with scratch("turns-") as folder:
            row = run_seed(seed, folder) if number < options.seeds else contradicted(seed, folder)
        keep_row(options.rows, row)
        print(json.dumps(row), file=sys.stderr, flush=True)
    write_page(read_rows(options.rows))


if __name__ == "__main__":
    main()
