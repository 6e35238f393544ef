"""The user's own library: nothing is lost without a word, and what was hidden comes back."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from dummydesign.cli.entry import run
from dummydesign.core.user_library import data_folder, user_folder
from dummydesign.resin import load_resin
from dummydesign.tissue.model.tissue_file import load_tissue
from tests.support.refusal import raises_code


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)
    return tmp_path / "home"


def whole(folder, name, kind="resins", source="polyurethane-nagoya"):
    text = (data_folder() / "materials" / kind / f"{source}.toml").read_text(encoding="utf-8")
    path = folder / f"{name}.toml"
    path.write_text(text.replace(f'name = "{source}"', f'name = "{name}"', 1), encoding="utf-8")
    return str(path)


def said(capsys, *words, status=0):
    assert run(list(words)) == status
    shown = capsys.readouterr()
    return shown.err if status else shown.out


@pytest.mark.parametrize("named", ["", None])
def test_an_empty_xdg_folder_is_as_none(named, tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DUMMYDESIGN_HOME", raising=False)
    monkeypatch.delenv("XDG_DATA_HOME", raising=False)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    if named is not None:
        monkeypatch.setenv("XDG_DATA_HOME", named)
    assert user_folder() == tmp_path / ".local" / "share" / "dummydesign"


def test_add_refuses_a_name_that_is_taken_and_replace_takes_it(home, tmp_path, capsys):
    file = whole(tmp_path, "mine")
    said(capsys, "resins", "add", file)
    kept = home / "materials/resins/mine.toml"
    before = kept.read_bytes()
    assert "'mine' exists" in said(capsys, "resins", "add", file, status=2) and kept.read_bytes() == before
    said(capsys, "resins", "add", file, "--replace")
    tissue = whole(tmp_path, "hand", "tissues", "palm")
    said(capsys, "tissues", "add", "hand", tissue)
    assert "'hand' exists" in said(capsys, "tissues", "add", "hand", tissue, status=2)
    said(capsys, "tissues", "add", "hand", tissue, "--replace")


def test_a_built_in_name_is_taken_with_a_word_and_comes_back_when_removed(home, tmp_path, capsys):
    file = whole(tmp_path, "polyurethane-nagoya")
    assert "hides the built-in one" in said(capsys, "resins", "add", file)
    assert load_resin("polyurethane-nagoya").origin == "user"
    removed = said(capsys, "resins", "remove", "Polyurethane-Nagoya")
    assert removed.startswith("removed ") and load_resin("polyurethane-nagoya").origin == "built-in"
    assert "built in and stays" in said(capsys, "resins", "remove", "polyurethane-nagoya", status=2)


def test_rename_changes_the_name_in_the_file_and_takes_the_draws_along(home, tmp_path, capsys):
    said(capsys, "tissues", "add", "hand", whole(tmp_path, "hand", "tissues", "palm"))
    folder = home / "materials/tissues"
    (folder / "hand_draws.csv").write_text("draws")
    said(capsys, "tissues", "rename", "hand", "left-hand")
    assert sorted(path.name for path in folder.iterdir()) == ["left-hand.toml", "left-hand_draws.csv"]
    assert load_tissue("left-hand").name == "left-hand"
    said(capsys, "tissues", "rename", "left-hand", "Left-Hand")
    assert load_tissue("left-hand").name == "Left-Hand"
    assert "unknown tissue of your own 'hand'" in said(capsys, "tissues", "rename", "hand", "x", status=2)
    said(capsys, "tissues", "add", "other", whole(tmp_path, "other", "tissues", "palm"))
    assert "'other' exists" in said(capsys, "tissues", "rename", "left-hand", "other", status=2)
    assert "may hold letters" in said(capsys, "tissues", "rename", "other", "../x", status=2)
    assert len(list(folder.glob("*.toml"))) == 2


def test_path_says_where_a_file_lies_and_whose_it_is(home, tmp_path, capsys):
    found = json.loads(said(capsys, "resins", "path", "polyurethane-nagoya", "--json"))
    assert found["origin"] == "built-in" and found["path"].endswith("polyurethane-nagoya.toml")
    said(capsys, "resins", "add", whole(tmp_path, "mine"))
    assert said(capsys, "resins", "path", "mine").strip() == str(home / "materials/resins/mine.toml")


def test_a_file_with_a_byte_order_mark_is_read_and_what_is_no_library_file_is_named(home, tmp_path, capsys):
    path = Path(whole(tmp_path, "marked"))
    plain = load_resin(str(path))
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert load_resin(str(path)).young_MPa(15.0) == plain.young_MPa(15.0)
    (tmp_path / "mine.txt").write_text("x", encoding="utf-8")
    with raises_code("unknown_name", "tissue") as caught:
        load_tissue("mine.txt")
    assert ".toml" in str(caught.value)


@pytest.mark.parametrize(
    ("words", "code", "quantity"),
    [
        (["on-person", "a.csv", "--tissue", "palm", "--limits", "no/limits.toml"], "file_not_found", "file"),
        (["on-person", "a.csv", "--tissue", "palm", "--limits", "."], "file_unreadable", "file"),
        (["replay", "campaign", "--calibration", "."], "file_unreadable", "calibration"),
        (["loop", "campaign/campaign.toml"], "file_not_found", "campaign"),
        (["suggest", "--tissue", "palm", "--no-cad", "--out", ""], "missing", "out"),
    ],
)
def test_what_cannot_be_read_is_named_and_nothing_is_written(words, code, quantity, home, tmp_path, capsys):
    (tmp_path / "campaign").mkdir()
    (tmp_path / "campaign" / "campaign.toml").write_text("", encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    assert run([*words, "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"]) == (code, quantity) and "''" not in error["message"]
    assert sorted(tmp_path.rglob("*")) == before
