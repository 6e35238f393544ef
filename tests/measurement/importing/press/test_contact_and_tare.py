"""Contact and tare of a press, held against presses of known law, contact and noise."""

from __future__ import annotations

import re

import numpy as np
import pytest

from dummydesign.measurement.importing.contact import FILTER_DELAY_S, find_contact, find_contacts, find_tares, interval
from dummydesign.measurement.importing.decisions import ImportLog, QuestionError, Settings
from dummydesign.measurement.importing.read import import_files
from dummydesign.measurement.importing.sign_convention import find_presses
from tests.support.machine_presses import recording
from tests.support.parted_press import parts_of
from tests.support.refusal import raises_code


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
    assert contact.baseline.mean_N == pytest.approx(0.0, abs=contact.baseline.error_N)
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
    notes = ImportLog("a.csv")
    assert find_contacts(contacts, depths, first, 1.0, notes) == [0.0]
    assert notes.decisions[0].value == "the file's own zero"


def test_a_zero_half_a_millimetre_off_is_moved_to_the_contact():
    contacts, depths, first, _ = contacts_of(seed=6, place=0.5)
    found = find_contacts(contacts, depths, first, 1.0, ImportLog("a.csv"))
    assert found[0] == pytest.approx(0.5, abs=0.05)


def test_a_fast_press_in_unknown_coordinates_is_asked_about_and_a_slow_one_beside_it_answers():
    fast, depths, first, _ = contacts_of(seed=6, velocity=250.0, place=200.0)
    assert interval(fast[0])[0] == pytest.approx(fast[0].low_mm - FILTER_DELAY_S * fast[0].velocity_mm_s)
    with raises_code("needs_decision", "contact"):
        find_contacts(fast, depths, first, 1.0, ImportLog("a.csv"))
    slow, more, _, _ = contacts_of(seed=6, place=200.0)
    found = find_contacts([*fast, *slow], [*depths, *more], first, 1.0, ImportLog("a.csv"))
    assert found == pytest.approx([200.0, 200.0], abs=0.05)


def saved(folder, name, place, seed=6, velocity=10.0):
    """A press of a machine whose zero is elsewhere, counted along the press or against it."""
    record = recording(seed, velocity_mm_s=velocity, filtered=False)
    columns = record.time_s, record.displacement_mm + place, record.force_N
    path = folder / name
    np.savetxt(path, np.column_stack(columns), "%.6f", ",", header="time_s,position_mm,force_N", comments="")
    return path


def test_fast_files_take_the_zero_of_the_slow_ones_of_their_name(tmp_path):
    """subjects at 200 and 220 mm, each pressed at 10 and 250 mm/s: every trace begins at its own surface"""
    for who, place in (("ann", 200.0), ("ben", 220.0)):
        for velocity in (10.0, 250.0):
            saved(tmp_path, f"{who}_v{velocity:03.0f}.csv", place, velocity=velocity)
    imported, warnings = import_files([tmp_path])
    zeros = {one.source.name: one.presses[0].zero_mm for one in imported}
    assert [*zeros] == ["ann_v010.csv", "ann_v250.csv", "ben_v010.csv", "ben_v250.csv"]
    assert [*zeros.values()] == pytest.approx([200.0, 200.0, 220.0, 220.0], abs=0.05)
    assert [one["code"] for one in warnings].count("contact_of_slower_presses") == 1
    decided = [one.value for one in imported[3].decisions if one.what == "contact"]
    (typed,), _ = import_files([imported[3].source], Settings(contact=decided[0].removesuffix(" mm")))
    assert typed.presses[0].displacement_mm == pytest.approx(imported[3].presses[0].displacement_mm, abs=1e-9)


@pytest.mark.parametrize("others", [(201.0, 200.0), (203.5,)])
def test_slow_files_that_contradict_each_other_or_the_force_do_not_give_a_zero(tmp_path, others):
    saved(tmp_path, "a_fast.csv", 200.0, velocity=250.0)
    for number, place in enumerate(others):
        saved(tmp_path, f"a_slow{number}.csv", place)
    with raises_code("needs_decision", "contact"):
        import_files([tmp_path])


def test_a_dent_that_is_left_is_told_and_does_not_move_the_surface():
    contacts, depths, first, _ = contacts_of(seed=6)
    later, more, _, _ = contacts_of(seed=6, place=0.4)
    notes = ImportLog("a.csv")
    assert find_contacts([*contacts, *later], [*depths, *more], first, 1.0, notes) == [0.0, 0.0]
    assert [warning["code"] for warning in notes.warnings] == ["surface_not_back"]


def test_a_press_at_another_place_gets_a_zero_of_its_own():
    contacts, depths, first, _ = contacts_of(seed=6)
    other, more, _, _ = contacts_of(seed=6, place=-3.0)
    notes = ImportLog("a.csv")
    found = find_contacts([*contacts, *other], [*depths, *more], first, 1.0, notes)
    assert found == pytest.approx([0.0, -3.0], abs=0.05)
    assert [warning["code"] for warning in notes.warnings] == ["another_place"]


def levels(contacts, signs, log):
    return [one.level_N for one in find_tares(contacts, signs.rest_force_N, 1.0, log)]


def test_the_lead_in_tares_and_a_tared_file_is_left_alone():
    record = recording(7, velocity_mm_s=10.0, lead_in=True)
    signs, _, contacts = parts_of(record, tare=0.8)
    assert levels(contacts, signs, ImportLog("a.csv")) == pytest.approx([0.8], abs=0.02)
    quiet = recording(7, velocity_mm_s=10.0)
    signs, _, contacts = parts_of(quiet)
    assert levels(contacts, signs, ImportLog("a.csv")) == [0.0]


def test_without_a_lead_in_a_force_at_the_start_is_asked_about():
    record = recording(7, velocity_mm_s=10.0, lead_in=False)
    signs, _, contacts = parts_of(record)
    assert contacts[0].baseline.samples < 5
    assert levels(contacts, signs, ImportLog("a.csv")) == [0.0]
    signs, _, contacts = parts_of(record, tare=0.8)
    with raises_code("needs_decision", "tare"):
        levels(contacts, signs, ImportLog("a.csv"))


def test_a_zero_that_wanders_from_press_to_press_is_tared_press_by_press():
    record = recording(8, presses=2, velocity_mm_s=10.0)
    _, spans, _ = parts_of(record)
    tare = np.where(np.arange(len(record.time_s)) < spans[1].start, 0.3, 0.5)
    signs, _, contacts = parts_of(record, tare=tare)
    notes = ImportLog("a.csv")
    found = levels(contacts, signs, notes)
    assert found == pytest.approx([0.3, 0.5], abs=0.04)
    assert [warning["code"] for warning in notes.warnings] == ["zero_wanders"]


UNITS = {"N": 1.0, "kN": 1e-3, "lbf": 1.0 / 4.4482216152605}


def written(folder, seed):
    """A file of a press with an offset of force and place, signs and unit that are drawn; without them it is whole."""
    draw = np.random.default_rng(seed)
    record = recording(seed, velocity_mm_s=float(draw.choice([2.0, 10.0])), lead_in=bool(draw.random() < 0.8))
    tare, place = float(draw.choice([0.15, -0.7, -152.3456])), float(draw.choice([0.0, 0.4, -31.123]))
    signs, unit = draw.choice([-1, 1], 2), str(draw.choice(list(UNITS)))
    x, force = signs[0] * (record.displacement_mm + place), signs[1] * (record.force_N + tare) * UNITS[unit]
    rows = (f"{a:.6f},{b:.6f},{c:.9g}" for a, b, c in zip(record.time_s, x, force))
    path = folder / f"r{seed}.csv"
    path.write_text("\n".join([f"time (s),displacement (mm),force ({unit})", *rows]) + "\n", encoding="utf-8")
    return path, record


def imported(path, **settings):
    (one,), _ = import_files([path], Settings(**settings))
    return one


@pytest.mark.parametrize("seed", range(900, 912))
def test_a_number_that_an_import_shows_gives_the_same_traces_when_it_is_typed(tmp_path, seed):
    path, record = written(tmp_path, seed)
    try:
        first = imported(path)
    except QuestionError as question:
        option, number = re.findall(r"--(tare|contact) (-?\d[\d.]*)", str(question))[-1]
        found = imported(path, **{option: number}).presses[0]
        begins = {"tare": found.force_N[0] - record.true_force_N[0], "contact": 0.0}[option]
        assert abs(begins) < 6.0 * record.noise_N
        return
    for made in first.decisions:
        number = re.match(r"-?\d[\d.]*", made.value)
        if made.what in ("tare", "contact") and number:
            for one, other in zip(first.presses, imported(path, **{made.what: number[0]}).presses, strict=True):
                assert np.abs(one.force_N - other.force_N).max() < 1e-9
                assert np.abs(one.displacement_mm - other.displacement_mm).max() < 1e-9
