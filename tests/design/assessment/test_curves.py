"""Force over time against people: share of the time, largest miss, rating against the aim."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.design.assessment.curves import PressCurve, largest_miss, match_of_presses, rate_press
from dummydesign.tissue.model.ranges import ForceRange

TIME = np.r_[np.linspace(0.0, 0.1, 51), 0.1 + np.geomspace(1e-3, 10.0, 80)]


def people(low, high, force_N=5.0):
    """Two subjects, at so many times of a curve that rises to twice the steady force and relaxes."""
    curve = force_N * np.where(TIME < 0.1, 20.0 * TIME, 1.0 + np.exp(-(TIME - 0.1) / 0.2))
    curves = np.stack([low * curve, high * curve])
    return ForceRange(force_N, 10.0, TIME, curves[0], curves[1], curves, np.ones(2), np.full(2, 0.1))


def press(factor=1.0, force_N=5.0, share=1.0, **changes):
    band = people(0.9, 1.1, force_N)
    aim = people(1.0, 1.0, force_N)
    middle = aim.curves_N[0]
    curve = PressCurve(
        force_N,
        10.0,
        TIME,
        factor * middle,
        0.1,
        band,
        replace(aim, curves_N=middle[None], stop_s=np.array([0.1])),
        share,
        0.01 * force_N,
    )
    return replace(curve, **changes)


def test_a_press_inside_the_range_has_no_miss_and_that_of_the_aim_is_rated_one():
    assert largest_miss(press()) is None
    assert set(rate_press(press()).to_dict().values()) == {1.0}
    # beside the range by less than a steady force can be set
    assert largest_miss(press(1.1 + 0.004)) is None


@pytest.mark.parametrize("factor, edge", [(1.3, 1.1), (0.7, 0.9)])
def test_the_largest_miss_is_at_the_peak_of_a_press_that_is_too_high_or_low_throughout(factor, edge):
    miss = largest_miss(press(factor))
    assert miss.miss_N == pytest.approx((factor - edge) * 10.0, rel=0.02)
    assert miss.miss_percent == pytest.approx(100.0 * (factor - edge) / edge)
    assert miss.time_after_stop_s == pytest.approx(0.0, abs=3e-3)
    assert miss.size == pytest.approx(abs(miss.miss_N) / 5.0)


@pytest.mark.parametrize("at, sign", [(0.05, -1.0), (0.6, 1.0)])
def test_the_moment_is_counted_from_the_pads_own_stop(at, sign):
    bump = sign * 3.0 * np.exp(-0.5 * ((TIME - at) / 0.01) ** 2)
    plain = press()
    miss = largest_miss(replace(plain, force_N=plain.force_N + bump, stop_s=0.12))
    assert np.sign(miss.miss_N) == sign and miss.time_after_stop_s == pytest.approx(at - 0.12, abs=0.02)


def test_what_the_range_does_not_reach_is_left_out():
    plain = press()
    late = np.where(TIME > 5.0, 20.0, plain.force_N)
    short = replace(
        plain.range, time_s=TIME[TIME < 4.0], low_N=plain.range.low_N[TIME < 4.0], high_N=plain.range.high_N[TIME < 4.0]
    )
    assert largest_miss(replace(plain, force_N=late, range=short)) is None


def test_the_worst_miss_is_the_largest_over_its_steady_force_and_the_share_the_least():
    # 2 N at 15 N are less than 1.5 N at 5 N
    low, high = press(1.1 + 1.5 / 10.0, 5.0, 0.4), press(1.1 + 2.0 / 30.0, 15.0, 0.2)
    match = match_of_presses([[low], [high]])
    assert match.worst.steady_force_N == 5.0 and match.worst.miss_N == pytest.approx(1.5, rel=0.02)
    assert match.inside_fraction_least == 0.2
    assert [row.inside_fraction for row in match.conditions] == [0.4, 0.2]
    assert largest_miss(high).miss_N > match.worst.miss_N


def test_repeats_are_averaged():
    first, second = press(1.0, share=1.0), press(1.3, share=0.5)
    row = match_of_presses([[first, second]]).conditions[0]
    assert row.inside_fraction == 0.75
    assert row.rating.Z == pytest.approx(0.5 * (1.0 + rate_press(second).Z))


def test_the_rating_ends_at_twice_the_time_in_which_the_aim_stops():
    plain = press()
    changed = np.where(TIME > 0.21, 3.0 * plain.force_N, plain.force_N)
    assert rate_press(replace(plain, force_N=changed)).R == 1.0
    changed = np.where(TIME > 0.15, 3.0 * plain.force_N, plain.force_N)
    assert rate_press(replace(plain, force_N=changed)).R < 0.9
