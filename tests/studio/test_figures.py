"""Figures of the studio: every press of the protocol, small and fast; measured presses from a report's files."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.core.files import csv_text
from dummydesign.design.pad_evaluator import PadEvaluator
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.files.solid_view import pad_solids, pad_view
from dummydesign.report.plot import COLUMNS, Plot, Series, plots_js
from dummydesign.studio import figures
from dummydesign.studio.slider_model import evaluator_of
from dummydesign.studio.state import State
from dummydesign.studio.widgets import page_head
from tests.support.drawn_plots import figures_of


@pytest.fixture(scope="module")
def looked(tmp_path_factory):
    """Inputs, shape and pad of a crowned pad."""
    evaluator = evaluator_of(tmp_path_factory.mktemp("project"), State("forefinger"))
    shape = read_shape("crowned:21.2,2,9.4")
    return evaluator.problem, shape, evaluator.evaluate(shape, 4.5, 15.4)


def test_every_press_of_the_protocol_is_drawn_small(looked):
    inputs, shape, pad = looked
    plots = figures.pad_plots(inputs, shape, pad)[2:]
    assert [plot.title.partition(":")[0] for plot in plots] == [
        f"{one.steady_force_N:g} N, {one.velocity_mm_s:g} mm/s" for one in inputs.targets.conditions
    ]
    assert len({plot.name for plot in plots}) == len(plots) == 6
    for plot, press in zip(plots, pad.candidate.evaluation.presses):
        drawn = figures_of(plot.html())[plot.name]["data"][-1]
        assert len(drawn["x"]) <= 124 and max(drawn["y"]) == pytest.approx(press.force_N[0].max(), rel=1e-5)
        at = np.interp(drawn["x"], press.time_s[0], press.force_N[0])
        assert drawn["y"] == pytest.approx(at.tolist(), rel=1e-4, abs=1e-5)
        assert 'style="aspect-ratio:300/222"' in plot.html()
        assert f"{press.force_N[0].max():.1f} N" in plot.title.replace("\u00a0", " ")


def test_a_moved_slider_changes_the_curves_of_the_pad_alone(looked):
    inputs, shape, pad = looked
    before, now = (
        figures.pad_plots(inputs, shape, one) for one in (pad, PadEvaluator(inputs).evaluate(shape, 4.5, 16.0))
    )
    drawn = [[plot.figure() for plot in plots] for plots in (before, now)]
    changes = {plot.name: plot.change(*pair) for plot, *pair in zip(now, *drawn)}
    for name, change in changes.items():
        names = {trace["name"] for trace in change["data"].values() if "name" in trace}
        assert name == "section" or names == {"this pad"}, name
        assert "layout" not in change
    assert len(json.dumps(list(changes.values()))) < 60_000


def test_one_legend_serves_the_force_over_depth_and_over_time(looked):
    inputs, shape, pad = looked
    text = figures.pad_html(figures.pad_plots(inputs, shape, pad))
    assert len(figures_of(text)) == 8
    legend = text[: text.index("<div")]
    assert legend.count('class="key"') == 4 and text.count('class="keys"') == 2


@pytest.mark.parametrize(
    ("name", "title", "series"),
    [
        ("press-5N-10mm-s", "5 N steady at 10 mm/s", ("measured", "fitted")),
        (
            "press-1.2e+01N-250mm-s-2",
            "1.2e+01 N steady at 250 mm/s",
            ("measured, a.csv", "fitted, a.csv", "measured, b, c.csv", "fitted, b, c.csv"),
        ),
        ("press-5mm-10mm-s-7N", "5 mm pad, 10 mm/s, 7 N", ("measured", "base", "corrected")),
        ("press-12.5mm-250mm-s-2.1mmdeep", "12.5 mm pad, 250 mm/s, 2.1 mm deep", ("measured", "base", "corrected")),
    ],
)
def test_measured_presses_are_read_from_the_files_of_a_report(tmp_path, name, title, series):
    t = np.geomspace(1e-4, 10.0, 300)
    force = 5.0 + 3.0 * np.exp(-((np.log(t) - np.log(0.2)) ** 2))
    curves = tuple(
        (Series.dots if one.startswith("measured") else Series.line)(one, t, force + k) for k, one in enumerate(series)
    )
    made = Plot(name, "t", "a", "time since contact [s]", "force [N]", "time_s", "force_N", curves, log_x=True)
    other = Plot("residual", "t", "a", "x", "y", "time_s", "force_N", curves)
    (tmp_path / "mine.csv").write_text(csv_text(COLUMNS, [*other.rows(), *made.rows()]), encoding="utf-8")
    assert figures.measured_presses(tmp_path / "gone.csv") == []
    (plot,) = figures.measured_presses(tmp_path / "mine.csv")
    assert plot.title == title and plot.x_range == (0.01, 10.0)
    for k, (drawn, one) in enumerate(zip(plot.series, series)):
        assert drawn.label == one.partition(", ")[0] and (drawn.kind == "dots") == one.startswith("measured")
        assert np.allclose(drawn.y, force + k, rtol=1e-5) and np.allclose(drawn.x, t, rtol=1e-5)
    assert len({one.style for one in plot.series}) == len({one.partition(", ")[0] for one in series})


def test_forces_that_a_pad_does_not_reach_and_single_points_are_not_drawn_of_a_comparison(tmp_path):
    force, depth = np.array([5.0, 10.0, 15.0]), np.array([1.0, 1.5, np.nan])
    people = Series.band("subjects", force, depth - 0.1, depth + 0.1, sideways=True)
    drawn = [people, Series.line("pad", depth, force), Series.dots("measured", [1.0], [5.0])]
    made = Plot("steady", "t", "a", "depth [mm]", "force [N]", "depth_mm", "force_N", drawn)
    (tmp_path / "report.csv").write_text(csv_text(COLUMNS, made.rows()), encoding="utf-8")
    (plot,) = figures.compared_plots(tmp_path / "report.csv")
    assert [(one.label, one.kind, len(one.y)) for one in plot.series] == [("subjects", "band", 2), ("pad", "line", 2)]
    assert np.array_equal(plot.series[0].y, force[:2]) and np.allclose(plot.series[0].high, depth[:2] + 0.1)


def test_the_script_of_the_plots_is_an_element_of_the_head():
    text = page_head()
    assert f"<script>{plots_js()}</script>" in text
    assert text.count("<script") == text.count("</script") == 4 and text.count("</style") == 1
    assert "http://" not in text.replace("http://www.w3.org/2000/svg", "")


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("slab", {"pad"}),
        ("crowned:20,2,9", {"pad"}),
        ("layered:4,0.6", {"lower layer", "upper layer"}),
        ("boned:radius=7.7,height=3.6,foot=6.5", {"rigid bone", "pad"}),
    ],
)
def test_a_solid_shows_what_is_inside_a_pad(text, parts):
    solids = pad_solids(read_shape(text), 9.0)
    assert all(f'"{name}"' in pad_view(read_shape(text), 9.0) for name in parts)
    assert set(solids) == parts
    assert all(len(faces) and np.isfinite(faces).all() for faces in solids.values())
    volume = sum(
        float(np.einsum("ni,ni->n", faces[:, 0], np.cross(faces[:, 1], faces[:, 2])).sum()) / 6.0
        for faces in solids.values()
    )
    if "rigid bone" not in parts:
        whole = 150.0 * 120.0 * 9.0
        assert 0.7 * whole < volume <= whole * (1.0 + 1e-9)
    else:
        assert solids["rigid bone"][:, :, 2].max() == pytest.approx(3.6) and solids["pad"][:, :, 1].min() == 0.0


def test_steady_curves_of_designs_are_drawn_over_each_tissue_once_and_a_damaged_answer_is_left_out(tmp_path):
    people = {"force_N": [5.0, 10.0], "depth_low_mm": [1.0, 2.0], "depth_high_mm": [2.0, 3.0]}
    for name, tissue in (("a", "palm"), ("b", "palm"), ("c", "forefinger")):
        curve = {"force_N": [1.0, 5.0, 10.0], "depth_mm": [0.5, 1.0, None], "subjects": people}
        (tmp_path / name).mkdir()
        answer = {"inputs": {"tissue": tissue}, "steady_curve": curve}
        (tmp_path / name / "suggest.json").write_text(json.dumps(answer), encoding="utf-8")
    (tmp_path / "d").mkdir()
    (tmp_path / "d" / "suggest.json").write_text('{"steady_curve": {"depth_mm": "x"}}', encoding="utf-8")
    plot = figures.designs_plot(tmp_path, ["a", "b", "c", "d", "e"])
    assert [one.label for one in plot.series] == ["subjects of palm", "subjects of forefinger", "a", "b", "c"]
    assert plot.series[2].x[:2].tolist() == [0.5, 1.0] and np.isnan(plot.series[2].x[2])
    assert len({one.style for one in plot.series}) == 5
    assert figures.designs_plot(tmp_path, ["a", "d"]) is None
