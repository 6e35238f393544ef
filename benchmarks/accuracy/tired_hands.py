"""Campaigns by tired hands: how often a wrong label is found, and how often one is seen where none is.

``python -m benchmarks.accuracy.tired_hands --seed N --campaigns N --rows FILE``; then the same with ``--table``.

Faults are put into the sheet or the files of campaigns of two generators that share no code with the loop
(``tests/support/campaign_generator.py`` and ``tests/support/independent_generator.py``). Half of the campaigns have a
fault, and half an effect that nobody declared, also such as are outside the vocabulary.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.accuracy.loop_independent_generator import share
from benchmarks.rows import keep_row, read_rows, scratch
from dummydesign.core.errors import InputError
from dummydesign.loop.data.trials import make_presses
from dummydesign.loop.fitting.fit import fit_base
from dummydesign.loop.model.campaign_law import law_of, within_reach
from dummydesign.loop.model.material import material_of
from dummydesign.loop.selection.doubts import doubts_of
from dummydesign.measurement.campaign_file import read_campaign
from tests.support import campaign_generator, independent_generator

FAULTS = ("pad", "exchanged", "thickness", "speed", "sensor", "zero", "whole_pad", "pads_of_a_day")
"""A press on another pad; two presses saved under each other's names; a thickness mistyped in one row; a press at
another speed than the sheet says; presses of a day, or some of them, by a sensor of another filter; a zero that moved
between two days; a thickness mistyped in all rows of a pad; two pads taken for each other for a day."""
MISTYPED = (0.15, 0.5)
"""Share by which a mistyped thickness is off: from one digit beside (15 for 13) to another pad's."""
ZERO_N = (0.1, 0.4)
FILTERS = (0.35, 0.6, 1.8, 3.0)
"""Cut-off of the second sensor over that of the declared one."""
FAST_MM_S = 50.0


def effects_of(rng: np.random.Generator, mind: str, loaded: bool) -> tuple[tuple[str, float], ...]:
    """An undeclared effect of one half to two times its usual size, one in four from outside the vocabulary."""
    if not loaded:
        return ()
    known, strange = (
        (campaign_generator.SIZES, campaign_generator.UNKNOWN)
        if mind == "first"
        else (independent_generator.SIZES, independent_generator.UNNAMED)
    )
    of = strange if rng.random() < 0.25 else known
    name = str(rng.choice(sorted(of)))
    return ((name, of[name] * float(np.exp(rng.uniform(np.log(0.5), np.log(2.0))))),)


def write(folder: Path, mind: str, put: tuple[tuple[str, float], ...], seed: int, filter_share: float = 1.0) -> None:
    """A campaign of one of the generators, its filter that share of the declared one."""
    if mind == "first":
        first, *more = put or (("none", 0.0),)
        campaign_generator.write_campaign(folder, *first, seed, more=tuple(more), cutoff_hz=35.0 * filter_share)
    else:
        independent_generator.write_campaign(folder, put, seed, cutoff_hz=50.0 * filter_share)


def one_of(rng: np.random.Generator, rows: Sequence[dict[str, str]]) -> dict[str, str]:
    """One of several trials, all alike."""
    return rows[int(rng.integers(len(rows)))]


def rows_of(folder: Path) -> list[dict[str, str]]:
    """The trials of a campaign file, values as they are written."""
    blocks = (folder / "campaign.toml").read_text().split("[[trial]]")[1:]
    return [dict(re.findall(r"^(\w+) = (.+)$", block, re.M)) for block in blocks]


def write_rows(folder: Path, rows: list[dict[str, str]]) -> None:
    """Replace the trials of a campaign file."""
    path = folder / "campaign.toml"
    head = path.read_text().partition("[[trial]]")[0]
    blocks = ["[[trial]]\n" + "".join(f"{key} = {value}\n" for key, value in row.items()) for row in rows]
    path.write_text(head + "".join(blocks))


def spoil(folder: Path, fault: str, mind: str, put: tuple[tuple[str, float], ...], seed: int) -> dict[str, Any]:
    """Put a fault into a written campaign; returns what was done."""
    rng, rows = np.random.default_rng([seed, 88]), rows_of(folder)
    pads = sorted({row["thickness_mm"] for row in rows}, key=float)
    days = sorted({row["age_days"] for row in rows}, key=float)
    day = str(rng.choice(days[1:]))
    of_day = [row for row in rows if row["age_days"] == day]
    done: dict[str, Any] = {}
    if fault == "pad":
        row = one_of(rng, rows)
        done["to"] = str(rng.choice([pad for pad in pads if pad != row["thickness_mm"]]))
        row["thickness_mm"], wrong = done["to"], [row]
    elif fault == "exchanged":
        keys = ("thickness_mm", "velocity_mm_s", "target_force_N")
        one = one_of(rng, rows)
        other = one_of(rng, [row for row in rows if [row[k] for k in keys] != [one[k] for k in keys]])
        done["same"] = [key for key in keys if one[key] == other[key]]
        one["file"], other["file"], wrong = other["file"], one["file"], [one, other]
    elif fault in ("thickness", "whole_pad"):
        row = one_of(rng, rows)
        off = float(np.exp(rng.choice([-1.0, 1.0]) * np.log1p(rng.uniform(*MISTYPED))))
        wrong = [row] if fault == "thickness" else [one for one in rows if one["thickness_mm"] == row["thickness_mm"]]
        typed = f"{float(row['thickness_mm']) * off:.1f}"
        done["off"] = float(typed) / float(row["thickness_mm"])
        for one in wrong:
            one["thickness_mm"] = typed
    elif fault == "speed":
        row = one_of(rng, rows)
        done["off"] = float(rng.choice([0.5, 2.0]))
        row["velocity_mm_s"], wrong = f"{float(row['velocity_mm_s']) * done['off']:g}", [row]
    elif fault == "sensor":
        done["share"], done["all"] = float(rng.choice(FILTERS)), bool(rng.random() < 0.5)
        wrong = of_day if done["all"] else [row for row in rows if rng.random() < 0.4]
        write(folder.with_name("other"), mind, put, seed, done["share"])
        for row in wrong:
            name = row["file"].strip('"')
            (folder / name).write_text((folder.with_name("other") / name).read_text())
        if not done["all"]:  # a slow press need not show its filter
            done["also"] = sorted(row["file"].strip('"') for row in wrong)
            wrong = [row for row in wrong if float(row["velocity_mm_s"]) > FAST_MM_S]
    elif fault == "zero":
        done["zero_N"] = float(rng.choice([-1.0, 1.0]) * rng.uniform(*ZERO_N))
        wrong = of_day
        for row in wrong:
            path = folder / row["file"].strip('"')
            head, *lines = path.read_text().split()
            values = [line.rpartition(",") for line in lines]
            path.write_text("\n".join([head, *(f"{a},{float(f) + done['zero_N']:.2f}" for a, _, f in values)]) + "\n")
    else:
        a, b = (str(one) for one in rng.choice(pads, 2, replace=False))
        wrong = [row for row in of_day if row["thickness_mm"] in (a, b)]
        for row in wrong:
            row["thickness_mm"] = b if row["thickness_mm"] == a else a
    write_rows(folder, rows)
    return {**done, "wrong": sorted(row["file"].strip('"') for row in wrong)}


KINDS = {
    "pad": ("pad", "thickness"),
    "exchanged": ("exchanged", "pad", "thickness", "speed"),
    "thickness": ("thickness", "pad"),
    "speed": ("speed",),
    "sensor": ("sensor",),
    "zero": ("zero",),
    "whole_pad": ("thickness", "pad"),
    "pads_of_a_day": ("exchanged", "pad", "thickness"),
}
"""Kinds of doubt that name each fault."""
MOST_WRONG = 0.5


def run_one(number: int, seed: int, folder: Path) -> dict[str, Any]:
    """Draw a campaign, doubt its labels, and keep what was said."""
    rng = np.random.default_rng([seed, 87])
    mind, loaded = ("first", "other")[number % 2], number // 2 % 2 == 1
    fault = FAULTS[number // 8 % len(FAULTS)] if number // 4 % 2 == 1 else ""
    put = effects_of(rng, mind, loaded)
    write(folder / "a", mind, put, seed)
    done = spoil(folder / "a", fault, mind, put, seed) if fault else {}
    row = {"seed": seed, "number": number, "mind": mind, "put": list(put), "fault": fault, **done}
    began = time.process_time()
    try:
        campaign = read_campaign(folder / "a")
        law, every = law_of(campaign), make_presses(campaign)
        _, presses, _ = within_reach(campaign, every, law)
        fit = fit_base(presses, law, 1e-3 * material_of(campaign).young_kPa.value)
        base_s, began = time.process_time() - began, time.process_time()
        doubts = doubts_of(campaign, every, fit)
    except InputError as problem:
        return {**row, "refused": str(problem).replace(f"{folder / 'a'}/", ""), "doubts": []}
    seconds = round(time.process_time() - began, 2)
    kept = [{"kind": one.kind, "files": list(one.files), "text": one.text} for one in doubts]
    return {**row, "base_s": round(base_s, 2), "cpu_s": seconds, "doubts": kept}


def found(row: dict[str, Any]) -> bool:
    """Whether the fault is named: its kind, most of the files, and at most as many wrong files as right ones.

    A file that is refused because it cannot be of its pad counts if the message names it.
    """
    wrong = set(row["wrong"])
    if "refused" in row:
        return any(name in row["refused"] for name in wrong)
    named = {file for one in row["doubts"] if one["kind"] in KINDS[row["fault"]] for file in one["files"]}
    # of two groups either may be called the odd one
    return len(named & wrong) >= 0.5 * len(wrong) and len(named - wrong) <= MOST_WRONG * len(named)


def beside(row: dict[str, Any]) -> bool:
    """Whether a doubt of another kind, or of other files, is raised beside the fault."""
    named = {file for one in row["doubts"] for file in one["files"]}
    return bool(named - set(row["wrong"]) - set(row.get("also", ())))


def table(rows: list[dict[str, Any]]) -> str:
    """Rates of a study in Markdown."""
    lines = ["| | found | rate | 95 % | wanted |", "|---|---|---|---|---|"]

    def line(name: str, of: list[dict[str, Any]], hit: Callable[[dict[str, Any]], bool], wanted: str = "") -> None:
        lines.append(share(name, [hit(row) for row in of], wanted))

    clean, faulty = [r for r in rows if not r["fault"]], [r for r in rows if r["fault"]]
    line("no fault: a doubt", clean, lambda r: bool(r["doubts"]) or "refused" in r, "<= 3 %")
    line("the same without an effect", [r for r in clean if not r["put"]], lambda r: bool(r["doubts"]))
    line("the same with an effect", [r for r in clean if r["put"]], lambda r: bool(r["doubts"]))
    line("a fault: found", faulty, found, ">= 90 %")
    line("the same without an effect", [r for r in faulty if not r["put"]], found)
    line("the same with an effect", [r for r in faulty if r["put"]], found)
    line("a fault: a file named that has none", faulty, beside)
    for fault in FAULTS:
        line(fault, [r for r in faulty if r["fault"] == fault], found)
    seconds = [row["cpu_s"] for row in rows if "cpu_s" in row]
    lines += ["", f"Processor seconds of the doubts: median {np.median(seconds):.1f}, largest {max(seconds):.1f}."]
    missed = [row for row in faulty if not found(row)]
    lines += ["", "Not found:"]
    lines += [f"- {row['seed']} {row['fault']} {row.get('off', row.get('share', ''))} {row['put']}" for row in missed]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run what is missing of the study, or print its table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=3400000)
    parser.add_argument("--campaigns", type=int, default=128)
    parser.add_argument("--rows", type=Path, required=True)
    parser.add_argument("--table", action="store_true")
    options = parser.parse_args()
    known = {row["seed"] for row in read_rows(options.rows)}
    for number in range(0 if options.table else options.campaigns):
        seed = options.seed + number
        if seed in known:
            continue
        with scratch("tired-") as folder:
            keep_row(options.rows, run_one(number, seed, folder))
        print(json.dumps(read_rows(options.rows)[-1])[:400], file=sys.stderr, flush=True)
    if options.table:
        print(table(read_rows(options.rows)))


if __name__ == "__main__":
    main()
