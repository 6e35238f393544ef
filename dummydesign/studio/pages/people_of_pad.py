"""What the presses of a cast pad would have been on people: drive, limits of one's own, and the answer."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.core.parsing import Purpose
from dummydesign.person.drives import DRIVES, read_drive
from dummydesign.report.on_person_facts import (
    headline,
    limit_name,
    limit_rows,
    mismatch,
    number_text,
    press_table,
    span_text,
)
from dummydesign.studio import file_transfer as transfer
from dummydesign.studio import parts
from dummydesign.studio.jobs import options
from dummydesign.studio.made import PressedPad
from dummydesign.studio.manage import DropList
from dummydesign.studio.page_frame import Studio
from dummydesign.studio.parts import html
from dummydesign.studio.work_panel import Work

LIMITS = "limits"
"""Folder of a project with the user's own limits."""
LIGHTS = {"pass": "green", "undecided": "amber", "fail": "red"}
SHORT = {"position": "the arm keeps its path", "steady": "the same steady force", "force": "the arm keeps its force",
         "mass": "a free body", "spring": "an arm with a spring and a mass"}  # fmt: skip


class PeopleOfPad:
    """Drive, limits, and what the presses would have been on people."""

    def __init__(self, studio: Studio, pad: Callable[[], PressedPad | None], presses: Callable[[], list[str]],
                 tissue: Callable[[], str]) -> None:  # fmt: skip
        self.root, self._pad, self._presses, self._tissue = studio.root, pad, presses, tissue
        html("<h2>The same presses on people</h2>")
        html("<p>What the robot would have done to people with the press it made on the pad. The result depends on "
             "what moves the robot.</p>")  # fmt: skip
        with ui.element("div").classes("fields"):
            known = {name: f"{name}: {SHORT[name]}" if name in SHORT else name for name in DRIVES}
            self.drive = parts.select("What moves the robot", known, "position", "drive")
            self.numbers: dict[str, ui.number] = {}
            for purpose, usual in _numbers().items():
                name = purpose.quantity.partition(" in ")[0]
                label = f"{name[0].upper()}{name[1:]}" + (f" [{purpose.unit}]" if purpose.unit else "")
                self.numbers[purpose.quantity] = ui.number(label, value=usual, min=0).props(f'data-test="drive-{name}"')
            self.limits = parts.select("Your limits", self._known_limits(), "", "limits")
        DropList(self._keep_limits, self._find_limits, "Drop your limits of force and pressure with their source: "
                 "a TOML file as 'suggest --limits' takes it.", "limits")  # fmt: skip
        self.work = Work(studio, "on-person", "Compute the presses on people", self.words,
                         lambda job: show_people(self.root, job.answer))  # fmt: skip
        self.drive.on_value_change(self._new_drive)
        parts.on_change(self.work.renew, self.limits, *self.numbers.values())
        self._new_drive()

    def words(self) -> list[str]:
        """The command of what is chosen."""
        pad, presses = self._pad(), self._presses()
        if pad is None or not presses:
            raise InputError("choose the presses of a pad, or drop them above", "missing", "trace")
        values = [self._number(purpose.quantity) for purpose, _ in DRIVES[self.drive.value].numbers]
        drive = ":".join([self.drive.value, ",".join(values)] if values else [self.drive.value])
        given = {"tissue": self._tissue(), "drive": read_drive(drive).text, "limits": self.limits.value,
                 "lowpass": pad.lowpass, "punch": pad.punch,
                 "out": f"designs/on-person-{Path(self._tissue()).stem}"}  # fmt: skip
        return ["on-person", *presses, *options(given)]

    def _number(self, name: str) -> str:
        value = self.numbers[name].value
        if value is None:
            raise InputError(f"{name} is empty: give it", "missing", "drive")
        return f"{value:g}"

    def _new_drive(self) -> None:
        wanted = [purpose.quantity for purpose, _ in DRIVES[self.drive.value].numbers]
        for name, field in self.numbers.items():
            field.set_visibility(name in wanted)
        self.work.renew()

    def _known_limits(self) -> dict[str, str]:
        paths = sorted((self.root / LIMITS).glob("*.toml"))
        return {"": "none"} | {path.relative_to(self.root).as_posix(): path.stem for path in paths}

    def _find_limits(self) -> None:
        known = self._known_limits()
        self.limits.set_options(known, value=self.limits.value if self.limits.value in known else "")

    def _keep_limits(self, name: str, content: bytes) -> str:
        """Keep a file of limits that can be read, and choose it."""
        from dummydesign.design.safety import read_limits

        if Path(transfer.plain_name(name)).suffix.lower() != ".toml":
            raise InputError("choose a file that ends in .toml", "unknown_name", "file_ending", name, ".toml")
        with tempfile.TemporaryDirectory() as away:
            path = Path(away) / name
            path.write_bytes(content)
            read_limits(path)
        kept = transfer.save_upload(transfer.inside(self.root, LIMITS), name, content)
        chosen = kept.relative_to(self.root).as_posix()
        self.limits.set_options(self._known_limits(), value=chosen)
        return f"{chosen} was added."


def _numbers() -> dict[Purpose, float | None]:
    """Numbers of all drives, with the default of those that may be left out."""
    numbers: dict[Purpose, float | None] = {}
    for drive in DRIVES.values():
        usual = [None] * (len(drive.numbers) - len(drive.defaults)) + list(drive.defaults)
        numbers |= {purpose: value for (purpose, _), value in zip(drive.numbers, usual)}
    return numbers


def show_people(root: Path, answer: Mapping[str, Any]) -> None:
    """Result, presses, limits, warnings and the report of an answer of ``on-person``."""
    if "presses" not in answer or "drive" not in answer:
        return
    files, result = answer.get("files") or {}, dict(answer)
    parts.tell_changes(root, str(files.get("manifest") or ""), "Compute them again.")
    word, text = headline(result)
    wrong = mismatch(result)
    if wrong:
        parts.tell_verdict("amber", f"CAUTION. {wrong}", test="drive-mismatch")
    if word in LIGHTS:
        parts.tell_verdict(LIGHTS[word], f"{word.upper()}. {text}", test="people")
    else:
        html(f'<p data-test="people">{escape(text)}</p>')
    parts.table(*press_table(result))
    rows = [[row["result"].upper(), limit_name(row), row["limit"], row["unit"], number_text(row["pad"]),
             span_text([row["person_low_95"], row["person_high_95"]]), row["reason"], file]
            for row, file in limit_rows(result)]  # fmt: skip
    if rows:
        head = ["result", "limit of", "limit", "unit", "pad", "people, 95 %", "why", "press"]
        parts.table(head, rows, words=True)
    parts.warnings(answer)
    if files.get("report") and (root / files["report"]).is_file():
        parts.zip_link(Path(files["report"]).parent.as_posix())
        parts.shown_file(f"/files/{files['report']}", "report of the presses on people")
