"""Whether what a command read has changed since, and whether its folder still holds its answer: by manifests."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dummydesign.core.datafiles import find
from dummydesign.core.errors import InputError
from dummydesign.core.outputs.manifest import NAME as MANIFEST
from dummydesign.core.outputs.manifest import sha256_of

KINDS = {"tissue": "materials/tissues", "resin": "materials/resins", "mould preset": "molds"}
"""Files that a manifest lists by what they are and their name or path."""


def changed_inputs(root: Path, manifest: Path) -> list[str]:
    """Files that are gone or have another content than when a command read them.

    Parameters
    ----------
    root : Path
        The project folder, in which the command ran.
    manifest : Path
        That it wrote; without one nothing is known to have changed.
    """
    try:
        read = json.loads(manifest.read_text(encoding="utf-8"))["files_read"]
        return [str(one["name"]) for one in read if sha256_of(_place(root, str(one["name"]))) != one["sha256"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def _place(root: Path, name: str) -> Path:
    """Where a file of a manifest lies now."""
    for what, kind in KINDS.items():
        called = name.removeprefix(f"{what} ")
        if called != name:
            try:
                return root / called if called.endswith(".toml") else find(kind, what, called).path
            except InputError:
                break
    return root / name


def holds_answer(root: Path, folder: str, answer: Mapping[str, Any]) -> bool:
    """Whether a folder still holds an answer: it may be gone, or another command has written it since.

    Parameters
    ----------
    root : Path
        The project folder.
    folder : str
        That the command wrote, from the project folder on.
    answer : mapping
        JSON of the command.
    """
    if not (root / folder).is_dir():
        return False
    try:
        kept = json.loads((root / folder / MANIFEST).read_text(encoding="utf-8"))["inputs"]
        asked = answer.get("inputs") or {}
        return all(kept[name] == asked[name] for name in kept.keys() & asked.keys())
    except (OSError, ValueError, KeyError, AttributeError, TypeError):
        return True


def changed_since(paths: list[Path], started: float) -> bool:
    """Whether a file was written after a command began."""
    return any(path.stat().st_mtime > started for path in paths if path.is_file())
