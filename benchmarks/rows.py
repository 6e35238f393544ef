"""Rows of a study that can be stopped and resumed, one JSON object a line; CSV files; a folder that is gone after."""

from __future__ import annotations

import csv
import io
import json
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path


def read_rows(path: Path) -> list[dict]:
    """Rows that were kept, in their order; none without a file."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def keep_row(path: Path, row: dict) -> None:
    """Add a row to the file."""
    with path.open("a") as stream:
        stream.write(json.dumps(row) + "\n")


def write_csv(path: Path, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table of ``docs/data``."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([head, *rows])
    path.write_text(out.getvalue(), encoding="utf-8")


@contextmanager
def scratch(prefix: str) -> Iterator[Path]:
    """A folder to work in, removed at the end whatever happens."""
    folder = Path(tempfile.mkdtemp(prefix=prefix))
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
