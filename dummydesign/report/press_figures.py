"""What the reports on measured presses have in common: styles, the start of a logarithmic time, parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dummydesign.report.html.page import Table

STYLES = ("main", "alt1", "alt2", "alt3", "alt4", "alt5")


def log_start(rise_s: float) -> float:
    """Where a logarithmic axis of time since contact begins: a power of ten below a tenth of the rise. [s]"""
    return 10.0 ** math.floor(math.log10(max(0.1 * rise_s, 1e-4)))


def digits(value: float | None) -> str | None:
    """Five digits: intervals of a good fit are narrower than four show."""
    return None if value is None else f"{value:.5g}"


def unique(name: str, taken: set[str]) -> str:
    """The name, with a number behind it when it is taken; it is then."""
    free, count = name, 1
    while free in taken:
        count += 1
        free = f"{name}-{count}"
    taken.add(free)
    return free


def table_of_parameters(parameters: Mapping[str, Any]) -> Table:
    """Parameters with intervals and what a reader must know of each; dampers of several speeds in rows."""
    rows = []
    for name, entry in parameters.items():
        several = {name: entry} if "value" in entry else {f"{name} at {v} mm/s": one for v, one in entry.items()}
        for label, one in several.items():
            note = "at the limit of its range" if one.get("at_bound") else ""
            note = "; ".join(part for part in (note, one.get("reason", "")) if part)
            rows.append([label, *(digits(one[key]) for key in ("value", "low", "high")), note])
    return Table(["parameter", "value", "95 % low", "95 % high", ""], rows)
