"""The door of the studio: only this machine, only with the key, nothing too large, nothing from outside."""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping
from html import escape
from secrets import token_urlsafe
from typing import Any
from urllib.parse import parse_qs, quote, urlencode

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
LARGEST_BYTES = 64 * 1024 * 1024
"""A file that is sent: an hour at 1 kHz has some 100 MB as text only with many columns."""
COOKIE = "dummydesign-studio"
HTML = "text/html; charset=utf-8"
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
LONGEST_PATH = 4000
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
        self, app: Any, key: str, port: int, largest_bytes: int = LARGEST_BYTES,
        once: Callable[[str], bool] = lambda key: False,
    ) -> None:  # fmt: skip
        self._app, self._key, self._largest, self._once = app, key, largest_bytes, once
        self._path, self._session = f"/{token_urlsafe(16)}", token_urlsafe(24)
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        sockets = " ".join(f"ws://{host}" for host in sorted(self._hosts))
        self._policy = (
            "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
            f"img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' {sockets}; frame-src 'self'; "
            "form-action 'self'; base-uri 'self'; frame-ancestors 'self'; object-src 'none'"
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or answer it here."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        heads = [(name.decode("latin-1").lower(), value.decode("latin-1")) for name, value in scope["headers"]]
        head, path = dict(heads), scope["path"]
        host = head.get("host", "")
        if host not in self._hosts or [name for name, _ in heads].count("host") > 1:
            await _refuse(scope, send, 403, "only for pages of this machine")
            return
        if head.get("origin") not in (None, f"http://{host}"):
            await _refuse(scope, send, 403, "only for pages of the studio itself")
            return
        given = parse_qs(scope.get("query_string", b"").decode("latin-1"), keep_blank_values=True)
        key = given.pop("key", [""])[0]
        welcome = scope["type"] == "http" and scope.get("method", "GET") in ("GET", "HEAD")
        welcome = welcome and (_same(key, self._key) or (scope.get("method") != "HEAD" and self._once(key)))
        away = head.get("sec-fetch-site", "none") not in ("none", "same-origin")
        if away and not (welcome and _opens_a_tab(head)):
            await _refuse(scope, send, 403, NO_KEY, HTML)
            return
        if len(path) > LONGEST_PATH or "\\" in path or any(ord(one) < 32 for one in path):
            await _refuse(scope, send, 404, "no such address")
            return
        if welcome:
            await self._welcome(send, path, urlencode(given, doseq=True), away)
            return
        if not (scope["type"] == "http" and path.startswith(VIEW)):
            if not path.startswith(f"{self._path}/") or not _same(_from_cookies(heads), self._session):
                await _refuse(scope, send, 403, NO_KEY, HTML)
                return
            scope = {**scope, "root_path": self._path}
            path = path.removeprefix(self._path)
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        allowed = self._largest + ROOM_BYTES
        length = head.get("content-length", "0")
        large = f"larger than {self._largest // 2**20} MB: not taken"
        if not (length.isascii() and length.isdigit() and len(length) < 20) or int(length) > allowed:
            await _refuse(scope, send, 413, large)
            return
        policy = FILE_POLICY if path.startswith((VIEW, "/files/", "/solid/")) else self._policy
        await _Counted(allowed, large).run(self._app, scope, receive, _with_policy(send, policy))

    async def _welcome(self, send: Send, path: str, query: str, away: bool) -> None:
        """Keep a secret in a cookie, and take the key out of the address, where others read it over a shoulder."""
        rest = path.removeprefix(self._path).lstrip("/")
        address = f"{self._path}/{quote(rest)}" + (f"?{query}" if query else "")
        cookie = f"{COOKIE}={self._session}; HttpOnly; SameSite=Strict; Path={self._path}/"
        heads = [(b"set-cookie", cookie.encode()), (b"cache-control", b"no-store")]
        heads += [(b"referrer-policy", b"no-referrer")]
        body = b""
        if away:
            # a browser keeps the cookie back on a way that began on another site: the page goes on by itself
            heads.append((b"content-type", HTML.encode()))
            body = f'<!doctype html><meta http-equiv="refresh" content="0;url={escape(address)}">'.encode()
        else:
            heads.append((b"location", address.encode()))
        await send({"type": "http.response.start", "status": 200 if away else 303, "headers": heads})
        await send({"type": "http.response.body", "body": body})


def _same(given: str, right: str) -> bool:
    return hmac.compare_digest(given.encode("utf-8", "replace"), right.encode())


def _opens_a_tab(head: Mapping[str, str]) -> bool:
    return head.get("sec-fetch-mode") == "navigate" and head.get("sec-fetch-dest") == "document"


def _from_cookies(heads: Iterable[tuple[str, str]]) -> str:
    for name, text in heads:
        for part in text.split(";") if name == "cookie" else ():
            if part.strip().startswith(f"{COOKIE}="):
                return part.strip().partition("=")[2]
    return ""


async def _refuse(scope: Scope, send: Send, status: int, text: str, kind: str = "text/plain; charset=utf-8") -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 4403})
        return
    heads = [(b"content-type", kind.encode()), (b"cache-control", b"no-store")]
    await send({"type": "http.response.start", "status": status, "headers": heads})
    await send({"type": "http.response.body", "body": text.encode()})


class _Counted:
    """Cuts off a body that claims no length and grows too large; the answer is 413, whatever the server makes of it."""

    def __init__(self, allowed: int, text: str) -> None:
        self._allowed, self._text, self._seen, self._answered = allowed, text, 0, False

    async def run(self, app: Any, scope: Scope, receive: Receive, send: Send) -> None:
        async def counted() -> MutableMapping[str, Any]:
            message = await receive()
            self._seen += len(message.get("body", b""))
            return {"type": "http.disconnect"} if self._over else message

        async def sent(message: MutableMapping[str, Any]) -> None:
            if self._over and not self._answered:
                return
            self._answered = True
            await send(message)

        try:
            await app(scope, counted, sent)
        except Exception:
            if not self._over:
                raise
        if self._over and not self._answered:
            await _refuse(scope, send, 413, self._text)

    @property
    def _over(self) -> bool:
        return self._seen > self._allowed


def _with_policy(send: Send, policy: str) -> Send:
    """Say in each answer what its page may ask for."""

    async def sent(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            heads = list(message.get("headers", []))
            pdf = policy == FILE_POLICY and (b"content-type", b"application/pdf") in heads
            heads += [(b"content-security-policy", (PDF_POLICY if pdf else policy).encode())]
            heads += [(b"x-dns-prefetch-control", b"off")]
            heads += [(b"x-content-type-options", b"nosniff"), (b"referrer-policy", b"no-referrer")]
            message = {**message, "headers": heads}
        await send(message)

    return sent
