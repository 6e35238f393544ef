"""Windows of moduli against closed forms: pads that are a power of the depth, relaxation by one arm."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.design.scoring.castings import Castings
from dummydesign.design.scoring.press_simulation import Sampling, SlabCurves
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.windows import (
    REACH,
    Batches,
    coarse_ranges,
    excess,
    unlike,
    windows_of,
)
from dummydesign.resin import load_resin
from tests.support.slab_by_formula import make_tissue

SAMPLING = Sampling()
LIMIT_MM, SAMPLES, SIZE = 8.0, 4801, 20.0
TAU_S = 1.0
LOG_YOUNG = float(np.log(0.04))
WIDE = {"stands_shortfall": 1.58, "stands_over": 1.1, "shortfall": 1.65, "over": 1.25}


@pytest.fixture(scope="module")
def targets():
    """Subjects who are far apart, judged by wide limits, so that pads without relaxation have a window."""
    made = make_targets(make_tissue((0.5, 0.8, 1.3)), "average", SAMPLING)
    return replace(made, limits=replace(made.limits, **WIDE))


def curves(power=3.0, size=SIZE, limit_mm=LIMIT_MM):
    """F / E = size d^power. [mm2]"""
    depth = limit_mm * np.linspace(0.0, 1.0, SAMPLES)
    return SlabCurves(np.array([12.0]), np.array([limit_mm]), size * depth[None] ** power)


def batches(*beta, softness=0.0, reference=LOG_YOUNG):
    """Batches of one arm with strengths at a modulus of reference, that fall with the modulus by a power."""
    count = len(beta)
    draws = SimpleNamespace(
        resin=SimpleNamespace(tau_s=(TAU_S,), pressed_force=None),
        beta_ref=np.array(beta)[:, None],
        softness_exponent=np.full(count, softness),
    )
    return Batches(draws, np.array([15.0]), np.zeros((count, 1)), np.full(count, reference))


def excess_by_hand(log_young, targets, power, size, limits):
    """ln of the largest reading of an elastic pad over its limit: peaks, energies f d / (p + 1), steady forces."""
    ranges = coarse_ranges(targets)
    young = np.exp(log_young)[:, None]
    depth = (ranges.force_N / (young * size)) ** (1.0 / power)
    steady = (ranges.steady_N / (young * size)) ** (1.0 / power)
    energy = ranges.force_N * depth / (power + 1.0)
    short = [
        ranges.peak_low_N / ranges.force_N + 0.0 * depth,
        (steady / ranges.soft_mm) ** ranges.power,
        ranges.energy_low_mJ / energy,
    ]
    over = [
        ranges.force_N / ranges.peak_high_N + 0.0 * depth,
        (ranges.stiff_mm / steady) ** ranges.power,
        energy / ranges.energy_high_mJ,
    ]
    low, high = (np.concatenate(one, axis=1).max(axis=1) for one in (short, over))
    return np.maximum(np.log(low / limits[0]), np.log(high / limits[1]))


def ends(grid, inside):
    assert inside.any() and not inside.all()
    return grid[inside][0], grid[inside][-1]


@pytest.mark.parametrize("power", [2.5, 3.0, 3.4])
def test_the_window_of_an_elastic_pad_is_the_one_in_closed_form(targets, power):
    size = SIZE * 2.0 ** (3.0 - power)
    limits, young = targets.limits, np.linspace(np.log(0.005), np.log(0.3), 4001)
    good = young[excess_by_hand(young, targets, power, size, (limits.shortfall, limits.over)) <= 0.0]
    assert good[-1] - good[0] < 1.9 * REACH
    centre = np.array([0.5 * (good[0] + good[-1])])
    found = windows_of(curves(power, size), centre, batches(0.0), targets, SAMPLING, 40)
    grid = found.log_young[0]
    step = grid[1] - grid[0]
    for beyond, pair in (
        (found.beyond_usable, (limits.shortfall, limits.over)),
        (found.beyond_stands, (limits.stands_shortfall, limits.stands_over)),
    ):
        wanted = excess_by_hand(grid, targets, power, size, pair)
        known = np.abs(grid - centre) <= REACH
        # straight between nodes: exact but for the cells that hold a kink
        away = np.abs(beyond[0, 0][known] - wanted[known])
        assert away.max() < 0.08 and np.quantile(away, 0.8) < 2e-3
        inside = wanted <= 0.0
        if inside.any():
            np.testing.assert_allclose(ends(grid, beyond[0, 0] <= 0.0), ends(grid, inside), atol=2 * step)
    assert found.usable.any()


def test_the_least_modulus_carries_the_largest_force_at_the_limit_of_depth(targets):
    limit = 3.2
    found = windows_of(curves(limit_mm=limit), np.array([np.log(0.02)]), batches(0.0, 0.5), targets, SAMPLING, 20)
    least = np.log(15.0 / (SIZE * limit**3))
    grid, reached = found.log_young[0], np.isfinite(found.beyond_usable[0])
    step = grid[1] - grid[0]
    assert grid[0] < least < grid[-1]
    # an arm of 1 s has died out after 10 s: it carries nothing
    for row in reached:
        assert grid[row][0] == pytest.approx(least, abs=1.01 * step)


def test_an_arm_that_is_still_there_at_the_end_of_the_hold_helps_to_reach_the_force(targets):
    short = replace(targets, sampling=Sampling(hold_s=1.0))
    held, limit = Sampling(hold_s=1.0), 3.2
    found = windows_of(curves(limit_mm=limit), np.array([np.log(0.02)]), batches(0.0, 0.6), short, held, 20)
    grid = found.log_young[0]
    bare, helped = (grid[np.isfinite(row)][0] for row in found.beyond_usable[0])
    rise = limit / (10.0 * TAU_S)
    left = np.exp(-1.0 / TAU_S) * (1.0 - np.exp(-rise)) / rise
    assert bare - helped == pytest.approx(np.log1p(0.6 * left), abs=2.1 * (grid[1] - grid[0]))


def test_a_batch_that_relaxes_too_much_has_its_window_where_it_is_stiff(targets):
    """beta falls as E^-s: peaks are too high below the modulus at which beta is what the limit allows"""
    softness, strengths = 0.8, (1.6, 2.2, 3.0)
    tight = replace(targets, limits=replace(targets.limits, over=1.8, shortfall=2.9, stands_over=1.3))
    centre = np.array([np.log(0.04)])
    drawn = batches(*strengths, softness=softness)
    found = windows_of(curves(), centre, drawn, tight, SAMPLING, 60)
    ranges = coarse_ranges(tight)
    # the least room above a press decides; in the fast ones the arm of 1 s has not relaxed yet
    room = np.log(1.8 * ranges.peak_high_N / ranges.force_N)
    wanted = []
    for beta in strengths:
        by_press = []
        for force, speed, ln_room in zip(ranges.force_N, ranges.velocity_mm_s, room):
            young = np.linspace(centre[0] - 2.0, centre[0] + 2.0, 20001)
            time = (force / (np.exp(young) * SIZE)) ** (1.0 / 3.0) / speed / TAU_S
            # cubic rise at constant rate: integral of 3 u^2 exp(-(1 - u) time) over the rise
            left = 3.0 / time * (1.0 - 2.0 / time + 2.0 / time**2 * (1.0 - np.exp(-time)))
            peak = np.log1p(beta * np.exp(-softness * (young - np.log(0.04))) * left)
            by_press.append(young[np.argmax(peak <= ln_room)])
        wanted.append(max(by_press))
    grid = found.log_young[0]
    lower = [grid[row][0] for row in found.usable[0] if row.any()]
    assert len(lower) >= 2, (wanted, found.beyond_usable[0, :, ::20])
    np.testing.assert_allclose(lower, wanted[: len(lower)], atol=0.03)


@pytest.mark.parametrize("factor", [0.2, 3.0])
def test_a_pad_of_another_unit_of_modulus_has_the_same_window(targets, factor):
    by = np.log(factor)
    centre = np.array([np.log(0.04)])
    first = windows_of(curves(), centre, batches(0.4, 1.0, softness=0.5), targets, SAMPLING, 12)
    again = windows_of(
        curves(size=SIZE / factor),
        centre + by,
        batches(0.4, 1.0, softness=0.5, reference=np.log(0.04) + by),
        targets,
        SAMPLING,
        12,
    )
    np.testing.assert_allclose(again.log_young, first.log_young + by, rtol=1e-12)
    for one, other in ((again.beyond_usable, first.beyond_usable), (again.beyond_stands, first.beyond_stands)):
        both = np.isfinite(one) & np.isfinite(other)
        assert both.mean() > 0.7 and (np.isfinite(one) == np.isfinite(other)).mean() > 0.98
        np.testing.assert_allclose(one[both], other[both], atol=1e-7)


def test_pads_and_batches_side_by_side_have_the_windows_of_one_after_the_other(targets):
    area = np.concatenate([curves().area_mm2, curves(2.6, 30.0, 6.0).area_mm2])
    both = SlabCurves(np.array([12.0, 9.0]), np.array([8.0, 6.0]), area)
    centre, drawn = np.log([0.04, 0.03]), batches(0.0, 0.4, 0.9, softness=0.6)
    every = windows_of(both, centre, drawn, targets, SAMPLING, 8)
    for pad in range(2):
        alone = windows_of(both.take(np.array([pad])), centre[[pad]], drawn, targets, SAMPLING, 8)
        np.testing.assert_allclose(every.take(slice(pad, pad + 1)).beyond_usable, alone.beyond_usable, atol=1e-9)


def test_strengths_of_a_batch_are_those_it_has_at_a_ratio():
    resin = load_resin()
    draws, ratio = Castings(resin).batches, resin.ratios()[::9]
    found = Batches.of(draws, ratio, 40)
    assert len(found) == 40 and found.log_young.shape == (40, len(ratio))
    strengths = found.strengths(found.log_young)
    for column, value in enumerate(ratio):
        wanted = draws.beta(np.full(len(draws.beta_ref), value))[:40]
        np.testing.assert_allclose(strengths[:, column], wanted, rtol=1e-9)
        np.testing.assert_allclose(found.log_young[:, column], np.log(np.maximum(draws.young_MPa(value)[:40], 1e-7)))


def test_a_few_batches_stand_for_all_by_how_much_they_relax():
    resin = load_resin()
    every = Batches.of(Castings(resin).batches, np.array([15.0, 16.0]), 1200)
    few = unlike(every, 6)
    total, kept = (one.draws.beta_ref.sum(axis=-1) for one in (every, few))
    places = np.searchsorted(np.sort(total), kept) / 1200.0
    np.testing.assert_allclose(places, (np.arange(6) + 0.5) / 6.0, atol=2e-3)
    rows = [int(np.argmin(np.abs(total - value))) for value in kept]
    np.testing.assert_array_equal(few.log_young, every.log_young[rows])


def test_an_excess_is_the_larger_of_both_sides_and_on_the_safe_side_the_shortfall_alone(targets):
    limits = targets.limits
    chance = np.random.default_rng(32)
    short, over = np.exp(chance.uniform(-0.5, 1.5, (2, 400)))
    free = SimpleNamespace(shortfall=short, over=over, ranges=SimpleNamespace(strict=False))
    stands, usable = excess(free, limits)
    np.testing.assert_array_equal(usable <= 0.0, (short <= limits.shortfall) & (over <= limits.over))
    np.testing.assert_array_equal(stands <= 0.0, (short <= limits.stands_shortfall) & (over <= limits.stands_over))
    strict = excess(SimpleNamespace(shortfall=short, over=over, ranges=SimpleNamespace(strict=True)), limits)
    for one in strict:
        np.testing.assert_allclose(one, np.log(short / limits.stands_shortfall))
