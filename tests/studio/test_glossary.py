"""Terms of the studio: escaped, and open under the pointer, by focus and by touch."""

from __future__ import annotations

import re
from html import escape

import pytest

from dummydesign.report.page import terms
from dummydesign.studio.widgets import marked, page_head
from tests.support.studio import browser


def term(word):
    """A term that the Tab key reaches."""
    return str(marked(word)).replace("<abbr", '<abbr tabindex="0" aria-describedby="term-tip"')


def test_a_term_carries_its_definition_and_escapes_what_is_shown():
    made = marked('Moduli <b>"x"')
    assert "<b>" not in made and "&lt;b&gt;" in made
    assert terms()["modulus"].text.partition("'")[0] in made
    assert marked("pad").endswith(">pad</abbr>") and marked("no such term") == "no such term"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("terms")
    text = (
        f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'>"
        f"<head>{page_head()}</head><body><h1>t</h1><p>{term('pad')} and "
        f"<span style='float:right'>{term('shortfall')}</span></p><p id=far style='margin-top:300px'>far</p></body>"
    )
    (folder / "page.html").write_text(text, encoding="utf-8")
    return (folder / "page.html").as_uri()


CONTRAST = """() => {
    const rgb = (text) => text.match(/[\\d.]+/g).map(Number), light = (c) => c.slice(0, 3)
        .map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
    const look = getComputedStyle(document.querySelector('#term-tip'));
    const [a, b] = [look.color, look.backgroundColor].map((text) => light(rgb(text)));
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); }"""


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "width"), [("light", 1100), ("dark", 390)])
def test_a_definition_opens_under_the_pointer_and_by_focus(address, scheme, width):
    with browser(viewport={"width": width, "height": 700}, color_scheme=scheme) as page:
        page.goto(address)
        tip = page.locator("#term-tip")
        page.locator("abbr").nth(1).hover()
        assert tip.is_visible() and tip.inner_text() == terms()["shortfall"].text
        assert page.evaluate(CONTRAST) >= 4.5
        box = tip.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= width
        # the pointer may go onto the words
        page.mouse.move(box["x"] + box["width"] - 6, box["y"] + 5)
        assert tip.is_visible()
        page.locator("#far").hover()
        assert not tip.is_visible()
        page.keyboard.press("Tab")
        assert tip.is_visible() and tip.inner_text() == terms()["pad"].text
        assert page.evaluate("document.activeElement.getAttribute('aria-describedby')") == tip.get_attribute("id")
        assert tip.get_attribute("role") == "tooltip"
        page.keyboard.press("Escape")
        assert not tip.is_visible()
        page.keyboard.press("Tab")
        assert tip.inner_text() == terms()["shortfall"].text
        page.keyboard.press("Tab")
        assert not tip.is_visible()
        assert page.evaluate("document.documentElement.scrollWidth") <= width and page.broken == []


@pytest.mark.slow
def test_a_definition_opens_by_touch_and_closes_by_a_touch_elsewhere(address):
    with browser(viewport={"width": 390, "height": 700}, has_touch=True, is_mobile=True) as page:
        page.goto(address)
        page.locator("abbr").nth(1).tap()
        assert page.locator("#term-tip").inner_text() == terms()["shortfall"].text
        page.locator("#far").tap()
        assert not page.locator("#term-tip").is_visible()


def test_the_first_use_of_each_term_in_a_text_is_marked_and_the_rest_is_escaped():
    plain = "The verdict on a pad <b>: 38 % of castings; the pad again. Steady force, force."
    text = marked(plain)
    assert text.count("<abbr") == 4 and "&lt;b&gt;" in text and "<b>" not in text
    assert ">Steady force</abbr>" in text and text.count(">pad</abbr>") == 1
    assert re.sub("<[^>]+>", "", text) == escape(plain)
