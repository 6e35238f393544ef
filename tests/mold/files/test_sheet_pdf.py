"""The pour sheet as PDF: pages, letters, the library's settings."""

from __future__ import annotations

import pytest

from dummydesign.mold.files.drawing_sheet import Drawing, Line, to_pdf
from dummydesign.mold.files.pour_sheet import Foot, SheetBlock, pour_sheet, sheet_pdf
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.pdf_paths import pages_mm

LINE = Drawing("part", 1.0, "A3", [Line(((50.0, 60.0), (150.0, 60.0)), "outline")])


@pytest.mark.parametrize("paper, size", [("A4", (210.0, 297.0)), ("A3", (297.0, 420.0))])
def test_every_page_is_on_its_paper(open_spec, paper, size):
    plan = pour_plan(open_spec)
    blocks = pour_sheet(open_spec, plan, pour_warnings(open_spec, plan))
    sizes = pages_mm(sheet_pdf(blocks, Foot(open_spec.hash, "dummydesign mold", "2026-01-01", paper), [LINE]))
    assert len(sizes) >= 2 and all(one == pytest.approx(size, abs=0.01) for one in sizes)


def test_equal_sheets_are_equal_files_and_another_date_is_another_file(open_spec):
    blocks = [
        SheetBlock("head", "Sheet"),
        SheetBlock("text", "µ, ° and — are letters too"),
        SheetBlock("list", items=("one",) * 200),
    ]
    first = sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-01"))
    assert sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-01")) == first
    assert sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-02")) != first and len(pages_mm(first)) > 2


def test_a_word_wider_than_its_column_and_marks_of_html_do_no_harm():
    rows = (("a", "b <c> & d"), ("x" * 300, "y"))
    assert pages_mm(sheet_pdf([SheetBlock("head", "<b>"), SheetBlock("table", rows=rows)], Foot("A", "c " * 500, "")))


def test_japanese_letters_have_a_font_that_holds_them():
    blocks = [
        SheetBlock("head", "前指"),
        SheetBlock("text", "resin <ウレタン> 15 ± 1"),
        SheetBlock("table", rows=(("名",), ("x",))),
    ]
    data = sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-01"))
    assert b"HeiseiKakuGo-W5" in data and pages_mm(data)
    assert b"HeiseiKakuGo" not in sheet_pdf([SheetBlock("text", "resin ± 1")], Foot("ABCD", "command", "2026-01-01"))


def test_pdfs_of_a_mould_leave_the_settings_of_their_library_as_they_were(monkeypatch):
    from reportlab import rl_config

    monkeypatch.setattr(rl_config, "useA85", 1)
    for data in (sheet_pdf([SheetBlock("head", "a")], Foot("A")), to_pdf([LINE], "a")):
        assert rl_config.useA85 == 1 and b"ASCII85Decode" not in data
