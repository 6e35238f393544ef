"""``suggest`` on the command line: the contract, the recipe, refusals."""

import pytest

from dummydesign.cli.entry import run
from dummydesign.resin import load_resin
from tests.support.command_answer import answer

# a crown that is not red, so that its mould is made
USABLE = ["--shape", "crowned:21.2,2,9.4", "--thickness", "4.5:4.5", "--ratio", "15.3:15.5"]
QUICK = ["--shape", "slab", "--no-cad", "--no-verify"]


def fits(status, found):
    """Status 1 goes with a red light and its error, and with nothing else."""
    red = found["verdict"]["light"] == "red"
    return status == int(red) and ("error" in found) == red


@pytest.mark.parametrize(
    "tissue", ["forefinger", *(pytest.param(name, marks=pytest.mark.slow) for name in ("palm", "thenar"))]
)
def test_every_tissue_gets_a_design_with_all_that_the_contract_names(tissue, capsys):
    status, found = answer(capsys, "suggest", "--tissue", tissue, *QUICK)
    assert fits(status, found) and found["schema"] == "dummydesign.suggest/2"
    best = found["recommendation"]
    assert 3 <= best["thickness_mm"] <= 30 and 14 <= best["ratio"] <= 20
    assert best["ratio_meaning"] == "isocyanate parts per 100 polyol by weight"
    assert best["young_kPa"]["low"] < best["young_kPa"]["value"] < best["young_kPa"]["high"]
    assert all(term["tau_s"] > 0 and term["beta"] > 0 for term in best["prony"])
    names = {"total", "parametric", "steady_state_range", "force_variation_range"}
    assert names <= set(best["scores"]) and all(0 <= value <= 1 for value in best["scores"].values())
    for name in ("gamma1_N_per_mm3", "gamma2_N_per_mm3", "gamma3_N_per_mm3"):
        assert best["parameters"][name] > 0
    for name in ("c2_N_s_per_mm", "c3_N_s_per_mm"):
        assert set(best["parameters"][name]) == {"10", "250"}
    places = [(row["steady_force_N"], row["velocity_mm_s"]) for row in best["conditions"]]
    assert sorted(places) == [(f, v) for f in (5, 10, 15) for v in (10, 250)]
    for row in best["conditions"]:
        assert row["target_peak_low_N"] < row["target_peak_high_N"] and 0 <= row["inside_fraction"] <= 1
        assert row["depth_over_thickness"] <= 0.6 + 1e-9 and row["peak_force_N"] >= row["steady_force_N"]
    assert {row["force_N"] for row in best["low_force"]} == {0.5, 1, 2, 3, 4, 5}
    assert 0 <= found["sensitivity"]["yield_fraction"] <= 1
    slope = load_resin().log_slope(best["ratio"])
    assert found["sensitivity"]["d_ln_young_per_percent_ratio"] == pytest.approx(0.01 * slope)
    assert found["verification"]["max_difference_percent"] is None
    assert found["rests_on"]["inferred_or_assumed"] > 0 and found["sources"]
    assert found["alternatives"]
    for other in found["alternatives"]:
        assert set(other) == set(best)


@pytest.mark.slow
def test_the_recipe_has_the_ratio_and_more_than_the_pad_weighs(capsys):
    _, found = answer(capsys, "suggest", "--tissue", "forefinger", *QUICK)
    best = found["recommendation"]
    masses = {item["name"]: item["mass_g"] for item in best["recipe"]["components"]}
    # the balance shows tenths of a gram
    assert 100 * masses["isocyanate"] / masses["polyol"] == pytest.approx(best["ratio"], abs=0.1)
    assert best["recipe"]["total_g"] == pytest.approx(sum(masses.values()))
    pad_g = 150 * 120 * best["thickness_mm"] * 1e-3 * load_resin().property("density_g_per_cm3", best["ratio"]).value
    assert pad_g < best["recipe"]["total_g"] < 1.5 * pad_g


@pytest.mark.slow
def test_the_same_question_has_the_same_answer(capsys):
    first, again = (answer(capsys, "suggest", "--tissue", "forefinger", *QUICK)[1] for _ in range(2))
    assert first == again


@pytest.mark.slow
def test_limits_are_followed_and_named(capsys):
    _, found = answer(
        capsys, "suggest", "--tissue", "palm", "--thickness", "15:15", "--ratio", "15:16", "--aim", "safe-side", *QUICK
    )
    best = found["recommendation"]
    assert best["thickness_mm"] == 15.0 and 15.0 <= best["ratio"] <= 16.0
    assert found["inputs"]["aim"] == "safe-side" and found["inputs"]["ratio"] == [15.0, 16.0]


@pytest.mark.slow
def test_a_pad_at_the_thin_end_of_the_table_is_answered(capsys):
    status, found = answer(capsys, "suggest", "--tissue", "forefinger", "--thickness", "3:3", *QUICK)
    assert fits(status, found) and found["recommendation"]["thickness_mm"] == 3.0


def test_no_feasible_design_is_said_with_status_1(capsys):
    status, found = answer(
        capsys, "suggest", "--tissue", "forefinger", "--thickness", "28:30", "--ratio", "14:14.2", *QUICK
    )
    assert status == 1 and found["error"]["code"] == "no_feasible_design"
    assert "10 N" in found["error"]["message"]


@pytest.mark.slow
def test_without_cad_the_recipe_stands_and_the_missing_step_is_named(capsys, monkeypatch, tmp_path):
    from dummydesign.core.errors import NoAnswerError

    def broken(*_, **__):
        raise NoAnswerError("cad_unavailable", "libGL.so.1 is missing: apt install libgl1")

    monkeypatch.setattr("dummydesign.mold.client.make_mold", broken)
    arguments = ["suggest", "--tissue", "forefinger", *USABLE, "--no-verify", "--out", str(tmp_path)]
    status, found = answer(capsys, *arguments)
    assert status == 1 and found["error"]["code"] == "cad_unavailable"
    assert found["recommendation"]["recipe"]["total_g"] > 0
    assert "libGL" in found["error"]["message"] and "dummydesign mold --thickness" in found["error"]["message"]
    assert run(arguments) == 1
    shown = capsys.readouterr()
    assert "polyol" in shown.out and shown.err.startswith("error: libGL")


@pytest.mark.slow
@pytest.mark.parametrize(
    "more",
    [
        (),
        ("--resin", "ecoflex-00-30"),
        ("--force", "1,2,3,5,8,10,12,15", "--velocity", "10,100,250"),
        ("--aim", "safe-side"),
        ("--shape", "auto"),
    ],
)
def test_the_answer_fits_one_screen_and_says_the_verdict_first(more, capsys):
    status = run(["suggest", "--tissue", "forefinger", *QUICK, *more])
    shown = capsys.readouterr()
    lines = shown.out.splitlines()
    assert len(lines) <= 30 and max(map(len, lines)) <= 100
    assert lines[0].startswith({0: ("GREEN", "AMBER"), 1: "RED"}[status])
    labels = [line.split()[0] for line in lines if line[:1].isupper()]
    assert {"PAD", "RESIN", "WEIGH", "VALID", "NEXT", "FILES", "MORE"} <= set(labels)
    assert (labels.count("WARNING") <= 4 and "polyol" in shown.out) or "thinner" in shown.out


@pytest.mark.slow
def test_details_hold_every_number_of_the_screen(capsys):
    import re

    asked = ["suggest", "--tissue", "palm", *QUICK]
    run(asked)
    screen = capsys.readouterr().out
    run([*asked, "--details", "--replace"])
    details = capsys.readouterr().out
    for part in ("polyol", "isocyanate", "fraction in range", "inferred or assumed", "of castings", "seed"):
        assert part in details
    rows = [line.split() for line in screen.splitlines() if re.match(r"^  \d", line)]
    assert len(rows) == 6
    for force, speed, depth, *_ in rows:
        assert any(line.split()[:3] == [force, speed, depth] for line in details.splitlines())


@pytest.mark.slow
def test_castings_are_counted_and_add_up(capsys, own_folder):
    own_folder("materials/making.toml", "castings = 1200", "castings = 1500")
    _, found = answer(capsys, "suggest", "--tissue", "palm", *QUICK)
    drawn = found["shares"]["as_poured"]
    assert drawn["n"] == 1500 == found["sensitivity"]["pours"]
    names = ("stands_for", "with_correction", "reads_low", "over", "out_of_reach")
    assert sum(drawn[name] for name in names) == pytest.approx(1.0, abs=1e-12)
    assert found["verdict"]["castings"] == {name: drawn[name] for name in names}
    assert drawn["usable"] == pytest.approx(drawn["stands_for"] + drawn["with_correction"], abs=1e-12)
    assert "castings" not in found


@pytest.mark.slow
def test_a_limits_file_of_ones_own_decides_and_a_damaged_one_is_refused(capsys, tmp_path, monkeypatch):
    from pathlib import Path

    source = Path(__file__).parents[3] / "materials" / "verdict.toml"
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    own = tmp_path / "materials" / "verdict.toml"
    own.parent.mkdir()
    text = source.read_text()
    for damaged in (text.replace("[usable.over]", "[usable.ovr]"), text[: len(text) // 2], "schema = 2\n", "a = ["):
        own.write_text(damaged)
        assert run(["suggest", "--tissue", "palm", *QUICK]) == 2
        error = capsys.readouterr().err.strip()
        assert error.startswith("error: ") and "verdict.toml" in error and "\n" not in error
    own.write_text(text.replace("value = 1.10\nlow = 1.0\nhigh = 1.20", "value = 1.15\nlow = 1.0\nhigh = 1.20", 1))
    assert run(["suggest", "--tissue", "palm", *QUICK, "--json"]) in (0, 1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--tissue", "forfinger"], "did you mean 'forefinger'"),
        (["--tissue", "palm", "--aim", "avarage"], "did you mean 'average'"),
        (["--tissue", "palm", "--aim", "subject:nobody"], "subject of palm 'nobody'"),
        (["--tissue", "palm", "--ratio", "10:12"], "allowed range 14.0 to 20.0"),
        (["--tissue", "palm", "--thickness", "2:30"], "allowed range 3.0 to 30.0"),
        (["--tissue", "palm", "--thickness", "20:10"], "MIN at most MAX"),
        (["--tissue", "palm", "--shape", "sphere"], "unknown shape 'sphere'"),
        (["--tissue", "palm", "--resin", "rubber"], "unknown resin 'rubber'"),
        (["--tissue", "palm", "--out", "/dev/null/x"], "cannot be written"),
        ([], "--tissue"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    status = run(["suggest", *QUICK, *arguments])
    error = capsys.readouterr().err.strip()
    assert status == 2 and error.startswith("error: ") and message in error and "\n" not in error


@pytest.mark.slow
def test_one_ratio_is_a_range_of_one(capsys):
    status, found = answer(capsys, "suggest", "--tissue", "palm", "--ratio", "15", *QUICK)
    assert fits(status, found) and found["recommendation"]["ratio"] == 15.0
    assert {other["ratio"] for other in found["alternatives"]} <= {15.0}


def test_the_folder_is_made_when_the_question_is_accepted_and_not_before(capsys, tmp_path):
    for bad in (
        ["suggest", "--tissue", "plam"],
        ["suggest", "--tissue", "palm", "--aim", "best"],
        ["suggest", "--tissue", "palm", "--calibration", "x.toml"],
        ["whatif", "--thickness", "5", "--tissue", "plam"],
        ["whatif", "--thickness", "5", "--tissue", "palm", "--aim", "best"],
        ["whatif", "--thickness", "5", "--workers", "0"],
        ["whatif", "--thickness", "5", "--condition", "frictionless"],
    ):
        assert run(bad) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert run(["suggest", "--tissue", "forefinger", "--thickness", "28:30", "--ratio", "14:14.2", *QUICK]) == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_report_and_csv_are_written_where_the_answer_says(capsys, tmp_path):
    _, found = answer(capsys, "suggest", "--tissue", "forefinger", *QUICK)
    assert found["files"]["report"] == "suggest-forefinger/report.html"
    assert {path.name for path in (tmp_path / "suggest-forefinger").iterdir()} == {
        path.split("/")[1] for path in found["files"].values()
    }


@pytest.mark.slow
def test_the_recommended_design_is_verified_by_finite_elements(capsys):
    _, found = answer(capsys, "suggest", "--tissue", "forefinger", "--shape", "slab", "--no-cad")
    checked = found["verification"]
    assert checked["fidelity"] == "axisymmetric" and len(checked["depth_mm"]) == 3
    assert 0 <= checked["max_difference_percent"] < 10


@pytest.mark.slow
def test_a_palm_of_a_silicone_that_hardly_relaxes_is_called_unsafe(capsys):
    status, found = answer(capsys, "suggest", "--tissue", "palm", "--resin", "ecoflex-00-30", *QUICK)
    judged = found["verdict"]
    assert status == 1 and judged["level"] == "not_representative" and judged["light"] == "red"
    assert judged["peaks_below"] == judged["peaks"] == 6 and judged["shortfall"]["central"] > 1.4
    assert found["files"] and not any("step" in path for path in found["files"].values())


@pytest.mark.slow
def test_a_finer_balance_and_a_truer_thickness_leave_more_castings_inside(capsys, own_folder):
    shares = []
    for balance, thickness in (("0.01", "0.02"), ("0.5", "0.5")):
        path = own_folder("materials/making.toml", "[weighing_g]\nvalue = 0.1", f"[weighing_g]\nvalue = {balance}")
        path.write_text(path.read_text().replace("[thickness_mm]\nvalue = 0.2", f"[thickness_mm]\nvalue = {thickness}"))
        _, found = answer(capsys, "suggest", "--tissue", "palm", *QUICK[2:])
        assert found["sensitivity"]["tolerances"]["weighing_g"] == float(balance)
        shares.append(found["shares"]["resin_known"]["usable"])
    assert shares[0] > shares[1] + 0.05
