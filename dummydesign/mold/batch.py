"""Several moulds in one call: a folder each, one sheet and one list of what is needed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dummydesign.core.errors import InputError, NoAnswerError, out_of_range
from dummydesign.core.manifest import Question
from dummydesign.core.outputs import new_folder
from dummydesign.core.parsing import THICKNESSES, read_number
from dummydesign.mold.client import make_mold, papers
from dummydesign.mold.files.pour_sheet import Foot, SheetBlock, sheet_pdf
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import PourPlan, batches_of, pour_plan
from dummydesign.mold.pour.steps import BLANK

MOST = 20


@dataclass(frozen=True)
class Ordered:
    """One mould of a job: its specification, its pour and the volumes of its printed parts."""

    spec: MouldSpec
    plan: PourPlan
    printed_mm3: Mapping[str, float]


def check_job(thicknesses_mm: Sequence[float], castings: int) -> None:
    """Refuse a job without pads, with the same pad twice or with more than can be meant."""
    if not 1 <= castings <= MOST:
        raise out_of_range("--castings", castings, 1, MOST, "castings of each mould")
    if not 1 <= len(thicknesses_mm) <= MOST:
        raise out_of_range("number of thicknesses", len(thicknesses_mm), 1, MOST)
    most, times = Counter(thicknesses_mm).most_common(1)[0]
    if times > 1:
        raise out_of_range(
            f"number of {most:g} mm in --thickness",
            times,
            1,
            1,
            "several pads of one thickness are --count or --castings",
        )


def job_bill(ordered: Sequence[Ordered], castings: int) -> list[tuple[str, str, str]]:
    """Everything to buy or to have for a job, the first row the head."""
    needs = (need for one in ordered for need in materials(one.spec, one.plan, one.printed_mm3))
    return bill_of_materials(need.times(castings) for need in needs)


def job_sheet(ordered: Sequence[Ordered], castings: int) -> list[SheetBlock]:
    """The sheet of a job: its pads in the order of casting, thinnest first, and what all need together."""
    rows = [("pad", "specification", "folder", "castings", "mix each, g", "silicone, g", "cast on")]
    for one in sorted(ordered, key=lambda item: item.spec.pad.thickness_mm):
        batch = batches_of(one.spec, one.plan)
        mass = batch["total_g"] + batch.get("base", {}).get("total_g", 0.0)
        several = f", {one.spec.count} cavities" if one.spec.count > 1 else ""
        days = " ".join([BLANK] * min(castings, 3))
        rows.append(
            (
                one.spec.pad.title + several,
                one.spec.hash,
                one.spec.tag,
                f"{castings}",
                f"{mass:.1f}",
                f"{one.plan.silicone_mass_g:.0f}",
                days,
            )
        )
    hours, pads = max(one.spec.pour.cure_time_h for one in ordered), castings * sum(one.spec.count for one in ordered)
    return [
        SheetBlock("head", f"Job: {len(ordered)} moulds, {pads} pads"),
        SheetBlock(
            "text",
            "Every mould has its own folder with its pour sheet. Record each cast pad there with dummydesign "
            "mold record, as its pour sheet says.",
        ),
        SheetBlock("table", rows=tuple(rows)),
        SheetBlock(
            "text",
            f"A mould is in use for about {hours:g} h a casting: {castings} castings of each take {castings} "
            "cures. Pads of one campaign are best cast of one resin batch; the witness puck goes with every cup.",
        ),
        SheetBlock("head", "What is needed for all"),
        SheetBlock("table", rows=tuple(job_bill(ordered, castings))),
    ]


NOT_PRINTED = ("cavity", "pad_nominal", "pad_compensated", "layer_top", "layer_base", "face_sheet")
"""Volumes of a mould that are not of printed parts, beside those of silicone."""
SILICONE = ("mould", "lid")


def read_thicknesses(given: float | str | Iterable[float]) -> tuple[float, ...]:
    """Thicknesses of one call: a number, several, or text such as ``5,15``. [mm]"""
    if isinstance(given, int | float):
        return (float(given),)
    parts = given.split(",") if isinstance(given, str) else given
    try:
        return tuple(read_number(part, THICKNESSES) for part in parts)
    except TypeError:
        message = f"thickness in mm = {given} is not a number, or several comma-separated"
        raise InputError(message, "not_a_number", "thickness_mm") from None


def folder_name(thicknesses_mm: Sequence[float], castings: int, kind: str = "", count: int = 1) -> str:
    """Name of the folder when none is given."""
    head = "mould" if len(thicknesses_mm) == 1 and castings == 1 else "moulds"
    several = [f"x{count}"] if count > 1 else []
    return "_".join([head, *([kind] if kind else []), *(f"t{one:g}" for one in thicknesses_mm), *several])


def job_inputs(specs: Sequence[MouldSpec], castings: int) -> dict[str, Any]:
    """All values used, as the answer names them; checked before anything is made."""
    first, thicknesses = specs[0], [spec.pad.thickness_mm for spec in specs]
    check_job(thicknesses, castings)
    return {
        "thickness_mm": thicknesses,
        "length_mm": first.pad.length_mm,
        "width_mm": first.pad.width_mm,
        "shape": first.pad.name,
        "preset": first.preset,
        "resin": first.pour.resin,
        "ratio": first.pour.ratio,
        "ratio_meaning": first.pour.ratio_meaning,
        "count": first.count,
        "castings": castings,
    }


def make_job(
    specs: Sequence[MouldSpec], castings: int, folder: Path, asked: Question, replace: bool, paper: str = "A4"
) -> dict[str, Any]:
    """Make several moulds, all or none."""
    inputs, hashes = {**job_inputs(specs, castings), "paper": paper}, [spec.hash for spec in specs]
    moulds: list[dict[str, Any]] = []
    ordered: list[Ordered] = []
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(specs[0].sources)}
        for spec in specs:
            try:
                made = make_mold(spec, output.path(spec.tag), paper=paper).to_dict()
            except NoAnswerError as reason:
                result = output.settled({**head, **reason.result, "moulds": moulds, "files": {}})
                message = output.settled(f"{spec.pad.title}: {reason}")
                raise NoAnswerError(reason.code, message, result, reason.quantity) from None
            del made["memory_MB"]
            volumes = made["volumes_mm3"]
            plan = pour_plan(spec, volumes["pad_compensated"], volumes["mould"] + volumes.get("lid", 0.0))
            other = NOT_PRINTED if spec.is_printed else (*NOT_PRINTED, *SILICONE)
            ordered.append(Ordered(spec, plan, {name: one for name, one in volumes.items() if name not in other}))
            moulds.append({"thickness_mm": spec.pad.thickness_mm, "folder": str(output.path(spec.tag)), **made})
        job = output.path("job.pdf")
        job.write_bytes(sheet_pdf(job_sheet(ordered, castings), Foot(" ".join(hashes), **papers(paper))))
        output.extra["hashes"] = hashes
        listed = {f"{spec.tag}_{role}": path for spec, one in zip(specs, moulds) for role, path in one["files"].items()}
        warnings = [
            {**item, "message": f"{spec.pad.thickness_mm:g} mm: {item['message']}"}
            for spec, one in zip(specs, moulds)
            for item in one["warnings"]
        ]
        return output.answer(
            {
                **head,
                "moulds": moulds,
                "bill_of_materials": [list(row) for row in job_bill(ordered, castings)],
                "files": {"job": str(job), **listed},
                "warnings": warnings,
            }
        )
