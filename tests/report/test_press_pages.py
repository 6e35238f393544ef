"""Reports of ``fit`` and ``compare`` in a real browser, and what their figures and tables hold."""

import csv
import json
import re

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.measurement.motion import Motion, ramp_and_hold
from dummydesign.report.page import figure_values
from dummydesign.studio.figures import measured_presses
from dummydesign.tissue.model.tissue_file import load_tissue
from tests.support.browser import visit
from tests.support.drawn_plots import figures_of

PHONE = 390
PRESSES = ((10.0, 5.0), (10.0, 12.0), (250.0, 5.0), (250.0, 12.0), (250.0, 12.0))


def traces(folder):
    """Files of presses of one subject of the palm, the last condition twice."""
    subject, files = load_tissue("palm").parameter_sets[2], []
    for number, (velocity, force) in enumerate(PRESSES):
        motion = ramp_and_hold(velocity, float(np.cbrt(force / subject.gamma1_N_per_mm3)), hold_s=3.0)
        time = np.union1d(np.arange(0.0, motion.time_s[-1], 2e-3), motion.time_s[:90])
        x = np.interp(time, motion.time_s, motion.displacement_mm)
        noise = 0.02 * np.random.default_rng(number).normal(size=len(time))
        rows = np.column_stack([time, x, subject.force(Motion(time, x), velocity) + noise])
        files.append(str(folder / f"<trace> {number}.csv"))
        np.savetxt(files[-1], rows, delimiter=",", header="time_s,displacement_mm,force_N", comments="")
    return files


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """{name: (path of the page, answer)} of both commands."""
    folder = tmp_path_factory.mktemp("pages")
    files = traces(folder)
    with pytest.MonkeyPatch.context() as patch:
        printed = []
        patch.setattr("builtins.print", lambda text="", **_: printed.append(str(text)))
        out = folder / "fit" / "mine.toml"
        assert run(["fit", *files, "--mode", "per-speed", "--elements", "5", "--out", str(out), "--json"]) == 0
        assert run(["compare", *files, "--tissue", "palm", "--out", str(folder / "compare"), "--json"]) == 0
    fit, compare = (json.loads(text) for text in printed if text.startswith("{"))
    return {
        "fit": (folder / "fit" / "mine-report" / "report.html", fit),
        "compare": (folder / "compare" / "report.html", compare),
    }


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fit", "compare"])
def test_a_report_opens_without_errors_asks_nothing_and_fits_a_phone(made, name, tmp_path):
    path, _ = made[name]
    measure = (
        "parent.document.title = JSON.stringify({width: innerWidth, page: document.scrollingElement.scrollWidth,"
        "plots: [...document.querySelectorAll('div.plot')].map((s) => Math.round(s.getBoundingClientRect().width))});"
    )
    inner = path.read_text(encoding="utf-8").replace("</body>", f"<script>{measure}</script></body>")
    (tmp_path / "inner.html").write_text(inner, encoding="utf-8")
    outer = tmp_path / "outer.html"
    outer.write_text(f'<iframe src="inner.html" width="{PHONE}" height="800" style="border:0"></iframe>')
    seen = visit(outer.as_uri(), tmp_path, "--allow-file-access-from-files", "--disable-web-security")
    assert seen.console == [] and seen.requests == []
    found = json.loads(re.search("<title>(.*?)</title>", seen.dom)[1])
    assert found["width"] == PHONE and found["page"] <= PHONE
    assert len(found["plots"]) >= 6 and min(found["plots"]) > 0.85 * PHONE


@pytest.mark.slow
@pytest.mark.parametrize("name", ["fit", "compare"])
def test_figures_are_listed_have_words_and_units_and_text_from_files_is_no_markup(made, name):
    path, answer = made[name]
    text = path.read_text(encoding="utf-8")
    figures = figures_of(text)
    assert list(figures) == list(figure_values(answer["files"]["report_values"]))
    titles = (figure["layout"][f"{side}axis"]["title"]["text"] for figure in figures.values() for side in "xy")
    assert all("[" in title for title in titles if title)
    assert "<trace>" not in text and "&lt;trace&gt;" in text
    assert answer["files"]["report"] == str(path)


def rows_of(path):
    with open(path, newline="") as stream:
        return list(csv.DictReader(stream))


def press_rows(answer, speed):
    """Values of the press at about 5 N at one speed."""
    figures = figure_values(answer["files"]["report_values"])
    (name,) = [name for name in figures if name.startswith("press-5") and name.endswith(f"-{speed}")]
    return figures[name]


@pytest.mark.slow
def test_measured_and_fitted_differ_in_the_report_by_the_residual_of_the_fit(made):
    answer = made["fit"][1]
    rows = press_rows(answer, "250mm-s")
    seen, model = (
        np.array([(float(r["x"]), float(r["y"])) for r in rows if r["series"] == series]).T
        for series in ("measured", "fitted")
    )
    late = seen[0] > 0.1
    left = seen[1][late] - np.interp(seen[0][late], *model)
    assert np.sqrt(np.mean(left**2)) < answer["noise_floor_N"]
    residual = figure_values(answer["files"]["report_values"])["residual-hold"]
    table = rows_of(answer["files"]["residuals"])
    drawn = sorted(float(r["y"]) for r in residual if r["series"] != "three noise floors")
    assert len(drawn) > 80 and drawn[-1] <= max(float(r["residual_N"]) for r in table) * (1 + 1e-5)


@pytest.mark.slow
def test_the_studio_draws_the_presses_that_the_fit_report_wrote(made):
    path, answer = made["fit"]
    plots = measured_presses(path.parent / answer["files"]["report_values"])
    names = [name for name in figure_values(answer["files"]["report_values"]) if name.startswith("press-")]
    assert [plot.name for plot in plots] == names and len(names) == 4
    text = path.read_text(encoding="utf-8")
    for plot in plots:
        assert " N steady at " in plot.title
        figure, drawn = figures_of(text)[plot.name], figures_of(plot.html())[plot.name]
        assert drawn["layout"] == figure["layout"]
        dots = [trace for trace in drawn["data"] if trace["mode"] == "markers"]
        assert dots and all(len(trace["x"]) >= 20 for trace in dots)
        table = [trace["y"] for trace in figure["data"]]
        assert all(trace["y"] in table for trace in drawn["data"])
        assert {trace["name"] for trace in drawn["data"]} == {"measured", "fitted"}


@pytest.mark.slow
def test_the_fit_report_says_parameters_rivals_and_where_the_law_comes_from(made):
    path, answer = made["fit"]
    text = path.read_text(encoding="utf-8")
    c3 = answer["parameters"]["c3_N_s_per_mm"]["250"]
    for number in (c3["value"], c3["low"], c3["high"]):
        assert f"<td>{number:.5g}</td>" in text
    for row in answer["comparison"].values():
        assert f"<td>{row['aicc']:.1f}</td>" in text
    assert "5 (reported)" in text and "IEEE Access" in text and "noise floor" in text


def test_what_is_not_identifiable_is_said_beside_its_parameter():
    from dummydesign.report.page import table_of_parameters

    entry = {"value": 2.0, "low": None, "high": 3.0, "at_bound": True, "reason": "not identifiable: no bound below"}
    row = table_of_parameters({"c2": {"10": entry}, "gamma1": entry | {"at_bound": False, "reason": ""}}).rows
    assert row[0] == ["c2 at 10 mm/s", "2", None, "3", "at the limit of its range; not identifiable: no bound below"]
    assert row[1][-1] == ""


@pytest.mark.slow
def test_the_compare_report_draws_the_dummy_in_the_ranges_it_counted(made):
    answer = made["compare"][1]
    rows = press_rows(answer, "10mm-s")
    low, high = ([float(r[end]) for r in rows if r["series"] == "subjects of palm"] for end in ("low", "high"))
    time = [float(r["x"]) for r in rows if r["series"] == "subjects of palm"]
    x, y = np.array([(float(r["x"]), float(r["y"])) for r in rows if r["series"] == "dummy"]).T
    inside = (y >= np.interp(x, time, low) - 0.06) & (y <= np.interp(x, time, high) + 0.06)
    condition = next(r for r in answer["force_variation_range"] if r["velocity_mm_s"] == 10 and r["steady_force_N"] < 6)
    assert abs(inside.mean() - condition["inside_fraction"]) < 0.1
    text = made["compare"][0].read_text(encoding="utf-8")
    assert f"{100 * condition['inside_fraction']:.0f} %" in text and "Steady force over depth" in text


@pytest.mark.slow
def test_the_pages_have_a_dark_and_a_printed_form(made):
    for path, _ in made.values():
        text = path.read_text(encoding="utf-8")
        assert "prefers-color-scheme:dark" in text and "@media print" in text and "Content-Security-Policy" in text
