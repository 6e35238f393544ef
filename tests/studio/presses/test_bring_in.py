"""An existing campaign folder is brought in: with its campaign.toml as it is, without it by a table of trials."""

from __future__ import annotations

import csv
import json
import time

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock
from dummydesign.project.folder import make_project
from dummydesign.studio import incoming_presses as bring_in
from dummydesign.studio import job_process as runner
from dummydesign.studio.jobs import options
from tests.support.refusal import raises_code

TOML = b'schema = 1\nname = "x"\n[pad]\nyoung_kPa_nominal = 25.0\n[[trial]]\nfile = "t05_v010_f03_1.csv"\n'


@pytest.fixture
def root(tmp_path):
    return make_project(tmp_path / "thumb", tissue="forefinger").root


def test_a_folder_with_its_campaign_file_is_taken_as_it_is(root):
    for name, content in (("campaign.toml", TOML), ("t05_v010_f03_1.csv", b"1,2\n"), ("notes.txt", b"words")):
        bring_in.save_waiting_file(root, name, content)
    assert "campaign.toml" in bring_in.waiting(root)
    folder = bring_in.bring_in(root, "may")
    assert folder == "campaigns/may"
    assert {path.name: path.read_bytes() for path in (root / folder).iterdir()} == {
        "campaign.toml": TOML,
        "t05_v010_f03_1.csv": b"1,2\n",
        "notes.txt": b"words",
    }
    assert bring_in.waiting(root) == []


def test_files_that_a_command_reads_are_not_taken_from_under_it(root):
    bring_in.save_waiting_file(root, "campaign.toml", TOML)
    folder = root / ".studio" / "jobs" / "0001-fromfiles"
    folder.mkdir(parents=True)
    words = ["campaign", "from-files", "campaigns/may", f"{bring_in.FOLDER}/a.csv"]
    asked = {"name": "fromfiles", "words": words, "cwd": str(root), "start": time.time()}
    (folder / runner.COMMAND).write_text(json.dumps(asked))
    with acquire_lock(folder / runner.LOCK), raises_code("busy", "path"):
        bring_in.bring_in(root, "june")
    assert bring_in.waiting(root) == ["campaign.toml"]
    assert bring_in.bring_in(root, "june") == "campaigns/june"


def test_a_name_that_is_there_is_refused_and_nothing_is_moved(root):
    (root / "campaigns" / "may").mkdir()
    bring_in.save_waiting_file(root, "campaign.toml", TOML)
    for name in ("may", "../may", "", ".may"):
        with pytest.raises(InputError):
            bring_in.bring_in(root, name)
    assert bring_in.waiting(root) == ["campaign.toml"]
    bring_in.save_waiting_file(root, "campaign.toml", b"not = [toml")
    with raises_code("malformed", "campaign"):
        bring_in.bring_in(root, "june")
    assert not (root / "campaigns" / "june").exists()


def test_the_table_begins_with_what_the_names_say_and_what_a_table_said(root):
    for name in ("t05_v010_f03_1.csv", "t15_v250_f09_2.csv", "run 3.csv"):
        bring_in.save_waiting_file(root, name, b"1,2\n")
    rows = {row["file"]: row for row in bring_in.table(root)}
    assert set(rows) == {"t05_v010_f03_1.csv", "t15_v250_f09_2.csv", "run 3.csv"}
    first = rows["t05_v010_f03_1.csv"]
    assert (first["thickness_mm"], first["velocity_mm_s"], first["target_force_N"], first["repeat"]) == (5, 10, 3, 1)
    assert rows["run 3.csv"]["thickness_mm"] is None
    bring_in.save_waiting_file(root, "trials.csv", b"file,thickness_mm,age_days\nrun 3.csv,15,9\n")
    rows = {row["file"]: row for row in bring_in.table(root)}
    assert rows["run 3.csv"]["thickness_mm"] == 15 and rows["run 3.csv"]["age_days"] == 9
    assert "trials.csv" not in rows


@pytest.mark.parametrize(
    "content",
    [b"file;thickness_mm\na.csv;5\n", "file,thickness_mm\né.csv,5\n".encode("latin-1"), b"file,age\na.csv,9\n"],
)
def test_a_table_that_the_command_could_not_read_is_refused_and_the_earlier_one_stays(root, content):
    """The page writes its own table in its place: what it cannot read would be lost without a word."""
    for name, first in (("a.csv", b"1,2\n"), ("trials.csv", b"file,thickness_mm\na.csv,5\n")):
        bring_in.save_waiting_file(root, name, first)
    with pytest.raises(InputError, match=r"trials\.csv"):
        bring_in.save_waiting_file(root, "trials.csv", content)
    assert bring_in.table(root)[0]["thickness_mm"] == 5.0


def test_of_a_table_that_comes_before_its_presses_no_row_is_lost(root):
    """The page writes the table anew with each press that comes in."""
    rows = b"file,thickness_mm,age_days\na.csv,5,9\nz.csv,15,29\n"
    bring_in.save_waiting_file(root, "trials.csv", rows)
    for name in ("a.csv", "z.csv"):
        bring_in.save_waiting_file(root, name, b"1,2\n")
        shown = bring_in.table(root)
        shown[0]["age_days"] = None  # emptied on the page
        bring_in.write_table(root, shown)
    shown = bring_in.table(root)
    assert [(row["file"], row["thickness_mm"], row["age_days"]) for row in shown] == [
        ("a.csv", 5.0, None),
        ("z.csv", 15.0, 29.0),
    ]
    bring_in.save_waiting_file(root, "trials.csv", rows)
    assert bring_in.table(root)[0]["age_days"] == 9.0
    assert bring_in.waiting(root) == ["a.csv", "trials.csv", "z.csv"]


def test_what_is_typed_is_the_table_that_the_command_reads(root):
    for name in ("a.csv", "b, c.csv"):
        bring_in.save_waiting_file(root, name, b"1,2\n")
    rows = bring_in.table(root)
    rows[0] |= {"thickness_mm": 5.0, "temperature_C": 21.5, "sequence": 2}
    bring_in.write_table(root, rows)
    with open(root / bring_in.FOLDER / "trials.csv", newline="", encoding="utf-8") as stream:
        read = list(csv.DictReader(stream))
    assert read[0]["file"] == "a.csv" and float(read[0]["thickness_mm"]) == 5.0
    assert read[0]["sequence"] == "2" and float(read[0]["temperature_C"]) == 21.5
    assert read[1]["file"] == "b, c.csv" and read[1]["temperature_C"] == ""
    words = bring_in.words(root, "may", options({"young": 25.0}))
    assert words[:3] == ["campaign", "from-files", "campaigns/may"] and "measured/to-bring-in/b, c.csv" in words
    assert words[-4:] == ["--table", "measured/to-bring-in/trials.csv", "--young", "25"]


def test_only_files_of_a_campaign_are_kept(root):
    for name in ("a.exe", "../a.csv", ".a.csv"):
        with pytest.raises(InputError):
            bring_in.save_waiting_file(root, name, b"1")
    assert bring_in.waiting(root) == []
    with pytest.raises(InputError):
        bring_in.words(root, "may", [])
