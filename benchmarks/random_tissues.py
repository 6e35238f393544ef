"""For how many tissues a pad is found, by kind of shape: ``python benchmarks/random_tissues.py``; about 8 s each.

Tissues are drawn from the posterior of the built-in ones, one after the other: a draw is five persons. The shapes are
searched by their tables, without finite elements, with the default resin. The pad that is taken is chosen by what is
expected of its castings, the five persons as five that were measured. Every tissue is kept in ``--rows`` (one JSON
object a line), so that a study can be stopped and resumed; the tables are printed.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from dummydesign.design.scoring.standing import ACCEPTABLE, ACCEPTABLE_AND_STEADY  # noqa: E402

from benchmarks.rows import keep_row, read_rows  # noqa: E402
from dummydesign.core.errors import NoAnswerError  # noqa: E402
from dummydesign.design.inputs import resolve  # noqa: E402
from dummydesign.design.request import Request  # noqa: E402
from dummydesign.design.scoring.targets import make_targets  # noqa: E402
from dummydesign.design.search.best_of_kinds import best_of_kinds  # noqa: E402
from dummydesign.design.solve import solve  # noqa: E402
from dummydesign.tissue.population.posterior import COLUMNS, read_draws, subject_of  # noqa: E402

SITES = ("forefinger", "palm", "thenar")


def drawn_tissue(tissue, site: str, rng: np.random.Generator):
    """A tissue of the five persons of one draw of a site's posterior, drawn by its weight, and the draw's number."""
    draws, weight = read_draws(ROOT / "materials" / "tissues" / f"{site}_draws.csv")
    number = int(rng.choice(len(draws), p=weight / weight.sum()))
    kinds = [("measured", f"draw {number} of the posterior of {site}")] * len(COLUMNS)
    subjects = tuple(subject_of(f"person-{k + 1}", row, row, row, kinds) for k, row in enumerate(draws[number]))
    return replace(tissue, name=f"{site}-{number}", subjects=subjects), number


def study_one(number: int, seed: int) -> dict[str, object]:
    """Search one random tissue: the best standing of each kind of shape, and the best total."""
    site = SITES[number % len(SITES)]
    inputs = resolve(Request(site, verify=False))
    tissue, draw = drawn_tissue(inputs.tissue, site, np.random.default_rng([seed, number]))
    space = replace(inputs.space, targets=make_targets(tissue, "average", inputs.space.sampling))
    found: dict[str, list[float]] = {}
    taken: dict[str, object] = {}
    try:
        result = best_of_kinds("auto", inputs.slab_law, space)
        designs = [(shaped.shape.name, shaped.found.best) for shaped in result.designs]
        designs += [] if result.slab is None else [("slab", result.slab.best)]
        solved = solve(replace(inputs, tissue=tissue, space=space), result)
        expected, best = solved.expectation, solved.chosen.found.best
        taken = {"kind": solved.chosen.shape.name, "thickness_mm": best.thickness_mm, "ratio": best.ratio,
                 "standing": best.standing, "differs": expected.differs,
                 "acceptable_fraction": round(expected.taken.acceptable_fraction, 4),
                 "middle_acceptable_fraction": round(expected.middle.acceptable_fraction, 4)}  # fmt: skip
    except NoAnswerError:
        designs = []
    for kind, best in designs:
        entry = found.setdefault(kind, [0, 0.0])
        entry[:] = [max(entry[0], best.standing), max(entry[1], round(best.total, 4))]
    return {"number": number, "seed": seed, "site": site, "draw": draw, "kinds": found, "taken": taken}


def table(rows: list[dict]) -> str:
    """Shares by site and kind: acceptable, and acceptable inside the steady range at 5, 10 and 15 N."""
    kinds = sorted({kind for row in rows for kind in row["kinds"]})
    lines = ["| site | tissues | share of | " + " | ".join([*kinds, "any"]) + " |", "|---" * (4 + len(kinds)) + "|"]
    for site in (*SITES, "all"):
        own = [row["kinds"] for row in rows if site in (row["site"], "all")]
        for words, least in (("acceptable", ACCEPTABLE), ("and in the steady range", ACCEPTABLE_AND_STEADY)):
            shares = [np.mean([row.get(kind, (0,))[0] >= least for row in own]) for kind in kinds]
            shares.append(np.mean([any(entry[0] >= least for entry in row.values()) for row in own]))
            lines.append(f"| {site} | {len(own)} | {words} | " + " | ".join(f"{s:.2f}" for s in shares) + " |")
    return "\n".join(lines)


def taken_table(rows: list[dict]) -> str:
    """Of the pad that is taken by expectation: shares by site, and its castings beside the best in the middle's."""
    words = ("acceptable", "and in the steady range", "another than the best in the middle")
    lines = ["| site | tissues | " + " | ".join(words) + " | castings acceptable | of the best in the middle |",
             "|---" * 7 + "|"]  # fmt: skip
    for site in (*SITES, "all"):
        every = [row["taken"] for row in rows if site in (row["site"], "all")]
        own = [row for row in every if row]
        if not own:
            continue
        shares = [
            sum(row["standing"] >= ACCEPTABLE for row in own) / len(every),
            sum(row["standing"] >= ACCEPTABLE_AND_STEADY for row in own) / len(every),
            sum(row["differs"] for row in own) / len(every),
            *(float(np.mean([row[f"{who}acceptable_fraction"] for row in own])) for who in ("", "middle_")),
        ]
        lines.append(f"| {site} | {len(every)} | " + " | ".join(f"{share:.2f}" for share in shares) + " |")
    return "\n".join(lines)


def main() -> None:
    """Run what is missing of the study and print the table."""
    parser = argparse.ArgumentParser(description="Share of random tissues for which a pad is found.")
    parser.add_argument("--tissues", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20262)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "random_tissues.jsonl")
    parser.add_argument("--table-only", action="store_true")
    options = parser.parse_args()

    known = {row["number"] for row in read_rows(options.rows) if row["seed"] == options.seed}
    for number in range(0 if options.table_only else options.tissues):
        if number not in known:
            keep_row(options.rows, study_one(number, options.seed))
    rows = read_rows(options.rows)
    print(table(rows), taken_table(rows), sep="\n\n")


if __name__ == "__main__":
    main()
