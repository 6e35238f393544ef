"""The decision rule, the budget and the curves as they are printed."""

from __future__ import annotations

import re

import pytest

from dummydesign.core.serialise import to_plain
from dummydesign.design.assessment.budget import Budget, Reading, UncertaintyComponent, decide
from dummydesign.report.sections import (
    budget_lines,
    budget_section,
    curves_section,
    curves_text,
    moment_text,
    probability_text,
    statement_table,
)


def budget(value=1.0, tolerance=(0.5, 2.0), u=0.1, **changes):
    made = decide(value, tolerance, (u, u))
    reading = Reading("peak force", value, "N", 5.0, 10.0)
    return to_plain(Budget(reading, (UncertaintyComponent("making", 100.0 * u),), "usable", made, **changes))


def edges(text):
    return [float(number) for number in re.findall(r"[\d.]+", text)]


def test_the_four_statements_cover_every_reading_once():
    rows = statement_table(budget()).rows
    inner, conditional, failing, outside = (edges(row[1]) for row in rows)
    # every band begins where the one inside it ends
    assert conditional[1] == inner[0] and conditional[2] == inner[1]
    assert [failing[1], failing[2]] == [conditional[0], conditional[3]]
    assert outside == [failing[0], failing[3]]
    assert [row[2] for row in rows] == ["this reading", "", "", ""]


@pytest.mark.parametrize("value, row", [(1.0, 0), (1.9, 1), (2.1, 2), (3.0, 3), (0.55, 1), (0.45, 2), (0.3, 3)])
def test_the_reading_stands_in_the_band_of_its_statement(value, row):
    marked = [bool(one[2]) for one in statement_table(budget(value)).rows]
    assert marked.index(True) == row and sum(marked) == 1


def test_guard_bands_wider_than_the_tolerance_leave_no_reading_that_passes():
    rows = statement_table(budget(u=0.5)).rows
    assert edges(rows[0][1]) == [] and edges(rows[1][1]) == [0.5, 2.0] and rows[1][2]


def test_one_limit_has_bands_on_one_side():
    rows = statement_table(budget(1.0, (None, 2.0))).rows
    assert [len(edges(row[1])) for row in rows] == [1, 2, 2, 1]
    rows = statement_table(budget(1.0, (0.5, None))).rows
    assert [len(edges(row[1])) for row in rows] == [1, 2, 2, 1]


def test_a_section_names_every_part_and_the_sums():
    (section,) = budget_section(budget())
    assert section.table.rows[0][0] == "making" and len(section.table.rows) == 3
    assert budget_section(None) == [] and budget_lines(None) == []
    assert len(budget_lines(budget())) == 2


@pytest.mark.parametrize("share, text", [(0.0, "below 0.01 %"), (0.0228, "2.3 %"), (0.5, "50 %"), (0.9999, "100 %")])
def test_a_probability_is_never_printed_as_nothing(share, text):
    assert probability_text(share) == text


def rows(*shares):
    rating = dict.fromkeys(("R", "Z", "EP", "EM", "ES"), 0.9)
    return [
        {"steady_force_N": 15.0, "velocity_mm_s": 250.0, "inside_fraction": share, "rating": rating} for share in shares
    ]


def miss(**changes):
    return {
        "steady_force_N": 12.5,
        "velocity_mm_s": 250.0,
        "time_after_stop_s": -0.0123,
        "miss_N": -12.3,
        "miss_percent": -98.0,
        **changes,
    }


def test_the_line_of_the_curves_fits_one_line_of_the_screen():
    text = curves_text({"conditions": rows(0.08, 0.96), "worst": miss()}, 5)
    assert len(text) <= 92 and "below" in text and "98 %" in text
    assert "above" in curves_text({"conditions": rows(0.5), "worst": miss(miss_N=1.0, miss_percent=3.0)}, 5)
    assert "N" in curves_text({"conditions": rows(0.5), "worst": miss(miss_percent=None)}, 5)
    assert ";" not in curves_text({"conditions": rows(1.0, 1.0), "worst": None}, 5)


@pytest.mark.parametrize(
    "after_s, text",
    [
        (0.0626, "63 ms after"),
        (-0.0051, "5.1 ms before"),
        (0.0, "at"),
        (0.1, "0.1 s after"),
        (1.234, "1.2 s after"),
    ],
)
def test_a_moment_is_told_by_its_distance_from_the_stop(after_s, text):
    assert moment_text(after_s) == f"{text} the stop"


def test_a_press_out_of_reach_has_no_rating():
    conditions = [*rows(0.5), {**rows(0.0)[0], "rating": None}]
    section = curves_section({"conditions": conditions, "worst": None}, 5, "average")
    assert len(section.table.rows) == 2 and section.table.rows[1][3:] == ["out of reach", "", "", "", ""]
