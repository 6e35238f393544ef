"""What pages offer and keep: pucks among the measured files, and whether what was read has changed since."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")

from nicegui import ui

from dummydesign.core.manifest import sha256_of
from dummydesign.project.folder import make_project
from dummydesign.project.status import ProjectFile
from dummydesign.studio.jobs import changed_inputs
from dummydesign.studio.pages import cast, learn
from dummydesign.studio.pages.design import Bar
from dummydesign.studio.pages.pucks import PuckPage, pucks
from dummydesign.studio.state import State
from dummydesign.studio.widgets import Form, NumberField, select
from tests.support import lab_project as lab
from tests.support.refusal import raises_code

HEAD = "time_s,displacement_mm,force_N\n"


def test_pucks_are_imported_presses_and_files_that_are_traces_as_they_are(tmp_path):
    (tmp_path / "measured" / "import-a").mkdir(parents=True)
    texts = {
        "import-a/a_1.csv": HEAD,
        "plain.csv": HEAD,
        "order.csv": "\ufeffforce_N, note,time_s,displacement_mm\n",
        "machine.csv": "Zeit;Weg;Kraft\n",
        "part.csv": "time_s,force_N\n",
    }
    for name, text in texts.items():
        (tmp_path / "measured" / name).write_text(text, encoding="utf-8")
    (tmp_path / "measured" / "binary.csv").write_bytes(b"\xff\xfe\x00")
    assert set(pucks(tmp_path)) == {"measured/import-a/a_1.csv", "measured/plain.csv", "measured/order.csv"}


def test_files_that_changed_or_went_since_they_were_read_are_named(tmp_path):
    read = []
    for name in ("a.csv", "b.csv", "c.csv"):
        (tmp_path / name).write_text(name)
        read.append({"name": name, "file": name, "sha256": sha256_of(tmp_path / name)})
    manifest = tmp_path / "manifest.json"
    manifest.write_text(json.dumps({"files_read": read}))
    assert changed_inputs(tmp_path, manifest) == []
    (tmp_path / "b.csv").write_text("other")
    (tmp_path / "c.csv").unlink()
    assert changed_inputs(tmp_path, manifest) == ["b.csv", "c.csv"]
    assert changed_inputs(tmp_path, tmp_path / "none.json") == []


@pytest.fixture
def client():
    """A place for the elements of a page, without a browser."""
    from nicegui.client import Client
    from nicegui.page import page

    made = Client(page(""), request=None)
    with made:
        yield made
    made.delete()


def test_among_several_presses_none_is_taken_for_the_pucks(tmp_path, client):
    project = make_project(tmp_path, None, tissue="palm")
    for count, name in enumerate(("a.csv", "b.csv"), 1):
        (tmp_path / "measured" / name).write_text(HEAD, encoding="utf-8")
        page = PuckPage(project, State("palm"), {"puck_diameter": "50", "puck_height": "30"})
        assert page._form.fields["press"].value == ("measured/a.csv" if count == 1 else "")
    with raises_code("missing", "press"):
        page._words()


def test_a_campaign_that_is_not_pressed_is_not_learned_from_first(tmp_path, client, monkeypatch):
    project = make_project(tmp_path, None, tissue="palm")
    (tmp_path / "campaigns" / "first").mkdir(parents=True)
    (tmp_path / "campaigns" / "first" / "campaign.toml").write_text("", encoding="utf-8")
    plan = ProjectFile("campaigns/first", "", "", {"pressed": 1, "missing": 3, "wrong": 0})
    monkeypatch.setattr(learn, "things_in", lambda root, room: [plan])
    page = learn.LearnPage(project, State("palm", campaign="campaigns/first"), {})
    assert not page.work.main
    (said,) = [one.content for one in page.lacking.descendants() if "missing" in getattr(one, "content", "")]
    assert "3 presses of this campaign are missing" in said


def test_moulds_without_gauge_points_are_named_and_none_at_all_is_said_only_without_moulds(tmp_path, client):
    project, state = make_project(tmp_path, None, tissue="palm"), State("palm")

    def said():
        comparison = SimpleNamespace(root=project.root, state=state, find_pads=lambda: None)
        page = cast.record_form(comparison, {})
        assert page is None
        words = " ".join(getattr(one, "content", "") for one in client.elements.values())
        client.content.clear()
        return words

    assert "No mould in this project" in said()
    for name in ("bare", "whole"):
        lab.mould(tmp_path, name, 6.0)
    words = said()
    assert "No mould" not in words and "moulds/bare" in words and "moulds/whole" in words
    lab.gauged(tmp_path / "moulds" / "whole", 6.0)
    words = said()
    assert "moulds/bare (spec.json)" in words and "moulds/whole (spec.json)" not in words and "gauge-map" in words


def test_a_field_whose_default_was_changed_is_marked_and_goes_back_to_it(client):
    made = {
        "name": ui.input("Name", value="first"),
        "note": ui.input("Note"),
        "repeats": NumberField("Repeats", 2.0),
        "resin": select("Resin", {"a": "A", "b": "B"}, "a"),
    }
    form = Form("plan", lambda: made, {"repeats": "7"})
    marks = {name: one.slots["append"].children[0] for name, one in made.items() if "append" in one.slots}
    assert {name: mark.visible for name, mark in marks.items()} == {"name": False, "repeats": True, "resin": False}
    for name, text in (("name", "second"), ("note", "so"), ("resin", "b")):
        made[name].set_value(text)
    assert all(mark.visible and "default" in mark.props["aria-label"] for mark in marks.values())
    for mark in marks.values():
        (listener,) = [one for one in mark._event_listeners.values() if one.type == "click"]
        mark._handle_event({"listener_id": listener.id, "args": None})
    assert form.kept() == {"name": "first", "note": "so", "repeats": "2", "resin": "a"}
    assert not any(mark.visible for mark in marks.values())


def test_a_slider_is_not_answered_by_the_server():
    """NiceGUI reads this of a class: under another name keys that follow each other would be taken back."""
    from nicegui import ui

    assert ui.slider.LOOPBACK is not False and Bar.LOOPBACK is False
