"""The project folder: ``project.toml`` and one folder a step; found from inside as git finds its own."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import toml_text
from dummydesign.core.errors import InputError, unknown_name
from dummydesign.core.files import write_text

FILE = "project.toml"
SCHEMA = 1
FOLDERS = ("measured", "tissue", "designs", "moulds", "campaigns", "calibrations")
"""One folder a step, in the order of the work."""
NAMES = ("tissue", "resin", "punch")
ASKED = ("aim", "shape", "thickness", "ratio", "calibration")
"""What may stand under ``[asked]``: options of ``suggest`` of the same name."""
_HELP = {
    "tissue": "a name of 'dummydesign tissues list', or a file such as \"tissue/mine.toml\"",
    "resin": "a name of 'dummydesign resins list', or a file",
    "punch": "square:14, round:D, ...: for predict, whatif and campaign new",
}


@dataclass(frozen=True)
class Project:
    """A project folder and what its ``project.toml`` says.

    Attributes
    ----------
    root : Path
        The folder.
    name : str
    tissue, resin, punch : str or None
        Defaults of the options of the same name.
    asked : tuple of (name, text)
        Further defaults of ``suggest``: aim, shape, thickness, ratio, calibration.
    """

    root: Path
    name: str
    tissue: str | None = None
    resin: str | None = None
    punch: str | None = None
    asked: tuple[tuple[str, str], ...] = ()

    def given(self) -> dict[str, str]:
        """All that ``project.toml`` says, by option."""
        own = {name: value for name in NAMES if (value := getattr(self, name)) is not None}
        return own | dict(self.asked)

    def toml(self) -> str:
        """Text of ``project.toml``; what is not given stands there as a comment."""
        lines = [f"schema = {SCHEMA}", f"name = {toml_text(self.name)}", ""]
        lines.append("# Defaults of the commands that are run in this folder; an option on the command line wins.")
        for name in NAMES:
            value = getattr(self, name)
            given = f"{name} = {toml_text(value)}" if value is not None else f"# {name} = "
            lines.append(f"{given:<40} # {_HELP[name]}")
        lines += ["", "# What 'dummydesign suggest' is asked for.", "[asked]"]
        known = dict(self.asked)
        lines += [f"{name} = {toml_text(known[name])}" if name in known else f"# {name} = " for name in ASKED]
        return "\n".join(lines) + "\n"


def find_project(start: str | Path = ".") -> Project | None:
    """The project that a folder lies in: the nearest ``project.toml`` upwards; None without one.

    A file of that name without ``schema`` belongs to something else and is passed over.

    Raises
    ------
    InputError
        When the file is damaged, with what is wrong.
    """
    here = Path(start).resolve()
    for folder in (here, *here.parents):
        path = folder / FILE
        if path.is_file() and _ours(path):
            return read_project(folder)
    return None


def _ours(path: Path) -> bool:
    """Whether a ``project.toml`` is meant for us; a damaged one is, for silence would hide it."""
    try:
        return "schema" in tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return True


def read_project(folder: str | Path) -> Project:
    """Read the ``project.toml`` of a folder.

    Raises
    ------
    InputError
        When there is none, or it is damaged: unknown entries, wrong types, not TOML.
    """
    root = Path(folder).resolve()
    path = root / FILE
    if not path.is_file():
        raise InputError(f"'{folder}' is no project folder: it holds no {FILE} ('dummydesign init {folder}' makes one)")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as problem:
        raise InputError(f"{path}: cannot be read: {problem.strerror}") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not UTF-8 text") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{path}: not valid TOML: {problem}") from None
    if data.get("schema") != SCHEMA:
        raise InputError(f"{path}: schema = {data.get('schema')} is not {SCHEMA}, the one this version reads")
    asked = data.get("asked", {})
    if not isinstance(asked, dict):
        raise InputError(f"{path}: asked must be a table, [asked]")
    for place, entries, known in (("", data, ("schema", "name", "asked", *NAMES)), ("asked.", asked, ASKED)):
        for key, value in entries.items():
            if key not in known:
                raise InputError(f"{path}: {unknown_name('entry', key, known)}")
            if key not in ("schema", "asked") and not (isinstance(value, str) and value.strip()):
                raise InputError(f"{path}: {place}{key} = {value!r} must be text that is not empty")
    named = {name: data.get(name) for name in NAMES}
    return Project(root, data.get("name", root.name), **named, asked=tuple(sorted(asked.items())))


def make_project(folder: str | Path, name: str | None = None, **given: str | None) -> Project:
    """Make a project folder, or complete the folders of one that has none of them.

    Parameters
    ----------
    folder : path
        Made when needed; what lies in it stays.
    name : str, optional
        By default the folder's.
    **given : str, optional
        tissue, resin, punch, aim, shape, thickness, ratio, calibration.

    Raises
    ------
    InputError
        When it is a project already, or cannot be written.
    """
    root = Path(folder)
    if (root / FILE).exists():
        raise InputError(f"'{root / FILE}' exists: the folder is a project; edit the file to change what it says")
    kept = {key: value for key, value in given.items() if value is not None}
    asked = tuple(sorted((key, kept[key]) for key in ASKED if key in kept))
    title = name or root.resolve().name or "project"
    named = {key: kept.get(key) for key in NAMES}
    project = Project(root.resolve(), title, named["tissue"], named["resin"], named["punch"], asked)
    try:
        for part in FOLDERS:
            (root / part).mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise InputError(f"project folder '{root}' cannot be written: {problem.strerror or problem}") from None
    write_text(root / FILE, project.toml())
    return project


def change_project(project: Project, **given: Any) -> Project:
    """Write new values into ``project.toml``; None takes one away. Comments of one's own are not kept.

    Parameters
    ----------
    project : Project
    **given : str or None
        As for :func:`make_project`.
    """
    own = {key: value for key, value in given.items() if key in ("name", *NAMES)}
    asked = {**dict(project.asked), **{key: value for key, value in given.items() if key in ASKED}}
    kept = tuple(sorted((key, value) for key, value in asked.items() if value is not None))
    changed = replace(project, **own, asked=kept)
    write_text(project.root / FILE, changed.toml())
    return changed
