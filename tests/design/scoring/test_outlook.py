"""Shares of a pad's castings against normal integrals: made-up windows of moduli, lognormal batches."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import norm

from dummydesign.design.scoring.outlook import ABOVE, SLACK, Match, Scatter, _best, outlook_of
from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.windows import Batches, Windows

LIMITS = verdict_limits()
# ends half a step beyond the last usable modulus of the grid
MIDDLE, HALF = np.log(0.037), 0.205
LOW, HIGH = MIDDLE - HALF, MIDDLE + HALF
GRID = MIDDLE + 0.01 * np.arange(-400, 401)
RATIO = np.round(np.arange(13.0, 18.01, 0.05), 2)
SLOPE = 0.9
"""ln E over the ratio."""
COUNT = 401
Z = norm.ppf((np.arange(COUNT) + 0.5) / COUNT)
NO_SHIFT = np.zeros(1)


def log_young(ratio):
    """ln E of the resin's centre; at 15.5 it is the middle of the window."""
    return MIDDLE + SLOPE * (np.asarray(ratio) - 15.5)


def batches(spread, ratio=RATIO, residual=0.0, seed=1):
    """Batches whose moduli scatter by the same factor at every ratio, but for a residual of each ratio of its own."""
    own = residual * np.random.default_rng(seed).standard_normal((len(Z), len(ratio)))
    young = log_young(ratio) + spread * np.random.default_rng(7).permutation(Z)[:, None] + own
    return Batches(SimpleNamespace(), ratio, young, np.zeros(len(Z)))


def centre(ratio=RATIO):
    return Batches(SimpleNamespace(), ratio, log_young(ratio)[None], np.zeros(1))


def windows(count, low=LOW, high=HIGH, inside=0.105 / HALF):
    """Usable between two moduli, standing for the subjects in the inner part of these."""
    away = np.abs(GRID - 0.5 * (low + high)) - 0.5 * (high - low)
    stands = np.abs(GRID - 0.5 * (low + high)) - 0.5 * inside * (high - low)
    usable, stands = (np.broadcast_to(one, (1, count, len(GRID))) for one in (away, stands))
    return Windows(GRID[None], stands, usable)


def outlook(
    spread=0.3,
    making=0.1,
    puck=0.03,
    shifts=NO_SHIFT,
    match=Match(MIDDLE, 0.0),  # noqa: B008
    strict=False,
    low=LOW,
    high=HIGH,
    ratio=RATIO,
    limits=LIMITS,
    inside=0.105 / HALF,
    **more,
):
    drawn = batches(spread, ratio, **more)
    if strict:  # there a casting stands for the subjects or is not usable
        inside = 1.0
    return outlook_of(
        windows(COUNT, low, high, inside),
        windows(1, low, high, inside),
        drawn,
        centre(ratio),
        match,
        Scatter(making, puck, np.asarray(shifts)),
        limits,
        strict,
    )


def cover(half, spread):
    """Probability that a normal of a spread lies within a half width."""
    return 2.0 * norm.cdf(half / spread) - 1.0


CASES = [(0.05, 0.02), (0.2, 0.05), (0.3, 0.1), (0.6, 0.2), (0.2, 0.6)]


@pytest.mark.parametrize(("spread", "making"), CASES)
def test_as_poured_and_with_the_resin_known_are_normal_integrals_over_the_window(spread, making):
    found = outlook(spread, making)
    assert found.as_poured == pytest.approx(cover(HALF, np.hypot(spread, making)), abs=2e-3)
    assert found.known == pytest.approx(cover(HALF, making), abs=2e-3)
    assert found.stands == pytest.approx(cover(0.105, np.hypot(spread, making)), abs=3e-3)
    assert log_young(found.ratio) == pytest.approx(MIDDLE, abs=0.1 * HALF + 0.5 * SLOPE * 0.05)
    assert found.possible.all()


@pytest.mark.parametrize(("spread", "making"), CASES)
def test_a_puck_without_error_leaves_the_making_alone(spread, making):
    """Every batch is brought to the middle of the window, within half a step of the ratio."""
    found = outlook(spread, making, puck=0.0)
    assert found.after_puck == pytest.approx(cover(HALF, making), abs=3e-3)
    corrected = found.ratios - 15.5
    away = batches(spread).log_young[:, 50] - MIDDLE
    near = cover(HALF, making) < 1.0 - SLACK
    if near:  # where the window holds all of the making, any ratio inside it will do
        np.testing.assert_allclose(SLOPE * corrected, -away, atol=0.1)


@pytest.mark.parametrize(("spread", "making"), CASES)
def test_a_puck_that_tells_nothing_leaves_what_is_usable_as_poured(spread, making):
    found = outlook(spread, making, puck=1e6)
    assert found.after_puck == pytest.approx(found.as_poured, abs=2e-3)
    assert np.ptp(found.ratios) <= 0.05 + 1e-9


@pytest.mark.parametrize("puck", [0.05, 0.15, 0.3, 0.6])
@pytest.mark.parametrize(("spread", "making"), [(0.3, 0.1), (0.6, 0.05)])
def test_a_puck_leaves_the_part_of_the_batch_that_its_error_hides(spread, making, puck):
    """Of a normal batch a reading with a normal error leaves 1 / (1 / s^2 + 1 / p^2) of variance."""
    left = 1.0 / (1.0 / spread**2 + 1.0 / puck**2)
    wanted = cover(HALF, np.sqrt(left + making**2))
    found = outlook(spread, making, puck)
    # the puck's errors are drawn: three standard errors
    error = 3.0 * np.sqrt(wanted * (1.0 - wanted) / COUNT)
    assert found.after_puck == pytest.approx(wanted, abs=error + 2e-3)
    assert found.as_poured - 2e-3 <= found.after_puck <= found.known + error


@pytest.mark.parametrize("residual", [0.05, 0.2])
def test_what_ties_no_ratio_to_the_puck_s_scatters_a_batch_at_every_other_ratio(residual):
    """with batches far from the middle the ratio is another one, whose own residual nobody measured"""
    spread, making = 0.8, 0.05
    found = outlook(spread, making, puck=0.0, residual=residual)
    own = cover(HALF, np.hypot(residual * np.sqrt(1.0 + residual**2 / spread**2) * np.sqrt(2.0), making))
    assert own - 0.03 < found.after_puck < cover(HALF, np.hypot(residual, making)) + 0.03


def test_the_shares_depend_on_ratios_of_moduli_alone():
    first = outlook(0.3, 0.1, 0.1)
    moved = batches(0.3)
    by = np.log(7.0)
    again = outlook_of(
        replace(windows(COUNT), log_young=GRID[None] + by),
        replace(windows(1), log_young=GRID[None] + by),
        replace(moved, log_young=moved.log_young + by),
        replace(centre(), log_young=centre().log_young + by),
        Match(MIDDLE + by, 0.0),
        Scatter(0.1, 0.1, NO_SHIFT),
        LIMITS,
        False,
    )
    for name in ("ratio", "as_poured", "known", "after_puck", "stands", "misfit"):
        assert getattr(again, name) == pytest.approx(getattr(first, name), abs=1e-9)


def test_a_tolerance_of_thickness_moves_the_window_and_its_ends_count_alike():
    one = outlook(0.05, 0.02, shifts=[0.4])
    assert log_young(one.ratio) == pytest.approx(MIDDLE + 0.4, abs=0.1)
    wide = outlook(0.2, 0.05, shifts=[-0.25, 0.0, 0.25])
    at = log_young(wide.ratio) - MIDDLE
    wanted = np.mean(
        [
            norm.cdf((HALF + s - at) / np.hypot(0.2, 0.05)) - norm.cdf((-HALF + s - at) / np.hypot(0.2, 0.05))
            for s in (-0.25, 0.0, 0.25)
        ]
    )
    assert wide.as_poured == pytest.approx(wanted, abs=3e-3)


def test_of_ratios_that_are_usable_alike_the_one_nearest_to_the_aim_is_poured():
    """A window far wider than the scatter holds many ratios; the aim is off its middle."""
    low, high = MIDDLE - 1.5, MIDDLE + 1.5
    for aim in (-0.7, 0.4, 0.9):
        found = outlook(0.1, 0.05, low=low, high=high, match=Match(MIDDLE + aim, 0.1), inside=1.0)
        assert log_young(found.ratio) == pytest.approx(MIDDLE + aim, abs=SLOPE * 0.05)
        assert found.known_ratio == pytest.approx(found.ratio, abs=0.051)
        # every batch is brought to the aim, so what is left of the misfit is what no modulus mends
        assert found.misfit == pytest.approx(0.1, abs=0.02)
    beyond = outlook(0.1, 0.05, low=low, high=high, match=Match(MIDDLE + 3.0, 0.1))
    assert beyond.as_poured > 1.0 - 2.0 * SLACK and log_young(beyond.ratio) < high


@pytest.mark.parametrize("strict", [False, True])
def test_no_ratio_of_a_worse_level_is_taken_for_a_nearer_aim(strict):
    """Drawn shares about the one that is needed: the ratio keeps the level of that of the largest usable share."""
    rng, needed = np.random.default_rng(8101), LIMITS.share
    usable = np.clip(needed + 0.02 * rng.standard_normal((2000, 12)), 0.0, 1.0)
    stands = np.minimum(needed + 0.03 * rng.standard_normal((2000, 12)), usable)
    rows, chosen = np.arange(2000), _best(usable, stands, rng.uniform(size=(2000, 12)), needed, strict)
    most = usable.max(axis=1)
    lost = (np.minimum(most, needed + ABOVE) if strict else most) - usable[rows, chosen]
    assert lost.max() <= SLACK + 1e-12 and lost.max() > 0.8 * SLACK
    assert np.all(usable[rows, chosen][most >= needed] >= needed)
    largest = stands[rows, usable.argmax(axis=1)]
    assert np.mean(largest >= needed) > 0.2
    if not strict:
        assert np.all(stands[rows, chosen][largest >= needed] >= needed)


@pytest.mark.parametrize("number", range(12))
def test_of_ratios_that_are_usable_alike_the_one_of_the_better_level_is_poured(number):
    """Drawn windows, aims and batches: no usable share falls for it, and of those that stand alike the aim decides."""
    rng = np.random.default_rng([6021, number])
    spread, making, half = rng.uniform(0.02, 0.06), rng.uniform(0.02, 0.06), rng.uniform(0.5, 0.9)
    inner = rng.uniform(1.5, 4.0) * np.hypot(spread, making)
    aim = MIDDLE + rng.choice([-1.0, 1.0]) * rng.uniform(0.2, 0.6)
    found = outlook(
        spread, making, low=MIDDLE - half, high=MIDDLE + half, match=Match(aim, 0.05), inside=inner / half, puck=0.02
    )

    def share(ratio, width):
        away, total = np.asarray(log_young(ratio)) - MIDDLE, np.hypot(spread, making)
        return norm.cdf((width - away) / total) - norm.cdf((-width - away) / total)

    usable, stands = share(RATIO, half), share(RATIO, inner)
    assert found.as_poured > usable.max() - SLACK - 2e-3
    enough = min(stands.max(), LIMITS.share + ABOVE)
    assert found.stands > enough - SLACK - 3e-3
    # no nearer ratio stands as well
    nearer = np.abs(log_young(RATIO) - aim) < abs(log_young(found.ratio) - aim) - 1e-9
    assert not (nearer & (usable > usable.max() - 0.5 * SLACK) & (stands > enough - 0.5 * SLACK)).any()
    if stands.max() > LIMITS.share + 0.005:
        assert found.level(LIMITS, False) == 0
    # the same rule holds for the batch whose puck was pressed
    assert np.mean(np.abs(log_young(found.ratios) - MIDDLE) > inner) < 0.2


def test_on_the_safe_side_more_castings_than_are_needed_only_read_higher():
    """open to the stiff side: the softest ratio that keeps the share needed is taken, not the surest one"""
    spread, making = 0.2, 0.05
    high = MIDDLE + 3.5
    strict = outlook(spread, making, low=LOW, high=high, strict=True, match=Match(MIDDLE - 2.0, 0.0))
    free = outlook(spread, making, low=LOW, high=high, match=Match(MIDDLE - 2.0, 0.0))
    needed = LIMITS.share + 0.01
    assert needed - SLACK <= strict.as_poured <= needed + 0.015 and free.as_poured > 1.0 - 2.0 * SLACK
    surely = LOW + norm.ppf(needed - SLACK) * np.hypot(spread, making)
    assert log_young(strict.ratio) == pytest.approx(surely, abs=SLOPE * 0.051)


def test_where_no_modulus_is_usable_the_ratio_is_that_of_the_least_excess():
    away = 0.3 + np.abs(GRID - (MIDDLE + 0.5))
    none, one = (Windows(GRID[None], *(np.broadcast_to(away, (1, n, len(GRID))) for _ in range(2))) for n in (COUNT, 1))
    scatter = Scatter(0.1, 0.1, NO_SHIFT)
    found = outlook_of(none, one, batches(0.2), centre(), Match(MIDDLE, 0.0), scatter, LIMITS, False)
    assert found.as_poured == found.known == found.after_puck == 0.0 and not found.possible.any()
    assert found.beyond == pytest.approx(0.3, abs=0.02)
    assert log_young(found.ratio) == pytest.approx(MIDDLE + 0.5, abs=SLOPE * 0.026) and found.known_ratio == found.ratio
    assert found.level(LIMITS, False) == 3


def test_batches_without_a_window_are_counted_as_those_that_no_ratio_suits():
    every = np.array(windows(COUNT).beyond_usable)
    every[0, ::4] = 1.0
    drawn = replace(windows(COUNT), beyond_usable=every)
    found = outlook_of(
        drawn, windows(1), batches(0.3), centre(), Match(MIDDLE, 0.0), Scatter(0.05, 0.0, NO_SHIFT), LIMITS, False
    )
    assert found.possible.mean() == pytest.approx(300 / 401)
    assert found.after_puck == pytest.approx(0.75 * cover(HALF, 0.05), abs=0.01)


@pytest.mark.parametrize(
    ("stands", "poured", "known", "strict", "level"),
    [
        (0.95, 0.95, 0.2, False, 0),
        (0.949, 0.95, 0.2, False, 1),
        (0.949, 0.949, 0.95, False, 2),
        (0.949, 0.949, 0.949, False, 3),
        (0.95, 0.99, 0.2, True, 0),
        (0.949, 0.99, 0.95, True, 2),
        (0.949, 0.99, 0.949, True, 3),
    ],
)
def test_levels_at_both_sides_of_the_share_that_is_needed(stands, poured, known, strict, level):
    found = replace(outlook(), stands=stands, as_poured=poured, known=known)
    assert found.level(LIMITS, strict) == level
