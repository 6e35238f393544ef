"""``predict``: several forces and speeds, units, what is refused and how, and a pad without relaxation."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

import dummydesign
from dummydesign.cli.entry import run
from tests.support.refusal import raises_code

POURED = ["predict", "--resin", "polyurethane-nagoya", "--ratio", "15", "--thickness", "5"]
ELASTIC = ["predict", "--young", "30", "--thickness", "10"]


def answered(capsys, *words):
    assert run([*words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def codes(found):
    return [item["code"] for item in found["warnings"]]


def test_several_forces_and_speeds_are_the_single_presses_one_after_the_other(capsys):
    several = answered(capsys, *POURED, "--force", "5,10N", "--velocity", "10,0.25m/s", "--hold", "2")
    presses = several["presses"]
    asked = [(one["steady_force_N"], one["velocity_mm_s"]) for one in presses]
    assert asked == [(5, 10), (10, 10), (5, 250), (10, 250)]
    for one in presses:
        force, speed = f"{one['steady_force_N']:g}", f"{one['velocity_mm_s']:g}"
        single = answered(capsys, *POURED, "--force", force, "--velocity", speed, "--hold", "2")
        assert "presses" not in single and single["inputs"]["force_N"] == float(force)
        assert single["steady_force_N"] == pytest.approx(one["steady_force_N"], rel=1e-6)
        for name in ("depth_mm", "peak_force_N", "peak_time_s", "time_s", "force_N", "force_low_N", "force_high_N"):
            assert one[name] == single[name]
    for name in ("depth_mm", "peak_force_N", "time_s", "displacement_mm", "force_N"):
        assert several[name] == presses[-1][name]


@pytest.mark.slow
def test_several_presses_are_a_file_each_that_compare_reads(tmp_path):
    given = {"resin": "polyurethane-nagoya", "ratio": 15, "out": tmp_path / "c.csv"}
    found = dummydesign.predict(5, force_N=np.array([5.0, 8.5, 300.0]), velocity_mm_s=[250], **given).to_dict()
    names = {"curve_5N_250mm_s": "c_5N_250mm_s.csv", "curve_8.5N_250mm_s": "c_8.5N_250mm_s.csv"}
    assert found["files"] == {role: str(tmp_path / name) for role, name in names.items()}
    assert {path.name for path in tmp_path.iterdir()} == set(names.values())
    for press, name in zip(found["presses"], names.values()):
        with (tmp_path / name).open() as file:
            rows = list(csv.DictReader(file))
        assert [float(row["force_N"]) for row in rows] == pytest.approx(press["force_N"], rel=1e-7)
    compared = dummydesign.compare(found["files"].values(), "forefinger").to_dict()
    assert [row["steady_force_N"] for row in compared["force_variation_range"]] == pytest.approx([5.0, 8.5], rel=0.01)


def test_one_press_is_written_to_the_file_that_was_asked_for(tmp_path):
    given = {"resin": "polyurethane-nagoya", "ratio": 15, "out": tmp_path / "c.csv"}
    found = dummydesign.predict(5, force_N=[5.0], velocity_mm_s=[250], **given).to_dict()
    assert found["files"] == {"curve": str(tmp_path / "c.csv")}
    assert (tmp_path / "c.csv").read_text().startswith("time_s,displacement_mm,force_N,")


def test_a_force_out_of_reach_is_said_of_that_press_and_refused_when_it_is_all(capsys):
    found = answered(capsys, *POURED, "--force", "5,300", "--velocity", "10")
    first, second = found["presses"]
    assert second["depth_mm"] is None and second["peak_force_N"] is None and "300 N" in second["out_of_reach"]
    assert found["depth_mm"] == first["depth_mm"] and found["steady_force_N"] == pytest.approx(5.0)
    assert run([*POURED, "--force", "5,300", "--velocity", "10"]) == 0
    assert len(capsys.readouterr().out.splitlines()) <= 30
    with raises_code("out_of_reach", "force_N") as caught:
        dummydesign.predict(5, resin="polyurethane-nagoya", ratio=15, force_N="300,400", velocity_mm_s=10)
    assert caught.value.code == "out_of_reach"


@pytest.mark.parametrize("what", [["--force", "10", "--velocity", "10"], ["--motion", "m.csv"]])
def test_a_pad_without_relaxation_that_is_pressed_in_time_is_told_first(what, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.csv").write_text("time_s,displacement_mm\n0,0\n0.1,1\n2,1\n", encoding="utf-8")
    found = answered(capsys, *ELASTIC, *what)
    assert codes(found)[0] == "no_relaxation" and found["peak_force_N"] == pytest.approx(found["steady_force_N"])
    assert run([*ELASTIC, *what]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    message = found["warnings"][0]["message"]
    assert "--prony" in message and "--resin" in message
    assert shown.startswith(f"WARNING {message}") and shown.count(message) == 1
    assert "no_relaxation" not in codes(answered(capsys, *ELASTIC, *what, "--prony", "0.1:0.3"))


def test_static_depths_and_resins_with_relaxation_are_not_warned_of(capsys):
    assert "no_relaxation" not in codes(answered(capsys, *ELASTIC, "--depth", "1"))
    assert "no_relaxation" not in codes(answered(capsys, *POURED, "--force", "5", "--velocity", "10"))


@pytest.mark.parametrize("typed", ["1,2", "1mm,2mm", "0.1cm, 2000um", ["1mm", 2]])
def test_depths_have_units_as_thicknesses_do(typed):
    assert dummydesign.predict("1cm", young_kPa=30, depth_mm=typed).to_dict()["depth_mm"] == [1.0, 2.0]


def test_units_are_taken_by_edges_studies_and_moulds():
    from dummydesign.core.parsing import parse_limits, read_numbers
    from dummydesign.mold.model.spec import read_thickness

    sharp, same = (dummydesign.predict(10, young_kPa=30, depth_mm=1, edge_radius_mm=e).to_dict() for e in (1.0, "1mm"))
    assert sharp["force_N"] == same["force_N"]
    assert read_numbers("5mm,1cm", "thickness in mm") == (5.0, 10.0)
    assert read_numbers("5mm:6mm:0.5", "thickness in mm") == (5.0, 5.5, 6.0)
    assert parse_limits("5mm:1cm", "thickness in mm") == (5.0, 10.0)
    assert read_thickness("1cm") == 10.0
    with raises_code("unknown_unit", "thickness_mm"):
        read_numbers("5N", "thickness in mm")


def test_what_nothing_would_read_is_refused():
    pad = {"young_kPa": 30.0, "depth_mm": 1.0}
    for more, code, quantity in (
        ({"ratio": 17.0}, "conflict", "ratio"),
        ({"aim": "nonsense"}, "not_applicable", "aim"),
        ({"hold_s": 5.0}, "not_applicable", "hold_s"),
        ({"deceleration_mm_s2": "5m/s2"}, "not_applicable", "deceleration_mm_s2"),
    ):
        with raises_code(code, quantity):
            dummydesign.predict(8, **pad, **more)
    with raises_code("not_applicable", "aim"):
        dummydesign.whatif([8.0], [15.0], aim="safe-side")


def test_answers_compare_by_identity():
    one, other = (dummydesign.predict(8, young_kPa=30, depth_mm=[1, 2]) for _ in range(2))
    assert one == one and one != other and one.outcome != other.outcome
    assert one.to_dict()["force_N"] == other.to_dict()["force_N"] and len({one, other}) == 2


def test_a_study_reads_numbers_as_a_prediction_does():
    (metres,), (millimetres,) = (
        dummydesign.whatif([8], [15], velocity_mm_s=[speed], force_N="10N").rows for speed in ("0.25m/s", 250)
    )
    assert metres["peak_over_steady"] == millimetres["peak_over_steady"]
    with raises_code("implausible_unit", "velocity_mm_s"):
        dummydesign.whatif([8], velocity_mm_s="0.25")


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["--young", "-5", "--depth", "1"], ("Young's modulus in kPa = -5 ", "0.01 to 1000000")),
        (["--young=-0.005MPa", "--depth", "1"], ("Young's modulus in kPa = -5 ", "0.01 to 1000000")),
        (["--young", "0", "--depth", "1"], ("Young's modulus in kPa = 0 ", "0.01")),
        (["--young", "30", "--depth", "-1"], ("depth in mm = -1 ", "0 to 6")),
        (["--young", "30", "--depth", "9"], ("depth in mm = 9 ", "0 to 6")),
        (["--young", "30", "--depth", "1,,2"], ("depth in mm = ''",)),
        (["--young", "30", "--depth", "1N"], ("depth in mm = '1N'", "mm")),
        (["--young", "30", "--force", "-3", "--velocity", "10"], ("force in N = -3 ", "0.0001")),
        (["--young", "30", "--force", "3,-4", "--velocity", "10"], ("force in N = -4 ", "0.0001")),
        (["--young", "30", "--force", "3", "--velocity", "0"], ("velocity in mm/s = 0 ", "0.0001")),
        (["--young", "30", "--force", "3", "--velocity", "9", "--hold", "-1"], ("hold in s = -1 ",)),
        (["--young", "30", "--force", "3", "--velocity", "9", "--deceleration", "-1"], ("deceleration in mm/s2 = -1",)),
        (["--young", "30", "--depth", "1", "--law", "ogden:-1,2"], ("mu = -1, alpha = 2",)),
    ],
)
def test_what_is_refused_is_named_as_it_was_typed(words, parts, capsys):
    assert run(["predict", "--thickness", "10", *words]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "MPa" not in said.replace("-0.005MPa", "")
    assert all(part in said for part in parts) and "young_MPa" not in said


def test_a_pad_smaller_than_its_punch_and_a_campaign_of_no_modulus_are_refused(tmp_path, capsys):
    assert run([*ELASTIC, "--depth", "1", "--pad", "slab:10x30"]) == 2
    assert "smaller than the punch square:14" in capsys.readouterr().err
    for typed, said in (("-5", "= -5 is outside"), ("0.025", "give 25")):
        assert run(["campaign", "new", str(tmp_path / "c"), "--young", typed]) == 2
        assert f"Young's modulus in kPa = {typed}" in (shown := capsys.readouterr().err) and said in shown
    assert not list(tmp_path.iterdir())


def test_the_screen_names_the_files_that_were_written(tmp_path, capsys):
    curve = tmp_path / "p.csv"
    words = [*ELASTIC, "--depth", "1,2"]
    assert run(words) == 0
    assert "FILES" not in capsys.readouterr().out
    for more, label in (([], "FILES"), (["--details"], "written:")):
        assert run([*words, "--out", str(curve), *more]) == 0
        said = capsys.readouterr().out
        assert curve.is_file() and f"{label} " in said and str(curve) in said and "--out FILE" not in said


def test_a_motion_with_a_measured_force_is_compared_with_it(tmp_path, capsys):
    words = [*POURED, "--motion", str(tmp_path / "press.csv")]
    rows = np.c_[np.linspace(0.0, 2.0, 401), 1.5 * np.clip(np.linspace(-0.1, 1.9, 401) / 0.2, 0.0, 1.0)]

    def saved(force, name="force_N", cells="%.9g"):
        head = "time_s,displacement_mm" + ("" if force is None else f",{name}")
        table = rows if force is None else np.c_[rows, force]
        np.savetxt(tmp_path / "press.csv", table, delimiter=",", header=head, comments="", fmt=cells)

    saved(None)
    plain = answered(capsys, *words)
    assert "measured" not in plain
    own = np.interp(rows[:, 0], plain["time_s"], plain["force_N"])
    error = 0.3 + 0.2 * np.sin(7.0 * rows[:, 0])
    saved(own - error)
    found = answered(capsys, *words)
    assert found["force_N"] == plain["force_N"]  # the measured force does not change the prediction
    assert found["measured"]["rmse_N"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-6)
    peaks = [np.convolve(one, np.ones(5) / 5.0, "valid").max() for one in (own, own - error)]
    assert found["measured"]["peak_force_N"] == pytest.approx(peaks[1], rel=1e-6)
    assert found["measured"]["peak_error_N"] == pytest.approx(peaks[0] - peaks[1], rel=1e-6)
    saved((own - error) / 4.4482216152605, "force_lbf")
    assert answered(capsys, *words)["measured"]["rmse_N"] == pytest.approx(found["measured"]["rmse_N"], rel=1e-6)
    saved(np.where(rows[:, 0] > 1.0, np.nan, own))
    bad = answered(capsys, *words)
    assert "measured" not in bad and "force_not_compared" in codes(bad) and bad["force_N"] == plain["force_N"]
    saved(own - error)
    assert run(words) == 0
    assert f"{found['measured']['rmse_N']:.3g} N rms" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "value", "quantity"),
    [
        ("--poisson", "0.6", "poisson"),
        ("--poisson", "0", "poisson"),
        ("--base", "slidng", "base"),
        ("--condition", "friction:-1", "condition"),
        ("--condition", "frictionles", "condition"),
    ],
)
def test_a_value_that_nothing_solves_is_not_sent_to_another_solver(option, value, quantity, capsys):
    assert run([*ELASTIC, "--depth", "1", option, value, "--json"]) == 2
    error = json.loads(capsys.readouterr().out)["error"]
    assert error["code"] in ("out_of_range", "unknown_name") and "--fidelity" not in error["message"]
    assert error["quantity"] == quantity


def test_a_warning_has_its_sentence_under_both_names_of_the_contract(capsys):
    found = answered(capsys, *ELASTIC, "--force", "5", "--velocity", "10")
    assert found["warnings"] and all(set(one) == {"code", "message"} for one in found["warnings"])
    assert dummydesign.predict(10, young_kPa=30, force_N=5, velocity_mm_s=10).to_dict()["warnings"] == found["warnings"]
