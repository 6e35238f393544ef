"""The panel of a long command: what is shown of the jobs in the folder, and when it can be started."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")

from dummydesign.core.errors import InputError
from dummydesign.studio import job_panel, jobs


def job(name, state, words=("fit", "a.csv"), answer=None, error=""):
    return SimpleNamespace(
        folder=Path(name),
        name="fit",
        commands=(words,),
        words=words,
        state=state,
        started=0.0,
        seconds=3.2,
        answer=answer or {},
        error=error,
        begun="fit a.csv",
        has_answer=state in ("done", "failed") and bool(answer),
    )


@pytest.fixture
def panel(monkeypatch):
    """A panel of the command ``fit a.csv``, its folder of jobs, and what it showed."""
    from nicegui.client import Client
    from nicegui.page import page

    every, log = [], {"shown": [], "ended": [], "focus": [], "started": []}
    monkeypatch.setattr(jobs, "all_jobs", lambda root, name: list(every))
    monkeypatch.setattr(jobs, "latest", lambda root, name: every[-1] if every else None)
    monkeypatch.setattr(jobs, "usual_s", lambda name: None)
    monkeypatch.setattr(jobs, "progress_line", lambda newest, usual: "going on")
    monkeypatch.setattr(jobs, "start", lambda root, name, *commands: log["started"].append(commands))
    monkeypatch.setattr(jobs, "stop", lambda one: log["started"].append(("stop", one.folder.name)))
    monkeypatch.setattr(job_panel, "_move_focus", lambda gone, stays: log["focus"].append(gone))
    chosen = {"words": ["fit", "a.csv"]}

    def words():
        if chosen["words"] is None:
            raise InputError("choose a press", "missing", "trace")
        return chosen["words"]

    client = Client(page(""), request=None)
    with client:
        made = job_panel.JobPanel(
            Path(),
            "fit",
            "Fit",
            words,
            lambda one: log["shown"].append(one.folder.name),
            ended=lambda one, mine: log["ended"].append((one.folder.name, mine)),
            needs="tissue",
        )
        yield SimpleNamespace(panel=made, every=every, log=log, chosen=chosen)
    client.delete()


def test_an_answer_to_what_is_chosen_is_shown_and_one_to_another_choice_is_not(panel):
    panel.every.append(job("1", "done", answer={"tissue": 1}))
    panel.panel.update()
    assert panel.log["shown"] == ["1"] and panel.panel.shown is panel.every[0]
    assert panel.panel._status.text == "done in 3 s"
    # nothing has changed: nothing is drawn anew
    panel.panel.update()
    assert panel.log["shown"] == ["1"]
    panel.chosen["words"] = ["fit", "b.csv"]
    panel.panel.update()
    assert panel.panel.shown is None and panel.panel._status.text == ""
    panel.chosen["words"] = None
    panel.panel.update()
    assert panel.panel.shown is None


def test_an_answer_without_what_is_needed_is_no_answer_to_show(panel):
    panel.every.append(job("1", "done", answer={"rows": 1}))
    panel.panel.update()
    assert panel.panel.shown is None and panel.log["shown"] == []


def test_while_it_runs_it_can_be_stopped_and_not_started(panel):
    panel.every.append(job("1", "running"))
    panel.panel.update()
    assert panel.panel.running and not panel.panel._button.enabled and panel.panel._stop.visible
    assert panel.panel._status.text == "going on"
    panel.panel.end()
    assert panel.log["started"] == [("stop", "1")]
    panel.every[0] = job("1", "done", answer={"tissue": 1})
    panel.panel.update()
    assert panel.panel._button.enabled and not panel.panel._stop.visible
    # whoever watched it is told of its end once
    assert panel.log["ended"] == [("1", True)]
    panel.panel.update()
    assert panel.log["ended"] == [("1", True)]


def test_a_job_that_ended_before_the_page_was_opened_tells_nobody(panel):
    panel.every.append(job("1", "done", answer={"tissue": 1}))
    panel.panel.update()
    assert panel.log["ended"] == []


@pytest.mark.parametrize(("answer", "status"), [({"tissue": 1}, "done in 3 s"), (None, None)])
def test_a_failure_is_told_over_an_older_answer(panel, answer, status):
    panel.every += [job("1", "done", answer={"tissue": 1}), job("2", "failed", answer=answer, error="too few samples")]
    panel.panel.update()
    assert panel.panel.shown is panel.every[1 if answer else 0]
    assert panel.panel._status.text == (status or job_panel.ENDED["failed"])
    told = [child for child in panel.panel._problem.descendants()]
    assert any("too few samples" in str(getattr(one, "content", getattr(one, "text", ""))) for one in told)


def test_an_answer_with_a_verdict_says_itself_what_is_wrong_and_a_step_that_should_not_be_done_is_not_the_main_one(
    panel,
):
    answer = {"tissue": 1, "accepted": False}
    panel.every.append(job("1", "failed", answer=answer, error="the pad is not accepted"))
    panel.panel.update()
    assert panel.log["shown"] == ["1"] and not list(panel.panel._problem.descendants())
    panel.every.clear()
    for main in (True, False):
        panel.panel.main = main
        panel.panel.update()
        assert ("outline" in panel.panel._button.props) != main


def test_a_start_is_of_the_commands_as_shown_and_a_refused_choice_starts_nothing(panel):
    panel.panel.begin()
    assert panel.log["started"] == [(["fit", "a.csv"],)] and panel.log["focus"]
    panel.chosen["words"] = None
    panel.panel.begin()
    assert len(panel.log["started"]) == 1
