"""Several moulds in one call: a folder each, one sheet and one list of what is needed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from dummydesign.core.checks import THICKNESSES, read_number
from dummydesign.core.errors import InputError, NoAnswerError
from dummydesign.core.outputs.manifest import Question
from dummydesign.core.outputs.write import new_folder
from dummydesign.mold.files.pour_sheet import to_markdown
from dummydesign.mold.files.sheet_pdf import Foot, sheet_pdf
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.plan import pour_plan
from dummydesign.mold.runner import make_mold, papers
from dummydesign.mold.several.job_sheet import Ordered, check_job, job_bill, job_sheet

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
        raise InputError(f"thickness in mm = {given} is not a number, or several comma-separated") from None


def folder_name(thicknesses_mm: Sequence[float], castings: int, kind: str = "", count: int = 1) -> str:
    """Name of the folder when none is given.

    Parameters
    ----------
    thicknesses_mm : sequence of float
        Of the pads. [mm]
    castings : int
        Castings of each.
    kind : str
        Of the shape; empty for a slab.
    count : int
        Cavities in each mould.
    """
    head = "mould" if len(thicknesses_mm) == 1 and castings == 1 else "moulds"
    several = [f"x{count}"] if count > 1 else []
    return "_".join([head, *([kind] if kind else []), *(f"t{one:g}" for one in thicknesses_mm), *several])


def job_inputs(specs: Sequence[MouldSpec], castings: int) -> dict[str, Any]:
    """All values used, as the answer names them; checked before anything is made.

    Raises
    ------
    InputError
        For a job that is not allowed.
    """
    first, thicknesses = specs[0], [spec.pad.thickness_mm for spec in specs]
    check_job(thicknesses, castings)
    return {
        "thickness_mm": thicknesses, "length_mm": first.pad.length_mm, "width_mm": first.pad.width_mm,
        "shape": first.pad.name, "preset": first.preset, "resin": first.pour.resin, "ratio": first.pour.ratio,
        "ratio_meaning": first.pour.ratio_meaning, "count": first.count, "castings": castings,
    }  # fmt: skip


def make_job(
    specs: Sequence[MouldSpec], castings: int, folder: Path, asked: Question, replace: bool
) -> dict[str, Any]:
    """Make several moulds, all or none.

    Parameters
    ----------
    specs : sequence of MouldSpec
        That differ in thickness.
    castings : int
        Castings of each.
    folder : Path
        Folder of the job.
    asked : Question
        For the manifest; its inputs are those of the answer.
    replace : bool
        Take the place of another answer there.

    Returns
    -------
    dict
        ``inputs``, ``moulds`` each with its folder, ``bill_of_materials``, ``files``, ``warnings``, ``sources``.

    Raises
    ------
    NoAnswerError
        When one of the moulds fails; no file is left.
    """
    inputs, hashes = job_inputs(specs, castings), [spec.hash for spec in specs]
    moulds: list[dict[str, Any]] = []
    ordered: list[Ordered] = []
    with new_folder(folder, asked, replace=replace) as output:
        head = {"inputs": {**inputs, "out": str(output.folder)}, "sources": list(specs[0].sources)}
        for spec in specs:
            try:
                made = make_mold(spec, output.path(spec.tag)).to_dict()
            except NoAnswerError as reason:
                result = output.settled({**head, **reason.result, "moulds": moulds, "files": {}})
                message = output.settled(f"{spec.pad.title}: {reason}")
                raise NoAnswerError(reason.code, message, result) from None
            del made["memory_MB"]
            volumes = made["volumes_mm3"]
            plan = pour_plan(spec, volumes["pad_compensated"], volumes["mould"] + volumes.get("lid", 0.0))
            silicone = () if spec.is_printed else SILICONE
            printed = {name: one for name, one in volumes.items() if name not in (*NOT_PRINTED, *silicone)}
            ordered.append(Ordered(spec, plan, printed, spec.tag))
            moulds.append({"thickness_mm": spec.pad.thickness_mm, "folder": str(output.path(spec.tag)), **made})
        blocks = job_sheet(ordered, castings)
        said = papers()
        output.path("job.md").write_text(to_markdown(blocks), encoding="utf-8")
        foot = Foot(" ".join(hashes), said["command"], said["date"])
        output.path("job.pdf").write_bytes(sheet_pdf(blocks, foot))
        output.extra["hashes"] = hashes
        files = {"job": str(output.path("job.md")), "job_pdf": str(output.path("job.pdf"))}
        files |= {f"{spec.tag}_{role}": path for spec, one in zip(specs, moulds) for role, path in one["files"].items()}
        bill = [list(row) for row in job_bill(ordered, castings)]
        warnings = [{**item, "message": f"{spec.pad.thickness_mm:g} mm: {item['message']}"}
                    for spec, one in zip(specs, moulds) for item in one["warnings"]]  # fmt: skip
        return output.answer(
            {**head, "moulds": moulds, "bill_of_materials": bill, "files": files, "warnings": warnings}
        )
