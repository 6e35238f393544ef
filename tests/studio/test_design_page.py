"""The design page by real clicks: every panel belongs to what is chosen."""

from __future__ import annotations

import pytest

from dummydesign.project.folder import make_project
from dummydesign.studio import jobs
from tests.support.studio import COMMAND_MS, browser, choose, running, unfold
from tests.support.studio import test_id as by

pytestmark = pytest.mark.slow
SETTLED = '[data-test="verdict"] .verdict[data-state="settled"]'
REFUSED = '[data-test="verdict"] .verdict[data-state="refused"]'


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    base = tmp_path_factory.mktemp("design")
    make_project(base / "thumb", tissue="forefinger")
    with running(base / "thumb", base / "home") as found:
        yield found, base / "thumb"


@pytest.fixture(scope="module")
def searched(studio):
    """A search of the default question, run by a click: any of the tests may be the first."""
    with browser(viewport={"width": 1280, "height": 900}) as found:
        found.goto(studio[0].address)
        found.wait_for_selector("h1")
        opened(found, studio, "?shape=slab&thickness_mm=12&ratio=17")
        choose(found, "searched", "slab")
        found.locator(by("run-suggest")).click()
        found.wait_for_selector(f"{by('found-suggest')} {by('why')}", timeout=COMMAND_MS)


@pytest.fixture
def page(studio):
    with browser(viewport={"width": 1280, "height": 900}) as found:
        found.goto(studio[0].address)
        found.wait_for_selector("h1")
        yield found
        assert found.broken == [] and found.outside == []


def opened(page, studio, query=""):
    page.goto(f"{studio[0].home}design{query}")
    page.wait_for_selector(SETTLED)


def slide(page, name, value):
    field = page.locator(by(f"number-{name}"))
    field.fill(f"{value}")
    field.press("Enter")


def label(page):
    return page.locator(f"{by('verdict')} small.label").inner_text()


def test_after_a_search_of_the_same_kind_every_panel_is_that_of_the_pad_that_was_found(page, studio):
    opened(page, studio, "?shape=slab&thickness_mm=12&ratio=17")
    before = page.locator(by("plots")).inner_html()
    choose(page, "searched", "slab")
    page.locator(by("run-suggest")).click()
    page.wait_for_selector(f"{by('found-suggest')} {by('why')}", timeout=COMMAND_MS)
    best = jobs.latest(studio[1], "suggest").answer["recommendation"]
    text = f"{best['thickness_mm']:g} mm, ratio {best['ratio']:g}"
    page.wait_for_function("(text) => document.querySelector('small.label').textContent.includes(text)", arg=text)
    page.wait_for_selector(SETTLED)
    page.wait_for_selector(f'iframe.solid[src*="thickness={best["thickness_mm"]:g}"]', state="attached")
    assert page.locator(by("plots")).inner_html() != before
    assert page.locator(by("number-thickness")).input_value() == f"{best['thickness_mm']:g}"
    assert f"thickness={best['thickness_mm']:g}" in page.locator("iframe.solid").get_attribute("src")
    assert f"--thickness {best['thickness_mm']:g}:" in page.locator(f"{by('solved')} code").inner_text()
    shown = page.locator(f"{by('verdict')} p").inner_text()
    assert jobs.latest(studio[1], "suggest").answer["verdict"]["text"] in shown
    assert "design=designs" in page.url


def test_the_pad_that_the_sliders_begin_with_has_no_light_until_a_pad_is_chosen(page, studio):
    opened(page, studio, "?shape=slab&thickness_mm=6&ratio=15")
    shown = page.locator(f"{by('verdict')} .verdict")
    assert "grey" in shown.get_attribute("class").split()
    slide(page, "thickness", 7)
    page.wait_for_selector(f"{SETTLED}.red")
    slide(page, "thickness", 6)
    page.wait_for_function("document.querySelector('small.label').textContent.includes('6 mm')")
    page.wait_for_selector(f"{SETTLED}.red")


def test_a_refused_pad_leaves_no_drawing_of_another_one(page, studio):
    opened(page, studio, "?shape=crowned:radius=20,height=2,foot=9&thickness_mm=9")
    assert page.locator(f"{by('plots')} figure").count() == 8
    slide(page, "thickness", 3)
    page.wait_for_selector(REFUSED)
    assert page.locator(f"{by('plots')} figure").count() == 0 and page.locator("iframe.solid").count() == 0
    assert "3 mm" in label(page)
    page.locator(by("fit-lengths")).click()
    page.wait_for_function("document.querySelector('[data-test=slide-height]').ariaValueMax < 2")


def test_another_tissue_hides_the_search_for_this_one_and_a_reload_keeps_what_is_chosen(page, studio, searched):
    opened(page, studio, "?tissue=forefinger")
    page.wait_for_selector(f"{by('found-suggest')} {by('why')}", timeout=COMMAND_MS)
    unfold(page, "question")
    choose(page, "tissue", "palm (built-in)")
    page.wait_for_selector(SETTLED)
    page.wait_for_function("document.querySelector('small.label').textContent.includes('palm')")
    assert page.locator(f"{by('found-suggest')} {by('why')}").count() == 0
    slide(page, "thickness", 11)
    page.wait_for_function("location.search.includes('thickness_mm=11')")
    chosen = label(page)
    page.reload()
    page.wait_for_selector(SETTLED)
    assert label(page) == chosen and "palm" in chosen and "11 mm" in chosen
    page.locator("nav a", has_text="Mould").click()
    page.wait_for_selector("h1 >> text=Mould")
    assert "thickness_mm=11" in page.url and "tissue=palm" in page.url
    page.go_back()
    page.wait_for_selector(SETTLED)
    assert label(page) == chosen


def test_values_that_are_not_the_projects_are_marked_and_go_back_by_a_click(page, studio):
    opened(page, studio, "?shape=slab&thickness_mm=9&ratio=15&aim=safe-side&punch=round:16")
    question = page.locator(f"{by('question')} .q-item").first
    assert "changed: aim, punch" in question.inner_text()
    unfold(page, "question")
    marks = page.locator(f"{by('question')} {by('back')}:visible")
    page.wait_for_function("document.querySelectorAll('[data-test=question] [data-test=punch]').length")
    assert marks.count() == 2
    for left in (1, 0):
        marks.first.click()
        page.wait_for_function(
            "(left) => [...document.querySelectorAll('[data-test=question] [data-test=back]')]"
            ".filter((one) => one.offsetParent).length === left",
            arg=left,
        )
    page.wait_for_function("document.querySelector('small.label').textContent.endsWith('forefinger, square:14')")
    assert "changed" not in question.inner_text()
    page.wait_for_function("location.search.includes('aim=average') && location.search.includes('punch=square')")


def test_a_tissue_that_is_missing_is_said_and_not_replaced(page, studio):
    page.goto(f"{studio[0].home}design?tissue=tissue/gone.toml")
    page.wait_for_selector(REFUSED)
    assert "tissue/gone.toml" in page.locator(by("verdict")).inner_text()
    assert page.locator(f"{by('plots')} figure").count() == 0


@pytest.mark.parametrize("kind", ["crowned", "layered", "boned"])
def test_every_kind_begins_with_a_pad_that_is_pressed_and_its_lengths_move(page, studio, kind):
    opened(page, studio, "?shape=slab&thickness_mm=6")
    choose(page, "kind", kind)
    page.wait_for_function("(kind) => document.querySelector('small.label').textContent.startsWith(kind)", arg=kind)
    page.wait_for_selector(SETTLED)
    before, slider = page.locator(by("plots")).inner_html(), page.locator("[role=slider] [tabindex]").nth(2)
    slider.focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_function("(old) => document.querySelector('[data-test=plots]').innerHTML !== old", arg=before)


def test_a_pad_outside_the_tables_is_solved_by_one_click(page, studio):
    page.goto(f"{studio[0].home}design?shape=boned:radius=12.6,height=1.8,foot=6.5&thickness_mm=20&ratio=15")
    page.wait_for_selector(REFUSED)
    page.locator(by("run-pad")).click()
    page.wait_for_selector('[data-test="verdict"] .verdict[data-state="solved"]', timeout=COMMAND_MS)
    words = jobs.latest(studio[1], "pad").words
    assert words[0] == "predict" and "axisymmetric" in words
    assert page.locator(f"{by('found-pad')} table").count() == 1


def test_a_search_that_failed_leaves_the_earlier_result_in_sight(page, studio, searched):
    opened(page, studio, "?tissue=forefinger")
    page.wait_for_selector(f"{by('found-suggest')} {by('why')}", timeout=COMMAND_MS)
    page.locator(by("run-suggest")).click()
    page.wait_for_selector(f"{by('stop-suggest')}:visible")
    page.locator(by("stop-suggest")).click()
    page.wait_for_selector(".work .problem")
    assert page.locator(f"{by('found-suggest')} {by('why')}").count() == 1
    assert page.locator(f"{by('found-suggest')} .source").count() == 1


CURVES = """() => [...document.querySelectorAll('[data-test=plots] .trace')]
    .filter((one) => one.__data__[0].trace.name === 'this pad')
    .map((one) => one.querySelector('.js-line').getAttribute('d'))"""
KNOWN = """() => [...document.querySelectorAll('[data-test=plots] .js-plotly-plot')].flatMap((one) => one.data)
    .filter((one) => one.name === 'this pad').map((one) => one.y.length + Math.max(...one.y) + Math.max(...one.x))"""


def test_a_moved_slider_moves_all_curves_at_once_and_the_plots_follow_when_it_rests(page, studio):
    opened(page, studio, "?shape=slab&thickness_mm=8&ratio=15")
    page.wait_for_function("document.querySelectorAll('[data-test=plots] .js-line').length > 20")
    before, known = page.evaluate(CURVES), page.evaluate(KNOWN)
    assert len(before) == 7
    slide(page, "ratio", 16)
    page.wait_for_function(f"(old) => ({CURVES})().every((one, k) => one !== old[k])", arg=before)
    assert "ratio 16" in label(page) and "modulus" in page.locator(".beside").all_inner_texts()[1]
    page.wait_for_function(f"(old) => ({KNOWN})().every((one, k) => one !== old[k])", arg=known)
    page.wait_for_selector(SETTLED)
    # what plotly.js draws lies where the curve was moved to
    moved = page.evaluate(CURVES)[0]
    page.reload()
    page.wait_for_selector(SETTLED)
    page.wait_for_function("document.querySelectorAll('[data-test=plots] .js-line').length > 20")
    ends = [[float(one) for one in path[1:].split("L")[-1].split(",")] for path in (moved, page.evaluate(CURVES)[0])]
    assert ends[0] == pytest.approx(ends[1], abs=0.5)
