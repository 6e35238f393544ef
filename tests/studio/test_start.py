"""How a studio starts: its folder, its address, a second one, what a killed one left."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from dummydesign.core.errors import InputError
from dummydesign.core.files import acquire_lock, is_locked
from dummydesign.studio import app as serve
from tests.support.refusal import raises_code

uvicorn = pytest.importorskip("uvicorn", reason="no NiceGUI here: pip install nicegui")
POSIX = pytest.mark.skipif(os.name == "nt", reason="rights are another matter there")


@pytest.fixture
def start(tmp_path, monkeypatch):
    """Start a studio whose server does one thing and ends; what it says and what the browser is shown are kept."""
    from dummydesign.studio import app

    shown, said = [], []
    monkeypatch.setattr(app, "make_app", lambda root: None)
    monkeypatch.setattr("webbrowser.open", shown.append)
    monkeypatch.setenv("NICEGUI_STORAGE_PATH", "")

    def run(meanwhile=lambda: None, browser=False, folder=tmp_path):
        monkeypatch.setattr(uvicorn.Server, "run", lambda server, sockets: meanwhile())
        serve.run_studio(folder, None, browser, said.append)

    run.shown, run.said = shown, said
    return run


def test_a_folder_open_elsewhere_gives_the_address_that_works_and_opens_it_unless_told_not_to(tmp_path, start):
    def again():
        address = start.said[0].rpartition(" ")[2]
        for browser in (False, True):
            with pytest.raises(InputError) as problem:
                serve.run_studio(tmp_path, None, browser, start.said.append)
            assert address in str(problem.value) and "?key=" in address
        (shown,) = start.shown
        assert shown.partition("key=")[0] == address.partition("key=")[0] and shown != address

    start(again)
    assert len(start.said) == 1 and not is_locked(tmp_path / ".studio" / "lock")
    assert not (tmp_path / ".studio" / "address").exists()


def test_a_folder_whose_address_is_not_known_is_refused_all_the_same(tmp_path, start):
    lock = acquire_lock(tmp_path / ".studio" / "lock")
    with raises_code("busy", "folder"):
        start(browser=True)
    lock.close()
    assert start.shown == []


@POSIX
def test_the_address_with_the_key_is_for_its_owner_alone(tmp_path, start):
    (tmp_path / ".studio").mkdir(mode=0o755)
    (tmp_path / ".studio" / "address").write_text("of a killed one", encoding="utf-8")
    (tmp_path / ".studio" / "address").chmod(0o644)
    found = []

    def look():
        for name in (".studio", ".studio/address"):
            found.append(stat.S_IMODE((tmp_path / name).stat().st_mode))
        found.append((tmp_path / ".studio" / "address").read_text(encoding="utf-8"))

    before = os.umask(0)
    try:
        start(look)
    finally:
        os.umask(before)
    assert found[:2] == [0o700, 0o600] and start.said[0].endswith(found[2])


def test_what_a_killed_studio_left_is_taken_away(tmp_path, start):
    (tmp_path / ".studio").mkdir()
    for name in ("address", "once"):
        (tmp_path / ".studio" / name).write_text("of a killed one", encoding="utf-8")
    found = []
    start(lambda: found.extend(path.name for path in (tmp_path / ".studio").iterdir()))
    assert sorted(found) == [".gitignore", "address", "lock"]


@POSIX
@pytest.mark.skipif(hasattr(os, "geteuid") and os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_may_not_be_written_is_one_line(tmp_path, start):
    (tmp_path / "a").mkdir(mode=0o500)
    with pytest.raises(InputError, match="cannot be written"):
        start(folder=tmp_path / "a")


def test_a_full_disk_is_one_line_and_lets_go_of_the_folder(tmp_path, start, monkeypatch):
    opened = os.open

    def full(path, *given, **more):
        if Path(path).name == "address":
            raise OSError(28, "No space left on device")
        return opened(path, *given, **more)

    monkeypatch.setattr(os, "open", full)
    with raises_code("file_unwritable", "folder"):
        start()
    assert not is_locked(tmp_path / ".studio" / "lock") and start.said == []


def test_the_key_of_a_browser_that_is_started_opens_the_studio_once(tmp_path, start, monkeypatch):
    """All users of a machine see with what address a browser is started."""
    guards, found = [], []
    config = uvicorn.Config
    monkeypatch.setattr(uvicorn, "Config", lambda guard, **more: guards.append(guard) or config(guard, **more))

    def meanwhile():
        once = guards[0]._once
        key, lasting = (address.partition("key=")[2] for address in (start.shown[0], start.said[0]))
        assert stat.S_IMODE((tmp_path / ".studio" / "once").stat().st_mode) & 0o077 == 0 or os.name == "nt"
        found.extend(once(one) for one in ("", "wrong", lasting, key, key, ""))

    start(meanwhile, browser=True)
    assert found == [False, False, False, True, False, False]
    assert not (tmp_path / ".studio" / "once").exists()


def _home(root):
    (root / ".studio").mkdir()
    return root / ".studio"


LINKS = {
    "the folder": lambda root, out: (root / ".studio").symlink_to(out),
    "what Git leaves out": lambda root, out: (_home(root) / ".gitignore").symlink_to(out / "theirs"),
    "the lock": lambda root, out: (_home(root) / "lock").symlink_to(out / "theirs"),
    "the bin": lambda root, out: (_home(root) / "bin").symlink_to(out),
    "an answer": lambda root, out: _answer(root).symlink_to("/dev/zero"),
    "a pipe": lambda root, out: os.mkfifo(_answer(root)),
}


def _answer(root):
    folder = _home(root) / "jobs" / "0001-suggest"
    folder.mkdir(parents=True)
    return folder / "answer.json"


@POSIX
@pytest.mark.parametrize("link", LINKS.values(), ids=LINKS)
def test_a_folder_whose_studio_files_lead_elsewhere_is_refused_and_nothing_there_changes(tmp_path, start, link):
    root, out = tmp_path / "root", tmp_path / "out"
    for folder in (root, out):
        folder.mkdir()
    out.chmod(0o755)
    for name in ("theirs", "zip-theirs", "address"):
        (out / name).write_text("theirs", encoding="utf-8")
    link(root, out)
    with raises_code("not_allowed"):
        start(folder=root)
    assert start.said == [] and stat.S_IMODE(out.stat().st_mode) == 0o755
    assert {path.name: path.read_text() for path in out.iterdir()} == dict.fromkeys(
        ("theirs", "zip-theirs", "address"), "theirs"
    )


@POSIX
def test_a_link_that_was_deleted_keeps_nobody_out(tmp_path, start):
    content = tmp_path / ".studio" / "bin" / "1-a" / "content"
    content.mkdir(parents=True)
    (content / "a.csv").symlink_to(tmp_path / "nowhere")
    start()
    assert len(start.said) == 1


def test_only_this_machine_reaches_the_server_and_no_header_says_otherwise(tmp_path, start, monkeypatch):
    seen = []

    def run(server, sockets):
        seen.extend((socket.getsockname()[0], server.config.proxy_headers) for socket in sockets)

    monkeypatch.setattr(uvicorn.Server, "run", run)
    serve.run_studio(tmp_path, None, False, start.said.append)
    assert seen == [("127.0.0.1", False)]
