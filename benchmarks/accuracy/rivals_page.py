"""Table and figure of docs/evidence.md: ``python -m benchmarks.accuracy.rivals_page``, from rows of ``rivals``."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.accuracy.loop_blind_table import rate
from benchmarks.accuracy.rivals import RIVALS, ROWS
from benchmarks.rows import read_rows, write_evidence

ROOT = Path(__file__).resolve().parents[2]
FIGURE = ROOT / "docs" / "images" / "loop-rivals.svg"
WORDS = {
    "loop": "`loop`",
    "omp": "OMP",
    "lasso": "LASSO",
    "ard": "ARD",
    "one_at_a_time": "one at a time",
    "gaussian_process": "Gaussian process",
}
SEEN_FLOORS = 3.0
"""What an effect leaves to the base model on left-out conditions to count as one that can be seen, in noise floors."""
NAMELESS = ("gaussian_process",)
Row = dict[str, Any]


def floors(row: Row) -> float:
    """What the base model leaves beyond noise on left-out conditions, in noise floors."""
    return float(np.sqrt(max((row["base_heldout_N"] / row["floor_N"]) ** 2 - 1.4, 0.0)))


def put(row: Row) -> set[str]:
    """Names of the effects of a campaign."""
    return {name for name, _ in row["put"]}


def counted(hits: Sequence[bool]) -> str:
    """A count and its total."""
    return f"{sum(hits)} of {len(hits)}" if hits else "-"


def inside(row: Row, name: str) -> bool:
    """Whether the modulus lies in the interval."""
    low, _, high = row["rivals"][name]["young_kPa"]
    return bool(low <= row["young_kPa"] <= high)


def measures(rows: list[Row]) -> list[tuple[str, Callable[[str], str]]]:
    """Each line of the table: what it is, and its cell for a rival."""
    of = {kind: [row for row in rows if row["kind"] == kind] for kind in ("one", "two", "none")}
    seen = [row for row in of["one"] if floors(row) >= SEEN_FLOORS]

    def names(row: Row, name: str) -> list[str]:
        return list(row["rivals"][name]["names"])

    def named(hits: Callable[[str], list[bool]]) -> Callable[[str], str]:
        return lambda name: "-" if name in NAMELESS else counted(hits(name))

    def wrong(row: Row, name: str) -> bool:
        return bool(set(names(row, name)) - put(row))

    return [
        (
            "one effect: right first",
            named(lambda name: [names(row, name)[:1] == [*put(row)] for row in of["one"]]),
        ),
        (
            f"the same, {SEEN_FLOORS:.0f} floors or more",
            named(lambda name: [names(row, name)[:1] == [*put(row)] for row in seen]),
        ),
        ("one effect: a wrong name", named(lambda name: [wrong(row, name) for row in of["one"]])),
        ("two effects: both named", named(lambda name: [put(row) <= set(names(row, name)) for row in of["two"]])),
        ("two effects: a wrong name", named(lambda name: [wrong(row, name) for row in of["two"]])),
        (
            "all: exactly the right names",
            named(lambda name: [set(names(row, name)) == put(row) for row in rows]),
        ),
        ("none: a name", named(lambda name: [wrong(row, name) for row in of["none"]])),
        ("modulus in its 95 % interval", lambda name: counted([inside(row, name) for row in rows])),
        (
            "error on new pads over the base's, median",
            lambda name: f"{np.median([over_base(row, name) for row in rows if row['put']]):.2f}",
        ),
    ]


def over_floor(row: Row, name: str) -> float:
    """Error on new pads in noise floors."""
    return float(row["rivals"][name]["rmse_N"] / row["floor_N"])


def over_base(row: Row, name: str) -> float:
    """Error on new pads over that of the base model."""
    return float(row["rivals"][name]["rmse_N"] / row["base_rmse_N"])


def table(rows: list[Row]) -> str:
    """The table in Markdown."""
    lines = [f"| | {' | '.join(WORDS[name] for name in RIVALS)} |", "|---" * (len(RIVALS) + 1) + "|"]
    lines += [f"| {words} | {' | '.join(cell(name) for name in RIVALS)} |" for words, cell in measures(rows)]
    return "\n".join(lines)


def posterior(rows: list[Row]) -> str:
    """Half widths of the modulus by sampling and by the loop, a line each campaign."""
    if not rows:
        return ""

    def half(ends: Sequence[float]) -> str:
        return f"{50.0 * (ends[-1] - ends[0]) / np.mean([ends[0], ends[-1]]):.2f}"

    lines = [
        "",
        "| put in | emcee, half width % | loop's fit | stated by `loop` | true modulus in: emcee, loop | s |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        hits = [ends[0] <= row["young_kPa"] <= ends[-1] for ends in (row["emcee_kPa"], row["loop_kPa"])]
        words = ", ".join(f"{name} {size:.3g}" for name, size in row["put"])
        cells = (
            words,
            half(row["emcee_kPa"]),
            half(row["fit_kPa"]),
            half(row["loop_kPa"]),
            ", ".join("yes" if hit else "no" for hit in hits),
            f"{row['cpu_s']:.0f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def draw(rows: list[Row]) -> None:
    """Draw the error on new pads of every campaign, and the names."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {"svg.hashsalt": "rivals", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    )
    figure, (names, errors) = plt.subplots(1, 2, figsize=(8.4, 3.2), layout="constrained", sharey=True)
    place = {name: len(RIVALS) - at for at, name in enumerate(RIVALS)}
    seen = [row for row in rows if row["kind"] == "one" and floors(row) >= SEEN_FLOORS]
    for name, at in place.items():
        values = [over_floor(row, name) for row in rows if row["put"]]
        errors.plot(values, at + np.linspace(-0.25, 0.25, len(values)), ".", ms=4, color="0.55")
        errors.plot([np.median(values)] * 2, [at - 0.35, at + 0.35], color="#1f4e79", lw=2)
        if name in NAMELESS:
            continue
        right = [row["rivals"][name]["names"][:1] == [*put(row)] for row in seen]
        wrong = [bool(set(row["rivals"][name]["names"]) - put(row)) for row in rows]
        for hits, shift, colour in ((right, 0.12, "#1f4e79"), (wrong, -0.12, "#c94a1f")):
            value, low, high = rate(sum(hits), len(hits))
            names.plot([low, high], [at + shift] * 2, color=colour, lw=1.2)
            names.plot(value, at + shift, "o", ms=4, color=colour)
    names.plot([], [], "o-", ms=4, color="#1f4e79", label="right first, one visible effect")
    names.plot([], [], "o-", ms=4, color="#c94a1f", label="a wrong name, all campaigns")
    names.set_yticks(list(place.values()), [WORDS[name].strip("`") for name in place])
    names.set(xlabel="share of campaigns, 95 % interval [%]", xlim=(-2, 102))
    names.legend(frameon=False, fontsize=7, loc="lower right")
    errors.set(xlabel="error on new pads [noise floors]; line: median", xscale="log")
    errors.set_xticks([1, 2, 5, 10, 20], ["1", "2", "5", "10", "20"])
    figure.savefig(FIGURE, metadata={"Date": None})
    plt.close(figure)


def main() -> None:
    """Write table and figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=Path, default=ROWS)
    rows = sorted(read_rows(parser.parse_args().rows), key=lambda row: row["seed"])
    compared = [row for row in rows if "rivals" in row]
    write_evidence("rivals", f"{table(compared)}\n{posterior([row for row in rows if 'emcee_kPa' in row])}")
    draw(compared)
    print(table(compared))


if __name__ == "__main__":
    main()
