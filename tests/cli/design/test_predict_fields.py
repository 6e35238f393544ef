"""``predict --fields`` and ``--picture``."""

import json

import pytest

from dummydesign.api.predictions import predict
from dummydesign.cli.entry import run
from tests.support.refusal import raises_code

PAD = ["predict", "--young", "40", "--thickness", "8", "--shape", "crowned:20,2,9", "--punch", "round:15.8"]


@pytest.mark.slow
def test_fields_and_picture_are_written_and_the_pressures_are_in_the_answer(tmp_path, capsys):
    files = ["--fields", str(tmp_path / "pad.vtu"), "--picture", str(tmp_path / "pad.png")]
    assert run([*PAD, "--depth", "0.5,1", "--fidelity", "axisymmetric", "--json", *files]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert {file.name for file in tmp_path.iterdir()} == {"pad.pvd", "pad-1.vtu", "pad-2.vtu", "pad.png"}
    assert answer["files"]["picture"].endswith("pad.png") and len(answer["files"]["fields"]) == 3
    first, second = answer["contact_pressure"]
    assert first["peak_kPa"] < second["peak_kPa"]
    # One bead at the edge instead of the limit of a sharp one.
    assert second["force_N"] == pytest.approx(answer["force_N"][1], rel=0.03)
    assert len(second["profile"]["radius_mm"]) == len(second["profile"]["pressure_kPa"]) > 8


def test_fields_of_a_table_are_refused_in_one_line(tmp_path, capsys):
    assert run([*PAD, "--depth", "1", "--fields", str(tmp_path / "pad.vtu")]) == 2
    assert "--fidelity axisymmetric" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_fields_of_a_motion_are_refused():
    with raises_code("not_applicable", "fields"):
        predict(10.0, young_kPa=30.0, force_N=5.0, velocity_mm_s=9.0, fidelity="axisymmetric", fields="a.vtu")
