"""Design a pad: sliders that answer at once with the verdict in sight, and the search for the best one."""

from __future__ import annotations

import asyncio
import json
import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from nicegui import background_tasks, run, ui

from dummydesign.core.errors import DummydesignError, InputError
from dummydesign.design.pad_evaluator import EvaluatedPad, NotTabulated, PadEvaluator
from dummydesign.design.suggestion import condition_rows
from dummydesign.geometry.dimensions import PUNCH
from dummydesign.geometry.pad_shape import PadShape
from dummydesign.geometry.shape_registry import read_shape
from dummydesign.project.folder import Project
from dummydesign.report.plot import Plot
from dummydesign.resin import load_resin
from dummydesign.studio import figures, project_index, select_options, slider_model, widgets
from dummydesign.studio.markup import in_page_words
from dummydesign.studio.pages import search
from dummydesign.studio.state import PAD_FIELDS, State, absolute, of_project, page_link, punch_of
from dummydesign.studio.widgets import having, html, keep_state, open_page

SETTLE_S = 0.35
"""After this time without a move the verdict counts what castings may turn out as. [s]"""
WATCH_S = 2.0
"""How often the files behind the verdict are looked at. [s]"""
ESTIMATE = "Estimate by interpolation; to be sure, solve this pad."
NO_LIGHT = "grey"


LONG_UNIT = 8
NUMBER = """(value) => {
  const field = document.querySelector('input[data-test="number-NAME"]');
  if (field) field.value = Number(value.toPrecision(6));
}"""


class Bar(ui.slider):
    """A slider to which nothing is sent back: an answer to the first of several keys would take the later ones back."""

    LOOPBACK = False


class Slider:
    """A slider and a number field that follow each other."""

    def __init__(
        self, name: str, unit: str, low: float, high: float, step: float, value: float, moved: Callable[[], None]
    ) -> None:
        self.value, self._name, self._moved = value, name, moved
        with ui.element("div").classes("slider"):
            with ui.element("div").classes("line"):
                ui.label(name)
                self.beside = ui.label("").classes("beside")
                self._field = ui.input().props("dense outlined inputmode=decimal")
            self._bar = Bar(min=low, max=high, step=step, value=value)
            self._unit, self._note = ui.label("").classes("source"), ui.label("").props("role=status")
        having(self._bar, aria_label=f"{name}, slider", data_test=f"slide-{name.lower()}")
        having(self._field, data_test=f"number-{name.lower()}")
        self._bar.on_value_change(lambda: self._take(float(self._bar.value)))
        # past the framework, which would lay out the whole page anew; :meth:`set` follows once the sliders rest
        self._bar.on("update:model-value", js_handler=NUMBER.replace("NAME", name.lower()))
        self._field.on("change", self._typed)
        self.limit(low, high, step, unit)

    def limit(self, low: float, high: float, step: float, unit: str) -> None:
        """Set the ends and the step; the value is moved inside, and the note names one that lay outside."""
        self._field.props["suffix" if len(unit) <= LONG_UNIT else "title"] = unit
        self._field.props["aria-label"] = f"{self._name} {unit}".strip()
        self._unit.set_text(f"{low:g} to {high:g}" + (f", {unit}" if len(unit) > LONG_UNIT else ""))
        self._low, self._high = low, high
        self._bar.props.update({"min": low, "max": high, "step": step})
        before = self.value
        self.set(min(max(before, low), high))
        if self.value != before:
            self._refuse(f"{before:g}")

    def set(self, value: float) -> None:
        """Move it from here, without a call."""
        self.value = self._written = float(value)
        self._field.set_value(f"{self.value:.6g}")
        self._note.set_text("")
        self._bar.set_value(self.value)

    def _refuse(self, typed: str) -> None:
        self._note.set_text(f"{typed} is not allowed: {self._low:g} to {self._high:g}." if typed else "")

    def rest(self) -> None:
        """Write down where the bar was moved to; a number that is being typed is left alone."""
        if self.value != self._written:
            self.set(self.value)

    def _take(self, value: float) -> None:
        if value != self.value:
            self.value = value
            self._moved()

    def _typed(self) -> None:
        """Take a number once it is typed to its end; one that is not allowed gives way to the one in use."""
        typed, before, value = (self._field.value or "").strip(), self.value, None
        with suppress(InputError):
            value = widgets.number_of(typed, self._name)
        if value is not None and self._low <= value <= self._high:
            self.set(value)
        else:
            self.set(before)
            self._refuse(typed)
        if self.value != before:
            self._moved()


@dataclass(frozen=True)
class PadView:
    """Everything that is drawn of a pad that can be pressed."""

    evaluator: PadEvaluator
    shape: PadShape
    pad: EvaluatedPad
    plots: Sequence[Plot]
    figures: Sequence[Mapping[str, Any]]
    modulus: str


class DesignPage:
    """The page: one state, from which every control and every panel is drawn."""

    def __init__(self, project: Project, state: State, query: Mapping[str, str]) -> None:
        self.root, self.state = project.root, state
        usual = State(**of_project(project)).question
        self.usual = {name: value for name, value in usual.items() if value or name != "tissue"}
        self.wanted = self.written = 0
        self.busy = False
        self.unchosen = all(getattr(state, name) == getattr(State, name) for name in (*PAD_FIELDS, "design"))
        self.drawn: Sequence[Mapping[str, Any]] = ()
        self.lengths: dict[str, Slider] = {}
        self.kind_of_lengths: tuple[str, float] = ("", 0.0)
        with ui.element("div").classes("two instrument"):
            choices = ui.element("div").classes("choices")
            with ui.element("div"):
                with widgets.area("verdict", live=True).classes("sticky"):
                    self.verdict = html("")
                found = widgets.area()
                with widgets.area("next-of-pad").classes("actions"):
                    self.made = widgets.area()
                    self.solved = search.SolvedPad(self.root, lambda: self.state, self.evaluate)
                self.plots = html("").props('data-test="plots"').style("width:100%")
                self.numbers = widgets.area("numbers")
                with widgets.fold("The pad as a solid, to turn"):
                    self.solid = widgets.area("solid")
                with widgets.fold("Designs of this project", "earlier"):
                    search.DesignList(self.root, lambda: self.state)
            with choices:
                self.search = search.Search(project, lambda: self.state, self.take, found)
                self._controls()
        self.take(state)
        ui.timer(WATCH_S, self.watch)

    def _controls(self) -> None:
        """Build the controls, empty of what the state says."""
        html("<h2>The pad that is shown</h2>")
        kinds = {name: words for name, words in select_options.shapes().items() if name != "auto"}
        self.kind = widgets.select("Shape", kinds, self.state.kind, "kind")
        self.thickness = Slider("Thickness", "mm", 3.0, 30.0, 0.1, self.state.thickness_mm, self.moved)
        self.ratio = Slider("Ratio", "", self.state.ratio, self.state.ratio, 0.05, self.state.ratio, self.moved)
        self.length_box = ui.element("div").style("width:100%")
        self.question = widgets.fold("", "question", opened=bool(self.state.missing))
        with self.question:
            self.fields = {
                name: widgets.select(name.capitalize(), {}, "", name)
                for name in ("tissue", "aim", "resin", "calibration")
            }
            self.punch = ui.input("Punch").props('data-test="punch"')
            self.shape = ui.input("Shape with its lengths").props('data-test="shape"')
        for name, field in self.fields.items():
            field.on_value_change(lambda event, name=name: self.choose(**{name: event.value}))
        for name, usual in self.usual.items():
            widgets.way_back(self.fields.get(name, self.punch), usual, partial(self.choose, **{name: usual}))
        self.punch.on("change", lambda: self.choose(punch=self.punch.value.strip() or PUNCH))
        self.shape.on("change", lambda: self.choose(shape=self.shape.value.strip() or "slab"))
        # by the user alone: a state that is taken brings its own lengths
        self.kind.on("update:model-value", lambda: self.choose_kind(self.kind.value))

    # The state and its controls.

    def choose(self, **new: Any) -> None:
        """Take what was chosen in a control; all others follow, whose values are those of the state already."""
        after = self.state.changed(**new)
        if after == self.state:
            return
        self.unchosen = False
        if after.tissue != self.state.tissue:
            after = after.changed(aim=after.aim if after.aim in self._aims(after.tissue) else "average")
        if after.missing:
            # what the page says at its top may be no longer true
            open_page("/design", after)
        else:
            self.take(after)

    def moved(self) -> None:
        """Take what a slider says; the sliders themselves are left alone while they move."""
        self.unchosen = False
        self.state = self.state.changed(thickness_mm=self.thickness.value, ratio=self.ratio.value)
        self.evaluate()

    def length_moved(self, name: str) -> None:
        """Take a length; those that its table ties to it follow."""
        with suppress(InputError):
            shape = read_shape(self.state.shape).with_length(name, self.lengths[name].value)
            self.state = self.state.changed(shape=str(shape))
            self.shape.set_value(self.state.shape)
            self.evaluate()

    def choose_kind(self, kind: str) -> None:
        """Choose a shape of a kind, with lengths that can be pressed at this thickness."""
        try:
            shape = str(slider_model.first_pad(self.root, self.state, kind))
        except InputError as problem:
            ui.notify(in_page_words(str(problem)), type="warning", multi_line=True)
        else:
            self.choose(shape=shape)

    def take(self, state: State) -> None:
        """Show a state: every control and every panel."""
        self.state, self.stamp = state, slider_model.stamp_of(self.root, state)
        self.unchosen = self.unchosen and not state.design
        self._set_choices(state)
        self._set_sliders(state)
        self.search.work.renew()
        self.evaluate()

    def _aims(self, tissue: str) -> dict[str, str]:
        with suppress(InputError):
            return select_options.aims(absolute(self.root, tissue))
        return {}

    def _set_choices(self, state: State) -> None:
        """Offer what there is, and show what is chosen."""
        resins = select_options.resins()
        known = {
            "tissue": select_options.tissues(self.root),
            "aim": self._aims(state.tissue),
            "resin": select_options.offered(resins, state.resin) if (self.root / state.resin).is_file() else resins,
            "calibration": select_options.calibrations(self.root),
        }
        for name, offered in known.items():
            widgets.offer(self.fields[name], offered, getattr(state, name))
        asked = (state.tissue, state.aim, state.resin, Path(state.calibration).parent.name, state.punch)
        changed = [name for name, usual in self.usual.items() if getattr(state, name) != usual]
        marks = f" (changed: {', '.join(changed)})" if changed else ""
        self.question.set_text(f"Judged against {', '.join(filter(None, asked))}{marks}")
        self.kind.set_value(state.kind)
        self.punch.set_value(state.punch)
        self.shape.set_value(state.shape)

    def _set_sliders(self, state: State) -> None:
        self.thickness.set(state.thickness_mm)
        self.ratio.set(state.ratio)
        with suppress(InputError):
            resin = load_resin(absolute(self.root, state.resin))
            self.ratio.limit(resin.ratio_min, resin.ratio_max, resin.ratio_step / 2, resin.ratio_meaning)
        self.state = state.changed(ratio=self.ratio.value)
        self._set_lengths()

    def _set_lengths(self) -> None:
        """Sliders of the shape's lengths, with the ends that they have at this thickness."""
        state = self.state
        try:
            radius_mm = punch_of(self.root, state.punch).radius_mm
            values = dict(read_shape(state.shape).parameters)
            lengths = slider_model.lengths_of(state.kind, state.thickness_mm, radius_mm)
        except (InputError, AttributeError):
            values, lengths = {}, ()
        if set(self.lengths) != {one.name for one in lengths}:
            self.lengths = {}
            with widgets.fresh(self.length_box):
                for one in lengths:
                    words, move = one.name.replace("_", " ").capitalize(), partial(self.length_moved, one.name)
                    self.lengths[one.name] = Slider(words, one.unit, one.low, one.high, one.step, one.low, move)
        for one in lengths:
            value, slider = values[one.name], self.lengths[one.name]
            slider.value = value
            # a length of the address may lie outside what the search tries: the ends make room for it
            slider.limit(min(one.low, value), max(one.high, value), one.step, one.unit)
        self.kind_of_lengths = (state.kind, state.thickness_mm)

    # What is drawn.

    def evaluate(self) -> None:
        """Something changed: press the pad anew, once for all moves that came in the meantime."""
        self.wanted += 1
        if not self.busy:
            self.busy = True
            background_tasks.create_or_defer(self.follow(), context=self.verdict)

    def watch(self) -> None:
        """A file was changed on the disk: the verdict is made anew."""
        before, self.stamp = self.stamp, slider_model.stamp_of(self.root, self.state)
        if before != self.stamp:
            self.evaluate()

    async def follow(self) -> None:
        """Show the newest state until there is no newer one, then settle the verdict."""
        number = 0
        try:
            while number != self.wanted:
                number, state = self.wanted, self.state
                view = await run.io_bound(self.view_of, state)
                if view is not None and not self.verdict.is_deleted:
                    self.draw(state, view)
        finally:
            self.busy = False
        await asyncio.sleep(SETTLE_S)
        if number == self.wanted and view is not None and not self.verdict.is_deleted:
            await self.settle(state, view, number)

    def view_of(self, state: State) -> PadView | InputError:
        """Press the pad of a state and draw it, apart from the page."""
        try:
            evaluator, shape = slider_model.evaluator_of(self.root, state), read_shape(state.shape)
            pad = evaluator.evaluate(shape, state.thickness_mm, state.ratio)
        except InputError as problem:
            return problem
        except Exception as problem:
            message = f"this pad cannot be evaluated ({type(problem).__name__}: {problem})"
            return InputError(message, "unsupported", "pad", state.shape)
        plots = figures.pad_plots(evaluator.problem, shape, pad)
        modulus = f"modulus {1e3 * float(evaluator.problem.resin.young_MPa(state.ratio)):.3g} kPa"
        return PadView(evaluator, shape, pad, plots, [one.figure() for one in plots], modulus)

    def solvable(self, view: PadView | InputError) -> bool:
        """Whether finite elements can solve a pad."""
        return isinstance(view, PadView) or (isinstance(view, NotTabulated) and not self.state.calibration)

    def draw(self, state: State, view: PadView | InputError) -> None:
        """Draw a pad, or why there is none.

        Where the same plots are drawn already the page is sent what changed of them, past its framework, which would
        lay out the whole page anew. What belongs to another pad is dimmed until the sliders rest. A light takes all
        castings: until they are counted there is none.
        """
        before, self.drawn = self.drawn, () if isinstance(view, InputError) else view.figures
        if isinstance(view, InputError):
            self._clear()
            self.plots.set_content("")
            text = str(view).replace(f"{self.root}{os.sep}", "")
            self._say(state, "amber" if self.solvable(view) else "red", text, "refused")
            return
        one = view.pad.verdict
        inside = one.peaks - one.peaks_below - one.peaks_above
        text = f"{inside} of {one.peaks + one.not_reached} peaks are inside the subjects' range at central estimates."
        verdict = NO_LIGHT, text, "", "Castings are being counted …"
        if [len(one["data"]) for one in before] == [len(one["data"]) for one in self.drawn]:
            new = {
                self.verdict.html_id: widgets.verdict_html(*verdict, state.label),
                self.ratio.beside.html_id: view.modulus,
            }
            changes = [plot.change(*pair) for plot, *pair in zip(view.plots, before, self.drawn)]
            ui.run_javascript(f"follow({json.dumps([new, changes], separators=(',', ':'))})")
        else:
            self._clear()
            self.plots.set_content(figures.pad_html(view.plots))
            self._say(state, *verdict)

    def _clear(self) -> None:
        """Take away what belongs to another pad."""
        for area in (self.numbers, self.solid, self.made):
            area.clear()

    async def settle(self, state: State, view: PadView | InputError, number: int) -> None:
        """After the last move: castings in the verdict, what comes next, solid, address, ends of the lengths."""
        keep_state(state)
        for slider in (self.thickness, self.ratio, *self.lengths.values()):
            slider.rest()
        self._clear()
        if (state.kind, state.thickness_mm) != self.kind_of_lengths:
            self._set_lengths()
        self.solved.renew(self.solvable(view), not self.unchosen, isinstance(view, InputError))
        if isinstance(view, InputError):
            with self.numbers:
                if (
                    state.kind != "slab"
                    and state.kind in self.kind.options
                    and not str(view.quantity).startswith("calibration")
                ):
                    widgets.button("Use lengths that fit", lambda: self.choose_kind(state.kind), "fit-lengths")
            if (solved := self.solved.verdict) is not None:
                self._say(state, *solved, "solved")
                self._next(state, solved[0], True)
            return
        self.ratio.beside.set_text(view.modulus)
        with self.numbers:
            if (calibrated := view.evaluator.problem.calibrated) is not None:
                widgets.warnings({"warnings": calibrated.warnings})
            presses = condition_rows(view.pad.candidate, view.evaluator.problem.targets, view.shape)
            search.show_presses(presses, f"the {len(presses)} presses in numbers")
        verdict = await run.io_bound(self._verdict, state, view)
        if number != self.wanted or verdict is None:
            return
        light, text, note = verdict
        self._say(state, light, text, "settled", note)
        self._next(state, light, not note)
        with self.solid:
            size = f"{state.thickness_mm:g}"
            widgets.shown_file(
                "/solid/pad", f"solid of {state.shape}, {size} mm", "shown solid", shape=state.shape, thickness=size
            )

    def _verdict(self, state: State, view: PadView) -> tuple[str, str, str]:
        """Light, sentence and source: the design of this pad where there is one, else an estimate by the table."""
        if solved := project_index.verdict_of_design(self.root, state) or self.solved.verdict:
            return *solved, ""
        try:
            verdict = view.evaluator.with_castings(view.shape, state.thickness_mm, state.ratio)
        except DummydesignError as refused:
            return "red", f"Do not use it: {refused}.", ESTIMATE
        return verdict.light, verdict.text, ESTIMATE

    def _next(self, state: State, light: str, solved: bool) -> None:
        """What comes next for the pad that is seen: solve it, measure its resin, make its mould."""
        puck = solved and light == "amber" and project_index.wants_puck(self.root, state)
        with self.made:
            main = solved and light != "red" and not self.unchosen
            if puck:
                widgets.go("/resin", "Measure one puck first", test="puck-first")
            if not self.unchosen:
                pad = f"{state.kind}, {state.thickness_mm:g} mm, ratio {state.ratio:g}"
                kind = "go" if main and not puck else "go more"
                html("{}", page_link("/mould", f"Make its mould: {pad}", test="mould", kind=kind))
        self.search.work.main = self.unchosen or (solved and light == "red")
        self.search.work.update()
        self.solved.work.main = not self.unchosen and not solved
        self.solved.work.update()

    def _say(self, state: State, light: str, text: str, shown: str, note: str = "") -> None:
        # numbered, so that a text written before still replaces what the browser has moved since
        self.written += 1
        if self.unchosen and shown != "refused":
            light, text = NO_LIGHT, f"No pad is chosen yet: find the best one. The sliders begin with a slab. {text}"
        said = widgets.verdict_html(light, text, shown, note, state.label)
        self.verdict.set_content(f"{said}<!--{self.written}-->")
