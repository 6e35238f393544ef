"""The campaign page: plan, print, drop the presses and say what they were; campaigns from elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from nicegui import background_tasks, run, ui

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.measurement.campaign_file import FILE
from dummydesign.measurement.campaign_presses import CampaignStatus, check_campaign, read_trials, write_trial_values
from dummydesign.project.folder import Project
from dummydesign.studio import file_transfer, jobs, project_index, select_options, trash, widgets
from dummydesign.studio.file_actions import DropList, manage, undo_bar
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.markup import Markup, filled, joined
from dummydesign.studio.state import State, page_link
from dummydesign.studio.widgets import NumberField, html, open_page


def show_campaigns(project: Project, state: State, query: Mapping[str, str]) -> None:
    """Build the page: the campaign that is chosen, then the two ways to a further one."""
    root = project.root
    known = select_options.campaigns(root)
    if known:
        chosen = widgets.select("Campaign", known, state.campaign, "campaign")
        chosen.on_value_change(lambda: open_page("/campaign", state.changed(campaign=chosen.value)))
    if (root / state.campaign / "campaign.toml").is_file():
        CampaignPresses(root, state)
    with widgets.fold("Plan a new campaign", "plan-new", opened=not known):
        PlanForm(root, state)
    with widgets.fold("Bring in a campaign that was pressed earlier", "bring-in"):
        html("<p>Copy its folder, with campaign.toml, into the folder campaigns. Then load this page again.</p>")
        html("<p>Without campaign.toml, a command makes it of the traces:</p>")
        words = ["campaign", "from-files", "campaigns/earlier", "traces/*.csv", "--resin", "NAME", "--ratio", "R"]
        widgets.command_line(words)


class CampaignPresses:
    """The presses of the campaign that is chosen."""

    def __init__(self, root: Path, state: State) -> None:
        self.root, self.state, self.campaign = root, state, state.campaign
        self.folder = self.root / self.campaign
        with ui.element("div").classes("pair"):
            self.status_area = widgets.area("state")
            with ui.element("div"):
                names = {str(trial["file"]): str(trial["file"]) for trial in read_trials(self.folder)}
                self.press = widgets.select(
                    "Press of the file", {"": "the one that the file is named after", **names}, "", "assign-to"
                )
                DropList(root, self.take, self.renew, "Drop the presses (CSV).")
        links = [
            ("the sheet to press from", f"{self.campaign}/{name}")
            for name in ("sheet.html", "sheet.csv")
            if (self.folder / name).is_file()
        ]
        with ui.element("div").classes("links"):
            widgets.file_links([*links, ("campaign.toml", f"{self.campaign}/campaign.toml")])
            widgets.zip_link(self.campaign)
        self.values = widgets.fold(
            "Values of the presses: order, age, temperature, rest",
            "values",
            lambda: TrialTable(root, self.campaign, self.renew),
        )
        self.change = widgets.area()
        manage(root, self.campaign, "plan")
        status = check_campaign(self.folder)
        self.show(status)
        if not status.pressed and plan_of(root, self.campaign):
            with self.change, widgets.fold("Change this plan: nothing was pressed yet", "replan"):
                PlanForm(root, state, self.campaign)

    def take(self, name: str, content: bytes) -> trash.Taken:
        """Take a file that was dropped."""
        taken = take_press(self.root, self.campaign, name, content, self.press.value)
        self.press.set_value("")
        return taken

    def renew(self) -> None:
        """Check the campaign anew, once for all that changed in the meantime."""
        background_tasks.create_lazy(self.check(), name=f"check {self.status_area.id} of {self.status_area.client.id}")

    async def check(self) -> None:
        """Check the campaign, apart from the page."""
        try:
            status = await run.io_bound(check_campaign, self.folder)
        except InputError as problem:
            with widgets.fresh(self.status_area):
                widgets.tell_problem(str(problem))
        else:
            if status is not None and not self.status_area.is_deleted:
                self.show(status)

    def show(self, status: CampaignStatus) -> None:
        """How far the campaign is, in words, and what comes next."""
        done, left = len(status.pressed), len(status.missing)
        if done:
            self.change.clear()
        with widgets.fresh(self.status_area):
            widgets.command_line(["campaign", "check", self.campaign])
            html('<p role="status"><b>{} of {} presses are there</b></p>', done, done + left)
            if left:
                html("<p>To press: {}{}</p>", ", ".join(status.missing[:6]), " …" * (left > 6))
            if status.wrong:
                widgets.records({"file": "file", "looks wrong": "message"}, status.wrong, words=True)
            if status.ready:
                widgets.go("/learn", "Learn from it", self.state, "learn")
            if done:
                link = page_link("/cast", "Check a cast pad", self.state, "cast")
                html("<p>{}: its presses against the tissue.</p>", link)
            widgets.warnings({"warnings": status.warnings})


def take_press(root: Path, campaign: str, name: str, content: bytes, planned: str = "") -> trash.Taken:
    """Take a press under its planned name: that which is chosen, else that of the file."""
    file_transfer.plain_name(name)
    folder = file_transfer.inside(root, campaign)
    plan = {trial["file"]: trial for trial in read_trials(root / campaign)}
    target = planned or name
    if target not in plan:
        raise InputError(
            f"{name} is not a planned name: choose the press that it is, then drop it again",
            "unknown_name",
            "campaign.trials",
            name,
            tuple(plan),
        )
    file_transfer.plain_name(target)  # a plan can name another file of its folder as a press, such as itself
    file_transfer.check_press(name, content, plan[target].get("velocity_mm_s"))
    for other in plan:
        if other != target and file_transfer.holds(folder / other, content):
            message = f"{name} is the same as {other}, which is there: press it again"
            raise InputError(message, "duplicate", "trace", name)
    taken = trash.keep_file(root, folder, target, content)
    return taken if target == name else replace(taken, text=f"{name} is now {target}. {taken.text}")


HEADS = {
    "sequence": "order",
    "thickness_mm": "pad [mm]",
    "velocity_mm_s": "speed [mm/s]",
    "target_force_N": "force [N]",
    "target_depth_mm": "depth [mm]",
    "age_days": "age [days]",
    "temperature_C": "temperature [C]",
    "rest_s": "rest [s]",
}
CHANGED = "({target: t}) => { if (t.dataset.key) emit([Number(t.dataset.row), t.dataset.key, t.value]); }"


CELL = '<td><input inputmode="decimal" size="6" data-row="{}" data-key="{}" value="{}" aria-label="{} of {}"></td>'


def table_html(keys: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Markup:
    """The table as HTML; each row has ``file`` and the keys, None where a value is unknown."""

    def shown(value: object) -> str:
        return f"{value:g}" if isinstance(value, int | float) and not isinstance(value, bool) else ""

    body = (
        (row["file"], joined(CELL, ((number, key, shown(row.get(key)), HEADS[key], row["file"]) for key in keys)))
        for number, row in enumerate(rows)
    )
    return filled(
        '<div class="values"><table><thead><tr><th scope=col>press</th>{}</tr></thead><tbody>{}</tbody></table></div>',
        joined("<th scope=col>{}</th>", ([HEADS[key]] for key in keys)),
        joined("<tr><th scope=row>{}</th>{}</tr>", body),
    )


OFTEN = ("temperature_C", "age_days", "rest_s")
"""Values that often are the same for a whole day."""
ALL = "all presses"


class TrialTable:
    """The table of a campaign; each value is written into ``campaign.toml`` when it was typed."""

    def __init__(self, root: Path, campaign: str, then: Callable[[], None]) -> None:
        self.root, self.path, self.folder, self.then = root, f"{campaign}/{FILE}", root / campaign, then
        html("<p>Empty means unknown. Each value is written into campaign.toml when you leave its field.</p>")
        with widgets.fields():
            self.day = widgets.select("Fill in for", {ALL: ALL}, ALL, "fill-day")
            self.key = widgets.select("Value", {key: HEADS[key] for key in OFTEN}, OFTEN[0], "fill-key")
            self.value = ui.input("The same for all of them").props('data-test="fill-value"')
            widgets.button("Fill in", self.fill, "fill")
        self.message, self.table = widgets.area("values-said", live=True), widgets.area()
        self.read()

    def read(self) -> None:
        """Show the file as it is now."""
        self.rows = read_trials(self.folder)
        days = [ALL, *days_of(self.rows)]
        self.day.set_options(days, value=self.day.value if self.day.value in days else ALL)
        aim = "target_depth_mm" if all(row["target_force_N"] is None for row in self.rows) else "target_force_N"
        self.keys = ("sequence", "thickness_mm", "velocity_mm_s", aim, "age_days", "temperature_C", "rest_s")
        with widgets.fresh(self.table):
            shown = html("{}", table_html(self.keys, self.rows)).style("width:100%")
        shown.on("change", lambda event: self.typed(shown.html_id, *event.args), js_handler=CHANGED)

    def typed(self, shown: str, row: object, key: str, text: object) -> None:
        """Write one value; why it is refused stands in a place of its own, and its cell is marked."""
        if key in self.keys and isinstance(row, int) and 0 <= row < len(self.rows):
            file, mark = self.rows[row]["file"], "setAttribute('aria-invalid', true)"
            with widgets.problems_in(self.message):
                value = widgets.number_of(str(text), f"{file}: {key}", key)
                self.write({row: {key: value}}, f"{HEADS[key]} of {file} is kept.")
                mark = "removeAttribute('aria-invalid')"
            cell = f'#{shown} [data-row="{row}"][data-key="{key}"]'
            ui.run_javascript(f"document.querySelector('{cell}')?.{mark}")

    def fill(self) -> None:
        """Write one value for all presses of a day."""
        rows, key = rows_of(self.rows, self.day.value), str(self.key.value)
        with widgets.problems_in(self.message):
            value = widgets.number_of(str(self.value.value or ""), key)
            if value is None:
                raise InputError("type the value to fill in", "missing", key)
            self.write({row: {key: value} for row in rows}, f"{HEADS[key]} of {len(rows)} presses is kept.")
            self.read()

    def back(self) -> None:
        """Show the file after a change was taken back."""
        self.read()
        self.then()

    def write(self, changes: Mapping[int, Mapping[str, float | None]], words: str) -> None:
        """Write values where the presses are still those of the table."""
        if [row["file"] for row in read_trials(self.folder)] != [row["file"] for row in self.rows]:
            message = "campaign.toml was changed meanwhile: load the page again"
            raise InputError(message, "changed_meanwhile", "campaign.trials")
        with trash.kept_before(self.root, self.path) as before:
            write_trial_values(self.folder, changes)
        undo_bar(self.root).offer(before, self.back, focus=False)
        for row, values in changes.items():
            self.rows[row].update(values)
        with self.message:
            html('<p class="note">{}</p>', words)
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


FIELDS: dict[str, Any] = {
    "pads": "5,15,20",
    "speeds": "10,250",
    "forces": "5,10,15",
    "ages": "9,14,29",
    "repeats": 2,
    "hold": 10.0,
    "shape": "slab",
    "pad": "150x120",
}


def usual_moulds(root: Path, state: State) -> list[str]:
    """Moulds whose pads one campaign can press: of one outline, resin and ratio, each of its own thickness.

    Those of the pad that is chosen, else those of the newest mould.
    """
    # The chosen pad's stand last: of each thickness the last one counts.
    own = sorted(project_index.moulds(root), key=lambda one: one.is_of(state))
    kept = {one.pad["thickness_mm"]: one.folder for one in own if _kind(one) == _kind(own[-1])}
    return [kept[thickness] for thickness in sorted(kept)]


def _kind(mould: project_index.Mould) -> tuple[Any, ...]:
    pad = mould.pad
    return mould.length_mm, mould.width_mm, pad["resin"], pad["ratio"], project_index.shape_key(pad["shape"])


def plan_of(root: Path, campaign: str) -> dict[str, Any]:
    """The fields of a plan that ``campaign new`` wrote, by its manifest; empty where it cannot be read."""
    try:
        manifest = read_json(root / campaign / MANIFEST)
        pads, set_up = manifest["inputs"]["design"], manifest["inputs"]["set_up"]
        if manifest["command"] != "campaign new" or pads["by_depth"]:
            return {}
        plan: dict[str, Any] = {
            "pads": _list(pads["pads_mm"]),
            "speeds": _list(pads["velocities_mm_s"]),
            "forces": _list(pads["targets"]),
            "ages": _list(pads["ages_days"]),
            "repeats": int(pads["repeats"]),
            "hold": float(pads["hold_s"]),
            "shape": str(set_up.get("shape", "slab")),
            "pad": str(set_up["pad"]),
            "resin": set_up.get("resin"),
            "ratio": set_up.get("ratio"),
            "punch": str(set_up["punch"]),
        }
    except (AttributeError, ValueError, KeyError, TypeError, OverflowError):
        return {}
    return plan if plan["resin"] and plan["ratio"] else {}


def _list(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def plan_options(given: Mapping[str, Any]) -> dict[str, object]:
    """Options of ``campaign new`` for the fields of a plan; pads come from moulds where some are named."""
    presses = {
        "velocity": given["speeds"],
        "force": given["forces"],
        "repeats": given["repeats"],
        "ages": given["ages"],
        "hold": given["hold"],
    }
    if given.get("moulds"):
        return {"from-mould": ",".join(given["moulds"]), **presses, "punch": given["punch"]}
    pads = {
        key: "" if key in ("shape", "pad") and given[key] == FIELDS[key] else given[key]
        for key in ("pads", "shape", "pad")
    }
    return {**pads, **presses, **{key: given[key] for key in ("resin", "ratio", "punch")}}


PAD = ("pads", "shape", "pad", "resin", "ratio")
"""Fields of pads that are typed; those of moulds have theirs."""


class PlanForm:
    """Fields of a plan and the command that makes it."""

    def __init__(self, root: Path, state: State, replaced: str = "") -> None:
        self.root, self.state, self.replaced = root, state, replaced
        name = "replan" if replaced else "campaign"
        usual = [] if replaced else usual_moulds(root, state)
        given = {**FIELDS, "resin": state.resin, "ratio": state.ratio, "punch": state.punch}
        given |= plan_of(root, replaced) if replaced else {}
        self.punch = given["punch"]
        known = {
            one.folder: f"{one.folder.partition('/')[2]}: {one.label}" for one in reversed(project_index.moulds(root))
        }
        self.form = widgets.Form(
            "replan" if replaced else "plan",
            lambda: {
                "name": ui.input("Name", value=select_options.free_name(root, "campaigns", "first")),
                "moulds": widgets.select_several(
                    "Pads of these moulds (none: type the pads)", known, usual, f"{name}-moulds"
                ),
                "pads": ui.input("Pads, thickness [mm]", value=given["pads"]),
                "shape": ui.input("Shape with its lengths", value=given["shape"]),
                "pad": ui.input("Outline, length x width [mm]", value=given["pad"]),
                "resin": widgets.select("Resin", select_options.resins(), given["resin"]),
                "ratio": NumberField("Ratio", given["ratio"]),
                "speeds": ui.input("Speeds [mm/s]", value=given["speeds"]),
                "forces": ui.input("Steady forces [N]", value=given["forces"]),
                "repeats": NumberField("Repeats", given["repeats"], 1, 9),
                "ages": ui.input("Age of the pads on each day [days]", value=given["ages"]),
                "hold": NumberField("Hold [s]", given["hold"], 1, 600),
            },
        )
        self.form.fields["name"].set_visibility(not replaced)
        self.form.fields["moulds"].set_visibility(bool(known))
        self.work = JobPanel(
            root,
            name,
            "Change the plan" if replaced else "Plan it",
            self.words,
            self.show,
            made=folder_of,
            needs="trials",
        )
        for one in PAD:
            self.form.fields[one].bind_visibility_from(self.form.fields["moulds"], "value", lambda chosen: not chosen)
        self.form.on_change(self.work.renew)

    def words(self) -> list[str]:
        """The plan as a command."""
        given = self.form.filled(repeats="repeats", ratio="ratio")
        if given["repeats"] % 1.0:
            raise InputError(f"repeats = {given['repeats']:g}: type a whole number", "malformed", "repeats")
        given["punch"] = self.punch
        folder = self.replaced or f"campaigns/{file_transfer.plain_name((given['name'] or '').strip())}"
        return jobs.command("campaign", "new", folder, **plan_options(given), replace=bool(self.replaced))

    def show(self, job: jobs.Job) -> None:
        """Show what was planned."""
        answer, folder = job.answer, folder_of(job)
        html('<p data-test="planned">{} presses planned in {}</p>', len(answer["trials"]), folder)
        if power := answer.get("power"):
            html("<p>Effects that this plan can detect: {}.</p>", ", ".join(power["seen"]) or "none")
        widgets.go("/campaign", "Go on to the presses", self.state.changed(campaign=folder), "presses")


def folder_of(job: jobs.Job) -> str:
    """Folder of the campaign that a command made; empty where it has no answer."""
    return str(job.answer.get("inputs", {}).get("folder", ""))
