"""The tissue: one of the library or one fitted to presses; its band, and the project's choice."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project, change_project
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    Work,
    command_line,
    file_links,
    html,
    lay_out,
    open_page,
    page_link,
    table,
    tell_problem,
    warnings,
)
from dummydesign.studio.server import files
from dummydesign.studio.state import State
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/tissue", "Tissue", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    known = choices.tissues(studio.root)
    html("<p>The tissue that the dummy stands for. Its band is the range of the subjects that were measured.</p>")
    start = state.tissue
    known = known if start in known else {start: f"{start} (missing)", **known}
    chosen = ui.select(known, value=start, label="Tissue").props('data-test="tissue"').style("width:100%")
    shown = ui.element("div")

    def renew() -> None:
        shown.clear()
        with shown:
            _show_tissue(studio, chosen.value)

    def use() -> None:
        change_project(project, tissue=chosen.value, aim=None)
        open_page("/design", state.changed(tissue=chosen.value, aim="average"))

    chosen.on_value_change(renew)
    ui.button("Use it for this project", on_click=use).props('data-test="use"')
    renew()
    html("<h2>Fit a tissue to your own presses</h2>")
    _fit(studio, chosen)


def _show_tissue(studio: Studio, name: str) -> None:
    from dummydesign.design.scoring.presses import Sampling
    from dummydesign.design.scoring.targets import make_targets
    from dummydesign.studio import figures
    from dummydesign.tissue import load_tissue

    path = str(studio.root / name) if name.endswith(".toml") else name
    command_line(["tissues", "show", name])
    try:
        tissue = load_tissue(path)
        plot = figures.steady(tissue, make_targets(tissue, "average", Sampling()))
    except InputError as problem:
        tell_problem(str(problem))
        return
    html(f"<p><b>{escape(tissue.title)}</b>, {len(tissue.subjects)} subjects, law {escape(tissue.law)}</p>")
    html(f'<div class="plots">{plot.html()}</div>')
    rows = []
    for label, entry in tissue.to_dict()["bands"].items():
        parts = {label: entry} if "value" in entry else {f"{label} at {v} mm/s": one for v, one in entry.items()}
        rows += [[key, one["value"], one["low"], one["high"], one["kind"]] for key, one in parts.items()]
    table(["parameter", "mean", "lowest", "highest", "kind"], rows)
    for note in tissue.notes:
        html(f"<p>{escape(note)}</p>")


def _fit(studio: Studio, chosen: ui.select) -> None:
    found = choices.traces(studio.root)
    if not found:
        html(f'<p class="note">No presses yet: {page_link("/measured", "bring in files")} first.</p>')
        return
    with ui.element("div").classes("fields"):
        picked = ui.select(found, multiple=True, value=list(found), label="Presses of one subject")
        picked.props('use-chips data-test="traces"')
        name = ui.input("Name of the tissue", value=choices.free_name(studio.root, "tissue", "mine"))
        name.props('data-test="fit-name"')
        lowpass = ui.input("Filter of the force, HZ[:ORDER[:PASSES]] (optional)")

    def words() -> list[str]:
        if not picked.value:
            raise InputError("choose the presses to fit")
        kept = files.plain_name(f"{(name.value or '').strip() or 'mine'}.toml")
        return ["fit", *picked.value, *options({"lowpass": lowpass.value}), "--out", f"tissue/{kept}"]

    def show(job: Job) -> None:
        answer = job.answer
        if "parameters" not in answer:
            return
        html(
            f"<p>{answer['elements']} elements, {escape(answer['mode'])}: rms residual {answer['rmse_N']:.3g} N, noise "
            f"floor {answer['noise_floor_N']:.3g} N</p>"
        )
        rows = []
        for label, entry in answer["parameters"].items():
            parts = {label: entry} if "value" in entry else {f"{label} at {v} mm/s": e for v, e in entry.items()}
            rows += [[key, one["value"], one["low"], one["high"], "at bound" if one["at_bound"] else ""]
                     for key, one in parts.items()]  # fmt: skip
        table(["parameter", "value", "95 % low", "95 % high", ""], rows)
        warnings(answer)
        links = [(role.replace("_", " "), path) for role, path in answer["files"].items() if path.endswith(".html")]
        file_links(links)
        chosen.set_options(choices.tissues(studio.root))

    work = Work(studio, "fit", "Fit the tissue", words, show)
    for field in (picked, name, lowpass):
        field.on_value_change(work.renew_line)
