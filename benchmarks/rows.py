"""Rows of a study that can be stopped and resumed, one JSON object a line; CSV files; a folder that is gone after."""

from __future__ import annotations

import csv
import io
import json
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

from studies.marked_page import MarkedPage, wrapped

ROOT = Path(__file__).resolve().parents[1]

R = TypeVar("R", bound=Any)
"""A dataclass with the fields ``seed`` and ``number``."""


def write_evidence(name: str, made: str) -> None:
    """Write a study's part of the page of evidence."""
    page = MarkedPage(Path("docs", "evidence.md"), f"<!-- {name} begin -->", f"<!-- {name} end -->")
    page.write(ROOT, wrapped(made))


def read_rows(path: Path) -> list[dict]:
    """Rows that were kept, in their order; none without a file."""
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def keep_row(path: Path, row: dict) -> None:
    """Add a row to the file."""
    with path.open("a") as stream:
        stream.write(json.dumps(row) + "\n")


def resume(path: Path, seed: int, count: int, row_type: type[R], run: Callable[[int, int], R]) -> list[R]:
    """Rows of a seed: those that were kept, and those that were not yet run, each kept and printed when it is there."""
    rows = [row_type(**row) for row in read_rows(path) if row["seed"] == seed]
    done = {row.number for row in rows}
    for number in range(count):
        if number not in done:
            rows.append(run(number, seed))
            keep_row(path, asdict(rows[-1]))
            print(json.dumps(asdict(rows[-1])), flush=True)
    return rows


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
