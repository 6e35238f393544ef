"""Blind study on campaigns of an independent generator.

``python -m benchmarks.accuracy.loop_independent_generator --seed N --campaigns N --rows FILE``; then the same with
``--table``.

The generator is tests/support/independent_generator.py. Every run is one line of the file of rows; ``--table`` prints
rates, and for each effect from which size on, in noise floors of the base model on left-out conditions, 9 of 10 are
found.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np

from benchmarks.rows import keep_row, read_rows, scratch
from dummydesign.core.errors import InputError
from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.run import close_loop, replay
from dummydesign.loop.selection.cross_validation import effect_intervals
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import independent_generator as generator

Put = tuple[tuple[str, float], ...]
KINDS = ("one", "two", "none", "unnamed", "one", "two", "one", "none", "three", "one", "two", "unnamed", "one")
COUNTS = {"none": 0, "one": 1, "two": 2, "three": 3}
SHOWN = ("none", "one", "two", "three", "unnamed")
SAME_LAW = ("contact_offset", "thickness_error", "inertia", "force_bias")
"""Effects whose law is the vocabulary's, so that their size can be compared."""
READINGS = ("sensor_square", "sensor_cube")
"""Functions of the reading: the vocabulary's ``sensor_curve``."""
LEAST_FLOORS = 3.0
"""What a single effect must leave to the base model to count as one that is to be found."""


def draw(kind: str, number: int, seed: int) -> Put:
    """Names and sizes of a campaign: single ones over two decades about the usual size, others 1 to 3 times usual."""
    rng = np.random.default_rng([seed, 501])
    if kind == "unnamed":
        name = list(generator.UNNAMED)[number % len(generator.UNNAMED)]
        return ((name, generator.UNNAMED[name] * float(rng.uniform(0.7, 2.0))),)
    names = list(generator.SIZES)
    if kind == "one":
        name = names[number % len(names)]
        spread = 10.0 ** rng.uniform(-1.0, 1.0) if name != "sensor_clipping" else rng.uniform(0.2, 1.5)
        most = {
            "strain_dependent_relaxation": 4.0,
            "base_slip": 4.0,
            "compressibility": 3.0,
            "punch_tilt": 3.0,
            "thickness_error": 4.0,
            "softening_with_cycles": 3.0,
        }.get(name, 10.0)
        return ((name, generator.SIZES[name] * min(spread, most)),)
    rare = {"base_slip", "compressibility", "thickness_error", "sensor_clipping"}
    chosen = rng.choice([name for name in names if name not in rare], COUNTS[kind], replace=False)
    return tuple((str(name), generator.SIZES[str(name)] * float(rng.uniform(1.0, 3.0))) for name in chosen)


def run_one(kind: str, number: int, seed: int, folder: Path) -> dict:
    """Write a campaign and two on other pads and conditions, close the loop, predict them.

    The pads of the last have no factor of their own.
    """
    put = draw(kind, number, seed)
    truth = generator.write_campaign(folder / "a", put, seed)
    generator.write_campaign(folder / "b", put, seed, held_out=True)
    generator.write_campaign(folder / "c", put, seed, held_out=True, usual_pads=True)
    row = {
        "seed": seed,
        "kind": kind,
        "put": list(truth.effects.items()),
        "young_kPa": truth.young_kPa,
        "floor_N": truth.floor_N,
    }
    try:
        campaign, began = read_campaign(folder / "a"), time.process_time()
        result = close_loop(campaign)
        row["cpu_s"] = round(time.process_time() - began, 1)
        calibration = calibration_of(result)
        other, usual = (replay(read_campaign(folder / name), calibration) for name in ("b", "c"))
    except InputError as problem:
        return {**row, "refused": str(problem).partition("; ")[0]}
    assert calibration.posterior is not None
    sizes = {}
    for one in result.effects:
        size = next(iter(effect_intervals(result.after, one.candidate.effect).values()))
        sizes[one.candidate.effect.name] = [size["low"], size["value"], size["high"]]
    return {
        **row,
        "verdict": result.verdict,
        "named": list(sizes),
        "sizes": sizes,
        "rivals": {one.candidate.effect.name: list(one.confounded_with) for one in result.effects},
        "learned": None if result.learnt is None else result.learnt.effect.shape.name,
        "gains": [round(one.candidate.gain, 1) for one in result.effects],
        "ranking": [[one.effect.name, round(one.gain, 1)] for one in result.selection.ranking[:4]],
        "warnings": [one["code"] for one in result.warnings],
        "reasons": list(result.remainder.reasons),
        "heldout_N": [result.base.errors.heldout_N, result.after.errors.heldout_N],
        "expected": result.remainder.expected,
        "replay_N": [other.total_base_rmse_N, other.total_rmse_N],
        "usual_pads_N": [usual.total_base_rmse_N, usual.total_rmse_N],
        "interval_kPa": list(calibration.posterior.interval("log young_kPa")),
    }


def floors(row: dict) -> float:
    """What the base model leaves beyond noise on left-out conditions, in noise floors."""
    return float(np.sqrt(max((row["heldout_N"][0] / row["floor_N"]) ** 2 - 1.4, 0.0)))


def silent_on_usual_pads(row: dict) -> bool:
    """Whether two noise floors are left on pads without a factor of their own, and the verdict does not say so."""
    left = row.get("usual_pads_N", (0.0, 0.0))[1] / row["floor_N"]
    return row.get("verdict", "unexplained") != "unexplained" and left**2 > 4.0 + 1.0


def share(name: str, hits: list[bool], wanted: str = "") -> str:
    """A row of the table: count, rate, 95 % interval by Wilson, and the rate that is wanted."""
    n, k, z = len(hits), sum(hits), 1.96
    if not n:
        return f"| {name} | 0 | | | {wanted} |"
    middle, half = (k + z * z / 2) / (n + z * z), z * np.sqrt(k * (n - k) / n + z * z / 4) / (n + z * z)
    low, high = max(100 * (middle - half), 0.0), min(100 * (middle + half), 100.0)
    return f"| {name} | {k} of {n} | {100 * k / n:.0f} % | {low:.0f} to {high:.0f} | {wanted} |"


def table(rows: list[dict]) -> str:
    """Rates of a study in Markdown."""
    ran = [row for row in rows if "refused" not in row]
    of = {kind: [row for row in ran if row["kind"] == kind] for kind in SHOWN}
    put = {row["seed"]: {name for name, _ in row["put"]} for row in ran}
    large = [row for row in of["one"] if floors(row) >= LEAST_FLOORS]

    def covers(row: dict) -> bool:
        return row["interval_kPa"][0] <= row["young_kPa"] <= row["interval_kPa"][1]

    def only(row: dict) -> bool:
        return set(row["named"]) <= put[row["seed"]]

    def all_named(row: dict) -> bool:
        return put[row["seed"]] <= set(row["named"])

    known = [row for kind in ("none", "one", "two", "three") for row in of[kind]]
    named = [row for row in known if put[row["seed"]] == set(row["named"]) and row["learned"] is None]
    clipped = [row for row in of["one"] if "sensor_clipping" in put[row["seed"]]]
    adhering = [row for row in large if "adhesion" in put[row["seed"]]]
    functions = [row for row in of["unnamed"] if not put[row["seed"]] & set(READINGS)]
    curves = [row for row in of["unnamed"] if put[row["seed"]] & set(READINGS)]
    sizes = [
        (row, name, size) for row in known for name, size in row["put"] if name in SAME_LAW and name in row["named"]
    ]
    usual = np.median([(row["replay_N"][1] / row["floor_N"]) ** 2 for row in of["none"]]) if of["none"] else 1.0

    def inside(row: dict, name: str, size: float) -> bool:
        return row["sizes"][name][0] <= size <= row["sizes"][name][2]

    def silent(row: dict) -> bool:
        return row["verdict"] != "unexplained" and (row["replay_N"][1] / row["floor_N"]) ** 2 > 4.0 + usual

    def beyond_rivals(row: dict) -> bool:
        """Whether a wrong effect is named of which no right one is stated as a rival."""
        wrong = set(row["named"]) - put[row["seed"]]
        return any(not put[row["seed"]] & set(row["rivals"][name]) for name in wrong)

    lines = ["| | found | rate | 95 % | wanted |", "|---|---|---|---|---|"]
    lines += [
        share("none: something named or learned", [bool(r["named"] or r["learned"]) for r in of["none"]], "<= 3 %"),
        share("none: called unexplained", [r["verdict"] == "unexplained" for r in of["none"]]),
        share("one, 3 floors or more: right first", [r["named"][:1] == [*put[r["seed"]]] for r in large], ">= 90 %"),
        share("one, 3 floors or more: a wrong name", [not only(r) for r in large]),
        share("one, less: a wrong name", [not only(r) for r in of["one"] if r not in large]),
        *(
            [
                share(
                    "one, less: a wrong name, the right one not among its rivals",
                    [beyond_rivals(r) for r in of["one"] if r not in large],
                )
            ]
            if all("rivals" in r for r in ran)
            else []
        ),
        share("two: both", [all_named(r) for r in of["two"]], ">= 85 %"),
        share("two: a wrong name", [not only(r) for r in of["two"]], "<= 5 %"),
        share("three: all", [all_named(r) for r in of["three"]], ">= 65 %"),
        share("three: a wrong name", [not only(r) for r in of["three"]]),
        share("known, called unexplained", [r["verdict"] == "unexplained" for r in known if r["kind"] != "none"]),
        share("unnamed function of the state: learned", [r["learned"] is not None for r in functions], ">= 80 %"),
        share(
            "unnamed function of the state: learned, or called unexplained",
            [r["learned"] is not None or r["verdict"] == "unexplained" for r in functions],
        ),
        share("curve of the reading: named", ["sensor_curve" in r["named"] for r in curves]),
        share("clipping found", [r["named"][:1] == ["sensor_clipping"] for r in clipped], "95 %"),
        share("adhesion found, 3 floors or more", ["adhesion" in r["named"] for r in adhering], "90 %"),
        share("`effect` or `none`, more than two floors left on other pads", [silent(r) for r in ran], "0"),
        *(
            [share("the same on pads without a factor of their own", [silent_on_usual_pads(r) for r in ran], "0")]
            if all("usual_pads_N" in r for r in ran)
            else []
        ),
        share("modulus inside its 95 % interval", [covers(r) for r in known], "92 to 98 %"),
        share("modulus inside, effects all right", [covers(r) for r in named]),
        share("size inside its 95 % interval, effects of the same law", [inside(*one) for one in sizes], "92 to 98 %"),
        share(
            "new pads: corrected model worse than the base", [r["replay_N"][1] > 1.02 * r["replay_N"][0] for r in ran]
        ),
        share("refused", ["refused" in r for r in rows]),
    ]
    ratio = [r["replay_N"][1] / r["replay_N"][0] for r in of["unnamed"]]
    beyond = [r for r in of["unnamed"] if "usual_pads_N" in r]
    parts = [[np.sqrt(max(n**2 - r["floor_N"] ** 2, 0.0)) for n in r["usual_pads_N"]] for r in beyond]
    spans = [0.5 * abs((row["sizes"][name][2] - row["sizes"][name][0]) / size) for row, name, size in sizes]
    width = [0.5 * (r["interval_kPa"][1] / r["interval_kPa"][0] - 1.0) for r in named]
    lines += [
        "",
        f"Unnamed: error on other pads over the base's, median {np.median(ratio):.2f}." if ratio else "",
        "The same beyond noise, on pads without a factor of their own: median "
        f"{np.median([after / max(base, 1e-9) for base, after in parts]):.2f}."
        if parts
        else "",
        f"Half width of the modulus, effects all right: median {100 * np.median(width):.1f} %." if width else "",
        f"Half width of those sizes: median {100 * np.median(spans):.1f} %." if spans else "",
        f"Processor seconds: two effects median {np.median([r['cpu_s'] for r in of['two']]):.1f}; all "
        f"{np.quantile([r['cpu_s'] for r in ran], 0.95):.1f} in 95 %, largest {max(r['cpu_s'] for r in ran):.1f}."
        if of["two"]
        else "",
    ]
    lines += ["", "| effect | campaigns | found | floors of those found first | of those not |"]
    lines.append("|---|---|---|---|---|")
    for name in generator.SIZES:
        own = [row for row in of["one"] if name in put[row["seed"]]]
        hit = sorted(floors(r) for r in own if r["named"][:1] == [name])
        miss = sorted(floors(r) for r in own if r["named"][:1] != [name])
        words = [", ".join(f"{one:.1f}" for one in part) for part in (hit, miss)]
        lines.append(f"| {name} | {len(own)} | {len(hit)} | {words[0]} | {words[1]} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what is missing of the study, or print its table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=910000)
    parser.add_argument("--campaigns", type=int, default=100)
    parser.add_argument("--part", type=int, nargs=2, default=(0, 1), metavar=("K", "N"), help="each N-th from K")
    parser.add_argument("--only", nargs="*", choices=SHOWN)
    parser.add_argument("--effect", choices=list(generator.SIZES), help="this one alone in every campaign")
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()
    known = {row["seed"] for row in read_rows(options.rows)}
    counts = dict.fromkeys(SHOWN, 0)
    for number in range(0 if options.table else options.campaigns):
        kind, seed = KINDS[number % len(KINDS)], options.seed + number
        counts[kind] += 1
        if number % options.part[1] != options.part[0] or seed in known or (options.only and kind not in options.only):
            continue
        index = counts[kind] - 1
        if options.effect:
            kind, index = "one", list(generator.SIZES).index(options.effect)
        with scratch("mind-") as folder:
            keep_row(options.rows, run_one(kind, index, seed, folder))
        row = read_rows(options.rows)[-1]
        shown = {key: row.get(key) for key in ("seed", "put", "verdict", "named", "learned", "refused", "cpu_s")}
        print(json.dumps(shown), file=sys.stderr, flush=True)
    if options.table:
        print(table(read_rows(options.rows)))


if __name__ == "__main__":
    main()
