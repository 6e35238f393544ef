"""Declared plates: what is read, how a friction is weighed, how much narrower the modulus becomes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dummydesign.core.quantity import HALF_WIDTH
from dummydesign.pad.tables.puck import friction_of, grip, load_puck_table, uniaxial
from dummydesign.resin.puck_test.loading_fit import GRIPS, fit_pucks
from dummydesign.resin.puck_test.plates import LUBRICATED, OPEN, over_friction, read_plates
from tests.resin.puck_test.test_loading_fit import WINDOW, best_of, made
from tests.support.refusal import raises_code


def test_a_declaration_is_read_and_a_wrong_one_refused():
    assert read_plates(None) is OPEN and OPEN.friction is None
    assert read_plates("Bonded").friction.value == math.inf
    assert read_plates("0.1").friction.value == 0.1 and read_plates(0.1).name == "0.1"
    for text, code in (("greasy", "unknown_name"), ("-0.1", "out_of_range"), ("7", "out_of_range")):
        with raises_code(code, "friction"):
            read_plates(text)


def test_lubricated_plates_have_a_prior_whose_median_and_ends_are_those_of_the_file():
    quantity = read_plates(LUBRICATED).friction
    grips, prior = read_plates(LUBRICATED).nodes(GRIPS)
    frictions = [friction_of(one) for one in grips]
    assert np.interp([HALF_WIDTH**2, 0.0], prior[4:], frictions[4:]) == pytest.approx(
        [quantity.high, quantity.value], rel=0.02
    )
    assert grips.min() < float(grip(quantity.low)) and grips.max() > float(grip(quantity.high))
    assert read_plates("bonded").nodes(GRIPS)[0].tolist() == [1.0] and OPEN.nodes(GRIPS)[0] is GRIPS
    assert not OPEN.nodes(GRIPS)[1].any()


def test_a_flat_likelihood_leaves_the_priors_median_and_interval():
    """Modulus linear in the deviate of the friction: its median is that of the median friction."""
    plates = read_plates(LUBRICATED)
    grips, prior = plates.nodes(GRIPS)
    away = np.sign(np.arange(len(grips)) - 4) * np.sqrt(prior)
    young = np.stack([np.log(30.0) - 0.02 * away, np.full(len(grips), 0.01)])
    strains, none = np.linspace(0.02, 0.3, 30), np.zeros(len(grips))
    known = over_friction(grips, prior, young, np.stack([none + 2.0, none + 0.1]), none, strains)
    assert known.young_kPa.value == pytest.approx(30.0, rel=1e-3)
    half_width = 0.5 * math.log(known.young_kPa.high / known.young_kPa.low)
    assert half_width == pytest.approx(HALF_WIDTH * math.hypot(0.02, 0.01), rel=0.06)
    assert known.friction.value == pytest.approx(plates.friction.value, rel=0.02)
    assert known.friction.low == pytest.approx(plates.friction.low, rel=0.2)
    assert known.friction.high == pytest.approx(plates.friction.high, rel=0.1)


def test_a_misfit_along_the_compression_may_be_all_of_the_exponent():
    """A misfit as large as half a unit of the exponent makes is half a unit of standard deviation."""
    grips, prior = read_plates("0.1").nodes(GRIPS)
    strains, young = np.linspace(0.02, 0.3, 30), np.array([[np.log(30.0)], [0.01]])
    away = np.log(uniaxial(2.6, strains) / uniaxial(2.4, strains)) / 0.2
    misfit, known = 0.5 * np.array([np.std(away)]), np.array([[2.5], [0.02]])
    exact, loose = (over_friction(grips, prior, young, known, one, strains).alpha for one in (0.0 * misfit, misfit))
    assert exact.high - exact.low == pytest.approx(2.0 * HALF_WIDTH * 0.02, rel=0.02)
    assert loose.high - 2.5 == pytest.approx(HALF_WIDTH * 0.5, rel=0.01) and loose.low < 2.0


def half(fit):
    return 0.5 * math.log(fit.known.young_kPa.high / fit.known.young_kPa.low)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("plates", "declared"), [("friction:0.05", "lubricated"), ("bonded", "bonded"), ("friction:0.12", "0.12")]
)
def test_declared_plates_narrow_the_modulus_and_hold_the_truth(plates, declared):
    curves, table = made(30.0, 2.0, plates, [("A1", 0.1, 1.0)]), load_puck_table()
    free = fit_pucks(curves, 50.0, 30.0, table, WINDOW)
    fit = fit_pucks(curves, 50.0, 30.0, table, WINDOW, read_plates(declared))
    for one in (fit.known.young_kPa, free.known.young_kPa):
        assert one.low < 30.0 < one.high
    assert half(fit) < 0.65 * half(free)
    assert not fit.contradicts


@pytest.mark.slow
def test_plates_declared_against_the_curve_are_doubted():
    curves, table = made(30.0, 2.0, "bonded", [("A1", 0.1, 1.0)]), load_puck_table()
    wrong = fit_pucks(curves, 50.0, 30.0, table, WINDOW, read_plates("lubricated"))
    assert wrong.contradicts
    assert best_of(fit_pucks(curves, 50.0, 30.0, table, WINDOW)).grip > float(grip(0.3))
