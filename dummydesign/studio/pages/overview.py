"""The first page: make the folder a project, or see where it stands and what comes next."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project, make_project
from dummydesign.project.status import status_of
from dummydesign.studio import choices
from dummydesign.studio.addresses import address
from dummydesign.studio.frame import Studio, command_line, file_links, html, lay_out, page_link, tell_problem
from dummydesign.studio.manage import deleted_files
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options, shown

ROOMS = {
    "measured": ("/measured", "Measured files"), "tissue": ("/tissue", "Tissues of your own"),
    "designs": ("/design", "Designs"), "moulds": ("/mould", "Moulds"), "campaigns": ("/campaign", "Campaigns"),
    "calibrations": ("/learn", "Calibrations"),
}  # fmt: skip

PAGES = {
    "tissues": "/tissue", "import": "/measured", "fit": "/tissue", "suggest": "/design", "mold": "/mould",
    "campaign": "/campaign", "loop": "/learn", "status": "/design",
}  # fmt: skip
"""Page that a command belongs to."""


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/", "Overview", query, lambda project, state: _stand(studio, project), lambda: _make(studio))


def _make(studio: Studio) -> None:
    html(
        "<p>A project folder keeps everything about one dummy: what was measured, the tissue, designs, moulds, "
        "campaigns and what was learned. The files in it are all there is; this page keeps nothing.</p>"
    )
    tissues = {"": "decide later", **choices.tissues(studio.root)}
    with ui.element("div").classes("fields"):
        name = ui.input("Name", value=studio.root.name).props('data-test="name"')
        tissue = ui.select(tissues, value="", label="Tissue").props('data-test="tissue"')
        resin = ui.select(choices.resins(), value="polyurethane-nagoya", label="Resin")
    line = ui.element("div")

    def given() -> dict[str, str | None]:
        return {"name": name.value or None, "tissue": tissue.value or None, "resin": resin.value or None}

    def renew() -> None:
        line.clear()
        with line:
            command_line(["init", ".", *options(given())])

    for field in (name, tissue, resin):
        field.on_value_change(renew)
    renew()
    problem = ui.element("div")

    def make() -> None:
        problem.clear()
        try:
            make_project(studio.root, **given())
        except InputError as said:
            with problem:
                tell_problem(str(said))
            return
        ui.navigate.to("/")

    ui.button("Make the project", on_click=make).props('data-test="make"')


def _stand(studio: Studio, project: Project) -> None:
    told = status_of(project)
    html(f'<p class="note next">Next: <b>{escape(told.next_text)}</b></p>')
    step = PAGES.get(told.next_command.split()[1], "/design")
    html(f'<a class="go" data-state data-test="next" href="{address(step)}">Go there</a>')
    html(f'<div class="command"><code>{escape(told.next_command)}</code></div>')
    given = ", ".join(f"{name} {value}" for name, value in project.given().items()) or "nothing chosen yet"
    html(f"<p>Chosen for this project: {escape(given)}</p>")
    for problem in told.problems:
        tell_problem(problem)
    cards = []
    for room, (path, words) in ROOMS.items():
        found = told.found[room]
        rows = "".join(f"<li>{escape(choices.told(one))}</li>" for one in reversed(found[-8:]))
        more = f"<li>and {len(found) - 8} more</li>" if len(found) > 8 else ""
        listed = f"<ul>{rows}{more}</ul>" if rows else "<p>none yet</p>"
        cards.append(f'<div><h2>{page_link(path, words)}</h2>{listed}</div>')
    html(f'<div class="cards">{"".join(cards)}</div>')
    reports = [
        (f"{one.folder.partition('/')[2]}: report", f"{one.folder}/report.html")
        for room in ("designs", "calibrations") for one in told.found[room]
        if (studio.root / one.folder / "report.html").is_file()
    ]  # fmt: skip
    if reports:
        html("<h2>Reports</h2>")
        file_links(reports)
    deleted_files(studio)
    _running(studio)


def _ended(job: jobs.Job) -> str:
    return "answer not acceptable" if job.state == "failed" and job.answer else job.state


def _running(studio: Studio) -> None:
    html("<h2>What was run</h2>")
    rows = [
        f"<li>{_ended(job)}, {job.seconds:.0f} s: <code>{escape(shown(job.words))}</code></li>"
        for job in reversed(jobs.all_jobs(studio.root)[-12:])
    ]
    html(f"<ul>{''.join(rows)}</ul>" if rows else "<p>nothing yet</p>")
