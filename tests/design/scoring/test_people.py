"""People by the subjects of a tissue: shares below a pad's peaks, the strict bounds of an aim, refusals."""

import dataclasses
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from dummydesign.cli.entry import run
from dummydesign.core.quantity import Quantity
from dummydesign.design.measured_pad import shares_of_traces
from dummydesign.design.scoring.press_simulation import Sampling
from dummydesign.design.scoring.settings import weights_of
from dummydesign.design.scoring.targets import make_targets, people_warnings, shares_below
from dummydesign.design.scoring.verdict import Readings, deviations, ranges_of, verdict
from dummydesign.measurement.motion import ramp_and_hold
from dummydesign.measurement.trace import Trace
from dummydesign.report.suggest_facts import people_text
from dummydesign.tissue import load_tissue
from dummydesign.tissue.adding.from_springs import spring_tissue
from dummydesign.tissue.comparison import ComparedPress
from dummydesign.tissue.fitting.reduction import reduce_trace
from dummydesign.tissue.model.people_share import tolerance_factor
from dummydesign.tissue.model.tissue import Subject
from tests.support.refusal import raises_code
from tests.support.slab_by_formula import make_tissue

ARMS = (0.4, 0.55, 0.6, 0.75, 0.9)


def measured(arms=ARMS, wide=1.0, kind="fitted"):
    """Subjects whose arms are unlike, so that their peaks at one steady force are; numbers known to a factor."""
    tissue = make_tissue(tuple(1.0 + 0.1 * n for n in range(len(arms))), law="ode")
    subjects = []
    for subject, arm in zip(tissue.subjects, arms):
        g = subject.numbers["gamma1_N_per_mm3"].value
        values = {
            "gamma1_N_per_mm3": g,
            "gamma2_N_per_mm3": 0.5 * arm * g,
            "gamma3_N_per_mm3": arm * g,
            "c2_N_s_per_mm": {"10": 0.5 * arm * g, "250": 0.25 * arm * g},
            "c3_N_s_per_mm": {"10": 0.15 * arm * g, "250": 0.03 * arm * g},
        }

        def quantity(value):
            return Quantity(value, value / wide, value * wide, kind, "test")

        numbers = {
            key: {speed: quantity(one) for speed, one in value.items()} if isinstance(value, dict) else quantity(value)
            for key, value in values.items()
        }
        subjects.append(Subject.of(subject.name, "ode", numbers))
    return dataclasses.replace(tissue, law="ode", subjects=tuple(subjects))


@pytest.fixture(scope="module")
def tissue():
    made = measured(ARMS[:3]), measured(ARMS[2:])
    return dataclasses.replace(made[0], subjects=(*made[0].subjects[:2], *made[1].subjects))


def peaks_of(targets):
    return np.array([one.range.curves_N.max(axis=-1) for one in targets.conditions])


def test_a_share_is_that_of_the_subjects_peaks_in_each_press(tissue):
    targets = make_targets(tissue, "average", Sampling())
    logs = np.log(peaks_of(targets))
    found = shares_below(targets, np.exp(logs.mean(axis=-1)))
    assert found.subjects == len(tissue.subjects) and found.reason is None and not found.inferred
    assert [one.below_expected for one in found.conditions] == pytest.approx([0.5] * 6, abs=1e-9)
    above = shares_below(targets, np.exp(logs.mean(axis=-1) + 2.0 * logs.std(axis=-1, ddof=1)))
    for one in above.conditions:
        assert 0.5 < one.below_90[0] < one.below_expected < one.below_90[1] <= 1.0
    unreached = shares_below(targets, np.full(6, np.nan))
    assert all(one.below_expected is None and one.below_90 is None for one in unreached.conditions)


def test_wide_intervals_of_the_subjects_numbers_widen_the_share(tissue):
    known, doubtful = (make_targets(measured(ARMS[:3], wide), "average", Sampling()) for wide in (1.0, 5.0))
    peak = 1.2 * peaks_of(known).max(axis=-1)
    one, two = (shares_below(targets, peak).conditions[0] for targets in (known, doubtful))
    assert two.below_90[0] < one.below_90[0] and two.below_expected < one.below_expected
    assert two.below_expected_if_exact == pytest.approx(one.below_expected)


def test_an_error_that_all_inferred_numbers_share_moves_everyone(tissue):
    own, shared = (
        make_targets(measured(ARMS[:3], 2.0, kind), "average", Sampling()) for kind in ("fitted", "inferred")
    )
    peak = 1.1 * peaks_of(own).max(axis=-1)
    widths = [np.diff(shares_below(targets, peak).conditions[3].below_90)[0] for targets in (own, shared)]
    assert widths[1] > widths[0]


def test_a_subject_pressed_at_a_speed_of_its_own_has_its_errors_counted_once():
    """A fast press of a short way may be read as 240 mm/s: what is known of the people stays the same."""
    alike = measured(ARMS[:3], wide=4.0)
    *others, last = alike.subjects
    own = {
        name: {("240" if speed == "250" else speed): one for speed, one in entry.items()}
        if isinstance(entry, dict)
        else entry
        for name, entry in last.numbers.items()
    }
    unlike = dataclasses.replace(alike, subjects=(*others, Subject.of(last.name, "ode", own)))
    found = [make_targets(one, "average", Sampling()).people.peak_N for one in (alike, unlike)]
    np.testing.assert_allclose(found[1].spread, found[0].spread, rtol=0.05)
    assert np.all(found[0].spread > 1.2 * make_targets(measured(ARMS[:3]), "average", Sampling()).people.peak_N.spread)


def test_the_aim_is_the_tolerance_bound_of_the_subjects_and_strict(tissue):
    targets = make_targets(tissue, "people:95", Sampling())
    ranges, logs = ranges_of(targets), np.log(peaks_of(targets))
    factor = tolerance_factor(len(tissue.subjects), 0.95)
    np.testing.assert_allclose(np.log(ranges.peak_high_N), logs.mean(axis=-1) + factor * logs.std(axis=-1, ddof=1))
    depth = np.log(targets.subject_depths_mm(targets.protocol.steady_grid_N))
    np.testing.assert_allclose(np.log(ranges.stiff_mm), depth.mean(axis=0) - factor * depth.std(axis=0, ddof=1))
    assert ranges.strict and (ranges.peak_high_N > logs.max(axis=-1)).all()
    highest = ranges_of(make_targets(tissue, "safe-side", Sampling()))
    np.testing.assert_allclose(ranges.peak_low_N, highest.peak_low_N)
    just_below = Readings(0.97 * ranges.peak_high_N, highest.energy_high_mJ, 0.999 * ranges.stiff_mm)
    assert deviations(ranges, just_below).shortfall[0] == pytest.approx(1.0 / 0.97)
    assert verdict(ranges, just_below).level == "not_representative"
    at = Readings(1.001 * ranges.peak_high_N, ranges.energy_high_mJ, 0.999 * ranges.stiff_mm)
    assert verdict(ranges, at, Readings(*(np.tile(one, (4, 1)) for one in vars(at).values()))).level == "stands_for"
    assert weights_of("people:95") is weights_of("safe-side")
    assert {code for code, _ in people_warnings(targets)} == {"people_bound"}
    assert people_warnings(make_targets(tissue, "safe-side", Sampling())) == []


@pytest.mark.slow
def test_a_larger_share_is_a_higher_bound(tissue):
    bounds = [ranges_of(make_targets(tissue, f"people:{p}", Sampling())).peak_high_N for p in (50, 80, 95, 99)]
    assert all((low < high).all() for low, high in pairwise(bounds))


def test_the_parameters_of_the_aim_reach_the_bound(tissue):
    targets = make_targets(tissue, "people:90", Sampling())
    ranges = ranges_of(targets)
    aims = np.array([one.aim_peak_N for one in targets.conditions])
    at_10 = ranges.force_N == 10.0
    ratio = aims[at_10] / ranges.peak_high_N[at_10]
    assert ratio.min() == pytest.approx(1.0, abs=0.01) and ratio.max() < 1.5
    grid = targets.protocol.steady_grid_N
    np.testing.assert_allclose(targets.aim_depth_mm(grid), ranges.stiff_mm, rtol=0.01)


def test_an_inferred_tissue_is_bounded_by_all_that_its_data_allow():
    targets = make_targets(load_tissue("forefinger"), "people:95", Sampling())
    stated = targets.people.stated.bound(0.95)
    assert (ranges_of(targets).peak_high_N > 1.2 * stated).all() and targets.drawn == ()
    wide = shares_below(targets, stated)
    assert wide.inferred
    assert all(one.below_90[1] - one.below_90[0] > 0.5 for one in wide.conditions)
    assert all(one.below_expected < one.below_expected_if_exact for one in wide.conditions)


def test_one_subject_and_a_spring_say_nothing_of_people():
    spring = spring_tissue("arm", 30.0, 5.0, "a standard", "digitised")
    for tissue in (make_tissue((1.0,)), spring):
        found = shares_below(make_targets(tissue, "average", Sampling()), np.ones(6))
        assert found.conditions == () and found.reason
        with raises_code("not_enough_data", "subjects"):
            make_targets(tissue, "people:95", Sampling())


def pressed_as(tissue, subject, speed):
    """The presses of a subject to 10 N, as those of a pad, repeated."""
    person = tissue.subjects[subject].parameters
    depth = float(np.cbrt(10.0 / person.gamma1_N_per_mm3))
    motion = ramp_and_hold(speed, depth)
    trace = reduce_trace(Trace("press.csv", motion.time_s, motion.displacement_mm, person.force(motion, speed)))
    band = tissue.force_range(trace.steady_force_N, speed, trace.hold_s, 30_000.0)
    return speed, (ComparedPress(trace, band, 30_000.0),) * 2


def test_a_measured_pad_that_is_a_subject_has_that_subjects_share(tissue):
    conditions = tuple(pressed_as(tissue, 4, speed) for speed in (10.0, 250.0))
    comparison = SimpleNamespace(conditions=conditions, noise_N=0.0)
    found = shares_of_traces(comparison, tissue)
    targets = make_targets(tissue, "average", Sampling())
    at_10 = [row for row, one in enumerate(targets.conditions) if one.steady_force_N == 10.0]
    wanted = shares_below(targets, peaks_of(targets)[:, 4])
    for mine, row in zip(found.conditions, at_10):
        assert mine.velocity_mm_s == wanted.conditions[row].velocity_mm_s
        assert mine.below_expected == pytest.approx(wanted.conditions[row].below_expected, abs=0.01)
        assert mine.below_90 == pytest.approx(wanted.conditions[row].below_90, abs=0.02)


def test_the_line_of_the_first_screen_is_of_the_press_with_the_least_share(tissue):
    targets = make_targets(tissue, "average", Sampling())
    peaks = peaks_of(targets).max(axis=-1)
    peaks[4] = peaks_of(targets)[4].mean()
    found = shares_below(targets, peaks)
    text = people_text(found.to_dict())
    least = found.conditions[4]
    assert f"{least.steady_force_N:g} N, {least.velocity_mm_s:g} mm/s" in text
    assert f"{100 * least.below_expected:.0f} % of people" in text and text.startswith("5 subjects")
    assert people_text(shares_below(make_targets(make_tissue((1.0,)), "average", Sampling()), peaks).to_dict()) == ""


@pytest.mark.parametrize("percent", ["0", "100", "abc", ""])
def test_a_wrong_share_is_one_line_and_status_2(percent, capsys):
    assert run(["suggest", "--tissue", "palm", "--aim", f"people:{percent}", "--no-cad"]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 1
