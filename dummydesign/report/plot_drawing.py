"""A plot as ``plot.typ`` draws it: runs of points in shares of the axes, numbers at their places, names of curves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.typeset import typeset
from dummydesign.report.plot import Plot, Series, thin

MOST_DOTS, MOST_ACROSS, MOST_NAMES = 40, 5, 12


def picture(title: str, plots: Sequence[Plot]) -> bytes:
    """Plots side by side, their areas named, as PNG."""
    areas = (dict.fromkeys(part.label for part in one.series if part.kind == "band" and part.seen) for one in plots)
    shown = [
        {"title": f"{one.title}; area: {'; '.join(names)}" if names else one.title, **plot_drawing(one)}
        for one, names in zip(plots, areas)
    ]
    return typeset(Path(__file__).with_name("plots.typ"), {"title": title, "plots": shown}, "png")


def plot_drawing(plot: Plot) -> dict[str, Any]:
    """Return a plot with the labels of its axes and the names of its curves."""
    labels = {"x_label": plot.x_label, "y_label": plot.y_label}
    return {"plot": draw_plot(plot, 6, named=True) | labels}


def draw_plot(
    plot: Plot,
    most_numbers: int,
    y_range: tuple[float, float] | None = None,
    unit: str = "",
    named: bool = False,
    words: str = "",
) -> dict[str, Any]:
    """Return bands, curves, points and bars of a plot inside their axes; maps, ellipses and words are left out.

    Parameters
    ----------
    plot : Plot
        Its ranges are those of the report.
    most_numbers : int
        Of intervals between the numbers of y.
    y_range : tuple of float, optional
        Instead of the plot's own.
    unit : str
        Written behind the last number of the x-axis.
    named : bool
        Whether the names of the curves stand right of the axes, at the height of their ends.
    words : str
        Written into the axes.

    Returns
    -------
    dict
        What ``plot.typ`` reads.
    """
    shown = [one for one in plot.series if one.kind in ("band", "line", "dots", "bars") and one.seen]
    shown.sort(key=lambda one: ("band", "bars", "line", "dots").index(one.kind))
    bars = next((one for one in shown if one.kind == "bars"), None)
    x_all, y_all = (np.concatenate([[]] + [one.extent()[side] for one in shown]) for side in (0, 1))
    x_axis = _Axis(x_all, plot.x_range, plot.zero and bars is None and not plot.log_x, plot.log_x)
    y_axis = _Axis(y_all, y_range or plot.y_range, plot.zero and bars is None)
    across = [(at, f"{value:g}") for at, value in x_axis.ticks(MOST_ACROSS)]
    across = across[::2] if len(across) > MOST_ACROSS + 1 else across
    across[-1:] = [(at, f"{number}{unit}") for at, number in across[-1:]]
    along = [(at, f"{value:g}") for at, value in y_axis.ticks(most_numbers)]
    if bars is not None:
        along = [(float(y_axis(place)), name) for place, name in zip(_places(bars), bars.names)]
    drawn = [{"kind": one.kind, "style": one.style, "runs": _runs(one, x_axis, y_axis)} for one in shown]
    ends = {
        one.label: {"name": one.label, "style": one.style, "at": made["runs"][-1][-1][1]}
        for one, made in zip(shown, drawn)
        if one.kind in ("line", "dots") and made["runs"]
    }
    return {
        "alt": plot.alt or plot.title or plot.name,
        "x": across,
        "y": along,
        "series": drawn,
        "names": [*ends.values()] if named and len(ends) <= MOST_NAMES else [],
        "bars": bars is not None,
        "words": words,
        "x_label": "",
        "y_label": "",
    }


class _Axis:
    """An axis over values: from its given ends, else with a margin, from zero where it may be.

    Calling it gives the shares of the axis at which values lie.
    """

    def __init__(
        self, values: NDArray, given: tuple[float, float] | None, zero: bool = False, log: bool = False
    ) -> None:
        known = values[np.isfinite(values) & (values > (0.0 if log else -np.inf))] if given is None else np.array(given)
        known = np.log10(known) if log else known
        self.low, self.high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        self.log = log
        if given is None or self.low == self.high:
            margin = 0.05 * (self.high - self.low) or 0.05 * abs(self.high) or 1.0
            self.low = 0.0 if zero and self.low >= 0.0 else self.low - margin
            self.high += margin

    def __call__(self, values: NDArray) -> NDArray:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.round(
                ((np.log10(np.maximum(values, 1e-12)) if self.log else values) - self.low) / (self.high - self.low), 5
            )

    def ticks(self, most: int) -> list[tuple[float, float]]:
        """Shares and values of round numbers, at most so many intervals; on a logarithmic axis of powers of ten."""
        power = 10.0 ** math.floor(math.log10((self.high - self.low) / most))
        steps = (factor * power for factor in (1.0, 2.0, 2.5, 5.0, 10.0))
        step = 1.0 if self.log else next(one for one in steps if one * most >= (self.high - self.low) * (1 - 1e-9))
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        values = [number * step for number in range(first, last + 1)]
        return [((one - self.low) / (self.high - self.low), 10.0**one if self.log else one) for one in values]


def _places(bars: Series) -> NDArray:
    return len(bars.names) - 0.5 - np.arange(len(bars.names))


def _runs(one: Series, x_axis: _Axis, y_axis: _Axis) -> list[list[list[float]]]:
    """Points of each part of a series between its gaps; of a band and of bars those around the area."""
    if one.kind == "bars":
        corners = ((one.low, -0.3), (one.high, -0.3), (one.high, 0.3), (one.low, 0.3))
        points = [np.c_[x_axis(end), y_axis(_places(one) + half)] for end, half in corners]
        return np.stack(points, axis=1).tolist()
    place = one.y if one.sideways else one.x
    columns = np.array([place, one.low, one.high] if one.kind == "band" else [one.x, one.y])
    known = np.isfinite(columns).all(axis=0)
    edges = np.flatnonzero(np.diff(np.r_[False, known, False])).reshape(-1, 2)
    log = x_axis.log and not one.sideways
    runs = []
    for begin, end in edges:
        most = {"most": MOST_DOTS} if one.kind == "dots" else {}
        at, *ends = thin(columns[0, begin:end], log, *columns[1:, begin:end], **most)
        if one.kind == "band":
            at, ends = np.r_[at, at[::-1]], [np.r_[ends[0], ends[1][::-1]]]
        x, y = (ends[0], at) if one.sideways else (at, ends[0])
        runs.append(np.c_[x_axis(x), y_axis(y)].tolist())
    return runs
