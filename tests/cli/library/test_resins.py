"""``resins`` on the command line: light, readable, JSON alone, errors in one line."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from dummydesign.cli.entry import run

HEAVY = ("scipy", "skfem", "cadquery", "OCP", "pyvista", "vtkmodules", "trimesh", "matplotlib")


def loaded_by(*arguments):
    """Modules that a fresh interpreter has loaded after a command."""
    code = (
        "import sys, io, contextlib\n"
        "from dummydesign.cli import run\n"
        "with contextlib.redirect_stdout(io.StringIO()):\n"
        f"    status = run({list(arguments)!r})\n"
        "print(status, *sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    status, *modules = done.stdout.split()
    assert status == "0"
    return {module.split(".")[0] for module in modules}


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        ["suggest", "--help"],
        ["whatif", "--help"],
        ["resins", "--help"],
        ["resins", "list"],
        ["resins", "list", "--json"],
        ["tissues", "list"],
    ],
)
def test_light_commands_load_nothing_heavy(arguments):
    code = arguments[:-1] if arguments[-1] == "--help" and len(arguments) > 1 else arguments
    if code is not arguments:  # argparse leaves by SystemExit after its help
        command = [sys.executable, "-X", "importtime", "-m", "dummydesign", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        found = {line.rsplit("|", 1)[-1].strip().split(".")[0] for line in done.stderr.splitlines()}
    else:
        found = loaded_by(*arguments)
    assert not found & set(HEAVY)


def test_list_names_origin_and_ranges(capsys):
    assert run(["resins", "list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "dummydesign.resins/1" and found["version"] and found["sources"]
    row = next(row for row in found["resins"] if row["name"] == "polyurethane-nagoya")
    assert row["origin"] == "built-in" and row["ratio_range"] == [14.0, 20.0]
    assert 0 < row["young_kPa_range"][0] < 25 < row["young_kPa_range"][1]


def test_show_gives_every_number_with_its_source(capsys):
    assert run(["resins", "show", "polyurethane-nagoya", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert all({"value", "low", "high", "kind", "source"} <= set(item) for item in found["numbers"].values())
    assert found["resin"]["modulus"]["young_ref_kPa"]["value"] == 25.0
    assert run(["resins", "show", "polyurethane-nagoya", "--details"]) == 0
    text = capsys.readouterr().out
    assert "relative to the long-term modulus" in text and "section IV" in text


@pytest.mark.slow
def test_show_writes_a_plot_and_its_data(tmp_path, capsys):
    assert run(["resins", "show", "polyurethane-nagoya", "--out", str(tmp_path), "--json"]) == 0
    files = json.loads(capsys.readouterr().out)["files"]
    assert "<svg" in Path(files["plot"]).read_text(encoding="utf-8")
    lines = Path(files["data"]).read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("ratio,young_low_kPa,young_kPa,young_high_kPa") and len(lines) == 62


def test_points_become_a_resin_and_a_broken_file_hides_nothing(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    points = tmp_path / "batch.toml"
    points.write_text(
        '[[point]]\nratio = 15.0\nyoung_kPa = {value = 30, low = 28, high = 32, kind = "measured", source = "puck"}\n'
    )
    assert run(["resins", "add", str(points)]) == 0
    (tmp_path / "home" / "materials" / "resins" / "broken.toml").write_text("not toml at all")
    capsys.readouterr()
    assert run(["resins", "list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {row["name"] for row in found["resins"]} >= {"polyurethane-nagoya", "batch"}
    assert [item["code"] for item in found["warnings"]] == ["unreadable_resin"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["resins"], "required"),
        (["resins", "show", "polyurethan"], "did you mean 'polyurethane-nagoya'"),
        (["resins", "add", "nowhere.toml"], "does not exist"),
        (["resins", "show", "polyurethane-nagoya", "--out", "/dev/null/x"], "cannot be written"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert run(arguments) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("error: ") and message in error and "\n" not in error


def test_points_in_a_csv_are_refused_and_the_help_does_not_promise_them(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    points = tmp_path / "points.csv"
    points.write_text("ratio,young_kPa\n15,30\n")
    assert run(["resins", "add", str(points)]) == 2
    assert "[[point]]" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        run(["resins", "add", "--help"])
    shown = capsys.readouterr().out
    assert "csv" not in shown.lower() and "[[point]]" in shown
