"""Sections that several reports share, and the same on the terminal: decision rule and uncertainty budget; force over
time against people and its rating."""

from __future__ import annotations

from typing import Any

from dummydesign.core.tables import Table
from dummydesign.design.assessment.budget import STATEMENTS
from dummydesign.report.front_page import full_sentence
from dummydesign.report.page import Section

SURE = 1e-4


def budget_section(budget: dict[str, Any] | None) -> list[Section]:
    """The section; none where no press gave a reading."""
    if budget is None:
        return []
    components = [[one["name"], _percent(one["standard_percent"])] for one in budget["components"]]
    components += [
        ["combined standard uncertainty", _percent(budget["combined_percent"])],
        [f"expanded uncertainty (k = {budget['k']:g})", _percent(budget["expanded_percent"])],
    ]
    table = Table(["component", "standard uncertainty, % of the reading"], components)
    made = budget["decision"]
    html = "" if made is None else statement_table(budget).html()
    text = "\n\n".join(budget_texts(budget))
    return [Section("Decision rule and uncertainty budget", text, table=table, html=html)]


def budget_texts(budget: dict[str, Any]) -> list[str]:
    """Reading, statement, rule and what is not in the numbers, a paragraph each."""
    reading = reading_text(budget["reading"])
    texts = [
        f"Reading that decides: {reading}. Of all readings it is the most probable to be outside its limits. Standard "
        "uncertainties are those of its natural logarithm, independent of each other: combined they are the root of "
        "the sum of squares."
    ]
    if budget["decision"] is not None:
        texts += [statement_text(budget), f"Decision rule: {budget['rule']}. Agree it before the measurement."]
    if budget["not_known"]:
        texts.append(f"Not known, and not in the combined uncertainty: {', '.join(budget['not_known'])}.")
    return texts


def reading_text(reading: dict[str, Any]) -> str:
    """A reading with its press."""
    where = [] if reading["steady_force_N"] is None else [f"{reading['steady_force_N']:.3g} N"]
    where += [] if reading["velocity_mm_s"] is None else [f"{reading['velocity_mm_s']:.4g} mm/s"]
    where += [] if reading["file"] is None else [reading["file"]]
    return f"{reading['quantity']} {reading['value']:.3g} {reading['unit']} ({', '.join(where)})"


def statement_text(budget: dict[str, Any]) -> str:
    """The statement with the probability of false acceptance; beside it the one with the range as specification."""
    made, exact = budget["decision"], budget["exact_range"]
    text = f"Statement: {budget['statement'].upper()} ({budget['requirement']})"
    if budget["missing"]:
        return f"{text}. {budget['missing']} presses are out of reach."
    if budget["doubt"]:
        doubt = budget["doubt"]
        return f"{text}. The probability of false acceptance is not known, and a pass is conditional: {doubt}."
    text += f". If accepted, the probability of false acceptance is {probability_text(budget['false_acceptance'])}."
    if none_can_pass(made):
        text += " No reading can pass: the guard bands are wider than the tolerance."
    if exact is not None:
        text += (
            f" With the subjects' range as the specification, without their uncertainty: {exact['statement'].upper()}, "
            f"{probability_text(exact['false_acceptance'])}."
        )
    return text


def none_can_pass(decision: dict[str, Any]) -> bool:
    """Whether the guard bands on both sides leave nothing of the tolerance."""
    low, high = decision["acceptance"]["low"], decision["acceptance"]["high"]
    return low is not None and high is not None and low > high


def probability_text(share: float) -> str:
    """A probability in per cent, two digits; a very small one by its bound."""
    return f"below {100.0 * SURE:g} %" if share < SURE else f"{100.0 * share:.2g} %" if share < 0.995 else "100 %"


def statement_table(budget: dict[str, Any]) -> Table:
    """Where each statement begins and ends, with the one of this reading marked."""
    made, unit = budget["decision"], budget["reading"]["unit"]
    edges = [made[name] for name in ("acceptance", "tolerance", "rejection")]
    lows, highs = ([edge[side] for edge in edges] for side in ("low", "high"))
    spans = [
        _between(lows[0], highs[0], unit),
        _sides(lows[:2], highs[:2], unit),
        _sides(lows[1:], highs[1:], unit),
        _outside(lows[2], highs[2], unit),
    ]
    if none_can_pass(made):
        spans[:2] = "no reading", _between(lows[1], highs[1], unit)
    rows = [[name, span, "this reading" * (name == budget["statement"])] for name, span in zip(STATEMENTS, spans)]
    return Table(["statement", f"reading, {budget['reading']['quantity']}", ""], rows)


def _between(low: float | None, high: float | None, unit: str) -> str:
    if low is None or high is None:
        return f"up to {high:.3g} {unit}" if low is None else f"from {low:.3g} {unit}"
    return f"{low:.3g} to {high:.3g} {unit}"


def _sides(lows: list[float | None], highs: list[float | None], unit: str) -> str:
    """A band on either side: nearer edge first in the lists."""
    parts = [] if lows[0] is None else [_between(lows[1], lows[0], unit)]
    parts += [] if highs[0] is None else [_between(highs[0], highs[1], unit)]
    return " or ".join(parts)


def _outside(low: float | None, high: float | None, unit: str) -> str:
    parts = [] if low is None else [f"below {low:.3g} {unit}"]
    return " or ".join([*parts, *([] if high is None else [f"above {high:.3g} {unit}"])])


def _percent(value: float | None) -> str:
    return "not known" if value is None else f"{value:.2g} %" if value < 99.5 else f"{value:.0f} %"


def budget_lines(budget: dict[str, Any] | None) -> list[str]:
    """The budget on the terminal: reading and components, then the statement."""
    if budget is None:
        return []
    parts = ", ".join(f"{one['name']} {_percent(one['standard_percent'])}" for one in budget["components"])
    whole = f"combined {_percent(budget['combined_percent'])}, expanded (k = {budget['k']:g}) "
    whole += _percent(budget["expanded_percent"])
    lines = [f"budget of the {reading_text(budget['reading'])}: {parts}; {whole}"]
    return [*lines, *([] if budget["decision"] is None else [statement_text(budget)])]


RATINGS = ("R", "Z", "EP", "EM", "ES")


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
        f"{full_sentence(curves_text(curves, subjects))} The largest miss is that with the largest force outside the "
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
    return Section("Force over time: range and rating", text, table=Table(head, rows))
