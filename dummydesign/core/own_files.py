"""The user's own named files: what a new one takes the place of, and removing, renaming and finding them."""

from __future__ import annotations

import re
from pathlib import Path

from dummydesign.core.datafiles import Entry, data_folder, entries, user_folder
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import write_text

_NAME = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9_.-]*[A-Za-z0-9_-])?")


def check_name(what: str, name: str) -> None:
    """Refuse a name that cannot be a file's (InputError)."""
    if not _NAME.fullmatch(name):
        raise InputError(f"{what} name '{name}' cannot be a file name: it may hold letters, digits, '-', '_' and '.'")


def make_room(kind: str, what: str, name: str, replace: bool) -> list[dict[str, str]]:
    """Check that a new file may have a name.

    Parameters
    ----------
    kind, what : str
        Folder, such as ``materials/resins``, and how the thing is called, such as ``resin``.
    name : str
        Of the new file, without its ending.
    replace : bool
        Whether a file of the user with this name may go.

    Returns
    -------
    list of {code, message}
        A warning when the name hides a built-in one.

    Raises
    ------
    InputError
        When the user has one of this name and ``replace`` is false.
    """
    check_name(what, name)
    known = entries(kind).get(name.lower())
    if known is not None and known.origin == "user" and not replace:
        raise InputError(f"{what} '{known.name}' exists; choose another name, or --replace to take its place")
    return hidden_by(kind, what, name)


def hidden_by(kind: str, what: str, name: str) -> list[dict[str, str]]:
    """A warning when a user's file of this name hides a built-in one.

    Parameters
    ----------
    kind, what : str
        Folder and how the thing is called, as for :func:`make_room`.
    name : str
        Of the user's file.
    """
    if not (data_folder() / kind / f"{name.lower()}.toml").is_file():
        return []
    message = (
        f"'{name}' now stands for this {what} of your own and hides the built-in one of that name; "
        f"'dummydesign {what}s remove {name}' brings it back"
    )
    return [{"code": "shadows_built_in", "message": message}]


def own_entry(kind: str, what: str, name: str) -> Entry:
    """Find a file of the user by its name.

    Parameters
    ----------
    kind, what : str
        Folder and how the thing is called, as for :func:`make_room`.
    name : str
        In any case of letters.

    Raises
    ------
    InputError
        When there is none: a built-in one cannot be changed.
    """
    known = entries(kind)
    entry = known.get(name.lower())
    if entry is None:
        raise unknown_name(f"{what} of your own", name, [one.name for one in known.values() if one.origin == "user"])
    if entry.origin != "user":
        raise InputError(f"{what} '{entry.name}' is built in and stays as it is; only your own can be changed")
    return entry


def remove_own(kind: str, what: str, name: str) -> list[Path]:
    """Delete a file of the user, with the draws beside it; return what was deleted.

    Parameters
    ----------
    kind, what : str
        Folder and how the thing is called, as for :func:`make_room`.
    name : str
        In any case of letters.
    """
    gone = _with_companions(own_entry(kind, what, name).path)
    for path in gone:
        try:
            path.unlink()
        except OSError as problem:
            raise InputError(f"'{path}' cannot be removed: {problem.strerror or problem}") from None
    return gone


def rename_own(kind: str, what: str, old: str, new: str) -> tuple[Path, list[dict[str, str]]]:
    """Give a file of the user another name, also inside the file; return its new path and what it now hides.

    Parameters
    ----------
    kind, what : str
        Folder and how the thing is called, as for :func:`make_room`.
    old, new : str
        Name that it has and name that it gets.

    Raises
    ------
    InputError
        When there is none of the old name, or one of the new.
    """
    entry = own_entry(kind, what, old)
    check_name(what, new)
    taken = entries(kind).get(new.lower())
    if taken is not None and taken.origin == "user" and taken.path != entry.path:
        raise InputError(f"{what} '{taken.name}' exists; remove it first, or choose another name")
    target = user_folder() / kind / f"{new}.toml"
    text = entry.path.read_text(encoding="utf-8")
    # the name of the file itself stands before the first table
    head, table, rest = text.partition("\n[")
    renamed = re.sub(r"(?m)^name\s*=.*$", lambda _: f'name = "{new}"', head, count=1) + table + rest
    companions = _with_companions(entry.path)[1:]
    write_text(target, renamed)
    for path in companions:
        path.rename(path.with_name(f"{new}{path.name.removeprefix(entry.path.stem)}"))
    if target != entry.path and not (target.exists() and target.samefile(entry.path)):
        entry.path.unlink()
    return target, hidden_by(kind, what, new)


def _with_companions(path: Path) -> list[Path]:
    draws = path.with_name(f"{path.stem}_draws.csv")
    return [path, *([draws] if draws.is_file() else [])]
