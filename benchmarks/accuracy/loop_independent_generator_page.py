"""The part of docs/evidence.md on the independent generator: rates, sizes from which effects are found."""

from __future__ import annotations

import csv
from pathlib import Path

from benchmarks.accuracy import loop_detection, loop_independent_generator
from benchmarks.rows import read_rows

RESULTS = Path(__file__).resolve().parents[1] / "results"
EARLIER, FURTHER, NONE, ROWS = (
    RESULTS / f"loop_independent_generator_{seed}.jsonl" for seed in (1050000, 1060000, 1420000, 1500000)
)
BEFORE = RESULTS / "loop_independent_generator_1300000.jsonl"
SIZES = RESULTS / "loop_detection.jsonl"

SECTION = """{rates}
- {more}.
- No effect, with further seeds: something is named in {false} of {none}.
- Functions without a name, with further seeds: {both} of the state are learned; a curve of the reading is named in
  {read} of {curves}.
- Named first in nine of ten campaigns from: {sizes}. At no size that was tried: {never}.
"""
MORE = (("sensor_clipping", 1042000), ("adhesion", 1044000))
"""Effects of which the study has too few, and the seeds of further campaigns with them alone."""
DROPPED = (
    *("clipping found", "adhesion found", "none: called", "one, less: a wrong name, the right", "refused"),
    *("unnamed function of the state: learned, or", "modulus inside, effects", "three: a wrong"),
    *("curve of the reading", "one, 3 floors or more: a wrong"),
    *("Half width of", "Unnamed: ", "The same beyond", "Processor"),
)
"""Rows of the table that the further campaigns show with more of them, that are zero or follow from others."""
FIELDS = ("seed", "put_in", "verdict", "named", "learned_over", "modulus_in_interval", "error_on_other_pads_over_base")
INSTANCES = ("contact_offset", "force_bias", "sensor_lag", "inertia", "machine_compliance", "punch_tilt")
STATE = ("skin", "bottom_felt", "flow_through", "creeping_hold", "cold_stiffening")


def _put(row: dict) -> str:
    return row["put"][0][0] if row["put"] else "none"


def functions() -> list[dict]:
    """Campaigns without an effect and with a function that has no name, of both studies."""
    return [row for path in (ROWS, FURTHER) for row in read_rows(path) if row["kind"] in ("none", "unnamed")]


def write_functions(path: Path) -> None:
    """Write the campaigns of :func:`functions` as CSV."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(FIELDS)
        for row in sorted(functions(), key=lambda one: (_put(one) != "none", _put(one), one["seed"])):
            low, high = row["interval_kPa"]
            writer.writerow(
                [
                    row["seed"],
                    _put(row),
                    row["verdict"],
                    " ".join(row["named"]),
                    row["learned"] or "",
                    "yes" if low <= row["young_kPa"] <= high else "no",
                    f"{row['replay_N'][1] / row['replay_N'][0]:.2f}",
                ]
            )


def rates_of(rows: list[dict]) -> str:
    """The table of a study and the lines below it."""
    out = []
    for line in loop_independent_generator.table(rows).partition("\n| effect |")[0].strip().splitlines():
        if line.removeprefix("| ").startswith(DROPPED):
            continue
        out.append(_without_rate(line) if line.startswith("|") else f"- {line}" if line else "")
    return "\n".join(out)


def section() -> str:
    """The table and what further campaigns show."""
    rows, earlier, others = read_rows(ROWS), read_rows(EARLIER), read_rows(FURTHER)
    more: list[str] = []
    further: list[dict] = []
    for name, seed in MORE:
        own = read_rows(RESULTS / f"loop_independent_generator_{seed}.jsonl")
        further += own
        missed = sorted(row["put"][0][1] for row in own if row["named"][:1] != [name])
        sizes = f" (missed at {' and '.join(f'{size:.2g}' for size in missed)})" if missed else ""
        more.append(f"`{name}` alone is right first in {len(own) - len(missed)} of {len(own)}{sizes}")
    known = [*read_rows(SIZES), *loop_detection.singles([*earlier, *further])]
    none = [row for row in [*read_rows(NONE), *others, *rows, *read_rows(BEFORE)] if row["kind"] == "none"]
    curves = [row for row in others if _put(row) in loop_independent_generator.READINGS]
    return SECTION.format(
        rates=rates_of(rows),
        more="; ".join(more),
        none=len(none),
        false=_false(none),
        curves=len(curves),
        read=sum("sensor_curve" in row["named"] for row in curves),
        both=_learned_of([*rows, *others]),
        **_sizes(loop_detection.lines_of(loop_detection.detection(known))),
    )


def _false(rows: list[dict]) -> int:
    """In how many something is named or learned."""
    return sum(bool(row["named"] or row["learned"]) for row in rows)


def _learned_of(rows: list[dict]) -> str:
    """How many functions of the state are learned."""
    state = [row for row in rows if _put(row) in STATE]
    return f"{sum(row['learned'] is not None for row in state)} of {len(state)}"


def _without_rate(line: str) -> str:
    """A row of the table without its rate in per cent, which counts and interval say."""
    cells = line.split("|")
    return "|".join([*cells[:3], *cells[4:]])


def _sizes(lines: list[list[str]]) -> dict[str, str]:
    """Sizes of some effects, and the names of those that are not found at any size."""
    sizes = {line[0]: line[3] for line in lines}
    named = (f"`{name}` {sizes[name]}" for name in INSTANCES)
    return {
        "sizes": ", ".join(named),
        "never": ", ".join(f"`{name}`" for name, size in sizes.items() if size.startswith("above")),
    }
