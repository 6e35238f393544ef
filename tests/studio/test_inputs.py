"""Whether an answer still fits the files it was made from, and its folder."""

from __future__ import annotations

import json
import shutil

from dummydesign.api.answers import question
from dummydesign.core.manifest import sha256_of
from dummydesign.core.user_library import find
from dummydesign.design.problem import read_problem
from dummydesign.design.request import Request
from dummydesign.studio.jobs import changed_inputs, changed_since, holds_answer


def manifest(root, inputs, *read):
    folder = root / "designs" / "a"
    folder.mkdir(parents=True, exist_ok=True)
    files = [{"name": name, "sha256": sha256_of(path)} for name, path in read]
    (folder / "manifest.json").write_text(json.dumps({"inputs": inputs, "files_read": files}), encoding="utf-8")
    return folder / "manifest.json"


def test_tissue_and_resin_of_a_search_are_compared_with_what_they_are_now(tmp_path):
    own = tmp_path / "tissue" / "my # 1.toml"
    own.parent.mkdir()
    own.write_text("a", encoding="utf-8")
    library = find("materials/resins", "resin", "polyurethane-nagoya").path
    kept = manifest(tmp_path, {}, ("tissue tissue/my # 1.toml", own), ("resin polyurethane-nagoya", library))
    assert changed_inputs(tmp_path, kept) == []
    own.write_text("b", encoding="utf-8")
    assert changed_inputs(tmp_path, kept) == ["tissue tissue/my # 1.toml"]
    own.unlink()
    assert changed_inputs(tmp_path, kept) == ["tissue tissue/my # 1.toml"]


def test_a_file_that_was_gone_before_its_sum_was_taken_has_changed(tmp_path):
    """Renamed between reading and the end of a command; a folder, which has no sum, has not."""
    (tmp_path / "moulds").mkdir()
    kept = manifest(tmp_path, {}, ("campaigns/first/a.csv", tmp_path / "gone.csv"), ("moulds", tmp_path / "moulds"))
    assert changed_inputs(tmp_path, kept) == ["campaigns/first/a.csv"]


def test_a_folder_that_another_command_wrote_since_does_not_hold_the_answer(tmp_path):
    answer = {"inputs": {"ratio": 15.0, "out": "designs/a"}}
    assert not holds_answer(tmp_path, "designs/a", answer)
    manifest(tmp_path, {"ratio": 15.0, "more": 1})
    assert holds_answer(tmp_path, "designs/a", answer)
    manifest(tmp_path, {"ratio": 16.0, "more": 1})
    assert not holds_answer(tmp_path, "designs/a", answer)
    shutil.rmtree(tmp_path / "designs" / "a")
    assert not holds_answer(tmp_path, "designs/a", answer)


def test_a_file_that_was_written_after_a_command_began_has_changed_since(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text("a", encoding="utf-8")
    written = path.stat().st_mtime
    assert changed_since([path], written - 1.0) and not changed_since([path, tmp_path / "gone"], written + 1.0)


def test_every_file_that_a_search_reads_is_found_again(tmp_path):
    """Weights, limits, machine and silicone too: none is said to have changed where nothing did."""
    problem = read_problem(Request("forefinger", shape="slab", verify=False))
    asked = question("suggest", {}, tissue="forefinger", resin="polyurethane-nagoya", named=dict(problem.files))
    assert {"materials/score", "silicone platinum_a20"} <= set(asked.files)
    assert changed_inputs(tmp_path, manifest(tmp_path, {}, *asked.files.items())) == []
