"""One table on the terminal and in a page: widths, digits, missing values, rows that end early."""

from __future__ import annotations

import math

import pytest

from dummydesign.core.tables import Table

COLUMNS = {"press": "file:<8", "N": "force_N:>9.3f", "share": lambda row: f"{100 * row['share']:.0f} %"}
ROWS = [{"file": "a.csv", "force_N": math.pi, "share": 0.5}, {"file": "b<c.csv", "force_N": None, "share": 1.0}]


def test_a_form_is_the_width_and_the_digits_of_its_column():
    head, first, missing = Table.of(ROWS, COLUMNS).lines(indent="")
    assert first == "a.csv        3.142 50 %" and head == "press            N share"
    assert missing.split() == ["b<c.csv", "-", "100", "%"]
    assert head.index("N") == first.index("3.142") + 4 == missing.index("-")


@pytest.mark.parametrize(("form", "shown"), [(">8.3g", "    1.23"), (">+9.2f", "    +1.23"), ("<6g", "1.2345")])
def test_a_number_is_written_by_its_form_and_a_text_takes_its_width_alone(form, shown):
    number, text = Table(["x"], [[1.2345], ["abc"]]).lines([form], indent="|")[1:]
    assert number == f"|{shown}".rstrip() and text.strip("| ") == "abc"
    assert form[0] == "<" or len(text) == len(number)


def test_a_row_may_end_early():
    table = Table(["N", "mm", ""], [["5", "out of reach of this pad"], ["5", "1.2", "inside"]])
    assert table.lines(["<4", "<6", "<1"], "") == ["  N   mm", "  5   out of reach of this pad", "  5   1.2   inside"]


def test_in_a_page_numbers_have_four_digits_or_their_form_and_text_is_escaped():
    page = Table.of(ROWS, COLUMNS | {"4": lambda row: row["force_N"], "": lambda row: 7}).html()
    for part in ('<th scope="col">press</th>', "<td></td>", ">3.142<", ">b&lt;c.csv", "<td>–</td>", "<td>7</td>"):
        assert part in page
    assert page.count("<tr>") == 3
