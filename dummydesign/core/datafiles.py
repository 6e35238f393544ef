"""Where the named data files live: the built-in library and the user's own folder, which wins."""

from __future__ import annotations

import json
import os
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name


@dataclass(frozen=True)
class Entry:
    """A named data file and where it comes from: ``built-in`` or ``user``."""

    name: str
    path: Path
    origin: str


def data_folder() -> Path:
    """Return the folder that holds ``materials/`` and ``molds/``: inside the wheel, or the repository root."""
    package = Path(__file__).parents[1]
    inside = package / "_data"
    return inside if inside.is_dir() else package.parent


def user_folder() -> Path:
    """Return the folder of the user's own tissues, resins and presets (``DUMMYDESIGN_HOME`` or the platform's)."""
    named = os.environ.get("DUMMYDESIGN_HOME")
    if named:
        return Path(named)
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", str(Path.home()))) / "dummydesign"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "dummydesign"
    return Path(os.environ.get("XDG_DATA_HOME", str(Path.home() / ".local" / "share"))) / "dummydesign"


def entries(kind: str) -> dict[str, Entry]:
    """List the files of one kind (``materials/resins``, ``materials/tissues``, ``molds``) by lower-case name."""
    found: dict[str, Entry] = {}
    for origin, root in (("built-in", data_folder()), ("user", user_folder())):
        for path in sorted((root / kind).glob("*.toml")):
            found[path.stem.lower()] = Entry(path.stem, path, origin)
    return found


def find(kind: str, what: str, name: str) -> Entry:
    """Find a file by name, or take ``name`` as a path when it ends in ``.toml`` or has a folder in it.

    Parameters
    ----------
    kind : str
        Folder, such as ``materials/resins``.
    what : str
        How the thing is called in messages, such as ``resin``.
    name : str
        A known name (any case) or the path of a TOML file.

    Raises
    ------
    InputError
        When neither a known name nor a readable file.
    """
    if name.lower().endswith(".toml") or os.sep in name:
        path = Path(name)
        if not path.is_file():
            raise InputError(f"{what} file '{name}' does not exist")
        return Entry(path.stem, path, "file")
    known = entries(kind)
    if name.lower() not in known:
        raise unknown_name(what, name, [entry.name for entry in known.values()])
    return known[name.lower()]


def read_toml(path: Path) -> tuple[dict[str, Any], str]:
    """Read a TOML file; return its content and its text (for line numbers in messages).

    Raises
    ------
    InputError
        When it cannot be read or is not TOML, with the place tomllib names.
    """
    try:
        text = path.read_text(encoding="utf-8")
        return tomllib.loads(text), text
    except OSError as problem:
        raise InputError(f"{path.name}: cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path.name}: is not UTF-8 text") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{path.name}: not valid TOML: {problem}") from None


def toml_text(text: str) -> str:
    """A text as a basic string of TOML, which is one of JSON but for the code point 127."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def toml_line(text: str) -> str:
    """The same with blanks for all white space."""
    return toml_text(" ".join(text.split()))
