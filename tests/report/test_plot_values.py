"""Plots in a browser: values under the pointer and by keys, zoom, replacement, print; nothing from outside."""

from __future__ import annotations

import re

import numpy as np
import pytest

from dummydesign.report.page import POLICY, Section, page
from dummydesign.report.plot import Plot, Series
from tests.support.drawn_plots import axis_range, place, read_at, shown, wait_until_drawn
from tests.support.studio import browser


def plot(*series, name="name", **more):
    return Plot(name, "title", "words", "time [s]", "force [N]", "x_s", "y_N", series, **more)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A page with a logarithmic press, a steady curve over bands, bars and a map, far enough down to scroll."""
    folder = tmp_path_factory.mktemp("values")
    time = np.geomspace(1e-3, 10.0, 500)
    force = 5.0 + 7.0 * np.exp(-time)
    press = plot(
        Series.band("subjects", time, force - 1.0, force + 2.0),
        Series.line("this pad", time, force),
        name="press",
        log_x=True,
        x_range=(1e-3, 10.0),
        y_range=(0.0, 16.0),
    )
    depth = np.linspace(0.0, 2.0, 80)
    steady = plot(
        Series.band("band", depth**2, 0.9 * depth, 1.1 * depth, sideways=True),
        Series.line("steady", depth, depth**2),
        name="steady",
        x_range=(0.0, 2.5),
        y_range=(0.0, 5.0),
    )
    bars = plot(Series.bars(["modulus", "thickness"], [-3.0, -1.0], [4.0, 2.0]), name="bars", y_range=(0.0, 2.0))
    share = np.array([[0.05, 0.37, 0.62], [0.81, np.nan, 1.0]])
    cells = plot(Series.map("map", [1.0, 2.0, 3.0], [1.0, 2.0], 50.0 * share, (0.0, 50.0)), name="cells")
    far = Section("e", html='<div style="height:3000px"></div>')
    text = page("t", "", [Section("s", plots=[press, steady, bars, cells]), far])
    (folder / "page.html").write_text(text, encoding="utf-8")
    return (folder / "page.html").as_uri()


def number(text):
    return [float(word) for word in re.findall(r"(?<![\w.])[-−]?\d+(?:\.\d+)?(?:e-?\d+)?", text.replace("−", "-"))]


def rows_of(words):
    return dict(word.split(" : ") for word in words[1:])


@pytest.mark.slow
def test_values_are_under_the_pointer_and_nothing_comes_from_outside(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        told = []
        page.on("console", lambda message: told.append(message.text))
        page.goto(made)
        wait_until_drawn(page, 4)
        assert POLICY in page.content()
        words = read_at(page, 0, 0.5, 0.5)
        (time,), rows = number(words[0]), rows_of(words)
        curve = 5.0 + 7.0 * np.exp(-time)
        assert time == pytest.approx(0.1, rel=0.05) and words[0].endswith(" s")
        assert number(rows["this pad"]) == pytest.approx([curve], rel=1e-3) and rows["this pad"].endswith(" N")
        assert number(rows["subjects"]) == pytest.approx([curve - 1.0, curve + 2.0], rel=1e-3)
        rows = rows_of(read_at(page, 1, 0.4, 0.3))
        assert number(rows["steady"]) == pytest.approx([1.0], rel=0.05)
        low, high, force = number(rows["band"])
        assert [low, high] == pytest.approx([0.9 * force**0.5, 1.1 * force**0.5], rel=1e-3) and "s at" in rows["band"]
        assert number("".join(read_at(page, 2, 0.5, 0.75))) == [-3.0, 4.0]
        assert number(read_at(page, 3, 0.5, 0.25)[0])[0] == pytest.approx(18.5)
        assert read_at(page, 3, 0.5, 0.75) == []
        assert told == [] and page.broken == [] and page.outside in ([], [made])


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "width"), [("light", 1100), ("dark", 390)])
def test_zoom_by_box_buttons_and_double_click(made, scheme, width):
    with browser(viewport={"width": width, "height": 800}, color_scheme=scheme) as page:
        page.goto(made)
        wait_until_drawn(page, 4)
        page.locator("div.plot").nth(0).scroll_into_view_if_needed()
        page.wait_for_timeout(300)
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert page.evaluate(OUTSIDE) == [True] * 4
        assert page.evaluate(CONTRAST) >= 4.5
        page.mouse.move(*place(page, 0, 0.25, 0.25))
        page.mouse.down()
        page.mouse.move(*place(page, 0, 0.5, 0.5), steps=4)
        page.mouse.up()
        page.wait_for_timeout(300)
        assert axis_range(page, 0) == pytest.approx([-2.0, -1.0], abs=0.05)
        assert axis_range(page, 0, "y") == pytest.approx([4.0, 8.0], abs=0.2)
        page.mouse.dblclick(*place(page, 0, 0.5, 0.5))
        page.wait_for_timeout(500)
        assert axis_range(page, 0) == pytest.approx([-3.0, 1.0]) and axis_range(page, 0, "y") == [0.0, 16.0]
        # the wheel scrolls the page
        page.mouse.wheel(0, 40)
        page.wait_for_timeout(300)
        assert page.evaluate("scrollY") > 0 and axis_range(page, 0) == pytest.approx([-3.0, 1.0])
        page.locator("div.plot").nth(0).locator(".modebar-btn").nth(0).click()
        page.wait_for_timeout(400)
        assert np.ptp(axis_range(page, 0)) < 3.0
        assert page.broken == []


OUTSIDE = """() => [...document.querySelectorAll('div.plot')].map((div) => {
    const frame = div.querySelector('.nsewdrag').getBoundingClientRect();
    return [...div.querySelectorAll('.modebar-btn')].every(
        (b) => b.getBoundingClientRect().bottom <= frame.top + 1); })"""
"""Whether the controls of each plot lie above its frame."""
CONTRAST = """() => {
    const rgb = (text) => text.match(/[\\d.]+/g).map(Number), light = (c) => c.slice(0, 3)
        .map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
    const back = light(rgb(getComputedStyle(document.body).backgroundColor));
    return Math.min(...[...document.querySelectorAll('.xtick text, .ytick text, .g-xtitle text')].map((e) => {
        const own = light(rgb(getComputedStyle(e).fill));
        return (Math.max(own, back) + 0.05) / (Math.min(own, back) + 0.05); })); }"""


@pytest.mark.slow
def test_a_plot_is_read_and_enlarged_by_keys_alone(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        page.goto(made)
        wait_until_drawn(page, 4)
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.matches('div.plot[aria-label]')")
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(150)
        spoken = page.locator("[aria-live=polite]")
        time, value = number(spoken.inner_text())[:2]
        assert 0.1 < time < 0.12 and value == pytest.approx(5.0 + 7.0 * np.exp(-time), rel=1e-3)
        page.keyboard.press("Shift+ArrowRight")
        page.wait_for_timeout(150)
        assert number(spoken.inner_text())[0] > 2.0 * time
        page.keyboard.press("+")
        page.wait_for_timeout(400)
        assert np.ptp(axis_range(page, 0)) < 3.0
        page.keyboard.press("0")
        page.wait_for_timeout(400)
        assert axis_range(page, 0) == pytest.approx([-3.0, 1.0])
        page.keyboard.press("Tab")  # one stop for each plot
        assert page.evaluate("document.activeElement === document.querySelectorAll('div.plot')[1]")
        assert page.broken == []


@pytest.mark.slow
def test_a_plot_that_is_replaced_is_drawn_anew_and_keeps_its_zoom(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        page.goto(made)
        wait_until_drawn(page, 4)
        page.locator("div.plot").nth(1).locator(".modebar-btn").nth(0).click()
        page.wait_for_timeout(400)
        before = axis_range(page, 1)
        assert np.ptp(before) < 2.0
        page.evaluate(
            """(text) => { document.querySelectorAll('figure')[1].outerHTML = text; }""",
            plot(
                Series.line("new", [0.0, 1.0, 2.0], [0.0, 2.0, 4.0]),
                name="steady",
                x_range=(0.0, 2.5),
                y_range=(0.0, 5.0),
            ).html(),
        )
        page.wait_for_timeout(500)
        assert axis_range(page, 1) == before
        page.mouse.move(*place(page, 1, 0.3, 0.5))
        page.wait_for_timeout(300)
        at = before[0] + 0.3 * np.ptp(before)
        words = shown(page, 1)
        assert words and number(words[0])[0] == pytest.approx(at, abs=0.1) and number(rows_of(words)["new"]) == [2.0]
        assert page.broken == []


@pytest.mark.slow
def test_the_printed_page_has_the_plots_within_its_sheet(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        page.goto(made)
        wait_until_drawn(page, 4)
        page.emulate_media(media="print")
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        page.set_viewport_size({"width": 700, "height": 900})
        page.wait_for_timeout(500)
        beyond = page.evaluate(
            "[...document.querySelectorAll('.main-svg')].map((s) => s.getBoundingClientRect().right)"
            ".filter((right) => right > 700).length"
        )
        assert beyond == 0
        assert page.pdf().startswith(b"%PDF")
