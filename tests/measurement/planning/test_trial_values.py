"""Values of trials written into campaign.toml: everything else of the file stays as it is."""

from __future__ import annotations

import tomllib

import pytest

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_presses import read_trials, write_trial_values
from tests.support.refusal import raises_code

TEXT = """# my own words
schema = 1
name = "first"  # of June

[pad]
young_kPa_nominal = 25.0

[[trial]]
file = "a.csv"
thickness_mm = 5.0   # gauged
velocity_mm_s = 10.0
target_force_N = 3.0
age_days = 9.0
# temperature_C =
sequence = 1

# the thick pad
[[trial]]
file = "b.csv"
thickness_mm = 15.0
velocity_mm_s = 250.0
target_force_N = 3.0
temperature_C = 21.5 # by the window
sequence = 2

[punch]
shape = "square"
side_mm = 14.0
"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "campaign.toml").write_text(TEXT, encoding="utf-8")
    return tmp_path


def content(folder):
    return (folder / "campaign.toml").read_text(encoding="utf-8")


def test_the_trials_are_read_with_empty_for_unknown(folder):
    first, second = read_trials(folder)
    assert first["file"] == "a.csv" and first["temperature_C"] is None and first["age_days"] == 9.0
    assert second["temperature_C"] == 21.5 and second["rest_s"] is None and second["sequence"] == 2


def test_what_is_written_is_read_back_and_all_else_stays(folder):
    before = tomllib.loads(TEXT)
    write_trial_values(folder, {0: {"temperature_C": 22.5, "rest_s": 60.0}, 1: {"age_days": 14.0, "sequence": 3}})
    before["trial"][0] |= {"temperature_C": 22.5, "rest_s": 60.0}
    before["trial"][1] |= {"age_days": 14.0, "sequence": 3}
    assert tomllib.loads(content(folder)) == before
    kept = [line for line in TEXT.splitlines() if "#" in line and "temperature_C =" != line.strip("# ")]
    assert all(line in content(folder).splitlines() for line in kept)
    assert "# temperature_C =" not in content(folder)


def test_an_empty_value_is_unknown_and_can_be_filled_in_again(folder):
    write_trial_values(folder, {1: {"temperature_C": None}})
    assert read_trials(folder)[1]["temperature_C"] is None
    assert "# by the window" in content(folder)
    write_trial_values(folder, {1: {"temperature_C": 19.0}})
    assert read_trials(folder)[1]["temperature_C"] == 19.0
    assert content(folder).count("temperature_C") == 2


def test_line_ends_and_the_mark_at_the_beginning_stay(folder):
    raw = ("\ufeff" + TEXT.replace("\n", "\r\n")).encode()
    (folder / "campaign.toml").write_bytes(raw)
    write_trial_values(folder, {0: {"age_days": 10.0}})
    after = (folder / "campaign.toml").read_bytes()
    assert after == raw.replace(b"age_days = 9.0", b"age_days = 10.0")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("temperature_C", 120.0),
        ("temperature_C", float("nan")),
        ("age_days", -1.0),
        ("rest_s", -1.0),
        ("sequence", 0),
        ("sequence", 1.5),
        ("thickness_mm", None),
        ("velocity_mm_s", 0.0),
    ],
)
def test_a_value_out_of_range_is_refused_by_name_and_nothing_is_written(folder, key, value):
    with pytest.raises(InputError, match=key) as problem:
        write_trial_values(folder, {0: {"age_days": 10.0}, 1: {key: value}})
    assert "b.csv" in str(problem.value)
    assert content(folder) == TEXT


def test_a_key_that_is_no_value_of_a_press_is_refused(folder):
    with raises_code("unknown_key", "trial"):
        write_trial_values(folder, {0: {"file": "c.csv"}})
    with raises_code("changed_meanwhile", "campaign.trials"):
        write_trial_values(folder, {7: {"age_days": 1.0}})
    assert content(folder) == TEXT


def test_a_file_in_another_form_is_left_alone(folder):
    text = 'schema = 1\ntrial = [{file = "a.csv", thickness_mm = 5.0, velocity_mm_s = 10.0}]\n'
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    with raises_code("unsupported", "campaign"):
        write_trial_values(folder, {0: {"age_days": 1.0}})
    assert content(folder) == text
