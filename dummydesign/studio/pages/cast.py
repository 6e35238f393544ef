"""Check a cast pad: what was poured, its presses against the tissue and by the calibration, the same on people."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.core.files import read_json
from dummydesign.core.parsing import QuantitySpec
from dummydesign.mold.pour.acceptance import GaugePoint
from dummydesign.mold.pour.record import allowed_words
from dummydesign.person.drives import DRIVES, read_drive
from dummydesign.person.limits import read_limits
from dummydesign.project.folder import Project
from dummydesign.report import on_person as people
from dummydesign.report.compare import next_steps, pad_text
from dummydesign.report.front_page import full_sentence
from dummydesign.report.plot import plots_html
from dummydesign.studio import figures, file_transfer, project_index, select_options, widgets
from dummydesign.studio.file_actions import DropList
from dummydesign.studio.job_panel import JobPanel
from dummydesign.studio.jobs import Job, command
from dummydesign.studio.markup import Markup, filled
from dummydesign.studio.state import State, page_link
from dummydesign.studio.trash import LIMITS, Taken, keep_file
from dummydesign.studio.widgets import NumberField, html, keep_state

TABS = {"record": "1 Record", "compare": "2 Compare", "people": "3 On people"}

ERRORS = {
    "press": "file",
    "calibrated, rms N": "rmse_N",
    "plain model, rms N": "base_rmse_N",
    "peak off by N": "peak_error_N",
}
COMPARED: dict[str, str | Callable[[Any], object]] = {
    "press": lambda row: Path(row["file"]).name,
    "mm/s": "velocity_mm_s",
    "steady N": "steady_force_N",
    "depth mm": "depth_mm",
    "peak N": "peak_force_N",
    "subjects N": lambda row: people.span_text([row.get(f"range_peak_{end}_N") for end in ("low", "high")]),
    "fraction in range": "inside_fraction",
}


def show_cast_pad(project: Project, state: State, query: Mapping[str, str]) -> None:
    """Build the page."""
    places = widgets.tabs(
        TABS,
        query.get(TAB, "record" if project_index.moulds(project.root) else "compare"),
        lambda name: keep_state(comparison.state, **{TAB: name}),
    )
    comparison = PressComparison(project.root, state, places["compare"], places["people"])
    with places["record"]:
        record_form(comparison, query)


class PressComparison:
    """Presses of one pad, the tissue, the calibration, and what the comparison says."""

    def __init__(self, root: Path, state: State, place: ui.element, people_place: ui.element) -> None:
        self.root, self.state = root, state
        self.pads: list[project_index.PadWithPresses] = []
        with place:
            with widgets.fields():
                self.pad = widgets.select("Pad", {}, "", "pad")
                self.tissue = widgets.select("Tissue", select_options.tissues(self.root), state.tissue, "tissue")
                self.record = widgets.select("Record of the cast pad", {"": "none"}, "", "record")
            self.files = widgets.select_several("Its presses", {}, [], "presses")
            self.work = JobPanel(root, "compare", "Compare with the tissue", self.words, self.show, needs="verdict")
            with widgets.fold("Presses from elsewhere", "more-presses", opened=not project_index.pads(root, state)):
                DropList(
                    root,
                    lambda name, content: project_index.keep_press(self.root, name, content),
                    lambda: self.find_pads(dropped=True),
                    "CSV with time_s, displacement_mm, force_N. Bring files in another form in under Measured first.",
                    "cast",
                )
            self.model = widgets.fold("Predict these presses with a calibration", "model")
            with self.model:
                self.calibration = widgets.select(
                    "Calibration", select_options.calibrations(root), state.calibration, "calibration"
                )
                self.replay = JobPanel(
                    root,
                    "replay",
                    "Predict its presses and compare",
                    self.replay_words,
                    self.show_replay,
                    stamp=lambda: self.pad.value,
                    reads=lambda: [self.root / self.calibration.value],
                    needs="trials",
                )
        with people_place:
            self.people = PeopleOfPad(self)
        self.find_pads()
        self.pad.on_value_change(self.new_pad)
        widgets.on_change(self.renew_lines, self.files, self.record)
        widgets.on_change(self.renew, self.tissue, self.calibration)

    def find_pads(self, dropped: bool = False) -> None:
        """Read which pads were pressed; the one that is chosen stays, unless presses were dropped."""
        before = self.pad.value
        self.pads = project_index.pads(self.root, self.state)
        named = [one.label for one in self.pads]
        first = project_index.nearest(self.pads, self.state)
        if dropped:
            first, before = next(one for one in self.pads if one.files[0].startswith(project_index.DROPPED)), None
        self.pad.set_options(named, value=before if before in named else first.label if first else None)
        self.pad.set_enabled(bool(named))
        self.new_pad()

    def chosen(self) -> project_index.PadWithPresses:
        """The pad that is chosen."""
        return next((one for one in self.pads if one.label == self.pad.value), project_index.PadWithPresses())

    def presses(self) -> tuple[project_index.PadWithPresses, list[str]]:
        """The pad and those of its presses that are chosen (InputError without any)."""
        pad = self.chosen()
        if not (pad.files and self.files.value):
            raise InputError("choose the presses of a pad, or drop them above", "missing", "trace")
        return pad, list(self.files.value)

    def new_pad(self) -> None:
        """Offer the presses and the records of the pad."""
        pad = self.chosen()
        names = {path: Path(path).name for path in pad.files}
        self.files.set_options(names, value=list(names))
        self.files.set_enabled(bool(names))
        records = {"": "none"} | {one: one for one in project_index.records(self.root, pad)}
        self.record.set_options(records, value=self.record.value if self.record.value in records else "")
        self.model.set_visibility(bool(pad.campaign))
        shown = f"Presses of {pad.label}, against {self.tissue.value}." if names else "No presses yet."
        self.people.pad.set_content(filled("<p>{} Choose others under Compare.</p>", shown))
        self.renew_lines()

    def renew(self) -> None:
        """Tissue or calibration was chosen."""
        self.state = self.state.changed(tissue=self.tissue.value, calibration=self.calibration.value)
        keep_state(self.state)
        self.renew_lines()

    def renew_lines(self) -> None:
        """Write the commands anew."""
        for work in (self.work, self.replay, self.people.work):
            work.renew()

    def words(self) -> list[str]:
        """The comparison as a command."""
        pad, presses = self.presses()
        stem = self.tissue.value.rpartition("/")[2].removesuffix(".toml")
        return command(
            "compare",
            *presses,
            tissue=self.tissue.value,
            lowpass=pad.lowpass,
            record=self.record.value,
            punch=pad.punch,
            out=f"designs/compare-{stem}",
        )

    def replay_words(self) -> list[str]:
        """The prediction as a command; offered for a pad of a campaign alone."""
        if not self.calibration.value:
            message = "choose a calibration: the model is then compared with the presses too"
            raise InputError(message, "missing", "calibration")
        return command("replay", self.chosen().campaign, calibration=self.calibration.value, tissue=self.tissue.value)

    def show_replay(self, job: Job) -> None:
        """What the calibration predicts, and each pad against the tissue."""
        answer, pad = job.answer, self.chosen()
        widgets.facts(
            [
                ("holds" if answer["holds"] else "does not hold", "the calibration, on these presses"),
                (f"{answer['rmse_N']:.3g} N", "error of the calibrated model (rms)"),
                (f"{answer['base_rmse_N']:.3g} N", "error of the plain model (rms)"),
            ]
        )
        for one in answer.get("pads") or []:
            mine = pad.thickness_mm is not None and abs(one["thickness_mm"] - pad.thickness_mm) < 1e-6
            if mine and one.get("verdict"):
                widgets.tell_verdict(one["verdict"]["light"], one["verdict"]["text"], test="verdict")
            elif mine:
                html("<p>{}</p>", one.get("reason") or "no verdict")
        names = {path.rpartition("/")[2] for path in pad.files}
        widgets.records(ERRORS, (one for one in answer["trials"] if one["file"] in names))

    def show(self, job: Job) -> None:
        """Verdict, what to do with the pad, each press, and the report of a comparison."""
        answer, files = job.answer, job.answer.get("files") or {}
        widgets.tell_changes(self.root, str(files.get("manifest") or ""), "Compare again.")
        if verdict := answer["verdict"]:
            widgets.tell_verdict(verdict["light"], verdict["text"], test="verdict")
            html('<p data-test="correction">{}</p>', full_sentence(next_steps(answer)[0]))
        if cast := pad_text(answer):
            html("<p>The pad: {}.</p>", cast)
        if path := files.get("report_values"):
            plots = figures.compared_plots(self.root / path)
            html('<div data-test="compared-plots">{}</div>', Markup(plots_html(plots)))
        widgets.records(COMPARED, answer.get("by_trace", []))
        widgets.show_report(self.root, files, "report of the comparison")


TYPED = "cast_"
"""Beginning of the names under which the address keeps what was typed of a cast pad."""
TAB, MOULD = f"{TYPED}tab", f"{TYPED}mould"
OTHERS = {
    "mass": ("Mass [g]", "of the trimmed pad"),
    "modulus": ("Modulus [kPa]", "of a puck; optional"),
    "level": ("Level [deg]", "when filled; optional"),
    "bubbles": ("Bubbles", "over 1 mm; optional"),
}


def record_form(comparison: PressComparison, query: Mapping[str, str]) -> None:
    """Fields for what was really cast, a map of where it is gauged, and the verdict of the record."""
    root = comparison.root
    every = project_index.moulds(root)[::-1]
    moulds = {one.folder: one for one in every if project_index.gauge_points(root / one.folder)}
    if lacking := [one.folder for one in every if one.folder not in moulds]:
        html(
            '<p class="note" data-test="no-points">No gauge points in {} (spec.json). {}, then record its pad.</p>',
            ", ".join(lacking),
            page_link("/mould", "Make the mould again"),
        )
    elif not moulds:
        html('<p class="note">No mould in this project yet: {}.</p>', page_link("/mould", "make one"))
    if not moulds:
        return
    known = {folder: f"{folder}: {one.label}" for folder, one in moulds.items()}
    wanted = [query.get(MOULD), *(folder for folder, one in moulds.items() if one.is_of(comparison.state)), *moulds]
    typed = {name.removeprefix(TYPED): text for name, text in query.items() if name.startswith(TYPED)}
    chosen = widgets.select("Mould it was cast in", known, next(one for one in wanted if one in known), "record-mould")
    with ui.element("div").classes("pair"):
        map_of = html("")
        with ui.element("div"):
            html("<b>Thickness at each point</b>")
            gauged = widgets.Form("gauge", kept=typed)
            others = widgets.Form(
                "record",
                lambda: {
                    **{name: NumberField(label, hint=hint) for name, (label, hint) in OTHERS.items()},
                    "note": ui.input("Note").props('hint="optional"'),
                },
                typed,
            )
            button = ui.element("div")

    def words() -> list[str]:
        gauges = gauged.filled(**{name: f"thickness at {name}" for name in gauged.fields})
        thickness = ",".join(f"{name}={value:g}" for name, value in gauges.items())
        more = others.filled(mass="the mass of the trimmed pad")
        return command("mold", "record", chosen.value, thickness=thickness, **more)

    def list_records() -> None:
        """List what was recorded, here and among the choices of the comparison."""
        with widgets.fresh(records):
            _records(root, chosen.value)
        comparison.find_pads()

    def renew() -> None:
        read = {f"{TYPED}{name}": text for name, text in (gauged.kept() | others.kept()).items()}
        keep_state(comparison.state, **read, **{MOULD: chosen.value})
        draw_map()
        work.renew()

    def draw_map() -> None:
        mould, points = moulds[chosen.value], project_index.gauge_points(root / chosen.value)
        map_of.set_content(gauge_map(points, mould.length_mm, mould.width_mm, gauged.kept()))

    found, records = widgets.area(), widgets.area()
    with button:
        work = JobPanel(
            root,
            "record",
            "Keep this record",
            words,
            lambda job: show_record(job.answer),
            ended=lambda job, mine: list_records(),
            needs="limits",
            found=found,
        )

    def new_mould() -> None:
        gauged.lay(
            lambda: {
                one.name: NumberField(f"{n} {one.name} [mm]", hint=f"{one.low_mm:.4g} to {one.high_mm:.4g}")
                for n, one in enumerate(project_index.gauge_points(root / chosen.value), 1)
            }
        )
        gauged.on_change(renew)
        draw_map()
        list_records()
        work.renew()

    new_mould()
    for follow in (new_mould, renew):
        chosen.on_value_change(follow)
    others.on_change(renew)


def gauge_map(marks: Sequence[GaugePoint], length_mm: float, width_mm: float, typed: Mapping[str, str]) -> str:
    """The pad from above with its gauge points, numbered; green within the limits, red outside, empty before."""
    dots = ""
    for number, one in enumerate(marks, 1):
        with suppress(InputError):
            value = widgets.number_of(typed.get(one.name, ""), one.name)
            kind = "" if value is None else "kept" if one.low_mm <= value <= one.high_mm else "missed"
            dots += f'<g class="{kind}" transform="translate({one.x_mm:g},{-one.y_mm:g})"><circle r="5"/>'
            dots += f'<text text-anchor="middle" dy="2.4">{number}</text></g>'
    box = f'x="{-length_mm / 2:g}" y="{-width_mm / 2:g}" width="{length_mm:g}" height="{width_mm:g}"'
    view = f"{-length_mm / 2 - 2:g} {-width_mm / 2 - 2:g} {length_mm + 4:g} {width_mm + 4:g}"
    return (
        f'<figure class="gauge" data-test="gauge-map"><svg viewBox="{view}" role="img" aria-label="the pad from above '
        f'with its {len(marks)} gauge points"><rect {box} rx="2"/>{dots}</svg><figcaption>Where to gauge, seen on the '
        f"tested face; {length_mm:g} x {width_mm:g} mm</figcaption></figure>"
    )


def _records(root: Path, folder: str) -> None:
    """Records that lie in the folder of a mould, each in a line."""
    rows = []
    for path in sorted((root / folder).glob("record*.json")):
        with suppress(ValueError, KeyError, TypeError):
            one = read_json(path)
            verdict = "accepted" if one["accepted"] else f"not accepted: {', '.join(one['missed'])}"
            rows.append([path.name, f"{one['thickness_mm']:.2f}", f"{one['mass_g']:g}", verdict])
    if rows:
        widgets.table(["record", "thickness mm", "mass g", ""], rows, words=True)


def show_record(answer: Mapping[str, Any]) -> None:
    """The verdict of a record: each limit, and what it does to the force."""
    light, text = "green", "Accepted: the pad keeps all limits."
    if not answer["accepted"]:
        light, text = "red", f"Not accepted. It misses {', '.join(answer['missed'])}."
    force = answer.get("force_percent")
    more = "" if force is None else f" Its force at a given depth is {force:+.1f} % off the designed pad's."
    widgets.tell_verdict(light, text + more, test="verdict")
    columns: dict[str, str | Callable[[Any], object]] = {
        "what": "what",
        "value": "value",
        "unit": "unit",
        "allowed": lambda one: allowed_words(one["low"], one["high"]),
        "result": lambda one: "missed" if one["missed"] else "" if one["high"] is None else "kept",
        "what to do": lambda one: one["advice"] * (one["missed"] or one["high"] is None),
    }
    widgets.records(columns, answer["limits"], words=True)


LIGHTS = {"pass": "green", "undecided": "amber", "fail": "red"}
SHORT = {
    "position": "the arm keeps its path",
    "steady": "the same steady force",
    "force": "the arm keeps its force",
    "mass": "a free body",
    "spring": "an arm with a spring and a mass",
}


class PeopleOfPad:
    """Drive, limits, and what the presses would have been on people."""

    def __init__(self, comparison: PressComparison) -> None:
        self.root, self.comparison = comparison.root, comparison
        self.pad = html("")
        with widgets.fields():
            known = {name: f"{name}: {SHORT[name]}" if name in SHORT else name for name in DRIVES}
            self.drive = widgets.select("What moves the robot", known, "position", "drive")
            self.numbers: dict[QuantitySpec, NumberField] = {}
            for purpose, usual in _numbers().items():
                name = purpose.quantity.partition(" in ")[0]
                label = f"{name[0].upper()}{name[1:]}" + f" [{purpose.unit}]" * bool(purpose.unit)
                wanting = {drive for drive, one in DRIVES.items() if purpose in dict(one.numbers)}
                field = NumberField(label, usual, test=f"drive-{name}")
                self.numbers[purpose] = field.bind_visibility_from(self.drive, "value", wanting.__contains__)
            self.limits = widgets.select("Your limits", self._known_limits(), "", "limits")
        self.work = JobPanel(
            self.root,
            "on-person",
            "Compute the presses on people",
            self.words,
            lambda job: show_people(self.root, job.answer),
            needs="presses",
        )
        with widgets.fold("Limits of your own: force and pressure with their source", "own-limits"):
            DropList(
                self.root,
                self._keep_limits,
                self._find_limits,
                "A TOML file of limits, as the page on people describes it.",
                "limits",
            )
        widgets.on_change(self.work.renew, self.drive, self.limits, *self.numbers.values())

    def words(self) -> list[str]:
        """The command of what is chosen."""
        (pad, presses), tissue = self.comparison.presses(), self.comparison.tissue.value
        values = {purpose: self.numbers[purpose].number for purpose, _ in DRIVES[self.drive.value].numbers}
        for purpose, value in values.items():
            if value is None:
                raise InputError(f"type {purpose.quantity}", "missing", "drive")
        numbers = ",".join(f"{value:g}" for value in values.values())
        drive = read_drive(f"{self.drive.value}:{numbers}" if numbers else self.drive.value)
        return command(
            "on-person",
            *presses,
            tissue=tissue,
            drive=drive.text,
            limits=self.limits.value,
            lowpass=pad.lowpass,
            punch=pad.punch,
            out=f"designs/on-person-{Path(tissue).stem}",
        )

    def _known_limits(self) -> dict[str, str]:
        return {"": "none"} | {f"{LIMITS}/{one.name}": one.stem for one in sorted((self.root / LIMITS).glob("*.toml"))}

    def _find_limits(self) -> None:
        widgets.offer(self.limits, self._known_limits(), self.limits.value)

    def _keep_limits(self, name: str, content: bytes) -> Taken:
        """Keep a file of limits that can be read, and choose it."""
        if Path(file_transfer.plain_name(name)).suffix.lower() != ".toml":
            raise InputError("choose a file that ends in .toml", "unknown_name", "file_ending", name, ".toml")
        file_transfer.read_sent(name, content, read_limits)
        kept = keep_file(self.root, self.root / LIMITS, name, content)
        self.limits.set_options(self._known_limits(), value=f"{LIMITS}/{kept.name}")
        return kept


def _numbers() -> dict[QuantitySpec, float | None]:
    """Numbers of all drives, with the default of those that may be left out."""
    numbers: dict[QuantitySpec, float | None] = {}
    for drive in DRIVES.values():
        usual = [None] * (len(drive.numbers) - len(drive.defaults)) + list(drive.defaults)
        numbers |= {purpose: value for (purpose, _), value in zip(drive.numbers, usual)}
    return numbers


LIMIT_COLUMNS: dict[str, str | Callable[[Any], object]] = {
    "result": lambda row: row["result"].upper(),
    "limit of": people.limit_name,
    "limit": "limit",
    "unit": "unit",
    "pad": lambda row: people.number_text(row["pad"]),
    "people, 95 %": lambda row: people.span_text([row["person_low_95"], row["person_high_95"]]),
    "why": "reason",
    "press": "press",
}


def show_people(root: Path, answer: Mapping[str, Any]) -> None:
    """Result, presses, limits, warnings and the report of an answer of ``on-person``."""
    files, result = answer.get("files") or {}, dict(answer)
    widgets.tell_changes(root, str(files.get("manifest") or ""), "Compute them again.")
    word, text = people.headline(result)
    if wrong := people.mismatch(result):
        widgets.tell_verdict("amber", f"CAUTION. {wrong}", test="drive-mismatch")
    beyond = people.worst_beyond(result["presses"])
    if beyond and beyond[1] > people.FAR:
        first = people.extrapolation_text(result["presses"])
        widgets.tell_verdict("red", text if first in text else f"{first}{text}", test="people")
    elif word in LIGHTS:
        widgets.tell_verdict(LIGHTS[word], f"{word.upper()}. {text}", test="people")
    else:
        html('<p data-test="people">{}</p>', text)
    table = people.press_table(result)
    widgets.table(table.head, table.rows)
    if rows := people.limit_rows(result):
        widgets.records(LIMIT_COLUMNS, ({"press": file, **row} for row, file in rows), words=True)
    widgets.show_report(root, files, "report of the presses on people")
