"""Tables of the study of the paper's dummies: verdicts, what each variant changes, and why some words fail."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from studies.paper_dummies.dummies import HELD, REFERENCE, SITES, Dummy, Variant
from studies.paper_dummies.in_time import CENTRE, SOFT_EDGE, SPEEDS, STIFF_EDGE, Dummies, Judged
from studies.paper_dummies.statements import ABOUT_5N, Statement, statements

SHOWN = (
    REFERENCE,
    Variant("sliding"),
    *(Variant("bonded", young) for young in (15.0, 34.0, 50.0)),
    *(Variant("bonded", 25.0, c2) for c2 in (0.1, 0.3)),
)
"""Variants with columns of their own: the reference, and one thing changed at a time."""
MARKS = {True: "+", False: "–", None: "·"}
WANTED_PLACE = {"I": CENTRE, "II": SOFT_EDGE, "III": STIFF_EDGE}
WANTED_PEAK = {"I": CENTRE, "II": STIFF_EDGE, "III": (0.0, 1.0)}
NOT_AT_ALL = "cannot be reproduced"
NOT_NEO_HOOKEAN = f"{NOT_AT_ALL} by a neo-Hookean resin"
Results = dict[Variant, Dummies]


def tables(results: Results, scan: Results) -> str:
    """All tables of the page as Markdown."""
    judged = [(statement, judge_all(statement, results)) for statement in statements()]
    parts = [
        ("Side by side", side_by_side(judged)),
        ("One thing changed at a time", by_variant(judged)),
        ("How much holds at once", at_once(judged)),
        ("Moduli at which the steady curve runs as the paper says", moduli(scan)),
        ("Why: the exponent", exponents(results, scan)),
        ("Why: the relaxation", relaxation(results)),
        ("The simulated dummies", figures(results)),
    ]
    return "\n".join(f"### {title}\n\n{text}" for title, text in parts)


def judge_all(statement: Statement, results: Results) -> dict[Variant, Judged]:
    """The statement's judgement and numbers in every variant."""
    return {variant: statement.judge(dummies) for variant, dummies in results.items()}


def verdict(judged: dict[Variant, Judged]) -> str:
    """``agrees`` in the reference, ``disagrees`` when only another variant does, else ``cannot be reproduced``.

    "By a neo-Hookean resin" is added when a stiffening one does it.
    """
    if judged[REFERENCE][0]:
        return "agrees"
    held = [variant for variant, (holds, _) in judged.items() if holds]
    if not held:
        return NOT_AT_ALL
    if all(variant.stiffening for variant in held):
        return NOT_NEO_HOOKEAN
    return "disagrees"


def _row(cells: Iterable[object]) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _table(head: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    return "\n".join([_row(head), "|---" * len(head) + "|", *(_row(row) for row in rows)]) + "\n"


def _held_in(judged: dict[Variant, Judged]) -> str:
    """Variants that agree, of those that could be judged, neo-Hookean and stiffening apart."""
    texts = []
    for stiff in (False, True):
        own = [holds for variant, (holds, _) in judged.items() if bool(variant.stiffening) is stiff]
        texts.append(f"{sum(holds is True for holds in own)}/{sum(holds is not None for holds in own)}")
    return ", ".join(texts)


def side_by_side(judged: list[tuple[Statement, dict[Variant, Judged]]]) -> str:
    """The main table: words, verdict, and the number in the reference."""
    rows = []
    for statement, found in judged:
        holds, number = found[REFERENCE]
        shown = number if holds is not None else f"not judged: {number}"
        words = f"{statement.words} ({statement.section})"
        rows.append((statement.dummy, words, statement.basis, verdict(found), shown, _held_in(found)))
    head = ("dummy", "the paper says (section)", "basis", "ours", "numbers (glued, 25 kPa)", "holds in, of variants")
    return _table(head, rows) + "\n" + _counts(judged)


def _counts(judged: list[tuple[Statement, dict[Variant, Judged]]]) -> str:
    kinds = ("agrees", "disagrees", NOT_NEO_HOOKEAN, NOT_AT_ALL)
    rows = []
    for basis in ("input", "band", "free"):
        words = [verdict(found) for statement, found in judged if statement.basis == basis]
        rows.append((basis, *(words.count(kind) for kind in kinds), len(words)))
    rows.append(("all", *(sum(row[column] for row in rows) for column in range(1, len(kinds) + 2))))
    return _table(("basis", *kinds, "rows"), rows)


def by_variant(judged: list[tuple[Statement, dict[Variant, Judged]]]) -> str:
    """Marks of every statement in the reference and its neighbours, with the number where the mark changes."""
    rows = []
    for statement, found in judged:
        first = found[REFERENCE][0]
        cells = []
        for variant in SHOWN:
            holds, number = found[variant]
            cells.append(MARKS[holds] + (f" {number}" if holds is not first and holds is not None else ""))
        rows.append((statement.dummy, statement.words, *cells))
    return _table(("dummy", "the paper says", *SHOWN), rows)


def at_once(judged: list[tuple[Statement, dict[Variant, Judged]]]) -> str:
    """How many statements each variant holds, together and a dummy."""
    rows = []
    for variant in judged[0][1]:
        held = {name: 0 for name in SITES}
        out = 0
        for statement, found in judged:
            held[statement.dummy] += found[variant][0] is True
            out += found[variant][0] is None
        rows.append((str(variant), sum(held.values()), *held.values(), out))
    total = {name: sum(statement.dummy == name for statement, _ in judged) for name in SITES}
    rows.sort(key=lambda row: -row[1])
    head = (
        "variant",
        f"holds, of {len(judged)}",
        *(f"{name}, of {count}" for name, count in total.items()),
        "not judged",
    )
    return _table(head, rows)


def moduli(scan: Results) -> str:
    """Moduli at which the three words on the steady curve of a dummy hold at once, by base and law."""
    said = {name: [s for s in statements() if s.steady_curve and s.dummy == name] for name in SITES}
    rows: dict[tuple[str, float], list[str]] = {}
    for kind in dict.fromkeys((variant.base, variant.stiffening) for variant in scan):
        own = {v.young_kPa: dummies for v, dummies in scan.items() if (v.base, v.stiffening) == kind}
        held = {
            name: {young for young, dummies in own.items() if all(s.judge(dummies)[0] for s in words)}
            for name, words in said.items()
        }
        held["all"] = set.intersection(*held.values())
        rows[kind] = [", ".join(f"{young:g}" for young in sorted(found)) or "none" for found in held.values()]
    table = [(HELD[base], f"{c2:g}", *cells) for (base, c2), cells in rows.items()]
    return _table(("base", "c2/mu", *(f"{name}, kPa" for name in SITES), "all three, kPa"), table)


def needed_exponents(dummy: Dummy, name: str) -> tuple[float, float, float]:
    """Mean exponent from the stiffest subject near 5 N to the wanted place at 10 N: middle, least, largest.

    A slab that meets the stiffest subject at F_c and stands at depth x at 10 N has the mean exponent
    n = ln(10 / F_c) / ln(x / x_stiffest(F_c)) in between. The middle is F_c = 5 N and the middle of the
    place; for an edge that is the middle of the outer quarter.
    """
    stiff, soft = (float(edge[0]) for edge in dummy.tissue.steady_depth_range([10.0]))

    def needed(crossing: float, place: float) -> float:
        start = float(dummy.tissue.steady_depth_range([crossing])[0][0])
        return math.log(10.0 / crossing) / math.log((soft - place * (soft - stiff)) / start)

    low, high = (min(max(place, 0.0), 1.0) for place in WANTED_PLACE[name])
    ends = [needed(crossing, place) for crossing in ABOUT_5N for place in (low, high)]
    return needed(5.0, 0.5 * (low + high)), min(ends), max(ends)


def _span(values: Iterable[float], digits: int = 2) -> str:
    known = [value for value in values if not math.isnan(value)]
    if not known:
        return "–"
    low, high = (f"{value:.{digits}f}" for value in (min(known), max(known)))
    return low if low == high else f"{low} to {high}"


def exponents(results: Results, scan: Results) -> str:
    """Exponent needed by the words against the exponent a slab has, over all bases and moduli."""
    rows = []
    for name in SITES:
        need = needed_exponents(results[REFERENCE][name], name)
        cells = [name, f"{need[0]:.2f} ({need[1]:.2f} to {need[2]:.2f})", _span([results[REFERENCE][name].exponent()])]
        for c2 in sorted({variant.stiffening for variant in results}):
            for base in ("bonded", "sliding"):
                near = [
                    dummies[name].exponent() for variant, dummies in scan.items()
                    if (variant.base, variant.stiffening) == (base, c2)
                ]  # fmt: skip
                cells.append(_span(near))
        rows.append(cells)
    kinds = [
        f"{held}, {'neo-Hookean' if not c2 else f'c2/mu {c2:g}'}"
        for c2 in sorted({variant.stiffening for variant in results})
        for held in ("glued", "sliding")
    ]
    return _table(("dummy", "needed", "glued, 25 kPa", *(f"{kind}, 15 to 50 kPa" for kind in kinds)), rows)


def relaxation(results: Results) -> str:
    """Peak over steady force at 10 N: wanted by the words, and what one relaxation law gives the three."""
    rows = []
    for speed in SPEEDS:
        for name in SITES:
            press = results[REFERENCE][name].presses.get((10.0, speed))
            if press is None:
                continue
            low, high = press.band.peak_low_N, press.band.peak_high_N
            wanted = [(low + place * (high - low)) / 10.0 for place in WANTED_PEAK[name]]
            every = [
                dummies[name].presses[10.0, speed].peak_N / 10.0
                for dummies in results.values() if (10.0, speed) in dummies[name].presses
            ]  # fmt: skip
            rows.append(
                (f"{speed:g}", name, f"{wanted[0]:.2f} to {wanted[1]:.2f}", f"{press.peak_N / 10:.2f}", _span(every))
            )
    return _table(("mm/s", "dummy", "wanted", "glued, 25 kPa", "all variants"), rows) + "\n" + _arms(results)


def _arms(results: Results) -> str:
    """What one arm adds to the peak of II over what it adds to I and to III: largest over all arm times."""
    rows = []
    for speed in SPEEDS:
        for other in ("I", "III"):
            ratio = {
                variant: dummies["II"].arm_weights[speed] / dummies[other].arm_weights[speed]
                for variant, dummies in results.items()
                if all(dummies[name].arm_weights for name in ("II", other))
            }
            own = ratio[REFERENCE]
            neo = [float(r.max()) for variant, r in ratio.items() if not variant.stiffening]
            every = [float(r.max()) for r in ratio.values()]
            rows.append(
                (f"{speed:g}", other, f"{own.min():.2f} to {own.max():.2f}", f"{max(neo):.2f}", f"{max(every):.2f}")
            )
    head = ("mm/s", "II over", "glued, 25 kPa, arms of 1 ms to 10 s", "largest, neo-Hookean", "largest, all variants")
    return _table(head, rows)


def figures(results: Results) -> str:
    """What was simulated: reach, place, ranges below and above 5 N, force variation ranges, fit."""
    rows = []
    for variant in SHOWN:
        for name, dummy in results[variant].items():
            shares = dummy.steady_inside
            rows.append(
                (
                    str(variant), name, f"{dummy.reach_N:.1f}", _force_list(dummy),
                    f"{shares['below_5N_fraction']:.2f}", f"{shares['above_5N_fraction']:.2f}",
                    *(_range_shares(dummy, speed) for speed in SPEEDS), *_fitted(dummy),
                )
            )  # fmt: skip
    head = (
        "variant", "dummy", "reach, N", "depth at 5, 10, 15 N, mm", "steady range 0.5 to 5 N", "5 to 15 N",
        "F(t) in range at 5, 10, 15 N, 10 mm/s", "the same, 250 mm/s", "gamma1, 2, 3, N/mm3",
        "c2, c3 at 10, 250 mm/s, N s/mm", "rms misfit, N",
    )  # fmt: skip
    return _table(head, rows)


def _force_list(dummy: Dummy) -> str:
    depths = [dummy.depth_at(force) for force in (5.0, 10.0, 15.0)]
    return ", ".join("–" if np.isnan(depth) else f"{depth:.2f}" for depth in depths)


def _range_shares(dummy: Dummy, speed: float) -> str:
    presses = [dummy.presses.get((force, speed)) for force in (5.0, 10.0, 15.0)]
    return ", ".join("–" if press is None else f"{press.inside['inside_fraction']:.2f}" for press in presses)


def _fitted(dummy: Dummy) -> tuple[str, str, str]:
    if dummy.parameters is None:
        return "–", "–", "–"
    own = dummy.parameters
    springs = ", ".join(f"{value:.3g}" for value in (own.gamma1_N_per_mm3, *own.gamma_N_per_mm3))
    dampers = "; ".join(", ".join(f"{value:.3g}" for value in own.dampers_at(speed)) for speed in SPEEDS)
    return springs, dampers, f"{dummy.rmse_N:.2f}"
