"""Budget of a press on one more person: parts of the 95 % interval, and the statement on the nearest limit."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.person.limits import LimitRow
from dummydesign.person.on_person import budget_of_people, middle_and_spread


def interval(middle, spread):
    return [middle * math.exp(sign * HALF_WIDTH * spread) for sign in (-1.0, 1.0)]


def limit(value, middle, spread, name="force transient"):
    low, high = interval(middle, spread)
    return LimitRow(name, "N", value, middle, low, high, "pass", "", "test")


def press(file, middle=100.0, spread=0.3, own=(0.1, 0.1), limits=(), beyond=()):
    subjects = [
        {"interval_95": {"peak_N": interval(middle, one), "steady_N": interval(middle, 2.0 * one)}} for one in own
    ]
    of_press = SimpleNamespace(trace=SimpleNamespace(name=file), velocity_mm_s=10.0)
    return SimpleNamespace(
        press=of_press,
        subjects=subjects or [{"interval_95": None}],
        limits=limits,
        beyond=beyond,
        interval={"peak_N": interval(middle, spread)},
    )


def budget_of(*presses):
    return budget_of_people(SimpleNamespace(presses=presses))


def test_an_interval_gives_its_middle_and_standard_deviation():
    assert middle_and_spread(interval(7.0, 0.25)) == pytest.approx((7.0, 0.25))
    for unknown in (None, [None, 2.0], [0.0, 1.0]):
        assert middle_and_spread(unknown) is None


def test_without_limits_the_largest_peak_is_given_without_a_statement():
    budget = budget_of(press("small", 50.0), press("large", 100.0))
    assert (budget.reading.file, budget.reading.value) == ("large", pytest.approx(100.0))
    assert budget.statement is None and budget.to_dict()["false_acceptance"] is None


def test_the_parts_add_up_to_the_spread_of_one_more_person():
    budget = budget_of(press("a", spread=0.3, own=(0.06, 0.18)))
    own, differ = (one.standard_percent for one in budget.components)
    assert own == pytest.approx(100.0 * math.sqrt((0.06**2 + 0.18**2) / 2.0))
    assert budget.combined_percent == pytest.approx(30.0) and differ == pytest.approx(math.sqrt(900.0 - own**2))
    # subjects who are less certain than one more person leave nothing for differences
    assert budget_of(press("a", spread=0.1, own=(0.3,))).components[1].standard_percent == pytest.approx(0.0, abs=1e-6)


def test_people_who_are_measured_curves_have_one_part_that_is_known():
    budget = budget_of(press("a", own=()))
    assert budget.not_known == ("subjects and trace",) and budget.combined_percent == pytest.approx(30.0)


def test_the_check_that_is_most_probably_not_met_decides():
    near, far = limit(150.0, 100.0, 0.3), limit(300.0, 100.0, 0.3)
    budget = budget_of(press("far", limits=(far,)), press("near", limits=(far, near)))
    assert budget.reading.file == "near" and budget.decision.tolerance.high == 150.0
    tail = 0.5 * math.erfc(math.log(1.5) / 0.3 / math.sqrt(2.0))
    assert budget.false_acceptance == pytest.approx(tail) and budget.statement == "conditional pass"


def test_a_quasi_static_check_takes_the_steady_forces_of_the_subjects():
    budget = budget_of(press("a", own=(0.1,), limits=(limit(150.0, 100.0, 0.3, "force quasi-static"),)))
    assert budget.components[0].standard_percent == pytest.approx(20.0)


def test_a_press_beyond_those_on_people_never_passes_without_a_condition():
    budget = budget_of(press("a", limits=(limit(1e4, 100.0, 0.3),), beyond=("depth",)))
    assert budget.decision.statement == "pass" and budget.statement == "conditional pass"
    assert budget.false_acceptance is None


def test_people_without_an_interval_have_no_budget():
    nothing = press("a")
    nothing.interval = {"peak_N": (None, None)}
    assert budget_of(nothing) is None
