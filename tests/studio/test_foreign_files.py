"""Files of the project in Chromium: they run by themselves and reach neither the studio nor any other server."""

from __future__ import annotations

import threading
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from dummydesign.project.folder import make_project
from tests.support.studio import browser, live, running, until

pytestmark = pytest.mark.slow

# every way out that a page has, to a server of this machine (OTHER) and to the studio (STUDIO)
EVIL = """<!doctype html><meta charset="utf-8"><title>evil</title>
<link rel="stylesheet" href="OTHER/style"><link rel="prefetch" href="OTHER/prefetch">
<link rel="icon" href="OTHER/icon">
<link rel="preload" as="image" href="OTHER/preload"><img src="OTHER/image"><script src="OTHER/script"></script>
<iframe src="OTHER/frame"></iframe><object data="OTHER/object"></object><embed src="OTHER/embed">
<video src="OTHER/video"></video><style>@import "OTHER/import"; body {background: url(OTHER/background)}
@font-face {font-family: evil; src: url(OTHER/font)} p {font-family: evil}</style><p>text</p>
<form id="form" method="post" action="OTHER/form"><input name="a" value="b"></form>
<a id="top" target="_top" href="OTHER/top">a</a><a id="tab" target="_blank" href="OTHER/tab" ping="OTHER/ping">b</a>
<svg><image href="OTHER/svg"/></svg>
<script>
const tried = [];
const go = (name, way) => { try { Promise.resolve(way()).then(() => tried.push(name), () => {}); } catch {} };
for (const home of ['OTHER', 'STUDIO', location.href.split('/view/')[0]]) {
  go('fetch', () => fetch(home + '/fetch', {mode: 'no-cors', credentials: 'include'}));
  go('post', () => fetch(home + '/post', {method: 'POST', body: 'x', mode: 'no-cors', credentials: 'include'}));
  go('beacon', () => { navigator.sendBeacon(home + '/beacon', 'x'); return Promise.reject(); });
  go('socket', () => new Promise((yes, no) => { const s = new WebSocket(home.replace('http', 'ws') + '/socket');
    s.onopen = yes; s.onerror = no; }));
  go('events', () => new Promise((yes, no) => { const s = new EventSource(home + '/events');
    s.onopen = yes; s.onerror = no; }));
  go('import', () => import(home + '/module'));
  go('worker', () => new Promise((yes, no) => { const s = new Worker(home + '/worker'); s.onmessage = yes;
    s.onerror = no; setTimeout(no, 1000); }));
  go('popup', () => open(home + '/popup') || Promise.reject());
  go('image', () => new Promise((yes, no) => { const s = new Image(); s.onload = yes; s.onerror = no;
    s.src = home + '/picture'; }));
}
go('cookie', () => document.cookie || Promise.reject());
go('storage', () => localStorage.length);
go('parent', () => parent !== window && parent.document ? 1 : Promise.reject());
setTimeout(() => { document.getElementById('tab').click(); document.getElementById('form').submit();
  if (parent !== window) document.getElementById('top').click(); }, 3000);
setTimeout(() => { document.body.dataset.tried = tried.join(' '); }, 4000);
</script>"""


@contextmanager
def other_server():
    """A server of another program on this machine, and what reaches it: (path, cookie)."""
    reached = []

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            reached.append((self.path, self.headers.get("cookie")))
            self.send_response(200)
            self.send_header("content-type", "text/html")
            self.end_headers()
            self.wfile.write(b"other")

        do_POST = do_HEAD = do_OPTIONS = do_GET

        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_address[1]}", reached
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@contextmanager
def project_with(tmp_path, **pages):
    folder = tmp_path / "thumb"
    make_project(folder, tissue="palm")
    (folder / "designs" / "evil").mkdir(parents=True)
    with running(folder, tmp_path / "home") as studio, other_server() as (other, reached), browser() as page:
        for name, text in pages.items():
            text = text.replace("OTHER", other).replace("STUDIO", studio.home.rstrip("/"))
            (folder / "designs" / "evil" / f"{name}.html").write_text(text, encoding="utf-8")
        page.goto(studio.address)
        page.wait_for_selector("h1")
        yield studio, page, other, reached


def test_the_test_itself_sees_what_reaches_the_other_server(tmp_path):
    with other_server() as (other, reached), browser() as page:
        page.goto(f"{other}/first")
        page.set_content(EVIL.replace("OTHER", other).replace("STUDIO", other))
        wanted = {"/image", "/script", "/frame", "/fetch", "/post", "/socket", "/style", "/events", "/picture"}
        until(lambda: wanted <= {path for path, _ in reached}, page, 60)
    assert wanted <= {path for path, _ in reached}


@pytest.mark.parametrize("framed", [False, True])
def test_a_file_of_the_project_reaches_no_server(tmp_path, framed):
    with project_with(tmp_path, evil=EVIL) as (studio, page, _, reached):
        place = f"{studio.home}files/designs/evil/evil.html"
        if framed:
            with page.expect_event("framenavigated", lambda frame: "/view/" in frame.url):
                page.evaluate(
                    "(place) => { const f = document.createElement('iframe'); f.src = place; f.id = 'evil';"
                    "document.body.append(f); }",
                    place,
                )
        else:
            page.goto(place)
        shown = next(frame for frame in page.frames[1:] if "/view/" in frame.url)
        shown.wait_for_selector("body[data-tried]", timeout=30_000)
        assert shown.evaluate("document.body.dataset.tried") == ""
        assert studio.home.split("/")[3] not in shown.url and "/view/" in shown.url
        page.wait_for_timeout(500)
        assert len(page.context.pages) == 1
    assert reached == []


LEAVING = {
    "refresh": '<meta http-equiv="refresh" content="0;url=OTHER/refresh"><p>a</p>',
    "location": "<p>a</p><script>location = 'OTHER/location?' + encodeURIComponent(location.href)</script>",
}


@pytest.mark.parametrize("way", LEAVING)
def test_a_file_leads_neither_a_page_of_the_studio_nor_its_own_tab_to_another_server(tmp_path, way):
    with project_with(tmp_path, evil=LEAVING[way]) as (studio, page, other, reached):
        place = f"{studio.home}files/designs/evil/evil.html"
        page.evaluate(
            "(place) => { const f = document.createElement('iframe'); f.src = place;document.body.append(f); }", place
        )
        page.wait_for_timeout(3000)
        assert reached == []
        tab = page.context.new_page()
        tab.goto(place)
        tab.wait_for_timeout(3000)
        # the address that the tab shows, opened again by hand
        tab.goto(tab.url)
        tab.wait_for_timeout(3000)
        assert reached == [] and "/view/" in tab.url and len(tab.frames) == 2
        # not even a server that asks for the path that it was told gets a cookie
        secret = studio.home.split("/")[3]
        tab.goto(f"{other}/{secret[:5]}/")
        assert reached and not any(secret in path or cookie for path, cookie in reached)


def test_a_page_of_another_port_gets_nothing_from_the_studio(tmp_path):
    with project_with(tmp_path) as (studio, page, other, reached):
        tab = page.context.new_page()
        tab.goto(other)
        for place in (studio.home, studio.home + "design", studio.home + "zip/designs/evil"):
            asked = "(place) => fetch(place, {credentials: 'include'}).then(() => 'yes', () => 'no')"
            assert tab.evaluate(asked, place) == "no"
            assert (
                tab.evaluate(
                    "(place) => new Promise((done) => { const f = document.createElement('iframe');"
                    "f.src = place; f.onload = () => done(f.contentDocument); document.body.append(f); })",
                    place,
                )
                is None
            )
        socket = studio.home.replace("http", "ws") + "_nicegui_ws/socket.io/?EIO=4&transport=websocket"
        assert (
            tab.evaluate(
                "(place) => new Promise((done) => { const s = new WebSocket(place); s.onopen = () =>"
                "done('open'); s.onerror = () => done('refused'); })",
                socket,
            )
            == "refused"
        )
        assert not any(cookie for _, cookie in reached)
        # a link with the key opens it, wherever the link is
        tab.evaluate("(place) => { location = place; }", studio.address)
        tab.wait_for_url(f"{studio.home}**")
        tab.wait_for_selector("nav")


def test_an_old_tab_says_what_to_do_after_a_restart_and_does_not_load_itself_forever(tmp_path):
    folder = tmp_path / "thumb"
    make_project(folder, tissue="palm")
    with browser() as page:
        with running(folder, tmp_path / "home") as studio:
            port = studio.home.split(":")[2].split("/")[0]
            page.goto(studio.address)
            live(page)
            page.evaluate("window.mark = 1")
        with running(folder, tmp_path / "home", "--port", port) as studio:
            page.wait_for_selector('[data-test="restarted"]', timeout=60_000)
            asked = []
            page.on("request", lambda one: asked.append(one.url))
            page.wait_for_timeout(6000)
            assert asked == [] and page.evaluate("window.mark") == 1
            page.goto(studio.address)
            page.wait_for_selector("h1")
            page.wait_for_timeout(4000)
            assert page.locator('[data-test="restarted"]').count() == 0


def test_links_of_every_page_stay_in_the_studio(tmp_path):
    with project_with(tmp_path) as (studio, page, _, _):
        for path in ("", "measured", "tissue", "design", "mould", "campaign", "learn"):
            page.goto(studio.home + path)
            live(page)
            links = page.evaluate("[...document.querySelectorAll('a[href]')].map((link) => link.href)")
            assert len(links) >= 7 and all(link.startswith(studio.home) for link in links), links


def test_a_report_with_scripts_works_as_a_file_of_the_project(tmp_path):
    from dummydesign.report.page import Section
    from dummydesign.report.page import page as lay_out

    drawn = """const c = document.createElement('canvas'), pen = c.getContext('2d');
        c.id = 'c'; document.body.append(c); pen.fillRect(0, 0, 9, 9);
        c.dataset.red = pen.getImageData(1, 1, 1, 1).data[3]"""
    report = lay_out("Report", "lead", [Section("a", "b")], scripts=[drawn])
    solids = "solid/pad?shape=slab&thickness=9"
    with project_with(tmp_path, report=report) as (studio, page, _, _):
        page.set_default_timeout(30_000)
        page.goto(f"{studio.home}files/designs/evil/report.html")
        shown = page.frames[1]
        assert shown.wait_for_selector("#c", state="attached").get_attribute("data-red") == "255"
        assert shown.evaluate("getComputedStyle(document.querySelector('main')).maxWidth") != "none"
        page.goto(studio.home + solids)
        page.wait_for_selector("canvas", state="attached")
        assert page.broken == [] and page.outside == []


def test_a_pdf_opens_in_the_viewer_of_the_browser(tmp_path):
    content = (
        b"%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n2 0 obj<</Type/Pages/Kids[3 0 R]/Count 1>>endobj\n"
        b"3 0 obj<</Type/Page/Parent 2 0 R/MediaBox[0 0 99 99]>>endobj\ntrailer<</Root 1 0 R>>\n%%EOF"
    )
    with project_with(tmp_path) as (studio, page, _, _):
        (tmp_path / "thumb" / "designs" / "evil" / "a.pdf").write_bytes(content)
        page.set_default_timeout(30_000)
        assert page.goto(f"{studio.home}files/designs/evil/a.pdf").status == 200
        assert until(lambda: any(frame.url.startswith("chrome-extension://") for frame in page.frames), page, 30)
