"""Files that come in and go out: plain names inside the project folder only."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from itertools import count
from pathlib import Path
from typing import IO

from dummydesign.core.errors import InputError, accepts
from dummydesign.core.files import writing
from dummydesign.core.user_library import DEVICE
from dummydesign.measurement.trace import read_trace

MEANINGFUL = frozenset({"project.toml", "campaign.toml", "manifest.json", "calibration.json", "study.json"})
"""A folder with one of these is taken for a project, a campaign or a result."""


def plain_name(name: str) -> str:
    """Check the name of a file that was sent; return it."""
    if name.casefold() in MEANINGFUL:
        message = f"file name '{name}' is not allowed: commands read a file of this name; rename the file"
        raise InputError(message, "bad_name", "file_name", name)
    if not name or name != Path(name).name or "\\" in name or ":" in name or name in (".", ".."):
        message = f"file name '{name}' is not allowed: it must be a plain name, without folders"
        raise InputError(message, "bad_name", "file_name", name)
    if name.startswith(".") or not name.isprintable() or len(name.encode()) > 200 or DEVICE.fullmatch(name):
        raise InputError(f"file name '{name}' is not allowed: rename the file", "bad_name", "file_name", name)
    return name


def check_there(root: Path) -> None:
    """Refuse a project folder that was renamed or moved: nothing is written in its old place."""
    if not root.is_dir():
        message = f"the project folder '{root}' was renamed or moved: give it its name back, or start the studio in it"
        raise InputError(message, "file_not_found", "folder", str(root))


def inside(root: Path, path: str) -> Path:
    """A path of the project, from its folder on."""
    check_there(root)
    try:
        home = root.resolve()
        target = (home / path).resolve()
        target.exists()
        parts = [*path.split("/"), *target.relative_to(home).parts]
    except (OSError, ValueError, RuntimeError):
        # too long, a zero byte, a link to itself, or outside
        parts = ["."]
    if any(part.startswith(".") for part in parts):
        raise InputError(f"'{path[:200]}' is not a file of this project", "not_allowed", "path", path[:200])
    return target


def numbered(name: str) -> Iterator[str]:
    """Yield the names ``name``, ``name-2``, ``name-3`` and so on, of which the first free one is taken."""
    yield from (name if number == 1 else f"{name}-{number}" for number in count(1))


def holds(path: Path, content: bytes) -> bool:
    """Whether a file is there with this content."""
    return path.is_file() and path.stat().st_size == len(content) and path.read_bytes() == content


def read_sent(name: str, content: bytes, read: Callable[[Path], object]) -> None:
    """Read a file that was sent, apart from the project."""
    with tempfile.TemporaryDirectory() as away:
        path = Path(away) / name
        path.write_bytes(content)
        try:
            read(path)
        except InputError as problem:
            # the user knows the file by its name
            text = str(problem).replace(str(path), name)
            raise InputError(text, problem.code, problem.quantity, problem.value, problem.allowed) from None


def check_press(name: str, content: bytes, speed_mm_s: object = None) -> None:
    """Refuse a file that was sent when it cannot be read as a press."""
    speed = speed_mm_s if isinstance(speed_mm_s, int | float) and speed_mm_s > 0 else None
    try:
        read_sent(name, content, lambda path: read_trace(path, speed))
    except OSError as problem:
        message = f"{name} cannot be read: {problem.strerror or problem}"
        raise InputError(message, "file_unreadable", "trace", name) from None
    except InputError as problem:
        message = f"{name} is no press: {str(problem).removeprefix(f'{name}: ')}"
        raise InputError(message, problem.code, problem.quantity, problem.value, problem.allowed) from None


def listed(root: Path, folder: Path) -> list[str]:
    """Files under a folder, from the project folder on; hidden ones and links that lead out are left out."""
    paths = (path.relative_to(root).as_posix() for path in folder.rglob("*") if path.is_file())
    return sorted(path for path in paths if accepts(inside, root, path))


def zipped(root: Path, folder: Path) -> IO[bytes]:
    """All files of a folder as a ZIP archive, whole and at its start; gone from the disk when it is closed."""
    home = root / ".studio"
    with writing("archive of", folder.name, "archive"), ExitStack() as opened:
        home.mkdir(exist_ok=True)
        # without a name: nothing is left even when the server is killed
        packed = opened.enter_context(tempfile.TemporaryFile(dir=home))
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, strict_timestamps=False) as archive:
            for name in listed(root, folder):
                archive.write(
                    root / name,
                    (root / name).relative_to(folder.parent).as_posix().encode("utf-8", "replace").decode("utf-8"),
                )
        packed.seek(0)
        opened.pop_all()
    return packed
