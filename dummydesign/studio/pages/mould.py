"""The mould of a pad: its size and preset, the work with its progress, checks, solids, and all files at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.studio import choices
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
    warnings,
    zip_link,
)  # fmt: skip
from dummydesign.studio.state import State, design_summary
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, query: Mapping[str, str]) -> None:
    """Build the page."""
    lay_out(studio, "/mould", "Mould", query, lambda project, state: _body(studio, project, state))


def _body(studio: Studio, project: Project, state: State) -> None:
    source = html("").style("width:100%")
    presets = ["open", "lidded", "printed"]
    resins, resin = choices.resins(), state.resin
    with ui.element("div").classes("fields"):
        thickness = ui.number("Thickness [mm]", value=state.thickness_mm, min=3, max=30, step=0.5)
        length = ui.number("Length [mm]", value=150.0, min=20, max=300, step=5)
        width = ui.number("Width [mm]", value=120.0, min=20, max=300, step=5)
        shape = ui.input("Shape", value=state.shape)
        ratio = ui.number("Ratio", value=state.ratio, step=0.1)
        material = ui.select(resins if resin in resins else {resin: resin, **resins}, value=resin, label="Resin")
        preset = ui.select(presets, value="open", label="Kind of mould").props('data-test="preset"')
    thickness.props('data-test="thickness"')

    def words() -> list[str]:
        for name, field in (("thickness", thickness), ("length", length), ("width", width), ("ratio", ratio)):
            if field.value is None:
                raise InputError(f"{name} is empty")
        kind = (shape.value or "slab").partition(":")[0]
        given: dict[str, Any] = {
            "thickness": float(thickness.value), "length": None if length.value == 150 else float(length.value),
            "width": None if width.value == 120 else float(width.value),
            "shape": None if shape.value == "slab" else shape.value, "preset": preset.value, "resin": material.value,
            "ratio": float(ratio.value),
            "out": f"moulds/mould_{'' if kind == 'slab' else f'{kind}_'}t{thickness.value:g}",
        }  # fmt: skip
        return ["mold", *options(given)]

    def show(job: Job) -> None:
        _show(studio, job.answer)

    def chosen() -> State:
        return state.changed(
            shape=(shape.value or "slab").strip(), resin=material.value,
            thickness_mm=float(thickness.value or state.thickness_mm), ratio=float(ratio.value or state.ratio),
        )  # fmt: skip

    def belongs(job: Job) -> bool:
        try:
            return pad_of(job.words) == pad_of(words())
        except InputError:
            return False

    work = Work(studio, "mould", "Make the mould", words, show, belongs)

    def renew() -> None:
        now = chosen()
        keep_state(now)
        source.set_content(_source(studio, now))
        work.renew_line()

    source.set_content(_source(studio, state))
    for field in (thickness, length, width, shape, ratio, material, preset):
        field.on_value_change(renew)


def pad_of(words: Sequence[str]) -> tuple[str, ...]:
    """The options of a command line of ``mold`` but for its folder: the pad and the kind of mould."""
    given = list(words)
    if "--out" in given:
        at = given.index("--out")
        del given[at : at + 2]
    return tuple(given)


def _source(studio: Studio, state: State) -> str:
    """Where the pad comes from, with the verdict on it."""
    if not state.design:
        link = page_link("/design", "design one")
        return f'<p class="note">This pad is not one of the designs. Check it, or {link}.</p>'
    summary = design_summary(studio.root, state.design)
    red = summary.get("verdict") == "not_representative"
    verdict = f'<p class="problem" role="alert">{escape(str(summary.get("text", "")))} Do not cast this pad.</p>'
    return f"<p>This pad is the design <b>{escape(state.design)}</b>.</p>{verdict if red else ''}"


def _show(studio: Studio, answer: dict[str, Any]) -> None:
    if "pour" not in answer:
        return
    batch = answer.get("batch") or {**answer["pour"], "pour_g": answer["pour"]["fill_mass_g"]}
    poured = [(f"{part['mass_g']:.1f} g", f"{part['name']}, to mix") for part in batch["components"]]
    poured.append((f"{batch['pour_g']:.1f} g", "of the mix, into the mould"))
    silicone = answer["pour"]["silicone_mass_g"]
    facts([*poured, *([(f"{silicone:.0f} g", "silicone for the mould")] if silicone else [])])
    checks = answer.get("checks", [])
    if checks:
        count = sum(one["status"] == "pass" for one in checks)
        html(f"<p><b>{count} of {len(checks)} checks passed</b></p>")
        rest = [[one["id"], one["status"], str(one.get("note", ""))] for one in checks if one["status"] != "pass"]
        if rest:
            table(["check", "", "because"], rest, words=True)
    warnings(answer)
    if not answer.get("files"):
        return
    folder = Path(next(iter(answer["files"].values()))).parent.as_posix()
    zip_link(folder)
    if list((studio.root / folder).glob("*.stl")):
        shown_file(f"/solid/mould/{folder}", "pad and mould as solids", "shown solid")
    file_links([(f"{role.replace('_', ' ')}: {Path(path).name}", path) for role, path in answer["files"].items()])
    html(f'<p class="note">Next: cast the pads, then {page_link("/campaign", "plan what to press")}.</p>')
