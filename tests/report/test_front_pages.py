"""The first pages of loop, compare, whatif and on-person: one sheet each, with the numbers of the answers."""

import json
from pathlib import Path as FilePath

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.report.compare import next_steps
from dummydesign.report.front_page import HEIGHT_MM, PAPER_MM, WIDTH_MM
from dummydesign.report.plot import Plot, Series
from dummydesign.report.plot_drawing import plot_drawing
from dummydesign.report.vector_sheet import PT_MM, Path, Text
from tests.report.test_front_page import pdf_texts, sheet_texts
from tests.support.answer_inputs import make_inputs
from tests.support.pdf_paths import pages_mm

pytestmark = pytest.mark.slow

LIMITS = FilePath(__file__).parents[2] / "examples" / "limits.toml"
PRESSES = ("press_0.csv", "press_2.csv")
COMMANDS = {
    "loop": ["loop", "campaign"],
    "compare": ["compare", *PRESSES, "--tissue", "forefinger"],
    "whatif": ["whatif", "--thickness", "5:20:5", "--ratio", "15:17:0.5", "--tissue", "palm"],
    "plane": ["whatif", "--thickness", "4:20:4", "--ratio", "14,15.5"],
    "on-person": ["on-person", *PRESSES, "--tissue", "palm", "--limits", str(LIMITS)],
    "again": ["on-person", *PRESSES, "--tissue", "palm", "--limits", str(LIMITS)],
    "one-press": ["on-person", PRESSES[0], "--tissue", "palm"],
}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """{name: (folder, answer)} of each command."""
    folder = tmp_path_factory.mktemp("pages") / "in"
    make_inputs(folder)
    answers = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for name, words in COMMANDS.items():
            printed = []
            patch.setattr("builtins.print", lambda text="", *, kept=printed, **_: kept.append(str(text)))
            assert run([*words, "--out", name, "--json"]) in (0, 1), printed
            answers[name] = folder / name, json.loads(next(text for text in printed if text.startswith("{")))
    return answers


def texts_of(made, name):
    """Texts of the page of a command, in one."""
    return " ".join(pdf_texts((made[name][0] / "report.pdf").read_bytes()))


@pytest.mark.parametrize("name", COMMANDS)
def test_each_page_is_one_sheet_alike_in_report_and_pdf(made, name):
    folder, answer = made[name]
    data, html = (folder / "report.pdf").read_bytes(), (folder / "report.html").read_text(encoding="utf-8")
    assert pages_mm(data) == [pytest.approx(PAPER_MM, abs=0.1)] and answer["files"]["first_page"].endswith("report.pdf")
    assert pdf_texts(data) == sheet_texts(html)
    main = html.partition("<main>")[2]
    assert main.startswith('<section class="front"') and main.index('<nav class="contents"') < main.index("<h1")


def test_equal_presses_give_equal_bytes_and_others_do_not(made):
    first, again, other = ((made[name][0] / "report.pdf").read_bytes() for name in ("on-person", "again", "one-press"))
    assert first == again != other


def test_the_page_of_a_loop_has_errors_parameters_and_the_next_measurement(made):
    page, answer = texts_of(made, "loop"), made["loop"][1]
    assert answer["answer"][0] in page
    for stage in ("base", "after"):
        assert f"{answer[stage]['error']['train_rmse_N']:.4f}" in page
    for name, one in answer["after"]["parameters"].items():
        assert f"{name} {answer['base']['parameters'][name]['value']:.4g} {one['value']:.4g} {one['low']:.4g}" in page
    assert answer["effects"] and answer["next_measurement"]["text"][1:] in page
    for effect in answer["effects"]:
        for name, value in effect["parameters"].items():
            assert f"{name} - {value['value']:.4g} {value['low']:.4g} {value['high']:.4g} ({effect['name']})" in page


def test_the_page_of_a_comparison_has_the_verdict_and_each_press(made):
    page, answer = texts_of(made, "compare"), made["compare"][1]
    strong, _, rest = answer["verdict"]["text"].partition(". ")
    assert f"{answer['verdict']['light'].upper()}: {strong.upper()}" in page and rest in page
    for row in answer["force_variation_range"]:
        span = f"{row['range_peak_low_N']:.2f} to {row['range_peak_high_N']:.2f}"
        assert f"{row['peak_force_N']:.2f} {span} {100 * row['inside_fraction']:.0f} %" in page


INPUTS = {
    "traces": ["my pad/a.csv"],
    "tissue": "palm",
    "punch": "round:10",
    "lowpass": {"cutoff_hz": 35.0, "order": 2, "passes": 1},
}


@pytest.mark.parametrize(
    ("light", "level", "numbers"),
    [
        ("green", "stands_for", ()),
        ("amber", "usable_with_correction", ("1.12", "1.16")),
        ("red", "not_representative", ("dummydesign loop",)),
        (None, "", ()),
    ],
)
def test_what_to_do_with_a_measured_pad_follows_from_its_light(light, level, numbers):
    verdict = light and {"light": light, "level": level, "correction": {"factor": 1.16, "force": 1.12}}
    steps = next_steps({"verdict": verdict, "inputs": INPUTS})
    assert bool(steps) == (light is not None) and all(number in " ".join(steps) for number in numbers)
    assert len(steps) == (0 if light is None else 2)
    on_person = "dummydesign on-person 'my pad/a.csv' --tissue palm --drive steady --lowpass 35:2:1 --punch round:10"
    assert (on_person in steps) == (light in ("green", "amber"))


def test_a_pad_that_is_not_settled_is_not_to_be_used():
    verdict = {"light": "amber", "level": "not_settled", "correction": {"factor": 1.0, "force": 1.0}}
    steps = " ".join(next_steps({"verdict": verdict, "inputs": INPUTS}))
    assert "multiply" not in steps and "do not use" in steps and "dummydesign" not in steps


def test_the_page_of_a_study_has_the_best_designs_or_the_plane(made):
    page, rows = texts_of(made, "whatif"), made["whatif"][1]["rows"]
    best = sorted(rows, key=lambda row: -row["score"]["total"])
    for row in best[:5]:
        assert f"{row['score']['total']:.2f} {row['thickness_mm']:g} {row['ratio']:g} {row['young_kPa']:.3g}" in page
    assert "dummydesign suggest --tissue palm" in page
    assert f"Highest score for palm, aim average: {best[0]['thickness_mm']:g} mm, ratio {best[0]['ratio']:g}" in page
    page, rows = texts_of(made, "plane"), made["plane"][1]["rows"]
    forces = list(rows[0]["depth_mm_at_N"])
    known = [row for row in rows if row["ratio"] == 15.5]
    cells = [f"{row['depth_mm_at_N'][forces[2]]:.2f}, {row['peak_over_steady']['250']:.2f}" for row in known]
    assert " ".join(cells) in page and f"depth in mm at {forces[2]} N" in page.replace("Depth", "depth")


def test_the_page_on_people_has_the_closest_limit_and_every_press(made):
    from dummydesign.report.on_person_facts import limit_name, number_text

    page, answer = texts_of(made, "on-person"), made["on-person"][1]
    rows = [row for press in answer["presses"] for row in press["limits"]]
    assert len(rows) == 8 and f" of {len(rows)} " in page
    for press in answer["presses"]:
        low, high = press["band"]["peak_N"]
        assert f"{press['pad']['peak_N']:.3g} {low:.3g} to {high:.3g}" in page
    shown = 0
    for row in rows:
        numbers = [f"{number_text(row[key])} {row['unit']}" for key in ("person_high_95", "limit", "pad")]
        shown += f"{limit_name(row)}, people up to {numbers[0]} (95 %), limit {numbers[1]}, pad {numbers[2]}" in page
    assert shown == 5
    page, (press,) = texts_of(made, "one-press"), made["one-press"][1]["presses"]
    assert f"energy mJ {press['pad']['energy_mJ']:.3g} " in page


def plot_of(*layers, **more):
    return Plot("p", "title", "alt", "x [mm]", "y [N]", "x_mm", "y_N", layers, **more)


def test_a_drawn_curve_lies_where_its_values_are():
    x, y = np.linspace(0.0, 4.0, 9), np.linspace(0.0, 8.0, 9) ** 2
    plot = plot_of(Series.line("pad", x, y), Series.dots("measured", [2.0], [10.0], "aim"))
    drawn = plot_drawing(plot)((0.0, 0.0, 100.0, 60.0))
    ticks = {item.words: item for item in drawn if isinstance(item, Text)}
    assert {"0", "20", "40", "60", "1", "2", "3", "4"} <= set(ticks)
    (curve,) = [item for item in drawn if isinstance(item, Path) and item.stroke == "#0b5cad"]
    (left, low), (right, high) = curve.points[0], curve.points[-1]
    (dot,) = [item for item in drawn if isinstance(item, Path) and item.fill == "#b3500f"]
    middle = 0.5 * (np.min(dot.points, axis=0) + np.max(dot.points, axis=0))
    assert (middle[0] - left) / (right - left) == pytest.approx(0.5, abs=1e-3)
    assert (low - middle[1]) / (low - high) == pytest.approx(10.0 / 64.0, abs=1e-3)
    assert (ticks["0"].y_mm - ticks["40"].y_mm) / (low - high) == pytest.approx(40.0 / 64.0, abs=1e-3)


def test_a_gap_breaks_a_curve_and_a_sideways_band_lies_across():
    broken = plot_of(Series.line("pad", [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, np.nan, 3.0, 4.0]))
    assert sum(item.stroke == "#0b5cad" for item in plot_drawing(broken)((0, 0, 90, 50)) if isinstance(item, Path)) == 2
    band = plot_of(
        Series.band("people", [0.0, 10.0], [1.0, 1.0], [2.0, 2.0], sideways=True), Series.line("pad", [0, 4], [0, 10])
    )
    (area,) = [item for item in plot_drawing(band)((0, 0, 90, 50)) if isinstance(item, Path) and item.fill == "#b9cfe4"]
    points = np.array(area.points)
    assert np.ptp(points[:, 0]) < 0.5 * np.ptp(points[:, 1])


def test_names_of_curves_that_end_together_are_clear_of_each_other_and_bars_have_labels():
    plot = plot_of(*(Series.line(f"ratio {n}", [0.0, 1.0], [0.0, 1.0 + 1e-3 * n], f"alt{n}") for n in range(1, 6)))
    drawn = plot_drawing(plot)((0.0, 0.0, 80.0, 50.0))
    heights = sorted(item.y_mm for item in drawn if isinstance(item, Text) and item.words.startswith("ratio"))
    assert len(heights) == 5 and np.diff(heights).min() >= 7.0 * PT_MM
    bars = plot_of(Series.bars(["thickness", "modulus"], [-1.0, 0.0], [2.0, 3.0]), y_range=(0.0, 2.0))
    items = plot_drawing(bars)((0.0, 0.0, WIDTH_MM, 0.2 * HEIGHT_MM))
    assert {"thickness", "modulus"} <= {item.words for item in items if isinstance(item, Text)}
