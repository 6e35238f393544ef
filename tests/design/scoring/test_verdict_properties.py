"""The verdict in general: it depends on ratios alone, and more force never makes a pad lower."""

import dataclasses

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dummydesign.core.levels import LEVELS
from dummydesign.design.scoring.press_simulation import PadBatch, Sampling, make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import Readings, ranges_of, readings_of, verdict
from dummydesign.geometry.dimensions import PUNCH_RADIUS_MM
from tests.support.judged_pads import pad, ranges
from tests.support.slab_by_formula import make_tissue

RANK = {level: place for place, level in enumerate(LEVELS[::-1])}
"""Larger is better."""


EXAMPLES = settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])


@EXAMPLES
@given(
    st.lists(st.floats(0.4, 2.5), min_size=6, max_size=6),
    st.lists(st.floats(0.4, 2.5), min_size=6, max_size=6),
    st.floats(0.7, 1.4),
    st.floats(1.0, 1.5),
    st.integers(0, 5),
)
def test_more_force_never_makes_a_pad_lower(peaks, energies, depth, more, press):
    start = pad()
    readings = Readings(start.peak_N * peaks, start.energy_mJ * energies, start.depth_mm * depth)
    raised = Readings(readings.peak_N.copy(), readings.energy_mJ.copy(), readings.depth_mm / more)
    raised.peak_N[press] *= more
    before, after = verdict(ranges(), readings), verdict(ranges(), raised)
    assert after.peaks_below <= before.peaks_below and after.steady_below_fraction <= before.steady_below_fraction
    assert after.shortfall.central <= before.shortfall.central * (1 + 1e-12)
    assert after.over.central >= before.over.central * (1 - 1e-12)
    assert not (before.reads in ("inside", "high") and after.reads in ("low", "mixed"))
    assert (before.reads in ("low", "mixed")) == bool(
        before.peaks_below or before.energy_below or before.steady_below_fraction
    )


@EXAMPLES
@given(
    st.lists(st.floats(0.6, 1.0), min_size=6, max_size=6),
    st.floats(0.95, 1.05),
    st.floats(0.5, 1.0),
    st.integers(0, 5),
    st.floats(0.0, 0.1),
    st.integers(0, 10),
)
def test_a_lower_peak_never_raises_the_level(peaks, depth, less, press, width, seed):
    """where no peak is above the highest subject; central and castings fall together"""
    start, band = pad(), ranges()
    readings = Readings(band.peak_high_N * peaks, start.energy_mJ, start.depth_mm * depth)
    lower = Readings(readings.peak_N.copy(), readings.energy_mJ, readings.depth_mm)
    lower.peak_N[press] *= less
    assert RANK[verdict(band, lower).level] <= RANK[verdict(band, readings).level]
    off = np.exp(-width * np.abs(np.random.default_rng(seed).standard_normal((40, 1))))
    still = [np.tile(values, (40, 1)) for values in (start.energy_mJ, readings.depth_mm)]
    higher, down = (verdict(band, one, Readings(off * one.peak_N, *still)) for one in (readings, lower))
    assert RANK[down.level] <= RANK[higher.level] and down.usable_share <= higher.usable_share
    assert down.castings["reads_low"] >= higher.castings["reads_low"]


@EXAMPLES
@given(st.floats(1e-3, 1e3), st.lists(st.floats(0.3, 3.0), min_size=6, max_size=6), st.floats(0.6, 1.5))
def test_forces_of_pad_and_subjects_times_the_same_factor_give_the_same_verdict(factor, peaks, depth):
    start = pad()
    readings = Readings(start.peak_N * peaks, start.energy_mJ, start.depth_mm * depth)
    scaled = Readings(readings.peak_N * factor, readings.energy_mJ * factor, readings.depth_mm)
    forces = ("force_N", "peak_low_N", "peak_high_N", "energy_low_mJ", "energy_high_mJ", "steady_N")
    same = dataclasses.replace(ranges(), **{name: factor * getattr(ranges(), name) for name in forces})
    first, second = verdict(ranges(), readings), verdict(same, scaled)
    assert (first.reads, first.peaks_below, first.peaks_above) == (second.reads, second.peaks_below, second.peaks_above)
    assert second.shortfall.central == pytest.approx(first.shortfall.central, rel=1e-12)
    assert second.over.central == pytest.approx(first.over.central, rel=1e-12)
    assert first.level == second.level


@pytest.fixture(scope="module")
def sampling():
    return Sampling(24, 12, 30)


def slabs_of(law, young_MPa, thickness_mm, beta=(0.6, 0.5)):
    """Slabs of one thickness and several moduli that relax in 0.03 and 0.5 s."""
    young = np.atleast_1d(young_MPa)
    curves = make_curves(law, [thickness_mm], PUNCH_RADIUS_MM, 0.6)
    return PadBatch(curves, np.zeros(len(young), int), young, (0.03, 0.5), np.tile(beta, (len(young), 1)))


def judged(slabs, tissue, sampling):
    targets = make_targets(tissue, "average", sampling)
    evaluation = evaluate(slabs, targets, sampling)
    band = ranges_of(targets)
    return [verdict(band, readings_of(evaluation, index)) for index in range(len(slabs.slab))]


@pytest.mark.parametrize("thickness_mm", [4.0, 6.0, 9.0])
@pytest.mark.parametrize("beta", [(0.3, 0.3), (0.6, 0.5), (1.0, 0.5)])
def test_a_stiffer_pad_never_goes_from_inside_to_low(layer_law, finger, sampling, thickness_mm, beta):
    young = np.geomspace(0.005, 0.2, 40)
    found = judged(slabs_of(layer_law, young, thickness_mm, beta), finger, sampling)
    reads = [item.reads for item in found]
    if "inside" in reads:
        assert "low" not in reads[reads.index("inside") :]
    below = [item.steady_below_fraction for item in found if not item.not_reached]
    assert np.all(np.diff(below) <= 0.0)
    assert {item.level for item in found} <= set(LEVELS)


def test_a_pad_that_hardly_relaxes_reads_low_at_any_modulus_that_follows_the_steady_curve(layer_law, finger, sampling):
    found = judged(slabs_of(layer_law, np.geomspace(0.01, 0.1, 15), 6.0, (0.02, 0.02)), finger, sampling)
    assert all(item.light == "red" for item in found)
    near = [item for item in found if not item.not_reached and item.steady_fraction > 0.4]
    assert near and all(item.peaks_below == 6 and item.reads in ("low", "mixed") for item in near)
    assert all(item.shortfall.central > 1.5 for item in near)


def test_one_person_is_followed_and_never_called_a_range(layer_law, sampling):
    found = judged(slabs_of(layer_law, np.geomspace(0.01, 0.1, 15), 6.0), make_tissue((1.2,)), sampling)
    assert all(item.light != "green" and item.subjects == 1 for item in found)
