"""The server's addresses: the pages of the steps, files of the project, archives, solids."""

from __future__ import annotations

import hmac
import logging
import os
from pathlib import Path
from secrets import token_bytes
from typing import IO
from urllib.parse import quote

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import (
    FileResponse,
    HTMLResponse,
    PlainTextResponse,
    RedirectResponse,
    Response,
    StreamingResponse,
)
from nicegui import ui
from starlette.types import Receive, Scope, Send

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import Studio
from dummydesign.studio.pages import campaign, cast, design, learn, measured, mould, overview, pucks, tissue
from dummydesign.studio.server import files
from dummydesign.studio.server.guard import VIEW

PAGES = {
    "/": overview.build, "/measured": measured.build, "/tissue": tissue.build, "/design": design.build,
    "/mould": mould.build, "/cast": cast.build, "/campaign": campaign.build, "/learn": learn.build,
    "/resin": pucks.build,
}  # fmt: skip


def make_app(root: Path) -> FastAPI:
    """The server of a folder; the guard goes around it."""
    logging.getLogger("nicegui").addFilter(_unexpected)
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    root = root.resolve()
    studio = Studio(root)
    secret = token_bytes(32)

    @app.exception_handler(InputError)
    def refused(request: Request, problem: Exception) -> Response:
        return PlainTextResponse(str(problem), 404)

    @app.exception_handler(RequestValidationError)
    def unreadable(request: Request, problem: Exception) -> Response:
        return PlainTextResponse("this address lacks a value, or has one that is no number", 400)

    @app.get("/alive")
    def alive() -> Response:
        return Response(status_code=204)

    @app.get("/files/{path:path}")
    def file(path: str) -> Response:
        _readable(root, path)
        return RedirectResponse(f"{VIEW}{_mark(secret, path)}/{quote(path)}", 303)

    @app.get(VIEW + "{mark}/{path:path}")
    def view(mark: str, path: str) -> Response:
        # without cookie: a file that knows its own address knows no other
        if not hmac.compare_digest(mark.encode(), _mark(secret, path).encode()):
            return PlainTextResponse("open this file from the studio again", 404)
        return FileResponse(_readable(root, path), headers={"cache-control": "no-cache"})

    @app.get("/zip/{path:path}")
    def archive(path: str) -> Response:
        found = files.inside(root, path)
        if found == root or not found.is_dir():
            return PlainTextResponse(f"'{path}' is no folder of this project", 404)
        try:
            return Archive(files.zipped(root, found), found.name)
        except InputError as problem:
            return PlainTextResponse(str(problem), 507)

    @app.get("/solid/pad")
    def pad(shape: str, thickness: float) -> Response:
        from dummydesign.core.errors import out_of_range
        from dummydesign.design.search.slabs import THICKNESS_MM
        from dummydesign.geometry.shapes import Slab, read_shape
        from dummydesign.studio.figures import pad_page

        if not THICKNESS_MM[0] <= thickness <= THICKNESS_MM[1]:
            raise out_of_range("thickness in mm", thickness, *THICKNESS_MM, "pads that can be cast")
        made = Slab() if shape == "slab" else read_shape(shape)
        made.check(thickness)
        return HTMLResponse(pad_page(made, thickness))

    @app.get("/solid/mould/{path:path}")
    def mould_solid(path: str) -> Response:
        from dummydesign.studio.figures import mould_page

        try:
            text = mould_page(files.inside(root, path))
        except (OSError, ValueError) as problem:
            return PlainTextResponse(f"the solids of '{path}' cannot be read: {problem}", 404)
        return HTMLResponse(text) if text else PlainTextResponse("no solids in this folder", 404)

    for page, build in PAGES.items():
        _add(studio, page, build)
    ui.run_with(app, title="dummydesign studio", dark=None, tailwind=False, unocss=None, storage_secret=None,
                reconnect_timeout=30.0, show_welcome_message=False)  # fmt: skip
    return app


def _unexpected(record: logging.LogRecord) -> bool:
    """Whether a failure is for the terminal: what the folder or the disk refused is shown on the page."""
    return not (record.exc_info and isinstance(record.exc_info[1], InputError | OSError))


def _add(studio: Studio, path: str, build) -> None:  # type: ignore[no-untyped-def]
    @ui.page(path)
    def page(request: Request) -> None:
        build(studio, request.query_params)


def _readable(root: Path, path: str) -> Path:
    """A file of the project that can be read now."""
    found = files.inside(root, path)
    if not found.is_file():
        raise InputError(f"'{path}' is not there (any more)")
    try:
        with open(found, "rb"):
            return found
    except OSError as problem:
        raise InputError(f"'{path}' cannot be read: {problem.strerror or problem}") from None


def _mark(secret: bytes, path: str) -> str:
    """What the address of a file holds, so that it opens without the key and opens no other file."""
    return hmac.new(secret, path.encode("utf-8", "surrogateescape"), "sha256").hexdigest()


class Archive(StreamingResponse):
    """An archive as a download; closed when it is out, or when nobody wants it any more."""

    def __init__(self, packed: IO[bytes], name: str) -> None:
        size = packed.seek(0, os.SEEK_END)
        packed.seek(0)
        head = {"content-disposition": f"attachment; filename*=UTF-8''{quote(name + '.zip', safe='')}"}
        super().__init__(iter(lambda: packed.read(1 << 20), b""), media_type="application/zip",
                         headers={**head, "content-length": str(size)})  # fmt: skip
        self._packed = packed

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._packed.close()
