"""A batch of resin: the modulus of its pucks, and the resin that results."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.datafiles import entries
from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project, change_project
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    Work,
    facts,
    html,
    keep_state,
    lay_out,
    open_page,
    page_link,
    table,
    tell_problem,
    warnings,
)  # fmt: skip
from dummydesign.studio.state import State
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job

OWN = ("puck", "diameter", "height", "mixed", "name", "base")
"""Choices of this page in the address."""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/measured", "Resin batch", query,
            lambda project, state: _Pucks(studio, project, state, query).build())  # fmt: skip


class _Pucks:
    def __init__(self, studio: Studio, project: Project, state: State, query: Mapping[str, str]) -> None:
        self._studio, self._project, self._state = studio, project, state
        self._known = pucks(studio.root)
        self._start = {name: query[name] for name in OWN if name in query} or _last(studio.root)

    def build(self) -> None:
        html(
            "<p>Press a puck of the batch slowly between two plates, by a third of its height or more. "
            "Its modulus makes a resin of the batch.</p>"
        )
        if not self._known:
            html(f'<p class="note">No presses yet: {page_link("/measured", "bring in the file of a puck")} first.</p>')
            return
        start = self._start
        gone = start.get("puck", "")
        if gone and gone not in self._known:
            tell_problem(f"The press '{gone}' is not there (any more). Choose another, or bring it back.")
            self._known = {gone: f"{gone} (missing)", **self._known}
        bases = {"": "default: the batch itself, else polyurethane-nagoya", **choices.resins()}
        with ui.element("div").classes("fields"):
            first = start.get("puck") or next(iter(self._known))
            self._puck = ui.select(self._known, value=first, label="Press of the puck").props('data-test="puck"')
            self._diameter = ui.number("Diameter [mm]", value=_number(start.get("diameter")), min=1, max=500)
            self._height = ui.number("Height [mm]", value=_number(start.get("height")), min=1, max=500)
            self._ratio = ui.number("Mixing ratio", value=_number(start.get("mixed")) or self._state.ratio, step=0.1)
            self._name = ui.input("Name of the batch", value=start.get("name") or _free_name())
            base = start.get("base", "")
            self._base = ui.select(bases, value=base if base in bases else "", label="Resin whose law is updated")
        named = {"diameter": self._diameter, "height": self._height, "ratio": self._ratio, "name": self._name,
                 "base": self._base}  # fmt: skip
        for name, field in named.items():
            field.props(f'data-test="puck-{name}"')
        self._work = Work(self._studio, "puck", "Find the modulus", self._words, self._show, self._belongs,
                          lambda job: self._list())  # fmt: skip
        for field in (self._puck, *named.values()):
            field.on_value_change(self._renew)
        self._own = ui.element("section").style("width:100%")
        self._list()

    def _renew(self) -> None:
        given = {"puck": self._puck.value, "diameter": self._diameter.value, "height": self._height.value,
                 "mixed": self._ratio.value, "name": self._name.value, "base": self._base.value}  # fmt: skip
        keep_state(self._state, **{name: _text(value) for name, value in given.items()})
        self._work.renew_line()

    def _words(self) -> list[str]:
        sizes = {"diameter": self._diameter.value, "height": self._height.value, "ratio": self._ratio.value}
        for name, value in sizes.items():
            if value is None:
                raise InputError(f"Enter the {name} of the puck.")
        name = (self._name.value or "").strip()
        if not name:
            raise InputError("Give the batch a name.")
        known = entries("materials/resins").get(name.lower())
        if known is not None and known.origin != "user":
            raise InputError(f"'{known.name}' is a resin of the library: choose another name.")
        given = {"diameter": float(sizes["diameter"]), "height": float(sizes["height"]), "name": name,
                 "ratio": float(sizes["ratio"]), "resin": self._base.value}  # fmt: skip
        return ["resins", "add-compression", self._puck.value, *options(given)]

    def _belongs(self, job: Job) -> bool:
        try:
            return list(job.words) == self._words()
        except InputError:
            return False

    def _show(self, job: Job) -> None:
        answer = job.answer
        if "young_kPa" not in answer:
            return
        name = answer["name"]
        puck, friction = answer["young_kPa"], answer["friction"]
        html(f"<p><b>{escape(name)}</b> from {escape(Path(job.words[2]).name)}, ratio {answer['ratio']:g}.</p>")
        facts([(f"{puck['value']:.3g} kPa", f"modulus of this puck, 95 %: {puck['low']:.3g} to {puck['high']:.3g}"),
               (f"{answer['rmse_N']:.2g} N", "residual, rms"),
               (_friction(friction), "plate friction that fits, in the interval")])  # fmt: skip
        rows, problem = _moduli(self._studio.root / job.words[2], answer)
        if problem:
            html(f'<p class="problem" role="alert">{escape(problem)}</p>')
        table(["", "modulus kPa", "95 % low", "95 % high"], rows)
        if answer["action"] == "unchanged":
            html(f'<p class="note">{escape(name)} has this puck already. Nothing was changed.</p>')
        if answer.get("before"):
            html(f'<p class="note">The puck was known at {escape(str(answer["before"]))}. It was replaced.</p>')
        warnings(answer)
        html("<p>The resin is in your own library, for all projects. Add further pucks under its name.</p>")
        if not problem:
            button = ui.button(f"Use {name} for this project", on_click=lambda: self._use(name))
            button.props('data-test="use-resin"')

    def _use(self, name: str) -> None:
        change_project(self._studio.project or self._project, resin=name)
        open_page("/design", self._state.changed(resin=name))

    def _list(self) -> None:
        own = [entry for entry in entries("materials/resins").values() if entry.origin == "user"]
        self._own.clear()
        with self._own:
            if own:
                names = ", ".join(f"{one.name}{' (chosen)' * (one.name == self._state.resin)}" for one in own)
                html(f"<h2>Your own resins</h2><p>{escape(names)}</p>")


def pucks(root: Path) -> dict[str, str]:
    """Files that may be pucks: imported presses, and measured files that are traces as they are."""
    own = [path for path in sorted((root / "measured").glob("*.csv")) if _is_trace(path)]
    return choices.traces(root) | {f"measured/{path.name}": path.name for path in own}


def _is_trace(path: Path) -> bool:
    try:
        with open(path, encoding="utf-8") as stream:
            head = stream.readline(4096)
    except (OSError, UnicodeDecodeError):
        return False
    return {"time_s", "displacement_mm", "force_N"} <= {word.strip() for word in head.lstrip("\ufeff").split(",")}


def _moduli(puck: Path, answer: Mapping[str, Any]) -> tuple[list[list[object]], str]:
    """Rows of the resin's modulus at the puck's ratio without and with this puck; or what is wrong."""
    from dummydesign.measurement.trace import read_trace
    from dummydesign.resin.model.puck_point import recording_sha256
    from dummydesign.resin.model.resin_file import load_resin
    from dummydesign.resin.update.pucks import known_puck, without_puck

    this = answer["young_kPa"]
    rows: list[list[object]] = [["this puck alone", this["value"], this["low"], this["high"]]]
    try:
        resin, sha256 = load_resin(answer["name"]), recording_sha256(read_trace(puck))
    except InputError as said:
        return rows, f"{said}."
    if known_puck(resin, sha256) is None:
        return rows, f"The resin '{answer['name']}' does not hold this puck (any more). Run the command again."
    ratio = float(answer["ratio"])
    before, after = without_puck(resin, sha256).modulus_kPa(ratio), resin.modulus_kPa(ratio)
    named = ((f"before, at ratio {ratio:g}", before), (f"{answer['name']}, at ratio {ratio:g}", after))
    return [rows[0], *([words, one.value, one.low, one.high] for words, one in named)], ""


def _friction(found: Mapping[str, float | None]) -> str:
    low, high = ("bonded" if found[end] is None else f"{found[end]:.2g}" for end in ("low", "high"))
    return f"{low} to {high}"


def _last(root: Path) -> dict[str, str]:
    """Choices of the newest command of this page."""
    job = jobs.latest(root, "puck")
    if job is None:
        return {}
    given = dict(zip(job.words[3::2], job.words[4::2]))
    names = {"--diameter": "diameter", "--height": "height", "--ratio": "mixed", "--name": "name", "--resin": "base"}
    return {"puck": job.words[2]} | {name: given[word] for word, name in names.items() if word in given}


def _number(text: str | None) -> float | None:
    try:
        return float(text) if text else None
    except ValueError:
        return None


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, (int, float)) else str(value or "")


def _free_name() -> str:
    """A name that no resin of the library has."""
    known, number = entries("materials/resins"), 1
    name = "my-batch"
    while name in known:
        number += 1
        name = f"my-batch-{number}"
    return name
