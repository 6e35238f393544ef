"""Check a cast pad: its presses against the tissue, by the calibration, and what was really poured."""

from __future__ import annotations

import json
from collections.abc import Mapping
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.project.status import things_in
from dummydesign.studio import choices, made
from dummydesign.studio.frame import (
    Studio,
    Work,
    facts,
    file_links,
    html,
    keep_state,
    lay_out,
    page_link,
    shown_file,
    table,
    tell_problem,
    tell_verdict,
    warnings,
    zip_link,
)  # fmt: skip
from dummydesign.studio.pages.dropping import drop_place
from dummydesign.studio.presses import pads as pressed_pads
from dummydesign.studio.presses.pads import PressedPad
from dummydesign.studio.state import State
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.inputs import changed_inputs, changed_since
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/cast", "Check a cast pad", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    html("<p>Is the cast pad right? First its thickness and mass, then its presses against the tissue.</p>")
    html("<h2>What was cast</h2>")
    comparison: list[Comparison] = []
    record_form(studio, state, lambda: [one.find_pads() for one in comparison])
    html("<h2>Its presses against the tissue</h2>")
    comparison.append(Comparison(studio, project, state))


class Comparison:
    """Presses of one pad, the tissue, the calibration, and what the comparison says."""

    def __init__(self, studio: Studio, project: Project, state: State) -> None:
        self.studio, self.root, self.project, self.state = studio, studio.root, project, state
        self.pads: list[PressedPad] = []
        words = ("Drop presses of the pad: CSV with time_s, displacement_mm, force_N. Bring files in another "
                 "form in under Measured first.")  # fmt: skip
        drop_place(self.take, lambda: self.find_pads(dropped=True), words, "cast")
        tissues = choices.tissues(self.root)
        tissues = tissues if state.tissue in tissues else {state.tissue: state.tissue, **tissues}
        self.pad = ui.select({}, label="Pad").props('data-test="pad"').style("width:100%")
        self.files = ui.select([], multiple=True, label="Its presses").props('use-chips data-test="presses"')
        self.files.style("width:100%")
        with ui.element("div").classes("fields"):
            self.tissue = ui.select(tissues, value=state.tissue, label="Tissue").props('data-test="tissue"')
            self.record = ui.select({"": "none"}, value="", label="Record of the cast pad").props('data-test="record"')
        self.work = Work(studio, "compare", "Compare with the tissue", self.words, self.show, self.belongs)
        self.model = ui.element("div").style("width:100%")
        with self.model:
            html("<h2>By the calibration</h2>")
            found = {"": "none"} | {f"{one}/calibration.json": one for one in
                                    choices.folders(self.root, "calibrations", "calibration.json")}  # fmt: skip
            found = found if state.calibration in found else {state.calibration: state.calibration, **found}
            self.calibration = ui.select(found, value=state.calibration, label="Calibration")
            self.calibration.props('data-test="calibration"')
            self.replay = Work(studio, "replay", "Predict its presses and compare", self.replay_words, self.show_replay,
                               self.replay_belongs)  # fmt: skip
        self.earlier = ui.element("div").style("width:100%")
        self.find_pads()
        self.pad.on_value_change(self.new_pad)
        for field in (self.files, self.record):
            field.on_value_change(self.work.renew_line)
        for field in (self.tissue, self.calibration):
            field.on_value_change(self.renew)
        self._list_earlier()

    def take(self, name: str, content: bytes) -> str:
        """Keep a press that was dropped."""
        return f"{pressed_pads.keep_press(self.root, name, content)} was added."

    def find_pads(self, dropped: bool = False) -> None:
        """Read which pads were pressed; the one that is chosen stays, unless presses were dropped."""
        before = self.pad.value
        self.pads = pressed_pads.pads(self.root, self.state)
        named = {one.label: one.label for one in self.pads}
        first = pressed_pads.nearest(self.pads, self.state)
        if dropped:
            first, before = next(one for one in self.pads if one.files[0].startswith(pressed_pads.DROPPED)), None
        kept = before if before in named else first.label if first else None
        self.pad.set_options(named, value=kept)
        self.pad.set_enabled(bool(named))
        self.new_pad()

    def chosen(self) -> PressedPad | None:
        """The pad that is chosen."""
        return next((one for one in self.pads if one.label == self.pad.value), None)

    def new_pad(self) -> None:
        """Offer the presses and the records of the pad."""
        pad = self.chosen()
        names = {path: path.rpartition("/")[2] for path in pad.files} if pad else {}
        self.files.set_options(names, value=list(names))
        self.files.set_enabled(bool(names))
        records = pressed_pads.records(self.root, pad) if pad else []
        kept = self.record.value if self.record.value in records else ""
        self.record.set_options({"": "none"} | {one: one for one in records}, value=kept)
        self.model.set_visibility(bool(pad and pad.campaign))
        self.renew_lines()

    def renew(self) -> None:
        """Tissue or calibration was chosen."""
        keep_state(self.state.changed(tissue=self.tissue.value, calibration=self.calibration.value))
        self.renew_lines()

    def renew_lines(self) -> None:
        """Write both commands anew."""
        self.work.renew_line()
        self.replay.renew_line()

    def words(self) -> list[str]:
        """The comparison as a command."""
        pad = self.chosen()
        if pad is None or not self.files.value:
            raise InputError("choose the presses of a pad, or drop them above")
        stem = self.tissue.value.rpartition("/")[2].removesuffix(".toml")
        given = {"tissue": self.tissue.value, "lowpass": pad.lowpass, "record": self.record.value,
                 "punch": pad.punch, "out": f"designs/compare-{stem}"}  # fmt: skip
        return ["compare", *self.files.value, *options(given)]

    def belongs(self, job: Job) -> bool:
        """Whether a job compared these presses with this tissue."""
        try:
            return list(job.words) == self.words()
        except InputError:
            return False

    def show(self, job: Job) -> None:
        """What the comparison says."""
        show_comparison(self.root, job.answer)

    def replay_words(self) -> list[str]:
        """The prediction as a command."""
        pad = self.chosen()
        if pad is None or not pad.campaign:
            raise InputError("choose a pad of a campaign")
        if not self.calibration.value:
            raise InputError("choose a calibration: the model is then compared with the presses too")
        return ["replay", pad.campaign, *options({"calibration": self.calibration.value, "tissue": self.tissue.value})]

    def replay_belongs(self, job: Job) -> bool:
        """Whether a job predicted this campaign with this calibration."""
        try:
            same = list(job.words) == self.replay_words()
        except InputError:
            return False
        return same and not changed_since([self.root / self.calibration.value], job.started)

    def show_replay(self, job: Job) -> None:
        """What the calibration predicts, and each pad against the tissue."""
        answer, pad = job.answer, self.chosen()
        if "trials" not in answer or pad is None:
            return
        facts([(f"{answer['rmse_N']:.3g} N", "error of the calibrated model (rms)"),
               (f"{answer['base_rmse_N']:.3g} N", "error of the plain model (rms)")])  # fmt: skip
        for one in answer.get("pads") or []:
            if pad.thickness_mm is None or abs(one["thickness_mm"] - pad.thickness_mm) > 1e-6:
                continue
            if one.get("verdict"):
                show_verdict(one["verdict"])
            else:
                html(f"<p>{escape(str(one.get('reason') or 'no verdict'))}</p>")
        names = {path.rpartition("/")[2] for path in pad.files}
        rows = [[one["file"], one["rmse_N"], one["base_rmse_N"], one["peak_error_N"]]
                for one in answer["trials"] if one["file"] in names]  # fmt: skip
        table(["press", "calibrated, rms N", "plain model, rms N", "peak off by N"], rows)
        warnings(answer)

    def _list_earlier(self) -> None:
        """Comparisons in the folder, also those made on the terminal."""
        found = [one for one in things_in(self.root, "designs") if one.command == "compare"]
        if not found:
            return
        with self.earlier:
            html("<h2>Comparisons in this project</h2>")
            for one in reversed(found):
                html(f"<p>{escape(choices.told(one))}</p>")
                if (self.root / one.folder / "report.html").is_file():
                    file_links([(f"report of {one.folder}", f"{one.folder}/report.html")])


def show_verdict(found: Mapping[str, Any]) -> None:
    """The verdict of an answer."""
    tell_verdict(str(found["light"]), str(found["text"]), test="verdict")


def correction(found: Mapping[str, Any]) -> str:
    """What to multiply readings by, in a sentence."""
    given = found.get("correction") or {}
    central, sure = given.get("factor_central"), given.get("factor")
    if found["light"] == "red" or central is None:
        return "No correction: this pad is not usable."
    if sure is None or sure < 1.005:
        return "Correction: none needed."
    best = "none" if central < 1.005 else f"multiply readings by {central:.2f}"
    return f"Correction: {best} at central estimates. Multiply by {sure:.2f} to be safe in 95 % of cases."


def show_comparison(root: Path, answer: Mapping[str, Any]) -> None:
    """Verdict, correction, each press, and the report of a comparison."""
    if "verdict" not in answer or "force_variation_range" not in answer:
        return
    files = answer.get("files") or {}
    for name in changed_inputs(root, root / str(files.get("manifest") or "")):
        tell_problem(f"{name} has changed since this comparison. Compare again.")
    show_verdict(answer["verdict"])
    html(f'<p data-test="correction">{escape(correction(answer["verdict"]))}</p>')
    if pad := answer.get("pad"):
        state = "accepted" if pad["accepted"] else "not accepted"
        html(f"<p>Cast: {pad['thickness_mm']:.2f} mm (standard error {pad['thickness_sd_mm']:.2f} mm), {state}.</p>")
    head = ["press", "mm/s", "steady N", "depth mm", "peak N", "people from N", "people to N", "fraction in range"]
    keys = ("velocity_mm_s", "steady_force_N", "depth_mm", "peak_force_N", "range_peak_low_N", "range_peak_high_N",
            "inside_fraction")  # fmt: skip
    table(head, [[Path(one["file"]).name, *(one[key] for key in keys)] for one in answer.get("by_trace", [])])
    warnings(answer)
    if files.get("report") and (root / files["report"]).is_file():
        zip_link(Path(files["report"]).parent.as_posix())
        shown_file(f"/files/{files['report']}", "report of the comparison")


def record_form(studio: Studio, state: State, then: Any) -> None:
    """Fields for what was really cast, and the verdict of the record.

    Parameters
    ----------
    studio : Studio
    state : State
        What is chosen: the mould of its pad comes first.
    then : callable
        Called when a record is shown.
    """
    root = studio.root
    moulds = {one.folder: f"{one.folder}: {one.label}" for one in reversed(made.moulds(root))
              if pressed_pads.gauge_points(root / one.folder)}  # fmt: skip
    if not moulds:
        html(f'<p class="note">No mould in this project yet: {page_link("/mould", "make one")}.</p>')
        return
    mine = [one.folder for one in made.moulds(root) if one.is_of(state) and one.folder in moulds]
    chosen = ui.select(moulds, value=mine[-1] if mine else next(iter(moulds)), label="Mould it was cast in")
    chosen.props('data-test="record-mould"').style("width:100%")
    gauged: dict[str, ui.number] = {}
    points = ui.element("div").classes("fields")
    with ui.element("div").classes("fields"):
        mass = ui.number("Mass, trimmed [g]", min=0, step=0.1).props('data-test="record-mass" hint="of the pad"')
        modulus = ui.number("Witness modulus [kPa]", min=0).props('hint="of the puck; optional"')
        level = ui.number("Level [deg]", min=0, step=0.01).props('hint="when filled; optional"')
        bubbles = ui.number("Bubbles", min=0, step=1).props('hint="over 1 mm; optional"')
        note = ui.input("Note").props('hint="optional"')

    def words() -> list[str]:
        empty = [name for name, field in gauged.items() if field.value is None]
        if empty:
            raise InputError(f"thickness at {', '.join(empty)} is empty")
        if mass.value is None:
            raise InputError("the mass of the trimmed pad is empty")
        readings = ",".join(f"{name}={field.value:g}" for name, field in gauged.items())
        given = {"thickness": readings, "mass": float(mass.value), "modulus": _float(modulus.value),
                 "level": _float(level.value), "bubbles": None if bubbles.value is None else int(bubbles.value),
                 "note": note.value}  # fmt: skip
        return ["mold", "record", chosen.value, *options(given)]

    def show(job: Job) -> None:
        show_record(job.answer)
        then()

    def list_records() -> None:
        kept.clear()
        with kept:
            _records(root, chosen.value)

    work = Work(studio, "record", "Keep this record", words, show, lambda job: job.words[2:3] == (chosen.value,),
                lambda job: list_records())  # fmt: skip
    kept = ui.element("div").style("width:100%")

    def new_mould() -> None:
        points.clear()
        gauged.clear()
        with points:
            for one in pressed_pads.gauge_points(root / chosen.value):
                field = ui.number(f"Thickness, {one.name} [mm]", min=0, step=0.01)
                field.props(f'data-test="gauge-{one.name}" hint="{one.low_mm:.2f} to {one.high_mm:.2f} mm"')
                field.on_value_change(work.renew_line)
                gauged[one.name] = field
        list_records()
        work.renew_line()

    new_mould()
    chosen.on_value_change(new_mould)
    for field in (mass, modulus, level, bubbles, note):
        field.on_value_change(work.renew_line)


def _float(value: float | None) -> float | None:
    return None if value is None else float(value)


def _records(root: Path, folder: str) -> None:
    """Records that lie in the folder of a mould, each in a line."""
    rows = []
    for path in sorted((root / folder).glob("record*.json")):
        try:
            one = json.loads(path.read_text(encoding="utf-8"))
            verdict = "accepted" if one["accepted"] else f"not accepted: {', '.join(one['missed'])}"
            rows.append([path.name, f"{one['thickness_mm']:.2f}", f"{one['mass_g']:g}", verdict])
        except (OSError, ValueError, KeyError, TypeError):
            continue
    if rows:
        table(["record", "thickness mm", "mass g", ""], rows, words=True)


def show_record(answer: Mapping[str, Any]) -> None:
    """The verdict of a record: each limit, and what it does to the force."""
    result = answer if "limits" in answer else (answer.get("result") or {})
    if "limits" not in result:
        return
    light = "green" if result["accepted"] else "red"
    missed = ", ".join(result["missed"])
    text = "Accepted: the pad keeps all limits." if result["accepted"] else f"Not accepted. It misses {missed}."
    force = result.get("force_percent")
    more = "" if force is None else f" Its force at a given depth is {force:+.1f} % off the designed pad's."
    show_verdict({"light": light, "text": text + more})
    rows = [
        [one["what"], one["value"], one["unit"],
         f"at most {one['high']:.4g}" if one["low"] is None else f"{one['low']:.4g} to {one['high']:.4g}",
         "missed" if one["missed"] else "kept", one["advice"] if one["missed"] else ""]
        for one in result["limits"]
    ]  # fmt: skip
    table(["what", "value", "", "allowed", "", "what to do"], rows, words=True)
