"""The first pages of loop, compare, whatif and on-person: one sheet each, with the numbers of the answers."""

import json
import re
from dataclasses import replace
from pathlib import Path as FilePath

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.report.compare import next_steps
from dummydesign.report.front_page import draw_plot, lay_out, plot_drawing
from dummydesign.report.plot import Plot, Series
from tests.report.test_front_page import PAPER_MM, some_page
from tests.support.answer_inputs import make_inputs
from tests.support.pdf_paths import pages_mm
from tests.support.pdf_texts import MM, pdf_text, placed_texts

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
    return pdf_text((made[name][0] / "report.pdf").read_bytes())


@pytest.mark.parametrize("name", COMMANDS)
@pytest.mark.slow
def test_each_page_is_one_sheet_and_the_report_has_contents(made, name):
    folder, answer = made[name]
    data, html = (folder / "report.pdf").read_bytes(), (folder / "report.html").read_text(encoding="utf-8")
    assert pages_mm(data) == [pytest.approx(PAPER_MM, abs=0.1)] and answer["files"]["first_page"].endswith("report.pdf")
    main = html.partition("<main>")[2]
    assert "<svg" not in main.partition("<h1")[0] and '<nav class="contents"' in main


@pytest.mark.slow
def test_equal_presses_give_equal_bytes_and_others_do_not(made):
    first, again, other = ((made[name][0] / "report.pdf").read_bytes() for name in ("on-person", "again", "one-press"))
    assert first == again != other


@pytest.mark.slow
def test_the_page_of_a_loop_has_errors_parameters_and_the_next_measurement(made):
    page, answer = texts_of(made, "loop"), made["loop"][1]
    assert answer["answer"][0] in page
    for stage in ("base", "after"):
        assert f"{answer[stage]['error']['train_rmse_N']:.4f}" in page
    for name, one in answer["after"]["parameters"].items():
        row = f"{answer['base']['parameters'][name]['value']:.4g} {one['value']:.4g} {one['low']:.4g}"
        assert re.search(rf"{name} \S+ {row}", page)
    assert answer["effects"] and answer["next_measurement"]["text"][1:] in page
    for effect in answer["effects"]:
        for name, value in effect["parameters"].items():
            assert f"{name} - - {value['value']:.4g} {value['low']:.4g} {value['high']:.4g} ({effect['name']})" in page


@pytest.mark.slow
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
    assert len(steps) == {None: 0, "red": 3}.get(light, 2)
    on_person = "dummydesign on-person 'my pad/a.csv' --tissue palm --drive steady --lowpass 35:2:1 --punch round:10"
    assert (on_person in steps) == (light in ("green", "amber"))


def test_a_pad_that_is_not_settled_is_not_to_be_used():
    verdict = {"light": "amber", "level": "not_settled", "correction": {"factor": 1.0, "force": 1.0}}
    steps = " ".join(next_steps({"verdict": verdict, "inputs": INPUTS}))
    assert "multiply" not in steps and "do not use" in steps and "on-person" not in steps


@pytest.mark.slow
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


@pytest.mark.slow
def test_the_page_on_people_has_the_closest_limit_and_every_press(made):
    from dummydesign.report.on_person import limit_name, number_text

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


def drawn_by_kind(plot, **more):
    """Runs of points of each kind of series, and the numbers of x and y with their places."""
    drawn = draw_plot(plot, 6, **more)
    runs = {one["kind"]: [np.array(run) for run in one["runs"]] for one in drawn["series"]}
    return runs, {text: at for at, text in drawn["x"]}, {text: at for at, text in drawn["y"]}


def test_a_drawn_curve_lies_where_its_values_are():
    x, y = np.linspace(0.0, 4.0, 9), np.linspace(0.0, 8.0, 9) ** 2
    plot = plot_of(Series.line("pad", x, y), Series.dots("measured", [2.0], [10.0], "aim"))
    runs, across, along = drawn_by_kind(plot)
    assert {"0", "20", "40", "60"} <= set(along) and {"0", "1", "2", "3", "4"} <= set(across)
    ((curve,), (dot,)) = runs["line"], runs["dots"]
    assert curve[:, 0] / across["4"] == pytest.approx(x / 4.0, abs=1e-4)
    assert curve[:, 1] / along["40"] == pytest.approx(y / 40.0, abs=1e-3)
    assert dot[0] == pytest.approx([across["2"], along["20"] / 2.0], abs=1e-4)


def test_a_logarithmic_axis_has_powers_of_ten_and_its_unit_at_the_last():
    x = np.geomspace(1e-3, 10.0, 9)
    runs, across, _ = drawn_by_kind(plot_of(Series.line("pad", x, x), log_x=True, x_range=(1e-3, 10.0)), unit=" s")
    assert across == pytest.approx({"0.001": 0.0, "0.01": 0.25, "0.1": 0.5, "1": 0.75, "10 s": 1.0})
    assert runs["line"][0][:, 0] == pytest.approx(np.linspace(0.0, 1.0, 9), abs=1e-4)


@pytest.mark.parametrize("seed", range(20))
def test_numbers_of_an_axis_are_round_few_and_at_their_places(seed):
    draw = np.random.default_rng(seed)
    low, width = draw.normal(0.0, 10.0 ** draw.uniform(-3, 4)), 10.0 ** draw.uniform(-3, 4)
    plot = plot_of(Series.line("pad", [0.0, 1.0], [low, low + width]), zero=False, y_range=(low, low + width))
    _, _, along = drawn_by_kind(plot)
    assert 2 <= len(along) <= 7
    for text, at in along.items():
        assert float(text) == pytest.approx(low + at * width, abs=1e-5 * width + 1e-5 * abs(float(text)))


def test_a_gap_breaks_a_curve_and_a_sideways_band_lies_across():
    broken = plot_of(Series.line("pad", [0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 1.0, np.nan, 3.0, 4.0]))
    assert [len(run) for run in drawn_by_kind(broken)[0]["line"]] == [2, 2]
    band = plot_of(
        Series.band("people", [0.0, 10.0], [1.0, 1.0], [2.0, 2.0], sideways=True), Series.line("pad", [0, 4], [0, 10])
    )
    runs, across, along = drawn_by_kind(band)
    (area,) = runs["band"]
    assert {tuple(point) for point in np.round(area / [across["1"], along["10"]], 3)} == {
        (1, 0),
        (1, 1),
        (2, 0),
        (2, 1),
    }


def test_names_of_curves_that_end_together_are_clear_of_each_other_and_bars_have_labels():
    plot = plot_of(*(Series.line(f"ratio {n}", [0.0, 1.0], [0.0, 1.0 + 1e-3 * n], f"alt{n}") for n in range(1, 6)))
    data = lay_out(replace(some_page(0), drawing=("Curves", plot_drawing(plot))))
    heights = sorted(text.y_mm for text in placed_texts(data) if re.fullmatch(r"ratio \d", text.words))
    assert len(heights) == 5 and np.diff(heights).min() >= 7.0 * MM
    bars = plot_of(Series.bars(["thickness", "modulus"], [-1.0, 0.0], [2.0, 3.0]), y_range=(0.0, 2.0))
    runs, across, along = drawn_by_kind(bars)
    assert [*along] == ["thickness", "modulus"] and along["thickness"] > along["modulus"]
    first = np.array(runs["bars"][0])
    assert (first[:, 0].max() - across["0"]) / (across["2"] - across["0"]) == pytest.approx(1.0, abs=1e-4)
