"""The verdict at central estimates: nothing that is low, far above or out of reach is quiet."""

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.design.scoring.settings import verdict_limits
from dummydesign.design.scoring.verdict import (
    ENERGY,
    LIGHTS,
    PEAK,
    STEADY,
    Readings,
    classes,
    deviations,
    verdict,
)
from tests.support.judged_pads import FORCES, SPEEDS, away, cast, pad, ranges, stacked


def test_a_pad_in_the_middle_stands_for_the_subjects_and_is_green():
    found = verdict(ranges(), pad())
    assert (found.level, found.light, found.reads, found.acceptable) == ("stands_for", "green", "inside", True)
    assert (found.peaks, found.peaks_below, found.peaks_above, found.steady_fraction) == (6, 0, 0, 1.0)
    assert found.energy_ratio == pytest.approx(1.0)
    assert found.shortfall.central < 1.0 and found.over.central < 1.0 and found.castings is None
    assert (found.correction.factor, found.correction.factor_central) == (1.0, 1.0)


@pytest.mark.parametrize("what", [{"peak": 0.5}, {"energy": 0.5}, {"depth": 1.3}])
def test_far_below_every_subject_in_peak_energy_or_steady_force_is_red(what):
    found = verdict(ranges(), pad(**what))
    assert (found.level, found.light, found.acceptable) == ("not_representative", "red", False)
    assert found.reads == "low" and found.shortfall.central > 1.5 and found.correction.factor == found.shortfall.central
    assert found.shortfall.quantity == {"peak": PEAK, "energy": ENERGY, "depth": STEADY}[next(iter(what))]


@pytest.mark.parametrize(
    ("factor", "level"), [(0.92, "stands_for"), (0.8, "usable_with_correction"), (0.7, "not_representative")]
)
@pytest.mark.parametrize("press", range(6))
def test_one_low_peak_of_six_decides(press, factor, level):
    readings = pad()
    readings.peak_N[press] *= factor
    found = verdict(ranges(), readings)
    assert found.level == level and found.peaks_below == (factor < 0.87)
    assert (found.reads == "low") == (factor < 0.87)
    assert found.shortfall.central == pytest.approx(1.6 * FORCES[press] / readings.peak_N[press])
    assert found.shortfall.press == {"steady_force_N": FORCES[press], "velocity_mm_s": SPEEDS[press]}
    assert found.correction.factor_central == max(found.shortfall.central, 1.0)


def test_low_in_some_and_high_in_other_presses_is_mixed_and_red():
    readings = pad()
    readings.peak_N[:3] *= 0.6
    readings.peak_N[3:] *= 1.6
    found = verdict(ranges(), readings)
    assert (found.level, found.light, found.reads) == ("not_representative", "red", "mixed")
    assert (found.peaks_below, found.peaks_above) == (3, 3)


@pytest.mark.parametrize("what", [{"peak": 1.35}, {"energy": 1.35}, {"depth": np.linspace(0.88, 1.0, 41)}])
def test_a_little_above_every_subject_reads_high_and_is_amber(what):
    found = verdict(ranges(), pad(**what))
    assert (found.level, found.light, found.reads) == ("usable_with_correction", "amber", "high")
    assert 1.10 < found.over.central < 1.25 and found.correction.factor == 1.0


@pytest.mark.parametrize("what", [{"peak": 1.5}, {"energy": 1.5}, {"depth": 0.8}])
def test_a_quarter_above_every_subject_is_red(what):
    found = verdict(ranges(), pad(**what))
    assert (found.level, found.light, found.reads) == ("not_representative", "red", "high")
    assert (
        found.over.central > 1.25
        and found.over.quantity == {"peak": PEAK, "energy": ENERGY, "depth": STEADY}[next(iter(what))]
    )


def test_out_of_reach_is_red_and_hides_nothing_low():
    readings = pad()
    readings.peak_N[[2, 5]] = np.nan
    readings.depth_mm[-5:] = np.nan
    found = verdict(ranges(), readings)
    assert (found.level, found.not_reached, found.peaks) == ("not_representative", 2, 4)
    readings.peak_N[0] *= 0.5
    found = verdict(ranges(), readings)
    assert found.level == "not_representative" and found.reads == "low" and found.peaks_below == 1
    assert found.shortfall.central == pytest.approx(2.0 / np.sqrt(1.3))
    nothing = Readings(np.full(6, np.nan), np.full(6, np.nan), np.full(41, np.nan))
    found = verdict(ranges(), nothing)
    assert found.level == "not_representative" and found.peaks == 0 and found.not_reached == 6
    assert found.steady_fraction is None and found.energy_ratio is None
    assert found.shortfall.central is None and found.over.central is None and found.shortfall.press is None
    assert found.correction.factor is None


@pytest.mark.parametrize("press", range(6))
def test_a_pad_that_is_cast_is_red_with_one_press_out_of_reach(press):
    readings = pad()
    readings.peak_N[press] = np.nan
    found = verdict(ranges(), readings)
    assert (found.level, found.not_reached) == ("not_representative", 1)


def test_a_stiff_pad_that_takes_less_energy_is_mixed_and_red():
    found = verdict(ranges(), pad(energy=0.5, depth=0.7))
    assert found.reads == "mixed" and found.light == "red"


LIMITS = [
    (1.0099, None, "stands_for"),
    (1.0101, None, "usable_with_correction"),
    (1.1111, None, "usable_with_correction"),
    (1.1999, None, "usable_with_correction"),
    (1.2001, None, "not_representative"),
    (None, 1.0999, "stands_for"),
    (None, 1.1001, "usable_with_correction"),
    (None, 1.2499, "usable_with_correction"),
    (None, 1.2501, "not_representative"),
    (1.1999, 1.2499, "usable_with_correction"),
    (1.0099, 1.0999, "stands_for"),
    (1.1999, 1.2501, "not_representative"),
    (1.2001, 1.2499, "not_representative"),
]


@pytest.mark.parametrize(("shortfall", "over", "level"), LIMITS)
def test_levels_at_and_about_each_limit_of_a_pad_that_is_known(shortfall, over, level):
    found = verdict(ranges(), away(shortfall, over))
    assert found.level == level and found.light == LIGHTS[level]
    if shortfall:
        assert found.shortfall.central == pytest.approx(shortfall) and found.shortfall.press["velocity_mm_s"] == 10.0
    if over:
        assert found.over.central == pytest.approx(over) and found.over.press["velocity_mm_s"] == 250.0


def test_one_subject_makes_no_range_so_nothing_is_green():
    one = ranges(1, 1.0)
    same = verdict(one, pad(width=1.0))
    assert same.level == "usable_with_correction" and same.subjects == 1
    assert same.shortfall.central == pytest.approx(1.0) and same.over.central == pytest.approx(1.0)
    assert verdict(one, pad(width=1.0), stacked([pad(width=1.0)] * 30)).light == "amber"
    assert verdict(one, pad(peak=0.83, width=1.0)).light == "red"
    assert verdict(one, pad(peak=0.95, width=1.0)).reads == "low"
    assert verdict(one, pad(peak=1.05, width=1.0)).reads == "high"


def test_a_pad_outside_in_most_presses_is_not_green_however_near_it_is():
    near = verdict(ranges(), pad(peak=1.09 * np.sqrt(1.3)))
    assert near.peaks_above == 6 and near.over.central == pytest.approx(1.09) and near.light == "amber"
    readings = pad()
    readings.peak_N[:3] = ranges().peak_high_N[:3] * 1.09
    assert verdict(ranges(), readings).level == "stands_for"
    readings.peak_N[3] = ranges().peak_high_N[3] * 1.09
    assert verdict(ranges(), readings).light == "amber"


def test_what_was_not_pressed_leaves_the_verdict_open():
    found = verdict(ranges(), pad(), unsettled="it was not pressed at 250 mm/s")
    assert found.level == "not_settled" and found.light == "amber"
    assert verdict(ranges(), pad(peak=0.5), unsettled="it was not pressed at 250 mm/s").light == "red"


def test_many_pads_at_once_are_classed_as_they_are_alone():
    pads = [*cast((1, 1, 1, 1, 1)), pad(0.5), pad(1.5), pad(1.0, 0.5, 0.7), pad(1.0, 1.0, 0.8)]
    limits = verdict_limits()
    for strict in (True, False):
        band = replace(ranges(), strict=strict)
        many, alone = deviations(band, stacked(pads)), [deviations(band, one) for one in pads]
        together = classes(many, limits).tolist()
        assert together == [int(classes(one, limits)[0]) for one in alone]
    assert [kind <= 1 for kind in together] == [verdict(ranges(), one).acceptable for one in pads]
