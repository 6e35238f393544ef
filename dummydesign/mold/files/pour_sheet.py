"""The pour sheet: one set of blocks, written as a self-contained HTML page and as PDF. No CAD, no browser.

Pages of the PDF carry number, date, command and hash.
"""

from __future__ import annotations

import html
import io
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from dummydesign.mold.cad.label import label_text
from dummydesign.mold.files.drawing_layout import font_file
from dummydesign.mold.files.drawing_sheet import PAPERS, Drawing, draw, packed_pages, to_dxf, to_pdf, to_svg
from dummydesign.mold.model.spec import MouldSpec, Pour
from dummydesign.mold.pour.acceptance import acceptance_rows, gauge_points, measured_blanks, points_rows, when_it_fails
from dummydesign.mold.pour.bill_of_materials import bill_of_materials, materials
from dummydesign.mold.pour.plan import CUP_FACTOR, WITNESS_MM, Batch, Mix, PourPlan, batch_of, pours_of
from dummydesign.mold.pour.printing import demould_steps, height_words, mould_steps, print_words, tip_words
from dummydesign.mold.pour.steps import BLANK, cup_words, demould_first, plug_finish, pour_steps, shape_mark
from dummydesign.resin.model.ratio_meaning import ratio_words

PADS_A_TABLE = 4


@dataclass(frozen=True)
class SheetBlock:
    """A heading (``head``), a paragraph (``text``), a numbered list (``list``) or a ``table`` (first row its head)."""

    kind: str
    text: str = ""
    rows: tuple[tuple[str, ...], ...] = ()
    items: tuple[str, ...] = ()


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
    safety = "Gloves, goggles, extraction or a hood; read the safety data sheets of all products first."
    if spec.pour.has_isocyanate:
        safety = (
            "isocyanates harm the airways and can cause a lasting allergy; never heat open isocyanate; "
            f"keep moisture out. {safety}"
        )
    return [
        SheetBlock("head", title),
        SheetBlock("text", f"Specification {spec.hash}; {label}. Date {BLANK}  Operator {BLANK}  Resin batch {BLANK}"),
        *([SheetBlock("text", f"{pad.title}. {mark[0].upper()}{mark[1:]}.")] if mark else []),
        SheetBlock("text", f"Safety: {safety}"),
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
    rows = weight_rows(mixes, digits)
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
        SheetBlock("table", rows=tuple(rows)),
        *volume_blocks(pour),
        SheetBlock("text", " ".join((*_batch_words(spec, pour, plan, batch, digits), cup))),
        SheetBlock("text", witness),
        *([SheetBlock("text", _hardness_words(pour))] if pour.hardness else []),
    ]


def weight_rows(mixes: Sequence[Mix], digits: int) -> list[tuple[str, ...]]:
    """Table of the masses of each mix, of a resin by volume the volumes too, with a column to fill in."""
    names = ("mix", "mix with a witness puck")[: len(mixes)]
    by_volume = bool(mixes[0].volumes_ml)
    units = ("g", "ml") if by_volume else ("g",)
    heads = [f"{name}, {unit}" for name in names for unit in units]
    rows: list[tuple[str, ...]] = [("component", *heads, "weighed, g")]
    for row, (component, _) in enumerate(mixes[0].components):
        cells: list[str] = []
        for mix in mixes:
            cells.append(f"{mix.components[row][1]:.{digits}f}")
            cells += [f"{mix.volumes_ml[row]:.1f}"] if by_volume else []
        rows.append((component, *cells, BLANK))
    totals: list[str] = []
    for mix in mixes:
        totals.append(f"{mix.total_g:.{digits}f}")
        totals += [f"{sum(mix.volumes_ml):.1f}"] if by_volume else []
    return [*rows, ("total", *totals, BLANK)]


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
MM = 72.0 / 25.4
MARGIN_MM, FOOT_MM = 16.0, 22.0


@dataclass(frozen=True)
class Foot:
    """What stands at the foot of every page, and the paper of pages and drawings."""

    hash: str
    command: str = ""
    date: str = ""
    paper: str = "A4"


@lru_cache(1)
def fonts() -> tuple[str, str]:
    """Names of a plain and a bold font that know more than Western letters: DejaVu Sans, which matplotlib carries."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.ttfonts import TTFont

    names = ("DejaVuSans", "DejaVuSans-Bold")
    files = [font_file(name) for name in names]
    if None in files:
        return "Helvetica", "Helvetica-Bold"
    for name, file in zip(names, files):
        pdfmetrics.registerFont(TTFont(name, str(file)))
    pdfmetrics.registerFontFamily(names[0], normal=names[0], bold=names[1], italic=names[0], boldItalic=names[1])
    return names


JAPANESE = re.compile("[\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef]+")


def marked(words: str) -> str:
    """Escape a paragraph's words; Japanese letters get a font of their own, which the reader's program brings."""
    from reportlab.pdfbase import pdfmetrics
    from reportlab.pdfbase.cidfonts import UnicodeCIDFont

    name = "HeiseiKakuGo-W5"
    if JAPANESE.search(words) and name not in pdfmetrics.getRegisteredFontNames():
        pdfmetrics.registerFont(UnicodeCIDFont(name))
    return JAPANESE.sub(lambda match: f'<font name="{name}">{match[0]}</font>', html.escape(words))


def sheet_pdf(blocks: Sequence[SheetBlock], foot: Foot, drawings: Sequence[Drawing] = ()) -> bytes:
    """Write a pour sheet as PDF."""
    from reportlab.pdfgen.canvas import Canvas
    from reportlab.platypus import BaseDocTemplate, Frame, PageTemplate

    wide, high = (MM * side for side in PAGES_MM[foot.paper])
    margin, low = MM * MARGIN_MM, MM * (FOOT_MM + 4.0)
    story = _story(blocks, wide - 2 * margin)
    for drawing in drawings:
        story += _picture(drawing, wide - 2 * margin)

    class Numbered(Canvas):
        """Keeps its pages until the last is laid out, when their number is known."""

        def __init__(self, *given: Any, **named: Any) -> None:
            Canvas.__init__(self, *given, **named)
            self.kept: list[dict[str, Any]] = []

        def showPage(self) -> None:
            self.kept.append(dict(self.__dict__))
            self._startPage()

        def save(self) -> None:
            for page, state in enumerate(self.kept, 1):
                self.__dict__.update(state)
                _foot(self, foot, page, len(self.kept), wide, margin)
                Canvas.showPage(self)
            Canvas.save(self)

    stream = io.BytesIO()
    document = BaseDocTemplate(stream, pagesize=(wide, high), invariant=1, title=blocks[0].text, creator="dummydesign")
    frame = Frame(margin, low, wide - 2 * margin, high - low - margin, 0, 0, 0, 0)
    document.addPageTemplates(PageTemplate("page", [frame]))
    with packed_pages():
        document.build(story, canvasmaker=Numbered)
    return stream.getvalue()


def _story(blocks: Sequence[SheetBlock], wide: float) -> list[Any]:
    from reportlab import platypus as flow
    from reportlab.lib.colors import HexColor
    from reportlab.lib.styles import ParagraphStyle

    plain, bold = fonts()
    text = ParagraphStyle("text", fontName=plain, fontSize=9, leading=12.5)
    cell = ParagraphStyle("cell", parent=text, fontSize=8, leading=10.5)
    heads = [
        ParagraphStyle(
            name,
            parent=text,
            fontName=bold,
            fontSize=size,
            leading=1.35 * size,
            spaceBefore=9,
            spaceAfter=3,
            keepWithNext=1,
        )
        for name, size in (("title", 14), ("head", 11))
    ]
    grid = flow.TableStyle(
        [
            ("GRID", (0, 0), (-1, -1), 0.4, HexColor("#8a99a5")),
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("BACKGROUND", (0, 0), (-1, 0), HexColor("#eef2f5")),
            ("LEFTPADDING", (0, 0), (-1, -1), 3),
            ("RIGHTPADDING", (0, 0), (-1, -1), 3),
            ("TOPPADDING", (0, 0), (-1, -1), 2),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
        ]
    )
    story: list[Any] = []
    for index, block in enumerate(blocks):
        if block.kind == "head":
            story += [flow.CondPageBreak(MM * 60), flow.Paragraph(marked(block.text), heads[min(index, 1)])]
        elif block.kind == "text":
            story += [flow.Paragraph(marked(block.text), text), flow.Spacer(1, 3)]
        elif block.kind == "list":
            items = [flow.ListItem(flow.Paragraph(marked(item), text), spaceAfter=2) for item in block.items]
            story.append(flow.ListFlowable(items, bulletFontName=plain, bulletFontSize=9, leftIndent=16))
        else:
            rows = [[flow.Paragraph(marked(words), cell) for words in row] for row in block.rows]
            table = flow.Table(rows, colWidths=_widths(block.rows, wide, plain), repeatRows=1, style=grid)
            story += [flow.KeepTogether(table) if len(rows) < 9 else table, flow.Spacer(1, 5)]
    return story


def _widths(rows: Sequence[Sequence[str]], wide: float, font: str) -> list[float]:
    """Columns as wide as their longest word at least, the rest shared by the length of their texts."""
    from reportlab.pdfbase.pdfmetrics import stringWidth

    columns = list(zip(*rows))
    least = [max(stringWidth(w, font, 8) for text in one for w in text.split() or [""]) + 8 for one in columns]
    wanted = [max(stringWidth(text, font, 8) for text in one) + 8 for one in columns]
    if sum(wanted) <= wide:
        return wanted
    spare, more = max(0.0, wide - sum(least)), [a - b for a, b in zip(wanted, least)]
    share = spare / max(sum(more), 1e-9)
    return [a + share * b for a, b in zip(least, more)]


def _picture(drawing: Drawing, wide: float) -> list[Any]:
    from reportlab.lib.styles import ParagraphStyle
    from reportlab.platypus import Flowable, KeepTogether, Paragraph

    width, height = PAPERS[drawing.paper]
    factor = wide / width

    class Picture(Flowable):
        def __init__(self) -> None:
            Flowable.__init__(self)
            self.width, self.height = wide, factor * height

        def draw(self) -> None:
            self.canv.scale(factor, factor)
            draw(self.canv, drawing)

    words = f"{drawing.title}: not to scale here; the drawings' own PDF is true to scale."
    style = ParagraphStyle("under", fontName=fonts()[0], fontSize=8)
    return [KeepTogether([Picture(), Paragraph(marked(words), style)])]


def _foot(canvas: Any, foot: Foot, page: int, pages: int, wide: float, margin: float) -> None:
    """Page number, date, command and hash."""
    from reportlab.lib.utils import simpleSplit

    plain, bold = fonts()
    canvas.saveState()
    canvas.setLineWidth(0.4)
    top = MM * FOOT_MM
    canvas.line(margin, top, wide - margin, top)
    canvas.setFont(bold, 8)
    canvas.drawString(margin, top - 10, f"Specification {foot.hash}    page {page} of {pages}    {foot.date}")
    canvas.setFont(plain, 7)
    for row, line in enumerate(simpleSplit(foot.command, plain, 7, wide - 2 * margin)[:3]):
        canvas.drawString(margin, top - 20 - 9 * row, line)
    canvas.restoreState()


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
