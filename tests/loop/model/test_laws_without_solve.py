"""Laws that need no solve are the pad model's, inside and beyond what it knows; parts of the forward model."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.loop.data.trials import memoised_law
from dummydesign.loop.model.effect import Arm, Parameter, root_law, wrap
from dummydesign.loop.model.forward_model import BaseParameters, arm_forces, loaded, parameter_names, relax
from dummydesign.pad.force_source import curve_without_solve, elastic_curve
from dummydesign.pad.material.hyperelastic import Ogden
from dummydesign.pad.pad_under_punch import Pad, Puck
from dummydesign.pad.tables import square
from dummydesign.pad.tables.slab import FILLETS, load_compressibility, load_filleted, load_table
from tests.support.known_laws import puck_law, slab_law
from tests.support.named_effects import effect_named
from tests.support.refusal import raises_code

RADIUS = 7.9
LAW = slab_law(RADIUS)
H = np.array([[5.0], [8.0], [14.0]])
DEPTH = H * np.array([[0.05, 0.2, 0.35]])


def test_a_puck_is_neo_hookean_between_its_plates_and_finite_however_deep():
    law, share = puck_law(30.0), np.array([[0.0, 0.1, 0.3, 0.6]])
    stretch = 1.0 - share
    area = np.pi * 15.0**2
    np.testing.assert_allclose(law(10.0 * share, np.array([[10.0]])), area * (stretch**-2 - stretch) / 3.0, rtol=1e-5)
    # of small strains the modulus times area over height
    small = law(np.array([[1e-6]]), np.array([[10.0]]))[0, 0]
    assert small == pytest.approx(area * 1e-7, rel=1e-4)
    deep = law(np.linspace(0.0, 20.0, 401)[None], np.array([[10.0]]))[0]
    assert np.isfinite(deep).all() and np.all(np.diff(deep) >= 0.0)
    assert [law.law_of(("", h)).limit_mm for h in (10.0, 20.0)] == pytest.approx([8.0, 16.0])


def test_a_puck_of_another_elastic_law_has_its_closed_form_and_one_that_rubs_has_none():
    share = np.array([0.05, 0.3, 0.5])
    for alpha in (1.5, 4.0):
        law = Ogden([2.0 / alpha], [alpha])
        curve = curve_without_solve(Puck(12.0, 0.05, 30.0, law=law))
        stress = 2.0 / (3.0 * alpha) * ((1.0 - share) ** (-0.5 * alpha - 1.0) - (1.0 - share) ** (alpha - 1.0))
        np.testing.assert_allclose(curve.force(12.0 * share), 0.05 * np.pi * 225.0 * stress, rtol=1e-12)
    for other in (Puck(12.0, 0.05, 30.0, plates="bonded"), Puck(12.0, 0.05, 30.0, poisson=0.49)):
        assert curve_without_solve(other) is None
    for other in (Pad(10.0, 1.0, 7.9, condition="frictionless"), Pad(10.0, 1.0, 7.9, base="friction:0.3")):
        assert curve_without_solve(other) is None
    assert curve_without_solve(Pad(40.0, 1.0, 7.9)) is None


@pytest.mark.parametrize("edge_mm", [0.0, 0.6])
@pytest.mark.parametrize("base", ["bonded", "sliding"])
@pytest.mark.parametrize("is_square", [False, True])
def test_the_force_of_a_slab_is_that_of_the_pad_model(base, is_square, edge_mm):
    """Pressed, new and changed thicknesses; square factor and fillet are the pad model's too."""
    law, side = slab_law(RADIUS, is_square, base, edge_mm), np.sqrt(np.pi) * RADIUS
    for h in (4.0, 10.0, 10.7, 21.0):
        sides = (side, side) if is_square else None
        curve = elastic_curve(Pad(h, 0.03, RADIUS, base=base, sides_mm=sides, edge_radius_mm=edge_mm), "table")
        depth = np.linspace(0.003, 1.0, 230) * curve.limit_mm
        error = 0.03 * law(depth[None], np.array([[h]]))[0] / curve.force(depth) - 1.0
        # the contact rolls on to a fillet by the root of the depth, which a straight line follows less well at first
        begins = depth < (0.02 * h if edge_mm else 0.0)
        assert np.abs(error[~begins]).max() < 1e-5 and np.abs(error[begins]).max(initial=0.0) < 1e-3
        assert law.law_of(("", h)).limit_mm == curve.limit_mm


def test_a_slab_beyond_its_table_goes_on_with_its_last_secant():
    table = load_table("bonded")
    for row, h in zip(LAW(DEPTH, H), H[:, 0]):
        np.testing.assert_allclose(row, table.force(DEPTH[H[:, 0] == h][0], h, 1.0, RADIUS), rtol=1e-6)
    limit = table.depth_limit_mm(H, RADIUS)
    np.testing.assert_allclose(LAW(1.3 * limit, H), 1.3 * LAW(limit, H), rtol=1e-6)
    assert not LAW(-DEPTH, H).any()
    # thicknesses outside the table are held at its ends
    for ratio in table.ratio_range:
        end = RADIUS / ratio
        beyond = end * (1.2 if ratio == table.ratio_range[0] else 0.8)
        at, out = (LAW(np.array([[0.5]]), np.array([[h]]))[0, 0] for h in (end, beyond))
        assert out == pytest.approx(at, rel=1e-6)


def test_a_base_that_slides_and_a_bulk_that_gives_are_those_of_their_tables():
    np.testing.assert_allclose(LAW.sliding()(DEPTH, H), slab_law(RADIUS, base="sliding")(DEPTH, H), rtol=1e-5)
    bulk = LAW.compressibility_coefficient(DEPTH, H)
    np.testing.assert_allclose(bulk, load_compressibility().coefficient(DEPTH / H, RADIUS / H), rtol=1e-4)


@pytest.mark.parametrize("base", ["bonded", "sliding"])
def test_the_square_punch_has_the_factor_of_the_base_it_presses_on(base):
    bonded = slab_law(RADIUS, square=True)
    law = bonded if base == "bonded" else bonded.sliding()
    factor, _ = square.square_factor(DEPTH, H, RADIUS, base)
    np.testing.assert_allclose(law(DEPTH, H), factor * load_table(base).force(DEPTH, H, 1.0, RADIUS), rtol=1e-5)


def test_a_missing_table_of_square_factors_is_an_error_and_not_another_number(monkeypatch, tmp_path):
    law = slab_law(RADIUS, square=True)
    monkeypatch.setattr("dummydesign.core.user_library.data_folder", lambda: tmp_path)
    square.load_square.cache_clear()
    with raises_code("table_unavailable", "table"):
        law(DEPTH, H + 0.0123)


@pytest.mark.parametrize("is_square", [False, True])
@pytest.mark.parametrize("place", [0, 1, -1])
def test_a_fillet_softens_as_its_table_says_and_none_not_at_all(place, is_square):
    law, fillet = slab_law(RADIUS, is_square), float(FILLETS[place])
    np.testing.assert_allclose(law.edge_factor(0.0, DEPTH, H), 1.0, atol=1e-12)
    found = law.edge_factor(fillet * RADIUS, DEPTH, H)
    sharp, filleted = load_table("bonded"), load_filleted("bonded", fillet)
    for row, h, depth in zip(found, H[:, 0], DEPTH):
        rounded, plain = (table.log(depth / h, RADIUS / h) for table in (filleted, sharp))
        np.testing.assert_allclose(row, np.exp(rounded - plain), rtol=1e-5)
    largest = float(FILLETS[-1]) * RADIUS
    np.testing.assert_allclose(law.edge_factor(9.0 * RADIUS, DEPTH, H), law.edge_factor(largest, DEPTH, H))
    between = law.edge_factor(0.5 * FILLETS[0] * RADIUS, DEPTH, H)
    # at small depth a fillet takes away, the more the larger it is
    assert np.all(between[:, 0] < 1.0)
    assert np.all(between[:, 0] > law.edge_factor(FILLETS[0] * RADIUS, DEPTH, H)[:, 0])


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
