"""The mould of a pad: its size and kind, the work with its progress, checks, solids, and its files by their use."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.studio import choices, made, parts
from dummydesign.studio.jobs import Job, holds_answer, options
from dummydesign.studio.manage import manage, undo_bar
from dummydesign.studio.page_frame import Studio, keep_state, open_page
from dummydesign.studio.parts import html
from dummydesign.studio.state import State, design_state, design_summary, page_link, state_link
from dummydesign.studio.work_panel import Work

OUTLINE_MM = (150.0, 120.0)


class MouldPage:
    """The page of one visitor: the pad that is chosen, its moulds, and the others of the project."""

    def __init__(self, studio: Studio, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.studio, self.root, self.state = studio, studio.root, state
        self.shown = ""
        undo_bar(studio)
        self.source = parts.area()
        mine = [one for one in made.moulds(self.root) if one.is_of(state)]
        length_mm, width_mm = (mine[-1].length_mm, mine[-1].width_mm) if mine else OUTLINE_MM
        preset = mine[-1].preset if mine and mine[-1].preset in made.PRESETS else "open"
        with ui.element("div").classes("fields"):
            self.thickness = ui.number("Thickness [mm]", value=state.thickness_mm, min=3, max=30, step=0.5)
            self.length = ui.number("Length [mm]", value=length_mm, min=20, max=300, step=5)
            self.width = ui.number("Width [mm]", value=width_mm, min=20, max=300, step=5)
            self.shape = ui.input("Shape", value=state.shape)
            self.ratio = ui.number("Ratio", value=state.ratio, step=0.1)
            self.resin = parts.select("Resin", choices.resins(), state.resin)
            self.preset = parts.select("Kind of mould", {name: name for name in made.PRESETS}, preset, "preset")
        self.thickness.props('data-test="thickness"')
        self.kind = html("")
        self.work = Work(studio, "mould", "Make the mould", self.words, self.show, self.belongs,
                         lambda job, mine: self.list_moulds())  # fmt: skip
        self.others = parts.area()
        for field in (self.thickness, self.length, self.width, self.shape, self.ratio, self.resin, self.preset):
            field.on_value_change(self.renew)
        self.show_pad()

    def words(self) -> list[str]:
        """The mould as a command."""
        size = {"thickness": self.thickness.value, "length": self.length.value, "width": self.width.value,
                "ratio": self.ratio.value}  # fmt: skip
        for name, value in size.items():
            if value is None:
                raise InputError(f"{name} is empty", "missing", name)
        kind = (self.shape.value or "slab").partition(":")[0]
        given = {
            "thickness": size["thickness"], "length": None if size["length"] == OUTLINE_MM[0] else size["length"],
            "width": None if size["width"] == OUTLINE_MM[1] else size["width"],
            "shape": None if self.shape.value == "slab" else self.shape.value, "preset": self.preset.value,
            "resin": self.resin.value, "ratio": size["ratio"],
            "out": f"moulds/mould_{'' if kind == 'slab' else f'{kind}_'}t{size['thickness']:g}",
        }  # fmt: skip
        return ["mold", *options(given)]

    def chosen(self) -> State:
        """The state with the pad of the fields."""
        return self.state.changed(
            shape=(self.shape.value or "slab").strip(), resin=self.resin.value,
            thickness_mm=float(self.thickness.value or self.state.thickness_mm),
            ratio=float(self.ratio.value or self.state.ratio),
        )  # fmt: skip

    def belongs(self, job: Job, words: list[str]) -> bool:
        """Whether a job made the mould that is chosen, and its files are still there."""
        folder = folder_of(job.answer)
        return pad_of(job.words) == pad_of(words) and (not folder or holds_answer(self.root, folder, job.answer))

    def renew(self) -> None:
        """Something was chosen."""
        keep_state(self.chosen())
        self.show_pad()

    def show_pad(self) -> None:
        """Where the pad comes from, what kind of mould it gets, and which moulds there are."""
        now = self.chosen()
        with parts.fresh(self.source):
            _source(self.root, now)
        self.kind.set_content(f'<p class="note">{escape(made.PRESETS[self.preset.value])}</p>')
        self.shown = ""
        self.work.renew()
        self.list_moulds()

    def show(self, job: Job) -> None:
        """What a command made."""
        answer = job.answer
        if "pour" not in answer:
            return
        self.shown = folder_of(answer)
        batch = answer.get("batch") or {**answer["pour"], "pour_g": answer["pour"]["fill_mass_g"]}
        poured = [(f"{part['mass_g']:.1f} g", f"{part['name']}, to mix") for part in batch["components"]]
        poured.append((f"{batch['pour_g']:.1f} g", "of the mix, into the mould"))
        silicone = answer["pour"]["silicone_mass_g"]
        parts.facts([*poured, *([(f"{silicone:.0f} g", "silicone for the mould")] if silicone else [])])
        parts.warnings(answer)
        if self.shown:
            html(f"<h2>{escape(self.shown)}</h2>")
            manage(self.studio, self.shown, "mould", self._moved)
            _files(self.root, self.shown, self.chosen())
        html(f'<p class="note">Next: cast the pads, then {page_link("/cast", "check a cast pad")} or '
             f'{page_link("/campaign", "plan what to press")}.</p>')  # fmt: skip

    def _moved(self, old: str, new: str) -> None:
        """A mould was renamed, deleted or brought back."""
        open_page("/mould", self.chosen())

    def list_moulds(self) -> None:
        """Further moulds of this pad with their files, and moulds of other pads as links."""
        self.others.clear()
        now = self.chosen()
        others = [one for one in reversed(made.moulds(self.root)) if one.folder != self.shown]
        with self.others:
            for one in others:
                if one.is_of(now):
                    html(f'<h2 data-test="mould-of-this-pad">{escape(one.folder)}</h2><p>{escape(one.label)}</p>')
                    manage(self.studio, one.folder, "mould", self._moved)
                    _files(self.root, one.folder, now)
            links = [
                f"<li>{state_link('/mould', one.label, self.state.changed(**one.pad, design=''), 'other-mould')}</li>"
                for one in others if not one.is_of(now)
            ]  # fmt: skip
            if links:
                html(f"<h2>Moulds of other pads</h2><ul>{''.join(links)}</ul>")


def pad_of(words: Sequence[str]) -> tuple[str, ...]:
    """The options of a command line of ``mold`` but for its folder: the pad and the kind of mould."""
    given = list(words)
    if "--out" in given:
        at = given.index("--out")
        del given[at : at + 2]
    return tuple(given)


def folder_of(answer: Mapping[str, Any]) -> str:
    """Folder of the files of an answer of ``mold``; empty without any."""
    files = answer.get("files") or {}
    return Path(next(iter(files.values()))).parent.as_posix() if files else ""


def verdict_of(root: Path, state: State) -> str:
    """Why the pad must not be cast, in a sentence; empty for one that may be, or that was not judged."""
    design = made.design_of_pad(root, state)
    summary = design_summary(root, design) if design else {}
    return str(summary.get("text", "")) if summary.get("verdict") == "not_representative" else ""


def _source(root: Path, state: State) -> None:
    """Where the pad comes from, with the verdict on it."""
    design = made.design_of_pad(root, state)
    if not design:
        link = page_link("/design", "design one")
        html(f'<p class="note">This pad is not one of the designs. Check it, or {link}.</p>')
        return
    html(f"<p>This pad is the design <b>{escape(design)}</b>.</p>")
    if not made.answers(root, design, state):
        words = State(**design_state(root, design)).label.partition("; ")[2]
        html(f'<p class="note" data-test="other-question">That design was judged for {escape(words)}. '
             f'For what is chosen, check it on the {page_link("/design", "design page")}.</p>')  # fmt: skip
    if red := verdict_of(root, state):
        html(f'<p class="problem" role="alert" data-test="red">Do not cast this pad. {escape(red)}</p>')


def _files(root: Path, folder: str, state: State) -> None:
    """Checks, solids and files of a mould; of a pad that must not be cast, folded away."""
    _checks(root / folder)
    red = verdict_of(root, state)
    if red:
        html(f'<p class="problem" data-test="do-not-cast">Do not cast. {escape(red)}</p>')
        with ui.expansion("Files of this mould, for the record").style("width:100%") as kept:
            _links(root, folder)
        kept.props('data-test="files-for-the-record"')
        return
    _links(root, folder)


def _links(root: Path, folder: str) -> None:
    parts.zip_link(folder)
    if list((root / folder).glob("*.stl")):
        parts.shown_file(f"/solid/mould/{folder}", "pad and mould as solids", "shown solid")
    names = [path.name for path in (root / folder).iterdir() if path.is_file() and not path.name.startswith(".")]
    for group, rows in made.grouped_files(names):
        html(f"<h3>{escape(group)}</h3>")
        parts.file_links([(words, f"{folder}/{name}") for words, name in rows])


def _checks(folder: Path) -> None:
    """How many checks of the solids passed, and what the others say."""
    try:
        checks = json.loads((folder / "checks.json").read_text(encoding="utf-8"))
        passed = sum(one["status"] == "pass" for one in checks)
        rest = [[one["id"], one["status"], str(one.get("note", ""))] for one in checks if one["status"] != "pass"]
    except (OSError, ValueError, KeyError, TypeError):
        return
    html(f"<p><b>{passed} of {len(checks)} checks passed</b></p>")
    if rest:
        parts.table(["check", "", "because"], rest, words=True)
