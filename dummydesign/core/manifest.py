"""The manifest of an answer: its question, command line, version, files, and records added later."""

from __future__ import annotations

import hashlib
import json
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from dummydesign._version import __version__
from dummydesign.core.errors import InputError
from dummydesign.core.files import FilePath, read_json, write_text
from dummydesign.core.progress import COMMAND_LINE

SCHEMA = "dummydesign.manifest/1"
NAME = "manifest.json"


@dataclass(frozen=True)
class Question:
    """What a command was asked."""

    command: str
    inputs: Mapping[str, Any]
    files: Mapping[str, FilePath] = field(default_factory=dict)

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
    question: Question, folder: Path, names: Iterable[str], extra: Mapping[str, Any] | None = None
) -> str:
    """Write a manifest as JSON."""
    words = COMMAND_LINE.get()
    content = {
        "schema": SCHEMA,
        "command": question.command,
        "command_line": None if words is None else shlex.join(["dummydesign", *words]),
        "version": __version__,
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "finished": True,
        "question": question.key,
        "inputs": dict(question.inputs),
        "files_read": question.sums,
        "sha256": {name: sha256_of(folder / name) for name in sorted(names)},
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
    content = read_json(path)
    sums = content.get("sha256")
    if not isinstance(sums, dict):
        return Earlier(None, None, {}) if path.is_file() else None
    named = {name: sha for name, sha in sums.items() if inside(name) and isinstance(sha, str)}
    return Earlier(content.get("question"), content.get("command"), named)


def inside(name: str) -> bool:
    """Whether a name stays in its folder."""
    path = Path(name)
    return bool(name) and not path.is_absolute() and ".." not in path.parts


KEY = "records"
"""Field of a manifest: SHA-256 of each record by its name. Asking the same question again leaves them in place."""
MOST = 1000


def records_of(manifest: Path, question: Question) -> dict[str, str]:
    """SHA-256 by name of the records beside the answer to a question; none when the manifest is another question's."""
    content = read_json(manifest)
    records = content.get(KEY) if content.get("question") == question.key else None
    return {name: sha for name, sha in records.items() if inside(name)} if isinstance(records, dict) else {}


def add_record(
    folder: Path, stem: str, content: Mapping[str, Any], *, ignored: tuple[str, ...] = ("date",), replace: bool = False
) -> Path:
    """Keep a record in the folder of an answer."""
    manifest = _manifest_of(folder)
    whole = read_json(manifest)
    known = whole.get(KEY, {})
    if not whole or not isinstance(known, dict):
        message = f"'{folder}' has no {NAME} that can be read; it is not the folder of an answer"
        raise InputError(message, "file_unreadable", "manifest", str(folder))
    path = _free(folder, stem, content, ignored, replace)
    if not path.exists() or _compared(read_json(path), ignored) != _compared(content, ignored):
        write_text(path, json.dumps(content, indent=1, allow_nan=False) + "\n")
    known = {**known, path.relative_to(manifest.parent).as_posix(): sha256_of(path)}
    write_text(manifest, json.dumps({**whole, KEY: dict(sorted(known.items()))}, indent=1) + "\n")
    return path


def _manifest_of(folder: Path) -> Path:
    """The manifest beside the answer, or that of the folder above, when it lists files of this one."""
    above = folder.resolve().parent / NAME
    earlier = None if (folder / NAME).exists() else read_manifest(above)
    listed = earlier is not None and any(name.startswith(f"{folder.resolve().name}/") for name in earlier.sha256)
    return folder.parent / NAME if listed and folder.name not in ("", "..") else folder / NAME


def _free(folder: Path, stem: str, content: Mapping[str, Any], ignored: tuple[str, ...], replace: bool) -> Path:
    for number in range(1, MOST):
        path = folder / (f"{stem}.json" if number == 1 else f"{stem}-{number}.json")
        if not path.exists() or replace or _compared(read_json(path), ignored) == _compared(content, ignored):
            return path
    raise InputError(f"'{folder}' holds {MOST - 1} records; use --replace or remove some", "too_large", "records")


def _compared(content: Mapping[str, Any], ignored: tuple[str, ...]) -> Any:
    """The content as JSON gives it back, without the keys left apart."""
    return json.loads(json.dumps({key: value for key, value in content.items() if key not in ignored}))
