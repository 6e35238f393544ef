"""The door: key, host, origin, size, and files that stay inside the folder."""

import asyncio
import io
import zipfile

import pytest

from dummydesign.core.errors import InputError
from dummydesign.studio.server import files
from dummydesign.studio.server.guard import Guard


def ask(path="/", query="", head=(), body=(b"",), kind="http", largest=1000):
    """Send one request through a guard; return status, headers and what reached the server behind it."""
    reached, sent = [], []

    async def server(scope, receive, send):
        taken = 0
        while True:
            message = await receive()
            if message["type"] == "http.disconnect":
                reached.append("cut off")
                return
            taken += len(message.get("body", b""))
            if not message.get("more_body"):
                break
        reached.append(taken)
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"ok"})

    pieces = list(body)

    async def receive():
        piece = pieces.pop(0)
        return {"type": "http.request", "body": piece, "more_body": bool(pieces)}

    async def send(message):
        sent.append(message)

    head = {"host": "127.0.0.1:8420", **dict(head)}
    scope = {"type": kind, "path": path, "query_string": query.encode(),
             "headers": [(name.encode(), value.encode()) for name, value in head.items()]}  # fmt: skip
    asyncio.run(Guard(server, "sesame", 8420, largest)(scope, receive, send))
    first = sent[0] if sent else {}
    return first.get("status", first.get("code")), dict(first.get("headers", [])), reached


COOKIE = ("cookie", "dummydesign-studio-8420=sesame")


def test_without_the_key_nothing_is_answered():
    for head in ([], [("cookie", "dummydesign-studio-8420=simsalabim")], [("cookie", "dummydesign-studio-1=sesame")]):
        assert ask(head=head)[::2] == (403, [])
    assert ask(query="key=wrong")[::2] == (403, [])


def test_the_key_in_the_address_becomes_a_cookie_and_leaves_the_address():
    status, head, reached = ask("/design", "key=sesame&which=a")
    assert status == 303 and head[b"location"] == b"/design?which=a" and reached == []
    assert b"HttpOnly" in head[b"set-cookie"] and b"SameSite=Strict" in head[b"set-cookie"]
    assert ask(head=[COOKIE])[::2] == (200, [0])


@pytest.mark.parametrize("head", [("host", "evil.example"), ("host", "127.0.0.1:1"), ("origin", "http://evil.example")])
def test_pages_of_other_sites_and_names_that_point_here_are_refused_even_with_the_key(head):
    assert ask(head=[COOKIE, head])[::2] == (403, [])
    assert ask(head=[COOKIE, head], kind="websocket")[0] == 4403


def test_a_websocket_needs_the_key_too():
    assert ask(kind="websocket")[::2] == (4403, [])


def test_a_body_that_says_it_is_too_large_never_reaches_the_server():
    too_large = str(1000 + 64 * 1024 + 1)
    assert ask(head=[COOKIE, ("content-length", too_large)])[::2] == (413, [])
    assert ask(head=[COOKIE, ("content-length", "-3")])[::2] == (413, [])


def test_a_body_that_says_no_length_is_cut_off():
    assert ask(head=[COOKIE], body=[b"x" * 40_000] * 3)[2] == ["cut off"]
    assert ask(head=[COOKIE], body=[b"x" * 500, b"y"])[2] == [501]


def test_a_page_may_ask_this_server_only_and_files_of_the_project_run_apart():
    policy = ask(head=[COOKIE])[1][b"content-security-policy"].decode()
    assert "default-src 'self'" in policy and "http" not in policy
    assert ask("/files/a.html", head=[COOKIE])[1][b"content-security-policy"].startswith(b"sandbox")
    assert b"allow-same-origin" not in ask("/files/a.html", head=[COOKIE])[1][b"content-security-policy"]


@pytest.mark.parametrize(
    "name",
    ["../a.csv", "a/b.csv", "..", "", ".hidden", "a\\b.csv", "C:a.csv", "con.txt", "a\n.csv", "x" * 300 + ".csv"],
)
def test_a_name_that_is_not_plain_is_refused_and_nothing_is_written(tmp_path, name):
    with pytest.raises(InputError, match="not taken"):
        files.keep(tmp_path / "measured", name, b"1")
    assert not (tmp_path / "measured").exists() and not (tmp_path / "a.csv").exists()


def test_a_file_of_the_same_name_is_never_written_over(tmp_path):
    assert files.keep(tmp_path, "a.csv", b"1").name == "a.csv"
    assert files.keep(tmp_path, "a.csv", b"1").name == "a.csv"
    assert files.keep(tmp_path, "a.csv", b"2").name == "a-2.csv"
    assert (tmp_path / "a.csv").read_bytes() == b"1"


def test_a_disk_that_is_full_is_said_and_leaves_nothing(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(InputError, match="No space left on device"):
        files.keep(tmp_path, "a.csv", b"1")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["../x", "designs/../../x", ".studio/lock", "designs/.part/a", "/etc/passwd"])
def test_only_what_lies_in_the_project_is_given_out(tmp_path, path):
    with pytest.raises(InputError, match="not a file of this project"):
        files.inside(tmp_path, path)


def test_a_link_that_leads_out_is_refused(tmp_path):
    (tmp_path / "secret").write_text("x", encoding="utf-8")
    (tmp_path / "root").mkdir()
    (tmp_path / "root" / "a").symlink_to(tmp_path / "secret")
    with pytest.raises(InputError):
        files.inside(tmp_path / "root", "a")


def test_an_archive_holds_the_folder_without_hidden_files(tmp_path):
    folder = tmp_path / "moulds" / "a"
    (folder / "in").mkdir(parents=True)
    for name in ("x.step", "in/y.stl", ".part"):
        (folder / name).write_text(name, encoding="utf-8")
    packed = b"".join(files.zipped(tmp_path, folder))
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        assert sorted(archive.namelist()) == ["a/in/y.stl", "a/x.step"]
    assert [path.name for path in (tmp_path / ".studio").iterdir()] == []


def test_an_archive_on_a_full_disk_is_said_before_anything_is_sent_and_leaves_nothing(tmp_path, monkeypatch):
    folder = tmp_path / "moulds" / "a"
    folder.mkdir(parents=True)
    (folder / "x.step").write_text("x", encoding="utf-8")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(zipfile.ZipFile, "write", full)
    with pytest.raises(InputError, match="archive of 'a' cannot be packed: No space left on device"):
        files.zipped(tmp_path, folder)
    assert list((tmp_path / ".studio").iterdir()) == []
