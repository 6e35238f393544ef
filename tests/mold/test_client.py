"""The command and the child process: answers, refusals, crashes, and what is left in the folder."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import dummydesign
from dummydesign import cli, make_mould
from dummydesign.mold import client
from dummydesign.mold.model.preset import mould_spec
from tests.support.mould_checks import no_check_fails
from tests.support.refusal import raises_code


def _files(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.rglob("*")) if folder.exists() else []


@pytest.mark.slow
def test_command_gives_one_json_object_with_the_contract(lidded_package, lidded_spec):
    _, result = lidded_package
    answer = result.answer
    assert answer["schema"] == "dummydesign.mold/1" and answer["inputs"]["ratio"] == 15.0
    assert {"pad", "mould", "master", "frame", "assembly", "lid", "tray"} <= set(result.files)
    for role, path in result.files.items():
        assert Path(path).is_file() and Path(path).stat().st_size > 0, role
    assert Path(result.files["mould"]).name == "mould_t8.step"
    assert {"cavity", "pad_nominal", "pad_compensated", "mould", "master", "frame"} <= set(result.volumes_mm3)
    assert set(result.masses_g) == {"polyol", "isocyanate", "silicone", "silicone (lid)"}
    assert no_check_fails(result.checks)
    assert len({item["id"] for item in result.checks}) == len(result.checks) > 35
    assert result.spec_hash == lidded_spec.hash and len(result.step_sha256) == 64
    assert answer["sources"] and answer["warnings"]


@pytest.mark.slow
def test_text_answer_shows_weights_checks_and_files(lidded_package):
    from dummydesign.cli.commands.mold import render

    text = render(lidded_package[1].answer)
    assert "polyol" in text and " 0 failed" in text and "mould_t8.step" in text and "None" not in text


BAD = [
    (["--thickness", "2"], "thickness_mm = 2"),
    (["--thickness", "31"], "3 to 30"),
    (["--thickness", "nan"], "thickness in mm"),
    (["--thickness", "five"], "five"),
    ([], "--thickness"),
    (["--thickness", "5", "--length", "400"], "printer bed"),
    (["--thickness", "5", "--preset", "opened"], "did you mean 'open'"),
    (["--thickness", "5", "--shape", "slab:x"], "not a number"),
    (["--thickness", "5", "--ratio", "99"], "99"),
]


@pytest.mark.parametrize("arguments, named", BAD)
def test_bad_input_ends_with_status_2_one_line_and_no_file(arguments, named, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.run(["mold", *arguments]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: ") and message.count("\n") == 1 and named in message
    assert _files(tmp_path) == []


def test_output_that_is_a_file_is_bad_input(tmp_path, capsys):
    (tmp_path / "taken").write_text("mine")
    assert cli.run(["mold", "--thickness", "5", "--out", str(tmp_path / "taken")]) == 2
    assert "cannot be written" in capsys.readouterr().err
    assert (tmp_path / "taken").read_text() == "mine"


def _worker(monkeypatch, code: str) -> None:
    monkeypatch.setattr(client, "WORKER", ("-c", code))


def test_crash_of_the_kernel_is_told_with_the_parameters_and_harms_nothing(monkeypatch, tmp_path):
    (tmp_path / "mould_t5.step").write_text("earlier")
    _worker(monkeypatch, "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    with raises_code("cad_failed", "mould") as caught:
        make_mould(5, out=tmp_path)
    assert caught.value.result["masses_g"]["polyol"] > 80
    assert _files(tmp_path) == ["mould_t5.step"] and (tmp_path / "mould_t5.step").read_text() == "earlier"


LIMITED = (
    "import json, sys; from dummydesign.core.blas_threads import limit_processor_time; sys.stdin.read(); "
    "limit_processor_time(json.load(open(sys.argv[1]))['processor_s']);"
)


@pytest.mark.slow
def test_a_kernel_that_never_ends_is_stopped_by_its_processor_time_and_that_is_told(monkeypatch, tmp_path):
    _worker(monkeypatch, f"{LIMITED}\nwhile True: pass")
    with raises_code("cad_failed", "mould") as caught:
        client.make_mold(mould_spec(5), tmp_path, processor_s=1.0)
    assert caught.value.code == "cad_failed" and _files(tmp_path) == []


def test_a_child_started_ahead_takes_the_next_question_and_work_goes_on_beside_it(monkeypatch):
    _worker(monkeypatch, "import sys; sys.stdin.read(); open(sys.argv[2], 'w').write(open(sys.argv[1]).read())")
    with client.child_ahead() as child:
        beside = []
        child.meanwhile = lambda: beside.append(child._process.poll())
        assert client._answered({"number": 7}, 60.0)[1] == {"number": 7}
        assert len(beside) == 1 and not Path(child._work.name).exists()
        # the next question has a child of its own
        assert client._answered({"number": 8}, 60.0)[1] == {"number": 8} and len(beside) == 1


def test_a_child_that_was_not_asked_is_ended(monkeypatch):
    _worker(monkeypatch, "import sys; sys.stdin.read(); sys.exit(3)")
    with pytest.raises(KeyError), client.child_ahead() as child:
        assert child._process.poll() is None
        raise KeyError
    assert child._process.returncode not in (None, 3) and not Path(child._work.name).exists() and client._started == []


@pytest.mark.slow
def test_a_kernel_that_waits_for_a_busy_machine_is_not_stopped(monkeypatch, tmp_path):
    """Three times the limit by the clock, hardly any of the processor."""
    answer = json.dumps({"error": {"code": "cad_failed", "message": "came to its end"}})
    code = f"{LIMITED} import time, pathlib; time.sleep(3)\n"
    code += f"pathlib.Path(sys.argv[2]).write_text({answer!r})"
    _worker(monkeypatch, code)
    with raises_code("cad_failed", "mould"):
        client.make_mold(mould_spec(5), tmp_path, processor_s=1.0)


@pytest.mark.slow
def test_the_worker_takes_its_limit_from_the_question(tmp_path):
    code = (
        "import sys, resource; from dummydesign.mold import child_main;"
        "child_main.run = lambda *_: {}; child_main.main();"
        "print(resource.getrlimit(resource.RLIMIT_CPU)[0])"
    )
    pytest.importorskip("resource")
    (tmp_path / "question.json").write_text('{"processor_s": 77.0}')
    words = [sys.executable, "-c", code, str(tmp_path / "question.json"), str(tmp_path / "answer.json")]
    assert subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip() == "77"


@pytest.mark.slow
def test_failed_check_keeps_no_file_but_reports_all_checks(monkeypatch, tmp_path):
    found = {
        "files": {"mould": "mould_t5.step"},
        "volumes_mm3": {},
        "step_sha256": "0",
        "warnings": [],
        "batch": {},
        "checks": [{"id": "draft_cavity", "value": -2.0, "limit": 1.99, "status": "fail"}],
        "pour": {"components": [], "silicone_mass_g": 1.0, "lid_silicone_mass_g": 0.0},
        "seconds": 1.0,
        "memory_MB": 1.0,
    }
    code = (
        "import json, sys, pathlib; sys.stdin.read(); folder = json.load(open(sys.argv[1]))['folder']; "
        "(pathlib.Path(folder) / 'mould_t5.step').write_text('bad'); "
        f"pathlib.Path(sys.argv[2]).write_text({json.dumps(found)!r})"
    )
    _worker(monkeypatch, code)
    for make in (make_mould, lambda thickness, out: client.make_mold(mould_spec(thickness), out)):
        with raises_code("check_failed", "mould") as caught:
            make(5, out=tmp_path)
        assert caught.value.result["checks"][0]["status"] == "fail" and caught.value.result["files"] == {}
        assert _files(tmp_path) == []
    # The report of a design stands without its mould: nothing of the refused one may lie beside it.
    with raises_code("check_failed", "mould"):
        dummydesign.suggest(
            "forefinger",
            shape="crowned:21.2,2,9.4",
            thickness_mm=(4.5, 4.5),
            ratio=(15.3, 15.5),
            verify=False,
            out=tmp_path / "design",
        )
    kept = _files(tmp_path / "design")
    assert "suggest.json" in kept and not {"mould_t5.step", "spec.json"} & set(kept)


def test_final_name_taken_by_a_folder_is_refused(monkeypatch, tmp_path):
    (tmp_path / "mould_t5.step").mkdir()
    found = {
        "files": {"mould": "mould_t5.step"},
        "volumes_mm3": {},
        "step_sha256": "0",
        "warnings": [],
        "batch": {},
        "checks": [],
        "pour": {"components": [], "silicone_mass_g": 1.0, "lid_silicone_mass_g": 0.0},
        "seconds": 1.0,
        "memory_MB": 1.0,
    }
    code = (
        "import json, sys, pathlib; sys.stdin.read(); folder = json.load(open(sys.argv[1]))['folder']; "
        "(pathlib.Path(folder) / 'mould_t5.step').write_text('good'); "
        f"pathlib.Path(sys.argv[2]).write_text({json.dumps(found)!r})"
    )
    _worker(monkeypatch, code)
    with raises_code("file_exists", "out"):
        client.make_mold(mould_spec(5), tmp_path)
    assert _files(tmp_path) == ["mould_t5.step"]


def test_a_folder_that_has_a_final_name_is_left_and_the_mould_goes_into_a_folder_beside(monkeypatch, tmp_path):
    out = tmp_path / "out"
    (out / "mould_t5.step").mkdir(parents=True)
    found = {
        "files": {"mould": "mould_t5.step"},
        "volumes_mm3": {},
        "step_sha256": "0",
        "warnings": [],
        "batch": {},
        "checks": [],
        "pour": {"components": [], "silicone_mass_g": 1.0, "lid_silicone_mass_g": 0.0},
        "seconds": 1.0,
        "memory_MB": 1.0,
    }
    code = (
        "import json, sys, pathlib; sys.stdin.read(); folder = json.load(open(sys.argv[1]))['folder']; "
        "(pathlib.Path(folder) / 'mould_t5.step').write_text('good'); "
        f"pathlib.Path(sys.argv[2]).write_text({json.dumps(found)!r})"
    )
    _worker(monkeypatch, code)
    answer = make_mould(5, out=out)
    made = Path(answer.result["files"]["mould"])
    assert _files(out) == ["mould_t5.step"] and made.read_text() == "good" and made.parent.parent == tmp_path
    assert answer.outcome.files == {"mould": str(made)}


@pytest.mark.parametrize(
    "fault, fix",
    [
        ("raise ImportError('libGL.so.1: cannot open shared object file')", "apt-get install libgl1 libx11-6"),
        ("raise ModuleNotFoundError('no module', name='cadquery')", "pip install cadquery"),
    ],
)
def test_missing_cad_gives_the_weights_and_the_line_to_type(fault, fix, tmp_path):
    shadow = tmp_path / "shadow"
    shadow.mkdir()
    (shadow / "cadquery.py").write_text(fault)
    out = tmp_path / "out"
    root = str(Path(cli.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(shadow), root])}
    command = [sys.executable, "-m", "dummydesign", "mold", "--thickness", "5", "--out", str(out), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    answer = json.loads(done.stdout)
    assert done.returncode == 1
    assert answer["error"]["code"] == "cad_unavailable" and fix in answer["error"]["message"]
    assert fix in done.stderr and done.stderr.count("\n") == 1
    assert answer["masses_g"]["isocyanate"] > 10 and answer["files"] == {}
    assert _files(out) == []


@pytest.mark.slow
def test_weights_without_cad_match_those_with_it(lidded_package, lidded_spec):
    _, result = lidded_package
    known = client.without_cad(lidded_spec)["masses_g"]
    for name in ("polyol", "isocyanate"):
        assert known[name] == pytest.approx(result.masses_g[name], abs=0.11)


SWEEP = [
    (3, 150, 120, "open", {}),
    (30, 150, 120, "open", {}),
    (7.5, 150, 120, "open", {}),
    (3, 150, 120, "lidded", {}),
    (30, 150, 120, "lidded", {}),
    (5, 20, 20, "open", {}),
    (30, 20, 20, "open", {}),
    (20, 30, 140, "open", {}),
    (12, 50, 50, "lidded", {}),
    (5, 120, 142, "lidded", {}),
    (10, 80, 60, "open", {"draft_deg": 0.0}),
    (10, 80, 60, "open", {"edge_radius_mm": 0.0}),
    (10, 80, 60, "open", {"corner_radius_mm": 0.5, "edge_radius_mm": 0.0}),
    (3, 80, 60, "open", {"edge_radius_mm": 2.6}),
    (10, 80, 60, "open", {"draft_deg": 10.0}),
    (30, 80, 60, "lidded", {"draft_deg": 0.0}),
]


@pytest.mark.slow
@pytest.mark.parametrize("thickness, length, width, preset, pad", SWEEP)
def test_every_corner_of_the_range_builds(thickness, length, width, preset, pad, tmp_path):
    from dataclasses import replace

    spec = mould_spec(thickness, length, width, preset)
    spec = replace(spec, pad=replace(spec.pad, **pad))
    result = client.make_mold(spec, tmp_path)
    assert no_check_fails(result.checks)


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
def test_names_in_any_script_work_to_the_end(encoding, tmp_path):
    """Resin, preset and folder; also where the terminal has no such letters."""
    root, home = Path(dummydesign.__file__).parents[1], tmp_path / "家"
    (home / "materials/resins").mkdir(parents=True)
    (home / "molds").mkdir()
    resin = (root / "materials/resins/polyurethane-nagoya.toml").read_text(encoding="utf-8")
    resin = resin.replace('name = "polyurethane-nagoya"', 'name = "樹脂-weiß"')
    (home / "materials/resins/樹脂-weiß.toml").write_text(resin, encoding="utf-8")
    (home / "molds/型-für.toml").write_bytes((root / "molds/open.toml").read_bytes())
    command = [
        sys.executable,
        "-m",
        "dummydesign",
        "mold",
        "--thickness",
        "5",
        "--length",
        "60",
        "--width",
        "60",
        "--resin",
        "樹脂-weiß",
        "--ratio",
        "15",
        "--preset",
        "型-für",
        "--out",
        "出力-ö",
    ]
    environment = {**os.environ, "DUMMYDESIGN_HOME": str(home), "PYTHONIOENCODING": encoding, "PYTHONPATH": str(root)}
    done = subprocess.run(command, capture_output=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    name = "樹脂-weiß".encode(encoding, "backslashreplace")
    assert name in done.stdout and b" 0 failed" in done.stdout
    out = tmp_path / "出力-ö"
    assert "樹脂-weiß" in (out / "pour_t5.html").read_text(encoding="utf-8")
    assert r"\X2\6A398102\X0\-wei\X2\00DF\X0" in (out / "assembly_t5.step").read_text(encoding="ascii")
    assert no_check_fails(json.loads((out / "checks.json").read_text(encoding="utf-8")))
