"""The mould of a pad: its size and preset, the work with its progress, checks, solids, and all files at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nicegui import ui

from dummydesign.core.errors import InputError
from dummydesign.project.folder import Project
from dummydesign.project.status import status_of
from dummydesign.studio import choices
from dummydesign.studio.frame import (
    Studio,
    Work,
    facts,
    file_links,
    html,
    lay_out,
    shown_file,
    table,
    warnings,
    zip_link,
)  # fmt: skip
from dummydesign.studio.work.commands import options
from dummydesign.studio.work.jobs import Job


def build(studio: Studio, which: str) -> None:
    """Build the page."""
    lay_out(studio, "/mould", "Mould", lambda project: _body(studio, project, which))


def _body(studio: Studio, project: Project, which: str) -> None:
    best = _design(project, which)
    if best:
        html(f"<p>Filled in from the design <b>{best['from']}</b>.</p>")
    else:
        html('<p class="note">No design yet: give the pad here, or <a href="/design">design one</a>.</p>')
    presets = ["open", "lidded", "printed"]
    resins = choices.resins()
    resin = best.get("resin") or project.resin or "polyurethane-nagoya"
    with ui.element("div").classes("fields"):
        thickness = ui.number("Thickness [mm]", value=best.get("thickness_mm", 5.0), min=3, max=30, step=0.5)
        length = ui.number("Length [mm]", value=150.0, min=20, max=300, step=5)
        width = ui.number("Width [mm]", value=120.0, min=20, max=300, step=5)
        shape = ui.input("Shape", value=str(best.get("shape", "slab")))
        ratio = ui.number("Ratio", value=best.get("ratio", 15.0), step=0.1)
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

    work = Work(studio, "mould", "Make the mould", words, show)
    for field in (thickness, length, width, shape, ratio, material, preset):
        field.on_value_change(work.renew_line)


def _design(project: Project, which: str) -> dict[str, Any]:
    """The design asked for, or the newest."""
    found = [one for one in status_of(project).found["designs"] if one.summary and "thickness_mm" in one.summary]
    named = [one for one in found if one.folder.partition("/")[2] == which] or found
    return {**(named[-1].summary or {}), "from": named[-1].folder} if named else {}


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
    html('<p class="note">Next: cast the pads, then <a href="/campaign">plan what to press</a>.</p>')
