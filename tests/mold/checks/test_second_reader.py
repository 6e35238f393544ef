"""The assembly read by another program: what it says decides, and none is not a pass."""

from __future__ import annotations

import pytest

from dummydesign.mold.checks.files import check_second_reader


@pytest.fixture
def programs(tmp_path, monkeypatch):
    """A folder of programs that is all there is; a function puts one there that prints lines."""
    folder = tmp_path / "programs"
    folder.mkdir()
    monkeypatch.setenv("PATH", str(folder))

    def put(name, *lines):
        path = folder / name
        path.write_text("#!/bin/sh\n" + "".join(f"echo '{line}'\n" for line in lines))
        path.chmod(0o755)

    return put


@pytest.mark.parametrize(
    "lines, status",
    [
        (("RESULT 10.0", "RESULT 20.0"), "pass"),
        (("RESULT 10.0", "RESULT 20.1"), "fail"),
        (("RESULT 30.0",), "fail"),
        (("Error : no solids",), "skipped"),
    ],
)
def test_gmsh_must_find_every_solid_with_its_volume(programs, tmp_path, lines, status):
    programs("gmsh", *lines)
    assert check_second_reader(tmp_path / "a.step", 30.0, 2).status == status


@pytest.mark.parametrize(
    "line, status", [("RESULT 2 30.0 True", "pass"), ("RESULT 2 30.0 False", "fail"), ("RESULT 3 30.0 True", "fail")]
)
def test_freecad_is_asked_first_and_must_call_them_valid(programs, tmp_path, line, status):
    programs("freecadcmd", line)
    programs("gmsh", "RESULT 1.0")
    found = check_second_reader(tmp_path / "a.step", 30.0, 2)
    assert found.status == status and found.note.startswith("FreeCAD")


def test_without_another_program_nothing_passed(programs, tmp_path):
    found = check_second_reader(tmp_path / "a.step", 30.0, 2)
    assert found.status == "skipped" and "neither FreeCAD nor gmsh" in found.note
