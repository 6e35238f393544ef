"""From which size on is each effect found? Single effects of the other generator, sizes over two decades.

``python -m benchmarks.accuracy.loop_detection --seed N --rounds N --rows FILE`` runs every effect once a round;
``--table`` writes docs/data/loop-detection.csv and docs/images/loop-detection.svg from the rows, with the single
effects of another study's rows (``--beside FILE``). An effect is found when the loop names it first.

The share found is a logistic curve in the logarithm of the size, with a middle of each effect's own and one steepness
for all; both are integrated over a grid, so that a few campaigns an effect give an interval and not a step. The sizes
of the first rounds are spread over two decades, those of later ones lie near the middle as it is known by then.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.accuracy.loop_independent_generator import floors
from benchmarks.rows import keep_row, read_rows, scratch
from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.loop.calibration import calibration_of
from dummydesign.loop.run import close_loop
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import independent_generator as generator

USUAL = {**generator.SIZES, "sensor_square": generator.UNNAMED["sensor_square"]}
NAMES = {"sensor_square": "sensor_curve"}
"""What is to be named where the generator's word is another one."""
MOST = {
    "base_slip": 4.0,
    "compressibility": 3.0,
    "punch_tilt": 3.0,
    "strain_dependent_relaxation": 4.0,
    "thickness_error": 4.0,
    "softening_with_cycles": 3.0,
    "sensor_clipping": 1.5,
}
"""Largest size over the usual one where ten times the usual one is not physical."""
DATA, FIGURE = Path("docs/data/loop-detection.csv"), Path("docs/images/loop-detection.svg")
GOLDEN, SPREAD = 0.618034, 2
NAMED_SHARE = 0.9


def size_of(number: int, turn: int, rows: list[dict]) -> float:
    """Size of an effect in a round.

    Spread evenly in the logarithm over the two decades below its largest; from the third round on near the middle of
    its curve, within a factor of 1.5 and those decades.
    """
    name = list(USUAL)[number]
    share = (number * 0.37 + turn * GOLDEN) % 1.0
    largest = USUAL[name] * MOST.get(name, 10.0)
    if turn < SPREAD:
        return largest * 10.0 ** (2.0 * share - 2.0)
    middle = next(one.middle for one in detection(rows) if one.name == NAMES.get(name, name))
    return float(np.clip(middle * 1.5 ** (2.0 * share - 1.0), 0.01 * largest, largest))


def run_one(number: int, turn: int, seed: int, folder: Path, rows: list[dict]) -> dict:
    """One campaign with one effect: what was put in, and what was named."""
    name = list(USUAL)[number]
    truth = generator.write_campaign(folder, ((name, size_of(number, turn, rows)),), seed)
    row = {"seed": seed, "effect": NAMES.get(name, name), "size": abs(truth.effects[name]), "floor_N": truth.floor_N}
    try:
        campaign, began = read_campaign(folder), time.process_time()
        result = close_loop(campaign)
    except InputError as problem:
        return {**row, "refused": str(problem).partition("; ")[0]}
    posterior = calibration_of(result).posterior
    return {
        **row,
        "verdict": result.verdict,
        "named": [one.candidate.effect.name for one in result.effects],
        "learned": None if result.learnt is None else result.learnt.effect.shape.name,
        "ranking": [[one.effect.name, round(one.gain, 1)] for one in result.selection.ranking[:3]],
        "heldout_N": [result.base.errors.heldout_N, result.after.errors.heldout_N],
        "young_kPa": truth.young_kPa,
        "interval_kPa": posterior and list(posterior.interval("log young_kPa")),
        "cpu_s": round(time.process_time() - began, 1),
    }


def singles(rows: list[dict]) -> list[dict]:
    """Campaigns with one effect among the rows of the study of the independent generator."""
    out = []
    for row in rows:
        if len(row["put"]) == 1 and row["put"][0][0] in USUAL:
            name, size = row["put"][0]
            out.append({**row, "effect": NAMES.get(name, name), "size": abs(size)})
    return out


@dataclass(frozen=True)
class DetectionLimit:
    """Detection of one effect: the size found in 9 of 10 with its 90 % interval, sizes found and missed."""

    name: str
    middle: float
    size: tuple[float, float, float]
    range: tuple[float, float]
    floors_per_size: float
    hits: list[float]
    misses: list[float]
    curve: tuple[NDArray, NDArray]
    """Sizes, and the chance at each to be found."""


STEEP = np.geomspace(1.0, 20.0, 25)
"""Steepness of the logistic curve over the natural logarithm of the size."""
BEYOND = 3.0
"""Natural logarithm by which the middle of a curve may lie outside the sizes that were tried."""


def detection(rows: list[dict]) -> list[DetectionLimit]:
    """Size from which on each effect is found in 9 of 10, from all effects together."""
    rows = [row for row in rows if "refused" not in row]
    names = list(dict.fromkeys(NAMES.get(name, name) for name in USUAL))
    own = {name: some for name in names if (some := [row for row in rows if row["effect"] == name])}
    tables, grids = {}, {}
    for name, some in own.items():
        size = np.log([row["size"] for row in some])
        hit = np.array([row["named"][:1] == [name] for row in some])
        grids[name] = np.linspace(size.min() - BEYOND, size.max() + BEYOND, 241)
        at = STEEP[:, None, None] * (size - grids[name][:, None])
        tables[name] = np.where(hit, -np.logaddexp(0.0, -at), -np.logaddexp(0.0, at)).sum(axis=-1)
    # one steepness for all: its likelihood is the product over effects, each with its middle integrated out
    each = {name: np.logaddexp.reduce(table, axis=1) for name, table in tables.items()}
    total = sum(each.values())
    limits = []
    for name, some in own.items():
        weights = np.exp(tables[name] - each[name][:, None] + (total - total.max())[:, None])
        places = grids[name] + np.log(NAMED_SHARE / (1.0 - NAMED_SHARE)) / STEEP[:, None]
        low, middle, high = np.exp(_quantiles(places, weights, (0.05, 0.5, 0.95)))
        half = float(np.exp(_quantiles(np.broadcast_to(grids[name], weights.shape), weights, (0.5,))[0]))
        sizes = [row["size"] for row in some]
        hits = [row["size"] for row in some if row["named"][:1] == [name]]
        misses = [row["size"] for row in some if row["named"][:1] != [name]]
        seen = [floors(row) / row["size"] for row in some if floors(row) >= 1.0]
        shown = np.geomspace(min(sizes), max(sizes), 40)
        chance = [
            np.average(1.0 / (1.0 + np.exp(-STEEP[:, None] * (np.log(one) - grids[name]))), weights=weights)
            for one in shown
        ]
        limits.append(
            DetectionLimit(
                name,
                half,
                (float(low), float(middle), float(high)),
                (min(sizes), max(sizes)),
                float(np.median(seen)) if len(seen) > 1 else 0.0,
                hits,
                misses,
                (shown, np.array(chance)),
            )
        )
    return limits


def _quantiles(values: NDArray, weights: NDArray, wanted: tuple[float, ...]) -> NDArray:
    order = np.argsort(values, axis=None)
    share = np.cumsum(weights.ravel()[order])
    return np.interp(wanted, share / share[-1], values.ravel()[order])


UNITS = {
    "contact_offset": "mm",
    "machine_compliance": "mm/N",
    "punch_tilt": "degrees",
    "thickness_error": "mm",
    "adhesion": "N",
    "inertia": "kg",
    "force_bias": "N",
    "force_drift": "N/s",
    "sensor_lag": "s",
    "time_skew": "s",
    "temperature": "1/C",
    "ageing": "",
    "sensor_curve": "1/N",
}


def lines_of(limits: list[DetectionLimit]) -> list[list[str]]:
    """Lines of the table: effect, campaigns, size with interval, the same in noise floors."""
    out = []
    for one in limits:
        unit = UNITS.get(one.name, "")
        low, middle, high = one.size
        most = one.range[1]
        known = middle <= most
        size = f"{middle:.2g}" if known else f"above {most:.2g}"
        span = f"{low:.2g} to {high:.2g}" if high <= most else f"above {min(low, most):.2g}"
        ratio = one.floors_per_size
        worth = "below 1" if not ratio or middle * ratio < 1.0 else f"{middle * ratio:.1f}" if known else "not known"
        ends = f"{low * ratio:.1f} to {high * ratio:.1f}" if ratio and high <= most else ""
        count = str(len(one.hits) + len(one.misses))
        out.append([one.name, count, str(len(one.hits)), f"{size} {unit}".strip(), span, worth, ends])
    return out


HEAD = ["effect", "campaigns", "found", "found in 9 of 10 from", "90 % interval", "in noise floors", "90 % interval"]


def table(limits: list[DetectionLimit]) -> str:
    """The table in Markdown."""
    rows = [HEAD, ["---"] * len(HEAD), *lines_of(limits)]
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


ACROSS = 4


def figure(limits: list[DetectionLimit]) -> str:
    """The chance to be found over the size, a panel for each effect, as SVG."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {"svg.hashsalt": "loop-detection", "font.size": 7, "axes.spines.top": False, "axes.spines.right": False}
    )
    rows = -(-len(limits) // ACROSS)
    drawn, panels = plt.subplots(rows, ACROSS, figsize=(7.2, 1.5 * rows), layout="constrained", squeeze=False)
    for panel in panels.flat[len(limits) :]:
        panel.set_visible(False)
    for panel, one in zip(panels.flat, limits):
        named = np.repeat([1.0, 0.0], [len(one.hits), len(one.misses)])
        panel.semilogx(*one.curve, linewidth=1.2)
        panel.plot([*one.hits, *one.misses], named, "s", markersize=2)
        panel.set(title=one.name.replace("_", " "), xlabel=f"size [{UNITS.get(one.name, '') or '1'}]")
        panel.set(xlim=(0.8 * one.range[0], 1.25 * one.range[1]), ylim=(-0.08, 1.08))
        panel.minorticks_off()
    stream = io.StringIO()
    drawn.savefig(stream, format="svg", metadata={"Date": None})
    return stream.getvalue()


def main() -> None:
    """Run what is missing of some rounds, or write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1030000)
    parser.add_argument("--rounds", type=int, default=8)
    parser.add_argument("--rows", type=Path, default=Path("benchmarks/results/loop_detection.jsonl"))
    parser.add_argument("--beside", type=Path, nargs="*", default=[], help="rows of loop_independent_generator")
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()

    def rows() -> list[dict]:
        return [*read_rows(options.rows), *(one for path in options.beside for one in singles(read_rows(path)))]

    known = {row["seed"] for row in read_rows(options.rows)}
    for number in range(0 if options.table else options.rounds * len(USUAL)):
        seed = options.seed + number
        if seed in known:
            continue
        with scratch("detect-") as folder:
            keep_row(options.rows, run_one(number % len(USUAL), number // len(USUAL), seed, folder / "a", rows()))
        row = read_rows(options.rows)[-1]
        shown = {key: row.get(key) for key in ("seed", "effect", "size", "verdict", "named", "refused", "cpu_s")}
        print(json.dumps(shown), file=sys.stderr, flush=True)
    if options.table:
        limits = detection(rows())
        with DATA.open("w", newline="") as stream:
            csv.writer(stream, lineterminator="\n").writerows([HEAD, *lines_of(limits)])
        write_text(FIGURE, figure(limits))
        print(table(limits))


if __name__ == "__main__":
    main()
