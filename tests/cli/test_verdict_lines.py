"""What a terminal shows first: the verdict, then what the tissue is not known for."""

from dummydesign.cli.text import tissue_lines, warning_lines


def warned(*codes):
    return {"warnings": [{"code": code, "message": f"said of {code}"} for code in codes]}


def test_what_nobody_measured_is_said_before_the_numbers_and_once():
    result = warned("equal_area_punch", "speed_not_in_band", "force_not_in_band", "tissue_punch", "measured_curves")
    first, last = tissue_lines(result), warning_lines(result)
    assert first[-1] == "" and len(first) == 5
    assert last == ["warning: said of equal_area_punch"]
    assert tissue_lines(warned("at_edge")) == []
