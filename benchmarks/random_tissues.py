"""For how many tissues a pad is found, by kind of shape: ``python benchmarks/random_tissues.py``; about 8 s each.

Tissues are drawn from the posterior of the built-in ones, one after the other: a draw is five persons. The shapes are
searched by their tables, without finite elements, with the default resin. The pad that is taken is chosen by what is
expected of its castings, the five persons as five that were measured; its verdict is that of an answer, over 1200
castings, and once more with modulus and relaxation of the resin known. Every tissue is kept in ``--rows`` (one JSON
object a line), so that a study can be stopped and resumed; the tables are printed, and written to ``--csv``.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from benchmarks.rows import keep_row, read_rows, write_csv  # noqa: E402
from dummydesign.core.errors import NoAnswerError  # noqa: E402
from dummydesign.design.assessment.pad_castings import PadCastings, verdict_of_design
from dummydesign.design.scoring.castings import RESIN
from dummydesign.design.request import Request  # noqa: E402
from dummydesign.design.scoring.targets import make_targets  # noqa: E402
from dummydesign.design.scoring.verdict import LEVELS, NOT_ACCEPTABLE, ranges_of, readings_of, verdict  # noqa: E402
from MISSING.dummydesign.design.search.best_of_kinds import best_of_kinds
from MISSING.dummydesign.design.suggest import Inputs
from dummydesign.design.problem import read_problem
from dummydesign.design.suggest import SolvedDesign, solve
from dummydesign.design.suggestion import tolerances_of  # noqa: E402
from dummydesign.tissue.model.posterior import COLUMNS, read_draws, subject_of  # noqa: E402

SITES = ("forefinger", "palm", "thenar")


def drawn_tissue(tissue, site: str, rng: np.random.Generator):
    """A tissue of the five persons of one draw of a site's posterior, drawn by its weight, and the draw's number."""
    draws, weight = read_draws(ROOT / "materials" / "tissues" / f"{site}_draws.csv")
    number = int(rng.choice(len(draws), p=weight / weight.sum()))
    kinds = [("measured", f"draw {number} of the posterior of {site}")] * len(COLUMNS)
    subjects = tuple(subject_of(f"person-{k + 1}", row, row, row, kinds) for k, row in enumerate(draws[number]))
    return replace(tissue, name=f"{site}-{number}", subjects=subjects), number


def study_one(number: int, seed: int) -> dict[str, object]:
    """Search one random tissue: the best of each kind of shape by central estimates, and the pad that is taken."""
    started = time.process_time()
    site = SITES[number % len(SITES)]
    inputs = read_problem(Request(site, verify=False))
    tissue, draw = drawn_tissue(inputs.tissue, site, np.random.default_rng([seed, number]))
    space = replace(inputs.space, targets=make_targets(tissue, "average", inputs.space.sampling))
    inputs = replace(inputs, tissue=tissue, space=space)
    kinds: dict[str, list[float]] = {}
    taken: dict[str, object] = {}
    try:
        result = best_of_kinds("auto", inputs.slab_law, space)
        designs = [(shaped.shape.name, shaped.result.best) for shaped in result.designs]
        designs += [] if result.slab is None else [("slab", result.slab.result.best)]
        taken = taken_pad(inputs, solve(inputs, result))
    except NoAnswerError:
        designs = []
    for kind, best in designs:
        entry = kinds.setdefault(kind, [0, 0.0])
        entry[:] = max(entry, [best.rank, round(best.total, 4)])
    row = {"number": number, "seed": seed, "site": site, "draw": draw, "kinds": kinds, "taken": taken}
    return {**row, "cpu_seconds": round(time.process_time() - started, 1)}


def taken_pad(inputs: Inputs, solved: SolvedDesign) -> dict[str, object]:
    """The pad that is taken: its verdict, and what it would be once modulus and relaxation are known."""
    space, chosen, request = inputs.space, solved.chosen, inputs.request
    best = chosen.result.best
    tolerances = tolerances_of(space.resin, best, request, chosen.shape)
    cast = PadCastings(inputs.castings, chosen.cast, best, space, tolerances)
    now = verdict_of_design(cast)
    own = readings_of(best.evaluation, best.index)
    known = verdict(ranges_of(space.targets), own, cast.readings(RESIN), limits=space.targets.limits)
    return {
        "kind": chosen.shape.name, "shape": str(chosen.shape), "thickness_mm": best.thickness_mm, "ratio": best.ratio,
        "rank": best.rank, "total": round(best.total, 4), "differs": solved.expectation.differs,
        "level": now.level, "reads": now.reads, "shortfall": _ends(now.shortfall), "over": _ends(now.over),
        "castings": _shares(now.castings), "factor": _short(now.correction.factor),
        "measured": {"level": known.level, "shortfall": _ends(known.shortfall), "over": _ends(known.over),
                     "castings": _shares(known.castings), "factor": _short(now.correction.factor_after_measuring)},
    }  # fmt: skip


def _short(value: float | None) -> float | None:
    return None if value is None else round(value, 4)


def _ends(deviation) -> list:
    """Central, 95 % and quantity of a shortfall or an over-reading."""
    return [_short(deviation.central), _short(deviation.q95), deviation.quantity]


def _shares(castings: dict[str, float] | None) -> dict[str, float]:
    return {name: round(share, 4) for name, share in (castings or {}).items()}


def table(rows: list[dict]) -> str:
    """Share of tissues with a pad that is not red at central estimates, by site and kind."""
    kinds = sorted({kind for row in rows for kind in row["kinds"]})
    lines = ["| site | tissues | " + " | ".join([*kinds, "any"]) + " |", "|---" * (3 + len(kinds)) + "|"]
    for site in (*SITES, "all"):
        own = [row["kinds"] for row in rows if site in (row["site"], "all")]
        shares = [np.mean([row.get(kind, (0,))[0] > NOT_ACCEPTABLE for row in own]) for kind in kinds]
        shares.append(np.mean([any(entry[0] > NOT_ACCEPTABLE for entry in row.values()) for row in own]))
        lines.append(f"| {site} | {len(own)} | " + " | ".join(f"{share:.3f}" for share in shares) + " |")
    return "\n".join(lines)


def levels_table(rows: list[dict]) -> str:
    """Share of tissues by the level of the pad that is taken: as the resin is known, and once it is measured."""
    lines = ["| site | tissues | resin | " + " | ".join(LEVELS) + " | no pad |", "|---" * (4 + len(LEVELS)) + "|"]
    for site in (*SITES, "all"):
        own = [row["taken"] for row in rows if site in (row["site"], "all")]
        for words, levels in (
            ("as it is known", [row.get("level") for row in own]),
            ("once measured", [row["measured"]["level"] if row else None for row in own]),
        ):
            shares = [levels.count(level) / len(own) for level in (*LEVELS, None)]
            lines.append(f"| {site} | {len(own)} | {words} | " + " | ".join(f"{share:.3f}" for share in shares) + " |")
    return "\n".join(lines)


def figures(rows: list[dict]) -> list[list[object]]:
    """Both tables of shares in one, as ``docs/data/random-tissues.csv`` has them; the first row is the head."""
    kinds = ["slab", "bumped", "crowned", "layered", "boned"]
    out: list[list[object]] = [[
        "site", "tissues", *kinds, "any", "usable_with_correction_resin_as_known", "not_settled_resin_as_known",
        "stands_for_resin_measured", "usable_with_correction_resin_measured", "not_settled_resin_measured",
        "not_representative",
    ]]  # fmt: skip
    for site in (*SITES, "all"):
        own = [row for row in rows if site in (row["site"], "all")]
        able = [{kind for kind, entry in row["kinds"].items() if entry[0] > NOT_ACCEPTABLE} for row in own]
        now, known = [row["taken"]["level"] for row in own], [row["taken"]["measured"]["level"] for row in own]
        counts = [sum(kind in one for one in able) for kind in kinds] + [sum(map(bool, able))]
        counts += [now.count("usable_with_correction"), now.count("not_settled"), known.count("stands_for")]
        counts += [known.count("usable_with_correction"), known.count("not_settled"), known.count("not_representative")]
        out.append([site, len(own), *(f"{count / len(own):.3f}" for count in counts)])
    return out


def taken_table(rows: list[dict]) -> str:
    """Medians of what the pads that are taken do, by site and kind, and for how many the pad is of that kind."""
    groups = [(site, None) for site in (*SITES, "all")]
    kinds = sorted({row["taken"]["kind"] for row in rows if row["taken"]})
    groups += [("all", kind) for kind in kinds]
    words = (
        "shortfall, 95 %", "over, 95 %", "total", "usable castings", "out of reach", "shortfall, 95 % once measured",
        "usable once measured",
    )  # fmt: skip
    lines = ["| site | kind | pads | " + " | ".join(words) + " |", "|---" * (3 + len(words)) + "|"]
    for site, kind in groups:
        own = [row["taken"] for row in rows if site in (row["site"], "all") and row["taken"]]
        own = [row for row in own if kind in (None, row["kind"])]
        columns = [
            *(f"{_middle(row[name][0] for row in own):.2f}, {_middle(row[name][1] for row in own):.2f}"
              for name in ("shortfall", "over")),
            f"{_middle(row['total'] for row in own):.2f}",
            f"{_middle(_usable(row) for row in own):.2f}",
            f"{_middle(row['castings']['out_of_reach'] for row in own):.2f}",
            f"{_middle(row['measured']['shortfall'][1] for row in own):.2f}",
            f"{_middle(_usable(row['measured']) for row in own):.2f}",
        ]  # fmt: skip
        lines.append(f"| {site} | {kind or 'any'} | {len(own)} | " + " | ".join(columns) + " |")
    return "\n".join(lines)


def red_words(rows: list[dict]) -> str:
    """Why the pads that are taken and are red at central estimates are so: the quantity and the side."""
    count: dict[str, int] = {}
    for row in rows:
        pad = row["taken"]
        if pad and pad["level"] == "not_representative":
            short, over = pad["shortfall"], pad["over"]
            worst = f"shortfall of {short[2]}" if short[0] / 1.10 >= over[0] / 1.25 else f"over-reading of {over[2]}"
            count[worst] = count.get(worst, 0) + 1
    return "Red pads by their worst quantity: " + (", ".join(f"{k} {v}" for k, v in sorted(count.items())) or "none")


def _usable(row: dict) -> float:
    return row["castings"]["stands_for"] + row["castings"]["usable"]


def _middle(values) -> float:
    known = [value for value in values if value is not None]
    return float(np.median(known)) if known else float("nan")


def main() -> None:
    """Run what is missing of the study and print the table."""
    parser = argparse.ArgumentParser(description="Share of random tissues for which a pad is found.")
    parser.add_argument("--tissues", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20271)
    parser.add_argument("--rows", type=Path, default=ROOT / "benchmarks" / "random_tissues.jsonl")
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
    print(table(rows), levels_table(rows), taken_table(rows), red_words(rows), sep="\n\n")


if __name__ == "__main__":
    main()
