"""What a user measured stays beside an answer, covered by its manifest, whatever command runs next."""

import hashlib
import json

from dummydesign.core.manifest import Question, add_record
from dummydesign.core.outputs import new_folder
from tests.support.refusal import raises_code


def answer(folder, number=1, replace=False):
    with new_folder(folder, Question("mold", {"thickness": number}), replace=replace) as output:
        output.path("pad.step").write_text("x")
    return output.folder


def records(folder):
    return json.loads((folder / "manifest.json").read_text()).get("records", {})


def test_a_record_is_in_the_manifest_with_its_hash_and_the_answers_own_files_stay_listed(tmp_path):
    folder = answer(tmp_path / "m")
    path = add_record(folder, "record", {"mass_g": 1.0, "date": "2026-01-01"})
    assert records(folder) == {"record.json": hashlib.sha256(path.read_bytes()).hexdigest()}
    assert set(json.loads((folder / "manifest.json").read_text())["sha256"]) == {"pad.step"}


def test_another_pad_takes_the_next_number_and_the_same_said_again_changes_nothing(tmp_path):
    folder = answer(tmp_path / "m")
    first = add_record(folder, "record", {"mass_g": 1.0, "date": "1"})
    second = add_record(folder, "record", {"mass_g": 2.0, "date": "1"})
    before = first.read_bytes()
    assert second.name == "record-2.json" and add_record(folder, "record", {"mass_g": 1.0, "date": "2"}) == first
    assert first.read_bytes() == before and set(records(folder)) == {"record.json", "record-2.json"}
    assert add_record(folder, "record", {"mass_g": 3.0}, replace=True) == first
    assert json.loads(first.read_text()) == {"mass_g": 3.0}


def test_a_record_outlives_the_same_command_and_is_never_deleted_by_another(tmp_path):
    folder = answer(tmp_path / "m")
    path = add_record(folder, "record", {"mass_g": 1.0})
    assert answer(tmp_path / "m") == folder and set(records(folder)) == {"record.json"}
    answer(tmp_path / "m", replace=True)
    assert set(records(folder)) == {"record.json"}
    answer(tmp_path / "m", number=2, replace=True)
    assert path.is_file() and records(folder) == {}


def test_a_folder_without_a_manifest_is_refused_and_stays_empty(tmp_path):
    with raises_code("file_unreadable", "manifest"):
        add_record(tmp_path, "record", {"mass_g": 1.0})
    assert list(tmp_path.iterdir()) == []
