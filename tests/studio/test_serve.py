"""The studio as a process: one a folder, one a port, only with its key, bad input said."""

from __future__ import annotations

import json
import socket
import subprocess
import urllib.error
import urllib.request

import pytest

from dummydesign.project.folder import make_project
from tests.support.studio import command, running, surroundings, until

pytestmark = pytest.mark.slow


def refused(home, *words):
    """Standard error of a studio that does not start."""
    told = surroundings(home)
    done = subprocess.run(command(*map(str, words)), capture_output=True, text=True, timeout=600, env=told)
    assert done.returncode == 2 and done.stdout == "" and done.stderr.count("\n") == 1, done.stderr
    return done.stderr


def get(studio, path, key=True, **head):
    cookie = {"Cookie": studio.cookie} if key else {}
    asked = urllib.request.Request(f"{studio.home}{path}", headers={**cookie, **head})
    try:
        with urllib.request.urlopen(asked, timeout=600) as answer:
            return answer.status, answer.read()
    except urllib.error.HTTPError as said:
        return said.code, said.read()


def test_a_studio_answers_its_key_alone_and_keeps_its_folder_to_itself(tmp_path):
    folder = tmp_path / "thumb"
    make_project(folder, tissue="palm")
    (folder / "designs" / "a").mkdir()
    (folder / "designs" / "a" / "report.html").write_text("<p>ours</p>", encoding="utf-8")
    (tmp_path / "secret").write_text("theirs", encoding="utf-8")
    with running(folder, tmp_path / "home") as studio:
        assert studio.address in refused(tmp_path / "home", folder)
        assert get(studio, "", key=False)[0] == 403 and get(studio, "")[0] == 200
        assert get(studio, "files/designs/a/report.html") == (200, b"<p>ours</p>")
        for path in ("files/%2e%2e/secret", "files/..%2fsecret", "files/.studio/lock", "zip/%2e%2e", "zip/", "files/x"):
            status, said = get(studio, path)
            assert status == 404 and b"theirs" not in said, path
        assert get(studio, "", Host="evil.example")[0] == 403
        assert b"did you mean 'crowned'" in get(studio, "solid/pad?shape=crownd:20,2&thickness=9")[1]
    # the folder is free again
    with running(folder, tmp_path / "home") as studio:
        assert get(studio, "design")[0] == 200


def test_a_port_in_use_and_a_folder_that_is_a_file_are_said_in_one_line(tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert f"port {port} is in use" in refused(tmp_path / "home", tmp_path / "a", "--port", port)
    assert "1 to 65535" in refused(tmp_path / "home", tmp_path / "a", "--port", "70000")
    (tmp_path / "file").write_text("x", encoding="utf-8")
    assert "cannot be written" in refused(tmp_path / "home", tmp_path / "file")


def test_a_damaged_project_is_said_on_every_page_and_nothing_is_changed(tmp_path):
    text = "schema = 1\ntissue = "
    (tmp_path / "thumb").mkdir()
    (tmp_path / "thumb" / "project.toml").write_text(text, encoding="utf-8")
    with running(tmp_path / "thumb", tmp_path / "home") as studio:
        for path in ("", "measured", "tissue", "design", "mould", "campaign", "learn"):
            status, page = get(studio, path)
            assert status == 200 and b"not valid TOML" in page, path
    assert (tmp_path / "thumb" / "project.toml").read_text(encoding="utf-8") == text


def test_a_command_goes_on_when_the_studio_ends_and_the_next_one_knows_it(tmp_path):
    from dummydesign.studio import jobs

    make_project(tmp_path / "thumb", tissue="forefinger")
    words = ["suggest", "--tissue", "forefinger", "--shape", "slab", "--no-cad", "--out", "designs/a"]
    with running(tmp_path / "thumb", tmp_path / "home"):
        job = jobs.start(tmp_path / "thumb", "suggest", words)
    assert jobs.read_job(job.folder).state in ("running", "done")
    with running(tmp_path / "thumb", tmp_path / "home") as studio:
        until(lambda: jobs.read_job(job.folder).state != "running", seconds=1200)
        assert jobs.read_job(job.folder).answer["recommendation"]["shape"] == "slab"  # red or not
        assert b"designs/a" in get(studio, "")[1]
    manifest = json.loads((tmp_path / "thumb" / "designs" / "a" / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["finished"]
