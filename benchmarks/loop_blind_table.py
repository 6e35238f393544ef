"""The tables of the loop's blind study."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from benchmarks.loop_campaigns import COUNTS, FLOORS, REFUSED

SHARED_LAW = ("contact_offset", "inertia", "force_bias", "time_skew", "thickness_error")
"""Effects whose law is the same in generator and vocabulary: their intervals can be tested."""
OF_THE_STATE = ("poroelastic", "ringing", "saturation", "stiffness_bump")
"""Effects outside the vocabulary that depend on depth, force or time since the stop; the others do not."""
Row = dict
Test = Callable[[Row], bool]


def share(count: int, total: int) -> str:
    """A count out of a total, with the 95 % interval of the rate (Wilson)."""
    if not total:
        return "-"
    p, z2 = count / total, 1.96**2
    middle, half = p + z2 / (2 * total), 1.96 * np.sqrt(p * (1 - p) / total + z2 / (4 * total**2))
    low, high = (abs(middle + sign * half) / (1 + z2 / total) for sign in (-1, 1))
    return f"{count} / {total} ({100 * p:.0f} %, {100 * low:.0f} to {100 * high:.0f})"


def right(row: Row) -> int:
    """How many of the effects that were put in were named."""
    return len(set(row["effects"]) & set(row["found"]))


def wrong(row: Row) -> bool:
    """Whether an effect was named that was not put in."""
    return bool(set(row["found"]) - set(row["effects"]))


def said_or_near(row: Row) -> bool:
    """Whether each effect that was put in was named, or named as a rival of one that was."""
    return set(row["effects"]) <= set(row["found"]).union(*row["confounded"])


def silent(row: Row) -> bool:
    """Whether more than two noise floors beyond the pad-to-pad part were left without being called unexplained."""
    return row["verdict"] != "unexplained" and row["replay"][2] > 2.0 * row["floor"]


def learned(row: Row) -> bool:
    """Whether a remainder was learned."""
    return any("was learned" in reason for reason in row["reasons"])


def table(rows: list[Row]) -> str:
    """The published page."""
    every, rows = rows, [row for row in rows if row["kind"] != REFUSED]
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in (*COUNTS, "unnamed")}
    lines = [
        "# Blind study of the loop", "",
        "Simulated campaigns only (tests/support/campaign_generator.py, which shares no code with the effects).",
        f"Made by `python benchmarks/loop_blind.py --seed {min(row['seed'] for row in rows)}`; one row per campaign is "
        "kept in benchmarks/loop_blind.jsonl.",
        f"{len(rows)} campaigns, seeds {_ranges(rows)}, run once. In brackets the rate and its 95 % interval.",
        *(f"Seed {row['seed']} ({', '.join(row['effects'])}) was refused before the loop: {row['message']}."
          for row in every if row["kind"] == REFUSED), "",
        "One effect: each of the vocabulary in turn, at its usual size, doubled, halved. Two and three: drawn from the "
        f"{len(FLOORS)} that can be made large, each of a size that alone would leave 3 to 8 noise floors on left-out "
        "conditions.", "",
    ]  # fmt: skip
    lines += ["| | counted | wanted |", "|---|---|---|"]

    def measure(name: str, kind: str, test: Test, wanted: str = "") -> None:
        counted = sum(map(test, kinds[kind]))
        lines.append(f"| {name} | {share(counted, len(kinds[kind]))} | {wanted} |")

    measure("none: something named", "none", lambda r: bool(r["found"]), "<= 3 %")
    measure("none: called unexplained", "none", lambda r: r["verdict"] == "unexplained")
    measure("one: right first", "one", lambda r: r["found"][:1] == r["effects"], ">= 90 %")
    measure("one: right first or among its rivals", "one", said_or_near)
    measure("one: a wrong name", "one", wrong)
    measure("two: both named", "two", lambda r: right(r) == 2, ">= 85 %")
    measure("two: one named", "two", lambda r: right(r) == 1)
    measure("two: a wrong name", "two", wrong, "<= 5 %")
    measure("three: all named", "three", lambda r: right(r) == 3, ">= 65 %")
    measure("three: two at least", "three", lambda r: right(r) >= 2, ">= 90 %")
    measure("three: a wrong name", "three", wrong)
    measure("unnamed: called unexplained", "unnamed", lambda r: r["verdict"] == "unexplained", ">= 95 %")
    measure("unnamed: an effect of the vocabulary named", "unnamed", lambda r: bool(r["found"]))
    lines += _by_nature(kinds["unnamed"])
    for kind in kinds:
        measure(f"{kind}: `effect` or `none` with more than two noise floors left on other pads", kind, silent, "0")
    for kind in COUNTS:
        if kind != "none":
            measure(f"{kind}: called unexplained", kind, lambda r: r["verdict"] == "unexplained")
    inside = [row for row in rows if row["kind"] != "unnamed"]
    covered = sum(row["young"][1] <= row["young"][0] <= row["young"][2] for row in inside)
    name = "modulus within its 95 % interval, without unnamed effects"
    lines.append(f"| {name} | {share(covered, len(inside))} | 90 to 98 % |")
    told = [row for row in inside if row["verdict"] != "unexplained"]
    covered = sum(row["young"][1] <= row["young"][0] <= row["young"][2] for row in told)
    lines.append(f"| of these not called unexplained | {share(covered, len(told))} | 90 to 98 % |")
    for names in (SHARED_LAW, *((name,) for name in SHARED_LAW)):
        label = "size within its 95 % interval" if names == SHARED_LAW else "of these"
        covered, wanted = _covered(inside, names), "90 to 98 %" if names == SHARED_LAW else ""
        lines.append(f"| {label} ({', '.join(names)}) | {share(sum(covered), len(covered))} | {wanted} |")
    covered = _covered([row for row in inside if set(row["effects"]) <= set(SHARED_LAW)], SHARED_LAW)
    lines.append(f"| of all these beside no effect of another law | {share(sum(covered), len(covered))} | |")
    lines += _errors(kinds) + _by_effect(kinds["one"]) + _missed(kinds) + _unnamed(kinds["unnamed"])
    return "\n".join(lines) + "\n"


def _by_nature(rows: list[Row]) -> list[str]:
    """Effects outside the vocabulary: those of the state are to be learned, the others to be flagged only."""
    state = [row for row in rows if row["effects"][0] in OF_THE_STATE]
    other = [row for row in rows if row not in state]
    flagged = sum(row["verdict"] == "unexplained" for row in state)
    alone = sum(row["verdict"] == "unexplained" and not learned(row) for row in other)
    names = ", ".join(sorted({row["effects"][0] for row in other}))
    out = [
        f"| unnamed, of the state ({', '.join(OF_THE_STATE)}): flagged | {share(flagged, len(state))} | >= 95 % |",
        f"| of these: something learned | {share(sum(map(learned, state)), len(state))} |  |",
        f"| unnamed, not of the state ({names}): flagged and nothing learned | {share(alone, len(other))} | >= 95 % |",
    ]
    if state:
        left = np.array([row["heldout"][1] / row["heldout"][0] for row in state])
        halved = share(int((left <= 0.5).sum()), len(left))
        name = "unnamed, of the state: left-out error at most half of the base model's"
        out.append(f"| {name} | {halved}; median {np.median(left):.2f} | median <= 0.5 |")
    return out


def _ranges(rows: list[Row]) -> str:
    """The seeds that were run, as ranges without gaps."""
    seeds = sorted(row["seed"] for row in rows)
    starts = [seed for seed in seeds if seed - 1 not in seeds]
    ends = [seed for seed in seeds if seed + 1 not in seeds]
    return ", ".join(f"{a} to {b}" for a, b in zip(starts, ends))


def _covered(rows: list[Row], names: tuple[str, ...]) -> list[bool]:
    """For each of these effects that was put in and named, whether its size was inside its interval."""
    out = []
    for row in rows:
        for name, size in zip(row["effects"], row["sizes"]):
            if name in names and name in row["intervals"]:
                low, _, high = row["intervals"][name]
                out.append(bool(min(abs(low), abs(high)) <= abs(size) <= max(abs(low), abs(high))))
    return out


def _errors(kinds: dict[str, list[Row]]) -> list[str]:
    """Errors over the noise floor, base and corrected model, and time."""
    lines = [
        "", "Median over the noise floor (90 % of campaigns below); processor seconds are of a crowded machine:", "",
        "| | left out, base | left out, corrected | new pads, base | new pads, corrected | without the pads' own part "
        "| processor seconds |", "|---" * 7 + "|",
    ]  # fmt: skip
    for kind, rows in kinds.items():
        if rows:
            floor = np.array([row["floor"] for row in rows])
            table = np.array([[*row["heldout"], *row["replay"]] for row in rows], float) / floor[:, None]
            seconds = np.array([row["cpu_seconds"] for row in rows])
            cells = [f"{np.median(c):.2f} ({np.quantile(c, 0.9):.2f})" for c in table.T]
            cells.append(f"{np.median(seconds):.1f} ({np.quantile(seconds, 0.9):.1f})")
            lines.append(f"| {kind} | {' | '.join(cells)} |")
    return lines


def _by_effect(rows: list[Row]) -> list[str]:
    lines = ["", "| one effect | right first | otherwise |", "|---|---|---|"]
    for name in sorted({row["effects"][0] for row in rows}):
        own = [row for row in rows if row["effects"] == [name]]
        missed = [row for row in own if row["found"][:1] != [name]]
        other = ", ".join(sorted({row["found"][0] if row["found"] else f"({row['verdict']})" for row in missed}))
        lines.append(f"| {name} | {len(own) - len(missed)} / {len(own)} | {other} |")
    return lines


def _missed(kinds: dict[str, list[Row]]) -> list[str]:
    """Every campaign of two or three in which not all was named, or something wrong."""
    heads = "put in", "found", "verdict", "new pads over the floor, without the pads' own part"
    lines = ["", f"| {' | '.join(heads)} |", "|---" * 4 + "|"]
    for row in (*kinds["two"], *kinds["three"]):
        if right(row) < len(row["effects"]) or wrong(row):
            left = row["replay"][2] / row["floor"]
            lines.append(f"| {', '.join(row['effects'])} | {', '.join(row['found'])} | {row['verdict']} | {left:.1f} |")
    return lines


def _unnamed(rows: list[Row]) -> list[str]:
    lines = ["", "| outside the vocabulary | unexplained | named beside it | reasons given |", "|---|---|---|---|"]
    for name in sorted({row["effects"][0] for row in rows}):
        own = [row for row in rows if row["effects"] == [name]]
        seen = sum(row["verdict"] == "unexplained" for row in own)
        named = ", ".join(sorted({found for row in own for found in row["found"]}))
        why = sorted({_short(reason) for row in own for reason in row["reasons"]})
        lines.append(f"| {name} | {seen} / {len(own)} | {named} | {'; '.join(why)} |")
    return lines


def _short(reason: str) -> str:
    for known in ("lack of fit", "left-out conditions"):
        if reason.startswith(known):
            return known
    return reason.split(":")[0].split(" (")[0]
