"""What a plan can see follows from what it varies."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dummydesign.api.campaigns import _empty_campaign
from dummydesign.loop.planning import plan_power
from dummydesign.measurement.campaign_file import SetUp
from dummydesign.measurement.campaign_plan import PlanSettings, make_plan
from dummydesign.measurement.sensor import Lowpass

SET_UP = SetUp("drawn", 25.0, lowpass=Lowpass(35.0))


def power(design, set_up=SET_UP):
    plan = make_plan(design)
    return plan_power(plan, _empty_campaign(set_up, set_up.tables()), 0.025)


def test_the_default_plan_sees_most_effects_and_says_which_it_hides():
    found = power(PlanSettings())
    assert "base_slip" in found.hidden
    assert len(found.seen) >= 18 and "plate_friction" in found.untested
    assert ("sensor_lag", "time_skew") in {pair["effects"] for pair in found.alike}


@pytest.mark.slow
def test_one_speed_one_pad_and_one_day_leave_their_effects_out():
    narrow = power(PlanSettings(pads_mm=(10.0,), velocities_mm_s=(10.0,), ages_days=(9.0,)))
    whole = power(PlanSettings())
    assert "ageing" in narrow.untested or "ageing" in narrow.hidden
    assert len(narrow.seen) < len(whole.seen)
    doubled = power(PlanSettings(repeats=4))
    assert all(doubled.seen.get(name, 0.0) > size for name, size in whole.seen.items())


def test_no_way_back_hides_adhesion():
    plan = tuple(replace(row, unload=False) for row in make_plan(PlanSettings()))
    found = plan_power(plan, _empty_campaign(SET_UP, SET_UP.tables()), 0.025)
    assert "adhesion" not in found.seen
