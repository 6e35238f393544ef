"""Tables of a TOML file: what is read, and that every fault has file, line, key and code."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from dummydesign.core.serialise import Serialised
from dummydesign.core.toml_schema import read_table
from tests.support.refusal import raises_code

TEXT = """schema = 1
name = "one"
[process]
speed_mm_s = 10
bad = "text"
endless = inf
[[subject]]
name = "a"
depths = [1.0, 2]
[[subject]]
name = ""
depths = [1.0, "x"]
"""


@pytest.fixture
def table(tmp_path: Path):
    path = tmp_path / "file.toml"
    path.write_text(TEXT, encoding="utf-8")
    return read_table(path, ("schema", "name", "process", "subject"))


def test_values_are_read_and_what_may_be_left_out_has_its_default(table):
    process = table.table("process")
    assert process.count("speed_mm_s", 1) == 10 and table.count("none", 4) == 4
    assert process.number("speed_mm_s", above=0.0) == 10.0 and process.number("none", 3.0) == 3.0
    assert table.string("name") == "one" and table.tables("subject")[0].numbers("depths") == (1.0, 2.0)
    assert table.table("nowhere", required=False).data == {} and table.tables("nowhere", required=False) == []


@pytest.mark.parametrize(
    ("ask", "code", "quantity", "line"),
    [
        (lambda t: t.table("process").number("bad"), "not_a_number", "process.bad", 5),
        (lambda t: t.table("process").number("endless"), "not_a_number", "process.endless", 6),
        (lambda t: t.table("process").number("speed_mm_s", high=5.0), "out_of_range", "process.speed_mm_s", 4),
        (lambda t: t.table("process").count("bad", 1), "out_of_range", "process.bad", 5),
        (lambda t: t.table("process").number("depth"), "missing", "process.depth", 3),
        (lambda t: t.table("process").only(("speed_mm_s", "bad")), "unknown_key", "process.endless", 6),
        (lambda t: t.tables("subject")[1].string("name"), "missing", "subject.name", 11),
        (lambda t: t.tables("subject")[1].numbers("depths"), "not_a_number", "subject.depths", 12),
        (lambda t: t.tables("name"), "malformed", "name", 2),
        (lambda t: t.string("name", choices=("two", "three")), "unknown_name", "name", 2),
        (lambda t: t.tables("subject")[0].quantity("name"), "malformed", "name", 8),
    ],
)
def test_a_fault_has_code_quantity_file_and_line(table, ask, code, quantity, line):
    with raises_code(code, quantity) as caught:
        ask(table)
    assert f"file.toml:{line}: " in str(caught.value)


def test_another_schema_is_refused(tmp_path):
    (tmp_path / "new.toml").write_text("schema = 2\n", encoding="utf-8")
    with raises_code("unsupported", "schema"):
        read_table(tmp_path / "new.toml")


@dataclass(frozen=True)
class Part(Serialised):
    depth_mm: np.ndarray
    force_N: float


@dataclass(frozen=True)
class Whole(Serialised):
    parts: tuple[Part, ...]
    share: float
    also = ("count",)

    @property
    def count(self) -> int:
        return len(self.parts)


def test_a_dataclass_becomes_plain_values_with_nested_ones_and_named_properties():
    whole = Whole((Part(np.array([1.0, 2.0]), 3.0),), float("nan"))
    assert whole.to_dict() == {"parts": [{"depth_mm": [1.0, 2.0], "force_N": 3.0}], "share": None, "count": 1}
