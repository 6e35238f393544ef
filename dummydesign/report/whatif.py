"""Report of a what-if study."""

from __future__ import annotations

import itertools
import math
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.core.parsing import command_words
from dummydesign.core.tables import Table
from dummydesign.design.request import Request
from dummydesign.report.front_page import FOOT, Fact, FrontPage, Panel, full_sentence, plot_drawing, warning_texts
from dummydesign.report.page import STYLES, Section, write_report
from dummydesign.report.plot import Plot, Series

if TYPE_CHECKING:
    from dummydesign.design.sweep.spec import Study
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue


SHOWN, SERIES = 200, 6
STATEMENT = (
    "Thinner slabs are more curved, in finite elements of one resin under one punch. The paper says the opposite: "
    "its dummy II (20 mm, the thickest) is the most curved because it is thick. At equal depth and equal strain the "
    "5 mm slab is by far the most curved and the 20 mm slab the least. This holds on a glued and on a sliding base. "
    "At equal force the difference is smaller. At 25 kPa, 5 N and on a glued base the exponent falls from 1.21 (5 "
    "mm) to 1.05 (20 mm), at 10 N from 1.35 to 1.15. In stiffening resins, too, the 20 mm slab is the least curved. "
    "If dummy II was the most curved, its thickness was not the cause."
    "\n\n"
    "Not covered: depths above 0.6 of the thickness; resins other than neo-Hookean and Yeoh; a pad that lifts off "
    "its base or wraps the punch."
)
"""What finite elements say of thickness; the tables behind it are written by ``studies.thickness``."""
Rows = list[dict[str, Any]]
BEST, ACROSS = 10, 7
VARIED = ("shape", "punch", "condition", "base", "edge_radius_mm")


def best_first(rows: Rows) -> Rows:
    """Rows by falling score, those of equal score as they were; as they are without scores."""
    if not rows or "score" not in rows[0]:
        return rows
    return sorted(rows, key=lambda row: -row["score"]["total"])


def varied(rows: Rows) -> dict[str, list[Any]]:
    """The values of each setting beside thickness and ratio, in their order."""
    return {name: list(dict.fromkeys(row[name] for row in rows)) for name in VARIED}


def fixed_texts(rows: Rows) -> list[str]:
    """Settings that all designs share."""
    return [
        f"{name.removesuffix('_mm').replace('_', ' ')} {values[0]}"
        for name, values in varied(rows).items()
        if len(values) == 1 and values[0]
    ]


def in_plane(rows: Rows) -> bool:
    """Whether thickness and ratio alone differ, and no tissue ranks the designs."""
    return "score" not in rows[0] and all(len(values) == 1 for values in varied(rows).values())


def plane_texts(rows: Rows) -> tuple[str, str]:
    """What the two tables of :func:`plane_tables` hold."""
    return f"depth in mm at {_middle(rows)} N steady ('-': not reached)", "peak over steady at the highest speed"


def _middle(rows: Rows) -> str:
    forces = list(rows[0]["depth_mm_at_N"])
    return forces[len(forces) // 2]


def plane_tables(rows: Rows) -> tuple[Table, Table, int]:
    """Depth at one force, peak over steady, and how many thicknesses are left out."""
    force = _middle(rows)
    across = sorted({row["thickness_mm"] for row in rows})
    shown = (
        across
        if len(across) <= ACROSS
        else [across[round(i * (len(across) - 1) / (ACROSS - 1))] for i in range(ACROSS)]
    )
    at = {(row["ratio"], row["thickness_mm"]): row for row in rows}
    depths, peaks = list[list[str]](), list[list[str]]()
    for ratio in sorted({row["ratio"] for row in rows}):
        cells = [at.get((ratio, thickness)) for thickness in shown]
        depth = [None if row is None else row["depth_mm_at_N"][force] for row in cells]
        peak = [
            None if row is None or x is None else list(row["peak_over_steady"].values())[-1]
            for row, x in zip(cells, depth)
        ]
        first = [f"{ratio:g}", f"{next(row['young_kPa'] for row in rows if row['ratio'] == ratio):.3g}"]
        for body, values in ((depths, depth), (peaks, peak)):
            body.append([*first, *("-" if value is None else f"{value:.2f}" for value in values)])
    head = ["ratio", "kPa", *(f"{thickness:g} mm" for thickness in shown)]
    return Table(head, depths), Table(head, peaks), len(across) - len(shown)


def first_text(rows: Rows) -> str:
    """What the columns of :func:`first_table` hold."""
    best = "best first (score: 1 is best); " if "score" in rows[0] else ""
    return f"{best}'at N': depth in mm at that steady force ('-': not reached)"


def first_table(rows: Rows) -> tuple[Table, int]:
    """The best designs, all where no tissue ranks them, and how many are left out."""
    forces = list(rows[0]["depth_mm_at_N"])
    shown = forces if len(forces) <= 3 else [forces[0], forces[len(forces) // 2], forces[-1]]
    differ = [name for name, values in varied(rows).items() if len(values) > 1]
    score = "score" in rows[0]
    body = []
    for row in rows[:BEST] if score else rows:
        depths = (row["depth_mm_at_N"][force] for force in shown)
        body.append(
            [
                *([f"{row['score']['total']:.2f}"] if score else []),
                f"{row['thickness_mm']:g}",
                f"{row['ratio']:g}",
                f"{row['young_kPa']:.3g}",
                *("-" if depth is None else f"{depth:.2f}" for depth in depths),
                ", ".join(str(row[name]) for name in differ),
            ]
        )
    head = [*(["score"] if score else []), "pad mm", "ratio", "kPa", *(f"at {force} N" for force in shown)]
    return Table([*head, ", ".join(differ)], body), len(rows) - BEST if score else 0


def write_whatif(
    folder: Path, study: Study, rows: Rows, resin: Resin, tissue: Tissue | None, warnings: list[dict[str, str]]
) -> dict[str, str]:
    """Write the report of a study into a folder; see :func:`dummydesign.report.page.write_report`."""
    thickness = _thickness(study, rows)
    sections = [thickness, *_map(study, rows), _table(study, rows)]
    lead = (
        f"{study.size} pads of {resin.title}: {_span(study.thickness_mm)} mm thick, ratio {_span(study.ratio)}, "
        f"{', '.join(name for name, _ in study.punches)}, by {_solved(study)}."
    )
    if tissue is not None and tissue.notice is not None:
        lead = f"{tissue.notice[1]}. {lead}"
    sources = [*resin.references, *([] if tissue is None else tissue.sources)]
    return write_report(
        folder,
        "What if",
        lead,
        sections,
        warnings=warnings,
        sources=sources,
        front=_front(study, rows, lead, thickness.plots, warnings),
    )


def _solved(study: Study) -> str:
    """How the forces were computed."""
    return "stored finite-element solutions" if study.fidelity == "table" else f"finite elements ({study.fidelity})"


def _front(study: Study, rows: Rows, lead: str, plots: Sequence[Plot], warnings: list[dict[str, str]]) -> FrontPage:
    """The first page: the best design or the study in words, depth and exponents over thickness, a table."""
    ordered = best_first(rows)
    plane = in_plane(ordered)
    if plane:
        depths, peaks, _ = plane_tables(ordered)
        both = (zip(*pair) for pair in zip(depths.rows, peaks.rows))
        body = [[x if column < 2 or y == "-" else f"{x}, {y}" for column, (x, y) in enumerate(row)] for row in both]
        table = Table(depths.head, body)
    else:
        table, _ = first_table(ordered)
    steps, best, facts, words = list[str](), ordered[0], [Fact("designs", f"{len(rows)}", True)], lead
    if "score" in best:
        text = f"{best['thickness_mm']:g} mm, ratio {best['ratio']:g}, {best['shape']}"
        score = f"{best['score']['total']:.2f}"
        facts = [Fact(f"best score for {study.tissue}, 0 to 1", score, True), Fact("pad", text)]
        words = f"Highest score for {study.tissue}, aim {study.aim}: {text}. A score is no verdict. {lead}"
        asked = command_words(Request, {"aim": study.aim, "resin": study.resin}, ("aim", "resin"))
        steps = [
            "Search all pads for a verdict, with castings, recipe and mould.",
            f"dummydesign suggest --tissue {shlex.quote(str(study.tissue))}{asked}",
        ]
    fixed = "\n".join(fixed_texts(ordered))
    return FrontPage(
        "What if",
        f"By {_solved(study)}; forces {_span(study.forces_N)} N, speeds {_span(study.velocities_mm_s)} mm/s.",
        (None, words),
        (plots[2].title, plot_drawing(plots[2])),
        "Study",
        [*facts, Fact("all designs", fixed)],
        "Local exponent d ln F / d ln x over thickness [mm]",
        [Panel(plot, plot.title.partition(" thickness ")[2], "") for plot in plots[:2]],
        (),
        table,
        [("Cells", [full_sentence(", ".join(plane_texts(ordered)))])] if plane else (),
        warning_texts(warnings),
        steps,
        foot=f"{FOOT} rows.csv has every design.",
    )


def _span(values: tuple[float, ...]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _groups(study: Study, rows: Rows) -> list[tuple[str, Rows]]:
    """Rows by punch, support and a few ratios, each with a name that says what differs."""
    ratios = [study.ratio[index] for index in np.unique(np.linspace(0, len(study.ratio) - 1, SERIES).astype(int))]
    groups = []
    each = itertools.product(study.setups, study.pads, ratios)
    for ((punch, _), condition, base), (shape, edge), ratio in itertools.islice(each, SERIES):
        varied: dict[str, Sequence[Any]] = {
            f"ratio {ratio:g}": study.ratio,
            punch: study.punches,
            f"{condition} face": study.conditions,
            f"{base} base": study.bases,
            shape: study.shapes,
            f"edge {edge:g} mm": study.edge_radii_mm,
        }
        words = [text for text, values in varied.items() if len(values) > 1]
        wanted = (punch, condition, base, shape, edge)
        chosen = [row for row in rows if row["ratio"] == ratio and _setup(row) == wanted]
        groups.append((", ".join(words) or f"ratio {ratio:g}", chosen))
    return groups


def _setup(row: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in ("punch", "condition", "base", "shape", "edge_radius_mm"))


def _thickness(study: Study, rows: Rows) -> Section:
    """Exponent and depth against thickness."""
    mark = Series.dots if len(study.thickness_mm) < 3 else Series.line
    middle = min(study.forces_N, key=lambda force: abs(force - 10.0))
    groups = _groups(study, rows)
    first, one = groups[len(groups) // 2]

    def curves(name: str, force: float) -> list[Series]:
        return [mark(words, *_series(chosen, name, force), style) for (words, chosen), style in zip(groups, STYLES)]

    by_force = [
        mark(f"{force:g} N", *_series(one, "exponent_at_N", force), style)
        for force, style in zip(study.forces_N, STYLES)
    ]
    exponent = ("thickness [mm]", "local exponent d ln F / d ln x", "thickness_mm", "exponent")
    plots = [
        Plot(
            "exponent-by-force",
            f"Exponent against thickness at equal force, {first}",
            f"Local exponent over thickness at equal forces, {first}.",
            *exponent,
            by_force,
            zero=False,
        ),
        Plot(
            "exponent-by-design",
            f"Exponent against thickness at {middle:g} N",
            f"Local exponent over thickness at {middle:g} N for several designs.",
            *exponent,
            curves("exponent_at_N", middle),
            zero=False,
        ),
        Plot(
            "depth",
            f"Relaxed depth against thickness at {middle:g} N",
            f"Relaxed depth over thickness at {middle:g} N for several designs.",
            "thickness [mm]",
            "depth [mm]",
            "thickness_mm",
            "depth_mm",
            curves("depth_mm_at_N", middle),
        ),
    ]
    return Section("Thickness and nonlinearity", STATEMENT, plots)


def _series(rows: Rows, name: str, force: float) -> tuple[list[float], list[float]]:
    """Thickness and a value at a force; NaN where missing, which breaks the line."""
    pairs = sorted((row["thickness_mm"], row[name][f"{force:g}"]) for row in rows)
    return [thickness for thickness, _ in pairs], [math.nan if value is None else value for _, value in pairs]


def _map(study: Study, rows: Rows) -> list[Section]:
    """Score over ratio and thickness for the first setup, when there is a score and a map."""
    if study.tissue is None or len(study.thickness_mm) < 2 or len(study.ratio) < 2:
        return []
    (punch, _), condition, base = study.setups[0]
    shape, edge = study.pads[0]
    thickness, ratio = sorted(study.thickness_mm), sorted(study.ratio)
    shown = [row for row in rows if _setup(row) == (punch, condition, base, shape, edge)]
    score = {(row["thickness_mm"], row["ratio"]): row["score"]["total"] for row in shown}
    value = np.array([[score.get((one, other), np.nan) for other in ratio] for one in thickness])
    best = max(shown, key=lambda row: row["score"]["total"])
    series = (
        Series.map("total score", ratio, thickness, value),
        Series.dots("best of this study", [best["ratio"]], [best["thickness_mm"]], "aim"),
    )
    alt = (
        f"Map of the total score for {study.tissue} over ratio and thickness; best {best['score']['total']:.2f} at "
        f"{best['thickness_mm']:g} mm and ratio {best['ratio']:g}."
    )
    plot = Plot(
        "score",
        f"Score for {study.tissue}, aim {study.aim}",
        alt,
        "ratio",
        "thickness [mm]",
        "ratio",
        "thickness_mm",
        series,
        note=f"{shape}, {punch}, {condition} face, {base} base; 1 is best",
    )
    return [Section("Score", "", [plot])]


def _table(study: Study, rows: Rows) -> Section:
    forces, speeds = [f"{v:g}" for v in study.forces_N], [f"{v:g}" for v in study.velocities_mm_s]
    scored = study.tissue is not None
    head = ["thickness mm", "ratio", "shape", "punch", "face, base", "E kPa", *(["score"] if scored else [])]
    head += [f"{name} at {force} N" for force in forces for name in ("depth mm,", "exponent")]
    head += [f"peak / steady at {speed} mm/s" for speed in speeds] + ["stops early"]
    lines = []
    for row in best_first(rows)[:SHOWN]:
        edge = f", edge {row['edge_radius_mm']:g} mm" if row["edge_radius_mm"] else ""
        values = [row["thickness_mm"], row["ratio"], row["shape"], row["punch"] + edge]
        values += [f"{row['condition']}, {row['base']}", row["young_kPa"]]
        values += [row["score"]["total"]] if scored else []
        for force in forces:
            values += [row["depth_mm_at_N"][force], row["exponent_at_N"][force]]
        lines.append([*values, *(row["peak_over_steady"][speed] for speed in speeds), row["limit"] or ""])
    first = "best" if scored else "first"
    more = f"The {first} {SHOWN} of {len(rows)} designs; all are in rows.csv." if len(rows) > SHOWN else ""
    return Section("Rows", more, table=Table(head, lines))
