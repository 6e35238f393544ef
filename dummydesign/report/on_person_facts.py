"""Words and rows of presses carried over to people, for the terminal, the studio and the report."""

from __future__ import annotations

from typing import Any

from dummydesign.core.tables import Table
from dummydesign.person.validity_range import FAR, short_number, subject_words

FIVE = (
    ("peak_N", "peak force", "N"),
    ("steady_N", "steady force", "N"),
    ("depth_mm", "depth", "mm"),
    ("energy_mJ", "energy", "mJ"),
    ("mean_pressure_N_per_cm2", "mean pressure", "N/cm2"),
)
WORST = ("fail", "undecided", "pass")
LIMITS_TEMPLATE = "limits-template.toml"
IN_HEADLINE = ("drive_mismatch", "beyond_range", "inferred_tissue")
"""Warnings whose facts the first lines of an answer give."""


def number_text(value: float | None) -> str:
    """Three digits; none as a power of ten below a million."""
    return "-" if value is None else short_number(value)


def span_text(ends: list[float | None]) -> str:
    """Both ends of an interval, or the one value that both are."""
    if ends[0] is None or ends[1] is None:
        return "-"
    low, high = number_text(ends[0]), number_text(ends[1])
    return low if low == high else f"{low} to {high}"


def limit_rows(result: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Checks of limits with the file of their press, the worst first."""
    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]

    def rank(pair: tuple[dict[str, Any], str]) -> tuple[int, float]:
        """Worse results first, of those the nearest to its limit."""
        return WORST.index(pair[0]["result"]), -(pair[0]["person_high_95"] or 0.0) / pair[0]["limit"]

    return sorted(rows, key=rank)


def mismatch(result: dict[str, Any]) -> str:
    """The drive does not fit the traces: how, by how much, and what to do; nothing where it fits."""
    wrong = [one for one in result["presses"] if one["drive_contradicted"]]
    if not wrong:
        return ""
    one, drive = wrong[0], result["drive"]
    count = len(result["presses"])
    what = "The trace does" if count == 1 else f"{len(wrong)} of {count} traces do"
    where = "" if count == 1 else f"{one['file']}: "
    reason = one["drive_contradicted"]
    change, name = _capital(other_drive(drive, one["signs"])), drive.partition(":")[0]
    return (
        f"{what} not fit --drive {drive}. {where}{_capital(reason)}. {change}. Keep --drive {name} if this is how "
        "the robot acts on people."
    )


def other_drive(drive: str, signs: dict[str, Any]) -> str:
    """What to type where a drive does not fit."""
    name, fits = drive.partition(":")[0], signs["looks_like"]
    if fits == "mass":
        fits = f"mass:{signs['mass_kg']:.3g}"
    elif fits == name:
        fits = None
    return f"use --drive {fits}" if fits else "give the drive that made the trace"


def headline(result: dict[str, Any]) -> tuple[str, str]:
    """A word and its text: the worst check of the limits where there are any, else people's peak over the pad's."""
    rows = limit_rows(result)
    beyond = extrapolation_text(result["presses"])
    if not rows:
        return "result", f"{beyond}{comparison_text(result)}"
    row, file = rows[0]
    count = sum(one["result"] == row["result"] for one, _ in rows)
    words = {"pass": "limits are met", "fail": "limits are exceeded", "undecided": "checks"}
    reason = "" if row["result"] == "pass" else f" {_capital(row['reason'])}."
    if row["result"] == "undecided" and beyond and row["reason"].startswith("the press goes beyond"):
        reason = f" {beyond.strip()}"
    where = f"{file}, " if len(result["presses"]) > 1 else ""
    return row["result"], (
        f"{count} of {len(rows)} {words[row['result']]}. {'Worst' if row['result'] == 'fail' else 'Closest'}: "
        f"{where}{limit_text(row)}.{reason}"
    )


def comparison_text(result: dict[str, Any]) -> str:
    """People's peak force over the pad's; where the drive makes both equal, how deep people are pressed."""
    presses = result["presses"]
    press = max(presses, key=lambda one: one["factor_peak"][1] or 0.0)
    where = f" ({press['file']})" if len(presses) > 1 else ""
    factor, of_people = span_text(press["factor_peak"]), span_text(press["factor_peak_95"])
    if factor == "1":
        press = max(presses, key=lambda one: one["band"]["depth_mm"][1] or 0.0)
        where = f" ({press['file']})" if len(presses) > 1 else ""
        return (
            f"The force is the pad's. The subjects are pressed {span_text(press['band']['depth_mm'])} mm deep, "
            f"the pad {number_text(press['pad']['depth_mm'])} mm. For 95 % of people it is "
            f"{span_text(press['interval_95']['depth_mm'])} mm{where}."
        )
    return (
        f"The peak force on the subjects is {factor} times the pad's. For 95 % of people it is {of_people} "
        f"times{where}."
    )


def worst_beyond(presses: list[dict[str, Any]]) -> tuple[dict[str, Any], float] | None:
    """The farthest way in which presses go beyond those on people, and how many times; None where none does."""
    ways = [one for press in presses for one in press["beyond_range"]]
    times = [max(one["value"] / one["pressed_to"], one["pressed_to"] / max(one["value"], 1e-12)) for one in ways]
    return None if not ways else max(zip(ways, times), key=lambda pair: pair[1])


def extrapolation_text(presses: list[dict[str, Any]]) -> str:
    """How far the presses go beyond those on people, the worst first; nothing where they do not."""
    worst = worst_beyond(presses)
    if worst is None:
        return ""
    way, times = worst
    first = "Do not use these numbers: " if times > FAR else "Extrapolated: "
    return f"{first}{way['text']}. "


def people_text(result: dict[str, Any]) -> str:
    """Whose numbers these are."""
    count = len(result["presses"][0]["subjects"])
    inferred = any(one["code"] == "inferred_tissue" for one in result["warnings"])
    subjects = f"{count} subjects" if count != 1 else "1 subject"
    return f"{result['tissue']}, {subjects}" + (", inferred, not measured" if inferred else "")


def press_table(result: dict[str, Any]) -> Table:
    """All five numbers of a single press, a row a press of several."""
    if len(result["presses"]) == 1:
        one = result["presses"][0]
        rows = [
            [
                f"{words} {unit}",
                number_text(one["pad"][key]),
                span_text(one["band"][key]),
                span_text(one["interval_95"][key]),
            ]
            for key, words, unit in FIVE
        ]
        return Table(["", "pad", "subjects", "95 % of people"], rows)
    rows = [
        [
            one["file"],
            f"{one['velocity_mm_s']:.4g}",
            number_text(one["pad"]["peak_N"]),
            *(
                span_text(ends)
                for ends in (
                    one["band"]["peak_N"],
                    one["interval_95"]["peak_N"],
                    one["factor_peak"],
                    one["band"]["depth_mm"],
                )
            ),
        ]
        for one in result["presses"]
    ]
    return Table(["press", "mm/s", "pad peak N", "subjects N", "95 % N", "subjects/pad", "depth mm"], rows)


def subject_table(press: dict[str, Any]) -> Table:
    """Each subject's numbers."""
    rows = [[subject_words(one["name"]), *(number_text(one[key]) for key, _, _ in FIVE)] for one in press["subjects"]]
    return Table(["subject", *(f"{words} {unit}" for _, words, unit in FIVE)], rows)


def limit_name(row: dict[str, Any]) -> str:
    """What a limit is of, as it is read: quasi-static force."""
    quantity, _, kind = row["name"].rpartition(" ")
    return f"{kind} {quantity}"


def limit_text(row: dict[str, Any]) -> str:
    """A check of a limit with its numbers."""
    unit, people = row["unit"], number_text(row["person_high_95"])
    return (
        f"{limit_name(row)}, people up to {people} {unit} (95 %), limit {number_text(row['limit'])} {unit}, "
        f"pad {number_text(row['pad'])} {unit}"
    )


def next_steps(result: dict[str, Any]) -> list[str]:
    """What to do now: first what makes the numbers valid, then what the worst check of the limits asks for."""
    word, steps = headline(result)[0], list[str]()
    wrong = next((one for one in result["presses"] if one["drive_contradicted"]), None)
    if wrong is not None:
        steps.append(other_drive(result["drive"], wrong["signs"]))
    worst = worst_beyond(result["presses"])
    if worst is not None:
        steps.append(_into_range(worst[0]))
    if word == "fail":
        steps.append("reduce speed, force or moving mass; press the pad again with the new setting")
    elif word == "pass":
        steps.append("keep speed, force and moving mass at or below those of these presses")
    elif word == "undecided" and worst is None:
        steps.append(
            "reduce speed, force or moving mass, or measure more subjects: dummydesign tissues add NAME TRACE.csv..."
        )
    elif word == "result":
        template = result["files"].get("limits_template", LIMITS_TEMPLATE)
        steps.append(
            f"compare with your limits: copy {template} to limits.toml, fill it in, repeat with --limits limits.toml"
        )
    return steps


def _into_range(way: dict[str, Any]) -> str:
    """How to press so that people's presses cover it."""
    low = way["value"] < way["pressed_to"]
    speed, depth = ("faster", "deeper") if low else ("more slowly", "less deep")
    change = {"velocity_mm_s": speed, "peak_force_N": f"{speed} or {depth}"}.get(way["quantity"], depth)
    how = ("slowly" if low else "fast") if way["quantity"] == "velocity_mm_s" else ("lightly" if low else "hard")
    people = f"add people who were pressed this {how}: dummydesign tissues add NAME TRACE.csv..."
    return f"press the pad {change}, or {people}"


def _capital(text: str) -> str:
    return text[0].upper() + text[1:]
