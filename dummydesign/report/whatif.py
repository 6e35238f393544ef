"""Report of a what-if study: the live page, how thickness shapes the curve, the score map, the rows."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dummydesign.report.figures.layers import Cells, Dots, Line
from dummydesign.report.figures.plot import Plot
from dummydesign.report.html.live import FORCES_N, SIZES_MM, live_scripts, live_section
from dummydesign.report.html.page import Section, Table, write_report

if TYPE_CHECKING:
    from dummydesign.design.sweep.spec import Study
    from dummydesign.resin.model.resin import Resin
    from dummydesign.tissue.model.tissue import Tissue

SHOWN, SERIES = 200, 6
STYLES = ("main", "alt1", "alt2", "alt3", "alt4", "alt5")
STATEMENT = (
    "The paper calls its dummy II (20 mm, the thickest) the most curved and gives its thickness as the reason. "
    "For slabs of one resin under one punch the finite elements say the opposite: at equal depth and at equal "
    "strain the thinnest slab (5 mm) is by far the most curved and the 20 mm slab the least, on a glued and on a "
    "sliding base. At equal force the thick slab is strained more, which evens the difference but does not turn "
    "it: at 25 kPa and 5 N the exponent falls from 1.21 (5 mm) to 1.05 (20 mm) on a glued base, at 10 N from 1.36 "
    "to 1.15 with 5 and 10 mm alike; in resins that stiffen the 20 mm slab is the least curved from 2 to 15 N "
    "too. Thickness does rule the nonlinearity, through punch radius over thickness and through strain, but "
    "thinner is more curved. If dummy II was measured to be the most curved, something else than its thickness "
    "made it so."
    "\n\n"
    "Not covered: depths above 0.6 of the thickness, where a slab of 10 mm or more of that modulus would carry 15 "
    "N, resins other than neo-Hookean and Yeoh, and a pad that lifts off its base or wraps the punch."
)
"""What finite elements say of thickness; the tables behind it are written by ``studies.thickness``."""
Rows = list[dict[str, Any]]


def write_whatif(
    folder: Path,
    study: Study,
    rows: Rows,
    resin: Resin,
    tissue: Tissue | None,
    data: dict[str, Any],
    warnings: list[dict[str, str]],
) -> dict[str, str]:
    """Write the report of a study into a folder; see :func:`dummydesign.report.html.page.write_report`.

    Parameters
    ----------
    folder : Path
        Where the files go.
    study : Study
        What was asked.
    rows : list of dict
        The answers, in the study's order.
    resin : Resin
        Gives ratios their moduli in the live page.
    tissue : Tissue or None
        Whose ranges are shown; None without scores.
    data : dict
        What the live page computes from, see :func:`dummydesign.design.sweep.live_data.live_data`.
    warnings : list of {code, message}
        Listed at the top.
    """
    sections = [
        live_section(data, resin, tissue, _start(study, rows)),
        _thickness(study, rows),
        *_map(study, rows),
        _table(study, rows),
    ]
    lead = (
        f"{study.size} pads of {resin.title}: {_span(study.thickness_mm)} mm thick, ratio {_span(study.ratio)}, "
        f"{', '.join(name for name, _ in study.punches)}, by {study.fidelity}."
    )
    if tissue is not None and tissue.said is not None:
        lead = f"{tissue.said[1]}. {lead}"
    sources = [*resin.references, *([] if tissue is None else tissue.sources)]
    return write_report(folder, "What if", lead, sections, (), warnings, sources, live_scripts())


def _span(values: tuple[float, ...]) -> str:
    low, high = min(values), max(values)
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"


def _start(study: Study, rows: Rows) -> dict[str, Any]:
    """Where the sliders stand first: the best score, else the middle of the lists."""
    # the page computes slabs
    rows = [row for row in rows if row["shape"] == "slab"] or rows
    scored = [row for row in rows if row.get("score")]
    best = max(scored, key=lambda row: row["score"]["total"]) if scored else rows[len(rows) // 2]
    name, size = best["punch"].split(":")[0], dict(study.punches)[best["punch"]]
    square = name != "round"
    side = size * math.sqrt(math.pi) if square else 2.0 * size
    force = study.forces_N[len(study.forces_N) // 2]
    return {
        "ratio": best["ratio"],
        "thickness_mm": best["thickness_mm"],
        "size_mm": min(max(side, SIZES_MM[0]), SIZES_MM[1]),
        "shape": "square" if square else "round",
        "base": best["base"],
        "velocity_mm_s": min(max(study.velocities_mm_s[-1], 1.0), 500.0),
        "force_N": min(max(force, FORCES_N[0]), FORCES_N[1]),
    }


def _groups(study: Study, rows: Rows) -> list[tuple[str, Rows]]:
    """Rows by punch, support and a few ratios, each with a name that says what differs."""
    ratios = [study.ratio[index] for index in np.unique(np.linspace(0, len(study.ratio) - 1, SERIES).astype(int))]
    groups = []
    each = itertools.product(study.setups, study.pads, ratios)
    for ((punch, _), condition, base), (shape, edge), ratio in itertools.islice(each, SERIES):
        words = [
            text
            for text, many in (
                (f"ratio {ratio:g}", len(study.ratio) > 1),
                (punch, len(study.punches) > 1),
                (f"{condition} face", len(study.conditions) > 1),
                (f"{base} base", len(study.bases) > 1),
                (shape, len(study.shapes) > 1),
                (f"edge {edge:g} mm", len(study.edge_radii_mm) > 1),
            )
            if many
        ]
        wanted = (punch, condition, base, shape, edge)
        chosen = [row for row in rows if row["ratio"] == ratio and _setup(row) == wanted]
        groups.append((", ".join(words) or f"ratio {ratio:g}", chosen))
    return groups[:SERIES]


def _setup(row: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(row[name] for name in ("punch", "condition", "base", "shape", "edge_radius_mm"))


def _thickness(study: Study, rows: Rows) -> Section:
    """Exponent and depth against thickness."""
    mark = Dots if len(study.thickness_mm) < 3 else Line
    middle = min(study.forces_N, key=lambda force: abs(force - 10.0))
    groups = _groups(study, rows)
    first, one = groups[len(groups) // 2]
    by_force = tuple(
        mark(f"{force:g} N", *_series(one, "exponent_at_N", force), style)
        for force, style in zip(study.forces_N, STYLES)
    )
    by_group = tuple(
        mark(name, *_series(chosen, "exponent_at_N", middle), style) for (name, chosen), style in zip(groups, STYLES)
    )
    depths = tuple(
        mark(name, *_series(chosen, "depth_mm_at_N", middle), style) for (name, chosen), style in zip(groups, STYLES)
    )
    common = {"x_label": "thickness [mm]", "x_name": "thickness_mm"}
    exponent = {"y_label": "local exponent d ln F / d ln x", "y_name": "exponent", "zero": False}
    plots = [
        Plot("exponent-by-force", f"Exponent against thickness at equal force, {first}",
             f"Local exponent over thickness at equal forces, {first}.", layers=by_force, **common, **exponent),
        Plot("exponent-by-design", f"Exponent against thickness at {middle:g} N",
             f"Local exponent over thickness at {middle:g} N for several designs.", layers=by_group, **common,
             **exponent),
        Plot("depth", f"Relaxed depth against thickness at {middle:g} N",
             f"Relaxed depth over thickness at {middle:g} N for several designs.", y_label="depth [mm]",
             y_name="depth_mm", layers=depths, **common),
    ]  # fmt: skip
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
    value = np.full((len(thickness), len(ratio)), np.nan)
    at = [{design: place for place, design in enumerate(steps)} for steps in (thickness, ratio)]
    best = None
    for row in rows:
        if _setup(row) == (punch, condition, base, shape, edge):
            value[at[0][row["thickness_mm"]], at[1][row["ratio"]]] = row["score"]["total"]
            if best is None or row["score"]["total"] > best["score"]["total"]:
                best = row
    layers = (
        Cells("total score", ratio, thickness, value),
        Dots("best of this study", [best["ratio"]], [best["thickness_mm"]], "aim"),
    )
    alt = (
        f"Map of the total score for {study.tissue} over ratio and thickness; best {best['score']['total']:.2f} at "
        f"{best['thickness_mm']:g} mm and ratio {best['ratio']:g}."
    )
    plot = Plot("score", f"Score for {study.tissue}, aim {study.aim}", alt, "ratio", "thickness [mm]", "ratio",
                "thickness_mm", layers, note=f"{shape}, {punch}, {condition} face, {base} base; 1 is best")  # fmt: skip
    return [Section("Score", "", [plot])]


def _table(study: Study, rows: Rows) -> Section:
    forces, speeds = [f"{v:g}" for v in study.forces_N], [f"{v:g}" for v in study.velocities_mm_s]
    scored = study.tissue is not None
    head = ["thickness mm", "ratio", "shape", "punch", "face, base", "E kPa", *(["score"] if scored else [])]
    head += [f"{name} at {force} N" for force in forces for name in ("depth mm,", "exponent")]
    head += [f"peak / steady at {speed} mm/s" for speed in speeds] + ["stops early"]
    lines = []
    ordered = sorted(rows, key=lambda row: -row["score"]["total"]) if scored else rows
    for row in ordered[:SHOWN]:
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
