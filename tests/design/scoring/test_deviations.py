"""Shortfall and over-reading against closed forms, and the exclusive classes of castings."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import (
    CLASSES,
    ENERGY,
    PEAK,
    STEADY,
    Deviations,
    Ranges,
    Readings,
    classes,
    deviations,
    verdict,
)

FORCE = np.array([5.0, 10.0, 15.0])
GRID = np.linspace(5.0, 15.0, 11)
SOFT, STIFF = 0.8, 2.0
"""Coefficients of the softest and the stiffest subject. [N / mm^power]"""
RISE = 1.7
"""Peak over steady force of every subject."""


def subjects(power=3.0, count=4, soft=SOFT, stiff=STIFF):
    """Subjects of steady force g x^power, with peaks RISE times as high and energies of the rise F x / (p + 1)."""
    peak = RISE * FORCE
    energy = [RISE * FORCE * (FORCE / g) ** (1 / power) / (power + 1) for g in (stiff, soft)]
    return Ranges(
        FORCE,
        np.full(3, 10.0),
        peak,
        peak,
        *energy,
        GRID,
        (GRID / stiff) ** (1 / power),
        (GRID / soft) ** (1 / power),
        count,
        power,
    )


def power_pad(g, power=3.0, rise=RISE):
    """A pad of the same law and another coefficient."""
    depth = (FORCE / g) ** (1 / power)
    return Readings(rise * FORCE, rise * FORCE * depth / (power + 1), (GRID / g) ** (1 / power))


@pytest.mark.parametrize("power", [1.5, 2.0, 3.0])
@pytest.mark.parametrize("k", [0.3, 0.8, 1.0, 1.3, 4.0])
def test_of_a_pad_k_times_as_stiff_as_the_stiffest_the_steady_force_is_k_times_as_large(k, power):
    found = deviations(subjects(power), power_pad(k * STIFF, power))
    np.testing.assert_allclose(found.above[STEADY], k)
    np.testing.assert_allclose(found.short[STEADY], SOFT / (k * STIFF))
    np.testing.assert_allclose(found.above[PEAK], 1.0)
    np.testing.assert_allclose(found.above[ENERGY], (k * STIFF / SOFT) ** (-1 / power))
    np.testing.assert_allclose(found.short[ENERGY], k ** (1 / power))
    assert found.over[0] == pytest.approx(max(k, 1.0, (k * STIFF / SOFT) ** (-1 / power)))
    assert found.shortfall[0] == pytest.approx(max(SOFT / (k * STIFF), 1.0, k ** (1 / power)))
    assert found.reached.all()


@pytest.mark.parametrize("rise", [0.5, 0.9, 1.2, 2.0])
def test_of_a_pad_with_another_rise_the_peaks_are_off_by_its_ratio(rise):
    found = deviations(subjects(), power_pad(np.sqrt(SOFT * STIFF), rise=rise * RISE))
    np.testing.assert_allclose(found.above[PEAK], rise)
    np.testing.assert_allclose(found.short[PEAK], 1.0 / rise)


@pytest.mark.parametrize("count", [2, 5])
def test_a_pad_beside_itself_as_its_own_tissue_is_exactly_what_its_subjects_are(count):
    own = subjects(count=count, soft=1.3, stiff=1.3)
    found = deviations(own, power_pad(1.3))
    for ratios in (found.short, found.above):
        for values in ratios.values():
            np.testing.assert_allclose(values, 1.0)
    assert verdict(own, power_pad(1.3)).level == "stands_for"


def test_on_the_safe_side_the_shortfall_is_that_below_the_highest_subject_and_energies_are_not_judged():
    pad = power_pad(0.5 * STIFF, rise=0.8 * RISE)
    found = deviations(replace(subjects(), strict=True), pad)
    np.testing.assert_allclose(found.short[STEADY], 2.0)
    np.testing.assert_allclose(found.short[PEAK], 1.25)
    assert ENERGY not in found.short and ENERGY not in found.above
    assert found.shortfall[0] == pytest.approx(2.0)


def test_the_largest_of_presses_and_quantities_counts_and_is_found():
    pad = power_pad(1.3)
    pad.peak_N[2] *= 0.5
    pad.depth_mm[4] *= 0.4
    found = deviations(subjects(), pad)
    assert found.worst(found.short) == (pytest.approx(2.0), PEAK, 2)
    assert found.worst(found.above) == (pytest.approx(1.3 / STIFF / 0.4**3), STEADY, 4)
    assert found.shortfall[0] == pytest.approx(2.0) and found.over[0] == pytest.approx(1.3 / STIFF / 0.4**3)


def test_what_is_out_of_reach_is_not_judged_and_is_not_reached():
    pad = power_pad(1.3)
    pad.peak_N[2] = pad.energy_mJ[2] = pad.depth_mm[-2] = np.nan
    pad.peak_N[0] *= 0.7
    found = deviations(subjects(), pad)
    assert not found.reached[0] and found.shortfall[0] == pytest.approx(1 / 0.7)
    nothing = deviations(subjects(), Readings(*(np.full(n, np.nan) for n in (3, 3, 11))))
    assert np.isnan(nothing.shortfall[0]) and np.isnan(nothing.over[0]) and not nothing.reached[0]
    assert np.isnan(nothing.worst(nothing.short)[0])


def test_energies_that_are_not_known_of_the_subjects_are_not_judged():
    unknown = np.full(3, np.nan)
    band = replace(subjects(), energy_low_mJ=unknown, energy_high_mJ=unknown)
    pad = power_pad(1.3)
    pad.energy_mJ[:] = 1e-6
    assert deviations(band, pad).shortfall[0] < 1.0 + 1e-9
    assert verdict(band, pad).energy_below == 0


def of_pads(short, over, reached=None):
    """Deviations of pads by their largest shortfall and over-reading."""
    short, over = (np.asarray(values, float)[:, None] for values in (short, over))
    known = np.ones(len(short), bool) if reached is None else np.asarray(reached)
    return Deviations(subjects(), {PEAK: short}, {PEAK: over}, known)


@pytest.mark.parametrize(
    ("short", "over", "name"),
    [
        (0.9, 0.9, "stands_for"),
        (1.01, 1.10, "stands_for"),
        (1.0101, 1.0, "with_correction"),
        (1.0, 1.1001, "with_correction"),
        (1.20, 1.25, "with_correction"),
        (1.2001, 1.0, "reads_low"),
        (1.0, 1.2501, "over"),
        (1.2001, 1.2499, "reads_low"),
        (1.1999, 1.2501, "over"),
        (1.3, 1.3, "reads_low"),
        (1.3, 1.4, "over"),
        (1.5, 1.5625, "reads_low"),
        (1.5, 1.563, "over"),
        (3.0, 2.0, "reads_low"),
    ],
)
def test_a_casting_that_falls_short_and_over_reads_counts_by_the_larger_excess(short, over, name):
    limits = verdict_limits()
    assert CLASSES[int(classes(of_pads([short], [over]), limits)[0])] == name
    assert CLASSES[int(classes(of_pads([short], [over], [False]), limits)[0])] == "out_of_reach"


def test_classes_are_exclusive_and_sum_to_one_whatever_the_castings_do():
    rng = np.random.default_rng(2)
    short, over = np.exp(rng.uniform(-0.3, 0.6, (2, 3000)))
    found, limits = of_pads(short, over, rng.random(3000) > 0.1), verdict_limits()
    kinds = classes(found, limits)
    assert set(kinds.tolist()) == set(range(len(CLASSES)))
    excess = np.maximum(short / limits.shortfall, over / limits.over)
    np.testing.assert_array_equal(kinds <= 1, found.reached & (excess <= 1.0))
    lost = found.reached & (excess > 1.0)
    low = short / limits.shortfall >= over / limits.over
    np.testing.assert_array_equal(kinds == 2, lost & low)
    np.testing.assert_array_equal(kinds == 3, lost & ~low)
    np.testing.assert_array_equal(kinds == 4, ~found.reached)
    strict = classes(replace(found, ranges=replace(found.ranges, strict=True)), limits)
    np.testing.assert_array_equal(strict, np.select([~found.reached, short <= limits.stands_shortfall], [4, 0], 2))


@pytest.mark.parametrize("name", ["shortfall", "over"])
def test_a_wider_limit_never_takes_a_pad_away(name):
    rng = np.random.default_rng(4)
    found = of_pads(*np.exp(rng.uniform(-0.3, 0.4, (2, 2000))))
    kept = [classes(found, verdict_limits().moved(name, factor)) <= 1 for factor in (0.98, 1.0, 1.05, 1.1)]
    assert all((after | ~before).all() for before, after in pairwise(kept)) and kept[0].sum() < kept[-1].sum()
