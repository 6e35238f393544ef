"""What a terminal shows first: the verdict, then what the tissue is not known for."""

import re

import pytest

from dummydesign.cli.text import fitted, tissue_lines, warning_lines


def warned(*codes):
    return {"warnings": [{"code": code, "message": f"said of {code}"} for code in codes]}


def test_what_nobody_measured_is_said_before_the_numbers_and_once():
    result = warned("equal_area_punch", "speed_not_in_band", "force_not_in_band", "tissue_punch", "measured_curves")
    first, last = tissue_lines(result), warning_lines(result)
    assert first[-1] == "" and len(first) == 5
    assert last == ["warning: said of equal_area_punch"]
    assert tissue_lines(warned("at_edge")) == []


@pytest.mark.parametrize("tail", [0, 20, 27, 28, 29, 30, 40])
@pytest.mark.parametrize("rows", [0, 1, 2, 3, 5, 40])
def test_the_rows_that_are_shown_and_those_that_are_counted_are_all(rows, tail):
    lines = fitted(["head"], [f"row {n}" for n in range(rows)], [["tail"] * tail], (), "... and {} more rows")
    shown = sum(line.startswith("row") for line in lines)
    counted = [int(n) for line in lines for n in re.findall(r"and (-?\d+) more", line)]
    assert shown + sum(counted) == rows and all(n > 1 for n in counted)
