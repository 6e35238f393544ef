"""A file of two columns says which of time, displacement and force it does not have, whoever reads it."""

from __future__ import annotations

import pytest

from dummydesign.cli.entry import run
from dummydesign.measurement.importing.vocabulary import absent_roles

COMMANDS = {
    "import": ["import"],
    "fit": ["fit"],
    "compare": ["compare", "--tissue", "palm"],
    "predict": ["predict", "--young", "30", "--thickness", "10", "--motion"],
}


@pytest.mark.parametrize("rows", [2, 5, 60])
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("header", "absent"),
    [
        ("time,force", "displacement"),
        ("displacement,force", "time"),
        ("time_s,force_N", "displacement"),
        ("displacement_mm,force_N", "time"),
        ("time_s,displacement_mm", "force"),
    ],
)
def test_the_missing_column_is_named_in_one_line(command, header, absent, rows, tmp_path, capsys):
    if command == "predict" and absent == "force":
        pytest.skip("a motion needs no force")
    path = tmp_path / "two.csv"
    lines = [f"{0.01 * i:.2f},{0.02 * max(i - 10, 0):.2f}" for i in range(rows)]
    path.write_text("\n".join([header, *lines]) + "\n", encoding="utf-8")
    assert run([*COMMANDS[command], str(path)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and said.startswith("error: two.csv")
    assert f"no column is {absent} " in said and "export" in said and "--columns" not in said
    assert "dummydesign import" not in said


@pytest.mark.parametrize(
    ("titles", "absent"),
    [
        (["Zeit [s]", "Weg [mm]", "Kraft [N]"], ()),
        (["a", "b", "c"], ()),
        (["s", "mm", "N"], ()),
        (["time", "foo", "force"], ()),
        (["Zeit", "Kraft"], ("displacement",)),
        (["a", "b"], ("time", "displacement", "force")),
    ],
)
def test_a_column_is_absent_only_where_no_other_can_be_it(titles, absent):
    assert absent_roles(titles) == absent
