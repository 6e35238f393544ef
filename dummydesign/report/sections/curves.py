"""What an answer states of force over time against people: one line, and a section with the objective rating."""

from __future__ import annotations

from typing import Any

from dummydesign.core.tables import Table
from dummydesign.report.page import Section

RATINGS = ("R", "Z", "EP", "EM", "ES")
TITLE = "Force over time: range and rating"


def curves_text(curves: dict[str, Any], subjects: int) -> str:
    """Share of the time inside the subjects' range, least and most of the presses, and the largest miss."""
    shares = [round(100.0 * row["inside_fraction"]) for row in curves["conditions"]]
    low, high = min(shares), max(shares)
    span = f"{low} to {high} %" if low < high else f"{low} %"
    text = f"{span} of the time {'inside' if subjects > 1 else 'within 1 % of the one subject'}"
    worst = curves["worst"]
    return text if worst is None else f"{text}; {miss_text(worst, subjects)}"


def miss_text(worst: dict[str, Any], subjects: int) -> str:
    """The largest miss: its moment, its size against the nearest subject, its press."""
    side, who = "below" if worst["miss_N"] < 0.0 else "above", "all" if subjects > 1 else "it"
    percent = worst["miss_percent"]
    size = f"{abs(worst['miss_N']):.2g} N" if percent is None else f"{abs(percent):.0f} %"
    press = f"{worst['steady_force_N']:.3g} N, {worst['velocity_mm_s']:.4g} mm/s"
    return f"{moment_text(worst['time_after_stop_s'])} {size} {side} {who} at {press}"


def moment_text(after_stop_s: float) -> str:
    """A moment by its distance from the stop."""
    away = abs(after_stop_s)
    if away < 5e-5:
        return "at the stop"
    size = f"{away:.2g} s" if away >= 0.095 else f"{1000.0 * away:.2g} ms"
    return f"{size} {'before' if after_stop_s < 0.0 else 'after'} the stop"


def curves_section(curves: dict[str, Any], subjects: int, aim: str) -> Section:
    """Shares of the time and ratings, press by press."""
    text = (
        f"{_sentence(curves_text(curves, subjects))} The largest miss is that with the largest force outside the "
        "range over the steady force. The share counts the rise evenly in time and the hold evenly in its logarithm, "
        "half each.\n\n"
        f"The rating of ISO/TS 18571 compares each press with the aim ({aim}): corridor Z, phase EP, magnitude EM, "
        "slope ES and overall R = 0.4 Z + 0.2 (EP + EM + ES), from 0 to 1 (equal curves). It is taken from contact "
        "until twice the time in which the aim stops."
    )
    rows = [
        [
            f"{row['steady_force_N']:.3g}",
            f"{row['velocity_mm_s']:.4g}",
            f"{100.0 * row['inside_fraction']:.0f} %",
            *(
                f"{row['rating'][name]:.2f}" if row["rating"] else "out of reach" if name == "R" else ""
                for name in RATINGS
            ),
        ]
        for row in curves["conditions"]
    ]
    head = ["steady N", "mm/s", "time inside", "R", "corridor Z", "phase EP", "magnitude EM", "slope ES"]
    return Section(TITLE, text, table=Table(head, rows))


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."
