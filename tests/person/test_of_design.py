"""A press that `predict` writes of the recommended pad, on people: the peaks that `suggest` compares it with."""

from __future__ import annotations

import json

import pytest

from dummydesign.cli import run


@pytest.mark.slow
def test_on_person_has_the_peaks_of_people_that_suggest_compares_the_pad_with(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run(["suggest", "--tissue", "palm", "--shape", "slab", "--no-cad", "--out", "o", "--json"])
    chosen = json.loads(capsys.readouterr().out)["recommendation"]
    row = next(row for row in chosen["conditions"] if (row["velocity_mm_s"], row["steady_force_N"]) == (250.0, 10.0))
    pad = ["--ratio", str(chosen["ratio"]), "--thickness", str(chosen["thickness_mm"])]
    assert run(["predict", *pad, "--force", "10", "--velocity", "250", "--hold", "10", "--out", "press.csv"]) == 0
    capsys.readouterr()
    assert run(["on-person", "press.csv", "--tissue", "palm", "--drive", "steady", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["presses"][0]
    assert found["pad"]["peak_N"] == pytest.approx(row["peak_force_N"], rel=5e-3)
    factors = row["target_peak_low_N"] / row["peak_force_N"], row["target_peak_high_N"] / row["peak_force_N"]
    assert found["factor_peak"] == pytest.approx(factors, rel=1e-2)
