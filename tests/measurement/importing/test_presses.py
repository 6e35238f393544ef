"""Signs, tare, contact and parts of a recording, held against presses of known law, contact and noise."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.core.decisions import Notes, QuestionError, Settings
from dummydesign.measurement.importing.press.contact import find_contact
from dummydesign.measurement.importing.press.sanity import check_press
from dummydesign.measurement.importing.press.signs import find_signs, middle_of_three, noise_of
from dummydesign.measurement.importing.press.split import find_presses
from dummydesign.measurement.importing.press.summary import summarise
from dummydesign.measurement.importing.press.zero import FILTER_DELAY_S, find_contacts, find_tares, interval
from tests.support.machine_presses import recording


def parts_of(record, tare=0.0, place=0.0):
    x, force = record.displacement_mm + place, record.force_N + tare
    signs = find_signs("a.csv", x, force, Settings(), None, Notes())
    load = signs.force * (force - signs.rest_force_N)
    spans = find_presses("a.csv", signs.displacement * x, load, True)
    return signs, spans, [find_contact(record.time_s, signs.displacement * x, load, span) for span in spans]


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize("push", [1.0, -1.0])
def test_compression_is_made_positive_whatever_the_file_counts(way, push):
    record = recording(1, velocity_mm_s=10.0)
    x, force = way * (record.displacement_mm + 120.0), push * (record.force_N + 1.7)
    signs = find_signs("a.csv", x, force, Settings(), None, Notes())
    assert (signs.displacement, signs.force) == (way, push)
    assert signs.rest_force_N == pytest.approx(push * 1.7, abs=4 * record.noise_N)


def test_given_signs_are_taken_and_wrong_ones_refused():
    record = recording(1, velocity_mm_s=10.0)
    both = frozenset({"displacement", "force"})
    signs = find_signs("a.csv", -record.displacement_mm, -record.force_N, Settings(flip=both), None, Notes())
    assert (signs.displacement, signs.force) == (-1.0, -1.0)
    for flip in ({"displacement"}, {"force"}):
        with pytest.raises(InputError, match=r"with --flip as given"):
            find_signs("a.csv", record.displacement_mm, record.force_N, Settings(flip=frozenset(flip)), None, Notes())


def test_a_force_that_swings_both_ways_is_asked_about():
    record = recording(1, velocity_mm_s=10.0)
    force = record.force_N.copy()
    force[-200:] = -0.8 * force.max()
    with pytest.raises(QuestionError, match=r"--flip force .* --flip none"):
        find_signs("a.csv", record.displacement_mm, force, Settings(), None, Notes())


def test_a_recording_that_begins_pressed_is_no_press_of_the_other_sign():
    record = recording(1, velocity_mm_s=10.0, unload=True)
    late = record.force_N.argmax() + 500
    with pytest.raises(QuestionError, match="begins pressed"):
        find_signs("a.csv", record.displacement_mm[late:], record.force_N[late:], Settings(), None, Notes())


@pytest.mark.parametrize("force", [np.zeros(500), np.full(500, 3.0), np.random.default_rng(1).normal(0, 0.01, 500)])
def test_nothing_pressed_says_so(force):
    x = np.linspace(-1.0, 5.0, 500)
    with pytest.raises(InputError, match="nothing is pressed"):
        find_signs("a.csv", x, force, Settings(), None, Notes())


def test_single_spikes_do_not_survive_the_middle_of_three_and_edges_do():
    values = np.r_[np.zeros(10), 5.0, np.zeros(10), np.ones(10)]
    assert np.array_equal(middle_of_three(values), np.r_[np.zeros(21), np.ones(10)])


def test_noise_is_told_beside_a_smooth_force():
    force = 3.0 * np.linspace(0, 1, 4000) ** 3 + np.random.default_rng(2).normal(0.0, 0.02, 4000)
    assert noise_of(force) == pytest.approx(0.02, rel=0.05)


@pytest.mark.parametrize("presses", [1, 2, 3])
@pytest.mark.parametrize("seed", range(6))
def test_presses_are_parted_where_the_punch_is_out_and_hold_all_samples(seed, presses):
    record = recording(seed, presses)
    _, spans, _ = parts_of(record)
    assert len(spans) == presses
    assert spans[0].start == 0 and spans[-1].stop == len(record.time_s)
    assert all(a.stop == b.start for a, b in pairwise(spans))
    cuts = [span.start for span in spans[1:]]
    assert np.all(record.displacement_mm[cuts] < 0) and np.all(np.abs(record.true_force_N[cuts]) < 1e-6)


def test_a_lost_signal_within_a_hold_parts_nothing():
    record = recording(3, velocity_mm_s=10.0)
    force = record.force_N.copy()
    middle = int(np.argmax(force)) + 300
    force[middle : middle + 20] = 0.0
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 1


def test_presses_are_parted_although_the_zero_of_the_force_drifts():
    record = recording(4, presses=3, velocity_mm_s=10.0)
    drift = 0.08 * record.force_N.max() * record.time_s / record.time_s[-1]
    assert len(find_presses("a.csv", record.displacement_mm, record.force_N + drift, True)) == 3


def test_presses_on_a_surface_that_pulls_are_parted():
    record = recording(4, presses=2, velocity_mm_s=10.0)
    leaving = np.r_[np.diff(record.displacement_mm) < -0.005, False] & (record.displacement_mm > -0.5)
    force = np.where(leaving & (record.force_N < 1.0), -1.5, record.force_N)
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 2


def test_a_jolt_of_the_robot_in_the_air_is_no_press():
    record = recording(5, velocity_mm_s=10.0)
    force = record.force_N.copy()
    start = int(np.argmax(np.diff(record.displacement_mm) > 0.01))
    force[start : start + 8] += 0.15 * force.max()
    assert len(find_presses("a.csv", record.displacement_mm, force, True)) == 1


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("place", [0.0, 0.7, -321.4])
def test_contact_is_found_for_every_power_law(power, place):
    time = np.arange(0, 2.0, 0.002)
    x = np.clip(-2.0 + 10.0 * (time - 0.4), -2.0, 5.0)
    force = 15.0 * (np.maximum(x, 0.0) / 5.0) ** power
    noise = np.random.default_rng(int(10 * power)).normal(0.0, 0.01, len(time))
    load = force + noise
    spans = find_presses("a.csv", x + place, load, True)
    contact = find_contact(time, x + place, load, spans[0])
    assert contact.position_mm == pytest.approx(place, abs=0.05 if power < 2.5 else 0.15)
    assert contact.low_mm < place < contact.high_mm
    assert contact.tare_N == pytest.approx(0.0, abs=contact.tare_error_N)
    assert contact.velocity_mm_s == pytest.approx(10.0, rel=0.01)


def test_without_noise_contact_is_exact():
    time = np.arange(0, 2.0, 0.001)
    x = np.clip(-1.0 + 10.0 * (time - 0.3), -1.0, 5.0)
    load = np.maximum(x - 0.25, 0.0) ** 1.5
    contact = find_contact(time, x, load, find_presses("a.csv", x, load, True)[0])
    assert contact.position_mm == pytest.approx(0.25, abs=0.01)


@pytest.mark.slow
def test_intervals_of_contact_hold_the_truth_as_often_as_they_say():
    inside, off = [], []
    for seed in range(5000, 5200):
        record = recording(seed, velocity_mm_s=[2.0, 10.0, 50.0][seed % 3])
        low, high = interval(parts_of(record)[2][0])
        inside.append(low <= 0.0 <= high)
        off.append(parts_of(record)[2][0].position_mm)
    assert np.mean(inside) >= 0.95
    assert np.sqrt(np.mean(np.square(off))) < 0.15


def contacts_of(seed=2, place=0.0, **options):
    record = recording(seed, velocity_mm_s=options.pop("velocity", 10.0), filtered=False, **options)
    signs, spans, contacts = parts_of(record, place=place)
    x = record.displacement_mm + place
    depths = [float(x[s.start : s.stop].max()) - c.position_mm for s, c in zip(spans, contacts)]
    return contacts, depths, float(x[0]), signs


def test_the_own_zero_of_a_file_stands_where_the_force_agrees():
    contacts, depths, first, _ = contacts_of()
    notes = Notes()
    assert find_contacts("a.csv", contacts, depths, first, 1.0, notes) == [0.0]
    assert notes.decisions[0].value == "the file's own zero"


def test_a_zero_half_a_millimetre_off_is_moved_to_the_contact():
    contacts, depths, first, _ = contacts_of(seed=6, place=0.5)
    found = find_contacts("a.csv", contacts, depths, first, 1.0, Notes())
    assert found[0] == pytest.approx(0.5, abs=0.05)


def test_a_fast_press_in_unknown_coordinates_is_asked_about_and_a_slow_one_beside_it_answers():
    fast, depths, first, _ = contacts_of(seed=6, velocity=250.0, place=200.0)
    assert interval(fast[0])[0] == pytest.approx(fast[0].low_mm - FILTER_DELAY_S * fast[0].velocity_mm_s)
    with pytest.raises(QuestionError, match="--contact"):
        find_contacts("a.csv", fast, depths, first, 1.0, Notes())
    slow, more, _, _ = contacts_of(seed=6, place=200.0)
    found = find_contacts("a.csv", [*fast, *slow], [*depths, *more], first, 1.0, Notes())
    assert found == pytest.approx([200.0, 200.0], abs=0.05)


def test_a_dent_that_is_left_is_told_and_does_not_move_the_surface():
    contacts, depths, first, _ = contacts_of(seed=6)
    later, more, _, _ = contacts_of(seed=6, place=0.4)
    notes = Notes()
    assert find_contacts("a.csv", [*contacts, *later], [*depths, *more], first, 1.0, notes) == [0.0, 0.0]
    assert [warning["code"] for warning in notes.warnings] == ["surface_not_back"]


def test_a_press_at_another_place_gets_a_zero_of_its_own():
    contacts, depths, first, _ = contacts_of(seed=6)
    other, more, _, _ = contacts_of(seed=6, place=-3.0)
    notes = Notes()
    found = find_contacts("a.csv", [*contacts, *other], [*depths, *more], first, 1.0, notes)
    assert found == pytest.approx([0.0, -3.0], abs=0.05)
    assert [warning["code"] for warning in notes.warnings] == ["another_place"]


def test_the_lead_in_tares_and_a_tared_file_is_left_alone():
    record = recording(7, velocity_mm_s=10.0, lead_in=True)
    signs, _, contacts = parts_of(record, tare=0.8)
    assert find_tares("a.csv", contacts, signs.rest_force_N, False, Notes())[0] == pytest.approx(0.8, abs=0.02)
    quiet = recording(7, velocity_mm_s=10.0)
    signs, _, contacts = parts_of(quiet)
    assert find_tares("a.csv", contacts, signs.rest_force_N, False, Notes()) == [0.0]


def test_without_a_lead_in_a_force_at_the_start_is_asked_about():
    record = recording(7, velocity_mm_s=10.0, lead_in=False)
    signs, _, contacts = parts_of(record)
    assert contacts[0].lead_in < 5
    assert find_tares("a.csv", contacts, signs.rest_force_N, False, Notes()) == [0.0]
    signs, _, contacts = parts_of(record, tare=0.8)
    with pytest.raises(QuestionError, match=r"--tare .* --tare none"):
        find_tares("a.csv", contacts, signs.rest_force_N, False, Notes())


def test_a_zero_that_wanders_from_press_to_press_is_tared_press_by_press():
    record = recording(8, presses=2, velocity_mm_s=10.0)
    _, spans, _ = parts_of(record)
    tare = np.where(np.arange(len(record.time_s)) < spans[1].start, 0.3, 0.5)
    signs, _, contacts = parts_of(record, tare=tare)
    notes = Notes()
    found = find_tares("a.csv", contacts, signs.rest_force_N, False, notes)
    assert found == pytest.approx([0.3, 0.5], abs=0.04)
    assert [warning["code"] for warning in notes.warnings] == ["zero_wanders"]


def checked(time, x, force):
    """Codes of what looks wrong in one press."""
    codes = []
    span = find_presses("a.csv", x, force, True)[0]
    contact = find_contact(time, x, force, span)
    summary = summarise("a.csv", time, x, force)
    check_press("a.csv", time, x, force, contact, summary, lambda code, text: codes.append(code))
    return codes


@pytest.fixture
def press():
    """A slow ball press with a long hold, as arrays that a test may damage."""
    rng = np.random.default_rng(11)
    time = np.arange(0, 12.0, 0.004)
    x = np.clip(-1.0 + 5.0 * (time - 0.4), -1.0, 4.0)
    force = 2.0 * np.maximum(x, 0) ** 1.5 * np.where(time > 1.4, 0.8 + 0.2 * np.exp(-(time - 1.4) / 0.4), 1.0)
    return time, x + rng.normal(0, 0.0005, len(x)), force + rng.normal(0, 0.01, len(x))


def test_a_good_press_gives_no_warning(press):
    assert checked(*press) == []


def test_a_load_cell_at_its_end_is_told(press):
    time, x, force = press
    assert "clipped" in checked(time, x, np.minimum(force, 11.0))


def test_a_coarse_resolution_is_not_taken_for_a_load_cell_at_its_end(press):
    time, x, force = press
    assert checked(time, x, np.round(force, 1)) == []


def test_single_samples_far_off_are_told(press):
    time, x, force = press
    force[[900, 1500]] += 4.0
    assert checked(time, x, force) == ["spike"]


def test_a_force_that_is_lost_in_the_hold_is_told(press):
    time, x, force = press
    force[1000:1010] = 0.0
    assert "drop_out" in checked(time, x, force)


def test_missing_samples_in_the_rise_are_told_and_a_sparser_hold_is_not(press):
    time, x, force = press
    keep = np.r_[0:200, 240 : len(time)]
    assert "drop_out" in checked(time[keep], x[keep], force[keep])
    keep = np.r_[0:500, 500 : len(time) : 25]
    assert checked(time[keep], x[keep], force[keep]) == []


def test_a_short_hold_whose_force_still_falls_is_told(press):
    time, x, force = press
    keep = time < 2.4
    assert checked(time[keep], x[keep], force[keep]) == ["hold_too_short"]


def test_a_staircase_is_told(press):
    time, _, _ = press
    x = np.interp(time, [0, 0.4, 1.0, 4.0, 4.4, 8.0, 8.4, 12.0], [-1, -1, 2, 2, 3, 3, 4, 4])
    assert "several_holds" in checked(time, x, 2.0 * np.maximum(x, 0) ** 1.5)


@pytest.mark.parametrize("change", ["grams", "inches"])
def test_a_press_far_from_any_hand_or_pad_is_doubted(press, change):
    time, x, force = press
    x, force = (x, force / 9.80665e-3) if change == "grams" else (x / 25.4, force)
    assert "far_from_known" in checked(time, x, force)
