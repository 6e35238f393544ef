"""The door of the studio: only this machine, only with the key, nothing too large, nothing from outside."""

from __future__ import annotations

import hmac
from collections.abc import Awaitable, Callable, MutableMapping
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlencode

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]
LARGEST_BYTES = 64 * 1024 * 1024
"""A file that is sent: an hour at 1 kHz has some 100 MB as text only with many columns."""
ROOM_BYTES = 64 * 1024
"""What the form around a file may take."""
POLICY = (
    "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' ws: ; frame-src 'self'; "
    "form-action 'self'; base-uri 'self'; frame-ancestors 'self'"
)
"""What a page may ask for: nothing but this server."""
NO_KEY = (
    "<!doctype html><html lang=en><meta charset=utf-8><title>dummydesign studio</title>"
    "<body style='font:16px system-ui;margin:3rem;max-width:40rem'><h1>This address needs its key</h1>"
    "<p>Open the whole address that "
    "<code>dummydesign studio</code> printed on the terminal, with what follows <code>?key=</code>.</p></body></html>"
)


class Guard:
    """Wraps a server (ASGI): checks host, key and size of every request before it goes on.

    The key comes once in the address, then in a cookie that no script reads and no other site sends.
    """

    def __init__(self, app: Any, key: str, port: int, largest_bytes: int = LARGEST_BYTES) -> None:
        self._app, self._key, self._cookie = app, key, f"dummydesign-studio-{port}"
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}
        self._largest = largest_bytes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request through, or answer it here."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        head = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        host, origin = head.get("host", ""), head.get("origin")
        if host not in self._hosts or (origin not in (None, "null") and origin != f"http://{host}"):
            await _refuse(scope, send, 403, "only for pages of this machine")
            return
        given = parse_qs(scope.get("query_string", b"").decode("latin-1"))
        if scope["type"] == "http" and self._right(given.get("key", [""])[0]):
            rest = urlencode({name: values for name, values in given.items() if name != "key"}, doseq=True)
            await self._welcome(send, scope["path"] + (f"?{rest}" if rest else ""))
            return
        if not self._right(self._from_cookie(head.get("cookie", ""))):
            await _refuse(scope, send, 403, NO_KEY, "text/html; charset=utf-8")
            return
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        allowed = self._largest + ROOM_BYTES
        length = head.get("content-length", "0")
        if not length.isdigit() or int(length) > allowed:
            await _refuse(scope, send, 413, f"larger than {self._largest // 2**20} MB: not taken")
            return
        await self._app(scope, _counted(receive, allowed), _with_policy(send, scope["path"]))

    def _right(self, key: str) -> bool:
        return hmac.compare_digest(key.encode(), self._key.encode())

    def _from_cookie(self, text: str) -> str:
        try:
            found = SimpleCookie(text).get(self._cookie)
        except CookieError:
            return ""
        return found.value if found else ""

    async def _welcome(self, send: Send, path: str) -> None:
        """Keep the key in a cookie and take it out of the address, where others read it over a shoulder."""
        cookie = f"{self._cookie}={self._key}; HttpOnly; SameSite=Strict; Path=/"
        heads = [(b"location", path.encode("latin-1", "ignore")), (b"set-cookie", cookie.encode())]
        heads += [(b"referrer-policy", b"no-referrer"), (b"cache-control", b"no-store")]
        await send({"type": "http.response.start", "status": 303, "headers": heads})
        await send({"type": "http.response.body", "body": b""})


async def _refuse(scope: Scope, send: Send, status: int, text: str, kind: str = "text/plain; charset=utf-8") -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 4403})
        return
    heads = [(b"content-type", kind.encode()), (b"cache-control", b"no-store")]
    await send({"type": "http.response.start", "status": status, "headers": heads})
    await send({"type": "http.response.body", "body": text.encode()})


def _counted(receive: Receive, allowed: int) -> Receive:
    """A body that claims no length is cut off when it grows too large."""
    seen = 0

    async def counted() -> MutableMapping[str, Any]:
        nonlocal seen
        message = await receive()
        seen += len(message.get("body", b""))
        if seen > allowed:
            return {"type": "http.disconnect"}
        return message

    return counted


def _with_policy(send: Send, path: str) -> Send:
    """Files of the project are shown apart: their scripts cannot reach the studio."""
    policy = "sandbox allow-scripts allow-popups allow-modals allow-downloads" if path.startswith("/files/") else POLICY

    async def sent(message: MutableMapping[str, Any]) -> None:
        if message["type"] == "http.response.start":
            heads = [*message.get("headers", []), (b"content-security-policy", policy.encode())]
            heads += [(b"x-content-type-options", b"nosniff"), (b"referrer-policy", b"no-referrer")]
            message = {**message, "headers": heads}
        await send(message)

    return sent
