"""Design a pad: sliders that answer at once with the verdict in sight, and the search for the best one."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from html import escape
from typing import Any

from nicegui import run, ui

from dummydesign.core.errors import InputError
from dummydesign.geometry.standard import PUNCH
from dummydesign.project.folder import Project
from dummydesign.project.status import status_of
from dummydesign.studio import bench, choices, figures
from dummydesign.studio.frame import (
    Studio,
    Work,
    command_line,
    facts,
    file_links,
    html,
    lay_out,
    page_link,
    shown_file,
    table,
    warnings,
)  # fmt: skip
from dummydesign.studio.slider import Slider
from dummydesign.studio.state import State
from dummydesign.studio.work import commands
from dummydesign.studio.work.jobs import Job

SETTLE_S = 0.35
"""After this time without a move the verdict counts what castings may turn out as. [s]"""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/design", "Design", query, lambda project, state: Page(studio, project, state) and None)


class Page:
    """The page; what is chosen on it lives in its fields alone until a command is started."""

    def __init__(self, studio: Studio, project: Project, state: State) -> None:
        self.studio, self.root, self.project = studio, studio.root, project
        self.wanted = self.shown = 0
        self.busy = False
        asked = dict(project.asked)
        known = choices.tissues(self.root)
        best = self._newest()
        self.verdict = ui.element("div").classes("sticky").props('role="status" aria-live="polite" data-test="verdict"')
        html('<p><a href="#search">Find the best pad</a>, or move the sliders:</p>')
        with ui.element("div").classes("two"):
            with ui.element("div"):
                tissue = project.tissue if project.tissue in known else next(iter(known))
                self.tissue = ui.select(known, value=tissue, label="Tissue").props('data-test="tissue"')
                aims = choices.aims(bench._path(self.root, tissue))
                aim = asked.get("aim", "average")
                self.aim = ui.select(aims, value=aim if aim in aims else "average", label="Aim")
                resins = choices.resins()
                resin = project.resin or "polyurethane-nagoya"
                resins = resins if resin in resins else {resin: resin, **resins}
                self.resin = ui.select(resins, value=resin, label="Resin")
                found = choices.folders(self.root, "calibrations", "calibration.json")
                calibrations = {"": "none"} | {f"{one}/calibration.json": one for one in reversed(found)}
                self.calibration = ui.select(calibrations, value=state.calibration,
                                             label="Calibration")  # fmt: skip
                self.punch = ui.input("Punch", value=project.punch or PUNCH).props('data-test="punch"')
                shape = str(best.get("shape", "slab"))
                kinds = {**choices.shapes()}
                kinds.pop("auto")
                self.kind = ui.select(kinds, value=shape.partition(":")[0], label="Shape").props('data-test="kind"')
                self.shape = ui.input("Shape with its lengths", value=shape)
                thick, mixed = float(best.get("thickness_mm", 6.0)), float(best.get("ratio", 15.0))
                self.thickness = Slider("Thickness", "mm", 3.0, 30.0, 0.1, thick, self.move)
                self.ratio = Slider("Ratio", "", mixed, mixed, 0.05, mixed, self.move)
            with ui.element("div"):
                self.numbers = ui.element("div")
                self.plots = ui.html("", sanitize=False).props('data-test="plots"').style("width:100%")
                self.solid = ui.element("div").style("width:100%")
        for field in (self.tissue, self.aim, self.resin, self.calibration, self.punch, self.kind, self.shape):
            field.style("width:100%")
        self.tissue.on_value_change(self.new_tissue)
        self.kind.on_value_change(self.new_kind)
        for one in (self.aim, self.resin, self.calibration):
            one.on_value_change(self.new_space)
        self.punch.on("change", self.new_space)
        self.shape.on("change", self.move)
        with ui.element("div"):
            html("<h2>This pad by the command line</h2>")
            self.same = ui.element("div").style("width:100%")
            html("<h2 id=search>Find the best pad</h2><p>Searches thickness, ratio and lengths, checks the best by "
                 "finite elements and writes the report. The sliders then stand at it.</p>")  # fmt: skip
            self.searched = ui.select(choices.shapes(), value=asked.get("shape", "auto"), label="Shapes to search")
            self.searched.props('data-test="searched"').style("max-width:320px;width:100%")
            self.work = Work(studio, "suggest", "Find the best pad", self.words, self.show)
            self.searched.on_value_change(self.work.renew_line)
        self.new_space()

    def _newest(self) -> dict[str, Any]:
        found = [one.summary for one in status_of(self.project).found["designs"] if one.summary]
        named = [one for one in found if {"shape", "thickness_mm", "ratio"} <= set(one)]
        return named[-1] if named else {}

    def asked(self) -> bench.Asked:
        """What is chosen above the sliders."""
        return bench.Asked(self.tissue.value, self.aim.value, self.resin.value, self.calibration.value or "",
                           self.punch.value.strip() or PUNCH)  # fmt: skip

    def words(self) -> list[str]:
        """The search as a command."""
        asked = self.asked()
        given = {"tissue": asked.tissue, "aim": asked.aim, "resin": asked.resin, "shape": self.searched.value,
                 "calibration": asked.calibration, "punch": self._typed_punch()}  # fmt: skip
        stem = asked.tissue.rpartition("/")[2].removesuffix(".toml")
        return commands.suggest(given, f"suggest-{stem}{'-calibrated' if asked.calibration else ''}")

    def pad_words(self) -> list[str]:
        """The pad under the sliders as a command: a search whose limits are this pad."""
        asked, t, r = self.asked(), f"{self.thickness.value:g}", f"{self.ratio.value:g}"
        pad = {"tissue": asked.tissue, "aim": asked.aim, "resin": asked.resin, "shape": self.shape.value}
        punch = self._typed_punch()
        if abs(2.0 * self.thickness.value - round(2.0 * self.thickness.value)) > 1e-9:
            if asked.calibration:
                raise InputError("with a calibration the command line takes steps of 0.5 mm: choose such a thickness")
            return ["predict", *commands.options({**pad, "thickness": t, "ratio": r, "punch": punch})]
        given = {**pad, "thickness": f"{t}:{t}", "ratio": f"{r}:{r}", "calibration": asked.calibration, "punch": punch}
        return commands.suggest(given, f"pad-{t}mm-{r}")

    def _typed_punch(self) -> str:
        """The punch as an option; empty where the command takes the same by itself."""
        punch = self.asked().punch
        return "" if punch == PUNCH and self.project.punch in (None, PUNCH) else punch

    def new_tissue(self) -> None:
        """Offer the aims of the tissue."""
        aims = choices.aims(bench._path(self.root, self.tissue.value))
        self.aim.set_options(aims, value=self.aim.value if self.aim.value in aims else "average")
        self.new_space()

    def new_kind(self) -> None:
        """Begin a kind of shape with usual lengths."""
        kind = self.kind.value
        if self.shape.value.partition(":")[0] != kind:
            self.shape.set_value(kind if kind == "slab" else f"{kind}:{bench.LENGTHS.get(kind, '')}")
        self.move()

    def new_space(self) -> None:
        """Tissue, aim, resin or calibration changed."""
        from dummydesign.resin import load_resin

        resin = load_resin(bench._path(self.root, self.resin.value))
        self.ratio.limit(resin.ratio_min, resin.ratio_max, resin.ratio_step / 2, resin.ratio_meaning)
        self.work.renew_line()
        self.move()

    def move(self) -> None:
        """Something changed: look again, once for all moves that came in the meantime."""
        self.wanted += 1
        if not self.busy:
            ui.timer(0.0, self.follow, once=True)

    async def follow(self) -> None:
        """Show the newest wish until there is no newer one, then settle the verdict."""
        if self.busy:
            return
        self.busy = True
        try:
            while self.shown != self.wanted:
                self.shown = self.wanted
                found = await run.io_bound(self.look)
                self._draw(*found)
        finally:
            self.busy = False
        number = self.wanted
        await asyncio.sleep(SETTLE_S)
        if number == self.wanted and found[0] is not None:
            settled = await run.io_bound(bench.settled, found[0], found[1], found[2])
            if number == self.wanted:
                self._say(settled.light, settled.text, "settled")
                self.show_solid()
                self._tell_same()

    def _tell_same(self) -> None:
        self.same.clear()
        with self.same:
            try:
                command_line(self.pad_words())
            except InputError as said:
                html(f'<p class="note">{escape(str(said))}</p>')

    def look(self) -> tuple[Any, Any, Any, str, str]:
        """Press the pad and draw it, apart from the page."""
        asked = self.asked()
        try:
            inputs = bench.inputs_of(self.root, asked, bench.stamp_of(self.root, asked))
            shape = bench.shape_of(self.shape.value)
            pad = bench.look(inputs, shape, self.thickness.value, self.ratio.value)
        except InputError as problem:
            return None, None, None, "", str(problem)
        targets = inputs.space.targets
        plots = [figures.steady(inputs.tissue, targets, pad), figures.press(targets, pad, len(targets.conditions) - 1),
                 figures.section(shape, self.thickness.value, inputs.punch)]  # fmt: skip
        return inputs, shape, pad, f'<div class="plots">{"".join(one.html() for one in plots)}</div>', ""

    def _draw(self, inputs: Any, shape: Any, pad: Any, plots: str, problem: str) -> None:
        if problem:
            self._say("red", problem, "refused")
            return
        self.plots.set_content(plots)
        self._say(pad.verdict.light, pad.verdict.text, "")
        young = 1e3 * float(inputs.space.resin.young_MPa(self.ratio.value))
        self.numbers.clear()
        with self.numbers:
            facts([(f"{young:.3g} kPa", "modulus"), (f"{self.thickness.value:g} mm", "thickness"),
                   (f"{self.ratio.value:g}", inputs.space.resin.ratio_meaning)])  # fmt: skip

    def _say(self, light: str, text: str, state: str) -> None:
        note = "" if state else " <small>(castings are being counted …)</small>"
        self.verdict.clear()
        with self.verdict:
            html(f'<div class="verdict {light}" data-state="{state}"><span class="light" aria-hidden="true"></span>'
                 f'<p><span class="hide">{light} light: </span>{escape(text)}{note}</p></div>')  # fmt: skip

    def show_solid(self) -> None:
        """The pad as a solid to turn."""
        from urllib.parse import urlencode

        self.solid.clear()
        with self.solid:
            asked = urlencode({"shape": self.shape.value, "thickness": f"{self.thickness.value:g}"})
            shown_file(f"/solid/pad?{asked}", "the pad as a solid", "shown solid")

    def show(self, job: Job) -> None:
        """What the search found."""
        answer = job.answer
        if "recommendation" not in answer:
            return
        best = answer["recommendation"]
        self.kind.set_value(best["shape"].partition(":")[0])
        self.shape.set_value(best["shape"])
        self.thickness.set(best["thickness_mm"])
        self.ratio.set(best["ratio"])
        html(f'<div class="verdict {answer["verdict"]["light"]}"><span class="light" aria-hidden="true"></span>'
             f"<p>{escape(answer['verdict']['text'])}</p></div>")  # fmt: skip
        recipe = best["recipe"]
        facts([(f"{best['thickness_mm']:g} mm", best["shape"]), (f"{best['ratio']:g}", best["ratio_meaning"]),
               *((f"{part['mass_g']:.1f} g", part["name"]) for part in recipe["components"])])  # fmt: skip
        rows = [[c["steady_force_N"], c["velocity_mm_s"], c["depth_mm"], c["peak_force_N"], c["inside_fraction"]]
                for c in best["conditions"]]  # fmt: skip
        table(["steady N", "mm/s", "depth mm", "peak N", "fraction in range"], rows)
        warnings(answer)
        if answer.get("files", {}).get("report"):
            file_links([("the whole report", answer["files"]["report"])])
        html(f'<p class="note next">{page_link("/mould", "Make its mould", "mould")}</p>')
