"""What comes next in a project, at every stage of the work."""

import json
import os

import pytest

from dummydesign.project import status
from dummydesign.project.folder import change_project, make_project, read_project
from dummydesign.project.status import ProjectFile, finished_manifest, status_of
from dummydesign.studio.state import next_page, next_state, read_state


def wrote(folder, command, date, **summary):
    folder.mkdir(parents=True)
    told = {"command": command, "date": date, "finished": True, "summary": summary}
    (folder / "manifest.json").write_text(json.dumps(told), encoding="utf-8")


def plan(root, name, files):
    folder = root / "campaigns" / name
    folder.mkdir()
    rows = [
        f'[[trial]]\nfile = "{file}"\nthickness_mm = 5.0\nvelocity_mm_s = 10.0\ntarget_force_N = 5.0\n'
        for file in files
    ]
    head = 'schema = 1\nname = "x"\n[pad]\nyoung_kPa_nominal = 25.0\nlength_mm = 150.0\nwidth_mm = 120.0\n'
    head += 'base = "bonded"\n[punch]\nshape = "square"\nside_mm = 14.0\ncontact = "bonded"\n[sensor]\n'
    (folder / "campaign.toml").write_text(head + "".join(rows), encoding="utf-8")


def test_each_stage_of_the_work_asks_for_the_next_one(tmp_path):
    project = make_project(tmp_path)

    def then():
        return status_of(project).next_command

    assert then() == "dummydesign tissues list"
    (tmp_path / "measured" / "my hand.csv").write_text("1,2\n", encoding="utf-8")
    assert then() == "dummydesign import 'measured/my hand.csv'"
    wrote(tmp_path / "measured" / "import-a", "import", "2026-01-01", traces=3)
    assert then() == "dummydesign fit measured/import-a/*.csv --out tissue/mine.toml"
    (tmp_path / "tissue" / "mine.toml").write_text("", encoding="utf-8")
    assert then() == "dummydesign suggest --tissue tissue/mine.toml --no-cad"
    best = {"shape": "crowned:radius=20,height=2", "thickness_mm": 8.0, "ratio": 15.4, "resin": "polyurethane-nagoya"}
    wrote(tmp_path / "designs" / "suggest-mine", "suggest", "2026-01-02", **best)
    assert then() == "dummydesign mold --thickness 8 --ratio 15.4 --shape crowned:radius=20,height=2"
    wrote(tmp_path / "moulds" / "mould_t8", "mold", "2026-01-03")
    assert then().startswith("dummydesign campaign new campaigns/first --from-mould moulds/mould_t8")
    plan(tmp_path, "first", ["a.csv", "b.csv"])
    told = status_of(project)
    assert told.next_command == "dummydesign campaign check campaigns/first" and "2 of 2" in told.next_text
    for name in ("a.csv", "b.csv"):
        (tmp_path / "campaigns" / "first" / name).write_text("", encoding="utf-8")
    assert "problem" in status_of(project).next_text


def test_a_red_design_asks_for_no_mould_and_an_unsettled_one_for_a_puck_first(tmp_path):
    project = make_project(tmp_path, tissue="palm")
    pad = {"shape": "slab", "thickness_mm": 8.0, "ratio": 15.4, "resin": "polyurethane-nagoya"}

    def then():
        status = status_of(project)
        return status.next_text, status.next_command, next_page(status)

    wrote(
        tmp_path / "designs" / "red",
        "suggest",
        "2026-01-02",
        **pad,
        verdict="not_representative",
        next={"do": "do not cast this pad: why", "command": None},
    )
    text, command, page = then()
    assert text.startswith("do not cast this pad: why") and command == "dummydesign resins list"
    assert page == "/design"
    wrote(tmp_path / "designs" / "open", "suggest", "2026-01-03", **pad, verdict="not_settled")
    text, command, page = then()
    assert "puck" in text and command.startswith("dummydesign mold --puck 50x30") and page == "/resin"
    assert next_state(status_of(project), read_state(project, {})).ratio == 15.4
    # the mould of an earlier pad settles nothing, and is no ring
    wrote(tmp_path / "moulds" / "earlier", "mold", "2026-01-01", **pad | {"thickness_mm": 12.0})
    assert then() == (text, command, page)
    wrote(tmp_path / "moulds" / "puck_50x30", "mold", "2026-01-04", ratio=15.4, resin="x", preset="printed")
    (tmp_path / "moulds" / "earlier" / "manifest.json").unlink()
    text, command, page = then()
    assert "press the puck" in text and "--diameter 50" in command and page == "/resin"
    change_project(project, resin="my-batch")
    project = read_project(tmp_path)
    assert "with the batch" in then()[0] and then()[2] == "/design"
    wrote(tmp_path / "designs" / "batch", "suggest", "2026-01-05", **pad | {"resin": "my-batch"}, verdict="stands_for")
    assert then()[:2] == ("make the mould", "dummydesign mold --thickness 8 --ratio 15.4")


def test_a_learned_calibration_asks_for_the_design_again(tmp_path):
    project = make_project(tmp_path, tissue="palm")
    wrote(tmp_path / "designs" / "suggest-palm", "suggest", "2026-01-01", mould=True)
    wrote(tmp_path / "campaigns" / "first", "campaign new", "2026-01-02")
    (tmp_path / "campaigns" / "first" / "manifest.json").unlink()
    (tmp_path / "campaigns" / "first").rmdir()
    plan(tmp_path, "first", ["a.csv"])
    wrote(tmp_path / "calibrations" / "loop-first", "loop", "2026-01-03", campaign="first", verdict="none", effects=[])
    assert "press the rest" in status_of(project).next_text


def test_an_unfinished_answer_and_a_damaged_campaign_are_not_taken_for_done(tmp_path):
    project = make_project(tmp_path, tissue="palm")
    (tmp_path / "designs" / "half").mkdir()
    (tmp_path / "designs" / "half" / "manifest.json").write_text('{"command": "suggest", "finished": false}')
    (tmp_path / "campaigns" / "bad").mkdir()
    (tmp_path / "campaigns" / "bad" / "campaign.toml").write_text("x = ", encoding="utf-8")
    told = status_of(project)
    assert told.files["designs"] == () and told.next_command == "dummydesign suggest --no-cad"
    assert len(told.problems) == 1 and "campaigns/bad" in told.problems[0]


def test_a_design_for_a_tissue_that_was_only_typed_is_not_forgotten(tmp_path):
    project = make_project(tmp_path)
    best = {"shape": "slab", "thickness_mm": 8.0, "ratio": 15.4, "resin": "polyurethane-nagoya"}
    wrote(tmp_path / "designs" / "suggest-palm", "suggest", "2026-01-02", tissue="palm", mould=True, **best)
    assert status_of(project).next_command.startswith("dummydesign campaign new campaigns/first")
    (tmp_path / "measured" / "hand.csv").write_text("1,2\n", encoding="utf-8")
    assert status_of(project).next_command == "dummydesign import measured/hand.csv"


def test_a_manifest_that_is_written_again_is_read_again(tmp_path):
    path = tmp_path / "manifest.json"
    for number, date in enumerate(("2026-01-01", "2026-01-02")):
        path.write_text(json.dumps({"command": "mold", "date": date, "finished": True}), encoding="utf-8")
        os.utime(path, ns=(number, number))
        assert finished_manifest(path)["date"] == date
    path.unlink()
    assert finished_manifest(path) is None


def test_what_was_learned_is_used_in_the_first_design_and_a_red_design_is_never_the_end(tmp_path):
    project = make_project(tmp_path, tissue="palm")
    files = {room: () for room in status_of(project).files}
    files["calibrations"] = (ProjectFile("calibrations/a", "loop", "2026-01-03", {"campaign": "first"}),)
    files["campaigns"] = (ProjectFile("campaigns/first", "", "", {"pressed": 8, "missing": 0, "wrong": 0}),)
    text, command = status._next(project, files)
    assert text == "design a pad with what was learned"
    assert command == "dummydesign suggest --shape slab --calibration calibrations/a/calibration.json"
    red = {"shape": "slab", "thickness_mm": 8.0, "ratio": 15.4, "verdict": "not_representative"}
    files["designs"] = (ProjectFile("designs/red", "suggest", "2026-01-04", red),)
    files["moulds"] = (ProjectFile("moulds/older", "mold", "2026-01-01", {"thickness_mm": 5.0}),)
    for campaigns in (files["campaigns"], ()):
        text, command = status._next(project, files | {"campaigns": campaigns})
        assert text.startswith("do not cast this pad") and command == "dummydesign resins list"


def test_presses_that_leave_the_modulus_open_ask_for_further_ones(tmp_path):
    project = make_project(tmp_path, tissue="palm")
    wrote(tmp_path / "calibrations" / "loop-first", "loop", "2026-01-03", campaign="first", designable=False)
    told = status_of(project)
    assert told.next_command == "dummydesign loop campaigns/first --plan campaigns/first-next"
    assert next_page(told) == "/learn"


@pytest.mark.parametrize(
    "odd", [{"thickness_mm": [6]}, {"ratio": "15"}, {"ratio": None}, {"thickness_mm": 10**400}, {"shape": ["slab"]}]
)
def test_a_pad_whose_numbers_are_none_is_no_pad(tmp_path, odd):
    """A project from elsewhere, or a manifest that was edited, ends no command and no page in a traceback."""
    pad = {"shape": "slab", "thickness_mm": 6.0, "ratio": 15.0, "resin": "polyurethane-nagoya"}
    path = tmp_path / "manifest.json"
    for number, (summary, kept) in enumerate(((pad, pad), (pad | odd, None))):
        path.write_text(json.dumps({"command": "suggest", "finished": True, "summary": summary}), encoding="utf-8")
        os.utime(path, ns=(number, number))
        assert finished_manifest(path)["summary"] == kept
