"""Several files or a folder at once: which files, one answer for all, and the traces that are written."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_bytes
from dummydesign.measurement.importing.core.decisions import NoTableError, Settings
from dummydesign.measurement.importing.read import Imported, Press, import_file
from dummydesign.measurement.trace import COLUMNS, SECONDS, magnitude_fault

ENDINGS = (".csv", ".txt", ".dat", ".tsv", ".asc", ".tra", ".log", ".lst", ".prn", ".lvm", ".xlsx", ".xls")
_ROWS = 50_000
Planned = tuple[Imported, Press, str]
"""A press, the file it comes from, and the name of its trace."""


def files_of(paths: Iterable[str | Path]) -> list[tuple[Path, bool]]:
    """List the files that are meant; a folder stands for its files with the usual endings.

    Returns
    -------
    list of (path, from a folder)

    Raises
    ------
    InputError
        When a path does not exist, or a folder holds no such file.
    """
    found: list[tuple[Path, bool]] = []
    for name in paths:
        path = Path(name)
        if path.is_dir():
            try:
                inside = sorted(p for p in path.iterdir() if p.is_file() and not p.name.startswith("."))
            except OSError as problem:
                raise InputError(f"folder '{path}' cannot be read: {problem.strerror or problem}") from None
            inside = [p for p in inside if p.suffix.lower() in ENDINGS]
            if not inside:
                raise InputError(f"folder '{path}' holds no file that may be a trace ({', '.join(ENDINGS)})")
            found += [(p, True) for p in inside]
        elif not path.exists():
            raise InputError(f"file '{path}' does not exist")
        else:
            found.append((path, False))
    unique: dict[Path, tuple[Path, bool]] = {}
    for path, in_folder in found:
        unique.setdefault(path.resolve(), (path, in_folder))
    return list(unique.values())


def import_files(
    paths: Sequence[str | Path], settings: Settings | None = None
) -> tuple[list[Imported], list[dict[str, Any]]]:
    """Read several files and folders.

    Returns
    -------
    imported : list of Imported
    warnings : list of {code, message}
        Of all of them together: files of a folder that hold no table, presses that two files share.

    Raises
    ------
    InputError, QuestionError
        The first one that a file gives, with the number of other files that have one too. Nothing is left out
        silently.
    """
    imported: list[Imported] = []
    warnings: list[dict[str, Any]] = []
    problems: list[InputError] = []
    listed = files_of(paths)
    for path, inside in listed:
        try:
            imported.append(import_file(path, settings))
        except NoTableError as problem:
            if not inside:
                problems.append(problem)
                continue
            warnings.append({"code": "skipped", "message": f"{path.name} is left out: it holds no table of numbers"})
        except InputError as problem:
            problems.append(problem)
    if problems:
        more = f" (and {len(problems) - 1} of {len(listed)} files more have such a doubt)" if len(problems) > 1 else ""
        raise type(problems[0])(f"{problems[0]}{more}")
    if not imported:
        raise InputError(f"none of the {len(listed)} files holds a table of numbers")
    return imported, warnings + _same_presses(imported)


def _same_presses(imported: Sequence[Imported]) -> list[dict[str, Any]]:
    """Presses that stand in two files word for word: one subject under two names, or a copy."""
    seen: dict[str, tuple[Path, int]] = {}
    warnings = []
    for one in imported:
        for press in one.presses:
            rounded = np.round(np.stack([press.displacement_mm, press.force_N]), 4)
            key = hashlib.sha256(rounded.tobytes()).hexdigest()
            if key in seen and seen[key][0] != one.source:
                source, number = seen[key]
                warnings.append(
                    {
                        "code": "same_press",
                        "message": f"{one.source.name} press {press.number} is the same recording as {source.name} "
                        f"press {number}: one subject under two names, or a copy? take one of them out",
                    }
                )
            seen.setdefault(key, (one.source, press.number))
    return warnings


def plan_traces(imported: Sequence[Imported], folder: Path | None) -> list[Planned]:
    """Choose the file name of every press.

    Raises
    ------
    InputError
        When a trace would take the place of a file that was read: nothing of a source is changed.
    """
    sources = {one.source.resolve() for one in imported}
    taken: set[str] = set()
    planned = []
    for one in imported:
        for press in one.presses:
            name = _name(one.source, press.number, taken)
            if folder is not None and (folder / name).resolve() in sources:
                raise InputError(f"trace '{name}' would take the place of a file that is read; give another --out")
            planned.append((one, press, name))
    return planned


def write_traces(planned: Sequence[Planned], folder: Path) -> None:
    """Write one canonical CSV a press into a folder."""
    for _, press, name in planned:
        columns = press.time_s, press.displacement_mm, press.force_N
        # a doubt that is left was settled by the user
        write_bytes(folder / name, trace_bytes(*columns, settled=bool(magnitude_fault(*columns))))


def describe(imported: Sequence[Imported], planned: Sequence[Planned]) -> list[dict[str, Any]]:
    """Say what became of each file: ``source``, ``traces`` (names without their folder), ``decisions``, "
    "``warnings``."""
    return [
        {
            "source": str(one.source),
            "traces": [
                {"file": name, "press": press.number, "samples": len(press.time_s), **press.summary.to_dict()}
                for owner, press, name in planned
                if owner is one
            ],
            "decisions": [decision.to_dict() for decision in one.decisions],
            "warnings": list(one.warnings),
        }
        for one in imported
    ]


def _name(source: Path, number: int, taken: set[str]) -> str:
    """A plain name: the source's, and the number of the press; another count behind it where two sources share one."""
    stem = re.sub(r"[^\w.-]+", "_", source.stem).strip("._") or "trace"
    name, count = f"{stem[:100]}_{number}.csv", 1
    while name.lower() in taken:
        count += 1
        name = f"{stem[:100]}-{count}_{number}.csv"
    taken.add(name.lower())
    return name


def trace_bytes(time_s: NDArray, displacement_mm: NDArray, force_N: NDArray, settled: bool = False) -> bytes:
    """The canonical CSV, to a microsecond, a nanometre and a micronewton.

    Parameters
    ----------
    time_s, displacement_mm, force_N : ndarray, shape (n,)
        A press in the project's units. [s, mm, N]
    settled : bool
        Whether a column is added that says that time is in seconds, however slow the press.

    Returns
    -------
    bytes
    """
    rows = np.stack([time_s, displacement_mm, force_N, *([np.ones_like(time_s)] if settled else [])], axis=1)
    parts = [_digits(rows[start : start + _ROWS]) for start in range(0, len(rows), _ROWS)]
    head = (*COLUMNS, SECONDS) if settled else COLUMNS
    return b"".join([(",".join(head) + "\n").encode("ascii"), *parts])


def _digits(rows: NDArray) -> bytes:
    """Numbers with six decimals, parted by commas and line ends; digit by digit in arrays, four times faster than "
    "``%``."""
    counts = np.rint(rows * 1e6).astype(np.int64)
    size = np.abs(counts)
    places = max(len(str(int(size.max()))), 7)
    text = np.zeros((*rows.shape, places + 3), np.uint8)
    text[..., 0] = np.where(counts < 0, ord("-"), 0)
    at = places + 1
    for place in range(places):
        if place == 6:
            text[..., at] = ord(".")
            at -= 1
        # A zero before the first digit stays a zero byte, which is taken out below.
        text[..., at] = np.where((size > 0) | (place <= 6), size % 10 + ord("0"), 0)
        size = size // 10
        at -= 1
    text[..., -1] = ord(",")
    text[:, -1, -1] = ord("\n")
    return text[text > 0].tobytes()
