"""From bytes to a table: encodings, separators, decimal and thousands signs, headers, damaged text."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.measurement.importing.cells import decimal_evidence, is_number, parse, seconds_of_stamp
from dummydesign.measurement.importing.decisions import ImportLog, NoTableError, Settings
from dummydesign.measurement.importing.layout import find_layout
from dummydesign.measurement.importing.table import decode, read_body
from tests.support.refusal import raises_code

ROWS = [(0.01 * i, -1.0 + 0.1 * i, 0.004 * i * i) for i in range(40)]


def table(separator=",", decimal=".", head="Zeit,Weg,Kraft", digits=4):
    lines = [head.replace(",", separator)] if head else []
    for row in ROWS:
        lines.append(separator.join(f"{value:.{digits}f}".replace(".", decimal) for value in row))
    return "\n".join(lines) + "\n"


def layout_of(text, **settings):
    return find_layout(text, ImportLog("a.csv", Settings(**settings)))


def values_of(text, **settings):
    layout = layout_of(text, **settings)
    return read_body(layout, range(len(layout.kinds)), ImportLog("a.csv")).values


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
def test_unicode_files_are_decoded_with_and_without_a_mark(encoding):
    text = table(head="Prüfzeit,Weg,Kraft")
    assert decode(text.encode(encoding), ImportLog("a.csv")) == text


@pytest.mark.parametrize(
    ("encoding", "head"),
    [
        ("cp1252", "Prüfzeit,Weg,Prüfkraft"),
        ("latin-1", "Durée,Déplacement,Force"),
        ("cp932", "時間,変位,荷重"),
        ("euc_jp", "試験時間,押込み深さ,荷重"),
        ("mac_roman", "Prüfzeit,Weg,Prüfkraft"),
        ("cp850", "Prüfzeit,Weg,Prüfkraft"),
    ],
)
def test_a_code_page_is_told_by_the_words_that_are_known_in_it(encoding, head):
    assert decode(table(head=head).encode(encoding), ImportLog("a.csv")).splitlines()[0] == head


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"", "not_enough_data"),
        (b" \r\n\n", "not_enough_data"),
        (b"%PDF-1.7 ...", "file_unreadable"),
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "file_unreadable"),
        (b"0,1\x00,2\n", "file_unreadable"),
    ],
)
def test_what_is_no_text_says_what_it_is(data, code):
    with raises_code(code):
        decode(data, ImportLog("a.csv"))


def test_a_given_encoding_is_used_or_refused():
    assert decode("Prüf".encode("cp850"), ImportLog("a.csv", Settings(encoding="cp850"))) == "Prüf"
    with raises_code("unknown_name", "encoding"):
        decode(b"a", ImportLog("a.csv", Settings(encoding="cp99999")))
    with raises_code("inconsistent", "encoding"):
        decode(b"\xff\xfa", ImportLog("a.csv", Settings(encoding="utf-8")))


@pytest.mark.parametrize("separator", [",", ";", "\t", "|", " ", "   "])
@pytest.mark.parametrize("decimal", [".", ","])
def test_separator_and_decimal_sign_are_found(separator, decimal):
    if separator == decimal:
        pytest.skip("one sign for both is refused, see below")
    assert np.allclose(values_of(table(separator, decimal)), ROWS, atol=1e-4)


def test_quoted_numbers_with_a_decimal_comma_between_commas_are_read():
    lines = ['"Temps (s)","Course (mm)","Charge (N)"']
    lines += [",".join(f'"{value:.4f}"'.replace(".", ",") for value in row) for row in ROWS]
    assert np.allclose(values_of("\n".join(lines) + "\n"), ROWS, atol=1e-4)


def test_a_comma_for_both_is_refused_and_the_mend_is_named():
    with raises_code("malformed", "table"):
        layout_of(table(",", ",", "Zeit,Weg,Kraft"))


@pytest.mark.parametrize(
    ("cell", "decimal", "value"),
    [
        ("1.234,5", ",", 1234.5),
        ("1,234.5", ".", 1234.5),
        ("1'234.5", ".", 1234.5),
        ("1 234,5", ",", 1234.5),
        ("1\u202f234,5", ",", 1234.5),
        ("-0,25", ",", -0.25),
        ("−0.25", ".", -0.25),
        ("+1.5E-03", ".", 0.0015),
        ("12.", ".", 12.0),
        (".5", ".", 0.5),
        ("1,234,567", ".", 1234567.0),
    ],
)
def test_numbers_are_read_with_thousands_signs_and_typographic_minus(cell, decimal, value):
    assert is_number(cell) and parse(cell, decimal) == pytest.approx(value)


@pytest.mark.parametrize("cell", ["", "abc", "1.2.3", "0,123.4", "--1", "1e", "12 N", "0x1f", "1_000", "½", "١٢"])
def test_what_is_no_number_is_none(cell):
    assert parse(cell, ".") is None


def test_the_decimal_sign_is_told_by_numbers_that_can_be_read_in_one_way_only():
    assert decimal_evidence(["0,795", "17,95"]) == {".": 0, ",": 2, "either": 0}
    assert decimal_evidence(["1,795", "12.345"]) == {".": 0, ",": 0, "either": 2}
    assert decimal_evidence(["1.795,20", "1,234,567"]) == {".": 1, ",": 1, "either": 0}


def test_numbers_that_may_be_decimals_or_thousands_are_asked_for():
    lines = ["a;b;c"] + [f"{i},{100 + i};{i + 1},{200 + i};{i + 2},{300 + i}" for i in range(1, 30)]
    text = "\n".join(lines) + "\n"
    with raises_code("needs_decision", "decimal"):
        layout_of(text)
    assert values_of(text, decimal=",")[0] == pytest.approx([1.101, 2.201, 3.301])
    assert values_of(text, decimal=".")[0] == pytest.approx([1101.0, 2201.0, 3301.0])


def test_a_decimal_sign_that_the_numbers_contradict_is_refused():
    with raises_code("inconsistent", "decimal"):
        layout_of(table(";", ","), decimal=".")


def test_thousands_signs_that_stand_in_few_rows_only_are_seen():
    rows = [f"0,{i:02d};{i}.5;{'1.234,5' if i == 25 else f'{i},5'}".replace(".5;", ",5;") for i in range(40)]
    assert values_of("Zeit;Weg;Kraft\n" + "\n".join(rows) + "\n")[25, 2] == 1234.5


def test_preamble_units_comments_and_footer_are_parted_from_the_table():
    text = (
        "Prüfprotokoll\nv;10;mm/s\n\nZeit;Weg;Kraft\ns;mm;N\n# begin\n"
        + table(";", ",", head="")
        + "\nEnde der Prüfung\nMax;2,9;6,08\n"
    )
    notes = ImportLog("a.csv")
    layout = find_layout(text, notes)
    assert layout.names == ("Zeit", "Weg", "Kraft") and layout.units == ("s", "mm", "N")
    assert len(read_body(layout, [0, 1, 2], notes).values) == len(ROWS)
    assert {"preamble", "footer"} <= {decision.what for decision in notes.decisions}


def test_units_may_stand_above_the_names_and_behind_a_comment_sign():
    layout = layout_of("s;mm;N\nZeit;Weg;Kraft\n" + table(";", ",", head=""))
    assert layout.names == ("Zeit", "Weg", "Kraft") and layout.units == ("s", "mm", "N")
    layout = layout_of("# time[s] depth[mm] load[N]\n" + table(" ", ".", head=""))
    assert layout.names == ("time[s]", "depth[mm]", "load[N]")


def test_names_with_spaces_stand_over_columns_parted_by_spaces():
    layout = layout_of("Elapsed Time (s)   Axial Force (N)   Position (mm)\n" + table("   ", ".", head=""))
    assert layout.names == ("Elapsed Time (s)", "Axial Force (N)", "Position (mm)")


def test_a_header_whose_quoted_cells_go_over_two_lines_is_one_row():
    text = '"Time\n(s)","Extension\n(mm)","Load\n(N)"\n' + table(head="")
    assert layout_of(text).names == ("Time (s)", "Extension (mm)", "Load (N)")
    with raises_code("not_a_number", "cell"):
        values_of(text.replace("\n0.1000", "\nbad"))


def test_a_skip_beyond_the_last_line_leaves_no_table():
    with pytest.raises(NoTableError):
        layout_of(table(), skip=400)


def test_a_row_that_counts_the_columns_is_no_data():
    assert values_of("Zeit;Weg;Kraft\ns;mm;N\n1;2;3\n" + table(";", ",", head=""))[0, 0] == 0.0


def test_a_blank_line_below_the_first_row_is_passed_over():
    first, _, rest = table(" ", head="").partition("\n")
    assert len(values_of(f"{first}\n\n{rest}")) == len(ROWS)


def test_a_tab_at_the_end_of_every_line_makes_no_column():
    layout = layout_of(table("\t", head="Zeit,Weg,Kraft,Comment").replace("\n0", "\t\n0"))
    assert layout.separator == "\t" and layout.names[:3] == ("Zeit", "Weg", "Kraft")


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_every_kind_of_line_end_is_one(newline):
    assert len(values_of(table().replace("\n", newline))) == len(ROWS)


@pytest.mark.parametrize(
    ("bad", "code"),
    [
        ("0.4000,abc,1.0", "not_a_number"),
        ("0.4000,nan,1.0", "missing"),
        ("0.4000,,1.0", "missing"),
        ("0.4000,1.0", "malformed"),
        ("0.4000,1.0,2.0,3.0", "malformed"),
        ("0.4000,1e999,1.0", "out_of_range"),
    ],
)
def test_a_bad_row_is_named_by_its_line(bad, code):
    with raises_code(code):
        values_of(table() + bad + "\n" + table(head=""))


def test_text_between_rows_parts_the_table():
    layout = layout_of(table() + "Cycle 2\n" + table())
    body = read_body(layout, [0, 1, 2], ImportLog("a.csv"))
    assert len(body.values) == 2 * len(ROWS) and body.breaks == (len(ROWS),)
    assert body.lines[len(ROWS)] == len(ROWS) + 4


@pytest.mark.parametrize("tail", ["0.4000,1.0", "0.4000,1.0,", "0.4000,1.0000,1.02"])
def test_a_file_that_is_being_written_is_refused(tail):
    with raises_code("malformed", "table"):
        layout_of(table() + tail)


def test_a_last_line_without_its_end_is_read_when_it_is_whole():
    assert len(values_of(table().rstrip("\n"))) == len(ROWS)


@pytest.mark.parametrize("text", ["# nothing\n\n", "Zeit;Weg;Kraft\n", "hello\nworld\n", "1\n2\n3\n4\n"])
def test_a_file_without_a_table_says_so(text):
    with pytest.raises(NoTableError):
        layout_of(text)


def test_clock_times_are_seconds_of_the_day():
    assert seconds_of_stamp("14:02:11,125")[0] == pytest.approx(50531.125)
    assert seconds_of_stamp("2025-11-19T14:02:11.125")[0] == pytest.approx(50531.125)
    assert seconds_of_stamp("19.11.2025 02:02:11.5 PM") == (pytest.approx(50531.5), "19.11.2025")
    assert seconds_of_stamp("2:11.5")[0] == pytest.approx(131.5)
    assert seconds_of_stamp("25:00:00") is None


def test_clock_times_go_on_over_midnight():
    rows = [f"23:59:59.{i:02d};{i};{i}" for i in range(50, 100)] + [f"00:00:00.{i:02d};{i};{i}" for i in range(50)]
    seconds = values_of("Uhrzeit;Weg;Kraft\n" + "\n".join(rows) + "\n")[:, 0]
    assert np.allclose(np.diff(seconds), 0.01)


def dated(*dates, last="23:59:59", first="00:00:00", separator=";"):
    """A table of two rows of each date: at the end of the first day, at the beginning of the others."""
    lines, head = [], "Datum;Weg;Kraft".replace(";", separator)
    for place, date in enumerate(dates):
        for part in range(2):
            number = str(2 * place + part)
            lines.append(separator.join([f"{date}{first if place else last}.{part}", number, number]))
    return head + "\n" + "\n".join(lines) + "\n"


def seconds_and_notes(text):
    layout, notes = layout_of(text), ImportLog("a.csv")
    columns = [at for at, kind in enumerate(layout.kinds) if kind in ("stamp", "number")]
    return read_body(layout, columns, notes).values[:, 0], {one.what: one for one in notes.decisions}


@pytest.mark.parametrize(
    ("dates", "days"),
    [
        (("2026-02-27 ", "2026-03-02 "), [3]),
        (("2026-02-27 ", "2026-02-28 ", "2026-03-02 "), [1, 3]),
        (("31.01.2026 ", "03.02.2026 "), [3]),
        (("3.1.2026 ", "4.1.2026 "), [1]),
        (("04.03.2026 ", "04.04.2026 "), [31]),
        (("1/30/2026 ", "2/2/2026 "), [3]),
        (("03/04/2026 ", "03/05/2026 "), [1]),
        (("03/04/2026 ", "04/04/2026 "), [1]),
        (("28/02/26 ", "02/03/26 "), [2]),
        (("2026/12/31T", "2027/01/01T"), [1]),
    ],
)
def test_a_gap_between_dates_is_as_long_as_the_dates_say(dates, days):
    seconds, notes = seconds_and_notes(dated(*dates))
    assert seconds[::2] - seconds[0] == pytest.approx([0.0, *(86400.0 * day - 86399.0 for day in days)])
    assert notes["days"].value.split()[0] == str(days[-1]) and "midnight" not in notes


@pytest.mark.parametrize("separator", [";", " "])
def test_dates_in_a_column_of_their_own_count(separator):
    text = dated(f"2026-02-27{separator}", f"2026-03-02{separator}", separator=separator)
    text = text.replace("Datum", f"Datum{separator}Zeit", 1)
    assert seconds_and_notes(text)[0][2] - 86399.0 == pytest.approx(2 * 86400.0 + 1.0)


def test_one_date_in_every_row_is_that_of_the_test_and_the_clock_goes_on_over_midnight():
    text = dated("2026-02-27;", "2026-02-27;").replace("Datum", "Datum;Zeit", 1)
    seconds, notes = seconds_and_notes(text)
    assert seconds[2] - seconds[0] == pytest.approx(1.0) and "midnight" in notes


def test_an_hour_that_goes_back_on_the_same_date_is_no_day():
    seconds, notes = seconds_and_notes(dated("2026-02-27 ", "2026-02-27 "))
    assert seconds[2] < seconds[1] and not {"days", "midnight"} & set(notes)


def test_a_date_that_goes_back_is_no_day_ahead():
    seconds, _ = seconds_and_notes(dated("2026-02-27 ", "2026-02-25 "))
    assert seconds[2] - seconds[0] == pytest.approx(-2 * 86400.0 - 86399.0)


def test_a_day_that_is_guessed_is_among_the_decisions():
    seconds, notes = seconds_and_notes(dated("", ""))
    assert seconds[2] - seconds[0] == pytest.approx(1.0)
    assert notes["midnight"].value.startswith("1 ") and "days" not in notes
    assert "midnight" not in seconds_and_notes(dated("", "", first="23:59:59"))[1]


def test_dates_in_no_order_are_refused():
    with raises_code("malformed", "date"):
        seconds_and_notes(dated("31.31.2026 ", "32.31.2026 "))


def test_the_quick_and_the_patient_reader_agree():
    quick = values_of(table(";", ","))
    patient = values_of(table(";", ",") + "\nCycle 2\n" + table(";", ",", head=""))
    assert np.array_equal(quick, patient[: len(quick)])
