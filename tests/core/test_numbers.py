"""Numbers as typed and as kept: usual ranges, units, lists, ranges, times, and quantities as distributions."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dummydesign.core import parsing
from dummydesign.core.interpolation import MOST_ROWS, uniform_times
from dummydesign.core.parsing import (
    THICKNESS,
    UNITS,
    VELOCITY,
    QuantitySpec,
    columns_in,
    parse_limits,
    positive,
    read_allowed,
    read_number,
    read_numbers,
    read_size,
    twin_of,
)
from dummydesign.core.quantity import HALF_WIDTH, KINDS, Quantity, has_line, line_of, value_at
from tests.support.refusal import raises_code

PURPOSES = {name: value for name, value in vars(parsing).items() if isinstance(value, QuantitySpec)}


@pytest.mark.parametrize("name", sorted(PURPOSES))
def test_a_bare_number_in_its_usual_range_is_taken_and_one_that_another_unit_brings_there_is_questioned(name):
    purpose = PURPOSES[name]
    low, high = purpose.usual
    meant = math.sqrt(max(low, 1e-9) * min(high, 1e9))
    for number in (low, 1.001 * low, meant, 0.999 * high, high):
        if 0.0 < number < math.inf:
            assert read_number(number, purpose) == number
    for unit, size in UNITS[purpose.unit].items():
        if abs(math.log10(size)) >= 3.0 and not low <= meant / size <= high:
            with raises_code("implausible_unit"):
                read_number(meant / size, purpose)
            # Said with its own unit it is taken.
            assert read_number(f"{meant / size!r}{purpose.unit}", purpose) == pytest.approx(meant / size)
        assert read_number(f"2.5 {unit}", purpose) == pytest.approx(2.5 * size)
    for number in (0.0, -1.0):
        assert read_number(number, purpose) == number


def test_units_of_one_kind_are_in_the_proportions_of_the_international_system():
    """Metres, seconds, newtons, pascals and grams of each; an inch is 25.4 mm, a pound of force 4.448 N."""
    assert [UNITS["mm"][unit] for unit in ("um", "µm", "mm", "cm", "in", "m")] == [1e-3, 1e-3, 1.0, 10.0, 25.4, 1000.0]
    prefix = {"": 1.0, "m": 1e-3, "k": 1e3, "M": 1e6}
    for kind, base in (("N", "N"), ("kPa", "Pa"), ("Hz", "Hz"), ("s", "s"), ("g", "g"), ("kg", "g")):
        for unit, size in UNITS[kind].items():
            if unit.endswith(base) and unit.removesuffix(base) in prefix:
                assert size == pytest.approx(prefix[unit.removesuffix(base)] / prefix[kind.removesuffix(base)])
    assert UNITS["s"]["min"] == 60.0 and UNITS["kg"]["t"] == 1000.0 and UNITS[""]["%"] == 0.01
    pound, inch = 0.45359237 * 9.80665, 0.0254
    assert UNITS["N"]["lbf"] == pytest.approx(pound, rel=1e-9)
    assert UNITS["kPa"]["psi"] == pytest.approx(1e-3 * pound / inch**2, rel=1e-9)
    assert UNITS["N/mm"] == pytest.approx({"N/m": 1e-3, "N/cm": 0.1, "N/mm": 1.0, "kN/m": 1.0})
    assert [UNITS["mm/s"][unit] for unit in ("mm/s", "cm/s", "in/s", "m/s")] == [1.0, 10.0, 25.4, 1000.0]
    assert UNITS["mm/s2"] == {"mm/s2": 1.0, "m/s2": 1000.0}


def test_only_finite_numbers_above_zero_are_positive():
    for number in (1, 1e-300, np.float64(2.0), np.int64(3)):
        positive("force in N", number)
    for wrong in (0.0, -1.0, math.inf, math.nan, "1"):
        with raises_code("out_of_range", "force_N"):
            positive("force in N", wrong)


def test_a_number_at_the_end_of_its_range_is_allowed():
    for number in (1.0, 4.0):
        assert read_allowed(number, parsing.DEPTH, 1.0, 4.0) == number
    for number in (0.99, 4.01):
        with raises_code("out_of_range"):
            read_allowed(number, parsing.DEPTH, 1.0, 4.0)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("3:5:0.5", [3.0, 3.5, 4.0, 4.5, 5.0]),
        ("3:5:0.75", [3.0, 3.75, 4.5]),
        ("2:2:1", [2.0]),
        ("0:1:0.1", [0.1 * k for k in range(11)]),
        ("1,5, 2.5", [1.0, 5.0, 2.5]),
        ("-1:1:1", [-1.0, 0.0, 1.0]),
        ("1e3:2e3:500", [1000.0, 1500.0, 2000.0]),
        ("5mm,1cm", [5.0, 10.0]),
    ],
)
def test_a_range_has_its_ends_and_steps(text, values):
    found = read_numbers(text, "thickness in mm")
    assert found == pytest.approx(values, abs=1e-15) and found[-1] == pytest.approx(values[-1], abs=0.0)
    assert read_numbers(text, "thickness in mm") == tuple(found)


def test_the_last_value_of_a_range_is_exactly_its_stop():
    for step, count in ((0.1, 271), (0.05, 541), (0.3, 91), (0.7, 39)):
        values = read_numbers(f"3:30:{step}", "thickness in mm")
        assert len(values) == count and values[0] == 3.0
        assert values[-1] <= 30.0 and max(abs(values[k] - 3.0 - k * step) for k in range(count)) < 1e-9
    assert read_numbers("3:30:0.1", "thickness in mm")[-1] == 30.0 and read_numbers("0:1e-6:1e-7", "x")[-1] == 1e-6


@pytest.mark.parametrize("text", ["1:2", "1:2:0", "1:2:-1", "2:1:1", "1:2:3:4"])
def test_what_is_no_range_is_refused(text):
    with raises_code("malformed"):
        read_numbers(text, "depth in mm")


def test_a_range_of_more_values_than_are_allowed_is_refused(monkeypatch):
    with raises_code("too_large"):
        read_numbers("0:1e9:1", "depth in mm")
    monkeypatch.setattr(parsing, "MOST_VALUES", 100)
    assert len(read_numbers("1:100:1", "depth in mm")) == 100
    with raises_code("too_large"):
        read_numbers("0:100:1", "depth in mm")
    for text in ("a:2:1", "1,inf", "1,nan", ""):
        with raises_code("not_a_number"):
            read_numbers(text, "depth in mm")


def test_limits_are_two_numbers_in_order_or_one_for_both():
    assert parse_limits("1:3", "depth in mm") == parse_limits((1, 3), "depth in mm") == (1.0, 3.0)
    assert parse_limits("2cm", "depth in mm") == (20.0, 20.0) and parse_limits("2:2", "depth in mm") == (2.0, 2.0)
    for wrong in ("3:1", "1:2:3"):
        with raises_code("malformed"):
            parse_limits(wrong, "depth in mm")
    assert read_size("slab:40x50", "pad") == (40.0, 50.0)


def test_a_column_in_inches_stands_for_its_twin_and_the_millimetre_goes_first():
    header = ["time_s", "displacement_in", "force_lbf", "velocity_mm_s", "velocity_in_s"]
    places, sizes = columns_in(("time_s", "displacement_mm", "force_N", "velocity_mm_s", "depth_mm"), header)
    assert places == [0, 1, 2, 3, None] and sizes == pytest.approx([1.0, 25.4, 4.4482216152605, 1.0, 25.4])
    assert twin_of("speed_mm_s") == ("speed_in_s", 25.4) and twin_of("speed_mm_s", "mm") == ("speed_mm_s", 1.0)


def test_times_at_a_rate_cover_each_span_and_end_with_it_where_it_is_a_whole_number_of_steps():
    first, second = uniform_times([(0.0, 0.3), (1.05, 1.2)], 10.0)
    assert first == pytest.approx([0.0, 0.1, 0.2, 0.3]) and second == pytest.approx([1.05, 1.15])
    assert len(uniform_times([(0.0, 4.35)], 1000.0)[0]) == 4351
    assert len(uniform_times([(0.0, MOST_ROWS / 1000.0)], 1000.0)[0]) == MOST_ROWS + 1
    with raises_code("too_large", "rate_Hz"):
        uniform_times([(0.0, MOST_ROWS / 1000.0), (5.0, 5.1)], 1000.0)


DEVIATES = np.array([-HALF_WIDTH, -1.0, -0.3, 0.0, 0.3, 1.0, HALF_WIDTH])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("value", "low", "high"), [(2.0, 1.0, 8.0), (0.5, -1.0, 3.0), (0.0, 0.0, 1.0)])
def test_a_quantity_has_its_value_for_median_and_its_interval_for_95_per_cent(kind, value, low, high):
    found = value_at(Quantity(value, low, high, kind, "made up"), DEVIATES)
    assert found[3] == pytest.approx(value) and np.all(np.diff(found) >= 0.0)
    if kind == "assumed":
        # Half of the probability lies evenly to either side; both ends are reached.
        share = np.array([0.5 * (1.0 + math.erf(z / math.sqrt(2.0))) for z in DEVIATES])
        exact = np.interp(share, [0.0, 0.5, 1.0], [low, value, high])
        assert found == pytest.approx(exact)
        ends = value_at(Quantity(value, low, high, kind, "made up"), np.array([-9.0, 9.0]))
        assert ends == pytest.approx([low, high])
    else:
        assert found[[0, -1]] == pytest.approx([low, high])
        # A two-piece normal, of the logarithm where all of it is above 0.
        turn = np.log if low > 0.0 else np.asarray
        below, above = turn(found[3]) - turn(found[:3]), turn(found[4:]) - turn(found[3])
        assert below == pytest.approx(below[0] * np.abs(DEVIATES[:3]) / HALF_WIDTH)
        assert above == pytest.approx(above[-1] * DEVIATES[4:] / HALF_WIDTH)


def test_a_quantity_without_width_is_its_value_and_half_a_width_is_that_of_95_per_cent():
    assert value_at(Quantity(2.0, 2.0, 2.0, "fitted", "made up"), [[-3.0, 5.0]]).tolist() == [[2.0, 2.0]]
    assert math.erf(HALF_WIDTH / math.sqrt(2.0)) == pytest.approx(0.95, abs=1e-12)


def test_the_line_of_a_key_is_searched_after_the_one_before_it():
    text = "a = 1\n[one]\nkey = 1\n[two]\nother = 2\nkey = 3"
    assert (line_of(text, "a"), line_of(text, "[one]", "key"), line_of(text, "[two]", "key")) == (1, 3, 6)
    assert line_of(text, "[two]", "nothing") == 4 and line_of(text) == 1


def test_a_comment_or_a_text_is_not_the_line_of_a_key():
    text = (
        '# [pad] has a ratio = 15\nname = "ratio = 3, [pad]"\n[padding]\nratio = 1\n[pad] # ratio\n# ratio = 2\n'
        'note = "a # ratio = 4"\nratio = 16 # the ratio\n[[trial]]\nby = { name = "x", ratio = 5 }\n[a.b]\nc.d = 1'
    )
    assert line_of(text, "[pad") == line_of(text, "[pad]") == 5
    assert line_of(text, "[pad", "ratio") == 8 and line_of(text, "[[trial]]", "ratio") == 10
    assert line_of(text, "[trial") == 9 and line_of(text, "[a") == 11 and line_of(text, "c") == 12
    assert has_line(text, "[a.b") and not has_line(text, "[ratio")


@pytest.mark.parametrize("text", ["0.25", "0.25,250", "0.25:1:0.25"])
def test_every_call_asks_about_a_speed_that_looks_like_metres_a_second(text):
    for read in (read_numbers, read_numbers) if ":" not in text else (read_numbers,):
        with raises_code("implausible_unit", "velocity_mm_s"):
            read(text, VELOCITY)
    with raises_code("implausible_unit", "velocity_mm_s"):
        read_numbers([0.25, 10.0], VELOCITY)


def test_units_are_read_in_lists_and_ranges_and_a_step_may_be_small():
    assert read_numbers(["0.25m/s", 10], VELOCITY) == (250.0, 10.0) == read_numbers(["0.25m/s", 10], VELOCITY)
    assert read_numbers("0.01m/s:0.02m/s:5", VELOCITY) == (10.0, 15.0, 20.0)
    assert read_numbers("5:6:0.25", THICKNESS) == (5.0, 5.25, 5.5, 5.75, 6.0)
    with raises_code("unknown_unit", "velocity_mm_s"):
        read_numbers(["3N"], VELOCITY)
    with raises_code("not_a_number", "ratio"):
        read_numbers(["15mm"], "ratio")
    for text, named in (("15,9", True), ("abc", False)):
        with raises_code("not_a_number", "ratio") as caught:
            read_numbers([text], "ratio")
        assert ("decimal sign" in str(caught.value)) == named
