"""Files that come in and go out: plain names only, inside the project folder only."""

from __future__ import annotations

import os
import re
import tempfile
import zipfile
from pathlib import Path
from typing import IO

from dummydesign.core.errors import InputError

_RESERVED = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?")
MEANINGFUL = frozenset({"project.toml", "campaign.toml", "manifest.json", "calibration.json", "study.json"})
"""A folder with one of these is taken for a project, a campaign or a result."""


def plain_name(name: str) -> str:
    """Check the name of a file that was sent; return it.

    Raises
    ------
    InputError
        For a name with a folder in it, a hidden one, one that no file may have, or one with a meaning of its own.
    """
    if name.casefold() in MEANINGFUL:
        raise InputError(f"file name '{name}' is not taken: commands read a file of this name; rename the file")
    if not name or name != Path(name).name or "\\" in name or ":" in name or name in (".", ".."):
        raise InputError(f"file name '{name}' is not taken: it must be a plain name, without folders")
    if name.startswith(".") or not name.isprintable() or len(name.encode()) > 200 or _RESERVED.fullmatch(name):
        raise InputError(f"file name '{name}' is not taken: rename the file")
    return name


def inside(root: Path, path: str) -> Path:
    """A path of the project, from its folder on.

    Parameters
    ----------
    root : Path
        The project folder.
    path : str
        Such as ``designs/a/report.html``.

    Raises
    ------
    InputError
        When it leads out of the folder, also by a link, or to something hidden, or is no path at all.
    """
    try:
        home = root.resolve()
        found = (home / path).resolve()
        found.exists()
        parts = [*path.split("/"), *found.relative_to(home).parts]
    except (OSError, ValueError, RuntimeError):
        # too long, a zero byte, a link to itself, or outside
        parts = ["."]
    if any(part.startswith(".") for part in parts):
        raise InputError(f"'{path[:200]}' is not a file of this project")
    return found


def keep(folder: Path, name: str, content: bytes) -> Path:
    """Write a file that was sent; one of the same name and content stays, one of another content gets a number.

    Parameters
    ----------
    folder : Path
        Inside the project.
    name : str
        As sent.
    content : bytes
        The whole file.

    Raises
    ------
    InputError
        For a name that is not plain, or a folder (or disk) that cannot be written.
    """
    from dummydesign.core.files import write_bytes

    stem, ending = os.path.splitext(plain_name(name))
    target, number = folder / name, 1
    try:
        folder.mkdir(parents=True, exist_ok=True)
        while target.exists() and not (target.is_file() and target.read_bytes() == content):
            number += 1
            target = folder / f"{stem}-{number}{ending}"
    except OSError as problem:
        raise InputError(f"folder '{folder.name}' cannot be used: {problem.strerror or problem}") from None
    return target if target.exists() else write_bytes(target, content)


def listed(root: Path, folder: Path) -> list[str]:
    """Files under a folder, from the project folder on; hidden ones and links that lead out are left out."""
    found = []
    for place, folders, names in os.walk(folder):
        folders[:] = [name for name in folders if not name.startswith(".")]
        for name in names:
            path = (Path(place) / name).relative_to(root).as_posix()
            try:
                if inside(root, path).is_file():
                    found.append(path)
            except InputError:
                continue
    return sorted(found)


def zipped(root: Path, folder: Path) -> IO[bytes]:
    """All files of a folder as a ZIP archive, whole and at its start; gone from the disk when it is closed.

    Parameters
    ----------
    root, folder : Path
        The project folder and one inside it.

    Raises
    ------
    InputError
        When there is no room to pack them; nothing is left then.
    """
    home = root / ".studio"
    try:
        home.mkdir(exist_ok=True)
        # without a name: nothing is left even when the server is killed
        packed = tempfile.TemporaryFile(dir=home)
        try:
            with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, strict_timestamps=False) as archive:
                for name in listed(root, folder):
                    inner = (root / name).relative_to(folder.parent).as_posix()
                    archive.write(root / name, inner.encode("utf-8", "replace").decode("utf-8"))
            packed.seek(0)
        except BaseException:
            packed.close()
            raise
    except OSError as problem:
        raise InputError(f"the archive of '{folder.name}' cannot be packed: {problem.strerror or problem}") from None
    return packed
