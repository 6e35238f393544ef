"""The server: start, addresses of pages, files, archives and the solid of a pad."""

from __future__ import annotations

import hmac
import logging
import os
import socket
import stat
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import partial
from html import escape
from pathlib import Path
from secrets import token_bytes, token_urlsafe
from typing import Any
from urllib.parse import quote

import uvicorn
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import FileResponse, HTMLResponse, PlainTextResponse, RedirectResponse, StreamingResponse
from nicegui import ui
from starlette.background import BackgroundTask
from starlette.responses import Response

from dummydesign.core.errors import InputError, out_of_range
from dummydesign.core.files import acquire_lock, writing
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.mold.files.solid_view import pad_view
from dummydesign.report.plot import PLOTLY
from dummydesign.studio import file_transfer
from dummydesign.studio.access import FRAME_POLICY, VIEW, Guard, same_secret
from dummydesign.studio.file_actions import undo_bar
from dummydesign.studio.pages import campaign, cast, design, learn, measured, mould, overview, pucks, tissue
from dummydesign.studio.widgets import Body, lay_out

PAGES: dict[str, tuple[str, str, Body]] = {
    "/": ("Overview", "", overview.show_status),
    "/measured": (
        "Measured files",
        "Presses that your test machine wrote: text with columns of time, displacement and force, or a workbook.",
        measured.MeasuredPage,
    ),
    "/tissue": ("Tissue", "What the pad imitates: how deep people give way under a force.", tissue.TissuePage),
    "/design": ("Design", "Find the pad that feels like the tissue, or try one by the sliders.", design.DesignPage),
    "/resin": (
        "Puck",
        "One puck of the batch tells its modulus. Press it slowly between plates, by a third of its height or more.",
        pucks.PuckPage,
    ),
    "/mould": ("Mould", "What to print, what to weigh and how to pour one pad.", mould.MouldPage),
    "/cast": ("Check a cast pad", "Is the pad as designed, and does it feel like the tissue?", cast.show_cast_pad),
    "/campaign": (
        "Campaign",
        "Press cast pads by a plan. Their presses teach the model what it lacks.",
        campaign.show_campaigns,
    ),
    "/learn": (
        "Learn",
        "The model against a pressed campaign: what it lacks, how large that is, and what to measure next.",
        learn.LearnPage,
    ),
}


def make_app(root: Path) -> FastAPI:
    """The server of a folder; the guard goes around it."""
    logging.getLogger("nicegui").addFilter(_unexpected)
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    root, secret = root.resolve(), token_bytes(32)

    @app.exception_handler(InputError)
    def refused(request: Request, problem: InputError) -> Response:
        return PlainTextResponse(str(problem), 507 if problem.code == "file_unwritable" else 404)

    @app.exception_handler(RequestValidationError)
    def malformed(request: Request, problem: RequestValidationError) -> Response:
        return PlainTextResponse("this address lacks a value, or has one that is no number", 400)

    @app.get("/alive")
    def alive() -> Response:
        return Response(status_code=204)

    def mark_of(path: str) -> str:
        """What the address of a file holds, so that it opens without the key and opens no other file."""
        return hmac.new(secret, path.encode("utf-8", "surrogateescape"), "sha256").hexdigest()

    @app.get("/files/{path:path}")
    def file(path: str) -> Response:
        _readable(root, path)
        return RedirectResponse(f"{VIEW}{mark_of(path)}/{quote(path)}", 303)

    @app.get(VIEW + "{mark}/{path:path}")
    def view(request: Request, mark: str, path: str) -> Response:
        # without cookie: a file that knows its own address knows no other
        if not same_secret(mark, mark_of(path)):
            return PlainTextResponse("open this file from the studio again", 404)
        file = _readable(root, path)
        if request.headers.get("sec-fetch-dest") == "document" and file.suffix.lower() in SCRIPTED:
            return _framed(f"{VIEW}{mark}/{quote(path)}", file.name)
        return FileResponse(file, headers={"cache-control": "no-cache", "vary": "sec-fetch-dest"})

    @app.get("/zip/{path:path}")
    def archive(path: str) -> Response:
        folder = file_transfer.inside(root, path)
        if folder == root or not folder.is_dir():
            return PlainTextResponse(f"'{path}' is no folder of this project", 404)
        packed = file_transfer.zipped(root, folder)
        heads = {
            "content-disposition": f"attachment; filename*=UTF-8''{quote(folder.name + '.zip', safe='')}",
            "content-length": str(os.fstat(packed.fileno()).st_size),
        }
        pieces, away = iter(lambda: packed.read(1 << 20), b""), BackgroundTask(packed.close)
        return StreamingResponse(pieces, media_type="application/zip", headers=heads, background=away)

    @app.get("/plotly.gz")
    def plotly() -> Response:
        return FileResponse(PLOTLY, headers={"cache-control": "max-age=86400"})

    @app.get("/solid/pad")
    def pad(shape: str, thickness: float) -> Response:
        if not THICKNESS_MM[0] <= thickness <= THICKNESS_MM[1]:
            raise out_of_range("thickness in mm", thickness, *THICKNESS_MM, "pads that can be cast")
        made = read_shape(shape)
        made.check(thickness)
        return HTMLResponse(pad_view(made, thickness))

    for path in PAGES:
        _add_page(root, path)
    ui.run_with(
        app,
        title="dummydesign studio",
        dark=None,
        tailwind=False,
        unocss=None,
        storage_secret=None,
        reconnect_timeout=120.0,
        show_welcome_message=False,
    )
    return app


def _unexpected(record: logging.LogRecord) -> bool:
    """Whether a failure is for the terminal: what the folder or the disk refused is shown on the page."""
    return not (record.exc_info and isinstance(record.exc_info[1], InputError | OSError))


def _add_page(root: Path, path: str) -> None:
    title, purpose, body = PAGES[path]

    @ui.page(path)
    def page(request: Request) -> None:
        lay_out(root, path, title, purpose, request.query_params, body, overview.make_new if path == "/" else None)
        undo_bar(root)


def _readable(root: Path, path: str) -> Path:
    """A file of the project that can be read now."""
    file = file_transfer.inside(root, path)
    if not file.is_file():
        raise InputError(f"'{path}' is not there (any more)", "file_not_found", "path", path)
    try:
        with open(file, "rb"):
            return file
    except OSError as problem:
        message = f"'{path}' cannot be read: {problem.strerror or problem}"
        raise InputError(message, "file_unreadable", "path", path) from None


SCRIPTED = (".html", ".htm", ".xhtml", ".xht", ".svg", ".xml", ".mht", ".mhtml")
"""Files that can run a script, which could lead a tab of their own to another server."""


def _framed(address: str, name: str) -> Response:
    """A page that shows a file in a frame."""
    text = (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(name)}</title><style>html,body,iframe'
        f'{{margin:0;border:0;width:100%;height:100%;display:block}}</style><iframe src="{escape(address)}" '
        f'title="{escape(name)}"></iframe></html>'
    )
    heads = {"cache-control": "no-cache", "vary": "sec-fetch-dest", "content-security-policy": FRAME_POLICY}
    return HTMLResponse(text, headers=heads)


HOST, FIRST_PORT, TRIED_PORTS = "127.0.0.1", 8420, 20
ONCE = "once"
"""File with the key of a browser that is started: it opens the studio one time."""


def run_studio(folder: str | Path, port: int | None, browser: bool, say: Callable[[str], None]) -> dict[str, Any]:
    """Serve a folder until the process is stopped."""
    root = Path(folder).resolve()
    home = root / ".studio"
    key = token_urlsafe(24)
    with ExitStack() as opened:
        with writing("folder", root, "folder"):
            root.mkdir(parents=True, exist_ok=True)
            _refuse_links(home)
            lock = acquire_lock(home / "lock")
            if lock is None:
                raise _open_elsewhere(root, browser)
            opened.enter_context(lock)
            _clear(home)
            opened.callback(_forget, home)
            listening = opened.enter_context(_listen(port))
            bound = int(listening.getsockname()[1])
            address = f"http://{HOST}:{bound}/"
            _write_privately(home / "address", f"{address}?key={key}")
        os.environ["NICEGUI_STORAGE_PATH"] = str(home / "page")
        say(f"studio of '{root.name}': {address}?key={key}")
        if browser:
            _show(home, address)
        guard = Guard(make_app(root), key, bound, once=partial(_use_once, home))
        config = uvicorn.Config(guard, log_level="warning", server_header=False, proxy_headers=False)
        uvicorn.Server(config).run(sockets=[listening])
    return {"folder": str(root), "address": address}


def _open_elsewhere(root: Path, browser: bool) -> InputError:
    """What to say of a folder that another studio has open; with its address for the user who started that one."""
    try:
        address = (root / ".studio" / "address").read_text(encoding="utf-8")
    except OSError:
        return InputError(f"'{root}' is open in another studio: use that one, or stop it first", "busy", "folder")
    if browser:
        with suppress(OSError):
            _show(root / ".studio", address.partition("?")[0])
    return InputError(f"'{root}' is open in another studio: open {address} or stop that one first", "busy", "folder")


def _show(home: Path, address: str) -> None:
    """Open a browser with a key that opens the studio once: all users of a machine see how programs are started."""
    import webbrowser

    key = token_urlsafe(24)
    (home / ONCE).unlink(missing_ok=True)
    _write_privately(home / ONCE, key)
    webbrowser.open(f"{address}?key={key}")


def _use_once(home: Path, key: str) -> bool:
    """Whether a key is that of a browser that was started; it is used up then."""
    with suppress(OSError):
        right = (home / ONCE).read_text(encoding="utf-8")
        if right and same_secret(key, right):
            (home / ONCE).unlink()
            return True
    return False


def _refuse_links(home: Path) -> None:
    """Refuse links, pipes and devices among the studio's own files, which a folder from elsewhere may bring."""
    if home.is_symlink() or (home.exists() and not home.is_dir()):
        message = f"'{home}' is a link or no folder: remove it; the studio makes its own"
        raise InputError(message, "not_allowed", "folder")
    for folder, folders, names in os.walk(home):
        for name in (*folders, *names):
            path = os.path.join(folder, name)
            with suppress(FileNotFoundError):  # another studio of this folder is at work
                kind = os.lstat(path).st_mode
                if not (stat.S_ISDIR(kind) or stat.S_ISREG(kind)):
                    raise InputError(f"'{path}' is a link or no plain file: remove it", "not_allowed", "file")
        # what was deleted may have links of its own; it is only moved
        folders[:] = [name for name in folders if name != "content"]


def _clear(home: Path) -> None:
    """Keep the folder from others and from Git, and take away the keys that a killed studio left."""
    with suppress(PermissionError):
        # the folder of another user, who let us write in it
        home.chmod(0o700)
    _forget(home)
    (home / ".gitignore").write_text("*\n", encoding="utf-8")


def _forget(home: Path) -> None:
    """Take away the keys of a studio that ended."""
    for name in ("address", ONCE):
        (home / name).unlink(missing_ok=True)


def _write_privately(path: Path, text: str) -> None:
    with open(path, "x", encoding="utf-8", opener=lambda name, flags: os.open(name, flags, 0o600)) as stream:
        stream.write(text)


def _listen(port: int | None) -> socket.socket:
    """A socket of this machine alone, on the requested port or the first free one."""
    if port is not None and not 1 <= port <= 65535:
        message = f"--port {port} is outside the allowed range 1 to 65535"
        raise InputError(message, "out_of_range", "port", port, (1, 65535))
    tried = [port] if port is not None else range(FIRST_PORT, FIRST_PORT + TRIED_PORTS)
    for one in tried:
        try:
            return socket.create_server((HOST, one), backlog=128)
        except PermissionError:
            message = f"port {one} may not be used by you: choose one above 1023"
            raise InputError(message, "not_allowed", "port", one) from None
        except OSError:
            continue
    words = f"port {port} is" if port is not None else f"ports {tried[0]} to {tried[-1]} are"
    raise InputError(f"{words} in use: choose another with --port", "busy", "port", port)
