"""The verdict: low is never quiet and never called inside; it depends on the ratio of pad and tissue alone."""

import dataclasses

import numpy as np
import pytest
from dummydesign.design.scoring.standing import ranges_of, safe_side_shortfall
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from dummydesign.design.assessment.readings import reading_of
from dummydesign.design.request import RADIUS_MM
from dummydesign.design.scoring.presses import Sampling, Slabs, make_curves
from dummydesign.design.scoring.score import evaluate
from dummydesign.design.scoring.targets import make_targets
from dummydesign.design.scoring.verdict import LEVELS, Ranges, Readings, levels, verdict
from dummydesign.design.search.slabs import Candidate
from tests.support.slab_by_formula import make_tissue

FORCES = np.array([5.0, 10.0, 15.0, 5.0, 10.0, 15.0])
SPEEDS = np.repeat([10.0, 250.0], 3)
STEADY = np.linspace(5.0, 15.0, 41)


def ranges(subjects=5, width=1.3):
    middle = np.cbrt(STEADY / 2.0)
    return Ranges(
        FORCES, SPEEDS, 1.6 * FORCES, 1.6 * width * FORCES, FORCES**1.3, width * FORCES**1.3, STEADY,
        middle / width**0.3, middle * width**0.3, subjects,
    )  # fmt: skip


def pad(peak=1.0, energy=1.0, depth=1.0, width=1.3):
    """A pad in the middle of the ranges, peaks, energies and depths times the given factors."""
    middle = np.sqrt(width)
    return Readings(peak * 1.6 * middle * FORCES, energy * middle * FORCES**1.3, depth * np.cbrt(STEADY / 2.0))


def test_a_pad_in_the_middle_is_inside_and_green():
    found = verdict(ranges(), pad())
    assert (found.level, found.light, found.acceptable) == ("inside", "green", True)
    assert (found.peaks, found.peaks_below, found.peaks_above, found.steady_fraction) == (6, 0, 0, 1.0)
    assert found.energy_ratio == pytest.approx(1.0)


@pytest.mark.parametrize("what", [{"peak": 0.5}, {"energy": 0.5}, {"depth": 1.3}])
def test_below_every_subject_in_peak_energy_or_steady_force_reads_low(what):
    found = verdict(ranges(), pad(**what))
    assert (found.level, found.light, found.acceptable) == ("reads_low", "red", False)
    assert found.text.startswith("reads low, the unsafe side")


@pytest.mark.parametrize("press", range(6))
def test_one_low_peak_of_six_is_enough(press):
    readings = pad()
    readings.peak_N[press] *= 0.8
    found = verdict(ranges(), readings)
    low = 1.6 * FORCES[press]
    assert found.level == "reads_low" and found.peaks_below == 1
    assert found.furthest_below_percent == pytest.approx(100 * (1 - readings.peak_N[press] / low))
    assert f"{FORCES[press]:g} N, {SPEEDS[press]:g} mm/s" in found.text


def test_low_in_some_and_high_in_other_presses_is_mixed_and_red():
    readings = pad()
    readings.peak_N[:3] *= 0.6
    readings.peak_N[3:] *= 1.6
    found = verdict(ranges(), readings)
    assert (found.level, found.light) == ("mixed", "red")
    assert "3 of 6 peaks are below every subject's" in found.text


@pytest.mark.parametrize("what", [{"peak": 1.5}, {"energy": 1.5}, {"depth": np.linspace(0.85, 1.0, 41)}])
def test_above_every_subject_reads_high_and_is_no_danger(what):
    found = verdict(ranges(), pad(**what))
    assert (found.level, found.light, found.acceptable) == ("reads_high", "amber", True)


def test_a_pad_stiffer_than_every_subject_almost_everywhere_is_poor():
    assert verdict(ranges(), pad(depth=0.8)).level == "poor"


def test_out_of_reach_is_poor_and_hides_nothing_low():
    readings = pad()
    readings.peak_N[[2, 5]] = np.nan
    readings.depth_mm[-5:] = np.nan
    assert verdict(ranges(), readings).level == "poor"
    readings.peak_N[0] *= 0.5
    assert verdict(ranges(), readings).level == "reads_low"
    nothing = Readings(np.full(6, np.nan), np.full(6, np.nan), np.full(41, np.nan))
    found = verdict(ranges(), nothing)
    assert found.level == "poor" and found.peaks == 0 and found.steady_fraction is None and found.energy_ratio is None


def test_a_stiff_pad_that_takes_less_energy_is_not_said_to_read_low():
    found = verdict(ranges(), pad(energy=0.5, depth=0.7))
    assert found.level == "mixed" and "unsafe side" in found.text


@pytest.mark.parametrize(("low", "out", "level"), [(0.0, 0.0, "inside"), (0.04, 0.0, "inside"), (0.06, 0.0, "mixed"),
                                                   (0.0, 0.3, "mixed"), (1.0, 0.0, "mixed")])  # fmt: skip
def test_a_pad_that_may_turn_out_low_is_not_called_inside(low, out, level):
    count = 200
    factor = np.ones((count, 1))
    factor[: round(low * count)] = 0.5
    factor[count - round(out * count) :] = 2.0
    middle = pad()
    energy, depth = (np.tile(values, (count, 1)) for values in (middle.energy_mJ, middle.depth_mm))
    spread = Readings(factor * middle.peak_N, energy, depth)
    found = verdict(ranges(), middle, spread)
    assert found.level == level and found.low_share == pytest.approx(low)
    assert found.acceptable and (level == "inside") == (found.light == "green")


def test_a_low_pad_stays_low_however_its_pours_may_turn_out():
    count = 50
    spread = Readings(*(np.tile(values, (count, 1)) for values in vars(pad()).values()))
    assert verdict(ranges(), pad(peak=0.7), spread).level == "reads_low"


def test_one_subject_makes_no_range_so_nothing_is_inside_it():
    one = ranges(1, 1.0)
    same = verdict(one, pad(width=1.0))
    assert same.level == "mixed" and "one subject makes no range" in same.text
    assert verdict(one, pad(peak=0.9, width=1.0)).level == "reads_low"
    assert verdict(one, pad(peak=1.1, width=1.0)).level == "reads_high"


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    st.lists(st.floats(0.4, 2.5), min_size=6, max_size=6), st.lists(st.floats(0.4, 2.5), min_size=6, max_size=6),
    st.floats(0.7, 1.4), st.floats(1.0, 1.5), st.integers(0, 5),
)  # fmt: skip
def test_more_force_never_moves_a_pad_from_inside_to_low(peaks, energies, depth, more, press):
    start = pad()
    readings = Readings(start.peak_N * peaks, start.energy_mJ * energies, start.depth_mm * depth)
    raised = Readings(readings.peak_N.copy(), readings.energy_mJ.copy(), readings.depth_mm / more)
    raised.peak_N[press] *= more
    before, after = verdict(ranges(), readings), verdict(ranges(), raised)
    assert after.peaks_below <= before.peaks_below
    assert not (before.level == "inside" and after.level in ("reads_low", "poor"))
    assert before.low == (before.level in ("reads_low",) or (before.level == "mixed" and before.light == "red"))


@settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.floats(1e-3, 1e3), st.lists(st.floats(0.3, 3.0), min_size=6, max_size=6), st.floats(0.6, 1.5))
def test_forces_of_pad_and_subjects_times_the_same_factor_give_the_same_verdict(factor, peaks, depth):
    start = pad()
    readings = Readings(start.peak_N * peaks, start.energy_mJ, start.depth_mm * depth)
    scaled = Readings(readings.peak_N * factor, readings.energy_mJ * factor, readings.depth_mm)
    forces = ("force_N", "peak_low_N", "peak_high_N", "energy_low_mJ", "energy_high_mJ", "steady_N")
    same = dataclasses.replace(ranges(), **{name: factor * getattr(ranges(), name) for name in forces})
    assert verdict(same, scaled).level == verdict(ranges(), readings).level


def test_many_pads_at_once_get_the_levels_they_get_alone():
    factors = [(0.5, 1.0, 1.0), (1.0, 1.0, 1.0), (1.5, 1.0, 1.0), (1.0, 0.5, 0.7), (1.0, 1.0, 0.8)]
    pads = [pad(*factor) for factor in factors]
    every = Readings(*(np.stack([getattr(one, name) for one in pads]) for name in vars(pads[0])))
    assert levels(ranges(), every) == [verdict(ranges(), one).level for one in pads]


@pytest.fixture(scope="module")
def sampling():
    return Sampling(24, 12, 30)


def slabs_of(law, young_MPa, thickness_mm, beta=(0.6, 0.5)):
    """Slabs of one thickness and several moduli that relax in 0.03 and 0.5 s."""
    young = np.atleast_1d(young_MPa)
    curves = make_curves(law, [thickness_mm], RADIUS_MM)
    return Slabs(curves, np.zeros(len(young), int), young, (0.03, 0.5), np.tile(beta, (len(young), 1)))


def judged(slabs, tissue, sampling):
    targets = make_targets(tissue, "average", sampling)
    evaluation = evaluate(slabs, targets, sampling)
    band = ranges_of(targets)
    return [
        verdict(band, reading_of(Candidate(5.0, 15.0, index, evaluation, None, 0.0, 0.0)))
        for index in range(len(slabs.slab))
    ]


@pytest.mark.parametrize("thickness_mm", [4.0, 6.0, 9.0])
@pytest.mark.parametrize("beta", [(0.3, 0.3), (0.6, 0.5), (1.0, 0.5)])
def test_a_stiffer_pad_never_goes_from_inside_to_low(layer_law, finger, sampling, thickness_mm, beta):
    young = np.geomspace(0.005, 0.2, 40)
    found = [item.level for item in judged(slabs_of(layer_law, young, thickness_mm, beta), finger, sampling)]
    if "inside" in found:
        assert "reads_low" not in found[found.index("inside") :]
    assert set(found) <= set(LEVELS)


def test_a_pad_that_hardly_relaxes_reads_low_at_any_modulus_that_follows_the_steady_curve(layer_law, finger, sampling):
    found = judged(slabs_of(layer_law, np.geomspace(0.01, 0.1, 15), 6.0, (0.02, 0.02)), finger, sampling)
    assert all(item.level != "inside" for item in found)
    assert any(item.level == "reads_low" and item.peaks_below == 6 for item in found)


def test_one_person_is_followed_and_never_called_a_range(layer_law, sampling):
    found = judged(slabs_of(layer_law, np.geomspace(0.01, 0.1, 15), 6.0), make_tissue((1.2,)), sampling)
    assert all(item.level != "inside" and item.subjects == 1 for item in found)


def test_the_safe_side_is_kept_when_nothing_is_below_the_highest_subject():
    band = ranges()
    high = Readings(band.peak_high_N * 1.001, band.energy_high_mJ, band.stiff_mm)
    assert safe_side_shortfall(band, high)[0] == pytest.approx(0.0, abs=1e-12)
    low = Readings(band.peak_high_N * np.array([1, 1, 0.9, 1, 1, 1]), band.energy_high_mJ, band.stiff_mm)
    assert safe_side_shortfall(band, low)[0] == pytest.approx(0.1)
    soft = Readings(high.peak_N, band.energy_high_mJ, band.stiff_mm * 1.25 ** (1 / 3))
    assert safe_side_shortfall(band, soft)[0] == pytest.approx(0.2)
    far = Readings(np.where(np.arange(6) == 2, np.nan, high.peak_N), high.energy_mJ, high.depth_mm)
    assert np.isinf(safe_side_shortfall(band, far)[0])
