"""Start the studio: one folder, one address on this machine, one key."""

from __future__ import annotations

import hmac
import os
import socket
import stat
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from secrets import token_urlsafe
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.studio.server.guard import Guard
from dummydesign.studio.work.lock import take

HOST, FIRST_PORT, TRIED_PORTS = "127.0.0.1", 8420, 20
ONCE = "once"
"""File with the key of a browser that is started: it opens the studio one time."""


def run_studio(folder: str | Path, port: int | None, browser: bool, say: Callable[[str], None]) -> dict[str, Any]:
    """Serve a folder until the process is stopped.

    Parameters
    ----------
    folder : path
        Made when needed; a project, or one that the page makes it.
    port : int, optional
        By default the first free one from 8420.
    browser : bool
        Open it there.
    say : callable
        Takes the line with the address.

    Raises
    ------
    InputError
        When NiceGUI is missing, the folder is open in another studio or cannot be written, or the port is in use.
    """
    try:
        import nicegui  # noqa: F401
        import uvicorn
    except ImportError as problem:
        raise InputError(f"the studio needs {problem.name}: pip install 'dummydesign[studio]'") from None
    root = Path(folder).resolve()
    home = root / ".studio"
    lock = listening = None
    key = token_urlsafe(24)
    try:
        root.mkdir(parents=True, exist_ok=True)
        _refuse_links(home)
        lock = take(home / "lock")
        if lock is None:
            raise _open_elsewhere(root, browser)
        _clear(home)
        listening = _listen(port)
        found = int(listening.getsockname()[1])
        address = f"http://{HOST}:{found}/"
        _write_privately(home / "address", f"{address}?key={key}")
    except (OSError, InputError) as problem:
        for opened in (listening, lock):
            if opened is not None:
                opened.close()
        if isinstance(problem, InputError):
            raise
        raise InputError(f"'{root}' cannot be written: {problem.strerror or problem}") from None
    os.environ["NICEGUI_STORAGE_PATH"] = str(home / "page")
    from dummydesign.studio.server.app import make_app

    say(f"studio of '{root.name}': {address}?key={key}")
    if browser:
        _show(home, address)
    guard = Guard(make_app(root), key, found, once=_once(home))
    config = uvicorn.Config(guard, log_level="warning", server_header=False, proxy_headers=False)
    try:
        uvicorn.Server(config).run(sockets=[listening])
    finally:
        for name in ("address", ONCE):
            (home / name).unlink(missing_ok=True)
        listening.close()
        lock.close()
    return {"folder": str(root), "address": address}


def _open_elsewhere(root: Path, browser: bool) -> InputError:
    """What to say of a folder that another studio has open; with its address for the user who started that one."""
    try:
        address = (root / ".studio" / "address").read_text(encoding="utf-8")
    except OSError:
        return InputError(f"'{root}' is open in another studio: use that one, or stop it first")
    if browser:
        with suppress(OSError):
            _show(root / ".studio", address.partition("?")[0])
    return InputError(f"'{root}' is open in another studio: open {address} or stop that one first")


def _show(home: Path, address: str) -> None:
    """Open a browser with a key that opens the studio once: all users of a machine see how programs are started."""
    import webbrowser

    key = token_urlsafe(24)
    (home / ONCE).unlink(missing_ok=True)
    _write_privately(home / ONCE, key)
    webbrowser.open(f"{address}?key={key}")


def _once(home: Path) -> Callable[[str], bool]:
    """Whether a key is that of a browser that was started; it is used up then."""

    def take_once(key: str) -> bool:
        try:
            right = (home / ONCE).read_text(encoding="utf-8")
        except OSError:
            return False
        if not right or not hmac.compare_digest(key.encode("utf-8", "replace"), right.encode()):
            return False
        (home / ONCE).unlink(missing_ok=True)
        return True

    return take_once


def _refuse_links(home: Path) -> None:
    """Refuse links, pipes and devices among the studio's own files, which a folder from elsewhere may bring.

    Raises
    ------
    InputError
        Else the studio would write through them into files that are not of the project, or read without end.
    """
    if not (home.exists() or home.is_symlink()):
        return
    if home.is_symlink() or not home.is_dir():
        raise InputError(f"'{home}' is a link or no folder: remove it; the studio makes its own")
    for place, folders, names in os.walk(home):
        for name in (*folders, *names):
            try:
                kind = os.lstat(os.path.join(place, name)).st_mode
            except FileNotFoundError:
                # another studio of this folder is at work
                continue
            if not (stat.S_ISDIR(kind) or stat.S_ISREG(kind)):
                raise InputError(f"'{os.path.join(place, name)}' is a link or no plain file: remove it")
        # what was deleted may have links of its own; it is only moved
        folders[:] = [name for name in folders if name != "content"]


def _clear(home: Path) -> None:
    """Keep the folder from others and from Git, and take away what a killed studio left."""
    with suppress(PermissionError):
        # the folder of another user, who let us write in it
        home.chmod(0o700)
    for name in ("address", ONCE):
        (home / name).unlink(missing_ok=True)
    for left in home.glob("zip-*"):
        left.unlink(missing_ok=True)
    (home / ".gitignore").write_text("*\n", encoding="utf-8")


def _write_privately(path: Path, text: str) -> None:
    with open(path, "x", encoding="utf-8", opener=lambda name, flags: os.open(name, flags, 0o600)) as stream:
        stream.write(text)


def _listen(port: int | None) -> socket.socket:
    """A socket of this machine alone, on the port asked for or the first free one."""
    if port is not None and not 1 <= port <= 65535:
        raise InputError(f"--port {port} is outside the allowed range 1 to 65535")
    tried = [port] if port is not None else list(range(FIRST_PORT, FIRST_PORT + TRIED_PORTS))
    for one in tried:
        found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        if os.name != "nt":
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            found.bind((HOST, one))
            found.listen(128)
            return found
        except PermissionError:
            found.close()
            raise InputError(f"port {one} may not be used by you: choose one above 1023") from None
        except OSError:
            found.close()
    said = f"port {port} is" if port is not None else f"ports {tried[0]} to {tried[-1]} are"
    raise InputError(f"{said} in use: choose another with --port")
