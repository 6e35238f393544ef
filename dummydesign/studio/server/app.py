"""The server's addresses: the pages of the steps, files of the project, archives, solids."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI, Request
from fastapi.responses import FileResponse, HTMLResponse, PlainTextResponse, Response, StreamingResponse
from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio.frame import Studio
from dummydesign.studio.pages import campaign, cast, design, learn, measured, mould, overview, pucks, tissue
from dummydesign.studio.server import files

PAGES = {
    "/": overview.build, "/measured": measured.build, "/tissue": tissue.build, "/design": design.build,
    "/mould": mould.build, "/cast": cast.build, "/campaign": campaign.build, "/learn": learn.build,
    "/resin": pucks.build,
}  # fmt: skip


def make_app(root: Path) -> FastAPI:
    """The server of a folder; the guard goes around it."""
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)
    studio = Studio(root)

    @app.get("/files/{path:path}")
    def file(path: str) -> Response:
        try:
            found = files.inside(root, path)
        except InputError as problem:
            return PlainTextResponse(str(problem), 404)
        if not found.is_file():
            return PlainTextResponse(f"'{path}' is not there (any more)", 404)
        return FileResponse(found, headers={"cache-control": "no-cache"})

    @app.get("/zip/{path:path}")
    def archive(path: str) -> Response:
        try:
            found = files.inside(root, path)
        except InputError as problem:
            return PlainTextResponse(str(problem), 404)
        if not path.strip("/") or not found.is_dir():
            return PlainTextResponse(f"'{path}' is no folder of this project", 404)
        head = {"content-disposition": f'attachment; filename="{found.name}.zip"'}
        try:
            return StreamingResponse(files.zipped(root, found), media_type="application/zip", headers=head)
        except InputError as problem:
            return PlainTextResponse(str(problem), 507)

    @app.get("/solid/pad")
    def pad(shape: str, thickness: float) -> Response:
        from dummydesign.geometry.shapes import Slab, read_shape
        from dummydesign.studio.figures import pad_page

        try:
            made = Slab() if shape == "slab" else read_shape(shape)
            made.check(thickness)
            return HTMLResponse(pad_page(made, thickness))
        except InputError as problem:
            return PlainTextResponse(str(problem), 404)

    @app.get("/solid/mould/{path:path}")
    def mould_solid(path: str) -> Response:
        from dummydesign.studio.figures import mould_page

        try:
            text = mould_page(files.inside(root, path))
        except InputError as problem:
            return PlainTextResponse(str(problem), 404)
        return HTMLResponse(text) if text else PlainTextResponse("no solids in this folder", 404)

    for path, build in PAGES.items():
        _add(studio, path, build)
    ui.run_with(app, title="dummydesign studio", dark=None, tailwind=False, unocss=None, storage_secret=None,
                reconnect_timeout=30.0, show_welcome_message=False)  # fmt: skip
    return app


def _add(studio: Studio, path: str, build) -> None:  # type: ignore[no-untyped-def]
    @ui.page(path)
    def page(request: Request) -> None:
        build(studio, request.query_params)
