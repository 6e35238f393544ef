"""A folder of presses that was made elsewhere: its files wait in one folder until they are a campaign."""

from __future__ import annotations

import csv
import io
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.measurement.campaign_file import FILE
from dummydesign.measurement.planning.from_files import COLUMNS, named_values
from dummydesign.studio.server import files

FOLDER = "measured/to-bring-in"
TABLE = "trials.csv"
KEYS = ("sequence", "thickness_mm", "velocity_mm_s", "target_force_N", "repeat", "age_days", "temperature_C", "rest_s")
"""Columns of the table that are filled in on the page."""
ENDINGS = (".csv", ".toml", ".txt", ".md", ".json", ".html")


def keep(root: Path, name: str, content: bytes) -> str:
    """Keep a file that was dropped, in the place of an earlier one of its name; return its name.

    Parameters
    ----------
    root : Path
        The project folder.
    name : str
        As sent.
    content : bytes
        The whole file.

    Raises
    ------
    InputError
        For a name that is not plain, or a kind of file that no campaign has.
    """
    from dummydesign.core.files import write_bytes

    if name != FILE:  # the one file of a meaning of its own that belongs here
        files.plain_name(name)
    if not name.lower().endswith(ENDINGS):
        raise InputError(f"a campaign has files of the kinds {', '.join(ENDINGS)}")
    try:
        files.inside(root, FOLDER).mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise InputError(f"folder '{FOLDER}' cannot be made: {problem.strerror or problem}") from None
    return write_bytes(root / FOLDER / name, content).name


def waiting(root: Path) -> list[str]:
    """Files that wait to be brought in."""
    return sorted(path.name for path in (root / FOLDER).glob("*") if path.is_file() and path.name[0] != ".")


def traces(root: Path) -> list[str]:
    """Presses among them."""
    return [name for name in waiting(root) if name.lower().endswith(".csv") and name != TABLE]


def has_campaign_file(root: Path) -> bool:
    """Whether ``campaign.toml`` is among them."""
    return (root / FOLDER / FILE).is_file()


def place_of(root: Path, name: str) -> str:
    """Folder of a new campaign.

    Raises
    ------
    InputError
        For a name that is not plain, or that is taken.
    """
    folder = f"campaigns/{files.plain_name(name.strip())}"
    if (root / folder).exists():
        raise InputError(f"'{folder}' is there already: choose another name")
    return folder


def bring_in(root: Path, name: str) -> str:
    """Make a campaign of the files as they are; return its folder from the project folder on.

    Raises
    ------
    InputError
        Without ``campaign.toml``, for one that is damaged, or a name that is taken; nothing is moved.
    """
    folder = place_of(root, name)
    try:
        tomllib.loads((root / FOLDER / FILE).read_text(encoding="utf-8-sig"))
    except (OSError, UnicodeDecodeError):
        raise InputError(f"{FILE} is not among the files, or is not UTF-8 text") from None
    except tomllib.TOMLDecodeError as problem:
        raise InputError(f"{FILE}: not valid TOML: {problem}") from None
    try:
        (root / folder).parent.mkdir(exist_ok=True)
        shutil.move(root / FOLDER, root / folder)
    except OSError as problem:
        raise InputError(f"'{folder}' cannot be made: {problem.strerror or problem}") from None
    return folder


def table(root: Path) -> list[dict[str, Any]]:
    """A row for each press: what its name says, and what a table of trials among the files says."""
    rows = []
    given = _given(root / FOLDER / TABLE)
    for name in traces(root):
        known: dict[str, Any] = {**named_values(Path(name)), **given.get(name, {})}
        rows.append({"file": name, **{key: known.get(key) for key in COLUMNS[1:]}})
    return rows


def _given(path: Path) -> dict[str, dict[str, Any]]:
    """Rows of a table of trials by file; numbers alone, cells that are none stay with the command to refuse."""
    try:
        lines = list(csv.DictReader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
    except (OSError, UnicodeDecodeError, csv.Error):
        return {}
    found: dict[str, dict[str, Any]] = {}
    for line in lines:
        row = {}
        for key in COLUMNS[1:]:
            cell = (line.get(key) or "").strip()
            if cell:
                row[key] = _cell(cell)
        found[(line.get("file") or "").strip()] = row
    return found


def _cell(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def write_table(root: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write the table that ``campaign from-files`` reads."""
    used = [key for key in COLUMNS if key == "file" or any(row.get(key) is not None for row in rows)]
    text = io.StringIO(newline="")
    out = csv.writer(text, lineterminator="\n")
    out.writerow(used)
    for row in rows:
        out.writerow(["" if (value := row.get(key)) is None else _text(value) for key in used])
    write_text(root / FOLDER / TABLE, text.getvalue())


def _text(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def words(root: Path, name: str, more: Sequence[str]) -> list[str]:
    """The command that makes a campaign of presses without ``campaign.toml``.

    Parameters
    ----------
    root : Path
        The project folder.
    name : str
        Of the campaign.
    more : sequence of str
        Further options.

    Raises
    ------
    InputError
        Without presses, or for a name that is taken.
    """
    presses = traces(root)
    if not presses:
        raise InputError("drop the files of the presses first")
    folder = place_of(root, name)
    return ["campaign", "from-files", folder, *(f"{FOLDER}/{one}" for one in presses),
            "--table", f"{FOLDER}/{TABLE}", *more]  # fmt: skip
