"""A real server and plain sockets: what is refused, and that no request whatever breaks it."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import socket
import zipfile
from urllib.parse import quote

import pytest

from dummydesign.project.folder import make_project
from tests.support.raw_studio import LARGEST_BYTES, raw_studio
from tests.support.studio import until

pytest.importorskip("nicegui", reason="no NiceGUI here: pip install nicegui")
JAPANESE = 'moulds/親指 "パッド"'


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    base = tmp_path_factory.mktemp("raw")
    make_project(base / "thumb", tissue="palm")
    (base / "secret").write_text("theirs", encoding="utf-8")
    folder = base / "thumb"
    (folder / JAPANESE).mkdir(parents=True)
    (folder / JAPANESE / "指.txt").write_text("ours", encoding="utf-8")
    os.symlink(base / "secret", folder / JAPANESE / "out.txt")
    os.symlink(folder / JAPANESE / "loop", folder / JAPANESE / "loop")
    (folder / "designs" / "a").mkdir(parents=True)
    (folder / "designs" / "a" / "report.html").write_text("<p>ours</p>", encoding="utf-8")
    os.truncate(_made(folder / "moulds" / "large" / "x.bin", os.urandom(12_000_000)), 12_000_000)
    return folder


def _made(path, content):
    path.parent.mkdir(parents=True)
    path.write_bytes(content)
    return path


@pytest.fixture(scope="module")
def studio(root):
    with raw_studio(root) as found:
        yield found


def test_pages_and_files_are_answered(studio):
    p = studio.path
    for path in ("/", "/design", "/measured", "/alive"):
        assert studio.get(p + path)[0] in (200, 204), path
    status, back = studio.get(f"{p}/files/designs/a/report.html")
    assert status == 303
    place = back.partition(b"location: ")[2].partition(b"\r\n")[0].decode()
    # what a file knows of itself opens this file only
    assert place.startswith("/view/") and studio.path not in place
    status, back = studio.get(place, known=False)
    assert status == 200 and back.endswith(b"<p>ours</p>") and b"security-policy: sandbox" in back
    # a tab of its own gets a page around it, which leads nowhere else
    status, back = studio.get(place, "Sec-Fetch-Dest: document", known=False)
    assert status == 200 and f'<iframe src="{place}"'.encode() in back and b"ours" not in back
    assert b"frame-src 'self'" in back and b"security-policy: sandbox" not in back
    for other in (place.replace("report.html", "x.html"), "/view/0/designs/a/report.html", "/view/", "/view//x"):
        assert studio.get(other, known=False)[0] == 404, other


def view_of(studio, path):
    back = studio.get(f"{studio.path}/files/{path}")[1]
    return back.partition(b"location: ")[2].partition(b"\r\n")[0].decode()


def test_the_address_of_a_file_opens_no_other_file_and_none_that_took_its_place(studio, root):
    folder = root / "designs" / "marks"
    folder.mkdir()
    for name in ("a.html", "b.html"):
        (folder / name).write_text("<p>ours</p>", encoding="utf-8")
    place = view_of(studio, "designs/marks/a.html")
    assert studio.get(place, known=False)[0] == 200
    assert studio.get(place.replace("a.html", "b.html"), known=False)[0] == 404
    (folder / "a.html").unlink()
    os.symlink(root.parent / "secret", folder / "a.html")
    status, back = studio.get(place, known=False)
    assert status == 404 and b"theirs" not in back


def test_what_a_bin_from_elsewhere_says_is_no_html(studio, root):
    folder = root / ".studio" / "bin" / "1-a"
    folder.mkdir(parents=True)
    words = {"path": "measured/<img src=evil>.csv", "time": 1.7e9, "why": "<img src=evil>"}
    (folder / "entry.json").write_text(json.dumps(words), encoding="utf-8")
    status, back = studio.get(f"{studio.path}/")
    # the page holds its pieces of HTML as text that is escaped once more
    assert status == 200 and back.count(b"&amp;lt;img src=evil") == 2 and back.count(b"img src=evil") == 3
    assert back.count(b"&lt;img src=evil") == back.count(b'"aria-label":"Restore measured/&lt;img src=evil') == 1
    shutil.rmtree(folder.parent)


def test_a_page_knows_the_path_that_it_lies_under(studio):
    back = studio.get(f"{studio.path}/design")[1]
    assert f'prefix: "{studio.path}"'.encode() in back and b'src="/_nicegui' not in back
    script = back.partition(b'<script defer src="')[2].partition(b'"')[0].decode()
    assert studio.get(script)[0] == 200


REFUSED = {
    "another name of this machine": ["Host: evil.example"],
    "another port": ["Host: 127.0.0.1:1"],
    "no host": ["Host: "],
    "another site": ["Origin: http://evil.example"],
    "a file that runs apart": ["Origin: null"],
    "from another site": ["Sec-Fetch-Site: cross-site"],
    "from another port": ["Sec-Fetch-Site: same-site"],
    "no cookie": ["Cookie: "],
    "the key as a cookie": ["Cookie: dummydesign-studio=sesame"],
}


@pytest.mark.parametrize("heads", REFUSED.values(), ids=REFUSED)
def test_a_refused_request_gets_403_and_nothing_of_the_project(studio, heads):
    socket_heads = (
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Version: 13",
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
    )
    socket_path = "/_nicegui_ws/socket.io/?transport=websocket"
    for path, more in (("/", ()), ("/zip/designs/a", ()), (socket_path, socket_heads)):
        status, back = studio.get(studio.path + path, *more, *heads)
        assert status == 403 and b"thumb" not in back and b"ours" not in back, path


def test_a_websocket_of_the_studio_itself_is_taken(studio):
    head = (
        f"GET {studio.path}/_nicegui_ws/socket.io/?EIO=4&transport=websocket HTTP/1.1\r\n"
        f"Host: 127.0.0.1:{studio.port}\r\nOrigin: http://127.0.0.1:{studio.port}\r\nCookie: {studio.cookie}\r\n"
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    )
    with socket.create_connection(("127.0.0.1", studio.port), timeout=60) as link:
        link.sendall(head.encode())
        assert link.recv(65536).startswith(b"HTTP/1.1 101")


@pytest.mark.parametrize(
    "sent",
    [
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
        b"GET\r\n\r\n",
        b"GARBAGE / LINE AND MORE\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\nno colon\r\n\r\n",
        b"GET /\x00 HTTP/1.1\r\nHost: a\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\nConnection: close\r\n\r\n",
        b"\r\n" * 200 + b"x\r\n\r\n",
    ],
)
def test_garbage_is_refused_and_the_next_request_is_answered(studio, sent):
    assert studio.answer(sent)[0] in (0, 400, 403)
    assert studio.get(f"{studio.path}/alive")[0] == 204


def test_two_hosts_are_no_host(studio):
    head = f"GET {studio.path}/ HTTP/1.1\r\nHost: evil.example\r\nHost: 127.0.0.1:{studio.port}\r\n"
    assert studio.answer(f"{head}Cookie: {studio.cookie}\r\nConnection: close\r\n\r\n".encode())[0] in (400, 403)


def upload_place(studio):
    """Where the page of measured files sends them, with the path in front."""
    page = studio.get(f"{studio.path}/measured")[1]
    return studio.path + re.search(rb"/_nicegui/client/[-\w]+/upload/\d+", page)[0].decode()


@pytest.mark.parametrize("length", [str(10 * LARGEST_BYTES), "9" * 18, "9" * 30])
def test_a_body_that_says_it_is_too_large_is_refused(studio, length):
    assert studio.get(upload_place(studio), f"Content-Length: {length}", method="POST")[0] in (400, 413)


@pytest.mark.parametrize("parts", [1, 30])
def test_a_body_without_a_length_is_refused(studio, root, parts):
    start = b'--cut\r\nContent-Disposition: form-data; name="file"; filename="a.csv"\r\n\r\n'
    pieces = [start, *[b"x" * 20_000] * parts, b"\r\n--cut--\r\n"]
    body = b"".join(f"{len(piece):x}\r\n".encode() + piece + b"\r\n" for piece in pieces) + b"0\r\n\r\n"
    heads = ("Transfer-Encoding: chunked", "Content-Type: multipart/form-data; boundary=cut")
    assert studio.get(upload_place(studio), *heads, method="POST", body=body)[0] == 411
    assert studio.get(f"{studio.path}/alive")[0] == 204
    assert not (root / "measured" / "a.csv").exists()


def test_a_body_longer_than_it_says_is_cut_at_its_length(studio, root):
    heads = ("Content-Length: 4", "Content-Type: multipart/form-data; boundary=cut")
    assert 400 <= studio.get(upload_place(studio), *heads, method="POST", body=b"x" * 200_000)[0] < 500
    assert studio.get(f"{studio.path}/alive")[0] == 204
    assert not (root / "measured" / "a.csv").exists()


SOLID = "/solid/pad?shape=slab&thickness="
BAD = [
    "/files/%00",
    "/zip/%00",
    "/files/" + "a" * 5000,
    "/files/" + "a/" * 2400,
    "/zip/" + "a" * 3000,
    "/files/",
    "/files//",
    "/zip/",
    "/zip//",
    "/zip/.",
    "/zip/x",
    "/files/designs",
    "/files/../secret",
    "/files/%2e%2e/secret",
    "/files/..%2fsecret",
    "/files/..%5csecret",
    "/files/%2fetc/passwd",
    "/files//etc/passwd",
    "/files/.studio/lock",
    "/files/designs/../.studio/lock",
    "/zip/.studio",
    "/zip/%2e%2e",
    "/files/%ff%fe",
    "/files/%c0%ae%c0%ae/secret",
    "/files/%u002e",
    "/files/%",
    "/files/a%0d%0ab",
    "/files/con",
    f"/files/{quote(JAPANESE)}/out.txt",
    f"/files/{quote(JAPANESE)}/loop",
    f"/zip/{quote(JAPANESE)}/loop",
    "/solid/pad",
    "/solid/pad?shape=slab",
    "/solid/pad?thickness=5",
    "/solid/pad?shape=&thickness=5",
    "/solid/pad?shape=crowned:radius=nan,height=2&thickness=9",
    "/solid/pad?shape=crowned:20,2,9,9,9&thickness=9",
    "/solid/pad?shape=crowned:radius=1e308,height=2&thickness=9",
    "/solid/pad?shape=%00&thickness=9",
    *(SOLID + value for value in ("nan", "-5", "0", "inf", "-inf", "1e9", "1e400", "", "%00", "five")),
]


@pytest.mark.parametrize("path", BAD)
def test_what_is_not_there_or_makes_no_sense_is_a_plain_line_of_4xx(studio, path):
    status, back = studio.get(studio.path + path)
    assert 400 <= status < 500 and b"theirs" not in back, back[:300]
    body = back.partition(b"\r\n\r\n")[2]
    assert body and b"Traceback" not in body and len(body) < 3000


@pytest.mark.slow
def test_no_request_breaks_the_server(studio):
    pieces = [
        "",
        "/",
        "//",
        ".",
        "..",
        "%2e%2e",
        "%2f",
        "%5c",
        "\\",
        "%00",
        "%",
        "%zz",
        "%ff",
        "a" * 300,
        "~",
        "*",
        ":",
        "?",
        "#",
        ";",
        "%0d%0a",
        "%e8%a6%aa",
        "%F0%9F%98%80",
        "con",
        "a.toml",
        ".studio",
        "%3F",
        "+",
    ]
    heads = [
        "/files/",
        "/zip/",
        "/solid/mould/",
        "/solid/",
        "/view/",
        "/view/0/",
        "/_nicegui/",
        "/_nicegui/3/static/",
        "/_nicegui/client/",
        "/_nicegui_ws/socket.io/",
        "/",
        "/design?which=",
        "/mould?which=",
        "/campaign?which=",
        "/learn?which=",
        "/tissue?which=",
        "/measured?which=",
        "/solid/pad?shape=",
    ]
    broken = []
    for head in heads:
        for piece in pieces:
            for method in ("GET", "POST") if piece in ("", "%00") else ("GET",):
                status, _ = studio.get(studio.path + head + piece, "Content-Length: 0", method=method)
                if not 200 <= status < 500:
                    broken.append((method, head + piece, status))
    odd = ("Range: bytes=a-b", "Range: bytes=9-1", "If-Modified-Since: x", "X-Forwarded-Prefix: //evil", "Accept: ,")
    for head in odd:
        for path in ("/", "/files/designs/a/report.html", "/zip/designs/a"):
            status, _ = studio.get(studio.path + path, head)
            if not 200 <= status < 500:
                broken.append((head, path, status))
    assert broken == []


def test_a_folder_of_any_name_is_packed_without_what_lies_outside(studio, root):
    status, back = studio.get(f"{studio.path}/zip/{quote(JAPANESE)}")
    assert status == 200 and f"filename*=UTF-8''{quote(JAPANESE.partition('/')[2] + '.zip')}".encode() in back
    with zipfile.ZipFile(io.BytesIO(back.partition(b"\r\n\r\n")[2])) as archive:
        assert archive.namelist() == [f"{JAPANESE.partition('/')[2]}/指.txt"]
    assert left(root) == []


def test_a_client_that_goes_away_leaves_no_archive(studio, root):
    host = f"Host: 127.0.0.1:{studio.port}"
    lines = (f"GET {studio.path}/zip/moulds/large HTTP/1.1", host, f"Cookie: {studio.cookie}")
    with socket.create_connection(("127.0.0.1", studio.port), timeout=60) as link:
        link.sendall("\r\n".join([*lines, "", ""]).encode())
        assert link.recv(1000).startswith(b"HTTP/1.1 200")
        assert opened(root) > 0
    until(lambda: not opened(root), seconds=30)
    assert opened(root) == 0 and left(root) == []


def left(root):
    return [path.name for path in (root / ".studio").iterdir() if path.name != "page"]


def opened(root):
    """Files without a name that this process holds open in the folder."""
    if not os.path.isdir("/proc/self/fd"):
        pytest.skip("no /proc here")
    found = 0
    for name in os.listdir("/proc/self/fd"):
        try:
            found += os.readlink(f"/proc/self/fd/{name}").startswith(str(root / ".studio"))
        except OSError:
            continue
    return found
