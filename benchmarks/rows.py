"""Rows of a study that can be stopped and resumed: one JSON object a line; and a folder that is gone afterwards."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


def read_rows(path: Path) -> list[dict]:
    """Rows that were kept, in their order; none without a file."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def keep_row(path: Path, row: dict) -> None:
    """Add a row to the file."""
    with path.open("a") as stream:
        stream.write(json.dumps(row) + "\n")


@contextmanager
def scratch(prefix: str) -> Iterator[Path]:
    """A folder to work in, removed at the end whatever happens."""
    folder = Path(tempfile.mkdtemp(prefix=prefix))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
