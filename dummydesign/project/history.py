"""Past answers of a folder: each finished manifest below it, with its verdict."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.project.status import finished_manifest

DEEPEST = 3
"""Folders below the one named that are looked into."""


@dataclass(frozen=True)
class PastAnswer:
    """One answer: its folder from the one named on, command, date and what its manifest sums up."""

    folder: str
    command: str
    date: str
    version: str
    summary: dict[str, Any] | None


def history_of(folder: Path) -> tuple[PastAnswer, ...]:
    """List the answers in a folder and up to three folders below it, the newest first.

    Raises
    ------
    InputError
        When there is no such folder.
    """
    if not folder.is_dir():
        message = f"folder '{folder}' does not exist; name one that holds answers"
        raise InputError(message, "file_not_found", "folder", str(folder))
    found = []
    for path in _manifests(folder):
        content = finished_manifest(path)
        if content is not None:
            place = path.parent if path.name == MANIFEST else path.with_name(path.name.removesuffix(f"-{MANIFEST}"))
            summary = content.get("summary")
            found.append(PastAnswer(
                place.relative_to(folder).as_posix(), str(content["command"]), str(content.get("date", "")),
                str(content.get("version", "")), summary if isinstance(summary, dict) else None,
            ))  # fmt: skip
    return tuple(sorted(found, key=lambda one: one.date, reverse=True))


def _manifests(folder: Path) -> Iterator[Path]:
    for place, below, names in os.walk(folder):
        deep = len(Path(place).relative_to(folder).parts)
        below[:] = [] if deep >= DEEPEST else sorted(name for name in below if not name.startswith("."))
        yield from (Path(place) / name for name in sorted(names) if name == MANIFEST or name.endswith(f"-{MANIFEST}"))
