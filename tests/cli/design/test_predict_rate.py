"""``predict --rate``: the curve's CSV at a uniform rate, by interpolation of the untouched one."""

import numpy as np
import pytest

from dummydesign.cli.entry import run

PAD = ["predict", "--young", "30", "--thickness", "10", "--prony", "0.1:0.3"]
PRESS = [*PAD, "--force", "5", "--velocity", "50", "--hold", "0.5"]


def table(path):
    return np.genfromtxt(path, delimiter=",", names=True)


def test_values_are_interpolated_at_uniform_times(tmp_path):
    assert run([*PRESS, "--out", str(tmp_path / "own.csv")]) == 0
    assert run([*PRESS, "--out", str(tmp_path / "even.csv"), "--rate", "200"]) == 0
    own, even = table(tmp_path / "own.csv"), table(tmp_path / "even.csv")
    assert np.ptp(np.diff(own["time_s"])) > 1e-3  # the answer's own times are not uniform
    assert np.allclose(np.diff(even["time_s"]), 1 / 200, rtol=0, atol=1e-7)
    assert even["time_s"][0] == own["time_s"][0]
    assert 0 <= own["time_s"][-1] - even["time_s"][-1] < 1 / 200
    for name in own.dtype.names[1:]:
        assert np.allclose(even[name], np.interp(even["time_s"], own["time_s"], own[name]), rtol=1e-6, atol=1e-6)


def test_a_motion_that_begins_late_and_several_presses(tmp_path):
    (tmp_path / "m.csv").write_text("time_s,displacement_mm\n0.3,0\n0.35,1\n0.5,1.5\n0.9,1.5\n", encoding="utf-8")
    assert run([*PAD, "--motion", str(tmp_path / "m.csv"), "--rate", "100Hz", "--out", str(tmp_path / "a.csv")]) == 0
    assert np.allclose(table(tmp_path / "a.csv")["time_s"], 0.3 + np.arange(61) / 100, atol=1e-7)
    words = [*PAD, "--force", "2,5", "--velocity", "50", "--hold", "0.2", "--rate", "500"]
    assert run([*words, "--out", str(tmp_path / "b.csv")]) == 0
    found = sorted(tmp_path.glob("b_*.csv"))
    assert len(found) == 2
    assert all(np.allclose(np.diff(table(path)["time_s"]), 0.002, atol=1e-7) for path in found)


@pytest.mark.parametrize("rate", ["0", "-5", "1e9", "nan", "fast", "100kg"])
def test_a_rate_that_cannot_be_is_one_line(tmp_path, capsys, rate):
    assert run([*PRESS, "--out", str(tmp_path / "a.csv"), "--rate", rate]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ") and error.count("\n") == 1 and "rate" in error
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("words", [["--hold", "3600", "--rate", "1000", "--out", "a.csv"], ["--rate", "100"]])
def test_too_many_rows_and_no_file_are_refused(tmp_path, monkeypatch, capsys, words):
    monkeypatch.chdir(tmp_path)
    assert run([*PAD, "--force", "5", "--velocity", "50", *words]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_static_depths_have_no_rate(tmp_path, capsys):
    assert run([*PAD, "--depth", "1,2", "--rate", "100", "--out", str(tmp_path / "a.csv")]) == 2
    assert "rate" in capsys.readouterr().err
