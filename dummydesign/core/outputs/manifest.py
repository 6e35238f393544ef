"""The manifest of what a command wrote: the question, its command line and version, and the hash of every file."""

from __future__ import annotations

import hashlib
import json
import shlex
from collections.abc import Iterable, Mapping, Sequence
from contextvars import ContextVar
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

from dummydesign._version import __version__

SCHEMA = "dummydesign.manifest/1"
NAME = "manifest.json"
COMMAND_LINE: ContextVar[Sequence[str] | None] = ContextVar("command_line", default=None)
"""Words of the command line that is being run; None in a call from Python."""


@dataclass(frozen=True)
class Question:
    """What a command was asked.

    Parameters
    ----------
    command : str
        Name of the command.
    inputs : mapping
        What the answer depends on, as plain values; not the folder, the number of processes or the like.
    files : mapping
        Files that are read, by what they are called; their content counts, not their date or place.
    """

    command: str
    inputs: Mapping[str, Any]
    files: Mapping[str, str | PathLike[str]] = field(default_factory=dict)

    @cached_property
    def sums(self) -> list[dict[str, Any]]:
        """``name``, ``file`` and ``sha256`` of each file that is read, as it was when first asked."""
        return [
            {"name": name, "file": Path(path).name, "sha256": sha256_of(Path(path))}
            for name, path in self.files.items()
        ]

    @cached_property
    def key(self) -> str:
        """SHA-256 of the question: two commands with the same key are asked the same."""
        content = [self.command, self.inputs, [one["sha256"] for one in self.sums]]
        return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def sha256_of(path: Path) -> str | None:
    """SHA-256 of a file; None where there is none that can be read."""
    try:
        with open(path, "rb") as stream:
            return hashlib.file_digest(stream, "sha256").hexdigest()
    except OSError:
        return None


def manifest_text(
    question: Question, folder: Path, names: Iterable[str] | None, extra: Mapping[str, Any] | None = None
) -> str:
    """Write a manifest as JSON.

    Parameters
    ----------
    question : Question
    folder : Path
        Where the files lie now.
    names : iterable of str, optional
        Their names in it; None for a command that is still at work (``finished`` is then false).
    extra : mapping, optional
        Further fields.
    """
    words = COMMAND_LINE.get()
    content = {
        "schema": SCHEMA,
        "command": question.command,
        "command_line": None if words is None else shlex.join(["dummydesign", *words]),
        "version": __version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "finished": names is not None,
        "question": question.key,
        "inputs": dict(question.inputs),
        "files_read": question.sums,
        "sha256": {name: sha256_of(folder / name) for name in sorted(names or ())},
        **(extra or {}),
    }
    return json.dumps(content, indent=1, default=str) + "\n"


@dataclass(frozen=True)
class Earlier:
    """What an earlier command left in a folder, by its manifest."""

    key: str | None
    command: str | None
    sha256: Mapping[str, str]

    def changed(self, folder: Path) -> list[str]:
        """Files that are no longer as they were written."""
        return [name for name, sha in self.sha256.items() if sha256_of(folder / name) not in (sha, None)]


def read_manifest(path: Path) -> Earlier | None:
    """Read a manifest, also one of an earlier edition; None where there is none.

    Names that lead out of the folder are left out: nothing outside is ever touched.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        sums = {name: sha for name, sha in content["sha256"].items() if inside(name) and isinstance(sha, str)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return Earlier(None, None, {}) if path.is_file() else None
    return Earlier(content.get("question"), content.get("command"), sums)


def inside(name: str) -> bool:
    """Whether a name stays in its folder."""
    path = Path(name)
    return bool(name) and not path.is_absolute() and ".." not in path.parts
