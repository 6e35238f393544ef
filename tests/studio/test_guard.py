"""The door: key, host, origin, size, and files that stay inside the folder."""

import asyncio
import zipfile
from urllib.parse import unquote, urljoin, urlsplit

import pytest

from dummydesign.core.errors import InputError
from dummydesign.studio import file_transfer as files
from dummydesign.studio import trash
from dummydesign.studio.access import Guard
from tests.support.refusal import raises_code


def ask(path="/", query="", head=(), body=(b"",), kind="http", largest=1000, method="GET", known=False):
    """Send one request through a guard; return status, headers and what reached the server behind it.

    With ``known`` as a page of the studio sends it: under its path, with its cookie.
    """
    reached, sent = [], []

    async def server(scope, receive, send):
        taken = 0
        while True:
            message = await receive()
            if message["type"] == "http.disconnect":
                reached.append("cut off")
                raise RuntimeError("the client went away")
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

    async def request(guard, path, query, head, kind="http", method="GET"):
        sent.clear()
        head = {"host": "127.0.0.1:8420", **dict(head)}
        scope = {
            "type": kind,
            "path": path,
            "query_string": query.encode(),
            "method": method,
            "headers": [(name.encode(), value.encode()) for name, value in head.items()],
        }
        await guard(scope, receive, send)
        first = sent[0] if sent else {}
        return first.get("status", first.get("code")), dict(first.get("headers", []))

    async def both():
        guard, more = Guard(server, "sesame", 8420, largest), []
        place = path
        if known:
            _, answer = await request(guard, "/", "key=sesame", ())
            place = answer[b"location"].decode().rstrip("/") + path
            more = [("cookie", f"other=1; {answer[b'set-cookie'].decode().partition(';')[0]}")]
        return await request(guard, place, query, [*more, *head], kind, method)

    status, headers = asyncio.run(both())
    return status, headers, reached


def test_without_the_key_nothing_is_answered():
    for cookie in ("dummydesign-studio=simsalabim", "dummydesign-studio=sesame", "dummydesign-studio-8420=sesame"):
        assert ask(head=[("cookie", cookie)])[::2] == (403, [])
        assert ask("/x/", head=[("cookie", cookie)])[::2] == (403, [])
    assert ask()[::2] == ask(query="key=wrong")[::2] == ask(query="key=")[::2] == (403, [])
    assert ask(query="key=sesame", method="POST")[::2] == (403, [])
    assert ask(known=True)[::2] == (200, [0])
    # a path that only begins with that of the studio is another one
    assert ask("x/", known=True)[::2] == (403, [])


def test_neither_the_path_without_the_cookie_nor_the_cookie_without_the_path_opens_anything():
    async def nothing(*_):
        raise AssertionError

    sent = []

    async def send(message):
        sent.append(message)

    guard = Guard(nothing, "sesame", 8420)
    host = (b"host", b"127.0.0.1:8420")
    scope = {"type": "http", "method": "GET", "path": "/", "query_string": b"key=sesame", "headers": [host]}
    asyncio.run(guard(scope, nothing, send))
    given = dict(sent[0]["headers"])
    cookie = (b"cookie", given[b"set-cookie"].partition(b";")[0])
    for path, heads in ((given[b"location"].decode(), [host]), ("/", [host, cookie]), ("/design", [host, cookie])):
        sent.clear()
        asyncio.run(guard({**scope, "path": path, "query_string": b"", "headers": heads}, nothing, send))
        assert sent[0]["status"] == 403


def test_the_key_in_the_address_becomes_a_cookie_that_is_not_the_key_and_goes_to_one_path_only():
    status, head, reached = ask("/design", "key=sesame&which=a&empty=")
    place, cookie = head[b"location"].decode(), head[b"set-cookie"].decode()
    secret = place.split("/")[1]
    assert status == 303 and place == f"/{secret}/design?which=a&empty=" and reached == []
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and cookie.endswith(f"Path=/{secret}/")
    assert "sesame" not in cookie + place and len(secret) > 20
    assert cookie.partition("=")[2].partition(";")[0] != secret
    assert ask("/design", "key=sesame")[1][b"location"] != head[b"location"]


@pytest.mark.parametrize(
    "path",
    [
        "//evil.example/",
        "///evil.example/a",
        "/\t/evil.example",
        "/\\evil.example/",
        "/a\r\nset-cookie: b=c",
        "http://evil.example/",
        "/親指 a?b#c",
    ],
)
def test_the_key_never_leads_to_another_server(path):
    status, head, _ = ask(path, "key=sesame")
    if status == 303:
        led = urlsplit(urljoin("http://127.0.0.1:8420/", head[b"location"].decode("ascii")))
        assert led.netloc == "127.0.0.1:8420" and led.path.count("/") >= 2 and not led.path.startswith("//")
        assert unquote(led.path).endswith(path.lstrip("/"))
    else:
        assert status == 404 and "location" not in head


FOREIGN = [
    ("host", "evil.example"),
    ("host", "127.0.0.1:1"),
    ("host", ""),
    ("origin", "http://evil.example"),
    ("origin", "null"),
    ("origin", "http://localhost:8420"),
    ("origin", "http://127.0.0.1:1"),
    ("sec-fetch-site", "cross-site"),
    ("sec-fetch-site", "same-site"),
]


@pytest.mark.parametrize("head", FOREIGN)
def test_other_sites_ports_and_files_that_run_apart_are_refused_even_with_the_cookie(head):
    assert ask(head=[head], known=True)[::2] == (403, [])
    assert ask(head=[head], known=True, kind="websocket")[::2] == (4403, [])


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
def test_a_link_elsewhere_opens_the_studio_with_the_key_in_a_tab_only(site):
    tab = [("sec-fetch-site", site), ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "document")]
    status, head, _ = ask("/", "key=sesame", head=tab)
    # browsers send no strict cookie on a way that began elsewhere: the page goes on by itself
    assert status == 200 and b"set-cookie" in head and b"location" not in head
    for other in (("sec-fetch-dest", "iframe"), ("sec-fetch-mode", "no-cors"), ("origin", "http://evil.example")):
        assert ask("/", "key=sesame", head=[*tab, other])[0] == 403
    assert ask("/", head=tab)[0] == 403


@pytest.mark.parametrize("site", ["none", "same-origin"])
def test_the_studio_itself_and_an_address_that_is_typed_are_answered(site):
    assert ask(head=[("sec-fetch-site", site), ("origin", "http://127.0.0.1:8420")], known=True)[::2] == (200, [0])


def test_a_websocket_needs_the_key_too():
    assert ask(kind="websocket")[::2] == ask(kind="websocket", query="key=sesame")[::2] == (4403, [])
    assert ask(kind="websocket", path="/view/a")[::2] == (4403, [])


@pytest.mark.parametrize("length", [str(1000 + 64 * 1024 + 1), "-3", "²", "9" * 5000, "1e3", ""])
def test_a_body_that_says_it_is_too_large_or_nonsense_never_reaches_the_server(length):
    assert ask(head=[("content-length", length)], known=True)[::2] == (413, [])


def test_a_body_that_says_no_length_never_reaches_the_server():
    assert ask(body=[b"x" * 500], head=[("transfer-encoding", "chunked")], known=True)[::2] == (411, [])
    both = [("transfer-encoding", "chunked"), ("content-length", "500")]
    assert ask(body=[b"x" * 500], head=both, known=True)[::2] == (411, [])
    assert ask(body=[b"x" * 500, b"y"], head=[("content-length", "501")], known=True)[::2] == (200, [501])


def directives(path):
    text = ask(path, known=True)[1][b"content-security-policy"].decode()
    return {words.split()[0]: words.split()[1:] for words in text.split(";")}


def test_a_page_may_ask_this_server_only():
    policy = directives("/design")
    assert policy["default-src"] == ["'self'"] and "sandbox" not in policy
    reached = {word for words in policy.values() for word in words if not word.startswith("'")}
    assert reached == {"data:", "blob:", "ws://127.0.0.1:8420", "ws://localhost:8420"}


@pytest.mark.parametrize("path", ["/files/a.html", "/solid/pad"])
def test_files_of_the_project_run_apart_and_reach_no_server(path):
    policy = directives(path)
    assert policy["default-src"] == ["'none'"] and policy["form-action"] == ["'none'"]
    assert {"allow-same-origin", "allow-popups", "allow-forms", "allow-top-navigation"}.isdisjoint(policy["sandbox"])
    reached = {word for name, words in policy.items() if name.endswith("-src") for word in words}
    assert reached <= {"'none'", "'unsafe-inline'", "data:", "blob:"}


@pytest.mark.parametrize(
    "name",
    [
        "../a.csv",
        "a/b.csv",
        "..",
        "",
        ".hidden",
        "a\\b.csv",
        "C:a.csv",
        "con.txt",
        "a\n.csv",
        "x" * 300 + ".csv",
        "project.toml",
        "Campaign.TOML",
        "manifest.json",
        "calibration.json",
    ],
)
def test_a_name_that_is_not_plain_is_refused(name):
    with raises_code("bad_name", "file_name"):
        files.plain_name(name)


def test_a_disk_that_is_full_is_said_and_leaves_nothing(tmp_path, monkeypatch):
    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with raises_code("file_unwritable", "file"):
        trash.keep_file(tmp_path, tmp_path / "measured", "a.csv", b"1")
    assert list((tmp_path / "measured").iterdir()) == []


@pytest.mark.parametrize(
    "path", ["../x", "designs/../../x", "a/../designs", ".studio/lock", "designs/.part/a", "/etc/passwd"]
)
def test_only_what_lies_in_the_project_is_given_out(tmp_path, path):
    with raises_code("not_allowed", "path"):
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
    (tmp_path / ".hidden").write_text("theirs", encoding="utf-8")
    for number, target in enumerate((tmp_path.parent, tmp_path / ".hidden", "/etc/passwd", "nowhere", "self")):
        (folder / ("self" if target == "self" else f"link{number}")).symlink_to(target)
    assert files.listed(tmp_path, folder) == ["moulds/a/in/y.stl", "moulds/a/x.step"]
    with files.zipped(tmp_path, folder) as packed, zipfile.ZipFile(packed) as archive:
        assert sorted(archive.namelist()) == ["a/in/y.stl", "a/x.step"]
    assert [path.name for path in (tmp_path / ".studio").iterdir()] == []


def test_an_archive_on_a_full_disk_is_said_before_anything_is_sent_and_leaves_nothing(tmp_path, monkeypatch):
    folder = tmp_path / "moulds" / "a"
    folder.mkdir(parents=True)
    (folder / "x.step").write_text("x", encoding="utf-8")

    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(zipfile.ZipFile, "write", full)
    with raises_code("file_unwritable", "archive"):
        files.zipped(tmp_path, folder)
    assert list((tmp_path / ".studio").iterdir()) == []


@pytest.mark.parametrize("path", ["/" + "a" * 5000, "/a\\b", "/a\nb", "/a\x00b"])
def test_an_address_that_no_page_has_never_reaches_the_server(path):
    assert ask(path, known=True)[::2] == (404, [])
    assert ask(path, known=True, kind="websocket")[::2] == (4403, [])


@pytest.mark.parametrize("length", ["²", "1³"])
def test_a_length_in_other_digits_is_no_length(length):
    async def nothing(*_):
        raise AssertionError

    sent = []

    async def send(message):
        sent.append(message)

    host = (b"host", b"127.0.0.1:8420")
    heads = [host, (b"content-length", length.encode("latin-1"))]
    scope = {"type": "http", "method": "POST", "path": "/view/a", "query_string": b"", "headers": heads}
    asyncio.run(Guard(nothing, "sesame", 8420)(scope, nothing, send))
    assert sent[0]["status"] == 413


def test_what_answers_a_key_or_refuses_is_kept_by_no_browser_and_told_to_no_site():
    for head in (ask("/", "key=sesame")[1], ask("/")[1], ask(known=True, head=[("host", "evil.example")])[1]):
        assert head[b"cache-control"] == b"no-store"
    assert ask("/", "key=sesame")[1][b"referrer-policy"] == b"no-referrer"


def test_the_page_that_goes_on_by_itself_holds_no_html_of_the_address():
    """Nothing else of an address is quoted by then: parts of it are put into an attribute."""
    sent = []

    async def send(message):
        sent.append(message)

    tab = {"sec-fetch-site": "cross-site", "sec-fetch-mode": "navigate", "sec-fetch-dest": "document"}
    heads = [(name.encode(), value.encode()) for name, value in {"host": "127.0.0.1:8420", **tab}.items()]
    scope = {
        "type": "http",
        "method": "GET",
        "path": '/"><b>',
        "query_string": b"key=sesame&a=%22%3E%3Cb%3E&c=d",
        "headers": heads,
    }
    asyncio.run(Guard(None, "sesame", 8420)(scope, None, send))
    page = sent[1]["body"]
    assert page.count(b'"') == 4 and page.count(b">") == 2 and b"&amp;c=d" in page


@pytest.mark.parametrize("path", ["/design", "/view/a", "/files/a.html", "/solid/pad"])
def test_every_answer_is_taken_for_what_it_says_and_tells_no_site_where_it_lies(path):
    head = ask(path, known=True)[1]
    assert head[b"x-content-type-options"] == b"nosniff" and head[b"referrer-policy"] == b"no-referrer"
    assert head[b"x-dns-prefetch-control"] == b"off"


@pytest.mark.parametrize("path", ["/design", "/files/a.html", "/solid/pad"])
def test_only_the_studio_frames_its_pages_and_none_moves_its_links_or_runs_plugins(path):
    policy, apart = directives(path), path != "/design"
    assert policy["frame-ancestors"] == ["'self'"]
    assert policy["base-uri"] == policy["form-action"] == ["'none'" if apart else "'self'"]
    assert policy.get("object-src", policy["default-src"]) == ["'none'"]


def of_type(kind, path):
    """The policy of an answer of a type."""

    async def server(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": [(b"content-type", kind)]})
        await send({"type": "http.response.body", "body": b""})

    sent = []

    async def send(message):
        sent.append(message)

    scope = {
        "type": "http",
        "method": "GET",
        "path": path,
        "query_string": b"",
        "headers": [(b"host", b"127.0.0.1:8420")],
    }
    asyncio.run(Guard(server, "sesame", 8420)(scope, None, send))
    text = dict(sent[0]["headers"])[b"content-security-policy"].decode()
    return {words.split()[0]: words.split()[1:] for words in text.split(";")}


def test_a_pdf_alone_is_shown_without_a_sandbox_and_runs_nothing():
    policy = of_type(b"application/pdf", "/view/0/a.pdf")
    assert "sandbox" not in policy and policy["default-src"] == ["'none'"] and "script-src" not in policy
    assert policy["frame-ancestors"] == ["'self'"] and policy["object-src"] == ["'self'"]
    for kind in (b"text/html", b"image/svg+xml", b"application/pdf; x", b"text/xml"):
        assert "sandbox" in of_type(kind, "/view/0/a")
