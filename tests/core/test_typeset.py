"""The door to Typst: texts are data, letters without a font are named, headings stay with what follows."""

import pytest

from dummydesign.core.typeset import PACKAGE, typeset
from tests.support.pdf_paths import pages_mm
from tests.support.pdf_texts import objects, pdf_texts, placed_texts

typst = pytest.importorskip("typst")

PLAIN = """
#import "/core/sheet.typ": *
#set page(width: 100mm, height: 100mm, margin: 10mm)
#show: sheet.with(data.title)
#heading(data.title)
"""


@pytest.fixture
def template(tmp_path, monkeypatch):
    """Write a template; the package's folder is the one that it lies in."""
    for part in ("core", "core/fonts"):
        (tmp_path / part).mkdir()
    (tmp_path / "core" / "sheet.typ").write_bytes((PACKAGE / "core" / "sheet.typ").read_bytes())
    monkeypatch.setattr("dummydesign.core.typeset.PACKAGE", tmp_path)

    def written(markup):
        path = tmp_path / "page.typ"
        path.write_text(PLAIN + markup, encoding="utf-8")
        return path

    return written


HOSTILE = (
    "#let a = 1",
    "$x$; 2.64",
    "*bold* _it_",
    "@key <label>",
    "\"q\" 'r' `raw`",
    "a -- b --- c ... -5",
    "\\u{41} // /* x */",
    "[a](b) ~ ^",
    "= head",
    "- item",
    "{json} \\n",
)


@pytest.mark.parametrize("name", HOSTILE)
def test_no_text_is_markup(template, name):
    assert pdf_texts(typeset(template("#data.name"), {"title": name, "name": name})) == [name, name]


def test_equal_data_give_equal_bytes_and_the_pages_are_tagged(template):
    path = template("#data.text")
    first, second, other = (typeset(path, {"title": "a", "text": text}) for text in ("b", "b", "c"))
    assert first == second != other
    tags = b"".join(objects(first).values()).replace(b" ", b"")
    assert b"/S/H1" in tags and b"/Markedtrue" in tags


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("bell\a", "bell[U+0007]"),
        ("half\udcff.csv", "half[U+DCFF].csv"),
        ("mark\ufeff", "mark[U+FEFF]"),
        ("e\u0301", "é"),
        ("한", "[U+D55C]"),
        ("指尖 3", "[U+6307][U+5C16] 3"),
    ],
)
def test_a_letter_that_no_font_has_is_written_as_its_code(template, monkeypatch, name, written):
    whole = typst.Fonts
    monkeypatch.setattr(typst, "Fonts", lambda **more: whole(**{**more, "include_system_fonts": False}))
    assert pdf_texts(typeset(template("#data.name"), {"title": "a", "name": name}))[1:] == [written]


def test_a_fault_of_a_template_is_not_taken_for_a_letter(template):
    with pytest.raises(typst.TypstError):
        typeset(template("#data.missing"), {"title": "指"})


def test_a_number_that_is_none_is_refused(template):
    with pytest.raises(ValueError):
        typeset(template("#data.x"), {"title": "a", "x": float("nan")})


def test_a_heading_never_stands_alone_at_the_foot_of_a_page(template):
    path = template(
        """
#for n in range(data.lines) [line #n \\ ]
#heading(level: 2, data.head)
#table(columns: 2, table.header(..data.names), ..data.cells)
"""
    )
    broken = 0
    for lines in range(6, 24):
        content = {
            "title": "a",
            "lines": lines,
            "head": "Weigh",
            "names": ["part", "g"],
            "cells": ["polyol", "54.1"] * 3,
        }
        texts = placed_texts(typeset(path, content))
        head, first = (next(text for text in texts if text.words == words) for words in ("Weigh", "part"))
        assert head.page == first.page and first.y_mm > head.y_mm
        broken += head.page > 0
    assert 0 < broken < 18


@pytest.mark.parametrize("lines", [1, 2, 4])
def test_a_cut_text_keeps_to_its_lines_and_ends_at_a_space(template, lines):
    path = template("#cut(data.text, lines: data.lines, size: 10pt)")
    texts = pdf_texts(typeset(path, {"title": "a", "text": "12.345 " * 80, "lines": lines}))[1:]
    assert len(texts) == lines and texts[-1].endswith(" ...")
    assert set(" ".join(texts).split()) == {"12.345", "..."}
    assert pdf_texts(typeset(path, {"title": "a", "text": "whole", "lines": lines}))[1:] == ["whole"]


def test_a_long_path_is_broken_and_nothing_is_put_into_it(template):
    name = "/".join(["folder-of-the-lab"] * 12)
    data = typeset(template("#data.name"), {"title": "a", "name": name})
    texts = placed_texts(data)[1:]
    assert "".join(text.words for text in texts) == name and len({text.y_mm for text in texts}) > 1
    assert all(text.x_mm + text.width_mm <= 90.1 for text in texts) and len(pages_mm(data)) == 1


@pytest.mark.parametrize("whole", ["24 N/cm2", "suggest --diameter 50"])
def test_neither_a_unit_nor_an_option_is_broken(template, whole):
    word, path = whole.split()[1], template("#data.text")
    lines = [pdf_texts(typeset(path, {"title": "a", "text": "x " * words + whole})) for words in range(20, 50)]
    assert all(any(word in line for line in texts) for texts in lines)
    assert len({len(texts) for texts in lines}) > 1
