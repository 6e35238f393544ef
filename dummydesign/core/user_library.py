"""Named data files: the built-in library, shipped tables, and the user's own folder, which wins."""

from __future__ import annotations

import json
import os
import re
import sys
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, TypeVar

from dummydesign.core.errors import InputError, NoAnswerError, quantity_name, unknown_name
from dummydesign.core.files import check_file, reading, write_bytes


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
    return Path(os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share") / "dummydesign"


def entries(kind: str) -> dict[str, Entry]:
    """List the files of one kind (``materials/resins``, ``materials/tissues``, ``molds``) by lower-case name."""
    known: dict[str, Entry] = {}
    for origin, root in (("built-in", data_folder()), ("user", user_folder())):
        for path in sorted((root / kind).glob("*.toml")):
            known[path.stem.lower()] = Entry(path.stem, path, origin)
    return known


def find(kind: str, what: str, name: str) -> Entry:
    """Find a file by name, or take ``name`` as a path when it ends in ``.toml`` or has a folder in it."""
    if name.lower().endswith(".toml") or {os.sep, os.altsep or os.sep} & set(name):
        path = Path(name)
        check_file(f"{what} file", path, quantity_name(what))
        return Entry(path.stem, path, "file")
    known = entries(kind)
    if name.lower() not in known:
        if Path(name).is_file():
            raise InputError(
                f"{what} '{name}' is a file that does not end in .toml; give a name of the list, or a TOML file",
                "unknown_name",
                quantity_name(what),
                name,
                sorted(e.name for e in known.values()),
            )
        raise unknown_name(what, name, [entry.name for entry in known.values()])
    return known[name.lower()]


def read_toml(path: Path) -> tuple[dict[str, Any], str]:
    """Read a TOML file; return its content and its text (for line numbers in messages)."""
    with reading("file", path, "file"):
        text = path.read_text(encoding="utf-8-sig")  # some editors begin a file with a byte order mark
    try:
        return tomllib.loads(text), text
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{path.name}: not valid TOML: {problem}", "file_unreadable", "file", str(path)) from None


def toml_text(text: str) -> str:
    """A text as a basic string of TOML, which is one of JSON but for the code point 127."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def toml_value(value: Any) -> str:
    """A plain value, or a list or table of such, on one line of TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return toml_text(value) if isinstance(value, str) else repr(value)


def toml_table(table: Mapping[str, Any]) -> str:
    """A file of TOML: its own values first, then the tables inside it; None becomes a commented line to fill in."""
    return "\n".join(_toml_lines(table, "")) + "\n"


def _toml_lines(table: Mapping[str, Any], prefix: str) -> list[str]:
    inside = {key: value for key, value in table.items() if not _is_inline(value)}
    own = {key: value for key, value in table.items() if key not in inside}
    lines = [f"# {key} =" if value is None else f"{key} = {toml_value(value)}" for key, value in own.items()]
    for key, value in inside.items():
        name = f"{prefix}{key}"
        for item in value if isinstance(value, list) else [value]:
            lines += ["", f"[[{name}]]" if isinstance(value, list) else f"[{name}]", *_toml_lines(item, f"{name}.")]
    return lines


def _is_inline(value: Any) -> bool:
    """Quantities and plain values stay on one line; other tables get a heading of their own."""
    if isinstance(value, dict):
        return "kind" in value and "source" in value
    return not (isinstance(value, list) and value and isinstance(value[0], dict))


def toml_line(text: str) -> str:
    """The same with blanks for all white space."""
    return toml_text(" ".join(text.split()))


Table = TypeVar("Table")


def table_path(name: str) -> Path:
    """Where a shipped table lies."""
    return data_folder() / "materials" / "tables" / name


def read(name: str, what: str, rebuild: str, parse: Callable[[dict[str, Any]], Table]) -> Table:
    """Read a shipped table."""
    try:
        return parse(json.loads(table_path(name).read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError) as problem:
        reason = str(problem) if type(problem) is ValueError else type(problem).__name__
        message = f"{what} {name} cannot be read ({reason}); rebuild it with: {rebuild}"
        raise NoAnswerError("table_unavailable", message, quantity="table") from None


_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_.-]*[A-Za-z0-9_-])?")
DEVICE = re.compile(r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?")
"""Names that are devices on Windows, with any ending: no file of such a name can be handed on to it."""


def check_name(what: str, name: str) -> None:
    """Refuse a name that cannot be a file's (InputError)."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{what} name '{name}' cannot be a file name: it may hold letters, digits, '-', '_' and '.'",
            "bad_name",
            quantity_name(what),
            name,
        )
    if DEVICE.fullmatch(name):
        raise InputError(
            f"{what} name '{name}' is the name of a device on Windows; choose another name",
            "bad_name",
            quantity_name(what),
            name,
        )


def make_room(kind: str, what: str, name: str, replace: bool) -> list[dict[str, str]]:
    """Check that a new file may have a name."""
    check_name(what, name)
    known = entries(kind).get(name.lower())
    if known is not None and known.origin == "user" and not replace:
        raise InputError(
            f"{what} '{known.name}' exists; choose another name, or --replace to take its place",
            "file_exists",
            quantity_name(what),
            name,
        )
    return hidden_by(kind, what, name)


def hidden_by(kind: str, what: str, name: str) -> list[dict[str, str]]:
    """A warning when a user's file of this name hides a built-in one."""
    if not (data_folder() / kind / f"{name.lower()}.toml").is_file():
        return []
    message = f"'{name}' now stands for this {what} of your own and hides the built-in one of that name; "
    message += f"'dummydesign {what}s remove {name}' brings it back"
    return [{"code": "shadows_built_in", "message": message}]


def own_entry(kind: str, what: str, name: str) -> Entry:
    """Find a file of the user by its name."""
    known = entries(kind)
    entry = known.get(name.lower())
    if entry is None:
        raise unknown_name(
            f"{what} of your own", name, [one.name for one in known.values() if one.origin == "user"], quantity=what
        )
    if entry.origin != "user":
        raise InputError(
            f"{what} '{entry.name}' is built in and stays as it is; only your own can be changed",
            "not_allowed",
            quantity_name(what),
            name,
        )
    return entry


def remove_own(kind: str, what: str, name: str) -> list[Path]:
    """Delete a file of the user, with the draws beside it; return what was deleted."""
    gone = _with_companions(own_entry(kind, what, name).path)
    for path in gone:
        try:
            path.unlink()
        except OSError as problem:
            raise InputError(
                f"'{path}' cannot be removed: {problem.strerror or problem}",
                "file_unwritable",
                quantity_name(what),
                str(path),
            ) from None
    return gone


def rename_own(kind: str, what: str, old: str, new: str) -> tuple[Path, list[dict[str, str]]]:
    """Give a file of the user another name, also inside the file; return its new path and what it now hides."""
    entry = own_entry(kind, what, old)
    check_name(what, new)
    taken = entries(kind).get(new.lower())
    if taken is not None and taken.origin == "user" and taken.path != entry.path:
        raise InputError(
            f"{what} '{taken.name}' exists; remove it first, or choose another name",
            "file_exists",
            quantity_name(what),
            new,
        )
    target = user_folder() / kind / f"{new}.toml"
    companions = _with_companions(entry.path)[1:]
    write_bytes(target, with_name(entry.path.read_bytes(), new))
    for path in companions:
        path.rename(path.with_name(f"{new}{path.name.removeprefix(entry.path.stem)}"))
    if target != entry.path and not (target.exists() and target.samefile(entry.path)):
        entry.path.unlink()
    return target, hidden_by(kind, what, new)


def with_name(content: bytes, name: str) -> bytes:
    """A TOML file with another ``name``, which stands before its first table; all else as it is."""
    head, table, rest = content.partition(b"\n[")
    line = f"name = {toml_text(name)}".encode()
    return re.sub(rb"(?m)^[ \t]*name[ \t]*=[^\r\n]*", lambda _: line, head, count=1) + table + rest


def _with_companions(path: Path) -> list[Path]:
    draws = path.with_name(f"{path.stem}_draws.csv")
    return [path, *([draws] if draws.is_file() else [])]


def fill_table(kind: type[Table], data: Mapping[str, Any], **known: Any) -> Table:
    """Fill a table's dataclass from the content of its file: lists become arrays, or tuples where a range is wanted."""
    import numpy as np

    values = dict(known)
    for item in fields(kind):  # type: ignore[arg-type]
        if item.name in known or item.name not in data:
            continue
        value = data[item.name]
        if isinstance(value, list):
            value = tuple(value) if str(item.type).startswith("tuple") else np.array(value, dtype=float)
        values[item.name] = value
    return kind(**values)
