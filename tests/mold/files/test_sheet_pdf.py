"""The pour sheet as PDF: pages, letters, the library's settings."""

from __future__ import annotations

import pytest

from dummydesign.mold.files.drawing_sheet import Drawing, Line, to_pdf
from dummydesign.mold.files.pour_sheet import Foot, SheetBlock, pour_sheet, sheet_pdf
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.pour.warnings import pour_warnings
from tests.support.pdf_paths import pages_mm
from tests.support.pdf_texts import pdf_text, pdf_texts, placed_texts

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


def test_letters_without_a_font_are_named_and_names_are_not_markup(monkeypatch):
    import typst

    whole = typst.Fonts
    monkeypatch.setattr(typst, "Fonts", lambda **more: whole(**{**more, "include_system_fonts": False}))
    blocks = [
        SheetBlock("head", "前 #pad"),
        SheetBlock("text", "resin <$x$; *15* ± 1>"),
        SheetBlock("table", rows=(("名", "@a"), ("x_y_", "2.64"))),
        SheetBlock("list", items=("= 1", "- 2")),
    ]
    texts = pdf_texts(sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-01")))
    assert {"[U+524D] #pad", "resin <$x$; *15* ± 1>", "[U+540D]", "@a", "x_y_", "2.64", "= 1", "- 2"} <= set(texts)


def test_no_heading_stands_alone_at_the_foot_of_a_page():
    rows = (("part", "g"), *(("polyol", "54.1"),) * 6)
    broken = 0
    for lines in range(30, 62, 3):
        blocks = [SheetBlock("head", "Sheet"), *[SheetBlock("text", "line")] * lines]
        blocks += [SheetBlock("head", "Weigh"), SheetBlock("table", rows=rows)]
        placed = placed_texts(sheet_pdf(blocks, Foot("ABCD", "command", "2026-01-01")))
        pages = {text.words: text.page for text in placed if text.words in ("Weigh", "part", "54.1")}
        assert len(set(pages.values())) == 1
        broken += pages["Weigh"] > 0
    assert 0 < broken < 11


def test_every_page_has_its_number_and_the_hash():
    data = sheet_pdf([SheetBlock("head", "Sheet"), SheetBlock("list", items=("one",) * 200)], Foot("ABCD", "typed"))
    count, text = len(pages_mm(data)), pdf_text(data)
    assert count > 2 and all(f"Specification ABCD page {page} of {count}" in text for page in range(1, count + 1))


def test_drawings_leave_the_settings_of_their_library_as_they_were(monkeypatch):
    from reportlab import rl_config

    monkeypatch.setattr(rl_config, "useA85", 1)
    data = to_pdf([LINE], "a")
    assert rl_config.useA85 == 1 and b"ASCII85Decode" not in data
