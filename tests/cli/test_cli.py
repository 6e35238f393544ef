"""The command line as a whole: light start-up, one-line errors, exit statuses, quiet pipes."""

from __future__ import annotations

import errno
import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from dummydesign import cli

OF_CALLS = {"dataclasses", "ast", "hashlib", "json"}
"""Modules of Python that the Python calls load, of whose signatures the options are made."""
NOT_FOR_HELP = ("tempfile", "difflib", *OF_CALLS)
"""Modules of Python that take as long to load as the rest of a help."""
FROM_CALLS = "suggest predict whatif import fit mold campaign loop replay compare on-person".split()
HEAVY = ("numpy", "scipy", "skfem", "cadquery", "OCP", "pyvista", "vtk", "trimesh", "matplotlib")
CONTRACT_HEAVY = HEAVY[1:]


def modules_after(*words):
    code = (
        "import sys\nfrom dummydesign.cli import run\n"
        f"status = run({list(words)!r})\n"
        "print('\\n@@', status, *sorted({name.split('.')[0] for name in sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    status, *names = done.stdout.rsplit("@@", 1)[1].split()
    return int(status), set(names)


@pytest.mark.parametrize("command", [[], ["--help"], ["--version"], *([name, "--help"] for name in cli.COMMANDS)])
def test_help_imports_nothing_heavy(command):
    if command and command[-1] == "--help" and len(command) == 2:
        code = f"import sys; sys.argv = ['dummydesign', *{command!r}]\nfrom dummydesign.cli import main\n"
        code += "try:\n    main()\nexcept SystemExit:\n    pass\nprint('@@', *{n.split('.')[0] for n in sys.modules})"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        names = set(done.stdout.rsplit("@@", 1)[1].split())
    else:
        _, names = modules_after(*command)
    assert not names & {*HEAVY, *NOT_FOR_HELP} - (OF_CALLS if command[:1] and command[0] in FROM_CALLS else set())


@pytest.mark.parametrize("command", [["tissues", "list"], ["resins", "list"]])
def test_lists_import_none_of_the_heavy_packages(command):
    status, names = modules_after(*command)
    assert status == 0
    assert not names & set(CONTRACT_HEAVY)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sugest"], "did you mean 'suggest'"),
        (["suggest"], "--tissue"),
        (["suggest", "--tissue", "foot"], "known names are forefinger"),
        (["predict", "--young", "25", "--thickness", "5"], "exactly one of --depth"),
        (["predict", "--young", "25", "--thickness", "-5", "--depth", "1"], "thickness in mm = -5 is outside"),
        (["predict", "--young", "25", "--thickness", "5", "--depth", "4"], "0 to 3"),
        (["predict", "--young", "25", "--thickness", "5", "--depth", "1,a"], "depth in mm = a "),
        (["predict", "--resin", "polyurethane-nagoya", "--thickness", "5", "--depth", "1"], "--ratio"),
        (["whatif", "--thickness", "3:30:0.001", "--ratio", "14:17:0.001"], "1000000"),
        (["mold", "--thickness", "2"], "3 to 30"),
        (["loop", "no-such-folder"], "does not exist"),
    ],
)
def test_bad_input_is_one_line_and_status_2(words, says, capsys):
    assert cli.run(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("error: ") and err.count("\n") == 1
    assert says in err


def test_a_ratio_alone_is_of_the_resin_that_suggest_takes(capsys):
    def forces(*words: str) -> list[float]:
        assert cli.run(["predict", "--thickness", "10", "--depth", "1", "--ratio", "15.4", *words, "--json"]) == 0
        return json.loads(capsys.readouterr().out)["force_N"]

    assert forces() == forces("--resin", "polyurethane-nagoya")


def test_a_speed_is_refused_where_nothing_moves_at_it(capsys):
    words = ["predict", "--young", "25", "--thickness", "5", "--depth", "1", "--velocity", "10", "--json"]
    assert cli.run(words) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"]) == ("not_applicable", "velocity_mm_s")


def test_out_of_reach_is_status_1_and_json_still_has_the_reason(capsys):
    words = ["predict", "--young", "25", "--thickness", "5", "--force", "500", "--velocity", "10", "--json"]
    assert cli.run(words) == 1
    answer = json.loads(capsys.readouterr().out)
    assert answer["error"]["code"] == "out_of_reach"
    assert answer["schema"] == "dummydesign.predict/1"


def test_json_is_one_object_with_the_common_fields(capsys):
    assert cli.run(["predict", "--young", "25", "--thickness", "5", "--depth", "0,1", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    for key in ("schema", "version", "inputs", "warnings", "sources", "depth_mm", "force_N", "local_exponent"):
        assert key in answer
    for key in ("fidelity", "force_low_N", "force_high_N", "solver"):
        assert key in answer
    assert answer["force_N"][0] == 0.0


def test_a_fault_of_our_own_is_told_without_a_traceback(monkeypatch, capsys):
    monkeypatch.delenv("DUMMYDESIGN_DEBUG", raising=False)
    monkeypatch.setattr("dummydesign.pad.predict.predict_static", lambda *a: 1 / 0)
    assert cli.run(["predict", "--young", "25", "--thickness", "5", "--depth", "1"]) == 1
    _, err = capsys.readouterr()
    assert "internal error (" in err and "Traceback" not in err


def test_a_package_that_is_missing_is_named_with_the_command_that_brings_it(monkeypatch, capsys):
    from dummydesign.cli.commands import tissues

    def lacks(options):
        raise ModuleNotFoundError("No module named 'skfem.mesh'", name="skfem.mesh")

    monkeypatch.setattr(tissues, "run", lacks)
    assert cli.run(["tissues", "list", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"], error["value"]) == ("program_missing", "package", "scikit-fem")


def test_what_the_studio_lacks_is_brought_by_one_package(monkeypatch, tmp_path, capsys):
    for name in [one for one in sys.modules if one.startswith(("dummydesign.studio.app", "fastapi"))]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "fastapi", None)
    assert cli.run(["studio", str(tmp_path / "a"), "--no-browser", "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert (error["code"], error["quantity"], error["value"]) == ("program_missing", "package", "nicegui")


@pytest.mark.skipif(os.name == "nt", reason="pipes of a POSIX shell")
def test_a_reader_that_stops_early_is_no_error():
    command = f"{sys.executable} -m dummydesign | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], capture_output=True, text=True)
    assert done.returncode == 0
    assert done.stderr == ""


def test_predict_writes_its_curve_and_follows_a_motion_file(tmp_path, capsys):
    motion = tmp_path / "motion.csv"
    motion.write_text("time_s,displacement_mm\n0,-0.1\n0.1,1.0\n5,1.0\n")
    out = tmp_path / "curve.csv"
    words = ["predict", "--young", "25", "--thickness", "5", "--motion", str(motion), "--prony", "0.1:0.5"]
    assert cli.run([*words, "--out", str(out), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["peak_force_N"] > answer["steady_force_N"] > 0.0
    lines = out.read_text().splitlines()
    assert lines[0].startswith("time_s,displacement_mm,force_N")
    assert len(lines) == 4
    motion.write_text("time_s,displacement_mm\n0,0\n0.1,x\n")
    assert cli.run(words) == 2
    assert "motion.csv:3: displacement_mm = 'x' is not a number" in capsys.readouterr().err


@pytest.mark.slow
def test_predict_takes_friction_profiles_and_plates(tmp_path, capsys):
    profile = tmp_path / "ball.csv"
    profile.write_text("r_mm,z_mm\n" + "\n".join(f"{r},{r * r / 40.0}" for r in range(9)) + "\n")
    common = ["predict", "--young", "25", "--fidelity", "axisymmetric", "--json"]
    puck = ["--thickness", "30", "--depth", "3", "--punch", "plate", "--pad", "cylinder:50"]
    forces = []
    for words in (
        ["--thickness", "10", "--depth", "0.5,1", "--punch", f"profile:{profile}", "--condition", "frictionless"],
        ["--thickness", "10", "--depth", "0.5,1", "--punch", "ball:40", "--condition", "frictionless"],
        [*puck, "--condition", "frictionless"],
        puck,
    ):
        assert cli.run([*common, *words]) == 0
        forces.append(json.loads(capsys.readouterr().out)["force_N"][-1])
    free = 0.025 / 3.0 * (1.0 / 0.9**2 - 0.9) * 3.14159265 * 25.0**2
    profiled, ball, *pucks = forces
    assert pucks == [pytest.approx(free, rel=1e-3), pytest.approx(1.404 * free, rel=0.06)]
    # Paraboloid of radius 20 mm on a layer, c = 0.447: small-strain law, 2 % at this depth.
    assert ball == pytest.approx(profiled, rel=0.02)
    assert profiled == pytest.approx(16.0 / 9.0 * 0.025 * 20.0**0.5 * 1.97, rel=0.06)
    assert cli.run([*common, "--thickness", "10", "--depth", "1", "--punch", "profile:none.csv"]) == 2
    assert cli.run([*common, "--thickness", "10", "--depth", "1", "--punch", "plate"]) == 2
    capsys.readouterr()
    for words, says in (
        (["--base", "sliding"], "both plates hold a puck alike"),
        (["--shape", "crowned:10,2"], "pressed by a flat punch, not by a profile or plates"),
        (["--fidelity", "3d"], "fidelity = 3d is not for pucks"),
        (["--fidelity", "table"], "punch = plate is not in the table"),
    ):
        assert cli.run([*common, *puck, *words]) == 2
        assert says in capsys.readouterr().err
    profile.write_text("r_mm,z_mm\n0,0\n1,a\n2,3\n")
    capsys.readouterr()
    assert cli.run([*common, "--thickness", "10", "--depth", "1", "--punch", f"profile:{profile}"]) == 2
    assert "ball.csv:3" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["suggest", "--tissu", "palm"], "unknown option '--tissu': did you mean '--tissue'?"),
        (["mold", "--sites", "2x2"], "unknown option '--sites': it is an option of suggest; 'dummydesign mold --help'"),
        (["tissues", "add-curves", "a", "b.csv", "--lwa=x"], "unknown option '--lwa': did you mean '--law'?"),
        (["predict", "--thickness", "5", "--zzz"], "unknown option '--zzz': 'dummydesign predict --help' lists"),
    ],
)
def test_an_option_that_a_command_does_not_have_is_named_with_the_nearest_or_with_whose_it_is(words, says, capsys):
    assert cli.run(words) == 2
    error = capsys.readouterr().err.strip()
    assert error.startswith("error: ") and says in error and "\n" not in error


PRESS = ["predict", "--young", "30", "--thickness", "5", "--motion"]


@pytest.mark.parametrize("words", [["history"], ["status"], ["import"], PRESS])
def test_a_name_too_long_for_the_system_is_bad_input(words, capsys):
    assert cli.run([*words, "a" * 300]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ") and error.count("\n") == 1


def test_a_full_disk_is_one_line_and_status_2_wherever_it_is_met(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    whole = Path.write_text

    def full(self, text, *args, **more):
        if "plan" in str(self):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self))
        return whole(self, text, *args, **more)

    monkeypatch.setattr(Path, "write_text", full)
    assert cli.run(["campaign", "new", "plan", "--young", "25", "--no-power", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "file_unwritable"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no disk that is always full")
@pytest.mark.parametrize("buffered", [True, False])
def test_an_answer_that_cannot_be_printed_is_status_2(buffered):
    with open("/dev/full", "w", encoding="utf-8") as full:
        words = [sys.executable, "-m", "dummydesign", "tissues", "list"]
        environment = {**os.environ, "PYTHONUNBUFFERED": "" if buffered else "1"}
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, check=False, env=environment)
    assert done.returncode == 2
    assert done.stderr.startswith("error: ") and done.stderr.count("\n") == 1


@pytest.mark.skipif(os.name != "posix", reason="closes a stream by its number")
@pytest.mark.parametrize("stream", [1, 2])
def test_a_closed_stream_is_no_error(stream):
    words = f"exec {shlex.quote(sys.executable)} -m dummydesign tissues list {stream}>&-"
    done = subprocess.run(["sh", "-c", words], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and done.stderr == ""
    assert ("palm" in done.stdout) == (stream == 2)


@pytest.mark.parametrize("name", [".", "..", "folder"])
def test_a_folder_given_as_a_file_is_refused(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    words = ["predict", "--young", "30", "--thickness", "8", "--depth", "1", "--out", name, "--json"]
    assert cli.run(words) == 2
    assert json.loads(capsys.readouterr().out)["error"]["code"] == "file_unwritable"
