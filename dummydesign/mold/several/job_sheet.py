"""One job for several pads: what all of them need together, and the sheet that lists them. No CAD."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dummydesign.core.errors import out_of_range
from dummydesign.mold.files.pour_sheet import Block
from dummydesign.mold.model.spec import MouldSpec
from dummydesign.mold.pour.batch import batches_of
from dummydesign.mold.pour.materials_list import HEAD, Need, materials
from dummydesign.mold.pour.plan import PourPlan
from dummydesign.mold.pour.steps import BLANK

MOST = 20


@dataclass(frozen=True)
class Ordered:
    """One mould of a job: its specification, its pour, the volumes of its printed parts and the folder it is in."""

    spec: MouldSpec
    plan: PourPlan
    printed_mm3: Mapping[str, float]
    folder: str


def check_job(thicknesses_mm: Sequence[float], castings: int) -> None:
    """Refuse a job without pads, with the same pad twice or with more than can be meant.

    Raises
    ------
    InputError
        With what is allowed.
    """
    if not 1 <= castings <= MOST:
        raise out_of_range("--castings", castings, 1, MOST, "castings of each mould")
    if not 1 <= len(thicknesses_mm) <= MOST:
        raise out_of_range("number of thicknesses", len(thicknesses_mm), 1, MOST)
    for one in thicknesses_mm:
        if list(thicknesses_mm).count(one) > 1:
            raise out_of_range(f"number of {one:g} mm in --thickness", list(thicknesses_mm).count(one), 1, 1,
                               "several pads of one thickness are --count or --castings")  # fmt: skip


def job_bill(ordered: Sequence[Ordered], castings: int) -> list[tuple[str, str, str]]:
    """Everything to buy or to have for a job, the first row the head.

    Parameters
    ----------
    ordered : sequence of Ordered
        The moulds; each is printed and cast in silicone once.
    castings : int
        Castings of each.

    Returns
    -------
    list of (str, str, str)
    """
    merged: dict[tuple[str, str], Need] = {}
    for one in ordered:
        for need in materials(one.spec, one.plan, one.printed_mm3):
            more = need.times(castings)
            key = (need.what, need.form)
            merged[key] = merged[key].with_(more) if key in merged else more
    return [HEAD, *(need.row for need in merged.values())]


def job_sheet(ordered: Sequence[Ordered], castings: int) -> list[Block]:
    """The sheet of a job: its pads in the order of casting, thinnest first, and what all need together.

    Parameters
    ----------
    ordered : sequence of Ordered
        The moulds.
    castings : int
        Castings of each.

    Returns
    -------
    list of Block
    """
    rows = [("pad", "specification", "folder", "castings", "mix each, g", "silicone, g", "cast on")]
    for one in sorted(ordered, key=lambda item: item.spec.pad.thickness_mm):
        batch = batches_of(one.spec, one.plan)
        mass = batch["total_g"] + batch.get("base", {}).get("total_g", 0.0)
        several = f", {one.spec.count} cavities" if one.spec.count > 1 else ""
        days = " ".join([BLANK] * min(castings, 3))
        rows.append((one.spec.pad.title + several, one.spec.hash, one.folder, f"{castings}", f"{mass:.1f}",
                     f"{one.plan.silicone_mass_g:.0f}", days))  # fmt: skip
    hours = max(one.spec.pour.cure_time_h for one in ordered)
    return [
        Block("head", f"Job: {len(ordered)} moulds, {castings * sum(one.spec.count for one in ordered)} pads"),
        Block("text", "Every mould has its own folder with its pour sheet. Record each cast pad there with dummydesign "
              "mold record, as its pour sheet says."),
        Block("table", rows=tuple(rows)),
        Block("text", f"A mould is in use for about {hours:g} h a casting: {castings} castings of each take {castings} "
              "cures. Pads of one campaign are best cast of one resin batch; the witness puck goes with every cup."),
        Block("head", "What is needed for all"),
        Block("table", rows=tuple(job_bill(ordered, castings))),
    ]  # fmt: skip
