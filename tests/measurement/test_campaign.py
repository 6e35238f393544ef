"""Campaign folders: what is read, and that every fault is refused with file and line."""

from __future__ import annotations

import numpy as np
import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.measurement.ramp_detection import find_ramp

HEAD = """schema = 1
name = "small"
[pad]
young_kPa_nominal = 25.0
base = "bonded"
[punch]
shape = "square"
side_mm = 14.0
contact = "bonded"
[sensor]
lowpass_hz = 35.0
"""
TRIAL = """[[trial]]
file = "{file}"
thickness_mm = 15.0
velocity_mm_s = 10.0
target_force_N = 4.0
repeat = {repeat}
sequence = {sequence}
rest_s = 60.0
temperature_C = 23.0
age_days = 7.0
"""


def press(scale_x: float = 1.0, scale_f: float = 1.0) -> np.ndarray:
    time = np.arange(-0.1, 2.0, 0.004)
    x = np.clip(10.0 * time, -1.0, 3.0)
    force = np.maximum(x, 0.0) * 1.4
    return np.column_stack([time + 0.1, x * scale_x, force * scale_f])


def write(folder, trials=2, text=None, **scales):
    for number in range(trials):
        rows = "\n".join(f"{t:.4f},{x:.6f},{f:.6f}" for t, x, f in press(**scales))
        (folder / f"t{number}.csv").write_text("time_s,displacement_mm,force_N\n" + rows + "\n")
    body = HEAD + "".join(TRIAL.format(file=f"t{n}.csv", repeat=n + 1, sequence=n + 1) for n in range(trials))
    (folder / "campaign.toml").write_text(text(body) if text else body)
    return folder


def refused(folder, *words):
    with pytest.raises(InputError) as problem:
        read_campaign(folder)
    for word in words:
        assert word in str(problem.value), str(problem.value)


def test_a_sound_campaign_is_read_with_all_that_it_declares(tmp_path):
    campaign = read_campaign(write(tmp_path))
    assert [t.file for t in campaign.trials] == ["t0.csv", "t1.csv"]
    assert campaign.lowpass.cutoff_hz == 35.0 and campaign.lowpass.order == 2 and campaign.lowpass.passes == 1
    assert campaign.trials[1].sequence == 2 and campaign.trials[0].age_days == 7.0
    assert campaign.punch.radius_mm == pytest.approx(14.0 / np.sqrt(np.pi))
    assert [one["code"] for one in campaign.warnings] == ["no_ratio"]


def test_a_campaign_with_its_ratio_is_not_warned_of(tmp_path):
    folder = write(tmp_path, text=lambda s: s.replace("[pad]\n", "[pad]\nratio = 15.0\n"))
    assert read_campaign(folder).warnings == ()


def test_what_is_not_declared_is_said(tmp_path):
    folder = write(tmp_path, text=lambda s: s.replace("temperature_C = 23.0\n", "", 1).replace("sequence", "#"))
    codes = {w["code"] for w in read_campaign(folder).warnings}
    assert {"no_temperature_C", "no_sequence"} <= codes


def test_missing_folder_and_missing_toml_are_refused(tmp_path):
    refused(tmp_path / "none", "does not exist")
    refused(tmp_path, "has no campaign.toml")


def test_a_missing_trace_is_refused_with_the_line_that_names_it(tmp_path):
    folder = write(tmp_path)
    (folder / "t1.csv").unlink()
    refused(folder, "campaign.toml:23", "t1.csv", "does not exist")


@pytest.mark.parametrize("name", ["../t1.csv", "/etc/hostname", "sub/t1.csv", "..", "a\\\\b.csv"])
def test_a_path_that_leaves_the_folder_is_refused(tmp_path, name):
    folder = write(tmp_path, text=lambda s: s.replace('"t1.csv"', f'"{name}"'))
    refused(folder, "campaign.toml:23", "leaves the campaign folder")


def test_a_link_that_leaves_the_folder_is_refused(tmp_path):
    inside = tmp_path / "inside"
    inside.mkdir()
    write(inside)
    (tmp_path / "outside.csv").write_bytes((inside / "t1.csv").read_bytes())
    (inside / "t1.csv").unlink()
    (inside / "t1.csv").symlink_to(tmp_path / "outside.csv")
    refused(inside, "leaves the campaign folder")


def test_a_single_trial_is_refused(tmp_path):
    refused(write(tmp_path, trials=1), "single trial")


@pytest.mark.parametrize(
    ("scales", "word"),
    [
        ({"scale_f": 1000.0}, "mN or gf"),
        ({"scale_f": 250.0}, "millinewtons"),
        ({"scale_f": 1e-3}, "in kN"),
        ({"scale_x": 1e-3}, "in m"),
        ({"scale_x": 1000.0}, "in um"),
    ],
)
def test_other_units_are_seen_by_magnitude(tmp_path, scales, word):
    refused(write(tmp_path, **scales), "t0.csv", word)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("thickness_mm = 15.0", "thickness_mm = 0.015", ("campaign.toml:14", "thickness_mm", "0.5")),
        ("velocity_mm_s = 10.0", "velocity_mm_s = 0.01", ("campaign.toml:15", "m/s")),
        ("young_kPa_nominal = 25.0", "young_kPa_nominal = 25000.0", ("campaign.toml:4", "kPa")),
        ("thickness_mm = 15.0", 'thickness_mm = "thick"', ("campaign.toml:14", "finite number")),
        ("repeat = 1", "repeat = 0", ("campaign.toml:17", "repeat")),
        ("sequence = 2", "sequence = 1", ("campaign.toml:28", "already used by trial 1")),
        ('file = "t1.csv"', 'file = "t0.csv"', ("campaign.toml:23", "already used by trial 1")),
        ("rest_s", "rests", ("campaign.toml:19", "unknown key", "rest_s")),
        ('shape = "square"', 'shape = "sqare"', ("campaign.toml:7", "did you mean 'square'")),
        ('base = "bonded"', 'base = "glued"', ("campaign.toml:5", "bonded")),
        ("schema = 1", "schema = 2", ("schema",)),
        ("lowpass_hz = 35.0", "lowpass_hz = -3", ("campaign.toml:11", "lowpass_hz")),
        ("[[trial]]", "[[trial]", ("not valid TOML",)),
        ("thickness_mm = 15.0", "thickness_mm = 3.0", ("campaign.toml:14", "another unit")),
    ],
)
def test_faults_of_the_description_name_their_line(tmp_path, old, new, words):
    refused(write(tmp_path, text=lambda s: s.replace(old, new, 1)), *words)


def test_unsorted_times_are_refused_with_file_and_line(tmp_path):
    folder = write(tmp_path)
    lines = (folder / "t1.csv").read_text().splitlines()
    lines[100], lines[101] = lines[101], lines[100]
    (folder / "t1.csv").write_text("\n".join(lines))
    refused(folder, "t1.csv:102", "does not increase")


def test_landmarks_ignore_a_robot_that_creeps_after_the_stop():
    time = np.arange(0.0, 10.5, 1e-3)
    contact, speed, depth = 0.1, 120.0, 0.58
    x = np.minimum(speed * (time - contact), depth)
    creep = np.where(time > contact + depth / speed, 0.02 * np.clip(time - 0.2, 0, 5) / 5, 0.0)
    found = find_ramp(time, np.round((x + creep) / 0.005) * 0.005, "slowed")
    assert found.contact_time_s == pytest.approx(contact, abs=1e-3)
    assert found.stop_time_s == pytest.approx(contact + depth / speed, abs=2e-3)
    assert found.hold_end_s == pytest.approx(time[-1])


def test_the_hold_ends_where_the_punch_leaves():
    time = np.arange(0.0, 12.0, 2e-3)
    x = np.minimum(10.0 * (time - 0.1), 4.0)
    x = np.where(time > 10.0, 4.0 - 10.0 * (time - 10.0), x)
    assert find_ramp(time, x, "slowed").hold_end_s == pytest.approx(10.0, abs=5e-3)
