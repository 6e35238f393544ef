"""The search for the best pad on the design page: its panel, its results, designs of the project, one solved pad."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.core.levels import level_name
from dummydesign.core.manifest import NAME as MANIFEST
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.project.folder import Project
from dummydesign.report import suggest_facts
from dummydesign.report.front_page import full_sentence
from dummydesign.studio import figures, jobs, select_options, slider_model, widgets
from dummydesign.studio.file_actions import thing
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.markup import Markup, filled
from dummydesign.studio.state import NO_TISSUE, QUESTION_FIELDS, State, designs_of, options_of, page_link, punch_of
from dummydesign.studio.widgets import html, open_page


def question_of(words: Sequence[str], answer: Mapping[str, Any]) -> dict[str, str]:
    """What a command line of ``suggest`` asked, as :attr:`State.question` has it; what it lacks is in its answer."""
    used = answer.get("inputs") or {}
    given = options_of(words)
    usual = {"tissue": str(used.get("tissue") or ""), "aim": "average", "punch": str(used.get("punch") or PUNCH)}
    return {name: given.get(name, usual.get(name, "")) for name in QUESTION_FIELDS}


def show_presses(presses: Sequence[Mapping[str, Any]], under: str = "") -> None:
    """Show the table of presses as the report of a design has it; ``under`` is the line that it is folded under."""
    table = suggest_facts.press_rows({"recommendation": {"conditions": presses}})
    widgets.table(table.head, table.rows, under=under)


def state_of_answer(state: State, answer: dict[str, Any], folder: str) -> State:
    """The state of the pad that a search recommends."""
    best = answer["recommendation"]
    resin = best["resin"] if best["resin"] == state.resin.rpartition("/")[2] else state.resin
    return state.changed(
        shape=best["shape"],
        thickness_mm=float(best["thickness_mm"]),
        ratio=float(best["ratio"]),
        resin=resin,
        design=folder,
    )


def _folder(job: jobs.Job) -> str:
    """The folder of a search's answer, from the project folder on; another number than requested when it was taken."""
    out = str(job.answer["inputs"]["out"]) if "recommendation" in job.answer else ""
    return out and "designs/" + out.replace("\\", "/").rpartition("/")[2]


class Search:
    """The panel of the search, with what belongs to the question of the page."""

    def __init__(
        self, project: Project, state: Callable[[], State], take: Callable[[State], None], found: ui.element
    ) -> None:
        self.root, self.state, self.take = project.root, state, take
        known = select_options.shapes()
        last = jobs.latest(self.root, "suggest")
        asked = dict(project.asked) | options_of(last.words if last else ())
        wish = asked.get("shape", "auto").partition(":")[0]
        place = ui.element("div").style("width:100%")
        self.kinds = widgets.select("Shapes to search", known, wish if wish in known else "auto", "searched")
        with place:
            self.work = JobPanel(
                self.root,
                "suggest",
                "Find the best pad",
                self.words,
                self.show,
                lambda job, words: question_of(job.words, job.answer) == self.state().question,
                _folder,
                self.ended,
                lambda: slider_model.stamp_of(self.root, self.state()),
                "recommendation",
                found=found,
                warn=False,
            )
        self.kinds.on_value_change(self.work.renew)

    def words(self) -> list[str]:
        """The search as a command."""
        state = self.state()
        if not state.tissue:
            raise InputError(NO_TISSUE, "missing", "tissue")
        stem = state.tissue.rpartition("/")[2].removesuffix(".toml")
        out = f"designs/suggest-{stem}{'-calibrated' if state.calibration else ''}"
        return jobs.command("suggest", **state.question, shape=self.kinds.value, no_cad=True, out=out)

    def ended(self, job: jobs.Job, mine: bool) -> None:
        """Put the sliders at the pad that was found, when it is for what is chosen."""
        if mine and _folder(job):
            self.take(state_of_answer(self.state(), job.answer, _folder(job)))

    def show(self, job: jobs.Job) -> None:
        """What a search found: its mould is next; folded why this one, the other kinds, the presses, warnings."""
        answer = job.answer
        widgets.tell_changes(self.root, f"{_folder(job)}/{MANIFEST}", "Search again.")
        best, light = answer["recommendation"], answer["verdict"]["light"]
        designed = state_of_answer(self.state(), answer, _folder(job))
        pad = f"{best['shape'].partition(':')[0]}, {best['thickness_mm']:g} mm, ratio {best['ratio']:g}"
        if light == "red":
            widgets.tell_problem(f"The best pad found ({pad}) is red: do not cast it.")
        widgets.button(f"Put the sliders at this pad: {pad}", lambda: self.take(designed), "best-pad")

        def tell_why() -> None:
            widgets.warnings(answer)
            if answer.get("files", {}).get("report"):
                widgets.file_links([("the whole report", answer["files"]["report"])])
            html("<p>{}</p>", widgets.marked(full_sentence(suggest_facts.why_text(answer))))
            widgets.records(figures.KIND_COLUMNS, figures.kind_rows(answer))
            show_presses(best["conditions"])

        words = "Why this pad: the other kinds, the presses"
        notes = len(answer.get("warnings", []))
        widgets.fold(words + (f", {notes} warning{'s' * (notes > 1)}" if notes else ""), "why", tell_why)


class DesignList:
    """The designs of the project: open one again, or draw several over each other."""

    def __init__(self, root: Path, state: Callable[[], State]) -> None:
        self.root, self.state = root, state
        self.stamps: list[tuple[Path, int]] | None = None
        self.box = widgets.area("designs")
        self.chosen = widgets.select_several("Designs to compare", {}, [], "to-compare")
        self.drawn = html("").props('data-test="compared"').style("width:100%")
        self.chosen.on_value_change(self.draw)
        self.renew()
        ui.timer(2.0, self.renew)

    def moved(self) -> None:
        """Follow a design that was deleted or brought back; the pad stays under the sliders."""
        state = self.state()
        if state.design and not (self.root / state.design).is_dir():
            open_page("/design", replace(state, design=""))
        else:
            self.renew()

    def renew(self) -> None:
        """List the designs anew when one came or went."""
        root = self.root
        stamps = [(path, path.stat().st_mtime_ns) for path in sorted((root / "designs").glob(f"*/{MANIFEST}"))]
        if stamps == self.stamps:
            return
        self.stamps = stamps
        designs = designs_of(root)
        with widgets.fresh(self.box):
            if not designs:
                html("<p>none yet</p>")
            for one in reversed(designs.values()):
                opened = self.state().changed(**one.given, missing=())
                link = page_link("/design", one.folder.partition("/")[2], opened)
                words = filled("<span>{}: {}: <b>{}</b></span>", link, opened.label, level_name(one.level))
                thing(words, root, one.folder, "design", self.moved).props('data-test="design"')
        kept = [name for name in self.chosen.value if name in designs]
        self.chosen.set_options({one: one for one in designs}, value=kept if len(kept) > 1 else [*designs][-2:])
        self.draw()

    def draw(self) -> None:
        """Draw the steady curves of the designs that are chosen over each other."""
        plot = figures.designs_plot(self.root, self.chosen.value)
        self.drawn.set_content("" if plot is None else Markup(plot.html()))


class SolvedPad:
    """The pad that is seen, solved by finite elements where a click asks for it."""

    def __init__(self, root: Path, state: Callable[[], State], solved: Callable[[], None]) -> None:
        self.root, self.state = root, state
        self.untabulated = False
        self.box = widgets.area("solved")
        with self.box:
            self.work = JobPanel(
                self.root,
                "pad",
                "Solve this pad",
                self.words,
                self.show,
                ended=lambda job, mine: solved(),
                reads=lambda: [Path(path) for path, *_ in slider_model.stamp_of(root, state())],
            )
        self.renew(False, False)

    def renew(self, able: bool, main: bool, untabulated: bool = False) -> None:
        """Offer to solve the pad that is chosen now; ``untabulated`` is whether no table holds it."""
        self.untabulated = untabulated
        self.box.set_visibility(able)
        self.work.main = main
        if able:
            self.work.renew()

    @property
    def verdict(self) -> tuple[str, str] | None:
        """Light and sentence of the pad that is chosen; None before it was solved."""
        job = self.work.shown if self.box.visible else None
        found = job.answer.get("verdict") if job else None
        return (str(found["light"]), str(found["text"])) if found else None

    def words(self) -> list[str]:
        """The pad as a command that solves it: a search that may take this pad alone."""
        state = self.state()
        t, r = f"{state.thickness_mm:g}", f"{state.ratio:g}"
        # predict solves a shape that no table holds, under a flat punch on a glued base
        if self.untabulated and state.kind != "slab" and punch_of(self.root, state.punch).profile_mm is None:
            fidelity = read_shape(state.shape).fidelity
            return jobs.command("predict", **state.question, shape=state.shape, thickness=t, ratio=r, fidelity=fidelity)
        return jobs.command(
            "suggest",
            **state.question,
            shape=state.shape,
            thickness=f"{t}:{t}",
            ratio=f"{r}:{r}",
            no_cad=True,
            out=f"designs/pad-{state.kind}-{t}mm-{r}",
        )

    def show(self, job: jobs.Job) -> None:
        """The presses of the solved pad."""
        rows = (job.answer.get("recommendation") or job.answer).get("conditions") or []
        show_presses([one for one in rows if "reads" in one], "the solved presses")
