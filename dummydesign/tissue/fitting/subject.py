"""From a fit to a subject of a tissue."""

from __future__ import annotations

from typing import Any

from dummydesign.core.quantity import Quantity
from dummydesign.tissue.fitting.fit import Fit
from dummydesign.tissue.fitting.groups import rounded_velocity, speed_groups
from dummydesign.tissue.model.parameters import Parameters, speed_key
from dummydesign.tissue.model.tissue import Subject

UNKNOWN = 1000.0
"""Factor put on a side of an interval that the data do not bound."""


def subject_from_fit(name: str, fit: Fit) -> Subject:
    """Make a subject from a fit: kind ``fitted``, the law and mode in the source.

    An interval without an end on one side gets a factor of :data:`UNKNOWN` there, and its source says so.
    A fit per condition has no intervals; the range over its conditions stands in.
    """
    files = [row["file"] for row in fit.result["by_trace"]]
    shown = ", ".join(files[:3]) + (f" and {len(files) - 3} more" if len(files) > 3 else "")
    source = f"fit of {shown}: law {fit.law}, {fit.mode}, rms residual {fit.result['rmse_N']:.3g} N"
    speeds = [speed_key(speed) for speed, _ in speed_groups([t for p, _ in fit.problems for t in p.traces])]
    numbers: dict[str, Any] = {}
    for key, entry in fit.result["parameters"].items():
        spread = _over_conditions(fit, key)
        if not key.startswith("c"):
            numbers[key] = _quantity(entry, source, spread)
        elif "value" in entry:
            by_speed = {speed: _over_conditions(fit, key, float(speed)) for speed in speeds}
            numbers[key] = {speed: _quantity(entry, source, by_speed[speed]) for speed in speeds}
        else:
            numbers[key] = {speed: _quantity(one, source, None) for speed, one in entry.items()}
    plain = {
        key: {speed: q.value for speed, q in entry.items()} if isinstance(entry, dict) else entry.value
        for key, entry in numbers.items()
    }
    return Subject(name, Parameters.from_dict(fit.law, plain), numbers)


def _over_conditions(fit: Fit, key: str, speed: float | None = None) -> list[float] | None:
    """Values of one parameter over the conditions (of one speed) of a fit per condition."""
    if fit.mode != "per-condition":
        return None
    return [
        condition["parameters"][key]["value"]
        for condition in fit.result["by_condition"]
        if speed is None or rounded_velocity(condition["velocity_mm_s"]) == speed
    ]


def _quantity(entry: dict[str, Any], source: str, spread: list[float] | None) -> Quantity:
    if spread:
        value = sum(spread) / len(spread)
        return Quantity(value, min(spread), max(spread), "fitted", f"{source}; low and high over conditions")
    value, low, high = entry["value"], entry["low"], entry["high"]
    if low is None or high is None:
        source = f"{source}; {entry.get('reason', 'no interval')}"
    low = value / UNKNOWN if low is None else min(low, value)
    high = value * UNKNOWN if high is None else max(high, value)
    return Quantity(value, low, high, "fitted", source)
