"""Workbooks as test programs write them: a sheet of results, a sheet a specimen, and what people add beside."""

from __future__ import annotations

import re
import zipfile

import numpy as np
import pytest

from dummydesign.measurement.importing.decisions import QuestionError, Settings
from dummydesign.measurement.importing.read import describe, import_files, plan_traces
from tests.support.refusal import raises_code

openpyxl = pytest.importorskip("openpyxl")
NAMES = ("Temps d'essai", "Force standard", "Allongement", "Ecartement entre outils")
UNITS = ("s", "N", "mm", "mm")


def press(surface_mm=0.0, stiffness=0.4, offset_N=0.0, rest_s=2.0):
    """Time, force and way of a ramp and hold; the surface may lie below the machine's zero."""
    time = np.arange(0.0, 16.0, 0.1)
    way = np.clip(time - rest_s, 0.0, 4.0)
    depth = np.maximum(way - surface_mm, 0.0)
    relaxed = 0.6 + 0.4 * np.exp(-np.maximum(time - rest_s - 4.0, 0.0) / 3.0)
    noise = 2e-4 * np.sin(37.0 * time)
    return time, stiffness * depth**1.5 * relaxed + offset_N + noise, way


def add_sheet(book, title, data, beside=False, note=()):
    """A specimen's sheet: its title over every column, French names, units, numbers; then what a person adds."""
    sheet = book.create_sheet(title)
    sheet.append([title] * 4)
    sheet.append([*NAMES, *([None, None, 20, 80] if beside else [])])
    sheet.append(UNITS)
    for at, (t, force, way) in enumerate(zip(*(column.tolist() for column in data))):
        sheet.append([t, force, way, 15.0 - way, *([None, 100 * way / 15.0] if beside and 3 < at < 90 else [])])
    if note:
        sheet.append(note)


def book_of_tests(path, tests, beside=(), note=()):
    book = openpyxl.Workbook()
    parameters = book.active
    parameters.title = "Paramètres"
    parameters.append([None, None, None])
    for row in (("HR", "%", 25), ("TA", "°C", 28), ("Opérateur", None, "A")):
        parameters.append(row)
    results = book.create_sheet("Résultats")
    results.append([None, "Désignation éprouvette", "Fmax", "dL(Fmax)"])
    results.append([None, None, "N", "mm"])
    for title, (_, force, _) in tests.items():
        results.append([title, title, float(force.max()), 4.0])
    for title, data in tests.items():
        add_sheet(book, title, data, title in beside, note)
    book.save(path)


def test_each_sheet_of_a_specimen_is_a_test_of_its_own(tmp_path):
    tests = {"230407_FF1A": press(), "230407_FF1B": press(1.5, 1.2), "230407_RDG1A": press(0.5, 0.8)}
    book_of_tests(tmp_path / "day.xlsx", tests, beside=("230407_FF1B",))
    read, warnings = import_files([tmp_path / "day.xlsx"])
    assert not warnings and [one.sheet for one in read] == list(tests)
    for one, (title, (_, force, _)) in zip(read, tests.items()):
        assert len(one.presses) == 1 and title in one.name
        found = one.presses[0]
        assert found.force_N.max() == pytest.approx(float(force.max()), abs=2e-3)
        # each specimen has a zero of its own: no depth of one is counted from the surface of another
        surface = {"230407_FF1A": 0.0, "230407_FF1B": 1.5, "230407_RDG1A": 0.5}[title]
        assert found.displacement_mm.max() == pytest.approx(4.0 - surface, abs=0.15)
    planned = plan_traces(read, tmp_path)
    assert [name for _, _, name in planned] == [f"day_{title}_1.csv" for title in tests]
    rows = describe(read, planned)
    assert [row["sheet"] for row in rows] == list(tests) and len({row["source"] for row in rows}) == 1


def test_numbers_below_and_beside_the_table_of_a_sheet_are_left_out(tmp_path):
    tests = {"A": press(), "B": press(0.0, 0.7)}
    book_of_tests(tmp_path / "day.xlsx", tests, beside=("A",), note=(None, 0.5, 12.0))
    read, _ = import_files([tmp_path / "day.xlsx"])
    assert [len(one.presses[0].time_s) for one in read] == [len(data[0]) for data in tests.values()]


def test_one_recording_over_two_sheets_stays_one_press(tmp_path):
    time, force, way = press()
    halves = {"part 1": (time[:80], force[:80], way[:80]), "part 2": (time[80:], force[80:], way[80:])}
    book_of_tests(tmp_path / "long.xlsx", halves)
    read, _ = import_files([tmp_path / "long.xlsx"])
    assert len(read) == 1 and read[0].sheet == "" and len(read[0].presses[0].time_s) == len(time)


def test_every_test_may_begin_with_an_offset_of_its_own(tmp_path):
    offsets = {"A": -0.826, "B": 0.31}
    tests = {title: press(0.0, 2.0, offset, rest_s=0.0) for title, offset in offsets.items()}
    book_of_tests(tmp_path / "day.xlsx", tests)
    with pytest.raises(QuestionError) as asked:
        import_files([tmp_path / "day.xlsx"])
    assert (asked.value.code, asked.value.quantity) == ("needs_decision", "tare")
    read, _ = import_files([tmp_path / "day.xlsx"], Settings(tare="first"))
    for one, offset in zip(read, offsets.values()):
        _, force, _ = tests[one.sheet]
        assert one.presses[0].force_N.max() == pytest.approx(float(force.max()) - offset, abs=2e-3)
        assert abs(one.presses[0].force_N[0]) < 1e-3


def test_a_sheet_in_doubt_is_named_and_the_others_can_be_chosen(tmp_path):
    tests = {"A": press(), "B, wet": press(1.5, 800.0), "C": press(0.5, 0.8)}
    book_of_tests(tmp_path / "day.xlsx", tests)
    assert float(tests["B, wet"][1].max()) > 2000.0  # more than machines do: the unit is asked for
    with raises_code("needs_decision", "units") as caught:
        import_files([tmp_path / "day.xlsx"])
    assert "[B, wet]" in str(caught.value)
    option = re.search(r'--sheets "([^"]+)"', str(caught.value))[1]
    for sheets in (option, "C,A", "a, c"):
        read, _ = import_files([tmp_path / "day.xlsx"], Settings(sheets=sheets))
        assert [one.sheet for one in read] == ["A", "C"]
    read, _ = import_files([tmp_path / "day.xlsx"], Settings(sheets="C"))
    assert len(read) == 1 and read[0].presses[0].summary.peak_force_N == pytest.approx(tests["C"][1].max(), rel=0.02)
    with raises_code("needs_decision", "units") as caught:
        import_files([tmp_path / "day.xlsx"], Settings(sheets="B, wet,C"))
    assert '--sheets "C"' in str(caught.value)


def test_sheets_that_are_not_there_are_refused(tmp_path):
    book_of_tests(tmp_path / "day.xlsx", {"A": press(), "B": press(0.5)})
    np.savetxt(tmp_path / "a.csv", np.c_[press()], header="time [s],force [N],way [mm]", delimiter=",", comments="")
    for name, sheets, code in (
        ("day.xlsx", "A,D", "unknown_name"),
        ("day.xlsx", "not:A,B", "nothing_found"),
        ("a.csv", "A", "not_applicable"),
    ):
        with raises_code(code, "sheets"):
            import_files([tmp_path / name], Settings(sheets=sheets))


def rows_of(data):
    return [["Zeit [s]", "Weg [mm]", "Kraft [N]"], *([t, x, f] for t, f, x in zip(*(one.tolist() for one in data)))]


def write_ods(path, rows):
    """The least OpenDocument spreadsheet: a mimetype, a manifest and one table."""
    cells = (
        "".join(
            f'<table:table-cell office:value-type="string"><text:p>{cell}</text:p></table:table-cell>'
            if isinstance(cell, str)
            else f'<table:table-cell office:value-type="float" office:value="{cell!r}"/>'
            for cell in row
        )
        for row in rows
    )
    table = "".join(f"<table:table-row>{one}</table:table-row>" for one in cells)
    names = " ".join(
        f'xmlns:{name}="urn:oasis:names:tc:opendocument:xmlns:{name}:1.0"' for name in ("office", "table", "text")
    )
    content = f"<office:document-content {names}><office:body><office:spreadsheet>"
    content += f'<table:table table:name="Test">{table}</table:table></office:spreadsheet></office:body>'
    kind = "application/vnd.oasis.opendocument.spreadsheet"
    manifest = "urn:oasis:names:tc:opendocument:xmlns:manifest:1.0"
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("mimetype", kind)
        packed.writestr("content.xml", f"{content}</office:document-content>")
        entry = f'<manifest:file-entry manifest:full-path="/" manifest:media-type="{kind}"/>'
        packed.writestr(
            "META-INF/manifest.xml", f'<manifest:manifest xmlns:manifest="{manifest}">{entry}</manifest:manifest>'
        )


def write_xls(path, rows):
    xlwt = pytest.importorskip("xlwt")
    book = xlwt.Workbook()
    sheet = book.add_sheet("Test")
    for at, row in enumerate(rows):
        for column, cell in enumerate(row):
            sheet.write(at, column, cell)
    book.save(str(path))


@pytest.mark.parametrize(("ending", "write"), [("ods", write_ods), ("xls", write_xls)])
@pytest.mark.parametrize("seed", [0, 1])
def test_other_workbooks_read_as_the_text_of_the_same_rows(tmp_path, ending, write, seed):
    draw = np.random.default_rng([seed, 7])
    rows = rows_of(press(float(draw.uniform(0, 1)), float(draw.uniform(0.3, 1)), rest_s=float(draw.uniform(1, 3))))
    write(tmp_path / f"a.{ending}", rows)
    text = "\n".join(";".join(cell if isinstance(cell, str) else repr(cell) for cell in row) for row in rows)
    (tmp_path / "a.csv").write_text(text + "\n", encoding="utf-8")
    ((book, text_file), _) = import_files([tmp_path / f"a.{ending}", tmp_path / "a.csv"])
    for name in ("time_s", "displacement_mm", "force_N"):
        assert np.array_equal(getattr(book.presses[0], name), getattr(text_file.presses[0], name))


def test_a_damaged_workbook_is_refused_by_its_name(tmp_path):
    (tmp_path / "a.xls").write_bytes(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600))
    with raises_code("file_unreadable", "workbook"):
        import_files([tmp_path / "a.xls"])
