"""Cells, curves and marks that reports make of an answer; the pages themselves are tested where they are opened."""

from __future__ import annotations

import csv
import io
from types import SimpleNamespace

import numpy as np
import pytest

import dummydesign
from dummydesign.measurement.campaign_plan import Planned
from dummydesign.measurement.trace import Trace
from dummydesign.report import campaign_sheet, fit, import_preview, on_person
from tests.support.refusal import raises_code


def planned(sequence=1, **more):
    given = {"thickness_mm": 5.08, "velocity_mm_s": 254.0, "target": 10.0, "by_depth": False, "rest_s": 60.0}
    given |= {"age_days": 9.0, "hold_s": 10.0, "unload": False, **more}
    return Planned(file=f"p{sequence}.csv", repeat=1, sequence=sequence, **given)


def expected(**more):
    given = {"value": 2.54, "low": 2.0, "high": 3.0, "limit_mm": 3.0, "by_depth": False}
    return SimpleNamespace(**{**given, "beyond": False, "may_go_beyond": False, **more})


def test_a_sheet_in_inches_has_inches_and_pounds_and_the_same_presses():
    metric = campaign_sheet.sheet_html("a", [planned()], {}, 3, [expected()])
    inch = campaign_sheet.sheet_html("a", [planned()], {}, 3, [expected()], "in")
    lengths = {metric: ("5.08", "254", "10", "2.54 (2 to 3)"), inch: ("0.2", "10", "2.248", "0.1 (0.0787 to 0.118)")}
    for page, cells in lengths.items():
        for cell in cells:
            assert f'<td class="n">{cell}</td>' in page
    assert "<th>pad in</th>" in inch and "<th>pad mm</th>" in metric and "(seed 3)" in inch


def test_a_sheet_parts_days_and_marks_fresh_pads_and_unloading():
    plan = [planned(1, age_days=9.0), planned(2, age_days=9.0, rest_s=3600.0), planned(3, age_days=14.0, unload=True)]
    page = campaign_sheet.sheet_html("<b>", plan, {"pad": "<i>"}, 1)
    assert page.count('class="day"') == 2 and page.count("fresh, 1 h") == 1 and page.count(">record<") == 1
    assert "&lt;b&gt;: 3 presses" in page and "&lt;i&gt;" in page and "<i>" not in page


@pytest.mark.parametrize(("count", "tight"), [(40, False), (41, True)])
def test_a_long_sheet_is_tight(count, tight):
    page = campaign_sheet.sheet_html("a", [planned(at + 1) for at in range(count)], {}, 1)
    assert ("class=tight" in page) is tight and page.count('class="free"') == count


@pytest.mark.parametrize(
    ("more", "text"),
    [
        ({}, "2.54 (2 to 3)"),
        ({"high": None}, "2.54 (2 to over 3 !)"),
        ({"value": None, "high": None}, "over 3 ! (from 2)"),
        ({"value": None, "low": None, "high": None}, "over 3 !"),
        ({"value": None, "low": None, "high": None, "by_depth": True}, "beyond the model !"),
    ],
)
def test_what_is_expected_ends_at_the_limit(more, text):
    assert campaign_sheet._expected_text(expected(**more), 1.0) == text


def test_a_press_by_depth_says_nothing_of_steady_forces_and_one_that_goes_too_deep_is_marked():
    words = campaign_sheet._hold(False, [expected()])
    assert words.startswith("The steady force is that at the end") and "!" not in words
    assert campaign_sheet._hold(True, [expected()]) == "Hold the position; do not control the force."
    assert "<b>!</b>" in campaign_sheet._hold(True, [expected(), expected(may_go_beyond=True)])
    assert campaign_sheet._targets(True, True, "mm") == ["depth mm", "steady force N (95 %)"]
    assert campaign_sheet._targets(False, False, "in") == ["steady force lbf"]


def test_rivals_of_a_fit_are_counted_from_the_lowest():
    row = {"parameters": 5, "rmse_N": 0.1, "heldout_rmse_N": 0.2}
    data = {"elements": 5, "comparison": {"3": {**row, "aicc": -10.0}, "5": {**row, "aicc": -16.5}}}
    rows = fit._rivals(data).rows
    assert [(one[0], one[-2], one[-1]) for one in rows] == [("3", "-10.0", "6.5"), ("5 (reported)", "-16.5", "0.0")]


@pytest.mark.parametrize("name", ["fit.csv", "fit", "toml"])
def test_a_fit_is_written_to_a_tissue_file_alone(tmp_path, name):
    with raises_code("bad_name", "out"):
        dummydesign.fit([], out=tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def imported(noise=0.0):
    """A ramp of 2 mm from 1 mm above the pad at 10 mm/s, 1 kHz, force 6 N/mm."""
    time = np.arange(0.0, 5.0, 1e-3)
    x = np.minimum(10.0 * time - 1.0, 2.0)
    summary = SimpleNamespace(depth_mm=2.0, peak_force_N=12.0, stop_time_s=0.3, hold_s=4.7, hold_end_s=5.0)
    return SimpleNamespace(
        number=1,
        time_s=time,
        displacement_mm=x,
        force_N=6.0 * np.maximum(x, 0.0) + noise,
        summary=summary,
        begins_s=20.0,
        contact_low_mm=-0.02,
        contact_high_mm=0.03,
    )


def test_a_drawn_press_keeps_every_sample_of_its_rise_and_its_ends():
    press = imported()
    some = import_preview._some(press)
    rise = np.flatnonzero(press.time_s <= 0.3)
    assert set(rise) <= set(some) and some[-1] == len(press.time_s) - 1 and len(some) < len(press.time_s)


def test_the_contact_of_a_press_is_its_last_sample_above_the_pad():
    assert import_preview._contact_time(imported()) == pytest.approx(0.1, abs=1.1e-3)
    begun = imported()
    begun.displacement_mm = begun.displacement_mm + 2.0
    assert import_preview._contact_time(begun) == 0.0


def test_the_figure_of_a_contact_ends_at_fifteen_hundredths_of_the_force():
    press = imported()
    band, line, zero = import_preview._toe(0, SimpleNamespace(name="a"), press).series
    assert line.y.max() == pytest.approx(0.15 * 12.0, abs=0.06) and line.x.min() >= -1.5 * 0.3 - 0.01
    np.testing.assert_allclose(band.x, [-0.02, 0.03])
    assert zero.x.tolist() == [0.0]


def test_a_recording_has_its_holds_and_contacts_at_the_time_of_the_file():
    plot = import_preview._recording(0, SimpleNamespace(name="a", presses=[imported()]))
    hold, line, touch = plot.series
    np.testing.assert_allclose(hold.x, [20.3, 25.0])
    assert line.x[0] == 20.0 and touch.x[0] == pytest.approx(20.1, abs=2e-3) and "1 press," in plot.alt


def test_decisions_are_escaped():
    text = import_preview._decisions({"decisions": [{"what": "a<b", "value": "&", "why": "'x'"}]})
    assert "a&lt;b: &amp;" in text and text.count("<li>") == 1


def person(end_s):
    """Two people who give 3 and 5 N/mm under a pad of 6 N/mm, followed to ``end_s``."""
    time = np.linspace(0.0, end_s, 101)
    depth = np.stack([time, time])
    trace = Trace("a.csv", time, time, time)
    second = np.array([0.0, 1.0])
    press = SimpleNamespace(trace=trace, time_s=second, x_mm=second, force_N=6.0 * second)
    response = SimpleNamespace(time_s=time, depth_curve_mm=depth, force_curve_N=depth * [[3.0], [5.0]])
    return SimpleNamespace(press=press, response=response)


def test_curves_of_people_are_empty_where_they_are_not_known():
    depth, force = on_person.on_grid(person(0.5), np.array([0.25, 0.5, 0.6]))
    np.testing.assert_allclose(depth, [[0.25, 0.5, np.nan]] * 2)
    np.testing.assert_allclose(force[1], [1.25, 2.5, np.nan])


@pytest.mark.parametrize(("rate", "count"), [(10.0, 11), (20.0, 21)])
def test_the_csv_has_pad_band_and_subjects_at_an_even_rate(rate, count):
    tissue = SimpleNamespace(subjects=[SimpleNamespace(name="ann"), SimpleNamespace(name="bob")])
    answer = SimpleNamespace(tissue=tissue, presses=[person(0.5)])
    rows = list(csv.DictReader(io.StringIO(on_person.curves_csv(answer, rate))))
    assert len(rows) == count
    for row in rows:
        t = float(row["time_s"])
        assert float(row["pad_force_N"]) == pytest.approx(6.0 * t, abs=1e-6)
        if t <= 0.5:
            values = [float(row[name]) for name in ("people_low_N", "people_high_N", "ann_force_N", "bob_force_N")]
            assert values == pytest.approx([3.0 * t, 5.0 * t, 3.0 * t, 5.0 * t], abs=1e-6)
        else:
            assert row["people_low_N"] == row["bob_force_N"] == ""
