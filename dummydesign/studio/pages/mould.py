"""The mould of a pad: its size and kind, the work with its progress, checks, solids, and its files by their use."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.geometry.dimensions import THICKNESS_MM
from dummydesign.project.folder import Project
from dummydesign.studio import figures, project_index, select_options, widgets
from dummydesign.studio.file_actions import thing
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.jobs import Job, command
from dummydesign.studio.markup import Markup, filled, joined
from dummydesign.studio.state import State, page_link
from dummydesign.studio.widgets import NumberField, html, keep_state

OUTLINE_MM, OUTLINES_MM = (150.0, 120.0), (20.0, 300.0)
OPTIONS = ("thickness", "length", "width", "shape", "preset", "resin", "ratio")


class MouldPage:
    """The page of one visitor: the pad that is chosen, its moulds, and the others of the project."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.root, self.state = project.root, state
        self.source = widgets.area()
        mine = [one for one in project_index.moulds(self.root) if one.is_of(state)]
        length_mm, width_mm = (mine[-1].length_mm, mine[-1].width_mm) if mine else OUTLINE_MM
        preset = mine[-1].preset if mine and mine[-1].preset in project_index.PRESETS else "open"
        with ui.element("div").classes("pair"):
            self.form = widgets.Form(
                "mould",
                lambda: {
                    "thickness": NumberField("Thickness [mm]", state.thickness_mm, *THICKNESS_MM, test="thickness"),
                    "length": NumberField("Length [mm]", length_mm, *OUTLINES_MM),
                    "width": NumberField("Width [mm]", width_mm, *OUTLINES_MM),
                    "ratio": NumberField("Ratio", state.ratio),
                    "shape": ui.input("Shape", value=state.shape),
                    "resin": widgets.select("Resin", select_options.resins(), state.resin),
                    "preset": widgets.select("Kind of mould", project_index.PRESETS, preset),
                },
            )
            self.section = html("")
        self.work = JobPanel(
            self.root,
            "mould",
            "Make the mould",
            self.words,
            self.show,
            lambda job, words: pad_of(job.words) == pad_of(words),
            lambda job: folder_of(job.answer),
            lambda job, mine: self.list_moulds(),
            needs="batch",
        )
        self.others = widgets.area()
        self.form.on_change(self.renew)
        self.show_pad()

    def words(self) -> list[str]:
        """The mould as a command."""
        values = self.form.filled(thickness="thickness", length="length", width="width", ratio="ratio")
        given = {name: values[name] for name in OPTIONS}
        usual = {"length": OUTLINE_MM[0], "width": OUTLINE_MM[1], "shape": "slab"}
        kind = (given["shape"] or "slab").partition(":")[0]
        folder = f"moulds/mould_{'' if kind == 'slab' else f'{kind}_'}t{given['thickness']:g}"
        return command("mold", **{name: one for name, one in given.items() if one != usual.get(name)}, out=folder)

    def chosen(self) -> State:
        """The state with the pad of the fields."""
        shape, resin = (self.form.fields[name].value for name in ("shape", "resin"))
        now = self.state.changed(shape=(shape or "slab").strip(), resin=resin)
        for name, field in (("thickness_mm", "thickness"), ("ratio", "ratio")):
            with suppress(InputError):
                now = now.changed(**{name: self.form.fields[field].number or getattr(now, name)})
        return now

    def renew(self) -> None:
        """Something was chosen."""
        keep_state(self.chosen())
        self.show_pad()

    def show_pad(self) -> None:
        """Where the pad comes from, what kind of mould it gets, and which moulds there are."""
        now = self.chosen()
        with widgets.fresh(self.source):
            _source(self.root, now)
        self.section.set_content(figures.section_html(self.root, now))
        self.work.main = not (verdict_of(self.root, now) or project_index.wants_puck(self.root, now))
        self.work.renew()
        self.list_moulds()

    def show(self, job: Job) -> None:
        """What a command made."""
        answer = job.answer
        folder = folder_of(answer)
        widgets.facts(poured(answer["batch"], answer["pour"]))
        if folder:
            self._files(folder)
        html(
            "<p>Cast the pads, then {} or {}.</p>",
            page_link("/cast", "check a cast pad"),
            page_link("/campaign", "plan what to press"),
        )

    def _files(self, folder: str, label: str = "", test: str = "") -> None:
        """Buttons, solids, files and checks of a mould; of a pad that must not be cast, folded away."""
        thing(filled('<h2 data-test="{}">{}</h2><p>{}</p>', test, folder, label), self.root, folder, "mould")
        widgets.tell_changes(self.root, f"{folder}/manifest.json", "Make the mould again before you weigh.")
        if red := verdict_of(self.root, self.chosen()):
            html('<p class="problem" data-test="do-not-cast">Do not cast. {}</p>', red)
            with widgets.fold("Files of this mould, for the record", "files-for-the-record"):
                _links(self.root, folder)
        else:
            _links(self.root, folder)

    def list_moulds(self) -> None:
        """Further moulds of this pad with their files, and moulds of other pads as links."""
        now, links = self.chosen(), []
        shown = folder_of(self.work.shown.answer) if self.work.shown else ""
        with widgets.fresh(self.others):
            for one in reversed(project_index.moulds(self.root)):
                if one.folder != shown and one.is_of(now):
                    self._files(one.folder, one.label, "mould-of-this-pad")
                elif one.folder != shown:
                    other = self.state.changed(**one.pad, design="")
                    links.append([page_link("/mould", one.label, other, "other-mould")])
            if links:
                html("<h2>Moulds of other pads</h2><ul>{}</ul>", joined("<li>{}</li>", links))


def poured(batch: Mapping[str, Any], pour: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What to weigh, and what of it goes where; of a layered pad both pours."""
    rows, pours = [], {"": batch}
    if "base" in batch:
        pours = {"upper layer, poured first: ": batch, "base layer, poured second: ": batch["base"]}
    for layer, one in pours.items():
        mixed = [
            (part["mass_g"], f"{part['name']}, to mix for pad and witness puck")
            for part in one["witness"]["components"]
        ]
        cast = (
            (one["pour_g"], "of the mix, into the mould"),
            (one["witness"]["mass_g"], "of the mix, into the ring of the witness puck"),
        )
        rows += [(f"{mass_g:.1f} g", f"{layer}{words}") for mass_g, words in (*mixed, *cast)]
    masses = {part: pour.get(f"{part}silicone_mass_g") for part in ("", "lid_")}
    return rows + [
        (f"{mass:.0f} g", f"silicone for the {'lid' if part else 'mould'}") for part, mass in masses.items() if mass
    ]


def pad_of(words: Sequence[str]) -> list[str]:
    """The options of a command line of ``mold`` but for its folder: the pad and the kind of mould."""
    at = words.index("--out") if "--out" in words else len(words)
    return [*words[:at], *words[at + 2 :]]


def folder_of(answer: Mapping[str, Any]) -> str:
    """Folder of the files of an answer of ``mold``; empty without any."""
    files = answer.get("files") or {}
    return Path(next(iter(files.values()))).parent.as_posix() if files else ""


def verdict_of(root: Path, state: State) -> str:
    """Why the pad must not be cast, in a sentence; empty for one that may be, or that was not judged."""
    design = project_index.design_of_pad(root, state)
    return design.text if design is not None and design.level == "not_representative" else ""


def _source(root: Path, state: State) -> None:
    """Where the pad comes from, with the verdict on it."""
    design = project_index.design_of_pad(root, state)
    if design is None:
        link = page_link("/design", "design one")
        html('<p class="note">This pad is not one of the designs. Check it, or {}.</p>', link)
        return
    html("<p>This pad is the design <b>{}</b>.</p>", design.folder)
    widgets.tell_changes(root, f"{design.folder}/manifest.json", "Solve the pad again on the design page.")
    if not design.answers(state):
        words = State(**design.given).label.partition("; ")[2]
        html(
            '<p class="note" data-test="other-question">That design was judged for {}. For what is '
            "chosen, check it on the {}.</p>",
            words,
            page_link("/design", "design page"),
        )
    if red := verdict_of(root, state):
        html('<p class="problem" role="alert" data-test="red">Do not cast this pad. {}</p>', red)
    elif project_index.wants_puck(root, state):
        widgets.go("/resin", "Measure one puck first", test="puck-first")


def _links(root: Path, folder: str) -> None:
    """Two buttons, the solid, a table of parts by format; what is read seldom is folded."""
    files = (root / folder).glob("[!.]*")
    groups = dict(project_index.grouped_files(path.name for path in files if path.is_file()))
    widgets.zip_link(folder, [f"{folder}/{name}" for words, name in groups.get("Pour", []) if "start here" in words])
    with ui.element("div").classes("pair"):
        for view in sorted((root / folder).glob("assembly_*.html"))[:1]:
            widgets.shown_file(f"/files/{folder}/{view.name}", "the parts as solids", "shown solid")
        made_of = groups.pop("Print or machine", []) + groups.pop("Draw", [])
        if made_of:
            html('<table class="files" data-test="parts"><tbody>{}</tbody></table>', _part_rows(made_of, folder))
    _checks(root / folder)
    with widgets.fold("Further files", "further-files"):
        for group, rows in groups.items():
            html("<h3>{}</h3>", group)
            widgets.file_links([(words, f"{folder}/{name}") for words, name in rows])


def _part_rows(rows: Sequence[tuple[str, str]], folder: str) -> Markup:
    """A row a part, with a link to each of its formats."""
    by_part: dict[str, list[tuple[str, str]]] = {}
    for words, name in rows:
        part, _, kind = words.removeprefix("Drawing of the ").removeprefix("Picture of the ").partition(", ")
        part, kind = part.capitalize(), kind or name.rpartition(".")[2].upper()
        by_part.setdefault(part, []).append((kind, f"{folder}/{name}"))
    links = ((part, Markup(" ").join(widgets.file_link(*one) for one in files)) for part, files in by_part.items())
    return joined("<tr><th scope=row>{}</th><td>{}</td></tr>", links)


def _checks(folder: Path) -> None:
    """How many checks of the solids passed, and what the others say."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        checks = json.loads((folder / "checks.json").read_text(encoding="utf-8"))
        rest = [[one["id"], one["status"], str(one.get("note", ""))] for one in checks if one["status"] != "pass"]
        said = f"{len(checks) - len(rest)} of {len(checks)} checks passed"
        if rest and all(row[1] == "skipped" for row in rest):
            said += ", the others could not be run"
        widgets.table(["check", "", "because"], rest, words=True, under=said) if rest else html("<p>{}</p>", said)
