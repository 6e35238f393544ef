"""A batch of resin: the modulus of its pucks, and the resin that results."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.core.user_library import entries
from dummydesign.measurement.trace import read_trace
from dummydesign.project.folder import Project, project_of
from dummydesign.project.status import witness_size
from dummydesign.resin.describe import explain
from dummydesign.resin.model.resin_file import load_resin, recording_sha256
from dummydesign.resin.update import known_puck, without_puck
from dummydesign.studio import jobs, project_index, select_options, widgets
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.state import State, absolute, options_of, page_link
from dummydesign.studio.trash import choose_for_project
from dummydesign.studio.widgets import NumberField, html, keep_state, open_page

TYPED = "puck_"
"""Beginning of the names under which the address keeps the choices of this page, which are named as the options are."""
SIZES_MM = (1.0, 500.0)
NUMBER = ("value", "low", "high", "kind")


class PuckPage:
    """The page: which puck was pressed, and the resin that results."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self._root, self._project, self._state = project.root, project, state
        known = pucks(project.root)
        typed = {name.removeprefix(TYPED): text for name, text in query.items() if name.startswith(TYPED)}
        start = typed or _last(project.root)
        with widgets.fold("Print the ring of a puck", "ring", opened=not known):
            size = witness_size()
            words = jobs.command("mold", puck=size, resin=state.resin, ratio=state.ratio, out=f"moulds/puck_{size}")
            JobPanel(project.root, "ring", "Make the ring", lambda: words, _show_ring, needs="files")
        widgets.fold(f"Numbers of {state.resin}, with their sources", "numbers", self._numbers)
        if not known:
            html('<p class="note">No presses yet: {} first.</p>', page_link("/measured", "bring in the file of a puck"))
            return
        # several presses may be those of people: which one is the puck's is for the user to say
        first = start.get("press") or (next(iter(known)) if len(known) == 1 else "")
        if first and first not in known:
            widgets.tell_problem(f"The press '{first}' is not there (any more). Choose another, or bring it back.")
        bases = {"": "the batch itself, or the built-in one", **select_options.resins()}
        base = start.get("resin", "")
        name = start.get("name") or select_options.free_library_name("resin", "my-batch")
        shown = select_options.offered(known, first, f"{first} (missing)" if first else "choose it")
        self._form = widgets.Form(
            "puck",
            lambda: {
                "press": widgets.select("Press of the puck", shown, first, "puck"),
                "diameter": NumberField("Diameter [mm]", None, *SIZES_MM),
                "height": NumberField("Height [mm]", None, *SIZES_MM),
                "ratio": NumberField("Mixing ratio", state.ratio),
                "name": ui.input("Name of the batch", value=name),
                "resin": widgets.select("Resin whose law is updated", bases, base if base in bases else ""),
            },
            {field: text for field, text in start.items() if field in ("diameter", "height", "ratio")},
        )
        self._work = JobPanel(
            project.root,
            "puck",
            "Find the modulus",
            self._words,
            self._show,
            ended=lambda job, mine: self._list(),
            needs="young_kPa",
        )
        self._form.on_change(self._renew)
        self._own = widgets.area()
        self._list()

    def _numbers(self) -> None:
        numbers = explain(load_resin(absolute(self._root, self._state.resin)))["numbers"].items()
        head = ("number", "unit", "value", "95 % low", "95 % high", "kind")
        rows = [[*project_index.name_and_unit(name), *(one[key] for key in NUMBER)] for name, one in numbers]
        widgets.table(head, rows, symbols=[one["source"] for _, one in numbers])
        widgets.command_line(["resins", "show", self._state.resin])

    def _renew(self) -> None:
        keep_state(self._state, **{f"{TYPED}{name}": text for name, text in self._form.kept().items()})
        self._work.renew()

    def _words(self) -> list[str]:
        given = self._form.filled(
            press="which press is the puck's",
            diameter="the diameter of the puck",
            height="the height of the puck",
            ratio="the ratio of the puck",
            name="the name of the batch",
        )
        select_options.check_name("resin", given["name"])
        return jobs.command("resins", "add-compression", given.pop("press"), **given)

    def _show(self, job: jobs.Job) -> None:
        answer, name = job.answer, job.answer["name"]
        puck, friction = answer["young_kPa"], answer["friction"]
        html("<p><b>{}</b> from {}, ratio {:g}.</p>", name, Path(job.words[2]).name, answer["ratio"])
        low, high = ("bonded" if friction[end] is None else f"{friction[end]:.2g}" for end in ("low", "high"))
        widgets.facts(
            [
                (f"{puck['value']:.3g} kPa", f"modulus of this puck, 95 %: {puck['low']:.3g} to {puck['high']:.3g}"),
                (f"{answer['rmse_N']:.2g} N", "residual, rms"),
                (f"{low} to {high}", "plate friction that fits, in the interval"),
            ]
        )
        if answer["action"] == "unchanged":
            html('<p class="note">{} has this puck already. Nothing was changed.</p>', name)
        if answer.get("before"):
            html('<p class="note">The puck was known at {}. It was replaced.</p>', answer["before"])
        html("<p>The resin is in your own library, for all projects. Add further pucks under its name.</p>")
        with widgets.problems_in(widgets.area()):
            rows = _moduli(self._root / job.words[2], answer)
            widgets.table(["", "modulus kPa", "95 % low", "95 % high"], rows)
            widgets.button(f"Use {name} for this project", lambda: self._use(name), "use-resin", main=True)

    def _use(self, name: str) -> None:
        choose_for_project(project_of(self._root) or self._project, resin=name)
        open_page("/design", self._state.changed(resin=name))

    def _list(self) -> None:
        own = [entry for entry in entries("materials/resins").values() if entry.origin == "user"]
        with widgets.fresh(self._own):
            if own:
                names = ", ".join(f"{one.name}{' (chosen)' * (one.name == self._state.resin)}" for one in own)
                html("<h2>Your own resins</h2><p>{}</p>", names)


def _show_ring(job: jobs.Job) -> None:
    folder = Path(next(iter(job.answer["files"].values()))).parent.as_posix()
    html("<p>The ring is in <b>{}</b>, with its pour sheet and how the puck is pressed.</p>", folder)
    widgets.zip_link(folder)


def pucks(root: Path) -> dict[str, str]:
    """Files that may be pucks: imported presses, and measured files that are traces as they are."""
    own = sorted(filter(_is_trace, (root / "measured").glob("*.csv")))
    return select_options.traces(root) | {f"measured/{path.name}": path.name for path in own}


def _is_trace(path: Path) -> bool:
    with suppress(OSError, UnicodeDecodeError), open(path, encoding="utf-8-sig") as stream:
        return {"time_s", "displacement_mm", "force_N"} <= {word.strip() for word in stream.readline(4096).split(",")}
    return False


def _moduli(puck: Path, answer: Mapping[str, Any]) -> list[list[object]]:
    """Rows of the resin's modulus at the puck's ratio without and with this puck."""
    name, ratio = answer["name"], float(answer["ratio"])
    resin, sha256 = load_resin(name), recording_sha256(read_trace(puck))
    if known_puck(resin, sha256) is None:
        message = f"The resin '{name}' does not hold this puck (any more). Run the command again."
        raise InputError(message, "file_not_found", "puck")
    rows: list[list[object]] = [["this puck alone", *(answer["young_kPa"][key] for key in ("value", "low", "high"))]]
    for words, resin_then in (("before", without_puck(resin, sha256)), (name, resin)):
        one = resin_then.modulus_kPa(ratio)
        rows.append([f"{words}, at ratio {ratio:g}", one.value, one.low, one.high])
    return rows


def _last(root: Path) -> dict[str, str]:
    """Choices of the newest command of this page."""
    job = jobs.latest(root, "puck")
    return {"press": job.words[2], **options_of(job.words)} if job else {}
