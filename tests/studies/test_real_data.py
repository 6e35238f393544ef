"""The study of real presses: what it fits and how it judges, on presses of known laws."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from dummydesign.measurement.trace import Trace
from studies import real_data

ROOT = Path(__file__).parents[2]


def ramp_and_hold(name, force_of, depth_mm=2.0, velocity_mm_s=1.0):
    """A press of a law, with 10 s of hold."""
    time = np.arange(0.0, depth_mm / velocity_mm_s + 10.0, 0.05)
    way = np.minimum(velocity_mm_s * time, depth_mm)
    zero = Trace(name, time, way, np.zeros_like(time))
    return Trace(name, time, way, force_of(zero))


LAW = real_data.Law(3, 0.1, (0.3,), (2.0,))
NAMES = real_data.FIELDS[-7:]
LINEAR = real_data.Linear(0.4, (0.5, 0.2), (0.5, 6.0))


def test_the_linear_branches_follow_the_closed_form_of_a_ramp_and_hold():
    trace = ramp_and_hold("a", LINEAR.force_N, 2.0, 1.0)
    stop, held = 2.0, trace.time_s >= 2.0
    since = trace.time_s[held] - stop
    exact = 0.4 * 2.0 + sum(
        k * tau * (1.0 - np.exp(-stop / tau)) * np.exp(-since / tau) for k, tau in zip((0.5, 0.2), (0.5, 6.0))
    )
    assert np.allclose(trace.force_N[held], exact, rtol=1e-9)


def test_every_press_is_predicted_once_by_a_fit_of_others(monkeypatch):
    kept = []
    monkeypatch.setattr(real_data, "fitted", lambda traces: kept.append({one.name for one in traces}) or LAW)
    traces = [ramp_and_hold(f"{at}", LAW.force_N, 1.5 + 0.3 * at) for at in range(5)]
    rows = real_data.predicted_rows("made", "law", traces, folds=2)
    assert sorted(row["press"] for row in rows) == list("01234") and kept == [set("13"), set("024")]
    assert max(row["error_law"] for row in rows) < 1e-9 < 0.05 < min(row["error_spring"] for row in rows)


@pytest.mark.slow
def test_a_fit_finds_the_law_and_not_that_of_a_linear_material():
    own, other = ([ramp_and_hold(f"{depth}", law.force_N, depth) for depth in (1.5, 3.0)] for law in (LAW, LINEAR))
    found = dict(zip(NAMES, real_data.errors(own[1], 0.1, real_data.fitted(own[:1]), LINEAR), strict=True))
    assert found["error_law"] < 0.01
    law, linear = real_data.fitted(other[:1]), real_data.fitted_linear(other[:1])
    found = dict(zip(NAMES, real_data.errors(other[1], 0.1, law, linear), strict=True))
    assert found["error_linear"] < 0.01 < 0.05 < found["error_law"]


def test_a_stiffer_press_and_a_late_contact_are_told_apart():
    spring, law, linear = 0.1, LAW, LINEAR
    stiff = ramp_and_hold("stiff", lambda trace: 1.6 * LAW.force_N(trace))
    found = dict(zip(NAMES, real_data.errors(stiff, spring, law, linear), strict=True))
    assert found["scale"] == pytest.approx(1.6, rel=1e-3) and found["error_law_scaled"] < 1e-3
    late = ramp_and_hold("late", lambda trace: LAW.force_N(trace, 0.4))
    found = dict(zip(NAMES, real_data.errors(late, spring, law, linear), strict=True))
    assert found["shift_mm"] == pytest.approx(0.4, abs=0.01) and found["error_law_shifted"] < 0.005 < found["error_law"]


def test_the_page_shows_the_rows_of_the_data_file():
    with (ROOT / real_data.ROWS).open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == real_data.FIELDS
    text = (ROOT / "docs" / "real-data.md").read_text(encoding="utf-8")
    assert real_data.table(rows) in text
