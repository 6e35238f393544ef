"""What an answer on people states on one screen and on its report's first page: the closest limit, presses, limits."""

from __future__ import annotations

from typing import Any

FOUR = (("peak_N", "peak force N"), ("steady_N", "steady force N"), ("depth_mm", "depth mm"),
        ("energy_mJ", "energy mJ"), ("mean_pressure_N_per_cm2", "mean pressure N/cm2"))  # fmt: skip
WORST = ("fail", "undecided", "pass")


def number_text(value: float | None) -> str:
    """Three digits."""
    return "-" if value is None else f"{value:.3g}"


def span_text(ends: list[float | None]) -> str:
    """Both ends of an interval."""
    return "-" if ends[0] is None or ends[1] is None else f"{ends[0]:.3g} to {ends[1]:.3g}"


def limit_rows(result: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Checks of limits with the file of their press, the worst first."""
    rows = [(row, press["file"]) for press in result["presses"] for row in press["limits"]]

    def place(pair: tuple[dict[str, Any], str]) -> tuple[int, float]:
        """Worse results first, of those the nearest to its limit."""
        return WORST.index(pair[0]["result"]), -(pair[0]["person_high_95"] or 0.0) / pair[0]["limit"]

    return sorted(rows, key=place)


def headline(result: dict[str, Any]) -> tuple[str, str]:
    """A word and its text: the worst check of the limits where there are any, else people's peak over the pad's."""
    rows = limit_rows(result)
    if not rows:
        press = max(result["presses"], key=lambda one: one["factor_peak"][1] or 0.0)
        factor, of_people = span_text(press["factor_peak"]), span_text(press["factor_peak_95"])
        return "result", (f"Peak force on the subjects is {factor} times the pad's; for 95 % of people {of_people} "
                          f"times ({press['file']}).")  # fmt: skip
    row = rows[0][0]
    count = sum(one["result"] == row["result"] for one, _ in rows)
    reason = "" if row["result"] == "pass" else f" {row['reason'][0].upper()}{row['reason'][1:]}."
    if any(one["drive_contradicted"] for one in result["presses"]):
        reason += " The drive does not fit the trace."
    return row["result"], (
        f"{count} of {len(rows)} checks. Closest: {row['name']}, people up to {number_text(row['person_high_95'])} "
        f"{row['unit']} (95 %), limit {row['limit']:.4g}, pad {number_text(row['pad'])}.{reason}"
    )


def press_table(result: dict[str, Any]) -> tuple[list[str], list[list[str]]]:
    """Head and rows: all five numbers of a single press, a row a press of several."""
    if len(result["presses"]) == 1:
        one = result["presses"][0]
        rows = [[words, number_text(one["pad"][key]), span_text(one["band"][key]), span_text(one["interval_95"][key])]
                for key, words in FOUR]  # fmt: skip
        return ["", "pad", "subjects", "95 % of people"], rows
    rows = [
        [one["file"], f"{one['velocity_mm_s']:.4g}", number_text(one["pad"]["peak_N"]),
         *(span_text(ends) for ends in (one["band"]["peak_N"], one["interval_95"]["peak_N"], one["factor_peak"],
                                        one["band"]["depth_mm"]))]
        for one in result["presses"]
    ]  # fmt: skip
    return ["press", "mm/s", "pad peak N", "subjects N", "95 % N", "times", "depth mm"], rows


def limit_text(row: dict[str, Any]) -> str:
    """A check of a limit with its numbers."""
    people = span_text([row["person_low_95"], row["person_high_95"]])
    return f"{row['name']}: limit {row['limit']:.4g}, pad {number_text(row['pad'])}, people {people} {row['unit']}"
