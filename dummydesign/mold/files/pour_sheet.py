"""The pour sheet: one set of blocks, written as Markdown and as a self-contained HTML page. No CAD."""

from __future__ import annotations

import html
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dummydesign.mold.cad.label import label_text
from dummydesign.mold.gauging.points import gauge_points, points_rows
from dummydesign.mold.model import formulas as formula
from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.pour import shape_notes
from dummydesign.mold.pour.acceptance import acceptance_rows, measured_blanks, when_it_fails
from dummydesign.mold.pour.batch import WITNESS_DIAMETER_MM, WITNESS_HEIGHT_MM, Batch, batch_of
from dummydesign.mold.pour.materials_list import bill_of_materials
from dummydesign.mold.pour.plan import CUP_FACTOR, PourPlan
from dummydesign.mold.pour.pour_steps import pour_steps
from dummydesign.mold.pour.print_fit import print_words
from dummydesign.mold.pour.print_layers import tip_words
from dummydesign.mold.pour.steps import BLANK
from dummydesign.mold.printed.notes import demould_steps, mould_steps

PADS_A_TABLE = 4


@dataclass(frozen=True)
class Block:
    """A heading (``head``), a paragraph (``text``), a numbered list (``list``) or a ``table`` (first row its head)."""

    kind: str
    text: str = ""
    rows: tuple[tuple[str, ...], ...] = ()
    items: tuple[str, ...] = ()


def pour_sheet(
    spec: MouldSpec, plan: PourPlan, warnings: Sequence[dict[str, str]], printed_mm3: Mapping[str, float] | None = None
) -> list[Block]:
    """Put together the pour sheet of a mould, in the order of the work.

    Parameters
    ----------
    spec : MouldSpec
        The mould.
    plan : PourPlan
        Weights and times of its pours.
    warnings : sequence of dict
        ``code`` and ``message`` of each.
    printed_mm3 : mapping, optional
        Volumes of the printed parts, for the list of what is needed. [mm3]

    Returns
    -------
    list of Block
    """
    pad = spec.pad
    title = f"Pour sheet: {pad.prefix + ' ' if pad.prefix else ''}pad "
    title += f"{pad.length_mm:g} x {pad.width_mm:g} x {pad.thickness_mm:g} mm, {spec.preset} mould"
    title += f" with {spec.count} cavities" if spec.count > 1 else ""
    shape = shape_notes.shape_mark(spec)
    label = label_text(spec)
    mark = f"label on the mould: {label}" if label else "the land has no room for a label: mark the mould"
    return [
        Block("head", title),
        Block("text", f"Specification {spec.hash}; {mark}. Date {BLANK}  Operator {BLANK}  Resin batch {BLANK}"),
        *([Block("text", f"{pad.title}. {shape[0].upper()}{shape[1:]}.")] if shape else []),
        Block(
            "text",
            _safety(spec),
        ),
        *_mould_blocks(spec, plan),
        *_weight_blocks(spec, plan),
        *_pour_blocks(spec, plan),
        *_demould_blocks(spec),
        Block("head", "5. Accept or reject" + (", each pad" if spec.count > 1 else "")),
        Block("table", rows=tuple(acceptance_rows(spec, plan))),
        Block("text", f"Keep it: {_record_line(spec)}. A campaign then names the record and knows this pad."),
        Block("head", "What is needed"),
        Block("table", rows=tuple(bill_of_materials(spec, plan, printed_mm3))),
        Block("head", "Cautions"),
        Block("list", items=tuple(item["message"] for item in warnings)),
    ]


def _record_line(spec: MouldSpec) -> str:
    """What to type for the readings of the gauge points."""
    typed = ",".join(f"{point.name}=MM" for point in gauge_points(spec))
    return f"dummydesign mold record DIR --thickness {typed} --mass G [--modulus KPA --level DEG --bubbles N]"


def _gauge_blocks(spec: MouldSpec) -> list[Block]:
    """Where to gauge the thickness: a table with a free column for each pad."""
    words = "Gauge the thickness at these points, seen on the tested face; x runs along the length from the middle."
    words += f" Zero the gauge on {'the plate of the bone' if spec.pad.shape.bone_height_mm else 'a flat base'}."
    points = gauge_points(spec)
    tables = [
        Block("table", rows=tuple(points_rows(points, BLANK, first, min(PADS_A_TABLE, spec.count - first + 1))))
        for first in range(1, spec.count + 1, PADS_A_TABLE)
    ]
    return [Block("text", words), *tables]


def _safety(spec: MouldSpec) -> str:
    """The safety line; every resin with isocyanate carries its warning."""
    general = "Gloves, goggles, extraction or a hood; read the safety data sheets of all products first."
    if any("isocyanate" in name.lower() for name, _ in spec.pour.components):
        return (
            "Safety: isocyanates harm the airways and can sensitise for good; never heat open isocyanate, keep out "
            f"moisture. {general}"
        )
    return f"Safety: {general}"


def _mould_blocks(spec: MouldSpec, plan: PourPlan) -> list[Block]:
    silicone, box = spec.silicone, spec.box
    if silicone is None:
        printed = mould_steps(spec, _plastic(spec), shape_notes.plug_finish(spec) + _gauged(spec))
        return [Block("head", "1. The mould"), Block("list", items=printed)]
    lidded = spec.closure is not None
    aids = " of mould and lid, pins and backer" if lidded else _aids(spec)
    steps = [
        f"Print master and frame{aids} and tray ({_plastic(spec)}; 4 perimeters, 15 % infill; plug upwards). "
        f"{shape_notes.plug_finish(spec)}{_gauged(spec)}{print_words(spec)}",
        f"Test cure inhibition: a dab of this silicone on this print, and a dab of resin {spec.pour.resin} on cured "
        "silicone, overnight. Tacky borders mean inhibition: seal the print or change the product.",
        f"Bolt frame to master (8 x M{math.floor(box.bolt_hole_mm):g}) and stand the box level: the silicone's free "
        "face becomes the mould's underside.",
        f"Mix {plan.silicone_mass_g:.0f} g {silicone.name} in the ratio of its data sheet, which is "
        f"not known here (ratio {BLANK}; two cups, pour over and mix again), degas at most 5 min, "
        f"pour within {silicone.pot_life_min:g} min from one corner up to the step in the frame; cure it at "
        "room temperature: the print may not bear more.",
        f"Leave {silicone.cure_time_h:g} h, lift the frame off, peel the silicone off the plug. "
        f"Post-cure, off the print, in a vented oven (warm silicone gives off vapour), as the data sheet says: {BLANK}",
    ]
    if lidded:
        steps.insert(
            3, "Stand the sprue pin (one) and the vent pins (five) in their sockets; pull them before peeling the lid."
        )
    return [Block("head", "1. The mould"), Block("list", items=tuple(steps))]


def _gauged(spec: MouldSpec) -> str:
    words = tip_words(spec)
    return f" There {words}. Height over the flat: {BLANK} mm." if words else ""


def _plastic(spec: MouldSpec) -> str:
    if spec.plastic is not None:
        return f"{spec.plastic.name.upper()}, bears {spec.plastic.service_temperature_C:g} C"
    return f"a plastic that bears {spec.pour.cure_temperature_C:g} C"


def _aids(spec: MouldSpec) -> str:
    """What an open mould is closed with."""
    if spec.pad.shape.bone_height_mm:
        return ", carrier with the bone upwards (solid)"
    carrier = ", carrier (solid)" if len(spec.pad.shape.places_mm) > 1 else ""
    return f", strike-off plate{carrier}" if spec.base is None else ", strike-off plate, spacer"


def _weight_blocks(spec: MouldSpec, plan: PourPlan) -> list[Block]:
    if plan.base is None:
        return [Block("head", "2. Weigh the resin"), *_weighing(spec, spec.pour, plan)]
    return [
        Block("head", "2a. Weigh the resin of the upper layer (poured first)"),
        *_weighing(spec, spec.pour, plan),
        Block("head", "2b. Weigh the resin of the base layer (poured second, when the first has gelled)"),
        *_weighing(spec, spec.base.pour, plan.base),
    ]


def _weighing(spec: MouldSpec, pour: Pour, plan: PourPlan) -> list[Block]:
    """Table of one resin's weights, and how much of the batch goes where."""
    resolution = spec.machines.balance_resolution_g
    digits = max(0, -math.floor(math.log10(resolution)))
    batch = batch_of(spec, pour, plan)
    mixes = [batch.mix] if batch.holds_witness else [batch.mix, batch.with_witness]
    rows = [("component", *("mix, g", "mix with a witness puck, g")[: len(mixes)], "really weighed, g")]
    for name, *masses in ((parts[0][0], *(mass for _, mass in parts)) for parts in zip(*(m.components for m in mixes))):
        rows.append((name, *(f"{mass:.{digits}f}" for mass in masses), BLANK))
    rows.append(("total", *(f"{one.total_g:.{digits}f}" for one in mixes), BLANK))
    cup = CUP_FACTOR * mixes[-1].total_g / pour.density_g_per_cm3 * 1e-3
    return [
        Block("text", f"{pour.resin}, ratio {pour.ratio:.6g} ({pour.ratio_meaning}); balance step {resolution:g} g."),
        Block("table", rows=tuple(rows)),
        Block("text", " ".join((*_batch_words(spec, pour, plan, batch, digits), f"Cup of at least {cup:.2f} litres: "
              "the mix foams to four times its volume under vacuum."))),
        Block(
            "text",
            f"Witness: a puck of {WITNESS_DIAMETER_MM:g} mm diameter and {WITNESS_HEIGHT_MM:g} mm height from the same "
            f"cup ({batch.witness_g:.1f} g). Its mould: dummydesign mold --shape puck --thickness "
            f"{WITNESS_HEIGHT_MM:g} --length {WITNESS_DIAMETER_MM:g} --width {WITNESS_DIAMETER_MM:g}. Compress it on "
            f"the day of the test and read its modulus with: dummydesign resins add-compression TRACE.csv --diameter "
            f"{WITNESS_DIAMETER_MM:g} --height {WITNESS_HEIGHT_MM:g} --name NAME --ratio {pour.ratio:.6g}.",
        ),
    ]  # fmt: skip


def _batch_words(spec: MouldSpec, pour: Pour, plan: PourPlan, batch: Batch, digits: int) -> list[str]:
    """How much to mix, how much of it to pour, why so much, and where the rest goes."""
    each = f" ({plan.fill_mass_g:.1f} g into each of {spec.count} cavities)" if spec.count > 1 else ""
    words = [f"Mix {batch.mix.total_g:.{digits}f} g and pour {batch.pour_g:.1f} g of it into the mould{each}."]
    if batch.raised:
        words.append(
            f"The mould would do with {plan.batch_mass_g:.{digits}f} g, but the balance leaves up to "
            f"{plan.ratio_error_percent:.2f} % error in a component's share of that; here it is "
            f"{batch.mix.error_percent:.2f} %. A finer balance saves resin."
        )
    else:
        words.append(f"The balance leaves up to {batch.mix.error_percent:.2f} % error in a component's share.")
    words.append(f"{pour.film_loss_g:g} g stay on cup and stirrer; {pour.extra_percent:g} % of the pour are spare.")
    if batch.holds_witness:
        words.append(f"The rest is enough for the witness puck ({batch.witness_g:.1f} g).")
    else:
        words.append(f"With a witness puck mix the second column, {batch.with_witness.total_g:.{digits}f} g; pour as "
                     "much into the mould.")  # fmt: skip
    return words


def _pour_blocks(spec: MouldSpec, plan: PourPlan) -> list[Block]:
    steps = tuple(step.text for step in pour_steps(spec, plan))
    trouble = [Block("head", "When a step fails"), Block("list", items=when_it_fails(spec))]
    return [Block("head", "3. Pour"), Block("list", items=steps), *trouble]


def _demould_blocks(spec: MouldSpec) -> list[Block]:
    pad, pour = spec.pad, spec.pour
    area = pad.length_mm * pad.width_mm
    let_go = (
        f"Never pull it straight: air pressure alone can hold {formula.suction_force_N(area):.0f} N on the sealed "
        "face. Peel a corner of the mould's wall outwards, let air in, and roll the mould off the pad "
        f"(about {formula.peel_force_N(min(pad.length_mm, pad.width_mm), 5.0):.1f} N at 5 J/m2).",
    )
    steps = (
        *(demould_steps(spec) if spec.is_printed else let_go),
        shape_notes.demould_first(spec),
        measured_blanks(spec.count),
        f"Age {pour.age_before_test_days:g} days at room temperature before testing; test pad and witness on one day.",
    )
    return [Block("head", "4. Demould and measure"), Block("list", items=steps), *_gauge_blocks(spec)]


def to_markdown(blocks: Sequence[Block]) -> str:
    """Write blocks as Markdown."""
    lines: list[str] = []
    for index, block in enumerate(blocks):
        if block.kind == "head":
            lines.append(f"{'#' if index == 0 else '##'} {block.text}")
        elif block.kind == "text":
            lines.append(block.text)
        elif block.kind == "list":
            lines += [f"{number}. {item}" for number, item in enumerate(block.items, 1)]
        else:
            head, *rows = block.rows
            lines.append("| " + " | ".join(head) + " |")
            lines.append("|" + "---|" * len(head))
            lines += ["| " + " | ".join(row) + " |" for row in rows]
        lines.append("")
    return "\n".join(lines)


_STYLE = (
    "body{font:15px/1.45 system-ui,sans-serif;max-width:860px;margin:2em auto;padding:0 1em;color:#20303c}"
    "table{border-collapse:collapse}td,th{border:1px solid #9fb0bc;padding:.35em .8em;text-align:right}"
    "td:first-child,th:first-child{text-align:left}h1{font-size:1.5em}h2{font-size:1.15em;margin-top:1.6em}"
    "svg{max-width:100%;height:auto;border:1px solid #dde5ea}li{margin:.3em 0}"
    "@media print{body{margin:0;font-size:12px}}"
)


def to_html(blocks: Sequence[Block], drawing_svg: str = "") -> str:
    """Write blocks as one HTML page that needs nothing else; a drawing may stand at its end."""
    parts: list[str] = []
    for index, block in enumerate(blocks):
        if block.kind == "head":
            tag = "h1" if index == 0 else "h2"
            parts.append(f"<{tag}>{html.escape(block.text)}</{tag}>")
        elif block.kind == "text":
            parts.append(f"<p>{html.escape(block.text)}</p>")
        elif block.kind == "list":
            parts.append("<ol>" + "".join(f"<li>{html.escape(item)}</li>" for item in block.items) + "</ol>")
        else:
            head, *rows = block.rows
            cells = ["".join(f"<th>{html.escape(c)}</th>" for c in head)]
            cells += ["".join(f"<td>{html.escape(c)}</td>" for c in row) for row in rows]
            parts.append("<table>" + "".join(f"<tr>{row}</tr>" for row in cells) + "</table>")
    title = html.escape(blocks[0].text)
    return (
        f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>'
        f"<style>{_STYLE}</style></head><body>\n" + "\n".join(parts) + f"\n{drawing_svg}\n</body></html>\n"
    )
