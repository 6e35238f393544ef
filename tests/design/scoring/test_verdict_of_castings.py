"""The verdict over castings: shares, 95 % figures and corrections of one set of draws; and the safe side."""

from dataclasses import replace

import numpy as np
import pytest

from dummydesign.design.scoring.verdict import CLASSES, STEADY, Readings, verdict
from tests.support.judged_pads import away, cast, pad, ranges, stacked

CASTINGS = [
    # per 200: stands, needs a correction, low, far above, out of reach -> level with a resin that would settle it
    ((200, 0, 0, 0, 0), "stands_for"),
    ((190, 10, 0, 0, 0), "stands_for"),
    ((190, 0, 10, 0, 0), "stands_for"),
    ((190, 0, 0, 0, 10), "stands_for"),
    ((189, 11, 0, 0, 0), "usable_with_correction"),
    ((0, 200, 0, 0, 0), "usable_with_correction"),
    ((180, 10, 10, 0, 0), "usable_with_correction"),
    ((180, 10, 0, 10, 0), "usable_with_correction"),
    ((180, 9, 11, 0, 0), "not_settled"),
    ((180, 9, 0, 11, 0), "not_settled"),
    ((180, 9, 0, 0, 11), "not_settled"),
    ((189, 0, 4, 4, 3), "not_settled"),
    ((0, 0, 200, 0, 0), "not_settled"),
    ((0, 0, 0, 200, 0), "not_settled"),
    ((0, 0, 0, 0, 200), "not_settled"),
]


@pytest.mark.parametrize(("counts", "level"), CASTINGS)
def test_at_least_95_of_100_castings_must_keep_the_limits(counts, level):
    known = stacked(cast((190, 0, 10, 0, 0)))
    found = verdict(ranges(), pad(), stacked(cast(counts)), known=known)
    assert found.level == level and found.acceptable
    # where the measured resin would not settle it either, one that is not usable as poured is red
    red = verdict(ranges(), pad(), stacked(cast(counts)), known=stacked(cast((0, 189, 11, 0, 0))))
    assert red.level == (level if level != "not_settled" else "not_representative")
    assert red.castings == found.castings
    assert found.castings == pytest.approx({name: count / 200 for name, count in zip(CLASSES, counts)})
    assert sum(found.castings.values()) == pytest.approx(1.0, abs=1e-12)
    assert found.usable_share == pytest.approx((counts[0] + counts[1]) / 200)
    assert (level == "stands_for") == (found.light == "green")


def test_half_of_the_castings_low_is_never_green_however_good_the_rest():
    for low in range(11, 200, 27):
        assert verdict(ranges(), pad(), stacked(cast((200 - low, 0, low, 0, 0)))).light == "amber"


@pytest.mark.parametrize("seed", range(3))
def test_the_order_of_castings_makes_no_difference(seed):
    rng = np.random.default_rng(seed)
    pads = [
        Readings(p.peak_N * f, p.energy_mJ / f, p.depth_mm * f)
        for p in cast((40, 8, 4, 5, 3))
        for f in [np.exp(0.1 * rng.standard_normal())]
    ]
    first = verdict(ranges(), pad(), stacked(pads))
    second = verdict(ranges(), pad(), stacked([pads[at] for at in rng.permutation(len(pads))]))
    assert (first.level, first.castings, first.text) == (second.level, second.castings, second.text)
    for side in ("shortfall", "over", "correction"):
        for name, value in vars(getattr(first, side)).items():
            again = getattr(getattr(second, side), name)
            assert again == (pytest.approx(value, rel=1e-14) if isinstance(value, float) else value)


def test_the_95_per_cent_figures_are_those_of_the_castings_in_reach():
    rng = np.random.default_rng(4)
    short, over = rng.uniform(0.9, 1.3, (2, 400))
    pads = [away(*pair) for pair in zip(short, over)]
    for one in pads[::5]:
        one.peak_N[0] = np.nan
    found = verdict(ranges(), pad(), stacked(pads))
    reached = np.arange(400) % 5 != 0
    assert found.shortfall.q95 == pytest.approx(np.quantile(short[reached], 0.95))
    assert found.over.q95 == pytest.approx(np.quantile(over[reached], 0.95))
    assert found.castings["out_of_reach"] == pytest.approx(0.2)
    assert found.correction.factor == found.shortfall.q95 and found.correction.factor_central == 1.0
    nowhere = stacked([away()] * 3)
    nowhere.peak_N[:, 0] = np.nan
    found = verdict(ranges(), pad(), nowhere)
    assert found.shortfall.q95 is None and found.correction.factor is None and found.castings["out_of_reach"] == 1.0


def test_corrected_readings_are_below_no_subject_and_measuring_gives_a_factor_of_its_own():
    rng = np.random.default_rng(8)
    pads = [away(value) for value in 1.05 * np.exp(0.05 * rng.standard_normal(400))]
    known = [away(value) for value in 1.05 * np.exp(0.01 * rng.standard_normal(400))]
    found = verdict(ranges(), away(1.05), stacked(pads), known=stacked(known))
    factor = found.correction
    assert factor.factor_central == pytest.approx(1.05)
    assert factor.factor_central < factor.factor_after_measuring < factor.factor
    for value, spread in ((factor.factor, pads), (factor.factor_after_measuring, known)):
        kept = [bool((value * one.peak_N >= ranges().peak_low_N * (1 - 1e-12)).all()) for one in spread]
        assert np.mean(kept) == pytest.approx(0.95, abs=0.003)
    assert verdict(ranges(), pad(), stacked([pad()] * 3)).correction.factor_after_measuring is None


@pytest.mark.parametrize(("good", "level"), [(190, "not_settled"), (189, "not_representative")])
def test_a_puck_is_asked_for_where_95_of_100_castings_of_the_measured_resin_are_usable(good, level):
    """whatever the pad at central estimates does: it is the castings that are used"""
    poured = stacked(cast((0, 100, 50, 30, 20)))
    known = stacked(cast((good // 2, good - good // 2, 200 - good, 0, 0)))
    for nominal in (pad(), pad(peak=0.7), pad(peak=1.9)):
        assert verdict(ranges(), nominal, poured, known=known).level == level


def test_without_castings_of_the_measured_resin_the_pad_itself_counts_as_the_resin_known():
    poured = stacked(cast((0, 100, 50, 30, 20)))
    for nominal, level in ((pad(), "not_settled"), (away(1.1999), "not_settled"), (away(1.2001), "not_representative")):
        assert verdict(ranges(), nominal, poured).level == level


@pytest.mark.parametrize(
    ("beyond", "level"),
    [
        (1.0, "stands_for"),
        (1.01, "not_settled"),
        (2.0, "not_settled"),
        (2.01, "not_representative"),
    ],
)
def test_a_test_harder_than_any_press_of_people_is_open_and_from_twice_on_red(beyond, level):
    found = verdict(ranges(), pad(), stacked([pad()] * 40), known=stacked([pad()] * 40), beyond=beyond)
    assert found.level == level


def test_a_low_pad_reads_low_however_its_pours_may_turn_out():
    found = verdict(ranges(), pad(peak=0.7), stacked([pad()] * 50))
    assert found.reads == "low" and found.shortfall.central > 1.2


def strictly(band, readings, **more):
    return verdict(replace(band, strict=True), readings, **more)


def test_the_safe_side_is_kept_when_nothing_is_below_the_highest_subject():
    band = ranges()
    high = Readings(band.peak_high_N * 1.001, band.energy_high_mJ, band.stiff_mm)
    found = strictly(band, high)
    assert found.level == "stands_for" and found.shortfall.central <= 1.0 + 1e-12
    low = Readings(band.peak_high_N * np.array([1, 1, 0.9, 1, 1, 1]), band.energy_high_mJ, band.stiff_mm)
    found = strictly(band, low)
    assert found.level == "not_representative" and found.shortfall.central == pytest.approx(1 / 0.9)
    assert found.shortfall.press == {"steady_force_N": 15.0, "velocity_mm_s": 10.0}
    soft = Readings(high.peak_N, band.energy_high_mJ, band.stiff_mm * 1.25 ** (1 / 3))
    found = strictly(band, soft)
    assert found.light == "red" and found.shortfall.central == pytest.approx(1.25)
    assert found.shortfall.quantity == STEADY
    far = Readings(np.where(np.arange(6) == 2, np.nan, high.peak_N), high.energy_mJ, high.depth_mm)
    assert strictly(band, far).light == "red"


def test_what_the_safe_side_takes_is_stated_and_not_limited():
    band = ranges()
    far = Readings(3.0 * band.peak_high_N, 0.5 * band.energy_low_mJ, band.stiff_mm)
    found = strictly(band, far)
    assert found.level == "stands_for" and found.over.central == pytest.approx(3.0) and found.peaks_above == 6
    assert verdict(band, far).light == "red"


@pytest.mark.parametrize(("low", "level"), [(10, "stands_for"), (11, "not_settled"), (200, "not_settled")])
def test_on_the_safe_side_a_casting_that_falls_short_is_not_corrected(low, level):
    band = ranges()
    kept = Readings(1.05 * band.peak_high_N, band.energy_high_mJ, band.stiff_mm)
    short = Readings(kept.peak_N * np.array([0.93, 1, 1, 1, 1, 1]), kept.energy_mJ, kept.depth_mm)
    found = strictly(band, kept, spread=stacked([short] * low + [kept] * (200 - low)))
    assert found.level == level and found.castings["with_correction"] == found.castings["over"] == 0.0
    assert found.castings["reads_low"] == pytest.approx(low / 200)


def test_one_subject_is_not_green_on_the_safe_side_either():
    band = ranges(1, 1.0)
    same = Readings(1.005 * band.peak_high_N, band.energy_high_mJ, band.stiff_mm)
    assert strictly(band, same).light == "amber"


def test_the_sentence_of_a_level_that_is_open_has_the_share_that_decides():
    counts = (100, 20, 80, 0, 0), (196, 0, 4, 0, 0), (150, 30, 20, 0, 0)
    poured, known, after = (stacked(cast(one)) for one in counts)
    found = verdict(ranges(), pad(), poured, known=known, measure="one puck", after_puck=after)
    assert found.level == "not_settled" and found.text.startswith("Measure one puck first")
    assert all(share in found.text for share in ("98 %", "90 %", "60 %"))


@pytest.mark.parametrize("over", [1.11, 1.2, 1.24])
def test_a_pad_that_only_reads_high_has_a_factor_of_one_and_its_excess_in_one_sentence(over):
    found = verdict(ranges(), pad(), stacked([away(over=over)] * 200))
    assert found.level == "usable_with_correction" and found.correction.factor == 1.0
    assert "no correction" not in found.text and "1.00" in found.text and f"{100 * (over - 1):.0f} %" in found.text
