"""The first page of a report: one sheet of A4 with the numbers of the answer, whatever its texts."""

import json
import re
import struct
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.core.tables import Table
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.punch import read_punch
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.report.front_page import SIZE, Fact, FrontPage, Panel, lay_out, pad_section, picture
from dummydesign.report.plot import Series, press_plot
from tests.support.pdf_paths import pages_mm
from tests.support.pdf_texts import MM, objects, pdf_text, pdf_texts, placed_texts

PAPER_MM, EDGES_MM = (210.0, 297.0), (12.0, 12.5)
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


def box_of(text):
    """What the words cover, with descenders. [mm]"""
    size = text.size_pt * MM
    if text.upright:
        return text.x_mm - 0.73 * size, text.y_mm - text.width_mm, text.x_mm + 0.21 * size, text.y_mm
    return text.x_mm, text.y_mm - 0.73 * size, text.x_mm + text.width_mm, text.y_mm + 0.21 * size


@pytest.mark.slow
def test_the_pdf_is_one_sheet_of_a4_and_equal_inputs_give_equal_bytes(made):
    first, answer, second = made
    data = (first / "report.pdf").read_bytes()
    assert answer["files"]["first_page"] == str(first / "report.pdf")
    assert pages_mm(data) == [pytest.approx(PAPER_MM, abs=0.1)]
    assert data == (second / "report.pdf").read_bytes()
    assert not [path for path in first.iterdir() if path.name.startswith(".")]


@pytest.mark.slow
def test_the_page_has_the_answers_numbers(made):
    first, answer, _ = made
    data = (first / "report.pdf").read_bytes()
    texts, page = pdf_texts(data), pdf_text(data)
    best, verdict = answer["recommendation"], answer["verdict"]
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
        assert texts[at + 1].startswith(f"{row['peak_force_N']:.1f} N: ")
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


@pytest.mark.slow
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


@pytest.mark.slow
def test_the_report_begins_with_its_verdict_and_has_the_steps_of_the_first_page(made):
    text = (made[0] / "report.html").read_text(encoding="utf-8")
    main = text.partition("<main>")[2]
    assert main.startswith('<div class="verdict')
    assert main.index('<section class="steps"') < main.index('<nav class="contents"') < main.index('id="part-1"')
    listed = re.findall(r'<li><a href="#([\w-]+)">(.*?)</a>', main)
    assert listed[0][0] == "part-1" and listed[-1] == ("sources", "Sources")
    headings = re.findall(r'<section id="([\w-]+)"><h2>(.*?)</h2>', main)
    assert listed == headings and len(headings) >= 8
    steps = re.findall("<li>(.*?)</li>", main.partition('<section class="steps">')[2].partition("</section>")[0])
    assert len(steps) == len(made[1]["next"]) > 1
    for step, shown in zip(made[1]["next"], steps):
        assert ("<code>" in shown) == bool(step["command"])


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
        Table(("steady N", "mm/s", "depth mm", "people N", ""), rows),
        [(words, [words] * 2)] * 3,
        [words] * (8 if long else 1),
        [words, f"dummydesign suggest --out {'x' * (400 if long else 4)}", words],
        "report.html continues",
    )


@pytest.mark.parametrize(("presses", "long"), [(0, False), (1, False), (4, False), (6, False), (24, True)])
def test_nothing_leaves_the_sheet_and_no_text_covers_another(presses, long):
    data = lay_out(some_page(presses, long))
    assert pages_mm(data) == [pytest.approx(PAPER_MM, abs=0.1)]
    texts = placed_texts(data)
    boxes = [box_of(text) for text in texts]
    for at, one in enumerate(boxes):
        for low, high, edge, side in zip(one[:2], one[2:], EDGES_MM, PAPER_MM):
            assert edge - 0.2 <= low and high <= side - edge + 0.2, texts[at]
        for number, other in enumerate(boxes[:at]):
            across = min(one[2], other[2]) - max(one[0], other[0])
            along = min(one[3], other[3]) - max(one[1], other[1])
            assert min(across, along) < 0.3, (texts[at], texts[number])
    assert sum(text.words.startswith("press ") for text in texts) == min(presses, 6)


@pytest.mark.parametrize(
    "name", ["#a $x$; *b* _c_ @d", "\"q\" 'r' <e> -- 2.64... -5 \\ `x`", "// /* [y] {z} ~ =", "шип; ≥ é"]
)
def test_a_name_is_written_as_it_is(name):
    page = some_page(1)
    table = Table(("steady N", name), [[name, "2.64"]])
    page = replace(
        page, title=name, facts=[Fact(name, name, True)], table=table, steps=[name], notes=[name], foot=f"{name};"
    )
    data = lay_out(page)
    texts = pdf_texts(data)
    assert texts.count(name) == 7 and f"{name};" in texts and len(pages_mm(data)) == 1


def test_a_line_break_in_a_fact_is_one():
    texts = pdf_texts(lay_out(replace(some_page(1), facts=[Fact("weigh", "polyol 7 g\nisocyanate 1 g")])))
    assert texts.index("isocyanate 1 g") == texts.index("polyol 7 g") + 1


def test_a_command_that_is_broken_is_one_for_a_shell():
    words = [
        "dummydesign",
        "predict",
        "--file",
        "'my pad/a b.csv'",
        *(f"--option-{n} {n}" for n in range(40)),
        "x" * 300,
    ]
    texts = pdf_texts(lay_out(replace(some_page(1), steps=[" ".join(words)])))
    at = next(row for row, text in enumerate(texts) if text.startswith("dummydesign predict"))
    lines = texts[at : texts.index("report.html continues")]
    assert len(lines) > 5 and "".join(f"{line}\n" for line in lines).replace("\\\n", "").strip() == " ".join(words)


def test_a_long_fact_ends_at_a_space_so_that_no_number_is_halved():
    texts = pdf_texts(lay_out(replace(some_page(1), facts=[Fact("numbers", " ".join(["12345.678"] * 60))])))
    (last,) = [text for text in texts if text.startswith("12345") and text.endswith(" ...")]
    assert set(last.split()) == {"12345.678", "..."}


def test_the_page_is_tagged_with_headings_table_and_words_for_figures():
    data = lay_out(some_page(2))
    plain = b"".join(objects(data).values())
    for tag in (b"/S/H1", b"/S/H2", b"/S/TH", b"/S/Figure", b"/Alt", b"/MarkInfo"):
        assert tag in plain.replace(b" ", b""), tag


def test_a_press_out_of_reach_is_named_and_its_pad_not_drawn():
    page = some_page(1)
    band = page.panels[0].plot.series[0]
    page = replace(page, panels=[replace(page.panels[0], plot=replace(page.panels[0].plot, series=(band,)))])
    assert "not reached" in pdf_texts(lay_out(page)) and "not reached" not in pdf_texts(lay_out(some_page(1)))


def test_curves_of_one_level_share_their_scale():
    page = some_page(2)
    high = replace(page.panels[1].plot, series=(Series.band("people", [1e-3, 10.0], [0.0, 0.0], [60.0, 60.0]),))
    for level, count in (("a", 2), ("b", 1)):
        panels = [page.panels[0], replace(page.panels[1], plot=high, level=level)]
        assert pdf_texts(lay_out(replace(page, panels=panels))).count("60") == count


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
    pad: PadShape = read_shape(shape)
    drawing = pad_section(pad, thickness, (150.0, 120.0), read_punch(punch), "glued")
    words = set(re.findall(">([^<>]+)</text>", drawing["svg"]))
    assert lengths <= words
    scale = float(re.search(r"scale ([\d.]+):1", " ".join(words))[1])
    runs = re.findall(r' points="([^"]+)', drawing["svg"])
    gel, *others = (np.array([point.split(",") for point in run.split()], float) for run in runs)
    assert np.ptp(gel[:, 1]) == pytest.approx(scale * thickness, abs=1e-3)
    x, z = (gel[:-2, 0] - gel[:-2, 0].mean()) / scale, (gel[-1, 1] - gel[:-2, 1]) / scale
    still = np.zeros_like(x)
    drop = pad.drop_mm(still, x) if pad.runs_out else pad.drop_mm(x, still)
    assert np.abs(thickness - drop - z).max() < 2e-3 / scale  # positions have three digits
    for points in (gel, *others):
        assert points.min() >= 0.0 and np.all(points.max(axis=0) <= SIZE)
    data = lay_out(
        replace(some_page(0), drawing=("Pad", pad_section(pad, thickness, (150.0, 120.0), read_punch(punch))))
    )
    assert lengths <= set(pdf_texts(data))


def test_plots_are_one_picture_and_equal_plots_equal_bytes():
    plots = [panel.plot for panel in some_page(6).panels]
    few, many = (picture("presses", plots[:count]) for count in (1, 6))
    assert few[:8] == b"\x89PNG\r\n\x1a\n" and many == picture("presses", plots)
    (wide, high), (wider, higher) = (struct.unpack(">II", data[16:24]) for data in (few, many))
    assert 3.5 * wide < wider < 4.5 * wide and 1.5 * high < higher < 2.5 * high  # four a row
