"""Dataclasses that hold arrays compare by identity: comparing field by field would raise."""

from __future__ import annotations

import ast
from pathlib import Path

import numpy as np

from dummydesign.measurement.motion import Motion

PACKAGE = Path(__file__).parents[1] / "dummydesign"
ROOMS = ("api", "core", "design", "geometry", "inference", "measurement", "mold", "pad", "person", "resin", "tissue")


def compared_by_field(source):
    """Names of dataclasses with a field that is an array and the equality of dataclasses."""
    for one in (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef)):
        arrays = [line for line in one.body if isinstance(line, ast.AnnAssign)]
        arrays = [line for line in arrays if ast.unparse(line.annotation).startswith(("NDArray", "np.ndarray"))]
        made = [ast.unparse(mark) for mark in one.decorator_list if ast.unparse(mark).startswith("dataclass")]
        if arrays and made and "eq=False" not in made[0]:
            yield one.name


def test_no_dataclass_with_arrays_compares_them():
    files = [path for room in ROOMS for path in (PACKAGE / room).rglob("*.py")]
    assert len(files) > 150
    assert [name for path in files for name in compared_by_field(path.read_text(encoding="utf-8"))] == []
    assert list(compared_by_field("@dataclass(frozen=True)\nclass A:\n    x: NDArray\n")) == ["A"]


def test_two_motions_of_the_same_numbers_are_two():
    one, other = (Motion(np.array([0.0, 1.0]), np.array([0.0, 2.0])) for _ in range(2))
    assert one == one and one != other and len({one, other}) == 2
