"""Declared plates: what is read, how a friction is weighed, how much narrower the modulus becomes."""

from __future__ import annotations

import math

import pytest

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.pad.tables.puck import friction_of, grip, load_puck_table
from dummydesign.resin.puck_test.loading_fit import GRIPS, contradicts, fit_pucks
from dummydesign.resin.puck_test.plates import LUBRICATED, OPEN, read_plates
from tests.resin.puck_test.test_loading_fit import WINDOW, made
from tests.support.refusal import raises_code


def test_a_declaration_is_read_and_a_wrong_one_refused():
    assert read_plates(None) is OPEN and not OPEN
    assert read_plates("Bonded").friction.value == math.inf
    assert read_plates("0.1").friction.value == 0.1 and read_plates(0.1).name == "0.1"
    for text, code in (("greasy", "unknown_name"), ("-0.1", "out_of_range"), ("7", "out_of_range")):
        with raises_code(code, "friction"):
            read_plates(text)


def test_the_ends_of_the_declared_interval_are_two_standard_deviations_away():
    plates = read_plates(LUBRICATED)
    quantity = plates.friction
    for end in (quantity.low, quantity.high):
        assert plates.surprise(float(grip(end))) == pytest.approx(HALF_WIDTH**2, rel=1e-9)
    assert plates.surprise(float(grip(quantity.value))) == pytest.approx(0.0, abs=1e-12)
    grips = plates.grips(GRIPS)
    assert [friction_of(grips[end]) for end in (0, -1)] == pytest.approx([quantity.low, quantity.high])
    assert read_plates("bonded").grips(GRIPS).tolist() == [1.0] and OPEN.grips(GRIPS) is GRIPS
    assert OPEN.surprise(0.3) == read_plates("bonded").surprise(1.0) == 0.0


def half(fit):
    return 0.5 * math.log(fit.young_high_kPa / fit.young_low_kPa)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plates", "declared"), [("friction:0.05", "lubricated"), ("bonded", "bonded"), ("friction:0.12", "0.12")]
)
def test_declared_plates_narrow_the_modulus_and_hold_the_truth(plates, declared):
    curves, table = made(30.0, 2.0, plates, [("A1", 0.1, 1.0)]), load_puck_table()
    free = fit_pucks(curves, 50.0, 30.0, table, WINDOW)
    fit = fit_pucks(curves, 50.0, 30.0, table, WINDOW, read_plates(declared))
    assert fit.young_low_kPa < 30.0 < fit.young_high_kPa and free.young_low_kPa < 30.0 < free.young_high_kPa
    assert half(fit) < 0.65 * half(free)
    assert not contradicts(fit.rmse, fit.rmse_open)


@pytest.mark.slow
def test_plates_declared_against_the_curve_are_doubted():
    curves, table = made(30.0, 2.0, "bonded", [("A1", 0.1, 1.0)]), load_puck_table()
    wrong = fit_pucks(curves, 50.0, 30.0, table, WINDOW, read_plates("lubricated"))
    assert contradicts(wrong.rmse, wrong.rmse_open)
    assert fit_pucks(curves, 50.0, 30.0, table, WINDOW).friction > 0.3
