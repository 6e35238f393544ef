"""Import profiles: what a user settled once for a machine, kept under a name in the user's own folder."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import unwritable, write_text
from dummydesign.core.library import DEVICE, Entry, entries, find, read_toml, toml_text, user_folder
from dummydesign.measurement.importing.decisions import Settings
from dummydesign.measurement.importing.read import Imported
from dummydesign.measurement.importing.vocabulary import ROLES

KIND = "profiles"
"""Folder of the profiles in the user's own one."""


def list_profiles() -> list[Entry]:
    """The profiles that are known, by name."""
    return [entry for _, entry in sorted(entries(KIND).items())]


_KEYS = {field.name for field in fields(Settings)}
_PLAIN = Settings()


def load_profile(name: str) -> Settings:
    """Read a profile by name, or from a file that ends in ``.toml``."""
    return _read(find(KIND, "profile", name).path)


def _read(path: Path) -> Settings:
    data, _ = read_toml(path)
    if data.pop("schema", 1) != 1:
        raise InputError(f"{path.name}: schema is not 1, the one that this version reads", "unsupported", "schema")
    values: dict[str, Any] = {}
    for key, value in data.items():
        if key not in _KEYS:
            raise unknown_name("key", key, _KEYS, "unknown_key", "profile").within(path.name)
        if key in ("columns", "units"):
            valid, form = isinstance(value, dict) and not set(value) - set(ROLES), f"texts for {', '.join(ROLES)}"
        elif key == "skip":
            valid, form = type(value) is int and value >= 0, "a whole number from 0"
        elif key == "flip":
            valid = isinstance(value, list) and not set(map(str, value)) - {"displacement", "force"}
            form = "a list of 'displacement' and 'force', which may be empty"
        else:
            valid, form = isinstance(value, str), "a text in quotes"
        if not valid:
            code = "out_of_range" if key == "skip" else "malformed"
            raise InputError(f"{path.name}: {key} = {value!r} must be {form}", code, key, value)
        values[key] = frozenset(value) if key == "flip" else value
        if isinstance(value, dict):
            values[key] = {role: str(text) for role, text in value.items()}
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
    """Keep a profile in the user's folder."""
    if not re.fullmatch(r"[\w][\w .-]{0,60}", name) or name.lower().endswith(".toml") or DEVICE.fullmatch(name):
        message = f"--save-profile '{name}': a profile's name is made of letters, digits, '-', '_' and '.'"
        raise InputError(message, "bad_name", "save_profile", name)
    path = user_folder() / KIND / f"{name}.toml"
    if path.exists() and not overwrite and _read(path) != settings:
        message = f"--save-profile '{name}': exists already with other settings; add --replace to replace it"
        raise InputError(message, "file_exists", "save_profile", name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise unwritable("folder", path.parent, problem, "folder") from None
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
