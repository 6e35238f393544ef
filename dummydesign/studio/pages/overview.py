"""The first page: make the folder a project, or see where it stands and what comes next."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path

from nicegui import ui

from dummydesign.core.levels import LEVELS, LIGHTS, level_name
from dummydesign.project.folder import Project, make_example, make_project
from dummydesign.project.status import STANDARD_RESIN, ProjectFile, ProjectStatus, measured, pads_of, status_of
from dummydesign.studio import figures, jobs, project_index, select_options, widgets
from dummydesign.studio.file_actions import deleted_files
from dummydesign.studio.markup import STEPS, Markup, in_page_words, joined, verbatim
from dummydesign.studio.state import State, absolute, address, designs_of, next_page, next_state, page_link
from dummydesign.studio.widgets import html

ROOMS = {
    "measured": ("/measured", "Measured files"),
    "tissue": ("/tissue", "Tissues of your own"),
    "designs": ("/design", "Designs and comparisons"),
    "moulds": ("/mould", "Moulds"),
    "campaigns": ("/campaign", "Campaigns"),
    "calibrations": ("/learn", "Calibrations"),
}

TABS = {"compare": "compare", "on-person": "people"}
"""Tab of the page of a cast pad with the answers of a command."""


def make_new(root: Path) -> None:
    """Build the page of a folder that is no project yet."""
    html(
        "<p>Turn presses on people into a pad that feels the same: its resin, its shape and its mould. "
        "A project is a folder with everything about one such pad.</p>"
    )
    form = widgets.Form(
        "new",
        lambda: {
            "name": ui.input("Name", value=root.name).props("data-test=name"),
            "tissue": widgets.select("Tissue", {"": "decide later", **select_options.tissues(root)}, "", "tissue"),
            "resin": widgets.select("Resin", select_options.resins(), STANDARD_RESIN),
        },
    )

    def given() -> dict[str, str | None]:
        return {name: text or None for name, text in form.kept().items()}

    def renew() -> None:
        with widgets.fresh(line):
            widgets.command_line(jobs.command("init", ".", **given()))

    problem = ui.element("div")

    def begin(make: Callable[[], object]) -> None:
        with widgets.problems_in(problem):
            make()
            ui.navigate.to(address("/"))

    with ui.element("div").classes("links"):
        widgets.button("Make the project", lambda: begin(lambda: make_project(root, **given())), "make", main=True)
        widgets.button("Open an example instead", lambda: begin(lambda: make_example(root)), "example")
        html('<span class="source">with presses of a forefinger and a pressed campaign, both simulated</span>')
    line = widgets.area()
    form.on_change(renew)
    renew()


def show_status(project: Project, state: State, query: Mapping[str, str]) -> None:
    """Build the page of a project."""
    status = status_of(project)
    following, page = next_state(status, state), next_page(status)
    html('<ol class="strip" data-test="steps">{}</ol>', _strip(status, page, following))
    with ui.element("div").classes("pair"):
        with ui.element("div"):
            # what must not be done, and why, is no name of a button
            before, _, words = in_page_words(status.next_text).rpartition("; then ")
            html("<p>Next step: {}</p>", before)
            html("{}", page_link(page, f"{words[:1].upper()}{words[1:]}", following, "next", kind="go"))
            widgets.command_line(shlex.split(status.next_command)[1:])
            given = ", ".join(f"{name} {value}" for name, value in project.given().items()) or "nothing chosen yet"
            html("<p>Chosen for this project: {}</p>", given)
        _show_newest(project.root, state)
    for problem in status.problems:
        widgets.tell_problem(problem)
    states, cards = states_of(project.root, status, state), []
    for room, (path, words) in ROOMS.items():
        lines = [line_of(path, one, states.get(one.folder)) for one in reversed(status.files[room])]
        cards.append((page_link(path, words), widgets.listed(lines or [Markup("none yet")], 8, "thing")))
    html('<div class="cards">{}</div>', joined("<div><h2>{}</h2>{}</div>", cards))
    reports = [
        (f"{one.folder.partition('/')[2]}: report", f"{one.folder}/report.html")
        for one in (*status.files["designs"], *status.files["calibrations"])
        if (project.root / one.folder / "report.html").is_file()
    ]
    if reports:
        html("<h2>Reports</h2>")
        widgets.file_links(reports)
    with widgets.fold("Deleted", "bin"):
        deleted_files(project.root)
    widgets.fold("What was run, and what is at work", "jobs", lambda: _show_jobs(project.root))


def _show_jobs(root: Path) -> None:
    """The last commands, those that wait for their turn too; each opens what it wrote beside its answer."""
    rows = []
    for job in reversed(jobs.all_jobs(root)[-12:]):
        state = "red" if job.state == "failed" and job.answer else job.progress or job.state
        notes = (str(one["message"]) for one in job.answer.get("warnings", []))
        log = "\n".join(filter(None, [job.log, *notes])) or "It wrote nothing beside its answer."
        rows.append((state, job.seconds, verbatim(job.begun), verbatim(log)))
    html(
        "{}",
        joined(
            '<details data-test="log"><summary>{}, {:.0f} s: <code>{}</code></summary><pre>{}</pre></details>', rows
        ),
    )


def _strip(status: ProjectStatus, next_path: str, following: State) -> Markup:
    """The steps: what each has, ticked when it is done; the next one stands out."""
    files, tissue = status.files, status.project.tissue
    designs = [one for one in designs_of(status.project.root).values() if one.command == "suggest"]
    verdict = designs[-1].level if designs else ""
    compared = [one for one in files["designs"] if one.command == "compare"]
    moulds, plans = pads_of(files), files["campaigns"]
    counts = [one.summary for one in plans if one.summary]
    whole = [one for one in counts if one["pressed"] and not one["missing"] + one["wrong"]]
    pressed = sum(one["pressed"] for one in counts)
    imports = [one for one in files["measured"] if one.command == "import"]
    raw, recorded = len(files["measured"]) - len(imports), len(list(status.project.root.glob("moulds/*/record*.json")))
    read = f"{len(imports)} import{'s' * (len(imports) > 1)}" if imports else f"{raw} not read yet" if raw else ""
    own = tissue or (files["tissue"][-1].folder if files["tissue"] else "")
    learned = files["calibrations"][-1].folder.partition("/")[2] if files["calibrations"] else ""
    words = {
        "/measured": (bool(imports), read or ("tissue of the library" if own else "")),
        "/tissue": (bool(own), own),
        "/design": (verdict not in ("", LEVELS[-1]), level_name(verdict)),
        "/resin": (measured(absolute(status.project.root, following.resin)), following.resin),
        "/mould": (bool(moulds), f"{len(moulds)} made" if moulds else ""),
        "/cast": (
            bool(compared),
            f"{len(compared)} compared" if compared else f"{recorded} recorded" if recorded else "",
        ),
        "/campaign": (
            bool(whole),
            f"{pressed} of {pressed + sum(one['missing'] for one in counts)} presses" if counts else "",
        ),
        "/learn": (bool(learned), learned),
    }
    items = []
    for path, name in list(STEPS.items())[1:]:
        done, what = words[path]
        mark = "next" if path == next_path else "done" if done else ""
        spoken = Markup('<span class="hide">done: </span>' if done else "")
        link = page_link(path, f"{'✓ ' * done}{name}", following if path == next_path else None)
        items.append((mark, spoken, link, what))
    return joined('<li class="{}">{}{}<small>{}</small></li>', items)


def _show_newest(root: Path, state: State) -> None:
    """The light and the section of the newest pad."""
    designs = designs_of(root)
    if not designs:
        return
    design = designs[next(reversed(designs))]
    newest, doubts = state.changed(**design.given), project_index.doubts_of_design(root, design, state)
    with ui.element("div"):
        widgets.tell_verdict(
            "grey" if doubts else LIGHTS.get(design.level, "amber"), design.text, newest.label, "newest"
        )
        if doubts:
            widgets.tell_problem(f"{' '.join(doubts)} Search again.")
    html("{}", figures.section_html(root, newest))


def states_of(root: Path, status: ProjectStatus, state: State) -> dict[str, State]:
    """The state in which each thing of a project opens its page, by folder: with that thing chosen."""
    states = {folder: state.changed(**one.given) for folder, one in designs_of(root).items()}
    states |= {one.folder: state for one in status.files["designs"] if one.command in TABS}
    states |= {one.folder: state.changed(**one.pad, design="") for one in project_index.moulds(root)}
    states |= {one.folder: state.changed(tissue=one.folder, aim="average") for one in status.files["tissue"]}
    for one in status.files["campaigns"]:
        states[one.folder] = state.changed(campaign=one.folder)
        for learned in project_index.calibrations(root, one.folder):
            states[learned.folder] = state.changed(campaign=one.folder, calibration=learned.file)
    return states


def line_of(path: str, one: ProjectFile, opened: State | None) -> Markup:
    """One thing that lies in the project, with what is known of it; a link where its page can open it."""
    words = f"{one.folder.partition('/')[2]}: {one.line}".removesuffix(": ")
    if opened is None:
        return verbatim(words)
    if tab := TABS.get(one.command):
        return page_link("/cast", words, opened, f"open-{one.folder}", more=f"cast_tab={tab}")
    return page_link(path, words, opened, f"open-{one.folder}")
