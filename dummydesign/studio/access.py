"""The door of the studio: only this machine, only with the key, nothing too large, nothing from outside."""

from __future__ import annotations

import hmac
from collections.abc import Callable
from html import escape
from secrets import token_urlsafe
from urllib.parse import quote, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import HTTPConnection
from starlette.responses import HTMLResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

LARGEST_BYTES = 64 * 1024 * 1024
"""A file that is sent: an hour at 1 kHz has some 100 MB as text only with many columns."""
COOKIE = "dummydesign-studio"
ROOM_BYTES = 64 * 1024
"""What the form around a file may take."""
VIEW = "/view/"
"""Addresses of single files, each with a mark of its own; outside the path that the cookie goes to."""
FILE_POLICY = (
    "sandbox allow-scripts allow-modals allow-downloads; default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; img-src data: blob:; font-src data:; media-src data: blob:; form-action 'none'; "
    "base-uri 'none'; frame-ancestors 'self'"
)
"""What a file of the project may do: run by itself, and reach neither the studio nor any other server."""
PDF_POLICY = "default-src 'none'; object-src 'self'; style-src 'unsafe-inline'; frame-ancestors 'self'"
"""The same for a PDF, which browsers do not show in a sandbox."""
FRAME_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; frame-src 'self'; frame-ancestors 'none'; "
    "base-uri 'none'; form-action 'none'"
)
"""Of the page around a file in a tab of its own: a frame cannot lead to another server, a tab could."""
LONGEST_PATH = 4000
UNKEPT = {"cache-control": "no-store"}
NO_KEY = (
    "<!doctype html><html lang=en><meta charset=utf-8><title>dummydesign studio</title>"
    "<body style='font:16px system-ui;margin:3rem;max-width:40rem'><h1>This address needs its key</h1>"
    "<p>Open the whole address that "
    "<code>dummydesign studio</code> printed on the terminal, with what follows <code>?key=</code>.</p></body></html>"
)


class Guard:
    """Wraps a server (ASGI): checks host, origin, key and size of every request before it goes on.

    The key comes once in the address. What follows lies under a path, and needs a cookie, that this server makes up at
    its start: a cookie goes to every server of this machine, whatever its port, but only with its path.
    """

    def __init__(
        self,
        app: ASGIApp,
        key: str,
        port: int,
        largest_bytes: int = LARGEST_BYTES,
        once: Callable[[str], bool] = lambda key: False,
    ) -> None:
        self._app, self._key, self._allowed, self._once = app, key, largest_bytes + ROOM_BYTES, once
        self._path, self._session = f"/{token_urlsafe(16)}", token_urlsafe(24)
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._too_large = _refusal(413, f"larger than {largest_bytes // 2**20} MB: not allowed")
        sockets = " ".join(f"ws://{host}" for host in sorted(self._hosts))
        self._policy = (
            "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
            f"img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' {sockets}; frame-src 'self'; "
            "form-action 'self'; base-uri 'self'; frame-ancestors 'self'; object-src 'none'"
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or answer it here."""
        kind = scope["type"]
        if kind not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        apart = kind == "http" and scope["path"].startswith(VIEW)
        answer = self._answer(HTTPConnection(scope), apart)
        if not apart:
            scope = {**scope, "root_path": self._path}
        if kind == "http":
            of_project = scope["path"].removeprefix(self._path).startswith((VIEW, "/files/", "/solid/"))
            policy = FILE_POLICY if of_project else self._policy
            await (answer or self._app)(scope, receive, send if answer else _with_policy(send, policy))
        elif answer is None:
            await self._app(scope, receive, send)
        else:
            await send({"type": "websocket.close", "code": 4403})

    def _answer(self, asked: HTTPConnection, apart: bool) -> Response | None:
        """What to answer here: a refusal, or the welcome to the key; None for what may go on."""
        heads, path = asked.headers, asked.scope["path"]
        host, method = heads.get("host", ""), asked.scope.get("method", "")
        if host not in self._hosts or len(heads.getlist("host")) > 1:
            return _refusal(403, "only for pages of this machine")
        if any(origin != f"http://{host}" for origin in heads.getlist("origin")):
            return _refusal(403, "only for pages of the studio itself")
        key = next((value for name, value in asked.query_params.multi_items() if name == "key"), "")
        welcome = method in ("GET", "HEAD") and (same_secret(key, self._key) or (method == "GET" and self._once(key)))
        away = heads.get("sec-fetch-site", "none") not in ("none", "same-origin")
        a_tab = heads.get("sec-fetch-mode") == "navigate" and heads.get("sec-fetch-dest") == "document"
        if away and not (welcome and a_tab):
            return HTMLResponse(NO_KEY, 403, UNKEPT)
        if len(path) > LONGEST_PATH or "\\" in path or any(ord(one) < 32 for one in path):
            return _refusal(404, "no such address")
        if welcome:
            given = [(name, value) for name, value in asked.query_params.multi_items() if name != "key"]
            return self._welcome(path, urlencode(given), away)
        if not apart and not (path.startswith(f"{self._path}/") and self._knows(heads)):
            return HTMLResponse(NO_KEY, 403, UNKEPT)
        if "transfer-encoding" in heads:
            return _refusal(411, "a body must say its length")  # the server counts it; browsers always say it
        length = heads.get("content-length", "0")
        digits = length.isascii() and length.isdigit() and len(length) < 20
        return None if digits and int(length) <= self._allowed else self._too_large

    def _welcome(self, path: str, query: str, away: bool) -> Response:
        """Keep a secret in a cookie, and take the key out of the address, where others read it over a shoulder."""
        rest = path.removeprefix(self._path).lstrip("/")
        address = f"{self._path}/{quote(rest)}" + (f"?{query}" if query else "")
        cookie = f"{COOKIE}={self._session}; HttpOnly; SameSite=Strict; Path={self._path}/"
        heads = {**UNKEPT, "set-cookie": cookie, "referrer-policy": "no-referrer"}
        if not away:
            return RedirectResponse(address, 303, heads)
        # a browser keeps the cookie back on a way that began on another site: the page goes on by itself
        return HTMLResponse(f'<!doctype html><meta http-equiv="refresh" content="0;url={escape(address)}">', 200, heads)

    def _knows(self, heads: Headers) -> bool:
        """Whether a request brings the cookie; other servers of this machine may have set one of its name."""
        pairs = (pair.strip().partition("=") for text in heads.getlist("cookie") for pair in text.split(";"))
        return any(name == COOKIE and same_secret(value, self._session) for name, _, value in pairs)


def _refusal(status: int, text: str) -> Response:
    return PlainTextResponse(text, status, UNKEPT)


def same_secret(given: str, right: str) -> bool:
    """Whether a secret is the right one; how long it takes tells nothing of it."""
    return hmac.compare_digest(given.encode("utf-8", "replace"), right.encode())


def _with_policy(send: Send, policy: str) -> Send:
    """Say in each answer what its page may ask for."""

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            heads = MutableHeaders(scope=message)
            pdf = policy == FILE_POLICY and heads.get("content-type") == "application/pdf"
            framed = heads.get("content-security-policy") == FRAME_POLICY
            heads["content-security-policy"] = FRAME_POLICY if framed else PDF_POLICY if pdf else policy
            heads.update(
                {"x-dns-prefetch-control": "off", "x-content-type-options": "nosniff", "referrer-policy": "no-referrer"}
            )
        await send(message)

    return sent
