"""Numbers with units: what they mean, and which bare ones are questioned."""

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.parsing import FORCE, UNITS, VELOCITY, YOUNG, QuantitySpec, read_number, read_numbers, read_size
from tests.support.refusal import raises_code


@pytest.mark.parametrize(
    ("text", "purpose", "value"),
    [
        ("0.25m/s", VELOCITY, 250.0),
        ("10 mm/s", VELOCITY, 10.0),
        ("25kPa", YOUNG, 25.0),
        ("0.025MPa", YOUNG, 25.0),
        ("0.25mm/s", VELOCITY, 0.25),
        ("5", FORCE, 5.0),
        (7.5, FORCE, 7.5),
        ("0.01kN", FORCE, 10.0),
    ],
)
def test_a_number_with_a_unit_means_what_it_says(text, purpose, value):
    assert read_number(text, purpose) == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize("unit", sorted(UNITS))
def test_every_unit_reads_back_its_own_size(unit):
    for name, size in UNITS[unit].items():
        assert read_number(f"3{name}", QuantitySpec("x", unit, (0.0, 1e9))) == pytest.approx(3.0 * size)


@pytest.mark.parametrize(
    ("value", "purpose", "code"),
    [(0.25, VELOCITY, "implausible_unit"), ("0.025", YOUNG, "implausible_unit"), (25000.0, YOUNG, "implausible_unit")],
)
def test_a_bare_number_off_by_a_thousand_is_refused_with_the_likely_unit(value, purpose, code):
    with raises_code(code):
        read_number(value, purpose)


@pytest.mark.parametrize("text", ["5 furlongs", "five", "", "5N5"])
def test_what_is_no_number_of_the_kind_is_refused_in_one_line(text):
    with pytest.raises(InputError) as caught:
        read_number(text, FORCE)
    assert "\n" not in str(caught.value) and "force in N" in str(caught.value)


def test_lists_and_sizes_are_read_however_they_are_given():
    assert read_numbers("0.01m/s,250", VELOCITY) == (10.0, 250.0)
    assert read_numbers([5, "10"], FORCE) == (5.0, 10.0) and read_numbers(5.0, FORCE) == (5.0,)
    assert read_size("40x50", "pad") == read_size((40, 50), "pad") == (40.0, 50.0)
    with raises_code("malformed", "pad"):
        read_size("40", "pad")
