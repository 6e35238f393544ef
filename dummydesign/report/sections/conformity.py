"""Decision rule and uncertainty budget of an answer, as a section of its report and as lines on the terminal."""

from __future__ import annotations

from typing import Any

from dummydesign.core.tables import Table
from dummydesign.design.assessment.budget import STATEMENTS
from dummydesign.report.page import Section

TITLE = "Decision rule and uncertainty budget"
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
    return [Section(TITLE, "\n\n".join(budget_texts(budget)), table=table, html=html)]


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
