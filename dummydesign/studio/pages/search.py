"""The search for the best pad on the design page: its panel, its results, designs of the project, one solved pad."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

from nicegui import run, ui

from dummydesign.core.errors import InputError
from dummydesign.core.outputs.manifest import NAME as MANIFEST
from dummydesign.geometry.standard import PUNCH
from dummydesign.project.folder import Project
from dummydesign.project.status import things_in
from dummydesign.studio import bench, choices, kinds
from dummydesign.studio.frame import (
    Studio,
    Work,
    facts,
    file_links,
    html,
    open_page,
    shown_file,
    state_link,
    table,
    tell_problem,
    tell_verdict,
    warnings,
)  # fmt: skip
from dummydesign.studio.glossary import marked
from dummydesign.studio.manage import manage
from dummydesign.studio.state import State, design_state, is_design
from dummydesign.studio.work import commands
from dummydesign.studio.work.inputs import changed_inputs, changed_since, holds_answer
from dummydesign.studio.work.jobs import Job

PATIENCE_S = 2.0
"""How long a pad must stay chosen before it is solved in the background. [s]"""
COMPARED = "designs/compared"
PRESS_HEAD = ("steady N", "mm/s", "depth mm", "pad peak N", "people N", "")


def question_options(state: State) -> dict[str, str]:
    """The options of ``suggest`` for what a state asks; project.toml may change, so all are typed."""
    return state.question


def question_of(words: Sequence[str], answer: Mapping[str, Any]) -> dict[str, str]:
    """What a command line of ``suggest`` asked, as :attr:`State.question` has it; what it lacks is in its answer."""
    used = answer.get("inputs") or {}
    given = {words[i][2:]: words[i + 1] for i in range(len(words) - 1) if words[i].startswith("--")}
    return {"tissue": given.get("tissue", str(used.get("tissue") or "")), "aim": given.get("aim", "average"),
            "resin": given.get("resin", ""), "calibration": given.get("calibration", ""),
            "punch": given.get("punch", str(used.get("punch") or PUNCH))}  # fmt: skip


def press_rows(presses: Sequence[Mapping[str, Any]]) -> list[list[object]]:
    """One row a press: steady force, speed, depth, peak of the pad, peaks of the subjects, how the pad reads.

    Parameters
    ----------
    presses : sequence of mapping
        ``conditions`` of the JSON of ``suggest``.
    """
    rows: list[list[object]] = []
    for one in presses:
        reached = one["peak_force_N"] is not None and one["peak_force_N"] == one["peak_force_N"]
        reads = str(one["reads"]) if reached else "out of reach"
        if reads in ("low", "high"):
            reads = f"{one['percent_outside']:.0f} % {reads}"
        rows.append([
            one["steady_force_N"], one["velocity_mm_s"], round(one["depth_mm"], 2) if reached else None,
            round(one["peak_force_N"], 1) if reached else None,
            f"{one['target_peak_low_N']:.1f} to {one['target_peak_high_N']:.1f}", reads,
        ])  # fmt: skip
    return rows


def state_of_answer(state: State, answer: dict[str, Any], folder: str) -> State:
    """The state of the pad that a search recommends.

    Parameters
    ----------
    state : State
        Of the page.
    answer : dict
        JSON of ``suggest``.
    folder : str
        Of the design, from the project folder on.
    """
    best = answer["recommendation"]
    return state.changed(shape=best["shape"], thickness_mm=float(best["thickness_mm"]), ratio=float(best["ratio"]),
                         resin=best["resin"] if best["resin"] == state.resin.rpartition("/")[2] else state.resin,
                         design=folder)  # fmt: skip


def _folder(job: Job) -> str:
    """The folder of a search's answer, from the project folder on; another number than asked for when it was taken."""
    return "designs/" + str(job.answer["inputs"]["out"]).replace("\\", "/").rpartition("/")[2]


class Search:
    """The panel of the search, with what belongs to the question of the page."""

    def __init__(
        self, studio: Studio, project: Project, state: Callable[[], State], take: Callable[[State], None]
    ) -> None:
        self.studio, self.project, self.state, self.take = studio, project, state, take
        asked = dict(project.asked)
        known = choices.shapes()
        wish = asked.get("shape", "auto").partition(":")[0]
        self.kinds = ui.select(known, value=wish if wish in known else "auto", label="Shapes to search")
        self.kinds.props('data-test="searched"').style("max-width:320px;width:100%")
        self.work = Work(studio, "suggest", "Find the best pad", self.words, self.show, self.belongs, self.ended,
                         self.stamp)  # fmt: skip
        self.kinds.on_value_change(self.work.renew_line)

    def renew(self) -> None:
        """The question changed."""
        self.work.renew_line()

    def words(self) -> list[str]:
        """The search as a command."""
        state = self.state()
        stem = state.tissue.rpartition("/")[2].removesuffix(".toml")
        given = {**question_options(state), "shape": self.kinds.value}
        return commands.suggest(given, f"suggest-{stem}{'-calibrated' if state.calibration else ''}")

    def belongs(self, job: Job) -> bool:
        """Whether a search was for what is chosen."""
        if question_of(job.words, job.answer) != self.state().question:
            return False
        return "recommendation" not in job.answer or holds_answer(self.studio.root, _folder(job), job.answer)

    def stamp(self) -> object:
        """Times of the files behind the question."""
        return bench.stamp_of(self.studio.root, bench.Asked.of(self.state()))

    def ended(self, job: Job) -> None:
        """Put the sliders at the pad that was found, when it is for what is chosen."""
        if self.belongs(job) and "recommendation" in job.answer:
            self.take(state_of_answer(self.state(), job.answer, _folder(job)))

    def show(self, job: Job) -> None:
        """What a search found: the pad, why this one, the other kinds, the presses."""
        answer = job.answer
        if "recommendation" not in answer:
            return
        for name in changed_inputs(self.studio.root, self.studio.root / _folder(job) / MANIFEST):
            tell_problem(f"The {name} has changed since this search. Search again.")
        best, light = answer["recommendation"], answer["verdict"]["light"]
        tell_verdict(str(light), str(answer["verdict"]["text"]))
        mixed = (answer["recommendation"].get("batch") or best["recipe"])["components"]
        facts([(f"{best['thickness_mm']:g} mm", best["shape"]), (f"{best['ratio']:g}", best["ratio_meaning"]),
               *((f"{part['mass_g']:.1f} g", f"{part['name']}, to mix") for part in mixed)])  # fmt: skip
        found = state_of_answer(self.state(), answer, _folder(job))
        link = state_link("/mould", "Make its mould", found, "mould")
        red = "This pad is not representative: do not cast it. " if light == "red" else ""
        html(f'<p class="note next">{red}{link}</p>')
        with ui.row():
            ui.button("Put the sliders at this pad", on_click=lambda: self.take(found), color=None).props("outline")
        table(PRESS_HEAD, press_rows(best["conditions"]))
        self._compare_kinds(answer)
        warnings(answer)
        if answer.get("files", {}).get("report"):
            file_links([("the whole report", answer["files"]["report"])])


    def _compare_kinds(self, answer: dict[str, Any]) -> None:
        """The best pad of each kind, and why this one; the verdicts of the others come a moment later."""
        compared = kinds.kinds_compared(answer)
        html("<h3>Why this pad</h3>" + "".join(f"<p>{marked(one)}</p>" for one in compared.sentences))
        if len(compared.rows) < 2:
            return
        box = ui.element("div").props('data-test="kinds"')
        with box:
            table(compared.head, compared.rows)
        root, asked = self.studio.root, bench.Asked.of(self.state())

        def judge() -> Any:
            inputs = bench.inputs_of(root, asked, bench.stamp_of(root, asked))
            return kinds.kinds_compared(answer, kinds.verdicts_of_kinds(inputs, answer))

        async def fill() -> None:
            try:
                full = await run.io_bound(judge)
            except InputError:
                return
            if full is not None and not box.is_deleted:
                box.clear()
                with box:
                    table(full.head, full.rows)

        ui.timer(0.1, fill, once=True)


class Designs:
    """The designs of the project: open one again, or hold several side by side."""

    def __init__(self, studio: Studio, state: Callable[[], State]) -> None:
        self.studio, self.state = studio, state
        self.seen: list[str] = []
        self.box = ui.element("div").style("width:100%").props('data-test="designs"')
        self.chosen: Any = None
        self.renew()
        ui.timer(2.0, self.renew)
        self.work = Work(studio, "compare-designs", "Compare them", self.words, self.show, self.belongs)

    def _found(self) -> list[Any]:
        project = self.studio.project
        every = things_in(project.root, "designs") if project else []
        return [one for one in every if is_design(one) and design_state(self.studio.root, one.folder)]

    def moved(self, old: str, new: str) -> None:
        """Follow a design that was renamed, deleted or brought back; the pad stays under the sliders."""
        state = self.state()
        if state.design == old:
            open_page("/design", replace(state, design=new))
        else:
            self.renew()

    def renew(self) -> None:
        """List the designs anew when one came or went."""
        found = self._found()
        names = [f"{one.folder} {one.date}" for one in found]
        if names == self.seen and self.chosen is not None:
            return
        self.seen = names
        kept = list(self.chosen.value) if self.chosen is not None else []
        self.box.clear()
        with self.box:
            if not found:
                html("<p>none yet</p>")
            for one in reversed(found):
                opened = self.state().changed(**{**design_state(self.studio.root, one.folder), "missing": ()})
                verdict = str((one.summary or {}).get("verdict", "")).replace("_", " ")
                link = state_link("/design", opened.design.partition("/")[2], opened)
                with ui.element("div").classes("thing").props('data-test="design"'):
                    html(f"<span>{link}: {escape(opened.label)}: <b>{escape(verdict)}</b></span>")
                    with ui.element("div"):
                        manage(self.studio, one.folder, "design", self.moved)
            folders = [one.folder for one in found]
            kept = [name for name in kept if name in folders]
            value = kept if len(kept) > 1 else folders[-2:]
            self.chosen = ui.select(folders, multiple=True, value=value, label="Designs to compare")
            self.chosen.props('use-chips data-test="to-compare"').style("width:100%")
            self.chosen.on_value_change(lambda: self.work.renew_line())
        if hasattr(self, "work"):
            self.work.renew_line()

    def words(self) -> list[str]:
        """The comparison as a command."""
        chosen = list(self.chosen.value or [])
        if len(chosen) < 2:
            raise InputError("choose two designs or more to compare them")
        return ["compare-designs", *chosen, "--out", COMPARED, "--replace"]

    def belongs(self, job: Job) -> bool:
        """Whether a comparison is of the designs that are chosen."""
        compared = {word for word in job.words if word.startswith("designs/")} - {COMPARED}
        same = compared == set(self.chosen.value or ())
        # each comparison takes the place of the one before
        return same and (not job.answer or holds_answer(self.studio.root, COMPARED, job.answer))

    def show(self, job: Job) -> None:
        """The page of the comparison."""
        report = job.answer.get("files", {}).get("report")
        if report:
            for name in changed_inputs(self.studio.root, self.studio.root / COMPARED / MANIFEST):
                tell_problem(f"{name} has changed since this comparison. Compare again.")
            shown_file(f"/files/{report}", "designs side by side")


class SolvedPad:
    """A pad that no table holds, solved in the background; shown while it is the pad that is chosen."""

    def __init__(
        self, studio: Studio, state: Callable[[], State], judge: Callable[[Mapping[str, Any]], None]
    ) -> None:
        self.studio, self.state, self.judge = studio, state, judge
        self.box = ui.element("div").style("width:100%").props('data-test="solved"')
        self.work: Work | None = None
        self.box.set_visibility(False)

    def hide(self) -> None:
        """Another pad is chosen."""
        self.box.set_visibility(False)

    def offer(self) -> None:
        """Solve the chosen pad, unless it is solved or something of this kind is at work."""
        self.box.set_visibility(True)
        if self.work is None:
            with self.box:
                html("<p>No table holds this pad. It is solved by finite elements in the background.</p>")
                self.work = Work(self.studio, "pad", "Solve this pad", self.words, self.show, self.belongs, self.ended)
        self.work.show_again()
        chosen = self.state()
        ui.timer(PATIENCE_S, lambda: self._begin(chosen), once=True)

    def _begin(self, chosen: State) -> None:
        """Start to solve a pad that is still chosen and not solved yet."""
        idle = self.work is not None and not self.work.answered and not self.work.running
        if idle and self.box.visible and self.work is not None and self.state() == chosen:
            self.work.begin()

    def ended(self, job: Job) -> None:
        """A pad that was chosen meanwhile is solved next."""
        if self.box.visible and not self.belongs(job):
            self.offer()

    def words(self) -> list[str]:
        """The pad as a command that solves it."""
        state = self.state()
        t, r = f"{state.thickness_mm:g}", f"{state.ratio:g}"
        given = {**question_options(state), "shape": state.shape}
        if bench.solved_by_predict(state):
            shape = bench.shape_of(state.shape)
            return ["predict", *commands.options({**given, "thickness": t, "ratio": r, "fidelity": shape.fidelity})]
        out = f"pad-{t}mm-{r}"
        return commands.suggest({**given, "thickness": f"{t}:{t}", "ratio": f"{r}:{r}"}, out)

    def belongs(self, job: Job) -> bool:
        """Whether a job solved the pad that is chosen."""
        try:
            same = list(job.words) == self.words()
        except InputError:
            return False
        stamp = bench.stamp_of(self.studio.root, bench.Asked.of(self.state()))
        return same and not changed_since([Path(path) for path, *_ in stamp], job.started)

    def show(self, job: Job) -> None:
        """The verdict and the presses of the solved pad."""
        answer = job.answer
        verdict = answer.get("verdict")
        if not verdict:
            return
        self.judge(verdict)
        warnings(answer)
        rows = (answer.get("recommendation") or answer).get("conditions") or []
        table(PRESS_HEAD, press_rows([one for one in rows if "reads" in one]))
