"""The first page of a report: one sheet of A4, alike as SVG and as PDF, with the numbers of the answer."""

import json
import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import read_punch
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.report.front_page import HEIGHT_MM, PAPER_MM, WIDTH_MM, Fact, FrontPage, Grid, Panel, lay_out
from dummydesign.report.pad_drawing import pad_section
from dummydesign.report.plot import Series, press_plot
from dummydesign.report.vector_sheet import PT_MM, Path, Text, VectorSheet, shortened, text_width_mm, wrapped
from tests.support.pdf_paths import contents, pages_mm
from tests.support.studio import browser

pytestmark = pytest.mark.slow

CROWN = "crowned:radius=21.2,height=2,foot=9.4"


@pytest.fixture(scope="module")
def made(tmp_path_factory, request):
    """A suggestion twice: folder, answer and folder of the second."""
    first, second = (tmp_path_factory.mktemp(name) for name in ("first", "second"))
    words = [
        "suggest",
        "--tissue",
        "forefinger",
        "--shape",
        CROWN,
        "--thickness",
        "4.5:4.5",
        "--no-cad",
        "--no-verify",
        "--json",
        "--out",
    ]
    printed = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("builtins.print", lambda text="", **_: printed.append(str(text)))
        assert run([*words, str(first)]) in (0, 1) and run([*words, str(second)]) in (0, 1)
    answer = json.loads(next(text for text in printed if text.startswith("{")))
    return first, answer, second


def texts_on(sheet):
    return [item for item in sheet.items if isinstance(item, Text)]


def box_of(text):
    """What the words cover, with descenders. [mm]"""
    size = text.size_pt * PT_MM
    return text.left_mm, text.y_mm - 0.73 * size, text.left_mm + text.width_mm, text.y_mm + 0.21 * size


def pdf_texts(data):
    """Texts of the only page of a PDF, in their order."""
    (content,) = contents(data)
    found = re.findall(r"\(((?:[^()\\]|\\.)*)\) Tj", content)
    return [re.sub(r"\\(.)", r"\1", text) for text in found]


def sheet_texts(html):
    """Texts of the SVG of the first page of a report."""
    svg = re.search('<svg class="sheet".*?</svg>', html, re.DOTALL)[0]
    return [unescape(text) for text in re.findall(r"<text[^>]*>(.*?)</text>", svg)]


@pytest.mark.slow
def test_the_pdf_is_one_sheet_of_a4_and_equal_inputs_give_equal_bytes(made):
    first, answer, second = made
    data = (first / "report.pdf").read_bytes()
    assert answer["files"]["first_page"] == str(first / "report.pdf")
    assert pages_mm(data) == [pytest.approx(PAPER_MM, abs=0.1)]
    assert data == (second / "report.pdf").read_bytes()
    assert not [path for path in first.iterdir() if path.name.startswith(".")]


@pytest.mark.slow
def test_page_and_pdf_have_the_same_texts_and_the_answers_numbers(made):
    first, answer, _ = made
    texts = pdf_texts((first / "report.pdf").read_bytes())
    assert texts == sheet_texts((first / "report.html").read_text(encoding="utf-8")) and len(texts) > 60
    page, best, verdict = " ".join(texts), answer["recommendation"], answer["verdict"]
    light, (strong, _, rest) = verdict["light"].upper(), verdict["text"].partition(". ")
    assert f"{light}: {strong.upper()}" in page and rest in page
    assert f"{best['ratio']:g}" in texts
    for item in best["batch"]["components"]:
        assert f"{item['name']} {item['mass_g']:.1f} g" in page
    assert f"pour {best['batch']['pour_g']:.1f} g" in page and f"{best['young_kPa']['value']:.3g} kPa" in page
    assert len(best["conditions"]) == 6
    for row in best["conditions"]:
        cells = [
            f"{row['steady_force_N']:g}",
            f"{row['velocity_mm_s']:g}",
            f"{row['depth_mm']:.2f}",
            f"{100 * row['gel_compression']:.0f} %",
            f"{row['peak_force_N']:.1f}",
            f"{row['target_peak_low_N']:.1f} to {row['target_peak_high_N']:.1f}",
        ]
        assert " ".join(cells) in page
        at = texts.index(f"{row['steady_force_N']:g} N, {row['velocity_mm_s']:g} mm/s")
        assert texts[at - 1].startswith(f"{row['peak_force_N']:.1f} N: ")
    factor = verdict["correction"]
    assert f"by {factor['force']:.2f} for 95 %" in page
    assert f"(nominal {max(factor['force_central'], 1):.2f}" in page
    assert any(step["command"] for step in answer["next"])
    for step in answer["next"]:
        assert (step["command"] or step["do"]).lower() in page.replace(" \\ ", " ").lower()
    for heading in ("Recipe", "Correction", "What to do next", "Force [N] over time since contact"):
        assert heading in texts
    for length in ("4.5", "2.5", "2", "9.4", "R 21.2"):
        assert length in texts


def test_the_recipe_weighs_the_batch_that_is_mixed(made):
    first, answer, _ = made
    recipe = (first / "report.html").read_text(encoding="utf-8").partition("<h2>Recipe</h2>")[2]
    table, best = recipe.partition("</table>")[0], answer["recommendation"]
    cells = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in table.split("<tr>")[2:]]
    mixed = [(item["name"], f"{item['mass_g']:.1f}") for item in best["batch"]["components"]]
    assert [tuple(row[:2]) for row in cells[:-1]] == mixed
    assert cells[-1][1:] == [
        f"{best['batch']['total_g']:.1f}",
        f"{best['recipe']['total_g']:.1f}",
        f"{best['batch']['pour_g']:.1f}",
    ]
    assert best["recipe"]["total_g"] < best["batch"]["total_g"]


def test_the_report_begins_with_the_sheet_then_lists_its_contents(made):
    text = (made[0] / "report.html").read_text(encoding="utf-8")
    main = text.partition("<main>")[2]
    assert main.startswith('<section class="front"') and main.count('class="sheet"') == 1
    assert 0 < main.index("</section>") < main.index('<nav class="contents"') < main.index("<h1")
    listed = re.findall(r'<li><a href="#([\w-]+)">(.*?)</a>', main)
    assert listed[0] == ("summary", "Summary") and listed[-1] == ("sources", "Sources")
    headings = re.findall(r'<section id="([\w-]+)"><h2>(.*?)</h2>', main)
    assert [pair for pair in listed if pair[0] != "summary"] == headings and len(headings) >= 8
    assert main.count('id="summary"') == 1
    printed = text.partition("@media print")[2]
    assert "break-after:page" in printed and f"width:{WIDTH_MM:g}mm;height:{HEIGHT_MM:g}mm" in printed


@pytest.mark.slow
def test_a_browser_prints_the_first_page_on_one_sheet(made):
    with browser() as page:
        page.goto((made[0] / "report.html").as_uri())
        whole = page.pdf(prefer_css_page_size=True)
        page.add_style_tag(content="main > :not(.front), footer {display: none}")
        front = page.pdf(prefer_css_page_size=True)
        page.emulate_media(media="print")
        assert page.evaluate("getComputedStyle(document.querySelector('.front')).breakAfter") == "page"
    assert pages_mm(front) == [pytest.approx(PAPER_MM, abs=0.5)] and len(pages_mm(whole)) > 5


def some_page(presses=6, long=False):
    """A page filled with made-up facts, short or longer than there is room."""
    time = np.geomspace(1e-3, 10.0, 300)
    layers = (Series.band("people", time, 4.0 + 0 * time, 6.0 + 0 * time), Series.line("pad", time, 5.0 + np.sin(time)))
    plots = [press_plot("p", "", "", layers, (1e-3, 10.0))] * presses
    words = "a pad that is softer than people at the highest force " * (20 if long else 1)
    section = pad_section(read_shape(CROWN), 4.5, (150.0, 120.0), read_punch("square:14"), "glued")
    rows = [[f"{n}", "250", "1.11", "8.6 to 10.3", "inside"] for n in range(presses)]
    return FrontPage(
        f"Pad for the {'fore' * (60 if long else 1)}finger",
        words,
        ("amber", f"Not settled. {words}"),
        ("Pad (mm)", section),
        "Recipe",
        [Fact("ratio", "15.5", True), *[Fact(words, words)] * (6 if long else 2)],
        "Force",
        [Panel(plot, f"press {n} {words}", words, level="a") for n, plot in enumerate(plots)],
        [("band", "people"), ("main", "pad")],
        Grid(("steady N", "mm/s", "depth mm", "people N", ""), rows),
        [(words, [words] * 2)] * 3,
        [words] * (8 if long else 1),
        [words, f"dummydesign suggest --out {'x' * (400 if long else 4)}", words],
        "report.html continues",
    )


@pytest.mark.parametrize(("presses", "long"), [(0, False), (1, False), (4, False), (6, False), (6, True), (24, True)])
def test_nothing_leaves_the_sheet_and_no_text_covers_another(presses, long):
    sheet = lay_out(some_page(presses, long))
    for item in sheet.items:
        points = np.array(item.points if isinstance(item, Path) else [box_of(item)[:2], box_of(item)[2:]])
        assert points.min() >= -0.2 and np.all(points.max(axis=0) <= (WIDTH_MM + 0.2, HEIGHT_MM + 0.2)), item
    boxes = [box_of(text) for text in texts_on(sheet)]
    for at, one in enumerate(boxes):
        for number, other in enumerate(boxes[:at]):
            across = min(one[2], other[2]) - max(one[0], other[0])
            along = min(one[3], other[3]) - max(one[1], other[1])
            assert min(across, along) < 0.3, (texts_on(sheet)[at], texts_on(sheet)[number])
    titles = [text.words for text in texts_on(sheet) if text.words.startswith("press ")]
    assert len(titles) == min(presses, 6)


def test_a_press_out_of_reach_is_named_and_its_pad_not_drawn():
    page = some_page(1)
    band = page.panels[0].plot.series[0]
    page = replace(page, panels=[replace(page.panels[0], plot=replace(page.panels[0].plot, series=(band,)))])
    assert "not reached" in [text.words for text in texts_on(lay_out(page))]
    assert "not reached" not in [text.words for text in texts_on(lay_out(some_page(1)))]


def test_curves_of_one_level_share_their_scale():
    page = some_page(2)
    high = replace(page.panels[1].plot, series=(Series.band("people", [1e-3, 10.0], [0.0, 0.0], [60.0, 60.0]),))
    for level, count in (("a", 2), ("b", 1)):
        panels = [page.panels[0], replace(page.panels[1], plot=high, level=level)]
        words = [text.words for text in texts_on(lay_out(replace(page, panels=panels)))]
        assert words.count("60") == count


@pytest.mark.parametrize(("face", "font"), [("plain", "Helvetica"), ("bold", "Helvetica-Bold"), ("mono", "Courier")])
def test_widths_of_letters_are_those_of_the_fonts_of_the_pdf(face, font):
    from reportlab.pdfbase.pdfmetrics import stringWidth

    for code in range(32, 127):
        assert text_width_mm(chr(code), 10.0, face) == pytest.approx(stringWidth(chr(code), font, 10.0) * 25.4 / 72.0)


def test_texts_are_broken_to_their_room():
    text = "one two\nthree " + "x" * 100
    lines = wrapped(text, 20.0, 9.0)
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(text_width_mm(line, 9.0) <= 20.0 for line in lines) and lines[0].startswith("one")
    assert wrapped(text, 20.0, 9.0, most=2)[-1].endswith("...") and len(wrapped(text, 20.0, 9.0, most=2)) == 2
    assert shortened("short", 20.0, 9.0) == "short"


def test_letters_beyond_those_of_western_europe_are_written():
    sheet = VectorSheet("x", WIDTH_MM, HEIGHT_MM, [Text(0.0, 10.0, "Наконечник 指 a<b")])
    assert sheet.pdf(PAPER_MM).startswith(b"%PDF") and "a&lt;b" in sheet.svg()


@pytest.mark.parametrize(
    ("shape", "thickness", "lengths"),
    [
        ("slab", 5.5, {"5.5"}),
        (CROWN, 4.5, {"4.5", "2", "2.5", "9.4", "R 21.2"}),
        ("boned:12,4,8", 7.0, {"7", "4", "3", "8", "R 12"}),
        ("layered:2,3", 6.0, {"6", "2", "4"}),
        ("crowned:10,2,9.4,ridge=1", 8.0, {"8", "2", "6", "9.4", "R 10"}),
    ],
)
@pytest.mark.parametrize("punch", ["square:14", "ball:8"])
def test_a_section_is_to_scale_and_has_the_lengths_of_its_shape(shape, thickness, lengths, punch):
    box = (0.0, 0.0, 110.0, 60.0)
    pad: PadShape = read_shape(shape)
    items = pad_section(pad, thickness, (150.0, 120.0), read_punch(punch), "glued")(box)
    words = {item.words for item in items if isinstance(item, Text)}
    assert lengths <= words
    scale = float(re.search(r"scale ([\d.]+):1", " ".join(words))[1])
    gel = np.array(items[0].points)
    assert np.ptp(gel[:, 1]) == pytest.approx(scale * thickness, rel=1e-9)
    x, z = (gel[:-2, 0] - gel[:-2, 0].mean()) / scale, (gel[-1, 1] - gel[:-2, 1]) / scale
    still = np.zeros_like(x)
    drop = pad.drop_mm(still, x) if pad.runs_out else pad.drop_mm(x, still)
    assert np.abs(thickness - drop - z).max() < 1e-6
    for item in items:
        points = np.array(item.points if isinstance(item, Path) else [box_of(item)[:2], box_of(item)[2:]])
        assert points.min() >= 0.0 and np.all(points.max(axis=0) <= (110.0, 60.0)), item


def test_a_pdf_leaves_the_settings_of_its_library_as_they_were(monkeypatch):
    rl_config = pytest.importorskip("reportlab.rl_config")
    monkeypatch.setattr(rl_config, "useA85", 1)
    content = VectorSheet("x", 100.0, 100.0, [Text(0.0, 10.0, "a")]).pdf((210.0, 297.0))
    assert rl_config.useA85 == 1 and b"ASCII85Decode" not in content
