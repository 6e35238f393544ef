"""What a puck contradicts is told by one table of pairs; usual mistakes are refused, honest pucks are not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.pad.tables.puck import table_for, uniaxial
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import Point, PuckPoint
from dummydesign.resin.puck_test.contradictions import (
    check_slips,
    odd_press,
    other_height,
    pairs_of,
    size_not_weighed,
    warnings_of,
)
from dummydesign.resin.puck_test.loading_fit import LoadingCurve, fit_pucks
from dummydesign.resin.puck_test.plates import read_plates
from dummydesign.resin.update import rebuild


def puck(ratio, young_kPa, sha256="a", spread=0.04, alpha=None):
    ends = [young_kPa * math.exp(k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)]
    own = PuckPoint(sha256, f"{sha256}.csv", 50.0, 30.0, plates="lubricated", alpha=alpha)
    return Point(ratio, Quantity(*ends, "fitted", sha256), own)


def refused(resin, point):
    try:
        check_slips(pairs_of(resin, point))
    except InputError as error:
        assert error.code == "implausible_unit"
        return True
    return False


def told(resin, point, mass_g=None):
    return warnings_of(pairs_of(resin, point, mass_g), 2.0)[0]


@pytest.mark.parametrize(
    ("slip", "least"),
    [
        (1e-3, 1.0),
        pytest.param(0.1, 1.0, marks=pytest.mark.slow),
        (10.0, 1.0),
        (1.0 / 4.4482, 0.85),
        (1.0 / 9.80665, 1.0),
    ],
)
def test_forces_in_another_unit_are_refused_and_right_ones_are_not(slip, least):
    """100 batches drawn from the resin's own intervals; a pound-force is 4.5 standard deviations, not always seen."""
    resin = load_resin()
    rng = np.random.default_rng(41)
    ratios = np.round(rng.uniform(14.8, 16.5, 100), 1)
    moduli = [1e3 * float(resin.draw(1, rng).young_MPa(ratio)[0]) for ratio in ratios]
    wrong = [puck(r, slip * e) for r, e in zip(ratios, moduli)]
    stopped = np.array([refused(resin, one) for one in wrong])
    assert stopped.mean() >= least - 0.05
    assert (stopped | [bool(told(resin, one)) for one in wrong]).mean() >= least
    assert np.mean([refused(resin, puck(r, e)) for r, e in zip(ratios, moduli)]) <= 0.03


def test_a_modulus_beyond_the_resins_interval_that_no_slip_explains_is_told_with_both_numbers():
    resin = load_resin()
    known = resin.modulus_kPa(15.5).value
    (one,) = told(resin, puck(15.5, 2.9 * known))
    assert one.a == pytest.approx(2.9 * known) and one.b == pytest.approx(known)
    assert told(resin, puck(15.5, 1.2 * known)) == ()


def test_two_pucks_of_one_ratio_that_disagree_are_told_in_either_order():
    resin = load_resin()
    first, second = puck(15.5, 42.0, "a"), puck(15.5, 58.0, "b")
    for one, two in ((first, second), (second, first)):
        (said,) = told(rebuild(resin, [one], "mine")[0], two)
        assert {round(said.a), round(said.b)} == {42, 58}
    assert told(rebuild(resin, [first], "mine")[0], puck(15.5, 43.0, "b")) == ()


@pytest.mark.parametrize(("off", "quiet"), [(1.04, True), (1.3, False), (0.25, False)])
def test_a_second_puck_is_judged_by_the_first_where_they_agree_however_far_the_batch_is_from_the_law(off, quiet):
    """A batch 2.9 standard deviations above the law: its second puck was refused as a radius typed for the diameter."""
    resin = load_resin()
    law = resin.modulus_kPa(15.5)
    kPa = law.value * math.exp(2.9 * math.hypot(0.04, math.log(law.high / law.low) / 2.0 / HALF_WIDTH))
    first, second = puck(15.5, kPa, "a"), puck(15.5, off * kPa, "b")
    assert told(resin, first) == () and (off < 1.0 or told(resin, second))
    both = rebuild(resin, [first], "mine")[0]
    assert (told(both, second) == ()) is quiet and not (quiet and refused(both, second))


def test_a_mass_that_disagrees_is_told():
    resin, point = load_resin(), puck(15.5, 42.0)
    mass = resin.property("density_g_per_cm3", 15.5).value * 0.25 * math.pi * 25.0 * 3.0
    assert told(resin, point, mass) == ()
    (one,) = told(resin, point, 0.87 * mass)
    assert one.what.startswith("mass_g") and one.b == pytest.approx(mass)


@pytest.mark.parametrize(
    ("typed_mm", "found"), [pytest.param(25.0, True, marks=pytest.mark.slow), (30.0, False), (33.0, False)]
)
def test_a_height_typed_too_small_is_read_off_the_course_of_the_force(typed_mm, found):
    """Closed form between frictionless plates, 60 kPa, 50 x 30 mm; the pair holds both heights."""
    depth = np.linspace(0.0, 9.0, 80)
    force = 60e-3 * 0.25 * math.pi * 50.0**2 * uniaxial(2.0, depth / 30.0)

    def fitted(height_mm):
        curve, window = LoadingCurve("p", "p", depth, force), (0.03 * height_mm, 9.0)
        return fit_pucks([curve], 50.0, height_mm, table_for(50.0, height_mm), window, read_plates("0"))

    far = [one for one in other_height(fitted(typed_mm), typed_mm, fitted) if one.far]
    assert [(one.a, one.b) for one in far] == ([(25.0, pytest.approx(30.0))] if found else [])


def test_a_size_that_nothing_confirms_is_asked_with_the_mass_it_should_have():
    resin, point = load_resin(), puck(15.5, 42.0)
    density = resin.property("density_g_per_cm3", 15.5).value
    asked, mass = size_not_weighed(42.0, density, point.puck), density * 0.25 * math.pi * 25.0 * 3.0
    assert asked["code"] == "size_not_weighed" and f"{mass:.1f} g" in asked["message"]


@pytest.mark.parametrize("count", [2, *(pytest.param(count, marks=pytest.mark.slow) for count in (3, 4))])
def test_the_press_that_differs_from_the_others_is_one_pair_with_both_numbers(count):
    """Levels drawn with the stated scatter: at most 3 % told by chance, one of 5 % in two of three."""
    rng = np.random.default_rng(count)
    names, scatter = [f"p{k}" for k in range(count)], 0.01**2 * np.eye(count)
    levels = 0.01 * rng.standard_normal((2000, count))
    for off, low, high in ((0.0, 0.0, 0.03), (0.05, 0.66, 1.0), (0.1, 0.99, 1.0)):
        levels[:, 1] += off
        pairs = [odd_press(names, 40.0, one, scatter) for one in levels]
        levels[:, 1] -= off
        far = [one for (one,) in pairs if warnings_of([one], 2.0)[0]]
        assert low <= len(far) / len(pairs) <= high
    assert odd_press(names[:1], 40.0, np.zeros(1), scatter[:1, :1]) == []
    (one,) = odd_press(names, 40.0, np.array([0.0, 0.08, 0.0, 0.0][:count]), scatter)
    assert one.a / one.b == pytest.approx(math.exp(0.08)) or one.b / one.a == pytest.approx(math.exp(0.08))
    assert one.a ** (1 / count) * one.b ** (1 - 1 / count) == pytest.approx(40.0)


def test_the_exponents_bound_is_a_warning_unless_a_mass_confirms_the_size():
    for alpha, codes in ((6.0, ["exponent_at_bound"]), (3.0, [])):
        assert [one["code"] for one in warnings_of([], alpha)[1]] == codes
    resin = load_resin()
    point = puck(15.5, 1e3 * float(resin.young_MPa(15.5)))
    mass_g = resin.property("density_g_per_cm3", 15.5).value * 0.25 * math.pi * 25.0 * 3.0
    for weighed, codes in ((mass_g, []), (1.3 * mass_g, ["contradiction", "exponent_at_bound"])):
        assert [one["code"] for one in warnings_of(pairs_of(resin, point, weighed), 6.0)[1]] == codes
    for wrong in (0.1 * mass_g, 1e-3 * mass_g, 10.0 * mass_g):  # a digit, kilograms, another puck
        with pytest.raises(InputError) as raised:
            check_slips(pairs_of(resin, point, wrong))
        assert (raised.value.code, raised.value.quantity) == ("out_of_range", "mass_g")


def arm_of(tau_s, beta):
    from dummydesign.resin.model.resin import ResinArm

    ends = [beta * math.exp(k * 0.1) for k in (0.0, -1.0, 1.0)]
    return ResinArm(Quantity(tau_s, 0.9 * tau_s, 1.1 * tau_s, "fitted", "p"), Quantity(*ends, "fitted", "p"))


@pytest.mark.slow
def test_the_order_of_pucks_does_not_matter_and_intervals_shrink():
    rng = np.random.default_rng(9)
    alphas = [Quantity(2.8, 2.4, 3.2, "fitted", "a"), Quantity(2.7, 2.2, 3.3, "fitted", "b")]
    points = []
    for sha256, alpha in zip("ab", alphas):
        point = puck(15.5, 42.0 * math.exp(0.02 * rng.standard_normal()), sha256, alpha=alpha)
        arms = (arm_of(0.3 * math.exp(0.1 * rng.standard_normal()), 0.3), arm_of(3.0, 0.1))
        points.append(replace(point, puck=replace(point.puck, seen_s=(0.02, 5.0), arms=arms)))
    base = load_resin()
    both = rebuild(base, points, "mine")[0]
    turns = []
    for order in (points, points[::-1]):
        resin = base
        for point in order:
            resin = rebuild(resin, [*resin.points, point], "mine")[0]
        turns.append(resin.to_dict())
    assert turns[0] == turns[1] == both.to_dict()
    assert both.ogden_alpha is not None and both.ogden_alpha.low > 2.0
    moduli = [one.modulus_kPa(15.5) for one in (rebuild(base, points[:1], "mine")[0], both)]
    widths = [np.log(one.high / one.low) for one in moduli]
    # what both share, friction and law, does not average out
    assert 0.75 * widths[0] < widths[1] < 0.99 * widths[0]
