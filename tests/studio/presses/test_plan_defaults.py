"""A new plan begins with the pads that were moulded; a plan that is changed begins with itself."""

from __future__ import annotations

import json

from dummydesign.project.folder import make_project
from dummydesign.studio.pages import campaign as plan_defaults
from dummydesign.studio.pages.campaign import ALL, days_of, rows_of, table_html
from dummydesign.studio.state import read_state
from dummydesign.studio.widgets import number_of
from tests.support.refusal import raises_code


def mould(root, name, thickness, shape="slab", ratio=15.0, date="2026-01-01"):
    folder = root / "moulds" / name
    folder.mkdir(parents=True)
    inputs = {
        "shape": shape,
        "thickness_mm": thickness,
        "length_mm": 80.0,
        "width_mm": 60.0,
        "preset": "open",
        "resin": "polyurethane-nagoya",
        "ratio": ratio,
    }
    told = {"command": "mold", "finished": True, "date": date, "inputs": inputs}
    (folder / "manifest.json").write_text(json.dumps(told), encoding="utf-8")


def test_the_moulds_of_one_campaign_agree_and_have_their_own_thickness(tmp_path):
    project = make_project(tmp_path / "thumb", tissue="forefinger")
    state = read_state(project, {})
    assert plan_defaults.usual_moulds(project.root, state) == []
    crowned = "crowned:radius=20,height=2,foot=9"
    mould(project.root, "a", 15.0)
    mould(project.root, "b", 5.0)
    mould(project.root, "b-again", 5.0, date="2026-02-01")
    mould(project.root, "other-ratio", 10.0, ratio=14.0)
    mould(project.root, "crowned", 4.5, crowned, date="2026-03-01")
    assert plan_defaults.usual_moulds(project.root, state) == ["moulds/crowned"]
    chosen = state.changed(thickness_mm=15.0)
    assert plan_defaults.usual_moulds(project.root, chosen) == ["moulds/b-again", "moulds/a"]


def test_a_plan_of_moulds_leaves_pads_to_them_and_one_without_names_all():
    given = {**plan_defaults.FIELDS, "resin": "r", "ratio": 15.0, "punch": "square:14"}
    own = plan_defaults.plan_options(given)
    assert own["pads"] == "5,15,20" and not own["shape"] and not own["pad"] and own["ratio"] == 15.0
    shaped = plan_defaults.plan_options({**given, "shape": "crowned:20,2,9", "pad": "80x60"})
    assert shaped["shape"] == "crowned:20,2,9" and shaped["pad"] == "80x60"
    moulded = plan_defaults.plan_options({**given, "moulds": ["moulds/a", "moulds/b"]})
    assert moulded["from-mould"] == "moulds/a,moulds/b"
    assert not {"pads", "shape", "pad", "resin", "ratio"} & set(moulded)


def test_a_plan_that_is_changed_begins_with_its_own_values(tmp_path):
    folder = tmp_path / "campaigns" / "first"
    folder.mkdir(parents=True)
    assert plan_defaults.plan_of(tmp_path, "campaigns/first") == {}
    inputs = {
        "set_up": {"resin": "r", "ratio": 15.0, "pad": "80x60", "punch": "round:12", "shape": "slab"},
        "design": {
            "pads_mm": [6.0, 15.0],
            "velocities_mm_s": [10.0],
            "targets": [3.0, 9.0],
            "by_depth": False,
            "repeats": 3,
            "ages_days": [9.0],
            "hold_s": 5.0,
        },
    }
    (folder / "manifest.json").write_text(json.dumps({"command": "campaign new", "inputs": inputs}), encoding="utf-8")
    found = plan_defaults.plan_of(tmp_path, "campaigns/first")
    assert found["pads"] == "6,15" and found["forces"] == "3,9" and found["repeats"] == 3 and found["pad"] == "80x60"
    assert plan_defaults.plan_options({**plan_defaults.FIELDS, **found})["punch"] == "round:12"
    odd = json.dumps({"command": "campaign new", "inputs": inputs | {"set_up": "x"}})
    (folder / "manifest.json").write_text(odd, encoding="utf-8")
    assert plan_defaults.plan_of(tmp_path, "campaigns/first") == {}


def test_rows_of_a_day_are_those_of_one_age():
    rows = [{"file": name, "age_days": age} for name, age in (("a", 9.0), ("b", 14.0), ("c", 9.0), ("d", None))]
    first, second = days_of(rows)
    assert rows_of(rows, first) == [0, 2] and rows_of(rows, second) == [1] and rows_of(rows, ALL) == [0, 1, 2, 3]


def test_numbers_are_read_with_dot_or_comma_and_nothing_else():

    assert number_of(" 21,5 ", "t") == 21.5 and number_of("", "t") is None
    for text in ("abc", "nan", "inf", "1.2.3"):
        with raises_code("not_a_number", "temperature"):
            number_of(text, "temperature")


def test_the_table_escapes_names_and_labels_each_field():
    text = table_html(("age_days",), [{"file": '"><script>x</script>', "age_days": None}])
    assert "<script>" not in text and text.count("aria-label") == 1 and 'value=""' in text
