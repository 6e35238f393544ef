"""The result file of a sweep: one line a design, appended and flushed, so that a stopped sweep can go on."""

from __future__ import annotations

import csv
import hashlib
import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError
from dummydesign.core.files import write_text
from dummydesign.design.sweep.rows import SCORES
from dummydesign.design.sweep.spec import Key, Study

ROWS, SETTINGS = "rows.csv", "study.json"
_NAMED = ("thickness_mm", "ratio", "punch", "condition", "base", "shape", "edge_radius_mm")
_TEXT = ("punch", "condition", "base", "shape", "limit")
_BY_FORCE = ("exponent", "depth_mm", "depth_over_thickness", "stiffness_N_per_mm")


class RowFormat:
    """Columns of a study's rows; nested values become one column a key, such as ``depth_mm_at_5_N``."""

    def __init__(self, study: Study) -> None:
        # where each column's value is in a row
        self.paths: dict[str, tuple[str, ...]] = {name: (name,) for name in (*_NAMED, "young_kPa")}
        for name in _BY_FORCE:
            for force in study.forces_N:
                self.paths[f"{name}_at_{force:g}_N"] = (f"{name}_at_N", f"{force:g}")
        for speed in study.velocities_mm_s:
            self.paths[f"peak_over_steady_at_{speed:g}_mm_s"] = ("peak_over_steady", f"{speed:g}")
        self.paths |= {name: (name,) for name in ("force_error_percent", "limit")}
        if study.tissue is not None:
            self.paths |= {f"score_{name}": ("score", name) for name in SCORES}
        self.columns = list(self.paths)

    def header(self) -> str:
        """First line of the file, with its end."""
        return _line(self.columns)

    def text(self, rows: Iterable[dict[str, Any]]) -> str:
        """Lines of the given rows; numbers in full, so that what is read back is what was worked out."""
        lines = []
        for row in rows:
            values = (row[at[0]] if len(at) == 1 else row[at[0]][at[1]] for at in self.paths.values())
            lines.append(["" if v is None else repr(v) if isinstance(v, float) else v for v in values])
        return _line(*lines)

    def row(self, fields: list[str]) -> dict[str, Any] | None:
        """Row from the fields of a line; None when they are not one."""
        if len(fields) != len(self.columns):
            return None
        row: dict[str, Any] = {}
        try:
            for at, field in zip(self.paths.values(), fields):
                value = (field or None) if at[0] in _TEXT else (float(field) if field else None)
                if len(at) == 1:
                    row[at[0]] = value
                else:
                    row.setdefault(at[0], {})[at[1]] = value
        except ValueError:
            return None
        return row if all(row[name] is not None for name in _NAMED) else None


def _line(*rows: list[Any]) -> str:
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(rows)
    return stream.getvalue()


def key_of(row: dict[str, Any]) -> Key:
    """Name of a row's design."""
    names = ("punch", "condition", "base", "shape", "edge_radius_mm", "thickness_mm", "ratio")
    return tuple(row[name] for name in names)  # type: ignore[return-value]


class RowsFile:
    """Rows of a sweep on disk and in memory."""

    def __init__(self, folder: Path, study: Study, settings: dict[str, Any], resume: bool) -> None:
        self.path, self.format = folder / ROWS, RowFormat(study)
        self.rows: dict[Key, dict[str, Any]] = {}
        self.order = study.keys()
        if resume and self.path.is_file():
            _same_settings(folder / SETTINGS, settings)
            self._read()
        write_text(folder / SETTINGS, json.dumps(settings, indent=1) + "\n")
        self._replace(self.rows.values())
        self._stream = open(self.path, "a", encoding="utf-8", newline="")

    def _read(self) -> None:
        text = self.path.read_text(encoding="utf-8", errors="replace")
        lines = list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1])))
        if lines and lines[0] != self.format.columns:
            odd = next((a for a, b in zip(lines[0], self.format.columns) if a != b), lines[0][-1])
            raise InputError(
                f"{self.path.name}: its columns are those of another study (first difference: '{odd}'); "
                "use the same forces, speeds and tissue, or another --out", "inconsistent", "rows_file", odd,
            )  # fmt: skip
        for fields in lines[1:]:
            row = self.format.row(fields)
            if row is not None:
                self.rows.setdefault(key_of(row), row)

    def _replace(self, rows: Iterable[dict[str, Any]]) -> None:
        write_text(self.path, self.format.header() + self.format.text(rows))

    def add(self, rows: list[dict[str, Any]]) -> None:
        """Append rows that are not there yet, and flush."""
        new = [row for row in rows if key_of(row) not in self.rows]
        self.rows.update((key_of(row), row) for row in new)
        try:
            self._stream.write(self.format.text(new))
            self._stream.flush()
        except OSError as problem:
            message = f"file '{self.path}' cannot be written: {problem.strerror or problem}"
            raise InputError(message, "file_unwritable", "rows_file", str(self.path)) from None

    def close(self) -> None:
        """End writing; what is there stays and can be resumed."""
        self._stream.close()

    def finish(self) -> list[dict[str, Any]]:
        """Put the lines into the study's order, rows of a wider earlier study after them; return the study's."""
        self.close()
        rows = [self.rows[key] for key in self.order]
        if list(self.rows) != self.order:
            wanted = set(self.order)
            self._replace([*rows, *(row for key, row in self.rows.items() if key not in wanted)])
        return rows


def settings_of(study: Study, resin: Any, tissue: Any) -> dict[str, Any]:
    """Settings that rows in one file share: all but the lists that name designs; data by their hash."""
    from dummydesign._version import __version__

    settings = {
        "version": __version__,
        "fidelity": study.fidelity,
        "resin": f"{resin.name} {_hash(resin.to_dict())}",
        "tissue": None if tissue is None else f"{tissue.name} {study.aim} {_hash(tissue.to_dict())}",
        "forces_N": list(study.forces_N),
        "velocities_mm_s": list(study.velocities_mm_s),
        "hold_s": study.hold_s,
        "deceleration_mm_s2": study.deceleration_mm_s2,
    }
    if study.fidelity == "table":
        from dummydesign.geometry.interface import BASES
        from dummydesign.pad.tables.slab import load_table

        settings["tables"] = _hash({base: load_table(base).coefficients.tolist() for base in BASES})
    return settings


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True, default=str).encode()).hexdigest()[:16]


def _same_settings(path: Path, settings: dict[str, Any]) -> None:
    try:
        before = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise InputError(
            f"--resume: {path.name} beside {ROWS} cannot be read, so its rows cannot be trusted; "
            "run without --resume or into another --out", "file_unreadable", "resume",
        ) from None  # fmt: skip
    for name, value in settings.items():
        was = before.get(name)
        if was != value:
            raise InputError(
                f"--resume: {ROWS} was made with {name} = {was}, now {value}; "
                "run without --resume or into another --out", "inconsistent", name, value, was,
            )  # fmt: skip
