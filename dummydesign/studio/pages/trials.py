"""What is known of each press of a campaign, in a table: order, pad, speed, force, age, temperature, rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.measurement.planning.trial_values import read_trials, write_trial_values
from dummydesign.studio.frame import html, tell_problem
from dummydesign.studio.pages.value_table import HEADS, number_of, value_table

OFTEN = ("temperature_C", "age_days", "rest_s")
"""Values that often are the same for a whole day."""
ALL = "all presses"


class TrialTable:
    """The table of a campaign; each value is written into ``campaign.toml`` when it was typed."""

    def __init__(self, folder: Path, then: Callable[[], None]) -> None:
        """Build it.

        Parameters
        ----------
        folder : Path
            Of the campaign.
        then : callable
            Called after values were written.
        """
        self.folder, self.then = folder, then
        html("<p>Empty means unknown. Each value is written into campaign.toml when you leave its field.</p>")
        with ui.element("div").classes("fields"):
            self.day = ui.select([ALL], value=ALL, label="Fill in for").props('data-test="fill-day"')
            self.key = ui.select({key: HEADS[key] for key in OFTEN}, value=OFTEN[0], label="Value")
            self.value = ui.input("The same for all of them").props('data-test="fill-value"')
            ui.button("Fill in", on_click=self.fill, color=None).props('outline data-test="fill"')
        self.key.props('data-test="fill-key"')
        self.words = ui.element("div").props('role="status" aria-live="polite" data-test="values-said"')
        self.place = ui.element("div").style("width:100%")
        self.rows: list[dict[str, Any]] = []
        self.read()

    def read(self) -> None:
        """Show the file as it is now."""
        self.rows = read_trials(self.folder)
        days = [ALL, *days_of(self.rows)]
        self.day.set_options(days, value=self.day.value if self.day.value in days else ALL)
        by_depth = all(row["target_force_N"] is None for row in self.rows)
        aim = "target_depth_mm" if by_depth else "target_force_N"
        self.place.clear()
        with self.place:
            value_table(("sequence", "thickness_mm", "velocity_mm_s", aim, *("age_days", "temperature_C", "rest_s")),
                        self.rows, self.changed)  # fmt: skip

    def changed(self, row: int, key: str, text: str) -> bool:
        """Write one value; return whether it was kept.

        Parameters
        ----------
        row : int
            Of the table.
        key : str
            Of the value.
        text : str
            As typed.
        """
        file = self.rows[row]["file"]
        try:
            self.write({row: {key: number_of(text, f"{file}: {key}")}}, f"{HEADS[key]} of {file} is kept.")
        except InputError as problem:
            self.tell(str(problem))
            return False
        return True

    def fill(self) -> None:
        """Write one value for all presses of a day."""
        rows = rows_of(self.rows, self.day.value)
        key = str(self.key.value)
        try:
            value = number_of(str(self.value.value or ""), key)
            self.write({row: {key: value} for row in rows}, f"{HEADS[key]} of {len(rows)} presses is kept.")
        except InputError as problem:
            self.tell(str(problem))
            return
        self.read()

    def write(self, changes: Mapping[int, Mapping[str, float | None]], words: str) -> None:
        """Write values where the presses are still those of the table."""
        now = [row["file"] for row in read_trials(self.folder)]
        if now != [row["file"] for row in self.rows]:
            raise InputError("campaign.toml was changed meanwhile: load the page again")
        write_trial_values(self.folder, changes)
        for row, values in changes.items():
            self.rows[row].update(values)
        self.words.clear()
        with self.words:
            html(f'<p class="note">{escape(words)}</p>')
        self.then()

    def tell(self, problem: str) -> None:
        """Say why a value was refused."""
        self.words.clear()
        with self.words:
            tell_problem(f"Not kept: {problem}")


def days_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Days of pressing by the pads' age, in the order of the table."""
    return list(dict.fromkeys(day for row in rows if (day := _day(row))))


def rows_of(rows: Sequence[Mapping[str, Any]], day: str) -> list[int]:
    """Numbers of the rows of a day."""
    return [number for number, row in enumerate(rows) if day == ALL or _day(row) == day]


def _day(row: Mapping[str, Any]) -> str:
    age = row.get("age_days")
    return f"the day at {age:g} days of age" if isinstance(age, int | float) else ""
