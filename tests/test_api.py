"""The calls for scripts: lazy, the same answers as the command line, dicts and tables; and the examples run."""

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import dummydesign
from dummydesign.cli import run
from dummydesign.errors import InputError

ROOT = Path(__file__).parent.parent
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def test_importing_the_package_imports_no_numerics():
    code = "import sys, dummydesign; dir(dummydesign); print(sorted({'numpy', 'scipy', 'pandas'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
    with pytest.raises(AttributeError, match="no attribute 'suggests'"):
        _ = dummydesign.suggests


def test_suggest_is_the_answer_of_the_command(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    answer = dummydesign.suggest("palm", thickness_mm=(8, 16), ratio=(15, 16), out=tmp_path / "a")
    arguments = ["--tissue", "palm", "--thickness", "8:16", "--ratio", "15:16", "--no-cad", "--no-verify", "--json"]
    assert run(["suggest", *arguments, "--out", "b"]) == 0
    printed = json.loads(capsys.readouterr().out)
    mine = json.loads(json.dumps(answer.to_dict()))
    for key in ("recommendation", "alternatives", "sensitivity", "warnings", "sources"):
        assert mine[key] == printed[key]
    assert (tmp_path / "a" / "report.html").read_text() == (tmp_path / "b" / "report.html").read_text()
    frame = answer.to_frame() if has_pandas() else None
    if frame is not None:
        assert frame["thickness_mm"][0] == mine["recommendation"]["thickness_mm"]
        assert len(frame) == 1 + len(mine["alternatives"]) and "scores.total" in frame


def has_pandas():
    try:
        import pandas  # noqa: F401
    except ImportError:
        return False
    return True


def test_whatif_takes_numbers_lists_and_text_alike(tmp_path):
    by_text = dummydesign.whatif("5:15:5", "15,16", force_N="5", velocity_mm_s=10)
    by_list = dummydesign.whatif([5, 10, 15], (15, 16), force_N=5, velocity_mm_s=[10.0])
    assert by_text.rows == by_list.rows and len(by_text.rows) == 6
    with ThreadPoolExecutor(2) as pool:
        assert dummydesign.whatif("5:15:5", "15,16", force_N=5, velocity_mm_s=10, executor=pool).rows == by_text.rows
    written = dummydesign.whatif("5:15:5", "15,16", force_N=5, velocity_mm_s=10, out=tmp_path)
    assert Path(written.files["rows"]).exists() and Path(written.files["report"]).exists()
    assert written.to_dict()["rows"] == [dict(row) for row in by_text.rows]
    if has_pandas():
        frame = by_text.to_frame()
        assert list(frame["thickness_mm"]) == [5.0, 5.0, 10.0, 10.0, 15.0, 15.0]
        assert frame["depth_mm_at_N.5"][0] == by_text.rows[0]["depth_mm_at_N"]["5"]


def test_tables_without_pandas_say_what_to_do(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pip install pandas"):
        dummydesign.whatif(5).to_frame()


@pytest.mark.parametrize("values", ["", "a", [], [None], object()])
def test_what_is_not_numbers_is_refused(values):
    with pytest.raises(InputError, match="thickness in mm"):
        dummydesign.whatif(values)


def test_refusals_leave_no_folder(tmp_path):
    for call in (
        lambda: dummydesign.suggest("plam", out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, 99, out=tmp_path / "x"),
        lambda: dummydesign.whatif(5, tissue="plam", out=tmp_path / "x"),
    ):
        with pytest.raises(InputError):
            call()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_runs_and_prints(path, tmp_path):
    environment = {"PYTHONPATH": str(ROOT), "PATH": "", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run([sys.executable, str(path)], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) >= 3 and "nan" not in done.stdout


def test_there_is_an_example_of_every_call():
    text = "".join(path.read_text() for path in EXAMPLES)
    assert all(f"dummydesign.{name}(" in text for name in ("suggest", "whatif", "fit"))
