"""Every set-up goes from plan to calibration and back, or is refused in one line with the reason."""

from __future__ import annotations

import json

import numpy as np
import pytest

from dummydesign.cli.entry import run
from tests.support.pressed_set_up import press_set_up

CROWN = "crowned:radius=20,height=3,foot=11"
BONE = "boned:height=3,radius=20,foot=9"
PLAN = [
    "--young",
    "25",
    "--pads",
    "10",
    "--depth",
    "1,2.5",
    "--velocity",
    "10,250",
    "--repeats",
    "2",
    "--ages",
    "9",
    "--no-power",
]
YOUNG_KPA = 27.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        ["--edge-radius", "0.5"],
        ["--punch", "round:14", "--edge-radius", "1", "--base", "sliding"],
        ["--punch", "ball:14"],
        ["--punch", "profile:PROFILE"],
        ["--punch", "round:14", "--contact", "frictionless"],
        ["--punch", "round:14", "--contact", "frictionless", "--edge-radius", "0.5"],
        ["--punch", "round:14", "--contact", "friction:0.3", "--edge-radius", "0.5"],
        ["--punch", "round:14", "--contact", "friction:0.3"],
        ["--punch", "round:14", "--base", "friction:0.5"],
        ["--punch", "round:14", "--shape", CROWN],
        ["--punch", "round:14", "--shape", CROWN, "--edge-radius", "0.4"],
        ["--shape", "layered:top=3,modulus_ratio=0.3", "--base", "sliding", "--edge-radius", "0.5"],
        ["--pad", "cylinder:20", "--contact", "friction:0.3"],
        ["--pad", "cylinder:50", "--contact", "frictionless"],
    ],
    ids=lambda words: " ".join(words).replace("--", ""),
)
def test_a_campaign_of_the_set_up_is_planned_pressed_checked_calibrated_and_predicted(words, tmp_path, capsys):
    """The modulus is found within the force law's stated error, and the calibration predicts presses with new noise."""
    profile = tmp_path / "cone.csv"
    profile.write_text("r_mm,z_mm\n" + "\n".join(f"{r},{0.02 * r * r:.4f}" for r in np.linspace(0.0, 8.0, 17)) + "\n")
    words = [word.replace("PROFILE", str(profile)) for word in words]
    for name, seed in (("a", 1), ("b", 2)):
        assert run(["campaign", "new", str(tmp_path / name), *PLAN, *words]) == 0
        press_set_up(tmp_path / name, YOUNG_KPA, seed)
        capsys.readouterr()
        assert run(["campaign", "check", str(tmp_path / name), "--json"]) == 0
        assert json.loads(capsys.readouterr().out)["ready"]
    assert run(["loop", str(tmp_path / "a"), "--out", str(tmp_path / "out"), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert not any("edge" in warning["message"] for warning in found["warnings"])
    young = found["after"]["parameters"]["young_kPa"]["value"]
    assert young == pytest.approx(YOUNG_KPA, rel=0.03)
    calibration = str(tmp_path / "out" / "calibration.json")
    assert run(["replay", str(tmp_path / "b"), "--calibration", calibration, "--json"]) == 0
    predicted = json.loads(capsys.readouterr().out)
    assert predicted["rmse_N"] < 0.03  # the noise is 0.02 N


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--edge-radius", "5"], "0 to 2.1"),
        (["--edge-radius", "-1"], "0 to 2.1"),
        (["--edge-radius", "0.5", "--contact", "friction:0.3", "--shape", CROWN], "contact = friction:0.3 is not"),
        (["--edge-radius", "0.5", "--base", "friction:0.3"], "base = friction:0.3 is not solved"),
        (["--edge-radius", "0.5", "--shape", BONE, "--base", "sliding"], "base = sliding is not solved"),
        (["--edge-radius", "0.5", "--shape", "crowned:10,2,6,1"], "ridge=1 is not solved"),
        (["--edge-radius", "0.5", "--punch", "ball:12"], "a ball has no edge"),
        (["--shape", "crowned:10,2,6,1"], "is not round"),
        (["--shape", CROWN, "--punch", "ball:12"], "pressed by a flat punch"),
        (["--shape", CROWN, "--pads", "4.2,10"], "leaves 1.2 mm"),
        (["--shape", CROWN, "--pad", "cylinder:20"], "a puck has a diameter only"),
        (["--shape", "crowned"], "has no lengths"),
        (["--punch", "profile:"], "give the file"),
        (["--punch", "profile:none.csv"], "does not exist"),
    ],
)
def test_what_is_not_solved_is_refused_before_it_is_pressed(words, said, tmp_path, capsys):
    assert run(["campaign", "new", str(tmp_path / "c"), *PLAN, *words]) == 2
    shown = capsys.readouterr()
    assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1 and said in shown.err
    assert not (tmp_path / "c").exists()


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("edge_radius_mm = 3.0", "0 to 2.1"),
        ('edge_radius_mm = "sharp"', "finite number"),
    ],
)
def test_a_campaign_file_with_a_fillet_that_is_not_solved_is_refused_with_its_line(line, said, tmp_path, capsys):
    folder = tmp_path / "c"
    assert run(["campaign", "new", str(folder), *PLAN]) == 0
    for trial in (folder / "campaign.toml").read_text().split('file = "')[1:]:
        time = np.linspace(0.0, 4.0, 400)
        x = np.minimum(10.0 * time - 0.5, 1.0)
        np.savetxt(
            folder / trial.split('"')[0],
            np.column_stack([time, x, 3.0 * np.maximum(x, 0.0)]),
            "%.4f",
            ",",
            header="time_s,displacement_mm,force_N",
            comments="",
        )
    path = folder / "campaign.toml"
    path.write_text(path.read_text().replace('contact = "bonded"', line).replace("250.0", "10.0"))
    capsys.readouterr()
    assert run(["loop", str(folder), "--out", str(tmp_path / "out")]) == 2
    shown = capsys.readouterr().err
    assert "campaign.toml:" in shown and said in shown and shown.count("\n") == 1
