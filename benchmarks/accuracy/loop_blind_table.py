"""The first generator's part of docs/evidence.md, and its data files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from benchmarks.accuracy.loop_campaigns import COUNTS
from benchmarks.rows import read_rows

BEFORE = Path(__file__).resolve().parents[1] / "results" / "loop_blind_746000.jsonl"

SHARED_LAW = ("contact_offset", "inertia", "force_bias", "time_skew", "thickness_error")
"""Effects whose law is the same in generator and vocabulary: their intervals can be tested."""
OF_THE_STATE = ("poroelastic", "ringing", "saturation", "stiffness_bump")
"""Effects outside the vocabulary that depend on depth, force or time since the stop; the others do not."""
Row = dict
Test = Callable[[Row], bool]


HEADS = {
    "loop-blind": ("quantity", "count", "total", "percent", "low_95_percent", "high_95_percent", "wanted"),
    "loop-blind-errors": ("campaigns", "quantity", "median", "quantile_90"),
    "loop-blind-effects": ("effect", "campaigns", "named_first", "otherwise"),
    "loop-blind-missed": ("put_in", "named", "verdict", "noise_floors_on_new_pads_without_their_own_part"),
    "loop-blind-unnamed": ("effect", "campaigns", "unexplained", "learned", "named", "reasons"),
}
"""Columns of the data files."""
Measure = tuple[str, int, int, str]
"""What is counted, the count, the total, and the rate that is wanted."""


def rate(count: int, total: int) -> tuple[float, float, float]:
    """A rate and its 95 % interval (Wilson). [%]"""
    p, z2 = count / total, 1.96**2
    middle, half = p + z2 / (2 * total), 1.96 * np.sqrt(p * (1 - p) / total + z2 / (4 * total**2))
    low, high = (abs(middle + sign * half) / (1 + z2 / total) for sign in (-1, 1))
    return 100 * p, 100 * low, 100 * high


def right(row: Row) -> int:
    """How many of the effects that were put in were named."""
    return len(set(row["effects"]) & set(row["found"]))


def wrong(row: Row) -> bool:
    """Whether an effect was named that was not put in."""
    return bool(set(row["found"]) - set(row["effects"]))


def named_or_rival(row: Row) -> bool:
    """Whether each effect that was put in was named, or named as a rival of one that was."""
    return set(row["effects"]) <= set(row["found"]).union(*row["confounded"])


def silent(row: Row) -> bool:
    """Whether more than two noise floors beyond the pad-to-pad part were left without being called unexplained."""
    return row["verdict"] != "unexplained" and row["replay"][2] > 2.0 * row["floor"]


def learned(row: Row) -> bool:
    """Whether a remainder was learned."""
    return any("was learned" in reason for reason in row["reasons"])


def by_kind(rows: list[Row]) -> dict[str, list[Row]]:
    """Campaigns of each kind; those that the reader refused count in none."""
    return {kind: [row for row in rows if row["kind"] == kind] for kind in (*COUNTS, "unnamed")}


def measures(rows: list[Row]) -> Iterator[Measure]:
    """Everything that is counted."""
    kinds = by_kind(rows)

    def measure(name: str, kind: str, test: Test, wanted: str = "") -> Measure:
        return f"{kind}: {name}", sum(map(test, kinds[kind])), len(kinds[kind]), wanted

    yield measure("an effect named", "none", lambda r: bool(r["found"]), "<= 3 %")
    yield measure("right first", "one", lambda r: r["found"][:1] == r["effects"], ">= 90 %")
    yield measure("right first or among its rivals", "one", named_or_rival)
    yield measure("both named", "two", lambda r: right(r) == 2, ">= 85 %")
    yield measure("one named", "two", lambda r: right(r) == 1)
    yield measure("all named", "three", lambda r: right(r) == 3, ">= 65 %")
    yield measure("at least two named", "three", lambda r: right(r) >= 2, ">= 90 %")
    for kind, wanted in (("one", ""), ("two", "<= 5 %"), ("three", "")):
        yield measure("a wrong name", kind, wrong, wanted)
        if kind != "one":
            name = "a wrong name, the right one not its rival"
            yield measure(name, kind, lambda r: wrong(r) and not named_or_rival(r))
    yield measure("an effect of the vocabulary named", "unnamed", lambda r: bool(r["found"]))
    for kind in kinds:
        wanted = ">= 95 %" if kind == "unnamed" else ""
        yield measure("called unexplained", kind, lambda r: r["verdict"] == "unexplained", wanted)
    yield from _by_nature(kinds["unnamed"])
    for kind in kinds:
        yield measure("silent", kind, silent, "0")
    inside = [row for row in rows if row["kind"] in COUNTS]
    explained = [row for row in inside if row["verdict"] != "unexplained"]
    for label, own in (("modulus", inside), ("modulus, not called unexplained", explained)):
        covered = sum(row["young"][1] <= row["young"][0] <= row["young"][2] for row in own)
        yield f"{label}: in its 95 % interval", covered, len(own), "90 to 98 %"
    alone = [row for row in inside if set(row["effects"]) <= set(SHARED_LAW)]
    shared = [("size of effects of the same law", SHARED_LAW, inside), ("size, only such effects", SHARED_LAW, alone)]
    for label, names, own in [*shared, *((f"size of {name}", (name,), inside) for name in SHARED_LAW)]:
        inside_interval = _covered(own, names)
        wanted = "90 to 98 %" if label == shared[0][0] else ""
        yield f"{label}: in its 95 % interval", sum(inside_interval), len(inside_interval), wanted


def visible(rows: list[Row]) -> str:
    """Rates of campaigns with one effect that can be seen, as lines."""
    tests: tuple[tuple[str, Test], ...] = (
        ("right first", lambda r: r["found"][:1] == r["effects"]),
        ("a wrong name", wrong),
        ("called unexplained", lambda r: r["verdict"] == "unexplained"),
        ("silent", silent),
        ("modulus in its interval", lambda r: r["young"][1] <= r["young"][0] <= r["young"][2]),
    )
    lines = []
    for name, test in tests:
        _, low, high = rate(sum(map(test, rows)), len(rows))
        lines.append(f"{name}: {sum(map(test, rows))} of {len(rows)} ({low:.0f} to {high:.0f} %)")
    odd = [f"{r['seed']} {r['effects'][0]} {r['sizes'][0]:.3g}" for r in rows if r["verdict"] == "unexplained"]
    slowest = max(row["cpu_seconds"] for row in rows)
    return "\n".join([*lines, f"unexplained: {', '.join(odd)}", f"processor seconds, largest: {slowest}"])


def rates(rows: list[Row]) -> list[tuple]:
    """What is counted, the count, the total, the rate with its interval, and the rate that is wanted."""
    return [
        (name, count, total, *(f"{part:.0f}" for part in rate(count, total)), wanted)
        for name, count, total, wanted in measures(rows)
        if total
    ]


def data(rows: list[Row]) -> dict[str, list[tuple]]:
    """Rows of the data files, without heads."""
    kinds = by_kind(rows)
    return {
        "loop-blind": rates(rows),
        "loop-blind-errors": _errors(kinds),
        "loop-blind-effects": _by_effect(kinds["one"]),
        "loop-blind-missed": _missed(kinds),
        "loop-blind-unnamed": _unnamed(kinds["unnamed"]),
    }


def table(rows: list[Row]) -> str:
    """The part of the page on the first generator."""
    counted = rates(rows)
    lines = ["| | found | 95 % | wanted |", "|---|---|---|---|"]
    for name, count, total, _, low, high, wanted in counted:
        if wanted and not name.endswith(LESS):
            lines.append(f"| {name} | {count} of {total} | {low} to {high} | {wanted} |")
    quiet = [row for row in counted if row[0].endswith("silent")]
    lines += [f"| any: silent | {sum(row[1] for row in quiet)} of {sum(row[2] for row in quiet)} | | 0 |", ""]
    single = (f"`{name}`" for name, total, first, _ in _by_effect(by_kind(rows)["one"]) if first < total)
    lines.append(f"- Not named first: {', '.join(single)}.")
    of = by_kind(read_rows(BEFORE))
    every = ((1, "one"), (2, "two"), (3, "three"))
    counts = [f"{sum(right(row) == size for row in of[kind])} of {len(of[kind])}" for size, kind in every]
    lines.append(
        f"- Another seed (746000): {', '.join(counts)} for one, two and three effects; of two a wrong name in "
        f"{sum(map(wrong, of['two']))} of {len(of['two'])}."
    )
    return "\n".join(lines) + "\n"


LESS = (
    "silent",
    "at least two named",
    "of the state: called unexplained",
    "nothing learned",
    "unexplained: in its 95 % interval",
)
"""Ends of names that only the data file has, or that are counted together."""


def _by_nature(rows: list[Row]) -> Iterator[Measure]:
    """Effects outside the vocabulary: those of the state are to be learned, the others to be flagged only."""
    state = [row for row in rows if row["effects"][0] in OF_THE_STATE]
    other = [row for row in rows if row not in state]
    flagged = sum(row["verdict"] == "unexplained" for row in state)
    alone = sum(row["verdict"] == "unexplained" and not learned(row) for row in other)
    halved = sum(row["heldout"][1] / row["heldout"][0] <= 0.5 for row in state)
    yield "unnamed, of the state: called unexplained", flagged, len(state), ">= 95 %"
    yield "unnamed, of the state: a function learned", sum(map(learned, state)), len(state), ""
    yield "unnamed, of the state: left-out error at most half of the base model's", halved, len(state), ""
    yield "unnamed, others: called unexplained, nothing learned", alone, len(other), ">= 95 %"


def _covered(rows: list[Row], names: tuple[str, ...]) -> list[bool]:
    """For each of these effects that was put in and named, whether its size was inside its interval."""
    out = []
    for row in rows:
        for name, size in zip(row["effects"], row["sizes"]):
            if name in names and name in row["intervals"]:
                low, _, high = row["intervals"][name]
                out.append(bool(min(abs(low), abs(high)) <= abs(size) <= max(abs(low), abs(high))))
    return out


QUANTITIES = (
    "left out, base",
    "left out, corrected",
    "new pads, base",
    "new pads, corrected",
    "without the pads' own part",
    "processor seconds",
)


def _errors(kinds: dict[str, list[Row]]) -> list[tuple]:
    """Median and 90 % quantile of errors over the noise floor, base and corrected model, and of processor seconds."""
    out = []
    for kind, rows in kinds.items():
        floor = np.array([row["floor"] for row in rows])
        errors = np.array([[*row["heldout"], *row["replay"]] for row in rows], float).reshape(len(rows), -1)
        seconds = np.array([row["cpu_seconds"] for row in rows])
        for name, values in zip(QUANTITIES, (*(errors / floor[:, None]).T, seconds)):
            digits = 1 if name == QUANTITIES[-1] else 2
            out.append((kind, name, f"{np.median(values):.{digits}f}", f"{np.quantile(values, 0.9):.{digits}f}"))
    return out


def _by_effect(rows: list[Row]) -> list[tuple]:
    out = []
    for name in sorted({row["effects"][0] for row in rows}):
        own = [row for row in rows if row["effects"] == [name]]
        missed = [row for row in own if row["found"][:1] != [name]]
        other = ", ".join(sorted({row["found"][0] if row["found"] else f"verdict {row['verdict']}" for row in missed}))
        out.append((name, len(own), len(own) - len(missed), other))
    return out


def _missed(kinds: dict[str, list[Row]]) -> list[tuple]:
    """Every campaign of two or three in which not all was named, or something wrong."""
    return [
        (", ".join(row["effects"]), ", ".join(row["found"]), row["verdict"], f"{row['replay'][2] / row['floor']:.1f}")
        for row in (*kinds["two"], *kinds["three"])
        if right(row) < len(row["effects"]) or wrong(row)
    ]


def _unnamed(rows: list[Row]) -> list[tuple]:
    out = []
    for name in sorted({row["effects"][0] for row in rows}):
        own = [row for row in rows if row["effects"] == [name]]
        seen = sum(row["verdict"] == "unexplained" for row in own)
        named = ", ".join(sorted({effect for row in own for effect in row["found"]}))
        why = "; ".join(sorted({_short(reason) for row in own for reason in row["reasons"]}))
        out.append((name, len(own), seen, sum(map(learned, own)), named, why))
    return out


def _short(reason: str) -> str:
    for known in ("lack of fit", "left-out conditions"):
        if reason.startswith(known):
            return known
    return reason.split(":")[0].split(" (")[0]
