"""The commands ``loop`` and ``replay``: JSON, files, exit status."""

from __future__ import annotations

import json

import pytest

from dummydesign import cli


@pytest.fixture(scope="module")
def small(campaigns, tmp_path_factory):
    """Twelve of the trials of a campaign without an effect."""
    source = campaigns("none", 401)
    folder = tmp_path_factory.mktemp("small")
    head, *blocks = (source / "campaign.toml").read_text().split("[[trial]]")
    kept = [b for b in blocks if "thickness_mm = 15.0" not in b][:12]
    for block in kept:
        name = block.split('file = "')[1].split('"')[0]
        (folder / name).write_bytes((source / name).read_bytes())
    (folder / "campaign.toml").write_text("[[trial]]".join([head, *kept]))
    return folder


def test_loop_writes_report_and_calibration_and_replay_reads_it(small, tmp_path, capsys):
    assert cli.run(["loop", str(small), "--out", str(tmp_path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "dummydesign.loop/2" and found["verdict"] == "none"
    made = {p.name for p in tmp_path.iterdir()}
    assert {"calibration.json", "report.html", "report.pdf"} <= made
    assert made - {"calibration.json", "report.html", "report.pdf", "manifest.json"} == {"report.csv"}
    assert found["calibration_file"].endswith("calibration.json")
    assert cli.run(["replay", str(small), "--calibration", found["calibration_file"], "--json"]) == 0
    predicted = json.loads(capsys.readouterr().out)
    assert len(predicted["trials"]) == 12
    assert predicted["rmse_N"] < 0.1 and set(predicted["trials"][0]) >= {"file", "rmse_N", "peak_error_N"}
    assert cli.run(["replay", str(small), "--calibration", found["calibration_file"]]) == 0
    assert "base rms N" in capsys.readouterr().out


def test_bad_input_ends_in_one_line_and_status_two(small, tmp_path, capsys):
    for arguments in (
        ["loop", str(tmp_path / "nothing")],
        ["replay", str(small), "--calibration", str(tmp_path / "nothing.json")],
        ["replay", str(small)],
        ["loop", str(small), "--out", "/proc/nowhere"],
    ):
        assert cli.run(arguments) == 2
        shown = capsys.readouterr()
        assert shown.out == "" and shown.err.startswith("error: ") and shown.err.count("\n") == 1


def test_a_campaign_may_name_resin_and_ratio_instead_of_a_modulus(small, tmp_path):
    from dummydesign.loop.model.material import material_of
    from dummydesign.measurement.campaign_file import read_campaign

    for path in small.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    text = (tmp_path / "campaign.toml").read_text().splitlines()
    text = ['resin = "polyurethane-nagoya"' if line.startswith("young_kPa_nominal") else line for line in text]
    (tmp_path / "campaign.toml").write_text("\n".join(text))
    assert 5.0 < material_of(read_campaign(tmp_path)).young_kPa.value < 100.0
