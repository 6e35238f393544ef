"""Import profiles: what a user settled once for a machine, kept under a name in the user's own folder."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import find, read_toml, toml_text, user_folder
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import write_text
from dummydesign.measurement.importing.core.decisions import Settings
from dummydesign.measurement.importing.core.vocabulary import ROLES
from dummydesign.measurement.importing.profile_names import KIND
from dummydesign.measurement.importing.read import Imported

_KEYS = {field.name for field in fields(Settings)}
_PLAIN = Settings()


def load_profile(name: str) -> Settings:
    """Read a profile by name, or from a file that ends in ``.toml``.

    Raises
    ------
    InputError
        When it is not known, or holds something that is no setting of an import.
    """
    entry = find(KIND, "profile", name)
    data, _ = read_toml(entry.path)
    return _settings(data, entry.path.name)


def _settings(data: dict[str, Any], file: str) -> Settings:
    data = dict(data)
    if data.pop("schema", 1) != 1:
        raise InputError(f"{file}: schema is not 1, the one that this version reads")
    for key in data:
        if key not in _KEYS:
            raise InputError(f"{file}: {unknown_name('key', key, _KEYS)}")
    values: dict[str, Any] = {}
    for key, value in data.items():
        if key in ("columns", "units"):
            if not isinstance(value, dict) or set(value) - set(ROLES):
                raise InputError(f"{file}: {key} must give a text for some of {', '.join(ROLES)}")
            values[key] = {role: str(text) for role, text in value.items()}
        elif key == "skip":
            if isinstance(value, bool) or not isinstance(value, int) or value < 0:
                raise InputError(f"{file}: skip = {value!r} must be a whole number from 0")
            values[key] = value
        elif key == "flip":
            if not isinstance(value, list) or set(map(str, value)) - {"displacement", "force"}:
                raise InputError(f"{file}: flip must be a list of 'displacement' and 'force', which may be empty")
            values[key] = frozenset(value)
        elif not isinstance(value, str):
            raise InputError(f"{file}: {key} = {value!r} must be a text in quotes")
        else:
            values[key] = value
    return Settings(**values)


def learned(given: Settings, found: Iterable[Imported]) -> Settings:
    """What to keep for the next time: what the user gave, and the columns and signs of text that all files share."""
    layouts = [one.columns for one in found]

    def common(values: list[str]) -> str | None:
        return values[0] if values and len(set(values)) == 1 and values[0] else None

    columns = dict(given.columns)
    for role in ROLES:
        title = common([one.chosen[role].title for one in layouts])
        # Units are not kept: a file states its own, and one that does not was read with those that were given.
        if role not in columns and title and all(list(one.layout.names).count(title) == 1 for one in layouts):
            columns[role] = title
    return replace(
        given,
        columns=columns,
        separator=given.separator or common([one.layout.separator for one in layouts]),
        decimal=given.decimal or common([one.layout.decimal for one in layouts]),
    )


def save_profile(name: str, settings: Settings, overwrite: bool = False) -> Path:
    """Keep a profile in the user's folder.

    Parameters
    ----------
    name : str
        Of the profile; letters, digits, ``-``, ``_`` and ``.``.
    settings : Settings
        What is kept.
    overwrite : bool
        Whether another profile of the name may be replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        For a name that cannot be a file's, or one that is taken.
    """
    if not re.fullmatch(r"[\w][\w .-]{0,60}", name) or name.lower().endswith(".toml"):
        raise InputError(f"--save-profile '{name}': a profile's name is made of letters, digits, '-', '_' and '.'")
    path = user_folder() / KIND / f"{name}.toml"
    if path.exists() and not overwrite and _settings(read_toml(path)[0], path.name) != settings:
        raise InputError(
            f"--save-profile '{name}': exists already with other settings; add --replace to put this in its place"
        )
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise InputError(f"folder '{path.parent}' cannot be made: {problem.strerror or problem}") from None
    return write_text(path, _toml(settings))


def _toml(settings: Settings) -> str:
    lines = ["schema = 1"]
    tables: list[str] = []
    for field in fields(Settings):
        value = getattr(settings, field.name)
        if value is None or value == getattr(_PLAIN, field.name):
            continue
        if isinstance(value, dict):
            tables += ["", f"[{field.name}]", *(f"{role} = {toml_text(text)}" for role, text in value.items())]
        elif isinstance(value, frozenset):
            lines.append(f"{field.name} = [{', '.join(toml_text(item) for item in sorted(value))}]")
        else:
            lines.append(f"{field.name} = {value if isinstance(value, int) else toml_text(value)}")
    return "\n".join([*lines, *tables]) + "\n"
