"""``dummydesign import`` as a technician meets it: traces, JSON, questions, profiles, sources left alone."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest

import dummydesign
from dummydesign.cli.commands.import_ import pairs
from dummydesign.cli.entry import run
from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.read import trace_bytes
from dummydesign.measurement.trace import read_trace
from tests.support.machine_files import machine_file
from tests.support.machine_presses import recording


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path / "home"))
    monkeypatch.chdir(tmp_path)


def asked(capsys, *words):
    status = run(["import", *map(str, words), "--json"])
    out = capsys.readouterr()
    return status, json.loads(out.out) if status == 0 else None, out.err


def write(path, head="Zeit [s];Weg [mm];Kraft [N]", seed=4, presses=1, tare=0.0, **options):
    record = recording(seed, presses, velocity_mm_s=10.0, **options)
    columns = (record.time_s, record.displacement_mm, record.force_N + tare)
    rows = (";".join(f"{cell:.4f}".replace(".", ",") for cell in row) for row in zip(*columns))
    path.write_text("\n".join([*([head] if head else []), *rows]) + "\n", encoding="cp1252")
    return record


def test_the_json_has_what_the_contract_names_and_the_traces_are_canonical(tmp_path, capsys):
    record = write(tmp_path / "a.csv", presses=2, tare=0.8)
    status, result, _ = asked(capsys, "a.csv", "--out", "out")
    assert status == 0 and result["schema"] == "dummydesign.import/1" and result["inputs"]["tare"] == "auto"
    (file,) = result["files"]
    assert file["source"] == "a.csv" and {"what", "value", "why"} == set(file["decisions"][0])
    assert [trace["press"] for trace in file["traces"]] == [1, 2]
    for trace, depth in zip(file["traces"], record.depth_mm):
        assert not trace["file"].count("/")
        read = read_trace(tmp_path / "out" / trace["file"])
        assert len(read.time_s) == trace["samples"] and read.time_s[0] == 0.0
        assert trace["depth_mm"] == pytest.approx(depth, abs=0.01)
        assert trace["velocity_mm_s"] == pytest.approx(10.0, rel=0.02)
        assert trace["hold_s"] == pytest.approx(record.hold_s, rel=0.05)
        assert trace["peak_force_N"] == pytest.approx(read.force_N.max(), abs=1e-5)
        assert abs(read.force_N[:20].mean()) < 0.05 and read.displacement_mm[0] < 0
    page = (tmp_path / result["preview"]).read_text(encoding="utf-8")
    assert page.count('<div class="plot"') == 3 and "http" not in page.replace("http-equiv", "")
    assert not list((tmp_path / "out").glob(".*"))


def test_the_same_command_gives_the_same_answer_and_the_source_stays_as_it_is(tmp_path, capsys):
    write(tmp_path / "a.csv")

    def state():
        return hashlib.sha256((tmp_path / "a.csv").read_bytes()).hexdigest(), (tmp_path / "a.csv").stat().st_mtime_ns

    before = state()
    first = asked(capsys, "a.csv")[1]
    assert asked(capsys, "a.csv")[1] == first
    assert state() == before


def test_the_call_from_python_is_the_answer_of_the_command(tmp_path, capsys):
    write(tmp_path / "a.csv", head="Zeit;Weg;Kraft")
    units = {"time": "s", "displacement": "mm", "force": "N"}
    mine = dummydesign.import_traces(["a.csv"], units=units, tare="none", out="out")
    _, theirs, _ = asked(capsys, "a.csv", "--units", "time=s,displacement=mm,force=N", "--tare", "none", "--out", "out")
    assert mine.to_dict() == {key: theirs[key] for key in mine.to_dict()}
    unwritten = dummydesign.import_traces(["a.csv"], units=units, tare="none")
    assert unwritten.to_dict()["preview"] is None
    assert len(unwritten.outcome[0].presses[0].time_s) == mine.to_dict()["files"][0]["traces"][0]["samples"]


def test_an_imported_trace_imports_to_itself(tmp_path, capsys):
    write(tmp_path / "a.csv", tare=0.8)
    assert asked(capsys, "a.csv", "--out", "once")[0] == 0
    assert asked(capsys, "once/a_1.csv", "--out", "twice")[0] == 0
    assert (tmp_path / "once/a_1.csv").read_bytes() == (tmp_path / "twice/a_1_1.csv").read_bytes()


def test_traces_are_written_as_python_writes_numbers():
    values = np.array([[0.0, -1.0, 1e-7], [12345.6789012, -0.0000004, -0.5], [1e6, 99.9999996, -1234.000001]])
    wanted = "".join("{:.6f},{:.6f},{:.6f}\n".format(*row) for row in values).replace("-0.000000", "0.000000")
    assert trace_bytes(*values.T) == b"time_s,displacement_mm,force_N\n" + wanted.encode()


def test_a_trace_never_takes_the_place_of_a_file_that_is_read(tmp_path, capsys):
    write(tmp_path / "a.csv")
    write(tmp_path / "a_1.csv")
    status, _, err = asked(capsys, "a.csv", "a_1.csv", "--out", ".")
    assert status == 2 and "take the place of a file that is read" in err


def test_a_folder_is_read_whole_and_what_holds_no_table_is_named(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    for number in range(3):
        write(tmp_path / "in" / f"p{number}.csv", seed=number)
    (tmp_path / "in" / "README.txt").write_text("pressed on Monday\n")
    (tmp_path / "in" / "photo.png").write_bytes(b"\x89PNG")
    status, result, _ = asked(capsys, "in")
    assert status == 0 and len(result["files"]) == 3 and result["inputs"]["out"] == "import-in"
    assert [w["message"] for w in result["warnings"] if w["code"] == "skipped"] == [
        "README.txt is left out: it holds no table of numbers"
    ]


def test_one_recording_under_two_names_is_told(tmp_path, capsys):
    write(tmp_path / "anna.csv")
    write(tmp_path / "bert.csv")
    result = asked(capsys, "anna.csv", "bert.csv")[1]
    assert [w["code"] for w in result["warnings"] if w["code"] == "same_press"] == ["same_press"]


def test_a_doubt_is_exit_2_with_the_option_that_settles_it(tmp_path, capsys):
    write(tmp_path / "a.csv", head="Zeit;Weg;Kraft")
    status, _, err = asked(capsys, "a.csv")
    assert status == 2 and err.count("\n") == 1 and err.startswith("error: a.csv: ")
    assert "--units time=s,displacement=mm,force=N" in err
    assert not (tmp_path / "import-a").exists()
    assert asked(capsys, "a.csv", "--units", "time=s,displacement=mm,force=N")[0] == 0


def test_a_doubt_about_one_file_of_a_folder_writes_nothing(tmp_path, capsys):
    (tmp_path / "in").mkdir()
    write(tmp_path / "in" / "a.csv")
    write(tmp_path / "in" / "b.csv", head="Zeit;Weg;Kraft")
    write(tmp_path / "in" / "c.csv", head="Zeit;Weg;Kraft")
    status, _, err = asked(capsys, "in")
    assert status == 2 and "2 files" in err and "b.csv, c.csv" in err and not (tmp_path / "import-in").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "needs a FILE"),
        (["none.csv"], "does not exist"),
        (["."], "holds no file that may be a trace"),
        (["a.csv", "--tare", "much"], "--tare much is not auto, none or a reading"),
        (["a.csv", "--tare", "1 3N"], "--tare 1 3N is not auto, none or a reading"),
        (["a.csv", "--contact", "3N"], "--contact 3N"),
        (["a.csv", "--units", "force=mm"], "is not a unit of force"),
        (["a.csv", "--units", "forse=N"], "roles time, displacement, force"),
        (["a.csv", "--columns", "force=Karft"], "did you mean"),
        (["a.csv", "--skip", "-1"], "skip"),
        (["a.csv", "--decimal", "x"], "is not one of . ,"),
        (["a.csv", "--split", "some"], "is not one of auto none"),
        (["a.csv", "--flip", "time"], "--flip 'time'"),
        (["a.csv", "--separator", "x"], "--separator 'x'"),
        (["a.csv", "--encoding", "klingon"], "klingon"),
        (["a.csv", "--profile", "none"], "unknown profile 'none'"),
        (["a.csv", "--save-profile", "a/b"], "profile's name"),
    ],
)
def test_bad_input_is_one_line_and_exit_2(tmp_path, capsys, words, says):
    if "." not in words:
        write(tmp_path / "a.csv")
    status, _, err = asked(capsys, *words)
    assert status == 2 and err.startswith("error: ") and err.count("\n") == 1 and says in err


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "is empty"),
        ("time_s,displacement_mm,force_N\n", "no rows of numbers"),
        ("time_s,displacement_mm,force_N\n" + "".join(f"{i},{i},0\n" for i in range(40)), "nothing is pressed"),
        ("time_s,displacement_mm\n" + "".join(f"{i},{i}\n" for i in range(40)), "no column is force"),
        (
            "time_s,displacement_mm,force_N\n" + "".join(f"{i},{i},{'nan' if i == 20 else i}\n" for i in range(40)),
            "a.csv:22: force_N: 'nan'",
        ),
        (
            "time_s,displacement_mm,force_N\n" + "".join(f"{i},{i},{i}\n" for i in range(40)) + "41,2",
            "still being written",
        ),
    ],
)
def test_a_file_that_is_no_press_says_why(tmp_path, capsys, text, says):
    (tmp_path / "a.csv").write_text(text)
    status, _, err = asked(capsys, "a.csv")
    assert status == 2 and says in err and err.count("\n") == 1


def test_given_readings_are_taken_as_the_file_counts_them(tmp_path, capsys):
    record = recording(4, velocity_mm_s=10.0)
    columns = (record.time_s, 300.0 - record.displacement_mm, 1.5 - record.force_N)
    rows = (",".join(f"{cell:.5f}" for cell in row) for row in zip(*columns))
    (tmp_path / "r.csv").write_text("\n".join(["t [s],z [mm],fz [N]", *rows]) + "\n")
    status, result, _ = asked(capsys, "r.csv", "--contact", "300", "--tare", "1500mN")
    assert status == 0
    trace = read_trace(tmp_path / "import-r" / result["files"][0]["traces"][0]["file"])
    assert np.allclose(trace.displacement_mm, record.displacement_mm, atol=1e-4)
    assert np.allclose(trace.force_N, record.force_N, atol=1e-4)
    status, result, _ = asked(
        capsys, "r.csv", "--contact", "30cm", "--tare", "none", "--split", "none", "--flip", "displacement,force"
    )
    assert result["inputs"]["out"] == "import-r-2"
    trace = read_trace(tmp_path / "import-r-2" / result["files"][0]["traces"][0]["file"])
    assert status == 0 and np.allclose(trace.force_N, record.force_N - 1.5, atol=1e-4)


def test_a_profile_is_kept_used_listed_and_not_lost(tmp_path, capsys):
    write(tmp_path / "a.csv", head="Zeit;Weg;Kraft")
    units = ["--units", "time=s,displacement=mm,force=N"]
    status, result, _ = asked(capsys, "a.csv", *units, "--save-profile", "my-zwick")
    assert status == 0 and result["profile"].endswith("my-zwick.toml")
    status, result, _ = asked(capsys, "--list")
    assert status == 0 and [one["name"] for one in result["profiles"]] == ["my-zwick"]
    status, result, _ = asked(capsys, "a.csv", "--profile", "MY-ZWICK")
    assert status == 0 and result["inputs"]["units"]["force"] == "N" and result["inputs"]["columns"]["force"] == "Kraft"
    words = ["a.csv", "--profile", "my-zwick", "--tare", "none", "--save-profile", "my-zwick", "--out", "other"]
    status, _, err = asked(capsys, *words)
    assert status == 2 and "--replace" in err and not (tmp_path / "other").exists()
    assert asked(capsys, *words, "--replace")[0] == 0
    result = asked(capsys, "a.csv", "--profile", str(tmp_path / "home/profiles/my-zwick.toml"))[1]
    assert result["inputs"]["tare"] == "none"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("colums = 3", "did you mean 'columns'"),
        ("skip = 'a'", "whole number"),
        ("skip = -1", "skip"),
        ("rate = 0", "rate"),
        ("flip = ['x']", "displacement force"),
        ("columns = 3", "columns"),
        ("columns = {speed = 'v'}", "speed"),
        ("tare = 3", "tare"),
        ("schema = 2", "schema"),
        ("a = [", "not valid TOML"),
    ],
)
def test_a_damaged_profile_is_named(tmp_path, capsys, text, says):
    write(tmp_path / "a.csv")
    (tmp_path / "p.toml").write_text(text)
    status, _, err = asked(capsys, "a.csv", "--profile", "p.toml")
    assert status == 2 and says in err and err.count("\n") == 1


def test_settings_are_read_although_names_hold_commas():
    assert pairs("columns", "time=Time, s,force=Load, N") == {"time": "Time, s", "force": "Load, N"}
    for wrong in ("", "time", "speed=3", "time=a,time=b", "time="):
        with pytest.raises(InputError):
            pairs("columns", wrong)


def test_a_workbook_is_read_like_text(tmp_path, capsys):
    openpyxl = pytest.importorskip("openpyxl")
    record = recording(4, velocity_mm_s=10.0, hold_s=3.0)
    book = openpyxl.Workbook()
    book.active.append(["made by hand"])
    book.create_sheet("Test").append(["Zeit [s]", "Weg [mm]", "Kraft [N]"])
    for row in zip(record.time_s.tolist(), record.displacement_mm.tolist(), record.force_N.tolist()):
        book["Test"].append(row)
    book.save(tmp_path / "a.xlsx")
    status, result, _ = asked(capsys, "a.xlsx")
    assert status == 0
    trace = read_trace(tmp_path / "import-a" / result["files"][0]["traces"][0]["file"])
    assert np.allclose(trace.displacement_mm, record.displacement_mm, atol=1e-5)


def test_readable_tables_show_decisions_and_traces(tmp_path, capsys):
    made = machine_file(5)
    (tmp_path / made.name).write_bytes(made.data)
    assert run(["import", made.name, "--details"]) == 0
    out = capsys.readouterr().out
    assert "Standardkraft" in out and "preview: " in out and "press_00005_1.csv" in out
