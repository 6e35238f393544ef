"""What pages say and choose, without a browser: sentences, links and folders of answers."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")

from dummydesign.core.tables import Table
from dummydesign.person.drives import DRIVES
from dummydesign.project.folder import make_project
from dummydesign.project.status import ProjectFile, status_of
from dummydesign.studio import select_options, widgets
from dummydesign.studio.pages import cast, learn, measured, mould, overview, tissue
from dummydesign.studio.state import Design, State
from tests.support.refusal import raises_code

PAD = {"thickness_mm": 5.0, "shape": "slab", "ratio": 15.0}


def test_the_peaks_of_the_subjects_are_one_cell_of_a_compared_press():
    keys = ("velocity_mm_s", "steady_force_N", "depth_mm", "peak_force_N", "inside_fraction")
    press = {"file": "campaigns/a/t05.csv", **dict.fromkeys(keys, 1.0)}
    ranged = press | {"range_peak_low_N": 5.186, "range_peak_high_N": 6.389}
    table = Table.of([ranged, press], cast.COMPARED)
    assert [(row[0], row[-2]) for row in table.rows] == [("t05.csv", "5.19 to 6.39"), ("t05.csv", "-")]


@pytest.mark.parametrize(("names", "chosen"), [(("anna_1", "anna_2"), 2), (("anna_1", "ben_1", "cleo_1"), 0)])
def test_presses_of_several_people_are_not_chosen_as_those_of_one_subject(lab, names, chosen):
    known = {f"measured/import-a/{name}.csv": name for name in names}
    start, *_ = tissue._start(SimpleNamespace(root=lab.root, query={}, tissue=""), known)
    assert len(start) == chosen


@pytest.mark.parametrize(("rmse_N", "poor"), [(0.11, 0), (12.8, 1)])
def test_a_fit_far_above_the_noise_is_called_poor(lab, monkeypatch, rmse_N, poor):
    said = []
    for name in ("html", "show_curves", "parameter_table"):
        monkeypatch.setattr(tissue, name, lambda *given: None)
    monkeypatch.setattr(tissue.widgets, "tell_problem", said.append)
    answer = {"elements": 5, "mode": "pooled", "rmse_N": rmse_N, "noise_floor_N": 0.1, "parameters": {}}
    page = SimpleNamespace(root=lab.root, use_button=lambda name: None)
    tissue._show(page, SimpleNamespace(answer=answer | {"files": {"tissue": "tissue/mine.toml"}}))
    assert len(said) == poor and all("128 times" in one for one in said)


def test_fields_of_drives_have_the_numbers_of_all_drives_with_their_usual_values():
    numbers = cast._numbers()
    assert set(numbers) == {purpose for drive in DRIVES.values() for purpose, _ in drive.numbers}
    usual = {purpose.quantity: value for purpose, value in numbers.items()}
    assert usual["damping ratio"] == 0.0 and [one for one in usual.values() if one is not None] == [0.0]


def test_the_plan_of_an_answer_is_the_folder_of_its_file():
    assert learn._plan_folder({"files": {"plan_campaign": "campaigns/next/campaign.toml"}}) == "campaigns/next"
    assert learn._plan_folder({"files": {}}) == learn._plan_folder({}) == ""


def test_an_import_has_its_files_before_its_options_and_its_folder_by_its_preview():
    job = SimpleNamespace(words=("import", "a.csv", "b.csv", "--out", "measured/x"), answer={})
    assert measured._sources(job) == ["a.csv", "b.csv"]
    assert measured._out(job) == "measured/none"
    job.answer = {"preview": "measured/x-2/preview.html"}
    assert measured._out(job) == "measured/x-2"


def test_a_mould_is_that_of_its_words_without_the_folder():
    assert mould.pad_of(["mold", "--thickness", "9", "--out", "moulds/a", "--preset", "open"]) == [
        *("mold", "--thickness", "9", "--preset", "open")
    ]
    assert mould.pad_of(["mold", "--thickness", "9"]) == ["mold", "--thickness", "9"]
    assert mould.folder_of({"files": {"pour_sheet": "moulds/a/pour.pdf"}}) == "moulds/a"
    assert mould.folder_of({}) == mould.folder_of({"files": {}}) == ""


def test_a_part_has_one_row_with_a_link_to_each_of_its_formats():
    rows = [("Base, STEP", "base.step"), ("Drawing of the base, PDF", "base.pdf"), ("Frame", "frame.stl")]
    table = mould._part_rows(rows, "moulds/a <b>")
    assert table.count("<tr>") == 2 and table.count("<th scope=row>Base</th>") == 1
    for words in ("STEP", "PDF", "STL"):
        assert f">{words}<" in table
    assert "<b>" not in table


@pytest.mark.parametrize(("verdict", "told"), [("not_representative", True), ("not_settled", False), (None, False)])
def test_a_mould_of_a_red_design_says_why_it_must_not_be_cast(monkeypatch, verdict, told):
    design = Design("designs/a", "suggest", {}, str(verdict), "Reads low.")
    monkeypatch.setattr(mould.project_index, "design_of_pad", lambda root, state: design)
    assert mould.verdict_of(Path(), State("palm")) == ("Reads low." if told else "")
    monkeypatch.setattr(mould.project_index, "design_of_pad", lambda root, state: None)
    assert mould.verdict_of(Path(), State("palm")) == ""


def test_a_fit_has_its_presses_and_its_tissue():
    assert tissue._presses(["fit", "a.csv", "--out", "t.toml", "b.csv"]) == ["a.csv", "b.csv"]
    assert tissue._tissue_of(SimpleNamespace(answer={"files": {"tissue": "tissue/a.toml"}})) == "tissue/a.toml"
    assert tissue._tissue_of(SimpleNamespace(answer={})) == ""


@pytest.fixture
def lab(tmp_path):
    return make_project(tmp_path / "lab", None, tissue="palm")


def test_the_strip_ticks_what_is_done_and_marks_what_is_next(lab):
    status = status_of(lab)
    strip = overview._strip(status, "/design", State("palm"))
    assert strip.count("<li") == 8 and strip.count('class="next"') == 1
    # the tissue of the library is chosen, nothing else is done
    assert strip.count("done: ") == 1 and "✓ " in strip and "tissue=palm" in strip
    for path in ("measured/a.csv", "moulds/m/record.json", "moulds/m/record-2.json"):
        (lab.root / path).parent.mkdir(exist_ok=True)
        (lab.root / path).write_text("{}", encoding="utf-8")
    strip = overview._strip(status_of(lab), "/design", State("palm"))
    assert "<small>1 not read yet</small>" in strip and "<small>2 recorded</small>" in strip
    for path in ("measured/a.csv", "moulds/m/record.json", "moulds/m/record-2.json"):
        (lab.root / path).unlink()
    nothing = overview._strip(status, "", State("palm"))
    assert nothing.count('class="next"') == 0 and nothing.count('class="done"') == 1


def test_the_strip_counts_the_presses_of_all_campaigns_and_links_results_on_people(lab):
    status = status_of(lab)
    counts = ({"pressed": 16, "missing": 0, "wrong": 0}, {"pressed": 0, "missing": 12, "wrong": 0})
    plans = tuple(ProjectFile(f"campaigns/{number}", "", "", one) for number, one in enumerate(counts))
    people = ProjectFile("designs/on-person-palm", "on-person", "", {})
    status = replace(status, files={**status.files, "campaigns": plans, "designs": (people,)})
    strip = overview._strip(status, "/design", State("palm"))
    assert "<small>16 of 28 presses</small>" in strip
    opened = overview.states_of(lab.root, status, State("palm"))[people.folder]
    assert "/cast?cast_tab=people&amp;tissue=palm" in overview.line_of("/design", people, opened)


def test_a_tissue_of_one_subject_has_one_column_of_values(monkeypatch):
    shown = []
    monkeypatch.setattr(tissue.widgets, "table", lambda head, rows, **more: shown.append((head, rows)))
    monkeypatch.setattr(tissue, "html", lambda *text: None)
    head = ("mean", "lowest", "highest", "kind")
    for high in (3.0, 4.0):
        one = {"value": 3.0, "low": 3.0, "high": high, "kind": "fitted"}
        tissue.parameter_table(head, {"gamma1_N_per_mm3": one}, lambda one: one["kind"])
    (alone, rows), (several, _) = shown
    assert alone == ["parameter", "", "value"] and rows == [["steady stiffness", "N/mm³", 3.0]]
    assert several == ["parameter", "", "mean", "lowest", "highest"]


def test_one_warning_more_is_no_warnings(monkeypatch):
    said = []
    monkeypatch.setattr(widgets, "html", lambda template, *values: said.append(template.format(*values)))
    for count in (5, 6):
        widgets.warnings({"warnings": [{"message": str(number)} for number in range(count)]})
    assert "1 more warning<" in said[0] and "2 more warnings<" in said[1]


def test_choices_are_what_lies_in_the_project_and_then_the_library(lab):
    root = lab.root
    (root / "tissue").mkdir(exist_ok=True)
    (root / "tissue" / "mine.toml").write_text("", encoding="utf-8")
    known = select_options.tissues(root)
    assert next(iter(known)) == "tissue/mine.toml" and "palm" in known
    assert "polyurethane-nagoya" in select_options.resins()
    assert {"auto", "slab", "crowned"} <= set(select_options.shapes())
    aims = select_options.aims("palm")
    assert list(aims)[:2] == ["average", "safe-side"] and len([one for one in aims if one.startswith("subject:")]) == 5
    presses = root / "measured" / "import-a"
    presses.mkdir(parents=True)
    (presses / "p1.csv").write_text("", encoding="utf-8")
    assert select_options.traces(root) == {"measured/import-a/p1.csv": "import-a/p1.csv"}


def test_folders_are_listed_by_age_and_hidden_ones_are_none(lab):
    root = lab.root
    for age, name in enumerate(("b", "a", ".c")):
        place = root / "calibrations" / name
        place.mkdir(parents=True)
        file = place / "calibration.json"
        file.write_text(json.dumps({}), encoding="utf-8")
        os.utime(file, (1000 + age, 1000 + age))
    assert select_options.folders(root, "calibrations", "calibration.json") == ["calibrations/b", "calibrations/a"]
    assert list(select_options.calibrations(root)) == [
        *("", "calibrations/a/calibration.json", "calibrations/b/calibration.json")
    ]
    assert select_options.campaigns(root) == {}


def test_a_free_name_is_numbered_beside_folders_and_files(lab):
    root = lab.root
    (root / "tissue").mkdir(exist_ok=True)
    assert select_options.free_name(root, "tissue", "hand") == "hand"
    (root / "tissue" / "hand").mkdir()
    (root / "tissue" / "hand-2.toml").write_text("", encoding="utf-8")
    assert select_options.free_name(root, "tissue", "hand") == "hand-3"
    assert select_options.free_library_name("tissue", "palm") == "palm-2"


def test_names_of_the_library_are_refused_and_own_ones_where_they_are_not_replaced(tmp_path, monkeypatch):
    monkeypatch.setenv("DUMMYDESIGN_HOME", str(tmp_path))
    select_options.check_name("tissue", "new-one")
    for name in ("palm", " PALM "):
        with raises_code("file_exists", "tissue"):
            select_options.check_name("tissue", name)
    own = tmp_path / "materials" / "tissues"
    own.mkdir(parents=True)
    (own / "mine.toml").write_text("", encoding="utf-8")
    select_options.check_name("tissue", "mine")
    with raises_code("file_exists", "tissue") as caught:
        select_options.check_name("tissue", "mine", replace=False)
    assert "tick Replace" in str(caught.value)


def test_what_is_chosen_and_gone_stands_at_the_head():
    known = {"a": "A"}
    assert select_options.offered(known, "a") == known
    assert list(select_options.offered(known, "b", "gone").items()) == [("b", "gone"), ("a", "A")]
    assert select_options.offered(known, "b")["b"] == "b"


@pytest.mark.parametrize(
    ("summary", "words"),
    [
        (None, "a"),
        ({"pressed": 2, "missing": 1, "wrong": 2}, "a: 2 of 3 presses are there, 2 problems"),
        ({**PAD, "verdict": "not_settled"}, "a: 5 mm slab, ratio 15: Measure first"),
        (PAD, "a: 5 mm slab, ratio 15"),
        ({"traces": 3}, "a: 3 presses"),
        ({"text": "so"}, "a: so"),
    ],
)
def test_a_thing_is_named_with_what_is_known_of_it(summary, words):
    assert overview.line_of("", ProjectFile("designs/a", "", "", summary), None) == words
