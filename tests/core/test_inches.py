"""Tables and sheets in inches and pounds-force: exact factors, round trips, what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest

from dummydesign import predict
from dummydesign.api.campaigns import plan_campaign
from dummydesign.core.parsing import twin_of
from dummydesign.measurement.campaign_plan import PlanSettings
from dummydesign.measurement.trace import read_motion, read_trace
from tests.support.refusal import raises_code

PRESS = {"young_kPa": 25, "force_N": 5, "velocity_mm_s": 100, "prony": "1:0.3", "hold_s": 1}


def test_the_factors_are_those_of_the_definitions():
    # inch of 1959; pound of 0.45359237 kg under standard gravity
    assert twin_of("displacement_mm") == ("displacement_in", 25.4)
    assert twin_of("force_low_N")[1] == pytest.approx(0.45359237 * 9.80665, rel=1e-15)
    assert twin_of("velocity_mm_s") == ("velocity_in_s", 25.4)
    assert twin_of("time_s") == ("time_s", 1.0)


def test_a_curve_in_inches_is_read_as_the_one_in_millimetres(tmp_path):
    # eight digits are written of each
    for units in ("mm", "in"):
        predict(10, **PRESS, out=tmp_path / f"{units}.csv", units=units)
    head = (tmp_path / "in.csv").read_text().splitlines()[0]
    assert head == "time_s,displacement_in,force_lbf,force_low_lbf,force_high_lbf"
    one, other = (read_trace(tmp_path / f"{units}.csv") for units in ("mm", "in"))
    np.testing.assert_allclose(other.displacement_mm, one.displacement_mm, rtol=1e-7, atol=1e-12)
    np.testing.assert_allclose(other.force_N, one.force_N, rtol=1e-7, atol=1e-12)
    moved = read_motion(tmp_path / "in.csv")
    np.testing.assert_allclose(moved.displacement_mm, one.displacement_mm, rtol=1e-7, atol=1e-12)


def test_each_column_has_its_own_unit_and_the_millimetre_goes_first(tmp_path):
    file = tmp_path / "press.csv"
    rows = [(0.001 * k, 0.01 * k, 0.02 * k) for k in range(200)]
    file.write_text("time_s,displacement_mm,force_lbf\n" + "\n".join(f"{t},{x},{f}" for t, x, f in rows))
    trace = read_trace(file)
    assert trace.displacement_mm[-1] == pytest.approx(1.99) and trace.force_N[-1] == pytest.approx(3.98 * 4.4482216)
    both = "\n".join(f"{t},{x},{9 * x},{f}" for t, x, f in rows)
    file.write_text("time_s,displacement_mm,displacement_in,force_N\n" + both)
    assert read_trace(file).displacement_mm[-1] == pytest.approx(1.99)


@pytest.mark.slow
def test_a_sheet_in_inches_has_the_numbers_of_the_one_in_millimetres(tmp_path, a_set_up):
    cells = {}
    for units in ("mm", "in"):
        plan_campaign(tmp_path / units, a_set_up, PlanSettings(targets=(4.0, 8.0)), power=False, units=units)
        page = (tmp_path / units / "sheet.html").read_text()
        heads = re.findall(r"<th>([^<]*)</th>", page)
        rows = [re.findall(r"<td[^>]*>([^<]*)</td>", row) for row in re.findall(r"<tr><td.*?</tr>", page)]
        cells[units] = heads, np.array([[float(cell.split()[0]) for cell in row[1:5]] for row in rows])
    assert cells["in"][0][1:5] == ["pad in", "in/s", "steady force lbf", "depth in (95 %)"]
    assert len(cells["mm"][1]) > 10
    np.testing.assert_allclose(cells["in"][1] * [25.4, 25.4, 4.4482216, 25.4], cells["mm"][1], rtol=6e-3)
    assert (tmp_path / "in" / "campaign.toml").read_text() == ((tmp_path / "mm" / "campaign.toml").read_text())


@pytest.fixture
def a_set_up():
    from dummydesign.measurement.campaign_file import SetUp

    return SetUp(name="c", young_kPa=30.0)


def test_other_units_and_units_without_a_table_are_refused(tmp_path):
    with raises_code("unknown_name", "units"):
        predict(10, **PRESS, out=tmp_path / "a.csv", units="inch")
    with raises_code("not_applicable", "units"):
        predict(10, **PRESS, units="in")
    assert list(tmp_path.iterdir()) == []
