"""Files that come in and go out: plain names only, inside the project folder only."""

from __future__ import annotations

import os
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path
from secrets import token_hex

from dummydesign.core.errors import InputError

_RESERVED = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?")


def plain_name(name: str) -> str:
    """Check the name of a file that was sent; return it.

    Raises
    ------
    InputError
        For a name with a folder in it, a hidden one, or one that no file may have.
    """
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
        When it leads out of the folder, also by a link, or to something hidden.
    """
    parts = path.split("/")
    found = (root / path).resolve()
    if any(part.startswith(".") for part in parts) or not found.is_relative_to(root.resolve()):
        raise InputError(f"'{path}' is not a file of this project")
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
    while target.exists() and target.read_bytes() != content:
        number += 1
        target = folder / f"{stem}-{number}{ending}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise InputError(f"folder '{folder.name}' cannot be made: {problem.strerror or problem}") from None
    return target if target.exists() else write_bytes(target, content)


def listed(root: Path, folder: Path) -> list[str]:
    """Files under a folder, from the project folder on, hidden ones left out."""
    found = (path.relative_to(root) for path in folder.rglob("*") if path.is_file())
    return sorted(path.as_posix() for path in found if not any(part.startswith(".") for part in path.parts))


def zipped(root: Path, folder: Path) -> Iterator[bytes]:
    """All files of a folder as a ZIP archive, in pieces; packed before the first is given out.

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
    packed = home / f"zip-{token_hex(6)}"
    try:
        home.mkdir(exist_ok=True)
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for name in listed(root, folder):
                archive.write(root / name, (root / name).relative_to(folder.parent).as_posix())
    except OSError as problem:
        packed.unlink(missing_ok=True)
        raise InputError(f"the archive of '{folder.name}' cannot be packed: {problem.strerror or problem}") from None
    return _pieces(packed)


def _pieces(packed: Path) -> Iterator[bytes]:
    """A file in pieces, deleted when all are out or nobody wants them any more."""
    try:
        with open(packed, "rb") as stream:
            while piece := stream.read(1 << 20):
                yield piece
    finally:
        packed.unlink(missing_ok=True)
