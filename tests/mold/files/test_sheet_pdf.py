"""The pour sheet as PDF: pages, letters, the library's settings."""

from __future__ import annotations

import re

import pytest

from dummydesign.core.typeset import FONTS
from dummydesign.mold.files.drawing_sheet import CAP_SHARE, PAPERS, TEXT_MM, Drawing, Line, Text, text_width, to_pdf
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


def test_every_drawing_is_a_page_in_the_list_of_pages_with_its_letters_in_their_places():
    texts = [Text((50.0, 60.0), "scale  1:2 µ ±", 5.0), Text((100.0, 90.0), "upright", upright=True, middle=True)]
    data = to_pdf([LINE, Drawing("crown, A", 1.0, "A4", texts=texts)], "Drawings")
    assert pages_mm(data) == [pytest.approx(PAPERS[name], abs=0.01) for name in ("A3", "A4")]
    titles = re.findall(rb"/Title ?\(([^)]*)\)", data)
    assert sorted(titles) == [b"Drawings", b"crown, A", b"part"]
    assert "scale1:2µ±" in (letters := pdf_text(data).replace(" ", "")) and "upright" in letters


@pytest.mark.parametrize("words", ["0123456789 mm", "AVATo, Heat may warp the print.", "µ ± ° (20.5)"])
def test_a_text_is_as_wide_as_its_pdf_draws_it(words):
    """Letters that are moved together make it narrower by a few hundredths, never wider."""
    from PIL import ImageFont

    font = ImageFont.truetype(FONTS / "LiberationSans-Regular.ttf", 1000)
    drawn = font.getlength(words) / 1000 * TEXT_MM / CAP_SHARE
    assert drawn - 0.01 <= text_width(words, TEXT_MM) <= 1.05 * drawn
