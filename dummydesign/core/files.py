"""Write files so that a half-written one never has its final name; hold a lock on a file."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from dummydesign.core.errors import InputError

FilePath = str | os.PathLike[str]


def unwritable(what: str, path: str | Path, problem: OSError, quantity: str) -> InputError:
    """Make the error for a file or folder that the system refuses to write."""
    reason = problem.strerror or problem
    return InputError(f"{what} '{path}' cannot be written: {reason}", "file_unwritable", quantity, str(path))


@contextmanager
def writing(what: str, path: str | Path, quantity: str) -> Iterator[None]:
    """Turn what the system refuses while a block writes into the error of :func:`unwritable`."""
    try:
        yield
    except OSError as problem:
        raise unwritable(what, path, problem, quantity) from None


@contextmanager
def reading(what: str, path: str | Path, quantity: str, advice: str = "") -> Iterator[None]:
    """Turn what the system refuses while a block reads a file, and what is no UTF-8 text, into an ``InputError``."""
    code = "file_unreadable"
    try:
        yield
        return
    except FileNotFoundError:
        code, reason = "file_not_found", "does not exist"
    except UnicodeDecodeError:
        reason = f"is not UTF-8 text{advice}"
    except OSError as problem:
        reason = f"cannot be read: {problem.strerror or problem}"
    if Path(path).is_dir():
        reason = "is a folder; give a file in it"
    raise InputError(f"{what} '{path}' {reason}", code, quantity, str(path))


def check_file(what: str, path: Path, quantity: str) -> None:
    """Refuse what is no file that can be read."""
    with reading(what, path, quantity):
        path.open("rb").close()


def output_folder(path: str | Path) -> Path:
    """Make the output folder if needed and try that it can be written, before any work starts."""
    folder = Path(path)
    with writing("output folder", path, "out"):
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / f".try-{os.urandom(8).hex()}"
        probe.touch(exist_ok=False)
        probe.unlink()
    return folder


def read_json(path: Path) -> dict[str, Any]:
    """What a JSON file holds; empty where it cannot be read or holds something else than keys."""
    import json

    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def write_text(path: str | Path, text: str) -> Path:
    """Write ``text`` under a dotted temporary name beside ``path`` and rename it when complete."""
    return write_bytes(path, text.encode("utf-8"))


def csv_text(head: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a table as the text of a CSV file."""
    import csv
    import io

    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows([head, *rows])
    return stream.getvalue()


def write_bytes(path: str | Path, content: bytes) -> Path:
    """Write ``content`` under a dotted temporary name beside ``path`` and rename it when complete."""
    final = Path(path)
    if not final.name or final.is_dir():
        message = f"file '{path}' cannot be written: it is a folder; give the name of a file"
        raise InputError(message, "file_unwritable", "file", str(path))
    # a name of its own for each writer: two that shared one renamed each other's half-written file
    part = final.with_name(f".{final.name[:40]}.{os.urandom(8).hex()}.part")
    try:
        with open(part, "xb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, final)
    except OSError as problem:
        raise unwritable("file", path, problem, "file") from None
    finally:
        with suppress(OSError):
            part.unlink()
    return final


def acquire_lock(path: Path, patience_s: float = 0.0) -> IO[str] | None:
    """Lock a file, made when needed; None when another process holds it. Keep what is returned as long as it counts."""
    path.parent.mkdir(parents=True, exist_ok=True)
    until = time.monotonic() + patience_s
    stream = open(path, "a+", encoding="utf-8")
    while True:
        try:
            _lock(stream)
            return stream
        except OSError:
            if time.monotonic() >= until:
                stream.close()
                return None
        time.sleep(0.01)


def is_locked(path: Path) -> bool:
    """Whether another process holds the lock of a file."""
    if not path.exists():
        return False
    # for reading alone: a folder that cannot be written any more still tells what runs in it
    with open(path, encoding="utf-8") as stream:
        try:
            _lock(stream)
        except OSError:
            return True
    return False


def _lock(stream: IO[str]) -> None:
    if os.name == "nt":
        import msvcrt

        stream.seek(0)
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
        return
    import fcntl

    fcntl.flock(stream.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
