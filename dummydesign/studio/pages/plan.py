"""The plan of a campaign: pads of moulds or typed ones, speeds, forces, days; a new one or one that is changed."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import choices, made
from dummydesign.studio.frame import Studio, Work, html, state_link, warnings
from dummydesign.studio.presses.plans import FIELDS, plan_of, plan_options, usual_moulds
from dummydesign.studio.server import files
from dummydesign.studio.state import State
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job

MOULDED, TYPED = "the moulds of this project", "typed here"


class PlanForm:
    """Fields of a plan and the command that makes it."""

    def __init__(self, studio: Studio, state: State, replaced: str = "") -> None:
        """Build it.

        Parameters
        ----------
        studio : Studio
        state : State
        replaced : str
            Folder of the campaign whose plan is changed; empty for a new one.
        """
        self.studio, self.state, self.replaced = studio, state, replaced
        root, name = studio.root, "replan" if replaced else "campaign"
        usual = [] if replaced else usual_moulds(root, state)
        given: dict[str, Any] = {**FIELDS, "moulds": usual, "resin": state.resin, "ratio": state.ratio,
                                 "punch": state.punch, **(plan_of(root, replaced) if replaced else {})}  # fmt: skip
        self.punch = given["punch"]
        known = {one.folder: f"{one.folder.partition('/')[2]}: {one.label}" for one in reversed(made.moulds(root))}
        resins, resin = choices.resins(), given["resin"]
        self.fields: dict[str, Any] = {}
        source = MOULDED if usual else TYPED
        with ui.element("div").classes("fields"):
            if not replaced:
                self.name = ui.input("Name", value=choices.free_name(root, "campaigns", "first"))
                self.name.props('data-test="plan-name"').on_value_change(self.renew)
            self.source = ui.select([MOULDED, TYPED] if known else [TYPED], value=source, label="Pads are those of")
            self.source.props(f'data-test="{name}-source"')
        self.moulds = ui.select(known, value=usual, multiple=True, label="Moulds")
        self.moulds.props(f'use-chips data-test="{name}-moulds"').style("width:100%")
        self.typed = ui.element("div").classes("fields")
        with self.typed:
            self._input("pads", "Pads, thickness [mm]", given)
            self._input("shape", "Shape with its lengths", given)
            self._input("pad", "Outline, length x width [mm]", given)
            self.fields["resin"] = ui.select(resins if resin in resins else {resin: resin, **resins}, value=resin,
                                             label="Resin")  # fmt: skip
            self.fields["ratio"] = ui.number("Ratio", value=given["ratio"], step=0.1)
        with ui.element("div").classes("fields"):
            self._input("speeds", "Speeds [mm/s]", given)
            self._input("forces", "Steady forces [N]", given)
            self.fields["repeats"] = ui.number("Repeats", value=given["repeats"], min=1, max=9, step=1)
            self._input("ages", "Age of the pads on each day [days]", given)
            self.fields["hold"] = ui.number("Hold [s]", value=given["hold"], min=1, max=600)
        for key in ("pads", "shape", "speeds", "forces", "repeats", "ages"):
            self.fields[key].props(f'data-test="{"re" if replaced else ""}plan-{key}"')
        label = "Change the plan" if replaced else "Plan it"
        self.work = Work(studio, name, label, self.words, self.show, self.belongs)
        for field in (self.source, self.moulds, *self.fields.values()):
            field.on_value_change(self.renew)
        self.renew()

    def _input(self, key: str, label: str, given: Mapping[str, Any]) -> None:
        self.fields[key] = ui.input(label, value=str(given[key]))

    def renew(self) -> None:
        """Something was chosen."""
        moulded = self.source.value == MOULDED
        self.moulds.set_visibility(moulded)
        self.typed.set_visibility(not moulded)
        self.work.renew_line()

    def folder(self) -> str:
        """Where the plan goes."""
        return self.replaced or f"campaigns/{files.plain_name((self.name.value or '').strip())}"

    def words(self) -> list[str]:
        """The plan as a command."""
        given: dict[str, Any] = {key: field.value for key, field in self.fields.items()}
        for key in ("repeats", "ratio"):
            if given[key] is None:
                raise InputError(f"{key} is empty")
        moulds = list(self.moulds.value or []) if self.source.value == MOULDED else []
        if self.source.value == MOULDED and not moulds:
            raise InputError("choose the moulds whose pads are pressed")
        if given["hold"] is not None:
            given["hold"] = float(given["hold"])
        given |= {"moulds": moulds, "punch": self.punch, "repeats": int(given["repeats"]),
                  "ratio": float(given["ratio"])}  # fmt: skip
        more = ["--replace"] if self.replaced else []
        return ["campaign", "new", self.folder(), *options(plan_options(given)), *more]

    def belongs(self, job: Job) -> bool:
        """Whether a job made the plan that is chosen, and it is still there."""
        folder = _folder_of(job)
        try:
            same = list(job.words) == self.words()
        except InputError:
            return False
        there = not folder or ((self.studio.root / folder).is_dir() and jobs.is_last(self.studio.root, job, _folder_of))
        return same and there

    def show(self, job: Job) -> None:
        """What was planned."""
        answer = job.answer
        if "trials" not in answer:
            return
        folder = answer["inputs"]["folder"]
        html(f'<p data-test="planned">{len(answer["trials"])} presses planned in {escape(folder)}</p>')
        power = answer.get("power")
        if power:
            html(f"<p>Effects that this plan can detect: {escape(', '.join(power['seen']) or 'none')}.</p>")
        warnings(answer)
        on = state_link("/campaign", "Go on to the presses", self.state.changed(campaign=folder), "presses")
        html(f'<p class="note">{on}</p>')


def _folder_of(job: Job) -> str:
    return str(job.answer.get("inputs", {}).get("folder", ""))
