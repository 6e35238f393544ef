"""One file up to three columns in s, mm and N: text, layout, columns, units, times."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from numpy.typing import NDArray

from dummydesign.core.errors import InputError
from dummydesign.measurement.importing.columns.absent import refuse_absent
from dummydesign.measurement.importing.columns.roles import Column, candidates, choose, describe_columns, wanted
from dummydesign.measurement.importing.columns.scales import factors
from dummydesign.measurement.importing.columns.times import recordings
from dummydesign.measurement.importing.core.decisions import Notes, Settings
from dummydesign.measurement.importing.core.vocabulary import ROLES
from dummydesign.measurement.importing.text.body import read_body
from dummydesign.measurement.importing.text.encoding import decode
from dummydesign.measurement.importing.text.layout import Layout, find_layout
from dummydesign.measurement.importing.text.spreadsheet import is_workbook, workbook_text

MIN_SAMPLES = 10


@dataclass(frozen=True)
class Columns:
    """The three columns as the file counts them, in s, mm and N.

    ``recordings`` are half-open ranges of samples: the time begins again in each. ``sources`` is the layout and the
    columns, for a profile.
    """

    file: str
    time_s: NDArray
    displacement_mm: NDArray
    force_N: NDArray
    recordings: tuple[tuple[int, int], ...]
    layout: Layout
    chosen: dict[str, Column]


def read_columns(path: Path, settings: Settings, notes: Notes) -> Columns:
    """Read time, displacement and force of a file as a test machine wrote it.

    Parameters
    ----------
    path : Path
        The file.
    settings : Settings
        What the user settled.
    notes : Notes
        Receives the decisions.

    Returns
    -------
    Columns

    Raises
    ------
    InputError
        With file, and line where there is one, and what to do.
    QuestionError
        Where the file leaves something open, with the option that settles it.
    """
    file = path.name
    data = _bytes(path)
    text = workbook_text(file, data, notes) if is_workbook(data) else decode(file, data, settings.encoding, notes)
    layout = find_layout(file, text, settings, notes)
    columns = describe_columns(layout)
    found = candidates(layout, columns, settings)
    refuse_absent(layout, columns, found)
    indices = wanted(found, columns)
    body = read_body(layout, indices, notes)
    if len(body.values) < MIN_SAMPLES:
        raise InputError(f"{file}: {len(body.values)} rows of numbers; a press needs at least {MIN_SAMPLES}")
    values = dict(zip(indices, body.values.T))
    chosen = choose(layout, columns, found, values, settings, notes)
    raw = {role: values[column.index] for role, column in chosen.items()}
    scale = factors(file, chosen, raw, settings, notes)
    first = float(raw["time"][0])
    time = (raw["time"] - first) * scale["time"] if abs(first) > 1e6 else raw["time"] * scale["time"]
    keep, ranges = recordings(file, time, body.values, body.breaks, body.lines, notes)
    x, force = raw["displacement"] * scale["displacement"], raw["force"] * scale["force"]
    return Columns(
        file, time[keep], x[keep], force[keep], tuple(ranges), layout, {role: chosen[role] for role in ROLES}
    )


def _bytes(path: Path) -> bytes:
    """The file's content; refused when it changes while it is read."""
    try:
        before = path.stat()
        data = path.read_bytes()
        after = path.stat()
    except FileNotFoundError:
        raise InputError(f"file '{path}' does not exist") from None
    except OSError as problem:
        raise InputError(f"{path.name}: cannot be read: {problem.strerror or problem}") from None
    if (before.st_size, before.st_mtime_ns) != (after.st_size, after.st_mtime_ns) or len(data) != after.st_size:
        raise InputError(f"{path.name}: is being written just now; wait for the test to end")
    return data
