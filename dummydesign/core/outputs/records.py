"""What a user measured, kept in the folder of an answer and covered by its manifest beside the answer's own files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.core.outputs.manifest import NAME, Question, inside, read_manifest, sha256_of

KEY = "records"
"""Field of a manifest: SHA-256 of each record by its name. Asking the same question again leaves them in place."""
MOST = 1000


def records_of(manifest: Path, question: Question) -> dict[str, str]:
    """SHA-256 by name of the records beside the answer to a question; none when the manifest is another question's."""
    try:
        content = json.loads(manifest.read_text(encoding="utf-8"))
        found = content.get(KEY, {}) if content["question"] == question.key else {}
    except (OSError, ValueError, AttributeError, KeyError, TypeError):
        return {}
    return {name: sha for name, sha in found.items() if inside(name)} if isinstance(found, dict) else {}


def add_record(
    folder: Path, stem: str, content: Mapping[str, Any], *, apart: tuple[str, ...] = ("date",), replace: bool = False
) -> Path:
    """Keep a record in the folder of an answer.

    Parameters
    ----------
    folder : Path
        Holds a manifest, or lies in a folder whose manifest covers it.
    stem : str
        The file is ``STEM.json``, or ``STEM-2.json``, ... when another record has that name.
    content : mapping
        Plain values.
    apart : tuple of str
        Keys in which two records of the same measurement may differ.
    replace : bool
        Take the place of the first record instead of the next number.

    Returns
    -------
    Path
        The record; one that says the same and is there already stays as it is.

    Raises
    ------
    InputError
        When the folder has no manifest, or cannot be written.
    """
    manifest = _manifest_of(folder)
    try:
        whole = json.loads(manifest.read_text(encoding="utf-8"))
        known = dict(whole.get(KEY, {}))
    except (OSError, ValueError, TypeError, AttributeError):
        raise InputError(f"'{folder}' has no {NAME} that can be read; it is not the folder of an answer") from None
    path = _free(folder, stem, content, apart, replace)
    if not path.exists() or _said(path, apart) != _plain(content, apart):
        write_text(path, json.dumps(content, indent=1, allow_nan=False) + "\n")
    known[path.relative_to(manifest.parent).as_posix()] = sha256_of(path)
    write_text(manifest, json.dumps({**whole, KEY: dict(sorted(known.items()))}, indent=1) + "\n")
    return path


def _manifest_of(folder: Path) -> Path:
    """The manifest beside the answer, or that of the folder above, when it lists files of this one."""
    above = folder.resolve().parent / NAME
    earlier = None if (folder / NAME).exists() else read_manifest(above)
    listed = earlier is not None and any(name.startswith(f"{folder.resolve().name}/") for name in earlier.sha256)
    return folder.parent / NAME if listed and folder.name not in ("", "..") else folder / NAME


def _free(folder: Path, stem: str, content: Mapping[str, Any], apart: tuple[str, ...], replace: bool) -> Path:
    for number in range(1, MOST):
        path = folder / (f"{stem}.json" if number == 1 else f"{stem}-{number}.json")
        if not path.exists() or replace or _said(path, apart) == _plain(content, apart):
            return path
    raise InputError(f"'{folder}' holds {MOST - 1} records; use --replace or remove some")


def _said(path: Path, apart: tuple[str, ...]) -> Any:
    try:
        return _plain(json.loads(path.read_text(encoding="utf-8")), apart)
    except (OSError, ValueError):
        return None


def _plain(content: Any, apart: tuple[str, ...]) -> Any:
    """The content as JSON gives it back, without the keys left apart."""
    if not isinstance(content, Mapping):
        return content
    return json.loads(json.dumps({key: value for key, value in content.items() if key not in apart}))
