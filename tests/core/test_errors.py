"""Errors have a code of the list and a quantity, also where they pass through another process or as JSON."""

from __future__ import annotations

import json
import pickle
import re
from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.core.errors import InputError, NoAnswerError, out_of_range, quantity_name, unknown_name
from dummydesign.design.pad_evaluator import NotTabulated
from studies.errors import CODES, DOCUMENT, document, raised

ROOT = Path(__file__).parents[2]


def test_every_error_of_the_package_has_a_code_of_the_list_and_a_quantity():
    quantities, bare = raised()
    assert bare == []
    assert set(quantities) == set(CODES)
    assert sum(len(names) for names in quantities.values()) > 200
    wrong = {name for names in quantities.values() for name in names if not re.fullmatch(r"[A-Za-z][\w.]*", name)}
    assert wrong == set()


def test_the_page_of_errors_is_that_of_the_sources():
    assert (ROOT / DOCUMENT).read_text(encoding="utf-8") == document()


def test_a_fault_keeps_its_code_and_quantity_in_the_place_it_was_found_at_and_through_a_process():
    first = out_of_range("thickness in mm", -5.0, 3.0, 30.0)
    there = first.within("file.toml:4")
    assert str(there) == f"file.toml:4: {first}" and there.to_dict() | {"message": ""} == first.to_dict() | {
        "message": ""
    }
    for error in (
        first,
        unknown_name("tissue", "foot", ["palm"]),
        NoAnswerError("check_failed", "no", {"a": 1}, "mould"),
    ):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error) and again.to_dict() == error.to_dict()
        assert getattr(again, "result", None) == getattr(error, "result", None)


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("thickness in mm", "thickness_mm"),
        ("--edge-radius", "edge_radius"),
        ("velocity in mm/s", "velocity_mm_s"),
        ("Young's modulus in kPa", "young_kPa"),
    ],
)
def test_words_of_a_message_become_a_name_with_its_unit(words, name):
    assert quantity_name(words) == name


@pytest.mark.parametrize(
    ("words", "code", "quantity", "value", "allowed"),
    [
        ("suggest --tissue foot", "unknown_name", "tissue", "foot", ["forefinger", "palm", "thenar"]),
        ("predict --young 25 --thickness -5 --depth 1", "out_of_range", "thickness_mm", None, None),
        ("predict --young 25 --thickness 5 --depht 1", "unknown_option", "depht", None, None),
        ("loop no-such-folder", "file_not_found", "campaign", None, None),
        ("mold --thickness", "bad_arguments", "thickness", None, None),
    ],
)
def test_with_json_an_error_is_printed_as_json_and_keeps_its_status(
    words, code, quantity, value, allowed, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    assert cli.run([*words.split(), "--json"]) == 2
    out, err = capsys.readouterr()
    error = json.loads(out)["error"]
    assert list(error) == ["code", "quantity", "value", "allowed", "message"]
    assert err == f"error: {error['message']}\n"
    assert error["code"] == code
    assert error["quantity"] == quantity
    assert value is None or error["value"] == value
    assert allowed is None or error["allowed"] == allowed


def test_an_error_from_elsewhere_has_the_code_for_that():
    assert InputError("no idea").to_dict()["code"] == "not_specified"


def test_a_refusal_of_a_pad_that_no_table_holds_comes_back_from_another_process():
    problem = NotTabulated("the punch is round", "punch")
    again = pickle.loads(pickle.dumps(problem))
    assert type(again) is NotTabulated and again.to_dict() == problem.to_dict()
