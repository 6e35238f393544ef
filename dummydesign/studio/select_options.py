"""What can be chosen on the pages: names of the library, and what lies in the project."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import entries
from dummydesign.design.search.shape_family import designable_kinds
from dummydesign.studio.file_transfer import numbered
from dummydesign.tissue import load_tissue


def tissues(root: Path) -> dict[str, str]:
    """Tissues of the project, then of the library; value for ``--tissue`` to words."""
    files = sorted((root / "tissue").glob("*.toml"))
    return {f"tissue/{path.name}": f"tissue/{path.name}" for path in files} | _of_library("materials/tissues")


def resins() -> dict[str, str]:
    """Resins of the library; value for ``--resin`` to words."""
    return _of_library("materials/resins")


def _of_library(kind: str) -> dict[str, str]:
    return {entry.name: f"{entry.name} ({entry.origin})" for entry in entries(kind).values()}


def shapes() -> dict[str, str]:
    """Kinds of pads that can be searched."""
    return {"auto": "auto (the best of all)", "slab": "slab"} | {kind: kind for kind in designable_kinds()}


def aims(tissue: str) -> dict[str, str]:
    """Aims that a tissue allows."""
    named = {f"subject:{one.name}": f"subject {one.name}" for one in load_tissue(tissue).subjects}
    return {"average": "average", "safe-side": "safe side"} | named


def traces(root: Path) -> dict[str, str]:
    """Imported presses, path to words."""
    return {
        path.relative_to(root).as_posix(): f"{path.parent.name}/{path.name}"
        for path in sorted((root / "measured").glob("import-*/*.csv"))
    }


def folders(root: Path, room: str, holding: str) -> list[str]:
    """Folders of a room that hold a file of this name, from the project folder on, the newest last."""
    paths = sorted((root / room).glob(f"[!.]*/{holding}"), key=lambda path: path.stat().st_mtime)
    return [path.parent.relative_to(root).as_posix() for path in paths]


def free_name(root: Path, room: str, name: str) -> str:
    """A name that no folder or TOML file of a room has: ``name``, ``name-2``, ..."""
    folder = root / room
    return next(one for one in numbered(name) if not ((folder / one).exists() or (folder / f"{one}.toml").exists()))


def free_library_name(what: str, name: str) -> str:
    """A name that no ``tissue`` or ``resin`` of the library has."""
    known = entries(f"materials/{what}s")
    return next(one for one in numbered(name) if one not in known)


def check_name(what: str, name: str, replace: bool = True) -> None:
    """Refuse the name of a ``tissue`` or ``resin`` that is not the user's own, or that is not to be replaced."""
    known = entries(f"materials/{what}s").get(name.strip().lower())
    if known is None or (known.origin == "user" and replace):
        return
    message = f"'{known.name}' is a {what} of the library: choose another name."
    if known.origin == "user":
        message = f"You have a {what} '{known.name}': choose another name, or tick Replace."
    raise InputError(message, "file_exists", what, known.name)


def offered(known: Mapping[str, str], value: str, words: str = "") -> dict[str, str]:
    """What can be chosen, with what is chosen now at its head when it is not there any more."""
    return dict(known) if value in known else {value: words or value, **known}


def calibrations(root: Path) -> dict[str, str]:
    """Calibrations of the project, the newest first; value for ``--calibration`` to words."""
    folder_of = {f"{one}/calibration.json": one for one in folders(root, "calibrations", "calibration.json")}
    return {"": "none"} | dict(reversed(folder_of.items()))


def campaigns(root: Path) -> dict[str, str]:
    """Campaigns of the project by folder, the newest last."""
    return {one: one for one in folders(root, "campaigns", "campaign.toml")}
