"""Fit a tissue of one subject to presses."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.studio import choices
from dummydesign.studio.frame import Work, file_links, html, table, tell_problem, warnings
from dummydesign.studio.server import files
from dummydesign.studio.work import jobs
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.inputs import changed_inputs
from dummydesign.studio.work.jobs import Job

if TYPE_CHECKING:
    from dummydesign.studio.pages.tissue import TissuePage

OWN = ("presses", "name", "touched")
"""Choices of this panel in the address."""
SEPARATOR = "\n"
CONTACT = {"": "as the files were read", "per-press": "fitted for each press"}


def fit_panel(page: TissuePage) -> None:
    """Fields, command and result of a fit.

    Parameters
    ----------
    page : TissuePage
        On which it stands; a fitted tissue is chosen there.
    """
    root = page.studio.root
    known = choices.traces(root)
    start, start_name, touched = _start(page, known)
    missing = [path for path in start if path not in known]
    for path in missing:
        tell_problem(f"The press '{path}' is not there (any more). Choose others, or bring it back.")
    picked = ui.select(known, multiple=True, value=[path for path in start if path in known],
                       label="Presses of one subject")  # fmt: skip
    picked.props('use-chips data-test="traces"').style("width:100%").set_enabled(bool(known))
    with ui.element("div").classes("fields"):
        name = ui.input("Name of the tissue", value=start_name).props('data-test="fit-name"')
        contact = ui.select(CONTACT, value=touched, label="Where each press touched").props('data-test="fit-contact"')
        lowpass = ui.input("Filter of the force, HZ[:ORDER[:PASSES]] (optional)")

    def words() -> list[str]:
        if not picked.value:
            raise InputError("Choose the presses to fit.")
        given = {"contact": contact.value, "lowpass": lowpass.value}
        kept = files.plain_name(f"{(name.value or '').strip() or 'mine'}.toml")
        return ["fit", *picked.value, *options(given), "--out", f"tissue/{kept}"]

    def belongs(job: Job) -> bool:
        """Whether a fit is of the chosen presses and name, and its tissue is still there."""
        try:
            asked = words()
        except InputError:
            return False
        if set(_presses(job)) != set(picked.value) or job.words[-1] != asked[-1]:
            return False
        tissue = _tissue_of(job)
        return not tissue or ((root / tissue).is_file() and jobs.is_last(root, job, _tissue_of))

    def show(job: Job) -> None:
        if "parameters" in job.answer:
            _show(page, job)

    def ended(job: Job) -> None:
        """Choose what was fitted, when it answers what is chosen."""
        if belongs(job) and "tissue" in job.answer.get("files", {}):
            page.choose(job.answer["files"]["tissue"])

    work = Work(page.studio, "fit", "Fit the tissue", words, show, belongs, ended)

    def renew() -> None:
        page.keep(presses=SEPARATOR.join(picked.value or []), name=name.value or "", touched=contact.value)
        work.renew_line()

    for field in (picked, name, contact, lowpass):
        field.on_value_change(renew)


def _start(page: TissuePage, known: dict[str, str]) -> tuple[list[str], str, str]:
    """Presses, name and contact: of the address, of the fit that made the tissue, or all presses and a free name."""
    root, query = page.studio.root, page.query
    if query.get("presses"):
        touched = query.get("touched", "")
        return query["presses"].split(SEPARATOR), query.get("name", ""), touched if touched in CONTACT else ""
    for job in reversed(jobs.named(root, "fit")):
        if job.answer.get("files", {}).get("tissue") == page.tissue:
            return _presses(job), Path(job.words[-1]).stem, "per-press" if "per-press" in job.words else ""
    return list(known), query.get("name") or choices.free_name(root, "tissue", "mine"), ""


def _tissue_of(job: Job) -> str:
    return str(job.answer.get("files", {}).get("tissue") or "")


def _presses(job: Job) -> list[str]:
    return [word for word in job.words[1:] if word.endswith(".csv")]


def _show(page: TissuePage, job: Job) -> None:
    answer, root = job.answer, page.studio.root
    tissue = answer["files"]["tissue"]
    for path in changed_inputs(root, root / answer["files"].get("manifest", "")):
        tell_problem(f"{path} has changed since the fit. Fit the tissue again.")
    html(
        f"<p><b>{escape(tissue)}</b>: {escape(str(answer['elements']))} elements, {escape(answer['mode'])}. Residual "
        f"{answer['rmse_N']:.3g} N rms, noise {answer['noise_floor_N']:.3g} N.</p>"
    )
    page.use_button(tissue)
    warnings(answer)
    show_curves(root, answer)
    table(["parameter", "value", "95 % low", "95 % high", ""], parameter_rows(answer["parameters"]))


def show_curves(root: Path, answer: Mapping[str, Any]) -> None:
    """Measured force with the fitted curve over it, and the report.

    Parameters
    ----------
    root : Path
        The project folder.
    answer : mapping
        JSON of ``fit``.
    """
    from dummydesign.studio import figures

    # several fits on a page have presses of the same name
    own = Path(answer["files"]["tissue"]).with_suffix("").as_posix().replace("/", "-")
    plots = figures.measured_over_fitted(root, answer)
    html(figures.plots_html(replace(one, name=f"{own}-{one.name}") for one in plots))
    report = answer["files"].get("report", "")
    if report and (root / report).is_file():
        file_links([("report of the fit, with its residuals", report)])


def parameter_rows(parameters: dict) -> list[list[object]]:
    """Rows of a table of fitted parameters, dampers by speed."""
    rows = []
    for label, entry in parameters.items():
        parts = {label: entry} if "value" in entry else {f"{label} at {v} mm/s": e for v, e in entry.items()}
        rows += [[key, one["value"], one["low"], one["high"], "at bound" if one["at_bound"] else ""]
                 for key, one in parts.items()]  # fmt: skip
    return rows
