"""For how many tissues a pad is found, by kind of shape. About 8 s each.

    python -m benchmarks.accuracy.random_tissues

Tissues are drawn from the posterior of the built-in ones, one after the other: a draw is five persons. The shapes are
searched by their tables, without finite elements, with the default resin. Of each kind the level and the three shares
that the search expects are kept; of the pad that is taken its verdict and its shares over castings. Every tissue is
kept in ``--rows`` (one JSON object a line), so that a study can be stopped and resumed; the tables are printed, and
written to ``--csv``.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.rows import keep_row, read_rows, write_csv
from dummydesign.core.errors import NoAnswerError
from dummydesign.core.levels import LEVELS
from dummydesign.design.assessment.pad_castings import Share, shares_of_pad, verdict_of_design
from dummydesign.design.pad_evaluator import cast_pad
from dummydesign.design.problem import Problem, read_problem
from dummydesign.design.request import Request
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import CLASSES, ranges_of
from dummydesign.design.search.shape_search import ShapedDesign, search_shapes
from dummydesign.tissue.model.posterior import COLUMNS, read_draws, subject_of
from dummydesign.tissue.model.tissue import Tissue

ROOT = Path(__file__).resolve().parents[2]

RED = LEVELS[-1]
SITES = ("forefinger", "palm", "thenar")
KINDS = ("slab", "crowned", "layered", "boned")
SHARES = ("as_poured", "resin_known", "after_puck")


def drawn_tissue(tissue: Tissue, site: str, rng: np.random.Generator) -> tuple[Tissue, int]:
    """A tissue of the five persons of one draw of a site's posterior, drawn by its weight, and the draw's number."""
    draws, weight = read_draws(ROOT / "materials" / "tissues" / f"{site}_draws.csv")
    number = int(rng.choice(len(draws), p=weight / weight.sum()))
    kinds = [("measured", f"draw {number} of the posterior of {site}")] * len(COLUMNS)
    subjects = tuple(subject_of(f"person-{k + 1}", row, row, row, kinds) for k, row in enumerate(draws[number]))
    return replace(tissue, name=f"{site}-{number}", subjects=subjects), number


def study_one(number: int, seed: int) -> dict[str, Any]:
    """Search one random tissue: the best pad of each kind of shape, and the castings of the pad that is taken."""
    started = time.process_time()
    site = SITES[number % len(SITES)]
    problem = read_problem(Request(site, verify=False))
    tissue, draw = drawn_tissue(problem.tissue, site, np.random.default_rng([seed, number]))
    targets = make_targets(tissue, "average", problem.sampling)
    problem = space = replace(problem, tissue=tissue, targets=targets)
    kinds: dict[str, dict[str, Any]] = {}
    taken: dict[str, Any] = {}
    try:
        designs = search_shapes("auto", problem.slab_law, space)[0]
        taken = taken_pad(problem, designs[0])
    except NoAnswerError:
        designs = []
    limits, strict = space.targets.limits, ranges_of(space.targets).strict
    for design in designs:  # ranked: the first of a kind is its best
        outlook = design.outlook
        kinds.setdefault(
            design.shape.name,
            {
                "level": LEVELS[outlook.level(limits, strict)],
                "as_poured": round(outlook.as_poured, 4),
                "resin_known": round(outlook.known, 4),
                "after_puck": round(outlook.after_puck, 4),
            },
        )
    row = {"number": number, "seed": seed, "site": site, "draw": draw, "kinds": kinds, "taken": taken}
    return {**row, "cpu_seconds": round(time.process_time() - started, 1)}


def taken_pad(problem: Problem, design: ShapedDesign) -> dict[str, Any]:
    """The pad that is taken: its verdict and its three shares."""
    cast = cast_pad(problem, design)
    judged, shares = verdict_of_design(cast), shares_of_pad(cast)
    window = shares.window_kPa
    return {
        "kind": design.shape.name,
        "shape": str(design.shape),
        "thickness_mm": design.thickness_mm,
        "ratio": cast.candidate.ratio,
        "level": judged.level,
        "reads": judged.reads,
        "window_kPa": None if window is None else [round(one, 2) for one in window],
        "no_ratio": round(shares.after_puck.no_ratio, 4),
        "no_ratio_reason": shares.after_puck.no_ratio_reason,
        "shares": {name: _share(getattr(shares, name)) for name in SHARES},
        "shortfall": [judged.shortfall.central, judged.shortfall.q95, judged.shortfall.quantity],
        "over": [judged.over.central, judged.over.q95, judged.over.quantity],
    }


def _share(share: Share) -> dict[str, float]:
    return {name: round(float(getattr(share, name)), 4) for name in CLASSES}


def usable(share: dict[str, float]) -> float:
    """Share of castings that may be used, as they are or with a correction."""
    return share["stands_for"] + share["with_correction"]


def table(rows: list[dict[str, Any]]) -> str:
    """Share of tissues with a pad that is not red, by site and kind."""
    head, *lines = figures(rows)
    kinds = [str(name) for name in head[2 : 2 + len(KINDS) + 1]]
    text = ["| site | tissues | " + " | ".join(kinds) + " |", "|---" * (2 + len(kinds)) + "|"]
    text += ["| " + " | ".join(str(value) for value in line[: 2 + len(kinds)]) + " |" for line in lines]
    return "\n".join(text)


def levels_table(rows: list[dict[str, Any]]) -> str:
    """Share of tissues by the level of the pad that is taken, and medians of its three shares of usable castings."""
    lines = [
        "| site | tissues | " + " | ".join([*LEVELS, "no pad", *SHARES]) + " |",
        "|---" * (3 + len(LEVELS) + len(SHARES)) + "|",
    ]
    for site in (*SITES, "all"):
        own = [row["taken"] for row in rows if site in (row["site"], "all")]
        if not own:
            continue
        levels = [row.get("level") for row in own]
        shares = [levels.count(level) / len(own) for level in (*LEVELS, None)]
        middle = [np.median([usable(row["shares"][name]) for row in own if row] or [np.nan]) for name in SHARES]
        lines.append(f"| {site} | {len(own)} | " + " | ".join(f"{one:.3f}" for one in (*shares, *middle)) + " |")
    return "\n".join(lines)


def figures(rows: list[dict[str, Any]]) -> list[list[object]]:
    """Both tables of shares in one, as ``docs/data/random-tissues.csv`` has them; the first row is the head."""
    out: list[list[object]] = [["site", "tissues", *KINDS, "any", *LEVELS]]
    for site in (*SITES, "all"):
        own = [row for row in rows if site in (row["site"], "all")]
        if not own:
            continue
        able = [{kind for kind, entry in row["kinds"].items() if entry["level"] != RED} for row in own]
        levels = [row["taken"].get("level", RED) for row in own]
        counts = [sum(kind in one for one in able) for kind in KINDS] + [sum(map(bool, able))]
        counts += [levels.count(level) for level in LEVELS]
        out.append([site, len(own), *(f"{count / len(own):.3f}" for count in counts)])
    return out


def red_words(rows: list[dict[str, Any]]) -> str:
    """Why the pads that are taken and are red are so: what most of the castings do that no ratio saves."""
    count: dict[str, int] = {}
    for row in rows:
        pad = row["taken"]
        if pad and pad["level"] == RED:
            lost = pad["shares"]["resin_known"]
            worst = max(("reads_low", "over", "out_of_reach"), key=lambda name: lost[name])
            count[worst] = count.get(worst, 0) + 1
    return "Red pads by what most castings of a measured resin do: " + (
        ", ".join(f"{name} {number}" for name, number in sorted(count.items())) or "none"
    )


def main() -> None:
    """Run what is missing of the study and print the table."""
    parser = argparse.ArgumentParser(description="Share of random tissues for which a pad is found.")
    parser.add_argument("--tissues", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20271)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "results" / "random_tissues.jsonl")
    parser.add_argument("--table-only", action="store_true")
    parser.add_argument("--csv", type=Path, default=ROOT / "docs" / "data" / "random-tissues.csv")
    options = parser.parse_args()

    known = {row["number"] for row in read_rows(options.rows) if row["seed"] == options.seed}
    for number in range(0 if options.table_only else options.tissues):
        if number not in known:
            keep_row(options.rows, study_one(number, options.seed))
    rows = [row for row in read_rows(options.rows) if row["seed"] == options.seed]
    head, *shares = figures(rows)
    write_csv(options.csv, [str(name) for name in head], shares)
    print(table(rows), levels_table(rows), red_words(rows), sep="\n\n")


if __name__ == "__main__":
    main()
