"""Write files so that a half-written one never stands under its final name."""

from __future__ import annotations

import os
import tempfile
from contextlib import suppress
from pathlib import Path
from secrets import token_hex

from dummydesign.core.errors import InputError


def output_folder(path: str | Path) -> Path:
    """Make the output folder if needed and try that it can be written, before any work starts.

    Raises
    ------
    InputError
        When the folder cannot be made or written to.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=folder, prefix=".try-"):
            pass
    except OSError as problem:
        raise InputError(f"output folder '{path}' cannot be written: {problem.strerror or problem}") from None
    return folder


def write_text(path: str | Path, text: str) -> Path:
    """Write ``text`` under a dotted temporary name beside ``path`` and rename it when complete."""
    return write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str | Path, content: bytes) -> Path:
    """Write ``content`` under a dotted temporary name beside ``path`` and rename it when complete.

    Raises
    ------
    InputError
        When the place cannot be written.
    """
    final = Path(path)
    # a name of its own for each writer: two that shared one renamed each other's half-written file
    part = final.with_name(f".{final.name[:40]}.{token_hex(8)}.part")
    try:
        with open(part, "xb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, final)
    except OSError as problem:
        raise InputError(f"file '{path}' cannot be written: {problem.strerror or problem}") from None
    finally:
        with suppress(OSError):
            part.unlink()
    return final
