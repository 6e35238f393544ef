"""Curves and budget of a pressed pad against people who are measured curves."""

from __future__ import annotations

import pytest

from dummydesign.core.serialise import to_plain
from dummydesign.design.measured_match import budget_of_traces, curves_of_traces
from dummydesign.design.measured_pad import readings_of_traces
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
