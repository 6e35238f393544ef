"""Answers lie whole, alone and listed in their place, whatever happens on the way."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

import pytest

from dummydesign.cli import entry
from dummydesign.cli.entry import run
from dummydesign.core import progress
from dummydesign.core.manifest import COMMAND_LINE, Question, read_manifest
from dummydesign.core.outputs import new_files, new_folder
from tests.support.refusal import raises_code

ROOT = str(Path(__file__).parents[3])


def ask(number=1, **files):
    return Question("suggest", {"tissue": number}, files)


def write(out, question, replace=False, **files):
    with new_folder(out, question, replace=replace) as output:
        for name, text in (files or {"a_csv": "a"}).items():
            output.path(name.replace("_", ".")).write_text(text)
    return output


def tree(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_a_manifest_lists_every_file_the_question_what_was_read_and_the_date(tmp_path):
    (tmp_path / "trace.csv").write_text("1,2,3")
    before = COMMAND_LINE.set(("suggest", "--tissue", "my palm"))
    output = write(tmp_path / "o", ask(trace=tmp_path / "trace.csv"), a_csv="a", b_svg="b")
    COMMAND_LINE.reset(before)
    content = json.loads((tmp_path / "o/manifest.json").read_text())
    assert content["sha256"] == {name: hashlib.sha256(name[:1].encode()).hexdigest() for name in ("a.csv", "b.svg")}
    assert content["command_line"] == "dummydesign suggest --tissue 'my palm'" and content["finished"] is True
    assert content["inputs"] == {"tissue": 1} and content["date"].endswith("+00:00") and content["version"]
    read = {"name": "trace", "file": "trace.csv", "sha256": hashlib.sha256(b"1,2,3").hexdigest()}
    assert content["files_read"] == [read]
    assert output.answer({"files": {"a": str(output.work / "a.csv")}})["files"] == {
        "a": str(tmp_path / "o/a.csv"),
        "manifest": str(tmp_path / "o/manifest.json"),
    }


@pytest.mark.parametrize("words", [["tissues", "list"], ["tissues", "show", "no such tissue"], ["--version"]])
def test_a_call_from_python_records_no_command_line_after_a_command(tmp_path, words, capsys):
    run(words)
    write(tmp_path / "o", ask())
    assert json.loads((tmp_path / "o/manifest.json").read_text())["command_line"] is None


def test_the_same_question_takes_its_own_place_and_another_the_next_number(tmp_path):
    out = tmp_path / "o"
    assert write(out, ask(1), a_csv="1", gone_csv="1").folder == out
    assert write(out, ask(1), a_csv="1").folder == out and tree(out) == ["a.csv", "manifest.json"]
    second = write(out, ask(2), a_csv="2")
    assert second.folder == tmp_path / "o-2" and (out / "a.csv").read_text() == "1"
    said = second.answer({})["warnings"]
    assert [one["code"] for one in said] == ["output_numbered"] and "--replace" in said[0]["message"]
    assert write(out, ask(3)).folder == tmp_path / "o-3"
    assert write(out, ask(2), a_csv="2").folder == tmp_path / "o-2"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["o", "o-2", "o-3"]


def test_other_content_of_a_file_that_is_read_is_another_question(tmp_path):
    for text, place in (("1", "o"), ("2", "o-2"), ("1", "o")):
        (tmp_path / "t.csv").write_text(text)
        assert write(tmp_path / "o", ask(t=tmp_path / "t.csv")).folder.name == place


def test_replace_takes_the_place_and_only_of_what_a_command_wrote(tmp_path):
    out = tmp_path / "o"
    write(out, ask(1), a_csv="1", b_csv="1")
    (out / "notes.txt").write_text("mine")
    taken = write(out, ask(2), replace=True, a_csv="2")
    assert taken.folder == out and tree(out) == ["a.csv", "manifest.json", "notes.txt"]
    assert (out / "a.csv").read_text() == "2" and (out / "notes.txt").read_text() == "mine"
    assert "notes.txt" in taken.target.warnings[0]["message"]


def test_a_file_changed_by_hand_is_not_overwritten(tmp_path):
    out = tmp_path / "o"
    write(out, ask(1), a_csv="1")
    (out / "a.csv").write_text("edited")
    again = write(out, ask(1), a_csv="1")
    assert again.folder == tmp_path / "o-2" and "changed since" in again.target.warnings[0]["message"]
    assert (out / "a.csv").read_text() == "edited"


def test_a_folder_of_ones_own_is_used_and_nothing_in_it_is_overwritten(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    assert write(tmp_path, ask(1), a_csv="1").folder == tmp_path
    assert tree(tmp_path) == ["a.csv", "manifest.json", "notes.txt"]
    other = tmp_path / "other"
    other.mkdir()
    (other / "a.csv").write_text("mine")
    with raises_code("file_exists", "out"):
        write(other, ask(1), a_csv="1")
    assert tree(other) == ["a.csv"] and (other / "a.csv").read_text() == "mine"


def test_an_answer_without_a_full_manifest_as_earlier_editions_left_it_is_not_mixed_into(tmp_path):
    for number, (name, text) in enumerate((("report.html", "x"), ("pad_t5.step", "x"), ("manifest.json", "{"))):
        old = tmp_path / f"old{number}"
        old.mkdir()
        (old / name).write_text(text)
        assert write(old, ask(1)).folder.name == f"old{number}-2"


def test_a_manifest_that_names_files_outside_harms_nothing(tmp_path):
    out = tmp_path / "o"
    write(out, ask(1))
    (tmp_path / "mine").write_text("mine")
    content = json.loads((out / "manifest.json").read_text())
    content["sha256"] = {"../mine": "0", str(tmp_path / "mine"): "0"}
    (out / "manifest.json").write_text(json.dumps(content))
    assert read_manifest(out / "manifest.json").sha256 == {}
    write(out, ask(2), replace=True)
    assert (tmp_path / "mine").read_text() == "mine"


def times(folder):
    return {name: (folder / name).stat().st_mtime_ns for name in tree(folder) if (folder / name).is_file()}


@pytest.mark.parametrize("fault", [ValueError, KeyboardInterrupt, SystemExit])
def test_what_fails_leaves_nothing_neither_new_nor_changed(tmp_path, fault):
    def fail(out):
        with pytest.raises(fault), new_folder(out, ask(1), replace=True) as output:
            output.path("a.csv").write_text("new")
            raise fault

    fail(tmp_path / "deep/er/o")
    assert tree(tmp_path) == []
    write(tmp_path / "o", ask(2), a_csv="old")
    before = times(tmp_path)
    fail(tmp_path / "o")
    assert times(tmp_path) == before


def test_a_fault_while_renaming_brings_the_earlier_answer_back(tmp_path, monkeypatch):
    write(tmp_path / "o", ask(1), a_csv="1", b_csv="1", c_csv="1")
    real, count = os.replace, iter(range(100))

    def replace(source, target):
        if str(target).endswith("o/b.csv") and next(count) == 0:
            raise OSError(28, "No space left on device")
        real(source, target)

    monkeypatch.setattr("dummydesign.core.outputs.os.replace", replace)
    with raises_code("file_unwritable", "out"):
        write(tmp_path / "o", ask(2), replace=True, a_csv="2", b_csv="2")
    assert tree(tmp_path / "o") == ["a.csv", "b.csv", "c.csv", "manifest.json"]
    assert {(tmp_path / "o" / name).read_text() for name in ("a.csv", "b.csv", "c.csv")} == {"1"}


def test_a_place_that_cannot_be_written_is_told_before_any_work(tmp_path):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file/x", Path("/proc/nowhere")):
        with raises_code("file_unwritable", "out"), new_folder(out, ask()):
            raise AssertionError("the work has started")
    assert tree(tmp_path) == ["file"]


def test_a_file_that_shares_a_folder_and_the_folder_beside_it_have_its_stem(tmp_path):
    def fit(question, replace=False):
        with new_files(tmp_path / "carla.toml", question, replace=replace) as output:
            output.path(f"{output.target.stem}.toml").write_text("x")
            report = output.path(f"{output.target.stem}-report")
            report.mkdir()
            (report / "residuals.csv").write_text("x")
        return output.target.stem

    (tmp_path / "bruno.toml").write_text("bruno")
    assert fit(ask(1)) == "carla" and fit(ask(1)) == "carla"
    assert fit(ask(2)) == "carla-2" and fit(ask(3), replace=True) == "carla"
    assert json.loads((tmp_path / "carla-report" / "manifest.json").read_text())["inputs"] == {"tissue": 3}
    parts = (".toml", "-report", "-report/manifest.json", "-report/residuals.csv")
    made = {f"carla{number}{part}" for number in ("", "-2") for part in parts}
    assert {name for name in tree(tmp_path) if not name.endswith("-report")} | made == {"bruno.toml", *made}


def test_what_a_killed_command_left_is_cleared_by_the_next(tmp_path):
    code = (
        "import os, sys; from dummydesign.core.outputs import new_folder\n"
        "from dummydesign.core.manifest import Question\n"
        "with new_folder('o', Question('suggest', {})) as o:\n"
        "    o.path('a.csv').write_text('half'); os.kill(os.getpid(), 9)"
    )
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env={**os.environ, "PYTHONPATH": ROOT})
    assert [name[:8] for name in os.listdir(tmp_path)] == [".o.part-"]
    write(tmp_path / "o", ask(1))
    assert os.listdir(tmp_path) == ["o"]


QUICK = ["--no-cad", "--no-verify"]


@pytest.mark.slow
def test_two_designs_never_share_a_folder_and_the_command_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # 1: the best pad is not acceptable, which is written all the same
    assert run(["suggest", "--tissue", "palm", *QUICK, "--out", "mine"]) in (0, 1)
    first = {path.name: path.read_bytes() for path in (tmp_path / "mine").iterdir()}
    capsys.readouterr()
    assert run(["suggest", "--tissue", "thenar", *QUICK, "--out", "mine", "--json"]) in (0, 1)
    found = json.loads(capsys.readouterr().out)
    assert found["inputs"]["out"] == "mine-2"
    assert {Path(path).parent.name for path in found["files"].values()} == {"mine-2"}
    assert all(Path(path).is_file() for path in found["files"].values())
    assert any(one["code"] == "output_numbered" for one in found["warnings"])
    assert {path.name: path.read_bytes() for path in (tmp_path / "mine").iterdir()} == first
    assert run(["suggest", "--tissue", "thenar", *QUICK, "--out", "mine", "--replace"]) in (0, 1)
    assert json.loads((tmp_path / "mine/manifest.json").read_text())["inputs"]["tissue"] == "thenar"
    for path in tmp_path.rglob("*.html"):
        assert ".part-" not in path.read_text()


def test_a_command_that_is_ended_inside_exec_has_its_status(tmp_path):
    """Python marks an interrupt there as unhandled for good, and would end by the signal."""
    (tmp_path / "ended.py").write_text(
        "import dummydesign.cli.entry as entry\n\ndef run(arguments):\n    try:\n"
        "        exec('raise KeyboardInterrupt')\n    except KeyboardInterrupt:\n        return 130\n\n"
        "entry.run = run\nentry.main()\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    assert subprocess.run([sys.executable, "-m", "ended"], env=environment, timeout=60).returncode == 130


@pytest.mark.slow
def test_a_command_that_is_ended_leaves_nothing(tmp_path):
    command = [sys.executable, "-m", "dummydesign", "suggest", "--tissue", "palm", "--no-cad", "--out", "o"]
    environment = {**os.environ, "PYTHONPATH": ROOT, "DUMMYDESIGN_CACHE": "off"}
    for how in (signal.SIGTERM, signal.SIGINT):
        # A test run in the background of a shell ignores SIGINT, and so would the command.
        heard = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
        child = subprocess.Popen(
            command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True, preexec_fn=heard
        )
        until = time.monotonic() + 60
        while not os.listdir(tmp_path) and time.monotonic() < until:
            time.sleep(0.01)
        assert os.listdir(tmp_path)[0].startswith(".o.part-")
        child.send_signal(how)
        assert child.communicate(timeout=60)[1] == "error: stopped by the user\n"
        assert child.returncode == 130 and os.listdir(tmp_path) == []


def test_an_interrupt_that_was_lost_ends_the_command_at_its_next_step_and_leaves_nothing(tmp_path):
    """While a C library loads an exception of a signal's handler can be dropped; the wish to end is kept."""
    try:
        with pytest.raises(KeyboardInterrupt), new_folder(tmp_path / "o", ask(1)) as output:
            output.path("a.csv").write_text("1")
            with suppress(KeyboardInterrupt):
                entry._stop()
        with pytest.raises(KeyboardInterrupt):
            progress.write_progress("step 1 of 2")
    finally:
        progress.STOP.clear()
    assert os.listdir(tmp_path) == []


def test_a_manifest_that_two_commands_write_at_once_is_whole(tmp_path, monkeypatch):
    parts, replace = [], os.replace

    def noted(source, target):
        parts.append(str(source))
        replace(source, target)

    monkeypatch.setattr(os, "replace", noted)
    for _ in range(2):
        with new_folder(tmp_path / "rows", ask(1)) as output:
            output.path("row").write_text("1")
    manifests = [part for part in parts if "manifest" in part]
    assert len(manifests) >= 2 and len(manifests) == len(set(manifests))


def test_of_two_commands_at_once_the_same_answer_is_taken_over_and_another_kept(tmp_path):
    with new_folder(tmp_path / "o", ask()) as first:
        first.path("a.csv").write_text("a")
        write(tmp_path / "o", ask(), a_csv="a", b_csv="b")
    assert sorted(tree(tmp_path)) == ["o", "o/a.csv", "o/manifest.json"]
    assert read_manifest(tmp_path / "o/manifest.json").key == ask().key
    with raises_code("changed_meanwhile", "out"), new_folder(tmp_path / "p", ask()) as first:
        first.path("a.csv").write_text("a")
        write(tmp_path / "p", ask(2), a_csv="other")
    assert (tmp_path / "p/a.csv").read_text() == "other" and tree(tmp_path / "p") == ["a.csv", "manifest.json"]
