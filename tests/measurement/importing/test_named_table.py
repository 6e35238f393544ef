"""Tables whose columns have given names, in any writing: which cell belongs to which name, and in which unit."""

from __future__ import annotations

import pytest

from dummydesign.measurement.importing.table import read_named_table
from tests.support.refusal import raises_code

COLUMNS = ("subject", "depth_mm", "force_N")
CURVES = (*COLUMNS, "velocity_mm_s", "time_s")


def read(tmp_path, text, columns=COLUMNS, optional=()):
    path = tmp_path / "points.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
    return read_named_table(path, "points", columns, optional)


def test_rows_keep_their_line_and_empty_ones_are_left_out(tmp_path):
    table = read(tmp_path, "subject,depth_mm,force_N\n\na,1.5,5\n,,\nb , 2.5,10\n")
    assert [line for line, _ in table.rows] == [3, 5]
    assert table.rows[1][1] == {"subject": "b", "depth_mm": "2.5", "force_N": "10"}
    assert (table.decimal, table.factors) == (".", {"depth_mm": 1.0, "force_N": 1.0})


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " "])
def test_any_separator_is_found_by_the_names(tmp_path, separator):
    lines = [("subject", "depth_mm", "force_N"), ("a", "1.5", "5"), ("b", "2.5", "10")]
    table = read(tmp_path, "\n".join(separator.join(line) for line in lines))
    assert [row["depth_mm"] for _, row in table.rows] == ["1.5", "2.5"]


@pytest.mark.parametrize(
    ("head", "factors"),
    [
        ("Person;Depth (cm);Force (kgf)", (10.0, 9.80665)),
        ("Sujet;Enfoncement [mm];Charge [N]", (1.0, 1.0)),
        ("Proband;Weg in µm;Kraft in kN", (1e-3, 1e3)),
        ("Participant;Displacement (m);Load (mN)", (1e3, 1e-3)),
    ],
)
def test_names_of_people_and_units_of_quantities_are_known_in_four_languages(tmp_path, head, factors):
    table = read(tmp_path, f"{head}\na;1.5;5\n")
    assert table.rows[0][1] == {"subject": "a", "depth_mm": "1.5", "force_N": "5"}
    assert (table.factors["depth_mm"], table.factors["force_N"]) == pytest.approx(factors)


@pytest.mark.parametrize(("unit", "factor"), [("mm/s", 1.0), ("m/s", 1e3), ("cm/s", 10.0), ("mm/min", 1 / 60)])
def test_a_speed_has_its_unit_and_a_time_that_of_seconds(tmp_path, unit, factor):
    table = read(tmp_path, f"subject;depth_mm;force_N;Speed ({unit});Time (ms)\na;1.5;5;600;20\n", CURVES)
    assert table.factors["velocity_mm_s"] == pytest.approx(factor)
    assert table.factors["time_s"] == pytest.approx(1e-3)


def test_a_header_may_stand_below_forty_lines_of_text_and_no_deeper(tmp_path):
    head, row = "subject,depth_mm,force_N", "a,1.5,5"
    assert read(tmp_path, "\n".join(["note"] * 40 + [head, row])).rows == [
        (42, {"subject": "a", "depth_mm": "1.5", "force_N": "5"})
    ]
    with raises_code("missing", "subject"):
        read(tmp_path, "\n".join(["note"] * 42 + [head, row]))


def test_a_column_that_is_absent_is_named_unless_it_may_be(tmp_path):
    with raises_code("missing", "force_N"):
        read(tmp_path, "subject,depth_mm\na,1.5\n")
    table = read(tmp_path, "subject,depth_mm\na,1.5\n", optional=("force_N",))
    assert "force_N" not in table.factors and table.rows[0][1]["depth_mm"] == "1.5"
    # a force in millimetres is none
    with raises_code("missing", "force_N"):
        read(tmp_path, "subject,depth_mm,Force (mm)\na,1.5,5\n")


def test_a_row_that_is_short_has_empty_cells_and_a_quote_may_hold_the_separator(tmp_path):
    table = read(tmp_path, 'subject,depth_mm,force_N\n"Doe, J.",1.5\n')
    assert table.rows[0][1] == {"subject": "Doe, J.", "depth_mm": "1.5", "force_N": ""}


@pytest.mark.parametrize(
    ("cells", "decimal"), [(("1,5", "5"), ","), (("1.5", "5"), "."), (("1,25", "12,5"), ","), (("2", "10"), ".")]
)
def test_the_decimal_sign_is_that_of_the_numbers(tmp_path, cells, decimal):
    assert read(tmp_path, "subject;depth_mm;force_N\na;" + ";".join(cells)).decimal == decimal


def test_a_comma_that_may_be_a_thousand_is_refused(tmp_path):
    with raises_code("not_a_number", "points"):
        read(tmp_path, "subject;depth_mm;force_N\na;1,500;5\n")
    assert read(tmp_path, "subject;depth_mm;force_N\na;1,500;5\nb;1,5;5\n").decimal == ","


def test_a_comma_in_a_text_column_says_nothing_of_numbers(tmp_path):
    assert read(tmp_path, "subject;depth_mm;force_N\n1,5;2.5;5\n").decimal == "."


def test_files_that_cannot_be_read_are_named(tmp_path):
    with raises_code("file_not_found", "points"):
        read_named_table(tmp_path / "none.csv", "points", COLUMNS)
    with raises_code("file_unreadable", "points"):
        read_named_table(tmp_path, "points", COLUMNS)
    with raises_code("missing", "subject"):
        read(tmp_path, "")
    with raises_code("malformed", "points"):
        read(tmp_path, 'subject,depth_mm,force_N\n"' + "a" * 200_000)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_other_encodings_are_read(tmp_path, encoding):
    text = "Prüfling;subject;depth_mm;force_N\nä;a;1.5;5\n"
    assert read(tmp_path, text.encode(encoding)).rows[0][1]["subject"] == "a"
