"""What a page's script reads of a plot: places lead back to values; a browser shows, enlarges and speaks them."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np
import pytest

from dummydesign.report.page import POLICY, Section, page
from dummydesign.report.plot import Axis, Plot
from dummydesign.report.plot_layers import Band, Bars, Cells, Dots, Line, corners
from tests.support.studio import browser


def plot(*layers, name="name", **more):
    return Plot(name, "title", "words", "time [s]", "force [N]", "x_s", "y_N", layers, **more)


def axes(svg):
    """Inverse of both axes by the attributes alone: from a place to a value and to a share of the axis."""

    def inverse(text):
        low, high, start, stop = map(float, text.split()[:4])
        log = text.endswith(" log")

        def value(place):
            share = (np.asarray(place) - start) / (stop - start)
            return low * (high / low) ** share if log else low + share * (high - low)

        return value, lambda v: (np.log(v / low) / np.log(high / low)) if log else (v - low) / (high - low)

    return [inverse(re.search(f'data-{side}="([^"]+)"', svg)[1]) for side in "xy"]


def points(svg, name):
    path = re.search(rf'data-n="{name}"[^>]* d="([^"]+)"', svg)[1]
    return np.array([[float(a), float(b)] for a, b in re.findall(r"(-?[\d.]+) (-?[\d.]+)", path)])


@pytest.mark.parametrize("log", [False, True])
def test_places_lead_back_to_the_data(log):
    x = np.geomspace(1e-3, 10.0, 4000) if log else np.linspace(0.0, 10.0, 4000)
    y = 12.0 * np.exp(-x) + 6.0 * np.exp(-((np.log(np.maximum(x, 1e-9)) - 1.0) ** 2) * 8.0)
    svg = plot(Line("a", x, y), log_x=log, x_range=(float(x[0]), float(x[-1]))).svg()
    (to_x, share_x), (to_y, share_y) = axes(svg)
    across, along = points(svg, "a").T
    tried = np.linspace(across[0], across[-1], 777)
    read = to_y(np.interp(tried, across, along))
    true = np.interp(to_x(tried), x, y)
    assert np.abs(share_y(read) - share_y(true)).max() < 0.005
    assert share_x(to_x(across[0])) == pytest.approx(0.0, abs=1e-4) and len(across) < 245


@pytest.mark.parametrize("sideways", [False, True])
def test_ends_of_a_band_lead_back_to_the_data(sideways):
    at, low = np.linspace(1.0, 5.0, 300), np.linspace(1.0, 5.0, 300) ** 2
    svg = plot(Band("b", at, low, low + 4.0, sideways=sideways)).svg()
    (to_x, _), (to_y, _) = axes(svg)
    across, along = points(svg, "b").T
    ends, over = (to_x(across), to_y(along)) if sideways else (to_y(along), to_x(across))
    away = np.minimum(np.abs(ends - over**2), np.abs(ends - over**2 - 4.0))
    assert away.max() < 0.005 * np.ptp(ends)
    assert ("data-s" in svg) == sideways


@pytest.mark.parametrize("log", [False, True])
def test_many_places_are_those_of_each_value(log):
    axis = Axis("x", 0.01, 10.0, 50.0, 400.0, log)
    values = np.array([1e-9, 0.02, 1.0, 9.0, 500.0])
    assert axis.positions(values) == pytest.approx([axis.position(v) for v in values.tolist()])
    assert np.isnan(axis.positions(np.array([np.nan]))[0])


def test_points_that_are_left_out_lie_on_the_line_that_stays():
    rng = np.random.default_rng(5)
    turn = np.linspace(0.0, 6.0, 400)
    for across, along in (
        (np.linspace(0, 300, 240), 80 * np.sin(np.linspace(0, 5, 240))),
        (np.linspace(0, 300, 240), rng.normal(0, 1, 240)),
        (100 * np.cos(turn), 100 * np.sin(turn)),
        (np.array([0.0, 100.0, 50.0]), np.zeros(3)),
        (np.array([0.0, 50.0, 100.0, 50.0, 0.0]), np.zeros(5)),
    ):
        kept = corners(across, along, 0.1)
        assert kept[0] == 0 and kept[-1] == len(across) - 1
        assert distances(across, along, kept).max() <= 0.1 + 1e-9
    assert len(corners(np.linspace(0, 300, 240), np.linspace(0, 80, 240))) <= 3
    assert corners(np.array([1.0]), np.array([2.0])).tolist() == [0]


def distances(across, along, kept):
    """Of every point from the stretch of the line that took its place."""
    found = np.zeros(len(across))
    for first, last in pairwise(kept):
        chord = np.array([across[last] - across[first], along[last] - along[first]])
        for k in range(first, last + 1):
            to = np.array([across[k] - across[first], along[k] - along[first]])
            share = np.clip(to @ chord / max(chord @ chord, 1e-12), 0.0, 1.0)
            found[k] = np.hypot(*(to - share * chord))
    return found


def test_a_page_has_the_script_once_when_it_has_a_plot():
    line = Line("a", [0, 1], [0, 1])
    two = page("t", "", [Section("s", plots=[plot(line), plot(line, name="other")])])
    assert two.count("plotsRead = true") == 1
    assert "plotsRead" not in page("t", "", [Section("s", "words")])


def test_names_cannot_leave_their_attribute():
    svg = plot(Line('<b>"&', [0, 1], [0, 1]), Dots("<i>", [1], [1]), Bars("n", ['"<u>'], [0], [1])).svg()
    assert "<b>" not in svg and "<i>" not in svg and "<u>" not in svg


SCALE = 0.01
"""Of the axis: what a reading may be off by where the pointer stands on whole pixels."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A page with a logarithmic press, a steady curve over bands and bars, far enough down to scroll."""
    folder = tmp_path_factory.mktemp("values")
    time = np.geomspace(1e-3, 10.0, 500)
    force = 5.0 + 7.0 * np.exp(-time)
    press = plot(
        Band("subjects", time, force - 1.0, force + 2.0),
        Line("this pad", time, force),
        name="press",
        log_x=True,
        x_range=(1e-3, 10.0),
        y_range=(0.0, 16.0),
    )
    depth = np.linspace(0.0, 2.0, 80)
    steady = plot(
        Band("band", depth**2, 0.9 * depth, 1.1 * depth, sideways=True),
        Line("steady", depth, depth**2),
        name="steady",
        x_range=(0.0, 2.5),
        y_range=(0.0, 5.0),
    )
    bars = plot(Bars("bars", ["modulus", "thickness"], [-3.0, -1.0], [4.0, 2.0]), name="bars", y_range=(0.0, 2.0))
    share = np.array([[0.05, 0.37, 0.62], [0.81, np.nan, 1.0]])
    cells = plot(Cells("map", [1.0, 2.0, 3.0], [1.0, 2.0], 50.0 * share, high=50.0), name="cells")
    far = Section("e", html='<div style="height:3000px"></div>')
    text = page("t", "", [Section("s", plots=[press, steady, bars, cells]), far])
    (folder / "page.html").write_text(text, encoding="utf-8")
    return (folder / "page.html").as_uri()


def place(page, index, share_x, share_y):
    """A place in the window by shares of both axes of a plot, as it was drawn first."""
    return page.evaluate(
        """([k, sx, sy]) => { const svg = document.querySelectorAll('svg.plot')[k], r = svg.getBoundingClientRect();
        const f = svg.querySelector('rect.frame'), n = (a) => Number(f.getAttribute(a));
        const scale = r.width / svg.viewBox.baseVal.width;
        return [r.left + scale * (n('x') + sx * n('width')), r.top + scale * (n('y') + (1 - sy) * n('height'))]; }""",
        [index, share_x, share_y],
    )


def shown(page):
    """Rows of the box beside the pointer: the pointer's own, then one a layer."""
    first, *rows = page.locator(".reading div").all_inner_texts()
    return first, dict(row.split(": ") for row in rows)


def number(text):
    return [float(word) for word in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


def ticks(page, index):
    return page.evaluate(
        "(k) => [...document.querySelectorAll('svg.plot')[k].querySelectorAll('.ticks text')]"
        ".map((t) => t.textContent)",
        index,
    )


@pytest.mark.slow
@pytest.mark.parametrize(("scheme", "width"), [("light", 1100), ("dark", 390)])
def test_values_zoom_reset_and_keys_in_a_browser(made, scheme, width):
    with browser(viewport={"width": width, "height": 800}, color_scheme=scheme) as page:
        told = []
        page.on("console", lambda message: told.append(message.text))
        page.goto(made)
        assert POLICY in page.content()
        # a logarithmic axis: half of four decades is 0.1 s
        page.mouse.move(*place(page, 0, 0.5, 0.5))
        first, rows = shown(page)
        time, force = number(first)
        assert time == pytest.approx(0.1, rel=0.05) and force == pytest.approx(8.0, abs=16 * SCALE)
        curve = 5.0 + 7.0 * np.exp(-time)
        assert number(rows["this pad"])[0] == pytest.approx(curve, abs=16 * SCALE)
        assert number(rows["subjects"]) == pytest.approx([curve - 1.0, curve + 2.0], abs=16 * SCALE)
        assert page.locator(".reading").evaluate("(e) => e.getBoundingClientRect().right") <= width
        assert page.evaluate(CONTRAST) >= 4.5
        before = ticks(page, 0)
        # a box by the mouse from a quarter to half of both axes
        page.mouse.move(*place(page, 0, 0.25, 0.25))
        page.mouse.down()
        page.mouse.move(*place(page, 0, 0.5, 0.5), steps=3)
        page.mouse.up()
        assert ticks(page, 0) != before
        page.mouse.move(*place(page, 0, 0.5, 0.5))
        time, force = number(shown(page)[0])
        assert time == pytest.approx(10 ** (-3 + 4 * 0.375), rel=0.05) and force == pytest.approx(6.0, abs=16 * SCALE)
        assert drawn_inside(page, 0)
        page.mouse.dblclick(*place(page, 0, 0.5, 0.5))
        assert ticks(page, 0) == before
        # the wheel scrolls the page where the plot has no focus, and zooms with ctrl or focus
        page.evaluate("document.activeElement.blur()")
        page.mouse.wheel(0, 40)
        assert scrolled(page, lambda at: at > 0)
        assert ticks(page, 0) == before
        page.evaluate("scrollTo(0, 0)")
        assert scrolled(page, lambda at: at == 0)
        page.mouse.move(*place(page, 0, 0.5, 0.4))
        page.keyboard.down("Control")
        page.mouse.wheel(0, -400)
        page.keyboard.up("Control")
        page.wait_for_timeout(200)
        assert ticks(page, 0) != before and page.evaluate("scrollY") == 0
        page.locator("figure").nth(0).hover()
        page.locator("[data-zoom='0']").nth(0).click()
        assert ticks(page, 0) == before
        assert told == [] and page.broken == [] and page.outside in ([], [made])


@pytest.mark.slow
def test_a_plot_is_read_and_enlarged_by_keys_alone(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        page.goto(made)
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.matches('svg.plot[aria-label]')")
        page.keyboard.press("ArrowRight")
        spoken = page.locator("[aria-live=polite]")
        assert number(spoken.inner_text())[0] == pytest.approx(0.1, rel=0.01)
        page.keyboard.press("ArrowRight")
        time, *values = number(spoken.inner_text())
        assert time == pytest.approx(10 ** (-1 + 0.04), rel=0.01)
        assert values[2] == pytest.approx(5.0 + 7.0 * np.exp(-time), abs=16 * 0.005)
        before = ticks(page, 0)
        page.keyboard.press("+")
        page.keyboard.press("+")
        assert ticks(page, 0) != before
        for _ in range(20):
            page.keyboard.press("Shift+ArrowRight")
        assert number(spoken.inner_text())[0] == pytest.approx(10.0, rel=0.01)
        page.keyboard.press("0")
        assert ticks(page, 0) == before
        named = page.locator("[data-zoom]").evaluate_all("(all) => all.map((e) => e.getAttribute('aria-label'))")
        assert len(named) == 12 and all(named)
        second = ticks(page, 1)
        page.keyboard.press("Tab")  # one stop for each plot: its buttons have the keys + - 0
        assert page.evaluate("document.activeElement === document.querySelectorAll('svg.plot')[1]")
        page.keyboard.press("+")
        assert ticks(page, 1) != second and ticks(page, 0) == before
        page.keyboard.press("Escape")


@pytest.mark.slow
def test_touch_bars_and_bands_over_force(made):
    with browser(viewport={"width": 390, "height": 800}, has_touch=True, is_mobile=True) as page:
        page.goto(made)
        page.locator("svg.plot").nth(1).scroll_into_view_if_needed()
        page.touchscreen.tap(*place(page, 1, 0.4, 0.5))
        _, rows = shown(page)
        assert number(rows["steady"])[0] == pytest.approx(1.0, abs=5 * SCALE)
        assert number(rows["band"]) == pytest.approx([1 / 1.21, 1 / 0.81], abs=5 * SCALE)
        page.touchscreen.tap(*place(page, 1, 0.8, 0.5))
        assert number(shown(page)[1]["band"])[0] == pytest.approx(4.0 / 1.21, abs=5 * SCALE)
        assert "above" in shown(page)[1]["band"]
        page.locator("svg.plot").nth(2).scroll_into_view_if_needed()
        page.touchscreen.tap(*place(page, 2, 0.5, 0.75))
        assert number(shown(page)[1]["modulus"]) == pytest.approx([-3.0, 4.0], abs=7 * SCALE)
        assert page.evaluate("document.documentElement.scrollWidth") <= 390


@pytest.mark.slow
def test_a_map_is_read_by_its_colours_also_when_it_is_enlarged(made):
    with browser(viewport={"width": 1100, "height": 1200}) as page:
        page.goto(made)
        page.wait_for_timeout(300)
        page.locator("svg.plot").nth(3).scroll_into_view_if_needed()
        page.wait_for_timeout(300)
        for (across, along), value in (
            ((0.17, 0.25), 2.5),
            ((0.5, 0.25), 18.5),
            ((0.83, 0.25), 31.0),
            ((0.17, 0.75), 40.5),
        ):
            page.mouse.move(*place(page, 3, across, along))
            assert number(shown(page)[1]["map"])[0] == pytest.approx(value, abs=50 * 0.006)
        page.mouse.move(*place(page, 3, 0.5, 0.75))
        assert number(shown(page)[1]["map"]) == []
        page.mouse.move(*place(page, 3, 0.83, 0.75))
        assert number(shown(page)[1]["map"]) == [50.0]
        page.mouse.move(*place(page, 3, 0.5, 0.25))
        page.keyboard.down("Control")
        page.mouse.wheel(0, -200)
        page.keyboard.up("Control")
        page.wait_for_timeout(200)
        page.mouse.move(*place(page, 3, 0.5, 0.25))
        assert number(shown(page)[1]["map"])[0] == pytest.approx(18.5, abs=50 * 0.006)


@pytest.mark.slow
def test_a_plot_that_is_replaced_can_be_read_and_keeps_its_zoom(made):
    with browser(viewport={"width": 1100, "height": 800}) as page:
        page.goto(made)
        page.locator("figure").nth(1).hover()
        page.locator("[data-zoom='+']").nth(1).click()
        before = ticks(page, 1)
        page.evaluate(
            """(text) => { const f = document.querySelectorAll('figure')[1]; f.outerHTML = text; }""",
            plot(Line("new", [0.0, 2.0], [0.0, 4.0]), name="steady", x_range=(0.0, 2.5), y_range=(0.0, 5.0)).html(),
        )
        page.wait_for_selector("figure:nth-of-type(2) [data-zoom]")
        assert ticks(page, 1) == before
        page.mouse.move(*place(page, 1, 0.5, 0.5))
        first, rows = shown(page)
        assert number(rows["new"])[0] == pytest.approx(2.0 * number(first)[0], abs=5 * SCALE)
        assert page.broken == []


def scrolled(page, wanted):
    """Whether the page comes to a place within five seconds; its policy forbids Playwright's own waiting."""
    for _ in range(100):
        if wanted(page.evaluate("scrollY")):
            return True
        page.wait_for_timeout(50)
    return False


def drawn_inside(page, index):
    """Whether what is drawn is cut off at the frame: the group of the curves has the clip of the frame's size."""
    return page.evaluate(
        """(k) => { const svg = document.querySelectorAll('svg.plot')[k], f = svg.querySelector('rect.frame');
        const c = svg.querySelector('clipPath rect'), p = svg.querySelector('path.line');
        return ['x', 'y', 'width', 'height'].every((a) => c.getAttribute(a) === f.getAttribute(a))
            && !!p.closest('g[clip-path]') && p.getBBox().width > Number(f.getAttribute('width')); }""",
        index,
    )


CONTRAST = """() => {
    const rgb = (text) => text.match(/[\\d.]+/g).map(Number), light = (c) => c.slice(0, 3)
        .map((v) => (v /= 255) <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
    const box = document.querySelector('.reading'), back = light(rgb(getComputedStyle(box).backgroundColor));
    return Math.min(...[...box.children, ...document.querySelectorAll('.zoom button')].map((e) => {
        const own = getComputedStyle(e).backgroundColor, ground = own.endsWith(', 0)') ? back : light(rgb(own));
        const a = light(rgb(getComputedStyle(e).color));
        return (Math.max(a, ground) + 0.05) / (Math.min(a, ground) + 0.05); })); }"""
