"""Prose of pages that a study writes is put into lines of 120 characters, and nothing else changes."""

from __future__ import annotations

import re

from studies.marked_page import WIDTH, wrapped

TABLE = "| a | b |\n|---|---|\n| " + "long " * 40 + "| 1 |\n"
CODE = "```sh\n" + "word " * 40 + "\n```\n"


def test_paragraphs_and_items_are_wrapped_and_keep_their_words():
    page = f"# {'Head ' * 40}\n\n{'word ' * 60}\n\n- {'one ' * 70}\n- two\n  and more\n\n1. {'three ' * 50}\n"
    lines = wrapped(page).splitlines()
    assert wrapped(page).split() == page.split()
    assert max(len(line) for line in lines if not line.startswith("#")) <= WIDTH
    assert sum(line.startswith(("- ", "1. ")) for line in lines) == 3
    assert "- two and more" in lines
    assert wrapped("\n".join(lines)).splitlines() == lines


def test_tables_code_and_marks_stay():
    page = f"<!-- {'mark ' * 40} -->\n\n{TABLE}\n{CODE}\n    dummydesign {'option ' * 30}\n"
    assert wrapped(page) == page


def test_no_line_becomes_a_list_item():
    for word in ("-", "5.", "+", "#2"):
        page = f"{'x' * (WIDTH - 1)} {word} rest\n"
        assert not any(re.match(r"[-+#]|\d+\.", line) for line in wrapped(page).splitlines())
