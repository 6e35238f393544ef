"""What can be chosen on the pages: names of the library, and what lies in the project."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import entries
from dummydesign.project.status import ProjectFile


def tissues(root: Path) -> dict[str, str]:
    """Tissues of the project, then of the library; value for ``--tissue`` to words."""
    own = [
        path.relative_to(root).as_posix() for path in sorted((root / "tissue").glob("*.toml"))
        if not path.stem.endswith("-manifest")
    ]  # fmt: skip
    known = {entry.name: f"{entry.name} ({entry.origin})" for entry in entries("materials/tissues").values()}
    return {name: name for name in own} | known


def resins() -> dict[str, str]:
    """Resins of the library; value for ``--resin`` to words."""
    return {entry.name: f"{entry.name} ({entry.origin})" for entry in entries("materials/resins").values()}


def shapes() -> dict[str, str]:
    """Kinds of pads that can be searched."""
    from dummydesign.design.search.tabulated_shapes import designable_kinds

    return {"auto": "auto (the best of all)", "slab": "slab"} | {kind: kind for kind in designable_kinds()}


def aims(tissue: str) -> dict[str, str]:
    """Aims that a tissue allows."""
    from dummydesign.tissue import load_tissue

    subjects = [subject.name for subject in load_tissue(tissue).subjects]
    named = {f"subject:{name}": f"subject {name}" for name in subjects}
    return {"average": "average", "safe-side": "safe side"} | named


def traces(root: Path) -> dict[str, str]:
    """Imported presses, path to words."""
    found = sorted((root / "measured").glob("import-*/*.csv"))
    return {path.relative_to(root).as_posix(): f"{path.parent.name}/{path.name}" for path in found}


def folders(root: Path, room: str, holding: str) -> list[str]:
    """Folders of a room that hold a file of this name, from the project folder on, the newest last.

    Parameters
    ----------
    root : Path
        The project folder.
    room : str
        Such as ``campaigns``.
    holding : str
        Such as ``campaign.toml``.
    """
    found = [path for path in (root / room).glob(f"*/{holding}") if not path.parent.name.startswith(".")]
    found.sort(key=lambda path: path.stat().st_mtime)
    return [path.parent.relative_to(root).as_posix() for path in found]


def free_name(root: Path, room: str, name: str) -> str:
    """A name that no folder or TOML file of a room has: ``name``, ``name-2``, ...

    Parameters
    ----------
    root : Path
        The project folder.
    room : str
        Such as ``campaigns``.
    name : str
        The name that is wished for.
    """
    number, found = 1, name
    while (root / room / found).exists() or (root / room / f"{found}.toml").exists():
        number += 1
        found = f"{name}-{number}"
    return found


def told(one: ProjectFile) -> str:
    """One thing that lies in the project, in a line."""
    name, found = one.folder.partition("/")[2], one.summary or {}
    said = _said(found)
    return f"{name}: {said}" if said else name


def _said(found: dict[str, Any]) -> str:
    if "pressed" in found:
        left = f", {found['wrong']} problem{'s' * (found['wrong'] > 1)}" if found["wrong"] else ""
        return f"{found['pressed']} of {found['pressed'] + found['missing']} presses are there{left}"
    if {"thickness_mm", "ratio", "shape"} <= set(found):
        verdict = str(found.get("verdict", "")).replace("_", " ")
        pad = f"{found['thickness_mm']:g} mm {found['shape']}, ratio {found['ratio']:g}"
        return f"{pad}, {verdict}" if verdict else pad
    if "traces" in found:
        return f"{found['traces']} presses"
    return str(found.get("text", ""))
