"""Design a pad: sliders that answer at once with the verdict in sight, and the search for the best one."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from typing import Any

from nicegui import run, ui

from dummydesign.core.errors import InputError
from dummydesign.geometry.shapes import read_shape
from dummydesign.geometry.standard import PUNCH
from dummydesign.project.folder import Project
from dummydesign.studio import bench, choices, figures
from dummydesign.studio.frame import (
    Studio,
    command_line,
    facts,
    html,
    keep_state,
    lay_out,
    open_page,
    shown_file,
    table,
    tell_verdict,
)  # fmt: skip
from dummydesign.studio.lengths import lengths_of
from dummydesign.studio.pages import search
from dummydesign.studio.slider import Slider
from dummydesign.studio.state import State, absolute
from dummydesign.studio.work import commands

SETTLE_S = 0.35
"""After this time without a move the verdict counts what castings may turn out as. [s]"""
WATCH_S = 2.0
"""How often the files behind the verdict are looked at. [s]"""
LONGEST_RATIO_UNIT = 8


@dataclass(frozen=True)
class View:
    """Everything that is drawn of one state: a pad with its plots, or why there is none."""

    state: State
    inputs: Any = None
    shape: Any = None
    pad: Any = None
    plots: str = ""
    presses: Sequence[Sequence[object]] = ()
    problem: str = ""
    solvable: bool = False


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""

    def body(project: Project, state: State) -> None:
        Page(studio, project, state)

    lay_out(studio, "/design", "Design", query, body)


class Page:
    """The page: one state, from which every control and every panel is drawn."""

    def __init__(self, studio: Studio, project: Project, state: State) -> None:
        self.studio, self.root, self.project, self.state = studio, studio.root, project, state
        self.wanted = self.shown = 0
        self.busy = self.setting = False
        self.lengths: dict[str, Slider] = {}
        self.kind_of_lengths: tuple[str, float] = ("", 0.0)
        self.verdict = ui.element("div").classes("sticky").props('role="status" aria-live="polite" data-test="verdict"')
        html('<p><a href="#search">Find the best pad</a>, or move the sliders:</p>')
        with ui.element("div").classes("two"):
            with ui.element("div"):
                self._controls()
            with ui.element("div"):
                self.numbers = ui.element("div").props('data-test="numbers"')
                self.plots = ui.html("", sanitize=False).props('data-test="plots"').style("width:100%")
                self.solid = ui.element("div").style("width:100%").props('data-test="solid"')
                self.solved = search.SolvedPad(studio, lambda: self.state, self.say_solved)
        html("<h2>This pad by the command line</h2>")
        self.same = ui.element("div").style("width:100%").props('data-test="same"')
        html("<h2 id=search>Find the best pad</h2><p>Searches thickness, ratio and lengths, checks the best by finite "
             "elements and writes the report. The sliders then stand at it.</p>")  # fmt: skip
        self.search = search.Search(studio, project, lambda: self.state, self.take)
        html("<h2>Designs of this project</h2>")
        search.Designs(studio, lambda: self.state)
        self.stamp: object = None
        self.take(state)
        ui.timer(WATCH_S, self.watch)

    def _controls(self) -> None:
        """Build the controls, empty of what the state says."""
        self.tissue = ui.select({}, label="Tissue").props('data-test="tissue"')
        self.aim = ui.select({}, label="Aim")
        self.resin = ui.select({}, label="Resin").props('data-test="resin"')
        self.calibration = ui.select({}, label="Calibration").props('data-test="calibration"')
        self.punch = ui.input("Punch").props('data-test="punch"')
        kinds = {name: words for name, words in choices.shapes().items() if name != "auto"}
        self.kind = ui.select(kinds, label="Shape").props('data-test="kind"')
        self.thickness = Slider("Thickness", "mm", 3.0, 30.0, 0.1, self.state.thickness_mm, self.moved)
        self.ratio = Slider("Ratio", "", self.state.ratio, self.state.ratio, 0.05, self.state.ratio, self.moved)
        self.length_box = ui.element("div").style("width:100%")
        self.shape = ui.input("Shape with its lengths").props('data-test="shape"')
        for field in (self.tissue, self.aim, self.resin, self.calibration, self.punch, self.kind, self.shape):
            field.style("width:100%")
        self.tissue.on_value_change(lambda: self.choose(tissue=self.tissue.value))
        self.aim.on_value_change(lambda: self.choose(aim=self.aim.value))
        self.resin.on_value_change(lambda: self.choose(resin=self.resin.value))
        self.calibration.on_value_change(lambda: self.choose(calibration=self.calibration.value))
        self.punch.on("change", lambda: self.choose(punch=self.punch.value.strip() or PUNCH))
        self.shape.on("change", lambda: self.choose(shape=self.shape.value.strip() or "slab"))
        self.kind.on_value_change(self.begin_kind)

    # The state and its controls.

    def choose(self, **new: Any) -> None:
        """Take what was chosen in a control; all others follow."""
        if self.setting:
            return
        after = self.state.changed(**new)
        if after.tissue != self.state.tissue:
            aims = self._aims(after.tissue)
            after = after.changed(aim=after.aim if after.aim in aims else "average")
        if after != self.state and after.missing:
            # what the page says at its top may be no longer true
            open_page("/design", after)
        elif after != self.state:
            self.take(after)

    def moved(self) -> None:
        """Take what a slider says; the sliders themselves are left alone while they move."""
        self.state = self.state.changed(thickness_mm=self.thickness.value, ratio=self.ratio.value)
        self.evaluate()

    def length_moved(self, name: str) -> None:
        """Take a length; those that its table ties to it follow."""
        try:
            shape = read_shape(self.state.shape).with_length(name, self.lengths[name].value)
        except InputError:
            return
        self.state = self.state.changed(shape=str(shape))
        self.shape.set_value(self.state.shape)
        self.evaluate()

    def begin_kind(self) -> None:
        """Begin a kind of shape with lengths that can be pressed at this thickness."""
        kind = self.kind.value
        if self.setting or kind == self.state.shape.partition(":")[0]:
            return
        self.choose(shape=self.first_shape(kind))

    def first_shape(self, kind: str) -> str:
        """The text of a shape of a kind that can be pressed, or the bare kind with its reason said later."""
        state = self.state
        try:
            asked = bench.Asked.of(state)
            inputs = bench.inputs_of(self.root, asked, bench.stamp_of(self.root, asked))
            near = bench.shape_of(state.shape) if state.shape.startswith(f"{kind}:") else None
            return str(bench.first_pad(inputs, kind, state.thickness_mm, state.ratio, near))
        except InputError as problem:
            ui.notify(str(problem), type="warning", multi_line=True)
            return state.shape

    def take(self, state: State) -> None:
        """Show a state: every control and every panel."""
        self.state, self.setting = state, True
        try:
            self._set_choices(state)
            self._set_sliders(state)
        finally:
            self.setting = False
        self.search.renew()
        self.evaluate()

    def _aims(self, tissue: str) -> dict[str, str]:
        try:
            return choices.aims(absolute(self.root, tissue))
        except InputError:
            return {}

    def _set_choices(self, state: State) -> None:
        """Offer what there is; what is chosen and not there is offered as missing, and nothing takes its place."""

        def offer(field: ui.select, known: dict[str, str], value: str) -> None:
            field.set_options(known if value in known else {value: f"{value} (missing)", **known}, value=value)

        found = choices.folders(self.root, "calibrations", "calibration.json")
        offer(self.tissue, choices.tissues(self.root), state.tissue)
        offer(self.aim, self._aims(state.tissue), state.aim)
        resins = choices.resins()
        own = {} if state.resin in resins or not (self.root / state.resin).is_file() else {state.resin: state.resin}
        offer(self.resin, {**own, **resins}, state.resin)
        offer(self.calibration, {"": "none"} | {f"{one}/calibration.json": one for one in reversed(found)},
              state.calibration)  # fmt: skip
        self.kind.set_value(state.shape.partition(":")[0].lower())
        self.punch.set_value(state.punch)
        self.shape.set_value(state.shape)

    def _set_sliders(self, state: State) -> None:
        from dummydesign.resin import load_resin

        self.thickness.set(state.thickness_mm)
        try:
            resin = load_resin(absolute(self.root, state.resin))
        except InputError:
            self.ratio.set(state.ratio)
        else:
            self.ratio.value = state.ratio
            self.ratio.limit(resin.ratio_min, resin.ratio_max, resin.ratio_step / 2, resin.ratio_meaning)
            if self.ratio.value != state.ratio:
                words = f"{resin.name} has no ratio {state.ratio:g}. The ratio is now {self.ratio.value:g}."
                ui.notify(words, type="warning", multi_line=True)
                self.state = state.changed(ratio=self.ratio.value)
        self._set_lengths()

    def _set_lengths(self) -> None:
        """Sliders of the shape's lengths, with the ends that they have at this thickness."""
        kind, state = self.state.shape.partition(":")[0].lower(), self.state
        try:
            radius = bench.read_punch(state.punch).radius_mm
            values = dict(bench.shape_of(state.shape).parameters)
            lengths = lengths_of(kind, state.thickness_mm, radius)
        except (InputError, AttributeError):
            values, lengths = {}, ()
        if set(self.lengths) != {one.name for one in lengths}:
            self.length_box.clear()
            self.lengths = {}
            with self.length_box:
                for one in lengths:
                    words, move = one.name.replace("_", " ").capitalize(), partial(self.length_moved, one.name)
                    self.lengths[one.name] = Slider(words, one.unit, one.low, one.high, one.step, one.low, move)
        for one in lengths:
            value, slider = values[one.name], self.lengths[one.name]
            slider.value = value
            # a length of the address may lie outside what the search tries: the ends make room for it
            slider.limit(min(one.low, value), max(one.high, value), one.step, one.unit)
        self.kind_of_lengths = (kind, state.thickness_mm)

    # What is drawn.

    def evaluate(self) -> None:
        """Something changed: press the pad anew, once for all moves that came in the meantime."""
        self.wanted += 1
        self.stamp = self.files()
        if not self.busy:
            ui.timer(0.0, self.follow, once=True)

    def files(self) -> object:
        """Times of the files behind what is chosen."""
        return bench.stamp_of(self.root, bench.Asked.of(self.state))

    def watch(self) -> None:
        """A file was changed on the disk: the verdict is made anew."""
        if self.files() != self.stamp:
            self.evaluate()

    async def follow(self) -> None:
        """Show the newest state until there is no newer one, then settle the verdict."""
        if self.busy or self.shown == self.wanted:
            return
        self.busy, view = True, None
        try:
            while self.shown != self.wanted:
                self.shown = self.wanted
                view = await run.io_bound(self.view_of, self.state)
                if view is not None:
                    self.draw(view)
        finally:
            self.busy = False
        number = self.wanted
        await asyncio.sleep(SETTLE_S)
        if number == self.wanted and view is not None:
            await self.settle(view, number)

    def view_of(self, state: State) -> View:
        """Press the pad of a state and draw it, apart from the page."""
        asked = bench.Asked.of(state)
        try:
            inputs = bench.inputs_of(self.root, asked, bench.stamp_of(self.root, asked))
            shape = bench.shape_of(state.shape)
            pad = bench.evaluate_pad(inputs, shape, state.thickness_mm, state.ratio)
        except bench.NotTabulated as problem:
            return View(state, problem=str(problem), solvable=not state.calibration)
        except InputError as problem:
            return View(state, problem=str(problem))
        except Exception as problem:
            return View(state, problem=f"this pad cannot be evaluated ({type(problem).__name__}: {problem})")
        from dummydesign.design.suggestion import condition_rows

        targets = inputs.space.targets
        large = figures.plots_html([figures.steady(inputs.tissue, targets, pad),
                                    figures.section(shape, state.thickness_mm, inputs.punch)])  # fmt: skip
        small = figures.plots_html(figures.presses(targets, pad), small=True)
        rows = search.press_rows(condition_rows(pad.candidate, targets, shape))
        return View(state, inputs, shape, pad, large + small, rows)

    def draw(self, view: View) -> None:
        """Draw a pad, or why there is none: what belongs to another pad goes."""
        self.numbers.clear()
        self.solid.clear()
        self.same.clear()
        self.solved.hide()
        if view.problem:
            self.plots.set_content("")
            self._say(view.state, "amber" if view.solvable else "red", view.problem, "refused")
            return
        self.plots.set_content(view.plots)
        self._say(view.state, view.pad.verdict.light, view.pad.verdict.text, "")
        resin = view.inputs.space.resin
        young = 1e3 * float(resin.young_MPa(view.state.ratio))
        with self.numbers:
            facts([(f"{young:.3g} kPa", "modulus"), (f"{view.state.thickness_mm:g} mm", "thickness"),
                   (f"{view.state.ratio:g}", resin.ratio_meaning)])  # fmt: skip
            table(search.PRESS_HEAD, view.presses)

    async def settle(self, view: View, number: int) -> None:
        """After the last move: castings in the verdict, solid, command line, address, ends of the lengths."""
        keep_state(view.state)
        if (view.state.shape.partition(":")[0].lower(), view.state.thickness_mm) != self.kind_of_lengths:
            self._set_lengths()
        with self.same:
            try:
                command_line(self.pad_words())
            except InputError as problem:
                html(f'<p class="note">{escape(str(problem))}</p>')
        if view.problem:
            self._offer(view)
            return
        verdict = await run.io_bound(bench.verdict_with_castings, view.inputs, view.shape, view.pad)
        if number != self.wanted or verdict is None:
            return
        self._say(view.state, verdict.light, verdict.text, "settled")
        with self.solid:
            asked = {"shape": view.state.shape, "thickness": f"{view.state.thickness_mm:g}"}
            shown_file("/solid/pad", f"solid of {asked['shape']}, {asked['thickness']} mm", "shown solid", **asked)

    def _offer(self, view: View) -> None:
        """What can be done about a pad that is refused."""
        kind = view.state.shape.partition(":")[0].lower()
        with self.numbers:
            if kind != "slab":
                ui.button("Use lengths that fit", on_click=lambda: self.choose(shape=self.first_shape(kind)),
                          color=None).props('outline data-test="fit-lengths"')  # fmt: skip
        if view.solvable:
            self.solved.offer()

    def say_solved(self, verdict: Mapping[str, Any]) -> None:
        """The verdict of the pad that was solved."""
        self._say(self.state, verdict["light"], verdict["text"], "solved")

    def _say(self, state: State, light: str, text: str, stage: str) -> None:
        note = "" if stage else "(castings are being counted …)"
        self.verdict.clear()
        with self.verdict:
            tell_verdict(light, text, stage, note, state.label)

    def pad_words(self) -> list[str]:
        """The pad under the sliders as a command: a search whose limits are this pad."""
        state, t, r = self.state, f"{self.state.thickness_mm:g}", f"{self.state.ratio:g}"
        pad = {**search.question_options(state), "shape": state.shape}
        if abs(2.0 * state.thickness_mm - round(2.0 * state.thickness_mm)) > 1e-9:
            if state.calibration:
                raise InputError("with a calibration the command line takes steps of 0.5 mm: choose such a thickness")
            return ["predict", *commands.options({**pad, "thickness": t, "ratio": r})]
        given = {**pad, "thickness": f"{t}:{t}", "ratio": f"{r}:{r}"}
        return commands.suggest(given, f"pad-{t}mm-{r}")
