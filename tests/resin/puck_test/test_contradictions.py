"""What a puck contradicts is told by one table of pairs; usual mistakes are refused, honest pucks are not."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.quantity import HALF_WIDTH, Quantity
from dummydesign.resin import load_resin
from dummydesign.resin.model.resin import Point, PuckPoint
from dummydesign.resin.puck_test.contradictions import check_slips, pairs_of, warnings_of
from dummydesign.resin.update.modulus import rebuild

DENSITY = Quantity(1.02, 1.0, 1.04, "assumed", "test")


def puck(ratio, young_kPa, sha256="a", spread=0.04, alpha=None):
    ends = [young_kPa * math.exp(k * HALF_WIDTH * spread) for k in (0.0, -1.0, 1.0)]
    own = PuckPoint(sha256, f"{sha256}.csv", 50.0, 30.0, plates="lubricated", alpha=alpha)
    return Point(ratio, Quantity(*ends, "fitted", sha256), own)


def refused(resin, point):
    try:
        check_slips(pairs_of(resin, point, [], None, DENSITY)[0])
    except InputError as error:
        assert error.code == "implausible_unit"
        return True
    return False


def told(resin, point, presses=(), mass_g=None):
    pairs = pairs_of(resin, point, presses, mass_g, DENSITY)
    return warnings_of(pairs, 2.0)[0]


@pytest.mark.parametrize(
    ("slip", "least"), [(1e-3, 1.0), (0.1, 1.0), (10.0, 1.0), (1.0 / 4.4482, 0.85), (1.0 / 9.80665, 1.0)]
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


def test_presses_and_mass_that_disagree_are_told():
    resin, point = load_resin(), puck(15.5, 42.0)
    assert [one.what for one in told(resin, point, [("fast", 0.05), ("slow", -0.05)])] == ["young_kPa by fast and slow"]
    mass = 1.02 * 0.25 * math.pi * 25.0 * 3.0
    assert told(resin, point, [("fast", 0.01), ("slow", -0.01)], mass) == ()
    (one,) = told(resin, point, (), 0.87 * mass)
    assert one.what.startswith("mass_g") and one.b == pytest.approx(mass)


def test_the_exponents_bound_is_a_warning():
    for alpha, codes in ((6.0, ["exponent_at_bound"]), (3.0, [])):
        assert [one["code"] for one in warnings_of([], alpha)[1]] == codes


def arm_of(tau_s, beta):
    from dummydesign.resin.model.resin import ResinArm

    ends = [beta * math.exp(k * 0.1) for k in (0.0, -1.0, 1.0)]
    return ResinArm(Quantity(tau_s, 0.9 * tau_s, 1.1 * tau_s, "fitted", "p"), Quantity(*ends, "fitted", "p"))


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
