"""``campaign new --from-mould``: the plan presses the pads of the moulds that were made."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from dummydesign import cli
from dummydesign.api.moulds import make_mould
from dummydesign.measurement.campaign_file import read_campaign
from dummydesign.mold import client
from dummydesign.mold.moulded_pads import MouldedPads, mould_folders, moulded_pads, one_mould
from tests.support.mould_child import CHILD
from tests.support.refusal import raises_code

PLAN = ["campaign", "new", "thumb", "--velocity", "10", "--force", "3", "--repeats", "2", "--ages", "9"]
CROWN, FLATTER = "crowned:radius=20,height=2,foot=9", "crowned:radius=30,height=1.5,foot=9"
BATCH = {"resin": "polyurethane-nagoya", "ratio": 15.2, "length_mm": 60, "width_mm": 50}


@pytest.fixture
def mould(monkeypatch, tmp_path):
    """A function that makes the folder of a mould as the command does, but for the solids."""
    monkeypatch.setattr(client, "WORKER", ("-c", CHILD))
    monkeypatch.chdir(tmp_path)

    def make(name, thickness_mm=8, **given):
        return make_mould(thickness_mm, out=name, **{**BATCH, **given})

    return make


def planned(capsys, *words):
    assert cli.run([*PLAN, *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def pressed(answer):
    """The campaign as it is read once every file is there, with the trace of nobody."""
    folder = Path(answer["inputs"]["folder"])
    rows = "\n".join(f"{0.01 * i:.2f},{min(0.02 * i, 1.0):.3f},{min(0.02 * i, 1.0):.3f}" for i in range(100))
    for trial in answer["trials"]:
        (folder / trial["file"]).write_text("time_s,displacement_mm,force_N\n" + rows + "\n")
    return read_campaign(folder)


@pytest.mark.slow
def test_a_crowned_mould_is_pressed_as_it_was_made(mould, capsys):
    mould("a", 8, shape=CROWN)
    answer = planned(capsys, "--from-mould", "a")
    campaign = pressed(answer)
    assert {(trial.thickness_mm, str(trial.geometry)) for trial in campaign.trials} == {(8.0, CROWN)}
    assert (campaign.pad.length_mm, campaign.pad.width_mm) == (60.0, 50.0)
    assert (campaign.pad.resin, campaign.pad.ratio) == ("polyurethane-nagoya", 15.2)
    assert answer["inputs"]["from_mould"] == ["a"] and all("expected_depth_mm" in row for row in answer["trials"])


@pytest.mark.slow
def test_several_thicknesses_of_one_shape_are_one_campaign_also_from_the_folder_that_holds_them(mould, capsys):
    mould("pads/a", 8)
    mould("pads/b", 5)
    answer = planned(capsys, "--from-mould", "pads")
    assert {trial["thickness_mm"] for trial in answer["trials"]} == {5.0, 8.0}
    assert all("shape" not in trial for trial in answer["trials"])
    assert len(answer["inputs"]["from_mould"]) == 2


@pytest.mark.slow
def test_different_shapes_stand_in_each_trial_and_are_expected_as_they_are(mould, capsys):
    mould("flat", 5)
    mould("crown", 8, shape=CROWN)
    mould("low", 9, shape=FLATTER)
    answer = planned(capsys, "--from-mould", "flat,crown,low")
    campaign = pressed(answer)
    shapes = {trial.thickness_mm: str(trial.geometry) for trial in campaign.trials}
    assert shapes == {5.0: "slab", 8.0: CROWN, 9.0: FLATTER}
    depths = {row["thickness_mm"]: row["expected_depth_mm"] for row in answer["trials"]}
    for folder, thickness in (("flat", 5.0), ("crown", 8.0), ("low", 9.0)):
        alone = planned(capsys, "--from-mould", folder, "--replace")
        assert alone["trials"][0]["expected_depth_mm"] == pytest.approx(depths[thickness], rel=1e-9)
    assert len(set(depths.values())) == 3


def test_a_puck_is_pressed_between_plates(mould, capsys):
    mould("puck", 20, shape="puck", length_mm=50, width_mm=50)
    campaign = pressed(planned(capsys, "--from-mould", "puck"))
    assert campaign.pad.diameter_mm == 50.0 and campaign.punch.shape == "plate"


@pytest.mark.parametrize(
    ("words", "resin", "ratio", "young"),
    [
        (["--ratio", "15.6"], "polyurethane-nagoya", 15.6, None),
        (["--resin", "ecoflex-00-30", "--ratio", "0"], "ecoflex-00-30", 0.0, None),
        (["--young", "31"], None, None, 31.0),
    ],
)
def test_what_was_poured_may_be_typed(words, resin, ratio, young, mould, capsys):
    mould("a")
    set_up = planned(capsys, "--from-mould", "a", *words)["inputs"]["set_up"]
    assert (set_up["resin"], set_up["ratio"], set_up["young_kPa"]) == (resin, ratio, young)


@pytest.mark.parametrize(
    ("other", "named"),
    [
        ({"ratio": 15.4}, ["15.2", "15.4"]),
        ({"resin": "ecoflex-00-30", "ratio": 0}, ["ecoflex-00-30"]),
        ({"length_mm": 70}, ["60x50", "70x50"]),
        ({"shape": "puck", "length_mm": 50, "width_mm": 50}, ["cylinder:50", "60x50"]),
        ({"thickness_mm": 8, "shape": CROWN}, ["'a'", "'b'", "8 mm"]),
    ],
)
def test_what_one_campaign_cannot_have_is_refused_by_name(other, named, mould, capsys):
    mould("a", 8)
    mould("b", **{"thickness_mm": 12, **other})
    assert cli.run([*PLAN, "--from-mould", "a,b"]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and all(word in message for word in named)
    assert not Path("thumb").exists()


@pytest.mark.parametrize("words", [["--pads", "5"], ["--shape", CROWN], ["--pad", "60x50"]], ids=lambda words: words[0])
def test_what_the_moulds_settle_cannot_be_typed_too(words, mould, capsys):
    mould("a")
    assert cli.run([*PLAN, "--from-mould", "a", *words]) == 2
    assert words[0] in capsys.readouterr().err


def test_a_folder_without_a_mould_and_a_changed_one_are_refused_by_name(mould, capsys):
    mould("a")
    for name in ("nowhere", "empty", ","):
        Path("empty").mkdir(exist_ok=True)
        assert cli.run([*PLAN, "--from-mould", name]) == 2
        assert name.strip(",") in capsys.readouterr().err
    spec = Path("a/spec.json")
    spec.write_text(spec.read_text().replace('"thickness_mm": 8.0', '"thickness_mm": 9.0'))
    assert cli.run([*PLAN, "--from-mould", "a"]) == 2
    assert "hash" in capsys.readouterr().err


@pytest.mark.slow
def test_a_project_with_moulds_hints_at_them_and_keeps_its_default(mould, capsys, monkeypatch):
    assert cli.run(["init", "hand"]) == 0
    mould("hand/moulds/mould_t8")
    mould("hand/moulds/pads", 5)
    mould("hand/designs/suggest-palm", 12)
    shutil.copytree("hand/moulds/mould_t8", "hand/moulds/.half")
    monkeypatch.chdir("hand")
    capsys.readouterr()
    young = ["--young", "25", "--no-power"]
    plain = planned(capsys, *young)
    (hint,) = [one["message"] for one in plain["warnings"] if one["code"] == "moulds_not_used"]
    listed = "moulds/mould_t8,moulds/pads,designs/suggest-palm"
    assert listed in hint and ".half" not in hint
    assert len(planned(capsys, *young, "--from-mould", listed, "--replace")["inputs"]["from_mould"]) == 3
    assert {row["thickness_mm"] for row in plain["trials"]} == {5.0, 15.0, 20.0}
    for words in (["--pads", "5"], ["--from-mould", "moulds/mould_t8"]):
        warnings = planned(capsys, *young, *words, "--replace")["warnings"]
        assert "moulds_not_used" not in {one["code"] for one in warnings}


def test_no_hint_outside_a_project(mould, capsys):
    mould("moulds/mould_t8")
    assert "moulds_not_used" not in {one["code"] for one in planned(capsys, "--young", "25", "--no-power")["warnings"]}


@pytest.mark.slow
def test_the_mould_of_a_design_made_with_solids_is_planned(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    make_mould(8, out="real", shape=CROWN, **BATCH)
    campaign = pressed(planned(capsys, "--from-mould", "real"))
    assert {(trial.thickness_mm, str(trial.geometry)) for trial in campaign.trials} == {(8.0, CROWN)}


def test_pads_of_some_moulds_are_sorted_with_their_shapes_and_one_pour(mould):
    mould("b", 12, shape=CROWN)
    mould("a", 8)
    pads = moulded_pads(["b", "a"])
    assert pads.pads_mm == (8.0, 12.0) and pads.shape == "slab" and pads.mixed
    assert pads.outline == "60x50" and pads.pour() == ("polyurethane-nagoya", 15.2)
    assert [Path(one).name for one in pads.folders] == ["a", "b"]
    assert not moulded_pads(["a"]).mixed
    with raises_code("missing", "from_mould"):
        moulded_pads([])
    # a folder that holds moulds is all of them
    assert moulded_pads(["."]).pads_mm == (8.0, 12.0)


def test_pads_of_two_ratios_have_no_pour():
    pads = MouldedPads(((8.0, "slab"),), "60x50", (("r", 15.0), ("r", 16.0)), ("a",))
    with raises_code("inconsistent", "resin") as caught:
        pads.pour()
    assert "r at ratio 15, r at ratio 16" in str(caught.value)


def test_one_mould_is_a_folder_its_file_or_the_only_one_in_a_folder(mould, tmp_path):
    mould("set/a", 8)
    for place in ("set/a", "set/a/spec.json", "set"):
        assert one_mould(place).pad.thickness_mm == 8.0
    (tmp_path / "set" / ".trash").mkdir()
    shutil.copy(tmp_path / "set" / "a" / "spec.json", tmp_path / "set" / ".trash" / "spec.json")
    assert mould_folders(Path("set")) == [Path("set/a")]
    shutil.copytree(tmp_path / "set" / "a", tmp_path / "set" / "b")
    with raises_code("conflict", "mould"):
        one_mould("set")
    with raises_code("nothing_found", "mould"):
        one_mould(tmp_path / "set" / "a" / "nowhere")
