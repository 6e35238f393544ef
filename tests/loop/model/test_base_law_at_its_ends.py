"""Base laws inside and beyond what they know: pucks in closed form, slabs by their tables, fillets and corners."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.data.trials import memoised_law
from dummydesign.loop.effects.registry import effect_named
from dummydesign.loop.model.base_law import EDGES, PuckLaw, SlabLaw, square_over_circle
from dummydesign.loop.model.effect import Arm, Parameter, root_law, wrap
from dummydesign.loop.model.forward_model import BaseParameters, arm_forces, loaded, parameter_names, relax
from dummydesign.pad.tables.filleted import load_filleted
from dummydesign.pad.tables.slab import load_compressibility, load_table
from dummydesign.pad.tables.square import load_square

RADIUS = 7.9
LAW = SlabLaw(load_table("bonded"), RADIUS, False)
H = np.array([[5.0], [8.0], [14.0]])
DEPTH = H * np.array([[0.05, 0.2, 0.35]])


def test_a_puck_is_neo_hookean_between_its_plates_and_finite_however_deep():
    law, share = PuckLaw(30.0), np.array([[0.0, 0.1, 0.3, 0.6]])
    stretch = 1.0 - share
    area = np.pi * 15.0**2
    np.testing.assert_allclose(law(10.0 * share, np.array([[10.0]])), area * (stretch**-2 - stretch) / 3.0)
    # of small strains the modulus times area over height
    small = law(np.array([[1e-6]]), np.array([[10.0]]))[0, 0]
    assert small == pytest.approx(area * 1e-7, rel=1e-5)
    deep = law(np.linspace(0.0, 20.0, 401)[None], np.array([[10.0]]))[0]
    assert np.isfinite(deep).all() and np.all(np.diff(deep) >= 0.0) and deep[-1] == deep[200]
    assert law.limit(np.array([10.0, 20.0])) == pytest.approx([8.0, 16.0])


def test_a_slab_is_its_table_and_beyond_it_its_last_secant_goes_on():
    table = load_table("bonded")
    for row, h in zip(LAW(DEPTH, H), H[:, 0]):
        np.testing.assert_allclose(row, table.force(DEPTH[H[:, 0] == h][0], h, 1.0, RADIUS), rtol=1e-9)
    limit = LAW.limit(H[:, 0])
    np.testing.assert_allclose(limit, table.depth_limit_mm(H[:, 0], RADIUS))
    last = LAW(limit[:, None], H)
    np.testing.assert_allclose(LAW(1.3 * limit[:, None], H), 1.3 * last, rtol=1e-6)
    assert not LAW(-DEPTH, H).any()
    # thicknesses outside the table are held at its ends
    low, high = table.ratio_range
    for ratio in (low, high):
        end, beyond = RADIUS / ratio, RADIUS / ratio * (1.2 if ratio == low else 0.8)
        share = 0.1
        force = [LAW(np.array([[share * h]]), np.array([[h]]))[0, 0] / (share * h) for h in (end, beyond)]
        assert force[1] == pytest.approx(force[0], rel=1e-9)


def test_a_base_that_slides_and_a_bulk_that_gives_are_those_of_their_tables():
    np.testing.assert_allclose(LAW.sliding()(DEPTH, H), SlabLaw(load_table("sliding"), RADIUS, False)(DEPTH, H))
    bulk = LAW.compressibility_coefficient(DEPTH, H)
    np.testing.assert_allclose(bulk, load_compressibility().coefficient(DEPTH / H, RADIUS / H))


def test_a_square_is_the_circle_times_its_own_factor():
    square = SlabLaw(load_table("bonded"), RADIUS, True)
    factor = square(DEPTH, H) / LAW(DEPTH, H)
    np.testing.assert_allclose(factor, square_over_circle(DEPTH, H, RADIUS), rtol=1e-9)
    for row, h, depth in zip(factor, H[:, 0], DEPTH):
        np.testing.assert_allclose(row, load_square("bonded").factor(depth / h, RADIUS / h)[0], rtol=2e-4)
    np.testing.assert_array_equal(square_over_circle(-DEPTH, H, RADIUS), square_over_circle(0.0 * DEPTH, H, RADIUS))
    deepest = square_over_circle(0.9 * H, H, RADIUS)
    np.testing.assert_allclose(deepest, square_over_circle(0.6 * H, H, RADIUS))


@pytest.mark.parametrize("place", [1, 2, -1])
def test_a_fillet_softens_as_its_table_says_and_none_not_at_all(place):
    np.testing.assert_allclose(LAW.edge_factor(0.0, DEPTH, H), 1.0, atol=1e-12)
    found = LAW.edge_factor(EDGES[place] * RADIUS, DEPTH, H)
    sharp, filleted = load_table("bonded"), load_filleted("bonded", EDGES[place])
    for row, h, depth in zip(found, H[:, 0], DEPTH):
        rounded, plain = (table.log_stiffness(depth / h, RADIUS / h)[0] for table in (filleted, sharp))
        np.testing.assert_allclose(row, np.exp(rounded - plain), rtol=2e-3)
    np.testing.assert_allclose(LAW.edge_factor(9.0 * RADIUS, DEPTH, H), LAW.edge_factor(EDGES[-1] * RADIUS, DEPTH, H))
    between = LAW.edge_factor(0.5 * (EDGES[0] + EDGES[1]) * RADIUS, DEPTH, H)
    # at small depth a fillet takes away, the more the larger it is
    assert np.all(between[:, 0] < 1.0)
    assert np.all(between[:, 0] > LAW.edge_factor(EDGES[1] * RADIUS, DEPTH, H)[:, 0])


def test_the_law_below_all_that_is_wrapped_is_found():
    changed = wrap(wrap(LAW, lambda d, h: LAW(d, h)), lambda d, h: LAW(d, h))
    assert root_law(changed) is LAW and root_law(LAW) is LAW
    assert root_law(memoised_law(changed)) is LAW


def test_arms_are_convolutions_and_add_to_the_elastic_force():
    """A ramp held: an arm rises as tau (1 - exp(-t / tau)) and falls as exp."""
    time = np.array([np.r_[np.linspace(0.0, 1.0, 7), 1.3, 2.0, 4.0]])
    elastic = 3.0 * np.minimum(time, 1.0)
    for tau in (0.1, 0.7):
        (held,) = arm_forces(time, elastic[None], [Arm(tau, 0.5)])[:, 0]
        rise = 3.0 * tau * -np.expm1(-np.minimum(time, 1.0) / tau) * np.exp(-np.maximum(time - 1.0, 0.0) / tau)
        np.testing.assert_allclose(held, rise, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(relax(time, elastic, [Arm(tau, 0.5)]), elastic + 0.5 * rise, rtol=1e-9)
    two = [Arm(0.1, 0.5), Arm(0.7, 0.2)]
    both = loaded(elastic, two, arm_forces(time, elastic[None], two)[:, 0])
    np.testing.assert_allclose(both, sum(relax(time, elastic, [one]) for one in two) - elastic)
    # a weight scales what is loaded, by its mean over each step
    weight = 1.0 + time
    (held,) = arm_forces(time, elastic[None], [Arm(1e9, 1.0, weight)])[:, 0]
    middle = 0.5 * (weight[:, 1:] + weight[:, :-1])
    np.testing.assert_allclose(held[0, 1:], np.cumsum(np.diff(elastic) * middle), rtol=1e-6)
    # what is there at the first sample has been loaded at once
    (start,) = arm_forces(time, elastic[None] + 2.0, [Arm(0.7, 1.0)])[:, 0]
    assert start[0, 0] == pytest.approx(2.0)


def test_base_parameters_are_their_logarithms_and_named_in_kilopascal():
    base = BaseParameters(0.03, (0.05, 1.2), (0.3, 0.2))
    np.testing.assert_allclose(np.exp(base.to_logs()), [0.03, 0.05, 0.3, 1.2, 0.2])
    again = BaseParameters.from_logs(base.to_logs())
    assert again.tau_s == pytest.approx(base.tau_s) and again.beta == pytest.approx(base.beta)
    assert base.to_dict()["young_kPa"] == pytest.approx(30.0) and base.to_dict()["tau_2_s"] == pytest.approx(1.2)
    names = parameter_names(2, [effect_named("temperature")])
    assert names[:5] == ["log young_kPa", "log tau_1_s", "log beta_1", "log tau_2_s", "log beta_2"] and len(names) > 5


def test_a_parameter_is_a_number_of_order_one_within_its_bounds():
    linear, log = Parameter("a", "1", 1.0, 0.0, 3.0, 0.5), Parameter("b", "s", 2.0, 0.5, 8.0, 2.0, log=True)
    for one in (linear, log):
        for value in (0.7, 2.5):
            assert one.to_value(one.to_coordinate(value)) == pytest.approx(value)
        assert one.to_value(99.0) == one.high and one.to_value(-99.0) == one.low
    assert linear.to_coordinate(1.5) == pytest.approx(1.0) and log.to_coordinate(2.0 * np.e) == pytest.approx(1.0)
    assert not linear.of_form and Parameter("c", "1", 0.0, -1.0, 1.0, 1.0, spread=0.5).of_form
