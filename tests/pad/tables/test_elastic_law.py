"""Pads of another elastic law: the tabulated factor against solves of proportions and exponents that are not in it."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.quantity import Quantity
from dummydesign.geometry.shape_registry import make_shape
from dummydesign.geometry.shapes.crowned import Crowned
from dummydesign.pad.force_source import elastic_curve
from dummydesign.pad.material.hyperelastic import Yeoh
from dummydesign.pad.pad_under_punch import Pad
from dummydesign.pad.tables.elastic_law import elastic_factor, load_elastic_table, mean_drop_mm, ogden_law
from tests.support.refusal import raises_code

DEPTH = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
# a / h = 7.9 / 15, solved by finite elements apart from the table
SOLVED = {
    1.8: (66.363171, 137.395451, 212.698937, 291.224539, 373.871841, 464.433947),
    2.0: (66.189396, 137.365604, 213.856874, 296.159679, 386.622477, 491.303833),
    3.5: (65.328635, 138.365818, 226.949705, 342.996579, 509.990660, 782.862516),
}


@pytest.mark.parametrize("alpha", [1.8, 3.5])
def test_the_factor_is_that_of_solved_slabs_within_its_error(alpha):
    factor, error = load_elastic_table().factor(alpha, DEPTH, 7.9 / 15.0)
    off = np.abs(factor / (np.array(SOLVED[alpha]) / SOLVED[2.0]) - 1.0)
    assert np.all(off[DEPTH <= 0.4] < 0.006) and np.all(off <= error + 0.003)


# thickness; radius, height and foot of crowns that are not in the table: F(3.5) / F(2) at d / h of 0.1 to 0.4, solved
CROWNS = {
    (13.9, (7.7, 3.6, 9.6)): (0.97665, 0.9718, 0.97641, 1.03032),
    (5.7, (3.6, 2.7, 9.4)): (0.97824, 0.97567, 0.99141, 1.09223),
    (8.6, (1.7, 3.7, 8.7)): (0.9756, 0.97136, 0.97891, 1.00822),
}


@pytest.mark.parametrize(("thickness", "size"), CROWNS)
def test_the_factor_is_that_of_solved_crowns_within_its_error(thickness, size):
    shape, solved = make_shape("crowned", list(zip(("radius", "height", "foot"), size))), CROWNS[thickness, size]
    drop, known = mean_drop_mm(shape, 7.9), Quantity(3.5, 3.5, 3.5, "fitted", "t")
    factor, error = elastic_factor(thickness * DEPTH[:4], thickness, 7.9, known, "crowned", drop)
    off = np.abs(factor / solved - 1.0)
    assert np.all(off <= error) and np.all(off[:2] < 0.012) and off[2] < 0.04


def test_neo_hookean_has_no_factor_and_an_unknown_shape_has_it_in_its_error():
    table = load_elastic_table()
    assert table.factor(2.0, DEPTH, 0.8)[0] == pytest.approx(1.0) and not table.factor(2.0, DEPTH, 0.8)[1].any()
    slab, other = table.factor(4.0, DEPTH, 0.8), table.factor(4.0, DEPTH, 0.8, "bumped")
    assert np.all(other[0] == 1.0) and np.all(other[1] >= np.abs(slab[0] - 1.0))


def test_what_is_not_known_of_the_exponent_is_in_the_error():
    at = 4.0, 10.0, 7.9
    exact, wide = (
        elastic_factor(*at, Quantity(3.0, low, high, "fitted", "t")) for low, high in ((3.0, 3.0), (2.5, 3.5))
    )
    assert wide[0] == exact[0] and wide[1] > exact[1] + 0.03


def test_the_mean_drop_of_a_paraboloid_is_half_that_at_the_rim():
    shape = Crowned(1000.0, 0.05)
    assert mean_drop_mm(shape, 8.0) == pytest.approx(0.5 * 8.0**2 / 2000.0, rel=1e-3)


def test_predict_by_the_table_takes_one_ogden_term_and_no_other_law():
    slab = Pad(10.0, 0.04, 7.9)
    plain, stiff = (elastic_curve(one, "table") for one in (slab, Pad(10.0, 0.04, 7.9, law=ogden_law(3.5))))
    depth = np.array([0.5, 4.0])
    ratio = stiff.force(depth) / plain.force(depth)
    assert ratio[0] == pytest.approx(1.0, abs=0.02) and ratio[1] > 1.1
    with raises_code("not_tabulated", "law"):
        elastic_curve(Pad(10.0, 0.04, 7.9, law=Yeoh(1.0, 0.02)), "table")
