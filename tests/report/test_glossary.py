"""The glossary: one source, found in the words of a page, short."""

from __future__ import annotations

import re
from pathlib import Path

from dummydesign.report.page import Section, folded_glossary, glossary_page, page, terms, terms_in

ROOT = Path(__file__).parents[2]
NEEDED = (
    "pad",
    "punch",
    "base",
    "steady force",
    "peak force",
    "press",
    "trace",
    "campaign",
    "mould",
    "ratio",
    "modulus",
    "interval",
    "subject",
    "band",
    "recipe",
    "puck",
    "effect",
    "calibration",
    "residual",
    "casting",
    "shortfall",
    "over-reading",
    "correction",
    "verdict level",
    "aim",
    "bonded",
    "crown",
    "layer",
    "bone",
    "foot",
    "tip radius",
    "draft",
    "thickness",
    "Prony arm",
    "relaxation",
    "hold",
    "lowpass",
    "verification",
)


def test_every_term_of_the_field_has_one_short_line():
    known = terms()
    assert [word for word in NEEDED if word.lower() not in known] == []
    for term in set(known.values()):
        assert "\n" not in term.text and term.text[0].isupper() and term.text.endswith((".", "]")), term.name
        assert all(len(part.split()) <= 20 for part in re.split(r"[.;] ", term.text)), term.name


def test_the_page_of_the_documentation_is_the_data_file():
    assert (ROOT / "docs" / "glossary.md").read_text(encoding="utf-8") == glossary_page()
    assert "glossary.md" in (ROOT / "mkdocs.yml").read_text(encoding="utf-8")


def test_terms_are_found_in_the_visible_words_alone():
    text = (
        "<p class='pad'>Two Presses and <b>moduli</b> of the pre-cast&nbsp;foot-print; pads&#x27;.</p>"
        "<script>let puck</script><style>.bone{}</style><svg><title>crown</title></svg>"
    )
    assert [term.name for term in terms_in(text)] == ["modulus", "pad", "press"]


def test_a_page_explains_the_terms_that_it_uses_and_no_others():
    made = page("Report", "The pad was pressed.", [Section("Shortfall", "A trace of each press.")])
    found = re.findall(r"<dt>([^<]+)</dt>", made)
    assert found == ["pad", "press", "shortfall", "trace"]
    assert made.count('<details class="terms">') == 1
    assert folded_glossary("<p>nothing of the kind</p>") == ""
    assert 'terms">' not in page("t", "", [Section("s", "words")])
