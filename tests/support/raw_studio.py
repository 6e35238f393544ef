"""A studio in this process, and requests to it by plain sockets: what no HTTP client would send."""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.support.studio import welcomed

KEY = "sesame"
LARGEST_BYTES = 300_000


@dataclass(frozen=True)
class RawStudio:
    """A server of a folder."""

    port: int
    path: str
    cookie: str

    def answer(self, sent: bytes, wait_s: float = 60.0) -> tuple[int, bytes]:
        """Send bytes, return status and all that came back; status 0 where the server hangs up without an answer."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait_s) as link:
            try:
                link.sendall(sent)
            except (BrokenPipeError, ConnectionResetError):
                pass
            back = b""
            try:
                while piece := link.recv(65536):
                    back += piece
            except ConnectionResetError:
                pass
        words = back.split(b" ", 2)
        return (int(words[1]) if back.startswith(b"HTTP/1.1 ") else 0), back

    def get(self, path: str, *heads: str, method: str = "GET", body: bytes = b"", known: bool = True):
        """Ask as a page of the studio does; heads of the same name replace its own."""
        own = {"Host": f"127.0.0.1:{self.port}", "Connection": "close"}
        if known:
            own |= {"Cookie": self.cookie}
        for head in heads:
            name, _, value = head.partition(": ")
            own[name] = value
        lines = [f"{method} {path} HTTP/1.1", *(f"{name}: {value}" for name, value in own.items()), "", ""]
        return self.answer("\r\n".join(lines).encode("latin-1") + body)


@contextmanager
def raw_studio(folder: Path) -> Iterator[RawStudio]:
    """Serve a folder; once a process only, since NiceGUI keeps its pages for good."""
    import uvicorn

    os.environ["NICEGUI_STORAGE_PATH"] = str(folder / ".studio" / "page")
    from dummydesign.studio.access import Guard
    from dummydesign.studio.app import make_app

    listening = socket.create_server(("127.0.0.1", 0))
    port = listening.getsockname()[1]
    guard = Guard(make_app(folder), KEY, port, LARGEST_BYTES)
    server = uvicorn.Server(uvicorn.Config(guard, log_level="critical", server_header=False, proxy_headers=False))
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive()
            time.sleep(0.02)
        home, cookie = welcomed(f"http://127.0.0.1:{port}/?key={KEY}")
        yield RawStudio(port, "/" + home.split("/")[3], cookie)
    finally:
        server.should_exit = True
        thread.join(60)
        listening.close()
