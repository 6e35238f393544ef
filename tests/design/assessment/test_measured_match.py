"""Curves and budget of a pressed pad against people who are measured curves."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.core.serialise import to_plain
from dummydesign.design import measured_pad
from dummydesign.design.measured_pad import budget_of_traces, curves_of_traces, readings_of_traces
from dummydesign.tissue.comparison import compare_traces
from tests.tissue.model.test_measured_curves import pad_traces, people  # noqa: F401


@pytest.mark.slow
@pytest.mark.parametrize("stiffness, beta, conforms", [(3.2, (0.8, 0.5), True), (3.4, (0.05, 0.05), False)])
def test_a_pressed_pad_has_a_rating_a_miss_and_a_statement(people, stiffness, beta, conforms):  # noqa: F811
    found = compare_traces(pad_traces(stiffness, 2.8, beta), people)
    curves = curves_of_traces(found, people)
    shares = [row["inside_fraction"] for row in found.result["force_variation_range"]]
    assert [row.inside_fraction for row in curves.conditions] == pytest.approx(shares)
    assert curves.inside_fraction_least == pytest.approx(min(shares))
    ratings = [row.rating.R for row in curves.conditions]
    assert (min(ratings) > 0.8) == conforms
    # a pad that hardly relaxes has its largest miss below all
    assert conforms or curves.worst.miss_N < 0.0
    budget = budget_of_traces(found, people, *readings_of_traces(found, people))
    assert [one.name for one in budget.components] == ["trace", "subjects"] and budget.not_known == ("subjects",)
    assert (budget.statement in ("pass", "conditional pass")) == conforms
    assert to_plain(budget)["exact_range"] is None


def test_outermost_energies_are_those_of_each_drawn_tissue_by_itself(monkeypatch):
    """Three tissues of two, three and one subject: energies 0 to 5 in this order."""
    bands = [
        SimpleNamespace(stop_s=np.zeros(count), peak_low_N=float(at), peak_high_N=at + 10.0)
        for at, count in enumerate((2, 3, 1))
    ]
    monkeypatch.setattr(measured_pad, "force_ranges", lambda *given: bands)
    monkeypatch.setattr(measured_pad, "energies_of", lambda *given: np.split(np.arange(6.0), [2, 5]))
    trace = SimpleNamespace(steady_force_N=10.0, hold_s=5.0)
    press = SimpleNamespace(trace=trace, braking_mm_s2=1e4)
    drawn = [SimpleNamespace(parameter_sets=())] * 3
    peaks, energies = measured_pad._outer(press, 10.0, drawn, "ode")
    assert peaks.tolist() == [[0.0, 10.0], [1.0, 11.0], [2.0, 12.0]]
    assert energies.tolist() == [[0.0, 1.0], [2.0, 4.0], [5.0, 5.0]]
