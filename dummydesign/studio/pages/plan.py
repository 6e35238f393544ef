"""The plan of a campaign, and the values of each press in a table."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from nicegui import events, ui

from dummydesign.core.errors import InputError
from dummydesign.measurement.campaign_from_files import read_trials, write_trial_values
from dummydesign.studio import choices, jobs, made, parts
from dummydesign.studio import file_transfer as files
from dummydesign.studio.incoming_presses import FIELDS, plan_of, plan_options, usual_moulds
from dummydesign.studio.jobs import Job, options
from dummydesign.studio.parts import html
from dummydesign.studio.state import State, page_link
from dummydesign.studio.work_panel import Work

HEADS = {
    "sequence": "order", "thickness_mm": "pad [mm]", "velocity_mm_s": "speed [mm/s]", "target_force_N": "force [N]",
    "target_depth_mm": "depth [mm]", "hold_s": "hold [s]", "age_days": "age [days]",
    "temperature_C": "temperature [C]", "rest_s": "rest [s]", "repeat": "repeat",
}  # fmt: skip
CHANGED = "({target: t}) => { if (t.dataset.key) emit([Number(t.dataset.row), t.dataset.key, t.value]); }"


def number_of(text: str, name: str, key: str = "") -> float | None:
    """A typed number, with a dot or a comma; None for an empty field."""
    given = text.strip().replace(",", ".")
    if not given:
        return None
    try:
        value = float(given)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name} = '{text.strip()}' is not a number", "not_a_number", key or name, text.strip())
    return value


def table_html(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> str:
    """The table as HTML; each row has ``file`` and the keys, None where a value is unknown."""
    head = "".join(f"<th scope=col>{escape(HEADS[key])}</th>" for key in keys)
    body = ""
    for number, row in enumerate(rows):
        body += f"<tr><th scope=row>{escape(str(row['file']))}</th>"
        for key in keys:
            value = row.get(key)
            shown = f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else ""
            label = escape(f"{HEADS[key]} of {row['file']}")
            body += (f'<td><input inputmode="decimal" size="6" data-row="{number}" data-key="{key}" value="{shown}" '
                     f'aria-label="{label}"></td>')  # fmt: skip
        body += "</tr>"
    return (f'<div class="values"><table><thead><tr><th scope=col>press</th>{head}</tr></thead>'
            f"<tbody>{body}</tbody></table></div>")  # fmt: skip


def value_table(
    keys: Sequence[str], rows: Sequence[Mapping[str, Any]], changed: Callable[[int, str, str], bool]
) -> None:
    """Show the table."""
    shown = html(table_html(keys, rows)).style("width:100%")

    def typed(event: events.GenericEventArguments) -> None:
        row, key, text = event.args
        if key in keys and isinstance(row, int) and 0 <= row < len(rows):
            kept = changed(row, key, str(text))
            mark = "removeAttribute('aria-invalid')" if kept else "setAttribute('aria-invalid', true)"
            cell = f'#{shown.html_id} [data-row="{row}"][data-key="{key}"]'
            ui.run_javascript(f"document.querySelector('{cell}')?.{mark}")

    shown.on("change", typed, js_handler=CHANGED)


OFTEN = ("temperature_C", "age_days", "rest_s")
"""Values that often are the same for a whole day."""
ALL = "all presses"


class TrialTable:
    """The table of a campaign; each value is written into ``campaign.toml`` when it was typed."""

    def __init__(self, folder: Path, then: Callable[[], None]) -> None:
        """Build it."""
        self.folder, self.then = folder, then
        html("<p>Empty means unknown. Each value is written into campaign.toml when you leave its field.</p>")
        with ui.element("div").classes("fields"):
            self.day = parts.select("Fill in for", {ALL: ALL}, ALL, "fill-day")
            self.key = parts.select("Value", {key: HEADS[key] for key in OFTEN}, OFTEN[0], "fill-key")
            self.value = ui.input("The same for all of them").props('data-test="fill-value"')
            parts.button("Fill in", self.fill, "fill")
        self.message, self.table = parts.area("values-said", live=True), parts.area()
        self.read()

    def read(self) -> None:
        """Show the file as it is now."""
        self.rows = read_trials(self.folder)
        days = [ALL, *days_of(self.rows)]
        self.day.set_options(days, value=self.day.value if self.day.value in days else ALL)
        aim = "target_depth_mm" if all(row["target_force_N"] is None for row in self.rows) else "target_force_N"
        keys = ("sequence", "thickness_mm", "velocity_mm_s", aim, "age_days", "temperature_C", "rest_s")
        with parts.fresh(self.table):
            value_table(keys, self.rows, self.changed)

    def changed(self, row: int, key: str, text: str) -> bool:
        """Write one value; return whether it was kept."""
        file = self.rows[row]["file"]
        with parts.problems_in(self.message):
            self.write({row: {key: number_of(text, f"{file}: {key}", key)}}, f"{HEADS[key]} of {file} is kept.")
            return True
        return False

    def fill(self) -> None:
        """Write one value for all presses of a day."""
        rows, key = rows_of(self.rows, self.day.value), str(self.key.value)
        with parts.problems_in(self.message):
            value = number_of(str(self.value.value or ""), key)
            self.write({row: {key: value} for row in rows}, f"{HEADS[key]} of {len(rows)} presses is kept.")
            self.read()

    def write(self, changes: Mapping[int, Mapping[str, float | None]], words: str) -> None:
        """Write values where the presses are still those of the table."""
        if [row["file"] for row in read_trials(self.folder)] != [row["file"] for row in self.rows]:
            message = "campaign.toml was changed meanwhile: load the page again"
            raise InputError(message, "changed_meanwhile", "campaign.trials")
        write_trial_values(self.folder, changes)
        for row, values in changes.items():
            self.rows[row].update(values)
        with self.message:
            html(f'<p class="note">{escape(words)}</p>')
        self.then()


def days_of(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Days of pressing by the pads' age, in the order of the table."""
    return list(dict.fromkeys(day for row in rows if (day := _day(row))))


def rows_of(rows: Sequence[Mapping[str, Any]], day: str) -> list[int]:
    """Numbers of the rows of a day."""
    return [number for number, row in enumerate(rows) if day == ALL or _day(row) == day]


def _day(row: Mapping[str, Any]) -> str:
    age = row.get("age_days")
    return f"the day at {age:g} days of age" if isinstance(age, int | float) else ""


MOULDED, TYPED = "the moulds of this project", "typed here"


class PlanForm:
    """Fields of a plan and the command that makes it."""

    def __init__(self, root: Path, state: State, replaced: str = "") -> None:
        """Build it."""
        self.root, self.state, self.replaced = root, state, replaced
        name = "replan" if replaced else "campaign"
        usual = [] if replaced else usual_moulds(root, state)
        given: dict[str, Any] = {**FIELDS, "moulds": usual, "resin": state.resin, "ratio": state.ratio,
                                 "punch": state.punch, **(plan_of(root, replaced) if replaced else {})}  # fmt: skip
        self.punch = given["punch"]
        known = {one.folder: f"{one.folder.partition('/')[2]}: {one.label}" for one in reversed(made.moulds(root))}
        self.fields: dict[str, Any] = {}

        def add(key: str, label: str) -> None:
            self.fields[key] = ui.input(label, value=str(given[key]))

        with ui.element("div").classes("fields"):
            if not replaced:
                self.name = ui.input("Name", value=choices.free_name(root, "campaigns", "first"))
                self.name.props('data-test="plan-name"').on_value_change(self.renew)
            sources = {one: one for one in ((MOULDED, TYPED) if known else (TYPED,))}
            self.source = parts.select("Pads are those of", sources, MOULDED if usual else TYPED, f"{name}-source")
        self.moulds = parts.select_several("Moulds", known, usual, f"{name}-moulds")
        self.typed = ui.element("div").classes("fields")
        with self.typed:
            add("pads", "Pads, thickness [mm]")
            add("shape", "Shape with its lengths")
            add("pad", "Outline, length x width [mm]")
            self.fields["resin"] = parts.select("Resin", choices.resins(), given["resin"])
            self.fields["ratio"] = ui.number("Ratio", value=given["ratio"], step=0.1)
        with ui.element("div").classes("fields"):
            add("speeds", "Speeds [mm/s]")
            add("forces", "Steady forces [N]")
            self.fields["repeats"] = ui.number("Repeats", value=given["repeats"], min=1, max=9, step=1)
            add("ages", "Age of the pads on each day [days]")
            self.fields["hold"] = ui.number("Hold [s]", value=given["hold"], min=1, max=600)
        for key in ("pads", "shape", "speeds", "forces", "repeats", "ages"):
            self.fields[key].props(f'data-test="{"re" if replaced else ""}plan-{key}"')
        label = "Change the plan" if replaced else "Plan it"
        self.work = Work(root, name, label, self.words, self.show, self.belongs, needs="trials")
        parts.on_change(self.renew, self.source, self.moulds, *self.fields.values())
        self.renew()

    def renew(self) -> None:
        """Something was chosen."""
        moulded = self.source.value == MOULDED
        self.moulds.set_visibility(moulded)
        self.typed.set_visibility(not moulded)
        self.work.renew()

    def words(self) -> list[str]:
        """The plan as a command."""
        given: dict[str, Any] = {key: field.value for key, field in self.fields.items()}
        for key in ("repeats", "ratio"):
            if given[key] is None:
                raise InputError(f"{key} is empty", "missing", key)
        moulds = list(self.moulds.value or []) if self.source.value == MOULDED else []
        if self.source.value == MOULDED and not moulds:
            raise InputError("choose the moulds whose pads are pressed", "missing", "moulds")
        given |= {"moulds": moulds, "punch": self.punch, "repeats": int(given["repeats"])}
        folder = self.replaced or f"campaigns/{files.plain_name((self.name.value or '').strip())}"
        return ["campaign", "new", folder, *options(plan_options(given) | {"replace": bool(self.replaced)})]

    def belongs(self, job: Job, words: list[str]) -> bool:
        """Whether a job made the plan that is chosen, and it is still there."""
        folder = folder_of(job)
        there = not folder or ((self.root / folder).is_dir() and jobs.is_last(self.root, job, folder_of))
        return list(job.words) == words and there

    def show(self, job: Job) -> None:
        """What was planned."""
        answer, folder = job.answer, folder_of(job)
        html(f'<p data-test="planned">{len(answer["trials"])} presses planned in {escape(folder)}</p>')
        if power := answer.get("power"):
            html(f"<p>Effects that this plan can detect: {escape(', '.join(power['seen']) or 'none')}.</p>")
        parts.warnings(answer)
        link = page_link("/campaign", "Go on to the presses", self.state.changed(campaign=folder), "presses")
        html(f'<p class="note">{link}</p>')


def folder_of(job: Job) -> str:
    """Folder of the campaign that a command made; empty where it has no answer."""
    return str(job.answer.get("inputs", {}).get("folder", ""))
