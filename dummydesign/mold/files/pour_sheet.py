"""The pour sheet: one set of blocks, written as a self-contained HTML page and as PDF. No CAD, no browser.

Pages of the PDF carry number, date, command and hash.
"""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from dummydesign.core.typeset import typeset
from dummydesign.mold.cad.label import label_text
from dummydesign.mold.files.drawing_sheet import Drawing, to_dxf, to_pdf, to_svg
from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.pour.acceptance import acceptance_rows, gauge_points, measured_blanks, points_rows, when_it_fails
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import CUP_FACTOR, WITNESS_MM, Batch, Mix, PourPlan, batch_of, pours_of
from dummydesign.mold.pour.printing import demould_steps, height_words, mould_steps, print_words, tip_words
from dummydesign.mold.pour.steps import BLANK, cup_words, demould_first, plug_finish, pour_steps, shape_mark
from dummydesign.resin.model.modulus_laws import ratio_words

PADS_A_TABLE = 4


@dataclass(frozen=True)
class SheetBlock:
    """A heading (``head``), a paragraph (``text``), a numbered list (``list``) or a ``table`` (first row its head)."""

    kind: str
    text: str = ""
    rows: tuple[tuple[str, ...], ...] = ()
    items: tuple[str, ...] = ()


def safety_words(pour: Pour, isocyanate: str = "") -> str:
    """What protects the person who pours; ``isocyanate`` is added to the words on it."""
    harm = f"isocyanates harm the airways and can cause a lasting allergy{isocyanate}. " if pour.has_isocyanate else ""
    return f"Safety: {harm}Gloves, goggles, extraction or a hood; read the safety data sheets of all products first."


def pour_sheet(
    spec: MouldSpec, plan: PourPlan, warnings: Sequence[dict[str, str]], printed_mm3: Mapping[str, float] | None = None
) -> list[SheetBlock]:
    """Put together the pour sheet of a mould, in the order of the work."""
    pad, mark = spec.pad, shape_mark(spec)
    title = f"Pour sheet: {pad.prefix + ' ' if pad.prefix else ''}pad "
    title += f"{pad.length_mm:g} x {pad.width_mm:g} x {pad.thickness_mm:g} mm, {spec.preset} mould"
    if pad.is_puck:
        title = f"Pour sheet: puck {pad.length_mm:g} x {pad.thickness_mm:g} mm, {spec.preset} mould"
    title += f" with {spec.count} cavities" if spec.count > 1 else ""
    text = label_text(spec)
    label = f"label on the mould: {text}" if text else "the land has no room for a label: mark the mould"
    typed = ",".join(f"{point.name}=MM" for point in gauge_points(spec))
    record = f"dummydesign mold record DIR --thickness {typed} --mass G [--modulus KPA --level DEG --bubbles N]"
    return [
        SheetBlock("head", title),
        SheetBlock("text", f"Specification {spec.hash}; {label}. Date {BLANK}  Operator {BLANK}  Resin batch {BLANK}"),
        *([SheetBlock("text", f"{pad.title}. {mark[0].upper()}{mark[1:]}.")] if mark else []),
        SheetBlock("text", safety_words(spec.pour, "; never heat open isocyanate; keep moisture out")),
        SheetBlock("head", "1. The mould"),
        SheetBlock("list", items=_mould_steps(spec, plan)),
        *_weight_blocks(spec, plan),
        SheetBlock("head", "3. Pour"),
        SheetBlock("list", items=tuple(step.text for step in pour_steps(spec, plan))),
        SheetBlock("head", "When a step fails"),
        SheetBlock("list", items=when_it_fails(spec)),
        SheetBlock("head", "4. Demould and measure"),
        SheetBlock(
            "list",
            items=(
                *demould_steps(spec),
                demould_first(spec),
                measured_blanks(spec.count),
                f"Age {spec.pour.age_before_test_days:g} days{spec.pour.mark('age_before_test_days')} at room "
                "temperature before testing; test pad and witness on one day.",
            ),
        ),
        *_gauge_blocks(spec),
        SheetBlock("head", "5. Accept or reject" + (", each pad" if spec.count > 1 else "")),
        SheetBlock("table", rows=tuple(acceptance_rows(spec, plan))),
        SheetBlock("text", f"Keep these values: {record}. Then name the record in the campaign of this pad."),
        SheetBlock("head", "What is needed"),
        SheetBlock("table", rows=tuple(bill_of_materials(materials(spec, plan, printed_mm3)))),
        SheetBlock("head", "Cautions"),
        SheetBlock("list", items=tuple(item["message"] for item in warnings)),
    ]


def _gauge_blocks(spec: MouldSpec) -> list[SheetBlock]:
    """Where to gauge the thickness: a table with a free column for each pad."""
    words = (
        "Gauge the thickness at these points, seen on the tested face; x runs along the length from the middle. "
        f"Zero the gauge on {'the plate of the bone' if spec.pad.shape.bone_height_mm else 'a flat base'}."
    )
    points = gauge_points(spec)
    tables = [
        SheetBlock("table", rows=tuple(points_rows(points, BLANK, first, min(PADS_A_TABLE, spec.count - first + 1))))
        for first in range(1, spec.count + 1, PADS_A_TABLE)
    ]
    return [SheetBlock("text", words), *tables]


def _mould_steps(spec: MouldSpec, plan: PourPlan) -> tuple[str, ...]:
    """From the printer to the empty mould."""
    silicone = spec.silicone
    plastic = f"a plastic that bears {spec.pour.cure_temperature_C:g} C"
    if spec.plastic is not None:
        plastic = f"{spec.plastic.name.upper()}, bears {spec.plastic.service_temperature_C:g} C"
    face = plug_finish(spec)
    if words := tip_words(spec):
        face += f" There {words}. {height_words(spec)}"
    if silicone is None:
        return mould_steps(spec, plastic, face)
    mix = f"Mix {plan.silicone_mass_g:.0f} g {silicone.name}"
    if plan.lid_silicone_mass_g:
        mix += f" for the mould, then {plan.lid_silicone_mass_g:.0f} g for the lid, each"
    pins = ["Stand the sprue pin (one) and the vent pins (five) in their sockets; pull them before peeling the lid."]
    return (
        f"Print master and frame{_aids(spec)} and tray ({plastic}; 4 perimeters, 15 % infill). "
        f"{face}{print_words(spec)}",
        f"Test cure inhibition: a dab of this silicone on this print, and a dab of resin {spec.pour.resin} on cured "
        "silicone, overnight. Tacky borders mean inhibition: seal the print or change the product.",
        f"Bolt frame to master (8 x M{math.floor(spec.box.bolt_hole_mm):g}) and stand the box level: the silicone's "
        "free face becomes the mould's underside.",
        *(pins if spec.closure is not None else []),
        f"{mix} in the ratio of its data sheet (ratio {BLANK}). Pour it "
        "into a second cup and mix again. Degas at most 5 min. "
        f"Pour within {silicone.pot_life_min:g} min from one corner up to the step in the frame. Cure it at "
        "room temperature: heat may warp the print.",
        f"Leave {silicone.cure_time_h:g} h, lift the frame off, peel the silicone off the plug. "
        f"Post-cure it without the print in a vented oven (warm silicone gives off vapour). Data sheet says: {BLANK}",
    )


def _aids(spec: MouldSpec) -> str:
    """What is printed besides master, frame and tray."""
    if spec.closure is not None:
        return " of mould and lid, pins and backer"
    if spec.pad.shape.bone_height_mm:
        return ", carrier with the bone (solid)"
    carrier = ", carrier (solid)" if len(spec.pad.shape.places_mm) > 1 else ""
    return f", strike-off plate{carrier}" if spec.base is None else ", strike-off plate, spacer"


def _weight_blocks(spec: MouldSpec, plan: PourPlan) -> list[SheetBlock]:
    heads = ["2. Weigh the resin"]
    if spec.base is not None:
        heads = [
            "2a. Weigh the resin of the upper layer (poured first)",
            "2b. Weigh the resin of the base layer (poured second, when the first has gelled)",
        ]
    return [
        block
        for head, one in zip(heads, pours_of(spec, plan))
        for block in (SheetBlock("head", head), *_weighing(spec, *one))
    ]


def _weighing(spec: MouldSpec, pour: Pour, plan: PourPlan) -> list[SheetBlock]:
    """Table of one resin's weights, and how much of the batch goes where."""
    resolution = spec.machines.balance_resolution_g
    digits = max(0, -math.floor(math.log10(resolution)))
    batch = batch_of(spec, pour, plan)
    mixes = [batch.mix] if batch.holds_witness else [batch.mix, batch.with_witness]
    cup = cup_words(pour, CUP_FACTOR * mixes[-1].total_g / pour.density_g_per_cm3 * 1e-3)
    diameter, height = WITNESS_MM
    witness = (
        f"Witness: a puck of {diameter:g} mm diameter and {height:g} mm height from the same cup "
        f"({batch.witness_g:.1f} g). Its printed ring and how to press it: dummydesign mold --puck "
        f"{diameter:g}x{height:g}. Compress it on the day of the test and read its modulus with: "
        f"dummydesign resins add-compression TRACE.csv --diameter {diameter:g} --height {height:g} --friction "
        f"lubricated --name NAME --ratio {pour.ratio:.6g}."
    )
    return [
        SheetBlock(
            "text",
            f"{pour.resin}, ratio {pour.ratio:.6g} ({ratio_text(pour)}){_made(mixes)}; balance step "
            f"{resolution:g} g, each reading within half of it.",
        ),
        SheetBlock("table", rows=tuple(weight_rows(mixes, digits))),
        *volume_blocks(pour),
        SheetBlock("text", " ".join((*_batch_words(spec, pour, plan, batch, digits), cup))),
        SheetBlock("text", witness),
        *([SheetBlock("text", _hardness_words(pour))] if pour.hardness else []),
    ]


def weight_rows(mixes: Sequence[Mix], digits: int) -> list[tuple[str, ...]]:
    """Table of the masses of each mix, of a resin by volume the volumes too, with a column to fill in."""
    columns: list[list[str]] = [["component", *(name for name, _ in mixes[0].components), "total"]]
    for name, mix in zip(("mix", "mix with a witness puck"), mixes):
        masses = (*(mass for _, mass in mix.components), mix.total_g)
        columns.append([f"{name}, g", *(f"{mass:.{digits}f}" for mass in masses)])
        if mix.volumes_ml:
            volumes = (*mix.volumes_ml, sum(mix.volumes_ml))
            columns.append([f"{name}, ml", *(f"{volume:.1f}" for volume in volumes)])
    return list(zip(*columns, ["weighed, g", *[BLANK] * (len(columns[0]) - 1)]))


def ratio_text(pour: Pour) -> str:
    """What the ratio counts, by weight or by volume; the meaning alone for a resin of one component."""
    return ratio_words(pour.ratio_meaning, pour.ratio_by) if len(pour.components) > 1 else pour.ratio_meaning


def volume_blocks(pour: Pour) -> list[SheetBlock]:
    """How the weights follow from a ratio by volume; nothing for one by weight."""
    if not pour.component_densities_g_per_cm3:
        return []
    densities = ", ".join(
        f"{name} {density:g} g/cm3" for (name, _), density in zip(pour.components, pour.component_densities_g_per_cm3)
    )
    return [SheetBlock("text", f"The ratio is by volume. The masses follow from the densities: {densities}.")]


def _hardness_words(pour: Pour) -> str:
    """The reading that a durometer should show on the cured resin."""
    return (
        f"Hardness, a rough check without a press: a durometer should show {pour.hardness} after "
        f"{pour.age_before_test_days:g} days{pour.mark('age_before_test_days')}, on a piece at least 6 mm thick. "
        f"Outside it the batch is not this recipe. Reading: {BLANK}"
    )


def _made(mixes: Sequence[Mix]) -> str:
    """The ratio of the weights that are printed."""
    ratios = dict.fromkeys(f"{mix.ratio:.5g}" for mix in mixes if mix.ratio is not None)
    return f"; these weights make {' and '.join(ratios)}" if ratios else ""


def _batch_words(spec: MouldSpec, pour: Pour, plan: PourPlan, batch: Batch, digits: int) -> list[str]:
    """How much to mix, how much of it to pour, why so much, and where the rest goes."""
    each = f" ({plan.fill_mass_g:.1f} g into each of {spec.count} cavities)" if spec.count > 1 else ""
    error = f"The balance leaves up to {batch.mix.error_percent:.2f} % error in a component's share."
    if batch.raised:
        error = (
            f"With the loss in the cup and the spare {plan.batch_mass_g:.{digits}f} g would do. Of that the "
            f"balance leaves up to {plan.ratio_error_percent:.2f} % error in a component's share; of this mix "
            f"{batch.mix.error_percent:.2f} %. A finer balance saves resin."
        )
    rest = (
        f"With a witness puck mix the second column, {batch.with_witness.total_g:.{digits}f} g; pour the same mass "
        "into the mould."
    )
    if batch.holds_witness:
        rest = f"The rest is enough for the witness puck ({batch.witness_g:.1f} g)."
    return [
        f"Mix {batch.mix.total_g:.{digits}f} g and pour {batch.pour_g:.1f} g of it into the mould{each}.",
        error,
        f"{pour.film_loss_g:g} g stay on cup and stirrer; {pour.extra_percent:g} % of the pour are spare.",
        rest,
    ]


_STYLE = (
    "body{font:15px/1.45 system-ui,sans-serif;max-width:860px;margin:2em auto;padding:0 1em;color:#20303c}"
    "table{border-collapse:collapse}td,th{border:1px solid #9fb0bc;padding:.35em .8em;text-align:right}"
    "td:first-child,th:first-child{text-align:left}h1{font-size:1.5em}h2{font-size:1.15em;margin-top:1.6em}"
    "svg{max-width:100%;height:auto;border:1px solid #dde5ea}li{margin:.3em 0}"
    "@media print{body{margin:0;font-size:12px}}"
)


def to_html(blocks: Sequence[SheetBlock], drawings_svg: str = "") -> str:
    """Write blocks as one HTML page that needs nothing else; drawings may stand at its end."""
    parts: list[str] = []
    for index, block in enumerate(blocks):
        if block.kind == "list":
            parts.append(f"<ol>{_each('li', block.items)}</ol>")
        elif block.kind == "table":
            rows = (_each("td" if number else "th", row) for number, row in enumerate(block.rows))
            parts.append("<table>" + "".join(f"<tr>{row}</tr>" for row in rows) + "</table>")
        else:
            parts.append(_each("p" if block.kind == "text" else "h2" if index else "h1", [block.text]))
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">{_each("title", [blocks[0].text])}'
        f"<style>{_STYLE}</style></head><body>\n" + "\n".join(parts) + f"\n{drawings_svg}\n</body></html>\n"
    )


def _each(tag: str, texts: Sequence[str]) -> str:
    return "".join(f"<{tag}>{html.escape(text)}</{tag}>" for text in texts)


PAGES_MM = {"A4": (210.0, 297.0), "A3": (297.0, 420.0)}
TEMPLATE = Path(__file__).with_name("pour_sheet.typ")


@dataclass(frozen=True)
class Foot:
    """What stands at the foot of every page, and the paper of pages and drawings."""

    hash: str
    command: str = ""
    date: str = ""
    paper: str = "A4"


def sheet_pdf(blocks: Sequence[SheetBlock], foot: Foot, drawings: Sequence[Drawing] = ()) -> bytes:
    """Write a pour sheet as PDF."""
    words = "{}: not to scale here; the drawings' own PDF is true to scale."
    content = {
        "title": blocks[0].text,
        "paper": PAGES_MM[foot.paper],
        "blocks": [asdict(block) for block in blocks],
        "drawings": [{"title": one.title, "svg": to_svg(one), "words": words.format(one.title)} for one in drawings],
        "foot": {
            "mark": f"Specification {foot.hash}",
            "numbered": ["page", "of"],
            "date": foot.date,
            "command": foot.command,
        },
    }
    return typeset(TEMPLATE, content)


def write_papers(
    folder: Path,
    tag: str,
    blocks: Sequence[SheetBlock],
    foot: Foot,
    drawings: Sequence[Drawing],
    shown: Sequence[Drawing],
) -> dict[str, str]:
    """Write all drawings as one DXF and one PDF, the pour sheet with those shown as PDF and HTML; name them by role."""
    contents: dict[str, tuple[str, bytes]] = {
        "drawings_dxf": (f"drawings_{tag}.dxf", to_dxf(drawings).encode()),
        "drawings": (f"drawings_{tag}.pdf", to_pdf(drawings, f"Drawings, specification {foot.hash}")),
        "pour_sheet": (f"pour_{tag}.pdf", sheet_pdf(blocks, foot, shown)),
        "pour_sheet_html": (f"pour_{tag}.html", to_html(blocks, "\n".join(map(to_svg, shown))).encode()),
    }
    for name, content in contents.values():
        (folder / name).write_bytes(content)
    return {role: name for role, (name, _) in contents.items()}
