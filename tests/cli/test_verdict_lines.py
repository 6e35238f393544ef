"""What a terminal shows first: the verdict, then what the tissue is not known for, then the impact."""

import re

import pytest

from dummydesign.cli.text import first_lines, fitted, tissue_lines, warning_lines


def warned(*codes):
    return {"warnings": [{"code": code, "message": f"said of {code}"} for code in codes]}


def test_what_nobody_measured_is_said_before_the_numbers_and_once():
    result = warned("equal_area_punch", "speed_not_in_band", "force_not_in_band", "tissue_punch", "measured_curves")
    first, last = tissue_lines(result), warning_lines(result)
    assert first[-1] == "" and len(first) == 5
    assert last == ["warning: said of equal_area_punch"]
    assert tissue_lines(warned("at_edge")) == []


def test_one_subject_stops_a_mass_with_one_force():
    def impact(*peaks):
        rows = [{"body": f"tissue, subject {k}", "peak_force_N": peak, "depth_mm": 1.0} for k, peak in enumerate(peaks)]
        rows.append({"body": "pad", "peak_force_N": 20.0, "depth_mm": 1.5})
        return first_lines({"warnings": [], "safety": {"impact": rows}})[0]

    assert impact(43.3).endswith("at 1.5 mm, the subject with 43.3 N")
    assert impact(40.0, None, 50.0).endswith("the subjects with 40 to 50 N")


@pytest.mark.parametrize("tail", [0, 20, 27, 28, 29, 30, 40])
@pytest.mark.parametrize("rows", [0, 1, 2, 3, 5, 40])
def test_the_rows_that_are_shown_and_those_that_are_counted_are_all(rows, tail):
    lines = fitted(["head"], [f"row {n}" for n in range(rows)], [["tail"] * tail], (), "... and {} more rows")
    shown = sum(line.startswith("row") for line in lines)
    counted = [int(n) for line in lines for n in re.findall(r"and (-?\d+) more", line)]
    assert shown + sum(counted) == rows and all(n > 1 for n in counted)
